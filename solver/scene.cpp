#include "solver/scene.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <string_view>
#include <utility>

#include "solver/error.hpp"
#include "solver/particles.hpp"

namespace mpm {
namespace {

/// How far a length may be from a whole number of cells (or of particle spacings), in cells. Decimal lengths
/// and the division leave errors of a few 1e-16 times the number of cells, so below 1e-7 for the largest grid
/// allowed; a real mistake is a visible part of a cell.
constexpr double whole_number_tolerance = 1e-6;

/// The most cells, and the most particles, a scene may have: about 10 GB of particles. Beyond it a misplaced
/// decimal point is more likely than a wish.
constexpr double most_elements = 1e8;

constexpr double largest_stable_fraction = 10.0;

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};

/// `value` with its unit, to the twelve digits that hide the round-off of a decimal number.
std::string text_of(double value, std::string_view unit = "") {
  char buffer[32];
  char* end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 12).ptr;
  std::string text(buffer, end);
  if (!unit.empty()) text.append(" ").append(unit);
  return text;
}

std::string at_index(const std::string& place, std::size_t index) {
  return place + "/" + std::to_string(index);
}

void require(bool condition, const std::string& place, const std::string& expected,
             const std::string& found) {
  if (!condition) throw SceneError(place, expected, found);
}

void require_positive(double value, const std::string& place, const std::string& what,
                      std::string_view unit = "") {
  require(std::isfinite(value) && value > 0.0, place, what + " above zero", text_of(value, unit));
}

void require_finite(double value, const std::string& place, const std::string& what,
                    std::string_view unit = "") {
  require(std::isfinite(value), place, "a finite " + what, text_of(value, unit));
}

std::size_t axes_of(const Scene& scene) { return static_cast<std::size_t>(scene.dimension); }

template <class Enum>
void require_known(Enum value, std::initializer_list<Enum> known, const std::string& place,
                   const std::string& what) {
  require(std::find(known.begin(), known.end(), value) != known.end(), place, "a known " + what,
          "number " + std::to_string(static_cast<int>(value)) + " of none");
}

void check_method(const Scene& scene) {
  require(scene.dimension >= 1 && scene.dimension <= max_dimension, "/dimension", "1 or 2",
          std::to_string(scene.dimension));
  require_known(scene.scheme, {Scheme::mpm, Scheme::ugimp, Scheme::cpgimp}, "/scheme", "scheme");
  require_known(scene.update_order, {UpdateOrder::musl, UpdateOrder::usf, UpdateOrder::usl}, "/update_order",
                "update order");
  require_known(scene.precision, {Precision::float64, Precision::float32}, "/precision", "precision");
  require_known(scene.objectivity, {Objectivity::none, Objectivity::jaumann}, "/objectivity", "objectivity");
  require(scene.dimension == 2 || scene.objectivity == Objectivity::none, "/objectivity",
          "none in one dimension, where nothing turns", "jaumann");
  if (scene.domain_limit) {
    require(*scene.domain_limit > 0.0 && *scene.domain_limit <= 1.0, "/domain_limit", "a number above 0, at most 1",
            text_of(*scene.domain_limit));
    for (const Body& body : scene.bodies) {
      for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimension); ++axis) {
        require(2 * body.particles_per_cell[axis] * *scene.domain_limit >= 1.0, "/domain_limit",
                "at least the half size that the particles of every body have at the start", text_of(*scene.domain_limit));
      }
    }
  }
  if (scene.light_nodes) {
    require(scene.update_order == UpdateOrder::usl, "/light_nodes",
            "nothing but in update order usl, where the grid's acceleration strains particles", text_of(*scene.light_nodes));
    require(*scene.light_nodes > 0.0 && *scene.light_nodes <= 1.0, "/light_nodes", "a number above 0, at most 1",
            text_of(*scene.light_nodes));
  }
  require(scene.flip_fraction >= 0.0 && scene.flip_fraction <= 1.0, "/flip_fraction", "a number from 0 to 1",
          text_of(scene.flip_fraction));
  require(scene.damping >= 0.0 && scene.damping < 1.0, "/damping", "a number from 0 to below 1",
          text_of(scene.damping));
}

