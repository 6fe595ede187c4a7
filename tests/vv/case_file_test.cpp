#include "vv/case_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "reference/manufactured.hpp"
#include "vv/case_schema.hpp"
#include "vv/quantity.hpp"

namespace mpm::vv {
namespace {

const std::filesystem::path root = MPMVV_ROOT;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  EXPECT_TRUE(stream.is_open()) << file;
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

/// A case that uses everything a case may have, and is right.
Json valid_case() {
  return Json::parse(R"({
    "$schema": "../case.schema.json",
    "id": "column",
    "title": "A column",
    "figure_of_paper": "Figure 1",
    "description": "A column settles under its own weight.",
    "claims": [{ "claim": "It comes to rest.", "finding": "depends", "gates": ["equilibrium"], "remark": "On damping." }],
    "notes": ["It is short."],
    "quick": false,
    "repeat_on_other_threads": true,
    "scene": {
      "dimension": 1,
      "scheme": "cpgimp",
      "update_order": "usl",
      "precision": "float",
      "flip_fraction": 0.9,
      "damping": 0.8,
      "grid": {
        "cell_size": "0.1 m",
        "lower": ["0 m"],
        "upper": ["1.2 m"],
        "edges": { "x_lower": "fixed", "x_upper": "free" }
      },
      "bodies": [
        {
          "name": "lower",
          "lower": ["0 m"],
          "upper": ["50 cm"],
          "particles_per_cell": [2],
          "density": "1000 kg/m^3",
          "material": { "law": "linear_elastic", "youngs_modulus": "10000 kPa", "poissons_ratio": 0.3 }
        }
      ],
      "gravity": { "acceleration": ["-9.8 m/s^2"], "level": 10, "loading": { "type": "ramp", "duration": "1 s" } },
      "time_step": { "stable_fraction": 0.2 },
      "termination": {
        "type": "at_rest",
        "unbalanced_force_ratio": 1e-8,
        "kinetic_energy_ratio": 1e-12,
        "deadline": "5 s"
      }
    },
    "sweep": [
      { "parameter": "/scene/grid/cell_size", "values": ["0.1 m", "0.05 m", "0.025 m"] },
      { "parameter": "/scene/scheme", "values": ["mpm", "cpgimp"] }
    ],
    "references": ["equilibrium", "hencky"],
    "probes": [{ "id": "top", "quantity": "displacement", "at": ["50 cm"], "every": "0.01 s" }],
    "gates": [
      {
        "id": "equilibrium",
        "metric": "equilibrium.stress.l2",
        "where": { "/scene/scheme": ["cpgimp"], "/scene/grid/cell_size": ["0.1 m", "0.025 m"] },
        "at_most": 0.002,
        "basis": "requirement",
        "reason": "Asked for."
      },
      {
        "id": "reduction",
        "metric": "hencky.stress.l2",
        "statistic": "reduction",
        "across": "/scene/grid/cell_size",
        "where": { "/scene/scheme": ["mpm"] },
        "at_least": 4,
        "basis": "theory",
        "reason": "Second order.",
        "must_fail": true
      },
      {
        "id": "order",
        "metric": "hencky.stress.l2",
        "statistic": "last_order",
        "across": "/scene/grid/cell_size",
        "at_least": 1,
        "basis": "fit",
        "reason": "Seen."
      }
    ],
    "figures": [
      {
        "id": "stress",
        "kind": "profiles",
        "quantity": "stress",
        "panels": "/scene/grid/cell_size",
        "series": "/scene/scheme",
        "references": ["hencky"],
        "caption": "Stress."
      },
      {
        "id": "convergence",
        "kind": "convergence",
        "over": "/scene/grid/cell_size",
        "series": "/scene/scheme",
        "metrics": ["hencky.stress.l2"],
        "where": { "/scene/scheme": ["cpgimp"] },
        "caption": "Convergence."
      },
      { "id": "bars", "kind": "bars", "metrics": ["equilibrium.stress.l2"], "caption": "Errors." },
      { "id": "settling", "kind": "history", "quantity": "top", "series": "/scene/scheme", "caption": "Settling." }
    ]
  })");
}

/// The same column with a second body on it, which no reference solution describes.
Json two_bodies() {
  Json text = valid_case();
  text["scene"]["bodies"].push_back(Json::parse(R"({
          "name": "upper",
          "lower": ["0.5 m"],
          "upper": ["1 m"],
          "particles_per_cell": [1],
          "density": "2.43 g/cm^3",
          "material": { "law": "zhang_elastic", "youngs_modulus": "10 MPa" }
        })"));
  text["references"] = Json::array();
  for (const char* key : {"figures", "claims"}) text.erase(key);
  text["gates"] = Json::parse(
      R"([{ "id": "completed", "metric": "completed", "at_least": 1, "basis": "requirement", "reason": "Asked for." }])");
  return text;
}

Case parsed(const Json& text) { return parse_case(text.dump(2), "column.json"); }

/// The message of the CaseError that reading the text throws, or an empty text.
std::string refusal_of(const std::string& text) {
  try {
    parse_case(text, "column.json");
    return "";
  } catch (const CaseError& error) {
    return error.what();
  }
}

/// Checks one line: "file: pointer: expected ... , found ...", with these phrases in their places.
void expect_message(const std::string& message, const std::string& file, const std::string& pointer,
                    const std::string& expected, const std::string& found) {
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  const std::string start = file + ": " + pointer + ": expected ";
  EXPECT_TRUE(message.starts_with(start)) << "should start with " << start << "\n" << message;
  const std::size_t middle = message.rfind(", found ");
  ASSERT_NE(middle, std::string::npos) << message;
  EXPECT_LT(message.find(expected), middle) << expected << "\n" << message;
  EXPECT_NE(message.find(found, middle), std::string::npos) << found << "\n" << message;
}

// ---- what a right case is read into
// -------------------------------------------------------------------------------

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

TEST(CaseFile, gives_the_scene_in_si_units) {
  const Scene scene = parsed(two_bodies()).runs.back().scene;
  EXPECT_EQ(scene.dimension, 1);
  EXPECT_EQ(scene.scheme, Scheme::cpgimp);
  EXPECT_EQ(scene.update_order, UpdateOrder::usl);
  EXPECT_EQ(scene.precision, Precision::float32);
  EXPECT_EQ(scene.flip_fraction, 0.9);
  EXPECT_EQ(scene.damping, 0.8);
  EXPECT_EQ(scene.cell_size, 0.025);
  EXPECT_EQ(scene.grid_lower[0], 0.0);
  EXPECT_EQ(scene.grid_upper[0], 1.2);
  EXPECT_EQ(scene.edges[0][0], Condition::fixed);
  EXPECT_EQ(scene.edges[0][1], Condition::free);

  ASSERT_EQ(scene.bodies.size(), 2u);
  const Body& lower = scene.bodies[0];
  EXPECT_EQ(lower.name, "lower");
  EXPECT_EQ(lower.upper[0], 0.5);
  EXPECT_EQ(lower.particles_per_cell[0], 2);
  EXPECT_EQ(lower.density, 1000.0);
  ASSERT_TRUE(std::holds_alternative<LinearElastic>(lower.material));
  EXPECT_EQ(std::get<LinearElastic>(lower.material).youngs_modulus, 1e7);
  EXPECT_EQ(std::get<LinearElastic>(lower.material).poissons_ratio, 0.3);
  const Body& upper = scene.bodies[1];
  EXPECT_EQ(upper.lower[0], 0.5);
  EXPECT_EQ(upper.density, 2430.0);
  ASSERT_TRUE(std::holds_alternative<ZhangElastic>(upper.material));
  EXPECT_EQ(std::get<ZhangElastic>(upper.material).youngs_modulus, 1e7);

  EXPECT_EQ(scene.gravity.acceleration[0], -9.8);
  EXPECT_EQ(scene.gravity.level, 10.0);
  EXPECT_EQ(std::get<RampLoading>(scene.gravity.loading).duration, 1.0);
  EXPECT_EQ(std::get<StableFraction>(scene.time_step).fraction, 0.2);
  const AtRest& rest = std::get<AtRest>(scene.termination);
  EXPECT_EQ(rest.unbalanced_force_ratio, 1e-8);
  EXPECT_EQ(rest.kinetic_energy_ratio, 1e-12);
  EXPECT_EQ(rest.deadline, 5.0);
}

TEST(CaseFile, reads_the_other_choices_of_a_scene) {
  Json text = valid_case();
  text["scene"]["grid"]["edges"]["x_lower"] = "roller";
  text["scene"]["gravity"]["loading"] = {{"type", "staged"}, {"hold", "500 ms"}, {"fractions", {0.5, 1}}};
  text["scene"]["time_step"] = {{"seconds", "4e-5 s"}};
  text["scene"]["termination"] = {{"type", "at_time"}, {"time", "2 s"}};
  const Scene scene = parsed(text).runs.front().scene;
  EXPECT_EQ(scene.edges[0][0], Condition::roller);
  EXPECT_EQ(std::get<StagedLoading>(scene.gravity.loading).hold, 0.5);
  EXPECT_EQ(std::get<StagedLoading>(scene.gravity.loading).fractions, (std::vector<double>{0.5, 1.0}));
  EXPECT_EQ(std::get<GivenTimeStep>(scene.time_step).seconds, 4e-5);
  EXPECT_EQ(std::get<AtTime>(scene.termination).time, 2.0);

  text["scene"]["gravity"]["loading"] = {{"type", "step"}};
  EXPECT_TRUE(std::holds_alternative<StepLoading>(parsed(text).runs.front().scene.gravity.loading));
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

/// A block of soil in plane strain.
Json soil_case() {
  Json text = two_bodies();
  Json& scene = text["scene"];
  scene["dimension"] = 2;
  scene["objectivity"] = "jaumann";
  scene["grid"]["lower"].push_back("0 m");
  scene["grid"]["upper"].push_back("1.2 m");
  scene["grid"]["edges"]["y_lower"] = "fixed";
  scene["grid"]["edges"]["y_upper"] = "free";
  scene["bodies"].erase(1);
  Json& body = scene["bodies"][0];
  body["lower"].push_back("0 m");
  body["upper"].push_back("1 m");
  body["particles_per_cell"].push_back(2);
  body["velocity"] = {"0 m/s", "-2 cm/s"};
  body["material"] = {{"law", "mohr_coulomb"}, {"youngs_modulus", "1000 kPa"},
                      {"poissons_ratio", 0.3}, {"friction_angle", "20 deg"},
                      {"cohesion", "0.5 kPa"}, {"dilation_angle", "0 deg"}};
  scene["gravity"]["acceleration"].push_back("-9.8 m/s^2");
  text["probes"][0]["at"].push_back("50 cm");
  return text;
}

TEST(CaseFile, reads_soil_in_two_dimensions) {
  const Scene scene = parsed(soil_case()).runs.front().scene;
  EXPECT_EQ(scene.dimension, 2);
  EXPECT_EQ(scene.objectivity, Objectivity::jaumann);
  EXPECT_EQ(scene.bodies[0].velocity[1], -0.02);
  ASSERT_TRUE(std::holds_alternative<MohrCoulomb>(scene.bodies[0].material));
  const MohrCoulomb& soil = std::get<MohrCoulomb>(scene.bodies[0].material);
  EXPECT_EQ(soil.youngs_modulus, 1e6);
  EXPECT_EQ(soil.poissons_ratio, 0.3);
  EXPECT_DOUBLE_EQ(soil.friction_angle, std::acos(-1.0) / 9);
  EXPECT_EQ(soil.cohesion, 500.0);
  EXPECT_EQ(soil.dilation_angle, 0.0);
}

TEST(CaseFile, refuses_soil_without_its_parameters) {
  for (const char* key : {"friction_angle", "cohesion", "dilation_angle", "poissons_ratio"}) {
    Json text = soil_case();
    text["scene"]["bodies"][0]["material"].erase(key);
    EXPECT_TRUE(schema_violation(text)) << key;
    expect_message(refusal_of(text.dump()), "column.json", std::string("/scene/bodies/0/material/") + key, "",
                   "nothing: the key is missing");
  }
  Json text = soil_case();
  text["scene"]["bodies"][0]["material"]["friction_angle"] = "0.35 rad";
  EXPECT_TRUE(schema_violation(text));
  expect_message(refusal_of(text.dump()), "column.json", "/scene/bodies/0/material/friction_angle",
                 "an angle such as \"30 deg\" (unit deg)", "\"0.35 rad\"");
  text = soil_case();
  text["scene"]["bodies"][0]["material"]["dilation_angle"] = "21 deg";
  expect_message(refusal_of(text.dump()), "column.json", "/scene/bodies/0/material/dilation_angle",
                 "from 0 to the friction angle, 20 deg", "21 deg");
}

/// A footing on ground that becomes heavier, with a surcharge beside it.
Json footing_case() {
  Json text = soil_case();
  text.erase("sweep");
  text.erase("notes");
  Json& scene = text["scene"];
  scene["time_step"] = {{"stable_fraction", 0.2}};
  scene["termination"] = {{"type", "at_time"}, {"time", "2 s"}};
  scene["sums_strain"] = true;
  scene["gravity"]["acceleration"] = {"0 m/s^2", "-9.8 m/s^2"};
  scene["grid"]["edges"]["x_lower"] = "roller";
  Json& body = scene["bodies"][0];
  body["upper"] = {"1 m", "50 cm"};
  body["density_ramp"] = {{"final_density", "2 t/m^3"}, {"start", "100 ms"}, {"duration", "1 s"}};
  body["initial_stress"] = {{"type", "geostatic"}, {"surface", "0.5 m"}, {"k0", 0.5}};
  Json second = body;
  second["name"] = "plate";
  second["lower"] = {"0 m", "0.6 m"};
  second["upper"] = {"1 m", "1.2 m"};
  second.erase("velocity");
  second.erase("density_ramp");
  second["ring"] = {{"center", {"0.5 m", "0.9 m"}}, {"inner_radius", "10 cm"}, {"outer_radius", "30 cm"}};
  second["initial_stress"] = {{"type", "uniform"}, {"xx", "-10 kPa"}, {"xy", "1 kPa"}};
  second["material"] = {{"law", "linear_elastic"}, {"youngs_modulus", "1 MPa"}, {"poissons_ratio", 0.3}};
  scene["bodies"].push_back(second);
  scene["rigid_bodies"] = Json::parse(R"([
    { "name": "footing", "lower": ["0 m", "0.5 m"], "upper": ["0.2 m", "0.6 m"], "constrains": ["y"],
      "velocity": ["0 m/s", "-1 mm/s"], "angular_velocity": "0.5 rad/s", "start": "10 ms", "ramp": "0.1 s" },
    { "name": "plug", "lower": ["0.4 m", "0.8 m"], "upper": ["0.6 m", "1 m"] }])");
  scene["surface_loads"] = Json::parse(R"([
    { "body": "lower", "edge": "y_upper", "from": "0.2 m", "to": "0.5 m", "traction": ["0 Pa", "-2 kPa"], "ramp": "0.2 s" }])");
  text["probes"] = Json::parse(R"([
    { "id": "corner", "quantity": "stress", "component": "zz", "at": ["0.5 m", "0.5 m"], "every": "0.1 s" },
    { "id": "settlement", "quantity": "displacement", "of": "footing", "every": "0.01 s" },
    { "id": "pressure", "quantity": "reaction", "of": "footing", "every": "0.01 s" },
    { "id": "mean", "quantity": "velocity", "of": "plate", "component": "x", "every": "0.01 s" },
    { "id": "weight", "quantity": "weight", "of": "lower", "every": "0.01 s" },
    { "id": "momentum", "quantity": "momentum", "every": "0.01 s" },
    { "id": "energy", "quantity": "kinetic_energy", "every": "0.01 s" }])");
  text["snapshots"] = Json::parse(
      R"([{ "time": "0 s" }, { "time": "0.1 s" }, { "probe": "settlement", "reaches": "-5 mm" }, { "end": true }])");
  text["figures"] = Json::parse(R"([
    { "id": "strain", "kind": "fields", "quantity": "max_shear_strain", "caption": "Strain." },
    { "id": "load", "kind": "curves", "quantity": "pressure", "references": [], "caption": "Pressure." }])");
  return text;
}

