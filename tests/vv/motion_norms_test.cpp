// Motions judged through made-up final states and histories whose errors are known.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "reference/manufactured.hpp"
#include "tests/support/column_scene.hpp"
#include "vv/norms.hpp"

namespace mpm::vv {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

using Metrics = std::map<std::string, double>;

/// A case judged by one reference, its run and its record.
struct Trial {
  Case definition;
  RunRequest request;
  Record record;

  ParticleFields& end() { return record.snapshots.at(0).fields; }
  Judgement judgement() const { return judge(definition, request, record); }
  Metrics metrics() const { return judgement().metrics; }
};

// ---- manufactured motions

/// What the profile of a record says of particles in one dimension.
Profile profile_of(const ParticleFields& fields) {
  return {fields.initial_position, fields.displacement,   fields.position, fields.stress,
          fields.volume,           fields.initial_volume, fields.mass,     fields.half_size};
}

/// Particles of unequal size that are where `motion` takes them, with its stress.
ParticleFields exact_state(const reference::ManufacturedSolution& motion, double time) {
  ParticleFields fields;
  fields.dimension = motion.dimension();
  const auto axes = static_cast<std::size_t>(fields.dimension);
  for (int k = 0; k < 9; ++k) {
    const reference::Place initial{0.1 + 0.09 * k, axes == 2 ? 0.85 - 0.08 * k : 0.0};
    const reference::Place moved = motion.displacement(initial, time);
    for (std::size_t a = 0; a < axes; ++a) {
      fields.initial_position.push_back(initial[a]);
      fields.displacement.push_back(moved[a]);
      fields.position.push_back(initial[a] + moved[a]);
    }
    const reference::CauchyStress stress = motion.stress(initial, time);
    fields.stress.push_back(stress.xx);
    if (axes == 2) fields.stress.insert(fields.stress.end(), {stress.yy, stress.zz, stress.xy});
    fields.initial_volume.push_back(0.01 * (1 + k % 3));
    fields.volume.push_back(0.02);
    fields.mass.push_back(10.0 * (1 + k % 3));
    fields.half_size.insert(fields.half_size.end(), axes, 0.0);
    fields.body.push_back(0);
  }
  return fields;
}

Trial driven(const std::string& solution, const reference::Parameters& parameters, double time) {
  Trial trial;
  trial.definition.references = {"manufactured"};
  Scene& scene = trial.request.scene;
  scene = test::column_scene(Scheme::mpm, 10);
  scene.grid_lower = {-0.1, -0.1};
  scene.grid_upper = {1.1, 1.1};
  trial.request.motion = reference::manufactured_solution(solution, parameters, {1000.0, 1e7, 0.3});
  scene.dimension = trial.request.motion->dimension();
  scene.driven_motion = DrivenMotion{};
  trial.record.snapshots = {{"start", 0.0, {}}, {"end", time, exact_state(*trial.request.motion, time)}};
  std::swap(trial.record.snapshots[0], trial.record.snapshots[1]);
  if (scene.dimension == 1) trial.record.profile = profile_of(trial.end());
  return trial;
}

/// One and two dimensions, in which every component of displacement and stress is there.
std::vector<Trial> driven_trials() {
  return {
      driven("standing_wave", {{"amplitude", 0.05}}, 0.003),
      driven("axis_aligned", {{"amplitude", 0.05}}, 0.003),
      driven("generalised_vortex", {{"amplitude", 0.8}, {"inner_radius", 0.05}, {"outer_radius", 1.5}}, 0.4)};
}

const char* const norms[] = {".l1", ".l2", ".linf"};

TEST(ManufacturedNorms, AreNothingForTheExactFields) {
  for (const Trial& trial : driven_trials()) {
    EXPECT_EQ(why_unsuited("manufactured", trial.request), "");
    const Metrics metrics = trial.metrics();
    for (const std::string norm : norms) {
      EXPECT_EQ(metrics.at("manufactured.displacement" + norm), 0.0);
      EXPECT_EQ(metrics.at("manufactured.stress" + norm), 0.0);
    }
  }
}

TEST(ManufacturedNorms, AreTheShareByWhichAFieldIsWrong) {
  for (const double share : {0.07, -0.02})
    for (Trial trial : driven_trials()) {
      for (double& u : trial.end().displacement) u *= 1 + share;
      for (double& stress : trial.end().stress) stress *= 1 + 2 * share;
      const Metrics metrics = trial.metrics();
      for (const std::string norm : norms) {
        EXPECT_NEAR(metrics.at("manufactured.displacement" + norm), std::abs(share), 1e-12) << norm;
        EXPECT_NEAR(metrics.at("manufactured.stress" + norm), 2 * std::abs(share), 1e-12) << norm;
      }
    }
}

/// The three norms of an error in one entry of `exact`, weighted by the particles' initial volumes.
std::vector<double> norms_of_one_error(const std::vector<double>& exact, const std::vector<double>& volume,
                                       std::size_t at, double error) {
  const std::size_t components = exact.size() / volume.size();
  double sum = 0.0, squares = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    sum += volume[k / components] * std::abs(exact[k]);
    squares += volume[k / components] * exact[k] * exact[k];
    largest = std::max(largest, std::abs(exact[k]));
  }
  const double weight = volume[at / components];
  return {weight * error / sum, std::sqrt(weight * error * error / squares), error / largest};
}

