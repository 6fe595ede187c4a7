#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "vv/gates.hpp"
#include "vv/norms.hpp"
#include "vv/stability_command.hpp"
#include "vv/survey_runs.hpp"

namespace mpm::vv {
namespace {

/// A damped column of eight cells that soon stands still, judged by Hencky's or by its own smallest step.
Json column_text() {
  return Json::parse(R"({
    "id": "column", "title": "A column", "description": "It settles.",
    "scene": {
      "dimension": 1, "scheme": "cpgimp", "update_order": "usl", "precision": "double", "damping": 0.8,
      "grid": { "cell_size": "0.1 m", "lower": ["0 m"], "upper": ["1 m"],
                "edges": { "x_lower": "fixed", "x_upper": "free" } },
      "bodies": [{ "name": "column", "lower": ["0 m"], "upper": ["0.8 m"], "particles_per_cell": [1],
                   "density": "1000 kg/m^3",
                   "material": { "law": "linear_elastic", "youngs_modulus": "1 MPa", "poissons_ratio": 0 } }],
      "gravity": { "acceleration": ["-9.8 m/s^2"], "level": 1, "loading": { "type": "ramp", "duration": "0.3 s" } },
      "time_step": { "stable_fraction": 0.2 },
      "termination": { "type": "at_time", "time": "1.5 s" }
    },
    "sweep": [{ "parameter": "/scene/update_order", "values": ["usl", "musl"] }],
    "references": ["hencky"],
    "stability": { "from": 0.2, "to": 4, "points": 4, "bisections": 2 },
    "gates": [{ "id": "margin", "metric": "stability.margin", "at_least": 1, "basis": "requirement", "reason": "Safe." }]
  })");
}

Case column(const Json& text = column_text()) { return parse_case(text.dump(), "column.json"); }

TEST(Survey, FindsWhereRunsBeginToDiverge) {
  const Case definition = column();
  const Survey survey = survey_of(definition, definition.runs[0], *definition.survey, {});
  EXPECT_NEAR(survey.own, 0.2, 1e-12);
  EXPECT_GT(survey.linear.limit, 0.6);
  ASSERT_GE(survey.points.size(), 6u);
  EXPECT_TRUE(
      std::is_sorted(survey.points.begin(), survey.points.end(),
                     [](const SurveyPoint& a, const SurveyPoint& b) { return a.fraction < b.fraction; }));
  EXPECT_DOUBLE_EQ(survey.points.front().fraction, 0.2);
  EXPECT_NEAR(survey.points.back().fraction, 4.0, 1e-12);
  EXPECT_GT(survey.stable, 0.2);
  EXPECT_LT(survey.stable, survey.unstable);
  EXPECT_LE(survey.accurate, survey.stable);
  for (const SurveyPoint& point : survey.points) {
    EXPECT_EQ(point.fraction >= survey.unstable, point.stability == StabilityClass::diverged)
        << point.fraction;
    EXPECT_EQ(point.reason.empty(), point.stability != StabilityClass::diverged);
  }
  EXPECT_EQ(survey.points.front().stability, StabilityClass::accurate);
}

TEST(Survey, BisectsTowardsTheFirstThatDiverges) {
  Json text = column_text();
  const auto gap = [&](int bisections) {
    text["stability"]["bisections"] = bisections;
    const Case definition = column(text);
    const Survey survey = survey_of(definition, definition.runs[0], *definition.survey, {});
    return std::log(survey.unstable / survey.stable);
  };
  EXPECT_NEAR(gap(3) / gap(0), 0.125, 1e-6);
}

TEST(Survey, JudgesByHenckyOrByTheSmallestStep) {
  Json text = column_text();
  text["stability"].update({{"to", 0.4}, {"points", 2}});
  const Case exact = column(text);
  text["references"] = Json::array();
  const Case relative = column(text);
  const Survey against_hencky = survey_of(exact, exact.runs[0], *exact.survey, {});
  const Survey against_own = survey_of(relative, relative.runs[0], *relative.survey, {});
  EXPECT_NE(against_hencky.error_name, against_own.error_name);
  EXPECT_GT(against_hencky.points[0].error, 1e-4);  // the cells' error, in any step
  EXPECT_LT(against_hencky.points[0].error, 0.1);
  EXPECT_EQ(against_own.points[0].error, 0.0);
  EXPECT_GT(against_own.points[1].error, 0.0);
  EXPECT_LT(against_own.points[1].error, 1e-2);
  Json strict = column_text();
  strict["stability"].update({{"to", 0.4}, {"points", 2}, {"accuracy", 1e-9}});
  const Case twice = column(strict);
  EXPECT_EQ(survey_of(twice, twice.runs[0], *twice.survey, {}).accurate, 0.4)
      << "twice the least error is accurate";
  strict["stability"]["times_least"] = 1e-3;
  const Case none = column(strict);
  EXPECT_EQ(survey_of(none, none.runs[0], *none.survey, {}).accurate, 0.0);
}

TEST(Survey, HasTheErrorsOfAPlainRun) {
  Json text = column_text();
  text["scene"]["gravity"]["level"] = 10;
  text["stability"].update({{"to", 0.4}, {"points", 2}});
  const Case surveyed = column(text);
  const Survey survey = survey_of(surveyed, surveyed.runs[0], *surveyed.survey, {});
  text.erase("stability");
  text["gates"][0]["metric"] = "completed";
  const Case plain = column(text);
  const auto metrics = judge(plain, plain.runs[0], unsigned_record(plain, plain.runs[0], {})).metrics;
  const double expected = std::max(metrics.at("hencky.stress.l2"), metrics.at("hencky.displacement.l2"));
  // The weights of displacements are volumes before and after, 4 % apart in the mean.
  EXPECT_NEAR(survey.points[0].error / expected, 1, 0.04);
}

TEST(Survey, TakesTheLeastLimitForTheMargin) {
  Json text = column_text();
  text["stability"].update({{"to", 0.3}, {"points", 2}});
  const Case definition = column(text);
  const Record record = unsigned_record(definition, definition.runs[0], {});
  const auto metrics = judge(definition, definition.runs[0], record).metrics;
  EXPECT_GT(metrics.at("stability.linear_limit"), 0.6);
  EXPECT_NEAR(metrics.at("stability.margin"), 0.3 / 0.2, 1e-9) << "no run beyond it says that more is stable";
  EXPECT_FALSE(metrics.contains("stability.unstable"));
}

TEST(Survey, CallsAColumnThatStillSwingsOscillating) {
  Json text = column_text();
  text["scene"]["damping"] = 0.0;
  text["scene"]["gravity"]["loading"] = {{"type", "step"}};
  text["stability"].update({{"to", 0.4}, {"points", 2}});
  const Case definition = column(text);
  const Survey survey = survey_of(definition, definition.runs[1], *definition.survey, {});
  for (const SurveyPoint& point : survey.points) {
    EXPECT_EQ(point.stability, StabilityClass::oscillating);
    EXPECT_GT(point.signal.ringing, 0.1);
  }
}

TEST(Survey, TravelsThroughTheRecord) {
  const Case definition = column();
  const Record record = unsigned_record(definition, definition.runs[0], {});
  ASSERT_TRUE(record.survey);
  EXPECT_TRUE(record.completed());
  EXPECT_GT(record.cost.particle_steps, record.cost.steps);
  EXPECT_EQ(to_json(record_from_json(to_json(record))), to_json(record));
  EXPECT_EQ(unsigned_record(definition, definition.runs[0], {}).digest, record.digest);
}

TEST(Survey, IsToldApartByWhatItAsks) {
  const Json text = column_text();
  const auto hash = [](const Json& of) {
    const Case definition = column(of);
    return input_hash(definition, definition.runs[0]);
  };
  for (const auto& [key, value] : std::vector<std::pair<std::string, Json>>{{"from", 0.3},
                                                                            {"to", 5},
                                                                            {"points", 5},
                                                                            {"bisections", 3},
                                                                            {"runs", false},
                                                                            {"accuracy", 0.02},
                                                                            {"times_least", 3}}) {
    Json other = text;
    other["stability"][key] = value;
    EXPECT_NE(hash(other), hash(text)) << key;
  }
  Json other = text;
  other["references"] = Json::array();
  EXPECT_NE(hash(other), hash(text));
  other = text;
  other["classification"] = {{"limits", {{"zigzag", 0.2}}}};
  EXPECT_NE(hash(other), hash(text));
}

TEST(Survey, EndsWhenItsPulseAsks) {
  const Case definition = column();
  int left = 40;
  EXPECT_THROW(
      survey_of(definition, definition.runs[0], *definition.survey, [&](std::int64_t) { return left-- > 0; }),
      Abandoned);
}

TEST(Survey, HasItsMetricsAndNoOthers) {
  const Case definition = column();
  const Record record = unsigned_record(definition, definition.runs[0], {});
  const Survey& survey = *record.survey;
  const auto metrics = judge(definition, definition.runs[0], record).metrics;
  EXPECT_EQ(metrics.at("stability.linear_limit"), survey.linear.limit);
  EXPECT_EQ(metrics.at("stability.stable"), survey.stable);
  EXPECT_EQ(metrics.at("stability.unstable"), survey.unstable);
  EXPECT_EQ(metrics.at("stability.accurate"), survey.accurate);
  EXPECT_EQ(metrics.at("stability.margin"), std::min(survey.stable, survey.linear.limit) / survey.own);
  // Its domains fill a cell each, so they act as points.
  EXPECT_LT(metrics.at("stability.formula_error"), 0.01);
  EXPECT_FALSE(metrics.contains("hencky.stress.l2"));
  Json text = column_text();
  text["gates"][0]["metric"] = "mass_change";
  EXPECT_THROW(column(text), CaseError);
  text = column_text();
  text.erase("stability");
  EXPECT_THROW(column(text), CaseError);
  text["gates"][0]["metric"] = "mass_change";
  column(text);
}

TEST(Survey, RefusesWhatItCannotDo) {
  for (const auto& [key, value] : std::vector<std::pair<std::string, Json>>{{"from", 0},
                                                                            {"to", 0.1},
                                                                            {"points", 1},
                                                                            {"points", 65},
                                                                            {"bisections", 21},
                                                                            {"accuracy", -1},
                                                                            {"times_least", 0},
                                                                            {"step", 1}}) {
    Json text = column_text();
    text["stability"][key] = value;
    EXPECT_THROW(column(text), CaseError) << key;
  }
  Json text = column_text();
  text["probes"] = Json::array();
  EXPECT_THROW(column(text), CaseError);
}

TEST(StabilityCommand, SurveysTheScenesOfACase) {
  Json text = column_text();
  text.erase("stability");
  text["gates"][0]["metric"] = "completed";
  text["sweep"].push_back({{"parameter", "/scene/gravity/level"}, {"values", {1, 10, 50}}});
  text["probes"] =
      Json::parse(R"([{ "id": "top", "quantity": "displacement", "at": ["0.8 m"], "every": "0.1 s" }])");
  const Case asked = column(text);
  const Case whole = survey_case(asked, Json{{"to", 2}}, 6);
  EXPECT_EQ(whole.runs.size(), 6u);
  ASSERT_TRUE(whole.survey);
  EXPECT_EQ(whole.survey->to, 2.0);
  EXPECT_EQ(whole.references, std::vector<std::string>{"hencky"});
  ASSERT_EQ(whole.figures.size(), 1u);
  EXPECT_EQ(whole.figures[0].map_axis, "/scene/update_order");
  EXPECT_EQ(whole.figures[0].panels, "/scene/gravity/level");
  EXPECT_TRUE(whole.notes.empty());
  const Case cut = survey_case(asked, Json::object(), 5);
  EXPECT_EQ(cut.runs.size(), 2u);
  ASSERT_EQ(cut.notes.size(), 1u);
  EXPECT_NE(cut.notes[0].find("/scene/gravity/level (3 values)"), std::string::npos);
  EXPECT_EQ(survey_case(asked, Json::object(), 1).runs.size(), 1u);
}

RunVerdict surveyed(double own, double linear, double stable, double unstable, double accurate) {
  RunVerdict run;
  Survey& survey = run.record.survey.emplace();
  run.record.time_step = own * 1e-3;
  survey.own = own;
  survey.linear.limit = linear;
  if (linear == 0.0) survey.linear.lack = "every time step is stable";
  for (const double fraction : {0.1, 1.0, 3.0}) survey.points.emplace_back().fraction = fraction;
  survey.stable = stable;
  survey.unstable = unstable;
  survey.accurate = accurate;
  return run;
}

TEST(StabilityCommand, AdvisesByTheLeastLimit) {
  EXPECT_EQ(advice_of(surveyed(0.2, 1.0, 3.0, 0.0, 3.0)),
            "keep it, or at most stable_fraction 0.8 (0.0008 s): a small disturbance grows above 1");
  EXPECT_EQ(advice_of(surveyed(0.2, 0.1, 1.0, 3.0, 1.0)),
            "lower it to stable_fraction 0.08 (8e-05 s): a small disturbance grows above 0.1");
  EXPECT_EQ(advice_of(surveyed(0.9, 2.0, 1.0, 3.0, 1.0)),
            "lower it to stable_fraction 0.8 (0.0008 s), for a reserve: runs diverge above 1");
  EXPECT_EQ(advice_of(surveyed(0.2, 2.0, 3.0, 0.0, 1.0)),
            "keep it, or at most stable_fraction 0.8 (0.0008 s): answers change above 1");
  EXPECT_EQ(advice_of(surveyed(0.2, 0.0, 3.0, 0.0, 3.0)),
            "keep stable_fraction 0.2 (0.0002 s): nothing went wrong at any step tried");
  RunVerdict none = surveyed(0.2, 0.05, 0.0, 0.1, 0.0);
  none.record.survey->points.front().stability = StabilityClass::diverged;
  EXPECT_EQ(advice_of(none), "take a step well below 0.1, the least tried: even that run diverged");
}

}  // namespace
}  // namespace mpm::vv
