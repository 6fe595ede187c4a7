#include "vv/classification.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "vv/gates.hpp"

namespace mpm::vv {
namespace {

/// A column that settles, with one knob each for what can become of it.
std::string text_of(const std::string& changes) {
  Json text = Json::parse(R"({
    "id": "column", "title": "A column", "description": "Settles.",
    "scene": {
      "dimension": 1, "scheme": "cpgimp", "damping": 0.8,
      "grid": { "cell_size": "0.1 m", "lower": ["0 m"], "upper": ["2 m"],
                "edges": { "x_lower": "fixed", "x_upper": "free" } },
      "bodies": [ { "name": "column", "lower": ["0 m"], "upper": ["1 m"], "particles_per_cell": [2],
                    "density": "1000 kg/m^3",
                    "material": { "law": "linear_elastic", "youngs_modulus": "10 MPa", "poissons_ratio": 0 } } ],
      "gravity": { "acceleration": ["-9.8 m/s^2"], "level": 1, "loading": { "type": "ramp", "duration": "0.2 s" } },
      "time_step": { "stable_fraction": 0.4 },
      "termination": { "type": "at_time", "time": "1 s" }
    },
    "references": ["hencky"],
    "probes": [ { "id": "top", "quantity": "displacement", "at": ["1 m"], "every": "10 ms" } ],
    "classification": { "probe": "top", "from": "0.6 s", "stress": true, "error": "hencky.settlement" },
    "gates": [ { "id": "sound", "metric": "class", "is": ["accurate"], "basis": "theory", "reason": "it settles",
                 "advice": "none needed" } ]
  })");
  text.merge_patch(Json::parse(changes));
  return text.dump();
}

CaseVerdict verdict_of(const std::string& changes) {
  const Case definition = parse_case(text_of(changes), "column.json");
  std::vector<Record> records;
  for (const RunRequest& run : definition.runs) records.push_back(simulate(definition, run));
  return judge_case(definition, std::move(records));
}

std::string refusal_of(const std::string& changes) {
  try {
    parse_case(text_of(changes), "column.json");
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

TEST(Classification, OfAColumnAtRestIsAccurate) {
  const CaseVerdict verdict = verdict_of("{}");
  ASSERT_EQ(verdict.runs[0].stability, StabilityClass::accurate);
  EXPECT_EQ(verdict.status, CaseStatus::pass);
  const GateResult& gate = verdict.runs[0].gates.at(0);
  EXPECT_EQ(gate.op, "is");
  EXPECT_EQ(gate.found, "accurate");
  EXPECT_EQ(gate.expected, "accurate");
  EXPECT_EQ(gate.advice, "none needed");
  EXPECT_EQ(verdict.runs[0].metrics.at("class"), 0.0);
  EXPECT_LT(verdict.runs[0].metrics.at("class.drift"), 0.01);
}

TEST(Classification, OfAColumnWithoutDampingIsOscillatingAndTurnsTheGateRed) {
  const CaseVerdict verdict = verdict_of(R"({"scene": {"damping": 0, "gravity": {"loading": {"duration": "0.1 s"}}}})");
  EXPECT_EQ(verdict.runs[0].stability, StabilityClass::oscillating);
  EXPECT_EQ(verdict.status, CaseStatus::fail);
  EXPECT_NE(verdict.runs[0].gates.at(0).detail.find("ringing"), std::string::npos);
}

TEST(Classification, OfAColumnThatIsStillLoadedIsDrifting) {
  const CaseVerdict verdict =
      verdict_of(R"({"scene": {"gravity": {"loading": {"duration": "5 s"}}}})");
  EXPECT_EQ(verdict.runs[0].stability, StabilityClass::drifting);
}

TEST(Classification, OfTheWrongSettlementIsInaccurate) {
  const CaseVerdict verdict = verdict_of(R"({"classification": {"limits": {"error": 1e-9}}})");
  EXPECT_EQ(verdict.runs[0].stability, StabilityClass::inaccurate);
  EXPECT_NE(verdict.runs[0].gates.at(0).detail.find("error"), std::string::npos);
}

TEST(Classification, OfTooLongStepsIsDivergedWithTheLastGoodState) {
  const CaseVerdict verdict = verdict_of(R"({"scene": {"damping": 0, "time_step": {"stable_fraction": 2.5}},
    "gates": [ { "id": "sound", "metric": "class", "is": ["diverged", "refused"], "basis": "theory", "reason": "too long" } ]})");
  const RunVerdict& run = verdict.runs[0];
  EXPECT_EQ(run.stability, StabilityClass::diverged);
  EXPECT_EQ(verdict.status, CaseStatus::pass) << "the gate covers how the run ends";
  EXPECT_EQ(run.gates.size(), 1u);
  EXPECT_NE(run.gates[0].detail.find("at step"), std::string::npos);
  ASSERT_TRUE(run.record.last_good);
  const Record read = record_from_json(to_json(run.record));
  ASSERT_TRUE(read.last_good);
  EXPECT_EQ(read.last_good->fields.position, run.record.last_good->fields.position);
  EXPECT_TRUE(read.last_good->moment.starts_with("last good state, step "));
  EXPECT_LE(read.last_good->time, run.record.end_time);
  // A smaller step goes on from there.
  Case sound = verdict.definition;
  sound.runs[0].scene.time_step = StableFraction{0.4};
  Simulation simulation(sound.runs[0].scene);
  simulation.set_particles(read.last_good->fields);
  while (simulation.advance()) {
  }
  EXPECT_TRUE(simulation.outcome().completed());
}

TEST(Classification, KeepsARefusedRunWithItsMessage) {
  const std::string sweep = R"({"refusals": true,
    "sweep": [ { "parameter": "/scene/damping", "values": [0.8, 1] } ],
    "gates": [ { "id": "sound", "metric": "class", "is": ["accurate"], "where": {"/scene/damping": [0.8]}, "basis": "theory", "reason": "it settles" },
               { "id": "refused", "metric": "class", "is": ["refused"], "where": {"/scene/damping": [1]}, "basis": "theory", "reason": "alpha below 1" } ]})";
  const CaseVerdict verdict = verdict_of(sweep);
  EXPECT_EQ(verdict.status, CaseStatus::pass);
  EXPECT_EQ(verdict.runs[1].stability, StabilityClass::refused);
  EXPECT_NE(verdict.runs[1].gates.at(0).detail.find("/scene/damping: expected"), std::string::npos);
  Json without = Json::parse(sweep);
  without["refusals"] = false;
  EXPECT_NE(refusal_of(without.dump()).find("/sweep/0/values/1"), std::string::npos);
}

