// What a case may say of error against cost, and the one line that says what is wrong with it.

#include "vv/trade_reader.hpp"

#include <gtest/gtest.h>

#include "tests/support/case_texts.hpp"
#include "vv/case_schema.hpp"

namespace mpm::vv {
namespace {

using namespace mpm::test;

constexpr const char* cells = "/scene/grid/cell_size";
constexpr const char* scheme = "/scene/scheme";

Json metric_trade() {
  return Json::parse(
      R"({ "title": "stress", "metric": "hencky.stress.l2", "problems": ["/scene/gravity/level"],
                          "family": "/scene/scheme", "asked": [0.1, 0.01] })");
}

Json curve_trade() {
  return Json::parse(
      R"({ "title": "course of the top", "curve": "top", "from": "0 s", "up_to": "500 ms", "within": "10 ms",
                          "finest": [ { "/scene/scheme": ["mpm"], "/scene/grid/cell_size": ["0.025 m"] },
                                      { "/scene/scheme": ["cpgimp"], "/scene/grid/cell_size": ["0.025 m"] } ],
                          "problems": ["/scene/gravity/level"], "family": "/scene/scheme", "asked": [0.05] })");
}

/// Columns in three sizes of cells, two schemes, two levels of gravity: twelve runs, of which two are left
/// out.
Json traded_case() {
  Json text = valid_case();
  text["sweep"].push_back(Json::parse(R"({ "parameter": "/scene/gravity/level", "values": [1, 10] })"));
  text["trade_without"] =
      Json::parse(R"([{ "/scene/grid/cell_size": ["0.1 m"], "/scene/scheme": ["mpm"] }])");
  text["trades"] = {metric_trade(), curve_trade()};
  text["advice"] = {{"of", "another"}, {"asked", {0.01, 0.001}}};
  text["gates"].push_back(Json::parse(
      R"({ "id": "ends", "metric": "completed", "at_least": 1, "basis": "requirement", "reason": "Asked." })"));
  text["gates"].push_back(Json::parse(
      R"({ "id": "promise", "metric": "trade.2.bound", "at_most": 1, "basis": "fit", "reason": "Seen." })"));
  return text;
}

TEST(TradeReader, reads_the_trade_of_a_metric) {
  const Case read = parsed(traded_case());
  ASSERT_EQ(read.trades.size(), 2u);
  const TradeRequest& trade = read.trades[0];
  EXPECT_EQ(trade.title, "stress");
  EXPECT_EQ(trade.metric, "hencky.stress.l2");
  EXPECT_EQ(trade.curve, "");
  EXPECT_EQ(trade.problems, std::vector<std::string>{"/scene/gravity/level"});
  EXPECT_EQ(trade.family, scheme);
  EXPECT_EQ(trade.asked, (std::vector<double>{0.1, 0.01}));
  EXPECT_TRUE(trade.finest.empty());
}

TEST(TradeReader, asks_which_configurations_must_end_well) {
  Json text = traded_case();
  Json& gates = text["gates"];
  for (std::size_t k = gates.size(); k-- > 0;)
    if (gates[k]["metric"] == "completed") gates.erase(k);
  try {
    parsed(text);
    FAIL() << "nothing was refused";
  } catch (const CaseError& error) {
    EXPECT_NE(std::string(error.what()).find("/gates: expected a gate on completed"), std::string::npos) << error.what();
  }
}

TEST(TradeReader, reads_the_trade_of_a_history_over_time) {
  const TradeRequest trade = parsed(traded_case()).trades[1];
  EXPECT_EQ(trade.curve, "top");
  EXPECT_EQ(trade.metric, "");
  EXPECT_EQ(trade.from, 0.0);
  EXPECT_EQ(trade.up_to, 0.5);
  EXPECT_EQ(trade.within, 0.01);
  ASSERT_EQ(trade.finest.size(), 2u);
  EXPECT_EQ(trade.finest[1][0].parameter, scheme);
  EXPECT_EQ(trade.finest[1][0].values, std::vector<Json>{"cpgimp"});
}

