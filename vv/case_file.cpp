#include "vv/case_file.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "solver/error.hpp"
#include "vv/case_schema.hpp"
#include "vv/json_reader.hpp"
#include "vv/norms.hpp"

namespace mpm::vv {
namespace {

// ---- scene
// ------------------------------------------------------------------------------------------------------

std::size_t axes_of(const Scene& scene) { return static_cast<std::size_t>(scene.dimension); }

/// The entries of an array with one entry per dimension.
std::vector<JsonPlace> axis_elements(const JsonPlace& place, std::size_t axes) {
  const std::vector<JsonPlace> elements = place.elements();
  if (elements.size() != axes)
    place.refuse("an array of " + std::to_string(axes) + ", one value per dimension");
  return elements;
}

PerAxis read_per_axis(const JsonPlace& place, std::size_t axes, QuantityKind kind) {
  PerAxis values{};
  const std::vector<JsonPlace> elements = axis_elements(place, axes);
  for (std::size_t axis = 0; axis < axes; ++axis) values[axis] = elements[axis].quantity(kind);
  return values;
}

int read_dimension(const JsonPlace& place) {
  const int dimension = place.integer();
  if (dimension < 1 || dimension > max_dimension) place.refuse("1 or 2");
  return dimension;
}

void read_edges(const JsonPlace& place, Scene& scene) {
  constexpr const char* names[max_dimension][2] = {{"x_lower", "x_upper"}, {"y_lower", "y_upper"}};
  std::vector<std::string> keys;
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis)
    keys.insert(keys.end(), {names[axis][0], names[axis][1]});
  place.allow_only(keys);
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    for (const std::size_t side : {0u, 1u}) {
      scene.edges[axis][side] = place[names[axis][side]].choice<Condition>(
          {{"free", Condition::free}, {"roller", Condition::roller}, {"fixed", Condition::fixed}});
    }
  }
}

void read_grid(const JsonPlace& place, Scene& scene) {
  place.allow_only({"cell_size", "lower", "upper", "edges"});
  scene.cell_size = place["cell_size"].quantity(QuantityKind::length);
  scene.grid_lower = read_per_axis(place["lower"], axes_of(scene), QuantityKind::length);
  scene.grid_upper = read_per_axis(place["upper"], axes_of(scene), QuantityKind::length);
  read_edges(place["edges"], scene);
}

enum class Law { linear_elastic, zhang_elastic, mohr_coulomb };

/// [rad]
double read_angle(const JsonPlace& place) {
  return place.quantity(QuantityKind::angle) * std::numbers::pi / 180;
}

MohrCoulomb read_mohr_coulomb(const JsonPlace& place) {
  place.allow_only(
      {"law", "youngs_modulus", "poissons_ratio", "friction_angle", "cohesion", "dilation_angle"});
  return {place["youngs_modulus"].quantity(QuantityKind::pressure), place["poissons_ratio"].number(),
          read_angle(place["friction_angle"]), place["cohesion"].quantity(QuantityKind::pressure),
          read_angle(place["dilation_angle"])};
}

Material read_material(const JsonPlace& place) {
  const Law law = place["law"].choice<Law>({{"linear_elastic", Law::linear_elastic},
                                            {"zhang_elastic", Law::zhang_elastic},
                                            {"mohr_coulomb", Law::mohr_coulomb}});
  switch (law) {
    case Law::linear_elastic:
      place.allow_only({"law", "youngs_modulus", "poissons_ratio"});
      return LinearElastic{place["youngs_modulus"].quantity(QuantityKind::pressure),
                           place["poissons_ratio"].number()};
    case Law::mohr_coulomb:
      return read_mohr_coulomb(place);
    case Law::zhang_elastic:
      break;
  }
  place.allow_only({"law", "youngs_modulus"});
  return ZhangElastic{place["youngs_modulus"].quantity(QuantityKind::pressure)};
}

