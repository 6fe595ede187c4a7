#include "vv/survey_runs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "reference/column.hpp"
#include "solver/error.hpp"
#include "vv/linear_stability.hpp"

namespace mpm::vv {
namespace {

using Values = std::vector<double>;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
/// Samples of the signal after all loads have settled, and what is needed of them to tell its shape.
constexpr int samples = 256, fewest_samples = 8;
/// Reach of the straight lines that a zig-zag is told from [cells].
constexpr double line_reach = 1.5;

/// The case with nothing to watch but how its first body moves.
Case watching_motion(const Case& definition, const Scene& scene) {
  Case bare;
  bare.id = definition.id;
  const double settling = loads_settled_after(scene), end = latest_end(scene);
  bare.probes.push_back({.id = "motion",
                         .quantity = "displacement",
                         .component = scene.dimension == 1 ? "x" : "y",
                         .target = ProbeTarget::body,
                         .of = scene.bodies.front().name,
                         .every = std::max(end - settling, end / samples) / samples});
  return bare;
}

/// L2 distance of two fields over the norm of the second, weighted; the distance itself if that is zero.
double relative_distance(const Values& found, const Values& expected, const Values& weight) {
  double distance = 0.0, norm = 0.0;
  for (std::size_t p = 0; p < expected.size(); ++p) {
    distance += weight[p] * std::pow(found[p] - expected[p], 2);
    norm += weight[p] * std::pow(expected[p], 2);
  }
  return std::sqrt(norm > 0.0 ? distance / norm : distance);
}

bool is_column(const Case& definition, const RunRequest& request) {
  const auto& names = definition.references;
  return request.scene.dimension == 1 && std::find(names.begin(), names.end(), "hencky") != names.end();
}

/// The answer that a run should give, particle by particle.
struct Answer {
  Values displacement, stress, weight;

  double distance_of(const Profile& profile) const {
    return std::max(relative_distance(profile.displacement, displacement, weight),
                    relative_distance(profile.stress, stress, weight));
  }
};

/// Hencky's column where the particles of a run have come to.
Answer exact_answer(const Scene& scene, const Profile& profile) {
  const Body& body = scene.bodies.front();
  const double gravity = -scene.gravity.acceleration[0] * scene.gravity.level *
                         scene.gravity.fraction(scene.gravity.settled_after());
  const double youngs_modulus = std::visit([](const auto& law) { return law.youngs_modulus; }, body.material);
  const reference::HenckyColumn column(
      {body.density * gravity, body.upper[0] - body.lower[0], youngs_modulus});
  Answer exact{{}, {}, profile.volume};
  for (std::size_t p = 0; p < profile.position.size(); ++p) {
    exact.displacement.push_back(column.displacement(profile.initial_position[p] - scene.grid_lower[0]));
    exact.stress.push_back(column.stress(profile.position[p] - scene.grid_lower[0]));
  }
  return exact;
}

class Surveyor {
 public:
  Surveyor(const Case& definition, const RunRequest& request, const SurveyRequest& survey, const Pulse& pulse)
      : definition_(definition), request_(request), asked_(survey), pulse_(pulse) {}

  Survey run() {
    Survey survey;
    survey.error_name =
        is_column(definition_, request_)
            ? "displacement and stress against Hencky's column, the larger L2 error"
            : "displacement and stress against those of the smallest time step, the larger L2 difference";
    crossing_ = crossing_time(request_.scene);
    survey.own = Simulation(request_.scene).time_step() / crossing_;
    survey.linear = linear_stability(request_.scene, {}, [&] { return !pulse_ || pulse_(0); });
    if (asked_.runs) make_runs(survey);
    return survey;
  }

 private:
  void make_runs(Survey& survey) {
    const double ratio = std::pow(asked_.to / asked_.from, 1.0 / (asked_.points - 1));
    for (int k = 0; k < asked_.points; ++k)
      survey.points.push_back(point_at(asked_.from * std::pow(ratio, k)));
    summarise(survey);
    for (int k = 0; k < asked_.bisections && survey.stable > 0.0 && survey.unstable > 0.0; ++k) {
      survey.points.push_back(point_at(std::sqrt(survey.stable * survey.unstable)));
      std::sort(survey.points.begin(), survey.points.end(),
                [](const SurveyPoint& a, const SurveyPoint& b) { return a.fraction < b.fraction; });
      summarise(survey);
    }
  }

