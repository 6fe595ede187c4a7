#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "solver/cell_average.hpp"
#include "solver/cell_blocks.hpp"
#include "solver/grid.hpp"
#include "solver/lanes.hpp"
#include "solver/particles.hpp"
#include "solver/shape_functions.hpp"

namespace mpm {

/// The weights and weight gradients of a particle, or of lanes of them, along each axis; gradients per metre.
/// Their products over the axes are the values at the particle's nodes.
template <int Dim, class Value, class Shape>
struct Stencil {
  std::array<std::array<Value, Shape::width>, Dim> weight;    ///< [-]
  std::array<std::array<Value, Shape::width>, Dim> gradient;  ///< [1/m]
};

/// What a particle sees of the grid's motion.
template <int Dim, class Value>
struct GridMotion {
  Vector<Dim, Value> velocity{};                   ///< [m/s]
  Vector<Dim, Value> acceleration{};               ///< [m/s^2]
  std::array<Vector<Dim, Value>, Dim> gradient{};  ///< of the velocity, [component][axis] [1/s]
};

/// What a particle gives to the grid.
template <int Dim, class Value>
struct ParticleSums {
  Value mass;                                 ///< [kg per unit of the absent dimensions]
  Vector<Dim, Value> momentum;                ///< [kg m/s]
  SymmetricTensor<Dim, Value> volume_stress;  ///< volume * stress, negative [N m]
  Vector<Dim, Value> external_force;          ///< [N]
};

/// Which of a particle's quantities a scatter sends to the grid.
struct Sends {
  bool mass = false, momentum = false, internal_force = false, external_force = false;
};

/// Why a particle cannot be given a stencil, if it cannot.
enum class StencilFault { none, not_finite, inverted, outside_grid, domain_too_large };

/// The only loops over particles and their nodes. They run over the layers of a block, lanes of particles at
/// a time; strays are taken out of their lanes and go through the same functions alone.
template <int Dim, class Real, Scheme scheme>
class Transfer {
 public:
  using Shape = typename SchemeTraits<scheme>::Shape;
  using Value = Lanes<Real>;
  using Points = Particles<Dim, Real>;
  using Nodes = Grid<Dim, Real>;
  using Weights = Stencil<Dim, Value, Shape>;
  static constexpr int lanes = lane_count<Real>;

  /// A layer of a block with its stencils.
  struct Layer {
    Eigen::Index slot;
    Weights weights;
    bool has_strays;
  };
  /// So many layers are scattered at once, because a node is touched once for all of them.
  static constexpr std::size_t layers_at_once = 4;
  using Layers = std::array<Layer, layers_at_once>;

  /// Calls `visit(layers, count)` for the layers of a block, `layers_at_once` of them at a time.
  template <class Visit>
  static void for_each_layers(const Points& particles, const Nodes& grid, const Block& block, Visit&& visit) {
    Layers layers;
    for (std::int32_t done = 0; done < block.depth; done += static_cast<std::int32_t>(layers_at_once)) {
      const auto count = std::min(layers_at_once, static_cast<std::size_t>(block.depth - done));
      for (std::size_t k = 0; k < count; ++k) {
        weigh(particles, grid, block, block.first_slot + (done + Eigen::Index(k)) * lanes, layers[k]);
      }
      visit(layers, count);
    }
  }

  /// Calls `visit(layer)` for the layers of a block, one after another.
  template <class Visit>
  static void for_each_layer(const Points& particles, const Nodes& grid, const Block& block, Visit&& visit) {
    Layer layer;
    for (std::int32_t k = 0; k < block.depth; ++k) {
      weigh(particles, grid, block, block.first_slot + Eigen::Index(k) * lanes, layer);
      visit(layer);
    }
  }

  /// Adds what the particles of some layers send to the grid [Kiriyama15, Eqs. 1, 2, 3 and 9]. With
  /// `mean_stress`, the internal force is that of the cells' means of the normal stresses in the plane.
  template <Sends sends>
  static void scatter(const Points& particles, const Block& block, const Layers& layers, std::size_t count,
                      Nodes& grid, const CellAverage<Dim, Real>* mean_stress = nullptr);

  /// What the particles of a layer see of the grid's motion [Kiriyama15, Eqs. 5 to 8 and 10a].
  template <bool motion, bool gradient>
  static GridMotion<Dim, Value> gather(const Points& particles, const Nodes& grid, const Block& block,
                                       const Layer& layer);

