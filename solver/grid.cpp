#include "solver/grid.hpp"

#include <cmath>

#include "solver/lanes.hpp"

namespace mpm {
namespace {

/// Rows begin at whole multiples of the lanes, and lanes that begin at the last node end within its row.
template <class Real>
std::int32_t padded(std::int32_t nodes) {
  constexpr std::int32_t lanes = lane_count<Real>, widest_stencil = 4;
  std::int32_t stride = (nodes + lanes - 1) / lanes * lanes + std::max(lanes, widest_stencil);
  // Rows a whole page apart would share the same few places in the caches.
  constexpr std::int32_t page = 4096 / sizeof(Real);
  if (stride % page == 0) stride += lanes;
  return stride;
}

}  // namespace

template <int Dim, class Real>
Grid<Dim, Real>::Grid(const Scene& scene)
    : cell_size_(static_cast<Real>(scene.cell_size)),
      cells_per_length_(static_cast<Real>(1.0 / scene.cell_size)) {
  for (std::size_t axis = 0; axis < Dim; ++axis) {
    origin_[axis] = static_cast<Real>(scene.grid_lower[axis] - ghost_layers * scene.cell_size);
    const double cells = std::round((scene.grid_upper[axis] - scene.grid_lower[axis]) / scene.cell_size);
    nodes_[axis] = static_cast<std::int32_t>(cells) + 1 + 2 * ghost_layers;
  }
  row_stride_ = padded<Real>(nodes_[0]);
  const Eigen::Index total = Eigen::Index(rows()) * row_stride_;
  mass.setZero(total);
  for (auto* fields : {&momentum, &force, &velocity, &acceleration}) {
    for (Field<Real>& field : *fields) field.setZero(total);
  }
  for (Field<Real>& field : strain_mass) field.setZero(scene.light_nodes ? total : 0);
}

template <int Dim, class Real>
void Grid<Dim, Real>::clear(Rows rows) {
  const auto [first, count] = place_of(rows);
  mass.segment(first, count).setZero();
  for (Field<Real>& component : force) component.segment(first, count).setZero();
  clear_momentum(rows);
}

template <int Dim, class Real>
void Grid<Dim, Real>::clear_momentum(Rows rows) {
  const auto [first, count] = place_of(rows);
  for (Field<Real>& component : momentum) component.segment(first, count).setZero();
}

template class Grid<1, double>;
template class Grid<1, float>;
template class Grid<2, double>;
template class Grid<2, float>;

}  // namespace mpm
