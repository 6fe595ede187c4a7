#include "reports/row_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/legend.hpp"
#include "reports/typography.hpp"

namespace mpm::reports {
namespace {

// Sizes in points.
constexpr double bar_slot = 10.0;  // of one bar in its row
constexpr double bar_height = 7.5;
constexpr double row_padding = 4.0;  // between the bars of two rows
constexpr double panel_gap = 14.0;
constexpr double title_room = 17.0;
constexpr double value_gap = 3.5;  // between a value and the frame

const Color grid_color{0.905, 0.905, 0.905, 1.0};
const Stroke mark_stroke{ink, 2.0, {}};
const Stroke whisker_stroke{ink, 0.8, {}};

double row_height(const Row& row) {
  return static_cast<double>(std::max<std::size_t>(1, row.bars.size())) * bar_slot + row_padding;
}

double rows_height(const RowPanel& panel) {
  double height = row_padding;
  for (const Row& row : panel.rows) height += row_height(row);
  return height;
}

double axis_room(const RowPanel& panel) {
  return tick_gap + line_height + (panel.x.label.empty() ? 0.0 : line_height + 2.0);
}

std::string value_text(const RowPanel& panel, const RowBar& bar) {
  if (!bar.text.empty()) return bar.text;
  return std::isfinite(bar.value) ? fmt::format("{:.{}f}", bar.value, panel.decimals) : "–";
}

/// A panel and where it stands.
struct Placed {
  const RowPanel* panel;
  const RowChart* chart;
  Rectangle frame;

