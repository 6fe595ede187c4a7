#pragma once

namespace mpm::vv {

/// Which sources this program was built from, and how.
struct BuildFacts {
  const char* version;   ///< of the project
  const char* revision;  ///< of the source tree at the last build, "-dirty" appended; "unknown" without git
  const char* compiler;  ///< name and version
  const char* build;     ///< build type and compiler flags
  const char* source_directory;  ///< absolute
  const char* simulation;        ///< hash of the compiled libraries that simulate, hexadecimal digits
};

/// Written by the build itself (vv/revision.cmake), anew whenever the revision changes.
const BuildFacts& build_facts();

}  // namespace mpm::vv
