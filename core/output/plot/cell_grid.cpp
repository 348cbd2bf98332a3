#include "core/output/plot/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "core/drawing/scene_view.hpp"

namespace cgcontact {

namespace {

constexpr double rounding_of_cells = 1e-6;  ///< over their size
constexpr int most_levels = 40;

/// Whole cell: level, and its edges at the first corner.
struct WholeCell {
  int level;
  Vec3 corner;
  Mat3 axes;                   ///< columns of length 1
  std::array<bool, 3> across;  ///< whether a layer of the body, not the cell's size, is the length along it
};

/// Returns the level of cells of this size; none: it is no half, quarter ... of the largest.
std::optional<int> level_of_size(double size, double largest) {
  const double level = std::log2(largest / size);
  if (!(level > -0.5) || level > most_levels || std::abs(level - std::round(level)) > rounding_of_cells)
    return std::nullopt;
  return static_cast<int>(std::lround(level));
}

/// Takes a hexahedron for a whole cell if two of its edges at least have the length of one.
std::optional<WholeCell> whole_cell(const DrawnBody& body, const std::array<int, 8>& h, double cell_size) {
  WholeCell cell{-1, body.position[h[0]], Mat3::Zero(), {}};
  int fitting = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 edge = body.position[h[k == 0 ? 1 : k == 1 ? 3 : 4]] - cell.corner;
    cell.axes.col(k) = edge.normalized();
    const std::optional<int> level = level_of_size(edge.norm(), cell_size);
    cell.across[k] = !level || (cell.level >= 0 && *level != cell.level);
    if (cell.across[k]) continue;
    cell.level = *level;
    ++fitting;
  }
  if (fitting < 2 || !(cell.axes.transpose() * cell.axes).isIdentity(rounding_of_cells)) return std::nullopt;
  return cell;
}

SceneBox box_of(const std::vector<Vec3>& points, const std::array<int, 8>& corners, int num_corners) {
  SceneBox box;
  for (int v = 0; v < num_corners; ++v) box.add(points[corners[v]]);
  return box;
}

/// Returns the level of the smallest cells that hold a box in grid coordinates.
int level_of_box(const SceneBox& box, int smallest) {
  for (int level = smallest; level > 0; --level) {
    const Vec3 low = std::ldexp(1.0, level) * box.low, high = std::ldexp(1.0, level) * box.high;
    bool fits = true;
    for (int k = 0; k < 3; ++k)
      fits &= std::floor(low[k] + rounding_of_cells) >= std::ceil(high[k] - rounding_of_cells) - 1;
    if (fits) return level;
  }
  return 0;
}

void set_levels(const long long* active, int smallest, ClippedMesh& mesh) {
  std::unordered_map<long long, SceneBox> boxes;
  const std::size_t n = mesh.num_polyhedra();
  const auto each = [&](const auto& use) {
    for (std::size_t i = 0; i < n; ++i) use(mesh.polyhedron(i));
  };
  each([&](const ClippedMesh::Polyhedron& p) {
    const SceneBox part = box_of(mesh.points, p.points, p.num_points);
    SceneBox& box = boxes[active[p.cell]];
    box.add(part.low);
    box.add(part.high);
  });
  std::unordered_map<long long, signed char> level;
  for (const auto& [cell, box] : boxes) level[cell] = static_cast<signed char>(level_of_box(box, smallest));
  mesh.level_of_cell.assign(n, 0);
  each([&](const ClippedMesh::Polyhedron& p) { mesh.level_of_cell[p.cell] = level[active[p.cell]]; });
}

}  // namespace

void find_grid(double cell_size, const long long* active, DrawnBody& body) {
  std::optional<WholeCell> largest;
  int smallest = 0;
  for (const std::array<int, 8>& h : body.mesh.hexahedra) {
    const std::optional<WholeCell> cell = whole_cell(body, h, cell_size);
    if (!cell) continue;
    smallest = std::max(smallest, cell->level);
    if (!largest || cell->level < largest->level) largest = cell;
  }
  if (!largest) return;
  for (std::size_t p = 0; p < body.position.size(); ++p) {
    Vec3& grid = body.mesh.points[p];
    grid = largest->axes.transpose() * (body.position[p] - largest->corner) / cell_size;
    for (int k = 0; k < 3; ++k)
      if (largest->across[k]) grid[k] = 0;
  }
  if (smallest > 0) set_levels(active, smallest, body.mesh);
}

}  // namespace cgcontact
