#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "solver/simulation.hpp"

// Runs a small footing and prints what became of its particles, or compares it with what another build of
// this program printed. Built for several instruction sets, so it uses the solver and nothing else of the
// project.

namespace {

using namespace mpm;

constexpr const char* usage =
    "usage: step_probe SCHEME ORDER LAW[+FEATURE...] STEPS [FILE TOLERANCE]\n"
    "  SCHEME mpm ugimp cpgimp; ORDER usl usf musl; LAW elastic mohr_coulomb\n"
    "  FEATURE damping jaumann strain_sums work_sums locking_control surface_load density_ramp rigid_body "
    "float\n"
    "  without FILE prints the final state; with it compares the state with FILE's\n";

[[noreturn]] void fail(const std::string& message) {
  std::cerr << "step_probe: " << message << '\n' << usage;
  std::exit(2);
}

template <class Value>
Value chosen(const std::string& word, std::initializer_list<std::pair<const char*, Value>> values) {
  for (const auto& [name, value] : values) {
    if (word == name) return value;
  }
  fail("unknown word '" + word + "'");
}

/// Half a block on ground between walls: 13 cells wide, 10 deep, four particles each, shaken by its own
/// weight.
Scene footing(Scheme scheme, UpdateOrder order, bool yields) {
  constexpr double h = 0.02;
  Scene scene;
  scene.dimension = 2;
  scene.scheme = scheme;
  scene.update_order = order;
  scene.cell_size = h;
  scene.grid_upper = {13 * h, 16 * h};
  scene.edges = {{{Condition::roller, Condition::roller}, {Condition::fixed, Condition::free}}};
  Body ground;
  ground.name = "ground";
  ground.upper = {13 * h, 10 * h};
  ground.particles_per_cell = {2, 2};
  ground.density = 2000.0;
  if (yields) {
    ground.material = MohrCoulomb{1e6, 0.3, 20.0 / 180.0 * std::numbers::pi, 500.0, 0.0};
  } else {
    ground.material = LinearElastic{1e6, 0.3};
  }
  Body block;
  block.name = "block";
  block.lower = {0.0, 10 * h};
  block.upper = {2 * h, 14 * h};
  block.particles_per_cell = {2, 2};
  block.density = 4000.0;
  block.velocity = {0.0, -0.1};
  block.material = LinearElastic{2e7, 0.3};
  scene.bodies = {ground, block};
  scene.gravity.acceleration = {0.0, -9.81};
  scene.time_step = StableFraction{0.4};
  scene.termination = AtTime{1e9};
  return scene;
}

/// Gives the scene something that it does without otherwise.
void add(const std::string& feature, Scene& scene) {
  const double h = scene.cell_size;
  if (feature == "damping") {
    scene.damping = 0.5;
  } else if (feature == "jaumann") {
    scene.objectivity = Objectivity::jaumann;
  } else if (feature == "strain_sums") {
    scene.sums_strain = true;
  } else if (feature == "work_sums") {
    scene.sums_work = true;
  } else if (feature == "locking_control") {
    scene.bodies[0].locking_control = LockingControl::cell_average;
  } else if (feature == "surface_load") {
    scene.surface_loads = {{"ground", 1, 1, 3 * h, 8 * h, {0.0, -100.0}, 0.0}};
  } else if (feature == "density_ramp") {
    scene.bodies[1].density_ramp = DensityRamp{.start = 0.0, .stages = {{8000.0, 1.0}}};
  } else if (feature == "rigid_body") {
    scene.rigid_bodies = {
        {.name = "plate", .lower = {8 * h, 10 * h}, .upper = {10 * h, 11 * h}, .velocity = {0.0, -0.1}}};
  } else if (feature == "float") {
    scene.precision = Precision::float32;
  } else {
    fail("unknown feature '" + feature + "'");
  }
}

/// Values of a kind, and their largest size.
struct Values {
  const char* name;
  const std::vector<double>* all;
};

std::vector<Values> state_of(const ParticleFields& fields) {
  return {{"position", &fields.position},
          {"velocity", &fields.velocity},
          {"stress", &fields.stress},
          {"volume", &fields.volume}};
}

int compare(const ParticleFields& fields, const char* file, double tolerance) {
  std::ifstream other(file);
  if (!other) fail(std::string("cannot read ") + file);
  int status = 0;
  for (const Values& values : state_of(fields)) {
    double size = 0.0, difference = 0.0;
    for (const double value : *values.all) {
      double there = std::nan("");
      other >> there;
      size = std::max(size, std::abs(value));
      difference = std::abs(value - there) <= difference ? difference : std::abs(value - there);
    }
    const bool good = difference <= tolerance * size;
    std::printf("%-9s differs by %.2g of its size %s\n", values.name, difference / size,
                good ? "" : "- too much");
    if (!good) status = 1;
  }
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5 && argc != 7) fail("four or six arguments expected");
  const auto scheme =
      chosen<Scheme>(argv[1], {{"mpm", Scheme::mpm}, {"ugimp", Scheme::ugimp}, {"cpgimp", Scheme::cpgimp}});
  const auto order = chosen<UpdateOrder>(
      argv[2], {{"usl", UpdateOrder::usl}, {"usf", UpdateOrder::usf}, {"musl", UpdateOrder::musl}});
  std::istringstream words(argv[3]);
  std::string word;
  std::getline(words, word, '+');
  Scene scene = footing(scheme, order, chosen<bool>(word, {{"elastic", false}, {"mohr_coulomb", true}}));
  while (std::getline(words, word, '+')) add(word, scene);
  Simulation simulation(scene);
  for (long step = std::atol(argv[4]); step > 0; --step) {
    if (!simulation.advance()) fail(std::string("the run ended: ") + name_of(simulation.outcome().ending));
  }
  const ParticleFields fields = simulation.particles();
  if (argc == 7) return compare(fields, argv[5], std::atof(argv[6]));
  for (const Values& values : state_of(fields)) {
    for (const double value : *values.all) std::printf("%.17g\n", value);
  }
  return 0;
}
