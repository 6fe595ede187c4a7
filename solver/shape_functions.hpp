#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "solver/lanes.hpp"
#include "solver/scene.hpp"

namespace mpm {

// Places and half sizes in this file are in cells. A Value is a number or lanes of them.

/// Weights of a point particle: S = N(d) [Kiriyama15, section 2].
///
/// Exactly on a node a point has no weight at the next one, which it strains by all the same: its gradient there is that of
/// any point of the cell. A node at a free surface would be empty and at rest, and the particle strained by its own
/// velocity. So a point is weighed as if it kept `nearest` cells away from nodes: the root of the rounding, so little that
/// nobody sees it. Then no weight is round-off, and every node that is reached at all moves as what reaches it.
struct LinearShape {
  template <class Real>
  static constexpr Real nearest = sizeof(Real) == 8 ? Real(0x1p-26) : Real(0x1p-11);
  /// Nodes with less than this fraction of the least particle mass count as empty: less than any particle can leave them,
  /// which is `nearest` squared in the plane.
  template <class Real>
  static constexpr Real empty_share = nearest<Real> * nearest<Real> / 4;

  static constexpr int width = 2;         ///< nodes per axis a particle can reach
  static constexpr int nodes_before = 0;  ///< of them below the lower node of its cell

  /// Weight [-] and weight gradient [1/m] of the `width` nodes reached by a particle that lies `place` above
  /// the first of them: in [nodes_before, nodes_before + 1).
  template <class Value>
  static void evaluate(const Value& place, const Value& /*half_size*/, Scalar<Value> cells_per_length,
                       std::array<Value, width>& weight, std::array<Value, width>& gradient) {
    using std::max, std::min;
    constexpr Scalar<Value> least = nearest<Scalar<Value>>;
    const Value inside = max(Value(least), min(Value(1 - least), place));
    weight = {1 - inside, inside};
    gradient = {Value(-cells_per_length), Value(cells_per_length)};
  }
};

/// Weights averaged over a particle's domain of half size l, exact for every 0 < l <= 1 [BardenhagenKober04]:
/// S = [psi(d + l) - psi(d - l)] / 2l and S' = [N(d + l) - N(d - l)] / 2l, with d = position - node, the hat
/// function N and its integral psi(t) = t (1 - |t| / 2), t clamped to [-1, 1].
///
/// The particle is between the second and the third of its nodes. So its lower edge lies within a cell of the
/// second, l- = d1 - l in (-1, 1), and its upper edge within a cell of the third, l+ = d2 + l in (-1, 1).
/// With their positive and negative parts, x = x' - x'' and |x| = x' + x'', both functions need no other
/// case:
///
///     2l S = l-''^2/2,   (1 - l+''^2 + l-'^2 - l-''^2)/2 - l-,   (1 - l-'^2 + l+''^2 - l+'^2)/2 + l+,
///     l+'^2/2 2l S' = -l-'',     l+'' - 1 + |l-|,                        1 - |l+| - l-', l+'
struct GimpShape {
  /// Nodes with less than this fraction of the least particle mass count as empty: their weights are round-off (a weight is
  /// a difference of numbers up to 1, divided by the domain), so their motion would be noise.
  template <class Real>
  static constexpr Real empty_share = 64 * std::numeric_limits<Real>::epsilon();

  static constexpr int width = 4;  ///< a domain of 2l <= 2 cells reaches at most four nodes per axis
  static constexpr int nodes_before = 1;

  template <class Value>
  static void evaluate(const Value& place, const Value& half_size, Scalar<Value> cells_per_length,
                       std::array<Value, width>& weight, std::array<Value, width>& gradient) {
    using std::max;
    const Value zero(0), over_size = 1 / (2 * half_size), over_length = over_size * cells_per_length;
    const Value lower = place - 1 - half_size, upper = place - 2 + half_size;
    const Value above_second = max(zero, lower), below_second = max(zero, -lower);
    const Value above_third = max(zero, upper), below_third = max(zero, -upper);
    const Value first = below_second * below_second, last = above_third * above_third;
    const Value inner = (1 + above_second * above_second - below_third * below_third) / 2;
    weight = {first / 2 * over_size, (inner - first / 2 - lower) * over_size,
              (1 - inner - last / 2 + upper) * over_size, last / 2 * over_size};
    gradient = {-below_second * over_length, (below_third - 1 + above_second + below_second) * over_length,
                (1 - above_third - below_third - above_second) * over_length, above_third * over_length};
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
