#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vv/case_file.hpp"
#include "vv/grid_convergence.hpp"
#include "vv/measurement.hpp"
#include "vv/record.hpp"
#include "vv/rounding.hpp"
#include "vv/trade.hpp"

namespace mpm::vv {

/// One curve exactly as it was judged or as the exact solution gives it; SI units.
struct Curve {
  std::string name;       ///< stress, displacement, stress_error, pressure, free_surface, failure_line, a cut's or a probe's id
  std::string source;     ///< "run", or the reference solution's name
  std::vector<double> x;  ///< initial height X [m], current height x [m], settlement [m] or time [s]: see `x_name`
  std::vector<double> y;
  std::string x_name;  ///< position, initial_position, settlement, strain or time
  /// Standard uncertainty of each ordinate by the way it was read off the particles; empty if there is none.
  std::vector<double> uncertainty = {};
};

enum class GateStatus {
  pass,
  fail,
  red_as_expected,     ///< a must-fail control that did turn red
  unexpectedly_green,  ///< a must-fail control that stayed green: counts as a failure
  no_measurement,      ///< what it compares with is an empty slot: neither passed nor failed
};

/// A gate applied to one run or one series of runs.
struct GateResult {
  std::string id, metric, statistic, basis, reason;  ///< the metric of curve_spread is the curve
  std::string scope;   ///< the runs it was applied to, for a person: "50G, cpgimp"
  double value = 0.0;  ///< NaN when it could not be measured; then `detail` says why and the gate is red
  std::string op;      ///< "<=" or ">="; "is" of a gate on the class of a run, whose value is the class's place in the list
  double threshold = 0.0;
  bool must_fail = false;
  GateStatus status = GateStatus::fail;
  std::string detail;
  std::string found = {}, expected = {};  ///< of "is": the class, and those that pass, by name
  std::string advice = {};                ///< of "is": what to do in such a scene, for a person; may be empty
  /// Nothing is wrong: what could be judged was as it should be.
  bool good() const {
    return status == GateStatus::pass || status == GateStatus::red_as_expected || waits();
  }
  /// The measurement it needs is not there.
  bool waits() const { return status == GateStatus::no_measurement; }
};

struct RunVerdict {
  std::vector<std::pair<std::string, Json>> parameters;
  Record record;
  std::map<std::string, double>
      metrics;                ///< only finite values; a metric that could not be measured is absent
  std::vector<Curve> curves;  ///< the run's own and the references it was judged against
  std::vector<CurveComparison> comparisons;  ///< with measured curves, in the order of the case's measurements
  std::vector<GateResult> gates;
  std::optional<StabilityClass> stability;  ///< of a case that classifies its runs
  Behaviour behaviour;                      ///< what it was told by
};

/// A metric over a refinement, with observed orders between neighbours.
struct SeriesVerdict {
  std::string across;                                  ///< the swept parameter
  std::vector<std::pair<std::string, Json>> fixed;     ///< the other parameters of the group
  std::vector<Json> values;                            ///< of that parameter, one entry per run
  std::vector<double> cell_size;                       ///< [m], from coarse to fine, one entry per run
  std::map<std::string, std::vector<double>> metrics;  ///< NaN where a run has none
  std::map<std::string, std::vector<double>> orders;   ///< observed order of each neighbouring pair
  std::map<std::string, GridConvergence> convergence;  ///< of readings and load curves; three levels or more
  std::vector<GateResult> gates;
};

enum class CaseStatus { pass, fail, not_run };

/// The names used in results and messages, for example "red_as_expected".
const char* name_of(GateStatus status);
const char* name_of(CaseStatus status);

/// Swept values for a person: "50G, cpgimp, h 0.02 m", variants by their names; "the run" when nothing is swept.
std::string scope_of(const std::vector<std::pair<std::string, Json>>& parameters);

/// Room between value and threshold relative to the threshold [-], positive on the side where the comparison
/// holds; NaN without a value or with a threshold of zero.
double margin(const GateResult& result);

/// Single measurements and what was predicted for them.
struct PairsVerdict {
  std::string id, title;
  std::string dimension;    ///< of measured and predicted, which are in its SI unit: "pressure", "ratio", ...
  std::vector<Pair> pairs;  ///< those that could be predicted
  std::vector<std::string> unpredicted;  ///< names of the runs that have no number, with the reason
  std::string lack;                      ///< why there is no factor; empty beside one
  bool missing = false;                  ///< the curve file is an empty slot
  ModelFactor factor;
};

/// One question put to the advice from another case, and what a run of this case says to the answer.
struct AdviceTrial {
  std::string title;                                      ///< of the trade of this case
  std::vector<std::pair<std::string, Json>> problem;      ///< of this case
  double asked = 0.0;                                     ///< error [-]
  std::string drawn_from = {};                            ///< measured problems, for a person: "1G and 50G"
  bool between = false;                                   ///< those that this one lies between
  std::vector<std::pair<std::string, Json>> configuration = {};  ///< advised; empty without advice
  double promised = std::numeric_limits<double>::quiet_NaN();    ///< bound of the error [-]
  double found = std::numeric_limits<double>::quiet_NaN();  ///< bound of the error that the run here has [-]
  /// Bytes of that run over those of the cheapest that meets the error [-].
  double regret = std::numeric_limits<double>::quiet_NaN();
  bool kept = false;      ///< found is at most what was asked
  bool no_offer = false;  ///< the advice was that nothing measured meets the error: no promise to keep
  std::string lack = {};  ///< why there is no advice or nothing was found, for a person; empty beside a number found
};

/// How advice from another case turned out.
struct AdviceVerdict {
  std::string of;         ///< id of the case it was drawn from
  bool own = false;       ///< that is this case: the advice was drawn from every second configuration
  std::string lack = {};  ///< why nothing was put to the test; empty beside trials
  std::vector<AdviceTrial> trials = {};
  std::map<std::string, double> metrics = {};  ///< of `advice_catalogue()`; finite ones only
};

struct CaseVerdict {
  Case definition;
  CaseStatus status = CaseStatus::not_run;
  std::string not_run_reason;
  std::vector<RunVerdict> runs;
  std::vector<SeriesVerdict> series;
  std::vector<PairsVerdict> pairs;  ///< in the order of the case's
  std::vector<TradeVerdict> trades;  ///< in the order of the case's, one a problem
  std::vector<RoundingRow> rounding;  ///< of a case that asks for it
  std::optional<AdviceVerdict> advice;  ///< of a case that puts advice to the test
  /// On pairs and on advice, and those that found nothing to judge: every one of these a failure.
  std::vector<GateResult> gates;
};

/// Every gate result of a case: of its runs, its series and the case as a whole.
std::vector<const GateResult*> gate_results(const CaseVerdict& verdict);

struct Counts {
  int cases = 0, cases_passed = 0, cases_failed = 0, cases_not_run = 0;
  int runs = 0;
  int gates = 0, gates_passed = 0, gates_failed = 0;  ///< of the ordinary gates
  int gates_waiting = 0;  ///< ordinary gates whose measurement is missing, neither passed nor failed
  int controls = 0, controls_red = 0,
      controls_green = 0;  ///< of the must-fail controls; green: not red as expected
};

/// All that the report says: built from records only.
struct CampaignVerdict {
  std::string revision, host, processor, compiler, build, date;
  int threads = 1;
  bool quick = false;
  int reused = 0;  ///< runs whose stored record was still valid, repeats included
  double wall_seconds = 0.0;
  double timing_seconds = 0.0;  ///< of these, for timing the runs of trades; 0 if all of it was done before
  std::vector<CaseVerdict> cases;
  Counts counts() const;
  bool passed() const;  ///< every gate good, every control red, every case run
  bool failed() const;  ///< some case failed, or none was judged; a case left out on request is no failure
};

/// The content of results.json. A number that could not be measured is null, beside a detail saying why.
Json to_json(const CampaignVerdict& verdict);

}  // namespace mpm::vv
