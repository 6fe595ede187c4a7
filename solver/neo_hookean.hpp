#pragma once

#include <array>
#include <cmath>

#include "solver/scene.hpp"
#include "solver/tensor.hpp"

namespace mpm {

/// Compressible neo-Hookean elasticity [Wallstedt08; Kamojjala15]: sigma = [lambda ln J I + mu (F F^T - I)] /
/// J, plane strain in 2D; in 1D lambda = 0 and mu = E/2, so that small strains see Young's modulus.
template <int Dim, class Real>
class NeoHookeanLaw {
 public:
  explicit NeoHookeanLaw(const NeoHookean& material) {
    const double e = material.youngs_modulus, nu = material.poissons_ratio;
    const double lame = Dim == 1 ? 0.0 : e * nu / ((1 + nu) * (1 - 2 * nu));
    const double shear = Dim == 1 ? e / 2 : e / (2 * (1 + nu));
    lame_ = static_cast<Real>(lame);
    shear_ = static_cast<Real>(shear);
    modulus_ = lame + 2 * shear;
  }

  /// Cauchy stress [Pa] of a stretch, which in one dimension is the volume ratio.
  template <class Value>
  SymmetricTensor<1, Value> update(const SymmetricTensor<1, Value>&, const SymmetricTensor<1, Value>&,
                                   const Value& volume_ratio) const requires(Dim == 1) {
    return {shear_ * (volume_ratio - 1 / volume_ratio)};
  }

  /// Cauchy stress [Pa] of a deformation gradient [-], rows one after another, whose determinant is
  /// `volume_ratio`.
  template <class Value>
  SymmetricTensor<2, Value> stress(const std::array<Value, 4>& f, const Value& volume_ratio) const
      requires(Dim == 2) {
    using std::log;
    const Value mean = lame_ * log(volume_ratio), over_volume = 1 / volume_ratio;
    return {(mean + shear_ * (f[0] * f[0] + f[1] * f[1] - 1)) * over_volume,
            (mean + shear_ * (f[2] * f[2] + f[3] * f[3] - 1)) * over_volume, mean * over_volume,
            shear_ * (f[0] * f[2] + f[1] * f[3]) * over_volume};
  }

  /// Modulus of the fastest elastic wave in the undeformed state [Pa].
  double wave_modulus() const { return modulus_; }

 private:
  double modulus_;
  Real lame_, shear_;
};

}  // namespace mpm
