#pragma once

#include <algorithm>
#include <vector>

#include "solver/particles.hpp"

namespace mpm {

/// What acts on particles beside gravity: tractions on edges, the body force of a driven motion, and masses
/// that change; and what gravity does to bodies whose inertia is not their weight's.
template <int Dim, class Real>
class Loading {
 public:
  /// Gives the particles, in the order of their filling, the initial velocities of a driven motion.
  Loading(const Scene& scene, double time_step, Particles<Dim, Real>& particles) : scene_(scene) {
    has_inertia_ = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                               [](const Body& body) { return body.inertia.has_value(); });
    for (const SurfaceLoad& load : scene.surface_loads) find_row(load, particles);
    if (!scene.driven_motion) return;
    for (const Body& body : scene.bodies) {
      const Lattice lattice = lattice_of(scene, body);
      start_.insert(start_.end(), lattice.centers.begin(), lattice.centers.end());
    }
    for (std::size_t p = 0; p < start_.size(); ++p) {
      const PerAxis velocity = scene.driven_motion->velocity(start_[p], -time_step / 2);
      const Eigen::Index slot = particles.slot_of[p];
      for (std::size_t a = 0; a < Dim; ++a) particles.velocity[a][slot] = static_cast<Real>(velocity[a]);
    }
  }

  /// Whether there is any external force to scatter.
  bool has_forces() const { return scene_.driven_motion || !rows_.empty() || has_inertia_; }

  /// Memory of the rows that carry loads, and of the places a driven motion starts from [B].
  std::int64_t bytes() const {
    std::size_t sum = start_.capacity() * sizeof(PerAxis);
    for (const Row& row : rows_) sum += row.particles.capacity() * sizeof(row.particles[0]);
    return static_cast<std::int64_t>(sum);
  }

  /// Sets the external forces acting at `time` [s] under `gravity` [m/s^2].
  void set_forces(double time, const Vector<Dim, Real>& gravity, Particles<Dim, Real>& particles) const {
    if (scene_.driven_motion) {
      for (std::size_t p = 0; p < start_.size(); ++p) {
        const PerAxis force = scene_.driven_motion->body_force(start_[p], time);
        const Eigen::Index slot = particles.slot_of[p];
        for (std::size_t a = 0; a < Dim; ++a) {
          particles.external_force[a][slot] = particles.mass[slot] * static_cast<Real>(force[a]);
        }
      }
    } else {
      for (Field<Real>& component : particles.external_force) component.setZero();
    }
    for (const Row& row : rows_) {
      const double fraction = row.ramp > 0 ? std::min(time / row.ramp, 1.0) : 1.0;
      for (const std::size_t p : row.particles) {
        const Eigen::Index slot = particles.slot_of[p];
        for (std::size_t a = 0; a < Dim; ++a) {
          particles.external_force[a][slot] += static_cast<Real>(fraction * row.force[a]);
        }
      }
    }
    if (has_inertia_) make_up_weights(time, gravity, particles);
  }

  /// Sets the masses of bodies whose density changes to those at `time` [s].
  void set_masses(double time, Particles<Dim, Real>& particles) const {
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      const Body& body = scene_.bodies[b];
      if (!body.density_ramp || body.inertia || time < body.density_ramp->start) continue;
      const auto density = static_cast<Real>(body.density_at(time));
      const ParticleRange range = particles.bodies[b];
      for (Eigen::Index slot = range.first; slot < range.last; ++slot) {
        if (particles.id[static_cast<std::size_t>(slot)] < 0) continue;
        particles.mass[slot] = density * particles.first_volume[b];
      }
    }
  }

 private:
  /// Particles that carry a surface load, and the force on each once it acts in full [N].
  struct Row {
    std::vector<std::size_t> particles;
    PerAxis force{};
    double ramp = 0.0;
  };

  /// Gravity acts on the mass of nodes, which is that of inertia: what the weight is more (or less) is a force.
  void make_up_weights(double time, const Vector<Dim, Real>& gravity, Particles<Dim, Real>& particles) const {
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      const Body& body = scene_.bodies[b];
      if (!body.inertia) continue;
      const auto missing = static_cast<Real>(body.density_at(time) / *body.inertia - 1);
      const ParticleRange range = particles.bodies[b];
      const Eigen::Index count = range.last - range.first;
      for (std::size_t a = 0; a < Dim; ++a) {
        particles.external_force[a].segment(range.first, count) +=
            missing * gravity[a] * particles.mass.segment(range.first, count);
      }
    }
  }

  void find_row(const SurfaceLoad& load, const Particles<Dim, Real>& particles) {
    const auto body = static_cast<std::size_t>(
        std::find_if(scene_.bodies.begin(), scene_.bodies.end(),
                     [&](const Body& candidate) { return candidate.name == load.body; }) -
        scene_.bodies.begin());
    const Lattice lattice = lattice_of(scene_, scene_.bodies[body]);
    Row row{rows_of(load, scene_.bodies[body], lattice), load.traction, load.ramp};
    for (std::size_t& p : row.particles) p += static_cast<std::size_t>(particles.bodies[body].first);
    const double area = Dim == 1 ? 1.0 : lattice.spacing[static_cast<std::size_t>(1 - load.axis)];
    for (double& component : row.force) component *= area;
    rows_.push_back(std::move(row));
  }

  /// Indices within the body.
  static std::vector<std::size_t> rows_of(const SurfaceLoad& load, const Body& body, const Lattice& lattice) {
    const auto normal = static_cast<std::size_t>(load.axis), along = 1 - normal;
    const double edge = load.side == 0 ? body.lower[normal] : body.upper[normal];
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < lattice.centers.size(); ++k) {
      const PerAxis& center = lattice.centers[k];
      if (std::abs(center[normal] - edge) > lattice.spacing[normal]) continue;
      if (Dim == 2 && (center[along] < load.begin || center[along] > load.end)) continue;
      found.push_back(k);
    }
    return found;
  }

  const Scene scene_;
  bool has_inertia_ = false;
  std::vector<Row> rows_;
  std::vector<PerAxis> start_;  ///< initial places, of a driven motion only
};

}  // namespace mpm
