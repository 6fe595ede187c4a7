#include "vv/gates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "vv/curves.hpp"
#include "vv/grid_convergence.hpp"

namespace mpm::vv {
namespace {

using Parameters = std::vector<std::pair<std::string, Json>>;

constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();
constexpr const char* completion_metric = "completed";

/// The value a gate compares or, when it is NaN, why there is none.
struct Measurement {
  double value = not_measured;
  std::string detail;
  bool ended_early = false;  ///< there is none because the solver ended the run early and said how
};

/// Runs of one series, from coarse to fine, and the parameters they share.
struct Group {
  Parameters fixed;
  std::vector<std::size_t> runs;
};

// ---- selecting ----

const Json* value_of(const Parameters& parameters, const std::string& pointer) {
  for (const auto& [name, value] : parameters) {
    if (name == pointer) return &value;
  }
  return nullptr;
}

bool selects(const std::vector<Selector>& where, const Parameters& parameters) {
  return std::all_of(where.begin(), where.end(), [&](const Selector& selector) {
    const Json* value = value_of(parameters, selector.parameter);
    return value &&
           std::find(selector.values.begin(), selector.values.end(), *value) != selector.values.end();
  });
}

std::vector<std::size_t> selected_runs(const Case& definition, const std::vector<Selector>& where) {
  std::vector<std::size_t> selected;
  for (std::size_t run = 0; run < definition.runs.size(); ++run) {
    if (selects(where, definition.runs[run].parameters)) selected.push_back(run);
  }
  return selected;
}

Parameters without(const Parameters& parameters, const std::string& pointer) {
  Parameters rest;
  for (const auto& entry : parameters) {
    if (entry.first != pointer) rest.push_back(entry);
  }
  return rest;
}

/// Groups runs that differ in one parameter only, in sweep order; runs in which it is not swept are left out.
std::vector<Group> groups_across(const Case& definition, const std::vector<std::size_t>& runs,
                                 const std::string& across) {
  std::vector<Group> groups;
  for (std::size_t run : runs) {
    const Parameters& parameters = definition.runs[run].parameters;
    if (!value_of(parameters, across)) continue;
    const Parameters fixed = without(parameters, across);
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.fixed == fixed; });
    if (group == groups.end()) group = groups.insert(groups.end(), Group{fixed, {}});
    group->runs.push_back(run);
  }
  const auto coarser = [&](std::size_t a, std::size_t b) {
    return definition.runs[a].scene.cell_size > definition.runs[b].scene.cell_size;
  };
  for (Group& group : groups) std::stable_sort(group.runs.begin(), group.runs.end(), coarser);
  return groups;
}

// ---- measuring ----

/// Why a run that completed does not have a metric that is absent.
std::string why_absent(const Case& definition, const RunVerdict& run, const std::string& metric) {
  for (const Reading& reading : definition.readings) {
    if (metric != metric_of(reading).name) continue;
    const std::string lack = read_off(reading, run.curves).lack;
    if (!lack.empty()) return "the run completed but " + lack;
  }
  return fmt::format("the run completed but {} was not measured", metric);
}

Measurement measure(const Case& definition, const RunVerdict& run, const std::string& metric) {
  const auto found = run.metrics.find(metric);
  if (found != run.metrics.end() && std::isfinite(found->second))
    return {.value = found->second, .detail = {}};
  if (!run.record.completed()) {
    return {
        .value = not_measured, .detail = ending_of(run.record), .ended_early = run.record.failure.empty()};
  }
  if (found == run.metrics.end())
    return {.value = not_measured, .detail = why_absent(definition, run, metric)};
  return {.value = not_measured,
          .detail = fmt::format("the run completed but {} is not a finite number", metric)};
}

double observed_order(double coarse_error, double fine_error, double coarse_size, double fine_size) {
  return std::log(coarse_error / fine_error) / std::log(coarse_size / fine_size);
}

