#include "reference/column.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mpm::reference {

double equilibrium_stress(const Column& column, double initial_position) {
  return -column.unit_weight * (column.height - initial_position);
}

double HenckyColumn::stress(double position) const {
  const double ratio = column().unit_weight / column().youngs_modulus;
  return column().youngs_modulus * std::log(ratio * position + std::exp(-ratio * column().height));
}

double HenckyColumn::position(double initial_position) const {
  const double ratio = column().unit_weight / column().youngs_modulus;
  // The difference of the two exponentials, without losing digits for a light column.
  return std::exp(-ratio * column().height) * std::expm1(ratio * initial_position) / ratio;
}

double ZhangColumn::kappa() const {
  return -column().unit_weight * column().height / (2 * column().youngs_modulus);
}

double ZhangColumn::stress(double position) const {
  const double k = kappa(), xi = position / column().height;
  return 2 * column().youngs_modulus * k * ((1 - xi) + k * xi) / (1 - k * (1 - k) * xi);
}

double ZhangColumn::displacement_at(double position) const {
  const double k = kappa(), xi = position / column().height;
  return k * position * (2 - k - (1 - k) * xi) / (1 - k * (1 - k) * xi);
}

double ZhangColumn::position(double initial_position) const {
  // From X = (1 - kappa)^2 x / [1 - kappa (1 - kappa) x/h0].
  const double k = kappa();
  return initial_position / ((1 - k) * (1 - k) + k * (1 - k) * initial_position / column().height);
}

std::unique_ptr<ColumnSolution> column_solution(const std::string& name, const Column& column) {
  if (name == "hencky") return std::make_unique<HenckyColumn>(column);
  if (name == "zhang") return std::make_unique<ZhangColumn>(column);
  throw std::invalid_argument("no column solution is called " + name);
}

double stress_distance(const ColumnSolution& other, const ColumnSolution& exact) {
  constexpr int points = 4096;  // midpoint rule on smooth fields: the quadrature error is below 1e-7 of the distance
  const double height = std::min(other.top(), exact.top());
  double difference = 0.0, norm = 0.0;
  for (int i = 0; i < points; ++i) {
    const double x = (i + 0.5) * height / points;
    difference += std::pow(other.stress(x) - exact.stress(x), 2);
    norm += std::pow(exact.stress(x), 2);
  }
  return std::sqrt(difference / norm);
}

}  // namespace mpm::reference
