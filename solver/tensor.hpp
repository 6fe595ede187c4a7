#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace mpm {

/// One value per axis.
template <int Dim, class Real>
using Vector = std::array<Real, Dim>;

/// Independent components of a symmetric tensor: (xx) in 1D, (xx, yy, zz, xy) in 2D plane strain.
template <int Dim>
inline constexpr int symmetric_components = Dim == 1 ? 1 : 4;

/// Stress or strain increment; shear strain is the tensor component, not the engineering one.
template <int Dim, class Real>
using SymmetricTensor = std::array<Real, symmetric_components<Dim>>;

/// One scalar of every particle, contiguous and aligned for vector instructions.
template <class Real>
using Field = Eigen::Array<Real, Eigen::Dynamic, 1>;

/// Stress times a gradient: the traction-like vector of [Kiriyama15, Eq. 2].
template <int Dim, class Real>
Vector<Dim, Real> contract(const SymmetricTensor<Dim, Real>& stress, const Vector<Dim, Real>& gradient) {
  if constexpr (Dim == 1) {
    return {stress[0] * gradient[0]};
  } else {
    return {stress[0] * gradient[0] + stress[3] * gradient[1],
            stress[3] * gradient[0] + stress[1] * gradient[1]};
  }
}

/// Adds the symmetric part of velocity (x) gradient [Kiriyama15, Eq. 10a] to `rate`.
template <int Dim, class Real>
void add_symmetric_product(const Vector<Dim, Real>& velocity, const Vector<Dim, Real>& gradient,
                           SymmetricTensor<Dim, Real>& rate) {
  rate[0] += velocity[0] * gradient[0];
  if constexpr (Dim == 2) {
    rate[1] += velocity[1] * gradient[1];
    rate[3] += (velocity[0] * gradient[1] + velocity[1] * gradient[0]) / 2;
  }
}

/// A stress turned anticlockwise by an angle [rad] in the plane; zz stays. Exact for any angle.
template <class Real>
SymmetricTensor<2, Real> rotated(const SymmetricTensor<2, Real>& stress, Real angle) {
  const Real c = std::cos(angle), s = std::sin(angle);
  return {c * c * stress[0] + s * s * stress[1] - 2 * c * s * stress[3],
          s * s * stress[0] + c * c * stress[1] + 2 * c * s * stress[3], stress[2],
          c * s * (stress[0] - stress[1]) + (c * c - s * s) * stress[3]};
}

template <int Dim, class Real>
Real trace(const SymmetricTensor<Dim, Real>& tensor) {
  if constexpr (Dim == 1) {
    return tensor[0];
  } else {
    return tensor[0] + tensor[1] + tensor[2];
  }
}

}  // namespace mpm
