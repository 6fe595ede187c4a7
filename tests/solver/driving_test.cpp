#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "solver/material.hpp"
#include "solver/simulation.hpp"

namespace {

using namespace mpm;

constexpr Scheme every_scheme[] = {Scheme::mpm, Scheme::ugimp, Scheme::cpgimp};
constexpr UpdateOrder every_order[] = {UpdateOrder::musl, UpdateOrder::usf, UpdateOrder::usl};
constexpr double no_gravity = 0.0;

/// A block of 0.4 m x 0.4 m in cells of 0.1 m with room on every side, free and without weight.
Scene free_block() {
  Scene scene;
  scene.dimension = 2;
  scene.scheme = Scheme::ugimp;
  scene.cell_size = 0.1;
  scene.grid_lower = {-0.5, -0.5};
  scene.grid_upper = {1.0, 1.0};
  Body body;
  body.name = "block";
  body.upper = {0.4, 0.4};
  body.particles_per_cell = {2, 2};
  body.density = 1000.0;
  body.material = LinearElastic{1e6, 0.3};
  scene.bodies = {body};
  scene.gravity = {{0.0, no_gravity}, 1.0, StepLoading{}};
  scene.time_step = StableFraction{0.3};
  scene.termination = AtTime{0.05};
  return scene;
}

/// The same block on a fixed base between rollers, as wide as its grid.
Scene confined_block() {
  Scene scene = free_block();
  scene.grid_lower = {0.0, 0.0};
  scene.grid_upper = {0.4, 1.0};
  scene.edges = {{{Condition::roller, Condition::roller}, {Condition::fixed, Condition::free}}};
  return scene;
}

RigidBody plate_on(const Scene& scene, double speed) {
  RigidBody plate;
  plate.name = "plate";
  plate.lower = {0.0, scene.bodies[0].upper[1]};
  plate.upper = {0.4, scene.bodies[0].upper[1] + 0.2};
  plate.constrains = {false, true};
  plate.velocity = {0.0, -speed};
  return plate;
}

Simulation run_to_end(const Scene& scene) {
  Simulation simulation(scene);
  while (simulation.advance()) {
  }
  EXPECT_TRUE(simulation.outcome().completed()) << name_of(simulation.outcome().ending);
  return simulation;
}

PerAxis momentum_of(const ParticleFields& fields) {
  PerAxis momentum{};
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    for (std::size_t a = 0; a < 2; ++a) momentum[a] += fields.mass[p] * fields.velocity[2 * p + a];
  }
  return momentum;
}

// ---- rigid bodies

TEST(RigidBody, TravelsWhatItsVelocityAddsUpTo) {
  RigidBody body;
  body.start = 0.5;
  body.ramp = 0.2;
  double sum = 0.0;
  constexpr int steps = 100000;
  for (int k = 0; k < steps; ++k) sum += body.speed_fraction((k + 0.5) / steps) / steps;
  EXPECT_NEAR(body.travel_time(1.0), sum, 1e-9);
  EXPECT_EQ(body.travel_time(0.4), 0.0);
  EXPECT_NEAR(body.travel_time(0.6), 0.5 * 0.1 * 0.1 / 0.2, 1e-15);
  EXPECT_NEAR(body.travel_time(1.0), 0.4, 1e-15);
}

