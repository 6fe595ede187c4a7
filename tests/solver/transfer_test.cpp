#include "solver/transfer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "solver/time_step.hpp"
#include "tests/support/plain_stencil.hpp"

namespace {

using namespace mpm;

/// What particles send to the grid, node by node, in double precision.
template <int Dim>
struct PlainSums {
  std::vector<double> mass;
  std::array<std::vector<double>, Dim> momentum, internal_force, external_force;
  double largest_force = 0.0;  ///< of the terms of the sums of internal forces [N]

  explicit PlainSums(Eigen::Index nodes) : mass(static_cast<std::size_t>(nodes)) {
    for (auto* sums : {&momentum, &internal_force, &external_force}) sums->fill(mass);
  }
};

/// A block of disturbed particles well inside a grid: every property of the transfers must hold for any
/// state. Particles are put in order before they are disturbed: by `reach` cells along every axis at most, so
/// that with 0 none leaves the cell of its lane, and above it most do.
template <int Dim, Scheme scheme_, class Real_>
struct Cloud {
  static constexpr int dimension = Dim;
  static constexpr Scheme scheme = scheme_;
  using Real = Real_;
  using Transfers = Transfer<Dim, Real, scheme>;
  using Value = Lanes<Real>;

  /// Round-off of a sum of a hundred terms of the size 1 whose weights carry that of their places, which are
  /// up to 30 cells from the grid's first node and change the gradient by three times as much.
  static constexpr double round_off = 256 * static_cast<double>(std::numeric_limits<Real>::epsilon());

  Scene scene = make_scene();
  Grid<Dim, Real> grid{scene};
  Particles<Dim, Real> particles = fill();
  CellBlocks<Dim, Real> blocks{grid, Transfers::Shape::nodes_before, particles};

  explicit Cloud(double reach) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto noise = [&](double size) { return static_cast<Real>(size * uniform(random)); };
    for (const Eigen::Index slot : particles.slot_of) {
      for (std::size_t a = 0; a < Dim; ++a) {
        // A particle lies at least a quarter of a cell from the border of its cell.
        particles.position[a][slot] += noise(reach > 0 ? reach * scene.cell_size : 0.2 * scene.cell_size);
        particles.velocity[a][slot] = noise(1.0);
        particles.external_force[a][slot] = noise(100.0);
        if constexpr (SchemeTraits<scheme>::has_domain) particles.half_size[a][slot] *= 1 + noise(0.3);
      }
      for (auto& component : particles.stress) component[slot] = noise(1e5);
      particles.volume[slot] *= 1 + noise(0.2);
    }
  }

  static Scene make_scene() {
    Scene scene;
    scene.dimension = Dim;
    scene.scheme = scheme;
    scene.cell_size = 0.1;
    scene.grid_lower = {-0.6, 0.0};
    scene.grid_upper = {2.0, 2.3};
    Body body;
    body.lower = {0.1, 0.5};
    body.upper = {1.2, 1.4};  // eleven cells, a multiple of no number of lanes
    body.particles_per_cell = {2, 2};
    body.density = 1800.0;
    scene.bodies = {body};
    return scene;
  }

  Particles<Dim, Real> fill() const {
    auto filled = fill_bodies<Dim, Real>(scene, SchemeTraits<scheme>::has_domain);
    for (auto& component : filled.external_force) component.setZero(filled.count());
    return filled;
  }

  std::int64_t strays() const {
    std::int64_t found = 0;
    for (const Block& block : blocks.blocks()) {
      for (Eigen::Index k = 0; k < block.depth * Eigen::Index(Transfers::lanes); ++k) {
        const Eigen::Index slot = block.first_slot + k;
        const std::array<std::int32_t, 2> cell{
            block.first_cell + static_cast<std::int32_t>(k % Transfers::lanes), block.row};
        bool is_stray = false;
        for (std::size_t a = 0; a < Dim; ++a) {
          is_stray = is_stray ||
                     std::floor(in_cells(grid, particles.position[a][slot], a)) != static_cast<Real>(cell[a]);
        }
        found += is_stray;
      }
    }
    return found;
  }