TEST(TradeReader, reads_the_trade_of_a_load_curve_over_settlement) {
  Json text = Json::parse(text_of(std::filesystem::path(MPMVV_ROOT) / "vv" / "cases" / "prandtl.json"));
  text["sweep"] = Json::parse(R"([{ "parameter": "/scene/scheme", "values": ["ugimp", "cpgimp"] }])");
  for (const char* key : {"figures", "claims", "readings"}) text.erase(key);
  text["gates"] = two_bodies()["gates"];
  text["trades"] = {curve_trade()};
  Json& trade = text["trades"][0];
  trade["curve"] = "pressure";
  trade["from"] = "1 mm";
  trade["up_to"] = "5 mm";
  trade["finest"] = Json::parse(R"([{ "/scene/scheme": ["ugimp"] }, { "/scene/scheme": ["cpgimp"] }])");
  for (const char* key : {"problems", "within", "family"}) trade.erase(key);
  const TradeRequest read = parsed(text).trades.at(0);
  EXPECT_EQ(read.from, 0.001);
  EXPECT_EQ(read.up_to, 0.005);
  EXPECT_EQ(read.within, 0.0);
  EXPECT_EQ(read.family, "");
  EXPECT_TRUE(read.problems.empty());
  // A time is no settlement.
  text["trades"][0]["from"] = "1 s";
  expect_message(refusal_of(text.dump()), "column.json", "/trades/0/from", "a length such as",
                 "\"1 s\", a time");
}

TEST(TradeReader, reads_advice) {
  const Case read = parsed(traded_case());
  ASSERT_TRUE(read.advice);
  EXPECT_EQ(read.advice->of, "another");
  EXPECT_EQ(read.advice->asked, (std::vector<double>{0.01, 0.001}));
  EXPECT_FALSE(parsed(valid_case()).advice);
  EXPECT_TRUE(parsed(valid_case()).trades.empty());
}

/// The case above with figures of one of its trades and of all.
Json figured_case() {
  Json text = traded_case();
  text["figures"] = Json::parse(
      R"([{ "id": "one", "kind": "trade", "trade": "stress", "caption": "Error over cost." },
          { "id": "all", "kind": "trade", "caption": "Error over cost." }])");
  return text;
}

TEST(TradeReader, reads_figures_of_trades) {
  const Json text = figured_case();
  EXPECT_FALSE(schema_violation(text));
  const Case read = parsed(text);
  ASSERT_EQ(read.figures.size(), 2u);
  EXPECT_EQ(read.figures[0].kind, "trade");
  EXPECT_EQ(read.figures[0].trade, "stress");
  EXPECT_EQ(read.figures[1].trade, "");
}

TEST(MalformedTrade, is_no_figure_of_another_kind_and_none_without_trades) {
  Json text = figured_case();
  text["figures"][0]["trade"] = "strain";
  expect_message(refusal_of(text.dump()), "column.json", "/figures/0/trade", "one of stress", "\"strain\"");

  for (const char* key : {"panels", "series", "metrics", "quantity"}) {
    text = figured_case();
    text["figures"][0][key] = scheme;
    EXPECT_NE(refusal_of(text.dump()), "") << key;
    EXPECT_TRUE(schema_violation(text)) << key;
  }
  text = figured_case();
  text["figures"][0]["kind"] = "bars";
  text["figures"][0]["metrics"] = {"hencky.stress.l2"};
  EXPECT_NE(refusal_of(text.dump()), "");
  EXPECT_TRUE(schema_violation(text));

  text = figured_case();
  text.erase("trades");
  text["gates"].erase(text["gates"].size() - 1);
  EXPECT_FALSE(schema_violation(text)) << "the schema cannot tell";
  expect_message(refusal_of(text.dump()), "column.json", "/figures/0/kind", "of which it has none",
                 "\"trade\"");
}

TEST(TradeReader, makes_metrics_for_gates_and_figures) {
  const Case read = parsed(traded_case());
  EXPECT_EQ(trade_metric_names(read.trades),
            (std::vector<std::string>{"trade.1.error", "trade.1.bound", "trade.2.error", "trade.2.bound"}));
  EXPECT_EQ(read.gates.back().metric, "trade.2.bound");
}

