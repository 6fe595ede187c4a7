#include "vv/trade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "vv/curves.hpp"
#include "vv/measurement_reader.hpp"
#include "vv/run_groups.hpp"
#include "vv/step_cost.hpp"
#include "vv/trade_reader.hpp"
#include "vv/verdict.hpp"

namespace mpm::vv {
namespace {

using Values = std::vector<double>;
using Runs = std::vector<std::size_t>;  ///< indices into those of the case

Runs common(const Runs& some, const Runs& others) {
  Runs both;
  std::set_intersection(some.begin(), some.end(), others.begin(), others.end(), std::back_inserter(both));
  return both;
}

bool is_among(std::size_t run, const Runs& runs) { return std::binary_search(runs.begin(), runs.end(), run); }

Parameters without(const Parameters& parameters, const std::vector<std::string>& names) {
  Parameters rest;
  for (const auto& entry : parameters)
    if (std::find(names.begin(), names.end(), entry.first) == names.end()) rest.push_back(entry);
  return rest;
}

/// Mean of curves that are read at the same abscissae.
Values mean_of(const std::vector<Values>& curves) {
  Values mean(curves.front().size(), 0.0);
  for (const Values& curve : curves)
    for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += curve[k] / static_cast<double>(curves.size());
  return mean;
}

Values half_range_of(const std::vector<Values>& curves) {
  Values half(curves.front().size());
  for (std::size_t k = 0; k < half.size(); ++k) {
    double least = curves.front()[k], most = least;
    for (const Values& curve : curves) {
      least = std::min(least, curve[k]);
      most = std::max(most, curve[k]);
    }
    half[k] = (most - least) / 2;
  }
  return half;
}

Values sum_of(Values one, const Values& other) {
  for (std::size_t k = 0; k < one.size(); ++k) one[k] += other[k];
  return one;
}

/// An error or, where it is NaN, why there is none.
struct Error {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string failure;
};

Error finite_or(double value, const std::string& failure) {
  if (std::isfinite(value)) return {.value = value, .failure = {}};
  return {.failure = failure};
}

// ---- errors of metrics ----

/// Which solution a metric is measured against; the metric itself if none has a name.
std::string source_of(const std::string& metric, const Case& definition) {
  for (const Reading& reading : definition.readings)
    if (metric == metric_of(reading).name && !reading.over.empty()) return reading.over;
  if (const Measurement* measurement = measurement_of(metric, definition.measurements))
    return measurement->file->id;
  for (const Metric& known : metric_catalogue())
    if (known.name == metric && !known.reference.empty()) return known.reference;
  return metric;
}

Error error_of_metric(const RunVerdict& run, const std::string& metric) {
  if (!run.record.completed()) return {.failure = ending_of(run.record)};
  const auto found = run.metrics.find(metric);
  if (found == run.metrics.end())
    return {.failure = fmt::format("the run completed but {} was not measured", metric)};
  return finite_or(std::abs(found->second), fmt::format("{} is not a finite number", metric));
}

// ---- errors of curves ----

/// The curves of one problem's runs, and what the finest of them make of the truth.
class CurveProblem {
 public:
  CurveProblem(const Case& definition, const std::vector<RunVerdict>& runs, const TradeRequest& request,
               const Runs& members)
      : runs_(runs), request_(request), abscissae_(abscissae_over(request.from, request.up_to)) {
    for (const std::vector<Selector>& family : request.finest)
      families_.push_back(common(selected_runs(definition, family), members));
    is_baseline_ = families_.empty();
    if (is_baseline_) families_.push_back(common(selected_runs(definition, request.baseline), members));
    for (const Runs& family : families_) curves_.push_back(curve_of_family(family));
    if (lack_.empty()) build_reference();
  }

  const TradeReference& reference() const { return reference_; }

  bool is_of_reference(std::size_t run) const {
    return std::any_of(families_.begin(), families_.end(),
                       [&](const Runs& family) { return is_among(run, family); });
  }

  /// By the families that the run is not part of; by the baseline in any case.
  Error error_of(std::size_t run) const {
    const CurveReading own = read(run);
    if (!own.lack.empty()) return {.failure = own.lack};
    if (!lack_.empty()) return {.failure = lack_};
    std::vector<Values> judges;
    for (std::size_t k = 0; k < families_.size(); ++k)
      if (is_baseline_ || !is_among(run, families_[k])) judges.push_back(curves_[k]);
    return finite_or(curve_distance(abscissae_, mean_of(judges), own.y).l2,
                     "the distance from the reference is not a finite number");
  }

 private:
  CurveReading read(std::size_t run) const {
    const RunVerdict& verdict = runs_[run];
    if (!verdict.record.completed()) return {.y = {}, .lack = ending_of(verdict.record)};
    const Curve* curve = find_curve(verdict.curves, request_.curve, "run");
    if (!curve) return {.y = {}, .lack = fmt::format("the run has no curve {}", request_.curve)};
    return read_over(*curve, abscissae_, request_.within);
  }

  /// Empty, and noted as lacking, if any of its runs has none.
  Values curve_of_family(const Runs& family) {
    std::vector<Values> curves;
    for (const std::size_t run : family) {
      const CurveReading reading = read(run);
      if (reading.lack.empty())
        curves.push_back(reading.y);
      else if (lack_.empty())
        lack_ = fmt::format("there is no reference: {}: {}", name_of_run(run), reading.lack);
    }
    return lack_.empty() ? mean_of(curves) : Values();
  }

