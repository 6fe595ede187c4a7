#include "reference/manufactured.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace mpm::reference;
using std::numbers::pi;
using Tensor = std::array<double, 4>;  // row-major

/// A motion with large strains, unequal lengths and nothing at the origin, and places within it.
struct Motion {
  std::string name;
  Parameters parameters;
  Solid solid;
  std::vector<Place> places;

  auto solution() const { return manufactured_solution(name, parameters, solid); }
};

const Solid soil{1500.0, 2e6, 0.3}, without_lateral_strain{1500.0, 2e6, 0.0};

std::vector<Motion> every_motion() {
  const std::vector<Place> ring{{1.3, 0.5}, {0.3, 1.55}, {-0.4, -0.6}, {0.9, -0.5}};
  const Parameters center{{"center_x", 0.3}, {"center_y", 0.5}};
  Parameters vortex = center, expanding = center, rotation = center;
  vortex.insert({{"amplitude", 0.7}, {"period", 1.3}, {"inner_radius", 0.7}, {"outer_radius", 1.5}});
  expanding.insert({{"amplitude", 0.2}, {"inner_radius", 0.7}, {"outer_radius", 1.5}});
  rotation.insert({{"angular_velocity", -3.0}});
  return {{"standing_wave", {{"amplitude", 0.2}, {"length", 1.7}}, soil, {{0.2, 0}, {0.9, 0}, {1.5, 0}}},
          {"axis_aligned", {{"amplitude", 0.3}, {"length", 1.7}}, soil, {{0.2, 0.7}, {0.9, 1.3}, {1.5, 0.1}}},
          {"generalised_vortex", vortex, soil, ring},
          {"expanding_ring", expanding, without_lateral_strain, ring},
          {"rotation", rotation, soil, ring},
          {"vibrating_bar", {{"amplitude", 1e-6}, {"length", 1.7}}, soil, {{0.2, 0}, {0.9, 0}, {1.5, 0}}}};
}

/// Within the period and a little before its begin.
std::vector<double> moments(const ManufacturedSolution& solution) {
  return {-1e-3 * solution.period(), 0.0, 0.13 * solution.period(), 0.61 * solution.period()};
}

/// Slope of a function at x by a central difference whose error is of the sixth order in its step.
template <class Function>
double slope(const Function& function, double x, double step) {
  const auto pair = [&](int i) { return function(x + i * step) - function(x - i * step); };
  return (45 * pair(1) - 9 * pair(2) + pair(3)) / (60 * step);
}

constexpr double step = 2e-3;  // [m]; sixth power below round-off, round-off over its square about 1e-11

/// F by differences of the displacement.
Tensor differenced_gradient(const ManufacturedSolution& solution, const Place& place, double time) {
  Tensor gradient{1, 0, 0, 1};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      const auto along = [&](double x) {
        Place moved = place;
        moved[j] = x;
        return solution.displacement(moved, time)[i];
      };
      gradient[2 * i + j] += slope(along, place[j], step);
    }
  return gradient;
}

double lame(const Solid& solid, int dimension) {
  const double nu = solid.poissons_ratio;
  return dimension == 1 ? 0.0 : solid.youngs_modulus * nu / ((1 + nu) * (1 - 2 * nu));
}

double shear_modulus(const Solid& solid, int dimension) {
  return solid.youngs_modulus / (dimension == 1 ? 2 : 2 * (1 + solid.poissons_ratio));
}

/// P = lambda ln J F^-T + mu (F - F^-T).
Tensor nominal_stress(double lambda, double mu, const Tensor& f) {
  const double j = f[0] * f[3] - f[1] * f[2];
  const Tensor inverse_transpose{f[3] / j, -f[2] / j, -f[1] / j, f[0] / j};
  Tensor stress;
  for (std::size_t i = 0; i < 4; ++i)
    stress[i] = lambda * std::log(j) * inverse_transpose[i] + mu * (f[i] - inverse_transpose[i]);
  return stress;
}

