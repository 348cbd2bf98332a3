#include "core/drawing/cut_open.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/numbers/rounding.hpp"
#include "core/base/process/parallel.hpp"

namespace cgcontact {
namespace {

struct Vertex {
  Vec3 grid, position, displacement;
  Sym3 stress;
  std::array<double, 2> height;  ///< (x - corner) . d
};

using VertexPolygon = std::vector<Vertex>;

/// Interpolates between two vertices where height k is zero.
Vertex between(const Vertex& a, const Vertex& b, int k) {
  const double t = a.height[k] / (a.height[k] - b.height[k]);
  const auto mean = [t](const auto& x, const auto& y) { return ((1 - t) * x + t * y).eval(); };
  Vertex v{mean(a.grid, b.grid),
           mean(a.position, b.position),
           mean(a.displacement, b.displacement),
           mean(a.stress, b.stress),
           {}};
  v.height[k] = 0;
  v.height[1 - k] = (1 - t) * a.height[1 - k] + t * b.height[1 - k];
  return v;
}

/// Clips a convex polygon to side * height k >= 0.
VertexPolygon clipped(const VertexPolygon& polygon, int k, double side) {
  VertexPolygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vertex &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (side * a.height[k] >= 0) kept.push_back(a);
    if (a.height[k] * b.height[k] < 0) kept.push_back(between(a, b, k));
  }
  return kept;
}

/// Cuts a tetrahedron that reaches below the plane of height k; empty if it does not.
VertexPolygon section(const std::array<Vertex, 4>& tetrahedron, int k) {
  VertexPolygon below, above, points;
  for (const Vertex& v : tetrahedron) (v.height[k] < 0 ? below : v.height[k] > 0 ? above : points).push_back(v);
  if (below.empty()) return {};
  if (below.size() == 2 && above.size() == 2)
    return {between(below[0], above[0], k), between(below[0], above[1], k), between(below[1], above[1], k),
            between(below[1], above[0], k)};
  for (const Vertex& a : below)
    for (const Vertex& b : above) points.push_back(between(a, b, k));
  return points;
}

class Opening {
 public:
  /// Puts what it finds behind what is in `open`.
  Opening(const DrawnBody& whole, const Vec3& corner, const std::array<Vec3, 2>& directions, DrawnBody open = {})
      : whole_(whole), directions_(directions), number_of_(whole.position.size(), -1), open_(std::move(open)) {
    height_.reserve(whole.position.size());
    for (const Vec3& x : whole.position)
      height_.push_back({(x - corner).dot(directions[0]), (x - corner).dot(directions[1])});
  }

  /// All of the boundary, nothing cut.
  DrawnBody boundary() {
    for (const BoundaryTriangle& triangle : whole_.mesh.boundary) keep(triangle);
    return std::move(open_);
  }

  DrawnBody run() {
    for (const BoundaryTriangle& triangle : whole_.mesh.boundary) add_boundary(triangle);
    each_tetrahedron([&](const std::array<int, 4>& tetrahedron, int cell) { add_sections(tetrahedron, cell); });
    return std::move(open_);
  }

  /// Cuts all of the body with the first plane.
  DrawnBody plane() {
    each_tetrahedron([&](const std::array<int, 4>& tetrahedron, int cell) {
      if (meets(tetrahedron, 0)) add(section_of(tetrahedron, 0), cell, -1);
    });
    return std::move(open_);
  }

 private:
  Vertex vertex(int p) const {
    return {whole_.mesh.points[p], whole_.position[p],
            whole_.displacement.empty() ? Vec3(Vec3::Zero()) : whole_.displacement[p],
            whole_.stress.empty() ? Sym3(Sym3::Zero()) : whole_.stress[p], height_[p]};
  }

  template <class Use>
  void each_tetrahedron(const Use& use) const {
    const ClippedMesh& mesh = whole_.mesh;
    for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) use(mesh.tetrahedra[i], mesh.cell_of_tetrahedron[i]);
    for (std::size_t i = 0; i < mesh.hexahedra.size(); ++i) {
      const auto& h = mesh.hexahedra[i];
      if (!meets(h, 0) && !meets(h, 1)) continue;
      for (const auto& t : tetrahedra_of_hexahedron)
        use({h[t[0]], h[t[1]], h[t[2]], h[t[3]]}, mesh.cell_of_hexahedron[i]);
    }
  }

  /// Cuts a tetrahedron with the plane of height k; the polygon is turned towards its direction.
  VertexPolygon section_of(const std::array<int, 4>& t, int k) const {
    VertexPolygon polygon = section({vertex(t[0]), vertex(t[1]), vertex(t[2]), vertex(t[3])}, k);
    if (polygon.size() < 3) return {};
    const Vec3 &a = polygon[0].position, &b = polygon[1].position, &c = polygon[2].position;
    if ((b - a).cross(c - a).dot(directions_[k]) < 0) std::reverse(polygon.begin(), polygon.end());
    return polygon;
  }

  /// Returns whether the points reach below the plane of height k, and up to it.
  template <class Points>
  bool meets(const Points& points, int k) const {
    return std::any_of(points.begin(), points.end(), [&](int p) { return height_[p][k] < 0; }) &&
           std::any_of(points.begin(), points.end(), [&](int p) { return height_[p][k] >= 0; });
  }

