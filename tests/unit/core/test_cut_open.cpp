#include <gtest/gtest.h>

#include "core/drawing/cut_open.hpp"
#include "core/drawing/scene_view.hpp"

namespace cgcontact::test_cut_open {
namespace {

Vec3 displacement_at(const Vec3& x) { return {0.1 * x[0] - 0.2 * x[1], 0.3, 0.4 * x[2] + 1}; }

/// A box with its cells, which its inside is drawn from.
struct DrawnBox {
  Grid grid;
  CutCells cells;
  DrawnBody body;

  DrawnBox(const Mat3& rotation, const Vec3& shift, const Vec3& low, const Vec3& high) {
    grid.num_cells = {12, 12, 12};
    grid.cell_size = 0.5;
    cells = make_cut_cells(Solid::box(low, high, "box").transformed(rotation, shift), grid);
    BodyFields fields;
    fields.cut_cells = &cells;
    fields.displacement = [this](int cell, const Vec3& xi) {
      return displacement_at(global_position(cells, cell, xi));
    };
    body = draw_body(fields);
  }
  DrawnBox(const DrawnBox&) = delete;
};

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
    const DrawnBox whole(Mat3::Identity(), Vec3::Zero(), low, high);
    EXPECT_GT(whole.body.mesh.num_interior_points(), 0U);
    const DrawnBody open = cut_open(whole.body, corner / 2, {Vec3::UnitX(), Vec3::UnitY()});
    const auto removed = [&](int k) { return std::min(std::max(high[k] - corner[k], 0.0), high[k] - low[k]); };
    const double volume = (high - low).prod() - removed(0) * removed(1) * (high[2] - low[2]);
    EXPECT_NEAR(enclosed_volume(open), volume / 8, 1e-12) << corner.transpose();
    ASSERT_EQ(open.position.size(), open.displacement.size());
    for (std::size_t p = 0; p < open.position.size(); ++p)
      EXPECT_LT((open.displacement[p] - displacement_at(open.position[p])).norm(), 1e-12);
  }
}

// What a plane cuts of a box has the area of the polygon, faces the normal, lies in the plane and carries the fields;
// planes that are those of the grid and planes beside the body too.
TEST(cut_open, sections_are_exact) {
  const DrawnBox whole(Mat3::Identity(), Vec3::Zero(), {1, 1, 1}, {5, 5.3, 5});  // cells of 0.5
  const auto area_of = [&](const Vec3& point, const Vec3& normal) {
    const DrawnBody section = section_of(whole.body, point, normal);
    double area = 0;
    for (const BoundaryTriangle& t : section.mesh.boundary) {
      const Vec3 &a = section.position[t.points[0]], &b = section.position[t.points[1]],
                 &c = section.position[t.points[2]];
      const double triangle_area = (b - a).cross(c - a).dot(normal) / 2;
      EXPECT_GE(triangle_area, 0);
      area += triangle_area;
    }
    for (std::size_t p = 0; p < section.position.size(); ++p) {
      EXPECT_NEAR((section.position[p] - point).dot(normal), 0, 1e-14);
      EXPECT_LT((section.displacement[p] - displacement_at(section.position[p])).norm(), 1e-12);
    }
    return area;
  };
  EXPECT_NEAR(area_of({1.3, 0, 0}, Vec3::UnitX()), 2.15 * 2, 1e-13);
  EXPECT_NEAR(area_of({1.5, 0, 0}, -Vec3::UnitX()), 2.15 * 2, 1e-13);
  EXPECT_NEAR(area_of({1.5, 0, 1.5}, Vec3(1, 0, 1).normalized()), 2.15 * std::sqrt(8.0), 1e-13);
  EXPECT_EQ(area_of({7, 0, 0}, Vec3::UnitX()), 0);
}

// Sections carry the levels of their cells: the pictures draw the lines of those.
TEST(cut_open, sections_have_the_levels_of_their_cells) {
  Grid grid;
  grid.num_cells = {4, 4, 4};
  const Solid solid = Solid::box({0.3, 0.3, 0.3}, {3.6, 3.6, 3.6}, "box");
  const CutCells cells = make_cut_cells(solid, grid, {}, {}, CellTree(grid.num_cells, {{{1, 1, 1}}}));
  ASSERT_EQ(cells.num_levels(), 2);
  BodyFields fields;
  fields.cut_cells = &cells;
  const DrawnBody open = cut_open(draw_body(fields), {1.8, 1.8, 0}, {Vec3::UnitX(), Vec3::UnitY()});
  std::array<int, 2> sections{0, 0};
  for (const BoundaryTriangle& t : open.mesh.boundary) {
    EXPECT_EQ(t.level, cells.level(t.cell));
    if (t.surface < 0) ++sections[static_cast<std::size_t>(t.level)];
  }
  EXPECT_GT(sections[0], 0);
  EXPECT_GT(sections[1], 0);
}

