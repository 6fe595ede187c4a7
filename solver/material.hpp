#pragma once

#include <variant>

#include "solver/linear_elastic.hpp"
#include "solver/mohr_coulomb.hpp"
#include "solver/neo_hookean.hpp"
#include "solver/particles.hpp"
#include "solver/zhang_elastic.hpp"

namespace mpm {

/// The laws a body can follow in `Dim` dimensions.
template <int Dim, class Real>
struct Laws {
  using Any = std::variant<LinearElasticLaw<Dim, Real>, MohrCoulombLaw<Real>, NeoHookeanLaw<Dim, Real>>;
};
template <class Real>
struct Laws<1, Real> {
  using Any = std::variant<LinearElasticLaw<1, Real>, ZhangElasticLaw<Real>, NeoHookeanLaw<1, Real>>;
};

/// The law of a material. The scene has been checked: a law exists in this dimension.
template <int Dim, class Real>
typename Laws<Dim, Real>::Any law_of(const Material& material) {
  if constexpr (Dim == 1) {
    if (const auto* zhang = std::get_if<ZhangElastic>(&material)) return ZhangElasticLaw<Real>(*zhang);
  } else {
    if (const auto* soil = std::get_if<MohrCoulomb>(&material)) return MohrCoulombLaw<Real>(*soil);
  }
  if (const auto* rubber = std::get_if<NeoHookean>(&material)) return NeoHookeanLaw<Dim, Real>(*rubber);
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

/// Deformation gradient, volume and stress of a neo-Hookean body's particles from their strain increments and
/// rotations: F grows by (I + L dt) F, exact for particles that move with their velocity gradient L.
template <class Real>
void update_stress(const NeoHookeanLaw<2, Real>& law, ParticleRange range, Particles<2, Real>& particles) {
  auto& gradient = particles.deformation_gradient;
  for (Eigen::Index p = range.first; p < range.last; ++p) {
    const Real xx = 1 + particles.strain_increment[0][p], yy = 1 + particles.strain_increment[1][p];
    const Real xy = particles.strain_increment[3][p] - particles.rotation[p];
    const Real yx = particles.strain_increment[3][p] + particles.rotation[p];
    const std::array<Real, 4> old{gradient[0][p], gradient[1][p], gradient[2][p], gradient[3][p]};
    const std::array<Real, 4> f{xx * old[0] + xy * old[2], xx * old[1] + xy * old[3],
                                yx * old[0] + yy * old[2], yx * old[1] + yy * old[3]};
    const Real volume_ratio = f[0] * f[3] - f[1] * f[2];
    for (std::size_t k = 0; k < f.size(); ++k) gradient[k][p] = f[k];
    particles.volume[p] = volume_ratio * particles.initial_volume[p];
    const SymmetricTensor<2, Real> stress = law.stress(f, volume_ratio);
    for (std::size_t c = 0; c < stress.size(); ++c) particles.stress[c][p] = stress[c];
  }
}

}  // namespace mpm
