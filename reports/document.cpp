#include "reports/document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string_view>

#include "reports/advice_section.hpp"
#include "reports/canvas.hpp"
#include "reports/figures.hpp"
#include "reports/last_good.hpp"
#include "reports/model_choices.hpp"
#include "reports/page_data.hpp"
#include "reports/performance_section.hpp"
#include "reports/stability_section.hpp"
#include "reports/trade_section.hpp"
#include "reports/trade_svg.hpp"
#include "reports/validation_section.hpp"
#include "vv/curves.hpp"
#include "vv/norms.hpp"

namespace mpm::reports {

std::string_view document_template();
std::string_view document_style();
std::string_view trade_script();

namespace {

using data = PageData;
using Parameters = std::vector<std::pair<std::string, vv::Json>>;

// ---- statuses
// ---------------------------------------------------------------------------------------------------

std::string chip_of(vv::CaseStatus status) {
  switch (status) {
    case vv::CaseStatus::pass:
      return chip("pass", "PASS");
    case vv::CaseStatus::fail:
      return chip("fail", "FAIL");
    case vv::CaseStatus::not_run:
      return chip("open", "NOT RUN");
  }
  return chip("fail", "UNKNOWN");
}

std::string chip_of(vv::GateStatus status) {
  switch (status) {
    case vv::GateStatus::pass:
      return chip("pass", "PASS");
    case vv::GateStatus::fail:
      return chip("fail", "FAIL");
    case vv::GateStatus::red_as_expected:
      return chip("expected", "red as expected");
    case vv::GateStatus::unexpectedly_green:
      return chip("fail", "GREEN, must be red");
    case vv::GateStatus::no_measurement:
      return chip("open", "no measurement");
  }
  return chip("fail", "UNKNOWN");
}

// ---- gates
// ------------------------------------------------------------------------------------------------------

/// A gate result with the runs it was applied to, named as everywhere in the report.
struct PlacedGate {
  const vv::GateResult* result = nullptr;
  std::string scope;  ///< markup
};

/// The scope of a series gate with its runs named as everywhere in the report.
std::string scope_of_series(const vv::SeriesVerdict& series, const vv::GateResult& gate) {
  const std::string fixed = vv::scope_of(series.fixed);
  if (series.fixed.empty() || !gate.scope.starts_with(fixed)) return escaped(gate.scope);
  return name_of_run(series.fixed) + escaped(gate.scope.substr(fixed.size()));
}

std::vector<PlacedGate> gates_of(const vv::CaseVerdict& verdict) {
  std::vector<PlacedGate> gates;
  for (const vv::RunVerdict& run : verdict.runs)
    for (const vv::GateResult& gate : run.gates) gates.push_back({&gate, name_of_run(run.parameters)});
  for (const vv::SeriesVerdict& series : verdict.series)
    for (const vv::GateResult& gate : series.gates) gates.push_back({&gate, scope_of_series(series, gate)});
  for (const vv::GateResult& gate : verdict.gates) gates.push_back({&gate, escaped(gate.scope)});
  return gates;
}

std::string threshold_of(const vv::GateResult& gate) {
  if (gate.op == "is") return "expected " + escaped(gate.expected);
  return (gate.op == "<="   ? "≤ "
          : gate.op == ">=" ? "≥ "
                            : escaped(gate.op) + " ") +
         number_markup(gate.threshold, 0);
}

std::string margin_of(const vv::GateResult& gate) {
  const double margin = vv::margin(gate);
  if (!std::isfinite(margin)) return "–";
  const double percent = 100.0 * margin;
  return (percent > 0.0 ? "+" : "") + number_markup(percent, 2) + " %";
}

std::string statistic_of(const vv::GateResult& gate) {
  if (gate.statistic.empty() || gate.statistic == "value") return "";
  std::string words = gate.statistic;
  std::replace(words.begin(), words.end(), '_', ' ');
  return ", " + escaped(words);
}

data row_of(const PlacedGate& gate) {
  return object({{"id", gate.result->id},
                 {"scope", gate.scope},
                 {"metric", gate.result->metric},
                 {"statistic", statistic_of(*gate.result)},
                 {"value", gate.result->op == "is" ? escaped(gate.result->found) : number_markup(gate.result->value)},
                 {"threshold", threshold_of(*gate.result)},
                 {"margin", margin_of(*gate.result)},
                 {"chip", chip_of(gate.result->status)},
                 {"detail", gate.result->detail}});
}

// Longer lists are folded away: they are looked up, not read.
constexpr std::size_t longest_open_table = 12;  // runs
constexpr std::size_t longest_open_gate = 5;    // results of a gate, or runs that share one

/// Results of one gate. Runs that gave the same value with the same result share one, all of them named.
std::vector<PlacedGate> merged_results(const std::vector<PlacedGate>& gates) {
  std::vector<PlacedGate> merged;
  std::vector<std::size_t> counts;
  for (const PlacedGate& gate : gates) {
    const auto same = std::find_if(merged.begin(), merged.end(), [&gate](const PlacedGate& other) {
      return std::isfinite(gate.result->value) && other.result->value == gate.result->value &&
             other.result->threshold == gate.result->threshold &&
             other.result->status == gate.result->status && other.result->detail == gate.result->detail;
    });
    if (same == merged.end()) {
      merged.push_back(gate);
      merged.back().scope = "<span class=\"run\">" + gate.scope + "</span>";
      counts.push_back(1);
    } else {
      same->scope += "; <span class=\"run\">" + gate.scope + "</span>";
      ++counts[static_cast<std::size_t>(same - merged.begin())];
    }
  }
  for (std::size_t i = 0; i < merged.size(); ++i) {
    const char* form =
        counts[i] > longest_open_gate
            ? "<details class=\"norms\"><summary>{} runs alike</summary><small>{}</small></details>"
            : "{} runs alike<br><small>{}</small>";
    if (counts[i] > 1) merged[i].scope = fmt::format(fmt::runtime(form), counts[i], merged[i].scope);
  }
  return merged;
}

/// The result with the least to spare: of a gate the least margin, of a control, which must violate, the
/// most.
const PlacedGate& closest(const std::vector<PlacedGate>& results) {
  return *std::min_element(results.begin(), results.end(), [](const PlacedGate& a, const PlacedGate& b) {
    const double sign = a.result->must_fail ? -1.0 : 1.0;
    return sign * vv::margin(*a.result) < sign * vv::margin(*b.result);
  });
}

/// Sets the rows of a gate: all of a few results; of many the closest and every bad one, the rest folded
/// away.
void set_rows(data& group, const std::vector<PlacedGate>& gates) {
  const std::vector<PlacedGate> results = merged_results(gates);
  const bool folds = results.size() > longest_open_gate;
  data shown = list(), folded = list();
  if (folds) {
    PlacedGate nearest = closest(results);
    nearest.scope = fmt::format("closest of {}: {}", results.size(), nearest.scope);
    shown << row_of(nearest);
  }
  for (const PlacedGate& result : results) {
    if (!folds || !result.result->good()) shown << row_of(result);
    if (folds) folded << row_of(result);
  }
  group.set("rows", shown);
  group.set("folds", flag(folds));
  group.set("folded_rows", folded);
  group.set("result_count", std::to_string(results.size()));
}

/// Results under their gate, controls apart from gates.
data gate_groups(const std::vector<PlacedGate>& gates, bool controls) {
  std::vector<std::string> ids;
  std::map<std::string, std::vector<PlacedGate>> by_id;
  for (const PlacedGate& gate : gates) {
    if (gate.result->must_fail != controls) continue;
    if (by_id[gate.result->id].empty()) ids.push_back(gate.result->id);
    by_id[gate.result->id].push_back(gate);
  }
  data groups = list();
  for (const std::string& id : ids) {
    const vv::GateResult& first = *by_id[id].front().result;
    data group = object({{"id", id},
                         {"metric", first.metric},
                         {"statistic", statistic_of(first)},
                         {"basis", first.basis},
                         {"reason", first.reason}});
    set_rows(group, by_id[id]);
    groups << group;
  }
  return groups;
}

/// "at most 0.5", or what a control has to violate: "not at most 0.5".
std::string bound_of(const vv::GateResult& gate) {
  if (gate.op == "is") return "expected " + escaped(gate.expected);
  const std::string comparison = gate.op == "<=" ? "at most " : gate.op == ">=" ? "at least " : gate.op + " ";
  return (gate.must_fail ? "not " : "") + escaped(comparison) + number_markup(gate.threshold, 0);
}

/// "0.31 … 0.44", or the one value there is; "–" without any.
std::string range_of(const std::vector<const vv::GateResult*>& results) {
  if (results.front()->op == "is") {
    std::set<std::string> classes;
    for (const vv::GateResult* result : results) classes.insert(escaped(result->found));
    return fmt::format("{}", fmt::join(classes, ", "));
  }
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const vv::GateResult* result : results) {
    if (!std::isfinite(result->value)) continue;
    least = std::min(least, result->value);
    most = std::max(most, result->value);
  }
  if (least > most) return "–";
  const std::string lower = number_markup(least), upper = number_markup(most);
  return lower == upper ? lower : lower + " … " + upper;
}

/// One entry a gate: "smooth 7/7", what was measured, and what was asked for.
data gate_tallies(const std::vector<PlacedGate>& gates, const vv::Case& definition) {
  std::vector<std::string> ids;
  std::map<std::string, std::vector<const vv::GateResult*>> by_id;
  for (const PlacedGate& gate : gates) {
    std::vector<const vv::GateResult*>& results = by_id[gate.result->id];
    if (results.empty()) ids.push_back(gate.result->id);
    results.push_back(gate.result);
  }
  data tallies = list();
  for (const std::string& id : ids) {
    const std::vector<const vv::GateResult*>& results = by_id[id];
    const auto good = std::count_if(results.begin(), results.end(),
                                    [](const auto* r) { return r->good() && !r->waits(); });
    const auto unmeasured =
        std::count_if(results.begin(), results.end(), [](const auto* r) { return !std::isfinite(r->value); });
    tallies << object(
        {{"id", id},
         {"tally", fmt::format("{}/{}", good, results.size())},
         {"metric", name_of_metric(results.front()->metric, definition) + statistic_of(*results.front())},
         {"range", range_of(results)},
         {"bound", bound_of(*results.front())},
         {"unmeasured", unmeasured > 0 ? std::to_string(unmeasured) : ""}});
  }
  return tallies;
}

// ---- tables of numbers
// ------------------------------------------------------------------------------------------

std::string metric_cell(const vv::RunVerdict& run, const std::string& metric) {
  const auto found = run.metrics.find(metric);
  return found == run.metrics.end() ? "–" : number_markup(found->second);
}

/// Metrics the runs have, as the catalogue orders them, then any it does not know.
std::vector<std::string> metrics_in_order(const vv::CaseVerdict& verdict) {
  std::set<std::string> present;
  for (const vv::RunVerdict& run : verdict.runs)
    for (const auto& [name, value] : run.metrics) present.insert(name);
  std::vector<std::string> ordered;
  for (const vv::Metric& metric : vv::metric_catalogue())
    if (present.erase(metric.name) > 0) ordered.push_back(metric.name);
  ordered.insert(ordered.end(), present.begin(), present.end());
  return ordered;
}

/// The table a metric stands in: that of its reference, or of the word before its first dot.
std::string table_of(const std::string& metric) {
  const std::size_t dot = metric.find('.');
  return dot == std::string::npos ? "" : metric.substr(0, dot);
}

std::string table_title(const std::string& table) {
  if (table.empty()) return "Other measures";
  const bool is_reference = name_of_reference(table) != escaped(table);
  if (is_reference) return "Against " + name_of_reference(table);
  if (table + "." == vv::reading_prefix) return "Readings";
  if (table == "floor") return "Model-form floor, Zhang − Hencky";
  std::string title = table;
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  return escaped(title);
}

/// The column's head inside its table: the metric without the table's name.
std::string column_title(const std::string& metric, const vv::Case& definition) {
  for (const vv::Reading& reading : definition.readings)
    if (metric == vv::reading_prefix + reading.id) {
      const std::string own_unit = vv::metric_of(reading).unit;
      return escaped(reading.title) + (own_unit == "-" ? "" : " [" + escaped(own_unit) + "]");
    }
  const std::size_t dot = metric.find('.');
  std::string rest = dot == std::string::npos ? metric : metric.substr(dot + 1);
  std::string unit;
  for (const vv::Metric& known : vv::metric_catalogue())
    if (known.name == metric && known.unit != "-" && !known.unit.empty())
      unit = " [" + escaped(known.unit) + "]";
  if (metric == "oscillation.hp") return "HP";
  if (metric == "oscillation.ns") return "NS";
  std::string suffix;
  for (const auto& [ending, symbol] : {std::pair{".l1", " <i>L</i><sub>1</sub>"},
                                       {".l2", " <i>L</i><sub>2</sub>"},
                                       {".linf", " <i>L</i><sub>∞</sub>"}})
    if (rest.ends_with(ending)) {
      suffix = symbol;
      rest.resize(rest.size() - std::string_view(ending).size());
      break;
    }
  std::replace_if(
      rest.begin(), rest.end(), [](char c) { return c == '_' || c == '.'; }, ' ');
  return escaped(rest) + suffix + unit;
}

data metric_tables(const vv::CaseVerdict& verdict) {
  std::vector<std::string> names;
  std::map<std::string, std::vector<std::string>> tables;
  // These stand in the table of runs already.
  const std::set<std::string> shown{"cell_crossings", "steps", "particle_steps", "completed", "wall_seconds"};
  for (const std::string& metric : metrics_in_order(verdict)) {
    if (shown.count(metric) > 0) continue;
    if (tables[table_of(metric)].empty()) names.push_back(table_of(metric));
    tables[table_of(metric)].push_back(metric);
  }
  data result = list();
  for (const std::string& name : names) {
    data table = object({{"title", table_title(name)}});
    std::vector<std::string> heads;
    for (const std::string& metric : tables[name]) heads.push_back(column_title(metric, verdict.definition));
    table.set("columns", text_cells(heads));
    data rows = list();
    for (const vv::RunVerdict& run : verdict.runs) {
      std::vector<std::string> cells;
      for (const std::string& metric : tables[name]) cells.push_back(metric_cell(run, metric));
      data row = object({{"name", name_of_run(run.parameters)}});
      row.set("values", text_cells(cells));
      rows << row;
    }
    table.set("rows", rows);
    table.set("folded", flag(verdict.runs.size() > longest_open_table));
    table.set("row_count", std::to_string(verdict.runs.size()));
    result << table;
  }
  return result;
}

/// In megabytes; a dash for what was not recorded.
std::string memory_markup(std::int64_t bytes) {
  return bytes > 0 ? number_markup(static_cast<double>(bytes) / 1e6) : "–";
}

data run_rows(const vv::CaseVerdict& verdict) {
  data rows = list();
  for (const vv::RunVerdict& run : verdict.runs) {
    const vv::Record& record = run.record;
    data row = object({{"name", name_of_run(run.parameters)},
                       {"ending", name_of_ending(record)},
                       {"crossings", count_markup(record.cell_crossings)},
                       {"steps", count_markup(record.cost.steps)},
                       {"particle_steps", count_markup(record.cost.particle_steps)},
                       {"time_step", number_markup(record.time_step)},
                       {"end_time", number_markup(record.end_time)},
                       {"wall", number_markup(record.cost.wall_seconds)},
                       {"memory", memory_markup(record.cost.memory_bytes)}});
    row.set("bad", flag(!record.completed()));
    rows << row;
  }
  return rows;
}

bool is_reading(const std::string& metric) { return metric.starts_with(vv::reading_prefix); }

/// The value for cells without size and how far off the finest may be: "12.3; ±4.2 %"; "–" for an error,
/// which goes to zero.
std::string limit_of(const vv::SeriesVerdict& series, const std::string& metric) {
  const auto found = series.convergence.find(metric);
  if (found == series.convergence.end()) return "–";
  const vv::GridConvergence& convergence = found->second;
  const std::string extrapolated =
      std::isfinite(convergence.extrapolated) ? number_markup(convergence.extrapolated) : "none";
  return extrapolated + "; ±" + number_markup(100.0 * convergence.uncertainty, 2) + " %";
}

/// The cell sizes of a series, or what else its levels differ by.
std::vector<std::string> names_of_levels(const vv::SeriesVerdict& series) {
  const std::vector<double>& sizes = series.cell_size;
  const bool refines = std::adjacent_find(sizes.begin(), sizes.end(), std::not_equal_to<>()) != sizes.end();
  std::vector<std::string> names;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    names.push_back(refines || k >= series.values.size()
                        ? fmt::format("<i>h</i> = {:.4g} mm", sizes[k] * 1e3)
                        : name_of_parameter(series.across, series.values[k]));
  }
  return names;
}

