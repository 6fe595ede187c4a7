#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "vv/picture_axes.hpp"
#include "vv/raster_image.hpp"

/// What printing, scanning and compressing do to a picture.
namespace mpm::tests {

using vv::PixelPlace;
using vv::RasterImage;
using vv::Rgb;

inline constexpr std::array channels{&Rgb::red, &Rgb::green, &Rgb::blue};

inline std::uint8_t channel_of(double value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

/// Every channel of every pixel off by normal noise of standard deviation `sigma`, of 255.
inline RasterImage with_noise(RasterImage image, double sigma, unsigned seed = 1) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> noise(0.0, sigma);
  for (Rgb& pixel : image.pixels)
    for (const auto channel : channels) pixel.*channel = channel_of(pixel.*channel + noise(engine));
  return image;
}

/// A value between pixels, from the four around a place; white outside.
inline double sampled(const RasterImage& image, PixelPlace at, std::uint8_t Rgb::*channel) {
  const int x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
  const auto value = [&](int i, int j) { return image.contains(i, j) ? image.at(i, j).*channel : 255.0; };
  const double s = at.x - x, t = at.y - y;
  return (1 - t) * ((1 - s) * value(x, y) + s * value(x + 1, y)) +
         t * ((1 - s) * value(x, y + 1) + s * value(x + 1, y + 1));
}

/// Where a place ends up when the sheet is turned clockwise about its middle.
inline PixelPlace turned(PixelPlace place, const RasterImage& image, double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0, c = std::cos(angle), s = std::sin(angle);
  const double x = place.x - image.width / 2.0, y = place.y - image.height / 2.0;
  return {image.width / 2.0 + c * x - s * y, image.height / 2.0 + s * x + c * y};
}

/// The sheet turned clockwise about its middle, its corners cut off.
inline RasterImage turned(const RasterImage& image, double degrees) {
  RasterImage result = image;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (const auto channel : channels)
        result.at(x, y).*channel =
            channel_of(sampled(image, turned(PixelPlace{double(x), double(y)}, image, -degrees), channel));
  return result;
}

/// Out of focus: every pixel a mean of its neighbours, with the weights of a normal of `sigma` pixels.
inline RasterImage blurred(const RasterImage& image, double sigma) {
  const int reach = static_cast<int>(std::ceil(3.0 * sigma));
  RasterImage result = image;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (const auto channel : channels) {
        double sum = 0.0, weights = 0.0;
        for (int i = -reach; i <= reach; ++i)
          for (int j = -reach; j <= reach; ++j) {
            if (!image.contains(x + i, y + j)) continue;
            const double weight = std::exp(-(i * i + j * j) / (2.0 * sigma * sigma));
            sum += weight * image.at(x + i, y + j).*channel;
            weights += weight;
          }
        result.at(x, y).*channel = channel_of(sum / weights);
      }
  return result;
}

/// One 8 x 8 block through a discrete cosine transform, its coefficients rounded to steps that grow with the
/// frequency.
inline void quantise(std::array<std::array<double, 8>, 8>& block, double step) {
  static const auto basis = [] {
    std::array<std::array<double, 8>, 8> b{};
    for (std::size_t k = 0; k < 8; ++k)
      for (std::size_t n = 0; n < 8; ++n)
        b[k][n] = std::sqrt((k == 0 ? 1.0 : 2.0) / 8.0) *
                  std::cos(std::numbers::pi * (2.0 * double(n) + 1.0) * double(k) / 16.0);
    return b;
  }();
  std::array<std::array<double, 8>, 8> half{}, spectrum{};
  for (std::size_t k = 0; k < 8; ++k)
    for (std::size_t n = 0; n < 8; ++n)
      for (std::size_t m = 0; m < 8; ++m) half[k][n] += basis[k][m] * block[m][n];
  for (std::size_t k = 0; k < 8; ++k)
    for (std::size_t l = 0; l < 8; ++l) {
      for (std::size_t n = 0; n < 8; ++n) spectrum[k][l] += half[k][n] * basis[l][n];
      const double q = step * (1.0 + 0.5 * double(k + l));
      spectrum[k][l] = q * std::round(spectrum[k][l] / q);
    }
  half = {};
  block = {};
  for (std::size_t m = 0; m < 8; ++m)
    for (std::size_t l = 0; l < 8; ++l)
      for (std::size_t k = 0; k < 8; ++k) half[m][l] += basis[k][m] * spectrum[k][l];
  for (std::size_t m = 0; m < 8; ++m)
    for (std::size_t n = 0; n < 8; ++n)
      for (std::size_t l = 0; l < 8; ++l) block[m][n] += half[m][l] * basis[l][n];
}

/// Compressed with losses as photographs are: brightness and colour apart, by blocks of 8 x 8, colour twice
/// as coarsely.
inline RasterImage compressed(const RasterImage& image, double step) {
  RasterImage result = image;
  for (int top = 0; top < image.height; top += 8)
    for (int left = 0; left < image.width; left += 8) {
      std::array<std::array<std::array<double, 8>, 8>, 3> planes{};
      for (int j = 0; j < 8; ++j)
        for (int i = 0; i < 8; ++i) {
          const Rgb& p = image.at(std::min(left + i, image.width - 1), std::min(top + j, image.height - 1));
          const double y = 0.299 * p.red + 0.587 * p.green + 0.114 * p.blue;
          const auto row = static_cast<std::size_t>(j), column = static_cast<std::size_t>(i);
          planes[0][row][column] = y;
          planes[1][row][column] = (p.blue - y) / 1.772;
          planes[2][row][column] = (p.red - y) / 1.402;
        }
      quantise(planes[0], step);
      quantise(planes[1], 2.0 * step);
      quantise(planes[2], 2.0 * step);
      for (int j = 0; j < 8 && top + j < image.height; ++j)
        for (int i = 0; i < 8 && left + i < image.width; ++i) {
          const auto row = static_cast<std::size_t>(j), column = static_cast<std::size_t>(i);
          const double y = planes[0][row][column];
          const double blue = y + 1.772 * planes[1][row][column], red = y + 1.402 * planes[2][row][column];
          result.at(left + i, top + j) = {
              channel_of(red), channel_of((y - 0.299 * red - 0.114 * blue) / 0.587), channel_of(blue)};
        }
    }
  return result;
}

}  // namespace mpm::tests