bool whole(double number) { return std::abs(number - std::round(number)) <= whole_number_tolerance; }

void check_grid(const Scene& scene) {
  require_positive(scene.cell_size, "/grid/cell_size", "a cell size", "m");
  double cells_in_all = 1.0;
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    const std::string upper_place = at_index("/grid/upper", axis);
    const double lower = scene.grid_lower[axis], upper = scene.grid_upper[axis];
    require_finite(lower, at_index("/grid/lower", axis), "length", "m");
    require_finite(upper, upper_place, "length", "m");
    const double cells = (upper - lower) / scene.cell_size;
    require(std::round(cells) >= 1.0, upper_place,
            "at least one cell above the lower corner " + text_of(lower, "m"), text_of(upper, "m"));
    cells_in_all *= cells;
    require(cells_in_all <= most_elements, "/grid/cell_size",
            "at most " + text_of(most_elements) + " cells in the grid", text_of(cells_in_all) + " of them");
    require(whole(cells), upper_place,
            "a whole number of cells of " + text_of(scene.cell_size, "m") + " above the lower corner " +
                text_of(lower, "m"),
            text_of(upper, "m") + ", " + text_of(cells) + " cells above it");
  }
}

double youngs_modulus_of(const Material& material) {
  return std::visit([](const auto& law) { return law.youngs_modulus; }, material);
}

void check_poissons_ratio(double ratio, const std::string& place) {
  require(ratio >= 0.0 && ratio < 0.5, place + "/poissons_ratio", "a number from 0 to below 0.5",
          text_of(ratio));
}

void check_strength(const MohrCoulomb& law, const std::string& place) {
  constexpr double degree = std::numbers::pi / 180;
  const auto in_degrees = [&](double angle) { return text_of(angle / degree, "deg"); };
  require(law.friction_angle >= 0.0 && law.friction_angle < 90 * degree, place + "/friction_angle",
          "an angle from 0 to below 90 deg", in_degrees(law.friction_angle));
  require(law.dilation_angle >= 0.0 && law.dilation_angle <= law.friction_angle, place + "/dilation_angle",
          "an angle from 0 to the friction angle, " + in_degrees(law.friction_angle),
          in_degrees(law.dilation_angle));
  require(std::isfinite(law.cohesion) && law.cohesion >= 0.0, place + "/cohesion",
          "a pressure, zero or above", text_of(law.cohesion, "Pa"));
  require(law.cohesion > 0.0 || law.friction_angle > 0.0, place + "/cohesion",
          "a pressure above zero where the friction angle is zero", text_of(law.cohesion, "Pa"));
}

void check_material(const Scene& scene, const Body& body, const std::string& place) {
  const double modulus = youngs_modulus_of(body.material);
  require_positive(modulus, place + "/youngs_modulus", "a modulus", "Pa");
  const double wave_speed = std::sqrt(modulus / body.lightest());
  require(std::isfinite(wave_speed) && wave_speed > 0.0, place + "/youngs_modulus",
          "a modulus with which the wave speed sqrt(modulus / density) is a number above zero",
          text_of(modulus, "Pa") + " at a density of " + text_of(body.lightest(), "kg/m^3"));
  std::visit(Overloaded{[&](const LinearElastic& law) { check_poissons_ratio(law.poissons_ratio, place); },
                        [&](const MohrCoulomb& law) {
                          require(scene.dimension == 2, place + "/law", "a law for one dimension",
                                  "mohr_coulomb, which has two");
                          check_poissons_ratio(law.poissons_ratio, place);
                          check_strength(law, place);
                        },
                        [&](const NeoHookean& law) { check_poissons_ratio(law.poissons_ratio, place); },
                        [&](const ZhangElastic&) {
                          require(scene.dimension == 1, place + "/law",
                                  "a law for " + std::to_string(scene.dimension) + " dimensions",
                                  "zhang_elastic, which has one");
                        }},
             body.material);
}

