#pragma once

#include <string>
#include <vector>

#include "reports/plot.hpp"
#include "reports/trade_parts.hpp"

/// Pictures of error against cost. What is drawn is worked out once, for paper and for the screen.
namespace mpm::reports {

/// A configuration in a panel; prices in SI units, errors relative [-].
struct TradeMark {
  std::size_t point = 0;  ///< index into the points of the trade
  double price = 0.0;
  double low = 0.0, high = 0.0;  ///< of the repeats; the price of what is counted
  double error = 0.0, uncertainty = 0.0;
  std::size_t family = 0, size = 0;  ///< indices into those of the chart
  bool on_front = false, of_reference = false;
};

struct TradeFailure {
  std::size_t family = 0, point = 0;  ///< indices into those of the chart and of the trade
};

/// One problem at one price.
struct TradePanel {
  const vv::TradeVerdict* trade = nullptr;
  Price price = Price::seconds;
  std::string title;  ///< markup
  Axis x, y;          ///< logarithmic, in SI units, with ticks in the unit that the label names
  std::vector<TradeMark> marks;
  std::vector<Point> front;            ///< corners of the step line in the units of the axes; y is the error
  std::vector<TradeFailure> failures;  ///< configurations that have no error, by family
  double failure_level = 0.0;          ///< ordinate of their row
  std::vector<double> asked;           ///< errors that advice is asked for [-], within the axis
  bool first = true;                   ///< of the panels of its trade
};

struct TradeFamily {
  std::string name;  ///< markup
  Color color;
  MarkerShape shape;
};

struct TradeChart {
  std::vector<TradeFamily> families;
  std::vector<double> cell_sizes;  ///< from coarse to fine [m]
  std::vector<TradePanel> panels;
};

/// The panels of a request of kind `trade`: one for every problem and price.
///
/// - Axes end at 1, 2 or 5 times a power of ten. A few points more than two decades from all others, and
/// errors
///   above 10 (1000 %), lie beyond them.
/// - All panels of a problem share their axis of errors, which holds the errors asked for and the uncertainty
///   of the reference.
TradeChart trade_chart_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

/// Diameter of a mark by the number of its cell size, the coarsest the largest [pt].
double trade_mark_size(const TradeChart& chart, std::size_t size);

/// Whether the bar of the repeats is longer than its mark, on a frame as wide as that of two on a page.
/// Shorter ones are not drawn.
bool shows_repeats(const TradeChart& chart, const TradePanel& panel, const TradeMark& mark);

/// Where the n-th of `count` failures stands along the axis: they have no price, and stand in a row.
double failure_abscissa(const Axis& axis, std::size_t number, std::size_t count);

/// The plot a request of kind `trade` asks for: the chart above, for paper.
///
/// - Colour and shape are the family, the size is that of the cells. What lies on the front is dark and
/// ringed,
///   all else pale, runs of the reference hollow.
/// - Below the uncertainty of the reference the panel is shaded.
/// - Failed configurations are crosses in a row at the upper edge, and counted in a note.
Plot trade_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

}  // namespace mpm::reports
