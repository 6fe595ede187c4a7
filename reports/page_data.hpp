#pragma once

#include <cstdint>
#include <mustache.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mpm::reports {

/// What a template of the report is filled with.
using PageData = kainjow::mustache::data;

PageData list();

PageData flag(bool on);

/// An object of texts. A key with an empty text is false, so that it switches a section of the template off.
PageData object(const std::vector<std::pair<std::string, std::string>>& entries);

/// Sets `name` to the entries and `has_<name>` to whether there are any.
void set_list(PageData& target, const std::string& name, const PageData& entries);

/// A list of objects with the key `text`.
PageData text_cells(const std::vector<std::string>& texts);

/// Markup of a count with a narrow space before every third digit.
std::string count_markup(std::int64_t count);

/// HTML of a short word in a rounded frame; `kind` is its class: pass, fail, open, expected or contrary.
std::string chip(const char* kind, const char* word);

std::string base64(const std::string& bytes);

/// The template filled with `page`, its texts escaped. Throws CanvasError for a broken template.
std::string rendered(std::string_view document, const PageData& page);

}  // namespace mpm::reports
