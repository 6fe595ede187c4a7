#include "reports/stability_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "reports/figure_parts.hpp"
#include "reports/figures.hpp"
#include "reports/stability_figures.hpp"
#include "vv/precision_pilots.hpp"

namespace mpm::reports {
namespace {

using data = PageData;
using Class = vv::StabilityClass;

constexpr Class all_classes[] = {Class::accurate,    Class::inaccurate, Class::drifting,
                                 Class::oscillating, Class::diverged,   Class::refused};

std::string plural(std::size_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

/// A word in the frame of good, of fair or of bad news.
std::string chip_of(Class stability) {
  const bool good = stability == Class::accurate, fair = stability == Class::refused;
  return chip(good ? "pass" : fair ? "open" : "contrary", vv::name_of(stability));
}

// ---- maps and limits
// --------------------------------------------------------------------------------------------

data map_entries(const vv::CampaignVerdict& verdict) {
  data entries = list();
  for (const vv::CaseVerdict& c : verdict.cases) {
    if (c.status == vv::CaseStatus::not_run) continue;
    for (const vv::FigureRequest& figure : c.definition.figures)
      if (figure.kind == "stability")
        entries << object({{"anchor", c.definition.id + "-" + figure.id},
                           {"title", c.definition.title},
                           {"caption", figure.caption}});
  }
  return entries;
}

std::string fraction_or_dash(double fraction) { return fraction > 0.0 ? number_markup(fraction, 3) : "–"; }

/// "0.48 … 0.52": the last stable time step and the first that was not.
std::string limit_by_runs(const vv::Survey& survey) {
  if (survey.points.empty()) return "–";
  if (!(survey.unstable > 0.0)) return "≥ " + number_markup(survey.stable, 3);
  if (!(survey.stable > 0.0)) return "< " + number_markup(survey.unstable, 3);
  return number_markup(survey.stable, 3) + "\u00a0…\u00a0" + number_markup(survey.unstable, 3);
}

/// The largest time step that nothing found here speaks against; 0 if that is none.
double bearable(const vv::Survey& survey) {
  if (survey.points.empty()) return survey.linear.limit;
  return survey.accurate > 0.0 ? survey.accurate : survey.stable;
}

std::string advice_on(const vv::Survey& survey) {
  const double most = bearable(survey);
  if (!(most > 0.0)) return "no time step that was tried will do: another scheme or setting is needed";
  const bool accurate = survey.accurate > 0.0, tried = !survey.points.empty();
  const std::string how = !tried ? "stable by the matrix" : accurate ? "accurate" : "stable, if not accurate";
  if (!(survey.own > 0.0)) return fmt::format("take at most {}: {}", number_markup(most, 2), how);
  if (survey.own > most * (1.0 + 1e-9))
    return fmt::format("take at most {}, {} of its own: beyond it is not {}", number_markup(most, 2),
                       number_markup(most / survey.own, 2), how);
  const double room = most / survey.own;
  if (room < 1.05) return "its own is as large as will do";
  return fmt::format("its own is {}; {} times as much would be, too", how, number_markup(room, 2));
}

/// More surveys than this are told method by method, by their least; every one of them is in its map and in results.json.
constexpr std::size_t most_single_surveys = 12;

using Surveys = std::vector<const vv::RunVerdict*>;

/// The surveys of a case one by one or, of many, those of the same scheme, update order and gravity together.
std::vector<Surveys> groups_of_surveys(const vv::CaseVerdict& c) {
  Surveys all;
  std::map<std::string, Surveys> groups;
  std::vector<std::string> order;
  for (std::size_t k = 0; k < c.runs.size(); ++k) {
    if (!c.runs[k].record.survey) continue;
    all.push_back(&c.runs[k]);
    const Scene& scene = c.definition.runs[k].scene;
    const std::string method = fmt::format("{} {} {} {}", static_cast<int>(scene.scheme), static_cast<int>(scene.update_order),
                                           scene.gravity.level, scene.light_nodes.value_or(0.0));
    if (!groups.contains(method)) order.push_back(method);
    groups[method].push_back(&c.runs[k]);
  }
  std::vector<Surveys> told;
  if (all.size() <= most_single_surveys) {
    for (const vv::RunVerdict* run : all) told.push_back({run});
  } else {
    for (const std::string& method : order) told.push_back(groups[method]);
  }
  return told;
}

/// What all runs have in common.
Parameters common_to(const std::vector<const vv::RunVerdict*>& runs) {
  Parameters common = runs.front()->parameters;
  for (const vv::RunVerdict* run : runs)
    std::erase_if(common, [&](const auto& parameter) {
      return std::find(run->parameters.begin(), run->parameters.end(), parameter) == run->parameters.end();
    });
  return common;
}

/// What all of them have in common, and how many they are.
std::string name_of_surveys(const Surveys& surveys) {
  const Parameters common = common_to(surveys);
  if (surveys.size() == 1) return name_of_run(common);
  return (common.empty() ? std::string() : name_of_run(common) + ", ") + plural(surveys.size(), "scene");
}

const vv::Survey& survey_of(const vv::RunVerdict* run) { return *run->record.survey; }

/// The survey with the least of a number.
template <class Number>
const vv::Survey& least_by(const Surveys& surveys, Number&& number) {
  return survey_of(*std::min_element(surveys.begin(), surveys.end(), [&](const auto* a, const auto* b) {
    return number(survey_of(a)) < number(survey_of(b));
  }));
}

data limit_entry(const vv::CaseVerdict& c, const Surveys& surveys) {
  const vv::Survey& by_matrix = least_by(surveys, [](const vv::Survey& s) { return s.linear.limit; });
  const vv::Survey& by_runs = least_by(surveys, [](const vv::Survey& s) { return s.stable; });
  const vv::Survey& accurate = least_by(surveys, [](const vv::Survey& s) { return s.accurate; });
  const vv::Survey& worst = least_by(surveys, bearable);
  std::vector<double> formulas;
  for (const vv::RunVerdict* run : surveys) {
    const auto formula = run->metrics.find("stability.formula");
    if (formula != run->metrics.end()) formulas.push_back(formula->second);
  }
  const bool all_known = formulas.size() == surveys.size();
  return object({{"case_id", c.definition.id},
                 {"name", name_of_surveys(surveys)},
                 {"own", fraction_or_dash(worst.own)},
                 {"matrix", fraction_or_dash(by_matrix.linear.limit)},
                 {"matrix_lack", by_matrix.linear.lack},
                 {"formula", all_known ? number_markup(*std::min_element(formulas.begin(), formulas.end()), 3) : "–"},
                 {"runs", limit_by_runs(by_runs)},
                 {"accurate", accurate.points.empty() ? "–" : fraction_or_dash(accurate.accurate)},
                 {"error", accurate.points.empty() ? "" : accurate.error_name},
                 {"advice", advice_on(worst)}});
}

data limit_entries(const vv::CampaignVerdict& verdict) {
  data entries = list();
  for (const vv::CaseVerdict& c : verdict.cases)
    for (const Surveys& surveys : groups_of_surveys(c)) entries << limit_entry(c, surveys);
  return entries;
}

// ---- extremes
// ---------------------------------------------------------------------------------------------------

/// The run's result of a gate that names classes; null without one.
const vv::GateResult* class_gate_of(const vv::RunVerdict& run) {
  for (const vv::GateResult& gate : run.gates)
    if (gate.op == "is") return &gate;
  return nullptr;
}

/// What the run was told by: "drift 0.02, ringing 0.001, zig-zag 0.3, error 4 %"; of one that was not
/// simulated to its end nothing.
std::string measures_cell(const vv::RunVerdict& run) {
  if (run.behaviour.failed || run.behaviour.refused) return "–";
  const std::pair<const char*, double> measures[] = {{"drift", run.behaviour.signal.drift},
                                                     {"ringing", run.behaviour.signal.ringing},
                                                     {"zig-zag", run.behaviour.zigzag},
                                                     {"error", run.behaviour.error}};
  std::string text;
  for (const auto& [name, value] : measures)
    if (value != 0.0)
      text += fmt::format("{}{}\u00a0{}", text.empty() ? "" : ", ", name, number_markup(value, 2));
  return text.empty() ? "nothing amiss" : text;
}

/// How it ended, where that is the answer; else what the gate says.
std::string diagnosis_cell(const vv::RunVerdict& run, const vv::RunRequest* request) {
  if (request && !request->refusal.empty()) return escaped(request->refusal);
  const vv::Record& record = run.record;
  if (!record.failure.empty()) return escaped(record.failure);
  if (!record.completed()) {
    std::string text = name_of_ending(record) + place_of_ending(record);
    const Outcome& outcome = record.outcome;
    if (outcome.particle >= 0) text += fmt::format(", particle {}", outcome.particle);
    if (std::isfinite(outcome.value)) text += ", value " + number_markup(outcome.value, 3);
    if (record.last_good)
      text += "; good up to <i>t</i> = " + number_markup(record.last_good->time, 3) + " s";
    return text;
  }
  const vv::GateResult* gate = class_gate_of(run);
  const bool is_well = run.stability == Class::accurate;
  return gate && !is_well ? escaped(gate->detail) : "";
}

data extreme_row(const vv::CaseVerdict& c, std::size_t number) {
  const vv::RunVerdict& run = c.runs[number];
  const vv::RunRequest* request = number < c.definition.runs.size() ? &c.definition.runs[number] : nullptr;
  const vv::GateResult* gate = class_gate_of(run);
  return object({{"case_id", c.definition.id},
                 {"name", name_of_run(run.parameters)},
                 {"expected", gate ? escaped(gate->expected) : "–"},
                 {"found", run.stability ? chip_of(*run.stability) : chip("fail", "NOT TOLD")},
                 {"measures", measures_cell(run)},
                 {"diagnosis", diagnosis_cell(run, request)},
                 {"advice", gate ? gate->advice : ""},
                 {"verdict", !gate          ? chip("open", "no gate")
                             : gate->good() ? chip("pass", "as expected")
                                            : chip("fail", "SURPRISE")}});
}

/// Of runs alike in what was expected and found: the one whose error is largest, which tells for all.
const vv::RunVerdict& telling(const std::vector<const vv::RunVerdict*>& runs) {
  return **std::max_element(runs.begin(), runs.end(),
                            [](const auto* a, const auto* b) { return a->behaviour.error < b->behaviour.error; });
}

/// Runs of one expectation and one class, in one row.
data expectation_row(const vv::CaseVerdict& c, const std::vector<const vv::RunVerdict*>& runs) {
  const vv::RunVerdict& shown = telling(runs);
  const auto number = static_cast<std::size_t>(&shown - c.runs.data());
  const Parameters common = common_to(runs);
  data row = extreme_row(c, number);
  const std::string name = common.empty() ? "all sorts" : name_of_run(common);
  row.set("name", runs.size() == 1 ? name_of_run(shown.parameters)
                                   : name + "<br><small>" + plural(runs.size(), "run") + ", told by " +
                                         name_of_run(shown.parameters) + "</small>");
  const vv::GateResult* gate = class_gate_of(shown);
  row.set("reason", gate ? gate->reason : "");
  return row;
}

/// The runs of a case by gate and class found, in the order in which they come.
data expectation_rows(const vv::CaseVerdict& c) {
  std::map<std::string, std::vector<const vv::RunVerdict*>> groups;
  std::vector<std::string> order;
  for (const vv::RunVerdict& run : c.runs) {
    const vv::GateResult* gate = class_gate_of(run);
    const std::string key = (gate ? gate->id : "") + "/" + (run.stability ? vv::name_of(*run.stability) : "");
    if (!groups.contains(key)) order.push_back(key);
    groups[key].push_back(&run);
  }
  data rows = list();
  for (const std::string& key : order) rows << expectation_row(c, groups[key]);
  return rows;
}

bool classifies(const vv::CaseVerdict& c) {
  return c.status != vv::CaseStatus::not_run &&
         std::any_of(c.runs.begin(), c.runs.end(), [](const vv::RunVerdict& run) {
           return run.stability.has_value() || class_gate_of(run) != nullptr;
         });
}

void set_extremes(data& page, const vv::CampaignVerdict& verdict) {
  std::map<Class, std::size_t> counts, surprising;
  data cases = list(), surprises = list();
  for (const vv::CaseVerdict& c : verdict.cases) {
    if (!classifies(c)) continue;
    data entry = object({{"case_id", c.definition.id}, {"title", c.definition.title}});
    data rows = list();
    for (std::size_t run = 0; run < c.runs.size(); ++run) {
      rows << extreme_row(c, run);
      const vv::GateResult* gate = class_gate_of(c.runs[run]);
      const bool surprise = gate && !gate->good();
      if (surprise) surprises << extreme_row(c, run);
      if (!c.runs[run].stability) continue;
      ++counts[*c.runs[run].stability];
      surprising[*c.runs[run].stability] += surprise;
    }
    entry.set("rows", rows);
    entry.set("expectations", expectation_rows(c));
    entry.set("count", plural(c.runs.size(), "run"));
    cases << entry;
  }
  data summary = list();
  for (const Class stability : all_classes)
    if (counts[stability] > 0)
      summary << object({{"class", chip_of(stability)},
                         {"count", std::to_string(counts[stability])},
                         {"surprising", std::to_string(surprising[stability])}});
  set_list(page, "class_counts", summary);
  set_list(page, "surprises", surprises);
  set_list(page, "extremes", cases);
}

// ---- rounding
// ---------------------------------------------------------------------------------------------------

bool is_of_baseline(const vv::RoundingRequest& request, const std::string& parameter) {
  return std::any_of(request.baseline.begin(), request.baseline.end(),
                     [&](const vv::Selector& selector) { return selector.parameter == parameter; });
}

/// The run's values of the axes of the baseline, or of all others.
Parameters part_of(const Parameters& parameters, const vv::RoundingRequest& request, bool of_baseline) {
  Parameters part;
  for (const auto& entry : parameters)
    if (is_of_baseline(request, entry.first) == of_baseline) part.push_back(entry);
  return part;
}

/// "1.2×10⁻⁷, 6.9 digits".
std::string rounding_cell(double rounding, double digits) {
  if (rounding == 0.0) return "none";
  return fmt::format("{}<br><small>{:.1f} digits</small>", number_markup(rounding, 2), digits);
}

std::string enough_chip(const vv::RoundingRow& row) {
  if (!row.lack.empty()) return chip("open", "not compared");
  if (row.bits_equal) return chip("pass", "same bits");
  if (std::isnan(row.share)) return chip("open", "not known");
  return row.is_enough() ? chip("pass", "enough") : chip("contrary", "not enough");
}

data rounding_row(const vv::CaseVerdict& c, const vv::RoundingRow& row) {
  const vv::RoundingRequest& request = *c.definition.rounding;
  const Parameters& parameters = c.runs[row.run].parameters;
  const Parameters problem = part_of(parameters, request, false);
  data entry = object({{"problem", problem.empty() ? "–" : name_of_run(problem)},
                       {"way", name_of_run(part_of(parameters, request, true))},
                       {"lack", row.lack},
                       {"chip", enough_chip(row)}});
  entry.set("numbers", flag(row.lack.empty()));
  entry.set("displacement", rounding_cell(row.displacement, row.digits_of_displacement));
  entry.set("stress", rounding_cell(row.stress, row.digits_of_stress));
  entry.set("cells_of_displacement", number_markup(row.cells_of_displacement, 2));
  entry.set("cells_of_stress", number_markup(row.cells_of_stress, 2));
  entry.set("share", std::isnan(row.share) ? "–" : number_markup(100.0 * row.share, 2) + "\u00a0%");
  return entry;
}

/// What came of one way to compute, over the problems of a case.
struct WayVerdict {
  std::size_t compared = 0, enough = 0, equal = 0, unknown = 0, lacking = 0;
  double worst = 0.0;  ///< share
  std::string where;   ///< the problem with the worst share, markup
};

/// "float is enough for all 6 runs; it adds at most 3 % to the error of the cells (50G)".
std::string sentence_on(const std::string& way, const WayVerdict& found) {
  std::string text = "<b>" + way + "</b> ";
  if (found.compared == 0) return text + "could not be compared.";
  const std::size_t known = found.compared - found.unknown;
  const std::string at = found.where.empty() ? "" : " (" + found.where + ")";
  const std::string most =
      fmt::format("at most {}\u00a0% of the error of the cells{}", number_markup(100.0 * found.worst, 2), at);
  if (found.equal == found.compared)
    text += "gives the same bits in all of " + plural(found.compared, "run");
  else if (known == 0)
    text += "cannot be judged: the error of the cells is not known";
  else if (found.enough == known)
    text += fmt::format("is enough in all of {}: rounding is {}", plural(known, "run"), most);
  else if (found.enough == 0)
    text += fmt::format("is not enough in any of {}: rounding is {}", plural(known, "run"), most);
  else
    text += fmt::format("is enough in {} of {}, and not in the others: rounding is {}", found.enough,
                        plural(known, "run"), most);
  if (found.unknown > 0 && known > 0)
    text += fmt::format("; of {} the error of the cells is not known", plural(found.unknown, "run"));
  if (found.lacking > 0) text += fmt::format("; {} could not be compared", plural(found.lacking, "run"));
  return text + ".";
}

data way_entries(const vv::CaseVerdict& c) {
  const vv::RoundingRequest& request = *c.definition.rounding;
  std::vector<std::pair<std::string, WayVerdict>> ways;
  for (const vv::RoundingRow& row : c.rounding) {
    const Parameters& parameters = c.runs[row.run].parameters;
    const std::string name = name_of_run(part_of(parameters, request, true));
    auto way = std::find_if(ways.begin(), ways.end(), [&](const auto& known) { return known.first == name; });
    if (way == ways.end()) way = ways.insert(ways.end(), {name, WayVerdict()});
    WayVerdict& found = way->second;
    if (!row.lack.empty()) {
      ++found.lacking;
      continue;
    }
    ++found.compared;
    found.equal += row.bits_equal;
    found.unknown += std::isnan(row.share);
    found.enough += row.is_enough();
    if (!(row.share > found.worst)) continue;
    found.worst = row.share;
    const Parameters problem = part_of(parameters, request, false);
    found.where = problem.empty() ? "" : name_of_run(problem);
  }
  data entries = list();
  for (const auto& [name, found] : ways) entries << object({{"text", sentence_on(name, found)}});
  return entries;
}

data rounding_entries(const vv::CampaignVerdict& verdict) {
  data entries = list();
  for (const vv::CaseVerdict& c : verdict.cases) {
    if (c.rounding.empty() || !c.definition.rounding) continue;
    data entry = object({{"case_id", c.definition.id}, {"title", c.definition.title}});
    entry.set("ways", way_entries(c));
    data rows = list();
    for (const vv::RoundingRow& row : c.rounding) rows << rounding_row(c, row);
    entry.set("rows", rows);
    entries << entry;
  }
  return entries;
}

data thread_entries(const vv::CampaignVerdict& verdict) {
  data entries = list();
  for (const vv::CaseVerdict& c : verdict.cases) {
    std::size_t runs = 0, repeats = 0;
    double differing = 0.0;
    std::set<int> threads;
    for (const vv::RunVerdict& run : c.runs) {
      const auto differ = run.metrics.find("bits_differ");
      if (differ == run.metrics.end()) continue;
      ++runs;
      differing += differ->second;
      repeats += run.record.repeats.size() + !run.record.repeat_digest.empty();
      threads.insert(run.record.step_threads);
      for (const auto& [count, digest] : run.record.repeats) threads.insert(count);
      if (!run.record.repeat_digest.empty()) threads.insert(run.record.step_threads == 1 ? 2 : 1);
    }
    if (runs == 0) continue;
    entries << object(
        {{"case_id", c.definition.id},
         {"title", c.definition.title},
         {"runs", std::to_string(runs)},
         {"threads", fmt::format("{}", fmt::join(threads, ", "))},
         {"repeats", std::to_string(repeats)},
         {"chip", differing == 0.0 ? chip("pass", "same bits")
                                   : chip("fail", fmt::format("{} DIFFER", differing).c_str())}});
  }
  return entries;
}

}  // namespace

void set_stability_overview(PageData& page, const vv::CampaignVerdict& verdict) {
  const std::pair<const char*, data> lists[] = {{"maps", map_entries(verdict)},
                                                {"limits", limit_entries(verdict)},
                                                {"roundings", rounding_entries(verdict)},
                                                {"thread_repeats", thread_entries(verdict)}};
  bool any = std::any_of(verdict.cases.begin(), verdict.cases.end(), classifies);
  for (const auto& [name, entries] : lists) {
    set_list(page, name, entries);
    any = any || !entries.is_empty_list();
  }
  set_extremes(page, verdict);
  page.set("has_stability", flag(any));
  page.set("allowed_share", number_markup(100.0 * vv::allowed_rounding_share, 0) + "\u00a0%");
}

}  // namespace mpm::reports
