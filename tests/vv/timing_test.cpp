#include "vv/timing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>

#include "tests/support/column_scene.hpp"
#include "tests/support/scratch_directory.hpp"
#include "vv/campaign.hpp"

namespace mpm::vv {
namespace {

namespace fs = std::filesystem;

RunRequest column(int cells) {
  RunRequest run;
  run.parameters = {{"/scene/cells", cells}};
  run.scene_text = {{"cells", cells}};
  run.scene = test::column_scene(Scheme::cpgimp, cells);
  run.scene.termination = AtTime{0.02};
  return run;
}

Case columns(std::initializer_list<int> cells) {
  Case definition;
  definition.id = "columns";
  for (const int count : cells) definition.runs.push_back(column(count));
  TradeRequest trade;
  trade.title = "crossings";
  trade.metric = "cell_crossings";
  trade.asked = {1.0};
  definition.trades = {trade};
  Gate gate;
  gate.id = "runs_to_the_end";
  gate.metric = "completed";
  gate.comparison = Comparison::at_least;
  gate.threshold = 1.0;
  definition.gates = {gate};
  return definition;
}

/// Of 1000 steps, of which each takes 1 ms, at first and at last.
Record recorded(const Case& definition, std::size_t run) {
  Record record;
  record.input_hash = input_hash(definition, definition.runs[run]);
  record.cost = {.wall_seconds = 1.0, .steps = 1000, .early_seconds = 0.2, .early_steps = 200};
  return record;
}

std::vector<Record> recorded(const Case& definition) {
  std::vector<Record> records;
  for (std::size_t run = 0; run < definition.runs.size(); ++run) records.push_back(recorded(definition, run));
  return records;
}

/// Times nothing: hands out what it is told to, and notes who was asked for and for how long.
struct FakeClock {
  std::vector<int> asked = {};
  std::vector<double> seconds = {};
  std::map<int, std::vector<TimedSteps>> answers = {};  ///< by cells, in the order of the repeats

  TimedSteps operator()(const RunRequest& run, double until) {
    const int cells = run.parameters[0].second;
    const auto before = std::count(asked.begin(), asked.end(), cells);
    asked.push_back(cells);
    seconds.push_back(until);
    const auto known = answers.find(cells);
    if (known == answers.end()) return {.seconds = 0.2, .steps = 100, .whole = false};
    return known->second[static_cast<std::size_t>(before) % known->second.size()];
  }
};

const auto go_on = [] { return true; };

std::ptrdiff_t count_timed(const Timings& timings) {
  return std::count_if(timings.begin(), timings.end(), [](const auto& timing) { return timing.has_value(); });
}

/// A case, its records and a place to store what is measured.
struct TimingTest : testing::Test {
  tests::ScratchDirectory scratch;
  Case definition = columns({10, 20, 30, 40});
  std::vector<Record> records = recorded(definition);
  FakeClock clock;
  Timekeeper timekeeper{"program", "processor", 4,
                        [this](const RunRequest& run, double until) { return clock(run, until); }};

