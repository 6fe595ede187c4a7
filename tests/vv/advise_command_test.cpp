// What the program says when it is asked for advice, from results that were made up, and what it writes.

#include "vv/advise_command.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/support/scratch_directory.hpp"
#include "vv/advised_case.hpp"
#include "vv/command_line.hpp"
#include "vv/curve_file.hpp"
#include "vv/machine.hpp"
#include "vv/record.hpp"
#include "vv/scene_match.hpp"

namespace mpm::vv {
namespace {

namespace fs = std::filesystem;

struct Answer {
  int code;
  std::string out, err;

  bool says(const std::string& part) const { return out.find(part) != std::string::npos; }
};

/// A column that is at rest after some hundred steps.
Json column() {
  return Json::parse(R"({
    "id": "column", "title": "A column", "description": "It settles.",
    "scene": {
      "dimension": 1, "scheme": "cpgimp", "damping": 0.8,
      "grid": {"cell_size": "0.1 m", "lower": ["0 m"], "upper": ["1.2 m"],
               "edges": {"x_lower": "fixed", "x_upper": "free"}},
      "bodies": [{"name": "column", "lower": ["0 m"], "upper": ["1 m"], "particles_per_cell": [1],
                  "density": "1000 kg/m^3",
                  "material": {"law": "linear_elastic", "youngs_modulus": "10 MPa", "poissons_ratio": 0.0}}],
      "gravity": {"acceleration": ["-9.8 m/s^2"], "level": 10, "loading": {"type": "ramp", "duration": "0.2 s"}},
      "time_step": {"stable_fraction": 0.2},
      "termination": {"type": "at_rest", "unbalanced_force_ratio": 1e-3, "kinetic_energy_ratio": 1e-8,
                      "deadline": "5 s"}
    },
    "references": ["hencky"],
    "gates": [{"id": "rest", "metric": "completed", "at_least": 1, "basis": "theory", "reason": "damped"}]
  })");
}

/// The sweep that was measured: problems, and configurations that set a value, another's default, or a key.
Json measured_sweep() {
  return Json::parse(R"([
    {"parameter": "/scene/gravity/level", "values": [1, 10, 50]},
    {"parameter": "/scene/grid/cell_size", "values": ["0.1 m", "0.05 m"]},
    {"name": "order", "variants": [{"name": "default", "set": {}},
                                   {"name": "usl", "set": {"/scene/update_order": "usl"}}]}])");
}

/// A point of the made-up results: one configuration of one problem.
Json measured_point(int run, const std::string& cell_size, const std::string& order, double error,
                    Json seconds) {
  const Json set = order == "usl" ? Json{{"/scene/grid/cell_size", cell_size}, {"/scene/update_order", "usl"}}
                                  : Json{{"/scene/grid/cell_size", cell_size}};
  if (!seconds.is_null()) {
    const double median = seconds;
    seconds = {
        {"median", median}, {"low", 0.9 * median}, {"high", 1.5 * median}, {"repeats", 5}, {"whole", true}};
  }
  return {{"run", run},
          {"configuration", {{"/scene/grid/cell_size", cell_size}, {"order", order}}},
          {"changes", {{"set", set}, {"remove", Json::array()}}},
          {"family", ""},
          {"cell_size", 0.1},
          {"error", error},
          {"uncertainty", 0.0},
          {"failure", ""},
          {"of_reference", false},
          {"seconds", seconds},
          {"particle_steps", 1e4},
          {"bytes", 1e6 * (run + 1)},
          {"operations", 1e6},
          {"on_time_front", false},
          {"on_work_front", false}};
}

/// One problem: the errors grow with the level, coarse cells and the other order make them larger.
Json measured_trade(int level) {
  const double scale = 1e-3 * level;
  Json trade = {{"title", "stress"},
                {"problem", {{"/scene/gravity/level", level}}},
                {"error_name", "hencky.stress.l2"},
                {"reference",
                 {{"source", "hencky"},
                  {"uncertainty", 0.0},
                  {"x", Json::array()},
                  {"y", Json::array()},
                  {"spread", Json::array()}}},
                {"points", Json::array()}};
  trade["points"].push_back(measured_point(0, "0.1 m", "default", 4 * scale, 1.0));
  trade["points"].push_back(measured_point(1, "0.1 m", "usl", 5 * scale, 1.2));
  trade["points"].push_back(measured_point(2, "0.05 m", "default", 1 * scale, 4.0));
  trade["points"].push_back(measured_point(3, "0.05 m", "usl", 2 * scale, 3.0));
  return trade;
}

