#include "vv/gates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace mpm::vv {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* cells = "/scene/grid/cell_size";
constexpr const char* scheme = "/scene/scheme";

RunRequest request(double cell_size, const std::string& of_scheme) {
  RunRequest made;
  made.parameters = {{cells, cell_size}, {scheme, of_scheme}};
  made.scene.cell_size = cell_size;
  return made;
}

Case one_run() {
  Case definition;
  definition.id = "one";
  definition.runs = {request(0.1, "cpgimp")};
  return definition;
}

/// Three levels and two schemes, written in an order that is not coarse to fine.
Case refinement() {
  Case definition;
  definition.id = "refinement";
  for (double size : {0.1, 0.4, 0.2}) {
    for (const char* of_scheme : {"mpm", "cpgimp"}) definition.runs.push_back(request(size, of_scheme));
  }
  return definition;
}

Gate gate(const std::string& metric, Comparison comparison, double threshold) {
  Gate made;
  made.id = "the_gate";
  made.metric = metric;
  made.comparison = comparison;
  made.threshold = threshold;
  made.basis = "requirement";
  made.reason = "because";
  return made;
}

Gate series_gate(Statistic statistic, Comparison comparison, double threshold) {
  Gate made = gate("error", comparison, threshold);
  made.statistic = statistic;
  made.across = cells;
  made.where = {{scheme, {"cpgimp"}}};
  return made;
}

Gate control(Gate made) {
  made.must_fail = true;
  return made;
}

Record completed() { return {}; }

Record ended_early() {
  Record record;
  record.outcome = {.ending = Ending::outside_grid, .step = 123, .time = 0.5, .particle = 4, .value = 1.1};
  return record;
}

Record died() {
  Record record;
  record.outcome.ending = Ending::not_at_rest;
  record.failure = "std::bad_alloc";
  return record;
}

/// Judges every run by the same metrics.
Judge says(std::map<std::string, double> metrics) {
  return [metrics](const Case&, const RunRequest&, const Record&) { return Judgement{metrics, {}}; };
}

/// An error of 2 h^2 for cpgimp and 0.5 for mpm.
Judgement second_order(const Case&, const RunRequest& of, const Record&) {
  const double size = of.scene.cell_size;
  return {{{"error", of.parameters[1].second == "mpm" ? 0.5 : 2.0 * size * size}, {"zero", 0.0}}, {}};
}

GateResult only_result(const Gate& applied, const Record& record, const Judge& judge_run) {
  Case definition = one_run();
  definition.gates = {applied};
  const CaseVerdict verdict = judge_case(definition, {record}, judge_run);
  EXPECT_EQ(verdict.runs.at(0).gates.at(0).id, "the_gate");
  return verdict.runs[0].gates[0];
}

GateResult series_result(const Gate& applied, std::vector<Record> records = std::vector<Record>(6),
                         const Judge& judge_run = second_order) {
  Case definition = refinement();
  definition.gates = {applied};
  const CaseVerdict verdict = judge_case(definition, std::move(records), judge_run);
  for (const SeriesVerdict& series : verdict.series) {
    if (!series.gates.empty()) return series.gates[0];
  }
  ADD_FAILURE() << "no series was judged";
  return {};
}

TEST(GateValue, IsComparedInBothDirections) {
  const auto status = [](Comparison comparison, double value) {
    return only_result(gate("error", comparison, 0.01), completed(), says({{"error", value}})).status;
  };
  EXPECT_EQ(status(Comparison::at_most, 0.01), GateStatus::pass);
  EXPECT_EQ(status(Comparison::at_most, std::nextafter(0.01, 1.0)), GateStatus::fail);
  EXPECT_EQ(status(Comparison::at_least, 0.01), GateStatus::pass);
  EXPECT_EQ(status(Comparison::at_least, std::nextafter(0.01, 0.0)), GateStatus::fail);
}

TEST(GateValue, CarriesAllAPersonNeeds) {
  const GateResult result =
      only_result(gate("error", Comparison::at_most, 0.01), completed(), says({{"error", 0.0075}}));
  EXPECT_EQ(result.metric, "error");
  EXPECT_EQ(result.statistic, "value");
  EXPECT_EQ(result.value, 0.0075);
  EXPECT_EQ(result.op, "<=");
  EXPECT_EQ(result.threshold, 0.01);
  EXPECT_EQ(result.basis, "requirement");
  EXPECT_EQ(result.reason, "because");
  EXPECT_EQ(result.scope, "h 0.1, cpgimp");
  EXPECT_DOUBLE_EQ(margin(result), 0.25);
}