void require_few_particles(double particles, const std::string& body_place) {
  require(particles <= most_elements, body_place + "/particles_per_cell",
          "at most " + text_of(most_elements) + " particles in the scene", text_of(particles) + " of them");
}

/// Checks where a body's edges are along one axis; returns how many particles fit between them.
double check_extent(const Scene& scene, const Body& body, std::size_t axis, const std::string& place) {
  const int per_cell = body.particles_per_cell[axis];
  require(per_cell >= 1, at_index(place + "/particles_per_cell", axis), "at least 1 particle",
          std::to_string(per_cell));
  const std::string lower_place = at_index(place + "/lower", axis),
                    upper_place = at_index(place + "/upper", axis);
  const double lower = body.lower[axis], upper = body.upper[axis];
  require_finite(lower, lower_place, "length", "m");
  require_finite(upper, upper_place, "length", "m");

  const double spacing = scene.cell_size / per_cell;
  const auto spacings_at = [&](double edge) { return (edge - scene.grid_lower[axis]) / spacing; };
  require(
      std::round(spacings_at(upper) - spacings_at(lower)) >= 1.0, upper_place,
      "at least one particle of " + text_of(spacing, "m") + " above the lower edge " + text_of(lower, "m"),
      text_of(upper, "m"));
  require_few_particles(spacings_at(upper) - spacings_at(lower), place);
  const double slack = whole_number_tolerance * scene.cell_size;
  require(lower >= scene.grid_lower[axis] - slack, lower_place,
          "a body inside the grid, which begins at " + text_of(scene.grid_lower[axis], "m"),
          text_of(lower, "m"));
  require(upper <= scene.grid_upper[axis] + slack, upper_place,
          "a body inside the grid, which ends at " + text_of(scene.grid_upper[axis], "m"),
          text_of(upper, "m"));
  if (body.anywhere) {
    require(whole(spacings_at(upper) - spacings_at(lower)), upper_place,
            "a whole number of particle spacings of " + text_of(spacing, "m") + " above the lower edge " +
                text_of(lower, "m"),
            text_of(upper, "m") + ", " + text_of(spacings_at(upper) - spacings_at(lower)) + " spacings above it");
    return spacings_at(upper) - spacings_at(lower);
  }
  for (const auto& [edge_place, edge] : {std::pair(lower_place, lower), std::pair(upper_place, upper)}) {
    require(whole(spacings_at(edge)), edge_place,
            "a whole number of particle spacings of " + text_of(spacing, "m") +
                " above the grid's lower corner " + text_of(scene.grid_lower[axis], "m"),
            text_of(edge, "m") + ", " + text_of(spacings_at(edge)) + " spacings above it");
  }
  return spacings_at(upper) - spacings_at(lower);
}

void check_ring(const Scene& scene, const Body& body, const std::string& place) {
  if (!body.ring) return;
  const Ring& ring = *body.ring;
  require(scene.dimension == 2, place, "no ring in one dimension", "one");
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    require_finite(ring.center[axis], at_index(place + "/center", axis), "length", "m");
  }
  require(std::isfinite(ring.inner_radius) && ring.inner_radius >= 0.0, place + "/inner_radius",
          "a radius, zero or above", text_of(ring.inner_radius, "m"));
  require(std::isfinite(ring.outer_radius) && ring.outer_radius > ring.inner_radius, place + "/outer_radius",
          "a radius above the inner one, " + text_of(ring.inner_radius, "m"),
          text_of(ring.outer_radius, "m"));
}

/// Whether particles are left is known only once the block's edges are.
void require_ring_hits(const Scene& scene, const Body& body, const std::string& place) {
  if (!body.ring) return;
  require(!lattice_of(scene, body).centers.empty(), place, "a ring with at least one particle center in it",
          "radii from " + text_of(body.ring->inner_radius, "m") + " to " +
              text_of(body.ring->outer_radius, "m") + ", which hold none of the block's");
}

