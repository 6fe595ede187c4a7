#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "solver/grid.hpp"
#include "solver/particles.hpp"
#include "solver/shape_functions.hpp"

namespace mpm {

/// The weights and weight gradients of one particle along each axis, gradients per metre.
/// Their products over the axes are the values at the particle's nodes.
template <int Dim, class Real, class Shape>
struct Stencil {
  std::array<std::array<Real, Shape::width>, Dim> weight;    ///< [-]
  std::array<std::array<Real, Shape::width>, Dim> gradient;  ///< [1/m]
  std::int32_t first_node;                                   ///< index into the grid's node arrays
};

/// Why a particle cannot be given a stencil, if it cannot.
enum class StencilFault { none, not_finite, inverted, outside_grid, domain_too_large };

/// The only loops over particles and their nodes. The stencils are made once a step, by `weigh`.
template <int Dim, class Real, Scheme scheme>
class Transfer {
 public:
  using Shape = typename SchemeTraits<scheme>::Shape;
  using Points = Particles<Dim, Real>;
  using Nodes = Grid<Dim, Real>;

  explicit Transfer(const Points& particles)
      : stencils_(static_cast<std::size_t>(particles.count())), cell_(stencils_.size(), -1) {}

  /// Makes the stencils of all particles and counts the centres that changed cell.
  /// False if a particle cannot have one; the stencils are then of no use and `find_fault` says why.
  bool weigh(const Points& particles, const Nodes& grid);

  /// The first particle that cannot have a stencil, or whose stress or velocity is not finite; why; and its
  /// offending value in SI units.
  struct Fault {
    StencilFault kind = StencilFault::none;
    Eigen::Index particle = -1;
    double value = 0.0;
  };
  static Fault find_fault(const Points& particles, const Nodes& grid);

  /// Adds mass and momentum to the grid [Kiriyama15, Eqs. 1 and 9].
  void scatter_mass_and_momentum(const Points& particles, Nodes& grid) const;
  /// Adds momentum alone: the second mapping of MUSL.
  void scatter_momentum(const Points& particles, Nodes& grid) const;
  /// Adds the internal force [Kiriyama15, Eq. 2].
  void scatter_internal_force(const Points& particles, Nodes& grid) const;
  /// Adds the particles' external forces, of a scene that has them [Kiriyama15, Eq. 3].
  void scatter_external_force(const Points& particles, Nodes& grid) const;
  /// Adds mass, momentum and internal force in one pass.
  void scatter_all(const Points& particles, Nodes& grid) const;

  /// Moves the particles with the grid [Kiriyama15, Eqs. 5 to 8]; `flip` blends the velocity update from
  /// 0 (PIC, the grid's velocity) to 1 (FLIP, the grid's acceleration).
  void gather_motion(const Nodes& grid, Real time_step, Real flip, Points& particles) const;
  /// Strain increments from the grid's velocity [Kiriyama15, Eq. 10a], and half sizes for cpGIMP [Eq. 14].
  void gather_strain(const Nodes& grid, Real time_step, Points& particles) const;
  /// Rotations from the grid's velocity: half its curl times the time step.
  void gather_rotation(const Nodes& grid, Real time_step, Points& particles) const requires(Dim == 2);

  /// Sum over the particles of |mass * unbalanced acceleration of the grid at the particle| [N]: the part of
  /// the unbalanced nodal force that the particles can feel. A pattern of nodal forces whose accelerations
  /// cancel at every particle moves nothing, so it does not keep a model from being at rest.
  double unbalanced_force(const Points& particles, const Nodes& grid, Real empty_mass) const;

  std::int64_t cell_crossings() const { return cell_crossings_; }

 private:
  static StencilFault fault_of(const Points& particles, const Nodes& grid, Eigen::Index p);

