// What a scene does not use is free: to say a default is the same as to leave it out, to the last bit and
// byte, and what only watches changes nothing of what it watches.

#include <gtest/gtest.h>

#include <bit>
#include <set>
#include <string>
#include <vector>

#include "tests/support/case_texts.hpp"
#include "vv/case_schema.hpp"
#include "vv/record.hpp"

namespace mpm::vv {
namespace {

/// A bar that falls onto a fixed end, grows heavier, carries a load, and does not reach what lies above it.
Json bar() {
  return Json::parse(R"({
    "dimension": 1,
    "scheme": "cpgimp",
    "grid": { "cell_size": "0.1 m", "lower": ["0 m"], "upper": ["1.2 m"],
              "edges": { "x_lower": "fixed", "x_upper": "free" } },
    "bodies": [
      { "name": "bar", "lower": ["0 m"], "upper": ["0.5 m"], "particles_per_cell": [2], "density": "1000 kg/m^3",
        "density_ramp": { "final_density": "1500 kg/m^3", "duration": "20 ms" },
        "initial_stress": { "type": "uniform" },
        "material": { "law": "linear_elastic", "youngs_modulus": "1 MPa", "poissons_ratio": 0.3 } } ],
    "rigid_bodies": [{ "name": "plug", "lower": ["0.9 m"], "upper": ["1.1 m"] }],
    "surface_loads": [{ "body": "bar", "edge": "x_upper", "traction": ["-5 kPa"] }],
    "gravity": { "acceleration": ["-9.8 m/s^2"], "level": 10, "loading": { "type": "step" } },
    "time_step": { "stable_fraction": 0.3 },
    "termination": { "type": "at_displacement", "body": "bar", "displacement": "-1 m", "deadline": "40 ms" }
  })");
}

/// A disc that falls on soil which yields beside a block that stands in the way.
Json block() {
  return Json::parse(R"({
    "dimension": 2,
    "scheme": "cpgimp",
    "grid": { "cell_size": "0.1 m", "lower": ["0 m", "0 m"], "upper": ["1.2 m", "1.2 m"],
              "edges": { "x_lower": "roller", "x_upper": "free", "y_lower": "fixed", "y_upper": "free" } },
    "bodies": [
      { "name": "ground", "lower": ["0 m", "0 m"], "upper": ["0.8 m", "0.3 m"], "particles_per_cell": [2, 2],
        "density": "2000 kg/m^3", "initial_stress": { "type": "uniform" },
        "material": { "law": "mohr_coulomb", "youngs_modulus": "1 MPa", "poissons_ratio": 0.3,
                      "friction_angle": "20 deg", "cohesion": "1 kPa", "dilation_angle": "0 deg" } },
      { "name": "disc", "lower": ["0 m", "0.3 m"], "upper": ["0.4 m", "0.7 m"], "particles_per_cell": [2, 2],
        "density": "2000 kg/m^3", "ring": { "center": ["0.2 m", "0.5 m"], "outer_radius": "0.2 m" },
        "density_ramp": { "final_density": "4000 kg/m^3", "duration": "20 ms" },
        "material": { "law": "linear_elastic", "youngs_modulus": "1 MPa", "poissons_ratio": 0.3 } } ],
    "rigid_bodies": [{ "name": "plug", "lower": ["0.6 m", "0.3 m"], "upper": ["0.8 m", "0.5 m"] }],
    "surface_loads": [{ "body": "ground", "edge": "y_upper", "from": "0.4 m", "to": "0.6 m",
                        "traction": ["1 kPa", "-5 kPa"] }],
    "gravity": { "acceleration": ["0 m/s^2", "-9.8 m/s^2"], "level": 10, "loading": { "type": "step" } },
    "time_step": { "stable_fraction": 0.3 },
    "termination": { "type": "at_displacement", "body": "disc", "displacement": "-1 m", "deadline": "40 ms" }
  })");
}

Json with_scheme(Json scene, const char* scheme) {
  scene["scheme"] = scheme;
  return scene;
}

Json bar_of_points() { return with_scheme(bar(), "mpm"); }
Json block_of_fixed_domains() { return with_scheme(block(), "ugimp"); }

