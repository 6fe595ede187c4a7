#include "reports/color_map.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mpm::reports {
namespace {

double encoded(double linear) {
  const double v = std::clamp(linear, 0.0, 1.0);
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
}

double decoded(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }

double cube(double v) { return v * v * v; }

Oklab of_hue(double lightness, double chroma, double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  return {lightness, chroma * std::cos(angle), chroma * std::sin(angle)};
}

/// Chroma 0.095 is about the most that every hue on the way has in sRGB.
Oklab sequential_at(double t) { return of_hue(0.28 + 0.64 * t, 0.095, 300.0 - 200.0 * t); }

Oklab diverging_at(double t) {
  const double away = std::abs(2.0 * t - 1.0);
  return of_hue(0.93 - 0.51 * away, 0.12 * away, t < 0.5 ? 255.0 : 40.0);
}

}  // namespace

Color srgb_of(const Oklab& color) {
  const auto [L, a, b] = color;
  const double l = cube(L + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(L - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(L - 0.0894841775 * a - 1.2914855480 * b);
  return {encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s), 1.0};
}

Oklab oklab_of(const Color& color) {
  const double red = decoded(color.red), green = decoded(color.green), blue = decoded(color.blue);
  const double l = std::cbrt(0.4122214708 * red + 0.5363325363 * green + 0.0514459929 * blue);
  const double m = std::cbrt(0.2119034982 * red + 0.6806995451 * green + 0.1073969566 * blue);
  const double s = std::cbrt(0.0883024619 * red + 0.2817188376 * green + 0.6299787005 * blue);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Color color_at(ColorMap map, double fraction) {
  if (!std::isfinite(fraction)) return black;
  const double t = std::clamp(fraction, 0.0, 1.0);
  return srgb_of(map == ColorMap::sequential ? sequential_at(t) : diverging_at(t));
}

}  // namespace mpm::reports
