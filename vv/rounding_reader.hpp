#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vv/case_file.hpp"
#include "vv/json_reader.hpp"

namespace mpm::vv {

/// What a case says of rounding; nothing if `place` is absent. Throws Refusal.
std::optional<RoundingRequest> read_rounding(const JsonPlace& place, const Case& read);

/// The metrics that the key makes; none if the case does not ask for it.
std::vector<std::string> rounding_metric_names(const std::optional<RoundingRequest>& request);

}  // namespace mpm::vv
