// Other descriptions of a scene as part of a case: read, run, recorded and judged.

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <initializer_list>
#include <string>

#include "vv/case_file.hpp"
#include "vv/case_schema.hpp"
#include "vv/metamorphic.hpp"
#include "vv/norms.hpp"
#include "vv/record.hpp"

namespace {

using namespace mpm;
using namespace mpm::vv;

/// An elastic block that slumps on a fixed base.
Json slump() {
  return Json::parse(R"({
    "id": "slump", "title": "Slump", "description": "A block slumps.",
    "metamorphoses": ["mirror_x", "binary_units"],
    "scene": {
      "dimension": 2, "scheme": "cpgimp",
      "grid": {"cell_size": "0.1 m", "lower": ["0 m", "0 m"], "upper": ["0.8 m", "0.6 m"],
               "edges": {"x_lower": "roller", "x_upper": "free", "y_lower": "fixed", "y_upper": "free"}},
      "bodies": [{"name": "block", "lower": ["0 m", "0 m"], "upper": ["0.4 m", "0.4 m"],
                  "particles_per_cell": [2, 2], "density": "1000 kg/m^3",
                  "material": {"law": "linear_elastic", "youngs_modulus": "1 MPa", "poissons_ratio": 0.3}}],
      "gravity": {"acceleration": ["0 m/s^2", "-9.8 m/s^2"], "level": 1, "loading": {"type": "step"}},
      "time_step": {"stable_fraction": 0.2},
      "termination": {"type": "at_time", "time": "0.05 s"}
    },
    "sweep": [{"parameter": "/scene/scheme", "values": ["mpm", "cpgimp"]}],
    "references": [],
    "gates": [{"id": "mirror", "metric": "metamorphic.mirror_x", "at_most": 1e-10, "basis": "theory", "reason": "Exact."}]
  })");
}

Case read(const Json& text) { return parse_case(text.dump(), "slump.json"); }

std::string refusal_of(const Json& text) {
  try {
    read(text);
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

std::uint64_t bits_of(double value) { return std::bit_cast<std::uint64_t>(value); }

TEST(MetamorphicCase, IsReadWithItsDescriptions) {
  EXPECT_FALSE(schema_violation(slump()));
  EXPECT_EQ(read(slump()).metamorphoses, (std::vector<std::string>{"mirror_x", "binary_units"}));
  Json plain = slump();
  plain.erase("metamorphoses");
  plain["gates"][0]["metric"] = "completed";
  EXPECT_TRUE(read(plain).metamorphoses.empty());
}

TEST(MetamorphicCase, IsRefusedWhereItIsWrong) {
  struct Wrong {
    const char *patch, *place, *expected;
  };
  for (const Wrong& wrong : std::initializer_list<Wrong>{
           {R"([{"op": "replace", "path": "/metamorphoses/1", "value": "upside_down"}])",
            "/metamorphoses/1: ", "binary_units"},
           {R"([{"op": "replace", "path": "/metamorphoses/1", "value": "mirror_x"}])",
            "/metamorphoses/1: ", "each name once"},
           {R"([{"op": "replace", "path": "/metamorphoses/1", "value": "shift"}])",
            "/metamorphoses/1: ", "a metamorphosis that the scene has"},
           {R"([{"op": "replace", "path": "/gates/0/metric", "value": "metamorphic.split"}])",
            "/gates/0/metric: ", "needs that name among metamorphoses"},
           {R"([{"op": "remove", "path": "/metamorphoses"}])",
            "/gates/0/metric: ", "needs that name among metamorphoses"},
           {R"([{"op": "replace", "path": "/gates/0/metric", "value": "metamorphic.upside_down"}])",
            "/gates/0/metric: ", "metamorphic.mirror_x"},
       }) {
    const std::string message = refusal_of(slump().patch(Json::parse(wrong.patch)));
    EXPECT_TRUE(message.starts_with(std::string("slump.json: ") + wrong.place)) << wrong.patch << "\n"
                                                                                << message;
    EXPECT_NE(message.find(wrong.expected), std::string::npos) << message;
  }
}

TEST(MetamorphicCase, IsRefusedForARunThatHasNoSuchDescription) {
  Json text = slump();
  text["metamorphoses"] = {"mirror_x", "swap_axes"};
  EXPECT_EQ(refusal_of(text), "");
  text["sweep"].push_back(Json::parse(R"({"parameter": "/scene/bodies/0/initial_stress", "values": [
    {"type": "uniform", "xx": "0 kPa", "yy": "0 kPa", "zz": "0 kPa", "xy": "0 kPa"},
    {"type": "geostatic", "surface": "0.4 m", "k0": 0.5}]})"));
  text["scene"]["bodies"][0]["initial_stress"] = text["sweep"][1]["values"][0];
  const std::string message = refusal_of(text);
  EXPECT_TRUE(message.starts_with("slump.json: /metamorphoses/1: ")) << message;
  EXPECT_NE(message.find("level ground"), std::string::npos) << message;
}

TEST(MetamorphicCase, IsOfAScene) {
  Json text = Json::parse(R"({
    "id": "soil", "title": "Soil", "description": "A soil.",
    "element": {
      "material": {"law": "mohr_coulomb", "youngs_modulus": "20 MPa", "poissons_ratio": 0.3,
                   "friction_angle": "30 deg", "cohesion": "5 kPa", "dilation_angle": "10 deg"},
      "path": {"type": "simple_shear", "pressure": "20 kPa", "strain": 0.01, "increments": 50}
    },
    "references": ["closed_form"],
    "gates": [{"id": "stress", "metric": "element.stress", "at_most": 1e-12, "basis": "theory", "reason": "Exact."}]
  })");
  EXPECT_EQ(refusal_of(text), "");
  text["metamorphoses"] = {"mirror_x"};
  EXPECT_TRUE(refusal_of(text).starts_with("slump.json: /metamorphoses: ")) << refusal_of(text);
  EXPECT_TRUE(schema_violation(text));
}

