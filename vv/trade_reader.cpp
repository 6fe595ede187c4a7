#include "vv/trade_reader.hpp"

#include <algorithm>

#include "vv/measurement_reader.hpp"
#include "vv/run_groups.hpp"
#include "vv/sweep.hpp"

namespace mpm::vv {
namespace {

/// The curves of the case's runs, histories included.
std::vector<CurveKind> curves_to_trade(const Case& read) {
  std::vector<CurveKind> kinds = curve_kinds(read);
  for (const HistoryProbe& probe : read.probes)
    if (!contains(names_of(kinds), probe.id)) kinds.push_back({probe.id, "time", probe.quantity});
  return kinds;
}

/// Errors that somebody asks for, from large to small.
std::vector<double> read_asked(const JsonPlace& place) {
  std::vector<double> asked;
  for (const JsonPlace& element : place.some_elements()) {
    const double error = element.number();
    if (!(error > 0.0)) element.refuse("an error above zero");
    if (!asked.empty() && !(error < asked.back())) element.refuse("an error below the one before");
    asked.push_back(error);
  }
  return asked;
}

std::vector<std::string> read_problems(const JsonPlace& place, const Case& read) {
  std::vector<std::string> problems;
  if (!place.present()) return problems;
  for (const JsonPlace& element : place.elements()) {
    const std::string axis = read_axis(element, read.sweep).parameter;
    if (contains(problems, axis)) element.refuse("each axis once", " again");
    problems.push_back(axis);
  }
  return problems;
}

std::string read_family(const JsonPlace& place, const Case& read, const std::vector<std::string>& problems) {
  if (!place.present()) return "";
  const std::string family = read_axis(place, read.sweep).parameter;
  if (contains(problems, family)) place.refuse("an axis that is not among the problems");
  return family;
}

/// The runs that stand for the truth: those of each family apart, and of every family some of every problem.
std::vector<std::vector<Selector>> read_finest(const JsonPlace& place, const Case& read,
                                               const std::vector<std::string>& problems) {
  std::vector<std::vector<Selector>> finest;
  std::vector<std::size_t> taken;
  const std::vector<JsonPlace> elements = place.some_elements();
  if (elements.size() < 2) place.refuse("the runs of at least two families, as no family may judge itself");
  for (const JsonPlace& element : elements) {
    finest.push_back(read_where(element, read.sweep));
    const std::vector<std::size_t> runs = selected_runs(read, finest.back());
    for (const std::size_t run : runs) {
      if (std::find(taken.begin(), taken.end(), run) != taken.end())
        element.refuse("runs that no other family has", ", which share one" + in_run(read.runs[run]));
    }
    taken.insert(taken.end(), runs.begin(), runs.end());
    for (const RunGroup& problem : groups_alike_in(read, problems)) {
      const bool has_one = std::find_first_of(problem.runs.begin(), problem.runs.end(), runs.begin(),
                                              runs.end()) != problem.runs.end();
      if (has_one) continue;
      element.refuse("a run of every problem",
                     ", which selects none like the one" + in_run(read.runs[problem.runs.front()]));
    }
  }
  return finest;
}

/// One run of each problem.
std::vector<Selector> read_baseline(const JsonPlace& place, const Case& read,
                                    const std::vector<std::string>& problems) {
  const std::vector<Selector> baseline = read_where(place, read.sweep);
  const std::vector<std::size_t> runs = selected_runs(read, baseline);
  for (const RunGroup& problem : groups_alike_in(read, problems)) {
    const auto count = std::count_if(problem.runs.begin(), problem.runs.end(), [&](std::size_t run) {
      return std::find(runs.begin(), runs.end(), run) != runs.end();
    });
    if (count != 1) {
      place.refuse("one run of every problem", ", which selects " + std::to_string(count) + " like the one" +
                                                   in_run(read.runs[problem.runs.front()]));
    }
  }
  return baseline;
}

double read_end(const JsonPlace& place, const CurveKind& kind) {
  return place.quantity(kind.abscissa == "time" ? QuantityKind::time : QuantityKind::length);
}

void read_curve(const JsonPlace& place, const Case& read, TradeRequest& trade) {
  const std::vector<CurveKind> kinds = curves_to_trade(read);
  trade.curve = place["curve"].one_of(names_of(kinds));
  const CurveKind& kind = *std::find_if(kinds.begin(), kinds.end(),
                                        [&](const CurveKind& each) { return each.name == trade.curve; });
  if (const JsonPlace baseline = place["baseline"]; baseline.present()) {
    if (place["finest"].present()) place["finest"].refuse("no finest runs beside a baseline");
    trade.baseline = read_baseline(baseline, read, trade.problems);
  } else {
    trade.finest = read_finest(place["finest"], read, trade.problems);
  }
  trade.from = read_end(place["from"], kind);
  trade.up_to = read_end(place["up_to"], kind);
  if (!(trade.up_to > trade.from)) place["up_to"].refuse("an end beyond where the stretch begins");
  if (const JsonPlace within = place["within"]; within.present()) {
    trade.within = read_end(within, kind);
    if (!(trade.within > 0.0)) within.refuse("a half-width above zero");
  }
}

TradeRequest read_trade(const JsonPlace& place, const Case& read, const std::vector<TradeRequest>& earlier,
                        const std::function<std::string(const JsonPlace&)>& read_metric) {
  std::vector<std::string> keys = {"title", "metric", "problems", "family", "asked"};
  const bool of_curve = place["curve"].present();
  if (of_curve) keys = {"title", "curve", "finest", "baseline", "from", "up_to", "within", "problems", "family", "asked"};
  place.allow_only(keys);
  TradeRequest trade;
  trade.title = place["title"].text();
  for (const TradeRequest& other : earlier)
    if (other.title == trade.title) place["title"].refuse("a title that no other trade of the case has");
  trade.problems = read_problems(place["problems"], read);
  trade.family = read_family(place["family"], read, trade.problems);
  if (of_curve)
    read_curve(place, read, trade);
  else
    trade.metric = read_metric(place["metric"]);
  trade.asked = read_asked(place["asked"]);
  return trade;
}

}  // namespace

std::vector<TradeRequest> read_trades(const JsonPlace& place, const Case& read,
                                      const std::function<std::string(const JsonPlace&)>& read_metric) {
  std::vector<TradeRequest> trades;
  if (!place.present()) return trades;
  for (const JsonPlace& element : place.some_elements())
    trades.push_back(read_trade(element, read, trades, read_metric));
  return trades;
}

std::optional<AdviceTest> read_advice(const JsonPlace& place) {
  if (!place.present()) return std::nullopt;
  place.allow_only({"of", "asked"});
  return AdviceTest{place["of"].identifier(), read_asked(place["asked"])};
}

std::vector<std::string> trade_metric_names(const std::vector<TradeRequest>& trades) {
  std::vector<std::string> names;
  for (std::size_t number = 1; number <= trades.size(); ++number)
    for (const char* what : {".error", ".bound"})
      names.push_back(trade_prefix + std::to_string(number) + what);
  return names;
}

}  // namespace mpm::vv
