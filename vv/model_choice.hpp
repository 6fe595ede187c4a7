#pragma once

#include <map>
#include <optional>
#include <string>

namespace mpm::vv {

/// Who decides how much of a written scene is simulated.
enum class Decision {
  automatic,   ///< the program takes the least that is enough
  as_written,  ///< the scene, whatever less would do
};

/// The key `model` of a scene.
struct ModelRequest {
  /// Whether a column of two dimensions is simulated in one. Without a word on it automatic, but as written
  /// in a case that asks for the cost of what is written.
  std::optional<Decision> dimension;
  /// Whether float is taken where pilots show it to be enough.
  Decision precision = Decision::as_written;
};

/// Something that a scene has and that less of may do.
struct ModelChoice {
  std::string what;           ///< "dimension" or "precision"
  std::string written, used;  ///< for a person: "2D", "1D"
  std::string reason;         ///< why that is enough, or why no less is
  std::map<std::string, double> numbers =
      {};  ///< what the choice rests on or what it saves, by name; SI units

  /// Something else is simulated than is written.
  bool picked() const { return used != written; }
};

}  // namespace mpm::vv
