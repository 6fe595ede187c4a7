#include "vv/record.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <limits>
#include <numeric>
#include <system_error>

#include "vv/linear_stability.hpp"
#include "vv/metamorphic.hpp"
#include "vv/precision_pilots.hpp"
#include "vv/sampler.hpp"
#include "vv/sufficient_model.hpp"
#include "vv/survey_runs.hpp"

namespace mpm::vv {
namespace {

constexpr const char* record_schema = "mpmvv-record/3";
constexpr std::int64_t particle_steps_per_pulse = 1
                                                  << 16;  // a few milliseconds: prompt, yet too rare to cost

/// The component of a vector or stress that one-number profiles and probes hold: the one along the last axis,
/// upwards. The first stress components are the normal ones, so their number is the axis too.
std::size_t along_column(const ParticleFields& fields) {
  return static_cast<std::size_t>(fields.dimension) - 1;
}

class Fnv1a {
 public:
  void add_byte(unsigned char byte) { state_ = (state_ ^ byte) * 0x100000001b3u; }
  void add(std::uint64_t word) {
    for (int shift = 0; shift < 64; shift += 8) add_byte(static_cast<unsigned char>(word >> shift));
  }
  void add(const std::vector<double>& values) {
    add(values.size());
    for (double value : values) add(std::bit_cast<std::uint64_t>(value));
  }
  void add(const char* text, std::size_t length) {
    for (std::size_t i = 0; i < length; ++i) add_byte(static_cast<unsigned char>(text[i]));
  }
  std::string digits() const { return fmt::format("{:016x}", state_); }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

// ---- JSON ----

Json number(double value) {
  if (std::isfinite(value)) return value;
  if (std::isnan(value)) return "nan";
  return value > 0 ? "inf" : "-inf";
}

double number_from(const Json& json) {
  if (json.is_number()) return json.get<double>();
  const auto text = json.get<std::string>();
  if (text == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (text == "inf") return std::numeric_limits<double>::infinity();
  if (text == "-inf") return -std::numeric_limits<double>::infinity();
  throw std::runtime_error("not a number: " + text);
}

Json numbers(const std::vector<double>& values) {
  Json json = Json::array();
  for (double value : values) json.push_back(number(value));
  return json;
}

std::vector<double> numbers_from(const Json& json) {
  if (!json.is_array()) throw std::runtime_error("not an array of numbers");
  std::vector<double> values;
  values.reserve(json.size());
  for (const Json& entry : json) values.push_back(number_from(entry));
  return values;
}

Ending ending_from(const std::string& name) {
  for (Ending ending : {Ending::reached_time, Ending::at_rest, Ending::not_at_rest,
                        Ending::reached_displacement, Ending::not_reached, Ending::not_finite, Ending::inverted, Ending::outside_grid, Ending::gained_energy, Ending::domain_too_large}) {
    if (name == name_of(ending)) return ending;
  }
  throw std::runtime_error("unknown ending: " + name);
}

/// The fields of a profile and their names, once for both directions.
template <class ProfileType, class Visit>
void for_each_field(ProfileType& profile, Visit visit) {
  visit("initial_position", profile.initial_position);
  visit("displacement", profile.displacement);
  visit("position", profile.position);
  visit("stress", profile.stress);
  visit("volume", profile.volume);
  visit("initial_volume", profile.initial_volume);
  visit("mass", profile.mass);
  visit("half_size", profile.half_size);
}

Json profile_to_json(const Profile& profile) {
  Json json = Json::object();
  for_each_field(profile, [&](const char* name, const auto& values) { json[name] = numbers(values); });
  return json;
}

Profile profile_from_json(const Json& json) {
  Profile profile;
  for_each_field(profile, [&](const char* name, auto& values) {
    values = numbers_from(json.at(name));
    if (values.size() != profile.initial_position.size())
      throw std::runtime_error("profile of unequal lengths");
  });
  return profile;
}

Json paths_to_json(const std::vector<ElementCurve>& paths) {
  Json json = Json::array();
  for (const ElementCurve& path : paths)
    json.push_back({{"id", path.id}, {"strain", numbers(path.strain)}, {"value", numbers(path.value)}});
  return json;
}

std::vector<ElementCurve> paths_from_json(const Json& json) {
  std::vector<ElementCurve> paths;
  for (const Json& entry : json) {
    paths.push_back({.id = entry.at("id").get<std::string>(),
                     .strain = numbers_from(entry.at("strain")),
                     .value = numbers_from(entry.at("value"))});
    if (paths.back().strain.size() != paths.back().value.size())
      throw std::runtime_error("path of unequal lengths");
  }
  return paths;
}

Json measured_to_json(const std::map<std::string, double>& measured) {
  Json json = Json::object();
  for (const auto& [name, value] : measured) json[name] = number(value);
  return json;
}

std::map<std::string, double> measured_from_json(const Json& json) {
  std::map<std::string, double> measured;
  for (const auto& [name, value] : json.items()) measured[name] = number_from(value);
  return measured;
}

std::vector<ModelChoice> model_from_json(const Json& json) {
  std::vector<ModelChoice> model;
  for (const Json& entry : json) {
    model.push_back({.what = entry.at("what").get<std::string>(),
                     .written = entry.at("written").get<std::string>(),
                     .used = entry.at("used").get<std::string>(),
                     .reason = entry.at("reason").get<std::string>(),
                     .numbers = measured_from_json(entry.at("numbers"))});
  }
  return model;
}

Json outcome_to_json(const Outcome& outcome) {
  return {{"ending", name_of(outcome.ending)},
          {"step", outcome.step},
          {"time", number(outcome.time)},
          {"particle", outcome.particle},
          {"value", number(outcome.value)}};
}

Outcome outcome_from_json(const Json& json) {
  return {.ending = ending_from(json.at("ending").get<std::string>()),
          .step = json.at("step").get<std::int64_t>(),
          .time = number_from(json.at("time")),
          .particle = json.at("particle").get<std::int64_t>(),
          .value = number_from(json.at("value"))};
}

Json histories_to_json(const std::vector<History>& histories) {
  Json json = Json::array();
  for (const History& history : histories) {
    json.push_back({{"id", history.id},
                    {"quantity", history.quantity},
                    {"time", numbers(history.time)},
                    {"value", numbers(history.value)}});
  }
  return json;
}

std::vector<History> histories_from_json(const Json& json) {
  std::vector<History> histories;
  for (const Json& entry : json) {
    histories.push_back({.id = entry.at("id").get<std::string>(),
                         .quantity = entry.at("quantity").get<std::string>(),
                         .time = numbers_from(entry.at("time")),
                         .value = numbers_from(entry.at("value"))});
    if (histories.back().time.size() != histories.back().value.size()) {
      throw std::runtime_error("history of unequal lengths");
    }
  }
  return histories;
}

// ---- snapshots ----

/// The double nearest to `value` written with nine significant digits, which is written out no longer than
/// that.
double rounded(double value) {
  if (!std::isfinite(value)) return value;
  std::array<char, 32> text;
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 8).ptr;
  std::from_chars(text.data(), end, value);
  return value;
}

std::vector<double> rounded(std::vector<double> values) {
  for (double& value : values) value = rounded(value);
  return values;
}

/// The fields of the particles, their names, and how many entries a particle has in each (where it has any),
/// once for both directions and for the digest.
template <class Fields, class Visit>
void for_each_particle_field(Fields& fields, Visit visit) {
  const auto dimension = static_cast<std::size_t>(fields.dimension);
  const std::size_t components = dimension == 1 ? 1 : 4;
  visit("initial_position", fields.initial_position, dimension);
  visit("displacement", fields.displacement, dimension);
  visit("position", fields.position, dimension);
  visit("velocity", fields.velocity, dimension);
  visit("half_size", fields.half_size, dimension);
  visit("stress", fields.stress, components);
  visit("volume", fields.volume, std::size_t{1});
  visit("initial_volume", fields.initial_volume, std::size_t{1});
  visit("mass", fields.mass, std::size_t{1});
  visit("strain", fields.strain, components);
  visit("stress_work", fields.stress_work, std::size_t{1});
  visit("deformation_gradient", fields.deformation_gradient, dimension * dimension);
}

ParticleFields rounded(ParticleFields fields) {
  for_each_particle_field(fields, [](const char*, std::vector<double>& values, std::size_t) {
    values = rounded(std::move(values));
  });
  return fields;
}

Json fields_to_json(const ParticleFields& fields) {
  Json json = {{"dimension", fields.dimension}, {"body", fields.body}};
  for_each_particle_field(fields, [&](const char* name, const std::vector<double>& values, std::size_t) {
    json[name] = numbers(rounded(values));
  });
  return json;
}

ParticleFields fields_from_json(const Json& json) {
  ParticleFields fields;
  fields.dimension = json.at("dimension").get<int>();
  fields.body = json.at("body").get<std::vector<std::size_t>>();
  if (fields.dimension < 1 || fields.dimension > max_dimension) {
    throw std::runtime_error("a snapshot of unknown dimension");
  }
  for_each_particle_field(fields, [&](const char* name, std::vector<double>& values, std::size_t entries) {
    values = numbers_from(json.at(name));
    const bool optional = &values == &fields.strain || &values == &fields.stress_work ||
                          &values == &fields.deformation_gradient;
    if (values.size() != fields.body.size() * entries && !(optional && values.empty())) {
      throw std::runtime_error("snapshot of unequal lengths");
    }
  });
  return fields;
}

Json snapshots_to_json(const std::vector<Snapshot>& snapshots) {
  Json json = Json::array();
  for (const Snapshot& snapshot : snapshots) {
    json.push_back({{"moment", snapshot.moment},
                    {"time", number(snapshot.time)},
                    {"fields", fields_to_json(snapshot.fields)}});
  }
  return json;
}

std::vector<Snapshot> snapshots_from_json(const Json& json) {
  if (!json.is_array()) throw std::runtime_error("not an array of snapshots");
  std::vector<Snapshot> snapshots;
  for (const Json& entry : json) {
    snapshots.push_back({.moment = entry.at("moment").get<std::string>(),
                         .time = number_from(entry.at("time")),
                         .fields = fields_from_json(entry.at("fields"))});
  }
  return snapshots;
}

// ---- surveys ----

StabilityClass stability_from(const std::string& name) {
  for (const StabilityClass stability :
       {StabilityClass::accurate, StabilityClass::inaccurate, StabilityClass::drifting, StabilityClass::oscillating,
        StabilityClass::diverged, StabilityClass::refused}) {
    if (name == name_of(stability)) return stability;
  }
  throw std::runtime_error("unknown class: " + name);
}

Json survey_point_to_json(const SurveyPoint& point) {
  return {{"fraction", number(point.fraction)}, {"class", name_of(point.stability)},
          {"outcome", outcome_to_json(point.outcome)}, {"reason", point.reason},
          {"drift", number(point.signal.drift)}, {"ringing", number(point.signal.ringing)},
          {"spike", number(point.signal.spike)}, {"zigzag", number(point.zigzag)}, {"error", number(point.error)}};
}

SurveyPoint survey_point_from_json(const Json& json) {
  SurveyPoint point;
  point.fraction = number_from(json.at("fraction"));
  point.stability = stability_from(json.at("class").get<std::string>());
  point.outcome = outcome_from_json(json.at("outcome"));
  point.reason = json.at("reason").get<std::string>();
  point.signal = {number_from(json.at("drift")), number_from(json.at("ringing")), number_from(json.at("spike"))};
  point.zigzag = number_from(json.at("zigzag"));
  point.error = number_from(json.at("error"));
  return point;
}

Json survey_to_json(const Survey& survey) {
  Json json = {{"own", number(survey.own)},
               {"linear",
                {{"limit", number(survey.linear.limit)},
                 {"unknowns", survey.linear.unknowns},
                 {"fraction", numbers(survey.linear.fraction)},
                 {"radius", numbers(survey.linear.radius)},
                 {"lack", survey.linear.lack}}},
               {"points", Json::array()},
               {"stable", number(survey.stable)},
               {"unstable", number(survey.unstable)},
               {"accurate", number(survey.accurate)},
               {"error_name", survey.error_name}};
  for (const SurveyPoint& point : survey.points) json["points"].push_back(survey_point_to_json(point));
  return json;
}

Survey survey_from_json(const Json& json) {
  const Json& linear = json.at("linear");
  Survey survey;
  survey.own = number_from(json.at("own"));
  survey.linear = {.limit = number_from(linear.at("limit")),
                   .unknowns = linear.at("unknowns").get<std::int64_t>(),
                   .fraction = numbers_from(linear.at("fraction")),
                   .radius = numbers_from(linear.at("radius")),
                   .lack = linear.at("lack").get<std::string>()};
  for (const Json& point : json.at("points")) survey.points.push_back(survey_point_from_json(point));
  survey.stable = number_from(json.at("stable"));
  survey.unstable = number_from(json.at("unstable"));
  survey.accurate = number_from(json.at("accurate"));
  survey.error_name = json.at("error_name").get<std::string>();
  return survey;
}

/// Whether the last of the values is the first to reach `value` or to lie beyond it, seen from the first.
bool has_passed(const std::vector<double>& values, double value) {
  const double from = values.front() - value, to = values.back() - value;
  return to == 0.0 || (from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0);
}

// ---- run ----

/// One component of every particle, from a field stored particle by particle.
std::vector<double> component_of(const std::vector<double>& field, std::size_t particles,
                                 std::size_t component) {
  const std::size_t stride = particles == 0 ? 1 : field.size() / particles;
  std::vector<double> values(particles);
  for (std::size_t p = 0; p < particles; ++p) values[p] = field[p * stride + component];
  return values;
}

/// Steps a simulation to its end, with its probes and snapshots, and measures what the steps cost.
class Recorder {
 public:
  Recorder(const Case& definition, const RunRequest& request, const Pulse& pulse)
      : scene_(request.scene),
        simulation_(request.scene, request.threads),
        pulse_(pulse),
        start_(simulation_.particles()),
        pending_(definition.snapshots) {
    const Observation now(simulation_);
    for (const HistoryProbe& probe : definition.probes) {
      const SimulatedProbe seen = simulated(probe, request);
      samplers_.emplace_back(seen.probe, scene_, now, seen.factor);
    }
    for (Sampler& sampler : samplers_) sampler.sample(now, simulation_.time_step());
    take_snapshots(now);
  }

