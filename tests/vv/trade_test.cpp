// Errors, references and fronts of runs whose metrics and curves are known.

#include "vv/trade.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/case_texts.hpp"
#include "vv/gates.hpp"
#include "vv/step_cost.hpp"

namespace mpm::vv {
namespace {

constexpr const char* method = "method";
constexpr const char* level = "/scene/gravity/level";

/// A run of a method at a level of gravity, which ends well.
struct Setting {
  std::string method;
  int level = 1;
};

Case methods(const std::vector<Setting>& settings) {
  Case definition;
  definition.id = "methods";
  for (const Setting& setting : settings) {
    RunRequest run;
    run.parameters = {{level, setting.level}, {method, setting.method}};
    run.scene.cell_size = 0.5;
    definition.runs.push_back(run);
  }
  return definition;
}

RunVerdict ended(const RunRequest& request, double particle_steps = 1.0) {
  RunVerdict run;
  run.parameters = request.parameters;
  run.record.cost.particle_steps = static_cast<std::int64_t>(particle_steps);
  return run;
}

std::vector<RunVerdict> all_ended(const Case& definition) {
  std::vector<RunVerdict> runs;
  for (const RunRequest& request : definition.runs) runs.push_back(ended(request));
  return runs;
}

/// y = factor x + offset, from `begin` to `end` in 400 steps.
Curve line(double factor, double offset = 0.0, double begin = 0.0, double end = 1.0) {
  Curve curve{"load", "run", {}, {}, "settlement"};
  for (int k = 0; k <= 400; ++k) {
    curve.x.push_back(begin + (end - begin) * k / 400);
    curve.y.push_back(factor * curve.x.back() + offset);
  }
  return curve;
}

TradeRequest of_metric() {
  TradeRequest request;
  request.title = "stress";
  request.metric = "hencky.stress.l2";
  request.asked = {0.1};
  return request;
}

TradeRequest of_curve(const std::vector<std::string>& finest = {"a", "b"}) {
  TradeRequest request;
  request.title = "load curve";
  request.curve = "load";
  for (const std::string& name : finest) request.finest.push_back({{method, {name}}});
  request.from = 0.0;
  request.up_to = 1.0;
  request.asked = {0.1};
  return request;
}

// ---- metrics ----

TEST(Trade, the_magnitude_of_a_metric_is_the_error) {
  Case definition = methods({{"a"}, {"b"}});
  definition.trades = {of_metric()};
  definition.trades[0].family = method;
  std::vector<RunVerdict> runs = all_ended(definition);
  runs[0].metrics["hencky.stress.l2"] = 0.02;
  runs[1].metrics["hencky.stress.l2"] = -0.03;
  const std::vector<TradeVerdict> verdicts = judge_trades(definition, runs, {});
  ASSERT_EQ(verdicts.size(), 1u);
  const TradeVerdict& verdict = verdicts[0];
  EXPECT_EQ(verdict.title, "stress");
  EXPECT_EQ(verdict.error_name, "hencky.stress.l2");
  EXPECT_EQ(verdict.reference.source, "hencky");
  EXPECT_EQ(verdict.reference.uncertainty, 0.0);
  EXPECT_TRUE(verdict.reference.x.empty());
  ASSERT_EQ(verdict.points.size(), 2u);
  EXPECT_EQ(verdict.points[0].error, 0.02);
  EXPECT_EQ(verdict.points[1].error, 0.03);
  EXPECT_EQ(verdict.points[1].bound(), 0.03);
  EXPECT_EQ(verdict.points[1].run, 1u);
  EXPECT_EQ(verdict.points[1].family, "b");
  EXPECT_EQ(verdict.points[1].cell_size, 0.5);
  EXPECT_EQ(verdict.points[1].failure, "");
  EXPECT_FALSE(verdict.points[1].of_reference);
  EXPECT_FALSE(verdict.points[1].timing);
}

TEST(Trade, says_why_a_run_has_no_error) {
  Case definition = methods({{"a"}, {"b"}, {"c"}});
  definition.trades = {of_metric()};
  std::vector<RunVerdict> runs = all_ended(definition);
  for (RunVerdict& run : runs) run.metrics["hencky.stress.l2"] = 0.02;
  runs[0].record.outcome = {.ending = Ending::outside_grid, .step = 12, .time = 0.5, .particle = 3};
  runs[1].metrics.clear();
  runs[2].record.failure = "no memory";
  const TradeVerdict verdict = judge_trades(definition, runs, {}).at(0);
  EXPECT_TRUE(verdict.points[0].failure.starts_with("run ended outside_grid at step 12"))
      << verdict.points[0].failure;
  EXPECT_EQ(verdict.points[1].failure, "the run completed but hencky.stress.l2 was not measured");
  EXPECT_EQ(verdict.points[2].failure, "run failed: no memory");
  for (const TradePoint& point : verdict.points) {
    EXPECT_TRUE(std::isnan(point.error));
    EXPECT_FALSE(point.on_work_front || point.on_time_front);
  }
}

TEST(Trade, each_problem_is_weighed_by_itself) {
  Case definition = methods({{"a", 1}, {"a", 50}, {"b", 1}, {"b", 50}});
  definition.trades = {of_metric(), of_metric()};
  definition.trades[0].problems = {level};
  definition.trades[1].title = "all the same";
  std::vector<RunVerdict> runs = all_ended(definition);
  const std::vector<TradeVerdict> verdicts = judge_trades(definition, runs, {});
  ASSERT_EQ(verdicts.size(), 3u);
  using Parameters = std::vector<std::pair<std::string, Json>>;
  EXPECT_EQ(verdicts[0].problem, (Parameters{{level, 1}}));
  EXPECT_EQ(verdicts[1].problem, (Parameters{{level, 50}}));
  ASSERT_EQ(verdicts[1].points.size(), 2u);
  EXPECT_EQ(verdicts[1].points[1].run, 3u);
  EXPECT_EQ(verdicts[1].points[1].configuration, (Parameters{{method, "b"}}));
  EXPECT_TRUE(verdicts[2].problem.empty());
  EXPECT_EQ(verdicts[2].points.size(), 4u);
  EXPECT_EQ(verdicts[2].points[1].configuration, (Parameters{{level, 50}, {method, "a"}}));
}

// ---- curves ----

TEST(Trade, the_error_of_a_curve_is_its_distance_from_the_mean_of_the_finest) {
  Case definition = methods({{"a"}, {"b"}, {"c"}});
  definition.trades = {of_curve()};
  std::vector<RunVerdict> runs = all_ended(definition);
  runs[0].curves = {line(1.9)};
  runs[1].curves = {line(2.1)};
  runs[2].curves = {line(2.2)};
  const TradeVerdict verdict = judge_trades(definition, runs, {}).at(0);
  EXPECT_EQ(verdict.error_name, "load");
  ASSERT_EQ(verdict.reference.x.size(), 200u);
  EXPECT_EQ(verdict.reference.x.front(), 0.0);
  EXPECT_EQ(verdict.reference.x.back(), 1.0);
  EXPECT_NEAR(verdict.reference.y[199], 2.0, 1e-12);
  EXPECT_NEAR(verdict.reference.spread[199], 0.1, 1e-12);
  EXPECT_NEAR(verdict.reference.uncertainty, 0.05, 1e-12);
  EXPECT_EQ(verdict.reference.source, "mean of 1G, a and 1G, b");
  EXPECT_NEAR(verdict.points[2].error, 0.1, 1e-12);
  EXPECT_NEAR(verdict.points[2].uncertainty, 0.05, 1e-12);
  EXPECT_NEAR(verdict.points[2].bound(), 0.15, 1e-12);
  EXPECT_FALSE(verdict.points[2].of_reference);
}

TEST(Trade, the_distance_is_taken_in_the_square_over_the_stretch_alone) {
  Case definition = methods({{"a"}, {"b"}, {"c"}});
  definition.trades = {of_curve()};
  definition.trades[0].from = 0.25;
  definition.trades[0].up_to = 0.75;
  std::vector<RunVerdict> runs = all_ended(definition);
  runs[0].curves = runs[1].curves = {line(0.0, 2.0)};
  runs[2].curves = {line(1.0, 2.0)};
  // The integral of x^2 from 1/4 to 3/4 over that of 4.
  const double exact = std::sqrt((27.0 - 1.0) / 64 / 3 / (4.0 / 2));
  EXPECT_NEAR(judge_trades(definition, runs, {}).at(0).points[2].error, exact, 1e-5);
}

TEST(Trade, no_family_judges_itself) {
  Case definition = methods({{"a"}, {"b"}, {"c"}, {"d"}});
  definition.trades = {of_curve({"a", "b", "c"})};
  std::vector<RunVerdict> runs = all_ended(definition);
  const std::vector<double> factors = {1.0, 2.0, 4.0, 2.0};
  for (std::size_t k = 0; k < 4; ++k) runs[k].curves = {line(factors[k])};
  const TradeVerdict verdict = judge_trades(definition, runs, {}).at(0);
  EXPECT_NEAR(verdict.points[0].error, 2.0 / 3, 1e-12);    // from the mean of 2 and 4
  EXPECT_NEAR(verdict.points[1].error, 0.5 / 2.5, 1e-12);  // of 1 and 4
  EXPECT_NEAR(verdict.points[2].error, 2.5 / 1.5, 1e-12);  // of 1 and 2
  EXPECT_NEAR(verdict.points[3].error, 1.0 / 7, 1e-12);    // of all, 7 / 3
  for (const TradePoint& point : verdict.points) {
    EXPECT_EQ(point.of_reference, point.run < 3);
    EXPECT_NEAR(point.uncertainty, 1.5 / (7.0 / 3), 1e-12);
  }
}

TEST(Trade, a_family_of_two_runs_weighs_no_more_than_one_of_one) {
  Case definition = methods({{"a"}, {"a", 2}, {"b"}, {"c"}});
  definition.trades = {of_curve()};
  std::vector<RunVerdict> runs = all_ended(definition);
  const std::vector<double> factors = {1.0, 3.0, 4.0, 3.0};
  for (std::size_t k = 0; k < 4; ++k) runs[k].curves = {line(factors[k])};
  const TradeVerdict verdict = judge_trades(definition, runs, {}).at(0);
  EXPECT_NEAR(verdict.reference.y.back(), 3.0, 1e-12);
  EXPECT_NEAR(verdict.points[3].error, 0.0, 1e-12);
  EXPECT_NEAR(verdict.points[1].error, 0.25, 1e-12);  // 3 beside the 4 of the other family
}

TEST(Trade, each_problem_has_its_own_reference) {
  Case definition = methods({{"a", 1}, {"a", 2}, {"b", 1}, {"b", 2}, {"c", 1}, {"c", 2}});
  definition.trades = {of_curve()};
  definition.trades[0].problems = {level};
  std::vector<RunVerdict> runs = all_ended(definition);
  const std::vector<double> factors = {1.0, 10.0, 1.0, 10.0, 2.0, 20.0};
  for (std::size_t k = 0; k < 6; ++k) runs[k].curves = {line(factors[k])};
  const std::vector<TradeVerdict> verdicts = judge_trades(definition, runs, {});
  ASSERT_EQ(verdicts.size(), 2u);
  EXPECT_NEAR(verdicts[1].reference.y.back(), 10.0, 1e-12);
  EXPECT_EQ(verdicts[1].reference.source, "mean of a and b");
  for (const TradeVerdict& verdict : verdicts) EXPECT_NEAR(verdict.points[2].error, 1.0, 1e-12);
}

TEST(Trade, a_moving_mean_takes_the_noise_off) {
  Case definition = methods({{"a"}, {"b"}, {"c"}});
  definition.trades = {of_curve()};
  std::vector<RunVerdict> runs = all_ended(definition);
  for (RunVerdict& run : runs) run.curves = {line(0.0, 1.0)};
  for (std::size_t k = 0; k < runs[2].curves[0].y.size(); ++k)
    runs[2].curves[0].y[k] += k % 2 == 0 ? 0.5 : -0.5;
  EXPECT_GT(judge_trades(definition, runs, {}).at(0).points[2].error, 0.2);
  definition.trades[0].within = 0.05;
  EXPECT_LT(judge_trades(definition, runs, {}).at(0).points[2].error, 0.05);
}

TEST(Trade, a_curve_that_breaks_off_has_a_failure) {
  Case definition = methods({{"a"}, {"b"}, {"c"}, {"d"}, {"e"}});
  definition.trades = {of_curve()};
  std::vector<RunVerdict> runs = all_ended(definition);
  for (RunVerdict& run : runs) run.curves = {line(1.0)};
  runs[1].curves = {line(1.1)};
  runs[2].curves = {line(1.0, 0.0, 0.0, 0.9)};
  runs[3].curves.clear();
  runs[4].record.outcome.ending = Ending::not_finite;  // although the curve is whole
  const TradeVerdict verdict = judge_trades(definition, runs, {}).at(0);
  EXPECT_EQ(verdict.points[2].failure.find("the curve load goes from 0 to 0.9 m and does not reach"), 0u)
      << verdict.points[2].failure;
  EXPECT_EQ(verdict.points[3].failure, "the run has no curve load");
  EXPECT_TRUE(verdict.points[4].failure.starts_with("run ended not_finite"));
  for (std::size_t k = 2; k < 5; ++k) {
    EXPECT_TRUE(std::isnan(verdict.points[k].error));
    EXPECT_EQ(verdict.points[k].uncertainty, 0.0);
  }
  EXPECT_EQ(verdict.points[0].failure, "");
}

TEST(Trade, without_one_of_the_finest_nobody_is_judged) {
  Case definition = methods({{"a"}, {"b"}, {"c"}, {"d"}});
  definition.trades = {of_curve({"a", "b", "c"})};
  std::vector<RunVerdict> runs = all_ended(definition);
  for (RunVerdict& run : runs) run.curves = {line(1.0)};
  runs[1].record.outcome.ending = Ending::not_at_rest;
  const TradeVerdict verdict = judge_trades(definition, runs, {}).at(0);
  EXPECT_TRUE(verdict.reference.x.empty());
  for (const TradePoint& point : verdict.points) EXPECT_TRUE(std::isnan(point.error));
  EXPECT_EQ(verdict.points[3].failure.find("there is no reference: 1G, b: run ended not_at_rest"), 0u)
      << verdict.points[3].failure;
  EXPECT_EQ(verdict.points[1].failure.find("run ended not_at_rest"), 0u);
}

TEST(Trade, a_reference_of_nothing_has_no_distance) {
  Case definition = methods({{"a"}, {"b"}, {"c"}});
  definition.trades = {of_curve()};
  std::vector<RunVerdict> runs = all_ended(definition);
  runs[0].curves = runs[1].curves = {line(0.0)};
  runs[2].curves = {line(1.0)};
  EXPECT_EQ(judge_trades(definition, runs, {}).at(0).points[2].failure,
            "the distance from the reference is not a finite number");
}

// ---- fronts ----

/// Runs with these errors, seconds and particle-steps.
TradeVerdict weighed(const std::vector<std::array<double, 3>>& points) {
  Case definition = methods(std::vector<Setting>(points.size(), {"a"}));
  Body body;
  body.upper = {1.0, 0.0};
  for (RunRequest& run : definition.runs) run.scene.bodies = {body};
  definition.trades = {of_metric()};
  std::vector<RunVerdict> runs;
  Timings timings;
  for (std::size_t k = 0; k < points.size(); ++k) {
    runs.push_back(ended(definition.runs[k], points[k][2]));
    runs.back().metrics["hencky.stress.l2"] = points[k][0];
    if (points[k][1] > 0)
      timings.push_back(Timing{.median = points[k][1], .low = 1, .high = 9, .repeats = 5});
    else
      timings.push_back(std::nullopt);
  }
  return judge_trades(definition, runs, timings).at(0);
}

std::vector<std::size_t> front_of(const TradeVerdict& verdict, bool TradePoint::*front) {
  std::vector<std::size_t> on;
  for (const TradePoint& point : verdict.points)
    if (point.*front) on.push_back(point.run);
  return on;
}

TEST(TradeFront, holds_what_nothing_beats) {
  //                                    error sec. work
  const TradeVerdict verdict = weighed({{0.10, 1.0, 900},
                                        {0.05, 2.0, 800},
                                        {0.06, 2.5, 700},  // slower and worse than the one before
                                        {0.01, 5.0, 1000}});
  EXPECT_EQ(front_of(verdict, &TradePoint::on_time_front), (std::vector<std::size_t>{0, 1, 3}));
  EXPECT_EQ(front_of(verdict, &TradePoint::on_work_front), (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(verdict.points[1].timing->median, 2.0);
}

TEST(TradeFront, equals_are_all_on_it_and_of_two_as_good_the_cheaper) {
  const TradeVerdict verdict = weighed({{0.1, 1.0, 5}, {0.1, 1.0, 5}, {0.1, 2.0, 4}, {0.2, 1.0, 5}});
  EXPECT_EQ(front_of(verdict, &TradePoint::on_time_front), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(front_of(verdict, &TradePoint::on_work_front), (std::vector<std::size_t>{2}));
}

TEST(TradeFront, who_was_not_timed_is_not_on_that_of_time) {
  const TradeVerdict verdict = weighed({{0.1, 0.0, 5}, {0.2, 3.0, 6}});
  EXPECT_EQ(front_of(verdict, &TradePoint::on_time_front), (std::vector<std::size_t>{1}));
  EXPECT_EQ(front_of(verdict, &TradePoint::on_work_front), (std::vector<std::size_t>{0}));
}

TEST(TradeFront, is_not_for_the_reference) {
  Case definition = methods({{"a"}, {"b"}, {"c"}});
  Body body;
  body.upper = {1.0, 0.0};
  for (RunRequest& run : definition.runs) run.scene.bodies = {body};
  definition.trades = {of_curve()};
  std::vector<RunVerdict> runs = all_ended(definition);
  for (std::size_t k = 0; k < 3; ++k) runs[k].curves = {line(1.0 + 0.1 * static_cast<double>(k))};
  runs[2].record.cost.particle_steps = 1000;  // worse and dearer than the others
  const Timing timing{.median = 1, .low = 1, .high = 1, .repeats = 5};
  const TradeVerdict verdict = judge_trades(definition, runs, {timing, timing, timing}).at(0);
  EXPECT_EQ(front_of(verdict, &TradePoint::on_work_front), (std::vector<std::size_t>{2}));
  EXPECT_EQ(front_of(verdict, &TradePoint::on_time_front), (std::vector<std::size_t>{2}));
}

TEST(Trade, counts_the_work) {
  const TradeVerdict verdict = weighed({{0.1, 1.0, 400}});
  Scene scene;
  scene.cell_size = 0.5;
  Body body;
  body.upper = {1.0, 0.0};
  scene.bodies = {body};
  const CountedWork work = counted_work(scene, 400);
  EXPECT_EQ(verdict.points[0].work.particle_steps, 400);
  EXPECT_EQ(verdict.points[0].work.bytes, work.bytes);
  EXPECT_EQ(verdict.points[0].work.operations, work.operations);
  EXPECT_GT(work.bytes, 0);
}

// ---- gates ----

TEST(TradeGate, sees_errors_and_bounds_of_every_run) {
  Case definition = methods({{"a"}, {"b"}, {"c"}});
  definition.trades = {of_metric(), of_curve()};
  Gate gate;
  gate.id = "promise";
  gate.metric = "trade.2.bound";
  gate.where = {{method, {"c"}}};
  gate.threshold = 0.151;
  definition.gates = {gate};
  const Judge judge = [](const Case&, const RunRequest& request, const Record&) {
    Judgement judgement;
    const std::string name = request.parameters[1].second;
    judgement.curves = {line(name == "a" ? 1.9 : name == "b" ? 2.1 : 2.2)};
    judgement.metrics["hencky.stress.l2"] = 0.02;
    return judgement;
  };
  const CaseVerdict verdict = judge_case(definition, std::vector<Record>(3), judge);
  EXPECT_EQ(verdict.trades.size(), 2u);
  EXPECT_EQ(verdict.runs[2].metrics.at("trade.1.error"), 0.02);
  EXPECT_EQ(verdict.runs[2].metrics.at("trade.1.bound"), 0.02);
  EXPECT_NEAR(verdict.runs[2].metrics.at("trade.2.error"), 0.1, 1e-12);
  EXPECT_NEAR(verdict.runs[2].metrics.at("trade.2.bound"), 0.15, 1e-12);
  EXPECT_EQ(verdict.runs[2].gates.front().status, GateStatus::pass);
  EXPECT_NEAR(verdict.runs[2].gates.front().value, 0.15, 1e-12);
  definition.gates[0].threshold = 0.149;
  EXPECT_EQ(judge_case(definition, std::vector<Record>(3), judge).runs[2].gates.front().status,
            GateStatus::fail);
}

TEST(TradeGate, does_not_see_the_time) {
  Case definition = methods({{"a"}});
  definition.trades = {of_metric()};
  const Judge judge = [](const Case&, const RunRequest&, const Record&) {
    Judgement judgement;
    judgement.metrics["hencky.stress.l2"] = 0.02;
    return judgement;
  };
  const Timings timings = {Timing{.median = 3.0, .low = 2.0, .high = 4.0, .repeats = 5}};
  const CaseVerdict timed = judge_case(definition, std::vector<Record>(1), judge, timings);
  EXPECT_EQ(timed.trades[0].points[0].timing->median, 3.0);
  EXPECT_EQ(timed.runs[0].metrics, judge_case(definition, std::vector<Record>(1), judge).runs[0].metrics);
  EXPECT_THROW(judge_case(definition, std::vector<Record>(1), judge, {timings[0], timings[0]}),
               std::invalid_argument);
}

TEST(TradeGate, without_an_error_is_red) {
  Case definition = methods({{"a"}});
  definition.trades = {of_metric()};
  Gate gate;
  gate.id = "promise";
  gate.metric = "trade.1.error";
  gate.threshold = 1.0;
  definition.gates = {gate};
  const CaseVerdict verdict =
      judge_case(definition, std::vector<Record>(1),
                 [](const Case&, const RunRequest&, const Record&) { return Judgement(); });
  EXPECT_FALSE(verdict.runs[0].metrics.contains("trade.1.error"));
  EXPECT_EQ(verdict.runs[0].gates.front().status, GateStatus::fail);
  EXPECT_EQ(verdict.runs[0].gates.front().detail, "the run completed but trade.1.error was not measured");
}

}  // namespace
}  // namespace mpm::vv
