#include "reports/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <variant>

#include "reports/figures.hpp"
#include "reports/legend.hpp"
#include "reports/typography.hpp"

namespace mpm::reports {
namespace {

// Sizes in points.
constexpr double edge_room = 9.0;       // of the symbols outside an edge
constexpr double dimension_row = 15.0;  // from one dimension line to the next
constexpr double arrow_length = 5.0;
constexpr double arrow_half_width = 1.7;
constexpr double words_width = 172.0;  // beside a single drawing
constexpr double gap = 14.0;           // between drawings, and between a drawing and its words
constexpr double entry_gap = 5.0;
constexpr double swatch = 12.0;
constexpr double detail_side = 92.0;
constexpr double tallest_single = 400.0;                     // of a drawing that stands alone
constexpr double tallest_of_rows[] = {240.0, 210.0, 165.0};  // of one among others, by the number of rows
constexpr double finest_pitch = 1.0;  // particles closer than this are drawn as one block
constexpr double finest_cell = 3.0;   // cells smaller than this are not drawn
constexpr double load_length = 13.0;
constexpr double gravity_width = 22.0, gravity_height = 32.0;

constexpr double particle_share = 0.84;  // of its side: the gap lets particles be told apart
constexpr double detail_cells = 4.0;     // along either side of the detail

const Color cell_color{0.86, 0.86, 0.86, 1.0};
const Color rigid_color{0.30, 0.30, 0.30, 1.0};
const Color dimension_color{0.25, 0.25, 0.25, 1.0};
const Color extension_color{0.62, 0.62, 0.62, 1.0};
const Color load_color{0.75, 0.0, 0.15, 1.0};

Color color_of_body(std::size_t number) {
  static const std::array<Color, 6> colors{{{0.79, 0.62, 0.34, 1.0},
                                            {0.27, 0.45, 0.64, 1.0},
                                            {0.45, 0.64, 0.45, 1.0},
                                            {0.72, 0.46, 0.52, 1.0},
                                            {0.55, 0.55, 0.60, 1.0},
                                            {0.50, 0.40, 0.65, 1.0}}};
  return colors[number % colors.size()];
}

// ---- words
// ----------------------------------------------------------------------------------------------------

std::string number(double value) { return number_markup(value, 0); }

std::string pressure_text(double pascals) {
  const double size = std::abs(pascals);
  if (size == 0.0) return "0";
  if (size < 100.0) return number(pascals) + " Pa";
  return size < 2e7 ? number(pascals * 1e-3) + " kPa" : number(pascals * 1e-6) + " MPa";
}

std::string angle_text(double radians) { return number(radians * 180.0 / std::numbers::pi) + "°"; }

std::string elastic_text(double youngs_modulus, double poissons_ratio) {
  return "<i>E</i> = " + pressure_text(youngs_modulus) + ", <i>ν</i> = " + number(poissons_ratio);
}

/// A law's name and its parameters.
struct LawWords {
  std::string name;
  std::vector<std::string> parameters;
};

struct WordsOfLaw {
  LawWords operator()(const LinearElastic& law) const {
    return {"linear elastic (rate form)", {elastic_text(law.youngs_modulus, law.poissons_ratio)}};
  }
  LawWords operator()(const ZhangElastic& law) const {
    return {"Zhang’s law", {"<i>E</i> = " + pressure_text(law.youngs_modulus)}};
  }
  LawWords operator()(const NeoHookean& law) const {
    return {"neo-Hookean", {elastic_text(law.youngs_modulus, law.poissons_ratio)}};
  }
  LawWords operator()(const MohrCoulomb& law) const {
    return {"Mohr–Coulomb",
            {elastic_text(law.youngs_modulus, law.poissons_ratio),
             "<i>φ</i> = " + angle_text(law.friction_angle) + ", <i>c</i> = " + pressure_text(law.cohesion) +
                 ", <i>ψ</i> = " + angle_text(law.dilation_angle)}};
  }
};

std::vector<std::string> density_lines(const Body& body) {
  const std::string start = "<i>ρ</i> = " + number(body.density);
  const auto& ramp = body.density_ramp;
  std::vector<std::string> lines{start + " kg/m³"};
  if (ramp) {
    std::string densities = start;
    for (const DensityStage& stage : ramp->stages) densities += " → " + number(stage.density);
    lines = {densities + " kg/m³,", fmt::format("{} from <i>t</i> = {} s to {} s",
                                                ramp->stages.size() == 1 ? "linear" : "in stages",
                                                number(ramp->start), number(ramp->end()))};
  }
  if (body.inertia) lines.push_back("inertia of " + number(*body.inertia) + " kg/m³");
  return lines;
}

std::string vector_text(const PerAxis& v, double factor) {
  return "(" + number(v[0] * factor) + ", " + number(v[1] * factor) + ")";
}

std::string length_text(double metres, double largest) {
  return largest < 1.0 ? fmt::format("{:.4g} mm", metres * 1e3) : fmt::format("{:.4g} m", metres);
}

std::vector<std::string> words_of_rigid_body(const RigidBody& body) {
  const bool x = body.constrains[0], y = body.constrains[1];
  std::vector<std::string> lines{"<b>" + escaped(body.name) + "</b>, rigid",
                                 x && y ? "rough: holds <i>x</i> and <i>y</i>"
                                 : y    ? "smooth: holds <i>y</i> alone"
                                        : "holds <i>x</i> alone"};
  if (body.velocity[0] != 0.0 || body.velocity[1] != 0.0)
    lines.push_back("velocity " + vector_text(body.velocity, 1e3) + " mm/s");
  if (body.angular_velocity != 0.0) lines.push_back("turns at " + number(body.angular_velocity) + " rad/s");
  return lines;
}

std::string gravity_text(const Gravity& gravity) {
  const double size = std::hypot(gravity.acceleration[0], gravity.acceleration[1]);
  const std::string level = gravity.level == 1.0 ? "" : number(gravity.level) + " × ";
  return "<i>g</i> = " + level + number(size) + " m/s²";
}

// ---- where things stand
// ----------------------------------------------------------------------------------------------

/// An upright box of the scene [m].
struct Box {
  PerAxis lower{}, upper{};
  double side(std::size_t axis) const { return upper[axis] - lower[axis]; }
};

/// What has an extent worth a dimension: bodies and rigid bodies inside the grid.
std::vector<Box> dimensioned_boxes(const Scene& scene) {
  std::vector<Box> boxes;
  const double slack = 1e-9 * scene.cell_size;
  const auto add = [&](const PerAxis& lower, const PerAxis& upper) {
    for (std::size_t a = 0; a < 2; ++a)
      if (lower[a] < scene.grid_lower[a] - slack || upper[a] > scene.grid_upper[a] + slack) return;
    boxes.push_back({lower, upper});
  };
  for (const Body& body : scene.bodies) add(body.lower, body.upper);
  for (const RigidBody& body : scene.rigid_bodies) add(body.lower, body.upper);
  return boxes;
}

/// The extent of a box along `axis`, written on the lower or upper side of the other axis, `row` lines out.
struct Dimension {
  std::size_t axis = 0, side = 0;
  double from = 0.0, to = 0.0;  ///< [m]
  double foot = 0.0;            ///< where the box ends on that side, along the other axis [m]
  std::size_t row = 0;
  bool meets_next =
      false;  ///< another begins in this row where it ends: what does not fit goes to its lower end
};

/// One dimension of each extent, on the side of the model that its box is nearer to; short ones inside.
std::vector<Dimension> dimensions_of(const Scene& scene) {
  const std::vector<Box> boxes = dimensioned_boxes(scene);
  if (boxes.empty()) return {};
  Box all = boxes.front();
  for (const Box& box : boxes)
    for (std::size_t a = 0; a < 2; ++a) {
      all.lower[a] = std::min(all.lower[a], box.lower[a]);
      all.upper[a] = std::max(all.upper[a], box.upper[a]);
    }
  const double slack = 1e-6 * scene.cell_size;
  std::vector<Dimension> dimensions;
  for (const Box& box : boxes)
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const std::size_t other = 1 - axis;
      const double below = box.lower[other] - all.lower[other], above = all.upper[other] - box.upper[other];
      // Of equal distances, a width stands below and a height to the right.
      const std::size_t side = axis == 0 ? (above < below - slack) : !(below < above - slack);
      const bool known = std::any_of(dimensions.begin(), dimensions.end(), [&](const Dimension& d) {
        return d.axis == axis && std::abs(d.from - box.lower[axis]) < slack &&
               std::abs(d.to - box.upper[axis]) < slack;
      });
      if (!known)
        dimensions.push_back({axis, side, box.lower[axis], box.upper[axis],
                              side == 0 ? box.lower[other] : box.upper[other], 0});
    }
  std::stable_sort(dimensions.begin(), dimensions.end(),
                   [](const Dimension& a, const Dimension& b) { return a.to - a.from < b.to - b.from; });
  // Two may stand end to end in a row: each keeps an end for words that do not fit between.
  for (std::size_t i = 0; i < dimensions.size(); ++i) {
    Dimension& d = dimensions[i];
    const auto placed = dimensions.begin() + static_cast<std::ptrdiff_t>(i);
    const auto in_row = [&d](const Dimension& e, std::size_t row) {
      return e.axis == d.axis && e.side == d.side && e.row == row;
    };
    const auto taken = [&](std::size_t row) {
      int met = 0;
      bool crossed = false;
      for (auto e = dimensions.begin(); e != placed; ++e) {
        if (!in_row(*e, row)) continue;
        crossed = crossed || (e->from < d.to - slack && d.from < e->to - slack);
        const bool meets = std::abs(e->to - d.from) < slack || std::abs(e->from - d.to) < slack;
        const bool in_pair = std::any_of(dimensions.begin(), placed, [&](const Dimension& f) {
          return in_row(f, row) && (std::abs(f.to - e->from) < slack || std::abs(f.from - e->to) < slack);
        });
        if (meets) met += in_pair ? 2 : 1;
      }
      return crossed || met > 1;
    };
    while (taken(d.row)) ++d.row;
    for (auto e = dimensions.begin(); e != placed; ++e) {
      if (!in_row(*e, d.row)) continue;
      if (std::abs(e->from - d.to) < slack) d.meets_next = true;
      if (std::abs(d.from - e->to) < slack) e->meets_next = true;
    }
  }
  return dimensions;
}

/// Room outside the grid for the symbols and dimensions of a side [pt].
double room_outside(const Scene& scene, const std::vector<Dimension>& dimensions, std::size_t axis,
                    std::size_t side) {
  std::size_t rows = 0;
  for (const Dimension& d : dimensions)
    if (1 - d.axis == axis && d.side == side) rows = std::max(rows, d.row + 1);
  double room = 2.0 + static_cast<double>(rows) * dimension_row + (rows > 0 ? 3.0 : 0.0);
  if (scene.edges[axis][side] != Condition::free) room += edge_room;
  return room;
}

/// A scene on the sheet.
struct Drawing {
  const Scene* scene = nullptr;
  std::vector<Dimension> dimensions;
  double scale = 1.0;                                       ///< [pt/m]
  Rectangle grid;                                           ///< on the sheet
  double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0;  ///< room outside the grid

