#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "vv/verdict.hpp"

namespace CLI {
class App;
}

namespace mpm::vv {

/// The case whose runs are surveys of the time steps of the scenes of `asked`. It is without all that asks
/// for something of a single run, and judges nothing but that the surveys were finished. Axes of the sweep
/// stay in their order for as long as there are at most `most_runs` surveys; the scene is as written in what
/// the others change, and its notes say so. Throws std::invalid_argument for a case without a scene,
/// CaseError for a survey that is no good.
Case survey_case(const Case& asked, const Json& survey, std::size_t most_runs);

/// What to set the time step of a surveyed scene to, and why, in one sentence for a person.
std::string advice_of(const RunVerdict& run);

/// `mpmvv stability`: how large a time step the scenes of a case bear.
class StabilityCommand {
 public:
  /// Adds the command to the program, which must outlive it.
  explicit StabilityCommand(CLI::App& program);
  ~StabilityCommand();
  StabilityCommand(const StabilityCommand&) = delete;
  StabilityCommand& operator=(const StabilityCommand&) = delete;

  bool parsed() const;      ///< it is the one that was asked for
  std::string out() const;  ///< directory for records, results and report
  int threads() const;      ///< surveys at a time
  /// The case to run; `file_of` finds a case by its file or id. Throws std::exception, its text for a person.
  Case surveys(const std::function<std::filesystem::path(const std::string&)>& file_of) const;
  /// Tells on standard output what was found of each scene, and what to do.
  static void tell(const CampaignVerdict& verdict);

 private:
  struct Options;
  std::unique_ptr<Options> options_;
  CLI::App* command_;
};

}  // namespace mpm::vv
