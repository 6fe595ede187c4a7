#include "reports/field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/framed_note.hpp"
#include "reports/legend.hpp"
#include "reports/typography.hpp"

namespace mpm::reports {
namespace {

// Sizes in points.
constexpr double row_gap = 9.0;
constexpr double title_gap = 4.0;
constexpr double head_height = 15.0;
constexpr double tallest_frames = 560.0;  // of all rows together: they fit a printed page
constexpr double least_frame = 44.0;      // on either side
constexpr double least_width = 330.0;     // of the picture: room for the colour bar and the stamp
constexpr double widest_tick_label = 26.0;
constexpr double bar_thickness = 9.0;
constexpr double bar_arrow = 8.0;
constexpr double outward_tick = 2.8;
constexpr double color_bar_height = bar_thickness + tick_gap + 2 * line_height + 6.0;
constexpr double edge_room = 6.0;     // right of the last frame, for half a tick label
constexpr double view_margin = 0.02;  // of the larger side, around what must be seen
constexpr double overlap = 0.12;      // of a particle on every side: gaps narrower than a pixel do not show
constexpr double readable_frame = 110.0;     // wide enough for what a field shows
constexpr double axis_label_gap = 6.0;       // between tick labels and the label of the vertical axis
constexpr double legend_sample_room = 47.0;  // of a line beside its label, and what parts entries
constexpr double line_border = 0.9;          // white, on either side of a line over particles
constexpr int bar_slices = 256;

const Color frame_color{0.45, 0.45, 0.45, 1.0};

/// What is seen [m].
struct View {
  Range x, y;
  double width() const { return x.upper - x.lower; }
  double height() const { return y.upper - y.lower; }
  double aspect() const { return height() / width(); }
};

Range grown(const Range& range, double by) { return {range.lower - by, range.upper + by}; }

View view_of(const FieldPlot& plot) {
  const double side = std::max({plot.x.upper - plot.x.lower, plot.y.upper - plot.y.lower, 1e-12});
  return {grown(plot.x, view_margin * side), grown(plot.y, view_margin * side)};
}

/// Metres, or millimetres for a model that is small.
struct LengthUnit {
  double factor = 1.0;
  const char* name = "m";
};

LengthUnit length_unit(const View& view) {
  return std::max(view.width(), view.height()) < 0.3 ? LengthUnit{1e3, "mm"} : LengthUnit{};
}

/// Ticks and labels of one side of a frame.
std::vector<std::pair<double, std::string>> labelled_ticks(const Range& range, double factor, int wanted) {
  const Range shown{range.lower * factor, range.upper * factor};
  const Ticks ticks = linear_ticks(shown, wanted);
  const double step = ticks.major.size() > 1 ? ticks.major[1] - ticks.major[0] : shown.upper;
  std::vector<std::pair<double, std::string>> labels;
  for (const double t : ticks.major) labels.emplace_back(t, tick_label(t, step));
  return labels;
}

double widest(const std::vector<std::pair<double, std::string>>& labels) {
  double width = 0.0;
  for (const auto& [value, label] : labels) width = std::max(width, text_width(label));
  return width;
}

/// As many labelled ticks as stand side by side along `length`.
std::vector<std::pair<double, std::string>> ticks_along(const Range& range, double factor, double length) {
  for (int wanted = 5; wanted > 1; --wanted) {
    const auto labels = labelled_ticks(range, factor, wanted);
    if (static_cast<double>(labels.size()) * (widest(labels) + 9.0) <= length) return labels;
  }
  return labelled_ticks(range, factor, 1);
}

/// The panels placed on the sheet.
struct Grid {
  View view;
  std::size_t columns = 1, rows = 1;
  double frame_width = 0.0, frame_height = 0.0;
  double column_gap = widest_tick_label;
  int row_ticks = 3;                  ///< labels wanted along the vertical axis
  double left_room = 0.0;             ///< for the ticks and the label of the vertical axis
  std::vector<double> title_heights;  ///< a row
  double block_width() const {
    return left_room + static_cast<double>(columns) * (frame_width + column_gap) - column_gap;
  }
};

double title_wrap(const FieldPlot& plot, const Grid& grid, std::size_t panel) {
  // A title alone in its row may run on over its neighbours.
  const std::size_t first = panel / grid.columns * grid.columns;
  const std::size_t last = std::min(first + grid.columns, plot.panels.size());
  const bool alone =
      panel == first && std::all_of(plot.panels.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                                    plot.panels.begin() + static_cast<std::ptrdiff_t>(last),
                                    [](const FieldPanel& p) { return p.title.empty(); });
  return alone ? std::max(grid.block_width() - grid.left_room, least_width - 60.0)
               : grid.frame_width + grid.column_gap - 6.0;
}

TextStyle title_style(double wrap) {
  TextStyle style = text_style(Horizontal::left, Vertical::top, title_size);
  style.wrap_width = wrap;
  return style;
}

std::string tagged_title(const FieldPlot& plot, std::size_t panel) {
  const std::string& title = plot.panels[panel].title;
  const auto titled = std::count_if(plot.panels.begin(), plot.panels.end(),
                                    [](const FieldPanel& p) { return !p.title.empty(); });
  if (title.empty() || titled < 2) return title;
  const auto number =
      std::count_if(plot.panels.begin(), plot.panels.begin() + static_cast<std::ptrdiff_t>(panel),
                    [](const FieldPanel& p) { return !p.title.empty(); });
  return fmt::format("<b>({})</b> {}", static_cast<char>('a' + number % 26), title);
}

/// Frames as large as the width and a printed page allow; a model flatter or slimmer than the least frame is
/// seen with more room around it.
Grid grid_of(const FieldPlot& plot, std::size_t columns) {
  Grid grid;
  grid.view = view_of(plot);
  grid.columns = columns;
  grid.rows = std::max<std::size_t>(1, (plot.panels.size() + columns - 1) / columns);
  const LengthUnit unit = length_unit(grid.view);
  const auto count = static_cast<double>(columns);
  const double tallest = tallest_frames / static_cast<double>(grid.rows);
  // The labels take room from the frames whose height decides how many there are: a guess of it will do.
  const double height_guess = std::min(tallest, plot.width / (count + 0.3) * grid.view.aspect());
  grid.row_ticks = std::clamp(static_cast<int>(height_guess / 26.0), 1, 5);
  grid.left_room = line_height + axis_label_gap + outward_tick + 2.0 +
                   widest(labelled_ticks(grid.view.y, unit.factor, grid.row_ticks));
  const double free_width =
      plot.width - 2 * outer_margin - edge_room - grid.left_room - (count - 1.0) * grid.column_gap;
  grid.frame_width = std::max(least_frame, std::min(free_width / count, tallest / grid.view.aspect()));
  grid.frame_height = std::max(least_frame, std::min(tallest, grid.frame_width * grid.view.aspect()));
  const double scale = std::min(grid.frame_width / grid.view.width(), grid.frame_height / grid.view.height());
  grid.view.x = grown(grid.view.x, (grid.frame_width / scale - grid.view.width()) / 2);
  grid.view.y = grown(grid.view.y, (grid.frame_height / scale - grid.view.height()) / 2);
  grid.title_heights.assign(grid.rows, 0.0);
  for (std::size_t i = 0; i < plot.panels.size(); ++i) {
    if (plot.panels[i].title.empty()) continue;
    const double height =
        Canvas::measure(tagged_title(plot, i), title_style(title_wrap(plot, grid, i))).height() + title_gap;
    grid.title_heights[i / columns] = std::max(grid.title_heights[i / columns], height);
  }
  return grid;
}

// ---- one panel
// ------------------------------------------------------------------------------------------------

struct Frame {
  Rectangle box;
  View view;
  double scale = 0.0;  ///< [pt/m]

