#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mpm::reports {

/// The median of the repetitions of one measurement between the smallest and the largest; 0 < low <= median
/// <= high.
struct Measured {
  double median = 0.0, low = 0.0, high = 0.0;
};

/// What the machine can do at most, or a part of a step by itself.
struct Limit {
  std::string name, title;
  Measured value;
  std::string unit;  ///< B/s, flop/s or particles/s
};

/// Whole steps of one scene in one configuration.
struct StepRate {
  std::string name;  ///< its own in the file, and the same from file to file
  std::string scene, scheme, order, law, precision;
  std::int64_t particles = 0;
  int threads = 1;
  Measured rate;                 ///< [particle-updates/s]
  std::optional<double> target;  ///< [particle-updates/s]
  std::optional<double> bytes;   ///< moved a particle-step, counted
  std::optional<double> flops;   ///< done a particle-step, counted
  std::optional<double> share_of_bandwidth, share_of_peak;

  bool meets_target() const { return target && rate.median >= *target; }
};

/// One kernel by itself.
struct KernelRate {
  std::string name;
  Measured rate;  ///< [particles/s]
};

/// A whole simulation, timed once.
struct TimedRun {
  std::string name, title;
  int threads = 1;
  std::int64_t particles = 0, steps = 0;
  double seconds = 0.0;
  std::optional<double> settlement;  ///< at the end [m]
  std::string ending;

  double particle_steps() const { return static_cast<double>(particles) * static_cast<double>(steps); }
  double rate() const { return particle_steps() / seconds; }  ///< [particle-updates/s]
};

struct MemoryUse {
  std::string scene, law, scheme, precision;
  std::int64_t particles = 0;
  double bytes_per_particle = 0.0;
};

/// How long a scene takes until its first step.
struct StartUp {
  std::string scene;
  double seconds = 0.0;
};

/// A scene that has a feature, or does without.
struct FeatureCost {
  std::string what;  ///< in a few words
  std::int64_t particles = 0;
  double time_step = 0.0;  ///< [s]
  std::int64_t bytes = 0;
  Measured step;  ///< wall time of a step, within the interval of its median [s]

  double per_particle(double of_scene) const { return of_scene / static_cast<double>(particles); }
};

/// A scene that says in so many words what another leaves to the default.
struct SpelledDefault {
  std::string what;        ///< "damping: 0"
  bool of_with = false;    ///< the other scene is the one with the feature, else the one without
  Measured ratio;          ///< wall time of a step over that of the other scene, within its interval
  std::int64_t bytes = 0;  ///< of the scene that says it
  bool same_bits = false;  ///< whether both end in the same state
  std::string verdict;     ///< within_limit, within_noise or beyond: whether it takes 2 % more time
};

/// What something costs that a scene may have.
struct FeaturePrice {
  std::string name, title;
  FeatureCost without, with;
  Measured ratio;  ///< wall time of a step with over without, within the interval of its median
  std::optional<SpelledDefault> spelled;

  /// The same for a second of simulated time.
  double ratio_of_time() const { return ratio.median * without.time_step / with.time_step; }
};

/// All that one call of the benchmark program measured.
struct Performance {
  std::filesystem::path file;
  std::string revision;   ///< of the source it was built from
  bool modified = false;  ///< that source differed from its revision
  std::string date, compiler;
  bool native = false;  ///< built for all instructions of the machine
  std::string processor;
  int cores = 0;
  int repetitions = 0;
  double seconds_each = 0.0;  ///< least duration of a repetition [s]
  double noise = 0.0;         ///< median over the steps of (high - low) / 2 / median [-]
  std::vector<Limit> limits;
  std::vector<StepRate> steps;
  std::vector<KernelRate> kernels;
  std::vector<TimedRun> runs;
  std::vector<MemoryUse> memory;
  std::vector<StartUp> start_up;
  std::vector<FeaturePrice> features;  ///< empty in files that do not have them

  /// The revision as the program and the report name theirs: with "-dirty" if the source was modified.
  std::string full_revision() const;
};

/// Reads and checks a file of format mpmvv-bench-1. Keys that the format does not have are let pass.
///
/// Throws std::runtime_error, "file: place: expected this, found that", for a file that cannot be read, is no
/// JSON, is of another format, lacks a key or has a value of the wrong type or out of its range; the place is
/// a JSON pointer.
Performance read_performance(const std::filesystem::path& file);

/// Every *.json of a directory, oldest first. Throws as read_performance, and std::runtime_error for a
/// directory that cannot be read.
std::vector<Performance> read_performance_history(const std::filesystem::path& directory);

/// What a report knows of speed.
struct PerformanceEvidence {
  std::optional<Performance> measured;
  std::vector<Performance> history;  ///< earlier measurements, oldest first
  std::string failure;               ///< why a measurement that was tried yielded nothing; may be empty

  /// Drops the present measurements from the earlier ones, known by date and revision: they are often kept
  /// there.
  void drop_present_from_history();
};

}  // namespace mpm::reports
