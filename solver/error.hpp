#pragma once

#include <stdexcept>
#include <string>

namespace mpm {

/// A scene that cannot be simulated as described: thrown before the first step, never during it.
///
/// `place` is the JSON pointer of the offending value relative to the scene, for example
/// "/bodies/0/material/youngs_modulus"; `expected` and `found` are short phrases for a person.
class SceneError : public std::runtime_error {
 public:
  SceneError(std::string place, std::string expected, std::string found)
      : std::runtime_error(place + ": expected " + expected + ", found " + found),
        place_(std::move(place)),
        expected_(std::move(expected)),
        found_(std::move(found)) {}

  const std::string& place() const noexcept { return place_; }
  const std::string& expected() const noexcept { return expected_; }
  const std::string& found() const noexcept { return found_; }

 private:
  std::string place_, expected_, found_;
};

}  // namespace mpm
