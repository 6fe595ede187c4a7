#include "vv/case_file.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "vv/advice.hpp"
#include "vv/case_schema.hpp"
#include "vv/curves.hpp"
#include "vv/field_map.hpp"
#include "vv/gates.hpp"
#include "vv/json_reader.hpp"
#include "vv/measurement_reader.hpp"
#include "vv/metamorphic.hpp"
#include "vv/norms.hpp"
#include "vv/probe_reader.hpp"
#include "vv/rounding.hpp"
#include "vv/rounding_reader.hpp"
#include "vv/scene_reader.hpp"
#include "vv/sufficient_model.hpp"
#include "vv/survey_reader.hpp"
#include "vv/sweep.hpp"
#include "vv/classification.hpp"
#include "vv/trade_reader.hpp"

namespace mpm::vv {
namespace {

// ---- names of what the case already has
// -------------------------------------------------------------------------

bool is_element_case(const Case& read) { return read.text.contains("element"); }

/// Whether a metric tells of every run, whatever it puts to the test.
bool tells_of_any_run(const std::string& metric) {
  return contains({"completed", "steps", "non_finite_values", "bits_differ"}, metric);
}

/// Every metric that a gate of the case may name.
std::vector<std::string> metric_names(const Case& read) {
  std::vector<std::string> names = names_of(metric_catalogue());
  for (const Reading& reading : read.readings) names.push_back(metric_of(reading).name);
  for (const std::string& name : comparison_metric_names(read.measurements)) names.push_back(name);
  for (const std::string& name : trade_metric_names(read.trades)) names.push_back(name);
  for (const std::string& name : rounding_metric_names(read.rounding)) names.push_back(name);
  return names;
}

std::string read_metric(const JsonPlace& place, const Case& read) {
  const std::string name = place.one_of(metric_names(read));
  for (const char* prefix : {reading_prefix, measured_prefix, trade_prefix, rounding_prefix})
    if (name.starts_with(prefix)) return name;
  const Metric& metric = *std::find_if(metric_catalogue().begin(), metric_catalogue().end(),
                                       [&](const Metric& m) { return m.name == name; });
  if (!metric.reference.empty() && !contains(read.references, metric.reference)) {
    place.refuse("a metric whose reference solution is among the case's references (" +
                     (read.references.empty() ? "none" : listed(read.references)) + ")",
                 ", which needs " + metric.reference);
  }
  if (name.starts_with(metamorphic_prefix) &&
      !contains(read.metamorphoses, name.substr(metamorphic_prefix.size()))) {
    place.refuse("a metric that the case measures", ", which needs that name among metamorphoses");
  }
  if (!tells_of_any_run(name) && name.starts_with("element.") != is_element_case(read)) {
    place.refuse(is_element_case(read) ? "a metric of an element test" : "a metric of a scene",
                 ", which the case does not measure");
  }
  if (name.starts_with(class_metric) && !read.classification) {
    place.refuse("a metric that the case measures", ", which needs the key \"classification\"");
  }
  if (!tells_of_any_run(name) && name.starts_with("stability.") != read.survey.has_value()) {
    place.refuse(read.survey ? "a metric of a survey, stability.*" : "a metric that the case measures",
                 read.survey ? "" : ", which needs the key \"stability\"");
  }
  if (name == "bits_differ" && !read.repeat_on_other_threads && read.repeat_on_threads.empty()) {
    place.refuse("a metric that the case measures",
                 ", which needs repeat_on_other_threads to be true or repeat_on_threads");
  }
  return name;
}

std::vector<std::string> read_metrics(const JsonPlace& place, const Case& read) {
  std::vector<std::string> metrics;
  for (const JsonPlace& metric : place.some_elements()) metrics.push_back(read_metric(metric, read));
  return metrics;
}

/// Distinct names out of `allowed`; the array may be empty.
std::vector<std::string> read_names(const JsonPlace& place, const std::vector<std::string>& allowed) {
  std::vector<std::string> names;
  for (const JsonPlace& element : place.elements()) {
    const std::string name = element.one_of(allowed);
    if (contains(names, name)) element.refuse("each name once", " again");
    names.push_back(name);
  }
  return names;
}

std::string optional_text(const JsonPlace& place) { return place.present() ? place.text() : ""; }

// ---- readings
// ---------------------------------------------------------------------------------------------------

/// An abscissa of the case's curves: a settlement or, of an element test, a strain.
double read_abscissa(const JsonPlace& place, const Case& read) {
  return is_element_case(read) ? place.number() : place.quantity(QuantityKind::length);
}

/// The half-width of a mean over abscissae; 0 if absent, for none.
double read_within(const JsonPlace& place, const Case& read) {
  if (!place.present()) return 0.0;
  const double within = read_abscissa(place, read);
  if (!(within > 0.0)) place.refuse("a half-width above zero");
  return within;
}

std::string read_curve_name(const JsonPlace& place, const Case& read) {
  return place.one_of(names_of(curve_kinds(read)));
}

Reading read_reading(const JsonPlace& place, const Case& read) {
  place.allow_only({"id", "title", "curve", "at", "within", "over"});
  Reading reading;
  reading.id = place["id"].own_identifier(ids_of(read.readings));
  reading.title = place["title"].text();
  reading.curve = read_curve_name(place["curve"], read);
  reading.at = read_abscissa(place["at"], read);
  reading.within = read_within(place["within"], read);
  if (const JsonPlace over = place["over"]; over.present()) {
    if (read.references.empty()) over.refuse("a reference solution of the case, which has none");
    reading.over = over.one_of(read.references);
  }
  return reading;
}

// ---- gates
// ------------------------------------------------------------------------------------------------------

void read_threshold(const JsonPlace& place, Gate& gate) {
  const JsonPlace at_most = place["at_most"], at_least = place["at_least"];
  const std::string expected = "either at_most or at_least";
  if (at_most.present() && at_least.present()) throw Refusal(place.pointer(), expected, "both");
  if (!at_most.present() && !at_least.present()) throw Refusal(place.pointer(), expected, "neither");
  gate.comparison = at_most.present() ? Comparison::at_most : Comparison::at_least;
  gate.threshold = (at_most.present() ? at_most : at_least).number();
}

bool is_of_pairs(Statistic statistic) {
  return statistic == Statistic::bias || statistic == Statistic::scatter || statistic == Statistic::model_scatter;
}

bool is_power_law(Statistic statistic) {
  return statistic == Statistic::power_exponent || statistic == Statistic::power_coefficient;
}

void read_across(const JsonPlace& place, const Case& read, Gate& gate) {
  if (gate.statistic == Statistic::value || is_of_pairs(gate.statistic)) {
    if (place.present()) place.refuse("no key \"across\" with a statistic that is not of a series");
    return;
  }
  const SweepAxis& axis = read_axis(place, read.sweep);
  const std::vector<Json> values = selected_values(axis, gate.where);
  const bool in_cell_size =
      gate.statistic == Statistic::last_order || gate.statistic == Statistic::discretisation_uncertainty;
  // One pair gives an order, two points a power, but nothing to tell that it has settled.
  const std::size_t fewest = in_cell_size || is_power_law(gate.statistic) ? 3 : 2;
  if (values.size() < fewest) {
    place.refuse("a parameter with at least " + std::to_string(fewest) + " selected values",
                 ", which has " + std::to_string(values.size()));
  }
  if (in_cell_size) {
    if (is_element_case(read)) place.refuse("a parameter of a scene, which alone has cells to refine");
    // Observed orders are taken in the cell size, so it must fall from each level to the next.
    if (!refines(axis, values, read_subject(JsonPlace(&read.text, "")))) {
      place.refuse("a parameter that makes the cell size smaller from each value to the next");
    }
  }
  gate.across = axis.parameter;
}

Statistic read_statistic(const JsonPlace& place) {
  if (!place.present()) return Statistic::value;
  return place.choice<Statistic>({{"value", Statistic::value},
                                  {"reduction", Statistic::reduction},
                                  {"worst_ratio", Statistic::worst_ratio},
                                  {"last_order", Statistic::last_order},
                                  {"least_ratio", Statistic::least_ratio},
                                  {"spread", Statistic::spread},
                                  {"curve_spread", Statistic::curve_spread},
                                  {"power_exponent", Statistic::power_exponent},
                                  {"power_coefficient", Statistic::power_coefficient},
                                  {"bias", Statistic::bias},
                                  {"scatter", Statistic::scatter},
                                  {"model_scatter", Statistic::model_scatter},
                                  {"discretisation_uncertainty", Statistic::discretisation_uncertainty}});
}

/// A metric of the runs or, of a case that puts advice to the test, a number of the case as a whole.
std::string read_gate_metric(const JsonPlace& place, const Case& read, const Gate& gate) {
  if (!place.present() || !contains(names_of(advice_catalogue()), place.text())) return read_metric(place, read);
  if (!read.advice) place.refuse("a metric that the case measures", ", which needs the key \"advice\"");
  if (gate.statistic != Statistic::value) place.refuse("a metric of each run", ", which is one of the whole case");
  return place.text();
}

/// What a gate looks at: pairs, a metric or, to compare whole curves, a curve and a stretch of it.
void read_object(const JsonPlace& place, const Case& read, Gate& gate) {
  if (is_of_pairs(gate.statistic)) {
    if (read.pairs.empty()) place["pairs"].refuse("pairs of the case, which has none");
    gate.pairs = place["pairs"].one_of(ids_of(read.pairs));
    return;
  }
  if (is_power_law(gate.statistic)) gate.over = read_metric(place["over"], read);
  if (gate.statistic != Statistic::curve_spread) {
    gate.metric = read_gate_metric(place["metric"], read, gate);
    return;
  }
  gate.curve = read_curve_name(place["curve"], read);
  gate.within = read_within(place["within"], read);
  if (place["from"].present()) gate.from = read_abscissa(place["from"], read);
  if (place["up_to"].present()) gate.up_to = read_abscissa(place["up_to"], read);
  if (gate.from && gate.up_to && !(*gate.up_to > *gate.from))
    place["up_to"].refuse("an end beyond where the stretch begins");
}

/// The keys a gate on a metric or on a curve may have.
std::vector<std::string> gate_keys(Statistic statistic, bool is_of_class) {
  std::vector<std::string> keys = {"id", "statistic", "at_most", "at_least", "basis", "reason", "must_fail"};
  if (is_of_pairs(statistic)) {
    keys.insert(keys.begin() + 1, "pairs");
    return keys;
  }
  if (is_of_class) return {"id", "metric", "where", "is", "basis", "reason", "advice"};
  keys.insert(keys.begin() + 2, {"across", "where"});
  if (statistic == Statistic::curve_spread)
    keys.insert(keys.begin() + 1, {"curve", "from", "up_to", "within"});
  else
    keys.insert(keys.begin() + 1, "metric");
  if (is_power_law(statistic)) keys.insert(keys.begin() + 2, "over");
  return keys;
}

Gate read_gate(const JsonPlace& place, const Case& read) {
  Gate gate;
  gate.statistic = read_statistic(place["statistic"]);
  const bool is_of_class = place["is"].present();
  place.allow_only(gate_keys(gate.statistic, is_of_class));
  gate.id = place["id"].own_identifier(ids_of(read.gates));
  read_object(place, read, gate);
  gate.where = read_where(place["where"], read.sweep);
  if (is_of_advice(gate) && !gate.where.empty()) place["where"].refuse("no runs of a gate on the whole case");
  read_across(place["across"], read, gate);
  if (is_of_class != (gate.metric == class_metric))
    place["metric"].refuse(is_of_class ? "the metric \"class\" with the key \"is\""
                                       : "a metric with a threshold; \"class\" has the key \"is\"");
  if (is_of_class)
    gate.classes = read_classes(place["is"]);
  else
    read_threshold(place, gate);
  gate.advice = optional_text(place["advice"]);
  gate.basis = place["basis"].one_of({"theory", "requirement", "fit", "reference_uncertainty"});
  gate.reason = place["reason"].text();
  gate.must_fail = place["must_fail"].flag_or(false);
  return gate;
}

// ---- figures
// ----------------------------------------------------------------------------------------------------

/// The keys a figure of each kind may have beside those that every figure may have.
std::vector<std::string> figure_keys(const std::string& kind) {
  if (kind == "model") return {"id", "kind", "caption", "panels", "where"};
  if (kind == "decomposition")
    return {"id", "kind", "caption", "panels", "where", "over", "metrics", "references"};
  if (kind == "pairs") return {"id", "kind", "caption", "pairs"};
  if (kind == "trade") return {"id", "kind", "caption", "trade"};
  if (kind == "stability") return {"id", "kind", "caption", "panels", "series", "where", "map_axis"};
  std::vector<std::string> keys = {"id", "kind", "caption", "panels", "series", "where"};
  if (kind == "comparison") keys.push_back("measurements");
  if (kind == "trend") keys.insert(keys.end(), {"over", "abscissa", "metrics", "published"});
  if (kind == "profiles") keys.insert(keys.end(), {"quantity", "references"});
  if (kind == "convergence") keys.insert(keys.end(), {"over", "metrics"});
  if (kind == "bars") keys.push_back("metrics");
  if (kind == "curves") keys.insert(keys.end(), {"quantity", "references", "unavailable", "marks", "stages"});
  if (kind == "fields") keys.insert(keys.end(), {"quantity", "snapshots", "unavailable", "view", "measurements"});
  if (kind == "history") keys.push_back("quantity");
  return keys;
}

/// Every run must have what is drawn of it in the plane.
void require_two_dimensions(const JsonPlace& place, const Case& read) {
  for (const RunRequest& run : read.runs) {
    if (run.scene.dimension != 2)
      place.refuse("a figure of a scene with another dimension",
                   ", which needs two dimensions" + in_run(run));
  }
}

/// The name of a scalar to draw the snapshots by, which every run must have.
std::string read_field(const JsonPlace& place, const Case& read) {
  if (read.snapshots.empty()) place.refuse("a figure of the case's snapshots, of which it has none");
  const std::string name = place.one_of(names_of(field_catalogue()));
  require_two_dimensions(place, read);
  for (const RunRequest& run : read.runs) {
    if (name.find("strain") != std::string::npos && !run.scene.sums_strain) {
      place.refuse("a scalar that the scene keeps", ", which needs sums_strain to be true" + in_run(run));
    }
  }
  return name;
}

/// Which of the case's snapshots to draw, each once; none if `place` is absent.
std::vector<int> read_snapshot_choice(const JsonPlace& place, const Case& read) {
  std::vector<int> chosen;
  if (!place.present()) return chosen;
  for (const JsonPlace& element : place.some_elements()) {
    const int index = element.integer();
    if (index < 0 || index >= static_cast<int>(read.snapshots.size())) {
      element.refuse("a number from 0 to " + std::to_string(read.snapshots.size() - 1) +
                     ", counting the case's snapshots");
    }
    if (std::find(chosen.begin(), chosen.end(), index) != chosen.end())
      element.refuse("each snapshot once", " again");
    chosen.push_back(index);
  }
  return chosen;
}

std::optional<ViewRequest> read_view(const JsonPlace& place) {
  if (!place.present()) return std::nullopt;
  place.allow_only({"lower", "upper"});
  const ViewRequest view{read_per_axis(place["lower"], 2, QuantityKind::length),
                         read_per_axis(place["upper"], 2, QuantityKind::length)};
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (!(view.lower[axis] < view.upper[axis])) place["upper"].refuse("a corner above the lower one");
  return view;
}

/// Settlements from small to large; none if `place` is absent.
std::vector<double> read_stages(const JsonPlace& place, const std::string& quantity) {
  std::vector<double> stages;
  if (!place.present()) return stages;
  if (quantity != "pressure") place.refuse("no key \"stages\" with a curve that is not over a settlement");
  for (const JsonPlace& element : place.some_elements()) {
    const double stage = element.quantity(QuantityKind::length);
    if (!(stage > (stages.empty() ? 0.0 : stages.back())))
      element.refuse("a settlement above zero and above the one before");
    stages.push_back(stage);
  }
  return stages;
}

std::string read_probe_name(const JsonPlace& place, const std::vector<HistoryProbe>& probes) {
  const std::vector<std::string> ids = ids_of(probes);
  if (ids.empty()) place.refuse("the id of a probe, of which this case has none");
  return place.one_of(ids);
}

/// What a figure separates by: each parameter at most once.
void read_layout(const JsonPlace& place, const Case& read, FigureRequest& figure) {
  std::vector<std::string> used;
  const auto read_role = [&](const char* key) -> std::string {
    const JsonPlace role = place[key];
    const std::string parameter = read_axis(role, read.sweep).parameter;
    if (contains(used, parameter)) role.refuse("a parameter without another role in the figure");
    used.push_back(parameter);
    return parameter;
  };
  if (contains({"convergence", "decomposition", "trend"}, figure.kind)) figure.over = read_role("over");
  if (place["map_axis"].present()) figure.map_axis = read_role("map_axis");
  if (place["panels"].present()) figure.panels = read_role("panels");
  if (place["series"].present()) figure.series = read_role("series");
}

/// At least one of the names there are.
std::vector<std::string> read_some_names(const JsonPlace& place, const std::vector<std::string>& allowed,
                                         const char* expected) {
  if (allowed.empty()) place.refuse(expected);
  place.some_elements();
  return read_names(place, allowed);
}

/// The title of one of the case's trades; empty, which is all of them, if `place` is absent.
std::string read_trade_title(const JsonPlace& figure, const Case& read) {
  if (read.trades.empty()) figure["kind"].refuse("a figure of the case's trades, of which it has none");
  if (!figure["trade"].present()) return "";
  std::vector<std::string> titles;
  for (const TradeRequest& trade : read.trades) titles.push_back(trade.title);
  return figure["trade"].one_of(titles);
}

/// What the metrics are drawn over, and the published curves beside them.
void read_trend(const JsonPlace& place, const Case& read, FigureRequest& figure) {
  figure.abscissa = read_metric(place["abscissa"], read);
  const JsonPlace published = place["published"];
  if (!published.present()) return;
  for (const JsonPlace& file : published.some_elements()) {
    figure.published.push_back(read_curve_file_at(file, read));
    if (!figure.published.back()->abscissa) file.refuse("a curve, with an abscissa", ", a table of single measurements");
  }
}

FigureRequest read_figure(const JsonPlace& place, const Case& read) {
  FigureRequest figure;
  figure.kind = place["kind"].one_of(
      is_element_case(read) ? std::vector<std::string>{"bars", "curves", "decomposition", "comparison"}
                            : std::vector<std::string>{"profiles", "convergence", "bars", "history", "curves",
                                                       "fields", "model", "decomposition", "comparison",
                                                       "pairs", "trend", "trade", "stability"});
  place.allow_only(figure_keys(figure.kind));
  figure.id = place["id"].own_identifier(ids_of(read.figures));
  figure.caption = place["caption"].text();
  read_layout(place, read, figure);
  if (figure.kind == "profiles") {
    figure.quantity = place["quantity"].one_of({"stress", "displacement", "stress_error"});
  } else if (figure.kind == "curves") {
    figure.quantity = read_curve_name(place["quantity"], read);
    figure.marks = place["marks"].flag_or(false);
    figure.stages = read_stages(place["stages"], figure.quantity);
  } else if (figure.kind == "history") {
    figure.quantity = read_probe_name(place["quantity"], read.probes);
  } else if (figure.kind == "fields") {
    figure.quantity = read_field(place["quantity"], read);
    figure.snapshots = read_snapshot_choice(place["snapshots"], read);
    figure.view = read_view(place["view"]);
  } else if (figure.kind == "model") {
    require_two_dimensions(place["kind"], read);
  } else if (figure.kind == "trade") {
    figure.trade = read_trade_title(place, read);
  } else if (figure.kind == "stability") {
    if (!read.survey) place["kind"].refuse("a figure of the case's surveys of time steps, of which it has none");
  } else if (figure.kind == "pairs") {
    figure.pairs = read_some_names(place["pairs"], ids_of(read.pairs), "pairs of the case, which has none");
  } else if (figure.kind != "comparison") {
    figure.metrics = read_metrics(place["metrics"], read);
  }
  if (figure.kind == "comparison" || place["measurements"].present()) {
    figure.measurements = read_some_names(place["measurements"], ids_of(read.measurements),
                                          "measurements of the case, which has none");
  }
  if (figure.kind == "trend") read_trend(place, read, figure);
  if (place["references"].present()) figure.references = read_names(place["references"], read.references);
  figure.unavailable = optional_text(place["unavailable"]);
  figure.where = read_where(place["where"], read.sweep);
  return figure;
}

// ---- case
// -------------------------------------------------------------------------------------------------------

std::vector<std::string> read_texts(const JsonPlace& place) {
  std::vector<std::string> texts;
  if (!place.present()) return texts;
  for (const JsonPlace& element : place.elements()) texts.push_back(element.text());
  return texts;
}

Claim read_claim(const JsonPlace& place, const Case& read) {
  place.allow_only({"claim", "finding", "gates", "remark"});
  Claim claim;
  claim.text = place["claim"].text();
  claim.finding = place["finding"].choice<Finding>({{"seen", Finding::seen},
                                                    {"not_seen", Finding::not_seen},
                                                    {"depends", Finding::depends},
                                                    {"untested", Finding::untested}});
  if (claim.finding == Finding::untested) {
    if (place["gates"].present()) place["gates"].refuse("no gates below a claim that is untested");
  } else {
    const std::vector<std::string> known = ids_of(read.gates);
    for (const JsonPlace& gate : place["gates"].some_elements()) claim.gates.push_back(gate.one_of(known));
  }
  claim.remark = optional_text(place["remark"]);
  if (claim.finding != Finding::seen && claim.remark.empty()) {
    place["remark"].refuse("a remark that says why the claim is not simply seen");
  }
  return claim;
}

/// Numbers of threads, each once; none if `place` is absent.
std::vector<int> read_thread_counts(const JsonPlace& place) {
  constexpr int most_threads = 64;
  std::vector<int> counts;
  if (!place.present()) return counts;
  for (const JsonPlace& element : place.some_elements()) {
    const int count = element.integer();
    if (count < 1 || count > most_threads) element.refuse("a number of threads from 1 to " + std::to_string(most_threads));
    if (std::find(counts.begin(), counts.end(), count) != counts.end()) element.refuse("each number once", " again");
    counts.push_back(count);
  }
  return counts;
}

void read_description(const JsonPlace& place, Case& read) {
  read.id = place["id"].identifier();
  read.title = place["title"].text();
  read.description = place["description"].text();
  read.figure_of_paper = optional_text(place["figure_of_paper"]);
  read.notes = read_texts(place["notes"]);
  read.quick = place["quick"].flag_or(true);
  read.study = place["study"].flag_or(false);
  if (read.study && read.quick) place["quick"].refuse("false for a study, which takes long");
  read.repeat_on_other_threads = place["repeat_on_other_threads"].flag_or(false);
  read.repeat_on_threads = read_thread_counts(place["repeat_on_threads"]);
  read.references = read_names(place["references"], reference_catalogue());
}

/// A run that a reference solution does not describe would be judged by nonsense.
void require_suited(const JsonPlace& place, const Case& read) {
  for (const JsonPlace& name : place.elements()) {
    for (const RunRequest& run : read.runs) {
      const std::string missing = why_unsuited(name.text(), run);
      if (missing.empty()) continue;
      name.refuse(std::string("a reference solution that describes the ") +
                      (run.element ? "element test" : "scene") + "; it needs " + missing,
                  run.parameters.empty() ? "" : " for the run with " + name_of(run));
    }
  }
}

/// A gate on a metric for which too little is recorded would only find that it was not measured.
void require_recorded(const JsonPlace& place, const Case& read) {
  for (const JsonPlace& name : place.elements()) {
    for (const RunRequest& run : read.runs) {
      const std::string missing = why_not_judged(name.text(), read, run);
      if (missing.empty()) continue;
      name.refuse("a reference solution for which the case records enough; it needs " + missing, in_run(run));
    }
  }
}

/// Other descriptions of the scene, each of which every run must have.
std::vector<std::string> read_metamorphoses(const JsonPlace& place, const Case& read) {
  if (!place.present()) return {};
  const std::vector<std::string> names = read_names(place, names_of(metamorphosis_catalogue()));
  for (const JsonPlace& name : place.elements()) {
    for (const RunRequest& run : read.runs) {
      const std::string reason = why_not_describable(name.text(), run.scene);
      if (reason.empty()) continue;
      name.refuse("a metamorphosis that the scene has", ", but " + reason + in_run(run));
    }
  }
  return names;
}

/// Reads `read.text` into the rest of `read`, top to bottom: each part refers only to those before it.
void read_parts(Case& read) {
  const JsonPlace place(&read.text, "");
  std::vector<std::string> keys = {
      "$schema", "id",      "title", "figure_of_paper", "description",
      "claims",  "notes",   "quick", "study",           "repeat_on_other_threads",
      "scene",   "element", "sweep", "references",      "readings",
      "gates",   "figures"};
  keys.insert(keys.end(), {"measurements", "pairs", "repeat_on_threads"});
  if (!place["element"].present()) {
    keys.insert(keys.end(), {"metamorphoses", "probes", "snapshots", "cuts"});
    keys.insert(keys.end(), {"trades", "trade_without", "advice", "classification", "refusals", "rounding", "stability"});
  }
  place.allow_only(keys);
  optional_text(place["$schema"]);
  read_description(place, read);
  const Subject subject = read_subject(place);
  read_checked(subject);  // as written, before anything is swept
  read.sweep = read_sweep(place["sweep"], subject);
  read.runs = expand(subject, read.sweep, place["trade_without"], place["refusals"].flag_or(false));
  require_suited(place["references"], read);
  read.survey = read_survey(place["stability"]);
  if (read.survey) refuse_beside_survey(place);
  read.metamorphoses = read_metamorphoses(place["metamorphoses"], read);
  read.probes = read_probes(place["probes"], read.runs);
  read.snapshots = read_snapshots(place["snapshots"], read.runs, read.probes);
  require_recorded(place["references"], read);
  read.cuts = read_cuts(place["cuts"], read);
  read.measurements = read_measurements(place["measurements"], read);
  if (const JsonPlace readings = place["readings"]; readings.present()) {
    for (const JsonPlace& reading : readings.elements()) read.readings.push_back(read_reading(reading, read));
  }
  read.pairs = read_pairs(place["pairs"], read, metric_names(read));
  read.trades =
      read_trades(place["trades"], read, [&](const JsonPlace& metric) { return read_metric(metric, read); });
  read.advice = read_advice(place["advice"]);
  read.rounding = read_rounding(place["rounding"], read);
  read.classification = read_classification(
      place["classification"], read, [&](const JsonPlace& metric) { return read_metric(metric, read); });
  for (const JsonPlace& gate : place["gates"].some_elements()) read.gates.push_back(read_gate(gate, read));
  const auto asks_for_end = [](const Gate& gate) { return gate.metric == "completed" && !gate.must_fail; };
  if (!read.trades.empty() && std::none_of(read.gates.begin(), read.gates.end(), asks_for_end))
    place["gates"].refuse("a gate on completed that says which configurations of the trades must end well", ", none");
  if (const JsonPlace claims = place["claims"]; claims.present()) {
    for (const JsonPlace& claim : claims.elements()) read.claims.push_back(read_claim(claim, read));
  }
  if (const JsonPlace figures = place["figures"]; figures.present()) {
    for (const JsonPlace& figure : figures.elements()) read.figures.push_back(read_figure(figure, read));
  }
  // Last, since it depends on all that the case asks for, and what it asks for is checked against the scene as written.
  for (RunRequest& run : read.runs) {
    if (run.refusal.empty()) choose_model(read, run);
  }
}

/// The second, independent net: what the published schema refuses is refused, whatever the reader above
/// thinks.
void require_schema(const Json& text) {
  const std::optional<SchemaViolation> violation = schema_violation(text);
  if (!violation) return;
  throw Refusal(violation->pointer, "what case.schema.json allows", violation->description);
}

/// Keys and texts of the file can hold line breaks; a message cannot.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, '?');
  return text;
}

}  // namespace

