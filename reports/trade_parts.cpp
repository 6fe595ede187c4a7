#include "reports/trade_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "reports/figure_parts.hpp"
#include "reports/figures.hpp"
#include "vv/advice_choice.hpp"

namespace mpm::reports {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
const char* precision_axis = "/scene/precision";

bool counted(const vv::TradeVerdict& trade, Price price) {
  return std::any_of(trade.points.begin(), trade.points.end(),
                     [price](const vv::TradePoint& point) { return price_of(point, price).has_value(); });
}

/// A unit with the prefix that leaves at most three digits before the point; powers of a thousand.
std::string prefixed(double value, const char* unit) {
  static constexpr const char* prefixes[] = {"", "k", "M", "G", "T", "P"};
  std::size_t power = 0;
  while (std::abs(value) >= 999.5 && power + 1 < std::size(prefixes)) {
    value /= 1000.0;
    ++power;
  }
  return fmt::format("{}\u00a0{}{}", number_markup(value), prefixes[power], unit);
}

/// What a duration is written in, and its symbol.
std::pair<double, const char*> time_unit(double seconds) {
  if (seconds < 0.0995) return {1e-3, "ms"};
  if (seconds < 120.0) return {1.0, "s"};
  return seconds < 7200.0 ? std::pair{60.0, "min"} : std::pair{3600.0, "h"};
}

/// Whether the points of a trade have more than one value of this parameter.
bool varies(const vv::TradeVerdict& trade, const std::string& parameter) {
  const vv::Json* first = nullptr;
  for (const vv::TradePoint& point : trade.points) {
    const vv::Json* value = value_of(point.configuration, parameter);
    if (!value) continue;
    if (first && *first != *value) return true;
    first = value;
  }
  return false;
}

// ---- pairs
// ------------------------------------------------------------------------------------------------------

Factor factor_of(std::vector<double> ratios) {
  if (ratios.empty()) return {nan_value, nan_value, nan_value, 0};
  std::sort(ratios.begin(), ratios.end());
  const std::size_t n = ratios.size();
  // Of an even number the geometric middle: it turns over when the two values change places.
  const double median = n % 2 == 1 ? ratios[n / 2] : std::sqrt(ratios[n / 2 - 1] * ratios[n / 2]);
  return {median, ratios.front(), ratios.back(), n};
}

/// "5 mm" and 0.5 are quantities, "musl" and "2 particles" of a list are not.
bool is_quantity(const vv::Json& value) {
  if (value.is_number()) return true;
  if (!value.is_string()) return false;
  const std::string text = value.get<std::string>();
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return end != text.c_str() && (*end == '\0' || *end == ' ' || *end == '%');
}

/// Of a parameter, in the order of the points.
std::vector<vv::Json> values_of(const std::vector<const vv::TradeVerdict*>& problems,
                                const std::string& parameter) {
  std::vector<vv::Json> values;
  for (const vv::TradeVerdict* trade : problems)
    for (const vv::TradePoint& point : trade->points) {
      const vv::Json* value = value_of(point.configuration, parameter);
      if (value && std::find(values.begin(), values.end(), *value) == values.end()) values.push_back(*value);
    }
  return values;
}

std::vector<std::string> parameters_of(const std::vector<const vv::TradeVerdict*>& problems) {
  std::vector<std::string> names;
  for (const vv::TradeVerdict* trade : problems)
    for (const vv::TradePoint& point : trade->points)
      for (const auto& [name, value] : point.configuration)
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

/// The configuration that has `value` in place of the point's own and is otherwise the same.
const vv::TradePoint* partner_of(const vv::TradeVerdict& trade, const vv::TradePoint& point,
                                 const std::string& parameter, const vv::Json& value) {
  auto wanted = point.configuration;
  for (auto& [name, own] : wanted)
    if (name == parameter) own = value;
  for (const vv::TradePoint& other : trade.points)
    if (&other != &point && other.configuration == wanted) return &other;
  return nullptr;
}

bool failed(const vv::TradePoint& point) { return !point.failure.empty() || !std::isfinite(point.error); }

struct Ratios {
  std::vector<double> error, seconds, bytes;
};

void add_ratio(std::vector<double>& ratios, std::optional<double> taken, std::optional<double> other) {
  if (taken && other && *taken > 0.0 && *other > 0.0) ratios.push_back(*taken / *other);
}

bool told_apart(const vv::TradePoint& a, const vv::TradePoint& b) {
  return a.error > a.uncertainty || b.error > b.uncertainty;
}

void add_pair(const vv::TradePoint& taken, const vv::TradePoint& other, ChoiceEffect& effect,
              Ratios& ratios) {
  if (failed(taken) || failed(other)) {
    effect.only_taken_failed += failed(taken) && !failed(other);
    effect.only_other_failed += failed(other) && !failed(taken);
    return;
  }
  ++effect.pairs;
  if (told_apart(taken, other)) add_ratio(ratios.error, taken.error, other.error);
  add_ratio(ratios.seconds, price_of(taken, Price::seconds), price_of(other, Price::seconds));
  add_ratio(ratios.bytes, price_of(taken, Price::bytes), price_of(other, Price::bytes));
}

ChoiceEffect effect_of(const std::vector<const vv::TradeVerdict*>& problems, const std::string& axis,
                       const vv::Json& value, const vv::Json& before) {
  ChoiceEffect effect{axis, value, before, {}, {}, {}};
  Ratios ratios;
  for (const vv::TradeVerdict* trade : problems)
    for (const vv::TradePoint& point : trade->points) {
      const vv::Json* own = value_of(point.configuration, axis);
      if (point.of_reference || !own || *own != value) continue;
      const vv::TradePoint* other = partner_of(*trade, point, axis, before);
      if (other && !other->of_reference) add_pair(point, *other, effect, ratios);
    }
  effect.error = factor_of(ratios.error);
  effect.seconds = factor_of(ratios.seconds);
  effect.bytes = factor_of(ratios.bytes);
  return effect;
}

bool is_in_float(const vv::TradePoint& point, const vv::Case& definition) {
  return definition.runs.at(point.run).scene.precision == Precision::float32;
}

/// What the sweep changes in a point's run, but for the precision.
std::vector<vv::Json> changes_without_precision(const vv::TradePoint& point, const vv::Case& definition) {
  std::vector<vv::Json> changes = definition.runs.at(point.run).changes;
  for (vv::Json& change : changes)
    if (change.contains("set")) change["set"].erase(precision_axis);
  return changes;
}

}  // namespace

std::optional<double> price_of(const vv::TradePoint& point, Price price) {
  const auto above_zero = [](double value) {
    return value > 0.0 && std::isfinite(value) ? std::optional(value) : std::nullopt;
  };
  switch (price) {
    case Price::seconds:
      return point.timing ? above_zero(point.timing->median) : std::nullopt;
    case Price::bytes:
      return above_zero(point.work.bytes);
    case Price::operations:
      return above_zero(point.work.operations);
    case Price::particle_steps:
      return above_zero(point.work.particle_steps);
  }
  return std::nullopt;
}

std::vector<Price> prices_of(const vv::TradeVerdict& trade) {
  std::vector<Price> prices;
  if (vv::has_times(trade)) prices.push_back(Price::seconds);
  for (const Price price : {Price::bytes, Price::operations}) {
    if (!counted(trade, price)) continue;
    prices.push_back(price);
    return prices;
  }
  if (prices.empty() || counted(trade, Price::particle_steps)) prices.push_back(Price::particle_steps);
  return prices;
}

bool on_front(const vv::TradePoint& point, Price price) {
  return vv::is_offer(point) && (price == Price::seconds ? point.on_time_front : point.on_work_front);
}

std::string name_of_price(Price price) {
  switch (price) {
    case Price::seconds:
      return "time of a run";
    case Price::bytes:
      return "data moved";
    case Price::operations:
      return "operations";
    case Price::particle_steps:
      return "particle-steps";
  }
  return "";
}

std::string duration_markup(double seconds) {
  if (!std::isfinite(seconds)) return "–";
  const auto [unit, symbol] = time_unit(seconds);
  return number_markup(seconds / unit) + "\u00a0" + symbol;
}

std::string price_markup(double value, Price price) {
  switch (price) {
    case Price::seconds:
      return duration_markup(value);
    case Price::bytes:
      return prefixed(value, "B");
    case Price::operations:
      return number_markup(value) + "\u00a0operations";
    case Price::particle_steps:
      return number_markup(value) + "\u00a0particle-steps";
  }
  return "–";
}

std::string percent_markup(double ratio) {
  const double percent = 100.0 * ratio;
  if (!std::isfinite(ratio)) return "–";
  // Small ones as well are read more easily without a power of ten.
  if (percent < 1e-4 || percent >= 0.01) return number_markup(percent) + "\u00a0%";
  return fmt::format("{:.{}f}\u00a0%", percent, 2 - static_cast<int>(std::floor(std::log10(percent))));
}

std::string error_markup(const vv::TradePoint& point) {
  const std::string uncertainty =
      point.uncertainty > 0.0 ? " ± " + number_markup(100.0 * point.uncertainty, 2) + "\u00a0%" : "";
  return percent_markup(point.error) + (std::isfinite(point.error) ? uncertainty : "");
}

std::string timing_markup(const vv::TradePoint& point) {
  if (!point.timing) return "–";
  const vv::Timing& t = *point.timing;
  const double unit = time_unit(t.median).first;
  return fmt::format("{} [{}\u00a0…\u00a0{}]", duration_markup(t.median), number_markup(t.low / unit),
                     number_markup(t.high / unit));
}

std::string ratio_markup(double ratio) {
  return std::isfinite(ratio) ? number_markup(ratio, ratio < 10.0 ? 2 : 3) + "\u00a0×" : "–";
}

std::string name_of_configuration(const vv::TradeVerdict& trade, const vv::TradePoint& point) {
  Parameters shown;
  for (const auto& entry : point.configuration)
    if (varies(trade, entry.first)) shown.push_back(entry);
  return name_of_run(shown.empty() ? point.configuration : shown);
}

std::string name_of_problem(const vv::TradeVerdict& trade) {
  return trade.problem.empty() ? "" : name_of_run(trade.problem);
}

std::string name_of_trade_error(const vv::TradeVerdict& trade, const vv::Case& definition) {
  for (const vv::TradeRequest& request : definition.trades)
    if (request.title == trade.title && !request.curve.empty())
      return "error of the " + words_of_curve(request.curve).words + " curve";
  return name_of_metric(trade.error_name, definition);
}

std::vector<const vv::TradeVerdict*> trades_of(const vv::CaseVerdict& verdict,
                                               const vv::FigureRequest& request) {
  std::vector<const vv::TradeVerdict*> trades;
  for (const vv::TradeVerdict& trade : verdict.trades)
    if (request.trade.empty() || trade.title == request.trade) trades.push_back(&trade);
  return trades;
}

std::vector<ChoiceEffect> effects_of(const std::vector<const vv::TradeVerdict*>& problems) {
  std::vector<ChoiceEffect> effects;
  for (const std::string& axis : parameters_of(problems)) {
    const std::vector<vv::Json> values = values_of(problems, axis);
    const bool ladder = std::all_of(values.begin(), values.end(), is_quantity);
    for (std::size_t k = 1; k < values.size(); ++k) {
      ChoiceEffect effect = effect_of(problems, axis, values[k], values[ladder ? k - 1 : 0]);
      if (effect.pairs + effect.only_taken_failed + effect.only_other_failed > 0)
        effects.push_back(std::move(effect));
    }
  }
  return effects;
}

std::optional<Rounding> rounding_of(const vv::TradeVerdict& trade, const vv::Case& definition) {
  Rounding rounding;
  for (const vv::TradePoint& point : trade.points) {
    if (failed(point) || !(point.error > 0.0) || is_in_float(point, definition)) continue;
    for (const vv::TradePoint& other : trade.points) {
      if (!is_in_float(other, definition) ||
          changes_without_precision(other, definition) != changes_without_precision(point, definition))
        continue;
      ++rounding.pairs;
      if (failed(other)) {
        ++rounding.failed;
        continue;
      }
      const double share = std::abs(other.error - point.error) / point.error;
      rounding.worst = std::max(rounding.worst, share);
      rounding.enough += share <= Rounding::negligible;
    }
  }
  return rounding.pairs > 0 ? std::optional(rounding) : std::nullopt;
}

}  // namespace mpm::reports
