#include "vv/polyline_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace mpm::vv {
namespace {

constexpr int lattice_steps = 40;
constexpr int most_pieces = 4;
using Ends = std::array<double, most_pieces + 1>;

/// The points of a fit. x is measured from 0 to 1 over its range, so that no sum cancels.
class Points {
 public:
  Points(const std::vector<double>& x, const std::vector<double>& y) : y_(&y) {
    const double range = x.back() - x.front();
    for (const double value : x) x_.push_back((value - x.front()) / range);
  }

  /// The values at the ends of given pieces that leave the least squares, and what they leave.
  double fit(const Ends& ends, int pieces, Ends& values) const {
    const auto n = static_cast<std::size_t>(pieces);
    // The unknowns are the values at the ends; each point sees the two of its own piece: the normal
    // equations are tridiagonal.
    Ends diagonal{}, upper{}, right{};
    for_each_point(ends, n, [&](std::size_t piece, double share, double y) {
      diagonal[piece] += (1 - share) * (1 - share);
      upper[piece] += (1 - share) * share;
      diagonal[piece + 1] += share * share;
      right[piece] += (1 - share) * y;
      right[piece + 1] += share * y;
    });
    for (std::size_t i = 1; i <= n; ++i) {
      const double factor = upper[i - 1] / diagonal[i - 1];
      diagonal[i] -= factor * upper[i - 1];
      right[i] -= factor * right[i - 1];
    }
    values[n] = right[n] / diagonal[n];
    for (std::size_t i = n; i-- > 0;) values[i] = (right[i] - upper[i] * values[i + 1]) / diagonal[i];
    double squares = 0.0;
    for_each_point(ends, n, [&](std::size_t piece, double share, double y) {
      const double left = y - (1 - share) * values[piece] - share * values[piece + 1];
      squares += left * left;
    });
    return squares;
  }

 private:
  template <class Visit>
  void for_each_point(const Ends& ends, std::size_t pieces, const Visit& visit) const {
    std::size_t piece = 0;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      while (piece + 1 < pieces && x_[i] > ends[piece + 1]) ++piece;
      visit(piece, (x_[i] - ends[piece]) / (ends[piece + 1] - ends[piece]), (*y_)[i]);
    }
  }

  std::vector<double> x_;
  const std::vector<double>* y_;
};

/// Ends of pieces, the values there, and the squares they leave.
struct Trial {
  Ends ends{}, values{};
  double squares = 0.0;
};

class Search {
 public:
  Search(const Points& points, int pieces) : points_(&points), pieces_(pieces) {
    best_.ends.fill(1.0);
    best_.ends[0] = 0.0;
    best_.squares = INFINITY;
  }

  Trial found() {
    Trial trial = best_;
    try_lattice(trial, 1, 1);
    for (double step = 0.5 / lattice_steps; pieces_ > 1 && step > 1e-6; step /= 2) {
      for (bool better = true; better;) {
        const double before = best_.squares;
        Trial moved = best_;
        try_moves(moved, best_.ends, 1, step);
        better = best_.squares < before * (1 - 1e-9);
      }
    }
    return best_;
  }

 private:
  bool is_last(int knot) const { return knot == pieces_; }

  void consider(Trial& trial) {
    trial.squares = points_->fit(trial.ends, pieces_, trial.values);
    if (trial.squares < best_.squares) best_ = trial;
  }

  /// Every place of the knots from this one on, on the lattice from its place `from` on.
  void try_lattice(Trial& trial, int knot, int from) {
    if (is_last(knot)) return consider(trial);
    const int last = lattice_steps - (pieces_ - knot);
    for (int place = from; place <= last; ++place) {
      trial.ends[static_cast<std::size_t>(knot)] = place / static_cast<double>(lattice_steps);
      try_lattice(trial, knot + 1, place + 1);
    }
  }

  /// Every knot from this one on stays at its place in `from` or moves to either side.
  void try_moves(Trial& trial, const Ends from, int knot, double step) {
    const auto k = static_cast<std::size_t>(knot);
    if (is_last(knot)) {
      if (1.0 - trial.ends[k - 1] >= shortest_piece - 1e-12) consider(trial);
      return;
    }
    for (const double move : {-step, 0.0, step}) {
      trial.ends[k] = from[k] + move;
      if (trial.ends[k] - trial.ends[k - 1] >= shortest_piece - 1e-12) try_moves(trial, from, knot + 1, step);
    }
  }

  const Points* points_;
  int pieces_;
  Trial best_;
};

}  // namespace

double Polyline::slope(int piece) const {
  const auto k = static_cast<std::size_t>(piece);
  return (y.at(k + 1) - y.at(k)) / (x.at(k + 1) - x.at(k));
}

Polyline fit_polyline(const std::vector<double>& x, const std::vector<double>& y, int pieces) {
  if (pieces < 1 || pieces > most_pieces) throw std::invalid_argument("a polyline has one to four pieces");
  if (x.size() != y.size() || x.size() < static_cast<std::size_t>(pieces) + 2)
    throw std::invalid_argument("a polyline needs one y for each x and more points than ends");
  if (!std::is_sorted(x.begin(), x.end()) || !(x.back() > x.front()))
    throw std::invalid_argument("a polyline needs points in the order of x");
  const Points points(x, y);
  const Trial best = Search(points, pieces).found();
  Polyline line;
  for (std::size_t k = 0; k <= static_cast<std::size_t>(pieces); ++k) {
    line.x.push_back((1 - best.ends[k]) * x.front() + best.ends[k] * x.back());
    line.y.push_back(best.values[k]);
  }
  line.rms_residual = std::sqrt(best.squares / static_cast<double>(x.size()));
  return line;
}

}  // namespace mpm::vv
