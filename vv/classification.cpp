#include "vv/classification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>



namespace mpm::vv {
namespace {

constexpr std::array classes{StabilityClass::accurate,    StabilityClass::inaccurate, StabilityClass::drifting,
                             StabilityClass::oscillating, StabilityClass::diverged,   StabilityClass::refused};

bool is_refused(const Record& record) { return record.failure.starts_with(refused_prefix); }

/// A numerical failure, or no result at all. A deadline that came first is neither: what still moves shows in the
/// signal.
bool has_failed(const Record& record) { return !record.failure.empty() || record.outcome.particle >= 0; }

QuantityKind kind_of(const HistoryProbe& probe, const JsonPlace& place) {
  if (probe.quantity == "displacement") return QuantityKind::length;
  if (probe.quantity == "velocity") return QuantityKind::velocity;
  if (probe.quantity == "stress") return QuantityKind::pressure;
  place.refuse("no scale of a probe of " + probe.quantity + ", whose largest magnitude it is");
}

double read_limit(const JsonPlace& place, double otherwise) {
  if (!place.present()) return otherwise;
  const double limit = place.number();
  if (!(limit > 0.0)) place.refuse("a limit above zero");
  return limit;
}

BehaviourLimits read_limits(const JsonPlace& place) {
  BehaviourLimits limits;
  if (!place.present()) return limits;
  place.allow_only({"drift", "ringing", "zigzag", "error"});
  limits.drift = read_limit(place["drift"], limits.drift);
  limits.ringing = read_limit(place["ringing"], limits.ringing);
  limits.zigzag = read_limit(place["zigzag"], limits.zigzag);
  limits.error = read_limit(place["error"], limits.error);
  return limits;
}

double largest_magnitude(const std::vector<double>& values) {
  double largest = 0.0;
  for (double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

const History& history_of(const Case& definition, const Record& record) {
  const auto probe = std::find_if(definition.probes.begin(), definition.probes.end(), [&](const HistoryProbe& each) {
    return each.id == definition.classification->probe;
  });
  return record.histories.at(static_cast<std::size_t>(probe - definition.probes.begin()));
}

/// Throws std::invalid_argument if the window holds too few samples.
SignalShape shape_of(const Classification& asked, const History& history) {
  const double scale = asked.scale > 0.0 ? asked.scale : largest_magnitude(history.value);
  if (scale == 0.0) return {};  // it never moved
  return shape_of_signal(history.time, history.value, asked.from, scale);
}

double zigzag_of(const RunVerdict& run, double reach) {
  const Profile& profile = run.record.profile;
  return zigzag_of_field(profile.position, profile.stress, profile.volume, reach);
}

/// Why a complete run has no class; empty if it has one.
std::string observe(const Case& definition, const Scene& scene, RunVerdict& run) {
  const Classification& asked = *definition.classification;
  Behaviour& behaviour = run.behaviour;
  behaviour.refused = is_refused(run.record);
  behaviour.failed = has_failed(run.record);
  if (behaviour.refused || behaviour.failed) return "";
  try {
    if (!asked.probe.empty()) behaviour.signal = shape_of(asked, history_of(definition, run.record));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  if (asked.stress) behaviour.zigzag = zigzag_of(run, 1.5 * scene.cell_size);
  if (asked.error.empty()) return "";
  const auto error = run.metrics.find(asked.error);
  if (error == run.metrics.end()) return ending_of(run.record) + ", " + asked.error + " was not measured";
  behaviour.error = error->second;
  return "";
}

const Scene& scene_of(const Case& definition, const RunVerdict& run) {
  const auto request = std::find_if(definition.runs.begin(), definition.runs.end(),
                                    [&](const RunRequest& each) { return each.parameters == run.parameters; });
  return request->scene;
}

std::string listed(const std::vector<StabilityClass>& wanted) {
  std::string text;
  for (std::size_t k = 0; k < wanted.size(); ++k) text += (k > 0 ? " or " : "") + std::string(name_of(wanted[k]));
  return text;
}

std::string beyond(const char* name, double measure, double limit) {
  return measure > limit ? fmt::format(", {} {:.3g} (limit {:.3g})", name, measure, limit) : "";
}

}  // namespace

std::optional<Classification> read_classification(
    const JsonPlace& place, const Case& read, const std::function<std::string(const JsonPlace&)>& read_metric) {
  if (!place.present()) return std::nullopt;
  place.allow_only({"probe", "from", "scale", "stress", "error", "limits"});
  Classification asked;
  if (const JsonPlace probe = place["probe"]; probe.present()) {
    std::vector<std::string> ids;
    for (const HistoryProbe& each : read.probes) ids.push_back(each.id);
    if (ids.empty()) probe.refuse("a probe of the case, which has none");
    asked.probe = probe.one_of(ids);
    asked.from = place["from"].quantity(QuantityKind::time);
    const auto& known = *std::find_if(read.probes.begin(), read.probes.end(),
                                      [&](const HistoryProbe& each) { return each.id == asked.probe; });
    if (const JsonPlace scale = place["scale"]; scale.present()) {
      asked.scale = scale.quantity(kind_of(known, scale));
      if (!(asked.scale > 0.0)) scale.refuse("a scale above zero");
    }
  } else {
    for (const char* key : {"from", "scale"}) {
      if (place[key].present()) place[key].refuse("no such key without a probe");
    }
  }
  asked.stress = place["stress"].flag_or(false);
  for (const RunRequest& run : read.runs) {
    if (asked.stress && run.scene.dimension != 1)
      place["stress"].refuse("false in two dimensions, where no line of particles is there to alternate");
  }
  if (const JsonPlace error = place["error"]; error.present()) asked.error = read_metric(error);
  asked.limits = read_limits(place["limits"]);
  return asked;
}

std::vector<StabilityClass> read_classes(const JsonPlace& place) {
  std::vector<std::string> names;
  for (const StabilityClass each : classes) names.emplace_back(name_of(each));
  std::vector<StabilityClass> wanted;
  for (const JsonPlace& element : place.some_elements()) {
    const std::string name = element.one_of(names);
    const StabilityClass each = classes[static_cast<std::size_t>(
        std::find(names.begin(), names.end(), name) - names.begin())];
    if (std::find(wanted.begin(), wanted.end(), each) != wanted.end()) element.refuse("each class once", " again");
    wanted.push_back(each);
  }
  return wanted;
}

const std::vector<Metric>& classification_catalogue() {
  static const std::vector<Metric> catalogue = {
      {class_metric, "-", "", "class of a run, in a case with a classification; its gates name classes"},
      {"class.drift", "-", "", "change of the signal over its window along the straight line through it, over its scale"},
      {"class.ringing", "-", "", "root mean square of the signal about that line without single spikes, over its scale"},
      {"class.spike", "-", "", "largest distance of a single sample from the range of its neighbours, over the scale"},
      {"class.zigzag", "-", "", "stress less its local straight lines, over the stress: L2, volume weighted"}};
  return catalogue;
}

void classify(const Case& definition, RunVerdict& run) {
  if (!definition.classification || definition.survey) return;
  if (!observe(definition, scene_of(definition, run), run).empty()) return;
  run.stability = class_of(run.behaviour, definition.classification->limits);
  run.metrics[class_metric] = static_cast<double>(*run.stability);
  if (run.behaviour.refused || run.behaviour.failed) return;
  const SignalShape& signal = run.behaviour.signal;
  const std::pair<const char*, double> measures[] = {{"class.drift", signal.drift},
                                                     {"class.ringing", signal.ringing},
                                                     {"class.spike", signal.spike},
                                                     {"class.zigzag", run.behaviour.zigzag}};
  for (const auto& [name, value] : measures) {
    if (std::isfinite(value)) run.metrics[name] = value;
  }
}

std::string diagnosis_of(const Case& definition, const RunVerdict& run) {
  if (!run.stability) {
    RunVerdict again = run;
    return "no class: " + observe(definition, scene_of(definition, run), again);
  }
  std::string text = name_of(*run.stability);
  if (run.behaviour.refused) return text + ": " + run.record.failure.substr(refused_prefix.size());
  if (run.behaviour.failed) return text + ": " + ending_of(run.record);
  const BehaviourLimits& limits = definition.classification->limits;
  const Behaviour& seen = run.behaviour;
  std::string measures = beyond("drift", seen.signal.drift, limits.drift) +
                         beyond("ringing", seen.signal.ringing, limits.ringing) +
                         beyond("zig-zag", seen.zigzag, limits.zigzag) + beyond("error", seen.error, limits.error);
  return measures.empty() ? text : text + ": " + measures.substr(2);
}

GateResult class_result(const Case& definition, const Gate& gate, const RunVerdict& run) {
  const bool expected = run.stability && std::find(gate.classes.begin(), gate.classes.end(), *run.stability) !=
                                             gate.classes.end();
  return {.id = gate.id,
          .metric = gate.metric,
          .statistic = "value",
          .basis = gate.basis,
          .reason = gate.reason,
          .scope = scope_of(run.parameters),
          .value = run.stability ? static_cast<double>(*run.stability) : std::numeric_limits<double>::quiet_NaN(),
          .op = "is",
          .threshold = static_cast<double>(*std::max_element(gate.classes.begin(), gate.classes.end())),
          .status = expected ? GateStatus::pass : GateStatus::fail,
          .detail = diagnosis_of(definition, run),
          .found = run.stability ? name_of(*run.stability) : "",
          .expected = listed(gate.classes),
          .advice = gate.advice};
}

}  // namespace mpm::vv
