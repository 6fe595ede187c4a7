#pragma once

/// Closed forms of the tests a soil sample is put to in the laboratory, in plane strain and small strain, for
/// isotropic elasticity with the Mohr–Coulomb limit and perfectly plastic flow. One homogeneous element: no
/// mesh, no inertia, no weight.
namespace mpm::reference {

/// Isotropic elasticity with the Mohr–Coulomb limit.
struct MohrCoulombSoil {
  double youngs_modulus;  ///< E [Pa], > 0
  double poissons_ratio;  ///< nu [-], 0 <= nu < 0.5
  double friction_angle;  ///< phi [rad], 0 <= phi < pi/2
  double cohesion;        ///< c [Pa], >= 0, above zero where phi is zero
  double dilation_angle;  ///< psi [rad], 0 <= psi <= phi
};

/// Throws std::invalid_argument where one of the ranges above is left.
void check(const MohrCoulombSoil& soil);

/// What is imposed on the element; every path starts from an isotropic pressure, and zz never strains but in
/// isotropic tension.
enum class LoadingPath {
  biaxial,       ///< yy strains while the stress xx keeps its value
  oedometric,    ///< yy strains and xx does not
  simple_shear,  ///< shear strain, while the mean of the stresses xx and yy keeps its value
  isotropic,     ///< xx, yy and zz strain equally
};

/// Stress and volume of the element, tension and expansion positive.
struct ElementState {
  double xx, yy, zz, xy;     ///< Cauchy stress [Pa]
  double volumetric_strain;  ///< sum of the normal strains since the start [-]
};

/// A soil on a path, from an isotropic pressure [Pa] >= 0 in one direction: elastic up to the limit, on it
/// from there. Every branch is a straight line in the imposed strain, because flow keeps its direction on
/// each.
///
/// With k = (1 - sin phi)/(1 + sin phi), m the same of psi, t = 2 c cos phi/(1 + sin phi) and p the pressure,
/// the limit is s1 = k s3 + t and flow is dg/ds = (1, 0, -m) for s1 >= s2 >= s3 [deSouzaNeto08, ch. 8]:
///
/// - biaxial: E/(1 - nu^2) and zz = nu yy in the changes, up to Rankine's stresses yy = -(p + t)/k in
///   compression and yy = t - k p in extension. There nothing moves any more but the volume, by
///   1 - 1/m = -2 sin psi/(1 - sin psi) of yy's strain in compression, 1 - m in extension.
/// - oedometric: compression reaches the edge s1 = s2, if at all (k > nu/(1 - nu)), and climbs along it;
///   extension reaches the edge s2 = s3 and climbs to the apex.
/// - simple shear: xy = 2 G times the tensor's shear strain up to p sin phi + c cos phi, zz stays at -p; the
///   volume then grows by 2 sin psi of it.
/// - isotropic: three times the bulk modulus up to the apex c cot phi; without friction there is no end.
class ElementTestSolution {
 public:
  /// `strain` tells the direction only: above zero for extension, below for compression. Throws
  /// std::invalid_argument where the ranges above are left, and for a start that is at the limit already.
  ElementTestSolution(const MohrCoulombSoil& soil, LoadingPath path, double pressure, double strain);

  /// At an imposed strain [-] in the direction of the path: of yy, the tensor's xy, or each normal one.
  ElementState at(double strain) const;

  /// The imposed strain at which the limit is reached, signed; infinite where it never is.
  double limit_strain() const { return limit_strain_; }

  /// Change of the volumetric strain with the imposed strain on the limit [-].
  double dilatancy() const { return on_limit_.volumetric_strain; }

 private:
  ElementState start_;
  ElementState elastic_;              ///< changes with the imposed strain before the limit ...
  ElementState on_limit_;             ///< ... and on it
  double limit_strain_, end_strain_;  ///< the apex is reached at `end_strain_`, and nothing moves beyond
};

/// How far a stress lies beyond the limit, s1 - k s3 - t over (the largest magnitude of a principal stress +
/// t)
/// [-], negative inside; 0 where both are zero. In extended precision, since a limit that is met leaves
/// nothing but round-off.
double relative_excess(const MohrCoulombSoil& soil, double xx, double yy, double zz, double xy);

}  // namespace mpm::reference
