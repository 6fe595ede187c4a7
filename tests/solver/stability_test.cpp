#include <gtest/gtest.h>

#include <cmath>

#include "solver/simulation.hpp"
#include "tests/support/column_scene.hpp"

namespace {

using namespace mpm;

/// A free bar with two particles per cell whose last particle stands a quarter of a cell past its node,
/// nudged by a pull so weak that the geometry stays as it is: the largest speed its particles reach after
/// `steps` steps.
double speed_of_free_bar(Scheme scheme, UpdateOrder order, double courant, int steps) {
  Scene scene = test::column_scene(scheme, 10, 2);
  scene.update_order = order;
  scene.damping = 0.0;
  scene.edges[0] = {Condition::free, Condition::free};
  scene.grid_lower[0] = -0.5;
  scene.grid_upper[0] = 1.5;
  scene.bodies[0].upper[0] = 1.05;
  scene.time_step = StableFraction{courant};
  // A rigid pull excites nothing; particle weights at the cut end turn it into strain at round-off, which is
  // enough.
  scene.gravity.level = 1e-9;
  scene.gravity.loading = StagedLoading{10 * courant * 0.1 / 100.0, {1.0, 0.0}};
  scene.termination = AtTime{1e9};
  scene.watched = false;  // round-off is more energy than such a pull gives
  Simulation simulation(scene);
  for (int i = 0; i < steps; ++i) {
    if (!simulation.advance()) return INFINITY;
  }
  double speed = 0.0;
  for (double velocity : simulation.particles().velocity) speed = std::max(speed, std::abs(velocity));
  return speed;
}

struct Limit {
  Scheme scheme;
  UpdateOrder order;
  double courant;  ///< spectral radius of the linearised step becomes 1 here
};

class StabilityOfAFreeBar : public testing::TestWithParam<Limit> {};

TEST_P(StabilityOfAFreeBar, HoldsBelowTheLimitAndIsLostAboveIt) {
  const auto [scheme, order, courant] = GetParam();
  const double below = speed_of_free_bar(scheme, order, 0.97 * courant, 4000);
  const double above = speed_of_free_bar(scheme, order, 1.03 * courant, 4000);
  EXPECT_LT(below, 1e-8);
  EXPECT_GT(above, 1e-3);
}

// Two particles per cell, end particle 0.25 cells past its node: the limits of the linearised step.
INSTANTIATE_TEST_SUITE_P(TwoParticlesPerCell, StabilityOfAFreeBar,
                         testing::Values(Limit{Scheme::mpm, UpdateOrder::usl, 0.657},
                                         Limit{Scheme::ugimp, UpdateOrder::usl, 0.657},
                                         Limit{Scheme::mpm, UpdateOrder::musl, 1.73},
                                         Limit{Scheme::ugimp, UpdateOrder::musl, 1.73},
                                         Limit{Scheme::cpgimp, UpdateOrder::usf, 1.73}));

}  // namespace
