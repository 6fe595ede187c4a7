#include "vv/element_test.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "solver/error.hpp"

namespace {

using namespace mpm;
using namespace mpm::vv;

constexpr double degree = std::numbers::pi / 180;

constexpr ElementPath paths[] = {ElementPath::plane_strain_compression,
                                 ElementPath::plane_strain_extension,
                                 ElementPath::oedometric_compression,
                                 ElementPath::oedometric_extension,
                                 ElementPath::simple_shear,
                                 ElementPath::isotropic_tension};

ElementTest test_of(const MohrCoulomb& material, ElementPath path, int increments = 100) {
  return {.material = material,
          .path = path,
          .precision = Precision::float64,
          .pressure = 2e4,
          .strain = 0.01,
          .increments = increments,
          .states = 1500,
          .seed = 5};
}

MohrCoulomb cemented(double friction = 30, double dilation = 10, double cohesion = 5e3) {
  return {2e7, 0.3, friction * degree, cohesion, dilation * degree};
}

std::vector<MohrCoulomb> materials() {
  std::vector<MohrCoulomb> all;
  for (double friction : {0.0, 15.0, 30.0, 45.0})
    for (double share : {0.0, 0.5, 1.0})
      for (double cohesion : {0.0, 5e3})
        for (double nu : {0.0, 0.3, 0.49})
          if (friction + cohesion > 0 && (friction > 0 || share == 0))
            all.push_back({2e7, nu, friction * degree, cohesion, share * friction * degree});
  return all;
}

std::string name_of(const MohrCoulomb& m) {
  return "phi " + std::to_string(m.friction_angle / degree) + " psi " +
         std::to_string(m.dilation_angle / degree) + " c " + std::to_string(m.cohesion) + " nu " +
         std::to_string(m.poissons_ratio);
}

// Flow keeps its direction on every branch, so the number of increments decides nothing but the round-off:
// some 2e-16 of the stress an increment, and nu/(1 - 2 nu) times as much of a strain's own.
TEST(VerificationOfElementTests, FollowTheClosedFormWhateverTheIncrements) {
  for (const MohrCoulomb& material : materials()) {
    SCOPED_TRACE(name_of(material));
    for (ElementPath path : paths) {
      SCOPED_TRACE(static_cast<int>(path));
      for (int increments : {1, 7, 100}) {
        const ElementTest test = test_of(material, path, increments);
        const ElementRun run = run_element_test(test);
        ASSERT_EQ(run.curves.size(), 5u);
        ASSERT_EQ(run.curves.front().strain.size(), static_cast<std::size_t>(increments) + 1);
        for (const auto& [metric, value] : judge_element_curves(test, run.curves))
          EXPECT_LE(value, 1e-12) << metric;
      }
    }
  }
}

TEST(VerificationOfElementTests, YieldWhereTheClosedFormDoes) {
  const ElementTest compression = test_of(cemented(), ElementPath::plane_strain_compression);
  const ElementRun run = run_element_test(compression);
  const auto expected = closed_form(compression, run.curves);
  const auto& stress = expected[1].value;
  const auto on_limit = std::count(stress.begin(), stress.end(), stress.back());
  EXPECT_NEAR(run.measured.at("element.yielding_increments"), static_cast<double>(on_limit), 1);
  EXPECT_GT(on_limit, 50);
}

TEST(VerificationOfElementTests, FindTheLawRightInRandomStates) {
  for (const MohrCoulomb& material : materials()) {
    SCOPED_TRACE(name_of(material));
    const auto found = run_element_test(test_of(material, ElementPath::random_states)).measured;
    EXPECT_LE(found.at("element.excess"), 2e-15);
    EXPECT_GE(found.at("element.plastic_work"), -1e-13);
    for (const char* metric : {"element.oracle", "element.rotation", "element.exchange"})
      EXPECT_LE(found.at(metric), 1e-13) << metric;
    EXPECT_EQ(found.at("element.moved_again"), 0);
    EXPECT_EQ(found.at("element.unequal_mirrored"), 0);
  }
}

TEST(VerificationOfElementTests, HitEveryPartOfTheLimit) {
  EXPECT_EQ(
      run_element_test(test_of(cemented(), ElementPath::random_states)).measured.at("element.regions_hit"),
      14);
  EXPECT_EQ(run_element_test(test_of(cemented(0, 0), ElementPath::random_states))
                .measured.at("element.regions_hit"),
            13);
}

TEST(ElementTest, TellsSinglePrecisionFromDouble) {
  for (ElementPath path : paths) {
    ElementTest test = test_of(cemented(), path);
    test.precision = Precision::float32;
    const auto metrics = judge_element_curves(test, run_element_test(test).curves);
    EXPECT_GT(metrics.at("element.stress"), 1e-9);
    EXPECT_LT(metrics.at("element.stress"), 1e-4);
  }
}

// What the metrics are for: a curve that is wrong by a thousandth must show in the one that speaks of it.
TEST(ElementTest, SeesWhatIsWrongWithACurve) {
  const ElementTest test = test_of(cemented(), ElementPath::plane_strain_compression);
  const std::vector<ElementCurve> right = run_element_test(test).curves;
  const auto spoilt = [&](std::size_t curve) {
    std::vector<ElementCurve> curves = right;
    for (double& value : curves[curve].value) value *= 1.001;
    return judge_element_curves(test, curves);
  };
  EXPECT_NEAR(spoilt(0).at("element.held"), 1e-3, 1e-6);
  EXPECT_GT(spoilt(1).at("element.limit"), 1e-4);
  EXPECT_NEAR(spoilt(1).at("element.stress"), 1e-3, 1e-6);
  EXPECT_GT(spoilt(2).at("element.out_of_plane"), 1e-4);
  EXPECT_LT(spoilt(2).at("element.limit"), 1e-12);
  EXPECT_GT(spoilt(4).at("element.volume"), 1e-4);
  EXPECT_GT(spoilt(4).at("element.dilation"), 1e-4);
  auto broken = right;
  broken[1].value[3] = std::nan("");
  EXPECT_TRUE(std::isnan(judge_element_curves(test, broken).at("element.stress")));
}

TEST(ElementTest, NamesEveryMetricItMeasures) {
  const auto known = [](const std::string& name) {
    return std::any_of(element_metrics().begin(), element_metrics().end(),
                       [&](const ElementMetric& metric) { return metric.name == name; });
  };
  for (ElementPath path : {ElementPath::random_states, ElementPath::plane_strain_compression}) {
    const ElementTest test = test_of(cemented(), path);
    const ElementRun run = run_element_test(test);
    for (const auto& [name, value] : run.measured) EXPECT_TRUE(known(name)) << name;
    for (const auto& [name, value] : judge_element_curves(test, run.curves)) EXPECT_TRUE(known(name)) << name;
  }
}

TEST(ElementTest, RepeatsTheSameStatesFromTheSameSeed) {
  ElementTest test = test_of(cemented(), ElementPath::random_states);
  const auto first = run_element_test(test).measured;
  EXPECT_EQ(run_element_test(test).measured, first);
  test.seed = 6;
  EXPECT_NE(run_element_test(test).measured, first);
}

TEST(ElementTest, RefusesTheImpossible) {
  const auto place_of = [](const ElementTest& test) {
    try {
      check(test);
    } catch (const SceneError& error) {
      return error.place();
    }
    return std::string("none");
  };
  const ElementTest good = test_of(cemented(), ElementPath::simple_shear);
  EXPECT_EQ(place_of(good), "none");
  const auto with = [&](auto change) {
    ElementTest test = good;
    change(test);
    return place_of(test);
  };
  EXPECT_EQ(with([](ElementTest& t) { t.material.youngs_modulus = 0; }), "/material/youngs_modulus");
  EXPECT_EQ(with([](ElementTest& t) { t.material.poissons_ratio = 0.5; }), "/material/poissons_ratio");
  EXPECT_EQ(with([](ElementTest& t) { t.material.friction_angle = 1.6; }), "/material/friction_angle");
  EXPECT_EQ(with([](ElementTest& t) { t.material.dilation_angle = 0.6; }), "/material/dilation_angle");
  EXPECT_EQ(with([](ElementTest& t) { t.material.cohesion = -1; }), "/material/cohesion");
  EXPECT_EQ(with([](ElementTest& t) { t.pressure = 0; }), "/path/pressure");
  EXPECT_EQ(with([](ElementTest& t) { t.strain = -0.1; }), "/path/strain");
  EXPECT_EQ(with([](ElementTest& t) { t.increments = 0; }), "/path/increments");
  EXPECT_EQ(with([](ElementTest& t) {
              t.path = ElementPath::random_states;
              t.states = 0;
            }),
            "/path/states");
}

}  // namespace
