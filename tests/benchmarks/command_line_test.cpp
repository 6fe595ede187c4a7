#include "benchmarks/command_line.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "benchmarks/measuring.hpp"
#include "tests/support/bench_results.hpp"
#include "tests/support/scratch_directory.hpp"
#include "vv/case_file.hpp"

namespace mpm::bench {
namespace {

namespace fs = std::filesystem;

struct Answer {
  int code;
  std::string out, err;
};

class BenchTest : public testing::Test {
 protected:
  fs::path file(const std::string& name) const { return scratch_.path() / name; }

  static Answer ask(std::vector<std::string> words) {
    words.insert(words.begin(), "bench");
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = command_line(static_cast<int>(arguments.size()), arguments.data());
    std::fflush(stdout);
    return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
  }

  /// Exit code 2 and one line that says why, containing `part`, before anything is measured.
  static void expect_refusal(const std::vector<std::string>& words, const std::string& part) {
    const Answer answer = ask(words);
    EXPECT_EQ(answer.code, 2) << part;
    EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
    EXPECT_NE(answer.err.find(part), std::string::npos) << part << "\n" << answer.err;
    EXPECT_EQ(answer.out, "");
  }

  std::string written(const std::string& name, const Results& results) const {
    write_results(results, file(name));
    return file(name).string();
  }

  tests::ScratchDirectory scratch_;
};

TEST_F(BenchTest, refuses_what_it_does_not_understand) {
  expect_refusal({"--qick"}, "--qick");
  expect_refusal({"law"}, "law");
  expect_refusal({"--compare", "one.json"}, "--compare");
  expect_refusal({"--compare", "one.json", "two.json", "--quick"}, "--quick");
  expect_refusal({"--filter", "("}, "--filter (");
  expect_refusal({"--filter", "no such thing"}, "nothing of that name");
}

TEST_F(BenchTest, refuses_files_it_cannot_use) {
  expect_refusal({"--json", scratch_.path().string()}, "cannot write");
  expect_refusal({"--json", file("x.json").string(), "--against", file("none.json").string()}, "cannot read");
  expect_refusal({"--compare", file("none.json").string(), file("none.json").string()}, "cannot read");
  std::ofstream(file("bad.json")) << "{}";
  expect_refusal({"--compare", file("bad.json").string(), file("bad.json").string()}, "/format");
}

TEST_F(BenchTest, says_what_it_can_do) {
  const Answer answer = ask({"--help"});
  EXPECT_EQ(answer.code, 0);
  for (const char* option :
       {"--json", "--quick", "--filter", "--features", "--footing", "--against", "--compare"}) {
    EXPECT_NE(answer.out.find(option), std::string::npos) << option;
  }
}

TEST_F(BenchTest, compares_two_files_without_measuring) {
  Results fast = tests::made_up_results();
  fast.steps.front().rate = {20e6, 19e6, 21e6};
  const std::string plain = written("plain.json", tests::made_up_results()),
                    faster = written("fast.json", fast);
  EXPECT_EQ(ask({"--compare", plain, plain}).code, 0);
  EXPECT_EQ(ask({"--compare", plain, faster}).code, 0);
  const Answer slower = ask({"--compare", faster, plain});
  EXPECT_EQ(slower.code, 1);
  EXPECT_NE(slower.out.find("SLOWER"), std::string::npos) << slower.out;
}

TEST_F(BenchTest, measures_writes_and_compares) {
  const std::string first = file("first.json").string();
  const Answer answer = ask({"--quick", "--filter", "^(column/.*/1|law/zhang.*)$", "--json", first});
  ASSERT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(answer.err.find("measuring"), std::string::npos) << "progress is for terminals";
  const Results results = read_results(first);
  ASSERT_EQ(results.steps.size(), 1u);
  ASSERT_EQ(results.kernels.size(), 1u);
  EXPECT_EQ(results.limits.size(), 9u);
  EXPECT_EQ(results.repetitions, 3);
  const StepResult& step = results.steps.front();
  EXPECT_EQ(step.name, "column/cpgimp/musl/linear_elastic/float64/50/1");
  EXPECT_EQ(step.particles, 50);
  EXPECT_EQ(results.noise, step.rate.spread());
  // A step of a particle takes more than a nanosecond and less than ten microseconds, in any build.
  EXPECT_GT(step.rate.low, 1e5);
  EXPECT_LT(step.rate.high, 1e9);
  EXPECT_NEAR(step.share_of_peak,
              step.flops * step.rate.value / limit_named(results.limits, "fma_peak").rate.value, 1e-12);
  EXPECT_NEAR(step.share_of_bandwidth,
              step.bytes * step.rate.value / limit_named(results.limits, "triad_l2").rate.value, 1e-12);
  EXPECT_NE(answer.out.find(step.name), std::string::npos);

  Results impossible = results;
  impossible.steps.front().rate = {1e15, 1e15, 1e15};
  const std::string old = written("impossible.json", impossible);
  const Answer slower = ask({"--quick", "--filter", "^column", "--json", first, "--against", old});
  EXPECT_EQ(slower.code, 1);
  EXPECT_NE(slower.out.find("SLOWER"), std::string::npos) << slower.out;
}

TEST_F(BenchTest, measures_features_alone) {
  const std::string json = file("features.json").string();
  const Answer answer = ask(
      {"--quick", "--features", "--filter", "^feature/(damping|second_dimension)$|^column", "--json", json});
  ASSERT_EQ(answer.code, 0) << answer.err;
  const Results results = read_results(json);
  EXPECT_TRUE(results.steps.empty()) << "whole steps were not asked for";
  EXPECT_TRUE(results.memory.empty());
  ASSERT_EQ(results.features.size(), 2u);
  EXPECT_NE(answer.out.find("damping: 0"), std::string::npos) << answer.out;
}

TEST_F(BenchTest, runs_a_footing_to_its_end) {
  std::ifstream stream(footing_case());
  vv::Json text = vv::Json::parse(stream);
  text["scene"]["termination"]["time"] = "0.0015 s";
  std::ofstream(file("short.json")) << text;
  const RunResult run = measure_run(file("short.json"), 1, [](const std::string&) {});
  EXPECT_EQ(run.name, "footing_paper");
  EXPECT_EQ(run.particles, 8832);
  EXPECT_EQ(run.steps, 100);
  EXPECT_EQ(run.ending, "reached_time");
  EXPECT_GT(run.seconds, 0);
  // Downwards is positive, and in that time nothing falls further than free.
  EXPECT_GT(run.settlement, 0);
  EXPECT_LT(run.settlement, 0.5 * 9.81 * 0.0015 * 0.0015 * 1.1);
}

TEST_F(BenchTest, counts_the_memory_of_a_scene) {
  const std::size_t small = bytes_of({.particles = 10'000}), large = bytes_of({.particles = 40'000});
  const std::size_t single = bytes_of({.precision = Precision::float32, .particles = 40'000});
  // At least place, velocity, stress and mass; at most ten times what a particle has been seen to take.
  EXPECT_GT(small, 10'000u * 9 * sizeof(double));
  EXPECT_LT(small, 10'000u * 3500);
  EXPECT_NEAR(static_cast<double>(large) / static_cast<double>(small), 4.0, 0.4);
  // Half the numbers, but as many indices, and more empty slots beside bodies in twice as many lanes.
  EXPECT_NEAR(static_cast<double>(single) / static_cast<double>(large), 0.58, 0.08);
}

}  // namespace
}  // namespace mpm::bench