TEST(scene_view, a_zone_is_seen_from_a_side_that_it_reaches_or_cut_open) {
  const DrawnBox box(Mat3::Identity(), Vec3::Zero(), {1, 1, 1}, {5, 5, 5});
  const std::vector<DrawnBody> bodies{box.body};
  SceneView scene;
  scene.box.low = Vec3::Constant(0.5);
  scene.box.high = Vec3::Constant(2.5);
  scene.camera.eye = Vec3(0.55, -0.75, 0.42).normalized();
  ContactZoneBox zone;
  zone.box.low = Vec3(0.5, 1.2, 2.5);
  zone.box.high = Vec3(0.9, 1.6, 2.5);
  const SceneView beside = look_at_zone(bodies, scene, zone);  // the zone reaches the lower side in x
  EXPECT_FALSE(beside.opened);
  EXPECT_LT(beside.camera.eye[0], 0);
  EXPECT_NEAR(enclosed_volume(beside.shown[0]), 8, 1e-12);
  EXPECT_TRUE(beside.shown[0].mesh.hexahedra.empty());
  zone.box.low[0] = 0.8;
  zone.box.high[0] = 1.2;
  const SceneView inside = look_at_zone(bodies, scene, zone);  // a quarter at x > 1, y < 1.4 is taken away
  EXPECT_TRUE(inside.opened);
  EXPECT_GT(inside.camera.eye[0], 0);
  EXPECT_NEAR(enclosed_volume(inside.shown[0]), 8 - 1.5 * 0.9 * 2, 1e-12);
}

// Two pairs: that with the larger force is looked at, in the middle of its pressed rows, with as much again around it.
TEST(scene_view, the_zone_of_the_largest_force_is_shown_from_nearby) {
  const DrawnBox box(Mat3::Identity(), Vec3::Zero(), {1, 1, 1}, {5, 5, 5});
  const std::vector<DrawnBody> bodies{box.body};
  Results results;
  results.bodies.resize(1);
  results.pairs.resize(2);
  for (int pair : {0, 1}) {
    results.pairs[pair].force_on_first = Vec3(0, 0, 1 + pair);
    results.pairs[pair].max_pressure = 1e6;
    for (const double x : {1.0, 1.2, 1.5}) {
      ContactRow row;
      row.pair = pair;
      row.x = Vec3(x, 1.4 + 0.1 * pair, 2.5);
      row.normal = Vec3::UnitZ();
      row.weight = 1;
      row.pressure_sprc = x > 1.4 ? 0.009e6 : 1e6;  // below a hundredth of the largest: no part of the zone
      results.contact_rows.push_back(row);
    }
  }
  SceneView scene;
  scene.box.low = Vec3::Constant(0.5);
  scene.box.high = Vec3::Constant(2.5);
  scene.camera.eye = Vec3(0.55, -0.75, 0.42).normalized();
  EXPECT_FALSE(look_at_main_zone(results, bodies, scene));  // which shows nothing itself
  scene.shown = bodies;
  const auto look = look_at_main_zone(results, bodies, scene);
  ASSERT_TRUE(look);
  EXPECT_EQ(look->pair, 1);
  EXPECT_LT((look->box.low - Vec3(1, 1.5, 2.5)).norm() + (look->box.high - Vec3(1.2, 1.5, 2.5)).norm(), 1e-12);
  EXPECT_TRUE(look->view.opened);
  SceneBox shown;
  for (const Vec3& corner : corners_around(look->box)) shown.add(corner);
  EXPECT_LT(((shown.low + shown.high) / 2 - Vec3(1.1, 1.5, 2.5)).norm(), 1e-12);
  EXPECT_NEAR(shown.extent()[0], 2.2 * 0.2, 1e-12);
  results.pairs[0].max_pressure = results.pairs[1].max_pressure = 0;
  EXPECT_FALSE(look_at_main_zone(results, bodies, scene));
}

TEST(cut_open, turned_bodies_and_directions) {
  const Mat3 rotation = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3 shift(2.1, 2.2, 2.3);
  const DrawnBox whole(rotation, shift, {2, 2, 2}, {5, 5, 5});
  const Vec3 corner = (rotation * Vec3(3.2, 3.9, 0) + shift) / 2;
  const DrawnBody open = cut_open(whole.body, corner, {rotation * -Vec3::UnitX(), rotation * Vec3::UnitY()});
  EXPECT_NEAR(enclosed_volume(open), (27 - 1.2 * 1.1 * 3) / 8, 1e-12);
}

}  // namespace
}  // namespace cgcontact::test_cut_open
