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

struct RunVerdict;

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

/// Of the runs of a case, in their order; nothing of a run that was not timed.
using Timings = std::vector<std::optional<Timing>>;

/// What the trades of a case say: one verdict for each problem of each trade, in the order of the case.
/// `runs` are all of the case, with their metrics and curves; `timings` has an entry for each of them, or
/// none at all.
///
/// - The error of a metric is its magnitude. That of a curve is its L2 distance from the mean of the finest
///   runs, relative to it, over 200 abscissae; a run that is part of that mean is compared with the mean of
///   the other families. Its uncertainty is the L2 norm of half the range of the families, of all of them in
///   either case.
/// - A run that did not complete, lacks the metric, or whose curve does not cover the stretch has a failure
///   and no error; if one of the finest does, no run of the problem has an error.
/// - On a front is what has an error, is not of the reference, and is beaten in error or cost by nothing that
///   is at least as good in the other.
std::vector<TradeVerdict> judge_trades(const Case& definition, const std::vector<RunVerdict>& runs,
                                       const Timings& timings);

/// Adds the metrics trade.<number>.error and trade.<number>.bound to the runs that have them; a trade's
/// number is that in the case, from 1.
void keep_trade_metrics(const Case& definition, const std::vector<TradeVerdict>& trades,
                        std::vector<RunVerdict>& runs);

}  // namespace mpm::vv
