#pragma once

#include <cmath>
#include <limits>
#include <variant>
#include <vector>

#include "solver/cell_average.hpp"
#include "solver/cell_blocks.hpp"
#include "solver/compensated_sum.hpp"
#include "solver/grid_motion.hpp"
#include "solver/loading.hpp"
#include "solver/material.hpp"
#include "solver/rigid_bodies.hpp"
#include "solver/transfer.hpp"
#include "solver/workers.hpp"

namespace mpm {

/// Particles, grid and what moves them: one explicit step of the Material Point Method [Kiriyama15, Eqs. 1 to
/// 14]. Its passes run over blocks of particles; what a pass needs of the one before, it reads again.
template <int Dim, class Real, Scheme scheme>
class TimeStepper {
 public:
  /// `threads` >= 1; their number changes no bit of any result.
  TimeStepper(const Scene& scene, double time_step, int threads)
      : particles_(fill_bodies<Dim, Real>(scene, SchemeTraits<scheme>::has_domain)),
        grid_(scene),
        edges_(scene, grid_),
        rigid_bodies_(scene, grid_, time_step),
        loading_(scene, time_step, particles_),
        update_stress_(scene),
        order_(scene.update_order),
        compensates_(scene.compensated_sums),
        time_step_(static_cast<Real>(time_step)),
        flip_(static_cast<Real>(scene.flip_fraction)),
        damping_(static_cast<Real>(scene.damping)),
        largest_half_size_(half_size_limit(scene)),
        empty_mass_(SchemeTraits<scheme>::Shape::template empty_share<Real> * static_cast<Real>(least_mass(scene))),
        light_nodes_(light_node_fractions(scene)),
        average_(scene, grid_),
        blocks_(grid_, SchemeTraits<scheme>::Shape::nodes_before, particles_),
        workers_(threads) {
    open_logs();
    for (const Body& body : scene.bodies) laws_.push_back(law_of<Dim, Real>(body.material));
  }

  /// One step from `time` [s] on, under the gravity of its end. False if a particle has left what the method
  /// can represent.
  bool advance(double time, const Vector<Dim, Real>& gravity) {
    if (has_fault_) return false;
    if (is_disordered_) arrange();
    loading_.set_masses(time, particles_);
    loading_.set_forces(time, gravity, particles_);
    rigid_bodies_.hold(time);
    in_rows([&](Rows rows) { grid_.clear(rows); });
    if (order_ == UpdateOrder::usf) {
      scatter<Sends{.mass = true, .momentum = true}>();
      take_velocity_from_momentum();
      update_stress_and_scatter_force();
    } else {
      average_stress();
      scatter<Sends{.mass = true, .momentum = true, .internal_force = true}>();
    }
    move_grid(gravity);
    if (order_ == UpdateOrder::usl) move_particles_and_update_stress();
    if (order_ == UpdateOrder::usf) move_particles();
    if (order_ == UpdateOrder::musl) {
      in_rows([&](Rows rows) { grid_.clear_momentum(rows); });
      accelerate_particles_and_scatter_momentum();
      take_velocity_from_momentum();
      update_stress_and_move_particles();
    }
    close_logs();
    return true;
  }

  /// Lets `change(particles)` put the particles in another state, wherever they then are.
  template <class Change>
  void change_particles(Change&& change) {
    change(particles_);
    particles_.clear_low_parts();
    has_fault_ = find_fault().kind != StencilFault::none;
    if (!has_fault_) arrange();
  }

