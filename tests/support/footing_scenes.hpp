#pragma once

#include <numbers>

#include "solver/scene.hpp"

/// Scenes of one footing, small and round enough to know by hand what is to come out.
namespace mpm::test {

inline constexpr double degree = std::numbers::pi / 180;
inline constexpr double cohesion = 1000.0;  ///< of clay [Pa]

inline MohrCoulomb clay() { return {1e7, 0.3, 0.0, cohesion, 0.0}; }
inline MohrCoulomb sand(double friction_angle) { return {1e7, 0.3, friction_angle, 0.0, friction_angle}; }

/// A strip of 0.8 m in the middle of 4 m of weightless ground, 2 m deep, pressed down by 0.1 m/s.
inline Scene full_model(const Material& material) {
  Scene scene;
  scene.dimension = 2;
  scene.cell_size = 0.1;
  scene.grid_upper = {4.0, 2.4};
  scene.edges = {{{Condition::roller, Condition::roller}, {Condition::fixed, Condition::free}}};
  Body ground;
  ground.name = "ground";
  ground.upper = {4.0, 2.0};
  ground.particles_per_cell = {2, 2};
  ground.density = 2000.0;
  ground.material = material;
  scene.bodies = {ground};
  RigidBody strip{.name = "strip", .lower = {1.6, 2.0}, .upper = {2.4, 2.2}, .velocity = {0.0, -0.1}};
  scene.rigid_bodies = {strip};
  scene.termination = AtTime{11.0};
  return scene;
}

/// The right half of such a strip: its axis is the grid's lower edge in x.
inline Scene half_model(const Material& material) {
  Scene scene = full_model(material);
  scene.rigid_bodies[0].lower[0] = -0.4;
  scene.rigid_bodies[0].upper[0] = 0.4;
  return scene;
}

/// With a pressure [Pa] on part of the ground's surface.
inline Scene loaded(Scene scene, double begin, double end, double pressure) {
  scene.surface_loads.push_back({"ground", 1, 1, begin, end, {0.0, -pressure}, 0.0});
  return scene;
}

/// With gravity of 10 m/s^2.
inline Scene with_gravity(Scene scene, double level = 1.0) {
  scene.gravity.acceleration = {0.0, -10.0};
  scene.gravity.level = level;
  return scene;
}

/// The half model with gravity, where a block of 0.4 m x 0.2 m that grows heavier from 2 s on stands in the
/// place of the strip.
inline Scene block_model(const Material& material) {
  Scene scene = with_gravity(half_model(material));
  scene.rigid_bodies.clear();
  Body block = scene.bodies[0];
  block.name = "block";
  block.lower = {0.0, 2.0};
  block.upper = {0.4, 2.2};
  block.density = 500.0;
  block.density_ramp = DensityRamp{2.0, {{8000.0, 8.0}}};
  block.material = LinearElastic{1e8, 0.3};
  scene.bodies.push_back(block);
  return scene;
}

}  // namespace mpm::test
