#include "vv/advise_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

#include "vv/advice_choice.hpp"
#include "vv/advice_match.hpp"
#include "vv/advised_case.hpp"
#include "vv/json_reader.hpp"
#include "vv/machine.hpp"
#include "vv/measured_trades.hpp"
#include "vv/record.hpp"
#include "vv/scene_match.hpp"

namespace mpm::vv {
namespace {

namespace fs = std::filesystem;

constexpr const char* about =
    "Say which of the measured configurations to take for the scene of a case: the cheapest that meets an\n"
    "error, the most accurate within a time. It rests on what earlier campaigns measured, and on nothing "
    "else.\n"
    "Exit codes: 0 there is one, 1 nothing measured tells of the scene or meets what is asked, 2 bad input "
    "or error.";

void say(const char* what, const std::string& text) { fmt::print("{:<10} {}\n", what, text); }

// ---- texts ----

std::string price_of(const TradePoint& point) {
  const std::string work =
      fmt::format("{:.3g} particle-steps, {:.3g} B moved", point.work.particle_steps, point.work.bytes);
  if (!point.timing) return work;
  return fmt::format("{:.3g} s ({:.3g} to {:.3g}), {}", point.timing->median, point.timing->low,
                     point.timing->high, work);
}

std::string error_of(const TradePoint& point) {
  if (point.uncertainty == 0.0) return fmt::format("error {:.3g}", point.bound());
  return fmt::format("error {:.3g} (found {:.3g}, known to {:.3g})", point.bound(), point.error,
                     point.uncertainty);
}

std::string text_of(const TradePoint& point) {
  return fmt::format("{}: {}, {}", scope_of(point.configuration), error_of(point), price_of(point));
}

/// Seconds if both were timed, else bytes.
double cost_ratio(const TradePoint& one, const TradePoint& other) {
  if (one.timing && other.timing) return one.timing->median / other.timing->median;
  return one.work.bytes / other.work.bytes;
}

/// The days since a date such as "2026-03-01T12:00:00Z", for a person; empty if it is none.
std::string age_of(const std::string& date) {
  std::tm time{};
  if (!::strptime(date.c_str(), "%Y-%m-%dT%H:%M:%SZ", &time)) return "";
  const double seconds = std::difftime(std::time(nullptr), ::timegm(&time));
  const auto days = static_cast<long>(std::floor(std::max(0.0, seconds) / 86400.0));
  return days == 0 ? ", today" : fmt::format(", {} day{} ago", days, days == 1 ? "" : "s");
}

std::string quoted_list(const std::set<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += (list.empty() ? "\"" : ", \"") + text + "\"";
  return list;
}

// ---- what was measured ----

/// Titles of the trades of a case, in their order.
std::vector<std::string> titles_of(const MeasuredCase& measured) {
  std::vector<std::string> titles;
  for (const MeasuredTrade& trade : measured.trades)
    if (!contains(titles, trade.verdict.title)) titles.push_back(trade.verdict.title);
  return titles;
}

/// A trade beside the case, and the campaign it is from.
struct Candidate {
  const MeasuredCampaign* campaign;
  TradeMatch match;
};

/// Every trade of a campaign beside the case, its own first.
std::vector<Candidate> candidates_in(const MeasuredCampaign& campaign, const Case& asked,
                                     const std::string& title, const std::string& problem) {
  std::vector<Candidate> candidates;
  for (const MeasuredCase& measured : campaign.cases) {
    for (const std::string& each : titles_of(measured)) {
      if (!title.empty() && each != title) continue;
      candidates.push_back({&campaign, match_trade(asked, measured, each, problem)});
    }
  }
  std::stable_partition(candidates.begin(), candidates.end(),
                        [&](const Candidate& candidate) { return candidate.match.measured->id == asked.id; });
  return candidates;
}

/// Throws where a scene was measured and the problem that is named is all it lacks.
void require_problem(const std::vector<Candidate>& candidates) {
  for (const Candidate& candidate : candidates) {
    const std::vector<Difference>& differences = candidate.match.differences;
    if (differences.size() == 1 && differences[0].pointer == problem_option)
      throw std::runtime_error(fmt::format("{}: expected a problem of the case ({}), found \"{}\"",
                                           problem_option, differences[0].there, differences[0].here));
  }
}

}  // namespace

struct AdviseCommand::Options {
  std::string asked_case, from, problem, trade, apply;
  double error = 0.0, time = 0.0;
  bool force = false;