/// A bar of 1 m that is driven.
Json driven_bar() {
  Json scene = bar();
  for (const char* key : {"rigid_bodies", "surface_loads"}) scene.erase(key);
  Json& body = scene["bodies"][0];
  body["upper"] = {"1 m"};
  body["material"] = {{"law", "neo_hookean"}, {"youngs_modulus", "1 MPa"}, {"poissons_ratio", 0.3}};
  for (const char* key : {"density_ramp", "initial_stress"}) body.erase(key);
  scene["gravity"]["level"] = 0;
  scene["driven_motion"] = {{"solution", "standing_wave"}, {"amplitude", "1 cm"}};
  scene["termination"] = {{"type", "at_time"}, {"time", "20 ms"}};
  return scene;
}

/// A square that a vortex turns about its middle.
Json driven_block() {
  Json scene = driven_bar();
  scene["dimension"] = 2;
  scene["grid"] =
      Json::parse(R"({ "cell_size": "0.1 m", "lower": ["-1.4 m", "-1.4 m"], "upper": ["1.4 m", "1.4 m"],
      "edges": { "x_lower": "free", "x_upper": "free", "y_lower": "free", "y_upper": "free" } })");
  Json& body = scene["bodies"][0];
  body["lower"] = {"-1.3 m", "-1.3 m"};
  body["upper"] = {"1.3 m", "1.3 m"};
  body["particles_per_cell"] = {1, 1};
  scene["gravity"]["acceleration"] = {"0 m/s^2", "0 m/s^2"};
  scene["driven_motion"] = {{"solution", "generalised_vortex"}, {"amplitude", "1 deg"}};
  return scene;
}

/// A default, where in which scene it can be said.
struct Spelling {
  Json (*scene)();
  const char* pointer;
  Json value;
};

/// A key that a scene may leave out: the ways to say its default, or why there is none.
struct OptionalKey {
  const char* key;  ///< definition of the schema, then the key
  std::vector<Spelling> spellings;
  const char* why_none = "";
};

constexpr const char* only_absence = "nothing but its absence says that there is none";
constexpr const char* of_another_type = "required where the type has it";