TEST(MetamorphicCase, MeasuresTheDifferenceOfEveryRun) {
  const Case definition = read(slump());
  for (const RunRequest& run : definition.runs) {
    const Record record = simulate(definition, run);
    ASSERT_TRUE(record.completed());
    ASSERT_EQ(record.measured.size(), 2u);
    // Round-off of a few hundred steps; not nothing, since a mirror rounds other sums.
    EXPECT_LT(record.measured.at("metamorphic.mirror_x"), 3e-11);
    EXPECT_GT(record.measured.at("metamorphic.mirror_x"), 0.0);
    EXPECT_EQ(record.measured.at("metamorphic.binary_units"), 0.0);
    const Judgement judgement = judge(definition, run, record);
    EXPECT_EQ(judgement.metrics.at("metamorphic.mirror_x"), record.measured.at("metamorphic.mirror_x"));
    const Record again = record_from_json(Json::parse(to_json(record).dump()));
    ASSERT_EQ(again.measured.size(), 2u);
    for (const auto& [name, value] : record.measured)
      EXPECT_EQ(bits_of(again.measured.at(name)), bits_of(value));
  }
}

TEST(MetamorphicCase, MeasuresNothingOfARunThatDidNotComplete) {
  Json text = slump();
  text["scene"]["termination"] = {{"type", "at_rest"},
                                  {"unbalanced_force_ratio", 1e-9},
                                  {"kinetic_energy_ratio", 1e-9},
                                  {"deadline", "0.01 s"}};
  const Case definition = read(text);
  const Record record = simulate(definition, definition.runs[1]);
  EXPECT_FALSE(record.completed());
  EXPECT_TRUE(record.measured.empty());
}

TEST(MetamorphicCase, LeavesTheRunItselfAsItIs) {
  Case definition = read(slump());
  const Record with = simulate(definition, definition.runs[1]);
  definition.metamorphoses.clear();
  const Record without = simulate(definition, definition.runs[1]);
  EXPECT_EQ(with.digest, without.digest);
  EXPECT_TRUE(without.measured.empty());
}

TEST(MetamorphicCase, IsAnotherInputWithAnotherList) {
  Case definition = read(slump());
  const RunRequest run = definition.runs[0];
  const std::string both = input_hash(definition, run);
  EXPECT_EQ(input_hash(definition, run), both);
  definition.metamorphoses.pop_back();
  const std::string one = input_hash(definition, run);
  definition.metamorphoses.clear();
  EXPECT_NE(one, both);
  EXPECT_NE(input_hash(definition, run), one);
  EXPECT_NE(input_hash(definition, run), both);
}

TEST(MetamorphicCatalogue, HasAMetricForEveryDescription) {
  for (const Metamorphosis& metamorphosis : metamorphosis_catalogue()) {
    int found = 0;
    for (const Metric& metric : metric_catalogue())
      found += metric.name == "metamorphic." + metamorphosis.name;
    EXPECT_EQ(found, 1) << metamorphosis.name;
  }
}

}  // namespace
