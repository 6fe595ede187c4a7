#pragma once

#include "reports/canvas.hpp"

namespace mpm::reports {

/// A colour of Oklab: lightness L in [0, 1], a towards red, b towards yellow [Ottosson20].
struct Oklab {
  double lightness = 0.0, a = 0.0, b = 0.0;
};

/// The sRGB colour that looks like it; cut to what sRGB can show.
Color srgb_of(const Oklab& color);
Oklab oklab_of(const Color& color);

/// How a number between two ends becomes a colour.
enum class ColorMap {
  /// From dark violet through teal to light yellow: lightness and hue grow evenly at one chroma, so that
  /// equal
  /// steps look equally large, to the colour-blind and in grey too.
  sequential,
  /// From dark blue (0) through light grey (0.5) to dark red-brown (1), both arms alike in lightness: sign by
  /// hue, size by darkness.
  diverging
};

/// The colour at `fraction` of the way, cut to [0, 1]; black if it is not finite.
Color color_at(ColorMap map, double fraction);

}  // namespace mpm::reports