TEST(ManufacturedNorms, WeighEveryComponentByTheInitialVolume) {
  for (const Trial& exact : driven_trials()) {
    const ParticleFields& fields = exact.record.snapshots[0].fields;
    for (const bool of_stress : {false, true}) {
      const std::vector<double>& field = of_stress ? fields.stress : fields.displacement;
      for (std::size_t at = 0; at < field.size(); at += 3) {
        Trial trial = exact;
        const double error = of_stress ? 2e3 : 3e-3;
        (of_stress ? trial.end().stress : trial.end().displacement)[at] += error;
        const std::vector<double> expected = norms_of_one_error(field, fields.initial_volume, at, error);
        const Metrics metrics = trial.metrics();
        for (std::size_t k = 0; k < 3; ++k) {
          const std::string name = of_stress ? "manufactured.stress" : "manufactured.displacement";
          EXPECT_NEAR(metrics.at(name + norms[k]) / expected[k], 1, 1e-9) << name << norms[k];
        }
      }
    }
  }
}

TEST(ManufacturedNorms, OfAnEntryThatIsNotANumberAreNotMeasured) {
  for (const Trial& exact : driven_trials())
    for (std::size_t at : {0u, 4u, 8u}) {
      Trial trial = exact;
      trial.end().displacement[at] = trial.end().stress[at] = not_a_number;
      const Metrics metrics = trial.metrics();
      for (const std::string norm : norms) {
        EXPECT_FALSE(metrics.contains("manufactured.displacement" + norm)) << at << norm;
        EXPECT_FALSE(metrics.contains("manufactured.stress" + norm)) << at << norm;
      }
    }
}

TEST(ManufacturedNorms, NeedTheEndAndTheWish) {
  for (const Trial& exact : driven_trials()) {
    Trial trial = exact;
    trial.record.snapshots.erase(trial.record.snapshots.begin());
    EXPECT_FALSE(trial.metrics().contains("manufactured.displacement.l2"));
    trial = exact;
    trial.definition.references.clear();
    EXPECT_FALSE(trial.metrics().contains("manufactured.displacement.l2"));
  }
}

