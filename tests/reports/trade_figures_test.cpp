#include "reports/trade_figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reports/figures.hpp"
#include "reports/trade_svg.hpp"
#include "tests/support/demo_trade.hpp"

namespace mpm::reports {
namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++found;
  return found;
}

TradeChart column_chart() {
  const vv::CaseVerdict verdict = support::demo_trade_column();
  return trade_chart_of(verdict, verdict.definition.figures.front());
}

TEST(TradeFigures, HaveAPanelForEveryProblemAndPrice) {
  const vv::CaseVerdict verdict = support::demo_trade_column();
  const TradeChart chart = trade_chart_of(verdict, verdict.definition.figures.front());
  ASSERT_EQ(chart.panels.size(), 4u);
  EXPECT_EQ(chart.panels[0].title, "1G");
  EXPECT_EQ(chart.panels[3].title, "50G");
  EXPECT_EQ(chart.panels[0].price, Price::seconds);
  EXPECT_EQ(chart.panels[1].price, Price::bytes);
  EXPECT_TRUE(chart.panels[0].first);
  EXPECT_FALSE(chart.panels[1].first);
  ASSERT_EQ(chart.families.size(), 3u);
  EXPECT_EQ(chart.families[2].name, "cpGIMP");
  EXPECT_EQ(chart.cell_sizes, (std::vector<double>{0.02, 0.01, 0.005, 0.0025}));
}

TEST(TradeFigures, ShowEveryConfigurationAsAMarkOrAFailure) {
  const vv::CaseVerdict verdict = support::demo_trade_column();
  const TradeChart chart = trade_chart_of(verdict, verdict.definition.figures.front());
  for (const TradePanel& panel : chart.panels) {
    EXPECT_EQ(panel.marks.size() + panel.failures.size(), 96u);
    for (const TradeMark& mark : panel.marks) {
      const vv::TradePoint& point = panel.trade->points[mark.point];
      EXPECT_EQ(mark.error, point.error);
      EXPECT_EQ(mark.on_front, panel.price == Price::seconds ? point.on_time_front : point.on_work_front);
      EXPECT_EQ(chart.cell_sizes[mark.size], point.cell_size);
      EXPECT_EQ(mark.price, panel.price == Price::seconds ? point.timing->median : point.work.bytes);
      EXPECT_EQ(mark.low, panel.price == Price::seconds ? point.timing->low : point.work.bytes);
    }
  }
  EXPECT_EQ(chart.panels[0].failures.size(), 0u);
  EXPECT_EQ(chart.panels[2].failures.size(), 20u);
}

TEST(TradeFigures, StepDownTheFrontFromEdgeToEdge) {
  const TradeChart chart = column_chart();
  for (const TradePanel& panel : chart.panels) {
    ASSERT_GE(panel.front.size(), 4u);
    EXPECT_EQ(panel.front.front().y, panel.y.range.upper);
    EXPECT_EQ(panel.front.back().x, panel.x.range.upper);
    for (std::size_t k = 1; k < panel.front.size(); ++k) {
      EXPECT_GE(panel.front[k].x, panel.front[k - 1].x);
      EXPECT_LE(panel.front[k].y, panel.front[k - 1].y);
      EXPECT_TRUE(panel.front[k].x == panel.front[k - 1].x || panel.front[k].y == panel.front[k - 1].y);
    }
    // Nothing lies below and left of it.
    for (const TradeMark& mark : panel.marks)
      for (const TradeMark& best : panel.marks)
        EXPECT_FALSE(best.on_front && mark.price < best.price && mark.error < best.error);
  }
}