TEST(Classification, WithoutEnoughSamplesIsNoneAndTurnsTheGateRed) {
  const CaseVerdict verdict = verdict_of(R"({"classification": {"from": "0.99 s"}})");
  EXPECT_FALSE(verdict.runs[0].stability);
  EXPECT_EQ(verdict.status, CaseStatus::fail);
  EXPECT_NE(verdict.runs[0].gates.at(0).detail.find("8 samples"), std::string::npos);
}

TEST(Classification, RefusesWhatDoesNotGoTogether) {
  EXPECT_NE(refusal_of(R"({"classification": null})").find("/gates/0/metric"), std::string::npos);
  EXPECT_NE(refusal_of(R"({"classification": {"probe": "bottom"}})").find("/classification/probe"), std::string::npos);
  EXPECT_NE(refusal_of(R"({"classification": {"probe": null}})").find("/classification/from"), std::string::npos);
  EXPECT_NE(refusal_of(R"({"classification": {"limits": {"drift": 0}}})").find("/classification/limits/drift"),
            std::string::npos);
  EXPECT_NE(refusal_of(R"({"classification": {"scale": "1 Pa"}})").find("/classification/scale"), std::string::npos);
  const auto gate = [](const std::string& keys) {
    return R"({"gates": [ { "id": "g", "basis": "theory", "reason": "r", )" + keys + "} ]}";
  };
  EXPECT_NE(refusal_of(gate(R"("metric": "class", "at_most": 1)")).find("/gates/0/metric"), std::string::npos);
  EXPECT_NE(refusal_of(gate(R"("metric": "completed", "is": ["accurate"])")).find("/gates/0/metric"),
            std::string::npos);
  EXPECT_NE(refusal_of(gate(R"("metric": "class", "is": ["good"])")).find("/gates/0/is/0"), std::string::npos);
  EXPECT_NE(refusal_of(gate(R"("metric": "class", "is": ["accurate"], "at_most": 1)")).find("/gates/0"),
            std::string::npos);
}

}  // namespace
}  // namespace mpm::vv
