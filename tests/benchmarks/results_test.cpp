#include "benchmarks/results.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <limits>

#include "tests/support/bench_results.hpp"
#include "tests/support/scratch_directory.hpp"

namespace mpm::bench {
namespace {

namespace fs = std::filesystem;

using tests::made_up_results;
using tests::ScratchDirectory;

/// The message of the error that reading the changed results throws, or an empty text.
std::string refusal_of(const std::function<void(Json&)>& change) {
  Json json = json_of(made_up_results());
  change(json);
  try {
    parse_results(json.dump(), "old.json");
    return "";
  } catch (const ResultsError& error) {
    return error.what();
  }
}

TEST(Results, survive_a_file) {
  const ScratchDirectory scratch;
  const fs::path file = scratch.path() / "deep" / "bench.json";
  Results results = made_up_results();
  results.steps.front().rate = {1.0 / 3.0, 0.1, 2.0 / 3.0};
  results.steps.push_back(results.steps.front());
  results.steps.back().name = "another";
  results.steps.back().target.reset();
  write_results(results, file);
  EXPECT_EQ(read_results(file), results);
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), fs::directory_iterator()), 1)
      << "something was left beside the file";
}

TEST(Results, empty_ones_survive_too) {
  Results results = made_up_results();
  results.limits.clear();
  results.steps.clear();
  results.kernels.clear();
  results.runs.clear();
  results.memory.clear();
  results.start_up.clear();
  results.features.clear();
  EXPECT_EQ(parse_results(json_of(results).dump(), "x"), results);
}

TEST(Results, have_the_agreed_keys) {
  const Json json = json_of(made_up_results());
  EXPECT_EQ(json.at("format"), "mpmvv-bench-1");
  EXPECT_EQ(json.at("machine").at("cores"), 2);
  EXPECT_EQ(json.at("limits").at(0).at("value"), 8e10);
  EXPECT_EQ(json.at("steps").at(0).at("rate"), 10e6);
  EXPECT_EQ(json.at("steps").at(0).at("target"), 25e6);
  EXPECT_EQ(json.at("kernels").at(0).at("low"), 0.9e9);
  EXPECT_EQ(json.at("runs").at(0).at("ending"), "reached_time");
  EXPECT_EQ(json.at("memory").at(0).at("bytes_per_particle"), 173.5);
  EXPECT_EQ(json.at("start_up").at(0).at("seconds"), 0.01);
  const Json& feature = json.at("features").at(0);
  EXPECT_EQ(feature.at("ratio"), 1.05);
  EXPECT_EQ(feature.at("without").at("step"), 20e-6);
  EXPECT_EQ(feature.at("with").at("bytes"), 160000);
  EXPECT_EQ(feature.at("spelled").at("of"), "without");
  EXPECT_EQ(feature.at("spelled").at("same_bits"), true);
  EXPECT_EQ(feature.at("spelled").at("verdict"), "within_limit");
}

TEST(Results, of_a_time_before_features_have_none) {
  Json json = json_of(made_up_results());
  json.erase("features");
  EXPECT_TRUE(parse_results(json.dump(), "x").features.empty());
  json["features"] = json_of(made_up_results()).at("features");
  json["features"][0]["spelled"] = nullptr;
  EXPECT_FALSE(parse_results(json.dump(), "x").features.at(0).spelled);
}

TEST(Results, a_default_is_free_within_the_limit_or_as_far_as_noise_tells) {
  using enum SpelledResult::Verdict;
  SpelledResult spelled;
  spelled.ratio = {1.01, 1.0, 1.02};
  EXPECT_EQ(spelled.verdict(), within_limit);
  spelled.ratio = {0.9, 0.8, 0.95};
  EXPECT_EQ(spelled.verdict(), within_limit) << "faster is free";
  spelled.ratio = {1.05, 1.0, 1.1};
  EXPECT_EQ(spelled.verdict(), within_noise);
  spelled.ratio = {1.05, 1.03, 1.1};
  EXPECT_EQ(spelled.verdict(), beyond);
}

