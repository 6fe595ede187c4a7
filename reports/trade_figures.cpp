#include "reports/trade_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "reports/figure_parts.hpp"
#include "reports/figures.hpp"
#include "vv/advice_choice.hpp"

namespace mpm::reports {
namespace {

constexpr double largest_error_shown = 10.0;  // 1000 % says no more than "wrong"
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double lone_gap = 100.0;       // a point farther than this from all others decides no axis
constexpr double failure_height = 0.95;  // of the frame, where failures have their row
constexpr double coarsest_mark = 8.4, finest_mark = 3.0;  // [pt]
constexpr double faintness = 0.45;                        // overlapping marks shine through one another

const Color band_color{0.82, 0.82, 0.82, 0.6};
const Color asked_color{0.35, 0.35, 0.35, 1.0};
const Color size_color{0.45, 0.45, 0.45, 1.0};
const Color front_color{0.1, 0.1, 0.1, 1.0};

// ---- axes
// -------------------------------------------------------------------------------------------------------

/// The values above zero, but for at most a tenth of them at either end that lie far from the rest.
Extent robust_extent(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !(v > 0.0) || !std::isfinite(v); });
  std::sort(values.begin(), values.end());
  const std::size_t few = values.size() / 10;
  std::size_t first = 0, last = values.size();
  for (std::size_t k = 1; k <= few; ++k)
    if (values[k] > lone_gap * values[k - 1]) first = k;
  for (std::size_t k = 1; k <= few; ++k)
    if (values[values.size() - k] > lone_gap * values[values.size() - k - 1]) last = values.size() - k;
  Extent extent;
  for (std::size_t k = first; k < last; ++k) extent.include(values[k]);
  return extent;
}

/// The next of 1, 2 and 5 times a power of ten at or beyond a value.
double round_outwards(double value, bool up) {
  const double decade = std::pow(10.0, std::floor(std::log10(value) + 1e-9));
  const double steps[] = {1.0, 2.0, 5.0, 10.0};
  double rounded = up ? 10.0 * decade : decade;
  if (up) {
    for (auto step = std::rbegin(steps); step != std::rend(steps); ++step)
      if (*step * decade >= value * (1.0 - 1e-9)) rounded = *step * decade;
  } else {
    for (const double step : steps)
      if (step * decade <= value * (1.0 + 1e-9)) rounded = step * decade;
  }
  return rounded;
}

/// Round ends with room around the extent, half a decade wide at least.
Range rounded_range(const Extent& extent) {
  if (extent.empty()) return {0.1, 10.0};
  constexpr double room = 1.4;
  Range range{round_outwards(extent.lower / room, false), round_outwards(extent.upper * room, true)};
  if (range.upper < 5.0 * range.lower) range = {range.lower / 2.0, range.upper * 2.0};
  return range;
}

/// A number of a tick in the unit of its axis.
std::string plain_tick(double value) {
  if (value >= 0.9e-3 && value < 1.1e5) return fmt::format("{:.6g}", value);
  const double exponent = std::floor(std::log10(value) + 1e-9);
  const double digit = std::round(value / std::pow(10.0, exponent));
  const std::string power = power_of_ten(static_cast<int>(exponent));
  return digit == 1.0 ? power : fmt::format("{:g}·{}", digit, power);
}

/// A logarithmic axis whose labels are in `unit` SI units.
Axis logarithmic_axis(const std::string& label, const Range& range, double unit) {
  Axis axis{label, Scale::logarithmic, range, {}};
  for (const double tick : logarithmic_ticks(range).major)
    axis.ticks.emplace_back(tick, plain_tick(tick / unit));
  return axis;
}

Axis price_axis(Price price, const Range& range) {
  const std::string name = name_of_price(price);
  if (price == Price::seconds) return logarithmic_axis(name + " [s]", range, 1.0);
  if (price != Price::bytes) return logarithmic_axis(name, range, 1.0);
  for (const auto& [unit, symbol] : {std::pair{1e12, "TB"}, {1e9, "GB"}, {1e6, "MB"}})
    if (range.upper > 10.0 * unit) return logarithmic_axis(fmt::format("{} [{}]", name, symbol), range, unit);
  return logarithmic_axis(name + " [kB]", range, 1e3);
}

