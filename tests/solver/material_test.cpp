#include "solver/material.hpp"

#include <gtest/gtest.h>

namespace {

using namespace mpm;

TEST(VerificationOfLaws, LinearElasticIntegratesToHenckyInOneDimension) {
  const LinearElasticLaw<1, double> law(LinearElastic{1e7, 0.3});
  const double stretch = 0.8;
  for (int steps : {1000, 2000}) {
    SymmetricTensor<1, double> stress{0.0};
    double length = 1.0;
    for (int i = 0; i < steps; ++i) {
      const double increment = std::pow(stretch, 1.0 / steps) - 1;
      stress = law.update(stress, {increment}, 1.0);
      length *= 1 + increment;
    }
    EXPECT_NEAR(length, stretch, 1e-12);
    // First order in the increment: E/2 sum of the squared increments.
    const double lost = 1e7 * std::pow(std::log(stretch), 2) / (2 * steps);
    EXPECT_NEAR(stress[0], 1e7 * std::log(stretch), 1.05 * lost);
    EXPECT_GT(std::abs(stress[0] - 1e7 * std::log(stretch)), 0.95 * lost);
  }
}

TEST(VerificationOfLaws, LinearElasticIsHookesLawInPlaneStrain) {
  const double e = 2e6, nu = 0.3, shear = e / (2 * (1 + nu)), lame = e * nu / ((1 + nu) * (1 - 2 * nu));
  const LinearElasticLaw<2, double> law(LinearElastic{e, nu});
  const SymmetricTensor<2, double> strain{1e-3, -4e-4, 0.0, 2.5e-4};
  const auto stress = law.update({10.0, 20.0, 30.0, 40.0}, strain, 1.0);
  EXPECT_NEAR(stress[0], 10 + lame * 6e-4 + 2 * shear * 1e-3, 1e-9);
  EXPECT_NEAR(stress[1], 20 + lame * 6e-4 - 2 * shear * 4e-4, 1e-9);
  EXPECT_NEAR(stress[2], 30 + lame * 6e-4, 1e-9);
  EXPECT_NEAR(stress[3], 40 + 2 * shear * 2.5e-4, 1e-9);
  EXPECT_NEAR(law.wave_modulus(), lame + 2 * shear, 1e-6);
}

TEST(VerificationOfLaws, ZhangIsAFunctionOfTheStretchAlone) {
  const ZhangElasticLaw<double> law(ZhangElastic{1e7});
  for (double stretch : {0.5, 0.95, 1.0, 1.3}) {
    const auto stress = law.update({12345.0}, {0.1}, stretch);
    EXPECT_NEAR(stress[0], 2e7 * (1 - 1 / std::sqrt(stretch)), 1e-6);
    // Its tangent at rest is Young's modulus, at any stretch E lambda^(-3/2).
    const double step = 1e-6;
    const double tangent =
        (law.update({0.0}, {0.0}, stretch + step)[0] - law.update({0.0}, {0.0}, stretch - step)[0]) /
        (2 * step);
    EXPECT_NEAR(tangent, 1e7 * std::pow(stretch, -1.5), 1e7 * 1e-8);
  }
}

TEST(VerificationOfLaws, TurningAStressKeepsItsInvariantsAndComesBack) {
  const SymmetricTensor<2, double> stress{3.0, -1.0, 0.5, 2.0};
  const auto turned = rotated(stress, 0.7);
  EXPECT_NEAR(turned[0] + turned[1], 2.0, 1e-15);
  EXPECT_NEAR(turned[0] * turned[1] - turned[3] * turned[3], -7.0, 1e-14);
  EXPECT_EQ(turned[2], 0.5);
  const auto back = rotated(turned, -0.7);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(back[c], stress[c], 1e-15);
  // A pull along x turned by a right angle is a pull along y.
  const auto quarter = rotated(SymmetricTensor<2, double>{1.0, 0.0, 0.0, 0.0}, std::acos(0.0));
  EXPECT_NEAR(quarter[0], 0.0, 1e-15);
  EXPECT_NEAR(quarter[1], 1.0, 1e-15);
  // By a small angle anticlockwise, tension along x gets a positive shear component.
  EXPECT_NEAR(rotated(SymmetricTensor<2, double>{1.0, 0.0, 0.0, 0.0}, 1e-6)[3], 1e-6, 1e-15);
}

TEST(Laws, UpdateVolumeBeforeStress) {
  Particles<1, double> particles;
  particles.stress[0] = particles.volume = particles.initial_volume = Field<double>::Ones(lane_count<double>);
  const Deformation<1, Lanes<double>> squeeze{{Lanes<double>(-0.19)}, Lanes<double>(0.0)};
  const StressUpdate<1, double> update_stress{Scene{}};
  update_stress(ZhangElasticLaw<double>(ZhangElastic{1e7}), squeeze, 0, particles);
  for (Eigen::Index lane = 0; lane < lane_count<double>; ++lane) {
    EXPECT_NEAR(particles.volume[lane], 0.81, 1e-15);
    EXPECT_NEAR(particles.stress[0][lane], 2e7 * (1 - 1 / 0.9), 1e-6);
  }
}

}  // namespace
