#pragma once

#include <string>

namespace mpm::vv {

/// What the system calls its processor; without such a name its architecture, else "unknown".
std::string processor_name();

/// Logical cores, at least 1.
int core_count();

}  // namespace mpm::vv
