#pragma once

#include "vv/record.hpp"

namespace mpm::vv {

/// What float may add to the error that the cells make anyway [-].
inline constexpr double allowed_rounding_share = 0.1;

/// The scene on cells `factor` times as large, with as many particles a cell and a time step as much longer;
/// a grid that is too short for that by a part of a cell grows beyond edges that are free. Throws SceneError
/// if bodies or grid are no whole number of the larger particles or cells, std::invalid_argument for what
/// would be another scene there.
Scene on_larger_cells(const Scene& scene, int factor);

/// Whether the simulated scene of a request may run in float: what rounding adds must be at most
/// `allowed_rounding_share` of the error of the cells, of displacement and of stress alike.
///
/// Both are estimated by three pilots, of cells twice as large in double and in float and four times as large
/// in double. They are compared by their means over the largest cells, in L2 relative to the field. With the
/// difference d of the two in double, the error at the scene's own cell size is taken as d / 12, what is left
/// of a method of second order, which is the least it can be expected to be; with the difference r of float
/// and double the rounding there as 8 r, more than it has been seen to grow. Whatever stands in
/// the way of pilots leaves the run in double. Throws Abandoned when `pulse` says so.
ModelChoice choose_precision(const RunRequest& request, const Pulse& pulse);

}  // namespace mpm::vv
