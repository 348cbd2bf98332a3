/// Small software renderer for the picture of the result: coloured triangles with a depth buffer, the lines of the
/// body's own grid drawn on them, outlines where body, depth or direction change.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Colour of a value; channels in [0,1].
using ColourMap = std::array<double, 3> (*)(double value);

/// Parallel projection; `right`, `up`, `eye` are orthonormal and right-handed, `eye` points to the viewer.
struct Camera {
  Vec3 right = Vec3::UnitX(), up = Vec3::UnitZ(), eye = -Vec3::UnitY();
  double low[2] = {0, 0};  ///< lower left corner of the picture in (right, up), m
  double pixels_per_metre = 1;
};

struct RasterVertex {
  Vec3 position;  ///< m, where it is drawn
  Vec3 grid;      ///< grid coordinates, for the grid lines
  double value;   ///< gives the colour
};

class RasterImage {
 public:
  /// Draws `oversampling` times finer in each direction, then averages.
  RasterImage(int width, int height, int oversampling, const Camera& camera, ColourMap colour);

  /// Draws a triangle. `shading`: 0 paints the plain colour, 1 darkens faces that turn away from the viewer's light.
  /// `region` (a body, a face) is what outlines separate.
  void draw(const std::array<RasterVertex, 3>& triangle, int region, double shading);
  void draw_outlines();
  /// Bytes red, green, blue by row from the bottom, white where nothing was drawn.
  std::string pixels() const;
  /// Returns the `region` seen in each pixel, by row from the bottom; -1: none.
  std::vector<int> regions() const;

 private:
  /// All its bytes are members, so that it is copied as a whole.
  struct Pixel {
    float depth;
    int region;
    std::array<unsigned char, 4> colour;  ///< and zero
    std::array<signed char, 4> normal;    ///< of length 127; and zero
  };
  /// Triangle on the screen: corners in pixels, gradients of its barycentric and grid coordinates by pixel.
  struct Screen {
    double x[3], y[3], z[3];
    Mat3 slope, grid;
    std::array<signed char, 4> normal;  ///< of a pixel
    Vec3 cells_per_pixel;               ///< by axis, of the averaged image
    Vec3 line_strength;                 ///< of the grid lines across each axis
    std::array<double, 3> colour;       ///< of a triangle of one value
    double shade;
    int region;
    bool plain;  ///< of one value
  };
  /// Returns false if the triangle is seen from behind or from the side.
  bool project(const std::array<RasterVertex, 3>& triangle, double shading, Screen& screen) const;
  static std::array<int, 2> columns_of_row(const Screen& screen, int row, const std::array<int, 2>& columns);
  void draw_pixel(const std::array<RasterVertex, 3>& triangle, const Screen& screen, const Vec3& weight, Pixel& pixel);
  /// Returns the fraction of the pixel that lies on a grid line.
  static double line_cover(const Vec3& grid, const Screen& screen);
  static bool are_apart(const Pixel& a, const Pixel& b);
  bool is_outline(int x, int y) const;
  std::vector<std::size_t> outline_pixels() const;
  void mend_speck(int x, int y);

  int width_, height_, oversampling_;
  Camera camera_;
  ColourMap colour_;
  std::vector<Pixel> fine_;
};

}  // namespace cgcontact
