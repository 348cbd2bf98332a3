/// Borders of declared faces as planes. A box ends at planes; the points of a sphere or a cylinder with normals within
/// a cone end at planes as well, since the normal is linear in the position there. Boundary facets cut at these belong
/// to a face wholly or not at all.
#pragma once

#include <vector>

#include "core/cells/boundary_points.hpp"
#include "core/cells/grid.hpp"
#include "core/expressions/jump_planes.hpp"
#include "core/scene/scene.hpp"

namespace cgcontact {

/// Returns planes in grid coordinates, each once, that divide the surfaces of a solid (in grid coordinates) at the
/// borders of faces. Plane faces and facets of triangle surfaces lie in a normal cone or outside as a whole (facets are
/// separated by their normals, Plane::of_normals); plane surfaces in a side of a box are on its rim.
std::vector<Plane> face_dividers(const std::vector<const FaceSpec*>& faces, const Solid& solid, const Grid& grid);

/// Appends planes at which a load on the face jumps; surfaces along a plane are not divided.
void add_jump_dividers(const FaceSpec& face, const std::vector<JumpPlane>& jumps, const Solid& solid, const Grid& grid,
                       std::vector<Plane>& dividers);

/// Appends the planes where the normals of a sphere or a cylinder leave the cone about `axis` (unit, grid axes); of
/// both of its sides, since a body may lie on either.
void add_cone_dividers(const Solid& solid, int surface, const Vec3& axis, double cosine, std::vector<Plane>& dividers);

}  // namespace cgcontact
