#include "vv/case_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/case_texts.hpp"
#include "vv/case_schema.hpp"
#include "vv/json_reader.hpp"
#include "vv/metamorphic.hpp"
#include "vv/norms.hpp"
#include "vv/quantity.hpp"

namespace mpm::vv {
namespace {

using namespace mpm::test;

const std::filesystem::path root = MPMVV_ROOT;

TEST(CaseFile, is_read_with_all_it_says) {
  const Case read = parsed(valid_case());
  EXPECT_EQ(read.id, "column");
  EXPECT_EQ(read.title, "A column");
  EXPECT_EQ(read.description, "A column settles under its own weight.");
  EXPECT_EQ(read.figure_of_paper, "Figure 1");
  ASSERT_EQ(read.claims.size(), 1u);
  EXPECT_EQ(read.claims[0].text, "It comes to rest.");
  EXPECT_EQ(read.claims[0].finding, Finding::depends);
  EXPECT_EQ(read.claims[0].gates, std::vector<std::string>{"equilibrium"});
  EXPECT_EQ(read.claims[0].remark, "On damping.");
  EXPECT_EQ(read.notes, std::vector<std::string>{"It is short."});
  EXPECT_FALSE(read.quick);
  EXPECT_TRUE(read.repeat_on_other_threads);
  EXPECT_EQ(read.references, (std::vector<std::string>{"equilibrium", "hencky"}));
  EXPECT_EQ(read.file, "column.json");
  EXPECT_EQ(read.text, valid_case());

  ASSERT_EQ(read.probes.size(), 1u);
  EXPECT_EQ(read.probes[0].id, "top");
  EXPECT_EQ(read.probes[0].quantity, "displacement");
  EXPECT_EQ(read.probes[0].at[0], 0.5);
  EXPECT_EQ(read.probes[0].every, 0.01);
}

TEST(CaseFile, leaves_what_is_optional_at_its_default) {
  Json text = valid_case();
  for (const char* key : {"$schema", "figure_of_paper", "claims", "notes", "quick", "repeat_on_other_threads",
                          "sweep", "probes", "figures"}) {
    text.erase(key);
  }
  for (const char* key : {"update_order", "precision", "flip_fraction", "damping"}) text["scene"].erase(key);
  text["gates"] = Json::array({text["gates"][0]});
  text["gates"][0].erase("where");

  const Case read = parsed(text);
  EXPECT_EQ(read.figure_of_paper, "");
  EXPECT_TRUE(read.claims.empty() && read.notes.empty() && read.sweep.empty());
  EXPECT_TRUE(read.probes.empty() && read.figures.empty());
  EXPECT_TRUE(read.quick);
  EXPECT_FALSE(read.repeat_on_other_threads);
  ASSERT_EQ(read.runs.size(), 1u);
  EXPECT_TRUE(read.runs[0].parameters.empty());
  EXPECT_EQ(read.runs[0].scene_text, text["scene"]);
  EXPECT_EQ(read.runs[0].scene.update_order, UpdateOrder::musl);
  EXPECT_EQ(read.runs[0].scene.precision, Precision::float64);
  EXPECT_EQ(read.runs[0].scene.flip_fraction, 1.0);
  EXPECT_EQ(read.runs[0].scene.damping, 0.0);
  EXPECT_EQ(read.gates[0].statistic, Statistic::value);
  EXPECT_FALSE(read.gates[0].must_fail);
}

TEST(CaseFile, expands_a_sweep_with_the_last_axis_fastest) {
  const Case read = parsed(valid_case());
  ASSERT_EQ(read.sweep.size(), 2u);
  ASSERT_EQ(read.runs.size(), 6u);
  const std::vector<double> cell_sizes = {0.1, 0.1, 0.05, 0.05, 0.025, 0.025};
  for (std::size_t i = 0; i < read.runs.size(); ++i) {
    const RunRequest& run = read.runs[i];
    EXPECT_EQ(run.scene.cell_size, cell_sizes[i]);
    EXPECT_EQ(run.scene.scheme, i % 2 == 0 ? Scheme::mpm : Scheme::cpgimp);
    ASSERT_EQ(run.parameters.size(), 2u);
    EXPECT_EQ(run.parameters[0].first, "/scene/grid/cell_size");
    EXPECT_EQ(run.parameters[1].first, "/scene/scheme");
    EXPECT_EQ(run.scene_text["grid"]["cell_size"], run.parameters[0].second);
    EXPECT_EQ(run.scene_text["scheme"], run.parameters[1].second);
  }
}

TEST(CaseFile, sweeps_over_whole_objects_and_entries_of_arrays) {
  Json text = two_bodies();
  text["probes"][0]["at"][0] = "0.9 m";
  text["sweep"].push_back(Json::parse(
      R"({ "parameter": "/scene/gravity/loading", "values": [{ "type": "step" }, { "type": "ramp", "duration": "2 s" }] })"));
  text["sweep"].push_back(
      Json::parse(R"({ "parameter": "/scene/bodies/1/upper/0", "values": ["0.9 m", "1 m"] })"));
  const Case read = parsed(text);
  ASSERT_EQ(read.runs.size(), 24u);
  EXPECT_EQ(read.runs[0].scene.bodies[1].upper[0], 0.9);
  EXPECT_EQ(read.runs[1].scene.bodies[1].upper[0], 1.0);
  EXPECT_EQ(std::get<RampLoading>(read.runs[2].scene.gravity.loading).duration, 2.0);
}

TEST(CaseFile, reads_gates) {
  const Case read = parsed(valid_case());
  ASSERT_EQ(read.gates.size(), 3u);
  const Gate& equilibrium = read.gates[0];
  EXPECT_EQ(equilibrium.id, "equilibrium");
  EXPECT_EQ(equilibrium.metric, "equilibrium.stress.l2");
  EXPECT_EQ(equilibrium.statistic, Statistic::value);
  EXPECT_EQ(equilibrium.comparison, Comparison::at_most);
  EXPECT_EQ(equilibrium.threshold, 0.002);
  EXPECT_EQ(equilibrium.basis, "requirement");
  EXPECT_EQ(equilibrium.reason, "Asked for.");
  EXPECT_FALSE(equilibrium.must_fail);
  ASSERT_EQ(equilibrium.where.size(), 2u);
  EXPECT_EQ(equilibrium.where[0].parameter, "/scene/scheme");
  EXPECT_EQ(equilibrium.where[1].values, (std::vector<Json>{"0.1 m", "0.025 m"}));

  EXPECT_EQ(read.gates[1].statistic, Statistic::reduction);
  EXPECT_EQ(read.gates[1].across, "/scene/grid/cell_size");
  EXPECT_EQ(read.gates[1].comparison, Comparison::at_least);
  EXPECT_EQ(read.gates[1].threshold, 4.0);
  EXPECT_TRUE(read.gates[1].must_fail);
  EXPECT_EQ(read.gates[2].statistic, Statistic::last_order);
}

TEST(CaseFile, reads_figures) {
  const Case read = parsed(valid_case());
  ASSERT_EQ(read.figures.size(), 4u);
  EXPECT_EQ(read.figures[0].kind, "profiles");
  EXPECT_EQ(read.figures[0].quantity, "stress");
  EXPECT_EQ(read.figures[0].panels, "/scene/grid/cell_size");
  EXPECT_EQ(read.figures[0].series, "/scene/scheme");
  EXPECT_EQ(read.figures[0].references, std::vector<std::string>{"hencky"});
  EXPECT_EQ(read.figures[0].caption, "Stress.");
  EXPECT_EQ(read.figures[1].over, "/scene/grid/cell_size");
  EXPECT_EQ(read.figures[1].metrics, std::vector<std::string>{"hencky.stress.l2"});
  ASSERT_EQ(read.figures[1].where.size(), 1u);
  EXPECT_EQ(read.figures[2].kind, "bars");
  EXPECT_EQ(read.figures[2].panels, "");
  EXPECT_EQ(read.figures[3].quantity, "top");
}

TEST(CaseFile, reads_probes_of_every_target) {
  const Case read = parsed(footing_case());
  struct Expected {
    const char *id, *component, *of;
    ProbeTarget target;
  };
  const std::vector<Expected> expected = {{"corner", "zz", "", ProbeTarget::particle},
                                          {"settlement", "y", "footing", ProbeTarget::rigid_body},
                                          {"pressure", "y", "footing", ProbeTarget::rigid_body},
                                          {"mean", "x", "plate", ProbeTarget::body},
                                          {"weight", "", "lower", ProbeTarget::body},
                                          {"momentum", "y", "", ProbeTarget::everything},
                                          {"energy", "", "", ProbeTarget::everything}};
  ASSERT_EQ(read.probes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(read.probes[i].id, expected[i].id);
    EXPECT_EQ(read.probes[i].component, expected[i].component) << expected[i].id;
    EXPECT_EQ(read.probes[i].of, expected[i].of) << expected[i].id;
    EXPECT_EQ(read.probes[i].target, expected[i].target) << expected[i].id;
  }
  EXPECT_EQ(parsed(valid_case()).probes[0].component, "x");
  Json text = valid_case();
  text["probes"][0]["quantity"] = "stress";
  EXPECT_EQ(parsed(text).probes[0].component, "xx");
  text = soil_case();
  text["probes"][0]["quantity"] = "stress";
  EXPECT_EQ(parsed(text).probes[0].component, "yy");
}

TEST(CaseFile, reads_snapshots_and_their_figures) {
  using When = SnapshotRequest::When;
  const Case read = parsed(footing_case());
  EXPECT_EQ(read.snapshots, (std::vector<SnapshotRequest>{{When::time, 0.0, "", 0.0},
                                                          {When::time, 0.1, "", 0.0},
                                                          {When::passing, 0.0, "settlement", -0.005},
                                                          {When::end, 0.0, "", 0.0}}));
  EXPECT_EQ(read.figures[0].kind, "fields");
  EXPECT_EQ(read.figures[0].quantity, "max_shear_strain");
  EXPECT_EQ(read.figures[1].kind, "curves");
  EXPECT_EQ(read.figures[1].quantity, "pressure");
  EXPECT_TRUE(parsed(valid_case()).snapshots.empty());
}

TEST(CaseFile, reads_what_a_figure_shows_beside_the_runs) {
  Json text = footing_case();
  text["figures"][0]["snapshots"] = {2, 0};
  text["figures"][0]["unavailable"] = "nobody measured it";
  text["figures"][0]["view"] = {{"lower", {"0 m", "-5 mm"}}, {"upper", {"1 m", "20 cm"}}};
  text["figures"][1]["marks"] = true;
  text["figures"][1]["stages"] = {"2 mm", "1 cm"};
  text["figures"].push_back({{"id", "scene"}, {"kind", "model"}, {"caption", "The scene."}});
  const Case read = parsed(text);
  EXPECT_EQ(read.figures[0].snapshots, (std::vector<int>{2, 0}));
  EXPECT_EQ(read.figures[0].unavailable, "nobody measured it");
  ASSERT_TRUE(read.figures[0].view);
  EXPECT_EQ(read.figures[0].view->lower, (PerAxis{0.0, -0.005}));
  EXPECT_EQ(read.figures[0].view->upper, (PerAxis{1.0, 0.2}));
  EXPECT_TRUE(read.figures[1].marks);
  EXPECT_EQ(read.figures[1].stages, (std::vector<double>{0.002, 0.01}));
  EXPECT_EQ(read.figures.back().kind, "model");

  const Case plain = parsed(footing_case());
  EXPECT_TRUE(plain.figures[0].snapshots.empty() && plain.figures[0].unavailable.empty());
  EXPECT_FALSE(plain.figures[0].view);
  EXPECT_FALSE(plain.figures[1].marks);
  EXPECT_TRUE(plain.figures[1].stages.empty());
}

TEST(CaseFile, sweeps_over_several_places_at_once) {
  Json text = valid_case();
  text["sweep"][0]["with"] = Json::parse(
      R"({ "/scene/time_step/stable_fraction": [0.2, 0.1, 0.1], "/scene/bodies/0/particles_per_cell": [[2], [4], [1]] })");
  const Case read = parsed(text);
  ASSERT_EQ(read.runs.size(), 6u);
  const std::vector<double> fractions = {0.2, 0.2, 0.1, 0.1, 0.1, 0.1};
  const std::vector<int> per_cell = {2, 2, 4, 4, 1, 1};
  for (std::size_t i = 0; i < read.runs.size(); ++i) {
    const RunRequest& run = read.runs[i];
    EXPECT_EQ(std::get<StableFraction>(run.scene.time_step).fraction, fractions[i]);
    EXPECT_EQ(run.scene.bodies[0].particles_per_cell[0], per_cell[i]);
    EXPECT_EQ(run.scene_text["bodies"][0]["particles_per_cell"][0], per_cell[i]);
    ASSERT_EQ(run.parameters.size(), 2u) << "what follows along does not name the run";
    EXPECT_EQ(run.parameters[0].first, "/scene/grid/cell_size");
  }
}

/// The column with a first axis of variants, then the schemes.
Json column_in_variants() {
  Json text = valid_case();
  text["sweep"][0] = Json::parse(R"({ "name": "setting", "variants": [
      { "name": "as written", "set": {} },
      { "name": "fine", "set": { "/scene/grid/cell_size": "0.05 m", "/scene/time_step": { "seconds": "1e-5 s" } } },
      { "name": "finest, 20G", "set": { "/scene/gravity/level": 20, "/scene/grid/cell_size": "0.025 m" } }] })");
  text["gates"][0]["where"] =
      Json::parse(R"({ "/scene/scheme": ["cpgimp"], "setting": ["as written", "finest, 20G"] })");
  text["gates"][1]["across"] = text["gates"][2]["across"] = "setting";
  text["figures"][0]["panels"] = text["figures"][1]["over"] = "setting";
  return text;
}

