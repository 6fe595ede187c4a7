#pragma once

#include <string>

#include "benchmarks/results.hpp"

namespace mpm::bench {

/// Everything that was measured, for a person, in lines of at most 130 columns.
std::string text_of(const Results& results);

}  // namespace mpm::bench
