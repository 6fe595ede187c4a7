#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "benchmarks/machine_limits.hpp"
#include "benchmarks/measured.hpp"

namespace mpm::bench {

using Json = nlohmann::ordered_json;

/// Whole steps of a scene. Rates are particle-updates (particles times steps) per second of wall time.
struct StepResult {
  std::string name;  ///< "scene/scheme/order/law/precision/particles wanted/threads"
  std::string scene, scheme, order, law, precision;
  std::int64_t particles = 0;
  int threads = 1;
  Measured rate;
  std::optional<double> target;
  double bytes = 0.0, flops = 0.0;  ///< a particle and step, of the count in vv/step_cost.hpp
  double share_of_bandwidth =
      0.0;                     ///< bytes times rate over the triad of the memory that holds the scene [-]
  double share_of_peak = 0.0;  ///< flops times rate over the peak [-]

  bool meets_target() const { return !target || rate.value >= *target; }
  friend bool operator==(const StepResult&, const StepResult&) = default;
};

/// A kernel alone: particles per second.
struct KernelResult {
  std::string name;
  Measured rate;
  friend bool operator==(const KernelResult&, const KernelResult&) = default;
};

/// A scene from its beginning to its end.
struct RunResult {
  std::string name, title;
  int threads = 1;
  std::int64_t particles = 0, steps = 0;
  double seconds = 0.0;     ///< wall time of the steps
  double settlement = 0.0;  ///< of the block, downwards [m]
  std::string ending;       ///< as `name_of(Ending)`
  friend bool operator==(const RunResult&, const RunResult&) = default;
};

/// What a simulation holds in memory, its grid and everything else included.
struct MemoryResult {
  std::string scene, law, scheme, precision;
  std::int64_t particles = 0;
  double bytes_per_particle = 0.0;
  friend bool operator==(const MemoryResult&, const MemoryResult&) = default;
};

/// From reading the case file to the end of the first step, wall time [s].
struct StartUpResult {
  std::string scene;
  double seconds = 0.0;
  friend bool operator==(const StartUpResult&, const StartUpResult&) = default;
};

/// A scene with a feature, or without it.
struct FeatureCost {
  std::string what;  ///< "Mohr–Coulomb, all of it elastic"
  std::int64_t particles = 0;
  double time_step = 0.0;  ///< [s]
  std::int64_t bytes = 0;  ///< `Simulation::memory`
  Measured step;           ///< wall time of a step, and the interval of its median [s]
  friend bool operator==(const FeatureCost&, const FeatureCost&) = default;
};

/// A scene that says in so many words what another leaves to the default.
struct SpelledResult {
  enum class Verdict { within_limit, within_noise, beyond };

  std::string what;      ///< "damping: 0"
  bool of_with = false;  ///< the other scene is the one with the feature, else the one without
  Measured ratio;        ///< wall time of a step over that of the other scene, and the interval of its median
  std::int64_t bytes = 0;
  bool same_bits = false;  ///< of all particles in the end

  /// Whether it takes at most `free_limit` more time: certainly, or as far as the noise lets one say.
  Verdict verdict() const;
  friend bool operator==(const SpelledResult&, const SpelledResult&) = default;
};
/// What does not take more than this share of time is free [-].
inline constexpr double free_limit = 0.02;
std::string name_of(SpelledResult::Verdict verdict);  ///< "within_limit"

/// What a feature costs.
struct FeatureResult {
  std::string name, title;
  FeatureCost without, with;
  Measured ratio;  ///< wall time of a step with over without, and the interval of its median
  std::optional<SpelledResult> spelled;
  friend bool operator==(const FeatureResult&, const FeatureResult&) = default;
};

/// All that one execution of the benchmarks has measured, and where.
struct Results {
  std::string revision;   ///< of the sources
  bool modified = false;  ///< whether the sources differ from that revision
  std::string date;       ///< UTC, ISO 8601
  std::string compiler;
  bool native = false;  ///< built for all instructions of the machine that built it
  std::string processor;
  int cores = 0;
  int repetitions = 0;
  double seconds_each = 0.0;  ///< least time of a repetition [s]
  double noise = 0.0;         ///< median spread of the steps [-]
  std::vector<Limit> limits;
  std::vector<StepResult> steps;
  std::vector<KernelResult> kernels;
  std::vector<RunResult> runs;
  std::vector<MemoryResult> memory;
  std::vector<StartUpResult> start_up;
  std::vector<FeatureResult> features;
  friend bool operator==(const Results&, const Results&) = default;
};

/// A results file that cannot be read or written, in one line with the file's name.
class ResultsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

Json json_of(const Results& results);

/// Throws ResultsError naming `file`, the JSON pointer, what was expected and what was found.
Results parse_results(const std::string& text, const std::string& file);
Results read_results(const std::filesystem::path& file);

/// Writes beside the file and renames, so that a file of that name is always whole. Makes its directory if
/// need be. Throws ResultsError.
void write_results(const Results& results, const std::filesystem::path& file);

/// Throws ResultsError unless `write_results` would be able to write the file.
void check_writable(const std::filesystem::path& file);

}  // namespace mpm::bench
