#include "solver/cell_blocks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "solver/shape_functions.hpp"

namespace {

using namespace mpm;

/// Three bodies, two of which have cells in common, on a grid that is no multiple of the lanes wide.
template <int Dim, class Real_, int nodes_before_>
struct Order {
  static constexpr int dimension = Dim;
  static constexpr int nodes_before = nodes_before_;
  using Real = Real_;
  using Blocks = CellBlocks<Dim, Real>;
  static constexpr Eigen::Index lanes = Blocks::lanes;

  Scene scene = make_scene();
  Grid<Dim, Real> grid{scene};
  Particles<Dim, Real> particles = fill_bodies<Dim, Real>(scene, true);
  Particles<Dim, Real> filled = particles;
  Blocks blocks{grid, nodes_before, particles};

  static Scene make_scene() {
    Scene scene;
    scene.dimension = Dim;
    scene.scheme = Scheme::cpgimp;
    scene.update_order = UpdateOrder::musl;
    scene.sums_strain = true;
    scene.sums_work = true;
    scene.cell_size = 0.1;
    scene.grid_lower = {-0.7, 0.2};
    scene.grid_upper = {4.6, 6.1};
    Body left, right, top;
    left.name = "left", right.name = "right", top.name = "top";
    left.lower = {-0.7, 0.2};
    left.upper = {1.05, 5.05};
    right.lower = {1.05, 0.2};
    right.upper = {4.6, 3.7};
    top.lower = {1.05, 5.2};
    top.upper = {2.3, 6.1};
    if (Dim == 1) right.lower = {2.3, 0.2};
    for (Body* body : {&left, &right, &top}) {
      body->particles_per_cell = {4, 4};
      body->density = 1000.0;
      body->material = NeoHookean{1e5, 0.3};
      scene.bodies.push_back(*body);
    }
    return scene;
  }

  /// Moves all particles at random within the grid, by `reach` cells at most, and marks their fields.
  void stir(double reach) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> uniform(-reach, reach);
    for (std::size_t id = 0; id < particles.slot_of.size(); ++id) {
      const Eigen::Index slot = particles.slot_of[id];
      for (std::size_t a = 0; a < Dim; ++a) {
        const double place = static_cast<double>(particles.position[a][slot]) + 0.1 * uniform(random);
        particles.position[a][slot] =
            static_cast<Real>(std::clamp(place, scene.grid_lower[a] + 1e-3, scene.grid_upper[a] - 1e-3));
        particles.velocity[a][slot] = static_cast<Real>(id);
      }
      particles.stress[0][slot] = static_cast<Real>(2 * id);
    }
  }

  std::int32_t cell(Eigen::Index slot, std::size_t axis) const {
    return static_cast<std::int32_t>((particles.position[axis][slot] - grid.origin(static_cast<int>(axis))) *
                                     grid.cells_per_length());
  }

  /// Calls `visit(block, slot, lane)` for every slot of every block.
  template <class Visit>
  void for_each_slot(Visit&& visit) const {
    for (const Block& block : blocks.blocks()) {
      for (Eigen::Index k = 0; k < block.depth * lanes; ++k)
        visit(block, block.first_slot + k, static_cast<std::int32_t>(k % lanes));
    }
  }

