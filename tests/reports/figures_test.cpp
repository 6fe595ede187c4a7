#include "reports/figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

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
  EXPECT_EQ(name_of_parameter("/scene/bodies/0/material/friction_angle", "20 deg"), "<i>φ</i> = 20°");
  EXPECT_EQ(name_of_parameter("/scene/bodies/0/material/cohesion", "1 kPa"), "<i>c</i> = 1 kPa");
  EXPECT_EQ(name_of_parameter("cause", "no embedment <1>"), "no embedment &lt;1&gt;");
  EXPECT_EQ(name_of_run({{"cause", "thin layer"}, {"/scene/scheme", "mpm"}}), "thin layer, MPM");
  EXPECT_EQ(name_of_reference("terzaghi"), "Terzaghi, surface");
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

TEST(Names, OfMetricsAndReferencesAreForPeople) {
  EXPECT_EQ(name_of_metric("manufactured.displacement.l2"),
            "<i>L</i><sub>2</sub> error of displacement against the manufactured solution");
  EXPECT_EQ(name_of_metric("limit_analysis.overshoot"), "overshoot of the exact limit load");
  EXPECT_EQ(name_of_metric("bar.frequency"), "error of the bar’s frequency");
  EXPECT_EQ(name_of_metric("metamorphic.mirror_image"), "difference under mirror image");
  EXPECT_EQ(name_of_metric("never_heard_of"), "never heard of");
  EXPECT_EQ(name_of_reference("limit_analysis"), "limit analysis, exact limit load");
  EXPECT_EQ(name_of_reference("a<b"), "a&lt;b");
}

TEST(Curves, PressureHasTheLoadToTheRightAndTheSettlementDown) {
  const vv::CaseVerdict verdict = support::demo_footing();
  const Plot figure = plot(verdict, "settling");
  ASSERT_EQ(figure.panels.size(), 2U);
  const Panel& panel = figure.panels[0];
  EXPECT_EQ(panel.x.label, "pressure [kPa]");
  EXPECT_EQ(panel.y.label, "settlement [mm]");
  EXPECT_TRUE(panel.y.reversed);
  const PlotCurve* drawn = curve(panel, "cpGIMP");
  ASSERT_TRUE(drawn);
  const vv::Curve& judged = verdict.runs[2].curves.front();
  ASSERT_EQ(drawn->x.size(), judged.y.size());
  EXPECT_DOUBLE_EQ(drawn->x.back(), judged.y.back() * 1e-3);
  EXPECT_DOUBLE_EQ(drawn->y.back(), judged.x.back() * 1e3);
  const Picture picture = draw(figure);
  const auto& points = picture.layout.panels[0].points;
  // The first curve goes right and down from the upper left corner.
  EXPECT_LT(points[0].x, points[100].x);
  EXPECT_LT(points[0].y, points[100].y);
  EXPECT_EQ(picture.layout.panels[0].outside, 0);
}

TEST(Curves, DrawEveryReferenceUnlessSomeAreNamed) {
  const vv::CaseVerdict verdict = support::demo_footing();
  const Plot all = plot(verdict, "settling");
  ASSERT_TRUE(curve(all.panels[0], "limit analysis, exact limit load"));
  EXPECT_FALSE(curve(all.panels[0], "limit analysis, exact limit load")->look.dash.empty());
  EXPECT_TRUE(curve(all.panels[0], "elastic strip, exact stiffness"));
  vv::FigureRequest named = request(verdict, "settling");
  named.references = {"limit_analysis"};
  EXPECT_TRUE(curve(plot_of(verdict, named).panels[0], "limit analysis, exact limit load"));
  EXPECT_FALSE(curve(plot_of(verdict, named).panels[0], "elastic strip, exact stiffness"));
}

TEST(Curves, ARunWithoutItsCurveIsNamed) {
  const Plot figure = plot(support::demo_footing(), "settling");
  EXPECT_TRUE(notes_mention(figure.panels[1], "MPM did not complete"));
  EXPECT_FALSE(curve(figure.panels[1], "MPM"));
  EXPECT_FALSE(notes_mention(figure.panels[0], "did not complete"));
}

