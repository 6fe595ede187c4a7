#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

/// Limit loads of a strip footing on the surface of a Mohr-Coulomb half space with associated flow: the mean
/// pressure
///   q_u = c Nc + q Nq + 1/2 gamma B Ngamma
/// from cohesion c [Pa], surcharge q beside the footing [Pa], unit weight gamma [N/m^3] and full width B [m].
/// Every friction angle is in radians; every factor is without unit.
namespace mpm::reference {

/// The contact between footing and soil: no shear at all, or no slip below the soil's own strength.
enum class Roughness { smooth, rough };

/// Surcharge factor of weightless soil, exact for smooth and rough [Prandtl20; Reissner24]:
/// Nq = exp(pi tan phi) tan^2(pi/4 + phi/2). For 0 <= phi < pi/2; throws std::invalid_argument outside.
double exact_nq(double friction_angle);

/// Cohesion factor of weightless soil, exact for smooth and rough [Prandtl20]: Nc = (Nq - 1) cot phi, which
/// tends to 2 + pi as phi -> 0; full precision down to phi = 0. For 0 <= phi < pi/2; throws
/// std::invalid_argument outside.
double exact_nc(double friction_angle);

/// [Terzaghi43]: Nq = exp((3 pi/2 - phi) tan phi) / (2 cos^2(pi/4 + phi/2)). An upper estimate from a
/// mechanism with a wedge at phi below a rough base. For 0 <= phi < pi/2; throws std::invalid_argument
/// outside.
double terzaghi_nq(double friction_angle);

/// [Terzaghi43]: Nc = (Nq - 1) cot phi, which tends to 1 + 3 pi/2 = 5.71 as phi -> 0; full precision down to
/// phi = 0. For 0 <= phi < pi/2; throws std::invalid_argument outside.
double terzaghi_nc(double friction_angle);

/// Self-weight factor read from Terzaghi's chart, as secondary sources quote it: 2.5, 5.0, 9.7 and 19.7 at
/// 15, 20, 25 and 30 degrees. Provenance: secondary, chart; good to about two digits. Nothing at any other
/// angle, since between the quoted values there is no datum.
std::optional<double> terzaghi_ngamma_chart(double friction_angle);

/// Self-weight factor from the mechanism behind Terzaghi's chart [Terzaghi43], computed [Kumbhojkar93]:
/// Ngamma = (4 Pp - gamma B^2 tan(phi)/2) / (gamma B^2), Pp the least passive force on a face of the wedge
/// that the rough base carries along.
///
/// The faces rise at phi from the wedge's tip, half a width below the base times tan phi, to the footing's
/// edges; Pp acts vertically, at phi to their normal, in their lower third point. Beyond a face a logarithmic
/// spiral runs from the tip into Rankine's passive wedge, which begins at the ray that goes down from the
/// edge at pi/4 - phi/2. All friction along the spiral passes through its centre, on that ray's backward
/// extension: moments about the centre give Pp, and the centre with the least of it is taken. A limit
/// equilibrium, bound to neither side by theory; it lies above the exact factor, by 30 % at 30 degrees and by
/// 39 % at 45. The chart agrees with it within 3 % at 30 degrees and lies above it at smaller angles, by 37 %
/// at 20. For 1 deg <= phi <= 50 deg; throws std::invalid_argument outside.
double terzaghi_ngamma(double friction_angle);

/// Self-weight factor, an approximation [Meyerhof63]: Ngamma = (Nq - 1) tan(1.4 phi), Nq the exact one.
/// For 0 <= phi < pi/2.8; throws std::invalid_argument outside.
double meyerhof_ngamma(double friction_angle);

/// Self-weight factor, exact for c = q = 0 and associated flow; see SlipLineField, whose range and exceptions
/// it has.
double exact_ngamma(double friction_angle, Roughness roughness);

/// The three factors of one friction angle.
struct BearingCapacityFactors {
  double cohesion;     ///< Nc
  double surcharge;    ///< Nq
  double self_weight;  ///< Ngamma
};

/// A strip footing and the soil it stands on; nothing negative.
struct StripFooting {
  double width;      ///< B, full [m]
  double cohesion;   ///< c [Pa]
  double surcharge;  ///< q beside the footing [Pa]; for a footing embedded by D, gamma D if the soil above is
                     ///< load only
  double unit_weight;  ///< gamma [N/m^3]
};

/// The mean pressure [Pa] at which the footing fails, by adding up the three terms. With exact factors and
/// one term only it is exact. The sum of several is conservative, because each term has its own worst
/// mechanism and the soil but one: with surcharge and self-weight together it errs on the safe side by up to
/// 30 % [DavisBooker71].
double superposed_capacity(const StripFooting& footing, const BearingCapacityFactors& factors);

/// A strip footing with its base below the surface of dry sand, which has no cohesion.
struct EmbeddedFooting {
  double width;           ///< B, full [m]
  double depth;           ///< D of the base below the surface [m]
  double unit_weight;     ///< gamma [N/m^3]
  double friction_angle;  ///< phi [rad]
};

/// A formula of bearing capacity as practice uses it, for a strip on sand:
/// q_u = gamma D Nq dq + 1/2 gamma B Ngamma dgamma.
struct CapacityFormula {
  const char* name;                            ///< an identifier
  const char* title;                           ///< factors and source, for a person
  double (*pressure)(const EmbeddedFooting&);  ///< mean pressure on the base at failure [Pa]
};

/// The formulas this project compares with measurements, none of them with a factor for the length of the
/// footing:
/// exact                the exact factors of each term alone, rough base, added up;
/// terzaghi             terzaghi_nq and terzaghi_ngamma;
/// meyerhof             exact_nq and meyerhof_ngamma;
/// meyerhof_with_depth  the same with dq = dgamma = 1 + 0.1 tan(pi/4 + phi/2) D/B [Meyerhof63], for the
///                      strength of the soil above the base, which the others leave out.
/// Friction angles from 1 to 45 degrees, with depth factors above 10; width above zero, nothing else
/// negative; throw std::invalid_argument otherwise. `exact` takes about 0.1 s.
std::span<const CapacityFormula> capacity_formulas();

/// In-plane Cauchy stress, tension positive.
struct InPlaneStress {
  double xx, yy, xy;
};

/// The exact limit state of a strip footing on cohesionless soil with weight and without surcharge (the
/// "Ngamma problem"), by the method of characteristics.
///
/// With nothing but weight there is no length near the footing's edge, so the plastic stress field is
/// self-similar: with r, theta the polar coordinates about the edge, theta = 0 along the free surface,
/// growing downwards to pi along the base,
///   mean compression p = gamma r s(theta),  direction psi(theta) of the largest compression from the
///   surface.
/// Equilibrium and the yield condition, deviator = p sin phi, then leave two ordinary differential equations,
///   s'   = [cos(2 psi - theta) + s sin 2 chi] / (cos 2 chi - sin phi)
///   psi' = [sin theta - sin phi sin(2 psi - theta) - s cos^2 phi] / [2 s sin phi (cos 2 chi - sin phi)],
/// chi = psi - theta, singular where the ray is itself a slip line (cos 2 chi = sin phi). They are integrated
/// with the parameter t that cancels the denominators, d theta/dt = 2 sin phi (cos 2 chi - sin phi), from the
/// base, where
///   smooth: psi = pi/2, no shear;   rough: psi = 3 pi/4 + phi/2, friction fully mobilised and directed to
///   the axis,
/// towards the passive Rankine wedge, psi = 0, s = sin theta / (1 - sin phi), which begins at the singular
/// ray theta_1 = pi/4 - phi/2. All solutions run into some singular ray as t grows, only one into theta_1:
/// the pressure at the base is found by bisection on the sign of psi at the end.
///
/// Smooth: this field reaches to the footing's centre. Rough: it reaches to the slip line through the point
/// of the axis where psi = pi/2, as symmetry demands; between that line and the base a wedge of soil is
/// carried by the footing like a part of it, and only the outer `sliding_share` of the base slides. The
/// capacity follows from the equilibrium of the soil above the ray theta_* from the edge to that point,
///   Ngamma = 1/2 [s(theta_*) (1 + sin phi) - sin theta_*] / |cos theta_*|,  theta_* = pi for a smooth base.
/// A stress field nowhere beyond yield is a lower bound once it is extended through the rest of the half
/// space; that it can be, and that a mechanism matches it, hence that the factor is exact, is shown in
/// [Martin05] and not again here. The results agree with the factors published there to every digit.
class SlipLineField {
 public:
  /// Solves the problem for 1 deg <= friction_angle <= 50 deg [rad] with so many steps of the classical
  /// Runge-Kutta method, steps >= 500; throws std::invalid_argument otherwise. With the default the relative
  /// error of Ngamma is below 1e-7 from 5 to 45 degrees (1e-9 from 10) and below 1e-4 from 1 to 50, falling
  /// with the fourth power of the step; it takes about 0.1 s.
  SlipLineField(double friction_angle, Roughness roughness, int steps = 4000);

