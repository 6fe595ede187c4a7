#include "benchmarks/machine_limits.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <experimental/simd>
#include <numeric>
#include <stdexcept>
#include <thread>

#include "benchmarks/scenes.hpp"

namespace mpm::bench {
namespace {

namespace stdx = std::experimental;

/// Consumes a result, so that what led to it must be computed.
void consume(const double& result) { benchmark::DoNotOptimize(result); }

// ---- triad ----

/// `bytes` of the three arrays together.
void triad(benchmark::State& state, std::size_t bytes) {
  const std::size_t length = bytes / (3 * sizeof(double));
  std::vector<double> a(length, 0.0);
  const std::vector<double> b(length, 1.0), c(length, 2.0);
  for ([[maybe_unused]] auto iteration : state) {
    for (std::size_t i = 0; i < length; ++i) a[i] = b[i] + 3.0 * c[i];
    benchmark::DoNotOptimize(a.data());
    benchmark::ClobberMemory();
  }
  consume(a.front() + a.back());
  state.counters[units_counter] = static_cast<double>(3 * sizeof(double) * length);
}

// ---- multiply-add ----

using Widest = stdx::native_simd<double>;
// Two units with a latency of four or five cycles need ten chains; with two constants more, twelve still fit
// the sixteen registers of AVX2.
constexpr std::size_t chains = 12;
constexpr int rounds = 2000;

void multiply_and_add() {
  // Every chain tends to addend / (1 - factor), so no number becomes large or denormal.
  const volatile double opaque_factor = 0.5, opaque_addend = 1.0;
  const Widest factor = opaque_factor, addend = opaque_addend;
  std::array<Widest, chains> sums;
  for (std::size_t k = 0; k < chains; ++k) sums[k] = static_cast<double>(k);
  for (int round = 0; round < rounds; ++round) {
    for (Widest& sum : sums) sum = sum * factor + addend;
  }
  consume(stdx::reduce(std::accumulate(sums.begin(), sums.end(), Widest(0.0))));
}

void fma_peak(benchmark::State& state) {
  for ([[maybe_unused]] auto iteration : state) multiply_and_add();
  state.counters[units_counter] = 2.0 * rounds * static_cast<double>(chains * Widest::size());
}

/// While another thread does the same.
void fma_beside(benchmark::State& state) {
  const std::jthread other([](const std::stop_token& stop) {
    while (!stop.stop_requested()) multiply_and_add();
  });
  fma_peak(state);
}

// ---- scatter and gather ----

constexpr std::size_t cells = 50, stride = cells + 3, particles = 4 * cells * cells, width = 3;

/// Particles in the order of their cells, four a cell, and the nodes around them.
struct Cloud {
  std::vector<std::uint32_t> first_node = std::vector<std::uint32_t>(particles);
  std::vector<double> x_weights = std::vector<double>(particles * width);
  std::vector<double> y_weights = std::vector<double>(particles * width);

