#include <algorithm>
#include <cmath>
#include <numeric>

#include "vv/judging.hpp"

namespace mpm::vv {
namespace {

/// The history of the first probe of a quantity, and component if one is named; null without such a probe.
const History* history_of(const Judging& judging, const std::string& quantity,
                          const std::string& component = "") {
  for (std::size_t i = 0; i < judging.definition.probes.size(); ++i) {
    const HistoryProbe& probe = judging.definition.probes[i];
    if (probe.quantity == quantity && (component.empty() || probe.component == component)) {
      return &judging.record.histories.at(i);
    }
  }
  return nullptr;
}

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

void judge(Judging& judging) {
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
  };
}

}  // namespace

NormFamily conservation_norms() { return {{}, catalogue(), never, judge}; }

}  // namespace mpm::vv
