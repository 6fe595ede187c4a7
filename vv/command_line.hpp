#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "vv/verdict.hpp"

namespace mpm::vv {

/// Where the report finds measurements of speed.
struct PerformanceFiles {
  std::filesystem::path file;     ///< empty without one
  std::filesystem::path history;  ///< directory of earlier ones; empty without one
  std::string failure;            ///< why measuring failed; empty if it was not tried or went well
};

/// What measured, and where.
struct MeasuredBy {
  std::string revision;  ///< of the source, "-dirty" appended if it was modified
  std::string processor;
  int cores = 0;
};

/// Whether measurements of `then` need not be repeated by `now`: processor, cores and revision are the same, and
/// the revision tells all of the source, neither unknown nor modified.
bool still_holds(const MeasuredBy& then, const MeasuredBy& now);

/// What the program needs of the reports.
struct ReportWriter {
  /// Reads the measurements that the report is to show, before anything runs; gives who made the latest,
  /// nothing without any. Throws for a bad file.
  std::function<std::optional<MeasuredBy>(const PerformanceFiles&)> read_performance;
  /// Writes the report of a campaign into a directory that exists.
  std::function<void(const CampaignVerdict&, const std::filesystem::path& directory)> write;
};

/// The program: reads the arguments, runs what they ask for, prints the gates and writes results.json and the
/// report. Shipped cases and the default directory of `report` are found below the environment variable
/// MPMVV_ROOT, without it below the source tree the program was built from.
///
/// Returns the exit code: 0 all gates pass and every control is red, 1 a gate failed, 2 bad input or an error
/// (told in one line per fault on standard error). Throws nothing.
int command_line(int argc, char** argv, const ReportWriter& reports);

}  // namespace mpm::vv
