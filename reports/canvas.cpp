#include "reports/canvas.hpp"

#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
#include <fontconfig/fontconfig.h>
#include <pango/pangocairo.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

namespace mpm::reports {
namespace {

constexpr int supersampling = 2;
constexpr int multisampling = 4;
// The frame buffer holds this many rows at a time: with 16 samples a pixel a whole sheet does not fit the
// cache.
constexpr int band_rows = 256;
constexpr int atlas_width = 4096;
// Height of a capital of Liberation Sans, as a fraction of the type size.
constexpr double capital_height = 0.71;

/// x, y in subpixels; u, v in texels of the text atlas, u < 0 for a plain fill; colour.
struct Vertex {
  float x, y, u, v, red, green, blue, alpha;
};

struct PixelBox {
  int left, top, right, bottom;
};

/// Vertices that share a clip box.
struct Batch {
  std::size_t first, count;
  PixelBox clip;
};

/// Coverage masks of all texts of a sheet, packed in shelves.
struct Atlas {
  std::vector<std::uint8_t> coverage;
  int rows = 0;
  int shelf_left = 0, shelf_top = 0, shelf_rows = 0;

  /// Reserves room and returns its upper left texel.
  std::pair<int, int> place(int width, int height) {
    if (width > atlas_width) throw CanvasError("a text is wider than the widest picture");
    if (shelf_left + width > atlas_width) {
      shelf_top += shelf_rows;
      shelf_left = shelf_rows = 0;
    }
    shelf_rows = std::max(shelf_rows, height);
    rows = std::max(rows, shelf_top + height);
    coverage.resize(static_cast<std::size_t>(rows) * atlas_width, 0);
    const std::pair<int, int> corner{shelf_left, shelf_top};
    shelf_left += width;
    return corner;
  }
};

const char* const vertex_shader = R"(#version 330 core
layout(location = 0) in vec2 place;
layout(location = 1) in vec2 texel;
layout(location = 2) in vec4 color;
uniform vec2 size;
uniform float top;
out vec2 at;
out vec4 tone;
void main() {
  at = texel;
  tone = color;
  gl_Position = vec4(2.0 * place.x / size.x - 1.0, 2.0 * (place.y - top) / size.y - 1.0, 0.0, 1.0);
})";

const char* const fragment_shader = R"(#version 330 core
uniform sampler2D atlas;
in vec2 at;
in vec4 tone;
out vec4 color;
void main() {
  float coverage = at.x < 0.0 ? 1.0 : texelFetch(atlas, ivec2(floor(at)), 0).r;
  color = vec4(tone.rgb, tone.a * coverage);
})";

void expect_no_gl_error(const char* what) {
  const GLenum error = glGetError();
  if (error != GL_NO_ERROR)
    throw CanvasError(std::string("offscreen rendering failed: GL error ") + std::to_string(error) +
                      " while " + what);
}

GLuint compiled(GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (!good) {
    std::array<char, 512> log{};
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw CanvasError(std::string("offscreen rendering failed: shader: ") + log.data());
  }
  return shader;
}

/// The one owner of GL: a core profile context, its program and its frame buffers. One a thread, reused for
/// every sheet.
class Renderer {
 public:
  static Renderer& of_this_thread() {
    thread_local Renderer renderer;
    return renderer;
  }
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;
  ~Renderer() { OSMesaDestroyContext(context_); }

  /// RGB of width x height pixels.
  std::vector<unsigned char> render(int width, int height, const std::vector<Vertex>& vertices,
                                    const std::vector<Batch>& batches, const Atlas& atlas) {
    make_current();
    const int columns = width * supersampling, rows = height * supersampling;
    size_buffers(columns);
    upload(vertices, atlas);
    std::vector<unsigned char> picture(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                                       3);
    std::vector<std::uint8_t> band(static_cast<std::size_t>(columns) * band_rows * 4);
    for (int top = 0; top < rows; top += band_rows) {
      const int band_height = std::min(band_rows, rows - top);
      draw_band(columns, top, batches);
      read_band(columns, band_height, band);
      average(band, columns, band_height,
              picture.data() + static_cast<std::size_t>(top / supersampling * width) * 3);
    }
    expect_no_gl_error("drawing");
    return picture;
  }

