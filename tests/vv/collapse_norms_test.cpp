// Deposits made up of particles whose surface is known.

#include "vv/collapse_norms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "solver/particles.hpp"
#include "vv/norms.hpp"

namespace mpm::vv {
namespace {

constexpr double cell = 0.05, spacing = cell / 2, width = 0.4, height = 0.4;
constexpr PerAxis wall{1.0, 2.0};  ///< the corner of wall and base
const double of_a_particle = spacing / std::sqrt(12.0);

/// A column as high as wide, 256 particles, with room for twice its width beside it.
Scene column() {
  Scene scene;
  scene.dimension = 2;
  scene.scheme = Scheme::ugimp;
  scene.cell_size = cell;
  scene.grid_lower = wall;
  scene.grid_upper = {wall[0] + 3 * width, wall[1] + 2 * height};
  scene.edges = {{{Condition::roller, Condition::free}, {Condition::fixed, Condition::free}}};
  Body block;
  block.name = "sand";
  block.lower = wall;
  block.upper = {wall[0] + width, wall[1] + height};
  block.particles_per_cell = {2, 2};
  block.density = 1000.0;
  block.material = MohrCoulomb{1e6, 0.3, 0.5, 0.0, 0.0};
  scene.bodies = {block};
  scene.gravity.acceleration = {0.0, -10.0};
  return scene;
}

using Field = std::function<double(double x, double y)>;

void add(ParticleFields& fields, double x, double y, double half_height, double area) {
  fields.dimension = 2;
  for (auto* field : {&fields.initial_position, &fields.position}) {
    field->push_back(wall[0] + x);
    field->push_back(wall[1] + y);
  }
  fields.displacement.insert(fields.displacement.end(), {0.0, 0.0});
  fields.half_size.insert(fields.half_size.end(), {spacing / 2, half_height});
  for (auto* field : {&fields.volume, &fields.initial_volume, &fields.mass}) field->push_back(area);
  fields.body.push_back(0);
}

/// Columns of particles a spacing wide from `begin` to `end`, exactly as high as the surface at their middle.
void heap(ParticleFields& fields, double begin, double end, const std::function<double(double)>& surface) {
  for (double x = begin + spacing / 2; x < end; x += spacing) {
    const int count = std::max(1, static_cast<int>(std::lround(surface(x) / spacing)));
    const double each = surface(x) / count;
    for (int k = 0; k < count; ++k) add(fields, x, (k + 0.5) * each, each / 2, spacing * each);
  }
}

ParticleFields heap(double end, const std::function<double(double)>& surface) {
  ParticleFields fields;
  heap(fields, 0.0, end, surface);
  return fields;
}

double level(double) { return height; }
double slope(double x) { return 0.4 - 0.5 * x; }  // as much area as the column

/// The column after displacements.
ParticleFields moved(const Field& along_x, const Field& along_y) {
  const Scene scene = column();
  ParticleFields fields;
  for (const PerAxis& place : lattice_of(scene, scene.bodies[0]).centers) {
    const double x = place[0] - wall[0], y = place[1] - wall[1];
    add(fields, x, y, spacing / 2, spacing * spacing);
    const PerAxis travel{along_x(x, y), along_y(x, y)};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      fields.position[fields.position.size() - 2 + axis] += travel[axis];
      fields.displacement[fields.displacement.size() - 2 + axis] = travel[axis];
    }
  }
  return fields;
}

double still(double, double) { return 0.0; }

// ---- surface

TEST(FreeSurface, OfTheColumnItselfIsLevelAndAsSureAsAParticle) {
  const ParticleFields fields = heap(width, level);
  const Curve surface = Deposit(column(), fields).free_surface();
  ASSERT_EQ(surface.x.size(), 24u);
  EXPECT_EQ(surface.name, "free_surface");
  EXPECT_EQ(surface.source, "run");
  EXPECT_EQ(surface.x_name, "position");
  for (std::size_t k = 0; k < 24; ++k) {
    EXPECT_NEAR(surface.x[k], (static_cast<double>(k) + 0.5) * cell, 1e-12);
    if (k == 7) continue;
    EXPECT_NEAR(surface.uncertainty[k], of_a_particle, 1e-9) << k;
    EXPECT_NEAR(surface.y[k], k < 8 ? height : 0.0, 1e-12) << k;
  }
  // At the edge the slope is taken for one of 45 degrees.
  EXPECT_NEAR(surface.y[7], height, spacing / 2 + 1e-12);
}

TEST(FreeSurface, OfASlopeIsTheSlopeAtTheMiddleOfEachCell) {
  const ParticleFields fields = heap(0.8, slope);
  const Curve surface = Deposit(column(), fields).free_surface();
  for (std::size_t k = 0; k < 15; ++k) EXPECT_NEAR(surface.y[k], slope(surface.x[k]), 1e-9) << k;
  for (std::size_t k = 16; k < 24; ++k) EXPECT_EQ(surface.y[k], 0.0) << k;
}

TEST(FreeSurface, OfAStaircaseIsThatOfItsSteps) {
  const ParticleFields fields = heap(0.8, [](double x) { return x < 0.4 ? 0.3 : 0.1; });
  const Curve surface = Deposit(column(), fields).free_surface();
  for (const std::size_t k : {0u, 3u, 6u}) EXPECT_NEAR(surface.y[k], 0.3, 1e-12);
  for (const std::size_t k : {9u, 12u, 14u}) EXPECT_NEAR(surface.y[k], 0.1, 1e-12);
}

TEST(FreeSurface, DoesNotCountGrainsThatHaveFlownOff) {
  ParticleFields fields = heap(0.8, slope);
  const Curve before = Deposit(column(), fields).free_surface();
  add(fields, 0.1, slope(0.1) + 1.2 * cell, spacing / 2, spacing * spacing);  // in the air
  add(fields, 0.95, spacing / 2, spacing / 2, spacing * spacing);             // on the base, ahead
  const Deposit deposit(column(), fields);
  EXPECT_EQ(deposit.free_surface().y, before.y);
  EXPECT_NEAR(deposit.scattered(), 2 * spacing * spacing / (0.16 + 2 * spacing * spacing), 1e-9);
}

TEST(FreeSurface, ReachesOverGapsUpToACell) {
  const auto low = [](double) { return spacing; };
  ParticleFields near = heap(width, level), far = near;
  heap(near, width + 0.9 * cell - spacing, width + 4 * cell, low);
  heap(far, width + 1.1 * cell, width + 4 * cell, low);
  EXPECT_NEAR(Deposit(column(), near).free_surface().y[10], spacing, 1e-9);
  EXPECT_EQ(Deposit(column(), near).scattered(), 0.0);
  EXPECT_EQ(Deposit(column(), far).free_surface().y[10], 0.0);
  EXPECT_GT(Deposit(column(), far).scattered(), 0.01);
}

TEST(FreeSurface, IsLessSureWhereItStandsOnVoids) {
  constexpr double lift = 0.02;
  const ParticleFields fields =
      moved(still, [](double, double y) { return y > height - spacing ? lift : 0.0; });
  const Deposit deposit(column(), fields);
  const Curve surface = deposit.free_surface();
  EXPECT_NEAR(surface.y[2], height + lift, 1e-12);
  EXPECT_NEAR(surface.uncertainty[2], std::hypot(of_a_particle, lift / std::sqrt(3.0)), 1e-12);
  // Beside the edge it is read too high by a quarter of a cell, as of the column at rest.
  const ParticleFields column_itself = heap(width, level);
  EXPECT_NEAR(deposit.area_change() - Deposit(column(), column_itself).area_change(), lift / height, 1e-9);
  EXPECT_NEAR(Deposit(column(), column_itself).area_change(), 0.0, spacing / 2 / height / 8 + 1e-9);
}

TEST(FreeSurface, OfPointsTakesTheirSpacing) {
  ParticleFields fields = heap(width, level);
  std::fill(fields.half_size.begin(), fields.half_size.end(), 0.0);
  EXPECT_NEAR(Deposit(column(), fields).free_surface().y[2], height, 1e-12);
}

// ---- foot

TEST(FootOfADeposit, OfAWedgeIsItsTip) {
  const ParticleFields fields = heap(0.8, slope);
  EXPECT_NEAR(Deposit(column(), fields).foot(), 0.8, 0.008);
}

TEST(FootOfADeposit, DoesNotNoticeSingleGrains) {
  ParticleFields fields = heap(0.8, slope);
  const double before = Deposit(column(), fields).foot();
  add(fields, 1.1, spacing / 2, spacing / 2, 1e-3 * 0.16);
  EXPECT_NEAR(Deposit(column(), fields).foot(), before, 0.01);
}

TEST(FootOfADeposit, OfACliffLiesALittleTooFar) {
  const ParticleFields fields = heap(width, level);
  const double foot = Deposit(column(), fields).foot();
  // By 4 % for particles without size; here one column of them is 6 %.
  EXPECT_GT(foot, 1.02 * width);
  EXPECT_LT(foot, 1.12 * width);
}

// ---- failure line

TEST(FailureLine, LiesWhereTheDisplacementPassesItsShareOfTheHeight) {
  // From a row of particles on the displacement grows by a tenth of the height above it; 6 mm are 60 mm
  // above.
  constexpr double row = 3.5 * spacing, least = moved_share * height;
  const ParticleFields fields = moved([](double, double y) { return std::max(0.06 * (y - row), 0.0); },
                                      [](double, double y) { return std::min(-0.08 * (y - row), 0.0); });
  const Curve line = Deposit(column(), fields).failure_line();
  EXPECT_EQ(line.name, "failure_line");
  ASSERT_EQ(line.x.size(), 16u);
  for (std::size_t k = 0; k < 16; ++k) {
    EXPECT_NEAR(line.x[k], (static_cast<double>(k) + 0.5) * spacing, 1e-12);
    EXPECT_NEAR(line.y[k], row + least / 0.1, 1e-9);
    EXPECT_NEAR(line.uncertainty[k], std::hypot(of_a_particle, 0.75 * least / 0.1), 1e-9);
  }
}

TEST(FailureLine, IsTheColumnsHeightWhereAllStayedAndTheBaseWhereNoneDid) {
  const ParticleFields fields = moved([](double x, double) { return x < 0.2 ? 1e-4 : 0.5; }, still);
  const Curve line = Deposit(column(), fields).failure_line();
  for (std::size_t k = 0; k < 8; ++k) EXPECT_DOUBLE_EQ(line.y[k], height);
  for (std::size_t k = 8; k < 16; ++k)
    EXPECT_NEAR(line.y[k], moved_share * height / 0.5 * spacing / 2, 1e-12);
}

TEST(FailureLine, IsTheLowestThatMovedWhateverLiesAbove) {
  const ParticleFields fields =
      moved([](double, double y) { return y > 0.1 && y < 0.15 ? 0.5 : 0.0; }, still);
  for (const double y : Deposit(column(), fields).failure_line().y) {
    EXPECT_GT(y, 0.1 - spacing);
    EXPECT_LT(y, 0.1 + spacing);
  }
}

TEST(FailureLine, KnowsMovedFromStayedByTheirShare) {
  constexpr double least = moved_share * height;
  for (const double share : {0.9, 1.1}) {
    const ParticleFields fields =
        moved([&](double, double y) { return y < spacing ? share * least : 0.0; }, still);
    const Curve line = Deposit(column(), fields).failure_line();
    EXPECT_EQ(line.y[3]<spacing, share> 1.0) << line.y[3];
  }
}

// ---- which scenes, and what is said of them

TEST(Collapse, IsAColumnThatFallsByItsWeightAlone) {
  EXPECT_EQ(why_no_collapse(column()), "");
  const std::vector<std::pair<const char*, std::function<void(Scene&)>>> others = {
      {"two dimensions", [](Scene& s) { s.dimension = 1; }},
      {"a single block", [](Scene& s) { s.bodies.push_back(s.bodies[0]); }},
      {"a plain block", [](Scene& s) { s.bodies[0].ring = Ring{}; }},
      {"a plain block", [](Scene& s) { s.bodies[0].density_ramp = DensityRamp{}; }},
      {"a block of Mohr-Coulomb's law",
       [](Scene& s) {
         s.bodies[0].material = LinearElastic{1e6, 0.3};
       }},
      {"fixed lower edge", [](Scene& s) { s.edges[1][0] = Condition::roller; }},
      {"fixed lower edge", [](Scene& s) { s.bodies[0].lower[1] += cell; }},
      {"begins at a wall", [](Scene& s) { s.edges[0][0] = Condition::free; }},
      {"begins at a wall", [](Scene& s) { s.bodies[0].lower[0] += cell; }},
      {"room for the block", [](Scene& s) { s.grid_upper[0] = s.bodies[0].upper[0]; }},
      {"gravity straight down",
       [](Scene& s) {
         s.gravity.acceleration = {1.0, -10.0};
       }},
      {"gravity straight down",
       [](Scene& s) {
         s.gravity.acceleration = {0.0, 10.0};
       }},
      {"gravity straight down", [](Scene& s) { s.gravity.level = 0.0; }},
      {"nothing else that acts", [](Scene& s) { s.rigid_bodies.emplace_back(); }},
      {"nothing else that acts", [](Scene& s) { s.surface_loads.emplace_back(); }},
      {"nothing else that acts", [](Scene& s) { s.driven_motion.emplace(); }}};
  for (const auto& [lack, change] : others) {
    Scene scene = column();
    change(scene);
    EXPECT_NE(why_no_collapse(scene).find(lack), std::string::npos) << lack << ": " << why_no_collapse(scene);
  }
  Scene fixed_wall = column();
  fixed_wall.edges[0][0] = Condition::fixed;
  EXPECT_EQ(why_no_collapse(fixed_wall), "");
}

struct Trial {
  Case definition;
  RunRequest request;
  Record record;

