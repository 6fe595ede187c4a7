#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "solver/material.hpp"
#include "solver/simulation.hpp"

namespace {

using namespace mpm;

constexpr double h = 0.1, dt = 1e-3;

/// An elastic block far from all edges, whose particles start with a given velocity.
Scene block(const PerAxis& lower, const PerAxis& upper, int particles_per_cell,
            std::function<PerAxis(const PerAxis&)> velocity) {
  Scene scene;
  scene.dimension = 2;
  scene.cell_size = h;
  scene.grid_upper = {2.0, 2.0};
  scene.sums_strain = true;
  Body body;
  body.name = "block";
  body.lower = lower;
  body.upper = upper;
  body.particles_per_cell = {particles_per_cell, particles_per_cell};
  body.density = 1000.0;
  body.material = LinearElastic{1e5, 0.3};
  scene.bodies = {body};
  scene.driven_motion = DrivenMotion{[=](const PerAxis& place, double) { return velocity(place); },
                                     [](const PerAxis&, double) { return PerAxis{}; }};
  scene.time_step = GivenTimeStep{dt};
  scene.termination = AtTime{1e9};
  return scene;
}

PerAxis wavy(const PerAxis& place) {
  return {std::sin(17 * place[0] + 3 * place[1]), std::cos(23 * place[1] * place[0])};
}

Scene with_control(Scene scene) {
  for (Body& body : scene.bodies) body.locking_control = LockingControl::cell_average;
  return scene;
}

ParticleFields after(const Scene& scene, int steps) {
  Simulation simulation(scene);
  for (int k = 0; k < steps; ++k) EXPECT_TRUE(simulation.advance());
  return simulation.particles();
}

std::pair<int, int> cell_of(const ParticleFields& fields, std::size_t p) {
  return {static_cast<int>(std::floor(fields.initial_position[2 * p] / h)),
          static_cast<int>(std::floor(fields.initial_position[2 * p + 1] / h))};
}

template <class Visit>
void in_every_method(Scene scene, Visit&& visit) {
  for (const Precision precision : {Precision::float64, Precision::float32}) {
    for (const Scheme scheme : {Scheme::mpm, Scheme::ugimp, Scheme::cpgimp}) {
      for (const UpdateOrder order : {UpdateOrder::musl, UpdateOrder::usf, UpdateOrder::usl}) {
        scene.precision = precision;
        scene.scheme = scheme;
        scene.update_order = order;
        SCOPED_TRACE("scheme " + std::to_string(static_cast<int>(scheme)) + ", order " +
                     std::to_string(static_cast<int>(order)) + ", precision " +
                     std::to_string(static_cast<int>(precision)));
        visit(scene, precision == Precision::float32 ? std::numeric_limits<float>::epsilon()
                                                     : std::numeric_limits<double>::epsilon());
      }
    }
  }
}

TEST(LockingControl, ChangesOnlyTheDilationOfADeformation) {
  Deformation<2, double> deformation{{0.03, -0.01, 0.0, 0.02}, 0.4};
  set_dilation(0.1, deformation);
  EXPECT_DOUBLE_EQ(deformation.strain_increment[0] + deformation.strain_increment[1], 0.1);
  EXPECT_DOUBLE_EQ(deformation.strain_increment[0] - deformation.strain_increment[1], 0.04);
  EXPECT_EQ(deformation.strain_increment[2], 0.0);
  EXPECT_EQ(deformation.strain_increment[3], 0.02);
  EXPECT_EQ(deformation.rotation, 0.4);
}

TEST(LockingControl, GivesAllParticlesOfACellTheirMeanDilation) {
  // Four large particles a cell and sixteen small ones meet in the middle of cells; both meet a third body
  // that keeps its own dilation.
  Scene scene = block({0.4, 0.4}, {0.85, 0.95}, 2, wavy);
  Body fine = scene.bodies[0];
  fine.name = "fine";
  fine.lower[0] = 0.85;
  fine.upper[0] = 1.3;
  fine.particles_per_cell = {4, 4};
  Body other = fine;
  other.name = "other";
  other.lower = {0.4, 0.95};
  other.upper = {1.3, 1.4};
  scene.bodies = {scene.bodies[0], fine, other};
  Scene controlled = with_control(scene);
  controlled.bodies[2].locking_control = LockingControl::none;
  in_every_method(scene, [&](const Scene& method, double round_off) {
    controlled.scheme = method.scheme;
    controlled.update_order = method.update_order;
    controlled.precision = method.precision;
    const ParticleFields own = after(method, 1), shared = after(controlled, 1);
    std::map<std::pair<int, int>, std::pair<double, double>> cells;
    for (std::size_t p = 0; p < own.mass.size(); ++p) {
      if (own.body[p] == 2) continue;
      auto& [growth, volume] = cells[cell_of(own, p)];
      growth += own.initial_volume[p] * (own.strain[4 * p] + own.strain[4 * p + 1]);
      volume += own.initial_volume[p];
    }
    const double tolerance = 64 * round_off;  // of strains below 0.03 that are sums of a few terms of order 1
    double largest_change = 0;
    for (std::size_t p = 0; p < own.mass.size(); ++p) {
      const double xx = own.strain[4 * p], yy = own.strain[4 * p + 1];
      const auto& [growth, volume] = cells[cell_of(own, p)];
      const double mean = own.body[p] == 2 ? xx + yy : growth / volume, change = (mean - xx - yy) / 2;
      largest_change = std::max(largest_change, std::abs(change));
      ASSERT_NEAR(shared.strain[4 * p], xx + change, tolerance);
      ASSERT_NEAR(shared.strain[4 * p + 1], yy + change, tolerance);
      ASSERT_EQ(shared.strain[4 * p + 2], 0.0);
      ASSERT_EQ(shared.strain[4 * p + 3], own.strain[4 * p + 3]);
      ASSERT_NEAR(shared.volume[p] / shared.initial_volume[p], 1 + mean, tolerance);
      if (method.scheme == Scheme::cpgimp) {
        const double half_size = h / (own.body[p] == 0 ? 4 : 8);
        ASSERT_NEAR(shared.half_size[2 * p] / half_size, 1 + xx + change, tolerance);
        ASSERT_NEAR(shared.half_size[2 * p + 1] / half_size, 1 + yy + change, tolerance);
      }
      if (own.body[p] == 2) {
        ASSERT_EQ(shared.strain[4 * p], xx);
        ASSERT_EQ(shared.strain[4 * p + 1], yy);
      }
    }
    EXPECT_GT(largest_change, 1e-3);
  });
}

/// Further from the edges than they reach in a step: four cells, two for each mapping.
bool is_inside(const ParticleFields& fields, std::size_t p) {
  for (std::size_t a = 0; a < 2; ++a) {
    if (std::abs(fields.initial_position[2 * p + a] - 1.0) > 0.25) return false;
  }
  return true;
}

void expect_same_inside(const Scene& scene, double strain_xx, double strain_yy, double strain_xy) {
  in_every_method(scene, [&](const Scene& method, double round_off) {
    const ParticleFields own = after(method, 1), shared = after(with_control(method), 1);
    int inside = 0;
    for (std::size_t p = 0; p < own.mass.size(); ++p) {
      if (!is_inside(own, p)) continue;
      ++inside;
      const std::array<double, 4> expected{strain_xx, strain_yy, 0.0, strain_xy};
      for (std::size_t c = 0; c < 4; ++c) {
        ASSERT_NEAR(own.strain[4 * p + c], expected[c], 64 * round_off);
        ASSERT_NEAR(shared.strain[4 * p + c], own.strain[4 * p + c], 64 * round_off);
        ASSERT_NEAR(shared.stress[4 * p + c], own.stress[4 * p + c], 64 * round_off * 1e5);
      }
      ASSERT_NEAR(shared.volume[p] / own.volume[p], 1, 64 * round_off);
    }
    EXPECT_GE(inside, 64);
  });
}

TEST(LockingControl, LeavesAnEvenDilationAsItIs) {
  const auto velocity = [](const PerAxis& place) { return PerAxis{3 * (place[0] - 1), 3 * (place[1] - 1)}; };
  expect_same_inside(block({0.2, 0.2}, {1.8, 1.8}, 2, velocity), 3e-3, 3e-3, 0.0);
}

TEST(LockingControl, LeavesAnEvenShearAsItIs) {
  const auto velocity = [](const PerAxis& place) { return PerAxis{6 * (place[1] - 1), 0.0}; };
  expect_same_inside(block({0.2, 0.2}, {1.8, 1.8}, 2, velocity), 0.0, 0.0, 3e-3);
  const auto pure = [](const PerAxis& place) { return PerAxis{3 * (place[0] - 1), -3 * (place[1] - 1)}; };
  expect_same_inside(block({0.2, 0.2}, {1.8, 1.8}, 2, pure), 3e-3, -3e-3, 0.0);
}

TEST(LockingControl, ChangesNothingOfOneParticleACell) {
  const auto slow = [](const PerAxis& place) {
    return PerAxis{0.05 * wavy(place)[0], 0.05 * wavy(place)[1]};
  };
  in_every_method(block({0.4, 0.4}, {1.3, 1.2}, 1, slow), [](const Scene& scene, double round_off) {
    const ParticleFields own = after(scene, 200), shared = after(with_control(scene), 200);
    double largest = 0;
    for (std::size_t k = 0; k < own.displacement.size(); ++k) {
      largest = std::max(largest, std::abs(own.displacement[k]));
      ASSERT_NEAR(shared.displacement[k], own.displacement[k], 200 * round_off * h);
    }
    EXPECT_GT(largest, 1e-3);
    for (std::size_t k = 0; k < own.stress.size(); ++k)
      ASSERT_NEAR(shared.stress[k], own.stress[k], 200 * round_off * 1e5);
  });
}

TEST(LockingControl, ChangesMotionWhereParticlesShareACell) {
  const Scene scene = block({0.4, 0.4}, {1.3, 1.2}, 2, wavy);
  EXPECT_NE(after(scene, 10).velocity, after(with_control(scene), 10).velocity);
}

}  // namespace