Body read_body(const JsonPlace& place, std::size_t axes) {
  place.allow_only({"name", "lower", "upper", "particles_per_cell", "density", "velocity", "material"});
  Body body;
  body.name = place["name"].identifier();
  body.lower = read_per_axis(place["lower"], axes, QuantityKind::length);
  body.upper = read_per_axis(place["upper"], axes, QuantityKind::length);
  const std::vector<JsonPlace> per_cell = axis_elements(place["particles_per_cell"], axes);
  for (std::size_t axis = 0; axis < axes; ++axis) body.particles_per_cell[axis] = per_cell[axis].integer();
  body.density = place["density"].quantity(QuantityKind::density);
  if (const JsonPlace velocity = place["velocity"]; velocity.present()) {
    body.velocity = read_per_axis(velocity, axes, QuantityKind::velocity);
  }
  body.material = read_material(place["material"]);
  return body;
}

enum class LoadingType { step, ramp, staged };

std::variant<StepLoading, RampLoading, StagedLoading> read_loading(const JsonPlace& place) {
  const LoadingType type = place["type"].choice<LoadingType>(
      {{"step", LoadingType::step}, {"ramp", LoadingType::ramp}, {"staged", LoadingType::staged}});
  switch (type) {
    case LoadingType::step:
      place.allow_only({"type"});
      return StepLoading{};
    case LoadingType::ramp:
      place.allow_only({"type", "duration"});
      return RampLoading{place["duration"].quantity(QuantityKind::time)};
    case LoadingType::staged:
      break;
  }
  place.allow_only({"type", "hold", "fractions"});
  StagedLoading staged{place["hold"].quantity(QuantityKind::time), {}};
  for (const JsonPlace& fraction : place["fractions"].some_elements())
    staged.fractions.push_back(fraction.number());
  return staged;
}

Gravity read_gravity(const JsonPlace& place, std::size_t axes) {
  place.allow_only({"acceleration", "level", "loading"});
  Gravity gravity;
  gravity.acceleration = read_per_axis(place["acceleration"], axes, QuantityKind::acceleration);
  gravity.level = place["level"].number();
  gravity.loading = read_loading(place["loading"]);
  return gravity;
}

std::variant<GivenTimeStep, StableFraction> read_time_step(const JsonPlace& place) {
  place.allow_only({"stable_fraction", "seconds"});
  const JsonPlace fraction = place["stable_fraction"], seconds = place["seconds"];
  const std::string expected = "either stable_fraction or seconds";
  if (fraction.present() && seconds.present()) throw Refusal(place.pointer(), expected, "both");
  if (fraction.present()) return StableFraction{fraction.number()};
  if (seconds.present()) return GivenTimeStep{seconds.quantity(QuantityKind::time)};
  throw Refusal(place.pointer(), expected, "neither");
}

enum class TerminationType { at_time, at_rest };

std::variant<AtTime, AtRest> read_termination(const JsonPlace& place) {
  const TerminationType type = place["type"].choice<TerminationType>(
      {{"at_time", TerminationType::at_time}, {"at_rest", TerminationType::at_rest}});
  if (type == TerminationType::at_time) {
    place.allow_only({"type", "time"});
    return AtTime{place["time"].quantity(QuantityKind::time)};
  }
  place.allow_only({"type", "unbalanced_force_ratio", "kinetic_energy_ratio", "deadline"});
  return AtRest{place["unbalanced_force_ratio"].number(), place["kinetic_energy_ratio"].number(),
                place["deadline"].quantity(QuantityKind::time)};
}

