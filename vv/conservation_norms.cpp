#include <algorithm>
#include <cmath>
#include <numeric>

#include "vv/judging.hpp"

namespace mpm::vv {
namespace {

/// Largest change of the total momentum over sqrt(2 M E), the momentum of all mass moving with the initial
/// kinetic energy; the total itself may be zero.
void judge_momentum(Judging& judging, double kinetic_energy) {
  const Values& mass = judging.record.profile.mass;
  const double scale = std::sqrt(2 * std::accumulate(mass.begin(), mass.end(), 0.0) * kinetic_energy);
  double largest = -1.0;
  for (const char* component : {"x", "y"}) {
    const History* momentum = history_of(judging, "momentum", component);
    if (!momentum) continue;
    for (const double value : momentum->value) {
      largest = larger(largest, std::abs(value - momentum->value.front()));
    }
  }
  if (!(largest < 0.0)) judging.set("momentum_change", largest / scale);
}

void judge_energy(Judging& judging, const History& kinetic) {
  const History* strain = history_of(judging, "strain_energy");
  if (!strain || strain->time != kinetic.time) return;
  const double start = kinetic.value.front() + strain->value.front();
  double most = 0.0;
  for (std::size_t k = 0; k < kinetic.value.size(); ++k) {
    most = larger(most, kinetic.value[k] + strain->value[k]);
  }
  judging.set("energy_loss", 1 - (kinetic.value.back() + strain->value.back()) / start);
  judging.set("energy_gain", most / start - 1);
}

/// Whether nothing but steady gravity does work on the bodies, and nothing but their stresses and the
/// numerics takes energy from them.
bool falls_freely(const Scene& scene) {
  const auto grows = [](const Body& body) { return body.density_ramp.has_value(); };
  return scene.rigid_bodies.empty() && scene.surface_loads.empty() && !scene.driven_motion &&
         scene.damping == 0.0 && std::holds_alternative<StepLoading>(scene.gravity.loading) &&
         std::none_of(scene.bodies.begin(), scene.bodies.end(), grows);
}

/// Where the potential energy has gone by the end: released = motion + work of the stresses + loss, and work
/// of the stresses = stored + dissipated.
void judge_balance(Judging& judging) {
  if (!falls_freely(judging.scene())) return;
  const History* potential = history_of(judging, "potential_energy");
  const History* kinetic = history_of(judging, "kinetic_energy");
  if (!potential || !kinetic) return;
  const auto gained = [](const History& history) { return history.value.back() - history.value.front(); };
  const double released = -gained(*potential);
  if (!(released > 0.0)) return;
  judging.set("energy_balance.kinetic", gained(*kinetic) / released);
  const History* work = history_of(judging, "stress_work");
  if (!work) return;
  judging.set("energy_balance.numerical_loss", (released - gained(*kinetic) - gained(*work)) / released);
  const History* strain = history_of(judging, "strain_energy");
  if (strain) judging.set("energy_balance.dissipated", (gained(*work) - gained(*strain)) / released);
}

void judge(Judging& judging) {
  judge_balance(judging);
  const History* kinetic = history_of(judging, "kinetic_energy");
  if (!kinetic || !(kinetic->value.front() > 0.0)) return;
  judge_momentum(judging, kinetic->value.front());
  judge_energy(judging, *kinetic);
}

std::string never(const std::string&, const Scene&) { return ""; }

std::vector<Metric> catalogue() {
  return {
      {"momentum_change", "-", "",
       "largest change of the momentum over sqrt(2 mass * initial kinetic energy); needs probes of both"},
      {"energy_loss", "-", "",
       "kinetic and strain energy lost from start to end, over their sum at the start; needs probes of both"},
      {"energy_gain", "-", "", "largest sum of both energies over that at the start, minus 1"},
      {"energy_balance.kinetic", "-", "",
       "kinetic energy gained over the potential energy released, at the end; needs probes of both"},
      {"energy_balance.numerical_loss", "-", "",
       "potential energy released that is neither kinetic nor work of the stresses, over all of it; needs "
       "probes of the three"},
      {"energy_balance.dissipated", "-", "",
       "work of the stresses that is not stored as strain energy, over the potential energy released; needs "
       "probes of all four"},
  };
}

}  // namespace

NormFamily conservation_norms() { return {{}, catalogue(), never, judge}; }

}  // namespace mpm::vv
