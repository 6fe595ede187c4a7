#include "vv/measurement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "vv/verdict.hpp"

namespace mpm::vv {
namespace {

using Values = std::vector<double>;

Values sampled(const Values& x, double (*function)(double)) {
  Values y;
  for (const double at : x) y.push_back(function(at));
  return y;
}

Values equidistant(double end, int count) {
  Values x;
  for (int k = 0; k <= count; ++k) x.push_back(end * k / count);
  return x;
}

Values scaled(Values values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

// ---- distances, whose answers are known

TEST(VerificationOfCurveDistance, OfACurveScaledIsAllMagnitude) {
  const Values x = equidistant(3.0, 40),
               d = sampled(x, [](double t) { return std::exp(-t) * std::cos(7 * t); });
  for (const double factor : {1.05, 0.8}) {
    const CurveDistance found = curve_distance(x, d, scaled(d, factor));
    EXPECT_NEAR(found.magnitude, factor - 1, 1e-14);
    EXPECT_NEAR(found.phase, 0.0, 2e-8);  // the arc cosine of one less round-off
    EXPECT_NEAR(found.comprehensive, std::abs(factor - 1), 2e-8);
    EXPECT_NEAR(found.l2, std::abs(factor - 1), 1e-14);
  }
}

TEST(VerificationOfCurveDistance, OfASineShiftedOverWholePeriodsIsAllPhase) {
  const Values x = equidistant(4 * std::numbers::pi, 800);
  const Values d = sampled(x, [](double t) { return std::sin(t); });
  for (const double shift : {0.1, 0.7, 2.0}) {
    Values s;
    for (const double t : x) s.push_back(std::sin(t - shift));
    const CurveDistance found = curve_distance(x, d, s);
    EXPECT_NEAR(found.magnitude, 0.0, 1e-12);
    EXPECT_NEAR(found.phase, shift / std::numbers::pi, 1e-12);
    EXPECT_NEAR(found.comprehensive, found.phase, 1e-12);
    EXPECT_NEAR(found.l2, 2 * std::sin(shift / 2), 1e-12);
  }
}

TEST(VerificationOfCurveDistance, OfTheNegativeIsHalfATurn) {
  const Values x = equidistant(1.0, 10), d = sampled(x, [](double t) { return 1 + t; });
  EXPECT_NEAR(curve_distance(x, d, scaled(d, -1)).phase, 1.0, 1e-7);
}

TEST(CurveDistance, DoesNotCountPointsButLengths) {
  // A constant error on the second half of the abscissa only, whose points lie four times as dense.
  Values x, d, s;
  for (int k = 0; k <= 50; ++k) x.push_back(k <= 10 ? 0.1 * k : 1 + 0.025 * (k - 10));
  for (const double at : x) {
    d.push_back(1.0);
    s.push_back(at > 1.0 + 1e-12 ? 1.5 : 1.0);
  }
  // int (s - d)^2 = 0.25 but for the trapezoid in which it sets in; int d^2 = 2.
  EXPECT_NEAR(curve_distance(x, d, s).l2, std::sqrt(0.25 * (1 - 0.025 / 2) / 2), 1e-12);
}

// ---- comparison

CurveFile line_file(StatedUncertainty along = {}, StatedUncertainty up = {},
                    StatedUncertainty experiment = {}) {
  CurveFile file;
  file.id = "line";
  file.columns = {{"x", "m", "length", "x", along, {}}, {"y", "Pa", "pressure", "y", up, experiment}};
  file.abscissa = 0;
  for (int k = 0; k <= 10; ++k) file.rows.push_back({0.1 * k, 2.0 * 0.1 * k});
  return file;
}

Curve run_curve(double offset, double slope = 2.0, double end = 1.0) {
  Curve curve;
  curve.name = "pressure";
  curve.source = "run";
  for (int k = 0; k <= 40; ++k) {
    curve.x.push_back(end * k / 40);
    curve.y.push_back(slope * curve.x.back() + offset);
  }
  return curve;
}

constexpr StatedUncertainty absolute(double value) {
  return {.kind = StatedUncertainty::Kind::absolute, .value = value};
}

TEST(Comparison, IsMadeAtTheMeasuredAbscissae) {
  const Curve run = run_curve(0.1);
  const CurveComparison found =
      compare(line_file({}, absolute(0.06)), 1, {.simulated = &run, .within = 0.0}, 0.1);
  ASSERT_EQ(found.abscissa.size(), 11u);
  for (std::size_t k = 0; k < 11; ++k) EXPECT_NEAR(found.simulated[k] - found.measured[k], 0.1, 1e-14);
  EXPECT_NEAR(found.bias, 0.05, 1e-14);  // of the largest measured value, 2
  EXPECT_NEAR(found.largest_error, 0.05, 1e-14);
  EXPECT_EQ(found.inside, 1.0);
  EXPECT_NEAR(found.level, 0.06, 1e-14);
  EXPECT_EQ(found.overlap, 1.0);
  EXPECT_EQ(found.agreement, Agreement::validated);
}

TEST(Comparison, VerdictRestsOnTheUncertainty) {
  const Curve run = run_curve(0.1);
  const ComparedCurves curves{.simulated = &run};
  // The difference of 0.1 is beyond 2 * 0.04, within 2 * 0.06, and 2 * 0.06 / 2 is more than 0.05.
  EXPECT_EQ(compare(line_file({}, absolute(0.04)), 1, curves, 0.1).agreement, Agreement::model_error);
  EXPECT_NEAR(compare(line_file({}, absolute(0.04)), 1, curves, 0.1).excess, 0.01, 1e-14);
  EXPECT_EQ(compare(line_file({}, absolute(0.06)), 1, curves, 0.1).agreement, Agreement::validated);
  EXPECT_EQ(compare(line_file({}, absolute(0.06)), 1, curves, 0.05).agreement, Agreement::inconclusive);
  // A wide uncertainty does not excuse what lies beyond it.
  EXPECT_EQ(compare(line_file({}, absolute(0.04)), 1, curves, 0.001).agreement, Agreement::model_error);
}

TEST(Comparison, OneOutlierInTwentyIsNormal) {
  CurveFile file = line_file({}, absolute(0.06));
  file.rows.clear();
  for (int k = 0; k <= 19; ++k) file.rows.push_back({k / 19.0, 2.0 * k / 19.0 + (k == 7 ? 1.0 : 0.0)});
  const Curve run = run_curve(0.0);
  EXPECT_EQ(compare(file, 1, {.simulated = &run}, 0.5).agreement, Agreement::validated);
  file.rows[8][1] += 1.0;
  EXPECT_EQ(compare(file, 1, {.simulated = &run}, 0.5).agreement, Agreement::model_error);
}

TEST(Comparison, UncertaintiesOfTheMeasurementAddInSquares) {
  const Curve run = run_curve(0.0);
  const CurveFile file = line_file(absolute(0.02), absolute(0.03), {StatedUncertainty::Kind::relative, 0.05});
  const CurveComparison found = compare(file, 1, {.simulated = &run}, 1.0);
  // The abscissa counts with the slope of 2.
  for (std::size_t k = 0; k < 11; ++k)
    EXPECT_NEAR(found.u_measured[k], std::hypot(0.04, 0.03, 0.05 * 0.2 * static_cast<double>(k)), 1e-14);
}

TEST(Comparison, DiscretisationIsThatOfTheFinestAndTheWayToIt) {
  const Curve coarse = run_curve(0.4), middle = run_curve(0.2), fine = run_curve(0.1);
  ComparedCurves curves{
      .simulated = &fine, .refined = {&coarse, &middle, &fine}, .cell_size = {4.0, 2.0, 1.0}};
  // First order with a limit at 0: the grid convergence index of the finest is 1.25 * 0.1 everywhere.
  CurveComparison found = compare(line_file(), 1, curves, 1.0);
  for (const double u : found.u_numerical) EXPECT_NEAR(u, 0.125 / 2, 1e-12);
  curves.simulated = &middle;
  found = compare(line_file(), 1, curves, 1.0);
  for (const double u : found.u_numerical) EXPECT_NEAR(u, (0.1 + 0.125) / 2, 1e-12);
  // Two levels: 3 |f1 - f2| / (r - 1).
  found = compare(line_file(), 1, {.simulated = &fine, .refined = {&middle, &fine}, .cell_size = {2.0, 1.0}},
                  1.0);
  for (const double u : found.u_numerical) EXPECT_NEAR(u, 0.3 / 2, 1e-12);
}

TEST(Comparison, ReadingOffParticlesCountsAsNumerical) {
  Curve run = run_curve(0.0);
  run.uncertainty.assign(run.x.size(), 0.03);
  const Curve other = run_curve(0.04 * 2 / 3);
  const CurveComparison found =
      compare(line_file(), 1, {.simulated = &run, .refined = {&other, &run}, .cell_size = {2.0, 1.0}}, 1.0);
  for (const double u : found.u_numerical) EXPECT_NEAR(u, std::hypot(0.04, 0.03), 1e-12);
}

TEST(Comparison, InputsAreRectangular) {
  const Curve run = run_curve(0.0), low = run_curve(-0.1), high = run_curve(0.3);
  const CurveComparison found =
      compare(line_file(), 1, {.simulated = &run, .inputs = {{&low, &run, &high}, {&run, &high}}}, 1.0);
  for (const double u : found.u_input) EXPECT_NEAR(u, std::hypot(0.2, 0.15) / std::sqrt(3.0), 1e-12);
  for (const double u : found.u_validation) EXPECT_NEAR(u, std::hypot(0.2, 0.15) / std::sqrt(3.0), 1e-12);
}

TEST(Comparison, NeedsTheWholeCurve) {
  const Curve almost = run_curve(0.0, 2.0, 0.96), half = run_curve(0.0, 2.0, 0.5);
  const CurveComparison rejected = compare(line_file(), 1, {.simulated = &half}, 1.0);
  EXPECT_EQ(rejected.agreement, Agreement::not_compared);
  EXPECT_EQ(rejected.lack, "the run's curve covers 50 % of the measured one, 95 % are needed");
  CurveFile dense = line_file();
  dense.rows.clear();
  for (int k = 0; k <= 100; ++k) dense.rows.push_back({0.01 * k, 0.02 * k});
  const CurveComparison accepted = compare(dense, 1, {.simulated = &almost}, 1.0);
  EXPECT_EQ(accepted.lack, "");
  EXPECT_NEAR(accepted.overlap, 0.96, 1e-9);
  EXPECT_EQ(compare(line_file(), 1, {}, 1.0).lack, "the run has no such curve");
}

TEST(Comparison, NeedsTheWholeOfItsRefinementAndInputs) {
  const Curve run = run_curve(0.0), half = run_curve(0.0, 2.0, 0.5);
  EXPECT_EQ(
      compare(line_file(), 1, {.simulated = &run, .refined = {&half, &run}, .cell_size = {2, 1}}, 1.0).lack,
      "run 1 of the refinement has no curve there, or one that does not reach as far");
  EXPECT_EQ(compare(line_file(), 1, {.simulated = &run, .inputs = {{&run, nullptr}}}, 1.0).lack,
            "run 2 of an uncertain input has no curve there, or one that does not reach as far");
}

TEST(Comparison, WithASlotWaits) {
  CurveFile slot = line_file();
  slot.missing = true;
  slot.rows.clear();
  const Curve run = run_curve(0.0);
  const CurveComparison found = compare(slot, 1, {.simulated = &run}, 1.0);
  EXPECT_EQ(found.agreement, Agreement::no_measurement);
  EXPECT_EQ(found.lack, "no measurement: line.json is an empty slot");
}

// ---- many pairs

TEST(VerificationOfModelFactor, OfKnownLogarithms) {
  std::vector<Pair> pairs;
  for (const double ratio : {0.5, 1.0, 2.0, 4.0}) pairs.push_back({"p", 3.0, 3.0 * ratio});
  const ModelFactor found = model_factor(pairs, 0.0);
  const double ln2 = std::numbers::ln2;
  EXPECT_NEAR(found.bias, std::sqrt(2.0), 1e-14);
  EXPECT_NEAR(found.scatter, ln2 * std::sqrt((2.25 + 0.25) * 2 / 3), 1e-14);
  // t of 3 degrees of freedom is 3.182.
  const double reach = 3.1824463 * found.scatter / 2;
  EXPECT_NEAR(std::log(found.bias_high / found.bias), reach, 2e-3 * reach);
  EXPECT_NEAR(found.bias_low * found.bias_high, found.bias * found.bias, 1e-12);
  EXPECT_DOUBLE_EQ(found.least, 0.5);
  EXPECT_DOUBLE_EQ(found.greatest, 4.0);
  EXPECT_DOUBLE_EQ(found.model_scatter, found.scatter);
}

TEST(VerificationOfModelFactor, IntervalsAreStudents) {
  // Alternating +1 and -1 make a scatter of sqrt(n / (n - 1)).
  const std::pair<int, double> quantiles[] = {{6, 2.570582}, {10, 2.262157}, {30, 2.045230}, {200, 1.971957}};
  for (const auto& [count, t] : quantiles) {
    std::vector<Pair> pairs;
    for (int k = 0; k < count; ++k) pairs.push_back({"p", 1.0, std::exp(k % 2 ? 1.0 : -1.0)});
    const double reach = t / std::sqrt(count - 1.0);
    EXPECT_NEAR(std::log(model_factor(pairs, 0.0).bias_high), reach, 2e-4 * reach) << count;
  }
}

TEST(ModelFactor, TakesTheMeasurementsOwnScatterOut) {
  const std::vector<Pair> pairs = {{"a", 1.0, std::exp(0.3)}, {"b", 1.0, 1.0}, {"c", 1.0, std::exp(-0.3)}};
  EXPECT_NEAR(model_factor(pairs, 0.0).scatter, 0.3, 1e-14);
  EXPECT_NEAR(model_factor(pairs, 0.18).model_scatter, 0.24, 1e-14);
  EXPECT_EQ(model_factor(pairs, 0.4).model_scatter, 0.0);
}

TEST(ModelFactor, NeedsThreePositivePairs) {
  EXPECT_THROW(model_factor({{"a", 1, 1}, {"b", 1, 1}}, 0.0), std::invalid_argument);
  EXPECT_THROW(model_factor({{"a", 1, 1}, {"b", 1, 1}, {"c", 0, 1}}, 0.0), std::invalid_argument);
  EXPECT_THROW(model_factor({{"a", 1, 1}, {"b", 1, -1}, {"c", 1, 1}}, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace mpm::vv
