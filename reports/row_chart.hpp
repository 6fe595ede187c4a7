#pragma once

#include <limits>
#include <string>
#include <vector>

#include "reports/plot.hpp"

namespace mpm::reports {

/// A level bar from zero, or from the left edge of an axis that begins above it, in the units of the axis.
struct RowBar {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  std::size_t series = 0;          ///< index into RowChart::series
  double value = none;             ///< NaN where there is none
  double low = none, high = none;  ///< ends of the error bar; NaN draws none
  double mark = none;              ///< an upright mark across the bar; NaN draws none
  std::string text = {};           ///< markup that stands in the column of values; empty for the value itself
};

/// Bars one below the other that share a name.
struct Row {
  std::string name;          ///< markup
  std::vector<RowBar> bars;  ///< none makes the name a heading of the rows below
};

/// An upright line through all rows.
struct RowLine {
  double value = 0.0;
  std::string legend;
  Stroke stroke;
  bool above = false;  ///< over the bars, not behind them
};

struct RowPanel {
  std::string title;  ///< markup
  Axis x;  ///< linear; its values stand in a column inside the right edge, for which it should leave room
  std::vector<Row> rows;
  std::vector<RowLine> lines;
  int decimals = 1;  ///< of the values
};

/// Level bars with long names: panels one below the other, all with the same room for names.
struct RowChart {
  std::vector<RowPanel> panels;
  std::vector<BarSeries> series;
  std::string mark_legend, spread_legend;  ///< what marks and error bars mean; said if there are any
  double width = 482.0;                    ///< of the whole picture [pt]
  std::string stamp;                       ///< markup, small, along the lower edge
};

/// Draws a chart; the height follows from the content. In the layout, the points of a panel are the ends of
/// its bars in the order of the rows, its annotations the values written at the right edge. A bar that the
/// axis cuts is counted as outside, one without a value as not finite. Throws CanvasError.
Picture draw(const RowChart& chart, double pixels_per_point = 10.0 / 3.0);

}  // namespace mpm::reports
