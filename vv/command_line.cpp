#include "vv/command_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "vv/advise_command.hpp"
#include "vv/campaign.hpp"
#include "vv/digitise_command.hpp"
#include "vv/machine.hpp"
#include "vv/revision.hpp"
#include "vv/stability_command.hpp"

namespace mpm::vv {
namespace {

namespace fs = std::filesystem;

enum ExitCode { all_good = 0, gate_failed = 1, bad_input = 2 };

/// One line on standard error, whatever the text.
void complain(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  fmt::print(stderr, "mpmvv: {}\n", text);
}

struct Arguments {
  std::vector<std::string> cases, curves;
  std::string out;
  int threads = core_count();
  bool quick = false;
  PerformanceFiles performance;
};

// ---- cases ----

fs::path shipped_directory() { return project_root() / "vv" / "cases"; }

std::vector<fs::path> shipped_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(shipped_directory())) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) throw std::runtime_error("no case files in " + shipped_directory().string());
  return files;
}

/// A file as the user sees it from where they are or, failing that, a shipped case of that id.
fs::path file_of(const std::string& name) {
  if (fs::exists(name)) return name;
  const fs::path shipped = shipped_directory() / (name + ".json");
  if (name.find('/') == std::string::npos && fs::is_regular_file(shipped)) return shipped;
  throw std::runtime_error(name + ": no such file, nor a shipped case of that id (`mpmvv list` shows them)");
}

/// The cases, or nothing when one of them is bad; then every fault has been told.
template <class Entry, class ToFile>
std::optional<std::vector<Case>> read_all(const std::vector<Entry>& entries, ToFile to_file) {
  std::vector<Case> cases;
  bool good = true;
  for (const Entry& entry : entries) {
    try {
      cases.push_back(read_case(to_file(entry)));
    } catch (const std::exception& error) {
      complain(error.what());
      good = false;
    }
  }
  return good ? std::optional(std::move(cases)) : std::nullopt;
}

// ---- the gate table ----

struct Row {
  std::string status, id, scope, metric, value, threshold, detail;
};

std::string metric_of(const GateResult& gate) {
  return gate.statistic == "value" || gate.statistic.empty() ? gate.metric
                                                             : gate.statistic + " of " + gate.metric;
}

std::string text_of(double value) { return std::isfinite(value) ? fmt::format("{:.4g}", value) : "-"; }

Row row_of(const GateResult& gate, const std::string& scope) {
  return {.status = gate.waits()     ? "WAITS"
                    : !gate.good()   ? "FAIL"
                    : gate.must_fail ? "CONTROL"
                                     : "PASS",
          .id = gate.id,
          .scope = scope,
          .metric = metric_of(gate),
          .value = gate.op == "is" ? gate.found : text_of(gate.value),
          .threshold = gate.op == "is" ? "is " + gate.expected : fmt::format("{} {:.4g}", gate.op, gate.threshold),
          .detail = gate.good() && !gate.must_fail && !gate.waits() ? "" : gate.detail};
}

/// Smaller is closer to the threshold, on either side of it.
double closeness(const GateResult& gate) {
  const double room = margin(gate);
  return std::isfinite(room) ? std::abs(room) : std::abs(gate.value - gate.threshold);
}

/// One row for several results of a gate, in the words of the one that is shown.
Row row_of_several(const std::vector<const GateResult*>& results, const GateResult& shown, const char* which) {
  return row_of(shown, results.size() == 1 ? shown.scope
                                           : fmt::format("{} x, {}: {}", results.size(), which, shown.scope));
}

/// The rows of one gate: every failure, the good results as one row that shows the closest of them, and those that
/// wait for a measurement as one.
std::vector<Row> rows_of(const std::vector<const GateResult*>& results) {
  std::vector<Row> rows;
  std::vector<const GateResult*> good, waiting;
  for (const GateResult* result : results) {
    if (result->waits())
      waiting.push_back(result);
    else if (result->good())
      good.push_back(result);
    else
      rows.push_back(row_of(*result, result->scope));
  }
  if (!good.empty()) {
    const GateResult* shown = good.front();
    for (const GateResult* result : good)
      if (closeness(*result) < closeness(*shown)) shown = result;
    rows.push_back(row_of_several(good, *shown, "closest"));
  }
  if (!waiting.empty()) rows.push_back(row_of_several(waiting, *waiting.front(), "first"));
  return rows;
}

