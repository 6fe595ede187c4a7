#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace CLI {
class App;
}

namespace mpm::vv {

/// `mpmvv advise`: which of the measured configurations a scene needs for an error, or within a time.
class AdviseCommand {
 public:
  /// Adds the command to the program, which must outlive it.
  explicit AdviseCommand(CLI::App& program);
  ~AdviseCommand();
  AdviseCommand(const AdviseCommand&) = delete;
  AdviseCommand& operator=(const AdviseCommand&) = delete;

  bool parsed() const;  ///< it is the one that was asked for
  /// Tells on standard output what was measured for the case's scene and which configuration to take, and
  /// writes it into a case file if that is asked for. `file_of` finds a case by its file or id. False if
  /// nothing that was measured tells of the scene or meets what is asked. Throws std::exception, its text for
  /// a person, for options, cases or results that are no good.
  bool run(const std::function<std::filesystem::path(const std::string&)>& file_of) const;

 private:
  struct Options;
  std::unique_ptr<Options> options_;
  CLI::App* command_;
};

}  // namespace mpm::vv
