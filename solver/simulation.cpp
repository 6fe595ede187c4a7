#include "solver/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "solver/energy.hpp"
#include "solver/energy_watch.hpp"
#include "solver/time_step.hpp"

namespace mpm {
namespace {

/// Steps between two looks at whether a run is over: rare enough to cost nothing, often enough to stop in
/// time.
constexpr std::int64_t steps_between_looks = 64;

double fastest_wave(const Scene& scene) {
  const auto modulus = [&](const Material& material) {
    const auto wave_modulus = [](const auto& law) { return law.wave_modulus(); };
    return scene.dimension == 1 ? std::visit(wave_modulus, law_of<1, double>(material))
                                : std::visit(wave_modulus, law_of<2, double>(material));
  };
  double speed = 0.0;
  for (const Body& body : scene.bodies) {
    speed = std::max(speed, std::sqrt(modulus(body.material) / body.lightest()));
  }
  return speed;
}

double time_step_of(const Scene& scene) {
  if (const auto* given = std::get_if<GivenTimeStep>(&scene.time_step)) return given->seconds;
  return std::get<StableFraction>(scene.time_step).fraction * scene.cell_size / fastest_wave(scene);
}

/// [particle * components + component], particles in the order of their filling; zeros for absent fields.
template <class Real, std::size_t Components>
std::vector<double> interleave(const std::array<Field<Real>, Components>& fields,
                               const std::vector<std::int32_t>& slot_of) {
  std::vector<double> all(slot_of.size() * Components, 0.0);
  for (std::size_t c = 0; c < Components; ++c) {
    for (std::size_t p = 0; fields[c].size() > 0 && p < slot_of.size(); ++p) {
      all[p * Components + c] = static_cast<double>(fields[c][slot_of[p]]);
    }
  }
  return all;
}

/// The inverse of `interleave`; nothing for a field the scene does not keep. Throws std::invalid_argument for another
/// number of values.
template <class Real, std::size_t Components>
void scatter_back(const std::vector<double>& all, const char* name, const std::vector<std::int32_t>& slot_of,
                  std::array<Field<Real>, Components>& fields) {
  if (fields[0].size() == 0) return;
  if (all.size() != slot_of.size() * Components) {
    throw std::invalid_argument(std::string(name) + ": expected " + std::to_string(slot_of.size() * Components) +
                                " values, found " + std::to_string(all.size()));
  }
  for (std::size_t p = 0; p < slot_of.size(); ++p) {
    for (std::size_t c = 0; c < Components; ++c) {
      fields[c][slot_of[p]] = static_cast<Real>(all[p * Components + c]);
    }
  }
}

template <class Real>
std::vector<double> to_doubles(const Field<Real>& field, const std::vector<std::int32_t>& slot_of) {
  std::vector<double> all(slot_of.size());
  std::transform(slot_of.begin(), slot_of.end(), all.begin(),
                 [&](Eigen::Index slot) { return static_cast<double>(field[slot]); });
  return all;
}

Ending ending_of(StencilFault fault) {
  switch (fault) {
    case StencilFault::not_finite:
      return Ending::not_finite;
    case StencilFault::inverted:
      return Ending::inverted;
    case StencilFault::domain_too_large:
      return Ending::domain_too_large;
    default:
      return Ending::outside_grid;
  }
}

}  // namespace

const char* name_of(Ending ending) {
  switch (ending) {
    case Ending::reached_time:
      return "reached_time";
    case Ending::at_rest:
      return "at_rest";
    case Ending::not_at_rest:
      return "not_at_rest";
    case Ending::reached_displacement:
      return "reached_displacement";
    case Ending::not_reached:
      return "not_reached";
    case Ending::not_finite:
      return "not_finite";
    case Ending::inverted:
      return "inverted";
    case Ending::outside_grid:
      return "outside_grid";
    case Ending::gained_energy:
      return "gained_energy";
    case Ending::domain_too_large:
      return "domain_too_large";
  }
  return "unknown";
}

/// A simulation whose dimension, scalar and shape function have been forgotten.
class Simulation::Engine {
 public:
  explicit Engine(const Scene& scene)
      : scene_(scene), time_step_(time_step_of(scene)), loads_settled_after_(loads_settled_after(scene)) {}
  virtual ~Engine() = default;