TEST(VerificationOfManufacturedSolution, VelocityIsTheRateOfDisplacement) {
  for (const Motion& motion : every_motion()) {
    const auto solution = motion.solution();
    for (double time : moments(*solution))
      for (const Place& place : motion.places)
        for (std::size_t i = 0; i < 2; ++i) {
          const auto history = [&](double t) { return solution->displacement(place, t)[i]; };
          const double scale = 1e-9 * std::abs(motion.parameters.begin()->second) / solution->period();
          EXPECT_NEAR(solution->velocity(place, time)[i], slope(history, time, 1e-3 * solution->period()),
                      std::max(scale, 1e-16))
              << motion.name << " at " << time;
        }
  }
}

TEST(VerificationOfManufacturedSolution, DeformationGradientIsTheSlopeOfTheMotion) {
  for (const Motion& motion : every_motion()) {
    const auto solution = motion.solution();
    for (double time : moments(*solution))
      for (const Place& place : motion.places) {
        const Tensor f = solution->deformation_gradient(place, time),
                     differenced = differenced_gradient(*solution, place, time);
        for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(f[i], differenced[i], 1e-11) << motion.name;
      }
  }
}

TEST(VerificationOfManufacturedSolution, StressIsThatOfTheLaw) {
  for (const Motion& motion : every_motion()) {
    if (motion.name == "vibrating_bar") continue;  // its law is linear
    const auto solution = motion.solution();
    const double lambda = lame(motion.solid, solution->dimension()),
                 mu = shear_modulus(motion.solid, solution->dimension());
    for (double time : moments(*solution))
      for (const Place& place : motion.places) {
        const Tensor f = solution->deformation_gradient(place, time);
        const double j = f[0] * f[3] - f[1] * f[2];
        const CauchyStress stress = solution->stress(place, time);
        const double volumetric = lambda * std::log(j) / j, tolerance = 1e-14 * motion.solid.youngs_modulus;
        EXPECT_NEAR(stress.xx, volumetric + mu * (f[0] * f[0] + f[1] * f[1] - 1) / j, tolerance);
        EXPECT_NEAR(stress.yy, volumetric + mu * (f[2] * f[2] + f[3] * f[3] - 1) / j, tolerance);
        EXPECT_NEAR(stress.zz, volumetric, tolerance);
        EXPECT_NEAR(stress.xy, mu * (f[0] * f[2] + f[1] * f[3]) / j, tolerance);
        if (solution->dimension() == 1) {
          EXPECT_NEAR(stress.xx, motion.solid.youngs_modulus / 2 * (f[0] - 1 / f[0]), tolerance);
        }
      }
  }
}

TEST(VerificationOfManufacturedSolution, DivergenceOfStressIsItsDifferenceInAnyStateOfStrain) {
  const double lambda = 1.7, mu = 0.6;
  const std::vector<Tensor> gradients{{0, 0, 0, 0}, {0.3, -0.2, 0.5, 0.1}, {-0.4, 0.3, 0.2, 0.8}};
  const std::array<std::array<double, 3>, 2> second{{{0.3, -0.7, 1.1}, {-0.2, 0.9, 0.4}}};
  for (const Tensor& gradient : gradients) {
    const Place divergence = stress_divergence(lambda, mu, gradient, second);
    for (std::size_t i = 0; i < 2; ++i) {
      double differenced = 0;
      for (std::size_t j = 0; j < 2; ++j) {
        const auto along = [&](double x) {
          Tensor f{1, 0, 0, 1};
          for (std::size_t row = 0; row < 2; ++row)
            for (std::size_t column = 0; column < 2; ++column)
              f[2 * row + column] += gradient[2 * row + column] + second[row][column + j] * x;
          return nominal_stress(lambda, mu, f)[2 * i + j];
        };
        differenced += slope(along, 0.0, step);
      }
      EXPECT_NEAR(divergence[i], differenced, 1e-10);
    }
  }
}

