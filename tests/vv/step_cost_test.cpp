#include "vv/step_cost.hpp"

#include <gtest/gtest.h>

#include "tests/support/column_scene.hpp"

namespace mpm::vv {
namespace {

/// The plainest step there is.
StepKind column_step() {
  return {.dimension = 1,
          .scheme = Scheme::mpm,
          .order = UpdateOrder::usl,
          .law = LawKind::linear_elastic,
          .particles_per_node = 1,
          .damps = false};
}

StepKind plane_step() {
  return {.scheme = Scheme::ugimp, .order = UpdateOrder::usl, .law = LawKind::mohr_coulomb};
}

TEST(StepCost, adds_up_for_the_plainest_step) {
  // Counted by hand. Scatter: weights 5, momentum 1, volume stress 1; of mass and momentum a row each, 2 (1 +
  // 4); of the force one, 5. Into place 15. Gravity 2, acceleration 1 + 4. Gather: weights 5, velocity and
  // acceleration 2 (4 + 2), gradient 4 + 2; the particle follows and moves 12, strain increment 1, volume 3,
  // stress 4.
  const StepCost column = step_cost(column_step());
  EXPECT_EQ(column.operations, 5 + 1 + 1 + 10 + 5 + 15 + 2 + 5 + 5 + 12 + 6 + 12 + 1 + 3 + 4);
  EXPECT_EQ(column.bytes, 8 * (5 + 7 + 5 + 3 + 6 + 3 + 5 + 2));
}

TEST(StepCost, numbers_of_half_the_size_are_half_the_bytes) {
  for (const UpdateOrder order : {UpdateOrder::usl, UpdateOrder::usf, UpdateOrder::musl}) {
    StepKind step = plane_step();
    step.order = order;
    const StepCost twice = step_cost(step);
    step.precision = Precision::float32;
    EXPECT_EQ(step_cost(step).bytes, twice.bytes / 2);
    EXPECT_EQ(step_cost(step).operations, twice.operations);
  }
}

TEST(StepCost, more_particles_share_the_nodes) {
  StepKind step = plane_step();
  const StepCost four = step_cost(step);
  step.particles_per_node = 1;
  const StepCost one = step_cost(step);
  step.particles_per_node = 2;
  const StepCost two = step_cost(step);
  EXPECT_DOUBLE_EQ(one.bytes - two.bytes, 2 * (two.bytes - four.bytes));
  EXPECT_GT(one.bytes, two.bytes);
  EXPECT_GT(one.operations, two.operations);
}

/// What a change of the step adds to it.
template <class Change>
StepCost added_by(Change change, const StepKind& step = plane_step()) {
  StepKind changed = step;
  change(changed);
  const StepCost before = step_cost(step), after = step_cost(changed);
  return {after.bytes - before.bytes, after.operations - before.operations};
}

TEST(StepCost, what_a_step_leaves_out_costs_nothing) {
  // Six operations an axis and node, of four particles each.
  const StepCost undamped = added_by([](StepKind& step) { step.damps = false; });
  EXPECT_DOUBLE_EQ(undamped.operations, -2 * 6 / 4.0);
  EXPECT_EQ(undamped.bytes, 0);
  // Four components read, added to and written.
  const StepCost strain = added_by([](StepKind& step) { step.sums_strain = true; });
  EXPECT_DOUBLE_EQ(strain.operations, 4);
  EXPECT_DOUBLE_EQ(strain.bytes, 8 * 8);
  const StepCost work = added_by([](StepKind& step) { step.sums_work = true; });
  EXPECT_DOUBLE_EQ(work.operations, 18);
  EXPECT_DOUBLE_EQ(work.bytes, 8 * 2);
  const StepCost turn = added_by([](StepKind& step) { step.turns_stress = true; });
  EXPECT_DOUBLE_EQ(turn.operations, 2 * operations_of_a_function + 18 + 3);
  EXPECT_EQ(turn.bytes, 0);
  const StepCost elastic = added_by([](StepKind& step) { step.law = LawKind::linear_elastic; });
  EXPECT_DOUBLE_EQ(elastic.operations, -50);
  EXPECT_EQ(elastic.bytes, 0);
  const StepCost size = added_by([](StepKind& step) { step.scheme = Scheme::cpgimp; });
  EXPECT_DOUBLE_EQ(size.operations, 2 * 2);
  EXPECT_DOUBLE_EQ(size.bytes, 8 * 2);
}

TEST(StepCost, nothing_turns_in_one_dimension) {
  const StepCost turn = added_by(
      [](StepKind& step) {
        step.turns_stress = true;
        step.averages_cells = true;
      },
      column_step());
  EXPECT_EQ(turn.operations, 0);
  EXPECT_EQ(turn.bytes, 0);
}

TEST(StepCost, means_of_cells_take_passes_of_their_own) {
  const auto average = [](StepKind& step) { step.averages_cells = true; };
  StepKind step = plane_step();
  const StepCost usl = added_by(average, step);
  // Cleared twice, summed into twice, read twice: 4 + 8 + 4 scalars of a cell, and the velocities once more.
  // Particles: place, mass, volume and two stresses; place, half size, mass and volume.
  EXPECT_DOUBLE_EQ(usl.bytes, 8 * (6 + 6 + (4 + 8 + 4 + 2) / 4.0));
  // The mean stress 5, sharing it 7, the mean dilation as much as a gather and 5 more, sharing it 7.
  EXPECT_DOUBLE_EQ(usl.operations, 5 + 7 + (78 + 80 + 96 + 6 + 5) + 7);
  step.order = UpdateOrder::musl;
  EXPECT_DOUBLE_EQ(added_by(average, step).bytes, usl.bytes);
  // Stress and force part: the force reads places, half sizes, masses, volumes and stresses again.
  step.order = UpdateOrder::usf;
  EXPECT_DOUBLE_EQ(added_by(average, step).bytes, usl.bytes + 8 * 9);
}

TEST(StepCost, a_stress_of_the_stretch_alone_is_not_read) {
  StepKind step = column_step();
  const auto zhang = [](StepKind& changed) { changed.law = LawKind::zhang_elastic; };
  EXPECT_DOUBLE_EQ(added_by(zhang, step).bytes, -8);
  EXPECT_DOUBLE_EQ(added_by(zhang, step).operations, 0);
  const auto rubber = [](StepKind& changed) { changed.law = LawKind::neo_hookean; };
  EXPECT_DOUBLE_EQ(added_by(rubber, step).operations, -1);
  step.sums_work = true;
  EXPECT_DOUBLE_EQ(added_by(zhang, step).bytes, 0);
  // In the plane four components of the deformation gradient are read in its place, and written.
  EXPECT_DOUBLE_EQ(added_by(rubber, plane_step()).bytes, 8 * 4);
}

Scene two_layers() {
  Scene scene;
  scene.dimension = 2;
  scene.scheme = Scheme::ugimp;
  scene.update_order = UpdateOrder::usl;
  scene.cell_size = 0.1;
  scene.grid_upper = {1.0, 1.0};
  Body lower;
  lower.name = "lower";
  lower.upper = {1.0, 0.3};
  lower.particles_per_cell = {2, 2};
  lower.density = 1000.0;
  lower.material = LinearElastic{1e6, 0.3};
  Body upper = lower;
  upper.name = "upper";
  upper.lower = {0.0, 0.3};
  upper.upper = {1.0, 0.4};
  upper.particles_per_cell = {3, 1};
  upper.material = MohrCoulomb{1e6, 0.3, 0.5, 1e3, 0.0};
  upper.locking_control = LockingControl::cell_average;
  scene.bodies = {lower, upper};
  return scene;
}

TEST(CountedWork, weighs_bodies_by_their_particles) {
  const Scene scene = two_layers();
  const StepKind of_lower = step_of(scene, scene.bodies[0]), of_upper = step_of(scene, scene.bodies[1]);
  EXPECT_EQ(of_lower.law, LawKind::linear_elastic);
  EXPECT_EQ(of_upper.law, LawKind::mohr_coulomb);
  EXPECT_EQ(of_upper.particles_per_node, 3);
  EXPECT_FALSE(of_lower.averages_cells);
  EXPECT_TRUE(of_upper.averages_cells);
  EXPECT_FALSE(of_lower.damps);
  const StepCost lower = step_cost(of_lower), upper = step_cost(of_upper);
  // 120 particles below and 30 above, ten steps.
  const CountedWork work = counted_work(scene, 1500);
  EXPECT_EQ(work.particle_steps, 1500);
  EXPECT_DOUBLE_EQ(work.bytes, 1200 * lower.bytes + 300 * upper.bytes);
  EXPECT_DOUBLE_EQ(work.operations, 1200 * lower.operations + 300 * upper.operations);
}

TEST(CountedWork, knows_what_the_scene_asks_for) {
  Scene scene = test::column_scene(Scheme::cpgimp, 20, 2);
  scene.precision = Precision::float32;
  scene.sums_strain = scene.sums_work = true;
  scene.objectivity = Objectivity::jaumann;
  const StepKind step = step_of(scene, scene.bodies[0]);
  EXPECT_EQ(step.dimension, 1);
  EXPECT_EQ(step.particles_per_node, 2);
  EXPECT_EQ(step.precision, Precision::float32);
  EXPECT_EQ(step.order, UpdateOrder::musl);
  EXPECT_EQ(step.scheme, Scheme::cpgimp);
  EXPECT_TRUE(step.damps && step.sums_strain && step.sums_work && step.turns_stress);
  EXPECT_EQ(counted_work(scene, 0).bytes, 0);
}

TEST(CountedWork, an_element_test_has_none) {
  const CountedWork work = counted_work(Scene(), 100);
  EXPECT_EQ(work.particle_steps, 100);
  EXPECT_EQ(work.bytes, 0);
}

}  // namespace
}  // namespace mpm::vv
