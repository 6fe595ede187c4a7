#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace mpm::vv {

/// A picture that cannot be read, for a person; names the file.
class ImageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A colour as a screen shows it: non-linear sRGB, 0 to 255.
struct Rgb {
  std::uint8_t red = 0, green = 0, blue = 0;
  bool operator==(const Rgb&) const = default;
};

/// `#d62728`.
std::string text_of(const Rgb& colour);

/// Pixels row by row from the top.
struct RasterImage {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;  ///< width x height

  bool contains(int x, int y) const { return x >= 0 && x < width && y >= 0 && y < height; }
  const Rgb& at(int x, int y) const { return pixels[index(x, y)]; }
  Rgb& at(int x, int y) { return pixels[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// Reads a PNG of any kind; what is transparent shows white. Throws ImageError for a file that is not there
/// or is no PNG, and for a picture of more than 10^8 pixels.
RasterImage read_png(const std::filesystem::path& file);

/// The picture as a PNG file's bytes. Throws ImageError.
std::string png_of(const RasterImage& image);

}  // namespace mpm::vv
