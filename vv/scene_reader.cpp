#include "vv/scene_reader.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>

#include "reference/manufactured.hpp"
#include "solver/error.hpp"

namespace mpm::vv {
namespace {

// ---- scene
// ------------------------------------------------------------------------------------------------------

/// The entries of an array with one entry per dimension.
std::vector<JsonPlace> axis_elements(const JsonPlace& place, std::size_t axes) {
  const std::vector<JsonPlace> elements = place.elements();
  if (elements.size() != axes)
    place.refuse("an array of " + std::to_string(axes) + ", one value per dimension");
  return elements;
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
  ring.inner_radius = place["inner_radius"].quantity_or(QuantityKind::length, 0.0);
  ring.outer_radius = place["outer_radius"].quantity(QuantityKind::length);
  return ring;
}

DensityRamp read_density_ramp(const JsonPlace& place) {
  place.allow_only({"final_density", "start", "duration", "then"});
  DensityRamp ramp{.start = place["start"].quantity_or(QuantityKind::time, 0.0),
                   .stages = {{.density = place["final_density"].quantity(QuantityKind::density),
                               .duration = place["duration"].quantity(QuantityKind::time)}}};
  if (const JsonPlace then = place["then"]; then.present()) {
    for (const JsonPlace& stage : then.some_elements()) {
      stage.allow_only({"density", "duration"});
      ramp.stages.push_back({.density = stage["density"].quantity(QuantityKind::density),
                             .duration = stage["duration"].quantity(QuantityKind::time)});
    }
  }
  return ramp;
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
  return UniformStress{.xx = place["xx"].quantity_or(QuantityKind::pressure, 0.0),
                       .yy = place["yy"].quantity_or(QuantityKind::pressure, 0.0),
                       .zz = place["zz"].quantity_or(QuantityKind::pressure, 0.0),
                       .xy = place["xy"].quantity_or(QuantityKind::pressure, 0.0)};
}

Body read_body(const JsonPlace& place, std::size_t axes) {
  place.allow_only(keys_of(axes,
                           {"name", "lower", "upper", "particles_per_cell", "density", "density_ramp", "inertia", "anywhere",
                            "velocity", "initial_stress", "material", "locking_control"},
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
  body.anywhere = place["anywhere"].flag_or(false);
  if (const JsonPlace inertia = place["inertia"]; inertia.present())
    body.inertia = inertia.quantity(QuantityKind::density);
  if (const JsonPlace stress = place["initial_stress"]; stress.present()) {
    body.initial_stress = read_initial_stress(stress, axes);
  }
  body.material = read_material(place["material"]);
  if (const JsonPlace control = place["locking_control"]; control.present()) {
    body.locking_control = control.choice<LockingControl>(
        {{"none", LockingControl::none}, {"cell_average", LockingControl::cell_average}});
  }
  return body;
}

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
  body.angular_velocity = place["angular_velocity"].quantity_or(QuantityKind::angular_velocity, 0.0);
  body.start = place["start"].quantity_or(QuantityKind::time, 0.0);
  body.ramp = place["ramp"].quantity_or(QuantityKind::time, 0.0);
  return body;
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
  load.ramp = place["ramp"].quantity_or(QuantityKind::time, 0.0);
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

enum class TerminationType { at_time, at_rest, at_displacement };

Termination read_termination(const JsonPlace& place, int dimension) {
  const TerminationType type =
      place["type"].choice<TerminationType>({{"at_time", TerminationType::at_time},
                                             {"at_rest", TerminationType::at_rest},
                                             {"at_displacement", TerminationType::at_displacement}});
  if (type == TerminationType::at_time) {
    place.allow_only({"type", "time"});
    return AtTime{place["time"].quantity(QuantityKind::time)};
  }
  const auto read_deadline = [&] { return place["deadline"].quantity(QuantityKind::time); };
  if (type == TerminationType::at_rest) {
    place.allow_only({"type", "unbalanced_force_ratio", "kinetic_energy_ratio", "deadline"});
    return AtRest{place["unbalanced_force_ratio"].number(), place["kinetic_energy_ratio"].number(),
                  read_deadline()};
  }
  place.allow_only({"type", "body", "component", "displacement", "deadline"});
  int axis = dimension - 1;
  if (const JsonPlace component = place["component"]; component.present())
    axis = component.choice<int>({{"x", 0}, {"y", 1}});
  return AtDisplacement{place["body"].text(), axis, place["displacement"].quantity(QuantityKind::length),
                        read_deadline()};
}

Precision read_precision(const JsonPlace& place) {
  if (!place.present()) return Precision::float64;
  return place.choice<Precision>({{"double", Precision::float64}, {"float", Precision::float32}});
}

Decision read_decision(const JsonPlace& place) {
  return place.choice<Decision>({{"automatic", Decision::automatic}, {"as_written", Decision::as_written}});
}

ModelRequest read_model(const JsonPlace& place) {
  ModelRequest request;
  if (!place.present()) return request;
  place.allow_only({"dimension", "precision"});
  if (const JsonPlace dimension = place["dimension"]; dimension.present())
    request.dimension = read_decision(dimension);
  if (const JsonPlace precision = place["precision"]; precision.present())
    request.precision = read_decision(precision);
  return request;
}

/// The number of a random order of particles, if they have one.
std::optional<std::uint64_t> read_shuffle(const JsonPlace& place) {
  if (!place.present()) return std::nullopt;
  place.allow_only({"shuffle"});
  const int seed = place["shuffle"].integer();
  if (seed < 0) place["shuffle"].refuse("a whole number, zero or above");
  return static_cast<std::uint64_t>(seed);
}

/// The scene as written: types, keys and units are right, but the values may be impossible.
Scene read_scene(const JsonPlace& place) {
  place.allow_only({"dimension", "scheme", "update_order", "precision", "objectivity", "flip_fraction",
                    "damping", "grid", "bodies", "rigid_bodies", "surface_loads", "driven_motion",
                    "model", "sums_strain", "sums_work", "domain_limit", "compensated_sums", "particle_order",
                    "light_nodes", "gravity", "time_step", "termination"});
  Scene scene;
  scene.dimension = read_dimension(place["dimension"]);
  scene.scheme = place["scheme"].choice<Scheme>(
      {{"mpm", Scheme::mpm}, {"ugimp", Scheme::ugimp}, {"cpgimp", Scheme::cpgimp}});
  if (const JsonPlace order = place["update_order"]; order.present()) {
    scene.update_order = order.choice<UpdateOrder>(
        {{"musl", UpdateOrder::musl}, {"usf", UpdateOrder::usf}, {"usl", UpdateOrder::usl}});
  }
  scene.precision = read_precision(place["precision"]);
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
  scene.sums_strain = place["sums_strain"].flag_or(false);
  scene.sums_work = place["sums_work"].flag_or(false);
  if (const JsonPlace limit = place["domain_limit"]; limit.present()) scene.domain_limit = limit.number();
  scene.compensated_sums = place["compensated_sums"].flag_or(false);
  scene.shuffle = read_shuffle(place["particle_order"]);
  if (const JsonPlace light = place["light_nodes"]; light.present()) scene.light_nodes = light.number();
  scene.gravity = read_gravity(place["gravity"], axes_of(scene));
  scene.time_step = read_time_step(place["time_step"]);
  scene.termination = read_termination(place["termination"], scene.dimension);
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
  test.precision = read_precision(place["precision"]);
  return test;
}

// ---- what a case puts to the test
// -----------------------------------------------------------------------------------

const std::string scene_pointer = "/scene", element_pointer = "/element";

/// Throws Refusal for a scene or an element test at `pointer` that cannot start.
template <class Trial>
void require_possible(const Trial& trial, const std::string& pointer) {
  try {
    check(trial);
  } catch (const SceneError& error) {
    throw Refusal(pointer + error.place(), error.expected(), error.found());
  }
}

}  // namespace

std::size_t axes_of(const Scene& scene) { return static_cast<std::size_t>(scene.dimension); }

std::vector<std::string> keys_of(std::size_t axes, std::vector<std::string> one,
                                 const std::vector<std::string>& more_in_two) {
  if (axes == 2) one.insert(one.end(), more_in_two.begin(), more_in_two.end());
  return one;
}

PerAxis read_per_axis(const JsonPlace& place, std::size_t axes, QuantityKind kind) {
  PerAxis values{};
  const std::vector<JsonPlace> elements = axis_elements(place, axes);
  for (std::size_t axis = 0; axis < axes; ++axis) values[axis] = elements[axis].quantity(kind);
  return values;
}

bool Subject::is_element() const { return pointer == element_pointer; }

Subject read_subject(const JsonPlace& place) {
  const JsonPlace scene = place["scene"], element = place["element"];
  if (scene.present() && element.present()) throw Refusal("", "either scene or element", "both");
  if (!scene.present() && !element.present()) scene.refuse("an object");
  return element.present() ? Subject{element_pointer, element.value()}
                           : Subject{scene_pointer, scene.value()};
}

CheckedSubject read_checked(const Subject& subject) {
  const JsonPlace place(&subject.text, subject.pointer);
  CheckedSubject checked;
  if (subject.is_element()) {
    checked.element = read_element(place);
    require_possible(*checked.element, subject.pointer);
    return checked;
  }
  checked.scene = read_scene(place);
  checked.model = read_model(place["model"]);
  require_possible(checked.scene, subject.pointer);
  checked.motion = read_solution(place, checked.scene);
  checked.scene.driven_motion = driven_motion_of(checked.motion);
  return checked;
}

double read_cell_size(const Subject& scene) {
  return read_scene(JsonPlace(&scene.text, scene.pointer)).cell_size;
}

}  // namespace mpm::vv