TEST(ManufacturedNorms, DrawTheExactDisplacementOverTheHeightsOfTheRun) {
  Trial trial = driven_trials()[0];
  trial.end().displacement[3] += 0.01;
  trial.record.profile = profile_of(trial.end());
  std::vector<Curve> run, exact;
  for (const Curve& curve : trial.judgement().curves) {
    if (curve.name == "displacement") (curve.source == "run" ? run : exact).push_back(curve);
  }
  ASSERT_EQ(run.size(), 1u);
  ASSERT_EQ(exact.size(), 1u);
  EXPECT_EQ(exact[0].source, "manufactured");
  EXPECT_EQ(exact[0].x_name, run[0].x_name);
  EXPECT_EQ(exact[0].x, run[0].x);
  for (std::size_t p = 0; p < exact[0].y.size(); ++p)
    EXPECT_NEAR(run[0].y[p] - exact[0].y[p], p == 3 ? 0.01 : 0.0, 1e-15);
}

TEST(ManufacturedNorms, NeedADrivenMotion) {
  EXPECT_EQ(why_unsuited("manufactured", test::column_scene(Scheme::mpm)), "a driven motion");
}

// ---- vibration

/// The first mode of a bar: 25 Hz, particles at 0.1, 0.19, ..., 0.82 m of 1 m.
Trial vibrating(const std::function<double(double)>& displacement, double duration, double place = 0.8) {
  Trial trial = driven("vibrating_bar", {{"amplitude", 1e-3}}, duration);
  trial.definition.probes = {{.id = "tip",
                              .quantity = "displacement",
                              .component = "x",
                              .at = {place, 0.0},
                              .of = "",
                              .every = 1e-3}};
  History history{"tip", "displacement", {}, {}};
  for (double t = 1e-5; t < duration; t += 1e-3) {
    history.time.push_back(t);
    history.value.push_back(displacement(t));
  }
  trial.record.histories = {history};
  return trial;
}

constexpr double frequency = 50 * pi;                      // rad/s
const double amplitude = 1e-3 * std::sin(pi / 2 * 0.82);   // of the particle at 0.82 m
constexpr double durations[] = {0.1, 0.2, 0.6, 1.0, 4.0};  // 2.5 to 100 periods

TEST(VibrationNorms, RecoverFrequencyAndAmplitude) {
  for (const double duration : durations)
    for (const double phase : {0.0, 0.3, -1.5, 3.0}) {
      const Metrics metrics =
          vibrating([&](double t) { return amplitude * std::sin(frequency * t + phase); }, duration)
              .metrics();
      EXPECT_NEAR(metrics.at("bar.frequency"), 0.0, 1e-6) << duration << " s, phase " << phase;
      EXPECT_NEAR(metrics.at("bar.amplitude"), 0.0, 1e-6) << duration << " s, phase " << phase;
    }
}

TEST(VibrationNorms, ReportWhatIsDetunedOrTooLarge) {
  for (const double duration : durations)
    for (const double error : {0.01, -0.01, 0.08, -0.08}) {
      const Metrics detuned =
          vibrating([&](double t) { return amplitude * std::sin((1 + error) * frequency * t + 0.4); },
                    duration)
              .metrics();
      EXPECT_NEAR(detuned.at("bar.frequency"), std::abs(error), 1e-6) << duration << " s";
      EXPECT_NEAR(detuned.at("bar.amplitude"), 0.0, 1e-6) << duration << " s";
      const Metrics scaled =
          vibrating([&](double t) { return (1 + error) * amplitude * std::sin(frequency * t); }, duration)
              .metrics();
      EXPECT_NEAR(scaled.at("bar.amplitude"), std::abs(error), 1e-6) << duration << " s";
      EXPECT_NEAR(scaled.at("bar.frequency"), 0.0, 1e-6) << duration << " s";
    }
}

TEST(VibrationNorms, StayLargeWhereTheFrequencyIsFarOff) {
  for (const double factor : {0.5, 0.8, 1.25, 2.0})
    EXPECT_GT(vibrating([&](double t) { return amplitude * std::sin(factor * frequency * t); }, 1.0)
                  .metrics()
                  .at("bar.frequency"),
              0.02)
        << factor;
}