TEST(CaseFile, sweeps_over_variants_that_have_names) {
  const Case read = parsed(column_in_variants());
  ASSERT_EQ(read.sweep.size(), 2u);
  EXPECT_EQ(read.sweep[0].parameter, "setting");
  EXPECT_EQ(read.sweep[0].values, (std::vector<Json>{"as written", "fine", "finest, 20G"}));
  ASSERT_EQ(read.sweep[0].variants.size(), 3u);
  EXPECT_TRUE(read.sweep[0].variants[0].set.empty());
  EXPECT_EQ(read.sweep[0].variants[2].set[1].first, "/scene/grid/cell_size");
  EXPECT_TRUE(read.sweep[1].variants.empty());

  ASSERT_EQ(read.runs.size(), 6u);
  const std::vector<double> cell_sizes = {0.1, 0.05, 0.025}, levels = {10, 10, 20};
  for (std::size_t i = 0; i < read.runs.size(); ++i) {
    const RunRequest& run = read.runs[i];
    EXPECT_EQ(run.scene.cell_size, cell_sizes[i / 2]);
    EXPECT_EQ(run.scene.gravity.level, levels[i / 2]) << "what a variant does not set stays as written";
    EXPECT_EQ(std::holds_alternative<StableFraction>(run.scene.time_step), i / 2 != 1);
    EXPECT_EQ(run.scene.scheme, i % 2 == 0 ? Scheme::mpm : Scheme::cpgimp);
    ASSERT_EQ(run.parameters.size(), 2u) << "only the axes name the run";
    EXPECT_EQ(run.parameters[0], (std::pair<std::string, Json>{"setting", read.sweep[0].values[i / 2]}));
  }
  EXPECT_EQ(read.runs[2].scene_text["time_step"], Json::parse(R"({ "seconds": "1e-5 s" })"));

  EXPECT_EQ(read.gates[0].where[1].parameter, "setting");
  EXPECT_EQ(read.gates[2].across, "setting");
  EXPECT_EQ(read.figures[0].panels, "setting");
  EXPECT_EQ(read.figures[1].over, "setting");
}

