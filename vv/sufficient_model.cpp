#include "vv/sufficient_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "vv/json_reader.hpp"

namespace mpm::vv {
namespace {

/// Lengths nearer than this share of a cell are the same: those of a text are rounded.
constexpr double same_length = 1e-9;

/// A place in two dimensions as a column has it.
PerAxis upright(const PerAxis& place) { return {place[1], 0.0}; }

// ---- the column
// ---------------------------------------------------------------------------------------------------------

bool spans(const Scene& scene, double lower, double upper) {
  const double slack = same_length * scene.cell_size;
  return lower <= scene.grid_lower[0] + slack && upper >= scene.grid_upper[0] - slack;
}

std::string why_no_layer(const Scene& scene, const Body& body) {
  const std::string name = "body " + body.name + " ";
  if (!std::holds_alternative<LinearElastic>(body.material))
    return name + "follows a law of which no one-dimensional form is known to give the same stress";
  if (body.ring || !spans(scene, body.lower[0], body.upper[0])) return name + "does not span the grid";
  if (body.velocity[0] != 0.0) return name + "starts with a velocity across";
  if (body.locking_control != LockingControl::none) return name + "asks for locking control";
  if (!body.initial_stress) return "";
  const auto* uniform = std::get_if<UniformStress>(&*body.initial_stress);
  return uniform && uniform->xy != 0.0 ? name + "starts with shear stress" : "";
}

std::string why_no_plate(const Scene& scene, const RigidBody& body) {
  const std::string name = "rigid body " + body.name + " ";
  if (!spans(scene, body.lower[0], body.upper[0])) return name + "is narrower than the grid";
  if (body.velocity[0] != 0.0 || body.angular_velocity != 0.0) return name + "moves across or turns";
  return body.constrains[1] ? "" : name + "leaves the vertical free";
}

std::string why_no_uniform_load(const Scene& scene, const SurfaceLoad& load) {
  const std::string name = "the surface load on " + load.body + " ";
  if (load.axis != 1 || load.traction[0] != 0.0) return name + "does not act along the column";
  return spans(scene, load.begin, load.end) ? "" : name + "does not act on the whole edge";
}

/// What of the scene beside its grid and loads is not alike all the way across.
std::string why_not_uniform(const Scene& scene) {
  for (const Body& body : scene.bodies) {
    if (const std::string reason = why_no_layer(scene, body); !reason.empty()) return reason;
  }
  for (const RigidBody& body : scene.rigid_bodies) {
    if (const std::string reason = why_no_plate(scene, body); !reason.empty()) return reason;
  }
  for (const SurfaceLoad& load : scene.surface_loads) {
    if (const std::string reason = why_no_uniform_load(scene, load); !reason.empty()) return reason;
  }
  return "";
}

/// [Pa]; sideways nothing gives way.
double constrained_modulus(const LinearElastic& law) {
  const double nu = law.poissons_ratio;
  return law.youngs_modulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
}

Body layer_of(Body body) {
  body.lower = upright(body.lower);
  body.upper = upright(body.upper);
  body.velocity = upright(body.velocity);
  body.particles_per_cell = {body.particles_per_cell[1], 1};
  body.material = LinearElastic{constrained_modulus(std::get<LinearElastic>(body.material)), 0.0};
  if (!body.initial_stress) return body;
  if (const auto* uniform = std::get_if<UniformStress>(&*body.initial_stress))
    body.initial_stress = UniformStress{.xx = uniform->yy};
  return body;
}

RigidBody plate_of(RigidBody body) {
  body.lower = upright(body.lower);
  body.upper = upright(body.upper);
  body.velocity = upright(body.velocity);
  body.constrains = {true, true};
  return body;
}

SurfaceLoad load_of(SurfaceLoad load) {
  load.axis = 0;
  load.begin = load.end = 0.0;
  load.traction = upright(load.traction);
  return load;
}

// ---- what a case asks for
// -----------------------------------------------------------------------------------------------

/// Metrics that a column has and that the plane it is cut from has alike.
bool is_of_columns(std::string_view metric) {
  for (const char* family : {"equilibrium.", "hencky.", "oscillation."}) {
    if (metric.starts_with(family)) return true;
  }
  return contains({"settlement", "largest_compression", "unbalanced_force_ratio", "kinetic_energy_ratio",
                   "mass_change", "completed", "steps", "particle_steps", "non_finite_values", "bits_differ"},
                  std::string(metric));
}

/// Every metric that a case judges or shows.
std::vector<std::string> metrics_asked_for(const Case& definition) {
  std::vector<std::string> metrics;
  for (const Gate& gate : definition.gates) metrics.insert(metrics.end(), {gate.metric, gate.over});
  for (const FigureRequest& figure : definition.figures) {
    metrics.insert(metrics.end(), figure.metrics.begin(), figure.metrics.end());
    metrics.push_back(figure.abscissa);
  }
  for (const PairedPrediction& pairs : definition.pairs) metrics.push_back(pairs.metric);
  for (const TradeRequest& trade : definition.trades) metrics.push_back(trade.metric);
  std::erase(metrics, "");
  return metrics;
}

/// The curves that a case can ask for by name are those of footings, of collapses and of cuts.
bool asks_for_curves(const Case& definition) {
  const auto names_one = [](const auto& each) { return !each.curve.empty(); };
  return !definition.readings.empty() || !definition.measurements.empty() ||
         std::any_of(definition.gates.begin(), definition.gates.end(), names_one) ||
         std::any_of(definition.trades.begin(), definition.trades.end(), names_one);
}

bool is_across(const HistoryProbe& probe) {
  return !probe.component.empty() && probe.component != "y" && probe.component != "yy";
}

/// Whether a case wants to know what the runs as written cost.
bool asks_for_cost(const Case& definition) {
  const auto metrics = metrics_asked_for(definition);
  return !definition.trades.empty() || contains(metrics, "particle_steps") || contains(metrics, "steps");
}

// ---- the choice
// ---------------------------------------------------------------------------------------------------------

double particles_of(const Scene& scene) {
  double all = 0.0;
  for (const Body& body : scene.bodies) {
    double particles = 1.0;
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimension); ++axis) {
      particles *=
          std::round((body.upper[axis] - body.lower[axis]) / scene.cell_size * body.particles_per_cell[axis]);
    }
    all += particles;
  }
  return all;
}

