#include "reports/plot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mpm::reports {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

std::string labels_of(const Ticks& ticks) {
  const double step = ticks.major.size() > 1 ? ticks.major[1] - ticks.major[0] : 1.0;
  std::string text;
  for (const double t : ticks.major) text += (text.empty() ? "" : " ") + tick_label(t, step);
  return text;
}

TEST(LinearTicks, AreRound) {
  EXPECT_EQ(labels_of(linear_ticks({0.0, 1.0}, 5)), "0.0 0.2 0.4 0.6 0.8 1.0");
  EXPECT_EQ(labels_of(linear_ticks({-9.8, 0.3}, 5)), "−7.5 −5.0 −2.5 0.0");
  EXPECT_EQ(labels_of(linear_ticks({0.0, 490.0}, 5)), "0 100 200 300 400");
  EXPECT_EQ(labels_of(linear_ticks({-0.3, 0.3}, 3)), "−0.2 0.0 0.2");
}

TEST(LinearTicks, StayInsideAndNeverTooMany) {
  for (const Range range : {Range{-3.7, 11.2}, Range{1e-9, 3e-9}, Range{-1e12, 5e11}, Range{99.99, 100.01}})
    for (int wanted = 2; wanted < 9; ++wanted) {
      const Ticks ticks = linear_ticks(range, wanted);
      ASSERT_FALSE(ticks.major.empty());
      EXPECT_LE(static_cast<int>(ticks.major.size()), wanted + 1);
      for (const double t : ticks.major) {
        EXPECT_GE(t, range.lower - 1e-6 * (range.upper - range.lower));
        EXPECT_LE(t, range.upper + 1e-6 * (range.upper - range.lower));
      }
      EXPECT_GE(ticks.minor.size() + 1, ticks.major.size());
    }
}

TEST(LinearTicks, EmptyForAnEmptyOrInfiniteRange) {
  EXPECT_TRUE(linear_ticks({1.0, 1.0}).major.empty());
  EXPECT_TRUE(linear_ticks({0.0, std::numeric_limits<double>::infinity()}).major.empty());
}

TEST(LogarithmicTicks, DecadesWithMinorTicksBetween) {
  const Ticks ticks = logarithmic_ticks({1e-4, 1e-1});
  ASSERT_EQ(ticks.major.size(), 4U);
  EXPECT_DOUBLE_EQ(ticks.major.front(), 1e-4);
  EXPECT_DOUBLE_EQ(ticks.major.back(), 1e-1);
  EXPECT_EQ(ticks.minor.size(), 24U);
  EXPECT_NEAR(ticks.minor.front(), 2e-4, 1e-12);
}

TEST(LogarithmicTicks, ThinnedOutOverManyDecades) {
  const Ticks ticks = logarithmic_ticks({1e-16, 1e4}, 7);
  EXPECT_LE(ticks.major.size(), 7U);
  EXPECT_GE(ticks.major.size(), 4U);
}

TEST(LogarithmicTicks, LessThanADecadeStillHasLabels) {
  const Ticks ticks = logarithmic_ticks({1.5, 7.0});
  ASSERT_EQ(ticks.major.size(), 2U);
  EXPECT_DOUBLE_EQ(ticks.major[0], 2.0);
  EXPECT_DOUBLE_EQ(ticks.major[1], 5.0);
}

TEST(LogarithmicTicks, NoneWithoutAPositiveRange) {
  EXPECT_TRUE(logarithmic_ticks({0.0, 1.0}).major.empty());
}

TEST(TickLabel, HasATrueMinusAndNoNegativeZero) {
  EXPECT_EQ(tick_label(-2.5, 0.5), "−2.5");
  EXPECT_EQ(tick_label(-1e-17, 0.1), "0.0");
  EXPECT_EQ(tick_label(0.25, 0.25), "0.25");
  EXPECT_EQ(power_of_ten(-4), "10<sup>−4</sup>");
}

