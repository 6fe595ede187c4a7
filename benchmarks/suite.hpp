#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/machine_limits.hpp"
#include "benchmarks/scenes.hpp"

namespace mpm::bench {

/// Whole steps to be measured.
struct StepBenchmark {
  SceneChoice choice;
  int threads = 1;
  std::optional<double> target;  ///< particle-updates per second

  /// "footing/ugimp/usl/linear_elastic/float64/10000/1"
  std::string name() const;
};

/// The whole steps of the full suite, or of the quick one, which is a part of it; those that need more
/// threads than a simulation can use are left out.
std::vector<StepBenchmark> step_benchmarks(bool quick);

/// A function to be timed; it sets the counter `units_counter` to the number it updates in an iteration.
struct Kernel {
  std::string name;
  std::function<void(benchmark::State&)> run;
};

std::vector<Kernel> shape_function_kernels();  ///< weights and gradients along one axis
std::vector<Kernel> law_kernels();             ///< stress updates alone
/// Scatter, gather, the order of cells and the motion of the grid, each over the footing with 1e4 particles.
std::vector<Kernel> transfer_kernels();

}  // namespace mpm::bench