TEST(VerificationOfRigidBodies, APlateCompressesAConfinedBlockByItsConstrainedModulus) {
  // Slowly, to a compression of 2 %: stress = E_oed ln(lambda), Hencky's, everywhere.
  constexpr double compressed = 0.008, height = 0.4, width = 0.4;
  const double modulus = 1e6 * 0.7 / (1.3 * 0.4);
  for (Scheme scheme : every_scheme) {
    for (UpdateOrder order : every_order) {
      Scene scene = confined_block();
      scene.scheme = scheme;
      scene.update_order = order;
      scene.damping = 0.5;
      RigidBody plate = plate_on(scene, compressed / 0.35);
      plate.ramp = 0.1;
      scene.rigid_bodies = {plate};
      scene.termination = AtTime{0.4};
      Simulation simulation(scene);
      RigidBodyState before;
      double began = 0.0;
      while (simulation.advance()) {
        if (simulation.time() < 0.39) {
          before = simulation.rigid_bodies()[0];
          began = simulation.time();
        }
      }
      const RigidBodyState after = simulation.rigid_bodies()[0];
      const double reaction = (after.impulse[1] - before.impulse[1]) / (simulation.time() - began);
      const double settlement = -(after.displacement[1] + before.displacement[1]) / 2;
      // The plate holds the nodes on the block's upper edge: the block below them is squeezed.
      const double exact = -modulus * std::log(1 - settlement / height) * width;
      EXPECT_NEAR(reaction, exact, 0.01 * exact) << static_cast<int>(scheme) << static_cast<int>(order);
      EXPECT_NEAR(after.displacement[1], -compressed, 2e-5);
    }
  }
}

TEST(VerificationOfRigidBodies, WhatThePlateGivesTheParticlesKeep) {
  // No edge and no gravity: the impulse of the particles on the body is the momentum they lost, whatever the
  // scheme and however rough the ride.
  for (Scheme scheme : every_scheme) {
    for (UpdateOrder order : every_order) {
      Scene scene = free_block();
      scene.scheme = scheme;
      scene.update_order = order;
      RigidBody ram = plate_on(scene, 0.05);
      ram.constrains = {true, true};
      ram.velocity = {0.02, -0.05};  // MPM in the order USL would not survive ten times that
      scene.rigid_bodies = {ram};
      const Simulation simulation = run_to_end(scene);
      const PerAxis momentum = momentum_of(simulation.particles());
      const PerAxis impulse = simulation.rigid_bodies()[0].impulse;
      for (std::size_t a = 0; a < 2; ++a) {
        EXPECT_NEAR(momentum[a] + impulse[a], 0.0, 1e-10 * std::abs(momentum[a]));
        EXPECT_GT(std::abs(momentum[a]), 0.1);  // of 160 kg/m: it was pushed
      }
    }
  }
}

TEST(RigidBody, HoldsTheNodesItHasReachedAndOnlyThose) {
  // A body that comes down through the grid takes a row of nodes when its face is within a quarter of a cell
  // of it: the row y = 0.4, the first that knows of the block, at 0.425. Before that it meets no mass.
  Scene scene = free_block();
  scene.rigid_bodies = {plate_on(scene, 1.0)};
  scene.rigid_bodies[0].lower[1] = 0.65;
  scene.rigid_bodies[0].upper[1] = 1.0;
  scene.termination = AtTime{0.3};
  Simulation simulation(scene);
  double first_touch = 0.0;
  while (simulation.advance()) {
    if (first_touch == 0.0 && simulation.rigid_bodies()[0].impulse[1] != 0.0) first_touch = simulation.time();
  }
  EXPECT_NEAR(first_touch, 0.225, 2 * simulation.time_step());
}

TEST(VerificationOfRigidBodies, ASmoothPlateLetsTheBlockSlideAndARoughOneDoesNot) {
  Scene scene = confined_block();
  scene.edges = {{{Condition::roller, Condition::free}, {Condition::roller, Condition::free}}};
  scene.grid_upper[0] = 0.8;
  scene.damping = 0.5;
  scene.termination = AtTime{0.3};
  RigidBody plate = plate_on(scene, 0.02);
  plate.upper[0] = 0.6;
  scene.rigid_bodies = {plate};
  const ParticleFields smooth = run_to_end(scene).particles();
  scene.rigid_bodies[0].constrains = {true, true};
  const ParticleFields rough = run_to_end(scene).particles();
  const std::size_t corner = smooth.mass.size() - 1;  // at the plate, far from the axis
  // Smooth, on a roller: uniform plane-strain compression, u_x = nu/(1 - nu) * 0.006/0.4 * x.
  const double exact = 0.3 / 0.7 * 0.006 / 0.4 * smooth.initial_position[2 * corner];
  EXPECT_NEAR(smooth.displacement[2 * corner], exact, 0.1 * exact);
  EXPECT_LT(rough.displacement[2 * corner], 0.5 * exact);
}

