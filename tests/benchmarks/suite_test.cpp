#include "benchmarks/suite.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "benchmarks/step_cost.hpp"

namespace mpm::bench {
namespace {

std::map<std::string, std::optional<double>> targets(bool quick) {
  std::map<std::string, std::optional<double>> by_name;
  for (const StepBenchmark& step : step_benchmarks(quick)) by_name[step.name()] = step.target;
  return by_name;
}

TEST(Suite, names_are_told_apart) {
  for (const bool quick : {false, true}) EXPECT_EQ(targets(quick).size(), step_benchmarks(quick).size());
  std::set<std::string> kernels;
  for (const auto& all : {shape_function_kernels(), law_kernels()}) {
    for (const Kernel& kernel : all) EXPECT_TRUE(kernels.insert(kernel.name).second) << kernel.name;
  }
}

TEST(Suite, the_quick_one_is_a_part_of_the_full_one) {
  const auto full = targets(false);
  for (const auto& [name, target] : targets(true)) {
    ASSERT_TRUE(full.contains(name)) << name;
    EXPECT_EQ(full.at(name), target) << name;
  }
  EXPECT_LT(targets(true).size(), full.size());
}

TEST(Suite, has_the_targets) {
  const auto full = targets(false);
  const auto target = [&](const std::string& name) {
    return full.contains(name) ? full.at(name) : std::nullopt;
  };
  EXPECT_EQ(target("footing/ugimp/usl/linear_elastic/float64/10000/1"), 25e6);
  EXPECT_EQ(target("footing/ugimp/usl/linear_elastic/float64/1000000/1"), 16e6);
  EXPECT_EQ(target("footing/ugimp/musl/mohr_coulomb/float64/10000/1"), 15e6);
  EXPECT_EQ(target("footing/cpgimp/musl/mohr_coulomb/float64/1000000/1"), 10e6);
  EXPECT_EQ(target("footing/mpm/usl/linear_elastic/float64/10000/1"), 50e6);
  EXPECT_EQ(target("footing/mpm/usl/linear_elastic/float64/1000000/1"), 25e6);
  EXPECT_EQ(target("column/mpm/musl/linear_elastic/float64/50/1"), 20e6);
  // Other numbers than these have none.
  EXPECT_TRUE(full.contains("footing/cpgimp/musl/mohr_coulomb/float32/10000/1"));
  EXPECT_EQ(target("footing/cpgimp/musl/mohr_coulomb/float32/10000/1"), std::nullopt);
}

TEST(Suite, asks_for_no_more_threads_than_there_are) {
  for (const StepBenchmark& step : step_benchmarks(false)) EXPECT_LE(step.threads, available_threads());
}

StepCost cost(Scheme scheme, UpdateOrder order, Law law, Precision precision = Precision::float64) {
  return step_cost({.scheme = scheme, .order = order, .law = law, .precision = precision, .particles = 1});
}

TEST(StepCost, adds_up_for_the_simplest_step) {
  // MPM, USL, one dimension, one particle a node, counted by hand, in doubles. Particles: place, mass,
  // velocity, volume and stress are read to be scattered (5); place, velocity, displacement, mass, stress and
  // both volumes are read to be updated (7), and all but mass and initial volume written (5). Nodes, of 3
  // sums and 2 motions: cleared 3, scattered to 6, gravity 3, acceleration 5, gathered from 2.
  const StepCost column = step_cost({.model = SceneChoice::Model::column,
                                     .scheme = Scheme::mpm,
                                     .order = UpdateOrder::usl,
                                     .law = Law::linear_elastic,
                                     .particles = 1});
  EXPECT_EQ(column.bytes, 8 * (5 + 7 + 5 + 3 + 6 + 3 + 5 + 2));
}

TEST(StepCost, tells_methods_apart) {
  const StepCost plain = cost(Scheme::ugimp, UpdateOrder::usl, Law::linear_elastic);
  const auto more = [&](const StepCost& other) {
    return other.bytes > plain.bytes && other.operations > plain.operations;
  };
  EXPECT_TRUE(more(cost(Scheme::cpgimp, UpdateOrder::usl, Law::linear_elastic)));
  EXPECT_TRUE(more(cost(Scheme::ugimp, UpdateOrder::musl, Law::linear_elastic)));
  EXPECT_TRUE(more(cost(Scheme::ugimp, UpdateOrder::usf, Law::linear_elastic)));
  EXPECT_GT(cost(Scheme::ugimp, UpdateOrder::usl, Law::mohr_coulomb).operations, plain.operations);
  EXPECT_LT(cost(Scheme::mpm, UpdateOrder::usl, Law::linear_elastic).operations, plain.operations / 2);
  const StepCost single = cost(Scheme::ugimp, UpdateOrder::usl, Law::linear_elastic, Precision::float32);
  EXPECT_EQ(single.operations, plain.operations);
  EXPECT_NEAR(single.bytes, plain.bytes / 2, 20);
}

}  // namespace
}  // namespace mpm::bench
