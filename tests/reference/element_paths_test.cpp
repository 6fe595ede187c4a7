#include "reference/element_paths.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "reference/multi_surface_return.hpp"

namespace {

using namespace mpm::reference;
using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180;
constexpr double pressure = 2e4;  // [Pa]

std::vector<MohrCoulombSoil> soils() {
  std::vector<MohrCoulombSoil> all;
  for (double friction : {0.0, 5.0, 15.0, 30.0, 45.0})
    for (double dilation : {0.0, 0.5, 1.0})
      for (double cohesion : {0.0, 1e3})
        for (double nu : {0.0, 0.3, 0.49})
          if (friction + cohesion > 0 && (friction > 0 || dilation == 0))
            all.push_back({1e7, nu, friction * degree, cohesion, dilation * friction * degree});
  return all;
}

std::string name_of(const MohrCoulombSoil& soil) {
  return "phi " + std::to_string(soil.friction_angle / degree) + " psi " +
         std::to_string(soil.dilation_angle / degree) + " c " + std::to_string(soil.cohesion) + " nu " +
         std::to_string(soil.poissons_ratio);
}

/// Elastic stress of normal strains [Pa].
Vector3d stress_of(const MohrCoulombSoil& soil, const Vector3d& strain) {
  const double e = soil.youngs_modulus, nu = soil.poissons_ratio;
  return e / (1 + nu) * (strain + Vector3d::Constant(nu / (1 - 2 * nu) * strain.sum()));
}

Vector3d strain_of(const MohrCoulombSoil& soil, const Vector3d& stress) {
  const double e = soil.youngs_modulus, nu = soil.poissons_ratio;
  return ((1 + nu) * stress - Vector3d::Constant(nu * stress.sum())) / e;
}

Vector3d returned(const MohrCoulombSoil& soil, const Vector3d& trial) {
  const auto found = multi_surface_return(soil, {trial[0], trial[1], trial[2]});
  EXPECT_TRUE(found) << name_of(soil) << " trial " << trial.transpose();
  return found ? Vector3d(found->principal.data()) : Vector3d::Constant(std::nan(""));
}

/// Along x, y and z; in simple shear along the plane's diagonals, since xx and yy are equal there.
Vector3d principal_of(const ElementState& state) {
  if (state.xx == state.yy) return {state.xx + state.xy, state.yy - state.xy, state.zz};
  return {state.xx, state.yy, state.zz};
}

/// Principal strains from one imposed strain to another: the change of volume that the path leaves open goes
/// to xx in biaxial tests, to both axes of the plane in simple shear.
Vector3d strain_between(LoadingPath path, double from, double to, double volumetric) {
  const double step = to - from;
  switch (path) {
    case LoadingPath::biaxial:
      return {volumetric - step, step, 0};
    case LoadingPath::oedometric:
      return {0, step, 0};
    case LoadingPath::simple_shear:
      return {volumetric / 2 + step, volumetric / 2 - step, 0};
    case LoadingPath::isotropic:
      break;
  }
  return Vector3d::Constant(step);
}

struct Course {
  LoadingPath path;
  double strain;  ///< at its end, far beyond the limit
};

std::vector<Course> all_courses() {
  return {{LoadingPath::biaxial, -0.05},     {LoadingPath::biaxial, 0.05},
          {LoadingPath::oedometric, -0.05},  {LoadingPath::oedometric, 0.05},
          {LoadingPath::simple_shear, 0.05}, {LoadingPath::simple_shear, -0.05},
          {LoadingPath::isotropic, 0.05}};
}

// The closed forms and the return by several surfaces know nothing of each other: the closed form's stress
// must be what the return makes of its strain, from any point of the path to any later one.
TEST(VerificationOfElementPaths, AreWhatTheReturnMakesOfTheirStrains) {
  for (const MohrCoulombSoil& soil : soils()) {
    SCOPED_TRACE(name_of(soil));
    for (const Course& course : all_courses()) {
      SCOPED_TRACE(static_cast<int>(course.path));
      const ElementTestSolution exact(soil, course.path, pressure, course.strain);
      for (const auto& [from, to] :
           {std::pair{0.0, 0.01}, {0.0, 1.0}, {0.03, 0.06}, {0.02, 1.0}, {0.5, 0.7}}) {
        const ElementState before = exact.at(from * course.strain), after = exact.at(to * course.strain);
        const Vector3d strain = strain_between(course.path, from * course.strain, to * course.strain,
                                               after.volumetric_strain - before.volumetric_strain);
        const Vector3d trial = principal_of(before) + stress_of(soil, strain);
        const double error = (returned(soil, trial) - principal_of(after)).cwiseAbs().maxCoeff();
        ASSERT_LE(error, 1e-11 * (trial.cwiseAbs().maxCoeff() + soil.cohesion))
            << from << " to " << to << " limit " << exact.limit_strain();
      }
    }
  }
}

TEST(VerificationOfElementPaths, KeepWhatTheyHold) {
  for (const MohrCoulombSoil& soil : soils()) {
    SCOPED_TRACE(name_of(soil));
    for (const Course& course : all_courses()) {
      const ElementTestSolution exact(soil, course.path, pressure, course.strain);
      for (double share : {0.0, 0.001, 0.01, 0.1, 1.0}) {
        const ElementState state = exact.at(share * course.strain);
        const double round_off = 1e-14 * (1 + soil.poissons_ratio / (1 - 2 * soil.poissons_ratio)) *
                                 (pressure + std::abs(state.yy) + std::abs(state.zz));
        if (course.path == LoadingPath::biaxial) {
          EXPECT_EQ(state.xx, -pressure);
        }
        if (course.path == LoadingPath::simple_shear) {
          EXPECT_EQ(state.xx, -pressure);
          EXPECT_EQ(state.yy, -pressure);
        }
        if (course.path == LoadingPath::oedometric) {
          EXPECT_NEAR(state.xx, state.zz, round_off);
        }
      }
    }
  }
}

TEST(VerificationOfElementPaths, EndAtTheLimit) {
  int reach_it = 0, do_not = 0;
  for (const MohrCoulombSoil& soil : soils()) {
    SCOPED_TRACE(name_of(soil));
    for (const Course& course : all_courses()) {
      const ElementTestSolution exact(soil, course.path, pressure, course.strain);
      const auto excess_at = [&](double strain) {
        const ElementState state = exact.at(strain);
        const double relative = relative_excess(soil, state.xx, state.yy, state.zz, state.xy);
        // Of the pressure where the stress is nothing but round-off, at the apex of sand.
        return relative * std::min(1.0, principal_of(state).cwiseAbs().maxCoeff() / pressure);
      };
      EXPECT_LT(excess_at(0.99 * std::clamp(exact.limit_strain(), -1e-4, 1e-4)), 0);
      if (std::abs(exact.limit_strain()) > std::abs(course.strain)) {
        ++do_not;
        continue;
      }
      ++reach_it;
      // The path's straight lines are sums of numbers as large as the elastic stress of the strain, up to 100
      // times the pressure, and 1/(1 - 2 nu) more.
      EXPECT_NEAR(excess_at(course.strain), 0, 1e-13 / (1 - 2 * soil.poissons_ratio));
    }
  }
  EXPECT_GT(reach_it, 400);
  EXPECT_GT(do_not, 10);
}

TEST(VerificationOfElementPaths, HaveTheKnownLimits) {
  const MohrCoulombSoil sand{1e7, 0.3, 30 * degree, 0, 10 * degree};
  const ElementTestSolution compression(sand, LoadingPath::biaxial, pressure, -1);
  EXPECT_NEAR(compression.at(-0.1).yy, -3 * pressure, 1e-9);
  EXPECT_NEAR(compression.at(-0.1).zz, -(1 + 0.3 * 2) * pressure, 1e-9);
  EXPECT_NEAR(compression.dilatancy(), -2 * std::sin(10 * degree) / (1 - std::sin(10 * degree)), 1e-14);
  const ElementTestSolution extension(sand, LoadingPath::biaxial, pressure, 1);
  EXPECT_NEAR(extension.at(0.1).yy, -pressure / 3, 1e-9);
  EXPECT_NEAR(extension.dilatancy(), 2 * std::sin(10 * degree) / (1 + std::sin(10 * degree)), 1e-14);
  const ElementTestSolution shear(sand, LoadingPath::simple_shear, pressure, 1);
  EXPECT_NEAR(shear.at(0.1).xy, pressure / 2, 1e-9);
  EXPECT_NEAR(shear.dilatancy(), 2 * std::sin(10 * degree), 1e-14);
  const MohrCoulombSoil clay{1e7, 0.3, 0, 1e3, 0};
  EXPECT_NEAR(ElementTestSolution(clay, LoadingPath::biaxial, pressure, -1).at(-0.1).yy, -pressure - 2e3,
              1e-9);
  const MohrCoulombSoil cemented{1e7, 0.3, 30 * degree, 1e3, 0};
  EXPECT_NEAR(ElementTestSolution(cemented, LoadingPath::isotropic, pressure, 1).at(0.1).zz,
              1e3 * std::sqrt(3.0), 1e-9);
}

TEST(ElementPaths, RefuseWhatTheyDoNotDescribe) {
  const MohrCoulombSoil sand{1e7, 0.3, 30 * degree, 0, 0};
  const auto solution = [](MohrCoulombSoil soil, double start, double strain) {
    return ElementTestSolution(soil, LoadingPath::biaxial, start, strain);
  };
  EXPECT_NO_THROW(solution(sand, pressure, 1));
  EXPECT_THROW(solution(sand, 0, 1), std::invalid_argument);
  EXPECT_THROW(solution(sand, -1, 1), std::invalid_argument);
  EXPECT_THROW(solution(sand, pressure, 0), std::invalid_argument);
  for (const MohrCoulombSoil& soil :
       {MohrCoulombSoil{0, 0.3, 0.5, 0, 0}, MohrCoulombSoil{1, 0.5, 0.5, 0, 0},
        MohrCoulombSoil{1, 0.3, 0, 0, 0}, MohrCoulombSoil{1, 0.3, 0.5, -1, 0},
        MohrCoulombSoil{1, 0.3, 0.5, 0, 0.6}, MohrCoulombSoil{1, 0.3, 1.6, 0, 0}}) {
    EXPECT_THROW(solution(soil, pressure, 1), std::invalid_argument);
    EXPECT_THROW(multi_surface_return(soil, {0, 0, 0}), std::invalid_argument);
  }
}

TEST(ElementPaths, MeasureTheExcessInPrincipalStresses) {
  const MohrCoulombSoil soil{1e7, 0.3, 30 * degree, 0, 0};
  EXPECT_NEAR(relative_excess(soil, -1, -3, -2, 0), 0, 1e-16);
  EXPECT_NEAR(relative_excess(soil, -2, -2, -2, 1), 0, 1e-16);
  EXPECT_NEAR(relative_excess(soil, -1, -3, -6, 0), 1 / 6.0, 1e-16);
  EXPECT_NEAR(relative_excess(soil, -1, -1, -1, 0), -2 / 3.0, 1e-16);
  EXPECT_EQ(relative_excess(soil, 0, 0, 0, 0), 0);
}

// With psi = phi: no admissible stress is nearer to the trial in elastic energy, wherever one looks.
TEST(VerificationOfMultiSurfaceReturn, IsTheClosestAdmissibleStressWhereFlowIsAssociated) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto random = [&](double size) {
    return Vector3d(size * uniform(generator), size * uniform(generator), size * uniform(generator));
  };
  for (const MohrCoulombSoil& soil : soils()) {
    if (soil.dilation_angle != soil.friction_angle) continue;
    SCOPED_TRACE(name_of(soil));
    const auto energy = [&](const Vector3d& change) { return change.dot(strain_of(soil, change)); };
    for (int i = 0; i < 40; ++i) {
      const Vector3d trial = random(3e4), found = returned(soil, trial);
      const double least = energy(trial - found);
      for (int j = 0; j < 40; ++j) {
        const Vector3d other =
            returned(soil, found + random(3e4 * std::pow(10, -5 * std::abs(uniform(generator)))));
        ASSERT_GE(energy(trial - other), least - 1e-12 * 9e8 / soil.youngs_modulus);
      }
    }
  }
}

