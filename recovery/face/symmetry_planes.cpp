#include "recovery/face/symmetry_planes.hpp"

#include <algorithm>
#include <map>

namespace cgcontact {
namespace {

/// Tolerance of normals, and of positions in cells.
constexpr double tolerance = 1e-8;

/// Returns whether the normal direction is held, and nothing else.
bool holds_normal_only(const TractionCondition& condition, const Vec3& normal) {
  if (condition.held) return false;
  bool held = condition.normal_held;
  for (int i = 0; i < 3; ++i) {
    if (!condition.component_held[i]) continue;
    if (std::abs(normal[i]) < 1 - tolerance) return false;
    held = true;
  }
  return held;
}

}  // namespace

std::vector<SymmetryPlane> symmetry_planes(const CutCells& cc, const BoundaryData& boundary) {
  const BoundaryPoints& points = cc.boundary;
  struct Face {
    Vec3 point, normal;  // grid coordinates
    bool plane = true;
  };
  std::map<std::pair<int, int>, Face> faces;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const int condition = boundary.condition_of_point[p];
    if (!boundary.conditions[condition].is_support()) continue;
    Face& face =
        faces.try_emplace({points.surface[p], condition}, Face{points.position[p], points.normal[p]}).first->second;
    face.plane = face.plane && (points.normal[p] - face.normal).norm() < tolerance &&
                 std::abs(face.normal.dot(points.position[p] - face.point)) < tolerance * (1 + face.point.norm());
  }
  std::vector<SymmetryPlane> planes;
  for (const auto& [key, face] : faces) {
    const Vec3 normal = cc.grid.rotation * face.normal;
    if (face.plane && holds_normal_only(boundary.conditions[key.second], normal))
      planes.push_back({cc.grid.to_global(face.point), normal});
  }
  return planes;
}

std::vector<Vec3> with_images(const Vec3& x, const std::vector<SymmetryPlane>& planes) {
  std::vector<Vec3> all{x};
  std::vector<unsigned> planes_of{0};
  for (std::size_t p = 0; p < planes.size() && p < 31; ++p)
    for (std::size_t i = 0, size = all.size(); i < size; ++i) {
      bool parallel = false;
      for (std::size_t k = 0; k < p; ++k)
        parallel |= (planes_of[i] >> k & 1) != 0 && std::abs(planes[k].normal.dot(planes[p].normal)) > 0.5;
      if (parallel) continue;
      all.push_back(planes[p].image(all[i]));
      planes_of.push_back(planes_of[i] | 1U << p);
    }
  return all;
}

std::vector<SymmetryPlane> common_planes(const std::vector<SymmetryPlane>& a, const std::vector<SymmetryPlane>& b,
                                         double cell_size) {
  std::vector<SymmetryPlane> common;
  for (const SymmetryPlane& plane : a) {
    const auto same = [&](const SymmetryPlane& other) {
      return (plane.normal - other.normal).norm() < 2 * tolerance &&
             std::abs(plane.distance(other.point)) < 1e-6 * cell_size;
    };
    if (std::any_of(b.begin(), b.end(), same) && std::none_of(common.begin(), common.end(), same))
      common.push_back(plane);
  }
  return common;
}

}  // namespace cgcontact
