// Which scenes are those of footings, and the load-settlement curve that their probes leave.

#include "vv/load_curve.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/footing_scenes.hpp"
#include "vv/norms.hpp"

namespace mpm::vv {
namespace {

using namespace mpm::test;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

struct Recorded {
  HistoryProbe probe;
  std::vector<double> time, value;
};

Recorded recorded(const std::string& quantity, const std::string& of, const std::string& component,
                  const std::vector<double>& time, const std::vector<double>& value) {
  return {{.id = of + "_" + quantity, .quantity = quantity, .component = component, .of = of, .every = 1.0},
          time,
          value};
}

/// A case with these probes, and the record of its only run.
struct Sampled {
  Case definition;
  Record record;

  explicit Sampled(const std::vector<Recorded>& all) {
    for (const Recorded& each : all) {
      definition.probes.push_back(each.probe);
      record.histories.push_back({each.probe.id, each.probe.quantity, each.time, each.value});
    }
  }

  std::optional<LoadCurve> curve(const Scene& scene) const {
    return load_curve_of(definition, scene, record);
  }
};

void expect_near(const std::vector<double>& values, const std::vector<double>& expected) {
  ASSERT_EQ(values.size(), expected.size());
  for (std::size_t k = 0; k < values.size(); ++k) EXPECT_NEAR(values[k], expected[k], 1e-9) << k;
}

struct Change {
  const char* expected;
  std::function<void(Scene&)> change;
};

void expect_no_footing(const Scene& footing, const std::vector<Change>& changes) {
  EXPECT_EQ(why_no_footing(footing), "");
  for (const Change& change : changes) {
    Scene scene = footing;
    change.change(scene);
    EXPECT_EQ(why_no_footing(scene), change.expected);
  }
}

// ---- rigid strips

/// The half model with a smooth shaft above the strip's base.
Scene with_shaft() {
  Scene scene = half_model(clay());
  RigidBody shaft = scene.rigid_bodies[0];
  shaft.name = "shaft";
  shaft.lower[1] = 2.1;
  shaft.upper[1] = 2.4;
  shaft.constrains = {true, false};
  scene.rigid_bodies.insert(scene.rigid_bodies.begin(), shaft);
  return scene;
}

TEST(FootingWithShaft, IsTheBodyThatConstrainsItsVerticalMotion) {
  const Scene scene = with_shaft();
  EXPECT_EQ(why_no_footing(scene), "");
  const Footing footing = footing_of(scene);
  EXPECT_EQ(footing.strip, &scene.rigid_bodies[1]);
  EXPECT_FALSE(footing.block);
  EXPECT_EQ(footing.roughness(), reference::Roughness::rough);
  EXPECT_EQ(footing.width, 0.4);
  const Sampled run({recorded("reaction", "shaft", "x", {0, 1, 2}, {7, 7, 7}),
                     recorded("reaction", "strip", "y", {0, 1, 2}, {7, 4, 8})});
  EXPECT_EQ(why_no_load_curve(run.definition, scene), "");
  expect_near(run.curve(scene)->settlement, {0.05, 0.15});
  expect_near(run.curve(scene)->pressure, {10, 20});
}

TEST(FootingWithShaft, StandsOnAFixedOrRollerBase) {
  Scene scene = with_shaft();
  scene.edges[1][0] = Condition::roller;
  EXPECT_EQ(why_no_footing(scene), "");
  scene.edges[1][0] = Condition::free;
  EXPECT_EQ(why_no_footing(scene), "ground that stands on a fixed or roller y_lower edge");
}

TEST(FootingWithShaft, RefusesBodiesThatAreNoShaft) {
  const char* only_shafts =
      "no rigid body beside the one that presses but such as constrain x only, move with it and stay above "
      "its "
      "base, within its width";
  const auto shaft = [](Scene& s) -> RigidBody& { return s.rigid_bodies[0]; };
  expect_no_footing(
      with_shaft(),
      {{only_shafts, [&](Scene& s) { shaft(s).velocity[1] = -0.2; }},
       {only_shafts, [&](Scene& s) { shaft(s).velocity[0] = 0.1; }},
       {only_shafts, [&](Scene& s) { shaft(s).angular_velocity = 0.1; }},
       {only_shafts, [&](Scene& s) { shaft(s).start = 1.0; }},
       {only_shafts, [&](Scene& s) { shaft(s).ramp = 1.0; }},
       {only_shafts, [&](Scene& s) { shaft(s).lower[1] = 2.0; }},
       {only_shafts, [&](Scene& s) { shaft(s).lower[0] = -0.5; }},
       {only_shafts, [&](Scene& s) { shaft(s).upper[0] = 0.5; }},
       {only_shafts, [&](Scene& s) { s.rigid_bodies.push_back(s.rigid_bodies[1]); }},
       {"a rigid body that constrains its vertical motion", [&](Scene& s) { s.rigid_bodies.pop_back(); }}});
}

// ---- blocks

TEST(BlockFooting, IsTheBodyWhoseDensityChanges) {
  Scene scene = block_model(clay());
  for (int order = 0; order < 2; ++order) {
    EXPECT_EQ(why_no_footing(scene), "");
    EXPECT_EQ(why_not_only_pressed(scene), "");
    const Footing footing = footing_of(scene);
    ASSERT_TRUE(footing.block);
    EXPECT_EQ(footing.block->name, "block");
    EXPECT_EQ(footing.ground->name, "ground");
    EXPECT_FALSE(footing.strip);
    EXPECT_TRUE(footing.half);
    EXPECT_EQ(footing.width, 0.4);
    EXPECT_EQ(footing.full_width(), 0.8);
    EXPECT_EQ(footing.weight, 20000.0);
    EXPECT_EQ(footing.roughness(), reference::Roughness::rough);
    std::swap(scene.bodies[0], scene.bodies[1]);
  }
  scene.bodies[1].lower[0] = 1.6;
  scene.bodies[1].upper[0] = 2.4;
  EXPECT_EQ(footing_of(scene).full_width(), 2.4 - 1.6);
}

TEST(BlockFooting, NamesWhatIsMissing) {
  const char* one_grows = "one block of ground and one on it whose density changes";
  expect_no_footing(
      block_model(clay()),
      {{one_grows, [](Scene& s) { s.bodies[1].density_ramp.reset(); }},
       {one_grows,
        [](Scene& s) {
          s.bodies[0].density_ramp = DensityRamp{0, {{1, 1}}};
        }},
       {"blocks without a ring",
        [](Scene& s) {
          s.bodies[1].ring = Ring{{0, 2}, 0, 1};
        }},
       {"blocks without a ring",
        [](Scene& s) {
          s.bodies[0].ring = Ring{{0, 2}, 0, 1};
        }},
       {"gravity that lets the block press on the ground", [](Scene& s) { s.gravity.level = 0.0; }},
       {"no surface load on the block that presses",
        [](Scene& s) {
          s.surface_loads = {{"block", 1, 1, 0.0, 0.4, {0.0, -1.0}, 0.0}};
        }},
       {"a block that starts on the ground's surface", [](Scene& s) { s.bodies[1].lower[1] = 2.1; }},
       {"ground that reaches beyond the footing", [](Scene& s) { s.bodies[1].upper[0] = 4.0; }},
       {"ground that reaches beyond the footing on its left too, or to a roller at its axis",
        [](Scene& s) { s.edges[0][0] = Condition::fixed; }},
       {"ground that stands on a fixed or roller y_lower edge", [](Scene& s) { s.bodies[0].lower[1] = 0.1; }},
       {"a single block of ground", [](Scene& s) { s.rigid_bodies.push_back({.name = "wall"}); }},
       {"a rigid body, or a block whose density changes, on the ground",
        [](Scene& s) { s.bodies.pop_back(); }}});
}

TEST(BlockFooting, PressesByItsWeightAndSettlesFromTheRampsStart) {
  // The ramp begins at 2 s, between two samples of the descent and at one of the weight.
  const Sampled run({recorded("displacement", "block", "y", {0.5, 1.5, 2.5, 3.5, 4.5}, {-1, -3, -5, -6, -10}),
                     recorded("weight", "block", "", {1, 2, 3, 4, 5}, {40, 40, 80, 120, 160})});
  const Scene scene = block_model(clay());
  EXPECT_EQ(why_no_load_curve(run.definition, scene), "");
  const std::optional<LoadCurve> curve = run.curve(scene);
  ASSERT_TRUE(curve);
  expect_near(curve->settlement, {0, 1, 2, 6});
  expect_near(curve->pressure, {100, 150, 250, 350});
}

TEST(BlockFooting, EndsWithTheShorterOfItsProbes) {
  const Sampled run({recorded("displacement", "block", "y", {1, 2, 3, 4, 5}, {0, 0, -1, -2, -3}),
                     recorded("weight", "block", "", {1, 2, 3.5}, {40, 40, 100})});
  expect_near(run.curve(block_model(clay()))->settlement, {0, 1});
  expect_near(run.curve(block_model(clay()))->pressure, {100, 200});
  const Sampled early({recorded("displacement", "block", "y", {0.5, 1.5}, {0, 0}),
                       recorded("weight", "block", "", {0.5, 1.5}, {40, 40})});
  EXPECT_FALSE(early.curve(block_model(clay())));
}

TEST(BlockFooting, NeedsBothProbes) {
  const Scene scene = block_model(clay());
  const std::vector<double> time{1, 2, 3}, value{4, 4, 4};
  const Recorded weight = recorded("weight", "block", "", time, value);
  const Recorded descent = recorded("displacement", "block", "y", time, value);
  const Recorded sideways = recorded("displacement", "block", "x", time, value);
  const Recorded of_ground = recorded("displacement", "ground", "y", time, value);
  const Sampled no_weight({descent}), no_descent({weight, sideways, of_ground});
  EXPECT_EQ(why_no_load_curve(no_weight.definition, scene), "a probe of the load or the weight of block");
  EXPECT_EQ(why_no_load_curve(no_descent.definition, scene),
            "a probe of the displacement of block, component y");
  EXPECT_FALSE(no_weight.curve(scene));
  EXPECT_FALSE(no_descent.curve(scene));
  const Sampled both({sideways, of_ground, weight, descent});
  EXPECT_EQ(why_no_load_curve(both.definition, scene), "");
  EXPECT_TRUE(both.curve(scene));
}

TEST(LoadCurve, IsThatOfTheLoadWhateverPresses) {
  const std::vector<double> time{1, 2, 3, 4}, load{40, 40, 80, 120}, descent{0, 0, -1, -2};
  const Sampled by_weight(
      {recorded("displacement", "block", "y", time, descent), recorded("weight", "block", "", time, load)});
  const Sampled by_load(
      {recorded("displacement", "block", "y", time, descent), recorded("load", "block", "", time, load)});
  expect_near(by_load.curve(block_model(clay()))->pressure, by_weight.curve(block_model(clay()))->pressure);
  const Sampled reaction({recorded("reaction", "strip", "y", time, load)});
  const Sampled rigid_load({recorded("load", "strip", "", time, load)});
  expect_near(rigid_load.curve(half_model(clay()))->pressure, reaction.curve(half_model(clay()))->pressure);
}

// ---- runs that break off

TEST(LoadCurveOfABrokenRun, EndsBeforeTheFirstSampleThatIsNoNumber) {
  Sampled run({recorded("reaction", "strip", "y", {0, 1, 2, 3, 4}, {0, 4, 8, not_a_number, 16})});
  EXPECT_EQ(run.curve(half_model(clay()))->pressure.size(), 4u);
  run.record.outcome.ending = Ending::not_finite;
  expect_near(run.curve(half_model(clay()))->settlement, {0.05, 0.15});
  expect_near(run.curve(half_model(clay()))->pressure, {10, 20});
  run.record.histories[0].value[1] = not_a_number;
  EXPECT_FALSE(run.curve(half_model(clay())));
  run.record.histories.clear();  // as of a run that threw
  EXPECT_FALSE(run.curve(half_model(clay())));
}

TEST(LoadCurveOfABrokenRun, IsDrawnWithItsReferencesButNotJudgedByThem) {
  Sampled run({recorded("reaction", "strip", "y", {0, 1, 2}, {0, 4, 8})});
  run.definition.references = {"limit_analysis"};
  run.record.outcome.ending = Ending::domain_too_large;
  RunRequest request;
  request.scene = half_model(clay());
  const Judgement judgement = judge(run.definition, request, run.record);
  std::vector<std::string> sources;
  for (const Curve& curve : judgement.curves) {
    if (curve.name == "pressure") sources.push_back(curve.source);
  }
  EXPECT_EQ(sources, (std::vector<std::string>{"run", "limit_analysis"}));
  for (const auto& [name, value] : judgement.metrics)
    EXPECT_FALSE(name.starts_with("limit_analysis")) << name;
}

// ---- as a function of the settlement

TEST(AdvancingPart, LeavesOutRestAndRebound) {
  const LoadCurve part = advancing_part({{0, 0, 0, 2, 1, 2, 3}, {1, 2, 3, 4, 9, 9, 5}});
  EXPECT_EQ(part.settlement, (std::vector<double>{0, 2, 3}));
  EXPECT_EQ(part.pressure, (std::vector<double>{3, 4, 5}));
}

TEST(EvenlySpaced, IsLinearBetweenTheSamples) {
  const LoadCurve even = evenly_spaced({{1, 2, 2, 5}, {0, 10, 99, 40}}, 9);
  expect_near(even.settlement, {1, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5});
  expect_near(even.pressure, {0, 5, 10, 15, 20, 25, 30, 35, 40});
}

}  // namespace
}  // namespace mpm::vv
