#include "vv/digitiser.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace mpm::vv {
namespace {

constexpr double crossing_curve = 10.0;  // [px]; what a curve that runs across covers of another, at least
constexpr double raster_uncertainty = 0.28867513459481287;  // 1/sqrt(12) [px]

PictureRegion region_of(const RasterImage& image, const DigitiseRequest& request) {
  const PixelBox whole{0, 0, image.width - 1, image.height - 1};
  const PixelBox area = request.area.value_or(whole);
  return {{std::max(area.left, 0), std::max(area.top, 0), std::min(area.right, whole.right),
           std::min(area.bottom, whole.bottom)},
          request.holes};
}

/// `series "exp" is ambiguous: ` and why.
DigitiseError ambiguous(const SeriesRequest& series, const std::string& why) {
  return DigitiseError(
      fmt::format("series \"{}\" ({}) is ambiguous: {}", series.name, text_of(series.colour), why));
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Standard deviation of what is mostly normal: a few values that are far off, at corners and crossings, do
/// not count.
double robust_spread(std::vector<double> values) {
  const double centre = median(values);
  for (double& value : values) value = std::abs(value - centre);
  return 1.4826 * median(std::move(values));
}

/// `100, 200 px`, for messages.
std::string text_of(PixelPlace place) { return fmt::format("{:.0f}, {:.0f} px", place.x, place.y); }

// ---- lines ----

/// Consecutive inked rows of a column, borders included.
struct Run {
  int bottom = 0, top = 0;
};

/// What a line shows in one column of the ink map.
struct Crossing {
  int column = 0;
  double row = 0.0;        ///< centre of the ink
  double thickness = 0.0;  ///< along the column [px]
  double slope = 0.0;      ///< rows a column, of the line around here
  double width() const { return thickness / std::hypot(1.0, slope); }  ///< across the line
};

std::vector<Run> runs_of(const InkMap& map, int column) {
  std::vector<Run> runs;
  for (int row = 0; row < map.rows; ++row) {
    if (!map.has_ink(column, row)) continue;
    if (runs.empty() || row > runs.back().top + 2)  // a single cell without ink is noise
      runs.push_back({row, row});
    else
      runs.back().top = row;
  }
  return runs;
}

/// Centre and thickness of a run, its faint rim included.
Crossing crossing_of(const InkMap& map, int column, const Run& run) {
  double sum = 0.0, moment = 0.0;
  for (int row = std::max(0, run.bottom - 1); row <= std::min(map.rows - 1, run.top + 1); ++row) {
    const double share = map.share[map.index(column, row)];
    sum += share;
    moment += share * row;
  }
  return {column, moment / sum, sum, 0.0};
}

/// A column in which a line shows more than once.
struct Doubtful {
  int column = 0;
  std::vector<Run> runs;
};

/// Whether a column is part of a steep stretch in pieces: it lies between the crossings to its left and
/// right, upwards as well, or just before the first crossing or after the last, where lines begin steeply.
bool is_steep_stretch(const Doubtful& doubtful, const std::vector<Crossing>& line, double width) {
  const auto right = std::lower_bound(line.begin(), line.end(), doubtful.column,
                                      [](const Crossing& c, int column) { return c.column < column; });
  if (right == line.begin()) return !line.empty() && right->column - doubtful.column <= 4.0 * width;
  const Crossing& left = *(right - 1);
  if (right == line.end()) return doubtful.column - left.column <= 4.0 * width;
  const double slack = 2.0 * width;
  return doubtful.runs.front().bottom >= std::min(left.row, right->row) - slack &&
         doubtful.runs.back().top <= std::max(left.row, right->row) + slack;
}

/// Settles the doubtful columns: they are left out where the line is steep, and an error anywhere else.
void check_doubtful(const std::vector<Doubtful>& doubtful, const std::vector<Crossing>& line, double width,
                    const InkMap& map, const PictureAxes& axes, const SeriesRequest& series) {
  for (const Doubtful& each : doubtful) {
    if (is_steep_stretch(each, line, width)) continue;
    const auto place = [&](const Run& run) {
      return text_of(axes.place_at(map.along(each.column, (run.bottom + run.top) / 2.0)));
    };
    throw ambiguous(
        series, fmt::format("at {} = {:.4g} it is both at {} and at {}; leave a legend or another curve out "
                            "with --area or --except",
                            axes.abscissa().name,
                            axes.values(axes.place_at(map.along(each.column, each.runs[0].bottom))).abscissa,
                            place(each.runs[0]), place(each.runs[1])));
  }
}

/// The polynomial of second degree nearest to the rows of crossings `first` to `last`, about the column of
/// `centre`.
Eigen::Vector3d parabola(const std::vector<Crossing>& line, std::size_t first, std::size_t last,
                         std::size_t centre) {
  const auto count = static_cast<Eigen::Index>(last - first + 1);
  Eigen::MatrixX3d powers(count, 3);
  Eigen::VectorXd rows(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Crossing& crossing = line[first + static_cast<std::size_t>(i)];
    const double x = crossing.column - line[centre].column;
    powers.row(i) << 1.0, x, x * x;
    rows(i) = crossing.row;
  }
  return powers.colPivHouseholderQr().solve(rows);
}

/// The slope of the line at each crossing, and the residuals across the line against a smooth curve.
std::vector<double> smooth(std::vector<Crossing>& line, double width) {
  const auto half_window = static_cast<std::size_t>(std::max(6.0, 2.0 * width));
  std::vector<double> residuals;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const std::size_t first = i > half_window ? i - half_window : 0,
                      last = std::min(line.size() - 1, i + half_window);
    if (last - first < 3) continue;
    const Eigen::Vector3d fit = parabola(line, first, last, i);
    line[i].slope = fit(1);
    const auto count = static_cast<double>(last - first + 1);
    residuals.push_back((line[i].row - fit(0)) / std::hypot(1.0, fit(1)) * std::sqrt(count / (count - 3.0)));
  }
  return residuals;
}

/// A column with less ink than the line is wide is the end of a stroke or half hidden: its centre is not the
/// line's.
void drop_thin(std::vector<Crossing>& line) {
  constexpr double whole = 0.8;  // of the typical width; noise takes less away
  std::vector<double> widths;
  for (const Crossing& crossing : line) widths.push_back(crossing.width());
  const double typical = median(std::move(widths));
  std::erase_if(line, [&](const Crossing& crossing) { return crossing.width() < whole * typical; });
}

/// A few columns far from the rest are no part of the line: where other inks and the axes meet, colours
/// arise.
void drop_strays(std::vector<Crossing>& line, double longest_gap, double width) {
  std::vector<Crossing> kept;
  for (auto first = line.begin(); first != line.end();) {
    const auto gap = std::adjacent_find(first, line.end(), [&](const Crossing& a, const Crossing& b) {
      return b.column - a.column - 1 > longest_gap;
    });
    const auto end = gap == line.end() ? gap : gap + 1;
    if (static_cast<double>(end - first) > 2.0 * width) kept.insert(kept.end(), first, end);
    first = end;
  }
  line = std::move(kept);
}

void check_gaps(const std::vector<Crossing>& line, double longest, const InkMap& map, const PictureAxes& axes,
                const SeriesRequest& series) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const int gap = line[i + 1].column - line[i].column - 1;
    if (gap <= longest) continue;
    const auto place = [&](const Crossing& c) { return text_of(axes.place_at(map.along(c.column, c.row))); };
    throw ambiguous(
        series,
        fmt::format("it is interrupted over {} px, from {} to {}; leave out what is not the curve with "
                    "--area or --except, or allow the gap with --gap",
                    gap, place(line[i]), place(line[i + 1])));
  }
}

