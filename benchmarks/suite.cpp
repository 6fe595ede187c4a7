#include "benchmarks/suite.hpp"

#include <algorithm>

namespace mpm::bench {
namespace {

using enum Scheme;
using enum UpdateOrder;
using enum Precision;

/// A method with what it should reach [particle-updates/s] on one thread in double precision.
struct Method {
  Scheme scheme;
  UpdateOrder order;
  Law law;
  double target_at_1e4, target_at_1e6;
};

const std::vector<Method>& methods() {
  static const std::vector<Method> all = {{ugimp, usl, Law::linear_elastic, 25e6, 16e6},
                                          {ugimp, musl, Law::mohr_coulomb, 15e6, 10e6},
                                          {cpgimp, musl, Law::mohr_coulomb, 15e6, 10e6},
                                          {mpm, usl, Law::linear_elastic, 50e6, 25e6}};
  return all;
}

StepBenchmark footing(const Method& method, Precision precision, std::int64_t particles, int threads) {
  StepBenchmark step{{.scheme = method.scheme,
                      .order = method.order,
                      .law = method.law,
                      .precision = precision,
                      .particles = particles},
                     threads,
                     {}};
  if (precision == float64 && threads == 1 && particles == 10'000) step.target = method.target_at_1e4;
  if (precision == float64 && threads == 1 && particles == 1'000'000) step.target = method.target_at_1e6;
  return step;
}

StepBenchmark column(Scheme scheme) {
  return {{.model = SceneChoice::Model::column,
           .scheme = scheme,
           .order = musl,
           .law = Law::linear_elastic,
           .particles = 50},
          1,
          20e6};
}

std::vector<StepBenchmark> quick_suite() {
  std::vector<StepBenchmark> steps;
  for (const Method& method : methods()) steps.push_back(footing(method, float64, 10'000, 1));
  const Method& paper = methods()[2];
  steps.push_back(footing(paper, float32, 10'000, 1));
  steps.push_back(footing(paper, float64, 10'000, 2));
  steps.push_back(footing(paper, float64, 1'000'000, 1));
  steps.push_back(footing(paper, float64, 1'000'000, 2));
  steps.push_back(column(cpgimp));
  return steps;
}

std::vector<StepBenchmark> full_suite() {
  std::vector<StepBenchmark> steps;
  for (const std::int64_t particles : {10'000, 1'000'000}) {
    for (const Method& method : methods()) {
      steps.push_back(footing(method, float64, particles, 1));
      steps.push_back(footing(method, float64, particles, 2));
      steps.push_back(footing(method, float32, particles, 1));
    }
  }
  const Method& paper = methods()[2];
  for (const std::int64_t particles : {1'000, 100'000, 4'000'000}) {
    steps.push_back(footing(paper, float64, particles, 1));
    steps.push_back(footing(paper, float64, particles, 2));
  }
  for (const UpdateOrder order : {usf, usl}) {
    steps.push_back(footing({cpgimp, order, Law::mohr_coulomb, 0, 0}, float64, 10'000, 1));
    steps.back().target.reset();
  }
  for (const Scheme scheme : {mpm, ugimp, cpgimp}) steps.push_back(column(scheme));
  return steps;
}

}  // namespace

std::string StepBenchmark::name() const {
  return name_of(choice.model) + "/" + name_of(choice.scheme) + "/" + name_of(choice.order) + "/" +
         name_of(choice.law) + "/" + name_of(choice.precision) + "/" + std::to_string(choice.particles) +
         "/" + std::to_string(threads);
}

std::vector<StepBenchmark> step_benchmarks(bool quick) {
  std::vector<StepBenchmark> steps = quick ? quick_suite() : full_suite();
  std::erase_if(steps, [](const StepBenchmark& step) { return step.threads > available_threads(); });
  return steps;
}

}  // namespace mpm::bench
