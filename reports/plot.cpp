#include "reports/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "reports/framed_note.hpp"
#include "reports/legend.hpp"
#include "reports/typography.hpp"

namespace mpm::reports {
namespace {

// Sizes in points.
constexpr double minor_tick = 2.2;
constexpr double column_gap = 16.0;
constexpr double row_gap = 13.0;
constexpr double edge_mark = 5.0;
constexpr double bar_cap = 4.0;  // of an error bar, its whole width

const Color grid_color{0.905, 0.905, 0.905, 1.0};

/// Where a value stands along an axis: 0 at the lower end, 1 at the upper one; may be infinite or NaN.
double fraction(const Axis& axis, double value) {
  const auto [lower, upper] = axis.range;
  if (axis.reversed) return (upper - value) / (upper - lower);
  if (axis.scale == Scale::linear) return (value - lower) / (upper - lower);
  if (value <= 0.0) return -std::numeric_limits<double>::infinity();
  return std::log(value / lower) / std::log(upper / lower);
}

/// An axis with its ticks, labels and common power of ten worked out.
struct ReadyAxis {
  Axis axis;
  std::vector<std::pair<double, std::string>> labels;
  std::vector<double> minor;
  std::string multiplier;  ///< markup of a power of ten common to all labels; may be empty
};

std::string log_label(double value) {
  const double exponent = std::log10(value);
  const double whole = std::round(exponent);
  if (std::abs(exponent - whole) < 1e-9) return power_of_ten(static_cast<int>(whole));
  const double decade = std::floor(exponent);
  return fmt::format("{:.0f}·{}", value / std::pow(10.0, decade), power_of_ten(static_cast<int>(decade)));
}

ReadyAxis ready(const Axis& axis, int wanted) {
  ReadyAxis result{axis, {}, {}, ""};
  if (axis.scale == Scale::logarithmic) {
    const Ticks ticks = logarithmic_ticks(axis.range);
    for (const double t : ticks.major) result.labels.emplace_back(t, log_label(t));
    result.minor = ticks.minor;
  } else {
    Ticks ticks = linear_ticks(axis.range, wanted);
    // Zero alone between two ends tells nothing of how far they are.
    for (int more = wanted + 1; ticks.major.size() < 2 && more < 2 * wanted + 2; ++more)
      ticks = linear_ticks(axis.range, more);
    const double largest = std::max(std::abs(axis.range.lower), std::abs(axis.range.upper));
    const double step = ticks.major.size() > 1 ? ticks.major[1] - ticks.major[0] : largest;
    int exponent = 0;
    if (largest < 0.02 || largest >= 20000.0)
      exponent = static_cast<int>(std::floor(std::log10(largest) + 1e-9));
    const double unit = std::pow(10.0, exponent);
    for (const double t : ticks.major) result.labels.emplace_back(t, tick_label(t / unit, step / unit));
    if (exponent != 0) result.multiplier = "×" + power_of_ten(exponent);
    result.minor = ticks.minor;
  }
  if (!axis.ticks.empty()) {
    result.labels = axis.ticks;
    result.multiplier.clear();
    if (axis.scale == Scale::linear) result.minor.clear();
  }
  return result;
}

/// The x axis of a bar panel: one unit a group.
Axis group_axis(const Panel& panel) {
  Axis axis = panel.x;
  axis.scale = Scale::linear;
  axis.range = {0.0, static_cast<double>(panel.groups.size())};
  axis.ticks.clear();
  for (std::size_t i = 0; i < panel.groups.size(); ++i)
    axis.ticks.emplace_back(static_cast<double>(i) + 0.5, panel.groups[i].name);
  return axis;
}

enum class Fate { inside, outside, not_finite };

Fate fate(const Panel& panel, double x, double y) {
  if (!std::isfinite(x) || !std::isfinite(y)) return Fate::not_finite;
  const double fx = fraction(panel.x, x), fy = fraction(panel.y, y);
  constexpr double slack = 1e-9;
  const bool inside = fx >= -slack && fx <= 1.0 + slack && fy >= -slack && fy <= 1.0 + slack;
  return inside ? Fate::inside : Fate::outside;
}

/// What a panel has to say of points that its axes do not show, by label of the curve.
std::vector<std::string> notes_on_missing_points(const Panel& panel) {
  std::vector<std::pair<std::string, std::pair<int, int>>> counts;
  for (const PlotCurve& curve : panel.curves) {
    int outside = 0, not_finite = 0;
    for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
      const Fate f = fate(panel, curve.x[i], curve.y[i]);
      outside += f == Fate::outside;
      not_finite += f == Fate::not_finite;
    }
    if (outside + not_finite == 0) continue;
    auto same = std::find_if(counts.begin(), counts.end(),
                             [&curve](const auto& entry) { return entry.first == curve.label; });
    if (same == counts.end()) same = counts.insert(same, {curve.label, {0, 0}});
    same->second.first += outside;
    same->second.second += not_finite;
  }
  std::vector<std::string> notes;
  const auto list = [&counts](auto pick) {
    std::string text;
    for (const auto& [label, count] : counts)
      if (pick(count) > 0)
        text += fmt::format("{}{}\u00a0({})", text.empty() ? "" : ", ", label, pick(count));
    return text;
  };
  const std::string outside = list([](const auto& c) { return c.first; });
  const std::string not_finite = list([](const auto& c) { return c.second; });
  if (!outside.empty()) notes.push_back("Points beyond the axes, marked at the edge: " + outside);
  if (!not_finite.empty()) notes.push_back("Points that are not finite, not drawn: " + not_finite);
  return notes;
}

/// The bars that the axis cuts, with their values.
std::vector<std::string> notes_on_cut_bars(const Panel& panel) {
  std::string list;
  for (const BarGroup& group : panel.groups)
    for (std::size_t s = 0; s < std::min(panel.bar_series.size(), group.values.size()); ++s)
      if (std::isfinite(group.values[s]) && fraction(panel.y, group.values[s]) > 1.0)
        list += fmt::format("{}{}{}{} ({:.2g})", list.empty() ? "" : ", ", panel.bar_series[s].label,
                            group.name.empty() ? "" : " at ", group.name, group.values[s]);
  if (list.empty()) return {};
  return {"Bars cut by the axis: " + list};
}

/// A panel measured and placed.
struct Placed {
  const Panel* panel = nullptr;
  ReadyAxis x, y;
  std::vector<std::string> notes;
  std::string absence;  ///< as it stands in the frame
  double left_room = 0.0, right_room = 0.0, top_room = 0.0, bottom_room = 0.0;
  double notes_height = 0.0;
  Rectangle frame;

