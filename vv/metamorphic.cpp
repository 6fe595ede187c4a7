#include "vv/metamorphic.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace mpm::vv {

namespace {

/// Cells of the enlarged grid of a shift, at most: a few GB.
constexpr double most_cells = 2e7;

struct Interval {
  double lower, upper;
};

/// A change of description: axis i of the new one is axis `from[i]` of the original, turned round where
/// `sign[i]` is negative. x' = length * sign * x + offset + boost * t', t' = time * t, m' = mass * m.
struct Change {
  std::array<std::size_t, max_dimension> from{0, 1};
  PerAxis sign{1.0, 1.0};
  double length = 1.0, mass = 1.0, time = 1.0;
  PerAxis offset{};  ///< in new units, as the boost
  PerAxis boost{};

  double velocity() const { return length / time; }
  double acceleration() const { return length / (time * time); }
  double stress() const { return mass / (length * time * time); }
  double density() const { return mass / (length * length * length); }
  double volume(int dimension) const { return dimension == 1 ? length : length * length; }
  /// 1 for a turn, -1 for a reflection.
  double handedness() const { return sign[0] * sign[1] * (from[0] == 0 ? 1.0 : -1.0); }
  bool turns(std::size_t axis) const { return from[axis] != axis || sign[axis] < 0; }

