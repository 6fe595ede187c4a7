#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/demo_verdict.hpp"

namespace mpm::support {

/// Verdicts of comparisons with measurements, for tests of their figures. Every number is made up from closed
/// forms; none was measured or simulated.
namespace demo {

using Stated = vv::StatedUncertainty;

inline vv::CurveColumn column(const std::string& name, const std::string& unit, const std::string& dimension,
                              Stated digitisation = {}, Stated experimental = {}) {
  return {name, unit, dimension, name + " of a made-up test", digitisation, experimental};
}

/// A surface that falls from 0.1 m at x = 0.2 m to nothing at 0.4 m, measured at `points` places.
inline double surface(double x) { return 0.1 * std::exp(-40.0 * (x - 0.2) * (x - 0.2)) * (1.0 - x / 0.45); }

inline std::shared_ptr<vv::CurveFile> surface_file(int points = 17) {
  auto file = std::make_shared<vv::CurveFile>();
  file->id = "demo_surface";
  file->title = "Surface of a collapsed heap";
  file->citation = "Demo00";
  file->place = "Figure 3";
  file->origin = "digitised";
  file->columns = {column("distance", "mm", "length", {Stated::Kind::absolute, 1e-3}),
                   column("height", "mm", "length", {Stated::Kind::absolute, 1e-3})};
  file->abscissa = 0;
  for (int k = 0; k < points; ++k) {
    const double x = 0.2 + 0.2 * k / (points - 1.0);
    file->rows.push_back({x, surface(x)});
  }
  return file;
}

inline std::shared_ptr<vv::CurveFile> empty_slot(const std::string& id) {
  auto file = std::make_shared<vv::CurveFile>(*surface_file());
  file->id = id;
  file->title = "A surface nobody has <measured>";
  file->missing = true;
  file->rows.clear();
  return file;
}

inline vv::Measurement measurement(const std::string& id, std::shared_ptr<const vv::CurveFile> file) {
  vv::Measurement measurement;
  measurement.id = id;
  measurement.file = std::move(file);
  measurement.curve = "free_surface";
  measurement.accuracy = 0.05;
  return measurement;
}

/// What comes of a curve `factor` times as high as what was measured: 2 u_val is about 4 % of the largest.
inline vv::CurveComparison comparison(const vv::Measurement& measurement, double factor,
                                      vv::Agreement agreement) {
  vv::CurveComparison c;
  c.measurement = measurement.id;
  c.agreement = agreement;
  for (const std::vector<double>& row : measurement.file->rows) {
    c.abscissa.push_back(row[0]);
    c.measured.push_back(row[1]);
    c.simulated.push_back(factor * row[1]);
    c.u_measured.push_back(1e-3 * (1.0 + 10.0 * (row[0] - 0.2)));
    c.u_numerical.push_back(8e-4);
    c.u_input.push_back(6e-4);
    c.u_validation.push_back(std::hypot(c.u_measured.back(), 1e-3));
  }
  c.overlap = 1.0;
  c.distance.comprehensive = 0.0434;
  c.inside = 0.706;
  c.excess = agreement == vv::Agreement::model_error ? 0.019 : 0.0;
  c.level = 0.043;
  return c;
}

}  // namespace demo

/// A heap that two schemes let collapse: uGIMP ends 12 % too high, cpGIMP within the uncertainty. A second
/// measurement is an empty slot.
inline vv::CaseVerdict demo_collapse() {
  using namespace demo;
  vv::CaseVerdict verdict;
  verdict.definition.id = "collapse";
  verdict.definition.title = "Collapse of a heap";
  verdict.definition.sweep = {{scheme_pointer, {"ugimp", "cpgimp"}}};
  verdict.definition.snapshots.resize(1);
  verdict.definition.measurements = {measurement("final_surface", surface_file()),
                                     measurement("other_surface", empty_slot("demo_other"))};
  for (const char* scheme : {"ugimp", "cpgimp"}) {
    const bool good = std::string(scheme) == "cpgimp";
    const double factor = good ? 1.02 : 1.12;
    vv::RunVerdict run = demo::run(scheme, 1, 10);
    run.parameters = {{scheme_pointer, scheme}};
    vv::Curve surface{"free_surface", "run", {}, {}, "position"};
    for (int k = 0; k <= 100; ++k) {
      const double x = 0.1 + 0.004 * k;
      surface.x.push_back(x);
      surface.y.push_back(std::max(0.0, factor * demo::surface(x)));
    }
    run.curves = {surface};
    run.comparisons = {comparison(verdict.definition.measurements[0], factor,
                                  good ? vv::Agreement::validated : vv::Agreement::model_error)};
    if (good) run.comparisons[0].inside = 1.0;
    vv::CurveComparison none;
    none.measurement = "other_surface";
    none.agreement = vv::Agreement::no_measurement;
    none.lack = "the slot is empty";
    run.comparisons.push_back(none);
    run.record.snapshots = {bubble("start", 0.0, 1e-3, 40), bubble("end", 1.0, 0.02, 40)};
    verdict.definition.runs.push_back(request(run, 0.005));
    verdict.runs.push_back(run);
  }
  vv::FigureRequest compared;
  compared.id = "surfaces";
  compared.kind = "comparison";
  compared.series = scheme_pointer;
  compared.measurements = {"final_surface", "other_surface"};
  compared.caption = "Made-up surfaces.";
  vv::FigureRequest field = figure("field", "fields", "displacement");
  field.panels.clear();
  field.measurements = {"final_surface", "other_surface"};
  verdict.definition.figures = {compared, field};
  verdict.status = vv::CaseStatus::pass;
  return verdict;
}

/// Twelve made-up capacities beside two formulas: one about half of what was measured, one about right.
inline vv::CaseVerdict demo_pairs() {
  using namespace demo;
  vv::CaseVerdict verdict;
  verdict.definition.id = "capacities";
  verdict.definition.title = "Capacities";
  auto file = std::make_shared<vv::CurveFile>();
  file->id = "demo_capacities";
  file->citation = "Demo00";
  file->columns = {column("capacity", "kPa", "pressure")};
  for (const auto& [id, title, factor] :
       {std::tuple{"exact", "exact factors", 0.43}, {"fitted", "fitted factors", 1.02}}) {
    vv::PairedPrediction prediction;
    prediction.id = id;
    prediction.title = title;
    prediction.file = file;
    verdict.definition.pairs.push_back(prediction);
    vv::PairsVerdict pairs;
    pairs.id = id;
    pairs.title = title;
    for (int k = 0; k < 12; ++k) {
      const double measured = 6e4 * std::pow(1.35, k);
      pairs.pairs.push_back({"test " + std::to_string(k), measured,
                             measured * factor * std::exp(0.15 * std::sin(2.0 * k + 5.0 * factor))});
    }
    pairs.factor = {factor, factor * 0.93, factor * 1.07, 0.12, 0.1, factor * 0.86, factor * 1.16};
    verdict.pairs.push_back(pairs);
  }
  verdict.pairs[0].unpredicted = {"test 12: no depth is <known>"};
  vv::FigureRequest figure;
  figure.id = "capacities";
  figure.kind = "pairs";
  figure.pairs = {"exact", "fitted"};
  verdict.definition.figures = {figure};
  verdict.status = vv::CaseStatus::pass;
  return verdict;
}

/// Run-out of columns over their aspect ratio, for two friction angles, beside two published laws.
inline vv::CaseVerdict demo_trend() {
  using namespace demo;
  vv::CaseVerdict verdict;
  verdict.definition.id = "run_out";
  verdict.definition.title = "Run-out";
  const char* angle_pointer = "/scene/bodies/0/material/friction_angle";
  const char* height_pointer = "/scene/bodies/0/height";
  for (const char* angle : {"20 deg", "30 deg"})
    for (const double ratio : {0.5, 1.0, 2.0, 4.0, 8.0}) {
      vv::RunVerdict run = demo::run("cpgimp", 1, 10);
      run.parameters = {{angle_pointer, angle}, {height_pointer, ratio}};
      run.metrics = {{"completed", 1.0},
                     {"collapse.aspect_ratio", ratio},
                     {"collapse.run_out", 1.7 * std::pow(ratio, 0.9) * (angle[0] == '2' ? 1.2 : 0.9)}};
      verdict.definition.runs.push_back(request(run, 0.005));
      verdict.runs.push_back(run);
    }
  vv::FigureRequest figure;
  figure.id = "run_out";
  figure.kind = "trend";
  figure.metrics = {"collapse.run_out"};
  figure.abscissa = "collapse.aspect_ratio";
  figure.over = height_pointer;
  figure.series = angle_pointer;
  for (const auto& [id, title, coefficient, power, upper] :
       {std::tuple{"first_law", "First law", 1.6, 0.85, 10.0}, {"second_law", "Second law", 2.1, 0.8, 5.0}}) {
    auto file = std::make_shared<vv::CurveFile>();
    file->id = id;
    file->title = title;
    file->citation = "Demo00";
    file->origin = "formula";
    file->columns = {column("aspect_ratio", "1", "ratio"), column("run_out", "1", "ratio")};
    file->abscissa = 0;
    for (int k = 0; k <= 10; ++k) {
      const double a = 0.3 * std::pow(upper / 0.3, k / 10.0);
      file->rows.push_back({a, coefficient * std::pow(a, power)});
    }
    figure.published.push_back(file);
  }
  verdict.definition.figures = {figure};
  verdict.status = vv::CaseStatus::pass;
  return verdict;
}

}  // namespace mpm::support
