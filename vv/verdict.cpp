#include "vv/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "vv/measured_trades.hpp"

namespace mpm::vv {
namespace {

constexpr const char* results_schema = "mpmvv-results/1";

/// JSON has no NaN: what could not be measured is null, and a detail beside it says why.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json numbers(const std::vector<double>& values) {
  Json json = Json::array();
  for (double value : values) json.push_back(number(value));
  return json;
}

Json numbers_by_name(const std::map<std::string, double>& values) {
  Json json = Json::object();
  for (const auto& [name, value] : values) json[name] = number(value);
  return json;
}

Json series_by_name(const std::map<std::string, std::vector<double>>& values) {
  Json json = Json::object();
  for (const auto& [name, series] : values) json[name] = numbers(series);
  return json;
}

Json parameters_to_json(const std::vector<std::pair<std::string, Json>>& parameters) {
  Json json = Json::object();
  for (const auto& [pointer, value] : parameters) json[pointer] = value;
  return json;
}

Json gates_to_json(const std::vector<GateResult>& gates) {
  Json json = Json::array();
  for (const GateResult& gate : gates) {
    json.push_back({{"id", gate.id},
                    {"metric", gate.metric},
                    {"value", number(gate.value)},
                    {"op", gate.op},
                    {"threshold", gate.threshold},
                    {"reason", gate.reason},
                    {"pass", gate.waits() ? Json(nullptr) : Json(gate.good())},
                    {"status", name_of(gate.status)},
                    {"must_fail", gate.must_fail},
                    {"statistic", gate.statistic},
                    {"basis", gate.basis},
                    {"scope", gate.scope},
                    {"margin", number(margin(gate))},
                    {"detail", gate.detail}});
    if (gate.op == "is") json.back().update({{"found", gate.found}, {"expected", gate.expected}, {"advice", gate.advice}});
  }
  return json;
}

Json outcome_to_json(const Record& record) {
  const Outcome& outcome = record.outcome;
  Json json = {{"ending", record.failure.empty() ? name_of(outcome.ending) : "failed"},
               {"step", outcome.step},
               {"time", number(outcome.time)},
               {"particle", outcome.particle},
               {"value", number(outcome.value)},
               {"completed", record.completed()}};
  if (!record.failure.empty()) json["failure"] = record.failure;
  return json;
}

Json comparisons_to_json(const std::vector<CurveComparison>& comparisons) {
  Json json = Json::array();
  for (const CurveComparison& comparison : comparisons) {
    Json entry = {{"measurement", comparison.measurement},
                  {"agreement", name_of(comparison.agreement)},
                  {"lack", comparison.lack}};
    for (const ComparisonMetric& metric : comparison_metrics()) {
      // Without a comparison the numbers are those of nothing.
      entry[metric.name] = comparison.lack.empty() ? number(metric.value(comparison)) : Json(nullptr);
    }
    entry.update({{"abscissa", numbers(comparison.abscissa)},
                  {"measured", numbers(comparison.measured)},
                  {"simulated", numbers(comparison.simulated)},
                  {"u_measured", numbers(comparison.u_measured)},
                  {"u_numerical", numbers(comparison.u_numerical)},
                  {"u_input", numbers(comparison.u_input)},
                  {"u_validation", numbers(comparison.u_validation)}});
    json.push_back(std::move(entry));
  }
  return json;
}

Json pairs_to_json(const std::vector<PairsVerdict>& all) {
  Json json = Json::array();
  for (const PairsVerdict& pairs : all) {
    Json entry = {{"id", pairs.id}, {"title", pairs.title}, {"dimension", pairs.dimension}, {"lack", pairs.lack}};
    const ModelFactor& factor = pairs.factor;
    const bool judged = pairs.lack.empty();
    const std::pair<const char*, double> facts[] = {
        {"bias", factor.bias},          {"bias_low", factor.bias_low},
        {"bias_high", factor.bias_high}, {"scatter", factor.scatter},
        {"model_scatter", factor.model_scatter}, {"least", factor.least}, {"greatest", factor.greatest}};
    for (const auto& [name, value] : facts) entry[name] = judged ? number(value) : Json(nullptr);
    entry["pairs"] = Json::array();
    for (const Pair& pair : pairs.pairs) {
      entry["pairs"].push_back(
          {{"name", pair.name}, {"measured", number(pair.measured)}, {"predicted", number(pair.predicted)}});
    }
    json.push_back(std::move(entry));
  }
  return json;
}

/// Which numbers a case was judged against, so that results tell them from others of the same name.
Json curve_files_to_json(const Case& definition) {
  Json json = Json::object();
  for (const auto& file : curve_files_of(definition)) {
    json[file->id] = {{"status", file->missing ? "missing" : "present"},
                      {"citation", file->citation},
                      {"doi", file->doi},
                      {"place", file->place},
                      {"origin", file->origin},
                      {"used_for_calibration", file->used_for_calibration},
                      {"hash", file->hash}};
  }
  return json;
}

Json timing_to_json(const std::optional<Timing>& timing) {
  if (!timing) return nullptr;
  return {{"median", number(timing->median)},
          {"low", number(timing->low)},
          {"high", number(timing->high)},
          {"repeats", timing->repeats},
          {"whole", timing->whole}};
}

/// What makes a run this configuration: the changes of all axes but those of the problem, in one.
Json changes_to_json(const RunRequest& run, const TradeVerdict& trade) {
  Json changes = {{"set", Json::object()}, {"remove", Json::array()}};
  for (std::size_t axis = 0; axis < run.changes.size(); ++axis) {
    const std::string& parameter = run.parameters[axis].first;
    const bool of_problem = std::any_of(trade.problem.begin(), trade.problem.end(),
                                        [&](const auto& entry) { return entry.first == parameter; });
    if (of_problem) continue;
    changes["set"].update(run.changes[axis]["set"]);
    for (const Json& pointer : run.changes[axis]["remove"]) changes["remove"].push_back(pointer);
  }
  return changes;
}

Json trades_to_json(const CaseVerdict& verdict) {
  Json json = Json::array();
  for (const TradeVerdict& trade : verdict.trades) {
    const TradeReference& reference = trade.reference;
    Json entry = {{"title", trade.title},
                  {"problem", parameters_to_json(trade.problem)},
                  {"error_name", trade.error_name},
                  {"reference",
                   {{"source", reference.source},
                    {"uncertainty", number(reference.uncertainty)},
                    {"x", numbers(reference.x)},
                    {"y", numbers(reference.y)},
                    {"spread", numbers(reference.spread)}}},
                  {"points", Json::array()}};
    for (const TradePoint& point : trade.points) {
      const bool judged = point.failure.empty();
      entry["points"].push_back({{"run", point.run},
                                 {"configuration", parameters_to_json(point.configuration)},
                                 {"changes", changes_to_json(verdict.definition.runs[point.run], trade)},
                                 {"family", point.family},
                                 {"cell_size", number(point.cell_size)},
                                 {"error", number(point.error)},
                                 {"uncertainty", judged ? number(point.uncertainty) : Json(nullptr)},
                                 {"failure", point.failure},
                                 {"of_reference", point.of_reference},
                                 {"seconds", timing_to_json(point.timing)},
                                 {"particle_steps", number(point.work.particle_steps)},
                                 {"bytes", number(point.work.bytes)},
                                 {"operations", number(point.work.operations)},
                                 {"on_time_front", point.on_time_front},
                                 {"on_work_front", point.on_work_front}});
    }
    json.push_back(std::move(entry));
  }
  return json;
}

Json repeats_to_json(const Record& record) {
  Json json = Json::array();
  for (const auto& [threads, digest] : record.repeats)
    json.push_back({{"step_threads", threads}, {"digest", digest}});
  return json;
}

Json run_to_json(const RunVerdict& run) {
  const Record& record = run.record;
  return {{"parameters", parameters_to_json(run.parameters)},
          {"outcome", outcome_to_json(record)},
          {"metrics", numbers_by_name(run.metrics)},
          {"cost",
           {{"wall_seconds", number(record.cost.wall_seconds)},
            {"steps", record.cost.steps},
            {"particle_steps", record.cost.particle_steps},
            {"memory_bytes", record.cost.memory_bytes}}},
          {"model", model_to_json(record.model)},
          {"comparisons", comparisons_to_json(run.comparisons)},
          {"gates", gates_to_json(run.gates)},
          {"time_step", number(record.time_step)},
          {"end_time", number(record.end_time)},
          {"unbalanced_force_ratio", number(record.unbalanced_force_ratio)},
          {"kinetic_energy_ratio", number(record.kinetic_energy_ratio)},
          {"revision", record.revision},
          {"input_hash", record.input_hash},
          {"program_hash", record.program_hash},
          {"digest", record.digest},
          {"repeat_digest", record.repeat_digest},
          {"repeats", repeats_to_json(record)}};
}

Json rounding_to_json(const std::vector<RoundingRow>& rows) {
  Json json = Json::array();
  for (const RoundingRow& row : rows) {
    const std::pair<const char*, double> facts[] = {{"displacement", row.displacement},
                                                    {"stress", row.stress},
                                                    {"digits_of_displacement", row.digits_of_displacement},
                                                    {"digits_of_stress", row.digits_of_stress},
                                                    {"cells_of_displacement", row.cells_of_displacement},
                                                    {"cells_of_stress", row.cells_of_stress},
                                                    {"share", row.share}};
    Json entry = {{"run", row.run}, {"baseline", row.baseline}, {"bits_equal", row.bits_equal}};
    for (const auto& [name, value] : facts) entry[name] = row.lack.empty() ? number(value) : Json(nullptr);
    entry["enough"] = row.is_enough();
    entry["lack"] = row.lack;
    json.push_back(std::move(entry));
  }
  return json;
}

Json convergence_by_name(const std::map<std::string, GridConvergence>& found) {
  Json json = Json::object();
  for (const auto& [name, convergence] : found) {
    json[name] = {{"monotone", convergence.monotone},
                  {"order", number(convergence.order)},
                  {"extrapolated", number(convergence.extrapolated)},
                  {"uncertainty", number(convergence.uncertainty)},
                  {"method", convergence.method}};
  }
  return json;
}

Json series_to_json(const SeriesVerdict& series) {
  return {{"across", series.across},
          {"fixed", parameters_to_json(series.fixed)},
          {"cell_size", numbers(series.cell_size)},
          {"metrics", series_by_name(series.metrics)},
          {"orders", series_by_name(series.orders)},
          {"convergence", convergence_by_name(series.convergence)},
          {"gates", gates_to_json(series.gates)}};
}

Json trial_to_json(const AdviceTrial& trial) {
  return {{"title", trial.title},
          {"problem", parameters_to_json(trial.problem)},
          {"asked", trial.asked},
          {"drawn_from", trial.drawn_from},
          {"between", trial.between},
          {"configuration", parameters_to_json(trial.configuration)},
          {"promised", number(trial.promised)},
          {"found", number(trial.found)},
          {"regret", number(trial.regret)},
          {"kept", trial.kept},
          {"no_offer", trial.no_offer},
          {"lack", trial.lack}};
}

Json advice_to_json(const std::optional<AdviceVerdict>& advice) {
  if (!advice) return nullptr;
  Json json = {{"of", advice->of},
               {"lack", advice->lack},
               {"metrics", numbers_by_name(advice->metrics)},
               {"trials", Json::array()}};
  for (const AdviceTrial& trial : advice->trials) json["trials"].push_back(trial_to_json(trial));
  return json;
}

/// What was run, so that others can tell whether theirs is like it: the scene or the element test as written and,
/// where advice can be drawn from it, what makes the trades.
void add_texts(const Case& definition, Json& json) {
  for (const char* subject : {"scene", "element"})
    if (definition.text.contains(subject)) json[subject] = definition.text[subject];
  if (definition.trades.empty()) return;
  json["definition"] = Json::object();
  for (const std::string& key : defining_keys())
    if (definition.text.contains(key)) json["definition"][key] = definition.text[key];
}

Json case_to_json(const CaseVerdict& verdict) {
  Json json = {{"id", verdict.definition.id},
               {"title", verdict.definition.title},
               {"figure_of_paper", verdict.definition.figure_of_paper},
               {"status", name_of(verdict.status)},
               {"not_run_reason", verdict.not_run_reason},
               {"curve_files", curve_files_to_json(verdict.definition)},
               {"runs", Json::array()},
               {"series", Json::array()},
               {"pairs", pairs_to_json(verdict.pairs)},
               {"trades", trades_to_json(verdict)},
               {"advice", advice_to_json(verdict.advice)},
               {"rounding", rounding_to_json(verdict.rounding)},
               {"gates", gates_to_json(verdict.gates)}};
  add_texts(verdict.definition, json);
  for (const RunVerdict& run : verdict.runs) json["runs"].push_back(run_to_json(run));
  for (const SeriesVerdict& series : verdict.series) json["series"].push_back(series_to_json(series));
  return json;
}

Json counts_to_json(const Counts& counts) {
  return {{"cases", counts.cases},
          {"cases_passed", counts.cases_passed},
          {"cases_failed", counts.cases_failed},
          {"cases_not_run", counts.cases_not_run},
          {"runs", counts.runs},
          {"gates", counts.gates},
          {"gates_passed", counts.gates_passed},
          {"gates_failed", counts.gates_failed},
          {"gates_waiting", counts.gates_waiting},
          {"controls", counts.controls},
          {"controls_red", counts.controls_red},
          {"controls_green", counts.controls_green}};
}

/// "cell size" of "/scene/grid/cell_size".
std::string last_name_of(const std::string& pointer) {
  std::string name = pointer.substr(pointer.rfind('/') + 1);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_object()) {
    for (const char* key : {"law", "type", "name"}) {
      if (value.contains(key) && value[key].is_string()) return value[key].get<std::string>();
    }
  }
  return value.dump();
}