  Point at(double x, double y) const {
    return {box.left + (x - view.x.lower) * scale, box.bottom - (y - view.y.lower) * scale};
  }
};

/// Whether a particle can be drawn: its centre is a place inside the frame.
bool seen(const Frame& frame, const vv::FieldMap& map, std::size_t p) {
  return frame.box.contains(frame.at(map.x[p], map.y[p]));
}

void draw_particles(Canvas& canvas, const Frame& frame, const vv::FieldMap& map, const ColorScale& scale,
                    Layout::Panel& layout) {
  const double span = scale.range.upper - scale.range.lower;
  canvas.clip(frame.box);
  for (std::size_t p = 0; p < map.value.size(); ++p) {
    const Point center = frame.at(map.x[p], map.y[p]);
    const bool placed = std::isfinite(center.x + center.y);
    layout.not_finite += !placed || !std::isfinite(map.value[p]);
    layout.outside += placed && !seen(frame, map, p);
    if (!seen(frame, map, p)) continue;
    const double half_x = map.half_x[p] * frame.scale + overlap,
                 half_y = map.half_y[p] * frame.scale + overlap;
    canvas.rectangle({center.x - half_x, center.y - half_y, center.x + half_x, center.y + half_y},
                     color_at(scale.map, (map.value[p] * scale.factor - scale.range.lower) / span));
    layout.points.push_back(center);
  }
  canvas.unclip();
}

/// A line over the particles, on a white border so that no colour hides it.
void draw_line(Canvas& canvas, const Frame& frame, const FieldLine& line) {
  std::vector<Point> path;
  for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i)
    path.push_back(frame.at(line.x[i], line.y[i]));
  canvas.clip(frame.box);
  canvas.line(path, {white, line.look.line_width + 2 * line_border, {}});
  canvas.line(path, {line.look.color, line.look.line_width, line.look.dash});
  // Marks that touch would hide the line.
  std::optional<Point> last;
  for (const Point& place : path) {
    if (last && std::hypot(place.x - last->x, place.y - last->y) < 2.5 * line.look.marker_size) continue;
    canvas.marker(place, marker_of(line.look));
    last = place;
  }
  canvas.unclip();
}

void draw_box(Canvas& canvas, const Rectangle& r, const Color& color) {
  canvas.rule({r.left, r.top}, {r.right, r.top}, axis_width, color);
  canvas.rule({r.left, r.bottom}, {r.right, r.bottom}, axis_width, color);
  canvas.rule({r.left, r.top}, {r.left, r.bottom}, axis_width, color);
  canvas.rule({r.right, r.top}, {r.right, r.bottom}, axis_width, color);
}

void draw_axes(Canvas& canvas, const Frame& frame, int row_ticks, bool x_labels, bool y_labels) {
  const LengthUnit unit = length_unit(frame.view);
  const Rectangle& box = frame.box;
  for (const auto& [value, label] : ticks_along(frame.view.x, unit.factor, box.width())) {
    const double x = frame.at(value / unit.factor, 0.0).x;
    canvas.rule({x, box.bottom}, {x, box.bottom + outward_tick}, axis_width, frame_color);
    if (x_labels)
      canvas.text({x, box.bottom + tick_gap + 8.5}, label,
                  text_style(Horizontal::center, Vertical::baseline));
  }
  const auto rows = labelled_ticks(frame.view.y, unit.factor, row_ticks);
  for (const auto& [value, label] : rows) {
    const double y = frame.at(0.0, value / unit.factor).y;
    canvas.rule({box.left, y}, {box.left - outward_tick, y}, axis_width, frame_color);
    if (y_labels)
      canvas.text({box.left - outward_tick - 2.0, y}, label, text_style(Horizontal::right, Vertical::middle));
  }
  if (x_labels)
    canvas.text({(box.left + box.right) / 2, box.bottom + tick_gap + 8.5 + line_height},
                fmt::format("<i>x</i> [{}]", unit.name), text_style(Horizontal::center, Vertical::baseline));
  if (!y_labels) return;
  TextStyle upward = text_style(Horizontal::center, Vertical::bottom);
  upward.upward = true;
  canvas.text({box.left - outward_tick - 2.0 - widest(rows) - axis_label_gap, (box.top + box.bottom) / 2},
              fmt::format("<i>y</i> [{}]", unit.name), upward);
}

// ---- the colour bar
// -------------------------------------------------------------------------------------------

std::string bar_number(double value) {
  const double size = std::abs(value);
  const int decimals = size <= 0.0 ? 0 : std::clamp(2 - static_cast<int>(std::floor(std::log10(size))), 0, 6);
  return tick_label(value, std::pow(10.0, -decimals));
}

/// Draws the bar centred at `middle` and gives the rectangle of its colours, arrows left out.
Rectangle draw_color_bar(Canvas& canvas, const ColorScale& scale, double middle, double top) {
  const std::string above = scale.above ? "largest " + bar_number(*scale.above) : "";
  const std::string below = scale.below ? "smallest " + bar_number(*scale.below) : "";
  const double beside = std::max(text_width(above), text_width(below)) + bar_arrow + 6.0;
  const double room = 2 * std::min(middle, canvas.width() - middle) - 2 * outer_margin;
  const double length = std::min(250.0, room - 2 * beside);
  const Rectangle bar{middle - length / 2, top, middle + length / 2, top + bar_thickness};
  for (int k = 0; k < bar_slices; ++k) {
    const double slice = length / bar_slices;
    canvas.rectangle({bar.left + k * slice, bar.top, bar.left + (k + 1) * slice, bar.bottom},
                     color_at(scale.map, (k + 0.5) / bar_slices));
  }
  draw_box(canvas, bar, frame_color);
  const double half = bar_thickness / 2, height = top + half;
  const auto arrow = [&](double from, double sense, double fraction, const std::string& words) {
    const std::vector<Point> corners{{from, top}, {from + sense * bar_arrow, height}, {from, bar.bottom}};
    canvas.polygon(corners, color_at(scale.map, fraction));
    canvas.line({corners[0], corners[1], corners[2]}, {frame_color, axis_width, {}});
    canvas.text({from + sense * (bar_arrow + 4.0), height}, words,
                text_style(sense > 0.0 ? Horizontal::left : Horizontal::right, Vertical::middle));
  };
  if (scale.above) arrow(bar.right, 1.0, 1.0, above);
  if (scale.below) arrow(bar.left, -1.0, 0.0, below);
  for (const auto& [value, label] : ticks_along(scale.range, 1.0, length)) {
    const double x =
        bar.left + (value - scale.range.lower) / (scale.range.upper - scale.range.lower) * length;
    canvas.rule({x, bar.bottom}, {x, bar.bottom + outward_tick}, axis_width, frame_color);
    canvas.text({x, bar.bottom + tick_gap + 8.5}, label, text_style(Horizontal::center, Vertical::baseline));
  }
  canvas.text({middle, bar.bottom + tick_gap + 8.5 + line_height + 1.0}, scale.label,
              text_style(Horizontal::center, Vertical::baseline));
  return bar;
}

// ---- the sheet
// ------------------------------------------------------------------------------------------------

/// Where everything stands.
struct Sheet {
  Grid grid;
  std::vector<Frame> frames;
  std::vector<std::string> frame_notes;          ///< as it stands in the frame, one a panel
  std::vector<std::string> notes;                ///< under the picture
  double width = 0.0, left = 0.0, middle = 0.0;  ///< left and middle of the frames
  double bar_top = 0.0, legend_top = 0.0, notes_top = 0.0, height = 0.0;
  LegendRows legend;
  bool has_bar = false;
};

/// Stands the frames and gives the lower edge of the last row.
double place_frames(Sheet& sheet, const FieldPlot& plot) {
  const Grid& grid = sheet.grid;
  double top = outer_margin + (plot.heads.empty() ? 0.0 : head_height);
  for (std::size_t i = 0; i < plot.panels.size(); ++i) {
    const std::size_t row = i / grid.columns, column = i % grid.columns;
    if (column == 0) top += grid.title_heights[row] + (row > 0 ? grid.frame_height + row_gap : 0.0);
    const double x = sheet.left + static_cast<double>(column) * (grid.frame_width + grid.column_gap);
    sheet.frames.push_back({{x, top, x + grid.frame_width, top + grid.frame_height},
                            grid.view,
                            grid.frame_width / grid.view.width()});
  }
  return top + grid.frame_height;
}

/// What is said in the frames without a map; what does not fit there is said under the picture.
void place_frame_notes(Sheet& sheet, const FieldPlot& plot) {
  std::vector<std::string> moved;
  for (std::size_t i = 0; i < plot.panels.size(); ++i) {
    const std::string& note = plot.panels[i].note;
    sheet.frame_notes.push_back(note);
    if (plot.panels[i].map || fits_in_frame(sheet.frames[i].box, note)) continue;
    auto same = std::find(moved.begin(), moved.end(), note);
    if (same == moved.end()) same = moved.insert(moved.end(), note);
    sheet.frame_notes.back() = fmt::format("note {}", same - moved.begin() + 1);
  }
  for (std::size_t k = 0; k < moved.size(); ++k)
    sheet.notes.push_back(fmt::format("Note {}: {}", k + 1, moved[k]));
}

/// How many particles are not seen as they should be.
void note_unseen_particles(Sheet& sheet, const FieldPlot& plot) {
  std::size_t outside = 0, not_finite = 0, all = 0;
  for (std::size_t i = 0; i < plot.panels.size(); ++i) {
    if (!plot.panels[i].map) continue;
    const vv::FieldMap& map = *plot.panels[i].map;
    all += map.value.size();
    for (std::size_t p = 0; p < map.value.size(); ++p) {
      const bool placed = std::isfinite(map.x[p]) && std::isfinite(map.y[p]);
      outside += placed && !seen(sheet.frames[i], map, p);
      not_finite += !placed || !std::isfinite(map.value[p]);
    }
  }
  if (outside > 0) sheet.notes.push_back(fmt::format("Particles outside the view: {} of {}.", outside, all));
  if (not_finite > 0)
    sheet.notes.push_back(
        fmt::format("Particles whose value (drawn black) or place (not drawn) is not finite: {} of {}.",
                    not_finite, all));
}

/// The lines by name. A label that has no room stands in a note, what is before its colon in the legend.
LegendRows legend_of(const FieldPlot& plot, double width, std::vector<std::string>& notes) {
  std::vector<LegendEntry> entries;
  const double room = width - 2 * outer_margin;
  const auto add = [&](const FieldLine& line) {
    LegendEntry entry{LegendEntry::Kind::curve, line.label, line.look, {}};
    if (text_width(line.label) + legend_sample_room > room) {
      if (std::find(notes.begin(), notes.end(), line.label) != notes.end()) return;
      notes.push_back(line.label);
      entry.label = line.label.substr(0, line.label.find(':'));
    }
    add_entry(entries, std::move(entry));
  };
  for (const FieldPanel& panel : plot.panels)
    for (const FieldLine& line : panel.lines) add(line);
  for (const FieldLine& line : plot.absent_lines) add(line);
  return legend_rows(entries, room);
}

double note_height(const std::string& note, double width) {
  return Canvas::measure(note, note_style(width - 2 * outer_margin)).height() + 1.0;
}

Sheet placed(const FieldPlot& plot) {
  Sheet sheet;
  sheet.grid = grid_of(plot, static_cast<std::size_t>(std::max(1, plot.columns)));
  const double block = sheet.grid.block_width();
  sheet.width =
      std::clamp(block + 2 * outer_margin + edge_room, std::min(least_width, plot.width), plot.width);
  sheet.left = std::max(outer_margin, (sheet.width - block) / 2) + sheet.grid.left_room;
  sheet.middle = sheet.left + (block - sheet.grid.left_room) / 2;
  sheet.bar_top = place_frames(sheet, plot) + tick_gap + 2 * line_height + 8.0;
  sheet.has_bar = std::any_of(plot.panels.begin(), plot.panels.end(),
                              [](const FieldPanel& panel) { return panel.map.has_value(); });
  place_frame_notes(sheet, plot);
  sheet.notes.insert(sheet.notes.end(), plot.notes.begin(), plot.notes.end());
  note_unseen_particles(sheet, plot);
  sheet.legend = legend_of(plot, sheet.width, sheet.notes);
  sheet.legend_top = sheet.bar_top + (sheet.has_bar ? color_bar_height : 0.0);
  sheet.notes_top = sheet.legend_top + (sheet.legend.empty() ? 0.0 : legend_height(sheet.legend) + 3.0);
  sheet.height = sheet.notes_top + 3.0;
  for (const std::string& note : sheet.notes) sheet.height += note_height(note, sheet.width);
  if (!plot.stamp.empty()) sheet.height += stamp_size + 7.0;
  return sheet;
}

void draw_heads(Canvas& canvas, const Sheet& sheet, const std::vector<std::string>& heads) {
  for (std::size_t c = 0; c < heads.size(); ++c) {
    const double x = heads.size() == 1 ? sheet.middle : sheet.frames[c].box.center().x;
    canvas.text({x, outer_margin + 9.0}, heads[c],
                text_style(Horizontal::center, Vertical::baseline, title_size));
  }
}

Layout::Panel draw_panel(Canvas& canvas, const Sheet& sheet, const FieldPlot& plot, std::size_t number) {
  const Grid& grid = sheet.grid;
  const Frame& frame = sheet.frames[number];
  const FieldPanel& panel = plot.panels[number];
  Layout::Panel layout;
  layout.frame = frame.box;
  canvas.text({frame.box.left, frame.box.top - grid.title_heights[number / grid.columns]},
              tagged_title(plot, number), title_style(title_wrap(plot, grid, number)));
  if (panel.map)
    draw_particles(canvas, frame, *panel.map, plot.scale, layout);
  else
    layout.annotations.push_back(write_in_frame(canvas, frame.box, sheet.frame_notes[number], panel.hatched));
  if (panel.map)
    for (const FieldLine& line : panel.lines) draw_line(canvas, frame, line);
  draw_box(canvas, frame.box, frame_color);
  draw_axes(canvas, frame, grid.row_ticks, number + grid.columns >= plot.panels.size(),
            number % grid.columns == 0);
  return layout;
}

}  // namespace