/// The scene as written: types, keys and units are right, but the values may be impossible.
Scene read_scene(const JsonPlace& place) {
  place.allow_only({"dimension", "scheme", "update_order", "precision", "objectivity", "flip_fraction",
                    "damping", "grid", "bodies", "gravity", "time_step", "termination"});
  Scene scene;
  scene.dimension = read_dimension(place["dimension"]);
  scene.scheme = place["scheme"].choice<Scheme>(
      {{"mpm", Scheme::mpm}, {"ugimp", Scheme::ugimp}, {"cpgimp", Scheme::cpgimp}});
  if (const JsonPlace order = place["update_order"]; order.present()) {
    scene.update_order = order.choice<UpdateOrder>(
        {{"musl", UpdateOrder::musl}, {"usf", UpdateOrder::usf}, {"usl", UpdateOrder::usl}});
  }
  if (const JsonPlace precision = place["precision"]; precision.present()) {
    scene.precision =
        precision.choice<Precision>({{"double", Precision::float64}, {"float", Precision::float32}});
  }
  if (const JsonPlace objectivity = place["objectivity"]; objectivity.present()) {
    scene.objectivity =
        objectivity.choice<Objectivity>({{"none", Objectivity::none}, {"jaumann", Objectivity::jaumann}});
  }
  if (const JsonPlace flip = place["flip_fraction"]; flip.present()) scene.flip_fraction = flip.number();
  if (const JsonPlace damping = place["damping"]; damping.present()) scene.damping = damping.number();
  read_grid(place["grid"], scene);
  for (const JsonPlace& body : place["bodies"].some_elements()) {
    scene.bodies.push_back(read_body(body, axes_of(scene)));
  }
  scene.gravity = read_gravity(place["gravity"], axes_of(scene));
  scene.time_step = read_time_step(place["time_step"]);
  scene.termination = read_termination(place["termination"]);
  return scene;
}

const std::string scene_pointer = "/scene";

/// The scene that can start. Throws Refusal with a pointer below /scene.
Scene checked_scene(const JsonPlace& place) {
  Scene scene = read_scene(place);
  try {
    check(scene);
  } catch (const SceneError& error) {
    throw Refusal(scene_pointer + error.place(), error.expected(), error.found());
  }
  return scene;
}

Scene checked_scene(const Json& scene_text) { return checked_scene(JsonPlace(&scene_text, scene_pointer)); }

// ---- sweep
// ------------------------------------------------------------------------------------------------------

/// Which value each axis of the sweep takes in a run.
using Choice = std::vector<std::size_t>;

/// More runs than this would be a slip, and would take days to simulate.
constexpr double most_runs = 1e5;

/// Whether `pointer` is `parent` itself or lies below it.
bool at_or_below(const std::string& pointer, const std::string& parent) {
  return pointer.starts_with(parent) && (pointer.size() == parent.size() || pointer[parent.size()] == '/');
}

/// A JSON pointer to something in the scene as written, relative to the scene.
Json::json_pointer below_scene(const std::string& parameter) {
  return Json::json_pointer(parameter.substr(scene_pointer.size()));
}

bool names_scene_value(const std::string& parameter, const Json& scene_text) {
  if (!parameter.starts_with(scene_pointer + "/")) return false;
  try {
    return scene_text.contains(below_scene(parameter));
  } catch (const Json::exception&) {  // not a JSON pointer
    return false;
  }
}

std::string read_parameter(const JsonPlace& place, const Json& scene_text,
                           const std::vector<SweepAxis>& earlier) {
  const std::string parameter = place.text();
  if (!names_scene_value(parameter, scene_text)) {
    place.refuse("a JSON pointer to a value the scene has, such as \"/scene/scheme\"");
  }
  for (const SweepAxis& axis : earlier) {
    if (at_or_below(parameter, axis.parameter) || at_or_below(axis.parameter, parameter)) {
      place.refuse("a parameter that no other axis changes", ", which " + axis.parameter + " changes too");
    }
  }
  return parameter;
}

std::vector<Json> read_distinct_values(const JsonPlace& place) {
  std::vector<Json> values;
  for (const JsonPlace& value : place.some_elements()) {
    if (std::find(values.begin(), values.end(), value.value()) != values.end()) {
      value.refuse("each value once", " again");
    }
    values.push_back(value.value());
  }
  return values;
}

std::vector<SweepAxis> read_sweep(const JsonPlace& place, const Json& scene_text) {
  std::vector<SweepAxis> sweep;
  if (!place.present()) return sweep;
  double runs = 1.0;
  for (const JsonPlace& axis : place.some_elements()) {
    axis.allow_only({"parameter", "values"});
    std::string parameter = read_parameter(axis["parameter"], scene_text, sweep);
    sweep.push_back({std::move(parameter), read_distinct_values(axis["values"])});
    runs *= static_cast<double>(sweep.back().values.size());
    if (runs > most_runs) place.refuse("at most 100000 runs");
  }
  return sweep;
}

