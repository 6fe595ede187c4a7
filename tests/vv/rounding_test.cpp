// What rounding does to an answer, beside what its cells do: on runs whose answers are made up, so that both
// are known.

#include "vv/rounding.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/case_texts.hpp"
#include "vv/gates.hpp"
#include "vv/verdict.hpp"

namespace mpm::vv {
namespace {

using namespace mpm::test;

/// A column or a block, its cells of three sizes, in double, in float, and in double with its particles in
/// another order.
Json text_of_case(int dimension) {
  Json text = valid_case();
  for (const char* key : {"claims", "figures", "probes", "references", "repeat_on_other_threads"})
    text.erase(key);
  text["references"] = Json::array();
  text["scene"]["dimension"] = dimension;
  text["scene"]["precision"] = "double";
  if (dimension == 2) {
    text["scene"]["grid"] =
        Json::parse(R"({ "cell_size": "0.1 m", "lower": ["0 m", "0 m"], "upper": ["0.4 m", "1.2 m"],
      "edges": { "x_lower": "roller", "x_upper": "roller", "y_lower": "fixed", "y_upper": "free" } })");
    text["scene"]["bodies"][0].update(
        {{"lower", {"0 m", "0 m"}}, {"upper", {"0.4 m", "0.4 m"}}, {"particles_per_cell", {2, 2}}});
    text["scene"]["gravity"]["acceleration"] = {"0 m/s^2", "-9.8 m/s^2"};
  }
  text["sweep"] = Json::parse(R"([
    { "parameter": "/scene/grid/cell_size", "values": ["0.1 m", "0.05 m", "0.025 m"] },
    { "name": "numbers", "variants": [ { "name": "double", "set": {} },
                                       { "name": "float", "set": { "/scene/precision": "float" } } ] }])");
  text["rounding"] =
      Json::parse(R"({ "baseline": { "numbers": ["double"] }, "cells": "/scene/grid/cell_size" })");
  text["gates"] =
      Json::parse(R"([{ "id": "enough", "metric": "rounding.share", "where": { "numbers": ["float"] },
                                    "at_most": 0.1, "basis": "requirement", "reason": "Asked." }])");
  return text;
}

/// What is set at every particle: a function of its place, of the cell size, and of the particle's number.
using Answer = std::function<double(double x, double y, double cell_size, bool in_float)>;

/// Where a particle starts, whatever float makes of it [m].
double place(double coordinate) { return std::round(coordinate * 1e5) * 1e-5; }

Record record_of(const RunRequest& request, const Answer& displacement, const Answer& stress) {
  const ParticleFields start = Simulation(request.scene).particles();
  const auto dimension = static_cast<std::size_t>(request.scene.dimension);
  const bool in_float = request.scene.precision == Precision::float32;
  Record record;
  record.outcome.ending = Ending::reached_time;
  for (std::size_t p = 0; p < start.mass.size(); ++p) {
    const double x = place(start.initial_position[p * dimension]);
    const double y = place(start.initial_position[p * dimension + dimension - 1]);
    record.profile.initial_position.push_back(y);
    record.profile.displacement.push_back(displacement(x, y, request.scene.cell_size, in_float));
    record.profile.stress.push_back(stress(x, y, request.scene.cell_size, in_float));
    record.profile.initial_volume.push_back(start.initial_volume[p]);
    for (auto* field :
         {&record.profile.position, &record.profile.volume, &record.profile.mass, &record.profile.half_size})
      field->push_back(1.0);
  }
  record.digest = in_float ? "f" : "d";
  return record;
}

std::vector<Record> records_of(const Case& definition, const Answer& displacement, const Answer& stress) {
  std::vector<Record> records;
  for (const RunRequest& run : definition.runs) records.push_back(record_of(run, displacement, stress));
  return records;
}

CaseVerdict judged(const Case& definition, std::vector<Record> records) {
  const Judge nothing_else = [](const Case&, const RunRequest&, const Record&) { return Judgement(); };
  return judge_case(definition, std::move(records), nothing_else);
}