TEST(CaseFile, has_variants_without_something_or_with_more) {
  Json text = valid_case();
  const Json column = text["scene"]["bodies"][0];
  const char* places[] = {"0 m", "0.3 m", "0.6 m", "1 m"};
  const char* names[] = {"bottom", "middle", "top"};
  text["scene"]["bodies"] = Json::array();
  for (int k = 0; k < 3; ++k) {
    Json body = column;
    body["name"] = names[k];
    body["lower"] = {places[k]};
    body["upper"] = {places[k + 1]};
    text["scene"]["bodies"].push_back(body);
  }
  text["scene"].erase("update_order");
  text["sweep"] = Json::parse(R"([
      { "name": "top", "variants": [
        { "name": "all", "set": {} },
        { "name": "no middle", "set": { "/scene/update_order": "usl" }, "remove": ["/scene/bodies/1"] } ] },
      { "parameter": "/scene/bodies/2/density", "values": ["2 t/m^3", "3 t/m^3"] } ])");
  for (const char* key : {"gates", "figures", "references", "probes", "snapshots"}) text[key] = Json::array();
  text.erase("claims");
  text["gates"].push_back(Json::parse(R"({ "id": "end", "metric": "completed", "at_least": 1,
      "basis": "requirement", "reason": "a reason" })"));
  const Case read = parsed(text);
  ASSERT_EQ(read.runs.size(), 4u);
  EXPECT_EQ(read.runs[1].scene.bodies.size(), 3u);
  EXPECT_EQ(read.runs[1].scene.bodies[2].density, 3000.0);
  EXPECT_EQ(read.runs[1].scene.update_order, UpdateOrder::musl);
  // The place of what is removed, and of what another axis changes, are those of the scene as written.
  ASSERT_EQ(read.runs[3].scene.bodies.size(), 2u);
  EXPECT_EQ(read.runs[3].scene.bodies[1].name, "top");
  EXPECT_EQ(read.runs[3].scene.bodies[1].density, 3000.0);
  EXPECT_EQ(read.runs[3].scene.update_order, UpdateOrder::usl);
}

