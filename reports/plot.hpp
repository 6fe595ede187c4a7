#pragma once

#include <string>
#include <utility>
#include <vector>

#include "reports/canvas.hpp"

namespace mpm::reports {

enum class Scale { linear, logarithmic };

/// Limits of an axis, lower < upper; both > 0 on a logarithmic axis.
struct Range {
  double lower = 0.0, upper = 1.0;
};

/// Where an axis carries ticks; only the major ones are labelled.
struct Ticks {
  std::vector<double> major, minor;
};

/// About `wanted` round steps of 1, 2, 2.5 or 5 times a power of ten, all inside the range.
Ticks linear_ticks(const Range& range, int wanted = 5);
/// Powers of ten (thinned out to at most `most` labels), minor ticks at their multiples 2 to 9. A range of
/// less than a decade is labelled at 1, 2 and 5.
Ticks logarithmic_ticks(const Range& range, int most = 7);
/// A number as a tick shows it: a true minus sign, and as many decimals as `step` needs.
std::string tick_label(double value, double step);
/// Markup of a power of ten with exponent n: 10<sup>n</sup>.
std::string power_of_ten(int exponent);

struct Axis {
  std::string label;  ///< markup, with its unit
  Scale scale = Scale::linear;
  Range range;
  /// Labelled ticks at given places, instead of round ones; may be empty.
  std::vector<std::pair<double, std::string>> ticks;
  bool reversed = false;  ///< the upper limit stands at the left or at the bottom; linear axes only
};

/// How a curve or a bar looks. Styles of one picture differ in colour and in shape, dash or hatching, so that
/// a print in grey tells them apart.
struct Look {
  Color color = black;
  double line_width = 0.0;  ///< [pt]; 0 draws no line
  std::vector<double> dash;
  MarkerShape marker = MarkerShape::none;
  double marker_size = 4.0;  ///< [pt]
  bool filled = false;       ///< the marker; an open one is white inside on a line, transparent without one
  enum class Pattern { solid, light, hatched } pattern = Pattern::solid;  ///< of a bar
};

/// The n-th look of a colour-blind-safe sequence; repeats after twelve.
Look look_of_series(int n);

/// A curve in the units of its axes. A point that is not finite breaks the line; a point outside the axes is
/// marked at the edge and counted in a note under the panel. Curves of one label share one legend entry.
struct PlotCurve {
  std::string label;
  Look look;
  std::vector<double> x, y;
  int layer = 0;  ///< curves of a higher layer are drawn over those of a lower one
  /// Half heights of upright error bars, one a point, in the unit of y; empty draws none.
  std::vector<double> bars = {};
  /// Ends of level error bars, one a point, in the unit of x; empty draws none.
  std::vector<double> x_low = {}, x_high = {};
};

/// What lies between two ordinates at each of ascending abscissae, in the units of the axes. A place that is
/// not finite breaks it.
struct Band {
  std::string label;  ///< in the legend; may be empty
  Color color;        ///< translucent, where bands may overlap
  std::vector<double> x, lower, upper;
};

/// Bars side by side over one name on the x axis, one a series of `Panel::bar_series`.
struct BarGroup {
  std::string name;
  std::vector<double> values;         ///< NaN where there is none; a value that has no bar is written out
  std::vector<std::string> absences;  ///< why a value is NaN, a few words; same length as `values`
};

struct BarSeries {
  std::string label;
  Look look;
};

/// A level line across the panel. `label` stands at its right end, outside the frame; `legend` explains it.
struct LevelLine {
  double value = 0.0;
  std::string label, legend;
  Stroke stroke;
};

struct Panel {
  std::string title;  ///< markup; follows the tag (a), (b), ...
  Axis x, y;
  std::vector<PlotCurve> curves;
  std::vector<BarGroup> groups;  ///< a bar panel if not empty: then `x.range` and `x.ticks` are not read
  std::vector<BarSeries> bar_series;
  std::vector<LevelLine> levels;
  std::vector<double>
      reference_slopes;  ///< orders to show as a fan of triangles, on two logarithmic axes, if there is room
  std::vector<std::string> notes;  ///< markup, set under the panel
  std::vector<Band> bands = {};    ///< drawn under levels and curves, cut at the frame
  double height = 1.0;             ///< of the frame, relative to what the plot's aspect makes it
  std::string absence = {};  ///< markup; if not empty, it stands in the frame in place of axes and curves
  bool hatched = false;      ///< the frame of an absence: nobody could have drawn one
};

struct Plot {
  std::vector<Panel> panels;
  int columns = 1;             ///< >= 1
  int stack = 1;               ///< so many successive panels stand one below the other, and are one for the columns
  double width = 482.0;        ///< of the whole picture [pt]
  double frame_aspect = 0.75;  ///< height / width of a panel's frame
  std::string stamp;           ///< markup, small, along the lower edge
};

/// Where things ended up, for whoever checks a picture [pt].
struct Layout {
  struct Panel {
    Rectangle frame;
    std::vector<Point> points;           ///< every drawn point and the tops of bars, edge marks included
    int outside = 0;                     ///< points that lie outside the axes, marked at the edge
    int not_finite = 0;                  ///< points that cannot be drawn at all
    std::vector<Rectangle> annotations;  ///< drawn inside the frame beside the curves, or in their place
  };
  std::vector<Panel> panels;
  Rectangle legend;  ///< empty (no area) if there is nothing to explain
};

struct Picture {
  Canvas canvas;
  Layout layout;
};

/// Draws a plot; the height follows from the content. The legend stands below the panels. Throws CanvasError.
Picture draw(const Plot& plot, double pixels_per_point = 10.0 / 3.0);

}  // namespace mpm::reports