  virtual std::int64_t particle_count() const = 0;
  virtual std::int64_t cell_crossings() const = 0;
  virtual std::int64_t arrangements() const = 0;
  virtual std::int64_t memory() const = 0;
  virtual Monitor monitor() const = 0;
  virtual ParticleFields particles() const = 0;
  virtual std::vector<RigidBodyState> rigid_bodies() const = 0;
  virtual void set_particles(const ParticleFields& fields) = 0;

  bool advance() {
    if (ended_) return false;
    const double fraction = scene_.gravity.fraction(time_at(outcome_.step + 1));
    largest_fraction_ = std::max(largest_fraction_, std::abs(fraction));
    if (step(outcome_.time, scene_.gravity.level * fraction)) {
      ++outcome_.step;
      outcome_.time = time_at(outcome_.step);
      if (outcome_.step % steps_between_looks == 0 && scene_.watched) {
        watch_energy(scene_.gravity.level * largest_fraction_);
        largest_fraction_ = 0.0;
      }
    }
    if (!ended_ && is_finished()) {
      ended_ = true;
      look_for_fault();  // what the last step did would otherwise be noticed by a next one only
    }
    return !ended_;
  }

  const Outcome& outcome() const { return outcome_; }
  double time_step() const { return time_step_; }
  double time_at(std::int64_t step) const { return static_cast<double>(step) * time_step_; }

 protected:
  /// One step from `time` on; false after `fail`.
  virtual bool step(double time, double gravity_level) = 0;
  /// Calls `fail` if the particles move with energy that came from nowhere.
  virtual void watch_energy(double gravity_level) = 0;
  /// Calls `fail` if a particle is in a state that has no next step. True if so.
  virtual bool look_for_fault() = 0;
  /// Of a body's particles, by mass, along an axis [m].
  virtual double mean_displacement(std::size_t body, std::size_t axis) const = 0;

  void fail(Ending ending, Eigen::Index particle, double value) {
    outcome_.ending = ending;
    outcome_.particle = particle;
    outcome_.value = value;
    ended_ = true;
  }

  const Scene& scene() const { return scene_; }

 private:
  bool is_finished() {
    return std::visit([&](const auto& end) { return is_finished(end); }, scene_.termination);
  }

  bool is_finished(const AtTime& end) const { return is_past(end.time); }

  bool is_finished(const AtRest& rest) {
    if (outcome_.time >= loads_settled_after_ && outcome_.step % steps_between_looks == 0) {
      const Monitor now = monitor();
      outcome_.ending = Ending::at_rest;
      if (now.unbalanced_force_ratio <= rest.unbalanced_force_ratio &&
          now.kinetic_energy_ratio <= rest.kinetic_energy_ratio) {
        return true;
      }
    }
    outcome_.ending = Ending::not_at_rest;
    return is_past(rest.deadline);
  }

  bool is_finished(const AtDisplacement& end) {
    if (outcome_.step % steps_between_looks == 0) {
      const auto body = std::find_if(scene_.bodies.begin(), scene_.bodies.end(),
                                     [&](const Body& candidate) { return candidate.name == end.body; });
      const double moved = mean_displacement(static_cast<std::size_t>(body - scene_.bodies.begin()),
                                             static_cast<std::size_t>(end.axis));
      outcome_.ending = Ending::reached_displacement;
      if (end.displacement > 0.0 ? moved >= end.displacement : moved <= end.displacement) return true;
    }
    outcome_.ending = Ending::not_reached;
    return is_past(end.deadline);
  }

  /// Half a step of slack: a time is reached by the step nearest to it.
  bool is_past(double time) const { return outcome_.time > time - 0.5 * time_step_; }

