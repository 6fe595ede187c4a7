// Footings judged through made-up load curves whose limit pressure or stiffness is known.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "reference/bearing_capacity.hpp"
#include "reference/elastic_strip.hpp"
#include "tests/support/footing_scenes.hpp"
#include "vv/norms.hpp"

namespace mpm::vv {
namespace {

using namespace mpm::test;

constexpr double nc_of_clay = 2 + std::numbers::pi;

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
  const Judgement unfinished = judge(definition, request, record);
  EXPECT_FALSE(unfinished.metrics.contains("limit_analysis.pressure"));
  EXPECT_TRUE(curve_of(unfinished, "run"));
  record.outcome.ending = Ending::reached_time;
  definition.references = {};
  const Judgement unasked = judge(definition, request, record);
  EXPECT_FALSE(unasked.metrics.contains("limit_analysis.pressure"));
  EXPECT_TRUE(curve_of(unasked, "run"));
  // The curve is drawn too where no reference describes what else acts on the ground.
  request.scene = loaded(with_gravity(request.scene), 3.0, 4.0, 1.0);
  EXPECT_NE(why_unsuited("limit_analysis", request), "");
  EXPECT_TRUE(curve_of(judge(definition, request, record), "run"));
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
    "ground that reaches beyond the footing on its left too, or to a roller at its axis";
const char* const downwards_only = "a rigid body that moves downwards only";
const char* const only_shafts =
    "no rigid body beside the one that presses but such as constrain x only, move with it and stay above its "
    "base, within its width";
const char* const evenly = "one pressure on all the surface beside the footing and none below it, if any";

TEST(WhyNoFooting, NamesWhatIsMissing) {
  const std::vector<Unsuited> common = {
      {"two dimensions", [](Scene& s) { s.dimension = 1; }},
      {"a single block of ground", [](Scene& s) { s.bodies.push_back(s.bodies[0]); }},
      {"a single block of ground",
       [](Scene& s) {
         s.bodies[0].ring = Ring{{1, 1}, 0, 1};
       }},
      {"ground that keeps its mass",
       [](Scene& s) {
         s.bodies[0].density_ramp = DensityRamp{0, {{1, 1}}};
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
      {"a rigid body, or a block whose density changes, on the ground",
       [](Scene& s) { s.rigid_bodies.clear(); }},
      {only_shafts, [](Scene& s) { s.rigid_bodies.push_back(s.rigid_bodies[0]); }},
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
      {"ground that stands on a fixed or roller y_lower edge",
       [](Scene& s) { s.edges[1][0] = Condition::free; }},
      {"ground that stands on a fixed or roller y_lower edge", [](Scene& s) { s.grid_lower[1] = -0.1; }},
      {"ground that reaches beyond the footing", [](Scene& s) { s.rigid_bodies[0].upper[0] = 4.0; }},
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
       {"ground that stands on a fixed y_lower edge", [](Scene& s) { s.edges[1][0] = Condition::roller; }},
       {"a half model, its axis a roller at the grid's lower edge",
        [](Scene& s) { s.rigid_bodies[0].lower[0] = 0.2; }},
       {far_side, [](Scene& s) { s.edges[0][1] = Condition::fixed; }},
       {far_side, [](Scene& s) { s.bodies[0].upper[0] = 3.0; }},
       {light, [](Scene& s) { s = with_gravity(s); }},
       {light, [](Scene& s) { s = loaded(s, 0.4, 4.0, 1.0); }}});
}

// ---- references over the settlement

const Curve& line_of(const Judgement& judgement, const std::string& source) {
  const Curve* curve = curve_of(judgement, source);
  EXPECT_TRUE(curve) << source;
  static const Curve none{"", "", {0, 0}, {0, 0}, ""};
  return curve ? *curve : none;
}

/// From a run that reaches 1.15 m with 1 kPa below a strip of 0.4 m.
Judgement of_one_kpa(const Scene& scene, const std::string& reference) {
  return judged(scene, reference, std::vector<double>(12, 400.0));
}

MohrCoulomb soil_of(double friction_angle, double c) {
  MohrCoulomb soil = sand(friction_angle);
  soil.cohesion = c;
  return soil;
}

TEST(Terzaghi, AddsCohesionSurchargeAndTheChartsWeight) {
  // B = 0.8 m, 20 kN/m^3; Nc and Nq by his formulas at 20 degrees, 5.0 from the chart.
  const double by_weight = 20000.0 * 0.8 / 2 * 5.0, by_cohesion = 300.0 * 17.690276,
               by_load = 200.0 * 7.438703;
  const auto pressure = [&](const Scene& scene) {
    const Judgement judgement = of_one_kpa(scene, "terzaghi");
    const Curve& line = line_of(judgement, "terzaghi");
    EXPECT_EQ(line.x_name, "settlement");
    EXPECT_EQ(line.x.front(), 0.0);
    EXPECT_NEAR(line.x.back(), 1.15, 1e-12);
    EXPECT_EQ(line.y.front(), line.y.back());
    EXPECT_NEAR(judgement.metrics.at("terzaghi.exceeded_by"), 1000.0 / line.y.front() - 1, 1e-9);
    return line.y.front();
  };
  EXPECT_NEAR(pressure(with_gravity(half_model(sand(20 * degree)))), by_weight, 1e-6);
  EXPECT_NEAR(pressure(with_gravity(half_model(soil_of(20 * degree, 300.0)))), by_weight + by_cohesion, 0.01);
  EXPECT_NEAR(pressure(loaded(with_gravity(half_model(soil_of(20 * degree, 300.0))), 0.4, 4.0, 200.0)),
              by_weight + by_cohesion + by_load, 0.01);
  // Weight is no strength without friction, and without weight any angle will do.
  EXPECT_NEAR(pressure(with_gravity(half_model(clay()))), 1000.0 * (1 + 1.5 * std::numbers::pi), 1e-6);
  EXPECT_NEAR(pressure(half_model(soil_of(33 * degree, 300.0))), 300.0 * reference::terzaghi_nc(33 * degree),
              1e-6);
}

TEST(Terzaghi, NamesWhatIsMissing) {
  expect_refusals(
      "terzaghi", with_gravity(half_model(sand(20 * degree))),
      {{"ground of Mohr-Coulomb's law", [](Scene& s) { s.bodies[0].material = elastic; }},
       {"a rough footing", [](Scene& s) { s.rigid_bodies[0].constrains[0] = false; }},
       {"a friction angle of 0, 15, 20, 25 or 30 degrees, for which the chart's factor of weight is quoted",
        [](Scene& s) { s.bodies[0].material = sand(21 * degree); }},
       {"something that gives the ground strength: cohesion, surcharge or weight",
        [](Scene& s) { s.gravity.level = 0.0; }},
       {evenly, [](Scene& s) { s = loaded(s, 1.0, 2.0, 1.0); }}});
}

TEST(EmbeddedLimit, GrowsWithTheSettlementByTheWeightOfWhatLiesBeside) {
  const double nq = 18.401122218708640, nc = (nq - 1) * std::sqrt(3.0), gamma = 20000.0;  // 30 degrees
  for (const bool rough : {true, false}) {
    const double ngamma = rough ? 14.75426 : 7.65300;
    Scene scene = loaded(with_gravity(half_model(soil_of(30 * degree, 300.0))), 0.4, 4.0, 200.0);
    scene.rigid_bodies[0].constrains[0] = rough;
    const Judgement judgement = of_one_kpa(scene, "embedded_limit");
    const Curve& line = line_of(judgement, "embedded_limit");
    const double surface = 300.0 * nc + 200.0 * nq + gamma * 0.8 / 2 * ngamma;
    ASSERT_EQ(line.x.size(), 2u);
    EXPECT_EQ(line.x[0], 0.0);
    EXPECT_NEAR(line.x[1], 1.15, 1e-12);
    EXPECT_NEAR(line.y[0] / surface, 1, 1e-6);
    EXPECT_NEAR(line.y[1] / (surface + gamma * 1.15 * nq), 1, 1e-6);
    EXPECT_NEAR(judgement.metrics.at("embedded_limit.exceeded_by"), 1000.0 / line.y[1] - 1, 1e-9);
  }
  const Judgement of_clay = of_one_kpa(with_gravity(half_model(clay())), "embedded_limit");
  EXPECT_NEAR(line_of(of_clay, "embedded_limit").y[0], nc_of_clay * cohesion, 1e-6);
  EXPECT_NEAR(line_of(of_clay, "embedded_limit").y[1], nc_of_clay * cohesion + 20000.0 * 1.15, 1e-6);
}

TEST(EmbeddedLimit, NamesWhatIsMissing) {
  const char* known = "a friction angle of zero or from 1 to 50 degrees, where the factor of weight is known";
  expect_refusals("embedded_limit", with_gravity(half_model(soil_of(20 * degree, 300.0))),
                  {{"ground of Mohr-Coulomb's law", [](Scene& s) { s.bodies[0].material = elastic; }},
                   {known, [](Scene& s) { s.bodies[0].material = sand(51 * degree); }},
                   {known, [](Scene& s) { s.bodies[0].material = sand(0.5 * degree); }},
                   {"something that gives the ground strength: cohesion, surcharge or weight", [](Scene& s) {
                      s.bodies[0].material = sand(20 * degree);
                      s.gravity.level = 0.0;
                    }}});
  EXPECT_EQ(why_unsuited("embedded_limit", half_model(soil_of(60 * degree, 1.0))), "");
}

TEST(EmbeddedLimit, OfABlockIsOfARoughFooting) {
  Scene rigid = with_gravity(half_model(sand(30 * degree)));
  for (const char* reference : {"terzaghi", "embedded_limit", "limit_analysis", "elastic_layer"})
    EXPECT_EQ(why_unsuited(reference, block_model(sand(30 * degree))), "") << reference;
  Case definition;
  definition.references = {"embedded_limit", "elastic_layer"};
  definition.probes = {{.id = "w", .quantity = "weight", .component = "", .of = "block"},
                       {.id = "u", .quantity = "displacement", .component = "y", .of = "block"}};
  RunRequest request;
  request.scene = block_model(sand(30 * degree));
  EXPECT_EQ(why_not_judged("embedded_limit", definition, request), "");
  Record record;
  record.histories = {{"w", "weight", {2, 3, 4}, {40, 400, 800}},
                      {"u", "displacement", {2, 3, 4}, {-0.5, -1, -1.65}}};
  const Judgement judgement = judge(definition, request, record);
  const Judgement of_rigid = of_one_kpa(rigid, "embedded_limit");
  const Curve &block = line_of(judgement, "embedded_limit"), &strip = line_of(of_rigid, "embedded_limit");
  EXPECT_NEAR(block.x[1], 1.15, 1e-12);
  EXPECT_NEAR(block.y[0] / strip.y[0], 1, 1e-12);
  EXPECT_NEAR(block.y[1] / strip.y[1], 1, 1e-12);
  // The elastic line begins at the pressure the block already stood with.
  const Curve& line = line_of(judgement, "elastic_layer");
  EXPECT_EQ(line.x[0], 0.0);
  EXPECT_NEAR(line.y[0], 100.0, 1e-9);
  EXPECT_NEAR(line.y[1], 2000.0, 1e-6);
  definition.probes.pop_back();
  EXPECT_EQ(why_not_judged("embedded_limit", definition, request),
            "a probe of the displacement of block, component y");
}

TEST(ElasticLayer, IsTheExactLineUpToTheLargestPressure) {
  const double exact =
      reference::secant_stiffness({0.4, 2.0, 4.0, 1e7, 0.3, reference::Roughness::rough}).value;
  for (const Scene& scene : {with_gravity(half_model(clay())), half_model(elastic)}) {
    const Judgement judgement = of_one_kpa(scene, "elastic_layer");
    const Curve& line = line_of(judgement, "elastic_layer");
    EXPECT_EQ(line.x[0], 0.0);
    EXPECT_EQ(line.y[0], 0.0);
    EXPECT_NEAR(line.y[1], 1000.0, 1e-9);
    EXPECT_NEAR(line.x[1] * exact, 1000.0, 1e-9);
  }
  for (const double share : {1.0, 0.5}) {
    // Stiff at first, then flat.
    std::vector<double> reaction{0.0};
    for (int k = 1; k < 115; ++k) reaction.push_back(share * exact * 0.4 * 0.1 * std::min(k + 0.5, 30.0));
    const Judgement judgement = judged(half_model(elastic), "elastic_layer", reaction);
    EXPECT_NEAR(judgement.metrics.at("elastic_layer.stiffness_ratio"), share, 1e-6);
    EXPECT_NEAR(judgement.metrics.at("load_curve.initial_stiffness"), share * exact, 1e-6 * exact);
    EXPECT_NEAR(judgement.metrics.at("load_curve.bend_settlement"), 3.0, 0.05);
  }
}

TEST(ElasticLayer, NamesWhatIsMissing) {
  const char* far_side = "ground that reaches to a roller on its far side";
  expect_refusals(
      "elastic_layer", with_gravity(half_model(sand(30 * degree))),
      {{"ground that is linear elastic or of Mohr-Coulomb's law",
        [](Scene& s) {
          s.bodies[0].material = NeoHookean{1e7, 0.3};
        }},
       {"Poisson's ratio up to 0.49",
        [](Scene& s) {
          s.bodies[0].material = LinearElastic{1e7, 0.495};
        }},
       {"ground that stands on a fixed y_lower edge", [](Scene& s) { s.edges[1][0] = Condition::roller; }},
       {"a half model, its axis a roller at the grid's lower edge",
        [](Scene& s) { s.rigid_bodies[0].lower[0] = 0.2; }},
       {far_side, [](Scene& s) { s.edges[0][1] = Condition::fixed; }},
       {far_side, [](Scene& s) { s.bodies[0].upper[0] = 3.0; }}});
}

// ---- metrics of the curve alone

TEST(LoadCurveMetrics, AreThereForRunsThatBrokeOff) {
  std::vector<double> time, reaction;
  for (int k = 0; k <= 400; ++k) {
    time.push_back(0.25 * k);
    const double settlement = 0.025 * (k - 0.5);  // of the sample that ends at k
    reaction.push_back(0.4 * (settlement < 2.0 ? 300 * settlement : 600 + 50 * (settlement - 2)));
  }
  Case definition;
  definition.references = {"terzaghi"};
  definition.probes = {reaction_of("strip", "y")};
  RunRequest request;
  request.scene = half_model(clay());
  Record record;
  record.histories = {{"strip_y", "reaction", time, reaction}};
  for (const Ending ending : {Ending::reached_time, Ending::domain_too_large}) {
    record.outcome.ending = ending;
    const auto metrics = judge(definition, request, record).metrics;
    EXPECT_NEAR(metrics.at("load_curve.bend_settlement"), 2.0, 0.02);
    EXPECT_NEAR(metrics.at("load_curve.bend_pressure"), 600.0, 5.0);
    EXPECT_NEAR(metrics.at("load_curve.bend_ratio"), 1.0 / 6, 0.01);
    EXPECT_GT(metrics.at("load_curve.straightness_gain_2"), 0.9);
    EXPECT_EQ(metrics.at("load_curve.phases"), 2.0);
    EXPECT_NEAR(metrics.at("load_curve.final_slope"), 50.0, 1e-6);
    EXPECT_NEAR(metrics.at("load_curve.deepest"), 9.9875, 1e-9);
    EXPECT_NEAR(metrics.at("load_curve.initial_stiffness"), 300.0, 1e-6);
    // What is said of the end is said of runs that reached it.
    EXPECT_EQ(metrics.contains("terzaghi.exceeded_by"), ending == Ending::reached_time);
  }
}

TEST(LoadCurveMetrics, HaveTheKneesOfThreePiecesInOrder) {
  std::vector<double> reaction{0.0};
  for (int k = 1; k <= 300; ++k) {
    const double s = 0.1 * (k + 0.5);
    reaction.push_back(0.4 * (s < 3 ? 100 * s : s < 10 ? 300 + 40 * (s - 3) : 580 + 10 * (s - 10)));
  }
  const auto metrics = judged(half_model(clay()), "limit_analysis", reaction).metrics;
  EXPECT_NEAR(metrics.at("load_curve.first_bend_settlement"), 3.0, 0.05);
  EXPECT_NEAR(metrics.at("load_curve.first_bend_pressure"), 300.0, 5.0);
  EXPECT_NEAR(metrics.at("load_curve.second_bend_settlement"), 10.0, 0.05);
  EXPECT_NEAR(metrics.at("load_curve.second_bend_pressure"), 580.0, 5.0);
  EXPECT_GT(metrics.at("load_curve.straightness_gain_3"), 0.9);
}

TEST(FootingCatalogue, HoldsEveryMetricThatIsMeasured) {
  std::map<std::string, double> measured;
  const auto add = [&](const Scene& scene, const std::string& reference) {
    std::vector<double> reaction;
    for (int k = 0; k < 120; ++k) reaction.push_back(std::min(k, 40) + 0.01 * k);
    measured.merge(judged(scene, reference, reaction).metrics);
  };
  add(half_model(clay()), "limit_analysis");
  add(half_model(elastic), "elastic_strip");
  add(half_model(elastic), "elastic_layer");
  add(half_model(clay()), "terzaghi");
  add(half_model(clay()), "embedded_limit");
  const std::vector<std::string> references{"limit_analysis", "elastic_strip", "elastic_layer", "terzaghi",
                                            "embedded_limit"};
  int listed = 0;
  for (const Metric& metric : metric_catalogue()) {
    const bool of_curve = metric.name.starts_with("load_curve.");
    if (!of_curve && std::find(references.begin(), references.end(), metric.reference) == references.end())
      continue;
    ++listed;
    EXPECT_TRUE(measured.contains(metric.name)) << metric.name;
    EXPECT_EQ(metric.reference.empty(), of_curve) << metric.name;
  }
  EXPECT_EQ(listed, 23);
  for (const auto& [name, value] : measured) {
    EXPECT_TRUE(std::any_of(metric_catalogue().begin(), metric_catalogue().end(), [&](const Metric& metric) {
      return metric.name == name;
    })) << name;
  }
}

}  // namespace
}  // namespace mpm::vv
