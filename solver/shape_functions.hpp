#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "solver/scene.hpp"

namespace mpm {

// All lengths in this file are in cells, measured from the grid's first node, so they are positive.

/// Integral of the hat function from 0 to t, for any t: psi(t) = t (1 - |t| / 2), t clamped to [-1, 1].
template <class Real>
Real hat_integral(Real t) {
  const Real inside = std::clamp(t, Real(-1), Real(1));
  return inside * (1 - std::abs(inside) / 2);
}

/// Hat function N(d) = max(0, 1 - |d|) [-].
template <class Real>
Real hat(Real d) {
  return std::max(Real(0), 1 - std::abs(d));
}

/// Weights of a point particle: S = N(d) [Kiriyama15, section 2].
struct LinearShape {
  static constexpr int width = 2;  ///< nodes per axis a particle can reach

  /// Index of the first node reached by a particle at `position`.
  template <class Real>
  static std::int32_t first_node(Real position, Real /*half_size*/) {
    return static_cast<std::int32_t>(position);
  }

  /// Weight [-] and weight gradient [1/cell] of the `width` nodes from `first` on.
  template <class Real>
  static void evaluate(Real position, Real /*half_size*/, std::int32_t first, std::array<Real, width>& weight,
                       std::array<Real, width>& gradient) {
    const Real right = position - static_cast<Real>(first);
    weight = {1 - right, right};
    gradient = {-1, 1};
  }
};

/// Weights averaged over a particle's domain of half size l, exact for every 0 < l <= 1 [BardenhagenKober04]:
/// S = [psi(d + l) - psi(d - l)] / 2l and S' = [N(d + l) - N(d - l)] / 2l, with d = position - node.
struct GimpShape {
  static constexpr int width = 4;  ///< a domain of 2l <= 2 cells reaches at most four nodes per axis

  template <class Real>
  static std::int32_t first_node(Real position, Real half_size) {
    return static_cast<std::int32_t>(position - half_size);
  }

  template <class Real>
  static void evaluate(Real position, Real half_size, std::int32_t first, std::array<Real, width>& weight,
                       std::array<Real, width>& gradient) {
    const Real over_size = 1 / (2 * half_size);
    for (int k = 0; k < width; ++k) {
      const Real distance = position - static_cast<Real>(first + k);
      const Real left = distance - half_size, right = distance + half_size;
      weight[static_cast<std::size_t>(k)] = (hat_integral(right) - hat_integral(left)) * over_size;
      gradient[static_cast<std::size_t>(k)] = (hat(right) - hat(left)) * over_size;
    }
  }
};

/// The shape function of a scheme, and whether its domains follow the strain [Kiriyama15, Eq. 14].
template <Scheme scheme>
struct SchemeTraits {
  using Shape = GimpShape;
  static constexpr bool has_domain = true;
  static constexpr bool updates_half_size = scheme == Scheme::cpgimp;
};
template <>
struct SchemeTraits<Scheme::mpm> {
  using Shape = LinearShape;
  static constexpr bool has_domain = false;
  static constexpr bool updates_half_size = false;
};

}  // namespace mpm