  Point at(double x_value, double y_value) const {
    return {frame.left + fraction(x.axis, x_value) * frame.width(),
            frame.bottom - fraction(y.axis, y_value) * frame.height()};
  }
};

double widest_label(const ReadyAxis& axis) {
  double widest = 0.0;
  for (const auto& [value, label] : axis.labels) widest = std::max(widest, text_width(label));
  return widest;
}

bool labels_fit(const ReadyAxis& axis, double length) {
  double sum = 0.0;
  for (const auto& [value, label] : axis.labels) sum += text_width(label) + 7.0;
  return sum <= length;
}

Placed measured(const Panel& panel, double frame_guess, double aspect) {
  Placed placed;
  placed.panel = &panel;
  if (!panel.absence.empty()) {
    placed.absence = panel.absence;
    placed.notes = panel.notes;
    placed.top_room = 17.0;
    return placed;
  }
  const Axis x_axis = panel.groups.empty() ? panel.x : group_axis(panel);
  for (int wanted = 6; wanted >= 2; --wanted) {
    placed.x = ready(x_axis, wanted);
    if (labels_fit(placed.x, frame_guess)) break;
  }
  placed.y = ready(panel.y, std::clamp(static_cast<int>(frame_guess * aspect * panel.height / 24.0), 3, 7));
  placed.notes = panel.notes;
  for (std::string& note : notes_on_missing_points(panel)) placed.notes.push_back(std::move(note));
  for (std::string& note : notes_on_cut_bars(panel)) placed.notes.push_back(std::move(note));
  placed.left_room = (panel.y.label.empty() ? 0.0 : line_height + 3.0) + widest_label(placed.y) + tick_gap;
  double label_width = 0.0;
  for (const LevelLine& level : panel.levels) label_width = std::max(label_width, text_width(level.label));
  placed.right_room = std::max(6.0, label_width > 0.0 ? label_width + 4.0 : 0.0);
  placed.top_room = 17.0;
  placed.bottom_room = tick_gap + line_height + (panel.x.label.empty() ? 0.0 : line_height + 2.0);
  return placed;
}

/// What does not fit in a frame of this size is said below it.
void move_long_absence(Placed& placed, const Rectangle& frame) {
  if (placed.absence.empty() || fits_in_frame(frame, placed.absence)) return;
  placed.notes.insert(placed.notes.begin(), placed.absence);
  placed.absence = "see below";
}

double notes_height(const std::vector<std::string>& notes, double width) {
  double height = 0.0;
  for (const std::string& note : notes) height += Canvas::measure(note, note_style(width)).height() + 1.0;
  return notes.empty() ? 0.0 : height + 4.0;
}

// ---- the legend
// -----------------------------------------------------------------------------------------------

std::vector<LegendEntry> legend_of(const Plot& plot) {
  std::vector<LegendEntry> entries;
  const auto add = [&entries](LegendEntry entry) { add_entry(entries, std::move(entry)); };
  for (const Panel& panel : plot.panels) {
    for (const PlotCurve& curve : panel.curves)
      add({LegendEntry::Kind::curve, curve.label, curve.look, {}, !curve.bars.empty()});
    for (const BarSeries& series : panel.bar_series)
      add({LegendEntry::Kind::bar, series.label, series.look, {}});
  }
  for (const Panel& panel : plot.panels)
    for (const Band& band : panel.bands) {
      Look look;
      look.color = band.color;
      add({LegendEntry::Kind::band, band.label, look, {}});
    }
  for (const Panel& panel : plot.panels)
    for (const LevelLine& level : panel.levels)
      add({LegendEntry::Kind::level, level.legend, {}, level.stroke});
  return entries;
}

// ---- one panel
// ------------------------------------------------------------------------------------------------

void draw_grid(Canvas& canvas, const Placed& placed) {
  const Rectangle& f = placed.frame;
  for (const auto& [value, label] : placed.y.labels) {
    const double y = placed.at(placed.x.axis.range.lower, value).y;
    canvas.rule({f.left, y}, {f.right, y}, 0.5, grid_color);
  }
  if (!placed.panel->groups.empty()) return;
  for (const auto& [value, label] : placed.x.labels) {
    const double x = placed.at(value, placed.y.axis.range.lower).x;
    canvas.rule({x, f.top}, {x, f.bottom}, 0.5, grid_color);
  }
}

void draw_x_ticks(Canvas& canvas, const Placed& placed) {
  const Rectangle& f = placed.frame;
  const bool groups = !placed.panel->groups.empty();
  const auto tick = [&](double value, double length) {
    const double x = f.left + fraction(placed.x.axis, value) * f.width();
    if (x < f.left - 0.01 || x > f.right + 0.01) return;
    canvas.rule({x, f.bottom}, {x, f.bottom - length}, axis_width, ink);
    canvas.rule({x, f.top}, {x, f.top + length}, axis_width, ink);
  };
  if (!groups)
    for (const double value : placed.x.minor) tick(value, minor_tick);
  for (const auto& [value, label] : placed.x.labels) {
    if (!groups) tick(value, major_tick);
    const double x = f.left + fraction(placed.x.axis, value) * f.width();
    canvas.text({x, f.bottom + tick_gap + 8.0}, label, text_style(Horizontal::center, Vertical::baseline));
  }
  const double baseline = f.bottom + tick_gap + line_height + 10.0;
  canvas.text({(f.left + f.right) / 2, baseline}, placed.x.axis.label,
              text_style(Horizontal::center, Vertical::baseline));
  canvas.text({f.right, baseline}, placed.x.multiplier, text_style(Horizontal::right, Vertical::baseline));
}

void draw_y_ticks(Canvas& canvas, const Placed& placed) {
  const Rectangle& f = placed.frame;
  const auto tick = [&](double value, double length) {
    const double y = f.bottom - fraction(placed.y.axis, value) * f.height();
    if (y < f.top - 0.01 || y > f.bottom + 0.01) return;
    canvas.rule({f.left, y}, {f.left + length, y}, axis_width, ink);
    canvas.rule({f.right, y}, {f.right - length, y}, axis_width, ink);
  };
  for (const double value : placed.y.minor) tick(value, minor_tick);
  for (const auto& [value, label] : placed.y.labels) {
    tick(value, major_tick);
    const double y = f.bottom - fraction(placed.y.axis, value) * f.height();
    canvas.text({f.left - tick_gap, y}, label, text_style(Horizontal::right, Vertical::middle));
  }
  TextStyle upward = text_style(Horizontal::center, Vertical::bottom);
  upward.upward = true;
  canvas.text({f.left - tick_gap - widest_label(placed.y) - 3.0, (f.top + f.bottom) / 2}, placed.y.axis.label,
              upward);
  canvas.text({f.left - tick_gap, f.top - 6.5}, placed.y.multiplier,
              text_style(Horizontal::right, Vertical::baseline));
}

void draw_frame(Canvas& canvas, const Rectangle& f) {
  canvas.rule({f.left, f.top}, {f.right, f.top}, axis_width, ink);
  canvas.rule({f.left, f.bottom}, {f.right, f.bottom}, axis_width, ink);
  canvas.rule({f.left, f.top}, {f.left, f.bottom}, axis_width, ink);
  canvas.rule({f.right, f.top}, {f.right, f.bottom}, axis_width, ink);
}

/// Pulls a point onto the frame, as far inside as its mark needs.
Point at_edge(Point p, const Rectangle& f) {
  const double inset = edge_mark / 2;
  const auto pulled = [inset](double v, double low, double high) {
    return std::isnan(v) ? low : std::clamp(v, low + inset, high - inset);
  };
  return {pulled(p.x, f.left, f.right), pulled(p.y, f.top, f.bottom)};
}

/// A small arrowhead at the edge, pointing to where the point really is.
void draw_edge_mark(Canvas& canvas, Point at, Point truth, const Rectangle& f, const Color& color) {
  const double r = edge_mark / 2;
  Point d{0.0, 0.0};
  if (truth.y < f.top)
    d = {0.0, -1.0};
  else if (truth.y > f.bottom)
    d = {0.0, 1.0};
  else
    d = {truth.x < f.left ? -1.0 : 1.0, 0.0};
  canvas.polygon({{at.x + r * d.x, at.y + r * d.y},
                  {at.x - r * d.x + r * d.y, at.y - r * d.y + r * d.x},
                  {at.x - r * d.x - r * d.y, at.y - r * d.y - r * d.x}},
                 color);
}

/// Where a point stands. Zero on a logarithmic axis lies infinitely far out: it is brought within reach of
/// the line's clipping.
Point reachable(const Placed& placed, double x, double y) {
  const Point place = placed.at(x, y);
  if (!std::isfinite(x) || !std::isfinite(y)) return place;
  return {std::clamp(place.x, -1e7, 1e7), std::clamp(place.y, -1e7, 1e7)};
}

/// A band as one piece between each two abscissae; pieces share their edges exactly.
void draw_band(Canvas& canvas, const Placed& placed, const Band& band) {
  const std::size_t count = std::min({band.x.size(), band.lower.size(), band.upper.size()});
  canvas.clip(placed.frame);
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const std::vector<Point> corners{
        reachable(placed, band.x[i], band.lower[i]), reachable(placed, band.x[i + 1], band.lower[i + 1]),
        reachable(placed, band.x[i + 1], band.upper[i + 1]), reachable(placed, band.x[i], band.upper[i])};
    const bool whole = std::all_of(corners.begin(), corners.end(),
                                   [](Point p) { return std::isfinite(p.x) && std::isfinite(p.y); });
    if (whole) canvas.polygon(corners, band.color);
  }
  canvas.unclip();
}

