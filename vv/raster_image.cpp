#include "vv/raster_image.hpp"

#include <fmt/format.h>
#include <png.h>

#include <fstream>
#include <iterator>

namespace mpm::vv {
namespace {

constexpr std::size_t most_pixels = 100'000'000;

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream.is_open() || stream.bad()) throw ImageError(file.string() + ": cannot be read");
  return bytes;
}

static_assert(sizeof(Rgb) == 3, "rows of pixels are handed to libpng as bytes");

/// A libpng image with its resources.
struct PngImage {
  png_image image{};
  PngImage() { image.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&image); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

}  // namespace

std::string text_of(const Rgb& colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

RasterImage read_png(const std::filesystem::path& file) {
  const std::string bytes = bytes_of(file);
  PngImage png;
  if (!png_image_begin_read_from_memory(&png.image, bytes.data(), bytes.size()))
    throw ImageError(fmt::format("{}: not a PNG picture ({})", file.string(), png.image.message));
  const std::size_t count = static_cast<std::size_t>(png.image.width) * png.image.height;
  if (count > most_pixels)
    throw ImageError(fmt::format("{}: a picture of {} pixels, too large", file.string(), count));
  RasterImage image{static_cast<int>(png.image.width), static_cast<int>(png.image.height),
                    std::vector<Rgb>(count)};
  png.image.format = PNG_FORMAT_RGB;
  const png_color white{255, 255, 255};
  if (!png_image_finish_read(&png.image, &white, image.pixels.data(), 0, nullptr))
    throw ImageError(fmt::format("{}: a damaged PNG picture ({})", file.string(), png.image.message));
  return image;
}

std::string png_of(const RasterImage& image) {
  PngImage png;
  png.image.width = static_cast<png_uint_32>(image.width);
  png.image.height = static_cast<png_uint_32>(image.height);
  png.image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  const auto encode = [&](void* memory) {
    if (!png_image_write_to_memory(&png.image, memory, &size, 0, image.pixels.data(), 0, nullptr))
      throw ImageError(std::string("the picture cannot be written: ") + png.image.message);
  };
  encode(nullptr);
  std::string bytes(size, '\0');
  encode(bytes.data());
  bytes.resize(size);
  return bytes;
}

}  // namespace mpm::vv