TEST(TradeFigures, HaveRoundAxesThatHoldAllButTheOutermost) {
  const TradeChart chart = column_chart();
  for (const TradePanel& panel : chart.panels) {
    EXPECT_EQ(panel.y.range.lower, chart.panels[panel.trade == chart.panels[0].trade ? 0 : 2].y.range.lower);
    for (const Range& range : {panel.x.range, panel.y.range})
      for (const double end : {range.lower, range.upper}) {
        const double digit = end / std::pow(10.0, std::floor(std::log10(end) + 1e-9));
        EXPECT_TRUE(std::abs(digit - 1) < 1e-6 || std::abs(digit - 2) < 1e-6 || std::abs(digit - 5) < 1e-6)
            << end;
      }
    for (const TradeMark& mark : panel.marks) {
      EXPECT_GT(mark.price, panel.x.range.lower);
      EXPECT_LT(mark.price, panel.x.range.upper);
      EXPECT_GT(mark.error, panel.y.range.lower);
      EXPECT_LT(mark.error, panel.failures.empty() ? panel.y.range.upper : panel.failure_level);
    }
    EXPECT_LE(panel.y.range.lower, 1e-5) << "an error asked for";
  }
}

TEST(TradeFigures, LeaveAFewFarPointsBeyondTheAxes) {
  vv::CaseVerdict verdict = support::demo_trade_column();
  std::vector<vv::TradePoint>& points = verdict.trades[0].points;
  points[0].error = 3e7;
  points[1].error = 1e-14;
  points[2].timing->median = points[2].timing->low = points[2].timing->high = 1e9;
  const TradeChart chart = trade_chart_of(verdict, verdict.definition.figures.front());
  EXPECT_LE(chart.panels[0].y.range.upper, 20.0);
  EXPECT_GE(chart.panels[0].y.range.lower, 1e-6);
  EXPECT_LE(chart.panels[0].x.range.upper, 1e5);
  const Picture picture = draw(trade_plot_of(verdict, verdict.definition.figures.front()));
  EXPECT_EQ(picture.layout.panels[0].outside, 3);
  const std::string html = trade_html(verdict, verdict.definition.figures.front());
  EXPECT_GE(count(html, "M0 -5L5 4H-5Z"), 1u) << "an arrowhead upwards";
  EXPECT_GE(count(html, "M0 5L5 -4H-5Z"), 1u);
  EXPECT_GE(count(html, "M5 0L-4 5V-5Z"), 1u);
}

TEST(TradeFigures, LetNoWrongErrorStretchTheAxis) {
  vv::CaseVerdict verdict = support::demo_trade_column();
  for (std::size_t k = 0; k < 32; ++k) verdict.trades[0].points[k].error = 20.0 * std::pow(1.5, k);
  const TradeChart chart = trade_chart_of(verdict, verdict.definition.figures.front());
  EXPECT_LE(chart.panels[0].y.range.upper, 1.0) << "a third of all errors is above 1000 %";
}

TEST(TradeFigures, KeepMarksClearOfTheRowOfFailures) {
  vv::CaseVerdict verdict = support::demo_trade_column();
  std::vector<vv::TradePoint>& points = verdict.trades[1].points;
  points.back().error = 0.7;
  const TradeChart chart = trade_chart_of(verdict, verdict.definition.figures.front());
  ASSERT_FALSE(chart.panels[2].failures.empty());
  EXPECT_GT(chart.panels[2].failure_level, 1.2 * 0.7);
  EXPECT_LT(chart.panels[2].failure_level, chart.panels[2].y.range.upper);
}

TEST(TradeFigures, MakeFinerCellsSmaller) {
  const TradeChart chart = column_chart();
  for (std::size_t k = 1; k < chart.cell_sizes.size(); ++k)
    EXPECT_LT(trade_mark_size(chart, k), trade_mark_size(chart, k - 1) - 1.0);
}

