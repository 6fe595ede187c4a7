#include "vv/behaviour.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace mpm::vv {
namespace {

/// Particles within `reach` of a place, or the three nearest if there are fewer. Positions need not be
/// sorted.
std::vector<std::size_t> neighbours(const std::vector<double>& position, double place, double reach) {
  std::vector<std::size_t> order(position.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto distance = [&](std::size_t p) { return std::abs(position[p] - place); };
  const auto within = static_cast<std::size_t>(
      std::count_if(order.begin(), order.end(), [&](std::size_t p) { return distance(p) <= reach; }));
  const std::size_t count = std::min(std::max<std::size_t>(within, 3), order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                    [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
  order.resize(count);
  return order;
}

/// Value at `place` of the weighted least-squares line through the chosen points.
double line_through(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& weight,
                    const std::vector<std::size_t>& chosen, double place) {
  double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
  for (std::size_t p : chosen) {
    const double d = x[p] - place;
    w += weight[p];
    wx += weight[p] * d;
    wy += weight[p] * y[p];
    wxx += weight[p] * d * d;
    wxy += weight[p] * d * y[p];
  }
  const double determinant = w * wxx - wx * wx;
  // All points in one place have no line; their mean is the value there.
  if (!(determinant > 1e-12 * w * wxx)) return wy / w;
  return (wxx * wy - wx * wxy) / determinant;
}

/// Least and largest of the samples around one, two on either side as far as there are.
std::pair<double, double> range_around(const std::vector<double>& value, std::size_t k) {
  const std::size_t first = k < 2 ? 0 : k - 2, last = std::min(k + 2, value.size() - 1);
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (std::size_t j = first; j <= last; ++j) {
    if (j == k) continue;
    least = std::min(least, value[j]);
    most = std::max(most, value[j]);
  }
  // At an end nothing is seen of what lies beyond: there a trend may go on.
  if (k < 2 || k + 2 >= value.size()) {
    const double span = most - least;
    least -= span;
    most += span;
  }
  return {least, most};
}

/// The signal without single spikes: the few samples that stick out most, a hundredth of all or one, are taken into the
/// range of their neighbours. A ringing loses no more than these.
std::vector<double> without_spikes(const std::vector<double>& value) {
  std::vector<double> calm = value, distance(value.size());
  std::vector<std::size_t> order(value.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t k = 0; k < value.size(); ++k) {
    const auto [least, most] = range_around(value, k);
    distance[k] = std::max({0.0, least - value[k], value[k] - most});
  }
  const auto few = static_cast<std::ptrdiff_t>(std::max<std::size_t>(1, value.size() / 100));
  std::partial_sort(order.begin(), order.begin() + few, order.end(),
                    [&](std::size_t a, std::size_t b) { return distance[a] > distance[b]; });
  for (auto k = order.begin(); k != order.begin() + few; ++k) {
    const auto [least, most] = range_around(value, *k);
    if (least <= most) calm[*k] = std::clamp(value[*k], least, most);  // else no neighbour is a number
  }
  return calm;
}

double norm_of(const std::vector<double>& value, const std::vector<double>& weight) {
  double squares = 0.0;
  for (std::size_t p = 0; p < value.size(); ++p) squares += weight[p] * value[p] * value[p];
  return std::sqrt(squares);
}

/// How far beyond its limit a measure is; a measure that is no number is infinitely far.
double excess(double measure, double limit) {
  if (std::isnan(measure)) return std::numeric_limits<double>::infinity();
  return limit > 0.0 ? measure / limit : (measure > 0.0 ? std::numeric_limits<double>::infinity() : 0.0);
}

}  // namespace

const char* name_of(StabilityClass stability) {
  switch (stability) {
    case StabilityClass::accurate:
      return "accurate";
    case StabilityClass::inaccurate:
      return "inaccurate";
    case StabilityClass::drifting:
      return "drifting";
    case StabilityClass::oscillating:
      return "oscillating";
    case StabilityClass::diverged:
      return "diverged";
    case StabilityClass::refused:
      return "refused";
  }
  return "unknown";
}

SignalShape shape_of_signal(const std::vector<double>& time, const std::vector<double>& value, double from,
                            double scale) {
  if (time.size() != value.size()) throw std::invalid_argument("a signal needs a value for every time");
  if (!(scale > 0.0)) throw std::invalid_argument("the scale of a signal must be positive");
  const auto first = std::lower_bound(time.begin(), time.end(), from) - time.begin();
  const std::vector<double> t(time.begin() + first, time.end()), v(value.begin() + first, value.end());
  constexpr std::size_t fewest = 8;
  if (t.size() < fewest)
    throw std::invalid_argument("a signal needs " + std::to_string(fewest) + " samples in its window, this one has " +
                                std::to_string(t.size()));
  const std::vector<double> calm = without_spikes(v);
  std::vector<std::size_t> all(t.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const std::vector<double> one(t.size(), 1.0);
  const double begin = line_through(t, calm, one, all, t.front()), end = line_through(t, calm, one, all, t.back());
  SignalShape shape;
  shape.drift = std::abs(end - begin) / scale;
  double squares = 0.0;
  for (std::size_t k = 0; k < t.size(); ++k) {
    const double line = begin + (end - begin) * (t[k] - t.front()) / (t.back() - t.front());
    squares += (calm[k] - line) * (calm[k] - line);
    // Written so that a value that is not a number is found, which std::max would lose.
    const double spike = std::abs(v[k] - calm[k]) / scale;
    if (!(spike <= shape.spike)) shape.spike = spike;
  }
  shape.ringing = std::sqrt(squares / static_cast<double>(t.size())) / scale;
  return shape;
}

std::vector<double> rough_part(const std::vector<double>& place, const std::vector<double>& value,
                               const std::vector<double>& weight, double reach) {
  std::vector<double> rough(value.size());
  for (std::size_t p = 0; p < value.size(); ++p) {
    const auto near = neighbours(place, place[p], reach);
    rough[p] = value[p] - line_through(place, value, weight, near, place[p]);
  }
  return rough;
}

double zigzag_of_field(const std::vector<double>& place, const std::vector<double>& value,
                       const std::vector<double>& weight, double reach) {
  const double whole = norm_of(value, weight);
  if (value.size() < 4 || whole == 0.0) return 0.0;
  return norm_of(rough_part(place, value, weight, reach), weight) / whole;
}

StabilityClass class_of(const Behaviour& behaviour, const BehaviourLimits& limits) {
  if (behaviour.refused) return StabilityClass::refused;
  if (behaviour.failed) return StabilityClass::diverged;
  const double drift = excess(behaviour.signal.drift, limits.drift);
  const double ringing =
      std::max(excess(behaviour.signal.ringing, limits.ringing), excess(behaviour.zigzag, limits.zigzag));
  if (ringing > 1.0 && ringing >= drift) return StabilityClass::oscillating;
  if (drift > 1.0) return StabilityClass::drifting;
  return excess(behaviour.error, limits.error) > 1.0 ? StabilityClass::inaccurate : StabilityClass::accurate;
}

}  // namespace mpm::vv