  Record run() {
    const std::int64_t steps_per_pulse = std::max<std::int64_t>(
        1, particle_steps_per_pulse / std::max<std::int64_t>(1, simulation_.particle_count()));
    while (advance(steps_per_pulse)) {
      observe();
      keep_good_state();
      beat();
    }
    beat();
    return result();
  }

  ParticleFields particles() const { return simulation_.particles(); }

 private:
  using Clock = std::chrono::steady_clock;

  /// Steps until a probe or snapshot is due, a pulse is, or the run has ended (then false). The clock runs
  /// only here.
  bool advance(std::int64_t most_steps) {
    const auto began = Clock::now();
    bool going_on = true;
    for (std::int64_t step = 0; step < most_steps && going_on && !something_is_due(); ++step) {
      going_on = simulation_.advance();
      if (is_time_to_keep_state(simulation_.steps())) break;
    }
    wall_ += Clock::now() - began;
    if (early_wall_ < early) {
      early_wall_ = wall_;
      early_steps_ = simulation_.steps();
    }
    return going_on;
  }

  /// Often at first, when a run goes wrong at once; later so rarely that keeping the state costs nothing to speak of.
  static bool is_time_to_keep_state(std::int64_t step) {
    constexpr std::int64_t first = 64, regularly = 2048;
    return step % regularly == 0 || (step < regularly && step >= first && (step & (step - 1)) == 0);
  }