  template <Sends sends>
  void scatter() {
    for (const Block& block : blocks.blocks()) {
      Transfers::for_each_layers(particles, grid, block, [&](const auto& layers, std::size_t count) {
        Transfers::template scatter<sends>(particles, block, layers, count, grid);
      });
    }
  }

  /// Calls `visit(particle, motion)` with plain numbers for every particle; returns how many there were.
  template <bool motion, bool gradient, class Visit>
  Eigen::Index gather(Visit&& visit) {
    Eigen::Index visited = 0;
    for (const Block& block : blocks.blocks()) {
      Transfers::for_each_layer(particles, grid, block, [&](const auto& layer) {
        const auto seen = Transfers::template gather<motion, gradient>(particles, grid, block, layer);
        for (int lane = 0; lane < Transfers::lanes; ++lane) {
          if (particles.id[static_cast<std::size_t>(layer.slot + lane)] < 0) continue;
          const auto number = [&](const Value& value) {
            std::array<Real, Transfers::lanes> numbers;
            store(value, numbers.data());
            return static_cast<double>(numbers[static_cast<std::size_t>(lane)]);
          };
          GridMotion<Dim, double> alone;
          for (std::size_t a = 0; a < Dim; ++a) {
            alone.velocity[a] = number(seen.velocity[a]);
            alone.acceleration[a] = number(seen.acceleration[a]);
            for (std::size_t b = 0; b < Dim; ++b) alone.gradient[a][b] = number(seen.gradient[a][b]);
          }
          visit(layer.slot + lane, alone);
          ++visited;
        }
      });
    }
    return visited;
  }

  /// Sets the velocity of all nodes by `velocity_at(place [m], component)`.
  template <class VelocityAt>
  void set_velocity(VelocityAt&& velocity_at) {
    for (std::int32_t j = 0; j < grid.rows(); ++j) {
      for (std::int32_t i = 0; i < grid.nodes(0); ++i) {
        const PerAxis place{
            static_cast<double>(grid.origin(0)) + i * static_cast<double>(grid.cell_size()),
            Dim == 1 ? 0.0
                     : static_cast<double>(grid.origin(Dim - 1)) + j * static_cast<double>(grid.cell_size())};
        const Eigen::Index node = i + Eigen::Index(j) * grid.row_stride();
        for (std::size_t a = 0; a < Dim; ++a) {
          grid.velocity[a][node] = static_cast<Real>(velocity_at(place, a));
        }
      }
    }
  }

  Vector<Dim, Real> at(const std::array<Field<Real>, Dim>& fields, Eigen::Index slot) const {
    Vector<Dim, Real> vector{};
    for (std::size_t a = 0; a < Dim; ++a) vector[a] = fields[a].size() > 0 ? fields[a][slot] : Real(0);
    return vector;
  }
  double position(Eigen::Index slot, std::size_t axis) const {
    return static_cast<double>(particles.position[axis][slot]);
  }

  /// What the grid should have received, particle by particle.
  PlainSums<Dim> plain_sums() const {
    PlainSums<Dim> sums(grid.mass.size());
    for (const Eigen::Index slot : particles.slot_of) {
      const test::PlainStencil<Dim, Real, scheme> stencil(grid, at(particles.position, slot),
                                                          at(particles.half_size, slot));
      std::array<std::array<double, Dim>, Dim> stress;
      for (std::size_t a = 0; a < Dim; ++a) {
        for (std::size_t b = 0; b < Dim; ++b)
          stress[a][b] = static_cast<double>(particles.stress[a == b ? a : 3][slot]);
      }
      const auto mass = static_cast<double>(particles.mass[slot]);
      const auto volume = static_cast<double>(particles.volume[slot]);
      for (const auto& seen : stencil) {
        const auto node = static_cast<std::size_t>(seen.node);
        const auto weight = static_cast<double>(seen.weight);
        sums.mass[node] += weight * mass;
        for (std::size_t a = 0; a < Dim; ++a) {
          sums.momentum[a][node] += weight * mass * static_cast<double>(particles.velocity[a][slot]);
          sums.external_force[a][node] += weight * static_cast<double>(particles.external_force[a][slot]);
          for (std::size_t b = 0; b < Dim; ++b) {
            const double force = -volume * stress[a][b] * static_cast<double>(seen.gradient[b]);
            sums.internal_force[a][node] += force;
            sums.largest_force = std::max(sums.largest_force, std::abs(force));
          }
        }
      }
    }
    return sums;
  }
};