const Json& chosen_value(const std::vector<SweepAxis>& sweep, const Choice& choice, std::size_t axis) {
  return sweep[axis].values[choice[axis]];
}

std::string chosen_pointer(const Choice& choice, std::size_t axis) {
  return "/sweep/" + std::to_string(axis) + "/values/" + std::to_string(choice[axis]);
}

/// The first axis whose value makes the scene impossible even without the other axes; if none does alone, the
/// last.
std::size_t culprit(const Json& scene_text, const std::vector<SweepAxis>& sweep, const Choice& choice) {
  for (std::size_t axis = 0; axis < sweep.size(); ++axis) {
    Json changed = scene_text;
    changed.at(below_scene(sweep[axis].parameter)) = chosen_value(sweep, choice, axis);
    try {
      checked_scene(changed);
    } catch (const Refusal&) {
      return axis;
    }
  }
  return sweep.size() - 1;
}

/// Says which swept value is to blame for what is wrong with the scene of a run.
[[noreturn]] void refuse_run(const Refusal& refusal, const Json& scene_text,
                             const std::vector<SweepAxis>& sweep, const Choice& choice) {
  for (std::size_t axis = 0; axis < sweep.size(); ++axis) {
    const std::string& parameter = sweep[axis].parameter;
    if (!at_or_below(refusal.pointer(), parameter)) continue;
    throw Refusal(chosen_pointer(choice, axis) + refusal.pointer().substr(parameter.size()),
                  refusal.expected(), refusal.found());
  }
  const std::size_t axis = culprit(scene_text, sweep, choice);
  throw Refusal(chosen_pointer(choice, axis),
                "a value with which " + refusal.pointer() + " is " + refusal.expected(),
                describe(chosen_value(sweep, choice, axis)) + ", which makes it " + refusal.found());
}

RunRequest read_run(const Json& scene_text, const std::vector<SweepAxis>& sweep, const Choice& choice) {
  RunRequest run;
  run.scene_text = scene_text;
  for (std::size_t axis = 0; axis < sweep.size(); ++axis) {
    const Json& value = chosen_value(sweep, choice, axis);
    run.parameters.emplace_back(sweep[axis].parameter, value);
    run.scene_text.at(below_scene(sweep[axis].parameter)) = value;
  }
  try {
    run.scene = checked_scene(run.scene_text);
  } catch (const Refusal& refusal) {
    refuse_run(refusal, scene_text, sweep, choice);
  }
  return run;
}

/// Moves on to the next combination, the last axis fastest; false after the last one.
bool advance(Choice& choice, const std::vector<SweepAxis>& sweep) {
  for (std::size_t axis = sweep.size(); axis-- > 0;) {
    if (++choice[axis] < sweep[axis].values.size()) return true;
    choice[axis] = 0;
  }
  return false;
}

std::vector<RunRequest> expand(const Json& scene_text, const std::vector<SweepAxis>& sweep) {
  std::vector<RunRequest> runs;
  Choice choice(sweep.size(), 0);
  do {
    runs.push_back(read_run(scene_text, sweep, choice));
  } while (advance(choice, sweep));
  return runs;
}

// ---- names of what the case already has
// -------------------------------------------------------------------------

const SweepAxis* find_axis(const std::vector<SweepAxis>& sweep, const std::string& parameter) {
  const auto axis =
      std::find_if(sweep.begin(), sweep.end(), [&](const SweepAxis& a) { return a.parameter == parameter; });
  return axis == sweep.end() ? nullptr : &*axis;
}

std::string swept_names(const std::vector<SweepAxis>& sweep) {
  if (sweep.empty()) return "a swept parameter, of which this case has none";
  std::vector<std::string> names;
  for (const SweepAxis& axis : sweep) names.push_back(axis.parameter);
  return "a swept parameter (" + listed(names) + ")";
}

