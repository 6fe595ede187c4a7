#include "solver/energy_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "solver/energy.hpp"
#include "solver/simulation.hpp"
#include "tests/support/column_scene.hpp"

namespace mpm {
namespace {

using test::column_scene;

constexpr Scheme every_scheme[] = {Scheme::mpm, Scheme::ugimp, Scheme::cpgimp};
constexpr UpdateOrder every_order[] = {UpdateOrder::musl, UpdateOrder::usf, UpdateOrder::usl};

/// A bar at rest in a long grid, pulled by nothing, that is let go with a stress.
Scene released_bar(Scheme scheme) {
  Scene scene = column_scene(scheme, 20, 2);
  scene.damping = 0.0;
  scene.edges[0] = {Condition::free, Condition::free};
  scene.grid_lower = {-2.0, 0.0};
  scene.grid_upper = {3.0, 0.0};
  scene.gravity.level = 0.0;
  scene.bodies[0].initial_stress = UniformStress{.xx = -1e4};
  scene.termination = AtTime{1.0};
  return scene;
}

Scene falling_column(Scheme scheme) {
  Scene scene = column_scene(scheme);
  scene.damping = 0.0;
  scene.termination = AtTime{1.0};
  return scene;
}

Simulation run(const Scene& scene) {
  Simulation simulation(scene);
  while (simulation.advance()) {
  }
  return simulation;
}

TEST(EnergyWatch, FindsNoEnergyFromNowhereInASoundRun) {
  for (const Scheme scheme : every_scheme) {
    for (const UpdateOrder order : every_order) {
      for (Scene scene : {released_bar(scheme), falling_column(scheme)}) {
        scene.update_order = order;
        const Simulation simulation = run(scene);
        ASSERT_TRUE(simulation.outcome().completed());
        EXPECT_LT(simulation.monitor().largest_energy_ratio, 1.001);
        EXPECT_GT(simulation.monitor().largest_energy_ratio, 0.1) << "or it looks at something else";
      }
    }
  }
}

TEST(EnergyWatch, KnowsWhatLoadsDo) {
  Scene scene = column_scene(Scheme::cpgimp);
  scene.damping = 0.0;
  scene.gravity.level = 0.0;
  scene.surface_loads = {{.body = "column", .axis = 0, .side = 1, .traction = {-1e4, 0.0}}};
  scene.termination = AtTime{1.0};
  EXPECT_LT(run(scene).monitor().largest_energy_ratio, 1.0);
  EXPECT_GT(run(scene).monitor().largest_energy_ratio, 1e-3);
}

TEST(EnergyWatch, KnowsWhatRigidBodiesDo) {
  Scene scene = column_scene(Scheme::cpgimp);
  scene.damping = 0.0;
  scene.gravity.level = 0.0;
  scene.rigid_bodies = {{.name = "ram", .lower = {0.95, 0.0}, .upper = {1.2, 0.0}, .velocity = {-0.5, 0.0}}};
  scene.termination = AtTime{0.1};
  const Monitor pushed = run(scene).monitor();
  EXPECT_LT(pushed.largest_energy_ratio, 1.0);
  EXPECT_GT(pushed.largest_energy_ratio, 1e-3);
}

TEST(EnergyWatch, StopsARunThatGainsEnergyInBoundedManySteps) {
  for (const Scheme scheme : every_scheme) {
    Scene scene = released_bar(scheme);
    scene.time_step = StableFraction{2.2};
    scene.termination = AtTime{1e4};
    const Simulation simulation = run(scene);
    const Outcome& outcome = simulation.outcome();
    EXPECT_FALSE(outcome.completed());
    EXPECT_GE(outcome.particle, 0);
    EXPECT_LT(outcome.particle, simulation.particle_count());
    EXPECT_LE(outcome.step, 256);
  }
}

TEST(EnergyWatch, NamesTheRatioAndTheFastestParticle) {
  // Just beyond the limit of 1.73, with a stress so small that it is the energy that is noticed first.
  Scene scene = released_bar(Scheme::ugimp);
  scene.bodies[0].initial_stress = UniformStress{.xx = -1e-3};
  scene.time_step = StableFraction{1.74};
  scene.termination = AtTime{1e4};
  const Simulation simulation = run(scene);
  ASSERT_EQ(simulation.outcome().ending, Ending::gained_energy);
  EXPECT_GT(simulation.outcome().value, (EnergyWatch<1, double>::largest_ratio));
  EXPECT_EQ(simulation.outcome().step % 64, 0);
  const ParticleFields fields = simulation.particles();
  const auto named = static_cast<std::size_t>(simulation.outcome().particle);
  for (const double velocity : fields.velocity) EXPECT_LE(std::abs(velocity), std::abs(fields.velocity[named]));
  scene.watched = false;
  EXPECT_NE(run(scene).outcome().ending, Ending::gained_energy);
}

TEST(EnergyWatch, ChangesNoBit) {
  Scene scene = column_scene(Scheme::cpgimp);
  const ParticleFields watched = run(scene).particles();
  scene.watched = false;
  EXPECT_EQ(run(scene).particles().stress, watched.stress);
}

TEST(EnergyWatch, LooksForLessThanAHundredthOfTheTimeOfTheSteps) {
  Scene scene = column_scene(Scheme::mpm, 100, 2);  // the cheapest step there is
  scene.update_order = UpdateOrder::usl;
  scene.watched = false;
  scene.termination = AtTime{1e3};
  Simulation simulation(scene);
  const Particles<1, double> particles = fill_bodies<1, double>(scene, false);
  EnergyWatch<1, double> watch;
  watch.start(scene, particles, 1.0);
  // The shortest of many turns: what disturbs one of them does not count.
  const auto shortest = [](auto&& turn) {
    double least = std::numeric_limits<double>::max();
    for (int k = 0; k < 200; ++k) {
      const auto began = std::chrono::steady_clock::now();
      turn();
      least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    }
    return least;
  };
  const double steps = shortest([&] {
    for (int k = 0; k < 64; ++k) simulation.advance();
  });
  const double looks = shortest([&] {
    for (int k = 0; k < 64; ++k) watch.look(particles, {}, 1e-3, 0.0);
  });
  EXPECT_LT(looks / 64, 0.01 * steps);
}

TEST(SetParticles, GoesOnFromAnyState) {
  for (const Scheme scheme : every_scheme) {
    const Scene scene = falling_column(scheme);
    Simulation whole(scene);
    for (int step = 0; step < 300; ++step) whole.advance();
    Simulation later(scene);
    later.set_particles(whole.particles());
    EXPECT_EQ(later.particles().position, whole.particles().position);
    EXPECT_EQ(later.particles().stress, whole.particles().stress);
    for (int step = 0; step < 100; ++step) {
      whole.advance();
      later.advance();
    }
    const ParticleFields a = whole.particles(), b = later.particles();
    for (std::size_t p = 0; p < a.mass.size(); ++p) {
      EXPECT_NEAR(a.stress[p], b.stress[p], 1e-6);
      EXPECT_NEAR(a.displacement[p], b.displacement[p], 1e-14);
    }
    EXPECT_LT(later.monitor().largest_energy_ratio, 1.001);
  }
}

TEST(SetParticles, RefusesTheStateOfAnother) {
  Simulation simulation(column_scene(Scheme::cpgimp));
  ParticleFields fields = simulation.particles();
  fields.stress.pop_back();
  EXPECT_THROW(simulation.set_particles(fields), std::invalid_argument);
  EXPECT_THROW(simulation.set_particles(Simulation(column_scene(Scheme::cpgimp, 10)).particles()),
               std::invalid_argument);
}

TEST(SetParticles, EndsWithATypedOutcomeOutsideTheGrid) {
  Simulation simulation(column_scene(Scheme::cpgimp));
  ParticleFields fields = simulation.particles();
  fields.position[3] = 1e9;
  simulation.set_particles(fields);
  EXPECT_FALSE(simulation.advance());
  EXPECT_EQ(simulation.outcome().ending, Ending::outside_grid);
  EXPECT_EQ(simulation.outcome().particle, 3);
  EXPECT_EQ(simulation.outcome().value, 1e9);
}

TEST(FarFromTheOrigin, NothingChangesInFloatEither) {
  for (const Precision precision : {Precision::float32, Precision::float64}) {
    Scene near = column_scene(Scheme::cpgimp, 16);
    near.precision = precision;
    Scene far = near;
    constexpr double distance = 1048576.0;  // a power of two, as the cells: no corner is rounded
    for (double* place : {&far.grid_lower[0], &far.grid_upper[0], &far.bodies[0].lower[0], &far.bodies[0].upper[0]})
      *place += distance;
    const ParticleFields here = run(near).particles(), there = run(far).particles();
    EXPECT_EQ(there.displacement, here.displacement);
    EXPECT_EQ(there.stress, here.stress);
    EXPECT_NEAR(there.position.back(), here.position.back() + distance, 1e-9);
  }
}

TEST(DensityRatio, OfABillionLeavesNoBodyBehindInFloat) {
  // Two bars apart, one a billion times lighter, are thrown alike.
  Scene scene = released_bar(Scheme::cpgimp);
  scene.precision = Precision::float32;
  scene.bodies[0].initial_stress.reset();
  scene.bodies[0].velocity = {1.0, 0.0};
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[1].name = "light";
  scene.bodies[1].lower = {-1.5, 0.0};
  scene.bodies[1].upper = {-0.5, 0.0};
  scene.bodies[1].density *= 1e-9;
  scene.bodies[1].material = LinearElastic{1e-2, 0.0};
  const ParticleFields end = run(scene).particles();
  for (const double displacement : end.displacement) EXPECT_NEAR(displacement, 1.0, 1e-3);
}

}  // namespace
}  // namespace mpm