std::vector<Row> rows_of(const CaseVerdict& verdict) {
  std::vector<std::string> ids;
  std::map<std::string, std::vector<const GateResult*>> by_id;
  for (const GateResult* result : gate_results(verdict)) {
    if (!by_id.contains(result->id)) ids.push_back(result->id);
    by_id[result->id].push_back(result);
  }
  std::vector<Row> rows;
  for (const std::string& id : ids) {
    for (Row& row : rows_of(by_id[id])) rows.push_back(std::move(row));
  }
  return rows;
}

std::string heading_of(const CaseVerdict& verdict) {
  const Case& definition = verdict.definition;
  switch (verdict.status) {
    case CaseStatus::pass:
      return fmt::format("{}: pass. {}", definition.id, definition.title);
    case CaseStatus::fail:
      return fmt::format("{}: FAIL. {}", definition.id, definition.title);
    case CaseStatus::not_run:
      return fmt::format("{}: not run, {}.", definition.id, verdict.not_run_reason);
  }
  return definition.id;
}

void print_gates(const CampaignVerdict& verdict) {
  constexpr std::array columns{&Row::status, &Row::id,    &Row::scope,
                               &Row::metric, &Row::value, &Row::threshold};
  std::vector<std::vector<Row>> tables;
  std::array<std::size_t, columns.size()> widths{};
  for (const CaseVerdict& case_verdict : verdict.cases) {
    tables.push_back(rows_of(case_verdict));
    for (const Row& row : tables.back()) {
      for (std::size_t c = 0; c < columns.size(); ++c)
        widths[c] = std::max(widths[c], (row.*columns[c]).size());
    }
  }
  for (std::size_t i = 0; i < tables.size(); ++i) {
    fmt::print("{}\n", heading_of(verdict.cases[i]));
    for (const Row& row : tables[i]) {
      std::string line = " ";
      for (std::size_t c = 0; c < columns.size(); ++c)
        line += fmt::format(" {:<{}} ", row.*columns[c], widths[c]);
      line += " " + row.detail;
      line.erase(line.find_last_not_of(' ') + 1);
      fmt::print("{}\n", line);
    }
  }
}

void print_counts(const CampaignVerdict& verdict, const fs::path& out) {
  const Counts counts = verdict.counts();
  fmt::print("\ncases     {}: {} pass, {} fail, {} not run\n", counts.cases, counts.cases_passed,
             counts.cases_failed, counts.cases_not_run);
  fmt::print("gates     {}: {} pass, {} fail{}\n", counts.gates, counts.gates_passed, counts.gates_failed,
             counts.gates_waiting ? fmt::format(", {} wait for a measurement", counts.gates_waiting) : "");
  fmt::print("controls  {}: {} red as expected, {} not\n", counts.controls, counts.controls_red,
             counts.controls_green);
  fmt::print("runs      {} in {:.1f} s on {} thread{}, {} stored record{} reused\n", counts.runs,
             verdict.wall_seconds, verdict.threads, verdict.threads == 1 ? "" : "s", verdict.reused,
             verdict.reused == 1 ? "" : "s");
  if (verdict.timing_seconds > 0.0)
    fmt::print("timing    {:.1f} s of these, one run at a time\n", verdict.timing_seconds);
  fmt::print("results   {}\n", out.string());
  std::fflush(stdout);
}

// ---- commands ----

/// The absolute directory, created, and shown to be writable before anything runs.
fs::path writable_directory(const fs::path& wanted) {
  const fs::path directory = fs::absolute(wanted).lexically_normal();
  try {
    fs::create_directories(directory);
    const fs::path trial = directory / fmt::format(".mpmvv-{}", ::getpid());
    write_atomically(trial, "");
    fs::remove(trial);
  } catch (const std::system_error& error) {
    throw std::runtime_error(directory.string() + ": cannot write results there: " + error.code().message());
  }
  return directory;
}