TEST(CaseFile, reads_what_bodies_start_from) {
  const Scene scene = parsed(footing_case()).runs.front().scene;
  const Body& ground = scene.bodies[0];
  ASSERT_TRUE(ground.density_ramp);
  EXPECT_EQ(ground.density_ramp->final_density, 2000.0);
  EXPECT_EQ(ground.density_ramp->start, 0.1);
  EXPECT_EQ(ground.density_ramp->duration, 1.0);
  ASSERT_TRUE(ground.initial_stress);
  EXPECT_EQ(std::get<GeostaticStress>(*ground.initial_stress).surface, 0.5);
  EXPECT_EQ(std::get<GeostaticStress>(*ground.initial_stress).k0, 0.5);
  EXPECT_FALSE(ground.ring);
  const Body& plate = scene.bodies[1];
  ASSERT_TRUE(plate.ring);
  EXPECT_EQ(plate.ring->center, (PerAxis{0.5, 0.9}));
  EXPECT_EQ(plate.ring->inner_radius, 0.1);
  EXPECT_EQ(plate.ring->outer_radius, 0.3);
  const UniformStress& stress = std::get<UniformStress>(*plate.initial_stress);
  EXPECT_EQ(stress.xx, -1e4);
  EXPECT_EQ(stress.yy, 0.0);
  EXPECT_EQ(stress.zz, 0.0);
  EXPECT_EQ(stress.xy, 1e3);
  EXPECT_FALSE(plate.density_ramp);
}

