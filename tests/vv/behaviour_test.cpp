#include "vv/behaviour.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace mpm::vv {
namespace {

using Values = std::vector<double>;

constexpr int samples = 200;

Values times() {
  Values t;
  for (int k = 0; k < samples; ++k) t.push_back(0.01 * k);
  return t;
}

SignalShape shape_of(const std::function<double(double)>& signal, double from = 0.0, double scale = 1.0) {
  Values v;
  for (const double t : times()) v.push_back(signal(t));
  return shape_of_signal(times(), v, from, scale);
}

TEST(SignalShape, OfAConstantIsNothing) {
  const SignalShape shape = shape_of([](double) { return 7.0; });
  EXPECT_NEAR(shape.drift, 0.0, 1e-14);
  EXPECT_NEAR(shape.ringing, 0.0, 1e-14);
  EXPECT_EQ(shape.spike, 0.0);
}

TEST(SignalShape, OfASlowDriftIsItsChangeAndNoRinging) {
  const SignalShape shape = shape_of([](double t) { return 3.0 - 0.02 * t; }, 0.0, 2.0);
  EXPECT_NEAR(shape.drift, 0.02 * 1.99 / 2.0, 1e-12);
  EXPECT_LT(shape.ringing, 1e-4);  // what is cut off at the ends
  EXPECT_NEAR(shape.spike, 0.0, 1e-4);
}

TEST(SignalShape, OfASineIsItsEffectiveValueAndHardlyADrift) {
  const double amplitude = 0.04;
  const SignalShape shape = shape_of([&](double t) { return 1 + amplitude * std::sin(20 * std::numbers::pi * t); });
  EXPECT_NEAR(shape.ringing, amplitude / std::sqrt(2.0), 0.05 * amplitude);
  EXPECT_LT(shape.drift, 0.15 * amplitude);
}

TEST(SignalShape, SeesARingingFromSampleToSample) {
  int sign = 1;
  const SignalShape shape = shape_of([&](double) { return 1 + 0.03 * (sign = -sign); });
  EXPECT_NEAR(shape.ringing, 0.03, 1e-5);
  EXPECT_EQ(shape.spike, 0.0);
}

TEST(SignalShape, SeesARingingOnADrift) {
  const SignalShape shape = shape_of([](double t) { return 0.5 * t + 0.02 * std::cos(200 * std::numbers::pi * t / 3); });
  EXPECT_NEAR(shape.drift, 0.5 * 1.99, 0.01);
  EXPECT_NEAR(shape.ringing, 0.02 / std::sqrt(2.0), 0.1 * 0.02);
}

TEST(SignalShape, OfASingleSpikeIsASpikeNeitherRingingNorDrift) {
  for (const int at : {0, 1, 60, samples - 2, samples - 1}) {
    int k = 0;
    const SignalShape shape = shape_of([&](double) { return k++ == at ? 6.0 : 1.0; });
    EXPECT_DOUBLE_EQ(shape.spike, 5.0) << at;
    EXPECT_NEAR(shape.ringing, 0.0, 1e-14) << at;
    EXPECT_NEAR(shape.drift, 0.0, 1e-14) << at;
  }
}

TEST(SignalShape, LooksFromTheGivenTimeOn) {
  const auto settles = [](double t) { return t < 1.0 ? std::sin(50 * t) : 1.0; };
  EXPECT_GT(shape_of(settles).ringing, 0.1);
  EXPECT_NEAR(shape_of(settles, 1.0).ringing, 0.0, 1e-14);
  EXPECT_NEAR(shape_of(settles, 1.0).drift, 0.0, 1e-14);
}

TEST(SignalShape, IsNoNumberWhereTheSignalIsNone) {
  const SignalShape shape =
      shape_of([](double t) { return t > 1.0 ? std::numeric_limits<double>::quiet_NaN() : 1.0; });
  EXPECT_TRUE(std::isnan(shape.ringing) && std::isnan(shape.drift));
  EXPECT_EQ(class_of({.signal = shape}, {}), StabilityClass::oscillating);
}

TEST(SignalShape, RefusesWhatItCannotTell) {
  EXPECT_THROW(shape_of_signal({0, 1}, {0}, 0, 1), std::invalid_argument);
  EXPECT_THROW(shape_of_signal(times(), times(), 0, 0), std::invalid_argument);
  EXPECT_THROW(shape_of_signal(times(), times(), 1.95, 1), std::invalid_argument);
}

/// A stress that grows with depth and alternates about that line by `amplitude` times the step between neighbours: below a
/// half it stays monotone.
Values sawtooth(double amplitude, int particles) {
  Values field;
  for (int p = 0; p < particles; ++p) field.push_back(p + 0.5 + (p % 2 == 0 ? amplitude : -amplitude));
  return field;
}

Values places(int particles) {
  Values place;
  for (int p = 0; p < particles; ++p) place.push_back(0.1 * (p + 0.5));
  return place;
}

TEST(Zigzag, IsSeenOnAFieldThatStaysMonotone) {
  constexpr int particles = 40;
  const Values field = sawtooth(0.4, particles), one(particles, 1.0);
  EXPECT_TRUE(std::is_sorted(field.begin(), field.end()));
  const double rms = std::sqrt(particles * particles / 3.0);
  // Of five neighbours the line takes up a fifth of the alternation.
  EXPECT_NEAR(zigzag_of_field(places(particles), field, one, 0.25), 0.4 * 0.8 / rms, 0.1 * 0.4 / rms);
  EXPECT_NEAR(zigzag_of_field(places(particles), sawtooth(0.0, particles), one, 0.25), 0.0, 1e-13);
}

TEST(Zigzag, DoesNotDependOnTheOrderOfTheParticles) {
  Values place = places(20), field = sawtooth(0.4, 20), weight(20, 1.0);
  weight[3] = 2.0;
  const double sorted = zigzag_of_field(place, field, weight, 0.25);
  for (Values* values : {&place, &field, &weight}) std::reverse(values->begin(), values->end());
  EXPECT_NEAR(zigzag_of_field(place, field, weight, 0.25), sorted, 1e-14);
}

TEST(Zigzag, OfNothingIsNothing) {
  EXPECT_EQ(zigzag_of_field(places(20), Values(20, 0.0), Values(20, 1.0), 0.25), 0.0);
  EXPECT_EQ(zigzag_of_field({0, 1, 2}, {0, 1, 0}, {1, 1, 1}, 1.5), 0.0);
}

TEST(StabilityClass, IsTheWorstThatFits) {
  const BehaviourLimits limits{.drift = 0.1, .ringing = 0.01, .zigzag = 0.05, .error = 0.02};
  const auto signal = [](double drift, double ringing) { return SignalShape{.drift = drift, .ringing = ringing}; };
  EXPECT_EQ(class_of({}, limits), StabilityClass::accurate);
  EXPECT_EQ(class_of({.error = 0.02}, limits), StabilityClass::accurate);
  EXPECT_EQ(class_of({.error = 0.021}, limits), StabilityClass::inaccurate);
  EXPECT_EQ(class_of({.signal = signal(0.11, 0), .error = 1}, limits), StabilityClass::drifting);
  EXPECT_EQ(class_of({.signal = signal(0, 0.011)}, limits), StabilityClass::oscillating);
  EXPECT_EQ(class_of({.zigzag = 0.06}, limits), StabilityClass::oscillating);
  EXPECT_EQ(class_of({.signal = signal(0.4, 0.02)}, limits), StabilityClass::drifting) << "four times, and twice";
  EXPECT_EQ(class_of({.signal = signal(0.2, 0.03)}, limits), StabilityClass::oscillating) << "twice, and three times";
  EXPECT_EQ(class_of({.signal = {.spike = 9.0}}, limits), StabilityClass::accurate);
  EXPECT_EQ(class_of({.failed = true, .error = 1}, limits), StabilityClass::diverged);
  EXPECT_EQ(class_of({.refused = true, .failed = true}, limits), StabilityClass::refused);
  EXPECT_EQ(class_of({.error = std::numeric_limits<double>::quiet_NaN()}, limits), StabilityClass::inaccurate);
}

}  // namespace
}  // namespace mpm::vv