  /// Calls `visit(node index, weight, gradient)` for each node of a particle.
  template <class Visit>
  static void for_each_node(const Stencil<Dim, Real, Shape>& stencil, std::int32_t row_stride,
                            Visit&& visit) {
    if constexpr (Dim == 1) {
      for (std::size_t i = 0; i < Shape::width; ++i) {
        visit(static_cast<std::size_t>(stencil.first_node) + i, stencil.weight[0][i],
              Vector<1, Real>{stencil.gradient[0][i]});
      }
    } else {
      for (std::size_t j = 0; j < Shape::width; ++j) {
        const std::size_t row =
            static_cast<std::size_t>(stencil.first_node) + j * static_cast<std::size_t>(row_stride);
        for (std::size_t i = 0; i < Shape::width; ++i) {
          visit(row + i, stencil.weight[0][i] * stencil.weight[1][j],
                Vector<2, Real>{stencil.gradient[0][i] * stencil.weight[1][j],
                                stencil.weight[0][i] * stencil.gradient[1][j]});
        }
      }
    }
  }

  template <bool mass_and_momentum, bool internal_force>
  void scatter(const Points& particles, Nodes& grid) const;

  std::vector<Stencil<Dim, Real, Shape>> stencils_;
  std::vector<std::int32_t> cell_;  ///< of each particle's centre at the last weighing
  std::int64_t cell_crossings_ = 0;
};

template <int Dim, class Real, Scheme scheme>
StencilFault Transfer<Dim, Real, scheme>::fault_of(const Points& particles, const Nodes& grid,
                                                   Eigen::Index p) {
  for (std::size_t axis = 0; axis < Dim; ++axis) {
    const Real x =
        (particles.position[axis][p] - grid.origin(static_cast<int>(axis))) * grid.cells_per_length();
    const Real last = static_cast<Real>(grid.nodes(static_cast<int>(axis)) - 1 - Nodes::ghost_layers);
    // Written so that a value that is not a number fails too.
    if (!(x >= Real(Nodes::ghost_layers) && x <= last)) {
      return std::isfinite(x) ? StencilFault::outside_grid : StencilFault::not_finite;
    }
    if constexpr (SchemeTraits<scheme>::has_domain) {
      if (!(particles.half_size[axis][p] * grid.cells_per_length() <= 1))
        return StencilFault::domain_too_large;
    }
  }
  if (!(particles.volume[p] > 0)) {
    return std::isfinite(particles.volume[p]) ? StencilFault::inverted : StencilFault::not_finite;
  }
  return StencilFault::none;
}

template <int Dim, class Real, Scheme scheme>
auto Transfer<Dim, Real, scheme>::find_fault(const Points& particles, const Nodes& grid) -> Fault {
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const StencilFault kind = fault_of(particles, grid, p);
    if (kind == StencilFault::none) {
      for (const auto& fields : {std::span<const Field<Real>>(particles.stress),
                                 std::span<const Field<Real>>(particles.velocity)}) {
        for (const Field<Real>& field : fields) {
          if (!std::isfinite(field[p])) return {StencilFault::not_finite, p, static_cast<double>(field[p])};
        }
      }
      continue;
    }
    Real value = particles.volume[p];
    if (kind == StencilFault::domain_too_large) value = particles.half_size[0][p];
    if (kind == StencilFault::outside_grid || kind == StencilFault::not_finite)
      value = particles.position[0][p];
    return {kind, p, static_cast<double>(value)};
  }
  return {};
}

