#include <benchmark/benchmark.h>

#include "solver/simulation.hpp"
#include "vv/case_file.hpp"

namespace {

using namespace mpm;

/// The column of Figure 1 at 10G with a given number of cells and particles per cell, never at an end.
Scene column(Scheme scheme, UpdateOrder order, Precision precision, std::int64_t cells) {
  static const vv::Case figure_1 = vv::read_case(MPMVV_ROOT "/vv/cases/column_figure_1.json");
  Scene scene = figure_1.runs.front().scene;
  scene.scheme = scheme;
  scene.update_order = order;
  scene.precision = precision;
  scene.gravity.level = 10;
  scene.cell_size = 1.0 / static_cast<double>(cells);
  scene.grid_upper[0] = 1.0 + 2.0 * scene.cell_size;
  scene.termination = AtTime{1e9};
  return scene;
}

/// A whole step: weights, scatter, grid, gather, second mapping, stress. Set-up is not timed.
void whole_step(benchmark::State& state, Scheme scheme, UpdateOrder order, Precision precision) {
  Simulation simulation(column(scheme, order, precision, state.range(0)));
  for (auto _ : state) {
    if (!simulation.advance()) {
      state.SkipWithError(name_of(simulation.outcome().ending));
      break;
    }
  }
  state.counters["particle-updates/s"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * static_cast<double>(simulation.particle_count()),
      benchmark::Counter::kIsRate);
}

const auto sizes = [](auto* b) { b->Arg(50)->Arg(1000)->Arg(20000)->ArgName("cells"); };

}  // namespace

#define MPMVV_STEP(name, scheme, order, precision) \
  BENCHMARK_CAPTURE(whole_step, name, Scheme::scheme, UpdateOrder::order, Precision::precision)->Apply(sizes)

MPMVV_STEP(mpm_musl, mpm, musl, float64);
MPMVV_STEP(ugimp_musl, ugimp, musl, float64);
MPMVV_STEP(cpgimp_musl, cpgimp, musl, float64);
MPMVV_STEP(cpgimp_usf, cpgimp, usf, float64);
MPMVV_STEP(cpgimp_usl, cpgimp, usl, float64);
MPMVV_STEP(cpgimp_musl_float, cpgimp, musl, float32);
