/// Drawn body without the quarter of space that hides its inside, and cut along a plane.
#pragma once

#include <array>

#include "core/drawing/drawn_body.hpp"

namespace cgcontact {

/// Removes from `whole` where (x - corner) . d > 0 for both directions d: returns its boundary and the sections, cut
/// through the cells of its mesh; displacement and stress linear along their edges. No volume. Triangles of the
/// sections have `surface` -1.
DrawnBody cut_open(const DrawnBody& whole, const Vec3& corner, const std::array<Vec3, 2>& directions);

/// Cuts the cells of the mesh with a plane, turned towards `normal`; as the sections of cut_open.
DrawnBody section_of(const DrawnBody& whole, const Vec3& point, const Vec3& normal);

/// Returns the boundary alone, with the points that it has.
DrawnBody boundary_of(const DrawnBody& whole);

}  // namespace cgcontact