TEST(Curves, StagesAreLinesAcrossThem) {
  const vv::CaseVerdict verdict = support::demo_footing();
  vv::FigureRequest staged = request(verdict, "settling");
  staged.stages = {0.005, 0.02, 0.08};
  const Panel panel = plot_of(verdict, staged).panels[0];
  ASSERT_EQ(panel.levels.size(), 3U);
  EXPECT_DOUBLE_EQ(panel.levels[1].value, 20.0);
  EXPECT_EQ(panel.levels[0].label, "(i)");
  EXPECT_EQ(panel.levels[2].label, "(iii)");
  EXPECT_GE(panel.y.range.upper, 80.0) << "the axis reaches the last stage";
}

TEST(Curves, BendsAreMarkedWhereTheMetricsSay) {
  const std::string first_bend = "bend of the straight pieces fitted";
  vv::CaseVerdict verdict = support::demo_footing();
  verdict.runs[2].metrics["load_curve.bend_settlement"] = 0.004;
  verdict.runs[2].metrics["load_curve.bend_pressure"] = 3e4;
  verdict.runs[1].metrics["load_curve.bend_settlement"] = 0.004;  // half of a place is none
  vv::FigureRequest marked = request(verdict, "settling");
  EXPECT_FALSE(curve(plot_of(verdict, marked).panels[0], first_bend));
  marked.marks = true;
  const Panel panel = plot_of(verdict, marked).panels[0];
  ASSERT_TRUE(curve(panel, first_bend));
  EXPECT_FALSE(curve(panel, "second bend"));
  std::vector<const PlotCurve*> marks;
  for (const PlotCurve& c : panel.curves)
    if (c.label.empty()) marks.push_back(&c);
  ASSERT_EQ(marks.size(), 1U);
  EXPECT_EQ(marks[0]->x, std::vector<double>{30.0});
  EXPECT_EQ(marks[0]->y, std::vector<double>{4.0});
  EXPECT_EQ(marks[0]->look.color.blue, curve(panel, "cpGIMP")->look.color.blue);
  EXPECT_FALSE(curve(plot_of(verdict, marked).panels[1], first_bend)) << "no run of this panel has one";

  // Of three phases, both bends of the three pieces; of one, none.
  auto& metrics = verdict.runs[2].metrics;
  metrics["load_curve.phases"] = 3.0;
  metrics["load_curve.first_bend_settlement"] = 0.003;
  metrics["load_curve.first_bend_pressure"] = 2e4;
  metrics["load_curve.second_bend_settlement"] = 0.01;
  metrics["load_curve.second_bend_pressure"] = 5e4;
  const Panel bent_twice = plot_of(verdict, marked).panels[0];
  ASSERT_TRUE(curve(bent_twice, "second bend"));
  std::vector<double> settlements;
  for (const PlotCurve& c : bent_twice.curves)
    if (c.label.empty()) settlements.push_back(c.y.at(0));
  EXPECT_EQ(settlements, (std::vector<double>{3.0, 10.0}));
  metrics["load_curve.phases"] = 1.0;
  EXPECT_FALSE(curve(plot_of(verdict, marked).panels[0], first_bend));
}

TEST(Curves, AMissingMeasurementIsNamedAndHasNoPoints) {
  const vv::CaseVerdict verdict = support::demo_footing();
  vv::FigureRequest compared = request(verdict, "settling");
  compared.unavailable = "a picture <only>";
  const Panel panel = plot_of(verdict, compared).panels[0];
  const PlotCurve* entry = curve(panel, "measured: not available, a picture &lt;only&gt;");
  ASSERT_TRUE(entry);
  EXPECT_TRUE(entry->x.empty());
  EXPECT_FALSE(entry->look.dash.empty());
  compared.unavailable.clear();
  for (int k = 0; k < 100; ++k) compared.unavailable += "not here ";
  const Plot longer = plot_of(verdict, compared);
  EXPECT_TRUE(curve(longer.panels[0], "measured: not available"));
  EXPECT_TRUE(notes_mention(longer.panels[0], "Measured: not available (not here not"));
  const Picture picture = draw(longer);
  EXPECT_GE(picture.layout.legend.left, 0.0);
  EXPECT_LE(picture.layout.legend.right, picture.canvas.width());
}

