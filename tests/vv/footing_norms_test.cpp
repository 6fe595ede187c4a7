// Footings judged through made-up load curves whose limit pressure or stiffness is known.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "reference/bearing_capacity.hpp"
#include "reference/elastic_strip.hpp"
#include "vv/norms.hpp"

namespace mpm::vv {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double cohesion = 1000.0;
constexpr double nc_of_clay = 2 + std::numbers::pi;

MohrCoulomb clay() { return {1e7, 0.3, 0.0, cohesion, 0.0}; }
MohrCoulomb sand(double friction_angle) { return {1e7, 0.3, friction_angle, 0.0, friction_angle}; }

/// A strip of 0.8 m in the middle of 4 m of weightless ground, 2 m deep, pressed down by 0.1 m/s.
Scene full_model(const Material& material) {
  Scene scene;
  scene.dimension = 2;
  scene.cell_size = 0.1;
  scene.grid_upper = {4.0, 2.4};
  scene.edges = {{{Condition::roller, Condition::roller}, {Condition::fixed, Condition::free}}};
  Body ground;
  ground.name = "ground";
  ground.upper = {4.0, 2.0};
  ground.particles_per_cell = {2, 2};
  ground.density = 2000.0;
  ground.material = material;
  scene.bodies = {ground};
  RigidBody strip{.name = "strip", .lower = {1.6, 2.0}, .upper = {2.4, 2.2}, .velocity = {0.0, -0.1}};
  scene.rigid_bodies = {strip};
  scene.termination = AtTime{11.0};
  return scene;
}

/// The right half of such a strip: its axis is the grid's lower edge in x.
Scene half_model(const Material& material) {
  Scene scene = full_model(material);
  scene.rigid_bodies[0].lower[0] = -0.4;
  scene.rigid_bodies[0].upper[0] = 0.4;
  return scene;
}

Scene loaded(Scene scene, double begin, double end, double pressure) {
  scene.surface_loads.push_back({"ground", 1, 1, begin, end, {0.0, -pressure}, 0.0});
  return scene;
}

Scene with_gravity(Scene scene, double level = 1.0) {
  scene.gravity.acceleration = {0.0, -10.0};
  scene.gravity.level = level;
  return scene;
}

HistoryProbe reaction_of(const std::string& body, const std::string& component) {
  return {.id = body + "_" + component,
          .quantity = "reaction",
          .component = component,
          .target = ProbeTarget::rigid_body,
          .of = body,
          .every = 1.0};
}

Judgement judged(const Scene& scene, const std::string& reference, const std::vector<double>& time,
                 const std::vector<double>& reaction) {
  Case definition;
  definition.references = {reference};
  definition.probes = {reaction_of("strip", "y")};
  RunRequest request;
  request.scene = scene;
  EXPECT_EQ(why_unsuited(reference, request), "");
  Record record;
  record.histories = {{"strip_y", "reaction", time, reaction}};
  return judge(definition, request, record);
}

/// A sample every second from 1 s on; `reaction` begins with the first step's, which is no mean of anything.
Judgement judged(const Scene& scene, const std::string& reference, const std::vector<double>& reaction) {
  std::vector<double> time;
  for (std::size_t k = 0; k < reaction.size(); ++k) time.push_back(1.0 + static_cast<double>(k));
  return judged(scene, reference, time, reaction);
}

/// The limit pressure by which a scene is judged, from a run that reaches 1 kPa below a strip of `width`.
double limit_pressure_of(const Scene& scene, double width) {
  const Judgement judgement = judged(scene, "limit_analysis", std::vector<double>(12, 1000.0 * width));
  EXPECT_NEAR(judgement.metrics.at("limit_analysis.pressure"), 1000.0, 1e-9);
  return 1000.0 / (1 + judgement.metrics.at("limit_analysis.overshoot"));
}

const Curve* curve_of(const Judgement& judgement, const std::string& source) {
  for (const Curve& curve : judgement.curves) {
    if (curve.name == "pressure" && curve.source == source) return &curve;
  }
  return nullptr;
}

// ---- the limit pressure

TEST(LimitLoad, OfClayIsPrandtlsForRoughAndSmooth) {
  for (const bool rough : {true, false}) {
    Scene full = full_model(clay()), half = half_model(clay());
    full.rigid_bodies[0].constrains[0] = half.rigid_bodies[0].constrains[0] = rough;
    EXPECT_NEAR(limit_pressure_of(full, 0.8), nc_of_clay * cohesion, 1e-8);
    EXPECT_NEAR(limit_pressure_of(half, 0.4), nc_of_clay * cohesion, 1e-8);
  }
}

TEST(LimitLoad, OfAHalfModelCountsFromTheAxis) {
  Scene half = half_model(clay());
  half.rigid_bodies[0].lower[0] = 0.0;
  EXPECT_NEAR(limit_pressure_of(half, 0.4), nc_of_clay * cohesion, 1e-8);
  half.grid_lower[0] = half.bodies[0].lower[0] = 0.1;
  EXPECT_NEAR(limit_pressure_of(half, 0.3), nc_of_clay * cohesion, 1e-8);
}

TEST(LimitLoad, CountsTheSurchargeOnEitherSideOnce) {
  const double q = 500.0, nq = 18.401122218708640;  // exp(pi tan 30) tan^2 60
  const Material soil = sand(30 * degree);
  EXPECT_NEAR(limit_pressure_of(loaded(half_model(soil), 0.4, 4.0, q), 0.4) / (q * nq), 1, 1e-12);
  const Scene both = loaded(loaded(full_model(soil), 0.0, 1.6, q), 2.4, 4.0, q);
  EXPECT_NEAR(limit_pressure_of(both, 0.8) / (q * nq), 1, 1e-12);
  // Two loads above each other and two beside each other, beyond the ground's end.
  Scene pieces =
      loaded(loaded(loaded(half_model(soil), 0.4, 9.0, q / 4), 0.4, 2.0, 3 * q / 4), 2.0, 4.0, 3 * q / 4);
  EXPECT_NEAR(limit_pressure_of(pieces, 0.4) / (q * nq), 1, 1e-12);
  // Of clay the surcharge adds as it is.
  EXPECT_NEAR(limit_pressure_of(loaded(half_model(clay()), 0.4, 4.0, q), 0.4), nc_of_clay * cohesion + q,
              1e-8);
}

TEST(LimitLoad, AddsCohesionAndSurchargeOfWeightlessSoil) {
  MohrCoulomb soil = sand(30 * degree);
  soil.cohesion = cohesion;
  const double nq = 18.401122218708640, nc = (nq - 1) * std::sqrt(3.0);
  EXPECT_NEAR(
      limit_pressure_of(loaded(half_model(soil), 0.4, 4.0, 200.0), 0.4) / (nc * cohesion + nq * 200.0), 1,
      1e-12);
}

TEST(LimitLoad, OfHeavySandGrowsWithTheFullWidth) {
  const double gamma = 2000.0 * 10.0, phi = 30 * degree;
  for (const bool rough : {true, false}) {
    const double factor =
        reference::exact_ngamma(phi, rough ? reference::Roughness::rough : reference::Roughness::smooth);
    EXPECT_NEAR(factor, rough ? 14.75426 : 7.65300, 1e-5);  // [Martin05]
    Scene full = with_gravity(full_model(sand(phi))), half = with_gravity(half_model(sand(phi)));
    full.rigid_bodies[0].constrains[0] = half.rigid_bodies[0].constrains[0] = rough;
    EXPECT_NEAR(limit_pressure_of(full, 0.8) / (gamma * 0.8 / 2 * factor), 1, 1e-12);
    EXPECT_NEAR(limit_pressure_of(half, 0.4) / (gamma * 0.8 / 2 * factor), 1, 1e-12);
    EXPECT_NEAR(limit_pressure_of(with_gravity(half_model(sand(phi)), 50.0), 0.4) /
                    (50 * limit_pressure_of(with_gravity(half_model(sand(phi))), 0.4)),
                1, 1e-12);
  }
}

TEST(LimitLoad, IsThatOfTheGravityThatActsInTheEnd) {
  const Scene full = with_gravity(half_model(sand(30 * degree)));
  Scene staged = full, ramped = full;
  staged.gravity.loading = StagedLoading{0.5, {1.0, 0.25}};
  ramped.gravity.loading = RampLoading{2.0};
  EXPECT_NEAR(limit_pressure_of(staged, 0.4) / limit_pressure_of(full, 0.4), 0.25, 1e-12);
  EXPECT_NEAR(limit_pressure_of(ramped, 0.4) / limit_pressure_of(full, 0.4), 1, 1e-12);
}

// ---- the load curve

TEST(LoadCurve, BelongsToTheSettlementHalfwayBetweenSamples) {
  const Judgement judgement =
      judged(half_model(clay()), "limit_analysis", {0.01, 0.5, 1.0, 3.0}, {9e9, 4.0, 8.0, 2.0});
  const Curve* curve = curve_of(judgement, "run");
  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->x_name, "settlement");
  const std::vector<double> settlement{0.0255, 0.075, 0.2}, pressure{10.0, 20.0, 5.0};
  ASSERT_EQ(curve->x.size(), 3u);
  ASSERT_EQ(curve->y.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(curve->x[k], settlement[k], 1e-15);
    EXPECT_NEAR(curve->y[k], pressure[k], 1e-12);
  }
}

