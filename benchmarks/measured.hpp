#pragma once

#include <vector>

namespace mpm::bench {

/// A figure that was measured several times.
struct Measured {
  double value = 0.0;  ///< median of the repetitions
  double low = 0.0;    ///< smallest of them
  double high = 0.0;   ///< largest of them

  double half_width() const { return (high - low) / 2; }
  /// Half width over median [-]; 0 for a median of 0.
  double spread() const { return value == 0 ? 0 : half_width() / value; }

  friend bool operator==(const Measured&, const Measured&) = default;
};

/// The middle one of the values, or the mean of the two middle ones. Throws std::invalid_argument without
/// values or with one that is not finite.
double median(std::vector<double> values);

/// Throws as `median`.
Measured summary_of(const std::vector<double>& repetitions);

/// The median, and an interval that holds the median of ever more repetitions with a probability of at least
/// 95 %, whatever their distribution: from the k-th smallest value to the k-th largest, where fewer than k of
/// so many fair coins show heads in at most 2.5 % of all throws; of fewer than six values all. Throws as
/// `median`.
Measured interval_of_median(std::vector<double> values);

/// One measurement of a rate.
struct Repetition {
  double rate;
  double time_lost;  ///< share of the wall time in which the program was not running [-]
};

/// A repetition that has lost more of its time than this was disturbed by other programs [-].
inline constexpr double bearable_loss = 0.02;

/// The repetitions that were not disturbed, but at least the three that were least (or all, of fewer). What
/// is kept depends on the time lost alone, never on the rate.
std::vector<Repetition> least_disturbed(std::vector<Repetition> all);

}  // namespace mpm::bench