/// Metrics of a refinement: errors and readings, not counts.
data series_tables(const vv::CaseVerdict& verdict) {
  data tables = list();
  for (const vv::SeriesVerdict& series : verdict.series) {
    data table = object({{"name", series.fixed.empty() ? "All runs" : name_of_run(series.fixed)}});
    table.set("sizes", text_cells(names_of_levels(series)));
    data rows = list();
    for (const std::string& metric : metrics_in_order(verdict)) {
      const auto found = series.metrics.find(metric);
      if (found == series.metrics.end() || table_of(metric).empty()) continue;
      std::vector<std::string> values;
      for (const double value : found->second) values.push_back(number_markup(value));
      // The order of an error is that of its own fall; a reading's is that of its differences.
      const auto orders = series.orders.find(metric);
      const auto convergence = series.convergence.find(metric);
      const std::string shown_orders = convergence != series.convergence.end()
                                           ? orders_markup({convergence->second.order})
                                       : orders == series.orders.end() ? "–"
                                                                       : orders_markup(orders->second);
      data row = object(
          {{"metric", metric},
           {"title", is_reading(metric) ? name_of_metric(metric, verdict.definition) : ""},
           {"orders", is_reading(metric) && convergence == series.convergence.end() ? "–" : shown_orders},
           {"limit", limit_of(series, metric)}});
      row.set("values", text_cells(values));
      rows << row;
    }
    table.set("rows", rows);
    table.set("has_limits", flag(!series.convergence.empty()));
    tables << table;
  }
  return tables;
}

