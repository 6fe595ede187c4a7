#pragma once

#include <functional>
#include <vector>

#include "vv/norms.hpp"
#include "vv/verdict.hpp"

namespace mpm::vv {

using Judge = std::function<Judgement(const Case&, const RunRequest&, const Record&)>;

/// Judges a case by its records (one per run, in the order of `definition.runs`) and applies every gate.
///
/// - A gate is red when its value cannot be measured; its detail says why.
/// - A must-fail control is red as expected when the value violates its threshold, or could not be measured
///   because the run ended early in an outcome the solver names. A value absent from a completed run, or a
///   run that died of an exception, is a failure of the control.
/// - A gate on a comparison whose measurement is an empty slot waits: it is neither good nor bad.
/// - A gate that matches no run, a case without runs and a case without gates are failures.
/// - Every run that no control and no gate on the metric `completed` covers gets the gate `run_completed`.
/// - The metric `bits_differ` is 0 when the repeat of the run has the same digest, 1 when it has not, absent
///   without a repeat.
///
/// `timings` are for the case's trades, one a run or none; no gate sees them. Throws std::invalid_argument when records or
/// timings are not one per run.
CaseVerdict judge_case(const Case& definition, std::vector<Record> records, const Judge& judge_run = judge,
                       const Timings& timings = {});

}  // namespace mpm::vv
