// From a curve file beside a case to the status of its gates.

#include "vv/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "tests/support/case_texts.hpp"
#include "tests/support/scratch_directory.hpp"
#include "vv/curves.hpp"
#include "vv/gates.hpp"

namespace mpm::vv {
namespace {

constexpr const char* cells = "/scene/grid/cell_size";

/// A footing in three sizes of cells; its pressure is 2 kPa at 10 mm, and h times 10 kPa/m too high
/// everywhere.
Json footing_case() {
  Json text = Json::parse(test::text_of(std::filesystem::path(MPMVV_ROOT) / "vv" / "cases" / "prandtl.json"));
  const Json scene = text["scene"];
  return Json{{"id", "footing"},
              {"title", "A footing"},
              {"description", "A footing."},
              {"scene", scene},
              {"sweep", {{{"parameter", cells}, {"values", {"40 mm", "20 mm", "10 mm"}}}}},
              {"references", Json::array()},
              {"probes", text["probes"]},
              {"measurements",
               {{{"id", "test"},
                 {"curve_file", "plate.json"},
                 {"curve", "pressure"},
                 {"where", {{cells, {"10 mm"}}}},
                 {"numerical", cells},
                 {"accuracy", 0.5},
                 {"reason", "Asked for."}}}},
              {"gates",
               {{{"id", "measured"},
                 {"metric", "measured.test.inside"},
                 {"where", {{cells, {"10 mm"}}}},
                 {"at_least", 0.95},
                 {"basis", "reference_uncertainty"},
                 {"reason", "Two sigma."}}}}};
}

Json plate(double factor) {
  Json text = Json::parse(R"({
    "format": "mpmvv-curve/1", "id": "plate", "title": "A plate", "status": "present",
    "source": { "citation": "Here", "doi": null, "place": "Figure 1" }, "origin": "table",
    "columns": [
      { "name": "settlement", "unit": "mm", "meaning": "s", "digitisation": "none", "experimental": "none" },
      { "name": "pressure", "unit": "kPa", "meaning": "p", "digitisation": "none", "experimental": "0.02 kPa" }
    ],
    "abscissa": "settlement", "licence": "ours", "used_for_calibration": false
  })");
  text["rows"] = Json::array();
  for (int k = 0; k <= 10; ++k) text["rows"].push_back({k, 0.2 * k * factor});
  text["hash"] = hash_of_values(text);
  return text;
}

Json slot() {
  Json text = plate(1.0);
  text["status"] = "missing";
  text.erase("rows");
  text.erase("hash");
  return text;
}

/// What a run of `footing_case` looks like once it is judged.
Judgement pressed(const Case&, const RunRequest& request, const Record&) {
  Judgement judgement;
  Curve curve;
  curve.name = "pressure";
  curve.source = "run";
  curve.x_name = "settlement";
  for (int k = 0; k <= 100; ++k) {
    curve.x.push_back(0.01 * k / 100);
    curve.y.push_back(2e5 * curve.x.back() + 1e4 * request.scene.cell_size);
  }
  judgement.curves.push_back(curve);
  judgement.metrics = {{"load_curve.bend_pressure", 3.0 * std::pow(request.scene.cell_size, 1.5)},
                       {"load_curve.deepest", request.scene.cell_size}};
  return judgement;
}

class FilledSlot : public testing::Test {
 protected:
  Case read(const Json& curve_file, const Json& text = footing_case()) {
    std::ofstream(scratch_.path() / "plate.json") << curve_file.dump();
    return parse_case(text.dump(), scratch_.path() / "footing.json");
  }
  CaseVerdict judged(const Json& curve_file, const Json& text = footing_case()) {
    return judge_case(read(curve_file, text), std::vector<Record>(3), pressed);
  }

