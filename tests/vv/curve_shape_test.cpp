// Curves whose knees and slopes are known, with and without noise.

#include "vv/curve_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace mpm::vv {
namespace {

using Values = std::vector<double>;

/// What a chain of straight lines through these points is at x.
double chain(const Values& x, const Values& y, double at) {
  std::size_t k = 1;
  while (k + 1 < x.size() && at > x[k]) ++k;
  return y[k - 1] + (y[k] - y[k - 1]) * (at - x[k - 1]) / (x[k] - x[k - 1]);
}

Values evenly(double from, double to, int points) {
  Values values;
  for (int i = 0; i < points; ++i) values.push_back(from + (to - from) * i / (points - 1));
  return values;
}

template <class Function>
Values each(const Values& x, const Function& function) {
  Values y;
  for (const double value : x) y.push_back(function(value));
  return y;
}

// ---- the fit

TEST(PolylineFit, OfOnePieceIsTheRegressionLine) {
  const Polyline line = fit_polyline({0, 1, 2, 3}, {1, 2, 2, 5}, 1);
  EXPECT_EQ(line.pieces(), 1);
  EXPECT_NEAR(line.slope(0), 1.2, 1e-12);  // sum of (x - 1.5)(y - 2.5) over sum of (x - 1.5)^2
  EXPECT_NEAR(line.y[0], 0.7, 1e-12);
  EXPECT_NEAR(line.rms_residual, std::sqrt((0.09 + 0.01 + 1.21 + 0.49) / 4), 1e-12);
}

TEST(PolylineFit, FindsExactKnotsWhereverTheyAre) {
  // From 7 to 12, and far from unit scale.
  const Values x = evenly(7, 12, 200);
  for (const double knot : {7.31, 8.0, 9.876, 11.7}) {
    const Values ends{7, knot, 12}, values{3e5, 9e5, 8e5};
    const Polyline two = fit_polyline(x, each(x, [&](double s) { return chain(ends, values, s); }), 2);
    EXPECT_NEAR(two.x[1], knot, 1e-4) << knot;
    EXPECT_NEAR(two.y[1], 9e5, 50) << knot;
    EXPECT_NEAR(two.y[0], 3e5, 50) << knot;
    EXPECT_LT(two.rms_residual, 50) << knot;
    EXPECT_NEAR(two.slope(1), -1e5 / (12 - knot), 100) << knot;
  }
  const Values ends{7, 7.77, 9.2, 11.11, 12}, values{0, 5, 6, 1, 4};
  const Values y = each(x, [&](double s) { return chain(ends, values, s); });
  const Polyline four = fit_polyline(x, y, 4);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(four.x[k], ends[k], 1e-3) << k;
    EXPECT_NEAR(four.y[k], values[k], 1e-2) << k;
  }
  double last = INFINITY;
  for (int pieces = 1; pieces <= 4; ++pieces) {
    const double rms = fit_polyline(x, y, pieces).rms_residual;
    EXPECT_LT(rms, last) << pieces;
    last = rms;
  }
}

TEST(PolylineFit, LeavesTheLeastThatAFinerSearchFinds) {
  const Values x = evenly(0, 1, 200),
               y = each(x, [](double s) { return std::sqrt(s) + 0.02 * std::sin(40 * s); });
  const double found = fit_polyline(x, y, 2).rms_residual;
  double least = INFINITY;
  for (int k = 25; k <= 975; ++k) {
    // The knot is an end that a weight of zero joins: the best values at three given ends, by a small search.
    const double knot = k / 1000.0;
    double a[3][4] = {};
    for (std::size_t i = 0; i < x.size(); ++i) {
      const bool first = x[i] <= knot;
      const double share = first ? x[i] / knot : (x[i] - knot) / (1 - knot);
      const double h[4] = {first ? 1 - share : 0, first ? share : 1 - share, first ? 0 : share, y[i]};
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) a[row][column] += h[row] * h[column];
    }
    for (int pivot = 0; pivot < 3; ++pivot) {
      for (int row = 0; row < 3; ++row) {
        if (row == pivot) continue;
        const double factor = a[row][pivot] / a[pivot][pivot];
        for (int column = 0; column < 4; ++column) a[row][column] -= factor * a[pivot][column];
      }
    }
    const Values values{a[0][3] / a[0][0], a[1][3] / a[1][1], a[2][3] / a[2][2]};
    double squares = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
      squares += std::pow(y[i] - chain({0, knot, 1}, values, x[i]), 2);
    least = std::min(least, std::sqrt(squares / static_cast<double>(x.size())));
  }
  EXPECT_LE(found, least * (1 + 1e-6));
  EXPECT_GE(found, least * (1 - 1e-3));
}

