#include "reports/stability_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "reports/figure_parts.hpp"
#include "reports/figures.hpp"
#include "reports/typography.hpp"

namespace mpm::reports {
namespace {

using Class = vv::StabilityClass;

constexpr Class all_classes[] = {Class::accurate,    Class::inaccurate, Class::drifting,
                                 Class::oscillating, Class::diverged,   Class::refused};
constexpr double patch_half_width = 0.44;  // of the distance of two columns
constexpr double least_ratio = 1.13;       // of neighbouring symbols of one class
constexpr double lone_ratio = 1.3;         // from a step to the ends of its patch where it has no neighbour
constexpr Color limit_color{0.0, 0.0, 0.0, 1.0};
constexpr Color matrix_color{0.35, 0.0, 0.45, 1.0};
constexpr Color own_color{0.0, 0.25, 0.75, 1.0};

/// A place along x.
struct Column {
  std::string name;  ///< markup
  const vv::RunVerdict* run = nullptr;
  const vv::Survey* survey = nullptr;  ///< null if the run has none
};

struct Map {
  std::string title;  ///< markup
  std::vector<Column> columns;
};

/// A value as a tick has room for it.
std::string short_name(const std::string& pointer, const vv::Json& value) {
  if (value.is_number()) return fmt::format("{:g}", value.get<double>());
  if (pointer.starts_with('/') && !value.is_string()) return name_of_parameter(pointer, value);
  return value.is_string() ? escaped(value.get<std::string>()) : escaped(value.dump());
}

std::string title_of(const Member& member, bool names_series) {
  if (!names_series || member.series.empty()) return member.panel;
  return member.panel.empty() ? member.series : member.panel + ", " + member.series;
}

std::vector<Map> maps_of(const std::vector<Member>& members, const vv::FigureRequest& request) {
  const bool has_axis = !request.map_axis.empty();
  std::vector<Map> maps;
  for (const Member& member : members) {
    const std::string title = title_of(member, has_axis || !request.series.empty());
    auto map = std::find_if(maps.begin(), maps.end(), [&](const Map& known) { return known.title == title; });
    if (map == maps.end()) map = maps.insert(maps.end(), Map{title, {}});
    const vv::Json* value = has_axis ? value_of(member.run->parameters, request.map_axis) : nullptr;
    map->columns.push_back({value ? short_name(request.map_axis, *value) : member.series, member.run,
                            member.run->record.survey ? &*member.run->record.survey : nullptr});
  }
  return maps;
}

// ---- a column
// ---------------------------------------------------------------------------------------------------

/// The patch of every point, from below to above.
std::vector<Range> patches_of(const std::vector<vv::SurveyPoint>& points) {
  std::vector<Range> patches;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double own = points[k].fraction;
    const auto half_way = [&](std::size_t neighbour) { return std::sqrt(own * points[neighbour].fraction); };
    Range patch{k > 0 ? half_way(k - 1) : 0.0, k + 1 < points.size() ? half_way(k + 1) : 0.0};
    if (patch.lower == 0.0) patch.lower = patch.upper > 0.0 ? own * own / patch.upper : own / lone_ratio;
    if (patch.upper == 0.0) patch.upper = own * own / patch.lower;
    patches.push_back(patch);
  }
  return patches;
}

/// The boundary of stability; nothing where none diverged or nothing was tried.
std::optional<double> boundary_of(const vv::Survey& survey) {
  if (survey.points.empty() || !(survey.unstable > 0.0)) return std::nullopt;
  if (survey.stable > 0.0) return std::sqrt(survey.stable * survey.unstable);
  return patches_of(survey.points).front().lower;
}

void add_patches(Panel& panel, const Column& column, double place) {
  const std::vector<vv::SurveyPoint>& points = column.survey->points;
  const std::vector<Range> patches = patches_of(points);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double left = place - patch_half_width, right = place + patch_half_width;
    const double whiteness = points[k].stability == Class::diverged ? 0.45 : 0.6;
    panel.bands.push_back({"",
                           tint(look_of_class(points[k].stability).color, whiteness),
                           {left, right},
                           {patches[k].lower, patches[k].lower},
                           {patches[k].upper, patches[k].upper}});
  }
}

