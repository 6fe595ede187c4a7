#include "solver/mohr_coulomb.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace mpm;
using Stress = SymmetricTensor<2, double>;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180;
constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double modulus = 1e7, typical_stress = 1e4;  // [Pa]

// ---------------------------------------------------------------------------------------------------------------
// A plain description of the law, in unordered principal stresses, that shares nothing with the code under
// test.

/// Normal of a face and direction of its potential: the i-th principal stress is the largest, the j-th the
/// smallest.
struct Plane {
  Vector3d normal, gradient;
};

std::vector<Plane> planes_of(const MohrCoulomb& material) {
  const double sin_phi = std::sin(material.friction_angle), sin_psi = std::sin(material.dilation_angle);
  std::vector<Plane> planes;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      const Vector3d largest = Vector3d::Unit(i), smallest = Vector3d::Unit(j);
      planes.push_back({(1 + sin_phi) * largest - (1 - sin_phi) * smallest,
                        (1 + sin_psi) * largest - (1 - sin_psi) * smallest});
    }
  }
  return planes;
}

double limit_of(const MohrCoulomb& material) {
  return 2 * material.cohesion * std::cos(material.friction_angle);
}

double apex_of(const MohrCoulomb& material) { return material.cohesion / std::tan(material.friction_angle); }

/// The largest f over all faces.
double excess_of(const MohrCoulomb& material, const Vector3d& principal) {
  double largest = -std::numeric_limits<double>::infinity();
  for (const Plane& plane : planes_of(material))
    largest = std::max(largest, plane.normal.dot(principal) - limit_of(material));
  return largest;
}

/// Elasticity between principal strains and principal stresses [Pa].
Matrix3d elasticity_of(const MohrCoulomb& material) {
  const double e = material.youngs_modulus, nu = material.poissons_ratio;
  return e / (1 + nu) * (Matrix3d::Identity() + nu / (1 - 2 * nu) * Matrix3d::Ones());
}

Matrix3d compliance_of(const MohrCoulomb& material) {
  const double e = material.youngs_modulus, nu = material.poissons_ratio;
  return ((1 + nu) * Matrix3d::Identity() - nu * Matrix3d::Ones()) / e;
}

/// Nothing where the matrix' rows depend on each other.
std::optional<Vector3d> solution_of(const Matrix3d& matrix, const Vector3d& right_side) {
  Eigen::FullPivLU<Matrix3d> factors(matrix);
  // Far from round-off, and from the least pivot that a friction of 5 degrees makes.
  factors.setThreshold(1e-9);
  return factors.isInvertible() ? std::optional<Vector3d>(factors.solve(right_side)) : std::nullopt;
}

/// Every choice of one to three of the six planes.
std::vector<std::vector<std::size_t>> active_sets() {
  std::vector<std::vector<std::size_t>> sets;
  for (unsigned mask = 1; mask < 64; ++mask) {
    std::vector<std::size_t> set;
    for (std::size_t i = 0; i < 6; ++i)
      if (mask >> i & 1u) set.push_back(i);
    if (set.size() <= 3) sets.push_back(set);
  }
  return sets;
}

/// The admissible stress s with D^-1 (trial - s) a non-negative sum of the gradients of the planes on which s
/// lies, by trying every set of planes; nothing where there is none. With psi = phi it is the projection in
/// the energy norm.
std::optional<Vector3d> returned_by_enumeration(const MohrCoulomb& material, const Vector3d& trial) {
  static const auto sets = active_sets();
  if (excess_of(material, trial) <= 0) return trial;
  const auto planes = planes_of(material);
  const Matrix3d elasticity = elasticity_of(material);
  const double close = 1e-11 * (trial.cwiseAbs().maxCoeff() + limit_of(material));
  for (const auto& set : sets) {
    // A row left over says that its multiplier is zero.
    Matrix3d normals = Matrix3d::Zero(), gradients = Matrix3d::Zero(), idle = Matrix3d::Identity();
    Vector3d excess = Vector3d::Zero();
    for (std::size_t i = 0; i < set.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      normals.row(row) = planes[set[i]].normal;
      gradients.col(row) = planes[set[i]].gradient;
      excess[row] = planes[set[i]].normal.dot(trial) - limit_of(material);
      idle(row, row) = 0.0;
    }
    const Matrix3d flow = elasticity * gradients / material.youngs_modulus;
    const auto multipliers = solution_of(normals * flow + idle, excess);
    if (!multipliers) continue;
    const Vector3d candidate = trial - flow * *multipliers;
    if (multipliers->minCoeff() >= -close && excess_of(material, candidate) <= close) return candidate;
  }
  return std::nullopt;
}

