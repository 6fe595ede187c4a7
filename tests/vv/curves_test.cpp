#include "vv/curves.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace mpm::vv {
namespace {

Curve curve(std::vector<double> x, std::vector<double> y, const std::string& source = "run") {
  return {"pressure", source, std::move(x), std::move(y), "settlement"};
}

/// A curve sampled at `count` + 1 equidistant abscissae.
Curve sampled(double end, int count, const std::function<double(double)>& ordinate) {
  Curve made = curve({}, {});
  for (int k = 0; k <= count; ++k) {
    made.x.push_back(end * k / count);
    made.y.push_back(ordinate(made.x.back()));
  }
  return made;
}

Reading reading(double at, double within = 0.0, const std::string& over = "") {
  return {.id = "p", .title = "p", .curve = "pressure", .at = at, .within = within, .over = over};
}

TEST(ValueAt, IsLinearBetweenSamples) {
  const Curve bent = curve({1.0, 2.0, 4.0}, {10.0, 20.0, 0.0});
  EXPECT_DOUBLE_EQ(value_at(bent, 1.0, 0.0).value, 10.0);
  EXPECT_DOUBLE_EQ(value_at(bent, 1.25, 0.0).value, 12.5);
  EXPECT_DOUBLE_EQ(value_at(bent, 2.0, 0.0).value, 20.0);
  EXPECT_DOUBLE_EQ(value_at(bent, 3.5, 0.0).value, 5.0);
  EXPECT_DOUBLE_EQ(value_at(bent, 4.0, 0.0).value, 0.0);
  EXPECT_EQ(value_at(bent, 3.5, 0.0).lack, "");
}

TEST(ValueAt, IsOfTheFirstPassing) {
  const Curve back_and_forth = curve({0.0, 0.0, 2.0, 1.0, 3.0}, {5.0, 6.0, 8.0, 0.0, 1.0});
  EXPECT_DOUBLE_EQ(value_at(back_and_forth, 0.0, 0.0).value, 5.0);
  EXPECT_DOUBLE_EQ(value_at(back_and_forth, 1.5, 0.0).value, 7.5);
  EXPECT_DOUBLE_EQ(value_at(curve({0.0, -1.0, -2.0}, {0.0, 3.0, 4.0}), -1.5, 0.0).value, 3.5);
}

TEST(ValueAt, IsTheMeanOfTheSamplesWithin) {
  const Curve noisy = curve({0.0, 1.0, 2.0, 3.0, 4.0}, {0.0, 7.0, 2.0, 9.0, 100.0});
  EXPECT_DOUBLE_EQ(value_at(noisy, 2.0, 1.0).value, 6.0);
  EXPECT_DOUBLE_EQ(value_at(noisy, 1.5, 0.6).value, 4.5);
  EXPECT_DOUBLE_EQ(value_at(noisy, 0.0, 1.0).value, 3.5) << "what lies beyond the end has no sample";
  const ReadOff lonely = value_at(noisy, 2.0, 0.9);
  EXPECT_TRUE(std::isnan(lonely.value));
  EXPECT_EQ(lonely.lack, "the curve pressure has fewer than two samples within 0.9 m of 2 m");
}

TEST(ValueAt, DoesNotExtrapolate) {
  const Curve short_curve = curve({0.5, 1.0, 1.5}, {1.0, 2.0, 3.0});
  for (const double at : {0.49, 1.51}) {
    for (const double within : {0.0, 1.0}) {
      const ReadOff beyond = value_at(short_curve, at, within);
      EXPECT_TRUE(std::isnan(beyond.value)) << at;
      EXPECT_NE(beyond.lack.find("the curve pressure goes from 0.5 to 1.5 m and does not reach "),
                std::string::npos)
          << beyond.lack;
    }
  }
  EXPECT_EQ(value_at(short_curve, 1.5 + 1e-12, 0.0).value, 3.0) << "an end missed by rounding is the end";
  EXPECT_EQ(value_at(curve({}, {}), 0.0, 0.0).lack, "the curve pressure has no samples");
  EXPECT_EQ(value_at(curve({1.0}, {2.0}), 1.0, 0.0).value, 2.0);
}

TEST(ValueAt, IsAbsentWhereTheCurveIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Curve broken = curve({0.0, 1.0, 2.0}, {0.0, nan, 2.0});
  EXPECT_FALSE(value_at(broken, 0.5, 0.0).lack.empty());
  EXPECT_FALSE(value_at(broken, 1.0, 1.0).lack.empty());
  EXPECT_FALSE(value_at(curve({0.0, nan, 2.0}, {0.0, 1.0, 2.0}), 0.5, 0.0).lack.empty());
}

TEST(Reading, IsReadOffTheCurveOfTheRun) {
  const std::vector<Curve> curves = {curve({0.0, 2.0}, {7.0, 7.0}, "limit_analysis"),
                                     {"other", "run", {0.0, 2.0}, {1.0, 1.0}, "time"},
                                     curve({0.0, 2.0}, {0.0, 10.0})};
  EXPECT_DOUBLE_EQ(read_off(reading(0.5), curves).value, 2.5);
  EXPECT_EQ(read_off(reading(0.5), {curves[0], curves[1]}).lack, "the run has no curve pressure");
  EXPECT_FALSE(read_off(reading(2.5), curves).lack.empty());
}

TEST(Reading, IsDividedByTheSameReadingOfTheReference) {
  // Two samples are enough for a reference that is a straight line, also where the run's many are averaged.
  const Curve run = sampled(2.0, 20, [](double x) { return 12.0 * x; });
  const Curve reference = curve({0.0, 2.0}, {0.0, 8.0}, "elastic_strip");
  for (const double within : {0.0, 0.25}) {
    const ReadOff ratio = read_off(reading(0.5, within, "elastic_strip"), {reference, run});
    EXPECT_NEAR(ratio.value, 3.0, 1e-12);
  }
  // The mean over unevenly many samples is of the same abscissae in both.
  const Curve uneven = curve({0.0, 0.9, 1.0, 2.0}, {0.0, 10.8, 12.0, 24.0});
  EXPECT_NEAR(read_off(reading(0.7, 0.35, "elastic_strip"), {reference, uneven}).value, 3.0, 1e-12);
  EXPECT_EQ(read_off(reading(0.5, 0.0, "hencky"), {reference, run}).lack, "hencky has no curve pressure");
  const Curve short_reference = curve({0.0, 0.6}, {0.0, 2.4}, "elastic_strip");
  EXPECT_NEAR(read_off(reading(0.5, 0.0, "elastic_strip"), {short_reference, run}).value, 3.0, 1e-12);
  const ReadOff beyond = read_off(reading(0.5, 0.25, "elastic_strip"), {short_reference, run});
  EXPECT_EQ(beyond.lack, "elastic_strip: the curve pressure goes from 0 to 0.6 m and does not reach 0.7 m");
  const Curve nothing = curve({0.0, 2.0}, {0.0, 0.0}, "elastic_strip");
  EXPECT_FALSE(read_off(reading(0.5, 0.0, "elastic_strip"), {nothing, run}).lack.empty());
}

TEST(Reading, IsAMetricOfTheCatalogueKind) {
  EXPECT_EQ(metric_of(reading(1.0)).name, "reading.p");
  EXPECT_EQ(metric_of(reading(1.0)).unit, "Pa");
  EXPECT_EQ(metric_of(reading(1.0, 0.0, "hencky")).unit, "-");
  EXPECT_EQ(metric_of(reading(1.0, 0.0, "hencky")).reference, "hencky");
}

// ---- curves against each other ----

ReadOff spread_of(const std::vector<Curve>& curves, const Stretch& stretch = {}, double within = 0.0) {
  std::vector<const Curve*> each;
  for (const Curve& one : curves) each.push_back(&one);
  return curve_spread(each, stretch, within);
}

Curve line(double end, double slope) {
  return sampled(end, 40, [=](double x) { return slope * x; });
}

TEST(CurveSpread, IsTheLargestDifferenceOverTheLargestMean) {
  // At 2 the lines are 2, 4 and 6: 4 apart around a mean of 4.
  EXPECT_NEAR(spread_of({line(2.0, 1.0), line(2.0, 3.0), line(2.0, 2.0)}).value, 1.0, 1e-12);
  // A bump between the samples of neither end: 1 apart where the mean is 2 + 1/2, its largest.
  const Curve flat = curve({0.0, 4.0}, {2.0, 2.0});
  const Curve bump = curve({0.0, 1.0, 2.0, 3.0, 4.0}, {2.0, 2.0, 3.0, 2.0, 2.0});
  EXPECT_NEAR(spread_of({flat, bump}).value, 1.0 / 2.5, 0.01) << "to half a step of the grid";
  const Curve below = curve({0.0, 4.0}, {-2.0, -2.0});
  EXPECT_NEAR(spread_of({below, curve({0.0, 4.0}, {-6.0, -6.0})}).value, 1.0, 1e-12)
      << "magnitude of the mean";
  EXPECT_EQ(spread_of({flat, flat}).value, 0.0);
}

TEST(CurveSpread, ComparesTheStretchAsked) {
  const std::vector<Curve> curves = {line(2.0, 1.0),
                                     sampled(2.0, 40, [](double x) { return x < 0.99 ? 5.0 : x; })};
  EXPECT_GT(spread_of(curves).value, 1.0);
  EXPECT_NEAR(spread_of(curves, {.from = 1.0, .up_to = {}}).value, 0.0, 1e-12);
  EXPECT_NEAR(spread_of(curves, {.from = {}, .up_to = 0.5}).value, 5.0 / 2.75, 1e-12);
}

TEST(CurveSpread, IsNotMeasuredWhereOneCurveBreaksOff) {
  EXPECT_EQ(spread_of({line(2.0, 1.0), line(1.905, 1.0)}).lack, "");
  const ReadOff broken = spread_of({line(2.0, 1.0), line(1.895, 1.0), line(1.99, 1.0)});
  EXPECT_TRUE(std::isnan(broken.value));
  EXPECT_EQ(broken.of, 1u);
  EXPECT_EQ(broken.lack, "the curve pressure goes from 0 to 1.895 m: the curves have only 94.8 % in common");
  EXPECT_EQ(spread_of({line(2.0, 1.0), line(0.5, 1.0)}, {.from = {}, .up_to = 0.4}).lack, "");
  // The part before `from` is not compared, so it does not count for what is in common.
  EXPECT_EQ(spread_of({line(2.0, 1.0), line(1.905, 1.0)}, {.from = 1.0, .up_to = {}}).of, 1u);
  EXPECT_NE(spread_of({line(2.0, 1.0), line(1.905, 1.0)}, {.from = 1.0, .up_to = {}}).lack, "");
}

TEST(CurveSpread, IsNotMeasuredWhereOneCurveBeginsLate) {
  const Curve late = curve({0.2, 2.0}, {0.2, 2.0});
  const ReadOff apart = spread_of({late, line(2.0, 1.0)});
  EXPECT_EQ(apart.of, 0u);
  EXPECT_EQ(apart.lack, "the curve pressure goes from 0.2 to 2 m: the curves have only 90.0 % in common");
  EXPECT_NEAR(spread_of({late, line(2.0, 1.0)}, {.from = 0.2, .up_to = {}}).value, 0.0, 1e-12);
}

TEST(CurveSpread, IsNotMeasuredWhereACurveDoesNotReachTheStretchAsked) {
  const ReadOff early = spread_of({line(2.0, 1.0), line(1.0, 1.0)}, {.from = {}, .up_to = 1.5});
  EXPECT_EQ(early.of, 1u);
  EXPECT_EQ(early.lack, "the curve pressure goes from 0 to 1 m and does not reach 1.5 m");
  EXPECT_FALSE(spread_of({line(2.0, 1.0), line(2.0, 1.0)}, {.from = -0.1, .up_to = {}}).lack.empty());
  const Curve elsewhere = curve({3.0, 4.0}, {1.0, 1.0});
  EXPECT_FALSE(spread_of({line(2.0, 1.0), elsewhere}).lack.empty());
  EXPECT_FALSE(spread_of({line(2.0, 1.0), curve({}, {})}).lack.empty());
  const Curve nothing = curve({0.0, 2.0}, {0.0, 0.0});
  EXPECT_FALSE(spread_of({nothing, nothing}).lack.empty()) << "nothing to relate the difference to";
}

TEST(CurveSpread, LooksAtMovingMeansWhereAsked) {
  const auto saw = [](double sign) {
    Curve teeth = curve({}, {});
    for (int k = 0; k <= 200; ++k) {
      teeth.x.push_back(0.01 * k);
      teeth.y.push_back(10.0 + sign * (k % 2 == 0 ? 1.0 : -1.0));
    }
    return teeth;
  };
  const std::vector<Curve> curves = {saw(1.0), saw(-1.0)};
  EXPECT_GT(spread_of(curves).value, 0.19);
  EXPECT_LT(spread_of(curves, {}, 0.2).value, 0.02) << "means of about forty samples, at the ends of twenty";
  EXPECT_FALSE(spread_of(curves, {}, 0.001).lack.empty()) << "no two samples are that near";
}

}  // namespace
}  // namespace mpm::vv
