#include "vv/collapse_norms.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <unordered_map>
#include <vector>

#include "vv/judging.hpp"

namespace mpm::vv {
namespace {

/// Standard deviation of what may lie anywhere within a width of one.
const double evenly_spread = 1 / std::sqrt(12.0);
/// The steepest slope along which tops are moved: a front that is steeper is a step, not a slope.
constexpr double steepest = 1.0;
/// Of a duration: the share of the potential energy that has been released by then. The last hundredth is
/// left to what still trickles.
constexpr double released_share = 0.99;

bool is_wall(Condition condition) { return condition != Condition::free; }

/// Whether two lengths are one, to a rounding of either.
bool same(double a, double b, double cell_size) { return std::abs(a - b) < 1e-6 * cell_size; }

bool falls_by_weight_alone(const Scene& scene) {
  const Gravity& gravity = scene.gravity;
  return scene.rigid_bodies.empty() && scene.surface_loads.empty() && !scene.driven_motion &&
         gravity.acceleration[0] == 0.0 && gravity.acceleration[1] * gravity.level < 0.0;
}

}  // namespace

std::string why_no_collapse(const Scene& scene) {
  if (scene.dimension != 2) return "two dimensions";
  if (scene.bodies.size() != 1) return "a single block";
  const Body& block = scene.bodies[0];
  if (block.ring || block.density_ramp) return "a plain block";
  if (!std::holds_alternative<MohrCoulomb>(block.material)) return "a block of Mohr-Coulomb's law";
  if (scene.edges[1][0] != Condition::fixed || !same(block.lower[1], scene.grid_lower[1], scene.cell_size))
    return "a block that stands on a fixed lower edge of the grid";
  if (!is_wall(scene.edges[0][0]) || !same(block.lower[0], scene.grid_lower[0], scene.cell_size))
    return "a block that begins at a wall, the grid's lower edge in x";
  if (!(block.upper[0] < scene.grid_upper[0] - scene.cell_size / 2))
    return "room for the block to fall into, beyond its upper edge in x";
  return falls_by_weight_alone(scene) ? "" : "gravity straight down and nothing else that acts";
}

Deposit::Deposit(const Scene& scene, const ParticleFields& fields)
    : block_(&scene.bodies.at(0)),
      fields_(&fields),
      cell_(scene.cell_size),
      cells_(static_cast<std::size_t>(std::llround((scene.grid_upper[0] - scene.grid_lower[0]) / cell_))) {
  for (std::size_t axis = 0; axis < 2; ++axis) spacing_[axis] = cell_ / block_->particles_per_cell[axis];
  particles_ = connected_with_corner();
}

double Deposit::travel(std::size_t p) const {
  return std::hypot(fields_->displacement[2 * p], fields_->displacement[2 * p + 1]);
}

/// Points, which have no extent of their own, stand for what they stood for at the start.
double Deposit::half_height(std::size_t p) const {
  const double own = fields_->half_size[2 * p + 1];
  return own > 0.0 ? own : spacing_[1] / 2;
}

double Deposit::area_at_start() const {
  return std::accumulate(fields_->initial_volume.begin(), fields_->initial_volume.end(), 0.0);
}

std::vector<std::size_t> Deposit::connected_with_corner() const {
  const std::size_t count = fields_->mass.size();
  const auto square = [&](std::size_t p, int right, int up) {
    const auto along = [&](std::size_t axis) {
      return static_cast<std::int64_t>(std::floor(place(p, axis) / cell_));
    };
    return (along(0) + right) * (std::int64_t{1} << 32) + (along(1) + up);
  };
  const auto distance_from = [&](std::size_t p, double x, double y) {
    return std::hypot(place(p, 0) - x, place(p, 1) - y);
  };
  std::size_t nearest = 0;
  for (std::size_t p = 1; p < count; ++p) {
    if (distance_from(p, 0.0, 0.0) < distance_from(nearest, 0.0, 0.0)) nearest = p;
  }
  std::unordered_map<std::int64_t, std::vector<std::size_t>> waiting;
  for (std::size_t p = 0; p < count; ++p) {
    if (p != nearest) waiting[square(p, 0, 0)].push_back(p);
  }
  std::vector<std::size_t> found{nearest};
  for (std::size_t next = 0; next < found.size(); ++next) {
    const std::size_t p = found[next];
    for (const int right : {-1, 0, 1}) {
      for (const int up : {-1, 0, 1}) {
        const auto near = waiting.find(square(p, right, up));
        if (near == waiting.end()) continue;
        std::erase_if(near->second, [&](std::size_t q) {
          if (distance_from(q, place(p, 0), place(p, 1)) > cell_) return false;
          found.push_back(q);
          return true;
        });
      }
    }
  }
  return found;
}

/// [column of cells]
std::vector<double> Deposit::heights_by_area() const {
  std::vector<double> height(cells_, 0.0);
  for (const std::size_t p : particles_) {
    const auto column = static_cast<std::size_t>(std::max(place(p, 0) / cell_, 0.0));
    height[std::min(column, cells_ - 1)] += fields_->initial_volume[p] / cell_;
  }
  return height;
}

std::vector<double> Deposit::heights_by_tops(const std::vector<double>& by_area) const {
  std::vector<double> height(cells_, 0.0);
  for (const std::size_t p : particles_) {
    const auto column = std::min(static_cast<std::size_t>(std::max(place(p, 0) / cell_, 0.0)), cells_ - 1);
    const std::size_t left = column > 0 ? column - 1 : 0, right = std::min(column + 1, cells_ - 1);
    const double rise = by_area[right] - by_area[left];
    const double slope = std::clamp(rise / (static_cast<double>(right - left) * cell_), -steepest, steepest);
    const double middle = (static_cast<double>(column) + 0.5) * cell_;
    height[column] = std::max(height[column], place(p, 1) + half_height(p) + slope * (middle - place(p, 0)));
  }
  return height;
}

Curve Deposit::free_surface() const {
  Curve surface{"free_surface", "run", {}, {}, "position", {}};
  const std::vector<double> by_area = heights_by_area();
  surface.y = heights_by_tops(by_area);
  for (std::size_t column = 0; column < cells_; ++column) {
    surface.x.push_back((static_cast<double>(column) + 0.5) * cell_);
    const double away = surface.y[column] - by_area[column];
    surface.uncertainty.push_back(std::hypot(spacing_[1] * evenly_spread, away / std::numbers::sqrt3));
  }
  return surface;
}

/// The particles that stood above one another, from the base up.
std::vector<std::vector<std::size_t>> Deposit::columns() const {
  const double width = block_->upper[0] - block_->lower[0];
  std::vector<std::vector<std::size_t>> all(static_cast<std::size_t>(std::llround(width / spacing_[0])));
  for (std::size_t p = 0; p < fields_->mass.size(); ++p) {
    all.at(static_cast<std::size_t>(start(p, 0) / spacing_[0])).push_back(p);
  }
  for (std::vector<std::size_t>& column : all) {
    std::sort(column.begin(), column.end(),
              [&](std::size_t p, std::size_t q) { return start(p, 1) < start(q, 1); });
  }
  return all;
}

double Deposit::height_unmoved(const std::vector<std::size_t>& column, double least_travel) const {
  double below = 0.0, travel_below = 0.0;
  for (const std::size_t p : column) {
    if (travel(p) >= least_travel) {
      const double share = (least_travel - travel_below) / (travel(p) - travel_below);
      return below + share * (start(p, 1) - below);
    }
    below = start(p, 1);
    travel_below = travel(p);
  }
  return block_->upper[1] - block_->lower[1];
}

Curve Deposit::failure_line() const {
  Curve line{"failure_line", "run", {}, {}, "position", {}};
  const double least_travel = moved_share * (block_->upper[1] - block_->lower[1]);
  for (const std::vector<std::size_t>& column : columns()) {
    line.x.push_back(start(column.front(), 0));
    line.y.push_back(height_unmoved(column, least_travel));
    const double range = height_unmoved(column, 2 * least_travel) - height_unmoved(column, least_travel / 2);
    line.uncertainty.push_back(std::hypot(spacing_[1] * evenly_spread, range / 2));
  }
  return line;
}

double Deposit::foot() const {
  std::vector<std::size_t> outermost(fields_->mass.size());
  std::iota(outermost.begin(), outermost.end(), std::size_t{0});
  std::sort(outermost.begin(), outermost.end(),
            [&](std::size_t p, std::size_t q) { return place(p, 0) > place(q, 0); });
  const double area = area_at_start();
  double beyond = 0.0, n = 0.0, sum_x = 0.0, sum_y = 0.0, sum_xx = 0.0, sum_xy = 0.0;
  for (const std::size_t p : outermost) {
    const double up_to_center = beyond + fields_->initial_volume[p] / 2;
    beyond += fields_->initial_volume[p];
    if (up_to_center < scattered_share * area || up_to_center > wedge_share * area) continue;
    const double x = place(p, 0), y = std::sqrt(up_to_center);
    n += 1.0;
    sum_x += x;
    sum_y += y;
    sum_xx += x * x;
    sum_xy += x * y;
  }
  if (n < 3.0) return std::numeric_limits<double>::quiet_NaN();
  const double slope = (n * sum_xy - sum_x * sum_y) / (n * sum_xx - sum_x * sum_x);
  return (sum_x - sum_y / slope) / n;
}

double Deposit::height() const {
  const std::vector<double> height = heights_by_tops(heights_by_area());
  return *std::max_element(height.begin(), height.end());
}

double Deposit::area_change() const {
  const std::vector<double> height = heights_by_tops(heights_by_area());
  return std::accumulate(height.begin(), height.end(), 0.0) * cell_ / area_at_start() - 1;
}

double Deposit::scattered() const {
  double area = 0.0;
  for (const std::size_t p : particles_) area += fields_->initial_volume[p];
  return 1 - area / area_at_start();
}

namespace {

/// The record's snapshot of the end; null without one.
const Snapshot* end_of(const Record& record) {
  const auto end = std::find_if(record.snapshots.begin(), record.snapshots.end(),
                                [](const Snapshot& snapshot) { return snapshot.moment == "end"; });
  return end == record.snapshots.end() ? nullptr : &*end;
}

/// The time by which most of the potential energy that is released by the end has been [s].
void judge_duration(Judging& judging) {
  const History* potential = history_of(judging, "potential_energy");
  if (!potential || potential->value.empty()) return;
  const double start = potential->value.front(),
               least = start + released_share * (potential->value.back() - start);
  for (std::size_t k = 0; k < potential->value.size(); ++k) {
    if (potential->value[k] > least) continue;
    judging.set("collapse.duration", potential->time[k]);
    return;
  }
}

void judge(Judging& judging) {
  if (!why_no_collapse(judging.scene()).empty()) return;
  const Body& block = judging.scene().bodies[0];
  const double width = block.upper[0] - block.lower[0], height = block.upper[1] - block.lower[1];
  judging.set("collapse.aspect_ratio", height / width);
  judge_duration(judging);
  const Snapshot* end = end_of(judging.record);
  if (!end || end->fields.mass.empty()) return;
  const Deposit deposit(judging.scene(), end->fields);
  judging.set("collapse.run_out", deposit.foot() / width - 1);
  judging.set("collapse.deposit_height", deposit.height() / width);
  judging.set("collapse.area_change", deposit.area_change());
  judging.set("collapse.scattered", deposit.scattered());
  judging.result.curves.push_back(deposit.free_surface());
  judging.result.curves.push_back(deposit.failure_line());
}

std::vector<Metric> catalogue() {
  return {
      {"collapse.aspect_ratio", "-", "", "height over width of the column at the start"},
      {"collapse.run_out", "-", "",
       "what the deposit's foot has advanced over the column's width; the foot is that of the wedge that the "
       "last tenth of the deposit makes"},
      {"collapse.deposit_height", "-", "", "greatest height of the deposit over the column's width"},
      {"collapse.area_change", "-", "", "area below the deposit's surface over the column's, minus 1"},
      {"collapse.scattered", "-", "",
       "share of the column's area that does not hang together with the deposit"},
      {"collapse.duration", "s", "",
       "time by which 99 % of the potential energy released by the end has been; needs a probe of it"},
  };
}

std::string never(const std::string&, const Scene&) { return "to be known"; }

}  // namespace

NormFamily collapse_norms() { return {{}, catalogue(), never, judge}; }

}  // namespace mpm::vv