/// Least distance of `strain` from the non-negative sums of `generators`, by trying every three of them.
double distance_from_cone(const Vector3d& strain, const std::vector<Vector3d>& generators) {
  double least = strain.norm();
  const auto count = static_cast<unsigned>(generators.size());
  for (unsigned mask = 1; mask < 1u << count; ++mask) {
    if (std::popcount(mask) > 3) continue;
    Matrix3d basis = Matrix3d::Zero(), idle = Matrix3d::Identity();
    Eigen::Index columns = 0;
    for (unsigned i = 0; i < count; ++i) {
      if (!(mask >> i & 1u)) continue;
      idle(columns, columns) = 0.0;
      basis.col(columns++) = generators[i];
    }
    const auto multipliers = solution_of(basis.transpose() * basis + idle, basis.transpose() * strain);
    if (!multipliers) continue;
    least = std::min(least, (basis * multipliers->cwiseMax(0.0) - strain).norm());
  }
  return least;
}

// ---------------------------------------------------------------------------------------------------------------
// Tensors and their principal values.

/// Stress with the principal values (first, second) in the plane, the first at an angle to x, and (third)
/// across it.
Stress rotated(const Vector3d& principal, double angle) {
  const double center = (principal[0] + principal[1]) / 2, radius = (principal[0] - principal[1]) / 2;
  return {center + radius * std::cos(2 * angle), center - radius * std::cos(2 * angle), principal[2],
          radius * std::sin(2 * angle)};
}

Stress turned(const Stress& s, double angle) {
  const double cos = std::cos(angle), sin = std::sin(angle);
  return {cos * cos * s[0] + sin * sin * s[1] - 2 * sin * cos * s[3],
          sin * sin * s[0] + cos * cos * s[1] + 2 * sin * cos * s[3], s[2],
          sin * cos * (s[0] - s[1]) + (cos * cos - sin * sin) * s[3]};
}

/// Principal values along given directions: the first two in the plane, the third across it.
struct Directions {
  Matrix3d axes;

  explicit Directions(const Stress& stress) {
    const double angle = std::atan2(2 * stress[3], stress[0] - stress[1]) / 2;
    axes << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  }

  Matrix3d seen(const Stress& s) const {
    Matrix3d full;
    full << s[0], s[3], 0, s[3], s[1], 0, 0, 0, s[2];
    return axes.transpose() * full * axes;
  }
};

double size_of(const Stress& stress) {
  double size = 0.0;
  for (double component : stress) size = std::max(size, std::abs(component));
  return size;
}

double difference(const Stress& a, const Stress& b) {
  return size_of({a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]});
}

/// Strain increment that adds `change` to the stress elastically.
Stress strain_for(const MohrCoulomb& material, const Stress& change) {
  const double e = material.youngs_modulus, nu = material.poissons_ratio;
  const double mean = nu * (change[0] + change[1] + change[2]);
  return {((1 + nu) * change[0] - mean) / e, ((1 + nu) * change[1] - mean) / e,
          ((1 + nu) * change[2] - mean) / e, (1 + nu) * change[3] / e};
}

/// f / (1 + sin phi) = s1 - k s3 - t of a stress, relative to max |s| + t, in more digits than the law has.
template <class Real>
double relative_excess(const MohrCoulomb& material, const SymmetricTensor<2, Real>& s) {
  using Wide = long double;
  const Wide sin_phi = std::sin(Wide(material.friction_angle)),
             cos_phi = std::cos(Wide(material.friction_angle));
  const Wide root = cos_phi / (1 + sin_phi), strength = 2 * Wide(material.cohesion) * root;
  const Wide center = (Wide(s[0]) + Wide(s[1])) / 2,
             radius = std::hypot((Wide(s[0]) - Wide(s[1])) / 2, Wide(s[3]));
  const Wide largest = std::max(center + radius, Wide(s[2])),
             smallest = std::min(center - radius, Wide(s[2]));
  const Wide scale = std::max(std::abs(largest), std::abs(smallest)) + strength;
  return scale > 0 ? static_cast<double>((largest - root * root * smallest - strength) / scale) : 0.0;
}

