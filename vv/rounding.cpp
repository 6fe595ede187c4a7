#include "vv/rounding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <stdexcept>

#include "solver/simulation.hpp"
#include "vv/grid_convergence.hpp"
#include "vv/precision_pilots.hpp"
#include "vv/run_groups.hpp"
#include "vv/verdict.hpp"

namespace mpm::vv {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double most_digits = 17.0;  ///< that a double can have
constexpr double highest_order = 2.0, lowest_order = 1.0, least_reliable_order = 0.5;
/// Parts of a cell that tell places apart. No number of particles in a cell puts one on the line between two.
constexpr double parts_of_cell = 1024.0;

/// Why two runs cannot be compared.
class NoComparison : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

using Field = std::vector<double> Profile::*;
/// Body and the number of a part of the space, along each axis.
using Place = std::array<std::int64_t, 1 + max_dimension>;

/// Which of the case's particles is which.
class Particles {
 public:
  explicit Particles(const Scene& scene) : scene_(scene), fields_(Simulation(scene).particles()) {}

  std::size_t count() const { return fields_.body.size(); }

  /// The place where a particle starts, from the lower corner of its body.
  Place start_of(std::size_t particle) const {
    const Body& body = scene_.bodies[fields_.body[particle]];
    return place_of(particle, body.lower, scene_.cell_size / parts_of_cell, Rounding::nearest);
  }

  /// The cell of a grid of other cells that a particle starts in.
  Place cell_of(std::size_t particle, double cell_size) const {
    return place_of(particle, scene_.grid_lower, cell_size, Rounding::down);
  }

 private:
  enum class Rounding { nearest, down };

  Place place_of(std::size_t particle, const PerAxis& from, double unit, Rounding rounding) const {
    const auto dimension = static_cast<std::size_t>(scene_.dimension);
    Place place{static_cast<std::int64_t>(fields_.body[particle])};
    for (std::size_t axis = 0; axis < dimension; ++axis) {
      const double units = (fields_.initial_position[particle * dimension + axis] - from[axis]) / unit;
      place[1 + axis] =
          static_cast<std::int64_t>(rounding == Rounding::down ? std::floor(units) : std::round(units));
    }
    return place;
  }

  const Scene& scene_;
  ParticleFields fields_;
};

/// A run's final state and where its particles start. Throws NoComparison unless there is such a state.
struct Level {
  const RunVerdict& run;
  Particles particles;
  double cell_size;

  Level(const RunRequest& request, const RunVerdict& verdict)
      : run(completed(request, verdict)), particles(request.scene), cell_size(request.scene.cell_size) {
    if (particles.count() != verdict.record.profile.displacement.size())
      throw NoComparison(scope_of(verdict.parameters) + " has other particles at its end than at its start");
  }

  const Profile& profile() const { return run.record.profile; }

 private:
  static const RunVerdict& completed(const RunRequest& request, const RunVerdict& verdict) {
    if (!request.refusal.empty())
      throw NoComparison(scope_of(verdict.parameters) + " is refused: " + request.refusal);
    if (!verdict.record.completed())
      throw NoComparison(fmt::format("{}: {}", scope_of(verdict.parameters), ending_of(verdict.record)));
    return verdict;
  }
};

/// Sqrt(sum w (a - b)^2 / sum w b^2).
double relative_distance(const std::vector<double>& found, const std::vector<double>& truth,
                         const std::vector<double>& weight) {
  double difference = 0.0, size = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    difference += weight[k] * (found[k] - truth[k]) * (found[k] - truth[k]);
    size += weight[k] * truth[k] * truth[k];
  }
  return std::sqrt(difference / size);
}

// ---- rounding ----

/// For every particle of `own` the one of `other` that starts in the same place.
std::vector<std::size_t> partners(const Level& own, const Level& other) {
  std::map<Place, std::size_t> by_place;
  for (std::size_t p = 0; p < other.particles.count(); ++p) by_place.emplace(other.particles.start_of(p), p);
  std::vector<std::size_t> found;
  for (std::size_t p = 0; p < own.particles.count(); ++p) {
    const auto partner = by_place.find(own.particles.start_of(p));
    if (partner == by_place.end()) break;
    found.push_back(partner->second);
  }
  if (found.size() != by_place.size() || own.particles.count() != by_place.size())
    throw NoComparison("its particles do not start where those of the baseline do");
  return found;
}