/// Upright bars with a cap at either end, cut at the frame.
void draw_error_bars(Canvas& canvas, const Placed& placed, const PlotCurve& curve) {
  const std::size_t count = std::min({curve.x.size(), curve.y.size(), curve.bars.size()});
  const Stroke stroke{curve.look.color, bar_width, {}};
  canvas.clip(placed.frame);
  for (std::size_t i = 0; i < count; ++i) {
    const Point low = reachable(placed, curve.x[i], curve.y[i] - curve.bars[i]),
                high = reachable(placed, curve.x[i], curve.y[i] + curve.bars[i]);
    if (!std::isfinite(low.x + low.y + high.y) || !(curve.bars[i] > 0.0)) continue;
    canvas.line({low, high}, stroke);
    for (const double y : {low.y, high.y})
      canvas.line({{low.x - bar_cap / 2, y}, {low.x + bar_cap / 2, y}}, stroke);
  }
  canvas.unclip();
}

/// Level bars with a cap at either end, cut at the frame.
void draw_level_error_bars(Canvas& canvas, const Placed& placed, const PlotCurve& curve) {
  const std::size_t count =
      std::min({curve.x.size(), curve.y.size(), curve.x_low.size(), curve.x_high.size()});
  canvas.clip(placed.frame);
  for (std::size_t i = 0; i < count; ++i) {
    const Point low = reachable(placed, curve.x_low[i], curve.y[i]),
                high = reachable(placed, curve.x_high[i], curve.y[i]);
    if (!std::isfinite(low.x + high.x + low.y) || !(high.x > low.x)) continue;
    draw_whisker(canvas, low.x, high.x, low.y, bar_cap, {curve.look.color, bar_width, {}});
  }
  canvas.unclip();
}