/// An answer of one height, wrong by c h^p in proportion, and in float by another proportion.
Answer wrong_by(double c, double order, double rounding) {
  return [=](double x, double y, double cell_size, bool in_float) {
    const double exact = 1.0 + x + 2.0 * y;
    return exact * (1.0 + c * std::pow(cell_size, order)) * (in_float ? 1.0 + rounding : 1.0);
  };
}

TEST(Rounding, IsTheDistanceFromTheBaselineBesideTheErrorOfTheCells) {
  for (int dimension : {1, 2}) {
    const Case definition = parsed(text_of_case(dimension));
    const CaseVerdict verdict =
        judged(definition, records_of(definition, wrong_by(1.0, 2.0, 1e-5), wrong_by(2.0, 2.0, -1e-6)));
    ASSERT_EQ(verdict.rounding.size(), 3u);
    const double sizes[] = {0.1, 0.05, 0.025};
    for (std::size_t level = 0; level < 3; ++level) {
      const RoundingRow& row = verdict.rounding[level];
      EXPECT_EQ(row.lack, "");
      EXPECT_EQ(row.run, 2 * level + 1);
      EXPECT_EQ(row.baseline, 2 * level);
      EXPECT_FALSE(row.bits_equal);
      EXPECT_NEAR(row.displacement, 1e-5, 1e-9);
      EXPECT_NEAR(row.stress, 1e-6, 1e-10);
      EXPECT_NEAR(row.digits_of_displacement, 5.0, 1e-3);
      EXPECT_NEAR(row.digits_of_stress, 6.0, 1e-3);
      // The estimate is relative to the finer of two answers, and that is wrong itself.
      EXPECT_NEAR(row.cells_of_displacement, sizes[level] * sizes[level], 0.02 * sizes[level] * sizes[level]);
      EXPECT_NEAR(row.cells_of_stress, 2 * sizes[level] * sizes[level], 0.04 * sizes[level] * sizes[level]);
      EXPECT_DOUBLE_EQ(row.share, row.displacement / row.cells_of_displacement);
      EXPECT_TRUE(row.is_enough());
      const auto& metrics = verdict.runs[row.run].metrics;
      EXPECT_EQ(metrics.at("rounding.displacement"), row.displacement);
      EXPECT_EQ(metrics.at("rounding.stress"), row.stress);
      EXPECT_EQ(metrics.at("rounding.share"), row.share);
      EXPECT_EQ(verdict.runs[row.baseline].metrics.count("rounding.share"), 0u);
    }
    EXPECT_EQ(verdict.status, CaseStatus::pass);
  }
}

TEST(Rounding, IsTooMuchBeyondATenthOfTheErrorOfTheCells) {
  const Case definition = parsed(text_of_case(1));
  const CaseVerdict verdict =
      judged(definition, records_of(definition, wrong_by(1.0, 2.0, 1e-6), wrong_by(1.0, 2.0, 1e-4)));
  EXPECT_TRUE(verdict.rounding[0].is_enough());   // 1e-4 of 1e-2
  EXPECT_TRUE(verdict.rounding[1].is_enough());   // 1e-4 of 2.5e-3
  EXPECT_FALSE(verdict.rounding[2].is_enough());  // 1e-4 of 6.25e-4
  EXPECT_EQ(verdict.status, CaseStatus::fail);
}

TEST(Rounding, TakesTheOrderThatThreeSizesTellIfItIsLower) {
  const Case definition = parsed(text_of_case(1));
  const auto at_finest = [&](double order) {
    return judged(definition,
                  records_of(definition, wrong_by(0.01, order, 1e-8), wrong_by(0.01, order, 1e-8)))
        .rounding.back()
        .cells_of_stress;
  };
  EXPECT_NEAR(at_finest(1.5), 0.01 * std::pow(0.025, 1.5), 1e-3 * 0.01 * std::pow(0.025, 1.5));
  // Lower than the lowest, higher than the highest: the estimate is below the error it stands for.
  EXPECT_LT(at_finest(0.5), 0.6 * 0.01 * std::pow(0.025, 0.5));
  const double slow = 0.01 * (std::pow(0.05, 0.7) - std::pow(0.025, 0.7));
  EXPECT_NEAR(at_finest(0.7), slow, 1e-2 * slow);  // as if of order 1
  EXPECT_GT(at_finest(3.0), 0.01 * std::pow(0.025, 3.0));
  const double difference = 0.01 * (std::pow(0.05, 3.0) - std::pow(0.025, 3.0));
  EXPECT_NEAR(at_finest(3.0), difference / 3.0, 1e-3 * difference);
}