TEST(CaseFile, refines_by_what_a_variant_and_the_scene_as_written_say) {
  Json text = column_in_variants();
  // Without a cell size of its own the last variant has that of the scene as written, which is not smaller.
  text["sweep"][0]["variants"][2]["set"].erase("/scene/grid/cell_size");
  expect_message(refusal_of(text.dump()), "column.json", "/gates/2/across",
                 "makes the cell size smaller from each value to the next", "\"setting\"");
  // Nor does a variant have the cell size of the one before it, which here would not be smaller.
  Json& variants = text["sweep"][0]["variants"];
  variants = Json::parse(R"([{ "name": "coarse", "set": { "/scene/grid/cell_size": "0.2 m" } },
    { "name": "as written", "set": {} }, { "name": "finest, 20G", "set": { "/scene/grid/cell_size": "0.05 m" } }])");
  EXPECT_EQ(refusal_of(text.dump()), "");
}

TEST(CaseFile, says_which_variant_is_wrong_and_where) {
  struct Wrong {
    const char *patch, *pointer, *expected, *found;
    bool schema_refuses;
  };
  const std::vector<Wrong> all = {
      {R"([{"op": "remove", "path": "/sweep/0/name"}])", "/sweep/0/name", "a name: a letter",
       "nothing: the key is missing", true},
      {R"([{"op": "replace", "path": "/sweep/0/name", "value": "/scene/scheme"}])", "/sweep/0/name",
       "a name: a letter", "\"/scene/scheme\"", true},
      {R"([{"op": "remove", "path": "/sweep/0/variants"}])", "/sweep/0/variants",
       "an array of at least one value", "nothing: the key is missing", true},
      {R"([{"op": "add", "path": "/sweep/0/values", "value": [1, 2]}])", "/sweep/0/values",
       "one of the keys name, variants", "\"values\"", true},
      {R"([{"op": "add", "path": "/sweep/1/variants", "value": []}])", "/sweep/1/parameter",
       "one of the keys name, variants", "\"parameter\"", true},
      {R"([{"op": "add", "path": "/sweep/2", "value": {"name": "setting", "variants": [{"name": "a", "set": {}}]}}])",
       "/sweep/2/name", "a name that no other axis has", "\"setting\", which an earlier one has", false},
      {R"([{"op": "replace", "path": "/sweep/0/variants/1/name", "value": "as written"}])",
       "/sweep/0/variants/1/name", "a name that no other variant of the axis has", "\"as written\", which", false},
      {R"([{"op": "replace", "path": "/sweep/0/variants/1/name",
            "value": "a name that is so long that no legend has room for it all, ever"}])",
       "/sweep/0/variants/1/name", "at most 60 characters on one line", "\"a name that is so long", true},
      {R"([{"op": "replace", "path": "/sweep/0/variants/1/name", "value": "two\nlines"}])",
       "/sweep/0/variants/1/name", "at most 60 characters on one line", "\"two", false},
      {R"([{"op": "remove", "path": "/sweep/0/variants/0/set"}])", "/sweep/0/variants/0/set", "an object",
       "nothing: the key is missing", true},
      {R"([{"op": "replace", "path": "/sweep/0/variants/1/set", "value": {}}])", "/sweep/0/variants/1/set",
       "what no other variant of the axis sets", "as \"as written\" has it", false},
      {R"([{"op": "add", "path": "/sweep/0/variants/0/settings", "value": {}}])",
       "/sweep/0/variants/0/settings", "one of the keys name, set, remove", "\"settings\"", true},
      {R"([{"op": "add", "path": "/sweep/0/variants/0/set/~1scene~1dampin", "value": 0}])",
       "/sweep/0/variants/0/set/~1scene~1dampin", "one of the keys", "\"dampin\" (did you mean \"damping\"?)",
       false},
      {R"([{"op": "add", "path": "/sweep/0/variants/0/set/~1scene~1nothing~1there", "value": 0}])",
       "/sweep/0/variants/0/set/~1scene~1nothing~1there", "a JSON pointer to a value the scene has", "", false},
      {R"([{"op": "add", "path": "/sweep/0/variants/0/remove", "value": ["/scene/dampin"]}])",
       "/sweep/0/variants/0/remove/0", "a JSON pointer to a value the scene has", "\"/scene/dampin\"", false},
      {R"([{"op": "add", "path": "/sweep/0/variants/1/remove", "value": ["/scene/grid"]}])",
       "/sweep/0/variants/1/remove/0", "a value that the variant does not set", "beside /scene/grid/cell_size",
       false},
      {R"([{"op": "add", "path": "/sweep/0/variants/0/remove", "value": ["/scene/bodies", "/scene/bodies/0"]}])",
       "/sweep/0/variants/0/remove/1", "each value once", "beside /scene/bodies", false},
      {R"([{"op": "add", "path": "/sweep/0/variants/0/remove", "value": ["/scene/bodies"]}])",
       "/sweep/0/variants/0", "a variant with which /scene/bodies is", "", false},
      {R"([{"op": "add", "path": "/sweep/0/variants/0/remove", "value": ["/scene/scheme"]}])",
       "/sweep/1/parameter", "a parameter that no other axis changes", "which /scene/scheme changes too", false},
      {R"([{"op": "add", "path": "/sweep/0/variants/0/set/~1title", "value": "a"}])",
       "/sweep/0/variants/0/set/~1title", "a JSON pointer to a value the scene has", "\"/title\"", true},
      {R"([{"op": "add", "path": "/sweep/0/variants/2/set/~1scene~1grid", "value": {}}])",
       "/sweep/0/variants/2/set/~1scene~1grid", "a parameter that the variant sets once",
       "\"/scene/grid\" beside /scene/grid/cell_size", false},
      {R"([{"op": "add", "path": "/sweep/0/variants/1/set/~1scene~1time_step~1seconds", "value": "1 s"}])",
       "/sweep/0/variants/1/set/~1scene~1time_step~1seconds", "a parameter that the variant sets once", "", false},
      {R"([{"op": "add", "path": "/sweep/0/variants/1/set/~1scene~1time_step~1stable_fraction", "value": 0.1}])",
       "/sweep/0/variants/1/set/~1scene~1time_step~1stable_fraction", "a parameter that the variant sets once",
       "beside /scene/time_step", false},
      {R"([{"op": "add", "path": "/sweep/0/variants/1/set/~1scene~1scheme", "value": "mpm"}])",
       "/sweep/1/parameter", "a parameter that no other axis changes", "which /scene/scheme changes too", false},
      {R"([{"op": "add", "path": "/sweep/2", "value": {"name": "other", "variants": [
            {"name": "a", "set": {}}, {"name": "b", "set": {"/scene/time_step/stable_fraction": 0.1}}]}}])",
       "/sweep/2/variants/1/set/~1scene~1time_step~1stable_fraction", "a parameter that no other axis changes",
       "which /scene/time_step changes too", false},
      {R"([{"op": "replace", "path": "/sweep/0/variants/2/set/~1scene~1gravity~1level", "value": "20G"}])",
       "/sweep/0/variants/2/set/~1scene~1gravity~1level", "a number", "\"20G\"", false},
      {R"([{"op": "replace", "path": "/sweep/0/variants/1/set/~1scene~1time_step/seconds", "value": "1e-5 m"}])",
       "/sweep/0/variants/1/set/~1scene~1time_step/seconds", "a time such as", "a length", false},
      {R"([{"op": "replace", "path": "/sweep/0/variants/1/set/~1scene~1grid~1cell_size", "value": "0.07 m"}])",
       "/sweep/0/variants/1", "a variant with which /scene/grid/upper/0 is a whole number of cells of 0.07 m",
       "\"fine\", which makes it 1.2 m", false},
      {R"([{"op": "replace", "path": "/gates/0/where/setting/0", "value": "as writen"}])",
       "/gates/0/where/setting/0", "a value this parameter is swept over (\"as written\", \"fine\"",
       "\"as writen\"", false},
      {R"([{"op": "replace", "path": "/gates/1/across", "value": "settings"}])", "/gates/1/across",
       "a swept parameter (setting, /scene/scheme)", "\"settings\"", false},
      {R"([{"op": "replace", "path": "/gates/1/across", "value": "two words"}])", "/gates/1/across",
       "a swept parameter (setting, /scene/scheme)", "\"two words\"", true},
  };
  for (const Wrong& wrong : all) {
    SCOPED_TRACE(wrong.patch);
    const Json text = column_in_variants().patch(Json::parse(wrong.patch));
    expect_message(refusal_of(text.dump()), "column.json", wrong.pointer, wrong.expected, wrong.found);
    EXPECT_EQ(schema_violation(text).has_value(), wrong.schema_refuses);
  }
}