TEST(LoadCurve, FollowsTheRampOfTheVelocity) {
  Scene scene = half_model(clay());
  scene.rigid_bodies[0].start = 1.0;
  scene.rigid_bodies[0].ramp = 2.0;
  // Halfway: 0.5 s at rest, 1.5 and 2.5 s in the ramp, 3.5 s beyond it.
  const Judgement judgement =
      judged(scene, "limit_analysis", {0.0, 1.0, 2.0, 3.0, 4.0}, std::vector<double>(5, 1.0));
  const Curve* curve = curve_of(judgement, "run");
  ASSERT_TRUE(curve);
  const std::vector<double> settlement{0.0, 0.1 * 0.25 / 4, 0.1 * 2.25 / 4, 0.1 * 1.5};
  ASSERT_EQ(curve->x.size(), settlement.size());
  for (std::size_t k = 0; k < settlement.size(); ++k) EXPECT_NEAR(curve->x[k], settlement[k], 1e-15);
}

TEST(LoadCurve, IsJudgedOverTheLastFifthOfItsSettlement) {
  // Of the settlements 0.15, 0.25, ..., 1.05 m the last three are beyond four fifths of the last.
  MohrCoulomb soil = clay();
  soil.cohesion = 80.0 / nc_of_clay;
  std::vector<double> reaction{1e6};
  for (const double pressure : {10.0, 20.0, 300.0, 40.0, 50.0, 60.0, 200.0, 90.0, 100.0, 110.0})
    reaction.push_back(0.8 * pressure);
  const Judgement judgement = judged(full_model(soil), "limit_analysis", reaction);
  const auto& metrics = judgement.metrics;
  EXPECT_NEAR(metrics.at("limit_analysis.pressure"), 100.0, 1e-10);
  EXPECT_NEAR(metrics.at("limit_analysis.overshoot"), 0.25, 1e-12);
  EXPECT_NEAR(metrics.at("limit_analysis.shortfall"), -0.25, 1e-12);
  EXPECT_NEAR(metrics.at("limit_analysis.peak_overshoot"), 300.0 / 80.0 - 1, 1e-12);
  EXPECT_NEAR(metrics.at("limit_analysis.spread"), 0.2, 1e-12);
  EXPECT_FALSE(metrics.contains("elastic_strip.stiffness"));
  const Curve* exact = curve_of(judgement, "limit_analysis");
  ASSERT_TRUE(exact);
  EXPECT_EQ(exact->x_name, "settlement");
  ASSERT_EQ(exact->x.size(), 2u);
  EXPECT_EQ(exact->x[0], 0.0);
  EXPECT_NEAR(exact->x[1], 1.05, 1e-12);
  EXPECT_NEAR(exact->y[0], 80.0, 1e-10);
  EXPECT_EQ(exact->y[0], exact->y[1]);
  EXPECT_EQ(judgement.curves.size(), 3u);  // the two and the probe's own history
}

