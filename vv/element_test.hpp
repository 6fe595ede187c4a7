#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "solver/scene.hpp"

namespace mpm::vv {

/// What an element test imposes; see reference/element_paths.hpp for what each keeps.
enum class ElementPath {
  plane_strain_compression,
  plane_strain_extension,
  oedometric_compression,
  oedometric_extension,
  simple_shear,
  isotropic_tension,
  random_states,  ///< no path: single increments from random admissible stresses, into every part of the
                  ///< limit
};

/// A test of the solver's constitutive law alone, on one element without mesh, inertia or weight.
struct ElementTest {
  MohrCoulomb material{};
  ElementPath path = ElementPath::plane_strain_compression;
  Precision precision = Precision::float64;
  double pressure = 0.0;   ///< isotropic at the start; of random states their typical size [Pa], > 0
  double strain = 0.0;     ///< magnitude imposed in the end: of yy, the tensor's xy, or each normal one; > 0
  int increments = 0;      ///< equal ones, >= 1
  int states = 0;          ///< of random states: how many, >= 1
  std::uint64_t seed = 0;  ///< of random states
};

/// One component over the imposed strain, from the start on.
struct ElementCurve {
  std::string id;              ///< stress_xx, stress_yy, stress_zz, stress_xy or volumetric_strain
  std::vector<double> strain;  ///< imposed, signed, tension positive [-]
  std::vector<double> value;   ///< [Pa], or [-] of the volumetric strain
};

/// What the law did in a test.
struct ElementRun {
  std::vector<ElementCurve> curves;        ///< none of random states
  std::map<std::string, double> measured;  ///< what only the law itself can tell, by metric
};

/// Throws SceneError, its place below the test as a case writes it, for the first value that makes the test
/// impossible.
void check(const ElementTest& test);

/// Drives the solver's law through the test, in its precision.
///
/// Where a stress is held, the strain that holds it is found by halving, to the round-off of the imposed one.
/// Measured on a path are the increments that yield; of random states everything, against the return of
/// reference/multi_surface_return.hpp and against the law itself. Throws what `check` throws.
ElementRun run_element_test(const ElementTest& test);

/// The curves that the closed form gives at the strains of `curves`; none of random states.
std::vector<ElementCurve> closed_form(const ElementTest& test, const std::vector<ElementCurve>& curves);

/// What the curves say, by metric: their distance from the closed form, and what they say of the limit and of
/// dilation without it. Nothing of random states.
std::map<std::string, double> judge_element_curves(const ElementTest& test,
                                                   const std::vector<ElementCurve>& curves);

/// A metric of element tests, without unit.
struct ElementMetric {
  std::string name;
  bool needs_closed_form;  ///< of a path; else of the law itself
  std::string meaning;     ///< one line for a person
};

/// Every metric of element tests, in the order a report lists them.
const std::vector<ElementMetric>& element_metrics();

}  // namespace mpm::vv
