#pragma once

#include "solver/scene.hpp"

namespace mpm::test {

/// A column of 1 m standing on a fixed base under gravity: E = 1e7 Pa, 1000 kg/m^3, so its wave speed is 100 m/s.
inline Scene column_scene(Scheme scheme, int cells = 20, int particles_per_cell = 1) {
  Scene scene;
  scene.scheme = scheme;
  scene.damping = 0.8;
  scene.cell_size = 1.0 / cells;
  scene.grid_upper = {1.0 + 2.0 / cells, 0.0};
  scene.edges[0] = {Condition::fixed, Condition::free};
  Body body;
  body.name = "column";
  body.upper = {1.0, 0.0};
  body.particles_per_cell = {particles_per_cell, 1};
  body.density = 1000.0;
  body.material = LinearElastic{1e7, 0.0};
  scene.bodies = {body};
  scene.gravity.acceleration = {-9.8, 0.0};
  scene.termination = AtTime{0.1};
  return scene;
}

}  // namespace mpm::test
