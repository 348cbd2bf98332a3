#include "core/bodies/local_solid.hpp"

#include <fmt/format.h>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

namespace {

constexpr double touch_tolerance = 1e-10;  // a surface this near to a cell is taken to cross it

double radial_distance(const Surface& surface, const Vec3& x) { return surface.signed_distance(x) + surface.radius; }

int side_of_interval(double min, double max) {
  if (max < -touch_tolerance) return 1;
  return min > touch_tolerance ? 0 : -1;
}

std::string too_many_surfaces(const CsgBody& solid, const std::vector<int>& surfaces) {
  constexpr std::size_t max_names = 8;
  std::string names;
  std::size_t count = 0;
  for (const int s : surfaces)
    for (const std::string& name : solid.surfaces()[s].names)
      if (++count <= max_names) names += (names.empty() ? "" : ", ") + name;
  if (count > max_names) names += fmt::format(" and {} more", count - max_names);
  return fmt::format("{} surfaces meet in one cell, {} can: {}", surfaces.size(), max_table_bits, names);
}

/// Removes the surfaces without influence from the table.
void drop_irrelevant(LocalSolid& local) {
  for (int i = static_cast<int>(local.surfaces.size()) - 1; i >= 0; --i) {
    const std::size_t bit = std::size_t{1} << i;
    bool matters = false;
    for (std::size_t m = 0; m < local.table.size() && !matters; ++m)
      matters = !(m & bit) && local.table[m] != local.table[m | bit];
    if (matters) continue;
    std::vector<unsigned char> table;
    for (std::size_t m = 0; m < local.table.size(); ++m)
      if (!(m & bit)) table.push_back(local.table[m]);
    local.table.swap(table);
    local.surfaces.erase(local.surfaces.begin() + i);
  }
}

}  // namespace

int side_of_box(const Surface& surface, const Vec3& centre, const Vec3& half_size) {
  if (surface.kind == Surface::Kind::plane) {
    const double d = surface.signed_distance(centre), reach = surface.direction.cwiseAbs().dot(half_size);
    return side_of_interval(d - reach, d + reach);
  }
  if (surface.kind == Surface::Kind::sphere) {
    const Vec3 d = (centre - surface.point).cwiseAbs();
    const double nearest = (d - half_size).cwiseMax(0.0).norm(), farthest = (d + half_size).norm();
    return side_of_interval(nearest - surface.radius, farthest - surface.radius);
  }
  if (surface.kind == Surface::Kind::cone) {
    const double distance = surface.signed_distance(centre), diagonal = half_size.norm();
    return side_of_interval(distance - diagonal, distance + diagonal);
  }
  const double d = radial_distance(surface, centre), reach = half_size.norm();
  return side_of_interval(d - reach - surface.radius, d + reach - surface.radius);
}

LocalSolid make_local_solid(const CsgBody& solid, const std::vector<signed char>& sides) {
  LocalSolid local;
  std::vector<signed char> trial = sides;
  for (std::size_t i = 0; i < sides.size(); ++i)
    if (sides[i] < 0) local.surfaces.push_back(static_cast<int>(i));
  const int m = static_cast<int>(local.surfaces.size());
  if (m > max_table_bits) throw InputError(too_many_surfaces(solid, local.surfaces));
  local.table.resize(std::size_t{1} << m);
  for (std::size_t mask = 0; mask < local.table.size(); ++mask) {
    for (int i = 0; i < m; ++i) trial[local.surfaces[i]] = mask >> i & 1;
    local.table[mask] = solid.evaluate_partial(trial) == 1;
  }
  drop_irrelevant(local);
  return local;
}

LocalSolid make_local_solid(const CsgBody& solid, const Vec3& corner, double width) {
  const Vec3 half = Vec3::Constant(0.5 * width);
  std::vector<signed char> sides;
  for (const Surface& s : solid.surfaces())
    sides.push_back(static_cast<signed char>(side_of_box(s, corner + half, half)));
  return make_local_solid(solid, sides);
}

}  // namespace cgcontact