TEST(VibrationNorms, AreOfTheParticleNearestToTheProbe) {
  const auto amplitude_error = [](double place, double of_particle) {
    const double exact = 1e-3 * std::sin(pi / 2 * of_particle);
    return vibrating([&](double t) { return exact * std::sin(frequency * t); }, 0.2, place)
        .metrics()
        .at("bar.amplitude");
  };
  EXPECT_NEAR(amplitude_error(2.0, 0.82), 0.0, 1e-6);
  EXPECT_NEAR(amplitude_error(0.5, 0.46), 0.0, 1e-6);
  EXPECT_NEAR(amplitude_error(0.52, 0.55), 0.0, 1e-6);
  EXPECT_GT(amplitude_error(0.52, 0.46), 0.1);
}

TEST(VibrationNorms, NeedADisplacementProbeOnAParticleAndTheEnd) {
  const Trial good = vibrating([](double t) { return amplitude * std::sin(frequency * t); }, 0.2);
  for (const auto change :
       {+[](Trial& t) { t.definition.probes[0].quantity = "velocity"; },
        +[](Trial& t) { t.definition.probes[0].target = ProbeTarget::body; },
        +[](Trial& t) { t.definition.probes.clear(); }, +[](Trial& t) { t.record.snapshots.clear(); },
        +[](Trial& t) { t.record.histories[0].value[7] = not_a_number; },
        +[](Trial& t) { t.definition.references.clear(); }}) {
    Trial trial = good;
    change(trial);
    EXPECT_FALSE(trial.metrics().contains("bar.frequency"));
    EXPECT_FALSE(trial.metrics().contains("bar.amplitude"));
  }
  // The probe need not be the first one.
  Trial second = good;
  second.definition.probes.insert(second.definition.probes.begin(), second.definition.probes[0]);
  second.definition.probes[0].quantity = "velocity";
  second.record.histories.insert(second.record.histories.begin(),
                                 {"speed", "velocity", {0.0, 1.0}, {5.0, 6.0}});
  EXPECT_NEAR(second.metrics().at("bar.frequency"), 0.0, 1e-6);
}

TEST(VibrationNorms, DrawTheExactHistory) {
  const Judgement judgement = vibrating([](double) { return 1.0; }, 0.02).judgement();
  int found = 0;
  for (const Curve& curve : judgement.curves) {
    if (curve.name != "tip") continue;
    ++found;
    EXPECT_EQ(curve.x_name, "time");
    ASSERT_EQ(curve.x.size(), 20u);
    for (std::size_t k = 0; k < curve.x.size(); ++k)
      EXPECT_NEAR(curve.y[k], curve.source == "run" ? 1.0 : amplitude * std::sin(frequency * curve.x[k]),
                  1e-12);
  }
  EXPECT_EQ(found, 2);
}

// ---- free fall

/// Two blocks thrown to the side and upwards.
Scene thrown() {
  Scene scene = test::column_scene(Scheme::cpgimp, 10);
  scene.dimension = 2;
  scene.damping = 0.0;
  scene.edges = {};
  scene.grid_lower = {-2.0, -2.0};
  scene.grid_upper = {2.0, 2.0};
  scene.bodies[0].upper = {0.3, 0.2};
  scene.bodies[0].velocity = {1.0, 2.0};
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[1].name = "second";
  scene.bodies[1].lower = {0.5, 0.5};
  scene.bodies[1].upper = {0.7, 0.6};
  scene.gravity.acceleration = {0.5, -10.0};
  scene.gravity.level = 2.0;
  scene.time_step = GivenTimeStep{1e-3};
  scene.termination = AtTime{0.1};
  return scene;
}