  Scene scene_;
  double time_step_, loads_settled_after_;
  double largest_fraction_ = 0.0;  ///< of gravity since the last look at the energy
  Outcome outcome_;
  bool ended_ = false;
};

template <int Dim, class Real, Scheme scheme>
class Simulation::EngineOf final : public Simulation::Engine {
 public:
  EngineOf(const Scene& description, int threads)
      : Engine(description), local_(from_grid_corner(description)), stepper_(local_, time_step(), threads) {
    start_watch();
  }

  std::int64_t particle_count() const override { return stepper_.particles().count(); }
  std::int64_t cell_crossings() const override { return stepper_.cell_crossings(); }
  std::int64_t arrangements() const override { return stepper_.arrangements(); }
  std::int64_t memory() const override { return stepper_.bytes(); }

  Monitor monitor() const override {
    const Grid<Dim, Real>& grid = stepper_.grid();
    const auto [first, count] = grid.place_of(stepper_.active_rows());
    double energy = 0.0;
    for (Eigen::Index i = first; i < first + count; ++i) {
      for (std::size_t a = 0; a < Dim; ++a) {
        const double velocity = static_cast<double>(grid.velocity[a][i]);
        energy += 0.5 * static_cast<double>(grid.mass[i]) * velocity * velocity;
      }
    }
    return {.unbalanced_force_ratio = stepper_.unbalanced_force() / weight(),
            .kinetic_energy_ratio = energy / (weight() * scene().cell_size),
            .energy_ratio = watch_.ratio(),
            .largest_energy_ratio = watch_.largest()};
  }

  ParticleFields particles() const override {
    const Particles<Dim, Real>& p = stepper_.particles();
    ParticleFields fields;
    fields.dimension = Dim;
    fields.initial_position = initial_positions();
    fields.displacement = interleave(p.displacement, p.slot_of);
    fields.position = interleave(p.position, p.slot_of);
    for (std::size_t k = 0; k < fields.position.size(); ++k) fields.position[k] += scene().grid_lower[k % Dim];
    fields.velocity = interleave(p.velocity, p.slot_of);
    fields.half_size = interleave(p.half_size, p.slot_of);
    fields.stress = interleave(p.stress, p.slot_of);
    fields.volume = to_doubles(p.volume, p.slot_of);
    fields.mass = to_doubles(p.mass, p.slot_of);
    if (scene().sums_strain) fields.strain = interleave(p.strain, p.slot_of);
    if (scene().sums_work) fields.stress_work = interleave(p.stress_work, p.slot_of);
    if (p.deformation_gradient[0].size() > 0) {
      fields.deformation_gradient = interleave(p.deformation_gradient, p.slot_of);
    }
    fields.body.resize(p.slot_of.size());
    fields.initial_volume.resize(p.slot_of.size());
    for (std::size_t b = 0; b < p.bodies.size(); ++b) {
      for (Eigen::Index slot = p.bodies[b].first; slot < p.bodies[b].last; ++slot) {
        const std::int32_t id = p.id[static_cast<std::size_t>(slot)];
        if (id < 0) continue;
        fields.body[static_cast<std::size_t>(id)] = b;
        fields.initial_volume[static_cast<std::size_t>(id)] = static_cast<double>(p.first_volume[b]);
      }
    }
    return fields;
  }

  void set_particles(const ParticleFields& fields) override {
    const std::size_t particles = stepper_.particles().slot_of.size();
    if (fields.dimension != Dim || fields.mass.size() != particles || fields.volume.size() != particles)
      throw std::invalid_argument("the state of other particles");
    stepper_.change_particles([&](Particles<Dim, Real>& p) {
      std::vector<double> local = fields.position;
      for (std::size_t k = 0; k < local.size(); ++k) local[k] -= scene().grid_lower[k % Dim];
      scatter_back(local, "position", p.slot_of, p.position);
      scatter_back(fields.displacement, "displacement", p.slot_of, p.displacement);
      scatter_back(fields.velocity, "velocity", p.slot_of, p.velocity);
      scatter_back(fields.half_size, "half_size", p.slot_of, p.half_size);
      scatter_back(fields.stress, "stress", p.slot_of, p.stress);
      scatter_back(fields.strain, "strain", p.slot_of, p.strain);
      scatter_back(fields.stress_work, "stress_work", p.slot_of, p.stress_work);
      scatter_back(fields.deformation_gradient, "deformation_gradient", p.slot_of, p.deformation_gradient);
      std::array<Field<Real>, 1> volume{std::move(p.volume)};
      scatter_back(fields.volume, "volume", p.slot_of, volume);
      p.volume = std::move(volume[0]);
    });
    start_watch();
  }