const std::vector<OptionalKey>& optional_keys() {
  static const std::vector<OptionalKey> all = {
      {"scene.update_order", {{bar, "/update_order", "musl"}, {block, "/update_order", "musl"}}},
      {"scene.precision", {{bar, "/precision", "double"}, {block, "/precision", "double"}}},
      {"scene.objectivity", {{bar, "/objectivity", "none"}, {block, "/objectivity", "none"}}},
      {"scene.flip_fraction", {{bar, "/flip_fraction", 1}, {block, "/flip_fraction", 1}}},
      {"scene.damping", {{bar, "/damping", 0}, {block, "/damping", 0}}},
      {"scene.sums_strain", {{bar, "/sums_strain", false}, {block, "/sums_strain", false}}},
      {"scene.sums_work", {{bar, "/sums_work", false}, {block, "/sums_work", false}}},
      // Domains that do not grow have no use for a limit.
      {"scene.domain_limit",
       {{bar_of_points, "/domain_limit", 1}, {block_of_fixed_domains, "/domain_limit", 1}}},
      {"scene.compensated_sums", {{bar, "/compensated_sums", false}, {block, "/compensated_sums", false}}},
      {"scene.particle_order", {}, only_absence},
      {"scene.light_nodes", {}, only_absence},
      {"scene.model",
       {{bar, "/model", {{"precision", "as_written"}}}, {block, "/model", {{"dimension", "automatic"}}}}},
      {"model.dimension", {{block, "/model/dimension", "automatic"}}},
      {"model.precision",
       {{bar, "/model/precision", "as_written"}, {block, "/model/precision", "as_written"}}},
      {"scene.rigid_bodies", {}, only_absence},
      {"scene.surface_loads", {}, only_absence},
      {"scene.driven_motion", {}, only_absence},
      {"edges.y_lower", {}, "required in two dimensions"},
      {"edges.y_upper", {}, "required in two dimensions"},
      {"body.ring", {}, only_absence},
      {"body.density_ramp", {}, only_absence},
      {"body.anywhere", {{bar, "/bodies/0/anywhere", false}, {block, "/bodies/0/anywhere", true}}},
      {"body.inertia", {}, "one of the same size still keeps to itself when the density changes"},
      {"body.velocity",
       {{bar, "/bodies/0/velocity", {"0 m/s"}}, {block, "/bodies/1/velocity", {"0 m/s", "0 m/s"}}}},
      {"body.initial_stress", {{block, "/bodies/1/initial_stress", {{"type", "uniform"}}}}},
      {"body.locking_control",
       {{bar, "/bodies/0/locking_control", "none"}, {block, "/bodies/0/locking_control", "none"}}},
      {"ring.inner_radius", {{block, "/bodies/1/ring/inner_radius", "0 m"}}},
      {"density_ramp.start",
       {{bar, "/bodies/0/density_ramp/start", "0 s"}, {block, "/bodies/1/density_ramp/start", "0 s"}}},
      {"density_ramp.then", {}, only_absence},
      {"initial_stress.xx",
       {{bar, "/bodies/0/initial_stress/xx", "0 Pa"}, {block, "/bodies/0/initial_stress/xx", "0 Pa"}}},
      {"initial_stress.yy", {{block, "/bodies/0/initial_stress/yy", "0 Pa"}}},
      {"initial_stress.zz", {{block, "/bodies/0/initial_stress/zz", "0 Pa"}}},
      {"initial_stress.xy", {{block, "/bodies/0/initial_stress/xy", "0 Pa"}}},
      {"initial_stress.surface", {}, of_another_type},
      {"initial_stress.k0", {}, of_another_type},
      {"material.poissons_ratio", {}, of_another_type},
      {"material.friction_angle", {}, of_another_type},
      {"material.cohesion", {}, of_another_type},
      {"material.dilation_angle", {}, of_another_type},
      {"rigid_body.constrains",
       {{bar, "/rigid_bodies/0/constrains", {"x"}}, {block, "/rigid_bodies/0/constrains", {"x", "y"}}}},
      {"rigid_body.velocity",
       {{bar, "/rigid_bodies/0/velocity", {"0 m/s"}},
        {block, "/rigid_bodies/0/velocity", {"0 m/s", "0 m/s"}}}},
      {"rigid_body.angular_velocity", {{block, "/rigid_bodies/0/angular_velocity", "0 rad/s"}}},
      {"rigid_body.start", {{bar, "/rigid_bodies/0/start", "0 s"}, {block, "/rigid_bodies/0/start", "0 s"}}},
      {"rigid_body.ramp", {{bar, "/rigid_bodies/0/ramp", "0 s"}, {block, "/rigid_bodies/0/ramp", "0 s"}}},
      {"surface_load.from", {}, "required in two dimensions"},
      {"surface_load.to", {}, "required in two dimensions"},
      {"surface_load.ramp", {{bar, "/surface_loads/0/ramp", "0 s"}, {block, "/surface_loads/0/ramp", "0 s"}}},
      {"driven_motion.amplitude", {}, of_another_type},
      {"driven_motion.angular_velocity", {}, of_another_type},
      {"driven_motion.angular_frequency", {}, "a property of the ring, which no text says to the last bit"},
      {"driven_motion.length", {{driven_bar, "/driven_motion/length", "1 m"}}},
      {"driven_motion.period", {{driven_block, "/driven_motion/period", "2 s"}}},
      {"driven_motion.inner_radius", {{driven_block, "/driven_motion/inner_radius", "0.75 m"}}},
      {"driven_motion.outer_radius", {{driven_block, "/driven_motion/outer_radius", "1.25 m"}}},
      {"driven_motion.center", {{driven_block, "/driven_motion/center", {"0 m", "0 m"}}}},
      {"loading.duration", {}, of_another_type},
      {"loading.hold", {}, of_another_type},
      {"loading.fractions", {}, of_another_type},
      {"time_step.stable_fraction", {}, "one of two keys, of which one is required"},
      {"time_step.seconds", {}, "one of two keys, of which one is required"},
      {"termination.time", {}, of_another_type},
      {"termination.unbalanced_force_ratio", {}, of_another_type},
      {"termination.kinetic_energy_ratio", {}, of_another_type},
      {"termination.body", {}, of_another_type},
      {"termination.component",
       {{bar, "/termination/component", "x"}, {block, "/termination/component", "y"}}},
      {"termination.displacement", {}, of_another_type},
      {"termination.deadline", {}, of_another_type},
  };
  return all;
}

