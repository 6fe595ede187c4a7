#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace mpm::vv {

/// The published JSON Schema (draft-07) of a case file: the text of vv/case.schema.json, built into the
/// program.
std::string_view case_schema();

/// Where and how a JSON text departs from the schema.
struct SchemaViolation {
  std::string pointer;      ///< JSON pointer of the value
  std::string description;  ///< for a person, on one line
};

/// The first violation found deepest in the text, or nothing. The schema knows types, keys, units and the
/// ranges of single values; it cannot compare values with each other, as `read_case` does.
std::optional<SchemaViolation> schema_violation(const nlohmann::ordered_json& case_text);

}  // namespace mpm::vv
