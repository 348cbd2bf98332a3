#include "core/output/pictures/png_layers.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"

namespace cgcontact {

namespace {

using Bytes = std::vector<std::uint8_t>;

/// Picture of libpng, which frees what it holds.
class Png {
 public:
  explicit Png(std::string file) : file_(std::move(file)) {
    std::memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
  }
  ~Png() { png_image_free(&image); }
  Png(const Png&) = delete;
  Png& operator=(const Png&) = delete;

  void check(int success) const {
    if (!success) throw InputError(fmt::format("{}: {}", file_, image.message));
  }

  png_image image;

 private:
  std::string file_;
};

/// Reads red, green, blue, alpha, by row from the top.
Bytes read_png(const std::string& file, int& width, int& height) {
  Png png(file);
  png.check(png_image_begin_read_from_file(&png.image, file.c_str()));
  png.image.format = PNG_FORMAT_RGBA;
  Bytes pixels(PNG_IMAGE_SIZE(png.image));
  png.check(png_image_finish_read(&png.image, nullptr, pixels.data(), 0, nullptr));
  width = static_cast<int>(png.image.width);
  height = static_cast<int>(png.image.height);
  return pixels;
}

/// Writes red, green, blue, by row from the top.
void write_png(const std::string& file, const Bytes& pixels, int width, int height) {
  Png png(file);
  png.image.width = width;
  png.image.height = height;
  png.image.format = PNG_FORMAT_RGB;
  png.check(png_image_write_to_file(&png.image, file.c_str(), 0, pixels.data(), 0, nullptr));
}

/// Copies a layer to a page of red, green, blue.
void copy(const PixelLayer& layer, Bytes& page, int width, int height) {
  const std::string pixels = read_text(layer.file);
  if (pixels.size() < std::size_t{3} * layer.width * layer.height)
    throw InputError(
        fmt::format("{}: {} bytes, fewer than {} x {} pixels", layer.file, pixels.size(), layer.width, layer.height));
  const int left = static_cast<int>(std::lround(layer.left)), bottom = static_cast<int>(std::lround(layer.bottom));
  const int first = std::max(0, -left), last = std::min(layer.width, width - left);
  for (int row = 0; row < layer.height; ++row) {
    const int y = height - 1 - bottom - row;
    if (y < 0 || y >= height || first >= last) continue;
    std::memcpy(&page[3 * (static_cast<std::size_t>(y) * width + left + first)],
                &pixels[3 * (static_cast<std::size_t>(row) * layer.width + first)], std::size_t{3} * (last - first));
  }
}

}  // namespace

void lay_below(const std::string& png, const std::vector<PixelLayer>& layers) {
  int width = 0, height = 0;
  const Bytes drawn = read_png(png, width, height);
  Bytes page(std::size_t{3} * width * height, 255);
  for (const PixelLayer& layer : layers) copy(layer, page, width, height);
  for (std::size_t k = 0; k < page.size() / 3; ++k) {
    const std::uint8_t* const above = &drawn[4 * k];
    const int alpha = above[3];
    if (alpha == 0) continue;
    for (int c = 0; c < 3; ++c)
      page[3 * k + c] = static_cast<std::uint8_t>((above[c] * alpha + page[3 * k + c] * (255 - alpha) + 127) / 255);
  }
  write_png(png, page, width, height);
}

}  // namespace cgcontact