PlotCurve wave(const std::string& label, int look, double phase, int points = 40) {
  PlotCurve curve{label, look_of_series(look), {}, {}, 0};
  for (int i = 0; i < points; ++i) {
    curve.x.push_back(i / (points - 1.0));
    curve.y.push_back(0.5 + 0.45 * std::sin(9.0 * curve.x.back() + phase));
  }
  return curve;
}

Panel waves(int curves, double spread = 1.0) {
  Panel panel;
  panel.title = "a title";
  panel.x = {"time <i>t</i> [s]", Scale::linear, {0.0, 1.0}, {}};
  panel.y = {"stress <i>σ</i> [kPa]", Scale::linear, {0.0, 1.0}, {}};
  for (int k = 0; k < curves; ++k) panel.curves.push_back(wave("curve " + std::to_string(k), k, spread * k));
  return panel;
}

Panel falling_errors(const std::vector<double>& orders) {
  Panel panel;
  panel.x = {"<i>h</i> [mm]", Scale::logarithmic, {1.8, 56.0}, {}};
  panel.y = {"error", Scale::logarithmic, {1e-6, 1.0}, {}};
  panel.reference_slopes = {1.0, 2.0};
  for (std::size_t k = 0; k < orders.size(); ++k) {
    PlotCurve curve{"order", look_of_series(static_cast<int>(k)), {}, {}, 0};
    for (const double h : {2.5, 5.0, 10.0, 20.0, 40.0}) {
      curve.x.push_back(h);
      curve.y.push_back(0.3 * std::pow(h / 40.0, orders[k]));
    }
    panel.curves.push_back(curve);
  }
  return panel;
}

Panel bars() {
  Panel panel;
  panel.y = {"HP", Scale::logarithmic, {1e-5, 1e-1}, {}};
  panel.bar_series = {
      {"MPM", look_of_series(0)}, {"uGIMP", look_of_series(1)}, {"cpGIMP", look_of_series(2)}};
  panel.groups = {{"1G", {1e-3, 1e-4, 2e-5}, {"", "", ""}},
                  {"50G", {nan_value, 20.0, 0.0}, {"did not complete", "", ""}}};
  panel.levels = {{1e-2, "≤ 1 %", "gate threshold", {black, 1.0, {3.0, 2.0}}}};
  return panel;
}

TEST(Plot, NothingCoversDataInABatteryOfPlots) {
  std::vector<Plot> plots;
  for (const int curves : {1, 3, 6})
    for (const int columns : {1, 2}) {
      Plot plot;
      plot.columns = columns;
      for (int p = 0; p < 4; ++p) plot.panels.push_back(waves(curves, 0.3 * p));
      plots.push_back(plot);
    }
  for (const auto& orders : {std::vector<double>{1.0}, {2.0, 1.0}, {0.1, 0.5, 1.5, 2.0}, {-0.5, 2.5}}) {
    Plot plot;
    plot.panels = {falling_errors(orders)};
    plots.push_back(plot);
  }
  Plot of_bars;
  of_bars.panels = {bars()};
  plots.push_back(of_bars);
  for (const Plot& plot : plots) {
    const Picture picture = draw(plot);
    ASSERT_EQ(picture.layout.panels.size(), plot.panels.size());
    EXPECT_GT(picture.layout.legend.width(), 0.0);
    EXPECT_LE(picture.layout.legend.bottom, picture.canvas.height());
    EXPECT_GE(picture.layout.legend.left, 0.0);
    EXPECT_LE(picture.layout.legend.right, picture.canvas.width());
    for (const Layout::Panel& panel : picture.layout.panels) {
      EXPECT_FALSE(picture.layout.legend.intersects(panel.frame));
      for (const Point& point : panel.points) {
        EXPECT_FALSE(picture.layout.legend.contains(point));
        EXPECT_TRUE(panel.frame.grown(0.01).contains(point));
        for (const Rectangle& annotation : panel.annotations) EXPECT_FALSE(annotation.contains(point));
      }
    }
  }
}