  const Particles<Dim, Real>& particles() const { return particles_; }
  const Grid<Dim, Real>& grid() const { return grid_; }
  /// Rows of nodes that can carry mass; the others are not kept up to date.
  Rows active_rows() const { return blocks_.active_rows(); }
  const RigidBodies<Dim, Real>& rigid_bodies() const { return rigid_bodies_; }
  /// Particle centres that changed cell so far, summed over the steps.
  std::int64_t cell_crossings() const { return cell_crossings_; }
  /// How often the particles have been put in order.
  std::int64_t arrangements() const { return arrangements_; }
  /// Memory of particles, nodes and tables: of everything whose size goes with that of the scene [B].
  std::int64_t bytes() const {
    return particles_.bytes() + grid_.bytes() + blocks_.bytes() + average_.bytes() + loading_.bytes() +
           static_cast<std::int64_t>(logs_.capacity() * sizeof(Log));
  }
  /// Of the last step [N]; see Transfer::unbalanced_force.
  double unbalanced_force() const { return Transfers::unbalanced_force(particles_, grid_, empty_mass_); }
  typename Transfer<Dim, Real, scheme>::Fault find_fault() const {
    return Transfers::find_fault(particles_, grid_);
  }

 private:
  using Transfers = Transfer<Dim, Real, scheme>;
  using Value = Lanes<Real>;
  using Layer = typename Transfers::Layer;
  using Layers = typename Transfers::Layers;
  using Motion = GridMotion<Dim, Value>;

  /// What a band's particles did in a step.
  struct alignas(64) Log {
    Value crossings = Value(0), strays = Value(0);  ///< in each lane
    Real lowest_row = 0, end_of_rows = 0;           ///< of cells, within reach of the band
    bool has_fault = false, has_far_stray = false;
  };

  // --- passes ---

  template <Sends sends>
  void scatter() {
    for_each_block_in_two_colours([&](const Block& block, std::size_t body, Log&) {
      Transfers::for_each_layers(particles_, grid_, block, [&](const Layers& layers, std::size_t count) {
        scatter<sends>(body, block, layers, count);
      });
    });
  }

  /// With the internal force go the external ones of a scene that has them.
  template <Sends sends>
  void scatter(std::size_t body, const Block& block, const Layers& layers, std::size_t count) {
    const CellAverage<Dim, Real>* const mean_stress = average_.is_wanted_by(body) ? &average_ : nullptr;
    constexpr Sends with_loads{sends.mass, sends.momentum, sends.internal_force, sends.internal_force};
    if (loading_.has_forces()) {
      Transfers::template scatter<with_loads>(particles_, block, layers, count, grid_, mean_stress);
    } else {
      Transfers::template scatter<sends>(particles_, block, layers, count, grid_, mean_stress);
    }
  }

  void move_grid(const Vector<Dim, Real>& gravity) {
    in_rows([&](Rows rows) {
      add_gravity<Dim, Real>(grid_, gravity, rows);
      edges_.apply(grid_, rows);
    });
    rigid_bodies_.take_up(grid_, empty_mass_);
    in_rows([&](Rows rows) {
      if (damping_ > 0) {
        accelerate<true>(grid_, time_step_, damping_, empty_mass_, rows);
      } else {
        accelerate<false>(grid_, time_step_, damping_, empty_mass_, rows);
      }
    });
    rigid_bodies_.set_motion(grid_, empty_mass_);
    if (light_nodes_.empty()) return;
    in_rows([&](Rows rows) { edges_.set_strain_mass(grid_, rows); });
    rigid_bodies_.set_strain_mass(grid_);
  }

  void take_velocity_from_momentum() {
    in_rows([&](Rows rows) {
      edges_.apply(grid_, rows);
      set_velocity(grid_, empty_mass_, rows);
    });
    rigid_bodies_.set_motion(grid_, empty_mass_);
  }

  /// Averages a number of the particles over the cells, `own(body, block, layer)`.
  template <class Own>
  void average_over_cells(Own&& own) {
    in_rows([&](Rows rows) { average_.clear(grid_, rows); });
    for_each_block_in_two_colours([&](const Block& block, std::size_t body, Log&) {
      if (!average_.is_wanted_by(body)) return;
      Value content(0), volume(0);
      Transfers::for_each_layer(particles_, grid_, block, [&](const Layer& layer) {
        Value volume_of_layer = volume_of(layer.slot);
        Value content_of_layer = volume_of_layer * own(body, block, layer);
        Transfers::for_each_stray(particles_, grid_, block, layer, [&](int lane, Eigen::Index cell) {
          average_.add(cell, lane_of<Real>(content_of_layer, lane), lane_of<Real>(volume_of_layer, lane));
          set_lane(content_of_layer, lane, Real(0));
          set_lane(volume_of_layer, lane, Real(0));
        });
        content = content + content_of_layer;
        volume = volume + volume_of_layer;
      });
      average_.add(Transfers::cell_of(block, grid_), content, volume);
    });
  }