/// A block whose whole grid turns about its middle, with a stress that turns with it or does not.
ParticleFields turned_by(double angle, Objectivity objectivity) {
  Scene scene = free_block();
  scene.bodies[0].lower = {0.1, 0.1};
  scene.objectivity = objectivity;
  scene.bodies[0].initial_stress = UniformStress{1000.0, -500.0, 250.0, 300.0};
  RigidBody all;
  all.name = "all";
  all.lower = scene.grid_lower;
  all.upper = scene.grid_upper;
  all.angular_velocity = angle;
  scene.rigid_bodies = {all};
  scene.time_step = GivenTimeStep{1e-4};
  scene.termination = AtTime{1.0};
  return run_to_end(scene).particles();
}

TEST(VerificationOfRigidBodies, StressTurnsWithTheMaterialUnderJaumannsRateOnly) {
  const double angle = 2 * std::numbers::pi / 3;
  const ParticleFields turned = turned_by(angle, Objectivity::jaumann);
  const ParticleFields left = turned_by(angle, Objectivity::none);
  const SymmetricTensor<2, double> start{1000.0, -500.0, 250.0, 300.0};
  const SymmetricTensor<2, double> exact = rotated(start, angle);
  for (std::size_t p = 0; p < turned.mass.size(); ++p) {
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_NEAR(turned.stress[4 * p + c], exact[c], 1e-6);  // round-off of 1e4 steps of E * strain
      EXPECT_NEAR(left.stress[4 * p + c], start[c], 1e-6);
    }
  }
}

// ---- neo-Hookean bodies

TEST(VerificationOfNeoHookean, FollowsItsClosedFormThroughStretchShearAndRotation) {
  const double e = 1e6, nu = 0.3, lame = e * nu / (1.3 * 0.4), shear = e / 2.6;
  const NeoHookeanLaw<2, double> law(NeoHookean{e, nu});
  // Stretch a along x and b along y, then turned by 30 degrees: sigma = Q diag(...) Q^T.
  const double a = 1.3, b = 0.8, angle = std::numbers::pi / 6, j = a * b;
  const double c = std::cos(angle), s = std::sin(angle);
  const SymmetricTensor<2, double> upright{(lame * std::log(j) + shear * (a * a - 1)) / j,
                                           (lame * std::log(j) + shear * (b * b - 1)) / j,
                                           lame * std::log(j) / j, 0.0};
  const SymmetricTensor<2, double> exact = rotated(upright, angle);
  const SymmetricTensor<2, double> found = law.stress({c * a, -s * b, s * a, c * b}, j);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(found[k], exact[k], 1e-9 * e);
  // Simple shear g: sigma_xy = mu g, sigma_xx = mu g^2, sigma_yy = 0.
  const SymmetricTensor<2, double> sheared = law.stress({1.0, 0.7, 0.0, 1.0}, 1.0);
  EXPECT_NEAR(sheared[3], shear * 0.7, 1e-9 * e);
  EXPECT_NEAR(sheared[0], shear * 0.49, 1e-9 * e);
  EXPECT_NEAR(sheared[1], 0.0, 1e-9 * e);
  const NeoHookeanLaw<1, double> line(NeoHookean{e, nu});
  EXPECT_NEAR(line.update({}, {}, 1.25)[0], e / 2 * (1.25 - 0.8), 1e-9 * e);
  EXPECT_NEAR(line.wave_modulus(), e, 1e-9 * e);
}