TEST(CaseFile, reads_rigid_bodies_and_surface_loads) {
  const Scene scene = parsed(footing_case()).runs.front().scene;
  EXPECT_TRUE(scene.sums_strain);
  ASSERT_EQ(scene.rigid_bodies.size(), 2u);
  const RigidBody& footing = scene.rigid_bodies[0];
  EXPECT_EQ(footing.name, "footing");
  EXPECT_EQ(footing.lower, (PerAxis{0.0, 0.5}));
  EXPECT_EQ(footing.upper, (PerAxis{0.2, 0.6}));
  EXPECT_EQ(footing.constrains, (std::array<bool, 2>{false, true}));
  EXPECT_EQ(footing.velocity, (PerAxis{0.0, -0.001}));
  EXPECT_EQ(footing.angular_velocity, 0.5);
  EXPECT_EQ(footing.start, 0.01);
  EXPECT_EQ(footing.ramp, 0.1);
  const RigidBody& plug = scene.rigid_bodies[1];
  EXPECT_EQ(plug.constrains, (std::array<bool, 2>{true, true}));
  EXPECT_EQ(plug.velocity, (PerAxis{0.0, 0.0}));
  EXPECT_EQ(plug.angular_velocity, 0.0);
  EXPECT_EQ(plug.start, 0.0);
  EXPECT_EQ(plug.ramp, 0.0);
  ASSERT_EQ(scene.surface_loads.size(), 1u);
  const SurfaceLoad& load = scene.surface_loads[0];
  EXPECT_EQ(load.body, "lower");
  EXPECT_EQ(load.axis, 1);
  EXPECT_EQ(load.side, 1);
  EXPECT_EQ(load.begin, 0.2);
  EXPECT_EQ(load.end, 0.5);
  EXPECT_EQ(load.traction, (PerAxis{0.0, -2000.0}));
  EXPECT_EQ(load.ramp, 0.2);
}