// The return's own terms, checked from outside: admissible, and the stress given up is elasticity times a
// plastic strain that does work and keeps the volume's share of psi on a face.
TEST(VerificationOfMultiSurfaceReturn, KeepsTheLimitAndDilatesByPsi) {
  std::mt19937_64 generator(8);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::array<int, 5> parts{};
  for (const MohrCoulombSoil& soil : soils()) {
    SCOPED_TRACE(name_of(soil));
    for (int i = 0; i < 400; ++i) {
      const Vector3d trial = Vector3d::Constant(2e4 * uniform(generator)) +
                             2e4 * Vector3d(uniform(generator), uniform(generator), uniform(generator));
      const auto found = multi_surface_return(soil, {trial[0], trial[1], trial[2]});
      ASSERT_TRUE(found) << trial.transpose();
      const Vector3d stress(found->principal.data()), plastic = strain_of(soil, trial - stress);
      ++parts[static_cast<std::size_t>(found->part)];
      const double size = trial.cwiseAbs().maxCoeff() + soil.cohesion;
      std::array<double, 3> sorted{stress[0], stress[1], stress[2]};
      std::sort(sorted.begin(), sorted.end());
      const double sin_phi = std::sin(soil.friction_angle);
      const double f = sorted[2] - sorted[0] + (sorted[2] + sorted[0]) * sin_phi -
                       2 * soil.cohesion * std::cos(soil.friction_angle);
      ASSERT_LE(f, 1e-10 * size);
      ASSERT_GE(stress.dot(plastic), -1e-10 * size * size / soil.youngs_modulus);
      if (found->part == LimitPart::inside) {
        ASSERT_EQ(stress, trial);
        continue;
      }
      ASSERT_GE(f, -1e-10 * size);
      if (found->part == LimitPart::apex) continue;
      // On faces and edges alike the volume grows by sin psi times the sum of the magnitudes of flow.
      ASSERT_NEAR(plastic.sum(), std::sin(soil.dilation_angle) * plastic.cwiseAbs().sum(),
                  1e-10 * size / soil.youngs_modulus / (1 - 2 * soil.poissons_ratio));
    }
  }
  for (int count : parts) EXPECT_GT(count, 300);
}

}  // namespace