 private:
  Renderer() {
    const std::array<int, 9> attributes{OSMESA_FORMAT,
                                        OSMESA_RGBA,
                                        OSMESA_PROFILE,
                                        OSMESA_CORE_PROFILE,
                                        OSMESA_CONTEXT_MAJOR_VERSION,
                                        3,
                                        OSMESA_CONTEXT_MINOR_VERSION,
                                        3,
                                        0};
    context_ = OSMesaCreateContextAttribs(attributes.data(), nullptr);
    if (!context_)
      throw CanvasError(
          "no offscreen OpenGL 3.3: OSMesa gave no core profile context (Debian package libosmesa6)");
    try {
      set_up();
    } catch (...) {
      OSMesaDestroyContext(context_);
      throw;
    }
  }

  void set_up() {
    make_current();
    GLint samples = 0;
    glGetIntegerv(GL_MAX_SAMPLES, &samples);
    if (samples < multisampling) throw CanvasError("offscreen OpenGL has no 4x multisampling");
    program_ = glCreateProgram();
    glAttachShader(program_, compiled(GL_VERTEX_SHADER, vertex_shader));
    glAttachShader(program_, compiled(GL_FRAGMENT_SHADER, fragment_shader));
    glLinkProgram(program_);
    GLint good = 0;
    glGetProgramiv(program_, GL_LINK_STATUS, &good);
    if (!good) throw CanvasError("offscreen rendering failed: shaders do not link");
    glUseProgram(program_);
    glGenVertexArrays(1, &vertex_array_);
    glBindVertexArray(vertex_array_);
    glGenBuffers(1, &vertex_buffer_);
    glGenTextures(1, &atlas_);
    glGenFramebuffers(2, frame_.data());
    glGenRenderbuffers(2, storage_.data());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    expect_no_gl_error("setting up");
  }

  void make_current() {
    // Drawing goes to frame buffer objects; OSMesa only insists on having some buffer.
    if (!OSMesaMakeCurrent(context_, default_buffer_.data(), GL_UNSIGNED_BYTE, 8, 8))
      throw CanvasError("offscreen rendering failed: OSMesa refused its buffer");
  }

  void size_buffers(int columns) {
    if (columns == columns_) return;
    GLint largest = 0;
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
    if (columns > largest) throw CanvasError("the picture is wider than offscreen OpenGL allows");
    glBindRenderbuffer(GL_RENDERBUFFER, storage_[0]);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, multisampling, GL_RGBA8, columns, band_rows);
    glBindRenderbuffer(GL_RENDERBUFFER, storage_[1]);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, columns, band_rows);
    for (std::size_t i = 0; i < 2; ++i) {
      glBindFramebuffer(GL_FRAMEBUFFER, frame_[i]);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, storage_[i]);
      if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw CanvasError("offscreen rendering failed: incomplete frame buffer");
    }
    columns_ = columns;
  }

  void upload(const std::vector<Vertex>& vertices, const Atlas& atlas) {
    glBindBuffer(GL_ARRAY_BUFFER, vertex_buffer_);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)), vertices.data(),
                 GL_STREAM_DRAW);
    const std::array<GLint, 3> sizes{2, 2, 4};
    std::size_t offset = 0;
    for (GLuint i = 0; i < sizes.size(); ++i) {
      glEnableVertexAttribArray(i);
      glVertexAttribPointer(i, sizes[i], GL_FLOAT, GL_FALSE, sizeof(Vertex),
                            reinterpret_cast<const void*>(offset));
      offset += static_cast<std::size_t>(sizes[i]) * sizeof(float);
    }
    glBindTexture(GL_TEXTURE_2D, atlas_);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, atlas_width, std::max(1, atlas.rows), 0, GL_RED, GL_UNSIGNED_BYTE,
                 atlas.rows > 0 ? atlas.coverage.data() : nullptr);
    expect_no_gl_error("uploading");
  }

  void draw_band(int columns, int top, const std::vector<Batch>& batches) {
    glBindFramebuffer(GL_FRAMEBUFFER, frame_[0]);
    glViewport(0, 0, columns, band_rows);
    glUniform2f(glGetUniformLocation(program_, "size"), static_cast<float>(columns),
                static_cast<float>(band_rows));
    glUniform1f(glGetUniformLocation(program_, "top"), static_cast<float>(top));
    glDisable(GL_SCISSOR_TEST);
    glClearColor(1.0F, 1.0F, 1.0F, 1.0F);
    glClear(GL_COLOR_BUFFER_BIT);
    glEnable(GL_MULTISAMPLE);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    for (const Batch& batch : batches) {
      const int upper = std::max(batch.clip.top - top, 0),
                lower = std::min(batch.clip.bottom - top, band_rows);
      if (lower <= upper || batch.clip.right <= batch.clip.left) continue;
      glScissor(batch.clip.left, upper, batch.clip.right - batch.clip.left, lower - upper);
      glDrawArrays(GL_TRIANGLES, static_cast<GLint>(batch.first), static_cast<GLsizei>(batch.count));
    }
  }

  void read_band(int columns, int rows, std::vector<std::uint8_t>& band) {
    glDisable(GL_SCISSOR_TEST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, frame_[0]);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, frame_[1]);
    glBlitFramebuffer(0, 0, columns, band_rows, 0, 0, columns, band_rows, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, frame_[1]);
    glReadPixels(0, 0, columns, rows, GL_RGBA, GL_UNSIGNED_BYTE, band.data());
  }

  /// Averages blocks of 2 x 2 subpixels.
  static void average(const std::vector<std::uint8_t>& band, int columns, int rows, unsigned char* out) {
    const std::size_t stride = static_cast<std::size_t>(columns) * 4;
    for (int row = 0; row + 1 < rows; row += supersampling) {
      const std::uint8_t* upper = band.data() + static_cast<std::size_t>(row) * stride;
      const std::uint8_t* lower = upper + stride;
      for (int column = 0; column < columns; column += supersampling, upper += 8, lower += 8)
        for (int channel = 0; channel < 3; ++channel)
          *out++ = static_cast<unsigned char>(
              (upper[channel] + upper[channel + 4] + lower[channel] + lower[channel + 4] + 2) / 4);
    }
  }

  OSMesaContext context_ = nullptr;
  std::array<std::uint8_t, 8 * 8 * 4> default_buffer_{};
  GLuint program_ = 0, vertex_array_ = 0, vertex_buffer_ = 0, atlas_ = 0;
  std::array<GLuint, 2> frame_{}, storage_{};
  int columns_ = 0;
};

