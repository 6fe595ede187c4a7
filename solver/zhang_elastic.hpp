#pragma once

#include <cmath>

#include "solver/scene.hpp"
#include "solver/tensor.hpp"

namespace mpm {

/// The one-dimensional law of the published column: stress = 2 E (1 - lambda^(-1/2)) [Zhang], a function of
/// the stretch lambda alone, so no increment is ever lost.
template <class Real>
class ZhangElasticLaw {
 public:
  explicit ZhangElasticLaw(const ZhangElastic& material)
      : modulus_(material.youngs_modulus), twice_modulus_(static_cast<Real>(2 * material.youngs_modulus)) {}

  /// Cauchy stress [Pa] at a stretch equal to `volume_ratio` [-], > 0.
  template <class Value>
  SymmetricTensor<1, Value> update(const SymmetricTensor<1, Value>& /*stress*/,
                                   const SymmetricTensor<1, Value>& /*strain_increment*/,
                                   const Value& volume_ratio) const {
    using std::sqrt;
    return {twice_modulus_ * (1 - 1 / sqrt(volume_ratio))};
  }

  /// Modulus of the elastic wave at lambda = 1 [Pa].
  double wave_modulus() const { return modulus_; }

 private:
  double modulus_;
  Real twice_modulus_;
};

}  // namespace mpm
