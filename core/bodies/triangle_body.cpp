#include "core/bodies/triangle_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/errors/errors.hpp"
#include "core/bodies/clipped_triangles.hpp"
#include "core/bodies/triangle_cells.hpp"
#include "core/cells/grid.hpp"

namespace cgcontact {

namespace {

/// A patch this flat is a plane: coordinates in single precision, as STL files have them, are about 1e-7 off.
/// Small triangles are turned more by that than large ones.
constexpr double flat_tolerance = 1e-6, flat_angle = 1e-2;
/// Tolerance of normals, and relative to the length of a prism: its sides and ends.
constexpr double flat_end = 1e-3;

/// Triangles of one patch, -1: of all.
class TrianglePatch final : public SurfacePatch {
 public:
  TrianglePatch(std::shared_ptr<const TriangleSurface> triangles, int patch)
      : triangles_(std::move(triangles)), patch_(patch) {}

  Surface near(const Vec3& x) const override {
    const int triangle = triangles_->nearest(x, patch_).triangle;
    Surface plane;
    plane.point = triangles_->corner(triangle, 0);
    plane.direction = triangles_->normal(triangle);
    return plane;
  }
  /// Interpolated over the nearest triangle.
  Vec3 normal(const Vec3& x) const override {
    const TriangleSurface::Foot foot = triangles_->nearest(x, patch_);
    return triangles_->smooth_normal(foot.triangle, foot.point);
  }