 private:
  tests::ScratchDirectory scratch_;
};

GateResult named(const CaseVerdict& verdict, const std::string& id) {
  for (const GateResult* result : gate_results(verdict))
    if (result->id == id) return *result;
  ADD_FAILURE() << "no gate " << id;
  return {};
}

TEST_F(FilledSlot, WaitsWhileItIsEmpty) {
  const CaseVerdict verdict = judged(slot());
  const GateResult gate = named(verdict, "measured");
  EXPECT_EQ(gate.status, GateStatus::no_measurement);
  EXPECT_TRUE(std::isnan(gate.value));
  EXPECT_EQ(gate.detail, "no measurement: plate.json is an empty slot");
  EXPECT_EQ(verdict.status, CaseStatus::pass) << "an empty slot fails nothing";
  CampaignVerdict campaign;
  campaign.cases = {verdict};
  EXPECT_EQ(campaign.counts().gates_waiting, 1);
  EXPECT_EQ(campaign.counts().gates_passed, campaign.counts().gates - 1) << "and is not counted as passed";
  EXPECT_EQ(to_json(campaign)["cases"][0]["runs"][2]["gates"][0]["status"], "no_measurement");
  EXPECT_TRUE(to_json(campaign)["cases"][0]["runs"][2]["gates"][0]["pass"].is_null());
}

TEST_F(FilledSlot, TurnsTheGateOnByItself) {
  // The finest run is 0.1 kPa off, first order: u_num is half of 1.25 * 0.1 kPa, and 2 u_val 0.131 kPa.
  const CaseVerdict verdict = judged(plate(1.0));
  EXPECT_EQ(named(verdict, "measured").status, GateStatus::pass);
  const CurveComparison& found = verdict.runs[2].comparisons.at(0);
  EXPECT_EQ(found.agreement, Agreement::validated);
  for (const double u : found.u_validation) EXPECT_NEAR(u, std::hypot(62.5, 20.0), 1e-6);
  EXPECT_TRUE(verdict.runs[0].comparisons.empty()) << "not among those selected";
  EXPECT_NEAR(verdict.runs[2].metrics.at("measured.test.bias"), 0.05, 1e-9);
}

TEST_F(FilledSlot, TurnsTheGateRedWhereTheModelIsOff) {
  const CaseVerdict verdict = judged(plate(0.8));
  EXPECT_EQ(named(verdict, "measured").status, GateStatus::fail);
  EXPECT_EQ(verdict.runs[2].comparisons.at(0).agreement, Agreement::model_error);
  EXPECT_EQ(verdict.status, CaseStatus::fail);
}

TEST_F(FilledSlot, OfADifferentLengthIsRedAndSaysWhy) {
  Json longer = plate(1.0);
  longer["rows"].push_back({20, 4.0});
  longer["hash"] = hash_of_values(longer);
  const GateResult gate = named(judged(longer), "measured");
  EXPECT_EQ(gate.status, GateStatus::fail);
  EXPECT_EQ(gate.detail,
            "the run completed but the run's curve covers 50 % of the measured one, 95 % are needed");
}

TEST_F(FilledSlot, ThatIsCorruptStopsTheCase) {
  Json corrupt = plate(1.0);
  corrupt["rows"][3][1] = 0.7;
  try {
    read(corrupt);
    FAIL() << "a number that nobody checked in was accepted";
  } catch (const CaseError& error) {
    EXPECT_NE(std::string(error.what()).find("plate.json: /hash: expected"), std::string::npos)
        << error.what();
  }
}

TEST_F(FilledSlot, OfOtherQuantitiesIsRefused) {
  Json strain = plate(1.0);
  strain["columns"][1]["unit"] = "mm";
  strain["columns"][1]["experimental"] = "none";
  strain["hash"] = hash_of_values(strain);
  try {
    read(strain);
    FAIL();
  } catch (const CaseError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("footing.json: /measurements/0/curve_file: expected the curve file of a pressure "
                        "over a length, "
                        "as the runs' pressure is, found \"plate.json\", which has a length over a length"),
              std::string::npos)
        << error.what();
  }
}

// ---- pairs

