#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
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

/// Whose dilation a particle takes: its own (`none`), or the mean of those in its cell (`cell_average`), and
/// with it the mean of the cell's normal stresses in the nodal forces; see `CellAverage`.
enum class LockingControl { none, cell_average };

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

/// Hyperelastic, stress from the deformation gradient F: [lambda ln J I + mu (F F^T - I)] / J, J = det F. It
/// keeps its energy over any cycle and turns with the material by itself. In one dimension lateral strain is
/// free of stress: mu (F - 1/F) with mu = E/2.
struct NeoHookean {
  double youngs_modulus;  ///< of small strains [Pa], > 0
  double poissons_ratio;  ///< of small strains [-], in [0, 0.5); no effect in one dimension
};

using Material = std::variant<LinearElastic, ZhangElastic, MohrCoulomb, NeoHookean>;

/// The same stress everywhere [Pa], tension positive; in one dimension only the first is read.
struct UniformStress {
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0;
};
/// The stress of a level ground at rest under full gravity, which acts along the last axis downwards:
/// vertical -density * gravity * depth, horizontal `k0` times that.
struct GeostaticStress {
  double surface;  ///< height of the ground's surface [m], not below the body's upper edge
  double k0;       ///< horizontal over vertical stress [-], >= 0
};
using InitialStress = std::variant<UniformStress, GeostaticStress>;

/// A stretch of a density ramp: linear in time.
struct DensityStage {
  double density;   ///< at its end [kg/m^3] of initial volume, > 0
  double duration;  ///< [s], > 0
};

/// A density that changes while the scene goes on: mass is added to (or taken from) every particle of the
/// body at its current velocity. Constant until `start`, then from stage to stage, constant after the last.
struct DensityRamp {
  double start = 0.0;                ///< [s], >= 0
  std::vector<DensityStage> stages;  ///< at least one

  double end() const;             ///< of the last stage [s]
  double lowest_density() const;  ///< at the end of any stage [kg/m^3]
};

/// What of a block belongs to a body: the particles whose centers lie between two radii; a disc has none
/// inside.
struct Ring {
  PerAxis center{};           ///< [m]
  double inner_radius = 0.0;  ///< [m], >= 0
  double outer_radius = 0.0;  ///< [m], above the inner
};

/// An axis-aligned block of particles, filled regularly with particles of equal size.
struct Body {
  std::string name;
  PerAxis lower{}, upper{};  ///< corners [m]; whole multiples of the particle spacing above the grid's lower corner
  bool anywhere = false;     ///< the corners may lie anywhere in the grid; their distance is still a whole multiple
  std::optional<Ring> ring;  ///< keeps only the part of the block inside it; two dimensions only
  std::array<int, max_dimension> particles_per_cell{1, 1};  ///< per axis, >= 1
  double density = 0.0;                                     ///< initial mass density [kg/m^3], > 0
  std::optional<DensityRamp> density_ramp;
  /// Density that resists acceleration, in place of the one that has weight [kg/m^3 of initial volume], > 0: mass
  /// scaling. At rest it makes no difference; it sets the speed of waves, and with it the stable time step.
  std::optional<double> inertia;
  PerAxis velocity{};  ///< initial [m/s]
  std::optional<InitialStress> initial_stress;
  Material material = LinearElastic{0.0, 0.0};
  LockingControl locking_control =
      LockingControl::none;  ///< two dimensions, `LinearElastic` or `MohrCoulomb`

  double density_at(double time) const;  ///< that has weight, of initial volume, at `time` [s] [kg/m^3]
  double lightest() const;               ///< least density that resists acceleration at any time [kg/m^3]
};

/// A rigid box that moves as prescribed and acts through the grid: what it holds takes its velocity, in the
/// components it constrains, and what that takes is its reaction. Across its motion its extent is as sharp as
/// the grid: the nodes inside it, edges included. At rest it is a condition on a region of the grid. A body
/// that moves along one axis has its two faces normal to that axis where they are, also between nodes; one
/// that turns or moves along both is as sharp as the grid everywhere.
struct RigidBody {
  std::string name;
  PerAxis lower{}, upper{};  ///< corners at the start [m]; may reach beyond the grid
  std::array<bool, max_dimension> constrains{
      true, true};                ///< components; a smooth footing leaves its tangential one
  PerAxis velocity{};             ///< once in full motion [m/s]
  double angular_velocity = 0.0;  ///< of the nodes' velocity about the box's center, anticlockwise [rad/s]
  double start = 0.0;             ///< at rest until then [s], >= 0
  double ramp = 0.0;              ///< velocities grow linearly over this time [s], >= 0; 0 is at once

