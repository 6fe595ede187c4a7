#include "vv/picture_axes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace mpm::vv {
namespace {

constexpr double shortest_axis = 10.0;   // [px]; nearer points are a slip, or tell next to nothing
constexpr double most_off_square = 5.0;  // [degrees]; a scan is askew by less, axes mixed up by more
constexpr double degree = std::numbers::pi / 180.0;

PixelPlace difference(PixelPlace a, PixelPlace b) { return {a.x - b.x, a.y - b.y}; }
double cross(PixelPlace a, PixelPlace b) { return a.x * b.y - a.y * b.x; }

double measure(const PictureAxis& axis, double value) {
  return axis.scale == AxisScale::linear ? value : std::log(value);
}

void check_values(const PictureAxis& axis) {
  const double first = axis.points[0].value, second = axis.points[1].value;
  if (first == second)
    throw DigitiseError(fmt::format("axis {}: both points have the value {}", axis.name, first));
  const double least = std::min(first, second);
  if (axis.scale == AxisScale::logarithmic && !(least > 0.0))
    throw DigitiseError(
        fmt::format("axis {}: a logarithmic axis has positive values, found {}", axis.name, least));
}

/// Unit vector from an axis' first point to its second.
PixelPlace direction_of(const PictureAxis& axis) {
  const PixelPlace d = difference(axis.points[1].place, axis.points[0].place);
  const double length = std::hypot(d.x, d.y);
  return {d.x / length, d.y / length};
}

void check_length(const PictureAxis& axis) {
  const PixelPlace d = difference(axis.points[1].place, axis.points[0].place);
  const double length = std::hypot(d.x, d.y);
  if (!(length >= shortest_axis))
    throw DigitiseError(
        fmt::format("axis {}: its two points are {:.1f} px apart; choose points far from each other, at "
                    "least {:.0f} px",
                    axis.name, length, shortest_axis));
}

void check_square(const std::array<PixelPlace, 2>& directions) {
  const double angle = std::asin(std::min(1.0, std::abs(cross(directions[0], directions[1])))) / degree;
  if (90.0 - angle > most_off_square)
    throw DigitiseError(
        fmt::format("bad calibration: the axes make an angle of {:.1f} degrees, expected 90 within {:.0f}; "
                    "is a point on the wrong axis, or x and y exchanged?",
                    angle, most_off_square));
}

}  // namespace

PictureAxes::PictureAxes(const PictureAxis& abscissa, const PictureAxis& ordinate)
    : axes_{abscissa, ordinate} {
  for (std::size_t i = 0; i < 2; ++i) {
    check_values(axes_[i]);
    check_length(axes_[i]);
    directions_[i] = direction_of(axes_[i]);
  }
  check_square(directions_);
}

AxisPair PictureAxes::along(PixelPlace place) const {
  const double area = cross(directions_[0], directions_[1]);
  return {cross(place, directions_[1]) / area, cross(directions_[0], place) / area};
}

PixelPlace PictureAxes::place_at(AxisPair along) const {
  return {along.abscissa * directions_[0].x + along.ordinate * directions_[1].x,
          along.abscissa * directions_[0].y + along.ordinate * directions_[1].y};
}

AxisPair PictureAxes::measures(PixelPlace place) const {
  const auto interpolated = [&](const PictureAxis& axis, double AxisPair::*part) {
    const double first = along(axis.points[0].place).*part, second = along(axis.points[1].place).*part;
    const double share = (along(place).*part - first) / (second - first);
    const double start = measure(axis, axis.points[0].value), end = measure(axis, axis.points[1].value);
    return start + share * (end - start);
  };
  return {interpolated(axes_[0], &AxisPair::abscissa), interpolated(axes_[1], &AxisPair::ordinate)};
}

AxisPair PictureAxes::values(PixelPlace place) const {
  const AxisPair m = measures(place);
  const auto value = [](const PictureAxis& axis, double t) {
    return axis.scale == AxisScale::linear ? t : std::exp(t);
  };
  return {value(axes_[0], m.abscissa), value(axes_[1], m.ordinate)};
}

AxisPair PictureAxes::worth_of_a_pixel() const {
  const AxisPair here = measures({0.0, 0.0}), there = measures(place_at({1.0, 1.0}));
  return {std::abs(there.abscissa - here.abscissa), std::abs(there.ordinate - here.ordinate)};
}

AxisPair PictureAxes::uncertainty(PixelPlace place, double click) const {
  const AxisPair here = measures(place);
  AxisPair variance;
  // A step so small that a moved point never makes the axes invalid.
  constexpr double step = 1e-3;
  for (std::size_t axis = 0; axis < 2; ++axis)
    for (std::size_t point = 0; point < 2; ++point)
      for (double PixelPlace::*coordinate : {&PixelPlace::x, &PixelPlace::y}) {
        PictureAxes moved = *this;
        moved.axes_[axis].points[point].place.*coordinate += step;
        moved.directions_[axis] = direction_of(moved.axes_[axis]);
        const AxisPair there = moved.measures(place);
        variance.abscissa += std::pow((there.abscissa - here.abscissa) / step * click, 2);
        variance.ordinate += std::pow((there.ordinate - here.ordinate) / step * click, 2);
      }
  return {std::sqrt(variance.abscissa), std::sqrt(variance.ordinate)};
}

}  // namespace mpm::vv
