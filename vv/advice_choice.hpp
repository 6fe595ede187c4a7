#pragma once

#include <cstddef>
#include <optional>

#include "vv/trade.hpp"

/// Which of the measured configurations to take. Pure: from a verdict, to indices into its points.
///
/// Only offers are chosen: points with an error, not of the reference, of a price that is known. A price is
/// the median of the seconds; where no offer has been timed, the bytes moved. Of two at one price the more
/// accurate comes first, of two of one bound the cheaper, of two of one bound and price the earlier run.
namespace mpm::vv {

struct Choice {
  std::optional<std::size_t> point;      ///< empty: nothing measured meets it; then so are the others
  std::optional<std::size_t> runner_up;  ///< what would be chosen if the point were not there
  std::optional<std::size_t>
      cheaper;  ///< the most accurate of all that cost less: what is lost by saving more
  double margin =
      0.0;  ///< room that the point leaves, relative to what was asked, within [0, 1]; 0 without a point
};

/// The cheapest configuration whose `bound()` is at most `error` [-]. Prices are seconds if `by_time` and
/// there are any, else bytes.
Choice cheapest_within(const TradeVerdict& trade, double error, bool by_time);

/// The configuration of the smallest `bound()` among those whose slowest repeat took at most `seconds`: what
/// was not timed is not offered.
Choice most_accurate_within(const TradeVerdict& trade, double seconds);

/// Whether a configuration may be chosen at all: it has an error and is not what others are judged by.
bool is_offer(const TradePoint& point);

/// Whether any offer has been timed: prices are seconds then, and bytes otherwise.
bool has_times(const TradeVerdict& trade);

}  // namespace mpm::vv