  /// How the nodes around a particle that are much lighter than it are to strain it.
  struct LightNodes {
    Real fraction;    ///< of the particle's mass: a node with less is light
    Real time_step;   ///< [s]
    Real empty_mass;  ///< nodes with less have no motion of their own [kg per unit of the absent dimensions]
  };

  /// Treats light nodes in what the particles of a layer have gathered before they move: changes the velocity gradient,
  /// and leaves all else.
  ///
  /// The mass of the node beyond a free surface is that of a sliver of the last particle, but the stress of the whole
  /// particle acts on it. What it is accelerated by, the particle feels by the sliver's weight only, yet in USL it is
  /// strained by it in full. Here a node of mass m_i < M, M = fraction * mass of the particle, has for the strain the
  /// acceleration S a_i + (1 - S) a_p, S = m_i / M, a_p what the particle itself feels: the motion that a second
  /// mapping would give a node that only this particle sees. A rigid motion strains as little as ever, and momentum
  /// and travel are untouched. An empty node moves with the particle, the limit of the above.
  ///
  /// For one particle at an offset x (in cells) past a node at rest, the step of velocity and stress has the trace
  /// 2 - q C^2 and the determinant 1 - (q - 1) C^2, C the Courant number and q = S / x + 1 - S; it is stable for
  /// C^2 < 4 / (2 q - 1). Without the treatment, S = 1, this is about 2 x; with it q <= 1 + 1 / fraction for one
  /// particle a cell, and C < sqrt(4 / (1 + 2 / fraction)) for any offset. In a long bar, whose other particles join
  /// in, a half is stable up to C = 0.64 with four or fewer particles a cell, and more than one is never stable with
  /// one particle a cell: every node would be light.
  static void slow_light_nodes(const Points& particles, const Nodes& grid, const Block& block, const Layer& layer,
                               const LightNodes& light, GridMotion<Dim, Value>& seen);

  /// The index of the lower node of a block's first cell. Numbers of cells lie at those of their lower nodes,
  /// so that those of a block's lanes lie side by side.
  static Eigen::Index cell_of(const Block& block, const Nodes& grid) {
    return Eigen::Index(block.row) * grid.row_stride() + block.first_cell;
  }

  /// Calls `visit(lane, cell)` for the strays of a layer, with the index of the cell they are in.
  template <class Visit>
  static void for_each_stray(const Points& particles, const Nodes& grid, const Block& block,
                             const Layer& layer, Visit&& visit) {
    if (!layer.has_strays) return;
    for_each_stray(particles, grid, block, layer.slot,
                   [&](int lane) { visit(lane, cell_of_stray(particles, grid, layer.slot + lane)); });
  }

  /// The first particle that cannot have a stencil, or whose stress or velocity is not finite; why; and its
  /// offending value in SI units.
  struct Fault {
    StencilFault kind = StencilFault::none;
    Eigen::Index particle = -1;
    double value = 0.0;
    std::size_t axis = 0;  ///< of a place or half size: along which it is at fault
  };
  static Fault find_fault(const Points& particles, const Nodes& grid);

  /// Sum over the particles of |mass * unbalanced acceleration of the grid at the particle| [N]: the part of
  /// the unbalanced nodal force that the particles can feel. A pattern of nodal forces whose accelerations
  /// cancel at every particle moves nothing, so it does not keep a model from being at rest.
  static double unbalanced_force(const Points& particles, const Nodes& grid, Real empty_mass);

  /// Lanes in which a place, in cells from the grid's first node, is outside a block's cells.
  static auto is_outside(const Block& block, const Vector<Dim, Value>& place) {
    auto outside = !is_in_cell(place[0] - (lane_numbers<Real>() + static_cast<Real>(block.first_cell)));
    if constexpr (Dim == 2) outside = outside || !is_in_cell(place[1] - static_cast<Real>(block.row));
    return outside;
  }

 private:
  static auto is_in_cell(const Value& place) { return place >= Value(0) && place < Value(1); }

  /// The nodes of lanes of particles, or of one: the index of the first, and the distance between rows.
  struct Place {
    Eigen::Index first;
    std::int32_t row_stride;
  };
  static Place place_of(const Block& block, const Nodes& grid) {
    const std::int32_t row = Dim == 1 ? 0 : block.row - Shape::nodes_before;
    return {Eigen::Index(row) * grid.row_stride() + block.first_cell - Shape::nodes_before,
            grid.row_stride()};
  }

