#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "vv/digitiser.hpp"

namespace mpm::tests {

/// A picture painted by hand, for digitising: strokes and discs with soft edges, on white.
class PaintedFigure {
 public:
  vv::RasterImage image;

  explicit PaintedFigure(int width = 400, int height = 300)
      : image{width, height,
              std::vector<vv::Rgb>(static_cast<std::size_t>(width * height), {255, 255, 255})} {}

  /// A stroke along y = `row`(x) from one column to another, `thickness` across.
  PaintedFigure& stroke(const vv::Rgb& colour, const std::function<double(double)>& row, int from, int to,
                        double thickness = 3.0) {
    for (int x = from; x <= to; ++x) {
      const double stretch = std::hypot(1.0, row(x + 0.5) - row(x - 0.5));
      for (int y = 0; y < image.height; ++y)
        blend(x, y, colour, thickness / 2.0 - std::abs(y - row(x)) / stretch + 0.5);
    }
    return *this;
  }

  PaintedFigure& disc(const vv::Rgb& colour, vv::PixelPlace centre, double radius) {
    const int reach = static_cast<int>(radius) + 2, column = static_cast<int>(centre.x),
              row = static_cast<int>(centre.y);
    for (int y = row - reach; y <= row + reach; ++y)
      for (int x = column - reach; x <= column + reach; ++x)
        blend(x, y, colour, radius - std::hypot(x - centre.x, y - centre.y) + 0.5);
    return *this;
  }

 private:
  /// Paints over with as much of the colour as covers the pixel.
  void blend(int x, int y, const vv::Rgb& colour, double cover) {
    if (!image.contains(x, y)) return;
    const double share = std::clamp(cover, 0.0, 1.0);
    for (std::uint8_t vv::Rgb::*part : {&vv::Rgb::red, &vv::Rgb::green, &vv::Rgb::blue}) {
      std::uint8_t& value = image.at(x, y).*part;
      value = static_cast<std::uint8_t>(std::lround((1.0 - share) * value + share * colour.*part));
    }
  }
};

/// Axes along the lower and left edges of a painted figure: x from 0 to 35 at 10 px a unit, y from 0 to 14 at
/// 20 px.
inline vv::DigitiseRequest painted_axes(std::vector<vv::SeriesRequest> series) {
  vv::DigitiseRequest request;
  request.abscissa = {"settlement", vv::AxisScale::linear, {{{{20.0, 290.0}, 0.0}, {{370.0, 290.0}, 35.0}}}};
  request.ordinate = {"pressure", vv::AxisScale::linear, {{{{20.0, 290.0}, 0.0}, {{20.0, 10.0}, 14.0}}}};
  request.series = std::move(series);
  return request;
}

}  // namespace mpm::tests
