#include "vv/machine.hpp"

#include <sys/utsname.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "vv/revision.hpp"

namespace mpm::vv {

std::string processor_name() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  utsname system{};
  return ::uname(&system) == 0 ? system.machine : "unknown";
}

int core_count() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

std::filesystem::path project_root() {
  const char* root = std::getenv("MPMVV_ROOT");
  return root && *root ? std::filesystem::path(root) : std::filesystem::path(build_facts().source_directory);
}

}  // namespace mpm::vv