void draw_curve(Canvas& canvas, const Placed& placed, const PlotCurve& curve, Layout::Panel& layout) {
  const std::size_t count = std::min(curve.x.size(), curve.y.size());
  std::vector<Point> path(count);
  for (std::size_t i = 0; i < count; ++i) path[i] = reachable(placed, curve.x[i], curve.y[i]);
  draw_error_bars(canvas, placed, curve);
  draw_level_error_bars(canvas, placed, curve);
  canvas.clip(placed.frame);
  if (curve.look.line_width > 0.0)
    canvas.line(path, {curve.look.color, curve.look.line_width, curve.look.dash});
  canvas.unclip();
  std::optional<Point> last_mark;
  for (std::size_t i = 0; i < count; ++i) {
    const Fate f = fate(*placed.panel, curve.x[i], curve.y[i]);
    if (f == Fate::not_finite) {
      ++layout.not_finite;
    } else if (f == Fate::inside) {
      canvas.marker(path[i], marker_of(curve.look));
      layout.points.push_back(path[i]);
    } else {
      ++layout.outside;
      const Point mark = at_edge(path[i], placed.frame);
      layout.points.push_back(mark);
      // A long excursion of a dense line needs no mark at every sample.
      const bool crowded = last_mark && curve.look.marker == MarkerShape::none &&
                           std::hypot(mark.x - last_mark->x, mark.y - last_mark->y) < edge_mark;
      if (crowded) continue;
      draw_edge_mark(canvas, mark, path[i], placed.frame, curve.look.color);
      last_mark = mark;
    }
  }
}

