// Element tests as cases: read, run, recorded and judged.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "vv/case_file.hpp"
#include "vv/case_schema.hpp"
#include "vv/gates.hpp"
#include "vv/norms.hpp"
#include "vv/record.hpp"

namespace {

using namespace mpm;
using namespace mpm::vv;

Json valid_case() {
  return Json::parse(R"({
    "id": "soil", "title": "Soil", "description": "A soil.",
    "element": {
      "material": {"law": "mohr_coulomb", "youngs_modulus": "20 MPa", "poissons_ratio": 0.3,
                   "friction_angle": "30 deg", "cohesion": "5 kPa", "dilation_angle": "10 deg"},
      "path": {"type": "simple_shear", "pressure": "20 kPa", "strain": 0.01, "increments": 50}
    },
    "sweep": [{"parameter": "/element/path", "values": [
      {"type": "simple_shear", "pressure": "20 kPa", "strain": 0.01, "increments": 50},
      {"type": "random_states", "pressure": "10 kPa", "states": 300, "seed": 3}]}],
    "references": ["closed_form"],
    "gates": [{"id": "stress", "metric": "element.stress", "at_most": 1e-12, "basis": "theory", "reason": "Exact."}],
    "figures": [{"id": "shear", "kind": "curves", "quantity": "stress_xy", "caption": "Shear.",
                 "references": ["closed_form"]}]
  })");
}

Case read(const Json& text) { return parse_case(text.dump(), "soil.json"); }

std::string refusal_of(const Json& text) {
  try {
    read(text);
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

Json patched(const std::string& patch) { return valid_case().patch(Json::parse(patch)); }

TEST(ElementCase, IsReadWithAllItSays) {
  const Case soil = read(valid_case());
  ASSERT_EQ(soil.runs.size(), 2u);
  ASSERT_TRUE(soil.runs[0].element);
  const ElementTest& shear = *soil.runs[0].element;
  EXPECT_EQ(shear.path, ElementPath::simple_shear);
  EXPECT_EQ(shear.precision, Precision::float64);
  EXPECT_DOUBLE_EQ(shear.pressure, 2e4);
  EXPECT_DOUBLE_EQ(shear.strain, 0.01);
  EXPECT_EQ(shear.increments, 50);
  EXPECT_DOUBLE_EQ(shear.material.youngs_modulus, 2e7);
  EXPECT_DOUBLE_EQ(shear.material.friction_angle, std::numbers::pi / 6);
  EXPECT_DOUBLE_EQ(shear.material.dilation_angle, std::numbers::pi / 18);
  EXPECT_DOUBLE_EQ(shear.material.cohesion, 5e3);
  EXPECT_EQ(soil.runs[1].element->path, ElementPath::random_states);
  EXPECT_EQ(soil.runs[1].element->states, 300);
  EXPECT_EQ(soil.runs[1].element->seed, 3u);
  EXPECT_EQ(soil.figures[0].quantity, "stress_xy");
  Json single = valid_case();
  single["element"]["precision"] = "float";
  EXPECT_EQ(read(single).runs[0].element->precision, Precision::float32);
}

TEST(ElementCase, IsReadOffItsCurves) {
  Json text = patched(R"([{"op": "add", "path": "/readings", "value": [
      {"id": "half_way", "title": "Half way", "curve": "stress_xy", "at": 0.005, "over": "closed_form"},
      {"id": "end", "title": "At the end", "curve": "stress_xx", "at": 0.01}]},
    {"op": "remove", "path": "/sweep"}])");
  const Case soil = read(text);
  EXPECT_EQ(soil.readings.at(0).at, 0.005);
  const CaseVerdict verdict = judge_case(soil, {simulate(soil, soil.runs[0])});
  EXPECT_NEAR(verdict.runs[0].metrics.at("reading.half_way"), 1.0, 1e-9);
  EXPECT_LT(verdict.runs[0].metrics.at("reading.end"), 0.0);
  text["readings"][0]["at"] = "5 mm";
  EXPECT_NE(refusal_of(text).find("/readings/0/at: expected a number, found"), std::string::npos);
}

TEST(ElementCase, IsRefusedWhereItIsWrong) {
  struct Wrong {
    const char *patch, *place, *expected;
  };
  for (const Wrong& wrong : std::vector<Wrong>{
           {R"([{"op": "add", "path": "/scene", "value": {}}])", "/: ", "either scene or element"},
           {R"([{"op": "remove", "path": "/element"}])", "/scene: ", "an object"},
           {R"([{"op": "add", "path": "/probes", "value": []}])", "/probes: ", "one of the keys"},
           {R"([{"op": "replace", "path": "/element/material/dilation_angle", "value": "40 deg"}])",
            "/element/material/dilation_angle: ", "to the friction angle"},
           {R"([{"op": "replace", "path": "/element/material",
                 "value": {"law": "linear_elastic", "youngs_modulus": "1 MPa", "poissons_ratio": 0}}])",
            "/element/material/law: ", "a law with element tests"},
           {R"([{"op": "replace", "path": "/element/path/strain", "value": 0}])",
            "/element/path/strain: ", "above zero"},
           {R"([{"op": "replace", "path": "/element/path/increments", "value": 0}])",
            "/element/path/increments: ", "one increment or more"},
           {R"([{"op": "add", "path": "/element/path/seed", "value": 1}])",
            "/element/path/seed: ", "one of the keys"},
           {R"([{"op": "replace", "path": "/sweep/0/values/1/states", "value": 0}])",
            "/sweep/0/values/1/states: ", "one state or more"},
           {R"([{"op": "replace", "path": "/sweep/0/parameter", "value": "/scene/scheme"}])",
            "/sweep/0/parameter: ", "a value the element test has"},
           {R"([{"op": "replace", "path": "/references/0", "value": "hencky"}])",
            "/references/0: ", "it needs a scene"},
           {R"([{"op": "replace", "path": "/gates/0/metric", "value": "cell_crossings"}])",
            "/gates/0/metric: ", "a metric of an element test"},
           {R"([{"op": "replace", "path": "/figures/0/quantity", "value": "pressure"}])",
            "/figures/0/quantity: ", "stress_xx"},
           {R"([{"op": "replace", "path": "/figures/0/kind", "value": "profiles"}])",
            "/figures/0/kind: ", "curves"},
       }) {
    const std::string message = refusal_of(patched(wrong.patch));
    EXPECT_TRUE(message.starts_with(std::string("soil.json: ") + wrong.place)) << wrong.patch << "\n"
                                                                               << message;
    EXPECT_NE(message.find(wrong.expected), std::string::npos) << message;
  }
}