// ---------------------------------------------------------------------------------------------------------------
// Materials and states that the properties below are asked of.

std::vector<MohrCoulomb> materials() {
  std::vector<MohrCoulomb> all;
  for (double friction : {0.0, 5.0, 15.0, 20.0, 30.0, 45.0})
    for (double dilation : {0.0, 0.5, 1.0})
      for (double cohesion : {0.0, 1e3})
        for (double nu : {0.0, 0.3, 0.4999})
          if ((friction > 0 || dilation == 0) && friction + cohesion > 0)
            all.push_back({modulus, nu, friction * degree, cohesion, dilation * friction * degree});
  return all;
}

std::string name_of(const MohrCoulomb& material) {
  return "phi " + std::to_string(material.friction_angle / degree) + " psi " +
         std::to_string(material.dilation_angle / degree) + " c " + std::to_string(material.cohesion) +
         " nu " + std::to_string(material.poissons_ratio);
}

/// Round-off, relative to the trial stress, of results that went through the elastic trial by different
/// roads: near incompressibility the volumetric part of a strain's own rounding becomes lambda / 2G times as
/// much stress.
double round_off_of(const MohrCoulomb& material) {
  const double nu = material.poissons_ratio;
  return 20 * epsilon * (1 + nu / (1 - 2 * nu));
}

struct State {
  Stress stress, strain_increment;
  Stress trial;  ///< what elasticity makes of it
};

/// An admissible stress and an increment that moves the elastic trial by a hundredth to nine times the
/// typical stress. Every fourth has two equal principal stresses, every eighth three, before and after.
class RandomStates {
 public:
  explicit RandomStates(const MohrCoulomb& material)
      : material_(material),
        law_(material),
        elastic_(LinearElastic{material.youngs_modulus, material.poissons_ratio}) {}

  State next() {
    ++count_;
    State state;
    state.stress = law_.update(random(typical_stress, -typical_stress), {}, 1.0);
    const double reach = 3 * typical_stress * std::pow(10.0, -2 * std::abs(uniform()));
    state.strain_increment = strain_for(material_, random(reach, 2 * reach * uniform()));
    state.trial = elastic_.update(state.stress, state.strain_increment, 1.0);
    return state;
  }

  double uniform() { return uniform_(generator_); }

 private:
  Stress random(double reach, double mean) {
    Stress stress{mean + reach * uniform(), mean + reach * uniform(), mean + reach * uniform(),
                  reach * uniform()};
    if (count_ % 4 == 0) stress[3] = 0.0;
    if (count_ % 8 == 0) stress[1] = stress[0];
    if (count_ % 8 == 4 || count_ % 16 == 0) stress[2] = stress[0];
    return stress;
  }

  MohrCoulomb material_;
  MohrCoulombLaw<double> law_;
  LinearElasticLaw<2, double> elastic_;
  std::mt19937_64 generator_{20240501};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
  int count_ = 0;
};

/// Calls `visit(material, law, state, states)` for `count` states of every material.
template <class Visit>
void for_every_state(int count, const Visit& visit) {
  for (const MohrCoulomb& material : materials()) {
    SCOPED_TRACE(name_of(material));
    const MohrCoulombLaw<double> law(material);
    RandomStates states(material);
    for (int i = 0; i < count && !testing::Test::HasFailure(); ++i)
      visit(material, law, states.next(), states);
  }
}

// ---------------------------------------------------------------------------------------------------------------
// Closed forms.

/// Strains along y by `count` steps while xx keeps its stress, from an isotropic pressure.
Stress after_biaxial_test(const MohrCoulomb& material, double pressure, double step, int count) {
  const MohrCoulombLaw<double> law(material);
  Stress stress{-pressure, -pressure, -pressure, 0.0};
  for (int i = 0; i < count; ++i) {
    double lower = -20 * std::abs(step),
           upper = 20 * std::abs(step);  // of the strain along x, found by halving
    for (int halving = 0; halving < 80; ++halving) {
      const double middle = (lower + upper) / 2;
      (law.update(stress, {middle, step, 0.0, 0.0}, 1.0)[0] < -pressure ? lower : upper) = middle;
    }
    stress = law.update(stress, {lower, step, 0.0, 0.0}, 1.0);
  }
  return stress;
}

