#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vv/ink_map.hpp"
#include "vv/picture_axes.hpp"
#include "vv/raster_image.hpp"

namespace mpm::vv {

/// What a series of a figure is drawn with. Of markers, filled or open, each centre is a point; those
/// `joined` by a line of their own colour are told from it by their size.
enum class Drawing { line, markers, joined_markers };

struct SeriesRequest {
  std::string name;
  Rgb colour;
  Drawing drawing = Drawing::line;
};

/// What to read off a picture.
struct DigitiseRequest {
  PictureAxis abscissa, ordinate;
  std::vector<SeriesRequest> series;
  std::optional<PixelBox> area;    ///< the whole picture without one
  std::vector<PixelBox> holes;     ///< not looked at
  double click_uncertainty = 0.5;  ///< standard, of each coordinate of the axes' points [px]
  double tolerance = 0.15;         ///< of a colour, see `map_ink`
  std::optional<double>
      longest_gap;        ///< of a line [px]; a sixteenth of the abscissa's calibrated length without one
  int most_points = 100;  ///< of a line, >= 2
};

/// A point of a curve: where it stands on the picture and what the axes say there.
struct DigitisedPoint {
  PixelPlace place;
  AxisPair value;
};

/// A curve read off a picture, abscissae strictly ascending.
///
/// `uncertainty` is the standard uncertainty of where a point stands, along each axis: in the axis' unit, as
/// a share of the value on a logarithmic axis. It combines
///  - the axes' clicks, which shift and stretch the whole curve: the root mean square over its points,
///  - the picking, which scatters the points: of a line the roughness of its centres against a smooth curve,
///  across it;
///  - the thickness: half the spread of the drawn width (what moves one edge by e moves the centre by e/2),
///  and
///  - the raster: a drawing on whole pixels is rounded by up to half of one, 1/sqrt(12) px.
/// At a given abscissa the ordinate is uncertain by sqrt(u_ordinate^2 + (slope u_abscissa)^2).
struct DigitisedSeries {
  std::string name;
  std::vector<DigitisedPoint> points;
  AxisPair uncertainty;
  AxisPair click_part;     ///< of `uncertainty`, what the axes' clicks contribute
  double picking = 0.0;    ///< standard, everything but the clicks, in any direction [px]
  double thickness = 0.0;  ///< of the stroke, of markers their diameter [px]
};

/// Reads every requested series off a picture. Throws DigitiseError when the axes are bad (see PictureAxes)
/// or one of their points lies outside the picture, when two series have one colour, when there is no ink of
/// a colour, and when a series is ambiguous: a line in two places at one abscissa, or with a longer gap,
/// markers that hide each other.
std::vector<DigitisedSeries> digitise(const RasterImage& image, const DigitiseRequest& request);

/// The picture, paled, with what was read off it: a cross for every point, a circle around every point of the
/// axes, and the rectangles that were looked at and that were not.
RasterImage preview_of(const RasterImage& image, const DigitiseRequest& request,
                       const std::vector<DigitisedSeries>& series);

}  // namespace mpm::vv
