#pragma once

#include <vector>

#include "vv/case_file.hpp"
#include "vv/json_reader.hpp"

/// What a case records while its runs go on.
namespace mpm::vv {

/// The probes of a case, none if `place` is absent. Throws Refusal for one that a run cannot serve or that
/// would not mean the same in every run.
std::vector<HistoryProbe> read_probes(const JsonPlace& place, const std::vector<RunRequest>& runs);

/// The snapshots of a case, none if `place` is absent. Throws Refusal for a moment that comes twice, that a
/// run does not last to, or that is up to a probe there is not.
std::vector<SnapshotRequest> read_snapshots(const JsonPlace& place, const std::vector<RunRequest>& runs,
                                            const std::vector<HistoryProbe>& probes);

}  // namespace mpm::vv
