#pragma once

#include <array>
#include <cstdint>

#include "solver/scene.hpp"
#include "solver/tensor.hpp"

namespace mpm {

/// A stretch of rows of nodes [begin, end).
struct Rows {
  std::int32_t begin = 0, end = 0;
};

/// A regular grid with `ghost_layers` of nodes beyond every edge, which the domains of particles near an edge
/// reach. One array per scalar, nodes along x one after another, so that the same node of neighbouring cells
/// are neighbours in memory; in one dimension there is one row.
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
  std::int32_t rows() const { return Dim == 1 ? 1 : nodes_[Dim - 1]; }
  /// Distance between rows in the arrays. It leaves room beyond the last node for lanes that reach past it.
  std::int32_t row_stride() const { return row_stride_; }
  /// Where the stretch of `rows` lies in the arrays: first index and count.
  std::pair<Eigen::Index, Eigen::Index> place_of(Rows rows) const {
    return {Eigen::Index(rows.begin) * row_stride_, Eigen::Index(rows.end - rows.begin) * row_stride_};
  }

  // What particles add to nodes.
  Field<Real> mass;                       ///< [kg per unit of the absent dimensions]
  std::array<Field<Real>, Dim> momentum;  ///< [kg m/s]
  std::array<Field<Real>, Dim> force;     ///< [N]: internal while scattering, unbalanced once gravity is in
  // What particles read from nodes.
  std::array<Field<Real>, Dim> velocity;      ///< [m/s]
  std::array<Field<Real>, Dim> acceleration;  ///< [m/s^2]
  /// The mass by which a node counts as light: its own, or the largest number in components that an edge or a rigid
  /// body holds [kg per unit of the absent dimensions]. Empty unless the scene treats light nodes.
  std::array<Field<Real>, Dim> strain_mass;

  /// Memory of all arrays [B].
  std::int64_t bytes() const {
    const auto nodes = static_cast<std::size_t>(mass.size());
    const auto nodes_with_strain_mass = static_cast<std::size_t>(strain_mass[0].size());
    return static_cast<std::int64_t>(((1 + 4 * Dim) * nodes + Dim * nodes_with_strain_mass) * sizeof(Real));
  }

  /// Forgets what was scattered to some rows.
  void clear(Rows rows);
  void clear_momentum(Rows rows);

 private:
  Real cell_size_{}, cells_per_length_{};
  Vector<Dim, Real> origin_{};
  std::array<std::int32_t, Dim> nodes_{};
  std::int32_t row_stride_ = 0;
};

}  // namespace mpm