/// The keys an object of the schema lets be absent, and those of the objects it holds.
class OptionalKeysOfSchema {
 public:
  OptionalKeysOfSchema() : schema_(Json::parse(case_schema())) {
    collect("scene", schema_["definitions"]["scene"]);
  }

  const std::set<std::string>& keys() const { return keys_; }

 private:
  void collect(const std::string& name, const Json& object) {
    if (!object.contains("properties") || !seen_.insert(name).second) return;
    const Json required = object.value("required", Json::array());
    for (const auto& [key, value] : object.at("properties").items()) {
      if (std::find(required.begin(), required.end(), key) == required.end()) keys_.insert(name + "." + key);
      const Json& held = value.contains("items") ? value.at("items") : value;
      if (!held.contains("$ref")) {
        collect(key, held);
        continue;
      }
      const std::string reference = held.at("$ref");
      const std::string definition = reference.substr(reference.rfind('/') + 1);
      collect(definition, schema_.at("definitions").at(definition));
    }
  }

  Json schema_;
  std::set<std::string> seen_, keys_;
};

Record record_of(const Json& scene) {
  Json text = test::two_bodies();
  for (const char* key : {"sweep", "notes"}) text.erase(key);
  text["repeat_on_other_threads"] = false;
  text["scene"] = scene;
  text["probes"] = Json::array();
  const Case definition = test::parsed(text);
  return unsigned_record(definition, definition.runs.front(), {});
}

/// All that a record says of a run, without how long it took and what was asked.
Json outcome_of(const Record& record) {
  Json json = to_json(record);
  json.erase("input_hash");
  for (const char* of_time : {"wall_seconds", "early_seconds", "early_steps"}) json["cost"].erase(of_time);
  return json;
}

TEST(UnusedFeatures, every_optional_key_of_the_schema_is_put_to_the_test) {
  const std::set<std::string> in_schema = OptionalKeysOfSchema().keys();
  EXPECT_GE(in_schema.size(), 50u);
  std::set<std::string> tested;
  for (const OptionalKey& optional : optional_keys()) {
    EXPECT_TRUE(tested.insert(optional.key).second) << optional.key << " twice";
    EXPECT_EQ(optional.spellings.empty(), *optional.why_none != '\0') << optional.key;
  }
  for (const std::string& key : in_schema) {
    EXPECT_TRUE(tested.contains(key)) << key << ": say its default here, or why it has none";
  }
  for (const std::string& key : tested) EXPECT_TRUE(in_schema.contains(key)) << key << " is no optional key";
}

TEST(UnusedFeatures, a_default_that_is_said_changes_no_bit_and_no_byte) {
  for (const OptionalKey& optional : optional_keys()) {
    for (const auto& [scene_of, pointer, value] : optional.spellings) {
      const Json absent = scene_of();
      Json said = absent;
      const Json::json_pointer place(pointer);
      ASSERT_FALSE(said.contains(place)) << optional.key << " is not absent";
      said[place] = value;
      const Record without = record_of(absent), with = record_of(said);
      ASSERT_EQ(without.failure, "") << optional.key;
      EXPECT_GT(without.outcome.step, 20) << optional.key;
      EXPECT_EQ(with.digest, without.digest) << optional.key;
      EXPECT_EQ(with.cost.memory_bytes, without.cost.memory_bytes) << optional.key;
      EXPECT_TRUE(outcome_of(with) == outcome_of(without)) << optional.key << ": records differ";
    }
  }
}