  static void weigh(const Points& particles, const Nodes& grid, const Block& block, Eigen::Index slot,
                    Layer& layer);
  static Place weigh_alone(const Points& particles, const Nodes& grid, Eigen::Index slot,
                           Stencil<Dim, Real, Shape>& stencil);
  template <class V>
  static void evaluate(const Vector<Dim, V>& place, const Vector<Dim, V>& half_size, Real per_length,
                       Stencil<Dim, V, Shape>& stencil);
  static Eigen::Index cell_of_stray(const Points& particles, const Nodes& grid, Eigen::Index slot);
  template <Sends sends, class V>
  static ParticleSums<Dim, V> read(const Points& particles, Eigen::Index slot);
  template <class V>
  static void set_mean_stress(const V& mean, const Points& particles, Eigen::Index slot,
                              ParticleSums<Dim, V>& sums);
  template <class V>
  static V at(const Field<Real>& field, Eigen::Index slot) {
    return load<V>(&field[slot]);
  }

  template <Sends sends, class V, class ReadStencil, class ReadSums>
  static void add(std::size_t count, ReadStencil&& stencil, ReadSums&& sums, Place place, Nodes& grid);
  static void add_to_nodes(const std::array<Value, Shape::width>& sums, Real* nodes);
  static void add_to_nodes(const std::array<Real, Shape::width>& sums, Real* nodes) {
    for (std::size_t i = 0; i < sums.size(); ++i) nodes[i] += sums[i];
  }

  template <bool motion, bool gradient, class V>
  static GridMotion<Dim, V> see(const Nodes& grid, Place place, const Stencil<Dim, V, Shape>& stencil);

  /// What light nodes change of the velocity gradient of a particle, or lanes of them.
  template <class V>
  static std::array<Vector<Dim, V>, Dim> change_by_light_nodes(const Points& particles, const Nodes& grid,
                                                               Eigen::Index slot, Place place,
                                                               const Stencil<Dim, V, Shape>& stencil,
                                                               const LightNodes& light,
                                                               const Vector<Dim, V>& acceleration);

