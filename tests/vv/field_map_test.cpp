#include "vv/field_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <stdexcept>

namespace mpm::vv {
namespace {

/// Two particles whose every number differs, so that no mix-up of axes, components or particles goes unseen.
Snapshot two_particles() {
  Snapshot snapshot;
  snapshot.moment = "t = 0.5 s";
  snapshot.time = 0.5;
  ParticleFields& f = snapshot.fields;
  f.dimension = 2;
  f.initial_position = {0.0, 0.0, 1.0, 0.0};
  f.displacement = {3e-3, -4e-3, 5e-3, 12e-3};
  f.position = {3e-3, -4e-3, 1.005, 0.012};
  f.velocity = {0.6, 0.8, -1.5, 2.0};
  f.half_size = {0.1, 0.2, 0.3, 0.4};
  f.stress = {-9e3, -5e3, -1e3, 1.5e3, 2e3, 8e3, -4e3, -4e3};
  f.strain = {0.03, -0.01, 0.0, 0.015, -0.02, 0.04, 0.0, -0.04};
  f.volume = {0.04, 0.09};
  f.initial_volume = {0.16, 0.25};
  f.mass = {1.0, 2.0};
  f.body = {0, 0};
  return snapshot;
}

TEST(FieldMaps, HaveTheValuesOfTheirFormulas) {
  // xx - yy = -4e3, 2 xy = 3e3: the circle's diameter is 5e3. Its strains: 0.04 and 0.03 give 0.05.
  const std::map<std::string, std::pair<double, double>> expected{
      {"displacement", {5e-3, 13e-3}},    {"displacement_x", {3e-3, 5e-3}},
      {"displacement_y", {-4e-3, 12e-3}}, {"speed", {1.0, 2.5}},
      {"stress_xx", {-9e3, 2e3}},         {"stress_yy", {-5e3, 8e3}},
      {"stress_zz", {-1e3, -4e3}},        {"stress_xy", {1.5e3, -4e3}},
      {"mean_stress", {-5e3, 2e3}},       {"max_shear_stress", {2.5e3, 5e3}},
      {"max_shear_strain", {0.05, 0.1}},
  };
  ASSERT_EQ(field_catalogue().size(), expected.size());
  for (const FieldQuantity& quantity : field_catalogue()) {
    const FieldMap map = map_of(two_particles(), quantity.name);
    ASSERT_EQ(map.value.size(), 2U) << quantity.name;
    // Few roundings.
    EXPECT_NEAR(map.value[0] / expected.at(quantity.name).first, 1.0, 1e-13) << quantity.name;
    EXPECT_NEAR(map.value[1] / expected.at(quantity.name).second, 1.0, 1e-13) << quantity.name;
    EXPECT_EQ(map.quantity, quantity.name);
    EXPECT_EQ(map.unit, quantity.unit);
    EXPECT_FALSE(quantity.meaning.empty());
  }
}

TEST(FieldMaps, AreOfTheCurrentPlaceAtTheirMoment) {
  const FieldMap map = map_of(two_particles(), "speed");
  EXPECT_EQ(map.x, (std::vector<double>{3e-3, 1.005}));
  EXPECT_EQ(map.y, (std::vector<double>{-4e-3, 0.012}));
  EXPECT_EQ(map.moment, "t = 0.5 s");
  EXPECT_EQ(map.time, 0.5);
}

TEST(FieldMaps, ParticlesWithADomainAreAsLargeAsIt) {
  const FieldMap map = map_of(two_particles(), "speed");
  EXPECT_EQ(map.half_x, (std::vector<double>{0.1, 0.3}));
  EXPECT_EQ(map.half_y, (std::vector<double>{0.2, 0.4}));
}

TEST(FieldMaps, PointsAreSquaresOfTheirCurrentArea) {
  Snapshot snapshot = two_particles();
  snapshot.fields.half_size = {0.0, 0.0, 0.0, 0.0};
  const FieldMap map = map_of(snapshot, "speed");
  EXPECT_NEAR(map.half_x[0], 0.1, 1e-15);
  EXPECT_NEAR(map.half_y[1], 0.15, 1e-15);
  snapshot.fields.volume = {0.0, std::nan("")};
  for (const double half : map_of(snapshot, "speed").half_x) EXPECT_GT(half, 0.0);
}

TEST(FieldMaps, RefuseWhatTheyCannotMap) {
  Snapshot snapshot = two_particles();
  EXPECT_THROW(map_of(snapshot, "temperature"), std::invalid_argument);
  snapshot.fields.strain.clear();
  EXPECT_NO_THROW(map_of(snapshot, "max_shear_stress"));
  EXPECT_THROW(map_of(snapshot, "max_shear_strain"), std::invalid_argument);
  snapshot.fields.dimension = 1;
  EXPECT_THROW(map_of(snapshot, "displacement"), std::invalid_argument);
}

}  // namespace
}  // namespace mpm::vv
