#pragma once

#include <limits>
#include <string>
#include <vector>

#include "vv/norms.hpp"
#include "vv/verdict.hpp"

/// Numbers read off curves.
namespace mpm::vv {

/// Metrics that are readings are called this and the reading's id.
inline constexpr const char* reading_prefix = "reading.";

/// A reading as an entry of the catalogue of metrics.
Metric metric_of(const Reading& reading);

/// A number read off a curve or, where it is NaN, why there is none.
struct ReadOff {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string lack;  ///< for a person; empty beside a finite value
};

/// The curve of this name and source, "run" or a reference solution; null without one.
const Curve* find_curve(const std::vector<Curve>& curves, const std::string& name, const std::string& source);

/// The ordinate at an abscissa: linear between the two samples where the curve first passes it or, with a
/// half-width `within` above zero, the mean of all samples at most that far from it, of which there must be
/// two. Never extrapolated: there is no value where the curve does not reach the abscissa.
ReadOff value_at(const Curve& curve, double abscissa, double within);

/// What a reading says of a run with these curves. Over a reference solution its curve is taken at the very
/// abscissae at which the run's is.
ReadOff read_off(const Reading& reading, const std::vector<Curve>& curves);

}  // namespace mpm::vv