TEST(VerificationOfNeoHookean, ATurnedBlockKeepsItsShapeAndStaysFreeOfStress) {
  Scene scene = free_block();
  scene.bodies[0].lower = {0.1, 0.1};
  scene.bodies[0].material = NeoHookean{1e6, 0.3};
  RigidBody all;
  all.name = "all";
  all.lower = scene.grid_lower;
  all.upper = scene.grid_upper;
  all.angular_velocity = 1.0;
  scene.rigid_bodies = {all};
  scene.time_step = GivenTimeStep{1e-5};
  scene.termination = AtTime{0.5};
  const ParticleFields fields = run_to_end(scene).particles();
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    // A step of angle d stretches by sqrt(1 + d^2): F grows by t dt / 2 = 2.5e-6 in all.
    EXPECT_NEAR(fields.deformation_gradient[4 * p], std::cos(0.5), 1e-5);
    EXPECT_NEAR(fields.deformation_gradient[4 * p + 1], -std::sin(0.5), 1e-5);
    EXPECT_NEAR(fields.stress[4 * p], 0.0, 1e-5 * 1e6);
    EXPECT_NEAR(fields.volume[p] / fields.initial_volume[p], 1.0, 1e-5);
  }
}

TEST(VerificationOfNeoHookean, SmallStrainsSeeTheLinearElasticBlock) {
  Scene scene = confined_block();
  scene.rigid_bodies = {plate_on(scene, 1e-5)};
  const ParticleFields linear = run_to_end(scene).particles();
  scene.bodies[0].material = NeoHookean{1e6, 0.3};
  const ParticleFields rubber = run_to_end(scene).particles();
  double largest = 0.0;
  for (std::size_t k = 0; k < linear.stress.size(); ++k) {
    EXPECT_NEAR(rubber.stress[k], linear.stress[k], 1e-5 * 10.0);
    largest = std::max(largest, std::abs(linear.stress[k]));
  }
  EXPECT_GT(largest, 0.5);
}

// ---- loads, densities, initial stress, driven motions, rings

TEST(VerificationOfLoads, AWeightlessBlockUnderATractionCarriesItEverywhere) {
  for (Scheme scheme : every_scheme) {
    Scene scene = confined_block();
    scene.scheme = scheme;
    scene.damping = 0.8;
    scene.surface_loads = {{"block", 1, 1, 0.0, 0.4, {0.0, -100.0}, 0.05}};
    scene.termination = AtTime{0.5};
    const ParticleFields fields = run_to_end(scene).particles();
    double mean = 0.0;
    for (std::size_t p = 0; p < fields.mass.size(); ++p) {
      mean += fields.stress[4 * p + 1] / static_cast<double>(fields.mass.size());
    }
    // The load enters half a particle below the surface, 1/16 of the height, so the mean lacks 1/16 at most.
    EXPECT_NEAR(mean, -100.0, 100.0 / 15) << static_cast<int>(scheme);
    EXPECT_NEAR(fields.stress[1], -100.0, 3.0);
  }
}

TEST(Loading, ATractionOnPartOfAnEdgePushesAsHardAsItsLengthSays) {
  Scene scene = free_block();
  scene.surface_loads = {{"block", 0, 1, 0.1, 0.3, {50.0, -20.0}, 0.0}};
  const Simulation simulation = run_to_end(scene);
  const PerAxis momentum = momentum_of(simulation.particles());
  EXPECT_NEAR(momentum[0], 50.0 * 0.2 * simulation.time(), 1e-9);
  EXPECT_NEAR(momentum[1], -20.0 * 0.2 * simulation.time(), 1e-9);
}

TEST(VerificationOfLoads, ABodyThatGrowsHeavierSettlesToItsFinalWeight) {
  Scene scene = confined_block();
  scene.damping = 0.8;
  scene.gravity.acceleration = {0.0, -10.0};
  scene.bodies[0].density_ramp = DensityRamp{0.1, {{3000.0, 0.2}}};
  scene.termination = AtTime{0.6};
  const Simulation simulation = run_to_end(scene);
  const ParticleFields fields = simulation.particles();
  EXPECT_NEAR(std::accumulate(fields.mass.begin(), fields.mass.end(), 0.0), 3000.0 * 0.16, 1e-9);
  double mean = 0.0;
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    mean += fields.stress[4 * p + 1] / static_cast<double>(fields.mass.size());
  }
  EXPECT_NEAR(mean, -3000.0 * 10 * 0.2, 0.01 * 6000);
  EXPECT_DOUBLE_EQ(scene.bodies[0].density_at(0.05), 1000.0);
  EXPECT_DOUBLE_EQ(scene.bodies[0].density_at(0.2), 2000.0);
}

