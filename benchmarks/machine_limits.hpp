#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "benchmarks/measured.hpp"

namespace mpm::bench {

/// What this machine can do at best, on one core.
struct Limit {
  std::string
      name;  ///< triad_l2, triad_l3, triad_memory, fma_peak, fma_beside, scatter, gather, step or step_beside
  std::string title;  ///< for a person
  std::string unit;   ///< B/s, flop/s or particles/s
  Measured rate;

  friend bool operator==(const Limit&, const Limit&) = default;
};

/// Sizes of one core's caches [B]; a plain guess where the system does not tell.
struct Caches {
  std::size_t l2, l3;
};
Caches caches();

/// How a limit is measured: a function to be timed, which sets the counter `units_counter` to the bytes,
/// operations or particles of an iteration.
struct LimitProbe {
  std::string name, title, unit;
  std::function<void(benchmark::State&)> run;
};

/// - triad: a = b + s c, 24 bytes per element (what a cache line fetched before it is written costs besides
///   is not counted), with arrays that together fill a quarter of the L2 cache; a quarter of L3, but at least
///   twice L2; and four times L3 or 256 MB, whichever is smaller, but at least twice L3.
/// - fma_peak: chains of multiply-adds, two operations each, in the widest vectors the program was built for.
/// - fma_beside: the same while a second thread does so too, sharing nothing. Twice this over `fma_peak` is
/// what
///   two threads can gain in arithmetic at all: processors share a clock, or a core, with their neighbours.
/// - scatter: particles in the order of their cells add four doubles, weighted by products of given weights
///   along the axes, to 3 x 3 nodes each; 10,000 particles, four a cell.
/// - gather: the same particles collect two doubles from 3 x 3 nodes each.
/// - step, step_beside: a whole step (cpGIMP, MUSL, Mohr–Coulomb, 1e4 particles) alone, and while a second
/// thread
///   takes steps of a simulation of its own. They share nothing, so twice the second over the first is all
///   that two threads can gain in one simulation on this machine.
std::vector<LimitProbe> limit_probes();

/// The counter of what one iteration of a benchmark does.
inline constexpr const char* units_counter = "units";

/// The limit of that name. Throws std::out_of_range if there is none.
const Limit& limit_named(const std::vector<Limit>& limits, const std::string& name);

/// Name of the triad of the smallest memory that holds `bytes`.
std::string triad_for(std::size_t bytes, const Caches& caches);

}  // namespace mpm::bench