int best_columns(const FieldPlot& plot) {
  const std::size_t panels = plot.panels.size();
  std::size_t largest = 1, flattest = 0;
  double area = 0.0;
  for (std::size_t columns = 1; columns <= std::min<std::size_t>(4, panels); ++columns) {
    const Grid grid = grid_of(plot, columns);
    if (grid.frame_width * grid.frame_height > area) {
      area = grid.frame_width * grid.frame_height;
      largest = columns;
    }
    const std::size_t empty_places = grid.rows * columns - panels;
    if (grid.frame_width >= readable_frame && empty_places <= 1) flattest = columns;
  }
  return static_cast<int>(flattest > 0 ? flattest : largest);
}

Picture draw(const FieldPlot& plot, double pixels_per_point) {
  const Sheet sheet = placed(plot);
  Picture picture{Canvas(sheet.width, sheet.height, pixels_per_point), {}};
  Canvas& canvas = picture.canvas;
  for (std::size_t i = 0; i < plot.panels.size(); ++i)
    picture.layout.panels.push_back(draw_panel(canvas, sheet, plot, i));
  draw_heads(canvas, sheet, plot.heads);
  if (sheet.has_bar) picture.layout.legend = draw_color_bar(canvas, plot.scale, sheet.middle, sheet.bar_top);
  if (!sheet.legend.empty()) draw_legend(canvas, sheet.legend, sheet.legend_top);
  double top = sheet.notes_top;
  for (const std::string& note : sheet.notes) {
    canvas.text({outer_margin, top}, note, note_style(sheet.width - 2 * outer_margin));
    top += note_height(note, sheet.width);
  }
  canvas.text({sheet.width - outer_margin, canvas.height() - 4.0}, plot.stamp,
              text_style(Horizontal::right, Vertical::baseline, stamp_size, stamp_color));
  return picture;
}

}  // namespace mpm::reports