  Point at(double x, double y) const {
    return {grid.left + (x - scene->grid_lower[0]) * scale, grid.bottom - (y - scene->grid_lower[1]) * scale};
  }
  Rectangle box(const PerAxis& lower, const PerAxis& upper) const {
    const Point a = at(lower[0], upper[1]), b = at(upper[0], lower[1]);
    return {a.x, a.y, b.x, b.y};
  }
  double largest_side() const {
    return std::max(scene->grid_upper[0] - scene->grid_lower[0], scene->grid_upper[1] - scene->grid_lower[1]);
  }
  double width() const { return left + grid.width() + right; }
  double height() const { return top + grid.height() + bottom; }
};

std::string words_of_dimension(const Drawing& drawing, const Dimension& d) {
  return length_text(d.to - d.from, drawing.largest_side());
}

/// Half of what the words of a dimension cover along its line.
double half_of_words(const Drawing& drawing, const Dimension& d) {
  return text_width(words_of_dimension(drawing, d)) / 2 + 2.0;
}

bool fits_on_line(const Drawing& drawing, const Dimension& d) {
  return (d.to - d.from) * drawing.scale > 2 * half_of_words(drawing, d) + 2 * arrow_length + 2.0;
}

constexpr double beyond_line = 3.0;  // from the end of a line to words that do not fit on it

/// Fits the grid in at most `width` x `tallest`, the room around it being taken.
void fit(Drawing& drawing, double width, double tallest) {
  const Scene& scene = *drawing.scene;
  const double across = scene.grid_upper[0] - scene.grid_lower[0],
               along = scene.grid_upper[1] - scene.grid_lower[1];
  drawing.scale = std::min((width - drawing.left - drawing.right) / across,
                           (tallest - drawing.top - drawing.bottom) / along);
  drawing.grid = {drawing.left, drawing.top, drawing.left + across * drawing.scale,
                  drawing.top + along * drawing.scale};
}

/// The drawing of a scene, its upper left corner at the origin, in at most `width` x `tallest`.
Drawing drawing_of(const Scene& scene, double width, double tallest) {
  if (scene.dimension != 2) throw std::invalid_argument("a model is drawn of a scene in two dimensions");
  Drawing drawing;
  drawing.scene = &scene;
  drawing.dimensions = dimensions_of(scene);
  drawing.left = room_outside(scene, drawing.dimensions, 0, 0);
  drawing.right = room_outside(scene, drawing.dimensions, 0, 1);
  drawing.bottom = room_outside(scene, drawing.dimensions, 1, 0);
  drawing.top = room_outside(scene, drawing.dimensions, 1, 1);
  for (const SurfaceLoad& load : scene.surface_loads) {
    double& room = load.axis == 0 ? (load.side == 0 ? drawing.left : drawing.right)
                                  : (load.side == 0 ? drawing.bottom : drawing.top);
    room = std::max(room, load_length + 4.0);
  }
  fit(drawing, width, tallest);
  // Words beyond the end of their line may need more room, the more the smaller the drawing: twice will do.
  for (int pass = 0; pass < 2; ++pass) {
    Drawing roomier = drawing;
    for (const Dimension& d : drawing.dimensions) {
      if (fits_on_line(drawing, d)) continue;
      const double needed = 2 * half_of_words(drawing, d) + beyond_line + 1.0;
      const double free =
          (d.meets_next ? d.from - scene.grid_lower[d.axis] : scene.grid_upper[d.axis] - d.to) *
          drawing.scale;
      double& room = d.axis == 0 ? (d.meets_next ? roomier.left : roomier.right)
                                 : (d.meets_next ? roomier.bottom : roomier.top);
      room = std::max(room, needed - free);
    }
    drawing = roomier;
    fit(drawing, width, tallest);
  }
  return drawing;
}

void move(Drawing& drawing, double right, double down) {
  drawing.grid.left += right;
  drawing.grid.right += right;
  drawing.grid.top += down;
  drawing.grid.bottom += down;
}

// ---- bodies
// ---------------------------------------------------------------------------------------------------

bool lies_in(const Ring& ring, double x, double y) {
  const double radius = std::hypot(x - ring.center[0], y - ring.center[1]);
  return radius >= ring.inner_radius && radius <= ring.outer_radius;
}

/// Calls `visit(x, y)` for the centre of every particle of a body [m].
template <class Visit>
void for_each_particle(const Body& body, double cell_size, Visit visit) {
  std::array<long long, 2> count{};
  PerAxis pitch{};
  for (std::size_t a = 0; a < 2; ++a) {
    pitch[a] = cell_size / body.particles_per_cell[a];
    count[a] = std::llround((body.upper[a] - body.lower[a]) / pitch[a]);
  }
  for (long long j = 0; j < count[1]; ++j)
    for (long long i = 0; i < count[0]; ++i) {
      const double x = body.lower[0] + (static_cast<double>(i) + 0.5) * pitch[0],
                   y = body.lower[1] + (static_cast<double>(j) + 0.5) * pitch[1];
      if (!body.ring || lies_in(*body.ring, x, y)) visit(x, y);
    }
}

/// Particles as rectangles that leave a gap between them.
void draw_particles(Canvas& canvas, const Drawing& drawing, std::size_t number, const Rectangle& clip,
                    std::vector<Point>* places) {
  const Body& body = drawing.scene->bodies[number];
  const double half_x = drawing.scene->cell_size / body.particles_per_cell[0] / 2 * drawing.scale,
               half_y = drawing.scene->cell_size / body.particles_per_cell[1] / 2 * drawing.scale;
  const Color color = color_of_body(number);
  const double pitch = 2 * std::min(half_x, half_y);
  canvas.clip(clip);
  if (pitch < finest_pitch && !body.ring) {
    canvas.rectangle(drawing.box(body.lower, body.upper), color);
  } else {
    const double share = pitch < finest_pitch ? 1.0 : particle_share;
    for_each_particle(body, drawing.scene->cell_size, [&](double x, double y) {
      const Point p = drawing.at(x, y);
      if (!clip.grown(half_x + half_y).contains(p)) return;
      canvas.rectangle(
          {p.x - share * half_x, p.y - share * half_y, p.x + share * half_x, p.y + share * half_y}, color);
      if (places) places->push_back(p);
    });
  }
  canvas.unclip();
}

void draw_outline(Canvas& canvas, const Rectangle& r, double width, const Color& color) {
  canvas.rule({r.left, r.top}, {r.right, r.top}, width, color);
  canvas.rule({r.left, r.bottom}, {r.right, r.bottom}, width, color);
  canvas.rule({r.left, r.top}, {r.left, r.bottom}, width, color);
  canvas.rule({r.right, r.top}, {r.right, r.bottom}, width, color);
}

/// Slanting lines across a rectangle, cut at `clip`.
void hatch(Canvas& canvas, const Rectangle& r, const Rectangle& clip, double pitch, const Stroke& stroke) {
  const Rectangle cut{std::max(r.left, clip.left), std::max(r.top, clip.top), std::min(r.right, clip.right),
                      std::min(r.bottom, clip.bottom)};
  if (cut.width() <= 0.0 || cut.height() <= 0.0) return;
  canvas.clip(cut);
  for (double x = cut.left - cut.height(); x < cut.right; x += pitch)
    canvas.line({{x, cut.bottom}, {x + cut.height(), cut.top}}, stroke);
  canvas.unclip();
}

void draw_rigid(Canvas& canvas, const Rectangle& box, const Rectangle& clip) {
  canvas.clip(clip);
  canvas.rectangle(box, Color{0.93, 0.93, 0.93, 1.0});
  canvas.unclip();
  hatch(canvas, box, clip, 4.0, {rigid_color, 0.7, {}});
  canvas.clip(clip.grown(0.5));
  draw_outline(canvas, box, 1.0, rigid_color);
  canvas.unclip();
}

void draw_cells(Canvas& canvas, const Drawing& drawing, const Rectangle& clip) {
  const Scene& scene = *drawing.scene;
  if (scene.cell_size * drawing.scale < finest_cell) return;
  canvas.clip(clip);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto cells = std::llround((scene.grid_upper[axis] - scene.grid_lower[axis]) / scene.cell_size);
    for (long long k = 0; k <= cells; ++k) {
      const double at = scene.grid_lower[axis] + static_cast<double>(k) * scene.cell_size;
      const Point p = drawing.at(axis == 0 ? at : scene.grid_lower[0], axis == 1 ? at : scene.grid_lower[1]);
      if (axis == 0)
        canvas.rule({p.x, drawing.grid.top}, {p.x, drawing.grid.bottom}, 0.4, cell_color);
      else
        canvas.rule({drawing.grid.left, p.y}, {drawing.grid.right, p.y}, 0.4, cell_color);
    }
  }
  canvas.unclip();
}