void check_density_ramp(const Body& body, const std::string& place) {
  if (!body.density_ramp) return;
  const DensityRamp& ramp = *body.density_ramp;
  require(std::isfinite(ramp.start) && ramp.start >= 0.0, place + "/start", "a time, zero or above",
          text_of(ramp.start, "s"));
  require(!ramp.stages.empty(), place, "at least one stage", "none");
  for (std::size_t i = 0; i < ramp.stages.size(); ++i) {
    const std::string stage = i == 0 ? place : at_index(place + "/then", i - 1);
    require_positive(ramp.stages[i].density, stage + (i == 0 ? "/final_density" : "/density"), "a density", "kg/m^3");
    require_positive(ramp.stages[i].duration, stage + "/duration", "a time", "s");
  }
}

void check_geostatic(const Scene& scene, const Body& body, const GeostaticStress& stress,
                     const std::string& place) {
  const std::size_t vertical = axes_of(scene) - 1;
  require(std::isfinite(stress.surface) &&
              stress.surface >= body.upper[vertical] - whole_number_tolerance * scene.cell_size,
          place + "/surface",
          "a height not below the body's upper edge, " + text_of(body.upper[vertical], "m"),
          text_of(stress.surface, "m"));
  require(std::isfinite(stress.k0) && stress.k0 >= 0.0, place + "/k0", "a ratio, zero or above",
          text_of(stress.k0));
  for (std::size_t axis = 0; axis < vertical; ++axis) {
    require(scene.gravity.acceleration[axis] == 0.0, place + "/type",
            "a uniform stress where gravity is not along the last axis", "geostatic");
  }
}

void check_initial_stress(const Scene& scene, const Body& body, const std::string& place) {
  if (!body.initial_stress) return;
  require(!std::holds_alternative<ZhangElastic>(body.material) &&
              !std::holds_alternative<NeoHookean>(body.material),
          place, "no initial stress with a law whose stress follows from the deformation alone", "one");
  std::visit(Overloaded{[&](const UniformStress& stress) {
                          require_finite(stress.xx, place + "/xx", "pressure", "Pa");
                          require_finite(stress.yy, place + "/yy", "pressure", "Pa");
                          require_finite(stress.zz, place + "/zz", "pressure", "Pa");
                          require_finite(stress.xy, place + "/xy", "pressure", "Pa");
                        },
                        [&](const GeostaticStress& stress) { check_geostatic(scene, body, stress, place); }},
             *body.initial_stress);
}

void check_locking_control(const Scene& scene, const Body& body, const std::string& place) {
  require_known(body.locking_control, {LockingControl::none, LockingControl::cell_average}, place,
                "locking control");
  if (body.locking_control == LockingControl::none) return;
  require(scene.dimension == 2, place, "none in one dimension, where a particle can do nothing but dilate",
          "cell_average");
  require(!std::holds_alternative<NeoHookean>(body.material), place,
          "none with a law whose stress follows from the deformation gradient", "cell_average");
}

/// Returns the number of particles of the body's block.
double check_body(const Scene& scene, const Body& body, const std::string& place) {
  require(!body.name.empty(), place + "/name", "a name", "an empty text");
  require_positive(body.density, place + "/density", "a density", "kg/m^3");
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    require_finite(body.velocity[axis], at_index(place + "/velocity", axis), "velocity", "m/s");
  }
  check_density_ramp(body, place + "/density_ramp");
  if (body.inertia) {
    require_positive(*body.inertia, place + "/inertia", "a density", "kg/m^3");
    require(!scene.driven_motion, place + "/inertia", "none in a driven motion, whose forces go with the mass", "one");
  }
  check_material(scene, body, place + "/material");
  check_ring(scene, body, place + "/ring");
  double particles = 1.0;
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis)
    particles *= check_extent(scene, body, axis, place);
  require_few_particles(particles, place);
  require_ring_hits(scene, body, place + "/ring");
  check_initial_stress(scene, body, place + "/initial_stress");
  check_locking_control(scene, body, place + "/locking_control");
  return particles;
}

