#include "core/cells/boundary_points.hpp"

#include <algorithm>

namespace cgcontact {

bool divide_faces(const std::vector<Plane>& dividers) {
  return std::any_of(dividers.begin(), dividers.end(), [](const Plane& plane) { return plane.surfaces != nullptr; });
}

std::vector<Plane> crossing_planes(const std::vector<Plane>& planes, const Vec3& corner, double width) {
  std::vector<Plane> result;
  const Vec3 half = Vec3::Constant(0.5 * width);
  for (const Plane& p : planes)
    if (p.of_normals || std::abs(p.normal.dot(corner + half) - p.offset) < p.normal.cwiseAbs().dot(half))
      result.push_back(p);
  return result;
}

}  // namespace cgcontact