// ---- edges, loads, gravity
// ------------------------------------------------------------------------------------------

/// The band outside an edge in which its symbol stands.
Rectangle band_outside(const Rectangle& grid, std::size_t axis, std::size_t side, double thickness) {
  if (axis == 0)
    return side == 0 ? Rectangle{grid.left - thickness, grid.top, grid.left, grid.bottom}
                     : Rectangle{grid.right, grid.top, grid.right + thickness, grid.bottom};
  return side == 0 ? Rectangle{grid.left, grid.bottom, grid.right, grid.bottom + thickness}
                   : Rectangle{grid.left, grid.top - thickness, grid.right, grid.top};
}

/// A fixed edge is hatched; a roller stands on wheels between two lines.
void draw_condition(Canvas& canvas, const Rectangle& band, bool upright, bool outer_is_upper,
                    Condition condition) {
  if (condition == Condition::free) return;
  if (condition == Condition::fixed) {
    hatch(canvas, band, band, 4.0, {ink, 0.6, {}});
    return;
  }
  const double length = upright ? band.height() : band.width(),
               thickness = upright ? band.width() : band.height();
  const double diameter = thickness - 2.0;
  const int wheels = std::max(1, static_cast<int>(length / (2.6 * diameter)));
  for (int k = 0; k < wheels; ++k) {
    const double along = (k + 0.5) * length / wheels;
    const double across = outer_is_upper ? diameter / 2 : thickness - diameter / 2;
    const Point center =
        upright ? Point{band.left + across, band.top + along} : Point{band.left + along, band.top + across};
    canvas.marker(center, {MarkerShape::circle, diameter - 0.7, white, ink, 0.6});
  }
  const double line = outer_is_upper ? diameter + 0.6 : thickness - diameter - 0.6;
  if (upright)
    canvas.rule({band.left + line, band.top}, {band.left + line, band.bottom}, 0.6, ink);
  else
    canvas.rule({band.left, band.top + line}, {band.right, band.top + line}, 0.6, ink);
}

