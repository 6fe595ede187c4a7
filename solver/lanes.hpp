#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <type_traits>
#include <utility>
#include <xsimd/xsimd.hpp>

namespace mpm {

/// As many numbers as the machine works on at once. Kernels are written for a `Value` that is either a plain
/// number or lanes of them; this file is all they know of vector instructions.
template <class Real>
using Lanes = xsimd::batch<Real>;

template <class Real>
inline constexpr int lane_count = static_cast<int>(Lanes<Real>::size);

/// The plain number of a Value.
template <class Value>
struct ScalarOf {
  using type = Value;
};
template <class Real, class Arch>
struct ScalarOf<xsimd::batch<Real, Arch>> {
  using type = Real;
};
template <class Value>
using Scalar = typename ScalarOf<Value>::type;

template <class Value>
inline constexpr bool is_lanes = !std::is_same_v<Scalar<Value>, Value>;

/// `chosen` where `condition` holds, else `other`; for lanes xsimd has its own.
template <class Real>
requires std::is_floating_point_v<Real> Real select(bool condition, Real chosen, Real other) {
  return condition ? chosen : other;
}
/// Whether a condition holds in any lane; for lanes xsimd has its own.
inline bool any(bool condition) { return condition; }

/// The numbers from a place on; it need not be aligned.
template <class Value>
Value load(const Scalar<Value>* place) {
  if constexpr (is_lanes<Value>) {
    return Value::load_unaligned(place);
  } else {
    return *place;
  }
}
template <class Real, class Arch>
void store(const xsimd::batch<Real, Arch>& lanes, Real* place) {
  lanes.store_unaligned(place);
}
template <class Real>
requires std::is_floating_point_v<Real>
void store(Real value, Real* place) { *place = value; }

/// Sum of the lanes.
template <class Real>
Real reduce_add(const Lanes<Real>& lanes) {
  alignas(sizeof(Lanes<Real>)) std::array<Real, static_cast<std::size_t>(lane_count<Real>)> numbers;
  lanes.store_aligned(numbers.data());
  return std::accumulate(numbers.begin(), numbers.end(), Real(0));
}

/// Lanes 0, 1, 2, ...
template <class Real>
Lanes<Real> lane_numbers() {
  return []<int... i>(std::integer_sequence<int, i...>) { return Lanes<Real>{static_cast<Real>(i)...}; }
  (std::make_integer_sequence<int, lane_count<Real>>{});
}

/// One lane of many.
template <class Real>
Real lane_of(const Lanes<Real>& lanes, int lane) {
  alignas(sizeof(Lanes<Real>)) std::array<Real, static_cast<std::size_t>(lane_count<Real>)> numbers;
  lanes.store_aligned(numbers.data());
  return numbers[static_cast<std::size_t>(lane)];
}

/// One lane of many replaced.
template <class Real>
void set_lane(Lanes<Real>& lanes, int lane, Real value) {
  alignas(sizeof(Lanes<Real>)) std::array<Real, static_cast<std::size_t>(lane_count<Real>)> numbers;
  lanes.store_aligned(numbers.data());
  numbers[static_cast<std::size_t>(lane)] = value;
  lanes = Lanes<Real>::load_aligned(numbers.data());
}

/// The lanes moved up by `n` of them: the first n are the last of `below`.
template <int n, class Real>
Lanes<Real> moved_up(const Lanes<Real>& below, const Lanes<Real>& lanes) {
  constexpr int count = lane_count<Real>;
  static_assert(n >= 0 && n <= count);
  return [&]<int... i>(std::integer_sequence<int, i...>) {
    return Lanes<Real>(__builtin_shufflevector(below.data, lanes.data, (i + count - n)...));
  }
  (std::make_integer_sequence<int, count>{});
}

}  // namespace mpm
