#include "reports/trade_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "reports/figures.hpp"
#include "reports/page_data.hpp"
#include "reports/trade_figures.hpp"

namespace mpm::reports {
namespace {

// Sizes in the units of the view, about pixels.
constexpr double view_width = 480.0, view_height = 390.0;
constexpr Rectangle frame{46.0, 26.0, 432.0, 346.0};
constexpr double px_per_pt = 1.75;  // of marks, which are larger on a screen than on paper
constexpr double edge_inset = 4.0;

std::string hex(const Color& color) {
  const auto part = [](double value) {
    return static_cast<int>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", part(color.red), part(color.green), part(color.blue));
}

double fraction(const Axis& axis, double value) {
  return std::log(std::max(value, 1e-300) / axis.range.lower) / std::log(axis.range.upper / axis.range.lower);
}

double across(const TradePanel& panel, double price) {
  return frame.left + fraction(panel.x, price) * frame.width();
}

double down(const TradePanel& panel, double error) {
  return frame.bottom - fraction(panel.y, error) * frame.height();
}

Point within_frame(Point p) {
  return {std::clamp(p.x, frame.left, frame.right), std::clamp(p.y, frame.top, frame.bottom)};
}

// ---- shapes around the origin
// -----------------------------------------------------------------------------------

std::string outline(MarkerShape shape, double size) {
  const double r = size / 2.0;
  switch (shape) {
    case MarkerShape::square:
      return fmt::format("M{0:.1f} {0:.1f}H{1:.1f}V{1:.1f}H{0:.1f}Z", -0.89 * r, 0.89 * r);
    case MarkerShape::diamond:
      return fmt::format("M0 {0:.1f}L{1:.1f} 0L0 {1:.1f}L{0:.1f} 0Z", -1.25 * r, 1.25 * r);
    case MarkerShape::triangle:
      return fmt::format("M0 {:.1f}L{:.1f} {:.1f}H{:.1f}Z", -1.3 * r, 1.2 * r, 0.8 * r, -1.2 * r);
    case MarkerShape::cross:
      return fmt::format("M{0:.1f} {0:.1f}L{1:.1f} {1:.1f}M{0:.1f} {1:.1f}L{1:.1f} {0:.1f}", -r, r);
    case MarkerShape::circle:
    case MarkerShape::none:
      break;
  }
  return fmt::format("M{0:.1f} 0A{1:.1f} {1:.1f} 0 1 1 {1:.1f} 0A{1:.1f} {1:.1f} 0 1 1 {0:.1f} 0Z", -r, r);
}

/// An arrowhead that points to where a place beyond the frame is.
std::string arrowhead(Point place) {
  if (place.y < frame.top) return "M0 -5L5 4H-5Z";
  if (place.y > frame.bottom) return "M0 5L5 -4H-5Z";
  return place.x < frame.left ? "M-5 0L4 5V-5Z" : "M5 0L-4 5V-5Z";
}

// ---- what the box says
// ------------------------------------------------------------------------------------------

std::string repeats_text(const vv::Timing& timing) {
  return fmt::format("{} repeat{} of {}", timing.repeats, timing.repeats == 1 ? "" : "s",
                     timing.whole ? "the whole run" : "its beginning, scaled up");
}

std::string steps_text(const vv::CaseVerdict& verdict, const vv::TradePoint& point) {
  std::string text;
  if (point.run < verdict.runs.size() && verdict.runs[point.run].record.cost.steps > 0)
    text = count_markup(verdict.runs[point.run].record.cost.steps) + " steps, ";
  return point.work.particle_steps > 0.0
             ? text + without_tags(number_markup(point.work.particle_steps)) + " particle-steps"
             : text.substr(0, text.empty() ? 0 : text.size() - 2);
}

/// Lines of escaped text, the configuration first.
std::string description(const vv::CaseVerdict& verdict, const TradePanel& panel,
                        const vv::TradePoint& point) {
  std::string text = without_tags(name_of_configuration(*panel.trade, point));
  const auto add = [&text](const std::string& words, const std::string& what) {
    if (!what.empty()) text += "\n" + words + without_tags(what);
  };
  if (!point.failure.empty() || !std::isfinite(point.error)) {
    add("failed: ", point.failure.empty() ? "there is no error" : escaped(point.failure));
    return text;
  }
  add("error ", error_markup(point));
  if (point.timing)
    add("time ", timing_markup(point) + "; " + repeats_text(*point.timing));
  else
    add("", "not timed");
  if (point.work.bytes > 0.0) add("data moved ", price_markup(point.work.bytes, Price::bytes));
  add("", steps_text(verdict, point));
  if (point.of_reference) add("", "one of the finest runs, which the reference is made of");
  if (on_front(point, panel.price)) add("", "on the front: nothing is both better and cheaper");
  return text;
}

// ---- one panel
// --------------------------------------------------------------------------------------------------

void line(std::string& svg, const char* kind, Point from, Point to) {
  svg += fmt::format("<path class=\"{}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", kind, from.x, from.y, to.x,
                     to.y);
}

void words(std::string& svg, const char* anchor, Point at, const std::string& markup) {
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", at.x, at.y, anchor,
                     without_tags(markup));
}

void add_axes(std::string& svg, const TradePanel& panel) {
  for (const auto& [value, label] : panel.x.ticks) {
    const double x = across(panel, value);
    line(svg, "grid", {x, frame.top}, {x, frame.bottom});
    words(svg, "middle", {x, frame.bottom + 16.0}, label);
  }
  for (const auto& [value, label] : panel.y.ticks) {
    const double y = down(panel, value);
    line(svg, "grid", {frame.left, y}, {frame.right, y});
    words(svg, "end", {frame.left - 6.0, y + 4.0}, label);
  }
  words(svg, "middle", {frame.center().x, frame.bottom + 36.0}, panel.x.label);
  words(svg, "start", {6.0, frame.top - 10.0}, panel.y.label);
}

void add_doubt(std::string& svg, const TradePanel& panel) {
  const double doubt = panel.trade->reference.uncertainty;
  if (!(doubt > 0.0)) return;
  const double y = within_frame({frame.left, down(panel, doubt)}).y;
  svg += fmt::format("<rect class=\"doubt\" x=\"{}\" y=\"{:.1f}\" width=\"{}\" height=\"{:.1f}\"/>\n",
                     frame.left, y, frame.width(), frame.bottom - y);
}

/// The errors asked for.
void add_levels(std::string& svg, const TradePanel& panel) {
  double previous = 1e9;
  for (const double error : panel.asked) {  // from large to small: downwards
    const double y = down(panel, error);
    if (y < frame.top || y > frame.bottom) continue;
    line(svg, "asked", {frame.left, y}, {frame.right, y});
    const double below = previous < 1e8 ? std::max(y, previous + 13.0) : y;
    words(svg, "start", {frame.right + 5.0, below + 4.0}, fmt::format("{:g} %", 100.0 * error));
    previous = below;
  }
}

void add_front(std::string& svg, const TradePanel& panel) {
  if (panel.front.empty()) return;
  svg += "<path class=\"front-line\" d=\"";
  for (std::size_t k = 0; k < panel.front.size(); ++k)
    svg += fmt::format("{}{:.1f} {:.1f}", k == 0 ? "M" : "L", across(panel, panel.front[k].x),
                       down(panel, panel.front[k].y));
  svg += "\"/>\n";
}

/// Of a mark at `at`: what its repeats and the uncertainty of its error span.
std::string bars(const TradeChart& chart, const TradePanel& panel, const TradeMark& mark, Point at) {
  std::string path;
  if (shows_repeats(chart, panel, mark))
    path += fmt::format("M{:.1f} 0H{:.1f}", within_frame({across(panel, mark.low), at.y}).x - at.x,
                        within_frame({across(panel, mark.high), at.y}).x - at.x);
  if (mark.uncertainty > 0.0)
    path += fmt::format("M0 {:.1f}V{:.1f}",
                        within_frame({at.x, down(panel, mark.error + mark.uncertainty)}).y - at.y,
                        within_frame({at.x, down(panel, mark.error - mark.uncertainty)}).y - at.y);
  return path.empty() ? "" : fmt::format("<path class=\"bar\" d=\"{}\"/>", path);
}

void open_mark(std::string& svg, const TradeFamily& family, std::size_t number, const char* kind, Point at,
               std::size_t run, const std::string& title) {
  const bool first_rank = std::string(kind) == " front";
  svg += fmt::format(
      "<g class=\"mark{}\" tabindex=\"{}\" role=\"img\" color=\"{}\" data-family=\"{}\" data-run=\"{}\" "
      "data-x=\"{:.1f}\" transform=\"translate({:.1f} {:.1f})\"><title>{}</title>",
      kind, first_rank ? 0 : -1, hex(family.color), number, run, at.x, at.x, at.y, title);
}

void add_mark(std::string& svg, const vv::CaseVerdict& verdict, const TradeChart& chart,
              const TradePanel& panel, const TradeMark& mark) {
  const TradeFamily& family = chart.families[mark.family];
  const vv::TradePoint& point = panel.trade->points[mark.point];
  const Point place{across(panel, mark.price), down(panel, mark.error)};
  Point at = within_frame(place);
  const bool outside = std::hypot(at.x - place.x, at.y - place.y) > 0.01;
  if (outside)
    at = {std::clamp(at.x, frame.left + edge_inset, frame.right - edge_inset),
          std::clamp(at.y, frame.top + edge_inset, frame.bottom - edge_inset)};
  open_mark(svg, family, mark.family,
            mark.of_reference ? " reference"
            : mark.on_front   ? " front"
                              : "",
            at, point.run, description(verdict, panel, point));
  if (!outside) svg += bars(chart, panel, mark, at);
  svg += fmt::format(
      "<path class=\"shape\" d=\"{}\"/></g>\n",
      outside ? arrowhead(place) : outline(family.shape, px_per_pt * trade_mark_size(chart, mark.size)));
}

void add_marks(std::string& svg, const vv::CaseVerdict& verdict, const TradeChart& chart,
               const TradePanel& panel) {
  std::vector<const TradeMark*> order;
  for (const TradeMark& mark : panel.marks) order.push_back(&mark);
  // The front on top, and small marks over large ones.
  std::stable_sort(order.begin(), order.end(), [](const TradeMark* a, const TradeMark* b) {
    return std::pair(a->on_front, a->size) < std::pair(b->on_front, b->size);
  });
  for (const TradeMark* mark : order) add_mark(svg, verdict, chart, panel, *mark);
}

/// Failures stand in the order of their families, as the row of the panel does.
void add_failures(std::string& svg, const vv::CaseVerdict& verdict, const TradeChart& chart,
                  const TradePanel& panel) {
  for (std::size_t k = 0; k < panel.failures.size(); ++k) {
    const auto [family, point] = panel.failures[k];
    const vv::TradePoint& failed = panel.trade->points[point];
    open_mark(svg, chart.families[family], family, " failed",
              {across(panel, failure_abscissa(panel.x, k, panel.failures.size())),
               down(panel, panel.failure_level)},
              failed.run, description(verdict, panel, failed));
    svg += fmt::format("<path class=\"shape\" d=\"{}\"/></g>\n", outline(MarkerShape::cross, 7.0));
  }
}

std::string panel_svg(const vv::CaseVerdict& verdict, const TradeChart& chart, const TradePanel& panel) {
  std::string svg = fmt::format(
      "<div class=\"trade-panel\"><p class=\"trade-title\">{}</p>\n<svg viewBox=\"0 0 {} {}\" role=\"group\" "
      "aria-label=\"{}: {} over {}\">\n",
      panel.title, view_width, view_height, without_tags(panel.title), without_tags(panel.y.label),
      without_tags(panel.x.label));
  add_doubt(svg, panel);
  add_axes(svg, panel);
  add_levels(svg, panel);
  svg += fmt::format("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", frame.left,
                     frame.top, frame.width(), frame.height());
  add_front(svg, panel);
  add_marks(svg, verdict, chart, panel);
  add_failures(svg, verdict, chart, panel);
  return svg + "</svg></div>\n";
}

// ---- the legend
// -------------------------------------------------------------------------------------------------

std::string sample(const std::string& inside, const char* kind, const std::string& color) {
  return fmt::format(
      "<svg viewBox=\"-14 -9 28 18\" width=\"28\" height=\"18\" aria-hidden=\"true\"><g class=\"mark{}\" "
      "color=\"{}\">{}</g></svg>",
      kind, color, inside);
}

std::string shape_sample(MarkerShape shape, double size, const char* kind, const std::string& color) {
  return sample(fmt::format("<path class=\"shape\" d=\"{}\"/>", outline(shape, size)), kind, color);
}

std::string legend(const TradeChart& chart) {
  static const std::string grey = "#6b6b6b";
  std::string html = "<div class=\"trade-legend\">\n";
  for (std::size_t k = 0; k < chart.families.size(); ++k)
    html += fmt::format("<button type=\"button\" data-family=\"{}\">{}{}</button>\n", k,
                        shape_sample(chart.families[k].shape, 9.0, " front", hex(chart.families[k].color)),
                        chart.families[k].name);
  const auto add = [&html](const std::string& picture, const std::string& text) {
    html += fmt::format("<span>{}{}</span>\n", picture, text);
  };
  for (std::size_t k = 0; k < chart.cell_sizes.size() && chart.cell_sizes.size() > 1; ++k)
    add(shape_sample(MarkerShape::circle, px_per_pt * trade_mark_size(chart, k), "", grey),
        fmt::format("<i>h</i> = {:.4g} mm", chart.cell_sizes[k] * 1e3));
  const auto any = [&chart](auto has) { return std::any_of(chart.panels.begin(), chart.panels.end(), has); };
  if (any([](const TradePanel& p) { return !p.front.empty(); }))
    add(sample("<path class=\"front-line\" d=\"M-12 -5H0V5H12\"/>", "", grey),
        "Pareto front: nothing is both better and cheaper");
  if (any([](const TradePanel& p) {
        return std::any_of(p.marks.begin(), p.marks.end(), [](const TradeMark& m) { return m.of_reference; });
      }))
    add(shape_sample(MarkerShape::circle, 9.0, " reference", grey), "a finest run, part of the reference");
  if (any([](const TradePanel& p) { return !p.failures.empty(); }))
    add(shape_sample(MarkerShape::cross, 7.0, " failed", grey), "failed; has no price");
  if (any([](const TradePanel& p) { return p.trade->reference.uncertainty > 0.0; }))
    add(sample("<rect class=\"doubt\" x=\"-12\" y=\"-6\" width=\"24\" height=\"12\"/>", "", grey),
        "within the uncertainty of the reference: cannot be told apart");
  if (any([](const TradePanel& p) { return !p.asked.empty(); }))
    add(sample("<path class=\"asked\" d=\"M-12 0H12\"/>", "", grey), "error asked for");
  return html + "</div>\n";
}

}  // namespace

std::string without_tags(const std::string& markup) {
  static const std::map<char, const char*> raised{{'0', "⁰"}, {'1', "¹"}, {'2', "²"}, {'3', "³"}, {'4', "⁴"},
                                                  {'5', "⁵"}, {'6', "⁶"}, {'7', "⁷"}, {'8', "⁸"}, {'9', "⁹"}};
  static const std::map<char, const char*> lowered{{'0', "₀"}, {'1', "₁"}, {'2', "₂"}, {'3', "₃"},
                                                   {'4', "₄"}, {'5', "₅"}, {'6', "₆"}, {'7', "₇"},
                                                   {'8', "₈"}, {'9', "₉"}};
  const std::map<char, const char*>* digits = nullptr;
  const std::string minus = "−";
  std::string text;
  for (std::size_t at = 0; at < markup.size(); ++at) {
    if (markup[at] == '<') {
      const std::size_t end = std::min(markup.find('>', at), markup.size() - 1);
      const std::string tag = markup.substr(at, end - at + 1);
      digits = tag == "<sup>"          ? &raised
               : tag == "<sub>"        ? &lowered
               : tag.starts_with("</") ? nullptr
                                       : digits;
      at = end;
    } else if (digits == &raised && markup.compare(at, minus.size(), minus) == 0) {
      text += "⁻";
      at += minus.size() - 1;
    } else if (digits && digits->count(markup[at]) > 0) {
      text += digits->at(markup[at]);
    } else {
      text += markup[at];
    }
  }
  return text;
}

std::string trade_html(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  const TradeChart chart = trade_chart_of(verdict, request);
  if (chart.panels.empty()) return "";
  std::string html = "<div class=\"trade\">\n" + legend(chart) + "<div class=\"trade-panels\">\n";
  for (const TradePanel& panel : chart.panels) html += panel_svg(verdict, chart, panel);
  return html + "</div>\n<div class=\"trade-box\" role=\"status\" hidden></div>\n</div>\n";
}

}  // namespace mpm::reports