TEST(CaseFile, reads_every_edge_of_a_surface_load) {
  const std::vector<std::tuple<const char*, int, int>> edges = {
      {"x_lower", 0, 0}, {"x_upper", 0, 1}, {"y_lower", 1, 0}, {"y_upper", 1, 1}};
  for (const auto& [name, axis, side] : edges) {
    Json text = footing_case();
    text["scene"]["surface_loads"][0]["edge"] = name;
    const SurfaceLoad load = parsed(text).runs.front().scene.surface_loads[0];
    EXPECT_EQ(load.axis, axis) << name;
    EXPECT_EQ(load.side, side) << name;
  }
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

/// A bar that is driven through a standing wave.
Json wave_case() {
  Json text = two_bodies();
  text.erase("sweep");
  Json& scene = text["scene"];
  scene["bodies"].erase(1);
  scene["bodies"][0]["upper"] = {"1 m"};
  scene["bodies"][0]["material"] = {
      {"law", "neo_hookean"}, {"youngs_modulus", "10 MPa"}, {"poissons_ratio", 0.3}};
  scene["driven_motion"] = {{"solution", "standing_wave"}, {"amplitude", "5 cm"}, {"length", "1 m"}};
  scene["gravity"]["level"] = 0;
  scene["termination"] = {{"type", "at_time"}, {"time", "0.02 s"}};
  text["probes"] = Json::parse(R"([{ "id": "energy", "quantity": "strain_energy", "every": "1 ms" }])");
  return text;
}

TEST(CaseFile, reads_a_driven_motion) {
  const Case read = parsed(wave_case());
  const RunRequest& run = read.runs.front();
  ASSERT_TRUE(run.motion);
  ASSERT_TRUE(run.scene.driven_motion);
  EXPECT_EQ(std::get<NeoHookean>(run.scene.bodies[0].material).youngs_modulus, 1e7);
  EXPECT_EQ(std::get<NeoHookean>(run.scene.bodies[0].material).poissons_ratio, 0.3);
  const double quarter = 0.005;  // of the period 2 L / c with c = sqrt(1e7 / 1000) m/s
  EXPECT_NEAR(run.motion->displacement({0.5, 0.0}, quarter)[0], 0.05, 1e-15);
  const double speed = 0.05 * std::acos(-1.0) * 100.0;
  EXPECT_NEAR(run.scene.driven_motion->velocity({0.5, 0.0}, 0.0)[0], speed, 1e-12);
  EXPECT_EQ(run.scene.driven_motion->body_force({0.3, 0.0}, 0.001)[0],
            run.motion->body_force({0.3, 0.0}, 0.001)[0]);
  EXPECT_FALSE(parsed(valid_case()).runs.front().motion);
  EXPECT_FALSE(parsed(valid_case()).runs.front().scene.driven_motion);
}

/// A square that is driven in two dimensions.
Json driven_square(const Json& motion) {
  Json text = soil_case();
  text.erase("sweep");
  text.erase("probes");
  Json& scene = text["scene"];
  scene["objectivity"] = "none";
  scene["bodies"][0].erase("velocity");
  scene["bodies"][0]["material"] = {
      {"law", "neo_hookean"}, {"youngs_modulus", "10 MPa"}, {"poissons_ratio", 0.0}};
  scene["driven_motion"] = motion;
  return text;
}

TEST(CaseFile, reads_every_driven_motion_with_its_parameters) {
  const Json ring = {{"solution", "expanding_ring"},     {"amplitude", "1 cm"},
                     {"angular_frequency", "100 rad/s"}, {"inner_radius", "0.4 m"},
                     {"outer_radius", "0.6 m"},          {"center", {"1 m", "2 m"}}};
  const auto motion_of = [](const Json& motion) { return parsed(driven_square(motion)).runs.front().motion; };
  // The inner face is displaced most, a quarter of a period after the start.
  const double quarter = std::acos(-1.0) / 200;
  EXPECT_NEAR(std::abs(motion_of(ring)->displacement({1.4, 2.0}, quarter)[0]), 0.01, 1e-12);
  const Json vortex = {
      {"solution", "generalised_vortex"}, {"amplitude", "90 deg"},   {"period", "1 s"},
      {"inner_radius", "0.4 m"},          {"outer_radius", "0.6 m"}, {"center", {"1 m", "2 m"}}};
  const auto turned = motion_of(vortex)->displacement({1.5, 2.0}, 0.25);
  EXPECT_NEAR(turned[0], -0.5, 1e-12);
  EXPECT_NEAR(turned[1], 0.5, 1e-12);
  const Json rotation = {
      {"solution", "rotation"}, {"angular_velocity", "2 rad/s"}, {"center", {"1 m", "2 m"}}};
  EXPECT_NEAR(motion_of(rotation)->velocity({1.5, 2.0}, 0.0)[1], 1.0, 1e-12);
  const Json square = {{"solution", "axis_aligned"}, {"amplitude", "1 cm"}, {"length", "2 m"}};
  EXPECT_NEAR(motion_of(square)->displacement({1.0, 0.0}, 0.01)[0], 0.01, 1e-12);
  Json bar = wave_case();
  bar["scene"]["driven_motion"]["solution"] = "vibrating_bar";
  bar["scene"]["bodies"][0]["material"]["law"] = "linear_elastic";
  EXPECT_TRUE(parsed(bar).runs.front().motion);
}

// ---- what is refused
// ----------------------------------------------------------------------------------------------

/// Whether the schema alone, without the reader, refuses the case as well.
enum class Schema { refuses, cannot_tell };

struct Malformed {
  std::string patch;  ///< what turns the valid case into this one (JSON Patch)
  std::string pointer;
  std::string expected;
  std::string found;
  Schema schema;
};

const std::vector<Malformed>& malformed_cases() {
  static const std::vector<Malformed> all = {
      // Keys.
      {R"([{"op": "add", "path": "/gate", "value": []}])", "/gate", "one of the keys $schema, id",
       "\"gate\" (did you mean \"gates\"?)", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/dampin", "value": 0.8}])", "/scene/dampin",
       "one of the keys dimension", "\"dampin\" (did you mean \"damping\"?)", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/grid/edges/y_lower", "value": "free"}])",
       "/scene/grid/edges/y_lower", "one of the keys x_lower, x_upper", "\"y_lower\"", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/grid/a~1b~0c", "value": 1}])", "/scene/grid/a~1b~0c",
       "one of the keys cell_size", "\"a/b~c\"", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/gravity/loading/hold", "value": "1 s"}])",
       "/scene/gravity/loading/hold", "one of the keys type, duration", "\"hold\"", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/bodies/-", "value": {"name": "upper", "lower": ["0.5 m"], "upper": ["1 m"], "particles_per_cell": [1], "density": "2 g/cm^3", "material": {"law": "zhang_elastic", "youngs_modulus": "10 MPa"}}}, {"op": "add", "path": "/scene/bodies/1/material/poissons_ratio", "value": 0.3}])",
       "/scene/bodies/1/material/poissons_ratio", "one of the keys law, youngs_modulus", "\"poissons_ratio\"",
       Schema::refuses},
      {R"([{"op": "add", "path": "/scene/two\nlines", "value": 1}])", "/scene/two?lines",
       "one of the keys dimension", R"("two\nlines")", Schema::refuses},
      {R"([{"op": "remove", "path": "/title"}])", "/title", "a text", "nothing: the key is missing",
       Schema::refuses},
      {R"([{"op": "remove", "path": "/scene"}])", "/scene", "an object", "nothing: the key is missing",
       Schema::refuses},
      {R"([{"op": "remove", "path": "/gates"}])", "/gates", "an array of at least one value",
       "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "remove", "path": "/references"}])", "/references", "an array",
       "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/grid/cell_size"}])", "/scene/grid/cell_size", "a length such as",
       "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/bodies/0/material/poissons_ratio"}])",
       "/scene/bodies/0/material/poissons_ratio", "a number", "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/gravity/loading/duration"}])", "/scene/gravity/loading/duration",
       "a time such as", "nothing: the key is missing", Schema::refuses},

      // Types.
      {R"([{"op": "replace", "path": "", "value": []}])", "/", "an object", "an empty array",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/id", "value": "two words"}])", "/id", "a letter, then letters",
       "\"two words\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/title", "value": ""}])", "/title", "a text that is not empty", "\"\"",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/claims/0/gates/0", "value": "equilibrum"}])", "/claims/0/gates/0",
       "one of equilibrium, reduction, order", "\"equilibrum\"", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/claims/0/remark"}])", "/claims/0/remark",
       "a remark that says why the claim is not simply seen", "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "replace", "path": "/claims/0/finding", "value": "true"}])", "/claims/0/finding",
       "one of seen, not_seen, depends", "\"true\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/claims", "value": "one"}])", "/claims", "an array", "\"one\"",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/notes/0", "value": 1}])", "/notes/0", "a text that is not empty", "1",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/quick", "value": "yes"}])", "/quick", "true or false", "\"yes\"",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/dimension", "value": "1"}])", "/scene/dimension", "an integer",
       "\"1\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/dimension", "value": 3}])", "/scene/dimension", "1 or 2", "3",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/0/particles_per_cell/0", "value": 1.5}])",
       "/scene/bodies/0/particles_per_cell/0", "an integer", "1.5", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/0/particles_per_cell/0", "value": 3000000000}])",
       "/scene/bodies/0/particles_per_cell/0", "an integer of at most 2147483647", "3000000000",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/damping", "value": "0.8"}])", "/scene/damping", "a number",
       "\"0.8\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/grid", "value": null}])", "/scene/grid", "an object", "null",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies", "value": []}])", "/scene/bodies",
       "an array of at least one value", "an empty array", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/grid/upper/1", "value": "1 m"}])", "/scene/grid/upper",
       "an array of 1, one value per dimension", "an array of 2", Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/gravity/acceleration/0"}])", "/scene/gravity/acceleration",
       "an array of 1, one value per dimension", "an empty array", Schema::refuses},

      // Names.
      {R"([{"op": "replace", "path": "/scene/scheme", "value": "gimp"}])", "/scene/scheme",
       "one of mpm, ugimp, cpgimp", "\"gimp\" (did you mean \"ugimp\"?)", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/precision", "value": "float64"}])", "/scene/precision",
       "one of double, float", "\"float64\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/update_order", "value": "MUSL"}])", "/scene/update_order",
       "one of musl, usf, usl", "\"MUSL\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/grid/edges/x_upper", "value": "open"}])",
       "/scene/grid/edges/x_upper", "one of free, roller, fixed", "\"open\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/0/material/law", "value": "cam_clay"}])",
       "/scene/bodies/0/material/law", "one of linear_elastic, zhang_elastic, mohr_coulomb", "\"cam_clay\"",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/termination/type", "value": "never"}])",
       "/scene/termination/type", "one of at_time, at_rest", "\"never\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/references/0", "value": "hanky"}])", "/references/0",
       "one of equilibrium, hencky, zhang", "\"hanky\" (did you mean \"hencky\"?)", Schema::refuses},
      {R"([{"op": "replace", "path": "/references/0", "value": "hencky"}])", "/references/1",
       "each name once", "\"hencky\" again", Schema::refuses},

      // Units.
      {R"([{"op": "replace", "path": "/scene/bodies/0/material/youngs_modulus", "value": "10000 kN"}])",
       "/scene/bodies/0/material/youngs_modulus", "a pressure such as \"10 kPa\" (units Pa, kPa, MPa, GPa)",
       "\"10000 kN\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/0/material/youngs_modulus", "value": 1e7}])",
       "/scene/bodies/0/material/youngs_modulus", "a pressure such as", "10000000.0, a number without a unit",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/0/density", "value": "9.8 kN/m^3"}])",
       "/scene/bodies/0/density", "a density such as",
       "a unit weight: divide it by the acceleration of gravity", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/grid/cell_size", "value": "0.1 s"}])", "/scene/grid/cell_size",
       "a length such as", "\"0.1 s\", a time", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/grid/lower/0", "value": "0"}])", "/scene/grid/lower/0",
       "a length such as", "\"0\", which has no unit", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/termination/deadline", "value": "5 s\nor so"}])",
       "/scene/termination/deadline", "a time such as", "\"5 s?or so\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/termination/deadline", "value": "inf s"}])",
       "/scene/termination/deadline", "a time such as", "\"inf s\"", Schema::refuses},

      // Impossible values.
      {R"([{"op": "replace", "path": "/scene/bodies/0/material/youngs_modulus", "value": "-10 kPa"}])",
       "/scene/bodies/0/material/youngs_modulus", "a modulus above zero", "-10000 Pa", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/0/material/poissons_ratio", "value": 0.5}])",
       "/scene/bodies/0/material/poissons_ratio", "from 0 to below 0.5", "0.5", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/grid/cell_size", "value": "0 m"}])", "/scene/grid/cell_size",
       "a cell size above zero", "0 m", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/damping", "value": 1}])", "/scene/damping", "from 0 to below 1",
       "1", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/gravity/level", "value": -1}])", "/scene/gravity/level",
       "zero or above", "-1", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/time_step", "value": {"stable_fraction": 11}}])",
       "/scene/time_step/stable_fraction", "above 0, at most 10", "11", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/time_step/seconds", "value": "4e-5 s"}])", "/scene/time_step",
       "either stable_fraction or seconds", "both", Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/time_step/stable_fraction"}])", "/scene/time_step",
       "either stable_fraction or seconds", "neither", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/gravity/loading", "value": {"type": "staged", "hold": "1 s", "fractions": []}}])",
       "/scene/gravity/loading/fractions", "an array of at least one value", "an empty array",
       Schema::refuses},
      {R"([{"op": "add", "path": "/scene/bodies/-", "value": {"name": "upper", "lower": ["0.5 m"], "upper": ["1 m"], "particles_per_cell": [1], "density": "2 g/cm^3", "material": {"law": "zhang_elastic", "youngs_modulus": "10 MPa"}}}, {"op": "replace", "path": "/scene/bodies/1/upper/0", "value": "1.3 m"}])",
       "/scene/bodies/1/upper/0", "a body inside the grid, which ends at 1.2 m", "1.3 m",
       Schema::cannot_tell},
      {R"([{"op": "add", "path": "/scene/bodies/-", "value": {"name": "upper", "lower": ["0.5 m"], "upper": ["1 m"], "particles_per_cell": [1], "density": "2 g/cm^3", "material": {"law": "zhang_elastic", "youngs_modulus": "10 MPa"}}}, {"op": "replace", "path": "/scene/bodies/1/lower/0", "value": "0.4 m"}])",
       "/scene/bodies/1", "a body clear of all others", "\"upper\", which overlaps \"lower\"",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/grid/edges/x_lower", "value": "free"}])", "/references/0",
       "a reference solution that describes the scene; it needs a fixed x_lower edge", "\"equilibrium\"",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/gravity/acceleration/0", "value": "9.8 m/s^2"}])",
       "/references/0", "it needs gravity towards the lower edge", "\"equilibrium\"", Schema::cannot_tell},
      {R"([{"op": "add", "path": "/scene/bodies/-", "value": {"name": "upper", "lower": ["0.5 m"], "upper": ["1 m"], "particles_per_cell": [1], "density": "2 g/cm^3", "material": {"law": "zhang_elastic", "youngs_modulus": "10 MPa"}}}])",
       "/references/0", "it needs a single body", "\"equilibrium\"", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/termination/deadline", "value": "1 s"}])",
       "/scene/termination/deadline", "after gravity has settled at 1 s", "1 s", Schema::cannot_tell},

      // Sweeps.
      {R"([{"op": "replace", "path": "/sweep", "value": []}])", "/sweep", "an array of at least one value",
       "an empty array", Schema::refuses},
      {R"([{"op": "replace", "path": "/sweep/0/values", "value": []}])", "/sweep/0/values",
       "an array of at least one value", "an empty array", Schema::refuses},
      {R"([{"op": "replace", "path": "/sweep/1/parameter", "value": "/scene/shape"}])", "/sweep/1/parameter",
       "a JSON pointer to a value the scene has", "\"/scene/shape\"", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/sweep/1/parameter", "value": "/scene/bodies/2/density"}])",
       "/sweep/1/parameter", "a JSON pointer to a value the scene has", "\"/scene/bodies/2/density\"",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/sweep/1/parameter", "value": "/scene/bodies/~2"}])",
       "/sweep/1/parameter", "a JSON pointer to a value the scene has", "\"/scene/bodies/~2\"",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/sweep/1/parameter", "value": "/title"}])", "/sweep/1/parameter",
       "a JSON pointer to a value the scene has", "\"/title\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/sweep/1/parameter", "value": "/scene/grid"}])", "/sweep/1/parameter",
       "a parameter that no other axis changes", "\"/scene/grid\", which /scene/grid/cell_size changes too",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/sweep/1/values/0", "value": "cpgimp"}])", "/sweep/1/values/1",
       "each value once", "\"cpgimp\" again", Schema::refuses},
      {R"([{"op": "replace", "path": "/sweep/1/values/0", "value": "pic"}])", "/sweep/1/values/0",
       "one of mpm, ugimp, cpgimp", "\"pic\"", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/sweep/0/values/2", "value": 0.025}])", "/sweep/0/values/2",
       "a length such as", "0.025, a number without a unit", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/sweep/0/values/2", "value": "-0.025 m"}])", "/sweep/0/values/2",
       "a cell size above zero", "-0.025 m", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/sweep/0/values/1", "value": "0.07 m"}])", "/sweep/0/values/1",
       "a value with which /scene/grid/upper/0 is a whole number of cells of 0.07 m",
       "\"0.07 m\", which makes it 1.2 m", Schema::cannot_tell},
      {R"([{"op": "add", "path": "/sweep/2", "value":
           {"parameter": "/scene/gravity/loading", "values": [{"type": "step"}, {"type": "ramp", "duration": "5 m"}]}}])",
       "/sweep/2/values/1/duration", "a time such as", "\"5 m\", a length", Schema::cannot_tell},
      {R"([{"op": "add", "path": "/sweep/2", "value":
           {"parameter": "/scene/gravity/loading/duration", "values": ["1 s", "6 s"]}}])",
       "/sweep/2/values/1",
       "a value with which /scene/termination/deadline is a time after gravity has settled at 6 s",
       "\"6 s\", which makes it 5 s", Schema::cannot_tell},

      // Sweeps that change several places at once.
      {R"([{"op": "add", "path": "/sweep/0/with", "value": {}}])", "/sweep/0/with",
       "an object with at least one parameter", "an empty object", Schema::refuses},
      {R"([{"op": "add", "path": "/sweep/0/with", "value": [0.1]}])", "/sweep/0/with", "an object",
       "an array of 1", Schema::refuses},
      {R"([{"op": "add", "path": "/sweep/0/with", "value": {"/scene/damping": [0.1, 0.2]}}])",
       "/sweep/0/with/~1scene~1damping", "an array of 3, one value for each of the axis's values",
       "an array of 2", Schema::cannot_tell},
      {R"([{"op": "add", "path": "/sweep/0/with", "value": {"/scene/damping": 0.1}}])",
       "/sweep/0/with/~1scene~1damping", "an array of at least one value", "0.1", Schema::refuses},
      {R"([{"op": "add", "path": "/sweep/0/with", "value": {"/scene/dampin": [0.1, 0.2, 0.3]}}])",
       "/sweep/0/with/~1scene~1dampin", "a JSON pointer to a value the scene has", "\"/scene/dampin\"",
       Schema::cannot_tell},
      {R"([{"op": "add", "path": "/sweep/0/with", "value": {"/title": ["a", "b", "c"]}}])",
       "/sweep/0/with/~1title", "a JSON pointer to a value the scene has", "\"/title\"", Schema::refuses},
      {R"([{"op": "add", "path": "/sweep/0/with", "value": {"/scene/grid": [1, 2, 3]}}])",
       "/sweep/0/with/~1scene~1grid", "a parameter that no other axis changes",
       "\"/scene/grid\", which /scene/grid/cell_size changes too", Schema::cannot_tell},
      {R"([{"op": "add", "path": "/sweep/0/with", "value": {"/scene/scheme": ["mpm", "mpm", "mpm"]}}])",
       "/sweep/1/parameter", "a parameter that no other axis changes",
       "\"/scene/scheme\", which /scene/scheme changes too", Schema::cannot_tell},
      {R"([{"op": "add", "path": "/sweep/0/with", "value": {"/scene/damping": [0.1, 0.2, 1.5]}}])",
       "/sweep/0/with/~1scene~1damping/2", "from 0 to below 1", "1.5", Schema::cannot_tell},
      {R"([{"op": "add", "path": "/sweep/0/with", "value": {"/scene/gravity/loading": [{"type": "step"}, {"type": "step"}, {"type": "ramp", "duration": "5 m"}]}}])",
       "/sweep/0/with/~1scene~1gravity~1loading/2/duration", "a time such as", "\"5 m\", a length",
       Schema::cannot_tell},

      // Probes.
      {R"([{"op": "replace", "path": "/probes/0/at/0", "value": "1.1 m"}])", "/probes/0/at",
       "a place within one particle spacing of a particle",
       "\"1.1 m\", which hits none in the run with /scene/grid/cell_size = \"0.1 m\", /scene/scheme = "
       "\"mpm\"",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/probes/0/every", "value": "0 s"}])", "/probes/0/every",
       "a time above zero", "\"0 s\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/probes/0/quantity", "value": "force"}])", "/probes/0/quantity",
       "one of displacement, velocity, stress", "\"force\"", Schema::refuses},

      // Gates.
      {R"([{"op": "replace", "path": "/gates", "value": []}])", "/gates", "an array of at least one value",
       "an empty array", Schema::refuses},
      {R"([{"op": "replace", "path": "/gates/1/id", "value": "equilibrium"}])", "/gates/1/id",
       "an id of its own", "\"equilibrium\", which an earlier entry has", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/gates/0/metric", "value": "equilibrium.stress.l3"}])",
       "/gates/0/metric", "one of ", "\"equilibrium.stress.l3\" (did you mean \"equilibrium.stress.l",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/gates/0/metric", "value": "zhang.stress.l2"}])", "/gates/0/metric",
       "among the case's references (equilibrium, hencky)", "\"zhang.stress.l2\", which needs zhang",
       Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/gates/0/at_most"}])", "/gates/0", "either at_most or at_least",
       "neither", Schema::refuses},
      {R"([{"op": "add", "path": "/gates/0/at_least", "value": 0}])", "/gates/0",
       "either at_most or at_least", "both", Schema::refuses},
      {R"([{"op": "replace", "path": "/gates/0/at_most", "value": "0.2 %"}])", "/gates/0/at_most", "a number",
       "\"0.2 %\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/gates/0/reason", "value": ""}])", "/gates/0/reason",
       "a text that is not empty", "\"\"", Schema::refuses},
      {R"([{"op": "remove", "path": "/gates/0/reason"}])", "/gates/0/reason", "a text that is not empty",
       "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "replace", "path": "/gates/0/basis", "value": "hope"}])", "/gates/0/basis",
       "one of theory, requirement, fit, reference_uncertainty", "\"hope\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/gates/1/statistic", "value": "mean"}])", "/gates/1/statistic",
       "one of value, reduction, worst_ratio, last_order", "\"mean\"", Schema::refuses},
      {R"([{"op": "remove", "path": "/gates/1/across"}])", "/gates/1/across",
       "a swept parameter (/scene/grid/cell_size, /scene/scheme)", "nothing: the key is missing",
       Schema::refuses},
      {R"([{"op": "add", "path": "/gates/0/across", "value": "/scene/grid/cell_size"}])", "/gates/0/across",
       "no key \"across\"", "\"/scene/grid/cell_size\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/gates/1/across", "value": "/scene/damping"}])", "/gates/1/across",
       "a swept parameter (/scene/grid/cell_size, /scene/scheme)", "\"/scene/damping\"", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/gates/2/across", "value": "/scene/scheme"}])", "/gates/2/across",
       "at least 3 selected values", "\"/scene/scheme\", which has 2", Schema::cannot_tell},
      {R"([{"op": "add", "path": "/gates/1/where/~1scene~1grid~1cell_size", "value": ["0.1 m"]}])",
       "/gates/1/across", "at least 2 selected values", "which has 1", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/sweep/0/values", "value": ["0.025 m", "0.05 m", "0.1 m"]}])",
       "/gates/2/across", "makes the cell size smaller from each value to the next",
       "\"/scene/grid/cell_size\"", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/gates/0/where", "value": {"/scene/damping": [0.8]}}])",
       "/gates/0/where/~1scene~1damping", "a swept parameter (/scene/grid/cell_size, /scene/scheme)",
       "\"/scene/damping\"", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/gates/0/where", "value": {"/scene/scheme": ["ugimp"]}}])",
       "/gates/0/where/~1scene~1scheme/0", "a value this parameter is swept over (\"mpm\", \"cpgimp\")",
       "\"ugimp\"", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/gates/0/where", "value": {"/scene/scheme": []}}])",
       "/gates/0/where/~1scene~1scheme", "an array of at least one value", "an empty array", Schema::refuses},
      {R"([{"op": "replace", "path": "/gates/0/metric", "value": "bits_differ"},
           {"op": "remove", "path": "/repeat_on_other_threads"}])",
       "/gates/0/metric", "a metric that the case measures", "which needs repeat_on_other_threads",
       Schema::cannot_tell},

      // Figures.
      {R"([{"op": "replace", "path": "/figures/0/kind", "value": "profile"}])", "/figures/0/kind",
       "one of profiles, convergence, bars, history", "\"profile\" (did you mean \"profiles\"?)",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/figures/0/quantity", "value": "strain"}])", "/figures/0/quantity",
       "one of stress, displacement, stress_error", "\"strain\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/figures/0/references", "value": ["zhang"]}])",
       "/figures/0/references/0", "one of equilibrium, hencky", "\"zhang\"", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/figures/0/panels", "value": "/scene/damping"}])", "/figures/0/panels",
       "a swept parameter", "\"/scene/damping\"", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/figures/0/panels", "value": "/scene/scheme"}])", "/figures/0/series",
       "a parameter without another role", "\"/scene/scheme\"", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/figures/1/over"}])", "/figures/1/over", "a swept parameter",
       "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "add", "path": "/figures/2/over", "value": "/scene/scheme"}])", "/figures/2/over",
       "one of the keys id, kind, caption", "\"over\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/figures/2/metrics", "value": []}])", "/figures/2/metrics",
       "an array of at least one value", "an empty array", Schema::refuses},
      {R"([{"op": "replace", "path": "/figures/2/metrics", "value": ["beauty"]}])", "/figures/2/metrics/0",
       "one of ", "\"beauty\"", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/figures/3/quantity", "value": "bottom"}])", "/figures/3/quantity",
       "top", "\"bottom\"", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/probes"}])", "/figures/3/quantity",
       "the id of a probe, of which this case has none", "\"top\"", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/figures/3/caption"}])", "/figures/3/caption",
       "a text that is not empty", "nothing: the key is missing", Schema::refuses},
  };
  return all;
}

