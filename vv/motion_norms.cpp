#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "reference/manufactured.hpp"
#include "solver/tensor.hpp"
#include "vv/judging.hpp"

namespace mpm::vv {
namespace {

/// The state of all particles at the end, if the case keeps it.
const Snapshot* end_of(const Record& record) {
  const auto found = std::find_if(record.snapshots.begin(), record.snapshots.end(),
                                  [](const Snapshot& snapshot) { return snapshot.moment == "end"; });
  return found == record.snapshots.end() ? nullptr : &*found;
}

std::string why_no_end(const std::string&, const Case& definition, const RunRequest&) {
  const bool kept =
      std::any_of(definition.snapshots.begin(), definition.snapshots.end(),
                  [](const SnapshotRequest& request) { return request.when == SnapshotRequest::When::end; });
  return kept ? "" : "a snapshot of the end, {\"end\": true}";
}

/// Values and weights of every component of a field, particle by particle.
Values repeated(const Values& of_particles, std::size_t components) {
  Values all;
  all.reserve(of_particles.size() * components);
  for (const double value : of_particles) all.insert(all.end(), components, value);
  return all;
}

/// Which way a scene's motion is known.
enum class Course { manufactured, free_fall, rotation, none };

Course course_of(const std::string& reference) {
  if (reference == "manufactured") return Course::manufactured;
  if (reference == "free_fall") return Course::free_fall;
  return reference == "rotation" ? Course::rotation : Course::none;
}

bool is_free(const Scene& scene) {
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimension); ++axis) {
    for (const Condition edge : scene.edges[axis]) {
      if (edge != Condition::free) return false;
    }
  }
  return scene.rigid_bodies.empty() && scene.surface_loads.empty() && !scene.driven_motion;
}

std::string why_no_free_fall(const Scene& scene) {
  if (!is_free(scene)) return "free edges and no load but gravity";
  if (!std::holds_alternative<StepLoading>(scene.gravity.loading))
    return "gravity that acts in full from the start";
  if (scene.damping != 0.0) return "no damping";
  for (const Body& body : scene.bodies) {
    if (body.velocity != scene.bodies.front().velocity) return "one velocity for all bodies";
    if (body.initial_stress || body.density_ramp)
      return "bodies that start free of stress and keep their mass";
  }
  return "";
}

std::string why_no_rotation(const Scene& scene) {
  if (scene.dimension != 2) return "two dimensions";
  if (scene.rigid_bodies.size() != 1 || scene.rigid_bodies.front().angular_velocity == 0.0)
    return "one rigid body that turns";
  const RigidBody& all = scene.rigid_bodies.front();
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (!all.constrains[axis]) return "a rigid body that constrains both components";
    if (all.lower[axis] > scene.grid_lower[axis] || all.upper[axis] < scene.grid_upper[axis])
      return "a rigid body that holds the whole grid";
    if (all.velocity[axis] != 0.0) return "a rigid body that only turns";
  }
  for (const Body& body : scene.bodies) {
    if (!body.initial_stress || !std::holds_alternative<UniformStress>(*body.initial_stress))
      return "bodies with a uniform initial stress";
  }
  return "";
}

std::string why_unsuited_to_motions(const std::string& reference, const Scene& scene) {
  switch (course_of(reference)) {
    case Course::manufactured:
      return scene.driven_motion ? "" : "a driven motion";
    case Course::free_fall:
      return why_no_free_fall(scene);
    default:
      return why_no_rotation(scene);
  }
}

