#include <cmath>

#include "benchmarks/suite.hpp"
#include "solver/lanes.hpp"
#include "solver/linear_elastic.hpp"
#include "solver/mohr_coulomb.hpp"
#include "solver/neo_hookean.hpp"
#include "solver/zhang_elastic.hpp"

namespace mpm::bench {
namespace {

constexpr std::size_t particles = 1024;

constexpr MohrCoulomb sand{.youngs_modulus = 1e6,
                           .poissons_ratio = 0.3,
                           .friction_angle = 0.349,
                           .cohesion = 1e3,
                           .dilation_angle = 0.0};

/// Numbers from -1 to 1 that differ from particle to particle.
double spread(std::size_t p, std::size_t component) {
  return std::sin(static_cast<double>(7 * p + 3 * component + 1));
}

/// One array per component.
template <int Dim, class Real>
using Components = std::array<std::vector<Real>, symmetric_components<Dim>>;

/// Strain increments and starting stresses of particles, and where their new stresses go.
template <int Dim, class Real>
struct Points {
  Components<Dim, Real> stress, increment, result;
  std::vector<Real> volume_ratio;

  /// Increments of this size around an isotropic stress of `mean` [Pa].
  Points(double mean, double increment_size) {
    for (std::size_t c = 0; c < stress.size(); ++c) {
      for (std::size_t p = 0; p < particles; ++p) {
        stress[c].push_back(static_cast<Real>(c < 3 ? mean : 0.0));
        increment[c].push_back(static_cast<Real>(increment_size * spread(p, c)));
      }
      result[c].resize(particles);
    }
    for (std::size_t p = 0; p < particles; ++p) {
      volume_ratio.push_back(static_cast<Real>(1 + 0.1 * spread(p, 9)));
    }
  }
};

/// Stress of all points, lanes of them at a time, from the same stress each time, so that no iteration
/// differs from another.
template <int Dim, class Real, class Law>
void update(benchmark::State& state, const Law& law, Points<Dim, Real> points) {
  using Value = Lanes<Real>;
  constexpr std::size_t components = symmetric_components<Dim>;
  for ([[maybe_unused]] auto iteration : state) {
    for (std::size_t p = 0; p < particles; p += lane_count<Real>) {
      SymmetricTensor<Dim, Value> stress, increment;
      for (std::size_t c = 0; c < components; ++c) {
        stress[c] = load<Value>(&points.stress[c][p]);
        increment[c] = load<Value>(&points.increment[c][p]);
      }
      stress = law.update(stress, increment, load<Value>(&points.volume_ratio[p]));
      for (std::size_t c = 0; c < components; ++c) store(stress[c], &points.result[c][p]);
    }
    for (std::size_t c = 0; c < components; ++c) benchmark::DoNotOptimize(points.result[c].data());
    benchmark::ClobberMemory();
  }
  state.counters[units_counter] = static_cast<double>(particles);
}

template <class Real>
void linear_elastic(benchmark::State& state) {
  update<2, Real>(state, LinearElasticLaw<2, Real>(LinearElastic{1e6, 0.3}), Points<2, Real>(-1e4, 1e-4));
}

/// Increments far within the limit.
template <class Real>
void mohr_coulomb_elastic(benchmark::State& state) {
  update<2, Real>(state, MohrCoulombLaw<Real>(sand), Points<2, Real>(-1e5, 1e-4));
}

/// Increments of which nearly all pass the limit, in all its regions.
template <class Real>
void mohr_coulomb_yielding(benchmark::State& state) {
  update<2, Real>(state, MohrCoulombLaw<Real>(sand), Points<2, Real>(-1e3, 0.1));
}

void zhang(benchmark::State& state) {
  update<1, double>(state, ZhangElasticLaw<double>(ZhangElastic{1e6}), Points<1, double>(0, 1e-4));
}

void neo_hookean(benchmark::State& state) {
  using Value = Lanes<double>;
  const NeoHookeanLaw<2, double> law(NeoHookean{1e6, 0.3});
  Points<2, double> points(0, 0);
  std::array<std::vector<double>, 4> gradient;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t p = 0; p < particles; ++p) {
      gradient[k].push_back((k == 0 || k == 3 ? 1.0 : 0.0) + 0.1 * spread(p, k));
    }
  }
  for ([[maybe_unused]] auto iteration : state) {
    for (std::size_t p = 0; p < particles; p += lane_count<double>) {
      std::array<Value, 4> f;
      for (std::size_t k = 0; k < 4; ++k) f[k] = load<Value>(&gradient[k][p]);
      const SymmetricTensor<2, Value> stress = law.stress(f, f[0] * f[3] - f[1] * f[2]);
      for (std::size_t c = 0; c < stress.size(); ++c) store(stress[c], &points.result[c][p]);
    }
    for (std::size_t c = 0; c < 4; ++c) benchmark::DoNotOptimize(points.result[c].data());
    benchmark::ClobberMemory();
  }
  state.counters[units_counter] = static_cast<double>(particles);
}

}  // namespace

std::vector<Kernel> law_kernels() {
  return {{"law/linear_elastic/float64", linear_elastic<double>},
          {"law/linear_elastic/float32", linear_elastic<float>},
          {"law/mohr_coulomb/elastic/float64", mohr_coulomb_elastic<double>},
          {"law/mohr_coulomb/elastic/float32", mohr_coulomb_elastic<float>},
          {"law/mohr_coulomb/yielding/float64", mohr_coulomb_yielding<double>},
          {"law/mohr_coulomb/yielding/float32", mohr_coulomb_yielding<float>},
          {"law/neo_hookean/float64", neo_hookean},
          {"law/zhang_elastic/float64", zhang}};
}

}  // namespace mpm::bench
