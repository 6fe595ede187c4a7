#include "vv/element_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>

#include "reference/element_paths.hpp"
#include "reference/multi_surface_return.hpp"
#include "solver/error.hpp"
#include "solver/linear_elastic.hpp"
#include "solver/mohr_coulomb.hpp"
#include "solver/tensor.hpp"

namespace mpm::vv {
namespace {

/// Stress [Pa] or strain [-] outside the law: components xx, yy, zz, xy.
using Tensor = SymmetricTensor<2, double>;

reference::MohrCoulombSoil soil_of(const MohrCoulomb& material) {
  return {material.youngs_modulus, material.poissons_ratio, material.friction_angle, material.cohesion,
          material.dilation_angle};
}

template <class To, class From>
SymmetricTensor<2, To> converted(const SymmetricTensor<2, From>& tensor) {
  SymmetricTensor<2, To> result;
  for (std::size_t c = 0; c < result.size(); ++c) result[c] = static_cast<To>(tensor[c]);
  return result;
}

double magnitude(const Tensor& tensor) {
  double largest = 0.0;
  for (double component : tensor) largest = std::max(largest, std::abs(component));
  return largest;
}

Tensor difference(const Tensor& a, const Tensor& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]};
}

// ---- paths ----

reference::LoadingPath loading_of(ElementPath path) {
  switch (path) {
    case ElementPath::plane_strain_compression:
    case ElementPath::plane_strain_extension:
      return reference::LoadingPath::biaxial;
    case ElementPath::oedometric_compression:
    case ElementPath::oedometric_extension:
      return reference::LoadingPath::oedometric;
    case ElementPath::simple_shear:
      return reference::LoadingPath::simple_shear;
    case ElementPath::isotropic_tension:
      return reference::LoadingPath::isotropic;
    case ElementPath::random_states:
      break;
  }
  throw std::invalid_argument("random states have no closed form");
}

/// The imposed strain in the end, signed.
double final_strain(const ElementTest& test) {
  const bool compresses =
      test.path == ElementPath::plane_strain_compression || test.path == ElementPath::oedometric_compression;
  return compresses ? -test.strain : test.strain;
}

reference::ElementTestSolution solution_of(const ElementTest& test) {
  return {soil_of(test.material), loading_of(test.path), test.pressure, final_strain(test)};
}

/// The strain increment of a path from its imposed strain and the one that is free to hold a stress.
Tensor strain_increment(reference::LoadingPath path, double imposed, double free) {
  switch (path) {
    case reference::LoadingPath::biaxial:
      return {free, imposed, 0, 0};
    case reference::LoadingPath::oedometric:
      return {0, imposed, 0, 0};
    case reference::LoadingPath::simple_shear:
      return {free, free, 0, imposed};
    case reference::LoadingPath::isotropic:
      break;
  }
  return {imposed, imposed, imposed, 0};
}

/// How far the stress that the path holds is from where it is to be [Pa]; 0 where none is held.
double deviation_of_held(reference::LoadingPath path, double pressure, double xx, double yy) {
  if (path == reference::LoadingPath::biaxial) return xx + pressure;
  if (path == reference::LoadingPath::simple_shear) return (xx + yy) / 2 + pressure;
  return 0.0;
}

/// One element that follows a path by the solver's law.
template <class Real>
class Element {
 public:
  explicit Element(const ElementTest& test)
      : path_(loading_of(test.path)),
        pressure_(test.pressure),
        law_(test.material),
        elastic_(LinearElastic{test.material.youngs_modulus, test.material.poissons_ratio}) {
    // Flow gives way sideways by up to (1 + sin psi)/(1 - sin psi) of the imposed strain, elasticity by less.
    const double sin_psi = std::sin(test.material.dilation_angle);
    reach_ = 2 * (1 + sin_psi) / (1 - sin_psi);
    stress_.fill(static_cast<Real>(-pressure_));
    stress_[3] = 0;
  }

  /// Whether the law yielded.
  bool advance(double imposed) {
    const auto increment = converted<Real>(strain_increment(path_, imposed, free_strain(imposed)));
    const bool yields =
        law_.update(stress_, increment, Real(1)) != elastic_.update(stress_, increment, Real(1));
    stress_ = law_.update(stress_, increment, Real(1));
    volumetric_strain_ += trace<2, double>(converted<double>(increment));
    return yields;
  }

  Tensor stress() const { return converted<double>(stress_); }
  double volumetric_strain() const { return volumetric_strain_; }

