#include "vv/grid_convergence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace mpm::vv {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double highest_order = 2.0;
constexpr double least_reliable_order = 0.5;
constexpr double safety_factor = 1.25;  // for three levels or more [Roache94]

/// Three levels; the finest first.
struct Triplet {
  double r21, r32;
  double f1, f2, f3;
};

std::optional<Triplet> finest_three(const std::vector<double>& cell_size, const std::vector<double>& value) {
  const std::size_t count = cell_size.size();
  if (count < 3 || value.size() != count) return std::nullopt;
  const Triplet levels{cell_size[count - 2] / cell_size[count - 1],
                       cell_size[count - 3] / cell_size[count - 2], value[count - 1], value[count - 2],
                       value[count - 3]};
  const bool refined = cell_size[count - 1] > 0.0 && levels.r21 > 1.0 && levels.r32 > 1.0 &&
                       std::isfinite(cell_size[count - 3]);
  const bool finite = std::isfinite(levels.f1) && std::isfinite(levels.f2) && std::isfinite(levels.f3);
  if (!refined || !finite || levels.f1 == 0.0) return std::nullopt;
  return levels;
}

/// (h_3^p - h_2^p) / (h_2^p - h_1^p), which grows with p.
double ratio_of_differences(const Triplet& levels, double order) {
  if (order == 0.0) return std::log(levels.r32) / std::log(levels.r21);  // the limit
  return std::pow(levels.r21, order) * std::expm1(order * std::log(levels.r32)) /
         std::expm1(order * std::log(levels.r21));
}

/// By bisection, which also finds what the usual fixed-point iteration runs away from. Orders beyond the ends
/// are as good as these: far above two, or far below reliable.
double observed_order(const Triplet& levels) {
  const double ratio = (levels.f3 - levels.f2) / (levels.f2 - levels.f1);
  double low = -20.0, high = 20.0;
  for (int halving = 0; halving < 100; ++halving) {
    const double middle = (low + high) / 2;
    (ratio_of_differences(levels, middle) < ratio ? low : high) = middle;
  }
  return (low + high) / 2;
}

double relative_range(const Triplet& levels) {
  const auto [least, greatest] = std::minmax({levels.f1, levels.f2, levels.f3});
  return (greatest - least) / std::abs(levels.f1);
}

GridConvergence by_range(const Triplet& levels, bool monotone, double order, const std::string& why) {
  return {monotone, order, nothing, relative_range(levels), "range of three levels: " + why};
}

}  // namespace

std::optional<GridConvergence> grid_convergence(const std::vector<double>& cell_size,
                                                const std::vector<double>& value) {
  const std::optional<Triplet> levels = finest_three(cell_size, value);
  if (!levels) return std::nullopt;
  const double fine_step = levels->f1 - levels->f2, coarse_step = levels->f2 - levels->f3;
  if (!(fine_step * coarse_step > 0.0))
    return by_range(*levels, false, nothing, "the values are not monotone");
  const double order = observed_order(*levels);
  if (order < least_reliable_order) {
    return by_range(*levels, true, order, fmt::format("the observed order {:.2f} is not reliable", order));
  }
  const bool limited = order > highest_order;
  const double taken = limited ? highest_order : order;
  const double correction = fine_step / (std::pow(levels->r21, taken) - 1.0);
  return GridConvergence{true, order, levels->f1 + correction,
                         safety_factor * std::abs(correction / levels->f1),
                         fmt::format("grid convergence index at {} order {:.2f}",
                                     limited ? "the formal" : "the observed", taken)};
}

}  // namespace mpm::vv