TEST(GateValue, IsRedWithoutAValueAndSaysWhy) {
  const Gate applied = gate("error", Comparison::at_most, 0.01);
  const GateResult absent = only_result(applied, completed(), says({}));
  EXPECT_EQ(absent.status, GateStatus::fail);
  EXPECT_TRUE(std::isnan(absent.value));
  EXPECT_EQ(absent.detail, "the run completed but error was not measured");
  const GateResult not_a_number = only_result(applied, completed(), says({{"error", nan}}));
  EXPECT_EQ(not_a_number.status, GateStatus::fail);
  EXPECT_EQ(not_a_number.detail, "the run completed but error is not a finite number");
  const GateResult early = only_result(applied, ended_early(), says({}));
  EXPECT_EQ(early.status, GateStatus::fail);
  EXPECT_EQ(early.detail, "run ended outside_grid at step 123, t = 0.5 s, particle 4, value 1.1");
  const GateResult dead = only_result(applied, died(), says({{"error", 0.0}}));
  EXPECT_EQ(dead.status, GateStatus::fail);
  EXPECT_EQ(dead.detail, "run failed: std::bad_alloc");
}

/// A curve of the run from 0 to `end`, of ordinate 3 x, and a reference of ordinate 2 x.
Judge draws(double end) {
  return [end](const Case&, const RunRequest&, const Record&) {
    return Judgement{{},
                     {{"pressure", "run", {0.0, end}, {0.0, 3 * end}, "settlement"},
                      {"pressure", "exact", {0.0, 9.0}, {0.0, 18.0}, "settlement"}}};
  };
}

Case one_run_with_readings() {
  Case definition = one_run();
  definition.readings = {
      {.id = "first", .title = "", .curve = "pressure", .at = 1.0, .within = 0.0, .over = ""},
      {.id = "ratio", .title = "", .curve = "pressure", .at = 2.0, .within = 0.0, .over = "exact"}};
  Gate second = gate("reading.ratio", Comparison::at_most, 2.0);
  second.id = "another";
  definition.gates = {gate("reading.first", Comparison::at_most, 4.0), second};
  return definition;
}

TEST(GateValue, MayBeAReadingOffACurve) {
  const CaseVerdict verdict = judge_case(one_run_with_readings(), {completed()}, draws(2.0));
  EXPECT_DOUBLE_EQ(verdict.runs[0].metrics.at("reading.first"), 3.0);
  EXPECT_DOUBLE_EQ(verdict.runs[0].metrics.at("reading.ratio"), 1.5);
  EXPECT_DOUBLE_EQ(verdict.runs[0].gates[0].value, 3.0);
  EXPECT_EQ(verdict.status, CaseStatus::pass);
}

TEST(GateValue, OfAReadingIsRedWhereTheCurveDoesNotReach) {
  const CaseVerdict verdict = judge_case(one_run_with_readings(), {completed()}, draws(1.5));
  EXPECT_FALSE(verdict.runs[0].metrics.contains("reading.ratio"));
  EXPECT_EQ(verdict.runs[0].gates[0].status, GateStatus::pass);
  EXPECT_EQ(verdict.runs[0].gates[1].status, GateStatus::fail);
  EXPECT_EQ(verdict.runs[0].gates[1].detail,
            "the run completed but the curve pressure goes from 0 to 1.5 m and does not reach 2 m");
}

TEST(GateValue, OfAReadingIsThereWhereTheCurveOfARunThatEndedEarlyReaches) {
  const CaseVerdict verdict = judge_case(one_run_with_readings(), {ended_early()}, draws(1.5));
  EXPECT_EQ(verdict.runs[0].gates[0].status, GateStatus::pass);
  EXPECT_EQ(verdict.runs[0].gates[1].status, GateStatus::fail);
  EXPECT_NE(verdict.runs[0].gates[1].detail.find("run ended outside_grid"), std::string::npos);
  EXPECT_TRUE(judge_case(one_run_with_readings(), {died()}, draws(1.5)).runs[0].metrics.empty());
}

TEST(Control, IsRedWhenItsValueViolatesTheThreshold) {
  const GateResult result =
      only_result(control(gate("error", Comparison::at_most, 0.01)), completed(), says({{"error", 0.5}}));
  EXPECT_EQ(result.status, GateStatus::red_as_expected);
  EXPECT_TRUE(result.good());
}

TEST(Control, IsRedWhenTheSolverGaveUp) {
  const GateResult result =
      only_result(control(gate("error", Comparison::at_most, 0.01)), ended_early(), says({}));
  EXPECT_EQ(result.status, GateStatus::red_as_expected);
  EXPECT_EQ(result.detail, "run ended outside_grid at step 123, t = 0.5 s, particle 4, value 1.1");
}

TEST(Control, FailsWhenItStaysGreen) {
  const GateResult result =
      only_result(control(gate("error", Comparison::at_most, 0.01)), completed(), says({{"error", 0.001}}));
  EXPECT_EQ(result.status, GateStatus::unexpectedly_green);
  EXPECT_FALSE(result.good());
  EXPECT_FALSE(result.detail.empty());
}

TEST(Control, FailsWhenTheMetricIsAbsentFromACompletedRun) {
  for (const auto& metrics :
       {std::map<std::string, double>{}, std::map<std::string, double>{{"error", nan}}}) {
    const GateResult result =
        only_result(control(gate("error", Comparison::at_most, 0.01)), completed(), says(metrics));
    EXPECT_EQ(result.status, GateStatus::fail);
    EXPECT_FALSE(result.detail.empty());
  }
}

