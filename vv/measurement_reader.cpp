#include "vv/measurement_reader.hpp"

#include <algorithm>
#include <utility>

#include "reference/bearing_capacity.hpp"
#include "vv/field_map.hpp"
#include "vv/scene_reader.hpp"
#include "vv/sweep.hpp"

namespace mpm::vv {
namespace {

std::vector<std::string> formula_names() {
  std::vector<std::string> names;
  for (const reference::CapacityFormula& formula : reference::capacity_formulas())
    names.emplace_back(formula.name);
  return names;
}

std::string dimension_of_field(const std::string& quantity) {
  const std::vector<FieldQuantity>& fields = field_catalogue();
  const auto field =
      std::find_if(fields.begin(), fields.end(), [&](const FieldQuantity& f) { return f.name == quantity; });
  return dimension_of_unit(field->unit == "-" ? "1" : field->unit);
}

std::string with_article(const std::string& dimension) { return "a " + dimension; }

/// A column by its name; the first that is not the abscissa if `place` is absent.
std::size_t read_column_choice(const JsonPlace& place, const CurveFile& file) {
  if (!place.present()) return file.abscissa && *file.abscissa == 0 ? 1 : 0;
  const std::vector<std::string> names = names_of(file.columns);
  const std::string name = place.one_of(names);
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

/// Axes of the case's sweep, each once.
std::vector<std::string> read_axes(const JsonPlace& place, const Case& read) {
  std::vector<std::string> axes;
  if (!place.present()) return axes;
  for (const JsonPlace& element : place.some_elements()) {
    const std::string axis = read_axis(element, read.sweep).parameter;
    if (contains(axes, axis)) element.refuse("each axis once", " again");
    axes.push_back(axis);
  }
  return axes;
}

/// A curve can be compared only with one of the same quantities.
void require_same_quantities(const JsonPlace& place, const CurveFile& file, std::size_t column,
                             const CurveKind& kind) {
  if (!file.abscissa) place.refuse("a curve, with an abscissa", ", a table of single measurements");
  const std::string x = file.columns[*file.abscissa].dimension, y = file.columns[column].dimension;
  if (x == kind.abscissa && y == kind.ordinate) return;
  place.refuse("the curve file of " + with_article(kind.ordinate) + " over " + with_article(kind.abscissa) +
                   ", as the runs' " + kind.name + " is",
               ", which has " + with_article(y) + " over " + with_article(x));
}

Measurement read_measurement(const JsonPlace& place, const Case& read,
                             const std::vector<std::string>& taken) {
  place.allow_only({"id", "curve_file", "column", "curve", "where", "numerical", "inputs", "within",
                    "accuracy", "reason"});
  Measurement measurement;
  measurement.id = place["id"].own_identifier(taken);
  measurement.file = read_curve_file_at(place["curve_file"], read);
  measurement.column = read_column_choice(place["column"], *measurement.file);
  const std::vector<CurveKind> kinds = curve_kinds(read);
  measurement.curve = place["curve"].one_of(names_of(kinds));
  const auto kind = std::find_if(kinds.begin(), kinds.end(),
                                 [&](const CurveKind& each) { return each.name == measurement.curve; });
  require_same_quantities(place["curve_file"], *measurement.file, measurement.column, *kind);
  measurement.where = read_where(place["where"], read.sweep);
  if (const JsonPlace numerical = place["numerical"]; numerical.present()) {
    const SweepAxis& axis = read_axis(numerical, read.sweep);
    if (!refines(axis, axis.values, read_subject(JsonPlace(&read.text, ""))))
      numerical.refuse("a parameter that makes the cell size smaller from each value to the next");
    measurement.numerical = axis.parameter;
  }
  measurement.inputs = read_axes(place["inputs"], read);
  if (const JsonPlace within = place["within"]; within.present()) {
    measurement.within = kind->abscissa == "length" ? within.quantity(QuantityKind::length) : within.number();
    if (!(measurement.within > 0.0)) within.refuse("a half-width above zero");
  }
  measurement.accuracy = place["accuracy"].number();
  if (!(measurement.accuracy > 0.0)) place["accuracy"].refuse("a number above zero");
  measurement.reason = place["reason"].text();
  return measurement;
}

/// The axis whose values are names of the table's rows.
std::string read_row_axis(const JsonPlace& place, const Case& read, const CurveFile& file) {
  const SweepAxis& axis = read_axis(place, read.sweep);
  for (const Json& value : axis.values) {
    if (file.missing || (value.is_string() && contains(file.row_names, value.get<std::string>()))) continue;
    place.refuse("an axis whose values are names of rows of " + file.id,
                 ", of which " + describe(value) + " is none");
  }
  return axis.parameter;
}

PairedPrediction read_pair(const JsonPlace& place, const Case& read, const std::vector<std::string>& metrics,
                           const std::vector<std::string>& taken) {
  place.allow_only({"id", "title", "curve_file", "column", "formula", "metric", "across", "where"});
  PairedPrediction pairs;
  pairs.id = place["id"].own_identifier(taken);
  pairs.title = place["title"].text();
  pairs.file = read_curve_file_at(place["curve_file"], read);
  pairs.column = read_column_choice(place["column"], *pairs.file);
  if (const JsonPlace formula = place["formula"]; formula.present()) {
    for (const char* key : {"metric", "across", "where"})
      if (place[key].present()) place[key].refuse("no key \"" + std::string(key) + "\" beside a formula");
    pairs.formula = formula.one_of(formula_names());
    return pairs;
  }
  pairs.metric = place["metric"].one_of(metrics);
  pairs.across = read_row_axis(place["across"], read, *pairs.file);
  pairs.where = read_where(place["where"], read.sweep);
  return pairs;
}

}  // namespace

std::vector<CurveKind> curve_kinds(const Case& read) {
  if (read.text.contains("element")) {
    std::vector<CurveKind> kinds;
    for (const char* stress : {"stress_xx", "stress_yy", "stress_zz", "stress_xy"})
      kinds.push_back({stress, "ratio", "pressure"});
    kinds.push_back({"volumetric_strain", "ratio", "ratio"});
    return kinds;
  }
  std::vector<CurveKind> kinds = {{"pressure", "length", "pressure"},
                                  {"free_surface", "length", "length"},
                                  {"failure_line", "length", "length"}};
  for (const Cut& cut : read.cuts) kinds.push_back({cut.id, "length", dimension_of_field(cut.quantity)});
  return kinds;
}

std::vector<Cut> read_cuts(const JsonPlace& place, const Case& read) {
  std::vector<Cut> cuts;
  if (!place.present()) return cuts;
  if (read.snapshots.empty()) place.refuse("no cuts without a snapshot to cut");
  std::vector<std::string> taken = ids_of(read.probes);
  for (const CurveKind& kind : curve_kinds(read)) taken.push_back(kind.name);
  for (const JsonPlace& element : place.elements()) {
    element.allow_only({"id", "quantity", "snapshot", "along", "at"});
    Cut cut;
    cut.id = element["id"].own_identifier(taken);
    taken.push_back(cut.id);
    cut.quantity = element["quantity"].one_of(names_of(field_catalogue()));
    for (const RunRequest& run : read.runs) {
      if (run.scene.dimension != 2) element.refuse("a cut through a scene of two dimensions", in_run(run));
      if (cut.quantity.find("strain") != std::string::npos && !run.scene.sums_strain)
        element["quantity"].refuse("a scalar that the scene keeps",
                                   ", which needs sums_strain to be true" + in_run(run));
    }
    cut.snapshot = element["snapshot"].integer();
    if (cut.snapshot < 0 || cut.snapshot >= static_cast<int>(read.snapshots.size()))
      element["snapshot"].refuse("a number from 0 to " + std::to_string(read.snapshots.size() - 1) +
                                 ", counting the case's snapshots");
    cut.along = element["along"].choice<std::size_t>({{"x", 0}, {"y", 1}});
    cut.at = element["at"].quantity(QuantityKind::length);
    cuts.push_back(std::move(cut));
  }
  return cuts;
}

std::shared_ptr<const CurveFile> read_curve_file_at(const JsonPlace& place, const Case& read) {
  const std::string name = place.text();
  const bool beside = name.ends_with(".json");
  const std::filesystem::path file =
      beside ? read.file.parent_path() / name : shipped_curves() / (name + ".json");
  if (!std::filesystem::is_regular_file(file)) {
    place.refuse("the id of a curve file in reference/curves, or the name of one beside the case with .json",
                 ", and there is no file " + file.string());
  }
  return std::make_shared<const CurveFile>(read_curve_file(file));
}

std::vector<Measurement> read_measurements(const JsonPlace& place, const Case& read) {
  std::vector<Measurement> all;
  if (!place.present()) return all;
  for (const JsonPlace& element : place.elements())
    all.push_back(read_measurement(element, read, ids_of(all)));
  return all;
}

std::vector<PairedPrediction> read_pairs(const JsonPlace& place, const Case& read,
                                         const std::vector<std::string>& metrics) {
  std::vector<PairedPrediction> all;
  if (!place.present()) return all;
  for (const JsonPlace& element : place.elements())
    all.push_back(read_pair(element, read, metrics, ids_of(all)));
  return all;
}

std::vector<std::string> comparison_metric_names(const std::vector<Measurement>& measurements) {
  std::vector<std::string> names;
  for (const Measurement& measurement : measurements)
    for (const ComparisonMetric& metric : comparison_metrics())
      names.push_back(measured_prefix + measurement.id + "." + metric.name);
  return names;
}

const Measurement* measurement_of(const std::string& metric, const std::vector<Measurement>& measurements) {
  for (const Measurement& measurement : measurements)
    if (metric.starts_with(measured_prefix + measurement.id + ".")) return &measurement;
  return nullptr;
}

}  // namespace mpm::vv