/// At most `most` crossings, evenly along the line, its ends among them.
std::vector<Crossing> thinned(const std::vector<Crossing>& line, std::size_t most) {
  if (line.size() <= most) return line;
  std::vector<double> length(line.size(), 0.0);
  for (std::size_t i = 1; i < line.size(); ++i)
    length[i] =
        length[i - 1] + std::hypot(line[i].column - line[i - 1].column, line[i].row - line[i - 1].row);
  std::vector<Crossing> kept;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double wanted = length.back() * static_cast<double>(kept.size()) / static_cast<double>(most - 1);
    if (length[i] >= wanted || i + 1 == line.size()) kept.push_back(line[i]);
  }
  return kept;
}

/// Centres read off an ink map, and how well.
struct Picked {
  std::vector<AxisPair> along;  ///< the axes [px]
  double picking = 0.0, thickness = 0.0;
};

Picked pick_line(InkMap& map, const PictureAxes& axes, const DigitiseRequest& request,
                 const SeriesRequest& series) {
  const double width = stroke_width(map);
  bridge_crossings(map, static_cast<int>(std::max(crossing_curve, 2.0 * width)));
  drop_specks(map, std::max(3.0, 0.7 * width * width));
  fill_holes(map, 6.0 * width);  // open markers on the line

  std::vector<Crossing> line;
  std::vector<Doubtful> doubtful;
  for (int column = 0; column < map.columns; ++column) {
    const std::vector<Run> runs = runs_of(map, column);
    if (runs.size() == 1) line.push_back(crossing_of(map, column, runs[0]));
    if (runs.size() > 1) doubtful.push_back({column, runs});
  }
  check_doubtful(doubtful, line, width, map, axes, series);
  const AxisPair start = axes.along(axes.abscissa().points[0].place),
                 end = axes.along(axes.abscissa().points[1].place);
  const double longest_gap = request.longest_gap.value_or(std::abs(end.abscissa - start.abscissa) / 16.0);
  smooth(line, width);
  drop_thin(line);
  drop_strays(line, longest_gap, width);
  check_gaps(line, longest_gap, map, axes, series);
  const std::vector<double> residuals = smooth(line, width);

  Picked picked;
  std::vector<double> widths;
  for (const Crossing& crossing : line) widths.push_back(crossing.width());
  picked.thickness = median(widths);
  picked.picking = std::hypot(robust_spread(residuals), robust_spread(widths) / 2.0, raster_uncertainty);
  for (const Crossing& crossing : thinned(line, static_cast<std::size_t>(request.most_points)))
    picked.along.push_back(map.along(crossing.column, crossing.row));
  return picked;
}