TEST(TradeReader, leaves_out_what_is_not_to_be_run) {
  const Case read = parsed(traded_case());
  ASSERT_EQ(read.runs.size(), 10u);
  for (const RunRequest& run : read.runs)
    EXPECT_FALSE(run.scene.cell_size == 0.1 && run.scene.scheme == Scheme::mpm);
  EXPECT_EQ(read.runs[0].scene.gravity.level, 1.0);
  EXPECT_EQ(read.runs[1].scene.gravity.level, 10.0);
}

TEST(TradeReader, leaves_out_combinations_that_could_not_start) {
  Json text = traded_case();
  text["sweep"].push_back(
      Json::parse(R"({ "parameter": "/scene/gravity/loading/duration", "values": ["1 s", "6 s"] })"));
  EXPECT_NE(refusal_of(text.dump()), "");
  text["trade_without"].push_back(Json::parse(R"({ "/scene/gravity/loading/duration": ["6 s"] })"));
  EXPECT_EQ(parsed(text).runs.size(), 10u);
}

TEST(TradeReader, tells_what_each_axis_changes_in_a_run) {
  Json text = valid_case();
  text["sweep"] = Json::parse(R"([
    { "parameter": "/scene/grid/cell_size", "values": ["0.1 m", "0.05 m"], "with": { "/scene/damping": [0.1, 0.2] } },
    { "name": "kind", "variants": [
      { "name": "as it is", "set": {} },
      { "name": "other", "set": { "/scene/scheme": "ugimp" }, "remove": ["/scene/update_order", "/scene/flip_fraction"] }
    ] }])");
  for (const char* key : {"figures", "claims"}) text.erase(key);
  text["gates"] = two_bodies()["gates"];
  const Case read = parsed(text);
  ASSERT_EQ(read.runs.size(), 4u);
  EXPECT_EQ(
      read.runs[3].changes,
      std::vector<Json>(
          {Json::parse(
               R"({ "set": { "/scene/grid/cell_size": "0.05 m", "/scene/damping": 0.2 }, "remove": [] })"),
           Json::parse(
               R"({ "set": { "/scene/scheme": "ugimp" }, "remove": ["/scene/update_order", "/scene/flip_fraction"] })")}));
  EXPECT_EQ(read.runs[0].changes[1], Json::parse(R"({ "set": {}, "remove": [] })"));
}

TEST(TradeReader, a_case_without_a_sweep_has_one_configuration) {
  Json text = valid_case();
  text.erase("sweep");
  for (const char* key : {"figures", "claims"}) text.erase(key);
  text["gates"] = two_bodies()["gates"];
  text["trades"] = {metric_trade()};
  for (const char* key : {"problems", "family"}) text["trades"][0].erase(key);
  EXPECT_EQ(parsed(text).trades.size(), 1u);
  EXPECT_TRUE(parsed(text).runs[0].changes.empty());
}

struct Malformed {
  std::string patch, pointer, expected, found;
  bool schema_tells;
};