Json measured_case() {
  Json measured = {
      {"id", "measured"}, {"scene", column()["scene"]}, {"runs", Json::array()}, {"trades", Json::array()}};
  measured["definition"] = {{"sweep", measured_sweep()},
                            {"references", {"hencky"}},
                            {"trades", {{{"title", "stress"}, {"metric", "hencky.stress.l2"}}}}};
  for (int run = 0; run < 4; ++run) measured["runs"].push_back({{"program_hash", program_hash()}});
  for (const int level : {1, 10, 50}) measured["trades"].push_back(measured_trade(level));
  return measured;
}

Json results() {
  return {{"schema", "mpmvv-results/1"},
          {"revision", "abc1234"},
          {"date", "2026-01-02T03:04:05Z"},
          {"processor", processor_name()},
          {"cases", {{{"id", "other"}, {"trades", Json::array()}}, measured_case()}}};
}

class AdviseCommandTest : public testing::Test {
 protected:
  void SetUp() override {
    former_directory_ = fs::current_path();
    fs::create_directories(scratch_.path() / "user" / "mpmvv-out");
    fs::current_path(scratch_.path() / "user");
    setenv("MPMVV_ROOT", scratch_.path().c_str(), 1);
    write("column.json", column());
    write("mpmvv-out/results.json", results());
  }
  void TearDown() override {
    fs::current_path(former_directory_);
    unsetenv("MPMVV_ROOT");
  }

  static void write(const fs::path& file, const Json& json) { std::ofstream(file) << json.dump(1); }
  static Json read(const fs::path& file) {
    std::ifstream stream(file);
    return Json::parse(stream);
  }

  static Answer program(std::vector<std::string> words) {
    words.insert(words.begin(), "mpmvv");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = command_line(static_cast<int>(argv.size()), argv.data(),
                                  {.read_performance = nullptr, .write = nullptr});
    std::string out = testing::internal::GetCapturedStdout();
    return {code, std::move(out), testing::internal::GetCapturedStderr()};
  }

  static Answer advise(std::vector<std::string> words) {
    words.insert(words.begin(), {"advise", "column.json"});
    return program(words);
  }

  /// The column with some places changed.
  static void change_column(const Json& changes) {
    Json text = column();
    for (const auto& [pointer, value] : changes.items()) text[Json::json_pointer(pointer)] = value;
    write("column.json", text);
  }

  const fs::path& root() const { return scratch_.path(); }

 private:
  tests::ScratchDirectory scratch_;
  fs::path former_directory_;
};