// ---- what must be recorded for a reference solution
// ---------------------------------------------------------------

/// A rough strip pressed into half of a weightless soil.
Json strip_case() {
  Json text = soil_case();
  text.erase("sweep");
  Json& scene = text["scene"];
  scene["grid"]["upper"] = {"0.5 m", "1.2 m"};
  scene["grid"]["edges"] = {
      {"x_lower", "roller"}, {"x_upper", "roller"}, {"y_lower", "fixed"}, {"y_upper", "free"}};
  scene["bodies"][0].erase("velocity");
  scene["gravity"]["level"] = 0;
  scene["termination"] = {{"type", "at_time"}, {"time", "2 s"}};
  scene["rigid_bodies"] =
      Json::parse(R"([{ "name": "strip", "lower": ["0 m", "1 m"], "upper": ["0.2 m", "1.1 m"],
    "velocity": ["0 m/s", "-1 mm/s"] }])");
  text["probes"] =
      Json::parse(R"([{ "id": "load", "quantity": "reaction", "of": "strip", "every": "0.01 s" }])");
  text["references"] = {"limit_analysis"};
  return text;
}

/// The same pressed into an elastic layer.
Json elastic_strip_case() {
  Json text = strip_case();
  text["scene"]["bodies"][0]["material"] = {
      {"law", "linear_elastic"}, {"youngs_modulus", "1 MPa"}, {"poissons_ratio", 0.3}};
  text["references"] = {"elastic_strip"};
  return text;
}

/// The strip with a reading at each of two depths, and a gate and a figure on them.
Json strip_with_readings() {
  Json text = strip_case();
  text["readings"] = Json::parse(R"([
    { "id": "early", "title": "pressure at 0.5 mm", "curve": "pressure", "at": "0.5 mm" },
    { "id": "late", "title": "pressure at 1.5 mm", "curve": "pressure", "at": "1.5 mm", "within": "0.1 mm",
      "over": "limit_analysis" }])");
  text["gates"].push_back(Json::parse(R"({ "id": "late", "metric": "reading.late", "at_most": 1.1,
    "basis": "theory", "reason": "Collapse." })"));
  text["figures"] = Json::parse(R"([{ "id": "readings", "kind": "bars", "caption": "Pressures.",
    "metrics": ["reading.early", "reading.late"] }])");
  return text;
}