  std::vector<fs::path> directories() const;
  std::vector<MeasuredCampaign> campaigns() const;
  std::optional<Candidate> matching(const std::vector<Candidate>& candidates) const;
  Choice chosen(const TradeVerdict& measured) const;
  std::string question() const;
  bool answer(const Case& asked, const Candidate& found) const;
};

namespace {

// ---- answers ----

void tell_lack(const std::vector<Candidate>& candidates, const std::vector<MeasuredCampaign>& campaigns) {
  for (const MeasuredCampaign& campaign : campaigns) say("looked in", campaign.file.string());
  fmt::print("nothing that was measured is like this scene\n");
  const auto nearest =
      std::min_element(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return a.match.differences.size() < b.match.differences.size();
      });
  if (nearest != candidates.end()) {
    say("nearest", fmt::format("{}, {}", nearest->match.measured->id, nearest->match.title));
    constexpr std::size_t most = 8;
    for (std::size_t k = 0; k < nearest->match.differences.size() && k < most; ++k) {
      const Difference& difference = nearest->match.differences[k];
      say("differs",
          fmt::format("{}: {} here, {} there", difference.pointer, difference.here, difference.there));
    }
    if (nearest->match.differences.size() > most)
      say("", fmt::format("and {} more", nearest->match.differences.size() - most));
  }
  say("measure it",
      "give a case with this scene a sweep over configurations and an entry under \"trades\" "
      "(vv/cases/README.md), 'mpmvv run' it, and ask again with --from");
}

/// The programs that simulated a configuration of the near problems.
std::set<std::string> programs_of(const TradeMatch& match, const TradePoint& point) {
  std::set<std::string> programs;
  const std::vector<const TradeVerdict*> near = match.near();
  for (const MeasuredTrade& trade : match.measured->trades) {
    if (std::find(near.begin(), near.end(), &trade.verdict) == near.end()) continue;
    for (std::size_t k = 0; k < trade.verdict.points.size(); ++k)
      if (trade.verdict.points[k].configuration == point.configuration)
        programs.insert(trade.program_hashes[k]);
  }
  return programs;
}

const Json& changes_of(const TradeMatch& match, const TradePoint& point) {
  for (const MeasuredTrade& trade : match.measured->trades) {
    if (&trade.verdict != match.near().front()) continue;
    for (std::size_t k = 0; k < trade.verdict.points.size(); ++k)
      if (trade.verdict.points[k].configuration == point.configuration) return trade.changes[k];
  }
  throw std::logic_error("a configuration that was not measured");
}

void tell_freshness(const Candidate& candidate, const TradePoint& point) {
  const MeasuredCampaign& campaign = *candidate.campaign;
  const bool same_code = programs_of(candidate.match, point) == std::set<std::string>{program_hash()};
  const bool same_processor = campaign.processor == processor_name();
  say("measured",
      fmt::format("at revision {}, {}{}", campaign.revision, campaign.date, age_of(campaign.date)));
  say("", same_code ? "by the code that simulates in this program"
                    : "by other code than simulates in this program: errors and prices may have moved");
  say("", same_processor ? fmt::format("on this processor ({})", campaign.processor)
                         : fmt::format("on {}, not on this {}: seconds may differ", campaign.processor,
                                       processor_name()));
}

void tell_choice(const TradeVerdict& trade, const Choice& choice, double error, double time) {
  const TradePoint& point = trade.points[*choice.point];
  say("take", text_of(point));
  if (error > 0.0) {
    say("margin", point.bound() > 0.0 ? fmt::format("the error asked for is {:.3g} times what is promised",
                                                    error / point.bound())
                                      : "no error was found");
  }
  if (time > 0.0)
    say(error > 0.0 ? "" : "margin",
        fmt::format("the time asked for is {:.3g} times the slowest repeat", time / point.timing->high));
  if (choice.runner_up) {
    const TradePoint& next = trade.points[*choice.runner_up];
    say("runner-up", fmt::format("{}; costs {:.3g} times as much", text_of(next), cost_ratio(next, point)));
  } else {
    say("runner-up", "none: no other configuration meets it");
  }
  if (choice.cheaper) {
    const TradePoint& lost = trade.points[*choice.cheaper];
    const std::string loss =
        point.bound() > 0.0 ? fmt::format(" and has {:.3g} times the error", lost.bound() / point.bound())
                            : "";
    say("cheaper",
        fmt::format("{}; saves {:.0f} %{}", text_of(lost), 100.0 * (1.0 - cost_ratio(lost, point)), loss));
  } else {
    say("cheaper", "nothing that was measured is");
  }
}

/// What comes closest to being chosen.
void tell_nearest_miss(const TradeVerdict& trade, double error, double time) {
  fmt::print("nothing measured meets it\n");
  const TradePoint *best = nullptr, *fastest = nullptr;
  for (const TradePoint& point : trade.points) {
    if (!is_offer(point)) continue;
    if (!best || point.bound() < best->bound()) best = &point;
    if (point.timing && (!fastest || point.timing->high < fastest->timing->high)) fastest = &point;
  }
  const Choice quick = most_accurate_within(trade, time);
  if (error > 0.0 && quick.point) say("nearest", "within the time: " + text_of(trade.points[*quick.point]));
  if (error > 0.0 && best) say("nearest", "most accurate: " + text_of(*best));
  if (time > 0.0 && fastest) say("nearest", "fastest: " + text_of(*fastest));
  if (time > 0.0 && !fastest) say("nearest", "no configuration has been timed");
  if (!best) say("nearest", "no configuration has an error");
}

}  // namespace

