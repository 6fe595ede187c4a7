#include "vv/advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "vv/advice_choice.hpp"
#include "vv/gates.hpp"
#include "vv/run_groups.hpp"
#include "vv/scene_match.hpp"

namespace mpm::vv {
namespace {

constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

// ---- several problems ----

bool same_parameters(const Parameters& one, const Parameters& other) {
  return one.size() == other.size() && std::all_of(one.begin(), one.end(), [&](const auto& parameter) {
           const Json* value = value_of(other, parameter.first);
           return value && same_value(parameter.second, *value);
         });
}

const TradePoint* point_of(const TradeVerdict& trade, const Parameters& configuration) {
  const auto point = std::find_if(trade.points.begin(), trade.points.end(), [&](const TradePoint& each) {
    return same_parameters(each.configuration, configuration);
  });
  return point == trade.points.end() ? nullptr : &*point;
}

std::optional<Timing> slower(const std::optional<Timing>& one, const std::optional<Timing>& other) {
  if (!one || !other) return std::nullopt;
  return Timing{.median = std::max(one->median, other->median),
                .low = std::max(one->low, other->low),
                .high = std::max(one->high, other->high),
                .repeats = std::min(one->repeats, other->repeats),
                .whole = one->whole && other->whole};
}

/// What can be said of a configuration whatever the problem is of the two.
TradePoint worse_of(const TradePoint& one, const TradePoint& other) {
  const bool other_counts = !other.failure.empty() || !(one.bound() >= other.bound());
  TradePoint worse = one.failure.empty() && other_counts ? other : one;
  worse.run = one.run;
  worse.of_reference = one.of_reference || other.of_reference;
  worse.on_time_front = worse.on_work_front = false;  // fronts are of one problem
  worse.timing = slower(one.timing, other.timing);
  worse.work = {std::max(one.work.particle_steps, other.work.particle_steps),
                std::max(one.work.bytes, other.work.bytes),
                std::max(one.work.operations, other.work.operations)};
  return worse;
}

// ---- near problems ----

std::vector<Json> values_along(const std::vector<const TradeVerdict*>& measured, const std::string& axis) {
  std::vector<Json> values;
  for (const TradeVerdict* trade : measured) {
    const Json* value = value_of(trade->problem, axis);
    const auto known = [&](const Json& other) { return value && same_value(*value, other); };
    if (value && std::none_of(values.begin(), values.end(), known)) values.push_back(*value);
  }
  return values;
}

/// Values of one axis among which a value lies, and how.
struct Among {
  NearProblems::Kind kind = NearProblems::Kind::outside;
  std::vector<Json> values;
};

Among neighbours_of(const Magnitude& magnitude, const std::vector<Json>& values) {
  const Json *below = nullptr, *above = nullptr;
  double nearest_below = -std::numeric_limits<double>::infinity();
  double nearest_above = std::numeric_limits<double>::infinity();
  for (const Json& candidate : values) {
    const std::optional<Magnitude> other = magnitude_of(candidate);
    if (!other || !other->comparable_with(magnitude)) continue;
    if (other->value < magnitude.value && other->value > nearest_below) {
      below = &candidate;
      nearest_below = other->value;
    }
    if (other->value > magnitude.value && other->value < nearest_above) {
      above = &candidate;
      nearest_above = other->value;
    }
  }
  if (!below || !above) return {};
  return {NearProblems::Kind::between, {*below, *above}};
}

Among values_about(const Json& value, const std::vector<Json>& values) {
  for (const Json& candidate : values)
    if (same_value(value, candidate)) return {NearProblems::Kind::same, {candidate}};
  if (const std::optional<Magnitude> magnitude = magnitude_of(value))
    return neighbours_of(*magnitude, values);
  return {NearProblems::Kind::unlike, values};
}

// ---- advice put to the test ----

const CaseVerdict* judged_case(const std::vector<CaseVerdict>& verdicts, const std::string& id) {
  const auto found = std::find_if(verdicts.begin(), verdicts.end(),
                                  [&](const CaseVerdict& verdict) { return verdict.definition.id == id; });
  return found == verdicts.end() || found->status == CaseStatus::not_run ? nullptr : &*found;
}

/// The trades of a case whose error is that of `trade`, of its title if there is one.
std::vector<const TradeVerdict*> trades_like(const TradeVerdict& trade, const CaseVerdict& verdict) {
  std::vector<const TradeVerdict*> alike;
  for (const TradeVerdict& each : verdict.trades)
    if (each.error_name == trade.error_name) alike.push_back(&each);
  const auto of_title = [&](const TradeVerdict* each) { return each->title == trade.title; };
  if (std::any_of(alike.begin(), alike.end(), of_title)) std::erase_if(alike, std::not_fn(of_title));
  return alike;
}

/// Bytes of a configuration over those of the cheapest that meets the error.
double regret_of(const TradePoint& advised, const TradeVerdict& trade, double asked) {
  const Choice best = cheapest_within(trade, asked, false);
  return best.point ? advised.work.bytes / trade.points[*best.point].work.bytes : not_measured;
}

/// Looks up what a trade of this case says to the advice drawn from `offered`.
void put_to_the_test(const TradeVerdict& offered, const TradeVerdict& trade, AdviceTrial& trial) {
  const Choice choice = cheapest_within(offered, trial.asked, false);
  trial.no_offer = !choice.point;
  if (trial.no_offer) {
    trial.lack = "nothing measured meets it";
    return;
  }
  const TradePoint& advised = offered.points[*choice.point];
  trial.configuration = advised.configuration;
  trial.promised = advised.bound();
  const TradePoint* here = point_of(trade, advised.configuration);
  if (!here) {
    trial.lack = "the configuration was not run here";
  } else if (!here->failure.empty() || !std::isfinite(here->bound())) {
    trial.lack = here->failure.empty() ? "no error was measured here" : here->failure;
  } else {
    trial.found = here->bound();
    trial.kept = trial.found <= trial.asked;
    trial.regret = regret_of(*here, trade, trial.asked);
  }
}

AdviceTrial trial_from(const std::vector<const TradeVerdict*>& measured, const TradeVerdict& trade,
                       double asked) {
  AdviceTrial trial{.title = trade.title, .problem = trade.problem, .asked = asked};
  const NearProblems near = problems_near(measured, trade.problem);
  trial.between = near.kind == NearProblems::Kind::between;
  if (near.problems.empty()) {
    trial.lack =
        measured.empty() ? "the case has no trade of " + trade.error_name : "outside of what was measured";
    return trial;
  }
  trial.drawn_from = names_of_problems(near.problems);
  put_to_the_test(worst_of(near.problems), trade, trial);
  return trial;
}

/// The same for a case's own trade: advice drawn from every second of its configurations.
AdviceTrial trial_of_own(const TradeVerdict& trade, double asked) {
  AdviceTrial trial{.title = trade.title, .problem = trade.problem, .asked = asked};
  trial.drawn_from = "every second configuration";
  TradeVerdict half = trade;
  half.points.clear();
  for (std::size_t k = 0; k < trade.points.size(); k += 2) half.points.push_back(trade.points[k]);
  put_to_the_test(half, trade, trial);
  return trial;
}

// ---- numbers of the whole ----

std::string name_of(const AdviceTrial& trial) {
  return fmt::format("{}{}, asked {:g}", trial.problem.empty() ? "" : scope_of(trial.problem) + ", ",
                     trial.title, trial.asked);
}

std::vector<const AdviceTrial*> promises_of(const AdviceVerdict& advice) {
  std::vector<const AdviceTrial*> promises;
  for (const AdviceTrial& trial : advice.trials)
    if (!trial.no_offer) promises.push_back(&trial);
  return promises;
}

Measured share_kept(const std::vector<const AdviceTrial*>& promises) {
  double kept = 0.0;
  Measured found;
  for (const AdviceTrial* trial : promises) {
    kept += trial->kept ? 1.0 : 0.0;
    if (trial->kept || !found.detail.empty()) continue;
    found.detail = name_of(*trial) + ": " +
                   (trial->lack.empty() ? fmt::format("found {:.3g}", trial->found) : trial->lack);
  }
  found.value = kept / static_cast<double>(promises.size());
  return found;
}

/// The largest number of any trial; none if one of them lacks it, where the largest would pass that over.
template <class Number>
Measured largest(const std::vector<const AdviceTrial*>& promises, Number number) {
  Measured found;
  for (const AdviceTrial* trial : promises) {
    const double value = number(*trial);
    if (!std::isfinite(value))
      return {
          .value = not_measured,
          .detail = name_of(*trial) + ": " + (trial->lack.empty() ? "no run here meets it" : trial->lack)};
    if (found.value >= value) continue;
    found = {.value = value, .detail = name_of(*trial)};
  }
  return found;
}

Measured measure(const std::string& metric, const AdviceVerdict& advice) {
  if (!advice.lack.empty()) return {.value = not_measured, .detail = advice.lack};
  const bool of_own = metric == "advice.hidden";
  if (of_own != advice.own)
    return {.value = not_measured,
            .detail = of_own ? "the advice is that of another case" : "the advice is the case's own"};
  const std::vector<const AdviceTrial*> promises = promises_of(advice);
  if (promises.empty())
    return {.value = not_measured, .detail = "nothing measured meets any of the errors asked for"};
  if (metric == "advice.kept") return share_kept(promises);
  if (metric == "advice.worst")
    return largest(promises, [](const AdviceTrial& trial) { return trial.found / trial.asked; });
  return largest(promises, [](const AdviceTrial& trial) { return trial.regret; });
}

AdviceVerdict advice_of(const CaseVerdict& verdict, const std::vector<CaseVerdict>& verdicts) {
  const AdviceTest& test = *verdict.definition.advice;
  AdviceVerdict advice{.of = test.of, .own = test.of == verdict.definition.id};
  const CaseVerdict* source = judged_case(verdicts, test.of);
  if (!source) {
    advice.lack = "case " + test.of + ", whose advice it is, was not run with it";
  } else if (verdict.trades.empty()) {
    advice.lack = "the case has no trades by which advice can be judged";
  }
  if (!advice.lack.empty()) return advice;
  for (const TradeVerdict& trade : verdict.trades) {
    for (const double asked : test.asked)
      advice.trials.push_back(advice.own ? trial_of_own(trade, asked)
                                         : trial_from(trades_like(trade, *source), trade, asked));
  }
  for (const Metric& metric : advice_catalogue()) {
    const double value = measure(metric.name, advice).value;
    if (std::isfinite(value)) advice.metrics[metric.name] = value;
  }
  return advice;
}

void apply_gates(CaseVerdict& verdict, bool waits) {
  for (const Gate& gate : verdict.definition.gates) {
    if (!is_of_advice(gate)) continue;
    Measured found = measure(gate.metric, *verdict.advice);
    found.waits = waits;
    add_result(verdict, gate, found);
  }
}

}  // namespace

TradeVerdict worst_of(const std::vector<const TradeVerdict*>& problems) {
  TradeVerdict worst = *problems.front();
  for (const TradeVerdict* other : problems) {
    std::erase_if(worst.problem, [&](const auto& parameter) {
      const Json* value = value_of(other->problem, parameter.first);
      return !value || !same_value(parameter.second, *value);
    });
    if (other == problems.front()) continue;
    std::vector<TradePoint> shared;
    for (const TradePoint& point : worst.points)
      if (const TradePoint* same = point_of(*other, point.configuration))
        shared.push_back(worse_of(point, *same));
    worst.points = std::move(shared);
  }
  return worst;
}

NearProblems problems_near(const std::vector<const TradeVerdict*>& measured, const Parameters& problem) {
  if (measured.empty()) return {};
  NearProblems near{.kind = NearProblems::Kind::same, .problems = measured};
  std::size_t combinations = 1;
  for (const auto& [axis, first] : measured.front()->problem) {
    const Json* value = value_of(problem, axis);
    const Among among = value ? values_about(*value, values_along(measured, axis)) : Among{};
    near.kind = std::max(near.kind, among.kind);
    combinations *= among.values.size();
    std::erase_if(near.problems, [&](const TradeVerdict* trade) {
      const Json* own = value_of(trade->problem, axis);
      return !own || std::none_of(among.values.begin(), among.values.end(),
                                  [&](const Json& each) { return same_value(each, *own); });
    });
  }
  if (near.problems.size() != combinations) return {};
  return near;
}

std::string names_of_problems(const std::vector<const TradeVerdict*>& problems) {
  std::string names;
  for (std::size_t k = 0; k < problems.size(); ++k) {
    if (k > 0) names += k + 1 < problems.size() ? ", " : " and ";
    names += problems[k]->problem.empty() ? "the measured one" : scope_of(problems[k]->problem);
  }
  return names;
}

const std::vector<Metric>& advice_catalogue() {
  static const std::vector<Metric> metrics = {
      {"advice.kept", "-", "", "share of the errors promised by another case that the runs here keep"},
      {"advice.worst", "-", "", "largest error found over the error asked for"},
      {"advice.regret", "-", "",
       "largest cost of what was advised over that of the cheapest run that meets the error"},
      {"advice.hidden", "-", "",
       "the same of the case's own trades, advised from every second configuration"},
  };
  return metrics;
}

void judge_advice(std::vector<CaseVerdict>& verdicts) {
  for (CaseVerdict& verdict : verdicts) {
    if (!verdict.definition.advice || verdict.status == CaseStatus::not_run) continue;
    verdict.advice = advice_of(verdict, verdicts);
    apply_gates(verdict, !judged_case(verdicts, verdict.definition.advice->of));
  }
}

}  // namespace mpm::vv
