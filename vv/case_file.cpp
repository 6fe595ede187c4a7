#include "vv/case_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "reference/manufactured.hpp"
#include "solver/error.hpp"
#include "vv/case_schema.hpp"
#include "vv/field_map.hpp"
#include "vv/json_reader.hpp"
#include "vv/metamorphic.hpp"
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

double optional_quantity(const JsonPlace& place, QuantityKind kind, double otherwise = 0.0) {
  return place.present() ? place.quantity(kind) : otherwise;
}

bool optional_flag(const JsonPlace& place, bool otherwise) {
  return place.present() ? place.flag() : otherwise;
}

/// `all` in two dimensions, of which `one` are left in one.
std::vector<std::string> keys_of(std::size_t axes, std::vector<std::string> one,
                                 const std::vector<std::string>& more_in_two) {
  if (axes == 2) one.insert(one.end(), more_in_two.begin(), more_in_two.end());
  return one;
}

int read_dimension(const JsonPlace& place) {
  const int dimension = place.integer();
  if (dimension < 1 || dimension > max_dimension) place.refuse("1 or 2");
  return dimension;
}

/// [axis][0 lower, 1 upper]
constexpr const char* edge_names[max_dimension][2] = {{"x_lower", "x_upper"}, {"y_lower", "y_upper"}};

void read_edges(const JsonPlace& place, Scene& scene) {
  place.allow_only(keys_of(axes_of(scene), {"x_lower", "x_upper"}, {"y_lower", "y_upper"}));
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    for (const std::size_t side : {0u, 1u}) {
      scene.edges[axis][side] = place[edge_names[axis][side]].choice<Condition>(
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

enum class Law { linear_elastic, zhang_elastic, mohr_coulomb, neo_hookean };

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
                                            {"mohr_coulomb", Law::mohr_coulomb},
                                            {"neo_hookean", Law::neo_hookean}});
  switch (law) {
    case Law::linear_elastic:
      place.allow_only({"law", "youngs_modulus", "poissons_ratio"});
      return LinearElastic{place["youngs_modulus"].quantity(QuantityKind::pressure),
                           place["poissons_ratio"].number()};
    case Law::neo_hookean:
      place.allow_only({"law", "youngs_modulus", "poissons_ratio"});
      return NeoHookean{place["youngs_modulus"].quantity(QuantityKind::pressure),
                        place["poissons_ratio"].number()};
    case Law::mohr_coulomb:
      return read_mohr_coulomb(place);
    case Law::zhang_elastic:
      break;
  }
  place.allow_only({"law", "youngs_modulus"});
  return ZhangElastic{place["youngs_modulus"].quantity(QuantityKind::pressure)};
}

Ring read_ring(const JsonPlace& place, std::size_t axes) {
  place.allow_only({"center", "inner_radius", "outer_radius"});
  Ring ring;
  ring.center = read_per_axis(place["center"], axes, QuantityKind::length);
  ring.inner_radius = optional_quantity(place["inner_radius"], QuantityKind::length);
  ring.outer_radius = place["outer_radius"].quantity(QuantityKind::length);
  return ring;
}

DensityRamp read_density_ramp(const JsonPlace& place) {
  place.allow_only({"final_density", "start", "duration"});
  return {.final_density = place["final_density"].quantity(QuantityKind::density),
          .start = optional_quantity(place["start"], QuantityKind::time),
          .duration = place["duration"].quantity(QuantityKind::time)};
}

enum class InitialStressType { uniform, geostatic };

InitialStress read_initial_stress(const JsonPlace& place, std::size_t axes) {
  const InitialStressType type = place["type"].choice<InitialStressType>(
      {{"uniform", InitialStressType::uniform}, {"geostatic", InitialStressType::geostatic}});
  if (type == InitialStressType::geostatic) {
    place.allow_only({"type", "surface", "k0"});
    return GeostaticStress{.surface = place["surface"].quantity(QuantityKind::length),
                           .k0 = place["k0"].number()};
  }
  place.allow_only(keys_of(axes, {"type", "xx"}, {"yy", "zz", "xy"}));
  return UniformStress{.xx = optional_quantity(place["xx"], QuantityKind::pressure),
                       .yy = optional_quantity(place["yy"], QuantityKind::pressure),
                       .zz = optional_quantity(place["zz"], QuantityKind::pressure),
                       .xy = optional_quantity(place["xy"], QuantityKind::pressure)};
}

Body read_body(const JsonPlace& place, std::size_t axes) {
  place.allow_only(keys_of(axes,
                           {"name", "lower", "upper", "particles_per_cell", "density", "density_ramp",
                            "velocity", "initial_stress", "material"},
                           {"ring"}));
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
  if (const JsonPlace ring = place["ring"]; ring.present()) body.ring = read_ring(ring, axes);
  if (const JsonPlace ramp = place["density_ramp"]; ramp.present())
    body.density_ramp = read_density_ramp(ramp);
  if (const JsonPlace stress = place["initial_stress"]; stress.present()) {
    body.initial_stress = read_initial_stress(stress, axes);
  }
  body.material = read_material(place["material"]);
  return body;
}

const std::vector<std::string> axis_names = {"x", "y"};