  std::vector<RigidBodyState> rigid_bodies() const override {
    std::vector<RigidBodyState> states;
    for (std::size_t b = 0; b < scene().rigid_bodies.size(); ++b) {
      const RigidBody& body = scene().rigid_bodies[b];
      RigidBodyState state{.displacement = {}, .impulse = stepper_.rigid_bodies().impulses()[b]};
      for (std::size_t a = 0; a < Dim; ++a) {
        state.displacement[a] = body.velocity[a] * body.travel_time(outcome().time);
      }
      states.push_back(state);
    }
    return states;
  }

 protected:
  bool step(double time, double gravity_level) override {
    Vector<Dim, Real> gravity;
    for (std::size_t a = 0; a < Dim; ++a) {
      gravity[a] = static_cast<Real>(gravity_level * scene().gravity.acceleration[a]);
    }
    return stepper_.advance(time, gravity) || !look_for_fault();
  }

  bool look_for_fault() override {
    const auto fault = stepper_.find_fault();
    if (fault.kind == StencilFault::none) return false;
    const bool is_place = fault.kind == StencilFault::outside_grid || fault.kind == StencilFault::not_finite;
    fail(ending_of(fault.kind), fault.particle, fault.value + (is_place ? scene().grid_lower[fault.axis] : 0.0));
    return true;
  }

  void watch_energy(double gravity_level) override {
    if (turns_) return;
    Vector<Dim, Real> gravity;
    for (std::size_t a = 0; a < Dim; ++a) {
      gravity[a] = static_cast<Real>(gravity_level * scene().gravity.acceleration[a]);
    }
    watch_.look(stepper_.particles(), gravity, static_cast<double>(steps_between_looks) * time_step(),
                work_of_rigid_bodies());
    if (!watch_.gains_energy() || look_for_fault()) return;
    fail(Ending::gained_energy, stepper_.particles().id[static_cast<std::size_t>(watch_.fastest())],
         watch_.ratio());
  }

  double mean_displacement(std::size_t body, std::size_t axis) const override {
    const Particles<Dim, Real>& p = stepper_.particles();
    double moment = 0.0, mass = 0.0;
    for (Eigen::Index slot = p.bodies[body].first; slot < p.bodies[body].last; ++slot) {
      moment += static_cast<double>(p.mass[slot]) * static_cast<double>(p.displacement[axis][slot]);
      mass += static_cast<double>(p.mass[slot]);
    }
    return moment / mass;
  }

 private:
  /// Where the bodies were filled, [particle * dimension + axis]: made again, because few ask and it would be
  /// a tenth of the memory.
  std::vector<double> initial_positions() const {
    std::vector<double> all;
    for (const Body& body : local_.bodies) {
      for (const PerAxis& center : lattice_of(local_, body).centers) {
        for (std::size_t a = 0; a < Dim; ++a) {
          all.push_back(static_cast<double>(static_cast<Real>(center[a])) + scene().grid_lower[a]);
        }
      }
    }
    return all;
  }

  /// Weight of everything under full gravity [N].
  double weight() const {
    double squares = 0.0;
    for (std::size_t a = 0; a < Dim; ++a) squares += std::pow(scene().gravity.acceleration[a], 2);
    return (total_mass(stepper_.particles()) + mass_without_inertia()) * scene().gravity.level * std::sqrt(squares);
  }