template <int Dim, class Real, Scheme scheme>
bool Transfer<Dim, Real, scheme>::weigh(const Points& particles, const Nodes& grid) {
  const Real per_length = grid.cells_per_length();
  std::int64_t crossings = 0;
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    if (fault_of(particles, grid, p) != StencilFault::none) return false;
    Stencil<Dim, Real, Shape>& stencil = stencils_[static_cast<std::size_t>(p)];
    std::int32_t first_node = 0, cell = 0;
    for (int axis = Dim - 1; axis >= 0; --axis) {
      const std::size_t a = static_cast<std::size_t>(axis);
      const Real position = (particles.position[a][p] - grid.origin(axis)) * per_length;
      const Real half_size =
          SchemeTraits<scheme>::has_domain ? particles.half_size[a][p] * per_length : Real(0);
      const std::int32_t first = Shape::first_node(position, half_size);
      Shape::evaluate(position, half_size, first, stencil.weight[a], stencil.gradient[a]);
      for (Real& gradient : stencil.gradient[a]) gradient *= per_length;
      first_node = first_node * (axis == Dim - 1 ? 0 : grid.nodes(0)) + first;
      cell = cell * (axis == Dim - 1 ? 0 : grid.nodes(0)) + static_cast<std::int32_t>(position);
    }
    stencil.first_node = first_node;
    std::int32_t& last_cell = cell_[static_cast<std::size_t>(p)];
    crossings += (last_cell >= 0) & (last_cell != cell);
    last_cell = cell;
  }
  cell_crossings_ += crossings;
  return true;
}

template <int Dim, class Real, Scheme scheme>
template <bool mass_and_momentum, bool internal_force>
void Transfer<Dim, Real, scheme>::scatter(const Points& particles, Nodes& grid) const {
  const std::int32_t row_stride = grid.row_stride();
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const Real mass = particles.mass[p];
    Vector<Dim, Real> momentum;
    for (std::size_t a = 0; a < Dim; ++a) momentum[a] = mass * particles.velocity[a][p];
    SymmetricTensor<Dim, Real> minus_volume_stress;
    for (std::size_t c = 0; c < Points::components; ++c) {
      minus_volume_stress[c] = -particles.volume[p] * particles.stress[c][p];
    }
    for_each_node(stencils_[static_cast<std::size_t>(p)], row_stride,
                  [&](std::size_t i, Real weight, const Vector<Dim, Real>& gradient) {
                    NodeSums<Dim, Real>& node = grid.sums[i];
                    if constexpr (mass_and_momentum) {
                      node.mass += weight * mass;
                      for (std::size_t a = 0; a < Dim; ++a) node.momentum[a] += weight * momentum[a];
                    }
                    if constexpr (internal_force) {
                      const Vector<Dim, Real> force = contract<Dim, Real>(minus_volume_stress, gradient);
                      for (std::size_t a = 0; a < Dim; ++a) node.force[a] += force[a];
                    }
                  });
  }
}

template <int Dim, class Real, Scheme scheme>
void Transfer<Dim, Real, scheme>::scatter_mass_and_momentum(const Points& particles, Nodes& grid) const {
  scatter<true, false>(particles, grid);
}
template <int Dim, class Real, Scheme scheme>
void Transfer<Dim, Real, scheme>::scatter_internal_force(const Points& particles, Nodes& grid) const {
  scatter<false, true>(particles, grid);
}
template <int Dim, class Real, Scheme scheme>
void Transfer<Dim, Real, scheme>::scatter_all(const Points& particles, Nodes& grid) const {
  scatter<true, true>(particles, grid);
}

template <int Dim, class Real, Scheme scheme>
void Transfer<Dim, Real, scheme>::scatter_external_force(const Points& particles, Nodes& grid) const {
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    Vector<Dim, Real> force;
    for (std::size_t a = 0; a < Dim; ++a) force[a] = particles.external_force[a][p];
    for_each_node(stencils_[static_cast<std::size_t>(p)], grid.row_stride(),
                  [&](std::size_t i, Real weight, const Vector<Dim, Real>&) {
                    for (std::size_t a = 0; a < Dim; ++a) grid.sums[i].force[a] += weight * force[a];
                  });
  }
}

