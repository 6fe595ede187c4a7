#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "vv/norms.hpp"
#include "vv/verdict.hpp"

namespace mpm::vv {

/// The value a gate compares or, when it is NaN, why there is none.
struct Measured {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string detail = {};
  bool ended_early = false;  ///< there is none because the solver ended the run early and said how
  bool waits = false;        ///< there is none because the measurement it compares with is missing
};

using Judge = std::function<Judgement(const Case&, const RunRequest&, const Record&)>;

/// Judges a case by its records (one per run, in the order of `definition.runs`) and applies every gate.
///
/// - A gate is red when its value cannot be measured; its detail says why.
/// - A must-fail control is red as expected when the value violates its threshold, or could not be measured
///   because the run ended early in an outcome the solver names. A value absent from a completed run, or a
///   run that died of an exception, is a failure of the control.
/// - A gate on a comparison whose measurement is an empty slot waits: it is neither good nor bad.
/// - Gates on advice are left to `judge_advice` of vv/advice.hpp, which needs the other cases' verdicts.
/// - A gate that matches no run, a case without runs and a case without gates are failures.
/// - Every run that no control and no gate on the metric `completed` covers gets the gate `run_completed`.
/// - The metric `bits_differ` counts the repeats of the run that have another digest; absent without a repeat.
///
/// `timings` are for the case's trades, one a run or none; no gate sees them. Throws std::invalid_argument
/// when records or timings are not one per run.
CaseVerdict judge_case(const Case& definition, std::vector<Record> records, const Judge& judge_run = judge,
                       const Timings& timings = {});

/// Whether a gate is on a number of the case as a whole that tells how advice turned out.
bool is_of_advice(const Gate& gate);

/// Adds the result of a gate on the case as a whole to a case that is judged already, and settles anew whether
/// it passes.
void add_result(CaseVerdict& verdict, const Gate& gate, const Measured& measured);

}  // namespace mpm::vv
