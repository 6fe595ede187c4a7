// Footings judged through made-up snapshots: what has risen, where the ground is sheared, how deep it moves.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "solver/particles.hpp"
#include "tests/support/footing_scenes.hpp"
#include "vv/norms.hpp"

namespace mpm::vv {
namespace {

using namespace mpm::test;

/// A displacement [m] and an engineering shear strain at an initial place.
struct Motion {
  std::function<PerAxis(double x, double y)> displacement = [](double, double) { return PerAxis{}; };
  std::function<double(double x, double y)> strain = [](double, double) { return 0.0; };
};

/// All bodies of a scene after a motion; particles 0.05 m apart.
Snapshot moved(const Scene& scene, const Motion& motion, double time, const std::string& moment) {
  Snapshot snapshot{moment, time, {}};
  ParticleFields& fields = snapshot.fields;
  fields.dimension = 2;
  for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
    for (const PerAxis& place : lattice_of(scene, scene.bodies[body]).centers) {
      const PerAxis displacement = motion.displacement(place[0], place[1]);
      for (std::size_t axis = 0; axis < 2; ++axis) {
        fields.initial_position.push_back(place[axis]);
        fields.displacement.push_back(displacement[axis]);
        fields.position.push_back(place[axis] + displacement[axis]);
        fields.velocity.push_back(0.0);
        fields.half_size.push_back(0.025);
      }
      // Partly as difference of the normal strains, partly as shear: 3-4-5.
      const double strain = motion.strain(place[0], place[1]);
      fields.stress.insert(fields.stress.end(), 4, 0.0);
      fields.strain.insert(fields.strain.end(), {0.3 * strain, -0.3 * strain, 0.0, 0.4 * strain});
      for (auto* field : {&fields.volume, &fields.initial_volume, &fields.mass}) field->push_back(0.0025);
      fields.body.push_back(body);
    }
  }
  return snapshot;
}

using Metrics = std::map<std::string, double>;

Scene strained(Scene scene) {
  scene.sums_strain = true;
  return scene;
}

Metrics metrics_of(const Scene& scene, const Case& definition, const Record& record) {
  RunRequest request;
  request.scene = scene;
  Metrics found;
  for (const auto& [name, value] : judge(definition, request, record).metrics) {
    if (name.starts_with("mechanism.")) found[name] = value;
  }
  return found;
}

/// After 1 s, when the strip has gone down by 0.1 m.
Metrics metrics_of(const Scene& scene, const Motion& motion) {
  Case definition;
  definition.snapshots = {SnapshotRequest{}};  // the end
  Record record;
  record.end_time = 1.0;
  record.snapshots = {moved(scene, motion, 1.0, "end")};
  return metrics_of(scene, definition, record);
}

// ---- heave

/// Up by 20 mm beside the strip as far as 1 m from it, down by 10 mm beyond; more below the surface.
PerAxis risen(double from_edge, double depth) {
  if (from_edge < 0.0) return {0.0, -0.1};
  if (depth > 0.05) return {0.0, 0.3};
  return {0.0, from_edge < 1.0 ? 0.02 : -0.01};
}

TEST(Heave, IsWhatHasRisenOverWhatWasDisplaced) {
  const Motion motion{[](double x, double y) { return risen(x - 0.4, 2.0 - y); }};
  // 20 mm times 1 m over 0.1 m times 0.4 m.
  EXPECT_NEAR(metrics_of(half_model(clay()), motion).at("mechanism.heave_1"), 0.5, 1e-9);
}

TEST(Heave, OfAFullModelCountsBothSides) {
  const Motion motion{[](double x, double y) { return risen(std::abs(x - 2.0) - 0.4, 2.0 - y); }};
  EXPECT_NEAR(metrics_of(full_model(clay()), motion).at("mechanism.heave_1"), 0.5, 1e-9);
  const Motion one_side{[](double x, double y) { return x < 2.0 ? risen(1.6 - x, 2.0 - y) : PerAxis{}; }};
  EXPECT_NEAR(metrics_of(full_model(clay()), one_side).at("mechanism.heave_1"), 0.25, 1e-9);
}

TEST(Heave, OfABlockIsOverItsOwnDescent) {
  // The block goes down by 0.05 m and its upper half by 0.02 m more.
  const Motion motion{[](double x, double y) {
    if (y > 2.0) return PerAxis{0.0, y > 2.1 ? -0.07 : -0.05};
    return risen(x - 0.4, 2.0 - y);
  }};
  EXPECT_NEAR(metrics_of(block_model(clay()), motion).at("mechanism.heave_1"), 0.02 / (0.06 * 0.4), 1e-9);
}

// ---- bubble

TEST(Bubble, EndsWhereTheAxisMovesHalfAsMuchAsTheFooting) {
  // Half at 0.5 m of depth, where the particle has gone down by 0.05 m: 0.45 m below the base, 0.8 m wide.
  const auto fading = [](double, double y) { return PerAxis{0.0, -0.1 * (y - 1.0)}; };
  EXPECT_NEAR(metrics_of(half_model(clay()), {fading}).at("mechanism.bubble_1"), 0.45 / 0.8, 1e-9);
  EXPECT_NEAR(metrics_of(full_model(clay()), {fading}).at("mechanism.bubble_1"), 0.45 / 0.8, 1e-9);
  // Only the axis counts, and sideways is as good as down.
  const auto sideways = [&](double x, double y) {
    return x < 0.05 ? PerAxis{0.1 * (y - 1.0), 0.0} : PerAxis{0.0, -0.1};
  };
  EXPECT_NEAR(metrics_of(half_model(clay()), {sideways}).at("mechanism.bubble_1"), 0.4 / 0.8, 1e-9);
}

TEST(Bubble, IsNoneWhereTheGroundStaysBehindOrGoesDownAsAWhole) {
  EXPECT_FALSE(metrics_of(half_model(clay()), {}).contains("mechanism.bubble_1"));
  const auto all = [](double, double) { return PerAxis{0.0, -0.1}; };
  EXPECT_FALSE(metrics_of(half_model(clay()), {all}).contains("mechanism.bubble_1"));
}

// ---- bands

/// A band down from the edge at x = 0.4 m to 0.6 m below the surface, out to x = 1.6 m and up again, as a
/// strain.
double channel(double x, double depth, double strain) {
  const bool down = std::abs(x - 0.4) < 0.05 && depth < 0.6;
  const bool out = x > 0.35 && x < 1.6 && depth > 0.5 && depth < 0.6;
  const bool up = x > 1.5 && x < 1.6 && depth < 0.6;
  return down || out || up ? strain : 0.0;
}

Motion sheared(double strain) {
  return {.strain = [=](double x, double y) { return channel(x, 2.0 - y, strain); }};
}

/// A quarter of 0.1 m over 0.8 m.
constexpr double least_strain = 0.03125;

TEST(Band, ReachesFromTheEdgeToTheSurface) {
  const Metrics found = metrics_of(strained(half_model(clay())), sheared(1.001 * least_strain));
  EXPECT_NEAR(found.at("mechanism.band_reach_1"), (1.575 - 0.4) / 0.8, 1e-9);
  EXPECT_NEAR(found.at("mechanism.band_depth_1"), (0.575 - 0.1) / 0.8, 1e-9);
}

TEST(Band, IsWhereTheStrainIsAQuarterOfSettlementOverWidth) {
  const Metrics found = metrics_of(strained(half_model(clay())), sheared(0.999 * least_strain));
  EXPECT_EQ(found.at("mechanism.band_reach_1"), 0.0);
  EXPECT_EQ(found.at("mechanism.band_depth_1"), 0.0);
}

TEST(Band, IsCutByAGapOfOneParticle) {
  Motion cut = sheared(1.0);
  const auto whole = cut.strain;
  cut.strain = [=](double x, double y) { return x > 1.0 && x < 1.05 ? 0.0 : whole(x, y); };
  const Metrics found = metrics_of(strained(half_model(clay())), cut);
  EXPECT_EQ(found.at("mechanism.band_reach_1"), 0.0);
  EXPECT_NEAR(found.at("mechanism.band_depth_1"), (0.575 - 0.1) / 0.8, 1e-9);
}

TEST(Band, FollowsParticlesToWhereTheyAre) {
  // What lies beyond 1 m has moved away by 0.2 m: no neighbour is left there. Moved by one spacing less it
  // is.
  for (const double away : {0.2, 0.02}) {
    Motion apart = sheared(1.0);
    apart.displacement = [=](double x, double) { return PerAxis{x > 1.0 ? away : 0.0, 0.0}; };
    const double reach = metrics_of(strained(half_model(clay())), apart).at("mechanism.band_reach_1");
    EXPECT_NEAR(reach, away > 0.1 ? 0.0 : (1.575 + away - 0.4) / 0.8, 1e-9);
  }
}

TEST(Band, BesideTheEdgeIsNoReach) {
  const Motion narrow{.strain = [](double x, double y) { return x > 0.3 && x < 0.5 && y > 1.7 ? 1.0 : 0.0; }};
  EXPECT_EQ(metrics_of(strained(half_model(clay())), narrow).at("mechanism.band_reach_1"), 0.0);
  const Motion wider{.strain = [](double x, double y) { return x > 0.3 && x < 0.55 && y > 1.7 ? 1.0 : 0.0; }};
  EXPECT_NEAR(metrics_of(strained(half_model(clay())), wider).at("mechanism.band_reach_1"), 0.125 / 0.8,
              1e-9);
  // Two rows are the surface, the third is not.
  for (const double depth : {0.06, 0.11}) {
    const Motion below{
        .strain = [=](double x, double y) { return x > 0.3 && x < 0.8 && y < 2 - depth && y > 1.7; }};
    EXPECT_EQ(metrics_of(strained(half_model(clay())), below).at("mechanism.band_reach_1") > 0.0,
              depth < 0.1);
  }
}

TEST(Band, OfAFullModelMayComeUpOnEitherSide) {
  const Motion left{.strain = [](double x, double y) { return channel(2.0 - x, 2.0 - y, 1.0); }};
  Scene scene = strained(full_model(clay()));
  EXPECT_NEAR(metrics_of(scene, left).at("mechanism.band_reach_1"), (1.575 - 0.4) / 0.8, 1e-9);
  // The half model's right edge sees nothing of what lies beyond its axis.
  const Motion right{.strain = [](double x, double y) { return channel(x - 2.0, 2.0 - y, 1.0); }};
  EXPECT_NEAR(metrics_of(scene, right).at("mechanism.band_reach_1"), (1.575 - 0.4) / 0.8, 1e-9);
}

TEST(Band, NeedsTheSumOfTheStrain) {
  const Metrics found = metrics_of(half_model(clay()), sheared(1.0));
  EXPECT_FALSE(found.contains("mechanism.band_reach_1"));
  EXPECT_FALSE(found.contains("mechanism.band_depth_1"));
  EXPECT_TRUE(found.contains("mechanism.heave_1"));
}

// ---- which snapshot is which

SnapshotRequest at(double time) {
  SnapshotRequest request;
  request.when = SnapshotRequest::When::time;
  request.time = time;
  return request;
}

TEST(MechanismOfSnapshots, CountsThemInTheOrderOfTheCase) {
  const Scene scene = strained(half_model(clay()));
  const Motion motion{[](double x, double y) { return risen(x - 0.4, 2.0 - y); }};
  Case definition;
  definition.snapshots = {SnapshotRequest{}, at(5.0), at(2.0)};
  Record record;
  record.end_time = 10.0;
  record.snapshots = {moved(scene, motion, 2.0, "t = 2 s"), moved(scene, motion, 10.0, "end")};
  const Metrics found = metrics_of(scene, definition, record);
  EXPECT_NEAR(found.at("mechanism.heave_1"), 0.05, 1e-9);
  EXPECT_FALSE(found.contains("mechanism.heave_2"));  // whose moment did not come
  EXPECT_NEAR(found.at("mechanism.heave_3"), 0.25, 1e-9);
  // A broken run's last state is that of the breakdown.
  record.outcome.ending = Ending::domain_too_large;
  const Metrics broken = metrics_of(scene, definition, record);
  EXPECT_FALSE(broken.contains("mechanism.heave_1"));
  EXPECT_NEAR(broken.at("mechanism.heave_3"), 0.25, 1e-9);
}

TEST(MechanismOfSnapshots, NeedsAFootingThatHasMoved) {
  Scene scene = half_model(clay());
  const Motion motion{[](double x, double y) { return risen(x - 0.4, 2.0 - y); }};
  scene.rigid_bodies[0].start = 1.0;
  EXPECT_TRUE(metrics_of(scene, motion).empty());
  scene.rigid_bodies[0].start = 0.0;
  EXPECT_FALSE(metrics_of(scene, motion).empty());
  scene.rigid_bodies[0].lower[1] = 2.1;
  EXPECT_TRUE(metrics_of(scene, motion).empty());
}

TEST(MechanismCatalogue, HoldsSixSnapshotsAndWhatIsMeasuredOfThem) {
  const Scene scene = strained(half_model(clay()));
  Motion motion = sheared(1.0);
  motion.displacement = [](double, double y) { return PerAxis{0.0, -0.1 * (y - 1.0)}; };
  Case definition;
  Record record;
  record.end_time = 10.0;
  for (int k = 1; k <= 7; ++k) {
    definition.snapshots.push_back(at(k));
    record.snapshots.push_back(moved(scene, motion, 1.0, "t = " + std::to_string(k) + " s"));
  }
  const Metrics found = metrics_of(scene, definition, record);
  std::vector<std::string> measured, listed;
  for (const auto& [name, value] : found) measured.push_back(name);
  for (const Metric& metric : metric_catalogue()) {
    if (metric.name.starts_with("mechanism.")) listed.push_back(metric.name);
  }
  std::sort(listed.begin(), listed.end());
  EXPECT_EQ(measured, listed);
  EXPECT_EQ(listed.size(), 24u);
}

}  // namespace
}  // namespace mpm::vv
