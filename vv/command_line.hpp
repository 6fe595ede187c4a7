#pragma once

#include <filesystem>
#include <functional>

#include "vv/verdict.hpp"

namespace mpm::vv {

/// Writes the report of a campaign into a directory that exists.
using WriteReport = std::function<void(const CampaignVerdict&, const std::filesystem::path& directory)>;

/// The program: reads the arguments, runs what they ask for, prints the gates and writes results.json and the
/// report. Shipped cases and the default directory of `report` are found below the environment variable
/// MPMVV_ROOT, without it below the source tree the program was built from.
///
/// Returns the exit code: 0 all gates pass and every control is red, 1 a gate failed, 2 bad input or an error
/// (told in one line per fault on standard error). Throws nothing.
int command_line(int argc, char** argv, const WriteReport& write_report);

}  // namespace mpm::vv
