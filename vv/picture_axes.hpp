#pragma once

#include <array>
#include <stdexcept>
#include <string>

namespace mpm::vv {

/// A figure that cannot be digitised as asked; the message is one line for a person.
class DigitiseError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A place on a picture [px], as image viewers count: x to the right, y DOWN, 0, 0 the centre of the upper
/// left pixel.
struct PixelPlace {
  double x = 0.0, y = 0.0;
};

enum class AxisScale { linear, logarithmic };

/// A place on an axis, and the value that the figure writes there.
struct AxisPoint {
  PixelPlace place;
  double value = 0.0;
};

/// An axis of a figure, known by two of its points.
struct PictureAxis {
  std::string name;
  AxisScale scale = AxisScale::linear;
  std::array<AxisPoint, 2> points;
};

/// One number along each axis of a figure: of places [px] or of what stands there.
struct AxisPair {
  double abscissa = 0.0, ordinate = 0.0;
};

/// The axes of a figure, wherever they run on its picture: turned with the page, downwards, to the left. The
/// abscissa is that of the curve; it may be the axis that stands upright.
///
/// A value is constant along the other axis, as the lines of a figure's grid are; so a sheet that lay
/// slightly askew or was sheared by a scanner is undone.
class PictureAxes {
 public:
  /// Throws DigitiseError when the points of an axis are closer than 10 px or carry one value, a logarithmic
  /// axis has a value that is not positive, or the axes are not square to each other within 5 degrees.
  PictureAxes(const PictureAxis& abscissa, const PictureAxis& ordinate);

  /// How far a place lies along the axes, from the centre of the upper left pixel [px].
  AxisPair along(PixelPlace place) const;
  PixelPlace place_at(AxisPair along) const;  ///< the inverse of `along`

  /// What the figure says at a place.
  AxisPair values(PixelPlace place) const;

  /// What one pixel is worth along each axis: in the axis' unit, as a share of the value on a logarithmic
  /// one; > 0.
  AxisPair worth_of_a_pixel() const;

  /// Standard uncertainty at a place when each coordinate of the axes' points has the standard uncertainty
  /// `click` [px], to first order; in the unit of `worth_of_a_pixel`.
  AxisPair uncertainty(PixelPlace place, double click) const;

  const PictureAxis& abscissa() const { return axes_[0]; }
  const PictureAxis& ordinate() const { return axes_[1]; }

 private:
  AxisPair measures(PixelPlace place) const;  ///< values, their logarithms on logarithmic axes

  std::array<PictureAxis, 2> axes_;
  std::array<PixelPlace, 2> directions_;  ///< unit vectors
};

}  // namespace mpm::vv
