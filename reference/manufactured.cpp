#include "reference/manufactured.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>
#include <type_traits>
#include <unsupported/Eigen/AutoDiff>

namespace mpm::reference {

namespace {

using std::numbers::pi;

/// A number that carries its first derivatives, each of which carries its own: second derivatives by forward
/// differentiation, in `N` variables.
template <int N>
using FirstOrder = Eigen::AutoDiffScalar<Eigen::Matrix<double, N, 1>>;
template <int N>
using SecondOrder = Eigen::AutoDiffScalar<Eigen::Matrix<FirstOrder<N>, N, 1>>;

using InSpace = SecondOrder<2>;
using InTime = SecondOrder<1>;

/// The independent variable number `index`.
template <int N>
SecondOrder<N> variable(double value, int index) {
  SecondOrder<N> number(FirstOrder<N>(value, N, index));
  for (int i = 0; i < N; ++i) number.derivatives()[i] = FirstOrder<N>(i == index ? 1.0 : 0.0);
  return number;
}

/// A function of space and time is differentiated by one of them while the other stays a plain number.
template <class Length, class Time>
using Mixed = std::conditional_t<std::is_same_v<Length, double>, Time, Length>;

/// u along both axes.
template <class Number>
using Vector = std::array<Number, 2>;

template <class Number>
Number zero() {
  if constexpr (std::is_same_v<Number, double>)
    return 0.0;
  else
    return Number(typename Number::Scalar(0.0));
}

// Eigen's numbers bring their own functions along, found by their arguments; plain numbers need these.
using std::cos;
using std::sin;
using std::sqrt;

struct StandingWave {
  static constexpr int dimension = 1;
  double amplitude, wave_number, angular_frequency;

  double period() const { return 2 * pi / angular_frequency; }

  template <class Length, class Time>
  Vector<Mixed<Length, Time>> displacement(const Vector<Length>& initial, const Time& time) const {
    using Number = Mixed<Length, Time>;
    const Length shape = sin(initial[0] * wave_number);
    const Time swing = sin(time * angular_frequency) * amplitude;
    return {Number(shape * swing), zero<Number>()};
  }
};

struct AxisAligned {
  static constexpr int dimension = 2;
  double amplitude, wave_number, angular_frequency;

  double period() const { return 2 * pi / angular_frequency; }

  template <class Length, class Time>
  Vector<Mixed<Length, Time>> displacement(const Vector<Length>& initial, const Time& time) const {
    using Number = Mixed<Length, Time>;
    const Length along_x = sin(initial[0] * wave_number), along_y = sin(initial[1] * wave_number);
    const Time swing = sin(time * angular_frequency) * amplitude;  // half a turn later is its negative
    return {Number(along_x * swing), Number(along_y * -swing)};
  }
};

/// The displacement of `arm` when it turns by `angle`, without the cancellation in cos(angle) - 1.
template <class Number, class Length, class Angle>
Vector<Number> turned(const Vector<Length>& arm, const Angle& angle) {
  const Angle sine = sin(angle * 0.5), cosine = cos(angle * 0.5);
  const Angle along = sine * sine * (-2.0), across = sine * cosine * 2.0;
  return {Number(along * arm[0] - across * arm[1]), Number(across * arm[0] + along * arm[1])};
}

struct Rotation {
  static constexpr int dimension = 2;
  double angular_velocity;
  Place center;

  double period() const { return 2 * pi / std::abs(angular_velocity); }

  template <class Length, class Time>
  Vector<Mixed<Length, Time>> displacement(const Vector<Length>& initial, const Time& time) const {
    const Vector<Length> arm{Length(initial[0] - center[0]), Length(initial[1] - center[1])};
    const Time angle = time * angular_velocity;
    return turned<Mixed<Length, Time>>(arm, angle);
  }
};

/// Material between two radii.
struct Annulus {
  double inner, outer;
  Place center;

  double mean() const { return (inner + outer) / 2; }
};

struct GeneralisedVortex {
  static constexpr int dimension = 2;
  double amplitude, duration;
  Annulus ring;

  double period() const { return duration; }

