#pragma once

#include "vv/record.hpp"

namespace mpm::vv {

/// Surveys the time steps of a run's scene: what the matrix of one step says of it, and runs of the scene, as
/// written but for the time step, at a scan of time steps and at bisections between the last before the first
/// that diverged and that one. Each lasts as long as the scene asks for and shares nothing with the others.
///
/// The class of each run is told by the mean displacement of the first body along the last axis, once all
/// loads have settled; in one dimension by the zig-zag of its stress; and by its error, the larger relative
/// L2 error of displacement and stress over all particles at the end: against Hencky's column if the case
/// names that reference solution, else against the run of the smallest step. A scene that is refused has no
/// points. Throws what `simulate` throws.
Survey survey_of(const Case& definition, const RunRequest& request, const SurveyRequest& asked,
                 const Pulse& pulse);

}  // namespace mpm::vv
