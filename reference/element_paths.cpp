#include "reference/element_paths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace mpm::reference {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

double ratio_of(double angle) { return (1 - std::sin(angle)) / (1 + std::sin(angle)); }

double tensile_strength(const MohrCoulombSoil& soil) {
  return 2 * soil.cohesion * std::cos(soil.friction_angle) / (1 + std::sin(soil.friction_angle));
}

double apex_of(const MohrCoulombSoil& soil) {
  return soil.friction_angle > 0 ? soil.cohesion / std::tan(soil.friction_angle) : never;
}

double twice_shear_modulus(const MohrCoulombSoil& soil) {
  return soil.youngs_modulus / (1 + soil.poissons_ratio);
}

/// Lamé's first constant over twice the shear modulus.
double relative_lame(const MohrCoulombSoil& soil) {
  return soil.poissons_ratio / (1 - 2 * soil.poissons_ratio);
}

/// The two branches of a path as rates with the imposed strain, and the change of the driven stress that the
/// limit allows.
struct Branches {
  ElementState elastic, on_limit;
  double limit_strain;
};

Branches biaxial(const MohrCoulombSoil& soil, double pressure, bool extends) {
  const double nu = soil.poissons_ratio, k = ratio_of(soil.friction_angle), m = ratio_of(soil.dilation_angle);
  const double t = tensile_strength(soil), modulus = soil.youngs_modulus / (1 - nu * nu);
  const double limit = extends ? t - k * pressure : -(pressure + t) / k;
  return {.elastic = {0, modulus, nu * modulus, 0, (1 - 2 * nu) / (1 - nu)},
          .on_limit = {0, 0, 0, 0, extends ? 1 - m : 1 - 1 / m},
          .limit_strain = (limit + pressure) / modulus};
}

/// With l Lamé's constant over 2 G and flow f (the sum on both faces) per imposed strain, compression has the
/// elastic strains (-f/2, 1 + m f, -f/2), extension (m f/2, 1 - f, m f/2); f follows from keeping the limit.
Branches oedometric(const MohrCoulombSoil& soil, double pressure, bool extends) {
  const double k = ratio_of(soil.friction_angle), m = ratio_of(soil.dilation_angle), l = relative_lame(soil);
  const double twice_shear = twice_shear_modulus(soil), reserve = pressure * (1 - k) + tensile_strength(soil);
  const auto rates = [&](double axial, double lateral) {
    const double mean = l * (axial + 2 * lateral);
    return ElementState{twice_shear * (mean + lateral), twice_shear * (mean + axial),
                        twice_shear * (mean + lateral), 0, 1};
  };
  const ElementState elastic = rates(1, 0);
  const double approach = extends ? elastic.yy - k * elastic.xx : k * elastic.yy - elastic.xx;
  const double flow = extends ? (l * (1 - k) + 1) / (l * (1 - k) * (1 - m) + 1 + k * m / 2)
                              : (l * (1 - k) - k) / (l * (1 - k) * (1 - m) + 0.5 + k * m);
  return {
      .elastic = elastic,
      .on_limit = extends ? rates(1 - flow, m * flow / 2) : rates(1 + m * flow, -flow / 2),
      .limit_strain = approach > 0 ? (extends ? reserve : -reserve) / approach : (extends ? never : -never)};
}

Branches simple_shear(const MohrCoulombSoil& soil, double pressure, bool positive) {
  const double strength =
      pressure * std::sin(soil.friction_angle) + soil.cohesion * std::cos(soil.friction_angle);
  const double modulus = twice_shear_modulus(soil), sign = positive ? 1 : -1;
  return {.elastic = {0, 0, 0, modulus, 0},
          .on_limit = {0, 0, 0, 0, sign * 2 * std::sin(soil.dilation_angle)},
          .limit_strain = sign * strength / modulus};
}

Branches isotropic(const MohrCoulombSoil& soil, double pressure, bool extends) {
  const double modulus = soil.youngs_modulus / (1 - 2 * soil.poissons_ratio);
  return {.elastic = {modulus, modulus, modulus, 0, 3},
          .on_limit = {0, 0, 0, 0, 3},
          .limit_strain = extends ? (apex_of(soil) + pressure) / modulus : -never};
}

