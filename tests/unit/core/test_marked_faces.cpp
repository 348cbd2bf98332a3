#include <gtest/gtest.h>

#include <map>

#include "core/drawing/marked_faces.hpp"
#include "core/scene_file/read_scene.hpp"

namespace cgcontact::test_marked_faces {
namespace {

/// The body of a scene on a grid along the axes.
CutCells on_grid(const BodySpec& body) {
  Grid grid;
  grid.cell_size = body.cell_size;
  grid.origin = Vec3::Constant(-0.3 * body.cell_size);
  grid.num_cells = {9, 6, 5};
  return make_cut_cells(body.solid.transformed(Mat3::Identity(), -grid.origin / grid.cell_size, 1 / grid.cell_size),
                        grid);
}

TEST(marked_faces, a_bar_under_tension) {
  const Scene scene = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/tests/scenes/one_body.toml",
                                 {"support.2.displacement={z = \"1e-3*x\"}", "support.2.symmetry=false"});
  const CutCells cells = on_grid(scene.bodies[0]);
  const std::vector<CheckedBody> bodies{{&cells, std::vector<int>(cells.boundary.size(), -1)}};
  const MarkedFaces faces(scene, bodies);
  ASSERT_EQ(faces.regions().size(), 6u);
  double area = 0;
  for (const FaceRegion& region : faces.regions()) {
    area += region.area;
    EXPECT_TRUE(region.contacts.empty());
    EXPECT_EQ(region.symmetry, region.name == "bar.x-" || region.name == "bar.y-") << region.name;
    EXPECT_EQ(region.loads.size(), region.name == "bar.x+" ? 1u : 0u) << region.name;
    // 2 MPa on 0.5 m x 0.4 m.
    EXPECT_LT((region.force - Vec3(region.loads.empty() ? 0 : 4e5, 0, 0)).norm(), 1e-6) << region.name;
    if (region.name == "bar.z-") {
      EXPECT_GT(region.low_displacement[2], 0);
      EXPECT_LT(region.high_displacement[2], 1e-3);
      EXPECT_GT(region.low_displacement[0], region.high_displacement[0]);
    }
  }
  EXPECT_NEAR(area, 2 * (0.5 * 0.4 + 1 * 0.4 + 1 * 0.5), 1e-12);
  for (std::size_t p = 0; p < cells.boundary.size(); ++p) {
    const int region = faces.region_at(0, cells.boundary.cell[p], cells.boundary.surface[p],
                                       cells.grid.to_global(cells.boundary.position[p]), cells.boundary.normal[p]);
    ASSERT_GE(region, 0);
    const Vec3 from_centre = cells.grid.to_global(cells.boundary.position[p]) - faces.regions()[region].centroid;
    EXPECT_NEAR(from_centre.dot(cells.boundary.normal[p]), 0, 1e-12);
  }
}

TEST(marked_faces, automatic_contact_is_where_something_is_opposite) {
  const Scene scene = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/tests/scenes/three_blocks.toml");
  std::vector<CutCells> cells;
  for (const BodySpec& body : scene.bodies) {
    Grid grid;
    grid.cell_size = 0.2;
    grid.origin = Vec3::Constant(-0.07);
    grid.num_cells = {6, 6, 7};
    cells.push_back(make_cut_cells(
        body.solid.transformed(Mat3::Identity(), -grid.origin / grid.cell_size, 1 / grid.cell_size), grid));
  }
  std::vector<CheckedBody> bodies;
  for (const CutCells& body : cells) bodies.push_back({&body, std::vector<int>(body.boundary.size(), -1)});
  for (std::size_t p = 0; p < cells[0].boundary.size(); ++p)
    if (cells[0].boundary.normal[p][2] > 0.5) bodies[0].pair_of_point[p] = 0;
  const MarkedFaces faces(scene, bodies);
  double area = 0;
  for (const FaceRegion& region : faces.regions())
    if (!region.contacts.empty()) {
      EXPECT_EQ(region.name, "a.box.z+");
      area += region.area;
    }
  EXPECT_NEAR(area, 1, 1e-12);
}

// A moment has no resultant but itself, without rounding; a declared face that nothing acts on has its name, and a load
// is not divided by one.
TEST(marked_faces, moments_and_declared_faces) {
  const Scene scene = parse_scene(R"(
[[body]]
name = "bar"
shape = {box = {min = [0, 0, 0], max = [1, 0.5, 0.4]}}
material = {E = 1e9, nu = 0.3}
cell_size = 0.13
faces = [{name = "strip", surfaces = ["z+"], box = {min = [0.2, -1, -1], max = [0.6, 1, 1]}},
         {name = "half", surfaces = ["x+"], box = {min = [-1, -1, -1], max = [2, 0.25, 1]}}]

[[support]]
face = "bar.x-"
displacement = {x = 0, y = 0, z = 0}

[[load]]
face = "bar.x+"
moment = [10, 0, -2]
)",
                                  "bar.toml");
  const CutCells cells = on_grid(scene.bodies[0]);
  const std::vector<CheckedBody> bodies{{&cells, std::vector<int>(cells.boundary.size(), -1)}};
  const MarkedFaces faces(scene, bodies);
  std::map<std::string, int> count;
  for (const FaceRegion& region : faces.regions()) {
    ++count[region.name];
    EXPECT_EQ(region.force, Vec3(0, 0, 0)) << region.name;
    if (!region.loads.empty())
      EXPECT_LT((region.moment - Vec3(10, 0, -2)).norm(), 1e-8);
    else
      EXPECT_EQ(region.moment, Vec3(0, 0, 0)) << region.name;
  }
  EXPECT_EQ(count["bar.strip"], 1);
  EXPECT_EQ(count["bar.x+"], 1) << "the load";
  EXPECT_EQ(count["bar.box.z+"], 1) << "what is left beside the strip";
  EXPECT_EQ(faces.regions().size(), 7u);
}

}  // namespace
}  // namespace cgcontact::test_marked_faces