/// Displacement and stress of every particle against the solution at its initial place.
void judge_by_manufactured(Judging& judging, const Snapshot& end) {
  const ParticleFields& fields = end.fields;
  const auto axes = static_cast<std::size_t>(fields.dimension);
  Values displacement, stress;
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    reference::Place place{};
    for (std::size_t a = 0; a < axes; ++a) place[a] = fields.initial_position[p * axes + a];
    const reference::Place moved = judging.request.motion->displacement(place, end.time);
    displacement.insert(displacement.end(), moved.begin(), moved.begin() + static_cast<std::ptrdiff_t>(axes));
    const reference::CauchyStress exact = judging.request.motion->stress(place, end.time);
    stress.push_back(exact.xx);
    if (axes == 2) stress.insert(stress.end(), {exact.yy, exact.zz, exact.xy});
  }
  set_norms(judging, "manufactured.displacement",
            relative_norms(fields.displacement, displacement, repeated(fields.initial_volume, axes)));
  set_norms(judging, "manufactured.stress",
            relative_norms(fields.stress, stress,
                           repeated(fields.initial_volume, fields.stress.size() / fields.mass.size())));
  if (axes == 1) {
    // The run's own curve is among a column's, as of every scene in one dimension, over the same heights.
    Values height = fields.initial_position;
    for (double& x : height) x -= judging.scene().grid_lower[0];
    judging.result.curves.push_back(
        {"displacement", "manufactured", height, displacement, "initial_position"});
  }
}

/// x - X = v t + g t (t + dt) / 2: the explicit step moves with the velocity of its end.
void judge_by_free_fall(Judging& judging, const Snapshot& end) {
  const ParticleFields& fields = end.fields;
  const auto axes = static_cast<std::size_t>(fields.dimension);
  const Scene& scene = judging.scene();
  const double t = end.time, dt = judging.record.time_step;
  double error = 0.0, largest = 0.0, stress = 0.0;
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    for (std::size_t a = 0; a < axes; ++a) {
      const double exact = scene.bodies.front().velocity[a] * t +
                           scene.gravity.acceleration[a] * scene.gravity.level * t * (t + dt) / 2;
      error = larger(error, std::abs(fields.displacement[p * axes + a] - exact));
      largest = larger(largest, std::abs(exact));
    }
  }
  for (const double component : fields.stress) stress = larger(stress, std::abs(component));
  judging.set("free_fall.displacement", error / largest);
  const double modulus =
      std::visit([](const auto& law) { return law.youngs_modulus; }, scene.bodies.front().material);
  judging.set("free_fall.stress", stress / modulus);
}

/// Stress turned by the angle of the body that holds everything.
void judge_by_rotation(Judging& judging, const Snapshot& end) {
  const ParticleFields& fields = end.fields;
  const Scene& scene = judging.scene();
  const RigidBody& all = scene.rigid_bodies.front();
  const double angle = all.angular_velocity * all.travel_time(end.time);
  double error = 0.0, largest = 0.0;
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    const auto& start = std::get<UniformStress>(*scene.bodies[fields.body[p]].initial_stress);
    const SymmetricTensor<2, double> exact =
        rotated(SymmetricTensor<2, double>{start.xx, start.yy, start.zz, start.xy}, angle);
    for (std::size_t c = 0; c < exact.size(); ++c) {
      error = larger(error, std::abs(fields.stress[p * exact.size() + c] - exact[c]));
      largest = larger(largest, std::abs(exact[c]));
    }
  }
  judging.set("rotation.stress", error / largest);
}

// ---- vibration

/// How well a sinusoid of one angular frequency fits a history, and its amplitude.
struct Fit {
  double residual, amplitude;
};

Fit fit_sinusoid(const Values& time, const Values& value, double angular_frequency) {
  double ss = 0, sc = 0, cc = 0, sy = 0, cy = 0;
  for (std::size_t k = 0; k < time.size(); ++k) {
    const double s = std::sin(angular_frequency * time[k]), c = std::cos(angular_frequency * time[k]);
    ss += s * s;
    sc += s * c;
    cc += c * c;
    sy += s * value[k];
    cy += c * value[k];
  }
  const double determinant = ss * cc - sc * sc;
  const double a = (sy * cc - cy * sc) / determinant, b = (cy * ss - sy * sc) / determinant;
  double residual = 0.0;
  for (std::size_t k = 0; k < time.size(); ++k) {
    const double fitted =
        a * std::sin(angular_frequency * time[k]) + b * std::cos(angular_frequency * time[k]);
    residual += (value[k] - fitted) * (value[k] - fitted);
  }
  return {residual, std::hypot(a, b)};
}

