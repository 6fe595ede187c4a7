#include "reports/framed_note.hpp"

#include "reports/typography.hpp"

namespace mpm::reports {
namespace {

constexpr double note_margin = 6.0;  // [pt]
constexpr double hatch_pitch = 6.0;  // of a frame that cannot be filled [pt]

const Color hatch_color{0.84, 0.84, 0.84, 1.0};
const Color empty_color{0.96, 0.96, 0.96, 1.0};

TextStyle frame_note_style(const Rectangle& box) {
  TextStyle style = text_style(Horizontal::center, Vertical::top, type_size, muted);
  style.wrap_width = box.width() - 2 * note_margin;
  return style;
}

}  // namespace

bool fits_in_frame(const Rectangle& box, const std::string& note) {
  const TextExtent extent = Canvas::measure(note, frame_note_style(box));
  return extent.height() <= box.height() - 2 * note_margin && extent.width <= box.width() - note_margin;
}

Rectangle write_in_frame(Canvas& canvas, const Rectangle& box, const std::string& note, bool hatched) {
  const TextStyle style = frame_note_style(box);
  const TextExtent extent = Canvas::measure(note, style);
  const Point middle = box.center();
  const double half_width = extent.width / 2, half_height = extent.height() / 2;
  canvas.rectangle(box, hatched ? white : empty_color);
  if (hatched) {
    canvas.clip(box);
    for (double x = box.left - box.height(); x < box.right; x += hatch_pitch)
      canvas.line({{x, box.bottom}, {x + box.height(), box.top}}, {hatch_color, 0.6, {}});
    canvas.unclip();
    canvas.rectangle({middle.x - half_width - 4.0, middle.y - half_height - 2.0, middle.x + half_width + 4.0,
                      middle.y + half_height + 2.0},
                     white);
  }
  canvas.text({middle.x, middle.y - half_height}, note, style);
  return {middle.x - half_width, middle.y - half_height, middle.x + half_width, middle.y + half_height};
}

}  // namespace mpm::reports
