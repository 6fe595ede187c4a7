#pragma once

#include <string>
#include <vector>

#include "vv/record.hpp"

namespace mpm::vv {

/// One scalar on the particles of a two-dimensional run at one moment, ready to be drawn.
struct FieldMap {
  std::string quantity, unit;
  std::string moment;                  ///< of the snapshot, for a person
  double time = 0.0;                   ///< [s]
  std::vector<double> x, y;            ///< current centers [m]
  std::vector<double> half_x, half_y;  ///< half sizes of what the particle stands for [m]
  std::vector<double> value;           ///< in `unit`
};

/// A scalar that a snapshot can be drawn by.
struct FieldQuantity {
  std::string name;     ///< for example "max_shear_strain"
  std::string unit;     ///< SI, "-" for a ratio
  std::string meaning;  ///< one line for a person
};

/// Every scalar there is: displacement (magnitude), displacement_x, displacement_y, speed, stress_xx, stress_yy,
/// stress_zz, stress_xy, mean_stress (tension positive), max_shear_stress, max_shear_strain (largest engineering
/// shear strain in the plane, from the sum of the increments).
const std::vector<FieldQuantity>& field_catalogue();

/// The map of a catalogue's quantity. Throws std::invalid_argument for an unknown one, for a run in one dimension,
/// and for a strain the scene did not sum.
FieldMap map_of(const Snapshot& snapshot, const std::string& quantity);

}  // namespace mpm::vv