TEST(CaseFile, reads_readings) {
  const Case read = parsed(strip_with_readings());
  ASSERT_EQ(read.readings.size(), 2u);
  EXPECT_EQ(read.readings[0].id, "early");
  EXPECT_EQ(read.readings[0].title, "pressure at 0.5 mm");
  EXPECT_EQ(read.readings[0].curve, "pressure");
  EXPECT_EQ(read.readings[0].at, 0.0005);
  EXPECT_EQ(read.readings[0].within, 0.0);
  EXPECT_EQ(read.readings[0].over, "");
  EXPECT_EQ(read.readings[1].within, 0.0001);
  EXPECT_EQ(read.readings[1].over, "limit_analysis");
  EXPECT_EQ(read.gates.back().metric, "reading.late");
  EXPECT_EQ(read.figures[0].metrics, (std::vector<std::string>{"reading.early", "reading.late"}));
  EXPECT_TRUE(parsed(strip_case()).readings.empty());
}

/// The strip at three speeds, its curves compared.
Json strip_at_speeds() {
  Json text = strip_with_readings();
  text["sweep"] = Json::parse(R"([{ "name": "speed", "variants": [
    { "name": "as written", "set": {} },
    { "name": "half", "set": { "/scene/rigid_bodies/0/velocity/1": "-0.5 mm/s", "/scene/termination/time": "4 s" } },
    { "name": "double", "set": { "/scene/rigid_bodies/0/velocity/1": "-2 mm/s", "/scene/termination/time": "1 s" } }]}])");
  text["gates"] = Json::parse(R"([
    { "id": "curves", "statistic": "curve_spread", "curve": "pressure", "across": "speed", "from": "0.1 mm",
      "up_to": "1.9 mm", "within": "0.05 mm", "at_most": 0.05, "basis": "requirement", "reason": "Slow enough." },
    { "id": "values", "statistic": "spread", "metric": "reading.late", "across": "speed", "at_most": 0.05,
      "basis": "requirement", "reason": "Slow enough." },
    { "id": "grows", "statistic": "least_ratio", "metric": "reading.early", "across": "speed", "at_least": 1,
      "basis": "theory", "reason": "Waves." }])");
  return text;
}

TEST(CaseFile, reads_gates_on_series_of_any_kind) {
  const Case read = parsed(strip_at_speeds());
  ASSERT_EQ(read.gates.size(), 3u);
  EXPECT_EQ(read.gates[0].statistic, Statistic::curve_spread);
  EXPECT_EQ(read.gates[0].metric, "");
  EXPECT_EQ(read.gates[0].curve, "pressure");
  EXPECT_EQ(read.gates[0].across, "speed");
  EXPECT_EQ(read.gates[0].from, 0.0001);
  EXPECT_EQ(read.gates[0].up_to, 0.0019);
  EXPECT_EQ(read.gates[0].within, 0.00005);
  EXPECT_EQ(read.gates[1].statistic, Statistic::spread);
  EXPECT_EQ(read.gates[1].curve, "");
  EXPECT_FALSE(read.gates[1].from || read.gates[1].up_to);
  EXPECT_EQ(read.gates[2].statistic, Statistic::least_ratio);
}

TEST(CaseFile, needs_three_falling_cell_sizes_for_the_uncertainty_of_the_discretisation) {
  Json text = valid_case();
  text["gates"][2]["statistic"] = "discretisation_uncertainty";
  EXPECT_EQ(parsed(text).gates[2].statistic, Statistic::discretisation_uncertainty);
  EXPECT_FALSE(schema_violation(text));
  text["gates"][2]["where"] = Json::parse(R"({ "/scene/grid/cell_size": ["0.1 m", "0.05 m"] })");
  expect_message(refusal_of(text.dump()), "column.json", "/gates/2/across", "at least 3 selected values",
                 "which has 2");
  text = strip_at_speeds();
  text["gates"][1]["statistic"] = "discretisation_uncertainty";
  expect_message(refusal_of(text.dump()), "column.json", "/gates/1/across",
                 "makes the cell size smaller from each value to the next", "\"speed\"");
  text["gates"][1].erase("across");
  EXPECT_TRUE(schema_violation(text));
}

