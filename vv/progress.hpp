#pragma once

#include <chrono>
#include <string>

namespace mpm::vv {

/// Tells on standard error how far work is: a bar on a terminal, elsewhere a plain line now and then, of
/// which short work gets none. The bar goes with the object.
class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Since the beginning [s].
  double elapsed() const;

  /// `fraction` of the work is done, from 0 to 1; `state` is for a person. How much time is left is added
  /// once it can be told.
  void draw(double fraction, const std::string& state);

 private:
  static constexpr double seconds_between_lines = 30.0;

  bool on_terminal_;
  double next_line_ = seconds_between_lines;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace mpm::vv