  /// A state counts as good as long as no energy has come from nowhere. A tenth is left to schemes that let it swing about
  /// its value.
  void keep_good_state() {
    if (!is_time_to_keep_state(simulation_.steps()) || good_step_ == simulation_.steps()) return;
    constexpr double largest_ratio = 1.1;
    if (!(simulation_.monitor().energy_ratio <= largest_ratio)) return;
    good_state_ = simulation_.particles();
    good_step_ = simulation_.steps();
  }

  bool is_due(const Sampler& sampler) const {
    return sampler.due(simulation_.time(), simulation_.time_step());
  }

  bool is_due(const SnapshotRequest& snapshot) const {
    // The slack is for the rounding of the time, a product of step and time step.
    return snapshot.when == SnapshotRequest::When::time &&
           simulation_.time() >= snapshot.time - 1e-6 * simulation_.time_step();
  }

  bool something_is_due() const {
    const auto due = [&](const auto& each) { return is_due(each); };
    return std::any_of(samplers_.begin(), samplers_.end(), due) ||
           std::any_of(pending_.begin(), pending_.end(), due);
  }

  void observe() {
    if (!something_is_due()) return;
    const Observation now(simulation_);
    for (Sampler& sampler : samplers_) {
      if (is_due(sampler)) sampler.sample(now, simulation_.time_step());
    }
    take_snapshots(now);
  }

