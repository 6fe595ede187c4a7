#pragma once

#include "reports/page_data.hpp"
#include "vv/verdict.hpp"

namespace mpm::reports {

/// The part of a case's section that tells what was simulated instead of what was written: the list
/// `model_choices`, one entry a run and choice that was taken, with `has_model_choices`.
void set_model_choices(PageData& section, const vv::CaseVerdict& verdict);

}  // namespace mpm::reports
