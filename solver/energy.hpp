#pragma once

#include "solver/simulation.hpp"

namespace mpm {

/// Energy of motion of all particles [J per unit of the absent dimensions].
double kinetic_energy(const ParticleFields& fields);

/// Energy stored in the strain of all particles [J per unit of the absent dimensions]. Of a linear elastic
/// or Mohr–Coulomb body 1/2 stress : compliance : stress times the current volume, which is exact for small
/// strain only; of the hyperelastic laws the potential of the law times the initial volume.
double strain_energy(const Scene& scene, const ParticleFields& fields);

}  // namespace mpm
