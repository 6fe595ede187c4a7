#include "reference/bearing_capacity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace mpm::reference {

namespace {

using std::numbers::pi;

constexpr double degree = pi / 180;

void require_friction_angle(double friction_angle, double limit) {
  if (!(friction_angle >= 0 && friction_angle < limit))
    throw std::invalid_argument("a friction angle is outside the range of its bearing-capacity factor");
}

/// ln Nq; since ln tan(pi/4 + phi/2) = asinh(tan phi), it goes to zero with phi without losing digits.
double exact_log_nq(double friction_angle) {
  const double tangent = std::tan(friction_angle);
  return pi * tangent + 2 * std::asinh(tangent);
}

/// ln Nq of Terzaghi, with 2 cos^2(pi/4 + phi/2) = 1 - sin phi.
double terzaghi_log_nq(double friction_angle) {
  return (1.5 * pi - friction_angle) * std::tan(friction_angle) - std::log1p(-std::sin(friction_angle));
}

/// Pp over gamma B^2 for the spiral whose centre is `back` widths B behind the footing's edge, up along the
/// slip line of Rankine's wedge. Lengths in B, levers from the centre, angles downwards from the horizontal.
double passive_force(double friction_angle, double back) {
  const double tangent = std::tan(friction_angle), rankine = pi / 4 - friction_angle / 2;
  const double cosine = std::cos(rankine), sine = std::sin(rankine);
  const double tip_x = back * cosine - 0.5, tip_y = back * sine + tangent / 2;
  const double first = std::hypot(tip_x, tip_y), first_angle = std::atan2(tip_y, tip_x);
  const double last = first * std::exp((first_angle - rankine) * tangent);

  // The soil between the spiral, the face and the surface: a sector, less the triangle above the face, and
  // the near half of Rankine's wedge.
  const auto primitive = [&](double radius, double angle) {
    return std::pow(radius, 3) * (std::sin(angle) - 3 * tangent * std::cos(angle));
  };
  const double sector =
      (primitive(first, first_angle) - primitive(last, rankine)) / (3 * (1 + 9 * tangent * tangent));
  const double triangle = back * first * std::sin(first_angle - rankine) / 2 * (back * cosine + tip_x) / 3;
  const double side = last - back, height = side * sine;
  const double wedge = height * side * cosine / 2 * (back + side * 2 / 3) * cosine;
  const double rankine_force = height * height / (2 * std::pow(std::tan(rankine), 2));
  const double resisting = sector - triangle + wedge + rankine_force * (back * sine + height * 2 / 3);
  return resisting / (1.0 / 3 - back * cosine);
}

/// The position of the least value of `function`, which falls and then rises between `low` and `high`.
template <class Function>
double position_of_minimum(const Function& function, double low, double high) {
  constexpr double golden = std::numbers::phi - 1;
  for (int step = 0; step < 60; ++step) {  // to 1e-12 of the interval
    const double left = high - golden * (high - low), right = low + golden * (high - low);
    if (function(left) < function(right))
      high = right;
    else
      low = left;
  }
  return (low + high) / 2;
}

void require_embedded_footing(const EmbeddedFooting& footing, double least_angle) {
  constexpr double rounding = 1e-9 * degree;  // so that the ends of the range are inside
  const bool has_angle =
      footing.friction_angle > least_angle - rounding && footing.friction_angle < 45 * degree + rounding;
  if (!(footing.width > 0 && footing.depth >= 0 && footing.unit_weight >= 0 && has_angle))
    throw std::invalid_argument("a footing is outside the range of the formula for its capacity");
}

double capacity(const EmbeddedFooting& footing, double nq, double ngamma) {
  return superposed_capacity({footing.width, 0, footing.unit_weight * footing.depth, footing.unit_weight},
                             {0, nq, ngamma});
}

double exact_capacity(const EmbeddedFooting& footing) {
  require_embedded_footing(footing, degree);
  return capacity(footing, exact_nq(footing.friction_angle),
                  exact_ngamma(footing.friction_angle, Roughness::rough));
}

double terzaghi_capacity(const EmbeddedFooting& footing) {
  require_embedded_footing(footing, degree);
  return capacity(footing, terzaghi_nq(footing.friction_angle), terzaghi_ngamma(footing.friction_angle));
}

double meyerhof_capacity(const EmbeddedFooting& footing) {
  require_embedded_footing(footing, degree);
  return capacity(footing, exact_nq(footing.friction_angle), meyerhof_ngamma(footing.friction_angle));
}

double meyerhof_capacity_with_depth(const EmbeddedFooting& footing) {
  require_embedded_footing(footing, 10 * degree);
  const double depth_factor =
      1 + 0.1 * std::tan(pi / 4 + footing.friction_angle / 2) * footing.depth / footing.width;
  return meyerhof_capacity(footing) * depth_factor;
}

constexpr CapacityFormula formulas[] = {
    {"exact", "exact factors added up", exact_capacity},
    {"terzaghi", "Terzaghi (1943)", terzaghi_capacity},
    {"meyerhof", "Meyerhof (1963)", meyerhof_capacity},
    {"meyerhof_with_depth", "Meyerhof (1963) with depth factors", meyerhof_capacity_with_depth},
};

}  // namespace