  /// A vector whose unit grows by `factor`.
  PerAxis vector(const PerAxis& original, double factor) const {
    return {factor * sign[0] * original[from[0]], factor * sign[1] * original[from[1]]};
  }
  PerAxis vector_back(const PerAxis& changed, double factor) const {
    PerAxis original{};
    for (std::size_t i = 0; i < max_dimension; ++i) original[from[i]] = sign[i] * changed[i] / factor;
    return original;
  }
  PerAxis place(const PerAxis& original) const {
    const PerAxis scaled = vector(original, length);
    return {scaled[0] + offset[0], scaled[1] + offset[1]};
  }
  PerAxis place_back(const PerAxis& changed) const {
    return vector_back({changed[0] - offset[0], changed[1] - offset[1]}, length);
  }
  PerAxis velocity_of(const PerAxis& original) const {
    const PerAxis scaled = vector(original, velocity());
    return {scaled[0] + boost[0], scaled[1] + boost[1]};
  }
  /// What was [lower, upper] along the original axis that is now `axis`.
  Interval interval(const Interval& original, std::size_t axis) const {
    const double a = length * sign[axis] * original.lower + offset[axis],
                 b = length * sign[axis] * original.upper + offset[axis];
    return {std::min(a, b), std::max(a, b)};
  }
  template <class Value>
  std::array<Value, max_dimension> by_axis(const std::array<Value, max_dimension>& original) const {
    return {original[from[0]], original[from[1]]};
  }
};

/// The same change of a box's two corners.
void change_box(const Change& change, PerAxis& lower, PerAxis& upper) {
  const PerAxis first = change.place(lower), second = change.place(upper);
  for (std::size_t axis = 0; axis < max_dimension; ++axis) {
    lower[axis] = std::min(first[axis], second[axis]);
    upper[axis] = std::max(first[axis], second[axis]);
  }
}

Material changed(const Change& change, Material material) {
  std::visit(
      [&](auto& law) {
        law.youngs_modulus *= change.stress();
        if constexpr (std::is_same_v<std::decay_t<decltype(law)>, MohrCoulomb>)
          law.cohesion *= change.stress();
      },
      material);
  return material;
}

InitialStress changed(const Change& change, const InitialStress& stress, int dimension) {
  const double factor = change.stress();
  if (const auto* uniform = std::get_if<UniformStress>(&stress)) {
    const auto normal = change.by_axis<double>({uniform->xx, uniform->yy});
    return UniformStress{factor * normal[0], factor * normal[1], factor * uniform->zz,
                         factor * change.sign[0] * change.sign[1] * uniform->xy};
  }
  const auto& ground = std::get<GeostaticStress>(stress);
  const auto vertical = static_cast<std::size_t>(dimension - 1);
  return GeostaticStress{change.length * ground.surface + change.offset[vertical], ground.k0};
}

Body changed(const Change& change, Body body, int dimension) {
  change_box(change, body.lower, body.upper);
  if (body.ring) {
    body.ring->center = change.place(body.ring->center);
    body.ring->inner_radius *= change.length;
    body.ring->outer_radius *= change.length;
  }
  body.particles_per_cell = change.by_axis(body.particles_per_cell);
  body.density *= change.density();
  if (body.density_ramp) {
    body.density_ramp->start *= change.time;
    for (DensityStage& stage : body.density_ramp->stages) {
      stage.density *= change.density();
      stage.duration *= change.time;
    }
  }
  if (body.inertia) *body.inertia *= change.density();
  body.velocity = change.velocity_of(body.velocity);
  if (body.initial_stress) body.initial_stress = changed(change, *body.initial_stress, dimension);
  body.material = changed(change, body.material);
  return body;
}

bool at_rest(const RigidBody& body) { return body.velocity == PerAxis{} && body.angular_velocity == 0.0; }

RigidBody changed(const Change& change, RigidBody body) {
  // What never moves has no beginning, and a common motion must not wait for one.
  if (at_rest(body)) body.start = body.ramp = 0.0;
  change_box(change, body.lower, body.upper);
  body.constrains = change.by_axis(body.constrains);
  body.velocity = change.velocity_of(body.velocity);
  body.angular_velocity *= change.handedness() / change.time;
  body.start *= change.time;
  body.ramp *= change.time;
  return body;
}

SurfaceLoad changed(const Change& change, SurfaceLoad load) {
  const auto axis = static_cast<std::size_t>(load.axis);
  const std::size_t normal = change.from[0] == axis ? 0 : 1;
  load.axis = static_cast<int>(normal);
  if (change.sign[normal] < 0) load.side = 1 - load.side;
  const Interval stretch = change.interval({load.begin, load.end}, 1 - normal);
  load.begin = stretch.lower;
  load.end = stretch.upper;
  load.traction = change.vector(load.traction, change.stress());
  load.ramp *= change.time;
  return load;
}

DrivenMotion changed(const Change& change, const DrivenMotion& motion) {
  return {[change, velocity = motion.velocity](const PerAxis& place, double time) {
            return change.velocity_of(velocity(change.place_back(place), time / change.time));
          },
          [change, force = motion.body_force](const PerAxis& place, double time) {
            return change.vector(force(change.place_back(place), time / change.time), change.acceleration());
          }};
}

Gravity changed(const Change& change, Gravity gravity) {
  gravity.acceleration = change.vector(gravity.acceleration, change.acceleration());
  if (auto* ramp = std::get_if<RampLoading>(&gravity.loading)) ramp->duration *= change.time;
  if (auto* staged = std::get_if<StagedLoading>(&gravity.loading)) staged->hold *= change.time;
  return gravity;
}

AtDisplacement changed(const Change& change, AtDisplacement end) {
  PerAxis displacement{};
  displacement[static_cast<std::size_t>(end.axis)] = end.displacement;
  displacement = change.vector(displacement, change.length);
  end.axis = displacement[0] != 0.0 ? 0 : 1;
  end.displacement = displacement[static_cast<std::size_t>(end.axis)];
  end.deadline *= change.time;
  return end;
}

Scene changed(const Change& change, Scene scene) {
  scene.cell_size *= change.length;
  change_box(change, scene.grid_lower, scene.grid_upper);
  scene.edges = change.by_axis(scene.edges);
  for (std::size_t axis = 0; axis < max_dimension; ++axis)
    if (change.sign[axis] < 0) std::swap(scene.edges[axis][0], scene.edges[axis][1]);
  for (Body& body : scene.bodies) body = changed(change, std::move(body), scene.dimension);
  for (RigidBody& body : scene.rigid_bodies) body = changed(change, std::move(body));
  for (SurfaceLoad& load : scene.surface_loads) load = changed(change, std::move(load));
  if (scene.driven_motion) scene.driven_motion = changed(change, *scene.driven_motion);
  scene.gravity = changed(change, std::move(scene.gravity));
  if (auto* given = std::get_if<GivenTimeStep>(&scene.time_step)) given->seconds *= change.time;
  if (auto* end = std::get_if<AtTime>(&scene.termination)) end->time *= change.time;
  if (auto* rest = std::get_if<AtRest>(&scene.termination)) rest->deadline *= change.time;
  if (auto* end = std::get_if<AtDisplacement>(&scene.termination)) *end = changed(change, *end);
  return scene;
}

bool is_shift(const std::string& metamorphosis) { return metamorphosis == "shift"; }

double time_step_of(const Scene& scene) { return Simulation(scene).time_step(); }

/// The cells that a shift goes through, and one to spare.
double cells_of_travel(const Scene& scene) {
  return std::ceil(std::get<AtTime>(scene.termination).time / time_step_of(scene)) + 1;
}

/// The same bodies in the same order, if not in the same terms.
Change change_of(const std::string& metamorphosis, const Scene& scene) {
  Change change;
  if (metamorphosis == "mirror_x") {
    change.sign = {-1.0, 1.0};
  } else if (metamorphosis == "swap_axes") {
    change.from = {1, 0};
  } else if (metamorphosis == "rotate_90") {
    change.from = {1, 0};
    change.sign = {-1.0, 1.0};
  } else if (metamorphosis == "translate") {
    change.offset = {7 * scene.cell_size, -3 * scene.cell_size};
  } else if (is_shift(metamorphosis)) {
    change.boost = {scene.cell_size / time_step_of(scene), 0.0};
  } else if (metamorphosis == "units") {
    change.length = 1e3;
    change.mass = 1e-3;
    change.time = 1e3;
  } else if (metamorphosis == "binary_units") {
    change.length = 1024.0;
    change.mass = 1.0 / 2048.0;
    change.time = 128.0;
  }
  return change;
}

/// The bodies of a scene, cut and in reverse, and which one of the scene each was part of.
struct Parts {
  std::vector<Body> bodies;
  std::vector<std::size_t> wholes;
};

double spacing_of(const Scene& scene, const Body& body, std::size_t axis) {
  return scene.cell_size / body.particles_per_cell[axis];
}

/// Where a block is cut: between its two middle columns of particles; its upper edge if it has only one.
double cut_of(const Scene& scene, const Body& body) {
  const double spacing = spacing_of(scene, body, 0);
  const auto columns = std::llround((body.upper[0] - body.lower[0]) / spacing);
  if (body.ring || columns < 2) return body.upper[0];
  return body.lower[0] + static_cast<double>(columns / 2) * spacing;
}

bool is_cut(const Scene& scene, const Body& body) { return cut_of(scene, body) < body.upper[0]; }

Parts parts_of(const Scene& scene) {
  Parts parts;
  for (std::size_t i = scene.bodies.size(); i-- > 0;) {
    const Body& body = scene.bodies[i];
    Body left = body, right = body;
    left.upper[0] = right.lower[0] = cut_of(scene, body);
    if (is_cut(scene, body)) {
      right.name += " (right)";
      left.name += " (left)";
      parts.bodies.push_back(right);
      parts.wholes.push_back(i);
    }
    parts.bodies.push_back(left);
    parts.wholes.push_back(i);
  }
  return parts;
}

/// Appends what of a load lies on one part of its body, if anything.
void add_part_of(const SurfaceLoad& load, const Scene& scene, const Body& whole, const Body& part,
                 std::vector<SurfaceLoad>& loads) {
  SurfaceLoad own = load;
  own.body = part.name;
  const auto normal = static_cast<std::size_t>(load.axis);
  if (normal == 0) {
    const double edge = load.side == 0 ? whole.lower[0] : whole.upper[0];
    if ((load.side == 0 ? part.lower[0] : part.upper[0]) == edge) loads.push_back(own);
    return;
  }
  // From the first to the last column of particles whose centers are loaded, edge to edge.
  const double spacing = spacing_of(scene, whole, 0);
  const auto column = [&](double place) { return (place - whole.lower[0]) / spacing; };
  const double first = std::max(std::ceil(column(load.begin) - 0.5), std::round(column(part.lower[0])));
  const double last = std::min(std::floor(column(load.end) - 0.5) + 1, std::round(column(part.upper[0])));
  if (last <= first) return;
  own.begin = whole.lower[0] + first * spacing;
  own.end = whole.lower[0] + last * spacing;
  loads.push_back(own);
}

Scene split(Scene scene) {
  const Parts parts = parts_of(scene);
  std::vector<SurfaceLoad> loads;
  for (const SurfaceLoad& load : scene.surface_loads)
    for (std::size_t i = 0; i < parts.bodies.size(); ++i) {
      const Body& whole = scene.bodies[parts.wholes[i]];
      if (whole.name == load.body) add_part_of(load, scene, whole, parts.bodies[i], loads);
    }
  scene.bodies = parts.bodies;
  scene.surface_loads = loads;
  return scene;
}

std::string why_not_shifted(const Scene& scene) {
  if (scene.edges[0] != std::array{Condition::free, Condition::free})
    return "the edges across x hold the material";
  if (scene.dimension == 2)
    for (Condition condition : scene.edges[1])
      if (condition == Condition::fixed) return "an edge along x holds the material back";
  if (scene.damping > 0) return "local damping works against the motion as the grid sees it";
  if (!std::holds_alternative<AtTime>(scene.termination)) return "the common motion would change when the run ends";
  if (scene.precision != Precision::float64)
    return "single precision cannot tell the motion from the common one";
  for (const RigidBody& body : scene.rigid_bodies)
    if (!at_rest(body) && (body.start > 0 || body.ramp > 0))
      return "the rigid body \"" + body.name + "\" starts from rest";
  double cells = cells_of_travel(scene) + (scene.grid_upper[0] - scene.grid_lower[0]) / scene.cell_size;
  if (scene.dimension == 2) cells *= (scene.grid_upper[1] - scene.grid_lower[1]) / scene.cell_size;
  if (cells > most_cells) return "the grid would be too long";
  return "";
}

bool has_geostatic_stress(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) {
    return body.initial_stress && std::holds_alternative<GeostaticStress>(*body.initial_stress);
  });
}

