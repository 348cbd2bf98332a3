#include "core/drawing/render.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/process/parallel.hpp"

namespace cgcontact {

namespace {

constexpr int oversampling = 3;
/// Rows that are drawn at a time, and rows beyond them whose outlines reach into them.
constexpr int strip_rows = 50, outline_reach = 1;

/// The triangles that reach into each strip of rows, in the order in which they are drawn.
std::vector<std::vector<std::size_t>> triangles_by_strip(const Camera& camera, std::size_t count,
                                                         const std::function<RasterTriangle(std::size_t)>& triangle,
                                                         int num_strips) {
  std::vector<std::vector<std::size_t>> strips(num_strips);
  for (std::size_t i = 0; i < count; ++i) {
    double low = std::numeric_limits<double>::max(), high = -low;
    for (const RasterVertex& vertex : triangle(i).vertices) {
      const double row = (camera.up.dot(vertex.position) - camera.low[1]) * camera.pixels_per_metre;
      low = std::min(low, row);
      high = std::max(high, row);
    }
    const auto strip = [&](double row) {
      return static_cast<int>(std::clamp(std::floor(row / strip_rows), 0.0, num_strips - 1.0));
    };
    // A strip sees `outline_reach` rows beyond its own; one more for rounding. Not-a-number is left to the strips.
    const bool known = std::isfinite(low) && std::isfinite(high);
    for (int s = known ? strip(low - outline_reach - 1) : 0;
         s <= (known ? strip(high + outline_reach + 1) : num_strips - 1); ++s)
      strips[s].push_back(i);
  }
  return strips;
}

}  // namespace

bool reaches_picture(const std::array<Vec3, 3>& corners, const std::array<int, 2>& size, const Camera& camera) {
  for (int k = 0; k < 2; ++k) {
    const auto coordinate = [&](int v) { return (k == 0 ? camera.right : camera.up).dot(corners[v]) - camera.low[k]; };
    const auto [low, high] = std::minmax({coordinate(0), coordinate(1), coordinate(2)});
    if (high < 0 || low > size[k] / camera.pixels_per_metre) return false;
  }
  return true;
}

RenderedImage render(const std::array<int, 2>& size, const Camera& camera, ColourMap colour, double shading,
                     std::size_t count, const std::function<RasterTriangle(std::size_t)>& triangle) {
  const auto num_pixels = [&](int rows) { return static_cast<std::size_t>(size[0]) * rows; };
  const int num_strips = (size[1] + strip_rows - 1) / strip_rows;
  const auto strips = triangles_by_strip(camera, count, triangle, num_strips);
  RenderedImage image{size[0], size[1], std::string(3 * num_pixels(size[1]), '\0'),
                      std::vector<int>(num_pixels(size[1]))};
  parallel_for("cgcontact::render::strips", num_strips, 1, [&](std::size_t s) {
    const int first = static_cast<int>(s) * strip_rows, rows = std::min(strip_rows, size[1] - first);
    const int below = std::min(outline_reach, first), above = std::min(outline_reach, size[1] - first - rows);
    Camera strip_camera = camera;
    strip_camera.low[1] += (first - below) / camera.pixels_per_metre;
    RasterImage strip(size[0], below + rows + above, oversampling, strip_camera, colour);
    for (std::size_t i : strips[s]) {
      const RasterTriangle drawn = triangle(i);
      strip.draw(drawn.vertices, drawn.region, shading);
    }
    strip.draw_outlines();
    std::copy_n(strip.pixels().data() + 3 * num_pixels(below), 3 * num_pixels(rows),
                image.pixels.data() + 3 * num_pixels(first));
    const std::vector<int> regions = strip.regions();
    std::copy_n(regions.data() + num_pixels(below), num_pixels(rows), image.regions.data() + num_pixels(first));
  });
  return image;
}

}  // namespace cgcontact
