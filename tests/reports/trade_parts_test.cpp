#include "reports/trade_parts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/demo_trade.hpp"

namespace mpm::reports {
namespace {

using support::demo::order_pointer;
using support::demo::precision_pointer;
using support::demo::scheme_pointer;
using support::demo::size_pointer;

vv::TradePoint point(const std::string& order, const std::string& size, double error, double seconds) {
  vv::TradePoint made;
  made.configuration = {{order_pointer, order}, {size_pointer, size}};
  made.error = error;
  made.timing = vv::Timing{.median = seconds, .low = seconds, .high = seconds, .repeats = 5};
  made.work.bytes = 1e9 * seconds;
  return made;
}

vv::TradeVerdict trade_of(std::vector<vv::TradePoint> points) {
  vv::TradeVerdict trade;
  trade.points = std::move(points);
  return trade;
}

/// USL costs 0.5, 0.8 and 0.9 of MUSL, its error is 1.1, 2 and 1.2 of MUSL's; each halving takes 8 times as
/// long.
vv::TradeVerdict two_orders() {
  return trade_of({point("musl", "8 mm", 0.1, 1.0), point("usl", "8 mm", 0.11, 0.5),
                   point("musl", "4 mm", 0.03, 8.0), point("usl", "4 mm", 0.06, 6.4),
                   point("musl", "2 mm", 0.01, 64.0), point("usl", "2 mm", 0.012, 57.6)});
}

const ChoiceEffect& effect_of(const std::vector<ChoiceEffect>& effects, const vv::Json& taken) {
  for (const ChoiceEffect& effect : effects)
    if (effect.taken == taken) return effect;
  throw std::runtime_error("no effect of " + taken.dump());
}

TEST(TradeParts, TakesTheMedianOverPairsThatDifferInOneChoiceOnly) {
  const vv::TradeVerdict trade = two_orders();
  const std::vector<ChoiceEffect> effects = effects_of({&trade});
  ASSERT_EQ(effects.size(), 3u);
  const ChoiceEffect& usl = effect_of(effects, "usl");
  EXPECT_EQ(usl.axis, order_pointer);
  EXPECT_EQ(usl.instead_of, "musl");
  EXPECT_EQ(usl.pairs, 3u);
  EXPECT_NEAR(usl.error.median, 1.2, 1e-12);
  EXPECT_NEAR(usl.error.low, 1.1, 1e-12);
  EXPECT_NEAR(usl.error.high, 2.0, 1e-12);
  EXPECT_NEAR(usl.seconds.median, 0.8, 1e-12);
  EXPECT_NEAR(usl.bytes.low, 0.5, 1e-12);
}

TEST(TradeParts, ComparesQuantitiesWithTheOneBeforeAndNamesWithTheFirst) {
  const vv::TradeVerdict trade = two_orders();
  const std::vector<ChoiceEffect> effects = effects_of({&trade});
  EXPECT_EQ(effect_of(effects, "4 mm").instead_of, "8 mm");
  EXPECT_EQ(effect_of(effects, "2 mm").instead_of, "4 mm");
  EXPECT_EQ(effect_of(effects, "2 mm").pairs, 2u);
  EXPECT_NEAR(effect_of(effects, "2 mm").seconds.median, std::sqrt(8.0 * 9.0), 1e-12)
      << "of two the geometric middle";

  const vv::TradeVerdict named = trade_of(
      {point("musl", "1 mm", 0.1, 1.0), point("usl", "1 mm", 0.1, 2.0), point("usf", "1 mm", 0.1, 3.0)});
  EXPECT_EQ(effect_of(effects_of({&named}), "usf").instead_of, "musl");
}

TEST(TradeParts, JoinsProblemsButNeverPairsAcrossThem) {
  const vv::TradeVerdict one = two_orders(), lone = trade_of({point("usl", "8 mm", 0.5, 1.0)}),
                         other = trade_of({point("musl", "16 mm", 0.5, 1.0)});
  EXPECT_EQ(effect_of(effects_of({&one, &one}), "usl").pairs, 6u);
  EXPECT_TRUE(effects_of({&lone, &other}).empty());
}

TEST(TradeParts, CountsPairsInWhichOneFailedApart) {
  vv::TradeVerdict trade = two_orders();
  trade.points[1].failure = "a particle left the grid";
  trade.points[2].failure = "a particle left the grid";
  trade.points[4].failure = trade.points[5].failure = "both";
  const std::vector<ChoiceEffect> effects = effects_of({&trade});
  const ChoiceEffect& usl = effect_of(effects, "usl");
  EXPECT_EQ(usl.pairs, 0u);
  EXPECT_EQ(usl.only_taken_failed, 1u);
  EXPECT_EQ(usl.only_other_failed, 1u);
  EXPECT_TRUE(std::isnan(usl.error.median));
}

TEST(TradeParts, LeavesRunsOfTheReferenceOutOfPairs) {
  vv::TradeVerdict trade = two_orders();
  trade.points[4].of_reference = true;
  EXPECT_EQ(effect_of(effects_of({&trade}), "usl").pairs, 2u);
  trade.points[4].of_reference = false;
  trade.points[5].of_reference = true;
  EXPECT_EQ(effect_of(effects_of({&trade}), "usl").pairs, 2u);
}

TEST(TradeParts, DoesNotCompareErrorsThatCannotBeToldApart) {
  vv::TradeVerdict trade = two_orders();
  for (vv::TradePoint& p : trade.points) p.uncertainty = 0.02;
  const std::vector<ChoiceEffect> effects = effects_of({&trade});
  const ChoiceEffect& usl = effect_of(effects, "usl");
  EXPECT_EQ(usl.error.pairs, 2u) << "0.01 and 0.012 are both within 0.02";
  EXPECT_EQ(usl.seconds.pairs, 3u);
}

TEST(TradeParts, JudgesFloatByTheErrorOfDouble) {
  vv::Case definition;
  std::vector<vv::TradePoint> points;
  /// A run on cells of a size by a method whose variant may set the precision.
  const auto add = [&](bool in_float, const std::string& size, vv::Json method, double error) {
    if (in_float) method[precision_pointer] = "float";
    vv::RunRequest request;
    request.scene.precision = in_float ? Precision::float32 : Precision::float64;
    request.changes = {vv::Json{{"set", {{"/scene/grid/cell_size", size}}}}, vv::Json{{"set", method}}};
    definition.runs.push_back(request);
    points.push_back(point("musl", size, error, 1.0));
    points.back().run = definition.runs.size() - 1;
  };
  const vv::Json none = vv::Json::object(), usl = {{"/scene/update_order", "usl"}};
  add(false, "8 mm", none, 0.1);
  add(true, "8 mm", none, 0.101);
  add(false, "4 mm", none, 0.02);
  add(true, "4 mm", none, 0.015);
  add(false, "2 mm", none, 0.01);
  add(true, "2 mm", usl, 0.5);
  vv::TradeVerdict trade = trade_of(points);
  std::optional<Rounding> rounding = rounding_of(trade, definition);
  ASSERT_TRUE(rounding);
  EXPECT_EQ(rounding->pairs, 2u) << "on the finest cells float differs in its order too";
  EXPECT_EQ(rounding->enough, 1u);
  EXPECT_NEAR(rounding->worst, 0.25, 1e-12);
  EXPECT_EQ(rounding->failed, 0u);
  trade.points[3].failure = "a value is not finite";
  rounding = rounding_of(trade, definition);
  EXPECT_EQ(rounding->pairs, 2u);
  EXPECT_EQ(rounding->failed, 1u);
  EXPECT_NEAR(rounding->worst, 0.01, 1e-12);
  trade.points.resize(1);
  EXPECT_FALSE(rounding_of(trade, definition));
}

TEST(TradeParts, PaysInWhatWasMeasuredOrCounted) {
  vv::TradeVerdict trade = two_orders();
  EXPECT_EQ(prices_of(trade), (std::vector{Price::seconds, Price::bytes}));
  for (vv::TradePoint& p : trade.points) {
    p.timing.reset();
    p.work.operations = 7.0;
  }
  EXPECT_EQ(prices_of(trade), std::vector{Price::bytes});
  for (vv::TradePoint& p : trade.points) p.work.bytes = 0.0;
  EXPECT_EQ(prices_of(trade), std::vector{Price::operations});
  for (vv::TradePoint& p : trade.points) p.work.operations = 0.0;
  EXPECT_EQ(prices_of(trade), std::vector{Price::particle_steps});
}

TEST(TradeParts, HasEachPriceOnAFrontOfItsOwnAndTheReferenceOnNone) {
  vv::TradePoint p = point("musl", "8 mm", 0.1, 1.0);
  p.on_time_front = true;
  EXPECT_TRUE(on_front(p, Price::seconds));
  EXPECT_FALSE(on_front(p, Price::bytes));
  p.of_reference = true;
  EXPECT_FALSE(on_front(p, Price::seconds));
}

TEST(TradeParts, WritesPricesInUnitsAPersonReads) {
  EXPECT_EQ(duration_markup(0.0123), "12.3\u00a0ms");
  EXPECT_EQ(duration_markup(0.41), "0.410\u00a0s");
  EXPECT_EQ(duration_markup(300.0), "5\u00a0min");
  EXPECT_EQ(duration_markup(9000.0), "2.50\u00a0h");
  EXPECT_EQ(price_markup(4.5e9, Price::bytes), "4.50\u00a0GB");
  EXPECT_EQ(price_markup(999.9e6, Price::bytes), "1.000\u00a0GB");
  EXPECT_EQ(percent_markup(0.0123), "1.23\u00a0%");
  EXPECT_EQ(percent_markup(5.734e-5), "0.00573\u00a0%");
  vv::TradePoint timed = point("musl", "8 mm", 0.1, 120.0);
  timed.timing->low = 114.0;
  EXPECT_EQ(timing_markup(timed), "2\u00a0min [1.90\u00a0…\u00a02]");
  vv::TradePoint p = point("musl", "8 mm", 0.1, 2.0);
  EXPECT_EQ(error_markup(p), "10\u00a0%");
  p.uncertainty = 0.012;
  EXPECT_EQ(error_markup(p), "10\u00a0% ± 1.2\u00a0%");
  p.error = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_markup(p), "–");
}

TEST(TradeParts, NamesAConfigurationByWhatVaries) {
  vv::TradeVerdict trade = trade_of({point("musl", "8 mm", 0.1, 1.0), point("usl", "8 mm", 0.1, 1.0)});
  EXPECT_EQ(name_of_configuration(trade, trade.points[1]), "USL");
  trade.points[1].configuration[1].second = "4 mm";
  EXPECT_EQ(name_of_configuration(trade, trade.points[1]), "USL, <i>h</i> = 4 mm");
}

}  // namespace
}  // namespace mpm::reports