TEST(LoadCurve, ThatIsNotANumberSomewhereHasNoPeak) {
  std::vector<double> reaction(12, 1000.0);
  reaction[4] = std::numeric_limits<double>::quiet_NaN();
  const auto metrics = judged(full_model(clay()), "limit_analysis", reaction).metrics;
  EXPECT_FALSE(metrics.contains("limit_analysis.peak_overshoot"));
  EXPECT_TRUE(metrics.contains("limit_analysis.overshoot"));  // of the last fifth, which is finite
  reaction[11] = reaction[4];
  for (const auto& [name, value] : judged(full_model(clay()), "limit_analysis", reaction).metrics)
    EXPECT_FALSE(name.starts_with("limit_analysis")) << name;
}

TEST(LoadCurve, NeedsTheProbeOfTheStripsVerticalReaction) {
  Case definition;
  definition.references = {"limit_analysis"};
  RunRequest request;
  request.scene = full_model(clay());
  Record record;
  const auto judged_pressure = [&] {
    const Judgement judgement = judge(definition, request, record);
    const auto found = judgement.metrics.find("limit_analysis.pressure");
    EXPECT_EQ(found == judgement.metrics.end(), curve_of(judgement, "run") == nullptr);
    return found == judgement.metrics.end() ? -1.0 : found->second;
  };
  EXPECT_EQ(judged_pressure(), -1.0);
  definition.probes = {reaction_of("strip", "x"), reaction_of("other", "y")};
  HistoryProbe displacement = reaction_of("strip", "y");
  displacement.quantity = "displacement";
  definition.probes.push_back(displacement);
  record.histories.assign(3, {"id", "reaction", {1.0, 2.0}, {8.0, 8.0}});
  EXPECT_EQ(judged_pressure(), -1.0);
  definition.probes.push_back(reaction_of("strip", "y"));
  record.histories.push_back({"id", "reaction", {1.0}, {8.0}});  // one sample is no mean
  EXPECT_EQ(judged_pressure(), -1.0);
  record.histories[3] = {"id", "reaction", {1.0, 2.0}, {8.0, 16.0}};
  EXPECT_NEAR(judged_pressure(), 20.0, 1e-12);
  record.outcome.ending = Ending::not_at_rest;
  EXPECT_EQ(judged_pressure(), -1.0);
  record.outcome.ending = Ending::reached_time;
  definition.references = {};
  const Judgement unasked = judge(definition, request, record);
  EXPECT_FALSE(unasked.metrics.contains("limit_analysis.pressure"));
  EXPECT_TRUE(curve_of(unasked, "run"));
}