TEST(Curves, AReferenceThatDiffersFromRunToRunHasTheirColours) {
  vv::CaseVerdict verdict = support::demo_footing();
  const std::string name = "limit analysis, exact limit load";
  const auto drawn = [&] {
    std::vector<PlotCurve> curves = plot(verdict, "settling").panels[0].curves;
    std::erase_if(curves, [&name](const PlotCurve& c) { return c.label != name || c.x.empty(); });
    return curves;
  };
  ASSERT_EQ(drawn().size(), 1U);
  EXPECT_EQ(drawn()[0].look.color.red, drawn()[0].look.color.blue) << "black, as all runs share it";
  for (double& y : verdict.runs[2].curves[1].y) y *= 1.5;
  const std::vector<PlotCurve> two = drawn();
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].look.color.red, two[0].look.color.blue) << "still shared by two runs";
  const Plot figure = plot(verdict, "settling");
  const Color own = curve(figure.panels[0], "cpGIMP")->look.color;
  EXPECT_EQ(two[1].look.color.blue, tint(own, 0.25).blue);
  EXPECT_EQ(two[1].look.color.red, tint(own, 0.25).red);
  // The legend shows it in black, as what all of them are.
  const PlotCurve* sample = curve(figure.panels[0], name);
  EXPECT_EQ(sample->look.color.red, sample->look.color.blue);
}

TEST(Curves, StressPathsHaveStrainToTheRight) {
  vv::CaseVerdict verdict = support::demo_footing();
  verdict.runs[0].curves = {{"q", "run", {0.0, 0.02, 0.06}, {0.0, 5e4, 6e4}, "strain"}};
  vv::FigureRequest path = request(verdict, "settling");
  path.quantity = "q";
  const Panel panel = plot_of(verdict, path).panels[0];
  EXPECT_EQ(panel.x.label, "strain <i>ε</i> [%]");
  EXPECT_EQ(panel.y.label, "deviatoric stress <i>q</i> [kPa]");
  EXPECT_FALSE(panel.y.reversed);
  EXPECT_DOUBLE_EQ(curve(panel, "MPM")->x.back(), 6.0);
  EXPECT_DOUBLE_EQ(curve(panel, "MPM")->y.back(), 60.0);
}

/// Three cell sizes of two schemes with a reading of the pressure, which goes to 50 kPa.
vv::CaseVerdict readings() {
  vv::CaseVerdict verdict;
  verdict.definition.readings = {{"deep", "pressure at 25 mm", "pressure", 0.025, 0.0, ""}};
  for (const char* scheme : {"ugimp", "cpgimp"}) {
    vv::SeriesVerdict series;
    series.across = support::demo::size_pointer;
    series.fixed = {{support::demo::scheme_pointer, scheme}};
    for (const double h : {0.02, 0.01, 0.005}) {
      vv::RunVerdict run = support::demo::run(scheme, 1, 10);
      run.parameters = {{support::demo::scheme_pointer, scheme},
                        {support::demo::size_pointer, std::to_string(h) + " m"}};
      run.metrics = {{"reading.deep", 5e4 + 1e6 * h}};
      run.curves = {{"pressure", "terzaghi", {0.0, 0.05}, {3e4, 5e4}, "settlement"}};
      verdict.definition.runs.push_back(support::demo::request(run, h));
      verdict.runs.push_back(run);
    }
    vv::GridConvergence convergence;
    convergence.monotone = true;
    convergence.order = 1.0;
    convergence.extrapolated = std::string(scheme) == "ugimp" ? 5e4 : std::numeric_limits<double>::quiet_NaN();
    convergence.uncertainty = 0.1;
    series.convergence["reading.deep"] = convergence;
    series.orders["reading.deep"] = {1.0};
    verdict.series.push_back(series);
  }
  return verdict;
}

TEST(Names, OfReadingsAreTheirTitles) {
  const vv::CaseVerdict verdict = readings();
  EXPECT_EQ(name_of_metric("reading.deep", verdict.definition), "pressure at 25 mm");
  EXPECT_EQ(name_of_metric("cell_crossings", verdict.definition), "cell crossings");
}

