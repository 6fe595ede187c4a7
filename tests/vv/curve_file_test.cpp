#include "vv/curve_file.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/case_texts.hpp"
#include "vv/case_file.hpp"

namespace mpm::vv {
namespace {

/// A curve file that is right, but for a hash that `sealed` puts in.
Json plate_load() {
  return Json::parse(R"({
    "format": "mpmvv-curve/1",
    "id": "plate_load",
    "title": "A plate load test",
    "status": "present",
    "source": { "citation": "Site report 7", "doi": null, "place": "Figure 12", "by_way_of": "the print" },
    "origin": "digitised",
    "columns": [
      { "name": "settlement", "unit": "mm", "meaning": "of the plate", "digitisation": "0.1 mm", "experimental": "none" },
      { "name": "pressure", "unit": "kPa", "meaning": "load over area", "digitisation": "0.5 %", "experimental": "not stated" }
    ],
    "abscissa": "settlement",
    "rows": [[0, 0], [1.5, 40], [4, 75.5]],
    "licence": "ours",
    "used_for_calibration": true,
    "notes": ["A note."]
  })");
}

Json sealed(Json text) {
  if (text["status"] == "present") text["hash"] = hash_of_values(text);
  return text;
}

CurveFile read(const Json& text) { return parse_curve_file(text.dump(), "somewhere/plate_load.json"); }

std::string refusal_of(const Json& text) {
  try {
    read(text);
  } catch (const CaseError& error) {
    return error.what();
  }
  ADD_FAILURE() << "accepted: " << text.dump();
  return "";
}

TEST(CurveFile, IsReadInSiUnits) {
  const CurveFile curve = read(sealed(plate_load()));
  EXPECT_EQ(curve.id, "plate_load");
  EXPECT_FALSE(curve.missing);
  EXPECT_EQ(curve.doi, "");
  EXPECT_EQ(curve.by_way_of, "the print");
  EXPECT_TRUE(curve.used_for_calibration);
  ASSERT_EQ(curve.abscissa, std::optional<std::size_t>(0));
  EXPECT_EQ(curve.column(0), (std::vector<double>{0.0, 0.0015, 0.004}));
  EXPECT_EQ(curve.column(1), (std::vector<double>{0.0, 40e3, 75.5e3}));
  EXPECT_EQ(curve.columns[0].dimension, "length");
  EXPECT_EQ(curve.columns[1].dimension, "pressure");
  EXPECT_DOUBLE_EQ(curve.columns[0].digitisation.of(1e3), 1e-4);
  EXPECT_DOUBLE_EQ(curve.columns[1].digitisation.of(-40e3), 200.0);
  EXPECT_TRUE(curve.columns[0].experimental.stated());
  EXPECT_FALSE(curve.columns[1].experimental.stated());
  EXPECT_EQ(curve.columns[1].experimental.of(40e3), 0.0);
}

TEST(CurveFile, KnowsTheUnitsOfPapers) {
  for (const auto& [unit, dimension] :
       {std::pair("kN/m^3", "unit weight"), std::pair("kN/m^2", "pressure"), std::pair("deg", "angle"),
        std::pair("1", "ratio"), std::pair("s", "time")})
    EXPECT_EQ(dimension_of_unit(unit), dimension) << unit;
  EXPECT_EQ(dimension_of_unit("psi"), "");
  EXPECT_DOUBLE_EQ(si_of_unit("kN/m^3"), 1000.0);
  EXPECT_DOUBLE_EQ(si_of_unit("mm"), 0.001);
}

TEST(CurveFile, OfASlotHasNoNumbers) {
  Json slot = plate_load();
  slot["status"] = "missing";
  slot.erase("rows");
  const CurveFile curve = read(slot);
  EXPECT_TRUE(curve.missing);
  EXPECT_TRUE(curve.rows.empty());
  slot["rows"] = {{0, 0}, {1, 1}};
  EXPECT_NE(refusal_of(slot).find("/rows: expected no rows as long as the status is \"missing\""),
            std::string::npos);
}

TEST(CurveFile, HashIsOfTheNumbersAlone) {
  const Json text = plate_load();
  Json other = text;
  other["title"] = "Another title";
  other["source"]["doi"] = "10.1/2";
  other["columns"][0]["digitisation"] = "1 mm";
  other["rows"][0] = {0.0, 0.0};  // the same numbers
  EXPECT_EQ(hash_of_values(other), hash_of_values(text));
  for (const char* patch : {R"([{"op": "replace", "path": "/rows/1/1", "value": 40.1}])",
                            R"([{"op": "replace", "path": "/columns/1/unit", "value": "Pa"}])",
                            R"([{"op": "replace", "path": "/columns/1/name", "value": "load"}])",
                            R"([{"op": "add", "path": "/row_names", "value": ["a", "b", "c"]}])"})
    EXPECT_NE(hash_of_values(text.patch(Json::parse(patch))), hash_of_values(text)) << patch;
}

TEST(CurveFile, BrokenHashIsRefusedWithTheRightOne) {
  Json text = sealed(plate_load());
  text["rows"][2][1] = 75.6;
  const std::string message = refusal_of(text);
  EXPECT_NE(message.find("plate_load.json: /hash: expected \"" + hash_of_values(text) + "\""),
            std::string::npos)
      << message;
  EXPECT_NE(message.find("the numbers are not those that were checked in"), std::string::npos) << message;
}

struct Wrong {
  const char* patch;
  const char* pointer;
  const char* expected;
};

TEST(CurveFile, RefusesWhatIsWrongWithItsPlace) {
  const Wrong all[] = {
      {R"([{"op": "remove", "path": "/columns/1/unit"}])", "/columns/1/unit", "a text"},
      {R"([{"op": "replace", "path": "/columns/1/unit", "value": "psi"}])", "/columns/1/unit",
       "a unit such as"},
      {R"([{"op": "replace", "path": "/columns/1/name", "value": "settlement"}])", "/columns/1/name", ""},
      {R"([{"op": "replace", "path": "/columns/0/digitisation", "value": "0.1 kPa"}])",
       "/columns/0/digitisation", "a unit of a length"},
      {R"([{"op": "replace", "path": "/columns/0/digitisation", "value": "-0.1 mm"}])",
       "/columns/0/digitisation", "above zero"},
      {R"([{"op": "replace", "path": "/columns/0/digitisation", "value": "0.1"}])", "/columns/0/digitisation",
       ""},
      {R"([{"op": "replace", "path": "/columns/0/digitisation", "value": "0.1x mm"}])",
       "/columns/0/digitisation", ""},
      {R"([{"op": "remove", "path": "/columns/0/experimental"}])", "/columns/0/experimental", ""},
      {R"([{"op": "remove", "path": "/columns/0"}])", "/columns", "at least two columns"},
      {R"([{"op": "replace", "path": "/rows/1/0", "value": 5}])", "/rows/2", "settlement grows"},
      {R"([{"op": "replace", "path": "/rows/1/0", "value": 4}])", "/rows/2",
       "settlement of the row before again"},
      {R"([{"op": "replace", "path": "/rows/1", "value": [0, 0]}])", "/rows/1", "each row once"},
      {R"([{"op": "replace", "path": "/rows/1", "value": [1]}])", "/rows/1", "a row of 2 numbers"},
      {R"([{"op": "replace", "path": "/rows/1/1", "value": "40"}])", "/rows/1/1", "a number"},
      {R"([{"op": "replace", "path": "/rows", "value": [[0, 0]]}])", "/rows", "at least two rows"},
      {R"([{"op": "replace", "path": "/rows", "value": []}])", "/rows", ""},
      {R"([{"op": "replace", "path": "/abscissa", "value": "time"}])", "/abscissa", "settlement"},
      {R"([{"op": "replace", "path": "/origin", "value": "guessed"}])", "/origin", "digitised"},
      {R"([{"op": "replace", "path": "/status", "value": "there"}])", "/status", "present"},
      {R"([{"op": "replace", "path": "/format", "value": "mpmvv-curve/2"}])", "/format", "mpmvv-curve/1"},
      {R"([{"op": "replace", "path": "/id", "value": "other"}])", "/id", "the name of the file"},
      {R"([{"op": "remove", "path": "/source/doi"}])", "/source/doi", "a DOI, or null"},
      {R"([{"op": "remove", "path": "/source/citation"}])", "/source/citation", ""},
      {R"([{"op": "remove", "path": "/licence"}])", "/licence", ""},
      {R"([{"op": "remove", "path": "/used_for_calibration"}])", "/used_for_calibration", ""},
      {R"([{"op": "add", "path": "/row_names", "value": ["a", "b"]}])", "/row_names",
       "a name for each of the 3 rows"},
      {R"([{"op": "add", "path": "/row_names", "value": ["a", "b", "a"]}])", "/row_names/2",
       "each name once"},
      {R"([{"op": "add", "path": "/rowz", "value": []}])", "/rowz", ""},
  };
  for (const Wrong& wrong : all) {
    SCOPED_TRACE(wrong.patch);
    Json text = plate_load().patch(Json::parse(wrong.patch));
    try {
      text = sealed(text);
    } catch (const std::exception&) {
      text["hash"] = "0000000000000000";  // too broken to be sealed
    }
    const std::string message = refusal_of(text);
    EXPECT_NE(message.find(std::string("plate_load.json: ") + wrong.pointer + ": expected"),
              std::string::npos)
        << message;
    EXPECT_NE(message.find(wrong.expected), std::string::npos) << message;
  }
}

TEST(CurveFile, OfATableNeedsNoOrder) {
  Json text = plate_load();
  text.erase("abscissa");
  text["rows"] = {{4, 1}, {1, 2}, {4, 3}};
  text["row_names"] = {"a", "b", "c"};
  const CurveFile table = read(sealed(text));
  EXPECT_FALSE(table.abscissa.has_value());
  EXPECT_EQ(table.row_names[2], "c");
}

TEST(CurveFile, EveryShippedOneIsRightAndItsCitationIsInTheBibliography) {
  const std::filesystem::path directory = std::filesystem::path(MPMVV_ROOT) / "reference" / "curves";
  const std::string bibliography =
      test::text_of(std::filesystem::path(MPMVV_ROOT) / "reference" / "bibliography.md");
  int present = 0, slots = 0;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    SCOPED_TRACE(entry.path().string());
    ASSERT_EQ(entry.path().extension(), ".json");
    const CurveFile curve = read_curve_file(entry.path());
    EXPECT_NE(bibliography.find("| " + curve.citation + " |"), std::string::npos) << curve.citation;
    ++(curve.missing ? slots : present);
  }
  EXPECT_GE(present, 1);
  EXPECT_GE(slots, 0) << "a user may have filled them all";
}

TEST(CurveFile, ThatIsNotThereIsSaidSo) {
  try {
    read_curve_file("nowhere/plate_load.json");
    FAIL();
  } catch (const CaseError& error) {
    EXPECT_STREQ(error.what(), "nowhere/plate_load.json: /: expected a readable curve file, found none");
  }
}

}  // namespace
}  // namespace mpm::vv