void draw_edges(Canvas& canvas, const Drawing& drawing) {
  for (std::size_t axis = 0; axis < 2; ++axis)
    for (std::size_t side = 0; side < 2; ++side) {
      const Condition condition = drawing.scene->edges[axis][side];
      const double thickness = condition == Condition::fixed ? 6.0 : 7.0;
      const bool outwards = axis == 0 ? side == 1 : side == 0;
      draw_condition(canvas, band_outside(drawing.grid, axis, side, thickness), axis == 0, outwards,
                     condition);
      const Rectangle edge = band_outside(drawing.grid, axis, side, 0.0);
      const bool held = condition != Condition::free;
      canvas.rule({edge.left, edge.top}, {edge.right, edge.bottom}, held ? 1.2 : 0.5,
                  held ? ink : extension_color);
    }
}

/// An arrow whose head ends at `to`.
void draw_arrow(Canvas& canvas, Point from, Point to, double width, const Color& color, double size = 1.0) {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  if (!(length > 0.0)) return;
  const double ux = (to.x - from.x) / length, uy = (to.y - from.y) / length;
  const double head = arrow_length * size, half = arrow_half_width * size;
  const Point neck{to.x - head * ux, to.y - head * uy};
  canvas.line({from, neck}, {color, width, {}});
  canvas.polygon({to, {neck.x - half * uy, neck.y + half * ux}, {neck.x + half * uy, neck.y - half * ux}},
                 color);
}