TEST(VerificationOfMohrCoulomb, BiaxialCompressionAndExtensionEndAtRankinesStresses) {
  const double pressure = 2e4;
  for (const MohrCoulomb& material : materials()) {
    SCOPED_TRACE(name_of(material));
    const double sin_phi = std::sin(material.friction_angle), ratio = (1 + sin_phi) / (1 - sin_phi);
    const double intercept = 2 * material.cohesion * std::sqrt(ratio);
    const Stress passive = after_biaxial_test(material, pressure, -2e-4, 200);
    EXPECT_NEAR(passive[1], -(pressure * ratio + intercept), 1e-9 * pressure * ratio);
    EXPECT_NEAR(passive[0], -pressure, 1e-9 * pressure);
    EXPECT_LE(passive[2], -pressure * (1 - 1e-9));
    EXPECT_GE(passive[2], passive[1]);
    const Stress active = after_biaxial_test(material, pressure, 2e-4, 200);
    EXPECT_NEAR(active[1], -(pressure - intercept) / ratio, 1e-9 * pressure);
    EXPECT_NEAR(active[0], -pressure, 1e-9 * pressure);
    EXPECT_LE(active[2], active[1] + 1e-9 * pressure);
    EXPECT_GE(active[2], -pressure * (1 + 1e-9));
  }
}

TEST(VerificationOfMohrCoulomb, SimpleShearWithoutDilationKeepsThePressure) {
  const double pressure = 2e4;
  for (MohrCoulomb material : materials()) {
    SCOPED_TRACE(name_of(material));
    material.dilation_angle = 0.0;
    const MohrCoulombLaw<double> law(material);
    const double strength =
        pressure * std::sin(material.friction_angle) + material.cohesion * std::cos(material.friction_angle);
    for (double sign : {-1.0, 1.0}) {
      Stress stress{-pressure, -pressure, -pressure, 0.0};
      for (int i = 0; i < 100; ++i) {
        stress = law.update(stress, {0.0, 0.0, 0.0, sign * 1e-4}, 1.0);
        // Elastic up to the limit, and there ever after: no step in between, whatever the increment.
        const double elastic = modulus / (1 + material.poissons_ratio) * 1e-4 * (i + 1);
        EXPECT_NEAR(stress[3], sign * std::min(strength, elastic), 1e-12 * pressure);
        for (std::size_t c : {0u, 1u, 2u}) EXPECT_NEAR(stress[c], -pressure, 1e-12 * pressure);
      }
    }
  }
}

TEST(VerificationOfMohrCoulomb, IsotropicTensionEndsAtTheApexExactly) {
  for (const MohrCoulomb& material : materials()) {
    if (material.friction_angle == 0) continue;
    SCOPED_TRACE(name_of(material));
    const MohrCoulombLaw<double> law(material);
    Stress stress{-500.0, -500.0, -500.0, 0.0};
    for (int i = 0; i < 300; ++i) stress = law.update(stress, {1e-4, 1e-4, 1e-4, 0.0}, 1.0);
    EXPECT_NEAR(stress[0], apex_of(material), 4 * epsilon * apex_of(material));
    EXPECT_EQ(stress, (Stress{stress[0], stress[0], stress[0], 0.0}));
  }
}

TEST(VerificationOfMohrCoulomb, TrescaHasNoApex) {
  const MohrCoulombLaw<double> law({modulus, 0.3, 0.0, 1e3, 0.0});
  const Stress tension{1e12, 1e12, 1e12, 0.0};
  EXPECT_EQ(law.update(tension, {}, 1.0), tension);
  const Stress sheared = law.update({1e9, 1e9, 1e9, 5e3}, {}, 1.0);
  EXPECT_NEAR(sheared[0], 1e9, 1e-6);
  EXPECT_NEAR(sheared[3], 1e3, 1e-6);
}

/// Points of the limit surface on a face, on an edge or at the apex, at several mean stresses, and the planes
/// there.
std::vector<Vector3d> points_of_surface(const MohrCoulomb& material) {
  const double sin_phi = std::sin(material.friction_angle);
  const auto from_smallest = [&](double s3) {
    return ((1 - sin_phi) * s3 + limit_of(material)) / (1 + sin_phi);
  };
  std::vector<Vector3d> points;
  for (double below : {1.0, 0.1, 0.01}) {
    const double top = material.friction_angle > 0 ? apex_of(material) : 0.0;
    const double s3 = top - below * typical_stress, s1 = from_smallest(s3);
    for (double share : {0.0, 0.2, 0.5, 0.9, 1.0}) points.emplace_back(s1, s3 + share * (s1 - s3), s3);
  }
  if (material.friction_angle > 0) points.push_back(Vector3d::Constant(apex_of(material)));
  return points;
}