/// Words where a bar would stand, upright unless they are short; on white, so that no line crosses them.
void write_in_bar_slot(Canvas& canvas, Point foot, const std::string& words, const Color& color,
                       Layout::Panel& layout) {
  TextStyle style = text_style(Horizontal::left, Vertical::middle, type_size, color);
  style.upward = words.size() > 3;
  const TextExtent extent = Canvas::measure(words, style);
  Rectangle covered{foot.x - 5.0, foot.y - extent.width - 2.0, foot.x + 5.0, foot.y + 1.0};
  if (!style.upward) {
    covered = {foot.x - extent.width / 2 - 1.0, foot.y - type_size, foot.x + extent.width / 2 + 1.0,
               foot.y + 1.0};
    style.horizontal = Horizontal::center;
    style.vertical = Vertical::baseline;
  }
  canvas.rectangle(covered, white);
  canvas.text(foot, words, style);
  layout.annotations.push_back(covered);
}

/// Where a bar has no height that could be drawn, the words that stand in its place; else nothing.
std::string words_instead_of_bar(const Panel& panel, const BarGroup& group, std::size_t series) {
  const double value = group.values[series];
  if (std::isfinite(value)) {
    if (fraction(panel.y, value) > 0.0) return "";
    return value == 0.0 ? "0" : fmt::format("{:.1g}", value);
  }
  const std::string why = series < group.absences.size() ? group.absences[series] : "";
  return why.empty() ? "no value" : why;
}

/// Draws the bars, or with `words` what stands in place of those that cannot be drawn.
void draw_bars(Canvas& canvas, const Placed& placed, bool words, Layout::Panel& layout) {
  const Panel& panel = *placed.panel;
  const Rectangle& f = placed.frame;
  const double group_width = f.width() / static_cast<double>(panel.groups.size());
  const double slot =
      group_width * 0.78 / static_cast<double>(std::max<std::size_t>(1, panel.bar_series.size()));
  const double bar_width = std::min(slot * 0.84, 26.0);
  for (std::size_t g = 0; g < panel.groups.size(); ++g) {
    const BarGroup& group = panel.groups[g];
    for (std::size_t s = 0; s < std::min(panel.bar_series.size(), group.values.size()); ++s) {
      const double offset = static_cast<double>(s) - (static_cast<double>(panel.bar_series.size()) - 1.0) / 2;
      const double x = f.left + (static_cast<double>(g) + 0.5) * group_width + offset * slot;
      const Look& look = panel.bar_series[s].look;
      const double value = group.values[s];
      const std::string instead = words_instead_of_bar(panel, group, s);
      if (words != !instead.empty()) continue;
      if (words) {
        ++(std::isfinite(value) ? layout.outside : layout.not_finite);
        write_in_bar_slot(canvas, {x, f.bottom - 4.0}, instead, look.color, layout);
        continue;
      }
      const double height = fraction(panel.y, value);
      Rectangle bar{x - bar_width / 2, f.bottom - std::min(height, 1.0) * f.height(), x + bar_width / 2,
                    f.bottom};
      if (height > 1.0) {
        ++layout.outside;
        bar.top = f.top + edge_mark + 4.0;
        draw_edge_mark(canvas, {x, f.top + edge_mark / 2 + 1.5}, {x, f.top - 1.0}, f, look.color);
      }
      canvas.clip(f);
      fill_bar(canvas, bar, look, f);
      canvas.unclip();
      layout.points.push_back({x, bar.top});
    }
  }
}

void draw_levels(Canvas& canvas, const Placed& placed) {
  const Rectangle& f = placed.frame;
  std::vector<std::pair<double, std::string>> labels;
  for (const LevelLine& level : placed.panel->levels) {
    const double at = fraction(placed.y.axis, level.value);
    if (!(at >= 0.0 && at <= 1.0)) continue;
    const double y = f.bottom - at * f.height();
    canvas.line({{f.left, y}, {f.right, y}}, level.stroke);
    labels.emplace_back(y, level.label);
  }
  std::sort(labels.begin(), labels.end());
  double previous = -1e9;
  for (const auto& [y, label] : labels) {
    previous = std::max(y, previous + line_height - 1.0);
    canvas.text({f.right + 4.0, previous}, label, text_style(Horizontal::left, Vertical::middle));
  }
}

// ---- reference slopes
// -----------------------------------------------------------------------------------------

