#include "core/triangles/triangle_faces.hpp"

#include <algorithm>
#include <cmath>

#include "core/triangles/triangle_edges.hpp"

namespace cgcontact {

namespace {

constexpr double slack = 1e-9;  // of the coordinates: corners on the rim of a box or slab count as inside
constexpr double cone_slack = 1e-12;

std::vector<Vec3> unit_normals(const TriangleSoup& soup) {
  std::vector<Vec3> normals;
  normals.reserve(soup.triangles.size());
  for (const Triangle& t : soup.triangles) {
    const Vec3& a = soup.points[t[0]];
    normals.push_back((soup.points[t[1]] - a).cross(soup.points[t[2]] - a).normalized());
  }
  return normals;
}

class FaceNamer {
 public:
  explicit FaceNamer(const TriangleSoup& soup) : soup_(soup), normals_(unit_normals(soup)) {
    for (const Vec3& x : soup.points) size_ = std::max(size_, x.lpNorm<Eigen::Infinity>());
  }

  std::vector<char> select(const TriangleSelector& selector) {
    std::vector<char> selected(soup_.triangles.size(), 1);
    if (selector.smooth) selected = grow(*selector.smooth);
    for (std::size_t t = 0; t < selected.size(); ++t) selected[t] = selected[t] && meets(selector, t);
    return selected;
  }

 private:
  bool meets(const TriangleSelector& selector, std::size_t t) const {
    if (selector.group && !soup_.is_in_group(static_cast<int>(t), *selector.group)) return false;
    if (selector.normal_cone &&
        normals_[t].dot(selector.normal_cone->first) < selector.normal_cone->second - cone_slack)
      return false;
    const double margin = slack * size_;
    for (int p : soup_.triangles[t]) {
      const Vec3& x = soup_.points[p];
      if (selector.box && ((x.array() < selector.box->first.array() - margin).any() ||
                           (x.array() > selector.box->second.array() + margin).any()))
        return false;
      if (selector.plane &&
          std::abs(selector.plane->normal.dot(x - selector.plane->point)) > selector.plane->distance + margin)
        return false;
    }
    return true;
  }

  std::vector<char> grow(const TriangleSelector::Growth& growth) {
    if (neighbours_.empty()) neighbours_ = edge_neighbours(soup_.triangles, soup_.points.size());
    const TriangleSurface surface(soup_.points, soup_.triangles, std::vector<int>(soup_.triangles.size(), 0), {""});
    std::vector<char> reached(soup_.triangles.size(), 0);
    flood(
        neighbours_, surface.nearest(growth.seed).triangle,
        [&](int from, int to) { return !reached[to] && angle_between(normals_[from], normals_[to]) <= growth.angle; },
        [&](int t) { reached[t] = 1; });
    return reached;
  }

  const TriangleSoup& soup_;
  std::vector<Vec3> normals_;
  std::vector<std::array<int, 3>> neighbours_;
  double size_ = 0;
};

}  // namespace

NamedTriangles name_faces(const TriangleSoup& soup, const std::string& part,
                          const std::vector<TriangleSelector>& selectors) {
  NamedTriangles result;
  result.face.assign(soup.triangles.size(), -1);
  FaceNamer namer(soup);
  for (const TriangleSelector& selector : selectors) {
    const std::vector<char> selected = namer.select(selector);
    const int number = static_cast<int>(result.names.size());
    for (std::size_t t = 0; t < selected.size(); ++t) {
      if (!selected[t]) continue;
      if (result.face[t] >= 0)
        throw InputError(selector.location, "\"" + selector.name + "\"",
                         "overlaps the face \"" + selectors[result.face[t]].name + "\": both select " +
                             soup.location(static_cast<int>(t)),
                         "faces of a mesh have no triangle in common");
      result.face[t] = number;
    }
    if (std::find(selected.begin(), selected.end(), 1) == selected.end())
      throw InputError(selector.location, "\"" + selector.name + "\"", "the face selects no triangle",
                       "triangles that meet all selectors given");
    result.names.push_back(part + "." + selector.name);
  }
  const int rest = static_cast<int>(result.names.size());
  if (std::find(result.face.begin(), result.face.end(), -1) != result.face.end())
    result.names.push_back(part + ".rest");
  std::replace(result.face.begin(), result.face.end(), -1, rest);
  return result;
}

TriangleSurface make_surface(const TriangleSoup& soup, const NamedTriangles& faces, double crease_angle) {
  const std::vector<Vec3> normals = unit_normals(soup);
  const auto neighbours = edge_neighbours(soup.triangles, soup.points.size());
  const double min_cosine = std::cos(crease_angle);
  std::vector<int> patch(soup.triangles.size(), -1);
  std::vector<std::string> names;
  for (std::size_t t = 0; t < patch.size(); ++t) {
    if (patch[t] >= 0) continue;
    const int number = static_cast<int>(names.size());
    names.push_back(faces.names[faces.face[t]]);
    flood(
        neighbours, static_cast<int>(t),
        [&](int from, int to) {
          return patch[to] < 0 && faces.face[to] == faces.face[t] && normals[from].dot(normals[to]) >= min_cosine;
        },
        [&](int reached) { patch[reached] = number; });
  }
  return TriangleSurface(soup.points, soup.triangles, std::move(patch), std::move(names));
}

}  // namespace cgcontact
