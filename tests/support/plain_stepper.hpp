#pragma once

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <variant>
#include <vector>

#include "solver/grid_motion.hpp"
#include "solver/loading.hpp"
#include "solver/material.hpp"
#include "solver/particles.hpp"
#include "solver/rigid_bodies.hpp"
#include "solver/simulation.hpp"
#include "tests/support/plain_stencil.hpp"

namespace mpm::test {

/// The step of `TimeStepper` once more, written to be seen to be right: particles in the order of their
/// filling, each on its own, loops over all nodes of the grid, one thread. It shares with the solver the
/// filling of bodies, loads, edge conditions, rigid bodies and the scalar laws, but none of the loops.
///
/// Weights are those of the step's start throughout the step: places and half sizes change at its end.
template <int Dim, class Real, Scheme scheme>
class PlainStepper {
 public:
  static constexpr std::size_t components = Particles<Dim, Real>::components;

  /// Where a run has to end.
  struct Fault {
    Ending ending;
    std::int64_t step, particle;
  };

  /// With `disturbance` other than 0, velocities, stresses, places and weights are changed by random
  /// round-off in every step: what then becomes of the run is as good as what becomes of it without.
  PlainStepper(Scene scene, double time_step, std::uint64_t disturbance = 0)
      : corner_(scene.grid_lower),
        scene_(scene = from_grid_corner(scene)),
        particles_(fill_bodies<Dim, Real>(scene, SchemeTraits<scheme>::has_domain)),
        grid_(scene),
        edges_(scene, grid_),
        rigid_bodies_(scene, grid_, time_step),
        loading_(scene, time_step, particles_),
        seconds_(time_step),
        time_step_(static_cast<Real>(time_step)),
        empty_mass_(SchemeTraits<scheme>::Shape::template empty_share<Real> * static_cast<Real>(least_mass(scene, particles_))),
        start_(particles_.position),
        travel_(static_cast<std::size_t>(particles_.count())),
        growth_(travel_.size()),
        strain_(travel_.size()),
        is_disturbed_(disturbance != 0),
        random_(disturbance) {}

  /// One step; false, and nothing done, if a particle is in a state that has none.
  bool advance() {
    for (Eigen::Index p = 0; p < particles_.count(); ++p) {
      if (!place_fault_of(p)) continue;
      note_first_fault();
      return false;
    }
    if (is_disturbed_) disturb();
    const double time = static_cast<double>(steps_) * seconds_;
    loading_.set_masses(time, particles_);
    loading_.set_forces(time, gravity(), particles_);
    rigid_bodies_.hold(time);
    find_nodes();
    step();
    ++steps_;
    return true;
  }

  const std::optional<Fault>& fault() const { return fault_; }
  std::int64_t cell_crossings() const { return cell_crossings_; }
  const std::vector<PerAxis>& impulses() const { return rigid_bodies_.impulses(); }

  ParticleFields fields() const {
    ParticleFields fields;
    fields.dimension = Dim;
    fields.initial_position = from_origin(interleaved(start_));
    fields.displacement = interleaved(particles_.displacement);
    fields.position = from_origin(interleaved(particles_.position));
    fields.velocity = interleaved(particles_.velocity);
    fields.half_size = interleaved(particles_.half_size);
    fields.stress = interleaved(particles_.stress);
    fields.volume = interleaved(std::array{particles_.volume});
    fields.initial_volume = interleaved(std::array{particles_.initial_volume});
    fields.mass = interleaved(std::array{particles_.mass});
    if (scene_.sums_strain) fields.strain = interleaved(particles_.strain);
    if (scene_.sums_work) fields.stress_work = interleaved(particles_.stress_work);
    if (particles_.deformation_gradient[0].size() > 0)
      fields.deformation_gradient = interleaved(particles_.deformation_gradient);
    for (std::size_t b = 0; b < particles_.bodies.size(); ++b) {
      const ParticleRange range = particles_.bodies[b];
      fields.body.insert(fields.body.end(), static_cast<std::size_t>(range.last - range.first), b);
    }
    return fields;
  }

 private:
  static double least_mass(const Scene& scene, const Particles<Dim, Real>& particles) {
    std::vector<double> masses;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b)
      masses.push_back(scene.bodies[b].lightest() * static_cast<double>(particles.first_volume[b]));
    return *std::min_element(masses.begin(), masses.end());
  }