TEST(PolylineFit, HasNoShorterPieceThanItSays) {
  const Values x = evenly(0, 1, 200), y = each(x, [](double s) { return s < 0.01 ? 100 * s : 1.0; });
  EXPECT_NEAR(fit_polyline(x, y, 2).x[1], shortest_piece, 1e-6);
  const Values late = each(x, [](double s) { return s > 0.99 ? 100 * (s - 0.99) : 0.0; });
  EXPECT_NEAR(fit_polyline(x, late, 2).x[1], 1 - shortest_piece, 1e-6);
}

TEST(PolylineFit, RefusesWhatIsNoCurve) {
  EXPECT_THROW(fit_polyline({0, 1, 2}, {0, 1}, 1), std::invalid_argument);
  EXPECT_THROW(fit_polyline({0, 1}, {0, 1}, 1), std::invalid_argument);
  EXPECT_THROW(fit_polyline({0, 2, 1}, {0, 1, 2}, 1), std::invalid_argument);
  EXPECT_THROW(fit_polyline({1, 1, 1}, {0, 1, 2}, 1), std::invalid_argument);
  EXPECT_THROW(fit_polyline(evenly(0, 1, 9), evenly(0, 1, 9), 0), std::invalid_argument);
  EXPECT_THROW(fit_polyline(evenly(0, 1, 9), evenly(0, 1, 9), 5), std::invalid_argument);
}

// ---- load curves

constexpr double mm = 1e-3, kPa = 1e3;

/// A load curve sampled more and more densely towards its beginning, with noise of so many pascals.
LoadCurve bent(const Values& settlement, const Values& pressure, double noise = 0.0) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  LoadCurve curve;
  for (int i = 0; i <= 600; ++i) {
    const double s = settlement.back() * std::pow(i / 600.0, 1.5);
    curve.settlement.push_back(s);
    curve.pressure.push_back(chain(settlement, pressure, s) + noise * normal(random));
  }
  return curve;
}

const Values two_phases_at{0, 2 * mm, 25 * mm}, two_phases{0, 6 * kPa, 13 * kPa};
const Values three_phases_at{0, 1 * mm, 6 * mm, 25 * mm}, three_phases{0, 5 * kPa, 10 * kPa, 12 * kPa};

TEST(CurveShape, RecoversTwoPhasesFromNoise) {
  const CurveShape shape = *shape_of(bent(two_phases_at, two_phases, 0.1 * kPa));
  EXPECT_EQ(shape.phases(), 2);
  EXPECT_NEAR(shape.fit(2).x[1], 2 * mm, 0.1 * mm);
  EXPECT_NEAR(shape.fit(2).y[1], 6 * kPa, 0.1 * kPa);
  EXPECT_NEAR(shape.fit(2).slope(1) / shape.fit(2).slope(0), 7.0 / 23 / 3, 0.01);
  EXPECT_NEAR(shape.final_slope, 7 * kPa / (23 * mm), 0.02 * kPa / mm);
  EXPECT_NEAR(shape.final_pressure, 13 * kPa, 0.1 * kPa);
  EXPECT_NEAR(shape.largest_pressure, 13 * kPa, 0.4 * kPa);
  const double left = shape.fit(2).rms_residual;
  EXPECT_NEAR(left, 0.08 * kPa, 0.03 * kPa);  // interpolation between the samples smooths a little
  EXPECT_LT(1 - left / shape.fit(1).rms_residual, 1.0);
  EXPECT_GT(1 - left / shape.fit(1).rms_residual, 0.8);
  EXPECT_LT(1 - shape.fit(3).rms_residual / left, 0.1);
}

TEST(CurveShape, RecoversThreePhasesFromNoise) {
  const CurveShape shape = *shape_of(bent(three_phases_at, three_phases, 0.05 * kPa));
  EXPECT_EQ(shape.phases(), 3);
  EXPECT_NEAR(shape.fit(3).x[1], 1 * mm, 0.1 * mm);
  EXPECT_NEAR(shape.fit(3).x[2], 6 * mm, 0.2 * mm);
  EXPECT_NEAR(shape.fit(3).y[1], 5 * kPa, 0.2 * kPa);
  EXPECT_NEAR(shape.fit(3).y[2], 10 * kPa, 0.1 * kPa);
  EXPECT_GT(1 - shape.fit(3).rms_residual / shape.fit(2).rms_residual, 0.7);
}

