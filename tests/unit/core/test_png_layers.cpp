#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cstring>
#include <vector>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"
#include "core/output/pictures/png_layers.hpp"

namespace cgcontact {
namespace {

using Pixel = std::array<unsigned char, 4>;  // red, green, blue, alpha
constexpr int width = 4, height = 3;

/// Writes or reads a picture of 4 x 3 pixels, by row from the top.
void write(const std::string& file, const std::vector<Pixel>& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = PNG_FORMAT_RGBA;
  ASSERT_TRUE(png_image_write_to_file(&image, file.c_str(), 0, pixels.data(), 0, nullptr)) << image.message;
}
std::vector<Pixel> read(const std::string& file) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_file(&image, file.c_str())) << image.message;
  EXPECT_EQ(image.format & PNG_FORMAT_FLAG_ALPHA, 0u);
  EXPECT_EQ(image.width, unsigned{width});
  EXPECT_EQ(image.height, unsigned{height});
  image.format = PNG_FORMAT_RGBA;
  std::vector<Pixel> pixels(width * height);
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr)) << image.message;
  return pixels;
}

const Pixel clear{9, 9, 9, 0}, white{255, 255, 255, 255};

/// Layers count rows from the bottom, pictures from the top.
TEST(PngLayers, LieBelowWhatIsDrawn) {
  const std::string file = testing::TempDir() + "layers.png", layer = testing::TempDir() + "layer.rgb";
  std::vector<Pixel> drawn(width * height, clear);
  drawn[4] = {200, 100, 0, 255};  // middle row, left: covers the layer
  drawn[5] = {200, 100, 0, 128};  // half
  write(file, drawn);
  std::string pixels;
  for (int k = 0; k < 6; ++k) pixels += std::string(3, static_cast<char>(10 + k));  // 2 x 3
  write_text(layer, pixels);
  lay_below(file, {{layer, 2, 3, 0.2, 1.1}});  // its third row lies outside
  const std::vector<Pixel> found = read(file);
  const auto grey = [](unsigned char v) { return Pixel{v, v, v, 255}; };
  const std::vector<Pixel> expected = {grey(12),
                                       grey(13),
                                       white,
                                       white,  //
                                       {200, 100, 0, 255},
                                       {106, 56, 5, 255},
                                       white,
                                       white,  //
                                       white,
                                       white,
                                       white,
                                       white};
  EXPECT_EQ(found, expected);
}

/// A layer that begins left of the picture and ends right of it.
TEST(PngLayers, AreCutAtTheEnds) {
  const std::string file = testing::TempDir() + "cut.png", layer = testing::TempDir() + "cut.rgb";
  write(file, std::vector<Pixel>(width * height, clear));
  std::string pixels;
  for (int k = 0; k < 7; ++k) pixels += std::string(3, static_cast<char>(20 + k));  // 7 x 1
  write_text(layer, pixels);
  lay_below(file, {{layer, 7, 1, -2, 2}});
  const std::vector<Pixel> found = read(file);
  for (int x = 0; x < width; ++x) EXPECT_EQ(found[x][0], 22 + x);
  EXPECT_EQ(found[width], white);
}

TEST(PngLayers, ErrorsNameTheFile) {
  const std::string file = testing::TempDir() + "bad.png", layer = testing::TempDir() + "short.rgb";
  write_text(layer, "12345");
  const auto message = [&] {
    try {
      lay_below(file, {{layer, 2, 1, 0, 0}});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  write_text(file, "no picture");
  EXPECT_NE(message().find("bad.png"), std::string::npos) << message();
  write(file, std::vector<Pixel>(width * height, clear));
  EXPECT_NE(message().find("short.rgb: 5 bytes"), std::string::npos) << message();
}

}  // namespace
}  // namespace cgcontact
