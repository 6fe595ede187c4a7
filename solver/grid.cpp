#include "solver/grid.hpp"

#include <cmath>

namespace mpm {

template <int Dim, class Real>
Grid<Dim, Real>::Grid(const Scene& scene)
    : cell_size_(static_cast<Real>(scene.cell_size)),
      cells_per_length_(static_cast<Real>(1.0 / scene.cell_size)) {
  std::size_t total = 1;
  for (std::size_t axis = 0; axis < Dim; ++axis) {
    origin_[axis] = static_cast<Real>(scene.grid_lower[axis] - ghost_layers * scene.cell_size);
    const double cells = std::round((scene.grid_upper[axis] - scene.grid_lower[axis]) / scene.cell_size);
    nodes_[axis] = static_cast<std::int32_t>(cells) + 1 + 2 * ghost_layers;
    total *= static_cast<std::size_t>(nodes_[axis]);
  }
  sums.resize(total);
  motion.resize(total);
}

template class Grid<1, double>;
template class Grid<1, float>;
template class Grid<2, double>;
template class Grid<2, float>;

}  // namespace mpm
