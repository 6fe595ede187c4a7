#include "benchmarks/measured.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace mpm::bench {
namespace {

TEST(Measured, the_median_is_the_middle_one_in_any_order) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({100, 1, 3, 2, -50}), 2);
  EXPECT_EQ(median({7}), 7);
}

TEST(Measured, the_median_of_an_even_number_is_between_the_middle_two) {
  EXPECT_EQ(median({4, 1, 2, 100}), 3);
}

TEST(Measured, nothing_and_what_is_no_number_have_no_median) {
  EXPECT_THROW(median({}), std::invalid_argument);
  EXPECT_THROW(median({1, std::numeric_limits<double>::quiet_NaN(), 2}), std::invalid_argument);
  EXPECT_THROW(summary_of({std::numeric_limits<double>::infinity()}), std::invalid_argument);
}

TEST(Measured, an_interval_of_the_median_leaves_out_what_chance_puts_outside) {
  const auto interval_of_first = [](int count) {
    std::vector<double> values;
    for (int k = count; k >= 1; --k) values.push_back(k);
    return interval_of_median(values);
  };
  // The probability that all of n values lie on one side of the median is 2 / 2^n: 6.2 % of five, 3.1 % of
  // six.
  EXPECT_EQ(interval_of_first(1), (Measured{1, 1, 1}));
  EXPECT_EQ(interval_of_first(5), (Measured{3, 1, 5}));
  EXPECT_EQ(interval_of_first(6), (Measured{3.5, 1, 6}));
  // From tables of the sign test at 5 %.
  EXPECT_EQ(interval_of_first(8), (Measured{4.5, 1, 8}));
  EXPECT_EQ(interval_of_first(9), (Measured{5, 2, 8}));
  EXPECT_EQ(interval_of_first(12), (Measured{6.5, 3, 10}));
  EXPECT_EQ(interval_of_first(25), (Measured{13, 8, 18}));
  EXPECT_THROW(interval_of_median({}), std::invalid_argument);
}

TEST(Measured, a_summary_keeps_the_extremes) {
  const Measured summary = summary_of({12, 9, 10, 11, 17});
  EXPECT_EQ(summary, (Measured{11, 9, 17}));
  EXPECT_EQ(summary.half_width(), 4);
  EXPECT_DOUBLE_EQ(summary.spread(), 4.0 / 11.0);
}

std::vector<double> kept_rates(const std::vector<Repetition>& all) {
  std::vector<double> rates;
  for (const Repetition& repetition : least_disturbed(all)) rates.push_back(repetition.rate);
  return rates;
}

TEST(Measured, disturbed_repetitions_do_not_count) {
  EXPECT_EQ(kept_rates({{1, 0.5}, {2, 0.0}, {3, 0.01}, {4, 0.1}, {5, 0.02}, {6, 0.0}}),
            (std::vector<double>{2, 6, 3, 5}));
}

TEST(Measured, the_three_least_disturbed_count_in_any_case) {
  EXPECT_EQ(kept_rates({{9, 0.5}, {1, 0.3}, {2, 0.4}, {3, 0.0}}), (std::vector<double>{3, 1, 2}));
  EXPECT_EQ(kept_rates({{9, 0.5}, {8, 0.1}}), (std::vector<double>{8, 9}));
}

TEST(Measured, slow_repetitions_count_like_others) {
  EXPECT_EQ(kept_rates({{1, 0.0}, {100, 0.0}, {99, 0.0}, {98, 0.0}}).size(), 4u);
}

}  // namespace
}  // namespace mpm::bench
