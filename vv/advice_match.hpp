#pragma once

#include <string>
#include <utility>
#include <vector>

#include "vv/advice.hpp"
#include "vv/measured_trades.hpp"

/// Which measured trade tells of the scene of a case.
namespace mpm::vv {

/// Stands for a pointer where the problem that is named is none of the case's.
inline constexpr const char* problem_option = "--problem";

/// A place at which a case is not what was measured, for a person.
struct Difference {
  std::string pointer, here, there;

  friend bool operator==(const Difference&, const Difference&) = default;
};

/// A problem of the case that advice is asked for, and the measured ones it lies among.
struct AskedProblem {
  Json scene;                                         ///< of the case, the problem's own values put in
  std::vector<std::pair<std::string, Json>> problem;  ///< along the axes of the measured trade's problem
  NearProblems near;
  std::vector<Difference> differences = {};  ///< why no measured problem tells of it; none if one does
};

/// A case beside one trade of a measured one.
struct TradeMatch {
  const MeasuredCase* measured = nullptr;
  std::string title = {};
  std::vector<std::string> configured = {};  ///< places of the scene that the trade's configurations decide
  std::vector<std::string> swept = {};       ///< axes of the case whose values are problems of the trade
  std::vector<AskedProblem> problems = {};   ///< at least one
  std::vector<Difference> differences = {};  ///< each once; none if the trade tells of the case

  bool alike() const { return differences.empty(); }
  bool between() const;  ///< a problem of the case lies between measured ones
  /// The measured problems that count, each once.
  std::vector<const TradeVerdict*> near() const;
};

/// Compares the scene of a case, value by value in SI units, with that of a measured one. The configurations'
/// places do not count. The problem has to be a measured one or, in one number, lie between two. A case that
/// is swept over an axis of the problem asks for all of its values, or for the one that `problem` names
/// ("50G").
///
/// There is a trade of that title.
TradeMatch match_trade(const Case& asked, const MeasuredCase& measured, const std::string& title,
                       const std::string& problem);

}  // namespace mpm::vv