/// What a panel's curves and lines cover, sampled densely.
std::vector<Point> covered_places(const Placed& placed, const Layout::Panel& layout) {
  std::vector<Point> places = layout.points;
  const auto sample = [&places](Point a, Point b) {
    const int steps = 1 + static_cast<int>(std::min(400.0, std::hypot(b.x - a.x, b.y - a.y) / 2.0));
    for (int k = 0; k <= steps; ++k)
      places.push_back({a.x + (b.x - a.x) * k / steps, a.y + (b.y - a.y) * k / steps});
  };
  for (const PlotCurve& curve : placed.panel->curves) {
    if (curve.look.line_width <= 0.0) continue;
    for (std::size_t i = 0; i + 1 < std::min(curve.x.size(), curve.y.size()); ++i) {
      const Point a = placed.at(curve.x[i], curve.y[i]), b = placed.at(curve.x[i + 1], curve.y[i + 1]);
      if (std::isfinite(a.x + a.y + b.x + b.y)) sample(a, b);
    }
  }
  for (const LevelLine& level : placed.panel->levels) {
    const double y = placed.at(placed.x.axis.range.lower, level.value).y;
    if (std::isfinite(y)) sample({placed.frame.left, y}, {placed.frame.right, y});
  }
  return places;
}

/// Finds room for a rectangle inside the frame, clear of `covered` and `taken`; nearest to the lower right
/// corner.
std::optional<Rectangle> empty_place(const Rectangle& frame, double width, double height,
                                     const std::vector<Point>& covered, const std::vector<Rectangle>& taken) {
  constexpr double clearance = 5.0, step = 4.0;
  for (double bottom = frame.bottom - 7.0; bottom - height > frame.top + 7.0; bottom -= step)
    for (double right = frame.right - 7.0; right - width > frame.left + 7.0; right -= step) {
      const Rectangle place{right - width, bottom - height, right, bottom};
      const Rectangle grown = place.grown(clearance);
      const bool free =
          std::none_of(covered.begin(), covered.end(), [&](Point p) { return grown.contains(p); }) &&
          std::none_of(taken.begin(), taken.end(), [&](const Rectangle& r) { return grown.intersects(r); });
      if (free) return place;
    }
  return std::nullopt;
}

/// Right triangles of the given slopes over a common base, if there is room for them.
void draw_slopes(Canvas& canvas, const Placed& placed, const std::vector<double>& orders,
                 const std::vector<Point>& covered, Layout::Panel& layout) {
  const Rectangle& f = placed.frame;
  const double x_decade = f.width() / std::log10(placed.x.axis.range.upper / placed.x.axis.range.lower);
  const double y_decade = f.height() / std::log10(placed.y.axis.range.upper / placed.y.axis.range.lower);
  const double steepest = *std::max_element(orders.begin(), orders.end());
  double label_width = 0.0;
  for (const double order : orders)
    label_width = std::max(label_width, text_width(fmt::format("order {:g}", order)));
  std::optional<Rectangle> place;
  double run = 0.0;
  for (double decades = 0.4; decades > 0.1 && !place; decades -= 0.05) {
    run = decades * x_decade;
    place = empty_place(f, run + 4.0 + label_width, decades * steepest * y_decade + 8.0, covered,
                        layout.annotations);
  }
  if (!place) return;
  layout.annotations.push_back(*place);
  const Point corner{place->left, place->bottom - 4.0}, foot{place->left + run, corner.y};
  for (const double order : orders) {
    const Point apex{foot.x, foot.y - order * run / x_decade * y_decade};
    canvas.line({corner, foot, apex, corner, foot}, {muted, 0.7, {}});
    canvas.text({foot.x + 4.0, apex.y}, fmt::format("order {:g}", order),
                text_style(Horizontal::left, Vertical::middle, type_size, muted));
  }
}

void draw_notes(Canvas& canvas, const Placed& placed, double left, double width) {
  double top = placed.frame.bottom + placed.bottom_room + 3.0;
  for (const std::string& note : placed.notes) {
    const TextStyle style = note_style(width);
    canvas.text({left, top}, note, style);
    top += Canvas::measure(note, style).height() + 1.0;
  }
}

void write_title(Canvas& canvas, const Placed& placed, std::size_t number, bool tagged) {
  const std::string tag = tagged ? fmt::format("<b>({})</b> ", static_cast<char>('a' + number % 26)) : "";
  canvas.text({placed.frame.left, placed.frame.top - 6.5}, tag + placed.panel->title,
              text_style(Horizontal::left, Vertical::baseline, title_size));
}