TEST(TradeFigures, PutFailuresInARowAndCountThem) {
  const vv::CaseVerdict verdict = support::demo_trade_column();
  const Plot plot = trade_plot_of(verdict, verdict.definition.figures.front());
  ASSERT_EQ(plot.panels.size(), 4u);
  EXPECT_EQ(plot.columns, 2);
  const auto crosses =
      std::count_if(plot.panels[2].curves.begin(), plot.panels[2].curves.end(),
                    [](const PlotCurve& c) { return c.look.marker == MarkerShape::cross && !c.x.empty(); });
  EXPECT_EQ(crosses, 20);
  EXPECT_TRUE(std::any_of(plot.panels[2].notes.begin(), plot.panels[2].notes.end(), [](const std::string& n) {
    return has(n, "20 of 96 configurations (MPM:\u00a020)");
  }));
  const Picture picture = draw(plot);
  for (const Layout::Panel& panel : picture.layout.panels)
    for (const Point p : panel.points) EXPECT_TRUE(panel.frame.grown(0.5).contains(p));
  EXPECT_EQ(picture.layout.panels[2].outside, 0);
}

TEST(TradeFigures, ShadeWhatCannotBeToldApartAndLeaveTheReferenceHollow) {
  const vv::CaseVerdict verdict = support::demo_trade_footing();
  const Plot plot = trade_plot_of(verdict, verdict.definition.figures.front());
  ASSERT_EQ(plot.panels.size(), 2u);
  for (const Panel& panel : plot.panels) {
    ASSERT_EQ(panel.bands.size(), 1u);
    EXPECT_EQ(panel.bands[0].upper[0], 0.018);
    EXPECT_EQ(panel.bands[0].lower[0], panel.y.range.lower);
    EXPECT_EQ(panel.levels.size(), 3u);
    int hollow = 0;
    for (const PlotCurve& curve : panel.curves)
      if (curve.look.marker != MarkerShape::none && !curve.look.filled)
        hollow += static_cast<int>(curve.x.size());
    EXPECT_EQ(hollow, 3);
  }
  EXPECT_FALSE(column_chart().panels[0].trade->reference.uncertainty > 0.0);
  const vv::CaseVerdict column = support::demo_trade_column();
  EXPECT_TRUE(trade_plot_of(column, column.definition.figures.front()).panels[0].bands.empty());
}

/// Of all curves of a panel: the bars of repeats, and those of the uncertainty.
std::pair<int, int> bars_of(const Panel& panel) {
  int level = 0, upright = 0;
  for (const PlotCurve& curve : panel.curves)
    for (std::size_t k = 0; k < curve.x_low.size(); ++k) {
      level += curve.x_low[k] < curve.x[k] && curve.x[k] < curve.x_high[k];
      upright += curve.bars[k] == 0.018;
    }
  return {level, upright};
}

TEST(TradeFigures, DrawTheUncertaintyAndRepeatsThatSpreadBeyondTheMark) {
  vv::CaseVerdict verdict = support::demo_trade_footing();
  const vv::FigureRequest& request = verdict.definition.figures.front();
  EXPECT_EQ(bars_of(trade_plot_of(verdict, request).panels[0]), (std::pair{0, 8}));
  EXPECT_EQ(count(trade_html(verdict, request), "class=\"bar\""), 2u * 8u) << "uncertainties";
  for (vv::TradePoint& point : verdict.trades[0].points)
    if (point.timing) {
      point.timing->low = 0.6 * point.timing->median;
      point.timing->high = 1.5 * point.timing->median;
    }
  const Plot plot = trade_plot_of(verdict, request);
  EXPECT_EQ(bars_of(plot.panels[0]), (std::pair{8, 8}));
  EXPECT_EQ(bars_of(plot.panels[1]), (std::pair{0, 8})) << "what is counted has no spread";
  EXPECT_EQ(draw(plot).layout.panels.size(), 2u);
  EXPECT_EQ(count(trade_html(verdict, request), "class=\"bar\" d=\"M-"), 8u) << "from left of the mark";
}