/// Particles of both blocks at t = 0.1 s, after 100 steps of 1 ms: v t + g t (t + dt) / 2.
Trial falling() {
  Trial trial;
  trial.definition.references = {"free_fall"};
  trial.request.scene = thrown();
  trial.record.time_step = 1e-3;
  ParticleFields fields;
  fields.dimension = 2;
  fields.mass = fields.volume = fields.initial_volume = {1.0, 1.0};
  const double x = 0.1 + 1.0 * 0.00505, y = 0.2 - 20.0 * 0.00505;
  fields.displacement = {x, y, x, y};
  fields.stress.assign(8, 0.0);
  fields.body = {0, 1};
  trial.record.snapshots = {{"end", 0.1, fields}};
  return trial;
}

TEST(FreeFallNorms, AreNothingForTheParabolaOfTheSteps) {
  EXPECT_EQ(why_unsuited("free_fall", falling().request), "");
  const Metrics metrics = falling().metrics();
  EXPECT_NEAR(metrics.at("free_fall.displacement"), 0.0, 1e-14);
  EXPECT_EQ(metrics.at("free_fall.stress"), 0.0);
}

TEST(FreeFallNorms, AreTheLargestErrorOverTheLargestDisplacement) {
  for (const std::size_t component : {0u, 1u, 2u, 3u})
    for (const double error : {1e-3, -1e-3}) {
      Trial trial = falling();
      trial.end().displacement[component] += error;
      EXPECT_NEAR(trial.metrics().at("free_fall.displacement"), 1e-3 / 0.10505, 1e-12);
    }
  Trial scaled = falling();
  for (double& u : scaled.end().displacement) u *= 0.98;
  EXPECT_NEAR(scaled.metrics().at("free_fall.displacement"), 0.02, 1e-12);
  Trial stressed = falling();
  stressed.end().stress[5] = -300.0;
  EXPECT_NEAR(stressed.metrics().at("free_fall.stress"), 3e-5, 1e-15);
}

TEST(FreeFallNorms, OfAnEntryThatIsNotANumberAreNotMeasured) {
  for (const std::size_t at : {0u, 1u, 3u}) {
    Trial trial = falling();
    trial.end().displacement[at] = trial.end().stress[at] = not_a_number;
    EXPECT_FALSE(trial.metrics().contains("free_fall.displacement")) << at;
    EXPECT_FALSE(trial.metrics().contains("free_fall.stress")) << at;
  }
}

/// A run of a scene, judged by its own state at the end.
Metrics simulated(const std::string& reference, const Scene& scene) {
  Trial trial;
  trial.definition.references = {reference};
  trial.definition.snapshots = {SnapshotRequest{}};
  trial.request.scene = scene;
  trial.record = simulate(trial.definition, trial.request);
  EXPECT_TRUE(trial.record.completed()) << ending_of(trial.record);
  return trial.metrics();
}

TEST(FreeFallNorms, AreRoundOffOfARun) {
  Scene plane = thrown(), line = test::column_scene(Scheme::ugimp, 10);
  line.damping = 0.0;
  line.edges = {};
  line.grid_lower = {-2.0, 0.0};
  for (const Scene& scene : {plane, line}) {
    const Metrics metrics = simulated("free_fall", scene);
    EXPECT_LT(metrics.at("free_fall.displacement"), 1e-12);
    EXPECT_LT(metrics.at("free_fall.stress"), 1e-12);
  }
}

struct Unsuited {
  const char* expected;
  std::function<void(Scene&)> change;
};

void expect_refusals(const std::string& reference, const Scene& suited,
                     const std::vector<Unsuited>& changes) {
  EXPECT_EQ(why_unsuited(reference, suited), "");
  for (const Unsuited& unsuited : changes) {
    Scene scene = suited;
    unsuited.change(scene);
    EXPECT_EQ(why_unsuited(reference, scene), unsuited.expected) << reference;
  }
}

