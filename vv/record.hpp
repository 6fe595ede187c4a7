#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "solver/simulation.hpp"
#include "vv/case_file.hpp"

namespace mpm::vv {

/// The state at the end of a run, one entry per particle in particle order; SI units, tension positive.
struct Profile {
  std::vector<double> initial_position;  ///< X [m]
  std::vector<double> position;          ///< x [m]
  std::vector<double> stress;            ///< Cauchy [Pa]
  std::vector<double> volume;            ///< current [m] (length in 1D)
  std::vector<double> initial_volume;    ///< [m]
  std::vector<double> mass;              ///< [kg/m^2 in 1D]
  std::vector<double> half_size;         ///< current [m]; 0 for scheme mpm
};

/// What a history probe saw.
struct History {
  std::string id, quantity;
  std::vector<double> time;   ///< [s]
  std::vector<double> value;  ///< SI unit of the quantity
};

/// What a run cost: a noisy measure and a noise-free one.
struct Cost {
  double wall_seconds = 0.0;
  std::int64_t steps = 0;
  std::int64_t particle_steps = 0;
};

/// What a run did: everything judged later is computed from this, never from the simulation itself.
struct Record {
  std::string case_id;
  std::string input_hash;    ///< of the resolved scene and probes
  std::string program_hash;  ///< of the program that ran it
  std::string revision;      ///< of the source tree that program was built from
  Outcome outcome;
  double time_step = 0.0;  ///< [s]
  double end_time = 0.0;   ///< [s]
  double unbalanced_force_ratio = 0.0;
  double kinetic_energy_ratio = 0.0;
  std::int64_t cell_crossings = 0;    ///< particle centres that changed cell, counted every step
  double relative_mass_change = 0.0;  ///< of the sum over the particles, end against start
  std::string digest;                 ///< of the bits of the final state; equal digests mean equal bits
  Profile profile;
  std::vector<History> histories;
  Cost cost;
};

Json to_json(const Record&);
Record record_from_json(const Json&);

}  // namespace mpm::vv
