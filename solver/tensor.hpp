#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace mpm {

/// One value per axis; a Value is a number or lanes of them.
template <int Dim, class Value>
using Vector = std::array<Value, Dim>;

/// Independent components of a symmetric tensor: (xx) in 1D, (xx, yy, zz, xy) in 2D plane strain.
template <int Dim>
inline constexpr int symmetric_components = Dim == 1 ? 1 : 4;

/// Stress or strain increment; shear strain is the tensor component, not the engineering one.
template <int Dim, class Real>
using SymmetricTensor = std::array<Real, symmetric_components<Dim>>;

/// One scalar of every particle, contiguous and aligned for vector instructions.
template <class Real>
using Field = Eigen::Array<Real, Eigen::Dynamic, 1>;

/// Symmetric part of a velocity gradient, given as [component][axis], in plane strain in 2D
/// [Kiriyama15, Eq. 10a].
template <int Dim, class Value>
SymmetricTensor<Dim, Value> symmetric_part(const std::array<Vector<Dim, Value>, Dim>& gradient) {
  if constexpr (Dim == 1) {
    return {gradient[0][0]};
  } else {
    return {gradient[0][0], gradient[1][1], Value(0), (gradient[0][1] + gradient[1][0]) / 2};
  }
}

/// A stress turned anticlockwise by an angle [rad] in the plane; zz stays. Exact for any angle.
template <class Value>
SymmetricTensor<2, Value> rotated(const SymmetricTensor<2, Value>& stress, const Value& angle) {
  using std::cos, std::sin;
  const Value c = cos(angle), s = sin(angle);
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

/// The sum of the products of all components: the power of a stress on a rate of strain, for example.
template <int Dim, class Real>
Real contraction(const SymmetricTensor<Dim, Real>& a, const SymmetricTensor<Dim, Real>& b) {
  if constexpr (Dim == 1) {
    return a[0] * b[0];
  } else {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2 * a[3] * b[3];
  }
}

}  // namespace mpm