// The hexagon's six faces and six corners in the deviatoric plane are the permutations of one face and its
// two ends. A trial is made backwards, by adding flow to a point of the surface: the law must find that
// point.
TEST(VerificationOfMohrCoulomb, FindsThePointFromWhichFlowStarted) {
  const std::array<std::array<int, 3>, 6> orders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (const MohrCoulomb& material : materials()) {
    SCOPED_TRACE(name_of(material));
    const MohrCoulombLaw<double> law(material);
    const auto planes = planes_of(material);
    RandomStates random(material);
    for (const Vector3d& sorted : points_of_surface(material)) {
      for (const auto& order : orders) {
        const Vector3d point(sorted[order[0]], sorted[order[1]], sorted[order[2]]);
        for (int repeat = 0; repeat < 12; ++repeat) {
          Vector3d strain = Vector3d::Zero();
          for (const Plane& plane : planes)
            if (plane.normal.dot(point) - limit_of(material) > -1e-9 * typical_stress)
              strain += plane.gradient * std::abs(random.uniform()) * typical_stress / modulus;
          // Without dilation no gradient of a potential leads out of the apex; any volumetric strain does.
          if (sorted[0] == sorted[2]) strain += Vector3d::Constant(std::abs(random.uniform()) * 1e-3);
          const Vector3d trial = point + elasticity_of(material) * strain;
          const double angle = repeat == 0 ? 0.0 : 3.2 * random.uniform();
          const Stress found = law.update(rotated(trial, angle), {}, 1.0);
          // The direction is the trial's, so where that is isotropic in the plane, so is the point.
          const double error = difference(found, rotated(point, angle)) / trial.cwiseAbs().maxCoeff();
          ASSERT_LT(error, round_off_of(material))
              << "point " << point.transpose() << " trial " << trial.transpose();
        }
      }
    }
  }
}

// With psi = phi this is the projection in the energy norm. A return that no set of planes yields is the
// apex's of flow without dilation.
TEST(VerificationOfMohrCoulomb, AgreesWithEveryActiveSetTriedInTurn) {
  for_every_state(300, [&](const MohrCoulomb& material, const auto& law, const State& state, RandomStates&) {
    const Directions directions(state.trial);
    const Vector3d trial = directions.seen(state.trial).diagonal();
    const auto expected = returned_by_enumeration(material, trial);
    if (!expected) {
      ASSERT_EQ(material.dilation_angle, 0.0);
    }
    const Matrix3d found = directions.seen(law.update(state.stress, state.strain_increment, 1.0));
    const Matrix3d exact = expected.value_or(Vector3d::Constant(apex_of(material))).asDiagonal();
    const double error = (found - exact).cwiseAbs().maxCoeff() / (size_of(state.trial) + material.cohesion);
    // The reference's own equations at the apex are nearly singular at small angles.
    ASSERT_LT(error, 10 * round_off_of(material))
        << "trial " << trial.transpose() << " expected " << exact.diagonal().transpose() << " found\n"
        << found;
  });
}

TEST(VerificationOfMohrCoulomb, AssociatedReturnIsTheClosestAdmissibleStress) {
  for_every_state(
      60, [](const MohrCoulomb& material, const auto& law, const State& state, RandomStates& states) {
        if (material.dilation_angle != material.friction_angle) return;
        const auto energy = [&](const Stress& a) {
          const Stress change{state.trial[0] - a[0], state.trial[1] - a[1], state.trial[2] - a[2],
                              state.trial[3] - a[3]};
          const Stress strain = strain_for(material, change);
          return change[0] * strain[0] + change[1] * strain[1] + change[2] * strain[2] +
                 2 * change[3] * strain[3];
        };
        const Stress found = law.update(state.stress, state.strain_increment, 1.0);
        const double least = energy(found);
        for (int i = 0; i < 50; ++i) {
          const double reach = size_of(state.trial) * std::pow(10.0, -6 * std::abs(states.uniform()));
          Stress other = found;
          for (double& component : other) component += reach * states.uniform();
          other = law.update(other, {}, 1.0);
          const double round_off = 1e-12 * std::pow(size_of(state.trial) + reach, 2) / modulus;
          ASSERT_GE(energy(other), least - round_off);
        }
      });
}

// ---------------------------------------------------------------------------------------------------------------
// Properties.

