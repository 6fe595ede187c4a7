#pragma once

#include <memory>

namespace CLI {
class App;
}

namespace mpm::vv {

/// `mpmvv digitise`: reads curves off a picture of a figure into curve files, and fills the empty ones.
class DigitiseCommand {
 public:
  /// Adds the command to the program, which must outlive it.
  explicit DigitiseCommand(CLI::App& program);
  ~DigitiseCommand();
  DigitiseCommand(const DigitiseCommand&) = delete;
  DigitiseCommand& operator=(const DigitiseCommand&) = delete;

  bool parsed() const;  ///< it is the one that was asked for
  /// Writes a curve file for each series, or nothing at all; tells on standard output what. Throws
  /// std::exception, its text for a person, when the options, the picture or the files that are there already
  /// do not permit it.
  void run() const;

 private:
  struct Options;
  std::unique_ptr<Options> options_;
  CLI::App* command_;
};

}  // namespace mpm::vv
