#pragma once

#include "reports/page_data.hpp"
#include "vv/verdict.hpp"

namespace mpm::reports {

/// The part of a case's section that stands runs beside measurements: the lists `comparisons` (one entry a
/// run and measurement; one a measurement whose curve file is an empty slot) and `paired` (one a paired
/// prediction), with `has_...` of both.
void set_validation(PageData& section, const vv::CaseVerdict& verdict);

/// What the page says of measurements as a whole: `validations` (one entry a measurement: its verdicts over
/// the runs), `paired` and `curve_files` (where every number that was measured by others comes from), with
/// `has_...`.
void set_validation_overview(PageData& page, const vv::CampaignVerdict& verdict);

}  // namespace mpm::reports
