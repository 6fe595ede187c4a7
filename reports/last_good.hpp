#pragma once

#include <string>

#include "reports/plot.hpp"
#include "vv/verdict.hpp"

/// What a run that ended as a numerical failure looked like before it went wrong.
namespace mpm::reports {

/// Name of the figure of a case's failure beside those that the case asks for.
inline constexpr const char* last_good_figure = "last_good";

/// A run of a case that classifies its runs, with its last good state; case and run are indices. A scene of
/// two dimensions is preferred.
struct FailedRun {
  const vv::CaseVerdict* verdict = nullptr;
  const vv::RunVerdict* run = nullptr;
};

/// The first run that is worth a picture; nothing (null) if there is none.
FailedRun failed_run_to_draw(const vv::CampaignVerdict& verdict);

/// Draws the last good state: in two dimensions every particle by its speed, in one velocity over height. A
/// ring marks the particle that the failure was noticed at. Throws CanvasError.
Picture last_good_picture(const FailedRun& failed);

/// What the picture shows and how the run went on, in markup.
std::string last_good_caption(const FailedRun& failed);

}  // namespace mpm::reports
