#include "recovery/patch/tangents.hpp"

namespace cgcontact {

std::pair<Vec3, Vec3> tangents(const Vec3& n) {
  // A fixed choice with one threshold: rounding of n does not turn the frame.
  const Vec3 t1 = n.cross(std::abs(n[0]) < 0.9 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
  return {t1, n.cross(t1)};
}

}  // namespace cgcontact
