#include "benchmarks/features.hpp"

#include <time.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <map>
#include <numeric>
#include <random>

#include "benchmarks/scenes.hpp"
#include "vv/scene_reader.hpp"

namespace mpm::bench {
namespace {

/// Steps before the clock starts, in a simulation just built and when its turn has come again: memory has
/// been touched, and caches hold the scene.
constexpr int steps_of_a_fresh_one = 2, steps_of_a_turn = 1;
/// Steps after which states are compared.
constexpr int compared_steps = 64;

double running_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Figures of repetitions that were not disturbed. The rate is whatever was measured.
std::vector<double> undisturbed(const std::vector<Repetition>& all) {
  std::vector<double> values;
  for (const Repetition& repetition : least_disturbed(all)) values.push_back(repetition.rate);
  return values;
}

/// The median of turns as one repetition.
Repetition in_one(const std::vector<Repetition>& turns) {
  const std::vector<Repetition> kept = least_disturbed(turns);
  double time_lost = 0.0;
  for (const Repetition& turn : kept) time_lost += turn.time_lost / static_cast<double>(kept.size());
  return {median(undisturbed(turns)), time_lost};
}

/// A scene that is measured, and what is known of it before.
class Entry {
 public:
  explicit Entry(const FeatureScene& scene) : what_(scene.what), threads_(scene.threads) {
    scene_ = vv::read_checked({"/scene", scene.text}).scene;
    scene_.watched = scene.watched;
    build();
    particles_ = simulation_->particle_count();
    bytes_ = simulation_->memory();
    time_step_ = simulation_->time_step();
  }

  /// Chooses how many steps a turn has, so that it takes about so long [s].
  void aim_at(double seconds) {
    constexpr int trial = 4;
    steps_ = trial;
    steps_ = std::clamp(static_cast<int>(seconds / time_a_turn().rate), 1, 100'000);
  }
  void take_steps_of(const Entry& other) { steps_ = other.steps_; }

  void build() {
    simulation_.reset();
    simulation_.emplace(simulation_of(scene_, threads_));
    advance(steps_of_a_fresh_one);
  }

  /// Wall time of a step [s]. Throws std::runtime_error if the scene ends.
  Repetition time_a_turn() {
    advance(steps_of_a_turn);
    const double running_before = running_seconds();
    const auto before = std::chrono::steady_clock::now();
    advance(steps_);
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    const double running = running_seconds() - running_before;
    return {wall / steps_, std::max(0.0, 1 - running / wall)};
  }

  ParticleFields state_after_some_steps() {
    build();
    advance(compared_steps);
    return simulation_->particles();
  }

  void keep(const std::vector<Repetition>& turns) { steps_timed_.push_back(in_one(turns)); }

  FeatureCost cost() const {
    return {.what = what_,
            .particles = particles_,
            .time_step = time_step_,
            .bytes = bytes_,
            .step = interval_of_median(undisturbed(steps_timed_))};
  }

  std::int64_t bytes() const { return bytes_; }

 private:
  void advance(int steps) {
    for (int k = 0; k < steps; ++k) {
      if (simulation_->advance()) continue;
      throw std::runtime_error(what_ + ": the scene ended: " + name_of(simulation_->outcome().ending));
    }
  }

  std::string what_;
  Scene scene_;
  int threads_;
  std::optional<Simulation> simulation_;
  std::int64_t particles_ = 0, bytes_ = 0;
  double time_step_ = 0.0;
  int steps_ = 1;
  std::vector<Repetition> steps_timed_;  ///< one a round [s]
};

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

bool same_bits(const ParticleFields& a, const ParticleFields& b) {
  return same_bits(a.position, b.position) && same_bits(a.displacement, b.displacement) &&
         same_bits(a.velocity, b.velocity) && same_bits(a.half_size, b.half_size) &&
         same_bits(a.stress, b.stress) && same_bits(a.volume, b.volume) && same_bits(a.mass, b.mass);
}

/// A feature's scenes, timed together.
class Trial {
 public:
  Trial(const Feature& feature, const FeatureEffort& effort)
      : feature_(feature), turns_(effort.turns), without_(feature.without), with_(feature.with) {
    without_.aim_at(effort.seconds_each);
    with_.aim_at(effort.seconds_each);
    entries_ = {&without_, &with_};
    if (!feature.spelled) return;
    spelled_.emplace(feature.spelled->scene);
    spelled_->take_steps_of(unsaid());
    has_same_bits_ = same_bits(spelled_->state_after_some_steps(), unsaid().state_after_some_steps());
    entries_.push_back(&*spelled_);
  }