TEST(Results, a_step_without_target_has_none_in_the_file) {
  Results results = made_up_results();
  results.steps.front().target.reset();
  EXPECT_TRUE(json_of(results).at("steps").at(0).at("target").is_null());
}

TEST(Results, a_target_is_met_from_its_value_on) {
  StepResult step;
  step.rate = {10, 9, 11};
  step.target = 10;
  EXPECT_TRUE(step.meets_target());
  step.target = 10.5;
  EXPECT_FALSE(step.meets_target());
  step.target.reset();
  EXPECT_TRUE(step.meets_target());
}

TEST(Results, bad_ones_are_refused_with_file_and_place) {
  const auto expect_refusal = [](const std::string& place, const std::function<void(Json&)>& change) {
    const std::string message = refusal_of(change);
    EXPECT_TRUE(message.starts_with("old.json: " + place)) << place << "\n" << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  };
  EXPECT_EQ(refusal_of([](Json&) {}), "");
  expect_refusal("/format", [](Json& json) { json["format"] = "mpmvv-bench-0"; });
  expect_refusal("/format", [](Json& json) { json.erase("format"); });
  expect_refusal("/steps", [](Json& json) { json.erase("steps"); });
  expect_refusal("/steps/0/rate", [](Json& json) { json["steps"][0]["rate"] = "fast"; });
  expect_refusal("/steps/0/target", [](Json& json) { json["steps"][0].erase("target"); });
  expect_refusal("/steps/0", [](Json& json) { json["steps"][0]["low"] = 1e9; });
  expect_refusal("/steps", [](Json& json) { json["steps"].push_back(json["steps"][0]); });
  expect_refusal("/kernels", [](Json& json) { json["kernels"].push_back(json["kernels"][0]); });
  expect_refusal("/limits/0", [](Json& json) { json["limits"][0]["high"] = 1.0; });
  expect_refusal("/features/0/spelled", [](Json& json) { json["features"][0].erase("spelled"); });
  expect_refusal("/features/0/spelled/of", [](Json& json) { json["features"][0]["spelled"]["of"] = "none"; });
  expect_refusal("/features/0/with/bytes", [](Json& json) { json["features"][0]["with"]["bytes"] = 1.5; });
  expect_refusal("/features", [](Json& json) { json["features"].push_back(json["features"][0]); });
  expect_refusal("/machine/cores", [](Json& json) { json["machine"]["cores"] = 1.5; });
  EXPECT_THROW(parse_results("[]", "x"), ResultsError);
  EXPECT_THROW(parse_results("{", "x"), ResultsError);
  EXPECT_THROW(parse_results("", "x"), ResultsError);
}

TEST(Results, a_file_that_cannot_be_read_is_named) {
  const ScratchDirectory scratch;
  for (const fs::path& file : {scratch.path() / "missing.json", scratch.path()}) {
    try {
      read_results(file);
      ADD_FAILURE() << file;
    } catch (const ResultsError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(file.string() + ": cannot read: ")) << error.what();
    }
  }
}

TEST(Results, a_file_that_cannot_be_written_is_named_and_the_former_one_kept) {
  const ScratchDirectory scratch;
  const fs::path no_directory = scratch.path() / "file";
  std::ofstream(no_directory) << "former";
  const fs::path file = no_directory / "bench.json";
  EXPECT_THROW(check_writable(file), ResultsError);
  EXPECT_THROW(write_results(made_up_results(), file), ResultsError);
  EXPECT_THROW(check_writable(scratch.path()), ResultsError);
  EXPECT_THROW(write_results(made_up_results(), scratch.path()), ResultsError);
  EXPECT_NO_THROW(check_writable(no_directory));
  std::ifstream stream(no_directory);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), "former");
}

}  // namespace
}  // namespace mpm::bench