/// Deletes what a C library handed out.
struct Release {
  void operator()(PangoLayout* layout) const { g_object_unref(layout); }
  void operator()(PangoFont* font) const { g_object_unref(font); }
  void operator()(PangoFontDescription* description) const { pango_font_description_free(description); }
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* cairo) const { cairo_destroy(cairo); }
};
template <class T>
using Owned = std::unique_ptr<T, Release>;

Owned<PangoFontDescription> describe(const std::string& family, double size) {
  Owned<PangoFontDescription> description(pango_font_description_new());
  pango_font_description_set_family(description.get(), family.c_str());
  pango_font_description_set_absolute_size(description.get(), size * PANGO_SCALE);
  return description;
}

/// Pango set to unhinted outlines, so that a text measures the same at every resolution. One a thread.
class Typesetter {
 public:
  static Typesetter& of_this_thread() {
    thread_local Typesetter typesetter;
    return typesetter;
  }
  Typesetter(const Typesetter&) = delete;
  Typesetter& operator=(const Typesetter&) = delete;
  ~Typesetter() {
    g_object_unref(context_);
    g_object_unref(font_map_);
  }

  std::string resolve(const std::string& family) {
    const auto description = describe(family, 9.0);
    const Owned<PangoFont> font(pango_context_load_font(context_, description.get()));
    if (!font) return "";
    const Owned<PangoFontDescription> found(pango_font_describe(font.get()));
    return pango_font_description_get_family(found.get());
  }

  Owned<PangoLayout> layout(const std::string& markup, const TextStyle& style) {
    require_family();
    GError* error = nullptr;
    PangoAttrList* attributes = nullptr;
    char* plain = nullptr;
    if (!pango_parse_markup(markup.c_str(), -1, 0, &attributes, &plain, nullptr, &error)) {
      const std::string reason = error->message;
      g_error_free(error);
      throw CanvasError("malformed markup \"" + markup + "\": " + reason);
    }
    Owned<PangoLayout> layout(pango_layout_new(context_));
    const auto description = describe(Canvas::family, style.size);
    pango_layout_set_font_description(layout.get(), description.get());
    pango_layout_set_text(layout.get(), plain, -1);
    pango_attr_list_insert(attributes, pango_attr_fallback_new(FALSE));
    pango_layout_set_attributes(layout.get(), attributes);
    pango_attr_list_unref(attributes);
    g_free(plain);
    if (style.wrap_width > 0.0)
      pango_layout_set_width(layout.get(), static_cast<int>(style.wrap_width * PANGO_SCALE));
    pango_layout_set_alignment(layout.get(), style.horizontal == Horizontal::left     ? PANGO_ALIGN_LEFT
                                             : style.horizontal == Horizontal::center ? PANGO_ALIGN_CENTER
                                                                                      : PANGO_ALIGN_RIGHT);
    if (pango_layout_get_unknown_glyphs_count(layout.get()) > 0)
      throw CanvasError("the font " + std::string(Canvas::family) + " lacks a glyph of \"" + markup + "\"");
    return layout;
  }