vv::FigureRequest reading_request(const std::string& kind) {
  vv::FigureRequest request;
  request.kind = kind;
  request.over = support::demo::size_pointer;
  request.metrics = {"reading.deep"};
  return request;
}

TEST(Convergence, ReadingsHaveLinearAxesFromZeroAndTheirLimitThere) {
  vv::FigureRequest figure = reading_request("convergence");
  figure.series = support::demo::scheme_pointer;
  const Panel panel = plot_of(readings(), figure).panels.at(0);
  EXPECT_EQ(panel.y.label, "pressure at 25 mm [kPa]");
  EXPECT_EQ(panel.x.scale, Scale::linear);
  EXPECT_EQ(panel.y.scale, Scale::linear);
  EXPECT_LE(panel.x.range.lower, 0.0);
  EXPECT_GT(panel.y.range.lower, 0.0);
  EXPECT_EQ(panel.x.ticks.size(), 4U) << "zero and three sizes";
  const PlotCurve* drawn = curve(panel, "uGIMP");
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->x, (std::vector<double>{5.0, 10.0, 20.0}));
  EXPECT_DOUBLE_EQ(drawn->y[0], 55.0);
  int bars = 0, limits = 0;
  for (const PlotCurve& c : panel.curves) {
    if (!c.label.empty()) continue;
    if (c.x.size() == 6U) {
      ++bars;
      EXPECT_NEAR(c.y.front(), 55.0 - 5.5, 1e-9);
      EXPECT_NEAR(c.y.back(), 55.0 + 5.5, 1e-9);
      EXPECT_LT(std::abs(c.x[2]), 1.0);
    }
    if (c.x.size() == 1U) {
      ++limits;
      EXPECT_DOUBLE_EQ(c.y[0], 50.0);
    }
  }
  EXPECT_EQ(bars, 2);
  EXPECT_EQ(limits, 1) << "nothing is extrapolated where the order is not reliable";
  EXPECT_TRUE(notes_mention(panel, "uGIMP: observed order 1.00, finest value ± 10 %"));
  EXPECT_TRUE(notes_mention(panel, "At <i>h</i> = 0"));
  EXPECT_EQ(draw(plot_of(readings(), figure)).layout.panels[0].outside, 0);
}

TEST(Decomposition, ShowsTheChangeOfEachCauseAgainstTheFirst) {
  vv::CaseVerdict verdict = readings();
  verdict.runs.resize(3);
  for (std::size_t k = 0; k < 3; ++k) {
    const char* names[] = {"as published", "thin <layer>", "half the cells"};
    verdict.runs[k].parameters = {{"cause", names[k]}};
  }
  verdict.runs[1].metrics["reading.deep"] = 8e4;
  verdict.runs[2].metrics.clear();
  vv::FigureRequest figure = reading_request("decomposition");
  figure.over = "cause";
  figure.references = {"terzaghi", "embedded_limit"};
  const RowChart chart = decomposition_of(verdict, figure);
  ASSERT_EQ(chart.panels.size(), 1U);
  const RowPanel& panel = chart.panels[0];
  ASSERT_EQ(panel.rows.size(), 3U);
  EXPECT_EQ(panel.x.label, "pressure at 25 mm [kPa]");
  EXPECT_EQ(panel.rows[1].name, "thin &lt;layer&gt;");
  EXPECT_EQ(panel.rows[0].bars.at(0).text, "70 · baseline");
  EXPECT_EQ(panel.rows[1].bars.at(0).text, "80 · +14 %");
  EXPECT_EQ(panel.rows[2].bars.at(0).text, "not measured");
  EXPECT_DOUBLE_EQ(panel.rows[1].bars[0].value, 80.0);
  EXPECT_EQ(panel.rows[0].bars[0].series, 0U);
  EXPECT_EQ(panel.rows[1].bars[0].series, 1U);
  ASSERT_EQ(panel.lines.size(), 2U) << "the baseline and the one reference that has a curve";
  EXPECT_DOUBLE_EQ(panel.lines[0].value, 70.0);
  EXPECT_DOUBLE_EQ(panel.lines[1].value, 40.0);
  EXPECT_EQ(panel.lines[1].legend, "Terzaghi, surface");
  const Picture picture = draw(chart);
  EXPECT_EQ(picture.layout.panels[0].points.size(), 2U);
  EXPECT_EQ(picture.layout.panels[0].not_finite, 1);
  // No bar reaches into the column of values.
  for (const Rectangle& value : picture.layout.panels[0].annotations)
    for (const Point& end : picture.layout.panels[0].points) EXPECT_LT(end.x, value.left);
}

