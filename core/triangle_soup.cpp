#include "core/triangle_soup.hpp"

#include <fmt/format.h>

namespace cgcontact {

std::string TriangleSoup::place(int triangle) const {
  const Triangle& t = triangles[triangle];
  const Vec3 x = (points[t[0]] + points[t[1]] + points[t[2]]) / 3;
  const int given = number.empty() ? triangle + 1 : number[triangle];
  const std::string where = line.empty() ? "" : fmt::format(" (line {})", line[triangle]);
  return fmt::format("triangle {}{} at ({:.6g}, {:.6g}, {:.6g})", given, where, x[0], x[1], x[2]);
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

}  // namespace cgcontact
