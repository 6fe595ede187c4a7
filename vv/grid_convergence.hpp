#pragma once

#include <optional>
#include <string>
#include <vector>

namespace mpm::vv {

/// What three levels of refinement say of a value on the finest of them.
struct GridConvergence {
  bool monotone = false;  ///< the value moves in one direction
  double order = 0.0;     ///< observed order of convergence [-]; NaN if not monotone
  double extrapolated =
      0.0;                   ///< to a cell size of zero [unit of the value]; NaN unless the order is reliable
  double uncertainty = 0.0;  ///< of the finest value by its discretisation, relative to it [-]
  std::string method;        ///< how the uncertainty was found, for a person
};

/// Judges the discretisation of a value by its three finest levels, all given from coarse to fine.
///
/// With h_1 < h_2 < h_3, r_21 = h_2 / h_1, r_32 = h_3 / h_2 and the values f_1 (finest), f_2, f_3, the
/// observed order p solves
///
///     (f_3 - f_2) / (f_2 - f_1) = r_21^p (r_32^p - 1) / (r_21^p - 1),
///
/// the value at zero cell size is f_0 = f_1 + (f_1 - f_2) / (r_21^p - 1), and the uncertainty is the grid
/// convergence index 1.25 |f_0 - f_1| / |f_1| [Roache94; CelikEtAl08]. An order above 2, which no scheme here
/// has, is taken for 2 in both. Nothing is hidden by a magnitude: an order below 0.5, or below zero where the
/// differences grow, is not reliable. Then, and where the values are not monotone, the uncertainty is the
/// range of the three values over the magnitude of the finest, and there is no extrapolated value.
///
/// Nothing for less than three levels, cell sizes that do not fall or are not positive, values that are not
/// finite, or a finest value of zero.
std::optional<GridConvergence> grid_convergence(const std::vector<double>& cell_size,
                                                const std::vector<double>& value);

}  // namespace mpm::vv