TEST(Control, FailsWhenTheRunDiedOfAnException) {
  const GateResult result =
      only_result(control(gate("error", Comparison::at_most, 0.01)), died(), says({{"error", 0.5}}));
  EXPECT_EQ(result.status, GateStatus::fail);
  EXPECT_EQ(result.detail, "run failed: std::bad_alloc");
}

TEST(Control, StaysGreenWhenMeasuredGreenInARunThatEndedEarly) {
  const GateResult result =
      only_result(control(gate("steps", Comparison::at_most, 200)), ended_early(), says({{"steps", 123}}));
  EXPECT_EQ(result.status, GateStatus::unexpectedly_green);
}

TEST(SeriesStatistic, ReductionIsFirstOverLast) {
  const GateResult result = series_result(series_gate(Statistic::reduction, Comparison::at_least, 15));
  EXPECT_NEAR(result.value, 16.0, 1e-12);
  EXPECT_EQ(result.status, GateStatus::pass);
  EXPECT_EQ(result.statistic, "reduction");
  EXPECT_EQ(result.scope, "cpgimp, 3 values of cell size");
  EXPECT_EQ(series_result(series_gate(Statistic::reduction, Comparison::at_least, 17)).status,
            GateStatus::fail);
}

TEST(SeriesStatistic, WorstRatioIsTheLargestStep) {
  const Judge uneven = [](const Case&, const RunRequest& of, const Record&) {
    // coarse to fine: 1.0, 0.9, 0.1
    const double size = of.scene.cell_size;
    return Judgement{{{"error", size == 0.4 ? 1.0 : size == 0.2 ? 0.9 : 0.1}}, {}};
  };
  const Gate applied = series_gate(Statistic::worst_ratio, Comparison::at_most, 0.95);
  EXPECT_NEAR(series_result(applied, std::vector<Record>(6), uneven).value, 0.9, 1e-12);
}

/// The worst ratio of a series of these values, from coarse to fine.
GateResult worst_ratio_of(const std::vector<double>& values) {
  Case definition;
  std::vector<Record> records(values.size());
  double size = 1.0;
  for (std::size_t k = 0; k < values.size(); ++k) definition.runs.push_back(request(size /= 2, "cpgimp"));
  definition.gates = {series_gate(Statistic::worst_ratio, Comparison::at_most, 0.95)};
  const Judge by_size = [&](const Case&, const RunRequest& of, const Record&) {
    const auto level = static_cast<std::size_t>(std::lround(-std::log2(of.scene.cell_size))) - 1;
    return Judgement{{{"error", values.at(level)}}, {}};
  };
  return judge_case(definition, records, by_size).series.at(0).gates.at(0);
}

/// A statistic of a series of runs that differ in a named setting only, in the order of the sweep.
GateResult result_over_settings(Statistic statistic, const std::vector<double>& values) {
  Case definition;
  std::vector<Record> records(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    definition.runs.push_back(request(0.1, "cpgimp"));
    definition.runs.back().parameters[0] = {"setting", "variant " + std::to_string(k)};
  }
  Gate applied = series_gate(statistic, Comparison::at_least, 1.0);
  applied.across = "setting";
  definition.gates = {applied};
  std::size_t next = 0;
  const Judge in_turn = [&](const Case&, const RunRequest&, const Record&) {
    return Judgement{{{"error", values.at(next++)}}, {}};
  };
  return judge_case(definition, records, in_turn).series.at(0).gates.at(0);
}

TEST(SeriesStatistic, LeastRatioIsTheSmallestStep) {
  const GateResult growing = result_over_settings(Statistic::least_ratio, {1.0, 2.0, 2.2, 4.4});
  EXPECT_NEAR(growing.value, 1.1, 1e-12);
  EXPECT_EQ(growing.status, GateStatus::pass);
  EXPECT_EQ(growing.statistic, "least_ratio");
  EXPECT_EQ(growing.scope, "cpgimp, 4 values of setting");
  const GateResult falling = result_over_settings(Statistic::least_ratio, {1.0, 0.9, 5.0});
  EXPECT_NEAR(falling.value, 0.9, 1e-12) << "runs with cells of one size keep the order of the sweep";
  EXPECT_EQ(falling.status, GateStatus::fail);
  EXPECT_NEAR(result_over_settings(Statistic::least_ratio, {4.0, 2.0, 1.0, 3.0}).value, 0.5, 1e-12);
  EXPECT_TRUE(std::isnan(result_over_settings(Statistic::least_ratio, {1.0, 0.0, 0.0, 1.0}).value));
  EXPECT_TRUE(std::isnan(result_over_settings(Statistic::least_ratio, {0.0, 0.0, 1.0}).value));
}