bool overlap(const Scene& scene, const Body& a, const Body& b) {
  const double slack = whole_number_tolerance * scene.cell_size;
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    if (a.upper[axis] <= b.lower[axis] + slack || b.upper[axis] <= a.lower[axis] + slack) return false;
  }
  return true;
}

void check_bodies(const Scene& scene) {
  require(!scene.bodies.empty(), "/bodies", "at least one body", "none");
  double particles = 0.0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const std::string place = at_index("/bodies", i);
    particles += check_body(scene, body, place);
    require_few_particles(particles, place);
    for (std::size_t j = 0; j < i; ++j) {
      const Body& other = scene.bodies[j];
      require(body.name != other.name, place + "/name", "a name no other body has",
              "\"" + body.name + "\", the name of body " + std::to_string(j));
      require(!overlap(scene, body, other), place, "a body clear of all others",
              "\"" + body.name + "\", which overlaps \"" + other.name + "\"");
    }
  }
}

/// Whether a rigid body's box holds nodes of an edge of the grid at the start.
bool holds_edge(const Scene& scene, const RigidBody& body, std::size_t axis, std::size_t side) {
  const double edge = side == 0 ? scene.grid_lower[axis] : scene.grid_upper[axis];
  const double slack = whole_number_tolerance * scene.cell_size;
  return body.lower[axis] <= edge + slack && body.upper[axis] >= edge - slack;
}

/// A node cannot both stand still with its edge and move with a body.
void check_against_edges(const Scene& scene, const RigidBody& body, const std::string& place) {
  for (std::size_t component = 0; component < axes_of(scene); ++component) {
    if (!body.constrains[component]) continue;
    if (body.velocity[component] == 0.0 && body.angular_velocity == 0.0) continue;
    for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
      for (const std::size_t side : {0u, 1u}) {
        const Condition condition = scene.edges[axis][side];
        const bool holds =
            condition == Condition::fixed || (condition == Condition::roller && axis == component);
        require(!holds || !holds_edge(scene, body, axis, side), at_index(place + "/velocity", component),
                "no motion along an axis in which an edge of the grid holds nodes of the body",
                text_of(body.velocity[component], "m/s") + ", where " + (axis == 0 ? "x" : "y") +
                    (side == 0 ? "_lower" : "_upper") + " is " +
                    (condition == Condition::fixed ? "fixed" : "roller"));
      }
    }
  }
}

/// The body holds a node at the start, or it would press on nothing.
void require_nodes(const Scene& scene, const RigidBody& body, const std::string& place) {
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    const double h = scene.cell_size;
    const double first =
        std::ceil((std::max(body.lower[axis], scene.grid_lower[axis]) - scene.grid_lower[axis]) / h -
                  whole_number_tolerance);
    const double last =
        std::floor((std::min(body.upper[axis], scene.grid_upper[axis]) - scene.grid_lower[axis]) / h +
                   whole_number_tolerance);
    require(first <= last, at_index(place + "/upper", axis), "a rigid body that holds a node of the grid",
            text_of(body.lower[axis], "m") + " to " + text_of(body.upper[axis], "m") + ", between two nodes");
    require(
        body.velocity[axis] == 0.0 || body.upper[axis] - body.lower[axis] >= h * (1 - whole_number_tolerance),
        at_index(place + "/upper", axis), "a body at least a cell thick along its motion, " + text_of(h, "m"),
        text_of(body.upper[axis] - body.lower[axis], "m"));
  }
}