/// The steps of a series, each value over the one before.
std::vector<double> ratios_of(const std::vector<double>& values) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k + 1 < values.size(); ++k) ratios.push_back(values[k + 1] / values[k]);
  return ratios;
}

/// The last in the order of `less`; not a number if any is not, where std::max_element may lose it.
template <class Less>
double extreme_of(const std::vector<double>& values, Less less) {
  if (std::any_of(values.begin(), values.end(), [](double value) { return std::isnan(value); }))
    return not_measured;
  return *std::max_element(values.begin(), values.end(), less);
}

double spread_of(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  return (*most - *least) / std::abs(mean);
}

/// Of finite values, at least two.
double statistic_of(Statistic statistic, const std::vector<double>& values,
                    const std::vector<double>& cell_size) {
  const std::size_t last = values.size() - 1;
  switch (statistic) {
    case Statistic::value:
      return values[last];
    case Statistic::reduction:
      return values[0] / values[last];
    case Statistic::worst_ratio:
      return extreme_of(ratios_of(values), std::less<>());
    case Statistic::least_ratio:
      return extreme_of(ratios_of(values), std::greater<>());
    case Statistic::spread:
      return spread_of(values);
    case Statistic::last_order:
      return observed_order(values[last - 1], values[last], cell_size[last - 1], cell_size[last]);
    case Statistic::curve_spread:
    case Statistic::discretisation_uncertainty:
    case Statistic::power_exponent:
    case Statistic::power_coefficient:
    case Statistic::bias:
    case Statistic::scatter:
    case Statistic::model_scatter:
      break;  // are more than a number of the values
  }
  return not_measured;
}

/// Adds to what a series lacks: the first run is told of, and ending early excuses all runs or none.
void add_lack(Measurement& lacking, const RunVerdict& run, const std::string& detail, bool ended_early) {
  const bool first = lacking.detail.empty();
  if (first) lacking.detail = scope_of(run.parameters) + ": " + detail;
  lacking.ended_early = ended_early && (first || lacking.ended_early);
}

/// The same where the run's curve is to blame.
void add_lack_of_curve(Measurement& lacking, const RunVerdict& run, const std::string& lack) {
  const bool completed = run.record.completed();
  add_lack(lacking, run, completed ? lack : ending_of(run.record) + ", " + lack,
           !completed && run.record.failure.empty());
}

/// How far apart the curves of a series are.
Measurement measure_curves(const Gate& gate, const std::vector<const RunVerdict*>& levels) {
  std::vector<const Curve*> curves;
  Measurement lacking;
  for (const RunVerdict* level : levels) {
    curves.push_back(find_curve(level->curves, gate.curve, "run"));
    if (!curves.back()) add_lack_of_curve(lacking, *level, "the run has no curve " + gate.curve);
  }
  if (!lacking.detail.empty()) return lacking;
  const ReadOff spread = curve_spread(curves, {gate.from, gate.up_to}, gate.within);
  if (spread.lack.empty()) return {.value = spread.value, .detail = {}};
  add_lack_of_curve(lacking, *levels[spread.of], spread.lack);
  return lacking;
}

/// How certain the finest value of a series is; the detail says how that was found.
Measurement measure_uncertainty(const std::vector<double>& values, const std::vector<double>& cell_size) {
  const std::optional<GridConvergence> convergence = grid_convergence(cell_size, values);
  if (convergence) return {.value = convergence->uncertainty, .detail = convergence->method};
  return {.value = not_measured,
          .detail =
              "it takes three levels, each with smaller cells than the one before, and a last value that is "
              "not 0"};
}