 private:
  /// The more it is, the more the held stress comes up.
  double free_strain(double imposed) const {
    if (path_ != reference::LoadingPath::biaxial && path_ != reference::LoadingPath::simple_shear) return 0.0;
    double lower = -reach_ * std::abs(imposed), upper = -lower;
    while (upper - lower > std::numeric_limits<double>::epsilon() * reach_ * std::abs(imposed)) {
      const double middle = (lower + upper) / 2;
      const auto increment = converted<Real>(strain_increment(path_, imposed, middle));
      const Tensor stress = converted<double>(law_.update(stress_, increment, Real(1)));
      (deviation_of_held(path_, pressure_, stress[0], stress[1]) < 0 ? lower : upper) = middle;
    }
    return (lower + upper) / 2;
  }

  reference::LoadingPath path_;
  double pressure_, reach_;
  MohrCoulombLaw<Real> law_;
  LinearElasticLaw<2, Real> elastic_;
  SymmetricTensor<2, Real> stress_;
  double volumetric_strain_ = 0.0;
};

std::vector<ElementCurve> empty_curves() {
  std::vector<ElementCurve> curves;
  for (const char* id : {"stress_xx", "stress_yy", "stress_zz", "stress_xy", "volumetric_strain"})
    curves.push_back({.id = id, .strain = {}, .value = {}});
  return curves;
}

void append(std::vector<ElementCurve>& curves, double strain, const Tensor& stress,
            double volumetric_strain) {
  for (std::size_t i = 0; i < curves.size(); ++i) {
    curves[i].strain.push_back(strain);
    curves[i].value.push_back(i < stress.size() ? stress[i] : volumetric_strain);
  }
}

template <class Real>
ElementRun run_path(const ElementTest& test) {
  Element<Real> element(test);
  ElementRun run{.curves = empty_curves(), .measured = {}};
  const double step = final_strain(test) / test.increments;
  int yielding = 0;
  append(run.curves, 0.0, element.stress(), 0.0);
  for (int i = 1; i <= test.increments; ++i) {
    yielding += element.advance(step);
    append(run.curves, i * step, element.stress(), element.volumetric_strain());
  }
  run.measured["element.yielding_increments"] = yielding;
  return run;
}

const std::vector<double>& values_of(const std::vector<ElementCurve>& curves, const std::string& id) {
  for (const ElementCurve& curve : curves)
    if (curve.id == id) return curve.value;
  throw std::invalid_argument("an element test without the curve " + id);
}

double largest_magnitude(const std::vector<double>& values) {
  double largest = 0.0;
  for (double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// NaN where a value of either is: it compares with nothing and stays.
double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double distance = std::abs(a[i] - b.at(i));
    if (std::isnan(distance) || distance > largest) largest = distance;
  }
  return largest;
}

// ---- random states ----

/// A stress inside the limit and a strain increment; `trial` is what elasticity makes of them.
struct State {
  Tensor stress, increment, trial;
};

Tensor elastic_stress(const MohrCoulomb& material, const Tensor& strain) {
  const double shear = material.youngs_modulus / (1 + material.poissons_ratio);
  const double mean = material.poissons_ratio / (1 - 2 * material.poissons_ratio) * trace<2, double>(strain);
  return {shear * (strain[0] + mean), shear * (strain[1] + mean), shear * (strain[2] + mean),
          shear * strain[3]};
}

Tensor elastic_strain(const MohrCoulomb& material, const Tensor& stress) {
  const double nu = material.poissons_ratio, mean = nu * trace<2, double>(stress);
  const double e = material.youngs_modulus;
  return {((1 + nu) * stress[0] - mean) / e, ((1 + nu) * stress[1] - mean) / e,
          ((1 + nu) * stress[2] - mean) / e, (1 + nu) * stress[3] / e};
}

/// Stress whose principal values in the plane are the first two, the first at `angle` to x.
Tensor tensor_of(const std::array<double, 3>& principal, double angle) {
  return rotated<double>({principal[0], principal[1], principal[2], 0.0}, angle);
}

/// States from a generator whose numbers are the same everywhere. The increments would change the stress by a
/// hundredth to nine times the typical pressure; every fourth state is aligned with the axes and has two
/// equal changes, every eighth three.
class RandomStates {
 public:
  explicit RandomStates(const ElementTest& test) : test_(test), generator_(test.seed) {}

  State next() {
    ++count_;
    State state;
    state.stress = admissible();
    const double reach = 3 * test_.pressure * std::pow(10.0, -2 * share());
    state.increment = elastic_strain(test_.material, change(reach));
    const Tensor change = elastic_stress(test_.material, state.increment);
    for (std::size_t c = 0; c < state.trial.size(); ++c) state.trial[c] = state.stress[c] + change[c];
    return state;
  }

