// Figures that the project draws itself, spoilt as printing and scanning spoil them, and read back: the
// curves that were drawn must come out within the uncertainty that is stated.

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "reports/plot.hpp"
#include "tests/support/degraded_image.hpp"
#include "vv/digitiser.hpp"

namespace mpm::vv {
namespace {

using reports::Look;
using reports::MarkerShape;
using reports::Panel;
using reports::Scale;
using tests::blurred;
using tests::compressed;
using tests::turned;
using tests::with_noise;
using Function = std::function<double(double)>;

Rgb rgb(const reports::Color& c) {
  return {tests::channel_of(255 * c.red), tests::channel_of(255 * c.green), tests::channel_of(255 * c.blue)};
}

/// A series of a figure: a function, drawn at a number of places from one end to the other.
struct Drawn {
  std::string name;
  Function function;
  double from = 0.0, to = 1.0;
  int places = 300;
};

/// An axis with round ticks.
reports::Axis axis_of(const std::string& label, Scale scale, const reports::Range& range) {
  return {label, scale, range, {}};
}

/// A figure as a picture, and what is known of it.
struct Figure {
  RasterImage image;
  DigitiseRequest request;   ///< with the true places of the axes' ends
  std::vector<Drawn> drawn;  ///< in the order of `request.series`
};

/// What a series is drawn with: its own colour, a line, markers or both.
struct Style {
  Drawing drawing = Drawing::line;
  Look look;
};

Look line_of(const reports::Color& color, std::vector<double> dash = {}) {
  return {color, 1.2, std::move(dash)};
}
Look markers_of(const reports::Color& color, MarkerShape shape, bool filled) {
  return {color, 0.0, {}, shape, 5.2, filled};
}

const reports::Color red{0.84, 0.15, 0.16}, blue{0.12, 0.47, 0.71}, green{0.0, 0.52, 0.38},
    purple{0.42, 0.27, 0.62};

/// A load–settlement curve: steep at first, with a peak, then slowly rising.
double footing(double s) {
  return 9.0 * (1.0 - std::exp(-s / 1.5)) + 0.18 * s + 1.2 * std::exp(-std::pow((s - 5.0) / 1.5, 2));
}
double straight(double s) { return 0.4 + 0.31 * s; }
double wave(double s) { return 5.0 + 2.0 * std::sin(s / 3.0); }
double power(double h) { return 0.7 * std::pow(h, 1.8); }
double tail(double h) { return 3.0 / (1.0 + 20.0 * h); }

reports::PlotCurve curve_of(const Drawn& drawn, const Look& look, bool logarithmic) {
  reports::PlotCurve curve{drawn.name, look, {}, {}};
  for (int i = 0; i < drawn.places; ++i) {
    const double share = static_cast<double>(i) / (drawn.places - 1);
    const double x = logarithmic ? drawn.from * std::pow(drawn.to / drawn.from, share)
                                 : drawn.from + share * (drawn.to - drawn.from);
    curve.x.push_back(x);
    curve.y.push_back(drawn.function(x));
  }
  return curve;
}

/// Draws the figure at 240 dots an inch.
Figure figure_of(const reports::Axis& x, const reports::Axis& y,
                 const std::vector<std::pair<Drawn, Style>>& series) {
  constexpr double pixels_per_point = 240.0 / 72.0;
  reports::Plot plot;
  plot.width = 260.0;
  Panel panel;
  panel.x = x;
  panel.y = y;
  Figure figure;
  for (const auto& [drawn, style] : series) {
    panel.curves.push_back(curve_of(drawn, style.look, x.scale == Scale::logarithmic));
    figure.drawn.push_back(drawn);
    figure.request.series.push_back({drawn.name, rgb(style.look.color), style.drawing});
  }
  plot.panels.push_back(panel);
  const reports::Picture picture = reports::draw(plot, pixels_per_point);
  const std::vector<unsigned char> pixels = picture.canvas.pixels();
  figure.image = {picture.canvas.pixel_width(), picture.canvas.pixel_height(), {}};
  for (std::size_t i = 0; i + 2 < pixels.size(); i += 3)
    figure.image.pixels.push_back({pixels[i], pixels[i + 1], pixels[i + 2]});

  // The centre of the first pixel is half a pixel from the sheet's corner.
  const auto place = [](double px, double py) {
    return PixelPlace{px * pixels_per_point - 0.5, py * pixels_per_point - 0.5};
  };
  const reports::Rectangle f = picture.layout.panels[0].frame;
  const auto scale = [](const reports::Axis& axis) {
    return axis.scale == Scale::linear ? AxisScale::linear : AxisScale::logarithmic;
  };
  DigitiseRequest& request = figure.request;
  request.abscissa = {
      "x", scale(x), {{{place(f.left, f.bottom), x.range.lower}, {place(f.right, f.bottom), x.range.upper}}}};
  request.ordinate = {
      "y", scale(y), {{{place(f.left, f.bottom), y.range.lower}, {place(f.left, f.top), y.range.upper}}}};
  const PixelPlace corner = place(f.left, f.top), opposite = place(f.right, f.bottom);
  request.area = {int(corner.x) - 15, int(corner.y) - 15, int(opposite.x) + 15, int(opposite.y) + 15};
  return figure;
}

/// Pressure over settlement of a test, a simulation and a formula, crossing each other.
Figure lines_figure() {
  return figure_of(axis_of("settlement [mm]", Scale::linear, {0.0, 25.0}),
                   axis_of("pressure [kPa]", Scale::linear, {0.0, 15.0}),
                   {{{"footing", footing, 0.0, 25.0}, {Drawing::line, line_of(red)}},
                    {{"straight", straight, 0.0, 25.0}, {Drawing::line, line_of(blue, {6.0, 2.5})}},
                    {{"wave", wave, 2.0, 22.0}, {Drawing::line, line_of(green, {1.6, 1.8})}},
                    {{"purple", [](double s) { return 13.5 - 0.02 * s * s; }, 1.0, 24.0},
                     {Drawing::line, line_of(purple)}}});
}

Figure logarithmic_figure() {
  return figure_of(axis_of("cell size [m]", Scale::logarithmic, {0.01, 1.0}),
                   axis_of("error [1]", Scale::logarithmic, {1e-4, 10.0}),
                   {{{"power", power, 0.011, 0.9}, {Drawing::line, line_of(red)}},
                    {{"tail", tail, 0.015, 0.95}, {Drawing::line, line_of(blue, {6.0, 2.5})}},
                    {{"points", [](double h) { return 0.1 * power(h); }, 0.03, 0.9, 9},
                     {Drawing::markers, markers_of(green, MarkerShape::square, true)}}});
}

/// Markers filled and open, some crossed by a curve of another colour, one kind on a line of its own.
Figure markers_figure() {
  Look joined{blue, 1.2, {}, MarkerShape::diamond, 6.5, true};
  return figure_of(
      axis_of("settlement [mm]", Scale::linear, {0.0, 25.0}),
      axis_of("pressure [kPa]", Scale::linear, {0.0, 15.0}),
      {{{"open", footing, 0.5, 24.0, 18}, {Drawing::markers, markers_of(red, MarkerShape::circle, false)}},
       {{"filled", wave, 1.0, 24.0, 15}, {Drawing::markers, markers_of(green, MarkerShape::triangle, true)}},
       {{"joined", straight, 1.0, 24.0, 12}, {Drawing::joined_markers, joined}},
       {{"purple", [](double s) { return footing(s) + 0.05; }, 1.5, 25.0},
        {Drawing::line, line_of(purple)}}});
}

// ---- how well it is read ----

/// Misses of points in units of what is stated for them.
struct Misses {
  int count = 0, beyond_two = 0;
  double squares = 0.0;