 private:
  std::shared_ptr<const TriangleSurface> triangles_;
  int patch_;
};

/// Patches as elementary surfaces; a flat one is a plane.
std::vector<Surface> patch_surfaces(const std::shared_ptr<const TriangleSurface>& triangles) {
  const std::size_t n = triangles->face_names().size();
  std::vector<Surface> surfaces(n);
  std::vector<double> area(n, 0);
  for (Surface& s : surfaces) s.direction = Vec3::Zero();
  const auto each_triangle = [&](const auto& use) {
    for (std::size_t t = 0; t < triangles->triangles().size(); ++t) use(static_cast<int>(t));
  };
  each_triangle([&](int t) {
    const Vec3 &a = triangles->corner(t, 0), &b = triangles->corner(t, 1), &c = triangles->corner(t, 2);
    const double weight = (b - a).cross(c - a).norm();
    Surface& s = surfaces[triangles->patch(t)];
    s.point += weight * (a + b + c) / 3;
    s.direction += weight * triangles->normal(t);
    area[triangles->patch(t)] += weight;
  });
  for (std::size_t p = 0; p < n; ++p) {
    surfaces[p].names = {triangles->face_names()[p]};
    surfaces[p].point /= area[p];
    surfaces[p].direction.normalize();
  }
  const double distance = flat_tolerance * (triangles->tree().max() - triangles->tree().min()).norm();
  each_triangle([&](int t) {
    Surface& s = surfaces[triangles->patch(t)];
    bool flat = (triangles->normal(t) - s.direction).norm() < flat_angle;
    for (int k = 0; k < 3; ++k) flat = flat && std::abs(s.direction.dot(triangles->corner(t, k) - s.point)) < distance;
    if (flat) return;
    s.kind = Surface::Kind::patch;
    if (!s.patch) s.patch = std::make_shared<TrianglePatch>(triangles, triangles->patch(t));
  });
  return surfaces;
}

/// Twice the area over the length of the edge from corner k: how far the triangle reaches from it.
double width(const TriangleSurface& surface, int triangle, int k) {
  const Vec3 &a = surface.corner(triangle, k), &b = surface.corner(triangle, (k + 1) % 3),
             &c = surface.corner(triangle, (k + 2) % 3);
  return (b - a).cross(c - a).norm() / (b - a).norm();
}

}  // namespace

TriangleBody::TriangleBody(TriangleSurface surface)
    : triangles_(std::make_shared<const TriangleSurface>(std::move(surface))) {
  surfaces_ = patch_surfaces(triangles_);
}

std::shared_ptr<const BodyGeometry> TriangleBody::transformed(const Mat3& rotation, const Vec3& translation,
                                                              double scale) const {
  return std::make_shared<TriangleBody>(triangles_->transformed(rotation, translation, scale));
}

std::shared_ptr<const BodyGeometry> TriangleBody::stretched(int axis, double factor, double shift) const {
  Vec3 min, max;
  bounding_box(min, max);
  const double slack = flat_end * (max - min)[axis];
  for (int t = 0; t < static_cast<int>(triangles_->triangles().size()); ++t) {
    const double cosine = std::abs(triangles_->normal(t)[axis]);
    bool prism = cosine < flat_end || cosine > 1 - flat_end;
    for (int k = 0; k < 3; ++k) {
      const double x = triangles_->corner(t, k)[axis];
      prism = prism && (x < min[axis] + slack || x > max[axis] - slack || cosine < flat_end);
    }
    if (!prism) {
      const Vec3& x = triangles_->corner(t, 0);
      throw InputError(
          fmt::format("the triangle at ({:.4g}, {:.4g}, {:.4g}) is neither on an end of a prism nor along "
                      "its axis",
                      x[0], x[1], x[2]));
    }
  }
  return std::make_shared<TriangleBody>(triangles_->stretched(axis, factor, shift));
}

bool TriangleBody::bounding_box(Vec3& min, Vec3& max) const {
  min = triangles_->tree().min();
  max = triangles_->tree().max();
  return true;
}

void TriangleBody::crossings(const Vec3& x, const Vec3& d, double reach, std::vector<Crossing>& found) const {
  triangles_->each_hit(x, d, reach, [&](double t, int triangle) {
    found.push_back({t, triangles_->patch(triangle), triangles_->normal(triangle)});
  });
}

std::unique_ptr<CellSweep> TriangleBody::sweep_cells(const Grid& grid, const std::vector<Plane>& dividers, int order,
                                                     const LeafLevel& leaves) const {
  return std::make_unique<TriangleCells>(*triangles_, nullptr, grid.num_cells, dividers, order, leaves);
}

void TriangleBody::boundary_points(const Index3& cell, const std::vector<char>& selected,
                                   const std::vector<Plane>& dividers, int order, int owner,
                                   BoundaryPoints& points) const {
  triangle_boundary_points(*triangles_, nullptr, triangles_near_cell(*triangles_, cell), cell, selected, dividers,
                           order, owner, points);
}

CellEstimate TriangleBody::estimate_cells(const Grid& grid, double max_cells) const {
  return estimate_triangle_cells(*triangles_, grid, max_cells);
}

double TriangleBody::facet_width(const Vec3& x, double min_angle) const {
  const int triangle = triangles_->nearest(x).triangle;
  double widest = 0;
  for (int k = 0; k < 3; ++k) {
    const int other = triangles_->neighbour(triangle, k);
    if (other < 0 || triangles_->patch(other) != triangles_->patch(triangle)) continue;
    if (triangles_->normal(triangle).dot(triangles_->normal(other)) > std::cos(min_angle)) continue;
    int edge = 0;
    while (edge < 2 && triangles_->neighbour(other, edge) != triangle) ++edge;
    widest = std::max(widest, std::min(width(*triangles_, triangle, k), width(*triangles_, other, edge)));
  }
  return widest;
}

/// Patches with a triangle there.
std::vector<int> TriangleBody::surfaces_near(const Vec3& centre, double half_size, double slack,
                                             const std::vector<int>&) const {
  return patches_near(*triangles_, centre, half_size, slack);
}

double TriangleBody::signed_distance(const Vec3& x) const {
  const TriangleSurface::Foot foot = triangles_->nearest(x);
  return (x - foot.point).dot(foot.normal) < 0 ? -foot.distance : foot.distance;
}

/// Triangles of each patch by themselves: the search for the nearest one need not pass over all others.
std::vector<Surface> TriangleBody::surfaces_alone() const {
  std::vector<std::vector<Vec3>> points(surfaces_.size());
  for (int t = 0; t < static_cast<int>(num_facets()); ++t)
    for (int k = 0; k < 3; ++k) points[triangles_->patch(t)].push_back(triangles_->corner(t, k));
  std::vector<Surface> alone = surfaces_;
  for (std::size_t s = 0; s < alone.size(); ++s) {
    if (alone[s].kind != Surface::Kind::patch) continue;
    std::vector<Triangle> triangles(points[s].size() / 3);
    for (int t = 0; t < static_cast<int>(triangles.size()); ++t) triangles[t] = {3 * t, 3 * t + 1, 3 * t + 2};
    std::vector<int> patch(triangles.size(), 0);
    alone[s].patch = std::make_shared<TrianglePatch>(
        std::make_shared<const TriangleSurface>(std::move(points[s]), std::move(triangles), std::move(patch),
                                                std::vector<std::string>{""}),
        -1);
  }
  return alone;
}

void TriangleBody::each_facet_in_cell(const UseFacet& use) const {
  for (int t = 0; t < static_cast<int>(num_facets()); ++t)
    each_cell_of_triangle(*triangles_, t, [&](const Index3& cell, const SurfacePolygon& polygon) {
      use(cell, triangles_->patch(t), polygon.x.data(), polygon.n);
    });
}

/// A plane of area A with the unit normal n crosses A (|nx| + |ny| + |nz|) / h^2 cells (axes of the grid).
CellEstimate estimate_triangle_cells(const TriangleSurface& surface, const Grid& grid, double) {
  const double h = grid.cell_size;
  double crossed = 0, volume = 0;
  const Vec3& origin = surface.corner(0, 0);
  for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t) {
    const Vec3 a = surface.corner(t, 0) - origin, b = surface.corner(t, 1) - origin, c = surface.corner(t, 2) - origin;
    crossed += (grid.rotation.transpose() * (b - a).cross(c - a)).lpNorm<1>() / 2;
    volume += a.dot(b.cross(c)) / 6;
  }
  const double cut = crossed / (h * h);
  return {volume / (h * h * h) + cut, cut};
}

std::vector<int> patches_near(const TriangleSurface& surface, const Vec3& centre, double half_size, double slack) {
  std::vector<int> near;
  const Vec3 reach = Vec3::Constant(half_size + slack), low = centre - reach, high = centre + reach;
  surface.tree().visit(
      [&](const Vec3& min, const Vec3& max) {
        return (min.array() <= high.array()).all() && (max.array() >= low.array()).all();
      },
      [&](int t) { near.push_back(surface.patch(t)); });
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return near;
}

Solid Solid::bounded_by(TriangleSurface surface) { return Solid(std::make_shared<TriangleBody>(std::move(surface))); }

const TriangleSurface* as_triangles(const Solid& solid) {
  const auto* const body = dynamic_cast<const TriangleBody*>(&solid.geometry());
  return body ? &body->triangles() : nullptr;
}

}  // namespace cgcontact