TEST(Body, ADensityRampGoesFromStageToStage) {
  Body body;
  body.density = 1000.0;
  body.density_ramp = DensityRamp{0.1, {{3000.0, 0.2}, {2000.0, 0.5}}};
  EXPECT_DOUBLE_EQ(body.density_at(0.05), 1000.0);
  EXPECT_DOUBLE_EQ(body.density_at(0.2), 2000.0);
  EXPECT_DOUBLE_EQ(body.density_at(0.3), 3000.0);
  EXPECT_DOUBLE_EQ(body.density_at(0.4), 2800.0);
  EXPECT_DOUBLE_EQ(body.density_at(9.0), 2000.0);
  EXPECT_DOUBLE_EQ(body.density_ramp->end(), 0.8);
  EXPECT_DOUBLE_EQ(body.lightest(), 1000.0);
  body.inertia = 500.0;
  EXPECT_DOUBLE_EQ(body.lightest(), 500.0);
}

TEST(VerificationOfLoads, InertiaSlowsAFallAndLeavesTheWeight) {
  Scene scene = free_block();
  scene.time_step = GivenTimeStep{1e-4};
  scene.gravity.acceleration = {0.0, -10.0};
  const double own = momentum_of(run_to_end(scene).particles())[1];
  scene.bodies[0].inertia = 4 * scene.bodies[0].density;
  const Simulation heavy = run_to_end(scene);
  const ParticleFields fields = heavy.particles();
  EXPECT_NEAR(momentum_of(fields)[1], own, 1e-9 * std::abs(own));  // the same force for the same time
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    EXPECT_NEAR(fields.velocity[2 * p + 1], -10.0 / 4 * heavy.time(), 1e-9);
  }
}

/// Inertia four times as large, with twice the time for everything, is the same motion at half the speed.
TEST(VerificationOfLoads, ScalingTheInertiaOfAllIsTakingTheTimeFromTheLoading) {
  for (const UpdateOrder order : {UpdateOrder::musl, UpdateOrder::usl, UpdateOrder::usf}) {
    Scene scene = confined_block();
    scene.update_order = order;
    scene.damping = 0.8;
    scene.gravity.acceleration = {0.0, -10.0};
    scene.bodies[0].inertia = scene.bodies[0].density;
    scene.bodies[0].density_ramp = DensityRamp{0.01, {{3000.0, 0.02}, {2500.0, 0.01}}};
    scene.time_step = GivenTimeStep{1e-4};
    scene.termination = AtTime{0.05};
    const ParticleFields plain = run_to_end(scene).particles();

    *scene.bodies[0].inertia *= 4;
    scene.bodies[0].density_ramp = DensityRamp{0.02, {{3000.0, 0.04}, {2500.0, 0.02}}};
    scene.time_step = GivenTimeStep{2e-4};
    scene.termination = AtTime{0.1};
    const ParticleFields scaled = run_to_end(scene).particles();
    double largest = 0.0;
    for (std::size_t i = 0; i < plain.displacement.size(); ++i) {
      largest = std::max(largest, std::abs(plain.displacement[i]));
    }
    ASSERT_GT(largest, 1e-5);
    for (std::size_t i = 0; i < plain.displacement.size(); ++i) {
      EXPECT_NEAR(scaled.displacement[i], plain.displacement[i], 1e-9 * largest);
      EXPECT_NEAR(scaled.velocity[i], plain.velocity[i] / 2, 1e-6 * largest / 0.05);
    }
  }
}

TEST(VerificationOfLoads, ABodyWithItsOwnDensityForInertiaMovesAsOneWithout) {
  Scene scene = confined_block();
  scene.damping = 0.8;
  scene.gravity.acceleration = {0.0, -10.0};
  const ParticleFields plain = run_to_end(scene).particles();
  scene.bodies[0].inertia = scene.bodies[0].density;
  const ParticleFields same = run_to_end(scene).particles();
  EXPECT_EQ(same.displacement, plain.displacement);
  EXPECT_EQ(same.stress, plain.stress);
}

