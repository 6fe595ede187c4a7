#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "vv/field_map.hpp"
#include "vv/judging.hpp"
#include "vv/load_curve.hpp"

namespace mpm::vv {
namespace {

/// So many of a case's snapshots are judged, so that the catalogue has an end.
constexpr std::size_t most_snapshots = 6;

/// A band is where the shear strain is above this share of the settlement over the width. What moves as a
/// mechanism as wide as the footing is sheared by about that ratio; the elastic field is far below it a width
/// away from the footing. With shares from 0.15 to 0.3 the same stages are told apart.
constexpr double band_share = 0.25;
/// Particles are neighbours up to this distance between their centers, in spacings of the start.
constexpr double neighbour_reach = 1.5;
/// A band begins within this distance of the edge of the footing's base, in cells.
constexpr double edge_reach = 1.5;

/// The ground below a footing at the moment of a snapshot.
class Ground {
 public:
  Ground(const Scene& scene, const Footing& footing, const Snapshot& snapshot)
      : footing_(&footing), snapshot_(&snapshot), cell_(scene.cell_size) {
    const auto& per_cell = footing.ground->particles_per_cell;
    for (std::size_t axis = 0; axis < 2; ++axis) spacing_[axis] = cell_ / per_cell[axis];
    const auto index = static_cast<std::size_t>(footing.ground - scene.bodies.data());
    const ParticleFields& fields = snapshot.fields;
    for (std::size_t p = 0; p < fields.body.size(); ++p) {
      if (fields.body[p] == index) particles_.push_back(p);
    }
    settlement_ = footing.strip
                      ? -footing.strip->velocity[1] * footing.strip->travel_time(snapshot.time)
                      : descent_of_block(static_cast<std::size_t>(footing.block - scene.bodies.data()));
  }

  /// Of the footing since the start of the run [m].
  double settlement() const { return settlement_; }

  /// What has risen beside the footing over what the footing has displaced.
  double heave() const {
    double risen = 0.0;
    for (const std::size_t p : particles_) {
      const bool at_surface = depth_at_start(p) < spacing_[1];
      if (at_surface && beside(start(p, 0)) > 0.0) risen += std::max(moved(p, 1), 0.0) * spacing_[0];
    }
    return risen / (settlement_ * footing_->width);
  }

  /// How far below the footing's base the axis moves half as much as the footing, in widths. Nothing if the
  /// ground moves less than that from its surface on.
  std::optional<double> bubble() const {
    const std::vector<std::size_t> column = below_axis();
    for (std::size_t k = 1; k < column.size(); ++k) {
      const double above = travel(column[k - 1]) - settlement_ / 2,
                   below = travel(column[k]) - settlement_ / 2;
      if (above < 0.0) return std::nullopt;
      if (below >= 0.0) continue;
      const double share = above / (above - below);
      const double height = (1 - share) * place(column[k - 1], 1) + share * place(column[k], 1);
      return (base() - height) / footing_->full_width();
    }
    return std::nullopt;
  }

  struct Band {
    double reach = 0.0;  ///< farthest from the edge that it comes up beside the footing, in widths
    double depth = 0.0;  ///< deepest below the footing's base, in widths
  };

  /// The band of shear that is connected with the edge of the footing's base.
  Band band() const {
    Band band;
    for (const std::size_t p : connected_with_edge()) {
      band.depth = std::max(band.depth, (base() - place(p, 1)) / footing_->full_width());
      const double distance = beside(place(p, 0));
      if (depth_at_start(p) < 2 * spacing_[1] && distance > cell_)
        band.reach = std::max(band.reach, distance / footing_->full_width());
    }
    return band;
  }

 private:
  double start(std::size_t p, std::size_t axis) const {
    return snapshot_->fields.initial_position[2 * p + axis];
  }
  double moved(std::size_t p, std::size_t axis) const { return snapshot_->fields.displacement[2 * p + axis]; }
  double place(std::size_t p, std::size_t axis) const { return snapshot_->fields.position[2 * p + axis]; }
  double travel(std::size_t p) const { return std::hypot(moved(p, 0), moved(p, 1)); }
  double depth_at_start(std::size_t p) const { return footing_->ground->upper[1] - start(p, 1); }
  double base() const { return footing_->lower[1] - settlement_; }

  /// Distance from the nearer edge outwards [m]; negative below the footing.
  double beside(double x) const {
    const double right = x - footing_->upper[0];
    return footing_->half ? right : std::max(right, footing_->lower[0] - x);
  }

  double descent_of_block(std::size_t block) const {
    const ParticleFields& fields = snapshot_->fields;
    double mass = 0.0, sum = 0.0;
    for (std::size_t p = 0; p < fields.body.size(); ++p) {
      if (fields.body[p] != block) continue;
      mass += fields.mass[p];
      sum += fields.mass[p] * moved(p, 1);
    }
    return -sum / mass;
  }