/// A statistic of a series; without a value it tells of the first run that lacks one.
Measurement measure(const Case& definition, const Gate& gate, const std::vector<const RunVerdict*>& levels,
                    const std::vector<double>& cell_size) {
  if (levels.size() < 2) {
    return {.value = not_measured,
            .detail = fmt::format("a series needs two runs, this one has {}", levels.size())};
  }
  if (gate.statistic == Statistic::curve_spread) return measure_curves(gate, levels);
  std::vector<double> values;
  Measurement lacking;
  for (const RunVerdict* level : levels) {
    const Measurement measurement = measure(definition, *level, gate.metric);
    values.push_back(measurement.value);
    if (!std::isfinite(measurement.value))
      add_lack(lacking, *level, measurement.detail, measurement.ended_early);
  }
  if (!lacking.detail.empty()) return lacking;
  if (gate.statistic == Statistic::discretisation_uncertainty) return measure_uncertainty(values, cell_size);
  const double value = statistic_of(gate.statistic, values, cell_size);
  if (std::isfinite(value)) return {.value = value, .detail = {}};
  return {.value = not_measured, .detail = "the statistic of these values is not a finite number"};
}

// ---- comparing ----

bool holds(Comparison comparison, double value, double threshold) {
  return comparison == Comparison::at_most ? value <= threshold : value >= threshold;
}

const char* name_of_statistic(Statistic statistic) {
  switch (statistic) {
    case Statistic::value:
      return "value";
    case Statistic::reduction:
      return "reduction";
    case Statistic::worst_ratio:
      return "worst_ratio";
    case Statistic::last_order:
      return "last_order";
    case Statistic::least_ratio:
      return "least_ratio";
    case Statistic::spread:
      return "spread";
    case Statistic::curve_spread:
      return "curve_spread";
    case Statistic::discretisation_uncertainty:
      return "discretisation_uncertainty";
    case Statistic::power_exponent:
      return "power_exponent";
    case Statistic::power_coefficient:
      return "power_coefficient";
    case Statistic::bias:
      return "bias";
    case Statistic::scatter:
      return "scatter";
    case Statistic::model_scatter:
      return "model_scatter";
  }
  return "value";
}

GateStatus status_of(const Gate& gate, const Measurement& measurement) {
  const bool measured = std::isfinite(measurement.value);
  const bool green = measured && holds(gate.comparison, measurement.value, gate.threshold);
  if (!gate.must_fail) return green ? GateStatus::pass : GateStatus::fail;
  if (green) return GateStatus::unexpectedly_green;
  return measured || measurement.ended_early ? GateStatus::red_as_expected : GateStatus::fail;
}

GateResult result_of(const Gate& gate, const std::string& scope, const Measurement& measurement) {
  GateResult result{.id = gate.id,
                    .metric = gate.metric.empty() ? gate.curve : gate.metric,
                    .statistic = name_of_statistic(gate.statistic),
                    .basis = gate.basis,
                    .reason = gate.reason,
                    .scope = scope,
                    .value = measurement.value,
                    .op = gate.comparison == Comparison::at_most ? "<=" : ">=",
                    .threshold = gate.threshold,
                    .must_fail = gate.must_fail,
                    .status = status_of(gate, measurement),
                    .detail = measurement.detail};
  if (result.status == GateStatus::unexpectedly_green)
    result.detail = "the control was to turn red and stayed green";
  return result;
}

// ---- runs ----

RunVerdict judged_run(const Case& definition, const RunRequest& request, Record record,
                      const Judge& judge_run) {
  RunVerdict run;
  run.parameters = request.parameters;
  if (record.failure.empty()) {
    try {
      Judgement judgement = judge_run(definition, request, record);
      run.metrics = std::move(judgement.metrics);
      run.curves = std::move(judgement.curves);
      for (const Reading& reading : definition.readings) {
        const ReadOff value = read_off(reading, run.curves);
        if (value.lack.empty()) run.metrics[metric_of(reading).name] = value.value;
      }
      if (!record.repeat_digest.empty()) {
        run.metrics["bits_differ"] = record.digest == record.repeat_digest ? 0.0 : 1.0;
      }
    } catch (const std::exception& error) {
      run.metrics.clear();
      record.failure = std::string("could not be judged: ") + error.what();
    }
  }
  run.record = std::move(record);
  return run;
}

