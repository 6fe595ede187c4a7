#pragma once

#include <string>

#include "reports/canvas.hpp"

namespace mpm::reports {

// Sizes in points. Type is at least 9 pt everywhere but in the stamp.
inline constexpr double type_size = 9.0;
inline constexpr double title_size = 9.5;
inline constexpr double stamp_size = 6.5;
inline constexpr double line_height = 12.0;
inline constexpr double axis_width = 0.7;
inline constexpr double bar_width = 0.9;  // of the line of an error bar
inline constexpr double major_tick = 4.0;
inline constexpr double tick_gap = 3.5;
inline constexpr double outer_margin = 7.0;

inline constexpr Color ink{0.1, 0.1, 0.1, 1.0};
inline constexpr Color muted{0.36, 0.36, 0.36, 1.0};
inline constexpr Color stamp_color{0.55, 0.55, 0.55, 1.0};

inline TextStyle text_style(Horizontal horizontal, Vertical vertical, double size = type_size,
                            const Color& color = ink) {
  TextStyle style;
  style.size = size;
  style.color = color;
  style.horizontal = horizontal;
  style.vertical = vertical;
  return style;
}

/// Of markup on one line [pt].
inline double text_width(const std::string& markup, double size = type_size) {
  TextStyle style;
  style.size = size;
  return markup.empty() ? 0.0 : Canvas::measure(markup, style).width;
}

/// Of an explanation under a picture, broken at `width` [pt].
inline TextStyle note_style(double width) {
  TextStyle style = text_style(Horizontal::left, Vertical::top, type_size, muted);
  style.wrap_width = width;
  return style;
}

}  // namespace mpm::reports