  /// Most triangles are away from the planes: these are kept as they are, or none of them is.
  void add_boundary(const BoundaryTriangle& triangle) {
    const auto all = [&](int k, double side) {
      return std::all_of(triangle.points.begin(), triangle.points.end(),
                         [&](int p) { return side * height_[p][k] > 0; });
    };
    if (all(0, -1) || (all(0, 1) && all(1, -1))) return keep(triangle);
    if (all(0, 1) && all(1, 1)) return;
    const VertexPolygon whole{vertex(triangle.points[0]), vertex(triangle.points[1]), vertex(triangle.points[2])};
    add(clipped(whole, 0, -1), triangle.cell, triangle.surface);
    add(clipped(clipped(whole, 0, 1), 1, -1), triangle.cell, triangle.surface);
  }

  void add_sections(const std::array<int, 4>& tetrahedron, int cell) {
    for (int k = 0; k < 2; ++k) {
      if (!meets(tetrahedron, k)) continue;
      const VertexPolygon polygon = section_of(tetrahedron, k);
      add(clipped(polygon, 1 - k, 1), cell, -1);
    }
  }

  /// With the points that its neighbours have.
  void keep(BoundaryTriangle triangle) {
    for (int& p : triangle.points) {
      int& number = number_of_[p];
      if (number < 0) number = add_point(vertex(p), whole_.mesh.cell_of_point[p]);
      p = number;
    }
    open_.mesh.boundary.push_back(triangle);
  }

  int add_point(const Vertex& v, int cell) {
    open_.mesh.points.push_back(v.grid);
    open_.mesh.cell_of_point.push_back(cell);
    open_.position.push_back(v.position);
    if (!whole_.displacement.empty()) open_.displacement.push_back(v.displacement);
    if (!whole_.stress.empty()) open_.stress.push_back(v.stress);
    return static_cast<int>(open_.position.size()) - 1;
  }

  void add(const VertexPolygon& polygon, int cell, int surface) {
    if (polygon.size() < 3) return;
    const int first = static_cast<int>(open_.position.size());
    for (const Vertex& v : polygon) add_point(v, cell);
    for (int i = 2; i < static_cast<int>(polygon.size()); ++i)
      open_.mesh.boundary.push_back({{first, first + i - 1, first + i}, cell, surface, whole_.mesh.level(cell)});
  }

  const DrawnBody& whole_;
  const std::array<Vec3, 2>& directions_;
  std::vector<std::array<double, 2>> height_;  ///< of the points of the whole body
  std::vector<int> number_of_;                 ///< those that are kept: among the points of the open one; -1: not yet
  DrawnBody open_;
};

/// Returns the interior cells that planes meet, as a drawn body of their own.
DrawnBody interior_at(const DrawnBody& whole, const Vec3& corner, const std::array<Vec3, 2>& directions) {
  const ClippedMesh& mesh = whole.mesh;
  DrawnBody near;
  near.mesh.level_of_cell = mesh.level_of_cell;
  std::vector<char> met(mesh.interior.cells.size(), 0);
  parallel_for("cgcontact::cut_open::interior", met.size(), grain_of_light, [&](std::size_t i) {
    const int cell = mesh.interior.cells[i];
    const Vec3 middle = global_position(*mesh.cut_cells, cell, Vec3::Zero()) - corner;
    const double reach = 0.5 * std::sqrt(3.0) * (1 + rounding) * mesh.cut_cells->h(cell);
    met[i] = std::abs(middle.dot(directions[0])) <= reach || std::abs(middle.dot(directions[1])) <= reach;
  });
  std::vector<int> points;  // of the whole
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (!met[i]) continue;
    near.mesh.hexahedra.push_back(mesh.interior_hexahedron(i));
    near.mesh.cell_of_hexahedron.push_back(mesh.interior.cells[i]);
    points.insert(points.end(), near.mesh.hexahedra.back().begin(), near.mesh.hexahedra.back().end());
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  for (auto& hexahedron : near.mesh.hexahedra)
    for (int& p : hexahedron) p = static_cast<int>(std::lower_bound(points.begin(), points.end(), p) - points.begin());
  std::vector<int> interior;
  for (const int p : points) {
    const auto index = static_cast<std::size_t>(p);
    if (index >= mesh.points.size()) {
      interior.push_back(p - static_cast<int>(mesh.points.size()));
      continue;
    }
    near.mesh.points.push_back(mesh.points[index]);
    near.position.push_back(whole.position[index]);
    near.mesh.cell_of_point.push_back(mesh.cell_of_point[index]);
    if (!whole.displacement.empty()) near.displacement.push_back(whole.displacement[index]);
    if (!whole.stress.empty()) near.stress.push_back(whole.stress[index]);
  }
  if (interior.empty()) return near;
  const PointValues values = whole.interior(mesh, interior);
  for (const int p : interior) {
    near.mesh.points.push_back(mesh.interior_point(p));
    near.position.push_back(interior_position(whole, p));
    near.mesh.cell_of_point.push_back(mesh.interior.cell_of_point[p]);
  }
  near.displacement.insert(near.displacement.end(), values.displacement.begin(), values.displacement.end());
  near.stress.insert(near.stress.end(), values.stress.begin(), values.stress.end());
  return near;
}

}  // namespace

DrawnBody boundary_of(const DrawnBody& whole) {
  return Opening(whole, Vec3::Zero(), {Vec3::UnitX(), Vec3::UnitY()}).boundary();
}

DrawnBody section_of(const DrawnBody& whole, const Vec3& point, const Vec3& normal) {
  const std::array<Vec3, 2> normals{normal, normal};
  DrawnBody section = Opening(whole, point, normals).plane();
  return Opening(interior_at(whole, point, normals), point, normals, std::move(section)).plane();
}

DrawnBody cut_open(const DrawnBody& whole, const Vec3& corner, const std::array<Vec3, 2>& directions) {
  DrawnBody open = Opening(whole, corner, directions).run();
  return Opening(interior_at(whole, corner, directions), corner, directions, std::move(open)).run();
}

}  // namespace cgcontact