  bool has_passed_probe(const SnapshotRequest& request) const {
    if (request.when != SnapshotRequest::When::passing) return false;
    const auto sampler = std::find_if(samplers_.begin(), samplers_.end(),
                                      [&](const Sampler& s) { return s.history().id == request.probe; });
    if (sampler == samplers_.end())
      throw std::invalid_argument("a snapshot waits for a probe there is not: '" + request.probe + "'");
    return has_passed(sampler->history().value, request.value);
  }

  void take(const SnapshotRequest& request, const Observation& now) {
    // Rounded here, so that a record judges the same before and after it has been stored.
    snapshots_.push_back({moment_of(request), now.time(), rounded(now.particles())});
  }

  void take_snapshots(const Observation& now) {
    std::erase_if(pending_, [&](const SnapshotRequest& request) {
      if (!is_due(request) && !has_passed_probe(request)) return false;
      take(request, now);
      return true;
    });
  }

  /// The moments left that the end is one of: itself, and a time that the last step is the nearest to.
  void take_last_snapshots(const Observation& now) {
    take_snapshots(now);
    for (const SnapshotRequest& request : pending_) {
      const bool reached = request.when == SnapshotRequest::When::time &&
                           request.time <= now.time() + 0.5 * simulation_.time_step();
      if (reached || request.when == SnapshotRequest::When::end) take(request, now);
    }
  }

