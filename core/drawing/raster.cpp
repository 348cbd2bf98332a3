#include "core/drawing/raster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cgcontact {

namespace {

/// Half the width of a grid line, in pixels of the averaged image.
constexpr double line_half_width = 0.55;
constexpr double line_darkness = 0.45;
/// Length of the normals that pixels keep; faces whose normals have a smaller cosine between them meet at an edge.
constexpr int normal_length = 127;
constexpr double edge_cosine = 0.8;
/// Depth, in fine pixels, between neighbours that are apart.
constexpr float depth_apart = 20;
constexpr unsigned char outline_grey = 31;
/// Grid lines closer than this many pixels fade out.
constexpr double line_fade_from = 12, line_fade_to = 4;

}  // namespace

RasterImage::RasterImage(int width, int height, int oversampling, const Camera& camera, ColourMap colour)
    : width_(width * oversampling),
      height_(height * oversampling),
      oversampling_(oversampling),
      camera_(camera),
      colour_(colour) {
  camera_.pixels_per_metre *= oversampling;
  const Pixel background{-std::numeric_limits<float>::max(), -1, {255, 255, 255, 0}, {0, 0, 0, 0}};
  fine_.assign(static_cast<std::size_t>(width_) * height_, background);
}

double RasterImage::line_cover(const Vec3& grid, const Screen& screen) {
  double cover = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (screen.line_strength[axis] <= cover) continue;
    const double distance = std::abs(grid[axis] - std::floor(grid[axis] + 0.5));  // floor is one instruction
    if (distance < line_half_width * screen.cells_per_pixel[axis]) cover = screen.line_strength[axis];
  }
  return cover;
}

bool RasterImage::project(const std::array<RasterVertex, 3>& triangle, double shading, Screen& screen) const {
  double *x = screen.x, *y = screen.y;
  for (int v = 0; v < 3; ++v) {
    const Vec3& position = triangle[v].position;
    if (!position.allFinite() || !std::isfinite(triangle[v].value)) return false;
    x[v] = (camera_.right.dot(position) - camera_.low[0]) * camera_.pixels_per_metre;
    y[v] = (camera_.up.dot(position) - camera_.low[1]) * camera_.pixels_per_metre;
    screen.z[v] = camera_.eye.dot(position) * camera_.pixels_per_metre;
    screen.grid.col(v) = triangle[v].grid;
  }
  const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
  if (area < 1e-9) return false;
  screen.slope.setZero();
  for (int v = 0; v < 3; ++v) {
    const int a = (v + 1) % 3, b = (v + 2) % 3;
    screen.slope(v, 0) = (y[a] - y[b]) / area;
    screen.slope(v, 1) = (x[b] - x[a]) / area;
  }
  const Mat3 gradient = screen.grid * screen.slope;
  for (int axis = 0; axis < 3; ++axis) {
    const double slope = std::hypot(gradient(axis, 0), gradient(axis, 1)) * oversampling_;
    screen.cells_per_pixel[axis] = slope;
    screen.line_strength[axis] =
        slope < 1e-6 ? 0 : std::clamp((1 / slope - line_fade_to) / (line_fade_from - line_fade_to), 0.0, 1.0);
  }
  const Vec3 side = triangle[1].position - triangle[0].position, other = triangle[2].position - triangle[0].position;
  const Vec3 normal = side.cross(other).normalized();
  screen.normal[3] = 0;
  for (int k = 0; k < 3; ++k) screen.normal[k] = static_cast<signed char>(std::lround(normal_length * normal[k]));
  screen.plain = triangle[0].value == triangle[1].value && triangle[0].value == triangle[2].value;
  if (screen.plain) screen.colour = colour_(triangle[0].value);
  const Vec3 light = (camera_.eye + 0.5 * camera_.up + 0.35 * camera_.right).normalized();
  screen.shade = 1 - shading * 0.4 * (1 - std::max(0.0, normal.dot(light)));
  return true;
}

/// weight: of the corners, at the pixel's centre.
inline void RasterImage::draw_pixel(const std::array<RasterVertex, 3>& triangle, const Screen& screen,
                                    const Vec3& weight, Pixel& pixel) {
  const auto depth = static_cast<float>(weight[0] * screen.z[0] + weight[1] * screen.z[1] + weight[2] * screen.z[2]);
  if (depth <= pixel.depth) return;
  const double value = weight[0] * triangle[0].value + weight[1] * triangle[1].value + weight[2] * triangle[2].value;
  const std::array<double, 3> colour = screen.plain ? screen.colour : colour_(value);
  const double factor = 255 * screen.shade * (1 - line_darkness * line_cover(screen.grid * weight, screen));
  pixel.depth = depth;
  for (int c = 0; c < 3; ++c) pixel.colour[c] = static_cast<unsigned char>(std::lround(factor * colour[c]));
  pixel.normal = screen.normal;
  pixel.region = screen.region;
}

void RasterImage::draw(const std::array<RasterVertex, 3>& triangle, int region, double shading) {
  Screen screen;
  if (!project(triangle, shading, screen)) return;
  screen.region = region;
  const auto range = [](const double* c, int size) {
    const double first = std::ceil(std::min({c[0], c[1], c[2]}) - 0.5);
    const double last = std::floor(std::max({c[0], c[1], c[2]}) - 0.5);
    return std::array<int, 2>{static_cast<int>(std::clamp(first, 0.0, static_cast<double>(size))),
                              static_cast<int>(std::clamp(last, -1.0, size - 1.0))};
  };
  const std::array<int, 2> columns = range(screen.x, width_), rows = range(screen.y, height_);
  for (int row = rows[0]; row <= rows[1]; ++row) {
    const std::array<int, 2> inside = columns_of_row(screen, row, columns);
    const Vec3 step = screen.slope.col(0);
    Vec3 first;  // weights at the row's first column
    for (int v = 0; v < 3; ++v) {
      const int a = (v + 1) % 3;
      first[v] = step[v] * (0.5 - screen.x[a]) + screen.slope(v, 1) * (row + 0.5 - screen.y[a]);
    }
    Pixel* const pixels = fine_.data() + static_cast<std::size_t>(row) * width_;
    for (int column = inside[0]; column <= inside[1]; ++column) {
      const Vec3 weight = first + column * step;
      if (weight.minCoeff() >= -1e-9) draw_pixel(triangle, screen, weight, pixels[column]);
    }
  }
}

