#include "solver/transfer.hpp"

#include <gtest/gtest.h>

#include <random>

namespace {

using namespace mpm;

/// A block of disturbed particles well inside a grid: every transfer property must hold for any state.
template <int Dim, Scheme scheme>
struct Block {
  static constexpr int dimension = Dim;
  static constexpr Scheme shape = scheme;

  Scene scene = make_scene();
  Grid<Dim, double> grid{scene};
  Particles<Dim, double> particles = fill_bodies<Dim, double>(scene, SchemeTraits<scheme>::has_domain);
  Transfer<Dim, double, scheme> transfer{particles};

  Block() {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> noise(-1.0, 1.0);
    for (Eigen::Index p = 0; p < particles.count(); ++p) {
      for (std::size_t a = 0; a < Dim; ++a) {
        particles.position[a][p] += 0.04 * noise(random);
        particles.velocity[a][p] = noise(random);
        if constexpr (SchemeTraits<scheme>::has_domain) particles.half_size[a][p] *= 1 + 0.3 * noise(random);
      }
      for (auto& component : particles.stress) component[p] = 1e5 * noise(random);
      particles.volume[p] *= 1 + 0.2 * noise(random);
    }
    EXPECT_TRUE(transfer.weigh(particles, grid));
  }

  static Scene make_scene() {
    Scene scene;
    scene.dimension = Dim;
    scene.scheme = scheme;
    scene.cell_size = 0.1;
    scene.grid_lower = {-0.3, 0.2};
    scene.grid_upper = {1.7, 2.2};
    Body body;
    body.lower = {0.2, 0.7};
    body.upper = {1.2, 1.7};
    body.particles_per_cell = {2, 2};
    body.density = 1800.0;
    scene.bodies = {body};
    return scene;
  }

