#pragma once

#include "benchmarks/results.hpp"

namespace mpm::tests {

/// Results of benchmarks with one entry of every kind, none of them measured.
inline bench::Results made_up_results() {
  bench::Results results;
  results.revision = "abc1234";
  results.modified = true;
  results.date = "2026-01-02T03:04:05Z";
  results.compiler = "GNU 12.2.0";
  results.native = true;
  results.processor = "a processor";
  results.cores = 2;
  results.repetitions = 5;
  results.seconds_each = 0.3;
  results.noise = 0.025;
  results.limits = {{"triad_l2", "triad in L2", "B/s", {8e10, 7.5e10, 8.5e10}}};
  results.steps = {{.name = "footing/ugimp/usl/linear_elastic/float64/10000/1",
                    .scene = "footing",
                    .scheme = "ugimp",
                    .order = "usl",
                    .law = "linear_elastic",
                    .precision = "float64",
                    .particles = 10012,
                    .threads = 1,
                    .rate = {10e6, 9.9e6, 10.2e6},
                    .target = 25e6,
                    .bytes = 1008,
                    .flops = 781,
                    .share_of_bandwidth = 0.3,
                    .share_of_peak = 0.1}};
  results.kernels = {{"law/linear_elastic/float64", {1e9, 0.9e9, 1.1e9}}};
  results.runs = {{.name = "footing_paper",
                   .title = "The paper's footing",
                   .threads = 2,
                   .particles = 8832,
                   .steps = 140001,
                   .seconds = 70.5,
                   .settlement = 0.0251,
                   .ending = "reached_time"}};
  results.memory = {{.scene = "footing",
                     .law = "mohr_coulomb",
                     .scheme = "cpgimp",
                     .precision = "float32",
                     .particles = 1000000,
                     .bytes_per_particle = 173.5}};
  results.start_up = {{"footing_paper", 0.01}};
  results.features = {{.name = "feature/damping",
                       .title = "local damping",
                       .without = {"none", 1000, 1e-4, 160000, {20e-6, 19e-6, 22e-6}},
                       .with = {"damped", 1000, 1e-4, 160000, {21e-6, 20e-6, 23e-6}},
                       .ratio = {1.05, 1.04, 1.07},
                       .spelled = bench::SpelledResult{.what = "damping: 0",
                                                       .of_with = false,
                                                       .ratio = {1.0, 0.99, 1.01},
                                                       .bytes = 160000,
                                                       .same_bits = true}}};
  return results;
}

}  // namespace mpm::tests
