#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "solver/grid.hpp"
#include "solver/lanes.hpp"

namespace mpm {

/// Edge conditions of a grid as ranges of constrained nodes: an edge's own nodes and the ghosts beyond it.
template <int Dim, class Real>
class EdgeConditions {
 public:
  EdgeConditions(const Scene& scene, const Grid<Dim, Real>& grid) {
    for (int axis = 0; axis < Dim; ++axis) {
      for (int side = 0; side < 2; ++side) {
        const Condition condition =
            scene.edges[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)];
        if (condition != Condition::free) constrain(grid, axis, side, condition == Condition::fixed);
      }
    }
  }

  /// Removes momentum and force of the constrained components in some rows.
  void apply(Grid<Dim, Real>& grid, Rows rows) const {
    for_each_stretch(grid, rows, [&](std::size_t component, Eigen::Index first, Eigen::Index count) {
      grid.momentum[component].segment(first, count).setZero();
      grid.force[component].segment(first, count).setZero();
    });
  }

  /// Sets the mass by which nodes count as light, in some rows.
  void set_strain_mass(Grid<Dim, Real>& grid, Rows rows) const {
    const auto [begin, nodes] = grid.place_of(rows);
    for (Field<Real>& mass : grid.strain_mass) mass.segment(begin, nodes) = grid.mass.segment(begin, nodes);
    for_each_stretch(grid, rows, [&](std::size_t component, Eigen::Index first, Eigen::Index count) {
      grid.strain_mass[component].segment(first, count).setConstant(std::numeric_limits<Real>::max());
    });
  }

 private:
  /// One component at `count` nodes from `first` on, in each of some rows.
  struct Constraint {
    std::size_t component;
    Rows rows;
    Eigen::Index first, count;
  };

  /// Calls `visit(component, first node, count)` for the constrained nodes in some rows.
  template <class Visit>
  void for_each_stretch(const Grid<Dim, Real>& grid, Rows rows, Visit&& visit) const {
    for (const Constraint& constraint : constraints_) {
      const std::int32_t last = std::min(rows.end, constraint.rows.end);
      for (std::int32_t row = std::max(rows.begin, constraint.rows.begin); row < last; ++row) {
        visit(constraint.component, Eigen::Index(row) * grid.row_stride() + constraint.first, constraint.count);
      }
    }
  }

  void constrain(const Grid<Dim, Real>& grid, int axis, int side, bool all_components) {
    const std::int32_t depth = Grid<Dim, Real>::ghost_layers + 1;
    const std::int32_t begin = side == 0 ? 0 : grid.nodes(axis) - depth;
    for (int component = 0; component < Dim; ++component) {
      if (component != axis && !all_components) continue;
      Constraint constraint{static_cast<std::size_t>(component), {0, grid.rows()}, 0, grid.nodes(0)};
      if (axis == 0) {
        constraint.first = begin;
        constraint.count = depth;
      } else {
        constraint.rows = {begin, begin + depth};
      }
      constraints_.push_back(constraint);
    }
  }

  std::vector<Constraint> constraints_;
};

/// Calls `visit(first node)` for lanes of nodes that cover some rows.
template <int Dim, class Real, class Visit>
void for_each_lanes_of_nodes(const Grid<Dim, Real>& grid, Rows rows, Visit&& visit) {
  const auto [first, count] = grid.place_of(rows);
  for (Eigen::Index i = first; i < first + count; i += lane_count<Real>) visit(i);
}

/// 1 / mass of nodes [1/kg]; zero at empty ones.
template <class Real>
Lanes<Real> one_over(const Lanes<Real>& mass, Real empty_mass) {
  using Value = Lanes<Real>;
  const auto counts = mass > Value(empty_mass);
  return select(counts, 1 / select(counts, mass, Value(1)), Value(0));
}

/// Nodal velocity from momentum [Kiriyama15, Eq. 9]; zero at empty nodes.
template <int Dim, class Real>
void set_velocity(Grid<Dim, Real>& grid, Real empty_mass, Rows rows) {
  using Value = Lanes<Real>;
  for_each_lanes_of_nodes(grid, rows, [&](Eigen::Index i) {
    const Value over_mass = one_over(load<Value>(&grid.mass[i]), empty_mass);
    for (std::size_t a = 0; a < Dim; ++a) {
      store(load<Value>(&grid.momentum[a][i]) * over_mass, &grid.velocity[a][i]);
    }
  });
}

/// Adds gravity to the nodal force [Kiriyama15, Eq. 3], so that it becomes the unbalanced force.
template <int Dim, class Real>
void add_gravity(Grid<Dim, Real>& grid, const Vector<Dim, Real>& gravity, Rows rows) {
  const auto [first, count] = grid.place_of(rows);
  for (std::size_t a = 0; a < Dim; ++a) {
    if (gravity[a] != 0) grid.force[a].segment(first, count) += gravity[a] * grid.mass.segment(first, count);
  }
}

/// Nodal acceleration and updated velocity [Kiriyama15, Eq. 4]. Cundall's local damping [Cundall87] takes
/// `damping` times |unbalanced force| against the motion; `damped` leaves it out at compile time.
/// The motion is that of the undamped step, not of its start: with the old velocity a node that the step
/// turns round is pushed on instead of held back, and alternates about zero for ever.
template <bool damped, int Dim, class Real>
void accelerate(Grid<Dim, Real>& grid, Real time_step, Real damping, Real empty_mass, Rows rows) {
  using Value = Lanes<Real>;
  for_each_lanes_of_nodes(grid, rows, [&](Eigen::Index i) {
    const Value over_mass = one_over(load<Value>(&grid.mass[i]), empty_mass);
    for (std::size_t a = 0; a < Dim; ++a) {
      const Value velocity = load<Value>(&grid.momentum[a][i]) * over_mass;
      Value force = load<Value>(&grid.force[a][i]);
      if constexpr (damped) {
        const Value undamped = velocity + time_step * force * over_mass;
        const Value against =
            select(undamped > Value(0), Value(-1), select(undamped < Value(0), Value(1), Value(0)));
        force = force + against * damping * abs(force);
      }
      const Value acceleration = force * over_mass;
      store(acceleration, &grid.acceleration[a][i]);
      store(velocity + time_step * acceleration, &grid.velocity[a][i]);
    }
  });
}

}  // namespace mpm
