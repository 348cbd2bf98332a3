/// Boolean operations on bodies. With triangles in an operand by CGAL's corefinement in exact arithmetic. Other
/// operands are replaced by triangles first: planes as they are, spheres and cylinders by facets with their corners on
/// the surface.
#pragma once

#include <optional>
#include <utility>

#include "core/bodies/csg_body.hpp"

namespace cgcontact {

/// Returns the corners of the box around those of both that are bounded.
std::pair<Vec3, Vec3> box_around(const Solid& a, const Solid& b);

/// Returns a op b (unite, intersect, subtract) as one expression of surfaces, exactly; nullopt unless both are such.
std::optional<Solid> combine_expressions(BooleanOp::Kind op, const Solid& a, const Solid& b);

struct TriangleBoolean {
  Solid solid;             ///< bounded by triangles; faces keep their names
  double facet_error = 0;  ///< m: facets are at most this far inside the sphere or cylinder they stand for; 0: none
};

/// Computes a op b (unite, intersect, subtract). `cell_size` (m) of the body sets the facets: at most half a cell long
/// and a thousandth of a cell from their surface, up to a million facets. Where faces of both coincide, the result has
/// the name of a's. Throws InputError if the result is empty, unbounded, or touches itself along an edge.
TriangleBoolean combine_triangles(BooleanOp::Kind op, const Solid& a, const Solid& b, double cell_size);

}  // namespace cgcontact