// ---- the stiffness

const LinearElastic elastic{1e7, 0.3};

/// 12 samples of a strip that meets `stiffness` [Pa/m], each a second's mean.
std::vector<double> linear_reaction(double stiffness, double width) {
  std::vector<double> reaction{0.0};
  for (int k = 1; k < 12; ++k) reaction.push_back(stiffness * width * 0.1 * (k + 0.5));
  return reaction;
}

TEST(VerificationOfElasticStripNorm, MeasuresWhatALinearCurveMissesOfTheStiffness) {
  for (const bool rough : {true, false}) {
    Scene scene = half_model(elastic);
    scene.rigid_bodies[0].constrains[0] = rough;
    const double exact =
        reference::secant_stiffness(
            {0.4, 2.0, 4.0, 1e7, 0.3, rough ? reference::Roughness::rough : reference::Roughness::smooth})
            .value;
    const Judgement right = judged(scene, "elastic_strip", linear_reaction(exact, 0.4));
    EXPECT_NEAR(right.metrics.at("elastic_strip.stiffness"), 0.0, 1e-12);
    EXPECT_NEAR(right.metrics.at("elastic_strip.overshoot"), 0.0, 1e-12);
    EXPECT_FALSE(right.metrics.contains("limit_analysis.pressure"));
    for (const double error : {0.03, -0.03}) {
      const Judgement wrong = judged(scene, "elastic_strip", linear_reaction((1 + error) * exact, 0.4));
      EXPECT_NEAR(wrong.metrics.at("elastic_strip.stiffness"), 0.03, 1e-12);
      EXPECT_NEAR(wrong.metrics.at("elastic_strip.overshoot"), error, 1e-12);
    }
    const Curve* line = curve_of(right, "elastic_strip");
    ASSERT_TRUE(line);
    EXPECT_EQ(line->x_name, "settlement");
    ASSERT_EQ(line->x.size(), 2u);
    EXPECT_EQ(line->x[0], 0.0);
    EXPECT_EQ(line->y[0], 0.0);
    EXPECT_NEAR(line->x[1], 1.15, 1e-12);
    EXPECT_NEAR(line->y[1] / (1.15 * exact), 1, 1e-12);
    const Curve* run = curve_of(right, "run");
    ASSERT_TRUE(run);
    EXPECT_NEAR(run->y.back() / line->y[1], 1, 1e-12);
  }
}

