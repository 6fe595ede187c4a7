#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reference/bearing_capacity.hpp"
#include "vv/case_file.hpp"
#include "vv/record.hpp"

/// What presses on a block of ground, and the load-settlement curve of its runs.
namespace mpm::vv {

/// A strip on the surface of one block of ground, which it loads either as a rigid body that is pressed down
/// or as a block that grows heavier. It points into the scene.
struct Footing {
  const RigidBody* strip;  ///< null if a block presses
  const Body* block;       ///< null if a rigid body presses
  const Body* ground;
  PerAxis lower, upper;  ///< corners of the strip or block at the start [m]
  bool half;             ///< only the half at x >= its axis, the grid's lower edge in x, is modelled
  double width;          ///< in the model [m]
  double surcharge;      ///< on the surface beside it [Pa]
  double weight;         ///< unit weight of the ground in the end [N/m^3]

  double full_width() const { return half ? 2 * width : width; }
  /// A block shares the grid's velocity with the ground: it is rough.
  reference::Roughness roughness() const {
    return strip && !strip->constrains[0] ? reference::Roughness::smooth : reference::Roughness::rough;
  }
};

/// What a scene lacks to be one of a footing, for a person; empty if it is.
std::string why_no_footing(const Scene& scene);

/// The footing of a scene that has one.
Footing footing_of(const Scene& scene);

/// What a footing's scene lacks to be one that nothing but the footing, gravity and an even surcharge acts
/// on, for a person; empty if it is.
std::string why_not_only_pressed(const Scene& scene);

/// Acceleration of gravity downwards in the end [m/s^2].
double final_gravity(const Gravity& gravity);

/// What a case does not record of a footing's scene that its load curve needs, for a person.
std::string why_no_load_curve(const Case& definition, const Scene& scene);

/// Mean pressure below a footing over its settlement, in the order of time.
struct LoadCurve {
  std::vector<double> settlement;  ///< [m], down
  std::vector<double> pressure;    ///< [Pa]
};

/// The curve of a run of a footing's scene, as far as the run got; nothing if the case does not record it or
/// the run ended before.
///
/// Of a rigid strip: its reaction over its width. A sample is the mean since the one before and belongs to
/// the settlement halfway. Of a block: its weight over its width, over the descent of its particles' mean
/// since its density began to change; this moment is the first point. Of a run that broke off, the samples
/// from the first that is no number on are left out.
std::optional<LoadCurve> load_curve_of(const Case& definition, const Scene& scene, const Record& record);

/// The samples at which the footing is deeper than ever before; of those before it moves the last.
LoadCurve advancing_part(const LoadCurve& curve);

/// The advancing part interpolated at so many settlements, equally far from each other, from its first to its
/// last. It must have two samples or more; points >= 2.
LoadCurve evenly_spaced(const LoadCurve& curve, int points);

}  // namespace mpm::vv
