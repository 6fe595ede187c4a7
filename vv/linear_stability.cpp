#include "vv/linear_stability.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>

#include "solver/material.hpp"
#include "vv/record.hpp"

namespace mpm::vv {
namespace {

/// Of a disturbance, relative to the waves' speed and modulus: nothing beside any place or volume.
constexpr double amplitude = 1e-24;
/// A time that does not come [s].
constexpr double never = 1e30;

/// The law of small strains.
LinearElastic tangent_of(const Material& material) {
  if (const auto* zhang = std::get_if<ZhangElastic>(&material)) return {zhang->youngs_modulus, 0.0};
  if (const auto* soil = std::get_if<MohrCoulomb>(&material))
    return {soil->youngs_modulus, soil->poissons_ratio};
  if (const auto* rubber = std::get_if<NeoHookean>(&material))
    return {rubber->youngs_modulus, rubber->poissons_ratio};
  return std::get<LinearElastic>(material);
}

Body linearised(Body body) {
  body.density = body.inertia.value_or(body.density_at(0.0));
  body.inertia.reset();
  body.density_ramp.reset();
  body.initial_stress.reset();
  body.velocity = {};
  body.material = tangent_of(body.material);
  return body;
}

double wave_modulus(const Scene& scene, const Body& body) {
  const LinearElastic law = tangent_of(body.material);
  return scene.dimension == 1 ? LinearElasticLaw<1, double>(law).wave_modulus()
                              : LinearElasticLaw<2, double>(law).wave_modulus();
}

/// The body with the fastest wave.
const Body& fastest_body(const Scene& scene) {
  return *std::max_element(scene.bodies.begin(), scene.bodies.end(), [&](const Body& a, const Body& b) {
    return wave_modulus(scene, a) / a.lightest() < wave_modulus(scene, b) / b.lightest();
  });
}

/// Where the unknowns of a particle are in the fields of all.
struct Layout {
  Eigen::Index velocities, stresses;  ///< unknowns of a particle
  std::size_t components;             ///< of a stress as stored

  explicit Layout(int dimension)
      : velocities(dimension), stresses(dimension == 1 ? 1 : 3), components(dimension == 1 ? 1 : 4) {}

  Eigen::Index unknowns() const { return velocities + stresses; }
  /// Calls `visit(unknown, velocity in its field)` and `visit_stress(unknown, stress in its field)`.
  template <class Visit, class VisitStress>
  void for_each(std::size_t particles, Visit&& visit, VisitStress&& visit_stress) const {
    Eigen::Index unknown = 0;
    for (std::size_t p = 0; p < particles; ++p) {
      for (Eigen::Index a = 0; a < velocities; ++a)
        visit(unknown++, p * static_cast<std::size_t>(velocities) + static_cast<std::size_t>(a));
      for (Eigen::Index c = 0; c < stresses; ++c)
        visit_stress(unknown++, p * components + static_cast<std::size_t>(c == 2 ? 3 : c));
    }
  }
};

/// The simulation that makes the steps.
class Prober {
 public:
  Prober(const Scene& scene, const ParticleFields& state, double speed, double modulus)
      : simulation_(scene),
        fields_(state),
        layout_(scene.dimension),
        speed_(amplitude * speed),
        stress_(amplitude * modulus) {}

  Eigen::VectorXd operator()(const Eigen::VectorXd& before) {
    layout_.for_each(
        fields_.mass.size(),
        [&](Eigen::Index k, std::size_t at) { fields_.velocity[at] = speed_ * before[k]; },
        [&](Eigen::Index k, std::size_t at) { fields_.stress[at] = stress_ * before[k]; });
    simulation_.set_particles(fields_);
    if (!simulation_.advance()) throw std::runtime_error("a step of the linear scene ended its run");
    const ParticleFields end = simulation_.particles();
    Eigen::VectorXd after(before.size());
    layout_.for_each(
        end.mass.size(), [&](Eigen::Index k, std::size_t at) { after[k] = end.velocity[at] / speed_; },
        [&](Eigen::Index k, std::size_t at) { after[k] = end.stress[at] / stress_; });
    return after;
  }

 private:
  Simulation simulation_;
  ParticleFields fields_;
  Layout layout_;
  double speed_, stress_;
};

double largest_eigenvalue(const Eigen::MatrixXd& matrix) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix, false);
  if (solver.info() != Eigen::Success) throw std::runtime_error("the eigenvalues of a step were not found");
  return solver.eigenvalues().cwiseAbs().maxCoeff();
}

/// Growth a step over the second half of the iterations.
double growth_of(const StepMatrix::Operator& step, Eigen::Index unknowns, int iterations) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::VectorXd state(unknowns);
  for (double& entry : state) entry = uniform(random);
  double log_growth = 0.0;
  for (int k = 0; k < iterations; ++k) {
    state = step(state / state.norm());
    if (2 * k >= iterations) log_growth += std::log(state.norm());
  }
  return std::exp(log_growth / (iterations - iterations / 2));
}