// ---- markers ----

AxisPair centre_of(const InkMap& map, const std::vector<std::pair<int, int>>& cells) {
  double sum = 0.0, column = 0.0, row = 0.0;
  for (const auto& [c, r] : cells) {
    const double share = map.share[map.index(c, r)];
    sum += share;
    column += share * c;
    row += share * r;
  }
  return map.along(column / sum, row / sum);
}

/// Markers that touch but do not hide each other, told apart by nearness to centres that settle (k-means,
/// begun with centres evenly from one end to the other).
std::vector<AxisPair> split(const InkMap& map, const Blob& blob, std::size_t count) {
  std::vector<std::pair<int, int>> cells = blob.cells;
  const bool wide = blob.width() >= blob.height();
  std::sort(cells.begin(), cells.end(), [&](const auto& a, const auto& b) {
    return wide ? a < b : std::pair(a.second, a.first) < std::pair(b.second, b.first);
  });
  std::vector<AxisPair> centres;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [c, r] = cells[(2 * i + 1) * cells.size() / (2 * count)];
    centres.push_back(map.along(c, r));
  }
  for (int pass = 0; pass < 50; ++pass) {
    std::vector<std::vector<std::pair<int, int>>> parts(count);
    for (const auto& cell : cells) {
      const AxisPair at = map.along(cell.first, cell.second);
      const auto distance = [&](const AxisPair& c) {
        return std::hypot(c.abscissa - at.abscissa, c.ordinate - at.ordinate);
      };
      const auto nearest =
          std::min_element(centres.begin(), centres.end(),
                           [&](const AxisPair& a, const AxisPair& b) { return distance(a) < distance(b); });
      parts[static_cast<std::size_t>(nearest - centres.begin())].push_back(cell);
    }
    for (std::size_t i = 0; i < count; ++i)
      if (!parts[i].empty()) centres[i] = centre_of(map, parts[i]);
  }
  return centres;
}

