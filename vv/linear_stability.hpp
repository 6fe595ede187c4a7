#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "vv/survey.hpp"

/// What one step of the solver does to a small disturbance, found out by asking the solver.
namespace mpm::vv {

/// A scene as its steps are linear: at rest, free of stress, without gravity, loads, damping and motions of
/// rigid bodies, whose nodes are held; in double; of materials as they are for small strains, linear elastic.
/// Bodies, grid, conditions, scheme, update order and FLIP fraction stay.
Scene linearised(const Scene& scene);

/// Time in which the fastest wave of the scene crosses a cell [s]: the time step of a `stable_fraction` of 1.
double crossing_time(const Scene& scene);

/// One step of the solver about a state at rest, as a matrix. Of `state` positions, half sizes and volumes
/// count; without one it is the scene as it is at the start.
///
/// Unknowns are velocities over the fastest wave's speed and stresses over its modulus, of each particle in
/// turn: velocity, then stress components without the one normal to the plane, which acts on nothing.
/// Displacements are left out: with places held nothing depends on them, and each would add an eigenvalue
/// of 1. A disturbance is so small that what a step does to places and volumes is lost in rounding, and a
/// step of it is exact all the same, as it is added to nothing.
class StepMatrix {
 public:
  using Operator = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

  /// Linearises the scene. Throws SceneError, std::invalid_argument for a state of another scene.
  explicit StepMatrix(const Scene& scene, const std::optional<ParticleFields>& state = std::nullopt);

  Eigen::Index unknowns() const;
  /// The step at a time step of `fraction` times the scene's `crossing_time`, without a matrix. It throws
  /// std::runtime_error if the solver ends there.
  Operator step_at(double fraction) const;
  /// Its matrix; a step of each unknown.
  Eigen::MatrixXd at(double fraction) const;

 private:
  Scene scene_;
  ParticleFields state_;
  double crossing_time_, speed_, modulus_;
};

/// How the limit is looked for.
struct LinearSearch {
  double from = 0.01,
         to = 4.0;  ///< time steps scanned, evenly spaced in the logarithm [fraction of crossing time]
  int points = 25;
  double resolution = 1e-4;  ///< of the limit, relative
  /// An eigenvalue may exceed 1 by this in magnitude. A double eigenvalue of 1 with one eigenvector, which a
  /// motion that strains at a constant rate makes, comes out of rounding as 1 + sqrt(1e-16 n), some 1e-7.
  /// Beyond a limit the largest grows at least in proportion to the distance, so this is also about what it
  /// costs of the limit.
  double tolerance = 1e-6;
  Eigen::Index most_of_matrix = 400;  ///< unknowns up to which all eigenvalues are computed
  /// Unknowns up to which the growth over `iterations` steps from a fixed random start stands for them: a
  /// magnitude above 1 + `growth_resolution` is noticed. Linear growth, of 1.0027 a step, is not.
  Eigen::Index most_of_iterations = 100000;
  int iterations = 512;
  double growth_resolution = 0.005;
};

/// The largest magnitude of an eigenvalue of a matrix, or its estimate by `iterations`.
double spectral_radius(const StepMatrix& step, double fraction, const LinearSearch& search = {});

/// The largest stable time step of a scene of any kind, `linearised` here: scan up to the first unstable one,
/// then bisection. `going_on` is asked between time steps; false throws Abandoned.
LinearStability linear_stability(const Scene& scene, const LinearSearch& search = {},
                                 const std::function<bool()>& going_on = {});

/// The same about another state of the same scene, for example one stretched.
LinearStability linear_stability(const StepMatrix& step, const LinearSearch& search = {},
                                 const std::function<bool()>& going_on = {});

}  // namespace mpm::vv
