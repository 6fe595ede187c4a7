#include "benchmarks/measured.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mpm::bench {

double median(std::vector<double> values) {
  if (values.empty()) throw std::invalid_argument("the median of nothing");
  if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); })) {
    throw std::invalid_argument("the median of values that are not all finite");
  }
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

Measured summary_of(const std::vector<double>& repetitions) {
  const double middle = median(repetitions);
  const auto [low, high] = std::minmax_element(repetitions.begin(), repetitions.end());
  return {middle, *low, *high};
}

Measured interval_of_median(std::vector<double> values) {
  const double middle = median(values);
  std::sort(values.begin(), values.end());
  const double n = static_cast<double>(values.size());
  // The chance of exactly `heads` heads, then of as many or fewer.
  double exactly = std::pow(0.5, n), at_most = exactly;
  std::size_t heads = 0;
  while (at_most <= 0.025) {
    ++heads;
    exactly *= (n - static_cast<double>(heads) + 1) / static_cast<double>(heads);
    at_most += exactly;
  }
  const std::size_t outermost = heads > 0 ? heads - 1 : 0;
  return {middle, values[outermost], values[values.size() - 1 - outermost]};
}

std::vector<Repetition> least_disturbed(std::vector<Repetition> all) {
  constexpr std::size_t fewest = 3;
  std::stable_sort(all.begin(), all.end(),
                   [](const Repetition& a, const Repetition& b) { return a.time_lost < b.time_lost; });
  const auto disturbed = std::find_if(all.begin(), all.end(), [](const Repetition& repetition) {
    return repetition.time_lost > bearable_loss;
  });
  const std::size_t undisturbed = static_cast<std::size_t>(disturbed - all.begin());
  all.erase(all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), std::max(undisturbed, fewest))),
            all.end());
  return all;
}

}  // namespace mpm::bench