/// A mark as large and where its convex hull is.
struct Hull {
  double area = 0.0;  ///< [px^2], of the pixels around its corners as well
  AxisPair centre;
};

Hull hull_of(const InkMap& map, const Blob& blob) {
  using Cell = std::pair<int, int>;
  std::vector<Cell> cells = blob.cells, corners;
  std::sort(cells.begin(), cells.end());
  const auto turn = [](const Cell& a, const Cell& b, const Cell& c) {
    return (b.first - a.first) * (c.second - a.second) - (b.second - a.second) * (c.first - a.first);
  };
  for (int side = 0; side < 2; ++side) {  // below, then above
    const std::size_t start = corners.size();
    for (const Cell& cell : cells) {
      while (corners.size() >= start + 2 && turn(corners.end()[-2], corners.back(), cell) <= 0)
        corners.pop_back();
      corners.push_back(cell);
    }
    corners.pop_back();
    std::reverse(cells.begin(), cells.end());
  }
  double twice = 0.0, column = 0.0, row = 0.0, edge = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Cell a = corners[i], b = corners[(i + 1) % corners.size()];
    const double part = static_cast<double>(a.first) * b.second - static_cast<double>(b.first) * a.second;
    twice += part;
    column += part * (a.first + b.first) / 3.0;
    row += part * (a.second + b.second) / 3.0;
    edge += std::hypot(a.first - b.first, a.second - b.second);
  }
  if (twice <= 0.0) return {edge, centre_of(map, blob.cells)};
  return {twice / 2.0 + edge / 2.0 + 1.0, map.along(column / twice, row / twice)};
}

/// Area of a typical mark; specks do not count.
double typical_area(const std::vector<Blob>& blobs) {
  std::vector<double> areas;
  for (const Blob& blob : blobs) areas.push_back(static_cast<double>(blob.cells.size()));
  const double largest = areas.empty() ? 0.0 : *std::max_element(areas.begin(), areas.end());
  std::erase_if(areas, [&](double area) { return area < 0.1 * largest; });
  return median(areas);
}

/// The centres of the markers that one mark consists of. A marker of which a crossing curve hides a part is
/// as large as its hull; where more is missing, or more there than markers that touch, the series is
/// ambiguous.
std::vector<AxisPair> centres_in(const InkMap& map, const Blob& blob, double typical, const PictureAxes& axes,
                                 const SeriesRequest& series) {
  constexpr double most_off = 0.25;  // of a marker's area: noise and bridged crossings change it by less
  const auto area = static_cast<double>(blob.cells.size());
  const double count = std::max(1.0, std::round(area / typical));
  if (std::abs(area / typical - count) < most_off && area > 0.9 * count * typical)
    return split(map, blob, static_cast<std::size_t>(count));
  const Hull hull = hull_of(map, blob);
  if (std::abs(hull.area / typical - 1.0) < most_off) return {hull.centre};
  throw ambiguous(
      series,
      fmt::format(
          "near {} there is a mark of {:.0f} px where a marker has {:.0f}: markers that hide each other, or "
          "something else; leave it out with --except",
          text_of(axes.place_at(centre_of(map, blob.cells))), area, typical));
}