  SurveyPoint point_at(double fraction) {
    SurveyPoint point;
    point.fraction = fraction;
    RunRequest request = request_;
    request.scene.time_step = GivenTimeStep{fraction * crossing_};
    request.model_request.precision = Decision::as_written;
    try {
      judge(unsigned_record(watching_motion(definition_, request.scene), request, pulse_), point);
    } catch (const SceneError& refusal) {
      point.stability = StabilityClass::refused;
      point.reason = refusal.what();
    }
    return point;
  }

  void judge(const Record& record, SurveyPoint& point) {
    point.outcome = record.outcome;
    const bool is_first = ++runs_ == 1;
    Behaviour behaviour;
    behaviour.failed = record.outcome.ending >= Ending::not_finite;
    if (behaviour.failed) {
      point.reason = ending_of(record);
    } else {
      point.signal = signal_of(record);
      point.zigzag = zigzag_of(record.profile);
      point.error = error_of(record.profile, is_first);
    }
    behaviour.signal = point.signal;
    behaviour.zigzag = point.zigzag;
    behaviour.error = point.error;
    BehaviourLimits limits =
        definition_.classification ? definition_.classification->limits : BehaviourLimits{};
    limits.error = error_limit();
    point.stability = class_of(behaviour, limits);
  }

  /// Of the mean displacement of the first body, from when its loads have settled. A run that came to rest at
  /// once is steady.
  SignalShape signal_of(const Record& record) const {
    const History& motion = record.histories.front();
    const double from = loads_settled_after(request_.scene);
    double scale = 0.0;
    for (const double value : motion.value) scale = std::max(scale, std::abs(value));
    const auto kept =
        std::count_if(motion.time.begin(), motion.time.end(), [&](double time) { return time >= from; });
    if (!(scale > 0.0) || kept < fewest_samples) return {};
    return shape_of_signal(motion.time, motion.value, from, scale);
  }

  /// Along a bar; across a body of two dimensions stress varies in ways that are no zig-zag.
  double zigzag_of(const Profile& profile) const {
    if (request_.scene.dimension != 1) return 0.0;
    const double zigzag = zigzag_of_field(profile.position, profile.stress, profile.volume,
                                          line_reach * request_.scene.cell_size);
    return std::isnan(zigzag) ? 0.0 : zigzag;
  }

  /// The first run is that of the smallest step: it is what the others are compared with, or tells how exact
  /// they can be.
  double error_of(const Profile& profile, bool is_first) {
    double error = not_a_number;
    if (is_column(definition_, request_)) {
      error = exact_answer(request_.scene, profile).distance_of(profile);
    } else {
      if (is_first) answer_ = Answer{profile.displacement, profile.stress, profile.initial_volume};
      if (answer_) error = answer_->distance_of(profile);
    }
    if (is_first) least_error_ = error;
    return error;
  }

  double error_limit() const { return std::max(asked_.accuracy, asked_.times_least * least_error_); }

  static bool is_bad(const SurveyPoint& point) {
    return point.stability == StabilityClass::diverged || point.stability == StabilityClass::refused;
  }

  /// Over the points in order of their time steps.
  void summarise(Survey& survey) const {
    survey.stable = survey.unstable = survey.accurate = 0.0;
    bool all_accurate = true;
    for (const SurveyPoint& point : survey.points) {
      if (is_bad(point)) {
        survey.unstable = point.fraction;
        return;
      }
      survey.stable = point.fraction;
      all_accurate = all_accurate && point.error <= error_limit();
      if (all_accurate) survey.accurate = point.fraction;
    }
  }

  const Case& definition_;
  const RunRequest& request_;
  const SurveyRequest& asked_;
  const Pulse& pulse_;
  double crossing_ = 0.0, least_error_ = 0.0;
  int runs_ = 0;
  std::optional<Answer> answer_;
};

}  // namespace

Survey survey_of(const Case& definition, const RunRequest& request, const SurveyRequest& asked,
                 const Pulse& pulse) {
  return Surveyor(definition, request, asked, pulse).run();
}

}  // namespace mpm::vv
