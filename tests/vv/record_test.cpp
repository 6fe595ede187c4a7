#include "vv/record.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <set>
#include <system_error>

#include "tests/support/column_scene.hpp"
#include "tests/support/scratch_directory.hpp"
#include "solver/energy.hpp"
#include "vv/sampler.hpp"

namespace mpm::vv {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<std::uint64_t> bits_of(const std::vector<double>& values) {
  std::vector<std::uint64_t> bits;
  for (double value : values) bits.push_back(std::bit_cast<std::uint64_t>(value));
  return bits;
}

/// A column of `cells` particles that falls onto its fixed base.
RunRequest column(int cells, Scheme scheme = Scheme::cpgimp) {
  RunRequest request;
  Scene& scene = request.scene;
  scene = test::column_scene(scheme, cells);
  scene.gravity.loading = RampLoading{0.01};
  scene.time_step = GivenTimeStep{1e-4};
  scene.termination = AtTime{0.05};
  request.scene_text = {{"cells", cells}};
  return request;
}

HistoryProbe probe(const std::string& id, const std::string& quantity, double at, double every) {
  return {.id = id, .quantity = quantity, .component = "", .at = {at, 0.0}, .of = "", .every = every};
}

Record full_record() {
  Record record;
  record.case_id = "a_case";
  record.input_hash = "0123456789abcdef";
  record.program_hash = "fedcba9876543210";
  record.revision = "1234567-dirty";
  record.threads = 2;
  record.outcome = {
      .ending = Ending::outside_grid, .step = (1LL << 53) + 1, .time = 0.1, .particle = 7, .value = nan};
  record.time_step = 1.0 / 3.0;
  record.end_time = 0.1 + 0.2;
  record.unbalanced_force_ratio = infinity;
  record.kinetic_energy_ratio = -infinity;
  record.cell_crossings = 9'007'199'254'740'993;
  record.relative_mass_change = -0.0;
  record.non_finite_values = 3;
  record.digest = "0000000000000001";
  record.repeat_digest = "0000000000000002";
  record.profile = {{0.0, 0.5}, {-1e-3, -2e-3}, {1e-300, 5e-324}, {nan, -0.0},
                    {1, 2},     {3, 4},         {5, 6},           {7, 8}};
  record.histories = {{"top", "displacement", {0.0, 0.1}, {-0.0, nan}}};
  ParticleFields fields;
  fields.dimension = 2;
  fields.initial_position = {1.0 / 3.0, 1e-300, 0.0, -0.0};
  fields.displacement = fields.position = fields.velocity = fields.half_size = {1, 2, 3, 4};
  fields.stress = fields.strain = {-123456789.4, nan, infinity, 1e10 / 7, 5, 6, 7, 8};
  fields.volume = fields.initial_volume = fields.mass = {0.1, 0.2};
  fields.stress_work = {1.25, -3.0};
  fields.body = {0, 3};
  record.snapshots = {{"end", 0.1 + 0.2, fields}};
  record.cost = {.wall_seconds = 1.5e-7, .steps = 12, .particle_steps = 600, .memory_bytes = 4096};
  return record;
}

TEST(RecordText, BringsBackEveryBit) {
  const Record written = full_record();
  const Record read = record_from_json(Json::parse(to_json(written).dump()));
  EXPECT_EQ(read.case_id, written.case_id);
  EXPECT_EQ(read.input_hash, written.input_hash);
  EXPECT_EQ(read.program_hash, written.program_hash);
  EXPECT_EQ(read.revision, written.revision);
  EXPECT_EQ(read.threads, 2);
  EXPECT_EQ(read.outcome.ending, Ending::outside_grid);
  EXPECT_EQ(read.outcome.step, written.outcome.step);
  EXPECT_EQ(read.outcome.time, 0.1);
  EXPECT_EQ(read.outcome.particle, 7);
  EXPECT_TRUE(std::isnan(read.outcome.value));
  EXPECT_EQ(read.non_finite_values, 3);
  EXPECT_EQ(read.time_step, written.time_step);
  EXPECT_EQ(read.end_time, written.end_time);
  EXPECT_EQ(read.unbalanced_force_ratio, infinity);
  EXPECT_EQ(read.kinetic_energy_ratio, -infinity);
  EXPECT_EQ(read.cell_crossings, written.cell_crossings);
  EXPECT_TRUE(std::signbit(read.relative_mass_change));
  EXPECT_EQ(read.digest, written.digest);
  EXPECT_EQ(read.repeat_digest, written.repeat_digest);
  EXPECT_EQ(bits_of(read.profile.displacement), bits_of(written.profile.displacement));
  EXPECT_EQ(bits_of(read.profile.position), bits_of(written.profile.position));
  EXPECT_EQ(bits_of(read.profile.stress), bits_of(written.profile.stress));
  EXPECT_EQ(read.profile.half_size, written.profile.half_size);
  ASSERT_EQ(read.histories.size(), 1u);
  EXPECT_EQ(read.histories[0].id, "top");
  EXPECT_EQ(read.histories[0].quantity, "displacement");
  EXPECT_EQ(bits_of(read.histories[0].value), bits_of(written.histories[0].value));
  EXPECT_EQ(read.cost.wall_seconds, 1.5e-7);
  EXPECT_EQ(read.cost.particle_steps, 600);
  EXPECT_EQ(read.cost.memory_bytes, 4096);
}

TEST(RecordText, BringsBackAnyFiniteNumber) {
  std::mt19937_64 random(1);
  Record written;
  while (written.profile.stress.size() < 20'000) {
    const auto value = std::bit_cast<double>(random());
    if (std::isfinite(value)) written.profile.stress.push_back(value);
  }
  const std::vector<double> filler(written.profile.stress.size(), 0.0);
  Profile& profile = written.profile;
  for (auto* field : {&profile.initial_position, &profile.displacement, &profile.position, &profile.volume,
                      &profile.initial_volume, &profile.mass, &profile.half_size}) {
    *field = filler;
  }
  const Record read = record_from_json(Json::parse(to_json(written).dump()));
  EXPECT_EQ(bits_of(read.profile.stress), bits_of(written.profile.stress));
}

TEST(RecordText, BringsBackSnapshotsToNineDigits) {
  const std::string text = to_json(full_record()).dump();
  const Record read = record_from_json(Json::parse(text));
  ASSERT_EQ(read.snapshots.size(), 1u);
  const Snapshot& snapshot = read.snapshots[0];
  EXPECT_EQ(snapshot.moment, "end");
  EXPECT_EQ(snapshot.time, 0.1 + 0.2);
  EXPECT_EQ(snapshot.fields.dimension, 2);
  EXPECT_EQ(snapshot.fields.initial_position, (std::vector<double>{0.333333333, 1e-300, 0.0, 0.0}));
  EXPECT_EQ(snapshot.fields.velocity, (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(snapshot.fields.stress[0], -123456789.0);
  EXPECT_TRUE(std::isnan(snapshot.fields.stress[1]));
  EXPECT_EQ(snapshot.fields.stress[2], infinity);
  EXPECT_EQ(snapshot.fields.stress[3], 1428571430.0);
  EXPECT_EQ(snapshot.fields.strain.size(), 8u);
  EXPECT_EQ(snapshot.fields.stress_work, (std::vector<double>{1.25, -3.0}));
  EXPECT_TRUE(snapshot.fields.deformation_gradient.empty());
  EXPECT_EQ(snapshot.fields.mass, (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(snapshot.fields.body, (std::vector<std::size_t>{0, 3}));
  EXPECT_NE(text.find("[0.333333333,1e-300,"), std::string::npos) << "no digit more is written";
  EXPECT_EQ(to_json(read).dump(), text);
}

TEST(RecordText, NeverTurnsANumberIntoNull) {
  EXPECT_EQ(to_json(full_record()).dump().find("null"), std::string::npos);
  EXPECT_EQ(to_json(full_record())["profile"]["stress"][0], "nan");
}

TEST(RecordText, RefusesWhatIsNoWholeRecord) {
  const Json good = to_json(full_record());
  EXPECT_NO_THROW(record_from_json(good));
  for (const char* key : {"schema", "outcome", "profile", "histories", "snapshots", "cost", "digest"}) {
    Json lacking = good;
    lacking.erase(key);
    EXPECT_ANY_THROW(record_from_json(lacking)) << key;
  }
  Json shorter = good;
  shorter["profile"]["stress"].erase(0);
  EXPECT_ANY_THROW(record_from_json(shorter));
  Json uneven = good;
  uneven["histories"][0]["time"].push_back(0.3);
  EXPECT_ANY_THROW(record_from_json(uneven));
  for (const char* key : {"initial_position", "stress", "strain", "stress_work", "mass", "body"}) {
    Json lacking = good;
    lacking["snapshots"][0]["fields"][key].erase(0);
    EXPECT_ANY_THROW(record_from_json(lacking)) << key;
  }
  Json spatial = good;
  spatial["snapshots"][0]["fields"]["dimension"] = 3;
  EXPECT_ANY_THROW(record_from_json(spatial));
  Json unknown = good;
  unknown["outcome"]["ending"] = "fine";
  EXPECT_ANY_THROW(record_from_json(unknown));
  Json null = good;
  null["time_step"] = nullptr;
  EXPECT_ANY_THROW(record_from_json(null));
}

TEST(RecordEnding, SaysHowWhereAndWhen) {
  Record record;
  record.outcome = {.ending = Ending::outside_grid, .step = 123, .time = 0.5, .particle = 49, .value = 1.04};
  EXPECT_EQ(ending_of(record), "run ended outside_grid at step 123, t = 0.5 s, particle 49, value 1.04");
  EXPECT_FALSE(record.completed());
  record.outcome = {};
  EXPECT_TRUE(record.completed());
  record.failure = "out of memory";
  EXPECT_EQ(ending_of(record), "run failed: out of memory");
  EXPECT_FALSE(record.completed());
}

TEST(Simulate, RecordsTheRunItWasAskedFor) {
  Case definition;
  definition.id = "column";
  const RunRequest request = column(10);
  const Record record = simulate(definition, request);
  EXPECT_EQ(record.case_id, "column");
  EXPECT_EQ(record.input_hash, input_hash(definition, request));
  EXPECT_EQ(record.program_hash, program_hash());
  EXPECT_EQ(record.outcome.ending, Ending::reached_time);
  EXPECT_TRUE(record.completed());
  EXPECT_EQ(record.cost.steps, 500);
  EXPECT_EQ(record.cost.particle_steps, 5000);
  EXPECT_GT(record.cost.wall_seconds, 0.0);
  EXPECT_NEAR(record.end_time, 0.05, 1e-12);
  EXPECT_EQ(record.relative_mass_change, 0.0);
  ASSERT_EQ(record.profile.stress.size(), 10u);
  EXPECT_NEAR(record.profile.initial_position[3], 0.35, 1e-12);
  // Compressed, most at the base.
  EXPECT_LT(record.profile.stress[0], 10.0 * record.profile.stress[9]);
  EXPECT_LT(record.profile.displacement[9], 0.0);
}

TEST(Simulate, HasADigestOfTheFinalBits) {
  Case definition;
  const Record once = simulate(definition, column(10));
  const Record again = simulate(definition, column(10));
  EXPECT_EQ(once.digest, again.digest);
  RunRequest heavier = column(10);
  heavier.scene.bodies[0].density = std::nextafter(1000.0, 2000.0);
  EXPECT_NE(simulate(definition, heavier).digest, once.digest);
}

TEST(Simulate, SamplesEveryProbeAtItsOwnInterval) {
  Case definition;
  definition.probes = {probe("top", "displacement", 1.0, 0.01), probe("base", "stress", 0.0, 0.02),
                       probe("speed", "velocity", 1.0, 1.0)};
  const Record record = simulate(definition, column(10));
  ASSERT_EQ(record.histories.size(), 3u);
  const History& top = record.histories[0];
  ASSERT_EQ(top.time.size(), 6u);
  for (std::size_t k = 0; k < top.time.size(); ++k) {
    EXPECT_NEAR(top.time[k], 0.01 * static_cast<double>(k), 1e-9);
  }
  EXPECT_EQ(top.value.front(), 0.0);
  EXPECT_EQ(top.value.back(), record.profile.displacement.back());
  const History& base = record.histories[1];
  ASSERT_EQ(base.time.size(), 4u);  // 0, 0.02, 0.04 and the end
  EXPECT_NEAR(base.time[2], 0.04, 1e-9);
  EXPECT_EQ(base.value.back(), record.profile.stress.front());
  const History& speed = record.histories[2];
  ASSERT_EQ(speed.time.size(), 2u);  // an interval longer than the run leaves its first and last step
  EXPECT_EQ(speed.time.front(), 0.0);
  EXPECT_NEAR(speed.time.back(), 0.05, 1e-9);
}

TEST(Simulate, SamplesEveryStepWhenTheIntervalIsShorter) {
  Case definition;
  definition.probes = {probe("top", "displacement", 1.0, 1e-5)};
  const Record record = simulate(definition, column(10));
  EXPECT_EQ(record.histories[0].time.size(), 501u);
}

TEST(Simulate, ProbesDoNotChangeTheRun) {
  Case bare, watched;
  watched.probes = {probe("top", "displacement", 1.0, 3e-4)};
  EXPECT_EQ(simulate(bare, column(10)).profile.stress, simulate(watched, column(10)).profile.stress);
}

TEST(Simulate, RecordsANumericalFailureAsAnOutcome) {
  RunRequest request = column(10);
  request.scene.time_step = GivenTimeStep{0.05};  // ten times what is stable
  request.scene.termination = AtTime{100.0};
  Case definition;
  definition.probes = {probe("top", "displacement", 1.0, 0.1)};
  const Record record = simulate(definition, request);
  EXPECT_FALSE(record.completed());
  EXPECT_TRUE(record.failure.empty());
  EXPECT_GE(record.outcome.particle, 0);
  EXPECT_LT(record.outcome.time, 100.0);
  EXPECT_EQ(record.histories[0].time.back(), record.end_time);
}

TEST(Simulate, ReportsItsProgressAndCanBeAbandoned) {
  RunRequest request = column(100);
  request.scene.termination = AtTime{0.5};
  std::int64_t reported = 0;
  const Record record = simulate({}, request, [&](std::int64_t particle_steps) {
    reported += particle_steps;
    return true;
  });
  EXPECT_EQ(reported, record.cost.particle_steps);
  EXPECT_THROW(simulate({}, request, [](std::int64_t) { return false; }), Abandoned);
}

TEST(Simulate, RefusesAProbeItCannotServe) {
  Case definition;
  definition.probes = {probe("top", "temperature", 1.0, 0.01)};
  EXPECT_THROW(simulate(definition, column(10)), std::invalid_argument);
  definition.probes = {probe("top", "stress", 1.0, 0.0)};
  EXPECT_THROW(simulate(definition, column(10)), std::invalid_argument);
}

// ---- probes of bodies and of everything
// --------------------------------------------------------------------------

HistoryProbe probe_of(const std::string& id, const std::string& quantity, ProbeTarget target,
                      const std::string& of = "", const std::string& component = "") {
  return {.id = id, .quantity = quantity, .component = component, .target = target, .of = of, .every = 1e-3};
}

/// A block of 1 m x 0.5 m without weight that flies at a constant velocity through an empty grid.
RunRequest flying_block() {
  RunRequest request;
  Scene& scene = request.scene;
  scene.dimension = 2;
  scene.cell_size = 0.25;
  scene.grid_lower = {-1.0, -1.0};
  scene.grid_upper = {3.0, 3.0};
  Body block;
  block.name = "block";
  block.upper = {1.0, 0.5};
  block.particles_per_cell = {2, 2};
  block.density = 1000.0;
  block.velocity = {2.0, -0.5};
  block.material = LinearElastic{1e7, 0.3};
  Body other = block;
  other.name = "other";
  other.lower = {0.0, 1.5};
  other.upper = {0.5, 2.0};
  other.velocity = {0.0, 0.0};
  scene.bodies = {block, other};
  scene.time_step = GivenTimeStep{1e-4};
  scene.termination = AtTime{0.01};
  return request;
}

TEST(ProbesOfBodies, SeeMeansOverTheBodyAndSumsOverEverything) {
  Case definition;
  definition.probes = {probe_of("u", "displacement", ProbeTarget::body, "block", "x"),
                       probe_of("v", "velocity", ProbeTarget::body, "block"),
                       probe_of("still", "velocity", ProbeTarget::body, "other", "x"),
                       probe_of("p", "momentum", ProbeTarget::everything, "", "x"),
                       probe_of("k", "kinetic_energy", ProbeTarget::everything),
                       probe_of("w", "strain_energy", ProbeTarget::everything)};
  const Record record = simulate(definition, flying_block());
  const auto last = [&](std::size_t i) { return record.histories[i].value.back(); };
  ASSERT_EQ(record.histories[0].time.size(), 11u);
  EXPECT_EQ(record.histories[0].value.front(), 0.0);
  EXPECT_NEAR(last(0), 0.02, 1e-12);
  EXPECT_NEAR(last(1), -0.5, 1e-12);
  EXPECT_NEAR(last(2), 0.0, 1e-12);
  EXPECT_NEAR(last(3), 500.0 * 2.0, 1e-8);
  EXPECT_NEAR(last(4), 0.5 * 500.0 * (4.0 + 0.25), 1e-8);
  EXPECT_NEAR(last(5), 0.0, 1e-8);
}

TEST(ProbesOfBodies, SeeOneComponentOfAParticle) {
  RunRequest request = flying_block();
  request.scene.bodies[0].initial_stress = UniformStress{.xx = 1.0, .yy = 2.0, .zz = 3.0, .xy = 4.0};
  Case definition;
  for (const char* component : {"xx", "yy", "zz", "xy", ""}) {
    definition.probes.push_back(probe_of("s", "stress", ProbeTarget::particle, "", component));
  }
  for (const char* component : {"x", "y", ""}) {
    definition.probes.push_back(probe_of("v", "velocity", ProbeTarget::particle, "", component));
  }
  const Record record = simulate(definition, request);
  const std::vector<double> expected = {1, 2, 3, 4, 2, 2.0, -0.5, -0.5};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(record.histories[i].value.front(), expected[i]) << i;
  }
}

TEST(ProbesOfBodies, SeeTheEnergyOfAUniformStress) {
  RunRequest request = flying_block();
  request.scene.bodies.pop_back();
  request.scene.bodies[0].initial_stress = UniformStress{.xx = 1e3, .yy = -2e3, .zz = 3e3, .xy = 4e3};
  Case definition;
  definition.probes = {probe_of("w", "strain_energy", ProbeTarget::everything)};
  // 1/2 sigma : epsilon with epsilon from Hooke's law, on 0.5 m^2.
  const double modulus = 1e7, nu = 0.3;
  const double exx = (1e3 - nu * (-2e3 + 3e3)) / modulus, eyy = (-2e3 - nu * (1e3 + 3e3)) / modulus,
               ezz = (3e3 - nu * (1e3 - 2e3)) / modulus, exy = 4e3 * (1 + nu) / modulus;
  const double energy = 0.5 * (1e3 * exx - 2e3 * eyy + 3e3 * ezz + 2 * 4e3 * exy) * 0.5;
  EXPECT_NEAR(simulate(definition, request).histories[0].value.front(), energy, 1e-12 * energy);
}

TEST(ProbesOfBodies, SeeTheirWeightUnderTheGravityOfTheMoment) {
  RunRequest request = flying_block();
  request.scene.gravity = {.acceleration = {0.0, -9.8}, .level = 2.0, .loading = RampLoading{0.02}};
  request.scene.bodies[0].density_ramp = DensityRamp{0.0, {{3000.0, 0.005}}};
  Case definition;
  definition.probes = {probe_of("w", "weight", ProbeTarget::body, "block"),
                       probe_of("other", "weight", ProbeTarget::body, "other")};
  const Record record = simulate(definition, request);
  EXPECT_EQ(record.histories[0].value.front(), 0.0);
  EXPECT_NEAR(record.histories[0].value.back(), 1500.0 * 9.8 * 2.0 * 0.5, 1e-8);
  EXPECT_NEAR(record.histories[1].value.back(), 250.0 * 9.8 * 2.0 * 0.5, 1e-8);
}

TEST(ProbesOfBodies, SeeNoMassChangeInADensityRamp) {
  RunRequest request = flying_block();
  for (const double duration : {0.005, 0.02}) {  // over at the end of the run, and not
    request.scene.bodies[0].density_ramp = DensityRamp{0.001, {{3000.0, duration}}};
    EXPECT_NEAR(simulate({}, request).relative_mass_change, 0.0, 1e-13) << duration;
  }
}

/// A block that a rigid plate lifts at 1 m/s once the plate has set out.
RunRequest lifted_block() {
  RunRequest request = flying_block();
  Scene& scene = request.scene;
  scene.bodies.pop_back();
  scene.bodies[0].velocity = {};
  RigidBody plate;
  plate.name = "plate";
  plate.lower = {-0.5, -0.25};
  plate.upper = {1.5, 0.0};
  plate.constrains = {false, true};
  plate.velocity = {0.0, 1.0};
  scene.rigid_bodies = {plate};
  scene.gravity.acceleration = {0.0, -9.8};
  return request;
}

TEST(ProbesOfRigidBodies, SeeTheirDisplacementAndMeanReaction) {
  Case definition;
  definition.probes = {probe_of("u", "displacement", ProbeTarget::rigid_body, "plate"),
                       probe_of("f", "reaction", ProbeTarget::rigid_body, "plate", "y"),
                       probe_of("p", "momentum", ProbeTarget::everything)};
  const RunRequest request = lifted_block();
  const Record record = simulate(definition, request);
  const History &displacement = record.histories[0], &reaction = record.histories[1],
                &momentum = record.histories[2];
  EXPECT_NEAR(displacement.value.back(), 0.01, 1e-12);
  ASSERT_EQ(reaction.value.size(), 11u);
  EXPECT_EQ(reaction.value.front(), 0.0);
  // Newton's second and third law over each interval: what the particles gain the plate has given, less
  // weight.
  for (std::size_t k = 1; k < reaction.value.size(); ++k) {
    const double interval = reaction.time[k] - reaction.time[k - 1];
    const double gained = momentum.value[k] - momentum.value[k - 1];
    const double weight = 500.0 * 9.8;
    EXPECT_NEAR(-reaction.value[k] * interval, gained + weight * interval, 1e-9 * std::abs(gained) + 1e-9);
  }
  EXPECT_LT(reaction.value[1], -1e4) << "the particles press it down";
}

TEST(ProbesOfLoad, SeeAWeightOrAReactionWhicheverTheNameHas) {
  Case definition;
  // In another run of the sweep the names belong to the other kind.
  definition.probes = {probe_of("w", "weight", ProbeTarget::body, "block"),
                       probe_of("f", "reaction", ProbeTarget::rigid_body, "plate", "y"),
                       probe_of("of_block", "load", ProbeTarget::rigid_body, "block"),
                       probe_of("of_plate", "load", ProbeTarget::body, "plate"),
                       probe_of("u", "displacement", ProbeTarget::body, "plate", "y")};
  const Record record = simulate(definition, lifted_block());
  EXPECT_EQ(record.histories[2].value, record.histories[0].value);
  EXPECT_EQ(record.histories[3].value, record.histories[1].value);
  EXPECT_NEAR(record.histories[4].value.back(), 0.01, 1e-12);
}

TEST(ProbesOfRigidBodies, AreNotServedWithoutThem) {
  Case definition;
  definition.probes = {probe_of("u", "displacement", ProbeTarget::rigid_body, "plug")};
  EXPECT_THROW(simulate(definition, lifted_block()), std::invalid_argument);
  definition.probes = {probe_of("u", "stress", ProbeTarget::rigid_body, "plate")};
  EXPECT_THROW(simulate(definition, lifted_block()), std::invalid_argument);
  definition.probes = {probe_of("u", "reaction", ProbeTarget::body, "block")};
  EXPECT_THROW(simulate(definition, lifted_block()), std::invalid_argument);
  definition.probes = {probe_of("u", "stress", ProbeTarget::everything)};
  EXPECT_THROW(simulate(definition, lifted_block()), std::invalid_argument);
  definition.probes = {probe_of("u", "velocity", ProbeTarget::body, "block", "z")};
  EXPECT_THROW(simulate(definition, lifted_block()), std::invalid_argument);
}

TEST(StrainEnergy, OfANeoHookeanBarIsTheWorkOfItsStress) {
  Scene scene = test::column_scene(Scheme::cpgimp, 1);
  scene.bodies[0].material = NeoHookean{1e7, 0.3};
  ParticleFields fields;
  fields.body = {0};
  fields.mass = {1.0};
  fields.initial_volume = {2.0};
  const double mu = 0.5e7;
  double work = 0.0;  // integral of the law's stress over the stretch, by the midpoint rule
  constexpr int steps = 100'000;
  for (int k = 0; k < steps; ++k) {
    const double stretch = 1.0 + 0.5 * (k + 0.5) / steps;
    work += mu * (stretch - 1 / stretch) * (0.5 / steps) * 2.0;
  }
  fields.volume = {2.0};
  EXPECT_EQ(strain_energy(scene, fields), 0.0);
  fields.volume = {3.0};
  EXPECT_NEAR(strain_energy(scene, fields), work, 1e-9 * work);
}

TEST(StrainEnergy, OfANeoHookeanBlockIsTheWorkOfItsStress) {
  Scene scene = flying_block().scene;
  const double modulus = 1e7, nu = 0.3;
  const double mu = modulus / (2 * (1 + nu)), lambda = modulus * nu / ((1 + nu) * (1 - 2 * nu));
  scene.bodies[1].material = NeoHookean{modulus, nu};
  ParticleFields fields;
  fields.dimension = 2;
  fields.body = {1};
  fields.mass = {1.0};
  fields.initial_volume = fields.volume = {2.0};
  // Along the path F = I + s D the first Piola-Kirchhoff stress mu (F - F^-T) + lambda ln J F^-T does the
  // work.
  const std::array<double, 4> d{0.3, 0.2, -0.1, 0.4};
  double work = 0.0;
  constexpr int steps = 100'000;
  for (int k = 0; k < steps; ++k) {
    const double s = (k + 0.5) / steps;
    const std::array<double, 4> f{1 + s * d[0], s * d[1], s * d[2], 1 + s * d[3]};
    const double j = f[0] * f[3] - f[1] * f[2];
    const std::array<double, 4> inverse_transposed{f[3] / j, -f[2] / j, -f[1] / j, f[0] / j};
    for (std::size_t i = 0; i < 4; ++i) {
      const double p = mu * (f[i] - inverse_transposed[i]) + lambda * std::log(j) * inverse_transposed[i];
      work += p * d[i] / steps * 2.0;
    }
  }
  fields.deformation_gradient = {1, 0, 0, 1};
  EXPECT_EQ(strain_energy(scene, fields), 0.0);
  fields.deformation_gradient = {1 + d[0], d[1], d[2], 1 + d[3]};
  EXPECT_NEAR(strain_energy(scene, fields), work, 1e-9 * work);
}

TEST(StrainEnergy, OfSoilIsThatOfItsElasticStrain) {
  Scene scene = flying_block().scene;
  ParticleFields fields;
  fields.dimension = 2;
  fields.body = {1};
  fields.mass = {1.0};
  fields.initial_volume = fields.volume = {2.0};
  fields.stress = {1e3, -2e3, 3e3, 4e3};
  scene.bodies[1].material = LinearElastic{1e7, 0.3};
  const double elastic = strain_energy(scene, fields);
  scene.bodies[1].material = MohrCoulomb{1e7, 0.3, 0.5, 1e3, 0.0};
  EXPECT_GT(elastic, 0.0);
  EXPECT_EQ(strain_energy(scene, fields), elastic);
}

TEST(PotentialEnergy, IsWhatTheWeightHasGainedInFullGravity) {
  Scene scene = flying_block().scene;
  scene.gravity = {.acceleration = {2.0, -10.0}, .level = 3.0, .loading = StepLoading{}};
  ParticleFields fields;
  fields.dimension = 2;
  fields.mass = {1.0, 4.0};
  fields.body = {0, 0};
  fields.displacement = {0.5, 0.0, 0.0, -0.25};
  EXPECT_DOUBLE_EQ(potential_energy(scene, fields), -3.0 * (1.0 * 2.0 * 0.5 + 4.0 * 10.0 * 0.25));
  scene.bodies[0].inertia = 2 * scene.bodies[0].density;  // half of the mass has weight
  EXPECT_DOUBLE_EQ(potential_energy(scene, fields), -1.5 * (1.0 * 2.0 * 0.5 + 4.0 * 10.0 * 0.25));
}

TEST(StressWork, IsSummedOverTheParticlesThatKeepIt) {
  ParticleFields fields;
  EXPECT_THROW(stress_work(fields), std::invalid_argument);
  fields.stress_work = {1.0, 2.5};
  EXPECT_EQ(stress_work(fields), 3.5);
}

TEST(StrainEnergy, OfAnElasticBarAndOfTheColumnsLawIsTheWorkOfTheirStress) {
  Scene scene = test::column_scene(Scheme::cpgimp, 1);
  ParticleFields fields;
  fields.body = {0};
  fields.mass = {1.0};
  fields.stress = {2e4};
  fields.volume = fields.initial_volume = {3.0};
  EXPECT_DOUBLE_EQ(strain_energy(scene, fields), 0.5 * 2e4 * 2e4 / 1e7 * 3.0);
  scene.bodies[0].material = ZhangElastic{1e7};
  fields.volume = {1.2};
  fields.initial_volume = {1.5};
  double work = 0.0;
  constexpr int parts = 1000;
  for (int k = 0; k < parts; ++k) {
    const double stretch = 1.0 - 0.2 * (k + 0.5) / parts;
    work -= 2e7 * (1 - 1 / std::sqrt(stretch)) * 0.2 / parts * 1.5;
  }
  EXPECT_NEAR(strain_energy(scene, fields), work, 1e-5 * work);
}

TEST(Observation, CopiesTheParticlesOnlyOnceAndWhenAsked) {
  Simulation simulation(flying_block().scene);
  const Observation now(simulation);
  const ParticleFields& first = now.particles();
  EXPECT_EQ(&first, &now.particles());
  const Observation later(simulation);
  simulation.advance();
  EXPECT_NE(later.particles().position, first.position) << "what nobody has asked for has not been copied";
  EXPECT_EQ(now.particles().position, first.position);
}

// ---- snapshots
// ---------------------------------------------------------------------------------------------------

using When = SnapshotRequest::When;

TEST(Snapshots, AreTakenWhenTheirMomentsCome) {
  Case definition;
  definition.probes = {probe("top", "displacement", 1.0, 0.001)};
  definition.snapshots = {{When::end, 0.0, "", 0.0},          {When::time, 0.02, "", 0.0},
                          {When::time, 0.00025, "", 0.0},     {When::time, 0.0, "", 0.0},
                          {When::passing, 0.0, "top", -1e-5}, {When::passing, 0.0, "top", 1.0}};
  const Record record = simulate(definition, column(10));
  ASSERT_EQ(record.snapshots.size(), 5u) << "the top never rises by a metre";
  EXPECT_EQ(record.snapshots[0].moment, "t = 0 s");
  EXPECT_EQ(record.snapshots[0].time, 0.0);
  EXPECT_EQ(record.snapshots[1].moment, "t = 0.00025 s");
  EXPECT_NEAR(record.snapshots[1].time, 0.0003, 1e-12) << "the first step that ends at or after it";
  EXPECT_EQ(record.snapshots[2].moment, "top = -0.01 mm");
  EXPECT_EQ(record.snapshots[3].moment, "t = 0.02 s");
  EXPECT_NEAR(record.snapshots[3].time, 0.02, 1e-12);
  EXPECT_EQ(record.snapshots[4].moment, "end");
  EXPECT_EQ(record.snapshots[4].time, record.end_time);

  const History& top = record.histories[0];
  const auto passed = std::find_if(top.value.begin(), top.value.end(), [](double u) { return u <= -1e-5; });
  EXPECT_EQ(record.snapshots[2].time, top.time[static_cast<std::size_t>(passed - top.value.begin())]);
  const ParticleFields& fields = record.snapshots[4].fields;
  EXPECT_EQ(fields.mass.size(), 10u);
  for (std::size_t p = 0; p < 10; ++p) {
    EXPECT_NEAR(fields.displacement[p], record.profile.displacement[p],
                5e-9 * std::abs(record.profile.displacement[p]));
  }
}

TEST(Snapshots, JudgeTheSameBeforeAndAfterTheyAreStored) {
  Case definition;
  definition.snapshots = {{When::end, 0.0, "", 0.0}};
  const Record record = simulate(definition, column(10));
  const Record read = record_from_json(Json::parse(to_json(record).dump()));
  EXPECT_EQ(bits_of(read.snapshots[0].fields.stress), bits_of(record.snapshots[0].fields.stress));
  EXPECT_EQ(read.snapshots[0].fields.body, record.snapshots[0].fields.body);
}

TEST(Snapshots, AtTheTimeTheRunEndsAreTaken) {
  Case definition;
  RunRequest request = column(10);
  request.scene.time_step = GivenTimeStep{3e-4};  // 167 steps end at 0.0501 s, the nearest to 0.05 s
  definition.snapshots = {{When::time, 0.05, "", 0.0}};
  EXPECT_EQ(simulate(definition, request).snapshots.size(), 1u);
  request.scene.time_step = GivenTimeStep{1.6e-4};  // 312 steps end at 0.04992 s
  EXPECT_EQ(simulate(definition, request).snapshots.size(), 1u);
}

TEST(Snapshots, DoNotChangeTheRun) {
  Case bare, watched;
  watched.snapshots = {{When::time, 0.0123, "", 0.0}, {When::end, 0.0, "", 0.0}};
  EXPECT_EQ(simulate(bare, column(10)).digest, simulate(watched, column(10)).digest);
}

TEST(Snapshots, KeepStrainWhereTheSceneSumsIt) {
  Case definition;
  definition.snapshots = {{When::end, 0.0, "", 0.0}};
  RunRequest request = column(10);
  EXPECT_TRUE(simulate(definition, request).snapshots[0].fields.strain.empty());
  request.scene.sums_strain = true;
  EXPECT_EQ(simulate(definition, request).snapshots[0].fields.strain.size(), 10u);
}

TEST(Snapshots, OfAProbeThereIsNotAreRefused) {
  Case definition;
  definition.snapshots = {{When::passing, 0.0, "top", 0.0}};
  EXPECT_THROW(simulate(definition, column(10)), std::invalid_argument);
}

// ---- hashes and files
// --------------------------------------------------------------------------------------------

TEST(InputHash, ChangesWithSceneProbesAndSnapshotsOnly) {
  const RunRequest request = column(10);
  const auto hash_with = [&](const std::vector<HistoryProbe>& probes,
                             const std::vector<SnapshotRequest>& snapshots = {}) {
    Case definition;
    definition.probes = probes;
    definition.snapshots = snapshots;
    return input_hash(definition, request);
  };
  const HistoryProbe top = probe("top", "stress", 1.0, 0.01);
  Case watched;
  watched.probes = {top};
  const std::string hash = hash_with({top});
  EXPECT_EQ(hash.size(), 16u);
  EXPECT_EQ(hash, input_hash(watched, column(10)));
  std::set<std::string> different{hash, input_hash(watched, column(11)), hash_with({})};
  for (const HistoryProbe& other : {probe("up", "stress", 1.0, 0.01), probe("top", "velocity", 1.0, 0.01),
                                    probe("top", "stress", 0.9, 0.01), probe("top", "stress", 1.0, 0.02)}) {
    different.insert(hash_with({other}));
  }
  EXPECT_EQ(different.size(), 7u);
  for (const SnapshotRequest& snapshot :
       {SnapshotRequest{When::end, 0.0, "", 0.0}, SnapshotRequest{When::time, 0.0, "", 0.0},
        SnapshotRequest{When::time, 0.1, "", 0.0}, SnapshotRequest{When::passing, 0.0, "top", 0.0},
        SnapshotRequest{When::passing, 0.0, "base", 0.0}, SnapshotRequest{When::passing, 0.0, "top", 0.1}}) {
    different.insert(hash_with({top}, {snapshot}));
  }
  EXPECT_EQ(different.size(), 13u);
  HistoryProbe other = top;
  other.component = "yy";
  different.insert(hash_with({other}));
  for (const ProbeTarget target : {ProbeTarget::rigid_body, ProbeTarget::body}) {
    for (const char* name : {"footing", "ground"}) {
      other = top;
      other.target = target;
      other.of = name;
      different.insert(hash_with({other}));
    }
  }
  EXPECT_EQ(different.size(), 18u);
}

TEST(InputHash, DoesNotTellAComponentSpeltOutFromTheSameByDefault) {
  Case definition;
  definition.probes = {probe("top", "stress", 1.0, 0.01)};
  const std::string hash = input_hash(definition, column(10));
  definition.probes[0].component = "xx";
  EXPECT_EQ(input_hash(definition, column(10)), hash);
}

TEST(Hash, IsFnv1a) {
  EXPECT_EQ(hash_of(""), "cbf29ce484222325");
  EXPECT_EQ(hash_of("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(hash_of("foobar"), "85944171f73967e8");
}

TEST(WriteAtomically, ReplacesTheFileAndLeavesNothingElse) {
  const tests::ScratchDirectory scratch;
  const auto file = scratch.path() / "results.json";
  write_atomically(file, "a first text, longer than the second");
  write_atomically(file, "second");
  std::ifstream stream(file);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), "second");
  const auto entries = std::filesystem::directory_iterator(scratch.path());
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);
}

TEST(WriteAtomically, CleansUpAndThrowsWhenItCannotWrite) {
  const tests::ScratchDirectory scratch;
  EXPECT_THROW(write_atomically(scratch.path() / "absent" / "file", "text"), std::system_error);
  const auto directory = scratch.path() / "taken";
  std::filesystem::create_directories(directory / "inside");
  EXPECT_THROW(write_atomically(directory, "text"), std::system_error);  // a directory cannot be replaced
  const auto entries = std::filesystem::directory_iterator(scratch.path());
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);
}

}  // namespace
}  // namespace mpm::vv
