#include "reports/performance.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/demo_performance.hpp"

namespace mpm::reports {
namespace {

using Json = support::PerformanceJson;

/// What reading a text complains of, without the directory; nothing when it is fine.
std::string complaint(const std::string& text) {
  const tests::ScratchDirectory scratch;
  const std::filesystem::path file = scratch.path() / "m.json";
  std::ofstream(file) << text;
  try {
    read_performance(file);
  } catch (const std::runtime_error& error) {
    const std::string message = error.what(), place = scratch.path().string() + "/";
    EXPECT_TRUE(message.starts_with(place)) << message;
    return message.substr(place.size());
  }
  return "";
}

/// Of the demonstration with one value replaced, or erased where there is none.
std::string complaint_with(const std::string& pointer, const Json& value, bool erased = false) {
  Json json = support::demo_performance_json();
  const Json::json_pointer place(pointer);
  if (erased)
    json[place.parent_pointer()].erase(place.back());
  else
    json[place] = value;
  return complaint(json.dump());
}

std::string complaint_without(const std::string& pointer) { return complaint_with(pointer, nullptr, true); }

TEST(PerformanceFile, HoldsWhatWasMeasured) {
  const Performance p = support::demo_performance();
  EXPECT_EQ(p.file.filename(), "demo.json");
  EXPECT_EQ(p.revision, "0123abcd");
  EXPECT_FALSE(p.modified);
  EXPECT_TRUE(p.native);
  EXPECT_EQ(p.date, "2000-01-02T03:04:05Z");
  EXPECT_EQ(p.compiler, "Test 1.0");
  EXPECT_EQ(p.processor, "Test processor");
  EXPECT_EQ(p.cores, 2);
  EXPECT_EQ(p.repetitions, 5);
  EXPECT_EQ(p.seconds_each, 0.25);
  EXPECT_EQ(p.noise, 0.1);
  ASSERT_EQ(p.limits.size(), 4U);
  EXPECT_EQ(p.limits[1].title, "triad in memory");
  EXPECT_EQ(p.limits[1].value.median, 10e9);
  EXPECT_EQ(p.limits[1].unit, "B/s");
  ASSERT_EQ(p.steps.size(), 20U);
  const StepRate& step = p.steps[2];
  EXPECT_EQ(step.name, "footing/mpm/usl/mohr_coulomb/float64/10000/1");
  EXPECT_EQ(step.scene, "footing");
  EXPECT_EQ(step.scheme, "mpm");
  EXPECT_EQ(step.order, "usl");
  EXPECT_EQ(step.law, "mohr_coulomb");
  EXPECT_EQ(step.precision, "float64");
  EXPECT_EQ(step.particles, 10000);
  EXPECT_EQ(step.threads, 1);
  EXPECT_EQ(step.rate.median, 40e6);
  EXPECT_DOUBLE_EQ(step.rate.low, 36e6);
  EXPECT_DOUBLE_EQ(step.rate.high, 44e6);
  EXPECT_EQ(step.target, 20e6);
  EXPECT_EQ(step.bytes, 200.0);
  EXPECT_EQ(step.flops, 200.0);
  EXPECT_EQ(step.share_of_bandwidth, 0.25);
  EXPECT_EQ(step.share_of_peak, 0.125);
  EXPECT_FALSE(p.steps[0].target);
  ASSERT_EQ(p.kernels.size(), 1U);
  EXPECT_EQ(p.kernels[0].rate.low, 190e6);
  ASSERT_EQ(p.runs.size(), 2U);
  EXPECT_EQ(p.runs[1].threads, 2);
  EXPECT_EQ(p.runs[1].settlement, 0.025);
  EXPECT_EQ(p.runs[1].ending, "reached_time");
  EXPECT_DOUBLE_EQ(p.runs[1].particle_steps(), 20e6);
  EXPECT_DOUBLE_EQ(p.runs[1].rate(), 2.5e6);
  ASSERT_EQ(p.memory.size(), 1U);
  EXPECT_EQ(p.memory[0].bytes_per_particle, 222.0);
  ASSERT_EQ(p.start_up.size(), 1U);
  EXPECT_EQ(p.start_up[0].seconds, 0.0125);
  ASSERT_EQ(p.features.size(), 2U);
  const FeaturePrice& damping = p.features[0];
  EXPECT_EQ(damping.title, "local damping");
  EXPECT_EQ(damping.without.what, "none");
  EXPECT_EQ(damping.with.bytes, 176000);
  EXPECT_EQ(damping.with.step.median, 25e-6);
  EXPECT_EQ(damping.ratio.high, 1.375);
  EXPECT_DOUBLE_EQ(damping.ratio_of_time(), 1.25);
  ASSERT_TRUE(damping.spelled);
  EXPECT_EQ(damping.spelled->what, "damping: 0");
  EXPECT_FALSE(damping.spelled->of_with);
  EXPECT_TRUE(damping.spelled->same_bits);
  EXPECT_EQ(damping.spelled->verdict, "within_limit");
  EXPECT_FALSE(p.features[1].spelled);
  EXPECT_DOUBLE_EQ(p.features[1].ratio_of_time(), 10.0);
}

TEST(PerformanceFile, MayBeOfATimeBeforeFeaturesWereMeasured) {
  Json json = support::demo_performance_json();
  json.erase("features");
  EXPECT_TRUE(support::performance_of(json).features.empty());
}

TEST(PerformanceFile, ATargetIsMetFromItsValueOn) {
  StepRate step;
  step.rate = {25e6, 24e6, 26e6};
  EXPECT_FALSE(step.meets_target());
  step.target = 25e6;
  EXPECT_TRUE(step.meets_target());
  step.target = 25.5e6;
  EXPECT_FALSE(step.meets_target());
}

TEST(PerformanceFile, ModifiedSourceMakesAnotherRevision) {
  Performance p;
  p.revision = "abc";
  EXPECT_EQ(p.full_revision(), "abc");
  p.modified = true;
  EXPECT_EQ(p.full_revision(), "abc-dirty");
  p.revision = "abc-dirty";
  EXPECT_EQ(p.full_revision(), "abc-dirty");
}

TEST(PerformanceFile, WhatTheFormatDoesNotHaveIsLetPass) {
  EXPECT_EQ(complaint_with("/extra", 1), "");
  EXPECT_EQ(complaint_with("/steps/0/extra", 1), "");
}

TEST(PerformanceFile, WhatWasNotMeasuredMayBeEmptyOrNull) {
  for (const char* key : {"limits", "steps", "kernels", "runs", "memory", "start_up", "features"})
    EXPECT_EQ(complaint_with(std::string("/") + key, Json::array()), "") << key;
  for (const char* key : {"target", "bytes", "flops", "share_of_bandwidth", "share_of_peak"})
    EXPECT_EQ(complaint_with(std::string("/steps/0/") + key, nullptr), "") << key;
  EXPECT_EQ(complaint_with("/runs/0/settlement", nullptr), "");
  EXPECT_EQ(complaint_without("/runs/0/settlement"), "");
}

TEST(PerformanceFile, EveryKeyOfTheFormatMustBeThere) {
  const Json demo = support::demo_performance_json();
  const auto all_needed = [](const std::string& parent, const Json& object) {
    for (const auto& [key, value] : object.items()) {
      if (key == "settlement" || key == "features") continue;
      const std::string pointer = parent + "/" + key, message = complaint_without(pointer);
      EXPECT_TRUE(message.starts_with("m.json: " + pointer + ": expected ")) << pointer << ": " << message;
      EXPECT_TRUE(message.ends_with(", found nothing: the key is missing")) << pointer << ": " << message;
    }
  };
  all_needed("", demo);
  all_needed("/machine", demo["machine"]);
  for (const char* entries : {"limits", "steps", "kernels", "runs", "memory", "start_up", "features"})
    all_needed(std::string("/") + entries + "/0", demo[entries][0]);
}

TEST(PerformanceFile, ABadValueIsToldWithItsPlace) {
  const auto expect = [](const std::string& pointer, const Json& value, const std::string& rest) {
    EXPECT_EQ(complaint_with(pointer, value), "m.json: " + pointer + ": expected " + rest);
  };
  expect("/format", "mpmvv-bench-2",
         "mpmvv-bench-1, found \"mpmvv-bench-2\" (did you mean \"mpmvv-bench-1\"?)");
  expect("/revision", 5, "a text that is not empty, found 5");
  expect("/modified", "no", "true or false, found \"no\"");
  expect("/machine", "fast", "an object, found \"fast\"");
  expect("/machine/cores", 0, "a whole number above 0, found 0");
  expect("/noise", -0.1, "a number of at least 0, found -0.1");
  expect("/steps", nullptr, "an array, found null");
  expect("/steps/3/rate", "fast", "a number, found \"fast\"");
  expect("/steps/3/rate", 0, "a number above 0, found 0");
  expect("/steps/3/low", 1e12, "at most the rate, found 1000000000000.0");
  expect("/steps/3/high", 1, "at least the rate, found 1");
  expect("/steps/3/particles", 10.5, "a whole number above 0, found 10.5");
  expect("/steps/3/threads", -1, "a whole number above 0, found -1");
  expect("/steps/3/target", "25", "a number, found \"25\"");
  expect(
      "/steps/3/name", "footing/mpm/usl/mohr_coulomb/float64/1000/1",
      "a name of its own, found \"footing/mpm/usl/mohr_coulomb/float64/1000/1\", which an earlier entry has");
  expect("/limits/0/unit", "GB/s", "one of B/s, flop/s, particles/s, found \"GB/s\" (did you mean \"B/s\"?)");
  expect("/runs/1/seconds", -1, "a number above 0, found -1");
  expect("/features/0/low", 2, "at most the ratio, found 2");
  expect("/features/0/with/bytes", 1.5, "a whole number above 0, found 1.5");
  expect("/features/0/spelled/of", "one", "one of with, without, found \"one\"");
  expect("/features/0/spelled/verdict", "free", "one of within_limit, within_noise, beyond, found \"free\"");
}

TEST(PerformanceFile, AnotherFormatIsToldBeforeAnythingElse) {
  EXPECT_TRUE(
      complaint(R"({"format": "other", "steps": 3})").starts_with("m.json: /format: expected mpmvv-bench-1"));
}

TEST(PerformanceFile, WhatIsNoJsonOrNoFileIsTold) {
  EXPECT_TRUE(complaint("{").starts_with("m.json: line 1, column")) << complaint("{");
  EXPECT_TRUE(complaint("").starts_with("m.json: line 1, column"));
  EXPECT_NE(complaint("[1]").find("expected an object"), std::string::npos);
  const tests::ScratchDirectory scratch;
  EXPECT_THROW(read_performance(scratch.path() / "none.json"), std::runtime_error);
  EXPECT_THROW(read_performance(scratch.path()), std::runtime_error);
}

TEST(PerformanceHistory, ComesOldestFirst) {
  const tests::ScratchDirectory scratch;
  std::ofstream(scratch.path() / "a.json") << support::demo_performance_json();
  std::ofstream(scratch.path() / "b.json") << support::demo_earlier_json();
  std::ofstream(scratch.path() / "notes.txt") << "no measurements";
  const auto history = read_performance_history(scratch.path());
  ASSERT_EQ(history.size(), 2U);
  EXPECT_EQ(history[0].file.filename(), "b.json");
  EXPECT_EQ(history[1].file.filename(), "a.json");
  EXPECT_THROW(read_performance_history(scratch.path() / "none"), std::runtime_error);
  std::ofstream(scratch.path() / "c.json") << "{}";
  EXPECT_THROW(read_performance_history(scratch.path()), std::runtime_error);
}

TEST(PerformanceHistory, DoesNotHoldThePresent) {
  PerformanceEvidence evidence;
  evidence.measured = support::demo_performance();
  evidence.history = {support::performance_of(support::demo_earlier_json()), support::demo_performance()};
  evidence.drop_present_from_history();
  ASSERT_EQ(evidence.history.size(), 1U);
  EXPECT_EQ(evidence.history[0].revision, "fedc9876");
}

}  // namespace
}  // namespace mpm::reports
