#include "vv/sampler.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "solver/energy.hpp"

namespace mpm::vv {
namespace {

[[noreturn]] void refuse(const HistoryProbe& probe) {
  throw std::invalid_argument("a history probe cannot record '" + probe.quantity + "'" +
                              (probe.of.empty() ? "" : " of '" + probe.of + "'"));
}

std::size_t axes_of(const Scene& scene) { return static_cast<std::size_t>(scene.dimension); }

/// Index of a component of a vector or of a stress; without a name, the one along the last axis. The first
/// stress components are the normal ones, so that their number is the axis too.
std::size_t component_index(const HistoryProbe& probe, const Scene& scene) {
  if (probe.component.empty()) return axes_of(scene) - 1;
  const std::vector<std::string> names = probe.quantity == "stress"
                                             ? std::vector<std::string>{"xx", "yy", "zz", "xy"}
                                             : std::vector<std::string>{"x", "y"};
  const auto name = std::find(names.begin(), names.end(), probe.component);
  if (name == names.end()) refuse(probe);
  return static_cast<std::size_t>(name - names.begin());
}

template <class Named>
std::size_t index_of(const std::vector<Named>& all, const HistoryProbe& probe) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Named& each) { return each.name == probe.of; });
  if (found == all.end()) refuse(probe);
  return static_cast<std::size_t>(found - all.begin());
}

std::size_t nearest_particle(const ParticleFields& fields, const PerAxis& place) {
  const auto dimension = static_cast<std::size_t>(fields.dimension);
  const std::size_t particles = fields.mass.size();
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < particles; ++p) {
    double distance = 0.0;
    for (std::size_t axis = 0; axis < dimension; ++axis) {
      const double offset = fields.initial_position[p * dimension + axis] - place[axis];
      distance += offset * offset;
    }
    if (distance < least) {
      least = distance;
      nearest = p;
    }
  }
  return nearest;
}

/// Which field of the particles a quantity is.
const std::vector<double>& field_of(const ParticleFields& fields, const std::string& quantity) {
  if (quantity == "displacement") return fields.displacement;
  return quantity == "velocity" ? fields.velocity : fields.stress;
}

double sum_over_body(const ParticleFields& fields, std::size_t body,
                     const std::function<double(std::size_t)>& of_particle) {
  double sum = 0.0;
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    if (fields.body[p] == body) sum += of_particle(p);
  }
  return sum;
}

/// The mass that has weight over the one that resists acceleration.
double weight_over_inertia(const Body& body, double time) {
  return body.inertia ? body.density_at(time) / *body.inertia : 1.0;
}

double mass_of_body(const ParticleFields& fields, std::size_t body) {
  return sum_over_body(fields, body, [&](std::size_t p) { return fields.mass[p]; });
}

double mean_over_body(const ParticleFields& fields, std::size_t body, const std::string& quantity,
                      std::size_t component) {
  const auto dimension = static_cast<std::size_t>(fields.dimension);
  const std::vector<double>& field = field_of(fields, quantity);
  return sum_over_body(fields, body,
                       [&](std::size_t p) { return fields.mass[p] * field[p * dimension + component]; }) /
         mass_of_body(fields, body);
}

double momentum(const ParticleFields& fields, std::size_t component) {
  const auto dimension = static_cast<std::size_t>(fields.dimension);
  double sum = 0.0;
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    sum += fields.mass[p] * fields.velocity[p * dimension + component];
  }
  return sum;
}

using Measure = std::function<double(const Observation&)>;

Measure measure_of_particle(const HistoryProbe& probe, std::size_t component, const Observation& start) {
  const std::string& quantity = probe.quantity;
  if (quantity != "displacement" && quantity != "velocity" && quantity != "stress") refuse(probe);
  if (start.particles().mass.empty()) throw std::invalid_argument("a history probe needs a particle");
  const std::size_t particle = nearest_particle(start.particles(), probe.at);
  return [=](const Observation& now) {
    const std::vector<double>& field = field_of(now.particles(), quantity);
    return field[particle * (field.size() / now.particles().mass.size()) + component];
  };
}

/// The mean force on a rigid body since the last call; nothing at the first.
class MeanReaction {
 public:
  MeanReaction(std::size_t body, std::size_t component) : body_(body), component_(component) {}

  double operator()(const Observation& now) {
    const double impulse = now.rigid_bodies()[body_].impulse[component_];
    const double mean = now.time() > time_ ? (impulse - impulse_) / (now.time() - time_) : 0.0;
    impulse_ = impulse;
    time_ = now.time();
    return mean;
  }

 private:
  std::size_t body_, component_;
  double impulse_ = 0.0, time_ = 0.0;
};