TEST(VerificationOfMohrCoulomb, ReturnsToTheLimitOnceAndLeavesElasticStatesAlone) {
  int elastic_states = 0, plastic_states = 0;
  for_every_state(500, [&](const MohrCoulomb& material, const auto& law, const State& state, RandomStates&) {
    const Stress found = law.update(state.stress, state.strain_increment, 1.0);
    ASSERT_LE(relative_excess(material, found), law.round_off);
    ASSERT_EQ(law.update(found, {}, 1.0), found);
    if (relative_excess(material, state.trial) <= 0) {
      // The compiler may fuse a multiplication and an addition of the elastic trial in one place and not in the
      // other: a rounding of each of the terms, which are as large as the stresses before and after.
      const double size = size_of(state.stress) + size_of(state.trial);
      ASSERT_LE(difference(found, state.trial), 4 * std::numeric_limits<double>::epsilon() * size);
      ++elastic_states;
    } else if (relative_excess(material, state.trial) > 1e-12) {
      ASSERT_NE(found, state.trial);
      ASSERT_GE(relative_excess(material, found), -law.round_off);
      ++plastic_states;
    }
  });
  EXPECT_GT(elastic_states, 3000);
  EXPECT_GT(plastic_states, 10000);
}

TEST(VerificationOfMohrCoulomb, PlasticStrainIsASumOfGradientsAndDissipates) {
  std::array<int, 7> states_on{};  // by the number of planes a returned stress lies on
  for_every_state(300, [&](const MohrCoulomb& material, const auto& law, const State& state, RandomStates&) {
    const Directions directions(state.trial);
    const Vector3d trial = directions.seen(state.trial).diagonal();
    const Matrix3d found = directions.seen(law.update(state.stress, state.strain_increment, 1.0));
    const Vector3d stress = found.diagonal();
    const double size = size_of(state.trial) + material.cohesion;
    ASSERT_LE(std::abs(found(0, 1)), 1e-14 * size) << "not coaxial";
    const Vector3d plastic = compliance_of(material) * (trial - stress);

    // Non-negative for every psi in [0, phi]: on a face its rate is t - (m - k) s3, which s3 <= c cot phi
    // keeps so. It is zero without cohesion when psi = phi; what flow makes of round-off at small angles is
    // left then.
    ASSERT_GE(stress.dot(plastic), -1e-12 * size * size / modulus);

    std::vector<Vector3d> generators;
    for (const Plane& plane : planes_of(material))
      if (plane.normal.dot(stress) - limit_of(material) > -1e-11 * size) generators.push_back(plane.gradient);
    ++states_on[generators.size()];
    // Without dilation the apex's gradients span the plane of no volume change; expansion is what is missing.
    if (generators.size() == 6 && material.dilation_angle == 0) generators.push_back(Vector3d::Ones());
    const double distance = distance_from_cone(plastic, generators) * modulus / size;
    ASSERT_LE(distance, 1e-10) << "plastic strain " << plastic.transpose() << " stress "
                               << stress.transpose();
  });
  for (std::size_t planes : {0u, 1u, 2u, 6u}) EXPECT_GT(states_on[planes], 500) << planes;
}

TEST(VerificationOfMohrCoulomb, IsInvariantUnderRotationInThePlane) {
  for_every_state(200, [&](const MohrCoulomb& material, const auto& law, const State& state,
                           RandomStates& states) {
    const double angle = 3.2 * states.uniform();
    const Stress there = law.update(turned(state.stress, angle), turned(state.strain_increment, angle), 1.0);
    const Stress here = law.update(state.stress, state.strain_increment, 1.0);
    const double error = difference(turned(there, -angle), here) / (size_of(state.trial) + material.cohesion);
    ASSERT_LT(error, round_off_of(material));
  });
}

TEST(VerificationOfMohrCoulomb, IsInvariantUnderExchangeOfAxesBitForBit) {
  const auto exchanged = [](const Stress& s) { return Stress{s[1], s[0], s[2], s[3]}; };
  const auto mirrored = [](const Stress& s) { return Stress{s[0], s[1], s[2], -s[3]}; };
  for_every_state(200, [&](const MohrCoulomb&, const auto& law, const State& state, RandomStates&) {
    const Stress found = law.update(state.stress, state.strain_increment, 1.0);
    ASSERT_EQ(law.update(exchanged(state.stress), exchanged(state.strain_increment), 1.0), exchanged(found));
    ASSERT_EQ(law.update(mirrored(state.stress), mirrored(state.strain_increment), 1.0), mirrored(found));
  });
}

