// Without it, a fault in the schema would end the program instead of throwing.
#define VALIJSON_USE_EXCEPTIONS 1

#include "vv/case_schema.hpp"

#include <algorithm>
#include <memory>
#include <vector>

// g++ 12 warns, at -O3 and with sanitizers, of string and regex code that the validator only instantiates.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpragmas"
#pragma GCC diagnostic ignored "-Wunknown-warning-option"
#pragma GCC diagnostic ignored "-Wrestrict"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>
#pragma GCC diagnostic pop

namespace mpm::vv {
namespace {

using valijson::adapters::NlohmannJsonAdapter;

/// The adapter reads plain json only, not the variant that keeps the order of keys.
nlohmann::json plain(const nlohmann::ordered_json& value) { return nlohmann::json::parse(value.dump()); }

std::unique_ptr<valijson::Schema> parsed_schema() {
  const nlohmann::json text = nlohmann::json::parse(case_schema());
  auto schema = std::make_unique<valijson::Schema>();
  valijson::SchemaParser(valijson::SchemaParser::kDraft7).populateSchema(NlohmannJsonAdapter(text), *schema);
  return schema;
}

const valijson::Schema& schema() {
  static const std::unique_ptr<valijson::Schema> parsed = parsed_schema();
  return *parsed;
}

/// The validator's path "<root>", "[scene]", "[0]" as a JSON pointer.
std::string pointer_of(const std::vector<std::string>& context) {
  nlohmann::json::json_pointer pointer;
  for (std::size_t i = 1; i < context.size(); ++i) {
    const std::string& step = context[i];
    pointer.push_back(step.size() >= 2 && step.front() == '[' ? step.substr(1, step.size() - 2) : step);
  }
  return pointer.to_string();
}

}  // namespace

std::optional<SchemaViolation> schema_violation(const nlohmann::ordered_json& case_text) {
  const nlohmann::json text = plain(case_text);
  valijson::ValidationResults results;
  valijson::Validator validator(valijson::Validator::kStrongTypes);
  if (validator.validate(schema(), NlohmannJsonAdapter(text), &results)) return std::nullopt;
  // Every failure is reported again at each level above it: the longest path is the value at fault.
  const auto deepest = std::max_element(results.begin(), results.end(), [](const auto& a, const auto& b) {
    return a.context.size() < b.context.size();
  });
  if (deepest == results.end()) return SchemaViolation{"", "a case as described by case.schema.json"};
  std::string description = deepest->description;
  std::replace(description.begin(), description.end(), '\n', ' ');
  return SchemaViolation{pointer_of(deepest->context), description};
}

}  // namespace mpm::vv