double exact_nq(double friction_angle) {
  require_friction_angle(friction_angle, pi / 2);
  return std::exp(exact_log_nq(friction_angle));
}

double exact_nc(double friction_angle) {
  require_friction_angle(friction_angle, pi / 2);
  if (friction_angle == 0) return 2 + pi;
  return std::expm1(exact_log_nq(friction_angle)) / std::tan(friction_angle);
}

double terzaghi_nq(double friction_angle) {
  require_friction_angle(friction_angle, pi / 2);
  return std::exp(terzaghi_log_nq(friction_angle));
}

double terzaghi_nc(double friction_angle) {
  require_friction_angle(friction_angle, pi / 2);
  if (friction_angle == 0) return 1 + 1.5 * pi;
  return std::expm1(terzaghi_log_nq(friction_angle)) / std::tan(friction_angle);
}

std::optional<double> terzaghi_ngamma_chart(double friction_angle) {
  constexpr std::array<std::pair<double, double>, 4> chart{{{15, 2.5}, {20, 5.0}, {25, 9.7}, {30, 19.7}}};
  constexpr double tolerance =
      1e-6;  // degrees: the rounding of whoever converted them, far below the chart's own
  for (const auto& [degrees, factor] : chart)
    if (std::abs(friction_angle / degree - degrees) < tolerance) return factor;
  return std::nullopt;
}

double terzaghi_ngamma(double friction_angle) {
  constexpr double rounding = 1e-9 * degree;  // so that 1 and 50 degrees themselves are inside
  if (!(friction_angle > degree - rounding && friction_angle < 50 * degree + rounding))
    throw std::invalid_argument("Terzaghi's factor of weight needs a friction angle from 1 to 50 degrees");
  const auto force = [&](double back) { return passive_force(friction_angle, back); };
  // Beyond a third of a width, measured along the surface, the force would turn the soil with its weight.
  const double furthest = 1 / (3 * std::cos(pi / 4 - friction_angle / 2));
  const double least = force(position_of_minimum(force, 0, furthest));
  return 4 * least - std::tan(friction_angle) / 2;
}

double meyerhof_ngamma(double friction_angle) {
  require_friction_angle(friction_angle, pi / 2.8);
  return std::expm1(exact_log_nq(friction_angle)) * std::tan(1.4 * friction_angle);
}

double exact_ngamma(double friction_angle, Roughness roughness) {
  return SlipLineField(friction_angle, roughness).bearing_capacity_factor();
}

double superposed_capacity(const StripFooting& footing, const BearingCapacityFactors& factors) {
  return footing.cohesion * factors.cohesion + footing.surcharge * factors.surcharge +
         footing.unit_weight * footing.width * factors.self_weight / 2;
}

std::span<const CapacityFormula> capacity_formulas() { return formulas; }

SlipLineField::SlipLineField(double friction_angle, Roughness roughness, int steps)
    : sine_(std::sin(friction_angle)),
      cosine_(std::cos(friction_angle)),
      rankine_angle_(pi / 4 - friction_angle / 2),
      roughness_(roughness),
      steps_(steps) {
  constexpr double rounding = 1e-9 * degree;  // so that 1 and 50 degrees themselves are inside
  if (!(friction_angle > degree - rounding && friction_angle < 50 * degree + rounding) || steps < 500)
    throw std::invalid_argument(
        "a slip-line field needs a friction angle from 1 to 50 degrees and 500 steps or more");
  // Near theta_1 a perturbation decays as exp(-4 sin phi cos phi t): forty powers of e are below double
  // precision.
  step_ = 10 / (sine_ * cosine_ * steps_);
  trace(base_log_scale());
  find_wedge();
}

SlipLineField::Point SlipLineField::base(double log_scale) const {
  const double direction = roughness_ == Roughness::smooth ? pi / 2 : pi - rankine_angle_;
  return {pi, log_scale, direction, 0, 0};
}

SlipLineField::Point SlipLineField::rate(const Point& point) const {
  const double s = std::exp(point.log_scale);
  const double chi = point.direction - point.angle, turned = 2 * point.direction - point.angle;
  // A slip line runs at psi +- theta_1, hence at chi +- theta_1 to the ray: dr = r cot(chi +- theta_1) d
  // theta.
  const double inner = chi + rankine_angle_, outer = chi - rankine_angle_;
  return {.angle = 2 * sine_ * (std::cos(2 * chi) - sine_),
          .log_scale = 2 * sine_ * (std::cos(turned) / s + std::sin(2 * chi)),
          .direction = (std::sin(point.angle) - sine_ * std::sin(turned)) / s - cosine_ * cosine_,
          .log_inner = -4 * sine_ * std::sin(outer) * std::cos(inner),
          .log_outer = -4 * sine_ * std::cos(outer) * std::sin(inner)};
}