TEST(VerificationOfElasticStripNorm, IsOfTheLastFifth) {
  Scene scene = half_model(elastic);
  const double exact =
      reference::secant_stiffness({0.4, 2.0, 4.0, 1e7, 0.3, reference::Roughness::rough}).value;
  std::vector<double> reaction = linear_reaction(exact, 0.4);
  for (std::size_t k = 0; k < 8; ++k) reaction[k] = 0.0;  // up to 0.75 m of 1.15 m
  EXPECT_NEAR(judged(scene, "elastic_strip", reaction).metrics.at("elastic_strip.stiffness"), 0.0, 1e-12);
  reaction.back() *= 2;
  EXPECT_GT(judged(scene, "elastic_strip", reaction).metrics.at("elastic_strip.stiffness"), 0.1);
}

// ---- scenes that no reference describes

struct Unsuited {
  const char* expected;
  std::function<void(Scene&)> change;
};

void expect_refusals(const std::string& reference, const Scene& suited,
                     const std::vector<Unsuited>& changes) {
  EXPECT_EQ(why_unsuited(reference, suited), "");
  for (const Unsuited& unsuited : changes) {
    Scene scene = suited;
    unsuited.change(scene);
    EXPECT_EQ(why_unsuited(reference, scene), unsuited.expected) << reference;
  }
}

const char* const reaches_beyond_on_its_left =
    "ground that reaches beyond the strip on its left too, or to a roller at its axis";
const char* const downwards_only = "a rigid body that moves downwards only";
const char* const evenly = "one pressure on all the surface beside the strip and none below it, if any";

