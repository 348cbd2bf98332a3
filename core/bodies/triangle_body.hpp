/// Bodies bounded by a triangle surface: its patches are their elementary surfaces.
#pragma once

#include <memory>

#include "core/geometry/solid.hpp"
#include "core/triangles/triangle_surface.hpp"

namespace cgcontact {

class TriangleBody final : public BodyGeometry {
 public:
  explicit TriangleBody(TriangleSurface surface);
  const TriangleSurface& triangles() const { return *triangles_; }

  std::shared_ptr<const BodyGeometry> transformed(const Mat3& rotation, const Vec3& translation,
                                                  double scale) const override;
  std::shared_ptr<const BodyGeometry> stretched(int axis, double factor, double shift) const override;
  bool bounding_box(Vec3& min, Vec3& max) const override;
  bool contains(const Vec3& x) const override { return triangles_->contains(x); }
  double distance_to_surfaces(const Vec3& x) const override { return triangles_->nearest(x).distance; }
  int surface_at(const Vec3& x, const Vec3& n) const override {
    return triangles_->patch(triangles_->nearest_facing(x, n));
  }
  void crossings(const Vec3& x, const Vec3& d, double reach, std::vector<Crossing>& found) const override;

  std::unique_ptr<CellSweep> sweep_cells(const Grid& grid, const std::vector<Plane>& dividers, int order,
                                         const LeafLevel& leaves) const override;
  void boundary_points(const Index3& cell, const std::vector<char>& selected, const std::vector<Plane>& dividers,
                       int order, int owner, BoundaryPoints& points) const override;
  CellEstimate estimate_cells(const Grid& grid, double max_cells) const override;

  std::size_t num_facets() const override { return triangles_->triangles().size(); }
  double facet_width(const Vec3& x, double min_angle) const override;

  std::vector<int> surfaces_near(const Vec3& centre, double half_size, double slack,
                                 const std::vector<int>& candidates) const override;
  double signed_distance(const Vec3& x) const override;
  std::vector<Surface> surfaces_alone() const override;
  void each_facet_in_cell(const UseFacet& use) const override;

 private:
  std::shared_ptr<const TriangleSurface> triangles_;
};

/// Estimates the cells of a body of these triangles.
CellEstimate estimate_triangle_cells(const TriangleSurface& surface, const Grid& grid, double max_cells);
/// Returns the patches with a triangle near a cube, ascending.
std::vector<int> patches_near(const TriangleSurface& surface, const Vec3& centre, double half_size, double slack);

/// Returns nullptr for bodies of another kind.
const TriangleSurface* as_triangles(const Solid& solid);

}  // namespace cgcontact
