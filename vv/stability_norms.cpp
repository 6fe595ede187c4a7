#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "reference/linear_stability.hpp"
#include "vv/judging.hpp"
#include "vv/linear_stability.hpp"

namespace mpm::vv {
namespace {

using reference::BarParticle, reference::StrainedBy;

StrainedBy strained_by(const Scene& scene) {
  return scene.update_order == UpdateOrder::usl ? StrainedBy::grid : StrainedBy::particles;
}

/// Whether the formulas know of everything in the scene: one body, its particles in a grid whose edges are at
/// most what it stands on.
bool is_plain(const Scene& scene) {
  return scene.bodies.size() == 1 && scene.rigid_bodies.empty() && !scene.bodies.front().ring &&
         scene.flip_fraction == 1.0 && !scene.light_nodes;
}

double past_node(const Scene& scene, double place, std::size_t axis) {
  const double cells = (place - scene.grid_lower[axis]) / scene.cell_size;
  return cells - std::floor(cells);
}

/// Of a particle alone; neutral at any step unless strained by the grid.
std::optional<double> lone_limit(const Scene& scene, const ParticleFields& fields) {
  if (strained_by(scene) != StrainedBy::grid) return std::nullopt;
  const BarParticle particle{past_node(scene, fields.position[0], 0), fields.half_size[0] / scene.cell_size};
  if (scene.dimension == 1) return reference::lone_particle_limit(particle);
  if (scene.scheme != Scheme::mpm) return std::nullopt;
  const auto* elastic = std::get_if<LinearElastic>(&scene.bodies.front().material);
  return reference::lone_particle_limit(particle.offset, past_node(scene, fields.position[1], 1),
                                        elastic->poissons_ratio);
}

/// Domains that lie within a cell each act as points do.
bool act_as_points(const std::vector<BarParticle>& particles) {
  return std::all_of(particles.begin(), particles.end(), [](const BarParticle& particle) {
    constexpr double rounding = 1e-9;
    return particle.offset - particle.half_size >= -rounding &&
           particle.offset + particle.half_size <= 1 + rounding;
  });
}

/// Under USL the worse of the bar and its free ends, each of which must have but one particle past its last
/// common node; else the endless bar.
std::optional<double> bar_limit(const Scene& scene, const ParticleFields& fields) {
  const int per_cell = scene.bodies.front().particles_per_cell[0];
  std::vector<BarParticle> cell;
  for (int k = 0; k < per_cell; ++k)
    cell.push_back({past_node(scene, fields.position[static_cast<std::size_t>(k)], 0),
                    fields.half_size[0] / scene.cell_size});
  if (!act_as_points(cell)) return std::nullopt;
  for (BarParticle& particle : cell) particle.half_size = 0.0;
  double limit = reference::endless_bar_limit(cell, strained_by(scene));
  if (strained_by(scene) == StrainedBy::particles) return limit;
  const auto [first, last] = std::minmax_element(fields.position.begin(), fields.position.end());
  std::vector<double> ends = {past_node(scene, *last, 0)};
  if (scene.edges[0][0] == Condition::free) ends.push_back(1 - past_node(scene, *first, 0));
  for (const double offset : ends) {
    if (offset > 0.5) continue;  // its node is as good as full: other places of the bar are worse
    if (!(offset > 0.0 && offset * per_cell < 1 - 1e-6)) return std::nullopt;
    limit = std::min(limit, reference::free_end_limit(per_cell, offset));
  }
  return limit;
}

/// The closed form for the scene, where there is one.
std::optional<double> closed_form(const Scene& scene) {
  if (!is_plain(scene)) return std::nullopt;
  const Scene linear = linearised(scene);
  const ParticleFields fields = Simulation(linear).particles();
  if (fields.mass.size() == 1) return lone_limit(linear, fields);
  // Shorter bars are all ends.
  const double cells = (scene.bodies.front().upper[0] - scene.bodies.front().lower[0]) / scene.cell_size;
  if (scene.dimension != 1 || cells < 6.0) return std::nullopt;
  return bar_limit(linear, fields);
}

void judge(Judging& judging) {
  if (!judging.record.survey) return;
  const Survey& survey = *judging.record.survey;
  double least = std::numeric_limits<double>::infinity();
  if (survey.linear.lack.empty()) {
    least = survey.linear.limit;
    judging.set("stability.linear_limit", survey.linear.limit);
    if (const std::optional<double> exact = closed_form(judging.scene()))
      judging.set("stability.formula_error", std::abs(survey.linear.limit / *exact - 1));
  }
  if (!survey.points.empty()) {
    least = std::min(least, survey.stable);
    judging.set("stability.stable", survey.stable);
    judging.set("stability.accurate", survey.accurate);
    if (survey.unstable > 0.0) judging.set("stability.unstable", survey.unstable);
  }
  judging.set("stability.margin", least / survey.own);
}

std::string never(const std::string&, const Scene&) { return ""; }

std::vector<Metric> catalogue() {
  return {
      {"stability.linear_limit", "-", "",
       "largest time step at which the matrix of one step is stable, over cell size / wave speed"},
      {"stability.stable", "-", "", "largest time step up to which no run diverged, over the same"},
      {"stability.unstable", "-", "",
       "least time step whose run diverged, over the same; absent if none did"},
      {"stability.accurate", "-", "",
       "largest time step up to which every run's error is within the survey's accuracy, over the same"},
      {"stability.margin", "-", "",
       "the smaller of the limits by the matrix and by runs, over the time step that the scene asks for"},
      {"stability.formula_error", "-", "",
       "relative difference of the limit by the matrix and the closed form, where the scene has one"},
  };
}

}  // namespace

NormFamily stability_norms() { return {{}, catalogue(), never, judge}; }

}  // namespace mpm::vv
