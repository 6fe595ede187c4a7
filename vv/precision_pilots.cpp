#include "vv/precision_pilots.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <stdexcept>

#include "solver/error.hpp"

namespace mpm::vv {
namespace {

constexpr int coarse = 2, coarsest = 4;
/// Of the difference of solutions on cells of 4 h and 2 h, what is left at h in second order: 1 / (4 (4 -
/// 1)).
constexpr double left_of_difference = 1.0 / 12;
/// How much more rounding there may be on cells half as large. Seen of stress: 1.3 to 7.2 times as much.
constexpr double growth_of_rounding = 8.0;
/// Between two beats of the pulse.
constexpr std::int64_t particle_steps_per_beat = 1 << 16;

std::string text_of(Precision precision) { return precision == Precision::float32 ? "float" : "double"; }

/// Body and cell of the largest pilot's grid.
using Place = std::array<std::int64_t, 1 + max_dimension>;

struct Content {
  double volume = 0.0;
  std::vector<double> displacement, stress;  ///< sums, by volume, of each component
};

using Cells = std::map<Place, Content>;

Cells cells_of(const ParticleFields& fields, const PerAxis& lower, double cell_size) {
  const auto dimension = static_cast<std::size_t>(fields.dimension);
  const std::size_t particles = fields.mass.size();
  Cells cells;
  for (std::size_t p = 0; p < particles; ++p) {
    Place place{static_cast<std::int64_t>(fields.body[p])};
    for (std::size_t axis = 0; axis < dimension; ++axis) {
      const double along = fields.initial_position[p * dimension + axis] - lower[axis];
      place[1 + axis] = static_cast<std::int64_t>(std::floor(along / cell_size));
    }
    Content& content = cells[place];
    const double volume = fields.initial_volume[p];
    content.volume += volume;
    const auto add = [&](std::vector<double>& sums, const std::vector<double>& field) {
      const std::size_t components = field.size() / particles;
      sums.resize(components);
      for (std::size_t c = 0; c < components; ++c) sums[c] += volume * field[p * components + c];
    };
    add(content.displacement, fields.displacement);
    add(content.stress, fields.stress);
  }
  return cells;
}

/// A sum over the cells of squares of a mean's components, by volume.
template <class Component>
double norm_of(const Cells& cells, std::vector<double> Content::*field, Component&& component) {
  double sum = 0.0;
  for (const auto& [place, content] : cells) {
    for (std::size_t c = 0; c < (content.*field).size(); ++c) {
      const double mean = component(place, content, c);
      sum += content.volume * mean * mean;
    }
  }
  return std::sqrt(sum);
}

/// In L2, relative to `truth`. Both have the same cells.
double distance(const Cells& found, const Cells& truth, std::vector<double> Content::*field) {
  const auto mean = [&](const Content& content, std::size_t c) {
    return (content.*field)[c] / content.volume;
  };
  const double size =
      norm_of(truth, field, [&](const Place&, const Content& own, std::size_t c) { return mean(own, c); });
  const double difference = norm_of(truth, field, [&](const Place& place, const Content& own, std::size_t c) {
    return mean(found.at(place), c) - mean(own, c);
  });
  return difference / size;
}

bool same_places(const Cells& a, const Cells& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& one, const auto& other) { return one.first == other.first; });
}

/// Why no pilots were run, or nothing came of them.
class NoVerdict : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Three runs and what they cost.
class Pilots {
 public:
  Pilots(const RunRequest& request, const Pulse& pulse) : request_(request), pulse_(pulse) {}

  /// Fills in what was found. Throws NoVerdict.
  void run(std::map<std::string, double>& numbers) {
    const Cells fine = end_of(coarse, Precision::float64), rounded = end_of(coarse, Precision::float32),
                rough = end_of(coarsest, Precision::float64);
    if (!same_places(fine, rounded) || !same_places(fine, rough))
      throw NoVerdict("its bodies do not fill the same cells on larger ones");
    for (const auto& [name, field] :
         {std::pair("displacement", &Content::displacement), std::pair("stress", &Content::stress)}) {
      const double discretisation = left_of_difference * distance(rough, fine, field);
      const double rounding = growth_of_rounding * distance(rounded, fine, field);
      numbers[std::string("discretisation_of_") + name] = discretisation;
      numbers[std::string("rounding_of_") + name] = rounding;
      numbers[std::string("share_of_") + name] = rounding / discretisation;
    }
  }

  double particle_steps() const { return particle_steps_; }

