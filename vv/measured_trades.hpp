#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "vv/case_file.hpp"
#include "vv/trade.hpp"

/// What earlier campaigns have measured of error against cost, as results.json keeps it.
namespace mpm::vv {

/// One trade of one problem, and what each of its configurations changes in the scene.
struct MeasuredTrade {
  TradeVerdict verdict;
  /// One a point: {"set": {pointer: value}, "remove": [pointer]}.
  std::vector<Json> changes;
  std::vector<std::string> program_hashes;  ///< one a point: what simulated it
};

/// A case that has trades.
struct MeasuredCase {
  std::string id;
  Json scene;       ///< as written, before anything is swept
  Json definition;  ///< the case's sweep, trades, and what it observes: see `defining_keys`
  std::vector<SweepAxis> sweep;
  std::vector<MeasuredTrade> trades;

  /// Places of the scene that the configurations of a trade change: those of all axes but the problem's.
  std::vector<std::string> configured_places(const MeasuredTrade& trade) const;
  /// The axes of a trade's problem, in the order of the sweep.
  std::vector<SweepAxis> problem_axes(const MeasuredTrade& trade) const;
};

/// The cases with trades of one campaign.
struct MeasuredCampaign {
  std::filesystem::path file;
  std::string revision, date, processor;
  std::vector<MeasuredCase> cases;
};

/// The keys of a case's text, beside its scene, that say what its trades are and what their errors are taken
/// from.
const std::vector<std::string>& defining_keys();

/// Reads results.json of a directory. Throws std::runtime_error, its text for a person, for a file that is
/// not one.
MeasuredCampaign read_measured_campaign(const std::filesystem::path& directory);

}  // namespace mpm::vv
