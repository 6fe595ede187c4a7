#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "vv/case_file.hpp"
#include "vv/record.hpp"

namespace mpm::vv {

/// One curve exactly as it was judged or as the exact solution gives it; SI units.
struct Curve {
  std::string name;      ///< stress, displacement, stress_error, or a probe's id
  std::string source;    ///< "run", or the reference solution's name
  std::vector<double> x;  ///< initial height X [m], current height x [m] or time [s]: see `x_name`
  std::vector<double> y;
  std::string x_name;  ///< position, initial_position or time
};

enum class GateStatus {
  pass,
  fail,
  red_as_expected,    ///< a must-fail control that did turn red
  unexpectedly_green, ///< a must-fail control that stayed green: counts as a failure
};

/// A gate applied to one run or one series of runs.
struct GateResult {
  std::string id, metric, statistic, basis, reason;
  std::string scope;     ///< the runs it was applied to, for a person: "50G, cpgimp"
  double value = 0.0;    ///< NaN when it could not be measured; then `detail` says why and the gate is red
  std::string op;        ///< "<=" or ">="
  double threshold = 0.0;
  bool must_fail = false;
  GateStatus status = GateStatus::fail;
  std::string detail;
  bool good() const { return status == GateStatus::pass || status == GateStatus::red_as_expected; }
};

struct RunVerdict {
  std::vector<std::pair<std::string, Json>> parameters;
  Record record;
  std::map<std::string, double> metrics;  ///< only finite values; a metric that could not be measured is absent
  std::vector<Curve> curves;              ///< the run's own and the references it was judged against
  std::vector<GateResult> gates;
};

/// A metric over a refinement, with observed orders between neighbours.
struct SeriesVerdict {
  std::string across;   ///< JSON pointer of the refined parameter
  std::vector<std::pair<std::string, Json>> fixed;  ///< the other parameters of the group
  std::vector<double> cell_size;  ///< [m], from coarse to fine, one entry per run
  std::map<std::string, std::vector<double>> metrics;  ///< NaN where a run has none
  std::map<std::string, std::vector<double>> orders;   ///< observed order of each neighbouring pair
  std::vector<GateResult> gates;
};

enum class CaseStatus { pass, fail, not_run };

struct CaseVerdict {
  Case definition;
  CaseStatus status = CaseStatus::not_run;
  std::string not_run_reason;
  std::vector<RunVerdict> runs;
  std::vector<SeriesVerdict> series;
};

struct Counts {
  int cases = 0, cases_passed = 0, cases_failed = 0, cases_not_run = 0;
  int runs = 0;
  int gates = 0, gates_passed = 0, gates_failed = 0;        ///< of the ordinary gates
  int controls = 0, controls_red = 0, controls_green = 0;   ///< of the must-fail controls
};

/// All that the report says: built from records only.
struct CampaignVerdict {
  std::string revision, host, processor, compiler, build, date;
  int threads = 1;
  bool quick = false;
  double wall_seconds = 0.0;
  std::vector<CaseVerdict> cases;
  Counts counts() const;
  bool passed() const;  ///< every gate good, every control red, every case run
};

Json to_json(const CampaignVerdict&);

}  // namespace mpm::vv
