#pragma once

#include <filesystem>
#include <string>

namespace mpm::vv {

/// What the system calls its processor; without such a name its architecture, else "unknown".
std::string processor_name();

/// Logical cores, at least 1.
int core_count();

/// The project that the shipped cases and curves belong to: MPMVV_ROOT of the environment, else where the program was
/// built from.
std::filesystem::path project_root();

}  // namespace mpm::vv