/// The words of an enumeration and of flags are also told apart from their defaults by what they do.
TEST(UnusedFeatures, what_is_not_the_default_is_told_from_it) {
  struct Other {
    Json (*scene)();
    const char* pointer;
    Json value;
  };
  for (const auto& [scene_of, pointer, value] :
       {Other{bar, "/update_order", "usl"}, Other{block, "/precision", "float"},
        Other{block, "/objectivity", "jaumann"}, Other{bar, "/flip_fraction", 0.9},
        Other{block, "/damping", 0.1}, Other{block, "/sums_strain", true}, Other{bar, "/sums_work", true},
        Other{block, "/compensated_sums", true}, Other{block, "/particle_order", {{"shuffle", 1}}},
        Other{block, "/domain_limit", 0.2501}, Other{block, "/bodies/0/locking_control", "cell_average"},
        Other{bar, "/bodies/0/density_ramp/start", "10 ms"}, Other{bar, "/surface_loads/0/ramp", "10 ms"},
        Other{driven_block, "/driven_motion/period", "1 s"}}) {
    const Json absent = scene_of();
    Json said = absent;
    said[Json::json_pointer(pointer)] = value;
    EXPECT_FALSE(outcome_of(record_of(said)) == outcome_of(record_of(absent))) << pointer;
  }
}

// ---- what only watches, and what lies out of reach ----

ParticleFields final_state(const Json& scene) {
  Json text = test::two_bodies();
  for (const char* key : {"sweep", "notes"}) text.erase(key);
  text["scene"] = scene;
  text["probes"] = Json::array();
  Simulation simulation(test::parsed(text).runs.front().scene);
  while (simulation.advance()) {
  }
  return simulation.particles();
}

std::vector<std::uint64_t> bits_of(const ParticleFields& fields) {
  std::vector<std::uint64_t> bits;
  for (const auto* values :
       {&fields.initial_position, &fields.displacement, &fields.position, &fields.velocity, &fields.half_size,
        &fields.stress, &fields.volume, &fields.initial_volume, &fields.mass}) {
    for (const double value : *values) bits.push_back(std::bit_cast<std::uint64_t>(value));
  }
  return bits;
}

TEST(UnusedFeatures, sums_change_no_bit_of_what_they_watch) {
  for (const char* order : {"usl", "usf", "musl"}) {
    for (Json plain : {bar(), block()}) {
      plain["update_order"] = order;
      for (const char* sums : {"sums_strain", "sums_work"}) {
        Json watched = plain;
        watched[sums] = true;
        EXPECT_EQ(bits_of(final_state(watched)), bits_of(final_state(plain))) << order << " " << sums;
      }
    }
  }
}

TEST(UnusedFeatures, a_limit_no_domain_reaches_changes_no_bit) {
  for (const Json& plain : {bar(), block()}) {
    Json limited = plain;
    limited["domain_limit"] = 1;
    EXPECT_EQ(bits_of(final_state(limited)), bits_of(final_state(plain)));
  }
}

TEST(UnusedFeatures, an_empty_part_of_the_grid_changes_no_bit) {
  Json high = block(), wide = block();
  high["grid"]["upper"][1] = "2.4 m";
  wide["grid"]["upper"][0] = "3.1 m";
  const std::vector<std::uint64_t> plain = bits_of(final_state(block()));
  EXPECT_EQ(bits_of(final_state(high)), plain);
  EXPECT_EQ(bits_of(final_state(wide)), plain);
  Json long_bar = bar();
  long_bar["grid"]["upper"][0] = "2.4 m";
  EXPECT_EQ(bits_of(final_state(long_bar)), bits_of(final_state(bar())));
}

TEST(UnusedFeatures, a_rigid_body_out_of_reach_changes_no_bit) {
  Json without_bar = bar(), with_block = block();
  without_bar.erase("rigid_bodies");
  EXPECT_EQ(bits_of(final_state(without_bar)), bits_of(final_state(bar())));
  with_block["rigid_bodies"].push_back(Json::parse(
      R"({ "name": "cloud", "lower": ["0.2 m", "1.1 m"], "upper": ["0.4 m", "1.2 m"], "velocity": ["0 m/s", "1 mm/s"] })"));
  EXPECT_EQ(bits_of(final_state(with_block)), bits_of(final_state(block())));
}

}  // namespace
}  // namespace mpm::vv