/// Why the scene stays in two dimensions; empty if it need not.
std::string why_two_dimensions(const Case& definition, const RunRequest& request) {
  const std::optional<Decision> decision = request.model_request.dimension;
  if (decision == Decision::as_written) return "the scene says as_written";
  if (!decision && asks_for_cost(definition))
    return "the case asks for the cost of what is written, and the scene does not say automatic";
  if (const std::string reason = why_no_column(request.scene); !reason.empty())
    return "not a column: " + reason;
  if (const std::string reason = why_in_the_plane(definition); !reason.empty())
    return "a column, but the case asks for " + reason;
  return "";
}

void choose_dimension(const Case& definition, RunRequest& request) {
  const Scene& scene = request.scene;
  if (scene.dimension == 1) return;  // there is no less
  ModelChoice choice{
      .what = "dimension", .written = "2D", .used = "2D", .reason = why_two_dimensions(definition, request)};
  if (!choice.reason.empty()) {
    request.model.push_back(std::move(choice));
    return;
  }
  Scene column = column_of(scene);
  choice.used = "1D";
  choice.reason =
      "every body reaches from roller to roller and nothing differs across: the only strain is the vertical "
      "one, and one dimension with the constrained modulus E(1 - nu)/((1 + nu)(1 - 2 nu)) of each body has "
      "the same vertical stress";
  choice.numbers = {{"particles_written", particles_of(scene)}, {"particles_used", particles_of(column)}};
  request.width = scene.grid_upper[0] - scene.grid_lower[0];
  request.scene = std::move(column);
  request.model.push_back(std::move(choice));
}

}  // namespace

std::string why_no_column(const Scene& scene) {
  if (scene.dimension != 2) return "it has one dimension already";
  if (scene.edges[0] != std::array{Condition::roller, Condition::roller}) return "no rollers on both sides";
  if (scene.gravity.acceleration[0] != 0.0) return "gravity does not act along it";
  if (scene.driven_motion) return "its motion is driven";
  const auto* moved = std::get_if<AtDisplacement>(&scene.termination);
  if (moved && moved->axis != 1) return "it ends by a displacement across";
  return why_not_uniform(scene);
}

Scene column_of(const Scene& strip) {
  Scene column = strip;
  column.dimension = 1;
  column.objectivity = Objectivity::none;  // a column does not turn
  column.grid_lower = upright(strip.grid_lower);
  column.grid_upper = upright(strip.grid_upper);
  column.edges = {strip.edges[1], {}};
  column.gravity.acceleration = upright(strip.gravity.acceleration);
  std::transform(strip.bodies.begin(), strip.bodies.end(), column.bodies.begin(), layer_of);
  std::transform(strip.rigid_bodies.begin(), strip.rigid_bodies.end(), column.rigid_bodies.begin(), plate_of);
  std::transform(strip.surface_loads.begin(), strip.surface_loads.end(), column.surface_loads.begin(),
                 load_of);
  if (auto* moved = std::get_if<AtDisplacement>(&column.termination)) moved->axis = 0;
  return column;
}

std::string why_in_the_plane(const Case& definition) {
  if (!definition.snapshots.empty()) return "snapshots, which are of the plane";
  if (!definition.metamorphoses.empty()) return "other descriptions of the plane";
  if (asks_for_curves(definition)) return "a curve that a column does not have";
  for (const HistoryProbe& probe : definition.probes) {
    if (is_across(probe)) return "component " + probe.component + " in the probe " + probe.id;
  }
  for (const FigureRequest& figure : definition.figures) {
    if (contains({"fields", "model", "curves", "comparison"}, figure.kind))
      return "the figure " + figure.id + ", which is of the plane";
  }
  for (const std::string& metric : metrics_asked_for(definition)) {
    if (!is_of_columns(metric)) return "the metric " + metric + ", which a column does not have alike";
  }
  return "";
}

void choose_model(const Case& definition, RunRequest& request) {
  if (request.element) return;
  choose_dimension(definition, request);
}

SimulatedProbe simulated(const HistoryProbe& probe, const RunRequest& request) {
  SimulatedProbe seen{probe};
  if (!request.width) return seen;
  seen.probe.at = upright(probe.at);
  if (!probe.component.empty()) seen.probe.component = probe.quantity == "stress" ? "xx" : "x";
  // Of quantities that have an extent a column has one metre's.
  const bool is_local = contains({"displacement", "velocity", "stress"}, probe.quantity);
  if (!is_local) seen.factor = *request.width;
  return seen;
}

}  // namespace mpm::vv
