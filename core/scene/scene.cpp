#include "core/scene/scene.hpp"

#include <algorithm>

namespace cgcontact {

namespace {

constexpr double box_tolerance =
    1e-9;  // of the size of the coordinates: points on the rim of a flat box count as inside
constexpr double cone_tolerance = 1e-12;
/// Fraction of the body's longest side by which a point on the boundary may be outside by rounding.
constexpr double boundary_tolerance = 1e-9;

bool holds_within(const Solid& solid, const Vec3& x, double reach) {
  if (solid.contains(x)) return true;
  for (int i : {-1, 0, 1})  // the cube around it
    for (int j : {-1, 0, 1})
      for (int k : {-1, 0, 1})
        if (solid.contains(x + reach * Vec3(i, j, k))) return true;
  return false;
}

}  // namespace

bool BodySpec::holds(const Vec3& x) const {
  Vec3 min, max;
  solid.bounding_box(min, max);
  return holds_within(solid, x, boundary_tolerance * (max - min).maxCoeff());
}

bool BodySpec::is_beside_owners(const FaceSpec& face, Vec3 x) const {
  if (face.owners.empty()) return false;
  Vec3 min, max;
  solid.bounding_box(min, max);
  if (plane_strain) {  // the cells are not as thick as the body
    const int across = static_cast<int>(*plane_strain);
    x[across] = 0.5 * (min[across] + max[across]);
  }
  const double reach = boundary_tolerance * (max - min).maxCoeff();
  return std::none_of(face.owners.begin(), face.owners.end(),
                      [&](const Solid& owner) { return holds_within(owner, x, reach); });
}

bool FaceSpec::selects(const std::vector<std::string>& names) const {
  const auto is_listed = [this](const std::string& listed) {
    return std::find(surfaces.begin(), surfaces.end(), listed) != surfaces.end();
  };
  return surfaces.empty() || std::any_of(names.begin(), names.end(), is_listed);
}

bool FaceSpec::contains(const Vec3& x, const Vec3& n) const {
  if (box) {
    const double slack =
        box_tolerance * std::max(box->first.lpNorm<Eigen::Infinity>(), box->second.lpNorm<Eigen::Infinity>());
    if ((x.array() < box->first.array() - slack).any() || (x.array() > box->second.array() + slack).any()) return false;
  }
  return !normal_cone || n.dot(normal_cone->first) >= normal_cone->second - cone_tolerance;
}

const std::vector<std::string>& coordinate_names() {
  static const std::vector<std::string> names{"x", "y", "z"};
  return names;
}

const std::string& name_of(Coordinate coordinate) { return coordinate_names()[static_cast<std::size_t>(coordinate)]; }

const char* name_of(Held component) {
  static const char* const names[num_held] = {"x", "y", "z", "normal", "radial", "tangential", "axial"};
  return names[static_cast<int>(component)];
}

ReferenceSpec Scene::reference_at(double contact_force) const {
  return reference_of_force && contact_force > 0 ? reference_of_force(contact_force) : reference;
}

}  // namespace cgcontact