TEST(CurveShape, CountsPhasesByTwoPerCentOfTheLargestPressure) {
  EXPECT_EQ(shape_of(bent({0, 25 * mm}, {0, 9 * kPa}))->phases(), 1);
  EXPECT_EQ(shape_of(bent({0, 25 * mm}, {0, 9 * kPa}, 0.1 * kPa))->phases(), 1);
  EXPECT_EQ(shape_of(bent({0, 25 * mm}, {0, 9 * kPa}, 0.6 * kPa))->phases(), 5);
  // A triangle of height a leaves a / sqrt(12) times one half to a line: 1.9 and 2.1 % of the largest.
  const auto roof = [](double height) {
    return shape_of(bent({0, 5 * mm, 10 * mm}, {0, (5 + height) * kPa, 10 * kPa}))->phases();
  };
  EXPECT_EQ(roof(0.019 * 10 * std::sqrt(12)), 1);
  EXPECT_EQ(roof(0.021 * 10 * std::sqrt(12)), 2);
}

TEST(CurveShape, DoesNotDependOnTheTimesOfTheSamples) {
  LoadCurve evenly_sampled, dense_late;
  for (int i = 0; i <= 1000; ++i) {
    for (const auto& [curve, power] : {std::pair{&evenly_sampled, 1.0}, std::pair{&dense_late, 0.6}}) {
      curve->settlement.push_back(25 * mm * std::pow(i / 1000.0, power));
      curve->pressure.push_back(-9 * kPa * std::expm1(-curve->settlement.back() / (5 * mm)));
    }
  }
  const CurveShape a = *shape_of(evenly_sampled), b = *shape_of(dense_late);
  EXPECT_NEAR(a.fit(2).x[1], b.fit(2).x[1], 0.05 * mm);
  EXPECT_NEAR(a.fit(2).rms_residual / b.fit(2).rms_residual, 1, 0.01);
}

TEST(CurveShape, BeginsWithTheTangentOfACurveThatIsNeverStraight) {
  // q (1 - exp(-s/d)): its tangent is q/d at first, a line through its first third is softer by a fifth.
  LoadCurve curve;
  for (int i = 0; i <= 2000; ++i) {
    curve.settlement.push_back(10 * mm * i / 2000.0);
    curve.pressure.push_back(8 * kPa * -std::expm1(-curve.settlement.back() / mm));
  }
  EXPECT_NEAR(*shape_of(curve)->initial_stiffness / (8 * kPa / mm), 1, 0.02);
  // A block's curve begins with the pressure it stands under.
  for (double& pressure : curve.pressure) pressure += 20 * kPa;
  EXPECT_NEAR(*shape_of(curve)->initial_stiffness / (8 * kPa / mm), 1, 0.02);
}

TEST(CurveShape, OfAnElasticCurveHasOneSlope) {
  const CurveShape shape = *shape_of(bent({0, 0.1 * mm}, {0, 2 * kPa}));
  EXPECT_NEAR(*shape.initial_stiffness / (20 * kPa / mm), 1, 1e-6);
  EXPECT_NEAR(shape.final_slope / (20 * kPa / mm), 1, 1e-6);
  EXPECT_NEAR(shape.fit(2).slope(1) / shape.fit(2).slope(0), 1, 1e-6);
}

TEST(CurveShape, NeedsEnoughSamplesAndNumbersOnly) {
  LoadCurve few;
  for (int i = 0; i < 9; ++i) {
    few.settlement.push_back(i);
    few.pressure.push_back(i);
  }
  EXPECT_FALSE(shape_of(few));
  few.settlement.push_back(8);  // no deeper
  few.pressure.push_back(8);
  EXPECT_FALSE(shape_of(few));
  few.settlement.push_back(9);
  few.pressure.push_back(9);
  EXPECT_TRUE(shape_of(few));
  few.pressure[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(shape_of(few));
  // The first third of the way to the bend must have eight samples, the eighth at 7.
  for (const double bend : {20.0, 24.0}) {
    LoadCurve steep;
    for (int i = 0; i < 200; ++i) {
      steep.settlement.push_back(i);
      steep.pressure.push_back(i < bend ? 10.0 * i : 10.0 * bend);
    }
    ASSERT_TRUE(shape_of(steep));
    EXPECT_EQ(shape_of(steep)->initial_stiffness.has_value(), bend > 22) << bend;
  }
}

}  // namespace
}  // namespace mpm::vv
