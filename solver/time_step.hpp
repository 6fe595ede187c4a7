#pragma once

#include "solver/grid_motion.hpp"
#include "solver/loading.hpp"
#include "solver/material.hpp"
#include "solver/rigid_bodies.hpp"
#include "solver/transfer.hpp"

namespace mpm {

/// Particles, grid and what moves them: one explicit step of the Material Point Method [Kiriyama15, Eqs. 1 to
/// 14].
template <int Dim, class Real, Scheme scheme>
class TimeStepper {
 public:
  TimeStepper(const Scene& scene, double time_step)
      : particles_(fill_bodies<Dim, Real>(scene, SchemeTraits<scheme>::has_domain)),
        grid_(scene),
        edges_(scene, grid_),
        rigid_bodies_(scene, grid_, time_step),
        loading_(scene, time_step, particles_),
        transfer_(particles_),
        order_(scene.update_order),
        time_step_(static_cast<Real>(time_step)),
        flip_(static_cast<Real>(scene.flip_fraction)),
        damping_(static_cast<Real>(scene.damping)),
        turns_stress_(scene.objectivity == Objectivity::jaumann),
        empty_mass_(empty_node_mass_ratio<Real> *
                    static_cast<Real>(total_mass(particles_) / static_cast<double>(particles_.count()))) {
    for (const Body& body : scene.bodies) laws_.push_back(law_of<Dim, Real>(body.material));
  }

  /// One step from `time` [s] on, under the gravity of its end. False if a particle has left what the method
  /// can represent.
  bool advance(double time, const Vector<Dim, Real>& gravity) {
    if (!transfer_.weigh(particles_, grid_)) return false;
    loading_.set_masses(time, particles_);
    rigid_bodies_.hold(time);
    grid_.clear();
    if (order_ == UpdateOrder::usf) {
      transfer_.scatter_mass_and_momentum(particles_, grid_);
      update_stress_from_momentum();
      transfer_.scatter_internal_force(particles_, grid_);
    } else {
      transfer_.scatter_all(particles_, grid_);
    }
    if (loading_.has_forces()) {
      loading_.set_forces(time, particles_);
      transfer_.scatter_external_force(particles_, grid_);
    }
    move_grid(gravity);
    transfer_.gather_motion(grid_, time_step_, flip_, particles_);
    if (order_ == UpdateOrder::musl) {
      transfer_.scatter_momentum(particles_, grid_);
      update_stress_from_momentum();
    }
    if (order_ == UpdateOrder::usl) update_stress_from_velocity();
    return true;
  }

  const Particles<Dim, Real>& particles() const { return particles_; }
  const Grid<Dim, Real>& grid() const { return grid_; }
  const Transfer<Dim, Real, scheme>& transfer() const { return transfer_; }
  const RigidBodies<Dim, Real>& rigid_bodies() const { return rigid_bodies_; }
  /// Of the last step [N]; see Transfer::unbalanced_force.
  double unbalanced_force() const { return transfer_.unbalanced_force(particles_, grid_, empty_mass_); }
  typename Transfer<Dim, Real, scheme>::Fault find_fault() const {
    return transfer_.find_fault(particles_, grid_);
  }

 private:
  void move_grid(const Vector<Dim, Real>& gravity) {
    add_gravity<Dim, Real>(grid_, gravity);
    edges_.apply(grid_);
    if (damping_ > 0) {
      accelerate<true>(grid_, time_step_, damping_, empty_mass_);
    } else {
      accelerate<false>(grid_, time_step_, damping_, empty_mass_);
    }
    rigid_bodies_.accelerate(grid_, empty_mass_);
  }

  void update_stress_from_momentum() {
    edges_.apply(grid_);
    set_velocity(grid_, empty_mass_);
    rigid_bodies_.set_velocity(grid_);
    update_stress_from_velocity();
  }

  void update_stress_from_velocity() {
    transfer_.gather_strain(grid_, time_step_, particles_);
    if constexpr (Dim == 2) {
      if (particles_.rotation.size() > 0) {
        transfer_.gather_rotation(grid_, time_step_, particles_);
        if (turns_stress_) rotate_stress(particles_);
      }
    }
    sum_strain();
    for (std::size_t b = 0; b < laws_.size(); ++b) {
      std::visit([&](const auto& law) { update_stress(law, particles_.bodies[b], particles_); }, laws_[b]);
    }
  }

  void sum_strain() {
    for (std::size_t c = 0; c < particles_.strain.size(); ++c) {
      if (particles_.strain[c].size() > 0) particles_.strain[c] += particles_.strain_increment[c];
    }
  }

  Particles<Dim, Real> particles_;
  Grid<Dim, Real> grid_;
  EdgeConditions<Dim, Real> edges_;
  RigidBodies<Dim, Real> rigid_bodies_;
  Loading<Dim, Real> loading_;
  Transfer<Dim, Real, scheme> transfer_;
  std::vector<typename Laws<Dim, Real>::Any> laws_;
  UpdateOrder order_;
  Real time_step_, flip_, damping_;
  bool turns_stress_;
  Real empty_mass_;
};

}  // namespace mpm
