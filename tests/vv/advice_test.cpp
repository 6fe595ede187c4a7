// Advice on one problem from trades measured of others, and how it is put to the test.

#include "vv/advice.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "vv/scene_match.hpp"

namespace mpm::vv {
namespace {

using Parameters = std::vector<std::pair<std::string, Json>>;

constexpr const char* level = "/scene/gravity/level";

TradePoint point(const std::string& scheme, double error, double bytes) {
  TradePoint made;
  made.configuration = {{"/scene/scheme", scheme}};
  made.error = error;
  made.work = {bytes / 100, bytes, bytes / 10};
  return made;
}

TradePoint failing(const std::string& scheme) {
  TradePoint made = point(scheme, std::nan(""), 10.0);
  made.failure = "a particle left the grid";
  return made;
}

TradeVerdict trade(const Parameters& problem, const std::vector<TradePoint>& points) {
  TradeVerdict made;
  made.title = "stress";
  made.problem = problem;
  made.error_name = "hencky.stress.l2";
  made.points = points;
  return made;
}

std::vector<const TradeVerdict*> all(const std::vector<TradeVerdict>& trades) {
  std::vector<const TradeVerdict*> pointers;
  for (const TradeVerdict& each : trades) pointers.push_back(&each);
  return pointers;
}

// ---- scenes ----

TEST(SceneMatch, ComparesQuantitiesInSiUnits) {
  EXPECT_TRUE(same_value("1 m", "100 cm"));
  EXPECT_TRUE(same_value("10 MPa", "10000 kPa"));
  EXPECT_TRUE(same_value(1, 1.0));
  EXPECT_FALSE(same_value("1 m", "1.0001 m"));
  EXPECT_FALSE(same_value("1 m", "1 s")) << "of another kind";
  EXPECT_FALSE(same_value(1, "1 m")) << "a plain number is no length";
  EXPECT_FALSE(same_value("mpm", "ugimp"));
  EXPECT_TRUE(same_value({{"a", "1 m"}, {"b", 2}}, {{"b", 2.0}, {"a", "1000 mm"}})) << "in any order";
}

TEST(SceneMatch, TellsWhereScenesDiffer) {
  const Json one = {
      {"grid", {{"cell_size", "0.1 m"}}}, {"bodies", {{{"density", 1}}, {{"density", 2}}}}, {"a/b", 1}};
  const Json other = {{"grid", {{"cell_size", "0.2 m"}}}, {"bodies", {{{"density", 3}}}}, {"extra", true}};
  const std::vector<std::string> everywhere = {"/scene/grid/cell_size", "/scene/bodies/0/density",
                                               "/scene/bodies/1", "/scene/a~1b", "/scene/extra"};
  EXPECT_EQ(differences(one, other, "/scene", {}), everywhere);
  EXPECT_EQ(differences(one, other, "/scene", {"/scene/bodies", "/scene/grid/cell_size"}),
            (std::vector<std::string>{"/scene/a~1b", "/scene/extra"}));
  EXPECT_EQ(differences(one, other, "/scene", {"/scene/grid/cell", "/scene/bod"}), everywhere)
      << "a place whose name begins alike is another";
}

// ---- several problems ----

TEST(WorstOfProblems, CountsTheLargerBoundAndTheHigherPrices) {
  std::vector<TradeVerdict> trades = {
      trade({{level, 1}}, {point("mpm", 0.1, 50), point("ugimp", 0.02, 80)}),
      trade({{level, 50}}, {point("ugimp", 0.01, 90), point("mpm", 0.3, 40)})};
  trades[0].points[0].uncertainty = 0.05;
  trades[0].points[0].timing = Timing{.median = 2, .low = 1, .high = 3, .repeats = 7, .whole = true};
  trades[1].points[1].timing = Timing{.median = 1, .low = 0.5, .high = 4, .repeats = 5, .whole = false};
  trades[0].points[1].timing = trades[0].points[0].timing;
  const TradeVerdict worst = worst_of(all(trades));
  ASSERT_EQ(worst.points.size(), 2u);
  EXPECT_TRUE(worst.problem.empty()) << "it is no one problem any more";
  const TradePoint &mpm = worst.points[0], &ugimp = worst.points[1];
  EXPECT_EQ(mpm.bound(), 0.3);
  EXPECT_EQ(mpm.work.bytes, 50);
  EXPECT_EQ(mpm.timing->median, 2);
  EXPECT_EQ(mpm.timing->high, 4);
  EXPECT_EQ(mpm.timing->repeats, 5);
  EXPECT_FALSE(mpm.timing->whole);
  EXPECT_EQ(ugimp.bound(), 0.02);
  EXPECT_EQ(ugimp.work.bytes, 90);
  EXPECT_FALSE(ugimp.timing) << "one of the two was not timed";
}

TEST(WorstOfProblems, FailureCountsAndWhatOneLacksIsLeftOut) {
  std::vector<TradeVerdict> trades = {
      trade({{level, 1}}, {point("mpm", 0.1, 50), failing("ugimp"), point("cpgimp", 0.1, 1)}),
      trade({{level, 50}}, {failing("mpm"), point("ugimp", 0.01, 90)})};
  trades[1].points[1].of_reference = true;
  const TradeVerdict worst = worst_of(all(trades));
  ASSERT_EQ(worst.points.size(), 2u);
  EXPECT_EQ(worst.points[0].failure, "a particle left the grid");
  EXPECT_EQ(worst.points[1].failure, "a particle left the grid");
  EXPECT_TRUE(worst.points[1].of_reference);
  EXPECT_EQ(worst_of({&trades[0]}).points.size(), 3u);
  EXPECT_EQ(worst_of({&trades[0]}).problem, trades[0].problem);
}

using Kind = NearProblems::Kind;

TEST(ProblemsNear, AreTheSameOrTheNeighboursOfANumber) {
  const std::vector<TradeVerdict> trades = {trade({{level, 50}}, {}), trade({{level, 1}}, {}),
                                            trade({{level, 100}}, {}), trade({{level, 10}}, {})};
  const auto near = [&](const Json& value) { return problems_near(all(trades), {{level, value}}); };
  EXPECT_EQ(near(50.0).kind, Kind::same);
  EXPECT_EQ(names_of_problems(near(50.0).problems), "50G");
  EXPECT_EQ(near(20).kind, Kind::between);
  EXPECT_EQ(names_of_problems(near(20).problems), "50G and 10G");
  EXPECT_EQ(names_of_problems(near(99).problems), "50G and 100G");
  for (const Json& value : {Json(0.5), Json(101), Json("20 m")}) {
    EXPECT_EQ(near(value).kind, Kind::outside) << value;
    EXPECT_TRUE(near(value).problems.empty()) << value;
  }
  EXPECT_TRUE(problems_near(all(trades), {}).problems.empty()) << "the problem has no such number";
  EXPECT_TRUE(problems_near({}, {{level, 1}}).problems.empty());
}

TEST(ProblemsNear, OfWordsAreAllOfThem) {
  const std::vector<TradeVerdict> trades = {trade({{"soil", "clay"}}, {}), trade({{"soil", "sand"}}, {})};
  EXPECT_EQ(problems_near(all(trades), {{"soil", "sand"}}).kind, Kind::same);
  const NearProblems near = problems_near(all(trades), {{"soil", "silt"}});
  EXPECT_EQ(near.kind, Kind::unlike);
  EXPECT_EQ(near.problems.size(), 2u);
}

TEST(ProblemsNear, OfSeveralAxesNeedEveryCombination) {
  const auto made = [](int g, const char* width) { return trade({{level, g}, {"width", width}}, {}); };
  std::vector<TradeVerdict> trades = {made(1, "1 m"), made(1, "2 m"), made(50, "1 m"), made(50, "2 m")};
  EXPECT_EQ(problems_near(all(trades), {{level, 1}, {"width", "150 cm"}}).problems.size(), 2u);
  EXPECT_EQ(problems_near(all(trades), {{level, 7}, {"width", "150 cm"}}).problems.size(), 4u);
  EXPECT_EQ(problems_near(all(trades), {{level, 50}, {"width", "200 cm"}}).kind, Kind::same);
  trades.pop_back();
  EXPECT_TRUE(problems_near(all(trades), {{level, 50}, {"width", "150 cm"}}).problems.empty());
  EXPECT_EQ(problems_near(all(trades), {{level, 1}, {"width", "150 cm"}}).problems.size(), 2u);
}

// ---- advice put to the test ----

Gate gate(const std::string& metric, Comparison comparison, double threshold) {
  Gate made;
  made.id = metric.substr(metric.find('.') + 1);
  made.metric = metric;
  made.comparison = comparison;
  made.threshold = threshold;
  made.basis = "requirement";
  made.reason = "promised";
  return made;
}

/// A case that was measured, and one that puts its advice to the test.
class PutToTheTest : public testing::Test {
 protected:
  PutToTheTest() {
    measured_.definition.id = "measured";
    measured_.status = CaseStatus::pass;
    measured_.trades = {
        trade({{level, 1}}, {point("mpm", 0.1, 10), point("ugimp", 0.02, 40), point("cpgimp", 0.002, 90)}),
        trade({{level, 50}}, {point("mpm", 0.4, 11), point("ugimp", 0.04, 44), point("cpgimp", 0.004, 99)})};
    testing_.definition.id = "testing";
    testing_.definition.advice = {.of = "measured", .asked = {0.2, 0.05, 0.001}};
    testing_.definition.gates = {gate("advice.kept", Comparison::at_least, 1.0),
                                 gate("advice.worst", Comparison::at_most, 1.0),
                                 gate("advice.regret", Comparison::at_most, 2.0)};
    testing_.status = CaseStatus::pass;
    testing_.trades = {trade(
        {{level, 20}}, {point("cpgimp", 0.003, 95), point("ugimp", 0.03, 42), point("mpm", 0.3, 10.5)})};
  }