  template <class Length, class Time>
  Vector<Mixed<Length, Time>> displacement(const Vector<Length>& initial, const Time& time) const {
    using Number = Mixed<Length, Time>;
    const Vector<Length> arm{Length(initial[0] - ring.center[0]), Length(initial[1] - ring.center[1])};
    const Length radius = sqrt(arm[0] * arm[0] + arm[1] * arm[1]);
    if (radius < ring.inner || radius > ring.outer) return {zero<Number>(), zero<Number>()};
    const Length s = (radius - ring.mean()) * (2 / (ring.outer - ring.inner));
    const Length root = 1.0 - s * s;
    const Time swing = sin(time * (2 * pi / duration)) * amplitude;
    const Number angle = root * root * swing;
    return turned<Number>(arm, angle);
  }
};

struct ExpandingRing {
  static constexpr int dimension = 2;
  double amplitude, angular_frequency;
  Annulus ring;

  double period() const { return 2 * pi / angular_frequency; }

  /// k [1/m^3]: between the faces f only falls, so |f| is largest at one of them.
  double scale() const {
    const double at_inner = ring.inner * ring.inner * (3 * ring.outer - ring.inner) / 6;
    const double at_outer = ring.outer * ring.outer * (3 * ring.inner - ring.outer) / 6;
    return 1 / std::max(std::abs(at_inner), std::abs(at_outer));
  }

  template <class Length, class Time>
  Vector<Mixed<Length, Time>> displacement(const Vector<Length>& initial, const Time& time) const {
    using Number = Mixed<Length, Time>;
    const Vector<Length> arm{Length(initial[0] - ring.center[0]), Length(initial[1] - ring.center[1])};
    const Length square = arm[0] * arm[0] + arm[1] * arm[1];
    const Length shape =  // f / R
        (square * (1.0 / 3) - sqrt(square) * ring.mean() + ring.inner * ring.outer) * scale();
    const Time swing = sin(time * angular_frequency) * amplitude;
    const Number stretch = shape * swing;
    return {Number(stretch * arm[0]), Number(stretch * arm[1])};
  }
};

/// Lamé's constants of the law; in one dimension those that make it one-dimensional.
struct Constants {
  double density, lambda, mu;
};

Constants constants_of(const Solid& solid, int dimension) {
  const double nu = solid.poissons_ratio, e = solid.youngs_modulus;
  if (dimension == 1) return {solid.density, 0.0, e / 2};
  return {solid.density, e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))};
}

/// det F - 1 from du/dX, to full precision for small strains.
double dilation(const std::array<double, 4>& gradient) {
  return gradient[0] + gradient[3] + gradient[0] * gradient[3] - gradient[1] * gradient[2];
}

/// What follows from a motion's displacement.
template <class Motion>
class SolutionOf : public ManufacturedSolution {
 public:
  SolutionOf(const Motion& motion, const Solid& solid)
      : motion_(motion), constants_(constants_of(solid, Motion::dimension)) {}

  int dimension() const override { return Motion::dimension; }
  double period() const override { return motion_.period(); }

  Place displacement(const Place& initial, double time) const override {
    return motion_.displacement(initial, time);
  }

  Place velocity(const Place& initial, double time) const override {
    const FirstOrder<1> moment(time, 1, 0);
    const auto moved = motion_.displacement(initial, moment);
    return {moved[0].derivatives()[0], moved[1].derivatives()[0]};
  }

