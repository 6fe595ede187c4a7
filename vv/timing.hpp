#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vv/record.hpp"
#include "vv/trade.hpp"

/// How long the steps of a run take, alone on the machine and with one thread. Nothing of it enters a record,
/// a metric or a gate: it is another number every time.
namespace mpm::vv {

/// Some of the first steps of a run, timed.
struct TimedSteps {
  double seconds = 0.0;  ///< wall time of the steps alone, above 0
  std::int64_t steps = 0;
  bool whole = false;  ///< they are all the run has
};

/// How the first steps of a run are timed, until they have taken `seconds` or the run has ended: at least
/// one.
using TimeSteps = std::function<TimedSteps(const RunRequest& request, double seconds)>;

/// Times by stepping a simulation, with one thread.
TimedSteps time_first_steps(const RunRequest& request, double seconds);

/// Who times: figures of another program or machine are no good.
struct Timekeeper {
  std::string program;    ///< `program_hash`
  std::string processor;  ///< name of the processor
  int cores = 1;
  TimeSteps time_steps = time_first_steps;
};

/// The runs of one case, timed in rounds: in each, every run once, one after another in an order of its own,
/// so that nothing that comes and goes on the machine falls on the same runs. A repeat does the first steps
/// of a run until a time has passed, or the whole run if that is shorter. What finished rounds measured is
/// stored at once, and taken over as long as program, machine and inputs of all runs are the same.
class CaseTiming {
 public:
  static constexpr std::size_t rounds = 5;

  /// Wall time that a repeat of a case with so many runs goes on for [s]: 0.15 s, and less where the whole
  /// case would take above a minute.
  static double seconds_of_repeat(std::size_t runs);

  /// The order of a round: a permutation of the numbers below `runs`, the same for ever.
  static std::vector<std::size_t> order_of_round(std::size_t round, std::size_t runs);

  /// Reads from `file` what has been measured already. `records` are those of the case's runs, in their
  /// order; one that did not complete is not timed. All arguments outlive the timing.
  CaseTiming(const Case& definition, const std::vector<Record>& records, std::filesystem::path file,
             const Timekeeper& timekeeper);

  std::size_t repeats_left() const { return (rounds - done_.size()) * timed_.size(); }

  /// Does the rounds that are left. `after_repeat` is called after each repeat; false from it ends the
  /// timing, with what finished rounds measured. False then. Throws std::system_error when a round cannot be
  /// stored.
  bool run(const std::function<bool()>& after_repeat);

  /// One entry a run of the case, empty for what was not timed; all are empty until every round is done.
  Timings timings() const;

 private:
  using Round = std::vector<TimedSteps>;  ///< in the order of `timed_`

  Json key() const;
  void read();
  void store() const;
  Timing timing_of(std::size_t place) const;

  const Case& definition_;
  const std::vector<Record>& records_;
  std::filesystem::path file_;
  const Timekeeper& timekeeper_;
  std::vector<std::size_t> timed_;  ///< indices of runs
  std::vector<Round> done_;
};

/// Where the timings of a case are stored.
std::filesystem::path timing_file(const std::filesystem::path& out, const Case& definition);

}  // namespace mpm::vv