TEST(VerificationOfLoads, InertiaOfAGrowingBlockSettlesToItsFinalWeight) {
  Scene scene = confined_block();
  scene.damping = 0.8;
  scene.gravity.acceleration = {0.0, -10.0};
  scene.bodies[0].density_ramp = DensityRamp{0.1, {{3000.0, 0.2}}};
  scene.bodies[0].inertia = 2500.0;
  scene.termination = AtRest{1e-4, 1e-6, 2.0};
  const Simulation simulation = run_to_end(scene);
  ASSERT_EQ(simulation.outcome().ending, Ending::at_rest);
  const ParticleFields fields = simulation.particles();
  EXPECT_NEAR(std::accumulate(fields.mass.begin(), fields.mass.end(), 0.0), 2500.0 * 0.16, 1e-9);
  double mean = 0.0;
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    mean += fields.stress[4 * p + 1] / static_cast<double>(fields.mass.size());
  }
  EXPECT_NEAR(mean, -3000.0 * 10 * 0.2, 0.01 * 6000);
}

TEST(VerificationOfLoads, RestIsNotLookedForBeforeTheLoadsHaveSettled) {
  // Without its traction the block is at rest from the start.
  Scene scene = confined_block();
  scene.damping = 0.8;
  scene.gravity.acceleration = {0.0, -1e-3};
  scene.surface_loads = {{"block", 1, 1, 0.0, 0.4, {0.0, -100.0}, 0.3}};
  scene.termination = AtRest{1e-2, 1e-2, 5.0};
  EXPECT_GE(run_to_end(scene).time(), 0.3);
}

TEST(VerificationOfLoads, GroundThatStartsAtItsGeostaticStressStaysAtRest) {
  Scene scene = confined_block();
  scene.gravity.acceleration = {0.0, -10.0};
  scene.bodies[0].initial_stress = GeostaticStress{0.4, 0.5};
  const ParticleFields fields = run_to_end(scene).particles();
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    const double vertical = -1e4 * (0.4 - fields.initial_position[2 * p + 1]);
    // The exact field, not the grid's: it swings about its own equilibrium by a part of a cell's weight.
    EXPECT_NEAR(fields.stress[4 * p + 1], vertical, 0.3 * 1e4 * 0.1);
    EXPECT_NEAR(fields.stress[4 * p], 0.5 * vertical, 0.3 * 1e4 * 0.1);
    // Unloaded it would have dropped by rho g h^2 / (2 E_oed) = 6e-4.
    EXPECT_LT(std::abs(fields.displacement[2 * p + 1]), 3e-5);
  }
}

TEST(VerificationOfDrivenMotions, AUniformBodyForceIsFreeFallFromHalfAStepBefore) {
  Scene scene = free_block();
  scene.driven_motion = DrivenMotion{[](const PerAxis&, double t) {
                                       return PerAxis{0.1, 3.0 * t};
                                     },
                                     [](const PerAxis&, double) {
                                       return PerAxis{0.0, 3.0};
                                     }};
  const Simulation simulation = run_to_end(scene);
  const ParticleFields fields = simulation.particles();
  const double t = simulation.time();
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    // Leapfrog is exact for a constant acceleration.
    EXPECT_NEAR(fields.displacement[2 * p + 1], 1.5 * t * t, 1e-12);
    EXPECT_NEAR(fields.displacement[2 * p], 0.1 * t, 1e-12);
  }
}

