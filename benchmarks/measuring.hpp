#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmarks/results.hpp"
#include "benchmarks/suite.hpp"

namespace mpm::bench {

struct Effort {
  int repetitions = 7;
  double seconds_each = 0.3;  ///< least time of one repetition [s]
};

/// Told what is being measured, as a line for a person.
using Progress = std::function<void(const std::string&)>;

/// What may make the results worth less.
struct Mishaps {
  std::vector<std::string> errors;  ///< what could not be measured and why, one line each
  /// Share of the time that single-threaded benchmarks lost to other programs, in the repetitions that count:
  /// their mean [-]. Above `bearable_loss` the rates are too low.
  double time_lost = 0.0;
};

/// Measures the machine's limits, steps and kernels in repetitions that take turns in random order, and puts
/// them into `results`. Of the single-threaded ones the least disturbed repetitions count.
Mishaps measure(const std::vector<StepBenchmark>& steps, const std::vector<Kernel>& kernels,
                const Effort& effort, const Progress& progress, Results& results);

/// What a simulation of the scene holds in memory [B], threads not counted.
std::size_t bytes_of(const SceneChoice& choice);

std::vector<MemoryResult> measure_memory();
std::vector<StartUpResult> measure_start_up();

/// Runs a footing case to its end. Its block is the second body.
RunResult measure_run(const std::filesystem::path& case_file, int threads, const Progress& progress);

}  // namespace mpm::bench