  void beat() {
    const std::int64_t fresh = simulation_.steps() - reported_steps_;
    reported_steps_ = simulation_.steps();
    if (pulse_ && !pulse_(fresh * simulation_.particle_count())) throw Abandoned();
  }

  Record result() {
    const Observation now(simulation_);
    const ParticleFields& end = now.particles();
    Record record;
    record.outcome = simulation_.outcome();
    record.time_step = simulation_.time_step();
    record.end_time = simulation_.time();
    record.unbalanced_force_ratio = simulation_.monitor().unbalanced_force_ratio;
    record.kinetic_energy_ratio = simulation_.monitor().kinetic_energy_ratio;
    record.cell_crossings = simulation_.cell_crossings();
    record.relative_mass_change = mass_change(end);
    record.profile = profile_of(end);
    // A broken state may have no number left to sample; how it broke is told apart from the histories.
    const bool broken = record.outcome.particle >= 0;
    for (Sampler& sampler : samplers_) sampler.sample(now, simulation_.time_step(), !broken);
    take_last_snapshots(now);
    record.snapshots = std::move(snapshots_);
    for (Sampler& sampler : samplers_) record.histories.push_back(std::move(sampler).history());
    record.non_finite_values = non_finite_values_of(end);
    record.digest = digest_of(end, record);
    record.largest_energy_ratio = simulation_.monitor().largest_energy_ratio;
    if (record.outcome.particle >= 0) record.last_good = last_good_state();
    record.cost = {.wall_seconds = std::chrono::duration<double>(wall_).count(),
                   .steps = simulation_.steps(),
                   .particle_steps = simulation_.steps() * simulation_.particle_count(),
                   .memory_bytes = simulation_.memory(),
                   .early_seconds = std::chrono::duration<double>(early_wall_).count(),
                   .early_steps = early_steps_};
    return record;
  }

  Snapshot last_good_state() const {
    const ParticleFields& fields = good_step_ > 0 ? good_state_ : start_;
    return {fmt::format("last good state, step {}", good_step_),
            static_cast<double>(good_step_) * simulation_.time_step(), rounded(fields)};
  }

  /// The factor by which a ramp has changed a body's mass. The particles carry the density of the last
  /// step's beginning.
  double growth_of(const Body& body) const {
    if (!body.density_ramp || body.inertia || simulation_.steps() == 0) return 1.0;
    const double time = static_cast<double>(simulation_.steps() - 1) * simulation_.time_step();
    return body.density_at(time) / body.density;
  }

  /// Against what the density ramps have made of the mass at the start.
  double mass_change(const ParticleFields& end) const {
    double expected = 0.0;
    for (std::size_t p = 0; p < start_.mass.size(); ++p) {
      expected += start_.mass[p] * growth_of(scene_.bodies[start_.body[p]]);
    }
    const double found = std::accumulate(end.mass.begin(), end.mass.end(), 0.0);
    return (found - expected) / expected;
  }

  static Profile profile_of(const ParticleFields& fields) {
    const std::size_t particles = fields.mass.size(), axis = along_column(fields);
    return {.initial_position = component_of(fields.initial_position, particles, axis),
            .displacement = component_of(fields.displacement, particles, axis),
            .position = component_of(fields.position, particles, axis),
            .stress = component_of(fields.stress, particles, axis),
            .volume = fields.volume,
            .initial_volume = fields.initial_volume,
            .mass = fields.mass,
            .half_size = component_of(fields.half_size, particles, axis)};
  }

  static std::int64_t non_finite_values_of(const ParticleFields& fields) {
    std::int64_t count = 0;
    for (const auto* field :
         {&fields.displacement, &fields.position, &fields.velocity, &fields.half_size, &fields.stress,
          &fields.volume, &fields.mass, &fields.strain, &fields.stress_work, &fields.deformation_gradient}) {
      count +=
          std::count_if(field->begin(), field->end(), [](double value) { return !std::isfinite(value); });
    }
    return count;
  }

  static std::string digest_of(const ParticleFields& fields, const Record& record) {
    Fnv1a hash;
    for (const auto* field :
         {&fields.initial_position, &fields.displacement, &fields.position, &fields.velocity,
          &fields.half_size, &fields.stress, &fields.volume, &fields.initial_volume, &fields.mass}) {
      hash.add(*field);
    }
    for (const History& history : record.histories) {
      hash.add(history.time);
      hash.add(history.value);
    }
    hash.add(static_cast<std::uint64_t>(record.outcome.step));
    return hash.digits();
  }

