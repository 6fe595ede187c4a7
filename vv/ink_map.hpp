#pragma once

#include <span>
#include <vector>

#include "vv/picture_axes.hpp"
#include "vv/raster_image.hpp"

namespace mpm::vv {

/// A rectangle of pixels, its borders included.
struct PixelBox {
  int left = 0, top = 0, right = 0, bottom = 0;
  bool contains(PixelPlace p) const { return p.x >= left && p.x <= right && p.y >= top && p.y <= bottom; }
};

/// Where on the picture to look.
struct PictureRegion {
  PixelBox area;
  std::vector<PixelBox> holes;  ///< within the area, not looked at: a legend, say
  bool contains(PixelPlace place) const;
};

/// The colour of the paper: the commonest one. Scanned paper is not quite white.
Rgb paper_colour(const RasterImage& image, const PictureRegion& region);

/// Up to `most` colours of ink that cover a good many pixels, those nearest to `wanted` first.
std::vector<Rgb> inks_nearest_to(const Rgb& wanted, const RasterImage& image, const PictureRegion& region,
                                 std::size_t most);

/// Difference of two colours, 1 from black to white.
double colour_distance(const Rgb& a, const Rgb& b);

/// Where the ink of one colour lies, on a raster whose columns stand at equal abscissa and whose rows at
/// equal ordinate, one pixel apart. Values at `index(column, row)`.
///
/// Along the edge of a stroke the picture mixes ink and paper: the share of ink is what is kept, so that the
/// centre of a stroke is known better than to a pixel.
struct InkMap {
  int columns = 0, rows = 0;
  int first_column = 0, first_row = 0;  ///< along the axes [px]
  std::vector<float> share;             ///< of ink of the colour, 0 to 1
  std::vector<char> inked;              ///< belongs to a stroke or a marker of the colour
  std::vector<char> foreign;            ///< covered by something else than the colour and the paper

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(column) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row);
  }
  bool contains(int column, int row) const {
    return column >= 0 && column < columns && row >= 0 && row < rows;
  }
  bool has_ink(int column, int row) const { return contains(column, row) && inked[index(column, row)]; }
  /// Where a column and a row, whole or not, lie along the axes [px].
  AxisPair along(double column, double row) const { return {first_column + column, first_row + row}; }
};

/// Maps the ink of `colours[which]`. A pixel is a mixture of paper and ink when it lies within `tolerance`,
/// relative to the difference of the two, of the line between them in colour space; it belongs to the colour
/// that it fits best, black among them.
InkMap map_ink(const RasterImage& image, const PictureAxes& axes, const PictureRegion& region,
               std::span<const Rgb> colours, std::size_t which, double tolerance);

/// A connected part of a raster, corners included.
struct Blob {
  std::vector<std::pair<int, int>> cells;  ///< column, row
  int left = 0, right = 0, bottom = 0, top = 0;

  int width() const { return right - left + 1; }
  int height() const { return top - bottom + 1; }
};

/// The connected parts of the ink, from left to right.
std::vector<Blob> blobs_of(const InkMap& map);

/// How thick a stroke typically is [px], of markers how large; 0 without ink.
double stroke_width(const InkMap& map);

/// Takes away what has fewer than `least` cells.
void drop_specks(InkMap& map, double least);
/// Inks paper that ink encloses, as an open marker does, when it is at most `largest` wide and high [px].
void fill_holes(InkMap& map, double largest);
/// Inks what foreign ink covers between two inked places at most `reach` apart [px]: curves that run across.
void bridge_crossings(InkMap& map, int reach);
/// Takes away every stroke thinner than `2 x radius + 1` [px] and keeps what is thicker.
void keep_thick(InkMap& map, int radius);

}  // namespace mpm::vv