// The axis across the plane is computed apart, so its exchange with the others holds to round-off.
TEST(VerificationOfMohrCoulomb, TreatsTheAxisAcrossThePlaneAsAnyOther) {
  for_every_state(200, [](const MohrCoulomb& material, const auto& law, const State& state, RandomStates&) {
    const auto normal = [](const Stress& s) { return Stress{s[0], s[1], s[2], 0.0}; };
    const auto cycled = [](const Stress& s) { return Stress{s[1], s[2], s[0], 0.0}; };
    const Stress here = law.update(normal(state.stress), normal(state.strain_increment), 1.0);
    const Stress there = law.update(cycled(state.stress), cycled(state.strain_increment), 1.0);
    ASSERT_LT(difference(there, cycled(here)),
              round_off_of(material) * (size_of(state.trial) + material.cohesion));
  });
}

TEST(VerificationOfMohrCoulomb, ScalesWithPowersOfTwoBitForBit) {
  for_every_state(100, [](const MohrCoulomb& material, const auto& law, const State& state, RandomStates&) {
    for (double factor : {0x1p-30, 0x1p-1, 0x1p40}) {
      const auto scaled = [&](Stress s) {
        for (double& component : s) component *= factor;
        return s;
      };
      MohrCoulomb other = material;
      other.youngs_modulus *= factor;
      other.cohesion *= factor;
      ASSERT_EQ(MohrCoulombLaw<double>(other).update(scaled(state.stress), state.strain_increment, 1.0),
                scaled(law.update(state.stress, state.strain_increment, 1.0)));
    }
  });
}

TEST(VerificationOfMohrCoulomb, SinglePrecisionAgreesToItsRoundOff) {
  const double single = std::numeric_limits<float>::epsilon();
  for_every_state(200, [&](const MohrCoulomb& material, const auto& law, const State& state, RandomStates&) {
    const MohrCoulombLaw<float> narrow(material);
    SymmetricTensor<2, float> trial;
    for (std::size_t c = 0; c < 4; ++c) trial[c] = static_cast<float>(state.trial[c]);
    const auto found = narrow.update(trial, {}, 1.0f);
    ASSERT_EQ(narrow.update(found, {}, 1.0f), found);
    // The limit's own constants are rounded to single precision once more.
    ASSERT_LE(relative_excess(material, found), 2 * narrow.round_off);
    const Stress wide{found[0], found[1], found[2], found[3]};
    const double error =
        difference(wide, law.update(state.trial, {}, 1.0)) / (size_of(state.trial) + material.cohesion);
    // Rounding of the trial and of the constants, each magnified a few times by the direction of flow.
    ASSERT_LT(error, 32 * single);
  });
}

// ---------------------------------------------------------------------------------------------------------------
// Where formulas tend to break.

TEST(MohrCoulombLaw, KeepsSandWithoutStressAtTheApex) {
  for (double dilation : {0.0, 15.0, 30.0}) {
    const MohrCoulomb sand{modulus, 0.3, 30 * degree, 0.0, dilation * degree};
    const MohrCoulombLaw<double> law(sand);
    const Stress none{};
    EXPECT_EQ(law.update(none, none, 1.0), none);
    EXPECT_EQ(law.update(none, {1e-3, 1e-3, 0.0, 0.0}, 1.0), none);
    EXPECT_EQ(law.update(none, {1e-3, 0.0, 0.0, 0.0}, 1.0), none);
    EXPECT_EQ(law.update({-1e-9, -1e-9, -1e-9, 0.0}, {1e-2, 1e-2, 0.0, 1e-3}, 1.0), none);
    // Pressed together it carries load again.
    EXPECT_LT(law.update(none, {-1e-3, -1e-3, 0.0, 0.0}, 1.0)[0], -1e3);
  }
}

