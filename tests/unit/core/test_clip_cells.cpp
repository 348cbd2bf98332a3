#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/drawing/clip_cells.hpp"
#include "tests/support/triangle_shapes.hpp"

namespace cgcontact::test_clip_cells {
namespace {

CutCells cut(const Solid& solid, int num_cells) {
  Grid grid;
  grid.num_cells = {num_cells, num_cells, num_cells};
  return make_cut_cells(solid, grid);
}

Solid tilted_box() {
  const Mat3 rotation = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  return Solid::box({-2, -1.5, -2.5}, {2, 1.5, 2.5}, "box").transformed(rotation, {4.1, 4.2, 3.9});
}

Solid hollow_box() {
  return Solid::subtract(Solid::box({0.3, 0.41, 0.77}, {6.1, 7.3, 5.9}, "box"),
                         Solid::box({2.2, 2.3, 2.4}, {4.4, 4.5, 7}, "hole"));
}

double volume_of_moments(const CutCells& cells) {
  double sum = 0;
  for (std::size_t i = 0; i < cells.cells.size(); ++i) sum += cells.volume_fraction(static_cast<int>(i));
  return sum;
}

Vec3 area_vector(const ClippedMesh& mesh, const BoundaryTriangle& triangle) {
  const Vec3& a = mesh.points[triangle.points[0]];
  return (mesh.points[triangle.points[1]] - a).cross(mesh.points[triangle.points[2]] - a) / 2;
}

/// Volume enclosed by the boundary triangles; equals the mesh's volume only if they are closed and turned outward.
double enclosed_volume(const ClippedMesh& mesh) {
  double sum = 0;
  for (const BoundaryTriangle& triangle : mesh.boundary)
    sum += mesh.points[triangle.points[0]].dot(area_vector(mesh, triangle)) / 3;
  return sum;
}

std::map<int, double> area_by_surface(const ClippedMesh& mesh) {
  std::map<int, double> areas;
  for (const BoundaryTriangle& triangle : mesh.boundary) areas[triangle.surface] += area_vector(mesh, triangle).norm();
  return areas;
}

void expect_sound(const CutCells& cells, const ClippedMesh& mesh) {
  for (const auto& t : mesh.tetrahedra) {
    const Vec3& a = mesh.points[t[0]];
    EXPECT_GT((mesh.points[t[1]] - a).cross(mesh.points[t[2]] - a).dot(mesh.points[t[3]] - a), 0);
  }
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    const Index3& c = cells.cells[mesh.cell_of_point[p]];
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(mesh.points[p][k], c[k] - 1e-12);
      EXPECT_LE(mesh.points[p][k], c[k] + 1 + 1e-12);
    }
  }
}

TEST(clip_cells, planar_bodies_are_exact) {
  for (const Solid& solid : {Solid::box({0.3, 0.41, 0.77}, {6.1, 7.3, 5.9}, "box"), tilted_box(), hollow_box()}) {
    const CutCells cells = cut(solid, 8);
    const ClippedMesh mesh = clip_cells(cells);
    expect_sound(cells, mesh);
    EXPECT_NEAR(mesh.volume() / volume_of_moments(cells), 1, 1e-12);
    EXPECT_NEAR(enclosed_volume(mesh) / mesh.volume(), 1, 1e-12);
    std::map<int, double> areas;
    for (std::size_t i = 0; i < cells.boundary.size(); ++i)
      areas[cells.boundary.surface[i]] += cells.boundary.weight[i];
    const std::map<int, double> drawn = area_by_surface(mesh);
    ASSERT_EQ(drawn.size(), areas.size());
    for (const auto& [surface, area] : areas) EXPECT_NEAR(drawn.at(surface) / area, 1, 1e-11) << surface;
  }
}

TEST(clip_cells, a_body_on_grid_planes_has_no_tetrahedra) {
  const CutCells cells = cut(Solid::box({1, 2, 1}, {5, 6, 4}, "box"), 8);
  const ClippedMesh mesh = clip_cells(cells);
  EXPECT_EQ(mesh.tetrahedra.size(), 0u);
  EXPECT_EQ(mesh.num_polyhedra(), 48u);
  EXPECT_EQ(mesh.interior.cells.size(), 4u);
  EXPECT_EQ(mesh.num_points(), 100u);
  EXPECT_EQ(mesh.volume(), 48);
  EXPECT_EQ(mesh.boundary_area(), 2 * (16 + 12 + 12));
}