const SweepAxis& read_axis(const JsonPlace& place, const std::vector<SweepAxis>& sweep) {
  const SweepAxis* axis = place.present() ? find_axis(sweep, place.text()) : nullptr;
  if (!axis) place.refuse(swept_names(sweep));
  return *axis;
}

Selector read_selector(const std::string& parameter, const JsonPlace& place,
                       const std::vector<SweepAxis>& sweep) {
  const SweepAxis* axis = find_axis(sweep, parameter);
  if (!axis) throw Refusal(place.pointer(), swept_names(sweep), "\"" + parameter + "\"");
  for (const JsonPlace& value : place.some_elements()) {
    if (std::find(axis->values.begin(), axis->values.end(), value.value()) == axis->values.end()) {
      std::vector<std::string> swept;
      for (const Json& candidate : axis->values) swept.push_back(describe(candidate));
      value.refuse("a value this parameter is swept over (" + listed(swept) + ")");
    }
  }
  return {parameter, read_distinct_values(place)};
}

std::vector<Selector> read_where(const JsonPlace& place, const std::vector<SweepAxis>& sweep) {
  std::vector<Selector> where;
  if (!place.present()) return where;
  for (const auto& [parameter, values] : place.members())
    where.push_back(read_selector(parameter, values, sweep));
  return where;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string read_metric(const JsonPlace& place, const Case& read) {
  std::vector<std::string> names;
  for (const Metric& metric : metric_catalogue()) names.push_back(metric.name);
  const std::string name = place.one_of(names);
  const Metric& metric = *std::find_if(metric_catalogue().begin(), metric_catalogue().end(),
                                       [&](const Metric& m) { return m.name == name; });
  if (!metric.reference.empty() && !contains(read.references, metric.reference)) {
    place.refuse("a metric whose reference solution is among the case's references (" +
                     (read.references.empty() ? "none" : listed(read.references)) + ")",
                 ", which needs " + metric.reference);
  }
  if (name == "bits_differ" && !read.repeat_on_other_threads) {
    place.refuse("a metric that the case measures", ", which needs repeat_on_other_threads to be true");
  }
  return name;
}

std::vector<std::string> read_metrics(const JsonPlace& place, const Case& read) {
  std::vector<std::string> metrics;
  for (const JsonPlace& metric : place.some_elements()) metrics.push_back(read_metric(metric, read));
  return metrics;
}

/// Distinct names out of `allowed`; the array may be empty.
std::vector<std::string> read_names(const JsonPlace& place, const std::vector<std::string>& allowed) {
  std::vector<std::string> names;
  for (const JsonPlace& element : place.elements()) {
    const std::string name = element.one_of(allowed);
    if (contains(names, name)) element.refuse("each name once", " again");
    names.push_back(name);
  }
  return names;
}

/// A name that no earlier entry of its array has.
template <class Entry>
std::string read_id(const JsonPlace& place, const std::vector<Entry>& earlier) {
  const std::string id = place.identifier();
  if (std::any_of(earlier.begin(), earlier.end(), [&](const Entry& entry) { return entry.id == id; })) {
    place.refuse("an id of its own", ", which an earlier entry has");
  }
  return id;
}

// ---- probes
// -----------------------------------------------------------------------------------------------------

/// Whether a particle lies within one particle spacing of `at` along every axis, which is to say that `at`
/// lies in a body or at most half a spacing outside it.
bool hits(const Body& body, const Scene& scene, const PerAxis& at) {
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    const double spacing = scene.cell_size / body.particles_per_cell[axis];
    // Of a spacing; lets a place exactly on the limit count whichever way its last bit was rounded.
    const double reach = (0.5 + 1e-9) * spacing;
    if (at[axis] < body.lower[axis] - reach || at[axis] > body.upper[axis] + reach) return false;
  }
  return true;
}

/// The swept values of a run, for messages; empty for the only run of a case without a sweep.
std::string name_of(const RunRequest& run) {
  std::vector<std::string> values;
  for (const auto& [parameter, value] : run.parameters) values.push_back(parameter + " = " + describe(value));
  return listed(values);
}

