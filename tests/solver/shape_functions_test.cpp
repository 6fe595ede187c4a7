#include "solver/shape_functions.hpp"

#include <gtest/gtest.h>

#include <random>

namespace {

using namespace mpm;

/// Weights and gradients of one particle, with the nodes' places, all in cells.
template <class Shape, class Real>
struct Sample {
  std::array<Real, Shape::width> weight, gradient;
  std::int32_t first;
  Sample(Real position, Real half_size) : first(static_cast<std::int32_t>(position) - Shape::nodes_before) {
    Shape::evaluate(position - static_cast<Real>(first), half_size, Real(1), weight, gradient);
  }
  Real node(std::size_t k) const { return static_cast<Real>(first) + static_cast<Real>(k); }
  Real weight_of(std::int32_t node_index) const {
    const std::int32_t k = node_index - first;
    return k < 0 || k >= Shape::width ? Real(0) : weight[static_cast<std::size_t>(k)];
  }
};

/// Calls `check(position, half_size)` for many places in the grid and half sizes from tiny to a whole cell.
template <class Check>
void for_many_places(Check&& check) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(3.0, 400.0), size(1e-3, 1.0);
  for (int i = 0; i < 20000; ++i) check(place(random), size(random));
  for (double half_size : {0.25, 0.5, 1.0}) {
    for (double position : {3.0, 3.25, 3.5, 3.75, 4.0}) check(position, half_size);
  }
}

template <class Shape>
class EveryShapeFunction : public testing::Test {};
using Shapes = testing::Types<LinearShape, GimpShape>;
TYPED_TEST_SUITE(EveryShapeFunction, Shapes);

// Round-off of a weight: differences of numbers up to 1/2 divided by twice the half size, at places up to 400
// cells.
double round_off(double half_size) { return 400 * std::numeric_limits<double>::epsilon() / half_size; }

TYPED_TEST(EveryShapeFunction, SumsToOneWithGradientsThatSumToZero) {
  for_many_places([](double position, double half_size) {
    const Sample<TypeParam, double> s(position, half_size);
    double weight = 0, gradient = 0;
    for (std::size_t k = 0; k < TypeParam::width; ++k) weight += s.weight[k], gradient += s.gradient[k];
    ASSERT_NEAR(weight, 1.0, round_off(half_size)) << position << " " << half_size;
    ASSERT_NEAR(gradient, 0.0, 4 * round_off(half_size)) << position << " " << half_size;
  });
}

TYPED_TEST(EveryShapeFunction, ReproducesLinearFieldsAndTheirGradient) {
  for_many_places([](double position, double half_size) {
    const Sample<TypeParam, double> s(position, half_size);
    double value = 0, slope = 0;
    for (std::size_t k = 0; k < TypeParam::width; ++k) {
      value += s.weight[k] * (s.node(k) - position);
      slope += s.gradient[k] * (s.node(k) - position);
    }
    // A point is weighed as if a little beside a node that it is on.
    constexpr double moved = TypeParam::nodes_before == 0 ? 2 * LinearShape::nearest<double> : 0.0;
    ASSERT_NEAR(value, 0.0, moved + 4 * round_off(half_size));
    ASSERT_NEAR(slope, 1.0, 8 * round_off(half_size));
  });
}

TYPED_TEST(EveryShapeFunction, IsNeverNegativeBeyondRoundOff) {
  for_many_places([](double position, double half_size) {
    const Sample<TypeParam, double> s(position, half_size);
    for (double weight : s.weight) ASSERT_GE(weight, -round_off(half_size));
  });
}

TYPED_TEST(EveryShapeFunction, HasTheGradientOfItsWeight) {
  constexpr double step = 1e-6;
  for_many_places([](double position, double half_size) {
    // Away from kinks of the linear weights, where there is no derivative.
    if (std::abs(position - std::round(position)) < 1e-4) return;
    const Sample<TypeParam, double> s(position, half_size), before(position - step, half_size),
        after(position + step, half_size);
    for (std::size_t k = 0; k < TypeParam::width; ++k) {
      const auto node = s.first + static_cast<std::int32_t>(k);
      const double slope = (after.weight_of(node) - before.weight_of(node)) / (2 * step);
      // A kink of the gradient within the step costs at most step / (half size).
      ASSERT_NEAR(slope, s.gradient[k], 1e-6 / half_size + round_off(half_size) / step)
          << position << " " << half_size;
    }
  });
}

TEST(GimpWeights, AreTheHatAveragedOverTheDomain) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> place(3.0, 9.0), size(0.01, 1.0);
  constexpr int points = 4000;  // midpoint rule: the kinks of the hat cost about (2l / points)^2
  for (int i = 0; i < 300; ++i) {
    const double position = place(random), half_size = size(random);
    const Sample<GimpShape, double> s(position, half_size);
    for (std::size_t k = 0; k < GimpShape::width; ++k) {
      double average = 0;
      for (int j = 0; j < points; ++j) {
        const double x = position + half_size * (2 * (j + 0.5) / points - 1);
        average += std::max(0.0, 1 - std::abs(x - s.node(k))) / points;
      }
      ASSERT_NEAR(s.weight[k], average, 2e-6) << position << " " << half_size;
    }
  }
}

TEST(GimpWeights, OfHalfACellHaveTheirTextbookValues) {
  const Sample<GimpShape, double> on_node(5.0, 0.5), in_the_middle(5.5, 0.5);
  EXPECT_DOUBLE_EQ(on_node.weight_of(4), 0.125);
  EXPECT_DOUBLE_EQ(on_node.weight_of(5), 0.75);
  EXPECT_DOUBLE_EQ(on_node.weight_of(6), 0.125);
  EXPECT_DOUBLE_EQ(in_the_middle.weight_of(5), 0.5);
  EXPECT_DOUBLE_EQ(in_the_middle.weight_of(6), 0.5);
}

TEST(GimpWeights, BecomeLinearAsTheDomainShrinks) {
  for (double position : {4.1, 4.5, 4.93}) {
    const Sample<GimpShape, double> small(position, 1e-6);
    const Sample<LinearShape, double> point(position, 0.0);
    for (std::int32_t node : {4, 5}) EXPECT_NEAR(small.weight_of(node), point.weight_of(node), 1e-6);
  }
}

TEST(GimpWeights, HoldInFloatToo) {
  for_many_places([](double position, double half_size) {
    if (position > 40.0 || half_size < 0.1) return;
    const Sample<GimpShape, float> s(static_cast<float>(position), static_cast<float>(half_size));
    float sum = 0;
    for (float weight : s.weight) sum += weight;
    ASSERT_NEAR(sum, 1.0F, 1e-4F);
  });
}

}  // namespace
