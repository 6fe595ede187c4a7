#pragma once

#include <string>
#include <vector>

/// What became of a run: whether its answer is right, whether it is still moving, whether it broke.
namespace mpm::vv {

/// From good to bad.
enum class StabilityClass {
  accurate,     ///< complete, steady, smooth, and right to the accuracy asked for
  inaccurate,   ///< complete, steady and smooth, and wrong
  drifting,     ///< goes on moving slowly where it should be at rest
  oscillating,  ///< rings in time, or its field alternates from particle to particle
  diverged,     ///< ended as a numerical failure; the record says at which step, which particle and why
  refused,      ///< is not simulated: the scene is no scene the solver accepts, and it says why
};

/// The name used in cases, results and messages, for example "drifting".
const char* name_of(StabilityClass stability);

/// How a signal behaves where it should be constant. All relative to a scale of the signal [-].
struct SignalShape {
  double drift = 0.0;    ///< change over the window of the straight line through it, in magnitude
  double ringing = 0.0;  ///< root mean square about that line, single spikes left out
  double spike = 0.0;    ///< largest distance of a single sample from the range of its neighbours
};

/// The shape of a signal over its samples from `from` on, relative to `scale` > 0. Needs eight samples there:
/// throws std::invalid_argument with fewer, with unequal lengths, or with a scale that is not positive.
SignalShape shape_of_signal(const std::vector<double>& time, const std::vector<double>& value, double from,
                            double scale);

/// What is left of values once the straight line through the neighbours of each (those within `reach`, itself included, or
/// the three nearest) has been taken off; weighted least squares, in any order of `place`.
std::vector<double> rough_part(const std::vector<double>& place, const std::vector<double>& value,
                               const std::vector<double>& weight, double reach);

/// How much of a field alternates from particle to particle [-]: the root mean square, weighted, of its
/// `rough_part`, relative to that of the field. A field that stays monotone can still alternate about its lines. 0 of a
/// field that is zero, or has fewer than four particles: three can lie on any curve.
double zigzag_of_field(const std::vector<double>& place, const std::vector<double>& value,
                       const std::vector<double>& weight, double reach);

/// What a run showed. A measure that was not taken is zero.
struct Behaviour {
  bool refused = false, failed = false;  ///< not simulated; ended as a numerical failure
  SignalShape signal = {};
  double zigzag = 0.0;  ///< of `zigzag_of_field`
  double error = 0.0;   ///< of the answer
};

/// From where on each measure is too much [-].
struct BehaviourLimits {
  double drift = 0.01, ringing = 0.01, zigzag = 0.05, error = 0.01;
};

/// The class of a run. One that both drifts and oscillates is of the class whose measure is further beyond its limit.
/// A measure that is not a number is beyond any limit.
StabilityClass class_of(const Behaviour& behaviour, const BehaviourLimits& limits);

}  // namespace mpm::vv
