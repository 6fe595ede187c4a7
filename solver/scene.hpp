#pragma once

#include <array>
#include <string>
#include <variant>
#include <vector>

namespace mpm {

/// The largest number of space dimensions a scene can have; arrays of this length hold one entry per axis
/// (x, y) of which only the first `Scene::dimension` are read.
inline constexpr int max_dimension = 2;
using PerAxis = std::array<double, max_dimension>;

/// Shape function and domain update: `mpm` points, `ugimp` domains of fixed size, `cpgimp` domains that
/// follow the strain [Kiriyama15, Eq. 14].
enum class Scheme { mpm, ugimp, cpgimp };

/// When the stress is updated within a step: after a second mapping of the velocity (`musl`, the paper's),
/// first (`usf`), or last without a second mapping (`usl`).
enum class UpdateOrder { musl, usf, usl };

enum class Precision { float64, float32 };

/// Whether the stress turns with the material: `none` leaves it as it is [Kiriyama15, Eq. 11], `jaumann`
/// turns it by the spin of the velocity field. In one dimension nothing turns.
enum class Objectivity { none, jaumann };

/// Velocity condition on an edge of the grid: none, normal component zero, all components zero.
/// In one dimension `roller` and `fixed` are the same.
enum class Condition { free, roller, fixed };

/// Rate-form isotropic linear elasticity [Kiriyama15, Eq. 11], plane strain in two dimensions; in 1D it
/// integrates to Hencky's law E ln(lambda).
struct LinearElastic {
  double youngs_modulus;  ///< [Pa], > 0
  double poissons_ratio;  ///< [-], in [0, 0.5); in one dimension lateral strain is free and it has no effect
};

/// The 1D law whose exact column is the published one: stress = 2 E (1 - lambda^(-1/2)) [Zhang].
struct ZhangElastic {
  double youngs_modulus;  ///< [Pa], > 0
};

/// Isotropic elasticity with the Mohr–Coulomb limit, perfectly plastic; two dimensions (plane strain) only.
struct MohrCoulomb {
  double youngs_modulus;  ///< [Pa], > 0
  double poissons_ratio;  ///< [-], in [0, 0.5)
  double friction_angle;  ///< phi [rad], in [0, pi/2); 0 is Tresca's limit, which has no apex
  double cohesion;        ///< c [Pa], >= 0; above zero where phi is zero
  double dilation_angle;  ///< psi [rad], in [0, phi]; phi is associated flow, 0 keeps the volume
};

using Material = std::variant<LinearElastic, ZhangElastic, MohrCoulomb>;

/// An axis-aligned block of particles, filled regularly with particles of equal size.
struct Body {
  std::string name;
  PerAxis lower{}, upper{};  ///< corners [m]; whole multiples of the particle spacing
  std::array<int, max_dimension> particles_per_cell{1, 1};  ///< per axis, >= 1
  double density = 0.0;                                     ///< initial mass density [kg/m^3], > 0
  PerAxis velocity{};                                       ///< initial [m/s]
  Material material = LinearElastic{0.0, 0.0};
};

struct StepLoading {};  ///< full gravity from the first step on
struct RampLoading {
  double duration;  ///< [s], > 0; gravity grows linearly from nothing to full
};
struct StagedLoading {
  double hold;                    ///< [s], > 0; how long each stage lasts (the last one lasts for ever)
  std::vector<double> fractions;  ///< fraction of full gravity in each stage, at least one
};

/// Gravity: `level` times `acceleration`, applied by a loading history.
struct Gravity {
  PerAxis acceleration{};  ///< at 1G [m/s^2], signed
  double level = 1.0;      ///< multiple of `acceleration` [-]
  std::variant<StepLoading, RampLoading, StagedLoading> loading = StepLoading{};

  double fraction(double time) const;  ///< fraction of full gravity acting at `time` [s]
  double settled_after() const;        ///< time [s] from which the fraction no longer changes
};

struct GivenTimeStep {
  double seconds;  ///< [s], > 0
};
struct StableFraction {
  double fraction;  ///< of cell size / fastest elastic wave of the initial state, > 0
};

struct AtTime {
  double time;  ///< [s], > 0
};
/// At rest, not before gravity has settled: the unbalanced force that the particles feel falls to
/// `unbalanced_force_ratio` times the total weight, and the grid's kinetic energy to `kinetic_energy_ratio`
/// times weight * cell size.
struct AtRest {
  double unbalanced_force_ratio;  ///< [-], > 0
  double kinetic_energy_ratio;    ///< [-], > 0
  double deadline;                ///< [s]; a run not at rest by then ends with that outcome
};

/// All the solver needs to know to simulate: plain values, SI units, no behaviour.
struct Scene {
  int dimension = 1;
  Scheme scheme = Scheme::cpgimp;
  UpdateOrder update_order = UpdateOrder::musl;
  Precision precision = Precision::float64;
  Objectivity objectivity = Objectivity::none;
  double flip_fraction = 1.0;  ///< 1 pure FLIP, 0 pure PIC
  double damping = 0.0;        ///< Cundall's local damping factor alpha [-], in [0, 1)

  double cell_size = 0.0;              ///< h [m], > 0, the same along every axis
  PerAxis grid_lower{}, grid_upper{};  ///< corners of the grid [m], a whole number of cells apart
  std::array<std::array<Condition, 2>, max_dimension> edges{};  ///< [axis][0 lower, 1 upper]

  std::vector<Body> bodies;
  Gravity gravity;
  std::variant<GivenTimeStep, StableFraction> time_step = StableFraction{0.2};
  std::variant<AtTime, AtRest> termination = AtTime{1.0};
};

/// Throws SceneError for the first value that makes the scene impossible to simulate.
void check(const Scene& scene);

}  // namespace mpm