double difference_of(const Level& own, const Level& baseline, const std::vector<std::size_t>& partner,
                     Field field) {
  std::vector<double> found(partner.size());
  for (std::size_t p = 0; p < partner.size(); ++p) found[partner[p]] = (own.profile().*field)[p];
  return relative_distance(found, baseline.profile().*field, baseline.profile().initial_volume);
}

double digits_of(double difference) { return std::clamp(-std::log10(difference), 0.0, most_digits); }

// ---- error of the cells ----

/// Means of a field over the cells of a grid.
struct Means {
  std::vector<Place> places;
  std::vector<double> value, volume;
};

Means means_of(const Level& level, Field field, double cell_size) {
  std::map<Place, std::pair<double, double>> sums;
  for (std::size_t p = 0; p < level.particles.count(); ++p) {
    auto& [sum, volume] = sums[level.particles.cell_of(p, cell_size)];
    sum += level.profile().initial_volume[p] * (level.profile().*field)[p];
    volume += level.profile().initial_volume[p];
  }
  Means means;
  for (const auto& [place, of_place] : sums) {
    means.places.push_back(place);
    means.value.push_back(of_place.first / of_place.second);
    means.volume.push_back(of_place.second);
  }
  return means;
}

/// Of each two neighbouring sizes, from coarse to fine.
std::vector<double> distances(const std::vector<const Level*>& levels, Field field) {
  std::vector<double> found;
  Means coarser;
  for (const Level* level : levels) {
    Means own = means_of(*level, field, levels.front()->cell_size);
    if (level != levels.front()) {
      if (own.places != coarser.places)
        throw NoComparison("its bodies do not fill the same cells on all grids");
      found.push_back(relative_distance(coarser.value, own.value, own.volume));
    }
    coarser = std::move(own);
  }
  return found;
}

/// Of the three finest sizes, by values that are so far apart; the highest where they tell none.
double order_of(const std::vector<double>& cell_size, const std::vector<double>& distance) {
  std::vector<double> values(cell_size.size(), 1.0);
  for (std::size_t k = distance.size(); k-- > 0;) values[k] = values[k + 1] + distance[k];
  const std::optional<GridConvergence> found = grid_convergence(cell_size, values);
  // Negated so that an order that is no number is not reliable either.
  if (!found || !(found->order >= least_reliable_order)) return highest_order;
  return std::clamp(found->order, lowest_order, highest_order);
}

/// The error at each size; see `judge_rounding`.
std::vector<double> errors_of(const std::vector<double>& cell_size, const std::vector<double>& distance) {
  const double order = order_of(cell_size, distance);
  std::vector<double> errors(cell_size.size(), INFINITY);
  for (std::size_t k = 0; k < distance.size(); ++k) {
    const double scale = distance[k] / (std::pow(cell_size[k], order) - std::pow(cell_size[k + 1], order));
    for (const std::size_t level : {k, k + 1})
      errors[level] = std::min(errors[level], scale * std::pow(cell_size[level], order));
  }
  return errors;
}

/// 0 over 0 is nothing to worry about.
double share_of(double rounding, double error) { return rounding == 0.0 ? 0.0 * error : rounding / error; }

// ---- a case ----

class Judge {
 public:
  Judge(const Case& definition, const std::vector<RunVerdict>& runs) : definition_(definition), runs_(runs) {}