  void step() {
    grid_.clear({0, grid_.rows()});
    switch (scene_.update_order) {
      case UpdateOrder::usl:
        send_mass();
        send_momentum();
        send_forces();
        move_grid();
        find_strains();
        if (scene_.light_nodes) slow_light_nodes();
        accelerate_particles();
        update_stresses();
        break;
      case UpdateOrder::usf:
        send_mass();
        send_momentum();
        find_velocities();
        find_strains();
        update_stresses();
        send_forces();
        move_grid();
        accelerate_particles();
        break;
      case UpdateOrder::musl:
        send_mass();
        send_momentum();
        send_forces();
        move_grid();
        accelerate_particles();
        grid_.clear_momentum({0, grid_.rows()});
        send_momentum();
        find_velocities();
        find_strains();
        update_stresses();
        break;
    }
    move_particles();
  }

  // --- particles to grid
  // ------------------------------------------------------------------------------------

  void send_mass() {
    for_each_particle([&](Eigen::Index p, const Nodes& nodes) {
      for (const auto& seen : nodes) grid_.mass[seen.node] += seen.weight * particles_.mass[p];
    });
  }

  void send_momentum() {
    for_each_particle([&](Eigen::Index p, const Nodes& nodes) {
      for (const auto& seen : nodes) {
        for (std::size_t a = 0; a < Dim; ++a)
          grid_.momentum[a][seen.node] += seen.weight * particles_.mass[p] * particles_.velocity[a][p];
      }
    });
  }

  void send_forces() {
    const auto own = [&](Eigen::Index p) {
      if constexpr (Dim == 1) return Real(0);
      return (stress(p, 0, 0) + stress(p, Dim - 1, Dim - 1)) / 2;
    };
    const std::vector<Real> mean = averaged_over_cells(own);
    for_each_particle([&](Eigen::Index p, const Nodes& nodes) {
      const Real change = mean[static_cast<std::size_t>(p)] - own(p);
      for (const auto& seen : nodes) {
        for (std::size_t a = 0; a < Dim; ++a) {
          Real force(0);
          for (std::size_t b = 0; b < Dim; ++b)
            force -=
                particles_.volume[p] * (stress(p, a, b) + (a == b ? change : Real(0))) * seen.gradient[b];
          if (loading_.has_forces()) force += seen.weight * particles_.external_force[a][p];
          grid_.force[a][seen.node] += force;
        }
      }
    });
  }

  Real stress(Eigen::Index p, std::size_t a, std::size_t b) const {
    return particles_.stress[a == b ? a : 3][p];
  }

  // --- grid
  // -------------------------------------------------------------------------------------------------

  void find_velocities() {
    edges_.apply(grid_, {0, grid_.rows()});
    for (Eigen::Index i = 0; i < grid_.mass.size(); ++i) {
      for (std::size_t a = 0; a < Dim; ++a)
        grid_.velocity[a][i] = grid_.mass[i] > empty_mass_ ? grid_.momentum[a][i] / grid_.mass[i] : Real(0);
    }
    rigid_bodies_.set_motion(grid_, empty_mass_);
  }

  /// At the end of the step [m/s^2].
  Vector<Dim, Real> gravity() const {
    const double level =
        scene_.gravity.level * scene_.gravity.fraction(static_cast<double>(steps_ + 1) * seconds_);
    Vector<Dim, Real> acceleration;
    for (std::size_t a = 0; a < Dim; ++a)
      acceleration[a] = static_cast<Real>(level * scene_.gravity.acceleration[a]);
    return acceleration;
  }

  void move_grid() {
    const Vector<Dim, Real> acceleration = gravity();
    for (std::size_t a = 0; a < Dim; ++a) grid_.force[a] += acceleration[a] * grid_.mass;
    edges_.apply(grid_, {0, grid_.rows()});
    rigid_bodies_.take_up(grid_, empty_mass_);
    for (Eigen::Index i = 0; i < grid_.mass.size(); ++i) {
      for (std::size_t a = 0; a < Dim; ++a) accelerate_node(i, a);
    }
    rigid_bodies_.set_motion(grid_, empty_mass_);
  }