template <class CloudType>
class EveryTransfer : public testing::Test {};
using Clouds = testing::Types<
    Cloud<1, Scheme::mpm, double>, Cloud<1, Scheme::ugimp, double>, Cloud<1, Scheme::cpgimp, double>,
    Cloud<2, Scheme::mpm, double>, Cloud<2, Scheme::ugimp, double>, Cloud<2, Scheme::cpgimp, double>,
    Cloud<1, Scheme::mpm, float>, Cloud<1, Scheme::ugimp, float>, Cloud<1, Scheme::cpgimp, float>,
    Cloud<2, Scheme::mpm, float>, Cloud<2, Scheme::ugimp, float>, Cloud<2, Scheme::cpgimp, float>>;
TYPED_TEST_SUITE(EveryTransfer, Clouds);

/// Cells by which particles are away from where they were put in order.
constexpr double reaches[] = {0.0, 0.6, 4.0};

constexpr Sends everything{.mass = true, .momentum = true, .internal_force = true, .external_force = true};

TYPED_TEST(EveryTransfer, HasStraysWhereItIsMeantTo) {
  EXPECT_EQ(TypeParam(0.0).strays(), 0);
  EXPECT_GT(TypeParam(0.6).strays(), 0);
  TypeParam far(4.0);
  EXPECT_GT(far.strays(), far.particles.count() / 2);
}

TYPED_TEST(EveryTransfer, KeepsMassAndMomentumAndAddsNoNetForce) {
  for (const double reach : reaches) {
    TypeParam cloud(reach);
    cloud.template scatter<Sends{.mass = true, .momentum = true, .internal_force = true}>();
    const double largest = cloud.plain_sums().largest_force;
    double mass = 0, expected_mass = 0;
    for (const auto node_mass : cloud.grid.mass) mass += static_cast<double>(node_mass);
    for (const Eigen::Index slot : cloud.particles.slot_of)
      expected_mass += static_cast<double>(cloud.particles.mass[slot]);
    EXPECT_NEAR(mass, expected_mass, TypeParam::round_off * mass);
    EXPECT_GT(largest, 0);
    for (std::size_t a = 0; a < TypeParam::dimension; ++a) {
      double momentum = 0, force = 0, expected_momentum = 0;
      for (Eigen::Index i = 0; i < cloud.grid.mass.size(); ++i) {
        momentum += static_cast<double>(cloud.grid.momentum[a][i]);
        force += static_cast<double>(cloud.grid.force[a][i]);
      }
      for (const Eigen::Index slot : cloud.particles.slot_of) {
        expected_momentum += static_cast<double>(cloud.particles.mass[slot]) *
                             static_cast<double>(cloud.particles.velocity[a][slot]);
      }
      EXPECT_NEAR(momentum, expected_momentum, TypeParam::round_off * mass);
      EXPECT_NEAR(force, 0.0, TypeParam::round_off * largest);
    }
  }
}

