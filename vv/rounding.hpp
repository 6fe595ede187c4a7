#pragma once

#include <string>
#include <utility>
#include <vector>

#include "vv/case_file.hpp"

namespace mpm::vv {

struct RunVerdict;

/// What rounding does to the answer of one run, beside the error that its cells make anyway.
struct RoundingRow {
  std::size_t run = 0, baseline = 0;  ///< indices into the runs of the case
  bool bits_equal = false;            ///< as the baseline, in every bit of the final state
  double displacement = 0.0, stress = 0.0;  ///< L2 of the difference to the baseline relative to its field [-]
  double digits_of_displacement = 0.0, digits_of_stress = 0.0;  ///< of agreement: -log10 of these, at most 17
  double cells_of_displacement = 0.0, cells_of_stress = 0.0;  ///< estimated error of the cells, likewise; NaN if unknown
  double share = 0.0;  ///< the larger of rounding over error of the cells [-]; NaN if unknown
  std::string lack;    ///< why there are no numbers, for a person; empty beside them
};

}  // namespace mpm::vv