 private:
  Typesetter()
      : font_map_(pango_cairo_font_map_new_for_font_type(CAIRO_FONT_TYPE_FT)),
        context_(pango_font_map_create_context(font_map_)) {
    pango_cairo_font_map_set_resolution(PANGO_CAIRO_FONT_MAP(font_map_), 72.0);
    cairo_font_options_t* options = cairo_font_options_create();
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    pango_cairo_context_set_font_options(context_, options);
    cairo_font_options_destroy(options);
    pango_context_set_round_glyph_positions(context_, FALSE);
  }

  void require_family() {
    if (family_checked_) return;
    const std::string found = resolve(Canvas::family);
    if (found != Canvas::family)
      throw CanvasError("the font \"" + std::string(Canvas::family) + "\" is missing, \"" + found +
                        "\" would take its place (Debian package fonts-liberation2)");
    family_checked_ = true;
  }

  PangoFontMap* font_map_;
  PangoContext* context_;
  bool family_checked_ = false;
};

TextExtent extent_of(PangoLayout* layout) {
  PangoRectangle logical;
  pango_layout_get_extents(layout, nullptr, &logical);
  const double ascent = pango_layout_get_baseline(layout) / static_cast<double>(PANGO_SCALE);
  return {logical.width / static_cast<double>(PANGO_SCALE), ascent,
          logical.height / static_cast<double>(PANGO_SCALE) - ascent};
}

/// From the anchor to the upper left corner of the text, before it is turned.
Point corner_offset(const TextExtent& extent, const TextStyle& style) {
  Point offset;
  if (style.horizontal == Horizontal::center) offset.x = -extent.width / 2;
  if (style.horizontal == Horizontal::right) offset.x = -extent.width;
  switch (style.vertical) {
    case Vertical::top:
      break;
    case Vertical::middle:
      offset.y = capital_height / 2 * style.size - extent.ascent;
      break;
    case Vertical::baseline:
      offset.y = -extent.ascent;
      break;
    case Vertical::bottom:
      offset.y = -extent.height();
      break;
  }
  return offset;
}

Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
Point operator*(double s, Point a) { return {s * a.x, s * a.y}; }
bool finite(Point p) { return std::isfinite(p.x) && std::isfinite(p.y); }

/// The part of a segment inside a rectangle, if any (Liang-Barsky); far-away points never reach single
/// precision.
std::optional<std::pair<Point, Point>> clipped(Point a, Point b, const Rectangle& box) {
  const Point d = b - a;
  double enter = 0.0, leave = 1.0;
  const std::array<std::pair<double, double>, 4> sides{
      {{-d.x, a.x - box.left}, {d.x, box.right - a.x}, {-d.y, a.y - box.top}, {d.y, box.bottom - a.y}}};
  for (const auto& [slope, distance] : sides) {
    if (slope == 0.0) {
      if (distance < 0.0) return std::nullopt;
      continue;
    }
    const double at = distance / slope;
    (slope < 0.0 ? enter : leave) = slope < 0.0 ? std::max(enter, at) : std::min(leave, at);
  }
  if (enter > leave) return std::nullopt;
  return std::pair{enter > 0.0 ? a + enter * d : a, leave < 1.0 ? a + leave * d : b};
}

using Path = std::vector<Point>;

/// Unbroken pieces of a polyline inside a rectangle.
std::vector<Path> pieces_inside(const Path& points, const Rectangle& box) {
  std::vector<Path> pieces;
  bool open = false;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const auto part =
        finite(points[i]) && finite(points[i + 1]) ? clipped(points[i], points[i + 1], box) : std::nullopt;
    if (!part) {
      open = false;
      continue;
    }
    if (!open) pieces.push_back({part->first});
    pieces.back().push_back(part->second);
    open = part->second.x == points[i + 1].x && part->second.y == points[i + 1].y;
  }
  return pieces;
}