// ---- a case
// -----------------------------------------------------------------------------------------------------

std::string sweep_sentence(const vv::CaseVerdict& verdict) {
  std::string text;
  for (const vv::SweepAxis& axis : verdict.definition.sweep) {
    std::string values;
    for (const vv::Json& value : axis.values)
      values += (values.empty() ? "" : ", ") + name_of_parameter(axis.parameter, value);
    text += (text.empty() ? "" : " × ") + values;
  }
  if (verdict.runs.empty()) return text;
  return fmt::format("{}{}{} run{}", text, text.empty() ? "" : ": ", verdict.runs.size(),
                     verdict.runs.size() == 1 ? "" : "s");
}

/// What a reference solution of a footing says, in markup; empty for any other. Symbols are those of
/// reference/bearing_capacity.hpp, s is the settlement.
std::string formula_of(const std::string& reference) {
  const std::string factors =
      "<i>c</i> <i>N</i><sub>c</sub> + {} <i>N</i><sub>q</sub> + ½ <i>γ</i> <i>B</i> <i>N</i><sub>γ</sub>";
  if (reference == "terzaghi")
    return fmt::format(fmt::runtime(factors), "<i>q</i>") +
           ", Terzaghi’s formulas and chart, a footing on the surface";
  if (reference == "embedded_limit")
    return fmt::format(fmt::runtime(factors), "(<i>q</i> + <i>γ</i> <i>s</i>)") +
           ", exact factors, a footing that has gone down by <i>s</i>; the sum is conservative";
  if (reference == "elastic_layer") return "the exact stiffness of the ground before anything yields";
  return "";
}

