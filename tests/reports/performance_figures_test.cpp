#include "reports/performance_figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/demo_performance.hpp"

namespace mpm::reports {
namespace {

using Json = support::PerformanceJson;

const RowChart& chart_of(const PerformanceFigure& figure) { return std::get<RowChart>(figure.content); }
const Plot& plot_of(const PerformanceFigure& figure) { return std::get<Plot>(figure.content); }

const PlotCurve& curve(const Panel& panel, const std::string& label) {
  const auto found = std::find_if(panel.curves.begin(), panel.curves.end(),
                                  [&label](const PlotCurve& c) { return c.label == label; });
  if (found == panel.curves.end()) throw std::runtime_error("no curve " + label);
  return *found;
}

/// The rows of a panel that have bars.
std::vector<Row> bar_rows(const RowPanel& panel) {
  std::vector<Row> rows;
  std::copy_if(panel.rows.begin(), panel.rows.end(), std::back_inserter(rows),
               [](const Row& row) { return !row.bars.empty(); });
  return rows;
}

/// Headings of a panel, each with the number of rows below it.
using Headings = std::vector<std::pair<std::string, int>>;

Headings headings(const RowPanel& panel) {
  Headings found;
  for (const Row& row : panel.rows) {
    if (row.bars.empty())
      found.emplace_back(row.name, 0);
    else if (!found.empty())
      ++found.back().second;
  }
  return found;
}

TEST(ConfigurationNames, SayOnlyWhatDiffers) {
  const Performance p = support::demo_performance();
  const ConfigurationNames names = configuration_names({&p.steps[2], &p.steps[3], &p.steps[9]});
  EXPECT_EQ(names.common, "USL, Mohr–Coulomb, double, 10\u00a0000 particles");
  EXPECT_EQ(names.own, (std::vector<std::string>{"MPM, 1 thread", "MPM, 2 threads", "uGIMP, 2 threads"}));
  EXPECT_EQ(configuration_names({&p.steps[2], &p.steps[3]}, threads_word).own,
            (std::vector<std::string>{"", ""}));
  EXPECT_EQ(configuration_names({&p.steps[2]}).own, std::vector<std::string>{""});
  EXPECT_TRUE(configuration_names({}).own.empty());
}

TEST(Ratio, TakesTheExtremesOfBoth) {
  const Measured r = ratio({30.0, 20.0, 40.0}, {10.0, 5.0, 20.0});
  EXPECT_DOUBLE_EQ(r.median, 3.0);
  EXPECT_DOUBLE_EQ(r.low, 1.0);
  EXPECT_DOUBLE_EQ(r.high, 8.0);
}

TEST(RateFigures, HaveABarAStepWithTargetAndSpread) {
  const auto figures = rate_figures(support::demo_performance());
  ASSERT_EQ(figures.size(), 2U);
  EXPECT_EQ(figures[0].id, "rates-footing");
  EXPECT_EQ(figures[1].id, "rates-block");
  const RowPanel& footing = chart_of(figures[0]).panels.at(0);
  EXPECT_EQ(headings(footing), (Headings{{"<b>double</b>", 18}, {"<b>float</b>", 1}}));
  const std::vector<Row> rows = bar_rows(footing);
  ASSERT_EQ(rows.size(), 19U);
  EXPECT_EQ(rows[2].name, "MPM, 10\u00a0000 particles, 1 thread");
  EXPECT_EQ(footing.title, "footing, USL, Mohr–Coulomb");
  const RowBar& bar = rows[2].bars.at(0);
  EXPECT_EQ(chart_of(figures[0]).series[bar.series].label, "MPM");
  EXPECT_DOUBLE_EQ(bar.value, 40.0);
  EXPECT_DOUBLE_EQ(bar.low, 36.0);
  EXPECT_DOUBLE_EQ(bar.high, 44.0);
  EXPECT_DOUBLE_EQ(bar.mark, 20.0);
  EXPECT_TRUE(std::isnan(rows[3].bars.at(0).mark));
  for (const Row& row : rows) EXPECT_LT(row.bars[0].high, footing.x.range.upper);
  // The target of the block lies beyond its bar, and still on the axis.
  EXPECT_GT(chart_of(figures[1]).panels[0].x.range.upper, 52.0);
}

TEST(RateFigures, ContinueInAnotherChartWithTheSameAxis) {
  Json json = support::demo_performance_json();
  for (int n = 1; n <= 30; ++n) {
    json["steps"].push_back(support::demo::step("footing", "mpm", "float64", 77 * n, 1, 1e6));
  }
  const auto figures = rate_figures(support::performance_of(json));
  ASSERT_EQ(figures.size(), 3U);
  EXPECT_EQ(figures[1].id, "rates-footing-2");
  EXPECT_EQ(headings(chart_of(figures[0]).panels[0]), (Headings{{"<b>double</b>", 35}}));
  EXPECT_EQ(headings(chart_of(figures[1]).panels[0]), (Headings{{"<b>double</b>", 13}, {"<b>float</b>", 1}}));
  EXPECT_EQ(chart_of(figures[0]).panels[0].x.range.upper, chart_of(figures[1]).panels[0].x.range.upper);
}

TEST(RateFigures, NeedNoHeadingWhereThatIsAllThatDiffers) {
  Performance p = support::demo_performance();
  std::erase_if(p.steps, [](const StepRate& s) {
    return s.scheme != "ugimp" || s.particles != 10000 || s.threads != 1 || s.scene != "footing";
  });
  const RowPanel panel = chart_of(rate_figures(p).at(0)).panels.at(0);
  ASSERT_EQ(panel.rows.size(), 2U);
  EXPECT_EQ(panel.rows[0].name, "double");
  EXPECT_EQ(panel.rows[1].name, "float");
}

TEST(SizeFigure, HasACurveASchemeAndNumberOfThreads) {
  const auto figure = size_figure(support::demo_performance());
  ASSERT_TRUE(figure);
  ASSERT_EQ(plot_of(*figure).panels.size(), 1U) << "the block and single precision have one size only";
  const Panel& panel = plot_of(*figure).panels[0];
  EXPECT_EQ(panel.curves.size(), 6U);
  EXPECT_EQ(panel.x.scale, Scale::logarithmic);
  const PlotCurve& two = curve(panel, "cpGIMP, 2 threads");
  EXPECT_EQ(two.x, (std::vector<double>{1e3, 1e4, 1e6}));
  ASSERT_EQ(two.y.size(), 3U);
  EXPECT_DOUBLE_EQ(two.y[0], 12.0);
  EXPECT_DOUBLE_EQ(two.y[1], 15.0);
  EXPECT_NE(two.look.dash, curve(panel, "cpGIMP, 1 thread").look.dash);
  EXPECT_TRUE(panel.title.empty());
  EXPECT_NE(figure->caption.find("footing, USL, Mohr–Coulomb, double"), std::string::npos);
}

TEST(SizeFigure, TellsItsPanelsApart) {
  Json json = support::demo_performance_json();
  json["steps"].push_back(support::demo::step("footing", "ugimp", "float32", 1000, 1, 40e6));
  const auto figure = size_figure(support::performance_of(json));
  ASSERT_TRUE(figure);
  ASSERT_EQ(plot_of(*figure).panels.size(), 2U);
  EXPECT_EQ(plot_of(*figure).panels[0].title, "double");
  EXPECT_EQ(plot_of(*figure).panels[1].title, "float");
}

TEST(RooflineFigure, PutsEveryStepOfOneThreadBelowItsRoofs) {
  const auto figure = roofline_figure(support::demo_performance());
  ASSERT_TRUE(figure);
  const Panel& panel = plot_of(*figure).panels.at(0);
  const PlotCurve& mpm = curve(panel, "MPM, double");
  ASSERT_EQ(mpm.x.size(), 3U);
  EXPECT_DOUBLE_EQ(mpm.x[1], 1.0);
  EXPECT_DOUBLE_EQ(mpm.y[1], 8.0);
  EXPECT_DOUBLE_EQ(curve(panel, "uGIMP, float").x.at(0), 4.0);
  const PlotCurve& memory = curve(panel, "triad in memory, 10 GB/s");
  EXPECT_DOUBLE_EQ(memory.y[0] / memory.x[0], 10.0);
  EXPECT_DOUBLE_EQ(memory.x[1], 10.0) << "where it meets the peak";
  EXPECT_DOUBLE_EQ(memory.y[1], 100.0);
  EXPECT_DOUBLE_EQ(curve(panel, "fused multiply-adds, 100 Gflop/s").x[0], 1.25);
  EXPECT_EQ(draw(*figure).layout.panels[0].outside, 0);
}

TEST(RooflineFigure, NeedsCountsAndLimits) {
  Performance p = support::demo_performance();
  for (StepRate& step : p.steps) step.bytes = std::nullopt;
  EXPECT_FALSE(roofline_figure(p));
  p = support::demo_performance();
  p.limits.erase(p.limits.begin() + 2);
  EXPECT_FALSE(roofline_figure(p)) << "no peak";
  p = support::demo_performance();
  p.limits.erase(p.limits.begin(), p.limits.begin() + 2);
  EXPECT_FALSE(roofline_figure(p)) << "no bandwidth";
}

TEST(RatioFigure, ComparesWhatDiffersInNothingElse) {
  const Performance p = support::demo_performance();
  EXPECT_EQ(thread_pairs(p).size(), 9U);
  ASSERT_EQ(precision_pairs(p).size(), 1U);
  EXPECT_EQ(precision_pairs(p)[0].one->name, "footing/ugimp/usl/mohr_coulomb/float64/10000/1");
  const auto figure = ratio_figure(p);
  ASSERT_TRUE(figure);
  const RowChart& chart = chart_of(*figure);
  ASSERT_EQ(chart.panels.size(), 2U);
  EXPECT_DOUBLE_EQ(chart.panels[0].rows[4].bars[0].value, 1.5);
  EXPECT_DOUBLE_EQ(chart.panels[0].rows[4].bars[0].low, 1.5 * 0.9 / 1.1);
  ASSERT_EQ(chart.panels[0].lines.size(), 2U);
  EXPECT_EQ(chart.panels[0].lines[1].value, 2.0);
  EXPECT_GE(chart.panels[0].x.range.upper, 2.0);
  EXPECT_DOUBLE_EQ(chart.panels[1].rows[0].bars[0].value, 1.5);
  EXPECT_EQ(chart.panels[1].lines.size(), 1U);
}

TEST(RatioFigure, IsAbsentWithoutPairs) {
  Performance p = support::demo_performance();
  std::erase_if(p.steps, [](const StepRate& s) { return s.threads > 1; });
  ASSERT_TRUE(ratio_figure(p));
  EXPECT_EQ(chart_of(*ratio_figure(p)).panels.size(), 1U);
  std::erase_if(p.steps, [](const StepRate& s) { return s.precision == "float32"; });
  EXPECT_FALSE(ratio_figure(p));
}

TEST(HistoryFigures, PutBeforeAndAfterSideBySide) {
  const Performance after = support::demo_performance(),
                    before = support::performance_of(support::demo_earlier_json());
  const auto figures = history_figures(before, after);
  ASSERT_EQ(figures.size(), 2U) << "the footing in two charts; the block was not measured before";
  const RowChart& chart = chart_of(figures[0]);
  const Row row = bar_rows(chart.panels[0]).at(2);
  ASSERT_EQ(row.bars.size(), 2U);
  EXPECT_DOUBLE_EQ(row.bars[0].value, 20.0);
  EXPECT_DOUBLE_EQ(row.bars[1].value, 40.0);
  EXPECT_TRUE(std::isnan(row.bars[0].mark));
  EXPECT_DOUBLE_EQ(row.bars[1].mark, 20.0);
  EXPECT_NE(chart.series[0].label.find("fedc9876"), std::string::npos);
  EXPECT_NE(chart.series[1].label.find("0123abcd"), std::string::npos);
  EXPECT_EQ(figures[0].id, "history-demo-footing") << "files of one revision have pictures of their own";
  EXPECT_EQ(figures[1].id, "history-demo-footing-2");
}

TEST(RowCharts, KeepBarsInsideAndValuesClearOfThem) {
  for (const PerformanceFigure& figure : rate_figures(support::demo_performance())) {
    const Picture picture = draw(figure);
    const Layout::Panel& panel = picture.layout.panels.at(0);
    const auto rows = bar_rows(chart_of(figure).panels[0]);
    ASSERT_EQ(panel.points.size(), rows.size());
    ASSERT_EQ(panel.annotations.size(), rows.size());
    EXPECT_EQ(panel.outside, 0);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_TRUE(panel.frame.contains(panel.points[i]));
      EXPECT_GT(panel.annotations[i].left, panel.points[i].x);
      EXPECT_LT(panel.annotations[i].right, panel.frame.right);
      if (i > 0) {
        EXPECT_FALSE(panel.annotations[i].intersects(panel.annotations[i - 1]));
      }
    }
    EXPECT_GT(picture.layout.legend.height(), 0.0);
    EXPECT_GT(picture.canvas.png().size(), 5000U);
  }
}

TEST(RowCharts, LengthsFollowValues) {
  const auto figures = rate_figures(support::demo_performance());
  const Layout::Panel panel = draw(figures[0]).layout.panels[0];
  const auto rows = bar_rows(chart_of(figures[0]).panels[0]);
  const auto length = [&](std::size_t i) { return panel.points[i].x - panel.frame.left; };
  EXPECT_NEAR(length(2) / length(14), rows[2].bars[0].value / rows[14].bars[0].value, 1e-9);
}

TEST(RowCharts, CountWhatTheyCannotShow) {
  RowChart chart;
  chart.series = {{"series", look_of_series(0)}};
  RowPanel panel;
  panel.x.range = {0.0, 10.0};
  panel.rows = {{"too long", {{0, 12.0}}}, {"none", {{0}}}, {"fine", {{0, 5.0}}}};
  chart.panels = {panel};
  const Layout::Panel layout = draw(chart).layout.panels[0];
  EXPECT_EQ(layout.outside, 1);
  EXPECT_EQ(layout.not_finite, 1);
  EXPECT_EQ(layout.points.size(), 2U);
  EXPECT_EQ(layout.annotations.size(), 3U);
}

TEST(PerformanceFigures, AllRender) {
  const Performance after = support::demo_performance(),
                    before = support::performance_of(support::demo_earlier_json());
  std::vector<PerformanceFigure> figures = history_figures(before, after);
  for (const auto& figure : {size_figure(after), roofline_figure(after), ratio_figure(after)})
    figures.push_back(figure.value());
  for (const PerformanceFigure& figure : figures)
    EXPECT_GT(draw(figure).canvas.png().size(), 10000U) << figure.id;
}

}  // namespace
}  // namespace mpm::reports