std::array<bool, max_dimension> read_constrained(const JsonPlace& place, std::size_t axes) {
  std::array<bool, max_dimension> constrains{};
  for (const JsonPlace& element : place.some_elements()) {
    const std::string name = element.one_of(keys_of(axes, {"x"}, {"y"}));
    bool& constrained = constrains[name == "x" ? 0 : 1];
    if (constrained) element.refuse("each component once", " again");
    constrained = true;
  }
  return constrains;
}

RigidBody read_rigid_body(const JsonPlace& place, std::size_t axes) {
  place.allow_only(keys_of(axes, {"name", "lower", "upper", "constrains", "velocity", "start", "ramp"},
                           {"angular_velocity"}));
  RigidBody body;
  body.name = place["name"].identifier();
  body.lower = read_per_axis(place["lower"], axes, QuantityKind::length);
  body.upper = read_per_axis(place["upper"], axes, QuantityKind::length);
  if (const JsonPlace constrains = place["constrains"]; constrains.present()) {
    body.constrains = read_constrained(constrains, axes);
  }
  if (const JsonPlace velocity = place["velocity"]; velocity.present()) {
    body.velocity = read_per_axis(velocity, axes, QuantityKind::velocity);
  }
  body.angular_velocity = optional_quantity(place["angular_velocity"], QuantityKind::angular_velocity);
  body.start = optional_quantity(place["start"], QuantityKind::time);
  body.ramp = optional_quantity(place["ramp"], QuantityKind::time);
  return body;
}

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& each : all) names.push_back(each.name);
  return names;
}

SurfaceLoad read_surface_load(const JsonPlace& place, const Scene& scene) {
  const std::size_t axes = axes_of(scene);
  place.allow_only(keys_of(axes, {"body", "edge", "traction", "ramp"}, {"from", "to"}));
  SurfaceLoad load;
  load.body = place["body"].one_of(names_of(scene.bodies));
  const std::string edge =
      place["edge"].one_of(keys_of(axes, {"x_lower", "x_upper"}, {"y_lower", "y_upper"}));
  load.axis = edge.front() == 'x' ? 0 : 1;
  load.side = edge == edge_names[load.axis][0] ? 0 : 1;
  if (axes == 2) {
    load.begin = place["from"].quantity(QuantityKind::length);
    load.end = place["to"].quantity(QuantityKind::length);
  }
  load.traction = read_per_axis(place["traction"], axes, QuantityKind::pressure);
  load.ramp = optional_quantity(place["ramp"], QuantityKind::time);
  return load;
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
                    "damping", "grid", "bodies", "rigid_bodies", "surface_loads", "driven_motion",
                    "sums_strain", "gravity", "time_step", "termination"});
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
  if (const JsonPlace rigid = place["rigid_bodies"]; rigid.present()) {
    for (const JsonPlace& body : rigid.some_elements())
      scene.rigid_bodies.push_back(read_rigid_body(body, axes_of(scene)));
  }
  if (const JsonPlace loads = place["surface_loads"]; loads.present()) {
    for (const JsonPlace& load : loads.some_elements())
      scene.surface_loads.push_back(read_surface_load(load, scene));
  }
  scene.sums_strain = optional_flag(place["sums_strain"], false);
  scene.gravity = read_gravity(place["gravity"], axes_of(scene));
  scene.time_step = read_time_step(place["time_step"]);
  scene.termination = read_termination(place["termination"]);
  return scene;
}

// ---- driven motion
// ----------------------------------------------------------------------------------------------

/// A number that a manufactured solution is told.
struct MotionParameter {
  const char* name;
  QuantityKind kind;  ///< an angle is told in radians
  bool required = false;
};

/// A manufactured solution as case files name it.
struct MotionKind {
  const char* name;
  bool of_any_elastic_law;  ///< else of neo-Hookean bodies only
  bool has_center;
  std::vector<MotionParameter> parameters;
};

const std::vector<MotionKind>& motion_kinds() {
  constexpr QuantityKind length = QuantityKind::length, time = QuantityKind::time,
                         angle = QuantityKind::angle, rate = QuantityKind::angular_velocity;
  static const std::vector<MotionKind> kinds = {
      {"standing_wave", false, false, {{"amplitude", length, true}, {"length", length}}},
      {"axis_aligned", false, false, {{"amplitude", length, true}, {"length", length}}},
      {"generalised_vortex",
       false,
       true,
       {{"amplitude", angle, true}, {"period", time}, {"inner_radius", length}, {"outer_radius", length}}},
      {"expanding_ring",
       false,
       true,
       {{"amplitude", length, true},
        {"angular_frequency", rate},
        {"inner_radius", length},
        {"outer_radius", length}}},
      {"rotation", false, true, {{"angular_velocity", rate, true}}},
      {"vibrating_bar", true, false, {{"amplitude", length, true}, {"length", length}}},
  };
  return kinds;
}

/// What a case file says of a driven motion.
struct MotionText {
  const MotionKind* kind = nullptr;
  reference::Parameters parameters;  ///< in SI units; what is left out keeps the solution's default
};

