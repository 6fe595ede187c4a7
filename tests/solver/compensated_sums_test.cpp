// Running sums that keep what rounding cuts off them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "solver/compensated_sum.hpp"
#include "solver/simulation.hpp"
#include "tests/support/column_scene.hpp"

namespace {

using namespace mpm;

TEST(CompensatedSums, AddWhatRoundingWouldLose) {
  // A tenth of a unit in the last place, ten million times: alone, none of it would arrive.
  float sum = 1.0F, low = 0.0F, plain = 1.0F;
  constexpr int count = 10000000;
  const float increment = 6e-9F;
  for (int k = 0; k < count; ++k) {
    add_compensated(increment, &sum, &low);
    plain += increment;
  }
  EXPECT_EQ(plain, 1.0F);
  EXPECT_NEAR(sum, 1.0 + count * static_cast<double>(increment), 1e-7);
}

TEST(CompensatedSums, AlsoTakeIncrementsLargerThanTheSum) {
  double sum = 1.0, low = 0.0;
  add_compensated(1e20, &sum, &low);
  EXPECT_EQ(sum, 1e20);
  EXPECT_EQ(low, 1.0);
  add_compensated(-1e20, &sum, &low);
  EXPECT_EQ(sum, 0.0) << "what is lost is below the last digit of the largest increment";
}

TEST(CompensatedSums, OfLanesAreThoseOfNumbers) {
  using Value = Lanes<float>;
  std::vector<float> sums(lane_count<float>, 1.0F), lows(sums.size(), 0.0F);
  float sum = 1.0F, low = 0.0F;
  for (int k = 0; k < 1000; ++k) {
    const float increment = 1e-6F * static_cast<float>(k % 7 - 2);
    add_compensated(Value(increment), sums.data(), lows.data());
    add_compensated(increment, &sum, &low);
  }
  for (std::size_t lane = 0; lane < sums.size(); ++lane) {
    EXPECT_EQ(sums[lane], sum);
    EXPECT_EQ(lows[lane], low);
  }
}

/// Largest difference of a field from that of the same scene in double, over the field's largest value.
struct RoundingErrors {
  double displacement, stress, volume;
};
RoundingErrors rounding_errors(Scene scene) {
  const auto end_of = [](const Scene& wanted) {
    Simulation simulation(wanted);
    while (simulation.advance()) {
    }
    return simulation.particles();
  };
  scene.precision = Precision::float32;
  const ParticleFields found = end_of(scene);
  scene.precision = Precision::float64;
  scene.compensated_sums = false;
  const ParticleFields exact = end_of(scene);
  const auto error = [&](std::vector<double> ParticleFields::*field) {
    double difference = 0.0, largest = 0.0;
    for (std::size_t k = 0; k < (exact.*field).size(); ++k) {
      difference = std::max(difference, std::abs((found.*field)[k] - (exact.*field)[k]));
      largest = std::max(largest, std::abs((exact.*field)[k]));
    }
    return difference / largest;
  };
  return {error(&ParticleFields::displacement), error(&ParticleFields::stress), error(&ParticleFields::volume)};
}

/// The 50G column in 80 000 steps, five hundred a crossing of its shortest wave.
Scene slow_column(Scheme scheme, UpdateOrder order) {
  Scene scene = test::column_scene(scheme, 20, 2);
  scene.update_order = order;
  scene.damping = 0.05;
  scene.gravity.level = 50.0;
  scene.gravity.loading = RampLoading{0.2};
  scene.time_step = GivenTimeStep{5e-6};
  scene.termination = AtTime{0.4};
  return scene;
}

TEST(CompensatedSums, TakeTheRoundingOfAHundredThousandStepsAway) {
  for (const Scheme scheme : {Scheme::ugimp, Scheme::cpgimp}) {
    for (const UpdateOrder order : {UpdateOrder::musl, UpdateOrder::usf, UpdateOrder::usl}) {
      Scene scene = slow_column(scheme, order);
      const RoundingErrors plain = rounding_errors(scene);
      scene.compensated_sums = true;
      const RoundingErrors compensated = rounding_errors(scene);
      EXPECT_LT(compensated.displacement, 1e-6);
      EXPECT_LT(compensated.displacement, plain.displacement / 100);
      EXPECT_LT(compensated.stress, plain.stress / 50);
      EXPECT_LT(compensated.volume, plain.volume / 100);
    }
  }
}

TEST(CompensatedSums, TakeAwayTheRoundingOfEveryLaw) {
  for (const Material& material :
       {Material(ZhangElastic{1e7}), Material(NeoHookean{1e7, 0.0}), Material(LinearElastic{1e7, 0.0})}) {
    Scene scene = slow_column(Scheme::ugimp, UpdateOrder::musl);
    scene.bodies[0].material = material;
    const RoundingErrors plain = rounding_errors(scene);
    scene.compensated_sums = true;
    EXPECT_LT(rounding_errors(scene).displacement, plain.displacement / 10) << material.index();
  }
  for (const Material& material : {Material(NeoHookean{1e7, 0.3}), Material(LinearElastic{1e7, 0.3})}) {
    // Points that stay in their cells: a domain whose edge is on a node reaches beyond it by round-off, and how that
    // sliver moves is a difference of float from double that no sum has made.
    Scene scene = slow_column(Scheme::mpm, UpdateOrder::musl);
    scene.dimension = 2;
    scene.cell_size = 0.1;
    scene.grid_upper = {0.3, 1.2};
    scene.edges = {{{Condition::roller, Condition::free}, {Condition::roller, Condition::free}}};
    scene.bodies[0].upper = {0.25, 1.05};
    scene.bodies[0].particles_per_cell = {2, 2};
    scene.gravity.acceleration = {0.0, -9.8};
    scene.gravity.level = 10.0;
    scene.bodies[0].material = material;
    const RoundingErrors plain = rounding_errors(scene);
    scene.compensated_sums = true;
    EXPECT_LT(rounding_errors(scene).displacement, plain.displacement / 10) << "2D " << material.index();
  }
}

TEST(CompensatedSums, ForgetWhatTheyLostWhenTheParticlesAreSet) {
  Scene scene = slow_column(Scheme::cpgimp, UpdateOrder::musl);
  scene.precision = Precision::float32;
  scene.compensated_sums = true;
  scene.gravity.loading = StepLoading{};  // so that the second course finds what the first has found
  const auto course = [&](int steps_before) {
    Simulation simulation(scene);
    const ParticleFields start = simulation.particles();
    for (int step = 0; step < steps_before; ++step) simulation.advance();
    simulation.set_particles(start);
    for (int step = 0; step < 200; ++step) simulation.advance();
    return simulation.particles();
  };
  EXPECT_EQ(course(0).position, course(500).position);
  EXPECT_EQ(course(0).stress, course(500).stress);
}

TEST(CompensatedSums, KeepTheMeaningOfALimitedDomain) {
  Scene scene = test::column_scene(Scheme::cpgimp, 10, 2);
  scene.compensated_sums = true;
  scene.domain_limit = 0.26;
  scene.edges[0] = {Condition::free, Condition::free};
  scene.grid_lower[0] = -1.0;
  scene.grid_upper[0] = 3.0;
  scene.gravity.level = 0.0;
  scene.damping = 0.0;
  scene.bodies[0].initial_stress = UniformStress{.xx = -3e6};
  Simulation simulation(scene);
  double largest = 0.0;
  for (int step = 0; step < 150; ++step) {
    ASSERT_TRUE(simulation.advance());
    for (const double size : simulation.particles().half_size) largest = std::max(largest, size);
  }
  EXPECT_LE(largest, 0.026);
  EXPECT_GT(largest, 0.02599);
}

}  // namespace
