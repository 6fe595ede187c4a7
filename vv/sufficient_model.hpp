#pragma once

#include <string>

#include "vv/case_file.hpp"

/// The smallest model that still gives all that a case asks for.
namespace mpm::vv {

/// What keeps a scene of two dimensions from being a column, which is alike all the way across and cannot
/// give way sideways: for a person, empty if it is one.
std::string why_no_column(const Scene& scene);

/// The column in one dimension: the same heights, times, densities and loads per area, and for each body the
/// constrained modulus E (1 - nu) / ((1 + nu) (1 - 2 nu)), with which the vertical stress
/// has the same rate. `strip` is a scene without a `why_no_column`.
Scene column_of(const Scene& strip);

/// What the case asks of its runs that only two dimensions have, for a person; empty if there is nothing.
std::string why_in_the_plane(const Case& definition);

/// Puts the scene that is simulated in place of the scene as written, and says what was chosen and why. All
/// of the case but its runs has been read.
void choose_model(const Case& definition, RunRequest& request);

/// A probe in the scene that is simulated, and what its numbers are to be multiplied by to be those of the
/// scene as written.
struct SimulatedProbe {
  HistoryProbe probe;
  double factor = 1.0;
};
SimulatedProbe simulated(const HistoryProbe& probe, const RunRequest& request);

}  // namespace mpm::vv
