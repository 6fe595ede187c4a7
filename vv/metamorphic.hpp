#pragma once

#include <string>
#include <vector>

#include "solver/simulation.hpp"

/// Metamorphic relations: a scene described in another way is the same physics, so the solver's answer,
/// described the first way again, has to be the same but for round-off. No exact solution is needed, so any
/// scene can be put to the test.
namespace mpm::vv {

/// What the metric of a metamorphosis is called: this and its name.
inline const std::string metamorphic_prefix = "metamorphic.";

/// One way to describe a scene differently.
struct Metamorphosis {
  std::string name;
  std::string meaning;     ///< one line for a person
  bool bit_equal = false;  ///< the two answers agree in every bit, not only to round-off
};

/// Every metamorphosis there is:
/// - mirror_x: x -> -x
/// - swap_axes: x <-> y, a reflection too
/// - rotate_90: a quarter turn anticlockwise, the two above in turn
/// - translate: grid and bodies moved by whole cells
/// - shift: everything in motion along x at one cell per time step, the grid as much longer. The method is
///   Galilean only up to the error of its grid; at this velocity the bodies meet the grid alike in every step
/// - units: m, kg and s are mm, t and ms; events that fall midway between two steps may move by one
/// - binary_units: powers of two; no bit changes as long as every formula is homogeneous in its units
/// - split: each block without a ring cut into two bodies along x, and all bodies listed in reverse, which is
///   another order of the particles
const std::vector<Metamorphosis>& metamorphosis_catalogue();

/// Why a scene has no such description, for a person; empty if it has one. Throws std::invalid_argument for a
/// name not in the catalogue. The scene is one that `mpm::check` accepts; SceneError may be thrown otherwise.
std::string why_not_describable(const std::string& metamorphosis, const Scene& scene);

/// The scene described differently, in all its members. Throws std::invalid_argument where `why_not_describable`
/// knows a reason.
Scene transformed(const Scene& scene, const std::string& metamorphosis);

/// The particles of the transformed scene as the original one describes them: axes, signs, units and origin
/// are its own, bodies are counted as it counts them, and the displacement of the common motion is taken off.
/// The order of the particles stays as it is. `time` is that of the transformed simulation, in its units.
/// Throws as `transformed` does, and std::invalid_argument if dimensions differ.
ParticleFields mapped_back(const Scene& original, const ParticleFields& of_the_transformed, double time,
                           const std::string& metamorphosis);

/// The largest difference between two answers [-]: over displacement, velocity, stress and volume, each
/// relative to the largest magnitude that the field has in either, and 0 for a field that is zero in both. A
/// field that is nothing but round-off, such as the stress of a body in free fall, differs by about 1.
/// Particles are matched by where they were initially, to within a thousandth of their spacing. Infinite if
/// anything compared is not finite. Throws std::invalid_argument if the particles are not at the same places.
double largest_difference(const ParticleFields& a, const ParticleFields& b);

}  // namespace mpm::vv
