#include "solver/shape_functions.hpp"

#include "benchmarks/suite.hpp"

namespace mpm::bench {
namespace {

constexpr std::size_t particles = 1024;

/// Places above the first node and half sizes, in cells, spread over a cell.
template <class Real>
struct Places {
  std::vector<Real> place, half_size;

  explicit Places(int nodes_before) {
    for (std::size_t p = 0; p < particles; ++p) {
      const double share = static_cast<double>((p * 37) % particles) / static_cast<double>(particles);
      place.push_back(static_cast<Real>(nodes_before + share));
      half_size.push_back(static_cast<Real>(0.3 + 0.4 * share));
    }
  }
};

/// Weights and gradients of lanes of particles along one axis.
template <class Shape, class Real>
void weights(benchmark::State& state) {
  using Value = Lanes<Real>;
  constexpr std::size_t lanes = lane_count<Real>;
  const Places<Real> places(Shape::nodes_before);
  std::vector<std::array<Value, Shape::width>> weight(particles / lanes), gradient(particles / lanes);
  for ([[maybe_unused]] auto iteration : state) {
    for (std::size_t k = 0; k < particles / lanes; ++k) {
      Shape::evaluate(load<Value>(&places.place[k * lanes]), load<Value>(&places.half_size[k * lanes]),
                      Real(100), weight[k], gradient[k]);
    }
    // Pointers and a clobber: passing a mutable number by reference can zero it with g++ 12.
    benchmark::DoNotOptimize(weight.data());
    benchmark::DoNotOptimize(gradient.data());
    benchmark::ClobberMemory();
  }
  state.counters[units_counter] = static_cast<double>(particles);
}

}  // namespace

std::vector<Kernel> shape_function_kernels() {
  return {{"weights/linear/float64", weights<LinearShape, double>},
          {"weights/gimp/float64", weights<GimpShape, double>},
          {"weights/gimp/float32", weights<GimpShape, float>}};
}

}  // namespace mpm::bench