// ---- gates ----

/// One case while its gates are applied.
class Bench {
 public:
  Bench(const Case& definition, std::vector<Record> records, const Judge& judge_run) {
    verdict_.definition = definition;
    for (std::size_t run = 0; run < records.size(); ++run) {
      verdict_.runs.push_back(
          judged_run(definition, definition.runs[run], std::move(records[run]), judge_run));
    }
    covered_.resize(records.size(), false);
    build_series();
  }

  CaseVerdict verdict() && {
    for (const Gate& gate : definition().gates) {
      const bool applied = gate.statistic == Statistic::value ? apply_to_runs(gate) : apply_to_series(gate);
      if (!applied) refuse(gate, "the gate matches no run of the sweep");
    }
    require_completion();
    if (verdict_.runs.empty()) refuse(judged_at_all(), "the case has no runs");
    if (definition().gates.empty()) refuse(judged_at_all(), "the case has no gates");
    const auto results = gate_results(verdict_);
    const bool good =
        std::all_of(results.begin(), results.end(), [](const GateResult* r) { return r->good(); });
    verdict_.status = good ? CaseStatus::pass : CaseStatus::fail;
    return std::move(verdict_);
  }

 private:
  const Case& definition() const { return verdict_.definition; }

  bool apply_to_runs(const Gate& gate) {
    const std::vector<std::size_t> runs = selected_runs(definition(), gate.where);
    for (std::size_t run : runs) {
      RunVerdict& target = verdict_.runs[run];
      target.gates.push_back(
          result_of(gate, scope_of(target.parameters), measure(definition(), target, gate.metric)));
      if (gate.must_fail || gate.metric == completion_metric) covered_[run] = true;
    }
    return !runs.empty();
  }

  bool apply_to_series(const Gate& gate) {
    const std::vector<Group> groups =
        groups_across(definition(), selected_runs(definition(), gate.where), gate.across);
    for (const Group& group : groups) {
      const Measurement measurement = measure(definition(), gate, levels_of(group), cell_sizes_of(group));
      series_of(gate.across, group.fixed)
          .gates.push_back(result_of(gate, scope_across(group, gate), measurement));
      for (std::size_t run : group.runs) covered_[run] = covered_[run] || gate.must_fail;
    }
    return !groups.empty();
  }

  void refuse(const Gate& gate, const std::string& why) {
    verdict_.gates.push_back(result_of(gate, "the case", {.value = not_measured, .detail = why}));
  }

  static Gate judged_at_all() {
    Gate gate;
    gate.id = "judged";
    gate.metric = "judged";
    gate.comparison = Comparison::at_least;
    gate.threshold = 1.0;
    gate.basis = "requirement";
    gate.reason = "what was not judged has not passed";
    return gate;
  }

  /// A run that ended early is silent about everything else: unless someone expects it, that is a failure.
  void require_completion() {
    Gate gate;
    gate.id = "run_completed";
    gate.metric = completion_metric;
    gate.comparison = Comparison::at_least;
    gate.threshold = 1.0;
    gate.basis = "requirement";
    gate.reason = "a run ends where it was meant to unless a control or a gate on 'completed' covers it";
    for (std::size_t run = 0; run < verdict_.runs.size(); ++run) {
      if (covered_[run]) continue;
      RunVerdict& target = verdict_.runs[run];
      const bool completed = target.record.completed();
      target.gates.push_back(result_of(
          gate, scope_of(target.parameters),
          {.value = completed ? 1.0 : 0.0, .detail = completed ? std::string() : ending_of(target.record)}));
    }
  }

  std::vector<const RunVerdict*> levels_of(const Group& group) const {
    std::vector<const RunVerdict*> levels;
    for (std::size_t run : group.runs) levels.push_back(&verdict_.runs[run]);
    return levels;
  }

