// vv/cases/README.md tells people how to write a case. What it shows has to run, and what it lists has to be
// all.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/scratch_directory.hpp"
#include "vv/advice.hpp"
#include "vv/case_file.hpp"
#include "vv/case_schema.hpp"
#include "vv/field_map.hpp"
#include "vv/gates.hpp"
#include "vv/measurement.hpp"
#include "vv/metamorphic.hpp"
#include "vv/norms.hpp"
#include "vv/record.hpp"
#include "vv/rounding_reader.hpp"

namespace mpm::vv {
namespace {

const std::filesystem::path root = MPMVV_ROOT;

const std::string& page() {
  static const std::string text = [] {
    std::ifstream stream(root / "vv" / "cases" / "README.md", std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  }();
  return text;
}

/// What stands between the first `begin` after `from` and the `end` that follows; empty without them.
std::string between(const std::string& text, std::size_t from, const std::string& begin,
                    const std::string& end) {
  const std::size_t start = text.find(begin, from);
  if (start == std::string::npos) return "";
  const std::size_t stop = text.find(end, start + begin.size());
  return stop == std::string::npos ? "" : text.substr(start + begin.size(), stop - start - begin.size());
}

/// The block of JSON that follows the comment `<!-- mark -->`.
std::string marked_block(const std::string& mark) {
  const std::string comment = "<!-- " + mark + " -->\n";
  const std::size_t at = page().find(comment);
  if (at == std::string::npos || !page().substr(at + comment.size()).starts_with("```json\n")) return "";
  return between(page(), at, "```json\n", "```");
}

std::string example() { return marked_block("example: two_layers"); }

/// The text below a heading, up to the next one of any level.
std::string section(const std::string& heading) {
  const std::string line = "\n### " + heading + "\n";
  const std::size_t at = page().find(line);
  if (at == std::string::npos) return "";
  const std::size_t begin = at + line.size();
  return page().substr(begin, page().find("\n#", begin) - begin);
}

bool names(const std::string& text, const std::string& name) {
  return text.find("`" + name + "`") != std::string::npos;
}

/// Keys, and texts a key may have, of one object of the schema that a section does not name.
std::vector<std::string> unnamed(const Json& definition, const std::string& text) {
  std::vector<std::string> missing;
  const auto look_for = [&](const std::string& name) {
    if (!names(text, name)) missing.push_back(name);
  };
  for (const auto& [key, value] : definition.at("properties").items()) {
    look_for(key);
    for (const Json& holder : {value, value.value("items", Json::object())}) {
      for (const Json& choice : holder.value("enum", Json::array())) look_for(choice.get<std::string>());
    }
  }
  return missing;
}

const History& history_of(const Record& record, const std::string& id) {
  const auto found = std::find_if(record.histories.begin(), record.histories.end(),
                                  [&](const History& history) { return history.id == id; });
  if (found == record.histories.end()) throw std::runtime_error("no history of " + id);
  return *found;
}

TEST(VerificationOfDocumentation, ExampleRunsAndPassesItsGates) {
  ASSERT_FALSE(example().empty());
  const tests::ScratchDirectory scratch;
  const std::filesystem::path file = scratch.path() / "two_layers.json";
  std::ofstream(file, std::ios::binary) << example();
  const Case definition = read_case(file);
  ASSERT_EQ(definition.runs.size(), 2u);
  EXPECT_EQ(definition.runs.front().scene.bodies.size(), 2u);
  EXPECT_EQ(definition.runs.front().scene.rigid_bodies.size(), 1u);

  std::vector<Record> records;
  for (const RunRequest& run : definition.runs) records.push_back(simulate(definition, run));
  std::vector<double> loads;
  for (const Record& record : records) {
    const History& reaction = history_of(record, "reaction");
    ASSERT_GT(reaction.value.size(), 100u);
    for (std::size_t k = 0; k < reaction.value.size() && reaction.time[k] < 0.1; ++k) {
      EXPECT_NEAR(reaction.value[k], 0.0, 1e-6) << "the ground is not at rest before it is pressed";
    }
    EXPECT_GT(reaction.value.back(), 0.0) << "pressing down gives a reaction upwards";
    EXPECT_NEAR(history_of(record, "descent").value.back(), -0.05, 1e-4);
    EXPECT_EQ(record.snapshots.size(), 2u);
    loads.push_back(reaction.value.back());
  }
  EXPECT_GT(loads[1], loads[0]) << "the stronger clay carries less";

  const CaseVerdict verdict = judge_case(definition, std::move(records));
  EXPECT_EQ(verdict.status, CaseStatus::pass);
  const std::vector<const GateResult*> results = gate_results(verdict);
  EXPECT_EQ(results.size(), 8u);
  for (const GateResult* result : results)
    EXPECT_TRUE(result->good()) << result->id << ": " << result->detail;
}

TEST(Documentation, PartsOfTheExampleAreThoseOfTheWhole) {
  const Json whole = Json::parse(example());
  const std::string begin = "<!-- part of two_layers: ";
  int parts = 0;
  for (std::size_t at = page().find(begin); at != std::string::npos; at = page().find(begin, at + 1)) {
    const std::string pointer = between(page(), at, begin, " -->");
    const std::string block = marked_block("part of two_layers: " + pointer);
    ASSERT_FALSE(block.empty()) << pointer;
    EXPECT_EQ(Json::parse(block), whole.at(Json::json_pointer(pointer))) << pointer;
    ++parts;
  }
  EXPECT_GE(parts, 5);
}

TEST(Documentation, VariantsFitTheExample) {
  Json whole = Json::parse(example());
  whole.erase("figures");
  whole["sweep"] = Json::array({Json::parse(marked_block("axis for two_layers"))});
  const Case definition = parse_case(whole.dump(), "two_layers.json");
  ASSERT_EQ(definition.runs.size(), 3u);
  EXPECT_EQ(scope_of(definition.runs[1].parameters), "half the speed");
  EXPECT_EQ(definition.runs[1].scene.rigid_bodies[0].velocity[1], -0.05);
}

TEST(Documentation, ReadingsFitAFooting) {
  std::ifstream stream(root / "vv" / "cases" / "prandtl.json", std::ios::binary);
  Json footing = Json::parse(std::string(std::istreambuf_iterator<char>(stream), {}));
  footing["readings"] = Json::parse(marked_block("readings of a footing"));
  footing["gates"][0]["metric"] = "reading.pressure_25";
  const Case definition = parse_case(footing.dump(), "prandtl.json");
  EXPECT_EQ(definition.readings.at(0).at, 0.025);
  EXPECT_EQ(definition.readings.at(0).over, "limit_analysis");
}

TEST(Documentation, MeasurementsFitAFooting) {
  std::ifstream stream(root / "vv" / "cases" / "prandtl.json", std::ios::binary);
  Json footing = Json::parse(std::string(std::istreambuf_iterator<char>(stream), {}));
  footing["measurements"] = Json::parse(marked_block("measurements of a footing"));
  footing["gates"][0]["metric"] = "measured.experiment.inside";
  const Case definition = parse_case(footing.dump(), "prandtl.json");
  EXPECT_EQ(definition.measurements.at(0).curve, "pressure");
}

TEST(Documentation, TradesFitAFooting) {
  std::ifstream stream(root / "vv" / "cases" / "prandtl.json", std::ios::binary);
  Json footing = Json::parse(std::string(std::istreambuf_iterator<char>(stream), {}));
  for (const char* key : {"figures", "claims"}) footing.erase(key);
  footing["sweep"] = Json::parse(R"([{ "parameter": "/scene/grid/cell_size", "values": ["20 mm", "10 mm"] },
                                     { "parameter": "/scene/scheme", "values": ["cpgimp", "ugimp"] }])");
  footing["trades"] = Json::parse(marked_block("trades of a footing"));
  Json gate = footing["gates"][0];
  gate["metric"] = "trade.1.bound";
  gate.erase("where");
  Json ending = gate;
  ending.update({{"id", "ends"}, {"metric", "completed"}});
  footing["gates"] = {gate, ending};
  const Case definition = parse_case(footing.dump(), "prandtl.json");
  EXPECT_EQ(definition.trades.at(0).curve, "pressure");
}

TEST(Documentation, CurveFileIsOne) {
  const CurveFile curve = parse_curve_file(marked_block("curve file"), "plate_load.json");
  EXPECT_EQ(curve.rows.size(), 4u);
  for (const ComparisonMetric& metric : comparison_metrics()) EXPECT_TRUE(names(page(), metric.name)) << metric.name;
}

TEST(Documentation, QuotesTheMessageOfABadValue) {
  std::string text = example();
  const std::string good = "\"cohesion\": \"10 kPa\"";
  ASSERT_NE(text.find(good), std::string::npos);
  text.replace(text.find(good), good.size(), "\"cohesion\": \"10\"");
  const std::string quoted = between(page(), page().find("<!-- message -->"), "-->\n    ", "\n");
  try {
    parse_case(text, "two_layers.json");
    ADD_FAILURE() << "a cohesion without a unit was accepted";
  } catch (const CaseError& error) {
    EXPECT_EQ(quoted, error.what());
  }
}

/// Each object of a case has a section under its title that names all its keys, and the words they may be.
TEST(Documentation, NamesEveryKeyOfTheSchema) {
  const Json schema = Json::parse(case_schema());
  EXPECT_EQ(unnamed(schema, section("Case") + section("Metamorphoses")), std::vector<std::string>{});
  int objects = 0;
  for (const auto& [name, definition] : schema.at("definitions").items()) {
    if (!definition.contains("properties")) continue;
    const std::string title = definition.at("title");
    const std::string text = section(title);
    EXPECT_FALSE(text.empty()) << "no section \"" << title << "\"";
    EXPECT_EQ(unnamed(definition, text), std::vector<std::string>{}) << title;
    ++objects;
  }
  EXPECT_GE(objects, 20);
}

TEST(Documentation, NamesEveryMetricReferenceFieldAndMetamorphosis) {
  for (const Metric& metric : metric_catalogue()) EXPECT_TRUE(names(page(), metric.name)) << metric.name;
  for (const Metric& metric : advice_catalogue()) EXPECT_TRUE(names(page(), metric.name)) << metric.name;
  for (const std::string& metric : rounding_metric_names(RoundingRequest()))
    EXPECT_TRUE(names(section("Rounding"), metric)) << metric;
  for (const std::string& reference : reference_catalogue())
    EXPECT_TRUE(names(page(), reference)) << reference;
  for (const FieldQuantity& field : field_catalogue())
    EXPECT_TRUE(names(section("Figure"), field.name)) << field.name;
  for (const Metamorphosis& metamorphosis : metamorphosis_catalogue())
    EXPECT_TRUE(names(section("Metamorphoses"), metamorphosis.name)) << metamorphosis.name;
  for (const Ending ending : {Ending::reached_time, Ending::at_rest, Ending::not_at_rest,
                              Ending::reached_displacement, Ending::not_reached, Ending::not_finite, Ending::inverted, Ending::outside_grid, Ending::gained_energy, Ending::domain_too_large})
    EXPECT_TRUE(names(page(), name_of(ending))) << name_of(ending);
}

}  // namespace
}  // namespace mpm::vv