void require_hit(const JsonPlace& place, const RunRequest& run, const PerAxis& at) {
  const std::vector<Body>& bodies = run.scene.bodies;
  if (std::any_of(bodies.begin(), bodies.end(), [&](const Body& b) { return hits(b, run.scene, at); }))
    return;
  std::vector<std::string> lengths;
  for (const JsonPlace& length : place.elements()) lengths.push_back(describe(length.value()));
  const std::string where = run.parameters.empty() ? "" : " in the run with " + name_of(run);
  throw Refusal(place.pointer(), "a place within one particle spacing of a particle",
                listed(lengths) + ", which hits none" + where);
}

HistoryProbe read_probe(const JsonPlace& place, const Case& read) {
  place.allow_only({"id", "quantity", "at", "every"});
  HistoryProbe probe;
  probe.id = read_id(place["id"], read.probes);
  probe.quantity = place["quantity"].one_of({"displacement", "velocity", "stress"});
  probe.every = place["every"].quantity(QuantityKind::time);
  if (probe.every <= 0.0) place["every"].refuse("a time above zero");
  for (const RunRequest& run : read.runs) {
    probe.at = read_per_axis(place["at"], axes_of(run.scene), QuantityKind::length);
    require_hit(place["at"], run, probe.at);
  }
  return probe;
}

// ---- gates
// ------------------------------------------------------------------------------------------------------

void read_threshold(const JsonPlace& place, Gate& gate) {
  const JsonPlace at_most = place["at_most"], at_least = place["at_least"];
  const std::string expected = "either at_most or at_least";
  if (at_most.present() && at_least.present()) throw Refusal(place.pointer(), expected, "both");
  if (!at_most.present() && !at_least.present()) throw Refusal(place.pointer(), expected, "neither");
  gate.comparison = at_most.present() ? Comparison::at_most : Comparison::at_least;
  gate.threshold = (at_most.present() ? at_most : at_least).number();
}

/// The values an axis takes among the runs that `where` selects, in the order of the sweep.
std::vector<Json> selected_values(const SweepAxis& axis, const std::vector<Selector>& where) {
  std::vector<Json> values = axis.values;
  for (const Selector& selector : where) {
    if (selector.parameter != axis.parameter) continue;
    std::erase_if(values, [&](const Json& value) {
      return std::find(selector.values.begin(), selector.values.end(), value) == selector.values.end();
    });
  }
  return values;
}

/// Observed orders are taken in the cell size, so it must fall from each level to the next.
void require_refinement(const JsonPlace& place, const SweepAxis& axis, const std::vector<Json>& values,
                        Json scene_text) {
  double coarser = std::numeric_limits<double>::infinity();
  for (const Json& value : values) {
    scene_text.at(below_scene(axis.parameter)) = value;
    const double cell_size = read_scene(JsonPlace(&scene_text, scene_pointer)).cell_size;
    if (!(cell_size < coarser)) {
      place.refuse("a parameter that makes the cell size smaller from each value to the next");
    }
    coarser = cell_size;
  }
}

void read_across(const JsonPlace& place, const Case& read, Gate& gate) {
  if (gate.statistic == Statistic::value) {
    if (place.present()) place.refuse("no key \"across\" with the statistic \"value\"");
    return;
  }
  const SweepAxis& axis = read_axis(place, read.sweep);
  const std::vector<Json> values = selected_values(axis, gate.where);
  // One pair gives an order but nothing to tell that it has settled.
  const std::size_t fewest = gate.statistic == Statistic::last_order ? 3 : 2;
  if (values.size() < fewest) {
    place.refuse("a parameter with at least " + std::to_string(fewest) + " selected values",
                 ", which has " + std::to_string(values.size()));
  }
  if (gate.statistic == Statistic::last_order) require_refinement(place, axis, values, read.text.at("scene"));
  gate.across = axis.parameter;
}

