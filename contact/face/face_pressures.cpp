#include "contact/face/face_pressures.hpp"

#include <cmath>

namespace cgcontact {

std::optional<double> SolvedZone::at(int body, const Vec3& x, const Vec3& normal) const {
  const double cosine = chart.normal(x).dot(normal) * (body == primary ? 1 : -1);
  if (cosine < same_side || std::abs(chart.height(x)) > 4 * h) return std::nullopt;
  const FaceGrid& grid = pressure.grid;
  FacePlace place = chart.place(x);
  if (grid.plane_strain) place[0] = 0;
  const FacePlace folded = grid.folded(place);
  int at[2];
  for (int a = 0; a < 2; ++a) at[a] = static_cast<int>(std::floor((folded[a] - grid.low[a]) / grid.spacing[a]));
  // A point at the end of a face lies at the border of the last patch.
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j) {
      const int row = at[0] + i, column = at[1] + j;
      if (row < 0 || column < 0 || row >= grid.size[0] || column >= grid.size[1]) continue;
      if (known[row * grid.size[1] + column]) return cosine * pressure.at(place);
    }
  return std::nullopt;
}

std::optional<double> FacePressures::at(int pair, int body, const Vec3& x, const Vec3& normal) const {
  std::optional<double> found;
  for (const SolvedZone& zone : zones) {
    if (zone.pair != pair) continue;
    if (const auto p = zone.at(body, x, normal); p && (!found || *p > *found)) found = p;
  }
  return found;
}

}  // namespace cgcontact