void draw_loads(Canvas& canvas, const Drawing& drawing) {
  const Scene& scene = *drawing.scene;
  for (const SurfaceLoad& load : scene.surface_loads) {
    const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                   [&load](const Body& b) { return b.name == load.body; });
    const double size = std::hypot(load.traction[0], load.traction[1]);
    if (body == scene.bodies.end() || !(size > 0.0)) continue;
    const double edge = load.side == 0 ? body->lower[static_cast<std::size_t>(load.axis)]
                                       : body->upper[static_cast<std::size_t>(load.axis)];
    const Point first = load.axis == 0 ? drawing.at(edge, load.begin) : drawing.at(load.begin, edge),
                last = load.axis == 0 ? drawing.at(edge, load.end) : drawing.at(load.end, edge);
    const int arrows = std::max(1, static_cast<int>(std::hypot(last.x - first.x, last.y - first.y) / 11.0));
    // What is pressed has the arrow's head on it, what is pulled its tail.
    const Point along{load.traction[0] / size * load_length, -load.traction[1] / size * load_length};
    const double outward = (load.side == 0 ? -1.0 : 1.0) * load.traction[static_cast<std::size_t>(load.axis)];
    for (int k = 0; k < arrows; ++k) {
      const double f = (k + 0.5) / arrows;
      const Point foot{first.x + f * (last.x - first.x), first.y + f * (last.y - first.y)};
      const Point back{foot.x - along.x, foot.y - along.y}, out{foot.x + along.x, foot.y + along.y};
      if (outward > 0.0)
        draw_arrow(canvas, foot, out, 0.8, load_color);
      else
        draw_arrow(canvas, back, foot, 0.8, load_color);
    }
  }
}

std::vector<Rectangle> solid_boxes(const Drawing& drawing) {
  std::vector<Rectangle> boxes;
  for (const Body& body : drawing.scene->bodies) boxes.push_back(drawing.box(body.lower, body.upper));
  for (const RigidBody& body : drawing.scene->rigid_bodies)
    boxes.push_back(drawing.box(body.lower, body.upper));
  return boxes;
}

/// A place for the arrow of gravity inside the grid where nothing else stands; its upper corners come first.
std::optional<Rectangle> place_of_gravity(const Drawing& drawing) {
  const std::vector<Rectangle> solids = solid_boxes(drawing);
  const Rectangle& grid = drawing.grid;
  constexpr double inset = 5.0;
  const double top = grid.top + inset;
  for (const double left :
       {grid.right - inset - gravity_width, grid.left + inset, grid.center().x - gravity_width / 2}) {
    const Rectangle place{left, top, left + gravity_width, top + gravity_height};
    // Loads press from outside: their arrows need room too.
    const bool free =
        place.left > grid.left && place.right < grid.right && place.bottom < grid.bottom &&
        std::none_of(solids.begin(), solids.end(), [&](const Rectangle& s) {
          return place.intersects(s.grown(drawing.scene->surface_loads.empty() ? 1.0 : load_length + 1.0));
        });
    if (free) return place;
  }
  return std::nullopt;
}

bool has_gravity(const Gravity& gravity) {
  return gravity.level != 0.0 && (gravity.acceleration[0] != 0.0 || gravity.acceleration[1] != 0.0);
}

void draw_gravity(Canvas& canvas, const Gravity& gravity, const Rectangle& place) {
  const double size = std::hypot(gravity.acceleration[0], gravity.acceleration[1]);
  const double half = gravity_height / 2 - 3.0;
  const Point middle{place.left + 8.0, place.center().y};
  const Point along{gravity.acceleration[0] / size * half, -gravity.acceleration[1] / size * half};
  canvas.rectangle(place, white);
  draw_arrow(canvas, {middle.x - along.x, middle.y - along.y}, {middle.x + along.x, middle.y + along.y}, 1.3,
             ink, 1.7);
  canvas.text({place.right - 2.0, place.center().y}, "<i>g</i>",
              text_style(Horizontal::right, Vertical::middle, title_size));
}

// ---- dimensions
// ---------------------------------------------------------------------------------------------------

/// Words that do not fit between the ends of the line stand beyond one of them.
void draw_dimension(Canvas& canvas, const Drawing& drawing, const Dimension& d, Layout::Panel& layout) {
  const Scene& scene = *drawing.scene;
  const std::size_t across = 1 - d.axis;
  const bool level = d.axis == 0;
  const Rectangle edge = band_outside(drawing.grid, across, d.side, 0.0);
  const double sense = level ? (d.side == 0 ? 1.0 : -1.0) : (d.side == 0 ? -1.0 : 1.0);
  const double symbols = scene.edges[across][d.side] == Condition::free ? 0.0 : edge_room;
  const double out = symbols + 2.0 + (static_cast<double>(d.row) + 1.0) * dimension_row - 3.0;
  const double line = (level ? edge.top : edge.left) + sense * out;
  const Point a0 = level ? drawing.at(d.from, d.foot) : drawing.at(d.foot, d.from),
              b0 = level ? drawing.at(d.to, d.foot) : drawing.at(d.foot, d.to);
  const Point a = level ? Point{a0.x, line} : Point{line, a0.y},
              b = level ? Point{b0.x, line} : Point{line, b0.y};
  const auto extension = [&](Point foot, Point end) {
    const Point start = level ? Point{foot.x, foot.y + 1.5 * sense} : Point{foot.x + 1.5 * sense, foot.y};
    const Point stop = level ? Point{end.x, end.y + 3.0 * sense} : Point{end.x + 3.0 * sense, end.y};
    canvas.rule(start, stop, 0.4, extension_color);
  };
  extension(a0, a);
  extension(b0, b);
  const Point middle{(a.x + b.x) / 2, (a.y + b.y) / 2};
  draw_arrow(canvas, middle, a, 0.6, dimension_color);
  draw_arrow(canvas, middle, b, 0.6, dimension_color);
  const std::string words = words_of_dimension(drawing, d);
  const double half = half_of_words(drawing, d);
  const double away = (half + beyond_line) * (d.meets_next ? -1.0 : 1.0);
  const Point end = d.meets_next ? a : b;
  const Point beyond = level ? Point{end.x + away, line} : Point{line, end.y - away};
  const Point place = fits_on_line(drawing, d) ? middle : beyond;
  TextStyle style = text_style(Horizontal::center, Vertical::middle, type_size, dimension_color);
  style.upward = !level;
  const Rectangle covered = level ? Rectangle{place.x - half, place.y - 5.0, place.x + half, place.y + 5.0}
                                  : Rectangle{place.x - 5.0, place.y - half, place.x + 5.0, place.y + half};
  canvas.rectangle(covered, white);
  canvas.text(place, words, style);
  layout.annotations.push_back(covered);
}

// ---- the words beside a drawing
// --------------------------------------------------------------------------------------