const Metamorphosis& known(const std::string& metamorphosis) {
  for (const Metamorphosis& entry : metamorphosis_catalogue())
    if (entry.name == metamorphosis) return entry;
  throw std::invalid_argument("no metamorphosis is called " + metamorphosis);
}

void require_suited(const std::string& metamorphosis, const Scene& scene) {
  const std::string reason = why_not_describable(metamorphosis, scene);
  if (!reason.empty()) throw std::invalid_argument(metamorphosis + " does not suit the scene: " + reason);
}

/// Applies `change_one(vector)` to the vector of each particle.
template <class ChangeOne>
void for_each_vector(std::vector<double>& field, std::size_t dimension, const ChangeOne& change_one) {
  for (std::size_t first = 0; first < field.size(); first += dimension) {
    PerAxis vector{};
    for (std::size_t a = 0; a < dimension; ++a) vector[a] = field[first + a];
    vector = change_one(vector);
    for (std::size_t a = 0; a < dimension; ++a) field[first + a] = vector[a];
  }
}

void stress_back(const Change& change, std::vector<double>& field, std::size_t dimension, double factor) {
  if (dimension == 2)
    for (std::size_t first = 0; first < field.size(); first += 4) {
      if (change.from[0] == 1) std::swap(field[first], field[first + 1]);
      field[first + 3] *= change.sign[0] * change.sign[1];
    }
  for (double& component : field) component /= factor;
}

