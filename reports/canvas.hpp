#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace mpm::reports {

/// A picture that could not be drawn: no offscreen renderer, a GL error, a font that is not the one asked
/// for, or malformed markup. The message says which and what to do.
class CanvasError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A place on the canvas in points (1/72 inch): x to the right, y DOWN, origin at the upper left corner.
struct Point {
  double x = 0.0, y = 0.0;
};

/// An upright rectangle in points; `top` is the smaller y.
struct Rectangle {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;
  double width() const { return right - left; }
  double height() const { return bottom - top; }
  Point center() const { return {(left + right) / 2, (top + bottom) / 2}; }
  /// Inside or on the border.
  bool contains(Point p) const { return p.x >= left && p.x <= right && p.y >= top && p.y <= bottom; }
  bool intersects(const Rectangle& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  Rectangle grown(double by) const { return {left - by, top - by, right + by, bottom + by}; }
};

/// Non-linear sRGB, each in [0, 1]. `alpha` below 1 is meant for fills; strokes overlap at their joints.
struct Color {
  double red = 0.0, green = 0.0, blue = 0.0, alpha = 1.0;
};

inline constexpr Color black{0.0, 0.0, 0.0, 1.0};
inline constexpr Color white{1.0, 1.0, 1.0, 1.0};

/// Mixes `color` with white: 0 leaves it as it is, 1 gives white.
Color tint(const Color& color, double whiteness);

struct Stroke {
  Color color = black;
  double width = 1.0;        ///< [pt], > 0
  std::vector<double> dash;  ///< lengths on, off, on, ... [pt], each > 0; empty draws a solid line
};

enum class MarkerShape { none, circle, square, triangle, diamond, cross };

struct MarkerStyle {
  MarkerShape shape = MarkerShape::circle;
  double size = 4.0;        ///< diameter of the circle, or of a shape that looks as large [pt]
  Color fill = white;       ///< of the inside; not used by a cross
  Color edge = black;       ///< of the outline
  double edge_width = 0.7;  ///< [pt]
};

enum class Horizontal { left, center, right };
/// `middle` is half the height of a capital above the baseline, so that rows of digits line up whatever
/// superscripts they carry.
enum class Vertical { top, middle, baseline, bottom };

struct TextStyle {
  double size = 9.0;  ///< [pt]
  Color color = black;
  Horizontal horizontal = Horizontal::left;
  Vertical vertical = Vertical::baseline;
  bool upward = false;      ///< turned a quarter turn anticlockwise; the alignments turn with the text
  double wrap_width = 0.0;  ///< [pt]; 0 never breaks lines
};

/// Of a text before it is turned [pt].
struct TextExtent {
  double width = 0.0;
  double ascent = 0.0;   ///< from the top to the first baseline
  double descent = 0.0;  ///< from the first baseline to the bottom (further lines included)
  double height() const { return ascent + descent; }
};

/// A sheet to draw on, rendered offscreen (OSMesa, 2 x supersampled and 4 x multisampled) when its pixels are
/// asked for. Later drawing covers earlier drawing. The same drawing gives the same bytes.
///
/// Text is markup as Pango reads it: <i>, <b>, <sup>, <sub>, &lt;, Greek and any glyph the font has.
class Canvas {
 public:
  /// The one font family of every picture.
  static constexpr const char* family = "Liberation Sans";

  /// A white sheet of `width` x `height` [pt]. Throws CanvasError when the font does not resolve.
  Canvas(double width, double height, double pixels_per_point = 10.0 / 3.0);
  ~Canvas();
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;

  double width() const;   ///< [pt]
  double height() const;  ///< [pt]
  int pixel_width() const;
  int pixel_height() const;

  /// Everything drawn until `unclip()` is cut at this rectangle.
  void clip(const Rectangle& rectangle);
  void unclip();

  /// A polyline with round joins and butt ends. A point that is not finite breaks it.
  void line(const std::vector<Point>& points, const Stroke& stroke);
  /// An upright or level solid line on whole pixels: axes, ticks, grid lines.
  void rule(Point from, Point to, double width, const Color& color);
  /// A filled convex polygon, in either sense of rotation.
  void polygon(const std::vector<Point>& corners, const Color& fill);
  void rectangle(const Rectangle& rectangle, const Color& fill);
  /// Nothing is drawn at a place that is not finite.
  void marker(Point place, const MarkerStyle& style);

  /// Draws `markup` at `anchor`. Throws CanvasError for malformed markup or a glyph that the font lacks.
  void text(Point anchor, const std::string& markup, const TextStyle& style);
  /// What `text` would cover. Needs no renderer.
  static TextExtent measure(const std::string& markup, const TextStyle& style);

  /// RGB, row by row from the top, 3 bytes a pixel. Throws CanvasError when rendering fails.
  std::vector<unsigned char> pixels() const;
  /// The picture as a PNG file's bytes.
  std::vector<unsigned char> png() const;

 private:
  class Sheet;
  std::unique_ptr<Sheet> sheet_;
};

/// The family that fontconfig really serves when `family` is asked for: silent substitution shows here.
std::string resolved_family(const std::string& family);

}  // namespace mpm::reports
