#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "solver/particles.hpp"

namespace mpm {

/// Compares the particles' energy of motion with all the energy that ever went into a scene. Whatever the
/// material does, it can give back no more than it was given; a scheme beyond its limits can.
///
/// What went in is counted generously, so that only energy from nowhere is ever called one: what loads take out again
/// is not subtracted, nor is what strain and friction have used up.
template <int Dim, class Real>
class EnergyWatch {
 public:
  /// A leapfrog keeps an energy that is not quite the true one: close to its limit, at 0.97 to 1 times the stable step,
  /// a sound run shows up to 3.5 times what went in. One beyond the limit passes any number.
  static constexpr double largest_ratio = 4.0;

  EnergyWatch() = default;

  /// `energy`: of the particles at the start, in motion and in strain [J per unit of the absent dimensions].
  void start(const Scene& scene, const Particles<Dim, Real>& particles, double energy) {
    has_ramp_ = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                            [](const Body& body) { return body.density_ramp && !body.inertia; });
    supplied_ = energy;
    const Sums now = sums_of(particles);
    mass_ = now.mass;
    moment_ = now.moment;
  }

  /// Looks at the particles after `elapsed` [s] since the last look. `gravity` [m/s^2] is the most that
  /// acted in between, `work_of_bodies` [J] what rigid bodies have done since the last look.
  void look(const Particles<Dim, Real>& particles, const Vector<Dim, Real>& gravity, double elapsed,
            double work_of_bodies) {
    const Sums now = sums_of(particles);
    for (std::size_t a = 0; a < Dim; ++a) {
      supplied_ += std::abs(static_cast<double>(gravity[a]) * (now.moment[a] - moment_[a]));
    }
    supplied_ += std::abs(now.power) * elapsed + std::abs(work_of_bodies);
    // Mass that a ramp adds moves with the particle from the start.
    if (has_ramp_) supplied_ += now.kinetic * std::max(0.0, 1 - mass_ / now.mass);
    mass_ = now.mass;
    moment_ = now.moment;
    ratio_ = now.kinetic > 0.0 ? now.kinetic / supplied_ : 0.0;
    fastest_ = now.fastest;
    largest_ = std::max(largest_, ratio_);
  }

  /// Energy of motion over all energy that went in, at the last look [-].
  double ratio() const { return ratio_; }
  double largest() const { return largest_; }
  /// Slot of the particle with the most energy of motion.
  Eigen::Index fastest() const { return fastest_; }
  /// Also true for a ratio that is no number.
  bool gains_energy() const { return !(ratio_ <= largest_ratio); }

 private:
  struct Sums {
    double kinetic = 0.0, mass = 0.0, power = 0.0;
    std::array<double, Dim> moment{};  ///< mass times displacement [kg m]
    Eigen::Index fastest = 0;
  };

  static Sums sums_of(const Particles<Dim, Real>& particles) {
    Sums sums;
    double most = -1.0;
    const bool has_forces = particles.external_force[0].size() > 0;
    for (Eigen::Index slot = 0; slot < particles.slots(); ++slot) {
      const auto mass = static_cast<double>(particles.mass[slot]);
      double kinetic = 0.0;
      for (std::size_t a = 0; a < Dim; ++a) {
        const auto velocity = static_cast<double>(particles.velocity[a][slot]);
        kinetic += 0.5 * mass * velocity * velocity;
        sums.moment[a] += mass * static_cast<double>(particles.displacement[a][slot]);
        if (has_forces) sums.power += static_cast<double>(particles.external_force[a][slot]) * velocity;
      }
      sums.mass += mass;
      sums.kinetic += kinetic;
      if (kinetic > most) {
        most = kinetic;
        sums.fastest = slot;
      }
    }
    return sums;
  }

  bool has_ramp_ = false;
  double supplied_ = 0.0, mass_ = 0.0, ratio_ = 0.0, largest_ = 0.0;
  std::array<double, Dim> moment_{};
  Eigen::Index fastest_ = 0;
};

}  // namespace mpm