TEST(Rounding, TakesTheSmallerOfTheEstimatesByTwoNeighbours) {
  const Case definition = parsed(text_of_case(1));
  // Level by level 0, then all of the error at once.
  const Answer answer = [](double, double, double cell_size, bool) { return cell_size < 0.03 ? 1.0 : 1.01; };
  const CaseVerdict verdict = judged(definition, records_of(definition, answer, answer));
  EXPECT_NEAR(verdict.rounding[1].cells_of_stress, 0.0, 1e-14);
  EXPECT_NEAR(verdict.rounding[2].cells_of_stress, 0.01 / 3.0, 1e-12);
}

TEST(Rounding, ComparesParticlesThatStartInTheSamePlace) {
  for (int dimension : {1, 2}) {
    Json text = text_of_case(dimension);
    // The same block in another order: two bodies, the upper one first.
    const std::string middle = dimension == 1 ? "0.2 m" : "0.2 m";
    Json lower = text["scene"]["bodies"][0], upper = lower;
    lower["name"] = "lower";
    upper["name"] = "upper";
    lower["upper"].back() = middle;
    upper["lower"].back() = middle;
    text["scene"]["bodies"] = {lower, upper};
    const Case definition = parsed(text);
    std::vector<Record> records = records_of(definition, wrong_by(0.0, 2.0, 0.0), wrong_by(0.0, 2.0, 0.0));
    const CaseVerdict same = judged(definition, records);
    EXPECT_EQ(same.rounding[0].displacement, 0.0);
    EXPECT_EQ(same.rounding[0].digits_of_stress, 17.0);
    std::swap(records[1].profile.stress.front(), records[1].profile.stress.back());
    EXPECT_GT(judged(definition, records).rounding[0].stress, 1e-2);
  }
}

TEST(Rounding, MatchesParticlesInAnotherOrder) {
  for (int dimension : {1, 2}) {
    Json text = text_of_case(dimension);
    text["sweep"][1]["variants"][1] = {{"name", "float"},
                                       {"set", {{"/scene/particle_order", {{"shuffle", 7}}}}}};
    const Case definition = parsed(text);
    const CaseVerdict verdict =
        judged(definition, records_of(definition, wrong_by(1.0, 2.0, 0.0), wrong_by(1.0, 2.0, 0.0)));
    for (const RoundingRow& row : verdict.rounding) {
      EXPECT_EQ(row.displacement, 0.0);
      EXPECT_EQ(row.stress, 0.0);
      EXPECT_NE(verdict.runs[row.run].record.profile.stress,
                verdict.runs[row.baseline].record.profile.stress);
    }
  }
}

TEST(Rounding, WeighsByInitialVolume) {
  const Case definition = parsed(text_of_case(1));
  std::vector<Record> records = records_of(definition, wrong_by(0.0, 2.0, 0.0), wrong_by(0.0, 2.0, 0.0));
  for (double& stress : records[0].profile.stress) stress = 1.0;
  for (double& stress : records[1].profile.stress) stress = 1.0;
  records[1].profile.stress[0] = 2.0;
  const auto count = static_cast<double>(records[0].profile.stress.size());
  records[0].profile.initial_volume[0] *= 9.0;
  EXPECT_NEAR(judged(definition, records).rounding[0].stress, std::sqrt(9.0 / (count + 8.0)), 1e-12);
}