TEST(Ring, HoldsTheParticlesBetweenItsRadii) {
  Scene scene = free_block();
  scene.bodies[0].particles_per_cell = {20, 20};
  scene.bodies[0].ring = Ring{{0.2, 0.2}, 0.1, 0.2};
  const ParticleFields fields = Simulation(scene).particles();
  const double area = std::accumulate(fields.volume.begin(), fields.volume.end(), 0.0);
  EXPECT_NEAR(area, std::numbers::pi * 0.03, 0.003 * area);
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    const double radius = std::hypot(fields.position[2 * p] - 0.2, fields.position[2 * p + 1] - 0.2);
    EXPECT_TRUE(radius >= 0.1 && radius <= 0.2);
  }
}

TEST(StrainSum, AddsUpWhatTheStressSaw) {
  Scene scene = confined_block();
  scene.sums_strain = true;
  scene.rigid_bodies = {plate_on(scene, 0.02)};
  const ParticleFields fields = run_to_end(scene).particles();
  ASSERT_EQ(fields.strain.size(), fields.stress.size());
  const double lame = 1e6 * 0.3 / (1.3 * 0.4), shear = 1e6 / 2.6;
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    const double volumetric = fields.strain[4 * p] + fields.strain[4 * p + 1];
    EXPECT_NEAR(fields.stress[4 * p + 1], lame * volumetric + 2 * shear * fields.strain[4 * p + 1], 1e-6);
  }
}

// ---- work

double sum_of(const std::vector<double>& field) { return std::accumulate(field.begin(), field.end(), 0.0); }

TEST(VerificationOfWork, ASlowCompressionDoesTheWorkOfHenckysLaw) {
  // M ln(lambda) on a volume of V0 lambda, over the logarithmic strain e: V0 M [(e - 1) exp(e) + 1].
  const double modulus = 1e6 * 0.7 / (1.3 * 0.4);
  Scene scene = confined_block();
  scene.sums_work = true;
  RigidBody plate = plate_on(scene, 0.2);
  plate.ramp = 0.1;
  scene.rigid_bodies = {plate};
  scene.termination = AtTime{0.3};
  for (UpdateOrder order : every_order) {
    scene.update_order = order;
    const ParticleFields fields = run_to_end(scene).particles();
    for (std::size_t p = 0; p < fields.mass.size(); ++p) {
      const double e = std::log(fields.volume[p] / fields.initial_volume[p]);
      EXPECT_LT(e, -0.05);
      const double exact = fields.initial_volume[p] * modulus * ((e - 1) * std::exp(e) + 1);
      // The sum of the increments, which the stress follows, is the logarithm to first order in them.
      EXPECT_NEAR(fields.stress_work[p], exact, 5e-4 * exact);
    }
  }
}

/// Potential of a compressible neo-Hookean law per initial volume, see `NeoHookeanLaw`.
double potential_of(double young, double nu, const double* f) {
  const double mu = young / (2 * (1 + nu)), lambda = 2 * mu * nu / (1 - 2 * nu);
  const double log_j = std::log(f[0] * f[3] - f[1] * f[2]);
  const double squares = f[0] * f[0] + f[1] * f[1] + f[2] * f[2] + f[3] * f[3];
  return lambda / 2 * log_j * log_j - mu * log_j + mu / 2 * (squares - 2);
}

TEST(VerificationOfWork, OfAnElasticBlockThatSagsIsItsStrainEnergy) {
  // Held at its base, free at its side: sheared, turned, and never far from falling over.
  Scene scene = confined_block();
  scene.grid_upper[0] = 0.8;
  scene.bodies[0].material = NeoHookean{1e5, 0.3};
  scene.gravity.acceleration = {0.0, -10.0};
  scene.sums_work = true;
  scene.time_step = StableFraction{0.1};
  for (UpdateOrder order : every_order) {
    scene.update_order = order;
    const ParticleFields fields = run_to_end(scene).particles();
    double stored = 0.0, turned = 0.0;
    for (std::size_t p = 0; p < fields.mass.size(); ++p) {
      const double* f = &fields.deformation_gradient[4 * p];
      stored += fields.initial_volume[p] * potential_of(1e5, 0.3, f);
      turned = std::max(turned, std::abs(f[2] - f[1]) / 2);
    }
    EXPECT_GT(turned, 0.005);
    EXPECT_NEAR(sum_of(fields.stress_work), stored, 1e-3 * stored);
  }
}