TEST(Decomposition, WhatElseVariesHasABaselineOfItsOwn) {
  const RowChart chart = decomposition_of(readings(), reading_request("decomposition"));
  ASSERT_EQ(chart.panels.size(), 1U);
  ASSERT_EQ(chart.panels[0].rows.size(), 6U);
  EXPECT_TRUE(chart.panels[0].lines.empty());
  EXPECT_TRUE(chart.panels[0].rows[3].bars[0].text.ends_with("baseline"));
  EXPECT_EQ(chart.panels[0].rows[3].name, "<i>h</i> = 20 mm, cpGIMP");
  vv::FigureRequest paneled = reading_request("decomposition");
  paneled.panels = support::demo::scheme_pointer;
  const RowChart two = decomposition_of(readings(), paneled);
  ASSERT_EQ(two.panels.size(), 2U);
  EXPECT_EQ(two.panels[1].title, "cpGIMP");
  EXPECT_EQ(two.panels[1].lines.size(), 1U);
  paneled.where = {{"/scene/other", {1}}};
  EXPECT_NO_THROW(draw(decomposition_of(readings(), paneled)));
}

TEST(Decomposition, ChangesHaveTheirSign) {
  vv::CaseVerdict verdict = readings();
  verdict.runs.resize(3);
  verdict.runs[1].metrics["reading.deep"] = 7e4 * 0.974;
  verdict.runs[2].metrics["reading.deep"] = 7e4 * 20.0;
  const RowChart chart = decomposition_of(verdict, reading_request("decomposition"));
  EXPECT_TRUE(chart.panels[0].rows[1].bars[0].text.ends_with("· −2.6 %"));
  EXPECT_TRUE(chart.panels[0].rows[2].bars[0].text.ends_with("· ×20"));
}

bool any_mentions(const std::vector<std::string>& notes, const std::string& words) {
  return std::any_of(notes.begin(), notes.end(),
                     [&words](const std::string& note) { return note.find(words) != std::string::npos; });
}

FieldPlot field_plot(const vv::CaseVerdict& verdict, const std::string& id) {
  return field_plot_of(verdict, request(verdict, id));
}

TEST(Fields, HaveARowForEveryRunAndAColumnForEveryMoment) {
  const FieldPlot figure = field_plot(support::demo_footing(), "shear");
  EXPECT_EQ(figure.columns, 3);
  ASSERT_EQ(figure.panels.size(), 9U);
  ASSERT_EQ(figure.heads.size(), 3U);
  EXPECT_EQ(figure.heads[2], "footing = −50 mm");
  EXPECT_EQ(figure.panels[3].title, "50G, uGIMP");
  EXPECT_EQ(figure.panels[4].title, "");
  ASSERT_TRUE(figure.panels[8].map);
  EXPECT_EQ(figure.panels[8].map->value.size(), 1800U);
}

TEST(Fields, AMissingPictureHasItsReasonInItsPlace) {
  vv::CaseVerdict verdict = support::demo_footing();
  verdict.runs[5].record.snapshots.erase(verdict.runs[5].record.snapshots.begin() + 1);
  const FieldPlot figure = field_plot(verdict, "shear");
  EXPECT_TRUE(figure.panels[0].map);
  EXPECT_FALSE(figure.panels[1].map);
  EXPECT_NE(figure.panels[1].note.find("did not complete: a particle left the grid at step 12345"),
            std::string::npos);
  EXPECT_NE(figure.panels[7].note.find("kept no snapshot at footing = −20 mm"), std::string::npos);
  EXPECT_TRUE(any_mentions(figure.notes, "MPM did not complete"));
  const Picture picture = draw(figure);
  EXPECT_EQ(picture.layout.panels[1].annotations.size(), 1U);
  EXPECT_TRUE(picture.layout.panels[8].annotations.empty());
  for (const auto& panel : picture.layout.panels)
    for (const Rectangle& note : panel.annotations) {
      EXPECT_GT(note.left, panel.frame.left);
      EXPECT_LT(note.right, panel.frame.right);
      EXPECT_LT(note.bottom, panel.frame.bottom);
    }
}