  /// Position of a node along an axis [m].
  double place(std::size_t node, std::size_t axis) const {
    const auto stride = static_cast<std::size_t>(grid.nodes(0));
    const std::size_t index = axis == 0 ? node % stride : node / stride;
    return grid.origin(static_cast<int>(axis)) + static_cast<double>(index) * grid.cell_size();
  }
};

template <class BlockType>
class EveryTransfer : public testing::Test {};
using Blocks = testing::Types<Block<1, Scheme::mpm>, Block<1, Scheme::ugimp>, Block<1, Scheme::cpgimp>,
                              Block<2, Scheme::mpm>, Block<2, Scheme::ugimp>, Block<2, Scheme::cpgimp>>;
TYPED_TEST_SUITE(EveryTransfer, Blocks);

TYPED_TEST(EveryTransfer, KeepsMassAndMomentumAndAddsNoNetForce) {
  TypeParam block;
  block.transfer.scatter_all(block.particles, block.grid);
  double mass = 0, momentum = 0, force = 0, largest = 0;
  for (const auto& node : block.grid.sums) {
    mass += node.mass;
    momentum += node.momentum[0];
    force += node.force[0];
    largest = std::max(largest, std::abs(node.force[0]));
  }
  double expected = 0;
  for (Eigen::Index p = 0; p < block.particles.count(); ++p) {
    expected += block.particles.mass[p] * block.particles.velocity[0][p];
  }
  EXPECT_NEAR(mass, total_mass(block.particles), 1e-12 * mass);
  EXPECT_NEAR(momentum, expected, 1e-12 * mass);
  EXPECT_GT(largest, 0);
  EXPECT_NEAR(force, 0.0, 1e-11 * largest);
}

TYPED_TEST(EveryTransfer, ScattersInOnePassWhatItScattersInTwo) {
  TypeParam one, two;
  one.transfer.scatter_all(one.particles, one.grid);
  two.transfer.scatter_mass_and_momentum(two.particles, two.grid);
  two.transfer.scatter_internal_force(two.particles, two.grid);
  for (std::size_t i = 0; i < one.grid.sums.size(); ++i) {
    // The compiler may fuse a multiplication and an addition in one of the two and not in the other.
    EXPECT_NEAR(one.grid.sums[i].mass, two.grid.sums[i].mass, 1e-12);
    for (std::size_t a = 0; a < TypeParam::dimension; ++a) {
      EXPECT_NEAR(one.grid.sums[i].momentum[a], two.grid.sums[i].momentum[a], 1e-12);
      EXPECT_NEAR(one.grid.sums[i].force[a], two.grid.sums[i].force[a], 1e-9);
    }
  }
}

TYPED_TEST(EveryTransfer, DoesWorkOnTheGridThatEqualsTheWorkOnTheParticles) {
  // Virtual work: sum over nodes of force . velocity = - sum over particles of volume * stress : strain rate.
  TypeParam block;
  block.transfer.scatter_all(block.particles, block.grid);
  for (std::size_t i = 0; i < block.grid.sums.size(); ++i) {
    for (std::size_t a = 0; a < TypeParam::dimension; ++a) {
      block.grid.motion[i].velocity[a] = std::sin(3 * block.place(i, 0) + static_cast<double>(a));
    }
  }
  double on_grid = 0, on_particles = 0;
  for (std::size_t i = 0; i < block.grid.sums.size(); ++i) {
    for (std::size_t a = 0; a < TypeParam::dimension; ++a) {
      on_grid += block.grid.sums[i].force[a] * block.grid.motion[i].velocity[a];
    }
  }
  block.transfer.gather_strain(block.grid, 1.0, block.particles);
  for (Eigen::Index p = 0; p < block.particles.count(); ++p) {
    for (std::size_t c = 0; c < block.particles.stress.size(); ++c) {
      const double count = c == 3 ? 2 : 1;  // the shear component stands for two
      on_particles -= count * block.particles.volume[p] * block.particles.stress[c][p] *
                      block.particles.strain_increment[c][p];
    }
  }
  EXPECT_NEAR(on_grid, on_particles, 1e-11 * std::abs(on_particles));
}

TYPED_TEST(EveryTransfer, GathersALinearVelocityFieldExactly) {
  TypeParam block;
  constexpr double slope = 0.75, time_step = 1e-3;
  for (std::size_t i = 0; i < block.grid.motion.size(); ++i) {
    block.grid.motion[i].velocity[0] = 2.0 + slope * block.place(i, 0);
  }
  const auto before = block.particles;
  block.transfer.gather_strain(block.grid, time_step, block.particles);
  block.transfer.gather_motion(block.grid, time_step, 0.0, block.particles);
  for (Eigen::Index p = 0; p < before.count(); ++p) {
    ASSERT_NEAR(block.particles.strain_increment[0][p], slope * time_step, 1e-14);
    ASSERT_NEAR(block.particles.velocity[0][p], 2.0 + slope * before.position[0][p], 1e-13);
    ASSERT_NEAR(block.particles.position[0][p] - before.position[0][p],
                time_step * block.particles.velocity[0][p], 1e-15);
    if constexpr (SchemeTraits<TypeParam::shape>::updates_half_size) {
      ASSERT_NEAR(block.particles.half_size[0][p] / before.half_size[0][p], 1 + slope * time_step, 1e-14);
    } else if constexpr (SchemeTraits<TypeParam::shape>::has_domain) {
      ASSERT_EQ(block.particles.half_size[0][p], before.half_size[0][p]);
    }
  }
}

TYPED_TEST(EveryTransfer, GathersTheSpinOfARotation) {
  if constexpr (TypeParam::dimension == 2) {
    TypeParam block;
    block.particles.rotation.setZero(block.particles.count());
    constexpr double spin = 0.4, time_step = 1e-2;
    for (std::size_t i = 0; i < block.grid.motion.size(); ++i) {
      block.grid.motion[i].velocity = {-spin * block.place(i, 1), spin * block.place(i, 0)};
    }
    block.transfer.gather_rotation(block.grid, time_step, block.particles);
    block.transfer.gather_strain(block.grid, time_step, block.particles);
    for (Eigen::Index p = 0; p < block.particles.count(); ++p) {
      ASSERT_NEAR(block.particles.rotation[p], spin * time_step, 1e-14);
      for (const auto& component : block.particles.strain_increment) ASSERT_NEAR(component[p], 0.0, 1e-14);
    }
  }
}

TYPED_TEST(EveryTransfer, BlendsFlipAndPic) {
  TypeParam block;
  for (auto& motion : block.grid.motion) motion = {.velocity = {3.0}, .acceleration = {-10.0}};
  const double before = block.particles.velocity[0][0];
  block.transfer.gather_motion(block.grid, 0.01, 0.25, block.particles);
  EXPECT_NEAR(block.particles.velocity[0][0], 0.25 * (before - 0.1) + 0.75 * 3.0, 1e-14);
}

TYPED_TEST(EveryTransfer, CountsCentresThatChangeCell) {
  TypeParam block;
  EXPECT_EQ(block.transfer.cell_crossings(), 0);
  for (auto& x : block.particles.position[0]) x += block.grid.cell_size();
  ASSERT_TRUE(block.transfer.weigh(block.particles, block.grid));
  EXPECT_EQ(block.transfer.cell_crossings(), block.particles.count());
}

TYPED_TEST(EveryTransfer, NamesTheParticleThatHasNoStencil) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto fault_after = [](auto&& damage) {
    TypeParam block;
    damage(block.particles);
    EXPECT_FALSE(block.transfer.weigh(block.particles, block.grid));
    return block.transfer.find_fault(block.particles, block.grid);
  };
  const auto lost = fault_after([](auto& particles) { particles.position[0][5] = 1.71; });
  EXPECT_EQ(lost.kind, StencilFault::outside_grid);
  EXPECT_EQ(lost.particle, 5);
  EXPECT_DOUBLE_EQ(lost.value, 1.71);
  EXPECT_EQ(fault_after([&](auto& particles) { particles.position[0][2] = nan; }).kind,
            StencilFault::not_finite);
  EXPECT_EQ(fault_after([](auto& particles) { particles.volume[2] = -1e-9; }).kind, StencilFault::inverted);
  EXPECT_EQ(fault_after([&](auto& particles) { particles.volume[2] = nan; }).kind, StencilFault::not_finite);
  TypeParam poisoned;  // has a stencil, but its stress would poison the next step
  poisoned.particles.stress[0][4] = nan;
  EXPECT_TRUE(poisoned.transfer.weigh(poisoned.particles, poisoned.grid));
  const auto found = poisoned.transfer.find_fault(poisoned.particles, poisoned.grid);
  EXPECT_EQ(found.kind, StencilFault::not_finite);
  EXPECT_EQ(found.particle, 4);
  if constexpr (SchemeTraits<TypeParam::shape>::has_domain) {
    const auto large = fault_after([](auto& particles) { particles.half_size[0][7] = 0.1001; });
    EXPECT_EQ(large.kind, StencilFault::domain_too_large);
    EXPECT_EQ(large.particle, 7);
  }
}

}  // namespace