std::string scope_of(const std::string& pointer, const Json& value) {
  const std::string text = text_of(value);
  if (!pointer.starts_with('/')) return text;  // a variant has a name of its own
  if (pointer == "/scene/gravity/level") return text + "G";
  if (pointer == "/scene/grid/cell_size") return "h " + text;
  if (pointer.ends_with("/youngs_modulus")) return "E " + text;
  if (pointer.ends_with("/constrains") && value.is_array()) return value.size() > 1 ? "rough" : "smooth";
  const bool speaks_for_itself = value.is_string() && text.find_first_of("0123456789") == std::string::npos;
  return speaks_for_itself || value.is_object() ? text : last_name_of(pointer) + " " + text;
}

void count(const GateResult& gate, Counts& counts) {
  if (gate.waits()) {
    ++counts.gates;
    ++counts.gates_waiting;
  } else if (gate.must_fail) {
    ++counts.controls;
    ++(gate.good() ? counts.controls_red : counts.controls_green);
  } else {
    ++counts.gates;
    ++(gate.good() ? counts.gates_passed : counts.gates_failed);
  }
}

}  // namespace

const char* name_of(GateStatus status) {
  switch (status) {
    case GateStatus::pass:
      return "pass";
    case GateStatus::fail:
      return "fail";
    case GateStatus::red_as_expected:
      return "red_as_expected";
    case GateStatus::unexpectedly_green:
      return "unexpectedly_green";
    case GateStatus::no_measurement:
      return "no_measurement";
  }
  return "fail";
}