TYPED_TEST(EveryTransfer, GivesEveryNodeThePlainSumOverTheParticles) {
  for (const double reach : reaches) {
    TypeParam cloud(reach);
    cloud.template scatter<everything>();
    const auto sums = cloud.plain_sums();
    const double particle_mass = total_mass(cloud.particles) / static_cast<double>(cloud.particles.count());
    for (std::size_t i = 0; i < sums.mass.size(); ++i) {
      const auto node = static_cast<Eigen::Index>(i);
      ASSERT_NEAR(static_cast<double>(cloud.grid.mass[node]), sums.mass[i],
                  TypeParam::round_off * particle_mass);
      for (std::size_t a = 0; a < TypeParam::dimension; ++a) {
        ASSERT_NEAR(static_cast<double>(cloud.grid.momentum[a][node]), sums.momentum[a][i],
                    TypeParam::round_off * particle_mass);
        ASSERT_NEAR(static_cast<double>(cloud.grid.force[a][node]),
                    sums.internal_force[a][i] + sums.external_force[a][i],
                    TypeParam::round_off * (sums.largest_force + 100));
      }
    }
  }
}

TYPED_TEST(EveryTransfer, SendsOnlyWhatItIsAskedTo) {
  TypeParam whole(0.6), parts(0.6);
  whole.template scatter<everything>();
  const double tolerance = TypeParam::round_off * (whole.plain_sums().largest_force + 100);
  const auto difference = [](const auto& one, const auto& other) {
    return static_cast<double>((one - other).abs().maxCoeff());
  };
  parts.template scatter<Sends{.mass = true, .momentum = true}>();
  for (std::size_t a = 0; a < TypeParam::dimension; ++a) EXPECT_EQ(parts.grid.force[a].abs().maxCoeff(), 0);
  parts.template scatter<Sends{.internal_force = true, .external_force = true}>();
  EXPECT_LE(difference(whole.grid.mass, parts.grid.mass), TypeParam::round_off * 20);
  for (std::size_t a = 0; a < TypeParam::dimension; ++a) {
    EXPECT_LE(difference(whole.grid.momentum[a], parts.grid.momentum[a]), TypeParam::round_off * 20);
    EXPECT_LE(difference(whole.grid.force[a], parts.grid.force[a]), tolerance);
  }
  parts.grid.clear_momentum({0, parts.grid.rows()});
  parts.template scatter<Sends{.momentum = true}>();
  for (std::size_t a = 0; a < TypeParam::dimension; ++a)
    EXPECT_LE(difference(whole.grid.momentum[a], parts.grid.momentum[a]), TypeParam::round_off * 20);
  EXPECT_LE(difference(whole.grid.mass, parts.grid.mass), TypeParam::round_off * 20);
}

TYPED_TEST(EveryTransfer, AddsToTheGridWhatExternalForcesAmountTo) {
  for (const double reach : reaches) {
    TypeParam cloud(reach);
    cloud.template scatter<Sends{.external_force = true}>();
    for (std::size_t a = 0; a < TypeParam::dimension; ++a) {
      double on_grid = 0, on_particles = 0;
      for (const auto force : cloud.grid.force[a]) on_grid += static_cast<double>(force);
      for (const Eigen::Index slot : cloud.particles.slot_of)
        on_particles += static_cast<double>(cloud.particles.external_force[a][slot]);
      EXPECT_NEAR(on_grid, on_particles,
                  TypeParam::round_off * 100 * std::sqrt(static_cast<double>(cloud.particles.count())));
    }
  }
}

TYPED_TEST(EveryTransfer, DoesWorkOnTheGridThatEqualsTheWorkOnTheParticles) {
  // Virtual work: sum over nodes of force . velocity = - sum over particles of volume * stress : strain rate.
  for (const double reach : reaches) {
    TypeParam cloud(reach);
    cloud.template scatter<Sends{.internal_force = true}>();
    cloud.set_velocity([](const PerAxis& place, std::size_t a) {
      return std::sin(3 * place[0] + static_cast<double>(a)) * (1 + place[1] * place[1]);
    });
    double on_grid = 0, on_particles = 0, scale = 0;
    for (std::size_t a = 0; a < TypeParam::dimension; ++a) {
      for (Eigen::Index i = 0; i < cloud.grid.mass.size(); ++i) {
        on_grid +=
            static_cast<double>(cloud.grid.force[a][i]) * static_cast<double>(cloud.grid.velocity[a][i]);
      }
    }
    const Eigen::Index visited = cloud.template gather<false, true>([&](Eigen::Index slot, const auto& seen) {
      for (std::size_t a = 0; a < TypeParam::dimension; ++a) {
        for (std::size_t b = 0; b < TypeParam::dimension; ++b) {
          const double work = static_cast<double>(cloud.particles.volume[slot]) *
                              static_cast<double>(cloud.particles.stress[a == b ? a : 3][slot]) *
                              seen.gradient[a][b];
          on_particles -= work;
          scale += std::abs(work);
        }
      }
    });
    EXPECT_EQ(visited, cloud.particles.count());
    EXPECT_NEAR(on_grid, on_particles, TypeParam::round_off * scale);
  }
}

