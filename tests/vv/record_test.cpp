#include "vv/record.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <set>
#include <system_error>

#include "tests/support/column_scene.hpp"
#include "tests/support/scratch_directory.hpp"

namespace mpm::vv {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<std::uint64_t> bits_of(const std::vector<double>& values) {
  std::vector<std::uint64_t> bits;
  for (double value : values) bits.push_back(std::bit_cast<std::uint64_t>(value));
  return bits;
}

/// A column of `cells` particles that falls onto its fixed base.
RunRequest column(int cells, Scheme scheme = Scheme::cpgimp) {
  RunRequest request;
  Scene& scene = request.scene;
  scene = test::column_scene(scheme, cells);
  scene.gravity.loading = RampLoading{0.01};
  scene.time_step = GivenTimeStep{1e-4};
  scene.termination = AtTime{0.05};
  request.scene_text = {{"cells", cells}};
  return request;
}

HistoryProbe probe(const std::string& id, const std::string& quantity, double at, double every) {
  return {.id = id, .quantity = quantity, .at = {at, 0.0}, .every = every};
}

Record full_record() {
  Record record;
  record.case_id = "a_case";
  record.input_hash = "0123456789abcdef";
  record.program_hash = "fedcba9876543210";
  record.revision = "1234567-dirty";
  record.threads = 2;
  record.outcome = {
      .ending = Ending::outside_grid, .step = (1LL << 53) + 1, .time = 0.1, .particle = 7, .value = nan};
  record.time_step = 1.0 / 3.0;
  record.end_time = 0.1 + 0.2;
  record.unbalanced_force_ratio = infinity;
  record.kinetic_energy_ratio = -infinity;
  record.cell_crossings = 9'007'199'254'740'993;
  record.relative_mass_change = -0.0;
  record.digest = "0000000000000001";
  record.repeat_digest = "0000000000000002";
  record.profile = {{0.0, 0.5}, {-1e-3, -2e-3}, {1e-300, 5e-324}, {nan, -0.0},
                    {1, 2},     {3, 4},         {5, 6},           {7, 8}};
  record.histories = {{"top", "displacement", {0.0, 0.1}, {-0.0, nan}}};
  record.cost = {.wall_seconds = 1.5e-7, .steps = 12, .particle_steps = 600};
  return record;
}

TEST(RecordText, BringsBackEveryBit) {
  const Record written = full_record();
  const Record read = record_from_json(Json::parse(to_json(written).dump()));
  EXPECT_EQ(read.case_id, written.case_id);
  EXPECT_EQ(read.input_hash, written.input_hash);
  EXPECT_EQ(read.program_hash, written.program_hash);
  EXPECT_EQ(read.revision, written.revision);
  EXPECT_EQ(read.threads, 2);
  EXPECT_EQ(read.outcome.ending, Ending::outside_grid);
  EXPECT_EQ(read.outcome.step, written.outcome.step);
  EXPECT_EQ(read.outcome.time, 0.1);
  EXPECT_EQ(read.outcome.particle, 7);
  EXPECT_TRUE(std::isnan(read.outcome.value));
  EXPECT_EQ(read.time_step, written.time_step);
  EXPECT_EQ(read.end_time, written.end_time);
  EXPECT_EQ(read.unbalanced_force_ratio, infinity);
  EXPECT_EQ(read.kinetic_energy_ratio, -infinity);
  EXPECT_EQ(read.cell_crossings, written.cell_crossings);
  EXPECT_TRUE(std::signbit(read.relative_mass_change));
  EXPECT_EQ(read.digest, written.digest);
  EXPECT_EQ(read.repeat_digest, written.repeat_digest);
  EXPECT_EQ(bits_of(read.profile.displacement), bits_of(written.profile.displacement));
  EXPECT_EQ(bits_of(read.profile.position), bits_of(written.profile.position));
  EXPECT_EQ(bits_of(read.profile.stress), bits_of(written.profile.stress));
  EXPECT_EQ(read.profile.half_size, written.profile.half_size);
  ASSERT_EQ(read.histories.size(), 1u);
  EXPECT_EQ(read.histories[0].id, "top");
  EXPECT_EQ(read.histories[0].quantity, "displacement");
  EXPECT_EQ(bits_of(read.histories[0].value), bits_of(written.histories[0].value));
  EXPECT_EQ(read.cost.wall_seconds, 1.5e-7);
  EXPECT_EQ(read.cost.particle_steps, 600);
}

TEST(RecordText, BringsBackAnyFiniteNumber) {
  std::mt19937_64 random(1);
  Record written;
  while (written.profile.stress.size() < 20'000) {
    const auto value = std::bit_cast<double>(random());
    if (std::isfinite(value)) written.profile.stress.push_back(value);
  }
  const std::vector<double> filler(written.profile.stress.size(), 0.0);
  Profile& profile = written.profile;
  for (auto* field : {&profile.initial_position, &profile.displacement, &profile.position, &profile.volume,
                      &profile.initial_volume, &profile.mass, &profile.half_size}) {
    *field = filler;
  }
  const Record read = record_from_json(Json::parse(to_json(written).dump()));
  EXPECT_EQ(bits_of(read.profile.stress), bits_of(written.profile.stress));
}

TEST(RecordText, NeverTurnsANumberIntoNull) {
  EXPECT_EQ(to_json(full_record()).dump().find("null"), std::string::npos);
  EXPECT_EQ(to_json(full_record())["profile"]["stress"][0], "nan");
}

TEST(RecordText, RefusesWhatIsNoWholeRecord) {
  const Json good = to_json(full_record());
  EXPECT_NO_THROW(record_from_json(good));
  for (const char* key : {"schema", "outcome", "profile", "histories", "cost", "digest"}) {
    Json lacking = good;
    lacking.erase(key);
    EXPECT_ANY_THROW(record_from_json(lacking)) << key;
  }
  Json shorter = good;
  shorter["profile"]["stress"].erase(0);
  EXPECT_ANY_THROW(record_from_json(shorter));
  Json uneven = good;
  uneven["histories"][0]["time"].push_back(0.3);
  EXPECT_ANY_THROW(record_from_json(uneven));
  Json unknown = good;
  unknown["outcome"]["ending"] = "fine";
  EXPECT_ANY_THROW(record_from_json(unknown));
  Json null = good;
  null["time_step"] = nullptr;
  EXPECT_ANY_THROW(record_from_json(null));
}

TEST(RecordEnding, SaysHowWhereAndWhen) {
  Record record;
  record.outcome = {.ending = Ending::outside_grid, .step = 123, .time = 0.5, .particle = 49, .value = 1.04};
  EXPECT_EQ(ending_of(record), "run ended outside_grid at step 123, t = 0.5 s, particle 49, value 1.04");
  EXPECT_FALSE(record.completed());
  record.outcome = {};
  EXPECT_TRUE(record.completed());
  record.failure = "out of memory";
  EXPECT_EQ(ending_of(record), "run failed: out of memory");
  EXPECT_FALSE(record.completed());
}

TEST(Simulate, RecordsTheRunItWasAskedFor) {
  Case definition;
  definition.id = "column";
  const RunRequest request = column(10);
  const Record record = simulate(definition, request);
  EXPECT_EQ(record.case_id, "column");
  EXPECT_EQ(record.input_hash, input_hash(request, {}));
  EXPECT_EQ(record.program_hash, program_hash());
  EXPECT_EQ(record.outcome.ending, Ending::reached_time);
  EXPECT_TRUE(record.completed());
  EXPECT_EQ(record.cost.steps, 500);
  EXPECT_EQ(record.cost.particle_steps, 5000);
  EXPECT_GT(record.cost.wall_seconds, 0.0);
  EXPECT_NEAR(record.end_time, 0.05, 1e-12);
  EXPECT_EQ(record.relative_mass_change, 0.0);
  ASSERT_EQ(record.profile.stress.size(), 10u);
  EXPECT_NEAR(record.profile.initial_position[3], 0.35, 1e-12);
  // Compressed, most at the base.
  EXPECT_LT(record.profile.stress[0], 10.0 * record.profile.stress[9]);
  EXPECT_LT(record.profile.displacement[9], 0.0);
}

TEST(Simulate, HasADigestOfTheFinalBits) {
  Case definition;
  const Record once = simulate(definition, column(10));
  const Record again = simulate(definition, column(10));
  EXPECT_EQ(once.digest, again.digest);
  RunRequest heavier = column(10);
  heavier.scene.bodies[0].density = std::nextafter(1000.0, 2000.0);
  EXPECT_NE(simulate(definition, heavier).digest, once.digest);
}

TEST(Simulate, SamplesEveryProbeAtItsOwnInterval) {
  Case definition;
  definition.probes = {probe("top", "displacement", 1.0, 0.01), probe("base", "stress", 0.0, 0.02),
                       probe("speed", "velocity", 1.0, 1.0)};
  const Record record = simulate(definition, column(10));
  ASSERT_EQ(record.histories.size(), 3u);
  const History& top = record.histories[0];
  ASSERT_EQ(top.time.size(), 6u);
  for (std::size_t k = 0; k < top.time.size(); ++k) {
    EXPECT_NEAR(top.time[k], 0.01 * static_cast<double>(k), 1e-9);
  }
  EXPECT_EQ(top.value.front(), 0.0);
  EXPECT_EQ(top.value.back(), record.profile.displacement.back());
  const History& base = record.histories[1];
  ASSERT_EQ(base.time.size(), 4u);  // 0, 0.02, 0.04 and the end
  EXPECT_NEAR(base.time[2], 0.04, 1e-9);
  EXPECT_EQ(base.value.back(), record.profile.stress.front());
  const History& speed = record.histories[2];
  ASSERT_EQ(speed.time.size(), 2u);  // an interval longer than the run leaves its first and last step
  EXPECT_EQ(speed.time.front(), 0.0);
  EXPECT_NEAR(speed.time.back(), 0.05, 1e-9);
}

TEST(Simulate, SamplesEveryStepWhenTheIntervalIsShorter) {
  Case definition;
  definition.probes = {probe("top", "displacement", 1.0, 1e-5)};
  const Record record = simulate(definition, column(10));
  EXPECT_EQ(record.histories[0].time.size(), 501u);
}

TEST(Simulate, ProbesDoNotChangeTheRun) {
  Case bare, watched;
  watched.probes = {probe("top", "displacement", 1.0, 3e-4)};
  EXPECT_EQ(simulate(bare, column(10)).profile.stress, simulate(watched, column(10)).profile.stress);
}

TEST(Simulate, RecordsANumericalFailureAsAnOutcome) {
  RunRequest request = column(10);
  request.scene.time_step = GivenTimeStep{0.05};  // ten times what is stable
  request.scene.termination = AtTime{100.0};
  Case definition;
  definition.probes = {probe("top", "displacement", 1.0, 0.1)};
  const Record record = simulate(definition, request);
  EXPECT_FALSE(record.completed());
  EXPECT_TRUE(record.failure.empty());
  EXPECT_GE(record.outcome.particle, 0);
  EXPECT_LT(record.outcome.time, 100.0);
  EXPECT_EQ(record.histories[0].time.back(), record.end_time);
}

TEST(Simulate, ReportsItsProgressAndCanBeAbandoned) {
  RunRequest request = column(100);
  request.scene.termination = AtTime{0.5};
  std::int64_t reported = 0;
  const Record record = simulate({}, request, [&](std::int64_t particle_steps) {
    reported += particle_steps;
    return true;
  });
  EXPECT_EQ(reported, record.cost.particle_steps);
  EXPECT_THROW(simulate({}, request, [](std::int64_t) { return false; }), Abandoned);
}

TEST(Simulate, RefusesAProbeItCannotServe) {
  Case definition;
  definition.probes = {probe("top", "temperature", 1.0, 0.01)};
  EXPECT_THROW(simulate(definition, column(10)), std::invalid_argument);
  definition.probes = {probe("top", "stress", 1.0, 0.0)};
  EXPECT_THROW(simulate(definition, column(10)), std::invalid_argument);
}

TEST(InputHash, ChangesWithSceneAndProbesOnly) {
  const RunRequest request = column(10);
  const std::vector<HistoryProbe> probes = {probe("top", "stress", 1.0, 0.01)};
  const std::string hash = input_hash(request, probes);
  EXPECT_EQ(hash.size(), 16u);
  EXPECT_EQ(hash, input_hash(column(10), probes));
  std::set<std::string> different{hash, input_hash(column(11), probes), input_hash(request, {})};
  for (const HistoryProbe& other : {probe("up", "stress", 1.0, 0.01), probe("top", "velocity", 1.0, 0.01),
                                    probe("top", "stress", 0.9, 0.01), probe("top", "stress", 1.0, 0.02)}) {
    different.insert(input_hash(request, {other}));
  }
  EXPECT_EQ(different.size(), 7u);
}

TEST(Hash, IsFnv1a) {
  EXPECT_EQ(hash_of(""), "cbf29ce484222325");
  EXPECT_EQ(hash_of("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(hash_of("foobar"), "85944171f73967e8");
}

TEST(WriteAtomically, ReplacesTheFileAndLeavesNothingElse) {
  const tests::ScratchDirectory scratch;
  const auto file = scratch.path() / "results.json";
  write_atomically(file, "a first text, longer than the second");
  write_atomically(file, "second");
  std::ifstream stream(file);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), "second");
  const auto entries = std::filesystem::directory_iterator(scratch.path());
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);
}

TEST(WriteAtomically, CleansUpAndThrowsWhenItCannotWrite) {
  const tests::ScratchDirectory scratch;
  EXPECT_THROW(write_atomically(scratch.path() / "absent" / "file", "text"), std::system_error);
  const auto directory = scratch.path() / "taken";
  std::filesystem::create_directories(directory / "inside");
  EXPECT_THROW(write_atomically(directory, "text"), std::system_error);  // a directory cannot be replaced
  const auto entries = std::filesystem::directory_iterator(scratch.path());
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);
}

}  // namespace
}  // namespace mpm::vv
