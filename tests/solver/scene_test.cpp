#include "solver/scene.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "solver/error.hpp"

namespace mpm {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// A column that can be simulated: 50 cells of 0.02 m in a grid of 52.
Scene column() {
  Scene scene;
  scene.damping = 0.8;
  scene.cell_size = 0.02;
  scene.grid_lower = {0.0};
  scene.grid_upper = {1.04};
  scene.edges[0] = {Condition::fixed, Condition::free};
  Body body;
  body.name = "column";
  body.lower = {0.0};
  body.upper = {1.0};
  body.density = 1000.0;
  body.material = LinearElastic{1e7, 0.3};
  scene.bodies = {body};
  scene.gravity = {{-9.8}, 50.0, RampLoading{1.0}};
  scene.termination = AtRest{1e-8, 1e-12, 5.0};
  return scene;
}

Scene two_columns() {
  Scene scene = column();
  Body upper = scene.bodies.front();
  upper.name = "upper";
  scene.bodies.front().upper = {0.5};
  upper.lower = {0.5};
  scene.bodies.push_back(upper);
  return scene;
}

Scene block() {
  Scene scene = column();
  scene.dimension = 2;
  scene.grid_upper = {1.04, 1.04};
  scene.bodies.front().upper = {1.0, 1.0};
  scene.gravity.acceleration = {0.0, -9.8};
  return scene;
}

/// A block with a rigid plate on it, on a fixed base.
Scene pressed_block() {
  Scene scene = block();
  scene.edges = {{{Condition::roller, Condition::free}, {Condition::fixed, Condition::free}}};
  RigidBody plate;
  plate.name = "plate";
  plate.lower = {0.2, 1.0};
  plate.upper = {0.4, 1.04};
  plate.velocity = {0.0, -0.1};
  scene.rigid_bodies = {plate};
  scene.surface_loads = {{"column", 1, 1, 0.5, 1.0, {0.0, -10.0}, 0.0}};
  return scene;
}

struct Impossible {
  std::string place;
  std::string expected;  ///< contained in what the error says was expected
  std::string found;     ///< contained in what it says was found
  std::function<void(Scene&)> spoil;
  Scene scene = column();
};

Body& body(Scene& scene) { return scene.bodies.front(); }

void elastic(Scene& scene, double modulus, double ratio) {
  body(scene).material = LinearElastic{modulus, ratio};
}

MohrCoulomb soil(double friction_angle, double cohesion, double dilation_angle) {
  return {1e6, 0.3, friction_angle, cohesion, dilation_angle};
}

const std::vector<Impossible>& impossible_scenes() {
  static const std::vector<Impossible> all = {
      {"/dimension", "1 or 2", "0", [](Scene& s) { s.dimension = 0; }},
      {"/dimension", "1 or 2", "3", [](Scene& s) { s.dimension = 3; }},
      {"/objectivity", "none in one dimension", "jaumann",
       [](Scene& s) { s.objectivity = Objectivity::jaumann; }},
      {"/objectivity", "a known objectivity", "7",
       [](Scene& s) { s.objectivity = static_cast<Objectivity>(7); }, block()},
      {"/bodies/0/material/law", "a law for one dimension", "mohr_coulomb",
       [](Scene& s) { body(s).material = soil(0.3, 0.0, 0.0); }},
      {"/bodies/0/material/friction_angle", "from 0 to below 90 deg", "90 deg",
       [](Scene& s) { body(s).material = soil(std::numbers::pi / 2, 0.0, 0.0); }, block()},
      {"/bodies/0/material/friction_angle", "from 0 to below 90 deg", "-",
       [](Scene& s) { body(s).material = soil(-0.1, 0.0, 0.0); }, block()},
      {"/bodies/0/material/dilation_angle", "from 0 to the friction angle", "deg",
       [](Scene& s) { body(s).material = soil(0.3, 0.0, 0.31); }, block()},
      {"/bodies/0/material/cohesion", "a pressure, zero or above", "-1 Pa",
       [](Scene& s) { body(s).material = soil(0.3, -1.0, 0.0); }, block()},
      {"/bodies/0/material/cohesion", "a pressure above zero where the friction angle is zero", "0 Pa",
       [](Scene& s) { body(s).material = soil(0.0, 0.0, 0.0); }, block()},
      {"/bodies/0/velocity/1", "a finite velocity", "inf",
       [](Scene& s) {
         body(s).velocity = {0.0, std::numeric_limits<double>::infinity()};
       },
       block()},
      {"/scheme", "a known scheme", "7", [](Scene& s) { s.scheme = static_cast<Scheme>(7); }},
      {"/update_order", "a known update order", "7",
       [](Scene& s) { s.update_order = static_cast<UpdateOrder>(7); }},
      {"/precision", "a known precision", "7", [](Scene& s) { s.precision = static_cast<Precision>(7); }},
      {"/domain_limit", "above 0, at most 1", "1.1", [](Scene& s) { s.domain_limit = 1.1; }},
      {"/domain_limit", "above 0, at most 1", "0", [](Scene& s) { s.domain_limit = 0.0; }},
      {"/light_nodes", "usl", "0.5", [](Scene& s) { s.light_nodes = 0.5; }},
      {"/light_nodes", "above 0, at most 1", "0",
       [](Scene& s) {
         s.update_order = UpdateOrder::usl;
         s.light_nodes = 0.0;
       }},
      {"/light_nodes", "above 0, at most 1", "1.5",
       [](Scene& s) {
         s.update_order = UpdateOrder::usl;
         s.light_nodes = 1.5;
       }},
      {"/domain_limit", "half size", "0.01", [](Scene& s) { s.domain_limit = 0.01; }},
      {"/flip_fraction", "0 to 1", "-0.1", [](Scene& s) { s.flip_fraction = -0.1; }},
      {"/flip_fraction", "0 to 1", "1.1", [](Scene& s) { s.flip_fraction = 1.1; }},
      {"/flip_fraction", "0 to 1", "nan", [](Scene& s) { s.flip_fraction = not_a_number; }},
      {"/damping", "0 to below 1", "1", [](Scene& s) { s.damping = 1.0; }},
      {"/damping", "0 to below 1", "-0.8", [](Scene& s) { s.damping = -0.8; }},
      {"/damping", "0 to below 1", "nan", [](Scene& s) { s.damping = not_a_number; }},

      {"/grid/cell_size", "above zero", "0 m", [](Scene& s) { s.cell_size = 0.0; }},
      {"/grid/cell_size", "above zero", "-0.02 m", [](Scene& s) { s.cell_size = -0.02; }},
      {"/grid/cell_size", "above zero", "inf m", [](Scene& s) { s.cell_size = infinity; }},
      {"/grid/cell_size", "above zero", "nan m", [](Scene& s) { s.cell_size = not_a_number; }},
      {"/grid/cell_size", "at most 100000000 cells", "of them", [](Scene& s) { s.cell_size = 1e-9; }},
      {"/grid/lower/0", "a finite length", "-inf m", [](Scene& s) { s.grid_lower[0] = -infinity; }},
      {"/grid/upper/0", "a finite length", "nan m", [](Scene& s) { s.grid_upper[0] = not_a_number; }},
      {"/grid/upper/0", "at least one cell", "0 m", [](Scene& s) { s.grid_upper[0] = 0.0; }},
      {"/grid/upper/0", "at least one cell", "-1.04 m", [](Scene& s) { s.grid_upper[0] = -1.04; }},
      {"/grid/upper/0", "a whole number of cells of 0.02 m", "52.5 cells",
       [](Scene& s) { s.grid_upper[0] = 1.05; }},

      {"/bodies", "at least one body", "none", [](Scene& s) { s.bodies.clear(); }},
      {"/bodies/0/name", "a name", "an empty text", [](Scene& s) { body(s).name.clear(); }},
      {"/bodies/0/density", "above zero", "0 kg/m^3", [](Scene& s) { body(s).density = 0.0; }},
      {"/bodies/0/density", "above zero", "-1 kg/m^3", [](Scene& s) { body(s).density = -1.0; }},
      {"/bodies/0/density", "above zero", "nan kg/m^3", [](Scene& s) { body(s).density = not_a_number; }},
      {"/bodies/0/material/youngs_modulus", "above zero", "0 Pa", [](Scene& s) { elastic(s, 0.0, 0.3); }},
      {"/bodies/0/material/youngs_modulus", "above zero", "-10000000 Pa",
       [](Scene& s) { elastic(s, -1e7, 0.3); }},
      {"/bodies/0/material/youngs_modulus", "above zero", "nan Pa",
       [](Scene& s) { elastic(s, not_a_number, 0.3); }},
      {"/bodies/0/material/youngs_modulus", "above zero", "-1 Pa",
       [](Scene& s) { body(s).material = ZhangElastic{-1.0}; }},
      {"/bodies/0/material/youngs_modulus", "wave speed", "1e+300 Pa at a density of 1e-300 kg/m^3",
       [](Scene& s) {
         elastic(s, 1e300, 0.3);
         body(s).density = 1e-300;
       }},
      {"/bodies/0/material/poissons_ratio", "0 to below 0.5", "0.5", [](Scene& s) { elastic(s, 1e7, 0.5); }},
      {"/bodies/0/material/poissons_ratio", "0 to below 0.5", "-0.1",
       [](Scene& s) { elastic(s, 1e7, -0.1); }},
      {"/bodies/0/material/poissons_ratio", "0 to below 0.5", "nan",
       [](Scene& s) { elastic(s, 1e7, not_a_number); }},
      {"/bodies/0/material/law", "2 dimensions", "zhang_elastic",
       [](Scene& s) { body(s).material = ZhangElastic{1e7}; }, block()},
      {"/bodies/0/particles_per_cell/0", "at least 1", "0",
       [](Scene& s) { body(s).particles_per_cell[0] = 0; }},
      {"/bodies/0/particles_per_cell", "at most 100000000 particles", "of them",
       [](Scene& s) { body(s).particles_per_cell[0] = 2'000'000'000; }},
      {"/bodies/0/particles_per_cell", "at most 100000000 particles", "2500000000 of them",
       [](Scene& s) {
         body(s).particles_per_cell = {1000, 1000};
       },
       block()},
      {"/bodies/0/lower/0", "a finite length", "nan m", [](Scene& s) { body(s).lower[0] = not_a_number; }},
      {"/bodies/0/upper/0", "a finite length", "inf m", [](Scene& s) { body(s).upper[0] = infinity; }},
      {"/bodies/0/upper/0", "at least one particle", "0 m", [](Scene& s) { body(s).upper[0] = 0.0; }},
      {"/bodies/0/upper/0", "at least one particle", "0.2 m",
       [](Scene& s) {
         body(s).lower[0] = 0.8;
         body(s).upper[0] = 0.2;
       }},
      {"/bodies/0/upper/1", "at least one particle", "0 m", [](Scene& s) { body(s).upper[1] = 0.0; },
       block()},
      {"/bodies/0/lower/0", "inside the grid, which begins at 0 m", "-0.02 m",
       [](Scene& s) { body(s).lower[0] = -0.02; }},
      {"/bodies/0/upper/0", "inside the grid, which ends at 1.04 m", "1.06 m",
       [](Scene& s) { body(s).upper[0] = 1.06; }},
      {"/bodies/0/upper/1", "inside the grid, which ends at 1.04 m", "2 m",
       [](Scene& s) { body(s).upper[1] = 2.0; }, block()},
      {"/bodies/0/lower/0", "a whole number of particle spacings of 0.02 m", "0.01 m, 0.5 spacings",
       [](Scene& s) { body(s).lower[0] = 0.01; }},
      {"/bodies/0/upper/0", "a whole number of particle spacings of 0.005 m", "0.9975 m",
       [](Scene& s) {
         body(s).particles_per_cell[0] = 4;
         body(s).upper[0] = 0.9975;
       }},
      {"/bodies/1/name", "a name no other body has", "\"column\", the name of body 0",
       [](Scene& s) { s.bodies[1].name = "column"; }, two_columns()},
      {"/bodies/1", "clear of all others", "\"upper\", which overlaps \"column\"",
       [](Scene& s) { s.bodies[1].lower[0] = 0.48; }, two_columns()},

      {"/gravity/acceleration/0", "a finite acceleration", "nan m/s^2",
       [](Scene& s) { s.gravity.acceleration[0] = not_a_number; }},
      {"/gravity/acceleration/1", "a finite acceleration", "inf m/s^2",
       [](Scene& s) { s.gravity.acceleration[1] = infinity; }, block()},
      {"/gravity/level", "zero or above", "-1", [](Scene& s) { s.gravity.level = -1.0; }},
      {"/gravity/level", "zero or above", "inf", [](Scene& s) { s.gravity.level = infinity; }},
      {"/gravity/loading/duration", "above zero", "0 s",
       [](Scene& s) { s.gravity.loading = RampLoading{0.0}; }},
      {"/gravity/loading/duration", "above zero", "-1 s",
       [](Scene& s) { s.gravity.loading = RampLoading{-1.0}; }},
      {"/gravity/loading/hold", "above zero", "0 s",
       [](Scene& s) {
         s.gravity.loading = StagedLoading{0.0, {1.0}};
       }},
      {"/gravity/loading/fractions", "at least one", "none",
       [](Scene& s) {
         s.gravity.loading = StagedLoading{1.0, {}};
       }},
      {"/gravity/loading/fractions/1", "zero or above", "-0.5",
       [](Scene& s) {
         s.gravity.loading = StagedLoading{1.0, {0.5, -0.5}};
       }},
      {"/gravity/loading/fractions/0", "zero or above", "nan",
       [](Scene& s) {
         s.gravity.loading = StagedLoading{1.0, {not_a_number}};
       }},

      {"/time_step/seconds", "above zero", "0 s", [](Scene& s) { s.time_step = GivenTimeStep{0.0}; }},
      {"/time_step/seconds", "above zero", "nan s",
       [](Scene& s) { s.time_step = GivenTimeStep{not_a_number}; }},
      {"/time_step/stable_fraction", "above 0, at most 10", "0",
       [](Scene& s) { s.time_step = StableFraction{0.0}; }},
      {"/time_step/stable_fraction", "above 0, at most 10", "10.5",
       [](Scene& s) { s.time_step = StableFraction{10.5}; }},
      {"/time_step/stable_fraction", "above 0, at most 10", "nan",
       [](Scene& s) { s.time_step = StableFraction{not_a_number}; }},

      {"/termination/time", "above zero", "0 s", [](Scene& s) { s.termination = AtTime{0.0}; }},
      {"/termination/unbalanced_force_ratio", "above zero", "0",
       [](Scene& s) {
         s.termination = AtRest{0.0, 1e-12, 5.0};
       }},
      {"/termination/kinetic_energy_ratio", "above zero", "-1",
       [](Scene& s) {
         s.termination = AtRest{1e-8, -1.0, 5.0};
       }},
      {"/termination/deadline", "above zero", "inf s",
       [](Scene& s) {
         s.termination = AtRest{1e-8, 1e-12, infinity};
       }},
      {"/termination/deadline", "after the loads have settled at 1 s", "0.5 s",
       [](Scene& s) {
         s.termination = AtRest{1e-8, 1e-12, 0.5};
       }},
      {"/termination/deadline", "after the loads have settled at 4 s", "4 s",
       [](Scene& s) {
         s.gravity.loading = StagedLoading{2.0, {0.2, 0.5, 1.0}};
         s.termination = AtRest{1e-8, 1e-12, 4.0};
       }},
      {"/termination/body", "the name of a body", "\"nobody\"",
       [](Scene& s) {
         s.termination = AtDisplacement{"nobody", 0, -0.01, 5.0};
       }},
      {"/termination/component", "an axis of the scene", "axis 1",
       [](Scene& s) {
         s.termination = AtDisplacement{s.bodies[0].name, 1, -0.01, 5.0};
       }},
      {"/termination/displacement", "other than zero", "0 m",
       [](Scene& s) {
         s.termination = AtDisplacement{s.bodies[0].name, 0, 0.0, 5.0};
       }},
      {"/termination/deadline", "above zero", "0 s",
       [](Scene& s) {
         s.termination = AtDisplacement{s.bodies[0].name, 0, -0.01, 0.0};
       }},
      {"/termination/type", "at_time where gravity is zero", "at_rest",
       [](Scene& s) { s.gravity.level = 0.0; }},
      {"/termination/type", "at_time where gravity is zero", "at_rest",
       [](Scene& s) { s.gravity.acceleration = {0.0}; }},

      {"/bodies/0/locking_control", "none in one dimension", "cell_average",
       [](Scene& s) { body(s).locking_control = LockingControl::cell_average; }},
      {"/bodies/0/locking_control", "none with a law whose stress follows from the deformation gradient",
       "cell_average",
       [](Scene& s) {
         body(s).material = NeoHookean{1e7, 0.3};
         body(s).locking_control = LockingControl::cell_average;
       },
       block()},
      {"/bodies/0/locking_control", "a known locking control", "number 2 of none",
       [](Scene& s) { body(s).locking_control = static_cast<LockingControl>(2); }, block()},
      {"/bodies/0/ring", "no ring in one dimension", "one",
       [](Scene& s) { body(s).ring = Ring{{0.5, 0.5}, 0.0, 0.5}; }},
      {"/bodies/0/ring/inner_radius", "zero or above", "-0.1 m",
       [](Scene& s) { body(s).ring = Ring{{0.5, 0.5}, -0.1, 0.5}; }, block()},
      {"/bodies/0/ring/outer_radius", "above the inner one, 0.5 m", "0.5 m",
       [](Scene& s) { body(s).ring = Ring{{0.5, 0.5}, 0.5, 0.5}; }, block()},
      {"/bodies/0/ring/center/1", "a finite length", "nan m",
       [](Scene& s) { body(s).ring = Ring{{0.5, not_a_number}, 0.0, 0.5}; }, block()},
      {"/bodies/0/ring", "at least one particle center", "hold none of the block's",
       [](Scene& s) { body(s).ring = Ring{{5.0, 5.0}, 0.0, 0.5}; }, block()},
      {"/bodies/0/density_ramp/final_density", "above zero", "0 kg/m^3",
       [](Scene& s) { body(s).density_ramp = DensityRamp{0.0, {{0.0, 1.0}}}; }},
      {"/bodies/0/density_ramp/start", "zero or above", "-1 s",
       [](Scene& s) { body(s).density_ramp = DensityRamp{-1.0, {{2000.0, 1.0}}}; }},
      {"/bodies/0/density_ramp/duration", "above zero", "0 s",
       [](Scene& s) { body(s).density_ramp = DensityRamp{0.0, {{2000.0, 0.0}}}; }},
      {"/bodies/0/initial_stress/surface", "not below the body's upper edge, 1 m", "0.9 m",
       [](Scene& s) { body(s).initial_stress = GeostaticStress{0.9, 0.5}; }, block()},
      {"/bodies/0/initial_stress/k0", "zero or above", "-0.5",
       [](Scene& s) { body(s).initial_stress = GeostaticStress{1.0, -0.5}; }, block()},
      {"/bodies/0/initial_stress/type", "a uniform stress where gravity is not along the last axis",
       "geostatic",
       [](Scene& s) {
         s.gravity.acceleration = {1.0, -9.8};
         body(s).initial_stress = GeostaticStress{1.0, 0.5};
       },
       block()},
      {"/bodies/0/initial_stress/xy", "a finite pressure", "inf Pa",
       [](Scene& s) {
         body(s).initial_stress = UniformStress{0.0, 0.0, 0.0, infinity};
       },
       block()},
      {"/bodies/0/initial_stress", "no initial stress with a law whose stress follows from the deformation",
       "one",
       [](Scene& s) {
         body(s).material = NeoHookean{1e7, 0.3};
         body(s).initial_stress = UniformStress{1.0};
       }},
      {"/bodies/0/material/poissons_ratio", "0 to below 0.5", "0.5",
       [](Scene& s) {
         body(s).material = NeoHookean{1e7, 0.5};
       }},

      {"/rigid_bodies/0/name", "a name", "an empty text",
       [](Scene& s) { s.rigid_bodies[0].name.clear(); }, pressed_block()},
      {"/rigid_bodies/0/name", "a name no other body has", "\"column\"",
       [](Scene& s) { s.rigid_bodies[0].name = "column"; }, pressed_block()},
      {"/rigid_bodies/1/name", "a name no other body has", "\"plate\"",
       [](Scene& s) { s.rigid_bodies.push_back(s.rigid_bodies[0]); }, pressed_block()},
      {"/rigid_bodies/0/upper/0", "above the lower corner's, 0.2 m", "0.2 m",
       [](Scene& s) { s.rigid_bodies[0].upper[0] = 0.2; }, pressed_block()},
      {"/rigid_bodies/0/upper/0", "holds a node of the grid", "between two nodes",
       [](Scene& s) {
         s.rigid_bodies[0].lower[0] = 0.205;
         s.rigid_bodies[0].upper[0] = 0.215;
       },
       pressed_block()},
      {"/rigid_bodies/0/upper/1", "at least a cell thick along its motion, 0.02 m", "0.01 m",
       [](Scene& s) { s.rigid_bodies[0].upper[1] = 1.01; }, pressed_block()},
      {"/rigid_bodies/0/constrains", "at least one component", "none",
       [](Scene& s) {
         s.rigid_bodies[0].constrains = {false, false};
       },
       pressed_block()},
      {"/rigid_bodies/0/velocity/1", "a finite velocity", "nan m/s",
       [](Scene& s) { s.rigid_bodies[0].velocity[1] = not_a_number; }, pressed_block()},
      {"/rigid_bodies/0/velocity/0", "no motion along an axis in which an edge", "1 m/s",
       [](Scene& s) {
         s.rigid_bodies[0].lower[0] = 0.0;
         s.rigid_bodies[0].velocity = {1.0, 0.0};
       },
       pressed_block()},
      {"/rigid_bodies/0/angular_velocity", "a finite rate", "inf rad/s",
       [](Scene& s) { s.rigid_bodies[0].angular_velocity = infinity; }, pressed_block()},
      {"/rigid_bodies/0/start", "zero or above", "-1 s", [](Scene& s) { s.rigid_bodies[0].start = -1.0; },
       pressed_block()},
      {"/rigid_bodies/0/ramp", "zero or above", "nan s",
       [](Scene& s) { s.rigid_bodies[0].ramp = not_a_number; }, pressed_block()},

      {"/surface_loads/0/body", "the name of a body", "\"wall\"",
       [](Scene& s) { s.surface_loads[0].body = "wall"; }, pressed_block()},
      {"/surface_loads/0/body", "a whole block", "a ring",
       [](Scene& s) { body(s).ring = Ring{{0.5, 0.5}, 0.0, 0.5}; }, pressed_block()},
      {"/surface_loads/0/edge", "an edge of the body", "axis 2, side 1",
       [](Scene& s) { s.surface_loads[0].axis = 2; }, pressed_block()},
      {"/surface_loads/0/traction/1", "a finite pressure", "inf Pa",
       [](Scene& s) { s.surface_loads[0].traction[1] = infinity; }, pressed_block()},
      {"/surface_loads/0/ramp", "zero or above", "-1 s", [](Scene& s) { s.surface_loads[0].ramp = -1.0; },
       pressed_block()},
      {"/surface_loads/0/to", "a stretch of at least one particle, 0.02 m", "1.5 m to 2 m",
       [](Scene& s) {
         s.surface_loads[0].begin = 1.5;
         s.surface_loads[0].end = 2.0;
       },
       pressed_block()},
      {"/driven_motion", "both a velocity and a body force", "one of them missing",
       [](Scene& s) { s.driven_motion = DrivenMotion{}; }},
  };
  return all;
}

TEST(Check, refuses_what_cannot_be_simulated) {
  for (const Impossible& impossible : impossible_scenes()) {
    Scene scene = impossible.scene;
    impossible.spoil(scene);
    try {
      check(scene);
      ADD_FAILURE() << impossible.place << " passed although it should be " << impossible.expected;
    } catch (const SceneError& error) {
      EXPECT_EQ(error.place(), impossible.place) << error.what();
      EXPECT_NE(error.expected().find(impossible.expected), std::string::npos) << error.what();
      EXPECT_NE(error.found().find(impossible.found), std::string::npos) << error.what();
    }
  }
}

TEST(Check, accepts_what_can_be_simulated) {
  EXPECT_NO_THROW(check(column()));
  EXPECT_NO_THROW(check(two_columns())) << "bodies may touch";
  EXPECT_NO_THROW(check(pressed_block())) << "a plate may touch";
}

TEST(Check, accepts_limits_that_belong_to_the_range) {
  const std::vector<std::function<void(Scene&)>> changes = {
      [](Scene& s) { s.flip_fraction = 0.0; },
      [](Scene& s) { s.damping = 0.0; },
      [](Scene& s) { elastic(s, 1e7, 0.0); },
      [](Scene& s) { elastic(s, 1e7, 0.4999); },
      [](Scene& s) { s.time_step = StableFraction{10.0}; },
      [](Scene& s) { s.grid_upper[0] = 1.0; },
      [](Scene& s) { s.precision = Precision::float32; },
      [](Scene& s) {
        s.gravity.level = 0.0;
        s.termination = AtTime{1.0};
      },
      [](Scene& s) { body(s).material = ZhangElastic{1e7}; },
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    Scene scene = column();
    changes[i](scene);
    EXPECT_NO_THROW(check(scene)) << "change " << i;
  }
}

// A third has no exact decimal: its multiples meet the ends of the grid only to round-off.
TEST(Check, allows_for_round_off_in_whole_numbers_of_cells) {
  Scene scene = column();
  scene.cell_size = 1.0 / 3.0;
  scene.grid_lower = {-0.1};
  scene.grid_upper = {-0.1 + 7.0 / 3.0};
  body(scene).lower = {-0.1 + 1.0 / 3.0};
  body(scene).upper = {-0.1 + 6.0 / 3.0};
  body(scene).particles_per_cell = {3};
  EXPECT_NO_THROW(check(scene));
  body(scene).upper[0] += 1e-5;
  EXPECT_THROW(check(scene), SceneError);
}

TEST(GravityFraction, of_a_step_is_full_from_the_start) {
  const Gravity gravity{{-9.8}, 1.0, StepLoading{}};
  EXPECT_EQ(gravity.fraction(0.0), 1.0);
  EXPECT_EQ(gravity.fraction(10.0), 1.0);
  EXPECT_EQ(gravity.settled_after(), 0.0);
}

TEST(GravityFraction, of_a_ramp_grows_linearly_and_stays) {
  const Gravity gravity{{-9.8}, 1.0, RampLoading{2.0}};
  EXPECT_EQ(gravity.fraction(0.0), 0.0);
  EXPECT_EQ(gravity.fraction(0.5), 0.25);
  EXPECT_EQ(gravity.fraction(2.0), 1.0);
  EXPECT_EQ(gravity.fraction(100.0), 1.0);
  EXPECT_EQ(gravity.settled_after(), 2.0);
}

TEST(GravityFraction, of_stages_jumps_when_a_stage_has_been_held) {
  const Gravity gravity{{-9.8}, 1.0, StagedLoading{0.5, {0.0, 0.25, 1.0}}};
  EXPECT_EQ(gravity.fraction(0.0), 0.0);
  EXPECT_EQ(gravity.fraction(0.4999), 0.0);
  EXPECT_EQ(gravity.fraction(0.5), 0.25);
  EXPECT_EQ(gravity.fraction(0.9999), 0.25);
  EXPECT_EQ(gravity.fraction(1.0), 1.0);
  EXPECT_EQ(gravity.fraction(100.0), 1.0);
  EXPECT_EQ(gravity.settled_after(), 1.0);
}

TEST(GravityFraction, of_one_stage_never_changes) {
  const Gravity gravity{{-9.8}, 1.0, StagedLoading{0.5, {0.7}}};
  EXPECT_EQ(gravity.fraction(0.0), 0.7);
  EXPECT_EQ(gravity.fraction(7.0), 0.7);
  EXPECT_EQ(gravity.settled_after(), 0.0);
}

TEST(GravityFraction, has_settled_when_the_remaining_stages_are_equal) {
  const Gravity gravity{{-9.8}, 1.0, StagedLoading{0.1, {0.5, 1.0, 1.0, 1.0}}};
  EXPECT_EQ(gravity.settled_after(), 0.1);
}

// The end of a stage is a product, not a sum of holds: what has settled by then does act then.
TEST(GravityFraction, is_the_last_one_exactly_when_gravity_has_settled) {
  for (const double hold : {0.1, 0.3, 1.0 / 3.0, 0.7, 1e-5}) {
    for (std::size_t stages = 1; stages < 100; ++stages) {
      std::vector<double> fractions(stages, 0.5);
      fractions.back() = 1.0;
      const Gravity gravity{{-9.8}, 1.0, StagedLoading{hold, fractions}};
      EXPECT_EQ(gravity.fraction(gravity.settled_after()), 1.0) << hold << " s, " << stages << " stages";
    }
  }
}

}  // namespace
}  // namespace mpm
