#pragma once

#include <string>
#include <vector>

#include "reports/document.hpp"
#include "reports/performance.hpp"
#include "vv/verdict.hpp"

namespace mpm::reports {

/// Draws every figure that the measurements suffice for. What cannot be drawn carries its reason.
std::vector<DrawnPerformanceFigure> draw_performance_figures(const PerformanceEvidence& evidence);

/// The report's section on speed, an HTML element with the id `performance`. It states only what the
/// measurements hold and says what they lack, and whether revision, processor or compiler are not those of
/// the verdict. Figures are numbered from `number` on, which is advanced.
std::string performance_section(const PerformanceEvidence& evidence, const vv::CampaignVerdict& verdict,
                                const std::vector<DrawnPerformanceFigure>& figures, int& number);

}  // namespace mpm::reports
