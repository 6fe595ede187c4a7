#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "solver/scene.hpp"
#include "solver/tensor.hpp"

namespace mpm {

/// What particles add to a node. One node is one aligned vector, so that adding to it is one load and one
/// store.
template <int Dim, class Real>
struct alignas((Dim == 1 ? 4 : 8) * sizeof(Real)) NodeSums {
  Real mass{};                   ///< [kg per unit of the absent dimensions]
  Vector<Dim, Real> momentum{};  ///< [kg m/s]
  Vector<Dim, Real> force{};     ///< [N]: internal while scattering, unbalanced once gravity is in
};

/// What particles read from a node.
template <int Dim, class Real>
struct alignas(2 * Dim * sizeof(Real)) NodeMotion {
  Vector<Dim, Real> velocity{};      ///< [m/s]
  Vector<Dim, Real> acceleration{};  ///< [m/s^2]
};

/// A regular grid with `ghost_layers` of nodes beyond every edge, which the domains of particles near an edge
/// reach.
template <int Dim, class Real>
class Grid {
 public:
  static constexpr int ghost_layers = 2;

  explicit Grid(const Scene& scene);

  Real cell_size() const { return cell_size_; }
  Real cells_per_length() const { return cells_per_length_; }
  /// Position of the first node (a ghost) along an axis [m].
  Real origin(int axis) const { return origin_[static_cast<std::size_t>(axis)]; }
  /// Nodes along an axis, ghosts included.
  std::int32_t nodes(int axis) const { return nodes_[static_cast<std::size_t>(axis)]; }
  /// Distance between rows in the node arrays; 0 in one dimension.
  std::int32_t row_stride() const { return Dim == 1 ? 0 : nodes_[0]; }

  std::vector<NodeSums<Dim, Real>> sums;
  std::vector<NodeMotion<Dim, Real>> motion;

  /// Forgets what was scattered.
  void clear() { std::fill(sums.begin(), sums.end(), NodeSums<Dim, Real>{}); }

 private:
  Real cell_size_{}, cells_per_length_{};
  Vector<Dim, Real> origin_{};
  std::array<std::int32_t, Dim> nodes_{};
};

}  // namespace mpm
