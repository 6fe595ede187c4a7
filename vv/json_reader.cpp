#include "vv/json_reader.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <set>

namespace mpm::vv {
namespace {

using Json = nlohmann::ordered_json;

/// Far deeper than any case file; keeps a hostile text from exhausting the stack of recursive code.
constexpr std::size_t deepest_nesting = 50;

std::string child(const std::string& pointer, const std::string& key) {
  return (Json::json_pointer(pointer) / key).to_string();
}

std::string child(const std::string& pointer, std::size_t index) {
  return pointer + "/" + std::to_string(index);
}

/// `line 3, column 5`, both counted from 1, for the character before byte `position`.
std::string line_and_column(std::string_view text, std::size_t position) {
  const std::string_view read = text.substr(0, position == 0 ? 0 : position - 1);
  const auto line = 1 + std::count(read.begin(), read.end(), '\n');
  const std::size_t line_start = read.rfind('\n') + 1;  // npos + 1 is 0: the first line
  return "line " + std::to_string(line) + ", column " + std::to_string(read.size() - line_start + 1);
}

/// The middle of the parser's message: without its name, its own position, and the raw text it read last.
std::string essence(const std::string& message) {
  const std::size_t dash = message.find(" - ");
  const std::size_t bracket = message.find("] ");
  std::string rest = message.substr(dash != std::string::npos      ? dash + 3
                                    : bracket != std::string::npos ? bracket + 2
                                                                   : 0);
  const std::size_t last_read = rest.find("; last read");
  const std::size_t wanted = rest.find("; expected");
  if (last_read == std::string::npos) return rest;
  return rest.substr(0, last_read) +
         (wanted != std::string::npos && wanted > last_read ? rest.substr(wanted) : "");
}

/// Walks through a text as it is parsed and refuses what a parser lets pass.
class Strictness : public nlohmann::json_sax<Json> {
 public:
  explicit Strictness(std::string_view text) : text_(text) {}

  bool null() override { return enter_value(); }
  bool boolean(bool) override { return enter_value(); }
  bool number_integer(number_integer_t) override { return enter_value(); }
  bool number_unsigned(number_unsigned_t) override { return enter_value(); }
  bool number_float(number_float_t, const string_t&) override { return enter_value(); }
  bool string(string_t&) override { return enter_value(); }
  bool binary(binary_t&) override { return enter_value(); }

  bool start_object(std::size_t) override { return open(true); }
  bool start_array(std::size_t) override { return open(false); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    Level& level = levels_.back();
    level.key = name;
    if (!level.keys.insert(name).second) throw Refusal(here(), "each key once", "it a second time");
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::json::exception& error) override {
    throw Refusal(line_and_column(text_, position), "valid JSON", essence(error.what()));
  }

 private:
  struct Level {
    bool object;
    std::string key;
    std::size_t entries = 0;
    std::set<std::string> keys;
  };

  bool enter_value() {
    if (!levels_.empty()) ++levels_.back().entries;
    return true;
  }

  bool open(bool object) {
    enter_value();
    levels_.push_back({object, "", 0, {}});
    if (levels_.size() > deepest_nesting) {
      levels_.pop_back();
      throw Refusal(here(), "at most " + std::to_string(deepest_nesting) + " levels of nesting", "more");
    }
    return true;
  }

  bool close() {
    levels_.pop_back();
    return true;
  }

  /// The pointer of the value or key that was entered last.
  std::string here() const {
    std::string pointer;
    for (const Level& level : levels_) {
      pointer = level.object ? child(pointer, level.key) : child(pointer, level.entries - 1);
    }
    return pointer;
  }

