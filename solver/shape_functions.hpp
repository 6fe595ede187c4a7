#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "solver/lanes.hpp"
#include "solver/scene.hpp"

namespace mpm {

// All lengths in this file are in cells. A Value is a number or lanes of them.

/// Integral of the hat function from 0 to t, for any t: psi(t) = t (1 - |t| / 2), t clamped to [-1, 1].
template <class Value>
Value hat_integral(const Value& t) {
  using std::abs, std::max, std::min;
  const Value inside = max(Value(-1), min(t, Value(1)));
  return inside * (1 - abs(inside) / 2);
}

/// Hat function N(d) = max(0, 1 - |d|) [-].
template <class Value>
Value hat(const Value& d) {
  using std::abs, std::max;
  return max(Value(0), 1 - abs(d));
}

/// Weights of a point particle: S = N(d) [Kiriyama15, section 2].
struct LinearShape {
  static constexpr int width = 2;         ///< nodes per axis a particle can reach
  static constexpr int nodes_before = 0;  ///< of them below the lower node of its cell

  /// Weight [-] and weight gradient [1/cell] of the `width` nodes reached by a particle that lies `place`
  /// above the first of them.
  template <class Value>
  static void evaluate(const Value& place, const Value& /*half_size*/, std::array<Value, width>& weight,
                       std::array<Value, width>& gradient) {
    weight = {1 - place, place};
    gradient = {Value(-1), Value(1)};
  }
};

/// Weights averaged over a particle's domain of half size l, exact for every 0 < l <= 1 [BardenhagenKober04]:
/// S = [psi(d + l) - psi(d - l)] / 2l and S' = [N(d + l) - N(d - l)] / 2l, with d = position - node.
struct GimpShape {
  static constexpr int width = 4;  ///< a domain of 2l <= 2 cells reaches at most four nodes per axis
  static constexpr int nodes_before = 1;

  template <class Value>
  static void evaluate(const Value& place, const Value& half_size, std::array<Value, width>& weight,
                       std::array<Value, width>& gradient) {
    const Value over_size = 1 / (2 * half_size);
    for (int k = 0; k < width; ++k) {
      const Value distance = place - static_cast<Scalar<Value>>(k);
      const Value left = distance - half_size, right = distance + half_size;
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