TYPED_TEST(EveryTransfer, GathersALinearVelocityFieldExactly) {
  // A row and a column of slopes, so that no two components are alike.
  const auto slope = [](std::size_t a, std::size_t b) {
    return 0.75 - 0.5 * static_cast<double>(a) + 0.3 * static_cast<double>(b);
  };
  const auto velocity_at = [&](const PerAxis& place, std::size_t a) {
    double velocity = 2.0;
    for (std::size_t b = 0; b < TypeParam::dimension; ++b) velocity += slope(a, b) * place[b];
    return velocity;
  };
  for (const double reach : reaches) {
    TypeParam cloud(reach);
    cloud.set_velocity(velocity_at);
    for (std::size_t a = 0; a < TypeParam::dimension; ++a)
      cloud.grid.acceleration[a] = cloud.grid.velocity[a];
    const Eigen::Index visited = cloud.template gather<true, true>([&](Eigen::Index slot, const auto& seen) {
      PerAxis place{};
      for (std::size_t a = 0; a < TypeParam::dimension; ++a) place[a] = cloud.position(slot, a);
      for (std::size_t a = 0; a < TypeParam::dimension; ++a) {
        ASSERT_NEAR(seen.velocity[a], velocity_at(place, a), TypeParam::round_off * 8);
        ASSERT_NEAR(seen.acceleration[a], velocity_at(place, a), TypeParam::round_off * 8);
        for (std::size_t b = 0; b < TypeParam::dimension; ++b) {
          // The slope is a difference of velocities over a cell.
          ASSERT_NEAR(seen.gradient[a][b], slope(a, b), TypeParam::round_off * 8 / cloud.scene.cell_size);
        }
      }
    });
    EXPECT_EQ(visited, cloud.particles.count());
  }
}

TYPED_TEST(EveryTransfer, SeesNoStrainInARigidMotionAndItsWholeTurn) {
  constexpr double spin = 0.4, time_step = 1e-2;
  for (const double reach : reaches) {
    TypeParam cloud(reach);
    cloud.set_velocity([&](const PerAxis& place, std::size_t a) {
      if constexpr (TypeParam::dimension == 1) return 3.0;
      return 3.0 + (a == 0 ? -spin * place[1] : spin * place[0]);
    });
    cloud.template gather<false, true>([&](Eigen::Index, const auto& seen) {
      const auto deformation = deformation_of<TypeParam::dimension, double>(seen.gradient, time_step);
      const double tolerance = TypeParam::round_off * 8 * time_step / cloud.scene.cell_size;
      for (const double component : deformation.strain_increment) ASSERT_NEAR(component, 0.0, tolerance);
      ASSERT_NEAR(deformation.rotation, TypeParam::dimension == 1 ? 0.0 : spin * time_step, tolerance);
    });
  }
}

