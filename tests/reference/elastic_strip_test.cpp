#include "reference/elastic_strip.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace {

using namespace mpm::reference;
using std::numbers::pi;

/// Half a footing 80 mm wide on a layer of 200 mm, rollers at 260 mm.
ElasticStrip footing(Roughness roughness = Roughness::smooth) {
  return {0.04, 0.2, 0.26, 1e6, 0.3, roughness};
}

double constrained_modulus(const ElasticStrip& strip) {
  const double nu = strip.poissons_ratio;
  return strip.youngs_modulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
}

/// Settlement of the surface of a layer bonded to a rigid base under p cos(kx), over that of a half plane,
/// without shear at the surface; kappa = k H. Written to stay finite for any kappa.
double layer_compliance(double kappa, double nu) {
  const double bonded = 3 - 4 * nu, decay = std::exp(-2 * kappa);
  return (bonded * (1 - decay * decay) - 4 * kappa * decay) /
         (bonded * (1 + decay * decay) + (4 * kappa * kappa + 1 + bonded * bonded) * decay);
}

/// The stiffness of a smooth strip by another way than elements: the integral equation for the contact
/// pressure. The pressure is a series of Chebyshev polynomials over the square-root singularity in the
/// variable cos(pi x/L), in which the half plane's logarithmic kernel is diagonal; the rest of the layer's
/// kernel is smooth.
double stiffness_by_integral_equation(const ElasticStrip& strip, int points) {
  const double nu = strip.poissons_ratio, first = pi / strip.side_distance;
  const double start = std::cos(first * strip.half_width), span = 1 - start;
  Eigen::VectorXd place(points), angle(points);
  for (int m = 0; m < points; ++m) {
    angle(m) = pi * (m + 0.5) / points;
    place(m) = std::acos(start + span * (1 + std::cos(angle(m))) / 2);
  }
  const double harmonic = 4 * (1 - nu * nu) / (pi * strip.youngs_modulus);
  const double mean = strip.layer_depth / (strip.side_distance * constrained_modulus(strip));

  Eigen::MatrixXd settlement(points, points),
      series(points, points);  // by coefficient; polynomials at the points
  for (int m = 0; m < points; ++m)
    for (int j = 0; j < points; ++j) {
      series(m, j) = std::cos(j * angle(m));
      settlement(m, j) = j == 0 ? mean - harmonic / 2 * std::log(span / 2) : harmonic / 2 * series(m, j) / j;
    }
  Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(points, points);
  for (int n = 1; first * n * strip.layer_depth < 20; ++n) {
    const double excess = layer_compliance(first * n * strip.layer_depth, nu) - 1;
    const Eigen::VectorXd wave = (n * place).array().cos();
    rest += harmonic * excess / n * wave * wave.transpose();
  }
  settlement += rest * series / points;
  const Eigen::VectorXd coefficients = settlement.partialPivLu().solve(Eigen::VectorXd::Ones(points));
  return coefficients(0) / strip.half_width;
}

TEST(VerificationOfElasticStrip, CoveringTheWholeWidthCompressesAColumn) {
  for (Roughness roughness : {Roughness::smooth, Roughness::rough})
    for (double nu : {0.0, 0.3, 0.49}) {
      ElasticStrip strip = footing(roughness);
      strip.half_width = strip.side_distance;
      strip.poissons_ratio = nu;
      const double exact = constrained_modulus(strip) / strip.layer_depth;
      // Uniform strain is in the space of any order: only round-off of the solution is left.
      EXPECT_NEAR(secant_stiffness(strip, 1, 0) / exact, 1, 1e-13);
      EXPECT_NEAR(secant_stiffness(strip, 3, 4) / exact, 1, 1e-11);
      EXPECT_NEAR(deep_layer_stiffness(strip) / exact, 1, 1e-14);
    }
}

TEST(VerificationOfElasticStrip, OnADeepLayerMeetsTheClosedForm) {
  for (double share : {0.15, 0.5, 0.9}) {
    ElasticStrip strip{share, 4.0, 1.0,
                       1e6,   0.3, Roughness::smooth};  // what is left out: some 300 exp(-8 pi) = 4e-9
    const double exact = deep_layer_stiffness(strip);
    EXPECT_NEAR(stiffness_by_integral_equation(strip, 24) / exact, 1, 4e-9);
    const SecantStiffness elements = secant_stiffness(strip);
    EXPECT_NEAR(elements.value, exact, elements.error);
    EXPECT_LT(elements.error, 3e-5 * exact);
  }
}