TEST(TradeFigures, SayThatAProblemWasNotTimed) {
  vv::CaseVerdict verdict = support::demo_trade_column();
  for (vv::TradePoint& point : verdict.trades[0].points) point.timing.reset();
  const Plot plot = trade_plot_of(verdict, verdict.definition.figures.front());
  ASSERT_EQ(plot.panels.size(), 4u);
  EXPECT_EQ(plot.panels[0].title, "1G");
  EXPECT_TRUE(has(plot.panels[1].absence, "timed"));
  EXPECT_EQ(plot.panels[2].title, "50G");
}

TEST(TradeFigures, SayThatThereIsNothing) {
  vv::CaseVerdict verdict = support::demo_trade_column();
  verdict.trades.clear();
  const Plot plot = trade_plot_of(verdict, verdict.definition.figures.front());
  ASSERT_EQ(plot.panels.size(), 1u);
  EXPECT_TRUE(has(plot.panels[0].absence, "No trade"));
  EXPECT_EQ(trade_html(verdict, verdict.definition.figures.front()), "");
  verdict = support::demo_trade_column();
  verdict.definition.figures[0].trade = "another";
  EXPECT_TRUE(trade_chart_of(verdict, verdict.definition.figures.front()).panels.empty());
}

TEST(TradeFigures, HaveATitleForEveryMarkOnTheScreen) {
  const vv::CaseVerdict verdict = support::demo_trade_column();
  const std::string html = trade_html(verdict, verdict.definition.figures.front());
  EXPECT_EQ(count(html, "<title>"), 4u * 96u);
  EXPECT_EQ(count(html, "data-run="), 4u * 96u);
  EXPECT_EQ(count(html, "<svg viewBox=\"0 0"), 4u);
  EXPECT_EQ(count(html, "class=\"front-line\" d=\"M"), 5u) << "four fronts and the legend's";
  std::size_t on_fronts = 0;
  for (const TradePanel& panel : column_chart().panels)
    on_fronts += static_cast<std::size_t>(
        std::count_if(panel.marks.begin(), panel.marks.end(), [](const TradeMark& m) { return m.on_front; }));
  EXPECT_EQ(count(html, "tabindex=\"0\""), on_fronts);
  EXPECT_TRUE(has(html, "<title>cpGIMP, h = 2.5 mm, USL, "));
  EXPECT_TRUE(has(html, "; 5 repeats of the whole run\ndata moved "));
  EXPECT_TRUE(has(html, "failed: a particle left the grid at step 617</title>"));
  EXPECT_FALSE(has(html, "http"));
}

TEST(TradeFigures, EscapeAllTextsOnTheScreen) {
  const vv::CaseVerdict verdict = support::demo_trade_footing();
  const std::string html = trade_html(verdict, verdict.definition.figures.front());
  EXPECT_FALSE(has(html, "<footing>"));
  EXPECT_TRUE(has(html, "rigid &lt;footing&gt;"));
  EXPECT_TRUE(has(html, "by the deadline &amp; more"));
  EXPECT_TRUE(has(html, "± 1.8\u00a0%"));
  EXPECT_TRUE(has(html, "class=\"doubt\""));
  EXPECT_EQ(count(html, "class=\"mark reference\""), 2u * 3u + 1u) << "of both panels, and the legend's";
}

TEST(TradeFigures, TakeTagsAwayButNotWhatWasEscaped) {
  EXPECT_EQ(without_tags("<i>h</i> = 5 mm &lt;b&gt;"), "h = 5 mm &lt;b&gt;");
  EXPECT_EQ(without_tags("1.2×10<sup>−12</sup> of <i>L</i><sub>2</sub> 7"), "1.2×10⁻¹² of L₂ 7");
}

TEST(TradeFigures, AreDrawnByThePictureOfTheirKind) {
  const vv::CaseVerdict verdict = support::demo_trade_footing();
  const Picture picture = picture_of(verdict, verdict.definition.figures.front());
  EXPECT_EQ(picture.layout.panels.size(), 2u);
  EXPECT_FALSE(picture.canvas.png().empty());
}

}  // namespace
}  // namespace mpm::reports
