#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "solver/lanes.hpp"
#include "solver/linear_elastic.hpp"
#include "solver/scene.hpp"
#include "solver/tensor.hpp"

namespace mpm {

/// Principal stresses [Pa], tension positive, largest >= middle >= smallest.
template <class Value>
struct PrincipalStresses {
  Value largest, middle, smallest;
};

/// Mohr's circle of the stresses in the plane [Pa]. The stress components lie `half_difference` and the shear
/// stress off its center, so their ratios to `radius` are cosine and sine of twice the principal direction's
/// angle.
template <class Value>
struct MohrCircle {
  Value center, half_difference, radius;
};

/// Circle of the components xx, yy and xy of a stress [Pa].
template <class Value>
MohrCircle<Value> mohr_circle(const SymmetricTensor<2, Value>& stress) {
  using std::sqrt;
  const Value half_difference = (stress[0] - stress[1]) / 2;
  return {(stress[0] + stress[1]) / 2, half_difference,
          sqrt(half_difference * half_difference + stress[3] * stress[3])};
}

/// The two principal stresses in the plane and the one across it, `zz` [Pa], in order.
template <class Value>
PrincipalStresses<Value> principal_stresses(const MohrCircle<Value>& circle, const Value& zz) {
  using std::max, std::min;
  const Value major = circle.center + circle.radius, minor = circle.center - circle.radius;
  return {max(major, zz), max(minor, min(major, zz)), min(minor, zz)};
}

/// f = (s1 - s3) + (s1 + s3) sin phi - 2 c cos phi [Pa], negative inside the elastic domain [deSouzaNeto08,
/// ch. 6].
template <class Real>
Real yield_function(const MohrCoulomb& material, const SymmetricTensor<2, Real>& stress) {
  const auto [s1, s2, s3] = principal_stresses(mohr_circle(stress), stress[2]);
  return (s1 - s3) + (s1 + s3) * static_cast<Real>(std::sin(material.friction_angle)) -
         static_cast<Real>(2 * material.cohesion * std::cos(material.friction_angle));
}

/// Mohr–Coulomb plasticity in plane strain: an elastic trial, returned to the limit in principal stresses
/// [ClausenDamkildeAndersen06], in closed form on the face, on both edges and at the apex.
///
/// With k = (1 - sin phi)/(1 + sin phi), the same ratio m of psi, and t = 2 c cos phi/(1 + sin phi), the
/// strength in uniaxial tension, limit and plastic potential are
///
///     f = s1 - k s3 - t <= 0,     g = s1 - m s3,     s1 >= s2 >= s3.
///
/// The apex is s1 = s2 = s3 = c cot phi. Its region is what the others leave: a trial stress goes there when
/// its return to the face, or to the edge which that passes, would lie beyond it. For psi > 0 this is the
/// region in which the plastic strain is a non-negative sum of the potentials' gradients; psi = 0 has no
/// gradient that expands, and the apex takes the expansion besides. Plastic work is never negative, for any
/// psi in [0, phi].
///
/// All regions are computed and one is selected, without a branch, so that lanes of particles can be returned
/// at once; where none of them yields, the return is left out. Squares of the stress in the plane must be
/// normal numbers: in single precision the law holds for stresses from 1e-18 to 1e18 Pa, and at zero.
template <class Real>
class MohrCoulombLaw {
 public:
  /// How far a stress may lie beyond the limit and still count as elastic: f <= round_off (max |s| + t).
  /// A returned stress lies within it, so that returning again changes no bit: it carries one rounding each
  /// from s1 = k s3 + t, from the circle's center and radius, and from both components; and the same once
  /// more when its principal stresses are taken again.
  static constexpr Real round_off = 8 * std::numeric_limits<Real>::epsilon();

  explicit MohrCoulombLaw(const MohrCoulomb& material);

  /// Cauchy stress [Pa] after a strain increment [-]: the elastic one where that is within the limit.
  template <class Value>
  SymmetricTensor<2, Value> update(const SymmetricTensor<2, Value>& stress,
                                   const SymmetricTensor<2, Value>& strain_increment,
                                   const Value& volume_ratio) const;

  /// Modulus of the fastest elastic wave [Pa].
  double wave_modulus() const { return elastic_.wave_modulus(); }

 private:
  template <class Value>
  PrincipalStresses<Value> returned(const PrincipalStresses<Value>& trial, const Value& excess) const;

