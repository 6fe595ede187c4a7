#include "reference/multi_surface_return.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

namespace mpm::reference {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// f = normal . s - limit <= 0, with flow along gradient.
struct Surface {
  Vector3d normal, gradient;
  double limit;
};

std::vector<Surface> surfaces_of(const MohrCoulombSoil& soil) {
  const double sin_phi = std::sin(soil.friction_angle), sin_psi = std::sin(soil.dilation_angle);
  std::vector<Surface> surfaces;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      if (a == b) continue;
      const Vector3d largest = Vector3d::Unit(a), smallest = Vector3d::Unit(b);
      surfaces.push_back({(1 + sin_phi) * largest - (1 - sin_phi) * smallest,
                          (1 + sin_psi) * largest - (1 - sin_psi) * smallest,
                          2 * soil.cohesion * std::cos(soil.friction_angle)});
    }
  }
  if (soil.friction_angle > 0) {
    const double apex = soil.cohesion / std::tan(soil.friction_angle);
    surfaces.push_back({Vector3d::Ones(), Vector3d::Ones(), 3 * apex});
  }
  return surfaces;
}

double largest_excess(const std::vector<Surface>& surfaces, const Vector3d& stress) {
  double largest = -std::numeric_limits<double>::infinity();
  for (const Surface& surface : surfaces)
    largest = std::max(largest, surface.normal.dot(stress) - surface.limit);
  return largest;
}

/// The stress with f = 0 on the surfaces of a set, a bit each, if flow along their gradients is unique and
/// goes forward.
std::optional<Vector3d> returned_to(const std::vector<Surface>& surfaces, unsigned set, const Matrix3d& flow,
                                    const Vector3d& trial, double close) {
  // A row left over says that its flow is zero.
  Matrix3d normals = Matrix3d::Zero(), gradients = Matrix3d::Zero(), idle = Matrix3d::Identity();
  Vector3d excess = Vector3d::Zero();
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (!(set >> i & 1u)) continue;
    normals.row(row) = surfaces[i].normal;
    gradients.col(row) = surfaces[i].gradient;
    excess[row] = surfaces[i].normal.dot(trial) - surfaces[i].limit;
    idle(row, row) = 0;
    ++row;
  }
  const Matrix3d direction = flow * gradients, matrix = normals * direction + idle;
  // Dependent surfaces; far from round-off, and from the smallest volume that 5 degrees of friction leave.
  if (std::abs(matrix.determinant()) < 1e-9 * matrix.colwise().norm().prod()) return std::nullopt;
  const Vector3d multipliers = matrix.partialPivLu().solve(excess);
  if (multipliers.minCoeff() < -close) return std::nullopt;
  return trial - direction * multipliers;
}

/// Equal principal stresses tell the part: none, the two larger or the two smaller, or all.
LimitPart part_of(Vector3d stress, double close) {
  std::sort(stress.begin(), stress.end());
  const bool low = stress[1] - stress[0] <= close, high = stress[2] - stress[1] <= close;
  if (low && high) return LimitPart::apex;
  return high ? LimitPart::compression_edge : low ? LimitPart::extension_edge : LimitPart::face;
}

}  // namespace

std::optional<ReturnedStress> multi_surface_return(const MohrCoulombSoil& soil,
                                                   const std::array<double, 3>& trial_stress) {
  check(soil);
  const std::vector<Surface> surfaces = surfaces_of(soil);
  const Vector3d trial(trial_stress.data());
  const double nu = soil.poissons_ratio;
  // Elasticity over 2 G; its size is left to the multipliers, which are stresses then.
  const Matrix3d elasticity = Matrix3d::Identity() + nu / (1 - 2 * nu) * Matrix3d::Ones();
  // A hundred times what the solution of three equations leaves at small angles.
  const double close = 1e-11 * (trial.cwiseAbs().maxCoeff() + soil.cohesion);
  if (largest_excess(surfaces, trial) <= 0) return ReturnedStress{trial_stress, LimitPart::inside};
  for (int members : {1, 2, 3}) {
    for (unsigned set = 1; set < 1u << surfaces.size(); ++set) {
      if (std::popcount(set) != members) continue;
      const auto stress = returned_to(surfaces, set, elasticity, trial, close);
      if (!stress || largest_excess(surfaces, *stress) > close) continue;
      return ReturnedStress{{(*stress)[0], (*stress)[1], (*stress)[2]}, part_of(*stress, close)};
    }
  }
  return std::nullopt;
}

}  // namespace mpm::reference