  double speed_fraction(double time) const;  ///< of the full velocities at `time` [s], from 0 to 1
  double travel_time(double time) const;     ///< integral of `speed_fraction` from 0 to `time` [s]
};

/// A traction on part of one edge of a block, carried by its outermost row of particles for good.
struct SurfaceLoad {
  std::string body;
  int axis = 0, side = 0;         ///< which edge: normal axis, 0 lower or 1 upper
  double begin = 0.0, end = 0.0;  ///< which part of it, along the other axis at the start [m]; not read in 1D
  PerAxis traction{};             ///< force per initial area [Pa]
  double ramp = 0.0;              ///< grows linearly over this time [s], >= 0; 0 is at once
};

/// A motion that is imposed by an initial velocity and a body force, so that its exact course is known.
struct DrivenMotion {
  /// Velocity [m/s] at an initial place [m] and time [s]. Read once per particle, at minus half a time step:
  /// the explicit step is a leapfrog whose velocities live halfway between the steps.
  std::function<PerAxis(const PerAxis& initial_place, double time)> velocity;
  /// Force per mass [m/s^2] at an initial place and time; read at the beginning of each step.
  std::function<PerAxis(const PerAxis& initial_place, double time)> body_force;
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
/// At rest, not before all loads have settled: the unbalanced force that the particles feel falls to
/// `unbalanced_force_ratio` times the total weight, and the grid's kinetic energy to `kinetic_energy_ratio`
/// times weight * cell size.
struct AtRest {
  double unbalanced_force_ratio;  ///< [-], > 0
  double kinetic_energy_ratio;    ///< [-], > 0
  double deadline;                ///< [s]; a run not at rest by then ends with that outcome
};

/// When a body has moved so far: the mean displacement of its particles, by mass, along one axis reaches a value.
struct AtDisplacement {
  std::string body;     ///< its name
  int axis = 0;         ///< of the displacement
  double displacement;  ///< [m], with its sign; not zero
  double deadline;      ///< [s], > 0; a run that has not moved so far by then ends with that outcome
};
using Termination = std::variant<AtTime, AtRest, AtDisplacement>;

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
  std::vector<RigidBody> rigid_bodies;
  std::vector<SurfaceLoad> surface_loads;
  std::optional<DrivenMotion> driven_motion;
  Gravity gravity;
  bool sums_strain = false;  ///< whether particles keep the sum of their strain increments, for fields
  bool sums_work = false;    ///< whether particles keep the sum of their stresses' work, for energy balances
  /// Largest half size of a particle of cpgimp along any axis, in cells, above 0 and at most 1: a domain that would
  /// grow beyond stays as large. Without one, such a run ends with domain_too_large.
  std::optional<double> domain_limit;
  /// Sums that go over all steps (position, displacement, velocity, volume, half size, deformation gradient, and the
  /// stress of linear elastic bodies) are compensated [Kahan65]: the part of each increment that rounding cuts off is
  /// kept and added with the next.
  bool compensated_sums = false;
  /// Fills each body in a random order of its particles, the same for the same number; no order is another answer but
  /// for rounding.
  std::optional<std::uint64_t> shuffle;
  /// Of USL, in (0, 1]: a node of less mass than this fraction of what a layer of particles across a cell weighs strains
  /// them as if it were accelerated no more than they are, see `Transfer::slow_light_nodes`. Without one, nodes beyond
  /// a free surface strain the last particle by accelerations that it never feels.
  std::optional<double> light_nodes;
  /// Whether the run is watched for energy that comes from nowhere. Only a measurement of what that costs has a reason
  /// to switch it off.
  bool watched = true;
  std::variant<GivenTimeStep, StableFraction> time_step = StableFraction{0.2};
  Termination termination = AtTime{1.0};
};

/// Time [s] from which no load on the bodies changes any more: gravity, surface loads, densities
/// and the ramps of rigid bodies.
double loads_settled_after(const Scene& scene);

/// When a run of the scene is over at the latest [s].
double latest_end(const Scene& scene);

/// The scene seen from the lower corner of its grid. Particles are kept in these coordinates, so that they lose no
/// digits however far from the origin the scene lies.
Scene from_grid_corner(Scene scene);

/// Throws SceneError for the first value that makes the scene impossible to simulate.
void check(const Scene& scene);

}  // namespace mpm
