/// Planes that a body goes on behind as its own mirror image.
#pragma once

#include "core/cells/cut_cells.hpp"
#include "core/geometry/symmetry_plane.hpp"
#include "recovery/patch/boundary_data.hpp"

namespace cgcontact {

/// Finds plane faces whose support holds the normal direction and no other.
std::vector<SymmetryPlane> symmetry_planes(const CutCells& cut_cells, const BoundaryData& boundary);

/// Returns a point and its images in the planes, and in planes across those: four quarters of a quarter.
std::vector<Vec3> with_images(const Vec3& x, const std::vector<SymmetryPlane>& planes);

/// Returns those planes of two bodies that are the same.
std::vector<SymmetryPlane> common_planes(const std::vector<SymmetryPlane>& a, const std::vector<SymmetryPlane>& b,
                                         double cell_size);

}  // namespace cgcontact
