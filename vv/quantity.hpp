#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace mpm::vv {

/// What a number with a unit measures.
enum class QuantityKind { length, time, pressure, density, acceleration, velocity, angle, angular_velocity };

/// A unit a quantity may be written in: 10^`exponent` of the kind's SI unit.
///
/// Only decimal multiples of SI units are known; this is what makes every conversion correctly rounded.
struct Unit {
  std::string_view symbol;
  int exponent;
};

/// The units of a kind, the SI unit first; an angle has only degrees.
std::span<const Unit> units_of(QuantityKind kind);

/// What a quantity of this kind looks like, for a person: `a length such as "0.02 m" (units m, mm, cm, km)`.
std::string expectation_of(QuantityKind kind);

/// A text that is no quantity of the kind asked for; `expected` and `found` are short phrases on one line.
class QuantityError : public std::runtime_error {
 public:
  QuantityError(std::string expected, std::string found);
  const std::string& expected() const noexcept { return expected_; }
  const std::string& found() const noexcept { return found_; }

 private:
  std::string expected_, found_;
};

/// The value of `text` in the SI unit of `kind`, an angle in degrees: the double nearest to the decimal number written.
///
/// `text` is a decimal number, one blank, and a unit: "0.02 m", "-9.8 m/s^2", "1e4 kPa". Independent of the
/// locale. Throws QuantityError for anything else: no unit or one of another kind, text before or after,
/// "inf", "nan", or a number that no double can hold.
double parse_quantity(std::string_view text, QuantityKind kind);

}  // namespace mpm::vv