TEST(VerificationOfElasticStrip, OnAFiniteLayerMeetsTheIntegralEquation) {
  for (double depth : {0.05, 0.2, 0.6})
    for (double nu : {0.0, 0.3, 0.45}) {
      ElasticStrip strip = footing();
      strip.layer_depth = depth;
      strip.poissons_ratio = nu;
      const double exact = stiffness_by_integral_equation(strip, 32);
      EXPECT_NEAR(stiffness_by_integral_equation(strip, 24) / exact, 1, 1e-10);
      // Order 4 and 12 halvings are fast; 2^-12 of an energy that is mostly far from the edge, and from
      // above.
      const double elements = secant_stiffness(strip, 4, 12);
      EXPECT_GT(elements, exact);
      EXPECT_NEAR(elements / exact, 1, 1e-4) << "depth " << depth << ", nu " << nu;
    }
}

TEST(VerificationOfElasticStrip, StatesItsError) {
  const SecantStiffness smooth = secant_stiffness(footing());
  EXPECT_NEAR(smooth.value, stiffness_by_integral_equation(footing(), 32), smooth.error);
  EXPECT_LT(smooth.error, 1e-5 * smooth.value);
  const SecantStiffness rough = secant_stiffness(footing(Roughness::rough));
  EXPECT_NEAR(rough.value, secant_stiffness(footing(Roughness::rough), 6, 18), rough.error);
  EXPECT_LT(rough.error, 1e-5 * rough.value);
}

TEST(VerificationOfElasticStrip, ComesDownUnderRefinementByHalfAHalving) {
  for (Roughness roughness : {Roughness::smooth, Roughness::rough}) {
    for (int order = 1; order < 4; ++order)
      EXPECT_LT(secant_stiffness(footing(roughness), order + 1, 6),
                secant_stiffness(footing(roughness), order, 6));
    double stiffness[4];
    for (int i = 0; i < 4; ++i) stiffness[i] = secant_stiffness(footing(roughness), 3, 5 + i);
    for (int i = 1; i < 4; ++i) EXPECT_LT(stiffness[i], stiffness[i - 1]);
    for (int i = 2; i < 4; ++i)
      EXPECT_NEAR((stiffness[i - 2] - stiffness[i - 1]) / (stiffness[i - 1] - stiffness[i]), 2, 0.2);
  }
}

TEST(VerificationOfElasticStrip, GrowsWithWhatStiffensIt) {
  const auto of = [](const ElasticStrip& strip) { return secant_stiffness(strip, 3, 8); };
  const ElasticStrip strip = footing();
  const double stiffness = of(strip);
  EXPECT_GT(of(footing(Roughness::rough)), stiffness);
  ElasticStrip other = strip;
  other.layer_depth /= 2;
  EXPECT_GT(of(other), stiffness);
  other = strip;
  other.poissons_ratio = 0.45;
  EXPECT_GT(of(other), stiffness);
}

TEST(VerificationOfElasticStrip, ScalesWithItsUnits) {
  const double stiffness = secant_stiffness(footing(Roughness::rough), 3, 8);
  const ElasticStrip in_millimetres{40, 200, 260, 1, 0.3, Roughness::rough};  // N/mm^2
  EXPECT_NEAR(secant_stiffness(in_millimetres, 3, 8) * 1e9 / stiffness, 1, 1e-10);
}

TEST(ElasticStrip, RefusesWhatIsOutsideTheRange) {
  const auto refuses = [](auto change) {
    ElasticStrip strip = footing();
    change(strip);
    EXPECT_THROW(secant_stiffness(strip), std::invalid_argument);
    EXPECT_THROW(secant_stiffness(strip, 1, 0), std::invalid_argument);
    EXPECT_THROW(deep_layer_stiffness(strip), std::invalid_argument);
  };
  refuses([](ElasticStrip& strip) { strip.half_width = 0; });
  refuses([](ElasticStrip& strip) { strip.half_width = 0.27; });
  refuses([](ElasticStrip& strip) { strip.layer_depth = 0; });
  refuses([](ElasticStrip& strip) { strip.layer_depth = std::numeric_limits<double>::infinity(); });
  refuses([](ElasticStrip& strip) { strip.youngs_modulus = -1; });
  refuses([](ElasticStrip& strip) { strip.poissons_ratio = -0.1; });
  refuses([](ElasticStrip& strip) { strip.poissons_ratio = 0.5; });
  refuses([](ElasticStrip& strip) { strip.side_distance = std::numeric_limits<double>::quiet_NaN(); });
  EXPECT_THROW(secant_stiffness(footing(), 0, 3), std::invalid_argument);
  EXPECT_THROW(secant_stiffness(footing(), 2, -1), std::invalid_argument);
}

}  // namespace