/// A sample and the lines that explain it.
struct Entry {
  enum class Sample { body, rigid, load, roller, fixed, cell, gravity } sample = Sample::body;
  std::size_t number = 0;  ///< of the body
  std::vector<std::string> lines;
  PerAxis direction{};  ///< of gravity, upwards positive, of length one

  friend bool operator==(const Entry&, const Entry&) = default;
};

std::vector<Entry> entries_of(const Scene& scene) {
  using Sample = Entry::Sample;
  std::vector<Entry> entries;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    entries.push_back({Sample::body, b, words_of_body(scene.bodies[b], scene), {}});
  for (const RigidBody& body : scene.rigid_bodies)
    entries.push_back({Sample::rigid, 0, words_of_rigid_body(body), {}});
  for (const SurfaceLoad& load : scene.surface_loads)
    entries.push_back({Sample::load,
                       0,
                       {fmt::format("load ({}, {}) on <b>{}</b>", pressure_text(load.traction[0]),
                                    pressure_text(load.traction[1]), escaped(load.body))},
                       {}});
  std::size_t particles = 0;
  for (const Body& body : scene.bodies) particles += particle_count(body, scene.cell_size);
  entries.push_back({Sample::cell,
                     0,
                     {fmt::format("cells of {:.4g} mm, {} particles", scene.cell_size * 1e3, particles)},
                     {}});
  if (has_gravity(scene.gravity)) {
    const PerAxis& g = scene.gravity.acceleration;
    const double size = std::hypot(g[0], g[1]);
    entries.push_back({Sample::gravity, 0, {gravity_text(scene.gravity)}, {g[0] / size, g[1] / size}});
  }
  const auto any = [&scene](Condition condition) {
    return std::any_of(scene.edges.begin(), scene.edges.end(), [condition](const auto& sides) {
      return sides[0] == condition || sides[1] == condition;
    });
  };
  if (any(Condition::roller)) entries.push_back({Sample::roller, 0, {"roller: slides along the edge"}, {}});
  if (any(Condition::fixed)) entries.push_back({Sample::fixed, 0, {"fixed edge"}, {}});
  return entries;
}

TextStyle words_style(double width) {
  TextStyle style = text_style(Horizontal::left, Vertical::top);
  style.wrap_width = width - swatch - 5.0;
  return style;
}

double lines_height(const Entry& entry, double width) {
  double height = 0.0;
  for (const std::string& line : entry.lines) height += Canvas::measure(line, words_style(width)).height();
  return height;
}

double words_height(const std::vector<Entry>& entries, double width) {
  double height = 0.0;
  for (const Entry& entry : entries) height += lines_height(entry, width) + entry_gap;
  return height;
}

void draw_sample(Canvas& canvas, const Entry& entry, const Rectangle& box) {
  using Sample = Entry::Sample;
  if (entry.sample == Sample::body) {
    canvas.rectangle(box, color_of_body(entry.number));
  } else if (entry.sample == Sample::rigid) {
    draw_rigid(canvas, box, box);
  } else if (entry.sample == Sample::load) {
    draw_arrow(canvas, {box.center().x, box.top}, {box.center().x, box.bottom}, 0.8, load_color);
  } else if (entry.sample == Sample::gravity) {
    const Point middle = box.center();
    const double half = box.height() / 2;
    const auto at = [&](double f) {
      return Point{middle.x + f * half * entry.direction[0], middle.y - f * half * entry.direction[1]};
    };
    draw_arrow(canvas, at(-1.0), at(1.0), 1.0, ink);
  } else if (entry.sample == Sample::cell) {
    canvas.rectangle(box, white);
    draw_outline(canvas, box, 0.6, extension_color);
  } else {
    const bool fixed = entry.sample == Sample::fixed;
    const Rectangle band{box.left, box.center().y - 3.0, box.right, box.center().y + (fixed ? 3.0 : 4.0)};
    canvas.rule({band.left, band.top}, {band.right, band.top}, 1.2, ink);
    draw_condition(canvas, band, false, true, fixed ? Condition::fixed : Condition::roller);
  }
}

/// Writes the entries from `top` down.
void draw_words(Canvas& canvas, const std::vector<Entry>& entries, double left, double top, double width,
                Layout::Panel& layout) {
  for (const Entry& entry : entries) {
    draw_sample(canvas, entry, {left, top + 1.0, left + swatch, top + 10.0});
    const double begin = top;
    double widest = 0.0;
    for (const std::string& line : entry.lines) {
      const TextExtent extent = Canvas::measure(line, words_style(width));
      canvas.text({left + swatch + 5.0, top}, line, words_style(width));
      widest = std::max(widest, extent.width);
      top += extent.height();
    }
    layout.annotations.push_back({left, begin, left + swatch + 5.0 + widest, top});
    top += entry_gap;
  }
}

// ---- the detail
// ---------------------------------------------------------------------------------------------------

/// The cells around the corner where the last thing placed meets the rest [m].
Box detail_of(const Scene& scene) {
  PerAxis corner = scene.grid_upper;
  if (!scene.rigid_bodies.empty())
    corner = {scene.rigid_bodies.back().upper[0], scene.rigid_bodies.back().lower[1]};
  else if (scene.bodies.size() > 1)
    corner = {scene.bodies.back().upper[0], scene.bodies.back().lower[1]};
  else if (!scene.bodies.empty())
    corner = scene.bodies.front().upper;
  Box box;
  for (std::size_t a = 0; a < 2; ++a) {
    const double cells = std::round((scene.grid_upper[a] - scene.grid_lower[a]) / scene.cell_size);
    const double first = std::round((corner[a] - scene.grid_lower[a]) / scene.cell_size) - detail_cells / 2;
    const double begin = std::clamp(first, 0.0, std::max(0.0, cells - detail_cells));
    box.lower[a] = scene.grid_lower[a] + begin * scene.cell_size;
    box.upper[a] = box.lower[a] + std::min(detail_cells, cells) * scene.cell_size;
  }
  return box;
}

