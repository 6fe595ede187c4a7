#include "vv/ink_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace mpm::vv {
namespace {

using Vec = std::array<double, 3>;  // red, green, blue in 0 to 1

constexpr double ink_floor =
    0.3;  // less ink than this is noise, a shadow of the printing or a faint grid line
constexpr double trace_floor = 0.08;  // less than this is paper: what scanning and compressing leave behind
constexpr double most_ink = 1.35;     // more is another, darker ink

Vec vec(const Rgb& c) { return {c.red / 255.0, c.green / 255.0, c.blue / 255.0}; }
Vec operator-(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double norm(const Vec& a) { return std::sqrt(dot(a, a)); }

template <class Visit>
void for_each_pixel(const RasterImage& image, const PictureRegion& region, Visit visit) {
  const PixelBox& area = region.area;
  for (int y = std::max(0, area.top); y <= std::min(image.height - 1, area.bottom); ++y)
    for (int x = std::max(0, area.left); x <= std::min(image.width - 1, area.right); ++x)
      if (region.contains({static_cast<double>(x), static_cast<double>(y)})) visit(image.at(x, y));
}

/// Pixels of nearly one colour.
struct ColourBin {
  long count = 0;
  std::array<long, 3> sum{};

  Rgb mean() const {
    const auto part = [&](std::size_t i) { return static_cast<std::uint8_t>((sum[i] + count / 2) / count); };
    return {part(0), part(1), part(2)};
  }
};

/// The colours of a region, in bins of 1/16 of each channel.
std::vector<ColourBin> histogram(const RasterImage& image, const PictureRegion& region) {
  std::map<int, ColourBin> bins;
  for_each_pixel(image, region, [&](const Rgb& c) {
    ColourBin& bin = bins[(c.red / 16) * 256 + (c.green / 16) * 16 + c.blue / 16];
    ++bin.count;
    bin.sum[0] += c.red;
    bin.sum[1] += c.green;
    bin.sum[2] += c.blue;
  });
  std::vector<ColourBin> all;
  for (const auto& [key, bin] : bins) all.push_back(bin);
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.count > b.count; });
  return all;
}

/// A pixel as a mixture of paper and one ink.
struct Mixture {
  double share = 0.0;   ///< of ink; 1 is pure ink, 0 paper
  double misfit = 0.0;  ///< distance from the nearest mixture, relative to the difference of ink and paper
};

Mixture mixture(const Vec& from_paper, const Vec& ink_from_paper) {
  const double share = dot(from_paper, ink_from_paper) / dot(ink_from_paper, ink_from_paper);
  const Vec off = {from_paper[0] - share * ink_from_paper[0], from_paper[1] - share * ink_from_paper[1],
                   from_paper[2] - share * ink_from_paper[2]};
  return {share, norm(off) / norm(ink_from_paper)};
}

/// The share of one colour's ink at every pixel, and where there is foreign ink.
class InkReader {
 public:
  InkReader(std::span<const Rgb> colours, std::size_t which, const Rgb& paper, double tolerance)
      : paper_(vec(paper)), which_(which), tolerance_(tolerance) {
    for (const Rgb& colour : colours) inks_.push_back(vec(colour) - paper_);
    // Axes and letters are black, and compressing tinges them; black need not be asked for to be told from a
    // colour.
    const bool asked_for = std::any_of(colours.begin(), colours.end(),
                                       [](const Rgb& c) { return colour_distance(c, {}) < 0.25; });
    if (!asked_for) inks_.push_back(vec(Rgb{}) - paper_);
  }

  double share(const Rgb& pixel) const {
    const Vec from_paper = vec(pixel) - paper_;
    const Mixture own = mixture(from_paper, inks_[which_]);
    // Faint mixtures may be off by a quarter of the tolerance, whatever their share: noise is not.
    if (own.share < trace_floor || own.share > most_ink ||
        own.misfit > tolerance_ * (0.25 + 0.75 * own.share))
      return 0.0;
    for (std::size_t i = 0; i < inks_.size(); ++i)
      if (i != which_ && distance(from_paper, i) < distance(from_paper, which_)) return 0.0;
    return std::min(1.0, own.share);
  }

  bool is_paper(const Rgb& pixel) const { return norm(vec(pixel) - paper_) < ink_floor; }

 private:
  /// From the nearest colour between paper and an ink.
  double distance(const Vec& from_paper, std::size_t ink) const {
    const Mixture m = mixture(from_paper, inks_[ink]);
    return std::hypot(m.misfit, std::max(0.0, m.share - 1.0)) * norm(inks_[ink]);
  }

  Vec paper_;
  std::vector<Vec> inks_;
  std::size_t which_;
  double tolerance_;
};

