/// A picture of triangles, drawn strip by strip so that it takes little memory, on all threads.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/drawing/clip_cells.hpp"
#include "core/drawing/raster.hpp"

namespace cgcontact {

struct RasterTriangle {
  std::array<RasterVertex, 3> vertices;  ///< counterclockwise seen from outside; seen from inside it is not drawn
  int region = 0;                        ///< outlines separate different ones
};

/// Returns a triangle of a mesh's boundary with the grid lines of its cell. position(point): where a point of the mesh
/// is drawn, m; value(corner): gives the colour, corner 0 to 2.
template <class Position, class Value>
RasterTriangle raster_triangle(const ClippedMesh& mesh, const BoundaryTriangle& triangle, int region,
                               const Position& position, const Value& value) {
  RasterTriangle drawn;
  drawn.region = region;
  for (int v = 0; v < 3; ++v) {
    const int p = triangle.points[v];
    drawn.vertices[v] = {position(p), std::ldexp(1.0, triangle.level) * mesh.points[p], value(v)};
  }
  return drawn;
}

struct RenderedImage {
  int width = 0, height = 0;
  std::string pixels;        ///< bytes red, green, blue, by row from the bottom
  std::vector<int> regions;  ///< of each pixel, -1: nothing there
};

/// Returns whether any of a picture may show a triangle with these corners (m).
bool reaches_picture(const std::array<Vec3, 3>& corners, const std::array<int, 2>& size, const Camera& camera);

/// Draws triangle(0) .. triangle(count - 1); `triangle` is called more than once for each, from several threads.
/// `shading` as in RasterImage::draw.
RenderedImage render(const std::array<int, 2>& size, const Camera& camera, ColourMap colour, double shading,
                     std::size_t count, const std::function<RasterTriangle(std::size_t)>& triangle);

}  // namespace cgcontact
