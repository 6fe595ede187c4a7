#include "solver/shape_functions.hpp"

#include "benchmarks/suite.hpp"

namespace mpm::bench {
namespace {

constexpr std::size_t particles = 1024;

/// Positions and half sizes in cells, spread over a cell so that no branch is always taken the same way.
template <class Real>
struct Places {
  std::vector<Real> position, half_size;

  Places() {
    for (std::size_t p = 0; p < particles; ++p) {
      const double share = static_cast<double>((p * 37) % particles) / static_cast<double>(particles);
      position.push_back(static_cast<Real>(2.0 + static_cast<double>(p) + share));
      half_size.push_back(static_cast<Real>(0.3 + 0.4 * share));
    }
  }
};

template <class Shape, class Real>
void weights(benchmark::State& state) {
  const Places<Real> places;
  std::vector<std::array<Real, Shape::width>> weight(particles), gradient(particles);
  for ([[maybe_unused]] auto iteration : state) {
    for (std::size_t p = 0; p < particles; ++p) {
      const std::int32_t first = Shape::first_node(places.position[p], places.half_size[p]);
      Shape::evaluate(places.position[p], places.half_size[p], first, weight[p], gradient[p]);
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
