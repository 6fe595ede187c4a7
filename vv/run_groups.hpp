#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "vv/case_file.hpp"

/// Which runs of a case belong together.
namespace mpm::vv {

using Parameters = std::vector<std::pair<std::string, Json>>;

/// Runs of one series, from coarse to fine, and the parameters they share.
struct RunGroup {
  Parameters fixed;
  std::vector<std::size_t> runs;  ///< indices into `Case::runs`
};

/// The value of a swept parameter; null if it is not swept.
const Json* value_of(const Parameters& parameters, const std::string& pointer);

/// Whether a run with these parameters has one of the values listed for every parameter named.
bool selects(const std::vector<Selector>& where, const Parameters& parameters);

/// The runs that have one of the values listed for every parameter named; all without any.
std::vector<std::size_t> selected_runs(const Case& definition, const std::vector<Selector>& where);

/// Groups runs that differ in one parameter only, in sweep order; runs in which it is not swept are left out.
std::vector<RunGroup> groups_across(const Case& definition, const std::vector<std::size_t>& runs,
                                    const std::string& across);

/// Groups runs that have the same values of these parameters, and no others in `fixed`; groups and the runs
/// in them in sweep order.
std::vector<RunGroup> groups_alike_in(const Case& definition, const std::vector<std::string>& parameters);

}  // namespace mpm::vv