const char* name_of(CaseStatus status) {
  switch (status) {
    case CaseStatus::pass:
      return "pass";
    case CaseStatus::fail:
      return "fail";
    case CaseStatus::not_run:
      return "not_run";
  }
  return "fail";
}

std::string scope_of(const std::vector<std::pair<std::string, Json>>& parameters) {
  std::string scope;
  for (const auto& [pointer, value] : parameters) {
    if (!scope.empty()) scope += ", ";
    scope += scope_of(pointer, value);
  }
  return scope.empty() ? "the run" : scope;
}

double margin(const GateResult& result) {
  if (result.threshold == 0.0 || result.op == "is") return std::numeric_limits<double>::quiet_NaN();
  const double room = result.op == "<=" ? result.threshold - result.value : result.value - result.threshold;
  return room / std::abs(result.threshold);
}

std::vector<const GateResult*> gate_results(const CaseVerdict& verdict) {
  std::vector<const GateResult*> results;
  const auto add = [&](const std::vector<GateResult>& gates) {
    for (const GateResult& gate : gates) results.push_back(&gate);
  };
  for (const RunVerdict& run : verdict.runs) add(run.gates);
  for (const SeriesVerdict& series : verdict.series) add(series.gates);
  add(verdict.gates);
  return results;
}

Counts CampaignVerdict::counts() const {
  Counts counts;
  for (const CaseVerdict& verdict : cases) {
    ++counts.cases;
    switch (verdict.status) {
      case CaseStatus::pass:
        ++counts.cases_passed;
        break;
      case CaseStatus::fail:
        ++counts.cases_failed;
        break;
      case CaseStatus::not_run:
        ++counts.cases_not_run;
        break;
    }
    counts.runs += static_cast<int>(verdict.runs.size());
    for (const GateResult* gate : gate_results(verdict)) count(*gate, counts);
  }
  return counts;
}

bool CampaignVerdict::passed() const {
  const Counts counted = counts();
  return !failed() && counted.cases_not_run == 0;
}

bool CampaignVerdict::failed() const {
  const Counts counted = counts();
  return counted.cases_passed == 0 || counted.cases_failed > 0 || counted.gates_failed > 0 ||
         counted.controls_green > 0;
}

Json to_json(const CampaignVerdict& verdict) {
  Json json = {{"schema", results_schema},
               {"revision", verdict.revision},
               {"host", verdict.host},
               {"counts", counts_to_json(verdict.counts())},
               {"date", verdict.date},
               {"processor", verdict.processor},
               {"compiler", verdict.compiler},
               {"build", verdict.build},
               {"threads", verdict.threads},
               {"quick", verdict.quick},
               {"passed", verdict.passed()},
               {"reused", verdict.reused},
               {"wall_seconds", number(verdict.wall_seconds)},
               {"timing_seconds", number(verdict.timing_seconds)},
               {"cases", Json::array()}};
  for (const CaseVerdict& case_verdict : verdict.cases) json["cases"].push_back(case_to_json(case_verdict));
  return json;
}

}  // namespace mpm::vv
