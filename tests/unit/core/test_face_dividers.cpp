/// Facets of the boundary are cut where declared faces end: areas and resultants of such faces are those of geometry.
#include <algorithm>
#include <random>

#include "core/scene/face_dividers.hpp"
#include "tests/support/triangle_shapes.hpp"
#include "tests/unit/core/cut_cells_checks.hpp"

namespace cgcontact::test_face_dividers {
namespace {

/// A solid around the global origin, in a grid of `size` anyhow turned and shifted.
CutCells cells_of(const Solid& solid, const FaceSpec& face, double size, std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1, 1);
  Grid grid;
  grid.cell_size = size;
  grid.rotation = rotation({any(random), any(random), any(random)}, 3 * any(random));
  Vec3 min, max;
  solid.transformed(grid.rotation.transpose(), Vec3::Zero()).bounding_box(min, max);
  const Vec3 start = min - size * Vec3(1 + any(random), 1 + any(random), 1 + any(random)) / 2 - Vec3::Constant(size);
  for (int k = 0; k < 3; ++k) grid.num_cells[k] = static_cast<int>(std::ceil((max[k] - start[k]) / size)) + 1;
  grid.origin = grid.rotation * start;
  const Solid in_grid =
      solid.transformed(grid.rotation.transpose(), -(grid.rotation.transpose() * grid.origin) / size, 1 / size);
  return make_cut_cells(in_grid, grid, face_dividers({&face}, in_grid, grid));
}

struct FaceSums {
  double area = 0, whole = 0;  ///< of the face; of all
  Vec3 normal = Vec3::Zero();  ///< integral over the face
};

FaceSums sums_of(const CutCells& cells, const FaceSpec& face) {
  FaceSums sums;
  const BoundaryPoints& points = cells.boundary;
  const Grid& grid = cells.grid;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double area = points.weight[p] * grid.cell_size * grid.cell_size;
    sums.whole += area;
    if (!face.contains(cells.solid.surfaces()[points.surface[p]].names, grid.to_global(points.position_of_facet(p)),
                       grid.rotation * points.normal_of_facet(p)))
      continue;
    sums.area += area;
    sums.normal += area * (grid.rotation * points.normal[p]);
  }
  return sums;
}

FaceSpec cone(const Vec3& axis, double degrees) {
  FaceSpec face;
  face.normal_cone = std::make_pair(axis.normalized(), std::cos(degrees * pi / 180));
  return face;
}

FaceSpec box(const Vec3& min, const Vec3& max) {
  FaceSpec face;
  face.box = std::make_pair(min, max);
  return face;
}

// Proves that the cap of a ball within a cone of normals has the area 2 pi r^2 (1 - cos a) and the projection
// pi r^2 sin^2 a, and that its resultant has no component across, in random grids. The tolerances are those of the
// rules on curved surfaces: 1e-9 from two cells over the radius on, 1e-8 in cells as large as the ball.
TEST(FaceDividers, CapOfABall) {
  std::mt19937 random(1);
  for (const auto& [size, tolerance] : {std::pair(1.1, 1e-8), std::pair(0.47, 1e-9), std::pair(0.26, 1e-9)})
    for (const double angle : {20.0, 60.0, 90.0, 137.0}) {
      const Vec3 axis = Vec3(0.2, -0.3, 1).normalized();
      const FaceSums sums =
          sums_of(cells_of(Solid::sphere({0.1, 0.2, 0.3}, 1, "s"), cone(axis, angle), size, random), cone(axis, angle));
      const double c = std::cos(angle * pi / 180);
      EXPECT_NEAR(sums.area / (2 * pi * (1 - c)), 1, tolerance) << size << " " << angle;
      EXPECT_NEAR(sums.whole / (4 * pi), 1, tolerance);
      EXPECT_LT((sums.normal - pi * (1 - c * c) * axis).norm(), tolerance * sums.area) << size << " " << angle;
    }
}

// Proves that a cone of normals cuts a sector out of a cylinder, outside and in a bore, along its generators: of the
// half angle acos(cos a / |axis across the cylinder|); end faces belong to the cone or not as a whole.
TEST(FaceDividers, SectorOfACylinder) {
  std::mt19937 random(2);
  const Vec3 along(0, 0, 2);
  const Solid tube = Solid::subtract(Solid::cylinder(Vec3::Zero(), along, 1, "outer"),
                                     Solid::cylinder(-along, 2 * along, 0.6, "bore"));
  const Vec3 axis = Vec3(1, 0.4, 0.5).normalized();
  const double across = axis.head<2>().norm();
  for (const double angle : {35.0, 75.0, 120.0}) {
    FaceSpec face = cone(axis, angle);
    const double half = std::acos(std::cos(angle * pi / 180) / across);
    for (const auto& [name, radius] : {std::pair("outer.side", 1.0), std::pair("bore.side", 0.6)}) {
      face.surfaces = {name};
      EXPECT_NEAR(sums_of(cells_of(tube, face, 0.31, random), face).area / (2 * half * radius * 2), 1, 1e-9) << name;
    }
    face.surfaces = {"outer.top"};
    const double top = std::acos(axis[2]) * 180 / pi < angle ? pi * (1 - 0.36) : 0;
    EXPECT_NEAR(sums_of(cells_of(tube, face, 0.31, random), face).area, top, 1e-9);
  }
}

