#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "vv/case_file.hpp"
#include "vv/scene_reader.hpp"

/// From the sweep of a case to its runs, and what the rest of the case says of them.
namespace mpm::vv {

/// The axes of a sweep, none if `place` is absent. Throws Refusal for a parameter that the subject does not
/// have or that is changed twice, for values that do not go together, and for more runs than can be meant.
std::vector<SweepAxis> read_sweep(const JsonPlace& place, const Subject& subject);

/// One run for every combination of swept values, the last axis varying fastest, but for those that an entry
/// of `without` selects, which may be absent. Throws Refusal for the first that cannot start: at the swept
/// value, or below it, that is to blame; and for an entry that takes nothing away, or the last run there is. With
/// `refusals` a run that cannot start stays, has the message, and the scene as written in place of its own.
std::vector<RunRequest> expand(const Subject& subject, const std::vector<SweepAxis>& sweep,
                               const JsonPlace& without, bool refusals = false);

/// The subject with one value of an axis in it, as if there were no other axis; `chosen` counts its values.
Subject with_value(const SweepAxis& axis, std::size_t chosen, const Subject& subject);

/// The axis whose parameter is named at `place`.
const SweepAxis& read_axis(const JsonPlace& place, const std::vector<SweepAxis>& sweep);

/// Swept parameters, each with some of its values; none if `place` is absent.
std::vector<Selector> read_where(const JsonPlace& place, const std::vector<SweepAxis>& sweep);

/// The values an axis takes among the runs that `where` selects, in the order of the sweep.
std::vector<Json> selected_values(const SweepAxis& axis, const std::vector<Selector>& where);

/// Whether the cell size of the scene falls from each of these values of the axis to the next.
bool refines(const SweepAxis& axis, const std::vector<Json>& values, const Subject& scene);

/// The swept values of a run, for messages; empty for the only run of a case without a sweep.
std::string name_of(const RunRequest& run);

/// ` in the run with ...`, or nothing for the only run.
std::string in_run(const RunRequest& run);

}  // namespace mpm::vv
