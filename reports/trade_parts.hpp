#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vv/verdict.hpp"

/// Words, prices and comparisons that everything said of speed against accuracy is put together from.
namespace mpm::reports {

/// What a configuration is paid for in.
enum class Price { seconds, bytes, operations, particle_steps };

/// In SI units; nothing if it was not measured or counted.
std::optional<double> price_of(const vv::TradePoint& point, Price price);

/// Seconds if anything was timed, and what was counted: bytes, without any operations, without any
/// particle-steps. At least one.
std::vector<Price> prices_of(const vv::TradeVerdict& trade);

/// Whether no configuration is both better and cheaper at this price. The finest runs of a reference lie on
/// no front.
bool on_front(const vv::TradePoint& point, Price price);

/// What a price is, for an axis or the head of a column: "time of a run", "data moved".
std::string name_of_price(Price price);

/// In markup: "3.2 ms", "0.41 s", "12.3 s", "4.5 min", "1.3 h".
std::string duration_markup(double seconds);
/// In markup, as much as `price` needs of a unit: "12.3 s", "4.5 GB", "1.2×10<sup>9</sup> operations".
std::string price_markup(double value, Price price);
/// "1.2 %"; "–" of what is not finite.
std::string percent_markup(double ratio);
/// "1.2 % ± 0.1 %", of an exact reference "1.2 %".
std::string error_markup(const vv::TradePoint& point);
/// The median and, in brackets and the same unit, the range: "0.41 s [0.40 … 0.45]"; "–" if it was not timed.
std::string timing_markup(const vv::TradePoint& point);
/// "1.32 ×".
std::string ratio_markup(double ratio);

/// The parameters in which the configurations of a trade differ, in markup; "the run" if there are none.
std::string name_of_configuration(const vv::TradeVerdict& trade, const vv::TradePoint& point);
/// "50G"; empty if there is one problem only.
std::string name_of_problem(const vv::TradeVerdict& trade);
/// What errors are of, in markup: the metric's or the curve's name.
std::string name_of_trade_error(const vv::TradeVerdict& trade, const vv::Case& definition);

/// The trades a figure shows: those of its title, or all.
std::vector<const vv::TradeVerdict*> trades_of(const vv::CaseVerdict& verdict,
                                               const vv::FigureRequest& request);

/// A factor over several pairs of configurations; NaN and zero without any.
struct Factor {
  double median, low, high;
  std::size_t pairs = 0;
};

/// What comes of taking one value of an axis instead of another and leaving all else as it is.
struct ChoiceEffect {
  std::string axis;
  vv::Json taken, instead_of;
  Factor error, seconds, bytes;  ///< of the value taken over that of the other
  std::size_t pairs = 0;         ///< in which neither failed
  std::size_t only_taken_failed = 0, only_other_failed = 0;
};

/// Over all pairs of configurations of one problem that differ in one axis only, the problems taken together.
/// Numbers and quantities are compared with the value before, names with the first; both as they first come
/// among the points. Runs of a reference are left out. Errors that both lie within the uncertainty of the
/// reference have no factor; nor has an error of zero.
std::vector<ChoiceEffect> effects_of(const std::vector<const vv::TradeVerdict*>& problems);

/// Float against double in configurations that are otherwise one.
struct Rounding {
  /// Share of the error of double that rounding may have and still not matter [-].
  static constexpr double negligible = 0.1;

  std::size_t pairs = 0;   ///< in which double has an error
  std::size_t enough = 0;  ///< of these, where float changes the error by at most `negligible` of it
  std::size_t failed = 0;  ///< of these, where float failed
  double worst = 0.0;      ///< largest |error of float − error of double| / error of double [-]
};

/// Of the pairs among the points whose runs, as the case describes them, differ in their precision alone: by an axis of
/// it, or by a variant that sets it. Nothing without such a pair.
std::optional<Rounding> rounding_of(const vv::TradeVerdict& trade, const vv::Case& definition);

}  // namespace mpm::reports