TEST(Plot, PanelsDoNotOverlap) {
  Plot plot;
  plot.columns = 2;
  for (int p = 0; p < 4; ++p) plot.panels.push_back(waves(2));
  const Layout layout = draw(plot).layout;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_FALSE(layout.panels[i].frame.grown(8.0).intersects(layout.panels[k].frame));
}

TEST(Plot, ReferenceSlopesAreDrawnWhereThereIsRoom) {
  Plot plot;
  plot.panels = {falling_errors({2.0})};
  EXPECT_EQ(draw(plot).layout.panels[0].annotations.size(), 1U);
}

TEST(Plot, ReferenceSlopesAreLeftOutWithoutRoom) {
  Plot plot;
  plot.panels = {falling_errors({1.0})};
  for (int k = 0; k < 60; ++k) plot.panels[0].levels.push_back({std::pow(10.0, -6.0 + 0.1 * k), "", "", {}});
  EXPECT_TRUE(draw(plot).layout.panels[0].annotations.empty());
}

TEST(Plot, PointsBeyondTheAxesAreCountedAndMarkedAtTheEdge) {
  Plot plot;
  plot.panels = {waves(1)};
  PlotCurve wild{"wild", look_of_series(1), {0.5, 0.5, 1e9, 0.2}, {0.5, 1e30, 0.5, -7.0}, 0};
  plot.panels.push_back(waves(1));
  plot.panels[1].curves.push_back(wild);
  const Picture picture = draw(plot);
  EXPECT_EQ(picture.layout.panels[0].outside, 0);
  EXPECT_EQ(picture.layout.panels[1].outside, 3);
  for (const Point& point : picture.layout.panels[1].points)
    EXPECT_TRUE(picture.layout.panels[1].frame.contains(point));
}

TEST(Plot, ANoteTellsOfPointsBeyondTheAxes) {
  Plot tame, wild;
  tame.panels = {waves(1)};
  wild.panels = {waves(1)};
  wild.panels[0].curves[0].y[3] = 1e6;
  EXPECT_GT(draw(wild).canvas.height(), draw(tame).canvas.height() + 9.0);
}

TEST(Plot, EveryPointIsAccountedFor) {
  Plot plot;
  plot.panels = {waves(3)};
  plot.panels[0].curves[0].y[5] = nan_value;
  plot.panels[0].curves[1].y[7] = std::numeric_limits<double>::infinity();
  plot.panels[0].curves[2].y[9] = -3.0;
  const Layout::Panel panel = draw(plot).layout.panels[0];
  EXPECT_EQ(panel.not_finite, 2);
  EXPECT_EQ(panel.outside, 1);
  EXPECT_EQ(panel.points.size() + static_cast<std::size_t>(panel.not_finite), 120U);
}

TEST(Plot, ZeroOnALogarithmicAxisIsOutside) {
  Plot plot;
  plot.panels = {falling_errors({1.0})};
  plot.panels[0].curves[0].y[0] = 0.0;
  const Picture picture = draw(plot);
  EXPECT_EQ(picture.layout.panels[0].outside, 1);
  EXPECT_GT(picture.canvas.png().size(), 1000U);
}

TEST(Plot, BarsSayWhatIsMissing) {
  Plot plot;
  plot.panels = {bars()};
  const Layout::Panel panel = draw(plot).layout.panels[0];
  EXPECT_EQ(panel.not_finite, 1);  // the run that did not complete
  EXPECT_EQ(panel.outside, 2);     // one cut by the axis, one zero
  EXPECT_EQ(panel.annotations.size(), 2U);
}

TEST(Plot, LooksDifferInMoreThanColour) {
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < i; ++k) {
      const Look a = look_of_series(i), b = look_of_series(k);
      EXPECT_TRUE(a.marker != b.marker || a.filled != b.filled) << i << " " << k;
      EXPECT_NE(a.dash, b.dash) << i << " " << k;
    }
}