  void accelerate_node(Eigen::Index i, std::size_t a) {
    grid_.acceleration[a][i] = grid_.velocity[a][i] = Real(0);
    if (!(grid_.mass[i] > empty_mass_)) return;
    const Real velocity = grid_.momentum[a][i] / grid_.mass[i];
    Real force = grid_.force[a][i];
    const Real undamped = velocity + time_step_ * force / grid_.mass[i];
    const Real taken = static_cast<Real>(scene_.damping) * std::abs(force);
    if (undamped > 0) force -= taken;
    if (undamped < 0) force += taken;
    grid_.acceleration[a][i] = force / grid_.mass[i];
    grid_.velocity[a][i] = velocity + time_step_ * grid_.acceleration[a][i];
  }

  // --- grid to particles
  // ------------------------------------------------------------------------------------

  void accelerate_particles() {
    const auto flip = static_cast<Real>(scene_.flip_fraction);
    for_each_particle([&](Eigen::Index p, const Nodes& nodes) {
      for (std::size_t a = 0; a < Dim; ++a) {
        Real velocity(0), acceleration(0);
        for (const auto& seen : nodes) {
          velocity += seen.weight * grid_.velocity[a][seen.node];
          acceleration += seen.weight * grid_.acceleration[a][seen.node];
        }
        const Real flip_velocity = particles_.velocity[a][p] + time_step_ * acceleration;
        particles_.velocity[a][p] = flip * flip_velocity + (1 - flip) * velocity;
        travel_[static_cast<std::size_t>(p)][a] = time_step_ * velocity;
      }
    });
  }

  using Matrix = std::array<std::array<Real, Dim>, Dim>;

  void update_stresses() {
    share_dilations();
    for (Eigen::Index p = 0; p < particles_.count(); ++p) {
      const auto& strain = strain_[static_cast<std::size_t>(p)];
      for (std::size_t c = 0; scene_.sums_strain && c < components; ++c) particles_.strain[c][p] += strain[c];
      const Matrix& growth = growth_[static_cast<std::size_t>(p)];
      const Real power_before = power_of_turned_stress(p, growth, strain),
                 volume_before = particles_.volume[p];
      std::visit([&](const auto& law) { update_stress(law, growth, strain, p); },
                 law_of<Dim, Real>(body_at(p).material));
      if (!scene_.sums_work) continue;
      particles_.stress_work[0][p] += (power_before + power(p, strain)) / 2 * volume_before;
    }
  }

  /// Of the stress on a strain increment, per volume.
  Real power(Eigen::Index p, const SymmetricTensor<Dim, Real>& strain) const {
    Real sum(0);
    for (std::size_t a = 0; a < Dim; ++a) {
      for (std::size_t b = 0; b < Dim; ++b) sum += stress(p, a, b) * strain[a == b ? a : 3];
    }
    return sum;
  }

  /// The same of the stress turned with the material, where the law's stress turns with it.
  Real power_of_turned_stress(Eigen::Index p, const Matrix& growth,
                              const SymmetricTensor<Dim, Real>& strain) {
    if constexpr (Dim == 1) {
      return power(p, strain);
    } else {
      const bool turns = scene_.objectivity == Objectivity::jaumann ||
                         std::holds_alternative<NeoHookean>(body_at(p).material);
      if (!turns) return power(p, strain);
      SymmetricTensor<Dim, Real> kept;
      for (std::size_t c = 0; c < components; ++c) kept[c] = particles_.stress[c][p];
      turn_stress(p, (growth[1][0] - growth[0][1]) / 2);
      const Real found = power(p, strain);
      set_stress(p, kept);
      return found;
    }
  }

  void find_strains() {
    for_each_particle([&](Eigen::Index p, const Nodes& nodes) {
      Matrix& growth = growth_[static_cast<std::size_t>(p)];
      growth = {};
      for (const auto& seen : nodes) {
        for (std::size_t a = 0; a < Dim; ++a) {
          for (std::size_t b = 0; b < Dim; ++b)
            growth[a][b] += time_step_ * grid_.velocity[a][seen.node] * seen.gradient[b];
        }
      }
      find_strain(p);
    });
  }