/// The symbols of one class.
PlotCurve symbols_of(const Map& map, Class stability) {
  PlotCurve symbols{words_of_class(stability), look_of_class(stability), {}, {}, 2};
  for (std::size_t c = 0; c < map.columns.size(); ++c) {
    if (!map.columns[c].survey) continue;
    double last = 0.0;
    bool covers = false;
    for (const vv::SurveyPoint& point : map.columns[c].survey->points) {
      covers = covers && point.stability == stability;
      if (point.stability != stability || (covers && point.fraction < last * least_ratio)) continue;
      symbols.x.push_back(static_cast<double>(c));
      symbols.y.push_back(point.fraction);
      last = point.fraction;
      covers = true;
    }
  }
  return symbols;
}

std::optional<double> above_zero(double value) {
  return value > 0.0 && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// A level line in every column that has a value; neighbours are joined if asked for. What is not there is no
/// point that could not be drawn.
template <class Value>
void add_levels(Panel& panel, const Map& map, const std::string& label, const Look& look, bool joined,
                Value value) {
  PlotCurve line{label, look, {}, {}, 1};
  const auto finish = [&] {
    if (!line.x.empty()) panel.curves.push_back(line);
    line.x.clear();
    line.y.clear();
  };
  for (std::size_t c = 0; c < map.columns.size(); ++c) {
    const vv::Survey* survey = map.columns[c].survey;
    const std::optional<double> level = survey ? value(*survey) : std::nullopt;
    if (!level || !joined) finish();
    if (!level) continue;
    const double place = static_cast<double>(c);
    line.x.insert(line.x.end(), {place - 0.5, place + 0.5});
    line.y.insert(line.y.end(), {*level, *level});
  }
  finish();
}

Look line_of(const Color& color, double width, const std::vector<double>& dash) {
  Look look;
  look.color = color;
  look.line_width = width;
  look.dash = dash;
  return look;
}

void add_lines(Panel& panel, const Map& map) {
  add_levels(panel, map, "limit found by runs", line_of(limit_color, 1.6, {}), true, boundary_of);
  add_levels(panel, map, "limit by the matrix of one step", line_of(matrix_color, 1.4, {4.0, 2.2}), false,
             [](const vv::Survey& survey) { return above_zero(survey.linear.limit); });
  add_levels(panel, map, "time step that the scene asks for", line_of(own_color, 1.2, {1.2, 1.8}), false,
             [](const vv::Survey& survey) { return above_zero(survey.own); });
}

// ---- axes
// -------------------------------------------------------------------------------------------------------

/// Of the fractions of all maps, so that they can be compared by eye.
Axis fraction_axis(const std::vector<Map>& maps) {
  Extent extent;
  for (const Map& map : maps)
    for (const Column& column : map.columns) {
      if (!column.survey) continue;
      for (const Range& patch : patches_of(column.survey->points)) {
        extent.include(patch.lower);
        extent.include(patch.upper);
      }
      for (const double level : {column.survey->linear.limit, column.survey->own})
        if (above_zero(level)) {
          extent.include(level / 1.1);
          extent.include(level * 1.1);
        }
    }
  Axis axis;
  axis.label = "Δt c / h";  // in full it would be longer than a panel is high
  axis.scale = Scale::logarithmic;
  axis.range = extent.empty() ? Range{0.1, 3.0} : Range{extent.lower, extent.upper};
  for (int exponent = -9; exponent < 9; ++exponent)
    for (const double first : {1.0, 2.0, 5.0}) {
      const double place = first * std::pow(10.0, exponent);
      if (place >= axis.range.lower && place <= axis.range.upper)
        axis.ticks.emplace_back(place, fmt::format("{:g}", place));
    }
  // Over many decades the powers of ten are enough.
  if (axis.ticks.size() > 9) axis.ticks.clear();
  return axis;
}

/// "particles per cell" of "/scene/bodies/0/particles_per_cell/0": the last name that is no number.
std::string words_of_axis(std::string pointer) {
  while (pointer.find_last_not_of("0123456789") != std::string::npos &&
         pointer[pointer.find_last_not_of("0123456789")] == '/' && pointer.back() != '/')
    pointer.erase(pointer.find_last_not_of("0123456789"));
  return escaped(spaced(pointer.substr(pointer.rfind('/') + 1)));
}

Axis column_axis(const Map& map, const vv::FigureRequest& request) {
  Axis axis;
  axis.label = words_of_axis(request.map_axis);
  axis.range = {-0.5, std::max(0.5, static_cast<double>(map.columns.size()) - 0.5)};
  for (std::size_t c = 0; c < map.columns.size(); ++c)
    axis.ticks.emplace_back(static_cast<double>(c), map.columns[c].name);
  return axis;
}

/// Names that would run into each other become numbers, and a note tells what they stand for.
void number_crowded_columns(Panel& panel, double frame_width) {
  auto& ticks = panel.x.ticks;
  const double room = frame_width / static_cast<double>(std::max<std::size_t>(1, ticks.size())) - 3.0;
  if (std::all_of(ticks.begin(), ticks.end(),
                  [&](const auto& tick) { return text_width(tick.second) <= room; }))
    return;
  std::string key;
  for (std::size_t c = 0; c < ticks.size(); ++c) {
    const std::string number = std::to_string(c + 1);
    key += fmt::format("{}<b>{}</b>\u00a0{}", key.empty() ? "" : "; ", number, ticks[c].second);
    ticks[c].second = number;
  }
  panel.notes.insert(panel.notes.begin(), key);
}

void add_notes(Panel& panel, const Map& map) {
  for (const Column& column : map.columns) {
    const vv::Record& record = column.run->record;
    if (!column.survey) {
      const std::string reason = record.failure.empty() ? "no survey" : escaped(record.failure);
      panel.notes.push_back(fmt::format("{}: {}", column.name, reason));
    } else if (!column.survey->linear.lack.empty()) {
      panel.notes.push_back(
          fmt::format("{}: no limit by the matrix: {}", column.name, escaped(column.survey->linear.lack)));
    }
  }
}

Panel panel_of(const Map& map, const Axis& fractions, const vv::FigureRequest& request) {
  Panel panel;
  panel.title = map.title;
  panel.x = column_axis(map, request);
  panel.y = fractions;
  for (std::size_t c = 0; c < map.columns.size(); ++c)
    if (map.columns[c].survey) add_patches(panel, map.columns[c], static_cast<double>(c));
  for (const Class stability : all_classes) {
    PlotCurve symbols = symbols_of(map, stability);
    if (!symbols.x.empty()) panel.curves.push_back(std::move(symbols));
  }
  add_lines(panel, map);
  add_notes(panel, map);
  return panel;
}

}  // namespace