template <int Dim, class Real, Scheme scheme>
void Transfer<Dim, Real, scheme>::scatter_momentum(const Points& particles, Nodes& grid) const {
  for (NodeSums<Dim, Real>& node : grid.sums) node.momentum = {};
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    Vector<Dim, Real> momentum;
    for (std::size_t a = 0; a < Dim; ++a) momentum[a] = particles.mass[p] * particles.velocity[a][p];
    for_each_node(stencils_[static_cast<std::size_t>(p)], grid.row_stride(),
                  [&](std::size_t i, Real weight, const Vector<Dim, Real>&) {
                    for (std::size_t a = 0; a < Dim; ++a) grid.sums[i].momentum[a] += weight * momentum[a];
                  });
  }
}

template <int Dim, class Real, Scheme scheme>
void Transfer<Dim, Real, scheme>::gather_motion(const Nodes& grid, Real time_step, Real flip,
                                                Points& particles) const {
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    Vector<Dim, Real> velocity{}, acceleration{};
    for_each_node(stencils_[static_cast<std::size_t>(p)], grid.row_stride(),
                  [&](std::size_t i, Real weight, const Vector<Dim, Real>&) {
                    for (std::size_t a = 0; a < Dim; ++a) {
                      velocity[a] += weight * grid.motion[i].velocity[a];
                      acceleration[a] += weight * grid.motion[i].acceleration[a];
                    }
                  });
    for (std::size_t a = 0; a < Dim; ++a) {
      const Real flip_velocity = particles.velocity[a][p] + time_step * acceleration[a];
      particles.velocity[a][p] = velocity[a] + flip * (flip_velocity - velocity[a]);
      particles.position[a][p] += time_step * velocity[a];
      particles.displacement[a][p] += time_step * velocity[a];
    }
  }
}

template <int Dim, class Real, Scheme scheme>
void Transfer<Dim, Real, scheme>::gather_strain(const Nodes& grid, Real time_step, Points& particles) const {
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    SymmetricTensor<Dim, Real> rate{};
    for_each_node(stencils_[static_cast<std::size_t>(p)], grid.row_stride(),
                  [&](std::size_t i, Real, const Vector<Dim, Real>& gradient) {
                    add_symmetric_product<Dim, Real>(grid.motion[i].velocity, gradient, rate);
                  });
    for (std::size_t c = 0; c < Points::components; ++c)
      particles.strain_increment[c][p] = time_step * rate[c];
    if constexpr (SchemeTraits<scheme>::updates_half_size) {
      for (std::size_t a = 0; a < Dim; ++a) particles.half_size[a][p] *= 1 + particles.strain_increment[a][p];
    }
  }
}

template <int Dim, class Real, Scheme scheme>
double Transfer<Dim, Real, scheme>::unbalanced_force(const Points& particles, const Nodes& grid,
                                                     Real empty_mass) const {
  double sum = 0.0;
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    Vector<Dim, Real> acceleration{};
    for_each_node(stencils_[static_cast<std::size_t>(p)], grid.row_stride(),
                  [&](std::size_t i, Real weight, const Vector<Dim, Real>&) {
                    const NodeSums<Dim, Real>& node = grid.sums[i];
                    if (!(node.mass > empty_mass)) return;
                    for (std::size_t a = 0; a < Dim; ++a)
                      acceleration[a] += weight * (node.force[a] / node.mass);
                  });
    for (Real component : acceleration) sum += static_cast<double>(particles.mass[p] * std::abs(component));
  }
  return sum;
}

template <int Dim, class Real, Scheme scheme>
void Transfer<Dim, Real, scheme>::gather_rotation(const Nodes& grid, Real time_step, Points& particles) const
    requires(Dim == 2) {
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    Real curl = 0;
    for_each_node(stencils_[static_cast<std::size_t>(p)], grid.row_stride(),
                  [&](std::size_t i, Real, const Vector<Dim, Real>& gradient) {
                    const Vector<Dim, Real>& velocity = grid.motion[i].velocity;
                    curl += velocity[1] * gradient[0] - velocity[0] * gradient[1];
                  });
    particles.rotation[p] = time_step * curl / 2;
  }
}

}  // namespace mpm