TEST(Fields, SnapshotsNoRunReachedAreCounted) {
  vv::CaseVerdict verdict = support::demo_footing();
  verdict.definition.snapshots.resize(5);
  EXPECT_TRUE(any_mentions(field_plot(verdict, "shear").notes, "Of 5 snapshots asked for, 2 came about"));
  EXPECT_FALSE(any_mentions(field_plot(support::demo_footing(), "shear").notes, "asked for"));
  for (vv::RunVerdict& run : verdict.runs) run.record.snapshots.clear();
  const FieldPlot bare = field_plot(verdict, "shear");
  EXPECT_EQ(bare.panels.size(), 3U);
  EXPECT_FALSE(bare.panels[2].note.empty());
  EXPECT_NO_THROW(draw(bare));
}

TEST(Fields, ShareOneScaleInAUnitThatSuitsIt) {
  const vv::CaseVerdict verdict = support::demo_footing();
  const FieldPlot strain = field_plot(verdict, "shear");
  EXPECT_EQ(strain.scale.map, ColorMap::sequential);
  EXPECT_EQ(strain.scale.range.lower, 0.0);
  EXPECT_DOUBLE_EQ(strain.scale.factor, 100.0);
  EXPECT_TRUE(strain.scale.label.ends_with("[%]"));
  const FieldPlot stress = field_plot(verdict, "shear_stress");
  EXPECT_EQ(stress.scale.map, ColorMap::diverging);
  EXPECT_EQ(stress.scale.range.lower, -stress.scale.range.upper);
  EXPECT_TRUE(stress.scale.label.ends_with("[kPa]"));
}

TEST(Fields, AFewWildValuesAreToldNotScaledTo) {
  vv::CaseVerdict verdict = support::demo_footing();
  for (vv::RunVerdict& run : verdict.runs)
    for (vv::Snapshot& snapshot : run.record.snapshots)
      for (std::size_t p = 0; p < snapshot.fields.volume.size(); ++p)
        snapshot.fields.stress[4 * p + 3] = 9e3 * std::sin(0.01 * static_cast<double>(p));
  const FieldPlot before = field_plot(verdict, "shear_stress");
  verdict.runs[0].record.snapshots[1].fields.stress[4 * 17 + 3] = 7e7;
  const FieldPlot after = field_plot(verdict, "shear_stress");
  EXPECT_LE(after.scale.range.upper, before.scale.range.upper * 1.001);
  EXPECT_GE(after.scale.range.upper, before.scale.range.upper * 0.4);
  ASSERT_TRUE(after.scale.above);
  EXPECT_DOUBLE_EQ(*after.scale.above, 7e4);
  EXPECT_TRUE(any_mentions(after.notes, "percentiles 0.5 to 99.5"));
  EXPECT_TRUE(any_mentions(after.notes, " of 16200 values drawn"));
  EXPECT_FALSE(before.scale.above);
  EXPECT_TRUE(before.notes.empty());
}

TEST(Fields, ARunThatDidNotCompleteDecidesNeitherViewNorColours) {
  vv::CaseVerdict verdict = support::demo_footing();
  const FieldPlot before = field_plot(verdict, "shear");
  ParticleFields& wild = verdict.runs[3].record.snapshots[0].fields;
  for (double& x : wild.position) x *= 40.0;
  for (double& e : wild.strain) e *= 1e6;
  const FieldPlot after = field_plot(verdict, "shear");
  EXPECT_EQ(before.x.upper, after.x.upper);
  EXPECT_EQ(before.scale.range.upper, after.scale.range.upper);
  EXPECT_TRUE(after.scale.above);
  EXPECT_GT(draw(after).layout.panels[0].outside, 1000);
}

TEST(Fields, AFewStrayParticlesDoNotShrinkTheRest) {
  vv::CaseVerdict verdict = support::demo_footing();
  EXPECT_GE(field_plot(verdict, "shear").x.upper, 2.0);
  verdict.runs[5].record.snapshots[2].fields.position[0] = 90.0;
  const FieldPlot figure = field_plot(verdict, "shear");
  EXPECT_LT(figure.x.upper, 2.3);
  EXPECT_GE(figure.x.upper, 2.0);
  EXPECT_EQ(draw(figure).layout.panels[8].outside, 1);
}

