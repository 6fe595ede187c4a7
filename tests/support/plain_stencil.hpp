#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "solver/grid.hpp"
#include "solver/shape_functions.hpp"

namespace mpm::test {

/// A node as one particle sees it.
template <int Dim, class Real>
struct SeenNode {
  Eigen::Index node;
  Real weight;                 ///< [-]
  Vector<Dim, Real> gradient;  ///< of the weight [1/m]
};

/// The nodes that a particle reaches, with weights from its own place and half sizes alone, as the definition
/// of the shape functions has them, with every case.
template <int Dim, class Real, Scheme scheme>
class PlainStencil {
 public:
  using Shape = typename SchemeTraits<scheme>::Shape;
  static constexpr std::size_t count = Dim == 1 ? Shape::width : Shape::width * Shape::width;

  /// `half_size` is not read by schemes without domains.
  PlainStencil(const Grid<Dim, Real>& grid, const Vector<Dim, Real>& position,
               const Vector<Dim, Real>& half_size)
      : PlainStencil(grid, position, half_size, [](Real) { return Real(0); }) {}

  /// With weights along an axis and their gradients off by `error(size)`, where they are not zero.
  template <class Error>
  PlainStencil(const Grid<Dim, Real>& grid, const Vector<Dim, Real>& position,
               const Vector<Dim, Real>& half_size, Error&& error) {
    std::array<std::int32_t, Dim> first;
    std::array<std::array<Real, Shape::width>, Dim> weight, gradient;
    for (std::size_t a = 0; a < Dim; ++a) {
      const Real place = (position[a] - grid.origin(static_cast<int>(a))) * grid.cells_per_length();
      first[a] = static_cast<std::int32_t>(place) - Shape::nodes_before;
      for (std::size_t k = 0; k < Shape::width; ++k) {
        const Real distance = place - static_cast<Real>(first[a] + static_cast<std::int32_t>(k));
        const Real size = half_size[a] * grid.cells_per_length();
        if constexpr (SchemeTraits<scheme>::has_domain) {
          weight[a][k] = (hat_integral(distance + size) - hat_integral(distance - size)) / (2 * size);
          gradient[a][k] = (hat(distance + size) - hat(distance - size)) / (2 * size);
        } else {
          constexpr Real nearest = LinearShape::nearest<Real>;
          weight[a][k] = std::clamp(hat(distance), nearest, 1 - nearest);
          gradient[a][k] = k == 0 ? Real(-1) : Real(1);
        }
      }
      for (Real& value : weight[a]) value += value != 0 ? error(Real(1)) : Real(0);
      for (Real& value : gradient[a]) value += value != 0 ? error(Real(1)) : Real(0);
    }
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = k % Shape::width, j = k / Shape::width;
      SeenNode<Dim, Real>& seen = nodes_[k];
      seen.node = first[0] + static_cast<Eigen::Index>(i);
      if constexpr (Dim == 1) {
        seen.weight = weight[0][i];
        seen.gradient[0] = gradient[0][i] * grid.cells_per_length();
      } else {
        seen.node += (first[1] + static_cast<Eigen::Index>(j)) * grid.row_stride();
        seen.weight = weight[0][i] * weight[1][j];
        seen.gradient[0] = gradient[0][i] * weight[1][j] * grid.cells_per_length();
        seen.gradient[1] = weight[0][i] * gradient[1][j] * grid.cells_per_length();
      }
    }
  }

  auto begin() const { return nodes_.begin(); }
  auto end() const { return nodes_.end(); }

 private:
  /// N(d) = max(0, 1 - |d|).
  static Real hat(Real d) { return std::max(Real(0), 1 - std::abs(d)); }
  /// Integral of the hat from 0 to t.
  static Real hat_integral(Real t) {
    const Real inside = std::clamp(t, Real(-1), Real(1));
    return inside * (1 - std::abs(inside) / 2);
  }

  std::array<SeenNode<Dim, Real>, count> nodes_;
};

}  // namespace mpm::test