  /// Before the stress is updated, for bodies that share their dilation.
  void average_dilation() {
    if (!average_.is_wanted()) return;
    average_over_cells([&](std::size_t body, const Block& block, const Layer& layer) {
      return trace<Dim, Value>(own_deformation_of_layer(body, block, layer).strain_increment);
    });
  }

  /// Before internal forces are sent, for bodies that share their dilation: of the normal stresses in the
  /// plane.
  void average_stress() {
    if constexpr (Dim == 2) {
      if (!average_.is_wanted()) return;
      average_over_cells([&](std::size_t, const Block&, const Layer& layer) {
        return (load<Value>(&particles_.stress[0][layer.slot]) +
                load<Value>(&particles_.stress[1][layer.slot])) /
               2;
      });
    }
  }

  /// USL.
  void move_particles_and_update_stress() {
    average_dilation();
    for_each_layer_with_law(
        [&](const auto& law, std::size_t body, const Block& block, const Layer& layer, Log& log) {
          const Motion motion = all_motion_of_layer(body, block, layer);
          const Value time_step = time_step_of(layer.slot);
          const Vector<Dim, Value> travel = accelerate_layer(motion, time_step, layer.slot);
          auto deformation = deformation_of<Dim, Value>(motion.gradient, time_step);
          share_dilation(body, block, layer, deformation);
          update_stress_(law, deformation, layer.slot, particles_);
          grow(deformation, layer.slot);
          move(travel, block, layer.slot, log);
        });
  }

  /// MUSL, first half: the travel of the particles waits in `pending` for the weights to be used once more.
  void accelerate_particles_and_scatter_momentum() {
    for_each_block_in_two_colours([&](const Block& block, std::size_t, Log&) {
      Transfers::for_each_layers(particles_, grid_, block, [&](const Layers& layers, std::size_t count) {
        for (std::size_t k = 0; k < count; ++k) {
          const Eigen::Index slot = layers[k].slot;
          const Motion motion = Transfers::template gather<true, false>(particles_, grid_, block, layers[k]);
          const Vector<Dim, Value> travel = accelerate_layer(motion, time_step_of(slot), slot);
          for (std::size_t a = 0; a < Dim; ++a) store(travel[a], &particles_.pending[a][slot]);
        }
        Transfers::template scatter<Sends{.momentum = true}>(particles_, block, layers, count, grid_);
      });
    });
  }

  /// MUSL, second half.
  void update_stress_and_move_particles() {
    average_dilation();
    for_each_layer_with_law(
        [&](const auto& law, std::size_t body, const Block& block, const Layer& layer, Log& log) {
          const auto deformation = deformation_of_layer(body, block, layer);
          update_stress_(law, deformation, layer.slot, particles_);
          grow(deformation, layer.slot);
          Vector<Dim, Value> travel;
          for (std::size_t a = 0; a < Dim; ++a) travel[a] = load<Value>(&particles_.pending[a][layer.slot]);
          move(travel, block, layer.slot, log);
        });
  }

  /// USF, first half: the growth of the domains waits in `pending` for the weights to be used once more.
  void update_stress_and_scatter_force() {
    average_dilation();
    for_each_block_in_two_colours([&](const Block& block, std::size_t body, Log&) {
      Transfers::for_each_layers(particles_, grid_, block, [&](const Layers& layers, std::size_t count) {
        for (std::size_t k = 0; k < count; ++k) {
          const auto deformation = deformation_of_layer(body, block, layers[k]);
          std::visit([&](const auto& law) { update_stress_(law, deformation, layers[k].slot, particles_); },
                     laws_[body]);
          if constexpr (SchemeTraits<scheme>::updates_half_size) {
            for (std::size_t a = 0; a < Dim; ++a) {
              store(deformation.strain_increment[a], &particles_.pending[a][layers[k].slot]);
            }
          }
        }
        if (!average_.is_wanted()) scatter<Sends{.internal_force = true}>(body, block, layers, count);
      });
    });
    if (!average_.is_wanted()) return;
    average_stress();  // which takes the stresses of all particles of a cell
    scatter<Sends{.internal_force = true}>();
  }