TEST_F(AdviseCommandTest, NamesTheCheapestThatMeetsTheError) {
  const Answer answer = advise({"--error", "0.025"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_TRUE(answer.says("from       mpmvv-out/results.json, case measured, 10G: 4 configurations"))
      << answer.out;
  EXPECT_TRUE(answer.says("take       h 0.05 m, usl: error 0.02, 3 s (2.7 to 4.5)")) << answer.out;
  EXPECT_TRUE(answer.says("the error asked for is 1.25 times what is promised")) << answer.out;
  EXPECT_TRUE(answer.says("runner-up  h 0.05 m, default: error 0.01, 4 s")) << answer.out;
  EXPECT_TRUE(answer.says("costs 1.33 times as much")) << answer.out;
  EXPECT_TRUE(answer.says("cheaper    h 0.1 m, default: error 0.04")) << answer.out;
  EXPECT_TRUE(answer.says("saves 67 % and has 2 times the error")) << answer.out;
  EXPECT_TRUE(answer.says("at revision abc1234, 2026-01-02T03:04:05Z, ")) << answer.out;
  EXPECT_TRUE(answer.says(" days ago")) << answer.out;
  EXPECT_TRUE(answer.says("by the code that simulates in this program")) << answer.out;
  EXPECT_TRUE(answer.says("on this processor")) << answer.out;
}

TEST_F(AdviseCommandTest, SaysWhatIsNotFresh) {
  Json stale = results();
  stale["processor"] = "an abacus";
  stale["cases"][1]["runs"][3]["program_hash"] = "0";
  write("mpmvv-out/results.json", stale);
  const Answer answer = advise({"--error", "0.025"});
  EXPECT_EQ(answer.code, 0);
  EXPECT_TRUE(answer.says("by other code than simulates in this program")) << answer.out;
  EXPECT_TRUE(answer.says("on an abacus, not on this ")) << answer.out;
  EXPECT_TRUE(advise({"--error", "0.5"}).says("by the code that simulates in this program"))
      << "the run that is advised counts, not another";
}

TEST_F(AdviseCommandTest, TimeBoundsTheChoice) {
  EXPECT_TRUE(advise({"--time", "5"}).says("take       h 0.05 m, usl")) << "the slowest repeat counts";
  EXPECT_TRUE(advise({"--time", "6"}).says("take       h 0.05 m, default"));
  EXPECT_TRUE(advise({"--time", "6"}).says("the time asked for is 1 times the slowest repeat"));
  const Answer both = advise({"--error", "0.045", "--time", "1.6"});
  EXPECT_TRUE(both.says("take       h 0.1 m, default")) << both.out;
  EXPECT_TRUE(both.says("asked      error at most 0.045, time at most 1.6 s")) << both.out;
}

TEST_F(AdviseCommandTest, NothingThatMeetsItIsAnAnswer) {
  const Answer error = advise({"--error", "0.001"});
  EXPECT_EQ(error.code, 1);
  EXPECT_TRUE(
      error.says("nothing measured meets it\nnearest    most accurate: h 0.05 m, default: error 0.01"))
      << error.out;
  const Answer time = advise({"--time", "0.1"});
  EXPECT_EQ(time.code, 1);
  EXPECT_TRUE(time.says("nearest    fastest: h 0.1 m, default")) << time.out;
  const Answer both = advise({"--time", "5", "--error", "0.015"});
  EXPECT_EQ(both.code, 1);
  EXPECT_TRUE(both.says("nearest    within the time: h 0.05 m, usl")) << both.out;
}

TEST_F(AdviseCommandTest, WithoutTimesBytesDecide) {
  Json untimed = results();
  for (Json& trade : untimed["cases"][1]["trades"])
    for (Json& point : trade["points"]) point["seconds"] = nullptr;
  write("mpmvv-out/results.json", untimed);
  const Answer answer = advise({"--error", "0.025"});
  EXPECT_TRUE(answer.says("take       h 0.05 m, default: error 0.01, 1e+04 particle-steps, 3e+06 B moved"))
      << answer.out;
  EXPECT_EQ(advise({"--time", "100"}).code, 1) << "what was not timed is within no time";
  EXPECT_TRUE(advise({"--time", "100"}).says("no configuration has been timed"));
}

TEST_F(AdviseCommandTest, SameSceneInOtherWordsIsTheSame) {
  change_column({{"/scene/bodies/0/upper/0", "100 cm"},
                 {"/scene/bodies/0/material/youngs_modulus", "10000 kPa"},
                 {"/scene/grid/cell_size", "0.2 m"},
                 {"/scene/update_order", "usl"},
                 {"/scene/gravity/level", 10.0}});
  EXPECT_EQ(advise({"--error", "0.025"}).code, 0) << "the configurations decide on cells and order";
}

TEST_F(AdviseCommandTest, OtherScenesAreToldApart) {
  change_column({{"/scene/bodies/0/density", "1001 kg/m^3"}, {"/scene/sums_work", true}});
  const Answer answer = advise({"--error", "0.5"});
  EXPECT_EQ(answer.code, 1);
  EXPECT_TRUE(answer.says("nothing that was measured is like this scene")) << answer.out;
  EXPECT_TRUE(answer.says("nearest    measured, stress")) << answer.out;
  EXPECT_TRUE(answer.says("differs    /scene/bodies/0/density: \"1001 kg/m^3\" here, \"1000 kg/m^3\" there"))
      << answer.out;
  EXPECT_TRUE(answer.says("differs    /scene/sums_work: true here, nothing there")) << answer.out;
  EXPECT_TRUE(answer.says("\"trades\"")) << "how to get it measured";
}

TEST_F(AdviseCommandTest, BetweenTwoProblemsTheWorseCounts) {
  change_column({{"/scene/gravity/level", 30}});
  const Answer answer = advise({"--error", "0.1"});
  EXPECT_EQ(answer.code, 0);
  EXPECT_TRUE(answer.says("10G and 50G, between which this problem lies; the worse counts")) << answer.out;
  EXPECT_TRUE(answer.says("take       h 0.05 m, usl: error 0.1")) << answer.out;
  for (const double level : {0.5, 51.0}) {
    change_column({{"/scene/gravity/level", level}});
    const Answer outside = advise({"--error", "0.1"});
    EXPECT_EQ(outside.code, 1);
    EXPECT_TRUE(outside.says("differs    /scene/gravity/level: ")) << outside.out;
    EXPECT_TRUE(outside.says(" here, 1, 10, 50 there")) << outside.out;
  }
}

TEST_F(AdviseCommandTest, SweptProblemsAllCountUnlessOneIsNamed) {
  change_column({{"/sweep", Json::parse(R"([{"parameter": "/scene/gravity/level", "values": [10, 30]}])")}});
  const Answer all = advise({"--error", "0.1"});
  EXPECT_TRUE(all.says("10G and 50G, between which this problem lies")) << all.out;
  EXPECT_TRUE(all.says("take       h 0.05 m, usl: error 0.1")) << all.out;
  const Answer one = advise({"--error", "0.1", "--problem", "10G"});
  EXPECT_TRUE(one.says("case measured, 10G: 4")) << one.out;
  EXPECT_TRUE(one.says("take       h 0.1 m, default: error 0.04")) << one.out;
  const Answer none = advise({"--error", "0.1", "--problem", "20G"});
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("--problem: expected a problem of the case (10G, 30G), found \"20G\""),
            std::string::npos)
      << none.err;
}

TEST_F(AdviseCommandTest, WhatFollowsAlongASweptProblemHasToBeMeasuredToo) {
  change_column({{"/sweep", Json::parse(R"([{"parameter": "/scene/gravity/level", "values": [10, 50],
                                             "with": {"/scene/damping": [0.8, 0.7]}}])")}});
  const Answer answer = advise({"--error", "0.1"});
  EXPECT_EQ(answer.code, 1);
  EXPECT_TRUE(answer.says("differs    /scene/damping: 0.7 here, 0.8 there")) << answer.out;
  EXPECT_EQ(advise({"--error", "0.1", "--problem", "10G"}).code, 0) << "there the damping is that measured";
}

TEST_F(AdviseCommandTest, FollowersOfTheProblemHaveToFollow) {
  Json with = results();
  with["cases"][1]["definition"]["sweep"][0]["with"] = {
      {"/scene/termination/deadline", {"5 s", "5 s", "9 s"}}};
  write("mpmvv-out/results.json", with);
  EXPECT_EQ(advise({"--error", "0.1"}).code, 0);
  change_column({{"/scene/gravity/level", 30}, {"/scene/termination/deadline", "7 s"}});
  EXPECT_EQ(advise({"--error", "0.1"}).code, 0) << "between, as the level is";
  change_column({{"/scene/termination/deadline", "7 s"}});
  const Answer answer = advise({"--error", "0.1"});
  EXPECT_EQ(answer.code, 1);
  EXPECT_TRUE(answer.says("/scene/termination/deadline: \"7 s\" here, \"5 s\" there")) << answer.out;
}

TEST_F(AdviseCommandTest, ProblemsMayBeVariants) {
  Json varied = results();
  Json& measured = varied["cases"][1];
  measured["definition"]["sweep"][0] = Json::parse(R"({"name": "soil", "variants": [
      {"name": "stiff", "set": {}}, {"name": "soft", "set": {"/scene/bodies/0/material/youngs_modulus": "1 MPa"}}]})");
  measured["trades"].erase(2);
  measured["trades"][0]["problem"] = {{"soil", "stiff"}};
  measured["trades"][1]["problem"] = {{"soil", "soft"}};
  write("mpmvv-out/results.json", varied);
  EXPECT_TRUE(advise({"--error", "0.1"}).says("case measured, stiff: 4"));
  change_column({{"/scene/bodies/0/material/youngs_modulus", "1000 kPa"}});
  EXPECT_TRUE(advise({"--error", "0.1"}).says("case measured, soft: 4"));
  change_column({{"/scene/bodies/0/material/youngs_modulus", "2 MPa"}});
  const Answer neither = advise({"--error", "0.1"});
  EXPECT_EQ(neither.code, 1);
  EXPECT_TRUE(neither.says("differs    soil: none of its variants here, \"stiff\", \"soft\" there"))
      << neither.out;
}

