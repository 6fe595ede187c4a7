#include "vv/curve_file.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

#include "vv/case_file.hpp"
#include "vv/json_reader.hpp"
#include "vv/machine.hpp"
#include "vv/record.hpp"

namespace mpm::vv {
namespace {

constexpr const char* format_name = "mpmvv-curve/1";

// ---- units
// ------------------------------------------------------------------------------------------------------

/// A unit as a number times 10^exponent of the SI unit of its dimension.
struct KnownUnit {
  std::string dimension;
  int exponent;
};

/// Units that papers use and case files do not.
constexpr struct {
  const char* symbol;
  const char* dimension;
  int exponent;
} paper_units[] = {{"1", "ratio", 0},           {"N/m^2", "pressure", 0}, {"kN/m^2", "pressure", 3},
                   {"N/m", "line load", 0},     {"kN/m", "line load", 3}, {"N/m^3", "unit weight", 0},
                   {"kN/m^3", "unit weight", 3}};

constexpr std::pair<QuantityKind, const char*> kinds[] = {{QuantityKind::length, "length"},
                                                          {QuantityKind::time, "time"},
                                                          {QuantityKind::pressure, "pressure"},
                                                          {QuantityKind::density, "density"},
                                                          {QuantityKind::acceleration, "acceleration"},
                                                          {QuantityKind::velocity, "velocity"},
                                                          {QuantityKind::angle, "angle"}};

std::optional<KnownUnit> known_unit(const std::string& symbol) {
  for (const auto& unit : paper_units)
    if (symbol == unit.symbol) return KnownUnit{unit.dimension, unit.exponent};
  for (const auto& [kind, dimension] : kinds)
    for (const Unit& unit : units_of(kind))
      if (unit.symbol == symbol) return KnownUnit{dimension, unit.exponent};
  return std::nullopt;
}

double in_si(double value, const KnownUnit& unit) {
  // Dividing by a whole power of ten is correctly rounded, multiplying by a negative one is not.
  return unit.exponent < 0 ? value / std::pow(10.0, -unit.exponent) : value * std::pow(10.0, unit.exponent);
}

// ---- parts of a file
// ----------------------------------------------------------------------------------------------------

std::string text_or_nothing(const JsonPlace& place) {
  return place.present() && !place.value().is_null() ? place.text() : "";
}

/// "not stated", "none", or a number above zero with the column's kind of unit or with "%".
StatedUncertainty read_uncertainty(const JsonPlace& place, const std::string& dimension) {
  using Kind = StatedUncertainty::Kind;
  const std::string text = place.text();
  if (text == "not stated") return {};
  if (text == "none") return {.kind = Kind::none};
  const std::string expected = "\"not stated\", \"none\", or a number above zero with a unit of " +
                               (dimension == "ratio" ? "\"1\"" : "a " + dimension) + " or with %";
  const std::size_t blank = text.find(' ');
  if (blank == std::string::npos) place.refuse(expected);
  const std::string symbol = text.substr(blank + 1);
  std::size_t read = 0;
  double number = 0.0;
  try {
    number = std::stod(text.substr(0, blank), &read);
  } catch (const std::exception&) {
    place.refuse(expected);
  }
  if (read != blank || !(number > 0.0) || !std::isfinite(number)) place.refuse(expected);
  if (symbol == "%") return {.kind = Kind::relative, .value = number / 100};
  const std::optional<KnownUnit> unit = known_unit(symbol);
  if (!unit || unit->dimension != dimension) place.refuse(expected);
  return {.kind = Kind::absolute, .value = in_si(number, *unit)};
}

CurveColumn read_column(const JsonPlace& place, const std::vector<CurveColumn>& before) {
  place.allow_only({"name", "unit", "meaning", "digitisation", "experimental"});
  CurveColumn column;
  column.name = place["name"].own_identifier(names_of(before));
  column.unit = place["unit"].text();
  column.dimension = dimension_of_unit(column.unit);
  if (column.dimension.empty())
    place["unit"].refuse("a unit such as \"mm\", \"kPa\", \"kN/m^3\", \"deg\", or \"1\" for a ratio");
  column.meaning = place["meaning"].text();
  column.digitisation = read_uncertainty(place["digitisation"], column.dimension);
  column.experimental = read_uncertainty(place["experimental"], column.dimension);
  return column;
}

void read_source(const JsonPlace& place, CurveFile& curve) {
  place.allow_only({"citation", "doi", "place", "by_way_of"});
  curve.citation = place["citation"].text();
  if (!place["doi"].present()) place["doi"].refuse("a DOI, or null where there is none");
  curve.doi = text_or_nothing(place["doi"]);
  curve.place = place["place"].text();
  curve.by_way_of = text_or_nothing(place["by_way_of"]);
}

std::vector<double> read_row(const JsonPlace& place, const std::vector<CurveColumn>& columns) {
  const std::vector<JsonPlace> cells = place.elements();
  if (cells.size() != columns.size()) {
    place.refuse("a row of " + std::to_string(columns.size()) + " numbers, one a column",
                 " with " + std::to_string(cells.size()));
  }
  std::vector<double> row;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const double value = in_si(cells[c].number(), *known_unit(columns[c].unit));
    if (!std::isfinite(value)) cells[c].refuse("a finite number");
    row.push_back(value);
  }
  return row;
}

void require_ascending(const JsonPlace& row, const CurveFile& curve) {
  if (!curve.abscissa || curve.rows.size() < 2) return;
  const double last = curve.rows.back()[*curve.abscissa],
               before = (curve.rows.end() - 2)->at(*curve.abscissa);
  const std::string& name = curve.columns[*curve.abscissa].name;
  const std::string order = "rows in which " + name + " grows from each to the next";
  if (last == before) row.refuse(order, ", with the " + name + " of the row before again");
  if (last < before) row.refuse(order, ", with less of it than the row before");
}

void read_rows(const JsonPlace& place, CurveFile& curve) {
  const std::vector<JsonPlace> rows = place["rows"].some_elements();
  for (const JsonPlace& row : rows) {
    std::vector<double> values = read_row(row, curve.columns);
    if (std::find(curve.rows.begin(), curve.rows.end(), values) != curve.rows.end())
      row.refuse("each row once", ", which is there already");
    curve.rows.push_back(std::move(values));
    require_ascending(row, curve);
  }
  if (curve.abscissa && curve.rows.size() < 2) place["rows"].refuse("at least two rows of a curve");
  if (const JsonPlace names = place["row_names"]; names.present()) {
    for (const JsonPlace& name : names.elements()) {
      if (contains(curve.row_names, name.text())) name.refuse("each name once", " again");
      curve.row_names.push_back(name.text());
    }
    if (curve.row_names.size() != curve.rows.size()) {
      names.refuse("a name for each of the " + std::to_string(curve.rows.size()) + " rows",
                   ", which has " + std::to_string(curve.row_names.size()));
    }
  }
}

void read_hash(const JsonPlace& place, CurveFile& curve, const Json& text) {
  const std::string of_values = hash_of_values(text);
  curve.hash = place.text();
  if (curve.hash != of_values) {
    place.refuse("\"" + of_values + "\", the hash of the numbers as they stand in the file",
                 ": the numbers are not those that were checked in");
  }
}

/// A slot has no numbers; everything else has numbers and their hash.
void read_numbers(const JsonPlace& place, CurveFile& curve) {
  if (!curve.missing) {
    read_rows(place, curve);
    read_hash(place["hash"], curve, place.value());
    return;
  }
  for (const char* key : {"rows", "row_names", "hash"})
    if (place[key].present())
      place[key].refuse("no " + std::string(key) + " as long as the status is \"missing\"");
}

CurveFile read_parts(const JsonPlace& place) {
  place.allow_only({"format", "id", "title", "status", "source", "origin", "columns", "abscissa", "row_names",
                    "rows", "licence", "used_for_calibration", "notes", "hash"});
  place["format"].one_of({format_name});
  CurveFile curve;
  curve.id = place["id"].identifier();
  curve.title = place["title"].text();
  curve.missing = place["status"].one_of({"present", "missing"}) == "missing";
  read_source(place["source"], curve);
  curve.origin = place["origin"].one_of({"digitised", "table", "formula", "simulated"});
  for (const JsonPlace& column : place["columns"].some_elements())
    curve.columns.push_back(read_column(column, curve.columns));
  if (curve.columns.size() < 2) place["columns"].refuse("at least two columns");
  if (const JsonPlace abscissa = place["abscissa"]; abscissa.present()) {
    const std::vector<std::string> names = names_of(curve.columns);
    const auto found = std::find(names.begin(), names.end(), abscissa.one_of(names));
    curve.abscissa = static_cast<std::size_t>(found - names.begin());
  }
  curve.licence = place["licence"].text();
  curve.used_for_calibration = place["used_for_calibration"].flag();
  if (const JsonPlace notes = place["notes"]; notes.present())
    for (const JsonPlace& note : notes.elements()) curve.notes.push_back(note.text());
  read_numbers(place, curve);
  return curve;
}

}  // namespace

