#include "vv/load_curve.hpp"

#include <algorithm>
#include <cmath>

#include "vv/judging.hpp"

namespace mpm::vv {
namespace {

// ---- the footing

double tolerance(const Scene& scene) { return 1e-6 * scene.cell_size; }

/// The body whose density changes, which is the one that loads the other.
const Body* block_of(const Scene& scene) {
  for (const Body& body : scene.bodies) {
    if (body.density_ramp) return &body;
  }
  return nullptr;
}

const RigidBody* strip_of(const Scene& scene) {
  for (const RigidBody& body : scene.rigid_bodies) {
    if (body.constrains[1]) return &body;
  }
  return nullptr;
}

bool is_pressed_by_block(const Scene& scene) {
  return scene.rigid_bodies.empty() && scene.bodies.size() == 2;
}

const Body& ground_of(const Scene& scene) {
  const bool second = is_pressed_by_block(scene) && scene.bodies.front().density_ramp;
  return second ? scene.bodies.back() : scene.bodies.front();
}

/// Whether only the half to the right of the axis is modelled.
bool is_half(const Scene& scene, const PerAxis& lower) {
  return lower[0] <= scene.grid_lower[0] && scene.edges[0][0] == Condition::roller;
}

/// Whether a rigid body does no more than guide the soil along the sides of a strip's shaft.
bool is_shaft_of(const RigidBody& strip, const RigidBody& body, double rounding) {
  const bool moves_along = body.velocity == strip.velocity && body.angular_velocity == 0.0 &&
                           body.start == strip.start && body.ramp == strip.ramp;
  return !body.constrains[1] && moves_along && body.lower[1] > strip.lower[1] + rounding &&
         body.lower[0] >= strip.lower[0] - rounding && body.upper[0] <= strip.upper[0] + rounding;
}

std::string why_no_strip(const Scene& scene) {
  if (scene.bodies.size() != 1 || scene.bodies.front().ring) return "a single block of ground";
  if (scene.rigid_bodies.empty()) return "a rigid body, or a block whose density changes, on the ground";
  const RigidBody* strip = strip_of(scene);
  if (!strip) return "a rigid body that constrains its vertical motion";
  if (strip->velocity[0] != 0.0 || !(strip->velocity[1] < 0.0) || strip->angular_velocity != 0.0)
    return "a rigid body that moves downwards only";
  for (const RigidBody& body : scene.rigid_bodies) {
    if (&body != strip && !is_shaft_of(*strip, body, tolerance(scene)))
      return "no rigid body beside the one that presses but such as constrain x only, move with it and stay "
             "above its base, within its width";
  }
  return "";
}

std::string why_no_block(const Scene& scene) {
  if (scene.bodies.front().density_ramp.has_value() == scene.bodies.back().density_ramp.has_value())
    return "one block of ground and one on it whose density changes";
  const Body& block = *block_of(scene);
  if (block.ring || ground_of(scene).ring) return "blocks without a ring";
  if (!(final_gravity(scene.gravity) > 0.0)) return "gravity that lets the block press on the ground";
  for (const SurfaceLoad& load : scene.surface_loads) {
    if (load.body == block.name) return "no surface load on the block that presses";
  }
  return "";
}

std::string why_not_placed(const Scene& scene, const PerAxis& lower, const PerAxis& upper) {
  const Body& ground = ground_of(scene);
  const std::string presser = is_pressed_by_block(scene) ? "block" : "rigid body";
  if (std::abs(lower[1] - ground.upper[1]) > tolerance(scene))
    return "a " + presser + " that starts on the ground's surface";
  if (ground.lower[1] != scene.grid_lower[1] || scene.edges[1][0] == Condition::free)
    return "ground that stands on a fixed or roller y_lower edge";
  if (upper[0] >= ground.upper[0]) return "ground that reaches beyond the footing";
  if (is_half(scene, lower) ? ground.lower[0] != scene.grid_lower[0] : ground.lower[0] >= lower[0])
    return "ground that reaches beyond the footing on its left too, or to a roller at its axis";
  return "";
}

/// Pressure of all loads on the surface of the ground at x [Pa].
double load_at(const Scene& scene, double x) {
  double pressure = 0.0;
  for (const SurfaceLoad& load : scene.surface_loads) {
    if (load.begin <= x && x <= load.end) pressure -= load.traction[1];
  }
  return pressure;
}

/// The middles of the parts into which the ground's surface is cut by the ends of the footing and of all
/// loads [m], from left to right; the last one is beside the footing.
Values parts_of_surface(const Scene& scene, const PerAxis& lower, const PerAxis& upper) {
  const Body& ground = ground_of(scene);
  Values cuts{ground.lower[0], ground.upper[0], lower[0], upper[0]};
  for (const SurfaceLoad& load : scene.surface_loads) cuts.insert(cuts.end(), {load.begin, load.end});
  for (double& x : cuts) x = std::clamp(x, ground.lower[0], ground.upper[0]);
  std::sort(cuts.begin(), cuts.end());
  Values middles;
  for (std::size_t k = 1; k < cuts.size(); ++k) {
    if (cuts[k] - cuts[k - 1] >= tolerance(scene)) middles.push_back((cuts[k - 1] + cuts[k]) / 2);
  }
  return middles;
}

/// Whether all the surface beside the footing bears one pressure and none the surface below it.
bool is_surcharged_evenly(const Scene& scene, const Footing& footing) {
  const Values parts = parts_of_surface(scene, footing.lower, footing.upper);
  return footing.surcharge >= 0.0 && std::all_of(parts.begin(), parts.end(), [&](double x) {
           const bool below = footing.lower[0] < x && x < footing.upper[0];
           return std::abs(load_at(scene, x) - (below ? 0.0 : footing.surcharge)) <= 1e-9 * footing.surcharge;
         });
}

// ---- its load curve

/// Whether a probe records a quantity along the vertical; a load is the weight of a body, the reaction of a
/// rigid one.
bool records(const HistoryProbe& probe, const std::string& quantity) {
  if (probe.quantity == "load") return quantity == "weight" || quantity == "reaction";
  return probe.quantity == quantity && (quantity == "weight" || probe.component == "y");
}

/// The history of a case's first probe of a quantity of a body, vertical if it has a direction.
template <class Each>
const Each* recorded(const std::vector<HistoryProbe>& probes, const std::vector<Each>& of_probes,
                     const std::string& quantity, const std::string& name) {
  for (std::size_t i = 0; i < probes.size() && i < of_probes.size(); ++i) {
    if (probes[i].of == name && records(probes[i], quantity)) return &of_probes[i];
  }
  return nullptr;
}

bool records(const Case& definition, const std::string& quantity, const std::string& name) {
  return recorded(definition.probes, definition.probes, quantity, name) != nullptr;
}

/// A history's value at a time within it, linear between the samples.
double value_at(const History& history, double time) {
  const auto next = std::lower_bound(history.time.begin(), history.time.end(), time);
  const auto k = static_cast<std::size_t>(next - history.time.begin());
  if (k == 0 || k == history.time.size()) return k == 0 ? history.value.front() : history.value.back();
  const double share = (time - history.time[k - 1]) / (history.time[k] - history.time[k - 1]);
  return (1 - share) * history.value[k - 1] + share * history.value[k];
}

LoadCurve curve_of_strip(const Footing& footing, const History& reaction) {
  LoadCurve curve;
  for (std::size_t k = 1; k < reaction.time.size(); ++k) {
    const double middle = (reaction.time[k - 1] + reaction.time[k]) / 2;
    curve.settlement.push_back(-footing.strip->velocity[1] * footing.strip->travel_time(middle));
    curve.pressure.push_back(reaction.value[k] / footing.width);
  }
  return curve;
}

LoadCurve curve_of_block(const Footing& footing, const History& weight, const History& displacement) {
  LoadCurve curve;
  if (weight.time.empty() || displacement.time.empty()) return curve;
  const double start =
      std::max({footing.block->density_ramp->start, weight.time.front(), displacement.time.front()});
  const double end = std::min(weight.time.back(), displacement.time.back());
  Values times{start};
  for (const double time : displacement.time) {
    if (start < time && time <= end) times.push_back(time);
  }
  if (start > end) return curve;
  for (const double time : times) {
    curve.settlement.push_back(value_at(displacement, start) - value_at(displacement, time));
    curve.pressure.push_back(value_at(weight, time) / footing.width);
  }
  return curve;
}

/// Leaves out what comes after the first sample that is no number.
void cut_at_breakdown(LoadCurve& curve) {
  std::size_t sound = 0;
  while (sound < curve.pressure.size() && std::isfinite(curve.settlement[sound]) &&
         std::isfinite(curve.pressure[sound]))
    ++sound;
  curve.settlement.resize(sound);
  curve.pressure.resize(sound);
}

LoadCurve measured_curve(const Case& definition, const Footing& footing, const Record& record) {
  const auto history_of = [&](const char* quantity, const std::string& name) {
    return recorded(definition.probes, record.histories, quantity, name);
  };
  if (footing.strip) {
    const History* reaction = history_of("reaction", footing.strip->name);
    return reaction ? curve_of_strip(footing, *reaction) : LoadCurve{};
  }
  const History* weight = history_of("weight", footing.block->name);
  const History* displacement = history_of("displacement", footing.block->name);
  return weight && displacement ? curve_of_block(footing, *weight, *displacement) : LoadCurve{};
}

}  // namespace

double final_gravity(const Gravity& gravity) {
  return -gravity.acceleration[1] * gravity.level * gravity.fraction(gravity.settled_after());
}

std::string why_no_footing(const Scene& scene) {
  if (scene.dimension != 2) return "two dimensions";
  const bool by_block = is_pressed_by_block(scene);
  const std::string missing = by_block ? why_no_block(scene) : why_no_strip(scene);
  if (!missing.empty()) return missing;
  if (by_block) return why_not_placed(scene, block_of(scene)->lower, block_of(scene)->upper);
  return why_not_placed(scene, strip_of(scene)->lower, strip_of(scene)->upper);
}

Footing footing_of(const Scene& scene) {
  Footing footing{};
  footing.ground = &ground_of(scene);
  footing.strip = strip_of(scene);
  if (!footing.strip) footing.block = block_of(scene);
  footing.lower = footing.strip ? footing.strip->lower : footing.block->lower;
  footing.upper = footing.strip ? footing.strip->upper : footing.block->upper;
  footing.half = is_half(scene, footing.lower);
  footing.width = footing.upper[0] - std::max(footing.lower[0], scene.grid_lower[0]);
  footing.surcharge = load_at(scene, parts_of_surface(scene, footing.lower, footing.upper).back());
  footing.weight = footing.ground->density * final_gravity(scene.gravity);
  return footing;
}

std::string why_not_only_pressed(const Scene& scene) {
  const Footing footing = footing_of(scene);
  if (scene.driven_motion) return "ground that no motion is imposed on";
  if (footing.ground->density_ramp) return "ground that keeps its mass";
  if ((scene.gravity.acceleration[0] != 0.0 && scene.gravity.level != 0.0) ||
      final_gravity(scene.gravity) < 0.0)
    return "gravity straight downwards, if any";
  for (const SurfaceLoad& load : scene.surface_loads) {
    if (load.axis != 1 || load.side != 1 || load.traction[0] != 0.0)
      return "no surface load but a pressure on the surface";
  }
  if (!is_surcharged_evenly(scene, footing))
    return "one pressure on all the surface beside the footing and none below it, if any";
  return "";
}

std::string why_no_load_curve(const Case& definition, const Scene& scene) {
  const Footing footing = footing_of(scene);
  if (footing.strip) {
    const std::string& name = footing.strip->name;
    return records(definition, "reaction", name)
               ? ""
               : "a probe of the load or the reaction of " + name + ", component y";
  }
  const std::string& name = footing.block->name;
  if (!records(definition, "weight", name)) return "a probe of the load or the weight of " + name;
  return records(definition, "displacement", name)
             ? ""
             : "a probe of the displacement of " + name + ", component y";
}

std::optional<LoadCurve> load_curve_of(const Case& definition, const Scene& scene, const Record& record) {
  LoadCurve curve = measured_curve(definition, footing_of(scene), record);
  if (!record.completed()) cut_at_breakdown(curve);
  if (curve.pressure.empty()) return std::nullopt;
  return curve;
}

LoadCurve advancing_part(const LoadCurve& curve) {
  LoadCurve part;
  for (std::size_t k = 0; k < curve.settlement.size(); ++k) {
    const double settlement = curve.settlement[k], pressure = curve.pressure[k];
    if (!part.settlement.empty() && !(settlement > part.settlement.back())) {
      const bool at_rest = part.settlement.size() == 1 && settlement == part.settlement.front();
      if (at_rest) part.pressure.front() = pressure;
      continue;
    }
    part.settlement.push_back(settlement);
    part.pressure.push_back(pressure);
  }
  return part;
}

LoadCurve evenly_spaced(const LoadCurve& curve, int points) {
  const LoadCurve part = advancing_part(curve);
  const double first = part.settlement.front(), last = part.settlement.back();
  LoadCurve even;
  std::size_t next = 1;
  for (int i = 0; i < points; ++i) {
    const double share = i / static_cast<double>(points - 1);
    const double settlement = (1 - share) * first + share * last;
    while (next + 1 < part.settlement.size() && part.settlement[next] < settlement) ++next;
    const double from = part.settlement[next - 1], to = part.settlement[next];
    const double beyond = (settlement - from) / (to - from);
    even.settlement.push_back(settlement);
    even.pressure.push_back((1 - beyond) * part.pressure[next - 1] + beyond * part.pressure[next]);
  }
  return even;
}

}  // namespace mpm::vv
