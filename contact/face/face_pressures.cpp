#include "contact/face/face_pressures.hpp"

#include <cmath>

namespace cgcontact {

std::optional<PressureOnFace> SolvedZone::at(int body, const Vec3& x, const Vec3& normal) const {
  const double along = chart.normal(x).dot(normal) * (body == primary ? 1 : -1);
  if (along < same_side || std::abs(chart.height(x)) > 4 * h) return std::nullopt;
  const FaceGrid& grid = pressure.grid;
  FacePlace place = chart.place(x);
  if (grid.plane_strain) place[0] = 0;
  const FacePlace folded = grid.folded(place);
  int at[2];
  for (int a = 0; a < 2; ++a) at[a] = static_cast<int>(std::floor((folded[a] - grid.low[a]) / grid.spacing[a]));
  // A point at the end of a face lies at the border of the last patch.
  for (const int i : {0, -1, 1})
    for (const int j : {0, -1, 1}) {
      const int row = at[0] + i, column = at[1] + j;
      if (row < 0 || column < 0 || row >= grid.size[0] || column >= grid.size[1]) continue;
      const int patch = row * grid.size[1] + column;
      if (!known[patch]) continue;
      const double on_primary = body == primary ? along : cosine[patch];
      return PressureOnFace{on_primary * pressure.at(place), on_primary * pressure.error[patch]};
    }
  return std::nullopt;
}

std::optional<PressureOnFace> FacePressures::at(int pair, int body, const Vec3& x, const Vec3& normal) const {
  std::optional<PressureOnFace> found;
  for (const SolvedZone& zone : zones) {
    if (zone.pair != pair) continue;
    if (const auto p = zone.at(body, x, normal); p && (!found || p->pressure > found->pressure)) found = p;
  }
  return found;
}

}  // namespace cgcontact