TEST(VerificationOfManufacturedSolution, BodyForceBalancesMomentum) {
  for (const Motion& motion : every_motion()) {
    if (motion.name == "vibrating_bar") continue;  // balances to the first order only
    const auto solution = motion.solution();
    const auto dimension = static_cast<std::size_t>(solution->dimension());
    const double lambda = lame(motion.solid, solution->dimension()),
                 mu = shear_modulus(motion.solid, solution->dimension());
    double largest = 0, difference = 0;
    for (double time : moments(*solution))
      for (const Place& place : motion.places)
        for (std::size_t i = 0; i < dimension; ++i) {
          const auto rate = [&](double t) { return solution->velocity(place, t)[i]; };
          double force = slope(rate, time, 1e-3 * solution->period());
          for (std::size_t j = 0; j < dimension; ++j) {
            const auto along = [&](double x) {
              Place moved = place;
              moved[j] = x;
              return nominal_stress(lambda, mu, differenced_gradient(*solution, moved, time))[2 * i + j];
            };
            force -= slope(along, place[j], step) / motion.solid.density;
          }
          const double found = solution->body_force(place, time)[i];
          largest = std::max(largest, std::abs(found));
          difference = std::max(difference, std::abs(found - force));
        }
    EXPECT_GT(largest, 1.0) << motion.name;
    // Round-off of second differences in a stress of some 1e6 Pa, 1e-11 E/rho per metre.
    EXPECT_LT(difference, 1e-7 * largest + 1e-7) << motion.name;
  }
}

TEST(VerificationOfManufacturedSolution, AllStartWithoutDisplacementAndReturnToIt) {
  for (const Motion& motion : every_motion()) {
    const auto solution = motion.solution();
    for (const Place& place : motion.places)
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(solution->displacement(place, 0.0)[i], 0.0) << motion.name;
        const double quarter = solution->displacement(place, 0.21 * solution->period())[i];
        EXPECT_NEAR(solution->displacement(place, 1.21 * solution->period())[i], quarter, 1e-14)
            << motion.name;
      }
  }
}

TEST(VerificationOfManufacturedSolution, BodyForceOfTheStandingWaveIsTheClosedForm) {
  // rho b = rho a - mu (1 + 1/F^2) u'' with u'' = -k^2 u and a = -(E/rho) k^2 u, k = pi/L.
  const double length = 1.7, k = pi / length;
  const auto wave = manufactured_solution("standing_wave", {{"amplitude", 0.2}, {"length", length}}, soil);
  for (double x : {0.0, 0.1, 0.6, 1.1, 1.7})
    for (double time : moments(*wave)) {
      const double u = wave->displacement({x, 0}, time)[0];
      const double f = wave->deformation_gradient({x, 0}, time)[0];
      const double e = soil.youngs_modulus;
      const double closed = k * k * u / soil.density * (e / 2 * (1 + 1 / (f * f)) - e);
      EXPECT_NEAR(wave->body_force({x, 0}, time)[0], closed, 1e-11);
    }
  EXPECT_NEAR(wave->displacement({length / 2, 0}, wave->period() / 4)[0], 0.2, 1e-15);
}

TEST(VerificationOfManufacturedSolution, AxisAlignedEdgesSlideAlongThemselves) {
  const auto motion = manufactured_solution("axis_aligned", {{"amplitude", 0.3}, {"length", 1.7}}, soil);
  const double time = motion->period() / 4;
  const Place wave = motion->displacement({0.85, 0.85}, time);
  EXPECT_NEAR(wave[0], 0.3, 1e-15);
  EXPECT_NEAR(wave[1], -0.3, 1e-15);
  for (double edge : {0.0, 1.7}) {
    EXPECT_NEAR(motion->displacement({edge, 0.4}, time)[0], 0.0, 1e-15);
    EXPECT_NEAR(motion->displacement({0.4, edge}, time)[1], 0.0, 1e-15);
    EXPECT_EQ(motion->stress({edge, 0.4}, time).xy, 0.0);
  }
}