  LinearElasticLaw<2, Real> elastic_;
  Real strength_ratio_, tensile_strength_, apex_;                         // k, t, c cot phi
  Real flow_ratio_, lateral_flow_;                                        // m, q
  Real face_compliance_, compression_compliance_, extension_compliance_;  // 1/h, 1/(2h - 1), 1/(2h - k m)
};

/// The constants of the return. A unit of flow on the face, D dg/ds in units of twice the shear modulus, is
/// (1 + q, q, q - m) with q = (1 - m) nu/(1 - 2 nu), and lowers f by h = 1 + k m + q (1 - k).
template <class Real>
MohrCoulombLaw<Real>::MohrCoulombLaw(const MohrCoulomb& material)
    : elastic_(LinearElastic{material.youngs_modulus, material.poissons_ratio}) {
  const double nu = material.poissons_ratio, c = material.cohesion;
  const double sin_phi = std::sin(material.friction_angle), cos_phi = std::cos(material.friction_angle);
  const double sin_psi = std::sin(material.dilation_angle), cos_psi = std::cos(material.dilation_angle);
  assert(nu < 0.5 && c >= 0 && sin_psi >= 0 && sin_psi <= sin_phi && cos_phi > 0);

  // (1 - sin)/(1 + sin) = (cos/(1 + sin))^2 keeps its digits up to a right angle, and is exactly 1 at zero.
  const double k = std::pow(cos_phi / (1 + sin_phi), 2), m = std::pow(cos_psi / (1 + sin_psi), 2);
  const double q = nu / (1 - 2 * nu) * 2 * sin_psi / (1 + sin_psi);
  const double h = 1 + k * m + q * 2 * sin_phi / (1 + sin_phi);
  // Without friction the apex is at infinity; the largest number stands for it, because it can be compared.
  const double apex = sin_phi > 0 ? c * cos_phi / sin_phi : std::numeric_limits<double>::infinity();

  strength_ratio_ = static_cast<Real>(k);
  tensile_strength_ = static_cast<Real>(2 * c * cos_phi / (1 + sin_phi));
  apex_ = static_cast<Real>(std::min<double>(apex, std::numeric_limits<Real>::max()));
  flow_ratio_ = static_cast<Real>(m);
  lateral_flow_ = static_cast<Real>(q);
  face_compliance_ = static_cast<Real>(1 / h);
  compression_compliance_ = static_cast<Real>(1 / (2 * h - 1));
  extension_compliance_ = static_cast<Real>(1 / (2 * h - k * m));
}

template <class Real>
template <class Value>
SymmetricTensor<2, Value> MohrCoulombLaw<Real>::update(const SymmetricTensor<2, Value>& stress,
                                                       const SymmetricTensor<2, Value>& strain_increment,
                                                       const Value& volume_ratio) const {
  using std::max;
  const SymmetricTensor<2, Value> elastic = elastic_.update(stress, strain_increment, volume_ratio);
  const Value zz = elastic[2];
  const MohrCircle<Value> circle = mohr_circle(elastic);
  const PrincipalStresses<Value> trial = principal_stresses(circle, zz);
  const Value excess = trial.largest - strength_ratio_ * trial.smallest - tensile_strength_;
  const Value scale = max(trial.largest, -trial.smallest) + tensile_strength_;
  const auto yields = excess > round_off * scale;
  if (!any(yields)) return elastic;

  // The principal directions stay, so the components shrink towards the center with the circle.
  const PrincipalStresses<Value> limit = returned(trial, excess);
  const auto zz_is_largest = zz > circle.center + circle.radius;
  const auto zz_is_smallest = zz < circle.center - circle.radius;
  const Value major = select(zz_is_largest, limit.middle, limit.largest);
  const Value minor = select(zz_is_smallest, limit.middle, limit.smallest);
  const Value across =
      select(zz_is_largest, limit.largest, select(zz_is_smallest, limit.smallest, limit.middle));
  const Value center = (major + minor) / 2;
  const Value shrinkage = (major - minor) / 2 / select(circle.radius > Value(0), circle.radius, Value(1));
  const Value deviation = circle.half_difference * shrinkage;
  return {select(yields, center + deviation, elastic[0]), select(yields, center - deviation, elastic[1]),
          select(yields, across, elastic[2]), select(yields, elastic[3] * shrinkage, elastic[3])};
}

/// Return of a trial stress s whose f is `excess` > 0 [deSouzaNeto08, ch. 8]; s2' matters on the face only:
///
///     face             flow = f/h                             s3' = s3 - (q - m) flow,  s2' = s2 - q flow
///     edge s1' = s2'   flow = [2 f - (s1 - s2)]/(2h - 1)      s3' = s3 - (q - m) flow
///     edge s2' = s3'   flow = [2 f - k (s2 - s3)]/(2h - k m)  s3' = [s2 + s3 - (2q - m) flow]/2
///
/// each with s1' = k s3' + t from f = 0. The edges are triaxial compression and triaxial extension; there,
/// `flow` is the sum of those on both faces.
///
/// The face's return passes the compression edge when h (s1 - s2) < f, and the extension edge when
/// h (s2 - s3) < m f; these are also the conditions under which the edge's second face flows forward. The
/// apex is passed when s3' > c cot phi. Who passes both edges has passed the apex on either: the point on the
/// face has s1' < s2' < s3' then, above the apex, and neither edge's flow turns that far, for any k <= m <= 1
/// and q >= 0.
template <class Real>
template <class Value>
PrincipalStresses<Value> MohrCoulombLaw<Real>::returned(const PrincipalStresses<Value>& trial,
                                                        const Value& excess) const {
  using std::max, std::min;
  const auto& [s1, s2, s3] = trial;
  const Value face_flow = excess * face_compliance_;
  const Value compression_flow = (2 * excess - (s1 - s2)) * compression_compliance_;
  const Value extension_flow = (2 * excess - strength_ratio_ * (s2 - s3)) * extension_compliance_;
  const Value on_face = s3 + (flow_ratio_ - lateral_flow_) * face_flow;
  const Value on_compression_edge = s3 + (flow_ratio_ - lateral_flow_) * compression_flow;
  const Value on_extension_edge = (s2 + s3 + (flow_ratio_ - 2 * lateral_flow_) * extension_flow) / 2;

  const auto passes_compression_edge = s1 - s2 < face_flow;
  const auto passes_extension_edge = s2 - s3 < flow_ratio_ * face_flow;
  const Value apex(apex_);
  const Value smallest = min(select(passes_compression_edge, on_compression_edge,
                                    select(passes_extension_edge, on_extension_edge, on_face)),
                             apex);
  const Value largest = select(smallest < apex, strength_ratio_ * smallest + tensile_strength_, apex);
  // Where the returned stress is small, round-off of the trial stress must not push the middle one out of
  // order.
  const Value middle = max(smallest, min(largest, s2 - lateral_flow_ * face_flow));
  return {largest, select(passes_compression_edge, largest, select(passes_extension_edge, smallest, middle)),
          smallest};
}

}  // namespace mpm
