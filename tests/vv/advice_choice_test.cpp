#include "vv/advice_choice.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace mpm::vv {
namespace {

TradePoint offer(double error, double seconds, double bytes) {
  TradePoint point;
  point.error = error;
  point.timing = Timing{.median = seconds, .low = 0.9 * seconds, .high = 1.25 * seconds, .repeats = 5};
  point.work.bytes = bytes;
  return point;
}

TradeVerdict four_offers() {
  TradeVerdict trade;
  trade.points = {offer(0.04, 1.0, 4e9), offer(0.02, 4.0, 3e9), offer(0.01, 16.0, 2e9),
                  offer(0.008, 8.0, 1e9)};
  return trade;
}

TEST(AdviceChoice, TakesTheCheapestThatMeetsTheErrorByTime) {
  const Choice choice = cheapest_within(four_offers(), 0.025, true);
  EXPECT_EQ(choice.point, 1u);
  EXPECT_EQ(choice.runner_up, 3u);
  EXPECT_EQ(choice.cheaper, 0u);
  EXPECT_NEAR(choice.margin, 0.2, 1e-12);
}

TEST(AdviceChoice, CountsBytesWhenAskedTo) {
  const Choice choice = cheapest_within(four_offers(), 0.025, false);
  EXPECT_EQ(choice.point, 3u);
  EXPECT_EQ(choice.runner_up, 2u);
  EXPECT_FALSE(choice.cheaper);
}

TEST(AdviceChoice, CountsBytesWhereNothingIsTimed) {
  TradeVerdict trade = four_offers();
  for (TradePoint& point : trade.points) {
    point.timing.reset();
  }
  EXPECT_FALSE(has_times(trade));
  EXPECT_EQ(cheapest_within(trade, 0.025, true).point, 3u);
  EXPECT_FALSE(most_accurate_within(trade, 100.0).point);
}

TEST(AdviceChoice, DoesNotOfferWhatWasNotTimedBesideWhatWas) {
  TradeVerdict trade = four_offers();
  trade.points[1].timing.reset();
  EXPECT_TRUE(has_times(trade));
  EXPECT_EQ(cheapest_within(trade, 0.025, true).point, 3u);
}

TEST(AdviceChoice, PromisesTheBoundNotTheError) {
  TradeVerdict trade = four_offers();
  trade.points[1].uncertainty = 0.006;
  EXPECT_EQ(cheapest_within(trade, 0.025, true).point, 3u);
  const Choice choice = cheapest_within(trade, trade.points[1].bound(), true);
  EXPECT_EQ(choice.point, 1u) << "a bound that equals the error asked for meets it";
  EXPECT_NEAR(choice.margin, 0.0, 1e-12);
}

TEST(AdviceChoice, NeverOffersTheReferenceNorAFailure) {
  TradeVerdict trade = four_offers();
  trade.points[0].of_reference = true;
  trade.points[1].failure = "a particle left the grid";
  trade.points[2].error = std::numeric_limits<double>::quiet_NaN();
  const Choice choice = cheapest_within(trade, 1.0, true);
  EXPECT_EQ(choice.point, 3u);
  EXPECT_FALSE(choice.runner_up);
  EXPECT_FALSE(choice.cheaper);
  EXPECT_EQ(most_accurate_within(trade, 100.0).point, 3u);
  EXPECT_FALSE(most_accurate_within(trade, 5.0).point);
}

TEST(AdviceChoice, TakesTheMoreAccurateOfTwoAtOnePriceThenTheEarlier) {
  TradeVerdict trade;
  trade.points = {offer(0.02, 2.0, 1e9), offer(0.01, 2.0, 1e9), offer(0.01, 2.0, 1e9)};
  const Choice choice = cheapest_within(trade, 0.05, true);
  EXPECT_EQ(choice.point, 1u);
  EXPECT_EQ(choice.runner_up, 2u);
  EXPECT_FALSE(choice.cheaper) << "what costs the same is not cheaper";
}

TEST(AdviceChoice, LosesLeastByGoingCheaper) {
  TradeVerdict trade = four_offers();
  trade.points.push_back(offer(0.03, 2.0, 5e9));
  EXPECT_EQ(cheapest_within(trade, 0.025, true).cheaper, 4u) << "0.03, not 0.04 which costs less still";
}

TEST(AdviceChoice, SaysThatNothingMeetsIt) {
  const Choice choice = cheapest_within(four_offers(), 0.001, true);
  EXPECT_FALSE(choice.point);
  EXPECT_FALSE(choice.runner_up);
  EXPECT_FALSE(choice.cheaper);
  EXPECT_EQ(choice.margin, 0.0);
  EXPECT_FALSE(cheapest_within(TradeVerdict{}, 1.0, true).point);
}

TEST(AdviceChoice, TakesTheMostAccurateWhoseSlowestRepeatIsWithinTheTime) {
  const Choice choice = most_accurate_within(four_offers(), 10.0);
  EXPECT_EQ(choice.point, 3u);
  EXPECT_EQ(choice.runner_up, 1u);
  EXPECT_EQ(choice.cheaper, 1u);
  EXPECT_NEAR(choice.margin, 0.0, 1e-12);
  EXPECT_EQ(most_accurate_within(four_offers(), 9.9).point, 1u)
      << "the slowest repeat took 10 s, the median 8 s";
  EXPECT_NEAR(most_accurate_within(four_offers(), 6.25).margin, 0.2, 1e-12);
}

TEST(AdviceChoice, TakesTheCheaperOfTwoOfOneBound) {
  TradeVerdict trade;
  trade.points = {offer(0.01, 4.0, 1e9), offer(0.01, 2.0, 1e9)};
  EXPECT_EQ(most_accurate_within(trade, 100.0).point, 1u);
}

}  // namespace
}  // namespace mpm::vv
