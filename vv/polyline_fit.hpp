#pragma once

#include <vector>

namespace mpm::vv {

/// Straight pieces joined end to end.
struct Polyline {
  std::vector<double> x;      ///< of the ends of the pieces, ascending; the inner ones are the knots
  std::vector<double> y;      ///< there
  double rms_residual = 0.0;  ///< root of the mean square distance, along y, to the points it was fitted to

  int pieces() const { return static_cast<int>(x.size()) - 1; }
  double slope(int piece) const;  ///< of the piece of that number, from 0
};

/// No piece of a fit is shorter than this share of the range of x.
inline constexpr double shortest_piece = 1.0 / 40;

/// The polyline of so many pieces with the least squares of distances along y, its knots free. All choices of
/// knots on a lattice of forty steps are tried; from the best of them the knots are moved, together and by
/// steps that halve, as long as that helps. For a single piece it is the regression line.
///
/// x ascending, with two points or more in every fortieth of its range, since knots that leave a piece
/// undetermined are passed over; in any case more points than pieces + 1; 1 <= pieces <= 4. Throws
/// std::invalid_argument otherwise, or for unequal lengths.
Polyline fit_polyline(const std::vector<double>& x, const std::vector<double>& y, int pieces);

}  // namespace mpm::vv