std::vector<std::shared_ptr<const CurveFile>> curve_files_of(const Case& definition) {
  std::vector<std::shared_ptr<const CurveFile>> all;
  const auto add = [&](const std::shared_ptr<const CurveFile>& file) {
    const auto same = [&](const auto& known) { return known->id == file->id && known->file == file->file; };
    if (std::none_of(all.begin(), all.end(), same)) all.push_back(file);
  };
  for (const Measurement& measurement : definition.measurements) add(measurement.file);
  for (const PairedPrediction& pairs : definition.pairs) add(pairs.file);
  for (const FigureRequest& figure : definition.figures)
    for (const auto& file : figure.published) add(file);
  return all;
}

Case parse_case(const std::string& text, const std::filesystem::path& file) {
  try {
    Case read;
    read.file = file;
    read.text = parse_json(text);
    read_parts(read);
    require_schema(read.text);
    return read;
  } catch (const Refusal& refusal) {
    throw CaseError(file.string(), one_line(refusal.pointer()), one_line(refusal.expected()),
                    one_line(refusal.found()));
  }
}

Case read_case(const std::filesystem::path& file) {
  std::error_code error;
  std::ifstream stream;
  if (std::filesystem::is_regular_file(file, error)) stream.open(file, std::ios::binary);
  if (!stream.is_open()) {
    const bool exists = std::filesystem::exists(file, error);
    throw CaseError(file.string(), "", "a readable case file",
                    exists ? "something that cannot be read" : "no file");
  }
  return parse_case(std::string(std::istreambuf_iterator<char>(stream), {}), file);
}

}  // namespace mpm::vv