// Where much flow has led close to the apex of a cohesionless body, the returned stress is far smaller than
// the trial's round-off allows for; it is still on the limit to its own.
TEST(MohrCoulombLaw, HoldsTheLimitCloseToTheApexOfSand) {
  for (double dilation : {0.0, 15.0, 30.0}) {
    const MohrCoulomb sand{modulus, 0.3, 30 * degree, 0.0, dilation * degree};
    const MohrCoulombLaw<double> law(sand);
    const Plane plane = planes_of(sand)[1];  // first largest, third smallest
    for (double s3 = -1e3; s3 < -1e-14; s3 /= 3) {
      for (double share : {0.0, 0.01, 0.5, 0.99, 1.0}) {
        const double s1 = s3 / 3;
        const Vector3d point(s1, s1 + share * (s3 - s1), s3);
        const Vector3d trial = point + elasticity_of(sand) * plane.gradient * 1e-3;
        for (const Vector3d& ordered :
             {trial, Vector3d(trial[0], trial[2], trial[1]), Vector3d(trial[1], trial[2], trial[0])}) {
          const Stress found = law.update(rotated(ordered, 0.3), {}, 1.0);
          EXPECT_LE(relative_excess(sand, found), law.round_off);
          EXPECT_EQ(law.update(found, {}, 1.0), found);
          EXPECT_LE(size_of(found), std::abs(s3) + 1e-11 * typical_stress);
        }
      }
    }
  }
}

TEST(MohrCoulombLaw, GoesOverIntoTrescaAsFrictionVanishes) {
  const MohrCoulombLaw<double> tresca({modulus, 0.3, 0.0, 1e3, 0.0});
  const MohrCoulombLaw<float> tresca_float({modulus, 0.3, 0.0, 1e3, 0.0});
  for (double friction : {1e-9, 1e-12, 1e-17, 1e-40, 1e-300, 5e-324}) {
    for (double dilation : {0.0, friction}) {
      const MohrCoulomb material{modulus, 0.3, friction, 1e3, dilation};
      const MohrCoulombLaw<double> law(material);
      const MohrCoulombLaw<float> narrow(material);
      for (double shear : {0.0, 5e3}) {
        for (double zz : {-2e4, 1e4, 3e4}) {
          const Stress trial{2e4, -1e4, zz, shear};
          EXPECT_LT(difference(law.update(trial, {}, 1.0), tresca.update(trial, {}, 1.0)),
                    1e5 * friction + 1e-10);
          const SymmetricTensor<2, float> single{2e4f, -1e4f, static_cast<float>(zz),
                                                 static_cast<float>(shear)};
          const auto found = narrow.update(single, {}, 1.0f), limit = tresca_float.update(single, {}, 1.0f);
          for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(found[c], limit[c], 1e-2);
        }
      }
    }
  }
}

TEST(MohrCoulombLaw, IsFiniteAtTheEndsOfItsParameters) {
  for (double friction : {0.0, 1e-8, 89.9, 90 - 1e-6}) {
    for (double share : {0.0, 0.5, 1.0}) {
      for (double nu : {0.0, 0.4999, 0.49999999}) {
        for (double cohesion : {0.0, 1.0}) {
          const MohrCoulomb material{modulus, nu, friction * degree, cohesion, share * friction * degree};
          SCOPED_TRACE(name_of(material));
          const MohrCoulombLaw<double> law(material);
          for (const Stress& trial :
               {Stress{1e4, 1e4, 1e4, 0}, Stress{-1e4, -1e4, -1e4, 0}, Stress{0, 0, 0, 1e4},
                Stress{0, 0, 1e4, 0}, Stress{1e4, -1e4, 3e3, 2e3}, Stress{0, 0, 0, 0}}) {
            const Stress found = law.update(trial, {}, 1.0);
            EXPECT_LE(relative_excess(material, found), law.round_off);
            EXPECT_EQ(law.update(found, {}, 1.0), found);
            for (double component : found) EXPECT_TRUE(std::isfinite(component));
          }
        }
      }
    }
  }
}

TEST(MohrCoulombLaw, HasTheWaveAndTheYieldFunctionOfItsParameters) {
  const MohrCoulomb material{modulus, 0.3, 30 * degree, 1e3, 0.0};
  EXPECT_DOUBLE_EQ(MohrCoulombLaw<double>(material).wave_modulus(),
                   (LinearElasticLaw<2, double>({modulus, 0.3}).wave_modulus()));
  const Stress stress = rotated({2e3, -5e3, 1e3}, 0.4);
  EXPECT_NEAR(yield_function(material, stress), 7e3 - 3e3 * 0.5 - 2e3 * std::cos(30 * degree), 1e-9);
  EXPECT_NEAR(yield_function(material, rotated({2e3, 1e3, -5e3}, 0.4)), yield_function(material, stress),
              1e-9);
}

}  // namespace
