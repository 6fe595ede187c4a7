#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "solver/grid.hpp"
#include "solver/scene.hpp"

namespace mpm {

/// The rigid bodies of a scene at work on the grid.
///
/// Nodes inside a body take its velocity. The face it moves with, or leaves behind, is usually between two
/// rows of nodes; there the velocity that the grid has on the face, w_in v_in + w_out v_out with the hat
/// functions' weights, takes the body's velocity, by the smallest impulse that does it (in the kinetic energy
/// of the two nodes): lambda w_i on node i, lambda = (v_body - w_in v_in - w_out v_out) / (w_in^2/m_in +
/// w_out^2/m_out). A uniform stress below the face then is in equilibrium with a pressure of the same size on
/// the body, wherever the face is; nodes that jump from free to held as the face passes them are not.
template <int Dim, class Real>
class RigidBodies {
 public:
  RigidBodies(const Scene& scene, const Grid<Dim, Real>& grid, double time_step)
      : bodies_(scene.rigid_bodies),
        impulses_(bodies_.size()),
        held_(bodies_.size()),
        time_step_(time_step),
        cell_size_(scene.cell_size),
        row_stride_(grid.row_stride()) {
    for (std::size_t axis = 0; axis < Dim; ++axis) {
      first_node_[axis] = scene.grid_lower[axis] - Grid<Dim, Real>::ghost_layers * scene.cell_size;
      nodes_[axis] = grid.nodes(static_cast<int>(axis));
    }
  }

  /// Finds the nodes that the bodies hold during the step that begins at `time` [s].
  void hold(double time) {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const RigidBody& body = bodies_[b];
      Held& held = held_[b];
      const double now = body.travel_time(time);
      held.fraction = (body.travel_time(time + time_step_) - now) / time_step_;
      held.faces.fill(Face{});
      for (std::size_t axis = 0; axis < Dim; ++axis) {
        const double moved = body.velocity[axis] * now;
        const double lower = (body.lower[axis] + moved - first_node_[axis]) / cell_size_;
        const double upper = (body.upper[axis] + moved - first_node_[axis]) / cell_size_;
        held.center[axis] = (lower + upper) / 2;
        held.begin[axis] = static_cast<std::int32_t>(std::ceil(lower - on_node));
        held.end[axis] = static_cast<std::int32_t>(std::floor(upper + on_node)) + 1;
        if (body.velocity[axis] != 0.0 && moves_along_one_axis(body)) hold_faces(held, axis, lower, upper);
      }
      for (std::size_t axis = 0; axis < Dim; ++axis) {
        held.begin[axis] = std::clamp(held.begin[axis], 0, nodes_[axis]);
        held.end[axis] = std::clamp(held.end[axis], 0, nodes_[axis]);
      }
    }
  }