TEST(WhyNoFooting, NamesWhatIsMissing) {
  const std::vector<Unsuited> common = {
      {"two dimensions", [](Scene& s) { s.dimension = 1; }},
      {"a single block of ground that keeps its mass", [](Scene& s) { s.bodies.push_back(s.bodies[0]); }},
      {"a single block of ground that keeps its mass",
       [](Scene& s) {
         s.bodies[0].ring = Ring{{1, 1}, 0, 1};
       }},
      {"a single block of ground that keeps its mass",
       [](Scene& s) {
         s.bodies[0].density_ramp = DensityRamp{1, 0, 1};
       }},
      {"ground that no motion is imposed on", [](Scene& s) { s.driven_motion = DrivenMotion{}; }},
      {"gravity straight downwards, if any",
       [](Scene& s) {
         s.gravity.acceleration = {1.0, -10.0};
       }},
      {"gravity straight downwards, if any",
       [](Scene& s) {
         s.gravity.acceleration = {0.0, 10.0};
       }},
      {"a single rigid body", [](Scene& s) { s.rigid_bodies.clear(); }},
      {"a single rigid body", [](Scene& s) { s.rigid_bodies.push_back(s.rigid_bodies[0]); }},
      {downwards_only,
       [](Scene& s) {
         s.rigid_bodies[0].velocity = {0.1, -0.1};
       }},
      {downwards_only,
       [](Scene& s) {
         s.rigid_bodies[0].velocity = {0.0, 0.0};
       }},
      {downwards_only,
       [](Scene& s) {
         s.rigid_bodies[0].velocity = {0.0, 0.1};
       }},
      {downwards_only, [](Scene& s) { s.rigid_bodies[0].angular_velocity = 0.1; }},
      {"a rigid body that constrains its vertical motion",
       [](Scene& s) { s.rigid_bodies[0].constrains[1] = false; }},
      {"a rigid body that starts on the ground's surface",
       [](Scene& s) { s.rigid_bodies[0].lower[1] += 0.01; }},
      {"a rigid body that starts on the ground's surface",
       [](Scene& s) { s.rigid_bodies[0].lower[1] -= 0.01; }},
      {"ground that stands on a fixed y_lower edge", [](Scene& s) { s.edges[1][0] = Condition::roller; }},
      {"ground that stands on a fixed y_lower edge", [](Scene& s) { s.grid_lower[1] = -0.1; }},
      {"ground that reaches beyond the strip", [](Scene& s) { s.rigid_bodies[0].upper[0] = 4.0; }},
      {"no surface load but a pressure on the surface",
       [](Scene& s) {
         s.surface_loads = {{"ground", 0, 1, 0.0, 2.0, {0.0, -1.0}, 0.0}};
       }},
      {"no surface load but a pressure on the surface",
       [](Scene& s) {
         s.surface_loads = {{"ground", 1, 0, 0.0, 4.0, {0.0, -1.0}, 0.0}};
       }},
      {"no surface load but a pressure on the surface",
       [](Scene& s) {
         s.surface_loads = {{"ground", 1, 1, 0.0, 4.0, {1.0, -1.0}, 0.0}};
       }},
      {evenly, [](Scene& s) { s = loaded(s, 0.0, 4.0, 1.0); }},
      {evenly, [](Scene& s) { s = loaded(s, s.rigid_bodies[0].upper[0], 3.0, 1.0); }},
      {evenly, [](Scene& s) { s = loaded(s, 3.0, 4.0, 1.0); }},
      {evenly, [](Scene& s) { s = loaded(s, s.rigid_bodies[0].upper[0] + 0.1, 4.0, 1.0); }},
      {evenly, [](Scene& s) { s = loaded(s, s.rigid_bodies[0].upper[0], 4.0, -1.0); }},
  };
  expect_refusals("limit_analysis", full_model(clay()), common);
  expect_refusals("limit_analysis", half_model(clay()), common);
  expect_refusals("elastic_strip", half_model(elastic), common);
  expect_refusals("limit_analysis", full_model(clay()),
                  {{reaches_beyond_on_its_left, [](Scene& s) { s.bodies[0].lower[0] = 1.6; }},
                   {evenly, [](Scene& s) { s = loaded(s, 2.4, 4.0, 1.0); }},
                   {evenly, [](Scene& s) { s = loaded(loaded(s, 2.4, 4.0, 1.0), 0.0, 1.6, 2.0); }}});
  expect_refusals("limit_analysis", half_model(clay()),
                  {{reaches_beyond_on_its_left, [](Scene& s) { s.edges[0][0] = Condition::fixed; }},
                   {reaches_beyond_on_its_left, [](Scene& s) { s.bodies[0].lower[0] = 0.1; }}});
}

