#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solver/simulation.hpp"
#include "vv/behaviour.hpp"

/// How large a time step a scene bears: by the matrix of one step, and by runs.
namespace mpm::vv {

/// The key `stability` of a case: each of its runs becomes a survey of time steps.
struct SurveyRequest {
  double from = 0.1, to = 3.0;  ///< least and largest time step tried, as fractions of cell size / wave speed
  int points = 9;               ///< of the scan, evenly spaced in the logarithm, ends included
  int bisections = 5;           ///< that follow, between the last stable step and the first that is not
  bool runs = true;             ///< whether runs are made; without them only the matrix is asked
  double accuracy = 0.01;       ///< an answer is accurate if its error is at most this, or ...
  double times_least = 2.0;     ///< ... at most so many times that of the smallest step
};

/// One time step of a survey.
struct SurveyPoint {
  double fraction = 0.0;  ///< time step * wave speed / cell size [-]
  StabilityClass stability = StabilityClass::accurate;
  Outcome outcome;         ///< of the run; of one that was refused it says nothing
  std::string reason;      ///< for a person: why it diverged or was refused; else empty
  SignalShape signal;      ///< of the body's mean displacement, once all loads have settled
  double zigzag = 0.0;     ///< of the stress
  double error = 0.0;      ///< of the answer [-]
};

/// What the matrix of one step says; of the scene as it is at the start, linear, without damping.
struct LinearStability {
  double limit = 0.0;  ///< largest stable time step * wave speed / cell size [-]; 0 if none was found
  std::int64_t unknowns = 0;           ///< size of the matrix
  std::vector<double> fraction, radius;  ///< time steps tried, ascending, and the spectral radius there
  std::string lack;                    ///< why there is no limit, for a person; empty beside one
};

/// All that was found out about the time step of a scene.
struct Survey {
  double own = 0.0;       ///< the fraction that the scene itself asks for or comes to [-]
  LinearStability linear;
  std::vector<SurveyPoint> points;  ///< ascending in `fraction`
  double stable = 0.0;    ///< largest fraction tried up to which none diverged [-]; 0 if the smallest did
  double unstable = 0.0;  ///< least fraction that diverged [-]; 0 if none did
  double accurate = 0.0;  ///< largest fraction tried up to which the errors of all are within the limit [-]; 0 if the smallest is not
  std::string error_name;  ///< what `SurveyPoint::error` is, for a person
};

}  // namespace mpm::vv
