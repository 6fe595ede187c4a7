#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "vv/field_map.hpp"
#include "vv/norms.hpp"
#include "vv/verdict.hpp"

/// Numbers read off curves: of one run at one abscissa, and of several runs against each other.
namespace mpm::vv {

/// Metrics that are readings are called this and the reading's id.
inline constexpr const char* reading_prefix = "reading.";

/// A reading as an entry of the catalogue of metrics.
Metric metric_of(const Reading& reading);

/// A number read off one or several curves or, where it is NaN, why there is none.
struct ReadOff {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string lack;    ///< for a person; empty beside a finite value
  std::size_t of = 0;  ///< which of several curves lacks it
};

/// The curve of this name and source, "run" or a reference solution; null without one.
const Curve* find_curve(const std::vector<Curve>& curves, const std::string& name, const std::string& source);

/// The ordinate at an abscissa: linear between the two samples where the curve first passes it or, with a
/// half-width `within` above zero, the mean of all samples at most that far from it, of which there must be
/// two. Never extrapolated: there is no value where the curve does not reach the abscissa.
ReadOff value_at(const Curve& curve, double abscissa, double within);

/// 200 abscissae equally far apart from end to end.
std::vector<double> abscissae_over(double from, double up_to);

/// A curve read by `value_at` at many abscissae or, with a `lack` for a person, as far as that went.
struct CurveReading {
  std::vector<double> y;
  std::string lack;
};
CurveReading read_over(const Curve& curve, const std::vector<double>& abscissae, double within);

/// What a reading says of a run with these curves. Over a reference solution its curve is taken at the very
/// abscissae at which the run's is.
ReadOff read_off(const Reading& reading, const std::vector<Curve>& curves);

/// The curve of a cut through a field: the particles whose own size reaches the line, in the order of their centers
/// along it; those at one place count with their mean. Its uncertainty is that of the place, half a particle's size
/// either way with a rectangular distribution, times the slope through the neighbours. Nothing if the line meets
/// less than two particles.
std::optional<Curve> curve_along(const Cut& cut, const FieldMap& field);

/// The stretch of abscissae over which curves are compared; open ends are those of the curves.
struct Stretch {
  std::optional<double> from, up_to;
};

/// How far apart curves are: the largest difference between the highest and the lowest of them at one
/// abscissa, over the largest magnitude of their mean, on a grid of 200 abscissae at each of which every
/// curve is read by `value_at`. The curves are at least two.
///
/// They are compared where all of them are. That must be 95 % of what they cover together, since curves of
/// which one breaks off have not been compared; an end that `stretch` gives is taken instead, and every curve
/// must reach it.
ReadOff curve_spread(const std::vector<const Curve*>& curves, const Stretch& stretch, double within);

}  // namespace mpm::vv
