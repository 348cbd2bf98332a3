#include "contact/model/opposite_borders.hpp"

#include <cmath>

#include "contact/model/opposite_points.hpp"
#include "core/base/numbers/rounding.hpp"

namespace cgcontact {
namespace {

/// Plane of the grid of one body in the coordinates of another's.
Plane moved(const Plane& plane, const Grid& from, const Grid& to) {
  const Vec3 normal = from.rotation * plane.normal;
  const double offset = plane.offset * from.cell_size + normal.dot(from.origin - to.origin);
  return {to.rotation.transpose() * normal, offset / to.cell_size};
}

/// The points x whose line along n meets the border on the plane m . y = c: those of a plane.
Plane seen_along(const Vec3& n, const Plane& border, const Vec3& m, double c) {
  const double slope = border.normal.dot(n) / m.dot(n);
  const Vec3 normal = border.normal - slope * m;
  return {normal.normalized(), (border.offset - slope * c) / normal.norm()};
}

}  // namespace

std::vector<Plane> box_dividers(const CutCells& cut_cells, const FaceSpec& face) {
  FaceSpec box = face;
  box.normal_cone.reset();
  return face_dividers({&box}, cut_cells.solid, cut_cells.grid);
}

std::vector<Plane> opposite_borders(const CutCells& own, int surface, const CutCells& other, const FaceSpec& face,
                                    const std::vector<Plane>& dividers) {
  std::vector<Plane> borders;
  const Surface& s = own.solid.surfaces()[surface];
  for (const Plane& divider : dividers) {
    const Plane border = moved(divider, other.grid, own.grid);
    if (s.kind != Surface::Kind::plane || std::abs(border.normal.dot(s.direction)) < rounding) {
      borders.push_back(border);
      continue;
    }
    for (std::size_t i = 0; i < other.solid.surfaces().size(); ++i) {
      const Surface& opposite = other.solid.surfaces()[i];
      if (opposite.kind != Surface::Kind::plane || !divider.divides(static_cast<int>(i))) continue;
      const Plane plane = moved({opposite.direction, opposite.direction.dot(opposite.point)}, other.grid, own.grid);
      if (std::abs(plane.normal.dot(s.direction)) < min_facing_cosine) continue;
      const Plane seen = seen_along(s.direction, border, plane.normal, plane.offset);
      if (seen.normal.cross(s.direction).norm() > rounding) borders.push_back(seen);
    }
  }
  if (face.normal_cone) {
    const Vec3 axis =
        own.grid.rotation.transpose() * face.normal_cone->first;  // both sides: also of the opposite normals
    add_cone_dividers(own.solid, surface, axis, face.normal_cone->second, borders);
    for (Plane& border : borders) border.surfaces = nullptr;
  }
  return borders;
}

}  // namespace cgcontact
