#include "reference/elastic_strip.hpp"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace mpm::reference {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Integrals over an element -1 <= xi <= 1 of products of the Lobatto shape functions N_a: (1 - xi)/2, (1 +
/// xi)/2, and N_k = (P_k - P_{k-2}) / sqrt(2 (2k - 1)), which vanish at both ends.
struct ElementIntegrals {
  Eigen::MatrixXd stiffness;  ///< N_a' N_b'
  Eigen::MatrixXd mass;       ///< N_a N_b
  Eigen::MatrixXd mixed;      ///< N_a' N_b
};

ElementIntegrals element_integrals(int order) {
  // Row a: the Legendre coefficients of N_a and of its derivative, since P_k' - P_{k-2}' = (2k - 1) P_{k-1}.
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(order + 1, order + 1), slopes = values;
  values(0, 0) = values(1, 0) = values(1, 1) = 0.5;
  values(0, 1) = -0.5;
  slopes(0, 0) = -0.5;
  slopes(1, 0) = 0.5;
  for (int k = 2; k <= order; ++k) {
    const double scale = 1 / std::sqrt(2.0 * (2 * k - 1));
    values(k, k) = scale;
    values(k, k - 2) = -scale;
    slopes(k, k - 1) = scale * (2 * k - 1);
  }
  Eigen::VectorXd norms(order + 1);  // of the Legendre polynomials
  for (int k = 0; k <= order; ++k) norms(k) = 2.0 / (2 * k + 1);
  return {slopes * norms.asDiagonal() * slopes.transpose(), values * norms.asDiagonal() * values.transpose(),
          slopes * norms.asDiagonal() * values.transpose()};
}

/// The same integrals over a line of elements. The unknowns are the values at the elements' ends, in their
/// order, and then the amplitudes of the functions within each element.
struct Line {
  int ends;  ///< how many unknowns are values
  int elements;
  int order;
  Sparse stiffness{}, mass{}, mixed{};

  int size() const { return ends + elements * (order - 1); }
  int unknown(int element, int function) const {
    return function < 2 ? element + function : ends + element * (order - 1) + function - 2;
  }
};

Line make_line(const std::vector<double>& ends, int order) {
  Line line{
      .ends = static_cast<int>(ends.size()), .elements = static_cast<int>(ends.size()) - 1, .order = order};
  const ElementIntegrals element = element_integrals(order);
  Triplets stiffness, mass, mixed;
  for (int e = 0; e < line.elements; ++e) {
    const double half = (ends[static_cast<std::size_t>(e) + 1] - ends[static_cast<std::size_t>(e)]) / 2;
    for (int a = 0; a <= order; ++a)
      for (int b = 0; b <= order; ++b) {
        const int row = line.unknown(e, a), column = line.unknown(e, b);
        stiffness.emplace_back(row, column, element.stiffness(a, b) / half);
        mass.emplace_back(row, column, element.mass(a, b) * half);
        mixed.emplace_back(row, column, element.mixed(a, b));
      }
  }
  const auto assemble = [&](Sparse& matrix, const Triplets& entries) {
    matrix.resize(line.size(), line.size());
    matrix.setFromTriplets(entries.begin(), entries.end());
  };
  assemble(line.stiffness, stiffness);
  assemble(line.mass, mass);
  assemble(line.mixed, mixed);
  return line;
}

/// The ends of elements between `from` and `to` that halve in size towards `to`.
std::vector<double> graded(double from, double to, int halvings) {
  std::vector<double> ends;
  for (int k = 0; k <= halvings; ++k) ends.push_back(to + (from - to) * std::pow(0.5, k));
  ends.push_back(to);
  return ends;
}

std::vector<double> ends_across(const ElasticStrip& strip, int halvings) {
  std::vector<double> ends = graded(0, strip.half_width, halvings);
  if (strip.half_width < strip.side_distance) {
    const std::vector<double> outside = graded(strip.side_distance, strip.half_width, halvings);
    ends.insert(ends.end(), outside.rbegin() + 1, outside.rend());
  }
  return ends;
}

/// The quadratic form of twice the strain energy per thickness, over the unknowns of both displacements.
class Energy {
 public:
  Energy(const ElasticStrip& strip, Line across, Line up) : across_(std::move(across)), up_(std::move(up)) {
    const double e = strip.youngs_modulus, nu = strip.poissons_ratio;
    const double shear = e / (2 * (1 + nu)), lame = e * nu / ((1 + nu) * (1 - 2 * nu));
    const Sparse across_mixed = across_.mixed.transpose(), up_mixed = up_.mixed.transpose();
    add(0, 0, lame + 2 * shear, across_.stiffness, up_.mass);
    add(0, 0, shear, across_.mass, up_.stiffness);
    add(1, 1, lame + 2 * shear, across_.mass, up_.stiffness);
    add(1, 1, shear, across_.stiffness, up_.mass);
    // lambda u,x v,y and shear u,y v,x, and their transposes.
    add(0, 1, lame, across_.mixed, up_mixed);
    add(0, 1, shear, across_mixed, up_.mixed);
    add(1, 0, lame, across_mixed, up_.mixed);
    add(1, 0, shear, across_.mixed, up_mixed);
    matrix_.resize(size(), size());
    matrix_.setFromTriplets(entries_.begin(), entries_.end());
    entries_ = {};
  }