TEST(Rounding, SaysWhyThereAreNoNumbers) {
  const Case definition = parsed(text_of_case(1));
  const Answer good = wrong_by(1.0, 2.0, 1e-6);
  std::vector<Record> records = records_of(definition, good, good);
  records[1].outcome.ending = Ending::outside_grid;
  records[3].profile.stress.pop_back();
  records[3].profile.displacement.pop_back();
  CaseVerdict verdict = judged(definition, records);
  EXPECT_NE(verdict.rounding[0].lack.find("outside_grid"), std::string::npos) << verdict.rounding[0].lack;
  EXPECT_NE(verdict.rounding[1].lack.find("other particles"), std::string::npos) << verdict.rounding[1].lack;
  EXPECT_EQ(verdict.rounding[2].lack, "");
  EXPECT_EQ(verdict.runs[1].metrics.count("rounding.stress"), 0u);
  EXPECT_FALSE(verdict.rounding[0].is_enough());

  records = records_of(definition, good, good);
  records[0].outcome.ending =
      Ending::not_finite;  // a baseline: neither its run nor the error of the cells is told
  verdict = judged(definition, records);
  EXPECT_NE(verdict.rounding[0].lack.find("not_finite"), std::string::npos) << verdict.rounding[0].lack;
  EXPECT_EQ(verdict.rounding[1].lack, "");
  EXPECT_TRUE(std::isnan(verdict.rounding[1].share));
  EXPECT_FALSE(verdict.rounding[1].is_enough());
  EXPECT_EQ(verdict.runs[3].metrics.count("rounding.share"), 0u);

  const Answer none = [](double, double, double, bool) { return 0.0; };
  EXPECT_NE(judged(definition, records_of(definition, none, good)).rounding[0].lack.find("no displacement"),
            std::string::npos);
}

TEST(Rounding, KnowsEqualBits) {
  const Case definition = parsed(text_of_case(1));
  const Answer good = wrong_by(1.0, 2.0, 0.0);
  std::vector<Record> records = records_of(definition, good, good);
  records[1].digest = "d";
  const CaseVerdict verdict = judged(definition, records);
  EXPECT_TRUE(verdict.rounding[0].bits_equal);
  EXPECT_FALSE(verdict.rounding[1].bits_equal);
}

TEST(Rounding, GoesIntoTheResults) {
  const Case definition = parsed(text_of_case(1));
  CampaignVerdict campaign;
  campaign.cases.push_back(
      judged(definition, records_of(definition, wrong_by(1.0, 2.0, 1e-6), wrong_by(1.0, 2.0, 1e-6))));
  campaign.cases[0].runs[0].record.repeats = {{2, "d"}, {8, "e"}};
  const Json json = to_json(campaign)["cases"][0];
  ASSERT_EQ(json["rounding"].size(), 3u);
  EXPECT_EQ(json["rounding"][1]["run"], 3);
  EXPECT_EQ(json["rounding"][1]["share"], campaign.cases[0].rounding[1].share);
  EXPECT_EQ(json["rounding"][1]["enough"], true);
  EXPECT_EQ(json["runs"][0]["repeats"][1]["step_threads"], 8);
}

TEST(Rounding, ReadsWhatACaseAsksFor) {
  Json text = text_of_case(1);
  const Case read = parsed(text);
  ASSERT_TRUE(read.rounding);
  ASSERT_EQ(read.rounding->baseline.size(), 1u);
  EXPECT_EQ(read.rounding->baseline[0].parameter, "numbers");
  EXPECT_EQ(read.rounding->baseline[0].values, std::vector<Json>{"double"});
  EXPECT_EQ(read.rounding->cells, "/scene/grid/cell_size");
  text["rounding"].erase("cells");
  EXPECT_EQ(parsed(text).rounding->cells, "");
  text["repeat_on_threads"] = {2, 3, 8};
  text["gates"][0]["metric"] = "bits_differ";
  EXPECT_EQ(parsed(text).repeat_on_threads, (std::vector<int>{2, 3, 8}));
  EXPECT_TRUE(parsed(valid_case()).repeat_on_threads.empty());
  EXPECT_FALSE(parsed(valid_case()).rounding);
}

}  // namespace
}  // namespace mpm::vv