TEST(CaseFile, says_which_comparison_of_a_series_is_wrong_and_where) {
  struct Wrong {
    const char *patch, *pointer, *expected, *found;
    bool schema_refuses;
  };
  const std::vector<Wrong> all = {
      {R"([{"op": "add", "path": "/gates/0/metric", "value": "reading.late"}])", "/gates/0/metric",
       "one of the keys id, curve, from, up_to, within, statistic", "\"metric\"", true},
      {R"([{"op": "remove", "path": "/gates/0/curve"}])", "/gates/0/curve", "pressure", "nothing", true},
      {R"([{"op": "replace", "path": "/gates/0/curve", "value": "load"}])", "/gates/0/curve", "pressure",
       "\"load\"", false},
      {R"([{"op": "remove", "path": "/gates/0/across"}])", "/gates/0/across", "a swept parameter (speed)",
       "nothing", true},
      {R"([{"op": "replace", "path": "/gates/0/up_to", "value": "0.1 mm"}])", "/gates/0/up_to",
       "an end beyond where the stretch begins", "\"0.1 mm\"", false},
      {R"([{"op": "replace", "path": "/gates/0/from", "value": 1}])", "/gates/0/from", "a length such as",
       "1", false},
      {R"([{"op": "replace", "path": "/gates/0/within", "value": "0 m"}])", "/gates/0/within",
       "a half-width above zero", "\"0 m\"", true},
      {R"([{"op": "remove", "path": "/gates/1/metric"}])", "/gates/1/metric", "one of ", "nothing", true},
      {R"([{"op": "add", "path": "/gates/1/curve", "value": "pressure"}])", "/gates/1/curve",
       "one of the keys id, metric, statistic", "\"curve\"", true},
      {R"([{"op": "add", "path": "/gates/1/up_to", "value": "1 mm"}])", "/gates/1/up_to",
       "one of the keys id, metric, statistic", "\"up_to\"", true},
      {R"([{"op": "replace", "path": "/gates/1/statistic", "value": "last_order"}])", "/gates/1/across",
       "makes the cell size smaller from each value to the next", "\"speed\"", false},
      {R"([{"op": "add", "path": "/gates/2/where", "value": {"speed": ["half"]}}])", "/gates/2/across",
       "at least 2 selected values", "which has 1", false},
  };
  EXPECT_FALSE(schema_violation(strip_at_speeds()));
  for (const Wrong& wrong : all) {
    SCOPED_TRACE(wrong.patch);
    const Json text = strip_at_speeds().patch(Json::parse(wrong.patch));
    expect_message(refusal_of(text.dump()), "column.json", wrong.pointer, wrong.expected, wrong.found);
    EXPECT_EQ(schema_violation(text).has_value(), wrong.schema_refuses);
  }
}

TEST(CaseFile, says_which_reading_is_wrong_and_where) {
  struct Wrong {
    const char *patch, *pointer, *expected, *found;
    bool schema_refuses;
  };
  const std::vector<Wrong> all = {
      {R"([{"op": "remove", "path": "/readings/0/title"}])", "/readings/0/title", "a text", "nothing", true},
      {R"([{"op": "replace", "path": "/readings/1/id", "value": "early"}])", "/readings/1/id",
       "an id of its own", "\"early\"", false},
      {R"([{"op": "replace", "path": "/readings/0/curve", "value": "presure"}])", "/readings/0/curve",
       "pressure", "(did you mean \"pressure\"?)", false},
      {R"([{"op": "replace", "path": "/readings/0/curve", "value": "stress_xx"}])", "/readings/0/curve",
       "pressure", "\"stress_xx\"", false},
      {R"([{"op": "replace", "path": "/readings/0/at", "value": "1 s"}])", "/readings/0/at",
       "a length such as", "\"1 s\", a time", true},
      {R"([{"op": "replace", "path": "/readings/0/at", "value": 0.025}])", "/readings/0/at",
       "a length such as", "0.025, a number without a unit", false},
      {R"([{"op": "remove", "path": "/readings/0/at"}])", "/readings/0/at", "a length such as", "nothing",
       true},
      {R"([{"op": "replace", "path": "/readings/1/within", "value": "0 mm"}])", "/readings/1/within",
       "a half-width above zero", "\"0 mm\"", true},
      {R"([{"op": "replace", "path": "/readings/1/over", "value": "elastic_strip"}])", "/readings/1/over",
       "limit_analysis", "\"elastic_strip\"", false},
      {R"([{"op": "replace", "path": "/references", "value": []}])", "/readings/1/over",
       "a reference solution of the case, which has none", "\"limit_analysis\"", false},
      {R"([{"op": "add", "path": "/readings/0/around", "value": "1 mm"}])", "/readings/0/around",
       "one of the keys id, title, curve, at, within, over", "\"around\"", true},
      {R"([{"op": "replace", "path": "/gates/1/metric", "value": "reading.lat"}])", "/gates/1/metric",
       "reading.early, reading.late", "(did you mean \"reading.late\"?)", false},
      {R"([{"op": "remove", "path": "/readings"}])", "/gates/1/metric", "one of ", "\"reading.late\"", false},
  };
  for (const Wrong& wrong : all) {
    SCOPED_TRACE(wrong.patch);
    const Json text = strip_with_readings().patch(Json::parse(wrong.patch));
    expect_message(refusal_of(text.dump()), "column.json", wrong.pointer, wrong.expected, wrong.found);
    EXPECT_EQ(schema_violation(text).has_value(), wrong.schema_refuses);
  }
}

TEST(CaseFile, needs_the_load_on_the_strip_for_what_judges_footings) {
  for (const Json& text : {strip_case(), elastic_strip_case()}) {
    EXPECT_EQ(refusal_of(text.dump()), "");
    const std::string name = text["references"][0].dump();
    const auto expect_refused = [&](const char* patch) {
      expect_message(refusal_of(text.patch(Json::parse(patch)).dump()), "column.json", "/references/0",
                     "the case records enough; it needs a probe of the load or the reaction of strip, component y", name);
    };
    expect_refused(R"([{"op": "remove", "path": "/probes"}])");
    expect_refused(R"([{"op": "add", "path": "/probes/0/component", "value": "x"}])");
    expect_refused(R"([{"op": "replace", "path": "/probes/0/quantity", "value": "displacement"}])");
  }
}

/// A soil in free fall, and one that turns as a whole.
Json falling_case() {
  Json text = soil_case();
  text.erase("sweep");
  Json& scene = text["scene"];
  for (auto& [edge, condition] : scene["grid"]["edges"].items()) condition = "free";
  scene["damping"] = 0;
  scene["gravity"]["loading"] = {{"type", "step"}};
  scene["termination"] = {{"type", "at_time"}, {"time", "0.1 s"}};
  text["references"] = {"free_fall"};
  return text;
}