/// Angular frequency of the best fit within a tenth of the expected one [rad/s]: by golden section around the
/// best of a scan. Over many periods the residual has minima beside the least one, one over the number of
/// periods apart; the scan looks eight times as closely. Not a number if nothing can be fitted.
double fitted_frequency(const Values& time, const Values& value, double expected) {
  const double periods = expected * (time.back() - time.front()) / (2 * std::numbers::pi);
  const int parts = static_cast<int>(std::ceil(std::max(1.0, 8 * 0.2 * periods)));
  const double spacing = 0.2 * expected / parts;
  double best = expected, least = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= parts; ++k) {
    const double frequency = 0.9 * expected + k * spacing;
    const double residual = fit_sinusoid(time, value, frequency).residual;
    if (!(residual < least)) continue;
    best = frequency;
    least = residual;
  }
  if (std::isinf(least)) return std::numeric_limits<double>::quiet_NaN();
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double lower = std::max(best - spacing, 0.9 * expected), upper = std::min(best + spacing, 1.1 * expected);
  for (int k = 0; k < 60; ++k) {
    const double a = upper - golden * (upper - lower), b = lower + golden * (upper - lower);
    if (fit_sinusoid(time, value, a).residual < fit_sinusoid(time, value, b).residual) {
      upper = b;
    } else {
      lower = a;
    }
  }
  return (lower + upper) / 2;
}

/// Frequency and amplitude of the first displacement probe on a particle against the exact mode's.
void judge_vibration(Judging& judging) {
  for (std::size_t i = 0; i < judging.definition.probes.size(); ++i) {
    const HistoryProbe& probe = judging.definition.probes[i];
    if (probe.quantity != "displacement" || probe.target != ProbeTarget::particle) continue;
    const History& history = judging.record.histories.at(i);
    const double expected = 2 * std::numbers::pi / judging.request.motion->period();
    const double found = fitted_frequency(history.time, history.value, expected);
    // The probe follows the particle nearest to where it was asked for.
    const Snapshot* end = end_of(judging.record);
    if (!end) return;
    double nearest = end->fields.initial_position.front();
    for (const double x : end->fields.initial_position) {
      if (std::abs(x - probe.at[0]) < std::abs(nearest - probe.at[0])) nearest = x;
    }
    const double amplitude =
        judging.request.motion->displacement({nearest, 0.0}, judging.request.motion->period() / 4)[0];
    judging.set("bar.frequency", std::abs(found / expected - 1));
    judging.set(
        "bar.amplitude",
        std::abs(fit_sinusoid(history.time, history.value, found).amplitude / std::abs(amplitude) - 1));
    Values exact;
    for (const double t : history.time) {
      exact.push_back(judging.request.motion->displacement({nearest, 0.0}, t)[0]);
    }
    judging.result.curves.push_back({history.id, "manufactured", history.time, exact, "time"});
    return;
  }
}

void judge(Judging& judging) {
  if (judging.asks_for("manufactured") && judging.scene().dimension == 1) judge_vibration(judging);
  const Snapshot* end = end_of(judging.record);
  if (!end) return;
  if (judging.asks_for("manufactured")) judge_by_manufactured(judging, *end);
  if (judging.asks_for("free_fall")) judge_by_free_fall(judging, *end);
  if (judging.asks_for("rotation")) judge_by_rotation(judging, *end);
}

std::vector<Metric> catalogue() {
  std::vector<Metric> all;
  add_norms(all, "manufactured.displacement", "manufactured",
            "error of the displacement at the end against the exact motion");
  add_norms(all, "manufactured.stress", "manufactured",
            "error of all stress components at the end against the exact motion");
  all.push_back({"bar.frequency", "-", "manufactured",
                 "relative error of the frequency of the sinusoid that best fits the displacement probe"});
  all.push_back({"bar.amplitude", "-", "manufactured", "relative error of that sinusoid's amplitude"});
  all.push_back({"free_fall.displacement", "-", "free_fall",
                 "largest error of the displacement over the largest displacement"});
  all.push_back({"free_fall.stress", "-", "free_fall", "largest stress over Young's modulus, exactly none"});
  all.push_back({"rotation.stress", "-", "rotation",
                 "largest error of the stress against the initial one turned, over the largest component"});
  return all;
}

}  // namespace

NormFamily motion_norms() {
  return {{"manufactured", "free_fall", "rotation"}, catalogue(), why_unsuited_to_motions, judge, why_no_end};
}

}  // namespace mpm::vv
