#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>

#include "reference/bearing_capacity.hpp"
#include "reference/elastic_strip.hpp"
#include "vv/judging.hpp"

namespace mpm::vv {
namespace {

/// Only the last part of the settlement is judged as the state reached: its share of the whole.
constexpr double judged_share = 0.2;

/// A rigid strip pressed down on the surface of one block of ground.
struct Footing {
  const RigidBody& strip;
  const Body& ground;
  bool half;         ///< only the half at x >= its axis, the grid's lower edge in x, is modelled
  double width;      ///< in the model [m]
  double surcharge;  ///< on the surface beside it [Pa]
  double weight;     ///< unit weight of the ground [N/m^3]

  double full_width() const { return half ? 2 * width : width; }
  reference::Roughness roughness() const {
    return strip.constrains[0] ? reference::Roughness::rough : reference::Roughness::smooth;
  }
};

/// Whether only the half to the right of the axis is modelled.
bool is_half(const Scene& scene) {
  return scene.rigid_bodies.front().lower[0] <= scene.grid_lower[0] && scene.edges[0][0] == Condition::roller;
}

/// Pressure of all loads on the surface of the ground at x [Pa].
double load_at(const Scene& scene, double x) {
  double pressure = 0.0;
  for (const SurfaceLoad& load : scene.surface_loads) {
    if (load.begin <= x && x <= load.end) pressure -= load.traction[1];
  }
  return pressure;
}

/// The middles of the parts into which the ground's surface is cut by the ends of the strip and of all loads
/// [m], from left to right; the last one is beside the strip.
Values parts_of_surface(const Scene& scene) {
  const RigidBody& strip = scene.rigid_bodies.front();
  const Body& ground = scene.bodies.front();
  Values cuts{ground.lower[0], ground.upper[0], strip.lower[0], strip.upper[0]};
  for (const SurfaceLoad& load : scene.surface_loads) cuts.insert(cuts.end(), {load.begin, load.end});
  for (double& x : cuts) x = std::clamp(x, ground.lower[0], ground.upper[0]);
  std::sort(cuts.begin(), cuts.end());
  Values middles;
  for (std::size_t k = 1; k < cuts.size(); ++k) {
    const bool rounding = cuts[k] - cuts[k - 1] < 1e-6 * scene.cell_size;
    if (!rounding) middles.push_back((cuts[k - 1] + cuts[k]) / 2);
  }
  return middles;
}

/// Whether all the surface beside the strip bears one pressure and none the surface below it.
bool is_surcharged_evenly(const Scene& scene) {
  const RigidBody& strip = scene.rigid_bodies.front();
  const Values parts = parts_of_surface(scene);
  const double surcharge = load_at(scene, parts.back());
  return surcharge >= 0.0 && std::all_of(parts.begin(), parts.end(), [&](double x) {
           const bool below = strip.lower[0] < x && x < strip.upper[0];
           return std::abs(load_at(scene, x) - (below ? 0.0 : surcharge)) <= 1e-9 * surcharge;
         });
}

/// Acceleration of gravity downwards in the end [m/s^2].
double final_gravity(const Gravity& gravity) {
  return -gravity.acceleration[1] * gravity.level * gravity.fraction(gravity.settled_after());
}

Footing footing_of(const Scene& scene) {
  const RigidBody& strip = scene.rigid_bodies.front();
  const Body& ground = scene.bodies.front();
  const bool half = is_half(scene);
  const double begin = std::max(strip.lower[0], scene.grid_lower[0]);
  return {strip,
          ground,
          half,
          strip.upper[0] - begin,
          load_at(scene, parts_of_surface(scene).back()),
          ground.density * final_gravity(scene.gravity)};
}

/// What a strip needs for its load curve.
std::string why_no_footing(const Scene& scene) {
  if (scene.dimension != 2) return "two dimensions";
  if (scene.bodies.size() != 1 || scene.bodies.front().ring) return "a single block of ground";
  if (scene.rigid_bodies.size() != 1) return "a single rigid body";
  const RigidBody& strip = scene.rigid_bodies.front();
  if (strip.velocity[0] != 0.0 || !(strip.velocity[1] < 0.0) || strip.angular_velocity != 0.0)
    return "a rigid body that moves downwards only";
  if (!strip.constrains[1]) return "a rigid body that constrains its vertical motion";
  const Body& ground = scene.bodies.front();
  if (std::abs(strip.lower[1] - ground.upper[1]) > 1e-6 * scene.cell_size)
    return "a rigid body that starts on the ground's surface";
  if (ground.lower[1] != scene.grid_lower[1] || scene.edges[1][0] != Condition::fixed)
    return "ground that stands on a fixed y_lower edge";
  if (strip.upper[0] >= ground.upper[0]) return "ground that reaches beyond the strip";
  if (is_half(scene) ? ground.lower[0] != scene.grid_lower[0] : ground.lower[0] >= strip.lower[0])
    return "ground that reaches beyond the strip on its left too, or to a roller at its axis";
  return "";
}

/// What both references need of all else that acts on the ground.
std::string why_not_only_pressed(const Scene& scene) {
  if (scene.driven_motion) return "ground that no motion is imposed on";
  if (scene.bodies.front().density_ramp) return "ground that keeps its mass";
  if ((scene.gravity.acceleration[0] != 0.0 && scene.gravity.level != 0.0) ||
      final_gravity(scene.gravity) < 0.0)
    return "gravity straight downwards, if any";
  for (const SurfaceLoad& load : scene.surface_loads) {
    if (load.axis != 1 || load.side != 1 || load.traction[0] != 0.0)
      return "no surface load but a pressure on the surface";
  }
  if (!is_surcharged_evenly(scene))
    return "one pressure on all the surface beside the strip and none below it, if any";
  return "";
}

std::string why_no_limit_load(const Scene& scene) {
  const Footing footing = footing_of(scene);
  const auto* soil = std::get_if<MohrCoulomb>(&footing.ground.material);
  if (!soil) return "ground of Mohr-Coulomb's law";
  if (footing.weight > 0.0 && (soil->cohesion > 0.0 || footing.surcharge > 0.0))
    return "either weight or strength without weight, since only one term at a time is exact";
  if (soil->friction_angle > 0.0 && soil->cohesion == 0.0 && footing.weight == 0.0 &&
      footing.surcharge == 0.0)
    return "something that gives the ground strength: cohesion, surcharge or weight";
  const double degrees = soil->friction_angle * 180 / std::numbers::pi;
  if (footing.weight > 0.0 && (degrees < 1.0 || degrees > 50.0))
    return "a friction angle from 1 to 50 degrees, where the factor of weight is known";
  return "";
}

std::string why_no_stiffness(const Scene& scene) {
  const Footing footing = footing_of(scene);
  const auto* elastic = std::get_if<LinearElastic>(&footing.ground.material);
  if (!elastic) return "linear elastic ground";
  if (elastic->poissons_ratio > 0.49) return "Poisson's ratio up to 0.49";
  if (footing.ground.initial_stress) return "ground that starts free of stress";
  if (!footing.half) return "a half model, its axis a roller at the grid's lower edge";
  if (scene.edges[0][1] != Condition::roller || footing.ground.upper[0] != scene.grid_upper[0])
    return "ground that reaches to a roller on its far side";
  if (footing.weight != 0.0 || footing.surcharge != 0.0) return "ground without weight or surcharge";
  return "";
}

std::string why_unsuited_to_footings(const std::string& reference, const Scene& scene) {
  std::string missing = why_no_footing(scene);
  if (missing.empty()) missing = why_not_only_pressed(scene);
  if (!missing.empty()) return missing;
  return reference == "limit_analysis" ? why_no_limit_load(scene) : why_no_stiffness(scene);
}

/// The mean pressure at which rigid, perfectly plastic ground with associated flow fails [Pa].
double limit_pressure(const Footing& footing) {
  const auto& soil = std::get<MohrCoulomb>(footing.ground.material);
  const double phi = soil.friction_angle;
  if (footing.weight > 0.0) {
    return footing.weight * footing.full_width() / 2 * reference::exact_ngamma(phi, footing.roughness());
  }
  return soil.cohesion * reference::exact_nc(phi) + footing.surcharge * reference::exact_nq(phi);
}

bool records_load(const HistoryProbe& probe, const RigidBody& strip) {
  return probe.quantity == "reaction" && probe.of == strip.name && probe.component == "y";
}

std::string why_no_load_curve(const std::string&, const Case& definition, const RunRequest& request) {
  const RigidBody& strip = request.scene.rigid_bodies.front();
  const bool recorded = std::any_of(definition.probes.begin(), definition.probes.end(),
                                    [&](const HistoryProbe& probe) { return records_load(probe, strip); });
  return recorded ? "" : "a probe of the reaction of " + strip.name + ", component y";
}

/// Pressure below the strip over its settlement, from the probe that records its reaction.
struct LoadCurve {
  Values settlement;  ///< [m]
  Values pressure;    ///< [Pa]
};

std::optional<LoadCurve> load_curve_of(const Judging& judging, const Footing& footing) {
  for (std::size_t i = 0; i < judging.definition.probes.size(); ++i) {
    if (!records_load(judging.definition.probes[i], footing.strip)) continue;
    const History& history = judging.record.histories.at(i);
    LoadCurve curve;
    // A sample is the mean since the one before: it belongs to the settlement halfway.
    for (std::size_t k = 1; k < history.time.size(); ++k) {
      const double middle = (history.time[k - 1] + history.time[k]) / 2;
      curve.settlement.push_back(-footing.strip.velocity[1] * footing.strip.travel_time(middle));
      curve.pressure.push_back(history.value[k] / footing.width);
    }
    if (!curve.pressure.empty()) return curve;
  }
  return std::nullopt;
}

/// The samples of the last part of the settlement.
Values judged_part(const LoadCurve& curve, const Values& values) {
  Values part;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (curve.settlement[k] >= (1 - judged_share) * curve.settlement.back()) part.push_back(values[k]);
  }
  return part;
}

double mean_of(const Values& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

void judge_by_limit_load(Judging& judging, const Footing& footing, const LoadCurve& curve) {
  const double exact = limit_pressure(footing);
  const Values reached = judged_part(curve, curve.pressure);
  const auto [least, most] = std::minmax_element(reached.begin(), reached.end());
  const double mean = mean_of(reached);
  judging.set("limit_analysis.pressure", mean);
  judging.set("limit_analysis.overshoot", mean / exact - 1);
  judging.set("limit_analysis.shortfall", 1 - mean / exact);
  judging.set(
      "limit_analysis.peak_overshoot",
      std::accumulate(curve.pressure.begin(), curve.pressure.end(), curve.pressure.front(), larger) / exact -
          1);
  judging.set("limit_analysis.spread", (*most - *least) / mean);
  judging.result.curves.push_back(
      {"pressure", "limit_analysis", {0.0, curve.settlement.back()}, {exact, exact}, "settlement"});
}

/// Solved once for each geometry: a sweep over schemes asks for the same stiffness again and again.
reference::SecantStiffness stiffness_of(const reference::ElasticStrip& strip) {
  static std::mutex mutex;
  static std::map<std::tuple<double, double, double, double, double, bool>, reference::SecantStiffness>
      solved;
  const auto key = std::tuple(strip.half_width, strip.layer_depth, strip.side_distance, strip.youngs_modulus,
                              strip.poissons_ratio, strip.roughness == reference::Roughness::rough);
  const std::lock_guard lock(mutex);
  const auto known = solved.find(key);
  if (known != solved.end()) return known->second;
  return solved.emplace(key, reference::secant_stiffness(strip)).first->second;
}

void judge_by_stiffness(Judging& judging, const Footing& footing, const LoadCurve& curve) {
  const auto& elastic = std::get<LinearElastic>(footing.ground.material);
  const Body& ground = footing.ground;
  const reference::SecantStiffness exact =
      stiffness_of({footing.width, ground.upper[1] - ground.lower[1], ground.upper[0] - ground.lower[0],
                    elastic.youngs_modulus, elastic.poissons_ratio, footing.roughness()});
  const double stiffness =
      mean_of(judged_part(curve, curve.pressure)) / mean_of(judged_part(curve, curve.settlement));
  judging.set("elastic_strip.stiffness", std::abs(stiffness / exact.value - 1));
  judging.set("elastic_strip.overshoot", stiffness / exact.value - 1);
  const double deepest = curve.settlement.back();
  judging.result.curves.push_back(
      {"pressure", "elastic_strip", {0.0, deepest}, {0.0, exact.value * deepest}, "settlement"});
}

void judge(Judging& judging) {
  if (!why_no_footing(judging.scene()).empty()) return;
  const Footing footing = footing_of(judging.scene());
  const std::optional<LoadCurve> curve = load_curve_of(judging, footing);
  if (!curve) return;
  judging.result.curves.push_back({"pressure", "run", curve->settlement, curve->pressure, "settlement"});
  if (judging.asks_for("limit_analysis")) judge_by_limit_load(judging, footing, *curve);
  if (judging.asks_for("elastic_strip")) judge_by_stiffness(judging, footing, *curve);
}

std::vector<Metric> catalogue() {
  const std::string last = "over the last fifth of the settlement";
  return {
      {"limit_analysis.pressure", "Pa", "limit_analysis", "mean pressure below the strip " + last},
      {"limit_analysis.overshoot", "-", "limit_analysis",
       "that pressure over the exact limit pressure, minus 1"},
      {"limit_analysis.shortfall", "-", "limit_analysis", "the same the other way round: 1 minus the ratio"},
      {"limit_analysis.peak_overshoot", "-", "limit_analysis",
       "largest pressure over the exact limit pressure, minus 1"},
      {"limit_analysis.spread", "-", "limit_analysis", "range of the pressure over its mean, " + last},
      {"elastic_strip.stiffness", "-", "elastic_strip",
       "relative error of pressure over settlement, both means " + last},
      {"elastic_strip.overshoot", "-", "elastic_strip", "the same with its sign: positive is too stiff"},
  };
}

}  // namespace

NormFamily footing_norms() {
  return {
      {"limit_analysis", "elastic_strip"}, catalogue(), why_unsuited_to_footings, judge, why_no_load_curve};
}

}  // namespace mpm::vv