MotionText read_motion(const JsonPlace& place, std::size_t axes) {
  std::vector<std::string> names;
  for (const MotionKind& kind : motion_kinds()) names.push_back(kind.name);
  const std::string name = place["solution"].one_of(names);
  MotionText text;
  text.kind = &*std::find_if(motion_kinds().begin(), motion_kinds().end(),
                             [&](const MotionKind& kind) { return kind.name == name; });
  std::vector<std::string> keys = {"solution"};
  for (const MotionParameter& parameter : text.kind->parameters) keys.push_back(parameter.name);
  if (text.kind->has_center) keys.push_back("center");
  place.allow_only(keys);
  for (const auto& [key, kind, required] : text.kind->parameters) {
    const JsonPlace value = place[key];
    if (!required && !value.present()) continue;
    text.parameters[key] = kind == QuantityKind::angle ? read_angle(value) : value.quantity(kind);
  }
  if (const JsonPlace center = place["center"]; center.present()) {
    const PerAxis at = read_per_axis(center, axes, QuantityKind::length);
    text.parameters["center_x"] = at[0];
    text.parameters["center_y"] = at[1];
  }
  return text;
}

/// What a body is made of, if a driven motion can be of it.
std::optional<reference::Solid> solid_of(const Body& body, bool any_elastic_law) {
  if (const auto* rubber = std::get_if<NeoHookean>(&body.material))
    return reference::Solid{body.density, rubber->youngs_modulus, rubber->poissons_ratio};
  const auto* elastic = std::get_if<LinearElastic>(&body.material);
  if (!elastic || !any_elastic_law) return std::nullopt;
  return reference::Solid{body.density, elastic->youngs_modulus, elastic->poissons_ratio};
}

/// The one solid that all bodies of a driven scene are made of.
reference::Solid read_driven_solid(const JsonPlace& bodies, const Scene& scene, const MotionKind& motion) {
  std::optional<reference::Solid> solid;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const JsonPlace body = bodies.elements()[i];
    if (body["velocity"].present()) body["velocity"].refuse("no velocity where driven_motion gives it");
    const auto made_of = solid_of(scene.bodies[i], motion.of_any_elastic_law);
    if (!made_of) {
      body["material"]["law"].refuse(std::string(motion.of_any_elastic_law ? "linear_elastic or " : "") +
                                     "neo_hookean, which " + motion.name + " is of");
    }
    if (!solid) solid = made_of;
    const bool same = solid->density == made_of->density &&
                      solid->youngs_modulus == made_of->youngs_modulus &&
                      solid->poissons_ratio == made_of->poissons_ratio && !scene.bodies[i].density_ramp;
    if (!same)
      body.refuse("a body with the constant density and the moduli of the first, all in one driven motion");
  }
  return *solid;
}

/// Passes on what a solution says of a parameter: "name: expected ..., found ...".
[[noreturn]] void refuse_parameter(const JsonPlace& motion, const std::string& message) {
  const std::size_t name = message.find(": expected "), found = message.rfind(", found ");
  if (name == std::string::npos || found == std::string::npos)
    throw Refusal(motion.pointer(), "parameters of a motion", message);
  const std::size_t expected = name + std::string(": expected ").size();
  const std::string key = message.substr(0, name);
  const JsonPlace place = motion[key];
  throw Refusal(place.present() ? place.pointer() : motion.pointer(),
                message.substr(expected, found - expected) + (place.present() ? "" : " for " + key),
                message.substr(found + std::string(", found ").size()));
}

/// The exact motion that a scene asks to be driven by; null if it does not. `scene` has been checked.
std::shared_ptr<const reference::ManufacturedSolution> read_solution(const JsonPlace& place,
                                                                     const Scene& scene) {
  const JsonPlace motion = place["driven_motion"];
  if (!motion.present()) return nullptr;
  const MotionText text = read_motion(motion, axes_of(scene));
  const reference::Solid solid = read_driven_solid(place["bodies"], scene, *text.kind);
  std::shared_ptr<const reference::ManufacturedSolution> solution;
  try {
    solution = reference::manufactured_solution(text.kind->name, text.parameters, solid);
  } catch (const std::invalid_argument& error) {
    refuse_parameter(motion, error.what());
  }
  if (solution->dimension() != scene.dimension) {
    motion["solution"].refuse("a motion in as many dimensions as the scene's",
                              ", which has " + std::to_string(solution->dimension()));
  }
  return solution;
}

/// The motion as the solver asks for it. The functions keep the solution alive.
std::optional<DrivenMotion> driven_motion_of(
    const std::shared_ptr<const reference::ManufacturedSolution>& solution) {
  if (!solution) return std::nullopt;
  return DrivenMotion{
      .velocity = [solution](const PerAxis& at, double time) { return solution->velocity(at, time); },
      .body_force = [solution](const PerAxis& at, double time) { return solution->body_force(at, time); }};
}

// ---- element test
// -----------------------------------------------------------------------------------------------

ElementPath read_path_type(const JsonPlace& place) {
  return place.choice<ElementPath>({{"plane_strain_compression", ElementPath::plane_strain_compression},
                                    {"plane_strain_extension", ElementPath::plane_strain_extension},
                                    {"oedometric_compression", ElementPath::oedometric_compression},
                                    {"oedometric_extension", ElementPath::oedometric_extension},
                                    {"simple_shear", ElementPath::simple_shear},
                                    {"isotropic_tension", ElementPath::isotropic_tension},
                                    {"random_states", ElementPath::random_states}});
}