std::vector<fs::path> AdviseCommand::Options::directories() const {
  if (!from.empty()) return {from};
  return {project_root() / "reports" / "out", "mpmvv-out"};
}

std::vector<MeasuredCampaign> AdviseCommand::Options::campaigns() const {
  std::vector<MeasuredCampaign> campaigns;
  for (const fs::path& directory : directories())
    if (!from.empty() || fs::exists(directory / "results.json"))
      campaigns.push_back(read_measured_campaign(directory));
  if (campaigns.empty())
    throw std::runtime_error("no results in " + directories()[0].string() +
                             " nor in mpmvv-out: run the report, or say --from");
  return campaigns;
}

std::optional<Candidate> AdviseCommand::Options::matching(const std::vector<Candidate>& candidates) const {
  const auto alike = [](const Candidate& candidate) { return candidate.match.alike(); };
  const auto first = std::find_if(candidates.begin(), candidates.end(), alike);
  if (first == candidates.end()) return require_problem(candidates), std::nullopt;
  std::set<std::string> titles;
  for (const Candidate& candidate : candidates)
    if (alike(candidate) && candidate.match.measured == first->match.measured)
      titles.insert(candidate.match.title);
  if (titles.size() > 1)
    throw std::runtime_error("--trade: expected one of " + quoted_list(titles) +
                             ", which were measured for this scene");
  return *first;
}

Choice AdviseCommand::Options::chosen(const TradeVerdict& measured) const {
  if (error == 0.0) return most_accurate_within(measured, time);
  if (time == 0.0) return cheapest_within(measured, error, true);
  TradeVerdict quick = measured;
  for (TradePoint& point : quick.points)
    if (!point.timing || point.timing->high > time) point.failure = "slower than asked";
  return cheapest_within(quick, error, true);
}

