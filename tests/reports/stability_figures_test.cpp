#include "reports/stability_figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "reports/figures.hpp"
#include "tests/support/demo_stability.hpp"

namespace mpm::reports {
namespace {

using Class = vv::StabilityClass;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

Plot map_of(const vv::CaseVerdict& verdict) {
  return stability_plot_of(verdict, verdict.definition.figures.front());
}

std::vector<const PlotCurve*> curves_called(const Panel& panel, const std::string& label) {
  std::vector<const PlotCurve*> found;
  for (const PlotCurve& curve : panel.curves)
    if (curve.label == label) found.push_back(&curve);
  return found;
}

TEST(StabilityFigures, TellClassesApartInColourAndInShape) {
  std::set<std::pair<MarkerShape, bool>> shapes;
  std::set<double> shades;
  std::set<std::string> words;
  for (const Class stability : {Class::accurate, Class::inaccurate, Class::drifting, Class::oscillating,
                                Class::diverged, Class::refused}) {
    const Look look = look_of_class(stability);
    shapes.emplace(look.marker, look.filled);
    shades.insert(look.color.red + 10 * look.color.green + 100 * look.color.blue);
    words.insert(words_of_class(stability));
  }
  EXPECT_EQ(shapes.size(), 6u);
  EXPECT_EQ(shades.size(), 6u);
  EXPECT_EQ(words.size(), 6u);
}

TEST(StabilityFigures, HaveAPanelForEveryPanelAndSeriesOnOneAxis) {
  const Plot plot = map_of(support::demo_maps());
  ASSERT_EQ(plot.panels.size(), 6u);
  EXPECT_TRUE(has(plot.panels[0].title, "MPM")) << plot.panels[0].title;
  EXPECT_NE(plot.panels[0].title, plot.panels[1].title);
  for (const Panel& panel : plot.panels) {
    ASSERT_EQ(panel.x.ticks.size(), 4u);
    EXPECT_EQ(panel.x.label, "particles per cell");
    EXPECT_EQ(panel.x.ticks[2].second, "3");
    EXPECT_EQ(panel.x.ticks[2].first, 2.0);
    EXPECT_EQ(panel.y.scale, Scale::logarithmic);
    EXPECT_EQ(panel.y.range.lower, plot.panels[0].y.range.lower);
    EXPECT_EQ(panel.y.range.upper, plot.panels[0].y.range.upper);
  }
}

TEST(StabilityFigures, PaintEveryStepTriedHalfWayToItsNeighbours) {
  const vv::CaseVerdict verdict = support::demo_maps();
  const Plot plot = map_of(verdict);
  const vv::Survey& survey = *verdict.runs[0].record.survey;
  const Panel& panel = plot.panels[0];
  ASSERT_EQ(panel.bands.size(), 4 * survey.points.size());
  for (std::size_t k = 0; k < survey.points.size(); ++k) {
    EXPECT_LT(panel.bands[k].lower[0], survey.points[k].fraction);
    EXPECT_GT(panel.bands[k].upper[0], survey.points[k].fraction);
    EXPECT_GT(panel.bands[k].x[0], -0.5);
    EXPECT_LT(panel.bands[k].x[1], 0.5);
    if (k == 0) continue;
    EXPECT_DOUBLE_EQ(panel.bands[k].lower[0], panel.bands[k - 1].upper[0]);
    EXPECT_NEAR(panel.bands[k].lower[0], std::sqrt(survey.points[k].fraction * survey.points[k - 1].fraction),
                1e-12);
  }
  EXPECT_LE(panel.y.range.lower, panel.bands.front().lower[0]);
}

TEST(StabilityFigures, MarkClassesByTheirSymbols) {
  const vv::CaseVerdict verdict = support::demo_maps();
  const Panel panel = map_of(verdict).panels[0];
  for (std::size_t c = 0; c < 4; ++c) {
    const vv::Survey& survey = *verdict.runs[c].record.survey;
    double last = 0.0;
    Class before = Class::refused;
    for (const vv::SurveyPoint& point : survey.points) {
      const auto symbols = curves_called(panel, words_of_class(point.stability));
      ASSERT_EQ(symbols.size(), 1u);
      bool drawn = false;
      for (std::size_t k = 0; k < symbols[0]->x.size(); ++k)
        drawn = drawn || (symbols[0]->x[k] == static_cast<double>(c) && symbols[0]->y[k] == point.fraction);
      // One left out has a neighbour of its class right below.
      if (!drawn) {
        EXPECT_EQ(before, point.stability);
        EXPECT_LT(point.fraction / last, 1.2);
      }
      if (drawn) last = point.fraction;
      before = point.stability;
    }
  }
}

TEST(StabilityFigures, LeaveNoSymbolOutBehindOneOfAnotherClass) {
  vv::CaseVerdict verdict = support::demo_maps();
  auto& points = verdict.runs[0].record.survey->points;
  points.resize(3);
  const Class classes[] = {Class::accurate, Class::drifting, Class::accurate};
  for (std::size_t k = 0; k < 3; ++k) {
    points[k].fraction = 0.1 + 0.001 * static_cast<double>(k);
    points[k].stability = classes[k];
  }
  const auto drawn_in_first = [&] {
    const Panel panel = map_of(verdict).panels[0];
    const PlotCurve& symbols = *curves_called(panel, words_of_class(Class::accurate)).at(0);
    return std::count(symbols.x.begin(), symbols.x.end(), 0.0);
  };
  EXPECT_EQ(drawn_in_first(), 2);
  points[1].stability = Class::accurate;
  EXPECT_EQ(drawn_in_first(), 1);
}

TEST(StabilityFigures, DrawTheBoundaryBetweenStableAndUnstable) {
  vv::CaseVerdict verdict = support::demo_maps();
  verdict.runs[1].record.survey->unstable = 0.0;  // none diverged: no boundary there
  const Panel panel = map_of(verdict).panels[0];
  const auto limits = curves_called(panel, "limit found by runs");
  ASSERT_EQ(limits.size(), 2u);
  const vv::Survey& first = *verdict.runs[0].record.survey;
  EXPECT_EQ(limits[0]->x, (std::vector<double>{-0.5, 0.5}));
  EXPECT_DOUBLE_EQ(limits[0]->y[0], std::sqrt(first.stable * first.unstable));
  EXPECT_EQ(limits[1]->x, (std::vector<double>{1.5, 2.5, 2.5, 3.5}));
  EXPECT_TRUE(limits[0]->look.dash.empty());

  const auto matrix = curves_called(panel, "limit by the matrix of one step");
  ASSERT_EQ(matrix.size(), 4u);
  EXPECT_FALSE(matrix[0]->look.dash.empty());
  EXPECT_EQ(matrix[0]->y[0], first.linear.limit);
  const auto own = curves_called(panel, "time step that the scene asks for");
  ASSERT_EQ(own.size(), 4u);
  EXPECT_EQ(own[3]->y[1], 0.2);
}

TEST(StabilityFigures, PutTheBoundaryBelowAllIfTheSmallestStepDiverged) {
  vv::CaseVerdict verdict = support::demo_maps();
  vv::Survey& survey = *verdict.runs[0].record.survey;
  survey.stable = 0.0;
  survey.unstable = survey.points[0].fraction;
  const Panel panel = map_of(verdict).panels[0];
  const PlotCurve& limit = *curves_called(panel, "limit found by runs")[0];
  EXPECT_LT(limit.y[0], survey.points[0].fraction);
  EXPECT_GE(limit.y[0], panel.y.range.lower);
}

TEST(StabilityFigures, HaveAColumnForEveryRunWithoutAnAxis) {
  vv::CaseVerdict verdict = support::demo_maps();
  vv::FigureRequest& figure = verdict.definition.figures[0];
  figure.map_axis = figure.series = "";
  const Plot plot = map_of(verdict);
  ASSERT_EQ(plot.panels.size(), 3u);
  ASSERT_EQ(plot.panels[0].x.ticks.size(), 8u);
  // Their names are too long to stand side by side.
  EXPECT_EQ(plot.panels[0].x.ticks[1].second, "2");
  ASSERT_EQ(plot.panels[0].notes.size(), 1u);
  EXPECT_TRUE(has(plot.panels[0].notes[0], "<b>2</b>\u00a0MUSL")) << plot.panels[0].notes[0];
}

TEST(StabilityFigures, SayWhatIsMissing) {
  vv::CaseVerdict verdict = support::demo_maps();
  verdict.runs[0].record.survey.reset();
  verdict.runs[0].record.failure = "too <large> for memory";
  verdict.runs[1].record.survey->linear.limit = 0.0;
  verdict.runs[1].record.survey->linear.lack = "too many unknowns";
  const Panel panel = map_of(verdict).panels[0];
  ASSERT_EQ(panel.notes.size(), 2u);
  EXPECT_TRUE(has(panel.notes[0], "1: too &lt;large&gt; for memory"));
  EXPECT_TRUE(has(panel.notes[1], "2: no limit by the matrix: too many unknowns"));
  EXPECT_EQ(curves_called(panel, "limit by the matrix of one step").size(), 2u);

  verdict.definition.figures[0].where = {{"/scene/scheme", {"none"}}};
  EXPECT_TRUE(has(map_of(verdict).panels.at(0).absence, "No run"));
}

TEST(StabilityFigures, AreDrawnWithEveryPointInPlace) {
  const vv::CaseVerdict verdict = support::demo_maps();
  const Picture picture = picture_of(verdict, verdict.definition.figures.front());
  ASSERT_EQ(picture.layout.panels.size(), 6u);
  for (const Layout::Panel& panel : picture.layout.panels) {
    EXPECT_EQ(panel.outside, 0);
    EXPECT_EQ(panel.not_finite, 0);
  }
  EXPECT_GT(picture.layout.legend.width(), 0.0);
}

}  // namespace
}  // namespace mpm::reports
