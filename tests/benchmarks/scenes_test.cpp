#include "benchmarks/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "solver/particles.hpp"
#include "vv/case_file.hpp"

namespace mpm::bench {
namespace {

std::size_t particles_in(const Scene& scene) {
  std::size_t count = 0;
  for (const Body& body : scene.bodies) count += lattice_of(scene, body).centers.size();
  return count;
}

Scene footing(std::int64_t particles, Law law = Law::mohr_coulomb) {
  return scene_of({.law = law, .particles = particles});
}

TEST(Scenes, the_footing_of_the_paper_has_its_particles) {
  const Scene scene = vv::read_case(footing_case()).runs.front().scene;
  ASSERT_EQ(scene.bodies.size(), 2u);
  EXPECT_EQ(lattice_of(scene, scene.bodies[0]).centers.size(), 8320u);
  EXPECT_EQ(lattice_of(scene, scene.bodies[1]).centers.size(), 512u);
  EXPECT_EQ(scene.cell_size, 0.005);
  EXPECT_EQ(std::get<GivenTimeStep>(scene.time_step).seconds, 1.5e-5);
  EXPECT_EQ(scene.damping, 0.8);
}

TEST(Scenes, the_footing_at_the_size_of_the_paper_is_the_paper_s) {
  const Scene paper = vv::read_case(footing_case()).runs.front().scene, scaled = footing(8832);
  EXPECT_EQ(particles_in(scaled), 8832u);
  EXPECT_DOUBLE_EQ(scaled.cell_size, paper.cell_size);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    EXPECT_DOUBLE_EQ(scaled.grid_upper[axis], paper.grid_upper[axis]);
    for (std::size_t body = 0; body < 2; ++body) {
      EXPECT_DOUBLE_EQ(scaled.bodies[body].lower[axis], paper.bodies[body].lower[axis]);
      EXPECT_DOUBLE_EQ(scaled.bodies[body].upper[axis], paper.bodies[body].upper[axis]);
    }
  }
}

TEST(Scenes, the_footing_has_the_particles_asked_for) {
  for (const std::int64_t wanted : {1'000, 10'000, 100'000, 1'000'000, 4'000'000}) {
    const Scene scene = footing(wanted);
    EXPECT_NO_THROW(check(scene)) << wanted;
    // The depth of the ground makes the number right within half a row of cells.
    const double row = 4 * scene.grid_upper[0] / scene.cell_size;
    EXPECT_NEAR(static_cast<double>(particles_in(scene)), static_cast<double>(wanted), row / 2 + 1);
  }
}

TEST(Scenes, the_footing_keeps_its_shape) {
  for (const std::int64_t wanted : {10'000, 1'000'000}) {
    const Scene scene = footing(wanted);
    const Body &ground = scene.bodies[0], &block = scene.bodies[1];
    EXPECT_DOUBLE_EQ(ground.upper[0], 0.26);
    EXPECT_NEAR(ground.upper[1], 0.20, 2 * scene.cell_size);
    EXPECT_NEAR(block.upper[0], 0.04, scene.cell_size);
    EXPECT_NEAR(block.upper[1] - block.lower[1], 0.08, scene.cell_size);
    EXPECT_EQ(block.lower[1], ground.upper[1]);
    EXPECT_GT(scene.grid_upper[1], block.upper[1]);
    EXPECT_EQ(scene.edges[0][0], Condition::roller);
    EXPECT_EQ(scene.edges[1][0], Condition::fixed);
    EXPECT_EQ(scene.damping, 0.8);
  }
}

TEST(Scenes, the_choice_of_method_and_law_is_taken_over) {
  const Scene scene = scene_of({.scheme = Scheme::ugimp,
                                .order = UpdateOrder::usl,
                                .law = Law::linear_elastic,
                                .precision = Precision::float32,
                                .particles = 1000});
  EXPECT_EQ(scene.scheme, Scheme::ugimp);
  EXPECT_EQ(scene.update_order, UpdateOrder::usl);
  EXPECT_EQ(scene.precision, Precision::float32);
  EXPECT_TRUE(std::holds_alternative<LinearElastic>(scene.bodies[0].material));
  EXPECT_TRUE(std::holds_alternative<MohrCoulomb>(footing(1000).bodies[0].material));
}

TEST(Scenes, sand_starts_on_the_limit) {
  const Scene scene = footing(1000);
  const double sine = std::sin(std::get<MohrCoulomb>(scene.bodies[0].material).friction_angle);
  EXPECT_NEAR(std::get<GeostaticStress>(*scene.bodies[0].initial_stress).k0, (1 - sine) / (1 + sine), 1e-14);
}

TEST(Scenes, the_footing_goes_on) {
  for (const Scheme scheme : {Scheme::mpm, Scheme::ugimp, Scheme::cpgimp}) {
    Simulation simulation = simulation_of(scene_of({.scheme = scheme, .particles = 1000}), 1);
    for (int step = 0; step < 1500; ++step) ASSERT_TRUE(simulation.advance()) << name_of(scheme) << step;
  }
}

TEST(Scenes, the_column_has_a_particle_a_cell) {
  Simulation simulation = simulation_of(
      scene_of({.model = SceneChoice::Model::column, .scheme = Scheme::mpm, .particles = 50}), 1);
  EXPECT_EQ(simulation.particle_count(), 50);
  EXPECT_TRUE(simulation.advance());
}

TEST(Scenes, what_cannot_be_is_refused) {
  EXPECT_THROW(footing(0), std::invalid_argument);
  EXPECT_THROW(simulation_of(footing(1000), 0), std::invalid_argument);
  EXPECT_THROW(simulation_of(footing(1000), available_threads() + 1), std::invalid_argument);
}

}  // namespace
}  // namespace mpm::bench