void set_exact_solutions(data& section, const vv::Case& definition) {
  data others = list();
  bool known = false;
  for (const std::string& reference : definition.references) {
    if (reference == "equilibrium" || reference == "hencky" || reference == "zhang") {
      section.set("exact_" + reference, flag(true));
      known = true;
    } else {
      data other = object({{"name", name_of_reference(reference)}});
      if (const std::string formula = formula_of(reference); !formula.empty()) other.set("formula", formula);
      others << other;
    }
  }
  section.set("has_exact", flag(known || !others.is_empty_list()));
  section.set("has_column_solution", flag(known));
  section.set("exact_other", others);
}

data figure_entries(const vv::CaseVerdict& verdict, const std::vector<DrawnFigure>& figures, int& number) {
  data entries = list();
  for (const vv::FigureRequest& request : verdict.definition.figures) {
    const auto drawn = std::find_if(figures.begin(), figures.end(), [&](const DrawnFigure& figure) {
      return figure.case_id == verdict.definition.id && figure.figure_id == request.id;
    });
    if (drawn == figures.end()) continue;
    const std::string on_screen = request.kind == "trade" ? trade_html(verdict, request) : "";
    entries << object(
        {{"anchor", verdict.definition.id + "-" + request.id},
         {"png", base64(drawn->png)},
         {"width", std::to_string(drawn->pixel_width / 2)},
         {"alt", fmt::format("{} of {}: {}", request.kind, verdict.definition.title, request.caption)},
         {"failure", drawn->failure},
         {"on_screen", on_screen},
         {"number", std::to_string(number++)},
         {"caption", request.caption}});
  }
  return entries;
}