Json pairs_case(const char* names) {
  Json text = footing_case();
  text.erase("measurements");
  text["sweep"] = Json::parse(names);
  text["pairs"] = Json::parse(R"([
    { "id": "runs", "title": "the runs", "curve_file": "plate.json", "column": "pressure",
      "metric": "load_curve.deepest", "across": "test" }])");
  text["gates"] = Json::parse(R"([
    { "id": "mean", "pairs": "runs", "statistic": "bias", "at_most": 1.2, "basis": "requirement", "reason": "r" },
    { "id": "width", "pairs": "runs", "statistic": "scatter", "at_most": 0.1, "basis": "requirement", "reason": "r" }])");
  return text;
}

constexpr const char* three_tests = R"([{ "name": "test", "variants": [
  { "name": "a", "set": { "/scene/grid/cell_size": "40 mm" } }, { "name": "b", "set": { "/scene/grid/cell_size": "20 mm" } },
  { "name": "c", "set": { "/scene/grid/cell_size": "10 mm" } }] }])";

Json table() {
  Json text = plate(1.0);
  text.erase("abscissa");
  text["row_names"] = {"c", "b", "a", "d"};
  text["rows"] = {{1, 1e-5}, {2, 2e-5}, {3, 2e-5}, {4, 1}};  // 0.01, 0.02 and 0.02 Pa
  text["hash"] = hash_of_values(text);
  return text;
}

TEST_F(FilledSlot, PairsRunsWithTheRowsTheyAreNamedAfter) {
  const CaseVerdict verdict = judged(table(), pairs_case(three_tests));
  ASSERT_EQ(verdict.pairs.size(), 1u);
  const PairsVerdict& pairs = verdict.pairs[0];
  EXPECT_EQ(pairs.lack, "");
  ASSERT_EQ(pairs.pairs.size(), 3u);
  EXPECT_EQ(pairs.pairs[0].name, "a");
  EXPECT_NEAR(pairs.pairs[0].measured, 0.02, 1e-15);
  EXPECT_NEAR(pairs.pairs[0].predicted, 0.04, 1e-15);
  EXPECT_NEAR(pairs.pairs[2].measured, 0.01, 1e-15);
  // Ratios 2, 1, 1.
  EXPECT_NEAR(named(verdict, "mean").value, std::cbrt(2.0), 1e-12);
  EXPECT_EQ(named(verdict, "mean").status, GateStatus::fail);
  EXPECT_NEAR(named(verdict, "width").value, std::log(2.0) / std::sqrt(3.0), 1e-12);
}

TEST_F(FilledSlot, PairsThatLackARunAreRed) {
  const Case definition = read(table(), pairs_case(three_tests));
  std::vector<Record> records(3);
  records[1].outcome = {.ending = Ending::outside_grid, .step = 7, .time = 0.5, .particle = 4, .value = 1.1};
  const Judge judge_run = [](const Case& of, const RunRequest& request, const Record& record) {
    return record.completed() ? pressed(of, request, record) : Judgement{};
  };
  const CaseVerdict verdict = judge_case(definition, records, judge_run);
  EXPECT_EQ(named(verdict, "mean").status, GateStatus::fail);
  EXPECT_NE(named(verdict, "mean").detail.find("b: run ended outside_grid"), std::string::npos)
      << named(verdict, "mean").detail;
}

TEST_F(FilledSlot, PairsNeedRowsOfTheSameNames) {
  Json text = pairs_case(three_tests);
  text["sweep"][0]["variants"][1]["name"] = "e";
  try {
    read(table(), text);
    FAIL();
  } catch (const CaseError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("/pairs/0/across: expected an axis whose values are names of rows of plate"),
              std::string::npos)
        << error.what();
  }
}

