#include "vv/digitiser.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/painted_figure.hpp"
#include "tests/support/scratch_directory.hpp"

namespace mpm::vv {
namespace {

using tests::painted_axes;
using tests::PaintedFigure;

const Rgb red{214, 39, 40}, blue{31, 119, 180}, black{0, 0, 0};

/// The message with which an action is refused; empty when it is not.
template <class Error = DigitiseError, class Action>
std::string refusal_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

void expect_parts(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

// ---- axes ----

PictureAxis axis(const std::string& name, AxisScale scale, AxisPoint first, AxisPoint second) {
  return {name, scale, {first, second}};
}

const PictureAxis level = axis("x", AxisScale::linear, {{100, 500}, 0}, {{600, 500}, 25});
const PictureAxis upright = axis("y", AxisScale::linear, {{100, 500}, 0}, {{100, 100}, 16});

TEST(PictureAxes, InterpolateAndExtrapolate) {
  const AxisPair value = PictureAxes(level, upright).values({300, 50});
  EXPECT_NEAR(value.abscissa, 10.0, 1e-12);
  EXPECT_NEAR(value.ordinate, 18.0, 1e-12) << "upwards is more, though rows are counted downwards";
}

TEST(PictureAxes, KnowDecades) {
  const PictureAxes axes(level, axis("y", AxisScale::logarithmic, {{100, 500}, 0.01}, {{100, 100}, 100}));
  EXPECT_NEAR(axes.values({0, 300}).ordinate, 1.0, 1e-12);
  EXPECT_NEAR(axes.worth_of_a_pixel().ordinate, std::log(1e4) / 400, 1e-12);
  EXPECT_NEAR(axes.worth_of_a_pixel().abscissa, 0.05, 1e-12);
}

TEST(PictureAxes, FollowATurnedAndShearedSheet) {
  // x = 100 + 16 a - 1 b, y = 500 + 0.5 a - 20 b
  const PictureAxes axes(axis("a", AxisScale::linear, {{100, 500}, 0}, {{500, 512.5}, 25}),
                         axis("b", AxisScale::linear, {{100, 500}, 0}, {{85, 200}, 15}));
  const AxisPair value = axes.values({100 + 16 * 7.0 - 11.0, 500 + 0.5 * 7.0 - 20 * 11.0});
  EXPECT_NEAR(value.abscissa, 7.0, 1e-9);
  EXPECT_NEAR(value.ordinate, 11.0, 1e-9);
}

TEST(PictureAxes, NeedNotMeetNorRunUpwards) {
  const PictureAxes axes(axis("settlement", AxisScale::linear, {{50, 100}, 0}, {{50, 600}, 25}),
                         axis("pressure", AxisScale::linear, {{90, 20}, 2}, {{490, 20}, 10}));
  const AxisPair value = axes.values({290, 350});
  EXPECT_NEAR(value.abscissa, 12.5, 1e-9);
  EXPECT_NEAR(value.ordinate, 6.0, 1e-9);
}

TEST(PictureAxes, SayWhatClicksContribute) {
  const PictureAxes axes(level, upright);
  const double pixel = 25.0 / 500.0;
  // On the x axis, halfway between the points: their mean, each off by half a pixel.
  EXPECT_NEAR(axes.uncertainty({350, 500}, 0.5).abscissa, 0.5 * pixel / std::sqrt(2.0), 1e-6);
  // At the first point: that point alone.
  EXPECT_NEAR(axes.uncertainty({100, 500}, 0.5).abscissa, 0.5 * pixel, 1e-6);
  // At the top of the y axis its direction counts as well, as much for each end.
  EXPECT_NEAR(axes.uncertainty({100, 100}, 0.5).abscissa, 0.5 * pixel * std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(axes.uncertainty({350, 300}, 2.0).abscissa, 4.0 * axes.uncertainty({350, 300}, 0.5).abscissa,
              1e-6);
}

TEST(PictureAxes, RefuseWhatIsNoPairOfAxes) {
  const auto refused = [](const PictureAxis& a, const PictureAxis& b) {
    return refusal_of([&] { PictureAxes(a, b); });
  };
  expect_parts(refused(axis("x", AxisScale::linear, {{100, 500}, 3}, {{600, 500}, 3}), upright),
               {"axis x", "both points have the value 3"});
  expect_parts(refused(level, axis("y", AxisScale::logarithmic, {{100, 500}, 0}, {{100, 100}, 1})),
               {"axis y", "positive", "found 0"});
  expect_parts(refused(axis("x", AxisScale::linear, {{100, 500}, 0}, {{103, 504}, 3}), upright),
               {"axis x", "5.0 px apart"});
  expect_parts(refused(level, axis("y", AxisScale::linear, {{100, 500}, 0}, {{600, 500}, 9})),
               {"bad calibration", "0.0 degrees"});
  expect_parts(refused(level, axis("y", AxisScale::linear, {{100, 500}, 0}, {{160, 100}, 9})),
               {"bad calibration", "81.5 degrees"});
  EXPECT_EQ(refused(level, axis("y", AxisScale::linear, {{100, 500}, 0}, {{130, 100}, 9})), "")
      << "4.3 degrees off";
}

// ---- pictures ----

TEST(RasterImage, PngKeepsEveryPixel) {
  const tests::ScratchDirectory scratch;
  const RasterImage image = PaintedFigure(30, 20).disc(red, {12, 9}, 5).image;
  std::ofstream(scratch.path() / "a.png", std::ios::binary) << png_of(image);
  const RasterImage read = read_png(scratch.path() / "a.png");
  EXPECT_EQ(read.width, 30);
  EXPECT_EQ(read.height, 20);
  EXPECT_EQ(read.pixels, image.pixels);
}

TEST(RasterImage, WhatIsNoPngIsToldByName) {
  const tests::ScratchDirectory scratch;
  std::ofstream(scratch.path() / "a.png") << "JFIF";
  expect_parts(refusal_of<ImageError>([&] { read_png(scratch.path() / "a.png"); }), {"a.png", "not a PNG"});
  expect_parts(refusal_of<ImageError>([&] { read_png(scratch.path() / "b.png"); }),
               {"b.png", "cannot be read"});
  const std::string whole = png_of(PaintedFigure(300, 200).disc(red, {120, 90}, 50).image);
  std::ofstream(scratch.path() / "c.png", std::ios::binary) << whole.substr(0, whole.size() / 2);
  expect_parts(refusal_of<ImageError>([&] { read_png(scratch.path() / "c.png"); }), {"c.png", "damaged"});
}

// ---- curves ----

DigitisedSeries only(const RasterImage& image, const DigitiseRequest& request) {
  const std::vector<DigitisedSeries> series = digitise(image, request);
  EXPECT_EQ(series.size(), 1U);
  return series.at(0);
}

double gentle(double x) { return 250.0 - 0.4 * x; }

TEST(Digitiser, ReadsALineBetweenPixels) {
  const auto figure = PaintedFigure().stroke(red, gentle, 30, 350);
  const DigitisedSeries series = only(figure.image, painted_axes({{"a", red}}));
  EXPECT_EQ(series.points.size(), 100U);
  for (const DigitisedPoint& point : series.points)
    EXPECT_NEAR(point.value.ordinate, (290.0 - gentle(20.0 + 10.0 * point.value.abscissa)) / 20.0,
                0.1 / 20.0);
  EXPECT_NEAR(series.points.front().value.abscissa, 1.0, 0.11);
  EXPECT_NEAR(series.points.back().value.abscissa, 33.0, 0.11);
}

TEST(Digitiser, KeepsTheNumberOfPointsAskedFor) {
  DigitiseRequest request = painted_axes({{"a", red}});
  request.most_points = 7;
  const auto figure = PaintedFigure().stroke(red, gentle, 30, 350);
  EXPECT_EQ(only(figure.image, request).points.size(), 7U);
}

TEST(Digitiser, UncertaintyIsThatOfClicksPickingAndRaster) {
  const auto figure = PaintedFigure().stroke(red, gentle, 30, 350);
  DigitiseRequest request = painted_axes({{"a", red}});
  const DigitisedSeries fine = only(figure.image, request);
  EXPECT_NEAR(fine.picking, 1.0 / std::sqrt(12.0), 0.03) << "a soft line without noise leaves the raster";
  EXPECT_NEAR(fine.uncertainty.ordinate, std::hypot(fine.click_part.ordinate, fine.picking / 20.0), 1e-9);
  request.click_uncertainty = 2.0;
  const DigitisedSeries coarse = only(figure.image, request);
  EXPECT_NEAR(coarse.click_part.abscissa, 4.0 * fine.click_part.abscissa, 1e-9);
  const auto rough = PaintedFigure().stroke(
      red, [](double x) { return gentle(x) + std::sin(40.0 * x * x); }, 30, 350);
  EXPECT_NEAR(only(rough.image, request).picking,
              std::hypot(std::sqrt(0.5) / std::hypot(1.0, 0.4), fine.picking), 0.25);
}

TEST(Digitiser, OrdersByTheAbscissaWhereverItRuns) {
  DigitiseRequest request = painted_axes({{"a", red}});
  std::swap(request.abscissa.points[0].value, request.abscissa.points[1].value);
  const auto figure = PaintedFigure().stroke(red, gentle, 30, 350);
  const DigitisedSeries leftwards = only(figure.image, request);
  EXPECT_LT(leftwards.points.front().value.abscissa, leftwards.points.back().value.abscissa);
  EXPECT_GT(leftwards.points.front().value.ordinate, leftwards.points.back().value.ordinate);

  // A curve that goes back and forth in x, as a function of y.
  request = painted_axes({{"a", red}});
  std::swap(request.abscissa, request.ordinate);
  PaintedFigure tall(300, 400);
  tall.stroke(
      red, [](double x) { return 150.0 + 60.0 * std::sin(x / 25.0); }, 20, 280);
  RasterImage turned{400, 300, tall.image.pixels};
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 400; ++x) turned.at(x, y) = tall.image.at(y, x);
  const DigitisedSeries upwards = only(turned, request);
  for (const DigitisedPoint& point : upwards.points) {
    const double y = 290.0 - 20.0 * point.value.abscissa;
    EXPECT_NEAR(20.0 + 10.0 * point.value.ordinate, 150.0 + 60.0 * std::sin(y / 25.0), 0.5) << "half a pixel";
  }
}

TEST(Digitiser, LooksNeitherOutsideTheAreaNorAtWhatIsExcepted) {
  const auto figure = PaintedFigure()
                          .stroke(red, gentle, 30, 350)
                          .stroke(
                              red, [](double) { return 20.0; }, 300, 340);
  DigitiseRequest request = painted_axes({{"a", red}});
  expect_parts(refusal_of([&] { digitise(figure.image, request); }),
               {"\"a\" (#d62728)", "ambiguous", "settlement = 28", "300, 130 px", "300, 20 px", "--except"});
  request.holes = {{290, 10, 350, 30}};
  EXPECT_EQ(only(figure.image, request).points.size(), 100U);
  request.holes = {};
  request.area = PixelBox{0, 40, 399, 299};
  EXPECT_EQ(only(figure.image, request).points.size(), 100U);
}

TEST(Digitiser, SpecksAreNoise) {
  auto figure = PaintedFigure().stroke(red, gentle, 30, 350);
  for (int k = 0; k < 40; ++k) figure.image.at(31 + 8 * k, 20 + (37 * k) % 60) = red;
  EXPECT_EQ(only(figure.image, painted_axes({{"a", red}})).points.size(), 100U);
}

TEST(Digitiser, AnInterruptionIsToldUnlessItIsAllowed) {
  const auto figure = PaintedFigure().stroke(red, gentle, 30, 150).stroke(red, gentle, 200, 350);
  DigitiseRequest request = painted_axes({{"a", red}});
  expect_parts(refusal_of([&] { digitise(figure.image, request); }),
               {"ambiguous", "interrupted over 49 px", "150, 190 px", "200, 170 px", "--gap"});
  request.longest_gap = 60;
  EXPECT_EQ(only(figure.image, request).points.size(), 100U);
}

TEST(Digitiser, ALoopIsNoFunction) {
  auto figure = PaintedFigure();
  for (double angle = 0.0; angle < 6.3; angle += 0.01)
    figure.disc(red, {150 + 80 * std::cos(angle), 150 + 60 * std::sin(angle)}, 1.5);
  expect_parts(refusal_of([&] {
                 digitise(figure.image, painted_axes({{"a", red}}));
               }),
               {"ambiguous", "both"});
}

TEST(Digitiser, ASteepStretchIsOneStroke) {
  const auto step = [](double x) { return 150.0 - 100.0 * std::tanh((x - 150.0) / 2.0); };
  auto figure = PaintedFigure();
  for (double x = 30.0; x < 350.0; x += 0.02) figure.disc(red, {x, step(x)}, 1.5);
  const DigitisedSeries series = only(figure.image, painted_axes({{"a", red}}));
  EXPECT_NEAR(series.points.front().value.ordinate, 2.0, 0.1);
  EXPECT_NEAR(series.points.back().value.ordinate, 12.0, 0.1);
}

TEST(Digitiser, AnotherCurveOnTopDoesNotCutTheLine) {
  const auto figure = PaintedFigure()
                          .stroke(red, gentle, 30, 350)
                          .stroke(
                              blue, [](double x) { return 100.0 + 0.3 * x; }, 30, 350, 5.0);
  const std::vector<DigitisedSeries> both = digitise(figure.image, painted_axes({{"a", red}, {"b", blue}}));
  for (const DigitisedPoint& point : both[0].points)
    EXPECT_NEAR(point.value.ordinate, (290.0 - gentle(20.0 + 10.0 * point.value.abscissa)) / 20.0,
                1.0 / 20.0);
}

// ---- markers ----

TEST(Digitiser, ReadsTheCentresOfMarkers) {
  auto figure = PaintedFigure();
  const std::vector<PixelPlace> centres = {{40.3, 200.7}, {90.0, 150.2}, {150.5, 120.0}, {231.8, 90.4}};
  for (const PixelPlace& centre : centres) figure.disc(red, centre, 6.0);
  figure.disc({255, 255, 255}, centres[1], 4.5).disc(red, {300, 250}, 0.5);  // an open one, and a speck
  const DigitisedSeries series = only(figure.image, painted_axes({{"a", red, Drawing::markers}}));
  ASSERT_EQ(series.points.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(series.points[i].place.x, centres[i].x, 0.1);
    EXPECT_NEAR(series.points[i].place.y, centres[i].y, 0.1);
  }
  EXPECT_NEAR(series.thickness, 12.0, 1.0);
}

TEST(Digitiser, TouchingMarkersAreToldApart) {
  auto figure = PaintedFigure();
  for (const PixelPlace& centre :
       {PixelPlace{100, 150}, {111, 148}, {122, 151}, {200, 80}, {230, 80}, {260, 60}})
    figure.disc(red, centre, 6.0);
  const DigitisedSeries series = only(figure.image, painted_axes({{"a", red, Drawing::markers}}));
  ASSERT_EQ(series.points.size(), 6U);
  EXPECT_NEAR(series.points[1].place.x, 111.0, 0.3);
  EXPECT_NEAR(series.points[1].place.y, 148.0, 0.5);
}

TEST(Digitiser, MarkersThatHideEachOtherAreToldOf) {
  auto figure = PaintedFigure();
  for (const PixelPlace& centre : {PixelPlace{100, 150}, {105, 148}, {200, 80}, {230, 80}, {260, 60}})
    figure.disc(red, centre, 6.0);
  expect_parts(refusal_of([&] {
                 digitise(figure.image, painted_axes({{"a", red, Drawing::markers}}));
               }),
               {"ambiguous", "hide each other", "near 103, 149 px"});
}

// ---- refusals ----

TEST(Digitiser, PointsOutsideThePictureAreToldOf) {
  DigitiseRequest request = painted_axes({{"a", red}});
  request.abscissa.points[1].place.x = 4000;
  expect_parts(refusal_of([&] { digitise(PaintedFigure().image, request); }),
               {"axis settlement", "4000, 290 px", "outside", "400 x 300 px"});
}

TEST(Digitiser, AColourThatIsNotThereIsToldWithThoseThatAre) {
  const auto figure = PaintedFigure().stroke(blue, gentle, 30, 350);
  expect_parts(refusal_of([&] {
                 digitise(figure.image, painted_axes({{"a", red}}));
               }),
               {"\"a\"", "#d62728", "nearest colours are #1f77b4"});
  expect_parts(refusal_of([&] {
                 digitise(PaintedFigure().image, painted_axes({{"a", red}}));
               }),
               {"no ink at all"});
}

TEST(Digitiser, ColoursMustDiffer) {
  expect_parts(
      refusal_of([&] {
        digitise(PaintedFigure().image, painted_axes({{"a", red}, {"b", blue}, {"c", {214, 40, 41}}}));
      }),
      {"\"a\" and \"c\"", "same colour"});
  expect_parts(refusal_of([&] {
                 digitise(PaintedFigure().image, painted_axes({{"a", {255, 255, 254}}}));
               }),
               {"\"a\"", "colour of the paper"});
}

// ---- the preview ----

TEST(Digitiser, ThePreviewMarksEveryPoint) {
  auto figure = PaintedFigure();
  for (const PixelPlace& centre : {PixelPlace{40, 200}, {90, 150}}) figure.disc(red, centre, 6.0);
  const DigitiseRequest request = painted_axes({{"a", red, Drawing::markers}});
  const RasterImage preview = preview_of(figure.image, request, digitise(figure.image, request));
  EXPECT_EQ(preview.width, 400);
  for (const PixelPlace& centre : {PixelPlace{40, 200}, {90, 150}})
    EXPECT_EQ(preview.at(static_cast<int>(centre.x), static_cast<int>(centre.y)), (Rgb{255, 0, 255}));
  EXPECT_EQ(preview.at(20, 290), (Rgb{0, 160, 0})) << "an axis' point";
  EXPECT_EQ(preview.at(200, 100), (Rgb{255, 255, 255}));
}

}  // namespace
}  // namespace mpm::vv