TEST(VerificationOfManufacturedSolution, TheVortexTurnsCirclesAndKeepsTheVolume) {
  const auto vortex = manufactured_solution("generalised_vortex", {{"amplitude", 1.0}}, soil);
  const double time = 0.5;  // the sine's peak
  for (double radius : {0.76, 0.8, 1.0, 1.1, 1.24})
    for (double direction : {0.0, 1.0, 4.0}) {
      const Place place{radius * std::cos(direction), radius * std::sin(direction)};
      const Place moved = vortex->displacement(place, time);
      const double s = 4 * (radius - 1), angle = std::pow(1 - s * s, 4);
      EXPECT_NEAR(place[0] + moved[0], radius * std::cos(direction + angle), 1e-14);
      EXPECT_NEAR(place[1] + moved[1], radius * std::sin(direction + angle), 1e-14);
      const Tensor f = vortex->deformation_gradient(place, time);
      EXPECT_NEAR(f[0] * f[3] - f[1] * f[2], 1.0, 1e-12);
    }
  // A shear of R h' = 1.7 or so: there is something to keep the volume in spite of.
  EXPECT_GT(std::abs(vortex->stress({0.86, 0.0}, time).xy), soil.youngs_modulus / 4);
}

TEST(VerificationOfManufacturedSolution, TheVortexLeavesItsFacesFreeAndTheOutsideAlone) {
  const auto vortex = manufactured_solution("generalised_vortex", {{"amplitude", 1.0}}, soil);
  const double time = 0.4;
  for (double radius : {0.0, 0.3, 0.7499, 1.2501, 7.0}) {
    EXPECT_EQ(vortex->displacement({radius, 0}, time), (Place{0, 0}));
    EXPECT_EQ(vortex->velocity({radius, 0}, time), (Place{0, 0}));
    EXPECT_EQ(vortex->body_force({0, radius}, time), (Place{0, 0}));
    EXPECT_EQ(vortex->deformation_gradient({radius, 0}, time), (Tensor{1, 0, 0, 1}));
  }
  for (double radius : {0.75, 1.25}) {
    const CauchyStress stress = vortex->stress({0, radius}, time);
    for (double component : {stress.xx, stress.yy, stress.zz, stress.xy})
      EXPECT_NEAR(component, 0.0, 1e-12 * soil.youngs_modulus);
  }
  // No jump at the faces: the force next to them is small beside what drives the middle.
  EXPECT_LT(std::abs(vortex->body_force({1.249, 0.0}, time)[1]),
            1e-2 * std::abs(vortex->body_force({1.1, 0.0}, time)[1]));
  // At the start there is but the centripetal force of its first speed, alpha' = pi.
  EXPECT_NEAR(vortex->body_force({1.0, 0.0}, 0.0)[0], -pi * pi, 1e-13);
  EXPECT_NEAR(vortex->body_force({1.0, 0.0}, 0.0)[1], 0.0, 1e-13);
}

TEST(VerificationOfManufacturedSolution, TheExpandingRingHasFacesFreeOfTraction) {
  for (double outer : {1.5, 3.0}) {  // beyond three times the inner radius f changes its sign
    const Parameters parameters{
        {"amplitude", 0.2}, {"inner_radius", 0.7}, {"outer_radius", outer}, {"center_x", 0.3}};
    const auto ring = manufactured_solution("expanding_ring", parameters, without_lateral_strain);
    const double time = 0.2 * ring->period();
    double largest = 0;
    for (int i = 0; i <= 100; ++i)
      for (double direction : {0.0, 0.8, 4.0}) {
        const double radius = 0.7 + (outer - 0.7) * i / 100;
        const Place normal{std::cos(direction), std::sin(direction)};
        const Place place{0.3 + radius * normal[0], radius * normal[1]};
        const CauchyStress stress = ring->stress(place, time);
        const double radial = stress.xx * normal[0] + stress.xy * normal[1],
                     other = stress.xy * normal[0] + stress.yy * normal[1];
        if (i == 0 || i == 100) {
          EXPECT_NEAR(radial, 0.0, 1e-14 * soil.youngs_modulus);
          EXPECT_NEAR(other, 0.0, 1e-14 * soil.youngs_modulus);
        } else if (i == 50) {
          EXPECT_GT(std::hypot(radial, other), 1e-2 * soil.youngs_modulus);
        }
        const Place moved = ring->displacement(place, ring->period() / 4);
        EXPECT_NEAR(moved[0] * normal[1], moved[1] * normal[0], 1e-15);  // radial
        largest = std::max(largest, std::hypot(moved[0], moved[1]));
      }
    EXPECT_NEAR(largest, 0.2, 1e-14);
  }
}