// Proves the same for a cone, whose normals are turned by its half angle, outside and in a bore, also with a tip.
TEST(FaceDividers, SectorOfACone) {
  std::mt19937 random(6);
  const Vec3 axis = Vec3(1, 0.4, 0.5).normalized();
  const double across = axis.head<2>().norm();
  const double height = 2, slant = std::hypot(height, 0.5), c = height / slant, s = 0.5 / slant;
  const Solid outside = Solid::cone(Vec3::Zero(), {0, 0, height}, 1, 0.5, "c");
  const Solid bore = Solid::subtract(Solid::cylinder(Vec3::Zero(), {0, 0, height}, 1.4, "o"), outside);
  for (const double angle : {35.0, 75.0, 120.0}) {
    FaceSpec face = cone(axis, angle);
    face.surfaces = {"c.side"};
    for (const double side : {1.0, -1.0}) {
      const double cosine = (std::cos(angle * pi / 180) - side * s * axis[2]) / (c * across);
      const double half = std::acos(std::clamp(cosine, -1.0, 1.0));  // beyond 1: no normal of the bore is that near
      const double area = half * 1.5 * slant;                        // of the whole: pi (R + r) times the slant height
      EXPECT_NEAR(sums_of(cells_of(side > 0 ? outside : bore, face, 0.2, random), face).area, area, 1e-8 * slant)
          << angle;
    }
  }
}

// Proves that a strip on a block has its exact area at any cell size, that the rim of a flat box counts as inside, and
// the same for a surface of triangles (the strip crosses triangles and a grid plane may lie anywhere).
TEST(FaceDividers, StripOnABlock) {
  std::mt19937 random(3);
  const Solid csg = Solid::box({0, 0, 0}, {12, 12, 5}, "b");
  const Solid triangles = Solid::bounded_by(test::surface_of(test::box_soup({0, 0, 0}, {12, 12, 5})));
  const FaceSpec strip = box({3, 1, 5}, {4, 11, 6}), edge = box({-1, 2, -1}, {3, 7, 7});
  for (const double size : {0.7, 1.0, 2.3, 7.1})
    for (const Solid& solid : {csg, triangles}) {
      EXPECT_NEAR(sums_of(cells_of(solid, strip, size, random), strip).area, 10, 1e-11) << size;
      EXPECT_NEAR(sums_of(cells_of(solid, edge, size, random), edge).area, 5 * 3 + 5 * 3 + 5 * 5, 1e-11) << size;
    }
}

// Proves that a box on a ball cuts exactly: the zone between two parallel planes has the area 2 pi r h, whatever else
// cuts it.
TEST(FaceDividers, ZoneOfABall) {
  std::mt19937 random(4);
  const FaceSpec zone = box({-9, -9, -0.35}, {9, 9, 0.6});
  for (const double size : {0.61, 0.33})
    EXPECT_NEAR(sums_of(cells_of(Solid::sphere({0, 0, 0}, 1, "s"), zone, size, random), zone).area, 2 * pi * 0.95,
                1e-8);
}

/// Area of a triangle within a box.
double area_in_box(std::vector<Vec3> polygon, const std::pair<Vec3, Vec3>& box) {
  for (int k = 0; k < 3; ++k)
    for (const double sign : {1.0, -1.0}) {
      const double limit = sign * (sign > 0 ? box.first[k] : box.second[k]);
      std::vector<Vec3> rest;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double da = sign * a[k] - limit, db = sign * b[k] - limit;
        if (da >= 0) rest.push_back(a);
        if (da * db < 0) rest.push_back(a + da / (da - db) * (b - a));
      }
      polygon = rest;
    }
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    sum += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]) / 2;
  return sum.norm();
}

// Proves that faces on a surface of many small facets, hundreds in a cell, have the areas of their facets: of those in
// a cone of normals as wholes, of those in a box as far as they lie in it, of both. The tolerance is that of the
// compression of the points.
TEST(FaceDividers, FineBallOfTriangles) {
  std::mt19937 random(5);
  const TriangleSoup soup = test::sphere_soup(1, 80);
  const Solid solid = Solid::bounded_by(test::surface_of(soup));
  FaceSpec cap = cone({0.2, -0.3, 1}, 50), zone = box({-9, -9, -0.35}, {9, 0.4, 0.6}), both = zone;
  both.normal_cone = cap.normal_cone;
  for (const FaceSpec& face : {cap, zone, both}) {
    double expected = 0;
    for (const Triangle& t : soup.triangles) {
      const Vec3 &a = soup.points[t[0]], &b = soup.points[t[1]], &c = soup.points[t[2]];
      const Vec3 normal = (b - a).cross(c - a).normalized();
      if (face.normal_cone && normal.dot(face.normal_cone->first) < face.normal_cone->second) continue;
      expected += face.box ? area_in_box({a, b, c}, *face.box) : (b - a).cross(c - a).norm() / 2;
    }
    EXPECT_GT(expected, 0.3);
    for (const double size : {1.1, 0.47, 0.2})
      EXPECT_NEAR(sums_of(cells_of(solid, face, size, random), face).area / expected, 1, 1e-9) << size;
  }
}

// Proves that borders that are planes of the body, or of another face, up to rounding make no slivers.
TEST(FaceDividers, CoincidentPlanesAreOne) {
  const Solid solid = Solid::box({1, 1, 1}, {5, 4, 3}, "b");
  Grid grid;
  grid.num_cells = {6, 6, 6};
  const FaceSpec a = box({0, 1 + 1e-13, 0}, {3.3, 9, 9}), b = box({3.3 + 1e-13, 0, 0}, {9, 9, 9});
  std::vector<Plane> of_top;
  for (const Plane& plane : face_dividers({&a, &b}, solid, grid))
    if (plane.divides(5) && std::abs(plane.offset) > 0.5 && std::abs(plane.offset) < 5.5) of_top.push_back(plane);
  ASSERT_EQ(of_top.size(), 2u);  // y = 1 and x = 3.3
  for (const Plane& plane : of_top)
    if (plane.normal[1] != 0) {
      EXPECT_EQ(std::abs(plane.offset), 1);
    }
}

}  // namespace
}  // namespace cgcontact::test_face_dividers
