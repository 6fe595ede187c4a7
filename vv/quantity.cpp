#include "vv/quantity.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>
#include <utility>

namespace mpm::vv {
namespace {

constexpr Unit length_units[] = {{"m", 0}, {"mm", -3}, {"cm", -2}, {"km", 3}};
constexpr Unit time_units[] = {{"s", 0}, {"ms", -3}, {"us", -6}};
constexpr Unit pressure_units[] = {{"Pa", 0}, {"kPa", 3}, {"MPa", 6}, {"GPa", 9}};
constexpr Unit density_units[] = {{"kg/m^3", 0}, {"g/cm^3", 3}, {"t/m^3", 3}};
constexpr Unit acceleration_units[] = {{"m/s^2", 0}};
constexpr Unit angle_units[] = {{"deg", 0}};
constexpr Unit angular_velocity_units[] = {{"rad/s", 0}};
constexpr Unit velocity_units[] = {{"m/s", 0}, {"mm/s", -3}, {"cm/s", -2}};

struct KindEntry {
  QuantityKind kind;
  std::string_view name;  ///< with its article
  std::string_view example;
  std::span<const Unit> units;
};

constexpr std::array<KindEntry, 8> kinds = {{
    {QuantityKind::length, "a length", "0.02 m", length_units},
    {QuantityKind::time, "a time", "0.5 s", time_units},
    {QuantityKind::pressure, "a pressure", "10 kPa", pressure_units},
    {QuantityKind::density, "a density", "1000 kg/m^3", density_units},
    {QuantityKind::acceleration, "an acceleration", "-9.8 m/s^2", acceleration_units},
    {QuantityKind::velocity, "a velocity", "0.1 m/s", velocity_units},
    {QuantityKind::angle, "an angle", "30 deg", angle_units},
    {QuantityKind::angular_velocity, "an angular velocity", "0.5 rad/s", angular_velocity_units},
}};

/// Units that are easily taken for another kind's, with the way out.
struct ForeignUnit {
  std::string_view symbol, advice;
};
constexpr std::string_view unit_weight = "a unit weight: divide it by the acceleration of gravity";
constexpr ForeignUnit foreign_units[] = {
    {"N/m^3", unit_weight}, {"kN/m^3", unit_weight}, {"MN/m^3", unit_weight}};

const KindEntry& entry_of(QuantityKind kind) {
  for (const KindEntry& entry : kinds) {
    if (entry.kind == kind) return entry;
  }
  throw std::logic_error("a quantity kind without units");
}

/// `text` in quotes, in plain letters on one line, and cut where it gets too long to read.
std::string quoted(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::string result = "\"";
  for (const char c : text.substr(0, longest)) result += c >= ' ' && c <= '~' ? c : '?';
  return result + (text.size() > longest ? "...\"" : "\"");
}

std::size_t digits_at(std::string_view text, std::size_t start) {
  std::size_t end = start;
  while (end < text.size() && text[end] >= '0' && text[end] <= '9') ++end;
  return end - start;
}

/// The length of the decimal number `text` begins with, 0 if it begins with none. Spelt out rather than left
/// to from_chars, which takes "inf" and "nan" too.
std::size_t number_length(std::string_view text) {
  std::size_t at = !text.empty() && text[0] == '-' ? 1 : 0;
  const std::size_t whole = digits_at(text, at);
  if (whole == 0) return 0;
  at += whole;
  if (at < text.size() && text[at] == '.') {
    const std::size_t decimals = digits_at(text, at + 1);
    if (decimals == 0) return 0;
    at += 1 + decimals;
  }
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    const bool sign = at + 1 < text.size() && (text[at + 1] == '+' || text[at + 1] == '-');
    const std::size_t start = at + (sign ? 2 : 1);
    const std::size_t exponent = digits_at(text, start);
    if (exponent == 0) return 0;
    at = start + exponent;
  }
  return at;
}

template <class Number>
std::optional<Number> parsed(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// `number` * 10^`exponent`. The exponent is moved in the text, not by multiplying: one rounding, so that
/// "2 cm" and "0.02 m" are the same double.
std::optional<double> scaled(std::string_view number, int exponent) {
  const std::size_t mark = number.find_first_of("eE");
  if (mark != std::string_view::npos) {
    std::string_view written = number.substr(mark + 1);
    if (written.front() == '+') written.remove_prefix(1);
    const std::optional<int> value = parsed<int>(written);
    // More than this no double holds, and it keeps the sum below from overflowing.
    if (!value || *value > 10'000 || *value < -10'000) return std::nullopt;
    exponent += *value;
  }
  return parsed<double>(std::string(number.substr(0, mark)) + "e" + std::to_string(exponent));
}

const Unit* find_unit(std::span<const Unit> units, std::string_view symbol) {
  for (const Unit& unit : units) {
    if (unit.symbol == symbol) return &unit;
  }
  return nullptr;
}

/// What `symbol` is when it is not a unit of the kind asked for: ", a length", or nothing when it is unknown.
std::string note_on_unit(std::string_view symbol) {
  for (const ForeignUnit& unit : foreign_units) {
    if (unit.symbol == symbol) return ", " + std::string(unit.advice);
  }
  for (const KindEntry& entry : kinds) {
    if (find_unit(entry.units, symbol)) return ", " + std::string(entry.name);
  }
  return "";
}

}  // namespace

QuantityError::QuantityError(std::string expected, std::string found)
    : std::runtime_error("expected " + expected + ", found " + found),
      expected_(std::move(expected)),
      found_(std::move(found)) {}

std::span<const Unit> units_of(QuantityKind kind) { return entry_of(kind).units; }

std::string expectation_of(QuantityKind kind) {
  const KindEntry& entry = entry_of(kind);
  std::string symbols;
  for (const Unit& unit : entry.units) {
    symbols += (symbols.empty() ? "" : ", ") + std::string(unit.symbol);
  }
  return std::string(entry.name) + " such as \"" + std::string(entry.example) + "\" (" +
         (entry.units.size() > 1 ? "units " : "unit ") + symbols + ")";
}

double parse_quantity(std::string_view text, QuantityKind kind) {
  const auto refuse = [&](const std::string& note) {
    return QuantityError(expectation_of(kind), quoted(text) + note);
  };
  const std::size_t length = number_length(text);
  if (length == 0) throw refuse("");
  if (length == text.size()) throw refuse(", which has no unit");
  if (text[length] != ' ') throw refuse(", without a blank between number and unit");

  const std::string_view symbol = text.substr(length + 1);
  const Unit* unit = find_unit(units_of(kind), symbol);
  if (!unit) throw refuse(note_on_unit(symbol));

  const std::optional<double> value = scaled(text.substr(0, length), unit->exponent);
  if (!value || !std::isfinite(*value)) throw refuse(", beyond the range of a floating-point number");
  return *value;
}

}  // namespace mpm::vv