/// Full cells are hexahedra with the corners that they have, away from the boundary as numbers only; points are shared:
/// each node of the interior is one point, with its position.
void expect_full_cells_once(const CutCells& cells) {
  const ClippedMesh mesh = clip_cells(cells);
  std::map<int, int> polyhedra;
  for (const int cell : mesh.cell_of_hexahedron) ++polyhedra[cell];
  for (const int cell : mesh.interior.cells) {
    EXPECT_LT(cells.cut_of_active[cell], 0);
    ++polyhedra[cell];
  }
  for (std::size_t c = 0; c < cells.cells.size(); ++c) {
    if (cells.cut_of_active[c] < 0) {
      EXPECT_EQ(polyhedra[static_cast<int>(c)], 1);
    }
  }
  EXPECT_GT(mesh.interior.cells.size(), 50u);
  EXPECT_GT(mesh.num_interior_points(), 20u);
  std::vector<int> corners_at(mesh.num_interior_points(), 0);
  for (std::size_t i = 0; i < mesh.interior.cells.size(); ++i) {
    const int cell = mesh.interior.cells[i];
    const std::array<int, 8> hexahedron = mesh.interior_hexahedron(i);
    for (int v = 0; v < 8; ++v) {
      const bool high[3] = {v % 4 == 1 || v % 4 == 2, v % 4 >= 2, v >= 4};
      const Vec3 position = cells.corner(cell) + cells.size(cell) * Vec3(high[0], high[1], high[2]);
      const auto point = static_cast<std::size_t>(hexahedron[v]);
      const bool inside = point >= mesh.points.size();
      EXPECT_EQ(inside ? mesh.interior_point(point - mesh.points.size()) : mesh.points[point], position);
      if (inside) ++corners_at[point - mesh.points.size()];
    }
  }
  for (const int corners : corners_at) EXPECT_EQ(corners, 8);  // no other polyhedron has the point
}

TEST(clip_cells, full_cells_away_from_the_boundary) {
  expect_full_cells_once(cut(Solid::sphere({8.1, 7.9, 8.03}, 7.2, "ball"), 17));
  expect_full_cells_once(cut(Solid::box({0.3, 0.41, 0.77}, {8.6, 8.3, 8.9}, "box"), 9));
}

TEST(clip_cells, full_cells_of_several_sizes) {
  Grid grid;
  grid.num_cells = {10, 10, 10};
  const CutCells cells = make_cut_cells(Solid::box({0.3, 0.3, 0.3}, {9.6, 9.6, 9.6}, "box"), grid, {}, {},
                                        CellTree(grid.num_cells, {{{1, 1, 1}, {1, 2, 1}, {2, 1, 1}, {1, 1, 2}}}));
  ASSERT_EQ(cells.num_levels(), 2);
  const ClippedMesh mesh = clip_cells(cells);
  EXPECT_NEAR(mesh.volume(), std::pow(9.3, 3), 1e-9);
  EXPECT_GT(mesh.interior.cells.size(), 400u);
  for (std::size_t i = 0; i < mesh.interior.cells.size(); ++i) {
    const int cell = mesh.interior.cells[i];
    const int first = mesh.interior_hexahedron(i)[0];
    const auto inside = first - static_cast<int>(mesh.points.size());
    EXPECT_EQ(inside >= 0 ? mesh.interior_point(inside) : mesh.points[first], cells.corner(cell));
  }
}

TEST(clip_cells, faces_near_grid_planes_are_found) {
  for (double shift : {1e-16, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 2e-10, 1e-9, 1e-7, 1e-5})
    for (double sign : {-1.0, 1.0}) {
      const double low = 2 + sign * shift, high = 5 - 0.5 * sign * shift;
      const CutCells cells = cut(Solid::box({low, 1.3, 2.2}, {high, 4.7, 5.1}, "box"), 8);
      const ClippedMesh mesh = clip_cells(cells);
      EXPECT_NEAR(mesh.volume() / volume_of_moments(cells), 1, 2e-10) << sign * shift;
      EXPECT_NEAR(enclosed_volume(mesh) / mesh.volume(), 1, 1e-9) << sign * shift;
      EXPECT_NEAR(mesh.boundary_area(), 2 * (3.4 * 2.9 + (high - low) * (3.4 + 2.9)), 1e-8) << sign * shift;
    }
}