  /// Builds each scene anew and times it in turns, another one first in every turn.
  void run_round() {
    std::map<const Entry*, std::vector<Repetition>> timed;
    std::rotate(entries_.begin(), entries_.begin() + 1, entries_.end());
    for (Entry* entry : entries_) entry->build();
    for (int turn = 0; turn < turns_; ++turn) {
      std::rotate(entries_.begin(), entries_.begin() + 1, entries_.end());
      for (Entry* entry : entries_) timed[entry].push_back(entry->time_a_turn());
    }
    for (Entry* entry : entries_) entry->keep(timed.at(entry));
    ratios_.push_back(in_one(ratios(timed.at(&with_), timed.at(&without_))));
    if (spelled_) spelled_ratios_.push_back(in_one(ratios(timed.at(&*spelled_), timed.at(&unsaid()))));
  }

  FeatureResult result() {
    FeatureResult result{.name = feature_.name,
                         .title = feature_.title,
                         .without = without_.cost(),
                         .with = with_.cost(),
                         .ratio = interval_of_median(undisturbed(ratios_)),
                         .spelled = std::nullopt};
    if (!spelled_) return result;
    result.spelled = SpelledResult{.what = feature_.spelled->scene.what,
                                   .of_with = feature_.spelled->is_of_with,
                                   .ratio = interval_of_median(undisturbed(spelled_ratios_)),
                                   .bytes = spelled_->bytes(),
                                   .same_bits = has_same_bits_};
    return result;
  }

 private:
  Entry& unsaid() { return feature_.spelled->is_of_with ? with_ : without_; }

  /// Turn by turn; a ratio is as disturbed as the worse of the two.
  static std::vector<Repetition> ratios(const std::vector<Repetition>& above,
                                        const std::vector<Repetition>& below) {
    std::vector<Repetition> all;
    for (std::size_t k = 0; k < above.size(); ++k) {
      all.push_back({above[k].rate / below[k].rate, std::max(above[k].time_lost, below[k].time_lost)});
    }
    return all;
  }

  const Feature& feature_;
  int turns_;
  Entry without_, with_;
  std::optional<Entry> spelled_;
  std::vector<Entry*> entries_;
  std::vector<Repetition> ratios_, spelled_ratios_;  ///< one a round
  bool has_same_bits_ = false;
};

}  // namespace

std::vector<FeatureResult> measure_features(const std::vector<Feature>& features, const FeatureEffort& effort,
                                            const std::function<void(const std::string&)>& progress,
                                            std::vector<std::string>& errors) {
  std::vector<std::unique_ptr<Trial>> trials(features.size());
  /// Runs a part of the measurement of one feature; without success the feature is left out from then on.
  const auto attempt = [&](std::size_t k, const std::function<void()>& part) {
    progress(features[k].name);
    try {
      part();
    } catch (const std::exception& error) {
      errors.push_back(features[k].name + ": " + error.what());
      trials[k].reset();
    }
  };
  for (std::size_t k = 0; k < features.size(); ++k) {
    attempt(k, [&] { trials[k] = std::make_unique<Trial>(features[k], effort); });
  }
  std::vector<std::size_t> order(features.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937 shuffler(1);
  for (int round = 0; round < effort.rounds; ++round) {
    std::shuffle(order.begin(), order.end(), shuffler);
    for (const std::size_t k : order) {
      if (trials[k]) attempt(k, [&] { trials[k]->run_round(); });
    }
  }
  std::vector<FeatureResult> results;
  for (const auto& trial : trials) {
    if (trial) results.push_back(trial->result());
  }
  return results;
}

}  // namespace mpm::bench