  std::vector<RoundingRow> rows() const {
    std::vector<RoundingRow> rows;
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      if (selects(request().baseline, runs_[run].parameters)) continue;
      RoundingRow row;
      row.run = run;
      row.baseline = baseline_of(run);
      row.bits_equal =
          !runs_[run].record.digest.empty() && runs_[run].record.digest == runs_[row.baseline].record.digest;
      try {
        compare(row);
      } catch (const NoComparison& reason) {
        row.lack = reason.what();
      }
      rows.push_back(std::move(row));
    }
    return rows;
  }

 private:
  const RoundingRequest& request() const { return *definition_.rounding; }

  Level level_of(std::size_t run) const { return {definition_.runs[run], runs_[run]}; }

  std::size_t baseline_of(std::size_t run) const {
    Parameters wanted = runs_[run].parameters;
    for (auto& [name, value] : wanted)
      for (const Selector& selector : request().baseline)
        if (selector.parameter == name) value = selector.values.front();
    for (std::size_t other = 0; other < runs_.size(); ++other)
      if (runs_[other].parameters == wanted) return other;
    throw std::invalid_argument("a case whose run " + scope_of(runs_[run].parameters) + " has no baseline");
  }

  void compare(RoundingRow& row) const {
    const Level own = level_of(row.run), baseline = level_of(row.baseline);
    const std::vector<std::size_t> partner = partners(own, baseline);
    row.displacement = difference_of(own, baseline, partner, &Profile::displacement);
    row.stress = difference_of(own, baseline, partner, &Profile::stress);
    if (!std::isfinite(row.displacement) || !std::isfinite(row.stress))
      throw NoComparison("the baseline has no displacement or no stress to compare with");
    row.digits_of_displacement = digits_of(row.displacement);
    row.digits_of_stress = digits_of(row.stress);
    row.cells_of_displacement = cells_error(row.baseline, &Profile::displacement);
    row.cells_of_stress = cells_error(row.baseline, &Profile::stress);
    const double shares[] = {share_of(row.displacement, row.cells_of_displacement),
                             share_of(row.stress, row.cells_of_stress)};
    row.share = std::isnan(shares[0]) || std::isnan(shares[1]) ? nothing : std::max(shares[0], shares[1]);
  }

  /// Not a number if nothing tells it.
  double cells_error(std::size_t baseline, Field field) const {
    if (request().cells.empty()) return nothing;
    try {
      std::vector<Level> levels;
      for (const std::size_t run : refinement_of(baseline)) levels.push_back(level_of(run));
      std::vector<const Level*> views;
      std::vector<double> cell_size;
      for (const Level& level : levels) {
        views.push_back(&level);
        cell_size.push_back(level.cell_size);
      }
      const std::vector<double> errors = errors_of(cell_size, distances(views, field));
      const auto own =
          std::find(cell_size.begin(), cell_size.end(), definition_.runs[baseline].scene.cell_size);
      return errors[static_cast<std::size_t>(own - cell_size.begin())];
    } catch (const NoComparison&) {
      return nothing;
    }
  }

  std::vector<std::size_t> refinement_of(std::size_t baseline) const {
    for (const RunGroup& group : groups_across(definition_, selected_runs(definition_, {}), request().cells))
      if (std::find(group.runs.begin(), group.runs.end(), baseline) != group.runs.end() &&
          group.runs.size() > 1)
        return group.runs;
    throw NoComparison("it has cells of one size only");
  }

  const Case& definition_;
  const std::vector<RunVerdict>& runs_;
};

}  // namespace

bool RoundingRow::is_enough() const { return lack.empty() && share <= allowed_rounding_share; }

std::vector<RoundingRow> judge_rounding(const Case& definition, const std::vector<RunVerdict>& runs) {
  if (!definition.rounding) return {};
  return Judge(definition, runs).rows();
}

void keep_rounding_metrics(const std::vector<RoundingRow>& rows, std::vector<RunVerdict>& runs) {
  for (const RoundingRow& row : rows) {
    if (!row.lack.empty()) continue;
    const std::pair<const char*, double> found[] = {
        {"displacement", row.displacement}, {"stress", row.stress}, {"share", row.share}};
    for (const auto& [name, value] : found)
      if (std::isfinite(value)) runs[row.run].metrics[std::string(rounding_prefix) + name] = value;
  }
}

}  // namespace mpm::vv
