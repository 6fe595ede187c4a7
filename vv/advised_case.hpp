#pragma once

#include <filesystem>
#include <string>

#include "vv/advice_match.hpp"

/// A case file with the configuration that was advised, and a gate that holds the advice to its promise.
namespace mpm::vv {

/// What was advised.
struct Advised {
  TradePoint point;      ///< its bound is the promise
  Json changes;          ///< of the configuration: {"set": {pointer: value}, "remove": [pointer]}
  std::string measured;  ///< where and when, for a person
};

/// Writes the case with the configuration in its scene, swept over nothing but problems, observed as the
/// measured case is. Its gate `promise` is on the error (with `promise_below` where that may be negative), at
/// 1.05 times the bound (another compiler moves the last digits) or 1.5 times where a problem lies between two
/// that were measured. Where the error is the distance of a curve, the curve that it is measured from is
/// written beside it, as `<stem>_reference.json`.
///
/// The file's name gives the id. Throws std::runtime_error for a name that gives none, for a file that is
/// there already unless `force`, and for a place of the scene that the configuration changes and the case
/// does not have; CaseError if what would be written is no case that can run. Then nothing is written.
void write_advised_case(const Case& asked, const TradeMatch& match, const Advised& advised,
                        const std::filesystem::path& file, bool force);

/// The scene with a configuration in it: its own places as `measured` has them, then what the configuration
/// changes. Throws std::runtime_error for a place that the scene does not have.
Json configured_scene(const Json& scene, const MeasuredCase& measured,
                      const std::vector<std::string>& configured, const Json& changes);

}  // namespace mpm::vv