void check_rigid_body(const Scene& scene, const RigidBody& body, const std::string& place) {
  require(!body.name.empty(), place + "/name", "a name", "an empty text");
  bool any = false;
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    require_finite(body.lower[axis], at_index(place + "/lower", axis), "length", "m");
    require_finite(body.upper[axis], at_index(place + "/upper", axis), "length", "m");
    require(body.upper[axis] > body.lower[axis], at_index(place + "/upper", axis),
            "a length above the lower corner's, " + text_of(body.lower[axis], "m"),
            text_of(body.upper[axis], "m"));
    require_finite(body.velocity[axis], at_index(place + "/velocity", axis), "velocity", "m/s");
    any = any || body.constrains[axis];
  }
  require(any, place + "/constrains", "at least one component", "none");
  require(std::isfinite(body.angular_velocity) && (scene.dimension == 2 || body.angular_velocity == 0.0),
          place + "/angular_velocity", scene.dimension == 2 ? "a finite rate" : "none in one dimension",
          text_of(body.angular_velocity, "rad/s"));
  require(std::isfinite(body.start) && body.start >= 0.0, place + "/start", "a time, zero or above",
          text_of(body.start, "s"));
  require(std::isfinite(body.ramp) && body.ramp >= 0.0, place + "/ramp", "a time, zero or above",
          text_of(body.ramp, "s"));
  require_nodes(scene, body, place);
  check_against_edges(scene, body, place);
}

void check_rigid_bodies(const Scene& scene) {
  for (std::size_t i = 0; i < scene.rigid_bodies.size(); ++i) {
    const RigidBody& body = scene.rigid_bodies[i];
    const std::string place = at_index("/rigid_bodies", i);
    check_rigid_body(scene, body, place);
    const auto has_its_name = [&](const auto& other) { return other.name == body.name; };
    const auto earlier = scene.rigid_bodies.begin() + static_cast<std::ptrdiff_t>(i);
    require(std::none_of(scene.bodies.begin(), scene.bodies.end(), has_its_name) &&
                std::none_of(scene.rigid_bodies.begin(), earlier, has_its_name),
            place + "/name", "a name no other body has", "\"" + body.name + "\"");
  }
}

void check_surface_load(const Scene& scene, const SurfaceLoad& load, const std::string& place) {
  const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                 [&](const Body& candidate) { return candidate.name == load.body; });
  require(body != scene.bodies.end(), place + "/body", "the name of a body", "\"" + load.body + "\"");
  require(!body->ring, place + "/body", "a whole block, which has straight edges",
          "\"" + load.body + "\", a ring");
  require(load.axis >= 0 && load.axis < scene.dimension && (load.side == 0 || load.side == 1),
          place + "/edge", "an edge of the body",
          "axis " + std::to_string(load.axis) + ", side " + std::to_string(load.side));
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    require_finite(load.traction[axis], at_index(place + "/traction", axis), "pressure", "Pa");
  }
  require(std::isfinite(load.ramp) && load.ramp >= 0.0, place + "/ramp", "a time, zero or above",
          text_of(load.ramp, "s"));
  if (scene.dimension == 1) return;
  const auto along = static_cast<std::size_t>(1 - load.axis);
  const double spacing = scene.cell_size / body->particles_per_cell[along];
  require_finite(load.begin, place + "/from", "length", "m");
  require(std::isfinite(load.end) &&
              std::min(load.end, body->upper[along]) - std::max(load.begin, body->lower[along]) >=
                  spacing * (1 - whole_number_tolerance),
          place + "/to",
          "a stretch of at least one particle, " + text_of(spacing, "m") + ", of the body's edge",
          text_of(load.begin, "m") + " to " + text_of(load.end, "m"));
}

void check_driven_motion(const Scene& scene) {
  if (!scene.driven_motion) return;
  require(scene.driven_motion->velocity && scene.driven_motion->body_force, "/driven_motion",
          "both a velocity and a body force", "one of them missing");
}

void check_loading(const Gravity& gravity) {
  const std::string place = "/gravity/loading";
  std::visit(
      Overloaded{[](const StepLoading&) {},
                 [&](const RampLoading& ramp) {
                   require_positive(ramp.duration, place + "/duration", "a duration", "s");
                 },
                 [&](const StagedLoading& staged) {
                   require_positive(staged.hold, place + "/hold", "a duration", "s");
                   require(!staged.fractions.empty(), place + "/fractions", "at least one stage", "none");
                   for (std::size_t i = 0; i < staged.fractions.size(); ++i) {
                     const double fraction = staged.fractions[i];
                     require(std::isfinite(fraction) && fraction >= 0.0, at_index(place + "/fractions", i),
                             "a fraction of full gravity, zero or above", text_of(fraction));
                   }
                 }},
      gravity.loading);
}