Look look_of_class(vv::StabilityClass stability) {
  Look look;
  look.filled = true;
  look.marker_size = 4.6;
  switch (stability) {
    case Class::accurate:
      look.color = {0.0, 0.50, 0.37, 1.0};
      look.marker = MarkerShape::circle;
      break;
    case Class::inaccurate:
      look.color = {0.78, 0.70, 0.05, 1.0};
      look.marker = MarkerShape::square;
      break;
    case Class::drifting:
      look.color = {0.25, 0.60, 0.85, 1.0};
      look.marker = MarkerShape::triangle;
      break;
    case Class::oscillating:
      look.color = {0.75, 0.40, 0.62, 1.0};
      look.marker = MarkerShape::diamond;
      break;
    case Class::diverged:
      look.color = {0.80, 0.33, 0.0, 1.0};
      look.marker = MarkerShape::cross;
      break;
    case Class::refused:
      look.color = {0.45, 0.45, 0.45, 1.0};
      look.marker = MarkerShape::square;
      look.filled = false;
      break;
  }
  return look;
}

std::string words_of_class(vv::StabilityClass stability) {
  switch (stability) {
    case Class::accurate:
      return "accurate";
    case Class::inaccurate:
      return "inaccurate";
    case Class::drifting:
      return "drifts";
    case Class::oscillating:
      return "oscillates";
    case Class::diverged:
      return "diverged";
    case Class::refused:
      return "refused";
  }
  return "unknown";
}

Plot stability_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  constexpr std::size_t many_panels = 6;
  constexpr double room_beside_frame = 52.0;  // label and ticks of the axis, and the gap to the next [pt]
  vv::FigureRequest layout = request;
  layout.over = request.map_axis;
  const std::vector<Member> members = members_of(verdict, layout);
  const std::vector<Map> maps = maps_of(members, request);
  const Axis fractions = fraction_axis(maps);
  Plot plot;
  plot.columns = maps.size() > many_panels ? 3 : maps.size() > 1 ? 2 : 1;
  const double frame_width = plot.width / plot.columns - room_beside_frame;
  for (const Map& map : maps) {
    plot.panels.push_back(panel_of(map, fractions, request));
    number_crowded_columns(plot.panels.back(), frame_width);
  }
  plot.frame_aspect = plot.columns == 1 ? 0.62 : 0.85;
  if (plot.panels.empty()) {
    Panel nothing;
    nothing.absence = "No run was selected for this figure.";
    plot.panels.push_back(nothing);
    plot.frame_aspect = 0.2;
  }
  plot.stamp = stamp_of(verdict, members);
  return plot;
}

}  // namespace mpm::reports
