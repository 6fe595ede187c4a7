#include "vv/curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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

/// A particle on the line of a cut.
struct Met {
  double place, value, half_size;
};

/// Those at one place as one.
std::vector<Met> merged(std::vector<Met> met) {
  std::stable_sort(met.begin(), met.end(), [](const Met& a, const Met& b) { return a.place < b.place; });
  std::vector<Met> all;
  for (std::size_t k = 0; k < met.size();) {
    std::size_t end = k;
    Met sum{0.0, 0.0, 0.0};
    for (; end < met.size() && met[end].place - met[k].place <= rounding * met[k].half_size; ++end) {
      sum.value += met[end].value;
      sum.half_size = std::max(sum.half_size, met[end].half_size);
    }
    all.push_back({met[k].place, sum.value / static_cast<double>(end - k), sum.half_size});
    k = end;
  }
  return all;
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

/// What curves cover: all of them, and at least one of them.
struct Coverage {
  Range common, together;
  std::size_t last_to_begin = 0, first_to_end = 0;  ///< the curves that bound the common part
};

Coverage coverage_of(const std::vector<Range>& ranges) {
  Coverage coverage{ranges.front(), ranges.front()};
  for (std::size_t k = 1; k < ranges.size(); ++k) {
    coverage.together.begin = std::min(coverage.together.begin, ranges[k].begin);
    coverage.together.end = std::max(coverage.together.end, ranges[k].end);
    if (ranges[k].begin > coverage.common.begin) {
      coverage.common.begin = ranges[k].begin;
      coverage.last_to_begin = k;
    }
    if (ranges[k].end < coverage.common.end) {
      coverage.common.end = ranges[k].end;
      coverage.first_to_end = k;
    }
  }
  return coverage;
}

/// The curve that cuts off most of what the others cover.
std::size_t shortest_of(const Coverage& coverage) {
  const double missing_first = coverage.common.begin - coverage.together.begin;
  const double missing_last = coverage.together.end - coverage.common.end;
  return missing_last >= missing_first ? coverage.first_to_end : coverage.last_to_begin;
}

ReadOff spread_over(const std::vector<const Curve*>& curves, const Range& range, double within) {
  double largest_difference = 0.0, largest_mean = 0.0;
  for (const double abscissa : abscissae_over(range.begin, range.end)) {
    std::vector<double> values;
    for (const Curve* curve : curves) {
      ReadOff value = value_at(*curve, abscissa, within);
      if (!value.lack.empty()) return {.lack = value.lack, .of = values.size()};
      values.push_back(value.value);
    }
    const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
    largest_difference = std::max(largest_difference, *greatest - *least);
    largest_mean = std::max(largest_mean, std::abs(mean_of(values)));
  }
  return found(largest_difference / largest_mean);
}

}  // namespace

Metric metric_of(const Reading& reading) {
  const bool ratio = !reading.over.empty() || reading.curve == "volumetric_strain";
  return {reading_prefix + reading.id, ratio ? "-" : "Pa", reading.over, reading.title};
}

std::optional<Curve> curve_along(const Cut& cut, const FieldMap& field) {
  const bool along_x = cut.along == 0;
  std::vector<Met> on_line;
  for (std::size_t p = 0; p < field.value.size(); ++p) {
    const double across = along_x ? field.y[p] : field.x[p], reach = along_x ? field.half_y[p] : field.half_x[p];
    if (std::abs(across - cut.at) > reach * (1 + rounding)) continue;
    on_line.push_back({along_x ? field.x[p] : field.y[p], field.value[p], along_x ? field.half_x[p] : field.half_y[p]});
  }
  const std::vector<Met> met = merged(std::move(on_line));
  if (met.size() < 2) return std::nullopt;
  Curve curve;
  curve.name = cut.id;
  curve.source = "run";
  curve.x_name = "position";
  for (std::size_t k = 0; k < met.size(); ++k) {
    const Met &before = met[k == 0 ? 0 : k - 1], &after = met[std::min(k + 1, met.size() - 1)];
    const double slope = (after.value - before.value) / (after.place - before.place);
    curve.x.push_back(met[k].place);
    curve.y.push_back(met[k].value);
    curve.uncertainty.push_back(std::abs(slope) * met[k].half_size / std::numbers::sqrt3);
  }
  return curve;
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

std::vector<double> abscissae_over(double from, double up_to) {
  constexpr std::size_t steps = 200;
  std::vector<double> abscissae;
  for (std::size_t step = 0; step < steps; ++step)
    abscissae.push_back(std::lerp(from, up_to, static_cast<double>(step) / static_cast<double>(steps - 1)));
  return abscissae;
}

CurveReading read_over(const Curve& curve, const std::vector<double>& abscissae, double within) {
  CurveReading reading;
  for (const double abscissa : abscissae) {
    const ReadOff value = value_at(curve, abscissa, within);
    reading.lack = value.lack;
    if (!reading.lack.empty()) break;
    reading.y.push_back(value.value);
  }
  return reading;
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

ReadOff curve_spread(const std::vector<const Curve*>& curves, const Stretch& stretch, double within) {
  constexpr double least_share = 0.95;
  std::vector<Range> ranges;
  for (const Curve* curve : curves) {
    const std::optional<Range> range = range_of(*curve);
    if (!range) return {.lack = fmt::format("the curve {} has no samples", curve->name), .of = ranges.size()};
    for (const std::optional<double>& end : {stretch.from, stretch.up_to}) {
      if (!end || inside(*range, *end)) continue;
      return {.lack = out_of_reach(*curve, *end).lack, .of = ranges.size()};
    }
    ranges.push_back(*range);
  }
  Coverage coverage = coverage_of(ranges);
  if (stretch.from) coverage.common.begin = coverage.together.begin = *stretch.from;
  if (stretch.up_to) coverage.common.end = coverage.together.end = *stretch.up_to;
  const double all = coverage.together.length();
  const double share = all > 0.0 ? std::max(0.0, coverage.common.length()) / all : 0.0;
  if (share >= least_share) return spread_over(curves, coverage.common, within);
  const std::size_t shortest = shortest_of(coverage);
  return {.lack = fmt::format(
              "the curve {} goes from {:.6g} to {:.6g}{}: the curves have only {:.1f} % in common",
              curves[shortest]->name, ranges[shortest].begin, ranges[shortest].end,
              unit_after(*curves[shortest]), 100 * share),
          .of = shortest};
}

}  // namespace mpm::vv