TEST_F(AdviseCommandTest, OwnMeasurementsComeFirstAndTradesAreNamed) {
  Json two = results();
  two["cases"].push_back(two["cases"][1]);
  two["cases"][2]["id"] = "column";
  write("mpmvv-out/results.json", two);
  EXPECT_TRUE(advise({"--error", "0.1"}).says("case column, 10G"));
  two["cases"][2]["trades"].push_back(two["cases"][2]["trades"][1]);
  two["cases"][2]["trades"][3]["title"] = "another";
  write("mpmvv-out/results.json", two);
  const Answer which = advise({"--error", "0.1"});
  EXPECT_EQ(which.code, 2);
  EXPECT_NE(which.err.find("--trade: expected one of \"another\", \"stress\""), std::string::npos)
      << which.err;
  EXPECT_TRUE(advise({"--error", "0.1", "--trade", "another"}).says("column: another (hencky.stress.l2)"));
}

TEST_F(AdviseCommandTest, LooksInTheReportThenHereOrWhereItIsTold) {
  fs::create_directories(root() / "reports" / "out");
  Json reported = results();
  reported["cases"][1]["id"] = "reported";
  write(root() / "reports" / "out" / "results.json", reported);
  EXPECT_TRUE(advise({"--error", "0.1"}).says("case reported, 10G"));
  EXPECT_TRUE(advise({"--error", "0.1", "--from", "mpmvv-out"}).says("case measured, 10G"));
  reported["cases"][1]["scene"]["damping"] = 0.7;
  write(root() / "reports" / "out" / "results.json", reported);
  EXPECT_TRUE(advise({"--error", "0.1"}).says("case measured, 10G")) << "what the report lacks may be here";
}

