#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/color_map.hpp"
#include "reports/plot.hpp"
#include "vv/field_map.hpp"

namespace mpm::reports {

/// The one colour scale of a picture. Values are multiplied by `factor` before they are looked up.
struct ColorScale {
  std::string label;  ///< markup, with its unit
  double factor = 1.0;
  ColorMap map = ColorMap::sequential;
  Range range;                  ///< in the label's unit
  std::optional<double> below;  ///< the smallest value, if it lies beyond the lower end
  std::optional<double> above;  ///< the largest value, if it lies beyond the upper end
};

/// A curve in the plane of the particles, drawn over them on a white border.
struct FieldLine {
  std::string label;  ///< markup, in the legend
  Look look;
  std::vector<double> x, y;  ///< [m]
};

/// The particles of one run at one moment, or why there are none.
struct FieldPanel {
  std::string title;  ///< markup; may be empty
  std::optional<vv::FieldMap> map;
  std::string note;                   ///< markup, set in the frame when there is no map
  bool hatched = false;               ///< the frame, when there is no map: nobody could have drawn one
  std::vector<FieldLine> lines = {};  ///< drawn if there is a map
};

/// Small multiples: every panel has the same view at equal aspect and the same colour scale.
struct FieldPlot {
  std::vector<FieldPanel> panels;  ///< row by row
  int columns = 1;                 ///< >= 1
  std::vector<std::string> heads;  ///< markup over every column, or one over all of them; may be empty
  Range x{0.0, 1.0}, y{0.0, 1.0};  ///< what the view must show [m]; the drawn view is a little larger
  ColorScale scale;
  std::vector<FieldLine> absent_lines = {};  ///< in the legend alone
  std::vector<std::string> notes;            ///< markup, set under the picture
  double width = 482.0;                      ///< at most, of the whole picture [pt]
  std::string stamp;                         ///< markup, small, along the lower edge
};

/// How many columns fill the page best when nothing else decides it: as many as leave the frames readable and
/// at most one place empty, or else those that make the frames largest.
int best_columns(const FieldPlot& plot);

/// Draws every particle as the rectangle it stands for, a hair larger so that no gap narrower than a pixel
/// shows. One whose value is not finite is black; it, and one that lies outside the view, is counted in a
/// note. Lines are named in a legend below the colour bar. In the layout the legend is the colour bar,
/// without its labels, and a panel's annotation is the note in its frame. Throws CanvasError.
Picture draw(const FieldPlot& plot, double pixels_per_point = 10.0 / 3.0);

}  // namespace mpm::reports