TEST(WhyNoFreeFall, NamesWhatIsMissing) {
  const char* free = "free edges and no load but gravity";
  const char* in_full = "gravity that acts in full from the start";
  const char* plain = "bodies that start free of stress and keep their mass";
  expect_refusals("free_fall", thrown(),
                  {{free, [](Scene& s) { s.edges[0][1] = Condition::roller; }},
                   {free, [](Scene& s) { s.edges[1][0] = Condition::fixed; }},
                   {free, [](Scene& s) { s.rigid_bodies.resize(1); }},
                   {free, [](Scene& s) { s.surface_loads.resize(1); }},
                   {free, [](Scene& s) { s.driven_motion = DrivenMotion{}; }},
                   {in_full, [](Scene& s) { s.gravity.loading = RampLoading{1.0}; }},
                   {in_full,
                    [](Scene& s) {
                      s.gravity.loading = StagedLoading{1.0, {1.0}};
                    }},
                   {"no damping", [](Scene& s) { s.damping = 0.1; }},
                   {"one velocity for all bodies", [](Scene& s) { s.bodies[1].velocity[0] = 0.0; }},
                   {plain, [](Scene& s) { s.bodies[1].initial_stress = UniformStress{}; }},
                   {plain, [](Scene& s) {
                      s.bodies[1].density_ramp = DensityRamp{0.0, {{1.0, 1.0}}};
                    }}});
}

// ---- rotation

/// Two blocks with stresses of their own, held by a body that turns all by a third of a turn.
Scene turning(double angle = 2 * pi / 3) {
  Scene scene = thrown();
  scene.objectivity = Objectivity::jaumann;
  scene.gravity = {};
  scene.grid_lower = {-1.0, -1.0};
  scene.grid_upper = {1.0, 1.0};
  for (Body& body : scene.bodies) body.velocity = {};
  scene.bodies[0].initial_stress = UniformStress{-3e3, -5e3, -4e3, 1e3};
  scene.bodies[1].initial_stress = UniformStress{2e3, 0.0, 1e3, -500.0};
  RigidBody all{.name = "all", .lower = {-1.0, -1.0}, .upper = {1.0, 1.0}};
  all.angular_velocity = 2.0;
  all.start = 0.5;
  all.ramp = 1.0;
  scene.rigid_bodies = {all};
  scene.termination = AtTime{1.0 + angle / 2.0};  // the ramp costs half of itself
  return scene;
}