  std::vector<double> cell_sizes_of(const Group& group) const {
    std::vector<double> sizes;
    for (std::size_t run : group.runs) sizes.push_back(definition().runs[run].scene.cell_size);
    return sizes;
  }

  static std::string scope_across(const Group& group, const Gate& gate) {
    std::string refined = gate.across.substr(gate.across.rfind('/') + 1);
    std::replace(refined.begin(), refined.end(), '_', ' ');
    const std::string over = fmt::format("{} values of {}", group.runs.size(), refined);
    return group.fixed.empty() ? over : scope_of(group.fixed) + ", " + over;
  }

  SeriesVerdict& series_of(const std::string& across, const Parameters& fixed) {
    return *std::find_if(verdict_.series.begin(), verdict_.series.end(), [&](const SeriesVerdict& series) {
      return series.across == across && series.fixed == fixed;
    });
  }

  /// Every refinement that a gate or a figure asks for, whole, whatever part of it a gate selects.
  void build_series() {
    std::vector<std::string> refined;
    for (const Gate& gate : definition().gates) {
      if (gate.statistic != Statistic::value) refined.push_back(gate.across);
    }
    for (const FigureRequest& figure : definition().figures) {
      if (!figure.over.empty()) refined.push_back(figure.over);
    }
    for (auto across = refined.begin(); across != refined.end(); ++across) {
      if (std::find(refined.begin(), across, *across) != across) continue;
      for (const Group& group : groups_across(definition(), selected_runs(definition(), {}), *across)) {
        verdict_.series.push_back(series_from(group, *across));
      }
    }
  }

  SeriesVerdict series_from(const Group& group, const std::string& across) const {
    SeriesVerdict series;
    series.across = across;
    series.fixed = group.fixed;
    series.cell_size = cell_sizes_of(group);
    for (const std::size_t run : group.runs)
      series.values.push_back(*value_of(definition().runs[run].parameters, across));
    const std::vector<const RunVerdict*> levels = levels_of(group);
    for (const RunVerdict* level : levels) {
      for (const auto& metric : level->metrics) series.metrics[metric.first];
    }
    for (auto& [metric, values] : series.metrics) {
      for (const RunVerdict* level : levels) values.push_back(measure(definition(), *level, metric).value);
      std::vector<double> orders = orders_of(values, series.cell_size);
      if (!orders.empty()) series.orders[metric] = std::move(orders);
      if (!has_uncertainty(metric)) continue;
      if (std::optional<GridConvergence> found = grid_convergence(series.cell_size, values))
        series.convergence[metric] = *std::move(found);
    }
    return series;
  }

  /// Whether a metric is a value of its own, which goes to a limit other than zero. Errors have their orders.
  static bool has_uncertainty(const std::string& metric) {
    return metric.starts_with(reading_prefix) || metric.starts_with("load_curve.");
  }

  /// Empty unless every value is positive and every level is finer than the one before: else there is no
  /// order.
  static std::vector<double> orders_of(const std::vector<double>& values,
                                       const std::vector<double>& cell_size) {
    std::vector<double> orders;
    for (std::size_t k = 0; k + 1 < values.size(); ++k) {
      const double order = observed_order(values[k], values[k + 1], cell_size[k], cell_size[k + 1]);
      if (!(values[k] > 0.0) || !std::isfinite(order)) return {};
      orders.push_back(order);
    }
    return orders;
  }

  CaseVerdict verdict_;
  std::vector<bool> covered_;  ///< runs whose early ending is somebody's business already
};

}  // namespace

CaseVerdict judge_case(const Case& definition, std::vector<Record> records, const Judge& judge_run) {
  if (records.size() != definition.runs.size()) {
    throw std::invalid_argument(fmt::format("case {} has {} runs and {} records", definition.id,
                                            definition.runs.size(), records.size()));
  }
  return Bench(definition, std::move(records), judge_run).verdict();
}

}  // namespace mpm::vv
