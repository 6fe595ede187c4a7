#include "reports/page_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "reports/canvas.hpp"
#include "reports/figures.hpp"

namespace mpm::reports {

PageData list() { return PageData(PageData::type::list); }

PageData flag(bool on) { return PageData(on ? PageData::type::bool_true : PageData::type::bool_false); }

PageData object(const std::vector<std::pair<std::string, std::string>>& entries) {
  PageData result(PageData::type::object);
  for (const auto& [key, value] : entries) {
    if (!value.empty())
      result.set(key, value);
    else
      result.set(key, flag(false));
  }
  return result;
}

void set_list(PageData& target, const std::string& name, const PageData& entries) {
  target.set(name, entries);
  target.set("has_" + name, flag(!entries.is_empty_list()));
}

PageData text_cells(const std::vector<std::string>& texts) {
  PageData cells = list();
  for (const std::string& text : texts) cells << object({{"text", text}});
  return cells;
}

std::string count_markup(std::int64_t count) {
  std::string digits = std::to_string(count);
  for (auto at = static_cast<int>(digits.size()) - 3; at > (count < 0 ? 1 : 0); at -= 3)
    digits.insert(static_cast<std::size_t>(at), "\u202f");
  return digits;
}

std::string chip(const char* kind, const char* word) {
  return fmt::format("<span class=\"chip {}\">{}</span>", kind, word);
}

std::string base64(const std::string& bytes) {
  static constexpr std::string_view alphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= std::min<std::size_t>(3, bytes.size() - i) ? alphabet[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

std::string rendered(std::string_view document, const PageData& page) {
  kainjow::mustache::mustache filled{std::string(document)};
  filled.set_custom_escape(escaped);
  const std::string html = filled.render(page);
  if (!filled.error_message().empty())
    throw CanvasError("the report's template is broken: " + filled.error_message());
  return html;
}

}  // namespace mpm::reports
