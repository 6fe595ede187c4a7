#pragma once

#include "reports/page_data.hpp"
#include "vv/verdict.hpp"

namespace mpm::reports {

/// What the page says of stability at the extremes, of all cases that were run:
///
/// - `maps`: the figures of kind stability, with their anchors;
/// - `limits`: one entry a survey of time steps, with the limits by matrix and by runs, and advice;
/// - `class_counts` and `extremes`: of every case that classifies its runs, how many runs are of each class,
/// and each
///   run with what it was told by; the runs whose class is not among those that their gates let pass are also
///   in `surprises`;
/// - `roundings`: of every case that asks what rounding does, a plain verdict for each way to compute and a
/// row a run;
/// - `thread_repeats`: one entry a case whose runs were repeated on other numbers of threads.
///
/// Each with `has_...`, and `has_stability` for any of them.
void set_stability_overview(PageData& page, const vv::CampaignVerdict& verdict);

}  // namespace mpm::reports
