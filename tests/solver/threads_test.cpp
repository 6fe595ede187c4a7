#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "solver/simulation.hpp"
#include "solver/workers.hpp"

namespace {

using namespace mpm;

// --- workers alone ----------------------------------------------------------------------------------------

TEST(Workers, DoEveryTaskOnce) {
  for (const int threads : {1, 2, 3, 5, 8}) {
    Workers workers(threads);
    EXPECT_EQ(workers.threads(), threads);
    for (int count = 0; count <= 100; ++count) {
      std::vector<int> done(static_cast<std::size_t>(count), 0);
      workers.run(count, [&](int k) { ++done[static_cast<std::size_t>(k)]; });
      ASSERT_EQ(done, std::vector<int>(static_cast<std::size_t>(count), 1)) << threads << " threads";
    }
  }
}

TEST(Workers, SeeInARoundWhatTheRoundBeforeWrote) {
  // More rounds than there are numbers for tasks, with fewer tasks than threads and with more. No entry is
  // atomic: only the order of the rounds keeps two threads from the same one.
  for (const int threads : {2, 3, 8}) {
    Workers workers(threads);
    std::vector<std::int64_t> numbers(7, 0);
    constexpr int rounds = 100000;
    for (int round = 0; round < rounds; ++round) {
      const int count = 2 + round % 6;
      workers.run(count, [&](int k) {
        const auto place = static_cast<std::size_t>((k + round) % count);
        numbers[place] += 1;
      });
    }
    std::int64_t expected = 0;
    for (int round = 0; round < rounds; ++round) expected += 2 + round % 6;
    EXPECT_EQ(std::accumulate(numbers.begin(), numbers.end(), std::int64_t(0)), expected);
  }
}

TEST(Workers, TakeTasksOfUnequalLengthInDifferentRounds) {
  Workers workers(4);
  for (int round = 0; round < 2000; ++round) {
    std::array<double, 9> sums{};
    workers.run(9, [&](int k) {
      for (int i = 0; i < (k * 37 + round) % 300; ++i) sums[static_cast<std::size_t>(k)] += i;
    });
    for (int k = 0; k < 9; ++k) {
      const int n = (k * 37 + round) % 300;
      ASSERT_EQ(sums[static_cast<std::size_t>(k)], n * (n - 1) / 2.0);
    }
  }
}

TEST(Workers, WorkAtTheSameTime) {
  // Neither task ends before the other has begun.
  Workers workers(2);
  for (int round = 0; round < 200; ++round) {
    std::atomic<int> begun{0};
    workers.run(2, [&](int) {
      ++begun;
      while (begun < 2) std::this_thread::yield();
    });
    ASSERT_EQ(begun, 2);
  }
}

TEST(Workers, ComeAndGo) {
  std::atomic<int> done{0};
  for (int k = 0; k < 300; ++k) {
    Workers idle(1 + k % 5);  // ends without having had a task
    Workers busy(1 + k % 5);
    busy.run(k % 7, [&](int) { ++done; });
  }
  int expected = 0;
  for (int k = 0; k < 300; ++k) expected += k % 7;
  EXPECT_EQ(done, expected);
}

// --- whole runs -------------------------------------------------------------------------------------------

/// A pile between rollers that falls apart under gravity, with a plate that presses on it and a block that
/// runs into it: more than 6000 particles in 40 rows or more.
Scene pile(Scheme scheme, UpdateOrder order, Precision precision, LockingControl locking_control) {
  Scene scene;
  scene.dimension = 2;
  scene.scheme = scheme;
  scene.update_order = order;
  scene.precision = precision;
  scene.objectivity = Objectivity::jaumann;
  scene.sums_strain = true;
  scene.sums_work = true;
  scene.damping = order == UpdateOrder::usf ? 0.0 : 0.5;
  scene.flip_fraction = 0.95;  // so that no method fails within the test
  scene.cell_size = 0.1;
  scene.grid_upper = {5.3, 6.1};
  scene.edges = {{{Condition::roller, Condition::roller}, {Condition::fixed, Condition::free}}};
  Body soil;
  soil.name = "soil";
  soil.upper = {3.7, 4.3};
  soil.particles_per_cell = {2, 2};
  soil.density = 1500.0;
  soil.material = MohrCoulomb{1e5, 0.3, 0.5, 500.0, 0.1};
  soil.locking_control = locking_control;
  Body rubber = soil;
  rubber.name = "rubber";
  rubber.lower = {3.8, 0.9};
  rubber.upper = {5.1, 4.9};
  rubber.velocity = {-1.0, 0.5};
  rubber.material = NeoHookean{1e5, 0.3};
  rubber.locking_control = LockingControl::none;
  Body load = soil;
  load.name = "load";
  load.lower = {0.2, 4.3};
  load.upper = {0.9, 5.0};
  load.velocity = {0.5, 2.5};
  load.material = LinearElastic{2e5, 0.2};
  scene.bodies = {soil, rubber, load};
  RigidBody plate;
  plate.name = "plate";
  plate.lower = {1.5, 4.3};
  plate.upper = {2.6, 4.9};
  plate.velocity = {0.0, -0.5};
  plate.constrains = {false, true};
  scene.rigid_bodies = {plate};
  scene.surface_loads = {SurfaceLoad{"soil", 1, 1, 0.0, 1.0, {300.0, -500.0}, 0.05}};
  scene.gravity.acceleration = {0.0, -9.8};
  scene.time_step = StableFraction{0.2};
  scene.termination = AtTime{1e9};
  return scene;
}

/// All that can be seen of a run, bit for bit.
struct Seen {
  ParticleFields fields;
  std::vector<RigidBodyState> bodies;
  Monitor monitor;
  std::int64_t crossings, arrangements, steps;
};

Seen run(const Scene& scene, int threads, int steps) {
  Simulation simulation(scene, threads);
  for (int k = 0; k < steps && simulation.advance(); ++k) {
  }
  return {simulation.particles(),      simulation.rigid_bodies(), simulation.monitor(),
          simulation.cell_crossings(), simulation.arrangements(), simulation.steps()};
}

void expect_same_bits(const Seen& one, const Seen& other) {
  EXPECT_EQ(one.fields.position, other.fields.position);
  EXPECT_EQ(one.fields.displacement, other.fields.displacement);
  EXPECT_EQ(one.fields.velocity, other.fields.velocity);
  EXPECT_EQ(one.fields.half_size, other.fields.half_size);
  EXPECT_EQ(one.fields.stress, other.fields.stress);
  EXPECT_EQ(one.fields.volume, other.fields.volume);
  EXPECT_EQ(one.fields.mass, other.fields.mass);
  EXPECT_EQ(one.fields.strain, other.fields.strain);
  EXPECT_EQ(one.fields.stress_work, other.fields.stress_work);
  EXPECT_EQ(one.fields.deformation_gradient, other.fields.deformation_gradient);
  EXPECT_EQ(one.fields.body, other.fields.body);
  ASSERT_EQ(one.bodies.size(), other.bodies.size());
  for (std::size_t b = 0; b < one.bodies.size(); ++b) {
    EXPECT_EQ(one.bodies[b].impulse, other.bodies[b].impulse);
    EXPECT_EQ(one.bodies[b].displacement, other.bodies[b].displacement);
  }
  EXPECT_EQ(one.monitor.unbalanced_force_ratio, other.monitor.unbalanced_force_ratio);
  EXPECT_EQ(one.monitor.kinetic_energy_ratio, other.monitor.kinetic_energy_ratio);
  EXPECT_EQ(one.crossings, other.crossings);
  EXPECT_EQ(one.arrangements, other.arrangements);
  EXPECT_EQ(one.steps, other.steps);
}

struct Method {
  Scheme scheme;
  UpdateOrder order;
  Precision precision;
  LockingControl locking_control = LockingControl::none;
};

class Threads : public testing::TestWithParam<Method> {};

TEST_P(Threads, ChangeNoBit) {
  const Scene scene =
      pile(GetParam().scheme, GetParam().order, GetParam().precision, GetParam().locking_control);
  constexpr int steps = 40;
  const Seen alone = run(scene, 1, steps);
  EXPECT_GE(alone.fields.mass.size(), 6000U);
  EXPECT_EQ(alone.steps, steps);
  EXPECT_GT(alone.arrangements, 0);
  EXPECT_GT(alone.crossings, 1000);
  EXPECT_NE(alone.bodies[0].impulse[1], 0.0);
  for (const int threads : {2, 3, 5, 8}) {
    SCOPED_TRACE(std::to_string(threads) + " threads");
    expect_same_bits(alone, run(scene, threads, steps));
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Threads,
                         testing::Values(Method{Scheme::mpm, UpdateOrder::usl, Precision::float64},
                                         Method{Scheme::mpm, UpdateOrder::musl, Precision::float32},
                                         Method{Scheme::ugimp, UpdateOrder::usf, Precision::float64},
                                         Method{Scheme::cpgimp, UpdateOrder::musl, Precision::float64},
                                         Method{Scheme::cpgimp, UpdateOrder::usf, Precision::float32},
                                         Method{Scheme::ugimp, UpdateOrder::usl, Precision::float32,
                                                LockingControl::cell_average},
                                         Method{Scheme::cpgimp, UpdateOrder::musl, Precision::float64,
                                                LockingControl::cell_average},
                                         Method{Scheme::cpgimp, UpdateOrder::usf, Precision::float64,
                                                LockingControl::cell_average}));

}  // namespace