  /// Calls `visit(lane)` for the strays of a layer.
  template <class Visit>
  static void for_each_stray(const Points& particles, const Nodes& grid, const Block& block,
                             Eigen::Index slot, Visit&& visit);
  static StencilFault fault_of(const Points& particles, const Nodes& grid, Eigen::Index slot);
  /// The first axis along which place or half size are not what a stencil can have; 0 if it is the volume.
  static std::size_t axis_at_fault(const Points& particles, const Nodes& grid, Eigen::Index slot);
};

/// A place along an axis in cells from the grid's first node.
template <class V, int Dim, class Real>
V in_cells(const Grid<Dim, Real>& grid, const V& position, std::size_t axis) {
  return (position - grid.origin(static_cast<int>(axis))) * grid.cells_per_length();
}

template <int Dim, class Real, Scheme scheme>
template <class V>
void Transfer<Dim, Real, scheme>::evaluate(const Vector<Dim, V>& place, const Vector<Dim, V>& half_size,
                                           Real per_length, Stencil<Dim, V, Shape>& stencil) {
  for (std::size_t a = 0; a < Dim; ++a) {
    Shape::evaluate(place[a], half_size[a], per_length, stencil.weight[a], stencil.gradient[a]);
  }
}

template <int Dim, class Real, Scheme scheme>
void Transfer<Dim, Real, scheme>::weigh(const Points& particles, const Nodes& grid, const Block& block,
                                        Eigen::Index slot, Layer& layer) {
  Vector<Dim, Value> place, half_size;
  for (std::size_t a = 0; a < Dim; ++a) {
    place[a] = in_cells(grid, at<Value>(particles.position[a], slot), a);
    half_size[a] = SchemeTraits<scheme>::has_domain
                       ? at<Value>(particles.half_size[a], slot) * grid.cells_per_length()
                       : Value(0);
  }
  layer.slot = slot;
  layer.has_strays = any(is_outside(block, place));
  place[0] = place[0] - (lane_numbers<Real>() + static_cast<Real>(block.first_cell - Shape::nodes_before));
  if constexpr (Dim == 2) place[1] = place[1] - static_cast<Real>(block.row - Shape::nodes_before);
  evaluate(place, half_size, grid.cells_per_length(), layer.weights);
}

template <int Dim, class Real, Scheme scheme>
auto Transfer<Dim, Real, scheme>::weigh_alone(const Points& particles, const Nodes& grid, Eigen::Index slot,
                                              Stencil<Dim, Real, Shape>& stencil) -> Place {
  Vector<Dim, Real> place, half_size;
  Eigen::Index first = 0;
  for (std::size_t axis = Dim; axis-- > 0;) {
    const Real cells = in_cells(grid, particles.position[axis][slot], axis);
    const std::int32_t first_node = static_cast<std::int32_t>(cells) - Shape::nodes_before;
    place[axis] = cells - static_cast<Real>(first_node);
    half_size[axis] = SchemeTraits<scheme>::has_domain
                          ? particles.half_size[axis][slot] * grid.cells_per_length()
                          : Real(0);
    first = first * grid.row_stride() + first_node;
  }
  evaluate(place, half_size, grid.cells_per_length(), stencil);
  return {first, grid.row_stride()};
}

template <int Dim, class Real, Scheme scheme>
template <class Visit>
void Transfer<Dim, Real, scheme>::for_each_stray(const Points& particles, const Nodes& grid,
                                                 const Block& block, Eigen::Index slot, Visit&& visit) {
  for (int lane = 0; lane < lanes; ++lane) {
    const std::array<std::int32_t, 2> cell{block.first_cell + lane, block.row};
    bool is_stray = false;
    for (std::size_t a = 0; a < Dim; ++a) {
      const Real place = in_cells(grid, particles.position[a][slot + lane], a) - static_cast<Real>(cell[a]);
      is_stray = is_stray || !(place >= 0 && place < 1);
    }
    if (is_stray) visit(lane);
  }
}

template <int Dim, class Real, Scheme scheme>
template <Sends sends, class V>
ParticleSums<Dim, V> Transfer<Dim, Real, scheme>::read(const Points& particles, Eigen::Index slot) {
  ParticleSums<Dim, V> sums;
  if constexpr (sends.mass || sends.momentum) sums.mass = at<V>(particles.mass, slot);
  if constexpr (sends.momentum) {
    for (std::size_t a = 0; a < Dim; ++a) sums.momentum[a] = sums.mass * at<V>(particles.velocity[a], slot);
  }
  if constexpr (sends.internal_force) {
    const V volume = at<V>(particles.volume, slot);
    for (std::size_t c = 0; c < Points::components; ++c) {
      if (c != 2) sums.volume_stress[c] = -volume * at<V>(particles.stress[c], slot);
    }
  }
  if constexpr (sends.external_force) {
    for (std::size_t a = 0; a < Dim; ++a) sums.external_force[a] = at<V>(particles.external_force[a], slot);
  }
  return sums;
}

template <int Dim, class Real, Scheme scheme>
Eigen::Index Transfer<Dim, Real, scheme>::cell_of_stray(const Points& particles, const Nodes& grid,
                                                        Eigen::Index slot) {
  Eigen::Index cell = 0;
  for (std::size_t axis = Dim; axis-- > 0;) {
    const Real place = in_cells(grid, particles.position[axis][slot], axis);
    cell = cell * grid.row_stride() + static_cast<std::int32_t>(place);
  }
  return cell;
}

/// Gives what particles send another mean of their normal stresses in the plane; empty slots send none.
template <int Dim, class Real, Scheme scheme>
template <class V>
void Transfer<Dim, Real, scheme>::set_mean_stress(const V& mean, const Points& particles, Eigen::Index slot,
                                                  ParticleSums<Dim, V>& sums) {
  const V volume = select(at<V>(particles.mass, slot) > V(0), at<V>(particles.volume, slot), V(0));
  const V change = -volume * mean - (sums.volume_stress[0] + sums.volume_stress[1]) / 2;
  for (std::size_t axis = 0; axis < Dim; ++axis) {
    sums.volume_stress[axis] = sums.volume_stress[axis] + change;
  }
}

/// Adds the sums of `count` particles, or layers of them, to their nodes, which are the same for all.
/// The force on a node is -V sigma . grad S; in two dimensions grad S = (S'x Sy, Sx S'y).
template <int Dim, class Real, Scheme scheme>
template <Sends sends, class V, class ReadStencil, class ReadSums>
void Transfer<Dim, Real, scheme>::add(std::size_t count, ReadStencil&& stencil_of, ReadSums&& sums_of,
                                      Place place, Nodes& grid) {
  constexpr std::size_t width = Shape::width;
  constexpr bool force = sends.internal_force || sends.external_force;
  for (std::size_t j = 0; j < (Dim == 1 ? 1 : width); ++j) {
    std::array<V, width> mass{};
    std::array<std::array<V, width>, Dim> momentum{}, nodal_force{};
    for (std::size_t i = 0; i < width; ++i) {
      mass[i] = V(0);
      for (std::size_t a = 0; a < Dim; ++a) momentum[a][i] = nodal_force[a][i] = V(0);
    }
    for (std::size_t k = 0; k < count; ++k) {
      const Stencil<Dim, V, Shape>& stencil = stencil_of(k);
      const ParticleSums<Dim, V>& particle = sums_of(k);
      const V weight_y = Dim == 1 ? V(1) : stencil.weight[Dim - 1][j];
      const V gradient_y = Dim == 1 ? V(0) : stencil.gradient[Dim - 1][j];
      const auto& weight_x = stencil.weight[0];
      const auto& gradient_x = stencil.gradient[0];
      if constexpr (sends.mass) {
        const V in_row = weight_y * particle.mass;
        for (std::size_t i = 0; i < width; ++i) mass[i] = mass[i] + weight_x[i] * in_row;
      }
      for (std::size_t a = 0; a < Dim; ++a) {
        if constexpr (sends.momentum) {
          const V in_row = weight_y * particle.momentum[a];
          for (std::size_t i = 0; i < width; ++i) momentum[a][i] = momentum[a][i] + weight_x[i] * in_row;
        }
        if constexpr (sends.internal_force) {
          const V in_row = weight_y * particle.volume_stress[a == 0 ? 0 : 3];
          for (std::size_t i = 0; i < width; ++i)
            nodal_force[a][i] = nodal_force[a][i] + gradient_x[i] * in_row;
        }
        if constexpr (force && !(Dim == 1 && !sends.external_force)) {
          V in_row(0);
          if constexpr (sends.internal_force && Dim == 2)
            in_row = gradient_y * particle.volume_stress[a == 0 ? 3 : 1];
          if constexpr (sends.external_force) in_row = in_row + weight_y * particle.external_force[a];
          for (std::size_t i = 0; i < width; ++i)
            nodal_force[a][i] = nodal_force[a][i] + weight_x[i] * in_row;
        }
      }
    }
    const Eigen::Index row = place.first + static_cast<Eigen::Index>(j) * place.row_stride;
    if constexpr (sends.mass) add_to_nodes(mass, &grid.mass[row]);
    for (std::size_t a = 0; a < Dim; ++a) {
      if constexpr (sends.momentum) add_to_nodes(momentum[a], &grid.momentum[a][row]);
      if constexpr (force) add_to_nodes(nodal_force[a], &grid.force[a][row]);
    }
  }
}

/// The i-th sums belong to the i-th node of each lane, which is node lane + i: they move up by i lanes, all
/// that are further up together, one lane at a time.
template <int Dim, class Real, Scheme scheme>
void Transfer<Dim, Real, scheme>::add_to_nodes(const std::array<Value, Shape::width>& sums, Real* nodes) {
  if constexpr (lanes >= Shape::width) {
    const Value zero(0);
    Value here = sums.back(), beyond = zero;
    for (std::size_t i = sums.size() - 1; i-- > 0;) {
      beyond = moved_up<1>(here, beyond);
      here = moved_up<1>(zero, here) + sums[i];
    }
    store(load<Value>(nodes) + here, nodes);
    store(load<Value>(nodes + lanes) + beyond, nodes + lanes);
  } else {
    for (std::size_t i = 0; i < sums.size(); ++i) store(load<Value>(nodes + i) + sums[i], nodes + i);
  }
}

template <int Dim, class Real, Scheme scheme>
template <Sends sends>
void Transfer<Dim, Real, scheme>::scatter(const Points& particles, const Block& block, const Layers& layers,
                                          std::size_t count, Nodes& grid,
                                          const CellAverage<Dim, Real>* mean_stress) {
  std::array<ParticleSums<Dim, Value>, layers_at_once> sums;
  for (std::size_t k = 0; k < count; ++k) {
    sums[k] = read<sends, Value>(particles, layers[k].slot);
    if constexpr (Dim == 2 && sends.internal_force) {
      if (mean_stress != nullptr) {
        const Value mean = mean_stress->template mean<Value>(cell_of(block, grid));
        set_mean_stress(mean, particles, layers[k].slot, sums[k]);
      }
    }
    if (!layers[k].has_strays) continue;
    for_each_stray(particles, grid, block, layers[k].slot, [&](int lane) {
      Stencil<Dim, Real, Shape> stencil;
      const Eigen::Index slot = layers[k].slot + lane;
      const Place place = weigh_alone(particles, grid, slot, stencil);
      auto alone = read<sends, Real>(particles, slot);
      if constexpr (Dim == 2 && sends.internal_force) {
        if (mean_stress != nullptr) {
          const Real mean = mean_stress->template mean<Real>(cell_of_stray(particles, grid, slot));
          set_mean_stress(mean, particles, slot, alone);
        }
      }
      add<sends, Real>(
          1, [&](std::size_t) -> auto& { return stencil; }, [&](std::size_t) -> auto& { return alone; },
          place, grid);
      if constexpr (sends.mass) set_lane(sums[k].mass, lane, Real(0));
      for (std::size_t a = 0; a < Dim; ++a) {
        if constexpr (sends.momentum) set_lane(sums[k].momentum[a], lane, Real(0));
        if constexpr (sends.external_force) set_lane(sums[k].external_force[a], lane, Real(0));
      }
      for (std::size_t c = 0; sends.internal_force && c < Points::components; ++c) {
        if (c != 2) set_lane(sums[k].volume_stress[c], lane, Real(0));
      }
    });
  }
  add<sends, Value>(
      count, [&](std::size_t k) -> auto& { return layers[k].weights; },
      [&](std::size_t k) -> auto& { return sums[k]; }, place_of(block, grid), grid);
}

template <int Dim, class Real, Scheme scheme>
template <bool motion, bool gradient, class V>
GridMotion<Dim, V> Transfer<Dim, Real, scheme>::see(const Nodes& grid, Place place,
                                                    const Stencil<Dim, V, Shape>& stencil) {
  GridMotion<Dim, V> seen;
  for (std::size_t a = 0; a < Dim; ++a) {
    seen.velocity[a] = seen.acceleration[a] = V(0);
    for (std::size_t axis = 0; axis < Dim; ++axis) seen.gradient[a][axis] = V(0);
  }
  for (std::size_t j = 0; j < (Dim == 1 ? 1 : Shape::width); ++j) {
    const Eigen::Index row = place.first + static_cast<Eigen::Index>(j) * place.row_stride;
    const V weight_y = Dim == 1 ? V(1) : stencil.weight[Dim - 1][j];
    const V gradient_y = Dim == 1 ? V(0) : stencil.gradient[Dim - 1][j];
    for (std::size_t a = 0; a < Dim; ++a) {
      V velocity(0), slope(0), acceleration(0);
      for (std::size_t i = 0; i < Shape::width; ++i) {
        const V nodal = load<V>(&grid.velocity[a][row] + i);
        velocity = velocity + stencil.weight[0][i] * nodal;
        if constexpr (gradient) slope = slope + stencil.gradient[0][i] * nodal;
        if constexpr (motion) {
          acceleration = acceleration + stencil.weight[0][i] * load<V>(&grid.acceleration[a][row] + i);
        }
      }
      if constexpr (motion) {
        seen.velocity[a] = seen.velocity[a] + weight_y * velocity;
        seen.acceleration[a] = seen.acceleration[a] + weight_y * acceleration;
      }
      if constexpr (gradient) {
        seen.gradient[a][0] = seen.gradient[a][0] + weight_y * slope;
        if constexpr (Dim == 2) seen.gradient[a][1] = seen.gradient[a][1] + gradient_y * velocity;
      }
    }
  }
  return seen;
}

template <int Dim, class Real, Scheme scheme>
template <bool motion, bool gradient>
auto Transfer<Dim, Real, scheme>::gather(const Points& particles, const Nodes& grid, const Block& block,
                                         const Layer& layer) -> GridMotion<Dim, Value> {
  GridMotion<Dim, Value> seen = see<motion, gradient, Value>(grid, place_of(block, grid), layer.weights);
  if (!layer.has_strays) return seen;
  for_each_stray(particles, grid, block, layer.slot, [&](int lane) {
    Stencil<Dim, Real, Shape> stencil;
    const Place place = weigh_alone(particles, grid, layer.slot + lane, stencil);
    const GridMotion<Dim, Real> alone = see<motion, gradient, Real>(grid, place, stencil);
    for (std::size_t a = 0; a < Dim; ++a) {
      set_lane(seen.velocity[a], lane, alone.velocity[a]);
      set_lane(seen.acceleration[a], lane, alone.acceleration[a]);
      for (std::size_t axis = 0; axis < Dim; ++axis) {
        set_lane(seen.gradient[a][axis], lane, alone.gradient[a][axis]);
      }
    }
  });
  return seen;
}

template <int Dim, class Real, Scheme scheme>
template <class V>
auto Transfer<Dim, Real, scheme>::change_by_light_nodes(const Points& particles, const Nodes& grid, Eigen::Index slot,
                                                        Place place, const Stencil<Dim, V, Shape>& stencil,
                                                        const LightNodes& light, const Vector<Dim, V>& acceleration)
    -> std::array<Vector<Dim, V>, Dim> {
  const V full = light.fraction * at<V>(particles.mass, slot);
  const V over_full = V(1) / select(full > V(0), full, V(1));
  std::array<Vector<Dim, V>, Dim> change;
  for (Vector<Dim, V>& row : change) row.fill(V(0));
  for (std::size_t j = 0; j < (Dim == 1 ? 1 : Shape::width); ++j) {
    const Eigen::Index row = place.first + static_cast<Eigen::Index>(j) * place.row_stride;
    for (std::size_t i = 0; i < Shape::width; ++i) {
      for (std::size_t a = 0; a < Dim; ++a) {
        const V mass = load<V>(&grid.strain_mass[a][row] + i);
        const auto is_light = mass < full;
        const V lag = light.time_step * (V(1) - mass * over_full) *
                      (acceleration[a] - load<V>(&grid.acceleration[a][row] + i));
        const V own = select(mass > V(light.empty_mass), V(0), at<V>(particles.velocity[a], slot));
        const V velocity = select(is_light, lag + own, V(0));
        const V weight_y = Dim == 1 ? V(1) : stencil.weight[Dim - 1][j];
        change[a][0] = change[a][0] + stencil.gradient[0][i] * weight_y * velocity;
        if constexpr (Dim == 2)
          change[a][1] = change[a][1] + stencil.weight[0][i] * stencil.gradient[1][j] * velocity;
      }
    }
  }
  return change;
}

template <int Dim, class Real, Scheme scheme>
void Transfer<Dim, Real, scheme>::slow_light_nodes(const Points& particles, const Nodes& grid, const Block& block,
                                                   const Layer& layer, const LightNodes& light,
                                                   GridMotion<Dim, Value>& seen) {
  const Value full = light.fraction * at<Value>(particles.mass, layer.slot);
  const Place place = place_of(block, grid);
  if (!layer.has_strays) {  // most particles have no light node
    auto is_any_light = Value(0) > Value(0);
    for (std::size_t j = 0; j < (Dim == 1 ? 1 : Shape::width); ++j) {
      const Eigen::Index row = place.first + static_cast<Eigen::Index>(j) * place.row_stride;
      for (std::size_t i = 0; i < Shape::width; ++i)
        is_any_light = is_any_light || load<Value>(&grid.mass[row] + i) < full;
    }
    if (!any(is_any_light)) return;
  }
  auto change = change_by_light_nodes<Value>(particles, grid, layer.slot, place, layer.weights, light,
                                             seen.acceleration);
  if (layer.has_strays) {
    for_each_stray(particles, grid, block, layer.slot, [&](int lane) {
      Stencil<Dim, Real, Shape> stencil;
      const Eigen::Index slot = layer.slot + lane;
      const Place alone = weigh_alone(particles, grid, slot, stencil);
      Vector<Dim, Real> acceleration;
      for (std::size_t a = 0; a < Dim; ++a) acceleration[a] = lane_of<Real>(seen.acceleration[a], lane);
      const auto own = change_by_light_nodes<Real>(particles, grid, slot, alone, stencil, light, acceleration);
      for (std::size_t a = 0; a < Dim; ++a) {
        for (std::size_t axis = 0; axis < Dim; ++axis) set_lane(change[a][axis], lane, own[a][axis]);
      }
    });
  }
  for (std::size_t a = 0; a < Dim; ++a) {
    for (std::size_t axis = 0; axis < Dim; ++axis)
      seen.gradient[a][axis] = seen.gradient[a][axis] + change[a][axis];
  }
}

template <int Dim, class Real, Scheme scheme>
StencilFault Transfer<Dim, Real, scheme>::fault_of(const Points& particles, const Nodes& grid,
                                                   Eigen::Index slot) {
  for (std::size_t axis = 0; axis < Dim; ++axis) {
    const Real x = in_cells(grid, particles.position[axis][slot], axis);
    const Real last = static_cast<Real>(grid.nodes(static_cast<int>(axis)) - 1 - Nodes::ghost_layers);
    // Written so that a value that is not a number fails too.
    if (!(x >= Real(Nodes::ghost_layers) && x <= last)) {
      return std::isfinite(x) ? StencilFault::outside_grid : StencilFault::not_finite;
    }
    if constexpr (SchemeTraits<scheme>::has_domain) {
      if (!(particles.half_size[axis][slot] * grid.cells_per_length() <= 1))
        return StencilFault::domain_too_large;
    }
  }
  if (!(particles.volume[slot] > 0)) {
    return std::isfinite(particles.volume[slot]) ? StencilFault::inverted : StencilFault::not_finite;
  }
  return StencilFault::none;
}

template <int Dim, class Real, Scheme scheme>
std::size_t Transfer<Dim, Real, scheme>::axis_at_fault(const Points& particles, const Nodes& grid, Eigen::Index slot) {
  for (std::size_t axis = 0; axis < Dim; ++axis) {
    const Real x = in_cells(grid, particles.position[axis][slot], axis);
    const Real last = static_cast<Real>(grid.nodes(static_cast<int>(axis)) - 1 - Nodes::ghost_layers);
    bool is_good = x >= Real(Nodes::ghost_layers) && x <= last;
    if constexpr (SchemeTraits<scheme>::has_domain)
      is_good = is_good && particles.half_size[axis][slot] * grid.cells_per_length() <= 1;
    if (!is_good) return axis;
  }
  return 0;
}

template <int Dim, class Real, Scheme scheme>
auto Transfer<Dim, Real, scheme>::find_fault(const Points& particles, const Nodes& grid) -> Fault {
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const Eigen::Index slot = particles.slot_of[static_cast<std::size_t>(p)];
    const StencilFault kind = fault_of(particles, grid, slot);
    if (kind == StencilFault::none) {
      for (const auto& fields : {std::span<const Field<Real>>(particles.stress),
                                 std::span<const Field<Real>>(particles.velocity)}) {
        for (const Field<Real>& field : fields) {
          if (!std::isfinite(field[slot]))
            return {StencilFault::not_finite, p, static_cast<double>(field[slot])};
        }
      }
      continue;
    }
    const std::size_t axis = axis_at_fault(particles, grid, slot);
    Real value = particles.volume[slot];
    if (kind == StencilFault::domain_too_large) value = particles.half_size[axis][slot];
    if (kind == StencilFault::outside_grid || kind == StencilFault::not_finite)
      value = particles.position[axis][slot];
    return {kind, p, static_cast<double>(value), axis};
  }
  return {};
}