/// What turns the footing into a case that is refused.
const std::vector<Malformed>& malformed_footings() {
  static const std::vector<Malformed> all = {
      // Bodies.
      {R"([{"op": "replace", "path": "/scene/bodies/1/upper/1", "value": "1.4 m"}])",
       "/scene/bodies/1/upper/1", "a body inside the grid, which ends at 1.2 m", "1.4 m",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/bodies/1/lower/0", "value": "-0.1 m"}])",
       "/scene/bodies/1/lower/0", "a body inside the grid, which begins at 0 m", "-0.1 m",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/bodies/1/lower/1", "value": "0.4 m"}])", "/scene/bodies/1",
       "a body clear of all others", "\"plate\", which overlaps \"lower\"", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/scene/bodies/1/ring/center"}])", "/scene/bodies/1/ring/center",
       "an array", "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/1/ring/center", "value": ["0.5 m"]}])",
       "/scene/bodies/1/ring/center", "an array of 2", "an array of 1", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/scene/bodies/1/ring/outer_radius"}])",
       "/scene/bodies/1/ring/outer_radius", "a length such as", "nothing: the key is missing",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/1/ring/outer_radius", "value": "5 cm"}])",
       "/scene/bodies/1/ring/outer_radius", "0.1", "0.05", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/bodies/1/ring/inner_radius", "value": "-5 cm"}])",
       "/scene/bodies/1/ring/inner_radius", "", "-0.05 m", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/bodies/1/ring/radius", "value": "5 cm"}])",
       "/scene/bodies/1/ring/radius", "one of the keys center, inner_radius, outer_radius", "\"radius\"",
       Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/bodies/0/density_ramp/final_density"}])",
       "/scene/bodies/0/density_ramp/final_density", "a density such as", "nothing: the key is missing",
       Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/bodies/0/density_ramp/duration"}])",
       "/scene/bodies/0/density_ramp/duration", "a time such as", "nothing: the key is missing",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/0/density_ramp/duration", "value": "0 s"}])",
       "/scene/bodies/0/density_ramp/duration", "above zero", "0 s", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/0/density_ramp/start", "value": "-1 s"}])",
       "/scene/bodies/0/density_ramp/start", "zero or above", "-1 s", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/0/density_ramp/final_density", "value": "20 kN/m^3"}])",
       "/scene/bodies/0/density_ramp/final_density", "a density such as", "a unit weight", Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/bodies/0/initial_stress/type"}])",
       "/scene/bodies/0/initial_stress/type", "one of uniform, geostatic", "nothing: the key is missing",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/0/initial_stress/type", "value": "geostatical"}])",
       "/scene/bodies/0/initial_stress/type", "one of uniform, geostatic", "(did you mean \"geostatic\"?)",
       Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/bodies/0/initial_stress/k0"}])",
       "/scene/bodies/0/initial_stress/k0", "a number", "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/bodies/0/initial_stress/surface"}])",
       "/scene/bodies/0/initial_stress/surface", "a length such as", "nothing: the key is missing",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/0/initial_stress/surface", "value": "0.4 m"}])",
       "/scene/bodies/0/initial_stress/surface", "not below the body's upper edge", "0.4 m",
       Schema::cannot_tell},
      {R"([{"op": "add", "path": "/scene/bodies/0/initial_stress/xx", "value": "1 Pa"}])",
       "/scene/bodies/0/initial_stress/xx", "one of the keys type, surface, k0", "\"xx\"", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/bodies/1/initial_stress/k0", "value": 1}])",
       "/scene/bodies/1/initial_stress/k0", "one of the keys type, xx, yy, zz, xy", "\"k0\"",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/1/initial_stress/xx", "value": "-10 kN"}])",
       "/scene/bodies/1/initial_stress/xx", "a pressure such as", "\"-10 kN\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/bodies/1/material/law", "value": "neo_hookean"}])",
       "/scene/bodies/1/initial_stress", "no initial stress with a law", "one", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/bodies/1/material/law", "value": "neo_hookian"}])",
       "/scene/bodies/1/material/law", "linear_elastic, zhang_elastic, mohr_coulomb, neo_hookean",
       "(did you mean \"neo_hookean\"?)", Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/bodies/1/initial_stress"}, {"op": "replace", "path": "/scene/bodies/1/material", "value": {"law": "neo_hookean", "youngs_modulus": "1 MPa"}}])",
       "/scene/bodies/1/material/poissons_ratio", "a number", "nothing: the key is missing", Schema::refuses},

      // Rigid bodies.
      {R"([{"op": "replace", "path": "/scene/rigid_bodies", "value": []}])", "/scene/rigid_bodies",
       "an array of at least one value", "an empty array", Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/rigid_bodies/0/name"}])", "/scene/rigid_bodies/0/name", "a name",
       "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/rigid_bodies/0/name", "value": "plate"}])",
       "/scene/rigid_bodies/0/name", "a name no other body has", "\"plate\"", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/scene/rigid_bodies/0/lower"}])", "/scene/rigid_bodies/0/lower",
       "an array", "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/rigid_bodies/0/upper", "value": ["0.2 m"]}])",
       "/scene/rigid_bodies/0/upper", "an array of 2", "an array of 1", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/rigid_bodies/0/upper/1", "value": "0.5 m"}])",
       "/scene/rigid_bodies/0/upper/1", "above the lower corner's", "0.5 m", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/rigid_bodies/0/constrains", "value": []}])",
       "/scene/rigid_bodies/0/constrains", "an array of at least one value", "an empty array",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/rigid_bodies/0/constrains", "value": ["z"]}])",
       "/scene/rigid_bodies/0/constrains/0", "one of x, y", "\"z\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/rigid_bodies/0/constrains", "value": ["y", "y"]}])",
       "/scene/rigid_bodies/0/constrains/1", "each component once", "\"y\" again", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/rigid_bodies/0/velocity/1", "value": "-1 mm"}])",
       "/scene/rigid_bodies/0/velocity/1", "a velocity such as", "\"-1 mm\", a length", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/rigid_bodies/0/angular_velocity", "value": "30 deg"}])",
       "/scene/rigid_bodies/0/angular_velocity", "an angular velocity such as \"0.5 rad/s\" (unit rad/s)",
       "\"30 deg\", an angle", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/rigid_bodies/0/start", "value": "-1 s"}])",
       "/scene/rigid_bodies/0/start", "zero or above", "-1 s", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/rigid_bodies/0/ramp", "value": "-1 s"}])",
       "/scene/rigid_bodies/0/ramp", "zero or above", "-1 s", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/rigid_bodies/0/speed", "value": "1 m/s"}])",
       "/scene/rigid_bodies/0/speed", "one of the keys name, lower, upper, constrains, velocity", "\"speed\"",
       Schema::refuses},

      // Surface loads.
      {R"([{"op": "replace", "path": "/scene/surface_loads/0/body", "value": "lover"}])",
       "/scene/surface_loads/0/body", "one of lower, plate", "\"lover\" (did you mean \"lower\"?)",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/surface_loads/0/body", "value": "plate"}])",
       "/scene/surface_loads/0/body", "a whole block", "\"plate\", a ring", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/scene/surface_loads/0/body"}])", "/scene/surface_loads/0/body",
       "one of lower, plate", "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/surface_loads/0/edge", "value": "top"}])",
       "/scene/surface_loads/0/edge", "one of x_lower, x_upper, y_lower, y_upper", "\"top\"",
       Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/surface_loads/0/from"}])", "/scene/surface_loads/0/from",
       "a length such as", "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/surface_loads/0/to"}])", "/scene/surface_loads/0/to",
       "a length such as", "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/surface_loads/0/to", "value": "0.2 m"}])",
       "/scene/surface_loads/0/to", "at least one particle", "0.2 m to 0.2 m", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/scene/surface_loads/0/traction"}])", "/scene/surface_loads/0/traction",
       "an array", "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/surface_loads/0/traction", "value": ["-2 kPa"]}])",
       "/scene/surface_loads/0/traction", "an array of 2", "an array of 1", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/surface_loads/0/traction/1", "value": "-2 kN"}])",
       "/scene/surface_loads/0/traction/1", "a pressure such as", "\"-2 kN\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/surface_loads/0/ramp", "value": "-1 s"}])",
       "/scene/surface_loads/0/ramp", "zero or above", "-1 s", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/sums_strain", "value": "yes"}])", "/scene/sums_strain",
       "true or false", "\"yes\"", Schema::refuses},

      // Probes.
      {R"([{"op": "replace", "path": "/probes/1/of", "value": "fotting"}])", "/probes/1/of",
       "one of footing, plug, lower, plate", "(did you mean \"footing\"?)", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/probes/2/of", "value": "plate"}])", "/probes/2/of",
       "one of footing, plug", "\"plate\"", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/probes/3/of", "value": "footing"}])", "/probes/3/of",
       "one of lower, plate", "\"footing\"", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/probes/4/of"}])", "/probes/4/of", "one of lower, plate",
       "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "remove", "path": "/probes/1/of"}])", "/probes/1", "either at or of", "neither",
       Schema::refuses},
      {R"([{"op": "add", "path": "/probes/1/at", "value": ["0 m", "0 m"]}])", "/probes/1", "either at or of",
       "both", Schema::refuses},
      {R"([{"op": "add", "path": "/probes/0/of", "value": "plate"}])", "/probes/0/of",
       "one of the keys id, quantity, at, component, every", "\"of\"", Schema::refuses},
      {R"([{"op": "add", "path": "/probes/6/of", "value": "plate"}])", "/probes/6/of",
       "one of the keys id, quantity, every", "\"of\"", Schema::refuses},
      {R"([{"op": "add", "path": "/probes/5/at", "value": ["0 m", "0 m"]}])", "/probes/5/at",
       "one of the keys id, quantity, component, every", "\"at\"", Schema::refuses},
      {R"([{"op": "add", "path": "/probes/4/component", "value": "y"}])", "/probes/4/component",
       "one of the keys id, quantity, of, every", "\"component\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/probes/3/component", "value": "xy"}])", "/probes/3/component",
       "one of x, y", "\"xy\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/probes/0/component", "value": "x"}])", "/probes/0/component",
       "one of xx, yy, zz, xy", "\"x\"", Schema::refuses},
      {R"([{"op": "add", "path": "/probes/2/component", "value": "x"}])", "/probes/2/component",
       "a component that footing constrains", "x, in which it has no reaction", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/probes/6/quantity", "value": "strain_energy"}])", "/probes/6/quantity",
       "strain energy needs linear_elastic or neo_hookean",
       "\"strain_energy\", but \"lower\" has another law", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/probes/0/at", "value": ["0.5 m", "0.9 m"]}])", "/probes/0/at",
       "a place within one particle spacing of a particle", "\"0.5 m\", \"0.9 m\", which hits none",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/probes/0/at", "value": ["0.95 m", "1.15 m"]}])", "/probes/0/at",
       "a place within one particle spacing of a particle", "which hits none", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/probes/0/quantity", "value": "temperature"}])", "/probes/0/quantity",
       "one of displacement, velocity, stress, reaction, weight", "\"temperature\"", Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/rigid_bodies"}, {"op": "remove", "path": "/snapshots"}, {"op": "remove", "path": "/figures"}, {"op": "remove", "path": "/probes/1"}])",
       "/probes/1/of", "the name of a rigid body, of which the scene has none", "\"footing\"",
       Schema::cannot_tell},

      // Snapshots.
      {R"([{"op": "replace", "path": "/snapshots/1/time", "value": "-1 s"}])", "/snapshots/1/time",
       "zero or above", "\"-1 s\"", Schema::refuses},
      {R"([{"op": "replace", "path": "/snapshots/1/time", "value": "0.1 m"}])", "/snapshots/1/time",
       "a time such as", "\"0.1 m\", a length", Schema::refuses},
      {R"([{"op": "replace", "path": "/snapshots/1/time", "value": "2.1 s"}])", "/snapshots/1/time",
       "a time before the run has ended", "\"2.1 s\", which is later", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/snapshots/2/probe", "value": "pressure"}])", "/snapshots/2/probe",
       "settlement", "\"pressure\"", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/snapshots/2/probe", "value": "setlement"}])", "/snapshots/2/probe",
       "settlement", "(did you mean \"settlement\"?)", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/snapshots/2/reaches", "value": "5 s"}])", "/snapshots/2/reaches",
       "a length such as", "\"5 s\", a time", Schema::refuses},
      {R"([{"op": "remove", "path": "/snapshots/2/reaches"}])", "/snapshots/2/reaches", "a length such as",
       "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "remove", "path": "/snapshots/2/probe"}])", "/snapshots/2/probe", "settlement",
       "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "replace", "path": "/snapshots/3/end", "value": false}])", "/snapshots/3/end", "true",
       "false", Schema::refuses},
      {R"([{"op": "add", "path": "/snapshots/3/time", "value": "1 s"}])", "/snapshots/3",
       "either time, or probe and reaches, or end", "more than one of them", Schema::refuses},
      {R"([{"op": "replace", "path": "/snapshots/3", "value": {}}])", "/snapshots/3",
       "either time, or probe and reaches, or end", "none of them", Schema::refuses},
      {R"([{"op": "replace", "path": "/snapshots/1/time", "value": "0 s"}])", "/snapshots/1",
       "each moment once", "the moment of an earlier one", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/probes/1"}])", "/snapshots/2/probe",
       "the id of a displacement probe, of which this case has none", "\"settlement\"", Schema::cannot_tell},

      // Figures.
      {R"([{"op": "replace", "path": "/figures/0/quantity", "value": "max_shear_stain"}])",
       "/figures/0/quantity", "one of displacement", "(did you mean \"max_shear_strain\"?)",
       Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/scene/sums_strain"}])", "/figures/0/quantity",
       "a scalar that the scene keeps", "which needs sums_strain to be true", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/snapshots"}])", "/figures/0/quantity",
       "a figure of the case's snapshots, of which it has none", "\"max_shear_strain\"", Schema::cannot_tell},
      {R"([{"op": "remove", "path": "/figures/0/quantity"}])", "/figures/0/quantity", "one of displacement",
       "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "add", "path": "/figures/0/references", "value": []}])", "/figures/0/references",
       "one of the keys id, kind, caption, panels, series, where, quantity", "\"references\"",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/figures/1/quantity", "value": "presure"}])", "/figures/1/quantity",
       "pressure", "(did you mean \"pressure\"?)", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/figures/1/references", "value": ["hencky"]}])",
       "/figures/1/references/0", "", "\"hencky\"", Schema::cannot_tell},
  };
  return all;
}

