#include "core/output/plot/cell_faces.hpp"

#include <algorithm>

namespace cgcontact {

namespace {

/// Corners outward, from one at the diagonal that tetrahedra_of_hexahedron divides the face along.
constexpr int squares_of_hexahedron[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                             {1, 2, 6, 5}, {3, 7, 6, 2}, {0, 4, 7, 3}};
constexpr int triangles_of_tetrahedron[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

/// Face of a cell with what it has in common with the same face of another one: its three smallest points.
struct KeyedFace {
  std::array<int, 3> key;
  int polyhedron, number;  ///< of the face in it
};

bool before(const KeyedFace& a, const KeyedFace& b) { return a.key < b.key; }

/// Keeps the faces whose keys are there once.
void keep_single(std::vector<KeyedFace>& faces) {
  std::sort(faces.begin(), faces.end(), before);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].key == faces[i].key) ++end;
    if (end == i + 1) faces[kept++] = faces[i];
    i = end;
  }
  faces.resize(kept);
}

std::vector<KeyedFace> single_squares(const ClippedMesh& mesh) {
  std::vector<KeyedFace> faces;
  faces.reserve(6 * mesh.hexahedra.size());
  for (std::size_t i = 0; i < mesh.hexahedra.size(); ++i)
    for (int f = 0; f < 6; ++f) {
      std::array<int, 4> points;
      for (int v = 0; v < 4; ++v) points[v] = mesh.hexahedra[i][squares_of_hexahedron[f][v]];
      std::sort(points.begin(), points.end());
      faces.push_back({{points[0], points[1], points[2]}, static_cast<int>(i), f});
    }
  keep_single(faces);
  return faces;
}

KeyedFace keyed(std::array<int, 3> points, int triangle) {
  std::sort(points.begin(), points.end());
  return {points, triangle, 0};
}

}  // namespace

void find_boundary(ClippedMesh& mesh) {
  std::vector<BoundaryTriangle> triangles;
  for (const KeyedFace& face : single_squares(mesh)) {
    const auto& h = mesh.hexahedra[face.polyhedron];
    const auto& s = squares_of_hexahedron[face.number];
    const int cell = mesh.cell_of_hexahedron[face.polyhedron];
    for (int k = 0; k < 2; ++k) triangles.push_back({{h[s[0]], h[s[k + 1]], h[s[k + 2]]}, cell, 0, mesh.level(cell)});
  }
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i)
    for (const auto& f : triangles_of_tetrahedron) {
      const auto& t = mesh.tetrahedra[i];
      const int cell = mesh.cell_of_tetrahedron[i];
      triangles.push_back({{t[f[0]], t[f[1]], t[f[2]]}, cell, 0, mesh.level(cell)});
    }
  std::vector<KeyedFace> faces;
  faces.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) faces.push_back(keyed(triangles[i].points, static_cast<int>(i)));
  keep_single(faces);
  std::sort(faces.begin(), faces.end(),
            [](const KeyedFace& a, const KeyedFace& b) { return a.polyhedron < b.polyhedron; });
  mesh.boundary.clear();
  for (const KeyedFace& face : faces) mesh.boundary.push_back(triangles[face.polyhedron]);
}

}  // namespace cgcontact
