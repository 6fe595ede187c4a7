#pragma once

#include <cmath>
#include <limits>

#include "solver/grid.hpp"

namespace mpm {

/// Nodes with less than this fraction of the mean particle mass count as empty: their weights are round-off
/// (a weight is a difference of numbers up to 1, divided by the domain), so their motion would be noise.
template <class Real>
inline constexpr Real empty_node_mass_ratio = 64 * std::numeric_limits<Real>::epsilon();

/// Edge conditions of a grid as ranges of constrained nodes: an edge's own nodes and the ghosts beyond it.
template <int Dim, class Real>
class EdgeConditions {
 public:
  EdgeConditions(const Scene& scene, const Grid<Dim, Real>& grid) {
    for (int axis = 0; axis < Dim; ++axis) {
      for (int side = 0; side < 2; ++side) {
        const Condition condition =
            scene.edges[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)];
        if (condition == Condition::free) continue;
        constrain(grid, axis, side, condition == Condition::fixed);
      }
    }
  }

  /// Removes momentum and force of the constrained components.
  void apply(Grid<Dim, Real>& grid) const {
    for (const Constraint& constraint : constraints_) {
      NodeSums<Dim, Real>& node = grid.sums[constraint.node];
      node.momentum[constraint.axis] = 0;
      node.force[constraint.axis] = 0;
    }
  }

 private:
  struct Constraint {
    std::uint32_t node;
    std::uint32_t axis;
  };

  void constrain(const Grid<Dim, Real>& grid, int axis, int side, bool all_components) {
    const std::int32_t depth = Grid<Dim, Real>::ghost_layers + 1;
    const std::int32_t begin = side == 0 ? 0 : grid.nodes(axis) - depth;
    const std::int32_t across = Dim == 1 ? 1 : grid.nodes(1 - axis);
    for (std::int32_t along = begin; along < begin + depth; ++along) {
      for (std::int32_t k = 0; k < across; ++k) {
        const std::int32_t node = Dim == 1    ? along
                                  : axis == 0 ? along + k * grid.row_stride()
                                              : k + along * grid.row_stride();
        for (int component = 0; component < Dim; ++component) {
          if (component != axis && !all_components) continue;
          constraints_.push_back({static_cast<std::uint32_t>(node), static_cast<std::uint32_t>(component)});
        }
      }
    }
  }

  std::vector<Constraint> constraints_;
};

/// Nodal velocity from momentum [Kiriyama15, Eq. 9]; zero at empty nodes.
template <int Dim, class Real>
void set_velocity(Grid<Dim, Real>& grid, Real empty_mass) {
  for (std::size_t i = 0; i < grid.sums.size(); ++i) {
    const Real over_mass = grid.sums[i].mass > empty_mass ? 1 / grid.sums[i].mass : Real(0);
    for (std::size_t a = 0; a < Dim; ++a) grid.motion[i].velocity[a] = grid.sums[i].momentum[a] * over_mass;
  }
}

/// Adds gravity to the nodal force [Kiriyama15, Eq. 3], so that it becomes the unbalanced force.
template <int Dim, class Real>
void add_gravity(Grid<Dim, Real>& grid, const Vector<Dim, Real>& gravity) {
  for (NodeSums<Dim, Real>& node : grid.sums) {
    for (std::size_t a = 0; a < Dim; ++a) node.force[a] += node.mass * gravity[a];
  }
}

/// Nodal acceleration and updated velocity [Kiriyama15, Eq. 4]. Cundall's local damping [Cundall87] takes
/// `damping` times |unbalanced force| against the motion; `damped` leaves it out at compile time.
/// The motion is that of the undamped step, not of its start: with the old velocity a node that the step
/// turns round is pushed on instead of held back, and alternates about zero for ever.
template <bool damped, int Dim, class Real>
void accelerate(Grid<Dim, Real>& grid, Real time_step, Real damping, Real empty_mass) {
  for (std::size_t i = 0; i < grid.sums.size(); ++i) {
    const NodeSums<Dim, Real>& node = grid.sums[i];
    NodeMotion<Dim, Real>& motion = grid.motion[i];
    const Real over_mass = node.mass > empty_mass ? 1 / node.mass : Real(0);
    for (std::size_t a = 0; a < Dim; ++a) {
      const Real velocity = node.momentum[a] * over_mass;
      Real force = node.force[a];
      if constexpr (damped) {
        const Real undamped = velocity + time_step * force * over_mass;
        const Real against = undamped > 0 ? Real(-1) : undamped < 0 ? Real(1) : Real(0);
        force += against * damping * std::abs(force);
      }
      motion.acceleration[a] = force * over_mass;
      motion.velocity[a] = velocity + time_step * motion.acceleration[a];
    }
  }
}

}  // namespace mpm