/// Particles of one law, sheared in the plane by an angle in equal steps, with a part of each as a turn.
ParticleFields sheared(const Material& material, double angle, int steps, double turn, bool turns_stress) {
  Scene scene = free_block();
  scene.bodies[0].material = material;
  scene.bodies[0].initial_stress = UniformStress{.xx = -200.0, .yy = -200.0, .zz = -200.0, .xy = 0.0};
  scene.sums_work = true;
  Particles<2, double> particles = fill_bodies<2, double>(scene, true);
  if (turns_stress) scene.objectivity = Objectivity::jaumann;
  const StressUpdate<2, double> update(scene);
  using Value = Lanes<double>;
  Deformation<2, Value> step{};
  for (Value& component : step.strain_increment) component = Value(0);
  step.strain_increment[3] = Value(angle / 2 / steps);
  step.rotation = Value(turn / steps);
  const auto law = law_of<2, double>(material);
  for (int k = 0; k < steps; ++k)
    std::visit([&](const auto& each) { update(each, step, 0, particles); }, law);
  ParticleFields fields;
  fields.stress_work = {particles.stress_work[0][0], particles.stress_work[0][lane_count<double> - 1]};
  fields.initial_volume = {particles.first_volume[0]};
  fields.stress = {particles.stress[3][0]};
  return fields;
}

TEST(VerificationOfWork, OfAShearedPlasticBodyIsStoredUntilItYieldsAndLostFromThenOn) {
  // Tresca: the shear stress is G angle up to c = 100 Pa, then c; what is stored is c^2/(2 G).
  constexpr double cohesion = 100.0, shear_modulus = 1e6 / 2.6, angle = 0.01;
  const MohrCoulomb clay{1e6, 0.3, 0.0, cohesion, 0.0};
  const ParticleFields fields = sheared(clay, angle, 10000, 0.0, false);
  EXPECT_NEAR(fields.stress[0], cohesion, 1e-9);
  const double stored = cohesion * cohesion / (2 * shear_modulus);
  const double exact = fields.initial_volume[0] * (cohesion * angle - stored);
  // One step in ten thousand is half elastic.
  for (const double work : fields.stress_work) EXPECT_NEAR(work, exact, 1e-5 * exact);
}

TEST(VerificationOfWork, TurningAStressDoesNone) {
  const LinearElastic elastic{1e6, 0.3};
  for (const Material& material : {Material(elastic), Material(NeoHookean{1e6, 0.3})}) {
    EXPECT_EQ(sheared(material, 0.0, 100, 1.0, true).stress_work[0], 0.0);
  }
  // Sheared to G angle = 3846 Pa and turned on the way, the energy is that of the shear.
  const double shear_modulus = 1e6 / 2.6;
  const ParticleFields turned = sheared(elastic, 0.01, 10000, 1e-6, true);
  EXPECT_NEAR(turned.stress_work[0], 0.5 * shear_modulus * 1e-4 * turned.initial_volume[0],
              1e-5 * turned.stress_work[0]);
}

TEST(VerificationOfWork, IsSummedOnTheSideAndChangesNoBit) {
  Scene scene = free_block();
  scene.bodies[0].velocity = {1.0, 0.0};
  scene.edges[0][1] = Condition::roller;
  scene.bodies[0].upper[0] = 0.9;
  const ParticleFields without = run_to_end(scene).particles();
  scene.sums_work = true;
  const ParticleFields with = run_to_end(scene).particles();
  EXPECT_EQ(with.position, without.position);
  EXPECT_EQ(with.stress, without.stress);
  EXPECT_GT(sum_of(with.stress_work), 0.0);
}

TEST(Features, ASceneWithoutThemStoresNothingForThem) {
  const ParticleFields fields = Simulation(free_block()).particles();
  EXPECT_TRUE(fields.strain.empty());
  EXPECT_TRUE(fields.stress_work.empty());
  EXPECT_TRUE(fields.deformation_gradient.empty());
}

}  // namespace
