#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "benchmarks/features.hpp"
#include "benchmarks/scenes.hpp"
#include "vv/json_reader.hpp"

namespace mpm::bench {
namespace {

Json scene_in(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw std::runtime_error(file.string() + ": cannot read");
  return vv::parse_json(text).at("scene");
}

void set_leanest_method(Json& scene) {
  scene["scheme"] = "ugimp";
  scene["update_order"] = "usl";
  scene.erase("damping");
  scene["termination"] = {{"type", "at_time"}, {"time", "1000000 s"}};
}

/// The paper's footing before its block grows heavier, all of it elastic. The ground is in the active state,
/// so that one of soil yields everywhere.
Json footing() {
  Json scene = scene_in(footing_case());
  set_leanest_method(scene);
  scene["time_step"] = {{"stable_fraction", 0.5}};
  Json &ground = scene["bodies"][0], &block = scene["bodies"][1];
  const double phi = 20.0 / 180.0 * std::numbers::pi;
  ground["initial_stress"]["k0"] = std::pow(std::tan(std::numbers::pi / 4 - phi / 2), 2);
  ground["material"] = {{"law", "linear_elastic"}, {"youngs_modulus", "1000 kPa"}, {"poissons_ratio", 0.3}};
  block.erase("density_ramp");
  return scene;
}

/// The column of Figure 1 with two particles a cell, under 1G.
Json column() {
  Json scene = scene_in(project_root() / "vv" / "cases" / "column_figure_1.json");
  set_leanest_method(scene);
  scene["gravity"]["level"] = 1;
  scene["bodies"][0]["particles_per_cell"] = {2};
  return scene;
}

/// The same column in plane strain, four cells wide between smooth walls.
Json strip() {
  Json scene = column();
  scene["dimension"] = 2;
  const auto across = [](Json& place, const char* first) { place = {first, place.at(0)}; };
  across(scene["grid"]["lower"], "0 m");
  across(scene["grid"]["upper"], "0.08 m");
  const Json ends = scene["grid"]["edges"];
  scene["grid"]["edges"] = {{"x_lower", "roller"},
                            {"x_upper", "roller"},
                            {"y_lower", ends["x_lower"]},
                            {"y_upper", ends["x_upper"]}};
  Json& body = scene["bodies"][0];
  across(body["lower"], "0 m");
  across(body["upper"], "0.08 m");
  body["particles_per_cell"] = {2, 2};
  across(scene["gravity"]["acceleration"], "0 m/s^2");
  return scene;
}

using Change = std::function<void(Json& scene)>;

Change nothing() {
  return [](Json&) {};
}

/// Sets the value at a pointer.
Change set(const char* pointer, Json value) {
  return [pointer = Json::json_pointer(pointer), value](Json& scene) { scene[pointer] = value; };
}

Change remove_key(const char* key) {
  return [key](Json& scene) { scene.erase(key); };
}

FeatureScene changed(Json scene, const char* what, const Change& change, int threads = 1) {
  change(scene);
  return {what, std::move(scene), threads};
}

FeatureScene unwatched(FeatureScene scene) {
  scene.watched = false;
  return scene;
}

Change soil(const char* cohesion) {
  return set("/bodies/0/material", {{"law", "mohr_coulomb"},
                                    {"youngs_modulus", "1000 kPa"},
                                    {"poissons_ratio", 0.3},
                                    {"friction_angle", "20 deg"},
                                    {"cohesion", cohesion},
                                    {"dilation_angle", "0 deg"}});
}

/// The block's place taken by a box that moves down at 10 mm/s.
void make_rigid(Json& scene) {
  const Json block = scene["bodies"][1];
  scene["bodies"].erase(1);
  scene["rigid_bodies"] = Json::array({{{"name", block["name"]},
                                        {"lower", block["lower"]},
                                        {"upper", block["upper"]},
                                        {"velocity", {"0 m/s", "-10 mm/s"}}}});
}

void widen_ground(Json& scene) {
  scene["grid"]["upper"][0] = "0.52 m";
  scene["bodies"][0]["upper"][0] = "0.52 m";
}

/// A feature that a key of the scene switches on, and another value of the key off.
Feature keyed(const char* name, const char* title, const char* pointer, const char* on, const Json& on_value,
              const char* off, const Json& off_value) {
  return {name,
          title,
          {"none", footing()},
          changed(footing(), on, set(pointer, on_value)),
          Spelled{changed(footing(), off, set(pointer, off_value))}};
}

std::vector<Feature> of_the_particles() {
  const Change mohr_coulomb_at_rest = soil("1 MPa"), mohr_coulomb_on_the_limit = soil("0 Pa");
  return {
      {"feature/plastic_law",
       "plastic law, never reached",
       {"linear elastic", footing()},
       changed(footing(), "Mohr–Coulomb, all of it elastic", mohr_coulomb_at_rest),
       std::nullopt},
      {"feature/plastic_return",
       "plastic return",
       {"linear elastic", footing()},
       changed(footing(), "Mohr–Coulomb, on the limit, yielding where it moves", mohr_coulomb_on_the_limit),
       std::nullopt},
      keyed("feature/damping", "local damping", "/damping", "α = 0.8", 0.8, "damping: 0", 0),
      keyed("feature/rotation", "rotation of the stress", "/objectivity", "Jaumann", "jaumann",
            "objectivity: none", "none"),
      {"feature/domains",
       "domains",
       changed(footing(), "MPM, points", set("/scheme", "mpm")),
       {"uGIMP", footing()},
       Spelled{changed(footing(), "domain_limit: 1",
                       [](Json& scene) {
                         scene["scheme"] = "mpm";
                         scene["domain_limit"] = 1;
                       })}},
      {"feature/domain_update",
       "update of the domains",
       {"uGIMP", footing()},
       changed(footing(), "cpGIMP", set("/scheme", "cpgimp")),
       Spelled{changed(footing(), "domain_limit: 1", set("/domain_limit", 1))}},
      keyed("feature/strain_sums", "sums of strain", "/sums_strain", "summed", true, "sums_strain: false",
            false),
      keyed("feature/work_sums", "sums of work", "/sums_work", "summed", true, "sums_work: false", false),
      keyed("feature/compensated_sums", "compensated sums", "/compensated_sums", "what rounding cuts off is kept", true,
            "compensated_sums: false", false),
      {"feature/light_nodes",
       "light nodes",
       changed(footing(), "MPM, points", set("/scheme", "mpm")),
       changed(footing(), "MPM, light nodes made slow",
               [](Json& scene) {
                 scene["scheme"] = "mpm";
                 scene["light_nodes"] = 0.5;
               }),
       std::nullopt},
      {"feature/energy_watch",
       "watch over energy",
       unwatched({"nobody looks", footing()}),
       {"a look every 64 steps, as in every run", footing()},
       std::nullopt},
      keyed("feature/locking_control", "locking control", "/bodies/0/locking_control",
            "averages over cells in the ground", "cell_average", "locking_control: none", "none"),
  };
}

std::vector<Feature> of_the_loads() {
  const Json surcharge = Json::parse(R"([{ "body": "ground", "edge": "y_upper", "from": "0.04 m",
      "to": "0.26 m", "traction": ["0 Pa", "-1 kPa"], "ramp": "1 s" }])");
  const Json ramp = {{"final_density", "16650 kg/m^3"}, {"duration", "1.9 s"}};
  return {
      {"feature/surface_loads",
       "surface loads",
       {"none", footing()},
       changed(footing(), "a surcharge beside the block", set("/surface_loads", surcharge)),
       std::nullopt},
      {"feature/density_ramp",
       "density that changes",
       {"constant", footing()},
       changed(footing(), "the block grows heavier", set("/bodies/1/density_ramp", ramp)),
       std::nullopt},
      {"feature/block_footing",
       "footing of particles",
       changed(footing(), "rigid body on the grid", make_rigid),
       {"512 particles, 20 times as stiff as the ground", footing()},
       std::nullopt},
  };
}

