/// Surfaces of a body that cross a cell or a box in one.
#pragma once

#include <vector>

#include "core/bodies/csg_body.hpp"

namespace cgcontact {

/// Returns the side of a surface on which a box lies: 1 inner, 0 outer, -1 if the surface may cross or touch it.
/// Conservative.
int side_of_box(const Surface& surface, const Vec3& centre, const Vec3& half_size);

/// Surfaces that cross a box and matter there, and the boolean over their signs (bit i: on the inner side).
struct LocalSolid {
  std::vector<int> surfaces;
  std::vector<unsigned char> table;
  bool is_constant() const { return surfaces.empty(); }
};
/// `sides` as for CsgBody::evaluate_partial.
LocalSolid make_local_solid(const CsgBody& solid, const std::vector<signed char>& sides);
/// At most this many surfaces can cross a cell; make_local_solid throws InputError with the names of more.
constexpr int max_table_bits = 16;
/// Restricts the solid to the cube [corner, corner + width]^3.
LocalSolid make_local_solid(const CsgBody& solid, const Vec3& corner, double width);

}  // namespace cgcontact
