#pragma once

#include <string>
#include <utility>
#include <vector>

#include "vv/norms.hpp"
#include "vv/verdict.hpp"

/// Advice on one problem from trades that were measured of others, and how it turns out.
namespace mpm::vv {

/// Several problems as one: of each configuration that all of them have, the larger bound and the higher
/// prices. Without an error where one has none, untimed where one is, of the reference where one is. Axes of
/// the problem in which they differ are left out. At least one problem, all of one trade.
TradeVerdict worst_of(const std::vector<const TradeVerdict*>& problems);

/// Measured problems that a problem lies among.
struct NearProblems {
  enum class Kind {
    same,     ///< it is one of them
    between,  ///< in a number between neighbours: these
    unlike,   ///< in what has no order: all of them that are alike in the rest
    outside,  ///< no measurement says anything of it
  };
  Kind kind = Kind::outside;
  std::vector<const TradeVerdict*> problems;  ///< none outside
};

/// The nearest of the measured problems, axis by axis: those of an equal value, else the neighbours of a
/// number that lies between two, else, where values are no numbers, those of any value. An axis that the
/// measured problems do not have says nothing; one that the problem does not have leaves it outside.
/// Neighbours have to be measured in every combination of several such axes.
NearProblems problems_near(const std::vector<const TradeVerdict*>& measured,
                           const std::vector<std::pair<std::string, Json>>& problem);

/// "1G", "1G and 50G"; "the measured one" of a trade with one problem only.
std::string names_of_problems(const std::vector<const TradeVerdict*>& problems);

/// Numbers of a case as a whole that tell how advice turned out; gates may be on them.
const std::vector<Metric>& advice_catalogue();

/// Puts advice to the test in every case that asks for it: draws it from the trades of the case it names, by
/// counted bytes so that it is the same everywhere, looks up what this case's runs found, and applies the
/// case's gates on `advice_catalogue()`. To be called once, when all cases are judged.
void judge_advice(std::vector<CaseVerdict>& verdicts);

}  // namespace mpm::vv