TEST(Fields, OneMomentFlowsAsItFitsBest) {
  vv::CaseVerdict verdict = support::demo_footing();
  for (vv::RunVerdict& run : verdict.runs)
    if (run.record.completed())
      run.record.snapshots.erase(run.record.snapshots.begin() + 1, run.record.snapshots.end());
  vv::FigureRequest all = request(verdict, "shear");
  all.where.clear();
  const FieldPlot figure = field_plot_of(verdict, all);
  EXPECT_EQ(figure.panels.size(), 6U);
  EXPECT_EQ(figure.columns, 3);
  EXPECT_EQ(figure.panels[1].title, "1G, uGIMP");
  EXPECT_EQ(figure.heads, std::vector<std::string>{"footing = −5 mm"});
}

/// The demo's footing with the snapshots that its records hold asked for by name.
vv::CaseVerdict footing_with_moments() {
  vv::CaseVerdict verdict = support::demo_footing();
  using When = vv::SnapshotRequest::When;
  verdict.definition.snapshots = {
      {When::time, 0.5, "", 0.0}, {When::passing, 0.0, "footing", -0.02}, {When::end, 0.0, "", 0.0}};
  for (vv::RunVerdict& run : verdict.runs)
    for (std::size_t k = 0; k < run.record.snapshots.size(); ++k)
      run.record.snapshots[k].moment = vv::moment_of(verdict.definition.snapshots[k]);
  return verdict;
}

TEST(Fields, OnlyTheSnapshotsChosenHaveColumns) {
  const vv::CaseVerdict verdict = footing_with_moments();
  vv::FigureRequest chosen = request(verdict, "shear");
  chosen.snapshots = {2, 1};
  const FieldPlot figure = field_plot_of(verdict, chosen);
  ASSERT_EQ(figure.heads.size(), 2U);
  EXPECT_EQ(figure.heads[0], "end");
  EXPECT_EQ(figure.heads[1], "footing = −20 mm");
  ASSERT_EQ(figure.panels.size(), 6U);
  EXPECT_EQ(figure.panels[4].map->moment, "end");
  EXPECT_NE(figure.panels[0].note.find("did not complete"), std::string::npos);
  EXPECT_FALSE(any_mentions(figure.notes, "came about"));
}

TEST(Fields, AChosenSnapshotThatNeverCameIsCounted) {
  vv::CaseVerdict verdict = footing_with_moments();
  for (vv::RunVerdict& run : verdict.runs)
    if (run.record.snapshots.size() > 1) run.record.snapshots.erase(run.record.snapshots.begin() + 1);
  vv::FigureRequest chosen = request(verdict, "shear");
  chosen.snapshots = {0, 1};
  const FieldPlot figure = field_plot_of(verdict, chosen);
  EXPECT_EQ(figure.panels.size(), 6U);
  EXPECT_TRUE(any_mentions(figure.notes, "Of 2 snapshots asked for, 1 came about in no run."));
}

TEST(Fields, AMissingMeasurementHasARowOfHatchedFrames) {
  const vv::CaseVerdict verdict = footing_with_moments();
  vv::FigureRequest compared = request(verdict, "shear");
  compared.where.push_back({support::demo::scheme_pointer, {"cpgimp"}});
  compared.unavailable = "only a <picture>";
  const FieldPlot figure = field_plot_of(verdict, compared);
  ASSERT_EQ(figure.panels.size(), 6U);
  EXPECT_EQ(figure.columns, 3);
  EXPECT_EQ(figure.heads.size(), 3U);
  EXPECT_EQ(figure.panels[3].title, "measured: not available");
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(figure.panels[i].hatched, i >= 3);
    EXPECT_EQ(figure.panels[i].map.has_value(), i < 3);
  }
  EXPECT_EQ(figure.panels[5].note, "only a &lt;picture&gt;");
  const Picture picture = draw(figure);
  EXPECT_DOUBLE_EQ(picture.layout.panels[5].frame.width(), picture.layout.panels[2].frame.width());
  EXPECT_DOUBLE_EQ(picture.layout.panels[5].frame.height(), picture.layout.panels[2].frame.height());
  EXPECT_TRUE(picture.layout.panels[5].points.empty());
}

