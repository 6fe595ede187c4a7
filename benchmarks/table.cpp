#include "benchmarks/table.hpp"

#include <fmt/format.h>

namespace mpm::bench {
namespace {

std::string heading_of(const Results& results) {
  return fmt::format(
      "revision {}{}, {}, {} instructions, {}, {} cores\n"
      "median of {} repetitions of at least {} s; +- is half of highest less lowest\n",
      results.revision, results.modified ? " (modified)" : "", results.compiler,
      results.native ? "the machine's" : "portable", results.processor, results.cores, results.repetitions,
      results.seconds_each);
}

std::string limits_of(const Results& results) {
  if (results.limits.empty()) return "";
  std::string text = "\nlimits of one core\n";
  for (const Limit& limit : results.limits) {
    text += fmt::format("  {:<48} {:>9.4g} {:<13} +-{:4.1f} %\n", limit.title, limit.rate.value, limit.unit,
                        100 * limit.rate.spread());
  }
  return text;
}

std::string row_of(const StepResult& step) {
  const std::string target = step.target ? fmt::format("{:.3g}", *step.target / 1e6) : "-";
  const char* met = !step.target ? "" : step.meets_target() ? "met" : "MISSED";
  return fmt::format("  {:<50} {:>9.3f} +-{:4.1f} % {:>7} {:<7} {:>6.0f} {:>6.0f} {:>9.1f} % {:>5.1f} %\n",
                     step.name, step.rate.value / 1e6, 100 * step.rate.spread(), target, met, step.bytes,
                     step.flops, 100 * step.share_of_bandwidth, 100 * step.share_of_peak);
}

std::string steps_of(const Results& results) {
  if (results.steps.empty()) return "";
  std::string text = fmt::format("\n{:<52} {:>9} {:>8} {:>7} {:<7} {:>6} {:>6} {:>11} {:>7}\n",
                                 "whole steps, millions of particle-updates a second", "", "", "target", "",
                                 "bytes", "flops", "bandwidth", "peak");
  for (const StepResult& step : results.steps) text += row_of(step);
  return text + fmt::format("  noise, the median of +-: {:.1f} %\n", 100 * results.noise);
}

std::string kernels_of(const Results& results) {
  if (results.kernels.empty()) return "";
  std::string text = "\nkernels, millions of particles a second\n";
  for (const KernelResult& kernel : results.kernels) {
    text += fmt::format("  {:<50} {:>9.1f} +-{:4.1f} %\n", kernel.name, kernel.rate.value / 1e6,
                        100 * kernel.rate.spread());
  }
  return text;
}

std::string memory_of(const Results& results) {
  if (results.memory.empty()) return "";
  std::string text = "\nmemory, bytes a particle, grid included\n";
  for (const MemoryResult& memory : results.memory) {
    const std::string name =
        fmt::format("{}/{}/{}/{}", memory.scene, memory.scheme, memory.law, memory.precision);
    text += fmt::format("  {:<50} {:>9.0f}\n", name, memory.bytes_per_particle);
  }
  return text;
}

std::string start_up_of(const Results& results) {
  if (results.start_up.empty()) return "";
  std::string text = "\nfrom reading the case to the end of the first step, seconds\n";
  for (const StartUpResult& start : results.start_up) {
    text += fmt::format("  {:<50} {:>9.3f}\n", start.scene, start.seconds);
  }
  return text;
}

std::string row_of(const FeatureResult& feature) {
  const auto per_particle = [](const FeatureCost& cost, double of_scene) {
    return of_scene / static_cast<double>(cost.particles);
  };
  const auto cost_of = [&](const FeatureCost& cost) {
    return fmt::format("{:>7.1f} {:>6.0f}", 1e9 * per_particle(cost, cost.step.value),
                       per_particle(cost, static_cast<double>(cost.bytes)));
  };
  std::string text =
      fmt::format("  {:<27} {:<32} {:<46} {} {} {:>8.3f} {:.3f} - {:.3f}\n", feature.name,
                  feature.without.what, feature.with.what, cost_of(feature.without), cost_of(feature.with),
                  feature.ratio.value, feature.ratio.low, feature.ratio.high);
  if (!feature.spelled) return text;
  const SpelledResult& spelled = *feature.spelled;
  const FeatureCost& unsaid = spelled.of_with ? feature.with : feature.without;
  return text + fmt::format("  {:<27} {:<32} {:<46} {:>29} {:>8.3f} {:.3f} - {:.3f}, {}, {} bits\n", "",
                            spelled.what, "said, over left out",
                            fmt::format("{:+} B", spelled.bytes - unsaid.bytes), spelled.ratio.value,
                            spelled.ratio.low, spelled.ratio.high, name_of(spelled.verdict()),
                            spelled.same_bits ? "the same" : "OTHER");
}

std::string features_of(const Results& results) {
  if (results.features.empty()) return "";
  std::string text =
      fmt::format("\n{:<29} {:<32} {:<46} {:>14} {:>14} {:>8} {}\n", "what features cost", "without", "with",
                  "ns and B without", "with", "ratio", "of a step's time, and its interval");
  for (const FeatureResult& feature : results.features) text += row_of(feature);
  return text + "  nanoseconds and bytes a particle; steps of the whole scene are compared\n";
}

std::string runs_of(const Results& results) {
  if (results.runs.empty()) return "";
  std::string text = "\nfrom beginning to end\n";
  for (const RunResult& run : results.runs) {
    const double updates = static_cast<double>(run.particles) * static_cast<double>(run.steps);
    text += fmt::format(
        "  {}, threads: {}: {:.1f} s for {} steps of {} particles ({:.3f} million a second); settled by "
        "{:.1f} mm; {}\n",
        run.name, run.threads, run.seconds, run.steps, run.particles, updates / run.seconds / 1e6,
        1e3 * run.settlement, run.ending);
  }
  return text;
}

}  // namespace

std::string text_of(const Results& results) {
  return heading_of(results) + limits_of(results) + steps_of(results) + kernels_of(results) +
         memory_of(results) + start_up_of(results) + features_of(results) + runs_of(results);
}

}  // namespace mpm::bench