/// The columns of a row that the triangle may cover, one more at each end for rounding.
std::array<int, 2> RasterImage::columns_of_row(const Screen& screen, int row, const std::array<int, 2>& columns) {
  double first = columns[0], last = columns[1];
  for (int v = 0; v < 3; ++v) {
    const int a = (v + 1) % 3;
    const double slope = screen.slope(v, 0);
    const double zero = screen.x[a] - 0.5 - screen.slope(v, 1) * (row + 0.5 - screen.y[a]) / slope;
    if (!std::isfinite(zero)) continue;  // an edge along the row
    if (slope > 0)
      first = std::max(first, std::floor(zero) - 1);
    else
      last = std::min(last, std::ceil(zero) + 1);
  }
  return {static_cast<int>(std::min(first, columns[1] + 1.0)), static_cast<int>(std::max(last, columns[0] - 1.0))};
}

/// Returns whether two neighbouring pixels show different regions, or points of one that are apart or meet at an
/// edge.
inline bool RasterImage::are_apart(const Pixel& a, const Pixel& b) {
  if (a.region != b.region) return true;
  if (a.region < 0) return false;
  const int product = a.normal[0] * b.normal[0] + a.normal[1] * b.normal[1] + a.normal[2] * b.normal[2];
  return product < static_cast<int>(edge_cosine * normal_length * normal_length) ||
         std::abs(a.depth - b.depth) > depth_apart;
}

inline bool RasterImage::is_outline(int x, int y) const {
  const Pixel* const pixel = fine_.data() + static_cast<std::size_t>(y) * width_ + x;
  return (x + 1 < width_ && are_apart(*pixel, pixel[1])) || (y + 1 < height_ && are_apart(*pixel, pixel[width_]));
}

/// Pixels at outlines, in order.
std::vector<std::size_t> RasterImage::outline_pixels() const {
  std::vector<std::size_t> found;
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      if (is_outline(x, y)) found.push_back(static_cast<std::size_t>(y) * width_ + x);
  return found;
}

/// A pixel apart from all its neighbours, which belong together, is a crack between cells of two sizes, or a sliver: it
/// becomes what is beside it.
void RasterImage::mend_speck(int x, int y) {
  if (x == 0 || y == 0 || x + 1 == width_ || y + 1 == height_) return;
  const std::size_t index = static_cast<std::size_t>(y) * width_ + x;
  Pixel& here = fine_[index];
  const Pixel &left = fine_[index - 1], &right = fine_[index + 1], &below = fine_[index - width_],
              &above = fine_[index + width_];
  for (const Pixel* other : {&left, &right, &below, &above})
    if (other->region < 0 || !are_apart(here, *other)) return;
  if (!are_apart(left, right) && !are_apart(below, above) && !are_apart(left, below)) here = left;
}

void RasterImage::draw_outlines() {
  std::vector<std::size_t> outline = outline_pixels();
  const auto column = [&](std::size_t index) { return static_cast<int>(index % width_); };
  const auto row = [&](std::size_t index) { return static_cast<int>(index / width_); };
  for (std::size_t index : outline) mend_speck(column(index), row(index));
  outline.erase(std::remove_if(outline.begin(), outline.end(),
                               [&](std::size_t index) { return !is_outline(column(index), row(index)); }),
                outline.end());
  const int reach = oversampling_ / 2;
  for (std::size_t index : outline) {
    const int x = column(index), y = row(index);
    for (int j = std::max(0, y - reach); j <= std::min(height_ - 1, y + reach); ++j)
      for (int i = std::max(0, x - reach); i <= std::min(width_ - 1, x + reach); ++i) {
        fine_[static_cast<std::size_t>(j) * width_ + i].colour = {outline_grey, outline_grey, outline_grey, 0};
      }
  }
}

std::string RasterImage::pixels() const {
  const int width = width_ / oversampling_, height = height_ / oversampling_;
  std::string bytes;
  bytes.reserve(static_cast<std::size_t>(3) * width * height);
  const int samples = oversampling_ * oversampling_;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      int sum[3] = {0, 0, 0};
      for (int j = 0; j < oversampling_; ++j) {
        const Pixel* const row =
            fine_.data() + (static_cast<std::size_t>(y) * oversampling_ + j) * width_ + x * oversampling_;
        for (int i = 0; i < oversampling_; ++i)
          for (int c = 0; c < 3; ++c) sum[c] += row[i].colour[c];
      }
      for (const int channel : sum)
        bytes += static_cast<char>(static_cast<unsigned char>((channel + samples / 2) / samples));
    }
  return bytes;
}

std::vector<int> RasterImage::regions() const {
  std::vector<int> regions;
  for (int y = oversampling_ / 2; y < height_; y += oversampling_)
    for (int x = oversampling_ / 2; x < width_; x += oversampling_)
      regions.push_back(fine_[static_cast<std::size_t>(y) * width_ + x].region);
  return regions;
}

}  // namespace cgcontact
