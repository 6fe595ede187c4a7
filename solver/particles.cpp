#include "solver/particles.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace mpm {
namespace {

bool lies_in(const Ring& ring, const PerAxis& place) {
  const double radius = std::hypot(place[0] - ring.center[0], place[1] - ring.center[1]);
  return radius >= ring.inner_radius && radius <= ring.outer_radius;
}

template <class Fields>
void resize(Fields& fields, Eigen::Index count) {
  for (auto& field : fields) field.setZero(count);
}

/// Stress a body starts with at a place, as (xx, yy, zz, xy); in one dimension only the first entry counts.
SymmetricTensor<2, double> initial_stress_at(const Scene& scene, const Body& body, const PerAxis& place) {
  if (!body.initial_stress) return {};
  if (const auto* uniform = std::get_if<UniformStress>(&*body.initial_stress)) {
    return {uniform->xx, uniform->yy, uniform->zz, uniform->xy};
  }
  const auto& ground = std::get<GeostaticStress>(*body.initial_stress);
  const auto vertical_axis = static_cast<std::size_t>(scene.dimension - 1);
  const double gravity = scene.gravity.acceleration[vertical_axis] * scene.gravity.level;
  const double vertical = body.density * gravity * (ground.surface - place[vertical_axis]);
  if (scene.dimension == 1) return {vertical, 0.0, 0.0, 0.0};
  return {ground.k0 * vertical, vertical, ground.k0 * vertical, 0.0};
}

template <int Dim, class Real>
void place(const Scene& scene, const Body& body, const Lattice& lattice, ParticleRange range,
           Particles<Dim, Real>& particles) {
  double volume = 1.0;
  for (std::size_t axis = 0; axis < Dim; ++axis) volume *= lattice.spacing[axis];
  particles.first_volume.push_back(static_cast<Real>(volume));
  for (Eigen::Index p = range.first; p < range.last; ++p) {
    const PerAxis& center = lattice.centers[static_cast<std::size_t>(p - range.first)];
    for (std::size_t axis = 0; axis < Dim; ++axis) {
      particles.position[axis][p] = static_cast<Real>(center[axis]);
      particles.velocity[axis][p] = static_cast<Real>(body.velocity[axis]);
    }
    const SymmetricTensor<2, double> stress = initial_stress_at(scene, body, center);
    for (std::size_t c = 0; c < particles.stress.size(); ++c) {
      particles.stress[c][p] = static_cast<Real>(stress[c]);
    }
    particles.volume[p] = static_cast<Real>(volume);
    particles.mass[p] = static_cast<Real>(body.inertia.value_or(body.density) * volume);
  }
}

/// Puts elements in any of their orders, all as likely, the same for a seed on every machine: how the standard
/// library shuffles is left to its makers [Knuth69, algorithm P].
template <class Element>
void shuffle(std::uint64_t seed, std::vector<Element>& elements) {
  std::mt19937_64 random(seed);
  for (std::size_t left = elements.size(); left > 1; --left) {
    const std::uint64_t uneven = (0 - left) % left;  // numbers of the generator that are too many for equal shares
    std::uint64_t number = random();
    while (number < uneven) number = random();
    std::swap(elements[left - 1], elements[number % left]);
  }
}

bool has_neo_hookean(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                     [](const Body& body) { return std::holds_alternative<NeoHookean>(body.material); });
}

/// Whether a law wants to know how much of its initial volume a particle has.
bool has_law_of_volume(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) {
    return std::holds_alternative<NeoHookean>(body.material) ||
           std::holds_alternative<ZhangElastic>(body.material);
  });
}

/// Gives the low parts of sums their length, after all other fields have theirs.
template <int Dim, class Real>
void reserve_low_parts(const Scene& scene, Eigen::Index total, Particles<Dim, Real>& particles) {
  LowParts<Dim, Real>& low = particles.low;
  resize(low.position, total);
  resize(low.displacement, total);
  resize(low.velocity, total);
  resize(low.half_size, scene.scheme == Scheme::cpgimp ? total : 0);
  const bool sums_stress = std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) {
    return std::holds_alternative<LinearElastic>(body.material);
  });
  resize(low.stress, sums_stress ? total : 0);
  resize(low.volume, total);
  resize(low.deformation_gradient, particles.deformation_gradient[0].size());
}