  const Scene& scene_;
  Simulation simulation_;
  const Pulse& pulse_;
  ParticleFields start_, good_state_;
  std::int64_t good_step_ = 0;
  std::vector<Sampler> samplers_;
  std::vector<SnapshotRequest> pending_;
  std::vector<Snapshot> snapshots_;
  /// After which steps are no longer early; see `Cost`.
  static constexpr auto early = std::chrono::milliseconds(150);

  Clock::duration wall_{}, early_wall_{};
  std::int64_t early_steps_ = 0;
  std::int64_t reported_steps_ = 0;
};

/// What a probe is told apart by. What has its default is left out.
Json essence_of(const HistoryProbe& probe, const Scene& scene) {
  Json json = {{"id", probe.id}, {"quantity", probe.quantity}, {"at", probe.at}, {"every", probe.every}};
  const std::string along_last = scene.dimension == 1 ? "x" : "y";
  const std::string otherwise = probe.quantity == "stress" ? along_last + along_last : along_last;
  if (!probe.component.empty() && probe.component != otherwise) json["component"] = probe.component;
  if (probe.target != ProbeTarget::particle) json["target"] = static_cast<int>(probe.target);
  if (!probe.of.empty()) json["of"] = probe.of;
  return json;
}

/// What a survey is told apart by, with what its case says of the class of a run.
Json essence_of(const SurveyRequest& survey, const Case& definition) {
  Json json = {{"from", survey.from},         {"to", survey.to},
               {"points", survey.points},     {"bisections", survey.bisections},
               {"runs", survey.runs},         {"accuracy", survey.accuracy},
               {"times_least", survey.times_least}, {"references", definition.references}};
  if (definition.classification) {
    const BehaviourLimits& limits = definition.classification->limits;
    json["limits"] = {limits.drift, limits.ringing, limits.zigzag};
  }
  return json;
}

// ---- element tests ----

std::string digest_of(const ElementRun& run) {
  Fnv1a hash;
  for (const ElementCurve& curve : run.curves) hash.add(curve.value);
  for (const auto& [name, value] : run.measured) hash.add(std::vector<double>{value});
  return hash.digits();
}

Record record_element_test(const ElementTest& test, const Pulse& pulse) {
  const auto began = std::chrono::steady_clock::now();
  ElementRun run = run_element_test(test);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - began;
  const std::int64_t steps = test.path == ElementPath::random_states ? test.states : test.increments;
  if (pulse && !pulse(steps)) throw Abandoned();
  Record record;
  record.outcome.ending = Ending::reached_time;
  record.outcome.step = steps;
  record.digest = digest_of(run);
  record.paths = std::move(run.curves);
  record.measured = std::move(run.measured);
  record.cost = {.wall_seconds = wall.count(),
                 .steps = steps,
                 .particle_steps = steps,
                 .early_seconds = wall.count(),
                 .early_steps = steps};
  return record;
}

// ---- surveys ----

/// Complete once the survey is, whatever became of its runs.
Record record_survey(const Case& definition, const RunRequest& request, const Pulse& pulse) {
  const auto began = std::chrono::steady_clock::now();
  std::int64_t particle_steps = 0;
  const Pulse counting = [&](std::int64_t fresh) {
    particle_steps += fresh;
    return !pulse || pulse(fresh);
  };
  Record record;
  record.survey = survey_of(definition, request, *definition.survey, counting);
  record.outcome.ending = Ending::reached_time;
  for (const SurveyPoint& point : record.survey->points) record.outcome.step += point.outcome.step;
  if (request.refusal.empty()) record.time_step = record.survey->own * crossing_time(request.scene);
  record.digest = hash_of(survey_to_json(*record.survey).dump());
  record.cost.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  record.cost.steps = record.outcome.step;
  record.cost.particle_steps = particle_steps;
  return record;
}

// ---- files ----

[[noreturn]] void fail(const std::filesystem::path& path, const char* what) {
  throw std::system_error(errno, std::generic_category(),
                          std::string("cannot ") + what + " " + path.string());
}

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int value() const { return value_; }