// ---- the chart
// --------------------------------------------------------------------------------------------------

const vv::TradeRequest* request_of(const vv::CaseVerdict& verdict, const vv::TradeVerdict& trade) {
  for (const vv::TradeRequest& request : verdict.definition.trades)
    if (request.title == trade.title) return &request;
  return nullptr;
}

std::string family_of(const vv::TradePoint& point, const vv::TradeRequest* request) {
  const vv::Json* value = request ? value_of(point.configuration, request->family) : nullptr;
  return value ? name_of_parameter(request->family, *value) : escaped(point.family);
}

/// Schemes have the looks they have everywhere, other families those that follow.
Look family_look(const std::string& name, std::size_t number) {
  if (name == "MPM") return look_of_series(0);
  if (name == "uGIMP") return look_of_series(1);
  if (name == "cpGIMP") return look_of_series(2);
  return look_of_series(static_cast<int>(number) + 3);
}

MarkerShape family_shape(std::size_t number) {
  static constexpr MarkerShape shapes[] = {MarkerShape::circle, MarkerShape::square, MarkerShape::diamond,
                                           MarkerShape::triangle};
  return shapes[number % std::size(shapes)];
}

std::size_t index_in(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

/// Corners of the line below and left of which nothing was measured, from edge to edge.
std::vector<Point> front_line(const TradePanel& panel) {
  std::vector<Point> corners;
  for (const TradeMark& mark : panel.marks)
    if (mark.on_front) corners.push_back({mark.price, mark.error});
  if (corners.empty()) return {};
  std::sort(corners.begin(), corners.end(), [](Point a, Point b) { return a.x < b.x; });
  std::vector<Point> line{{corners.front().x, panel.y.range.upper}};
  for (const Point corner : corners) {
    line.push_back({corner.x, line.back().y});
    line.push_back(corner);
  }
  line.push_back({panel.x.range.upper, corners.back().y});
  for (Point& corner : line)
    corner = {std::clamp(corner.x, panel.x.range.lower, panel.x.range.upper),
              std::clamp(corner.y, panel.y.range.lower, panel.y.range.upper)};
  return line;
}

Axis error_axis(const vv::TradeVerdict& trade, const std::vector<double>& asked, const std::string& name) {
  std::vector<double> errors;
  bool any_failed = false;
  for (const vv::TradePoint& point : trade.points) {
    if (point.error <= largest_error_shown) errors.push_back(point.error);
    any_failed |= !std::isfinite(point.error);
  }
  Extent extent = robust_extent(errors);
  for (const double error : asked) extent.include(error);
  if (trade.reference.uncertainty > 0.0) extent.include(trade.reference.uncertainty);
  Range range = rounded_range(extent);
  // A free strip for the row of failures.
  if (any_failed && !extent.empty())
    range.upper = round_outwards(range.lower * std::pow(1.3 * extent.upper / range.lower, 1.0 / 0.9), true);
  return logarithmic_axis(name + " [%]", range, 0.01);
}

TradePanel trade_panel(const vv::TradeVerdict& trade, Price price, const Axis& errors, TradeChart& chart,
                       const std::function<std::size_t(const vv::TradePoint&)>& family) {
  TradePanel panel;
  panel.trade = &trade;
  panel.price = price;
  panel.y = errors;
  std::vector<double> prices;
  for (std::size_t k = 0; k < trade.points.size(); ++k) {
    const vv::TradePoint& point = trade.points[k];
    if (!point.failure.empty() || !std::isfinite(point.error)) {
      panel.failures.push_back({family(point), k});
      continue;
    }
    const std::optional<double> paid = price_of(point, price);
    if (!paid) continue;
    const bool timed = price == Price::seconds;
    const auto size = std::find(chart.cell_sizes.begin(), chart.cell_sizes.end(), point.cell_size);
    panel.marks.push_back({k, *paid, timed ? point.timing->low : *paid, timed ? point.timing->high : *paid,
                           point.error, point.uncertainty, family(point),
                           static_cast<std::size_t>(size - chart.cell_sizes.begin()), on_front(point, price),
                           point.of_reference});
    prices.push_back(*paid);
  }
  panel.x = price_axis(price, rounded_range(robust_extent(prices)));
  std::stable_sort(panel.failures.begin(), panel.failures.end(),
                   [](const TradeFailure& a, const TradeFailure& b) { return a.family < b.family; });
  const Range& y = panel.y.range;
  panel.failure_level = y.lower * std::pow(y.upper / y.lower, failure_height);
  panel.front = front_line(panel);
  return panel;
}

// ---- for paper
// --------------------------------------------------------------------------------------------------

Look mark_of(const TradeFamily& family, double size) { return mark_look(family.shape, size, family.color); }

/// A sample for the legend, without points.
PlotCurve sample(const std::string& label, const Look& look) { return {label, look, {}, {}, 0}; }

/// The marks of one family, cell size and kind.
PlotCurve marks_of(const TradeChart& chart, const TradePanel& panel, std::size_t family, std::size_t size,
                   const std::function<bool(const TradeMark&)>& wanted) {
  PlotCurve curve;
  curve.label = chart.families[family].name;
  curve.look = mark_of(chart.families[family], trade_mark_size(chart, size));
  for (const TradeMark& mark : panel.marks) {
    if (mark.family != family || mark.size != size || !wanted(mark)) continue;
    curve.x.push_back(mark.price);
    curve.y.push_back(mark.error);
    curve.bars.push_back(mark.uncertainty);
    const bool shown = shows_repeats(chart, panel, mark);
    curve.x_low.push_back(shown ? mark.low : nan_value);
    curve.x_high.push_back(shown ? mark.high : nan_value);
  }
  return curve;
}

bool within(const Axis& axis, double value) { return value >= axis.range.lower && value <= axis.range.upper; }

/// Dark rims behind marks; beyond the axes a mark's own arrowhead is enough.
PlotCurve rings_of(const TradePanel& panel, const PlotCurve& marks) {
  PlotCurve rings{"", marks.look, {}, {}, 4};
  rings.look.color = front_color;
  rings.look.marker_size += 2.4;
  for (std::size_t k = 0; k < marks.x.size(); ++k) {
    if (!within(panel.x, marks.x[k]) || !within(panel.y, marks.y[k])) continue;
    rings.x.push_back(marks.x[k]);
    rings.y.push_back(marks.y[k]);
  }
  return rings;
}

void add_marks(Panel& drawn, const TradeChart& chart, const TradePanel& panel) {
  const auto add = [&](PlotCurve curve, int layer) {
    curve.layer = layer;
    if (!curve.x.empty()) drawn.curves.push_back(std::move(curve));
  };
  for (std::size_t f = 0; f < chart.families.size(); ++f)
    for (std::size_t s = 0; s < chart.cell_sizes.size(); ++s) {
      PlotCurve pale =
          marks_of(chart, panel, f, s, [](const TradeMark& m) { return !m.on_front && !m.of_reference; });
      pale.look.color.alpha = faintness;
      add(std::move(pale), 2);
      PlotCurve hollow = marks_of(chart, panel, f, s, [](const TradeMark& m) { return m.of_reference; });
      hollow.look.filled = false;
      add(std::move(hollow), 3);
      PlotCurve best = marks_of(chart, panel, f, s, [](const TradeMark& m) { return m.on_front; });
      add(rings_of(panel, best), 4);
      add(std::move(best), 5);
    }
}

void add_failures(Panel& drawn, const TradeChart& chart, const TradePanel& panel) {
  std::map<std::size_t, std::size_t> counts;
  for (std::size_t k = 0; k < panel.failures.size(); ++k) {
    const TradeFamily& family = chart.families[panel.failures[k].family];
    PlotCurve cross{family.name,
                    mark_look(MarkerShape::cross, 4.6, family.color),
                    {failure_abscissa(panel.x, k, panel.failures.size())},
                    {panel.failure_level},
                    3};
    drawn.curves.push_back(std::move(cross));
    ++counts[panel.failures[k].family];
  }
  if (!panel.first || counts.empty()) return;
  std::string families;
  for (const auto& [family, count] : counts)
    families +=
        fmt::format("{}{}:\u00a0{}", families.empty() ? "" : ", ", chart.families[family].name, count);
  drawn.notes.push_back(fmt::format("Failed: {} of {} configurations ({}), a cross each; they have no price",
                                    panel.failures.size(), panel.trade->points.size(), families));
}

void add_samples(Panel& drawn, const TradeChart& chart, bool references, bool failures) {
  for (const TradeFamily& family : chart.families)
    drawn.curves.push_back(sample(family.name, mark_of(family, 5.6)));
  for (std::size_t s = 0; s < chart.cell_sizes.size() && chart.cell_sizes.size() > 1; ++s)
    drawn.curves.push_back(sample(fmt::format("<i>h</i> = {:.4g} mm", chart.cell_sizes[s] * 1e3),
                                  mark_look(MarkerShape::circle, trade_mark_size(chart, s), size_color)));
  if (references) {
    Look hollow = mark_look(MarkerShape::circle, 5.6, size_color);
    hollow.filled = false;
    drawn.curves.push_back(sample("a finest run, part of the reference", hollow));
  }
  if (failures) drawn.curves.push_back(sample("failed", mark_look(MarkerShape::cross, 4.6, size_color)));
}

std::string asked_label(double error) { return fmt::format("{:g} %", 100.0 * error); }

std::string note_on_reference(const vv::TradeVerdict& trade) {
  const std::string source = name_of_reference(trade.reference.source);
  const std::string doubt =
      trade.reference.uncertainty > 0.0
          ? "uncertain by " + number_markup(100.0 * trade.reference.uncertainty, 2) + "\u00a0%"
          : "";
  if (source.empty()) return doubt.empty() ? "" : "The reference is " + doubt;
  return "Reference: " + source + (doubt.empty() ? "" : ", " + doubt);
}

void add_notes(Panel& drawn, const TradePanel& panel) {
  const auto without =
      std::count_if(panel.trade->points.begin(), panel.trade->points.end(), [&](const vv::TradePoint& point) {
        return point.failure.empty() && std::isfinite(point.error) && !price_of(point, panel.price);
      });
  if (panel.first) {
    const std::string reference = note_on_reference(*panel.trade);
    if (!reference.empty()) drawn.notes.push_back(reference);
  }
  if (without > 0)
    drawn.notes.push_back(fmt::format("{}: {} configurations",
                                      panel.price == Price::seconds ? "Not timed" : "Not counted", without));
}

Panel untimed_panel() {
  Panel panel;
  panel.absence = "No configuration of this problem was timed.";
  return panel;
}

Panel drawn_panel(const TradeChart& chart, const TradePanel& panel) {
  Panel drawn;
  drawn.title = panel.title;
  drawn.x = panel.x;
  drawn.y = panel.y;
  const double uncertainty = panel.trade->reference.uncertainty;
  if (uncertainty > 0.0) {
    const double low = panel.y.range.lower;
    drawn.bands = {{"within the uncertainty of the reference: cannot be told apart",
                    band_color,
                    {panel.x.range.lower, panel.x.range.upper},
                    {low, low},
                    {uncertainty, uncertainty}}};
  }
  for (const double error : panel.asked)
    drawn.levels.push_back({error, asked_label(error), "error asked for", {asked_color, 0.8, {1.5, 2.0}}});
  const bool references = std::any_of(panel.marks.begin(), panel.marks.end(),
                                      [](const TradeMark& mark) { return mark.of_reference; });
  add_samples(drawn, chart, references, !panel.failures.empty());
  if (!panel.front.empty()) {
    PlotCurve line{"Pareto front: nothing is both better and cheaper", {}, {}, {}, 1};
    line.look.color = front_color;
    line.look.line_width = 1.1;
    for (const Point corner : panel.front) {
      line.x.push_back(corner.x);
      line.y.push_back(corner.y);
    }
    drawn.curves.push_back(std::move(line));
  }
  add_marks(drawn, chart, panel);
  add_failures(drawn, chart, panel);
  add_notes(drawn, panel);
  return drawn;
}

}  // namespace

