#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vv/case_file.hpp"
#include "vv/quantity.hpp"

/// Whether two texts of a scene say the same.
namespace mpm::vv {

/// A number, or a quantity in the SI unit of its kind.
struct Magnitude {
  double value = 0.0;
  std::optional<QuantityKind> kind;  ///< none of a plain number

  bool comparable_with(const Magnitude& other) const { return kind == other.kind; }
};

/// What a value of a case file measures; nothing of one that is neither a number nor a quantity.
std::optional<Magnitude> magnitude_of(const Json& value);

/// Whether two values say the same: numbers and quantities by their magnitude, so that "1 m" is "100 cm",
/// everything else entry by entry, in any order of the keys.
bool same_value(const Json& one, const Json& other);

/// Whether `pointer` is one of the `places` or lies below one.
bool at_or_below_any(const std::string& pointer, const std::vector<std::string>& places);

/// JSON pointers, `pointer` and what follows, at which two values differ or which only one of them has.
/// Places at or below the `ignored` do not count.
std::vector<std::string> differences(const Json& one, const Json& other, const std::string& pointer,
                                     const std::vector<std::string>& ignored);

/// Every place below /scene that an axis of a sweep changes in any run.
std::vector<std::string> places_of(const SweepAxis& axis);

}  // namespace mpm::vv
