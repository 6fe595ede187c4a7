#pragma once

#include <memory>
#include <string>

namespace mpm::reference {

/// A column standing on a fixed base, free at its top, settled under its own weight; one stress component.
/// X is the initial and x the current height above the base; stress is Cauchy, tension positive.
struct Column {
  double unit_weight;     ///< q = initial density * gravity [Pa/m], > 0
  double height;          ///< h0, initial [m], > 0
  double youngs_modulus;  ///< E [Pa], > 0
};

/// Stress [Pa] at the initial height X [m], whatever the constitutive law, since the mass above a point does
/// not change: sigma(X) = -q (h0 - X).
double equilibrium_stress(const Column& column, double initial_position);

/// The exact column of one constitutive law.
class ColumnSolution {
 public:
  explicit ColumnSolution(const Column& column) : column_(column) {}
  virtual ~ColumnSolution() = default;

  /// Stress [Pa] at the current height x [m], 0 <= x <= top().
  virtual double stress(double position) const = 0;
  /// Current height x [m] of the initial height X [m], 0 <= X <= h0.
  virtual double position(double initial_position) const = 0;

  /// u = x - X [m], negative for settlement.
  double displacement(double initial_position) const { return position(initial_position) - initial_position; }
  /// Current height of the top [m].
  double top() const { return position(column_.height); }
  /// How far the top has come down [m], positive.
  double settlement() const { return -displacement(column_.height); }

 protected:
  const Column& column() const { return column_; }

 private:
  Column column_;
};

/// For Hencky's law sigma = E ln(lambda), to which the rate law [Kiriyama15, Eq. 11] integrates in 1D:
/// x(X) = (E/q) [exp(-q (h0 - X)/E) - exp(-q h0/E)],  sigma(x) = E ln(q x/E + exp(-q h0/E)).
class HenckyColumn final : public ColumnSolution {
 public:
  using ColumnSolution::ColumnSolution;
  double stress(double position) const override;
  double position(double initial_position) const override;
};

/// The published column [Kiriyama15, Eqs. 33 and 34], exact for sigma = 2 E (1 - lambda^(-1/2)). With
/// sigma(0) = -q h0, kappa = sigma(0)/(2E) and xi = x/h0:
/// sigma(x) = sigma(0) [(1 - xi) + kappa xi] / [1 - kappa (1 - kappa) xi]                   (33)
/// u(x) = kappa x [2 - kappa - (1 - kappa) xi] / [1 - kappa (1 - kappa) xi]                   (34, corrected)
/// The print of (34) lacks the factor x, divides by xi where it multiplies, and has the sign of X - x for u.
class ZhangColumn final : public ColumnSolution {
 public:
  using ColumnSolution::ColumnSolution;
  double stress(double position) const override;            ///< (33)
  double position(double initial_position) const override;  ///< the inverse of x -> x - u(x)
  double displacement_at(double position) const;            ///< (34, corrected), by current height [m]

 private:
  double kappa() const;
};

/// "hencky" or "zhang"; throws std::invalid_argument for any other name.
std::unique_ptr<ColumnSolution> column_solution(const std::string& name, const Column& column);

/// Relative L2 distance of two stress fields over the part of the column both cover, relative to `exact`.
double stress_distance(const ColumnSolution& other, const ColumnSolution& exact);

}  // namespace mpm::reference