  double angle() { return std::numbers::pi * signed_share(); }

 private:
  /// In [0, 1).
  double share() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }
  double signed_share() { return 2 * share() - 1; }

  /// A mean stress from nothing to twice the pressure and some of the deviator that the limit allows there.
  Tensor admissible() {
    const double sin_phi = std::sin(test_.material.friction_angle);
    const double ratio = (1 - sin_phi) / (1 + sin_phi);
    const double strength =
        2 * test_.material.cohesion * std::cos(test_.material.friction_angle) / (1 + sin_phi);
    const double mean = -2 * test_.pressure * share();
    const std::array<double, 3> deviator = random_deviator();
    const auto [smallest, largest] = std::minmax_element(deviator.begin(), deviator.end());
    const double most = (strength - mean * (1 - ratio)) / (*largest - ratio * *smallest);
    const double size = most * share();
    return tensor_of({mean + size * deviator[0], mean + size * deviator[1], mean + size * deviator[2]},
                     count_ % 4 == 0 ? 0.0 : angle());
  }

  std::array<double, 3> random_deviator() {
    const double a = signed_share(), b = signed_share(), c = 1 + share();
    return {a - (a + b + c) / 3, b - (a + b + c) / 3, c - (a + b + c) / 3};
  }

  Tensor change(double reach) {
    const double mean = 2 * reach * signed_share();
    Tensor change{mean + reach * signed_share(), mean + reach * signed_share(), mean + reach * signed_share(),
                  reach * signed_share()};
    if (count_ % 4 == 0) {
      change[3] = 0;
      change[1] = change[count_ % 8 == 0 ? 0 : 2];
    }
    if (count_ % 16 == 0) change[2] = change[0];
    return change;
  }

  const ElementTest& test_;
  std::mt19937_64 generator_;
  int count_ = 0;
};

/// The reference's return of a trial stress.
struct Expected {
  Tensor stress;
  int region;  ///< which face, edge or else of the limit, told apart by the axes' order
};

/// A number for each of: inside, six faces, three edges of either kind, the apex.
int region_of(const reference::ReturnedStress& found) {
  const auto [smallest, largest] = std::minmax_element(found.principal.begin(), found.principal.end());
  const auto low = static_cast<int>(smallest - found.principal.begin());
  const auto high = static_cast<int>(largest - found.principal.begin());
  switch (found.part) {
    case reference::LimitPart::inside:
      return 0;
    case reference::LimitPart::face:
      return 10 + 3 * high + low;
    case reference::LimitPart::compression_edge:
      return 20 + low;
    case reference::LimitPart::extension_edge:
      return 30 + high;
    case reference::LimitPart::apex:
      break;
  }
  return 40;
}

/// By the principal stresses nearest to x, nearest to y and across the plane, so that every order occurs.
Expected expected_return(const reference::MohrCoulombSoil& soil, const Tensor& trial) {
  const double center = (trial[0] + trial[1]) / 2, half_difference = (trial[0] - trial[1]) / 2;
  const double radius = std::hypot(half_difference, trial[3]);
  const bool x_is_larger = half_difference >= 0;
  const double near_x = center + (x_is_larger ? radius : -radius);
  const double near_y = center - (x_is_larger ? radius : -radius);
  const auto found = reference::multi_surface_return(soil, {near_x, near_y, trial[2]});
  if (!found) throw std::runtime_error("the reference found no return of a random state");
  const double angle = std::atan2(x_is_larger ? trial[3] : -trial[3], std::abs(half_difference)) / 2;
  return {tensor_of(found->principal, angle), region_of(*found)};
}

/// The worst that the law did to many states.
template <class Real>
class Examination {
 public:
  explicit Examination(const ElementTest& test)
      : material_(test.material), soil_(soil_of(test.material)), law_(test.material) {}

  void examine(const State& state, double angle) {
    const double size = magnitude(state.trial) + material_.cohesion;
    const Expected expected = expected_return(soil_, state.trial);
    const Tensor found = updated(state.stress, state.increment);
    regions_.insert(expected.region);
    raise(oracle_, magnitude(difference(found, expected.stress)) / size);
    raise(excess_, reference::relative_excess(soil_, found[0], found[1], found[2], found[3]));
    lower(work_, plastic_work(state.trial, found) * material_.youngs_modulus / (size * size));
    if (updated(found, Tensor{}) != found) ++moved_again_;
    if (mirrored(updated(mirrored(state.stress), mirrored(state.increment))) != found) ++unequal_mirrored_;
    const Tensor turned = updated(rotated(state.stress, angle), rotated(state.increment, angle));
    raise(rotation_, magnitude(difference(rotated(turned, -angle), found)) / size);
    raise(exchange_, exchange_error(state) / size);
  }