TEST(clip_cells, a_sphere_converges_with_second_order) {
  double errors[2];
  for (int level = 0; level < 2; ++level) {
    const int n = 16 << level;
    const double radius = 0.45 * n;
    const CutCells cells = cut(Solid::sphere({0.5 * n + 0.1, 0.5 * n - 0.07, 0.5 * n + 0.03}, radius, "ball"), n + 1);
    const ClippedMesh mesh = clip_cells(cells);
    expect_sound(cells, mesh);
    errors[level] = std::abs(mesh.volume() / volume_of_moments(cells) - 1);
    EXPECT_NEAR(enclosed_volume(mesh) / mesh.volume(), 1, 1e-7);
    EXPECT_NEAR(mesh.boundary_area() / (4 * pi * radius * radius), 1, 1e-3);
  }
  EXPECT_LT(errors[0], 2e-3);
  EXPECT_LT(errors[1], 0.27 * errors[0]);
}

TEST(clip_cells, curved_and_plane_faces_meet_without_gaps) {
  const Mat3 rotation = Eigen::AngleAxisd(0.3, Vec3(1, 1, 1).normalized()).toRotationMatrix();
  const Solid cap =
      Solid::intersect(Solid::sphere({0, 0, 0}, 6, "ball"), Solid::half_space({0, 0, 5.4}, Vec3::UnitZ(), "top"));
  const Solid ring = Solid::subtract(Solid::cylinder({0, 0, -1}, {0, 0, 1.2}, 5.5, "outer"),
                                     Solid::cylinder({0, 0, -2}, {0, 0, 2}, 2.5, "inner"));
  for (const Solid& solid : {cap, ring}) {
    const Solid turned = solid.transformed(rotation, {7.1, 7.2, 7.3});
    const CutCells cells = cut(turned, 14);
    const ClippedMesh mesh = clip_cells(cells);
    expect_sound(cells, mesh);
    EXPECT_NEAR(mesh.volume() / volume_of_moments(cells), 1, 3e-3);
    EXPECT_NEAR(enclosed_volume(mesh) / mesh.volume(), 1, 1e-7);
    for (const Vec3& x : mesh.points)
      for (std::size_t s = 0; s < 1; ++s) EXPECT_LT(turned.surfaces()[s].signed_distance(x), 1e-9);
  }
}

// Flat faces of triangle surfaces and their edges (also inward ones) are drawn exactly, curved ones closely.
TEST(clip_cells, bodies_of_triangles) {
  const TriangleSoup block = test::prism_soup({{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}}, {0.5, 0.5}, 2);
  const Mat3 rotation = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (const Mat3& turn : {Mat3(Mat3::Identity()), rotation}) {
    const Solid solid = Solid::bounded_by(test::surface_of(block)).transformed(turn, {4.1, 4.2, 3.9});
    const CutCells cells = cut(solid, 10);
    const ClippedMesh mesh = clip_cells(cells);
    expect_sound(cells, mesh);
    EXPECT_NEAR(mesh.volume() / volume_of_moments(cells), 1, 1e-11);
    EXPECT_NEAR(enclosed_volume(mesh) / volume_of_moments(cells), 1, 1e-11);
  }
  TriangleSoup rounded = block;  // single precision: the faces are flat up to 1e-7
  for (Vec3& x : rounded.points) x = (rotation * x).cast<float>().cast<double>() + Vec3(4.1, 4.2, 3.9);
  const CutCells nearly = cut(Solid::bounded_by(test::surface_of(rounded)), 10);
  const ClippedMesh drawn = clip_cells(nearly);
  expect_sound(nearly, drawn);
  EXPECT_NEAR(drawn.volume() / volume_of_moments(nearly), 1, 1e-6);
  EXPECT_NEAR(enclosed_volume(drawn) / volume_of_moments(nearly), 1, 1e-11);
  const Solid ball =
      Solid::bounded_by(test::surface_of(test::sphere_soup(3, 16))).transformed(rotation, {4.1, 4.2, 3.9});
  const CutCells cells = cut(ball, 8);
  const ClippedMesh mesh = clip_cells(cells);
  expect_sound(cells, mesh);
  // Chords of segments of half a cell on a radius of 3: 0.75 / (8 * 3) cells deep at most, 2/3 of that in the mean.
  EXPECT_NEAR(mesh.volume() / volume_of_moments(cells), 1, 0.02);
  EXPECT_NEAR(enclosed_volume(mesh) / volume_of_moments(cells), 1, 1e-11);
}