  fs::path file() const { return timing_file(scratch.path(), definition); }
  CaseTiming timing() const { return CaseTiming(definition, records, file(), timekeeper); }
  Timings timed() const {
    CaseTiming all = timing();
    EXPECT_TRUE(all.run(go_on));
    return all.timings();
  }
  std::string stored() const {
    std::ifstream stream(file(), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
};

// ---- how ----

TEST_F(TimingTest, every_round_has_every_run_once_in_an_order_of_its_own) {
  timed();
  ASSERT_EQ(clock.asked.size(), 20u);
  std::vector<std::vector<int>> rounds;
  for (std::size_t round = 0; round < 5; ++round) {
    const auto begin = clock.asked.begin() + static_cast<std::ptrdiff_t>(4 * round);
    rounds.emplace_back(begin, begin + 4);
    std::vector<int> sorted = rounds.back();
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, (std::vector<int>{10, 20, 30, 40}));
  }
  std::sort(rounds.begin(), rounds.end());
  EXPECT_EQ(std::unique(rounds.begin(), rounds.end()), rounds.end()) << "two rounds have one order";
  const std::vector<int> first = clock.asked;
  clock.asked.clear();
  fs::remove(file());
  timed();
  EXPECT_EQ(clock.asked, first);
}

TEST(CaseTiming, orders_are_permutations) {
  for (const std::size_t runs : {1u, 2u, 3u, 100u}) {
    std::vector<std::size_t> all(runs);
    std::iota(all.begin(), all.end(), std::size_t{0});
    for (std::size_t round = 0; round < CaseTiming::rounds; ++round) {
      const std::vector<std::size_t> order = CaseTiming::order_of_round(round, runs);
      EXPECT_TRUE(std::is_permutation(order.begin(), order.end(), all.begin(), all.end()));
    }
  }
  EXPECT_TRUE(CaseTiming::order_of_round(0, 0).empty());
}

TEST_F(TimingTest, a_repeat_goes_on_for_150_ms_or_less_of_very_many_runs) {
  timed();
  for (const double seconds : clock.seconds) EXPECT_EQ(seconds, 0.15);
  EXPECT_EQ(CaseTiming::seconds_of_repeat(80), 0.15);
  EXPECT_DOUBLE_EQ(CaseTiming::seconds_of_repeat(240), 0.05);
}

// ---- what is made of it ----

TEST_F(TimingTest, the_rate_of_the_first_steps_is_that_of_the_run) {
  const Timings timings = timed();
  ASSERT_EQ(timings.size(), 4u);
  // 2 ms a step, of 1000.
  EXPECT_DOUBLE_EQ(timings[2]->median, 2.0);
  EXPECT_DOUBLE_EQ(timings[2]->low, 2.0);
  EXPECT_DOUBLE_EQ(timings[2]->high, 2.0);
  EXPECT_EQ(timings[2]->repeats, 5);
  EXPECT_FALSE(timings[2]->whole);
}

TEST_F(TimingTest, median_and_range_are_those_of_the_rounds) {
  for (const double seconds : {0.5, 0.1, 0.4, 0.2, 0.3}) clock.answers[20].push_back({seconds, 100, false});
  const Timings timings = timed();
  EXPECT_DOUBLE_EQ(timings[1]->median, 3.0);
  EXPECT_DOUBLE_EQ(timings[1]->low, 1.0);
  EXPECT_DOUBLE_EQ(timings[1]->high, 5.0);
  EXPECT_DOUBLE_EQ(timings[0]->high, 2.0);
}

TEST_F(TimingTest, steps_that_grow_dearer_scale_the_first) {
  records[1].cost.early_steps = 400;   // 0.5 ms a step at first, 1 ms on average
  records[2].cost.wall_seconds = 0.5;  // 1 ms at first, 0.5 ms on average
  const Timings timings = timed();
  EXPECT_DOUBLE_EQ(timings[0]->median, 2.0);
  EXPECT_DOUBLE_EQ(timings[1]->median, 4.0);
  EXPECT_DOUBLE_EQ(timings[2]->median, 1.0);
}

TEST_F(TimingTest, a_record_that_knows_no_early_steps_scales_nothing) {
  records[0].cost.early_seconds = 0.0;
  records[1].cost.early_steps = 0;
  const Timings timings = timed();
  EXPECT_DOUBLE_EQ(timings[0]->median, 2.0);
  EXPECT_DOUBLE_EQ(timings[1]->median, 2.0);
}

TEST_F(TimingTest, a_whole_run_takes_what_it_took) {
  clock.answers[10] = {{0.07, 1000, true}};
  clock.answers[20] = {{0.07, 1000, true}, {0.15, 1000, false}, {0.07, 1000, true}};
  records[0].cost.early_steps = 400;
  const Timings timings = timed();
  EXPECT_DOUBLE_EQ(timings[0]->median, 0.07);
  EXPECT_TRUE(timings[0]->whole);
  EXPECT_DOUBLE_EQ(timings[1]->high, 0.15);
  EXPECT_FALSE(timings[1]->whole);
}

TEST_F(TimingTest, a_run_that_did_not_complete_is_not_timed) {
  records[1].outcome.ending = Ending::not_finite;
  records[3].failure = "no memory";
  const Timings timings = timed();
  EXPECT_EQ(clock.asked.size(), 10u);
  EXPECT_TRUE(timings[0] && timings[2]);
  EXPECT_FALSE(timings[1] || timings[3]);
  for (Record& record : records) record.failure = "no memory";
  EXPECT_EQ(timing().repeats_left(), 0u);
  EXPECT_EQ(count_timed(timed()), 0);
}

// ---- what is taken over ----

TEST_F(TimingTest, is_taken_over_as_long_as_all_is_the_same) {
  const Timings first = timed();
  clock.asked.clear();
  EXPECT_EQ(timing().repeats_left(), 0u);
  const Timings again = timed();
  EXPECT_TRUE(clock.asked.empty());
  EXPECT_EQ(again[3]->median, first[3]->median);
  for (const auto& entry : fs::directory_iterator(file().parent_path())) EXPECT_EQ(entry.path(), file());
}

TEST_F(TimingTest, is_done_again_by_another_program_or_machine) {
  timed();
  const Timekeeper before = timekeeper;
  timekeeper.program = "another";
  EXPECT_EQ(timing().repeats_left(), 20u);
  timekeeper = before;
  timekeeper.processor = "another";
  EXPECT_EQ(timing().repeats_left(), 20u);
  timekeeper = before;
  timekeeper.cores = 2;
  EXPECT_EQ(timing().repeats_left(), 20u);
  timekeeper = before;
  EXPECT_EQ(timing().repeats_left(), 0u);
}

TEST_F(TimingTest, is_done_again_for_other_inputs) {
  timed();
  records[2].input_hash = "another";
  EXPECT_EQ(timing().repeats_left(), 20u);
  records = recorded(definition);
  std::swap(records[1], records[2]);
  EXPECT_EQ(timing().repeats_left(), 20u);
  records = recorded(definition);
  records[2].failure = "it fails by now";
  EXPECT_EQ(timing().repeats_left(), 15u);
  records = recorded(definition);
  EXPECT_EQ(timing().repeats_left(), 0u);
}

TEST_F(TimingTest, is_done_again_if_the_file_is_not_what_was_written) {
  timed();
  const std::string good = stored();
  std::string altered = good;
  altered.replace(altered.find("0.2"), 3, "0.1");
  for (const std::string& bad :
       {altered, good.substr(0, good.size() / 2), std::string(), std::string("{}"), std::string("[]")}) {
    std::ofstream(file(), std::ios::binary) << bad;
    EXPECT_EQ(timing().repeats_left(), 20u) << bad.substr(0, 40);
  }
  std::ofstream(file(), std::ios::binary) << good;
  EXPECT_EQ(timing().repeats_left(), 0u);
}

TEST_F(TimingTest, a_time_of_nothing_is_not_taken_over) {
  clock.answers[10] = {{0.0, 100, false}};
  timed();
  EXPECT_EQ(timing().repeats_left(), 20u);
}

// ---- interruptions ----

TEST_F(TimingTest, keeps_the_rounds_that_were_finished) {
  int repeats = 0;
  CaseTiming first = timing();
  EXPECT_FALSE(first.run([&] { return ++repeats < 10; }));  // two rounds and a half
  EXPECT_EQ(count_timed(first.timings()), 0);
  EXPECT_EQ(clock.asked.size(), 10u);
  CaseTiming second = timing();
  EXPECT_EQ(second.repeats_left(), 12u);
  EXPECT_TRUE(second.run(go_on));
  EXPECT_EQ(clock.asked.size(), 22u);
  EXPECT_EQ(second.timings()[0]->repeats, 5);
  // The third round began anew, in its own order.
  const std::vector<std::size_t> order = CaseTiming::order_of_round(2, 4);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(clock.asked[10 + k], 10 * static_cast<int>(order[k] + 1));
}

TEST_F(TimingTest, a_round_that_was_just_finished_is_kept) {
  int repeats = 0;
  EXPECT_FALSE(timing().run([&] { return ++repeats < 8; }));
  EXPECT_EQ(timing().repeats_left(), 12u);
  repeats = 0;
  EXPECT_TRUE(timing().run([&] { return ++repeats < 12; })) << "all was done when it was to end";
}

// ---- real steps ----

TEST(TimeFirstSteps, stops_after_the_time_or_with_the_run) {
  const RunRequest run = column(20);
  const TimedSteps all = time_first_steps(run, 1e3);
  EXPECT_TRUE(all.whole);
  Simulation simulation(run.scene);
  while (simulation.advance()) {
  }
  EXPECT_EQ(all.steps, simulation.steps());
  EXPECT_GT(all.seconds, 0.0);
  RunRequest endless = run;
  endless.scene.termination = AtTime{1e6};
  const TimedSteps some = time_first_steps(endless, 0.01);
  EXPECT_FALSE(some.whole);
  EXPECT_GE(some.seconds, 0.01);
  EXPECT_GT(some.steps, 0);
  const TimedSteps fewest = time_first_steps(endless, 0.0);
  EXPECT_GE(fewest.steps, 1);
  EXPECT_LT(fewest.steps, some.steps);
}

// ---- campaigns ----

TEST(TimedCampaign, times_cases_with_trades_after_their_runs) {
  const tests::ScratchDirectory scratch;
  Case traded = columns({5, 10}), plain = columns({5});
  plain.id = "plain";
  plain.trades.clear();
  int executed = 0;
  std::vector<int> executed_before;
  FakeClock clock;
  const Execute execute = [&](const Case& definition, const RunRequest& run, const Pulse& pulse) {
    ++executed;
    return simulate(definition, run, pulse);
  };
  const TimeSteps time_steps = [&](const RunRequest& run, double seconds) {
    executed_before.push_back(executed);
    return clock(run, seconds);
  };
  const CampaignVerdict verdict = run_campaign({traded, plain}, {.out = scratch.path()}, execute, time_steps);
  EXPECT_EQ(executed_before, std::vector<int>(10, 3));
  EXPECT_GT(verdict.timing_seconds, 0.0);
  ASSERT_TRUE(verdict.cases[0].trades[0].points[1].timing);
  const double steps = verdict.cases[0].runs[1].metrics.at("steps");
  EXPECT_GT(verdict.cases[0].trades[0].points[1].timing->median, 0.0);
  EXPECT_EQ(verdict.cases[0].trades[0].points[1].work.particle_steps, 10 * steps);
  EXPECT_FALSE(fs::exists(timing_file(scratch.path(), plain)));
  // Once more, and nothing is left to time.
  const CampaignVerdict again = run_campaign({traded, plain}, {.out = scratch.path()}, execute, time_steps);
  EXPECT_EQ(executed_before.size(), 10u);
  EXPECT_EQ(again.timing_seconds, 0.0);
  EXPECT_EQ(again.cases[0].trades[0].points[1].timing->median,
            verdict.cases[0].trades[0].points[1].timing->median);
}

TEST(TimedCampaign, leaves_records_and_metrics_alone) {
  const tests::ScratchDirectory one, other;
  const std::vector<Case> cases = {columns({5, 10})};
  FakeClock swift, slow;
  slow.answers[5] = {{7.0, 10, false}};
  const CampaignVerdict a = run_campaign(cases, {.out = one.path()}, simulate, std::ref(swift));
  const CampaignVerdict b = run_campaign(cases, {.out = other.path()}, simulate, std::ref(slow));
  for (std::size_t run : {0u, 1u}) {
    EXPECT_EQ(a.cases[0].runs[run].metrics, b.cases[0].runs[run].metrics);
    EXPECT_EQ(a.cases[0].runs[run].record.digest, b.cases[0].runs[run].record.digest);
  }
  EXPECT_GT(b.cases[0].trades[0].points[0].timing->median, a.cases[0].trades[0].points[0].timing->median);
}

TEST(TimedCampaign, stops_on_a_signal_and_continues_later) {
  const tests::ScratchDirectory scratch;
  const std::vector<Case> cases = {columns({5, 10})};
  FakeClock clock;
  const TimeSteps interrupted = [&](const RunRequest& run, double seconds) {
    if (clock.asked.size() == 4) raise(SIGINT);
    return clock(run, seconds);
  };
  try {
    run_campaign(cases, {.out = scratch.path()}, simulate, interrupted);
    ADD_FAILURE() << "the campaign was not interrupted";
  } catch (const Interrupted& stop) {
    EXPECT_NE(std::string(stop.what()).find("all runs are stored"), std::string::npos) << stop.what();
  }
  EXPECT_EQ(clock.asked.size(), 5u);
  clock.asked.clear();
  const CampaignVerdict resumed = run_campaign(cases, {.out = scratch.path()}, simulate, std::ref(clock));
  EXPECT_EQ(clock.asked.size(), 6u);
  EXPECT_EQ(resumed.reused, 2);
  EXPECT_TRUE(resumed.cases[0].trades[0].points[0].timing);
}

TEST(TimedCampaign, is_in_the_results) {
  const tests::ScratchDirectory scratch;
  Case definition = columns({5, 10});
  for (RunRequest& run : definition.runs) {
    run.parameters.insert(run.parameters.begin(), {"/scene/gravity/level", 1});
    run.parameters.push_back({"kind", "other"});
    run.changes = {Json::parse(R"({"set": {"/scene/gravity/level": 1}, "remove": []})"),
                   Json{{"set", {{"/scene/cells", run.parameters[1].second}}}, {"remove", Json::array()}},
                   Json::parse(R"({"set": {"/scene/scheme": "mpm"}, "remove": ["/scene/damping"]})")};
  }
  definition.trades[0].problems = {"/scene/gravity/level"};
  definition.trades[0].family = "kind";
  const TimeSteps time_steps = [](const RunRequest&, double) { return TimedSteps{0.2, 100, false}; };
  const CampaignVerdict verdict = run_campaign({definition}, {.out = scratch.path()}, simulate, time_steps);
  const Json results = to_json(verdict);
  EXPECT_EQ(results["timing_seconds"], verdict.timing_seconds);
  const Json& trade = results["cases"][0]["trades"].at(0);
  EXPECT_EQ(trade["title"], "crossings");
  EXPECT_EQ(trade["problem"], Json::parse(R"({"/scene/gravity/level": 1})"));
  EXPECT_EQ(trade["error_name"], "cell_crossings");
  EXPECT_EQ(
      trade["reference"],
      Json::parse(R"({"source": "cell_crossings", "uncertainty": 0.0, "x": [], "y": [], "spread": []})"));
  const TradePoint& point = verdict.cases[0].trades[0].points[1];
  EXPECT_EQ(trade["points"].at(1), (Json{{"run", 1},
                                         {"configuration", {{"/scene/cells", 10}, {"kind", "other"}}},
                                         {"changes",
                                          {{"set", {{"/scene/cells", 10}, {"/scene/scheme", "mpm"}}},
                                           {"remove", Json::array({"/scene/damping"})}}},
                                         {"family", "other"},
                                         {"cell_size", 0.1},
                                         {"error", point.error},
                                         {"uncertainty", 0.0},
                                         {"failure", ""},
                                         {"of_reference", false},
                                         {"seconds",
                                          {{"median", point.timing->median},
                                           {"low", point.timing->low},
                                           {"high", point.timing->high},
                                           {"repeats", 5},
                                           {"whole", false}}},
                                         {"particle_steps", point.work.particle_steps},
                                         {"bytes", point.work.bytes},
                                         {"operations", point.work.operations},
                                         {"on_time_front", point.on_time_front},
                                         {"on_work_front", point.on_work_front}}));
}

TEST(TimedCampaign, what_failed_has_neither_error_nor_time_in_the_results) {
  const tests::ScratchDirectory scratch;
  const Execute failing = [](const Case& definition, const RunRequest& run, const Pulse& pulse) {
    if (run.parameters[0].second == 10) throw std::runtime_error("no memory");
    return simulate(definition, run, pulse);
  };
  FakeClock clock;
  const Json results =
      to_json(run_campaign({columns({5, 10})}, {.out = scratch.path()}, failing, std::ref(clock)));
  const Json& point = results["cases"][0]["trades"][0]["points"][1];
  EXPECT_EQ(point["failure"], "run failed: no memory");
  for (const char* key : {"error", "uncertainty", "seconds"}) EXPECT_TRUE(point[key].is_null()) << key;
}

TEST(RecordedCost, knows_how_long_the_early_steps_took) {
  const Case definition = columns({10});
  const Record brief = simulate(definition, definition.runs[0]);
  EXPECT_EQ(brief.cost.early_steps, brief.cost.steps);
  EXPECT_EQ(brief.cost.early_seconds, brief.cost.wall_seconds);
  RunRequest longer = definition.runs[0];
  longer.scene.termination = AtTime{1e6};
  std::int64_t done = 0;
  const auto start = std::chrono::steady_clock::now();
  const Pulse half_a_second = [&](std::int64_t steps) {
    done += steps;
    return std::chrono::steady_clock::now() - start < std::chrono::milliseconds(500);
  };
  EXPECT_THROW(simulate(definition, longer, half_a_second), Abandoned);
  // As many steps as that are done in half a second, a good while beyond the early ones.
  longer.scene.termination = AtTime{static_cast<double>(done / 10) * Simulation(longer.scene).time_step()};
  const Record record = simulate(definition, longer);
  EXPECT_GT(record.cost.early_steps, 0);
  EXPECT_LT(record.cost.early_steps, record.cost.steps);
  EXPECT_GE(record.cost.early_seconds, 0.15);
  EXPECT_LT(record.cost.early_seconds, record.cost.wall_seconds);
}

}  // namespace
}  // namespace mpm::vv