  /// What the bodies weigh more than what they resist acceleration with [kg per unit of the absent dimensions].
  double mass_without_inertia() const {
    const Particles<Dim, Real>& p = stepper_.particles();
    double sum = 0.0;
    for (std::size_t b = 0; b < scene().bodies.size(); ++b) {
      const Body& body = scene().bodies[b];
      if (!body.inertia) continue;
      for (Eigen::Index slot = p.bodies[b].first; slot < p.bodies[b].last; ++slot) {
        sum += static_cast<double>(p.mass[slot]) * (body.density_at(outcome().time) / *body.inertia - 1);
      }
    }
    return sum;
  }

  void start_watch() {
    if (!scene().watched) return;
    turns_ = std::any_of(scene().rigid_bodies.begin(), scene().rigid_bodies.end(),
                         [](const RigidBody& body) { return body.angular_velocity != 0.0; });
    const ParticleFields now = particles();
    watch_.start(scene(), stepper_.particles(), kinetic_energy(now) + strain_energy(scene(), now));
    work_of_rigid_bodies();
  }

  /// Done since it was last asked [J per unit of the absent dimensions].
  double work_of_rigid_bodies() {
    const std::vector<PerAxis>& impulses = stepper_.rigid_bodies().impulses();
    seen_impulses_.resize(impulses.size());
    double work = 0.0;
    for (std::size_t b = 0; b < impulses.size(); ++b) {
      for (std::size_t a = 0; a < Dim; ++a) {
        work += std::abs((impulses[b][a] - seen_impulses_[b][a]) * scene().rigid_bodies[b].velocity[a]);
      }
      seen_impulses_[b] = impulses[b];
    }
    return work;
  }

  const Scene local_;  ///< seen from the lower corner of the grid
  TimeStepper<Dim, Real, scheme> stepper_;
  EnergyWatch<Dim, Real> watch_;
  std::vector<PerAxis> seen_impulses_;
  /// A rigid body turns: the work of its torque is not summed, so energy is not watched.
  bool turns_ = false;
};

Simulation::Simulation(const Scene& scene, int threads) {
  check(scene);
  const auto make = [&]<int Dim, class Real>(std::integral_constant<int, Dim>,
                                             Real) -> std::unique_ptr<Engine> {
    switch (scene.scheme) {
      case Scheme::mpm:
        return std::make_unique<EngineOf<Dim, Real, Scheme::mpm>>(scene, threads);
      case Scheme::ugimp:
        return std::make_unique<EngineOf<Dim, Real, Scheme::ugimp>>(scene, threads);
      default:
        return std::make_unique<EngineOf<Dim, Real, Scheme::cpgimp>>(scene, threads);
    }
  };
  const auto with_dimension = [&](auto dimension) {
    return scene.precision == Precision::float32 ? make(dimension, 0.0F) : make(dimension, 0.0);
  };
  engine_ = scene.dimension == 1 ? with_dimension(std::integral_constant<int, 1>{})
                                 : with_dimension(std::integral_constant<int, 2>{});
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

bool Simulation::advance() { return engine_->advance(); }

const Outcome& Simulation::outcome() const { return engine_->outcome(); }
double Simulation::time() const { return engine_->outcome().time; }
double Simulation::time_step() const { return engine_->time_step(); }
std::int64_t Simulation::steps() const { return engine_->outcome().step; }
std::int64_t Simulation::particle_count() const { return engine_->particle_count(); }
std::int64_t Simulation::cell_crossings() const { return engine_->cell_crossings(); }
std::int64_t Simulation::arrangements() const { return engine_->arrangements(); }
std::int64_t Simulation::memory() const { return engine_->memory(); }
Monitor Simulation::monitor() const { return engine_->monitor(); }
ParticleFields Simulation::particles() const { return engine_->particles(); }
void Simulation::set_particles(const ParticleFields& fields) { engine_->set_particles(fields); }
std::vector<RigidBodyState> Simulation::rigid_bodies() const { return engine_->rigid_bodies(); }

}  // namespace mpm
