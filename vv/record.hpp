#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "solver/simulation.hpp"
#include "vv/case_file.hpp"
#include "vv/survey.hpp"

namespace mpm::vv {

/// The state at the end of a run, one entry per particle in particle order; SI units, tension positive.
/// Of a quantity with several components it holds the one along the last axis, upwards.
struct Profile {
  std::vector<double> initial_position;  ///< X [m]
  std::vector<double> displacement;      ///< x - X [m], kept apart so that it loses no digits in float
  std::vector<double> position;          ///< x [m]
  std::vector<double> stress;            ///< Cauchy [Pa]
  std::vector<double> volume;            ///< current [m in 1D, m^2 in 2D]
  std::vector<double> initial_volume;    ///< same unit
  std::vector<double> mass;              ///< [kg per unit of the absent dimensions]
  std::vector<double> half_size;         ///< current [m]; 0 for scheme mpm
};

/// What a history probe saw.
struct History {
  std::string id, quantity;
  std::vector<double> time;   ///< [s]
  std::vector<double> value;  ///< SI unit of the quantity
};

/// Every particle at one moment of a run. Values travel through JSON rounded to nine significant digits: enough
/// for pictures and for judging fields, half the size.
struct Snapshot {
  std::string moment;  ///< for a person: "t = 0.1 s", "footing = -5 mm", "end"
  double time = 0.0;   ///< [s]
  ParticleFields fields;
};

/// The name of the moment that a request asks for, as `Snapshot::moment` has it.
std::string moment_of(const SnapshotRequest& request);

/// What a run cost: a noisy measure and a noise-free one.
struct Cost {
  double wall_seconds = 0.0;
  std::int64_t steps = 0;
  std::int64_t particle_steps = 0;
  std::int64_t memory_bytes = 0;  ///< of the solver's particles and nodes; 0 of an element test, which has neither
  double early_seconds = 0.0;    ///< when the steps had taken 0.15 s of wall time, or were over: how long ...
  std::int64_t early_steps = 0;  ///< ... and how many they were
};

/// What a run did: everything judged later is computed from this, never from the simulation itself.
struct Record {
  std::string case_id;
  std::string input_hash;    ///< of the resolved scene, probes and snapshots
  std::string program_hash;  ///< of the part that simulates of the program that ran it
  std::string revision;      ///< of the source tree that program was built from
  int threads = 1;           ///< of the pool the run was part of
  int step_threads = 1;      ///< that shared the work of each of its steps
  std::string failure;       ///< why there is no result at all (an exception's text); empty when there is one
  Outcome outcome;           ///< of a run with a `failure` it says only that it is not completed
  double time_step = 0.0;    ///< [s]
  double end_time = 0.0;     ///< [s]
  double unbalanced_force_ratio = 0.0;
  double kinetic_energy_ratio = 0.0;
  std::int64_t cell_crossings = 0;    ///< particle centres that changed cell, counted every step
  double relative_mass_change = 0.0;  ///< of the sum over the particles, end against start and density ramps
  std::int64_t non_finite_values = 0;  ///< in the final state of all particles, every field and component
  std::string digest;                 ///< of the bits of the final state; equal digests mean equal bits
  std::string repeat_digest;  ///< the same of the repeat on another number of threads; empty without one
  /// Number of threads that shared the work of each step, and digest, of each further repeat. Not stored: these repeats
  /// have records of their own.
  std::vector<std::pair<int, std::string>> repeats;
  Profile profile;
  std::vector<History> histories;
  /// Energy of motion over all energy that ever went in, at its largest [-]; see `Monitor`.
  double largest_energy_ratio = 0.0;
  std::map<std::string, double>
      measured;  ///< metrics that the record's states alone cannot tell, by name; of other descriptions of a
                 ///< scene, and of an element test what only the law itself knows
  std::vector<Snapshot> snapshots;  ///< in the order they were taken
  std::vector<ModelChoice> model;   ///< what was simulated instead of what was written, and what was left as it is
  /// Of a run that ended as a numerical failure: the last state seen in which no energy had come from nowhere.
  std::optional<Snapshot> last_good;
  std::optional<Survey> survey;     ///< of a case that surveys time steps, in place of all that describes one run
  std::vector<ElementCurve> paths;  ///< of an element test, over the imposed strain
  Cost cost;

  /// The run ended where it was meant to: its final state can be judged.
  bool completed() const { return failure.empty() && outcome.completed(); }
};

/// What the `failure` of a run begins with whose scene the solver does not accept.
inline const std::string refused_prefix = "refused: ";

/// How a run ended, for a person: "run ended outside_grid at step 123, t = 0.5 s, particle 49, value 1.04".
std::string ending_of(const Record& record);

/// Every number comes back with the same bits; NaN and infinities travel as "nan", "inf" and "-inf".
Json to_json(const Record& record);

/// What was chosen of a run's model, with all its numbers.
Json model_to_json(const std::vector<ModelChoice>& model);

/// The inverse of `to_json`. Throws std::exception for anything that is not a whole record.
Record record_from_json(const Json& json);

/// Called now and then while a run goes on, with the particle-steps done since the last call. False abandons
/// the run.
using Pulse = std::function<bool(std::int64_t particle_steps)>;

/// A run was abandoned because its pulse asked for it.
class Abandoned : public std::runtime_error {
 public:
  Abandoned() : std::runtime_error("the run was abandoned") {}
};

/// Runs one request of a case to its end and records it, probes included: each samples the first step, the
/// step nearest to every multiple of its interval, and the last step. A snapshot whose moment does not come
/// is left out. `cost.wall_seconds` covers the steps only. Throws SceneError, std::bad_alloc, and Abandoned
/// when `pulse` says so. An element test has increments, or random states, for steps, and neither time nor
/// particles.
Record simulate(const Case& definition, const RunRequest& request, const Pulse& pulse = {});

/// Hash of all that decides what a run computes and what is kept of it: scene, probes and snapshots; 16
/// hexadecimal digits.
std::string input_hash(const Case& definition, const RunRequest& request);

/// As `simulate`, without program and revision.
Record unsigned_record(const Case& definition, const RunRequest& request, const Pulse& pulse);

/// Hash of the part of this program that simulates; hexadecimal digits. It is that of the compiled libraries
/// which turn a scene into a record, so it tells another solver, compiler or set of flags, and does not tell
/// another gate, figure or page.
std::string program_hash();

/// Hash of a text; 16 hexadecimal digits [FNV-1a, 64 bit].
std::string hash_of(const std::string& text);

/// Replaces the file as a whole: whoever reads `path` sees the old text or the new one, never a part, even
/// when the machine stops in between. Throws std::system_error and leaves nothing behind.
void write_atomically(const std::filesystem::path& path, const std::string& text);

}  // namespace mpm::vv
