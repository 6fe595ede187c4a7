#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "solver/grid.hpp"
#include "solver/scene.hpp"

namespace mpm {

/// The rigid bodies of a scene at work on the grid: the nodes they hold this step and the velocities these
/// take.
template <int Dim, class Real>
class RigidBodies {
 public:
  RigidBodies(const Scene& scene, const Grid<Dim, Real>& grid, double time_step)
      : bodies_(scene.rigid_bodies), impulses_(bodies_.size()), held_(bodies_.size()), time_step_(time_step) {
    for (std::size_t axis = 0; axis < Dim; ++axis) {
      cell_size_ = scene.cell_size;
      first_node_[axis] = scene.grid_lower[axis] - Grid<Dim, Real>::ghost_layers * scene.cell_size;
      nodes_[axis] = grid.nodes(static_cast<int>(axis));
    }
    row_stride_ = grid.row_stride();
  }

  /// Finds the nodes that the bodies hold during the step that begins at `time` [s].
  void hold(double time) {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const RigidBody& body = bodies_[b];
      Held& held = held_[b];
      const double now = body.travel_time(time), then = body.travel_time(time + time_step_);
      held.fraction = (then - now) / time_step_;
      for (std::size_t axis = 0; axis < Dim; ++axis) {
        const double moved = body.velocity[axis] * now;
        const double first = (body.lower[axis] + moved - first_node_[axis]) / cell_size_;
        const double last = (body.upper[axis] + moved - first_node_[axis]) / cell_size_;
        held.begin[axis] =
            static_cast<std::int32_t>(std::clamp(std::ceil(first - on_node), 0.0, 1.0 * nodes_[axis]));
        held.end[axis] =
            static_cast<std::int32_t>(std::clamp(std::floor(last + on_node) + 1, 0.0, 1.0 * nodes_[axis]));
        held.center[axis] = (first + last) / 2;
      }
    }
  }

  /// Gives the held nodes the velocity of their body instead of what forces would give them, and sums up what
  /// that takes. To follow `mpm::accelerate`.
  void accelerate(Grid<Dim, Real>& grid, Real empty_mass) {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      for_each_held_component(b, [&](std::size_t i, std::size_t a, double velocity) {
        NodeSums<Dim, Real>& node = grid.sums[i];
        grid.motion[i].velocity[a] = static_cast<Real>(velocity);
        if (!(node.mass > empty_mass)) return;
        const double mass = static_cast<double>(node.mass);
        const double change = mass * velocity - static_cast<double>(node.momentum[a]);  // [kg m/s]
        impulses_[b][a] += static_cast<double>(node.force[a]) * time_step_ - change;
        node.force[a] = static_cast<Real>(change / time_step_);
        grid.motion[i].acceleration[a] = static_cast<Real>(change / time_step_ / mass);
      });
    }
  }

  /// Gives the held nodes the velocity of their body. To follow `mpm::set_velocity`.
  void set_velocity(Grid<Dim, Real>& grid) const {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      for_each_held_component(b, [&](std::size_t i, std::size_t a, double velocity) {
        grid.motion[i].velocity[a] = static_cast<Real>(velocity);
      });
    }
  }

  bool empty() const { return bodies_.empty(); }
  /// Of the particles on each body, summed over the steps [N s per unit of the absent dimensions].
  const std::vector<PerAxis>& impulses() const { return impulses_; }

 private:
  /// How far beyond an edge of a body, in cells, a node still counts as on it: round-off of its travel.
  static constexpr double on_node = 1e-6;

  struct Held {
    std::array<std::int32_t, Dim> begin{}, end{};  ///< nodes along each axis
    Vector<Dim, double> center{};                  ///< of the box, in cells from the first node
    double fraction = 0.0;                         ///< of the full velocities, mean over the step
  };

  /// Calls `visit(node, component, velocity)`.
  template <class Visit>
  void for_each_held_component(std::size_t b, Visit&& visit) const {
    const Held& held = held_[b];
    const std::int32_t first_row = Dim == 1 ? 0 : held.begin[Dim - 1];
    const std::int32_t last_row = Dim == 1 ? 1 : held.end[Dim - 1];
    for (std::int32_t j = first_row; j < last_row; ++j) {
      for (std::int32_t i = held.begin[0]; i < held.end[0]; ++i) {
        const std::size_t node = static_cast<std::size_t>(i) + static_cast<std::size_t>(j * row_stride_);
        for (std::size_t a = 0; a < Dim; ++a) {
          if (bodies_[b].constrains[a]) visit(node, a, velocity_of(b, i, j, a));
        }
      }
    }
  }

  double velocity_of(std::size_t b, std::int32_t i, std::int32_t j, std::size_t axis) const {
    const RigidBody& body = bodies_[b];
    double velocity = body.velocity[axis];
    if constexpr (Dim == 2) {
      const Held& held = held_[b];
      const double arm = axis == 0 ? held.center[1] - j : i - held.center[0];
      velocity += body.angular_velocity * arm * cell_size_;
    }
    return held_[b].fraction * velocity;
  }

  std::vector<RigidBody> bodies_;
  std::vector<PerAxis> impulses_;
  std::vector<Held> held_;
  double time_step_, cell_size_ = 0.0;
  Vector<Dim, double> first_node_{};
  std::array<std::int32_t, Dim> nodes_{};
  std::int32_t row_stride_ = 0;
};

}  // namespace mpm