  Cloud() {
    for (std::size_t p = 0; p < particles; ++p) {
      const std::size_t cell = p / 4;
      first_node[p] = static_cast<std::uint32_t>(cell / cells * stride + cell % cells);
      const double shift = 0.1 * static_cast<double>(p % 4);
      for (std::vector<double>* weights : {&x_weights, &y_weights}) {
        (*weights)[p * width] = 0.3 - shift / 2;
        (*weights)[p * width + 1] = 0.5;
        (*weights)[p * width + 2] = 0.2 + shift / 2;
      }
    }
  }
};

/// Calls `visit(node, weight)` for the nine nodes of a particle.
template <class Visit>
void for_each_node(const Cloud& cloud, std::size_t p, Visit&& visit) {
  for (std::size_t j = 0; j < width; ++j) {
    const std::size_t row = cloud.first_node[p] + j * stride;
    for (std::size_t i = 0; i < width; ++i) {
      visit(row + i, cloud.x_weights[p * width + i] * cloud.y_weights[p * width + j]);
    }
  }
}

template <std::size_t numbers>
using Numbers = stdx::fixed_size_simd<double, numbers>;

void scatter(benchmark::State& state) {
  const Cloud cloud;
  const std::vector<double> values(particles * 4, 1.0);
  std::vector<double> nodes(stride * stride * 4, 0.0);
  for ([[maybe_unused]] auto iteration : state) {
    for (std::size_t p = 0; p < particles; ++p) {
      const Numbers<4> value(&values[p * 4], stdx::element_aligned);
      for_each_node(cloud, p, [&](std::size_t node, double weight) {
        Numbers<4> sum(&nodes[node * 4], stdx::element_aligned);
        sum += weight * value;
        sum.copy_to(&nodes[node * 4], stdx::element_aligned);
      });
    }
    benchmark::ClobberMemory();
  }
  consume(std::accumulate(nodes.begin(), nodes.end(), 0.0));
  state.counters[units_counter] = static_cast<double>(particles);
}

void gather(benchmark::State& state) {
  const Cloud cloud;
  const std::vector<double> nodes(stride * stride * 2, 1.0);
  std::vector<double> results(particles * 2);
  for ([[maybe_unused]] auto iteration : state) {
    for (std::size_t p = 0; p < particles; ++p) {
      Numbers<2> sum = 0.0;
      for_each_node(cloud, p, [&](std::size_t node, double weight) {
        sum += weight * Numbers<2>(&nodes[node * 2], stdx::element_aligned);
      });
      sum.copy_to(&results[p * 2], stdx::element_aligned);
    }
    benchmark::DoNotOptimize(results.data());
    benchmark::ClobberMemory();
  }
  consume(std::accumulate(results.begin(), results.end(), 0.0));
  state.counters[units_counter] = static_cast<double>(particles);
}

// ---- whole steps ----

Simulation paper_like() { return simulation_of(scene_of({.particles = 10'000}), 1); }

void step_alone(benchmark::State& state) {
  Simulation simulation = paper_like();
  for ([[maybe_unused]] auto iteration : state) simulation.advance();
  state.counters[units_counter] = static_cast<double>(simulation.particle_count());
}

/// While another thread takes steps of a simulation of its own.
void step_beside(benchmark::State& state) {
  const std::jthread other([](const std::stop_token& stop) {
    Simulation simulation = paper_like();
    while (!stop.stop_requested()) simulation.advance();
  });
  step_alone(state);
}

}  // namespace

Caches caches() {
  const auto size = [](int name, std::size_t otherwise) {
    const long bytes = ::sysconf(name);
    return bytes > 0 ? static_cast<std::size_t>(bytes) : otherwise;
  };
  return {.l2 = size(_SC_LEVEL2_CACHE_SIZE, 1u << 20), .l3 = size(_SC_LEVEL3_CACHE_SIZE, 32u << 20)};
}

std::vector<LimitProbe> limit_probes() {
  constexpr std::size_t largest = 256u << 20;
  const auto [l2, l3] = caches();
  const auto triad_of = [](std::size_t bytes) {
    return [bytes](benchmark::State& state) { triad(state, bytes); };
  };
  return {{"triad_l2", "triad in L2", "B/s", triad_of(l2 / 4)},
          {"triad_l3", "triad in L3", "B/s", triad_of(std::max(l3 / 4, 2 * l2))},
          {"triad_memory", "triad from memory", "B/s", triad_of(std::max(std::min(4 * l3, largest), 2 * l3))},
          {"fma_peak", "multiply-adds", "flop/s", fma_peak},
          {"fma_beside", "the same while another core does so too", "flop/s", fma_beside},
          {"scatter", "9-node scatter of 4 numbers, sorted", "particles/s", scatter},
          {"gather", "9-node gather of 2 numbers, sorted", "particles/s", gather},
          {"step", "a cpGIMP step of 10,000 particles", "particles/s", step_alone},
          {"step_beside", "the same while another core does so too", "particles/s", step_beside}};
}

const Limit& limit_named(const std::vector<Limit>& limits, const std::string& name) {
  const auto found =
      std::find_if(limits.begin(), limits.end(), [&](const Limit& limit) { return limit.name == name; });
  if (found == limits.end()) throw std::out_of_range("no machine limit of the name " + name);
  return *found;
}

std::string triad_for(std::size_t bytes, const Caches& caches) {
  return bytes <= caches.l2 ? "triad_l2" : bytes <= caches.l3 ? "triad_l3" : "triad_memory";
}

}  // namespace mpm::bench