  double at(double value) const {
    const auto [lower, upper] = panel->x.range;
    return frame.left + (value - lower) / (upper - lower) * frame.width();
  }
};

void draw_axis(Canvas& canvas, const Placed& placed) {
  const Rectangle& f = placed.frame;
  const Ticks ticks =
      linear_ticks(placed.panel->x.range, std::clamp(static_cast<int>(f.width() / 35.0), 3, 7));
  const double step = ticks.major.size() > 1 ? ticks.major[1] - ticks.major[0] : 1.0;
  for (const double value : ticks.major) {
    const double x = placed.at(value);
    canvas.rule({x, f.top}, {x, f.bottom}, 0.5, grid_color);
    canvas.rule({x, f.bottom}, {x, f.bottom - major_tick}, axis_width, ink);
    canvas.text({x, f.bottom + tick_gap + 8.0}, tick_label(value, step),
                text_style(Horizontal::center, Vertical::baseline));
  }
  canvas.text({f.center().x, f.bottom + tick_gap + line_height + 10.0}, placed.panel->x.label,
              text_style(Horizontal::center, Vertical::baseline));
}

void draw_outline(Canvas& canvas, const Rectangle& f) {
  canvas.rule({f.left, f.top}, {f.right, f.top}, axis_width, ink);
  canvas.rule({f.left, f.bottom}, {f.right, f.bottom}, axis_width, ink);
  canvas.rule({f.left, f.top}, {f.left, f.bottom}, axis_width, ink);
  canvas.rule({f.right, f.top}, {f.right, f.bottom}, axis_width, ink);
}

void draw_bar(Canvas& canvas, const Placed& placed, const RowBar& bar, double middle, Layout::Panel& layout) {
  const Rectangle& f = placed.frame;
  const std::string text = value_text(*placed.panel, bar);
  if (std::isfinite(bar.value)) {
    const double zero = std::clamp(placed.at(0.0), f.left, f.right),
                 end = std::clamp(placed.at(bar.value), f.left, f.right);
    const Rectangle box{std::min(zero, end), middle - bar_height / 2, std::max(zero, end),
                        middle + bar_height / 2};
    layout.outside += placed.at(bar.value) > f.right + 0.01;
    canvas.clip(f);
    fill_bar(canvas, box, placed.chart->series[bar.series].look, f);
    canvas.line({{box.right, box.bottom}, {box.left, box.bottom}},
                {placed.chart->series[bar.series].look.color, 0.8, {}});
    if (std::isfinite(bar.low + bar.high))
      draw_whisker(canvas, placed.at(bar.low), placed.at(bar.high), middle, 5.0, whisker_stroke);
    canvas.unclip();
    layout.points.push_back({end, middle});
  } else {
    ++layout.not_finite;
  }
  if (std::isfinite(bar.mark)) {
    const double x = placed.at(bar.mark);
    canvas.clip(f);
    canvas.line({{x, middle - bar_slot / 2}, {x, middle + bar_slot / 2}}, mark_stroke);
    canvas.unclip();
  }
  // All values stand in one column: behind a bar, one could be taken for that of a mark.
  const double right = f.right - value_gap, left = right - text_width(text);
  canvas.rectangle({left - 1.0, middle - 4.5, right + 1.0, middle + 4.5}, white);
  canvas.text({right, middle}, text, text_style(Horizontal::right, Vertical::middle));
  layout.annotations.push_back({left, middle - 4.5, right, middle + 4.5});
}

Layout::Panel draw_panel(Canvas& canvas, const Placed& placed, const std::string& tag) {
  const Rectangle& f = placed.frame;
  Layout::Panel layout;
  layout.frame = f;
  draw_axis(canvas, placed);
  const auto draw_lines = [&](bool above) {
    for (const RowLine& line : placed.panel->lines)
      if (line.above == above)
        canvas.line({{placed.at(line.value), f.top}, {placed.at(line.value), f.bottom}}, line.stroke);
  };
  draw_lines(false);
  double top = f.top + row_padding;
  for (const Row& row : placed.panel->rows) {
    const double height = row_height(row) - row_padding;
    canvas.text({f.left - tick_gap, top + height / 2}, row.name,
                text_style(Horizontal::right, Vertical::middle));
    for (std::size_t b = 0; b < row.bars.size(); ++b)
      draw_bar(canvas, placed, row.bars[b], top + (static_cast<double>(b) + 0.5) * bar_slot, layout);
    top += row_height(row);
  }
  draw_lines(true);
  draw_outline(canvas, f);
  canvas.text({outer_margin, f.top - 6.5}, tag + placed.panel->title,
              text_style(Horizontal::left, Vertical::baseline, title_size));
  return layout;
}

template <class Has>
bool any_bar(const RowChart& chart, Has has) {
  for (const RowPanel& panel : chart.panels)
    for (const Row& row : panel.rows)
      if (std::any_of(row.bars.begin(), row.bars.end(), has)) return true;
  return false;
}

std::vector<LegendEntry> legend_of(const RowChart& chart) {
  using Kind = LegendEntry::Kind;
  std::vector<LegendEntry> entries;
  for (std::size_t s = 0; s < chart.series.size(); ++s)
    if (any_bar(chart, [s](const RowBar& bar) { return bar.series == s; }))
      add_entry(entries, {Kind::bar, chart.series[s].label, chart.series[s].look, {}});
  if (any_bar(chart, [](const RowBar& bar) { return std::isfinite(bar.mark); }))
    add_entry(entries, {Kind::tick, chart.mark_legend, {}, mark_stroke});
  if (any_bar(chart, [](const RowBar& bar) { return std::isfinite(bar.low + bar.high); }))
    add_entry(entries, {Kind::whisker, chart.spread_legend, {}, whisker_stroke});
  for (const RowPanel& panel : chart.panels)
    for (const RowLine& line : panel.lines) add_entry(entries, {Kind::level, line.legend, {}, line.stroke});
  return entries;
}

}  // namespace

Picture draw(const RowChart& chart, double pixels_per_point) {
  double names = 0.0;
  for (const RowPanel& panel : chart.panels)
    for (const Row& row : panel.rows) names = std::max(names, text_width(row.name));
  const double left = outer_margin + names + tick_gap;
  const double right = std::max(left + 60.0, chart.width - outer_margin - 1.0);
  std::vector<Placed> placed;
  double top = outer_margin;
  for (const RowPanel& panel : chart.panels) {
    top += title_room;
    placed.push_back({&panel, &chart, {left, top, right, top + rows_height(panel)}});
    top += rows_height(panel) + axis_room(panel) + panel_gap;
  }
  const LegendRows legend = legend_rows(legend_of(chart), chart.width - 2 * outer_margin);
  const double legend_top = top - 6.0;
  if (!legend.empty()) top = legend_top + legend_height(legend) + 6.0;
  if (!chart.stamp.empty()) top += stamp_size + 3.0;

  Picture picture{Canvas(chart.width, top + 2.0, pixels_per_point), {}};
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const std::string tag =
        placed.size() > 1 ? fmt::format("<b>({})</b> ", static_cast<char>('a' + i % 26)) : "";
    picture.layout.panels.push_back(draw_panel(picture.canvas, placed[i], tag));
  }
  if (!legend.empty()) picture.layout.legend = draw_legend(picture.canvas, legend, legend_top);
  picture.canvas.text({chart.width - outer_margin, picture.canvas.height() - 4.0}, chart.stamp,
                      text_style(Horizontal::right, Vertical::baseline, stamp_size, stamp_color));
  return picture;
}

}  // namespace mpm::reports