/// Cuts a path into its dashes.
std::vector<Path> dashed(const Path& path, const std::vector<double>& dash) {
  if (dash.empty()) return {path};
  std::vector<Path> dashes;
  std::size_t entry = 0;
  double left = dash[0];
  bool on = true;
  dashes.push_back({path[0]});
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Point d = path[i + 1] - path[i];
    const double length = std::hypot(d.x, d.y);
    double at = 0.0;
    while (length - at > left) {
      at += left;
      const Point here = path[i] + (at / length) * d;
      if (on)
        dashes.back().push_back(here);
      else
        dashes.push_back({here});
      on = !on;
      entry = (entry + 1) % dash.size();
      left = std::max(dash[entry], 1e-3);
    }
    left -= length - at;
    if (on) dashes.back().push_back(path[i + 1]);
  }
  return dashes;
}

void append_png(png_structp png, png_bytep bytes, png_size_t size) {
  auto* out = static_cast<std::vector<unsigned char>*>(png_get_io_ptr(png));
  out->insert(out->end(), bytes, bytes + size);
}

}  // namespace

Color tint(const Color& color, double whiteness) {
  const auto mix = [whiteness](double c) { return c + (1.0 - c) * whiteness; };
  return {mix(color.red), mix(color.green), mix(color.blue), color.alpha};
}

/// What has been drawn: triangles in subpixels and the texts' coverage.
class Canvas::Sheet {
 public:
  Sheet(double w, double h, double pixels_per_point)
      : width(w), height(h), pixels(pixels_per_point), scale(pixels_per_point * supersampling) {
    if (!(w > 0.0 && h > 0.0 && pixels_per_point > 0.0)) throw CanvasError("a canvas needs a positive size");
    columns = static_cast<int>(std::lround(w * pixels_per_point));
    rows = static_cast<int>(std::lround(h * pixels_per_point));
    clip_box = whole();
  }

  Rectangle whole() const { return {0.0, 0.0, width, height}; }

  PixelBox subpixel_box(const Rectangle& r) const {
    const auto to = [this](double v, int limit) {
      return std::clamp(static_cast<int>(std::lround(std::clamp(v * scale, -1e6, 1e6))), 0, limit);
    };
    const int right = columns * supersampling, bottom = rows * supersampling;
    return {to(r.left, right), to(r.top, bottom), to(r.right, right), to(r.bottom, bottom)};
  }

  void triangle(Point a, Point b, Point c, const Color& color) {
    for (const Point p : {a, b, c}) vertex(p.x * scale, p.y * scale, -1.0, -1.0, color);
  }

  /// Corners in subpixels and texels.
  void textured_quad(const PixelBox& at, int texel_x, int texel_y, const Color& color) {
    const int w = at.right - at.left, h = at.bottom - at.top;
    for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
      vertex(at.left + i * w, at.top + j * h, texel_x + i * w, texel_y + j * h, color);
  }

  void vertex(double x, double y, double u, double v, const Color& color) {
    if (batches.empty() || batch_is_stale) {
      batches.push_back({vertices.size(), 0, subpixel_box(clip_box)});
      batch_is_stale = false;
    }
    const auto f = [](double value) { return static_cast<float>(value); };
    vertices.push_back({f(x), f(y), f(u), f(v), f(color.red), f(color.green), f(color.blue), f(color.alpha)});
    ++batches.back().count;
  }

  void stroke(const Path& path, const Stroke& style) {
    const double half = style.width / 2;
    std::optional<Point> previous;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const Point a = path[i], b = path[i + 1], d = b - a;
      const double length = std::hypot(d.x, d.y);
      if (length < 1e-9) continue;
      const Point n = (half / length) * Point{-d.y, d.x};
      triangle(a + n, b + n, b - n, style.color);
      triangle(a + n, b - n, a - n, style.color);
      if (previous) join(a, *previous, n, style.color);
      previous = n;
    }
  }

  /// Fills the outer wedge between two segments whose normals are `from` and `to`.
  void join(Point at, Point from, Point to, const Color& color) {
    const double cross = from.x * to.y - from.y * to.x, dot = from.x * to.x + from.y * to.y;
    const double turn = std::atan2(cross, dot);
    const double side = turn > 0.0 ? -1.0 : 1.0;
    const int wedges = std::max(1, static_cast<int>(std::ceil(std::abs(turn) / 0.35)));
    const auto rotated = [&](int k) {
      const double angle = turn * k / wedges, c = std::cos(angle), s = std::sin(angle);
      return at + side * Point{c * from.x - s * from.y, s * from.x + c * from.y};
    };
    for (int k = 0; k < wedges; ++k) triangle(at, rotated(k), rotated(k + 1), color);
  }

  double width, height, pixels, scale;
  int columns = 0, rows = 0;
  Rectangle clip_box;
  bool batch_is_stale = false;
  std::vector<Vertex> vertices;
  std::vector<Batch> batches;
  Atlas atlas;
};

