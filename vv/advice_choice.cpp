#include "vv/advice_choice.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <vector>

namespace mpm::vv {
namespace {

struct Offer {
  std::size_t index;
  double price;    // [s] or [B]
  double longest;  // slowest repeat [s]; 0 where bytes are the price
  double bound;
};

std::vector<Offer> offers_of(const TradeVerdict& trade, bool by_time) {
  std::vector<Offer> offers;
  for (std::size_t k = 0; k < trade.points.size(); ++k) {
    const TradePoint& point = trade.points[k];
    if (!is_offer(point) || (by_time && !point.timing)) {
      continue;
    }
    offers.push_back({k, by_time ? point.timing->median : point.work.bytes,
                      by_time ? point.timing->high : 0.0, point.bound()});
  }
  return offers;
}

bool cheaper_first(const Offer& one, const Offer& other) {
  return std::tie(one.price, one.bound, one.index) < std::tie(other.price, other.bound, other.index);
}

bool better_first(const Offer& one, const Offer& other) {
  return std::tie(one.bound, one.price, one.index) < std::tie(other.bound, other.price, other.index);
}

template <typename Meets, typename Before>
Choice choose(const std::vector<Offer>& offers, Meets meets, Before before) {
  std::vector<Offer> meeting;
  std::copy_if(offers.begin(), offers.end(), std::back_inserter(meeting), meets);
  std::sort(meeting.begin(), meeting.end(), before);
  Choice choice;
  if (meeting.empty()) {
    return choice;
  }
  choice.point = meeting[0].index;
  if (meeting.size() > 1) {
    choice.runner_up = meeting[1].index;
  }
  std::vector<Offer> below;
  std::copy_if(offers.begin(), offers.end(), std::back_inserter(below),
               [&](const Offer& offer) { return offer.price < meeting[0].price; });
  if (!below.empty()) {
    choice.cheaper = std::min_element(below.begin(), below.end(), better_first)->index;
  }
  return choice;
}

// Of zero asked, zero is used in full.
double room(double used, double asked) { return asked > 0.0 ? (asked - used) / asked : 0.0; }

}  // namespace

bool is_offer(const TradePoint& point) {
  return !point.of_reference && point.failure.empty() && std::isfinite(point.error);
}

bool has_times(const TradeVerdict& trade) {
  return std::any_of(trade.points.begin(), trade.points.end(),
                     [](const TradePoint& point) { return is_offer(point) && point.timing.has_value(); });
}

Choice cheapest_within(const TradeVerdict& trade, double error, bool by_time) {
  const std::vector<Offer> offers = offers_of(trade, by_time && has_times(trade));
  Choice choice = choose(
      offers, [&](const Offer& offer) { return offer.bound <= error; }, cheaper_first);
  if (choice.point) {
    choice.margin = room(trade.points[*choice.point].bound(), error);
  }
  return choice;
}

Choice most_accurate_within(const TradeVerdict& trade, double seconds) {
  const std::vector<Offer> offers = offers_of(trade, true);
  Choice choice = choose(
      offers, [&](const Offer& offer) { return offer.longest <= seconds; }, better_first);
  if (choice.point) {
    choice.margin = room(trade.points[*choice.point].timing->high, seconds);
  }
  return choice;
}

}  // namespace mpm::vv