TEST(VerificationOfManufacturedSolution, RotationIsRigidWithoutStressAndHeldByTheCentripetalForce) {
  const Place center{0.3, 0.5};
  const double rate = -3.0;
  const auto rotation = manufactured_solution(
      "rotation", {{"angular_velocity", rate}, {"center_x", center[0]}, {"center_y", center[1]}}, soil);
  const Place place{1.3, 0.9};
  for (double time : moments(*rotation)) {
    const double c = std::cos(rate * time), s = std::sin(rate * time);
    const Place arm{c * 1.0 - s * 0.4, s * 1.0 + c * 0.4};
    const Place moved = rotation->displacement(place, time), force = rotation->body_force(place, time);
    const CauchyStress stress = rotation->stress(place, time);
    for (double component : {stress.xx, stress.yy, stress.zz, stress.xy})
      EXPECT_NEAR(component, 0.0, 1e-15 * soil.youngs_modulus);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(place[i] + moved[i], center[i] + arm[i], 1e-15);
      EXPECT_NEAR(force[i], -rate * rate * arm[i], 1e-14);
    }
  }
}

TEST(VerificationOfManufacturedSolution, TheVibratingBarBalancesMomentumToTheFirstOrder) {
  const double length = 1.7, rho = soil.density, e = soil.youngs_modulus;
  double residuals[3];
  for (int i = 0; i < 3; ++i) {
    const double amplitude = 1e-3 / (1 << i), strain = pi * amplitude / (2 * length);
    const auto bar =
        manufactured_solution("vibrating_bar", {{"amplitude", amplitude}, {"length", length}}, soil);
    // The same motion of the neo-Hookean bar needs a force: what the linear one leaves out.
    const auto wave =
        manufactured_solution("standing_wave", {{"amplitude", amplitude}, {"length", 2 * length}}, soil);
    const double omega = 2 * pi / bar->period(), acceleration = amplitude * omega * omega;
    EXPECT_NEAR(bar->period(), 4 * length * std::sqrt(rho / e), 1e-14);
    residuals[i] = 0;
    for (double x : {0.0, 0.3, 0.85, 1.7})
      for (double time : moments(*bar)) {
        const Place place{x, 0};
        const auto stress = [&](double at) { return bar->stress({at, 0}, time).xx; };
        const auto rate = [&](double t) { return bar->velocity(place, t)[0]; };
        const double balance = rho * slope(rate, time, 1e-3 * bar->period()) - slope(stress, x, step);
        EXPECT_NEAR(balance, 0.0, 1e-8 * rho * acceleration);  // the linear law's own is exact
        EXPECT_EQ(bar->body_force(place, time), (Place{0, 0}));
        EXPECT_NEAR(bar->displacement(place, time)[0], wave->displacement(place, time)[0], 1e-18);
        EXPECT_NEAR(bar->stress(place, time).xx, wave->stress(place, time).xx, 0.51 * e * strain * strain);
        residuals[i] = std::max(residuals[i], std::abs(wave->body_force(place, time)[0]) / acceleration);
      }
    EXPECT_EQ(bar->displacement({0, 0}, 0.3)[0], 0.0);
    EXPECT_NEAR(bar->stress({length, 0}, 0.3 * bar->period()).xx, 0.0, 1e-15 * e);
    EXPECT_LT(residuals[i], strain);
  }
  EXPECT_NEAR(residuals[0] / residuals[1], 2.0, 2e-3);
  EXPECT_NEAR(residuals[1] / residuals[2], 2.0, 1e-3);
}

