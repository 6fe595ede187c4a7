#include "reports/model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "solver/simulation.hpp"

namespace mpm::reports {
namespace {

/// Half a block on ground, as deep as it is wide, in a grid with room above.
Scene block_on_ground() {
  Scene scene;
  scene.dimension = 2;
  scene.cell_size = 0.01;
  scene.grid_lower = {0.0, 0.0};
  scene.grid_upper = {0.2, 0.3};
  scene.edges = {{{Condition::roller, Condition::roller}, {Condition::fixed, Condition::free}}};
  Body ground;
  ground.name = "ground";
  ground.upper = {0.2, 0.2};
  ground.particles_per_cell = {2, 2};
  ground.density = 2430.0;
  ground.initial_stress = GeostaticStress{0.2, 0.658};
  ground.material = MohrCoulomb{1e6, 0.3, 20.0 * std::numbers::pi / 180.0, 0.0, 0.0};
  Body block;
  block.name = "block";
  block.lower = {0.0, 0.2};
  block.upper = {0.04, 0.26};
  block.particles_per_cell = {2, 3};
  block.density = 500.0;
  block.density_ramp = DensityRamp{0.2, {{16650.0, 1.9}}};
  block.material = LinearElastic{2e7, 0.3};
  scene.bodies = {ground, block};
  scene.gravity.acceleration = {0.0, -9.81};
  return scene;
}

ModelPlot plot_of(const Scene& scene, std::size_t panels = 1) {
  ModelPlot plot;
  for (std::size_t i = 0; i < panels; ++i) plot.panels.push_back({"a title", scene});
  plot.stamp = "stamp";
  return plot;
}

bool has(const std::vector<std::string>& lines, const std::string& words) {
  return std::any_of(lines.begin(), lines.end(),
                     [&words](const std::string& line) { return line.find(words) != std::string::npos; });
}

/// Nothing that is written runs into anything else or over the edge of the sheet.
void expect_orderly(const Picture& picture) {
  std::vector<Rectangle> written;
  for (const Layout::Panel& panel : picture.layout.panels)
    written.insert(written.end(), panel.annotations.begin(), panel.annotations.end());
  for (std::size_t i = 0; i < written.size(); ++i) {
    EXPECT_GE(written[i].left, 0.0);
    EXPECT_GE(written[i].top, 0.0);
    EXPECT_LE(written[i].right, picture.canvas.width());
    EXPECT_LE(written[i].bottom, picture.canvas.height());
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_FALSE(written[i].grown(-0.5).intersects(written[k])) << i << " " << k;
  }
}

TEST(Model, CountsTheParticlesThatTheSolverMakes) {
  Scene scene = block_on_ground();
  scene.bodies[1].ring = Ring{{0.0, 0.2}, 0.0, 0.03};
  scene.bodies[1].density_ramp.reset();
  std::size_t count = 0;
  for (const Body& body : scene.bodies) count += particle_count(body, scene.cell_size);
  EXPECT_EQ(count, Simulation(scene).particles().volume.size());
  EXPECT_EQ(particle_count(scene.bodies[0], scene.cell_size), 1600U);
}

TEST(Model, DrawsEveryParticleInItsPlace) {
  const Scene scene = block_on_ground();
  const Picture picture = draw(plot_of(scene));
  const Layout::Panel& panel = picture.layout.panels.at(0);
  ASSERT_EQ(panel.points.size(), 1600U + 4U * 6U * 6U);
  const double scale = panel.frame.width() / 0.2;
  EXPECT_NEAR(panel.frame.height() / 0.3, scale, 1e-9) << "one scale along both axes";
  EXPECT_NEAR(panel.points.front().x, panel.frame.left + 0.0025 * scale, 1e-9);
  EXPECT_NEAR(panel.points.front().y, panel.frame.bottom - 0.0025 * scale, 1e-9);
  EXPECT_NEAR(panel.points.back().y, panel.frame.bottom - (0.26 - 0.01 / 6) * scale, 1e-9);
}

TEST(Model, ColoursBodiesApart) {
  const Picture picture = draw(plot_of(block_on_ground()));
  const Layout::Panel& panel = picture.layout.panels.at(0);
  const std::vector<unsigned char> pixels = picture.canvas.pixels();
  const double per_point = picture.canvas.pixel_width() / picture.canvas.width();
  const auto red_and_blue = [&](const Point& p) {
    const auto x = static_cast<std::size_t>(p.x * per_point), y = static_cast<std::size_t>(p.y * per_point);
    const std::size_t at = 3 * (y * static_cast<std::size_t>(picture.canvas.pixel_width()) + x);
    return std::pair<int, int>{pixels[at], pixels[at + 2]};
  };
  // The ground is the colour of sand, the block blue. The first particle may have a line of its cell on it.
  const auto [ground_red, ground_blue] = red_and_blue(panel.points[120]);
  const auto [block_red, block_blue] = red_and_blue(panel.points.back());
  EXPECT_GT(ground_red, ground_blue + 40);
  EXPECT_GT(block_blue, block_red + 40);
}

TEST(Model, SaysWhatABodyIsMadeOf) {
  const Scene scene = block_on_ground();
  const auto ground = words_of_body(scene.bodies[0], scene), block = words_of_body(scene.bodies[1], scene);
  EXPECT_TRUE(has(ground, "<b>ground</b>, Mohr–Coulomb"));
  EXPECT_TRUE(has(ground, "<i>E</i> = 1000 kPa, <i>ν</i> = 0.3"));
  EXPECT_TRUE(has(ground, "<i>φ</i> = 20°, <i>c</i> = 0, <i>ψ</i> = 0°"));
  EXPECT_TRUE(has(ground, "2430 kg/m³"));
  EXPECT_TRUE(has(ground, "= 0.658"));
  EXPECT_TRUE(has(ground, "1600 particles, 2 × 2 a cell"));
  EXPECT_TRUE(has(block, "linear elastic"));
  EXPECT_TRUE(has(block, "<i>E</i> = 20 MPa"));
  EXPECT_TRUE(has(block, "500 → 16650 kg/m³"));
  EXPECT_TRUE(has(block, "linear from <i>t</i> = 0.2 s to 2.1 s"));
  EXPECT_TRUE(has(block, "144 particles, 2 × 3 a cell"));
}

TEST(Model, NamesTheExtentOfEveryBodyOnce) {
  Scene scene = block_on_ground();
  const std::size_t both = draw(plot_of(scene)).layout.panels[0].annotations.size();
  // A second block like the first, beside it, is as high and has its own place along x.
  scene.bodies.push_back(scene.bodies[1]);
  scene.bodies.back().name = "twin";
  scene.bodies.back().lower[0] += 0.1;
  scene.bodies.back().upper[0] += 0.1;
  // One more width, one more entry of the legend.
  EXPECT_EQ(draw(plot_of(scene)).layout.panels[0].annotations.size(), both + 2);
}

TEST(Model, SaysOnceWhatAllPanelsShare) {
  ModelPlot plot = plot_of(block_on_ground(), 3);
  const auto written = [&plot] {
    std::vector<std::size_t> counts;
    for (const auto& panel : draw(plot).layout.panels) counts.push_back(panel.annotations.size());
    return counts;
  };
  const std::vector<std::size_t> alike = written();
  EXPECT_GT(alike[0], alike[1]) << "the shared words are counted with the first panel";
  EXPECT_EQ(alike[1], alike[2]);
  std::get<MohrCoulomb>(plot.panels[1].scene.bodies[0].material).cohesion = 500.0;
  const std::vector<std::size_t> differing = written();
  EXPECT_EQ(differing[0], alike[0]) << "the ground's words move from the foot to the panels";
  EXPECT_EQ(differing[1], alike[1] + 1);
  EXPECT_EQ(differing[2], alike[2] + 1);
}

TEST(Model, KeepsWhatIsWrittenApart) {
  Scene scene = block_on_ground();
  expect_orderly(draw(plot_of(scene)));
  expect_orderly(draw(plot_of(scene, 5)));
  RigidBody strip;
  strip.name = "strip";
  strip.lower = {0.0, 0.26};
  strip.upper = {0.04, 0.30};
  strip.velocity = {0.0, -0.1};
  scene.rigid_bodies = {strip};
  scene.surface_loads = {{"ground", 1, 1, 0.05, 0.2, {0.0, -1e4}, 0.0}};
  expect_orderly(draw(plot_of(scene)));
  expect_orderly(draw(plot_of(scene, 2)));
}

TEST(Model, AFineModelIsDrawnAsBlocks) {
  Scene scene = block_on_ground();
  scene.cell_size = 0.0005;
  const Picture picture = draw(plot_of(scene));
  EXPECT_TRUE(picture.layout.panels[0].points.empty());
  EXPECT_GT(picture.canvas.png().size(), 10000U);
}

TEST(Model, RefusesOneDimension) {
  Scene scene = block_on_ground();
  scene.dimension = 1;
  EXPECT_THROW(draw(plot_of(scene)), std::invalid_argument);
}

}  // namespace
}  // namespace mpm::reports
