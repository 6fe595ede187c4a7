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
