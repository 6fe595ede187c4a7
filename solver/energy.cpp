#include "solver/energy.hpp"

#include <cmath>

namespace mpm {
namespace {

/// Energy of particle `p` [J per unit of the absent dimensions]: 1/2 stress : compliance : stress.
double energy_of(const LinearElastic& law, const ParticleFields& fields, std::size_t p) {
  if (fields.dimension == 1) {
    return 0.5 * fields.stress[p] * fields.stress[p] / law.youngs_modulus * fields.volume[p];
  }
  const double* stress = &fields.stress[4 * p];
  const double trace = stress[0] + stress[1] + stress[2];
  const double square =
      stress[0] * stress[0] + stress[1] * stress[1] + stress[2] * stress[2] + 2 * stress[3] * stress[3];
  const double nu = law.poissons_ratio;
  return 0.5 * ((1 + nu) * square - nu * trace * trace) / law.youngs_modulus * fields.volume[p];
}

/// lambda/2 (ln J)^2 - mu ln J + mu/2 (tr F^T F - dimension), J = det F, per initial volume; in one dimension
/// lambda is 0 and mu is E/2.
double energy_of(const NeoHookean& law, const ParticleFields& fields, std::size_t p) {
  if (fields.dimension == 1) {
    const double stretch = fields.volume[p] / fields.initial_volume[p], mu = law.youngs_modulus / 2;
    return (0.5 * mu * (stretch * stretch - 1) - mu * std::log(stretch)) * fields.initial_volume[p];
  }
  const double nu = law.poissons_ratio, mu = law.youngs_modulus / (2 * (1 + nu));
  const double lambda = 2 * mu * nu / (1 - 2 * nu);
  const double* f = &fields.deformation_gradient[4 * p];
  const double log_j = std::log(f[0] * f[3] - f[1] * f[2]);
  const double squares = f[0] * f[0] + f[1] * f[1] + f[2] * f[2] + f[3] * f[3];
  return (0.5 * lambda * log_j * log_j - mu * log_j + 0.5 * mu * (squares - 2)) * fields.initial_volume[p];
}

/// Of the elastic part of the strain, which alone stores energy.
double energy_of(const MohrCoulomb& law, const ParticleFields& fields, std::size_t p) {
  return energy_of(LinearElastic{law.youngs_modulus, law.poissons_ratio}, fields, p);
}

/// The work of the stress 2 E (1 - lambda^(-1/2)) from the unstrained length on.
double energy_of(const ZhangElastic& law, const ParticleFields& fields, std::size_t p) {
  const double root = std::sqrt(fields.volume[p] / fields.initial_volume[p]);
  return 2 * law.youngs_modulus * (root - 1) * (root - 1) * fields.initial_volume[p];
}

}  // namespace

double kinetic_energy(const ParticleFields& fields) {
  const auto dimension = static_cast<std::size_t>(fields.dimension);
  double sum = 0.0;
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    for (std::size_t axis = 0; axis < dimension; ++axis) {
      const double velocity = fields.velocity[p * dimension + axis];
      sum += 0.5 * fields.mass[p] * velocity * velocity;
    }
  }
  return sum;
}

double strain_energy(const Scene& scene, const ParticleFields& fields) {
  double sum = 0.0;
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    sum += std::visit([&](const auto& law) { return energy_of(law, fields, p); },
                      scene.bodies[fields.body[p]].material);
  }
  return sum;
}

}  // namespace mpm
