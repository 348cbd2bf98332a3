#include "core/triangles/triangle_soup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace cgcontact {

std::string TriangleSoup::location(int triangle) const {
  const Triangle& t = triangles[triangle];
  const Vec3 x = (points[t[0]] + points[t[1]] + points[t[2]]) / 3;
  const int given = number.empty() ? triangle + 1 : number[triangle];
  const std::string where = line.empty() ? "" : fmt::format(" (line {})", line[triangle]);
  return fmt::format("triangle {}{} at ({:.6g}, {:.6g}, {:.6g})", given, where, x[0], x[1], x[2]);
}

bool TriangleSoup::is_in_group(int triangle, const std::string& name) const {
  const int facet = number.empty() ? triangle + 1 : number[triangle];
  return std::any_of(groups.begin(), groups.end(), [&](const FacetGroup& group) {
    return group.name == name && group.first <= facet && facet <= group.last;
  });
}

void TriangleSoup::keep(const std::vector<char>& kept) {
  if (number.empty())
    for (std::size_t t = 0; t < triangles.size(); ++t) number.push_back(static_cast<int>(t) + 1);
  std::size_t n = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!kept[t]) continue;
    triangles[n] = triangles[t];
    number[n] = number[t];
    if (!line.empty()) line[n] = line[t];
    ++n;
  }
  triangles.resize(n);
  number.resize(n);
  if (!line.empty()) line.resize(n);
}

int TriangleSoup::drop_collapsed() {
  std::vector<char> kept(triangles.size(), 1);
  int gone = 0;
  for (std::size_t t = 0; t < kept.size(); ++t) {
    const Triangle& c = triangles[t];
    if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) continue;
    kept[t] = 0;
    ++gone;
  }
  if (gone > 0) keep(kept);
  return gone;
}

double TriangleSoup::signed_volume() const {
  if (triangles.empty()) return 0;
  const Vec3 origin = points[triangles[0][0]];
  double volume = 0;
  for (const Triangle& t : triangles)
    volume += (points[t[0]] - origin).dot((points[t[1]] - origin).cross(points[t[2]] - origin)) / 6;
  return volume;
}

double TriangleSoup::diagonal() const {
  Vec3 low = points.at(0), high = low;
  for (const Vec3& x : points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  return (high - low).norm();
}

int TriangleSoup::merge(std::vector<int> candidates, double distance) {
  std::stable_sort(candidates.begin(), candidates.end(), [&](int a, int b) { return points[a][0] < points[b][0]; });
  std::vector<int> target(points.size());
  std::iota(target.begin(), target.end(), 0);
  int merged = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const int a = candidates[i];
    if (target[a] != a) continue;
    for (std::size_t j = i + 1; j < candidates.size() && points[candidates[j]][0] - points[a][0] <= distance; ++j) {
      const int b = candidates[j];
      if (target[b] != b || (points[b] - points[a]).norm() > distance) continue;
      target[b] = a;
      ++merged;
    }
  }
  for (Triangle& t : triangles)
    for (int& p : t) p = target[p];
  return merged;
}

}  // namespace cgcontact