  Place body_force(const Place& initial, double time) const override {
    const Vector<InSpace> place{variable<2>(initial[0], 0), variable<2>(initial[1], 1)};
    const Vector<InSpace> in_space = motion_.displacement(place, time);
    const Vector<InTime> in_time = motion_.displacement(initial, variable<1>(time, 0));
    std::array<double, 4> gradient;
    std::array<std::array<double, 3>, 2> second;
    Place acceleration;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& slope = in_space[i].derivatives();
      for (int j = 0; j < 2; ++j) gradient[2 * i + static_cast<std::size_t>(j)] = slope[j].value();
      second[i] = {slope[0].derivatives()[0], slope[0].derivatives()[1], slope[1].derivatives()[1]};
      acceleration[i] = in_time[i].derivatives()[0].derivatives()[0];
    }
    const Place divergence = stress_divergence(constants_.lambda, constants_.mu, gradient, second);
    return {acceleration[0] - divergence[0] / constants_.density,
            acceleration[1] - divergence[1] / constants_.density};
  }

  CauchyStress stress(const Place& initial, double time) const override {
    const std::array<double, 4> h = gradient(initial, time);
    const double change = dilation(h), j = 1 + change;
    const double mean = constants_.lambda * std::log1p(change) / j, mu = constants_.mu / j;
    // F F^T - I, without taking the identity off what contains it.
    return {mean + mu * (2 * h[0] + h[0] * h[0] + h[1] * h[1]),
            mean + mu * (2 * h[3] + h[2] * h[2] + h[3] * h[3]), mean,
            mu * (h[1] + h[2] + h[0] * h[2] + h[1] * h[3])};
  }

  std::array<double, 4> deformation_gradient(const Place& initial, double time) const override {
    const std::array<double, 4> h = gradient(initial, time);
    return {1 + h[0], h[1], h[2], 1 + h[3]};
  }

 protected:
  /// du/dX, row-major.
  std::array<double, 4> gradient(const Place& initial, double time) const {
    const Vector<FirstOrder<2>> place{FirstOrder<2>(initial[0], 2, 0), FirstOrder<2>(initial[1], 2, 1)};
    const auto moved = motion_.displacement(place, time);
    const auto &x = moved[0].derivatives(), &y = moved[1].derivatives();
    return {x[0], x[1], y[0], y[1]};
  }

 private:
  Motion motion_;
  Constants constants_;
};

/// A wave so small that the law is linear.
class VibratingBar final : public SolutionOf<StandingWave> {
 public:
  VibratingBar(const StandingWave& motion, const Solid& solid)
      : SolutionOf(motion, solid), modulus_(solid.youngs_modulus) {}

  Place body_force(const Place&, double) const override { return {0.0, 0.0}; }
  CauchyStress stress(const Place& initial, double time) const override {
    return {modulus_ * gradient(initial, time)[0], 0.0, 0.0, 0.0};
  }

 private:
  double modulus_;
};

void require(bool condition, const std::string& name, const std::string& expected, double found) {
  if (!condition)
    throw std::invalid_argument(name + ": expected " + expected + ", found " + std::to_string(found));
}

/// Takes a motion's parameters by name and knows which nobody has asked for.
class Reading {
 public:
  explicit Reading(const Parameters& parameters) : parameters_(parameters) {}

  double required(const std::string& name) {
    asked_.insert(name);
    const auto entry = parameters_.find(name);
    if (entry == parameters_.end()) throw std::invalid_argument(name + ": expected a number, found none");
    require(std::isfinite(entry->second), name, "a finite number", entry->second);
    return entry->second;
  }
  double optional(const std::string& name, double otherwise) {
    asked_.insert(name);
    return parameters_.contains(name) ? required(name) : otherwise;
  }
  double positive(const std::string& name, double otherwise) {
    const double value = optional(name, otherwise);
    require(value > 0, name, "a number above zero", value);
    return value;
  }
  Place center() { return {optional("center_x", 0.0), optional("center_y", 0.0)}; }
  Annulus annulus() {
    const double inner = positive("inner_radius", 0.75), outer = optional("outer_radius", 1.25);
    require(outer > inner, "outer_radius", "a radius above the inner", outer);
    return {inner, outer, center()};
  }
  /// An amplitude of which F stays regular while it is below `limit`.
  double amplitude_below(double limit) {
    const double value = required("amplitude");
    require(std::abs(value) < limit, "amplitude",
            "less than " + std::to_string(limit) + ", where the deformation gradient inverts", value);
    return value;
  }
  void finish() const {
    for (const auto& [name, value] : parameters_)
      if (!asked_.contains(name)) throw std::invalid_argument(name + ": the motion has no such parameter");
  }

 private:
  const Parameters& parameters_;
  std::set<std::string> asked_;
};

double wave_speed(const Solid& solid) { return std::sqrt(solid.youngs_modulus / solid.density); }