TradeChart trade_chart_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  TradeChart chart;
  const std::vector<const vv::TradeVerdict*> trades = trades_of(verdict, request);
  std::vector<std::string> names;
  for (const vv::TradeVerdict* trade : trades)
    for (const vv::TradePoint& point : trade->points) {
      const std::string name = family_of(point, request_of(verdict, *trade));
      if (index_in(names, name) == names.size()) names.push_back(name);
      if (std::find(chart.cell_sizes.begin(), chart.cell_sizes.end(), point.cell_size) ==
          chart.cell_sizes.end())
        chart.cell_sizes.push_back(point.cell_size);
    }
  std::sort(chart.cell_sizes.begin(), chart.cell_sizes.end(), std::greater<>());
  for (std::size_t k = 0; k < names.size(); ++k)
    chart.families.push_back(
        {names[k].empty() ? "a configuration" : names[k], family_look(names[k], k).color, family_shape(k)});
  const bool several = std::any_of(trades.begin(), trades.end(), [&trades](const vv::TradeVerdict* trade) {
    return trade->title != trades.front()->title;
  });
  for (const vv::TradeVerdict* trade : trades) {
    const vv::TradeRequest* asked = request_of(verdict, *trade);
    const std::vector<double> errors = asked ? asked->asked : std::vector<double>{};
    const Axis axis = error_axis(*trade, errors, name_of_trade_error(*trade, verdict.definition));
    bool first = true;
    for (const Price price : prices_of(*trade)) {
      TradePanel panel = trade_panel(*trade, price, axis, chart, [&](const vv::TradePoint& point) {
        return index_in(names, family_of(point, asked));
      });
      panel.title = name_of_problem(*trade);
      if (several) panel.title = escaped(trade->title) + (panel.title.empty() ? "" : ", ") + panel.title;
      if (panel.title.empty()) panel.title = capitalised(name_of_price(price));
      panel.asked = errors;
      panel.first = first;
      first = false;
      chart.panels.push_back(std::move(panel));
    }
  }
  return chart;
}