void check_gravity(const Scene& scene) {
  const Gravity& gravity = scene.gravity;
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    require_finite(gravity.acceleration[axis], at_index("/gravity/acceleration", axis), "acceleration",
                   "m/s^2");
  }
  require(std::isfinite(gravity.level) && gravity.level >= 0.0, "/gravity/level",
          "a multiple of the acceleration, zero or above", text_of(gravity.level));
  check_loading(gravity);
}

void check_time_step(const Scene& scene) {
  std::visit(
      Overloaded{[](const GivenTimeStep& given) {
                   require_positive(given.seconds, "/time_step/seconds", "a time", "s");
                 },
                 // Above 1 a run is expected to go wrong, which is worth studying; far above, it is a slip.
                 [](const StableFraction& stable) {
                   require(stable.fraction > 0.0 && stable.fraction <= largest_stable_fraction,
                           "/time_step/stable_fraction",
                           "a number above 0, at most " + text_of(largest_stable_fraction),
                           text_of(stable.fraction));
                 }},
      scene.time_step);
}

bool weightless(const Scene& scene) {
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    if (scene.gravity.level * scene.gravity.acceleration[axis] != 0.0) return false;
  }
  return true;
}

void check_rest(const Scene& scene, const AtRest& rest) {
  const std::string place = "/termination";
  require_positive(rest.unbalanced_force_ratio, place + "/unbalanced_force_ratio", "a ratio");
  require_positive(rest.kinetic_energy_ratio, place + "/kinetic_energy_ratio", "a ratio");
  require_positive(rest.deadline, place + "/deadline", "a time", "s");
  require(!weightless(scene), place + "/type",
          "at_time where gravity is zero: rest is measured against the weight", "at_rest");
  const double settled = loads_settled_after(scene);
  require(rest.deadline > settled, place + "/deadline",
          "a time after the loads have settled at " + text_of(settled, "s"), text_of(rest.deadline, "s"));
}

void check_displacement(const Scene& scene, const AtDisplacement& end) {
  const std::string place = "/termination";
  const bool known = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                 [&](const Body& candidate) { return candidate.name == end.body; });
  require(known, place + "/body", "the name of a body", "\"" + end.body + "\"");
  require(end.axis >= 0 && end.axis < scene.dimension, place + "/component", "an axis of the scene",
          "axis " + std::to_string(end.axis));
  require(std::isfinite(end.displacement) && end.displacement != 0.0, place + "/displacement",
          "a length other than zero", text_of(end.displacement, "m"));
  require_positive(end.deadline, place + "/deadline", "a time", "s");
}

void check_termination(const Scene& scene) {
  std::visit(
      Overloaded{[](const AtTime& end) { require_positive(end.time, "/termination/time", "a time", "s"); },
                 [&](const AtRest& rest) { check_rest(scene, rest); },
                 [&](const AtDisplacement& end) { check_displacement(scene, end); }},
      scene.termination);
}

std::size_t stage_at(const StagedLoading& staged, double time) {
  std::size_t stage = 0;
  while (stage + 1 < staged.fractions.size() && time >= staged.hold * static_cast<double>(stage + 1)) ++stage;
  return stage;
}

}  // namespace

double DensityRamp::end() const {
  return std::accumulate(stages.begin(), stages.end(), start,
                         [](double time, const DensityStage& stage) { return time + stage.duration; });
}

double DensityRamp::lowest_density() const {
  return std::min_element(stages.begin(), stages.end(), [](const DensityStage& a, const DensityStage& b) {
           return a.density < b.density;
         })->density;
}

double Body::density_at(double time) const {
  if (!density_ramp) return density;
  double begin = density_ramp->start, from = density;
  for (const DensityStage& stage : density_ramp->stages) {
    if (time < begin + stage.duration) {
      return from + std::max(time - begin, 0.0) / stage.duration * (stage.density - from);
    }
    begin += stage.duration;
    from = stage.density;
  }
  return from;
}