Measure measure_of_rigid_body(const HistoryProbe& probe, std::size_t component, const Scene& scene) {
  const std::size_t body = index_of(scene.rigid_bodies, probe);
  if (probe.quantity == "reaction") return MeanReaction(body, component);
  if (probe.quantity == "load") return MeanReaction(body, axes_of(scene) - 1);
  if (probe.quantity != "displacement") refuse(probe);
  return [=](const Observation& now) { return now.rigid_bodies()[body].displacement[component]; };
}

Measure measure_of_body(const HistoryProbe& probe, std::size_t component, const Scene& scene) {
  const std::size_t body = index_of(scene.bodies, probe);
  if (probe.quantity == "weight" || probe.quantity == "load") {
    return [body, &scene, axis = axes_of(scene) - 1](const Observation& now) {
      const Gravity& gravity = scene.gravity;
      const double acceleration = gravity.acceleration[axis] * gravity.level * gravity.fraction(now.time());
      return mass_of_body(now.particles(), body) * weight_over_inertia(scene.bodies[body], now.time()) *
             std::abs(acceleration);
    };
  }
  if (probe.quantity != "displacement" && probe.quantity != "velocity") refuse(probe);
  return [body, component, quantity = probe.quantity](const Observation& now) {
    return mean_over_body(now.particles(), body, quantity, component);
  };
}

Measure measure_of_everything(const HistoryProbe& probe, std::size_t component, const Scene& scene) {
  if (probe.quantity == "momentum") {
    return [=](const Observation& now) { return momentum(now.particles(), component); };
  }
  if (probe.quantity == "kinetic_energy") {
    return [](const Observation& now) { return kinetic_energy(now.particles()); };
  }
  if (probe.quantity == "potential_energy") {
    return [&scene](const Observation& now) { return potential_energy(scene, now.particles()); };
  }
  if (probe.quantity == "stress_work") {
    return [](const Observation& now) { return stress_work(now.particles()); };
  }
  if (probe.quantity != "strain_energy") refuse(probe);
  return [&scene](const Observation& now) { return strain_energy(scene, now.particles()); };
}

bool is_rigid(const Scene& scene, const std::string& name) {
  return std::any_of(scene.rigid_bodies.begin(), scene.rigid_bodies.end(),
                     [&](const RigidBody& body) { return body.name == name; });
}

Measure measure_of(const HistoryProbe& probe, const Scene& scene, const Observation& start) {
  const std::size_t component = component_index(probe, scene);
  switch (probe.target) {
    case ProbeTarget::particle:
      return measure_of_particle(probe, component, start);
    case ProbeTarget::rigid_body:
    case ProbeTarget::body:
      return is_rigid(scene, probe.of) ? measure_of_rigid_body(probe, component, scene)
                                       : measure_of_body(probe, component, scene);
    case ProbeTarget::everything:
      return measure_of_everything(probe, component, scene);
  }
  refuse(probe);
}

}  // namespace

const ParticleFields& Observation::particles() const {
  if (!particles_) particles_ = simulation_->particles();
  return *particles_;
}

const std::vector<RigidBodyState>& Observation::rigid_bodies() const {
  if (!rigid_bodies_) rigid_bodies_ = simulation_->rigid_bodies();
  return *rigid_bodies_;
}

double potential_energy(const Scene& scene, const ParticleFields& fields) {
  const auto dimension = static_cast<std::size_t>(fields.dimension);
  double sum = 0.0;
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    for (std::size_t axis = 0; axis < dimension; ++axis) {
      sum -= fields.mass[p] * weight_over_inertia(scene.bodies[fields.body[p]], 0.0) * scene.gravity.acceleration[axis] * scene.gravity.level *
             fields.displacement[p * dimension + axis];
    }
  }
  return sum;
}

double stress_work(const ParticleFields& fields) {
  if (fields.stress_work.empty()) throw std::invalid_argument("the particles of this scene sum no work");
  return std::accumulate(fields.stress_work.begin(), fields.stress_work.end(), 0.0);
}

Sampler::Sampler(const HistoryProbe& probe, const Scene& scene, const Observation& start, double factor)
    : history_{.id = probe.id, .quantity = probe.quantity, .time = {}, .value = {}},
      every_(probe.every),
      factor_(factor),
      measure_(measure_of(probe, scene, start)) {
  if (!(every_ > 0.0))
    throw std::invalid_argument("the sampling interval of a history probe must be positive");
}

void Sampler::sample(const Observation& now, double time_step, bool whatever) {
  if (!history_.time.empty() && history_.time.back() == now.time()) return;
  const double value = factor_ * measure_(now);
  if (!whatever && !std::isfinite(value)) return;
  history_.value.push_back(value);
  history_.time.push_back(now.time());
  next_ = every_ * (std::floor((now.time() + 0.5 * time_step) / every_) + 1.0);
}

}  // namespace mpm::vv