TEST_F(AdviseCommandTest, WhatIsWrongIsToldInOneLine) {
  write("broken.json", "nothing");
  fs::create_directories("torn");
  std::ofstream("torn/results.json") << "{";
  const std::vector<std::pair<std::vector<std::string>, std::string>> faults = {
      {{}, "say --error, --time or both"},
      {{"--error", "-1"}, "--error"},
      {{"--error", "0.1", "--from", "nowhere"}, "nowhere/results.json: no such file"},
      {{"--error", "0.1", "--from", "torn"}, "torn/results.json: not the results of a campaign"},
      {{"--error", "0.1", "--apply", "a-b.json"}, "a-b.json: expected a name such as advised.json"},
      {{"--error", "0.1", "--apply", "advised.txt"}, "advised.txt: expected a name such as advised.json"},
      {{"--error", "0.1", "--apply", "column.json"},
       "column.json: is there already, and is replaced only with --force"},
  };
  for (const auto& [words, expected] : faults) {
    const Answer answer = advise(words);
    EXPECT_EQ(answer.code, 2) << expected;
    EXPECT_NE(answer.err.find(expected), std::string::npos) << expected << " in " << answer.err;
    EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
  }
  EXPECT_EQ(read("column.json"), column());
  fs::remove("mpmvv-out/results.json");
  EXPECT_NE(advise({"--error", "0.1"}).err.find("no results in "), std::string::npos);
}

// ---- the case that is written ----