void deformation_back(const Change& change, std::vector<double>& field, std::size_t dimension) {
  if (dimension == 1) return;
  for (std::size_t first = 0; first < field.size(); first += 4) {
    const std::array<double, 4> f{field[first], field[first + 1], field[first + 2], field[first + 3]};
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j)
        field[first + 2 * change.from[i] + change.from[j]] = change.sign[i] * change.sign[j] * f[2 * i + j];
  }
}

ParticleFields changed_back(const Change& change, ParticleFields fields, double time) {
  const auto dimension = static_cast<std::size_t>(fields.dimension);
  const PerAxis travel{change.boost[0] * time, change.boost[1] * time};
  const auto without = [](const PerAxis& vector, const PerAxis& common) {
    return PerAxis{vector[0] - common[0], vector[1] - common[1]};
  };
  for_each_vector(fields.initial_position, dimension,
                  [&](const PerAxis& place) { return change.place_back(place); });
  for_each_vector(fields.position, dimension,
                  [&](const PerAxis& place) { return change.place_back(without(place, travel)); });
  for_each_vector(fields.displacement, dimension, [&](const PerAxis& displacement) {
    return change.vector_back(without(displacement, travel), change.length);
  });
  for_each_vector(fields.velocity, dimension, [&](const PerAxis& velocity) {
    return change.vector_back(without(velocity, change.boost), change.velocity());
  });
  for_each_vector(fields.half_size, dimension, [&](const PerAxis& half_size) {
    const PerAxis signed_half = change.vector_back(half_size, change.length);
    return PerAxis{std::abs(signed_half[0]), std::abs(signed_half[1])};
  });
  stress_back(change, fields.stress, dimension, change.stress());
  stress_back(change, fields.strain, dimension, 1.0);
  deformation_back(change, fields.deformation_gradient, dimension);
  const double volume = change.volume(fields.dimension);
  for (double& value : fields.stress_work) value /= change.stress() * volume;
  for (double& value : fields.volume) value /= volume;
  for (double& value : fields.initial_volume) value /= volume;
  for (double& value : fields.mass) value /= change.density() * volume;
  return fields;
}

