#include "reports/field.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <limits>

namespace mpm::reports {
namespace {

/// Red, green and blue of a pixel, 0 to 1.
std::array<double, 3> pixel(const Canvas& canvas, const std::vector<unsigned char>& pixels, Point place) {
  const auto column = static_cast<std::size_t>(place.x / canvas.width() * canvas.pixel_width());
  const auto row = static_cast<std::size_t>(place.y / canvas.height() * canvas.pixel_height());
  const std::size_t at = (row * static_cast<std::size_t>(canvas.pixel_width()) + column) * 3;
  return {pixels[at] / 255.0, pixels[at + 1] / 255.0, pixels[at + 2] / 255.0};
}

void expect_color(const std::array<double, 3>& seen, const Color& color) {
  // One step of 8 bits, and rounding.
  EXPECT_NEAR(seen[0], color.red, 0.006);
  EXPECT_NEAR(seen[1], color.green, 0.006);
  EXPECT_NEAR(seen[2], color.blue, 0.006);
}

/// Two particles 1 m apart in a view 2 m wide and 1 m high, the right one twice as high as wide.
FieldPlot two_particles() {
  FieldPlot plot;
  plot.x = {0.0, 2.0};
  plot.y = {0.0, 1.0};
  FieldPanel panel;
  panel.map =
      vv::FieldMap{"speed", "m/s", "end", 1.0, {0.5, 1.5}, {0.5, 0.25}, {0.3, 0.1}, {0.3, 0.2}, {2.0, 8.0}};
  plot.panels = {panel};
  plot.scale = {"speed [m/s]", 1.0, ColorMap::sequential, {0.0, 10.0}, std::nullopt, std::nullopt};
  return plot;
}

Point place_of(const Layout::Panel& layout, std::size_t particle, double right, double up,
               double points_per_metre) {
  const Point center = layout.points.at(particle);
  return {center.x + right * points_per_metre, center.y - up * points_per_metre};
}

double points_per_metre(const Layout::Panel& layout) { return layout.points[1].x - layout.points[0].x; }

TEST(ColorMaps, TheSequentialOneGrowsEvenlyInLightnessAndInColour) {
  double least = 1.0, most = 0.0;
  for (int k = 0; k < 50; ++k) {
    const Oklab a = oklab_of(color_at(ColorMap::sequential, k / 50.0)),
                b = oklab_of(color_at(ColorMap::sequential, (k + 1) / 50.0));
    EXPECT_GT(b.lightness, a.lightness + 0.5 * 0.64 / 50.0);
    const double step = std::hypot(b.lightness - a.lightness, b.a - a.a, b.b - a.b);
    least = std::min(least, step);
    most = std::max(most, step);
  }
  // Equal but for what sRGB cuts off.
  EXPECT_LT(most / least, 1.1);
}

TEST(ColorMaps, TheDivergingOneIsDarkAtBothEndsAlikeAndGreyInTheMiddle) {
  const Color middle = color_at(ColorMap::diverging, 0.5);
  EXPECT_NEAR(middle.red, middle.blue, 1e-3);
  for (const double away : {0.1, 0.3, 0.5}) {
    const Oklab low = oklab_of(color_at(ColorMap::diverging, 0.5 - away)),
                high = oklab_of(color_at(ColorMap::diverging, 0.5 + away));
    EXPECT_NEAR(low.lightness, high.lightness, 0.01);
    EXPECT_NEAR(low.lightness, 0.93 - 1.02 * away, 0.01);
    EXPECT_LT(low.b, 0.0);
    EXPECT_GT(high.b, 0.0);
  }
}

TEST(ColorMaps, OklabComesBack) {
  for (const Color& color : {Color{0.2, 0.5, 0.9, 1.0}, Color{0.9, 0.1, 0.3, 1.0}, white, black}) {
    const Color back = srgb_of(oklab_of(color));
    // The published matrices have ten digits.
    EXPECT_NEAR(back.red, color.red, 1e-5);
    EXPECT_NEAR(back.green, color.green, 1e-5);
    EXPECT_NEAR(back.blue, color.blue, 1e-5);
  }
  EXPECT_NEAR(oklab_of(white).lightness, 1.0, 1e-6);
}

TEST(ColorMaps, HoldTheirEndsAndShowWhatIsNotFinite) {
  for (const ColorMap map : {ColorMap::sequential, ColorMap::diverging}) {
    EXPECT_EQ(color_at(map, 7.0).green, color_at(map, 1.0).green);
    EXPECT_EQ(color_at(map, -7.0).green, color_at(map, 0.0).green);
    EXPECT_EQ(color_at(map, std::nan("")).green, 0.0);
    EXPECT_EQ(color_at(map, std::numeric_limits<double>::infinity()).green, 0.0);
  }
}

TEST(Field, ParticlesHaveTheirPlaceSizeAndColour) {
  const Picture picture = draw(two_particles());
  const Layout::Panel& layout = picture.layout.panels.at(0);
  ASSERT_EQ(layout.points.size(), 2U);
  const double metre = points_per_metre(layout);
  // Equal aspect: a quarter of a metre down is a quarter of the distance across.
  EXPECT_NEAR(layout.points[1].y - layout.points[0].y, 0.25 * metre, 1e-9);
  const auto pixels = picture.canvas.pixels();
  const auto at = [&](std::size_t particle, double right, double up) {
    return pixel(picture.canvas, pixels, place_of(layout, particle, right, up, metre));
  };
  const Color first = color_at(ColorMap::sequential, 0.2), second = color_at(ColorMap::sequential, 0.8);
  expect_color(at(0, 0.0, 0.0), first);
  expect_color(at(0, 0.29, -0.29), first);
  expect_color(at(0, 0.31, 0.0), white);
  expect_color(at(1, 0.09, 0.19), second);
  expect_color(at(1, 0.11, 0.0), white);
  expect_color(at(1, 0.0, 0.21), white);
}

TEST(Field, LinesStandOverTheParticlesOnAWhiteBorder) {
  FieldPlot plot = two_particles();
  Look look;
  look.line_width = 2.0;
  plot.panels[0].lines = {{"measured", look, {0.3, 0.7}, {0.5, 0.5}}};
  const Picture with = draw(plot);
  const auto pixels = with.canvas.pixels();
  const Layout::Panel& layout = with.layout.panels[0];
  const Point on = layout.points[0];
  expect_color(pixel(with.canvas, pixels, on), black);
  expect_color(pixel(with.canvas, pixels, {on.x, on.y + 1.5}), white);
  expect_color(pixel(with.canvas, pixels, {on.x, on.y + 4.0}), color_at(ColorMap::sequential, 0.2));
  plot.panels[0].lines.clear();
  const double bare = draw(plot).canvas.height();
  EXPECT_GT(with.canvas.height(), bare + 10.0) << "room for the legend";
  plot.absent_lines = {{"no measurement", look, {}, {}}};
  EXPECT_DOUBLE_EQ(draw(plot).canvas.height(), with.canvas.height());
}

TEST(Field, TheScaleConvertsUnits) {
  FieldPlot plot = two_particles();
  plot.scale.factor = 0.5;
  const Picture picture = draw(plot);
  expect_color(pixel(picture.canvas, picture.canvas.pixels(), picture.layout.panels[0].points[1]),
               color_at(ColorMap::sequential, 0.4));
}

TEST(Field, TheBarShowsTheScale) {
  const Picture picture = draw(two_particles());
  const Rectangle bar = picture.layout.legend;
  ASSERT_GT(bar.width(), 150.0);
  EXPECT_GT(bar.top, picture.layout.panels[0].frame.bottom);
  const auto pixels = picture.canvas.pixels();
  for (const double t : {0.1, 0.5, 0.9}) {
    const auto seen = pixel(picture.canvas, pixels, {bar.left + t * bar.width(), bar.center().y});
    const Color expected = color_at(ColorMap::sequential, t);
    EXPECT_NEAR(seen[1], expected.green, 0.02);
  }
}

TEST(Field, WhatLiesBeyondTheScaleHasAnArrow) {
  FieldPlot plot = two_particles();
  const auto color_beside = [&plot](double sense) {
    const Picture picture = draw(plot);
    const Rectangle bar = picture.layout.legend;
    const double x = sense > 0.0 ? bar.right + 3.0 : bar.left - 3.0;
    return pixel(picture.canvas, picture.canvas.pixels(), {x, bar.center().y});
  };
  expect_color(color_beside(1.0), white);
  expect_color(color_beside(-1.0), white);
  plot.scale.above = 99.0;
  expect_color(color_beside(1.0), color_at(ColorMap::sequential, 1.0));
  expect_color(color_beside(-1.0), white);
  plot.scale.below = -99.0;
  expect_color(color_beside(-1.0), color_at(ColorMap::sequential, 0.0));
}

TEST(Field, WhatCannotBeSeenIsCounted) {
  FieldPlot plot = two_particles();
  const double plain = draw(plot).canvas.height();
  plot.panels[0].map->value[0] = std::nan("");
  plot.panels[0].map->x[1] = 50.0;
  const Picture picture = draw(plot);
  EXPECT_EQ(picture.layout.panels[0].not_finite, 1);
  EXPECT_EQ(picture.layout.panels[0].outside, 1);
  EXPECT_EQ(picture.layout.panels[0].points.size(), 1U);
  expect_color(pixel(picture.canvas, picture.canvas.pixels(), picture.layout.panels[0].points[0]), black);
  // Two lines of notes.
  EXPECT_GT(picture.canvas.height(), plain + 18.0);
}

TEST(Field, ANoteTooLongForItsFrameStandsBelow) {
  FieldPlot plot = two_particles();
  plot.panels.push_back({"", std::nullopt, "did not complete"});
  plot.columns = 2;
  const double brief = draw(plot).canvas.height();
  for (int k = 0; k < 40; ++k) plot.panels[1].note += " for one reason or another";
  const Picture picture = draw(plot);
  EXPECT_GT(picture.canvas.height(), brief + 9.0);
  ASSERT_EQ(picture.layout.panels[1].annotations.size(), 1U);
  EXPECT_LT(picture.layout.panels[1].annotations[0].width(), 50.0);
}

TEST(Field, FramesNeitherOverlapNorLeaveTheSheet) {
  for (const double height : {0.02, 0.3, 1.0, 4.0, 60.0})
    for (const int columns : {1, 2, 4}) {
      FieldPlot plot = two_particles();
      plot.y.upper = height;
      plot.panels.resize(7, plot.panels[0]);
      plot.columns = columns;
      const Picture picture = draw(plot);
      const Rectangle sheet{0.0, 0.0, picture.canvas.width(), picture.canvas.height()};
      EXPECT_LE(sheet.right, plot.width);
      for (std::size_t i = 0; i < 7; ++i) {
        const Rectangle& frame = picture.layout.panels[i].frame;
        EXPECT_TRUE(sheet.contains({frame.left, frame.top}) && sheet.contains({frame.right, frame.bottom}));
        EXPECT_FALSE(frame.intersects(picture.layout.legend));
        for (std::size_t j = 0; j < i; ++j)
          EXPECT_FALSE(frame.intersects(picture.layout.panels[j].frame)) << height << " " << columns;
      }
    }
}

TEST(Field, TensOfThousandsOfParticlesTakeSeconds) {
  FieldPlot plot = two_particles();
  vv::FieldMap& map = *plot.panels[0].map;
  map.x.clear();
  map.y.clear();
  map.half_x.assign(50000, 0.002);
  map.half_y.assign(50000, 0.002);
  map.value.clear();
  for (int p = 0; p < 50000; ++p) {
    map.x.push_back(p % 250 / 125.0);
    map.y.push_back(p / 250 / 200.0);
    map.value.push_back(p % 11);
  }
  plot.panels.resize(6, plot.panels[0]);
  plot.columns = 3;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_GT(draw(plot).canvas.png().size(), 10000U);
  // About a second on an idle core; ten times that is a fault, not a busy machine.
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 10.0);
}

}  // namespace
}  // namespace mpm::reports
