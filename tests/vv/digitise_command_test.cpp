#include "vv/digitise_command.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/support/painted_figure.hpp"
#include "tests/support/scratch_directory.hpp"
#include "vv/command_line.hpp"
#include "vv/curve_file.hpp"
#include "vv/digitised_curve.hpp"

namespace mpm::vv {
namespace {

namespace fs = std::filesystem;

/// What the program said and how it ended.
struct Answer {
  int code;
  std::string out, err;
};

Answer ask(std::vector<std::string> words) {
  words.insert(words.begin(), {"mpmvv", "digitise"});
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = command_line(static_cast<int>(argv.size()), argv.data(),
                                {.read_performance = nullptr, .write = nullptr});
  std::string out = testing::internal::GetCapturedStdout();
  return {code, std::move(out), testing::internal::GetCapturedStderr()};
}

/// A directory with a figure, `figure.png`: a red line along pressure = 2 + 0.2 settlement, and four blue
/// markers.
class DigitiseCommandTest : public testing::Test {
 protected:
  void SetUp() override {
    former_directory_ = fs::current_path();
    fs::current_path(scratch_.path());
    tests::PaintedFigure figure;
    figure.stroke(
        {214, 39, 40}, [](double x) { return 250.0 - 0.4 * (x - 20.0); }, 30, 350);
    for (const double x : {50.0, 120.0, 200.0, 300.0}) figure.disc({31, 119, 180}, {x, 60.0}, 6.0);
    write("figure.png", png_of(figure.image));
  }
  void TearDown() override { fs::current_path(former_directory_); }

  static void write(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
  }
  static std::string text_in(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  /// The options that read the line, in the order given; `changes` replace or add pairs of option and value.
  static std::vector<std::string> line(const std::vector<std::pair<std::string, std::string>>& changes = {}) {
    std::vector<std::pair<std::string, std::string>> options = {
        {"--x", "settlement mm"},       {"--x-point", "20,290=0"},    {"--x-point", "370,290=35"},
        {"--y", "pressure kPa linear"}, {"--y-point", "20,290=0"},    {"--y-point", "20,10=14"},
        {"--series", "line=#d62728"},   {"--citation", "Kiriyama15"}, {"--place", "Figure 3"}};
    for (const auto& change : changes) {
      const auto same = std::find_if(options.begin(), options.end(),
                                     [&](const auto& o) { return o.first == change.first; });
      if (same == options.end())
        options.push_back(change);
      else
        *same = change;
    }
    std::vector<std::string> words = {"figure.png"};
    for (const auto& [option, value] : options) {
      if (option.empty()) continue;
      words.push_back(option);
      if (!value.empty()) words.push_back(value);
    }
    return words;
  }

  /// A slot for the measured curve, its columns the other way round and in other units.
  static std::string slot() {
    return R"({"format": "mpmvv-curve/1", "id": "measured", "title": "Pressure below the footing, measured", "status": "missing",
      "source": {"citation": "Kiriyama15", "doi": null, "place": "Figure 3"}, "origin": "digitised",
      "columns": [
        {"name": "pressure", "unit": "Pa", "meaning": "mean pressure", "digitisation": "not stated", "experimental": "5 %"},
        {"name": "settlement", "unit": "m", "meaning": "settlement of the footing", "digitisation": "not stated", "experimental": "not stated"}],
      "abscissa": "settlement", "licence": "the publisher's", "used_for_calibration": true, "notes": ["Dense sand."]})";
  }