bool by_matrix(const StepMatrix& step, const LinearSearch& search) {
  return step.unknowns() <= search.most_of_matrix;
}

/// Asks for the radius at time steps, and keeps what it was told.
class Search {
 public:
  Search(const StepMatrix& step, const LinearSearch& search, const std::function<bool()>& going_on)
      : step_(step), search_(search), going_on_(going_on) {}

  LinearStability run() {
    LinearStability found;
    found.unknowns = step_.unknowns();
    if (found.unknowns > search_.most_of_iterations) {
      found.lack = fmt::format("its {} unknowns are more than the {} that are looked into", found.unknowns,
                               search_.most_of_iterations);
      return found;
    }
    find(found);
    for (const auto& [fraction, radius] : radius_) {
      found.fraction.push_back(fraction);
      found.radius.push_back(radius);
    }
    return found;
  }

 private:
  bool is_stable(double fraction) {
    if (going_on_ && !going_on_()) throw Abandoned();
    const double radius = spectral_radius(step_, fraction, search_);
    radius_[fraction] = radius;
    return radius <= 1 + (by_matrix(step_, search_) ? search_.tolerance : search_.growth_resolution);
  }

  void find(LinearStability& found) {
    const double ratio = std::pow(search_.to / search_.from, 1.0 / (search_.points - 1));
    double stable = 0.0, unstable = 0.0;
    for (int k = 0; k < search_.points && unstable == 0.0; ++k) {
      const double fraction = search_.from * std::pow(ratio, k);
      (is_stable(fraction) ? stable : unstable) = fraction;
    }
    if (stable == 0.0) {
      found.lack = fmt::format("no time step from {:.3g} on is stable", search_.from);
    } else if (unstable == 0.0) {
      found.lack = fmt::format("every time step up to {:.3g} is stable", search_.to);
    } else {
      while (unstable - stable > search_.resolution * stable) {
        const double middle = (stable + unstable) / 2;
        (is_stable(middle) ? stable : unstable) = middle;
      }
      found.limit = stable;
    }
  }

  const StepMatrix& step_;
  const LinearSearch& search_;
  const std::function<bool()>& going_on_;
  std::map<double, double> radius_;
};

}  // namespace

Scene linearised(const Scene& scene) {
  Scene linear = scene;
  for (Body& body : linear.bodies) body = linearised(std::move(body));
  for (RigidBody& body : linear.rigid_bodies) body.start = never;
  linear.precision = Precision::float64;
  linear.damping = 0.0;
  linear.surface_loads.clear();
  linear.driven_motion.reset();
  linear.gravity = {};
  linear.sums_strain = linear.sums_work = linear.compensated_sums = linear.watched = false;
  linear.termination = AtTime{never};
  return linear;
}

double crossing_time(const Scene& scene) {
  const Body& body = fastest_body(scene);
  return scene.cell_size / std::sqrt(wave_modulus(scene, body) / body.lightest());
}

StepMatrix::StepMatrix(const Scene& scene, const std::optional<ParticleFields>& state)
    : scene_(linearised(scene)), crossing_time_(crossing_time(scene)) {
  const Body& fastest = fastest_body(scene_);
  modulus_ = wave_modulus(scene_, fastest);
  speed_ = std::sqrt(modulus_ / fastest.density);
  state_ = state ? *state : Simulation(scene_).particles();
  std::fill(state_.velocity.begin(), state_.velocity.end(), 0.0);
  std::fill(state_.stress.begin(), state_.stress.end(), 0.0);
}

Eigen::Index StepMatrix::unknowns() const {
  return static_cast<Eigen::Index>(state_.mass.size()) * Layout(scene_.dimension).unknowns();
}

StepMatrix::Operator StepMatrix::step_at(double fraction) const {
  Scene scene = scene_;
  scene.time_step = GivenTimeStep{fraction * crossing_time_};
  const auto prober = std::make_shared<Prober>(scene, state_, speed_, modulus_);
  return [prober](const Eigen::VectorXd& before) { return (*prober)(before); };
}

Eigen::MatrixXd StepMatrix::at(double fraction) const {
  const Operator step = step_at(fraction);
  Eigen::MatrixXd matrix(unknowns(), unknowns());
  for (Eigen::Index k = 0; k < unknowns(); ++k) matrix.col(k) = step(Eigen::VectorXd::Unit(unknowns(), k));
  return matrix;
}

double spectral_radius(const StepMatrix& step, double fraction, const LinearSearch& search) {
  if (by_matrix(step, search)) return largest_eigenvalue(step.at(fraction));
  return growth_of(step.step_at(fraction), step.unknowns(), search.iterations);
}

LinearStability linear_stability(const StepMatrix& step, const LinearSearch& search,
                                 const std::function<bool()>& going_on) {
  return Search(step, search, going_on).run();
}

LinearStability linear_stability(const Scene& scene, const LinearSearch& search,
                                 const std::function<bool()>& going_on) {
  return linear_stability(StepMatrix(scene), search, going_on);
}

}  // namespace mpm::vv