/// A few cells magnified, with their particles and the size of one.
void draw_detail(Canvas& canvas, const Drawing& model, double left, double top, Layout::Panel& layout) {
  const Scene& scene = *model.scene;
  const Box detail = detail_of(scene);
  Drawing close = model;
  close.scale = detail_side / std::max(detail.side(0), detail.side(1));
  const Rectangle frame{left, top, left + detail.side(0) * close.scale, top + detail.side(1) * close.scale};
  const double down = (detail.lower[1] - scene.grid_lower[1]) * close.scale,
               aside = (detail.lower[0] - scene.grid_lower[0]) * close.scale;
  close.grid.left = frame.left - aside;
  close.grid.bottom = frame.bottom + down;
  close.grid.right = close.grid.left + (scene.grid_upper[0] - scene.grid_lower[0]) * close.scale;
  close.grid.top = close.grid.bottom - (scene.grid_upper[1] - scene.grid_lower[1]) * close.scale;
  canvas.rectangle(frame, white);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) draw_particles(canvas, close, b, frame, nullptr);
  for (const RigidBody& body : scene.rigid_bodies)
    draw_rigid(canvas, close.box(body.lower, body.upper), frame);
  canvas.clip(frame);
  for (double k = 0.0; k <= detail_cells; k += 1.0) {
    const double step = k * scene.cell_size * close.scale;
    canvas.rule({frame.left + step, frame.top}, {frame.left + step, frame.bottom}, 0.6, dimension_color);
    canvas.rule({frame.left, frame.top + step}, {frame.right, frame.top + step}, 0.6, dimension_color);
  }
  canvas.unclip();
  draw_outline(canvas, frame, 1.0, ink);
  draw_outline(canvas, model.box(detail.lower, detail.upper), 1.0, ink);
  const double cell = scene.cell_size * close.scale, line = frame.bottom + 9.0;
  for (const double x : {frame.left, frame.left + cell})
    canvas.rule({x, frame.bottom + 1.5}, {x, line + 3.0}, 0.4, extension_color);
  draw_arrow(canvas, {frame.left + cell / 2, line}, {frame.left, line}, 0.6, dimension_color);
  draw_arrow(canvas, {frame.left + cell / 2, line}, {frame.left + cell, line}, 0.6, dimension_color);
  const std::string words = fmt::format("{:.4g} mm, one cell", scene.cell_size * 1e3);
  canvas.text({frame.left + cell + 5.0, line}, words, text_style(Horizontal::left, Vertical::middle));
  layout.annotations.push_back(
      {frame.left + cell + 4.0, line - 5.0, frame.left + cell + 5.0 + text_width(words), line + 5.0});
  TextStyle beside = text_style(Horizontal::left, Vertical::top, type_size, muted);
  beside.wrap_width = words_width - frame.width() - 8.0;
  const std::string note = "the framed part, magnified: cells and particles";
  const TextExtent extent = Canvas::measure(note, beside);
  canvas.text({frame.right + 8.0, frame.top}, note, beside);
  layout.annotations.push_back(
      {frame.right + 8.0, frame.top, frame.right + 8.0 + extent.width, frame.top + extent.height()});
}

constexpr double detail_height = detail_side + 22.0;

// ---- the sheet
// ---------------------------------------------------------------------------------------------------

/// A panel in its place.
struct Placed {
  const ModelPanel* panel = nullptr;
  Drawing drawing;
  std::vector<Entry> entries;
  double title_top = 0.0, left = 0.0;
  double words_left = 0.0, words_top = 0.0, words_room = 0.0;
  Point detail = {};  ///< its upper left corner, if it is drawn
};

constexpr double title_room = 16.0;

std::string tagged_title(const ModelPlot& plot, std::size_t number) {
  const std::string& title = plot.panels[number].title;
  if (plot.panels.size() < 2) return title;
  return fmt::format("<b>({})</b> {}", static_cast<char>('a' + number % 26), title);
}

/// One drawing with its words to the right. Gives the lower edge.
double place_single(const ModelPlot& plot, std::vector<Placed>& placed) {
  const ModelPanel& panel = plot.panels.front();
  const double room = plot.width - 2 * outer_margin - gap - words_width;
  Placed p{&panel, drawing_of(panel.scene, room, tallest_single), entries_of(panel.scene)};
  p.title_top = outer_margin;
  const double top = outer_margin + (panel.title.empty() ? 0.0 : title_room);
  p.left = outer_margin;
  // The sheet keeps its width; a slim model stands in the middle of its part.
  move(p.drawing, outer_margin + (room - p.drawing.width()) / 2, top);
  p.words_left = outer_margin + room + gap;
  p.words_room = words_width;
  const double written = words_height(p.entries, words_width), drawn = p.drawing.height();
  // The detail stands over the words, or below a flat model if that makes the picture shorter.
  const bool flat =
      std::max(drawn + gap + detail_height, written) < std::max(drawn, detail_height + 6.0 + written);
  p.detail = flat ? Point{p.drawing.grid.left, top + drawn + gap} : Point{p.words_left, top};
  p.words_top = flat ? top : top + detail_height + 6.0;
  const double bottom = std::max(flat ? p.detail.y + detail_height : top + drawn, p.words_top + written);
  placed.push_back(std::move(p));
  return bottom;
}

/// The entries that all panels share, taken out of each.
std::vector<Entry> shared_entries(std::vector<std::vector<Entry>>& panels) {
  std::vector<Entry> shared;
  for (const Entry& entry : panels.front())
    if (std::all_of(panels.begin(), panels.end(), [&entry](const std::vector<Entry>& entries) {
          return std::find(entries.begin(), entries.end(), entry) != entries.end();
        }))
      shared.push_back(entry);
  for (std::vector<Entry>& entries : panels)
    std::erase_if(entries, [&shared](const Entry& entry) {
      return std::find(shared.begin(), shared.end(), entry) != shared.end();
    });
  return shared;
}

/// Words that are written once for all panels, in two columns.
struct SharedWords {
  std::array<std::vector<Entry>, 2> columns;
  double top = 0.0, room = 0.0;
};

