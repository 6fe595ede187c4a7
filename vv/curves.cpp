#include "vv/curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace mpm::vv {
namespace {

/// An abscissa beyond the end of a curve by less than this share of what the curve covers is at its end: sums
/// of increments are rounded.
constexpr double rounding = 1e-9;

/// The abscissae a curve covers.
struct Range {
  double begin, end;

  double length() const { return end - begin; }
};

/// Nothing without samples, or with an abscissa that is not finite.
std::optional<Range> range_of(const Curve& curve) {
  const bool finite = std::all_of(curve.x.begin(), curve.x.end(), [](double x) { return std::isfinite(x); });
  if (curve.x.empty() || !finite) return std::nullopt;
  const auto [least, greatest] = std::minmax_element(curve.x.begin(), curve.x.end());
  return Range{*least, *greatest};
}

/// `abscissa` itself, or the end of the range that it misses by rounding; nothing beyond.
std::optional<double> inside(const Range& range, double abscissa) {
  const double inner = std::clamp(abscissa, range.begin, range.end);
  if (std::abs(inner - abscissa) <= rounding * range.length()) return inner;
  return std::nullopt;
}

std::string unit_after(const Curve& curve) { return curve.x_name == "settlement" ? " m" : ""; }

ReadOff out_of_reach(const Curve& curve, double abscissa) {
  const std::optional<Range> range = range_of(curve);
  if (!range) return {.lack = fmt::format("the curve {} has no samples", curve.name)};
  return {.lack =
              fmt::format("the curve {} goes from {:.6g} to {:.6g}{} and does not reach {:.6g}{}", curve.name,
                          range->begin, range->end, unit_after(curve), abscissa, unit_after(curve))};
}

ReadOff found(double value) {
  if (std::isfinite(value)) return {.value = value, .lack = {}};
  return {.lack = "the value read off the curve is not a finite number"};
}

ReadOff interpolated(const Curve& curve, double abscissa) {
  const std::optional<Range> range = range_of(curve);
  const std::optional<double> x = range ? inside(*range, abscissa) : std::nullopt;
  if (!x) return out_of_reach(curve, abscissa);
  for (std::size_t k = 0; k + 1 < curve.x.size(); ++k) {
    const double before = curve.x[k], after = curve.x[k + 1];
    if (std::min(before, after) > *x || std::max(before, after) < *x) continue;
    if (before == after) return found(curve.y[k]);
    return found(std::lerp(curve.y[k], curve.y[k + 1], (*x - before) / (after - before)));
  }
  return found(curve.y.front());
}

std::vector<std::size_t> samples_near(const Curve& curve, double abscissa, double within) {
  std::vector<std::size_t> near;
  for (std::size_t k = 0; k < curve.x.size(); ++k) {
    if (std::abs(curve.x[k] - abscissa) <= within) near.push_back(k);
  }
  return near;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// The reference's curve where the run's is read.
ReadOff read_alike(const Curve& reference, const Curve& run, const Reading& reading) {
  if (reading.within == 0.0) return value_at(reference, reading.at, 0.0);
  std::vector<double> values;
  for (const std::size_t sample : samples_near(run, reading.at, reading.within)) {
    ReadOff value = interpolated(reference, run.x[sample]);
    if (!value.lack.empty()) return value;
    values.push_back(value.value);
  }
  return found(mean_of(values));
}

ReadOff no_curve(const std::string& name, const std::string& source) {
  return {.lack = source == "run" ? fmt::format("the run has no curve {}", name)
                                  : fmt::format("{} has no curve {}", source, name)};
}

}  // namespace

Metric metric_of(const Reading& reading) {
  const bool ratio = !reading.over.empty() || reading.curve == "volumetric_strain";
  return {reading_prefix + reading.id, ratio ? "-" : "Pa", reading.over, reading.title};
}

const Curve* find_curve(const std::vector<Curve>& curves, const std::string& name,
                        const std::string& source) {
  const auto curve = std::find_if(curves.begin(), curves.end(), [&](const Curve& each) {
    return each.name == name && each.source == source;
  });
  return curve == curves.end() ? nullptr : &*curve;
}

ReadOff value_at(const Curve& curve, double abscissa, double within) {
  const std::optional<Range> range = range_of(curve);
  if (within == 0.0 || !range || !inside(*range, abscissa)) return interpolated(curve, abscissa);
  std::vector<double> values;
  for (const std::size_t sample : samples_near(curve, abscissa, within)) values.push_back(curve.y[sample]);
  if (values.size() >= 2) return found(mean_of(values));
  return {.lack = fmt::format("the curve {} has fewer than two samples within {:.6g}{} of {:.6g}{}",
                              curve.name, within, unit_after(curve), abscissa, unit_after(curve))};
}

ReadOff read_off(const Reading& reading, const std::vector<Curve>& curves) {
  const Curve* run = find_curve(curves, reading.curve, "run");
  if (!run) return no_curve(reading.curve, "run");
  ReadOff value = value_at(*run, reading.at, reading.within);
  if (!value.lack.empty() || reading.over.empty()) return value;
  const Curve* reference = find_curve(curves, reading.curve, reading.over);
  if (!reference) return no_curve(reading.curve, reading.over);
  ReadOff unit = read_alike(*reference, *run, reading);
  if (!unit.lack.empty()) return {.lack = reading.over + ": " + unit.lack};
  return found(value.value / unit.value);
}

}  // namespace mpm::vv
