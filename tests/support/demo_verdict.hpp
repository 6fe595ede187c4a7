#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "vv/verdict.hpp"

namespace mpm::support {

/// A verdict shaped like that of a real campaign, for tests of the report. Every number in it is made up from
/// closed forms; none comes from a simulation.
namespace demo {

inline constexpr double youngs_modulus = 1e7, unit_weight = 9800.0;
inline const char* level_pointer = "/scene/gravity/level";
inline const char* scheme_pointer = "/scene/scheme";
inline const char* size_pointer = "/scene/grid/cell_size";

inline double height(double X, double q) {
  return youngs_modulus / q * (std::exp(-q * (1.0 - X) / youngs_modulus) - std::exp(-q / youngs_modulus));
}

/// Amplitude of the made-up error of a scheme at a level, relative to the largest stress.
inline double roughness(const std::string& scheme, int level) {
  if (scheme == "mpm") return level >= 50 ? 40.0 : 8e-4 * level;
  if (scheme == "ugimp") return 5e-5 * level;
  return 8e-6 * level + 5e-5;
}

inline vv::RunVerdict run(const std::string& scheme, int level, int particles) {
  vv::RunVerdict run;
  run.record.case_id = "column_figure_1";
  run.record.revision = "0123abcd";
  run.record.input_hash = "00ff00ff00ff00ff";
  run.record.outcome.ending = Ending::at_rest;
  run.record.outcome.step = 40000;
  run.record.outcome.time = 2.0;
  run.record.cost = {0.21, 40000, 40000LL * particles};
  run.record.cell_crossings = level >= 50 ? 31 : 0;
  const double q = unit_weight * level, amplitude = roughness(scheme, level);
  vv::Curve stress{"stress", "run", {}, {}, "position"}, exact{"stress", "zhang", {}, {}, "position"};
  vv::Curve displacement{"displacement", "run", {}, {}, "initial_position"};
  vv::Curve exact_displacement{"displacement", "hencky", {}, {}, "initial_position"};
  vv::Curve error{"stress_error", "run", {}, {}, "position"};
  for (int p = 0; p < particles; ++p) {
    const double X = (p + 0.5) / particles, x = height(X, q);
    const double e = amplitude * std::sin(17.0 * p) * std::cos(2.0 + p * p);
    stress.x.push_back(x);
    stress.y.push_back(-q * (1.0 - X) + e * q);
    exact.x.push_back(x);
    exact.y.push_back(-q * (1.0 - X));
    error.x.push_back(x);
    error.y.push_back(e);
    displacement.x.push_back(X);
    displacement.y.push_back((x - X) * (1.0 + 0.1 * e));
    exact_displacement.x.push_back(X);
    exact_displacement.y.push_back(x - X);
  }
  vv::Curve top{"top", "run", {}, {}, "time"};
  for (int k = 0; k <= 200; ++k) {
    const double t = 0.01 * k, ramp = t < 1.0 ? t : 1.0;
    top.x.push_back(t);
    top.y.push_back((height(1.0, q) - 1.0) * ramp * (1.0 + 0.02 * std::exp(-2.0 * t) * std::sin(30.0 * t)));
  }
  run.curves = {stress, exact, displacement, exact_displacement, error, top};
  run.metrics = {{"hencky.stress.l2", 0.7 * amplitude},
                 {"zhang.stress.l2", 0.7 * amplitude + 2.7e-4},
                 {"equilibrium.stress.l2", 0.7 * amplitude},
                 {"hencky.displacement.linf", 0.1 * amplitude},
                 {"oscillation.hp", 0.6 * amplitude},
                 {"oscillation.ns", 0.5 * amplitude},
                 {"floor.stress.l2", 2.7e-4},
                 {"cell_crossings", run.record.cell_crossings},
                 {"completed", 1.0}};
  return run;
}

inline vv::GateResult gate(const std::string& id, const std::string& metric, double value, double threshold,
                           bool must_fail, const std::string& scope) {
  vv::GateResult result;
  result.id = id;
  result.metric = metric;
  result.statistic = "value";
  result.basis = "requirement";
  result.reason = "the error of a settled column is that of its discretisation, not that of cell crossings";
  result.scope = scope;
  result.value = value;
  result.op = "<=";
  result.threshold = threshold;
  result.must_fail = must_fail;
  const bool green = value <= threshold;
  result.status = must_fail ? (green ? vv::GateStatus::unexpectedly_green : vv::GateStatus::red_as_expected)
                            : (green ? vv::GateStatus::pass : vv::GateStatus::fail);
  return result;
}

inline vv::RunRequest request(const vv::RunVerdict& run, double cell_size) {
  vv::RunRequest request;
  request.parameters = run.parameters;
  request.scene.cell_size = cell_size;
  Body column;
  column.name = "column";
  column.material = LinearElastic{youngs_modulus, 0.0};
  request.scene.bodies = {column};
  return request;
}

inline vv::FigureRequest figure(const std::string& id, const std::string& kind, const std::string& quantity) {
  vv::FigureRequest figure;
  figure.id = id;
  figure.kind = kind;
  figure.quantity = quantity;
  figure.panels = level_pointer;
  figure.series = scheme_pointer;
  figure.caption = "A made-up picture of kind " + kind + ".";
  return figure;
}

inline vv::Gate gate_definition(const std::string& id, const std::string& metric, double threshold) {
  vv::Gate gate;
  gate.id = id;
  gate.metric = metric;
  gate.threshold = threshold;
  gate.basis = "requirement";
  gate.reason = "oscillation of one per cent is visible in a figure";
  return gate;
}

inline void record_failure(vv::RunVerdict& run) {
  run.record.outcome = {Ending::outside_grid, 12345, 0.617, 49, 1.0412};
  run.curves.clear();
  run.metrics = {{"completed", 0.0}, {"cell_crossings", 4711.0}};
}

/// Half of a soil body, 2 m wide and 1 m deep below y = 1 m, under a strip that presses on its left end: the
/// displacement is a bubble that dies away with the distance from the strip. `across` particles side by side.
inline vv::Snapshot bubble(const std::string& moment, double time, double settlement, int across) {
  vv::Snapshot snapshot;
  snapshot.moment = moment;
  snapshot.time = time;
  ParticleFields& f = snapshot.fields;
  f.dimension = 2;
  const double spacing = 2.0 / across;
  for (int j = 0; j < across / 2; ++j)
    for (int i = 0; i < across; ++i) {
      const double X = (i + 0.5) * spacing, Y = (j + 0.5) * spacing, depth = 1.0 - Y;
      const double r = X * X / 0.08 + depth * depth / 0.16, decay = std::exp(-r);
      const double ux = settlement * 0.7 * X / 0.28 * decay,
                   uy = settlement * (0.6 * std::exp(-(X - 0.8) * (X - 0.8) / 0.04 - depth / 0.2) - decay);
      const double shear = 1.5 * settlement / 0.28 * (r - 0.5) * decay * X / 0.28;
      const double load = 5e5 * settlement / 0.28 * decay, weight = 1.8e4 * depth;
      f.initial_position.insert(f.initial_position.end(), {X, Y});
      f.displacement.insert(f.displacement.end(), {ux, uy});
      f.position.insert(f.position.end(), {X + ux, Y + uy});
      f.velocity.insert(f.velocity.end(), {0.1 * ux, 0.1 * uy});
      f.half_size.insert(f.half_size.end(), {spacing / 2, spacing / 2});
      f.stress.insert(f.stress.end(), {-0.5 * weight - 0.4 * load, -weight - load, -0.5 * weight - 0.4 * load,
                                       0.5 * load * std::sin(3.0 * X) * (1.0 - r)});
      f.strain.insert(f.strain.end(), {shear / 4, -shear / 4, 0.0, shear / 2});
      f.volume.push_back(spacing * spacing);
      f.initial_volume.push_back(spacing * spacing);
      f.mass.push_back(1800.0 * spacing * spacing);
      f.body.push_back(0);
    }
  return snapshot;
}

/// Pressure over settlement, hyperbolic towards a limit that the limit analysis gives.
inline void add_settlement_curves(vv::RunVerdict& run, double limit, double stiffness) {
  vv::Curve pressure{"pressure", "run", {}, {}, "settlement"};
  vv::Curve exact{"pressure", "limit_analysis", {0.0, 0.05}, {limit, limit}, "settlement"};
  vv::Curve elastic{"pressure", "elastic_strip", {}, {}, "settlement"};
  for (int k = 0; k <= 100; ++k) {
    const double s = 5e-4 * k;
    pressure.x.push_back(s);
    pressure.y.push_back(s / (1.0 / stiffness + s / (1.04 * limit)));
    if (stiffness * s > 1.1 * limit) continue;
    elastic.x.push_back(s);
    elastic.y.push_back(stiffness * s);
  }
  run.curves = {pressure, exact, elastic};
}

}  // namespace demo

/// A strip footing under three schemes at two levels of gravity; MPM leaves the grid at the second level
/// after its first snapshot. `across` particles a row in every snapshot.
inline vv::CaseVerdict demo_footing(int across = 60) {
  using namespace demo;
  vv::CaseVerdict verdict;
  verdict.definition.id = "strip_footing";
  verdict.definition.title = "Strip footing on sand";
  verdict.definition.references = {"limit_analysis", "elastic_strip"};
  verdict.definition.sweep = {{level_pointer, {1, 50}}, {scheme_pointer, {"mpm", "ugimp", "cpgimp"}}};
  verdict.definition.snapshots.resize(3);
  for (const int level : {1, 50})
    for (const char* scheme : {"mpm", "ugimp", "cpgimp"}) {
      vv::RunVerdict run = demo::run(scheme, level, across * across / 2);
      run.parameters = {{level_pointer, level}, {scheme_pointer, scheme}};
      run.metrics = {{"completed", 1.0}, {"limit_analysis.overshoot", 0.01 * level}};
      const double softer = std::string(scheme) == "cpgimp" ? 1.0 : 1.15;
      add_settlement_curves(run, 8e4 * std::sqrt(level), 1e7 / softer * std::sqrt(level));
      for (const int s : {5, 20, 50})
        run.record.snapshots.push_back(
            bubble("footing = −" + std::to_string(s) + " mm", 0.1 * s, 1e-3 * s * softer, across));
      if (level == 50 && std::string(scheme) == "mpm") {
        record_failure(run);
        run.record.snapshots.resize(1);
      }
      verdict.definition.runs.push_back(request(run, 0.02));
      verdict.runs.push_back(run);
    }
  vv::FigureRequest strain = figure("shear", "fields", "max_shear_strain");
  strain.where = {{level_pointer, {50}}};
  vv::FigureRequest stress = figure("shear_stress", "fields", "stress_xy");
  stress.where = {{level_pointer, {1}}};
  verdict.definition.figures = {strain, stress, figure("settling", "curves", "pressure")};
  verdict.status = vv::CaseStatus::pass;
  return verdict;
}

/// Four gravity levels and three schemes; MPM scatters by orders of magnitude at 50G.
inline vv::CaseVerdict demo_levels() {
  using namespace demo;
  vv::CaseVerdict verdict;
  verdict.definition.id = "column_figure_1";
  verdict.definition.title = "1D elastic column under 1G, 10G, 20G and 50G";
  verdict.definition.figure_of_paper = "Figure 1";
  verdict.definition.description = "A made-up column of 50 particles, 1 m high.";
  verdict.definition.claims = {
      {"cpGIMP follows the exact stress at every level.", vv::Finding::seen, {"smooth"}, ""}};
  verdict.definition.notes = {"Numbers of this case are made up."};
  verdict.definition.references = {"equilibrium", "hencky", "zhang"};
  verdict.definition.sweep = {{level_pointer, {1, 10, 20, 50}}, {scheme_pointer, {"mpm", "ugimp", "cpgimp"}}};
  verdict.definition.gates = {gate_definition("smooth", "oscillation.hp", 0.01)};
  vv::HistoryProbe probe;
  probe.id = "top";
  probe.quantity = "displacement";
  verdict.definition.probes = {probe};
  for (const int level : {1, 10, 20, 50})
    for (const char* scheme : {"mpm", "ugimp", "cpgimp"}) {
      vv::RunVerdict run = demo::run(scheme, level, 50);
      run.parameters = {{level_pointer, level}, {scheme_pointer, scheme}};
      const std::string scope = std::to_string(level) + "G, " + scheme;
      const bool control = std::string(scheme) == "mpm" && level == 50;
      run.gates = {gate(control ? "oscillation_control" : "smooth", "oscillation.hp",
                        run.metrics["oscillation.hp"], control ? 0.01 : 0.02, control, scope)};
      verdict.definition.runs.push_back(request(run, 0.02));
      verdict.runs.push_back(run);
    }
  vv::FigureRequest stress = figure("stress", "profiles", "stress");
  stress.references = {"zhang"};
  vv::FigureRequest displacement = figure("displacement", "profiles", "displacement");
  displacement.references = {"hencky"};
  vv::FigureRequest bars = figure("oscillation", "bars", "");
  bars.metrics = {"oscillation.hp", "oscillation.ns"};
  verdict.definition.figures = {stress, displacement, figure("stress_error", "profiles", "stress_error"),
                                bars, figure("settling", "history", "top")};
  verdict.status = vv::CaseStatus::pass;
  return verdict;
}

/// Five cell sizes and three schemes at 50G; MPM leaves the grid on all but the coarsest.
inline vv::CaseVerdict demo_convergence() {
  using namespace demo;
  vv::CaseVerdict verdict;
  verdict.definition.id = "column_convergence";
  verdict.definition.title = "Refinement of the column at 50G";
  verdict.definition.references = {"hencky", "zhang"};
  vv::FigureRequest figure;
  figure.id = "convergence";
  figure.kind = "convergence";
  figure.over = size_pointer;
  figure.series = scheme_pointer;
  figure.metrics = {"hencky.stress.l2", "zhang.stress.l2"};
  figure.caption = "Made-up errors over the cell size.";
  verdict.definition.figures = {figure};
  for (const char* scheme : {"mpm", "ugimp", "cpgimp"}) {
    vv::SeriesVerdict series;
    series.across = size_pointer;
    series.fixed = {{scheme_pointer, scheme}};
    for (const int cells : {25, 50, 100, 200, 400}) {
      const double h = 1.0 / cells;
      vv::RunVerdict run = demo::run(scheme, 50, cells);
      run.parameters = {{scheme_pointer, scheme}, {size_pointer, std::to_string(h).substr(0, 6) + " m"}};
      const std::string name = scheme;
      const double error = name == "cpgimp"  ? 1.5 * std::pow(h, 1.6)
                           : name == "ugimp" ? 2.7e-3 * std::pow(cells / 50.0, 0.4)
                                             : 30.0;
      run.metrics["hencky.stress.l2"] = error;
      run.metrics["zhang.stress.l2"] = std::hypot(error, 2.7e-4);
      if (name == "mpm" && cells > 25) record_failure(run);
      series.cell_size.push_back(h);
      const auto found = run.metrics.find("hencky.stress.l2");
      series.metrics["hencky.stress.l2"].push_back(
          found == run.metrics.end() ? std::numeric_limits<double>::quiet_NaN() : found->second);
      verdict.definition.runs.push_back(request(run, h));
      verdict.runs.push_back(run);
    }
    if (std::string(scheme) != "mpm") {
      const auto& values = series.metrics["hencky.stress.l2"];
      for (std::size_t k = 0; k + 1 < values.size(); ++k)
        series.orders["hencky.stress.l2"].push_back(std::log2(values[k] / values[k + 1]));
    }
    verdict.series.push_back(series);
  }
  verdict.status = vv::CaseStatus::pass;
  return verdict;
}

/// A campaign of the two cases above, and of one that was not run.
inline vv::CampaignVerdict demo_campaign() {
  vv::CampaignVerdict campaign;
  campaign.revision = "0123abcd";
  campaign.host = "host";
  campaign.processor = "a processor";
  campaign.compiler = "a compiler";
  campaign.build = "Release";
  campaign.date = "2000-01-01T00:00:00Z";
  campaign.threads = 2;
  campaign.wall_seconds = 12.5;
  campaign.cases = {demo_levels(), demo_convergence()};
  return campaign;
}

}  // namespace mpm::support