  double rms() const { return std::sqrt(squares / count); }
  double share_within_two() const { return 1.0 - static_cast<double>(beyond_two) / count; }
  void add(double miss) {
    ++count;
    beyond_two += std::abs(miss) > 2.0;
    squares += miss * miss;
  }
};

double measure(const PictureAxis& axis, double value) {
  return axis.scale == AxisScale::linear ? value : std::log(value);
}

void judge(const DigitisedSeries& series, const Drawn& drawn, const DigitiseRequest& request,
           Misses& misses) {
  for (const DigitisedPoint& point : series.points) {
    const double x = point.value.abscissa, step = 1e-5 * x;
    const auto truth = [&](double at) { return measure(request.ordinate, drawn.function(at)); };
    const double slope = (truth(x + step) - truth(x - step)) /
                         (measure(request.abscissa, x + step) - measure(request.abscissa, x - step));
    const double uncertainty = std::hypot(series.uncertainty.ordinate, slope * series.uncertainty.abscissa);
    misses.add((measure(request.ordinate, point.value.ordinate) - truth(x)) / uncertainty);
  }
}

/// As the hand of a person would point.
void unsettle(PictureAxis& axis, std::mt19937& engine, double click) {
  std::normal_distribution<double> slip(0.0, click);
  for (AxisPoint& point : axis.points)
    point.place = {point.place.x + slip(engine), point.place.y + slip(engine)};
}

/// Reads a figure as ten persons would, and judges all points of each series together.
std::vector<Misses> read_by_ten(const Figure& figure) {
  std::vector<Misses> misses(figure.drawn.size());
  std::mt19937 engine(7);
  for (int person = 0; person < 10; ++person) {
    DigitiseRequest request = figure.request;
    unsettle(request.abscissa, engine, request.click_uncertainty);
    unsettle(request.ordinate, engine, request.click_uncertainty);
    const std::vector<DigitisedSeries> series = digitise(figure.image, request);
    for (std::size_t i = 0; i < series.size(); ++i) judge(series[i], figure.drawn[i], request, misses[i]);
  }
  return misses;
}

enum class Spoilt { not_at_all, noise, compression, turn, everything };

Figure spoilt(Figure figure, Spoilt how) {
  const bool all = how == Spoilt::everything;
  if (how == Spoilt::turn || all) {
    const RasterImage sheet = figure.image;
    constexpr double degrees = 2.0;
    figure.image = turned(sheet, degrees);
    for (PictureAxis* axis : {&figure.request.abscissa, &figure.request.ordinate})
      for (AxisPoint& point : axis->points) point.place = turned(point.place, sheet, degrees);
    const PixelBox a = *figure.request.area;
    figure.request.area = PixelBox{a.left - 10, a.top - 10, a.right + 10, a.bottom + 10};
  }
  if (how == Spoilt::compression || all) figure.image = compressed(blurred(figure.image, 0.7), 12.0);
  if (how == Spoilt::noise || all) figure.image = with_noise(figure.image, 8.0);
  return figure;
}

class RoundTrip : public testing::TestWithParam<std::tuple<Figure (*)(), Spoilt>> {};

TEST_P(RoundTrip, MissesByWhatIsStated) {
  const auto [draw, how] = GetParam();
  const Figure figure = spoilt(draw(), how);
  const std::vector<Misses> misses = read_by_ten(figure);
  for (std::size_t i = 0; i < misses.size(); ++i) {
    SCOPED_TRACE(figure.drawn[i].name);
    // Ten persons share what their clicks do to the whole curve: their share beyond two, 5 % if all were
    // independent, and the root mean square, 1, scatter accordingly.
    EXPECT_GE(misses[i].share_within_two(), 0.9);
    EXPECT_LE(misses[i].rms(), 1.5);
    EXPECT_GE(misses[i].rms(), 0.3) << "the uncertainty is exaggerated";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Digitiser, RoundTrip,
    testing::Combine(testing::Values(&lines_figure, &logarithmic_figure, &markers_figure),
                     testing::Values(Spoilt::not_at_all, Spoilt::noise, Spoilt::compression, Spoilt::turn,
                                     Spoilt::everything)));

TEST(RoundTrip, TheWholeOfEveryCurveIsRead) {
  for (const auto draw : {&lines_figure, &logarithmic_figure, &markers_figure})
    for (const Spoilt how : {Spoilt::not_at_all, Spoilt::everything}) {
      const Figure figure = spoilt(draw(), how);
      const std::vector<DigitisedSeries> series = digitise(figure.image, figure.request);
      for (std::size_t i = 0; i < series.size(); ++i) {
        const Drawn& drawn = figure.drawn[i];
        SCOPED_TRACE(series[i].name);
        if (figure.request.series[i].drawing != Drawing::line) {
          EXPECT_EQ(series[i].points.size(), static_cast<std::size_t>(drawn.places));
          continue;
        }
        EXPECT_EQ(series[i].points.size(), 100U);
        const PictureAxis& axis = figure.request.abscissa;
        const double range = measure(axis, axis.points[1].value) - measure(axis, axis.points[0].value);
        // A dashed line may end in a gap.
        EXPECT_NEAR(measure(axis, series[i].points.front().value.abscissa), measure(axis, drawn.from),
                    0.02 * range);
        EXPECT_NEAR(measure(axis, series[i].points.back().value.abscissa), measure(axis, drawn.to),
                    0.02 * range);
      }
    }
}

TEST(RoundTrip, ACleanPictureIsReadToAThousandthOfItsAxes) {
  const Figure figure = lines_figure();
  for (const DigitisedSeries& series : digitise(figure.image, figure.request)) {
    SCOPED_TRACE(series.name);
    EXPECT_LT(series.uncertainty.abscissa, 0.002 * 25.0);
    EXPECT_LT(series.uncertainty.ordinate, 0.002 * 15.0);
    EXPECT_NEAR(series.thickness, 4.0, 0.7) << "1.2 pt at 240 dots an inch";
  }
}

}  // namespace
}  // namespace mpm::vv
