#include "vv/model_difference.hpp"

#include <algorithm>
#include <cmath>

namespace mpm::vv {
namespace {

/// Initial heights nearer than this share of the largest are the same: those of float are rounded.
constexpr double same_height = 1e-6;

double largest_of(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// The particle of a profile, sorted by `order`, at an initial height.
std::optional<std::size_t> particle_at(const Profile& profile, const std::vector<std::size_t>& order,
                                       double height, double slack) {
  const auto at = std::partition_point(order.begin(), order.end(), [&](std::size_t p) {
    return profile.initial_position[p] < height - slack;
  });
  if (at == order.end() || profile.initial_position[*at] > height + slack) return std::nullopt;
  return *at;
}

std::vector<std::size_t> by_height(const Profile& profile) {
  std::vector<std::size_t> order(profile.initial_position.size());
  for (std::size_t p = 0; p < order.size(); ++p) order[p] = p;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return profile.initial_position[a] < profile.initial_position[b];
  });
  return order;
}

/// How much of a written scene a run may choose not to simulate.
bool is_of_the_model(const std::string& parameter) { return parameter.starts_with("/scene/model/"); }

bool chose(const Record& record, const std::string& what) {
  return std::any_of(record.model.begin(), record.model.end(),
                     [&](const ModelChoice& choice) { return choice.what == what && choice.picked(); });
}

/// Whether runs of one case have the same values but for what they ask of the model.
bool differ_in_model_only(const RunVerdict& a, const RunVerdict& b) {
  return std::equal(a.parameters.begin(), a.parameters.end(), b.parameters.begin(), b.parameters.end(),
                    [](const auto& one, const auto& other) {
                      return one == other || (one.first == other.first && is_of_the_model(one.first));
                    });
}

}  // namespace

const RunVerdict* run_as_written(const CaseVerdict& verdict, const RunVerdict& run,
                                 const ModelChoice& choice) {
  const auto others_alike = [&](const Record& record) {
    return std::all_of(run.record.model.begin(), run.record.model.end(), [&](const ModelChoice& other) {
      return other.what == choice.what || chose(record, other.what) == other.picked();
    });
  };
  for (const RunVerdict& other : verdict.runs) {
    if (differ_in_model_only(run, other) && !chose(other.record, choice.what) && others_alike(other.record))
      return &other;
  }
  return nullptr;
}

std::optional<ModelDifference> model_difference(const Record& used, const Record& written) {
  if (!used.completed() || !written.completed()) return std::nullopt;
  const Profile &a = used.profile, &b = written.profile;
  const std::vector<std::size_t> order = by_height(a);
  const double slack = same_height * largest_of(b.initial_position);
  ModelDifference difference;
  for (std::size_t p = 0; p < b.initial_position.size(); ++p) {
    const auto at = particle_at(a, order, b.initial_position[p], slack);
    if (!at) return std::nullopt;
    difference.displacement =
        std::max(difference.displacement, std::abs(a.displacement[*at] - b.displacement[p]));
    difference.stress = std::max(difference.stress, std::abs(a.stress[*at] - b.stress[p]));
  }
  if (b.initial_position.empty()) return std::nullopt;
  difference.displacement /= largest_of(b.displacement);
  difference.stress /= largest_of(b.stress);
  return difference;
}

}  // namespace mpm::vv
