#include "reports/canvas.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mpm::reports {
namespace {

/// Brightness of the pixel that holds a place given in points, 0 black to 1 white.
double brightness(const Canvas& canvas, const std::vector<unsigned char>& pixels, Point place) {
  const auto column = static_cast<std::size_t>(place.x / canvas.width() * canvas.pixel_width());
  const auto row = static_cast<std::size_t>(place.y / canvas.height() * canvas.pixel_height());
  const std::size_t at = (row * static_cast<std::size_t>(canvas.pixel_width()) + column) * 3;
  return (pixels[at] + pixels[at + 1] + pixels[at + 2]) / (3.0 * 255.0);
}

/// Smallest and largest brightness inside a rectangle.
std::pair<double, double> brightness_range(const Canvas& canvas, const Rectangle& r) {
  const auto pixels = canvas.pixels();
  double low = 1.0, high = 0.0;
  const double step = canvas.width() / canvas.pixel_width();
  for (double y = r.top; y < r.bottom; y += step)
    for (double x = r.left; x < r.right; x += step) {
      const double b = brightness(canvas, pixels, {x, y});
      low = std::min(low, b);
      high = std::max(high, b);
    }
  return {low, high};
}

Canvas scene() {
  Canvas canvas(120.0, 80.0);
  canvas.line({{10.0, 10.0}, {60.0, 40.0}, {110.0, 12.0}}, {{0.8, 0.2, 0.1, 1.0}, 1.5, {4.0, 2.0}});
  canvas.marker({60.0, 40.0}, {MarkerShape::diamond, 6.0, white, black, 0.8});
  TextStyle style;
  canvas.text({10.0, 70.0}, "stress <i>σ</i> 10<sup>−4</sup>", style);
  return canvas;
}

TEST(Canvas, SameDrawingGivesSameBytes) {
  const auto first = scene().png(), second = scene().png();
  EXPECT_GT(first.size(), 500U);
  EXPECT_EQ(first, second);
}

TEST(Canvas, DifferentDrawingGivesDifferentBytes) {
  Canvas changed = scene();
  changed.rule({5.0, 75.0}, {6.0, 75.0}, 0.5, black);
  EXPECT_NE(scene().pixels(), changed.pixels());
}

TEST(Canvas, LineIsDarkWhereItIsAndWhiteElsewhere) {
  Canvas canvas(100.0, 60.0);
  canvas.line({{10.0, 30.0}, {90.0, 30.0}}, {black, 2.0, {}});
  const auto pixels = canvas.pixels();
  EXPECT_LT(brightness(canvas, pixels, {50.0, 30.0}), 0.02);
  EXPECT_GT(brightness(canvas, pixels, {50.0, 33.0}), 0.98);
  EXPECT_GT(brightness(canvas, pixels, {50.0, 27.0}), 0.98);
  EXPECT_GT(brightness(canvas, pixels, {5.0, 30.0}), 0.98);
}

TEST(Canvas, YPointsDown) {
  Canvas canvas(50.0, 50.0);
  canvas.rectangle({0.0, 0.0, 50.0, 10.0}, black);
  const auto pixels = canvas.pixels();
  EXPECT_LT(brightness(canvas, pixels, {25.0, 5.0}), 0.02);
  EXPECT_GT(brightness(canvas, pixels, {25.0, 45.0}), 0.98);
}

TEST(Canvas, DashesLeaveGaps) {
  Canvas canvas(100.0, 20.0);
  canvas.line({{0.0, 10.0}, {100.0, 10.0}}, {black, 2.0, {10.0, 10.0}});
  const auto pixels = canvas.pixels();
  EXPECT_LT(brightness(canvas, pixels, {5.0, 10.0}), 0.02);
  EXPECT_GT(brightness(canvas, pixels, {15.0, 10.0}), 0.98);
  EXPECT_LT(brightness(canvas, pixels, {25.0, 10.0}), 0.02);
}

TEST(Canvas, ObliqueLinesAreAntialiased) {
  Canvas canvas(40.0, 40.0);
  canvas.line({{2.0, 3.0}, {38.0, 31.0}}, {black, 1.0, {}});
  int grey = 0;
  for (const unsigned char value : canvas.pixels()) grey += value > 30 && value < 225;
  EXPECT_GT(grey, 100);
}

TEST(Canvas, ClipCutsWhatLiesOutside) {
  Canvas canvas(60.0, 60.0);
  canvas.clip({20.0, 20.0, 40.0, 40.0});
  canvas.rectangle({0.0, 0.0, 60.0, 60.0}, black);
  canvas.unclip();
  const auto pixels = canvas.pixels();
  EXPECT_LT(brightness(canvas, pixels, {30.0, 30.0}), 0.02);
  EXPECT_GT(brightness(canvas, pixels, {15.0, 30.0}), 0.98);
  EXPECT_GT(brightness(canvas, pixels, {30.0, 45.0}), 0.98);
}

TEST(Canvas, NotANumberBreaksALine) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Canvas canvas(100.0, 20.0);
  canvas.line({{5.0, 10.0}, {30.0, 10.0}, {50.0, nan}, {70.0, 10.0}, {95.0, 10.0}}, {black, 2.0, {}});
  canvas.marker({nan, 3.0}, {});
  const auto pixels = canvas.pixels();
  EXPECT_LT(brightness(canvas, pixels, {20.0, 10.0}), 0.02);
  EXPECT_GT(brightness(canvas, pixels, {50.0, 10.0}), 0.98);
  EXPECT_LT(brightness(canvas, pixels, {80.0, 10.0}), 0.02);
}

