#include <gtest/gtest.h>

#include "core/drawing/cut_open.hpp"

namespace cgcontact {
namespace {

Vec3 displacement_at(const Vec3& x) { return {0.1 * x[0] - 0.2 * x[1], 0.3, 0.4 * x[2] + 1}; }

DrawnBody drawn_box(const Mat3& rotation, const Vec3& place, const Vec3& low, const Vec3& high) {
  Grid grid;
  grid.num_cells = {12, 12, 12};
  grid.cell_size = 0.5;
  const CutCells cells = make_cut_cells(Solid::box(low, high, "box").transformed(rotation, place), grid);
  BodyFields fields;
  fields.cut_cells = &cells;
  fields.displacement = [&](int cell, const Vec3& xi) {
    const Index3& c = cells.cells[cell];
    return displacement_at(grid.to_global(Vec3(c[0], c[1], c[2]) + 0.5 * (xi + Vec3::Ones())));
  };
  return draw_body(fields);
}

/// Volume (of the positions) that the boundary encloses: right only if it is closed and turned outward.
double enclosed_volume(const DrawnBody& body) {
  double sum = 0;
  for (const BoundaryTriangle& t : body.mesh.boundary)
    sum += body.position[t.points[0]].dot(body.position[t.points[1]].cross(body.position[t.points[2]])) / 6;
  return sum;
}

// The boundary of a box without a quarter is closed, its volume is exact, and the fields on it are those of the body
// (linear ones); also where the planes of the quarter are those of the grid, and where one of them misses the body.
TEST(cut_open, boundary_is_closed_and_exact) {
  const Vec3 low(1, 1, 1), high(5, 5.3, 5);  // cells
  for (const Vec3& corner : {Vec3(3.1, 2.7, 0), Vec3(3, 2, 0), Vec3(3.1, 0.3, 0), Vec3(0.2, 0.3, 0), Vec3(7, 7, 0)}) {
    const DrawnBody whole = drawn_box(Mat3::Identity(), Vec3::Zero(), low, high);
    const DrawnBody open = cut_open(whole, corner / 2, {Vec3::UnitX(), Vec3::UnitY()});
    const auto removed = [&](int k) { return std::min(std::max(high[k] - corner[k], 0.0), high[k] - low[k]); };
    const double volume = (high - low).prod() - removed(0) * removed(1) * (high[2] - low[2]);
    EXPECT_NEAR(enclosed_volume(open), volume / 8, 1e-12) << corner.transpose();
    ASSERT_EQ(open.position.size(), open.displacement.size());
    for (std::size_t p = 0; p < open.position.size(); ++p)
      EXPECT_LT((open.displacement[p] - displacement_at(open.position[p])).norm(), 1e-12);
  }
}

TEST(cut_open, turned_bodies_and_directions) {
  const Mat3 rotation = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3 place(2.1, 2.2, 2.3);
  const DrawnBody whole = drawn_box(rotation, place, {2, 2, 2}, {5, 5, 5});
  const Vec3 corner = (rotation * Vec3(3.2, 3.9, 0) + place) / 2;
  const DrawnBody open = cut_open(whole, corner, {rotation * -Vec3::UnitX(), rotation * Vec3::UnitY()});
  EXPECT_NEAR(enclosed_volume(open), (27 - 1.2 * 1.1 * 3) / 8, 1e-12);
}

}  // namespace
}  // namespace cgcontact
