#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "solver/simulation.hpp"
#include "vv/verdict.hpp"

/// What a granular column leaves when it has collapsed: the surface of its deposit, the line below which
/// nothing moved, and how far it ran.
namespace mpm::vv {

/// What a scene lacks to be a collapse, for a person; empty if it is one: in two dimensions a single plain
/// block of Mohr–Coulomb ground that stands on a fixed lower edge of the grid, begins at the grid's lower
/// edge in x, a wall, does not reach the other side, and falls under its weight alone.
std::string why_no_collapse(const Scene& scene);

/// What has moved at least this share of the column's height counts as moved. 1.5 % of a column of bars 0.1 m
/// high are 1.5 mm, a bar's thickness: less is not seen on a photograph. The ground's elastic settlement when
/// the side is let go, about density gravity height^2 / (2 Young's modulus), has to stay below it.
inline constexpr double moved_share = 0.015;

/// The foot of a deposit is where its last tenth, less its last hundredth, would end if it were a wedge.
inline constexpr double wedge_share = 0.10, scattered_share = 0.01;

/// A column's deposit, as the particles of a collapse make it up at one moment. Places are distances from the
/// wall [m], heights are above the base [m].
class Deposit {
 public:
  /// Particles hold together over gaps of a cell: nearer than that they share nodes, and feel each other.
  /// What hangs together with the corner of wall and base is the deposit; grains that have flown off are not.
  Deposit(const Scene& scene, const ParticleFields& fields);

  /// Height of the surface over the place, at the middle of every column of the grid's cells; 0 beyond the
  /// deposit. In each it is the highest top of the deposit's particles, moved along the surface's slope to
  /// the middle. `uncertainty` is that of a top that may lie anywhere within a particle's height, and of what
  /// a second way to see a surface says otherwise: the area that the particles in the column of cells had at
  /// the start, over its width, which knows no voids. The surface may be anywhere as far away as that one is.
  Curve free_surface() const;

  /// Height up to which the ground has not moved, over the place of each column of particles; the column's
  /// height where all of it stayed. Between particles the displacement is linear, and it is zero at the base.
  /// `uncertainty`: a particle's height, evenly spread, and half of what twice and half of `moved_share`
  /// differ in.
  Curve failure_line() const;

  /// Place of the deposit's foot [m]: the square root of the area beyond a place falls linearly to zero at
  /// the end of a wedge. Fitted by least squares to the places of the particles that have between
  /// `scattered_share` and `wedge_share` of the area beyond them. It is the foot of a wedge exactly, lies 4 %
  /// too far of a deposit that ends in a cliff, and does not notice single grains. Not a number of fewer than
  /// three particles.
  double foot() const;

  /// Greatest height of `free_surface` [m].
  double height() const;
  /// Area below `free_surface` over that of the column at the start, minus 1.
  double area_change() const;
  /// Share of the column's area that is not part of the deposit.
  double scattered() const;

 private:
  double place(std::size_t p, std::size_t axis) const {
    return fields_->position[2 * p + axis] - block_->lower[axis];
  }
  double start(std::size_t p, std::size_t axis) const {
    return fields_->initial_position[2 * p + axis] - block_->lower[axis];
  }
  double travel(std::size_t p) const;
  double half_height(std::size_t p) const;
  double area_at_start() const;
  std::vector<std::size_t> connected_with_corner() const;
  std::vector<double> heights_by_area() const;
  std::vector<double> heights_by_tops(const std::vector<double>& by_area) const;
  std::vector<std::vector<std::size_t>> columns() const;
  double height_unmoved(const std::vector<std::size_t>& column, double least_travel) const;

  const Body* block_;
  const ParticleFields* fields_;
  double cell_;
  PerAxis spacing_{};
  std::size_t cells_ = 0;  ///< along the base
  std::vector<std::size_t> particles_;
};

}  // namespace mpm::vv