std::string AdviseCommand::Options::question() const {
  std::string text = error > 0.0 ? fmt::format("error at most {:g}", error) : "";
  if (time > 0.0) text += fmt::format("{}time at most {:g} s", text.empty() ? "" : ", ", time);
  return text;
}

/// False if nothing meets what is asked.
bool AdviseCommand::Options::answer(const Case& asked, const Candidate& found) const {
  const TradeMatch& match = found.match;
  const TradeVerdict measured = worst_of(match.near());
  fmt::print("{}: {} ({})\n", asked.id, match.title, measured.error_name);
  say("from", fmt::format("{}, case {}, {}{}: {} configurations", found.campaign->file.string(),
                          match.measured->id, names_of_problems(match.near()),
                          match.between()           ? ", between which this problem lies; the worse counts"
                          : match.near().size() > 1 ? ", of which the worst counts"
                                                    : "",
                          measured.points.size()));
  say("asked", question());
  const Choice choice = chosen(measured);
  if (!choice.point) return tell_nearest_miss(measured, error, time), false;
  const TradePoint& point = measured.points[*choice.point];
  tell_choice(measured, choice, error, time);
  tell_freshness(found, point);
  if (apply.empty()) return true;
  const std::string source = fmt::format("{} at revision {} ({})", match.measured->id,
                                         found.campaign->revision, found.campaign->date);
  write_advised_case(asked, match, {point, changes_of(match, point), source}, apply, force);
  say("written", apply + ": 'mpmvv run " + apply + "' holds it to its promise");
  return true;
}

AdviseCommand::AdviseCommand(CLI::App& program)
    : options_(std::make_unique<Options>()), command_(program.add_subcommand("advise", about)) {
  Options& o = *options_;
  command_->add_option("case", o.asked_case, "Case file, or id of a shipped case")->required();
  command_->add_option("--error", o.error, "Relative error, at most, such as 0.01")
      ->check(CLI::PositiveNumber);
  command_->add_option("--time", o.time, "Seconds on one thread, at most")->check(CLI::PositiveNumber);
  command_->add_option(
      "--from", o.from,
      "Directory of the results to draw on (default: reports/out of the project, then mpmvv-out)");
  command_->add_option("--problem", o.problem,
                       "Which problem of a case that is swept over several, such as 50G");
  command_->add_option("--trade", o.trade, "Title of the trade, where a scene has several");
  command_->add_option("--apply", o.apply,
                       "Write the case with that configuration, and a gate on its promise, into this file");
  command_->add_flag("--force", o.force, "Replace that file if it is there already");
}

AdviseCommand::~AdviseCommand() = default;

bool AdviseCommand::parsed() const { return command_->parsed(); }

bool AdviseCommand::run(const std::function<fs::path(const std::string&)>& file_of) const {
  const Options& o = *options_;
  if (o.error == 0.0 && o.time == 0.0) throw std::runtime_error("advise: say --error, --time or both");
  const Case asked = read_case(file_of(o.asked_case));
  if (!asked.text.contains("scene"))
    throw std::runtime_error(o.asked_case + ": an element test has no scene to configure");
  const std::vector<MeasuredCampaign> campaigns = o.campaigns();
  std::vector<Candidate> candidates;
  for (const MeasuredCampaign& campaign : campaigns)
    for (Candidate& candidate : candidates_in(campaign, asked, o.trade, o.problem))
      candidates.push_back(std::move(candidate));
  const std::optional<Candidate> found = o.matching(candidates);
  if (!found) tell_lack(candidates, campaigns);
  const bool answered = found && o.answer(asked, *found);
  std::fflush(stdout);
  return answered;
}

}  // namespace mpm::vv