  /// Ngamma, twice the mean pressure over gamma B.
  double bearing_capacity_factor() const;

  /// Stress over gamma [m] at x [m] beside the edge (negative below the footing) and height y <= 0 [m] from
  /// the surface; to be multiplied by gamma. It belongs to the failing footing where the field does: to the
  /// outer slip line from below, and for a rough base outside the carried wedge. Throws std::invalid_argument
  /// for y > 0.
  InPlaneStress stress(double x, double y) const;

  /// theta_*: the angle [rad] from the free surface, through the soil, to the ray from the edge to the
  /// deepest point of the carried wedge, which lies on the axis; pi for a smooth base.
  double wedge_angle() const;
  /// The part of the base along which soil slides, measured from each edge: 1 for smooth, between 0 and 1 for
  /// rough.
  double sliding_share() const;
  /// How far from the edge the outermost slip line comes to the surface, in widths B.
  double reach() const;
  /// How deep the outermost slip line runs, in widths B.
  double depth() const;

 private:
  /// theta, ln s, psi, and ln r along the slip line of either family: `inner`, to which the edge's rays
  /// belong, and `outer`, which crosses them.
  struct Point {
    double angle, log_scale, direction, log_inner, log_outer;
  };

  Point base(double log_scale) const;
  Point rate(const Point& point) const;
  Point advanced(const Point& point, double step) const;
  bool ends_above_rankine(double log_scale) const;
  double base_log_scale() const;
  void trace(double log_scale);
  void find_wedge();
  Point at(double angle) const;

  double sine_, cosine_;  ///< of the friction angle
  double rankine_angle_;  ///< theta_1
  Roughness roughness_;
  int steps_;
  double step_;              ///< of t
  std::vector<Point> path_;  ///< from the base to theta_1
  Point wedge_;              ///< at theta_*
};

}  // namespace mpm::reference
