#include "vv/command_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>

#include "tests/support/scratch_directory.hpp"
#include "vv/machine.hpp"
#include "vv/revision.hpp"

namespace mpm::vv {
namespace {

namespace fs = std::filesystem;

/// What the program said and how it ended.
struct Answer {
  int code;
  std::string out, err;
  std::optional<CampaignVerdict> reported;
  fs::path reported_in;
  std::optional<PerformanceFiles> measurements;  ///< that were read

  long error_lines() const { return std::count(err.begin(), err.end(), '\n'); }
};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A project with shipped cases, and a directory the user is in.
class CommandLineTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(cases());
    fs::create_directories(scratch_.path() / "user");
    former_directory_ = fs::current_path();
    fs::current_path(scratch_.path() / "user");
    setenv("MPMVV_ROOT", scratch_.path().c_str(), 1);
  }
  void TearDown() override {
    fs::current_path(former_directory_);
    unsetenv("MPMVV_ROOT");
  }

  fs::path cases() const { return scratch_.path() / "vv" / "cases"; }
  fs::path user() const { return scratch_.path() / "user"; }
  const fs::path& root() const { return scratch_.path(); }

  /// Whoever made any measurements that are read.
  MeasuredBy measured_by_{build_facts().revision, processor_name(), core_count()};

  static Json case_text(const std::string& id) {
    return Json::parse(R"({
      "id": "x", "title": "A column", "description": "It falls.",
      "scene": {
        "dimension": 1, "scheme": "cpgimp",
        "grid": {"cell_size": "0.1 m", "lower": ["0 m"], "upper": ["1.2 m"],
                 "edges": {"x_lower": "fixed", "x_upper": "free"}},
        "bodies": [{"name": "column", "lower": ["0 m"], "upper": ["1 m"], "particles_per_cell": [1],
                    "density": "1000 kg/m^3",
                    "material": {"law": "linear_elastic", "youngs_modulus": "10 MPa", "poissons_ratio": 0.0}}],
        "gravity": {"acceleration": ["-9.8 m/s^2"], "level": 1, "loading": {"type": "step"}},
        "time_step": {"stable_fraction": 0.2},
        "termination": {"type": "at_time", "time": "0.02 s"}
      },
      "sweep": [{"parameter": "/scene/gravity/level", "values": [1, 2, 3]}],
      "references": [],
      "gates": [{"id": "steps", "metric": "steps", "at_least": 100, "basis": "theory", "reason": "counted"}]
    })")
        .patch(Json::array({{{"op", "replace"}, {"path", "/id"}, {"value", id}}}));
  }

  static Json with(Json text, const std::string& pointer, const Json& value) {
    text[Json::json_pointer(pointer)] = value;
    return text;
  }

  static void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }
  static void write(const fs::path& file, const Json& text) { write(file, text.dump(1)); }
  static Json read(const fs::path& file) {
    std::ifstream stream(file);
    return Json::parse(stream);
  }

  Answer ask(std::vector<std::string> words) const {
    words.insert(words.begin(), "mpmvv");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    Answer answer{};
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const auto read = [&](const PerformanceFiles& files) -> std::optional<MeasuredBy> {
      if (files.file == "bad.json") throw std::runtime_error("bad.json: /steps: expected an array");
      answer.measurements = files;
      return files.file.empty() ? std::nullopt : std::optional(measured_by_);
    };
    const auto write = [&](const CampaignVerdict& verdict, const fs::path& directory) {
      answer.reported = verdict;
      answer.reported_in = directory;
    };
    answer.code = command_line(static_cast<int>(argv.size()), argv.data(),
                               {.read_performance = read, .write = write});
    answer.out = testing::internal::GetCapturedStdout();
    answer.err = testing::internal::GetCapturedStderr();
    return answer;
  }

 private:
  tests::ScratchDirectory scratch_;
  fs::path former_directory_;
};