/// What turns the driven bar into a case that is refused.
const std::vector<Malformed>& malformed_waves() {
  static const std::vector<Malformed> all = {
      // One dimension has no more than one component.
      {R"([{"op": "add", "path": "/scene/bodies/0/ring", "value": {"center": ["0.5 m"], "outer_radius": "0.2 m"}}])",
       "/scene/bodies/0/ring", "one of the keys name, lower", "\"ring\"", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/bodies/0/initial_stress", "value": {"type": "uniform", "yy": "1 Pa"}}])",
       "/scene/bodies/0/initial_stress/yy", "one of the keys type, xx", "\"yy\"", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/rigid_bodies", "value": [{"name": "wall", "lower": ["0 m"], "upper": ["0.1 m"], "angular_velocity": "1 rad/s"}]}])",
       "/scene/rigid_bodies/0/angular_velocity", "one of the keys name", "\"angular_velocity\"",
       Schema::refuses},
      {R"([{"op": "add", "path": "/scene/rigid_bodies", "value": [{"name": "wall", "lower": ["0 m"], "upper": ["0.1 m"], "constrains": ["y"]}]}])",
       "/scene/rigid_bodies/0/constrains/0", "x", "\"y\"", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/surface_loads", "value": [{"body": "lower", "edge": "y_upper", "traction": ["1 Pa"]}]}])",
       "/scene/surface_loads/0/edge", "one of x_lower, x_upper", "\"y_upper\"", Schema::refuses},
      {R"([{"op": "add", "path": "/scene/surface_loads", "value": [{"body": "lower", "edge": "x_upper", "from": "0 m", "traction": ["1 Pa"]}]}])",
       "/scene/surface_loads/0/from", "one of the keys body, edge, traction, ramp", "\"from\"",
       Schema::refuses},
      {R"([{"op": "add", "path": "/probes/-", "value": {"id": "p", "quantity": "stress", "component": "yy", "at": ["0.5 m"], "every": "1 s"}}])",
       "/probes/1/component", "xx", "\"yy\"", Schema::cannot_tell},
      {R"([{"op": "add", "path": "/snapshots", "value": [{"end": true}]}, {"op": "add", "path": "/figures", "value": [{"id": "f", "kind": "fields", "quantity": "displacement", "caption": "C."}]}])",
       "/figures/0/quantity", "another dimension", "\"displacement\", which needs two dimensions",
       Schema::cannot_tell},

      // Driven motions.
      {R"([{"op": "remove", "path": "/scene/driven_motion/solution"}])", "/scene/driven_motion/solution",
       "one of standing_wave, axis_aligned", "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/driven_motion/solution", "value": "standing_waves"}])",
       "/scene/driven_motion/solution", "one of standing_wave", "(did you mean \"standing_wave\"?)",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/driven_motion/solution", "value": "axis_aligned"}])",
       "/scene/driven_motion/solution", "a motion in as many dimensions as the scene's",
       "\"axis_aligned\", which has 2", Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/driven_motion", "value": {"solution": "rotation"}}])",
       "/scene/driven_motion/angular_velocity", "an angular velocity such as", "nothing: the key is missing",
       Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/driven_motion", "value": {"solution": "rotation", "angular_velocity": "1 rad/s", "amplitude": "1 m"}}])",
       "/scene/driven_motion/amplitude", "one of the keys solution, angular_velocity, center",
       "\"amplitude\"", Schema::refuses},
      {R"([{"op": "remove", "path": "/scene/driven_motion/amplitude"}])", "/scene/driven_motion/amplitude",
       "a length such as", "nothing: the key is missing", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/driven_motion/amplitude", "value": "5 deg"}])",
       "/scene/driven_motion/amplitude", "a length such as", "\"5 deg\", an angle", Schema::refuses},
      {R"([{"op": "replace", "path": "/scene/driven_motion/amplitude", "value": "0.5 m"}])",
       "/scene/driven_motion/amplitude", "where the deformation gradient inverts", "0.5",
       Schema::cannot_tell},
      {R"([{"op": "add", "path": "/scene/driven_motion/period", "value": "1 s"}])",
       "/scene/driven_motion/period", "one of the keys solution, amplitude, length", "\"period\"",
       Schema::refuses},
      {R"([{"op": "add", "path": "/scene/driven_motion/center", "value": ["0 m"]}])",
       "/scene/driven_motion/center", "one of the keys solution, amplitude, length", "\"center\"",
       Schema::refuses},
      {R"([{"op": "add", "path": "/scene/bodies/0/velocity", "value": ["0 m/s"]}])",
       "/scene/bodies/0/velocity", "no velocity where driven_motion gives it", "an array of 1",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/bodies/0/material/law", "value": "linear_elastic"}])",
       "/scene/bodies/0/material/law", "neo_hookean, which standing_wave is of", "\"linear_elastic\"",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/driven_motion/solution", "value": "vibrating_bar"}, {"op": "replace", "path": "/scene/bodies/0/material", "value": {"law": "zhang_elastic", "youngs_modulus": "1 MPa"}}])",
       "/scene/bodies/0/material/law", "linear_elastic or neo_hookean", "\"zhang_elastic\"",
       Schema::cannot_tell},
      {R"([{"op": "replace", "path": "/scene/bodies/0/upper/0", "value": "0.5 m"}, {"op": "add", "path": "/scene/bodies/-", "value": {"name": "upper", "lower": ["0.5 m"], "upper": ["1 m"], "particles_per_cell": [2], "density": "1000 kg/m^3", "material": {"law": "neo_hookean", "youngs_modulus": "20 MPa", "poissons_ratio": 0.3}}}])",
       "/scene/bodies/1", "a body with the constant density and the moduli of the first", "an object",
       Schema::cannot_tell},
      {R"([{"op": "add", "path": "/scene/bodies/0/density_ramp", "value": {"final_density": "1 t/m^3", "duration": "1 s"}}])",
       "/scene/bodies/0", "a body with the constant density", "an object", Schema::cannot_tell},
  };
  return all;
}

