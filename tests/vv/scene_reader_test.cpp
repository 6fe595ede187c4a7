#include "vv/scene_reader.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "reference/manufactured.hpp"
#include "tests/support/case_texts.hpp"
#include "vv/case_schema.hpp"

namespace mpm::vv {
namespace {

using namespace mpm::test;

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

  text["scene"]["termination"] = {{"type", "at_displacement"}, {"body", text["scene"]["bodies"][0]["name"]},
                                  {"displacement", "-2 mm"},   {"deadline", "3 s"}};
  const AtDisplacement end = std::get<AtDisplacement>(parsed(text).runs.front().scene.termination);
  EXPECT_EQ(end.body, text["scene"]["bodies"][0]["name"].get<std::string>());
  EXPECT_EQ(end.axis, 0);
  EXPECT_EQ(end.displacement, -0.002);
  EXPECT_EQ(end.deadline, 3.0);

  text["scene"]["gravity"]["loading"] = {{"type", "step"}};
  EXPECT_TRUE(std::holds_alternative<StepLoading>(parsed(text).runs.front().scene.gravity.loading));
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

TEST(CaseFile, reads_what_bodies_start_from) {
  const Scene scene = parsed(footing_case()).runs.front().scene;
  const Body& ground = scene.bodies[0];
  ASSERT_TRUE(ground.density_ramp);
  EXPECT_EQ(ground.density_ramp->stages.at(0).density, 2000.0);
  EXPECT_EQ(ground.density_ramp->start, 0.1);
  EXPECT_EQ(ground.density_ramp->stages.at(0).duration, 1.0);
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

TEST(CaseFile, reads_locking_control) {
  Json text = footing_case();
  EXPECT_EQ(parsed(text).runs.front().scene.bodies[0].locking_control, LockingControl::none);
  text["scene"]["bodies"][0]["locking_control"] = "cell_average";
  text["scene"]["bodies"][1]["locking_control"] = "none";
  EXPECT_FALSE(schema_violation(text));
  const Scene scene = parsed(text).runs.front().scene;
  EXPECT_EQ(scene.bodies[0].locking_control, LockingControl::cell_average);
  EXPECT_EQ(scene.bodies[1].locking_control, LockingControl::none);
}

TEST(CaseFile, refuses_locking_control_in_one_dimension) {
  Json text = valid_case();
  text["scene"]["bodies"][0]["locking_control"] = "cell_average";
  expect_message(refusal_of(text.dump()), "column.json", "/scene/bodies/0/locking_control",
                 "none in one dimension", "cell_average");
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

TEST(CaseFile, turns_a_vortex_either_way) {
  const auto moved = [](const char* amplitude) {
    const Json vortex = {{"solution", "generalised_vortex"}, {"amplitude", amplitude}};
    return parsed(driven_square(vortex)).runs.front().motion->displacement({1.0, 0.0}, 0.5)[1];
  };
  EXPECT_GT(moved("30 deg"), 0.1);
  EXPECT_EQ(moved("-30 deg"), -moved("30 deg"));
}

}  // namespace
}  // namespace mpm::vv
