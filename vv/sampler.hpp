#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "vv/record.hpp"

namespace mpm::vv {

/// A simulation at one moment. What is asked for is copied once, and nothing else: a probe of a rigid body
/// costs no copy of the particles.
class Observation {
 public:
  explicit Observation(const Simulation& simulation) : simulation_(&simulation), time_(simulation.time()) {}

  double time() const { return time_; }  ///< [s]
  const ParticleFields& particles() const;
  const std::vector<RigidBodyState>& rigid_bodies() const;

 private:
  const Simulation* simulation_;
  double time_;
  mutable std::optional<ParticleFields> particles_;
  mutable std::optional<std::vector<RigidBodyState>> rigid_bodies_;
};

/// What all weight has gained in potential energy since the start, -mass gravity . displacement, in full
/// gravity [J per unit of the absent dimensions].
double potential_energy(const Scene& scene, const ParticleFields& fields);

/// What the stresses of all particles have done since the start [J per unit of the absent dimensions]. Throws
/// std::invalid_argument if the scene does not sum work.
double stress_work(const ParticleFields& fields);

/// A probe at work: what it looks at, when it is due, and what it has seen.
class Sampler {
 public:
  /// `scene` must outlive the sampler. What it sees is recorded times `factor`. Throws std::invalid_argument for
  /// a probe the scene cannot serve.
  Sampler(const HistoryProbe& probe, const Scene& scene, const Observation& start, double factor = 1.0);

  /// The step that ends at `time` is the nearest to the next multiple of the interval, or past it. Never
  /// twice at one time, however the rounding falls.
  bool due(double time, double time_step) const {
    return time + 0.5 * time_step >= next_ && time > history_.time.back();
  }

  /// Takes a sample, unless there is one of this moment or, without `whatever` it is, it is no finite number.
  void sample(const Observation& now, double time_step, bool whatever = true);

  const History& history() const& { return history_; }
  History history() && { return std::move(history_); }

 private:
  History history_;
  double every_, factor_;
  std::function<double(const Observation&)> measure_;  ///< the number recorded at a moment
  double next_ = 0.0;
};

}  // namespace mpm::vv