Layout::Panel draw_panel(Canvas& canvas, const Placed& placed, std::size_t number, bool tagged,
                         double notes_left, double notes_width) {
  Layout::Panel layout;
  layout.frame = placed.frame;
  write_title(canvas, placed, number, tagged);
  draw_notes(canvas, placed, notes_left, notes_width);
  if (!placed.panel->absence.empty()) {
    layout.annotations.push_back(write_in_frame(canvas, placed.frame, placed.absence, placed.panel->hatched));
    draw_frame(canvas, placed.frame);
    return layout;
  }
  draw_grid(canvas, placed);
  for (const Band& band : placed.panel->bands) draw_band(canvas, placed, band);
  if (!placed.panel->groups.empty()) draw_bars(canvas, placed, false, layout);
  draw_levels(canvas, placed);
  if (!placed.panel->groups.empty()) draw_bars(canvas, placed, true, layout);
  draw_frame(canvas, placed.frame);
  draw_x_ticks(canvas, placed);
  draw_y_ticks(canvas, placed);
  std::vector<const PlotCurve*> order;
  for (const PlotCurve& curve : placed.panel->curves) order.push_back(&curve);
  std::stable_sort(order.begin(), order.end(),
                   [](const PlotCurve* a, const PlotCurve* b) { return a->layer < b->layer; });
  for (const PlotCurve* curve : order) draw_curve(canvas, placed, *curve, layout);
  if (!placed.panel->reference_slopes.empty()) {
    const std::vector<Point> covered = covered_places(placed, layout);
    draw_slopes(canvas, placed, placed.panel->reference_slopes, covered, layout);
  }
  return layout;
}

}  // namespace

std::string power_of_ten(int exponent) {
  if (exponent == 0) return "1";
  if (exponent == 1) return "10";
  return fmt::format("10<sup>{}{}</sup>", exponent < 0 ? "−" : "", std::abs(exponent));
}

std::string tick_label(double value, double step) {
  int decimals = 0;
  for (double s = std::abs(step);
       decimals < 8 && s > 0.0 && std::abs(s - std::round(s)) > 1e-6 * std::max(1.0, s); s *= 10.0)
    ++decimals;
  const std::string digits = fmt::format("{:.{}f}", std::abs(value), decimals);
  const bool zero = digits.find_first_not_of("0.") == std::string::npos;
  return (value < 0.0 && !zero ? "−" : "") + digits;
}

Ticks linear_ticks(const Range& range, int wanted) {
  Ticks ticks;
  const double span = range.upper - range.lower;
  if (!(span > 0.0) || !std::isfinite(span)) return ticks;
  const double raw = span / std::max(1, wanted);
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * power;
  int parts = 5;
  for (const auto& [multiple, division] : {std::pair{1.0, 5}, {2.0, 4}, {2.5, 5}, {5.0, 5}})
    if (multiple * power >= raw * (1.0 - 1e-9)) {
      step = multiple * power;
      parts = division;
      break;
    }
  const double minor = step / parts;
  const double slack = 1e-9 * span;
  const auto first = static_cast<long long>(std::ceil((range.lower - slack) / minor));
  const auto last = static_cast<long long>(std::floor((range.upper + slack) / minor));
  for (long long k = first; k <= last; ++k) {
    if (k % parts == 0)
      ticks.major.push_back(static_cast<double>(k / parts) * step);
    else
      ticks.minor.push_back(static_cast<double>(k) * minor);
  }
  return ticks;
}

Ticks logarithmic_ticks(const Range& range, int most) {
  Ticks ticks;
  if (!(range.lower > 0.0 && range.upper > range.lower && std::isfinite(range.upper))) return ticks;
  const double lower = range.lower * (1.0 - 1e-9), upper = range.upper * (1.0 + 1e-9);
  const int first = static_cast<int>(std::ceil(std::log10(lower))),
            last = static_cast<int>(std::floor(std::log10(upper)));
  const int decades = last - first + 1;
  const int stride = std::max(1, (decades + most - 1) / most);
  for (int exponent = first - 1; exponent <= last; ++exponent) {
    const double decade = std::pow(10.0, exponent);
    for (int k = 1; k <= 9; ++k) {
      const double value = k * decade;
      if (value < lower || value > upper) continue;
      const bool labelled = k == 1 ? exponent % stride == 0 : decades < 2 && (k == 2 || k == 5);
      if (labelled)
        ticks.major.push_back(value);
      else if (stride == 1 || k == 1)
        ticks.minor.push_back(value);
    }
  }
  return ticks;
}

