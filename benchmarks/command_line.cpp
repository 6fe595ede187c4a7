#include "benchmarks/command_line.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <fstream>
#include <regex>
#include <string_view>
#include <thread>

#include "benchmarks/comparison.hpp"
#include "benchmarks/features.hpp"
#include "benchmarks/measuring.hpp"
#include "benchmarks/table.hpp"
#include "vv/revision.hpp"

namespace mpm::bench {
namespace {

enum ExitCode { all_good = 0, became_slower = 1, bad_input = 2 };

struct Arguments {
  std::string json, filter, against;
  std::vector<std::string> compared;
  bool quick = false, footing = false, features = false;
};

/// One line on standard error, whatever the text.
void complain(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  fmt::print(stderr, "mpmvv bench: {}\n", text);
}

/// A line that replaces itself, for somebody who watches; nothing otherwise.
class ProgressLine {
 public:
  ~ProgressLine() { clear(); }

  void show(const std::string& text) {
    if (!watched_) return;
    fmt::print(stderr, "\r\033[K{}", text);
    std::fflush(stderr);
  }
  void clear() { show(""); }

 private:
  bool watched_ = ::isatty(STDERR_FILENO) == 1;
};

std::string processor() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

/// What is known before anything has been measured.
Results circumstances(const Effort& effort) {
  constexpr std::string_view modified = "-dirty";
  const vv::BuildFacts& facts = vv::build_facts();
  Results results;
  results.revision = facts.revision;
  results.modified = results.revision.ends_with(modified);
  if (results.modified) results.revision.resize(results.revision.size() - modified.size());
  results.date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  results.compiler = facts.compiler;
  results.native = std::string_view(facts.build).find("-march=native") != std::string_view::npos;
  results.processor = processor();
  results.cores = static_cast<int>(std::thread::hardware_concurrency());
  results.repetitions = effort.repetitions;
  results.seconds_each = effort.seconds_each;
  return results;
}

/// What the arguments ask to measure.
struct Suite {
  std::vector<StepBenchmark> steps;
  std::vector<Kernel> kernels;
  std::vector<Feature> features;
};

Suite suite_of(const Arguments& arguments) {
  Suite suite{.steps = {}, .kernels = {}, .features = features()};
  if (!arguments.features) {
    suite.steps = step_benchmarks(arguments.quick);
    for (const auto& kernels : {shape_function_kernels(), law_kernels(), transfer_kernels()}) {
      suite.kernels.insert(suite.kernels.end(), kernels.begin(), kernels.end());
    }
  }
  try {
    const std::regex filter(arguments.filter);
    std::erase_if(suite.steps, [&](const auto& step) { return !std::regex_search(step.name(), filter); });
    std::erase_if(suite.kernels, [&](const auto& kernel) { return !std::regex_search(kernel.name, filter); });
    std::erase_if(suite.features,
                  [&](const auto& feature) { return !std::regex_search(feature.name, filter); });
  } catch (const std::regex_error& error) {
    throw std::runtime_error("--filter " + arguments.filter + ": not a regular expression: " + error.what());
  }
  if (suite.steps.empty() && suite.kernels.empty() && suite.features.empty() && !arguments.footing) {
    throw std::runtime_error("--filter " + arguments.filter + ": nothing of that name");
  }
  return suite;
}

int tell_comparison(const Results& before, const Results& after) {
  const Comparison comparison = compare(before, after);
  fmt::print("{}", text_of(comparison));
  return comparison.has_slower() ? became_slower : all_good;
}

void tell(const Mishaps& mishaps) {
  if (mishaps.time_lost > bearable_loss) {
    complain(fmt::format(
        "other programs had the core for {:.0f} % of the time: rates are too low and noise is large",
        100 * mishaps.time_lost));
  }
  for (const std::string& error : mishaps.errors) complain(error);
}

int measure_all(const Arguments& arguments) {
  // Everything that can be wrong with the arguments is looked at before minutes go by.
  const Suite suite = suite_of(arguments);
  std::optional<Results> before;
  if (!arguments.against.empty()) before = read_results(arguments.against);
  check_writable(arguments.json);

  const Effort effort = arguments.quick ? Effort{3, 0.1} : Effort{};
  ProgressLine line;
  const Progress progress = [&](const std::string& text) { line.show("measuring " + text); };
  Results results = circumstances(effort);
  Mishaps mishaps;
  if (!suite.steps.empty() || !suite.kernels.empty()) {
    mishaps = measure(suite.steps, suite.kernels, effort, progress, results);
  }
  if (!suite.features.empty()) {
    const FeatureEffort features_effort = arguments.quick ? FeatureEffort{9, 7, 0.0015} : FeatureEffort{};
    results.features = measure_features(suite.features, features_effort, progress, mishaps.errors);
  }
  if (arguments.filter.empty() && !arguments.features) {
    progress("memory and start-up");
    results.memory = measure_memory();
    results.start_up = measure_start_up();
  }
  if (arguments.footing) {
    for (int threads = 1; threads <= std::min(2, available_threads()); ++threads) {
      results.runs.push_back(measure_run(footing_case(), threads, progress));
    }
  }
  line.clear();
  fmt::print("{}", text_of(results));
  write_results(results, arguments.json);
  fmt::print("\nwritten to {}\n", arguments.json);
  tell(mishaps);
  const int verdict = before ? tell_comparison(*before, results) : all_good;
  return mishaps.errors.empty() ? verdict : bad_input;
}

int run(const Arguments& arguments) {
  if (arguments.compared.empty()) return measure_all(arguments);
  return tell_comparison(read_results(arguments.compared[0]), read_results(arguments.compared[1]));
}

}  // namespace

int command_line(int argc, char** argv) {
  Arguments arguments;
  arguments.json = (project_root() / "build" / "bench.json").string();
  CLI::App app{
      "Measures whole steps, constitutive laws and shape functions against what the machine can do.\n"
      "Exit code: 0, 1 if something became slower beyond noise, 2 for bad input or an error.",
      "mpmvv bench"};
  auto* json = app.add_option("--json", arguments.json, "where the results go")->capture_default_str();
  auto* quick = app.add_flag("--quick", arguments.quick, "fewer sizes and repetitions: well below a minute");
  auto* filter = app.add_option("--filter", arguments.filter,
                                "only what has a name that matches; no memory, no start-up")
                     ->type_name("REGEX");
  auto* features = app.add_flag("--features", arguments.features,
                                "only what features cost, and that unused ones cost nothing");
  auto* footing = app.add_flag("--footing", arguments.footing,
                               "also the paper's footing from beginning to end (minutes)");
  auto* against = app.add_option("--against", arguments.against, "compare with the results of another time")
                      ->type_name("OLD.json");
  auto* compare = app.add_option("--compare", arguments.compared, "compare two files, measure nothing")
                      ->expected(2)
                      ->type_name("OLD.json NEW.json");
  for (auto* option : {json, quick, filter, features, footing, against}) compare->excludes(option);
  try {
    app.parse(argc, argv);
    return run(arguments);
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", app.help());
    return all_good;
  } catch (const std::exception& error) {
    complain(error.what());
    return bad_input;
  }
}

}  // namespace mpm::bench