// A round crown of triangles, narrower than a cell at its ends, that goes over smoothly into flat flanks: the boundary
// is the triangles, closed up to rounding.
TEST(clip_cells, round_patches_that_touch_flat_ones_leave_no_gaps) {
  std::vector<Eigen::Vector2d> profile{{-2.1, -1.5}, {2.1, -1.5}};
  for (int i = 0; i <= 24; ++i) {
    const double angle = pi * i / 24;
    profile.push_back({2.1 * std::cos(angle), 0.9 * std::sin(angle)});
  }
  const TriangleSoup soup = test::prism_soup(profile, {0, -0.5}, 5);
  TriangleSelector crown;
  crown.name = "crown";
  crown.normal_cone = {Vec3::UnitY(), std::cos(1.5)};
  const TriangleSurface surface = make_surface(soup, name_faces(soup, "rail", {crown}), default_crease_angle);
  for (int i = 0; i < 12; ++i) {
    const Mat3 turn =
        Eigen::AngleAxisd(i % 4 == 0 ? 0 : 0.3 * i, Vec3(1, i % 3, 0.5 * i).normalized()).toRotationMatrix();
    const Solid solid = Solid::bounded_by(surface).transformed(turn, {5.1 + 0.07 * i, 5.2, 4.9 - 0.05 * i});
    const CutCells cells = cut(solid, 14);
    const ClippedMesh mesh = clip_cells(cells);
    expect_sound(cells, mesh);
    EXPECT_NEAR(mesh.volume() / volume_of_moments(cells), 1, 0.03) << i;  // half a cell at ends of radius 0.4
    EXPECT_NEAR(enclosed_volume(mesh) / volume_of_moments(cells), 1, 1e-11) << i;
    double area = 0;
    for (std::size_t p = 0; p < cells.boundary.size(); ++p) area += cells.boundary.weight[p];
    EXPECT_NEAR(mesh.boundary_area() / area, 1, 1e-11) << i;
    EXPECT_EQ(clip_boundary(cells).boundary_area(), mesh.boundary_area());
  }
}

// A shaft with 400 grooves, 20 of them in a cell: its cells are cut at the surface as a whole, in a bounded number of
// polyhedra; the boundary is the triangles all the same. Volume to 5 %: cubes of half a cell cut off the rims of both
// ends (a ninth of a cell's face along 37 cells, of 109) and the bulge between their corners (1 %).
TEST(clip_cells, many_patches_in_a_cell) {
  const TriangleSoup soup = test::prism_soup(test::star(800, 3, 2.9), {0, 0}, 4);
  const Solid solid = Solid::bounded_by(test::surface_of(soup)).transformed(Mat3::Identity(), {4.1, 4.2, 1.3});
  const CutCells cells = cut(solid, 8);
  const ClippedMesh mesh = clip_cells(cells);
  expect_sound(cells, mesh);
  EXPECT_NEAR(mesh.volume() / volume_of_moments(cells), 1, 0.05);
  EXPECT_NEAR(enclosed_volume(mesh) / volume_of_moments(cells), 1, 1e-11);
  EXPECT_LT(mesh.tetrahedra.size(), 8 * 6 * 10 * cells.moments.size());
}

TEST(clip_cells, cell_coordinates_are_those_of_the_cell) {
  const CutCells cells = cut(Solid::box({1, 1, 1}, {5, 5, 5}, "box"), 6);
  const int cell = cells.find({2, 3, 4});
  EXPECT_TRUE(clamped_cell_coordinates(cells, cell, {2, 3.5, 5}).isApprox(Vec3(-1, 0, 1)));
  EXPECT_TRUE(clamped_cell_coordinates(cells, cell, {1.9, 3.75, 4.5}).isApprox(Vec3(-1, 0.5, 0)));
}

}  // namespace
}  // namespace cgcontact::test_clip_cells