Gate read_gate(const JsonPlace& place, const Case& read) {
  place.allow_only({"id", "metric", "statistic", "across", "where", "at_most", "at_least", "basis", "reason",
                    "must_fail"});
  Gate gate;
  gate.id = read_id(place["id"], read.gates);
  gate.metric = read_metric(place["metric"], read);
  if (const JsonPlace statistic = place["statistic"]; statistic.present()) {
    gate.statistic = statistic.choice<Statistic>({{"value", Statistic::value},
                                                  {"reduction", Statistic::reduction},
                                                  {"worst_ratio", Statistic::worst_ratio},
                                                  {"last_order", Statistic::last_order}});
  }
  gate.where = read_where(place["where"], read.sweep);
  read_across(place["across"], read, gate);
  read_threshold(place, gate);
  gate.basis = place["basis"].one_of({"theory", "requirement", "fit", "reference_uncertainty"});
  gate.reason = place["reason"].text();
  if (const JsonPlace must_fail = place["must_fail"]; must_fail.present()) gate.must_fail = must_fail.flag();
  return gate;
}

// ---- figures
// ----------------------------------------------------------------------------------------------------

/// The keys a figure of each kind may have beside those that every figure may have.
std::vector<std::string> figure_keys(const std::string& kind) {
  std::vector<std::string> keys = {"id", "kind", "caption", "panels", "series", "where"};
  if (kind == "profiles") keys.insert(keys.end(), {"quantity", "references"});
  if (kind == "convergence") keys.insert(keys.end(), {"over", "metrics"});
  if (kind == "bars") keys.push_back("metrics");
  if (kind == "history") keys.push_back("quantity");
  return keys;
}

std::string read_probe_name(const JsonPlace& place, const std::vector<HistoryProbe>& probes) {
  std::vector<std::string> ids;
  for (const HistoryProbe& probe : probes) ids.push_back(probe.id);
  if (ids.empty()) place.refuse("the id of a probe, of which this case has none");
  return place.one_of(ids);
}

/// What a figure separates by: each parameter at most once.
void read_layout(const JsonPlace& place, const Case& read, FigureRequest& figure) {
  std::vector<std::string> used;
  const auto read_role = [&](const char* key) -> std::string {
    const JsonPlace role = place[key];
    const std::string parameter = read_axis(role, read.sweep).parameter;
    if (contains(used, parameter)) role.refuse("a parameter without another role in the figure");
    used.push_back(parameter);
    return parameter;
  };
  if (figure.kind == "convergence") figure.over = read_role("over");
  if (place["panels"].present()) figure.panels = read_role("panels");
  if (place["series"].present()) figure.series = read_role("series");
}

FigureRequest read_figure(const JsonPlace& place, const Case& read) {
  FigureRequest figure;
  figure.kind = place["kind"].one_of({"profiles", "convergence", "bars", "history"});
  place.allow_only(figure_keys(figure.kind));
  figure.id = read_id(place["id"], read.figures);
  figure.caption = place["caption"].text();
  read_layout(place, read, figure);
  if (figure.kind == "profiles") {
    figure.quantity = place["quantity"].one_of({"stress", "displacement", "stress_error"});
    if (place["references"].present()) figure.references = read_names(place["references"], read.references);
  } else if (figure.kind == "history") {
    figure.quantity = read_probe_name(place["quantity"], read.probes);
  } else {
    figure.metrics = read_metrics(place["metrics"], read);
  }
  figure.where = read_where(place["where"], read.sweep);
  return figure;
}

// ---- case
// -------------------------------------------------------------------------------------------------------

std::vector<std::string> read_texts(const JsonPlace& place) {
  std::vector<std::string> texts;
  if (!place.present()) return texts;
  for (const JsonPlace& element : place.elements()) texts.push_back(element.text());
  return texts;
}

std::string optional_text(const JsonPlace& place) { return place.present() ? place.text() : ""; }

Claim read_claim(const JsonPlace& place, const Case& read) {
  place.allow_only({"claim", "finding", "gates", "remark"});
  Claim claim;
  claim.text = place["claim"].text();
  claim.finding = place["finding"].choice<Finding>(
      {{"seen", Finding::seen}, {"not_seen", Finding::not_seen}, {"depends", Finding::depends}});
  std::vector<std::string> known;
  for (const Gate& gate : read.gates) known.push_back(gate.id);
  for (const JsonPlace& gate : place["gates"].some_elements()) claim.gates.push_back(gate.one_of(known));
  claim.remark = optional_text(place["remark"]);
  if (claim.finding != Finding::seen && claim.remark.empty()) {
    place["remark"].refuse("a remark that says why the claim is not simply seen");
  }
  return claim;
}

