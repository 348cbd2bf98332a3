#include "core/face_dividers.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {

namespace {

constexpr double same_plane = 1e-9;  // cells, and of the normals: less than what FaceSpec::contains lets pass
constexpr double parallel = 1e-12;   // of a cylinder's axis to that of a cone; of a cone to a half-space or a line

bool coincide(const Vec3& a, double a_offset, const Vec3& b, double b_offset) {
  const double sign = a.dot(b) < 0 ? -1 : 1;
  return (sign * a - b).norm() < same_plane && std::abs(sign * a_offset - b_offset) < same_plane;
}

void add_once(const Plane& plane, std::vector<Plane>& dividers) {
  const auto is_same = [&](const Plane& other) {
    return other.surface == plane.surface && coincide(plane.normal, plane.offset, other.normal, other.offset);
  };
  if (std::none_of(dividers.begin(), dividers.end(), is_same)) dividers.push_back(plane);
}

/// Exactly one of the solid's own planes if it is one up to rounding: no slivers along an edge.
void settle(const Solid& solid, Plane& plane) {
  for (const Surface& s : solid.surfaces()) {
    if (s.kind != Surface::Kind::plane) continue;
    const double offset = s.direction.dot(s.point);
    if (!coincide(s.direction, offset, plane.normal, plane.offset)) continue;
    plane.normal = s.direction;
    plane.offset = offset;
  }
}

void add_box_dividers(const Solid& solid, int surface, const Grid& grid, const std::pair<Vec3, Vec3>& box,
                      std::vector<Plane>& dividers) {
  const Surface& s = solid.surfaces()[surface];
  for (int k = 0; k < 3; ++k)
    for (const double position : {box.first[k], box.second[k]}) {
      Plane plane{grid.rotation.row(k).transpose(), (position - grid.origin[k]) / grid.cell_size, surface};
      if (s.kind == Surface::Kind::plane && s.direction.cross(plane.normal).norm() < same_plane) continue;
      settle(solid, plane);
      add_once(plane, dividers);
    }
}

}  // namespace

void add_cone_dividers(const Solid& solid, int surface, const Vec3& axis, double cosine, std::vector<Plane>& dividers) {
  const Surface& s = solid.surfaces()[surface];
  if (s.radius == 0) return;
  Vec3 across = axis;
  if (s.kind == Surface::Kind::cylinder) across -= axis.dot(s.direction) * s.direction;
  const double length = across.norm();
  if (length < parallel || std::abs(cosine) > length * (1 - parallel)) return;
  across /= length;
  for (const double side : {1.0, -1.0})
    add_once({across, across.dot(s.point) + side * s.radius * cosine / length, surface}, dividers);
}

std::vector<Plane> face_dividers(const std::vector<const FaceSpec*>& faces, const Solid& solid, const Grid& grid) {
  std::vector<Plane> dividers;
  for (const FaceSpec* face : faces) {
    if (!face->box && !face->normal_cone) continue;
    for (int s = 0; s < static_cast<int>(solid.surfaces().size()); ++s) {
      if (!face->selects(solid.surfaces()[s].names)) continue;
      if (face->box) add_box_dividers(solid, s, grid, *face->box, dividers);
      if (face->normal_cone)
        add_cone_dividers(solid, s, grid.rotation.transpose() * face->normal_cone->first, face->normal_cone->second,
                          dividers);
    }
  }
  return dividers;
}

bool divide_faces(const std::vector<Plane>& dividers) {
  return std::any_of(dividers.begin(), dividers.end(), [](const Plane& plane) { return plane.surface >= 0; });
}

std::vector<Plane> crossing_planes(const std::vector<Plane>& planes, const Vec3& corner, double width) {
  std::vector<Plane> result;
  const Vec3 half = Vec3::Constant(0.5 * width);
  for (const Plane& p : planes)
    if (std::abs(p.normal.dot(corner + half) - p.offset) < p.normal.cwiseAbs().dot(half)) result.push_back(p);
  return result;
}

}  // namespace cgcontact