TEST(SeriesStatistic, SpreadIsTheRangeOverTheMean) {
  EXPECT_NEAR(result_over_settings(Statistic::spread, {2.0, 5.0, 3.0, 2.0}).value, 1.0, 1e-12);
  EXPECT_NEAR(result_over_settings(Statistic::spread, {-1.0, -3.0}).value, 1.0, 1e-12);
  EXPECT_EQ(result_over_settings(Statistic::spread, {2.0, 2.0}).value, 0.0);
  EXPECT_TRUE(std::isnan(result_over_settings(Statistic::spread, {-1.0, 1.0}).value));
}

/// 7 + h at 0.4, 0.2 and 0.1, and what is no number where cells are of size 0.2.
Judgement first_order(const Case&, const RunRequest& of, const Record&) {
  const double size = of.scene.cell_size;
  return {{{"error", 7.0 + size},
           {"reading.late", 7.0 + size},
           {"load_curve.peak", size == 0.2 ? 9.0 : 7.0},
           {"reading.constant", 0.0}},
          {}};
}

TEST(SeriesStatistic, DiscretisationUncertaintyIsOfTheFinestLevel) {
  const Gate applied = series_gate(Statistic::discretisation_uncertainty, Comparison::at_most, 0.02);
  const GateResult result = series_result(applied, std::vector<Record>(6), first_order);
  EXPECT_NEAR(result.value, 1.25 * 0.1 / 7.1, 1e-9);
  EXPECT_EQ(result.statistic, "discretisation_uncertainty");
  EXPECT_EQ(result.status, GateStatus::pass);
  EXPECT_EQ(result.detail, "grid convergence index at the observed order 1.00");
  Gate of_none = applied;
  of_none.metric = "reading.constant";
  const GateResult none = series_result(of_none, std::vector<Record>(6), first_order);
  EXPECT_EQ(none.status, GateStatus::fail);
  EXPECT_TRUE(std::isnan(none.value));
  Gate short_series = applied;
  short_series.where.push_back({cells, {0.4, 0.2}});
  EXPECT_EQ(series_result(short_series, std::vector<Record>(6), first_order).detail.substr(0, 21),
            "it takes three levels");
}

