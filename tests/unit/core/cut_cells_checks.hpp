// What the tests of cut cells share: placing a solid in a grid of its own, and totals over all cells.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "core/cells/cut_cells.hpp"

namespace cgcontact {

inline Mat3 rotation(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

/// Cut cells of the solid after a rotation and a shift by the fractions of a cell given, in a grid that just holds it.
inline CutCells cut(const Solid& solid, const Mat3& turn = Mat3::Identity(), const Vec3& fraction = Vec3::Zero()) {
  Vec3 min, max;
  const Solid turned = solid.transformed(turn, Vec3::Zero());
  EXPECT_TRUE(turned.bounding_box(min, max));
  const Solid placed = turned.transformed(Mat3::Identity(), fraction - min);
  Grid grid;
  for (int k = 0; k < 3; ++k) grid.num_cells[k] = static_cast<int>(std::ceil(max[k] - min[k] + fraction[k] - 1e-9));
  return make_cut_cells(placed, grid);
}

struct Totals {
  double volume = 0, area = 0;
  double flux = 0;              ///< integral of x . n / 3 over the boundary
  Vec3 closure = Vec3::Zero();  ///< integral of n
};

inline Totals totals(const CutCells& cells) {
  Totals sum;
  long double volume = 0, area = 0;
  for (std::size_t a = 0; a < cells.cells.size(); ++a) volume += cells.volume_fraction(static_cast<int>(a));
  for (std::size_t i = 0; i < cells.boundary.size(); ++i) {
    const double w = cells.boundary.weight[i];
    area += w;
    sum.flux += w * cells.boundary.position[i].dot(cells.boundary.normal[i]) / 3;
    sum.closure += w * cells.boundary.normal[i];
  }
  sum.volume = static_cast<double>(volume);
  sum.area = static_cast<double>(area);
  return sum;
}

/// Integral of x over the cells, from their moments.
inline Vec3 first_moment(const CutCells& cells) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t a = 0; a < cells.cells.size(); ++a) {
    const int cut = cells.cut_of_active[a];
    const Moments& m = cut < 0 ? full_cell_moments() : cells.moments[cut];
    constexpr int n = moment_degree + 1;
    const Vec3 linear(m[n * n], m[n], m[1]);
    for (int k = 0; k < 3; ++k) sum[k] += m[0] / 8 * (cells.cells[a][k] + 0.5) + linear[k] / 16;
  }
  return sum;
}

inline std::vector<int> all_surfaces(const CutCells& cells) {
  std::vector<int> result;
  for (std::size_t i = 0; i < cells.solid.surfaces().size(); ++i) result.push_back(static_cast<int>(i));
  return result;
}

/// Area from boundary_points_of_cell over all active cells.
inline double area_by_cells(const CutCells& cells, const std::vector<Plane>& dividers, int order) {
  BoundaryPoints points;
  for (std::size_t a = 0; a < cells.cells.size(); ++a)
    boundary_points_of_cell(cells, static_cast<int>(a), all_surfaces(cells), dividers, order, points);
  double area = 0;
  for (double w : points.weight) area += w;
  return area;
}

/// The bookkeeping of the structure is consistent, whatever the geometry.
inline void check_structure(const CutCells& cells) {
  const int num_active = static_cast<int>(cells.cells.size());
  ASSERT_EQ(cells.cut_of_active.size(), cells.cells.size());
  ASSERT_EQ(cells.active_of_cut.size(), cells.moments.size());
  for (int a = 0; a < num_active; ++a) {
    EXPECT_EQ(cells.find(cells.cells[a]), a);
    EXPECT_GT(cells.volume_fraction(a), 0.99e-12);
    EXPECT_LT(cells.volume_fraction(a), 1 + 1e-11) << "pruned neighbours may add a few 1e-12";
    if (a > 0) {
      const Index3 &before = cells.cells[a - 1], &here = cells.cells[a];
      EXPECT_LT(std::tie(before[2], before[1], before[0]), std::tie(here[2], here[1], here[0]));
    }
  }
  for (std::size_t c = 0; c < cells.moments.size(); ++c)
    EXPECT_EQ(cells.cut_of_active[cells.active_of_cut[c]], static_cast<int>(c));
  for (std::size_t i = 0; i < cells.boundary.size(); ++i) {
    const int owner = cells.boundary.cell[i];
    ASSERT_TRUE(owner >= 0 && owner < num_active) << "a point is owned by an inactive cell";
    EXPECT_GE(cells.cut_of_active[owner], 0) << "a point is owned by an interior cell";
    EXPECT_GT(cells.boundary.weight[i], 0);
    EXPECT_NEAR(cells.boundary.normal[i].norm(), 1, 1e-14);
    if (i > 0) {
      EXPECT_LE(cells.boundary.cell[i - 1], owner);
    }
  }
}

const double planar = 1e-13;  // planar bodies are exact: rounding of sums of some hundred cells
const double curved = 1e-8;   // promised for curved bodies at 8 cells per diameter

struct KnownBody {
  const char* name;
  Solid solid;
  double volume, area;
  double tolerance = curved;
};

// Proves volume, area, closedness (sum of w n = 0) and the divergence identity (sum of w x.n / 3 = volume), turned,
// aligned with the grid and shifted by irrational fractions.
inline void check_totals(const std::vector<KnownBody>& bodies, const std::vector<Mat3>& turns) {
  const Vec3 fractions[] = {{0, 0, 0}, {std::sqrt(0.5), std::sqrt(0.3), std::exp(-1.0)}};
  for (const KnownBody& body : bodies)
    for (const Mat3& turn : turns)
      for (const Vec3& fraction : fractions) {
        SCOPED_TRACE(body.name);
        const CutCells cells = cut(body.solid, turn, fraction);
        check_structure(cells);
        const Totals sum = totals(cells);
        EXPECT_NEAR(sum.volume / body.volume, 1, body.tolerance);
        EXPECT_NEAR(sum.area / body.area, 1, body.tolerance);
        EXPECT_NEAR(sum.flux / body.volume, 1, body.tolerance);
        EXPECT_LT(sum.closure.norm() / body.area, body.tolerance);
      }
}

}  // namespace cgcontact