  void find_strain(Eigen::Index p) {
    const Matrix& growth = growth_[static_cast<std::size_t>(p)];
    auto& strain = strain_[static_cast<std::size_t>(p)];
    strain = {};
    for (std::size_t a = 0; a < Dim; ++a) strain[a] = growth[a][a];
    if constexpr (Dim == 2) strain[3] = (growth[0][1] + growth[1][0]) / 2;
  }

  /// A node that weighs less than `light_nodes` of a layer of the particle's body, one cell wide, is for the strain
  /// partly accelerated as the particle is; an empty one moves with it. Nodes that are held are not light.
  void slow_light_nodes() {
    edges_.set_strain_mass(grid_, {0, grid_.rows()});
    rigid_bodies_.set_strain_mass(grid_);
    for_each_particle([&](Eigen::Index p, const Nodes& nodes) {
      const auto& in_cell = body_at(p).particles_per_cell;
      const double across = Dim == 1 ? 1.0 : std::sqrt(in_cell[0] * in_cell[1]);
      const Real full = static_cast<Real>(*scene_.light_nodes * across) * particles_.mass[p];
      for (std::size_t a = 0; a < Dim; ++a) {
        Real felt(0);
        for (const auto& seen : nodes) felt += seen.weight * grid_.acceleration[a][seen.node];
        for (const auto& seen : nodes) {
          const Real share = std::min(grid_.strain_mass[a][seen.node] / full, Real(1));
          if (share == 1) continue;
          const Real before = grid_.velocity[a][seen.node] - time_step_ * grid_.acceleration[a][seen.node];
          const Real start = grid_.strain_mass[a][seen.node] > empty_mass_ ? before : particles_.velocity[a][p];
          const Real velocity =
              start + time_step_ * (share * grid_.acceleration[a][seen.node] + (1 - share) * felt);
          for (std::size_t b = 0; b < Dim; ++b)
            growth_[static_cast<std::size_t>(p)][a][b] +=
                time_step_ * (velocity - grid_.velocity[a][seen.node]) * seen.gradient[b];
        }
      }
      find_strain(p);
    });
  }

  /// Locking control: xx + yy becomes its mean over the cell, the difference of both stays.
  void share_dilations() {
    if constexpr (Dim == 2) {
      const auto own = [&](Eigen::Index p) {
        return strain_[static_cast<std::size_t>(p)][0] + strain_[static_cast<std::size_t>(p)][1];
      };
      const std::vector<Real> mean = averaged_over_cells(own);
      for (Eigen::Index p = 0; p < particles_.count(); ++p) {
        const Real change = mean[static_cast<std::size_t>(p)] - own(p);
        for (std::size_t a = 0; a < Dim; ++a) strain_[static_cast<std::size_t>(p)][a] += change / 2;
      }
    }
  }

  /// [particle] The mean of a number over the particles in the same cell whose bodies have locking control,
  /// weighted by volume; the number itself elsewhere.
  template <class Own>
  std::vector<Real> averaged_over_cells(Own&& own) const {
    const auto cell = [&](Eigen::Index p) {
      std::array<Real, Dim> lower;
      for (std::size_t a = 0; a < Dim; ++a) lower[a] = std::floor(in_cells(p, a));
      return lower;
    };
    const auto shares = [&](Eigen::Index p) { return body_at(p).locking_control != LockingControl::none; };
    std::map<std::array<Real, Dim>, std::pair<Real, Real>> sums;
    for (Eigen::Index p = 0; p < particles_.count(); ++p) {
      if (!shares(p)) continue;
      auto& [content, volume] = sums[cell(p)];
      content += particles_.volume[p] * own(p);
      volume += particles_.volume[p];
    }
    std::vector<Real> all;
    for (Eigen::Index p = 0; p < particles_.count(); ++p) {
      all.push_back(shares(p) ? sums.at(cell(p)).first / sums.at(cell(p)).second : own(p));
    }
    return all;
  }