TEST_F(CommandLineTest, HelpNamesEveryCommand) {
  const Answer help = ask({"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_TRUE(help.err.empty());
  for (const char* command : {"list", "run", "report", "advise", "digitise", "test", "bench"})
    EXPECT_TRUE(contains(help.out, command));
  EXPECT_EQ(ask({"run", "--help"}).code, 0);
}

TEST_F(CommandLineTest, VersionNamesRevisionAndCompiler) {
  const Answer version = ask({"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_TRUE(version.out.starts_with("mpmvv ")) << version.out;
  EXPECT_TRUE(contains(version.out, "(")) << version.out;
  EXPECT_EQ(std::count(version.out.begin(), version.out.end(), '\n'), 1);
}

TEST_F(CommandLineTest, WrongUseIsTwoInOneLine) {
  write(cases() / "fine.json", case_text("fine"));
  const std::vector<std::vector<std::string>> wrong = {{},
                                                       {"dance"},
                                                       {"run"},
                                                       {"run", "fine", "--threads", "0"},
                                                       {"run", "fine", "--threads", "many"},
                                                       {"run", "fine", "--threads", "-3"},
                                                       {"report", "--fast"},
                                                       {"run", "fine", "--out"},
                                                       {"test"},
                                                       {"bench", "--filter=x"}};
  for (const auto& words : wrong) {
    const Answer answer = ask(words);
    EXPECT_EQ(answer.code, 2) << testing::PrintToString(words);
    EXPECT_EQ(answer.error_lines(), 1) << answer.err;
    EXPECT_TRUE(answer.out.empty()) << answer.out;
    EXPECT_FALSE(answer.reported);
  }
}

TEST_F(CommandLineTest, ListShowsOneLineACase) {
  write(cases() / "beta.json", case_text("beta"));
  write(cases() / "alpha.json", case_text("alpha"));
  const Answer list = ask({"list"});
  EXPECT_EQ(list.code, 0);
  EXPECT_EQ(list.out, "alpha     3 runs  A column\nbeta      3 runs  A column\n");
}

TEST_F(CommandLineTest, ListTellsOfABadCaseAndShowsTheOthers) {
  write(cases() / "alpha.json", case_text("alpha"));
  write(cases() / "bad.json", with(case_text("bad"), "/scene/dimension", 7));
  const Answer list = ask({"list"});
  EXPECT_EQ(list.code, 2);
  EXPECT_TRUE(contains(list.out, "alpha"));
  EXPECT_EQ(list.error_lines(), 1);
}

TEST_F(CommandLineTest, RunGivesZeroWhenEveryGatePasses) {
  write(user() / "mine.json", case_text("mine"));
  const Answer answer = ask({"run", "mine.json", "--threads", "1"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_TRUE(answer.err.empty()) << answer.err;
  EXPECT_TRUE(contains(answer.out, "PASS")) << answer.out;
  EXPECT_FALSE(contains(answer.out, "FAIL")) << answer.out;
  EXPECT_TRUE(contains(answer.out, "3 x, closest: ")) << answer.out;
  const Json results = read(user() / "mpmvv-out" / "results.json");
  EXPECT_EQ(results["cases"][0]["id"], "mine");
  EXPECT_EQ(results["cases"][0]["runs"].size(), 3u);
  ASSERT_TRUE(answer.reported);
  EXPECT_EQ(answer.reported->threads, 1);
  EXPECT_EQ(answer.reported_in, user() / "mpmvv-out");
}

TEST_F(CommandLineTest, RunGivesOneWhenAGateFailsAndShowsEachFailure) {
  write(user() / "mine.json", with(case_text("mine"), "/gates/0/at_least", 101));
  const Answer answer = ask({"run", "mine.json"});
  EXPECT_EQ(answer.code, 1);
  std::size_t failures = 0;
  for (std::size_t at = answer.out.find("  FAIL"); at != std::string::npos;
       at = answer.out.find("  FAIL", at + 1)) {
    ++failures;
  }
  EXPECT_EQ(failures, 3u) << answer.out;
  EXPECT_TRUE(contains(answer.out, ">= 101")) << answer.out;
  EXPECT_EQ(read(user() / "mpmvv-out" / "results.json")["counts"]["gates_failed"], 3);
  EXPECT_TRUE(answer.reported);
}

TEST_F(CommandLineTest, ControlsDecideTheExitCodeToo) {
  Json text = with(case_text("mine"), "/gates/0/must_fail", true);
  write(user() / "mine.json", text);
  EXPECT_EQ(ask({"run", "mine.json"}).code, 1);  // green although it was to be red
  write(user() / "mine.json", with(text, "/gates/0/at_least", 101));
  const Answer red = ask({"run", "mine.json"});
  EXPECT_EQ(red.code, 0);
  EXPECT_TRUE(contains(red.out, "CONTROL")) << red.out;
}

TEST_F(CommandLineTest, RunFindsShippedCasesById) {
  write(cases() / "shipped.json", case_text("shipped"));
  const Answer answer = ask({"run", "shipped", "--out", "here/there"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_TRUE(fs::exists(user() / "here" / "there" / "results.json"));
  const Answer unknown = ask({"run", "unheard_of"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_TRUE(contains(unknown.err, "unheard_of"));
}

TEST_F(CommandLineTest, RunReusesWhatItStored) {
  write(user() / "mine.json", case_text("mine"));
  EXPECT_TRUE(contains(ask({"run", "mine.json"}).out, "0 stored records reused"));
  EXPECT_TRUE(contains(ask({"run", "mine.json"}).out, "3 stored records reused"));
}

TEST_F(CommandLineTest, EveryBadCaseIsToldBeforeAnythingRuns) {
  write(user() / "good.json", case_text("good"));
  write(user() / "negative.json",
        with(case_text("negative"), "/scene/bodies/0/material/youngs_modulus", "-10 MPa"));
  write(user() / "broken.json", std::string("{\n\"id\": "));
  const Answer answer = ask({"run", "good.json", "negative.json", "broken.json", "absent.json"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.error_lines(), 3) << answer.err;
  for (const char* name :
       {"negative.json", "/scene/bodies/0/material/youngs_modulus", "broken.json", "absent.json"}) {
    EXPECT_TRUE(contains(answer.err, name)) << name << " in " << answer.err;
  }
  EXPECT_TRUE(answer.out.empty());
  EXPECT_FALSE(fs::exists(user() / "mpmvv-out"));
  EXPECT_FALSE(answer.reported);
}

TEST_F(CommandLineTest, TwoCasesOfOneIdAreRefused) {
  write(user() / "mine.json", case_text("mine"));
  const Answer answer = ask({"run", "mine.json", "mine.json"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(contains(answer.err, "two cases have the id mine")) << answer.err;
}

TEST_F(CommandLineTest, UnwritableOutputIsToldBeforeAnythingRuns) {
  write(user() / "mine.json", case_text("mine"));
  write(user() / "a_file", std::string("in the way"));
  const Answer answer = ask({"run", "mine.json", "--out", "a_file/out"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.error_lines(), 1);
  EXPECT_TRUE(contains(answer.err, "cannot write results there")) << answer.err;
  EXPECT_FALSE(answer.reported);
}

TEST_F(CommandLineTest, ReportRunsEveryShippedCaseIntoTheProject) {
  write(cases() / "alpha.json", case_text("alpha"));
  write(cases() / "beta.json", case_text("beta"));
  const Answer answer = ask({"report"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(read(root() / "reports" / "out" / "results.json")["counts"]["cases"], 2);
  EXPECT_EQ(answer.reported_in, root() / "reports" / "out");
}

TEST_F(CommandLineTest, QuickReportShowsWhatItLeftOut) {
  write(cases() / "alpha.json", case_text("alpha"));
  write(cases() / "slow.json", with(case_text("slow"), "/quick", false));
  const Answer answer = ask({"report", "--quick", "--out", "out"});
  EXPECT_EQ(answer.code, 0) << answer.err;
  EXPECT_TRUE(contains(answer.out, "slow: not run")) << answer.out;
  EXPECT_TRUE(contains(answer.out, "2: 1 pass, 0 fail, 1 not run")) << answer.out;
  const Json results = read(user() / "out" / "results.json");
  EXPECT_EQ(results["cases"][1]["status"], "not_run");
  EXPECT_FALSE(results["cases"][1]["not_run_reason"].get<std::string>().empty());
}

TEST_F(CommandLineTest, ReportWithoutCasesIsAnError) {
  const Answer answer = ask({"report"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_EQ(answer.error_lines(), 1);
}

TEST_F(CommandLineTest, AReportThatCannotBeWrittenIsAnErrorAfterTheResults) {
  write(user() / "mine.json", case_text("mine"));
  std::vector<std::string> words = {"mpmvv", "run", "mine.json"};
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const auto fail = [](const CampaignVerdict&, const fs::path&) {
    throw std::runtime_error("no font\nat all");
  };
  const int code = command_line(3, argv.data(), {.read_performance = nullptr, .write = fail});
  testing::internal::GetCapturedStdout();
  EXPECT_EQ(code, 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "mpmvv: no font at all\n");
  EXPECT_TRUE(fs::exists(user() / "mpmvv-out" / "results.json"));
}

TEST_F(CommandLineTest, MeasurementsAreReadBeforeAnythingRuns) {
  write(cases() / "fine.json", case_text("fine"));
  const Answer good = ask({"report", "--out", "out", "--performance", "m.json", "--performance-history", "old"});
  ASSERT_TRUE(good.measurements);
  EXPECT_EQ(good.measurements->file, "m.json");
  EXPECT_EQ(good.measurements->history, "old");
  EXPECT_TRUE(good.reported);
  const Answer bad = ask({"report", "--out", "out", "--performance", "bad.json"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_EQ(bad.err, "mpmvv: bad.json: /steps: expected an array\n");
  EXPECT_TRUE(bad.out.empty());
  EXPECT_FALSE(bad.reported);
  EXPECT_EQ(ask({"report", "--performance-history", "old"}).code, 2) << "with nothing to compare with";
}

TEST_F(CommandLineTest, AMeasurementThatFailedChangesNoExitCode) {
  write(cases() / "fine.json", case_text("fine"));
  const Answer answer = ask({"report", "--out", "out", "--performance-failure", "it ended with exit code 3"});
  EXPECT_EQ(answer.code, 0);
  ASSERT_TRUE(answer.measurements);
  EXPECT_EQ(answer.measurements->failure, "it ended with exit code 3");
  EXPECT_TRUE(answer.reported);
}

TEST_F(CommandLineTest, SaysByItsExitCodeWhetherMeasurementsAreCurrent) {
  const bool current = still_holds(measured_by_, measured_by_);
  EXPECT_EQ(ask({"check-performance", "m.json"}).code, current ? 0 : 1) << "this program may be of a modified source";
  EXPECT_EQ(ask({"check-performance", "bad.json"}).code, 2);
  EXPECT_EQ(ask({"check-performance"}).code, 2);
  measured_by_ = {"feedbeef", "another processor", 3};
  const Answer elsewhere = ask({"check-performance", "m.json"});
  EXPECT_EQ(elsewhere.code, 1);
  EXPECT_EQ(elsewhere.out, "measured at revision feedbeef on another processor, 3 cores: not current\n");
}

TEST(Measurements, HoldOnlyForTheSameMachineAndUnmodifiedRevision) {
  const MeasuredBy now{"0123abcd", "a processor", 2};
  EXPECT_TRUE(still_holds(now, now));
  EXPECT_FALSE(still_holds({"feedbeef", "a processor", 2}, now));
  EXPECT_FALSE(still_holds({"0123abcd-dirty", "a processor", 2}, now));
  EXPECT_FALSE(still_holds({"0123abcd", "another processor", 2}, now));
  EXPECT_FALSE(still_holds({"0123abcd", "a processor", 4}, now));
  for (const char* revision : {"unknown", "0123abcd-dirty"}) {
    const MeasuredBy vague{revision, "a processor", 2};
    EXPECT_FALSE(still_holds(vague, vague)) << revision;
  }
}

}  // namespace
}  // namespace mpm::vv