  /// USF, second half.
  void move_particles() {
    for_each_layer([&](const Block& block, const Layer& layer, Log& log) {
      const Eigen::Index slot = layer.slot;
      const Motion motion = Transfers::template gather<true, false>(particles_, grid_, block, layer);
      const Vector<Dim, Value> travel = accelerate_layer(motion, time_step_of(slot), slot);
      if constexpr (SchemeTraits<scheme>::updates_half_size) {
        Deformation<Dim, Value> deformation;
        for (std::size_t a = 0; a < Dim; ++a) {
          deformation.strain_increment[a] = load<Value>(&particles_.pending[a][slot]);
        }
        grow(deformation, slot);
      }
      move(travel, block, slot, log);
    });
  }

  // --- what passes do to a layer of particles ---

  /// The time step, and none in empty slots.
  Value time_step_of(Eigen::Index slot) const {
    return select(load<Value>(&particles_.mass[slot]) > Value(0), Value(time_step_), Value(0));
  }

  /// Volumes, and none in empty slots.
  Value volume_of(Eigen::Index slot) const {
    return select(load<Value>(&particles_.mass[slot]) > Value(0), load<Value>(&particles_.volume[slot]),
                  Value(0));
  }

  /// What the stress and the volume of a body's particles follow.
  Deformation<Dim, Value> deformation_of_layer(std::size_t body, const Block& block,
                                               const Layer& layer) const {
    Deformation<Dim, Value> deformation = own_deformation_of_layer(body, block, layer);
    share_dilation(body, block, layer, deformation);
    return deformation;
  }

  Deformation<Dim, Value> own_deformation_of_layer(std::size_t body, const Block& block, const Layer& layer) const {
    const Motion motion = straining_motion_of_layer(body, block, layer);
    return deformation_of<Dim, Value>(motion.gradient, time_step_of(layer.slot));
  }

  /// With light nodes as the scene treats them.
  [[gnu::always_inline]] Motion all_motion_of_layer(std::size_t body, const Block& block, const Layer& layer) const {
    if (!light_nodes_.empty()) [[unlikely]] return motion_with_light_nodes(body, block, layer);
    return Transfers::template gather<true, true>(particles_, grid_, block, layer);
  }

  /// Likewise, of the motion no more than what strains.
  [[gnu::always_inline]] Motion straining_motion_of_layer(std::size_t body, const Block& block,
                                                          const Layer& layer) const {
    if (!light_nodes_.empty()) [[unlikely]] return motion_with_light_nodes(body, block, layer);
    return Transfers::template gather<false, true>(particles_, grid_, block, layer);
  }

  // What few scenes have stays out of the loops of all others: such functions are not inlined, and take copies, so that
  // nothing of a loop has to live in memory for their sake.

  [[gnu::noinline]] Motion motion_with_light_nodes(std::size_t body, Block block, Layer layer) const {
    Motion motion = Transfers::template gather<true, true>(particles_, grid_, block, layer);
    Transfers::slow_light_nodes(particles_, grid_, block, layer, {light_nodes_[body], time_step_, empty_mass_}, motion);
    return motion;
  }

  [[gnu::noinline]] void accelerate_compensated(Vector<Dim, Value> change, Eigen::Index slot) {
    for (std::size_t a = 0; a < Dim; ++a)
      add_compensated(change[a], &particles_.velocity[a][slot], &particles_.low.velocity[a][slot]);
  }