double StatedUncertainty::of(double column_value) const {
  switch (kind) {
    case Kind::not_stated:
    case Kind::none:
      return 0.0;
    case Kind::absolute:
      return value;
    case Kind::relative:
      return value * std::abs(column_value);
  }
  return 0.0;
}

std::vector<double> CurveFile::column(std::size_t index) const {
  std::vector<double> values;
  for (const std::vector<double>& row : rows) values.push_back(row.at(index));
  return values;
}

std::string hash_of_values(const Json& curve_file) {
  // 5 and 5.0 are one number, so every number is written as one with a point.
  Json values = Json::array();
  for (const Json& column : curve_file.at("columns"))
    values.push_back({column.at("name"), column.at("unit")});
  values.push_back(curve_file.contains("row_names") ? curve_file.at("row_names") : Json::array());
  Json rows = Json::array();
  for (const Json& row : curve_file.at("rows")) rows.push_back(row.get<std::vector<double>>());
  values.push_back(std::move(rows));
  return hash_of(values.dump());
}

std::string dimension_of_unit(const std::string& unit) {
  const std::optional<KnownUnit> known = known_unit(unit);
  return known ? known->dimension : "";
}

double si_of_unit(const std::string& unit) { return in_si(1.0, known_unit(unit).value()); }

CurveFile parse_curve_file(const std::string& text, const std::filesystem::path& file) {
  try {
    const Json json = parse_json(text);
    CurveFile curve = read_parts(JsonPlace(&json, ""));
    if (curve.id != file.stem().string())
      throw Refusal("/id", "\"" + file.stem().string() + "\", the name of the file", "\"" + curve.id + "\"");
    curve.file = file;
    return curve;
  } catch (const Refusal& refusal) {
    throw CaseError(file.string(), refusal.pointer(), refusal.expected(), refusal.found());
  }
}

CurveFile read_curve_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) || !stream.is_open())
    throw CaseError(file.string(), "", "a readable curve file", "none");
  return parse_curve_file(std::string(std::istreambuf_iterator<char>(stream), {}), file);
}

std::filesystem::path shipped_curves() { return project_root() / "reference" / "curves"; }

}  // namespace mpm::vv
