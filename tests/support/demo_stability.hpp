#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/demo_verdict.hpp"

/// Surveys of time steps, classes of runs and rounding that nobody measured, for pictures and pages about
/// them.
namespace mpm::support {

/// Every step below `drift` accurate, from there drifting, from `ring` oscillating, from `limit` diverged.
inline vv::Survey demo_survey(double drift, double ring, double limit) {
  vv::Survey survey;
  survey.own = 0.2;
  survey.linear.limit = 1.1 * limit;
  survey.linear.unknowns = 40;
  survey.error_name = "top of the column";
  std::vector<double> fractions = {0.1,  0.15, 0.23, 0.36,         0.55,        0.83,
                                   1.28, 1.95, 3.0,  0.96 * limit, 1.02 * limit};
  std::sort(fractions.begin(), fractions.end());
  for (const double fraction : fractions) {
    vv::SurveyPoint point;
    point.fraction = fraction;
    point.stability = fraction >= limit   ? vv::StabilityClass::diverged
                      : fraction >= ring  ? vv::StabilityClass::oscillating
                      : fraction >= drift ? vv::StabilityClass::drifting
                                          : vv::StabilityClass::accurate;
    if (point.stability == vv::StabilityClass::accurate && survey.accurate < fraction)
      survey.accurate = fraction;
    if (fraction < limit) survey.stable = std::max(survey.stable, fraction);
    if (fraction >= limit && survey.unstable == 0.0) survey.unstable = fraction;
    survey.points.push_back(point);
  }
  return survey;
}

/// Surveys of two schemes, with two orders of the update each, in bars of several numbers of particles a
/// cell.
inline vv::CaseVerdict demo_maps() {
  vv::CaseVerdict verdict;
  verdict.definition.id = "time_steps";
  verdict.definition.title = "Time steps of a bar";
  verdict.status = vv::CaseStatus::pass;
  verdict.definition.survey = vv::SurveyRequest();
  int row = 0;
  for (const char* scheme : {"mpm", "ugimp", "cpgimp"})
    for (const char* order : {"musl", "usl"}) {
      for (const int particles : {1, 2, 3, 4}) {
        vv::RunVerdict run;
        run.parameters = {{"/scene/scheme", scheme},
                          {"/scene/update_order", order},
                          {"/scene/bodies/0/particles_per_cell/0", particles}};
        run.record.revision = "0123abcd";
        run.record.input_hash = "00ff00ff00ff00ff";
        run.record.outcome.ending = Ending::reached_time;
        const double limit = (row < 2 ? 0.5 : 1.0) + 0.15 * particles + 0.2 * (row % 2);
        run.record.survey = demo_survey(0.35 * limit, 0.8 * limit, limit);
        verdict.definition.runs.push_back({});
        verdict.definition.runs.back().parameters = run.parameters;
        verdict.runs.push_back(std::move(run));
      }
      ++row;
    }
  vv::FigureRequest figure;
  figure.id = "map";
  figure.kind = "stability";
  figure.caption = "What becomes of every time step.";
  figure.panels = "/scene/scheme";
  figure.series = "/scene/update_order";
  figure.map_axis = "/scene/bodies/0/particles_per_cell/0";
  verdict.definition.figures = {figure};
  return verdict;
}

}  // namespace mpm::support