TEST(ElementCase, IsRefusedByTheSchemaAloneWhereASchemaCanTell) {
  EXPECT_FALSE(schema_violation(valid_case()));
  for (const char* patch :
       {R"([{"op": "add", "path": "/scene", "value": {}}])", R"([{"op": "remove", "path": "/element"}])",
        R"([{"op": "add", "path": "/probes", "value": []}])",
        R"([{"op": "remove", "path": "/element/path/strain"}])",
        R"([{"op": "add", "path": "/element/path/states", "value": 1}])",
        R"([{"op": "replace", "path": "/element/path/increments", "value": 0}])"})
    EXPECT_TRUE(schema_violation(patched(patch))) << patch;
}

TEST(ElementCase, RefusesMetricsOfElementsInScenes) {
  const std::filesystem::path file = std::filesystem::path(MPMVV_ROOT) / "vv/cases/column_update_order.json";
  std::ifstream stream(file, std::ios::binary);
  Json column = Json::parse(std::string(std::istreambuf_iterator<char>(stream), {}));
  column["gates"][0]["metric"] = "element.excess";
  EXPECT_NE(refusal_of(column).find("a metric of a scene"), std::string::npos);
  column["gates"][0]["metric"] = "completed";
  column["references"].push_back("closed_form");
  EXPECT_NE(refusal_of(column).find("it needs an element test"), std::string::npos);
}

TEST(ElementCase, RunsIntoARecordThatKeepsEveryBit) {
  const Case soil = read(valid_case());
  for (const RunRequest& request : soil.runs) {
    const Record record = simulate(soil, request);
    EXPECT_TRUE(record.completed());
    EXPECT_EQ(record.cost.steps, request.element->path == ElementPath::random_states ? 300 : 50);
    EXPECT_EQ(record.input_hash, input_hash(soil, request));
    EXPECT_EQ(simulate(soil, request).digest, record.digest);
    const Record again = record_from_json(Json::parse(to_json(record).dump()));
    EXPECT_EQ(again.measured, record.measured);
    ASSERT_EQ(again.paths.size(), record.paths.size());
    for (std::size_t i = 0; i < record.paths.size(); ++i) {
      EXPECT_EQ(again.paths[i].id, record.paths[i].id);
      EXPECT_EQ(again.paths[i].strain, record.paths[i].strain);
      EXPECT_EQ(again.paths[i].value, record.paths[i].value);
    }
  }
  EXPECT_NE(input_hash(soil, soil.runs[0]), input_hash(soil, soil.runs[1]));
  EXPECT_THROW(simulate(soil, soil.runs[0], [](std::int64_t) { return false; }), Abandoned);
}

TEST(ElementCase, IsJudgedByItsRecordAlone) {
  const Case soil = read(valid_case());
  Record record = simulate(soil, soil.runs[0]);
  const Judgement judgement = judge(soil, soil.runs[0], record);
  EXPECT_LE(judgement.metrics.at("element.stress"), 1e-12);
  EXPECT_EQ(judgement.metrics.at("completed"), 1);
  EXPECT_EQ(judgement.metrics.at("non_finite_values"), 0);
  const auto curve = [&](const std::string& source) {
    const auto found = std::find_if(judgement.curves.begin(), judgement.curves.end(), [&](const Curve& c) {
      return c.name == "stress_xy" && c.source == source;
    });
    return found == judgement.curves.end() ? Curve{} : *found;
  };
  EXPECT_EQ(curve("run").x_name, "strain");
  EXPECT_EQ(curve("run").y.size(), 51u);
  EXPECT_NEAR(curve("closed_form").y.back(), 2e4 * 0.5 + 5e3 * std::sqrt(0.75), 1e-8);

  for (ElementCurve& path : record.paths)
    if (path.id == "stress_xy") path.value.back() *= 1.01;
  EXPECT_GT(judge(soil, soil.runs[0], record).metrics.at("element.stress"), 1e-3);
  record.paths[0].value[3] = std::nan("");
  const Judgement broken = judge(soil, soil.runs[0], record);
  EXPECT_EQ(broken.metrics.at("non_finite_values"), 1);
  EXPECT_EQ(broken.metrics.count("element.stress"), 0u) << "a gate on it turns red";
  for (const auto& [name, value] : judgement.metrics)
    EXPECT_TRUE(std::any_of(metric_catalogue().begin(), metric_catalogue().end(),
                            [&, metric = name](const Metric& m) { return m.name == metric; }))
        << name;
}

}  // namespace
