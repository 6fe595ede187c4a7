#pragma once

#include <string>
#include <utility>
#include <vector>

#include "vv/case_file.hpp"

namespace mpm::vv {

struct RunVerdict;

/// What rounding does makes metrics of every run that is no baseline: this and `displacement`, `stress` or
/// `share`.
inline constexpr const char* rounding_prefix = "rounding.";

/// What rounding does to the answer of one run, beside the error that its cells make anyway.
struct RoundingRow {
  std::size_t run = 0, baseline = 0;  ///< indices into the runs of the case
  bool bits_equal = false;            ///< as the baseline, in every bit of the final state
  double displacement = 0.0,
         stress = 0.0;  ///< L2 of the difference to the baseline relative to its field [-]
  double digits_of_displacement = 0.0, digits_of_stress = 0.0;  ///< of agreement: -log10 of these, at most 17
  double cells_of_displacement = 0.0,
         cells_of_stress = 0.0;  ///< estimated error of the cells, likewise; NaN if unknown
  double share = 0.0;            ///< the larger of rounding over error of the cells [-]; NaN if unknown
  std::string lack;              ///< why there are no numbers, for a person; empty beside them

  /// Whether rounding adds at most `allowed_rounding_share` to the error of the cells. Not if that is
  /// unknown.
  bool is_enough() const;
};

/// Compares every run of a case that asks for it with its baseline; one row for each run that is none itself,
/// in the order of the runs. Nothing for a case that does not ask. `runs` are one for each of the case.
///
/// Final displacement and stress along the last axis are compared particle by particle: those that start in
/// the same place of the same body, whatever their order. The L2 norms are weighted by initial volume.
///
/// The error of the cells is estimated from the baselines on all cell sizes there are: their means over the
/// cells of the coarsest grid, and the distance d in L2, relative to the finer, of each two neighbouring
/// sizes h_c > h_f. In a method of order p the error at the size h is then h^p d / (h_c^p - h_f^p). The order
/// is 2, the highest that is expected, unless the three finest sizes tell a lower one; it is never taken as
/// below 1, and an order below 0.5 tells nothing. Of the estimates by the two neighbours of a size the
/// smaller one counts. All of this makes the error of the cells rather too small than too large, and so
/// rounding look rather worse beside it.
std::vector<RoundingRow> judge_rounding(const Case& definition, const std::vector<RunVerdict>& runs);

/// Keeps the metrics `rounding.displacement`, `rounding.stress` and `rounding.share` of the runs that rows
/// tell of.
void keep_rounding_metrics(const std::vector<RoundingRow>& rows, std::vector<RunVerdict>& runs);

}  // namespace mpm::vv