  int size() const { return 2 * across_.size() * up_.size(); }
  int unknown(int component, int i, int j) const { return (component * up_.size() + j) * across_.size() + i; }
  const Sparse& matrix() const { return matrix_; }
  const Line& across() const { return across_; }
  const Line& up() const { return up_; }

 private:
  /// Adds factor times the product of integrals across and up.
  void add(int row, int column, double factor, const Sparse& across, const Sparse& up) {
    for (int i = 0; i < across.outerSize(); ++i)
      for (Sparse::InnerIterator x(across, i); x; ++x)
        for (int j = 0; j < up.outerSize(); ++j)
          for (Sparse::InnerIterator y(up, j); y; ++y)
            entries_.emplace_back(unknown(row, static_cast<int>(x.row()), static_cast<int>(y.row())),
                                  unknown(column, static_cast<int>(x.col()), static_cast<int>(y.col())),
                                  factor * x.value() * y.value());
  }

  Line across_, up_;
  Triplets entries_;
  Sparse matrix_;
};

/// Which unknowns are given, and all of them with the given ones in place: zero, or one for the settlement.
struct Conditions {
  std::vector<bool> given;
  Eigen::VectorXd displacement;
};

Conditions conditions(const Energy& energy, const ElasticStrip& strip, int halvings) {
  Conditions all{std::vector<bool>(static_cast<std::size_t>(energy.size()), false),
                 Eigen::VectorXd::Zero(energy.size())};
  const auto give = [&](int component, int i, int j) {
    all.given[static_cast<std::size_t>(energy.unknown(component, i, j))] = true;
  };
  const Line &across = energy.across(), &up = energy.up();
  const int edge = halvings + 1, surface = up.ends - 1;  // the end at x = half_width, and the one at the top
  for (int j = 0; j < up.size(); ++j) {
    give(0, 0, j);
    give(0, across.ends - 1, j);
  }
  for (int i = 0; i < across.size(); ++i) {
    give(0, i, 0);
    give(1, i, 0);
    const bool below_strip = i < across.ends ? i <= edge : i < across.unknown(edge, 2);
    if (!below_strip) continue;
    give(1, i, surface);
    if (strip.roughness == Roughness::rough) give(0, i, surface);
    // Uniform settlement is one at every end and nothing within the elements.
    if (i < across.ends) all.displacement(energy.unknown(1, i, surface)) = 1;
  }
  return all;
}

/// Twice the least strain energy under the conditions.
double least_energy(const Energy& energy, const Conditions& all) {
  std::vector<int> place(all.given.size(), -1);
  int free = 0;
  for (std::size_t i = 0; i < place.size(); ++i)
    if (!all.given[i]) place[i] = free++;
  const Eigen::VectorXd residual = energy.matrix() * all.displacement;
  Triplets entries;
  Eigen::VectorXd load(free);
  for (int column = 0; column < energy.size(); ++column) {
    const int to = place[static_cast<std::size_t>(column)];
    if (to < 0) continue;
    load(to) = residual(column);
    for (Sparse::InnerIterator entry(energy.matrix(), column); entry; ++entry)
      if (const int row = place[static_cast<std::size_t>(entry.row())]; row >= 0)
        entries.emplace_back(row, to, entry.value());
  }
  const double given = all.displacement.dot(residual);
  if (free == 0) return given;
  Sparse matrix(free, free);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Sparse> solver(matrix);
  if (solver.info() != Eigen::Success)
    throw std::runtime_error("the elastic strip's equations are not positive definite");
  return given - load.dot(solver.solve(load));
}

void require(const ElasticStrip& strip) {
  const bool fine = strip.half_width > 0 && strip.half_width <= strip.side_distance &&
                    strip.layer_depth > 0 && std::isfinite(strip.side_distance) &&
                    std::isfinite(strip.layer_depth) && strip.youngs_modulus > 0 &&
                    strip.poissons_ratio >= 0 && strip.poissons_ratio <= 0.49;
  if (!fine) throw std::invalid_argument("an elastic strip's measures are outside their range");
}

}  // namespace

double secant_stiffness(const ElasticStrip& strip, int order, int halvings) {
  require(strip);
  if (order < 1 || halvings < 0)
    throw std::invalid_argument("an elastic strip needs order >= 1 and halvings >= 0");
  const Energy energy(strip, make_line(ends_across(strip, halvings), order),
                      make_line(graded(0, strip.layer_depth, halvings), order));
  // Twice the energy of unit settlement is the force on half the strip.
  return least_energy(energy, conditions(energy, strip, halvings)) / strip.half_width;
}

SecantStiffness secant_stiffness(const ElasticStrip& strip) {
  constexpr int order = 5, halvings = 14;
  const double finest = secant_stiffness(strip, order, halvings);
  const double value = 2 * finest - secant_stiffness(strip, order, halvings - 1);
  const double lower_order =
      2 * secant_stiffness(strip, order - 1, halvings) - secant_stiffness(strip, order - 1, halvings - 1);
  return {value, std::abs(finest - value) + std::abs(lower_order - value)};
}

double deep_layer_stiffness(const ElasticStrip& strip) {
  require(strip);
  using std::numbers::pi;
  const double e = strip.youngs_modulus, nu = strip.poissons_ratio, b = strip.half_width,
               l = strip.side_distance;
  const double constrained = e * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
  return 1 / (b / l * strip.layer_depth / constrained -
              4 * (1 - nu * nu) * b / (pi * e) * std::log(std::sin(pi * b / (2 * l))));
}

}  // namespace mpm::reference
