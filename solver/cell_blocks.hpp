#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "solver/grid.hpp"
#include "solver/lanes.hpp"
#include "solver/particles.hpp"

namespace mpm {

/// Particles of as many cells as there are lanes, side by side along x. Its slots are `depth` layers of
/// lanes; lane l of every layer holds a particle of the l-th cell, or none. So what the lanes of a layer read
/// from the grid, or add to it, lies side by side in memory.
struct Block {
  Eigen::Index first_slot;
  std::int32_t depth;
  std::int32_t first_cell;  ///< along x, counted from the grid's first node
  std::int32_t row;         ///< of cells, counted from the grid's first node; 0 in one dimension
};

/// Rows of cells whose particles are worked on by one thread at a time.
struct Band {
  Rows rows;                                                ///< of cells
  std::vector<std::pair<std::size_t, std::size_t>> blocks;  ///< [body] first and one past the last block
};

/// Keeps the particles of every body in the order of blocks, row by row.
///
/// A particle that has left its lane's cell (a stray) stays in its slot, and the transfers work on it alone;
/// when there are many, or one has gone far, `arrange` puts all particles in order. An empty slot holds a
/// particle of no mass in the middle of its cell, which takes no part: its time step is zero.
///
/// Bands have two colours in turn. A particle reaches the nodes two rows around its cell at most, and a stray
/// is no more than a row outside its band, so bands of one colour never touch the same node and may be worked
/// on at the same time; a node's sum is that of the first colour, then the second, for any number of threads.
template <int Dim, class Real>
class CellBlocks {
 public:
  static constexpr int lanes = lane_count<Real>;
  /// How far outside its band, in rows, a stray may be.
  static constexpr std::int32_t stray_rows = 1;

  /// `nodes_before`: of the shape function.
  CellBlocks(const Grid<Dim, Real>& grid, int nodes_before, Particles<Dim, Real>& particles);

  /// Puts all particles in order. Allocates only if empty slots have outgrown what was reserved.
  void arrange(const Grid<Dim, Real>& grid, Particles<Dim, Real>& particles);

  const std::vector<Block>& blocks() const { return blocks_; }
  const std::vector<Band>& bands() const { return bands_; }
  /// Rows of nodes that particles can reach until they are put in order again.
  Rows active_rows() const { return active_rows_; }
  /// Memory of all tables, and of what `arrange` works in [B].
  std::int64_t bytes() const;

 private:
  std::int32_t cell_of(const Grid<Dim, Real>& grid, const Particles<Dim, Real>& particles, int axis,
                       Eigen::Index slot) const;
  Eigen::Index place_body(const Grid<Dim, Real>& grid, const Particles<Dim, Real>& particles,
                          ParticleRange body, Eigen::Index first_slot);
  void move_fields(const Grid<Dim, Real>& grid, Particles<Dim, Real>& particles, Eigen::Index slots);
  void divide_into_bands(Eigen::Index particles);

  int nodes_before_;
  std::int32_t blocks_across_, rows_;
  std::vector<Block> blocks_;
  std::vector<std::pair<std::size_t, std::size_t>> blocks_of_body_;
  std::vector<Band> bands_;
  Rows active_rows_;
  std::vector<std::int32_t> in_cell_;        ///< [cell] particles of a body
  std::vector<Eigen::Index> first_slot_of_;  ///< [block of the grid]
  std::vector<std::int32_t> source_;         ///< [new slot] old slot, -1 for none
  std::vector<Eigen::Index> in_row_;         ///< [row] particles
  Field<Real> moved_;
};

}  // namespace mpm