  std::map<std::string, double> measured() const {
    return {{"element.oracle", oracle_},
            {"element.excess", excess_},
            {"element.plastic_work", work_},
            {"element.moved_again", moved_again_},
            {"element.unequal_mirrored", unequal_mirrored_},
            {"element.rotation", rotation_},
            {"element.exchange", exchange_},
            {"element.regions_hit", static_cast<double>(regions_.size())}};
  }

 private:
  Tensor updated(const Tensor& stress, const Tensor& increment) const {
    return converted<double>(law_.update(converted<Real>(stress), converted<Real>(increment), Real(1)));
  }

  static Tensor mirrored(const Tensor& t) { return {t[1], t[0], t[2], t[3]}; }

  double plastic_work(const Tensor& trial, const Tensor& found) const {
    const Tensor plastic = elastic_strain(material_, difference(trial, found));
    return found[0] * plastic[0] + found[1] * plastic[1] + found[2] * plastic[2] + 2 * found[3] * plastic[3];
  }

  /// Of the state without its shear components, when x, y and z take each other's places.
  double exchange_error(const State& state) const {
    const auto cycled = [](const Tensor& t) { return Tensor{t[1], t[2], t[0], 0.0}; };
    const auto aligned = [](const Tensor& t) { return Tensor{t[0], t[1], t[2], 0.0}; };
    const Tensor here = updated(aligned(state.stress), aligned(state.increment));
    const Tensor there = updated(cycled(state.stress), cycled(state.increment));
    return magnitude(difference(there, cycled(here)));
  }

  /// A NaN wins, and stays.
  static void raise(double& worst, double value) {
    if (std::isnan(value) || value > worst) worst = value;
  }
  static void lower(double& worst, double value) {
    if (std::isnan(value) || value < worst) worst = value;
  }

  const MohrCoulomb& material_;
  reference::MohrCoulombSoil soil_;
  MohrCoulombLaw<Real> law_;
  std::set<int> regions_;
  double oracle_ = 0.0, excess_ = -1.0, work_ = std::numeric_limits<double>::infinity(), rotation_ = 0.0;
  double exchange_ = 0.0;
  int moved_again_ = 0, unequal_mirrored_ = 0;
};

template <class Real>
ElementRun run_random_states(const ElementTest& test) {
  RandomStates states(test);
  Examination<Real> examination(test);
  for (int i = 0; i < test.states; ++i) {
    const State state = states.next();
    examination.examine(state, states.angle());
  }
  return {.curves = {}, .measured = examination.measured()};
}

template <class Real>
ElementRun run(const ElementTest& test) {
  return test.path == ElementPath::random_states ? run_random_states<Real>(test) : run_path<Real>(test);
}

// ---- checks ----

void require(bool holds, const char* place, const char* expected, double found) {
  if (!holds) throw SceneError(place, expected, fmt::format("{}", found));
}

void check_material(const MohrCoulomb& m) {
  constexpr double degree = std::numbers::pi / 180;
  require(std::isfinite(m.youngs_modulus) && m.youngs_modulus > 0, "/material/youngs_modulus",
          "a modulus above zero", m.youngs_modulus);
  require(m.poissons_ratio >= 0 && m.poissons_ratio < 0.5, "/material/poissons_ratio",
          "a ratio from 0 to below 0.5", m.poissons_ratio);
  require(m.friction_angle >= 0 && m.friction_angle < 90 * degree, "/material/friction_angle",
          "an angle from 0 to below 90 deg", m.friction_angle / degree);
  require(m.dilation_angle >= 0 && m.dilation_angle <= m.friction_angle, "/material/dilation_angle",
          "an angle from 0 to the friction angle", m.dilation_angle / degree);
  require(std::isfinite(m.cohesion) && m.cohesion >= 0 && m.cohesion + m.friction_angle > 0,
          "/material/cohesion", "a pressure, zero or above, above zero where the friction angle is zero",
          m.cohesion);
}

}  // namespace

void check(const ElementTest& test) {
  check_material(test.material);
  require(std::isfinite(test.pressure) && test.pressure > 0, "/path/pressure", "a pressure above zero",
          test.pressure);
  if (test.path == ElementPath::random_states) {
    require(test.states >= 1, "/path/states", "one state or more", test.states);
    return;
  }
  require(std::isfinite(test.strain) && test.strain > 0, "/path/strain", "a strain above zero", test.strain);
  require(test.increments >= 1, "/path/increments", "one increment or more", test.increments);
}