data case_section(const vv::CaseVerdict& verdict, const std::vector<DrawnFigure>& figures,
                  int& figure_number) {
  const vv::Case& definition = verdict.definition;
  data section =
      object({{"id", definition.id},
              {"title", definition.title},
              {"chip", chip_of(verdict.status)},
              {"paper", definition.figure_of_paper},
              {"sweep", sweep_sentence(verdict)},
              {"description", definition.description},
              {"not_run_reason", verdict.status == vv::CaseStatus::not_run ? verdict.not_run_reason : ""}});
  set_exact_solutions(section, definition);
  section.set("figures", figure_entries(verdict, figures, figure_number));
  set_model_choices(section, verdict);
  set_validation(section, verdict);
  set_trades(section, verdict);
  set_advice(section, verdict);
  const std::vector<PlacedGate> gates = gates_of(verdict);
  set_list(section, "gates", gate_groups(gates, false));
  set_list(section, "controls", gate_groups(gates, true));
  set_list(section, "series", series_tables(verdict));
  set_list(section, "runs", run_rows(verdict));
  section.set("runs_folded", flag(verdict.runs.size() > longest_open_table));
  section.set("run_count", std::to_string(verdict.runs.size()));
  section.set("metric_tables", metric_tables(verdict));
  data notes = list();
  for (const std::string& note : definition.notes) notes << object({{"text", note}});
  set_list(section, "notes", notes);
  return section;
}

/// What became of a claim: its finding, if every gate it rests on was applied and is good.
std::string chip_of(const vv::Claim& claim, const std::vector<PlacedGate>& evidence) {
  const auto is_good = [](const PlacedGate& gate) { return gate.result->good(); };
  const bool complete = std::all_of(claim.gates.begin(), claim.gates.end(), [&](const std::string& id) {
    return std::any_of(evidence.begin(), evidence.end(),
                       [&](const PlacedGate& gate) { return gate.result->id == id; });
  });
  if (claim.finding == vv::Finding::untested) return chip("open", "not tested");
  if (evidence.empty() || !complete) return chip("open", "NOT MEASURED");
  if (!std::all_of(evidence.begin(), evidence.end(), is_good)) return chip("fail", "IN DOUBT");
  if (std::any_of(evidence.begin(), evidence.end(), [](const PlacedGate& gate) { return gate.result->waits(); }))
    return chip("open", "not tested: no measurement");
  switch (claim.finding) {
    case vv::Finding::seen:
      return chip("pass", "holds");
    case vv::Finding::not_seen:
      return chip("contrary", "not seen");
    case vv::Finding::untested:
      break;
    case vv::Finding::depends:
      return chip("contrary", "holds in part");
  }
  return chip("fail", "UNKNOWN");
}

