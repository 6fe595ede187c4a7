#pragma once

#include <algorithm>

#include "solver/scene.hpp"
#include "solver/tensor.hpp"

namespace mpm {

/// Isotropic linear elasticity in rate form [Kiriyama15, Eq. 11]: uniaxial stress in 1D, plane strain in 2D.
/// In 1D the sum of the increments is Hencky's law, stress = E ln(lambda), to first order in the increment.
template <int Dim, class Real>
class LinearElasticLaw {
 public:
  explicit LinearElasticLaw(const LinearElastic& material) {
    const double e = material.youngs_modulus, nu = material.poissons_ratio;
    modulus_ = Dim == 1 ? e : e * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
    lame_ = static_cast<Real>(Dim == 1 ? 0.0 : e * nu / ((1 + nu) * (1 - 2 * nu)));
    twice_shear_ = static_cast<Real>(Dim == 1 ? e : e / (1 + nu));
  }

  /// Cauchy stress [Pa] after a strain increment [-].
  template <class Value>
  SymmetricTensor<Dim, Value> update(SymmetricTensor<Dim, Value> stress,
                                     const SymmetricTensor<Dim, Value>& strain_increment,
                                     const Value& /*volume_ratio*/) const {
    const Value mean = lame_ * trace<Dim, Value>(strain_increment);
    for (std::size_t c = 0; c < stress.size(); ++c) stress[c] += twice_shear_ * strain_increment[c];
    for (std::size_t c = 0; c < std::min<std::size_t>(3, stress.size()); ++c) stress[c] += mean;
    return stress;
  }

  /// Modulus of the fastest elastic wave [Pa].
  double wave_modulus() const { return modulus_; }

 private:
  double modulus_;
  Real lame_, twice_shear_;
};

}  // namespace mpm
