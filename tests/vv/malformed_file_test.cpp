// Files and texts that cannot be read as a case.

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "tests/support/case_texts.hpp"
#include "vv/case_file.hpp"
#include "vv/case_schema.hpp"

namespace mpm::vv {
namespace {

using namespace mpm::test;

const std::filesystem::path root = MPMVV_ROOT;

struct MalformedFile {
  std::string name;
  std::string pointer;
  std::string expected;
  std::string found;
};

const std::vector<MalformedFile>& malformed_files() {
  static const std::vector<MalformedFile> all = {
      {"syntax_error.json", "line 13, column 13", "valid JSON", "unexpected string literal; expected '}'"},
      {"cut_short.json", "line 14, column 32", "valid JSON", "missing closing quote"},
      {"duplicate_key.json", "/scene/damping", "each key once", "it a second time"},
      {"unknown_key.json", "/scene/grid/cell_sise", "one of the keys cell_size, lower, upper, edges",
       "\"cell_sise\" (did you mean \"cell_size\"?)"},
      {"missing_gates.json", "/gates", "an array of at least one value", "nothing: the key is missing"},
      {"wrong_unit.json", "/scene/bodies/0/material/youngs_modulus", "a pressure such as", "\"10000 kN\""},
      {"unit_weight_for_density.json", "/scene/bodies/0/density", "a density such as",
       "\"9.8 kN/m^3\", a unit weight"},
      {"wrong_type.json", "/scene/gravity/level", "a number", "\"50G\""},
      {"negative_modulus.json", "/scene/bodies/0/material/youngs_modulus", "a modulus above zero",
       "-10000000 Pa"},
      {"incompressible.json", "/scene/bodies/0/material/poissons_ratio", "from 0 to below 0.5", "0.5"},
      {"body_outside_grid.json", "/scene/bodies/0/upper/0", "inside the grid, which ends at 1.04 m", "1.2 m"},
      {"empty_sweep.json", "/sweep", "an array of at least one value", "an empty array"},
      {"bad_swept_value.json", "/sweep/0/values/2", "a cell size above zero", "-0.01 m"},
      {"gate_on_nothing.json", "/gates/0/where/~1scene~1scheme/0", "swept over (\"mpm\", \"ugimp\")",
       "\"cpgimp\""},
      {"probe_hits_nothing.json", "/probes/0/at", "a place within one particle spacing",
       "\"1.04 m\", which hits none"},
  };
  return all;
}

TEST(MalformedFile, is_refused_in_one_line_that_names_place_expected_and_found) {
  for (const MalformedFile& malformed : malformed_files()) {
    const std::filesystem::path file = root / "tests/vv/malformed" / malformed.name;
    try {
      read_case(file);
      ADD_FAILURE() << malformed.name << " was read";
    } catch (const CaseError& error) {
      expect_message(error.what(), file.string(), malformed.pointer, malformed.expected, malformed.found);
    }
  }
}

TEST(MalformedFile, is_refused_by_the_schema_alone_where_a_schema_can_tell) {
  for (const char* name : {"unknown_key", "missing_gates", "wrong_unit", "unit_weight_for_density",
                           "wrong_type", "negative_modulus", "incompressible", "empty_sweep"}) {
    const std::filesystem::path file = root / "tests/vv/malformed" / (std::string(name) + ".json");
    EXPECT_TRUE(schema_violation(Json::parse(text_of(file)))) << name;
  }
}

TEST(MalformedFile, is_listed_here) {
  std::set<std::string> listed, present;
  for (const MalformedFile& malformed : malformed_files()) listed.insert(malformed.name);
  for (const auto& entry : std::filesystem::directory_iterator(root / "tests/vv/malformed")) {
    present.insert(entry.path().filename().string());
  }
  EXPECT_EQ(listed, present);
}

TEST(CaseText, that_is_no_json_is_refused_with_line_and_column) {
  expect_message(refusal_of(""), "column.json", "line 1, column 1", "valid JSON", "unexpected end of input");
  expect_message(refusal_of("{\n  \"id\": nul\n}"), "column.json", "line 2, column 12", "valid JSON",
                 "invalid literal");
  expect_message(refusal_of("{\"id\": 1e999}"), "column.json", "line 1, column 12", "valid JSON",
                 "number overflow");
  expect_message(refusal_of("{} {}"), "column.json", "line 1, column 4", "valid JSON", "unexpected '{'");
  expect_message(refusal_of("{\"id\": \"\xff\"}"), "column.json", "line 1, column 9", "valid JSON",
                 "ill-formed UTF-8");
}

TEST(CaseText, with_a_key_given_twice_is_refused_wherever_it_is) {
  expect_message(refusal_of(R"({"a": [0, {"b": 1, "c": {}, "b": 2}]})"), "column.json", "/a/1/b",
                 "each key once", "it a second time");
  expect_message(refusal_of(R"({"a": {"b": 1}, "a": 2})"), "column.json", "/a", "each key once",
                 "it a second time");
  EXPECT_EQ(refusal_of(R"({"a": [{"b": 1}, {"b": 2}], "c": {"a": 1}})").find("each key once"),
            std::string::npos);
}

TEST(CaseText, nested_too_deep_is_refused) {
  const std::string text = std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_NE(refusal_of(text).find("at most 50 levels of nesting"), std::string::npos);
}

TEST(CaseText, of_great_length_stays_short_in_messages) {
  Json text = valid_case();
  text["scene"]["scheme"] = std::string(5000, 'x');
  EXPECT_LT(refusal_of(text.dump()).size(), 250u);
}

TEST(CaseText, that_asks_for_too_many_runs_is_refused) {
  Json text = valid_case();
  Json levels = Json::array(), dampings = Json::array();
  for (int i = 0; i < 1000; ++i) {
    levels.push_back(i + 1);
    dampings.push_back(0.0009 * i);
  }
  text["sweep"] = Json::array({{{"parameter", "/scene/gravity/level"}, {"values", levels}},
                               {{"parameter", "/scene/damping"}, {"values", dampings}}});
  expect_message(refusal_of(text.dump()), "column.json", "/sweep", "at most 100000 runs", "an array of 2");
}

TEST(CaseFile, that_is_not_there_is_refused) {
  const std::filesystem::path absent = root / "vv/cases/absent.json";
  try {
    read_case(absent);
    FAIL();
  } catch (const CaseError& error) {
    expect_message(error.what(), absent.string(), "/", "a readable case file", "no file");
  }
  try {
    read_case(root / "vv");
    FAIL();
  } catch (const CaseError& error) {
    expect_message(error.what(), (root / "vv").string(), "/", "a readable case file",
                   "something that cannot be read");
  }
}

}  // namespace
}  // namespace mpm::vv
