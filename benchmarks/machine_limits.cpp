#include "benchmarks/machine_limits.hpp"

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <experimental/simd>
#include <functional>
#include <numeric>
#include <stdexcept>

namespace mpm::bench {
namespace {

namespace stdx = std::experimental;

/// Consumes a result, so that what led to it must be computed.
void consume(const double& result) { benchmark::DoNotOptimize(result); }

/// Calls per second of `call`, measured over at least `seconds` after one call that warms up.
double calls_per_second(double seconds, const std::function<void()>& call) {
  using Clock = std::chrono::steady_clock;
  call();
  for (std::int64_t calls = 1;;) {
    const auto start = Clock::now();
    for (std::int64_t k = 0; k < calls; ++k) call();
    const double taken = std::chrono::duration<double>(Clock::now() - start).count();
    if (taken >= seconds) return static_cast<double>(calls) / taken;
    // As many as should do, and a fifth more; at most ten times as many, since a short time tells little.
    const double growth = taken > 0 ? 1.2 * seconds / taken : 10.0;
    calls = static_cast<std::int64_t>(std::ceil(static_cast<double>(calls) * std::min(growth, 10.0)));
  }
}

// ---- triad ----

class Triad {
 public:
  /// `bytes` of the three arrays together.
  explicit Triad(std::size_t bytes)
      : a_(bytes / (3 * sizeof(double)), 0.0), b_(a_.size(), 1.0), c_(a_.size(), 2.0) {}

  /// Bytes read and written per second.
  double rate(double seconds) {
    const double calls = calls_per_second(seconds, [this] { sweep(); });
    consume(a_.front() + a_.back());
    return calls * 3 * sizeof(double) * static_cast<double>(a_.size());
  }

 private:
  void sweep() {
    double* a = a_.data();
    const double *b = b_.data(), *c = c_.data();
    for (std::size_t i = 0; i < a_.size(); ++i) a[i] = b[i] + 3.0 * c[i];
    benchmark::DoNotOptimize(a_.data());
    benchmark::ClobberMemory();
  }

  std::vector<double> a_, b_, c_;
};

// ---- multiply-add ----

/// Operations per second.
double fma_peak(double seconds) {
  using Lanes = stdx::native_simd<double>;
  // Two units with a latency of four or five cycles need ten chains; with two constants more, twelve still
  // fit the sixteen registers of AVX2.
  constexpr std::size_t chains = 12;
  constexpr int rounds = 2000;
  // Every chain tends to addend / (1 - factor), so no number becomes large or denormal.
  const volatile double opaque_factor = 0.5, opaque_addend = 1.0;
  const Lanes factor = opaque_factor, addend = opaque_addend;
  const double calls = calls_per_second(seconds, [&] {
    std::array<Lanes, chains> sums;
    for (std::size_t k = 0; k < chains; ++k) sums[k] = static_cast<double>(k);
    for (int round = 0; round < rounds; ++round) {
      for (Lanes& sum : sums) sum = sum * factor + addend;
    }
    consume(stdx::reduce(std::accumulate(sums.begin(), sums.end(), Lanes(0.0))));
  });
  return calls * rounds * chains * static_cast<double>(Lanes::size()) * 2;
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

/// Particles per second.
double scatter_rate(double seconds) {
  const Cloud cloud;
  const std::vector<double> values(particles * 4, 1.0);
  std::vector<double> nodes(stride * stride * 4, 0.0);
  const double calls = calls_per_second(seconds, [&] {
    for (std::size_t p = 0; p < particles; ++p) {
      const Numbers<4> value(&values[p * 4], stdx::element_aligned);
      for_each_node(cloud, p, [&](std::size_t node, double weight) {
        Numbers<4> sum(&nodes[node * 4], stdx::element_aligned);
        sum += weight * value;
        sum.copy_to(&nodes[node * 4], stdx::element_aligned);
      });
    }
    benchmark::ClobberMemory();
  });
  consume(std::accumulate(nodes.begin(), nodes.end(), 0.0));
  return calls * particles;
}

/// Particles per second.
double gather_rate(double seconds) {
  const Cloud cloud;
  const std::vector<double> nodes(stride * stride * 2, 1.0);
  std::vector<double> results(particles * 2);
  const double calls = calls_per_second(seconds, [&] {
    for (std::size_t p = 0; p < particles; ++p) {
      Numbers<2> sum = 0.0;
      for_each_node(cloud, p, [&](std::size_t node, double weight) {
        sum += weight * Numbers<2>(&nodes[node * 2], stdx::element_aligned);
      });
      sum.copy_to(&results[p * 2], stdx::element_aligned);
    }
    benchmark::DoNotOptimize(results.data());
    benchmark::ClobberMemory();
  });
  consume(std::accumulate(results.begin(), results.end(), 0.0));
  return calls * particles;
}

// ---- all of them ----

struct Probe {
  std::string name, title, unit;
  std::function<double(double seconds)> rate;
};

std::vector<Probe> probes() {
  constexpr std::size_t largest = 256u << 20;
  const auto [l2, l3] = caches();
  const auto triad = [](std::size_t bytes) {
    return [bytes](double seconds) { return Triad(bytes).rate(seconds); };
  };
  return {{"triad_l2", "triad in L2", "B/s", triad(l2 / 4)},
          {"triad_l3", "triad in L3", "B/s", triad(std::max(l3 / 4, 2 * l2))},
          {"triad_memory", "triad from memory", "B/s", triad(std::max(std::min(4 * l3, largest), 2 * l3))},
          {"fma_peak", "multiply-adds", "flop/s", fma_peak},
          {"scatter", "9-node scatter of 4 numbers, sorted", "particles/s", scatter_rate},
          {"gather", "9-node gather of 2 numbers, sorted", "particles/s", gather_rate}};
}

}  // namespace

Caches caches() {
  const auto size = [](int name, std::size_t otherwise) {
    const long bytes = ::sysconf(name);
    return bytes > 0 ? static_cast<std::size_t>(bytes) : otherwise;
  };
  return {.l2 = size(_SC_LEVEL2_CACHE_SIZE, 1u << 20), .l3 = size(_SC_LEVEL3_CACHE_SIZE, 32u << 20)};
}

std::vector<Limit> measure_limits(int repetitions, double seconds) {
  const std::vector<Probe> all = probes();
  std::vector<std::vector<double>> rates(all.size());
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    for (std::size_t k = 0; k < all.size(); ++k) rates[k].push_back(all[k].rate(seconds));
  }
  std::vector<Limit> limits;
  for (std::size_t k = 0; k < all.size(); ++k) {
    limits.push_back({all[k].name, all[k].title, all[k].unit, summary_of(rates[k])});
  }
  return limits;
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
