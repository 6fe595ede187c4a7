#include "vv/campaign.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <fstream>
#include <iterator>
#include <mutex>
#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "tests/support/column_scene.hpp"
#include "tests/support/scratch_directory.hpp"

namespace mpm::vv {
namespace {

namespace fs = std::filesystem;

RunRequest request(int cells) {
  RunRequest made;
  made.parameters = {{"/scene/cells", cells}};
  made.scene_text = {{"cells", cells}};
  Scene& scene = made.scene;
  scene = test::column_scene(Scheme::cpgimp, cells);
  scene.damping = 0.0;
  scene.termination = AtTime{0.02};
  return made;
}

Case columns(const std::string& id, std::initializer_list<int> cells) {
  Case definition;
  definition.id = id;
  for (int count : cells) definition.runs.push_back(request(count));
  Gate gate;
  gate.id = "runs_to_the_end";
  gate.metric = "completed";
  gate.comparison = Comparison::at_least;
  gate.threshold = 1.0;
  definition.gates = {gate};
  return definition;
}

/// Simulates and notes which runs were asked for, in the order they were.
class Counting {
 public:
  Record operator()(const Case& definition, const RunRequest& of, const Pulse& pulse) {
    {
      const std::lock_guard lock(mutex_);
      executed_.push_back(of.parameters[0].second.get<int>());
    }
    return simulate(definition, of, pulse);
  }
  std::vector<int> executed() const { return executed_; }
  void forget() { executed_.clear(); }

