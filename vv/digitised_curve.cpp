#include "vv/digitised_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <vector>

#include "vv/curve_file.hpp"
#include "vv/json_reader.hpp"

namespace mpm::vv {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* to_fill_in = "fill in";

/// A column of the curve: one axis of the figure.
struct Column {
  const PictureAxis* axis = nullptr;
  std::string unit;
  double AxisPair::*part = nullptr;
};

std::vector<Column> columns_of(const DigitiseRequest& request, const CurveLabels& labels) {
  std::vector<Column> columns = {{&request.abscissa, labels.abscissa_unit, &AxisPair::abscissa},
                                 {&request.ordinate, labels.ordinate_unit, &AxisPair::ordinate}};
  if (request.ordinate.name == labels.first_column) std::swap(columns[0], columns[1]);
  return columns;
}

/// The power of ten above which digits of a number with this uncertainty tell something: two beyond its
/// first.
int last_digit(double uncertainty) { return static_cast<int>(std::floor(std::log10(uncertainty))) - 2; }

/// To the digits that mean something, as the decimal number that a person would write.
double rounded(double value, double uncertainty) {
  return std::stod(fmt::format("{:.{}f}", value, std::max(0, -last_digit(uncertainty))));
}

Json rows_of(const DigitisedSeries& series, const std::vector<Column>& columns) {
  Json rows = Json::array();
  for (const DigitisedPoint& point : series.points) {
    Json row = Json::array();
    for (const Column& column : columns) {
      const double value = point.value.*column.part;
      const double scale = column.axis->scale == AxisScale::linear ? 1.0 : value;
      row.push_back(rounded(value, series.uncertainty.*column.part * scale));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void check_ascending(const Json& rows, std::size_t abscissa, const DigitisedSeries& series,
                     const std::string& name) {
  for (std::size_t i = 0; i + 1 < rows.size(); ++i)
    if (!(rows[i][abscissa] < rows[i + 1][abscissa]))
      throw DigitiseError(fmt::format(
          "series \"{}\": two points have the {} {}, near {:.0f}, {:.0f} px; a curve has one value at "
          "each, so leave one out with --except",
          series.name, name, rows[i][abscissa].dump(), series.points[i].place.x, series.points[i].place.y));
}

/// How an axis was read: `settlement: linear, 0 mm at 112, 640 px and 25 mm at 530, 640 px`.
std::string axis_note(const Column& column) {
  const auto& [first, second] = column.axis->points;
  return fmt::format("Axis {}: {}, {:g} {} at {:g}, {:g} px and {:g} {} at {:g}, {:g} px.", column.axis->name,
                     column.axis->scale == AxisScale::linear ? "linear" : "logarithmic", first.value,
                     column.unit, first.place.x, first.place.y, second.value, column.unit, second.place.x,
                     second.place.y);
}

std::string drawing_note(const DigitisedSeries& series, const DigitiseRequest& request) {
  const auto found = std::find_if(request.series.begin(), request.series.end(),
                                  [&](const SeriesRequest& each) { return each.name == series.name; });
  const std::string colour = found == request.series.end() ? "" : " of colour " + text_of(found->colour);
  if (found != request.series.end() && found->drawing != Drawing::line)
    return fmt::format("Centres of {} markers{}, {:.1f} px large.", series.points.size(), colour,
                       series.thickness);
  return fmt::format("{} points evenly along a line{}, {:.1f} px thick.", series.points.size(), colour,
                     series.thickness);
}

std::string uncertainty_note(const DigitisedSeries& series, const DigitiseRequest& request) {
  return fmt::format(
      "Digitisation uncertainty, one standard deviation in either direction: the axes' points to {:g} px, "
      "which "
      "shifts and stretches the whole curve, and {:.2f} px for each point.",
      request.click_uncertainty, series.picking);
}

Json notes_of(const DigitisedSeries& series, const DigitiseRequest& request, const CurveLabels& labels,
              const std::vector<Column>& columns) {
  Json notes = Json::array();
  notes.push_back(fmt::format("Read off {} by {}.", labels.picture, labels.program));
  for (const Column& column : columns) notes.push_back(axis_note(column));
  notes.push_back(drawing_note(series, request));
  notes.push_back(uncertainty_note(series, request));
  return notes;
}

Json column_json(const Column& column, const DigitisedSeries& series) {
  return {
      {"name", column.axis->name},
      {"unit", column.unit},
      {"meaning", fmt::format("{}: what the {} is", to_fill_in, column.axis->name)},
      {"digitisation", uncertainty_text(series.uncertainty.*column.part, column.axis->scale, column.unit)},
      {"experimental", "not stated"}};
}

/// Keeps what a slot says of a column beside its unit and digitisation.
void keep_column(Json& column, const Json& slot) {
  const std::string unit = slot.at("unit"), found = column.at("unit");
  if (dimension_of_unit(unit) != dimension_of_unit(found))
    throw DigitiseError(
        fmt::format("the curve's column {} is in {}, the figure's axis in {}: not the same kind",
                    std::string(slot.at("name")), unit, found));
  for (const char* key : {"meaning", "experimental"}) column[key] = slot.at(key);
}

/// Keeps what a slot says, and orders the columns as it does.
void keep(Json& curve, const Json& slot, const CurveLabels& labels) {
  if (!labels.citation.empty() && slot.at("source").at("citation") != labels.citation)
    throw DigitiseError(fmt::format("curve {} is one of {}, not of {}", labels.id,
                                    std::string(slot.at("source").at("citation")), labels.citation));
  for (std::size_t i = 0; i < 2; ++i) keep_column(curve["columns"][i], slot.at("columns").at(i));
  for (const char* key : {"title", "source", "licence", "used_for_calibration"}) curve[key] = slot.at(key);
  if (slot.at("status") != "missing" || !slot.contains("notes")) return;
  Json notes = slot.at("notes");
  notes.insert(notes.end(), curve["notes"].begin(), curve["notes"].end());
  curve["notes"] = std::move(notes);
}

/// On one line, with blanks.
std::string one_line(const Json& value) {
  static const std::regex line_break("\n *");  // those in strings are escaped
  return std::regex_replace(value.dump(1), line_break, " ");
}

/// As a person would set it out: an entry of a list a line.
std::string laid_out(const Json& curve) {
  std::string text;
  for (const auto& [key, value] : curve.items()) {
    text += fmt::format("{}  {}: ", text.empty() ? "{\n" : ",\n", Json(key).dump());
    if (!value.is_array() || value.empty()) {
      text += one_line(value);
      continue;
    }
    std::string list;
    for (const Json& entry : value) list += (list.empty() ? "[\n    " : ",\n    ") + one_line(entry);
    text += list + "\n  ]";
  }
  return text + "\n}\n";
}

}  // namespace

std::string uncertainty_text(double uncertainty, AxisScale scale, const std::string& unit) {
  const double shown = scale == AxisScale::linear ? uncertainty : 100.0 * uncertainty;
  const int digit = last_digit(shown) + 1;
  const double step = std::pow(10.0, digit);
  return fmt::format("{:.{}f} {}", std::ceil(shown / step * (1.0 - 1e-12)) * step, std::max(0, -digit),
                     scale == AxisScale::linear ? unit : "%");
}

std::string curve_text(const DigitisedSeries& series, const DigitiseRequest& request,
                       const CurveLabels& labels, const std::optional<Json>& slot) {
  CurveLabels ordered = labels;
  if (slot) ordered.first_column = slot->at("columns").at(0).at("name");
  const std::vector<Column> columns = columns_of(request, ordered);
  if (slot) {
    const Json& kept = slot->at("columns");
    if (kept.size() != 2 || kept[0].at("name") != columns[0].axis->name ||
        kept[1].at("name") != columns[1].axis->name) {
      std::vector<std::string> names;
      for (const Json& column : kept) names.push_back(column.at("name"));
      throw DigitiseError(fmt::format("curve {} has the columns {}, the figure's axes are {} and {}",
                                      labels.id, listed(names), columns[0].axis->name,
                                      columns[1].axis->name));
    }
  }
  Json curve = {{"format", "mpmvv-curve/1"},
                {"id", labels.id},
                {"title", fmt::format("{}, read off {} of {}", series.name, labels.place, labels.citation)},
                {"status", "present"},
                {"source",
                 {{"citation", labels.citation},
                  {"doi", labels.doi.empty() ? Json() : Json(labels.doi)},
                  {"place", labels.place}}},
                {"origin", "digitised"},
                {"columns", Json::array({column_json(columns[0], series), column_json(columns[1], series)})},
                {"abscissa", request.abscissa.name},
                {"rows", rows_of(series, columns)},
                {"licence", to_fill_in},
                {"used_for_calibration", false},
                {"notes", notes_of(series, request, labels, columns)}};
  check_ascending(curve["rows"], columns[0].axis == &request.abscissa ? 0 : 1, series, request.abscissa.name);
  if (slot) keep(curve, *slot, labels);
  curve["hash"] = hash_of_values(curve);
  return laid_out(curve);
}

}  // namespace mpm::vv