template <int Dim, class Real, Scheme scheme>
double Transfer<Dim, Real, scheme>::unbalanced_force(const Points& particles, const Nodes& grid,
                                                     Real empty_mass) {
  double sum = 0.0;
  for (const Eigen::Index slot : particles.slot_of) {
    if (fault_of(particles, grid, slot) != StencilFault::none) continue;
    Stencil<Dim, Real, Shape> stencil;
    const Place place = weigh_alone(particles, grid, slot, stencil);
    Vector<Dim, Real> acceleration{};
    for (std::size_t j = 0; j < (Dim == 1 ? 1 : Shape::width); ++j) {
      for (std::size_t i = 0; i < Shape::width; ++i) {
        const Eigen::Index node =
            place.first + static_cast<Eigen::Index>(j) * place.row_stride + static_cast<Eigen::Index>(i);
        if (!(grid.mass[node] > empty_mass)) continue;
        const Real weight = stencil.weight[0][i] * (Dim == 1 ? Real(1) : stencil.weight[Dim - 1][j]);
        for (std::size_t a = 0; a < Dim; ++a)
          acceleration[a] += weight * (grid.force[a][node] / grid.mass[node]);
      }
    }
    for (Real component : acceleration) {
      sum += static_cast<double>(particles.mass[slot] * std::abs(component));
    }
  }
  return sum;
}

}  // namespace mpm
