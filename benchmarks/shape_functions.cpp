#include "solver/shape_functions.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

namespace {

using namespace mpm;

/// Positions and half sizes in cells, spread over a cell so that no branch is always taken the same way.
struct Places {
  std::vector<double> position, half_size;
};

Places spread_places(std::size_t count) {
  Places places;
  for (std::size_t p = 0; p < count; ++p) {
    const double share = static_cast<double>((p * 37) % count) / static_cast<double>(count);
    places.position.push_back(2.0 + static_cast<double>(p) + share);
    places.half_size.push_back(0.3 + 0.4 * share);
  }
  return places;
}

/// Weights and gradients of 1024 particles along one axis.
template <class Shape>
void weights(benchmark::State& state) {
  const Places places = spread_places(1024);
  std::array<double, Shape::width> weight{}, gradient{};
  for (auto _ : state) {
    for (std::size_t p = 0; p < places.position.size(); ++p) {
      const double above_cell = places.position[p] - std::floor(places.position[p]);
      Shape::evaluate(above_cell + Shape::nodes_before, places.half_size[p], 1.0, weight, gradient);
      // A pointer and a clobber: passing a mutable double by reference can zero it with this compiler.
      benchmark::DoNotOptimize(weight.data());
      benchmark::DoNotOptimize(gradient.data());
      benchmark::ClobberMemory();
    }
  }
  state.counters["particles/s"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * static_cast<double>(places.position.size()), benchmark::Counter::kIsRate);
}

}  // namespace

BENCHMARK(weights<LinearShape>)->Name("shape_function/linear");
BENCHMARK(weights<GimpShape>)->Name("shape_function/gimp");
