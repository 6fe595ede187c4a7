#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

#include "solver/scene.hpp"
#include "solver/tensor.hpp"

namespace mpm {

/// A stretch of particles [first, last) that belong to one body.
struct ParticleRange {
  Eigen::Index first = 0, last = 0;
};

/// What rounding has cut off the running sums of the particles so far, to be added with the next increment; all empty
/// unless the scene compensates its sums. Units and meaning of each are those of the sum.
template <int Dim, class Real>
struct LowParts {
  std::array<Field<Real>, Dim> position, displacement, velocity;
  std::array<Field<Real>, Dim> half_size;                        ///< of cpGIMP only
  std::array<Field<Real>, symmetric_components<Dim>> stress;     ///< only with a body whose stress is a sum
  std::array<Field<Real>, 1> volume;
  std::array<Field<Real>, Dim * Dim> deformation_gradient;       ///< if the particles have one

  /// Calls `visit(array of fields)` for all of them.
  template <class Self, class Visit>
  static void visit_all(Self& self, Visit&& visit) {
    visit(self.position);
    visit(self.displacement);
    visit(self.velocity);
    visit(self.half_size);
    visit(self.stress);
    visit(self.volume);
    visit(self.deformation_gradient);
  }
};

/// The material points, one contiguous array per scalar, bodies one after another. A particle lives in a
/// slot; slots without one are kept harmless, see `CellBlocks`. Mass is the invariant; density is mass /
/// volume [Kiriyama15, Eqs. 12 and 13].
template <int Dim, class Real>
struct Particles {
  static constexpr std::size_t components = symmetric_components<Dim>;

  std::array<Field<Real>, Dim> position;  ///< [m]
  std::array<Field<Real>, Dim>
      displacement;  ///< [m], summed apart from the position so that small ones keep their digits
  std::array<Field<Real>, Dim> velocity;       ///< [m/s]
  std::array<Field<Real>, Dim> half_size;      ///< [m]; empty for scheme mpm
  std::array<Field<Real>, components> stress;  ///< Cauchy [Pa], tension positive
  std::array<Field<Real>, Dim> pending;  ///< what a later pass of the same step adds, see `TimeStepper`:
                                         ///< travel [m] in MUSL, strain increments [-] in USF with cpGIMP
  std::array<Field<Real>, components>
      strain;  ///< sum of the increments [-]; empty unless the scene asks for it
  std::array<Field<Real>, 1> stress_work;  ///< sum of what the stress did [J per unit of the absent
                                           ///< dimensions]; empty unless asked for
  std::array<Field<Real>, Dim * Dim>
      deformation_gradient;  ///< row by row [-]; empty unless a neo-Hookean body in 2D needs it
  std::array<Field<Real>, Dim>
      external_force;            ///< beside gravity [N]; empty unless the scene has such forces
  LowParts<Dim, Real> low;       ///< of the sums
  Field<Real> mass;              ///< [kg per unit of the absent dimensions]
  Field<Real> volume;            ///< current [m^Dim]
  Field<Real> initial_volume;    ///< [m^Dim]; empty unless a body's law follows the volume
  std::vector<std::int32_t> id;  ///< of the particle in a slot, in the order of filling; -1 in an empty one
  std::vector<std::int32_t> slot_of;  ///< [id]
  std::vector<ParticleRange> bodies;  ///< slots of each body
  std::vector<Real> first_volume;     ///< [body] initial volume of each of its particles [m^Dim]

  Eigen::Index count() const { return static_cast<Eigen::Index>(slot_of.size()); }
  Eigen::Index slots() const { return mass.size(); }

  /// Calls `visit(field, value in an empty slot)` for all fields that the scene has. Positions in empty slots
  /// are for `CellBlocks` to set.
  template <class Visit>
  void for_each_field(Visit&& visit) {
    visit_fields(*this, visit);
  }

  /// Forgets what the sums have lost, for particles that are put into another state.
  void clear_low_parts() {
    LowParts<Dim, Real>::visit_all(low, [](auto& fields) {
      for (auto& field : fields) field.setZero();
    });
  }

  /// Memory of all arrays [B].
  std::int64_t bytes() const {
    std::size_t sum = (id.capacity() + slot_of.capacity()) * sizeof(std::int32_t) +
                      bodies.capacity() * sizeof(ParticleRange) + first_volume.capacity() * sizeof(Real);
    visit_fields(*this, [&](const auto& field, Real) {
      sum += static_cast<std::size_t>(field.size()) * sizeof(Real);
    });
    return static_cast<std::int64_t>(sum);
  }

 private:
  template <class Self, class Visit>
  static void visit_fields(Self& self, Visit&& visit) {
    const auto all_of = [&](auto& fields, Real empty) {
      for (auto& field : fields) {
        if (field.size() > 0) visit(field, empty);
      }
    };
    for (auto* fields :
         {&self.position, &self.displacement, &self.velocity, &self.pending, &self.external_force})
      all_of(*fields, Real(0));
    all_of(self.half_size, self.half_size[0].size() > 0 ? self.half_size[0][0] : Real(0));
    all_of(self.stress, Real(0));
    all_of(self.strain, Real(0));
    all_of(self.stress_work, Real(0));
    LowParts<Dim, Real>::visit_all(self.low, [&](auto& fields) { all_of(fields, Real(0)); });
    for (std::size_t k = 0; k < self.deformation_gradient.size(); ++k) {
      if (self.deformation_gradient[k].size() > 0)
        visit(self.deformation_gradient[k], Real(k % (Dim + 1) == 0));
    }
    visit(self.mass, Real(0));
    visit(self.volume, Real(1));
    if (self.initial_volume.size() > 0) visit(self.initial_volume, Real(1));
  }
};

/// Mass of all particles, summed in double precision in the order of their slots [kg per unit of the absent
/// dimensions].
template <int Dim, class Real>
double total_mass(const Particles<Dim, Real>& particles) {
  return std::accumulate(particles.mass.begin(), particles.mass.end(), 0.0);
}

/// The centers of a body's particles in their order, which is at random in a scene that shuffles them, and the spacing between them along each axis [m].
struct Lattice {
  std::vector<PerAxis> centers;
  PerAxis spacing{};
};
Lattice lattice_of(const Scene& scene, const Body& body);

/// Fills the bodies of a checked scene with particles at their bodies' initial velocities and stresses.
/// `with_domain`: whether the scheme needs half sizes.
template <int Dim, class Real>
Particles<Dim, Real> fill_bodies(const Scene& scene, bool with_domain);

}  // namespace mpm