Canvas::Canvas(double width, double height, double pixels_per_point)
    : sheet_(std::make_unique<Sheet>(width, height, pixels_per_point)) {}
Canvas::~Canvas() = default;
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;

double Canvas::width() const { return sheet_->width; }
double Canvas::height() const { return sheet_->height; }
int Canvas::pixel_width() const { return sheet_->columns; }
int Canvas::pixel_height() const { return sheet_->rows; }

void Canvas::clip(const Rectangle& rectangle) {
  sheet_->clip_box = rectangle;
  sheet_->batch_is_stale = true;
}

void Canvas::unclip() { clip(sheet_->whole()); }

void Canvas::line(const std::vector<Point>& points, const Stroke& stroke) {
  for (const Path& piece : pieces_inside(points, sheet_->clip_box.grown(stroke.width)))
    for (const Path& dash : dashed(piece, stroke.dash)) sheet_->stroke(dash, stroke);
}

void Canvas::rule(Point from, Point to, double width, const Color& color) {
  const double unit = 1.0 / sheet_->pixels;
  const double thickness = std::max(1.0, std::round(width / unit)) * unit;
  const auto snapped = [unit](double v) { return std::round(v / unit) * unit; };
  Rectangle box{std::min(from.x, to.x), std::min(from.y, to.y), std::max(from.x, to.x),
                std::max(from.y, to.y)};
  if (box.width() < box.height()) {
    box.left = snapped(box.left - thickness / 2);
    box.right = box.left + thickness;
  } else {
    box.top = snapped(box.top - thickness / 2);
    box.bottom = box.top + thickness;
  }
  rectangle(box, color);
}

void Canvas::polygon(const std::vector<Point>& corners, const Color& fill) {
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    if (finite(corners[0]) && finite(corners[i]) && finite(corners[i + 1]))
      sheet_->triangle(corners[0], corners[i], corners[i + 1], fill);
}

void Canvas::rectangle(const Rectangle& r, const Color& fill) {
  const Point upper_left{r.left, r.top}, lower_right{r.right, r.bottom};
  if (!finite(upper_left) || !finite(lower_right)) return;
  sheet_->triangle(upper_left, {r.right, r.top}, lower_right, fill);
  sheet_->triangle(upper_left, lower_right, {r.left, r.bottom}, fill);
}