 private:
  int value_;
};

/// A name beside `path` that no other process or thread uses now.
std::filesystem::path temporary_beside(const std::filesystem::path& path) {
  static std::atomic<unsigned> counter{0};
  return path.parent_path() / fmt::format(".{}.{}-{}.part", path.filename().string(), ::getpid(), counter++);
}

void write_and_sync(const std::filesystem::path& path, const std::string& text) {
  const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (file.value() < 0) fail(path, "create");
  for (std::size_t written = 0; written < text.size();) {
    const ssize_t count = ::write(file.value(), text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(path, "write");
    written += static_cast<std::size_t>(count);
  }
  if (::fsync(file.value()) != 0) fail(path, "write");
}

/// Runs the scene in another description and compares the ends. Infinite if that run does not complete.
double difference_to(const Scene& scene, const std::string& metamorphosis, const ParticleFields& end,
                     const Pulse& pulse) {
  Simulation other(transformed(scene, metamorphosis));
  const std::int64_t steps_per_pulse =
      std::max<std::int64_t>(1, particle_steps_per_pulse / std::max<std::int64_t>(1, other.particle_count()));
  std::int64_t reported = 0;
  while (other.advance()) {
    if (other.steps() - reported < steps_per_pulse) continue;
    if (pulse && !pulse((other.steps() - reported) * other.particle_count())) throw Abandoned();
    reported = other.steps();
  }
  if (!other.outcome().completed()) return std::numeric_limits<double>::infinity();
  return largest_difference(end, mapped_back(scene, other.particles(), other.time(), metamorphosis));
}

/// The request once pilots, if it asks for any, have told its precision.
RunRequest with_precision(RunRequest request, const Pulse& pulse) {
  if (request.model_request.precision == Decision::as_written) return request;
  request.model.push_back(choose_precision(request, pulse));
  request.scene.precision =
      request.model.back().used == "float" ? Precision::float32 : Precision::float64;
  return request;
}

Record record_scene(const Case& definition, const RunRequest& asked, const Pulse& pulse) {
  const RunRequest request = with_precision(asked, pulse);
  Recorder recorder(definition, request, pulse);
  Record record = recorder.run();
  record.model = request.model;
  for (const std::string& metamorphosis : definition.metamorphoses) {
    if (!record.completed()) break;  // a state without an end has no other description of it
    const double difference = difference_to(request.scene, metamorphosis, recorder.particles(), pulse);
    if (std::isfinite(difference)) record.measured[metamorphic_prefix + metamorphosis] = difference;
  }
  return record;
}

}  // namespace

std::string moment_of(const SnapshotRequest& request) {
  switch (request.when) {
    case SnapshotRequest::When::time:
      return fmt::format("t = {:.6g} s", request.time);
    case SnapshotRequest::When::passing:
      return fmt::format("{} = {:.6g} mm", request.probe, request.value * 1e3);
    case SnapshotRequest::When::end:
      break;
  }
  return "end";
}

std::string ending_of(const Record& record) {
  if (!record.failure.empty()) return "run failed: " + record.failure;
  const Outcome& outcome = record.outcome;
  std::string text = fmt::format("run ended {} at step {}, t = {:.4g} s", name_of(outcome.ending),
                                 outcome.step, outcome.time);
  if (outcome.particle >= 0)
    text += fmt::format(", particle {}, value {:.6g}", outcome.particle, outcome.value);
  return text;
}

Json model_to_json(const std::vector<ModelChoice>& model) {
  Json json = Json::array();
  for (const ModelChoice& choice : model) {
    json.push_back({{"what", choice.what},
                    {"written", choice.written},
                    {"used", choice.used},
                    {"reason", choice.reason},
                    {"numbers", measured_to_json(choice.numbers)}});
  }
  return json;
}

Json to_json(const Record& record) {
  return {{"schema", record_schema},
          {"case_id", record.case_id},
          {"input_hash", record.input_hash},
          {"program_hash", record.program_hash},
          {"revision", record.revision},
          {"threads", record.threads},
          {"step_threads", record.step_threads},
          {"failure", record.failure},
          {"outcome", outcome_to_json(record.outcome)},
          {"time_step", number(record.time_step)},
          {"end_time", number(record.end_time)},
          {"unbalanced_force_ratio", number(record.unbalanced_force_ratio)},
          {"kinetic_energy_ratio", number(record.kinetic_energy_ratio)},
          {"cell_crossings", record.cell_crossings},
          {"relative_mass_change", number(record.relative_mass_change)},
          {"non_finite_values", record.non_finite_values},
          {"digest", record.digest},
          {"repeat_digest", record.repeat_digest},
          {"cost",
           {{"wall_seconds", number(record.cost.wall_seconds)},
            {"steps", record.cost.steps},
            {"particle_steps", record.cost.particle_steps},
            {"memory_bytes", record.cost.memory_bytes},
            {"early_seconds", number(record.cost.early_seconds)},
            {"early_steps", record.cost.early_steps}}},
          {"profile", profile_to_json(record.profile)},
          {"histories", histories_to_json(record.histories)},
          {"snapshots", snapshots_to_json(record.snapshots)},
          {"largest_energy_ratio", number(record.largest_energy_ratio)},
          {"last_good", record.last_good ? snapshots_to_json({*record.last_good}) : Json::array()},
          {"model", model_to_json(record.model)},
          {"paths", paths_to_json(record.paths)},
          {"survey", record.survey ? survey_to_json(*record.survey) : Json::object()},
          {"measured", measured_to_json(record.measured)}};
}

Record record_from_json(const Json& json) {
  if (json.at("schema") != record_schema) throw std::runtime_error("not a record of this format");
  const Json& cost = json.at("cost");
  Record record;
  record.case_id = json.at("case_id").get<std::string>();
  record.input_hash = json.at("input_hash").get<std::string>();
  record.program_hash = json.at("program_hash").get<std::string>();
  record.revision = json.at("revision").get<std::string>();
  record.threads = json.at("threads").get<int>();
  record.step_threads = json.value("step_threads", 1);
  record.failure = json.at("failure").get<std::string>();
  record.outcome = outcome_from_json(json.at("outcome"));
  record.time_step = number_from(json.at("time_step"));
  record.end_time = number_from(json.at("end_time"));
  record.unbalanced_force_ratio = number_from(json.at("unbalanced_force_ratio"));
  record.kinetic_energy_ratio = number_from(json.at("kinetic_energy_ratio"));
  record.cell_crossings = json.at("cell_crossings").get<std::int64_t>();
  record.relative_mass_change = number_from(json.at("relative_mass_change"));
  record.non_finite_values = json.at("non_finite_values").get<std::int64_t>();
  record.digest = json.at("digest").get<std::string>();
  record.repeat_digest = json.at("repeat_digest").get<std::string>();
  record.cost = {.wall_seconds = number_from(cost.at("wall_seconds")),
                 .steps = cost.at("steps").get<std::int64_t>(),
                 .particle_steps = cost.at("particle_steps").get<std::int64_t>(),
                 .memory_bytes = cost.at("memory_bytes").get<std::int64_t>(),
                 .early_seconds = number_from(cost.at("early_seconds")),
                 .early_steps = cost.at("early_steps").get<std::int64_t>()};
  record.profile = profile_from_json(json.at("profile"));
  record.histories = histories_from_json(json.at("histories"));
  record.snapshots = snapshots_from_json(json.at("snapshots"));
  record.largest_energy_ratio = number_from(json.at("largest_energy_ratio"));
  const std::vector<Snapshot> good = snapshots_from_json(json.at("last_good"));
  if (!good.empty()) record.last_good = good.front();
  record.model = model_from_json(json.at("model"));
  record.paths = paths_from_json(json.at("paths"));
  if (!json.at("survey").empty()) record.survey = survey_from_json(json.at("survey"));
  record.measured = measured_from_json(json.at("measured"));
  return record;
}

Record unsigned_record(const Case& definition, const RunRequest& request, const Pulse& pulse) {
  if (!request.refusal.empty()) {
    Record refused;
    refused.failure = refused_prefix + request.refusal;
    refused.case_id = definition.id;
    refused.input_hash = input_hash(definition, request);
    return refused;
  }
  Record record = definition.survey ? record_survey(definition, request, pulse)
                  : request.element ? record_element_test(*request.element, pulse)
                                    : record_scene(definition, request, pulse);
  record.case_id = definition.id;
  record.input_hash = input_hash(definition, request);
  return record;
}

std::string input_hash(const Case& definition, const RunRequest& request) {
  Json input = {{"schema", record_schema},
                {request.element ? "element" : "scene", request.scene_text},
                {"probes", Json::array()}};
  for (const HistoryProbe& probe : definition.probes)
    input["probes"].push_back(essence_of(probe, request.scene));
  // The text alone does not tell: what is chosen depends on what else the case asks for.
  if (request.width) input["dimension"] = request.scene.dimension;
  for (const SnapshotRequest& snapshot : definition.snapshots) {
    input["snapshots"].push_back({{"when", static_cast<int>(snapshot.when)},
                                  {"time", snapshot.time},
                                  {"probe", snapshot.probe},
                                  {"value", snapshot.value}});
  }
  if (!definition.metamorphoses.empty()) input["metamorphoses"] = definition.metamorphoses;
  if (definition.survey) input["survey"] = essence_of(*definition.survey, definition);
  return hash_of(input.dump());
}

std::string hash_of(const std::string& text) {
  Fnv1a hash;
  hash.add(text.data(), text.size());
  return hash.digits();
}

void write_atomically(const std::filesystem::path& path, const std::string& text) {
  const std::filesystem::path temporary = temporary_beside(path);
  try {
    write_and_sync(temporary, text);
    if (::rename(temporary.c_str(), path.c_str()) != 0) fail(path, "write");
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw;
  }
  // The new name lasts through a power cut only once the directory is on the disk too.
  const std::filesystem::path directory = path.has_parent_path() ? path.parent_path() : ".";
  const Descriptor descriptor(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.value() >= 0) ::fsync(descriptor.value());
}

}  // namespace mpm::vv
