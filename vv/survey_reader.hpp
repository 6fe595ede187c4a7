#pragma once

#include <optional>

#include "vv/json_reader.hpp"
#include "vv/survey.hpp"

namespace mpm::vv {

/// The key `stability` of a case; nothing if `place` is absent. Throws Refusal.
std::optional<SurveyRequest> read_survey(const JsonPlace& place);

/// Refuses keys of a case that ask for something of one run, which a survey has not. `place` is the case.
void refuse_beside_survey(const JsonPlace& place);

}  // namespace mpm::vv
