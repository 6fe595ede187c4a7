// Linear USL on a free surface: how far past its node the last particle is, bounds the step, unless light nodes are
// treated.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "solver/simulation.hpp"

namespace {

using namespace mpm;

constexpr double modulus = 1e7, density = 1000.0, cell = 0.1;  // a wave takes 100 m/s

/// A free bar of ten cells whose last particle is `offset` cells past a node, under a weak stress that lets it ring.
Scene free_bar(double offset, int per_cell, double courant) {
  Scene scene;
  scene.scheme = Scheme::mpm;
  scene.update_order = UpdateOrder::usl;
  scene.cell_size = cell;
  scene.grid_lower = {-0.5, 0.0};
  scene.grid_upper = {1.7, 0.0};
  Body body;
  body.name = "bar";
  body.anywhere = true;
  body.upper[0] = 1.0 + offset * cell + cell / per_cell / 2;
  body.lower[0] = body.upper[0] - 10 * cell;
  body.particles_per_cell = {per_cell, 1};
  body.density = density;
  body.material = LinearElastic{modulus, 0.0};
  body.initial_stress = UniformStress{.xx = 1.0};
  scene.bodies = {body};
  scene.time_step = StableFraction{courant};
  scene.termination = AtTime{1e9};
  return scene;
}

double largest_speed(const Simulation& simulation) {
  double speed = 0.0;
  for (const double velocity : simulation.particles().velocity) speed = std::max(speed, std::abs(velocity));
  return speed;
}

TEST(LightNodes, LetAnyOffsetOfTheLastParticleBearTheSameStep) {
  // A stress of 1 Pa moves elastic soil at no more than 1 Pa / (density * wave speed), twice that at a free end.
  const double elastic_speed = 2.0 / (density * 100.0);
  for (const int per_cell : {1, 2, 4}) {
    for (const double offset : {0.25, 0.1, 0.01, 0.001, 1e-9}) {
      Scene scene = free_bar(offset, per_cell, 0.6);
      scene.light_nodes = 0.5;
      Simulation treated(scene);
      int steps = 0;
      while (steps < 6000 && treated.advance()) ++steps;
      EXPECT_EQ(steps, 6000) << offset << " with " << per_cell << " a cell";
      EXPECT_LT(largest_speed(treated), elastic_speed) << offset << " with " << per_cell << " a cell";
      if (offset > 0.05) continue;  // closer to the limit of the plain step, which is about sqrt(2 * offset)
      scene.light_nodes.reset();
      Simulation plain(scene);
      steps = 0;
      while (steps < 6000 && plain.advance()) ++steps;
      EXPECT_LT(steps, 100) << offset << " with " << per_cell << " a cell";
    }
  }
}

/// The largest stress [Pa] of one small particle at `offset` cells past a node that is held, whose first is 1e-9 Pa.
double largest_stress_of_one_particle(double offset, double light_nodes, double courant) {
  constexpr int per_cell = 1000;
  Scene scene = free_bar(offset, per_cell, courant);
  scene.grid_lower[0] = 1.0;
  scene.edges[0] = {Condition::fixed, Condition::free};
  scene.bodies[0].lower[0] = scene.bodies[0].upper[0] - cell / per_cell;
  scene.bodies[0].initial_stress = UniformStress{.xx = 1e-9};
  scene.watched = false;
  scene.light_nodes = light_nodes;
  Simulation simulation(scene);
  double largest = 0.0;
  for (int step = 0; step < 1000; ++step) {
    if (!simulation.advance()) return INFINITY;
    largest = std::max(largest, std::abs(simulation.particles().stress[0]));
  }
  return largest;
}

TEST(LightNodes, BoundTheStepOfOneParticleAsDerived) {
  for (const double offset : {1e-3, 0.1, 0.3}) {
    for (const double fraction : {0.25, 0.5, 1.0}) {
      const double share = std::min(offset / fraction, 1.0), q = share / offset + 1 - share;
      const double limit = std::sqrt(4 / (2 * q - 1));
      const double below = largest_stress_of_one_particle(offset, fraction, 0.98 * limit);
      const double above = largest_stress_of_one_particle(offset, fraction, 1.02 * limit);
      EXPECT_LT(below, 1e-7) << offset << " " << fraction;
      EXPECT_GT(above, 1.0) << offset << " " << fraction;
    }
  }
}

/// A block of 4 by 3 cells whose last particles are past nodes on two sides.
Scene free_block() {
  Scene scene = free_bar(0.02, 2, 0.4);
  scene.dimension = 2;
  scene.grid_lower = {-0.5, -0.5};
  scene.grid_upper = {1.7, 1.7};
  scene.bodies[0].particles_per_cell = {2, 2};
  scene.bodies[0].lower = {scene.bodies[0].upper[0] - 0.4, 0.703 - 0.3};
  scene.bodies[0].upper[1] = 0.703;
  scene.bodies[0].material = LinearElastic{modulus, 0.3};
  return scene;
}

TEST(LightNodes, DoNotStrainWhatMovesAsOne) {
  // Falling, and crossing cells, with light nodes all around: the strain of free fall is none.
  for (const int dimension : {1, 2}) {
    Scene scene = dimension == 1 ? free_bar(0.01, 2, 0.5) : free_block();
    scene.bodies[0].initial_stress.reset();
    scene.bodies[0].velocity = {3.0, dimension == 1 ? 0.0 : -2.0};
    scene.gravity.acceleration = {-9.8, dimension == 1 ? 0.0 : 4.0};
    scene.light_nodes = 0.5;
    Simulation simulation(scene);
    for (int step = 0; step < 100; ++step) ASSERT_TRUE(simulation.advance());
    EXPECT_GT(simulation.cell_crossings(), 0);
    for (const double stress : simulation.particles().stress) EXPECT_LT(std::abs(stress), 1e-5);
  }
}

TEST(LightNodes, DoNotStrainWhatPassesANodeByRoundOff) {
  // A sliver that weighs nothing has no velocity of its own: taken as standing still, it would strain the particle by
  // all of its speed. So a point is weighed as if a little beside the node, with light nodes and without.
  Scene scene = free_bar(1e-15, 2, 0.5);
  scene.grid_lower[0] = -1.0;
  scene.grid_upper[0] = 2.0;
  scene.bodies[0].initial_stress.reset();
  scene.bodies[0].velocity[0] = 3.0;
  scene.light_nodes = 0.5;
  for (const std::optional<double> light_nodes : {std::optional<double>(0.5), std::optional<double>()}) {
    scene.light_nodes = light_nodes;
    Simulation simulation(scene);
    ASSERT_TRUE(simulation.advance());
    for (const double stress : simulation.particles().stress) EXPECT_LT(std::abs(stress), 1e-5);
  }
}

TEST(LightNodes, LeaveMomentumAsItIs) {
  Scene scene = free_block();
  scene.bodies[0].initial_stress = UniformStress{.xx = 2e5, .yy = 1e5, .xy = 5e4};
  scene.light_nodes = 0.5;
  Simulation simulation(scene);
  for (int step = 0; step < 500; ++step) ASSERT_TRUE(simulation.advance());
  const ParticleFields fields = simulation.particles();
  PerAxis momentum{};
  double most = 0.0;
  for (std::size_t k = 0; k < fields.velocity.size(); ++k) {
    momentum[k % 2] += fields.mass[k / 2] * fields.velocity[k];
    most += std::abs(fields.mass[k / 2] * fields.velocity[k]);
  }
  EXPECT_GT(most, 1.0);
  EXPECT_NEAR(momentum[0], 0.0, 1e-12 * most);
  EXPECT_NEAR(momentum[1], 0.0, 1e-12 * most);
}

TEST(LightNodes, MakeABlockStableThatIsLostWithout) {
  Scene scene = free_block();
  scene.time_step = StableFraction{0.5};
  for (const bool treated : {false, true}) {
    scene.light_nodes = treated ? std::optional(0.5) : std::nullopt;
    Simulation simulation(scene);
    int steps = 0;
    while (steps < 5000 && simulation.advance()) ++steps;
    if (treated) {
      EXPECT_EQ(steps, 5000);
      EXPECT_LT(largest_speed(simulation), 1e-4);
    } else {
      EXPECT_LT(steps, 1000);
    }
  }
}

TEST(LightNodes, OfALightBodyBesideAHeavyOneAreItsOwn) {
  // What is light goes by the particle that looks at the node: a body a million times lighter, against a heavy one,
  // rings as it does alone against a wall.
  const auto light_bar = [](bool beside_heavy) {
    Scene scene = free_bar(0.01, 2, 0.3);
    scene.light_nodes = 0.5;
    scene.bodies[0].initial_stress = UniformStress{.xx = -10.0};
    if (beside_heavy) {
      Body heavy = scene.bodies[0];
      heavy.name = "heavy";
      heavy.upper[0] = heavy.lower[0];
      heavy.lower[0] -= 2 * cell;
      heavy.density *= 1e6;
      heavy.material = LinearElastic{1e6 * modulus, 0.0};
      heavy.initial_stress.reset();
      scene.bodies.push_back(heavy);
    }
    Simulation simulation(scene);
    for (int step = 0; step < 5000; ++step) EXPECT_TRUE(simulation.advance());
    return largest_speed(simulation);
  };
  EXPECT_LT(light_bar(true), 2 * 10.0 / (density * 100.0));
  EXPECT_LT(light_bar(false), 2 * 10.0 / (density * 100.0));
}

}  // namespace