  std::string_view text_;
  std::vector<Level> levels_;
};

/// The number of single-letter changes between two words.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, diagonal + 1});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string describe(const Json& value) {
  if (value.is_object()) return value.empty() ? "an empty object" : "an object";
  if (value.is_array() && value.empty()) return "an empty array";
  if (value.is_array()) return "an array of " + std::to_string(value.size());
  // The dump escapes line breaks and replaces bytes that are no text, so that a message stays one line.
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  constexpr std::size_t longest = 80;
  if (text.size() <= longest) return text;
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80)
    --end;  // keep UTF-8 letters whole
  return text.substr(0, end) + "...";
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string suggestion(const std::string& word, const std::vector<std::string>& names) {
  constexpr std::size_t longest_compared = 60;
  if (word.size() > longest_compared) return "";
  const std::string* nearest = nullptr;
  std::size_t distance = 1 + std::max<std::size_t>(2, word.size() / 4);
  for (const std::string& name : names) {
    const std::size_t candidate = edit_distance(word, name);
    if (candidate < distance && candidate < name.size()) {
      nearest = &name;
      distance = candidate;
    }
  }
  return nearest ? " (did you mean \"" + *nearest + "\"?)" : "";
}

Json parse_json(std::string_view text) {
  Strictness strictness(text);
  Json::sax_parse(text.begin(), text.end(), &strictness);
  return Json::parse(text.begin(), text.end());
}

void JsonPlace::refuse(const std::string& expected, const std::string& remark) const {
  throw Refusal(pointer_, expected, (present() ? describe(*value_) : "nothing: the key is missing") + remark);
}

bool JsonPlace::flag() const {
  if (!present() || !value_->is_boolean()) refuse("true or false");
  return value_->get<bool>();
}

bool JsonPlace::flag_or(bool otherwise) const { return present() ? flag() : otherwise; }

double JsonPlace::number() const {
  if (!present() || !value_->is_number()) refuse("a number");
  return value_->get<double>();
}

int JsonPlace::integer() const {
  if (!present() || !value_->is_number_integer()) refuse("an integer");
  constexpr std::int64_t largest = std::numeric_limits<int>::max();
  // An unsigned number beyond int64 would come out negative, so that it is compared as unsigned.
  const bool too_large =
      value_->is_number_unsigned() && value_->get<std::uint64_t>() > std::uint64_t{largest};
  if (too_large || std::abs(value_->get<double>()) > static_cast<double>(largest)) {
    refuse("an integer of at most " + std::to_string(largest));
  }
  return value_->get<int>();
}

double JsonPlace::quantity(QuantityKind kind) const {
  if (!present() || !value_->is_string()) {
    refuse(expectation_of(kind), present() && value_->is_number() ? ", a number without a unit" : "");
  }
  try {
    return parse_quantity(value_->get_ref<const std::string&>(), kind);
  } catch (const QuantityError& error) {
    throw Refusal(pointer_, error.expected(), error.found());
  }
}

double JsonPlace::quantity_or(QuantityKind kind, double otherwise) const {
  return present() ? quantity(kind) : otherwise;
}

std::string JsonPlace::text() const {
  if (!present() || !value_->is_string() || value_->get_ref<const std::string&>().empty()) {
    refuse("a text that is not empty");
  }
  return value_->get<std::string>();
}

std::string JsonPlace::identifier() const {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto inner = [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  const std::string expected = "a name: a letter, then letters, digits and underscores";
  if (!present() || !value_->is_string()) refuse(expected);
  const std::string& name = value_->get_ref<const std::string&>();
  if (name.empty() || !letter(name.front()) || !std::all_of(name.begin(), name.end(), inner))
    refuse(expected);
  return name;
}

std::string JsonPlace::own_identifier(const std::vector<std::string>& taken) const {
  const std::string id = identifier();
  if (contains(taken, id)) refuse("an id of its own", ", which an earlier entry has");
  return id;
}

std::string JsonPlace::one_of(const std::vector<std::string>& names) const {
  const std::string expected = (names.size() > 1 ? "one of " : "") + listed(names);
  if (!present() || !value_->is_string()) refuse(expected);
  const std::string& name = value_->get_ref<const std::string&>();
  if (!contains(names, name)) refuse(expected, suggestion(name, names));
  return name;
}

std::vector<JsonPlace> JsonPlace::elements() const {
  if (!present() || !value_->is_array()) refuse("an array");
  std::vector<JsonPlace> places;
  for (std::size_t i = 0; i < value_->size(); ++i) places.emplace_back(&(*value_)[i], child(pointer_, i));
  return places;
}

std::vector<JsonPlace> JsonPlace::some_elements() const {
  if (!present() || !value_->is_array() || value_->empty()) refuse("an array of at least one value");
  return elements();
}

std::vector<std::pair<std::string, JsonPlace>> JsonPlace::members() const {
  if (!present() || !value_->is_object()) refuse("an object");
  std::vector<std::pair<std::string, JsonPlace>> places;
  for (const auto& [key, member] : value_->items()) {
    places.emplace_back(key, JsonPlace(&member, child(pointer_, key)));
  }
  return places;
}

void JsonPlace::allow_only(const std::vector<std::string>& keys) const {
  for (const auto& [key, place] : members()) {
    if (!contains(keys, key)) {
      throw Refusal(place.pointer(), "one of the keys " + listed(keys),
                    describe(Json(key)) + suggestion(key, keys));
    }
  }
}

JsonPlace JsonPlace::operator[](const std::string& key) const {
  if (!present() || !value_->is_object()) refuse("an object");
  const auto member = value_->find(key);
  return JsonPlace(member == value_->end() ? nullptr : &*member, child(pointer_, key));
}

}  // namespace mpm::vv
