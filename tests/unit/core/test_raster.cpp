#include <gtest/gtest.h>

#include "core/drawing/raster.hpp"

namespace cgcontact::test_raster {
namespace {

std::array<double, 3> white_to_black(double value) { return {1 - value, 1 - value, 1 - value}; }

/// A square of 9 x 9 pixels of one colour, and in front of it the triangle between three corners, whose colour differs.
std::string picture(const std::array<Vec3, 3>& front) {
  Camera camera;
  camera.right = Vec3::UnitX();
  camera.up = Vec3::UnitY();
  camera.eye = Vec3::UnitZ();
  RasterImage image(9, 9, 1, camera, white_to_black);
  const auto draw = [&](const std::array<Vec3, 3>& x, double value) {
    std::array<RasterVertex, 3> triangle;
    for (std::size_t v = 0; v < 3; ++v) triangle[v] = {x[v], Vec3::Constant(0.5), value};
    image.draw(triangle, 0, 0);
  };
  draw({Vec3(0, 0, 0), Vec3(9, 0, 0), Vec3(9, 9, 0)}, 0.25);
  draw({Vec3(0, 0, 0), Vec3(9, 9, 0), Vec3(0, 9, 0)}, 0.25);
  draw(front, 0.75);
  image.draw_outlines();
  return image.pixels();
}

// A sliver that covers one pixel and turns away from the face around it is no edge of the body: it is not seen. One of
// two pixels is.
TEST(raster, single_pixels_that_stand_out_are_specks) {
  const std::array<Vec3, 3> hidden{Vec3(4, 4, -1), Vec3(5, 4, -1), Vec3(4, 5, -1)};
  const std::string plain = picture(hidden);
  const std::array<Vec3, 3> one{Vec3(4, 4, 1), Vec3(5.2, 4, 3), Vec3(4, 5.2, 3)};
  EXPECT_EQ(picture(one), plain);
  const std::array<Vec3, 3> two{Vec3(4, 4, 1), Vec3(6.2, 4, 5), Vec3(4, 5.6, 5)};
  EXPECT_NE(picture(two), plain);
}

}  // namespace
}  // namespace cgcontact::test_raster