  Trial() {
    request.scene = column();
    request.scene.bodies[0].upper[0] = wall[0] + 0.5;
    ParticleFields fields = heap(0.8, slope);
    const std::vector<PerAxis> centers = lattice_of(request.scene, request.scene.bodies[0]).centers;
    for (std::size_t p = 0; p < fields.mass.size(); ++p) {
      for (std::size_t a = 0; a < 2; ++a) fields.initial_position[2 * p + a] = centers[p % centers.size()][a];
    }
    record.snapshots = {{"end", 1.0, fields}};
  }
  Judgement judged() const { return judge(definition, request, record); }
  std::map<std::string, double> metrics() const {
    std::map<std::string, double> found;
    for (const auto& [name, value] : judged().metrics) {
      if (name.starts_with("collapse.")) found[name] = value;
    }
    return found;
  }
};

TEST(CollapseMetrics, SpeakInWidthsOfTheColumn) {
  const auto metrics = Trial().metrics();
  EXPECT_NEAR(metrics.at("collapse.aspect_ratio"), 0.8, 1e-12);
  EXPECT_NEAR(metrics.at("collapse.run_out"), 0.8 / 0.5 - 1, 0.02);
  EXPECT_NEAR(metrics.at("collapse.deposit_height"), slope(cell / 2) / 0.5, 1e-9);
  EXPECT_NEAR(metrics.at("collapse.area_change"), 0.0, 0.01);
  EXPECT_NEAR(metrics.at("collapse.scattered"), 0.0, 1e-12);
  EXPECT_EQ(metrics.size(), 5u) << "no duration without a probe";
}

TEST(CollapseMetrics, ComeWithTheCurvesThatTheyAreReadFrom) {
  std::vector<std::string> names;
  for (const Curve& curve : Trial().judged().curves) {
    names.push_back(curve.name);
    EXPECT_EQ(curve.uncertainty.size(), curve.y.size());
  }
  EXPECT_EQ(names, (std::vector<std::string>{"free_surface", "failure_line"}));
}

TEST(CollapseMetrics, AreAboutTheEnd) {
  Trial trial;
  trial.record.snapshots[0].moment = "t = 1 s";
  EXPECT_EQ(trial.metrics().size(), 1u) << "the aspect ratio alone";
  EXPECT_TRUE(trial.judged().curves.empty());
}

TEST(CollapseMetrics, SayNothingOfOtherScenes) {
  Trial trial;
  trial.request.scene.edges[1][0] = Condition::roller;
  EXPECT_TRUE(trial.metrics().empty());
}

TEST(CollapseDuration, IsWhenMostOfTheEnergyIsReleased) {
  Trial trial;
  HistoryProbe probe;
  probe.id = probe.quantity = "potential_energy";
  probe.target = ProbeTarget::everything;
  trial.definition.probes = {probe};
  trial.record.histories = {
      {"potential_energy", "potential_energy", {0.0, 0.1, 0.2, 0.3}, {0.0, -5.0, -9.95, -10.0}}};
  EXPECT_EQ(trial.metrics().at("collapse.duration"), 0.2);
  trial.record.histories[0].value[2] = -9.85;
  EXPECT_EQ(trial.metrics().at("collapse.duration"), 0.3);
}

}  // namespace
}  // namespace mpm::vv