  template <class Law>
  void update_stress(const Law& law, const Matrix& growth, const SymmetricTensor<Dim, Real>& strain,
                     Eigen::Index p) {
    if constexpr (std::is_same_v<Law, NeoHookeanLaw<2, Real>>) {
      auto& f = particles_.deformation_gradient;
      std::array<Real, 4> grown;
      for (std::size_t a = 0; a < 2; ++a) {
        for (std::size_t b = 0; b < 2; ++b)
          grown[2 * a + b] = f[2 * a + b][p] + growth[a][0] * f[b][p] + growth[a][1] * f[2 + b][p];
      }
      for (std::size_t k = 0; k < 4; ++k) f[k][p] = grown[k];
      const Real volume_ratio = grown[0] * grown[3] - grown[1] * grown[2];
      particles_.volume[p] = volume_ratio * particles_.initial_volume[p];
      set_stress(p, law.stress(grown, volume_ratio));
    } else {
      if constexpr (Dim == 2) {
        if (scene_.objectivity == Objectivity::jaumann) turn_stress(p, (growth[1][0] - growth[0][1]) / 2);
      }
      Real expansion(0);
      for (std::size_t a = 0; a < Dim; ++a) expansion += strain[a];
      particles_.volume[p] *= 1 + expansion;
      SymmetricTensor<Dim, Real> old;
      for (std::size_t c = 0; c < components; ++c) old[c] = particles_.stress[c][p];
      Real volume_ratio(1);
      if constexpr (follows_volume<Law>) volume_ratio = particles_.volume[p] / particles_.initial_volume[p];
      set_stress(p, law.update(old, strain, volume_ratio));
    }
  }

  /// R stress R^T, with R a turn by `angle` [rad] anticlockwise.
  void turn_stress(Eigen::Index p, Real angle) {
    const std::array<std::array<Real, 2>, 2> turn{
        {{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}}};
    const auto turned = [&](std::size_t a, std::size_t b) {
      Real sum(0);
      for (std::size_t c = 0; c < 2; ++c) {
        for (std::size_t d = 0; d < 2; ++d) sum += turn[a][c] * stress(p, c, d) * turn[b][d];
      }
      return sum;
    };
    set_stress(p, {turned(0, 0), turned(1, 1), particles_.stress[2][p], turned(0, 1)});
  }

  void set_stress(Eigen::Index p, const SymmetricTensor<Dim, Real>& stress) {
    for (std::size_t c = 0; c < components; ++c) particles_.stress[c][p] = stress[c];
  }

  void move_particles() {
    for (Eigen::Index p = 0; p < particles_.count(); ++p) {
      bool crosses = false;
      for (std::size_t a = 0; a < Dim; ++a) {
        const Real travel = travel_[static_cast<std::size_t>(p)][a];
        const Real cell = std::floor(in_cells(p, a));
        particles_.position[a][p] += travel;
        particles_.displacement[a][p] += travel;
        crosses = crosses || std::floor(in_cells(p, a)) != cell;
        if constexpr (scheme == Scheme::cpgimp)
          particles_.half_size[a][p] =
              std::min(particles_.half_size[a][p] * (1 + strain_[static_cast<std::size_t>(p)][a]), largest_half_size());
      }
      cell_crossings_ += crosses;
    }
  }

  // --- what can go wrong
  // ------------------------------------------------------------------------------------

  /// What no domain grows beyond, as the solver rounds it [m].
  Real largest_half_size() const {
    if (!scene_.domain_limit) return std::numeric_limits<Real>::max();
    return static_cast<Real>(*scene_.domain_limit * scene_.cell_size) * (1 - 4 * std::numeric_limits<Real>::epsilon());
  }

  Real in_cells(Eigen::Index p, std::size_t axis) const {
    return (particles_.position[axis][p] - grid_.origin(static_cast<int>(axis))) * grid_.cells_per_length();
  }

  /// Why the particle has no stencil, if it has none.
  std::optional<Ending> place_fault_of(Eigen::Index p) const {
    for (std::size_t a = 0; a < Dim; ++a) {
      const Real place = in_cells(p, a);
      if (!std::isfinite(place)) return Ending::not_finite;
      if (place < 2 || place > static_cast<Real>(grid_.nodes(static_cast<int>(a)) - 3))
        return Ending::outside_grid;
      if constexpr (SchemeTraits<scheme>::has_domain) {
        if (!(particles_.half_size[a][p] * grid_.cells_per_length() <= 1)) return Ending::domain_too_large;
      }
    }
    if (!std::isfinite(particles_.volume[p])) return Ending::not_finite;
    if (particles_.volume[p] <= 0) return Ending::inverted;
    return std::nullopt;
  }