/// The message of the refusal; empty if there was none.
std::string refusal(const std::string& name, const Parameters& parameters, const Solid& solid = soil) {
  try {
    manufactured_solution(name, parameters, solid);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ManufacturedSolution, RefusesAmplitudesThatInvertTheMaterial) {
  const double limit = 1.7 / pi;
  for (const char* name : {"standing_wave", "axis_aligned"}) {
    EXPECT_EQ(refusal(name, {{"amplitude", 0.999 * limit}, {"length", 1.7}}), "");
    EXPECT_TRUE(refusal(name, {{"amplitude", 1.001 * limit}, {"length", 1.7}}).starts_with("amplitude:"));
    EXPECT_TRUE(refusal(name, {{"amplitude", -1.001 * limit}, {"length", 1.7}}).starts_with("amplitude:"));
  }
  EXPECT_EQ(refusal("vibrating_bar", {{"amplitude", 1.9 * limit}, {"length", 1.7}}), "");
  EXPECT_TRUE(
      refusal("vibrating_bar", {{"amplitude", 2.1 * limit}, {"length", 1.7}}).starts_with("amplitude:"));
  EXPECT_TRUE(
      refusal("expanding_ring", {{"amplitude", 0.76}}, without_lateral_strain).starts_with("amplitude:"));
}

TEST(ManufacturedSolution, ARingOfTheLargestAmplitudeNowhereInverts) {
  for (double outer : {0.8, 1.25, 2.2, 2.8, 5.0, 20.0}) {
    double limit = 10;
    for (double least = 0; limit - least > 1e-9;) {
      const double middle = (least + limit) / 2;
      const bool refused =
          !refusal("expanding_ring", {{"amplitude", middle}, {"outer_radius", outer}}, without_lateral_strain)
               .empty();
      (refused ? limit : least) = middle;
    }
    for (double sign : {-1.0, 1.0}) {
      const Parameters largest{{"amplitude", sign * (limit - 1e-8)}, {"outer_radius", outer}};
      const auto ring = manufactured_solution("expanding_ring", largest, without_lateral_strain);
      for (int i = 0; i <= 200; ++i) {
        const Place place{0.75 + (outer - 0.75) * i / 200, 0.0};
        const Tensor f = ring->deformation_gradient(place, ring->period() / 4);
        EXPECT_GT(f[0], 0.0);
        EXPECT_GT(f[3], 0.0);
      }
    }
  }
}

TEST(ManufacturedSolution, RefusesWhatItDoesNotKnowOrCannotBe) {
  EXPECT_NE(refusal("standing_waves", {{"amplitude", 0.1}}), "");
  EXPECT_TRUE(refusal("standing_wave", {}).starts_with("amplitude:"));
  EXPECT_TRUE(refusal("standing_wave", {{"amplitude", NAN}}).starts_with("amplitude:"));
  EXPECT_TRUE(refusal("standing_wave", {{"amplitude", 0.1}, {"period", 1.0}}).starts_with("period:"));
  EXPECT_TRUE(refusal("standing_wave", {{"amplitude", 0.1}, {"length", 0.0}}).starts_with("length:"));
  EXPECT_TRUE(refusal("generalised_vortex", {{"amplitude", 1.0}, {"period", 0.0}}).starts_with("period:"));
  EXPECT_TRUE(refusal("generalised_vortex", {{"amplitude", 1.0}, {"outer_radius", 0.7}})
                  .starts_with("outer_radius:"));
  EXPECT_TRUE(refusal("expanding_ring", {{"amplitude", 0.1}}).starts_with("poissons_ratio:"));
  EXPECT_TRUE(refusal("expanding_ring", {{"amplitude", 0.1}, {"inner_radius", 0.0}}, without_lateral_strain)
                  .starts_with("inner_radius:"));
  EXPECT_TRUE(refusal("rotation", {{"angular_velocity", 0.0}}).starts_with("angular_velocity:"));
  EXPECT_TRUE(refusal("rotation", {{"angular_velocity", 1.0}}, {0, 1, 0}).starts_with("density:"));
  EXPECT_TRUE(refusal("rotation", {{"angular_velocity", 1.0}}, {1, -1, 0}).starts_with("youngs_modulus:"));
  EXPECT_TRUE(refusal("rotation", {{"angular_velocity", 1.0}}, {1, 1, 0.5}).starts_with("poissons_ratio:"));
}

}  // namespace