bool optional_flag(const JsonPlace& place, bool otherwise) {
  return place.present() ? place.flag() : otherwise;
}

void read_description(const JsonPlace& place, Case& read) {
  read.id = place["id"].identifier();
  read.title = place["title"].text();
  read.description = place["description"].text();
  read.figure_of_paper = optional_text(place["figure_of_paper"]);
  read.notes = read_texts(place["notes"]);
  read.quick = optional_flag(place["quick"], true);
  read.repeat_on_other_threads = optional_flag(place["repeat_on_other_threads"], false);
  read.references = read_names(place["references"], reference_catalogue());
}

/// A run that a reference solution does not describe would be judged by nonsense.
void require_suited(const JsonPlace& place, const Case& read) {
  for (const JsonPlace& name : place.elements()) {
    for (const RunRequest& run : read.runs) {
      const std::string missing = why_unsuited(name.text(), run.scene);
      if (missing.empty()) continue;
      name.refuse("a reference solution that describes the scene; it needs " + missing,
                  run.parameters.empty() ? "" : " for the run with " + name_of(run));
    }
  }
}

/// Reads `read.text` into the rest of `read`, top to bottom: each part refers only to those before it.
void read_parts(Case& read) {
  const JsonPlace place(&read.text, "");
  place.allow_only({"$schema", "id", "title", "figure_of_paper", "description", "claims", "notes", "quick",
                    "repeat_on_other_threads", "scene", "sweep", "references", "probes", "gates", "figures"});
  optional_text(place["$schema"]);
  read_description(place, read);
  checked_scene(place["scene"]);
  const Json& scene_text = place["scene"].value();
  read.sweep = read_sweep(place["sweep"], scene_text);
  read.runs = expand(scene_text, read.sweep);
  require_suited(place["references"], read);
  if (const JsonPlace probes = place["probes"]; probes.present()) {
    for (const JsonPlace& probe : probes.elements()) read.probes.push_back(read_probe(probe, read));
  }
  for (const JsonPlace& gate : place["gates"].some_elements()) read.gates.push_back(read_gate(gate, read));
  if (const JsonPlace claims = place["claims"]; claims.present()) {
    for (const JsonPlace& claim : claims.elements()) read.claims.push_back(read_claim(claim, read));
  }
  if (const JsonPlace figures = place["figures"]; figures.present()) {
    for (const JsonPlace& figure : figures.elements()) read.figures.push_back(read_figure(figure, read));
  }
}

/// The second, independent net: what the published schema refuses is refused, whatever the reader above
/// thinks.
void require_schema(const Json& text) {
  const std::optional<SchemaViolation> violation = schema_violation(text);
  if (!violation) return;
  throw Refusal(violation->pointer, "what case.schema.json allows", violation->description);
}

/// Keys and texts of the file can hold line breaks; a message cannot.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, '?');
  return text;
}

}  // namespace

Case parse_case(const std::string& text, const std::filesystem::path& file) {
  try {
    Case read;
    read.file = file;
    read.text = parse_json(text);
    read_parts(read);
    require_schema(read.text);
    return read;
  } catch (const Refusal& refusal) {
    throw CaseError(file.string(), one_line(refusal.pointer()), one_line(refusal.expected()),
                    one_line(refusal.found()));
  }
}

Case read_case(const std::filesystem::path& file) {
  std::error_code error;
  std::ifstream stream;
  if (std::filesystem::is_regular_file(file, error)) stream.open(file, std::ios::binary);
  if (!stream.is_open()) {
    const bool exists = std::filesystem::exists(file, error);
    throw CaseError(file.string(), "", "a readable case file",
                    exists ? "something that cannot be read" : "no file");
  }
  return parse_case(std::string(std::istreambuf_iterator<char>(stream), {}), file);
}

}  // namespace mpm::vv
