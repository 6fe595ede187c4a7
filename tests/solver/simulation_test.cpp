#include "solver/simulation.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>

#include "tests/support/column_scene.hpp"

namespace {
std::atomic<long> allocations{0};
}

// Counts every allocation of this test program, so that a step can be shown to make none.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace {

using namespace mpm;
using mpm::test::column_scene;

constexpr Scheme every_scheme[] = {Scheme::mpm, Scheme::ugimp, Scheme::cpgimp};
constexpr UpdateOrder every_order[] = {UpdateOrder::musl, UpdateOrder::usf, UpdateOrder::usl};

Simulation run_to_end(const Scene& scene) {
  Simulation simulation(scene);
  while (simulation.advance()) {
  }
  return simulation;
}

TEST(Simulation, AllocatesNothingInAStep) {
  for (Scheme scheme : every_scheme) {
    for (UpdateOrder order : every_order) {
      for (Precision precision : {Precision::float64, Precision::float32}) {
        Scene scene = column_scene(scheme);
        scene.update_order = order;
        scene.precision = precision;
        scene.gravity.loading = RampLoading{0.05};
        scene.termination = AtRest{1e-5, 1e-10, 10.0};
        Simulation simulation(scene);
        simulation.advance();
        const long before = allocations;
        // Past two looks at the rest criterion.
        for (int i = 0; i < 200; ++i) simulation.advance();
        EXPECT_EQ(allocations - before, 0);
      }
    }
  }
}

TEST(Simulation, AllocatesNothingInAStepWithLockingControl) {
  for (Scheme scheme : every_scheme) {
    for (UpdateOrder order : every_order) {
      for (Precision precision : {Precision::float64, Precision::float32}) {
        Scene scene = column_scene(scheme);
        scene.dimension = 2;
        scene.update_order = order;
        scene.precision = precision;
        scene.grid_upper = {1.1, 0.5};
        scene.bodies[0].upper = {1.0, 0.5};
        scene.bodies[0].particles_per_cell = {2, 2};
        scene.bodies[0].velocity = {0.0, 0.3};  // so that some go astray
        scene.bodies[0].locking_control = LockingControl::cell_average;
        scene.edges[1] = {Condition::roller, Condition::roller};
        scene.termination = AtTime{1e9};
        Simulation simulation(scene);
        simulation.advance();
        const long before = allocations;
        for (int i = 0; i < 200; ++i) simulation.advance();
        EXPECT_EQ(allocations - before, 0);
        EXPECT_EQ(simulation.steps(), 201);
      }
    }
  }
}

TEST(VerificationOfMotion, FreeFallIsExact) {
  for (Scheme scheme : every_scheme) {
    for (UpdateOrder order : every_order) {
      Scene scene = column_scene(scheme);
      scene.update_order = order;
      scene.damping = 0.0;
      scene.edges[0] = {Condition::free, Condition::free};
      scene.grid_lower = {-1.0, 0.0};
      scene.termination = AtTime{0.2};
      const Simulation simulation = run_to_end(scene);
      ASSERT_EQ(simulation.outcome().ending, Ending::reached_time);
      const double t = simulation.time(), dt = simulation.time_step();
      const ParticleFields fields = simulation.particles();
      for (std::size_t p = 0; p < fields.mass.size(); ++p) {
        // Symplectic Euler falls by g (t^2 + t dt) / 2 to round-off.
        EXPECT_NEAR(fields.displacement[p], -9.8 * (t * t + t * dt) / 2, 1e-11);
        EXPECT_NEAR(fields.velocity[p], -9.8 * t, 1e-9);  // round-off strains times the modulus, summed
        // 100 Pa of 10 MPa would already be a strain of 1e-5; round-off of the velocity gradient is far
        // below.
        EXPECT_NEAR(fields.stress[p], 0.0, 1e-3);
      }
    }
  }
}

TEST(Simulation, TakesTheStepItWasGivenOrAFractionOfTheStableOne) {
  Scene scene = column_scene(Scheme::cpgimp, 50);
  scene.time_step = StableFraction{0.2};
  EXPECT_NEAR(Simulation(scene).time_step(), 0.2 * 0.02 / 100.0, 1e-18);
  scene.time_step = GivenTimeStep{1.5e-5};
  EXPECT_EQ(Simulation(scene).time_step(), 1.5e-5);
}

TEST(Simulation, ComesToRestAndSaysSo) {
  Scene scene = column_scene(Scheme::cpgimp);
  scene.gravity.loading = RampLoading{0.1};
  scene.termination = AtRest{1e-4, 1e-8, 5.0};
  const Simulation simulation = run_to_end(scene);
  EXPECT_EQ(simulation.outcome().ending, Ending::at_rest);
  EXPECT_TRUE(simulation.outcome().completed());
  EXPECT_GE(simulation.time(), 0.1);
  EXPECT_LE(simulation.monitor().unbalanced_force_ratio, 1e-4);
  EXPECT_LE(simulation.monitor().kinetic_energy_ratio, 1e-8);
}

