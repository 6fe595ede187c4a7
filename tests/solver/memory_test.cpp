// A scene holds what it needs and no more, and says how much that is.

#include <gtest/gtest.h>
#include <malloc.h>

#include "solver/lanes.hpp"
#include "solver/simulation.hpp"
#include "tests/support/column_scene.hpp"

namespace {

using namespace mpm;

/// A long bar of points, or a block of fixed domains: elastic, USL, and nothing besides.
Scene leanest(int dimension) {
  Scene scene =
      test::column_scene(dimension == 1 ? Scheme::mpm : Scheme::ugimp, dimension == 1 ? 10'000 : 100, 2);
  scene.dimension = dimension;
  scene.update_order = UpdateOrder::usl;
  scene.damping = 0.0;
  if (dimension == 1) return scene;
  scene.grid_upper = {1.0, 1.02};
  scene.edges = {{{Condition::roller, Condition::roller}, {Condition::fixed, Condition::free}}};
  scene.bodies[0].upper = {1.0, 1.0};
  scene.bodies[0].particles_per_cell = {2, 2};
  scene.gravity.acceleration = {0.0, -9.8};
  return scene;
}

double bytes_a_particle(const Scene& scene) {
  const Simulation simulation(scene);
  return static_cast<double>(simulation.memory()) / static_cast<double>(simulation.particle_count());
}

/// Bytes of `numbers` numbers a particle and what comes with it: one number of room to put particles in
/// order; who is in a slot, who was, and where each particle is. And for each cell its node's numbers, the
/// particles in it, and a lane's share of a block and of the index of blocks.
double bytes_of(int numbers, int numbers_a_node, int particles_a_cell) {
  constexpr double number = sizeof(double), index = sizeof(std::int32_t), lanes = lane_count<double>;
  const double cell = numbers_a_node * number + index + (24 + sizeof(std::int64_t)) / lanes;
  return (numbers + 1) * number + 3 * index + cell / particles_a_cell;
}

/// Empty slots beside the body, a reserve of one in 64, rows of nodes with room at their ends, and a list of
/// blocks that may have grown to twice its length.
constexpr double slack_of_a_line = 1.05, slack_of_a_plane = 1.1;

TEST(Memory, of_the_leanest_bar_is_six_numbers_a_particle) {
  // Place, displacement, velocity, stress, mass, volume; five numbers a node.
  const double needed = bytes_of(6, 5, 2), found = bytes_a_particle(leanest(1));
  EXPECT_LE(found, slack_of_a_line * needed);
  EXPECT_GE(found, (6 + 1) * sizeof(double)) << "not all of it is counted";
}

TEST(Memory, of_the_leanest_block_is_fourteen_numbers_a_particle) {
  // Place, displacement, velocity and half size in two components, stress in four, mass, volume; nine numbers
  // a node.
  const double needed = bytes_of(14, 9, 4), found = bytes_a_particle(leanest(2));
  EXPECT_LE(found, slack_of_a_plane * needed);
  EXPECT_GE(found, (14 + 1) * sizeof(double)) << "not all of it is counted";
}

TEST(Memory, is_all_that_the_heap_has_given) {
  const auto live = [] {
    const struct mallinfo2 now = ::mallinfo2();
    return static_cast<double>(now.uordblks + now.hblkhd);
  };
  for (const int dimension : {1, 2}) {
    Scene scene = leanest(dimension);
    for (int variant = 0; variant < 4; ++variant) {
      if (variant == 1) scene.sums_work = scene.sums_strain = true;
      if (variant == 2) scene.surface_loads = {{"column", dimension - 1, 1, 0.0, 1.0, {-1.0, -1.0}, 0.0}};
      if (variant == 2) scene.compensated_sums = true;
      if (variant == 3) scene.light_nodes = 0.5;
      if (variant == 3 && dimension == 2) scene.bodies[0].locking_control = LockingControl::cell_average;
      const double before = live();
      const Simulation simulation(scene);
      EXPECT_NEAR(static_cast<double>(simulation.memory()), live() - before, 0.01 * (live() - before))
          << dimension << "D, variant " << variant;
    }
  }
}

TEST(Memory, grows_by_what_a_scene_asks_for_and_no_more) {
  for (const int dimension : {1, 2}) {
    const Scene plain = leanest(dimension);
    const double before = bytes_a_particle(plain), d = dimension, stress = dimension == 1 ? 1 : 4;
    const auto expect_numbers_more = [&](const char* what, double numbers, const Scene& scene) {
      const double more = (bytes_a_particle(scene) - before) / sizeof(double);
      EXPECT_GE(more, numbers) << dimension << "D " << what;
      EXPECT_LE(more, numbers * 1.2) << dimension << "D " << what;
    };
    Scene scene = plain;
    scene.damping = 0.5;
    expect_numbers_more("damping", 0, scene);
    scene = plain;
    scene.bodies[0].density_ramp = DensityRamp{.start = 0.0, .stages = {{2000.0, 1.0}}};
    expect_numbers_more("density ramp", 0, scene);
    scene = plain;
    scene.update_order = UpdateOrder::usf;
    expect_numbers_more("USF", 0, scene);
    scene.update_order = UpdateOrder::musl;
    expect_numbers_more("MUSL", d, scene);
    scene = plain;
    scene.sums_strain = true;
    expect_numbers_more("strain", stress, scene);
    scene = plain;
    scene.sums_work = true;
    expect_numbers_more("work", 1, scene);
    scene = plain;
    scene.bodies[0].material = NeoHookean{1e7, 0.0};
    expect_numbers_more("neo-Hookean", dimension == 1 ? 1 : 5, scene);
    scene = plain;
    scene.compensated_sums = true;  // place, displacement, velocity, stress, volume
    expect_numbers_more("compensated sums", 3 * d + stress + 1, scene);
    scene.bodies[0].material = NeoHookean{1e7, 0.0};  // no sum of stress, but one of the deformation gradient
    expect_numbers_more("compensated sums of rubber", 3 * d + 1 + (dimension == 1 ? 1 : 5 + 4), scene);
    scene = plain;
    scene.shuffle = 1;
    expect_numbers_more("shuffled", 0, scene);
    if (dimension == 1) continue;
    scene = plain;
    scene.bodies[0].material = MohrCoulomb{1e7, 0.0, 0.3, 1e3, 0.0};
    expect_numbers_more("Mohr–Coulomb", 0, scene);
    scene = plain;
    scene.objectivity = Objectivity::jaumann;
    expect_numbers_more("Jaumann", 0, scene);
    scene.scheme = Scheme::cpgimp;
    expect_numbers_more("cpGIMP", 0, scene);
  }
}

}  // namespace