Trial turned() {
  Trial trial;
  trial.definition.references = {"rotation"};
  trial.request.scene = turning();
  ParticleFields fields;
  fields.dimension = 2;
  fields.mass = {1.0, 1.0};
  fields.body = {1, 0};
  fields.displacement.assign(4, 0.0);
  // cos = -1/2, sin = root(3)/2: xx' = xx/4 + 3/4 yy + root(3)/2 xy, yy' the same with the two exchanged and
  // minus, xy' = -root(3)/4 (xx - yy) - xy/2.
  for (const UniformStress& s :
       {UniformStress{2e3, 0.0, 1e3, -500.0}, UniformStress{-3e3, -5e3, -4e3, 1e3}}) {
    const double half_root = std::sqrt(3.0) / 2;
    fields.stress.insert(fields.stress.end(), {s.xx / 4 + 3 * s.yy / 4 + half_root * s.xy,
                                               3 * s.xx / 4 + s.yy / 4 - half_root * s.xy, s.zz,
                                               -half_root / 2 * (s.xx - s.yy) - s.xy / 2});
  }
  trial.record.snapshots = {{"end", 1.0 + pi / 3, fields}};
  return trial;
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

TEST(RotationNorm, IsNothingForStressTurnedByAThird) {
  EXPECT_EQ(why_unsuited("rotation", turned().request), "");
  EXPECT_NEAR(turned().metrics().at("rotation.stress"), 0.0, 1e-12);
}

TEST(RotationNorm, IsTheLargestErrorOverTheLargestComponent) {
  const double scale = largest(turned().end().stress);
  for (std::size_t component = 0; component < 8; ++component) {
    Trial trial = turned();
    trial.end().stress[component] -= 100.0;
    EXPECT_NEAR(trial.metrics().at("rotation.stress"), 100.0 / scale, 1e-12) << component;
    trial.end().stress[component] = not_a_number;
    EXPECT_FALSE(trial.metrics().contains("rotation.stress")) << component;
  }
  Trial scaled = turned();
  for (double& stress : scaled.end().stress) stress *= 1.03;
  EXPECT_NEAR(scaled.metrics().at("rotation.stress"), 0.03, 1e-12);
}

TEST(RotationNorm, IsLargeForStressThatStayedOrTurnedTheOtherWay) {
  Trial stayed = turned();
  stayed.end().stress = {2e3, 0.0, 1e3, -500.0, -3e3, -5e3, -4e3, 1e3};
  EXPECT_GT(stayed.metrics().at("rotation.stress"), 0.2);
  Trial reversed = turned();
  reversed.request.scene.rigid_bodies[0].angular_velocity *= -1;
  EXPECT_GT(reversed.metrics().at("rotation.stress"), 0.2);
  Trial swapped = turned();
  swapped.end().body = {0, 1};
  EXPECT_GT(swapped.metrics().at("rotation.stress"), 0.2);
}

TEST(RotationNorm, TellsARunThatTurnsItsStressFromOneThatDoesNot) {
  // By an eighth of a turn and 1 ms steps.
  Scene scene = turning(pi / 4);
  EXPECT_LT(simulated("rotation", scene).at("rotation.stress"), 1e-3);
  scene.objectivity = Objectivity::none;
  EXPECT_GT(simulated("rotation", scene).at("rotation.stress"), 0.1);
}

TEST(WhyNoRotation, NamesWhatIsMissing) {
  const char* one = "one rigid body that turns";
  const char* whole = "a rigid body that holds the whole grid";
  const char* only = "a rigid body that only turns";
  const char* stress = "bodies with a uniform initial stress";
  expect_refusals("rotation", turning(),
                  {{"two dimensions", [](Scene& s) { s.dimension = 1; }},
                   {one, [](Scene& s) { s.rigid_bodies.clear(); }},
                   {one, [](Scene& s) { s.rigid_bodies.push_back(s.rigid_bodies[0]); }},
                   {one, [](Scene& s) { s.rigid_bodies[0].angular_velocity = 0.0; }},
                   {"a rigid body that constrains both components",
                    [](Scene& s) { s.rigid_bodies[0].constrains[0] = false; }},
                   {"a rigid body that constrains both components",
                    [](Scene& s) { s.rigid_bodies[0].constrains[1] = false; }},
                   {whole, [](Scene& s) { s.rigid_bodies[0].lower[0] = -0.9; }},
                   {whole, [](Scene& s) { s.rigid_bodies[0].upper[1] = 0.9; }},
                   {only, [](Scene& s) { s.rigid_bodies[0].velocity[0] = 0.1; }},
                   {only, [](Scene& s) { s.rigid_bodies[0].velocity[1] = -0.1; }},
                   {stress, [](Scene& s) { s.bodies[1].initial_stress.reset(); }},
                   {stress, [](Scene& s) {
                      s.bodies[1].initial_stress = GeostaticStress{1.0, 0.5};
                    }}});
}

TEST(MotionCatalogue, HoldsEveryMetricThatIsMeasured) {
  const std::map<std::string, Metrics> measured = {
      {"manufactured",
       vibrating([](double t) { return amplitude * std::sin(frequency * t); }, 0.11).metrics()},
      {"free_fall", falling().metrics()},
      {"rotation", turned().metrics()}};
  int found = 0;
  for (const Metric& metric : metric_catalogue()) {
    if (!measured.contains(metric.reference)) continue;
    ++found;
    EXPECT_TRUE(measured.at(metric.reference).contains(metric.name)) << metric.name;
  }
  EXPECT_EQ(found, 11);
  EXPECT_EQ(why_unsuited("nonsense", thrown()), "to be known");
}

}  // namespace
}  // namespace mpm::vv