Json turning_case() {
  Json text = falling_case();
  text["scene"]["rigid_bodies"] = Json::parse(
      R"([{ "name": "all", "lower": ["0 m", "0 m"], "upper": ["1.2 m", "1.2 m"], "angular_velocity": "1 rad/s" }])");
  text["scene"]["bodies"][0]["initial_stress"] = {{"type", "uniform"}, {"xx", "-1 kPa"}};
  text["references"] = {"rotation"};
  return text;
}

TEST(CaseFile, needs_the_end_for_what_judges_motions) {
  Json wave = wave_case();
  wave["references"] = {"manufactured"};
  for (Json text : {wave, falling_case(), turning_case()}) {
    const std::string name = text["references"][0].dump();
    for (const char* snapshots : {"[]", R"([{"time": "0.01 s"}])"}) {
      text["snapshots"] = Json::parse(snapshots);
      expect_message(refusal_of(text.dump()), "column.json", "/references/0",
                     "the case records enough; it needs a snapshot of the end, {\"end\": true}", name);
    }
    text["snapshots"] = Json::parse(R"([{"time": "0.01 s"}, {"end": true}])");
    EXPECT_EQ(refusal_of(text.dump()), "");
  }
}

TEST(CaseFile, tells_for_which_run_too_little_is_recorded) {
  Json text = strip_case();
  text.erase("probes");
  text["sweep"] =
      Json::parse(R"([{ "parameter": "/scene/rigid_bodies/0/name", "values": ["plate", "strip"] }])");
  expect_message(refusal_of(text.dump()), "column.json", "/references/0",
                 "the reaction of plate, component y",
                 "in the run with /scene/rigid_bodies/0/name = \"plate\"");
}

// ---- schema
// -------------------------------------------------------------------------------------------------------

TEST(CaseSchema, is_the_published_file) { EXPECT_EQ(case_schema(), text_of(root / "vv/case.schema.json")); }

TEST(CaseSchema, accepts_the_valid_case) {
  const auto violation = schema_violation(valid_case());
  EXPECT_FALSE(violation) << violation->pointer << ": " << violation->description;
}

TEST(CaseSchema, names_the_place_of_a_violation) {
  Json text = valid_case();
  text["scene"]["bodies"][1]["density"] = "2 kN/m^3";
  const auto violation = schema_violation(text);
  ASSERT_TRUE(violation);
  EXPECT_EQ(violation->pointer, "/scene/bodies/1/density");
  EXPECT_EQ(violation->description.find('\n'), std::string::npos);
}

/// The valid case with one quantity replaced.
Json with_quantity(const std::string& pointer, const std::string& quantity) {
  Json text = valid_case();
  text.at(Json::json_pointer(pointer)) = quantity;
  return text;
}

TEST(CaseSchema, knows_the_units_the_reader_knows) {
  const std::vector<std::pair<std::string, QuantityKind>> places = {
      {"/scene/grid/cell_size", QuantityKind::length},
      {"/scene/grid/upper/0", QuantityKind::length},
      {"/scene/termination/deadline", QuantityKind::time},
      {"/scene/bodies/0/material/youngs_modulus", QuantityKind::pressure},
      {"/scene/bodies/0/density", QuantityKind::density},
      {"/scene/gravity/acceleration/0", QuantityKind::acceleration}};
  for (const auto& [pointer, kind] : places) {
    for (const Unit& unit : units_of(kind)) {
      const std::string symbol(unit.symbol);
      for (const std::string number : {"1.5", "20", "0.5e-3", "1E+2"}) {
        EXPECT_FALSE(schema_violation(with_quantity(pointer, number + " " + symbol)))
            << pointer << " " << symbol;
      }
      for (const std::string number : {"", "+1", "1.", ".5", "1e", "inf", "nan", " 1", "1 ", "1,5", "0x1"}) {
        EXPECT_TRUE(schema_violation(with_quantity(pointer, number + " " + symbol)))
            << pointer << " " << number;
      }
    }
  }
}

TEST(CaseSchema, names_the_references_and_metamorphoses_the_reader_knows) {
  const Json schema = Json::parse(case_schema());
  const auto sorted = [](std::vector<std::string> names) {
    std::sort(names.begin(), names.end());
    return names;
  };
  const Json &references = schema["definitions"]["references"]["items"]["enum"],
             &metamorphoses = schema["properties"]["metamorphoses"]["items"]["enum"];
  EXPECT_EQ(sorted(references.get<std::vector<std::string>>()), sorted(reference_catalogue()));
  EXPECT_EQ(sorted(metamorphoses.get<std::vector<std::string>>()),
            sorted(names_of(metamorphosis_catalogue())));
}

TEST(CaseSchema, describes_every_key) {
  const Json schema = Json::parse(case_schema());
  std::vector<Json> pending = {schema};
  for (const auto& [name, definition] : schema["definitions"].items()) pending.push_back(definition);
  for (const Json& object : pending) {
    if (!object.contains("properties")) continue;
    EXPECT_EQ(object.value("additionalProperties", true), false);
    for (const auto& [key, property] : object["properties"].items()) {
      const bool described = property.contains("title") || property.contains("$ref");
      EXPECT_TRUE(described) << key;
    }
  }
}

// ---- the cases that are shipped
// -----------------------------------------------------------------------------------

TEST(ShippedCases, are_all_valid) {
  int cases = 0;
  for (const auto& entry : std::filesystem::directory_iterator(root / "vv/cases")) {
    if (entry.path().extension() != ".json") continue;
    ++cases;
    try {
      EXPECT_EQ(read_case(entry.path()).id, entry.path().stem().string()) << "a case is found by its id";
    } catch (const CaseError& error) {
      ADD_FAILURE() << error.what();
    }
    const auto violation = schema_violation(Json::parse(text_of(entry.path())));
    EXPECT_FALSE(violation) << entry.path() << violation->pointer << ": " << violation->description;
  }
  EXPECT_GT(cases, 0);
}

}  // namespace
}  // namespace mpm::vv