ElementRun run_element_test(const ElementTest& test) {
  check(test);
  return test.precision == Precision::float32 ? run<float>(test) : run<double>(test);
}

std::vector<ElementCurve> closed_form(const ElementTest& test, const std::vector<ElementCurve>& curves) {
  if (curves.empty()) return {};
  const reference::ElementTestSolution exact = solution_of(test);
  std::vector<ElementCurve> result = empty_curves();
  for (double strain : curves.front().strain) {
    const reference::ElementState state = exact.at(strain);
    append(result, strain, {state.xx, state.yy, state.zz, state.xy}, state.volumetric_strain);
  }
  return result;
}

std::map<std::string, double> judge_element_curves(const ElementTest& test,
                                                   const std::vector<ElementCurve>& curves) {
  if (curves.empty()) return {};
  std::map<std::string, double> metrics;
  const reference::ElementTestSolution exact = solution_of(test);
  const std::vector<ElementCurve> expected = closed_form(test, curves);
  const auto found_of = [&](const char* id) -> const std::vector<double>& { return values_of(curves, id); };
  const auto error_of = [&](const char* id) {
    return largest_difference(found_of(id), values_of(expected, id));
  };

  double largest = 0.0, error = 0.0, held = 0.0;
  for (const char* id : {"stress_xx", "stress_yy", "stress_zz", "stress_xy"}) {
    largest = std::max(largest, largest_magnitude(values_of(expected, id)));
    if (const double of_component = error_of(id); std::isnan(of_component) || of_component > error)
      error = of_component;
  }
  const std::vector<double>&xx = found_of("stress_xx"), &yy = found_of("stress_yy");
  for (std::size_t i = 0; i < xx.size(); ++i)
    held = std::max(held, std::abs(deviation_of_held(loading_of(test.path), test.pressure, xx[i], yy[i])));
  metrics["element.stress"] = error / largest;
  metrics["element.out_of_plane"] = error_of("stress_zz") / largest;
  metrics["element.volume"] = error_of("volumetric_strain") / test.strain;
  metrics["element.held"] = held / test.pressure;

  // Of the largest stress: where sand has come apart there is none left to compare with.
  const Tensor end{xx.back(), yy.back(), found_of("stress_zz").back(), found_of("stress_xy").back()};
  if (std::abs(exact.limit_strain()) < test.strain) {
    metrics["element.limit"] =
        std::abs(reference::relative_excess(soil_of(test.material), end[0], end[1], end[2], end[3])) *
        magnitude(end) / largest;
  }
  const std::vector<double>&strain = curves.front().strain, &volume = found_of("volumetric_strain");
  const auto on_limit = std::find_if(strain.begin(), strain.end(), [&](double at) {
    return std::abs(at) >= std::abs(exact.limit_strain());
  });
  if (strain.end() - on_limit >= 2) {
    const double before = volume[static_cast<std::size_t>(on_limit - strain.begin())];
    metrics["element.dilation"] =
        std::abs((volume.back() - before) / (strain.back() - *on_limit) - exact.dilatancy());
  }
  return metrics;
}

const std::vector<ElementMetric>& element_metrics() {
  static const std::vector<ElementMetric> all = {
      {"element.stress", true,
       "largest error of a stress component on the path, relative to the largest exact one"},
      {"element.out_of_plane", true, "the same of the stress across the plane alone"},
      {"element.volume", true, "largest error of the volumetric strain, relative to the imposed strain"},
      {"element.limit", true,
       "distance from the limit at the end of a path that reaches it, relative to the "
       "largest exact stress"},
      {"element.dilation", true, "error of the change of volume with the imposed strain on the limit"},
      {"element.held", true, "largest deviation of a stress that the path holds, relative to the pressure"},
      {"element.yielding_increments", false, "increments of the path in which the law yields"},
      {"element.oracle", false,
       "largest distance of a random state's return from the one found by trying every set "
       "of yield surfaces, relative to the trial stress"},
      {"element.excess", false,
       "how far a returned stress lies beyond the limit at most, relative to itself"},
      {"element.plastic_work", false, "least plastic work of an increment, relative to stress^2 / E"},
      {"element.rotation", false,
       "largest change of a result by turning the axes in the plane, relative to the "
       "trial stress"},
      {"element.exchange", false,
       "largest change of a result by cycling x, y and z, relative to the trial stress"},
      {"element.unequal_mirrored", false, "states in which exchanging x and y changes a bit"},
      {"element.moved_again", false, "returned stresses of which an increment of no strain changes a bit"},
      {"element.regions_hit", false,
       "parts of the limit hit, of 14: inside, six faces, two times three edges, apex"},
  };
  return all;
}

}  // namespace mpm::vv
