#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/demo_verdict.hpp"

namespace mpm::support {

/// Verdicts of speed against accuracy, for tests of what the report says of it. Every number is made up from
/// closed forms; none was measured or simulated.
namespace demo {

inline const char* order_pointer = "/scene/update_order";
inline const char* step_pointer = "/scene/time_step/factor";
inline const char* precision_pointer = "/scene/precision";

/// Marks what no other point with an error beats at both, the reference's runs left out.
inline void mark_fronts(vv::TradeVerdict& trade) {
  const auto beaten = [&trade](const vv::TradePoint& p, auto price) {
    for (const vv::TradePoint& q : trade.points)
      if (&q != &p && q.failure.empty() && !q.of_reference && price(q) <= price(p) && q.error <= p.error &&
          (price(q) < price(p) || q.error < p.error))
        return true;
    return false;
  };
  for (vv::TradePoint& p : trade.points) {
    if (!p.failure.empty() || p.of_reference) continue;
    p.on_time_front = p.timing && !beaten(p, [](const vv::TradePoint& q) {
                        return q.timing ? q.timing->median : std::numeric_limits<double>::infinity();
                      });
    p.on_work_front = !beaten(p, [](const vv::TradePoint& q) { return q.work.bytes; });
  }
}

/// What a column of cells costs: `work` particle-steps of `bytes` each, with a spread that differs from run
/// to run.
inline void set_price(vv::TradePoint& point, double work, double bytes, double nanoseconds) {
  point.work = {work, work * bytes, work * 150.0};
  const double wobble = 0.02 + 0.03 * std::fabs(std::sin(7.0 * static_cast<double>(point.run)));
  const double seconds = work * nanoseconds * 1e-9;
  point.timing =
      vv::Timing{seconds, seconds * (1.0 - 0.4 * wobble), seconds * (1.0 + 2.0 * wobble), 5, work < 1e9};
}

struct ColumnChoice {
  std::string scheme;
  double size_mm;
  std::string order;
  double step;
  std::string precision;
};

inline double column_error(const ColumnChoice& c, int level) {
  const double h = c.size_mm * 1e-3, crossings = level >= 50 ? 1.0 : 0.1;
  const double scheme = c.scheme == "cpgimp"  ? 1.5 * std::pow(h, 1.7)
                        : c.scheme == "ugimp" ? 3e-3 * crossings + 1.2 * std::pow(h, 1.5)
                                              : 0.12 * crossings * std::pow(h / 0.02, -0.4);
  const double order = c.order == "usl" ? 1.3 : 1.0;
  const double rounding = c.precision == "float" ? 2e-7 / h : 0.0;
  return scheme * order * (1.0 + 0.2 * c.step * c.step) + rounding;
}

inline vv::TradePoint column_point(const ColumnChoice& c, int level, std::size_t run) {
  vv::TradePoint point;
  point.run = run;
  point.configuration = {{scheme_pointer, c.scheme},
                         {size_pointer, std::to_string(c.size_mm).substr(0, 4) + " mm"},
                         {order_pointer, c.order},
                         {step_pointer, c.step},
                         {precision_pointer, c.precision}};
  point.family = c.scheme;
  point.cell_size = c.size_mm * 1e-3;
  const double cells = 1000.0 / c.size_mm, work = 2.0 * cells * cells * 400.0 / c.step;
  if (c.scheme == "mpm" && level >= 50 && (c.size_mm < 4.0 || c.step > 0.8)) {
    point.failure = "a particle left the grid at step 617";
    point.work = {0.1 * work, 0.1 * work * 200.0, 0.0};
    return point;
  }
  point.error = column_error(c, level);
  const double order = c.order == "usl" ? 0.74 : 1.0, scheme = c.scheme == "mpm" ? 0.7 : 1.0;
  const double width = c.precision == "float" ? 0.55 : 1.0;
  set_price(point, work, 260.0 * width * scheme * order, 22.0 * (0.4 + 0.6 * width) * scheme * order);
  return point;
}

inline vv::RunVerdict run_of(const vv::TradePoint& point,
                             const std::vector<std::pair<std::string, vv::Json>>& problem) {
  vv::RunVerdict run;
  run.parameters = problem;
  run.parameters.insert(run.parameters.end(), point.configuration.begin(), point.configuration.end());
  run.record.revision = "0123abcd";
  run.record.input_hash = "00ff00ff00ff00ff";
  run.record.outcome.ending = point.failure.empty() ? Ending::at_rest : Ending::outside_grid;
  return run;
}

inline vv::FigureRequest trade_figure(const std::string& title) {
  vv::FigureRequest figure;
  figure.id = "trade";
  figure.kind = "trade";
  figure.trade = title;
  figure.caption = "Made-up errors over made-up costs.";
  return figure;
}

/// The run that a point is of, each parameter an axis that sets it.
inline vv::RunRequest request_of(const vv::RunVerdict& run) {
  vv::RunRequest request;
  request.parameters = run.parameters;
  for (const auto& [name, value] : run.parameters) {
    request.changes.push_back({{"set", {{name, value}}}});
    if (name == "/scene/precision" && value == "float") request.scene.precision = Precision::float32;
  }
  return request;
}

}  // namespace demo

/// A column at two levels of gravity: 96 configurations each, errors against an exact solution; at 50G half
/// of MPM's fail.
inline vv::CaseVerdict demo_trade_column() {
  using namespace demo;
  vv::CaseVerdict verdict;
  verdict.definition.id = "trade_column";
  verdict.definition.title = "Column: speed against accuracy";
  vv::TradeRequest request;
  request.title = "stress of the column";
  request.problems = {level_pointer};
  request.metric = "hencky.stress.l2";
  request.family = scheme_pointer;
  request.asked = {0.01, 0.003, 1e-5};
  verdict.definition.trades = {request};
  verdict.definition.figures = {trade_figure(request.title)};
  std::size_t number = 0;
  for (const int level : {1, 50}) {
    vv::TradeVerdict trade;
    trade.title = request.title;
    trade.problem = {{level_pointer, level}};
    trade.error_name = request.metric;
    trade.reference.source = "hencky";
    for (const char* scheme : {"mpm", "ugimp", "cpgimp"})
      for (const double size : {20.0, 10.0, 5.0, 2.5})
        for (const char* order : {"musl", "usl"})
          for (const double step : {0.25, 0.9})
            for (const char* precision : {"double", "float"}) {
              trade.points.push_back(column_point({scheme, size, order, step, precision}, level, number++));
              verdict.runs.push_back(run_of(trade.points.back(), trade.problem));
              verdict.definition.runs.push_back(request_of(verdict.runs.back()));
            }
    mark_fronts(trade);
    verdict.trades.push_back(trade);
  }
  verdict.status = vv::CaseStatus::pass;
  return verdict;
}

/// A footing whose reference is the mean of the finest runs of three methods, with an uncertainty of its own;
/// every method is a variant.
inline vv::CaseVerdict demo_trade_footing() {
  using namespace demo;
  vv::CaseVerdict verdict;
  verdict.definition.id = "trade_footing";
  verdict.definition.title = "Footing <on sand>: speed & accuracy";
  vv::TradeRequest request;
  request.title = "load–settlement curve";
  request.curve = "pressure";
  request.family = "method";
  request.asked = {0.1, 0.05, 0.005};
  verdict.definition.trades = {request};
  verdict.definition.figures = {trade_figure("")};
  vv::TradeVerdict trade;
  trade.title = request.title;
  trade.error_name = "pressure";
  trade.reference = {
      "mean of the finest runs of 3 methods", {0.0, 0.01, 0.02}, {0.0, 8e4, 1e5}, {0.0, 2e3, 1e3}, 0.018};
  std::size_t number = 0;
  for (const char* method : {"paper's own", "rigid <footing>", "rigid, mass × 4"})
    for (const double size : {20.0, 10.0, 5.0}) {
      vv::TradePoint point;
      point.run = number++;
      point.configuration = {{"method", method}, {size_pointer, std::to_string(size).substr(0, 4) + " mm"}};
      point.family = method;
      point.cell_size = size * 1e-3;
      const bool block = method[0] == 'p', scaled = std::string(method).ends_with("4");
      if (scaled && size > 15.0) {
        point.failure = "not moved so far by the deadline & more";
      } else {
        point.error = 0.012 + 8.0 * point.cell_size * (block ? 1.4 : 1.0) * (scaled ? 1.05 : 1.0) - 0.03;
        point.uncertainty = 0.018;
        set_price(point, 4e12 / std::pow(size, 3) * (block ? 8.0 : 1.0) / (scaled ? 2.0 : 1.0), 400.0, 30.0);
      }
      point.of_reference = size < 6.0;
      trade.points.push_back(point);
      verdict.runs.push_back(run_of(point, {}));
      verdict.definition.runs.push_back(request_of(verdict.runs.back()));
    }
  mark_fronts(trade);
  verdict.trades = {trade};
  verdict.status = vv::CaseStatus::pass;
  return verdict;
}

}  // namespace mpm::support
