#pragma once

#include <string>

#include "reports/canvas.hpp"

/// Words in a frame in which nothing else stands.
namespace mpm::reports {

/// Whether a note (markup), broken into lines, can be read in the frame.
bool fits_in_frame(const Rectangle& box, const std::string& note);

/// Fills the frame, in grey or with hatching, and writes the note in its middle; gives what the note covers.
Rectangle write_in_frame(Canvas& canvas, const Rectangle& box, const std::string& note, bool hatched);

}  // namespace mpm::reports