void expect_refused(const Json& valid, const std::vector<Malformed>& all) {
  EXPECT_EQ(refusal_of(valid.dump()), "");
  for (const Malformed& malformed : all) {
    SCOPED_TRACE(malformed.patch);
    const Json text = valid.patch(Json::parse(malformed.patch));
    expect_message(refusal_of(text.dump()), "column.json", malformed.pointer, malformed.expected,
                   malformed.found);
  }
}

TEST(MalformedCase, is_refused_in_one_line_that_names_place_expected_and_found) {
  expect_refused(valid_case(), malformed_cases());
  expect_refused(footing_case(), malformed_footings());
  expect_refused(wave_case(), malformed_waves());
}

void expect_schema_to_tell(const Json& valid, const std::vector<Malformed>& all) {
  const auto violation = schema_violation(valid);
  EXPECT_FALSE(violation) << violation->pointer << ": " << violation->description;
  for (const Malformed& malformed : all) {
    const Json text = valid.patch(Json::parse(malformed.patch));
    EXPECT_EQ(schema_violation(text).has_value(), malformed.schema == Schema::refuses) << malformed.patch;
  }
}

TEST(MalformedCase, is_refused_by_the_schema_alone_where_a_schema_can_tell) {
  expect_schema_to_tell(valid_case(), malformed_cases());
  expect_schema_to_tell(footing_case(), malformed_footings());
  expect_schema_to_tell(wave_case(), malformed_waves());
}

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
