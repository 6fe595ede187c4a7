#include "vv/grid_convergence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mpm::vv {
namespace {

std::vector<double> values_of(const std::vector<double>& cell_size, double exact, double factor,
                              double order) {
  std::vector<double> values;
  for (const double h : cell_size) values.push_back(exact + factor * std::pow(h, order));
  return values;
}

// The worked example of [CelikEtAl08]: three grids in two dimensions, with different ratios of refinement.
TEST(VerificationOfGridConvergence, ReproducesThePublishedExample) {
  std::vector<double> cell_size;
  for (const double cells : {4500.0, 8000.0, 18000.0}) cell_size.push_back(1 / std::sqrt(cells));
  const auto found = grid_convergence(cell_size, {5.863, 5.972, 6.063});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->monotone);
  EXPECT_NEAR(found->order, 1.53397, 5e-6);         // printed: 1.53
  EXPECT_NEAR(found->extrapolated, 6.16850, 5e-6);  // printed: 6.1685
  EXPECT_NEAR(found->uncertainty, 0.02175, 5e-6);   // printed: 2.2 % of the finest value
  EXPECT_EQ(found->method, "grid convergence index at the observed order 1.53");
}

TEST(VerificationOfGridConvergence, FindsTheOrderAndTheLimitOfPowers) {
  for (const std::vector<double>& cell_size :
       {std::vector<double>{0.4, 0.2, 0.1}, std::vector<double>{0.3, 0.2, 0.1},
        std::vector<double>{0.2, 0.15, 0.1}}) {
    for (const double order : {0.6, 1.0, 1.5, 1.95}) {
      for (const double factor : {0.7, -0.7}) {
        const auto found = grid_convergence(cell_size, values_of(cell_size, 3.0, factor, order));
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->order, order, 1e-9);
        EXPECT_NEAR(found->extrapolated, 3.0, 1e-10);
        const double finest = 3.0 + factor * std::pow(0.1, order);
        EXPECT_NEAR(found->uncertainty, 1.25 * 0.7 * std::pow(0.1, order) / finest, 1e-10);
      }
    }
  }
}

TEST(GridConvergence, TakesNoOrderAboveTwo) {
  const std::vector<double> cell_size = {0.4, 0.2, 0.1};
  const auto found = grid_convergence(cell_size, values_of(cell_size, 5.0, 1.0, 4.0));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->order, 4.0, 1e-8);
  const double finest = 5.0 + 1e-4, step = 16e-4 - 1e-4;
  EXPECT_NEAR(found->extrapolated, finest - step / 3, 1e-12);
  EXPECT_NEAR(found->uncertainty, 1.25 * step / 3 / finest, 1e-12);
  EXPECT_EQ(found->method, "grid convergence index at the formal order 2.00");
}

TEST(GridConvergence, DoesNotTrustALowOrderOrDifferencesThatGrow) {
  const std::vector<double> cell_size = {0.4, 0.2, 0.1};
  const auto slow = grid_convergence(cell_size, values_of(cell_size, 5.0, 1.0, 0.4));
  ASSERT_TRUE(slow);
  EXPECT_TRUE(slow->monotone);
  EXPECT_NEAR(slow->order, 0.4, 1e-9);
  EXPECT_TRUE(std::isnan(slow->extrapolated));
  EXPECT_NEAR(slow->uncertainty, (std::pow(0.4, 0.4) - std::pow(0.1, 0.4)) / (5.0 + std::pow(0.1, 0.4)),
              1e-12);
  EXPECT_EQ(slow->method, "range of three levels: the observed order 0.40 is not reliable");

  // Each step is 2.83 times the one before: with a magnitude around the logarithm this would be an order
  // of 1.5.
  const auto growing = grid_convergence(cell_size, {1.0, 2.0, 2.0 + std::pow(2.0, 1.5)});
  ASSERT_TRUE(growing);
  EXPECT_NEAR(growing->order, -1.5, 1e-9);
  EXPECT_TRUE(std::isnan(growing->extrapolated));
  EXPECT_NEAR(growing->uncertainty, (1.0 + std::pow(2.0, 1.5)) / (2.0 + std::pow(2.0, 1.5)), 1e-12);
  // Steps of one length, which no power law has but in the limit of a logarithm.
  EXPECT_NEAR(grid_convergence(cell_size, {1.0, 2.0, 3.0})->order, 0.0, 1e-9);
}

TEST(GridConvergence, TakesTheRangeOfValuesThatAreNotMonotone) {
  for (const std::vector<double>& values :
       {std::vector<double>{1.0, 3.0, 2.0}, std::vector<double>{3.0, 1.0, 2.0},
        std::vector<double>{1.0, 2.0, 2.0}, std::vector<double>{2.0, 2.0, 1.5}}) {
    const auto found = grid_convergence({0.4, 0.2, 0.1}, values);
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->monotone);
    EXPECT_TRUE(std::isnan(found->order) && std::isnan(found->extrapolated));
    const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
    EXPECT_DOUBLE_EQ(found->uncertainty, (*greatest - *least) / values.back());
    EXPECT_EQ(found->method, "range of three levels: the values are not monotone");
  }
  EXPECT_DOUBLE_EQ(grid_convergence({0.4, 0.2, 0.1}, {-1.0, -3.0, -2.0})->uncertainty, 1.0);
  EXPECT_EQ(grid_convergence({0.4, 0.2, 0.1}, {2.0, 2.0, 2.0})->uncertainty, 0.0);
}

TEST(GridConvergence, LooksAtTheThreeFinestLevels) {
  const std::vector<double> cell_size = {0.8, 0.4, 0.2, 0.1};
  std::vector<double> values = values_of(cell_size, 5.0, 1.0, 1.0);
  values[0] = -100.0;
  EXPECT_NEAR(grid_convergence(cell_size, values)->order, 1.0, 1e-9);
  values[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(grid_convergence(cell_size, values)->extrapolated, 5.0, 1e-10);
}

TEST(GridConvergence, SaysNothingWithoutThreeLevelsThatRefine) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(grid_convergence({0.2, 0.1}, {1.0, 2.0}));
  EXPECT_FALSE(grid_convergence({0.4, 0.2, 0.1}, {1.0, 2.0}));
  EXPECT_FALSE(grid_convergence({0.2, 0.2, 0.1}, {1.0, 2.0, 2.5}));
  EXPECT_FALSE(grid_convergence({0.1, 0.2, 0.4}, {1.0, 2.0, 2.5}));
  EXPECT_FALSE(grid_convergence({0.2, 0.1, 0.0}, {1.0, 2.0, 2.5}));
  EXPECT_FALSE(grid_convergence({nan, 0.2, 0.1}, {1.0, 2.0, 2.5}));
  EXPECT_FALSE(grid_convergence({0.4, 0.2, 0.1}, {nan, 2.0, 2.5}));
  EXPECT_FALSE(grid_convergence({0.4, 0.2, 0.1}, {2.0, 1.0, 0.0}));
}

}  // namespace
}  // namespace mpm::vv
