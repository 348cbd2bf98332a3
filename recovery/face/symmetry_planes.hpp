/// Planes that a body goes on behind as its own mirror image.
#pragma once

#include "core/cells/cut_cells.hpp"
#include "recovery/patch/boundary_data.hpp"

namespace cgcontact {

struct SymmetryPlane {
  Vec3 point, normal;  ///< m; outward unit normal, global axes
  /// Returns the distance of a point from the plane, m: negative inside.
  double distance(const Vec3& x) const { return normal.dot(x - point); }
  Vec3 image(const Vec3& x) const { return x - 2 * distance(x) * normal; }
  Vec3 turned(const Vec3& v) const { return v - 2 * normal.dot(v) * normal; }
};

/// Finds plane faces whose support holds the normal direction and no other.
std::vector<SymmetryPlane> symmetry_planes(const CutCells& cut_cells, const BoundaryData& boundary);

/// Returns a point and its images in the planes, and in planes across those: four quarters of a quarter.
std::vector<Vec3> with_images(const Vec3& x, const std::vector<SymmetryPlane>& planes);

/// Returns those planes of two bodies that are the same.
std::vector<SymmetryPlane> common_planes(const std::vector<SymmetryPlane>& a, const std::vector<SymmetryPlane>& b,
                                         double cell_size);

}  // namespace cgcontact