/// Gives the fields that only some scenes need their length.
template <int Dim, class Real>
void reserve_optional_fields(const Scene& scene, Eigen::Index total, Particles<Dim, Real>& particles) {
  const bool deforms = Dim == 2 && has_neo_hookean(scene);
  resize(particles.deformation_gradient, deforms ? total : 0);
  if (deforms) {
    for (std::size_t axis = 0; axis < Dim; ++axis) particles.deformation_gradient[axis * (Dim + 1)].setOnes();
  }
  resize(particles.strain, scene.sums_strain ? total : 0);
  resize(particles.stress_work, scene.sums_work ? total : 0);
  const bool has_forces = scene.driven_motion || !scene.surface_loads.empty() ||
                          std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                      [](const Body& body) { return body.inertia.has_value(); });
  resize(particles.external_force, has_forces ? total : 0);
  const bool grows_late = scene.update_order == UpdateOrder::usf && scene.scheme == Scheme::cpgimp;
  resize(particles.pending, scene.update_order == UpdateOrder::musl || grows_late ? total : 0);
  if (scene.compensated_sums) reserve_low_parts(scene, total, particles);
}

}  // namespace

Lattice lattice_of(const Scene& scene, const Body& body) {
  Lattice lattice;
  std::array<std::int64_t, max_dimension> count{1, 1};
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimension); ++axis) {
    lattice.spacing[axis] = scene.cell_size / body.particles_per_cell[axis];
    count[axis] = std::llround((body.upper[axis] - body.lower[axis]) / lattice.spacing[axis]);
  }
  for (std::int64_t k = 0; k < count[0] * count[1]; ++k) {
    const std::array<std::int64_t, max_dimension> index{k % count[0], k / count[0]};
    PerAxis center{};
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimension); ++axis) {
      center[axis] = body.lower[axis] + (static_cast<double>(index[axis]) + 0.5) * lattice.spacing[axis];
    }
    if (!body.ring || lies_in(*body.ring, center)) lattice.centers.push_back(center);
  }
  if (scene.shuffle) shuffle(*scene.shuffle, lattice.centers);
  return lattice;
}

template <int Dim, class Real>
Particles<Dim, Real> fill_bodies(const Scene& scene, bool with_domain) {
  Particles<Dim, Real> particles;
  std::vector<Lattice> lattices;
  Eigen::Index total = 0;
  for (const Body& body : scene.bodies) {
    lattices.push_back(lattice_of(scene, body));
    particles.bodies.push_back({total, total + static_cast<Eigen::Index>(lattices.back().centers.size())});
    total = particles.bodies.back().last;
  }
  resize(particles.position, total);
  resize(particles.displacement, total);
  resize(particles.velocity, total);
  resize(particles.half_size, with_domain ? total : 0);
  resize(particles.stress, total);
  particles.mass.setZero(total);
  particles.volume.setZero(total);
  reserve_optional_fields(scene, total, particles);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const ParticleRange range = particles.bodies[b];
    place(scene, scene.bodies[b], lattices[b], range, particles);
    for (std::size_t axis = 0; with_domain && axis < Dim; ++axis) {
      particles.half_size[axis].segment(range.first, range.last - range.first) =
          static_cast<Real>(lattices[b].spacing[axis] / 2);
    }
  }
  if (has_law_of_volume(scene)) particles.initial_volume = particles.volume;
  particles.id.resize(static_cast<std::size_t>(total));
  std::iota(particles.id.begin(), particles.id.end(), 0);
  particles.slot_of.resize(static_cast<std::size_t>(total));
  std::iota(particles.slot_of.begin(), particles.slot_of.end(), 0);
  return particles;
}

template Particles<1, double> fill_bodies<1, double>(const Scene&, bool);
template Particles<1, float> fill_bodies<1, float>(const Scene&, bool);
template Particles<2, double> fill_bodies<2, double>(const Scene&, bool);
template Particles<2, float> fill_bodies<2, float>(const Scene&, bool);

}  // namespace mpm