  [[gnu::noinline]] void grow_compensated(Vector<Dim, Value> strain_increment, Eigen::Index slot) {
    for (std::size_t a = 0; a < Dim; ++a) {
      Real *const half_size = &particles_.half_size[a][slot], *const low = &particles_.low.half_size[a][slot];
      const Value largest(largest_half_size_);
      add_compensated(load<Value>(half_size) * strain_increment[a], half_size, low);
      const Value grown = load<Value>(half_size);
      store(select(grown < largest, grown, largest), half_size);
      store(select(grown < largest, load<Value>(low), Value(0)), low);
    }
  }

  /// Position and displacement.
  [[gnu::noinline]] void add_up_compensated(Value travel, Eigen::Index slot, std::size_t axis) {
    add_compensated(travel, &particles_.position[axis][slot], &particles_.low.position[axis][slot]);
    add_compensated(travel, &particles_.displacement[axis][slot], &particles_.low.displacement[axis][slot]);
  }

  /// [body] The mass of a node that counts as full over that of a particle: the scene's fraction of a layer of
  /// particles one cell wide. Empty for scenes that do not treat light nodes.
  static std::vector<Real> light_node_fractions(const Scene& scene) {
    std::vector<Real> fractions;
    if (!scene.light_nodes) return fractions;
    for (const Body& body : scene.bodies) {
      double in_cell = 1.0;
      for (std::size_t a = 0; a < Dim; ++a) in_cell *= body.particles_per_cell[a];
      fractions.push_back(static_cast<Real>(*scene.light_nodes * std::pow(in_cell, (Dim - 1.0) / Dim)));
    }
    return fractions;
  }

  /// In a body that asks for it, the mean dilation of its cell takes the place of each particle's own.
  void share_dilation(std::size_t body, const Block& block, const Layer& layer,
                      Deformation<Dim, Value>& deformation) const {
    if constexpr (Dim == 2) {
      if (!average_.is_wanted_by(body)) return;
      Value mean = average_.template mean<Value>(Transfers::cell_of(block, grid_));
      Transfers::for_each_stray(particles_, grid_, block, layer, [&](int lane, Eigen::Index cell) {
        set_lane(mean, lane, average_.template mean<Real>(cell));
      });
      const auto is_particle = load<Value>(&particles_.mass[layer.slot]) > Value(0);
      set_dilation(select(is_particle, mean, Value(0)), deformation);
    }
  }

  /// Velocities after the step, a blend of the grid's velocity (`flip` 0, PIC) and the grid's acceleration
  /// (1, FLIP); returns the distances to travel.
  Vector<Dim, Value> accelerate_layer(const Motion& motion, const Value& time_step, Eigen::Index slot) {
    Vector<Dim, Value> travel;
    if (compensates_) [[unlikely]] {
      Vector<Dim, Value> change;
      for (std::size_t a = 0; a < Dim; ++a) {
        const Value old = load<Value>(&particles_.velocity[a][slot]);
        change[a] = flip_ * (time_step * motion.acceleration[a]) + (1 - flip_) * (motion.velocity[a] - old);
        travel[a] = time_step * motion.velocity[a];
      }
      accelerate_compensated(change, slot);
      return travel;
    }
    for (std::size_t a = 0; a < Dim; ++a) {
      const Value flip_velocity = load<Value>(&particles_.velocity[a][slot]) + time_step * motion.acceleration[a];
      store(motion.velocity[a] + flip_ * (flip_velocity - motion.velocity[a]), &particles_.velocity[a][slot]);
      travel[a] = time_step * motion.velocity[a];
    }
    return travel;
  }

  /// Of any particle at any time [kg per unit of the absent dimensions].
  static double least_mass(const Scene& scene) {
    double least = std::numeric_limits<double>::max();
    for (const Body& body : scene.bodies) {
      const Lattice lattice = lattice_of(scene, body);
      double volume = 1.0;
      for (std::size_t a = 0; a < Dim; ++a) volume *= lattice.spacing[a];
      least = std::min(least, body.lightest() * volume);
    }
    return least;
  }