 private:
  std::mutex mutex_;
  std::vector<int> executed_;
};

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void overwrite(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::vector<std::string> digests_of(const CampaignVerdict& verdict) {
  std::vector<std::string> digests;
  for (const CaseVerdict& of : verdict.cases) {
    for (const RunVerdict& run : of.runs) digests.push_back(run.record.digest);
  }
  return digests;
}

TEST(Campaign, JudgesEveryCaseInTheOrderGiven) {
  const tests::ScratchDirectory scratch;
  const CampaignVerdict verdict =
      run_campaign({columns("zebra", {10}), columns("ant", {10, 20})}, {.out = scratch.path(), .threads = 2});
  ASSERT_EQ(verdict.cases.size(), 2u);
  EXPECT_EQ(verdict.cases[0].definition.id, "zebra");
  EXPECT_EQ(verdict.cases[1].runs.size(), 2u);
  EXPECT_EQ(verdict.cases[1].runs[1].record.profile.stress.size(), 20u);
  EXPECT_TRUE(verdict.passed());
  EXPECT_EQ(verdict.threads, 2);
  EXPECT_GT(verdict.wall_seconds, 0.0);
}

TEST(Campaign, SaysWhereItComesFrom) {
  const tests::ScratchDirectory scratch;
  const CampaignVerdict verdict = run_campaign({columns("one", {5})}, {.out = scratch.path()});
  EXPECT_FALSE(verdict.revision.empty());
  EXPECT_FALSE(verdict.host.empty());
  EXPECT_FALSE(verdict.processor.empty());
  EXPECT_FALSE(verdict.compiler.empty());
  EXPECT_FALSE(verdict.build.empty());
  ASSERT_EQ(verdict.date.size(), 20u) << verdict.date;  // 2000-01-01T00:00:00Z
  EXPECT_EQ(verdict.date[10], 'T');
  EXPECT_EQ(verdict.date.back(), 'Z');
}

TEST(Campaign, GivesTheSameBitsOnAnyNumberOfThreads) {
  std::vector<std::vector<std::string>> digests;
  for (int threads : {1, 2, 4}) {
    const tests::ScratchDirectory scratch;
    digests.push_back(digests_of(
        run_campaign({columns("some", {10, 40, 20, 30, 15})}, {.out = scratch.path(), .threads = threads})));
  }
  ASSERT_EQ(digests[0].size(), 5u);
  EXPECT_NE(digests[0][0], digests[0][1]);
  EXPECT_EQ(digests[0], digests[1]);
  EXPECT_EQ(digests[0], digests[2]);
}

TEST(Campaign, RunsTheLongestFirst) {
  const tests::ScratchDirectory scratch;
  Counting counting;
  run_campaign({columns("some", {10, 40, 20})}, {.out = scratch.path(), .threads = 1}, std::ref(counting));
  EXPECT_EQ(counting.executed(), (std::vector<int>{40, 20, 10}));
}

TEST(Campaign, ReusesStoredRecords) {
  const tests::ScratchDirectory scratch;
  const std::vector<Case> cases = {columns("some", {10, 20})};
  const CampaignOptions options{.out = scratch.path()};
  Counting counting;
  const CampaignVerdict first = run_campaign(cases, options, std::ref(counting));
  EXPECT_EQ(first.reused, 0);
  counting.forget();
  const CampaignVerdict second = run_campaign(cases, options, std::ref(counting));
  EXPECT_TRUE(counting.executed().empty());
  EXPECT_EQ(second.reused, 2);
  EXPECT_EQ(digests_of(first), digests_of(second));
  EXPECT_EQ(first.cases[0].runs[0].record.profile.stress, second.cases[0].runs[0].record.profile.stress);
}

TEST(Campaign, RunsAgainWhenTheInputChanged) {
  const tests::ScratchDirectory scratch;
  const CampaignOptions options{.out = scratch.path()};
  Case definition = columns("some", {10, 20});
  run_campaign({definition}, options);
  definition.runs[0].scene_text["damping"] = 0.5;
  Counting counting;
  EXPECT_EQ(run_campaign({definition}, options, std::ref(counting)).reused, 1);
  EXPECT_EQ(counting.executed(), std::vector<int>{10});
}

TEST(Campaign, RunsAgainWhenARecordIsDamaged) {
  const std::vector<Case> cases = {columns("some", {10})};
  const auto damaged_by = [&](const std::function<std::string(std::string)>& damage) {
    const tests::ScratchDirectory scratch;
    const CampaignOptions options{.out = scratch.path()};
    const std::string digest = digests_of(run_campaign(cases, options))[0];
    const fs::path file = record_file(scratch.path(), cases[0], 0);
    const std::string whole = text_of(file);
    EXPECT_GT(whole.size(), 500u);
    overwrite(file, damage(whole));
    Counting counting;
    const CampaignVerdict verdict = run_campaign(cases, options, std::ref(counting));
    EXPECT_EQ(digests_of(verdict)[0], digest);
    EXPECT_EQ(Json::parse(text_of(file))["record"]["digest"], digest);
    return counting.executed().size();
  };
  EXPECT_EQ(damaged_by([](std::string whole) { return whole; }), 0u);
  EXPECT_EQ(damaged_by([](std::string whole) { return whole.substr(0, whole.size() / 2); }), 1u);
  EXPECT_EQ(damaged_by([](std::string) { return ""; }), 1u);
  EXPECT_EQ(damaged_by([](std::string) { return "{}"; }), 1u);
  const auto alter = [](const char* key, const Json& value) {
    return [=](std::string whole) {
      Json json = Json::parse(whole);
      json["record"][key] = value;
      return json.dump();
    };
  };
  EXPECT_EQ(damaged_by(alter("cell_crossings", 77)), 1u);
  EXPECT_EQ(damaged_by(alter("program_hash", "0")), 1u);
}

TEST(Campaign, RunsAgainForAnotherProgram) {
  const tests::ScratchDirectory scratch;
  const std::vector<Case> cases = {columns("some", {10})};
  const Execute of_another_program = [](const Case& definition, const RunRequest& of, const Pulse& pulse) {
    Record record = simulate(definition, of, pulse);
    record.program_hash = "0123456789abcdef";
    return record;
  };
  run_campaign(cases, {.out = scratch.path()}, of_another_program);
  EXPECT_EQ(run_campaign(cases, {.out = scratch.path()}).reused, 0);
  EXPECT_EQ(run_campaign(cases, {.out = scratch.path()}).reused, 1);
}

TEST(Campaign, TurnsAnExceptionIntoAFailedRunAndGoesOn) {
  const tests::ScratchDirectory scratch;
  const std::vector<Case> cases = {columns("some", {10, 20, 30})};
  const Execute sometimes = [](const Case& definition, const RunRequest& of, const Pulse& pulse) {
    if (of.parameters[0].second == 20) throw std::bad_alloc();
    if (of.parameters[0].second == 30) throw 42;
    return simulate(definition, of, pulse);
  };
  const CampaignVerdict verdict = run_campaign(cases, {.out = scratch.path(), .threads = 2}, sometimes);
  const auto& runs = verdict.cases[0].runs;
  EXPECT_TRUE(runs[0].record.completed());
  EXPECT_EQ(runs[1].record.failure, "std::bad_alloc");
  EXPECT_FALSE(runs[1].record.completed());
  EXPECT_FALSE(runs[2].record.failure.empty());
  EXPECT_EQ(verdict.cases[0].status, CaseStatus::fail);
  EXPECT_TRUE(verdict.failed());
  // What failed is tried again.
  EXPECT_EQ(run_campaign(cases, {.out = scratch.path()}).reused, 1);
}

TEST(Campaign, RepeatsOnAnotherNumberOfThreads) {
  Case definition = columns("some", {10, 20});
  definition.repeat_on_other_threads = true;
  for (int threads : {1, 2, 4}) {
    const tests::ScratchDirectory scratch;
    const CampaignOptions options{.out = scratch.path(), .threads = threads};
    const CampaignVerdict verdict = run_campaign({definition}, options);
    for (std::size_t run : {0u, 1u}) {
      EXPECT_EQ(verdict.cases[0].runs[run].metrics.at("bits_differ"), 0.0);
      const Json first = Json::parse(text_of(record_file(scratch.path(), definition, run)))["record"];
      const Json repeat = Json::parse(text_of(record_file(scratch.path(), definition, run, true)))["record"];
      EXPECT_EQ(first["threads"], threads);
      EXPECT_EQ(repeat["threads"], threads == 1 ? 2 : 1);
    }
    EXPECT_EQ(run_campaign({definition}, options).reused, 4);
  }
}

TEST(Campaign, RepeatsOnEveryNumberOfThreadsListed) {
  Case definition = columns("some", {10, 20});
  definition.repeat_on_threads = {2, 3, 8};
  const tests::ScratchDirectory scratch;
  const CampaignVerdict verdict = run_campaign({definition}, {.out = scratch.path()});
  for (std::size_t run : {0u, 1u}) {
    const RunVerdict& judged = verdict.cases[0].runs[run];
    EXPECT_EQ(judged.metrics.at("bits_differ"), 0.0);
    EXPECT_TRUE(judged.record.repeat_digest.empty());
    ASSERT_EQ(judged.record.repeats.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) {
      const int threads = definition.repeat_on_threads[k];
      EXPECT_EQ(judged.record.repeats[k], std::pair(threads, judged.record.digest));
      const Json repeat = Json::parse(text_of(record_file(scratch.path(), definition, run, true, threads)))["record"];
      EXPECT_EQ(repeat["step_threads"], threads);
    }
  }
  EXPECT_EQ(run_campaign({definition}, {.out = scratch.path()}).reused, 8);
}

TEST(Campaign, CountsTheRepeatsThatDiffer) {
  const tests::ScratchDirectory scratch;
  Case definition = columns("some", {10});
  definition.repeat_on_threads = {2, 3, 8};
  const Execute erratic = [&](const Case& of_case, const RunRequest& of, const Pulse& pulse) {
    RunRequest disturbed = of;
    if (of.threads > 2) disturbed.scene.gravity.level *= 1.0 + 1e-15;
    return simulate(of_case, disturbed, pulse);
  };
  const CampaignVerdict verdict = run_campaign({definition}, {.out = scratch.path()}, erratic);
  EXPECT_EQ(verdict.cases[0].runs[0].metrics.at("bits_differ"), 2.0);
}

TEST(Campaign, NoticesARepeatThatDiffers) {
  const tests::ScratchDirectory scratch;
  Case definition = columns("some", {10});
  definition.repeat_on_other_threads = true;
  std::atomic<int> calls = 0;
  const Execute erratic = [&](const Case& of_case, const RunRequest& of, const Pulse& pulse) {
    RunRequest disturbed = of;
    if (calls++ == 1) disturbed.scene.gravity.level = 1.0 + 1e-15;
    return simulate(of_case, disturbed, pulse);
  };
  const CampaignVerdict verdict = run_campaign({definition}, {.out = scratch.path()}, erratic);
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(verdict.cases[0].runs[0].metrics.at("bits_differ"), 1.0);
}

TEST(Campaign, ShowsWhatQuickLeavesOut) {
  const tests::ScratchDirectory scratch;
  Case slow = columns("slow", {10});
  slow.quick = false;
  const std::vector<Case> cases = {columns("swift", {10}), slow};
  const CampaignVerdict quick = run_campaign(cases, {.out = scratch.path(), .quick = true});
  ASSERT_EQ(quick.cases.size(), 2u);
  EXPECT_EQ(quick.cases[1].status, CaseStatus::not_run);
  EXPECT_FALSE(quick.cases[1].not_run_reason.empty());
  EXPECT_EQ(quick.counts().cases, 2);
  EXPECT_EQ(quick.counts().cases_not_run, 1);
  EXPECT_FALSE(quick.passed());
  EXPECT_FALSE(quick.failed());
  EXPECT_EQ(run_campaign(cases, {.out = scratch.path()}).counts().cases_not_run, 0);
}

TEST(Campaign, StopsOnASignalAndContinuesLater) {
  for (int threads : {1, 2}) {
    const tests::ScratchDirectory scratch;
    const std::vector<Case> cases = {columns("some", {40, 30, 20, 10})};
    const CampaignOptions options{.out = scratch.path(), .threads = threads};
    const Execute interrupted = [](const Case& definition, const RunRequest& of, const Pulse& pulse) {
      if (of.parameters[0].second == 20) {
        raise(SIGTERM);
        while (pulse(1)) std::this_thread::yield();
        throw Abandoned();
      }
      return simulate(definition, of, pulse);
    };
    try {
      run_campaign(cases, options, interrupted);
      ADD_FAILURE() << "the campaign was not interrupted";
    } catch (const Interrupted& stop) {
      EXPECT_NE(std::string(stop.what()).find("of 4 runs are stored"), std::string::npos) << stop.what();
    }
    int stored = 0;
    for (const auto& entry : fs::recursive_directory_iterator(scratch.path())) {
      if (entry.is_directory()) continue;
      EXPECT_EQ(entry.path().extension(), ".json") << entry.path();
      EXPECT_TRUE(Json::accept(text_of(entry.path())));
      ++stored;
    }
    EXPECT_GE(stored, 1);
    EXPECT_FALSE(fs::exists(record_file(scratch.path(), cases[0], 2)));
    EXPECT_FALSE(fs::exists(record_file(scratch.path(), cases[0], 3)));
    const CampaignVerdict resumed = run_campaign(cases, options);
    EXPECT_EQ(resumed.reused, stored);
    EXPECT_TRUE(resumed.passed());
  }
}

TEST(Campaign, ThrowsWhenARecordCannotBeStored) {
  const tests::ScratchDirectory scratch;
  const std::vector<Case> cases = {columns("some", {10, 20})};
  fs::create_directories(record_file(scratch.path(), cases[0], 0) / "in_the_way");
  EXPECT_THROW(run_campaign(cases, {.out = scratch.path(), .threads = 2}), std::system_error);
}

TEST(Campaign, RefusesNoThreadsAndTwinCases) {
  const tests::ScratchDirectory scratch;
  EXPECT_THROW(run_campaign({columns("some", {10})}, {.out = scratch.path(), .threads = 0}),
               std::invalid_argument);
  EXPECT_THROW(run_campaign({columns("some", {10}), columns("some", {20})}, {.out = scratch.path()}),
               std::invalid_argument);
}

TEST(RecordFile, TellsTheSweptValuesAndIsUnique) {
  Case definition;
  definition.id = "some";
  definition.runs.resize(4);
  definition.runs[0].parameters = {{"/scene/gravity/level", 50}, {"/scene/grid/cell_size", "0.02 m"}};
  definition.runs[1].parameters = {{"/scene/body", {{"a", "x/../y"}}}};
  EXPECT_EQ(record_file("out", definition, 0), "out/records/some/level=50,cell_size=0.02m.json");
  EXPECT_EQ(record_file("out", definition, 0, true), "out/records/some/level=50,cell_size=0.02m.repeat.json");
  EXPECT_EQ(record_file("out", definition, 1).parent_path(), "out/records/some");
  definition.runs[0].parameters = {{"setting", "half the rate, 50"}, {"/scene/gravity/level", 50}};
  EXPECT_EQ(record_file("out", definition, 0), "out/records/some/setting=half_the_rate__50,level=50.json");
  EXPECT_NE(record_file("out", definition, 2), record_file("out", definition, 3));
}

TEST(Estimate, CountsParticlesTimesSteps) {
  // c = 100 m/s, h = 0.1 m: a step of 0.2 h / c = 2e-4 s, so 100 steps of 10 particles.
  EXPECT_NEAR(estimated_particle_steps(request(10).scene), 1000.0, 1e-6);
  Scene given = request(10).scene;
  given.time_step = GivenTimeStep{1e-3};
  given.bodies[0].particles_per_cell[0] = 3;
  EXPECT_NEAR(estimated_particle_steps(given), 600.0, 1e-6);
}

}  // namespace
}  // namespace mpm::vv
