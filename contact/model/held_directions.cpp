#include "contact/model/held_directions.hpp"

namespace cgcontact {
namespace {

void add_cylindrical(const SupportSpec& support, const Axis& axis, const Vec3& x, std::vector<HeldDirection>& held) {
  const Vec3 r = x - axis.point, across = r - r.dot(axis.direction) * axis.direction;
  const Vec3 radial = across.normalized(), directions[3] = {radial, axis.direction.cross(radial), axis.direction};
  for (int k = 0; k < 3; ++k)
    if (support.cylindrical[k])
      held.push_back(
          {static_cast<Held>(static_cast<int>(Held::radial) + k), directions[k], (*support.cylindrical[k])(x)});
}

}  // namespace

std::vector<HeldDirection> held_at(const SupportSpec& support, const SupportedFace& face, const Vec3& x,
                                   const Vec3& n) {
  std::vector<HeldDirection> held;
  if (support.holds_normal())
    held.push_back({Held::normal, n, support.normal_displacement ? (*support.normal_displacement)(x) : 0.0});
  for (int k = 0; k < 3; ++k)
    if (support.displacement[k]) held.push_back({static_cast<Held>(k), Vec3::Unit(k), (*support.displacement[k])(x)});
  if (support.is_cylindrical()) add_cylindrical(support, face.axis, x, held);
  for (int k = 0; k < 4; ++k)
    if (const double spring = support.springs[k]; spring > 0)
      held.push_back(
          {static_cast<Held>(k), k < 3 ? Vec3(Vec3::Unit(k)) : n, 0, support.of_face ? spring / face.area : spring});
  return held;
}

}  // namespace cgcontact