/// Two drawings a row, the words of each below it and those of all at the foot. Gives the lower edge.
double place_many(const ModelPlot& plot, std::vector<Placed>& placed, SharedWords& shared) {
  const double room = (plot.width - 2 * outer_margin - gap) / 2;
  const std::size_t rows = (plot.panels.size() + 1) / 2;
  const double tallest = tallest_of_rows[std::min(rows, std::size(tallest_of_rows)) - 1];
  std::vector<std::vector<Entry>> entries;
  for (const ModelPanel& panel : plot.panels) entries.push_back(entries_of(panel.scene));
  const std::vector<Entry> common = shared_entries(entries);
  double top = outer_margin;
  for (std::size_t first = 0; first < plot.panels.size(); first += 2) {
    const std::size_t last = std::min(first + 2, plot.panels.size());
    double drawn = 0.0, written = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      Placed p{&plot.panels[i], drawing_of(plot.panels[i].scene, room, tallest), entries[i]};
      p.title_top = top;
      p.left = p.words_left = outer_margin + static_cast<double>(i - first) * (room + gap);
      p.words_room = room;
      move(p.drawing, p.left, top + title_room);
      drawn = std::max(drawn, p.drawing.height());
      written = std::max(written, words_height(p.entries, room));
      placed.push_back(std::move(p));
    }
    for (std::size_t i = first; i < last; ++i) placed[i].words_top = top + title_room + drawn + 6.0;
    top += title_room + drawn + 6.0 + written + 8.0;
  }
  shared.top = top;
  shared.room = room;
  const double whole = words_height(common, room);
  double used = 0.0;
  for (const Entry& entry : common) {
    const double height = words_height({entry}, room);
    // The left column takes the larger half.
    shared.columns[used + height / 2 < whole / 2 || used <= 0.0 ? 0 : 1].push_back(entry);
    used += height;
  }
  return top + std::max(words_height(shared.columns[0], room), words_height(shared.columns[1], room));
}

Layout::Panel draw_panel(Canvas& canvas, const Placed& placed, const std::string& title, bool detailed) {
  const Drawing& drawing = placed.drawing;
  const Scene& scene = *drawing.scene;
  Layout::Panel layout;
  layout.frame = drawing.grid;
  canvas.text({placed.left, placed.title_top + 9.0}, title,
              text_style(Horizontal::left, Vertical::baseline, title_size));
  draw_cells(canvas, drawing, drawing.grid.grown(1.0));
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    draw_particles(canvas, drawing, b, drawing.grid.grown(1.0), &layout.points);
  for (const RigidBody& body : scene.rigid_bodies)
    draw_rigid(canvas, drawing.box(body.lower, body.upper), drawing.grid);
  draw_edges(canvas, drawing);
  for (const Dimension& d : drawing.dimensions) draw_dimension(canvas, drawing, d, layout);
  draw_loads(canvas, drawing);
  if (has_gravity(scene.gravity))
    if (const auto place = place_of_gravity(drawing)) {
      draw_gravity(canvas, scene.gravity, *place);
      layout.annotations.push_back(*place);
    }
  if (detailed) draw_detail(canvas, drawing, placed.detail.x, placed.detail.y, layout);
  draw_words(canvas, placed.entries, placed.words_left, placed.words_top, placed.words_room, layout);
  return layout;
}

}  // namespace

std::size_t particle_count(const Body& body, double cell_size) {
  std::size_t count = 0;
  for_each_particle(body, cell_size, [&count](double, double) { ++count; });
  return count;
}

std::vector<std::string> words_of_body(const Body& body, const Scene& scene) {
  const LawWords law = std::visit(WordsOfLaw{}, body.material);
  std::vector<std::string> lines{"<b>" + escaped(body.name) + "</b>, " + law.name};
  lines.insert(lines.end(), law.parameters.begin(), law.parameters.end());
  for (std::string& line : density_lines(body)) lines.push_back(std::move(line));
  if (body.initial_stress) {
    const auto* at_rest = std::get_if<GeostaticStress>(&*body.initial_stress);
    lines.push_back(at_rest ? "at rest, <i>K</i><sub>0</sub> = " + number(at_rest->k0)
                            : std::string("stressed evenly at the start"));
  }
  if (body.velocity[0] != 0.0 || body.velocity[1] != 0.0)
    lines.push_back("starts at " + vector_text(body.velocity, 1.0) + " m/s");
  lines.push_back(fmt::format("{} particles, {} × {} a cell", particle_count(body, scene.cell_size),
                              body.particles_per_cell[0], body.particles_per_cell[1]));
  return lines;
}

Picture draw(const ModelPlot& plot, double pixels_per_point) {
  std::vector<Placed> placed;
  SharedWords shared;
  double bottom = outer_margin;
  const bool single = plot.panels.size() == 1;
  if (!plot.panels.empty()) bottom = single ? place_single(plot, placed) : place_many(plot, placed, shared);
  const double notes_top = bottom + 3.0;
  const TextStyle notes = note_style(plot.width - 2 * outer_margin);
  double height = notes_top;
  for (const std::string& note : plot.notes) height += Canvas::measure(note, notes).height() + 1.0;
  height += plot.stamp.empty() ? 4.0 : stamp_size + 8.0;

  Picture picture{Canvas(plot.width, height, pixels_per_point), {}};
  for (std::size_t i = 0; i < placed.size(); ++i)
    picture.layout.panels.push_back(draw_panel(picture.canvas, placed[i], tagged_title(plot, i), single));
  for (std::size_t c = 0; c < 2 && !placed.empty(); ++c)
    draw_words(picture.canvas, shared.columns[c], outer_margin + static_cast<double>(c) * (shared.room + gap),
               shared.top, shared.room, picture.layout.panels.front());
  double top = notes_top;
  for (const std::string& note : plot.notes) {
    picture.canvas.text({outer_margin, top}, note, notes);
    top += Canvas::measure(note, notes).height() + 1.0;
  }
  picture.canvas.text({plot.width - outer_margin, picture.canvas.height() - 4.0}, plot.stamp,
                      text_style(Horizontal::right, Vertical::baseline, stamp_size, stamp_color));
  return picture;
}

}  // namespace mpm::reports
