#pragma once

#include <variant>

#include "solver/linear_elastic.hpp"
#include "solver/mohr_coulomb.hpp"
#include "solver/particles.hpp"
#include "solver/zhang_elastic.hpp"

namespace mpm {

/// The laws a body can follow in `Dim` dimensions.
template <int Dim, class Real>
struct Laws {
  using Any = std::variant<LinearElasticLaw<Dim, Real>, MohrCoulombLaw<Real>>;
};
template <class Real>
struct Laws<1, Real> {
  using Any = std::variant<LinearElasticLaw<1, Real>, ZhangElasticLaw<Real>>;
};

/// The law of a material. The scene has been checked: a law exists in this dimension.
template <int Dim, class Real>
typename Laws<Dim, Real>::Any law_of(const Material& material) {
  if constexpr (Dim == 1) {
    if (const auto* zhang = std::get_if<ZhangElastic>(&material)) return ZhangElasticLaw<Real>(*zhang);
  } else {
    if (const auto* soil = std::get_if<MohrCoulomb>(&material)) return MohrCoulombLaw<Real>(*soil);
  }
  return LinearElasticLaw<Dim, Real>(std::get<LinearElastic>(material));
}

/// Turns the stress of all particles by the step's rotation: the Jaumann rate, integrated exactly for a
/// constant spin.
template <class Real>
void rotate_stress(Particles<2, Real>& particles) {
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    SymmetricTensor<2, Real> stress;
    for (std::size_t c = 0; c < stress.size(); ++c) stress[c] = particles.stress[c][p];
    stress = rotated(stress, particles.rotation[p]);
    for (std::size_t c = 0; c < stress.size(); ++c) particles.stress[c][p] = stress[c];
  }
}

/// Volume, then stress of a body's particles from their strain increments [Kiriyama15, Eqs. 11 and 12].
template <int Dim, class Real, class Law>
void update_stress(const Law& law, ParticleRange range, Particles<Dim, Real>& particles) {
  constexpr std::size_t components = Particles<Dim, Real>::components;
  for (Eigen::Index p = range.first; p < range.last; ++p) {
    SymmetricTensor<Dim, Real> stress, increment;
    for (std::size_t c = 0; c < components; ++c) {
      stress[c] = particles.stress[c][p];
      increment[c] = particles.strain_increment[c][p];
    }
    particles.volume[p] *= 1 + trace<Dim, Real>(increment);
    stress = law.update(stress, increment, particles.volume[p] / particles.initial_volume[p]);
    for (std::size_t c = 0; c < components; ++c) particles.stress[c][p] = stress[c];
  }
}

}  // namespace mpm