  /// [m]; without a limit more than any half size can be.
  static Real half_size_limit(const Scene& scene) {
    if (!scene.domain_limit) return std::numeric_limits<Real>::max();
    // A little less: in cells, it must not be rounded to more than one.
    constexpr Real rounding = 4 * std::numeric_limits<Real>::epsilon();
    return static_cast<Real>(*scene.domain_limit * scene.cell_size) * (1 - rounding);
  }

  /// Half sizes of cpGIMP [Kiriyama15, Eq. 14], up to the scene's limit.
  void grow(const Deformation<Dim, Value>& deformation, Eigen::Index slot) {
    if constexpr (SchemeTraits<scheme>::updates_half_size) {
      if (compensates_) [[unlikely]] {
        Vector<Dim, Value> increment;
        for (std::size_t a = 0; a < Dim; ++a) increment[a] = deformation.strain_increment[a];
        return grow_compensated(increment, slot);
      }
      for (std::size_t a = 0; a < Dim; ++a) {
        Real* const half_size = &particles_.half_size[a][slot];
        const Value largest(largest_half_size_);
        const Value grown = load<Value>(half_size) * (1 + deformation.strain_increment[a]);
        store(select(grown < largest, grown, largest), half_size);
      }
    }
  }

  /// Moves a layer, and notes who crosses into another cell, strays, or has no next step.
  void move(const Vector<Dim, Value>& travel, const Block& block, Eigen::Index slot, Log& log) {
    Vector<Dim, Value> place;
    auto crosses = Value(0) > Value(0), is_good = Value(0) < load<Value>(&particles_.volume[slot]);
    for (std::size_t a = 0; a < Dim; ++a) {
      const Value before = load<Value>(&particles_.position[a][slot]);
      Value after = before + travel[a];
      if (compensates_) [[unlikely]] {
        add_up_compensated(travel[a], slot, a);
        after = load<Value>(&particles_.position[a][slot]);
      } else {
        store(after, &particles_.position[a][slot]);
        Real* const displacement = &particles_.displacement[a][slot];
        store(load<Value>(displacement) + travel[a], displacement);
      }
      place[a] = in_cells(grid_, after, a);
      crosses = crosses || floor(place[a]) != floor(in_cells(grid_, before, a));
      constexpr Real ghosts = Grid<Dim, Real>::ghost_layers;
      const Real last = static_cast<Real>(grid_.nodes(static_cast<int>(a)) - 1) - ghosts;
      is_good = is_good && place[a] >= Value(ghosts) && place[a] <= Value(last);
      if constexpr (SchemeTraits<scheme>::has_domain) {
        is_good =
            is_good && load<Value>(&particles_.half_size[a][slot]) * grid_.cells_per_length() <= Value(1);
      }
    }
    const auto strays = Transfers::is_outside(block, place);
    log.crossings = log.crossings + select(crosses, Value(1), Value(0));
    log.strays = log.strays + select(strays, Value(1), Value(0));
    log.has_fault = log.has_fault || any(!is_good && load<Value>(&particles_.mass[slot]) > Value(0));
    if constexpr (Dim == 2) {
      log.has_far_stray =
          log.has_far_stray || any(place[1] < Value(log.lowest_row) || place[1] >= Value(log.end_of_rows));
    }
  }

  // --- order ---

  void arrange() {
    blocks_.arrange(grid_, particles_);
    grid_.clear({0, grid_.rows()});
    open_logs();
    is_disordered_ = false;
    ++arrangements_;
  }

  void open_logs() {
    logs_.assign(blocks_.bands().size(), Log());
    for (std::size_t b = 0; b < logs_.size(); ++b) {
      const Rows rows = blocks_.bands()[b].rows;
      logs_[b].lowest_row = static_cast<Real>(rows.begin - CellBlocks<Dim, Real>::stray_rows);
      logs_[b].end_of_rows = static_cast<Real>(rows.end + CellBlocks<Dim, Real>::stray_rows);
    }
  }