double trade_mark_size(const TradeChart& chart, std::size_t size) {
  if (chart.cell_sizes.size() < 2) return 5.2;
  const double part = static_cast<double>(size) / (static_cast<double>(chart.cell_sizes.size()) - 1.0);
  return coarsest_mark + part * (finest_mark - coarsest_mark);
}

bool shows_repeats(const TradeChart& chart, const TradePanel& panel, const TradeMark& mark) {
  constexpr double frame_width = 155.0;  // [pt]
  const Range& range = panel.x.range;
  return std::log(mark.high / mark.low) / std::log(range.upper / range.lower) * frame_width >
         trade_mark_size(chart, mark.size);
}

double failure_abscissa(const Axis& axis, std::size_t number, std::size_t count) {
  const double gap = std::min(0.045, 0.94 / static_cast<double>(std::max<std::size_t>(1, count)));
  return axis.range.lower *
         std::pow(axis.range.upper / axis.range.lower, 0.03 + gap * static_cast<double>(number));
}

Plot trade_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  const TradeChart chart = trade_chart_of(verdict, request);
  Plot plot;
  // Problems one below the other, their prices side by side.
  plot.columns = std::any_of(chart.panels.begin(), chart.panels.end(),
                             [](const TradePanel& panel) { return !panel.first; })
                     ? 2
                     : 1;
  for (const TradePanel& panel : chart.panels) {
    if (panel.first && plot.columns == 2 && plot.panels.size() % 2 == 1)
      plot.panels.push_back(untimed_panel());
    plot.panels.push_back(drawn_panel(chart, panel));
  }
  plot.frame_aspect = plot.columns > 1 ? 0.95 : 0.6;
  if (plot.panels.empty()) {
    Panel nothing;
    nothing.absence = "No trade of speed against accuracy was judged for this figure.";
    plot.panels.push_back(nothing);
    plot.frame_aspect = 0.2;
  }
  plot.stamp = stamp_of(verdict, members_of(verdict, request));
  return plot;
}

}  // namespace mpm::reports
