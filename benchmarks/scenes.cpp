#include "benchmarks/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "vv/case_file.hpp"

namespace mpm::bench {
namespace {

/// Nobody waits for this [s].
constexpr AtTime never{1e9};

Scene first_scene(const std::filesystem::path& file) { return vv::read_case(file).runs.front().scene; }

void set_method(const SceneChoice& choice, Scene& scene) {
  scene.scheme = choice.scheme;
  scene.update_order = choice.order;
  scene.precision = choice.precision;
  scene.termination = never;
}

Scene column(const SceneChoice& choice) {
  Scene scene = first_scene(project_root() / "vv" / "cases" / "column_figure_1.json");
  set_method(choice, scene);
  scene.gravity.level = 10;
  scene.cell_size = 1.0 / static_cast<double>(choice.particles);
  scene.grid_upper[0] = 1.0 + 2.0 * scene.cell_size;
  return scene;
}

/// The footing in cells.
struct Cells {
  double ground_width, ground_depth, block_width, block_height, free_rows;
};

Cells scaled(const Scene& scene, double scale, double cells_in_all) {
  const Body &ground = scene.bodies[0], &block = scene.bodies[1];
  const auto rounded = [&](double length) {
    return std::max(1.0, std::round(scale * length / scene.cell_size));
  };
  Cells cells{.ground_width = rounded(ground.upper[0] - ground.lower[0]),
              .ground_depth = 0,
              .block_width = rounded(block.upper[0] - block.lower[0]),
              .block_height = rounded(block.upper[1] - block.lower[1]),
              .free_rows = rounded(scene.grid_upper[1] - block.upper[1])};
  // The depth makes up for what rounding has done to the rest.
  cells.ground_depth =
      std::max(1.0, std::round((cells_in_all - cells.block_width * cells.block_height) / cells.ground_width));
  return cells;
}

void set_ground(Law law, Body& ground) {
  const MohrCoulomb soil = std::get<MohrCoulomb>(ground.material);
  const double active = std::pow(std::tan(std::atan(1.0) - soil.friction_angle / 2), 2);
  ground.initial_stress = GeostaticStress{.surface = ground.upper[1], .k0 = active};
  if (law == Law::linear_elastic) ground.material = LinearElastic{soil.youngs_modulus, soil.poissons_ratio};
}

Scene footing(const SceneChoice& choice) {
  Scene scene = first_scene(footing_case());
  set_method(choice, scene);
  Body &ground = scene.bodies.at(0), &block = scene.bodies.at(1);
  const double per_cell = ground.particles_per_cell[0] * ground.particles_per_cell[1];
  const double wanted = static_cast<double>(choice.particles) / per_cell;
  double paper = 0;
  for (const Body& body : scene.bodies) {
    paper += (body.upper[0] - body.lower[0]) * (body.upper[1] - body.lower[1]) / std::pow(scene.cell_size, 2);
  }
  const Cells cells = scaled(scene, std::sqrt(wanted / paper), wanted);
  const double size = (ground.upper[0] - ground.lower[0]) / cells.ground_width;
  scene.cell_size = size;
  scene.grid_upper = {cells.ground_width * size,
                      (cells.ground_depth + cells.block_height + cells.free_rows) * size};
  ground.upper = {scene.grid_upper[0], cells.ground_depth * size};
  block.lower = {0, ground.upper[1]};
  block.upper = {cells.block_width * size, (cells.ground_depth + cells.block_height) * size};
  block.density_ramp.reset();
  scene.time_step = StableFraction{0.5};
  set_ground(choice.law, ground);
  return scene;
}

}  // namespace

std::string name_of(SceneChoice::Model model) {
  return model == SceneChoice::Model::column ? "column" : "footing";
}
std::string name_of(Scheme scheme) {
  return scheme == Scheme::mpm ? "mpm" : scheme == Scheme::ugimp ? "ugimp" : "cpgimp";
}
std::string name_of(UpdateOrder order) {
  return order == UpdateOrder::musl ? "musl" : order == UpdateOrder::usf ? "usf" : "usl";
}
std::string name_of(Law law) { return law == Law::linear_elastic ? "linear_elastic" : "mohr_coulomb"; }
std::string name_of(Precision precision) { return precision == Precision::float64 ? "float64" : "float32"; }

std::filesystem::path project_root() {
  const char* root = std::getenv("MPMVV_ROOT");
  return root && *root ? root : MPMVV_BUILT_FROM;
}

std::filesystem::path footing_case() {
  return project_root() / "benchmarks" / "cases" / "footing_paper.json";
}

Scene scene_of(const SceneChoice& choice) {
  if (choice.particles < 1) throw std::invalid_argument("a scene without particles");
  return choice.model == SceneChoice::Model::column ? column(choice) : footing(choice);
}

int available_threads() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

Simulation simulation_of(const Scene& scene, int threads) {
  if (threads < 1 || threads > available_threads()) throw std::invalid_argument("too many threads");
  return Simulation(scene, threads);
}

}  // namespace mpm::bench
