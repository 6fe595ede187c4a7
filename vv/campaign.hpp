#pragma once

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "vv/record.hpp"
#include "vv/timing.hpp"
#include "vv/verdict.hpp"

namespace mpm::vv {

struct CampaignOptions {
  std::filesystem::path out;  ///< exists and can be written; records go below out/records
  int threads = 1;            ///< runs at a time, >= 1; decides nothing but the time it takes
  bool quick = false;         ///< leave out the cases that are not quick; they stay in the verdict as not run
};

/// How a run becomes a record; `simulate` outside tests.
using Execute = std::function<Record(const Case&, const RunRequest&, const Pulse&)>;

/// SIGINT or SIGTERM stopped a campaign before its last run. What had finished is stored.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Runs every run of every case and judges them.
///
/// Each finished record is stored at once and used again by a later campaign with the same inputs and the
/// same `program_hash`; a record file that cannot be read, or whose text was altered, is ignored and the run
/// redone. A run that throws becomes a failed run, with the reason, and is not stored. Runs of cases with
/// `repeat_on_other_threads` are executed again in a pool of another size (two threads instead of one, else
/// one), and those with `repeat_on_threads` once more for each number there, one run at a time with so many threads
/// for its steps.
///
/// Once every run is recorded, those of cases with trades are timed, see `CaseTiming`, below out/timings.
///
/// Throws Interrupted; std::invalid_argument for fewer than one thread or two cases of one id;
/// std::system_error when a record or a timing cannot be stored.
CampaignVerdict run_campaign(const std::vector<Case>& cases, const CampaignOptions& options,
                             const Execute& execute = simulate,
                             const TimeSteps& time_steps = time_first_steps);

/// Where the record of one run is stored. The name tells the swept values and is unique within the case. A repeat has
/// one of its own; with a number of step threads, if it was asked for on that many.
std::filesystem::path record_file(const std::filesystem::path& out, const Case& definition, std::size_t run,
                                  bool repeat = false, int step_threads = 0);

/// A rough particle-steps count before the run, for ordering and progress: never below 1.
double estimated_particle_steps(const Scene& scene);

}  // namespace mpm::vv
