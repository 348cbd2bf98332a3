#include "core/scene/face_dividers.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace cgcontact {

namespace {

constexpr double same_plane = 1e-9;  // cells, and of the normals: less than what FaceSpec::contains lets pass
constexpr double parallel = 1e-12;   // of a cylinder's axis to that of a cone; of a cone to a half-space or a line

bool coincide(const Vec3& a, double a_offset, const Vec3& b, double b_offset) {
  const double sign = a.dot(b) < 0 ? -1 : 1;
  return (sign * a - b).norm() < same_plane && std::abs(sign * a_offset - b_offset) < same_plane;
}

/// Adds a plane that divides the given surfaces; one that is there already divides these as well.
void add_once(Plane plane, const std::vector<char>& surfaces, std::vector<Plane>& dividers) {
  if (std::find(surfaces.begin(), surfaces.end(), 1) == surfaces.end()) return;
  const auto same = std::find_if(dividers.begin(), dividers.end(), [&](const Plane& other) {
    return other.surfaces && other.of_normals == plane.of_normals &&
           coincide(plane.normal, plane.offset, other.normal, other.offset);
  });
  std::vector<char> all = surfaces;
  if (same != dividers.end())
    std::transform(all.begin(), all.end(), same->surfaces->begin(), all.begin(), std::bit_or<char>());
  plane.surfaces = std::make_shared<const std::vector<char>>(std::move(all));
  if (same != dividers.end())
    same->surfaces = plane.surfaces;
  else
    dividers.push_back(plane);
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

/// Divides the selected surfaces but for planes along the divider.
void add_plane_divider(const Solid& solid, std::vector<char> selected, Plane plane, std::vector<Plane>& dividers) {
  for (std::size_t i = 0; i < selected.size(); ++i) {
    const Surface& s = solid.surfaces()[i];
    if (s.kind == Surface::Kind::plane && s.direction.cross(plane.normal).norm() < same_plane) selected[i] = 0;
  }
  settle(solid, plane);
  add_once(plane, selected, dividers);
}

void add_box_dividers(const Solid& solid, const std::vector<char>& selected, const Grid& grid,
                      const std::pair<Vec3, Vec3>& box, std::vector<Plane>& dividers) {
  for (int k = 0; k < 3; ++k)
    for (const double position : {box.first[k], box.second[k]})
      add_plane_divider(solid, selected,
                        {grid.rotation.row(k).transpose(), (position - grid.origin[k]) / grid.cell_size}, dividers);
}

std::vector<char> surfaces_of(const FaceSpec& face, const Solid& solid) {
  std::vector<char> selected;
  for (const Surface& s : solid.surfaces()) selected.push_back(face.selects(s.names));
  return selected;
}

/// The normals of a cone leave a cone of normals along straight lines through its tip: two for each of its sides.
void divide_cone(const Solid& solid, int surface, const Vec3& axis, double cosine, std::vector<Plane>& dividers) {
  const Surface& s = solid.surfaces()[surface];
  const double along = axis.dot(s.direction);
  const Vec3 across = axis - along * s.direction;
  std::vector<char> divided(solid.surfaces().size(), 0);
  divided[surface] = 1;
  for (const double side : {1.0, -1.0}) {
    const double component = (side * cosine + s.sine * along) / s.cosine;  // of the unit normal across, along `across`
    if (std::abs(component) > across.norm() * (1 - parallel)) continue;
    const Vec3 normal = (across - component * s.sine / s.cosine * s.direction).normalized();
    add_once({normal, normal.dot(s.point)}, divided, dividers);
  }
}

}  // namespace

void add_cone_dividers(const Solid& solid, int surface, const Vec3& axis, double cosine, std::vector<Plane>& dividers) {
  const Surface& s = solid.surfaces()[surface];
  if (s.kind == Surface::Kind::cone) return divide_cone(solid, surface, axis, cosine, dividers);
  if (s.radius == 0) return;
  Vec3 across = axis;
  if (s.kind == Surface::Kind::cylinder) across -= axis.dot(s.direction) * s.direction;
  const double length = across.norm();
  if (length < parallel || std::abs(cosine) > length * (1 - parallel)) return;
  across /= length;
  std::vector<char> divided(solid.surfaces().size(), 0);
  divided[surface] = 1;
  for (const double side : {1.0, -1.0})
    add_once({across, across.dot(s.point) + side * s.radius * cosine / length}, divided, dividers);
}

void add_jump_dividers(const FaceSpec& face, const std::vector<JumpPlane>& jumps, const Solid& solid, const Grid& grid,
                       std::vector<Plane>& dividers) {
  const std::vector<char> selected = surfaces_of(face, solid);
  for (const JumpPlane& jump : jumps)
    add_plane_divider(
        solid, selected,
        {grid.rotation.transpose() * jump.normal, (jump.offset - jump.normal.dot(grid.origin)) / grid.cell_size},
        dividers);
}

std::vector<Plane> face_dividers(const std::vector<const FaceSpec*>& faces, const Solid& solid, const Grid& grid) {
  std::vector<Plane> dividers;
  for (const FaceSpec* face : faces) {
    if (!face->box && !face->normal_cone) continue;
    std::vector<char> selected = surfaces_of(*face, solid);
    if (face->box) add_box_dividers(solid, selected, grid, *face->box, dividers);
    if (!face->normal_cone) continue;
    const Vec3 axis = grid.rotation.transpose() * face->normal_cone->first;
    for (std::size_t s = 0; s < selected.size(); ++s) {
      if (!selected[s]) continue;
      add_cone_dividers(solid, static_cast<int>(s), axis, face->normal_cone->second, dividers);
      if (solid.surfaces()[s].kind != Surface::Kind::patch) selected[s] = 0;
    }
    add_once({axis, face->normal_cone->second, nullptr, true}, selected, dividers);
  }
  return dividers;
}

}  // namespace cgcontact
