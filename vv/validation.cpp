#include "vv/validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "reference/bearing_capacity.hpp"
#include "vv/curves.hpp"
#include "vv/run_groups.hpp"

namespace mpm::vv {
namespace {

// ---- curves
// ------------------------------------------------------------------------------------------------------

std::vector<const Curve*> curves_of(const CaseVerdict& verdict, const std::vector<std::size_t>& runs,
                                    const std::string& name) {
  std::vector<const Curve*> curves;
  for (const std::size_t run : runs) curves.push_back(find_curve(verdict.runs[run].curves, name, "run"));
  return curves;
}

/// The runs that differ from this one along an axis only.
std::vector<std::size_t> relatives(const Case& definition, std::size_t run, const std::string& axis) {
  for (const RunGroup& group : groups_across(definition, selected_runs(definition, {}), axis))
    if (std::find(group.runs.begin(), group.runs.end(), run) != group.runs.end()) return group.runs;
  return {};
}

ComparedCurves gathered(const CaseVerdict& verdict, const Measurement& measurement, std::size_t run) {
  const Case& definition = verdict.definition;
  ComparedCurves curves;
  curves.within = measurement.within;
  curves.simulated = find_curve(verdict.runs[run].curves, measurement.curve, "run");
  if (!measurement.numerical.empty()) {
    const std::vector<std::size_t> levels = relatives(definition, run, measurement.numerical);
    curves.refined = curves_of(verdict, levels, measurement.curve);
    for (const std::size_t level : levels) curves.cell_size.push_back(definition.runs[level].scene.cell_size);
  }
  for (const std::string& input : measurement.inputs)
    curves.inputs.push_back(curves_of(verdict, relatives(definition, run, input), measurement.curve));
  return curves;
}

bool compared(Agreement agreement) {
  return agreement != Agreement::no_measurement && agreement != Agreement::not_compared;
}

void keep_metrics(const CurveComparison& comparison, RunVerdict& run) {
  for (const ComparisonMetric& metric : comparison_metrics()) {
    const double value = metric.value(comparison);
    if (std::isfinite(value))
      run.metrics[measured_prefix + comparison.measurement + "." + metric.name] = value;
  }
}

// ---- pairs
// -------------------------------------------------------------------------------------------------------

/// The value of a column that the formula needs, in the unit it needs it in.
double needed(const CurveFile& file, std::size_t row, const std::string& name) {
  for (std::size_t c = 0; c < file.columns.size(); ++c)
    if (file.columns[c].name == name) return file.rows[row][c];
  throw std::invalid_argument("the table has no column " + name);
}

double predicted(const std::string& formula, const CurveFile& file, std::size_t row) {
  for (const reference::CapacityFormula& each : reference::capacity_formulas()) {
    if (formula != each.name) continue;
    return each.pressure({.width = needed(file, row, "width"),
                          .depth = needed(file, row, "depth"),
                          .unit_weight = needed(file, row, "unit_weight"),
                          .friction_angle = needed(file, row, "friction_angle") * std::numbers::pi / 180});
  }
  throw std::invalid_argument("there is no formula " + formula);
}

std::string name_of_row(const CurveFile& file, std::size_t row) {
  return file.row_names.empty() ? fmt::format("row {}", row + 1) : file.row_names[row];
}

void predict_by_formula(const PairedPrediction& request, PairsVerdict& found) {
  const CurveFile& file = *request.file;
  for (std::size_t row = 0; row < file.rows.size(); ++row)
    found.pairs.push_back(
        {name_of_row(file, row), file.rows[row][request.column], predicted(request.formula, file, row)});
}

void predict_by_runs(const PairedPrediction& request, const CaseVerdict& verdict, PairsVerdict& found) {
  const CurveFile& file = *request.file;
  for (const std::size_t index : selected_runs(verdict.definition, request.where)) {
    const RunVerdict& run = verdict.runs[index];
    const std::string name = value_of(run.parameters, request.across)->get<std::string>();
    const auto row = std::find(file.row_names.begin(), file.row_names.end(), name) - file.row_names.begin();
    const auto metric = run.metrics.find(request.metric);
    if (metric != run.metrics.end()) {
      found.pairs.push_back({name, file.rows[static_cast<std::size_t>(row)][request.column], metric->second});
    } else {
      const std::string why =
          run.record.completed() ? request.metric + " was not measured" : ending_of(run.record);
      found.unpredicted.push_back(scope_of(run.parameters) + ": " + why);
    }
  }
}

/// The relative standard uncertainty of one measurement, as far as the file states any; the mean of absolute
/// ones.
double relative_uncertainty(const CurveFile& file, std::size_t column) {
  const CurveColumn& measured = file.columns[column];
  double sum = 0.0;
  for (const double value : file.column(column))
    sum += std::hypot(measured.digitisation.of(value), measured.experimental.of(value)) / std::abs(value);
  return sum / static_cast<double>(file.rows.size());
}

PairsVerdict judged(const PairedPrediction& request, const CaseVerdict& verdict) {
  PairsVerdict found;
  found.id = request.id;
  found.title = request.title;
  found.dimension = request.file->columns[request.column].dimension;
  if (request.file->missing) {
    found.missing = true;
    found.lack = lack_of_measurement(*request.file);
    return found;
  }
  try {
    if (request.formula.empty())
      predict_by_runs(request, verdict, found);
    else
      predict_by_formula(request, found);
    if (found.unpredicted.empty())
      found.factor = model_factor(found.pairs, relative_uncertainty(*request.file, request.column));
    else
      found.lack = found.unpredicted.front();
  } catch (const std::invalid_argument& error) {
    found.lack = error.what();
  }
  return found;
}

}  // namespace

void compare_with_measurements(CaseVerdict& verdict) {
  const Case& definition = verdict.definition;
  for (const Measurement& measurement : definition.measurements) {
    for (const std::size_t index : selected_runs(definition, measurement.where)) {
      RunVerdict& run = verdict.runs[index];
      CurveComparison found = compare(*measurement.file, measurement.column,
                                      gathered(verdict, measurement, index), measurement.accuracy);
      found.measurement = measurement.id;
      if (compared(found.agreement)) keep_metrics(found, run);
      run.comparisons.push_back(std::move(found));
    }
  }
}

std::vector<PairsVerdict> judge_pairs(const CaseVerdict& verdict) {
  std::vector<PairsVerdict> all;
  for (const PairedPrediction& request : verdict.definition.pairs) all.push_back(judged(request, verdict));
  return all;
}

}  // namespace mpm::vv
