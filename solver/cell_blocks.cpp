#include "solver/cell_blocks.hpp"

#include <algorithm>
#include <bit>

namespace mpm {
namespace {

/// Bands no lower than this keep those of one colour apart: each reaches two rows of nodes and strays one
/// more on either side.
constexpr std::int32_t lowest_band = 6;
/// Fewer particles than this are not worth waking a thread for.
constexpr Eigen::Index particles_worth_a_band = 1000;
constexpr Eigen::Index most_bands = 64;

}  // namespace

template <int Dim, class Real>
CellBlocks<Dim, Real>::CellBlocks(const Grid<Dim, Real>& grid, int nodes_before,
                                  Particles<Dim, Real>& particles)
    : nodes_before_(nodes_before),
      blocks_across_((grid.nodes(0) + lanes - 1) / lanes + 1),
      rows_(grid.rows()),
      blocks_of_body_(particles.bodies.size()),
      in_cell_(static_cast<std::size_t>(blocks_across_) * static_cast<std::size_t>(rows_) * lanes),
      first_slot_of_(in_cell_.size() / lanes),
      in_row_(static_cast<std::size_t>(rows_)) {
  arrange(grid, particles);
}

template <int Dim, class Real>
std::int64_t CellBlocks<Dim, Real>::bytes() const {
  const auto of = [](const auto& table) { return table.capacity() * sizeof(table[0]); };
  std::size_t sum = of(blocks_) + of(blocks_of_body_) + of(bands_) + of(in_cell_) + of(first_slot_of_) +
                    of(source_) + of(in_row_) + static_cast<std::size_t>(moved_.size()) * sizeof(Real);
  for (const Band& band : bands_) sum += of(band.blocks);
  return static_cast<std::int64_t>(sum);
}

template <int Dim, class Real>
std::int32_t CellBlocks<Dim, Real>::cell_of(const Grid<Dim, Real>& grid,
                                            const Particles<Dim, Real>& particles, int axis,
                                            Eigen::Index slot) const {
  const Real position = particles.position[static_cast<std::size_t>(axis)][slot];
  return static_cast<std::int32_t>((position - grid.origin(axis)) * grid.cells_per_length());
}

template <int Dim, class Real>
void CellBlocks<Dim, Real>::arrange(const Grid<Dim, Real>& grid, Particles<Dim, Real>& particles) {
  blocks_.clear();
  source_.clear();
  std::fill(in_row_.begin(), in_row_.end(), 0);
  Eigen::Index slots = 0;
  for (std::size_t b = 0; b < particles.bodies.size(); ++b) {
    const std::size_t first_block = blocks_.size();
    const Eigen::Index first = slots;
    slots = place_body(grid, particles, particles.bodies[b], first);
    particles.bodies[b] = {first, slots};
    blocks_of_body_[b] = {first_block, blocks_.size()};
  }
  move_fields(grid, particles, slots);
  divide_into_bands(particles.count());
}

/// Appends the blocks of a body, with slots from `first_slot` on. Returns one past its last slot.
template <int Dim, class Real>
Eigen::Index CellBlocks<Dim, Real>::place_body(const Grid<Dim, Real>& grid,
                                               const Particles<Dim, Real>& particles, ParticleRange body,
                                               Eigen::Index first_slot) {
  const auto for_each_particle = [&](auto&& visit) {
    for (Eigen::Index slot = body.first; slot < body.last; ++slot) {
      if (particles.id[static_cast<std::size_t>(slot)] < 0) continue;
      const std::int32_t row = Dim == 1 ? 0 : cell_of(grid, particles, Dim - 1, slot);
      const std::int32_t across = cell_of(grid, particles, 0, slot) - nodes_before_;
      visit(slot, row,
            static_cast<std::size_t>(row) * static_cast<std::size_t>(blocks_across_ * lanes) +
                static_cast<std::size_t>(across));
    }
  };
  Rows rows{rows_, 0};
  for_each_particle([&](Eigen::Index, std::int32_t row, std::size_t cell) {
    ++in_cell_[cell];
    ++in_row_[static_cast<std::size_t>(row)];
    rows = {std::min(rows.begin, row), std::max(rows.end, row + 1)};
  });
  for (std::int32_t row = rows.begin; row < rows.end; ++row) {
    for (std::int32_t k = 0; k < blocks_across_; ++k) {
      const auto index = static_cast<std::size_t>(row) * static_cast<std::size_t>(blocks_across_) +
                         static_cast<std::size_t>(k);
      const auto cells = in_cell_.begin() + static_cast<std::ptrdiff_t>(index * lanes);
      const std::int32_t depth = *std::max_element(cells, cells + lanes);
      if (depth == 0) continue;
      std::fill(cells, cells + lanes, 0);
      first_slot_of_[index] = first_slot;
      blocks_.push_back({first_slot, depth, k * lanes + nodes_before_, row});
      first_slot += Eigen::Index(depth) * lanes;
    }
  }
  source_.resize(static_cast<std::size_t>(first_slot), -1);
  for_each_particle([&](Eigen::Index slot, std::int32_t, std::size_t cell) {
    const Eigen::Index layer = in_cell_[cell]++;
    const Eigen::Index place =
        first_slot_of_[cell / lanes] + layer * lanes + static_cast<Eigen::Index>(cell % lanes);
    source_[static_cast<std::size_t>(place)] = static_cast<std::int32_t>(slot);
  });
  for_each_particle([&](Eigen::Index, std::int32_t, std::size_t cell) { in_cell_[cell] = 0; });
  return first_slot;
}

template <int Dim, class Real>
void CellBlocks<Dim, Real>::move_fields(const Grid<Dim, Real>& grid, Particles<Dim, Real>& particles,
                                        Eigen::Index slots) {
  const bool outgrown = slots > particles.slots();
  const Eigen::Index capacity =
      outgrown ? slots + std::max<Eigen::Index>(slots / 64, 16 * lanes) : particles.slots();
  particles.for_each_field([&](Field<Real>& field, Real empty) {
    moved_.resize(capacity);
    for (Eigen::Index slot = 0; slot < slots; ++slot) {
      const std::int32_t from = source_[static_cast<std::size_t>(slot)];
      moved_[slot] = from < 0 ? empty : field[from];
    }
    moved_.tail(capacity - slots).setConstant(empty);
    field.swap(moved_);
  });
  for (Eigen::Index slot = 0; slot < slots; ++slot) {
    std::int32_t& from = source_[static_cast<std::size_t>(slot)];
    from = from < 0 ? -1 : particles.id[static_cast<std::size_t>(from)];  // from now on, who it is
    if (from >= 0) particles.slot_of[static_cast<std::size_t>(from)] = static_cast<std::int32_t>(slot);
  }
  source_.resize(static_cast<std::size_t>(capacity), -1);
  if (outgrown) source_.shrink_to_fit();  // a vector that grows takes up to twice what it needs
  particles.id.swap(source_);
  for (const Block& block : blocks_) {
    for (Eigen::Index k = 0; k < Eigen::Index(block.depth) * lanes; ++k) {
      const Eigen::Index slot = block.first_slot + k;
      if (particles.id[static_cast<std::size_t>(slot)] >= 0) continue;
      const std::array<std::int32_t, 2> cell{block.first_cell + static_cast<std::int32_t>(k % lanes),
                                             block.row};
      for (std::size_t a = 0; a < Dim; ++a) {
        particles.position[a][slot] =
            grid.origin(static_cast<int>(a)) + (static_cast<Real>(cell[a]) + Real(0.5)) * grid.cell_size();
      }
    }
  }
}

template <int Dim, class Real>
void CellBlocks<Dim, Real>::divide_into_bands(Eigen::Index particles) {
  const auto occupied = [](Eigen::Index count) { return count > 0; };
  const auto first = std::find_if(in_row_.begin(), in_row_.end(), occupied) - in_row_.begin();
  const auto last = in_row_.rend() - std::find_if(in_row_.rbegin(), in_row_.rend(), occupied);
  active_rows_ = {std::max(static_cast<std::int32_t>(first) - nodes_before_ - stray_rows, 0),
                  std::min(static_cast<std::int32_t>(last) + 2 + stray_rows, rows_)};

  // A power of two leaves two, four or eight threads with as many bands each in either colour.
  const auto wanted = static_cast<Eigen::Index>(std::bit_floor(static_cast<std::uint64_t>(
      std::clamp<Eigen::Index>(particles / particles_worth_a_band, 1, most_bands))));
  std::size_t count = 0;
  Eigen::Index passed = 0;
  Rows rows{static_cast<std::int32_t>(first), static_cast<std::int32_t>(first)};
  const auto close = [&] {
    if (bands_.size() <= count)
      bands_.push_back({{}, std::vector<std::pair<std::size_t, std::size_t>>(blocks_of_body_.size())});
    bands_[count++].rows = rows;
    rows.begin = rows.end;
  };
  for (std::int32_t row = rows.begin; row < static_cast<std::int32_t>(last); ++row) {
    passed += in_row_[static_cast<std::size_t>(row)];
    rows.end = row + 1;
    const bool is_high =
        rows.end - rows.begin >= lowest_band && static_cast<std::int32_t>(last) - rows.end >= lowest_band;
    if (wanted > 1 && is_high && passed * wanted >= particles * static_cast<Eigen::Index>(count + 1)) close();
  }
  close();
  bands_.resize(count);
  for (Band& band : bands_) {
    for (std::size_t b = 0; b < blocks_of_body_.size(); ++b) {
      const auto begin = blocks_.begin() + static_cast<std::ptrdiff_t>(blocks_of_body_[b].first);
      const auto end = blocks_.begin() + static_cast<std::ptrdiff_t>(blocks_of_body_[b].second);
      const auto first_at = [&](std::int32_t row) {
        return static_cast<std::size_t>(
            std::partition_point(begin, end, [&](const Block& block) { return block.row < row; }) -
            blocks_.begin());
      };
      band.blocks[b] = {first_at(band.rows.begin), first_at(band.rows.end)};
    }
  }
}

template class CellBlocks<1, double>;
template class CellBlocks<1, float>;
template class CellBlocks<2, double>;
template class CellBlocks<2, float>;

}  // namespace mpm
