#pragma once

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "reports/performance.hpp"
#include "tests/support/scratch_directory.hpp"

/// Measurements that nobody took: round numbers that no machine would give.
namespace mpm::support {

using PerformanceJson = nlohmann::ordered_json;

namespace demo {

/// A whole step; its spread is a tenth to either side.
inline PerformanceJson step(const std::string& scene, const std::string& scheme, const std::string& precision,
                            std::int64_t particles, int threads, double rate,
                            PerformanceJson target = nullptr) {
  const std::string law = scene == "footing" ? "mohr_coulomb" : "linear_elastic";
  return {{"name", scene + "/" + scheme + "/usl/" + law + "/" + precision + "/" + std::to_string(particles) +
                       "/" + std::to_string(threads)},
          {"scene", scene},
          {"scheme", scheme},
          {"order", "usl"},
          {"law", law},
          {"precision", precision},
          {"particles", particles},
          {"threads", threads},
          {"rate", rate},
          {"low", 0.9 * rate},
          {"high", 1.1 * rate},
          {"target", std::move(target)},
          {"bytes", precision == "float32" ? 100 : 200},
          {"flops", scheme == "mpm" ? 200 : 400},
          {"share_of_bandwidth", 0.25},
          {"share_of_peak", 0.125}};
}

inline PerformanceJson limit(const std::string& name, const std::string& title, double value,
                             const std::string& unit) {
  return {{"name", name},       {"title", title},      {"value", value},
          {"low", 0.9 * value}, {"high", 1.1 * value}, {"unit", unit}};
}

inline PerformanceJson run(int threads, double seconds) {
  return {{"name", "footing_paper"}, {"title", "the footing, the paper's settings"},
          {"threads", threads},      {"particles", 1000},
          {"steps", 20000},          {"seconds", seconds},
          {"settlement", 0.025},     {"ending", "reached_time"}};
}

inline PerformanceJson feature_cost(const std::string& what, std::int64_t bytes, double step) {
  return {{"what", what}, {"particles", 1000}, {"time_step", 1e-4}, {"bytes", bytes},
          {"step", step}, {"low", 0.9 * step}, {"high", 1.1 * step}};
}

/// One that costs time and memory and can be switched off, one that cannot.
inline PerformanceJson features() {
  PerformanceJson damping = {{"name", "feature/damping"},
                             {"title", "local damping"},
                             {"without", feature_cost("none", 160000, 20e-6)},
                             {"with", feature_cost("damped", 176000, 25e-6)},
                             {"ratio", 1.25},
                             {"low", 1.125},
                             {"high", 1.375},
                             {"spelled",
                              {{"what", "damping: 0"},
                               {"of", "without"},
                               {"ratio", 1.005},
                               {"low", 0.995},
                               {"high", 1.015},
                               {"bytes", 160000},
                               {"same_bits", true},
                               {"verdict", "within_limit"}}}};
  PerformanceJson rigid = damping;
  rigid["name"] = "feature/block_footing";
  rigid["title"] = "footing of particles";
  rigid["without"]["what"] = "rigid body";
  rigid["with"]["what"] = "a stiff block";
  rigid["without"]["time_step"] = 8e-4;
  rigid["spelled"] = nullptr;
  return {damping, rigid};
}

inline PerformanceJson steps() {
  PerformanceJson all = PerformanceJson::array();
  for (const std::string scheme : {"mpm", "ugimp", "cpgimp"}) {
    const double rate = scheme == "mpm" ? 40e6 : scheme == "ugimp" ? 30e6 : 10e6;
    for (const std::int64_t particles : {1000, 10000, 1000000})
      for (const int threads : {1, 2}) {
        const double size = particles == 10000 ? 1.0 : 0.8;
        const bool aim = particles == 10000 && threads == 1;
        all.push_back(step("footing", scheme, "float64", particles, threads,
                           rate * size * (threads == 2 ? 1.5 : 1.0),
                           aim ? PerformanceJson(20e6) : PerformanceJson()));
      }
  }
  all.push_back(step("footing", "ugimp", "float32", 10000, 1, 45e6));
  all.push_back(step("block", "ugimp", "float64", 10000, 1, 50e6, 52e6));
  return all;
}

}  // namespace demo

/// A file with something of everything; of its targets two are met and two are not, one of these within the
/// spread.
inline PerformanceJson demo_performance_json() {
  return {{"format", "mpmvv-bench-1"},
          {"revision", "0123abcd"},
          {"modified", false},
          {"date", "2000-01-02T03:04:05Z"},
          {"compiler", "Test 1.0"},
          {"native", true},
          {"machine", {{"processor", "Test processor"}, {"cores", 2}}},
          {"repetitions", 5},
          {"seconds_each", 0.25},
          {"noise", 0.1},
          {"limits",
           {demo::limit("triad_l2", "triad in L2", 80e9, "B/s"),
            demo::limit("triad_memory", "triad in memory", 10e9, "B/s"),
            demo::limit("fma_peak", "fused multiply-adds", 100e9, "flop/s"),
            demo::limit("scatter", "9-node scatter of 4 numbers, sorted", 120e6, "particles/s")}},
          {"steps", demo::steps()},
          {"kernels", {{{"name", "weights/gimp/float64"}, {"rate", 200e6}, {"low", 190e6}, {"high", 210e6}}}},
          {"runs", {demo::run(1, 10.0), demo::run(2, 8.0)}},
          {"memory",
           {{{"scene", "footing"},
             {"law", "mohr_coulomb"},
             {"scheme", "cpgimp"},
             {"precision", "float64"},
             {"particles", 1000000},
             {"bytes_per_particle", 222}}}},
          {"start_up", {{{"scene", "footing_paper"}, {"seconds", 0.0125}}}},
          {"features", demo::features()}};
}

/// Reads a text as if it stood in a file of that name.
inline reports::Performance performance_of(const PerformanceJson& json,
                                           const std::string& name = "demo.json") {
  const tests::ScratchDirectory scratch;
  std::ofstream(scratch.path() / name) << json.dump(1);
  return reports::read_performance(scratch.path() / name);
}

inline reports::Performance demo_performance() { return performance_of(demo_performance_json()); }

/// The same a day earlier: an older revision, at half the rate where it was measured.
inline PerformanceJson demo_earlier_json() {
  PerformanceJson json = demo_performance_json();
  json["revision"] = "fedc9876";
  json["date"] = "2000-01-01T03:04:05Z";
  for (PerformanceJson& step : json["steps"])
    for (const char* key : {"rate", "low", "high"}) step[key] = 0.5 * step[key].get<double>();
  json["runs"][0]["seconds"] = 30.0;
  json["steps"].erase(json["steps"].size() - 1);
  return json;
}

}  // namespace mpm::support
