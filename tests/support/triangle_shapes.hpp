/// Closed triangle surfaces of known shapes, for tests.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/triangles/triangle_faces.hpp"

namespace cgcontact::test {

inline TriangleSoup box_soup(const Vec3& min, const Vec3& max) {
  TriangleSoup soup;
  for (int c = 0; c < 8; ++c)
    soup.points.push_back(Vec3(c & 1 ? max[0] : min[0], c & 2 ? max[1] : min[1], c & 4 ? max[2] : min[2]));
  soup.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return soup;
}

inline TriangleSoup tetrahedron_soup() {
  return {{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, {}, {}};
}

inline TriangleSoup octahedron_soup(double r) {
  return {{{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}},
          {},
          {}};
}

/// Prism over a polygon (counterclockwise) all of whose corners `centre` sees.
inline TriangleSoup prism_soup(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& centre,
                               double height) {
  TriangleSoup soup;
  const int n = static_cast<int>(corners.size());
  for (const double z : {0.0, height}) {
    for (const Eigen::Vector2d& c : corners) soup.points.push_back({c[0], c[1], z});
    soup.points.push_back({centre[0], centre[1], z});
  }
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n, up = n + 1;
    soup.triangles.push_back({i, j, up + j});
    soup.triangles.push_back({i, up + j, up + i});
    soup.triangles.push_back({n, j, i});
    soup.triangles.push_back({up + n, up + i, up + j});
  }
  return soup;
}

/// Polygon with n corners, those with odd numbers at radius `inner`.
inline std::vector<Eigen::Vector2d> star(int n, double radius, double inner) {
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i < n; ++i) {
    const double r = i % 2 ? inner : radius, angle = 2 * pi * i / n;
    corners.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return corners;
}

/// Gear: teeth with flat tops and bottoms.
inline std::vector<Eigen::Vector2d> gear(int teeth, double outer, double inner) {
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i < 4 * teeth; ++i) {
    const double r = i % 4 < 2 ? outer : inner, angle = 2 * pi * i / (4 * teeth);
    corners.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return corners;
}

inline TriangleSoup sphere_soup(double radius, int rings) {
  TriangleSoup soup;
  const int segments = 2 * rings;
  soup.points.push_back({0, 0, -radius});
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < segments; ++j) {
      const double theta = pi * i / rings, phi = 2 * pi * j / segments;
      soup.points.push_back(radius *
                            Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), -std::cos(theta)));
    }
  soup.points.push_back({0, 0, radius});
  const int last = static_cast<int>(soup.points.size()) - 1;
  const auto node = [&](int i, int j) { return 1 + (i - 1) * segments + j % segments; };
  for (int j = 0; j < segments; ++j) {
    soup.triangles.push_back({0, node(1, j + 1), node(1, j)});
    soup.triangles.push_back({last, node(rings - 1, j), node(rings - 1, j + 1)});
    for (int i = 1; i + 1 < rings; ++i) {
      soup.triangles.push_back({node(i, j), node(i, j + 1), node(i + 1, j + 1)});
      soup.triangles.push_back({node(i, j), node(i + 1, j + 1), node(i + 1, j)});
    }
  }
  return soup;
}

inline TriangleSoup torus_soup(double major, double minor, int n) {
  TriangleSoup soup;
  const int m = n / 2;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double u = 2 * pi * i / n, v = 2 * pi * j / m, r = major + minor * std::cos(v);
      soup.points.push_back({r * std::cos(u), r * std::sin(u), minor * std::sin(v)});
    }
  const auto node = [&](int i, int j) { return i % n * m + j % m; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      soup.triangles.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1)});
      soup.triangles.push_back({node(i, j), node(i + 1, j + 1), node(i, j + 1)});
    }
  return soup;
}

struct NamedSoup {
  std::string name;
  TriangleSoup soup;
};

/// Ten shapes of a few cells' size: convex, not convex, thin, with a hole, with many small and with few large
/// triangles.
inline std::vector<NamedSoup> ten_shapes() {
  return {{"cube", box_soup({0, 0, 0}, {3, 3, 3})},
          {"tetrahedron", tetrahedron_soup()},
          {"octahedron", octahedron_soup(2)},
          {"l_block", prism_soup({{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}}, {0.5, 0.5}, 2)},
          {"gear", prism_soup(gear(9, 3, 2), {0, 0}, 1)},
          {"star", prism_soup(star(10, 3, 1), {0, 0}, 2)},
          {"cylinder", prism_soup(star(40, 2, 2), {0, 0}, 3)},
          {"plate", box_soup({0, 0, 0}, {5, 4, 0.03})},
          {"sphere", sphere_soup(2, 12)},
          {"torus", torus_soup(2.5, 0.8, 24)}};
}

/// All triangles belong to the face "part.rest".
inline TriangleSurface surface_of(const TriangleSoup& soup) {
  return make_surface(soup, name_faces(soup, "part", {}), default_crease_angle);
}

}  // namespace cgcontact::test
