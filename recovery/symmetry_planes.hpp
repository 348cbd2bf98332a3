/// Planes that a body goes on behind as its own mirror image.
#pragma once

#include "recovery/patch_assembly.hpp"

namespace cgcontact {

struct SymmetryPlane {
  Vec3 point, normal;  ///< m; outward unit normal, global axes
  /// Of points, m: negative inside.
  double distance(const Vec3& x) const { return normal.dot(x - point); }
  Vec3 image(const Vec3& x) const { return x - 2 * distance(x) * normal; }
  Vec3 turned(const Vec3& v) const { return v - 2 * normal.dot(v) * normal; }
};

/// Plane faces whose support holds the normal direction and no other.
std::vector<SymmetryPlane> symmetry_planes(const RecoveryBody& body);

/// Those planes of two bodies that are the same.
std::vector<SymmetryPlane> common_planes(const std::vector<SymmetryPlane>& a, const std::vector<SymmetryPlane>& b,
                                         double cell_size);

}  // namespace cgcontact
