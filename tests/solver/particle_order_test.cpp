// The order in which particles are numbered: no order is another answer but for rounding.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "solver/particles.hpp"
#include "solver/simulation.hpp"

namespace {

using namespace mpm;

/// Two blocks that press on each other, with a load on one.
Scene blocks() {
  Scene scene;
  scene.dimension = 2;
  scene.scheme = Scheme::cpgimp;
  scene.cell_size = 0.1;
  scene.grid_upper = {1.0, 1.2};
  scene.edges = {{{Condition::roller, Condition::roller}, {Condition::fixed, Condition::free}}};
  Body lower, upper;
  lower.name = "lower";
  lower.upper = {0.8, 0.4};
  upper.name = "upper";
  upper.lower = {0.2, 0.4};
  upper.upper = {0.6, 0.7};
  for (Body* body : {&lower, &upper}) {
    body->particles_per_cell = {2, 3};
    body->density = 1500.0;
    body->material = LinearElastic{1e6, 0.3};
    scene.bodies.push_back(*body);
  }
  scene.bodies[1].initial_stress = GeostaticStress{0.7, 0.5};
  scene.surface_loads = {{.body = "upper", .axis = 1, .side = 1, .begin = 0.3, .end = 0.5, .traction = {1e3, -5e3}}};
  scene.gravity.acceleration = {0.0, -9.8};
  scene.time_step = StableFraction{0.3};
  scene.termination = AtTime{0.05};
  return scene;
}

ParticleFields end_of(const Scene& scene) {
  Simulation simulation(scene);
  while (simulation.advance()) {
  }
  return simulation.particles();
}

TEST(ParticleOrder, IsTheSameForANumberOnEveryMachine) {
  Scene scene = blocks();
  scene.dimension = 1;
  scene.edges = {};
  scene.bodies.resize(1);
  scene.bodies[0].upper[0] = 0.4;
  const auto order_of = [&](std::uint64_t seed) {
    scene.shuffle = seed;
    std::vector<int> order;
    for (const PerAxis& center : lattice_of(scene, scene.bodies[0]).centers)
      order.push_back(static_cast<int>(std::floor(center[0] / 0.05)));
    return order;
  };
  EXPECT_EQ(order_of(7), order_of(7));
  EXPECT_NE(order_of(7), order_of(8));
  // Of std::mt19937_64, whose numbers the standard prescribes, worked out apart from the code.
  EXPECT_EQ(order_of(7), (std::vector<int>{2, 3, 5, 6, 1, 0, 4, 7}));
}

TEST(ParticleOrder, IsDrawnFromAllOrdersAlike) {
  Scene scene = blocks();
  scene.dimension = 1;
  scene.edges = {};
  scene.bodies.resize(1);
  scene.bodies[0].particles_per_cell = {3, 1};
  scene.bodies[0].upper[0] = 0.1;
  std::map<std::vector<double>, int> times;
  constexpr int draws = 6000;
  for (int seed = 0; seed < draws; ++seed) {
    scene.shuffle = static_cast<std::uint64_t>(seed);
    std::vector<double> order;
    for (const PerAxis& center : lattice_of(scene, scene.bodies[0]).centers) order.push_back(center[0]);
    ++times[order];
  }
  EXPECT_EQ(times.size(), 6u);
  for (const auto& [order, count] : times) EXPECT_NEAR(count, draws / 6, 150);  // five standard deviations
}

TEST(ParticleOrder, ChangesNothingButRounding) {
  const Scene plain = blocks();
  Scene shuffled = plain;
  shuffled.shuffle = 3;
  const ParticleFields expected = end_of(plain), found = end_of(shuffled);
  ASSERT_EQ(found.position.size(), expected.position.size());
  std::map<std::pair<long, long>, std::size_t> particle_at;
  const auto start_of = [](const ParticleFields& fields, std::size_t p) {
    return std::pair(std::lround(1e6 * fields.initial_position[2 * p]),
                     std::lround(1e6 * fields.initial_position[2 * p + 1]));
  };
  for (std::size_t p = 0; p < expected.mass.size(); ++p) particle_at[start_of(expected, p)] = p;
  bool has_other_bits = false, has_other_order = false;
  for (std::size_t p = 0; p < found.mass.size(); ++p) {
    const std::size_t same = particle_at.at(start_of(found, p));
    has_other_order = has_other_order || same != p;
    EXPECT_EQ(found.body[p], expected.body[same]);
    for (std::size_t a = 0; a < 2; ++a) {
      const double velocity = expected.velocity[2 * same + a];
      EXPECT_NEAR(found.position[2 * p + a], expected.position[2 * same + a], 1e-12);
      EXPECT_NEAR(found.displacement[2 * p + a], expected.displacement[2 * same + a], 1e-12);
      EXPECT_NEAR(found.velocity[2 * p + a], velocity, 1e-10);
      has_other_bits = has_other_bits || found.velocity[2 * p + a] != velocity;
    }
    for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(found.stress[4 * p + c], expected.stress[4 * same + c], 1e-6);
  }
  EXPECT_TRUE(has_other_order);
  EXPECT_TRUE(has_other_bits);
}

}  // namespace
