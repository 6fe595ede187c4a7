#include "reports/validation_figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reports/figures.hpp"
#include "tests/support/demo_validation.hpp"

namespace mpm::reports {
namespace {

using support::demo::scheme_pointer;

const PlotCurve* curve(const Panel& panel, const std::string& label) {
  for (const PlotCurve& c : panel.curves)
    if (c.label == label) return &c;
  return nullptr;
}

const Band* band(const Panel& panel, const std::string& label) {
  for (const Band& b : panel.bands)
    if (b.label == label) return &b;
  return nullptr;
}

bool mention(const std::vector<std::string>& texts, const std::string& words) {
  return std::any_of(texts.begin(), texts.end(),
                     [&words](const std::string& text) { return text.find(words) != std::string::npos; });
}

/// The demo's first figure of the measurement alone, of the run of one scheme if one is named.
vv::FigureRequest surfaces(const vv::CaseVerdict& verdict, const std::string& measurement,
                           const std::string& scheme = "") {
  vv::FigureRequest request = verdict.definition.figures.at(0);
  request.measurements = {measurement};
  if (!scheme.empty()) request.where = {{scheme_pointer, {scheme}}};
  return request;
}

/// A changed copy of the file of a measurement.
template <class Change>
void change_file(vv::CaseVerdict& verdict, std::size_t measurement, Change change) {
  auto file = std::make_shared<vv::CurveFile>(*verdict.definition.measurements.at(measurement).file);
  change(*file);
  verdict.definition.measurements[measurement].file = file;
}

const std::string measured_label = "measured ± 2<i>u</i>, reading only [Demo00, Figure 3]";

// ---- comparison
// --------------------------------------------------------------------------------------------------

TEST(ComparisonFigure, HasTheMeasuredPointsInTheUnitOfTheirFile) {
  const vv::CaseVerdict verdict = support::demo_collapse();
  const Plot figure = plot_of(verdict, surfaces(verdict, "final_surface"));
  ASSERT_EQ(figure.panels.size(), 2U);
  EXPECT_EQ(figure.stack, 2);
  const Panel& above = figure.panels[0];
  EXPECT_EQ(above.title, "Surface of a collapsed heap");
  EXPECT_EQ(above.y.label, "height [mm]");
  EXPECT_EQ(figure.panels[1].x.label, "distance [mm]");
  EXPECT_EQ(figure.panels[1].y.label, "difference [mm]");
  const PlotCurve* points = curve(above, measured_label);
  ASSERT_TRUE(points);
  const vv::CurveFile& file = *verdict.definition.measurements[0].file;
  const vv::CurveComparison& compared = verdict.runs[0].comparisons[0];
  ASSERT_EQ(points->x.size(), file.rows.size());
  ASSERT_EQ(points->bars.size(), file.rows.size());
  for (std::size_t i = 0; i < points->x.size(); ++i) {
    EXPECT_DOUBLE_EQ(points->x[i], file.rows[i][0] * 1e3);
    EXPECT_DOUBLE_EQ(points->y[i], file.rows[i][1] * 1e3);
    EXPECT_DOUBLE_EQ(points->bars[i], 2e3 * compared.u_measured[i]);
  }
  EXPECT_EQ(points->look.line_width, 0.0);
}

TEST(ComparisonFigure, SaysWhoseUncertaintyTheBarsAre) {
  using Stated = vv::StatedUncertainty;
  vv::CaseVerdict verdict = support::demo_collapse();
  const auto label_with = [&verdict](Stated digitisation, Stated experimental) {
    change_file(verdict, 0, [&](vv::CurveFile& file) {
      file.columns[1].digitisation = digitisation;
      file.columns[1].experimental = experimental;
      file.by_way_of = "Other01";
    });
    return plot_of(verdict, surfaces(verdict, "final_surface")).panels[0].curves.at(0).label;
  };
  const Stated stated{Stated::Kind::absolute, 1e-3}, none{Stated::Kind::none}, silent;
  const std::string source = " [Demo00, Figure 3 by way of Other01]";
  EXPECT_EQ(label_with(stated, stated), "measured ± 2<i>u</i> of experiment and reading" + source);
  EXPECT_EQ(label_with(none, stated), "measured ± 2<i>u</i> of experiment and reading" + source);
  EXPECT_EQ(label_with(stated, silent), "measured ± 2<i>u</i>, reading only" + source);
  EXPECT_EQ(label_with(silent, stated), "measured ± 2<i>u</i> of the experiment" + source);
  EXPECT_EQ(label_with(silent, silent), "measured, uncertainty not stated" + source);
}

TEST(ComparisonFigure, PointsNoRunReachesHaveTheUncertaintyOfTheirColumn) {
  vv::CaseVerdict verdict = support::demo_collapse();
  for (vv::RunVerdict& run : verdict.runs) {
    vv::CurveComparison& c = run.comparisons[0];
    for (std::vector<double>* values :
         {&c.abscissa, &c.measured, &c.simulated, &c.u_measured, &c.u_numerical, &c.u_input, &c.u_validation})
      values->erase(values->begin());
  }
  const Plot figure = plot_of(verdict, surfaces(verdict, "final_surface"));
  const PlotCurve* points = curve(figure.panels[0], measured_label);
  ASSERT_TRUE(points);
  EXPECT_DOUBLE_EQ(points->bars[0], 2.0);  // 2 times 1 mm of reading
  EXPECT_DOUBLE_EQ(points->bars[1], 2e3 * verdict.runs[0].comparisons[0].u_measured[0]);
  EXPECT_DOUBLE_EQ(points->x[0], 200.0);
}

TEST(ComparisonFigure, ManyPointsHaveABandInPlaceOfBars) {
  vv::CaseVerdict verdict = support::demo_collapse();
  verdict.definition.measurements[0].file = support::demo::surface_file(61);
  for (vv::RunVerdict& run : verdict.runs)
    run.comparisons[0] =
        support::demo::comparison(verdict.definition.measurements[0], 1.0, vv::Agreement::validated);
  const Panel above = plot_of(verdict, surfaces(verdict, "final_surface", "cpgimp")).panels[0];
  const PlotCurve* points = curve(above, "measured ± 2<i>u</i>, reading only, shaded [Demo00, Figure 3]");
  ASSERT_TRUE(points);
  EXPECT_TRUE(points->bars.empty());
  ASSERT_EQ(above.bands.size(), 2U);
  EXPECT_TRUE(above.bands[0].label.empty()) << "the points say what it is";
  EXPECT_DOUBLE_EQ(above.bands[0].upper[7],
                   points->y[7] + 2e3 * verdict.runs[0].comparisons[0].u_measured[7]);
  EXPECT_GE(above.y.range.upper, above.bands[0].upper[0]);
}

TEST(ComparisonFigure, HasTheRunsWholeCurvesWithTheirOwnUncertainty) {
  const vv::CaseVerdict verdict = support::demo_collapse();
  const Panel above = plot_of(verdict, surfaces(verdict, "final_surface", "ugimp")).panels[0];
  const PlotCurve* run = curve(above, "uGIMP");
  ASSERT_TRUE(run);
  // Cut where the picture ends, a little beyond the measured places, not at them.
  EXPECT_DOUBLE_EQ(run->x.front(), above.x.range.lower);
  EXPECT_DOUBLE_EQ(run->x.back(), above.x.range.upper);
  EXPECT_LT(above.x.range.lower, 200.0);
  EXPECT_GT(above.x.range.lower, 150.0);
  EXPECT_NEAR(run->y.front(), 1.12e3 * support::demo::surface(above.x.range.lower * 1e-3), 0.02);
  EXPECT_GT(run->x.size(), 50U);
  const Band* own = band(above, "± 2<i>u</i> of a run");
  ASSERT_TRUE(own);
  const vv::CurveComparison& c = verdict.runs[0].comparisons[0];
  ASSERT_EQ(own->x.size(), c.abscissa.size());
  EXPECT_DOUBLE_EQ(own->x[3], c.abscissa[3] * 1e3);
  EXPECT_NEAR(own->upper[3], (c.simulated[3] + 2e-3) * 1e3, 1e-9);  // 2 hypot(0.8, 0.6) mm
  EXPECT_NEAR(own->lower[3], (c.simulated[3] - 2e-3) * 1e3, 1e-9);
  EXPECT_EQ(own->color.blue, run->look.color.blue);
  EXPECT_LT(own->color.alpha, 1.0);
}

TEST(ComparisonFigure, HasTheDifferenceBelowAndTheVerdict) {
  const vv::CaseVerdict verdict = support::demo_collapse();
  const Plot figure = plot_of(verdict, surfaces(verdict, "final_surface", "ugimp"));
  const Panel& below = figure.panels[1];
  EXPECT_EQ(below.title, "Model error detected");
  EXPECT_EQ(below.x.range.lower, figure.panels[0].x.range.lower);
  EXPECT_EQ(below.x.range.upper, figure.panels[0].x.range.upper);
  EXPECT_TRUE(below.absence.empty());
  const PlotCurve* difference = curve(below, "uGIMP");
  ASSERT_TRUE(difference);
  const vv::CurveComparison& c = verdict.runs[0].comparisons[0];
  ASSERT_EQ(difference->y.size(), c.abscissa.size());
  for (std::size_t i = 0; i < c.abscissa.size(); ++i)
    EXPECT_NEAR(difference->y[i], (c.simulated[i] - c.measured[i]) * 1e3, 1e-9);
  const Band* uncertainty = band(below, "± 2<i>u</i><sub>val</sub> of a run");
  ASSERT_TRUE(uncertainty);
  EXPECT_EQ(uncertainty->color.red, uncertainty->color.blue) << "grey beside one run";
  EXPECT_DOUBLE_EQ(uncertainty->upper[5], 2e3 * c.u_validation[5]);
  EXPECT_DOUBLE_EQ(uncertainty->lower[5], -2e3 * c.u_validation[5]);
  EXPECT_EQ(below.curves.at(0).y, (std::vector<double>{0.0, 0.0}));
  ASSERT_EQ(below.notes.size(), 1U);
  EXPECT_EQ(below.notes[0],
            "71 % of 17 points inside 2<i>u</i><sub>val</sub>, <i>C</i> = 0.043, excess 1.9 % of the largest "
            "height; 2<i>u</i><sub>val</sub> is 4.3 % of it");
}

TEST(ComparisonFigure, TellsSeveralRunsApart) {
  const vv::CaseVerdict verdict = support::demo_collapse();
  const Plot figure = plot_of(verdict, surfaces(verdict, "final_surface"));
  const Panel& below = figure.panels[1];
  EXPECT_EQ(below.title, "Simulated minus measured") << "the verdicts differ";
  ASSERT_EQ(below.bands.size(), 3U);
  EXPECT_EQ(below.bands[0].color.blue, curve(below, "uGIMP")->look.color.blue);
  EXPECT_EQ(below.bands[1].color.blue, curve(below, "cpGIMP")->look.color.blue);
  EXPECT_TRUE(below.bands[2].x.empty()) << "a sample for the legend";
  EXPECT_EQ(below.bands[2].label, "± 2<i>u</i><sub>val</sub> of a run in its colour, below");
  EXPECT_TRUE(mention(below.notes, "uGIMP, model error detected: 71 %"));
  EXPECT_TRUE(mention(below.notes, "cpGIMP, validated at this level: 100 %"));
  EXPECT_FALSE(mention({below.notes.at(1)}, "excess"));
}

TEST(ComparisonFigure, SaysWhatWasAskedOfAnInconclusiveOneAndWhatWasAdjusted) {
  vv::CaseVerdict verdict = support::demo_collapse();
  vv::CurveComparison& c = verdict.runs[1].comparisons[0];
  c.agreement = vv::Agreement::inconclusive;
  c.level = 0.23;
  change_file(verdict, 0, [](vv::CurveFile& file) { file.used_for_calibration = true; });
  const Panel below = plot_of(verdict, surfaces(verdict, "final_surface", "cpgimp")).panels[1];
  EXPECT_EQ(below.title, "Inconclusive");
  EXPECT_TRUE(mention(below.notes, "is 23 % of the largest height, asked for at most 5 %"));
  EXPECT_TRUE(mention(below.notes, "was adjusted to this measurement"));
}

TEST(ComparisonFigure, AnEmptySlotIsAHatchedFrameBelowTheRuns) {
  const vv::CaseVerdict verdict = support::demo_collapse();
  const Plot figure = plot_of(verdict, surfaces(verdict, "other_surface"));
  ASSERT_EQ(figure.panels.size(), 2U);
  const Panel &above = figure.panels[0], &below = figure.panels[1];
  EXPECT_EQ(below.absence, "No measurement: slot <i>demo_other</i> is empty");
  EXPECT_TRUE(below.hatched);
  EXPECT_EQ(above.curves.size(), 2U) << "two runs and nothing measured";
  EXPECT_EQ(curve(above, "uGIMP")->x.size(), verdict.runs[0].curves[0].x.size());
  EXPECT_EQ(above.x.label, "distance [mm]");
  EXPECT_TRUE(above.bands.empty());
  const Picture picture = draw(figure);
  EXPECT_EQ(picture.layout.panels[1].annotations.size(), 1U);
  EXPECT_TRUE(picture.layout.panels[1].points.empty());
}

TEST(ComparisonFigure, ARunThatCouldNotBeComparedHasItsReason) {
  vv::CaseVerdict verdict = support::demo_collapse();
  vv::CurveComparison& c = verdict.runs[0].comparisons[0];
  c = {};
  c.measurement = "final_surface";
  c.lack = "it covers 40 % <only>";
  const Plot alone = plot_of(verdict, surfaces(verdict, "final_surface", "ugimp"));
  EXPECT_EQ(alone.panels[1].absence, "Not compared: it covers 40 % &lt;only&gt;");
  EXPECT_FALSE(alone.panels[1].hatched);
  EXPECT_TRUE(curve(alone.panels[0], measured_label));
  EXPECT_TRUE(curve(alone.panels[0], "uGIMP")) << "with nothing to stand back behind";
  const Plot both = plot_of(verdict, surfaces(verdict, "final_surface"));
  EXPECT_TRUE(both.panels[1].absence.empty());
  EXPECT_EQ(both.panels[1].title, "Validated at this level");
  EXPECT_TRUE(mention(both.panels[1].notes, "uGIMP, not compared: it covers 40 % &lt;only&gt;"));
  const PlotCurve* pale = curve(both.panels[0], "uGIMP, not compared");
  ASSERT_TRUE(pale);
  EXPECT_LT(pale->look.line_width, curve(both.panels[0], "cpGIMP")->look.line_width);
  EXPECT_FALSE(curve(both.panels[1], "uGIMP"));
  verdict.runs[0].comparisons.clear();
  EXPECT_EQ(plot_of(verdict, surfaces(verdict, "final_surface", "ugimp")).panels[1].absence,
            "None of these runs is compared with it.");
}

TEST(ComparisonFigure, ARunWithoutItsCurveIsNamed) {
  vv::CaseVerdict verdict = support::demo_collapse();
  support::demo::record_failure(verdict.runs[0]);
  verdict.runs[0].comparisons.clear();
  const Panel above = plot_of(verdict, surfaces(verdict, "final_surface")).panels[0];
  EXPECT_TRUE(mention(above.notes, "uGIMP did not complete"));
  EXPECT_FALSE(curve(above, "uGIMP"));
  EXPECT_TRUE(curve(above, "cpGIMP"));
}

TEST(ComparisonFigure, AWildRunDoesNotStretchTheAxes) {
  vv::CaseVerdict verdict = support::demo_collapse();
  const Plot before = plot_of(verdict, surfaces(verdict, "final_surface", "cpgimp"));
  for (double& y : verdict.runs[0].curves[0].y) y *= 1e4;
  for (double& y : verdict.runs[0].comparisons[0].simulated) y *= 1e4;
  const Plot after = plot_of(verdict, surfaces(verdict, "final_surface"));
  EXPECT_DOUBLE_EQ(after.panels[0].y.range.upper, before.panels[0].y.range.upper);
  EXPECT_DOUBLE_EQ(after.panels[1].y.range.upper, before.panels[1].y.range.upper);
  EXPECT_GT(draw(after).layout.panels[1].outside, 10);
  for (double& x : verdict.runs[1].curves[0].x) x *= 1e4;
  const Plot slot = plot_of(verdict, surfaces(verdict, "other_surface"));
  EXPECT_LT(slot.panels[0].x.range.upper, 600.0) << "the tame run's places";
}

TEST(ComparisonFigure, StandsInPairsSideBySide) {
  vv::CaseVerdict verdict = support::demo_collapse();
  vv::FigureRequest request = verdict.definition.figures[0];
  const Picture picture = draw(plot_of(verdict, request));
  ASSERT_EQ(picture.layout.panels.size(), 4U);
  const auto& panels = picture.layout.panels;
  EXPECT_EQ(panels[0].frame.left, panels[1].frame.left);
  EXPECT_GT(panels[1].frame.top, panels[0].frame.bottom);
  EXPECT_EQ(panels[2].frame.left, panels[3].frame.left);
  EXPECT_GT(panels[2].frame.left, panels[0].frame.right);
  EXPECT_EQ(panels[0].frame.top, panels[2].frame.top);
  EXPECT_LT(panels[1].frame.height(), panels[0].frame.height());
  EXPECT_GE(picture.layout.legend.left, 0.0);
  EXPECT_LE(picture.layout.legend.right, picture.canvas.width());
  for (const auto& panel : panels) EXPECT_EQ(panel.outside, 0);
  // The same of an axis that separates panels.
  request.measurements = {"final_surface"};
  request.panels = scheme_pointer;
  request.series.clear();
  change_file(verdict, 0, [](vv::CurveFile& file) { file.title += " of well-rounded gravel"; });
  const Plot separate = plot_of(verdict, request);
  ASSERT_EQ(separate.panels.size(), 4U);
  EXPECT_EQ(separate.panels[2].title, "cpGIMP: final surface") << "its whole title has no room";
  EXPECT_EQ(separate.panels[3].title, "Validated at this level");
}

TEST(ComparisonFigure, SaysWhenThereIsNothingToCompare) {
  const vv::CaseVerdict verdict = support::demo_collapse();
  const Plot nobody = plot_of(verdict, surfaces(verdict, "final_surface", "mpm"));
  EXPECT_TRUE(mention({nobody.panels.at(0).absence}, "No run was selected"));
  const Plot nothing = plot_of(verdict, surfaces(verdict, "never_heard_of"));
  EXPECT_TRUE(mention({nothing.panels.at(0).absence}, "No measurement was chosen"));
  EXPECT_NO_THROW(draw(nobody));
}

// ---- fields
// -----------------------------------------------------------------------------------------------------

FieldPlot fields(const vv::CaseVerdict& verdict) {
  return field_plot_of(verdict, verdict.definition.figures.at(1));
}

TEST(MeasuredLines, StandOnTheLastMomentInMetres) {
  const FieldPlot figure = fields(support::demo_collapse());
  ASSERT_EQ(figure.panels.size(), 4U);  // two runs at two moments
  EXPECT_TRUE(figure.panels[0].lines.empty());
  ASSERT_EQ(figure.panels[1].lines.size(), 1U);
  ASSERT_EQ(figure.panels[3].lines.size(), 1U);
  const FieldLine& line = figure.panels[1].lines[0];
  EXPECT_EQ(line.label, "measured free surface: Surface of a collapsed heap [Demo00, Figure 3]");
  EXPECT_DOUBLE_EQ(line.x.front(), 0.2);
  EXPECT_DOUBLE_EQ(line.y.front(), support::demo::surface(0.2));
  ASSERT_EQ(figure.absent_lines.size(), 1U);
  EXPECT_EQ(figure.absent_lines[0].label, "No measurement: slot <i>demo_other</i> is empty");
}

TEST(MeasuredLines, OfACutStandAtItsSnapshotAndOnlyOnRunsThatAreCompared) {
  vv::CaseVerdict verdict = support::demo_collapse();
  vv::Cut cut;
  cut.id = "free_surface";
  cut.snapshot = 0;
  verdict.definition.cuts = {cut};
  verdict.definition.snapshots[0].when = vv::SnapshotRequest::When::time;
  const std::string first = vv::moment_of(verdict.definition.snapshots[0]);
  for (vv::RunVerdict& run : verdict.runs) run.record.snapshots[0].moment = first;
  FieldPlot figure = fields(verdict);
  EXPECT_EQ(figure.panels[0].lines.size(), 1U);
  EXPECT_TRUE(figure.panels[1].lines.empty());
  verdict.definition.measurements[0].where = {{scheme_pointer, {"cpgimp"}}};
  figure = fields(verdict);
  EXPECT_TRUE(figure.panels[0].lines.empty());
  EXPECT_EQ(figure.panels[2].lines.size(), 1U);
}

TEST(MeasuredLines, TheViewGrowsToHoldThemUnlessItIsGiven) {
  vv::CaseVerdict verdict = support::demo_collapse();
  change_file(verdict, 0, [](vv::CurveFile& file) { file.rows.back() = {2.7, 1.4}; });
  EXPECT_DOUBLE_EQ(fields(verdict).x.upper, 2.7);
  EXPECT_DOUBLE_EQ(fields(verdict).y.upper, 1.4);
  verdict.definition.figures[1].view = {{0.0, 0.0}, {2.0, 1.0}};
  EXPECT_DOUBLE_EQ(fields(verdict).x.upper, 2.0);
}

TEST(MeasuredLines, WhatIsNoCurveOfPlacesIsNotDrawn) {
  vv::CaseVerdict verdict = support::demo_collapse();
  change_file(verdict, 0, [](vv::CurveFile& file) { file.columns[1].dimension = "pressure"; });
  const FieldPlot figure = fields(verdict);
  EXPECT_TRUE(figure.panels[1].lines.empty());
  ASSERT_EQ(figure.absent_lines.size(), 2U);
  EXPECT_TRUE(mention({figure.absent_lines[0].label}, "no curve of places"));
}

// ---- pairs
// ------------------------------------------------------------------------------------------------------

Plot pairs(const vv::CaseVerdict& verdict) { return plot_of(verdict, verdict.definition.figures.at(0)); }

const std::string exact_label = "exact factors: bias 0.43 (0.40–0.46), scatter 0.12, 12 tests";

TEST(PairsFigure, HasPredictedBesideMeasuredAndTheirRatio) {
  const vv::CaseVerdict verdict = support::demo_pairs();
  const Plot figure = pairs(verdict);
  ASSERT_EQ(figure.panels.size(), 2U);
  const Panel &both = figure.panels[0], &ratio = figure.panels[1];
  EXPECT_EQ(both.x.label, "measured capacity [kPa]");
  EXPECT_EQ(both.y.label, "predicted capacity [kPa]");
  EXPECT_EQ(both.x.scale, Scale::logarithmic);
  EXPECT_EQ(ratio.y.scale, Scale::logarithmic);
  const PlotCurve *marks = curve(both, exact_label), *ratios = curve(ratio, exact_label);
  ASSERT_TRUE(marks && ratios);
  ASSERT_EQ(marks->x.size(), 12U);
  const vv::Pair& pair = verdict.pairs[0].pairs[4];
  EXPECT_DOUBLE_EQ(marks->x[4], pair.measured * 1e-3);
  EXPECT_DOUBLE_EQ(marks->y[4], pair.predicted * 1e-3);
  EXPECT_DOUBLE_EQ(ratios->x[4], pair.measured * 1e-3);
  EXPECT_DOUBLE_EQ(ratios->y[4], pair.predicted / pair.measured);
  EXPECT_EQ(marks->look.line_width, 0.0);
  const PlotCurve* other = curve(both, "fitted factors: bias 1.02 (0.95–1.09), scatter 0.12, 12 tests");
  ASSERT_TRUE(other);
  EXPECT_NE(other->look.marker, marks->look.marker);
  const Picture picture = draw(figure);
  for (const auto& panel : picture.layout.panels) EXPECT_EQ(panel.outside + panel.not_finite, 0);
  EXPECT_LE(picture.layout.legend.right, picture.canvas.width());
}

TEST(PairsFigure, HasGuidesThatSuitTheRatios) {
  vv::CaseVerdict verdict = support::demo_pairs();
  Plot figure = pairs(verdict);
  const PlotCurve* equal = curve(figure.panels[0], "predicted = measured");
  ASSERT_TRUE(equal);
  EXPECT_DOUBLE_EQ(equal->y[1], equal->x[1]);
  const PlotCurve* twice = curve(figure.panels[0], "factor of 2");
  ASSERT_TRUE(twice);
  EXPECT_NEAR(twice->y[0] / twice->x[0], 2.0, 1e-12);
  std::vector<double> levels;
  for (const LevelLine& level : figure.panels[1].levels) levels.push_back(level.value);
  EXPECT_EQ(levels, (std::vector<double>{0.43, 1.02, 1.0, 2.0, 0.5}));
  verdict.definition.figures[0].pairs = {"fitted"};
  figure = pairs(verdict);
  EXPECT_FALSE(curve(figure.panels[0], "factor of 2"));
  EXPECT_TRUE(curve(figure.panels[0], "± 20 %")) << "no ratio is farther off than 1.5";
  const auto& ticks = figure.panels[1].y.ticks;
  EXPECT_TRUE(std::find(ticks.begin(), ticks.end(), std::pair<double, std::string>(0.8, "0.8")) !=
              ticks.end());
}

TEST(PairsFigure, NamesWhatWasNotPredictedAndCountsWhatIsNotPositive) {
  vv::CaseVerdict verdict = support::demo_pairs();
  verdict.pairs[1].pairs[0].predicted = -1.0;
  const Plot figure = pairs(verdict);
  EXPECT_TRUE(
      mention(figure.panels[0].notes, "Not predicted, exact factors: test 12: no depth is &lt;known&gt;"));
  EXPECT_TRUE(mention(figure.panels[0].notes, "Not positive and not drawn, fitted factors: 1"));
  ASSERT_EQ(figure.panels[0].curves.at(1).x.size(), 11U);
  EXPECT_EQ(figure.panels[1].curves.size(), 4U) << "marks of two pairs, and a bias of either";
  EXPECT_GT(figure.panels[1].y.range.lower, 0.0);
  EXPECT_TRUE(mention(figure.panels[0].notes, "95 % confidence"));
  EXPECT_NO_THROW(draw(figure));
}

TEST(PairsFigure, WithoutAFactorSaysWhy) {
  vv::CaseVerdict verdict = support::demo_pairs();
  verdict.pairs[0].lack = "fewer than three pairs";
  verdict.pairs[0].pairs.resize(1);
  const Plot figure = pairs(verdict);
  EXPECT_TRUE(curve(figure.panels[0], "exact factors: fewer than three pairs"));
  EXPECT_EQ(figure.panels[1].levels.size(), 4U) << "no line of a bias that there is not";
}

TEST(PairsFigure, AnEmptySlotIsAHatchedFrame) {
  vv::CaseVerdict verdict = support::demo_pairs();
  verdict.pairs[0].missing = true;
  verdict.pairs[0].pairs.clear();
  verdict.pairs[0].lack = "the slot is empty";
  verdict.pairs[0].unpredicted.clear();
  const std::string words = "Exact factors: no measurement: slot <i>demo_capacities</i> is empty";
  const Plot beside = pairs(verdict);
  EXPECT_EQ(beside.panels.size(), 2U);
  EXPECT_TRUE(mention(beside.panels[0].notes, words));
  verdict.definition.figures[0].pairs = {"exact"};
  const Plot alone = pairs(verdict);
  ASSERT_EQ(alone.panels.size(), 1U);
  EXPECT_EQ(alone.panels[0].absence, words);
  EXPECT_TRUE(alone.panels[0].hatched);
  verdict.definition.figures[0].pairs.clear();
  EXPECT_TRUE(mention({pairs(verdict).panels.at(0).absence}, "no predictions"));
  EXPECT_NO_THROW(draw(pairs(verdict)));
}

TEST(PairsFigure, PairsOfDifferentUnitsHavePanelsOfTheirOwn) {
  vv::CaseVerdict verdict = support::demo_pairs();
  auto other = std::make_shared<vv::CurveFile>(*verdict.definition.pairs[1].file);
  other->columns[0] = support::demo::column("settlement", "mm", "length");
  verdict.definition.pairs[1].file = other;
  const Plot figure = pairs(verdict);
  ASSERT_EQ(figure.panels.size(), 4U);
  EXPECT_EQ(figure.panels[2].x.label, "measured settlement [mm]");
  EXPECT_DOUBLE_EQ(figure.panels[2].curves[0].x[0], verdict.pairs[1].pairs[0].measured * 1e3);
}

// ---- trend
// ------------------------------------------------------------------------------------------------------

Plot trend(const vv::CaseVerdict& verdict) { return plot_of(verdict, verdict.definition.figures.at(0)); }

/// The n-th published curve of the demo, to be changed.
vv::CurveFile& published(vv::CaseVerdict& verdict, std::size_t number) {
  auto& place = verdict.definition.figures.at(0).published.at(number);
  auto file = std::make_shared<vv::CurveFile>(*place);
  place = file;
  return *file;
}

TEST(TrendFigure, HasAMarkForEveryRunAndLinesForPublishedLaws) {
  const vv::CaseVerdict verdict = support::demo_trend();
  const Plot figure = trend(verdict);
  ASSERT_EQ(figure.panels.size(), 1U);
  const Panel& panel = figure.panels[0];
  const PlotCurve* marks = curve(panel, "<i>φ</i> = 20°");
  ASSERT_TRUE(marks);
  ASSERT_EQ(marks->x.size(), 5U) << "the axis `over` makes one series";
  EXPECT_DOUBLE_EQ(marks->x[3], 4.0);
  EXPECT_DOUBLE_EQ(marks->y[3], verdict.runs[3].metrics.at("collapse.run_out"));
  EXPECT_EQ(marks->look.line_width, 0.0);
  EXPECT_NE(marks->look.marker, MarkerShape::none);
  const PlotCurve* law = curve(panel, "First law [Demo00]");
  ASSERT_TRUE(law);
  EXPECT_EQ(law->look.marker, MarkerShape::none);
  EXPECT_GT(law->look.line_width, 0.0);
  EXPECT_DOUBLE_EQ(law->y[10], 1.6 * std::pow(10.0, 0.85));
  EXPECT_EQ(panel.x.scale, Scale::logarithmic);
  EXPECT_EQ(panel.y.scale, Scale::logarithmic);
  EXPECT_EQ(draw(figure).layout.panels[0].outside, 0);
}

TEST(TrendFigure, FillsBetweenTheLawsWhereBothAreDefined) {
  vv::CaseVerdict verdict = support::demo_trend();
  const Panel panel = trend(verdict).panels[0];
  const Band* between = band(panel, "between the published curves");
  ASSERT_TRUE(between);
  for (std::size_t i = 0; i < between->x.size(); ++i) {
    const double a = between->x[i];
    EXPECT_EQ(std::isfinite(between->lower[i]), a <= 5.0 + 1e-9) << a;
    if (!std::isfinite(between->lower[i])) continue;
    // Both are power laws, which are straight between their points on these axes.
    const double first = 1.6 * std::pow(a, 0.85), second = 2.1 * std::pow(a, 0.8);
    EXPECT_NEAR(between->lower[i], std::min(first, second), 1e-9);
    EXPECT_NEAR(between->upper[i], std::max(first, second), 1e-9);
  }
  verdict.definition.figures[0].published.resize(1);
  EXPECT_TRUE(trend(verdict).panels[0].bands.empty());
}

TEST(TrendFigure, IsLinearIfNotAllIsPositive) {
  vv::CaseVerdict verdict = support::demo_trend();
  verdict.runs[0].metrics["collapse.run_out"] = -0.1;
  const Panel panel = trend(verdict).panels[0];
  EXPECT_EQ(panel.x.scale, Scale::linear);
  EXPECT_EQ(panel.y.scale, Scale::linear);
  EXPECT_LT(panel.y.range.lower, -0.1);
}

TEST(TrendFigure, HasTheUnitsOfThePublishedCurves) {
  vv::CaseVerdict verdict = support::demo_trend();
  published(verdict, 0).columns[1] = support::demo::column("run_out", "mm", "length");
  const Panel panel = trend(verdict).panels[0];
  EXPECT_TRUE(panel.y.label.ends_with("[mm]")) << panel.y.label;
  EXPECT_FALSE(panel.x.label.ends_with("]")) << "a ratio has no unit";
  EXPECT_DOUBLE_EQ(curve(panel, "<i>φ</i> = 20°")->y[3],
                   1e3 * verdict.runs[3].metrics.at("collapse.run_out"));
  EXPECT_DOUBLE_EQ(curve(panel, "First law [Demo00]")->y[10], 1.6e3 * std::pow(10.0, 0.85));
}

TEST(TrendFigure, MeasuredOnesHaveTheirPointsAndEmptySlotsAreNamed) {
  vv::CaseVerdict verdict = support::demo_trend();
  published(verdict, 0).origin = "digitised";
  vv::CurveFile& empty = published(verdict, 1);
  empty.missing = true;
  empty.rows.clear();
  const Panel panel = trend(verdict).panels[0];
  EXPECT_EQ(curve(panel, "First law [Demo00]")->look.marker, MarkerShape::square);
  EXPECT_FALSE(curve(panel, "Second law [Demo00]"));
  EXPECT_TRUE(mention(panel.notes, "No measurement: slot <i>second_law</i> is empty"));
  EXPECT_TRUE(panel.bands.empty());
}

TEST(TrendFigure, EveryMetricHasAPanelAndAColumn) {
  vv::CaseVerdict verdict = support::demo_trend();
  vv::FigureRequest& request = verdict.definition.figures[0];
  request.metrics = {"collapse.run_out", "collapse.aspect_ratio"};
  Plot figure = trend(verdict);
  ASSERT_EQ(figure.panels.size(), 2U);
  EXPECT_FALSE(curve(figure.panels[1], "First law [Demo00]")) << "it has no column for the second";
  EXPECT_TRUE(figure.panels[1].bands.empty());
  vv::CurveFile& law = published(verdict, 0);
  law.columns.push_back(support::demo::column("aspect_ratio_again", "1", "ratio"));
  for (std::vector<double>& row : law.rows) row.push_back(row[0]);
  figure = trend(verdict);
  ASSERT_TRUE(curve(figure.panels[1], "First law [Demo00]"));
  EXPECT_DOUBLE_EQ(curve(figure.panels[1], "First law [Demo00]")->y[10], 10.0);
}

TEST(TrendFigure, ARunWithoutTheMetricIsNamed) {
  vv::CaseVerdict verdict = support::demo_trend();
  verdict.runs[1].metrics.erase("collapse.aspect_ratio");
  support::demo::record_failure(verdict.runs[2]);
  const Panel panel = trend(verdict).panels[0];
  EXPECT_EQ(curve(panel, "<i>φ</i> = 20°")->x.size(), 3U);
  EXPECT_TRUE(
      mention(panel.notes, "<i>φ</i> = 20° completed (height 1): what is drawn here was not measured"));
  EXPECT_TRUE(mention(panel.notes, "<i>φ</i> = 20° did not complete (height 2): a particle left the grid"));
  for (vv::RunVerdict& run : verdict.runs) run.metrics.clear();
  EXPECT_NO_THROW(draw(trend(verdict))) << "only the laws are left";
  verdict.definition.figures[0].published.clear();
  EXPECT_NO_THROW(draw(trend(verdict))) << "nothing is left";
  verdict.definition.figures[0].where = {{"/scene/other", {1}}};
  EXPECT_TRUE(mention({trend(verdict).panels.at(0).absence}, "No run was selected"));
}

TEST(ValidationFigures, AreTheSameEveryTime) {
  for (const vv::CaseVerdict& verdict :
       {support::demo_collapse(), support::demo_pairs(), support::demo_trend()})
    for (const vv::FigureRequest& figure : verdict.definition.figures) {
      const auto png = picture_of(verdict, figure).canvas.png();
      EXPECT_GT(png.size(), 10000U) << figure.id;
      EXPECT_EQ(png, picture_of(verdict, figure).canvas.png()) << figure.id;
    }
}

}  // namespace
}  // namespace mpm::reports