Look look_of_series(int n) {
  using Pattern = Look::Pattern;
  // Okabe and Ito's colours; shape, dash and hatching differ as well.
  static const std::vector<Look> looks{
      {{0.835, 0.369, 0.0, 1.0}, 1.2, {4.0, 3.0}, MarkerShape::circle, 5.2, false, Pattern::hatched},
      {{0.0, 0.447, 0.698, 1.0}, 1.2, {6.0, 2.0, 1.4, 2.0}, MarkerShape::square, 3.3, false, Pattern::light},
      {{0.0, 0.52, 0.38, 1.0}, 1.2, {}, MarkerShape::diamond, 2.0, true, Pattern::solid},
      {{0.70, 0.36, 0.55, 1.0}, 1.2, {1.4, 1.8}, MarkerShape::triangle, 4.4, false, Pattern::hatched},
      {{0.80, 0.55, 0.0, 1.0}, 1.2, {9.0, 2.5}, MarkerShape::cross, 4.4, false, Pattern::light},
      {{0.20, 0.20, 0.20, 1.0}, 1.2, {3.0, 1.5}, MarkerShape::triangle, 2.6, true, Pattern::solid},
      // Six more, for pictures with many series: darker and paler neighbours, each with a dash of its own.
      {{0.25, 0.65, 0.88, 1.0}, 1.2, {12.0, 3.0}, MarkerShape::circle, 3.0, true, Pattern::solid},
      {{0.58, 0.05, 0.12, 1.0},
       1.2,
       {6.0, 2.0, 1.4, 2.0, 1.4, 2.0},
       MarkerShape::square,
       2.6,
       true,
       Pattern::solid},
      {{0.42, 0.27, 0.62, 1.0}, 1.2, {5.0, 1.5}, MarkerShape::diamond, 4.4, false, Pattern::light},
      {{0.50, 0.50, 0.05, 1.0}, 1.2, {2.2, 3.2}, MarkerShape::triangle, 3.4, true, Pattern::hatched},
      {{0.12, 0.18, 0.48, 1.0}, 1.2, {8.0, 2.0, 3.0, 2.0}, MarkerShape::square, 4.2, false, Pattern::hatched},
      {{0.45, 0.26, 0.10, 1.0}, 1.2, {4.0, 1.2, 1.2, 1.2}, MarkerShape::cross, 3.4, false, Pattern::light},
  };
  const int count = static_cast<int>(looks.size());
  return looks[static_cast<std::size_t>(((n % count) + count) % count)];
}

Picture draw(const Plot& plot, double pixels_per_point) {
  const std::size_t columns = static_cast<std::size_t>(std::max(1, plot.columns));
  const std::size_t stack = static_cast<std::size_t>(std::max(1, plot.stack));
  const double guess = (plot.width - 2 * outer_margin) / static_cast<double>(columns) - 45.0;
  std::vector<Placed> placed;
  for (const Panel& panel : plot.panels) placed.push_back(measured(panel, guess, plot.frame_aspect));
  const auto column_of = [&](std::size_t i) { return i / stack % columns; };
  std::vector<std::vector<std::size_t>> rows;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const std::size_t row = i / (stack * columns) * stack + i % stack;
    rows.resize(std::max(rows.size(), row + 1));
    rows[row].push_back(i);
  }

  // All frames are equally wide; a column has the room its widest labels need.
  std::vector<double> left(columns, 0.0), right(columns, 0.0);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    left[column_of(i)] = std::max(left[column_of(i)], placed[i].left_room);
    right[column_of(i)] = std::max(right[column_of(i)], placed[i].right_room);
  }
  double free_width = plot.width - 2 * outer_margin - column_gap * (static_cast<double>(columns) - 1.0);
  for (std::size_t c = 0; c < columns; ++c) free_width -= left[c] + right[c];
  const double frame_width = std::max(40.0, free_width / static_cast<double>(columns));
  const double frame_height = frame_width * plot.frame_aspect;

  double top = outer_margin;
  for (const std::vector<std::size_t>& row : rows) {
    double x = outer_margin, tallest_notes = 0.0, above = 0.0, below = 0.0, tallest = 0.0;
    for (const std::size_t i : row) {
      above = std::max(above, placed[i].top_room);
      below = std::max(below, placed[i].bottom_room);
      tallest = std::max(tallest, placed[i].panel->height * frame_height);
      move_long_absence(placed[i], {0.0, 0.0, frame_width, placed[i].panel->height * frame_height});
      placed[i].notes_height = notes_height(placed[i].notes, left[column_of(i)] + frame_width);
      tallest_notes = std::max(tallest_notes, placed[i].notes_height);
    }
    for (const std::size_t i : row) {
      const std::size_t c = column_of(i);
      placed[i].frame = {x + left[c], top + above, x + left[c] + frame_width,
                         top + above + placed[i].panel->height * frame_height};
      x += left[c] + frame_width + right[c] + column_gap;
    }
    top += above + tallest + below + tallest_notes + row_gap;
  }
  const auto legend = legend_rows(legend_of(plot), plot.width - 2 * outer_margin);
  const double legend_top = top - 4.0;
  if (!legend.empty()) top = legend_top + legend_height(legend) + 6.0;
  if (!plot.stamp.empty()) top += stamp_size + 3.0;

  Picture picture{Canvas(plot.width, top + 2.0, pixels_per_point), {}};
  for (std::size_t i = 0; i < placed.size(); ++i)
    picture.layout.panels.push_back(draw_panel(picture.canvas, placed[i], i, placed.size() > 1,
                                               placed[i].frame.left - left[column_of(i)],
                                               left[column_of(i)] + frame_width));
  if (!legend.empty()) picture.layout.legend = draw_legend(picture.canvas, legend, legend_top);
  picture.canvas.text({plot.width - outer_margin, picture.canvas.height() - 4.0}, plot.stamp,
                      text_style(Horizontal::right, Vertical::baseline, stamp_size, stamp_color));
  return picture;
}

}  // namespace mpm::reports