TEST(Fields, OfOneMomentTheMissingMeasurementIsOnePanelMore) {
  const vv::CaseVerdict verdict = footing_with_moments();
  vv::FigureRequest compared = request(verdict, "shear");
  compared.snapshots = {0};
  compared.unavailable = "none";
  EXPECT_EQ(field_plot_of(verdict, compared).panels.size(), 4U);
  compared.unavailable.clear();
  EXPECT_EQ(field_plot_of(verdict, compared).panels.size(), 3U);
}

TEST(Fields, ShowThePartThatIsAskedFor) {
  const vv::CaseVerdict verdict = support::demo_footing();
  vv::FigureRequest zoomed = request(verdict, "shear");
  zoomed.view = {{0.0, 0.5}, {0.8, 1.0}};
  const FieldPlot figure = field_plot_of(verdict, zoomed);
  EXPECT_EQ(figure.x.upper, 0.8);
  EXPECT_EQ(figure.y.lower, 0.5);
  EXPECT_EQ(figure.scale.range.upper, field_plot(verdict, "shear").scale.range.upper);
  EXPECT_GT(draw(figure).layout.panels[8].outside, 900);
}

TEST(Model, HasAPanelForEveryRunSelected) {
  vv::CaseVerdict verdict = support::demo_footing();
  for (vv::RunRequest& run : verdict.definition.runs) run.scene.dimension = 2;
  vv::FigureRequest model;
  model.kind = "model";
  model.where = {{support::demo::scheme_pointer, {"cpgimp"}}};
  const ModelPlot figure = model_plot_of(verdict, model);
  ASSERT_EQ(figure.panels.size(), 2U);
  EXPECT_EQ(figure.panels[0].title, "1G");
  EXPECT_EQ(figure.panels[1].title, "50G");
  EXPECT_EQ(figure.panels[1].scene.bodies.at(0).name, "column");
  model.where = {{"/scene/other", {1}}};
  EXPECT_TRUE(any_mentions(model_plot_of(verdict, model).notes, "No run was selected"));
  EXPECT_NO_THROW(picture_of(verdict, model));
}

TEST(Fields, SayWhyARunHasNoField) {
  vv::CaseVerdict verdict = support::demo_footing();
  for (vv::Snapshot& snapshot : verdict.runs[5].record.snapshots) snapshot.fields.strain.clear();
  EXPECT_NE(field_plot(verdict, "shear").panels[8].note.find("did not sum"), std::string::npos);
  vv::FigureRequest odd = request(verdict, "shear");
  odd.quantity = "temperature";
  EXPECT_THROW(field_plot_of(verdict, odd), std::invalid_argument);
  odd = request(verdict, "shear");
  odd.where = {{"/scene/other", {1}}};
  EXPECT_NE(field_plot_of(verdict, odd).panels.at(0).note.find("No run"), std::string::npos);
  EXPECT_NO_THROW(draw(field_plot_of(verdict, odd)));
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
  EXPECT_THROW(picture_of(support::demo_levels(), strange), std::invalid_argument);
}

TEST(Figures, EscapeWhatAMetricOrProbeIsCalled) {
  vv::CaseVerdict verdict = support::demo_levels();
  vv::FigureRequest odd = request(verdict, "oscillation");
  odd.metrics = {"a<b & c"};
  EXPECT_NO_THROW(draw(plot_of(verdict, odd)));
}

TEST(Figures, AllKindsRenderInSeconds) {
  const auto start = std::chrono::steady_clock::now();
  for (const vv::CaseVerdict& verdict :
       {support::demo_levels(), support::demo_convergence(), support::demo_footing()})
    for (const vv::FigureRequest& figure : verdict.definition.figures)
      EXPECT_GT(picture_of(verdict, figure).canvas.png().size(), 10000U) << figure.id;
  // Nine figures take about 3 s on two idle cores; many times that is a fault, not a busy machine.
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 30.0);
}

}  // namespace
}  // namespace mpm::reports