TEST(Plot, TwelveLooksDifferInColourAndDash) {
  for (int i = 0; i < 12; ++i)
    for (int k = 0; k < i; ++k) {
      const Look a = look_of_series(i), b = look_of_series(k);
      const double apart =
          std::hypot(a.color.red - b.color.red, a.color.green - b.color.green, a.color.blue - b.color.blue);
      EXPECT_GT(apart, 0.15) << i << " " << k;
      EXPECT_NE(a.dash, b.dash) << i << " " << k;
    }
  EXPECT_EQ(look_of_series(12).dash, look_of_series(0).dash);
}

TEST(Plot, SurvivesCurvesWithoutPoints) {
  Plot plot;
  plot.panels = {waves(1)};
  plot.panels[0].curves.push_back({"nothing", look_of_series(1), {}, {}, 0});
  EXPECT_NO_THROW(draw(plot).canvas.png());
}

/// How dark a place is, averaged over the colours: 0 white, 1 black.
double darkness(const Canvas& canvas, const std::vector<unsigned char>& pixels, Point place) {
  const auto column = static_cast<std::size_t>(place.x / canvas.width() * canvas.pixel_width());
  const auto row = static_cast<std::size_t>(place.y / canvas.height() * canvas.pixel_height());
  const std::size_t at = (row * static_cast<std::size_t>(canvas.pixel_width()) + column) * 3;
  return 1.0 - (pixels[at] + pixels[at + 1] + pixels[at + 2]) / (3.0 * 255.0);
}

/// A panel from 0 to 1 along both axes with nothing in it, and a place in it.
Plot unit_square() {
  Plot plot;
  plot.panels.resize(1);
  return plot;
}

Point place_in(const Rectangle& frame, double x, double y) {
  return {frame.left + x * frame.width(), frame.bottom - y * frame.height()};
}

TEST(Plot, BandsFillEvenlyBetweenTheirEdgesAndBreak) {
  Plot plot = unit_square();
  plot.panels[0].bands = {
      {"band", {0.0, 0.0, 0.0, 0.5}, {0.05, 0.33, 0.47, nan_value, 0.7, 0.97}, std::vector<double>(6, 0.45),
       std::vector<double>(6, 0.55)}};
  const Picture picture = draw(plot);
  const auto pixels = picture.canvas.pixels();
  const Rectangle& frame = picture.layout.panels[0].frame;
  const auto dark = [&](double x, double y) {
    return darkness(picture.canvas, pixels, place_in(frame, x, y));
  };
  // Half black on white, on either side of an abscissa and at it: no seam shows.
  for (const double x : {0.1, 0.3, 0.33, 0.36, 0.9}) EXPECT_NEAR(dark(x, 0.48), 0.5, 0.01) << x;
  EXPECT_NEAR(dark(0.55, 0.48), 0.0, 0.01) << "what is not finite breaks it";
  EXPECT_NEAR(dark(0.1, 0.58), 0.0, 0.01);
  EXPECT_NEAR(dark(0.1, 0.43), 0.0, 0.01);
  EXPECT_GT(picture.layout.legend.width(), 0.0);
}

TEST(Plot, ErrorBarsReachAsFarAsTheySay) {
  Plot plot = unit_square();
  Look look;
  look.marker = MarkerShape::circle;
  plot.panels[0].curves = {{"measured", look, {0.33, 0.73}, {0.47, 0.47}, 0, {0.25, 0.1}}};
  const Picture picture = draw(plot);
  const auto pixels = picture.canvas.pixels();
  const Rectangle& frame = picture.layout.panels[0].frame;
  const auto dark = [&](double x, double y) {
    return darkness(picture.canvas, pixels, place_in(frame, x, y));
  };
  for (const double y : {0.24, 0.35, 0.63, 0.7}) EXPECT_GT(dark(0.33, y), 0.5) << y;
  for (const double y : {0.16, 0.76}) EXPECT_LT(dark(0.33, y), 0.2) << y;
  EXPECT_GT(dark(0.73, 0.54), 0.5);
  EXPECT_LT(dark(0.73, 0.65), 0.2);
  EXPECT_EQ(picture.layout.panels[0].points.size(), 2U) << "ends of bars are no points";
}

