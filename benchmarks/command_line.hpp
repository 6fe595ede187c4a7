#pragma once

namespace mpm::bench {

/// The program: measures, prints, writes, compares. Returns the exit code: 0, 1 if something became slower
/// beyond noise, 2 for bad input or an error.
int command_line(int argc, char** argv);

}  // namespace mpm::bench
