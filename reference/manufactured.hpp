#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>

/// Motions chosen beforehand, and the body force that makes each of them an exact solution: the method of
/// manufactured solutions [Wallstedt08; Kamojjala15].
///
/// All are of neo-Hookean material,
///   sigma = [lambda ln J I + mu (F F^T - I)] / J,   F = dx/dX,  J = det F,
/// with lambda and mu from the small-strain constants. Two dimensions are plane strain: sigma_zz = lambda ln
/// J / J. In one dimension lateral strain is free of stress and does not change the section: lambda = 0, mu =
/// E/2, hence sigma = E (F - 1/F) / 2. X is an initial place, x(X, t) where it is at time t, u = x - X. At t
/// = 0 nothing is displaced. Velocity and body force are valid at times below zero too.
namespace mpm::reference {

/// What the bodies in motion are made of.
struct Solid {
  double density;         ///< rho, initial [kg/m^3], > 0
  double youngs_modulus;  ///< E of small strains [Pa], > 0
  double poissons_ratio;  ///< nu of small strains [-], in [0, 0.5); no effect in one dimension
};

/// Along the axes x and y [m], [m/s] or [m/s^2]. Solutions in one dimension read and fill the first entry
/// only; the second is zero in what they return.
using Place = std::array<double, 2>;

/// Tension positive [Pa]; in one dimension all but xx are zero.
struct CauchyStress {
  double xx, yy, zz, xy;
};

/// Div P at a place, P = J sigma F^-T the first Piola-Kirchhoff stress [Pa/m]. With H_kLJ = d^2 x_k / dX_L
/// dX_J and (ln J),J = F^-1_Lk H_kLJ,
///   Div P = mu Lap x + [mu + lambda (1 - ln J)] F^-T Grad ln J,
/// since dP_iJ / dF_kL = mu d_ik d_JL + (mu - lambda ln J) F^-1_Jk F^-1_Li + lambda F^-1_Ji F^-1_Lk and H is
/// symmetric in L and J. `gradient` is du/dX row-major; `second` holds for each of u_x and u_y the
/// derivatives XX, XY, YY [1/m].
Place stress_divergence(double lambda, double mu, const std::array<double, 4>& gradient,
                        const std::array<std::array<double, 3>, 2>& second);

/// An exact motion. Thread-safe; no function allocates.
class ManufacturedSolution {
 public:
  virtual ~ManufacturedSolution() = default;

  virtual int dimension() const = 0;
  /// u [m] of the initial place [m] at a time [s].
  virtual Place displacement(const Place& initial, double time) const = 0;
  /// du/dt [m/s].
  virtual Place velocity(const Place& initial, double time) const = 0;
  /// Force per mass that the motion needs [m/s^2]: b = a - Div P / rho.
  virtual Place body_force(const Place& initial, double time) const = 0;
  /// sigma at the place where `initial` has got to.
  virtual CauchyStress stress(const Place& initial, double time) const = 0;
  /// F, row-major {xx, xy, yx, yy} [-]; in one dimension yy is 1.
  virtual std::array<double, 4> deformation_gradient(const Place& initial, double time) const = 0;
  /// Time after which the motion repeats itself [s].
  virtual double period() const = 0;
};

/// Numbers of a motion by name; which there are is said at `manufactured_solution`.
using Parameters = std::map<std::string, double>;

/// A motion by its name. With c = sqrt(E/rho); angles anticlockwise [rad]:
///
/// `standing_wave`, 1D [Wallstedt08]: u = G sin(pi X/L) sin(pi c t/L), both ends at rest. Parameters
/// `amplitude` G [m], |G| pi/L < 1, and `length` L [m], 1 if left out.
///
/// `axis_aligned`, 2D [Wallstedt08; Kamojjala15]: u_x = G sin(pi X/L) sin(pi c t/L), u_y = G sin(pi Y/L)
/// sin(pi c t/L + pi) on the square 0 <= X, Y <= L: its edges slide along themselves. Parameters as above.
///
/// `generalised_vortex`, 2D [Kamojjala15]: every circle between two radii turns about the center by alpha =
/// A sin(2 pi t/T) h(R), h = (1 - s^2)^2, s = (R - R_m) / w, R_m the mean radius and w half the ring's width
/// (for R_m = 1 and w = 1/4 the published 1 - 32 (R - 1)^2 + 256 (R - 1)^4). J = 1. At both radii h and its
/// slope vanish, so there is neither motion nor stress, and outside there is none either; the body force
/// jumps there, because h'' does. The sine starts without angular acceleration, hence with the centripetal
/// one alone, (2 pi A h/T)^2 R. Parameters `amplitude` A [rad], `period` T [s] (2), `inner_radius` (0.75),
/// `outer_radius` (1.25), `center_x`, `center_y` (0) [m].
///
/// `expanding_ring`, 2D [Kamojjala15]: r = R + A sin(omega t) f(R), f = k [R^3/3 - (R_i + R_o) R^2/2 +
/// R_i R_o R], k such that the largest |f| on the ring is 1; to be evaluated on the ring only. Because f' =
/// k (R - R_i)(R - R_o) vanishes on both faces, F_rr = 1 there; the traction on them is P_rR = mu (F_rr -
/// 1/F_rr) + lambda ln J / F_rr, of which the first term is then zero, but the second is not, since the
/// hoop is stretched. Hence both faces are free of traction only for lambda = 0, and any nu but 0 is refused.
/// Parameters `amplitude` A [m], `angular_frequency` omega [rad/s] (c/R_m, that of a thin ring breathing
/// freely), radii and center as above.
///
/// `rotation`, 2D: a rigid turn about the center by omega t. No stress; the body force is centripetal.
/// Parameters `angular_velocity` omega [rad/s], not zero, and the center as above.
///
/// `vibrating_bar`, 1D: u = U sin(pi X/(2L)) sin(omega t), omega = pi c/(2L): the first mode of a linear bar
/// fixed at X = 0 and free at X = L. The body force is zero and the stress E u': exact for a vanishing
/// amplitude. With e = u', |e| <= pi U/(2L), the law's P = E (e - e^2/2 + e^3/2 - ...), so stress and
/// balance of momentum leave out terms of the relative order e/2 and e: the share of the amplitude in the
/// length. Parameters `amplitude` U [m], pi |U|/(2L) < 1, and `length` L [m], 1 if left out.
///
/// Throws std::invalid_argument, its message naming the parameter, for a solid outside its ranges, an
/// unknown motion or parameter, a missing one without a default, and one with which F would invert.
std::unique_ptr<ManufacturedSolution> manufactured_solution(const std::string& name,
                                                            const Parameters& parameters, const Solid& solid);

}  // namespace mpm::reference
