#include "benchmarks/machine_limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "benchmarks/measuring.hpp"

namespace mpm::bench {
namespace {

TEST(MachineLimits, are_positive_and_agree_with_each_other) {
  Results results;
  const Mishaps mishaps = measure(
      {}, {}, {.repetitions = 3, .seconds_each = 0.02}, [](const auto&) {}, results);
  EXPECT_TRUE(mishaps.errors.empty());
  EXPECT_GE(mishaps.time_lost, 0);
  EXPECT_LT(mishaps.time_lost, 1);
  const std::vector<Limit>& limits = results.limits;
  ASSERT_EQ(limits.size(), 9u);
  for (const Limit& limit : limits) {
    EXPECT_TRUE(std::isfinite(limit.rate.high)) << limit.name;
    EXPECT_GT(limit.rate.low, 0) << limit.name;
    EXPECT_LE(limit.rate.low, limit.rate.value) << limit.name;
    EXPECT_LE(limit.rate.value, limit.rate.high) << limit.name;
  }
  // Memory further away is not faster; a fifth for the noise of a machine on which other things run.
  const auto rate = [&](const char* name) { return limit_named(limits, name).rate.value; };
  EXPECT_GT(rate("triad_l2"), 0.8 * rate("triad_l3"));
  EXPECT_GT(rate("triad_l2"), 0.8 * rate("triad_memory"));
  // No loop was optimised away: no core does more than 64 double multiply-adds a cycle at 6 GHz, or moves
  // more than 192 bytes a cycle, and none handles a particle in less than a cycle.
  EXPECT_LT(rate("fma_peak"), 64 * 2 * 6e9);
  EXPECT_LT(rate("triad_l2"), 192 * 6e9);
  EXPECT_LT(rate("scatter"), 6e9);
  EXPECT_LT(rate("gather"), 6e9);
  // A scatter of nine nodes and four numbers is 36 multiply-adds, a gather 18.
  EXPECT_LT(rate("scatter") * 72, rate("fma_peak"));
  EXPECT_LT(rate("gather") * 36, rate("fma_peak"));
}

TEST(MachineLimits, are_found_by_name) {
  const std::vector<Limit> limits = {{"a", "A", "B/s", {1, 1, 1}}, {"b", "B", "B/s", {2, 2, 2}}};
  EXPECT_EQ(limit_named(limits, "b").rate.value, 2);
  EXPECT_THROW(limit_named(limits, "c"), std::out_of_range);
}

TEST(MachineLimits, the_triad_of_a_scene_is_that_of_the_smallest_memory_that_holds_it) {
  const Caches caches{.l2 = 1000, .l3 = 20000};
  EXPECT_EQ(triad_for(1, caches), "triad_l2");
  EXPECT_EQ(triad_for(1000, caches), "triad_l2");
  EXPECT_EQ(triad_for(1001, caches), "triad_l3");
  EXPECT_EQ(triad_for(20001, caches), "triad_memory");
}

TEST(MachineLimits, caches_have_sizes) {
  EXPECT_GT(caches().l2, 0u);
  EXPECT_GT(caches().l3, 0u);
}

}  // namespace
}  // namespace mpm::bench
