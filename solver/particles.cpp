#include "solver/particles.hpp"

#include <cmath>

namespace mpm {
namespace {

/// Particles of a body along each axis, and their spacing [m].
struct Lattice {
  std::array<std::int64_t, max_dimension> count{1, 1};
  PerAxis spacing{};
  std::int64_t total = 1;
};

Lattice lattice_of(const Scene& scene, const Body& body) {
  Lattice lattice;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimension); ++axis) {
    lattice.spacing[axis] = scene.cell_size / body.particles_per_cell[axis];
    lattice.count[axis] = std::llround((body.upper[axis] - body.lower[axis]) / lattice.spacing[axis]);
    lattice.total *= lattice.count[axis];
  }
  return lattice;
}

template <class Fields>
void resize(Fields& fields, Eigen::Index count) {
  for (auto& field : fields) field.setZero(count);
}

template <int Dim, class Real>
void place(const Body& body, const Lattice& lattice, ParticleRange range, Particles<Dim, Real>& particles) {
  double volume = 1.0;
  for (std::size_t axis = 0; axis < Dim; ++axis) volume *= lattice.spacing[axis];
  for (Eigen::Index p = range.first; p < range.last; ++p) {
    const std::int64_t k = p - range.first;
    const std::array<std::int64_t, max_dimension> index{k % lattice.count[0], k / lattice.count[0]};
    for (std::size_t axis = 0; axis < Dim; ++axis) {
      const double cells = static_cast<double>(index[axis]) + 0.5;
      particles.position[axis][p] = static_cast<Real>(body.lower[axis] + cells * lattice.spacing[axis]);
      particles.velocity[axis][p] = static_cast<Real>(body.velocity[axis]);
    }
    particles.volume[p] = static_cast<Real>(volume);
    particles.mass[p] = static_cast<Real>(body.density * volume);
  }
}

}  // namespace

template <int Dim, class Real>
Particles<Dim, Real> fill_bodies(const Scene& scene, bool with_domain) {
  Particles<Dim, Real> particles;
  std::vector<Lattice> lattices;
  Eigen::Index total = 0;
  for (const Body& body : scene.bodies) {
    lattices.push_back(lattice_of(scene, body));
    particles.bodies.push_back({total, total + lattices.back().total});
    total = particles.bodies.back().last;
  }
  resize(particles.position, total);
  resize(particles.displacement, total);
  resize(particles.velocity, total);
  resize(particles.half_size, with_domain ? total : 0);
  resize(particles.stress, total);
  resize(particles.strain_increment, total);
  particles.rotation.setZero(scene.objectivity == Objectivity::jaumann ? total : 0);
  particles.mass.setZero(total);
  particles.volume.setZero(total);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const ParticleRange range = particles.bodies[b];
    place(scene.bodies[b], lattices[b], range, particles);
    for (std::size_t axis = 0; with_domain && axis < Dim; ++axis) {
      particles.half_size[axis].segment(range.first, range.last - range.first) =
          static_cast<Real>(lattices[b].spacing[axis] / 2);
    }
  }
  particles.initial_volume = particles.volume;
  return particles;
}

template Particles<1, double> fill_bodies<1, double>(const Scene&, bool);
template Particles<1, float> fill_bodies<1, float>(const Scene&, bool);
template Particles<2, double> fill_bodies<2, double>(const Scene&, bool);
template Particles<2, float> fill_bodies<2, float>(const Scene&, bool);

}  // namespace mpm