 private:
  tests::ScratchDirectory scratch_;
  fs::path former_directory_;
};

TEST_F(DigitiseCommandTest, WritesACurveFileThatCanBeRead) {
  const Answer answer = ask(line());
  ASSERT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.out.find("line: 100 points, settlement ± "), std::string::npos) << answer.out;
  const CurveFile curve = read_curve_file("line.json");
  EXPECT_EQ(curve.citation, "Kiriyama15");
  EXPECT_EQ(curve.place, "Figure 3");
  EXPECT_EQ(curve.origin, "digitised");
  EXPECT_EQ(curve.licence, "fill in");
  EXPECT_FALSE(curve.missing);
  EXPECT_EQ(curve.abscissa, 0U);
  ASSERT_EQ(curve.rows.size(), 100U);
  for (const std::vector<double>& row : curve.rows)
    EXPECT_NEAR(row[1], 2000.0 + 200e3 * row[0], 10.0) << "in Pa over m";
  for (const CurveColumn& column : curve.columns) {
    EXPECT_EQ(column.digitisation.kind, StatedUncertainty::Kind::absolute);
    EXPECT_EQ(column.experimental.kind, StatedUncertainty::Kind::not_stated);
  }
  EXPECT_NEAR(curve.columns[0].digitisation.value, 0.6 * 0.1e-3, 0.3 * 0.1e-3) << "about half a pixel";
  const std::string text = text_in("line.json");
  for (const char* part :
       {"figure.png (400 x 300 px, hash ", "settlement: linear, 0 mm at 20, 290 px and 35 mm at 370, 290 px",
        "#d62728", "mpmvv "})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in " << text;
}

TEST_F(DigitiseCommandTest, FillsASlotAndKeepsWhatItSays) {
  write("measured.json", slot());
  const Answer answer = ask(line({{"--series", "measured=#1F77B4:markers"}, {"--citation", "Kiriyama15"}}));
  ASSERT_EQ(answer.code, 0) << answer.err;
  const CurveFile curve = read_curve_file("measured.json");
  EXPECT_FALSE(curve.missing);
  EXPECT_EQ(curve.title, "Pressure below the footing, measured");
  EXPECT_EQ(curve.licence, "the publisher's");
  EXPECT_TRUE(curve.used_for_calibration);
  ASSERT_EQ(curve.columns.size(), 2U);
  EXPECT_EQ(curve.columns[0].name, "pressure");
  EXPECT_EQ(curve.columns[0].unit, "kPa") << "that of the figure's axis";
  EXPECT_EQ(curve.columns[0].meaning, "mean pressure");
  EXPECT_EQ(curve.columns[0].experimental.value, 0.05);
  EXPECT_EQ(curve.abscissa, 1U);
  EXPECT_EQ(curve.notes.front(), "Dense sand.");
  EXPECT_GT(curve.notes.size(), 3U);
  ASSERT_EQ(curve.rows.size(), 4U);
  EXPECT_NEAR(curve.rows[1][0], 11.5e3, 10.0);
  EXPECT_NEAR(curve.rows[1][1], 10e-3, 0.01e-3);
}

TEST_F(DigitiseCommandTest, TheAbscissaMayStandUpright) {
  const Answer answer = ask(line({{"--abscissa", "pressure"}}));
  ASSERT_EQ(answer.code, 0) << answer.err;
  const CurveFile curve = read_curve_file("line.json");
  EXPECT_EQ(curve.columns[0].name, "settlement");
  EXPECT_EQ(curve.abscissa, 1U);
  // 0.4 px: across a gentle line, an end that is cut upright is not quite in the middle.
  for (const std::vector<double>& row : curve.rows) EXPECT_NEAR(row[1], 2000.0 + 200e3 * row[0], 20.0);
}

TEST_F(DigitiseCommandTest, LogarithmicAxesHaveRelativeUncertainties) {
  ASSERT_EQ(ask(line({{"--y", "error 1 log"}, {"--y-point", "20,290=0.01"}})).code, 0);
  const CurveColumn column = read_curve_file("line.json").columns[1];
  EXPECT_EQ(column.dimension, "ratio");
  EXPECT_EQ(column.digitisation.kind, StatedUncertainty::Kind::relative);
  EXPECT_NEAR(column.digitisation.value, 0.6 * std::log(1400.0) / 280.0, 0.005);
}

TEST_F(DigitiseCommandTest, NumbersAreReplacedOnlyByForce) {
  ASSERT_EQ(ask(line()).code, 0);
  const std::string before = text_in("line.json");
  const Answer refused = ask(line({{"--points", "20"}}));
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
  EXPECT_EQ(text_in("line.json"), before);
  ASSERT_EQ(ask(line({{"--points", "20"}, {"--force", ""}})).code, 0);
  EXPECT_EQ(read_curve_file("line.json").rows.size(), 20U);
  EXPECT_EQ(read_curve_file("line.json").notes.size(), 5U)
      << "notes on the numbers that were replaced are gone";
}

