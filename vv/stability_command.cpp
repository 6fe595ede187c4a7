#include "vv/stability_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>

#include "vv/linear_stability.hpp"
#include "vv/machine.hpp"

namespace mpm::vv {
namespace {

namespace fs = std::filesystem;

constexpr const char* about =
    "Survey how large a time step the scenes of a case bear: the limit by the matrix of one step, runs at a "
    "scan of\n"
    "time steps, and what became of each. Writes records, results and a report with the map.\n"
    "Exit codes: 0 surveyed, 1 a survey was not finished, 2 bad input or error.";

/// What is left below a limit: the state moves on, and the limit with it.
constexpr double reserve = 0.8;

/// Of a case: what asks for something that a survey has not.
constexpr std::array left_out{"gates",
                              "probes",
                              "snapshots",
                              "cuts",
                              "measurements",
                              "pairs",
                              "readings",
                              "trades",
                              "trade_without",
                              "advice",
                              "rounding",
                              "metamorphoses",
                              "claims",
                              "figures",
                              "repeat_on_other_threads",
                              "repeat_on_threads",
                              "figure_of_paper",
                              "notes"};

bool names_hencky(const Case& asked) {
  return std::find(asked.references.begin(), asked.references.end(), "hencky") != asked.references.end();
}

/// How many axes, from the first, make at most so many runs.
std::size_t axes_within(const std::vector<SweepAxis>& sweep, std::size_t most_runs) {
  std::size_t runs = 1, axes = 0;
  while (axes < sweep.size() && runs * sweep[axes].values.size() <= most_runs)
    runs *= sweep[axes++].values.size();
  return axes;
}

/// The axes of the sweep that are surveyed; those left out become a note.
void keep_axes(const Case& asked, std::size_t axes, Json& text) {
  if (axes == asked.sweep.size()) return;
  std::string note = "Left as written, to keep the number of surveys small:";
  for (std::size_t k = axes; k < asked.sweep.size(); ++k)
    note += fmt::format("{} {} ({} values)", k == axes ? "" : ",", asked.sweep[k].parameter,
                        asked.sweep[k].values.size());
  text["notes"].push_back(note + ".");
  Json& sweep = text["sweep"];
  sweep.erase(sweep.begin() + static_cast<Json::difference_type>(axes), sweep.end());
  if (sweep.empty()) text.erase("sweep");
}

/// A map of the first axis; the next two separate its panels.
Json map_figure(const Case& asked, std::size_t axes) {
  Json figure = {{"id", "stability_map"},
                 {"kind", "stability"},
                 {"caption", "Time steps over cell size / wave speed, and what became of the runs."}};
  constexpr std::array roles{"map_axis", "panels", "series"};
  for (std::size_t k = 0; k < std::min(axes, roles.size()); ++k) figure[roles[k]] = asked.sweep[k].parameter;
  return figure;
}

// ---- what is told ----

std::string text_of(double fraction) { return fmt::format("{:.3g}", fraction); }

struct Binding {
  double limit;
  std::string what;
};

/// The least of the limits that were found, and which it is.
std::optional<Binding> binding_limit(const Survey& survey) {
  std::optional<Binding> least;
  const auto consider = [&](double limit, const char* what) {
    if (limit > 0.0 && (!least || limit < least->limit)) least = Binding{limit, what};
  };
  if (survey.unstable > 0.0) consider(survey.stable, "runs diverge");
  if (survey.linear.lack.empty()) consider(survey.linear.limit, "a small disturbance grows");
  if (!survey.points.empty() && survey.accurate < survey.points.back().fraction)
    consider(survey.accurate, "answers change");
  return least;
}

std::string setting_of(double fraction, const Record& record) {
  const double seconds = record.time_step / record.survey->own * fraction;
  return fmt::format("stable_fraction {:.2g} ({:.2g} s)", fraction, seconds);
}

}  // namespace

std::string advice_of(const RunVerdict& run) {
  const Record& record = run.record;
  if (!record.failure.empty()) return record.failure;
  const Survey& survey = *record.survey;
  if (survey.unstable > 0.0 && survey.stable == 0.0)
    return fmt::format(
        "take a step well below {}, the least tried: even that run {}", text_of(survey.unstable),
        survey.points.front().stability == StabilityClass::refused ? "was refused" : "diverged");
  const std::optional<Binding> least = binding_limit(survey);
  if (!least)
    return fmt::format("keep {}: nothing went wrong at any step tried", setting_of(survey.own, record));
  const std::string why = fmt::format("{} above {}", least->what, text_of(least->limit));
  const double most = reserve * least->limit;
  if (survey.own > least->limit) return fmt::format("lower it to {}: {}", setting_of(most, record), why);
  if (survey.own > most)
    return fmt::format("lower it to {}, for a reserve: {}", setting_of(most, record), why);
  return fmt::format("keep it, or at most {}: {}", setting_of(most, record), why);
}

Case survey_case(const Case& asked, const Json& survey, std::size_t most_runs) {
  if (!asked.text.contains("scene"))
    throw std::invalid_argument(asked.id + ": an element test has no time steps");
  Json text = asked.text;
  for (const char* key : left_out) text.erase(key);
  if (text.contains("classification")) {
    const Json limits = text["classification"].value("limits", Json::object());
    text["classification"] = {{"limits", limits}};
  }
  text["notes"] = Json::array();
  const std::size_t axes = axes_within(asked.sweep, most_runs);
  keep_axes(asked, axes, text);
  text["id"] = asked.id + "_stability";
  text["title"] = "Time steps: " + asked.title;
  text["references"] = names_hencky(asked) ? Json{"hencky"} : Json::array();
  text["stability"] = asked.text.value("stability", Json::object());
  text["stability"].update(survey);
  text["gates"] = {{{"id", "surveyed"},
                    {"metric", "completed"},
                    {"at_least", 1},
                    {"basis", "requirement"},
                    {"reason", "Every survey that was asked for is finished, whatever it found."}}};
  text["figures"] = {map_figure(asked, axes)};
  return parse_case(text.dump(), asked.file);
}

struct StabilityCommand::Options {
  std::string asked_case, out = "mpmvv-out";
  int threads = core_count();
  std::size_t most_runs = 12;
  std::optional<double> from, to, accuracy;
  std::optional<int> points, bisections;