TEST(Canvas, FarAwayPointsKeepTheirDirection) {
  Canvas canvas(60.0, 60.0);
  canvas.line({{30.0, 30.0}, {30.0, 1e30}}, {black, 2.0, {}});
  const auto pixels = canvas.pixels();
  EXPECT_LT(brightness(canvas, pixels, {30.0, 58.0}), 0.02);
  EXPECT_GT(brightness(canvas, pixels, {30.0, 20.0}), 0.98);
}

TEST(Canvas, OpenMarkersAreWhiteInsideAndDarkAtTheEdge) {
  for (const MarkerShape shape :
       {MarkerShape::circle, MarkerShape::square, MarkerShape::triangle, MarkerShape::diamond}) {
    Canvas canvas(30.0, 30.0);
    canvas.rectangle({0.0, 0.0, 30.0, 30.0}, {0.5, 0.5, 0.5, 1.0});
    canvas.marker({15.0, 15.0}, {shape, 12.0, white, black, 1.0});
    EXPECT_GT(brightness(canvas, canvas.pixels(), {15.0, 15.0}), 0.98) << static_cast<int>(shape);
    EXPECT_LT(brightness_range(canvas, {5.0, 5.0, 25.0, 25.0}).first, 0.1) << static_cast<int>(shape);
  }
}

TEST(Canvas, TheFontIsTheOneAskedFor) { EXPECT_EQ(resolved_family(Canvas::family), Canvas::family); }

TEST(Canvas, AMissingFontIsNoticed) {
  const std::string missing = "No Such Family Anywhere";
  EXPECT_NE(resolved_family(missing), missing);
}

TEST(Canvas, MeasuredTextIsWhereTheInkIs) {
  TextStyle style;
  style.size = 20.0;
  const TextExtent extent = Canvas::measure("HHHH", style);
  EXPECT_GT(extent.width, 50.0);
  Canvas canvas(200.0, 60.0);
  canvas.text({20.0, 40.0}, "HHHH", style);
  EXPECT_LT(brightness_range(canvas, {20.0, 30.0, 20.0 + extent.width, 40.0}).first, 0.05);
  EXPECT_GT(brightness_range(canvas, {20.0 + extent.width + 1.0, 10.0, 200.0, 60.0}).first, 0.98);
  EXPECT_GT(brightness_range(canvas, {0.0, 0.0, 19.0, 60.0}).first, 0.98);
  EXPECT_GT(brightness_range(canvas, {0.0, 41.0, 200.0, 60.0}).first, 0.98);
}

TEST(Canvas, UpwardTextRunsUp) {
  TextStyle style;
  style.size = 20.0;
  style.upward = true;
  Canvas canvas(60.0, 200.0);
  canvas.text({40.0, 180.0}, "HHHH", style);
  EXPECT_LT(brightness_range(canvas, {28.0, 130.0, 40.0, 180.0}).first, 0.05);
  EXPECT_GT(brightness_range(canvas, {0.0, 182.0, 60.0, 200.0}).first, 0.98);
  EXPECT_GT(brightness_range(canvas, {42.0, 0.0, 60.0, 200.0}).first, 0.98);
}

TEST(Canvas, SuperscriptsAndGreekCount) {
  const TextStyle style;
  EXPECT_LT(Canvas::measure("10<sup>3</sup>", style).width, Canvas::measure("103", style).width);
  EXPECT_GT(Canvas::measure("<i>σψφ</i>", style).width, 5.0);
}

TEST(Canvas, RefusesBrokenMarkupAndMissingGlyphs) {
  const TextStyle style;
  EXPECT_THROW(Canvas::measure("<i>open", style), CanvasError);
  EXPECT_THROW(Canvas::measure("漢", style), CanvasError);
}

TEST(Canvas, RefusesAnEmptySheet) { EXPECT_THROW(Canvas(0.0, 10.0), CanvasError); }

}  // namespace
}  // namespace mpm::reports