using Bin = std::array<std::int64_t, max_dimension>;

/// Finds particles by where they were initially.
class Places {
 public:
  explicit Places(const ParticleFields& fields) : fields_(fields) {
    const double smallest = *std::min_element(fields.initial_volume.begin(), fields.initial_volume.end());
    spacing_ = fields.dimension == 1 ? smallest : std::sqrt(smallest);
    for (std::size_t p = 0; p < fields.mass.size(); ++p) bins_.emplace(bin_of(place_of(fields, p)), p);
  }

  /// The particle at the initial place of particle `p` of `other`.
  std::size_t match(const ParticleFields& other, std::size_t p) const {
    const PerAxis place = place_of(other, p);
    const Bin bin = bin_of(place);
    for (std::int64_t i = bin[0] - 1; i <= bin[0] + 1; ++i)
      for (std::int64_t j = bin[1] - 1; j <= bin[1] + 1; ++j) {
        const auto [begin, end] = bins_.equal_range({i, j});
        for (auto candidate = begin; candidate != end; ++candidate) {
          const PerAxis found = place_of(fields_, candidate->second);
          if (std::hypot(found[0] - place[0], found[1] - place[1]) < 1e-3 * spacing_)
            return candidate->second;
        }
      }
    throw std::invalid_argument("particle " + std::to_string(p) + " has no counterpart at its initial place");
  }

 private:
  static PerAxis place_of(const ParticleFields& fields, std::size_t p) {
    const auto dimension = static_cast<std::size_t>(fields.dimension);
    PerAxis place{};
    for (std::size_t a = 0; a < dimension; ++a) place[a] = fields.initial_position[p * dimension + a];
    return place;
  }
  Bin bin_of(const PerAxis& place) const {
    return {std::llround(place[0] / spacing_), std::llround(place[1] / spacing_)};
  }

  const ParticleFields& fields_;
  double spacing_;
  std::multimap<Bin, std::size_t> bins_;
};