TEST(Series, KnowsWhereReadingsAndLoadCurvesConverge) {
  Case definition = refinement();
  definition.gates = {series_gate(Statistic::reduction, Comparison::at_least, 1)};
  CampaignVerdict campaign;
  campaign.cases = {judge_case(definition, std::vector<Record>(6), first_order)};
  const auto& convergence = campaign.cases[0].series.at(1).convergence;
  EXPECT_FALSE(convergence.contains("error")) << "an error goes to zero: it has orders, and no other limit";
  EXPECT_FALSE(convergence.contains("reading.constant"));
  EXPECT_NEAR(convergence.at("reading.late").extrapolated, 7.0, 1e-9);
  EXPECT_NEAR(convergence.at("load_curve.peak").uncertainty, 2.0 / 7.0, 1e-12);
  const Json json = Json::parse(to_json(campaign).dump())["cases"][0]["series"][1]["convergence"];
  EXPECT_EQ(json.size(), 2u);
  EXPECT_NEAR(json["reading.late"]["order"].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(json["reading.late"]["extrapolated"].get<double>(), 7.0, 1e-9);
  EXPECT_NEAR(json["reading.late"]["uncertainty"].get<double>(), 0.125 / 7.1, 1e-9);
  EXPECT_EQ(json["reading.late"]["monotone"], true);
  EXPECT_EQ(json["reading.late"]["method"], "grid convergence index at the observed order 1.00");
  EXPECT_EQ(json["load_curve.peak"]["monotone"], false);
  EXPECT_TRUE(json["load_curve.peak"]["order"].is_null());
  EXPECT_TRUE(json["load_curve.peak"]["extrapolated"].is_null());
}

TEST(Series, HasNoConvergenceWithoutThreeSizesOfCells) {
  Case definition = refinement();
  definition.gates = {series_gate(Statistic::reduction, Comparison::at_least, 1)};
  for (RunRequest& run : definition.runs)
    if (run.scene.cell_size == 0.1) run.scene.cell_size = 0.2;
  EXPECT_TRUE(judge_case(definition, std::vector<Record>(6), first_order).series.at(1).convergence.empty());
}

/// Lines of slope 1 / cell size up to these ends, coarse to fine; no curve where the end is 0.
GateResult curve_result(const Gate& applied, const std::vector<double>& ends, std::vector<Record> records) {
  Case definition;
  for (std::size_t k = 0; k < ends.size(); ++k)
    definition.runs.push_back(request(1.0 / static_cast<double>(k + 1), "cpgimp"));
  definition.gates = {applied};
  std::size_t next = 0;
  const Judge in_turn = [&](const Case&, const RunRequest& of, const Record&) {
    Judgement judgement;
    if (const double end = ends.at(next++); end > 0.0)
      judgement.curves = {{"pressure", "run", {0.0, end}, {0.0, end / of.scene.cell_size}, "settlement"}};
    return judgement;
  };
  return judge_case(definition, std::move(records), in_turn).series.at(0).gates.at(0);
}

Gate curve_gate() {
  Gate made = series_gate(Statistic::curve_spread, Comparison::at_most, 1.5);
  made.metric.clear();
  made.curve = "pressure";
  return made;
}

TEST(SeriesStatistic, CurveSpreadComparesTheCurvesOfTheRuns) {
  const GateResult result = curve_result(curve_gate(), {2.0, 2.0, 1.99}, std::vector<Record>(3));
  EXPECT_NEAR(result.value, 1.0, 1e-12);
  EXPECT_EQ(result.status, GateStatus::pass);
  EXPECT_EQ(result.metric, "pressure");
  EXPECT_EQ(result.statistic, "curve_spread");
  EXPECT_EQ(result.scope, "cpgimp, 3 values of cell size");
}

TEST(SeriesStatistic, CurveSpreadIsRedWhereACurveBreaksOffOrLacks) {
  std::vector<Record> records(3);
  const GateResult completed_short = curve_result(curve_gate(), {2.0, 1.0, 2.0}, records);
  EXPECT_EQ(completed_short.status, GateStatus::fail);
  EXPECT_EQ(completed_short.detail,
            "h 0.5, cpgimp: the curve pressure goes from 0 to 1 m: the curves have only 50.0 % in common");
  EXPECT_EQ(curve_result(control(curve_gate()), {2.0, 1.0, 2.0}, records).status, GateStatus::fail);
  EXPECT_EQ(curve_result(curve_gate(), {2.0, 2.0, 0.0}, records).detail.substr(0, 14), "h 0.3333333333");
  Gate limited = curve_gate();
  limited.up_to = 1.0;
  EXPECT_NEAR(curve_result(limited, {2.0, 1.0, 2.0}, records).value, 1.0, 1e-12);

  records[1] = ended_early();
  const GateResult broken = curve_result(curve_gate(), {2.0, 1.0, 2.0}, records);
  EXPECT_EQ(broken.status, GateStatus::fail);
  EXPECT_NE(broken.detail.find("run ended outside_grid"), std::string::npos);
  EXPECT_NE(broken.detail.find("the curves have only"), std::string::npos);
  EXPECT_EQ(curve_result(control(curve_gate()), {2.0, 1.0, 2.0}, records).status,
            GateStatus::red_as_expected);
  EXPECT_EQ(curve_result(control(curve_gate()), {2.0, 0.0, 0.0}, records).status, GateStatus::fail)
      << "the last run completed and has no excuse";
  EXPECT_NEAR(curve_result(curve_gate(), {2.0, 1.95, 2.0}, records).value, 1.0, 1e-12)
      << "far enough is far enough, however the run ended";
}

TEST(SeriesStatistic, WorstRatioThatIsNoNumberSomewhereIsNoNumber) {
  EXPECT_NEAR(worst_ratio_of({1.0, 0.5, 0.45, 0.1}).value, 0.9, 1e-12);
  // 0/0 first, in the middle and last; what follows a zero can fall again by way of minus infinity only.
  for (const auto& values : std::vector<std::vector<double>>{{0.0, 0.0, -1.0, -0.5, -0.25},
                                                             {1.0, 0.5, 0.0, 0.0, -1.0, -0.5},
                                                             {1.0, 0.5, 0.0, 0.0}}) {
    const GateResult result = worst_ratio_of(values);
    EXPECT_TRUE(std::isnan(result.value)) << values.size();
    EXPECT_EQ(result.status, GateStatus::fail);
    EXPECT_EQ(result.detail, "the statistic of these values is not a finite number");
  }
}

TEST(SeriesStatistic, LastOrderIsOfTheFinestPair) {
  const Judge uneven = [](const Case&, const RunRequest& of, const Record&) {
    // orders log2(1/0.8) and log2(0.8/0.1) = 3
    const double size = of.scene.cell_size;
    return Judgement{{{"error", size == 0.4 ? 1.0 : size == 0.2 ? 0.8 : 0.1}}, {}};
  };
  const Gate applied = series_gate(Statistic::last_order, Comparison::at_least, 2.9);
  EXPECT_NEAR(series_result(applied, std::vector<Record>(6), uneven).value, 3.0, 1e-12);
}

TEST(SeriesStatistic, UsesOnlyTheLevelsTheGateSelects) {
  Gate applied = series_gate(Statistic::reduction, Comparison::at_least, 1);
  applied.where.push_back({cells, {0.4, 0.2}});
  const GateResult result = series_result(applied);
  EXPECT_NEAR(result.value, 4.0, 1e-12);
  EXPECT_EQ(result.scope, "cpgimp, 2 values of cell size");
}

TEST(SeriesStatistic, IsRedWithOneLevelOrAValueMissing) {
  Gate short_series = series_gate(Statistic::last_order, Comparison::at_least, 1);
  short_series.where.push_back({cells, {0.4}});
  const GateResult one = series_result(short_series);
  EXPECT_EQ(one.status, GateStatus::fail);
  EXPECT_EQ(one.detail, "a series needs two runs, this one has 1");

  std::vector<Record> records(6);
  records[5] = ended_early();  // cpgimp at 0.2
  const Judge unless_ended = [](const Case& of, const RunRequest& run, const Record& record) {
    return record.completed() ? second_order(of, run, record) : Judgement{};
  };
  const Gate applied = series_gate(Statistic::reduction, Comparison::at_least, 15);
  const GateResult missing = series_result(applied, records, unless_ended);
  EXPECT_EQ(missing.status, GateStatus::fail);
  EXPECT_EQ(missing.detail,
            "h 0.2, cpgimp: run ended outside_grid at step 123, t = 0.5 s, particle 4, value 1.1");
  EXPECT_EQ(series_result(control(applied), records, unless_ended).status, GateStatus::red_as_expected);
}

TEST(SeriesStatistic, ControlFailsWhenAnyMissingValueHasNoExcuse) {
  std::vector<Record> records(6);
  records[1] = ended_early();
  const Judge nothing = says({});
  const Gate applied = control(series_gate(Statistic::reduction, Comparison::at_least, 15));
  EXPECT_EQ(series_result(applied, records, nothing).status, GateStatus::fail);
}

TEST(SeriesStatistic, IsRedWhenItIsNoNumber) {
  for (Statistic statistic : {Statistic::reduction, Statistic::worst_ratio, Statistic::last_order,
                              Statistic::least_ratio, Statistic::spread}) {
    Gate applied = series_gate(statistic, Comparison::at_least, 0.0);
    applied.metric = "zero";
    const GateResult result = series_result(applied);
    EXPECT_EQ(result.status, GateStatus::fail) << result.statistic;
    EXPECT_FALSE(result.detail.empty());
  }
}

TEST(Series, HoldsEveryGroupFromCoarseToFineWithItsOrders) {
  Case definition = refinement();
  definition.gates = {series_gate(Statistic::reduction, Comparison::at_least, 15)};
  const CaseVerdict verdict = judge_case(definition, std::vector<Record>(6), second_order);
  ASSERT_EQ(verdict.series.size(), 2u);
  const SeriesVerdict& mpm_series = verdict.series[0];
  const SeriesVerdict& cpgimp = verdict.series[1];
  EXPECT_EQ(mpm_series.fixed[0].second, "mpm");
  EXPECT_TRUE(mpm_series.gates.empty());
  EXPECT_EQ(cpgimp.cell_size, (std::vector<double>{0.4, 0.2, 0.1}));
  ASSERT_EQ(cpgimp.values.size(), 3u);
  EXPECT_NE(cpgimp.values[0], cpgimp.values[1]);
  EXPECT_NE(cpgimp.values[1], cpgimp.values[2]);
  ASSERT_EQ(cpgimp.orders.at("error").size(), 2u);
  EXPECT_NEAR(cpgimp.orders.at("error")[0], 2.0, 1e-12);
  EXPECT_NEAR(cpgimp.orders.at("error")[1], 2.0, 1e-12);
  EXPECT_NEAR(mpm_series.orders.at("error")[1], 0.0, 1e-12);
  EXPECT_FALSE(cpgimp.orders.contains("zero"));
}

TEST(Series, ShowsAMissingValueAndGivesNoOrderForIt) {
  Case definition = refinement();
  definition.gates = {series_gate(Statistic::reduction, Comparison::at_least, 15)};
  const Judge lacking = [](const Case& of, const RunRequest& run, const Record& record) {
    return run.scene.cell_size == 0.2 ? Judgement{} : second_order(of, run, record);
  };
  const CaseVerdict verdict = judge_case(definition, std::vector<Record>(6), lacking);
  EXPECT_TRUE(std::isnan(verdict.series[1].metrics.at("error")[1]));
  EXPECT_FALSE(verdict.series[1].orders.contains("error"));
  EXPECT_EQ(verdict.status, CaseStatus::fail);
}

TEST(Series, IsMadeForAFigureToo) {
  Case definition = refinement();
  definition.gates = {gate("error", Comparison::at_most, 1.0)};
  definition.figures.resize(1);
  definition.figures[0].over = cells;
  EXPECT_EQ(judge_case(definition, std::vector<Record>(6), second_order).series.size(), 2u);
}

TEST(CaseStatus, PassesWhenEveryGateDoes) {
  Case definition = one_run();
  definition.gates = {gate("error", Comparison::at_most, 0.01)};
  EXPECT_EQ(judge_case(definition, {completed()}, says({{"error", 0.001}})).status, CaseStatus::pass);
  EXPECT_EQ(judge_case(definition, {completed()}, says({{"error", 0.1}})).status, CaseStatus::fail);
}

TEST(CaseStatus, FailsWithoutRunsOrGates) {
  Case no_gates = one_run();
  const CaseVerdict ungated = judge_case(no_gates, {completed()}, says({}));
  EXPECT_EQ(ungated.status, CaseStatus::fail);
  EXPECT_EQ(ungated.gates.at(0).detail, "the case has no gates");
  Case no_runs;
  no_runs.gates = {gate("error", Comparison::at_most, 0.01)};
  EXPECT_EQ(judge_case(no_runs, {}, says({})).status, CaseStatus::fail);
}

TEST(CaseStatus, FailsWhenAGateMatchesNoRun) {
  Case definition = one_run();
  Gate nowhere = gate("error", Comparison::at_most, 0.01);
  nowhere.where = {{scheme, {"ugimp"}}};
  for (const Gate& applied : {nowhere, control(nowhere)}) {
    definition.gates = {applied};
    const CaseVerdict verdict = judge_case(definition, {completed()}, says({{"error", 0.001}}));
    EXPECT_EQ(verdict.status, CaseStatus::fail);
    ASSERT_EQ(verdict.gates.size(), 1u);
    EXPECT_EQ(verdict.gates[0].status, GateStatus::fail);
    EXPECT_EQ(verdict.gates[0].detail, "the gate matches no run of the sweep");
  }
}

TEST(CaseStatus, FailsForAnEarlyEndingThatNobodyExpects) {
  Case definition = one_run();
  definition.gates = {gate("steps", Comparison::at_least, 1)};
  const CaseVerdict verdict = judge_case(definition, {ended_early()}, says({{"steps", 123}}));
  EXPECT_EQ(verdict.runs[0].gates[0].status, GateStatus::pass);
  EXPECT_EQ(verdict.status, CaseStatus::fail);
  const GateResult& added = verdict.runs[0].gates.at(1);
  EXPECT_EQ(added.id, "run_completed");
  EXPECT_EQ(added.status, GateStatus::fail);
  EXPECT_EQ(added.value, 0.0);
  EXPECT_NE(added.detail.find("outside_grid at step 123"), std::string::npos);
}

TEST(CaseStatus, LetsAControlOrAGateOnCompletionCoverAnEarlyEnding) {
  Case definition = one_run();
  definition.gates = {control(gate("error", Comparison::at_most, 0.01))};
  EXPECT_EQ(judge_case(definition, {ended_early()}, says({})).status, CaseStatus::pass);
  definition.gates = {gate("completed", Comparison::at_most, 0)};
  const Judge as_it_is = [](const Case&, const RunRequest&, const Record& record) {
    return Judgement{{{"completed", record.completed() ? 1.0 : 0.0}}, {}};
  };
  EXPECT_EQ(judge_case(definition, {ended_early()}, as_it_is).status, CaseStatus::pass);
  EXPECT_EQ(judge_case(definition, {completed()}, as_it_is).status, CaseStatus::fail);
  EXPECT_EQ(judge_case(definition, {died()}, as_it_is).status, CaseStatus::fail);
}

TEST(CaseStatus, HasTheSameNumberOfGatesHoweverTheRunsEnd) {
  Case definition = refinement();
  definition.gates = {gate("error", Comparison::at_most, 1.0),
                      series_gate(Statistic::reduction, Comparison::at_least, 15)};
  const auto results = [&](const Record& record) {
    return gate_results(judge_case(definition, std::vector<Record>(6, record), second_order)).size();
  };
  EXPECT_EQ(results(completed()), 13u);  // 6 values, 6 completions, 1 series
  EXPECT_EQ(results(ended_early()), 13u);
  EXPECT_EQ(results(died()), 13u);
}

TEST(CaseStatus, FailsWhenARunCannotBeJudged) {
  Case definition = one_run();
  definition.gates = {gate("error", Comparison::at_most, 0.01)};
  const Judge broken = [](const Case&, const RunRequest&, const Record&) -> Judgement {
    throw std::runtime_error("no such reference");
  };
  const CaseVerdict verdict = judge_case(definition, {completed()}, broken);
  EXPECT_EQ(verdict.status, CaseStatus::fail);
  EXPECT_NE(verdict.runs[0].gates[0].detail.find("no such reference"), std::string::npos);
}

TEST(CaseStatus, NeedsOneRecordForEveryRun) {
  EXPECT_THROW(judge_case(one_run(), {}, says({})), std::invalid_argument);
}

TEST(BitsDiffer, ComparesTheDigestOfTheRepeat) {
  const Gate applied = gate("bits_differ", Comparison::at_most, 0.0);
  Record record;
  record.digest = record.repeat_digest = "1";
  EXPECT_EQ(only_result(applied, record, says({})).value, 0.0);
  record.repeat_digest = "2";
  const GateResult different = only_result(applied, record, says({}));
  EXPECT_EQ(different.value, 1.0);
  EXPECT_EQ(different.status, GateStatus::fail);
  record.repeat_digest.clear();
  EXPECT_TRUE(std::isnan(only_result(applied, record, says({})).value));
}

// ---- counting ----

GateResult result(GateStatus status, bool must_fail = false) {
  GateResult made;
  made.op = "<=";
  made.threshold = 1.0;
  made.value = 0.5;
  made.status = status;
  made.must_fail = must_fail;
  return made;
}

CaseVerdict case_with(CaseStatus status, std::vector<GateResult> of_run) {
  CaseVerdict verdict;
  verdict.definition.id = "some_case";
  verdict.status = status;
  verdict.runs.resize(1);
  verdict.runs[0].gates = std::move(of_run);
  return verdict;
}

TEST(Counts, KeepAFixedDenominator) {
  CampaignVerdict campaign;
  campaign.cases = {
      case_with(CaseStatus::pass, {result(GateStatus::pass), result(GateStatus::red_as_expected, true)}),
      case_with(CaseStatus::fail, {result(GateStatus::fail), result(GateStatus::unexpectedly_green, true),
                                   result(GateStatus::fail, true)}),
      {}};
  campaign.cases[0].series.resize(1);
  campaign.cases[0].series[0].gates = {result(GateStatus::pass)};
  campaign.cases[1].gates = {result(GateStatus::fail)};
  const Counts counts = campaign.counts();
  EXPECT_EQ(counts.cases, 3);
  EXPECT_EQ(counts.cases_passed, 1);
  EXPECT_EQ(counts.cases_failed, 1);
  EXPECT_EQ(counts.cases_not_run, 1);
  EXPECT_EQ(counts.runs, 2);
  EXPECT_EQ(counts.gates, 4);
  EXPECT_EQ(counts.gates_passed, 2);
  EXPECT_EQ(counts.gates_failed, 2);
  EXPECT_EQ(counts.controls, 3);
  EXPECT_EQ(counts.controls_red, 1);
  EXPECT_EQ(counts.controls_green, 2);
}

TEST(Counts, DecideWhetherTheCampaignPassed) {
  CampaignVerdict campaign;
  EXPECT_FALSE(campaign.passed());
  EXPECT_TRUE(campaign.failed());  // nothing was judged
  campaign.cases = {case_with(CaseStatus::pass, {result(GateStatus::pass)})};
  EXPECT_TRUE(campaign.passed());
  campaign.cases.emplace_back();
  EXPECT_FALSE(campaign.passed());  // a case was not run,
  EXPECT_FALSE(campaign.failed());  // which is no failure
  campaign.cases.push_back(case_with(CaseStatus::fail, {result(GateStatus::unexpectedly_green, true)}));
  EXPECT_TRUE(campaign.failed());
  EXPECT_FALSE(campaign.passed());
}

TEST(Results, HaveThePublishedShape) {
  CampaignVerdict campaign;
  campaign.revision = "abc";
  campaign.host = "here";
  campaign.cases = {
      case_with(CaseStatus::pass, {result(GateStatus::pass), result(GateStatus::red_as_expected, true)})};
  RunVerdict& run = campaign.cases[0].runs[0];
  run.parameters = {{scheme, "mpm"}};
  run.metrics = {{"error", 0.5}};
  run.gates[1].value = nan;
  run.gates[1].detail = "why";
  const Json json = Json::parse(to_json(campaign).dump());
  EXPECT_EQ(json["schema"], "mpmvv-results/1");
  EXPECT_EQ(json["revision"], "abc");
  EXPECT_EQ(json["host"], "here");
  EXPECT_EQ(json["counts"]["gates"], 1);
  const Json& one = json["cases"][0];
  EXPECT_EQ(one["id"], "some_case");
  EXPECT_EQ(one["status"], "pass");
  EXPECT_EQ(one["runs"][0]["parameters"][scheme], "mpm");
  EXPECT_EQ(one["runs"][0]["outcome"]["ending"], "reached_time");
  EXPECT_EQ(one["runs"][0]["outcome"]["completed"], true);
  EXPECT_EQ(one["runs"][0]["metrics"]["error"], 0.5);
  EXPECT_TRUE(one["runs"][0]["cost"].contains("wall_seconds"));
  const Json& gates = one["runs"][0]["gates"];
  for (const char* key : {"id", "metric", "value", "op", "threshold", "reason", "pass"}) {
    EXPECT_TRUE(gates[0].contains(key)) << key;
  }
  EXPECT_EQ(gates[0]["pass"], true);
  EXPECT_EQ(gates[0]["margin"], 0.5);
  EXPECT_EQ(gates[1]["must_fail"], true);
  EXPECT_EQ(gates[1]["pass"], true);
  EXPECT_TRUE(gates[1]["value"].is_null());
  EXPECT_EQ(gates[1]["detail"], "why");
}

TEST(Scope, ReadsLikeASentence) {
  EXPECT_EQ(scope_of({{"/scene/gravity/level", 50}, {scheme, "cpgimp"}, {cells, "0.02 m"}}),
            "50G, cpgimp, h 0.02 m");
  EXPECT_EQ(scope_of({{"/scene/damping", 0.8}, {"/scene/bodies/0/material", {{"law", "zhang_elastic"}}}}),
            "damping 0.8, zhang_elastic");
  EXPECT_EQ(scope_of({{"setting", "half the rate, 50"}, {scheme, "mpm"}}), "half the rate, 50, mpm");
  EXPECT_EQ(scope_of({}), "the run");
}

}  // namespace
}  // namespace mpm::vv