/// `tell` says on standard output what was found.
int run_and_report(const std::vector<Case>& cases, const Arguments& arguments, const fs::path& wanted_out,
                   const ReportWriter& reports, void (*tell)(const CampaignVerdict&) = print_gates) {
  const fs::path out = writable_directory(wanted_out);
  if (reports.read_performance) reports.read_performance(arguments.performance);
  const CampaignVerdict verdict =
      run_campaign(cases, {.out = out, .threads = arguments.threads, .quick = arguments.quick});
  constexpr auto replace = Json::error_handler_t::replace;
  write_atomically(out / "results.json", to_json(verdict).dump(2, ' ', false, replace) + "\n");
  tell(verdict);
  print_counts(verdict, out);
  if (reports.write) reports.write(verdict, out);
  return verdict.failed() ? gate_failed : all_good;
}

int list() {
  std::vector<Case> cases;
  const std::vector<fs::path> files = shipped_files();
  bool good = true;
  for (const fs::path& file : files) {
    try {
      cases.push_back(read_case(file));
    } catch (const std::exception& error) {
      complain(error.what());
      good = false;
    }
  }
  std::size_t width = 0;
  for (const Case& definition : cases) width = std::max(width, definition.id.size());
  for (const Case& definition : cases) {
    fmt::print("{:<{}}  {:>4} run{}  {}{}\n", definition.id, width, definition.runs.size(),
               definition.runs.size() == 1 ? " " : "s", definition.title,
               definition.quick ? "" : " (not quick)");
  }
  std::fflush(stdout);
  return good ? all_good : bad_input;
}

/// One line a curve file: what it is, or what is wrong with it.
bool show_curve(const fs::path& file) {
  try {
    const CurveFile curve = read_curve_file(file);
    const std::string content =
        curve.missing ? "missing" : fmt::format("{} rows, {}", curve.rows.size(), curve.origin);
    fmt::print("{:<32}  {:<20}  {}, {}: {}\n", curve.id, content, curve.citation, curve.place, curve.title);
    return true;
  } catch (const std::exception& error) {
    complain(error.what());
    return false;
  }
}

int curves(const Arguments& arguments) {
  std::vector<fs::path> files(arguments.curves.begin(), arguments.curves.end());
  if (files.empty()) {
    for (const auto& entry : fs::directory_iterator(shipped_curves()))
      if (entry.path().extension() == ".json") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
  }
  bool good = true;
  for (const fs::path& file : files) good = show_curve(file) && good;
  std::fflush(stdout);
  return good ? all_good : bad_input;
}

int run(const Arguments& arguments, const ReportWriter& reports) {
  const auto cases = read_all(arguments.cases, file_of);
  if (!cases) return bad_input;
  return run_and_report(*cases, arguments, arguments.out.empty() ? "mpmvv-out" : arguments.out, reports);
}

int report(const Arguments& arguments, const ReportWriter& reports) {
  auto cases = read_all(shipped_files(), [](const fs::path& file) { return file; });
  if (!cases) return bad_input;
  // What the paper shows comes first, in the paper's order.
  std::stable_sort(cases->begin(), cases->end(), [](const Case& a, const Case& b) {
    return std::pair(a.figure_of_paper.empty(), a.figure_of_paper) < std::pair(b.figure_of_paper.empty(), b.figure_of_paper);
  });
  const fs::path out = arguments.out.empty() ? project_root() / "reports" / "out" : fs::path(arguments.out);
  return run_and_report(*cases, arguments, out, reports);
}

int stability(const StabilityCommand& command, const ReportWriter& reports) {
  Arguments arguments;
  arguments.threads = command.threads();
  return run_and_report({command.surveys(file_of)}, arguments, command.out(), reports, StabilityCommand::tell);
}

/// Whether a file of measurements is sound, and this very program could have made it on this machine.
int check_performance(const Arguments& arguments, const ReportWriter& reports) {
  const std::optional<MeasuredBy> by = reports.read_performance(arguments.performance);
  const bool current = by && still_holds(*by, {build_facts().revision, processor_name(), core_count()});
  if (by)
    fmt::print("measured at revision {} on {}, {} cores: {}\n", by->revision, by->processor, by->cores,
               current ? "current" : "not current");
  std::fflush(stdout);
  return current ? all_good : gate_failed;
}