  /// The testing case, judged in a campaign.
  CaseVerdict judged(bool with_the_measured = true) const {
    std::vector<CaseVerdict> verdicts = {testing_};
    if (with_the_measured) verdicts.push_back(measured_);
    judge_advice(verdicts);
    return verdicts[0];
  }

  CaseVerdict measured_, testing_;
};

TEST_F(PutToTheTest, IsDrawnFromNeighboursAndKept) {
  const CaseVerdict verdict = judged();
  ASSERT_TRUE(verdict.advice);
  ASSERT_EQ(verdict.advice->trials.size(), 3u);
  const AdviceTrial& first = verdict.advice->trials[0];
  EXPECT_EQ(first.drawn_from, "1G and 50G");
  EXPECT_TRUE(first.between);
  EXPECT_EQ(first.configuration, (Parameters{{"/scene/scheme", "ugimp"}})) << "mpm is too far off at 50G";
  EXPECT_EQ(first.promised, 0.04);
  EXPECT_EQ(first.found, 0.03);
  EXPECT_TRUE(first.kept);
  EXPECT_EQ(first.regret, 1.0) << "nothing here is cheaper";
  EXPECT_TRUE(verdict.advice->trials[2].no_offer);
  EXPECT_EQ(verdict.advice->metrics.at("advice.kept"), 1.0) << "silence breaks no promise";
  EXPECT_DOUBLE_EQ(verdict.advice->metrics.at("advice.worst"), 0.03 / 0.05);
  EXPECT_EQ(verdict.advice->metrics.at("advice.regret"), 1.0);
  EXPECT_FALSE(verdict.advice->metrics.contains("advice.hidden"));
  ASSERT_EQ(verdict.gates.size(), 3u);
  for (const GateResult& result : verdict.gates) EXPECT_EQ(result.status, GateStatus::pass) << result.id;
  EXPECT_EQ(verdict.status, CaseStatus::pass);
}

TEST_F(PutToTheTest, RegretIsWhatACheaperRunWouldHaveSaved) {
  testing_.trades[0].points[2].error = 0.15;  // mpm does it here
  const CaseVerdict verdict = judged();
  EXPECT_DOUBLE_EQ(verdict.advice->trials[0].regret, 42 / 10.5);
  EXPECT_DOUBLE_EQ(verdict.advice->metrics.at("advice.regret"), 4.0);
  EXPECT_EQ(verdict.gates[2].status, GateStatus::fail);
  EXPECT_EQ(verdict.status, CaseStatus::fail);
}

TEST_F(PutToTheTest, BrokenPromiseIsRed) {
  testing_.trades[0].points[1].error = 0.045;
  testing_.trades[0].points[1].uncertainty = 0.02;  // the bound counts, not the error alone
  const CaseVerdict verdict = judged();
  EXPECT_TRUE(verdict.advice->trials[0].kept);
  EXPECT_FALSE(verdict.advice->trials[1].kept);
  EXPECT_EQ(verdict.advice->metrics.at("advice.kept"), 0.5);
  EXPECT_DOUBLE_EQ(verdict.advice->metrics.at("advice.worst"), 0.065 / 0.05);
  EXPECT_EQ(verdict.gates[0].status, GateStatus::fail);
  EXPECT_NE(verdict.gates[0].detail.find("20G, stress, asked 0.05: found 0.065"), std::string::npos)
      << verdict.gates[0].detail;
  EXPECT_EQ(verdict.gates[1].status, GateStatus::fail);
  EXPECT_EQ(verdict.status, CaseStatus::fail);
}

TEST_F(PutToTheTest, ConfigurationThatWasNotRunIsAFailureToTest) {
  testing_.trades[0].points.erase(testing_.trades[0].points.begin() + 1);
  const CaseVerdict verdict = judged();
  EXPECT_EQ(verdict.advice->trials[0].lack, "the configuration was not run here");
  EXPECT_EQ(verdict.advice->metrics.at("advice.kept"), 0.0);
  EXPECT_FALSE(verdict.advice->metrics.contains("advice.worst"))
      << "the largest of what is there would hide it";
  for (const GateResult& result : verdict.gates) {
    EXPECT_EQ(result.status, GateStatus::fail) << result.id;
    EXPECT_NE(result.detail.find("was not run here"), std::string::npos) << result.detail;
  }
}

TEST_F(PutToTheTest, RunThatFailedKeepsNoPromise) {
  testing_.trades[0].points[1] = failing("ugimp");
  const CaseVerdict verdict = judged();
  EXPECT_EQ(verdict.advice->trials[0].lack, "a particle left the grid");
  EXPECT_EQ(verdict.advice->metrics.at("advice.kept"), 0.0);
}

TEST_F(PutToTheTest, ProblemOutsideOfTheMeasuredOnesIsNotAdvisedOn) {
  testing_.trades[0].problem = {{level, 60}};
  const CaseVerdict verdict = judged();
  EXPECT_EQ(verdict.advice->trials[0].lack, "outside of what was measured");
  EXPECT_FALSE(verdict.advice->trials[0].no_offer);
  EXPECT_EQ(verdict.status, CaseStatus::fail);
}

TEST_F(PutToTheTest, OnlyTradesOfTheSameErrorAreDrawnOn) {
  testing_.trades[0].error_name = "hencky.displacement.l2";
  EXPECT_EQ(judged().advice->trials[0].lack, "the case has no trade of hencky.displacement.l2");
  // Of several of one error, that of the title.
  testing_.trades[0].error_name = "hencky.stress.l2";
  measured_.trades[1].title = "another";
  testing_.trades[0].problem = {{level, 1}};
  EXPECT_EQ(judged().advice->trials[0].configuration, (Parameters{{"/scene/scheme", "mpm"}}));
}

TEST_F(PutToTheTest, WaitsForACaseThatWasNotRun) {
  for (const bool left_out : {false, true}) {
    measured_.status = CaseStatus::not_run;
    const CaseVerdict verdict = judged(left_out);
    EXPECT_FALSE(verdict.advice->lack.empty());
    for (const GateResult& result : verdict.gates) EXPECT_TRUE(result.waits()) << result.id;
    EXPECT_EQ(verdict.status, CaseStatus::pass) << "nothing is known to be wrong";
  }
}

TEST_F(PutToTheTest, WithoutTradesOfItsOwnNothingCanBeJudged) {
  testing_.trades.clear();
  const CaseVerdict verdict = judged();
  for (const GateResult& result : verdict.gates) EXPECT_EQ(result.status, GateStatus::fail) << result.id;
}

TEST_F(PutToTheTest, OfItsOwnIsDrawnFromEverySecondConfiguration) {
  measured_.definition.advice = {.of = "measured", .asked = {0.05}};
  measured_.definition.gates = {gate("advice.hidden", Comparison::at_most, 2.3),
                                gate("advice.kept", Comparison::at_least, 1.0)};
  std::vector<CaseVerdict> verdicts = {measured_};
  judge_advice(verdicts);
  const AdviceVerdict& advice = *verdicts[0].advice;
  ASSERT_EQ(advice.trials.size(), 2u);
  EXPECT_EQ(advice.trials[0].configuration, (Parameters{{"/scene/scheme", "cpgimp"}})) << "ugimp is hidden";
  EXPECT_DOUBLE_EQ(advice.metrics.at("advice.hidden"), 90.0 / 40.0);
  EXPECT_EQ(verdicts[0].gates.at(0).status, GateStatus::pass);
  EXPECT_EQ(verdicts[0].gates.at(1).status, GateStatus::fail) << "no promise was put to the test";
}

TEST_F(PutToTheTest, CaseThatWasNotRunHasNone) {
  testing_.status = CaseStatus::not_run;
  EXPECT_FALSE(judged().advice);
  EXPECT_EQ(judged().status, CaseStatus::not_run);
}

TEST_F(PutToTheTest, IsInTheResults) {
  CampaignVerdict campaign;
  testing_.definition.runs.resize(1);
  testing_.definition.text = Json::parse(R"({"scene": {"scheme": "mpm"}, "sweep": [1], "gates": [2]})");
  campaign.cases = {judged()};
  const Json plain = to_json(campaign)["cases"][0];
  EXPECT_EQ(plain["advice"]["of"], "measured");
  EXPECT_EQ(plain["advice"]["metrics"]["advice.kept"], 1.0);
  const Json& trial = plain["advice"]["trials"][1];
  EXPECT_EQ(trial["asked"], 0.05);
  EXPECT_EQ(trial["configuration"]["/scene/scheme"], "ugimp");
  EXPECT_EQ(trial["promised"], 0.04);
  EXPECT_EQ(trial["found"], 0.03);
  EXPECT_TRUE(plain["advice"]["trials"][2]["found"].is_null());
  EXPECT_EQ(plain["scene"]["scheme"], "mpm");
  EXPECT_FALSE(plain.contains("definition")) << "of a case without trades nothing can be drawn";
  campaign.cases[0].definition.trades.emplace_back();
  const Json full = to_json(campaign)["cases"][0];
  EXPECT_EQ(full["definition"]["sweep"], Json::array({1}));
  EXPECT_FALSE(full["definition"].contains("gates"));
}

}  // namespace
}  // namespace mpm::vv