SlipLineField::Point SlipLineField::advanced(const Point& point, double step) const {
  const auto moved = [](const Point& from, double time, const Point& rate) -> Point {
    return {from.angle + time * rate.angle, from.log_scale + time * rate.log_scale,
            from.direction + time * rate.direction, from.log_inner + time * rate.log_inner,
            from.log_outer + time * rate.log_outer};
  };
  const Point first = rate(point);
  const Point second = rate(moved(point, step / 2, first));
  const Point third = rate(moved(point, step / 2, second));
  const Point fourth = rate(moved(point, step, third));
  const Point half = moved(moved(point, step / 6, first), step / 3, second);
  return moved(moved(half, step / 3, third), step / 6, fourth);
}

bool SlipLineField::ends_above_rankine(double log_scale) const {
  Point point = base(log_scale);
  // psi only falls. Far too high a pressure may end as not a number, which counts as too high.
  for (int i = 0; i < steps_ && point.direction > 0; ++i) point = advanced(point, step_);
  return point.direction > 0;
}

double SlipLineField::base_log_scale() const {
  double low = -6, high = 14;  // from below Ngamma at 1 degree to above it at 50
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = (low + high) / 2;
    (ends_above_rankine(middle) ? low : high) = middle;
  }
  return low;
}

void SlipLineField::trace(double log_scale) {
  // Closer to theta_1 the field is Rankine's to far below the error of the steps.
  constexpr double arrived = 1e-12;
  path_.reserve(static_cast<std::size_t>(steps_) + 1);
  path_.push_back(base(log_scale));
  for (int i = 0; i < steps_; ++i) {
    const Point next = advanced(path_.back(), step_);
    if (next.angle - rankine_angle_ < arrived || next.angle >= path_.back().angle) break;
    path_.push_back(next);
  }
}

/// The point where psi = pi/2: theta_*, by bisection within the step that passes it.
void SlipLineField::find_wedge() {
  wedge_ = path_.front();
  if (roughness_ == Roughness::smooth) return;
  const auto below = [](const Point& point) { return point.direction < pi / 2; };
  const Point start = *std::prev(std::find_if(path_.begin(), path_.end(), below));
  double low = 0, high = step_;
  for (int halving = 0; halving < 55; ++halving) {
    const double middle = (low + high) / 2;
    (below(advanced(start, middle)) ? high : low) = middle;
  }
  wedge_ = advanced(start, low);
}

double SlipLineField::bearing_capacity_factor() const {
  const double pressure = std::exp(wedge_.log_scale) * (1 + sine_);
  return (pressure - std::sin(wedge_.angle)) / (2 * std::abs(std::cos(wedge_.angle)));
}

SlipLineField::Point SlipLineField::at(double angle) const {
  // Counted from the base, angles fall: the last stored point that is not yet past the one sought.
  const auto next = std::upper_bound(path_.begin(), path_.end(), angle,
                                     [](double value, const Point& point) { return value > point.angle; });
  if (next == path_.begin()) return path_.front();
  const Point& start = *std::prev(next);
  double low = 0, high = step_;
  for (int halving = 0; halving < 55; ++halving) {
    const double middle = (low + high) / 2;
    (advanced(start, middle).angle < angle ? high : low) = middle;
  }
  return advanced(start, low);
}

InPlaneStress SlipLineField::stress(double x, double y) const {
  if (y > 0) throw std::invalid_argument("there is no soil above the surface");
  const double angle = std::atan2(std::abs(y), x), radius = std::hypot(x, y);
  double pressure = -y / (1 - sine_), direction = 0;
  if (angle > path_.back().angle) {
    const Point point = at(angle);
    pressure = radius * std::exp(point.log_scale);
    direction = point.direction;
  }
  const double deviator = pressure * sine_;
  // psi turns downwards and compression is positive in the field; both signs cancel in the shear.
  return {-pressure - deviator * std::cos(2 * direction), -pressure + deviator * std::cos(2 * direction),
          deviator * std::sin(2 * direction)};
}

double SlipLineField::wedge_angle() const { return wedge_.angle; }

double SlipLineField::sliding_share() const {
  if (roughness_ == Roughness::smooth) return 1;
  return std::exp(-wedge_.log_inner) / std::abs(std::cos(wedge_.angle));
}

double SlipLineField::reach() const {
  // In the Rankine wedge the slip line is straight and comes up as steeply as the ray theta_1 goes down.
  const double start = 0.5 / std::abs(std::cos(wedge_.angle));
  return 2 * start * std::exp(path_.back().log_outer - wedge_.log_outer) * std::cos(rankine_angle_);
}

double SlipLineField::depth() const {
  const double start = 0.5 / std::abs(std::cos(wedge_.angle));
  double deepest = 0;
  for (const Point& point : path_)
    if (point.angle <= wedge_.angle)
      deepest =
          std::max(deepest, start * std::exp(point.log_outer - wedge_.log_outer) * std::sin(point.angle));
  return deepest;
}

}  // namespace mpm::reference