/// The largest difference of one field over its largest magnitude; `match[p]` is the particle of b that is p
/// of a.
double difference_of(const std::vector<double>& a, const std::vector<double>& b,
                     const std::vector<std::size_t>& match) {
  const std::size_t components = a.size() / match.size();
  double difference = 0.0, magnitude = 0.0;
  for (std::size_t p = 0; p < match.size(); ++p)
    for (std::size_t c = 0; c < components; ++c) {
      const double mine = a[p * components + c], other = b[match[p] * components + c];
      if (!std::isfinite(mine) || !std::isfinite(other)) return std::numeric_limits<double>::infinity();
      difference = std::max(difference, std::abs(mine - other));
      magnitude = std::max({magnitude, std::abs(mine), std::abs(other)});
    }
  return difference > 0.0 ? difference / magnitude : 0.0;
}

}  // namespace

const std::vector<Metamorphosis>& metamorphosis_catalogue() {
  static const std::vector<Metamorphosis> catalogue = {
      {"mirror_x", "seen in a mirror: x turned round"},
      {"swap_axes", "x and y exchanged, a reflection too"},
      {"rotate_90", "turned anticlockwise by a quarter"},
      {"translate", "grid and bodies moved by whole cells"},
      {"shift", "everything in motion along x by one cell per time step"},
      {"units", "in mm, t and ms instead of m, kg and s"},
      {"binary_units", "in units that are powers of two of m, kg and s", true},
      {"split", "blocks cut in two, bodies listed in reverse"},
  };
  return catalogue;
}

std::string why_not_describable(const std::string& metamorphosis, const Scene& scene) {
  known(metamorphosis);
  if (scene.dimension == 1 && (metamorphosis == "swap_axes" || metamorphosis == "rotate_90"))
    return "there is only one axis";
  if (metamorphosis == "split") {
    if (std::holds_alternative<AtDisplacement>(scene.termination))
      return "the body whose displacement ends the run would be in parts";
    const bool any = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                 [&](const Body& body) { return is_cut(scene, body); });
    return any || scene.bodies.size() > 1 ? "" : "there is nothing to cut or to reorder";
  }
  if (is_shift(metamorphosis)) return why_not_shifted(scene);
  const auto vertical = static_cast<std::size_t>(scene.dimension - 1);
  if (has_geostatic_stress(scene) && change_of(metamorphosis, scene).turns(vertical))
    return "the stress of level ground at rest is that of gravity down the last axis";
  return "";
}

Scene transformed(const Scene& scene, const std::string& metamorphosis) {
  require_suited(metamorphosis, scene);
  if (metamorphosis == "split") return split(scene);
  Scene result = changed(change_of(metamorphosis, scene), scene);
  if (is_shift(metamorphosis)) {
    result.grid_upper[0] += cells_of_travel(scene) * scene.cell_size;
    result.time_step = GivenTimeStep{time_step_of(scene)};
  }
  return result;
}

ParticleFields mapped_back(const Scene& original, const ParticleFields& of_the_transformed, double time,
                           const std::string& metamorphosis) {
  require_suited(metamorphosis, original);
  if (of_the_transformed.dimension != original.dimension)
    throw std::invalid_argument("the particles are of another dimension than the scene");
  ParticleFields fields = changed_back(change_of(metamorphosis, original), of_the_transformed, time);
  if (metamorphosis == "split") {
    const Parts parts = parts_of(original);
    for (std::size_t& body : fields.body) body = parts.wholes.at(body);
  }
  return fields;
}

double largest_difference(const ParticleFields& a, const ParticleFields& b) {
  if (a.dimension != b.dimension || a.mass.size() != b.mass.size())
    throw std::invalid_argument("the numbers of dimensions or particles differ");
  if (a.mass.empty()) return 0.0;
  const Places places(b);
  std::vector<std::size_t> match;
  for (std::size_t p = 0; p < a.mass.size(); ++p) match.push_back(places.match(a, p));
  return std::max({difference_of(a.displacement, b.displacement, match),
                   difference_of(a.velocity, b.velocity, match), difference_of(a.stress, b.stress, match),
                   difference_of(a.volume, b.volume, match)});
}

}  // namespace mpm::vv