data claim_row(const vv::Claim& claim, const vv::CaseVerdict& verdict) {
  std::vector<PlacedGate> evidence;
  for (const PlacedGate& gate : gates_of(verdict)) {
    if (std::find(claim.gates.begin(), claim.gates.end(), gate.result->id) != claim.gates.end()) {
      evidence.push_back(gate);
    }
  }
  data row = object({{"id", verdict.definition.id},
                     {"paper", verdict.definition.figure_of_paper},
                     {"text", claim.text},
                     {"remark", claim.remark},
                     {"chip", chip_of(claim, evidence)}});
  row.set("gates", gate_tallies(evidence, verdict.definition));
  return row;
}

/// Whether a control of the case turned red on this run or on a series that contains it.
bool covered_by_control(const vv::CaseVerdict& verdict, const vv::RunVerdict& run) {
  const auto red = [](const vv::GateResult& gate) { return gate.status == vv::GateStatus::red_as_expected; };
  if (std::any_of(run.gates.begin(), run.gates.end(), red)) return true;
  return std::any_of(verdict.series.begin(), verdict.series.end(), [&](const vv::SeriesVerdict& series) {
    const bool contains = std::all_of(series.fixed.begin(), series.fixed.end(), [&run](const auto& entry) {
      return std::find(run.parameters.begin(), run.parameters.end(), entry) != run.parameters.end();
    });
    return contains && std::any_of(series.gates.begin(), series.gates.end(), red);
  });
}

/// Why it is no failure of the case that a run ended early, for a person; empty if it is one.
std::string excuse_of(const vv::CaseVerdict& verdict, const vv::RunVerdict& run) {
  if (covered_by_control(verdict, run)) return "by a control";
  const bool is_open_question = !verdict.definition.trades.empty() && run.record.failure.empty() &&
                                std::all_of(run.gates.begin(), run.gates.end(), [](const auto& gate) { return gate.good(); });
  return is_open_question ? "a configuration that fails" : "";
}

// ---- across cases
// -----------------------------------------------------------------------------------------------

void set_verdict(data& page, const vv::CampaignVerdict& verdict) {
  const vv::Counts counts = verdict.counts();
  const bool failed = verdict.failed(), passed = verdict.passed();
  page.set("verdict_word", failed ? "FAIL" : passed ? "PASS" : "INCOMPLETE");
  page.set("verdict_class", failed ? "fail" : passed ? "pass" : "open");
  std::string sentence =
      fmt::format("{} of {} cases passed; {} of {} gates hold; {} of {} controls are red as expected.",
                  counts.cases_passed, counts.cases, counts.gates_passed, counts.gates, counts.controls_red,
                  counts.controls);
  if (counts.cases_not_run > 0)
    sentence += fmt::format(" {} case{} not run.", counts.cases_not_run,
                            counts.cases_not_run == 1 ? " was" : "s were");
  if (counts.gates_waiting > 0)
    sentence += fmt::format(" {} gate{} for a measurement that is missing.", counts.gates_waiting,
                            counts.gates_waiting == 1 ? " waits" : "s wait");
  page.set("verdict_sentence", sentence);
  int completed = 0, expected = 0;
  for (const vv::CaseVerdict& c : verdict.cases)
    for (const vv::RunVerdict& run : c.runs) {
      completed += run.record.completed();
      expected += !run.record.completed() && !excuse_of(c, run).empty();
    }
  for (const auto& [name, value] : std::map<std::string, int>{{"cases", counts.cases},
                                                              {"cases_passed", counts.cases_passed},
                                                              {"cases_failed", counts.cases_failed},
                                                              {"cases_not_run", counts.cases_not_run},
                                                              {"runs", counts.runs},
                                                              {"runs_completed", completed},
                                                              {"runs_ended_early", counts.runs - completed},
                                                              {"runs_expected", expected},
                                                              {"gates", counts.gates},
                                                              {"gates_passed", counts.gates_passed},
                                                              {"gates_failed", counts.gates_failed},
                                                              {"controls", counts.controls},
                                                              {"controls_red", counts.controls_red},
                                                              {"controls_green", counts.controls_green}})
    page.set(name, std::to_string(value));
  page.set("any_case_failed", flag(counts.cases_failed > 0));
  page.set("any_case_not_run", flag(counts.cases_not_run > 0));
  page.set("any_gate_failed", flag(counts.gates_failed > 0));
  page.set("gates_waiting", std::to_string(counts.gates_waiting));
  page.set("any_gate_waiting", flag(counts.gates_waiting > 0));
  page.set("any_control_green", flag(counts.controls_green > 0));
}

