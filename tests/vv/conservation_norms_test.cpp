// Momentum and energy judged through made-up histories.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "vv/norms.hpp"

namespace mpm::vv {
namespace {

using Values = std::vector<double>;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// A run of 8 kg that starts with 4 J of kinetic energy, which is a momentum of 8 kg m/s if all move alike.
struct Trial {
  Case definition;
  RunRequest request;
  Record record;

  Trial() {
    request.scene.dimension = 2;
    record.profile.mass = {5.0, 3.0};
  }

  Trial& probe(const std::string& quantity, const std::string& component, const Values& values) {
    HistoryProbe probe;
    probe.id = quantity + component;
    probe.quantity = quantity;
    probe.component = component;
    probe.target = ProbeTarget::everything;
    definition.probes.push_back(probe);
    Values time;
    for (std::size_t k = 0; k < values.size(); ++k) time.push_back(0.1 * static_cast<double>(k));
    record.histories.push_back({probe.id, quantity, time, values});
    return *this;
  }

  std::map<std::string, double> metrics() const { return judge(definition, request, record).metrics; }
};

TEST(MomentumChange, IsTheLargestOverTheMomentumOfTheInitialEnergy) {
  Trial trial;
  trial.probe("momentum", "x", {1.0, 1.5, 0.2, 1.0}).probe("kinetic_energy", "", {4.0, 1.0, 9.0, 4.0});
  EXPECT_NEAR(trial.metrics().at("momentum_change"), 0.8 / 8.0, 1e-15);
  trial.probe("momentum", "y", {-3.0, -3.0, -3.0, -1.0});
  EXPECT_NEAR(trial.metrics().at("momentum_change"), 2.0 / 8.0, 1e-15);
  Trial upwards;
  upwards.probe("kinetic_energy", "", {4.0, 4.0}).probe("momentum", "y", {0.0, -0.4});
  EXPECT_NEAR(upwards.metrics().at("momentum_change"), 0.05, 1e-15);
}

TEST(NonFiniteValues, CountTheWholeFinalStateAndEveryHistory) {
  Trial trial;
  EXPECT_EQ(trial.metrics().at("non_finite_values"), 0.0);
  trial.record.non_finite_values = 2;  // sideways, where the profile does not look
  trial.probe("momentum", "x", {0.3, not_a_number});
  EXPECT_EQ(trial.metrics().at("non_finite_values"), 3.0);
}

TEST(MomentumChange, IsNothingWhereNothingChanges) {
  Trial trial;
  trial.probe("momentum", "x", {0.3, 0.3, 0.3}).probe("kinetic_energy", "", {4.0, 1.0, 0.5});
  EXPECT_EQ(trial.metrics().at("momentum_change"), 0.0);
}

TEST(EnergyLoss, IsWhatTheSumHasLostInTheEnd) {
  Trial trial;
  trial.probe("kinetic_energy", "", {4.0, 1.0, 2.0}).probe("strain_energy", "", {1.0, 4.0, 2.5});
  EXPECT_NEAR(trial.metrics().at("energy_loss"), 0.1, 1e-15);
  EXPECT_NEAR(trial.metrics().at("energy_gain"), 0.0, 1e-15);
}

TEST(EnergyGain, IsWhatTheSumHadMoreAtItsHighest) {
  Trial trial;
  trial.probe("strain_energy", "", {1.0, 4.0, 0.5}).probe("kinetic_energy", "", {4.0, 2.0, 5.0});
  EXPECT_NEAR(trial.metrics().at("energy_gain"), 0.2, 1e-15);
  EXPECT_NEAR(trial.metrics().at("energy_loss"), -0.1, 1e-15);
}

TEST(Conservation, IsNotMeasuredWithoutItsProbes) {
  const auto expect_only = [](const Trial& trial, bool momentum, bool energy) {
    const auto metrics = trial.metrics();
    EXPECT_EQ(metrics.contains("momentum_change"), momentum);
    EXPECT_EQ(metrics.contains("energy_loss"), energy);
    EXPECT_EQ(metrics.contains("energy_gain"), energy);
  };
  Trial none, only_momentum, only_strain, without_strain, without_momentum, both_energies_at_other_times,
      at_rest;
  expect_only(none, false, false);
  expect_only(only_momentum.probe("momentum", "x", {1.0, 1.0}), false, false);
  expect_only(only_strain.probe("strain_energy", "", {1.0, 1.0}), false, false);
  without_strain.probe("momentum", "x", {1.0, 1.0}).probe("kinetic_energy", "", {1.0, 1.0});
  expect_only(without_strain, true, false);
  without_momentum.probe("kinetic_energy", "", {1.0, 1.0}).probe("strain_energy", "", {1.0, 1.0});
  expect_only(without_momentum, false, true);
  both_energies_at_other_times.probe("kinetic_energy", "", {1.0, 1.0})
      .probe("strain_energy", "", {1.0, 1.0, 1.0});
  expect_only(both_energies_at_other_times, false, false);
  at_rest.probe("momentum", "x", {0.0, 1.0})
      .probe("kinetic_energy", "", {0.0, 1.0})
      .probe("strain_energy", "", {1.0, 1.0});
  expect_only(at_rest, false, false);
  without_momentum.record.outcome.ending = Ending::not_finite;
  expect_only(without_momentum, false, false);
}

TEST(Conservation, IsNotMeasuredOfValuesThatAreNotNumbers) {
  for (const std::size_t at : {0u, 1u, 2u}) {
    Values constant(3, 1.0), broken(3, 1.0);
    broken[at] = not_a_number;
    Trial momentum, strain;
    momentum.probe("momentum", "x", broken)
        .probe("momentum", "y", constant)
        .probe("kinetic_energy", "", constant);
    EXPECT_FALSE(momentum.metrics().contains("momentum_change")) << at;
    strain.probe("kinetic_energy", "", constant).probe("strain_energy", "", broken);
    EXPECT_FALSE(strain.metrics().contains("energy_gain")) << at;
  }
}

TEST(Conservation, NeedsNoReference) {
  int found = 0;
  for (const Metric& metric : metric_catalogue()) {
    if (metric.name != "momentum_change" && metric.name != "energy_loss" && metric.name != "energy_gain")
      continue;
    ++found;
    EXPECT_EQ(metric.reference, "") << metric.name;
    EXPECT_EQ(metric.unit, "-") << metric.name;
  }
  EXPECT_EQ(found, 3);
}

// ---- what is measured of every run

TEST(GeneralMetrics, CountWhatIsNoNumberAndKeepItInTheLargestCompression) {
  Trial trial;
  trial.record.profile.initial_volume = {1.0, 2.0, 1.0};
  trial.record.profile.volume = {0.9, 1.5, 1.1};
  EXPECT_NEAR(trial.metrics().at("largest_compression"), 0.25, 1e-15);
  EXPECT_EQ(trial.metrics().at("non_finite_values"), 0.0);
  trial.record.profile.volume[1] = not_a_number;
  EXPECT_FALSE(trial.metrics().contains("largest_compression"));
  EXPECT_EQ(trial.metrics().at("non_finite_values"), 1.0);
}

/// Falls freely; 10 J of potential energy become 1 J of motion, 7 J of work, of which 2 J are stored.
Trial fall() {
  Trial trial;
  trial.probe("potential_energy", "", {0.0, -4.0, -10.0}).probe("kinetic_energy", "", {0.5, 3.0, 1.5});
  trial.probe("stress_work", "", {0.0, 3.0, 7.0}).probe("strain_energy", "", {1.0, 1.0, 3.0});
  return trial;
}

TEST(EnergyBalance, SharesOutWhatGravityHasReleased) {
  const auto metrics = fall().metrics();
  EXPECT_NEAR(metrics.at("energy_balance.kinetic"), 0.1, 1e-15);
  EXPECT_NEAR(metrics.at("energy_balance.numerical_loss"), 0.2, 1e-15);
  EXPECT_NEAR(metrics.at("energy_balance.dissipated"), 0.5, 1e-15);
}

TEST(EnergyBalance, IsNotDrawnUpWhereSomethingElseDoesWork) {
  const std::vector<void (*)(Scene&)> disturbances = {
      [](Scene& scene) { scene.damping = 0.1; },
      [](Scene& scene) { scene.rigid_bodies.emplace_back(); },
      [](Scene& scene) { scene.surface_loads.emplace_back(); },
      [](Scene& scene) { scene.driven_motion.emplace(); },
      [](Scene& scene) { scene.gravity.loading = RampLoading{1.0}; },
      [](Scene& scene) {
        scene.bodies.emplace_back();
        scene.bodies[0].density_ramp = DensityRamp{0.0, {{2.0, 1.0}}};
      }};
  for (const auto& disturb : disturbances) {
    Trial trial = fall();
    disturb(trial.request.scene);
    for (const auto& [name, value] : trial.metrics())
      EXPECT_FALSE(name.starts_with("energy_balance")) << name;
  }
}

TEST(EnergyBalance, SaysWhatItsProbesAllow) {
  Trial trial;
  trial.probe("potential_energy", "", {0.0, -10.0});
  EXPECT_FALSE(trial.metrics().contains("energy_balance.kinetic"));
  trial.probe("kinetic_energy", "", {0.0, 1.0});
  EXPECT_TRUE(trial.metrics().contains("energy_balance.kinetic"));
  EXPECT_FALSE(trial.metrics().contains("energy_balance.numerical_loss"));
  trial.probe("stress_work", "", {0.0, 8.0});
  EXPECT_TRUE(trial.metrics().contains("energy_balance.numerical_loss"));
  EXPECT_FALSE(trial.metrics().contains("energy_balance.dissipated"));
  Trial rising;
  rising.probe("potential_energy", "", {0.0, 1.0}).probe("kinetic_energy", "", {1.0, 0.0});
  EXPECT_FALSE(rising.metrics().contains("energy_balance.kinetic"));
}

}  // namespace
}  // namespace mpm::vv