  void expect_order() const {
    const auto slots = static_cast<std::size_t>(particles.slots());
    ASSERT_EQ(particles.id.size(), slots);
    std::vector<int> met(slots, 0);
    std::set<std::int32_t> ids;
    for_each_slot([&](const Block& block, Eigen::Index slot, std::int32_t lane) {
      ASSERT_LT(slot, particles.slots());
      ++met[static_cast<std::size_t>(slot)];
      // Empty slots lie in the cell of their lane as well.
      ASSERT_EQ(cell(slot, 0), block.first_cell + lane);
      ASSERT_EQ(Dim == 1 ? 0 : cell(slot, Dim - 1), block.row);
      const std::int32_t id = particles.id[static_cast<std::size_t>(slot)];
      if (id < 0) {
        ASSERT_EQ(particles.mass[slot], 0);
        ASSERT_GT(particles.volume[slot], 0);
        ASSERT_GT(particles.half_size[0][slot], 0);
      } else {
        ASSERT_EQ(particles.slot_of[static_cast<std::size_t>(id)], slot);
        ASSERT_GT(particles.mass[slot], 0);
        ASSERT_TRUE(ids.insert(id).second);
      }
    });
    ASSERT_EQ(ids.size(), particles.slot_of.size());
    for (std::size_t slot = 0; slot < slots; ++slot) {
      ASSERT_LE(met[slot], 1);
      if (met[slot] == 0) {
        ASSERT_EQ(particles.id[slot], -1);
        ASSERT_EQ(particles.mass[static_cast<Eigen::Index>(slot)], 0);
      }
    }
  }
};

template <class OrderType>
class EveryOrder : public testing::Test {};
using Orders = testing::Types<Order<1, double, 0>, Order<1, float, 1>, Order<2, double, 0>,
                              Order<2, double, 1>, Order<2, float, 0>, Order<2, float, 1>>;
TYPED_TEST_SUITE(EveryOrder, Orders);

TYPED_TEST(EveryOrder, HasEveryParticleInItsCellsLane) {
  TypeParam order;
  order.expect_order();
  order.stir(3.0);
  order.blocks.arrange(order.grid, order.particles);
  order.expect_order();
}

TYPED_TEST(EveryOrder, LeavesNoMoreRoomThanTheFullestLaneOfABlockNeeds) {
  TypeParam order;
  order.stir(3.0);
  order.blocks.arrange(order.grid, order.particles);
  for (const Block& block : order.blocks.blocks()) {
    EXPECT_GT(block.depth, 0);
    bool last_layer_is_used = false;
    for (Eigen::Index k = (block.depth - 1) * TypeParam::lanes; k < block.depth * TypeParam::lanes; ++k)
      last_layer_is_used =
          last_layer_is_used || order.particles.id[static_cast<std::size_t>(block.first_slot + k)] >= 0;
    EXPECT_TRUE(last_layer_is_used);
  }
}

TYPED_TEST(EveryOrder, KeepsWhatParticlesCarry) {
  TypeParam order;
  order.stir(3.0);
  const auto before = order.particles;
  order.blocks.arrange(order.grid, order.particles);
  const auto& after = order.particles;
  for (std::size_t id = 0; id < after.slot_of.size(); ++id) {
    const Eigen::Index from = before.slot_of[id], to = after.slot_of[id];
    for (std::size_t a = 0; a < TypeParam::dimension; ++a) {
      ASSERT_EQ(after.position[a][to], before.position[a][from]);
      ASSERT_EQ(after.velocity[a][to], static_cast<typename TypeParam::Real>(id));
      ASSERT_EQ(after.half_size[a][to], before.half_size[a][from]);
    }
    ASSERT_EQ(after.stress[0][to], static_cast<typename TypeParam::Real>(2 * id));
    ASSERT_EQ(after.mass[to], order.filled.mass[static_cast<Eigen::Index>(id)]);
    ASSERT_EQ(after.volume[to], order.filled.volume[static_cast<Eigen::Index>(id)]);
    if constexpr (TypeParam::dimension == 2) {
      ASSERT_EQ(after.deformation_gradient[3][to], 1);
    }
  }
}

TYPED_TEST(EveryOrder, KeepsBodiesApart) {
  TypeParam order;
  order.stir(3.0);
  order.blocks.arrange(order.grid, order.particles);
  ASSERT_EQ(order.particles.bodies.size(), 3U);
  Eigen::Index slot = 0;
  for (std::size_t b = 0; b < 3; ++b) {
    const ParticleRange now = order.particles.bodies[b], once = order.filled.bodies[b];
    EXPECT_EQ(now.first, slot);
    for (; slot < now.last; ++slot) {
      const std::int32_t id = order.particles.id[static_cast<std::size_t>(slot)];
      if (id < 0) continue;
      EXPECT_GE(id, once.first);
      EXPECT_LT(id, once.last);
    }
  }
}