/// A raster that covers an area, still empty.
InkMap map_over(const PixelBox& area, const PictureAxes& axes) {
  AxisPair low{1e300, 1e300}, high{-1e300, -1e300};
  for (const int x : {area.left, area.right})
    for (const int y : {area.top, area.bottom}) {
      const AxisPair corner = axes.along({static_cast<double>(x), static_cast<double>(y)});
      low = {std::min(low.abscissa, corner.abscissa), std::min(low.ordinate, corner.ordinate)};
      high = {std::max(high.abscissa, corner.abscissa), std::max(high.ordinate, corner.ordinate)};
    }
  InkMap map;
  map.first_column = static_cast<int>(std::floor(low.abscissa));
  map.first_row = static_cast<int>(std::floor(low.ordinate));
  map.columns = static_cast<int>(std::ceil(high.abscissa)) - map.first_column + 1;
  map.rows = static_cast<int>(std::ceil(high.ordinate)) - map.first_row + 1;
  const std::size_t cells = static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows);
  map.share.assign(cells, 0.0F);
  map.inked.assign(cells, 0);
  map.foreign.assign(cells, 0);
  return map;
}

/// The mean of a pixel's property over the four pixels around a place, weighted by nearness; 0 outside the
/// picture.
template <class Property>
double interpolated(const RasterImage& image, PixelPlace place, Property property) {
  constexpr double on_a_pixel = 1e-6;  // rounding of the axes' directions must not drag in a neighbour
  const double left = std::floor(place.x + on_a_pixel), top = std::floor(place.y + on_a_pixel);
  double sum = 0.0;
  for (const int i : {0, 1})
    for (const int j : {0, 1}) {
      const double weight = (1.0 - std::abs(place.x - left - i)) * (1.0 - std::abs(place.y - top - j));
      const int x = static_cast<int>(left) + i, y = static_cast<int>(top) + j;
      if (weight > on_a_pixel && image.contains(x, y)) sum += weight * property(x, y);
    }
  return sum;
}

/// Calls `visit` for the blobs of a mask, whatever their size.
template <class Inside, class Visit>
void flood(const InkMap& map, bool with_corners, Inside inside, Visit visit) {
  std::vector<char> seen(map.inked.size(), 0);
  for (int c = 0; c < map.columns; ++c)
    for (int r = 0; r < map.rows; ++r) {
      if (seen[map.index(c, r)] || !inside(c, r)) continue;
      Blob blob{{{c, r}}, c, c, r, r};
      seen[map.index(c, r)] = 1;
      for (std::size_t next = 0; next < blob.cells.size(); ++next) {
        const auto [column, row] = blob.cells[next];
        blob.left = std::min(blob.left, column);
        blob.right = std::max(blob.right, column);
        blob.bottom = std::min(blob.bottom, row);
        blob.top = std::max(blob.top, row);
        for (int i = -1; i <= 1; ++i)
          for (int j = -1; j <= 1; ++j) {
            if (!with_corners && i != 0 && j != 0) continue;
            const int x = column + i, y = row + j;
            if (!map.contains(x, y) || seen[map.index(x, y)] || !inside(x, y)) continue;
            seen[map.index(x, y)] = 1;
            blob.cells.emplace_back(x, y);
          }
      }
      visit(std::move(blob));
    }
}

/// How far ink reaches from a cell that has ink, both ways, along a row or a column.
int run_length(const InkMap& map, int c, int r, int dc, int dr) {
  int length = 1;
  for (int k = 1; map.has_ink(c + k * dc, r + k * dr); ++k) ++length;
  for (int k = 1; map.has_ink(c - k * dc, r - k * dr); ++k) ++length;
  return length;
}

/// Steps from a cell to the nearest ink in one direction, 0 when there is none within `reach`.
int steps_to_ink(const InkMap& map, int c, int r, int dc, int dr, int reach) {
  for (int k = 1; k <= reach; ++k)
    if (map.has_ink(c + k * dc, r + k * dr)) return k;
  return 0;
}

/// The cells from which a disc of `radius` touches what `inside` holds.
template <class Inside>
std::vector<char> dilated(const InkMap& map, int radius, Inside inside) {
  std::vector<char> result(map.inked.size(), 0);
  for (int c = 0; c < map.columns; ++c)
    for (int r = 0; r < map.rows; ++r) {
      if (!inside(c, r)) continue;
      for (int i = -radius; i <= radius; ++i)
        for (int j = -radius; j <= radius; ++j)
          if (i * i + j * j <= radius * radius && map.contains(c + i, r + j))
            result[map.index(c + i, r + j)] = 1;
    }
  return result;
}

}  // namespace

bool PictureRegion::contains(PixelPlace place) const {
  return area.contains(place) &&
         std::none_of(holes.begin(), holes.end(), [&](const PixelBox& hole) { return hole.contains(place); });
}

double colour_distance(const Rgb& a, const Rgb& b) { return norm(vec(a) - vec(b)) / std::sqrt(3.0); }

Rgb paper_colour(const RasterImage& image, const PictureRegion& region) {
  const std::vector<ColourBin> bins = histogram(image, region);
  return bins.empty() ? Rgb{255, 255, 255} : bins.front().mean();
}