namespace {

/// Corners of a closed marker of unit radius; sizes are balanced so that shapes look equally large.
Path marker_outline(MarkerShape shape) {
  const auto ring = [](int corners, double radius, double first_angle) {
    Path path;
    for (int i = 0; i < corners; ++i) {
      const double angle = first_angle + 2.0 * std::numbers::pi * i / corners;
      path.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    return path;
  };
  constexpr double quarter = std::numbers::pi / 2;
  switch (shape) {
    case MarkerShape::square:
      return ring(4, 1.27, quarter / 2);
    case MarkerShape::triangle:
      return ring(3, 1.4, -quarter);
    case MarkerShape::diamond:
      return ring(4, 1.3, 0.0);
    default:
      return ring(36, 1.0, 0.0);
  }
}

}  // namespace

void Canvas::marker(Point place, const MarkerStyle& style) {
  if (style.shape == MarkerShape::none || !finite(place)) return;
  if (!sheet_->clip_box.grown(2 * style.size).contains(place)) return;
  const double radius = style.size / 2;
  const Stroke outline{style.edge, style.edge_width, {}};
  if (style.shape == MarkerShape::cross) {
    const double arm = radius * 0.9;
    sheet_->stroke({place + Point{-arm, -arm}, place + Point{arm, arm}}, outline);
    sheet_->stroke({place + Point{-arm, arm}, place + Point{arm, -arm}}, outline);
    return;
  }
  Path corners = marker_outline(style.shape);
  for (Point& corner : corners) corner = place + radius * corner;
  polygon(corners, style.fill);
  // Twice around the first edge, so that the last corner is joined as well.
  corners.push_back(corners[0]);
  corners.push_back(corners[1]);
  sheet_->stroke(corners, outline);
}

TextExtent Canvas::measure(const std::string& markup, const TextStyle& style) {
  const auto layout = Typesetter::of_this_thread().layout(markup, style);
  return extent_of(layout.get());
}

void Canvas::text(Point anchor, const std::string& markup, const TextStyle& style) {
  if (markup.empty() || !finite(anchor)) return;
  const auto layout = Typesetter::of_this_thread().layout(markup, style);
  const TextExtent extent = extent_of(layout.get());
  const Point offset = corner_offset(extent, style);
  const double scale = sheet_->scale;
  // Room for ink beyond the logical extents: italics lean out.
  const double pad = style.size / 2;
  const int across = static_cast<int>(std::ceil((extent.width + 2 * pad) * scale));
  const int down = static_cast<int>(std::ceil((extent.height() + 2 * pad) * scale));
  const int columns = style.upward ? down : across, rows = style.upward ? across : down;
  const Owned<cairo_surface_t> surface(cairo_image_surface_create(CAIRO_FORMAT_A8, columns, rows));
  const Owned<cairo_t> cairo(cairo_create(surface.get()));
  if (style.upward) {
    cairo_translate(cairo.get(), 0.0, rows);
    cairo_rotate(cairo.get(), -std::numbers::pi / 2);
  }
  cairo_scale(cairo.get(), scale, scale);
  // A wrapped layout measures its alignment from the wrap width; its ink starts where its logical box starts.
  PangoRectangle logical;
  pango_layout_get_extents(layout.get(), nullptr, &logical);
  cairo_move_to(cairo.get(), pad - logical.x / static_cast<double>(PANGO_SCALE), pad);
  pango_cairo_show_layout(cairo.get(), layout.get());
  cairo_surface_flush(surface.get());
  if (cairo_status(cairo.get()) != CAIRO_STATUS_SUCCESS)
    throw CanvasError(std::string("text could not be drawn: ") +
                      cairo_status_to_string(cairo_status(cairo.get())));

  const auto [texel_x, texel_y] = sheet_->atlas.place(columns, rows);
  const unsigned char* mask = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int row = 0; row < rows; ++row)
    std::copy_n(
        mask + static_cast<std::ptrdiff_t>(row) * stride, columns,
        sheet_->atlas.coverage.begin() + static_cast<std::ptrdiff_t>(texel_y + row) * atlas_width + texel_x);
  const Point corner = style.upward ? anchor + Point{offset.y - pad, -offset.x + pad - rows / scale}
                                    : anchor + Point{offset.x - pad, offset.y - pad};
  const int left = static_cast<int>(std::lround(corner.x * scale)),
            top = static_cast<int>(std::lround(corner.y * scale));
  sheet_->textured_quad({left, top, left + columns, top + rows}, texel_x, texel_y, style.color);
}

std::vector<unsigned char> Canvas::pixels() const {
  return Renderer::of_this_thread().render(sheet_->columns, sheet_->rows, sheet_->vertices, sheet_->batches,
                                           sheet_->atlas);
}

std::vector<unsigned char> Canvas::png() const {
  std::vector<unsigned char> rgb = pixels();
  std::vector<unsigned char> bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    throw CanvasError("libpng could not encode the picture");
  }
  const auto columns = static_cast<png_uint_32>(sheet_->columns),
             rows = static_cast<png_uint_32>(sheet_->rows);
  png_set_write_fn(png, &bytes, append_png, nullptr);
  png_set_IHDR(png, info, columns, rows, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  // Pixels a metre, so that the picture prints at its size in points.
  const auto density = static_cast<png_uint_32>(std::lround(sheet_->pixels * 72.0 / 0.0254));
  png_set_pHYs(png, info, density, density, PNG_RESOLUTION_METER);
  png_write_info(png, info);
  for (png_uint_32 row = 0; row < rows; ++row)
    png_write_row(png, rgb.data() + static_cast<std::size_t>(row) * columns * 3);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

std::string resolved_family(const std::string& family) {
  return Typesetter::of_this_thread().resolve(family);
}

}  // namespace mpm::reports
