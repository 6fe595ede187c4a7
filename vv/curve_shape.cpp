#include "vv/curve_shape.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace mpm::vv {
namespace {

constexpr int points = 200;
constexpr std::size_t fewest_samples = 10, fewest_initial_samples = 8;
constexpr double straight_within = 0.02;   ///< of the largest pressure
constexpr double final_share = 0.2;        ///< of the settlement
constexpr double initial_share = 1.0 / 3;  ///< of the pressure gained up to the knee

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/// Slope at x = 0 of the parabola with the least squares.
double initial_slope_of_parabola(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<Eigen::Index>(x.size());
  const Eigen::ArrayXd share = Eigen::Map<const Eigen::ArrayXd>(x.data(), n) / x.back();
  Eigen::MatrixXd terms(n, 3);
  terms << Eigen::VectorXd::Ones(n), share.matrix(), share.square().matrix();
  const Eigen::VectorXd coefficients =
      terms.colPivHouseholderQr().solve(Eigen::Map<const Eigen::VectorXd>(y.data(), n));
  return coefficients[1] / x.back();
}

std::optional<double> initial_stiffness_of(const LoadCurve& curve, double knee_pressure) {
  const LoadCurve part = advancing_part(curve);
  const double first = part.pressure.front(), enough = first + initial_share * (knee_pressure - first);
  const auto end = std::find_if(part.pressure.begin(), part.pressure.end(),
                                [&](double pressure) { return pressure > enough; });
  const auto samples = static_cast<std::size_t>(end - part.pressure.begin());
  if (samples < fewest_initial_samples) return std::nullopt;
  const LoadCurve initial =
      evenly_spaced({{part.settlement.begin(), part.settlement.begin() + (end - part.pressure.begin())},
                     {part.pressure.begin(), end}},
                    points);
  std::vector<double> advance;
  for (const double settlement : initial.settlement)
    advance.push_back(settlement - initial.settlement.front());
  return initial_slope_of_parabola(advance, initial.pressure);
}

}  // namespace

int CurveShape::phases() const {
  for (const Polyline& fit : fits) {
    if (fit.rms_residual < straight_within * largest_pressure) return fit.pieces();
  }
  return static_cast<int>(fits.size()) + 1;
}

std::optional<CurveShape> shape_of(const LoadCurve& curve) {
  if (!all_finite(curve.settlement) || !all_finite(curve.pressure)) return std::nullopt;
  if (advancing_part(curve).settlement.size() < fewest_samples) return std::nullopt;
  const LoadCurve even = evenly_spaced(curve, points);
  CurveShape shape{};
  for (int pieces = 1; pieces <= static_cast<int>(shape.fits.size()); ++pieces)
    shape.fits[static_cast<std::size_t>(pieces) - 1] = fit_polyline(even.settlement, even.pressure, pieces);
  shape.largest_pressure = *std::max_element(curve.pressure.begin(), curve.pressure.end());
  shape.initial_stiffness = initial_stiffness_of(curve, shape.fit(2).y[1]);
  const auto last_part = static_cast<std::ptrdiff_t>(std::lround((1 - final_share) * (points - 1)));
  const Polyline final_line = fit_polyline({even.settlement.begin() + last_part, even.settlement.end()},
                                           {even.pressure.begin() + last_part, even.pressure.end()}, 1);
  shape.final_slope = final_line.slope(0);
  shape.final_pressure = final_line.y.back();
  return shape;
}

}  // namespace mpm::vv
