#include "benchmarks/measuring.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <numeric>

#include "benchmarks/step_cost.hpp"
#include "vv/case_file.hpp"

namespace mpm::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Bytes that are allocated and not yet freed.
std::size_t live_bytes() {
  const struct mallinfo2 now = ::mallinfo2();
  return now.uordblks + now.hblkhd;
}

/// Steps before the clock starts: memory is touched, caches and branches have seen the scene.
constexpr int warm_up_steps = 2;

/// Constructs, warms up, and times the steps alone.
void whole_steps(benchmark::State& state, const StepBenchmark& step) {
  Simulation simulation = simulation_of(scene_of(step.choice), step.threads);
  bool goes_on = true;
  for (int k = 0; k < warm_up_steps; ++k) goes_on = goes_on && simulation.advance();
  for ([[maybe_unused]] auto iteration : state) {
    goes_on = goes_on && simulation.advance();
    if (!goes_on) break;
  }
  if (!goes_on) {
    state.SkipWithError(
        fmt::format("the scene ended: {}, step {}", name_of(simulation.outcome().ending), simulation.steps())
            .c_str());
  }
  state.counters[units_counter] = static_cast<double>(simulation.particle_count());
}

/// Keeps the repetitions instead of printing them.
class Collector : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      const std::string& name = run.run_name.function_name;
      if (run.error_occurred) {
        errors.push_back(name + ": " + run.error_message);
        continue;
      }
      Repetitions& of = repetitions[name];
      of.units = run.counters.at(units_counter).value;
      of.all.push_back({of.units * static_cast<double>(run.iterations) / run.real_accumulated_time,
                        std::max(0.0, 1 - run.cpu_accumulated_time / run.real_accumulated_time)});
    }
  }

  struct Repetitions {
    double units = 0.0;  ///< of an iteration
    std::vector<Repetition> all;
  };
  std::map<std::string, Repetitions> repetitions;
  std::vector<std::string> errors;
};

/// The library is told as on its command line.
void set_up_library(const Effort& effort) {
  std::vector<std::string> words{"mpmvv_benchmarks", "--benchmark_enable_random_interleaving=true",
                                 fmt::format("--benchmark_repetitions={}", effort.repetitions),
                                 fmt::format("--benchmark_min_time={}", effort.seconds_each)};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
}

Measured rate_of(const std::vector<Repetition>& repetitions) {
  std::vector<double> rates;
  for (const Repetition& repetition : repetitions) rates.push_back(repetition.rate);
  return summary_of(rates);
}

StepResult result_of(const StepBenchmark& step, double particles, const Measured& rate,
                     const std::vector<Limit>& limits) {
  const StepCost cost = step_cost(step.choice);
  const SceneChoice& choice = step.choice;
  StepResult result{.name = step.name(),
                    .scene = name_of(choice.model),
                    .scheme = name_of(choice.scheme),
                    .order = name_of(choice.order),
                    .law = name_of(choice.law),
                    .precision = name_of(choice.precision),
                    .particles = static_cast<std::int64_t>(particles),
                    .threads = step.threads,
                    .rate = rate,
                    .target = step.target,
                    .bytes = cost.bytes,
                    .flops = cost.operations};
  const double rate_of_a_core = result.rate.value / step.threads;
  const Limit& triad = limit_named(limits, triad_for(bytes_of(choice), caches()));
  result.share_of_bandwidth = cost.bytes * rate_of_a_core / triad.rate.value;
  // The peak is of 64-bit numbers; a vector holds twice as many of 32.
  const double numbers_for_one = choice.precision == Precision::float32 ? 2 : 1;
  const double peak = numbers_for_one * limit_named(limits, "fma_peak").rate.value;
  result.share_of_peak = cost.operations * rate_of_a_core / peak;
  return result;
}

/// Mean of a body's displacement downwards, by mass [m].
double settlement_of(const ParticleFields& fields, std::size_t body) {
  double moment = 0.0, mass = 0.0;
  for (std::size_t p = 0; p < fields.mass.size(); ++p) {
    if (fields.body[p] != body) continue;
    moment -= fields.mass[p] * fields.displacement[2 * p + 1];
    mass += fields.mass[p];
  }
  return moment / mass;
}

double noise_of(const std::vector<StepResult>& steps) {
  std::vector<double> spreads;
  for (const StepResult& step : steps) spreads.push_back(step.rate.spread());
  return spreads.empty() ? 0.0 : median(spreads);
}

}  // namespace