TEST(Plot, LevelErrorBarsReachAsFarAsTheySay) {
  Plot plot = unit_square();
  Look look;
  look.marker = MarkerShape::circle;
  const double none = std::numeric_limits<double>::quiet_NaN();
  plot.panels[0].curves = {{"measured", look, {0.47, 0.47}, {0.33, 0.73}, 0, {}, {0.27, none}, {0.77, none}}};
  const Picture picture = draw(plot);
  const auto pixels = picture.canvas.pixels();
  const Rectangle& frame = picture.layout.panels[0].frame;
  const auto dark = [&](double x, double y) {
    return darkness(picture.canvas, pixels, place_in(frame, x, y));
  };
  for (const double x : {0.29, 0.36, 0.63, 0.74}) EXPECT_GT(dark(x, 0.33), 0.5) << x;
  for (const double x : {0.22, 0.83}) EXPECT_LT(dark(x, 0.33), 0.2) << x;
  for (const double x : {0.36, 0.63}) EXPECT_LT(dark(x, 0.73), 0.2) << "a bar without ends is not drawn";
}

TEST(Plot, NamesALabelOnceInTheNoteOnPointsBeyondTheAxes) {
  Plot plot = unit_square();
  Look look;
  look.marker = MarkerShape::circle;
  const std::string label = "a curve whose name is so long that it fills a line";
  plot.panels[0].curves = {{label, look, {0.5, 3.0}, {2.0, 0.5}, 0}};
  const Picture once = draw(plot);
  plot.panels[0].curves = {{label, look, {0.5}, {2.0}, 0}, {label, look, {3.0}, {0.5}, 0}};
  const Picture twice = draw(plot);
  EXPECT_EQ(twice.layout.panels[0].outside, 2);
  EXPECT_EQ(twice.canvas.height(), once.canvas.height());
}

TEST(Plot, PanelsOfAStackStandOneBelowTheOther) {
  Plot plot;
  plot.columns = 2;
  plot.stack = 2;
  for (int p = 0; p < 6; ++p) plot.panels.push_back(waves(1));
  for (const std::size_t p : {1U, 3U, 5U}) plot.panels[p].height = 0.5;
  const Layout layout = draw(plot).layout;
  const auto frame = [&layout](std::size_t p) { return layout.panels[p].frame; };
  for (const std::size_t p : {0U, 2U, 4U}) {
    EXPECT_EQ(frame(p).left, frame(p + 1).left);
    EXPECT_GT(frame(p + 1).top, frame(p).bottom);
    EXPECT_NEAR(frame(p + 1).height(), frame(p).height() / 2, 1e-9);
  }
  EXPECT_EQ(frame(0).top, frame(2).top);
  EXPECT_EQ(frame(1).top, frame(3).top);
  EXPECT_GT(frame(2).left, frame(0).right);
  EXPECT_EQ(frame(4).left, frame(0).left);
  EXPECT_GT(frame(4).top, frame(1).bottom);
}

TEST(Plot, WhatIsAbsentIsSaidInTheFrameOrBelowIt) {
  Plot plot = unit_square();
  plot.panels.push_back(plot.panels[0]);
  plot.columns = 2;
  plot.panels[0].absence = "nothing was measured";
  const Picture brief = draw(plot);
  ASSERT_EQ(brief.layout.panels[0].annotations.size(), 1U);
  const Rectangle note = brief.layout.panels[0].annotations[0];
  EXPECT_TRUE(brief.layout.panels[0].frame.contains({note.left, note.top}));
  EXPECT_TRUE(brief.layout.panels[0].frame.contains({note.right, note.bottom}));
  EXPECT_TRUE(brief.layout.panels[1].annotations.empty());
  for (int k = 0; k < 8; ++k) plot.panels[0].absence += plot.panels[0].absence.substr(0, 200);
  const Picture lengthy = draw(plot);
  EXPECT_GT(lengthy.canvas.height(), brief.canvas.height() + 50.0);
  EXPECT_LT(lengthy.layout.panels[0].annotations.at(0).width(), note.width()) << "only where to look";
}

}  // namespace
}  // namespace mpm::reports
