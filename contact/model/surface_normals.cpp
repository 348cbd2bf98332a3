#include "contact/model/surface_normals.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {

SurfaceNormals::SurfaceNormals(const BodyModel& body) : body_(body), surfaces_of_cell_(body.cut_cells.cells.size()) {
  const BoundaryPoints& boundary = body.cut_cells.boundary;
  for (std::size_t p = 0; p < boundary.size(); ++p) {
    std::vector<int>& list = surfaces_of_cell_[boundary.cell[p]];
    if (std::find(list.begin(), list.end(), boundary.surface[p]) == list.end()) list.push_back(boundary.surface[p]);
  }
}

Vec3 SurfaceNormals::operator()(int cell, const Vec3& x) const {
  double nearest = 1e300;
  Vec3 normal = Vec3::Zero();
  for (const int s : surfaces_of_cell_[cell]) {
    const Surface& surface = body_.cut_cells.solid.surfaces()[s];
    const double distance = std::abs(surface.signed_distance(x));
    if (distance >= nearest) continue;
    nearest = distance;
    normal = surface.gradient(x);
  }
  return body_.cut_cells.grid.rotation * normal;
}

}  // namespace cgcontact