TEST_F(DigitiseCommandTest, ManySeriesManyFilesOrNone) {
  std::vector<std::string> words = line({{"--out", "there"}});
  words.insert(words.end(), {"--series", "markers=#1f77b4:markers", "--preview", "seen.png"});
  const Answer answer = ask(words);
  ASSERT_EQ(answer.code, 0) << answer.err;
  EXPECT_EQ(read_curve_file("there/markers.json").rows.size(), 4U);
  EXPECT_EQ(read_curve_file("there/line.json").rows.size(), 100U);
  EXPECT_EQ(read_png("seen.png").width, 400);
  fs::remove_all("there");
  words.insert(words.end(), {"--series", "green=#00aa00"});
  EXPECT_EQ(ask(words).code, 2);
  EXPECT_FALSE(fs::exists("there"));
}

TEST_F(DigitiseCommandTest, WhatIsWrongIsToldInOneLine) {
  write("broken.png", "not a picture");
  write("measured.json", slot());
  write("other.json", "{}");
  using Changes = std::vector<std::pair<std::string, std::string>>;
  const std::vector<std::pair<Changes, std::string>> faults = {
      {{{"--x", "settlement furlong"}}, "--x: expected a unit such as mm"},
      {{{"--x", "settlement"}}, "--x: expected name, unit"},
      {{{"--y", "settlement kPa"}}, "--y: expected another name"},
      {{{"--x-point", "20,290"}}, "--x-point: expected a pixel and its value"},
      {{{"--x-point", "20,zero=0"}}, "--x-point: expected a number, found \"zero\""},
      {{{"--x-point", "370,290=35"}}, "axis settlement: both points have the value 35"},
      {{{"--x-point", "20,-9=1"}}, "axis settlement: the point 20, -9 px lies outside"},
      {{{"--y-point", "350,290=3"}}, "bad calibration"},
      {{{"--y", "pressure kPa log"}}, "positive values, found 0"},
      {{{"--series", "line=red"}}, "--series: expected a name, a colour"},
      {{{"--series", "line=#00aa00"}}, "no ink of the colour #00aa00 there; the nearest colours are "},
      {{{"--area", "9,9,3,3"}}, "--area: expected left < right"},
      {{{"--abscissa", "time"}}, "--abscissa: expected settlement or pressure"},
      {{{"--out", "measured.json"}, {"--citation", "Terzaghi43"}}, "is one of Kiriyama15, not of Terzaghi43"},
      {{{"--out", "measured.json"}, {"--x", "settlement s"}},
       "column settlement is in m, the figure's axis in s"},
      {{{"--out", "measured.json"}, {"--y", "load kPa"}}, "has the columns pressure, settlement"},
      {{{"--out", "measured.json"}, {"--abscissa", "pressure"}}, "its abscissa is settlement, not pressure"},
      {{{"--out", "other.json"}}, "other.json"},
  };
  for (const auto& [changes, expected] : faults) {
    const Answer answer = ask(line(changes));
    EXPECT_EQ(answer.code, 2) << expected;
    EXPECT_NE(answer.err.find(expected), std::string::npos) << expected << " in " << answer.err;
    EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
    EXPECT_TRUE(answer.out.empty()) << answer.out;
  }
  std::vector<std::string> nameless = line();
  nameless.resize(nameless.size() - 2);
  EXPECT_NE(ask(nameless).err.find("--citation and --place"), std::string::npos);
  std::vector<std::string> broken = line();
  broken[0] = "broken.png";
  EXPECT_NE(ask(broken).err.find("broken.png: not a PNG"), std::string::npos);
  EXPECT_EQ(text_in("measured.json"), slot());
  EXPECT_FALSE(fs::exists("line.json"));
}

TEST(UncertaintyText, HasTwoDigitsRoundedUp) {
  EXPECT_EQ(uncertainty_text(0.0341, AxisScale::linear, "mm"), "0.035 mm");
  EXPECT_EQ(uncertainty_text(0.03, AxisScale::linear, "mm"), "0.030 mm");
  EXPECT_EQ(uncertainty_text(123.4, AxisScale::linear, "Pa"), "130 Pa");
  EXPECT_EQ(uncertainty_text(0.01234, AxisScale::logarithmic, "mm"), "1.3 %");
}

}  // namespace
}  // namespace mpm::vv