Branches branches_of(const MohrCoulombSoil& soil, LoadingPath path, double pressure, bool positive) {
  switch (path) {
    case LoadingPath::biaxial:
      return biaxial(soil, pressure, positive);
    case LoadingPath::oedometric:
      return oedometric(soil, pressure, positive);
    case LoadingPath::simple_shear:
      return simple_shear(soil, pressure, positive);
    case LoadingPath::isotropic:
      break;
  }
  return isotropic(soil, pressure, positive);
}

ElementState advanced(const ElementState& state, const ElementState& rate, double by) {
  return {state.xx + by * rate.xx, state.yy + by * rate.yy, state.zz + by * rate.zz, state.xy + by * rate.xy,
          state.volumetric_strain + by * rate.volumetric_strain};
}

double smaller_magnitude(double a, double b) { return std::abs(a) < std::abs(b) ? a : b; }

}  // namespace

void check(const MohrCoulombSoil& soil) {
  require(soil.youngs_modulus > 0, "Young's modulus must be above zero");
  require(soil.poissons_ratio >= 0 && soil.poissons_ratio < 0.5, "Poisson's ratio must be in [0, 0.5)");
  require(soil.friction_angle >= 0 && soil.friction_angle < std::numbers::pi / 2,
          "the friction angle must be in [0, pi/2)");
  require(soil.dilation_angle >= 0 && soil.dilation_angle <= soil.friction_angle,
          "the dilation angle must be in [0, phi]");
  require(soil.cohesion >= 0 && soil.cohesion + soil.friction_angle > 0, "a soil needs cohesion or friction");
}

ElementTestSolution::ElementTestSolution(const MohrCoulombSoil& soil, LoadingPath path, double pressure,
                                         double strain)
    : start_{-pressure, -pressure, -pressure, 0, 0} {
  check(soil);
  require(pressure >= 0 && pressure * (1 - ratio_of(soil.friction_angle)) + tensile_strength(soil) > 0,
          "the path must start inside the limit, from a pressure >= 0");
  require(strain != 0 && std::isfinite(strain), "the path needs a direction");
  const Branches branches = branches_of(soil, path, pressure, strain > 0);
  elastic_ = branches.elastic;
  on_limit_ = branches.on_limit;
  limit_strain_ = branches.limit_strain;
  end_strain_ = strain > 0 ? never : -never;
  // Only the edge that extension climbs leads to the apex.
  if (path == LoadingPath::oedometric && strain > 0 && on_limit_.xx > 0) {
    end_strain_ = limit_strain_ + (apex_of(soil) - at(limit_strain_).xx) / on_limit_.xx;
  }
}

ElementState ElementTestSolution::at(double strain) const {
  const double before = smaller_magnitude(strain, limit_strain_);
  const double on_limit = smaller_magnitude(strain, end_strain_) - before;
  ElementState state = advanced(advanced(start_, elastic_, before), on_limit_, on_limit);
  // The volume still grows by the imposed strain where the apex has been reached.
  state.volumetric_strain += on_limit_.volumetric_strain * (strain - before - on_limit);
  return state;
}

double relative_excess(const MohrCoulombSoil& soil, double xx, double yy, double zz, double xy) {
  using Wide = long double;
  const Wide phi = soil.friction_angle, root = std::cos(phi) / (1 + std::sin(phi));  // its square is k
  const Wide center = (Wide(xx) + Wide(yy)) / 2;
  const Wide radius = std::hypot((Wide(xx) - Wide(yy)) / 2, Wide(xy));
  const Wide largest = std::max(center + radius, Wide(zz)), smallest = std::min(center - radius, Wide(zz));
  const Wide strength = 2 * Wide(soil.cohesion) * root;
  const Wide scale = std::max(std::abs(largest), std::abs(smallest)) + strength;
  return scale > 0 ? static_cast<double>((largest - root * root * smallest - strength) / scale) : 0.0;
}

}  // namespace mpm::reference