  void build_reference() {
    reference_.x = abscissae_;
    reference_.y = mean_of(curves_);
    reference_.spread = half_range_of(curves_);
    // The distance of the curve from itself with half the range put on it.
    reference_.uncertainty =
        curve_distance(abscissae_, reference_.y, sum_of(reference_.y, reference_.spread)).l2;
    std::vector<std::string> names;
    for (const Runs& family : families_)
      for (const std::size_t run : family) names.push_back(name_of_run(run));
    reference_.source =
        is_baseline_ ? names.front() : fmt::format("mean of {}", fmt::join(names, " and "));
  }

  std::string name_of_run(std::size_t run) const {
    return scope_of(without(runs_[run].parameters, request_.problems));
  }

  const std::vector<RunVerdict>& runs_;
  const TradeRequest& request_;
  Values abscissae_;
  std::vector<Runs> families_;
  std::vector<Values> curves_;  ///< of the families
  bool is_baseline_ = false;    ///< the only family, taken for what it is
  std::string lack_;
  TradeReference reference_;
};

// ---- fronts ----

/// Marks the points that nothing beats: no other is at least as good in both error and cost, and better in
/// one.
template <class Cost>
void mark_front(std::vector<TradePoint>& points, bool TradePoint::*front, Cost cost_of) {
  const auto takes_part = [&](const TradePoint& point) {
    return std::isfinite(point.error) && !point.of_reference && std::isfinite(cost_of(point));
  };
  for (TradePoint& point : points) {
    point.*front =
        takes_part(point) && std::none_of(points.begin(), points.end(), [&](const TradePoint& other) {
          if (!takes_part(other)) return false;
          const bool as_good = other.error <= point.error && cost_of(other) <= cost_of(point);
          return as_good && (other.error < point.error || cost_of(other) < cost_of(point));
        });
  }
}

// ---- verdicts ----

class TradeJudge {
 public:
  TradeJudge(const Case& definition, const std::vector<RunVerdict>& runs, const Timings& timings,
             const TradeRequest& request)
      : definition_(definition), runs_(runs), timings_(timings), request_(request) {}

  TradeVerdict verdict_of(const RunGroup& problem) const {
    TradeVerdict verdict;
    verdict.title = request_.title;
    verdict.problem = problem.fixed;
    verdict.error_name = request_.curve.empty() ? request_.metric : request_.curve;
    for (const std::size_t run : problem.runs) verdict.points.push_back(point_of(run));
    if (request_.curve.empty())
      judge_by_metric(verdict);
    else
      judge_by_curve(verdict, problem.runs);
    mark_front(verdict.points, &TradePoint::on_time_front, [](const TradePoint& point) {
      return point.timing ? point.timing->median : std::numeric_limits<double>::quiet_NaN();
    });
    mark_front(verdict.points, &TradePoint::on_work_front,
               [](const TradePoint& point) { return point.work.bytes; });
    return verdict;
  }

 private:
  /// All but the error.
  TradePoint point_of(std::size_t run) const {
    const RunRequest& request = definition_.runs[run];
    TradePoint point;
    point.run = run;
    point.configuration = without(request.parameters, request_.problems);
    if (const Json* family = value_of(request.parameters, request_.family))
      point.family = scope_of({{request_.family, *family}});
    point.cell_size = request.scene.cell_size;
    point.work = counted_work(request.scene, runs_[run].record.cost.particle_steps);
    if (!timings_.empty()) point.timing = timings_[run];
    return point;
  }

  void judge_by_metric(TradeVerdict& verdict) const {
    verdict.reference.source = source_of(request_.metric, definition_);
    for (TradePoint& point : verdict.points)
      take(error_of_metric(runs_[point.run], request_.metric), 0.0, point);
  }

  void judge_by_curve(TradeVerdict& verdict, const Runs& members) const {
    const CurveProblem problem(definition_, runs_, request_, members);
    verdict.reference = problem.reference();
    for (TradePoint& point : verdict.points) {
      point.of_reference = problem.is_of_reference(point.run);
      take(problem.error_of(point.run), verdict.reference.uncertainty, point);
    }
  }

  static void take(const Error& error, double uncertainty, TradePoint& point) {
    point.error = error.value;
    point.failure = error.failure;
    if (error.failure.empty()) point.uncertainty = uncertainty;
  }

  const Case& definition_;
  const std::vector<RunVerdict>& runs_;
  const Timings& timings_;
  const TradeRequest& request_;
};

}  // namespace

std::vector<TradeVerdict> judge_trades(const Case& definition, const std::vector<RunVerdict>& runs,
                                       const Timings& timings) {
  std::vector<TradeVerdict> verdicts;
  for (const TradeRequest& request : definition.trades) {
    const TradeJudge judge(definition, runs, timings, request);
    for (const RunGroup& problem : groups_alike_in(definition, request.problems))
      verdicts.push_back(judge.verdict_of(problem));
  }
  return verdicts;
}

void keep_trade_metrics(const Case& definition, const std::vector<TradeVerdict>& trades,
                        std::vector<RunVerdict>& runs) {
  for (std::size_t k = 0; k < definition.trades.size(); ++k) {
    const std::string name = fmt::format("{}{}", trade_prefix, k + 1);
    for (const TradeVerdict& verdict : trades) {
      if (verdict.title != definition.trades[k].title) continue;
      for (const TradePoint& point : verdict.points) {
        if (!point.failure.empty()) continue;
        runs[point.run].metrics[name + ".error"] = point.error;
        runs[point.run].metrics[name + ".bound"] = point.bound();
      }
    }
  }
}

}  // namespace mpm::vv
