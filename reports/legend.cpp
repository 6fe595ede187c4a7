#include "reports/legend.hpp"

#include <algorithm>
#include <utility>

#include "reports/typography.hpp"

namespace mpm::reports {
namespace {

constexpr double legend_gap = 18.0;
constexpr double legend_row = 14.0;

/// Room for the sample of line, bar or marker in front of a label.
double sample_width(const LegendEntry& entry) {
  using Kind = LegendEntry::Kind;
  if (entry.kind == Kind::bar || entry.kind == Kind::band || entry.kind == Kind::whisker) return 18.0;
  if (entry.kind == Kind::tick) return 8.0;
  return entry.kind == Kind::curve && entry.look.line_width <= 0.0 ? 8.0 : 24.0;
}

double entry_width(const LegendEntry& entry) { return sample_width(entry) + 5.0 + text_width(entry.label); }

void draw_sample(Canvas& canvas, const LegendEntry& entry, double left, double middle,
                 const Rectangle& sheet) {
  const double right = left + sample_width(entry);
  using Kind = LegendEntry::Kind;
  if (entry.kind == Kind::level) {
    canvas.line({{left, middle}, {right, middle}}, entry.stroke);
  } else if (entry.kind == Kind::tick) {
    canvas.line({{(left + right) / 2, middle - 5.0}, {(left + right) / 2, middle + 5.0}}, entry.stroke);
  } else if (entry.kind == Kind::whisker) {
    draw_whisker(canvas, left, right, middle, 5.0, entry.stroke);
  } else if (entry.kind == Kind::band) {
    canvas.rectangle({left, middle - 4.0, right, middle + 4.0}, entry.look.color);
  } else if (entry.kind == Kind::bar) {
    const Rectangle box{left, middle - 4.0, right, middle + 4.0};
    fill_bar(canvas, box, entry.look, sheet);
    canvas.line({{box.left, box.bottom}, {box.right, box.bottom}}, {entry.look.color, 0.8, {}});
  } else {
    if (entry.look.line_width > 0.0)
      canvas.line({{left, middle}, {right, middle}},
                  {entry.look.color, entry.look.line_width, entry.look.dash});
    const double center = (left + right) / 2;
    if (entry.bars)
      canvas.line({{center, middle - 5.5}, {center, middle + 5.5}}, {entry.look.color, bar_width, {}});
    canvas.marker({center, middle}, marker_of(entry.look));
  }
}

}  // namespace

void add_entry(std::vector<LegendEntry>& entries, LegendEntry entry) {
  if (entry.label.empty()) return;
  for (const LegendEntry& known : entries)
    if (known.label == entry.label) return;
  entries.push_back(std::move(entry));
}

LegendRows legend_rows(const std::vector<LegendEntry>& entries, double width) {
  LegendRows rows;
  double used = 0.0;
  for (const LegendEntry& entry : entries) {
    const double needed = entry_width(entry) + legend_gap;
    if (rows.empty() || used + needed > width + legend_gap) {
      rows.emplace_back();
      used = 0.0;
    }
    rows.back().push_back(entry);
    used += needed;
  }
  return rows;
}

double legend_height(const LegendRows& rows) { return static_cast<double>(rows.size()) * legend_row; }

Rectangle draw_legend(Canvas& canvas, const LegendRows& rows, double top) {
  const Rectangle sheet{0.0, 0.0, canvas.width(), canvas.height()};
  Rectangle covered{canvas.width(), top, 0.0, top + legend_height(rows)};
  for (std::size_t r = 0; r < rows.size(); ++r) {
    double width = -legend_gap;
    for (const LegendEntry& entry : rows[r]) width += entry_width(entry) + legend_gap;
    double left = (canvas.width() - width) / 2;
    covered.left = std::min(covered.left, left);
    covered.right = std::max(covered.right, left + width);
    const double middle = top + (static_cast<double>(r) + 0.5) * legend_row;
    for (const LegendEntry& entry : rows[r]) {
      draw_sample(canvas, entry, left, middle, sheet);
      canvas.text({left + sample_width(entry) + 5.0, middle}, entry.label,
                  text_style(Horizontal::left, Vertical::middle));
      left += entry_width(entry) + legend_gap;
    }
  }
  return covered;
}

MarkerStyle marker_of(const Look& look) {
  const Color inside = look.filled ? look.color : look.line_width > 0.0 ? white : Color{1.0, 1.0, 1.0, 0.0};
  return {look.marker, look.marker_size, inside, look.color, 0.7};
}

void fill_bar(Canvas& canvas, const Rectangle& box, const Look& look, const Rectangle& clip) {
  if (box.height() <= 0.0 || box.width() <= 0.0) return;
  using Pattern = Look::Pattern;
  canvas.rectangle(box, look.pattern == Pattern::solid   ? look.color
                        : look.pattern == Pattern::light ? tint(look.color, 0.62)
                                                         : white);
  if (look.pattern == Pattern::hatched) {
    const Rectangle cut{std::max(box.left, clip.left), std::max(box.top, clip.top),
                        std::min(box.right, clip.right), std::min(box.bottom, clip.bottom)};
    canvas.clip(cut);
    for (double x = cut.left - cut.height(); x < cut.right; x += 3.4)
      canvas.line({{x, cut.bottom}, {x + cut.height(), cut.top}}, {look.color, 0.8, {}});
    canvas.clip(clip);
  }
  canvas.line({{box.left, box.bottom}, {box.left, box.top}, {box.right, box.top}, {box.right, box.bottom}},
              {look.color, 0.8, {}});
}

void draw_whisker(Canvas& canvas, double from, double to, double y, double cap, const Stroke& stroke) {
  canvas.line({{from, y}, {to, y}}, stroke);
  for (const double x : {from, to}) canvas.line({{x, y - cap / 2}, {x, y + cap / 2}}, stroke);
}

}  // namespace mpm::reports