  /// Reads the logs of a step and empties them.
  void close_logs() {
    double crossings = 0, strays = 0;
    for (Log& log : logs_) {
      crossings += static_cast<double>(reduce_add(log.crossings));
      strays += static_cast<double>(reduce_add(log.strays));
      has_fault_ = has_fault_ || log.has_fault;
      is_disordered_ = is_disordered_ || log.has_far_stray;
      log.crossings = log.strays = Value(0);
    }
    cell_crossings_ += static_cast<std::int64_t>(crossings);
    // Putting all in order costs about a step, and a stray alone many times a particle in lanes: a few per
    // cent of strays are worth it.
    is_disordered_ = is_disordered_ || strays * 32 > static_cast<double>(particles_.count());
  }

  // --- who does what ---

  /// Calls `visit(block, body, log)` for the blocks of a band.
  template <class Visit>
  void visit_band(std::size_t band, Visit&& visit) {
    for (std::size_t body = 0; body < laws_.size(); ++body) {
      const auto [first, last] = blocks_.bands()[band].blocks[body];
      for (std::size_t k = first; k < last; ++k) visit(blocks_.blocks()[k], body, logs_[band]);
    }
  }

  /// For passes that add to nodes.
  template <class Visit>
  void for_each_block_in_two_colours(Visit&& visit) {
    const int bands = static_cast<int>(logs_.size());
    for (int colour = 0; colour < 2; ++colour) {
      workers_.run((bands - colour + 1) / 2,
                   [&](int k) { visit_band(static_cast<std::size_t>(2 * k + colour), visit); });
    }
  }

  /// For passes that only read nodes: calls `visit(block, layer, log)`.
  template <class Visit>
  void for_each_layer(Visit&& visit) {
    workers_.run(static_cast<int>(logs_.size()), [&](int band) {
      visit_band(static_cast<std::size_t>(band), [&](const Block& block, std::size_t, Log& log) {
        Transfers::for_each_layer(particles_, grid_, block,
                                  [&](const Layer& layer) { visit(block, layer, log); });
      });
    });
  }

  /// Likewise, with the law of the layer's body: calls `visit(law, body, block, layer, log)`.
  template <class Visit>
  void for_each_layer_with_law(Visit&& visit) {
    workers_.run(static_cast<int>(logs_.size()), [&](int band) {
      Log& log = logs_[static_cast<std::size_t>(band)];
      for (std::size_t body = 0; body < laws_.size(); ++body) {
        const auto [first, last] = blocks_.bands()[static_cast<std::size_t>(band)].blocks[body];
        std::visit(
            [&, begin = first, end = last](const auto& law) {
              for (std::size_t k = begin; k < end; ++k) {
                const Block& block = blocks_.blocks()[k];
                Transfers::for_each_layer(particles_, grid_, block,
                                          [&](const Layer& layer) { visit(law, body, block, layer, log); });
              }
            },
            laws_[body]);
      }
    });
  }

  /// Calls `visit(rows)` for the rows of nodes that particles can reach, in as many parts as there are
  /// threads.
  template <class Visit>
  void in_rows(Visit&& visit) {
    const auto [begin, end] = blocks_.active_rows();
    const int parts = std::min(workers_.threads(), static_cast<int>(logs_.size()));
    workers_.run(parts, [&, first = begin, count = end - begin](int k) {
      visit(Rows{first + count * k / parts, first + count * (k + 1) / parts});
    });
  }

  Particles<Dim, Real> particles_;
  Grid<Dim, Real> grid_;
  EdgeConditions<Dim, Real> edges_;
  RigidBodies<Dim, Real> rigid_bodies_;
  Loading<Dim, Real> loading_;
  StressUpdate<Dim, Real> update_stress_;
  std::vector<typename Laws<Dim, Real>::Any> laws_;
  UpdateOrder order_;
  bool compensates_;
  Real time_step_, flip_, damping_, largest_half_size_, empty_mass_;
  bool has_fault_ = false, is_disordered_ = false;
  std::vector<Real> light_nodes_;
  CellAverage<Dim, Real> average_;
  std::int64_t cell_crossings_ = 0, arrangements_ = 0;
  CellBlocks<Dim, Real> blocks_;
  std::vector<Log> logs_;
  Workers workers_;
};

}  // namespace mpm