void read_path(const JsonPlace& place, ElementTest& test) {
  test.path = read_path_type(place["type"]);
  test.pressure = place["pressure"].quantity(QuantityKind::pressure);
  if (test.path == ElementPath::random_states) {
    place.allow_only({"type", "pressure", "states", "seed"});
    test.states = place["states"].integer();
    const int seed = place["seed"].integer();
    if (seed < 0) place["seed"].refuse("a whole number, zero or above");
    test.seed = static_cast<std::uint64_t>(seed);
    return;
  }
  place.allow_only({"type", "pressure", "strain", "increments"});
  test.strain = place["strain"].number();
  test.increments = place["increments"].integer();
}

ElementTest read_element(const JsonPlace& place) {
  place.allow_only({"material", "path", "precision"});
  ElementTest test;
  const Material material = read_material(place["material"]);
  const auto* soil = std::get_if<MohrCoulomb>(&material);
  if (!soil) place["material"]["law"].refuse("a law with element tests, mohr_coulomb");
  test.material = *soil;
  read_path(place["path"], test);
  if (const JsonPlace precision = place["precision"]; precision.present()) {
    test.precision =
        precision.choice<Precision>({{"double", Precision::float64}, {"float", Precision::float32}});
  }
  return test;
}

const std::string scene_pointer = "/scene", element_pointer = "/element";

/// What a case puts to the test as written: a scene or an element test, and which.
struct Subject {
  std::string pointer;  ///< `scene_pointer` or `element_pointer`
  Json text;
};

/// Throws Refusal with a pointer below /scene for a scene that cannot start.
void require_possible(const Scene& scene) {
  try {
    check(scene);
  } catch (const SceneError& error) {
    throw Refusal(scene_pointer + error.place(), error.expected(), error.found());
  }
}

/// Reads a scene that can start into the request of a run. Throws Refusal with a pointer below /scene.
void read_checked_scene(const JsonPlace& place, RunRequest& run) {
  run.scene = read_scene(place);
  require_possible(run.scene);
  run.motion = read_solution(place, run.scene);
  run.scene.driven_motion = driven_motion_of(run.motion);
}

void read_checked_element(const JsonPlace& place, RunRequest& run) {
  run.element = read_element(place);
  try {
    check(*run.element);
  } catch (const SceneError& error) {
    throw Refusal(element_pointer + error.place(), error.expected(), error.found());
  }
}

/// Reads a scene or an element test that can start into the request of a run.
void read_checked(const Subject& subject, RunRequest& run) {
  const JsonPlace place(&subject.text, subject.pointer);
  if (subject.pointer == element_pointer) return read_checked_element(place, run);
  read_checked_scene(place, run);
}

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

/// A JSON pointer to something in the subject as written, relative to the subject.
Json::json_pointer below(const Subject& subject, const std::string& parameter) {
  return Json::json_pointer(parameter.substr(subject.pointer.size()));
}

bool names_value(const std::string& parameter, const Subject& subject) {
  if (!parameter.starts_with(subject.pointer + "/")) return false;
  try {
    return subject.text.contains(below(subject, parameter));
  } catch (const Json::exception&) {  // not a JSON pointer
    return false;
  }
}

