#include "core/geometry/body_geometry.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {

std::shared_ptr<const BodyGeometry> BodyGeometry::on_level(int level, const CellTree&) const {
  return transformed(Mat3::Identity(), Vec3::Zero(), std::ldexp(1.0, level));
}

int BodyGeometry::side_of_block(const Vec3&, const Vec3&, std::vector<signed char>&) const { return -1; }

double BodyGeometry::facet_width(const Vec3&, double) const { return 0; }

std::vector<int> BodyGeometry::surfaces_near(const Vec3& centre, double half_size, double slack,
                                             const std::vector<int>& candidates) const {
  const double half_diagonal = half_size * std::sqrt(3.0);
  std::vector<int> near;
  for (int s : candidates)
    if (std::abs(surfaces_[s].signed_distance(centre)) <= half_diagonal + slack) near.push_back(s);
  return near;
}

bool BodyGeometry::is_inside(const std::vector<char>& inner_side, const std::vector<int>& near,
                             const Vec3& centroid) const {
  const auto inner = [&](int s) { return inner_side[s] != 0; };
  const bool any = std::any_of(near.begin(), near.end(), inner), all = std::all_of(near.begin(), near.end(), inner);
  return any == all ? any : contains(centroid);
}

double BodyGeometry::signed_distance(const Vec3& x) const {
  const double distance = distance_to_surfaces(x);
  return contains(x) ? -distance : distance;
}

void BodyGeometry::each_facet_in_cell(const UseFacet&) const {}

}  // namespace cgcontact