Picked pick_markers(InkMap& map, const PictureAxes& axes, const SeriesRequest& series) {
  const double stroke = stroke_width(map);
  bridge_crossings(map, static_cast<int>(std::max(crossing_curve, 0.5 * stroke)));
  fill_holes(map, 12.0 * std::max(2.0, stroke));
  // Half the width of the joining line and a pixel for its soft edge; markers are thicker.
  if (series.drawing == Drawing::joined_markers)
    keep_thick(map, static_cast<int>(std::ceil(stroke / 2.0)) + 1);

  const std::vector<Blob> blobs = blobs_of(map);
  const double typical = typical_area(blobs);
  Picked picked;
  std::vector<double> diameters;
  for (const Blob& blob : blobs) {
    const auto area = static_cast<double>(blob.cells.size());
    if (area < 0.3 * typical) continue;  // a speck
    const std::vector<AxisPair> centres = centres_in(map, blob, typical, axes, series);
    picked.along.insert(picked.along.end(), centres.begin(), centres.end());
    if (centres.size() == 1) diameters.push_back(2.0 * std::sqrt(area / std::numbers::pi));
  }
  std::sort(picked.along.begin(), picked.along.end(),
            [](const AxisPair& a, const AxisPair& b) { return a.abscissa < b.abscissa; });
  picked.thickness = median(diameters);
  picked.picking = std::hypot(robust_spread(diameters) / 2.0, raster_uncertainty);
  return picked;
}

// ---- a series ----

DigitisedSeries finished(const Picked& picked, const PictureAxes& axes, const DigitiseRequest& request,
                         const std::string& name) {
  DigitisedSeries series{name, {}, {}, {}, picked.picking, picked.thickness};
  AxisPair variance;
  std::vector<DigitisedPoint>& points = series.points;
  for (const AxisPair& along : picked.along) {
    const PixelPlace place = axes.place_at(along);
    points.push_back({place, axes.values(place)});
    const AxisPair u = axes.uncertainty(place, request.click_uncertainty);
    variance.abscissa += u.abscissa * u.abscissa / static_cast<double>(picked.along.size());
    variance.ordinate += u.ordinate * u.ordinate / static_cast<double>(picked.along.size());
  }
  const AxisPair pixel = axes.worth_of_a_pixel();
  series.click_part = {std::sqrt(variance.abscissa), std::sqrt(variance.ordinate)};
  series.uncertainty = {std::hypot(series.click_part.abscissa, picked.picking * pixel.abscissa),
                        std::hypot(series.click_part.ordinate, picked.picking * pixel.ordinate)};
  if (points.size() > 1 && points.front().value.abscissa > points.back().value.abscissa)
    std::reverse(points.begin(), points.end());
  return series;
}

DigitisedSeries read_series(const RasterImage& image, const PictureAxes& axes, const DigitiseRequest& request,
                            std::size_t which) {
  std::vector<Rgb> colours;
  for (const SeriesRequest& each : request.series) colours.push_back(each.colour);
  const SeriesRequest& series = request.series[which];
  const PictureRegion region = region_of(image, request);
  InkMap map = map_ink(image, axes, region, colours, which, request.tolerance);
  const Picked picked = series.drawing == Drawing::line ? pick_line(map, axes, request, series)
                                                        : pick_markers(map, axes, series);
  if (!picked.along.empty()) return finished(picked, axes, request, series.name);
  std::string others;
  for (const Rgb& ink : inks_nearest_to(series.colour, image, region, 3))
    others += (others.empty() ? "" : ", ") + text_of(ink);
  throw DigitiseError(
      fmt::format("series \"{}\": no ink of the colour {} there; {}", series.name, text_of(series.colour),
                  others.empty() ? "there is no ink at all" : "the nearest colours are " + others));
}

// ---- checks ----