std::vector<Rgb> inks_nearest_to(const Rgb& wanted, const RasterImage& image, const PictureRegion& region,
                                 std::size_t most) {
  constexpr long fewest = 20;  // pixels; less is the edge of something
  const Rgb paper = paper_colour(image, region);
  std::vector<Rgb> inks;
  for (const ColourBin& bin : histogram(image, region)) {
    const Vec colour = vec(bin.mean()) - vec(paper);
    // The soft edges of an ink are no further ink.
    const bool shade = std::any_of(inks.begin(), inks.end(), [&](const Rgb& ink) {
      return mixture(colour, vec(ink) - vec(paper)).misfit < 0.15;
    });
    if (bin.count >= fewest && norm(colour) > ink_floor && !shade) inks.push_back(bin.mean());
  }
  std::stable_sort(inks.begin(), inks.end(), [&](const Rgb& a, const Rgb& b) {
    return colour_distance(a, wanted) < colour_distance(b, wanted);
  });
  inks.resize(std::min(inks.size(), most));
  return inks;
}

InkMap map_ink(const RasterImage& image, const PictureAxes& axes, const PictureRegion& region,
               std::span<const Rgb> colours, std::size_t which, double tolerance) {
  const InkReader reader(colours, which, paper_colour(image, region), tolerance);
  InkMap map = map_over(region.area, axes);
  for (int c = 0; c < map.columns; ++c)
    for (int r = 0; r < map.rows; ++r) {
      const PixelPlace place = axes.place_at(map.along(c, r));
      if (!region.contains({std::round(place.x), std::round(place.y)})) continue;
      const double share =
          interpolated(image, place, [&](int x, int y) { return reader.share(image.at(x, y)); });
      const double covered = interpolated(
          image, place, [&](int x, int y) { return reader.is_paper(image.at(x, y)) ? 0.0 : 1.0; });
      const std::size_t at = map.index(c, r);
      map.share[at] = static_cast<float>(share);
      map.inked[at] = share >= ink_floor;
      map.foreign[at] = !map.inked[at] && covered > 0.5;
    }
  return map;
}

std::vector<Blob> blobs_of(const InkMap& map) {
  std::vector<Blob> blobs;
  flood(
      map, true, [&](int c, int r) { return map.has_ink(c, r); },
      [&](Blob&& blob) { blobs.push_back(std::move(blob)); });
  return blobs;
}

double stroke_width(const InkMap& map) {
  std::vector<int> widths;
  for (int c = 0; c < map.columns; ++c)
    for (int r = 0; r < map.rows; ++r)
      if (map.has_ink(c, r))
        widths.push_back(std::min(run_length(map, c, r, 1, 0), run_length(map, c, r, 0, 1)));
  if (widths.empty()) return 0.0;
  const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
  std::nth_element(widths.begin(), middle, widths.end());
  return *middle;
}

void drop_specks(InkMap& map, double least) {
  for (const Blob& blob : blobs_of(map))
    if (static_cast<double>(blob.cells.size()) < least)
      for (const auto& [c, r] : blob.cells) map.inked[map.index(c, r)] = 0;
}

void fill_holes(InkMap& map, double largest) {
  std::vector<Blob> holes;
  flood(
      map, false, [&](int c, int r) { return !map.has_ink(c, r); },
      [&](Blob&& blob) {
        const bool at_the_edge =
            blob.left == 0 || blob.bottom == 0 || blob.right == map.columns - 1 || blob.top == map.rows - 1;
        if (!at_the_edge && blob.width() <= largest && blob.height() <= largest)
          holes.push_back(std::move(blob));
      });
  for (const Blob& hole : holes)
    for (const auto& [c, r] : hole.cells) {
      map.inked[map.index(c, r)] = 1;
      map.share[map.index(c, r)] = 1.0F;
    }
}

void bridge_crossings(InkMap& map, int reach) {
  std::vector<std::size_t> bridged;
  for (int c = 0; c < map.columns; ++c)
    for (int r = 0; r < map.rows; ++r) {
      if (!map.foreign[map.index(c, r)]) continue;
      for (const auto& [dc, dr] : {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}}) {
        const int one = steps_to_ink(map, c, r, dc, dr, reach),
                  other = steps_to_ink(map, c, r, -dc, -dr, reach);
        if (one == 0 || other == 0 || one + other > reach) continue;
        bridged.push_back(map.index(c, r));
        break;
      }
    }
  for (const std::size_t at : bridged) {
    map.inked[at] = 1;
    map.share[at] = 1.0F;
  }
}

void keep_thick(InkMap& map, int radius) {
  const std::vector<char> near_paper = dilated(map, radius, [&](int c, int r) { return !map.has_ink(c, r); });
  map.inked = dilated(map, radius, [&](int c, int r) { return !near_paper[map.index(c, r)]; });
}

}  // namespace mpm::vv