TEST(Simulation, SaysWhenTheDeadlineComesBeforeRest) {
  Scene scene = column_scene(Scheme::cpgimp);
  scene.damping = 0.0;
  scene.termination = AtRest{1e-9, 1e-15, 0.05};
  const Simulation simulation = run_to_end(scene);
  EXPECT_EQ(simulation.outcome().ending, Ending::not_at_rest);
  EXPECT_FALSE(simulation.outcome().completed());
  EXPECT_NEAR(simulation.time(), 0.05, simulation.time_step());
}

TEST(Simulation, EndsWhenABodyHasMovedAsFarAsAskedFor) {
  Scene scene = column_scene(Scheme::cpgimp);
  const std::string name = scene.bodies[0].name;
  scene.gravity.loading = RampLoading{1.0};
  scene.termination = AtDisplacement{name, 0, -1e-4, 5.0};
  const Simulation simulation = run_to_end(scene);
  EXPECT_EQ(simulation.outcome().ending, Ending::reached_displacement);
  EXPECT_TRUE(simulation.outcome().completed());
  const ParticleFields end = simulation.particles();
  double moment = 0.0, mass = 0.0;
  for (std::size_t p = 0; p < end.mass.size(); ++p) {
    moment += end.mass[p] * end.displacement[p];
    mass += end.mass[p];
  }
  EXPECT_LE(moment / mass, -1e-4);
  // It is looked for every 64 steps; half the way takes longer than that.
  scene.termination = AtDisplacement{name, 0, -5e-5, 5.0};
  EXPECT_LT(run_to_end(scene).steps(), simulation.steps());
}

TEST(Simulation, SaysWhenTheDeadlineComesBeforeTheDisplacement) {
  Scene scene = column_scene(Scheme::cpgimp);
  scene.termination = AtDisplacement{scene.bodies[0].name, 0, 1e-3, 0.05};  // upwards, where it does not go
  const Simulation simulation = run_to_end(scene);
  EXPECT_EQ(simulation.outcome().ending, Ending::not_reached);
  EXPECT_FALSE(simulation.outcome().completed());
  EXPECT_NEAR(simulation.time(), 0.05, simulation.time_step());
}

TEST(Simulation, NodesThatTurnRoundComeToRestToo) {
  // With the sign of the old velocity the kinetic energy of this column stalls near 3e-10.
  Scene scene = column_scene(Scheme::cpgimp, 50);
  scene.gravity.level = 10;
  scene.gravity.loading = RampLoading{1.0};
  scene.termination = AtTime{3.0};
  EXPECT_LT(run_to_end(scene).monitor().kinetic_energy_ratio, 1e-13);
}

TEST(Simulation, EndsWithATypedOutcomeWhenAParticleLeavesTheGrid) {
  Scene scene = column_scene(Scheme::ugimp);
  scene.edges[0] = {Condition::free, Condition::free};
  scene.termination = AtTime{10.0};
  const Simulation simulation = run_to_end(scene);
  EXPECT_EQ(simulation.outcome().ending, Ending::outside_grid);
  EXPECT_EQ(simulation.outcome().particle, 0);
  EXPECT_LT(simulation.outcome().value, 0.0);
  EXPECT_EQ(simulation.outcome().step, simulation.steps());
  EXPECT_GT(simulation.time(), 0.0);
}

TEST(Simulation, EndsWithATypedOutcomeWhenADomainOutgrowsItsShapeFunction) {
  // Pulled up at 2000G from its fixed end, the column stretches until the domains are too long.
  Scene scene = column_scene(Scheme::cpgimp);
  scene.gravity.acceleration = {9.8, 0.0};
  scene.gravity.level = 2000;
  scene.grid_upper = {20.0, 0.0};
  scene.termination = AtTime{10.0};
  const Simulation simulation = run_to_end(scene);
  EXPECT_EQ(simulation.outcome().ending, Ending::domain_too_large);
  EXPECT_GT(simulation.outcome().value, scene.cell_size);
}

TEST(Simulation, KeepsDomainsWithinTheLimitOfTheScene) {
  Scene scene = column_scene(Scheme::cpgimp);
  scene.gravity.acceleration = {9.8, 0.0};
  scene.gravity.level = 2000;
  scene.grid_upper = {20.0, 0.0};
  scene.termination = AtTime{1.0};
  const Simulation free = run_to_end(scene);
  ASSERT_EQ(free.outcome().ending, Ending::domain_too_large);
  // Held domains are as large as they may be when free ones have outgrown the cell, and go on.
  scene.termination = AtTime{free.time()};
  for (const double limit : {0.55, 1.0}) {
    scene.domain_limit = limit;
    const Simulation held = run_to_end(scene);
    EXPECT_TRUE(held.outcome().completed());
    const ParticleFields particles = held.particles();
    EXPECT_NEAR(*std::max_element(particles.half_size.begin(), particles.half_size.end()), limit * scene.cell_size,
                1e-12);
  }
  // A limit that nothing reaches changes no bit.
  scene.termination = AtTime{free.time() / 2};
  const ParticleFields limited = run_to_end(scene).particles();
  scene.domain_limit.reset();
  EXPECT_EQ(limited.position, run_to_end(scene).particles().position);
}