std::vector<Feature> of_the_method() {
  const Change musl = remove_key("update_order");
  return {
      {"feature/second_mapping",
       "second mapping",
       {"USL", footing()},
       changed(footing(), "MUSL", musl),
       Spelled{changed(footing(), "update_order: musl", set("/update_order", "musl")), true}},
      {"feature/double_precision",
       "double precision",
       changed(footing(), "float", set("/precision", "float")),
       {"double", footing()},
       Spelled{changed(footing(), "precision: double", set("/precision", "double")), true}},
      {"feature/second_dimension",
       "second dimension",
       {"column, 50 cells of 2 particles", column()},
       {"strip, 4 × 50 cells of 2 × 2 particles", strip()},
       std::nullopt},
      {"feature/far_field",
       "far field at rest",
       {"ground 0.26 m wide", footing()},
       changed(footing(), "ground 0.52 m wide", widen_ground),
       std::nullopt},
      {"feature/wide_grid",
       "empty grid to the side",
       {"grid 0.26 m wide", footing()},
       changed(footing(), "grid 0.52 m wide, the same particles", set("/grid/upper/0", "0.52 m")),
       std::nullopt},
      {"feature/high_grid",
       "empty grid above",
       {"grid 0.30 m high", footing()},
       changed(footing(), "grid 0.60 m high, the same particles", set("/grid/upper/1", "0.60 m")),
       std::nullopt},
      {"feature/threads", "a second thread asked for in a scene too small for it",
       changed(column(), "one thread", nothing(), 1), changed(column(), "two threads", nothing(), 2),
       std::nullopt},
  };
}

}  // namespace

std::vector<Feature> features() {
  std::vector<Feature> all;
  for (const auto& part : {of_the_particles(), of_the_loads(), of_the_method()}) {
    for (const Feature& feature : part) {
      if (std::max(feature.without.threads, feature.with.threads) <= available_threads())
        all.push_back(feature);
    }
  }
  return all;
}

}  // namespace mpm::bench
