#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>

#include "solver/error.hpp"
#include "solver/scene.hpp"

namespace mpm::test {

/// Scenes drawn at random from all that the solver can do, the same for a number on every machine. Every
/// scheme, update order, dimension and precision occurs once in 36 numbers in a row.
class RandomScene {
 public:
  /// Always a scene that `check` accepts.
  static Scene number(std::uint64_t number) {
    for (std::uint64_t attempt = 0;; ++attempt) {
      Scene scene = RandomScene(number, attempt).draw(number);
      try {
        check(scene);
        return scene;
      } catch (const SceneError&) {  // such as a ring that no particle is in: draw again
      }
    }
  }

 private:
  static constexpr double modulus = 1e5, density = 1000.0;  // a wave takes 10 m/s

  RandomScene(std::uint64_t number, std::uint64_t attempt) : random_(1000 * number + attempt + 1) {}

  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) / 9007199254740992.0;
  }
  int whole(int low, int high) {
    return low + static_cast<int>(random_() % static_cast<std::uint64_t>(high - low + 1));
  }
  bool chance(double share) { return between(0.0, 1.0) < share; }

  Scene draw(std::uint64_t number) {
    Scene scene;
    scene.scheme = std::array{Scheme::mpm, Scheme::ugimp, Scheme::cpgimp}[number % 3];
    scene.update_order = std::array{UpdateOrder::musl, UpdateOrder::usf, UpdateOrder::usl}[number / 3 % 3];
    scene.dimension = 2 - static_cast<int>(number / 9 % 2);
    scene.precision = number / 18 % 2 == 0 ? Precision::float64 : Precision::float32;
    scene.objectivity = scene.dimension == 2 && chance(0.5) ? Objectivity::jaumann : Objectivity::none;
    scene.damping = chance(0.5) ? 0.5 : 0.0;
    scene.flip_fraction = chance(0.5) ? 1.0 : between(0.0, 1.0);
    scene.sums_strain = chance(0.5);
    scene.sums_work = scene.flip_fraction < 1.0;
    if (scene.sums_strain) scene.domain_limit = 0.51;
    scene.cell_size = 0.1;
    cells_ = {scene.dimension == 1 ? whole(61, 190) : whole(9, 37), whole(8, 19)};
    for (std::size_t a = 0; a < 2; ++a) {
      scene.grid_lower[a] = between(-1.0, 1.0);
      scene.grid_upper[a] = scene.grid_lower[a] + cells_[a] * scene.cell_size;
    }
    for (auto& axis : scene.edges) {
      for (Condition& edge : axis)
        edge = chance(0.6) ? Condition::roller : chance(0.6) ? Condition::fixed : Condition::free;
    }
    draw_bodies(scene);
    if (chance(0.4)) draw_rigid_body(scene);
    if (chance(0.4)) draw_surface_load(scene);
    if (chance(0.15)) drive(scene);
    draw_gravity(scene);
    scene.time_step = StableFraction{between(0.1, 0.4)};
    scene.termination = AtTime{1e9};
    if (scene.dimension == 2) draw_locking_control(scene);
    if (!scene.driven_motion) draw_inertia(scene);
    draw_numerics(scene);
    return scene;
  }

  /// Bodies side by side, often in touch, and then often in one cell; some reach the edges of the grid.
  void draw_bodies(Scene& scene) {
    const std::array<int, max_dimension> per_cell{whole(1, 3), whole(1, 3)};
    const double spacing_x = scene.cell_size / per_cell[0], spacing_y = scene.cell_size / per_cell[1];
    const int wide = cells_[0] * per_cell[0], high = cells_[1] * per_cell[1], count = whole(1, 3);
    for (int b = 0; b < count; ++b) {
      const auto margin = [&] { return chance(0.5) ? 0 : whole(1, 4); };
      const int first = wide * b / count + margin(), last = wide * (b + 1) / count - margin();
      const int low = chance(0.4) ? 0 : whole(0, high / 2), top = chance(0.2) ? high : whole(high / 2, high);
      Body body;
      body.name = "body " + std::to_string(b);
      body.lower = {scene.grid_lower[0] + first * spacing_x, scene.grid_lower[1] + low * spacing_y};
      body.upper = {scene.grid_lower[0] + last * spacing_x, scene.grid_lower[1] + top * spacing_y};
      body.particles_per_cell = per_cell;
      body.density = density * between(0.5, 1.5);
      const double speed = chance(0.2) ? 0.0 : between(0.2, 2.5), angle = between(0, 2 * std::numbers::pi);
      body.velocity = {speed * std::cos(angle), speed * std::sin(angle)};
      draw_material(scene.dimension, body);
      if (scene.dimension == 2 && chance(0.25)) {
        const double radius = std::max(body.upper[0] - body.lower[0], body.upper[1] - body.lower[1]) / 2;
        body.ring = Ring{{(body.lower[0] + body.upper[0]) / 2, (body.lower[1] + body.upper[1]) / 2},
                         chance(0.5) ? 0.0 : radius / 3,
                         radius};
      }
      if (chance(0.2)) body.density_ramp = DensityRamp{0.02, {{body.density * between(0.6, 1.6), 0.1}}};
      scene.bodies.push_back(body);
    }
  }

  void draw_material(int dimension, Body& body) {
    const double stiffness = modulus * between(0.5, 1.0), ratio = between(0.0, 0.4);
    const int law = whole(0, 2);
    body.material = LinearElastic{stiffness, ratio};
    if (law == 1) body.material = NeoHookean{stiffness, ratio};
    if (law == 2 && dimension == 1) body.material = ZhangElastic{stiffness};
    if (law == 2 && dimension == 2) {
      const double friction = chance(0.2) ? 0.0 : between(0.1, 0.7);
      body.material =
          MohrCoulomb{stiffness, ratio, friction, between(100.0, 3000.0), friction * between(0.0, 1.0)};
    }
    if (law != 1 && !std::holds_alternative<ZhangElastic>(body.material) && chance(0.3)) {
      const auto stress = [&] { return between(-2000.0, 500.0); };
      body.initial_stress = UniformStress{stress(), stress(), stress(), stress()};
    }
  }

  /// A box somewhere in the grid that pushes, stands or turns.
  void draw_rigid_body(Scene& scene) {
    RigidBody body;
    body.name = "box";
    for (std::size_t a = 0; a < 2; ++a) {
      body.lower[a] = scene.grid_lower[a] + between(0.0, 0.7) * cells_[a] * scene.cell_size;
      body.upper[a] = body.lower[a] + scene.cell_size * between(1.5, 5.0);
      body.constrains[a] = scene.dimension == 1 || chance(0.8);
      body.velocity[a] = chance(0.5) ? between(-1.0, 1.0) : 0.0;
    }
    if (scene.dimension == 2 && chance(0.2)) body.angular_velocity = between(-1.0, 1.0);
    body.start = chance(0.5) ? 0.0 : 0.05;
    body.ramp = chance(0.5) ? 0.0 : 0.1;
    scene.rigid_bodies.push_back(body);
  }

  void draw_surface_load(Scene& scene) {
    SurfaceLoad load;
    load.body = scene.bodies[0].name;
    load.axis = scene.dimension - 1;
    load.side = whole(0, 1);
    load.begin = scene.bodies[0].lower[0];
    load.end = scene.bodies[0].upper[0] - (chance(0.5) ? 2 * scene.cell_size : 0.0);
    load.traction = {between(-2000.0, 2000.0), between(-2000.0, 2000.0)};
    load.ramp = chance(0.5) ? 0.0 : 0.1;
    scene.surface_loads.push_back(load);
  }

  static void drive(Scene& scene) {
    scene.driven_motion =
        DrivenMotion{[](const PerAxis& place, double time) {
                       return PerAxis{std::sin(3 * place[0] + time), std::cos(2 * place[1])};
                     },
                     [](const PerAxis& place, double time) {
                       return PerAxis{std::cos(9 * time) * place[1], std::sin(4 * place[0] + time)};
                     }};
  }

  /// Drawn last, so that all else of a scene is what it is without.
  void draw_locking_control(Scene& scene) {
    for (Body& body : scene.bodies) {
      if (!std::holds_alternative<NeoHookean>(body.material) && chance(0.6))
        body.locking_control = LockingControl::cell_average;
    }
  }

  /// After all else, likewise; what grows heavier also does so in two stages.
  void draw_inertia(Scene& scene) {
    for (Body& body : scene.bodies) {
      if (body.density_ramp && chance(0.5))
        body.density_ramp->stages.insert(body.density_ramp->stages.begin(), {body.density * between(0.8, 1.2), 0.03});
      if (chance(0.3)) body.inertia = body.density * between(0.8, 1.5);
    }
  }

  /// After all else, likewise.
  void draw_numerics(Scene& scene) {
    scene.compensated_sums = chance(0.3);
    if (chance(0.3)) scene.shuffle = random_();
    if (scene.update_order == UpdateOrder::usl && chance(0.6)) scene.light_nodes = between(0.1, 1.0);
  }

  void draw_gravity(Scene& scene) {
    scene.gravity.acceleration[static_cast<std::size_t>(scene.dimension - 1)] = -between(0.0, 9.8);
    if (scene.dimension == 2 && chance(0.3)) scene.gravity.acceleration[0] = between(-3.0, 3.0);
    scene.gravity.level = between(0.5, 2.0);
    if (chance(0.3)) scene.gravity.loading = RampLoading{0.2};
    if (chance(0.2)) scene.gravity.loading = StagedLoading{0.05, {0.3, 1.0, 0.6}};
  }

  std::mt19937_64 random_;
  std::array<int, max_dimension> cells_{};
};

}  // namespace mpm::test
