#pragma once

#include <vector>

#include "vv/verdict.hpp"

/// Runs of a case beside measurements.
namespace mpm::vv {

/// Compares every run that the case's measurements select with the measured curves: `comparisons` of the
/// runs, and their metrics measured.<id>.<name>. The curves of all runs are there already.
void compare_with_measurements(CaseVerdict& verdict);

/// What every paired prediction of the case says beside its measurements. The metrics of all runs are there
/// already.
std::vector<PairsVerdict> judge_pairs(const CaseVerdict& verdict);

}  // namespace mpm::vv
