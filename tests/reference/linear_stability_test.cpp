#include "reference/linear_stability.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

namespace mpm::reference {
namespace {

/// The largest time step at which both roots of a wave's quadratic stay within the unit circle, by bisection.
double limit_of_wave(double stiffness, double projection, StrainedBy strained_by) {
  double low = 0.0, high = 1e3;
  while (high - low > 1e-12 * high) {
    const double courant = (low + high) / 2, w = stiffness * courant * courant;
    const std::complex<double> b = strained_by == StrainedBy::grid ? w : w * projection, c = w * projection;
    const auto root = std::sqrt(b * b - 4.0 * c);
    const double largest = std::max(std::abs(1.0 + (-b + root) / 2.0), std::abs(1.0 + (-b - root) / 2.0));
    (largest <= 1 + 1e-12 ? low : high) = courant;
  }
  return low;
}

TEST(VerificationOfLinearStabilityFormulas, EndlessBarOfPointsIsItsWorstWave) {
  for (const std::vector<double>& offsets :
       {std::vector{0.5}, {0.2}, {0.03}, {0.1, 0.6}, {0.01, 0.26, 0.51, 0.76}}) {
    for (const StrainedBy by : {StrainedBy::grid, StrainedBy::particles}) {
      std::vector<BarParticle> points, domains;
      double worst = 1e9;
      for (const double s : offsets) points.push_back({s}), domains.push_back({s, 1e-7});
      for (double theta = 0.001; theta <= std::numbers::pi; theta += 0.001) {
        const double x = std::pow(std::sin(theta / 2), 2);
        double projection = 0.0;
        for (const double s : offsets)
          projection += (1 - 4 * s * (1 - s) * x) / static_cast<double>(offsets.size());
        worst = std::min(worst, limit_of_wave(4 * x, projection, by));
      }
      EXPECT_NEAR(endless_bar_limit(points, by), worst, 1e-5);
      EXPECT_NEAR(endless_bar_limit(domains, by), worst, 1e-5) << "domains that are hardly more than points";
    }
  }
  EXPECT_NEAR(endless_bar_limit({{0.5}}, StrainedBy::grid), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(endless_bar_limit({{0.5}}, StrainedBy::particles), 2.0, 1e-15);
  EXPECT_NEAR(endless_bar_limit({{0.05}}, StrainedBy::particles), 1 / 0.9, 1e-15);
}

TEST(VerificationOfLinearStabilityFormulas, DomainsWithinCellsAreAsPoints) {
  for (const StrainedBy by : {StrainedBy::grid, StrainedBy::particles})
    EXPECT_NEAR(endless_bar_limit({{0.25, 0.25}, {0.75, 0.25}}, by), endless_bar_limit({{0.25}, {0.75}}, by),
                1e-8);
  EXPECT_EQ(lone_stiffness({0.4, 0.1}), lone_stiffness({0.4}));
}

/// Two particles a cell, one of them on the nodes: by hand kappa = 4 x (1 - x/2), t = 1 - 3 x/4 + x^2/32.
TEST(VerificationOfLinearStabilityFormulas, DomainsOverNodesAreWorkedOutByHand) {
  double worst = 0.0;
  for (double x = 0.0; x <= 1.0; x += 1e-5)
    worst = std::max(worst, x * (1 - x / 2) * (1 - 0.75 * x + x * x / 32));
  EXPECT_NEAR(endless_bar_limit({{0.0, 0.25}, {0.5, 0.25}}, StrainedBy::particles), 1 / std::sqrt(worst),
              1e-7);
}

TEST(VerificationOfLinearStabilityFormulas, ALoneDomainIsTheSumOverItsNodes) {
  const auto hat = [](double d) { return std::max(0.0, 1 - std::abs(d)); };
  const auto integral = [](double d) {
    const double t = std::clamp(d, -1.0, 1.0);
    return t * (1 - std::abs(t) / 2);
  };
  for (const auto& [offset, l] :
       {BarParticle{0.0, 0.25}, {0.1, 0.25}, {0.9, 0.25}, {0.3, 0.5}, {0.02, 0.05}}) {
    double sum = 0.0;
    for (int node = -1; node <= 2; ++node) {
      const double d = offset - node, weight = (integral(d + l) - integral(d - l)) / (2 * l);
      if (weight > 1e-12) sum += std::pow((hat(d + l) - hat(d - l)) / (2 * l), 2) / weight;
    }
    EXPECT_NEAR(lone_stiffness({offset, l}), sum, 1e-9 * sum) << offset;
  }
}

TEST(LinearStabilityFormulas, AgreeWhereTheyMeet) {
  EXPECT_NEAR(lone_particle_limit({0.3}), std::sqrt(2 * 0.3 * 0.7), 1e-15);
  EXPECT_NEAR(lone_particle_limit(0.3, 0.3, 0.0), lone_particle_limit({0.3}), 1e-15);
  EXPECT_NEAR(lone_particle_limit(0.3, 0.3, 0.4), lone_particle_limit({0.3}) * std::sqrt(0.6), 1e-15);
  EXPECT_NEAR(lone_particle_limit(0.3, 0.1, 0.0), lone_particle_limit({0.1}), 1e-15);
  for (const int per_cell : {1, 2, 4}) EXPECT_NEAR(free_end_limit(per_cell, 1e-6), std::sqrt(2e-6), 1e-8);
  EXPECT_NEAR(free_end_limit(2, 0.1), std::sqrt(0.2 / (1 + 0.1 * 5 / 9)), 1e-15);
}

TEST(LinearStabilityFormulas, RefuseWhatTheyAreNotFor) {
  EXPECT_THROW(endless_bar_limit({}, StrainedBy::grid), std::invalid_argument);
  EXPECT_THROW(endless_bar_limit({{1.0}}, StrainedBy::grid), std::invalid_argument);
  EXPECT_THROW(endless_bar_limit({{0.5, 1.1}}, StrainedBy::grid), std::invalid_argument);
  EXPECT_THROW(lone_stiffness({0.0}), std::invalid_argument);
  EXPECT_THROW(lone_stiffness({0.5, 0.6}), std::invalid_argument);
  EXPECT_THROW(free_end_limit(0, 0.1), std::invalid_argument);
  EXPECT_THROW(free_end_limit(2, 0.6), std::invalid_argument);
}

}  // namespace
}  // namespace mpm::reference