  /// Adds to the nodal forces what makes nodes and faces follow their bodies, and sums it up. Between
  /// `add_gravity` and `mpm::accelerate`, so that damping acts on what is left unbalanced.
  void take_up(Grid<Dim, Real>& grid, Real empty_mass) {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const auto velocity_of_node = [&](Eigen::Index i, std::size_t a) {
        return (static_cast<double>(grid.momentum[a][i]) +
                static_cast<double>(grid.force[a][i]) * time_step_) /
               static_cast<double>(grid.mass[i]);
      };
      const auto give = [&](Eigen::Index i, std::size_t a, double impulse) {
        grid.force[a][i] += static_cast<Real>(impulse / time_step_);
        impulses_[b][a] -= impulse;
      };
      for_each_held(b, [&](Eigen::Index i, std::size_t a, double velocity) {
        if (!(grid.mass[i] > empty_mass)) return;
        give(i, a, static_cast<double>(grid.mass[i]) * (velocity - velocity_of_node(i, a)));
      });
      for_each_face(b, [&](const Pair& pair, std::size_t a, double velocity) {
        if (grid.mass[pair.in] > empty_mass)
          pull(grid, empty_mass, pair, a, velocity, velocity_of_node, give);
      });
    }
  }

  /// Gives nodes and faces the velocities of their bodies, and nodes the accelerations that go with them.
  /// What it still changes after `mpm::accelerate` is what damping took, and no reaction.
  void set_motion(Grid<Dim, Real>& grid, Real empty_mass) const {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const auto velocity_of_node = [&](Eigen::Index i, std::size_t a) {
        return static_cast<double>(grid.velocity[a][i]);
      };
      const auto give = [&](Eigen::Index i, std::size_t a, double impulse) {
        const double change = impulse / static_cast<double>(grid.mass[i]);
        grid.velocity[a][i] += static_cast<Real>(change);
        grid.acceleration[a][i] += static_cast<Real>(change / time_step_);
      };
      for_each_held(b, [&](Eigen::Index i, std::size_t a, double velocity) {
        if (grid.mass[i] > empty_mass) {
          grid.acceleration[a][i] += static_cast<Real>((velocity - velocity_of_node(i, a)) / time_step_);
        }
        grid.velocity[a][i] = static_cast<Real>(velocity);
      });
      for_each_face(b, [&](const Pair& pair, std::size_t a, double velocity) {
        if (grid.mass[pair.in] > empty_mass) {
          pull(grid, empty_mass, pair, a, velocity, velocity_of_node, give);
        } else {  // it costs nothing to move
          grid.velocity[a][pair.in] =
              static_cast<Real>((velocity - (1 - pair.weight) * velocity_of_node(pair.out, a)) / pair.weight);
        }
      });
    }
  }

  /// Nodes that the bodies hold, or whose faces they pull, are never light.
  void set_strain_mass(Grid<Dim, Real>& grid) const {
    constexpr Real held = std::numeric_limits<Real>::max();
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      for_each_held(b, [&](Eigen::Index i, std::size_t a, double) { grid.strain_mass[a][i] = held; });
      for_each_face(b, [&](const Pair& pair, std::size_t a, double) {
        grid.strain_mass[a][pair.in] = grid.strain_mass[a][pair.out] = held;
      });
    }
  }

  /// Of the particles on each body, summed over the steps [N s per unit of the absent dimensions].
  const std::vector<PerAxis>& impulses() const { return impulses_; }

 private:
  /// How far beyond an edge of a body, in cells, a node still counts as on it: round-off of its travel.
  static constexpr double on_node = 1e-6;
  /// A face closer than this to the row outside it, in cells, holds that row too: the slab between would be
  /// as stiff as it is thin, and shorten the stable time step. At a quarter it is no stiffer than a cell.
  static constexpr double thinnest_slab = 0.25;

  /// A face between two rows of nodes; no face where `inside` is negative.
  struct Face {
    std::size_t axis = 0;
    std::int32_t inside = -1, outside = -1;  ///< rows along `axis`
    double weight = 1.0;                     ///< of the inside row on the face; 1 minus that is the other's
  };

  struct Held {
    std::array<std::int32_t, Dim> begin{}, end{};  ///< nodes along each axis
    std::array<Face, 2> faces;
    Vector<Dim, double> center{};  ///< of the box, in cells from the first node
    double fraction = 0.0;         ///< of the full velocities, mean over the step
  };

  static bool moves_along_one_axis(const RigidBody& body) {
    const auto moving =
        std::count_if(body.velocity.begin(), body.velocity.end(), [](double v) { return v != 0; });
    return moving == 1 && body.angular_velocity == 0.0;
  }

  /// Places of the two faces along `axis`, in cells from the first node.
  void hold_faces(Held& held, std::size_t axis, double lower, double upper) const {
    held.faces[0] = face_at(axis, held.begin[axis], held.begin[axis] - 1, lower);
    held.faces[1] = face_at(axis, held.end[axis] - 1, held.end[axis], upper);
    for (Face& face : held.faces) {
      const bool at_lower = face.outside < face.inside;
      const bool within =
          std::min(face.inside, face.outside) >= 0 && std::max(face.inside, face.outside) < nodes_[axis];
      if (face.weight > 1 - on_node || !within) {
        face = {};
      } else if (face.weight < thinnest_slab) {
        (at_lower ? held.begin[axis] : held.end[axis]) += at_lower ? -1 : 1;
        face = {};
      } else {
        (at_lower ? held.begin[axis] : held.end[axis]) += at_lower ? 1 : -1;
      }
    }
  }

  static Face face_at(std::size_t axis, std::int32_t inside, std::int32_t outside, double place) {
    return {axis, inside, outside, std::abs(place - outside)};
  }

  Eigen::Index node_at(std::int32_t i, std::int32_t j) const { return i + Eigen::Index(j) * row_stride_; }

  /// Calls `visit(node, component, velocity)` for the nodes inside body `b`.
  template <class Visit>
  void for_each_held(std::size_t b, Visit&& visit) const {
    const Held& held = held_[b];
    const std::int32_t first_row = Dim == 1 ? 0 : held.begin[Dim - 1];
    const std::int32_t last_row = Dim == 1 ? 1 : held.end[Dim - 1];
    for (std::int32_t j = first_row; j < last_row; ++j) {
      for (std::int32_t i = held.begin[0]; i < held.end[0]; ++i) {
        for (std::size_t a = 0; a < Dim; ++a) {
          if (bodies_[b].constrains[a]) visit(node_at(i, j), a, velocity_of(b, i, j, a));
        }
      }
    }
  }

  /// Two nodes with a face between them.
  struct Pair {
    Eigen::Index in, out;
    double weight;  ///< of `in` on the face
  };

  /// Calls `visit(pair, component, velocity)` along the faces of body `b`.
  template <class Visit>
  void for_each_face(std::size_t b, Visit&& visit) const {
    for (const Face& face : held_[b].faces) {
      if (face.inside < 0) continue;
      const std::size_t across = Dim == 1 ? 0 : 1 - face.axis;
      const std::int32_t first = Dim == 1 ? 0 : held_[b].begin[across];
      const std::int32_t last = Dim == 1 ? 1 : held_[b].end[across];
      for (std::int32_t k = first; k < last; ++k) {
        const auto node = [&](std::int32_t row) {
          return Dim == 1 || face.axis == 0 ? node_at(row, k) : node_at(k, row);
        };
        const Pair pair{node(face.inside), node(face.outside), face.weight};
        for (std::size_t a = 0; a < Dim; ++a) {
          if (bodies_[b].constrains[a]) visit(pair, a, held_[b].fraction * bodies_[b].velocity[a]);
        }
      }
    }
  }

  /// Calls `give(node, component, impulse)` with the smallest impulses that give one component of the
  /// velocity on the face its value.
  template <class Velocity, class Give>
  static void pull(const Grid<Dim, Real>& grid, Real empty_mass, const Pair& pair, std::size_t a,
                   double velocity, Velocity&& velocity_of_node, Give&& give) {
    const double inside = pair.weight, outside = 1 - pair.weight;
    const bool out_counts = grid.mass[pair.out] > empty_mass;
    const double missing = velocity - inside * velocity_of_node(pair.in, a) -
                           (out_counts ? outside * velocity_of_node(pair.out, a) : 0.0);
    const double compliance =
        inside * inside / static_cast<double>(grid.mass[pair.in]) +
        (out_counts ? outside * outside / static_cast<double>(grid.mass[pair.out]) : 0.0);
    give(pair.in, a, missing / compliance * inside);
    if (out_counts) give(pair.out, a, missing / compliance * outside);
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
  double time_step_, cell_size_;
  std::int32_t row_stride_;
  Vector<Dim, double> first_node_{};
  std::array<std::int32_t, Dim> nodes_{};
};

}  // namespace mpm