TYPED_TEST(EveryOrder, GivesEveryBlockToOneBandAndOfTheRightBody) {
  TypeParam order;
  std::vector<int> met(order.blocks.blocks().size(), 0);
  for (const Band& band : order.blocks.bands()) {
    ASSERT_EQ(band.blocks.size(), 3U);
    for (std::size_t b = 0; b < 3; ++b) {
      for (std::size_t k = band.blocks[b].first; k < band.blocks[b].second; ++k) {
        const Block& block = order.blocks.blocks()[k];
        ++met[k];
        EXPECT_GE(block.row, band.rows.begin);
        EXPECT_LT(block.row, band.rows.end);
        EXPECT_GE(block.first_slot, order.particles.bodies[b].first);
        EXPECT_LT(block.first_slot, order.particles.bodies[b].last);
      }
    }
  }
  EXPECT_EQ(met, std::vector<int>(met.size(), 1));
}

TYPED_TEST(EveryOrder, KeepsBandsOfOneColourApart) {
  TypeParam order;
  const auto& bands = order.blocks.bands();
  if (TypeParam::dimension == 1) {
    EXPECT_EQ(bands.size(), 1U);
    return;
  }
  ASSERT_GE(bands.size(), 3U);
  // The particles would do for bands of a row or two: what keeps them apart is the least height of a band.
  ASSERT_GT(order.particles.count(), 500 * order.grid.rows());
  constexpr std::int32_t strays = TypeParam::Blocks::stray_rows;
  // One past the last row of nodes that a particle of the last row of cells reaches, with either shape.
  constexpr std::int32_t width = TypeParam::nodes_before == 0 ? LinearShape::width : GimpShape::width;
  for (std::size_t k = 0; k < bands.size(); ++k) {
    EXPECT_LT(bands[k].rows.begin, bands[k].rows.end);
    if (k > 0) {
      EXPECT_EQ(bands[k].rows.begin, bands[k - 1].rows.end);
    }
    const std::int32_t end = bands[k].rows.end - 1 + strays - TypeParam::nodes_before + width;
    EXPECT_LE(end, order.blocks.active_rows().end);
    if (k + 2 < bands.size()) {
      EXPECT_LE(end, bands[k + 2].rows.begin - strays - TypeParam::nodes_before);
    }
  }
  EXPECT_LE(order.blocks.active_rows().begin, bands[0].rows.begin - TypeParam::nodes_before - strays);
}

TYPED_TEST(EveryOrder, IsTheSameTwice) {
  TypeParam order;
  order.stir(3.0);
  order.blocks.arrange(order.grid, order.particles);
  const auto id = order.particles.id;
  const auto position = order.particles.position;
  order.blocks.arrange(order.grid, order.particles);
  EXPECT_EQ(order.particles.id, id);
  for (std::size_t a = 0; a < TypeParam::dimension; ++a)
    EXPECT_TRUE((order.particles.position[a] == position[a]).all());
}

TYPED_TEST(EveryOrder, StaysInItsPlaceInMemory) {
  TypeParam order;
  order.stir(3.0);
  order.blocks.arrange(order.grid, order.particles);  // room for the worst of what follows
  const auto places = [&] {
    std::set<const void*> found;
    order.particles.for_each_field([&](auto& field, auto) { found.insert(field.data()); });
    return found;
  };
  // Fields change places with one another and with one array beside them.
  auto known = places();
  order.blocks.arrange(order.grid, order.particles);
  known.merge(places());
  const Eigen::Index slots = order.particles.slots();
  for (int k = 0; k < 5; ++k) {
    order.blocks.arrange(order.grid, order.particles);
    for (const void* place : places()) EXPECT_TRUE(known.contains(place));
    EXPECT_EQ(order.particles.slots(), slots);
  }
}

}  // namespace