void set_facts(data& page, const vv::CampaignVerdict& verdict) {
  const auto stated = [](const std::string& text) { return text.empty() ? std::string("not stated") : text; };
  page.set("revision", stated(verdict.revision));
  page.set("date", stated(verdict.date));
  page.set("host", stated(verdict.host));
  page.set("processor", stated(verdict.processor));
  page.set("compiler", stated(verdict.compiler));
  page.set("build", stated(verdict.build));
  page.set("threads", std::to_string(verdict.threads));
  page.set("wall_seconds", number_markup(verdict.wall_seconds));
  page.set("quick", flag(verdict.quick));
  page.set("extent", verdict.quick ? "quick: only the cases marked as quick" : "all cases");
  if (verdict.reused > 0)
    page.set("reused", std::to_string(verdict.reused));
  else
    page.set("reused", flag(false));
  std::set<std::string> others;
  int stale = 0, total = 0;
  for (const vv::CaseVerdict& c : verdict.cases)
    for (const vv::RunVerdict& run : c.runs) {
      ++total;
      if (run.record.revision == verdict.revision) continue;
      ++stale;
      others.insert(stated(run.record.revision));
    }
  std::string names;
  for (const std::string& name : others) names += (names.empty() ? "" : ", ") + name;
  data entries = list();
  if (stale > 0)
    entries << object({{"count", std::to_string(stale)}, {"total", std::to_string(total)}, {"names", names}});
  page.set("other_revisions", entries);
}

void set_failed_gates(data& page, const vv::CampaignVerdict& verdict) {
  data failed = list(), not_measured = list(), not_run = list();
  for (const vv::CaseVerdict& c : verdict.cases) {
    if (c.status == vv::CaseStatus::not_run)
      not_run << object({{"id", c.definition.id},
                         {"reason", c.not_run_reason.empty() ? "no reason was given" : c.not_run_reason}});
    for (const PlacedGate& gate : gates_of(c)) {
      if (!gate.result->good()) {
        data row = row_of(gate);
        row.set("case_id", c.definition.id);
        failed << row;
      }
      if (!std::isfinite(gate.result->value) && !gate.result->waits())
        not_measured << object(
            {{"text",
              fmt::format(
                  "{}, gate {} ({}): {}", escaped(c.definition.id), escaped(gate.result->id), gate.scope,
                  gate.result->detail.empty() ? "no reason was given" : escaped(gate.result->detail))}});
    }
  }
  set_list(page, "failed_gates", failed);
  set_list(page, "not_measured", not_measured);
  set_list(page, "not_run", not_run);
}

void set_runs_across_cases(data& page, const vv::CampaignVerdict& verdict) {
  data oscillation = list(), failures = list(), hashes = list();
  for (const vv::CaseVerdict& c : verdict.cases)
    for (const vv::RunVerdict& run : c.runs) {
      const vv::Record& record = run.record;
      const std::string name = name_of_run(run.parameters), id = c.definition.id;
      if (run.metrics.count("oscillation.hp") + run.metrics.count("oscillation.ns") > 0)
        oscillation << object({{"case_id", id},
                               {"name", name},
                               {"hp", metric_cell(run, "oscillation.hp")},
                               {"ns", metric_cell(run, "oscillation.ns")},
                               {"crossings", count_markup(record.cell_crossings)}});
      if (!record.completed()) {
        const bool solver_said = record.failure.empty();
        const std::string excuse = excuse_of(c, run);
        failures << object(
            {{"case_id", id},
             {"name", name},
             {"ending", solver_said ? std::string(name_of(record.outcome.ending)) : record.failure},
             {"step", solver_said ? count_markup(record.outcome.step) : "–"},
             {"time", solver_said ? number_markup(record.outcome.time) : "–"},
             {"particle",
              solver_said && record.outcome.particle >= 0 ? count_markup(record.outcome.particle) : "–"},
             {"value",
              solver_said && record.outcome.particle >= 0 ? number_markup(record.outcome.value) : "–"},
             {"expected", excuse.empty() ? "no" : chip("expected", excuse.c_str())}});
      }
      hashes << object({{"case_id", id},
                        {"name", name},
                        {"revision", record.revision},
                        {"input", record.input_hash},
                        {"program", record.program_hash},
                        {"digest", record.digest},
                        {"repeat", record.repeat_digest}});
    }
  set_list(page, "oscillation", oscillation);
  set_list(page, "failures", failures);
  page.set("hashes", hashes);
}

