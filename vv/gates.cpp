#include "vv/gates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "vv/classification.hpp"
#include "vv/curves.hpp"
#include "vv/field_map.hpp"
#include "vv/grid_convergence.hpp"
#include "vv/measurement_reader.hpp"
#include "vv/run_groups.hpp"
#include "vv/validation.hpp"

namespace mpm::vv {
namespace {

constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();
constexpr const char* completion_metric = "completed";

// ---- measuring ----

/// Why the run was not compared with the measurement that a metric belongs to; empty if it was.
std::string lack_of_comparison(const RunVerdict& run, const std::string& metric) {
  for (const CurveComparison& comparison : run.comparisons)
    if (metric.starts_with(measured_prefix + comparison.measurement + ".")) return comparison.lack;
  return "";
}

/// Why a run that completed does not have a metric that is absent.
std::string why_absent(const Case& definition, const RunVerdict& run, const std::string& metric) {
  for (const Reading& reading : definition.readings) {
    if (metric != metric_of(reading).name) continue;
    const std::string lack = read_off(reading, run.curves).lack;
    if (!lack.empty()) return "the run completed but " + lack;
  }
  const std::string lack = lack_of_comparison(run, metric);
  if (!lack.empty()) return "the run completed but " + lack;
  return fmt::format("the run completed but {} was not measured", metric);
}

/// Whether the number needs a measurement that is an empty slot.
bool needs_what_is_missing(const Case& definition, const std::string& metric) {
  const Measurement* measurement = measurement_of(metric, definition.measurements);
  return measurement && measurement->file->missing;
}

Measured measure(const Case& definition, const RunVerdict& run, const std::string& metric) {
  if (needs_what_is_missing(definition, metric))
    return {.value = not_measured, .detail = lack_of_comparison(run, metric), .waits = true};
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
void add_lack(Measured& lacking, const RunVerdict& run, const std::string& detail, bool ended_early) {
  const bool first = lacking.detail.empty();
  if (first) lacking.detail = scope_of(run.parameters) + ": " + detail;
  lacking.ended_early = ended_early && (first || lacking.ended_early);
}

/// The same where the run's curve is to blame.
void add_lack_of_curve(Measured& lacking, const RunVerdict& run, const std::string& lack) {
  const bool completed = run.record.completed();
  add_lack(lacking, run, completed ? lack : ending_of(run.record) + ", " + lack,
           !completed && run.record.failure.empty());
}

/// How far apart the curves of a series are.
Measured measure_curves(const Gate& gate, const std::vector<const RunVerdict*>& levels) {
  std::vector<const Curve*> curves;
  Measured lacking;
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
Measured measure_uncertainty(const std::vector<double>& values, const std::vector<double>& cell_size) {
  const std::optional<GridConvergence> convergence = grid_convergence(cell_size, values);
  if (convergence) return {.value = convergence->uncertainty, .detail = convergence->method};
  return {.value = not_measured,
          .detail =
              "it takes three levels, each with smaller cells than the one before, and a last value that is "
              "not 0"};
}

bool is_power_law(Statistic statistic) {
  return statistic == Statistic::power_exponent || statistic == Statistic::power_coefficient;
}

/// n and c of y = c x^n, by least squares in the logarithms; nothing unless all numbers are above zero and the
/// abscissae differ.
std::optional<std::pair<double, double>> power_law(const std::vector<double>& x, const std::vector<double>& y) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!(x[k] > 0.0) || !(y[k] > 0.0)) return std::nullopt;
    const double lx = std::log(x[k]), ly = std::log(y[k]);
    sx += lx;
    sy += ly;
    sxx += lx * lx;
    sxy += lx * ly;
  }
  const auto count = static_cast<double>(x.size());
  const double exponent = (count * sxy - sx * sy) / (count * sxx - sx * sx);
  const double coefficient = std::exp((sy - exponent * sx) / count);
  if (!std::isfinite(exponent) || !std::isfinite(coefficient)) return std::nullopt;
  return std::pair(exponent, coefficient);
}

/// The law of a metric whose `values` are all there over another metric of the same runs.
Measured measure_power_law(const Case& definition, const Gate& gate, const std::vector<const RunVerdict*>& levels,
                           const std::vector<double>& values) {
  std::vector<double> abscissae;
  for (const RunVerdict* level : levels) {
    const Measured abscissa = measure(definition, *level, gate.over);
    if (!std::isfinite(abscissa.value)) return abscissa;
    abscissae.push_back(abscissa.value);
  }
  const std::optional<std::pair<double, double>> law = power_law(abscissae, values);
  if (!law)
    return {.value = not_measured,
            .detail = "a power law goes through positive numbers at different abscissae only"};
  return {.value = gate.statistic == Statistic::power_exponent ? law->first : law->second, .detail = {}};
}

/// A statistic of a series; without a value it tells of the first run that lacks one.
Measured measure(const Case& definition, const Gate& gate, const std::vector<const RunVerdict*>& levels,
                    const std::vector<double>& cell_size) {
  if (levels.size() < 2) {
    return {.value = not_measured,
            .detail = fmt::format("a series needs two runs, this one has {}", levels.size())};
  }
  if (gate.statistic == Statistic::curve_spread) return measure_curves(gate, levels);
  std::vector<double> values;
  Measured lacking;
  for (const RunVerdict* level : levels) {
    const Measured measurement = measure(definition, *level, gate.metric);
    values.push_back(measurement.value);
    if (!std::isfinite(measurement.value))
      add_lack(lacking, *level, measurement.detail, measurement.ended_early);
  }
  lacking.waits = needs_what_is_missing(definition, gate.metric);
  if (!lacking.detail.empty()) return lacking;
  if (is_power_law(gate.statistic)) return measure_power_law(definition, gate, levels, values);
  if (gate.statistic == Statistic::discretisation_uncertainty) return measure_uncertainty(values, cell_size);
  const double value = statistic_of(gate.statistic, values, cell_size);
  if (std::isfinite(value)) return {.value = value, .detail = {}};
  return {.value = not_measured, .detail = "the statistic of these values is not a finite number"};
}

Measured measure_pairs(Statistic statistic, const PairsVerdict& pairs) {
  if (!pairs.lack.empty()) return {.value = not_measured, .detail = pairs.lack, .waits = pairs.missing};
  const ModelFactor& factor = pairs.factor;
  return {.value = statistic == Statistic::bias      ? factor.bias
                   : statistic == Statistic::scatter ? factor.scatter
                                                     : factor.model_scatter,
          .detail =
              fmt::format("bias {:.3g} to {:.3g} with 95 % confidence", factor.bias_low, factor.bias_high)};
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

GateStatus status_of(const Gate& gate, const Measured& measurement) {
  if (measurement.waits) return GateStatus::no_measurement;
  const bool measured = std::isfinite(measurement.value);
  const bool green = measured && holds(gate.comparison, measurement.value, gate.threshold);
  if (!gate.must_fail) return green ? GateStatus::pass : GateStatus::fail;
  if (green) return GateStatus::unexpectedly_green;
  return measured || measurement.ended_early ? GateStatus::red_as_expected : GateStatus::fail;
}

/// What a gate looks at.
std::string object_of(const Gate& gate) {
  if (!gate.pairs.empty()) return gate.pairs;
  return gate.metric.empty() ? gate.curve : gate.metric;
}

GateResult result_of(const Gate& gate, const std::string& scope, const Measured& measurement) {
  GateResult result{.id = gate.id,
                    .metric = object_of(gate),
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

/// The curves of the case's cuts, as far as their snapshots were taken.
void add_cuts(const Case& definition, const Record& record, std::vector<Curve>& curves) {
  for (const Cut& cut : definition.cuts) {
    const std::string moment = moment_of(definition.snapshots[static_cast<std::size_t>(cut.snapshot)]);
    for (const Snapshot& snapshot : record.snapshots) {
      if (snapshot.moment != moment) continue;
      if (std::optional<Curve> curve = curve_along(cut, map_of(snapshot, cut.quantity)))
        curves.push_back(*std::move(curve));
    }
  }
}

/// Of the run's repeats; nothing without any.
std::optional<double> repeats_that_differ(const Record& record) {
  std::vector<std::string> digests;
  if (!record.repeat_digest.empty()) digests.push_back(record.repeat_digest);
  for (const auto& [threads, digest] : record.repeats) digests.push_back(digest);
  if (digests.empty()) return std::nullopt;
  return std::count_if(digests.begin(), digests.end(), [&](const std::string& digest) { return digest != record.digest; });
}

RunVerdict judged_run(const Case& definition, const RunRequest& request, Record record,
                      const Judge& judge_run) {
  RunVerdict run;
  run.parameters = request.parameters;
  if (record.failure.empty()) {
    try {
      Judgement judgement = judge_run(definition, request, record);
      run.metrics = std::move(judgement.metrics);
      run.curves = std::move(judgement.curves);
      add_cuts(definition, record, run.curves);
      for (const Reading& reading : definition.readings) {
        const ReadOff value = read_off(reading, run.curves);
        if (value.lack.empty()) run.metrics[metric_of(reading).name] = value.value;
      }
      if (const std::optional<double> differing = repeats_that_differ(record))
        run.metrics["bits_differ"] = *differing;
    } catch (const std::exception& error) {
      run.metrics.clear();
      record.failure = std::string("could not be judged: ") + error.what();
    }
  }
  run.record = std::move(record);
  return run;
}

// ---- gates ----

CaseStatus status_of(const CaseVerdict& verdict) {
  const auto results = gate_results(verdict);
  const bool good =
      std::all_of(results.begin(), results.end(), [](const GateResult* r) { return r->good(); });
  return good ? CaseStatus::pass : CaseStatus::fail;
}

/// One case while its gates are applied.
class Bench {
 public:
  Bench(const Case& definition, std::vector<Record> records, const Judge& judge_run, const Timings& timings) {
    verdict_.definition = definition;
    for (std::size_t run = 0; run < records.size(); ++run) {
      verdict_.runs.push_back(
          judged_run(definition, definition.runs[run], std::move(records[run]), judge_run));
    }
    covered_.resize(records.size(), false);
    compare_with_measurements(verdict_);
    verdict_.pairs = judge_pairs(verdict_);
    verdict_.trades = judge_trades(definition, verdict_.runs, timings);
    keep_trade_metrics(definition, verdict_.trades, verdict_.runs);
    verdict_.rounding = judge_rounding(definition, verdict_.runs);
    keep_rounding_metrics(verdict_.rounding, verdict_.runs);
    for (RunVerdict& run : verdict_.runs) classify(definition, run);
    build_series();
  }

  CaseVerdict verdict() && {
    for (const Gate& gate : definition().gates) {
      if (is_of_advice(gate)) continue;
      const bool applied = !gate.pairs.empty()                  ? apply_to_pairs(gate)
                           : gate.statistic == Statistic::value ? apply_to_runs(gate)
                                                                : apply_to_series(gate);
      if (!applied) refuse(gate, "the gate matches no run of the sweep");
    }
    require_completion();
    if (verdict_.runs.empty()) refuse(judged_at_all(), "the case has no runs");
    if (definition().gates.empty()) refuse(judged_at_all(), "the case has no gates");
    verdict_.status = status_of(verdict_);
    return std::move(verdict_);
  }

 private:
  const Case& definition() const { return verdict_.definition; }

  bool apply_to_runs(const Gate& gate) {
    const std::vector<std::size_t> runs = selected_runs(definition(), gate.where);
    for (std::size_t run : runs) {
      RunVerdict& target = verdict_.runs[run];
      if (!gate.classes.empty()) {
        target.gates.push_back(class_result(definition(), gate, target));
        covered_[run] = true;
        continue;
      }
      target.gates.push_back(
          result_of(gate, scope_of(target.parameters), measure(definition(), target, gate.metric)));
      if (gate.must_fail || gate.metric == completion_metric) covered_[run] = true;
    }
    return !runs.empty();
  }

  bool apply_to_pairs(const Gate& gate) {
    for (const PairsVerdict& pairs : verdict_.pairs) {
      if (pairs.id != gate.pairs) continue;
      const std::string scope = fmt::format("{} pairs, {}", pairs.pairs.size(), pairs.title);
      verdict_.gates.push_back(result_of(gate, scope, measure_pairs(gate.statistic, pairs)));
    }
    return true;
  }

  bool apply_to_series(const Gate& gate) {
    const std::vector<RunGroup> groups =
        groups_across(definition(), selected_runs(definition(), gate.where), gate.across);
    for (const RunGroup& group : groups) {
      const Measured measurement = measure(definition(), gate, levels_of(group), cell_sizes_of(group));
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

  /// A run that ended early is silent about everything else: unless someone expects it, that is a failure. Among the
  /// configurations of a trade it is an answer; which of them must end well, the case's gates say.
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
      if (!completed && target.record.failure.empty() && !definition().trades.empty()) continue;
      target.gates.push_back(result_of(
          gate, scope_of(target.parameters),
          {.value = completed ? 1.0 : 0.0, .detail = completed ? std::string() : ending_of(target.record)}));
    }
  }

  std::vector<const RunVerdict*> levels_of(const RunGroup& group) const {
    std::vector<const RunVerdict*> levels;
    for (std::size_t run : group.runs) levels.push_back(&verdict_.runs[run]);
    return levels;
  }

  std::vector<double> cell_sizes_of(const RunGroup& group) const {
    std::vector<double> sizes;
    for (std::size_t run : group.runs) sizes.push_back(definition().runs[run].scene.cell_size);
    return sizes;
  }

  static std::string scope_across(const RunGroup& group, const Gate& gate) {
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
      if (!gate.across.empty()) refined.push_back(gate.across);
    }
    for (const FigureRequest& figure : definition().figures) {
      if (!figure.over.empty()) refined.push_back(figure.over);
    }
    for (auto across = refined.begin(); across != refined.end(); ++across) {
      if (std::find(refined.begin(), across, *across) != across) continue;
      for (const RunGroup& group : groups_across(definition(), selected_runs(definition(), {}), *across)) {
        verdict_.series.push_back(series_from(group, *across));
      }
    }
  }

  SeriesVerdict series_from(const RunGroup& group, const std::string& across) const {
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

CaseVerdict judge_case(const Case& definition, std::vector<Record> records, const Judge& judge_run,
                       const Timings& timings) {
  if (records.size() != definition.runs.size()) {
    throw std::invalid_argument(fmt::format("case {} has {} runs and {} records", definition.id,
                                            definition.runs.size(), records.size()));
  }
  if (!timings.empty() && timings.size() != definition.runs.size()) {
    throw std::invalid_argument(fmt::format("case {} has {} runs and {} timings", definition.id,
                                            definition.runs.size(), timings.size()));
  }
  return Bench(definition, std::move(records), judge_run, timings).verdict();
}

bool is_of_advice(const Gate& gate) { return gate.metric.starts_with("advice."); }

void add_result(CaseVerdict& verdict, const Gate& gate, const Measured& measured) {
  verdict.gates.push_back(result_of(gate, "the case", measured));
  verdict.status = status_of(verdict);
}

}  // namespace mpm::vv