int of_the_front_door(const char* command) {
  complain(fmt::format("'{0}' is done by the front door: ./mpmvv {0}", command));
  return bad_input;
}

/// The commands and what they take.
struct CommandLine {
  CLI::App app{
      "Verification and validation of the Material Point Method.\n"
      "Exit codes: 0 all gates pass, 1 a gate failed, 2 bad input or error.",
      "mpmvv"};
  Arguments arguments;
  CLI::App* list = app.add_subcommand("list", "Show the shipped cases, one line each");
  CLI::App* curves = app.add_subcommand(
      "curves", "Check files of measured curves and show them, one line each; without any, those shipped");
  CLI::App* run = app.add_subcommand("run", "Run cases and judge them");
  CLI::App* report = app.add_subcommand("report", "Run and judge every shipped case and write the report");
  DigitiseCommand digitise{app};
  AdviseCommand advise{app};
  StabilityCommand stability{app};
  CLI::App* check_performance =
      app.add_subcommand("check-performance",
                         "Read a file of measurements; exit code 0 if it is of this revision and machine, "
                         "1 if it is not, 2 if it is bad");
  CLI::App* test = app.add_subcommand("test", "Run every test (ctest)");
  CLI::App* bench = app.add_subcommand("bench", "Measure the kernels (Google Benchmark)");

  CommandLine() {
    const BuildFacts& facts = build_facts();
    app.set_version_flag("--version",
                         fmt::format("mpmvv {} ({}, {})", facts.version, facts.revision, facts.compiler));
    app.require_subcommand(1);
    curves->add_option("file", arguments.curves, "Curve files");
    run->add_option("case", arguments.cases, "Case files, or ids of shipped cases")->required();
    run->add_option("--out", arguments.out, "Directory for records, results and report (default: mpmvv-out)");
    report->add_option("--out", arguments.out, "The same (default: reports/out of the project)");
    report->add_flag("--quick", arguments.quick,
                     "Leave out the slow cases; the report shows them as not run");
    report->add_option("--performance", arguments.performance.file, "Show these measurements of speed (JSON)");
    report
        ->add_option("--performance-history", arguments.performance.history,
                     "Compare them with the earlier ones in this directory")
        ->needs(report->get_option("--performance"));
    report->add_option("--performance-failure", arguments.performance.failure,
                       "Say that measuring failed, and why");
    check_performance->add_option("file", arguments.performance.file, "Measurements of speed (JSON)")->required();
    for (CLI::App* command : {run, report}) {
      command->add_option("--threads", arguments.threads, "Runs at a time (default: all cores)")
          ->check(CLI::Range(1, 1024));
    }
    for (CLI::App* command : {test, bench}) command->allow_extras()->prefix_command();
  }

  int dispatch(const ReportWriter& reports) const {
    if (list->parsed()) return vv::list();
    if (curves->parsed()) return vv::curves(arguments);
    if (run->parsed()) return vv::run(arguments, reports);
    if (report->parsed()) return vv::report(arguments, reports);
    if (digitise.parsed()) return digitise.run(), all_good;
    if (stability.parsed()) return vv::stability(stability, reports);
    if (advise.parsed()) return advise.run(file_of) ? all_good : gate_failed;
    if (check_performance->parsed()) return vv::check_performance(arguments, reports);
    return of_the_front_door(test->parsed() ? "test" : "bench");
  }
};

}  // namespace

bool still_holds(const MeasuredBy& then, const MeasuredBy& now) {
  const bool known = now.revision != "unknown" && !now.revision.ends_with("-dirty");
  return known && then.revision == now.revision && then.processor == now.processor && then.cores == now.cores;
}

int command_line(int argc, char** argv, const ReportWriter& reports) {
  try {
    CommandLine line;
    try {
      line.app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return line.app.exit(error);
      complain(std::string(error.what()) + " (see mpmvv --help)");
      return bad_input;
    }
    return line.dispatch(reports);
  } catch (const std::exception& error) {
    complain(error.what());
    return bad_input;
  }
}

}  // namespace mpm::vv
