#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vv/case_file.hpp"

/// What accuracy costs: the runs of a case as configurations of one problem, each with its error and its price.
namespace mpm::vv {

/// How long the steps of a run take on this machine, alone on it and with one thread.
struct Timing {
  double median = 0.0, low = 0.0, high = 0.0;  ///< of the repeats, for the whole run [s]; 0 < low <= median <= high
  int repeats = 0;
  bool whole = true;  ///< every repeat did the whole run; else its beginning, and the rest was scaled up
};

/// The work of a run, counted and free of noise.
struct CountedWork {
  double particle_steps = 0.0;
  double bytes = 0.0;       ///< moved between memory and processor [B]
  double operations = 0.0;  ///< floating-point
};

/// One configuration: a run, how far off it is, what it costs.
struct TradePoint {
  std::size_t run = 0;  ///< index into the runs of the case
  std::vector<std::pair<std::string, Json>> configuration;  ///< the run's parameters without those of the problem
  std::string family;   ///< value of the request's `family`, for a person; empty without one
  double cell_size = 0.0;  ///< [m]
  double error = std::numeric_limits<double>::quiet_NaN();  ///< relative [-]; NaN if there is none, then `failure` says why
  double uncertainty = 0.0;  ///< of the error, from the reference it is measured against [-]; 0 of an exact one
  std::string failure;       ///< for a person: "a particle left the grid"; empty beside an error
  bool of_reference = false;  ///< one of the finest runs: judged by those of the other families, and no offer
  std::optional<Timing> timing;
  CountedWork work;
  bool on_time_front = false, on_work_front = false;  ///< no configuration is both better and cheaper

  /// The error that can be promised [-]: at most this, as far as the reference is known.
  double bound() const { return error + uncertainty; }
};

/// A curve that stands for the truth, of the finest runs of several families.
struct TradeReference {
  std::string source;          ///< "hencky" and the like, or what the curve is the mean of
  std::vector<double> x, y;    ///< of a curve only; SI units
  std::vector<double> spread;  ///< half the range of the families at each abscissa
  double uncertainty = 0.0;    ///< L2 norm of `spread` relative to that of the curve [-]; 0 of an exact one
};

/// All configurations of one problem.
struct TradeVerdict {
  std::string title;    ///< the request's
  std::vector<std::pair<std::string, Json>> problem;  ///< parameters that make it one; empty if there is one only
  std::string error_name;  ///< metric or curve that the error is of
  TradeReference reference;
  std::vector<TradePoint> points;  ///< in the order of the runs
};

}  // namespace mpm::vv
