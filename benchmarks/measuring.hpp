#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmarks/results.hpp"
#include "benchmarks/suite.hpp"

namespace mpm::bench {

struct Effort {
  int repetitions = 5;
  double seconds_each = 0.3;  ///< least time of one repetition [s]
};

/// Told what is being measured, as a line for a person.
using Progress = std::function<void(const std::string&)>;

/// Measures steps and kernels in repetitions that take turns in random order, and puts both into `results`
/// with what the model and the limits in `results` make of them. Returns what went wrong, one line each;
/// nothing of that is in `results`.
std::vector<std::string> measure(const std::vector<StepBenchmark>& steps, const std::vector<Kernel>& kernels,
                                 const Effort& effort, const Progress& progress, Results& results);

/// What a simulation of the scene holds in memory [B], threads not counted.
std::size_t bytes_of(const SceneChoice& choice);

std::vector<MemoryResult> measure_memory();
std::vector<StartUpResult> measure_start_up();

/// Runs a footing case to its end. Its block is the second body.
RunResult measure_run(const std::filesystem::path& case_file, int threads, const Progress& progress);

}  // namespace mpm::bench
