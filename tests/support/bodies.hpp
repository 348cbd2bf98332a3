/// Small bodies on grids that never fit them, for tests.
#pragma once

#include <random>

#include "core/cells/cut_cells.hpp"
#include "kernels/operator/system.hpp"

namespace cgcontact::test {

/// Grid of `n` cells over [-0.1, 1.1]^3 turned by `angle` about an odd axis, shifted by irrational fractions.
inline Grid odd_grid(int n, double angle, double length = 1.0) {
  Grid grid;
  grid.rotation = Eigen::AngleAxisd(angle, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  grid.cell_size = length / n;
  const int cells = static_cast<int>(std::ceil((angle == 0 ? 1.0 : 1.8) * n)) + 2;
  grid.num_cells = {cells, cells, cells};
  const Vec3 centre = grid.rotation * Vec3::Constant(0.5 * cells * grid.cell_size);
  grid.origin =
      length * Vec3(0.5, 0.5, 0.5) - centre +
      grid.cell_size * (grid.rotation * Vec3(std::sqrt(2.0) - 1.2, std::sqrt(3.0) - 1.5, std::sqrt(5.0) - 2.1));
  return grid;
}

inline Solid in_grid(const Solid& solid, const Grid& grid) {
  return solid.transformed(grid.rotation.transpose(), -(grid.rotation.transpose() * grid.origin) / grid.cell_size,
                           1 / grid.cell_size);
}

inline CutCells cut(const Solid& solid, const Grid& grid) { return make_cut_cells(in_grid(solid, grid), grid); }

/// Cuts cells refined towards a point (global axes): no larger than `finest` cells of the grid there, growing by
/// `slope`; distances across a quadtree do not count.
inline CutCells cut_refined(const Solid& solid, const Grid& grid, const Vec3& point, double finest, double slope = 0.4,
                            int max_levels = 12) {
  const Solid placed = in_grid(solid, grid);
  const Vec3 centre = grid.to_grid(point);
  const auto wanted = [&](const Vec3& low, const Vec3& high) {
    Vec3 away = centre - centre.cwiseMax(low).cwiseMin(high);
    if (grid.is_quadtree()) away[grid.plane_strain] = 0;
    return std::max(finest, slope * away.norm());
  };
  return make_cut_cells(placed, grid, {}, {}, refine_cells(placed.geometry(), grid, wanted, max_levels));
}

/// Nodal values of a displacement field given in global axes, stored in grid axes.
template <class Field>
RealView nodal_field(const ElasticSystem& system, const Field& field) {
  RealView u("u", system.num_dofs());
  for (const BodyMesh* level : system.level_meshes())
    for (int n = 0; n < level->num_nodes; ++n) {
      const BodyMesh& mesh = *level;
      const Grid& grid = mesh.cut_cells->grid;
      const Vec3 value = grid.rotation.transpose() * field(grid.to_global(mesh.node_position(n)));
      for (int i = 0; i < 3; ++i) u(dof_of(mesh.first_node + n, i)) = value[i];
    }
  return u;
}

inline RealView random_vector(int size, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  RealView x("x", size);
  for (int i = 0; i < size; ++i) x(i) = uniform(generator);
  return x;
}

inline double dot(const RealView& a, const RealView& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.extent(0); ++i) sum += a(i) * b(i);
  return sum;
}

inline double norm(const RealView& a) { return std::sqrt(dot(a, a)); }

}  // namespace cgcontact::test