  Json survey() const {
    Json json = Json::object();
    const auto put = [&](const char* key, const auto& value) {
      if (value) json[key] = *value;
    };
    put("from", from);
    put("to", to);
    put("points", points);
    put("bisections", bisections);
    put("accuracy", accuracy);
    return json;
  }
};

StabilityCommand::StabilityCommand(CLI::App& program)
    : options_(std::make_unique<Options>()), command_(program.add_subcommand("stability", about)) {
  Options& o = *options_;
  command_->add_option("case", o.asked_case, "Case file, or id of a shipped case")->required();
  command_->add_option("--out", o.out, "Directory for records, results and report (default: mpmvv-out)");
  command_->add_option("--threads", o.threads, "Surveys at a time (default: all cores)")
      ->check(CLI::Range(1, 1024));
  command_->add_option("--from", o.from, "Least time step run, over cell size / wave speed (default: 0.1)");
  command_->add_option("--to", o.to, "Largest (default: 3)");
  command_->add_option("--points", o.points, "Time steps from the least to the largest (default: 9)");
  command_->add_option("--bisections", o.bisections, "That follow, towards the limit (default: 5)");
  command_->add_option("--accuracy", o.accuracy, "Relative error of an accurate answer (default: 0.01)");
  command_
      ->add_option("--most", o.most_runs,
                   "Surveys at most; axes of the sweep beyond are left out (default: 12)")
      ->check(CLI::Range(1, 10000));
}

StabilityCommand::~StabilityCommand() = default;

bool StabilityCommand::parsed() const { return command_->parsed(); }

std::string StabilityCommand::out() const { return options_->out; }

int StabilityCommand::threads() const { return options_->threads; }

Case StabilityCommand::surveys(const std::function<fs::path(const std::string&)>& file_of) const {
  const Case asked = read_case(file_of(options_->asked_case));
  return survey_case(asked, options_->survey(), options_->most_runs);
}

void StabilityCommand::tell(const CampaignVerdict& verdict) {
  constexpr const char* row = "{:<{}}  {:>8}  {:>8}  {:>8}  {:>8}  {}\n";
  for (const CaseVerdict& of_case : verdict.cases) {
    fmt::print("{}: {}\n", of_case.definition.id, of_case.definition.title);
    for (const std::string& note : of_case.definition.notes) fmt::print("{}\n", note);
    std::size_t width = 0;
    for (const RunVerdict& run : of_case.runs) width = std::max(width, scope_of(run.parameters).size());
    fmt::print("time steps over cell size / wave speed\n");
    fmt::print(row, "", width, "own", "matrix", "runs", "accurate", "advice");
    for (const RunVerdict& run : of_case.runs) {
      const auto metric = [&](const char* name) {
        const auto found = run.metrics.find(name);
        return found == run.metrics.end() ? "-" : text_of(found->second);
      };
      fmt::print(row, scope_of(run.parameters), width,
                 run.record.survey ? text_of(run.record.survey->own) : "-", metric("stability.linear_limit"),
                 metric("stability.stable"), metric("stability.accurate"), advice_of(run));
    }
  }
}

}  // namespace mpm::vv
