#pragma once

#include <vector>

#include "solver/grid.hpp"
#include "solver/lanes.hpp"

namespace mpm {

/// Averages over the particles of each cell, weighted by their volumes, of one of their numbers at a time.
/// Particles of bodies that do not ask for it count nowhere. Cells lie at the indices of their lower nodes;
/// without a body that asks there is no storage.
///
/// Within a step it is used twice. A particle takes the mean dilation of its cell, so that a cell has to keep
/// its volume once instead of at every particle [NagtegaalParksRice74]; and in the nodal forces it takes the
/// mean of the cell's normal stresses in the plane, so that they do the work of the dilation it took: the
/// B-bar method [Hughes80] with a cell for an element.
template <int Dim, class Real>
class CellAverage {
 public:
  CellAverage(const Scene& scene, const Grid<Dim, Real>& grid) {
    for (const Body& body : scene.bodies) {
      is_wanted_by_.push_back(body.locking_control == LockingControl::cell_average);
      is_wanted_ = is_wanted_ || is_wanted_by_.back();
    }
    if (!is_wanted_) return;
    content_.setZero(grid.mass.size());
    volume_.setZero(grid.mass.size());
  }

  /// Whether any body asks for it.
  bool is_wanted() const { return is_wanted_; }
  bool is_wanted_by(std::size_t body) const { return is_wanted_by_[body] != 0; }

  /// Memory of the sums [B].
  std::int64_t bytes() const {
    return static_cast<std::int64_t>(static_cast<std::size_t>(content_.size() + volume_.size()) *
                                     sizeof(Real));
  }

  /// Forgets the sums of some rows of cells.
  void clear(const Grid<Dim, Real>& grid, Rows rows) {
    const auto [first, count] = grid.place_of(rows);
    content_.segment(first, count).setZero();
    volume_.segment(first, count).setZero();
  }

  /// Adds volumes [m^Dim], and volumes times the number, to a cell, or lanes of them to the cells from it on.
  template <class Value>
  void add(Eigen::Index cell, const Value& content, const Value& volume) {
    store(load<Value>(&content_[cell]) + content, &content_[cell]);
    store(load<Value>(&volume_[cell]) + volume, &volume_[cell]);
  }

  /// The mean of a cell, or of lanes of cells from it on; zero where nothing has been added.
  template <class Value>
  Value mean(Eigen::Index cell) const {
    const Value volume = load<Value>(&volume_[cell]);
    return load<Value>(&content_[cell]) / select(volume != Value(0), volume, Value(1));
  }

 private:
  Field<Real> content_, volume_;  ///< [cell] sums
  bool is_wanted_ = false;
  std::vector<unsigned char> is_wanted_by_;  ///< [body]
};

}  // namespace mpm
