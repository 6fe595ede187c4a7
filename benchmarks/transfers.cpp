#include "benchmarks/suite.hpp"
#include "solver/cell_blocks.hpp"
#include "solver/grid_motion.hpp"
#include "solver/time_step.hpp"
#include "solver/transfer.hpp"

namespace mpm::bench {
namespace {

/// The footing's particles in the order of their cells, and its grid, with nothing else of a step.
template <class Real, Scheme scheme>
struct Bench {
  using Shape = typename SchemeTraits<scheme>::Shape;
  using Transfers = Transfer<2, Real, scheme>;
  using Layer = typename Transfers::Layer;
  using Layers = typename Transfers::Layers;

  Scene scene = scene_of({.scheme = scheme,
                          .precision = std::is_same_v<Real, float> ? Precision::float32 : Precision::float64,
                          .particles = 10'000});
  Grid<2, Real> grid{scene};
  Particles<2, Real> particles = fill_bodies<2, Real>(scene, SchemeTraits<scheme>::has_domain);
  CellBlocks<2, Real> blocks{grid, Shape::nodes_before, particles};

  template <class Visit>
  void for_each_layers(Visit&& visit) {
    for (const Block& block : blocks.blocks()) {
      Transfers::for_each_layers(particles, grid, block, [&](const Layers& layers, std::size_t count) {
        visit(block, layers, count);
      });
    }
  }
};

/// Times `pass(bench)` and counts the particles it goes over.
template <class Real, Scheme scheme, class Pass>
std::function<void(benchmark::State&)> timed(Pass pass) {
  return [pass](benchmark::State& state) {
    Bench<Real, scheme> bench;
    for ([[maybe_unused]] auto iteration : state) {
      pass(bench);
      benchmark::ClobberMemory();
    }
    state.counters[units_counter] = static_cast<double>(bench.particles.count());
  };
}

constexpr Sends everything{.mass = true, .momentum = true, .internal_force = true};

template <class Real, Scheme scheme>
void add_kernels(const std::string& suffix, std::vector<Kernel>& kernels) {
  using OfBench = Bench<Real, scheme>;
  using Transfers = typename OfBench::Transfers;
  kernels.push_back({"scatter/mass_momentum_force/" + suffix, timed<Real, scheme>([](OfBench& bench) {
                       bench.for_each_layers([&](const Block& block, const auto& layers, std::size_t count) {
                         Transfers::template scatter<everything>(bench.particles, block, layers, count,
                                                                 bench.grid);
                       });
                     })});
  kernels.push_back({"scatter/momentum/" + suffix, timed<Real, scheme>([](OfBench& bench) {
                       bench.for_each_layers([&](const Block& block, const auto& layers, std::size_t count) {
                         Transfers::template scatter<Sends{.momentum = true}>(bench.particles, block, layers,
                                                                              count, bench.grid);
                       });
                     })});
  kernels.push_back(
      {"gather/motion_gradient/" + suffix, timed<Real, scheme>([](OfBench& bench) {
         for (const Block& block : bench.blocks.blocks()) {
           Transfers::for_each_layer(bench.particles, bench.grid, block, [&](const auto& layer) {
             const auto seen =
                 Transfers::template gather<true, true>(bench.particles, bench.grid, block, layer);
             benchmark::DoNotOptimize(&seen);
           });
         }
       })});
  kernels.push_back({"order/arrange/" + suffix, timed<Real, scheme>([](OfBench& bench) {
                       bench.blocks.arrange(bench.grid, bench.particles);
                     })});
  kernels.push_back({"grid/gravity_acceleration/" + suffix, timed<Real, scheme>([](OfBench& bench) {
                       const Rows rows = bench.blocks.active_rows();
                       add_gravity<2, Real>(bench.grid, {Real(0), Real(-10)}, rows);
                       accelerate<true>(bench.grid, Real(1e-5), Real(0.8), Real(1e-12), rows);
                     })});
}

}  // namespace

std::vector<Kernel> transfer_kernels() {
  std::vector<Kernel> kernels;
  add_kernels<double, Scheme::mpm>("mpm/float64", kernels);
  add_kernels<double, Scheme::cpgimp>("cpgimp/float64", kernels);
  add_kernels<float, Scheme::cpgimp>("cpgimp/float32", kernels);
  return kernels;
}

}  // namespace mpm::bench