TEST(PairsOfAFormula, AreThoseOfEveryRow) {
  Case definition;
  definition.id = "formula";
  definition.runs.resize(1);
  auto file = std::make_shared<CurveFile>();
  const auto column = [](const char* name, const char* unit, const char* dimension) {
    return CurveColumn{name, unit, dimension, "", {}, {}};
  };
  file->columns = {column("width", "m", "length"), column("depth", "m", "length"),
                   column("unit_weight", "N/m^3", "unit weight"), column("friction_angle", "deg", "angle"),
                   column("capacity", "Pa", "pressure")};
  // Meyerhof at 30 degrees: Nq = 18.401, Ngamma = 17.401 tan 42 deg = 15.668.
  const double nq = std::exp(std::numbers::pi / std::sqrt(3.0)) * 3,
               ngamma = (nq - 1) * std::tan(0.733038285837618);
  for (const double depth : {0.0, 0.5, 1.0}) {
    const double exact = 16e3 * depth * nq + 0.5 * 16e3 * 2.0 * ngamma;
    file->rows.push_back({2.0, depth, 16e3, 30.0, exact / 1.25});
  }
  PairedPrediction meyerhof;
  meyerhof.id = "m";
  meyerhof.title = "Meyerhof";
  meyerhof.file = file;
  meyerhof.column = 4;
  meyerhof.formula = "meyerhof";
  definition.pairs = {meyerhof};
  const PairsVerdict pairs = judge_pairs([&] {
                               CaseVerdict verdict;
                               verdict.definition = definition;
                               verdict.runs.resize(1);
                               return verdict;
                             }())
                                 .at(0);
  ASSERT_EQ(pairs.lack, "");
  EXPECT_NEAR(pairs.factor.bias, 1.25, 1e-9);
  EXPECT_NEAR(pairs.factor.scatter, 0.0, 1e-9);
  EXPECT_EQ(pairs.pairs[1].name, "row 2");
}

// ---- power laws

TEST_F(FilledSlot, PowerLawsAreFittedInTheLogarithms) {
  Json text = footing_case();
  text.erase("measurements");
  text["gates"] = Json::parse(R"([
    { "id": "n", "metric": "load_curve.bend_pressure", "over": "load_curve.deepest", "statistic": "power_exponent",
      "across": "/scene/grid/cell_size", "at_most": 2, "basis": "theory", "reason": "r" },
    { "id": "c", "metric": "load_curve.bend_pressure", "over": "load_curve.deepest", "statistic": "power_coefficient",
      "across": "/scene/grid/cell_size", "at_most": 4, "basis": "theory", "reason": "r" }])");
  const CaseVerdict verdict = judged(slot(), text);
  EXPECT_NEAR(named(verdict, "n").value, 1.5, 1e-12);
  EXPECT_NEAR(named(verdict, "c").value, 3.0, 1e-9);
}

// ---- cuts

TEST(Cut, MeetsTheParticlesThatReachTheLine) {
  FieldMap field;
  field.x = {0.1, 0.3, 0.3, 0.5, 0.9};
  field.y = {1.0, 1.05, 0.95, 1.2, 1.0};
  field.half_x.assign(5, 0.1);
  field.half_y.assign(5, 0.1);
  field.value = {10.0, 30.0, 34.0, 99.0, 50.0};
  const auto curve =
      curve_along({.id = "level", .quantity = "speed", .snapshot = 0, .along = 0, .at = 1.0}, field);
  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->name, "level");
  EXPECT_EQ(curve->x, (std::vector<double>{0.1, 0.3, 0.9}));
  EXPECT_EQ(curve->y, (std::vector<double>{10.0, 32.0, 50.0})) << "two at one place count with their mean";
  const double at_ends[] = {110.0, 50.0, 30.0};  // slopes
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(curve->uncertainty[k], at_ends[k] * 0.1 / std::sqrt(3.0), 1e-12);
  const auto upright =
      curve_along({.id = "axis", .quantity = "speed", .snapshot = 0, .along = 1, .at = 0.3}, field);
  ASSERT_TRUE(upright);
  EXPECT_EQ(upright->x, (std::vector<double>{0.95, 1.05}));
  EXPECT_FALSE(curve_along({.id = "far", .quantity = "speed", .snapshot = 0, .along = 0, .at = 5.0}, field));
}

}  // namespace
}  // namespace mpm::vv