TYPED_TEST(EveryTransfer, NamesTheParticleThatHasNoStencil) {
  using Real = typename TypeParam::Real;
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  const auto fault_after = [](auto&& damage) {
    TypeParam cloud(0.0);
    damage(cloud.particles, [&](std::size_t id) { return cloud.particles.slot_of[id]; });
    return TypeParam::Transfers::find_fault(cloud.particles, cloud.grid);
  };
  EXPECT_EQ(fault_after([](auto&, auto&&) {}).kind, StencilFault::none);
  const auto lost = fault_after([](auto& p, auto&& slot) { p.position[0][slot(5)] = Real(2.01); });
  EXPECT_EQ(lost.kind, StencilFault::outside_grid);
  EXPECT_EQ(lost.particle, 5);
  EXPECT_EQ(lost.value, static_cast<double>(Real(2.01)));
  EXPECT_EQ(fault_after([&](auto& p, auto&& slot) { p.position[0][slot(2)] = nan; }).kind,
            StencilFault::not_finite);
  EXPECT_EQ(fault_after([](auto& p, auto&& slot) { p.volume[slot(2)] = Real(-1e-9); }).kind,
            StencilFault::inverted);
  EXPECT_EQ(fault_after([&](auto& p, auto&& slot) { p.volume[slot(2)] = nan; }).kind,
            StencilFault::not_finite);
  // It has a stencil, but its stress would poison the next step.
  const auto poisoned = fault_after([&](auto& p, auto&& slot) {
    p.stress[0][slot(4)] = nan;
    p.position[0][slot(9)] = nan;
  });
  EXPECT_EQ(poisoned.kind, StencilFault::not_finite);
  EXPECT_EQ(poisoned.particle, 4);
  if constexpr (SchemeTraits<TypeParam::scheme>::has_domain) {
    const auto large = fault_after([](auto& p, auto&& slot) { p.half_size[0][slot(7)] = Real(0.1001); });
    EXPECT_EQ(large.kind, StencilFault::domain_too_large);
    EXPECT_EQ(large.particle, 7);
  }
}

/// Two free blocks under gravity that move through one another at opposite velocities: the grid's velocity is
/// that of free fall and its acceleration is gravity, so that the blend is known whatever the stencils.
template <class CloudType>
Scene falling(double flip, UpdateOrder order) {
  Scene scene = CloudType::make_scene();
  scene.update_order = order;
  scene.flip_fraction = flip;
  Body& body = scene.bodies[0];
  body.name = "block";
  body.velocity = {0.5, -0.25};
  body.material = LinearElastic{1e4, 0.0};
  Body other = body;
  other.name = "other";
  other.velocity = {-0.5, 0.25};
  scene.bodies = {body, other};
  scene.gravity.acceleration = {-8.0, 6.0};
  return scene;
}

TYPED_TEST(EveryTransfer, BlendsFlipAndPic) {
  // TimeStepper does not check the scene, so that two bodies may lie in one place.
  using Real = typename TypeParam::Real;
  constexpr double time_step = 1e-3;
  for (const UpdateOrder order : {UpdateOrder::musl, UpdateOrder::usf, UpdateOrder::usl}) {
    for (const double flip : {0.0, 0.25, 1.0}) {
      const Scene scene = falling<TypeParam>(flip, order);
      TimeStepper<TypeParam::dimension, Real, TypeParam::scheme> stepper(scene, time_step, 1);
      const auto start = stepper.particles();
      Vector<TypeParam::dimension, Real> gravity;
      for (std::size_t a = 0; a < TypeParam::dimension; ++a)
        gravity[a] = static_cast<Real>(scene.gravity.acceleration[a]);
      ASSERT_TRUE(stepper.advance(0.0, gravity));
      const auto& end = stepper.particles();
      for (const Eigen::Index slot : end.slot_of) {
        for (std::size_t a = 0; a < TypeParam::dimension; ++a) {
          const double on_grid = time_step * scene.gravity.acceleration[a];
          const double before = static_cast<double>(start.velocity[a][slot]);
          ASSERT_NEAR(static_cast<double>(end.velocity[a][slot]),
                      flip * (before + on_grid) + (1 - flip) * on_grid, TypeParam::round_off);
          ASSERT_NEAR(static_cast<double>(end.displacement[a][slot]), time_step * on_grid,
                      TypeParam::round_off * time_step);
        }
      }
    }
  }
}

}  // namespace