  /// The column of particles next to the axis, from the surface down.
  std::vector<std::size_t> below_axis() const {
    const double axis =
        footing_->half ? footing_->ground->lower[0] : (footing_->lower[0] + footing_->upper[0]) / 2;
    std::vector<std::size_t> column;
    for (const std::size_t p : particles_) {
      const double beyond = start(p, 0) - axis;
      if (beyond > -1e-6 * cell_ && beyond < (1 - 1e-6) * spacing_[0]) column.push_back(p);
    }
    std::sort(column.begin(), column.end(),
              [&](std::size_t a, std::size_t b) { return start(a, 1) > start(b, 1); });
    return column;
  }

  bool at_edge(std::size_t p) const {
    return std::hypot(beside(place(p, 0)), place(p, 1) - base()) <= edge_reach * cell_;
  }

  bool are_neighbours(std::size_t p, std::size_t q) const {
    return std::hypot((place(p, 0) - place(q, 0)) / spacing_[0], (place(p, 1) - place(q, 1)) / spacing_[1]) <=
           neighbour_reach;
  }

  /// A square of the plane as wide as neighbours may be apart, `right` and `up` squares from that of p.
  std::int64_t square_of(std::size_t p, int right = 0, int up = 0) const {
    const auto along = [&](std::size_t axis) {
      return static_cast<std::int64_t>(std::floor(place(p, axis) / (neighbour_reach * spacing_[axis])));
    };
    return (along(0) + right) * (std::int64_t{1} << 32) + (along(1) + up);
  }

  std::vector<std::size_t> connected_with_edge() const {
    const std::vector<double> strain = map_of(*snapshot_, "max_shear_strain").value;
    const double least = band_share * settlement_ / footing_->full_width();
    std::unordered_map<std::int64_t, std::vector<std::size_t>> waiting;
    std::vector<std::size_t> found;
    for (const std::size_t p : particles_) {
      if (!(strain[p] >= least)) continue;
      if (at_edge(p)) {
        found.push_back(p);
      } else {
        waiting[square_of(p)].push_back(p);
      }
    }
    for (std::size_t next = 0; next < found.size(); ++next) {
      const std::size_t p = found[next];
      for (const int right : {-1, 0, 1}) {
        for (const int up : {-1, 0, 1}) {
          const auto square = waiting.find(square_of(p, right, up));
          if (square == waiting.end()) continue;
          std::erase_if(square->second, [&](std::size_t q) {
            if (!are_neighbours(p, q)) return false;
            found.push_back(q);
            return true;
          });
        }
      }
    }
    return found;
  }

  const Footing* footing_;
  const Snapshot* snapshot_;
  double cell_;
  PerAxis spacing_{};
  std::vector<std::size_t> particles_;
  double settlement_ = 0.0;
};

/// What the record has of the case's snapshot of that number, from 0. Null if its moment did not come, or
/// only when a run broke off.
const Snapshot* snapshot_of(const Case& definition, const Record& record, std::size_t number) {
  const std::string moment = moment_of(definition.snapshots.at(number));
  for (const Snapshot& snapshot : record.snapshots) {
    if (snapshot.moment != moment) continue;
    return record.completed() || snapshot.time < record.end_time ? &snapshot : nullptr;
  }
  return nullptr;
}

void judge_snapshot(Judging& judging, const Footing& footing, const Snapshot& snapshot, std::size_t number) {
  const Ground ground(judging.scene(), footing, snapshot);
  if (!(ground.settlement() > 0.0)) return;
  const auto set = [&](const char* what, double value) {
    judging.set(fmt::format("mechanism.{}_{}", what, number + 1), value);
  };
  set("heave", ground.heave());
  if (const std::optional<double> bubble = ground.bubble()) set("bubble", *bubble);
  if (!judging.scene().sums_strain) return;
  const Ground::Band band = ground.band();
  set("band_reach", band.reach);
  set("band_depth", band.depth);
}

void judge_course(Judging& judging) {
  if (!why_no_footing(judging.scene()).empty()) return;
  const Footing footing = footing_of(judging.scene());
  for (std::size_t k = 0; k < std::min(judging.definition.snapshots.size(), most_snapshots); ++k) {
    const Snapshot* snapshot = snapshot_of(judging.definition, judging.record, k);
    if (snapshot) judge_snapshot(judging, footing, *snapshot, k);
  }
}

std::vector<Metric> catalogue() {
  std::vector<Metric> metrics;
  for (std::size_t k = 1; k <= most_snapshots; ++k) {
    const auto add = [&](const char* what, const char* meaning) {
      metrics.push_back({fmt::format("mechanism.{}_{}", what, k), "-", "",
                         fmt::format("{}, at the case's snapshot {}", meaning, k)});
    };
    add("heave", "what has risen beside the footing over what the footing has displaced");
    add("band_reach",
        "how far from the edge the footing's band of shear comes up, in widths; 0 if it does not");
    add("band_depth", "how far below its base the footing's band of shear reaches, in widths");
    add("bubble", "how far below its base the axis moves half as much as the footing, in widths");
  }
  return metrics;
}

std::string never(const std::string&, const Scene&) { return "to be known"; }

void judge_end(Judging&) {}  // every snapshot has been judged on the way

}  // namespace

NormFamily mechanism_norms() { return {{}, catalogue(), never, judge_end, nullptr, judge_course}; }

}  // namespace mpm::vv