double Body::lightest() const {
  if (inertia) return *inertia;
  return density_ramp ? std::min(density, density_ramp->lowest_density()) : density;
}

double RigidBody::speed_fraction(double time) const {
  if (time < start) return 0.0;
  return ramp > 0.0 ? std::min((time - start) / ramp, 1.0) : 1.0;
}

double RigidBody::travel_time(double time) const {
  const double moving = std::max(time - start, 0.0);
  if (moving < ramp) return moving * moving / (2 * ramp);
  return moving - ramp / 2;
}

double Gravity::fraction(double time) const {
  return std::visit(
      Overloaded{[](const StepLoading&) { return 1.0; },
                 [&](const RampLoading& ramp) { return std::clamp(time / ramp.duration, 0.0, 1.0); },
                 [&](const StagedLoading& staged) { return staged.fractions[stage_at(staged, time)]; }},
      loading);
}

double Gravity::settled_after() const {
  return std::visit(Overloaded{[](const StepLoading&) { return 0.0; },
                               [](const RampLoading& ramp) { return ramp.duration; },
                               [](const StagedLoading& staged) {
                                 std::size_t last = staged.fractions.size() - 1;
                                 while (last > 0 && staged.fractions[last - 1] == staged.fractions[last])
                                   --last;
                                 return staged.hold * static_cast<double>(last);
                               }},
                    loading);
}

double loads_settled_after(const Scene& scene) {
  double latest = scene.gravity.settled_after();
  for (const SurfaceLoad& load : scene.surface_loads) latest = std::max(latest, load.ramp);
  for (const Body& body : scene.bodies) {
    if (body.density_ramp) latest = std::max(latest, body.density_ramp->end());
  }
  for (const RigidBody& body : scene.rigid_bodies) latest = std::max(latest, body.start + body.ramp);
  return latest;
}

double latest_end(const Scene& scene) {
  return std::visit(Overloaded{[](const AtTime& end) { return end.time; },
                               [](const auto& end) { return end.deadline; }},
                    scene.termination);
}

void check(const Scene& scene) {
  check_method(scene);
  check_grid(scene);
  check_gravity(scene);  // before the bodies, whose initial stress it makes
  check_bodies(scene);
  check_rigid_bodies(scene);
  for (std::size_t i = 0; i < scene.surface_loads.size(); ++i) {
    check_surface_load(scene, scene.surface_loads[i], at_index("/surface_loads", i));
  }
  check_driven_motion(scene);
  check_time_step(scene);
  check_termination(scene);
}

Scene from_grid_corner(Scene scene) {
  const PerAxis corner = scene.grid_lower;
  const auto move = [&](PerAxis& place) {
    for (std::size_t a = 0; a < place.size(); ++a) place[a] -= corner[a];
  };
  const auto vertical = static_cast<std::size_t>(scene.dimension - 1);
  move(scene.grid_lower);
  move(scene.grid_upper);
  for (Body& body : scene.bodies) {
    move(body.lower);
    move(body.upper);
    if (body.ring) move(body.ring->center);
    if (!body.initial_stress) continue;
    if (auto* ground = std::get_if<GeostaticStress>(&*body.initial_stress)) ground->surface -= corner[vertical];
  }
  for (RigidBody& body : scene.rigid_bodies) {
    move(body.lower);
    move(body.upper);
  }
  for (SurfaceLoad& load : scene.surface_loads) {
    const double along = corner[static_cast<std::size_t>(1 - load.axis)];
    load.begin -= along;
    load.end -= along;
  }
  if (scene.driven_motion) {
    const auto seen_from = [corner](const PerAxis& place) {
      PerAxis moved = place;
      for (std::size_t a = 0; a < moved.size(); ++a) moved[a] += corner[a];
      return moved;
    };
    const auto of_corner = [&](auto& function) {
      function = [inner = std::move(function), seen_from](const PerAxis& place, double time) {
        return inner(seen_from(place), time);
      };
    };
    of_corner(scene.driven_motion->velocity);
    of_corner(scene.driven_motion->body_force);
  }
  return scene;
}

}  // namespace mpm
