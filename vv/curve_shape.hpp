#pragma once

#include <array>
#include <optional>

#include "vv/load_curve.hpp"
#include "vv/polyline_fit.hpp"

namespace mpm::vv {

/// What a load curve's shape tells without any reference. It is read from the curve at 200 settlements
/// equally far from each other, so that neither the times of the samples nor the speed weighs.
struct CurveShape {
  std::array<Polyline, 4> fits;  ///< by least squares, of one to four straight pieces
  double largest_pressure;       ///< [Pa]
  /// The slope at its first point of the least-squares parabola through the curve until it has gained a third
  /// of the pressure that it gains up to the knee of the fit of two pieces [Pa/m]. Ground that yields at once
  /// at the edges has no straight beginning: a line through any part of it would be softer. Nothing where the
  /// run has fewer than eight samples there: with four the paper's footing (20 degrees) came out stiffer by a
  /// quarter than with fifteen.
  std::optional<double> initial_stiffness;
  /// Of the least-squares line through the last fifth of the settlement.
  double final_slope;     ///< [Pa/m]
  double final_pressure;  ///< its value at the deepest settlement [Pa]

  /// The fit of so many straight pieces.
  const Polyline& fit(int pieces) const { return fits.at(static_cast<std::size_t>(pieces) - 1); }
  /// The least number of pieces whose fit leaves a root mean square below 2 % of the largest pressure; 5 if
  /// even four leave more.
  int phases() const;
};

/// The shape of a curve, if ten samples or more go deeper than all before and all are numbers.
std::optional<CurveShape> shape_of(const LoadCurve& curve);

}  // namespace mpm::vv
