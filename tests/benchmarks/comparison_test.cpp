#include "benchmarks/comparison.hpp"

#include <gtest/gtest.h>

#include "tests/support/bench_results.hpp"

namespace mpm::bench {
namespace {

using tests::made_up_results;

Results with_rate(const Measured& rate) {
  Results results = made_up_results();
  results.steps.front().rate = rate;
  return results;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Comparison, intervals_that_overlap_are_noise) {
  EXPECT_EQ(change_of({100, 95, 105}, {110, 104, 115}), Change::unchanged);
  EXPECT_EQ(change_of({100, 95, 105}, {90, 80, 95}), Change::unchanged);
  EXPECT_EQ(change_of({100, 95, 105}, {100, 95, 105}), Change::unchanged);
}

TEST(Comparison, intervals_apart_are_a_change) {
  EXPECT_EQ(change_of({100, 95, 105}, {120, 110, 125}), Change::faster);
  EXPECT_EQ(change_of({100, 95, 105}, {80, 75, 90}), Change::slower);
}

TEST(Comparison, medians_nearer_than_the_larger_half_width_are_noise) {
  // Apart by a hair, and skewed: the medians differ by 11, half the wider interval is 20.
  EXPECT_EQ(change_of({100, 99, 101}, {111, 102, 142}), Change::unchanged);
  EXPECT_EQ(change_of({111, 102, 142}, {100, 99, 101}), Change::unchanged);
}

TEST(Comparison, nothing_changes_against_itself) {
  const Comparison comparison = compare(made_up_results(), made_up_results());
  ASSERT_EQ(comparison.rates.size(), 2u);
  EXPECT_FALSE(comparison.has_slower());
  EXPECT_TRUE(comparison.circumstances.empty());
  EXPECT_TRUE(comparison.only_before.empty() && comparison.only_after.empty());
  for (const Compared& rate : comparison.rates) EXPECT_EQ(rate.change, Change::unchanged);
}

TEST(Comparison, a_faster_step_is_no_slower_one) {
  const Comparison comparison = compare(with_rate({100, 99, 101}), with_rate({150, 149, 151}));
  EXPECT_EQ(comparison.rates.front().change, Change::faster);
  EXPECT_DOUBLE_EQ(comparison.rates.front().ratio(), 1.5);
  EXPECT_FALSE(comparison.has_slower());
  EXPECT_TRUE(contains(text_of(comparison), "1 faster, 0 slower, 1 unchanged"));
}

TEST(Comparison, a_slower_step_is_told) {
  const Comparison comparison = compare(with_rate({150, 149, 151}), with_rate({100, 99, 101}));
  EXPECT_EQ(comparison.rates.front().change, Change::slower);
  EXPECT_TRUE(comparison.has_slower());
  EXPECT_TRUE(contains(text_of(comparison), "SLOWER"));
}

TEST(Comparison, a_slower_kernel_counts_and_a_slower_machine_does_not) {
  Results slower_kernel = made_up_results(), slower_machine = made_up_results();
  slower_kernel.kernels.front().rate = {1, 1, 1};
  slower_machine.limits.front().rate = {1, 1, 1};
  EXPECT_TRUE(compare(made_up_results(), slower_kernel).has_slower());
  const Comparison machine = compare(made_up_results(), slower_machine);
  EXPECT_FALSE(machine.has_slower());
  EXPECT_EQ(machine.limits.front().change, Change::slower);
}

TEST(Comparison, what_is_in_one_only_is_told) {
  Results before = made_up_results(), after = made_up_results();
  before.steps.front().name = "old";
  after.kernels.front().name = "recent";
  const Comparison comparison = compare(before, after);
  EXPECT_TRUE(comparison.rates.empty());
  EXPECT_EQ(comparison.only_before, (std::vector<std::string>{"old", "law/linear_elastic/float64"}));
  EXPECT_EQ(comparison.only_after,
            (std::vector<std::string>{made_up_results().steps.front().name, "recent"}));
  EXPECT_TRUE(contains(text_of(comparison), "only before"));
  EXPECT_TRUE(contains(text_of(comparison), "only after"));
}

TEST(Comparison, names_every_circumstance_that_differs) {
  const auto circumstances = [](auto change) {
    Results after = made_up_results();
    change(after);
    return compare(made_up_results(), after).circumstances;
  };
  EXPECT_EQ(circumstances([](Results& r) { r.processor = "another"; }).size(), 1u);
  EXPECT_EQ(circumstances([](Results& r) { r.cores = 64; }).size(), 1u);
  EXPECT_EQ(circumstances([](Results& r) { r.native = false; }).size(), 1u);
  EXPECT_EQ(circumstances([](Results& r) { r.seconds_each = 0.1; }).size(), 1u);
  const auto compiler = circumstances([](Results& r) { r.compiler = "Clang 14"; });
  ASSERT_EQ(compiler.size(), 1u);
  EXPECT_EQ(compiler.front(), "the compiler differs: GNU 12.2.0 before, Clang 14 after");
  EXPECT_TRUE(circumstances([](Results& r) { r.revision = "def", r.date = "later"; }).empty());
}

}  // namespace
}  // namespace mpm::bench
