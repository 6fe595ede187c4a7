#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "solver/simulation.hpp"
#include "tests/support/column_scene.hpp"

namespace {

using namespace mpm;

constexpr Scheme every_scheme[] = {Scheme::mpm, Scheme::ugimp, Scheme::cpgimp};

/// The test column turned upright: three cells wide between rollers, gravity along y.
Scene upright(const Scene& column) {
  Scene scene = column;
  scene.dimension = 2;
  scene.grid_lower = {0.0, column.grid_lower[0]};
  scene.grid_upper = {3 * column.cell_size, column.grid_upper[0]};
  scene.edges = {{{Condition::roller, Condition::roller}, column.edges[0]}};
  Body& body = scene.bodies[0];
  body.lower = {0.0, body.lower[0]};
  body.upper = {3 * column.cell_size, body.upper[0]};
  body.particles_per_cell = {body.particles_per_cell[0], body.particles_per_cell[0]};
  scene.gravity.acceleration = {0.0, column.gravity.acceleration[0]};
  return scene;
}

Simulation run_to_end(const Scene& scene) {
  Simulation simulation(scene);
  while (simulation.advance()) {
  }
  return simulation;
}

/// A column of dry soil with a friction angle of 30 degrees, at rest under its own weight.
ParticleFields settled_soil(double poissons_ratio) {
  Scene scene = upright(test::column_scene(Scheme::cpgimp, 10, 2));
  scene.bodies[0].material = MohrCoulomb{1e7, poissons_ratio, std::acos(-1.0) / 6, 0.0, 0.0};
  scene.gravity.loading = RampLoading{0.2};
  scene.termination = AtRest{1e-4, 1e-8, 5.0};
  const Simulation simulation = run_to_end(scene);
  EXPECT_EQ(simulation.outcome().ending, Ending::at_rest);
  return simulation.particles();
}

TEST(VerificationInPlaneStrain, AColumnBetweenRollersIsTheOneDimensionalOne) {
  for (Scheme scheme : every_scheme) {
    for (UpdateOrder order : {UpdateOrder::musl, UpdateOrder::usf, UpdateOrder::usl}) {
      Scene line = test::column_scene(scheme, 16, 2);
      line.update_order = order;
      line.gravity.level = 20;
      line.gravity.loading = RampLoading{0.05};
      const ParticleFields one = run_to_end(line).particles(), two = run_to_end(upright(line)).particles();
      ASSERT_EQ(two.mass.size(), 6 * one.mass.size());
      for (std::size_t p = 0; p < two.mass.size(); ++p) {
        const std::size_t row = p / 6;
        ASSERT_NEAR(two.displacement[2 * p + 1], one.displacement[row], 1e-12);
        ASSERT_NEAR(two.displacement[2 * p], 0.0, 1e-12);
        ASSERT_NEAR(two.stress[4 * p + 1], one.stress[row], 1e-12 * 1e7);
        ASSERT_NEAR(two.stress[4 * p + 3], 0.0, 1e-12 * 1e7);
      }
    }
  }
}

TEST(VerificationInPlaneStrain, FreeFallOfABlockIsExact) {
  for (Scheme scheme : every_scheme) {
    Scene scene = upright(test::column_scene(scheme, 10, 2));
    scene.damping = 0.0;
    scene.edges = {};
    scene.grid_lower = {-1.0, -1.0};
    scene.grid_upper = {2.0, 2.0};
    scene.bodies[0].velocity = {0.5, 0.25};
    scene.bodies[0].material = MohrCoulomb{1e7, 0.3, 0.5, 1000.0, 0.0};
    scene.termination = AtTime{0.2};
    const Simulation simulation = run_to_end(scene);
    const double t = simulation.time(), dt = simulation.time_step();
    const ParticleFields fields = simulation.particles();
    for (std::size_t p = 0; p < fields.mass.size(); ++p) {
      ASSERT_NEAR(fields.displacement[2 * p], 0.5 * t, 1e-10);
      ASSERT_NEAR(fields.displacement[2 * p + 1], 0.25 * t - 9.8 * (t * t + t * dt) / 2, 1e-10);
    }
  }
}

TEST(VerificationInPlaneStrain, AColumnOfSoilBetweenRollersKeepsTheEarthPressureOfItsElasticity) {
  // Settling under its own weight, E and nu decide the pressure on the sides as long as the limit is not
  // reached: nu/(1 - nu) = 0.43 lies between the active (0.33) and passive (3.0) ratios of 30 degrees.
  const ParticleFields fields = settled_soil(0.3);
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    const double vertical = fields.stress[4 * p + 1];
    EXPECT_NEAR(fields.stress[4 * p], vertical * 0.3 / 0.7,
                1e-5 * 9800);  // but for strain sideways from round-off
    // Half a cell of self-weight is 5 %: the scheme's own error on so coarse a mesh is half of that.
    EXPECT_NEAR(vertical, -9800 * (1 - fields.initial_position[2 * p + 1]), 0.03 * 9800);
  }
}

TEST(VerificationInPlaneStrain, AColumnOfSoilWithoutLateralStiffnessYieldsToTheActiveState) {
  // With nu = 0 the elastic pressure on the sides would be nothing; sand of 30 degrees presses with a third.
  const ParticleFields fields = settled_soil(0.0);
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    const double vertical = fields.stress[4 * p + 1];
    // The limit itself is never passed; what the column swings back while it settles is elastic.
    for (std::size_t sideways : {0u, 2u}) {
      EXPECT_GT(fields.stress[4 * p + sideways] / vertical, 1.0 / 3.0 - 1e-9);
      EXPECT_LT(fields.stress[4 * p + sideways] / vertical, 0.40);
    }
  }
}

TEST(VerificationInPlaneStrain, TheSumsOfAStepDoNotDependOnWhichWayIsUp) {
  // A quarter turn of the whole scene, with its particles in another order: round-off apart the same motion.
  Scene scene = upright(test::column_scene(Scheme::cpgimp, 10, 2));
  scene.edges[0] = {Condition::roller, Condition::free};
  scene.grid_upper[0] = 0.6;
  scene.bodies[0].material = MohrCoulomb{1e6, 0.3, 0.5, 500.0, 0.1};
  scene.objectivity = Objectivity::jaumann;
  scene.termination = AtTime{0.1};
  Scene turned = scene;
  std::swap(turned.grid_lower[0], turned.grid_lower[1]);
  std::swap(turned.grid_upper[0], turned.grid_upper[1]);
  std::swap(turned.edges[0], turned.edges[1]);
  std::swap(turned.bodies[0].lower[0], turned.bodies[0].lower[1]);
  std::swap(turned.bodies[0].upper[0], turned.bodies[0].upper[1]);
  std::swap(turned.gravity.acceleration[0], turned.gravity.acceleration[1]);
  const ParticleFields a = run_to_end(scene).particles(), b = run_to_end(turned).particles();
  double largest = 0.0;
  for (std::size_t row = 0; row < 20; ++row) {
    for (std::size_t column = 0; column < 6; ++column) {
      const std::size_t p = row * 6 + column, q = column * 20 + row;
      ASSERT_NEAR(a.displacement[2 * p], b.displacement[2 * q + 1], 1e-9);
      ASSERT_NEAR(a.displacement[2 * p + 1], b.displacement[2 * q], 1e-9);
      ASSERT_NEAR(a.stress[4 * p + 3], b.stress[4 * q + 3], 1e-3);
      largest = std::max(largest, std::abs(a.displacement[2 * p]));
    }
  }
  EXPECT_GT(largest, 1e-4);  // it did bulge
}

}  // namespace