Mishaps measure(const std::vector<StepBenchmark>& steps, const std::vector<Kernel>& kernels,
                const Effort& effort, const Progress& progress, Results& results) {
  set_up_library(effort);
  const auto add = [&](const std::string& name, std::function<void(benchmark::State&)> run) {
    benchmark::RegisterBenchmark(name.c_str(), [name, run, progress](benchmark::State& state) {
      progress(name);
      run(state);
    })->UseRealTime();
  };
  const std::vector<LimitProbe> probes = limit_probes();
  for (const LimitProbe& probe : probes) add(probe.name, probe.run);
  for (const StepBenchmark& step : steps) {
    add(step.name(), [step](benchmark::State& state) { whole_steps(state, step); });
  }
  for (const Kernel& kernel : kernels) add(kernel.name, kernel.run);
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector);
  benchmark::ClearRegisteredBenchmarks();

  std::vector<double> losses;
  // Threads that wait for each other lose time too, so only a single one's losses are told to be others'
  // work.
  const auto rate_on = [&](int threads, const std::string& name) {
    if (threads > 1) return rate_of(collector.repetitions.at(name).all);
    const std::vector<Repetition> kept = least_disturbed(collector.repetitions.at(name).all);
    for (const Repetition& repetition : kept) losses.push_back(repetition.time_lost);
    return rate_of(kept);
  };
  for (const LimitProbe& probe : probes) {
    results.limits.push_back({probe.name, probe.title, probe.unit, rate_on(1, probe.name)});
  }
  for (const StepBenchmark& step : steps) {
    const auto found = collector.repetitions.find(step.name());
    if (found == collector.repetitions.end()) continue;
    results.steps.push_back(
        result_of(step, found->second.units, rate_on(step.threads, step.name()), results.limits));
  }
  for (const Kernel& kernel : kernels) results.kernels.push_back({kernel.name, rate_on(1, kernel.name)});
  results.noise = noise_of(results.steps);
  const double time_lost =
      std::accumulate(losses.begin(), losses.end(), 0.0) / static_cast<double>(losses.size());
  return {.errors = collector.errors, .time_lost = time_lost};
}

std::size_t bytes_of(const SceneChoice& choice) {
  const Scene scene = scene_of(choice);
  const std::size_t before = live_bytes();
  const Simulation simulation = simulation_of(scene, 1);
  return live_bytes() - before;
}

std::vector<MemoryResult> measure_memory() {
  std::vector<MemoryResult> all;
  for (const Precision precision : {Precision::float64, Precision::float32}) {
    for (const auto& [scheme, law] :
         {std::pair(Scheme::mpm, Law::linear_elastic), std::pair(Scheme::ugimp, Law::linear_elastic),
          std::pair(Scheme::ugimp, Law::mohr_coulomb), std::pair(Scheme::cpgimp, Law::mohr_coulomb)}) {
      const SceneChoice choice{.scheme = scheme, .law = law, .precision = precision, .particles = 1'000'000};
      const std::int64_t particles = simulation_of(scene_of(choice), 1).particle_count();
      all.push_back(
          {.scene = name_of(choice.model),
           .law = name_of(law),
           .scheme = name_of(scheme),
           .precision = name_of(precision),
           .particles = particles,
           .bytes_per_particle = static_cast<double>(bytes_of(choice)) / static_cast<double>(particles)});
    }
  }
  return all;
}

std::vector<StartUpResult> measure_start_up() {
  const auto first_step = [](const std::string& name, const std::function<Scene()>& scene) {
    const auto start = Clock::now();
    simulation_of(scene(), 1).advance();
    return StartUpResult{name, seconds_since(start)};
  };
  return {first_step("footing_paper", [] { return vv::read_case(footing_case()).runs.front().scene; }),
          first_step("footing/1000000", [] { return scene_of({.particles = 1'000'000}); })};
}

RunResult measure_run(const std::filesystem::path& case_file, int threads, const Progress& progress) {
  const vv::Case footing = vv::read_case(case_file);
  const Scene& scene = footing.runs.front().scene;
  Simulation simulation = simulation_of(scene, threads);
  const auto start = Clock::now();
  auto told = start;
  while (simulation.advance()) {
    // A look at the clock now and then costs nothing beside that many steps.
    if (simulation.steps() % 256 != 0 || Clock::now() - told < std::chrono::seconds(1)) continue;
    told = Clock::now();
    progress(fmt::format("{}, {} threads: {:.2f} s simulated", footing.id, threads, simulation.time()));
  }
  const double seconds = seconds_since(start);
  return {.name = footing.id,
          .title = footing.title,
          .threads = threads,
          .particles = simulation.particle_count(),
          .steps = simulation.steps(),
          .seconds = seconds,
          .settlement = settlement_of(simulation.particles(), 1),
          .ending = name_of(simulation.outcome().ending)};
}

}  // namespace mpm::bench