TEST(MalformedTrade, is_refused_in_one_line_that_names_place_expected_and_found) {
  const std::vector<Malformed> all = {
      // What is not run.
      {R"([{"op": "replace", "path": "/trade_without", "value": []}])", "/trade_without",
       "an array of at least one value", "an empty array", true},
      {R"([{"op": "replace", "path": "/trade_without", "value": {}}])", "/trade_without", "an array",
       "an empty object", true},
      {R"([{"op": "replace", "path": "/trade_without/0", "value": {"/scene/damping": [0.8]}}])",
       "/trade_without/0/~1scene~1damping", "a swept parameter", "\"/scene/damping\"", false},
      {R"([{"op": "replace", "path": "/trade_without/0", "value": {"/scene/scheme": ["ugimp"]}}])",
       "/trade_without/0/~1scene~1scheme/0", "a value this parameter is swept over", "\"ugimp\"", false},
      {R"([{"op": "replace", "path": "/trade_without/0", "value": {}}])", "/trade_without",
       "combinations that leave a run", "an array of 1", false},
      {R"([{"op": "add", "path": "/trade_without/-", "value": {"/scene/scheme": ["mpm"], "/scene/grid/cell_size": ["0.1 m"], "/scene/gravity/level": [1]}}])",
       "/trade_without/1", "runs that no earlier entry takes away", "an object", false},

      // Trades.
      {R"([{"op": "replace", "path": "/trades", "value": []}])", "/trades", "an array of at least one value",
       "an empty array", true},
      {R"([{"op": "add", "path": "/trades/0/error", "value": 1}])", "/trades/0/error",
       "one of the keys title, metric, problems, family, asked", "\"error\"", true},
      {R"([{"op": "replace", "path": "/trades/1/title", "value": "stress"}])", "/trades/1/title",
       "a title that no other trade of the case has", "\"stress\"", false},
      {R"([{"op": "remove", "path": "/trades/0/title"}])", "/trades/0/title", "a text",
       "nothing: the key is missing", true},
      {R"([{"op": "replace", "path": "/trades/0/metric", "value": "hencky.stress.l3"}])", "/trades/0/metric",
       "one of", "\"hencky.stress.l3\" (did you mean", false},
      {R"([{"op": "replace", "path": "/trades/0/metric", "value": "zhang.stress.l2"}])", "/trades/0/metric",
       "among the case's references (equilibrium, hencky)", "\"zhang.stress.l2\", which needs zhang", false},
      {R"([{"op": "replace", "path": "/trades/0/metric", "value": "trade.1.error"}])", "/trades/0/metric",
       "one of", "\"trade.1.error\"", false},
      {R"([{"op": "remove", "path": "/trades/0/metric"}])", "/trades/0/metric", "one of",
       "nothing: the key is missing", true},
      {R"([{"op": "add", "path": "/trades/0/within", "value": "1 s"}])", "/trades/0/within",
       "one of the keys", "\"within\"", true},
      {R"([{"op": "add", "path": "/trades/1/metric", "value": "hencky.stress.l2"}])", "/trades/1/metric",
       "one of the keys title, curve", "\"metric\"", true},
      {R"([{"op": "replace", "path": "/trades/0/problems/0", "value": "/scene/damping"}])",
       "/trades/0/problems/0", "a swept parameter", "\"/scene/damping\"", false},
      {R"([{"op": "add", "path": "/trades/0/problems/-", "value": "/scene/gravity/level"}])",
       "/trades/0/problems/1", "each axis once", "again", true},
      {R"([{"op": "replace", "path": "/trades/0/family", "value": "/scene/damping"}])", "/trades/0/family",
       "a swept parameter", "\"/scene/damping\"", false},
      {R"([{"op": "replace", "path": "/trades/0/family", "value": "/scene/gravity/level"}])",
       "/trades/0/family", "an axis that is not among the problems", "\"/scene/gravity/level\"", false},
      {R"([{"op": "replace", "path": "/trades/0/asked", "value": [0.1, 0.1]}])", "/trades/0/asked/1",
       "an error below the one before", "0.1", true},
      {R"([{"op": "replace", "path": "/trades/0/asked", "value": [0.1, 0]}])", "/trades/0/asked/1",
       "an error above zero", "0", true},
      {R"([{"op": "replace", "path": "/trades/0/asked", "value": [0.1, 0.2]}])", "/trades/0/asked/1",
       "an error below the one before", "0.2", false},
      {R"([{"op": "replace", "path": "/trades/0/asked", "value": []}])", "/trades/0/asked",
       "an array of at least one value", "an empty array", true},
      {R"([{"op": "remove", "path": "/trades/0/asked"}])", "/trades/0/asked",
       "an array of at least one value", "nothing: the key is missing", true},

      // Of curves.
      {R"([{"op": "replace", "path": "/trades/1/curve", "value": "tip"}])", "/trades/1/curve", "one of",
       "\"tip\"", false},
      {R"([{"op": "remove", "path": "/trades/1/finest"}])", "/trades/1/finest",
       "an array of at least one value", "nothing: the key is missing", true},
      {R"([{"op": "remove", "path": "/trades/1/finest/1"}])", "/trades/1/finest",
       "the runs of at least two families, as no family may judge itself", "an array of 1", true},
      {R"([{"op": "replace", "path": "/trades/1/finest/1/~1scene~1scheme", "value": ["mpm", "cpgimp"]}])",
       "/trades/1/finest/1", "runs that no other family has",
       "which share one in the run with /scene/grid/cell_size = \"0.025 m\", /scene/scheme = \"mpm\"", false},
      {R"([{"op": "replace", "path": "/trades/1/finest/0/~1scene~1grid~1cell_size", "value": ["0.1 m"]}])",
       "/trades/1/finest/0", "a run of every problem", "which selects none like the one in the run with",
       false},
      {R"([{"op": "add", "path": "/trades/1/finest/1/~1scene~1gravity~1level", "value": [10]}])",
       "/trades/1/finest/1", "a run of every problem", "/scene/gravity/level = 1", false},
      {R"([{"op": "add", "path": "/trades/1/finest/1/~1scene~1damping", "value": [10]}])",
       "/trades/1/finest/1/~1scene~1damping", "a swept parameter", "\"/scene/damping\"", false},
      {R"([{"op": "replace", "path": "/trades/1/from", "value": "1 mm"}])", "/trades/1/from",
       "a time such as", "\"1 mm\", a length", false},
      {R"([{"op": "replace", "path": "/trades/1/from", "value": 0}])", "/trades/1/from", "a time such as",
       "0", true},
      {R"([{"op": "remove", "path": "/trades/1/up_to"}])", "/trades/1/up_to", "a time such as",
       "nothing: the key is missing", true},
      {R"([{"op": "replace", "path": "/trades/1/up_to", "value": "0 s"}])", "/trades/1/up_to",
       "an end beyond where the stretch begins", "\"0 s\"", false},
      {R"([{"op": "replace", "path": "/trades/1/within", "value": "0 s"}])", "/trades/1/within",
       "a half-width above zero", "\"0 s\"", true},

      // Gates on what trades measure.
      {R"([{"op": "replace", "path": "/gates/4/metric", "value": "trade.3.bound"}])", "/gates/4/metric",
       "one of", "\"trade.3.bound\" (did you mean", false},

      // Advice.
      {R"([{"op": "replace", "path": "/advice/of", "value": "two words"}])", "/advice/of",
       "a letter, then letters", "\"two words\"", true},
      {R"([{"op": "replace", "path": "/advice/asked", "value": [0.001, 0.01]}])", "/advice/asked/1",
       "an error below the one before", "0.01", false},
      {R"([{"op": "replace", "path": "/advice/asked/0", "value": "1 %"}])", "/advice/asked/0", "a number",
       "\"1 %\"", true},
      {R"([{"op": "add", "path": "/advice/title", "value": "a"}])", "/advice/title",
       "one of the keys of, asked", "\"title\"", true},
  };
  const Json valid = traded_case();
  EXPECT_EQ(refusal_of(valid.dump()), "");
  EXPECT_FALSE(schema_violation(valid));
  for (const Malformed& malformed : all) {
    SCOPED_TRACE(malformed.patch);
    const Json text = valid.patch(Json::parse(malformed.patch));
    expect_message(refusal_of(text.dump()), "column.json", malformed.pointer, malformed.expected,
                   malformed.found);
    EXPECT_EQ(schema_violation(text).has_value(), malformed.schema_tells);
  }
}

TEST(MalformedTrade, an_element_test_has_none) {
  const Json text =
      Json::parse(text_of(std::filesystem::path(MPMVV_ROOT) / "vv" / "cases" / "element_mohr_coulomb.json"));
  for (const char* key : {"trades", "trade_without", "advice"}) {
    Json changed = text;
    changed[key] = traded_case()[key];
    expect_message(refusal_of(changed.dump()), "column.json", std::string("/") + key, "one of the keys",
                   "\"" + std::string(key) + "\"");
    EXPECT_TRUE(schema_violation(changed));
  }
}

}  // namespace
}  // namespace mpm::vv