void check_points_inside(const RasterImage& image, const PictureAxis& axis) {
  for (const AxisPoint& point : axis.points)
    if (!(point.place.x >= -0.5 && point.place.x <= image.width - 0.5 && point.place.y >= -0.5 &&
          point.place.y <= image.height - 0.5))
      throw DigitiseError(fmt::format("axis {}: the point {} lies outside the picture of {} x {} px",
                                      axis.name, text_of(point.place), image.width, image.height));
}

void check_colours(const RasterImage& image, const DigitiseRequest& request) {
  constexpr double least_difference = 0.02;  // less than the noise of a scan
  const Rgb paper = paper_colour(image, region_of(image, request));
  for (std::size_t i = 0; i < request.series.size(); ++i) {
    const SeriesRequest& one = request.series[i];
    if (colour_distance(one.colour, paper) < least_difference)
      throw DigitiseError(
          fmt::format("series \"{}\" has the colour of the paper, {}", one.name, text_of(paper)));
    for (std::size_t k = 0; k < i; ++k)
      if (colour_distance(one.colour, request.series[k].colour) < least_difference)
        throw DigitiseError(fmt::format("series \"{}\" and \"{}\" have the same colour {}",
                                        request.series[k].name, one.name, text_of(one.colour)));
  }
}

// ---- preview ----

const Rgb picked_colour{255, 0, 255}, axis_colour{0, 160, 0}, hole_colour{220, 0, 0};

void dot(RasterImage& image, double x, double y, const Rgb& colour) {
  const int column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
  if (image.contains(column, row)) image.at(column, row) = colour;
}

void draw_cross(RasterImage& image, PixelPlace at, int arm, const Rgb& colour) {
  for (int k = -arm; k <= arm; ++k) {
    dot(image, at.x + k, at.y, colour);
    dot(image, at.x, at.y + k, colour);
  }
}

void draw_circle(RasterImage& image, PixelPlace at, double radius, const Rgb& colour) {
  for (double angle = 0.0; angle < 6.3; angle += 0.5 / radius)
    dot(image, at.x + radius * std::cos(angle), at.y + radius * std::sin(angle), colour);
}

void draw_box(RasterImage& image, const PixelBox& box, const Rgb& colour) {
  for (int x = box.left; x <= box.right; ++x)
    for (const int y : {box.top, box.bottom}) dot(image, x, y, colour);
  for (int y = box.top; y <= box.bottom; ++y)
    for (const int x : {box.left, box.right}) dot(image, x, y, colour);
}

}  // namespace

std::vector<DigitisedSeries> digitise(const RasterImage& image, const DigitiseRequest& request) {
  for (const PictureAxis& axis : {request.abscissa, request.ordinate}) check_points_inside(image, axis);
  const PictureAxes axes(request.abscissa, request.ordinate);
  check_colours(image, request);
  std::vector<DigitisedSeries> all;
  for (std::size_t i = 0; i < request.series.size(); ++i) all.push_back(read_series(image, axes, request, i));
  return all;
}

RasterImage preview_of(const RasterImage& image, const DigitiseRequest& request,
                       const std::vector<DigitisedSeries>& series) {
  RasterImage result = image;
  for (Rgb& pixel : result.pixels)
    for (std::uint8_t Rgb::*part : {&Rgb::red, &Rgb::green, &Rgb::blue})
      pixel.*part = static_cast<std::uint8_t>(128 + pixel.*part / 2);
  if (request.area) draw_box(result, *request.area, axis_colour);
  for (const PixelBox& hole : request.holes) draw_box(result, hole, hole_colour);
  for (const PictureAxis& axis : {request.abscissa, request.ordinate})
    for (const AxisPoint& point : axis.points) {
      draw_cross(result, point.place, 8, axis_colour);
      draw_circle(result, point.place, 6.0, axis_colour);
    }
  for (const DigitisedSeries& each : series)
    for (const DigitisedPoint& point : each.points) draw_cross(result, point.place, 3, picked_colour);
  return result;
}

}  // namespace mpm::vv