 private:
  Cells end_of(int factor, Precision precision) {
    Scene scene = on_larger_cells(request_.scene, factor);
    scene.precision = precision;
    Simulation simulation(scene, request_.threads);
    const std::int64_t particles = simulation.particle_count();
    const std::int64_t steps_per_beat = std::max<std::int64_t>(1, particle_steps_per_beat / particles);
    std::int64_t reported = 0;
    const auto beat = [&] {
      const std::int64_t fresh = (simulation.steps() - reported) * particles;
      reported = simulation.steps();
      particle_steps_ += static_cast<double>(fresh);
      if (pulse_ && !pulse_(fresh)) throw Abandoned();
    };
    while (simulation.advance()) {
      if (simulation.steps() - reported >= steps_per_beat) beat();
    }
    beat();
    if (!simulation.outcome().completed())
      throw NoVerdict("the pilot in " + text_of(precision) + " on cells " + std::to_string(factor) +
                      " times as large ended " + name_of(simulation.outcome().ending));
    return cells_of(simulation.particles(), scene.grid_lower, coarsest * request_.scene.cell_size);
  }

  const RunRequest& request_;
  const Pulse& pulse_;
  double particle_steps_ = 0.0;
};

/// Whether pilots cost little beside what float saves: their work is that of the run over 2^(dimension + 1),
/// twice, and over 4^(dimension + 1).
void require_worth_it(const Scene& scene) {
  if (scene.dimension == 1)
    throw NoVerdict("in one dimension pilots take half as long as the run, more than float saves");
}

/// Larger of the two shares; infinite if one is not a number.
double largest_share(const std::map<std::string, double>& numbers) {
  const double a = numbers.at("share_of_displacement"), b = numbers.at("share_of_stress");
  return std::isnan(a) || std::isnan(b) ? INFINITY : std::max(a, b);
}

bool on_larger_nodes(const Scene& scene, double place, std::size_t axis, double cell_size) {
  if (place <= scene.grid_lower[axis] || place >= scene.grid_upper[axis]) return true;
  const double cells = (place - scene.grid_lower[axis]) / cell_size;
  return std::abs(cells - std::round(cells)) < 1e-6;
}

/// What would be another scene on larger cells, beside what `check` says.
void require_alike(const Scene& scene, double cell_size) {
  for (const Body& body : scene.bodies) {
    if (body.ring) throw std::invalid_argument("the ring " + body.name + " has another outline");
  }
  for (const RigidBody& body : scene.rigid_bodies) {
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimension); ++axis) {
      if (!on_larger_nodes(scene, body.lower[axis], axis, cell_size) ||
          !on_larger_nodes(scene, body.upper[axis], axis, cell_size))
        throw std::invalid_argument("the rigid body " + body.name + " has its edges between the nodes");
    }
  }
  for (const SurfaceLoad& load : scene.surface_loads) {
    if (scene.dimension == 1) continue;
    const auto along = static_cast<std::size_t>(1 - load.axis);
    if (!on_larger_nodes(scene, load.begin, along, cell_size) ||
        !on_larger_nodes(scene, load.end, along, cell_size))
      throw std::invalid_argument("the load on " + load.body + " ends between the nodes");
  }
}

}  // namespace

Scene on_larger_cells(const Scene& scene, int factor) {
  Scene larger = scene;
  larger.cell_size = factor * scene.cell_size;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimension); ++axis) {
    if (scene.edges[axis][1] != Condition::free) continue;
    const double cells = (scene.grid_upper[axis] - scene.grid_lower[axis]) / larger.cell_size;
    larger.grid_upper[axis] = scene.grid_lower[axis] + std::ceil(cells - 1e-6) * larger.cell_size;
  }
  if (auto* given = std::get_if<GivenTimeStep>(&larger.time_step)) given->seconds *= factor;
  require_alike(scene, larger.cell_size);
  check(larger);
  return larger;
}

ModelChoice choose_precision(const RunRequest& request, const Pulse& pulse) {
  using Clock = std::chrono::steady_clock;
  ModelChoice choice{.what = "precision", .written = text_of(request.scene.precision), .used = "double", .reason = ""};
  const auto began = Clock::now();
  Pilots pilots(request, pulse);
  try {
    require_worth_it(request.scene);
    pilots.run(choice.numbers);
    const bool is_enough = largest_share(choice.numbers) <= allowed_rounding_share;
    choice.used = is_enough ? "float" : "double";
    choice.reason =
        is_enough ? "pilots show that float adds at most a tenth of the error that the cells make"
                  : "pilots do not show that float adds at most a tenth of the error that the cells make";
  } catch (const NoVerdict& reason) {
    choice.reason = std::string("no verdict by pilots: ") + reason.what();
  } catch (const SceneError& error) {
    choice.reason = std::string("no verdict by pilots: on larger cells ") + error.what();
  } catch (const std::invalid_argument& error) {
    choice.reason = std::string("no verdict by pilots: on larger cells ") + error.what();
  }
  choice.numbers["pilot_particle_steps"] = pilots.particle_steps();
  choice.numbers["pilot_seconds"] = std::chrono::duration<double>(Clock::now() - began).count();
  return choice;
}

}  // namespace mpm::vv
