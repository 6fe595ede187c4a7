#pragma once

#include "reference/bearing_capacity.hpp"

namespace mpm::reference {

/// One half of a rigid strip on a linear elastic layer in plane strain: a rectangle of soil, 0 <= x <=
/// side_distance and as high as the layer is deep, fixed at its base, on rollers along the axis x = 0 and
/// along its far side, the strip covering 0 <= x <= half_width of its surface, the rest of the surface free.
/// Small displacements, no weight.
struct ElasticStrip {
  double half_width;      ///< b = B/2 [m], 0 < b <= side_distance
  double layer_depth;     ///< H [m], > 0
  double side_distance;   ///< L, from the axis to the rollers [m]
  double youngs_modulus;  ///< E [Pa], > 0
  double poissons_ratio;  ///< nu, 0 <= nu <= 0.49
  Roughness roughness;    ///< smooth: no shear below the strip; rough: no horizontal displacement
};

/// Mean pressure below the strip over its settlement.
struct SecantStiffness {
  double value;  ///< [Pa/m]
  double error;  ///< estimated bound of the distance to the exact value [Pa/m]
};

/// The stiffness by finite elements of high order, graded towards the strip's edge, extrapolated; it takes
/// about 2 s.
///
/// The strain energy of unit settlement is minimised over a tensor product of Lobatto shape functions
/// (integrals of Legendre polynomials) of equal order in x and y; elements halve in size towards x =
/// half_width and towards the surface, where the contact stress of a rigid strip is singular as
/// 1/sqrt(distance). The energy in an element at the edge falls as its size, hence the error by one half with
/// every halving; elsewhere it falls fast with the order. Every refinement contains the coarser space, so one
/// mesh's stiffness comes down to the exact one.
///
/// `value` is Richardson's from two meshes of order 5, 2 k(14 halvings) - k(13). `error` is what the
/// extrapolation took off the finer mesh, because the rough strip's singularity r^(-1/2 +- i epsilon) falls
/// only nearly by one half, plus the difference to the same of order 4; it is a few millionths of the value
/// for the proportions of a shallow footing. Throws std::invalid_argument where the ranges above are left.
SecantStiffness secant_stiffness(const ElasticStrip& strip);

/// The same for one mesh, never below the exact stiffness but for round-off: order of the shape functions >=
/// 1, halvings of the elements towards the edge >= 0. Throws std::invalid_argument as above.
double secant_stiffness(const ElasticStrip& strip, int order, int halvings);

/// Where the layer is much deeper than wide and the strip smooth, the surface responds to a harmonic load as
/// a half plane and in the mean as a column, and the integral equation for the contact pressure has the
/// closed solution
///   1/k = (b/L) H / E_oed - [4 (1 - nu^2) b / (pi E)] ln sin(pi b / (2 L)),
/// E_oed = E (1 - nu) / [(1 + nu)(1 - 2 nu)]; the part left out falls as (H/L)^2 exp(-2 pi H/L). With b = L
/// the strip compresses a column, k = E_oed/H, whatever the depth and roughness. [Pa/m]
double deep_layer_stiffness(const ElasticStrip& strip);

}  // namespace mpm::reference