TEST(Simulation, NeverEndsASilentNan) {
  // Far beyond the stable step everything is possible but a completed run with values that are not numbers.
  for (Scheme scheme : every_scheme) {
    for (double fraction : {2.5, 10.0}) {
      Scene scene = column_scene(scheme);
      scene.time_step = StableFraction{fraction};
      scene.damping = 0.0;
      scene.termination = AtTime{5.0};
      const Simulation simulation = run_to_end(scene);
      EXPECT_FALSE(simulation.outcome().completed());
      EXPECT_GE(simulation.outcome().particle, 0);
    }
  }
}

TEST(Simulation, EndsInTheSameBitsEveryTime) {
  for (Scheme scheme : every_scheme) {
    const Scene scene = column_scene(scheme);
    const ParticleFields a = run_to_end(scene).particles(), b = run_to_end(scene).particles();
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.stress, b.stress);
    EXPECT_EQ(a.velocity, b.velocity);
  }
}

TEST(VerificationOfMotion, ChangeOfUnitsChangesNothing) {
  // Lengths in units of 2^-20 m, masses in units of 2^30 kg: powers of two, so bits must not change. An
  // absolute mass threshold would.
  const double length = std::ldexp(1.0, 20), mass = std::ldexp(1.0, -30);
  for (Scheme scheme : every_scheme) {
    const Scene scene = column_scene(scheme, 16);
    Scene other = scene;
    other.cell_size *= length;
    other.grid_lower[0] *= length;
    other.grid_upper[0] *= length;
    Body& body = other.bodies[0];
    body.upper[0] *= length;
    body.density *= mass / length;  // in 1D mass is per area: the absent dimensions keep their unit
    body.material = LinearElastic{1e7 * mass * length, 0.0};
    other.gravity.acceleration[0] *= length;
    // Wave speeds scale with the length; the time stays.
    const ParticleFields a = run_to_end(scene).particles(), b = run_to_end(other).particles();
    for (std::size_t p = 0; p < a.mass.size(); ++p) {
      ASSERT_EQ(a.position[p] * length, b.position[p]);
      ASSERT_EQ(a.stress[p] * mass * length, b.stress[p]);
    }
  }
}

TEST(VerificationOfMotion, UndampedColumnSwingsToTwiceItsStaticSettlement) {
  // Linear theory: a bar loaded at once by its weight swings to 2 * q h0^2 / (2E) after 2 h0/c. At 0.01G the
  // strains are 1e-5, so the theory is exact to that order; the grid disperses the wave front, hence 2 %.
  for (Scheme scheme : every_scheme) {
    Scene scene = column_scene(scheme, 100);
    scene.damping = 0.0;
    scene.gravity.level = 0.01;
    scene.termination = AtTime{0.02};
    const double static_settlement = 1000 * 9.8 * 0.01 / (2 * 1e7);
    EXPECT_NEAR(-run_to_end(scene).particles().displacement.back(), 2 * static_settlement,
                0.04 * static_settlement);
  }
}

TEST(VerificationOfMotion, EnergyIsKeptWithoutDampingAndLostWithPic) {
  Scene scene = column_scene(Scheme::cpgimp, 50);
  scene.damping = 0.0;
  scene.gravity.level = 0.01;
  scene.termination = AtTime{0.4};  // ten periods of 4 h0/c
  const auto swing = [](const Scene& described) {
    double lowest = 0.0;
    Simulation simulation(described);
    while (simulation.advance()) {
      if (simulation.time() > 0.36) lowest = std::min(lowest, simulation.particles().displacement.back());
    }
    return -lowest;
  };
  const double static_settlement = 1000 * 9.8 * 0.01 / (2 * 1e7);
  EXPECT_GT(swing(scene), 1.8 * static_settlement);
  scene.flip_fraction = 0.0;
  EXPECT_LT(swing(scene), 1.5 * static_settlement);
}

TEST(Simulation, FloatFollowsDouble) {
  for (Scheme scheme : every_scheme) {
    Scene scene = column_scene(scheme);
    const ParticleFields exact = run_to_end(scene).particles();
    scene.precision = Precision::float32;
    const ParticleFields rounded = run_to_end(scene).particles();
    double difference = 0.0, largest = 0.0;
    for (std::size_t p = 0; p < exact.stress.size(); ++p) {
      difference = std::max(difference, std::abs(exact.stress[p] - rounded.stress[p]));
      largest = std::max(largest, std::abs(exact.stress[p]));
    }
    EXPECT_LT(difference, 0.02 * largest);
    EXPECT_GT(difference, 0.0);
  }
}

}  // namespace