  void note_first_fault() {
    for (Eigen::Index p = 0; p < particles_.count() && !fault_; ++p) {
      std::optional<Ending> ending = place_fault_of(p);
      bool is_finite = true;
      for (const auto& component : particles_.stress) is_finite = is_finite && std::isfinite(component[p]);
      for (const auto& component : particles_.velocity) is_finite = is_finite && std::isfinite(component[p]);
      if (!ending && !is_finite) ending = Ending::not_finite;
      if (ending) fault_ = Fault{*ending, steps_, static_cast<std::int64_t>(p)};
    }
  }

  // --- the rest
  // ---------------------------------------------------------------------------------------------

  using Nodes = PlainStencil<Dim, Real, scheme>;

  void find_nodes() {
    nodes_.clear();
    for (Eigen::Index p = 0; p < particles_.count(); ++p) {
      Vector<Dim, Real> position, half_size{};
      for (std::size_t a = 0; a < Dim; ++a) {
        position[a] = particles_.position[a][p];
        if constexpr (SchemeTraits<scheme>::has_domain) half_size[a] = particles_.half_size[a][p];
      }
      if (is_disturbed_) {
        nodes_.emplace_back(grid_, position, half_size, [&](Real size) { return round_off(size); });
      } else {
        nodes_.emplace_back(grid_, position, half_size);
      }
    }
  }

  template <class Visit>
  void for_each_particle(Visit&& visit) {
    for (Eigen::Index p = 0; p < particles_.count(); ++p) visit(p, nodes_[static_cast<std::size_t>(p)]);
  }

  const Body& body_at(Eigen::Index p) const {
    std::size_t body = 0;
    while (p >= particles_.bodies[body].last) ++body;
    return scene_.bodies[body];
  }

  /// Up to two units in the last place of `size`.
  Real round_off(Real size) {
    return static_cast<Real>(uniform_(random_)) * std::numeric_limits<Real>::epsilon() * size;
  }

  void disturb() {
    for (Eigen::Index p = 0; p < particles_.count(); ++p) {
      for (std::size_t a = 0; a < Dim; ++a) {
        particles_.position[a][p] +=
            round_off(particles_.position[a][p] - grid_.origin(static_cast<int>(a)) + grid_.cell_size());
        particles_.velocity[a][p] += round_off(particles_.velocity[a][p]);
      }
      for (auto& component : particles_.stress) component[p] += round_off(component[p]);
    }
  }

  template <std::size_t Count>
  std::vector<double> interleaved(const std::array<Field<Real>, Count>& fields) const {
    std::vector<double> all;
    for (Eigen::Index p = 0; p < particles_.count(); ++p) {
      for (const Field<Real>& field : fields)
        all.push_back(field.size() > 0 ? static_cast<double>(field[p]) : 0.0);
    }
    return all;
  }

  std::vector<double> from_origin(std::vector<double> places) const {
    for (std::size_t k = 0; k < places.size(); ++k) places[k] += corner_[k % Dim];
    return places;
  }

  PerAxis corner_;  ///< of the grid, which everything below is seen from
  Scene scene_;
  Particles<Dim, Real> particles_;
  Grid<Dim, Real> grid_;
  EdgeConditions<Dim, Real> edges_;
  RigidBodies<Dim, Real> rigid_bodies_;
  Loading<Dim, Real> loading_;
  double seconds_;
  Real time_step_, empty_mass_;
  std::array<Field<Real>, Dim> start_;
  std::vector<Nodes> nodes_;                                    ///< [particle], of the step's start
  std::vector<Vector<Dim, Real>> travel_;                       ///< [particle] [m]
  std::vector<std::array<std::array<Real, Dim>, Dim>> growth_;  ///< [particle] velocity gradient * time step
  std::vector<SymmetricTensor<Dim, Real>> strain_;              ///< [particle] increments [-]
  std::int64_t steps_ = 0, cell_crossings_ = 0;
  std::optional<Fault> fault_;
  bool is_disturbed_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_{-2.0, 2.0};
};

}  // namespace mpm::test
