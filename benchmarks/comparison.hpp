#pragma once

#include <string>
#include <vector>

#include "benchmarks/results.hpp"

namespace mpm::bench {

enum class Change { faster, slower, unchanged };

/// Whether a rate has changed beyond noise: the intervals from low to high do not overlap, and the medians
/// differ by more than the larger half width.
Change change_of(const Measured& before, const Measured& after);

/// One rate of two files.
struct Compared {
  std::string name;
  Measured before, after;
  Change change = Change::unchanged;

  double ratio() const { return after.value / before.value; }
};

struct Comparison {
  std::vector<std::string> circumstances;  ///< what differs between the two besides the rates, one line each
  std::vector<Compared> limits;            ///< the machine itself; does not count
  std::vector<Compared> rates;             ///< steps, then kernels
  std::vector<std::string> only_before, only_after;  ///< names of steps and kernels

  /// Whether a step or a kernel has become slower beyond noise.
  bool has_slower() const;
};

Comparison compare(const Results& before, const Results& after);

/// A table for a person, one line each, with a last line that sums up.
std::string text_of(const Comparison& comparison);

}  // namespace mpm::bench
