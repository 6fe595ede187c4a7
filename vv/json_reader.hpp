#pragma once

#include <algorithm>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "vv/quantity.hpp"

namespace mpm::vv {

/// What is wrong with a place in a JSON text, not yet knowing which file the text came from.
class Refusal : public std::runtime_error {
 public:
  Refusal(std::string pointer, std::string expected, std::string found)
      : std::runtime_error(pointer + ": expected " + expected + ", found " + found),
        pointer_(std::move(pointer)),
        expected_(std::move(expected)),
        found_(std::move(found)) {}

  const std::string& pointer() const noexcept { return pointer_; }  ///< JSON pointer, or line and column
  const std::string& expected() const noexcept { return expected_; }
  const std::string& found() const noexcept { return found_; }

 private:
  std::string pointer_, expected_, found_;
};

/// A short description of a value on one line: `"10 kPa"`, `1.5`, `an array of 3 values`.
std::string describe(const nlohmann::ordered_json& value);

/// `a, b, c`, for messages.
std::string listed(const std::vector<std::string>& names);

bool contains(const std::vector<std::string>& names, const std::string& name);

/// The names of bodies, metrics or whatever else has one.
template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& each : all) names.push_back(each.name);
  return names;
}

/// The ids of probes, gates or whatever else has one.
template <class Identified>
std::vector<std::string> ids_of(const std::vector<Identified>& all) {
  std::vector<std::string> ids;
  for (const Identified& each : all) ids.push_back(each.id);
  return ids;
}

/// ` (did you mean "b"?)` with the name nearest to `word`, or nothing when none is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& names);

/// Parses a JSON text. Throws Refusal for a syntax error (with line and column in place of a pointer), for a
/// key given twice in one object, which JSON parsers commonly let pass, and for nesting too deep to be meant.
nlohmann::ordered_json parse_json(std::string_view text);

/// A value in a JSON text and the pointer it stands at. It may be absent: then it still knows where it should
/// stand, and every reading of it says that it is missing.
///
/// Every member function that reads throws Refusal when the value is not of the type it is read as.
class JsonPlace {
 public:
  using Json = nlohmann::ordered_json;

  /// `value` must outlive the place; null means absent.
  JsonPlace(const Json* value, std::string pointer) : value_(value), pointer_(std::move(pointer)) {}

  bool present() const noexcept { return value_ != nullptr; }
  const Json& value() const noexcept { return *value_; }  ///< of a present place
  const std::string& pointer() const noexcept { return pointer_; }

  /// Throws Refusal saying that `expected` was expected here; `remark` follows the description of what was
  /// found.
  [[noreturn]] void refuse(const std::string& expected, const std::string& remark = "") const;

  bool flag() const;
  bool flag_or(bool otherwise) const;  ///< `otherwise` if absent
  double number() const;
  int integer() const;                                            ///< within the range of int
  double quantity(QuantityKind kind) const;                       ///< in SI units
  double quantity_or(QuantityKind kind, double otherwise) const;  ///< `otherwise` if absent
  std::string text() const;                                       ///< not empty
  std::string identifier() const;  ///< a letter, then letters, digits and underscores
  std::string own_identifier(const std::vector<std::string>& taken) const;  ///< one that no earlier entry has
  std::string one_of(const std::vector<std::string>& names) const;

  /// The value that the name standing here is paired with.
  template <class Value>
  Value choice(std::initializer_list<std::pair<const char*, Value>> choices) const {
    std::vector<std::string> names;
    for (const auto& choice : choices) names.emplace_back(choice.first);
    const std::string name = one_of(names);
    const auto chosen =
        std::find_if(choices.begin(), choices.end(), [&](const auto& c) { return name == c.first; });
    return chosen->second;
  }

  std::vector<JsonPlace> elements() const;                         ///< of an array, which may be empty
  std::vector<JsonPlace> some_elements() const;                    ///< of an array with at least one entry
  std::vector<std::pair<std::string, JsonPlace>> members() const;  ///< of an object, in the order of the text

  /// Refuses anything but an object whose keys are all among `keys`.
  void allow_only(const std::vector<std::string>& keys) const;

  JsonPlace operator[](const std::string& key) const;  ///< of an object; absent when it has no such key

 private:
  const Json* value_;
  std::string pointer_;
};

}  // namespace mpm::vv
