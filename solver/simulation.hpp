#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "solver/scene.hpp"

namespace mpm {

/// How a run ended. The last five are numerical failures: `step`, `time`, `particle` and `value` say where.
enum class Ending {
  reached_time,      ///< the end time asked for
  at_rest,           ///< the rest criterion was met
  not_at_rest,       ///< the deadline came first
  reached_displacement,  ///< the body has moved as far as asked for
  not_reached,           ///< the deadline came first
  not_finite,        ///< a particle's position, velocity or stress is not a finite number
  inverted,          ///< a particle's volume is not positive
  outside_grid,      ///< a particle's domain left the grid
  gained_energy,     ///< the particles move with several times the energy that ever went into the scene
  domain_too_large,  ///< a particle's half size exceeds the cell size, beyond what its shape function covers
};

/// The name used in records, results and messages, for example "at_rest".
const char* name_of(Ending ending);

struct Outcome {
  Ending ending = Ending::reached_time;
  std::int64_t step = 0;       ///< steps completed
  double time = 0.0;           ///< simulated [s]
  std::int64_t particle = -1;  ///< of a numerical failure, else -1
  double value = 0.0;          ///< the offending value in SI units; 0 without a numerical failure

  /// The run ended where it was meant to: its state can be judged.
  bool completed() const { 
    return ending == Ending::reached_time || ending == Ending::at_rest || ending == Ending::reached_displacement;
  }
};

/// A copy of the particles for an observer, in double precision whatever the run's own.
struct ParticleFields {
  int dimension = 1;
  std::vector<double> initial_position;  ///< [particle * dimension + axis] [m]
  std::vector<double> displacement;      ///< same shape [m]
  std::vector<double> position;          ///< same shape [m]
  std::vector<double> velocity;          ///< same shape [m/s]
  std::vector<double> half_size;         ///< same shape [m]; zeros for scheme mpm
  std::vector<double> stress;  ///< [particle * stress components + component] Cauchy [Pa], tension positive
  std::vector<double> volume;  ///< [particle] current [m^dimension]
  std::vector<double> initial_volume;  ///< [particle]
  std::vector<double> mass;            ///< [particle] [kg per unit of the absent dimensions]
  std::vector<double>
      strain;  ///< sum of the increments, shape of `stress` [-]; empty unless the scene sums strain
  std::vector<double> stress_work;  ///< [particle] sum of what the stress did [J per unit of the absent
                                    ///< dimensions]; empty unless the scene sums work
  std::vector<double> deformation_gradient;  ///< [particle * dimension^2 + row * dimension + column] [-];
                                             ///< empty unless a neo-Hookean body in 2D needs it
  std::vector<std::size_t> body;             ///< [particle] index into Scene::bodies
};

/// What a rigid body has done so far.
struct RigidBodyState {
  PerAxis displacement{};  ///< [m]
  PerAxis impulse{};  ///< of the particles on the body, summed over the steps [N s per unit of the absent
                      ///< dimensions]
};

/// Quantities of the whole model after the last step.
struct Monitor {
  double unbalanced_force_ratio = 0.0;  ///< unbalanced force felt by the particles / total weight [-]
  double kinetic_energy_ratio = 0.0;    ///< kinetic energy of the grid / (total weight * cell size) [-]
  /// Kinetic energy of the particles / all energy that went into the scene so far [-]: what they had at the start, in
  /// motion and in stress, and what loads and rigid bodies have done. Above 1 energy came from nowhere. As of the
  /// last look, which comes every 64 steps; 0 where a rigid body turns, whose work is not known.
  double energy_ratio = 0.0;
  double largest_energy_ratio = 0.0;  ///< at any look so far [-]
};

/// A scene in motion. Memory is reserved on construction; advancing allocates nothing, unless bodies scatter
/// so far that their particles need more room.
class Simulation {
 public:
  /// `threads` >= 1 share the work of a step; their number changes no bit of any result. Throws SceneError.
  explicit Simulation(const Scene& scene, int threads = 1);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// Advances one step. False once the run has ended; then `outcome()` says how.
  bool advance();

  const Outcome& outcome() const;
  double time() const;
  double time_step() const;  ///< [s]
  std::int64_t steps() const;
  std::int64_t particle_count() const;
  std::int64_t cell_crossings() const;  ///< particle centres that changed cell so far, summed over steps
  std::int64_t arrangements() const;    ///< how often the particles have been put in the order of their cells
  std::int64_t memory() const;          ///< of particles, nodes and tables: all that grows with the scene [B]
  Monitor monitor() const;
  /// Puts the particles in another state: position, displacement, velocity, half size, stress and volume, and what
  /// else the scene keeps of strain, work and deformation gradient. Time goes on as it was. Mass and bodies have to be
  /// those of the scene; throws std::invalid_argument for fields of other lengths. A run that has ended stays ended.
  void set_particles(const ParticleFields& fields);
  ParticleFields particles() const;
  std::vector<RigidBodyState> rigid_bodies() const;  ///< in the order of the scene

 private:
  class Engine;
  template <int Dim, class Real, Scheme scheme>
  class EngineOf;
  std::unique_ptr<Engine> engine_;
};

}  // namespace mpm
