#include "core/bodies/booleans.hpp"

namespace cgcontact {

std::pair<Vec3, Vec3> box_around(const Solid& a, const Solid& b) {
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (const Solid* solid : {&a, &b}) {
    Vec3 min, max;
    if (!solid->bounding_box(min, max)) continue;
    low = low.cwiseMin(min);
    high = high.cwiseMax(max);
  }
  return {low, high};
}

std::optional<Solid> combine_expressions(BooleanOp::Kind op, const Solid& a, const Solid& b) {
  if (!as_csg(a) || !as_csg(b)) return std::nullopt;
  return op == BooleanOp::Kind::unite       ? Solid::unite(a, b)
         : op == BooleanOp::Kind::intersect ? Solid::intersect(a, b)
                                            : Solid::subtract(a, b);
}

}  // namespace cgcontact