/// How the failure of one run began, as an example.
void set_last_good(data& page, const vv::CampaignVerdict& verdict, const std::vector<DrawnFigure>& figures,
                   int& number) {
  const FailedRun failed = failed_run_to_draw(verdict);
  data entries = list();
  for (const DrawnFigure& figure : figures) {
    if (!failed.run || figure.case_id != failed.verdict->definition.id || figure.figure_id != last_good_figure) continue;
    entries << object({{"png", base64(figure.png)},
                       {"width", std::to_string(figure.pixel_width / 2)},
                       {"failure", figure.failure},
                       {"number", std::to_string(number++)},
                       {"caption", last_good_caption(failed)}});
  }
  page.set("last_good", entries);
}

/// Draws a figure, or says why it could not be.
DrawnFigure drawn_figure(const std::string& case_id, const std::string& id, const std::function<Picture()>& picture_of) {
  DrawnFigure figure{case_id, id, "", 0, ""};
  try {
    const Picture picture = picture_of();
    const std::vector<unsigned char> png = picture.canvas.png();
    figure.png.assign(png.begin(), png.end());
    figure.pixel_width = picture.canvas.pixel_width();
  } catch (const std::exception& error) {
    figure.failure = error.what();
  }
  return figure;
}

data glossary() {
  data entries = list();
  for (const vv::Metric& metric : vv::metric_catalogue())
    entries << object({{"name", metric.name},
                       {"unit", metric.unit == "-" ? "–" : metric.unit},
                       {"reference", metric.reference.empty() ? "–" : metric.reference},
                       {"meaning", metric.meaning}});
  return entries;
}

}  // namespace

std::vector<DrawnFigure> draw_figures(const vv::CampaignVerdict& verdict) {
  std::vector<DrawnFigure> figures;
  for (const vv::CaseVerdict& c : verdict.cases) {
    if (c.status == vv::CaseStatus::not_run) continue;
    for (const vv::FigureRequest& request : c.definition.figures) {
      figures.push_back(drawn_figure(c.definition.id, request.id, [&] { return picture_of(c, request); }));
    }
  }
  const FailedRun failed = failed_run_to_draw(verdict);
  if (failed.run)
    figures.push_back(drawn_figure(failed.verdict->definition.id, last_good_figure, [&] { return last_good_picture(failed); }));
  return figures;
}

std::string report_html(const vv::CampaignVerdict& verdict, const std::vector<DrawnFigure>& figures,
                        const PerformanceEvidence& performance,
                        const std::vector<DrawnPerformanceFigure>& performance_figures) {
  data page(data::type::object);
  page.set("style", std::string(document_style()));
  set_verdict(page, verdict);
  set_facts(page, verdict);
  set_failed_gates(page, verdict);
  data case_list = list(), claims = list(), sections = list(), commands = list();
  int figure_number = 1;
  for (const vv::CaseVerdict& c : verdict.cases) {
    case_list << object(
        {{"id", c.definition.id}, {"title", c.definition.title}, {"chip", chip_of(c.status)}});
    for (const vv::Claim& claim : c.definition.claims) claims << claim_row(claim, c);
    sections << case_section(c, figures, figure_number);
    const std::string file = c.definition.file.filename().string();
    commands << object({{"file", file.empty() ? c.definition.id + ".json" : file}});
  }
  page.set("case_list", case_list);
  page.set("claims", claims);
  page.set("case_sections", sections);
  page.set("commands", commands);
  set_runs_across_cases(page, verdict);
  set_validation_overview(page, verdict);
  set_trade_overview(page, verdict);
  set_stability_overview(page, verdict);
  set_last_good(page, verdict, figures, figure_number);
  page.set("trade_script", std::string(trade_script()));
  page.set("performance", performance_section(performance, verdict, performance_figures, figure_number));
  page.set("glossary", glossary());
  return rendered(document_template(), page);
}

void write_report(const vv::CampaignVerdict& verdict, const std::filesystem::path& directory,
                  const PerformanceEvidence& performance) {
  const std::vector<DrawnFigure> figures = draw_figures(verdict);
  const std::vector<DrawnPerformanceFigure> performance_figures = draw_performance_figures(performance);
  std::filesystem::create_directories(directory / "figures");
  std::string failures;
  const auto write = [&](const DrawnFigure& figure) {
    const std::string name = figure.case_id + "-" + figure.figure_id;
    if (figure.failure.empty())
      vv::write_atomically(directory / "figures" / (name + ".png"), figure.png);
    else
      failures += (failures.empty() ? "" : "; ") + name + ": " + figure.failure;
  };
  for (const DrawnFigure& figure : figures) write(figure);
  for (const DrawnPerformanceFigure& figure : performance_figures) write(figure.drawn);
  vv::write_atomically(directory / "report.html",
                       report_html(verdict, figures, performance, performance_figures));
  if (!failures.empty()) throw CanvasError("figures could not be drawn: " + failures);
}

}  // namespace mpm::reports