/// A wave of which `length` holds `half_waves` halves.
template <class Wave>
Wave make_wave(Reading& reading, const Solid& solid, double half_waves) {
  const double wave_number = half_waves * pi / reading.positive("length", 1.0);
  return {reading.amplitude_below(1 / wave_number), wave_number, wave_number * wave_speed(solid)};
}

ExpandingRing make_ring(Reading& reading, const Solid& solid) {
  require(solid.poissons_ratio == 0, "poissons_ratio", "0, or the ring's faces are not free of traction",
          solid.poissons_ratio);
  ExpandingRing motion{0.0, 0.0, reading.annulus()};
  motion.angular_frequency = reading.positive("angular_frequency", wave_speed(solid) / motion.ring.mean());
  // Radially the strain is largest halfway, k w^2; around, |f|/R is at most 1/R_i.
  const double half_width = (motion.ring.outer - motion.ring.inner) / 2;
  const double steepest = motion.scale() * half_width * half_width;
  motion.amplitude = reading.amplitude_below(1 / std::max(steepest, 1 / motion.ring.inner));
  return motion;
}

Rotation make_rotation(Reading& reading) {
  const double angular_velocity = reading.required("angular_velocity");
  require(angular_velocity != 0, "angular_velocity", "a number that is not zero", angular_velocity);
  return {angular_velocity, reading.center()};
}

GeneralisedVortex make_vortex(Reading& reading) {
  return {reading.required("amplitude"), reading.positive("period", 2.0), reading.annulus()};
}

void check(const Solid& solid) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  require(positive(solid.density), "density", "a number above zero", solid.density);
  require(positive(solid.youngs_modulus), "youngs_modulus", "a number above zero", solid.youngs_modulus);
  require(solid.poissons_ratio >= 0 && solid.poissons_ratio < 0.5, "poissons_ratio",
          "a number from 0 to below 0.5", solid.poissons_ratio);
}

template <class Motion>
std::unique_ptr<ManufacturedSolution> solution_of(const Motion& motion, const Solid& solid) {
  return std::make_unique<SolutionOf<Motion>>(motion, solid);
}

std::unique_ptr<ManufacturedSolution> read_solution(const std::string& name, Reading& reading,
                                                    const Solid& solid) {
  if (name == "standing_wave") return solution_of(make_wave<StandingWave>(reading, solid, 1.0), solid);
  if (name == "axis_aligned") return solution_of(make_wave<AxisAligned>(reading, solid, 1.0), solid);
  if (name == "generalised_vortex") return solution_of(make_vortex(reading), solid);
  if (name == "expanding_ring") return solution_of(make_ring(reading, solid), solid);
  if (name == "rotation") return solution_of(make_rotation(reading), solid);
  if (name == "vibrating_bar")
    return std::make_unique<VibratingBar>(make_wave<StandingWave>(reading, solid, 0.5), solid);
  throw std::invalid_argument("no manufactured solution is called " + name);
}

}  // namespace

Place stress_divergence(double lambda, double mu, const std::array<double, 4>& gradient,
                        const std::array<std::array<double, 3>, 2>& second) {
  const double change = dilation(gradient), j = 1 + change;
  // F^-1 times J, row-major.
  const std::array<double, 4> adjugate{1 + gradient[3], -gradient[1], -gradient[2], 1 + gradient[0]};
  Place slope;  // Grad J
  for (std::size_t axis = 0; axis < 2; ++axis)
    slope[axis] = adjugate[0] * second[0][axis] + adjugate[1] * second[1][axis] +
                  adjugate[2] * second[0][axis + 1] + adjugate[3] * second[1][axis + 1];
  const double factor = (mu + lambda * (1 - std::log1p(change))) / (j * j);
  return {mu * (second[0][0] + second[0][2]) + factor * (adjugate[0] * slope[0] + adjugate[2] * slope[1]),
          mu * (second[1][0] + second[1][2]) + factor * (adjugate[1] * slope[0] + adjugate[3] * slope[1])};
}

std::unique_ptr<ManufacturedSolution> manufactured_solution(const std::string& name,
                                                            const Parameters& parameters,
                                                            const Solid& solid) {
  check(solid);
  Reading reading(parameters);
  auto solution = read_solution(name, reading, solid);
  reading.finish();
  return solution;
}

}  // namespace mpm::reference