TEST_F(AdviseCommandTest, WritesACaseWithTheConfigurationAndItsPromise) {
  change_column(
      {{"/probes",
        Json::parse(R"([{"id": "top", "quantity": "displacement", "at": ["1 m"], "every": "0.1 s"}])")}});
  const Answer answer = advise({"--error", "0.025", "--apply", "below/advised.json"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  EXPECT_TRUE(answer.says("written    below/advised.json"));
  const Case written = read_case("below/advised.json");
  EXPECT_EQ(written.id, "advised");
  ASSERT_EQ(written.runs.size(), 1u);
  EXPECT_EQ(written.runs[0].scene.cell_size, 0.05);
  EXPECT_EQ(written.runs[0].scene.update_order, UpdateOrder::usl);
  EXPECT_EQ(written.probes.size(), 1u) << "the case's own";
  ASSERT_EQ(written.gates.size(), 1u);
  EXPECT_EQ(written.gates[0].id, "promise");
  EXPECT_EQ(written.gates[0].metric, "hencky.stress.l2");
  EXPECT_EQ(written.gates[0].comparison, Comparison::at_most);
  EXPECT_DOUBLE_EQ(written.gates[0].threshold, 1.05 * 0.02);
  EXPECT_NE(written.gates[0].reason.find("0.02 was promised by measured at revision abc1234"),
            std::string::npos)
      << written.gates[0].reason;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator("below")) files.push_back(entry.path().filename());
  EXPECT_EQ(files, std::vector<fs::path>{"advised.json"}) << "nothing else is left";
}

TEST_F(AdviseCommandTest, PutsBackWhatOtherConfigurationsChange) {
  change_column({{"/scene/update_order", "usf"}});
  ASSERT_EQ(advise({"--error", "0.1", "--apply", "advised.json"}).code, 0);
  const Json scene = read("advised.json")["scene"];
  EXPECT_FALSE(scene.contains("update_order"))
      << "the configuration that was measured left it to its default";
  EXPECT_EQ(scene, column()["scene"]);
}

TEST_F(AdviseCommandTest, AppliesOnTopOnlyIfForced) {
  ASSERT_EQ(advise({"--error", "0.1", "--apply", "advised.json"}).code, 0);
  const Json first = read("advised.json");
  EXPECT_EQ(advise({"--error", "0.025", "--apply", "advised.json"}).code, 2);
  EXPECT_EQ(read("advised.json"), first);
  EXPECT_EQ(advise({"--error", "0.025", "--apply", "advised.json", "--force"}).code, 0);
  EXPECT_NE(read("advised.json"), first);
  // Advice on a case that was advised is the same advice.
  const Answer again = program({"advise", "advised.json", "--error", "0.025", "--apply", "again.json"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(read("again.json")["scene"], read("advised.json")["scene"]);
}

TEST_F(AdviseCommandTest, ProblemAxesStayWhereNoneWasNamed) {
  change_column({{"/sweep", Json::parse(R"([{"parameter": "/scene/gravity/level", "values": [10, 30]},
                                            {"parameter": "/scene/grid/cell_size", "values": ["0.2 m", "0.1 m"]}])")}});
  ASSERT_EQ(advise({"--error", "0.1", "--apply", "all.json"}).code, 0);
  const Case all = read_case("all.json");
  ASSERT_EQ(all.runs.size(), 2u);
  EXPECT_EQ(all.runs[1].scene.gravity.level, 30);
  EXPECT_EQ(all.runs[1].scene.cell_size, 0.05);
  EXPECT_DOUBLE_EQ(all.gates[0].threshold, 1.5 * 0.1) << "30G was not measured";
  EXPECT_NE(all.gates[0].reason.find("lies between"), std::string::npos);
  ASSERT_EQ(advise({"--error", "0.1", "--apply", "one.json", "--problem", "30G"}).code, 0);
  const Case one = read_case("one.json");
  ASSERT_EQ(one.runs.size(), 1u);
  EXPECT_EQ(one.runs[0].scene.gravity.level, 30);
  EXPECT_DOUBLE_EQ(one.gates[0].threshold, 1.5 * 0.1);
}

TEST_F(AdviseCommandTest, SignedErrorsAreBoundOnBothSides) {
  Json other = results();
  for (Json& trade : other["cases"][1]["trades"]) trade["error_name"] = "reading.strain_gap";
  write("mpmvv-out/results.json", other);
  EXPECT_EQ(advise({"--error", "0.1", "--apply", "advised.json"}).code, 2) << "a metric that the case lacks";
  EXPECT_FALSE(fs::exists("advised.json"));
  for (Json& trade : other["cases"][1]["trades"]) trade["error_name"] = "cell_crossings";
  write("mpmvv-out/results.json", other);
  ASSERT_EQ(advise({"--error", "0.1", "--apply", "advised.json"}).code, 0);
  const Case written = read_case("advised.json");
  ASSERT_EQ(written.gates.size(), 2u);
  EXPECT_EQ(written.gates[1].comparison, Comparison::at_least);
  EXPECT_EQ(written.gates[1].threshold, -written.gates[0].threshold);
}

TEST(ConfiguredScene, SetsRemovesAndRefuses) {
  MeasuredCase measured;
  measured.scene = Json::parse(R"({"bodies": [{"name": "soil"}, {"name": "block"}], "limit": 1})");
  const std::vector<std::string> places = {"/scene/bodies/1", "/scene/rigid", "/scene/limit"};
  const Json rigid = {{"set", {{"/scene/rigid", true}}}, {"remove", {"/scene/bodies/1"}}};
  const Json block = {{"set", Json::object()}, {"remove", Json::array()}};
  const Json with_rigid = configured_scene(measured.scene, measured, places, rigid);
  EXPECT_EQ(with_rigid, Json::parse(R"({"bodies": [{"name": "soil"}], "limit": 1, "rigid": true})"));
  EXPECT_TRUE(same_value(configured_scene(with_rigid, measured, places, block), measured.scene))
      << "back again from the other configuration";
  for (const Json& changes : {Json{{"set", {{"/scene/none/there", 1}}}, {"remove", Json::array()}},
                              Json{{"set", Json::object()}, {"remove", {"/scene/none"}}}}) {
    try {
      configured_scene(measured.scene, measured, places, changes);
      ADD_FAILURE() << changes;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("the case has no /scene/none"), std::string::npos)
          << error.what();
    }
  }
}

// ---- from measurement to promise ----

/// The column at other levels, with a trade, or with advice put to the test too.
Json traded(const std::string& id, const Json& levels) {
  Json text = column();
  text["id"] = id;
  text["sweep"] = measured_sweep();
  text["sweep"][0]["values"] = levels;
  text["trades"] = Json::parse(R"([{"title": "stress", "metric": "hencky.stress.l2",
                                    "problems": ["/scene/gravity/level"], "asked": [0.005]}])");
  return text;
}

TEST_F(AdviseCommandTest, RunOfTheWrittenCaseKeepsThePromise) {
  write("swept.json", traded("swept", {1, 10, 50}));
  ASSERT_EQ(program({"run", "swept.json", "--out", "measured", "--threads", "2"}).code, 0);
  const Json measured = read("measured/results.json");
  std::vector<double> errors;
  for (const Json& point : measured["cases"][0]["trades"][2]["points"]) errors.push_back(point["error"]);
  std::sort(errors.begin(), errors.end());
  ASSERT_LT(errors[0], 0.8 * errors[1]) << "there is something to choose";
  const std::string asked = std::to_string(std::sqrt(errors[0] * errors[1]));
  change_column({{"/scene/gravity/level", 50}});
  const Answer answer = advise({"--error", asked, "--from", "measured", "--apply", "advised.json"});
  ASSERT_EQ(answer.code, 0) << answer.err << answer.out;
  EXPECT_EQ(read_case("advised.json").runs[0].scene.cell_size, 0.05);
  const Answer kept = program({"run", "advised.json", "--out", "kept", "--threads", "1"});
  EXPECT_EQ(kept.code, 0) << kept.out;
  EXPECT_TRUE(kept.says("PASS  promise"));
  const Json run = read("kept/results.json")["cases"][0]["runs"][0];
  EXPECT_NEAR(run["gates"][0]["value"].get<double>() * 1.05, run["gates"][0]["threshold"].get<double>(), 1e-6)
      << "the very run that was measured";
  EXPECT_NEAR(run["gates"][0]["value"].get<double>(), errors[0], 1e-12);

  // A promise that was never true is found out.
  Json lie = measured;
  for (Json& trade : lie["cases"][0]["trades"])
    for (Json& point : trade["points"]) point["error"] = point["error"].get<double>() / 2;
  write("measured/results.json", lie);
  ASSERT_EQ(advise({"--error", asked, "--from", "measured", "--apply", "lie.json"}).code, 0);
  EXPECT_EQ(program({"run", "lie.json", "--out", "broken", "--threads", "1"}).code, 1);
}

TEST_F(AdviseCommandTest, CampaignPutsAdviceToTheTest) {
  Json testing = traded("testing", {30});
  testing["advice"] = {{"of", "measured"}, {"asked", {0.2, 0.003}}};
  testing["gates"].push_back({{"id", "kept"},
                              {"metric", "advice.kept"},
                              {"at_least", 1},
                              {"basis", "requirement"},
                              {"reason", "promised"}});
  write("testing.json", testing);
  write("measured.json", traded("measured", {10, 50}));
  const Answer both = program({"run", "testing.json", "measured.json", "--out", "both", "--threads", "1"});
  EXPECT_EQ(both.code, 0) << both.out;
  const Json found = read("both/results.json")["cases"][0]["advice"];
  ASSERT_EQ(found["trials"].size(), 2u);
  for (const Json& trial : found["trials"]) {
    EXPECT_EQ(trial["drawn_from"], "10G and 50G");
    EXPECT_TRUE(trial["kept"]) << trial;
    EXPECT_GE(trial["regret"], 1.0);
  }
  EXPECT_NE(found["trials"][0]["configuration"], found["trials"][1]["configuration"]);
  const Answer alone = program({"run", "testing.json", "--out", "alone", "--threads", "1"});
  EXPECT_EQ(alone.code, 0) << alone.out;
  EXPECT_TRUE(alone.says("WAITS  kept")) << alone.out;
}

TEST_F(AdviseCommandTest, GatesOnAdviceAreOfTheCaseAsAWhole) {
  Json text = traded("testing", {30});
  text["advice"] = {{"of", "measured"}, {"asked", {0.2}}};
  text["gates"][0] = {{"id", "kept"},
                      {"metric", "advice.kept"},
                      {"at_least", 1},
                      {"basis", "requirement"},
                      {"reason", "promised"}};
  text["gates"].push_back({{"id", "ends"},
                           {"metric", "completed"},
                           {"at_least", 1},
                           {"basis", "requirement"},
                           {"reason", "asked for"}});
  EXPECT_EQ(parse_case(text.dump(), "testing.json").gates[0].metric, "advice.kept");
  const auto refused_at = [&](const std::string& pointer, const Json& changed) {
    try {
      parse_case(changed.dump(), "testing.json");
      ADD_FAILURE() << pointer;
    } catch (const CaseError& error) {
      EXPECT_NE(std::string(error.what()).find("testing.json: " + pointer + ": "), std::string::npos)
          << error.what();
    }
  };
  Json without = text, some = text, series = text;
  without.erase("advice");
  refused_at("/gates/0/metric", without);
  some["gates"][0]["where"] = {{"order", {"usl"}}};
  refused_at("/gates/0/where", some);
  series["gates"][0].update({{"statistic", "reduction"}, {"across", "/scene/grid/cell_size"}});
  refused_at("/gates/0/metric", series);
}

/// A rough strip on elastic ground, whose load curve has two families of schemes for its truth.
Json strip() {
  return Json::parse(R"({
    "id": "strip", "title": "A strip on clay", "description": "It is pressed in.",
    "scene": {
      "dimension": 2, "scheme": "cpgimp", "damping": 0.7,
      "grid": {"cell_size": "0.25 m", "lower": ["0 m", "0 m"], "upper": ["2 m", "1.5 m"],
               "edges": {"x_lower": "roller", "x_upper": "roller", "y_lower": "fixed", "y_upper": "free"}},
      "bodies": [{"name": "clay", "lower": ["0 m", "0 m"], "upper": ["2 m", "1 m"], "particles_per_cell": [2, 2],
                  "density": "1800 kg/m^3", "initial_stress": {"type": "geostatic", "surface": "1 m", "k0": 0.6},
                  "material": {"law": "linear_elastic", "youngs_modulus": "3 MPa", "poissons_ratio": 0.3}}],
      "rigid_bodies": [{"name": "strip", "lower": ["0 m", "1 m"], "upper": ["0.5 m", "1.5 m"],
                        "velocity": ["0 m/s", "-0.1 m/s"], "ramp": "0.1 s"}],
      "gravity": {"acceleration": ["0 m/s^2", "-9.81 m/s^2"], "level": 1, "loading": {"type": "step"}},
      "time_step": {"stable_fraction": 0.4},
      "termination": {"type": "at_time", "time": "0.3 s"}
    },
    "sweep": [{"parameter": "/scene/scheme", "values": ["cpgimp", "ugimp"]},
              {"parameter": "/scene/grid/cell_size", "values": ["0.25 m", "0.125 m"]}],
    "references": [],
    "probes": [{"id": "descent", "quantity": "displacement", "of": "strip", "every": "5 ms"},
               {"id": "reaction", "quantity": "reaction", "of": "strip", "every": "5 ms"}],
    "trades": [{"title": "load curve", "curve": "pressure", "from": "4 mm", "up_to": "20 mm", "within": "1 mm",
                "finest": [{"/scene/scheme": ["cpgimp"], "/scene/grid/cell_size": ["0.125 m"]},
                           {"/scene/scheme": ["ugimp"], "/scene/grid/cell_size": ["0.125 m"]}], "asked": [0.5]}],
    "gates": [{"id": "pressed_in", "metric": "completed", "at_least": 1, "basis": "theory", "reason": "pressed"}]
  })");
}

TEST_F(AdviseCommandTest, PromiseOfACurveIsHeldAgainstTheCurve) {
  write("strip.json", strip());
  ASSERT_EQ(program({"run", "strip.json", "--out", "out", "--threads", "1"}).code, 0);
  const auto advised = [](const std::string& file) {
    return program({"advise", "strip.json", "--error", "0.5", "--from", "out", "--apply", file});
  };
  const Answer answer = advised("advised.json");
  ASSERT_EQ(answer.code, 0) << answer.err << answer.out;
  EXPECT_TRUE(answer.says(", known to ")) << answer.out;
  const CurveFile curve = read_curve_file("advised_reference.json");
  EXPECT_EQ(curve.origin, "simulated");
  EXPECT_EQ(curve.rows.size(), 200u);
  EXPECT_EQ(curve.columns[1].experimental.kind, StatedUncertainty::Kind::relative);
  const Case written = read_case("advised.json");
  ASSERT_EQ(written.runs.size(), 1u);
  EXPECT_EQ(written.runs[0].scene.cell_size, 0.25) << "the finest are no offers";
  EXPECT_EQ(written.measurements.at(0).within, 0.001);
  EXPECT_EQ(written.gates.at(0).metric, "measured.reference.l2");
  const Answer kept = program({"run", "advised.json", "--out", "kept", "--threads", "1"});
  EXPECT_EQ(kept.code, 0) << kept.out;
  const Json trade = read("out/results.json")["cases"][0]["trades"][0];
  const Json gate = read("kept/results.json")["cases"][0]["runs"][0]["gates"][0];
  EXPECT_NEAR(gate["value"].get<double>(),
              trade["points"][written.runs[0].scene.scheme == Scheme::cpgimp ? 0 : 2]["error"].get<double>(),
              1e-9)
      << "the same distance by another way";
  EXPECT_EQ(advised("advised.json").code, 2) << "is there already";
  std::ofstream("new_reference.json") << "mine";
  EXPECT_EQ(advised("new.json").code, 2) << "so is the curve's file";
  EXPECT_FALSE(fs::exists("new.json"));

  Json lie = read("out/results.json");
  for (Json& point : lie["cases"][0]["trades"][0]["points"]) {
    point["error"] = point["error"].get<double>() / 2;
    point["uncertainty"] = 0.0;
  }
  write("out/results.json", lie);
  ASSERT_EQ(advised("lie.json").code, 0);
  EXPECT_EQ(program({"run", "lie.json", "--out", "broken", "--threads", "1"}).code, 1);
}

}  // namespace
}  // namespace mpm::vv