/// Refuses a `parameter` that the subject does not have or that one of the `taken` changes too. `found`
/// describes it.
void require_own_value(const std::string& pointer, const std::string& parameter, const std::string& found,
                       const Subject& subject, const std::vector<std::string>& taken) {
  if (!names_value(parameter, subject)) {
    const bool of_scene = subject.pointer == scene_pointer;
    throw Refusal(pointer,
                  of_scene ? "a JSON pointer to a value the scene has, such as \"/scene/scheme\""
                           : "a JSON pointer to a value the element test has, such as \"/element/path\"",
                  found);
  }
  for (const std::string& other : taken) {
    if (at_or_below(parameter, other) || at_or_below(other, parameter)) {
      throw Refusal(pointer, "a parameter that no other axis changes",
                    found + ", which " + other + " changes too");
    }
  }
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

std::vector<Json> read_followers(const JsonPlace& place, std::size_t count) {
  std::vector<Json> values;
  for (const JsonPlace& value : place.some_elements()) values.push_back(value.value());
  if (values.size() != count) {
    place.refuse("an array of " + std::to_string(count) + ", one value for each of the axis's values");
  }
  return values;
}

/// Reads an axis; `taken` are the parameters that are changed so far, to which its own are added.
SweepAxis read_sweep_axis(const JsonPlace& place, const Subject& subject, std::vector<std::string>& taken) {
  place.allow_only({"parameter", "with", "values"});
  SweepAxis axis;
  axis.parameter = place["parameter"].text();
  require_own_value(place["parameter"].pointer(), axis.parameter, describe(place["parameter"].value()),
                    subject, taken);
  taken.push_back(axis.parameter);
  axis.values = read_distinct_values(place["values"]);
  if (!place["with"].present()) return axis;
  for (const auto& [parameter, values] : place["with"].members()) {
    require_own_value(values.pointer(), parameter, describe(Json(parameter)), subject, taken);
    taken.push_back(parameter);
    axis.with.push_back({parameter, read_followers(values, axis.values.size())});
  }
  if (axis.with.empty()) place["with"].refuse("an object with at least one parameter");
  return axis;
}

std::vector<SweepAxis> read_sweep(const JsonPlace& place, const Subject& subject) {
  std::vector<SweepAxis> sweep;
  if (!place.present()) return sweep;
  double runs = 1.0;
  std::vector<std::string> taken;
  for (const JsonPlace& axis : place.some_elements()) {
    sweep.push_back(read_sweep_axis(axis, subject, taken));
    runs *= static_cast<double>(sweep.back().values.size());
    if (runs > most_runs) place.refuse("at most 100000 runs");
  }
  return sweep;
}

const Json& chosen_value(const std::vector<SweepAxis>& sweep, const Choice& choice, std::size_t axis) {
  return sweep[axis].values[choice[axis]];
}

std::string axis_pointer(std::size_t axis) { return "/sweep/" + std::to_string(axis); }

std::string chosen_pointer(const Choice& choice, std::size_t axis) {
  return axis_pointer(axis) + "/values/" + std::to_string(choice[axis]);
}

/// Puts the value with index `chosen` of an axis into the subject, and what follows along.
void put(const SweepAxis& axis, std::size_t chosen, Subject& subject) {
  subject.text.at(below(subject, axis.parameter)) = axis.values[chosen];
  for (const Follower& follower : axis.with) {
    subject.text.at(below(subject, follower.parameter)) = follower.values[chosen];
  }
}

/// Where in the case file the value stands that an axis puts at or above `pointer`, with the part of
/// `pointer` below it; empty if it puts none there.
std::string source_of(const std::string& pointer, const std::vector<SweepAxis>& sweep, const Choice& choice,
                      std::size_t axis) {
  if (const std::string& parameter = sweep[axis].parameter; at_or_below(pointer, parameter))
    return chosen_pointer(choice, axis) + pointer.substr(parameter.size());
  for (const Follower& follower : sweep[axis].with) {
    if (!at_or_below(pointer, follower.parameter)) continue;
    const Json::json_pointer values = Json::json_pointer(axis_pointer(axis) + "/with") / follower.parameter;
    return (values / choice[axis]).to_string() + pointer.substr(follower.parameter.size());
  }
  return "";
}

/// The first axis whose value makes the subject impossible even without the other axes; if none does alone,
/// the last.
std::size_t culprit(const Subject& subject, const std::vector<SweepAxis>& sweep, const Choice& choice) {
  for (std::size_t axis = 0; axis < sweep.size(); ++axis) {
    Subject changed = subject;
    put(sweep[axis], choice[axis], changed);
    try {
      RunRequest alone;
      read_checked(changed, alone);
    } catch (const Refusal&) {
      return axis;
    }
  }
  return sweep.size() - 1;
}

/// Says which swept value is to blame for what is wrong with the subject of a run.
[[noreturn]] void refuse_run(const Refusal& refusal, const Subject& subject,
                             const std::vector<SweepAxis>& sweep, const Choice& choice) {
  for (std::size_t axis = 0; axis < sweep.size(); ++axis) {
    const std::string source = source_of(refusal.pointer(), sweep, choice, axis);
    if (!source.empty()) throw Refusal(source, refusal.expected(), refusal.found());
  }
  const std::size_t axis = culprit(subject, sweep, choice);
  throw Refusal(chosen_pointer(choice, axis),
                "a value with which " + refusal.pointer() + " is " + refusal.expected(),
                describe(chosen_value(sweep, choice, axis)) + ", which makes it " + refusal.found());
}

RunRequest read_run(const Subject& subject, const std::vector<SweepAxis>& sweep, const Choice& choice) {
  RunRequest run;
  Subject resolved = subject;
  for (std::size_t axis = 0; axis < sweep.size(); ++axis) {
    run.parameters.emplace_back(sweep[axis].parameter, chosen_value(sweep, choice, axis));
    put(sweep[axis], choice[axis], resolved);
  }
  try {
    read_checked(resolved, run);
  } catch (const Refusal& refusal) {
    refuse_run(refusal, subject, sweep, choice);
  }
  run.scene_text = std::move(resolved.text);
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

std::vector<RunRequest> expand(const Subject& subject, const std::vector<SweepAxis>& sweep) {
  std::vector<RunRequest> runs;
  Choice choice(sweep.size(), 0);
  do {
    runs.push_back(read_run(subject, sweep, choice));
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

bool is_element_case(const Case& read) { return read.text.contains("element"); }

/// Whether a metric tells of every run, whatever it puts to the test.
bool tells_of_any_run(const std::string& metric) {
  return contains({"completed", "steps", "non_finite_values", "bits_differ"}, metric);
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
  if (name.starts_with(metamorphic_prefix) &&
      !contains(read.metamorphoses, name.substr(metamorphic_prefix.size()))) {
    place.refuse("a metric that the case measures", ", which needs that name among metamorphoses");
  }
  if (!tells_of_any_run(name) && name.starts_with("element.") != is_element_case(read)) {
    place.refuse(is_element_case(read) ? "a metric of an element test" : "a metric of a scene",
                 ", which the case does not measure");
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

/// Whether a particle of a ring can lie within half a particle spacing of `at`: along a radius.
bool hits(const Ring& ring, double spacing, const PerAxis& at) {
  const double radius = std::hypot(at[0] - ring.center[0], at[1] - ring.center[1]);
  const double reach = (0.5 + 1e-9) * spacing;
  return radius >= ring.inner_radius - reach && radius <= ring.outer_radius + reach;
}

/// Whether a particle lies within one particle spacing of `at` along every axis, which is to say that `at`
/// lies in a body or at most half a spacing outside it.
bool hits(const Body& body, const Scene& scene, const PerAxis& at) {
  if (body.ring) {
    const double spacing =
        scene.cell_size / *std::min_element(body.particles_per_cell.begin(), body.particles_per_cell.end());
    if (!hits(*body.ring, spacing, at)) return false;
  }
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

/// Says in which run something is wrong.
std::string in_run(const RunRequest& run) {
  return run.parameters.empty() ? "" : " in the run with " + name_of(run);
}

void require_hit(const JsonPlace& place, const RunRequest& run, const PerAxis& at) {
  const std::vector<Body>& bodies = run.scene.bodies;
  if (std::any_of(bodies.begin(), bodies.end(), [&](const Body& b) { return hits(b, run.scene, at); }))
    return;
  std::vector<std::string> lengths;
  for (const JsonPlace& length : place.elements()) lengths.push_back(describe(length.value()));
  throw Refusal(place.pointer(), "a place within one particle spacing of a particle",
                listed(lengths) + ", which hits none" + in_run(run));
}

/// What can be recorded of a target, with the components it has.
struct ProbeKind {
  const char* quantity;
  ProbeTarget target;
  enum class Components { none, vector, stress } components;
};

constexpr ProbeKind probe_kinds[] = {
    {"displacement", ProbeTarget::particle, ProbeKind::Components::vector},
    {"velocity", ProbeTarget::particle, ProbeKind::Components::vector},
    {"stress", ProbeTarget::particle, ProbeKind::Components::stress},
    {"displacement", ProbeTarget::rigid_body, ProbeKind::Components::vector},
    {"reaction", ProbeTarget::rigid_body, ProbeKind::Components::vector},
    {"displacement", ProbeTarget::body, ProbeKind::Components::vector},
    {"velocity", ProbeTarget::body, ProbeKind::Components::vector},
    {"weight", ProbeTarget::body, ProbeKind::Components::none},
    {"momentum", ProbeTarget::everything, ProbeKind::Components::vector},
    {"kinetic_energy", ProbeTarget::everything, ProbeKind::Components::none},
    {"strain_energy", ProbeTarget::everything, ProbeKind::Components::none},
};

std::vector<std::string> probe_quantities() {
  std::vector<std::string> names;
  for (const ProbeKind& kind : probe_kinds) {
    if (!contains(names, kind.quantity)) names.push_back(kind.quantity);
  }
  return names;
}

const ProbeKind* find_probe_kind(const std::string& quantity, ProbeTarget target) {
  const auto kind = std::find_if(std::begin(probe_kinds), std::end(probe_kinds), [&](const ProbeKind& k) {
    return k.quantity == quantity && k.target == target;
  });
  return kind == std::end(probe_kinds) ? nullptr : &*kind;
}

/// The names in the scene that a quantity can be recorded of.
std::vector<std::string> probed_names(const Scene& scene, const std::string& quantity) {
  std::vector<std::string> names;
  if (find_probe_kind(quantity, ProbeTarget::rigid_body)) names = names_of(scene.rigid_bodies);
  if (find_probe_kind(quantity, ProbeTarget::body)) {
    for (const Body& body : scene.bodies) names.push_back(body.name);
  }
  return names;
}

/// What a probe of `quantity` with these keys looks at; of a named thing only whether there is a name.
ProbeTarget read_target(const JsonPlace& place, const std::string& quantity) {
  const bool particle = find_probe_kind(quantity, ProbeTarget::particle);
  const bool named =
      find_probe_kind(quantity, ProbeTarget::rigid_body) || find_probe_kind(quantity, ProbeTarget::body);
  std::vector<std::string> keys = {"id", "quantity"};
  if (particle) keys.push_back("at");
  if (named) keys.push_back("of");
  if (quantity == "momentum" || particle || quantity == "reaction") keys.push_back("component");
  keys.push_back("every");
  place.allow_only(keys);
  if (particle && named && place["at"].present() == place["of"].present()) {
    throw Refusal(place.pointer(), "either at or of", place["at"].present() ? "both" : "neither");
  }
  if (particle && (place["at"].present() || !named)) return ProbeTarget::particle;
  return named ? ProbeTarget::body : ProbeTarget::everything;
}

/// Finds the body or rigid body of the name in the scene of a run.
void read_named(const JsonPlace& place, const RunRequest& run, HistoryProbe& probe) {
  const std::vector<std::string> names = probed_names(run.scene, probe.quantity);
  if (names.empty()) place.refuse("the name of a rigid body, of which the scene has none");
  probe.of = place.one_of(names);
  const bool rigid = contains(names_of(run.scene.rigid_bodies), probe.of);
  probe.target = rigid ? ProbeTarget::rigid_body : ProbeTarget::body;
}

std::vector<std::string> component_names(const ProbeKind& kind, std::size_t axes) {
  return kind.components == ProbeKind::Components::stress ? keys_of(axes, {"xx"}, {"yy", "zz", "xy"})
                                                          : keys_of(axes, {"x"}, {"y"});
}

void read_component(const JsonPlace& place, const RunRequest& run, HistoryProbe& probe) {
  const ProbeKind& kind = *find_probe_kind(probe.quantity, probe.target);
  if (kind.components == ProbeKind::Components::none) return;
  const std::size_t axes = axes_of(run.scene);
  const std::vector<std::string> names = component_names(kind, axes);
  probe.component = place.present() ? place.one_of(names) : names[axes - 1];
  if (probe.quantity != "reaction") return;
  const auto body = std::find_if(run.scene.rigid_bodies.begin(), run.scene.rigid_bodies.end(),
                                 [&](const RigidBody& b) { return b.name == probe.of; });
  if (!body->constrains[probe.component == "x" ? 0 : 1]) {
    throw Refusal(place.pointer(), "a component that " + probe.of + " constrains",
                  probe.component + ", in which it has no reaction" + in_run(run));
  }
}

bool stores_energy(const Body& body) {
  return std::holds_alternative<LinearElastic>(body.material) ||
         std::holds_alternative<NeoHookean>(body.material);
}

/// Checks a probe against the scene of a run and fills in what only the scene tells.
void read_probed(const JsonPlace& place, const RunRequest& run, HistoryProbe& probe) {
  if (place["at"].present()) {
    probe.at = read_per_axis(place["at"], axes_of(run.scene), QuantityKind::length);
    require_hit(place["at"], run, probe.at);
  }
  if (probe.target == ProbeTarget::body || probe.target == ProbeTarget::rigid_body)
    read_named(place["of"], run, probe);
  read_component(place["component"], run, probe);
  if (probe.quantity != "strain_energy") return;
  for (const Body& body : run.scene.bodies) {
    if (stores_energy(body)) continue;
    place["quantity"].refuse(
        "a quantity of the bodies there are; strain energy needs linear_elastic or neo_hookean",
        ", but \"" + body.name + "\" has another law" + in_run(run));
  }
}

HistoryProbe read_probe(const JsonPlace& place, const Case& read) {
  HistoryProbe probe;
  probe.quantity = place["quantity"].one_of(probe_quantities());
  probe.target = read_target(place, probe.quantity);
  probe.id = read_id(place["id"], read.probes);
  probe.every = place["every"].quantity(QuantityKind::time);
  if (probe.every <= 0.0) place["every"].refuse("a time above zero");
  read_probed(place, read.runs.front(), probe);
  for (const RunRequest& run : read.runs) {
    HistoryProbe again = probe;
    read_probed(place, run, again);
    if (again.target != probe.target || again.component != probe.component) {
      throw Refusal(place.pointer(), "a probe that means the same in every run",
                    "one that means something else" + in_run(run));
    }
  }
  return probe;
}

// ---- snapshots
// --------------------------------------------------------------------------------------------------

std::vector<std::string> displacement_probes(const Case& read) {
  std::vector<std::string> ids;
  for (const HistoryProbe& probe : read.probes) {
    if (probe.quantity == "displacement") ids.push_back(probe.id);
  }
  return ids;
}

double latest_end(const Scene& scene) {
  const auto* at_time = std::get_if<AtTime>(&scene.termination);
  return at_time ? at_time->time : std::get<AtRest>(scene.termination).deadline;
}

double read_snapshot_time(const JsonPlace& place, const Case& read) {
  const double time = place.quantity(QuantityKind::time);
  if (time < 0.0) place.refuse("a time, zero or above");
  for (const RunRequest& run : read.runs) {
    if (time > latest_end(run.scene))
      place.refuse("a time before the run has ended", ", which is later" + in_run(run));
  }
  return time;
}

SnapshotRequest read_snapshot(const JsonPlace& place, const Case& read) {
  place.allow_only({"time", "probe", "reaches", "end"});
  const JsonPlace time = place["time"], probe = place["probe"], reaches = place["reaches"],
                  end = place["end"];
  const bool passing = probe.present() || reaches.present();
  const int ways = (time.present() ? 1 : 0) + (passing ? 1 : 0) + (end.present() ? 1 : 0);
  if (ways != 1) {
    throw Refusal(place.pointer(), "either time, or probe and reaches, or end",
                  ways == 0 ? "none of them" : "more than one of them");
  }
  SnapshotRequest snapshot;
  if (time.present()) {
    snapshot.when = SnapshotRequest::When::time;
    snapshot.time = read_snapshot_time(time, read);
  } else if (passing) {
    const std::vector<std::string> ids = displacement_probes(read);
    if (ids.empty()) probe.refuse("the id of a displacement probe, of which this case has none");
    snapshot.when = SnapshotRequest::When::passing;
    snapshot.probe = probe.one_of(ids);
    snapshot.value = reaches.quantity(QuantityKind::length);
  } else if (!end.flag()) {
    end.refuse("true");
  }
  return snapshot;
}

std::vector<SnapshotRequest> read_snapshots(const JsonPlace& place, const Case& read) {
  std::vector<SnapshotRequest> snapshots;
  if (!place.present()) return snapshots;
  for (const JsonPlace& element : place.elements()) {
    snapshots.push_back(read_snapshot(element, read));
    for (std::size_t earlier = 0; earlier + 1 < snapshots.size(); ++earlier) {
      if (snapshots[earlier] == snapshots.back())
        element.refuse("each moment once", ", the moment of an earlier one");
    }
  }
  return snapshots;
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
                        Subject subject) {
  double coarser = std::numeric_limits<double>::infinity();
  for (const Json& value : values) {
    const auto chosen = std::find(axis.values.begin(), axis.values.end(), value) - axis.values.begin();
    put(axis, static_cast<std::size_t>(chosen), subject);
    const double cell_size = read_scene(JsonPlace(&subject.text, subject.pointer)).cell_size;
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
  if (gate.statistic == Statistic::last_order) {
    if (is_element_case(read)) place.refuse("a parameter of a scene, which alone has cells to refine");
    require_refinement(place, axis, values, {scene_pointer, read.text.at("scene")});
  }
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
  if (kind == "curves") keys.insert(keys.end(), {"quantity", "references"});
  if (kind == "history" || kind == "fields") keys.push_back("quantity");
  return keys;
}

/// The curves of a verdict that can be drawn by their name: of a scene the pressure under a footing over its
/// settlement, of an element test its stresses and volume over the strain.
std::vector<std::string> curve_catalogue(const Case& read) {
  if (!is_element_case(read)) return {"pressure"};
  return {"stress_xx", "stress_yy", "stress_zz", "stress_xy", "volumetric_strain"};
}

/// The name of a scalar to draw the snapshots by, which every run must have.
std::string read_field(const JsonPlace& place, const Case& read) {
  if (read.snapshots.empty()) place.refuse("a figure of the case's snapshots, of which it has none");
  const std::string name = place.one_of(names_of(field_catalogue()));
  for (const RunRequest& run : read.runs) {
    if (run.scene.dimension != 2)
      place.refuse("a figure of a scene with another dimension",
                   ", which needs two dimensions" + in_run(run));
    if (name.find("strain") != std::string::npos && !run.scene.sums_strain) {
      place.refuse("a scalar that the scene keeps", ", which needs sums_strain to be true" + in_run(run));
    }
  }
  return name;
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
  figure.kind =
      place["kind"].one_of(is_element_case(read) ? std::vector<std::string>{"bars", "curves"}
                                                 : std::vector<std::string>{"profiles", "convergence", "bars",
                                                                            "history", "curves", "fields"});
  place.allow_only(figure_keys(figure.kind));
  figure.id = read_id(place["id"], read.figures);
  figure.caption = place["caption"].text();
  read_layout(place, read, figure);
  if (figure.kind == "profiles") {
    figure.quantity = place["quantity"].one_of({"stress", "displacement", "stress_error"});
  } else if (figure.kind == "curves") {
    figure.quantity = place["quantity"].one_of(curve_catalogue(read));
  } else if (figure.kind == "history") {
    figure.quantity = read_probe_name(place["quantity"], read.probes);
  } else if (figure.kind == "fields") {
    figure.quantity = read_field(place["quantity"], read);
  } else {
    figure.metrics = read_metrics(place["metrics"], read);
  }
  if (place["references"].present()) figure.references = read_names(place["references"], read.references);
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
      const std::string missing = why_unsuited(name.text(), run);
      if (missing.empty()) continue;
      name.refuse(std::string("a reference solution that describes the ") +
                      (run.element ? "element test" : "scene") + "; it needs " + missing,
                  run.parameters.empty() ? "" : " for the run with " + name_of(run));
    }
  }
}

/// Other descriptions of the scene, each of which every run must have.
std::vector<std::string> read_metamorphoses(const JsonPlace& place, const Case& read) {
  if (!place.present()) return {};
  std::vector<std::string> known;
  for (const Metamorphosis& metamorphosis : metamorphosis_catalogue()) known.push_back(metamorphosis.name);
  const std::vector<std::string> names = read_names(place, known);
  for (const JsonPlace& name : place.elements()) {
    for (const RunRequest& run : read.runs) {
      const std::string reason = why_not_describable(name.text(), run.scene);
      if (reason.empty()) continue;
      name.refuse("a metamorphosis that the scene has",
                  ", but " + reason + (run.parameters.empty() ? "" : " in the run with " + name_of(run)));
    }
  }
  return names;
}

/// The scene or the element test of a case, which can start as written.
Subject read_subject(const JsonPlace& place) {
  const JsonPlace scene = place["scene"], element = place["element"];
  if (scene.present() && element.present()) throw Refusal("", "either scene or element", "both");
  if (!scene.present() && !element.present()) scene.refuse("an object");
  const Subject subject =
      element.present() ? Subject{element_pointer, element.value()} : Subject{scene_pointer, scene.value()};
  RunRequest as_written;
  read_checked(subject, as_written);
  return subject;
}

/// Reads `read.text` into the rest of `read`, top to bottom: each part refers only to those before it.
void read_parts(Case& read) {
  const JsonPlace place(&read.text, "");
  std::vector<std::string> keys = {"$schema",         "id",          "title",
                                   "figure_of_paper", "description", "claims",
                                   "notes",           "quick",       "repeat_on_other_threads",
                                   "scene",           "element",     "sweep",
                                   "references",      "gates",       "figures"};
  if (!place["element"].present()) keys.insert(keys.end(), {"metamorphoses", "probes", "snapshots"});
  place.allow_only(keys);
  optional_text(place["$schema"]);
  read_description(place, read);
  const Subject subject = read_subject(place);
  read.sweep = read_sweep(place["sweep"], subject);
  read.runs = expand(subject, read.sweep);
  require_suited(place["references"], read);
  read.metamorphoses = read_metamorphoses(place["metamorphoses"], read);
  if (const JsonPlace probes = place["probes"]; probes.present()) {
    for (const JsonPlace& probe : probes.elements()) read.probes.push_back(read_probe(probe, read));
  }
  read.snapshots = read_snapshots(place["snapshots"], read);
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