TEST(WhyNoLimitLoad, NamesWhatIsMissing) {
  const char* one_term = "either weight or strength without weight, since only one term at a time is exact";
  expect_refusals("limit_analysis", half_model(clay()),
                  {{"ground of Mohr-Coulomb's law", [](Scene& s) { s.bodies[0].material = elastic; }},
                   {one_term, [](Scene& s) { s = with_gravity(s); }},
                   {"something that gives the ground strength: cohesion, surcharge or weight",
                    [](Scene& s) { s.bodies[0].material = sand(0.5); }}});
  const char* known = "a friction angle from 1 to 50 degrees, where the factor of weight is known";
  expect_refusals("limit_analysis", with_gravity(half_model(sand(30 * degree))),
                  {{one_term, [](Scene& s) { s = loaded(s, 0.4, 4.0, 1.0); }},
                   {known, [](Scene& s) { s.bodies[0].material = sand(50.5 * degree); }},
                   {known, [](Scene& s) { s.bodies[0].material = sand(0.9 * degree); }},
                   // A level of zero leaves nothing that gives strength.
                   {"something that gives the ground strength: cohesion, surcharge or weight",
                    [](Scene& s) { s.gravity.level = 0.0; }}});
  EXPECT_EQ(why_unsuited("limit_analysis", with_gravity(half_model(sand(50 * degree)))), "");
  EXPECT_EQ(why_unsuited("limit_analysis", loaded(half_model(sand(60 * degree)), 0.4, 4.0, 1.0)), "");
}

TEST(WhyNoStiffness, NamesWhatIsMissing) {
  const char* far_side = "ground that reaches to a roller on its far side";
  const char* light = "ground without weight or surcharge";
  expect_refusals(
      "elastic_strip", half_model(elastic),
      {{"linear elastic ground", [](Scene& s) { s.bodies[0].material = clay(); }},
       {"Poisson's ratio up to 0.49",
        [](Scene& s) {
          s.bodies[0].material = LinearElastic{1e7, 0.495};
        }},
       {"ground that starts free of stress", [](Scene& s) { s.bodies[0].initial_stress = UniformStress{}; }},
       {"a half model, its axis a roller at the grid's lower edge",
        [](Scene& s) { s.rigid_bodies[0].lower[0] = 0.2; }},
       {far_side, [](Scene& s) { s.edges[0][1] = Condition::fixed; }},
       {far_side, [](Scene& s) { s.bodies[0].upper[0] = 3.0; }},
       {light, [](Scene& s) { s = with_gravity(s); }},
       {light, [](Scene& s) { s = loaded(s, 0.4, 4.0, 1.0); }}});
}

TEST(FootingCatalogue, HoldsEveryMetricThatIsMeasured) {
  std::vector<Judgement> judgements;
  judgements.push_back(judged(half_model(clay()), "limit_analysis", std::vector<double>(12, 1.0)));
  judgements.push_back(judged(half_model(elastic), "elastic_strip", std::vector<double>(12, 1.0)));
  int measured = 0;
  for (const Metric& metric : metric_catalogue()) {
    if (metric.reference != "limit_analysis" && metric.reference != "elastic_strip") continue;
    ++measured;
    EXPECT_TRUE(judgements[metric.reference == "elastic_strip"].metrics.contains(metric.name)) << metric.name;
  }
  EXPECT_EQ(measured, 7);
}

}  // namespace
}  // namespace mpm::vv
