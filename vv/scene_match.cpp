#include "vv/scene_match.hpp"

#include <algorithm>

namespace mpm::vv {
namespace {

constexpr QuantityKind kinds[] = {QuantityKind::length,       QuantityKind::time,
                                  QuantityKind::pressure,     QuantityKind::density,
                                  QuantityKind::acceleration, QuantityKind::velocity,
                                  QuantityKind::angle,        QuantityKind::angular_velocity};

std::string pointer_to(const std::string& parent, const std::string& key) {
  return (Json::json_pointer(parent) / key).to_string();
}

void add_differences(const Json& one, const Json& other, const std::string& pointer,
                     const std::vector<std::string>& ignored, std::vector<std::string>& found);

/// The same of what one of two has, and the other may lack.
void add_difference(const Json& one, const Json* other, const std::string& pointer,
                    const std::vector<std::string>& ignored, std::vector<std::string>& found) {
  if (at_or_below_any(pointer, ignored)) return;
  if (other)
    add_differences(one, *other, pointer, ignored, found);
  else
    found.push_back(pointer);
}

void add_differences_of_objects(const Json& one, const Json& other, const std::string& pointer,
                                const std::vector<std::string>& ignored, std::vector<std::string>& found) {
  for (const auto& [key, value] : one.items()) {
    const auto same = other.find(key);
    add_difference(value, same == other.end() ? nullptr : &*same, pointer_to(pointer, key), ignored, found);
  }
  for (const auto& [key, value] : other.items())
    if (!one.contains(key)) add_difference(value, nullptr, pointer_to(pointer, key), ignored, found);
}

void add_differences_of_arrays(const Json& one, const Json& other, const std::string& pointer,
                               const std::vector<std::string>& ignored, std::vector<std::string>& found) {
  const Json& longer = one.size() < other.size() ? other : one;
  const Json& shorter = one.size() < other.size() ? one : other;
  for (std::size_t i = 0; i < longer.size(); ++i) {
    const Json* same = i < shorter.size() ? &shorter[i] : nullptr;
    add_difference(longer[i], same, pointer + "/" + std::to_string(i), ignored, found);
  }
}

void add_differences(const Json& one, const Json& other, const std::string& pointer,
                     const std::vector<std::string>& ignored, std::vector<std::string>& found) {
  if (one.is_object() && other.is_object()) {
    add_differences_of_objects(one, other, pointer, ignored, found);
  } else if (one.is_array() && other.is_array()) {
    add_differences_of_arrays(one, other, pointer, ignored, found);
  } else if (one != other) {
    const std::optional<Magnitude> first = magnitude_of(one), second = magnitude_of(other);
    const bool same = first && second && first->comparable_with(*second) && first->value == second->value;
    if (!same) found.push_back(pointer);
  }
}

}  // namespace

std::optional<Magnitude> magnitude_of(const Json& value) {
  if (value.is_number()) return Magnitude{value.get<double>(), std::nullopt};
  if (!value.is_string()) return std::nullopt;
  for (const QuantityKind kind : kinds) {
    try {
      return Magnitude{parse_quantity(value.get_ref<const std::string&>(), kind), kind};
    } catch (const QuantityError&) {  // of another kind, or a word
    }
  }
  return std::nullopt;
}

bool same_value(const Json& one, const Json& other) { return differences(one, other, "", {}).empty(); }

bool at_or_below_any(const std::string& pointer, const std::vector<std::string>& places) {
  return std::any_of(places.begin(), places.end(), [&](const std::string& place) {
    return pointer.starts_with(place) && (pointer.size() == place.size() || pointer[place.size()] == '/');
  });
}

std::vector<std::string> differences(const Json& one, const Json& other, const std::string& pointer,
                                     const std::vector<std::string>& ignored) {
  std::vector<std::string> found;
  add_difference(one, &other, pointer, ignored, found);
  return found;
}

std::vector<std::string> places_of(const SweepAxis& axis) {
  std::vector<std::string> places;
  if (axis.variants.empty()) places.push_back(axis.parameter);
  for (const Follower& follower : axis.with) places.push_back(follower.parameter);
  for (const Variant& variant : axis.variants) {
    for (const auto& [place, value] : variant.set) places.push_back(place);
    places.insert(places.end(), variant.remove.begin(), variant.remove.end());
  }
  return places;
}

}  // namespace mpm::vv
