#include "reports/figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "tests/support/demo_verdict.hpp"

namespace mpm::reports {
namespace {

const vv::FigureRequest& request(const vv::CaseVerdict& verdict, const std::string& id) {
  const auto& figures = verdict.definition.figures;
  return *std::find_if(figures.begin(), figures.end(),
                       [&id](const vv::FigureRequest& f) { return f.id == id; });
}

Plot plot(const vv::CaseVerdict& verdict, const std::string& id) {
  return plot_of(verdict, request(verdict, id));
}

const PlotCurve* curve(const Panel& panel, const std::string& label) {
  for (const PlotCurve& c : panel.curves)
    if (c.label == label) return &c;
  return nullptr;
}

bool notes_mention(const Panel& panel, const std::string& words) {
  return std::any_of(panel.notes.begin(), panel.notes.end(),
                     [&words](const std::string& note) { return note.find(words) != std::string::npos; });
}

TEST(Names, AreThoseAPersonUses) {
  EXPECT_EQ(name_of_parameter("/scene/gravity/level", 50), "50G");
  EXPECT_EQ(name_of_parameter("/scene/gravity/level", 0.5), "0.5G");
  EXPECT_EQ(name_of_parameter("/scene/scheme", "cpgimp"), "cpGIMP");
  EXPECT_EQ(name_of_parameter("/scene/grid/cell_size", "0.005 m"), "<i>h</i> = 5 mm");
  EXPECT_EQ(name_of_parameter("/scene/grid/cell_size", "2.5 mm"), "<i>h</i> = 2.5 mm");
  EXPECT_EQ(name_of_parameter("/scene/update_order", "musl"), "MUSL");
  EXPECT_EQ(name_of_parameter("/scene/some_thing", "a<b"), "some thing a&lt;b");
  EXPECT_EQ(name_of_parameter("/scene/gravity/loading", {{"type", "ramp"}, {"duration", "1 s"}}),
            "ramped load over 1 s");
  EXPECT_EQ(name_of_run({}), "the run");
  EXPECT_EQ(name_of_metric("hencky.settlement"), "error of settlement against Hencky");
  EXPECT_EQ(name_of_metric("cell_crossings"), "cell crossings");
  EXPECT_EQ(name_of_metric("hencky.stress.l2"), "<i>L</i><sub>2</sub> error of stress against Hencky");
}

TEST(Numbers, KeepTheirDigits) {
  EXPECT_EQ(number_markup(0.0), "0");
  EXPECT_EQ(number_markup(0.01234), "0.0123");
  EXPECT_EQ(number_markup(1.2e-5), "1.20×10<sup>−5</sup>");
  EXPECT_EQ(number_markup(-3e-4), "−3.00×10<sup>−4</sup>");
  EXPECT_EQ(number_markup(0.002, 0), "0.002");
  EXPECT_EQ(number_markup(1e-8, 0), "10<sup>−8</sup>");
  EXPECT_EQ(number_markup(25.0, 0), "25");
  EXPECT_EQ(number_markup(std::numeric_limits<double>::quiet_NaN()), "–");
}

TEST(Profiles, DrawTheCurvesOfTheVerdictAndNoOthers) {
  const vv::CaseVerdict verdict = support::demo_levels();
  const Plot stress = plot(verdict, "stress");
  ASSERT_EQ(stress.panels.size(), 4U);
  EXPECT_EQ(stress.panels[3].title, "50G");
  const PlotCurve* drawn = curve(stress.panels[3], "cpGIMP");
  ASSERT_TRUE(drawn);
  const vv::Curve& judged = verdict.runs.back().curves.front();
  ASSERT_EQ(drawn->x.size(), judged.y.size());
  for (std::size_t i = 0; i < judged.y.size(); ++i) {
    EXPECT_DOUBLE_EQ(drawn->x[i], judged.y[i] * 1e-3);
    EXPECT_DOUBLE_EQ(drawn->y[i], judged.x[i]);
  }
  EXPECT_EQ(stress.panels[3].curves.size(), 4U);
}

TEST(Profiles, AxesComeFromTheReferenceWhateverTheRunsDo) {
  vv::CaseVerdict verdict = support::demo_levels();
  const Range before = plot(verdict, "stress").panels[3].x.range;
  EXPECT_GT(before.lower, -600.0);
  EXPECT_LT(before.upper, 100.0);
  for (double& y : verdict.runs[9].curves[0].y) y *= 1e12;
  const Range after = plot(verdict, "stress").panels[3].x.range;
  EXPECT_EQ(before.lower, after.lower);
  EXPECT_EQ(before.upper, after.upper);
}

TEST(Profiles, WildPointsAreCountedNotDropped) {
  const Picture picture = draw(plot(support::demo_levels(), "stress"));
  EXPECT_EQ(picture.layout.panels[0].outside, 0);
  EXPECT_GT(picture.layout.panels[3].outside, 20);
  for (const auto& panel : picture.layout.panels) EXPECT_EQ(panel.points.size(), 200U);
}

TEST(Profiles, ErrorsOfTameSeriesStayReadableBesideAWildOne) {
  const Plot error = plot(support::demo_levels(), "stress_error");
  EXPECT_LT(error.panels[3].x.range.upper, 0.01);
  EXPECT_GT(error.panels[2].x.range.upper, 0.01);
}

TEST(Profiles, ARunThatDidNotCompleteIsNamed) {
  vv::CaseVerdict verdict = support::demo_levels();
  support::demo::record_failure(verdict.runs[9]);
  const Plot stress = plot(verdict, "stress");
  EXPECT_FALSE(curve(stress.panels[3], "MPM"));
  EXPECT_TRUE(notes_mention(stress.panels[3], "MPM did not complete"));
  EXPECT_TRUE(notes_mention(stress.panels[3], "step 12345"));
  EXPECT_FALSE(notes_mention(stress.panels[2], "did not complete"));
}

TEST(Profiles, ACompletedRunWithoutItsCurveIsNamed) {
  vv::CaseVerdict verdict = support::demo_levels();
  verdict.runs[0].curves.clear();
  EXPECT_TRUE(notes_mention(plot(verdict, "stress").panels[0], "was not measured"));
}

TEST(Profiles, SelectorsChooseRuns) {
  vv::CaseVerdict verdict = support::demo_levels();
  vv::FigureRequest chosen = request(verdict, "stress");
  chosen.where = {{support::demo::scheme_pointer, {"cpgimp"}}, {support::demo::level_pointer, {1, 50}}};
  const Plot figure = plot_of(verdict, chosen);
  ASSERT_EQ(figure.panels.size(), 2U);
  EXPECT_FALSE(curve(figure.panels[0], "MPM"));
  chosen.where = {{"/scene/other", {1}}};
  EXPECT_TRUE(notes_mention(plot_of(verdict, chosen).panels.at(0), "No run"));
}

TEST(Convergence, DrawsMetricsAgainstCellSizeWithItsFloor) {
  const vv::CaseVerdict verdict = support::demo_convergence();
  const Plot figure = plot(verdict, "convergence");
  ASSERT_EQ(figure.panels.size(), 2U);
  const PlotCurve* cpgimp = curve(figure.panels[0], "cpGIMP");
  ASSERT_TRUE(cpgimp);
  ASSERT_EQ(cpgimp->x.size(), 5U);
  EXPECT_DOUBLE_EQ(cpgimp->x.front(), 2.5);
  EXPECT_DOUBLE_EQ(cpgimp->x.back(), 40.0);
  EXPECT_DOUBLE_EQ(cpgimp->y.back(), verdict.runs[10].metrics.at("hencky.stress.l2"));
  // The law of these runs is the rate law: its own solution has no floor, the other law's has.
  EXPECT_FALSE(curve(figure.panels[0], "model-form floor (Zhang − Hencky)"));
  EXPECT_TRUE(curve(figure.panels[1], "model-form floor (Zhang − Hencky)"));
  EXPECT_TRUE(notes_mention(figure.panels[0], "MPM did not complete"));
  EXPECT_TRUE(notes_mention(figure.panels[0], "Observed orders of cpGIMP: 1.60"));
}

TEST(Convergence, AMadErrorDoesNotStretchTheAxis) {
  EXPECT_LT(plot(support::demo_convergence(), "convergence").panels[0].y.range.upper, 1.0);
}

TEST(Bars, ShowThresholdsOfTheirGates) {
  const Plot figure = plot(support::demo_levels(), "oscillation");
  ASSERT_EQ(figure.panels.size(), 2U);
  ASSERT_EQ(figure.panels[0].levels.size(), 1U);
  EXPECT_DOUBLE_EQ(figure.panels[0].levels[0].value, 0.01);
  EXPECT_EQ(figure.panels[0].levels[0].label, "≤ 1 %");
  EXPECT_TRUE(figure.panels[1].levels.empty());
  ASSERT_EQ(figure.panels[0].groups.size(), 4U);
  EXPECT_EQ(figure.panels[0].groups[3].name, "50G");
}

TEST(Bars, SayWhichSeriesAGateHolds) {
  vv::CaseVerdict verdict = support::demo_levels();
  EXPECT_EQ(plot(verdict, "oscillation").panels[0].levels.at(0).legend, "gate threshold");
  verdict.definition.gates[0].where = {{support::demo::scheme_pointer, {"cpgimp"}}};
  EXPECT_EQ(plot(verdict, "oscillation").panels[0].levels.at(0).legend, "gate threshold for cpGIMP");
  verdict.definition.gates[0].where = {{support::demo::scheme_pointer, {"another"}}};
  EXPECT_TRUE(plot(verdict, "oscillation").panels[0].levels.empty());
}

TEST(Orders, HaveNoNegativeZero) {
  EXPECT_EQ(orders_markup({1.624, -0.04, -0.001}), "1.62, −0.04, 0.00");
  EXPECT_EQ(orders_markup({std::numeric_limits<double>::quiet_NaN()}), "–");
  EXPECT_EQ(orders_markup({}), "–");
}

TEST(Histories, HaveTheProbesQuantity) {
  const Plot figure = plot(support::demo_levels(), "settling");
  EXPECT_EQ(figure.panels[0].y.label, "displacement <i>u</i><sub>top</sub> [mm]");
  EXPECT_DOUBLE_EQ(figure.panels[0].x.range.upper, 2.0);
}

TEST(Stamp, NamesTheRevisionThatRan) {
  vv::CaseVerdict verdict = support::demo_levels();
  EXPECT_NE(plot(verdict, "stress").stamp.find("0123abcd"), std::string::npos);
  const std::string before = plot(verdict, "stress").stamp;
  verdict.runs[3].record.input_hash = "another";
  EXPECT_NE(plot(verdict, "stress").stamp, before);
}

TEST(Figures, RefuseAnUnknownKind) {
  vv::FigureRequest strange;
  strange.kind = "pie";
  EXPECT_THROW(plot_of(support::demo_levels(), strange), std::invalid_argument);
}

TEST(Figures, EscapeWhatAMetricOrProbeIsCalled) {
  vv::CaseVerdict verdict = support::demo_levels();
  vv::FigureRequest odd = request(verdict, "oscillation");
  odd.metrics = {"a<b & c"};
  EXPECT_NO_THROW(draw(plot_of(verdict, odd)));
}

TEST(Figures, AllKindsRenderInSeconds) {
  const auto start = std::chrono::steady_clock::now();
  for (const vv::CaseVerdict& verdict : {support::demo_levels(), support::demo_convergence()})
    for (const vv::FigureRequest& figure : verdict.definition.figures)
      EXPECT_GT(draw(plot_of(verdict, figure)).canvas.png().size(), 10000U) << figure.id;
  // Six figures take about 2 s on two idle cores; ten times that is a fault, not a busy machine.
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 20.0);
}

}  // namespace
}  // namespace mpm::reports
