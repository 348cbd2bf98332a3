/// Cells of a body that is refined around a ring: as small as asked for everywhere, and small nowhere else.
#include <gtest/gtest.h>

#include "contact/model/model.hpp"
#include "core/scene_file/read_scene.hpp"
#include "tests/support/input_errors.hpp"

namespace cgcontact::test_refined_grid {
namespace {

/// A plate of 1 m by 1 m on a turned grid, its cells of 0.1 m halved three times around a ring.
std::string plate(const std::string& ring) {
  return R"(
[[body]]
name = "plate"
shape = {box = {min = [-0.5, -0.5, -0.2], max = [0.5, 0.5, 0]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.1
grid = {offset = [0.3, 0.6, 0.2], rotation = {axis = [1, 2, 3], angle = 20}}
refine = [{ring = )" +
         ring + R"(, size = 0.0125, grading = 0.5}]
[[support]]
face = "plate.z-"
symmetry = true
)";
}

const Vec3 centre(0.05, 0, -0.02), axis = Vec3(0.2, -0.1, 1).normalized();
constexpr double radius = 0.3;

double distance_to_circle(const Vec3& x) {
  const Vec3 from = x - centre;
  return std::hypot(from.cross(axis).norm() - radius, from.dot(axis));
}

TEST(RefinedGrid, IsFineAroundARing) {
  for (const double tube : {0.0, 0.03}) {
    const Scene scene = parse_scene(plate("{center = [0.05, 0, -0.02], axis = [0.2, -0.1, 1], radius = 0.3, "
                                          "tube_radius = " +
                                          std::to_string(tube) + "}"),
                                    "ring.toml");
    const std::vector<BodyModel> bodies = make_body_models(scene);
    const CutCells& cells = bodies[0].cut_cells;
    ASSERT_EQ(cells.num_levels(), 4);
    for (int e = 0; e < static_cast<int>(cells.cells.size()); ++e) {
      const Vec3 middle = global_position(cells, e, Vec3::Zero());
      const double distance = std::max(0.0, distance_to_circle(middle) - tube);
      EXPECT_LE(cells.h(e), 1.001 * std::max(0.0125, 0.5 * distance)) << middle.transpose();
      // The cell of twice the size that holds it was too large for the nearest point of the ball around it, or
      // touches one of its own size that was.
      const double above = 2 * cells.h(e), ball = 0.5 * std::sqrt(3.0) * above;
      if (cells.level(e) == 3) {
        EXPECT_LT(distance, above / 0.5 + ball + 2 * std::sqrt(3.0) * above) << middle.transpose();
      }
    }
    int inside = 0;
    for (int k = 0; k < 360; ++k) {
      const Vec3 x =
          centre + radius * (std::cos(k) * axis.unitOrthogonal() + std::sin(k) * axis.cross(axis.unitOrthogonal()));
      if (x[2] > 0) continue;  // above the plate
      ++inside;
      EXPECT_EQ(cells.level(cells.locate(cells.grid.to_grid(x))), 3) << x.transpose();
    }
    EXPECT_GT(inside, 90);
  }
}

TEST(RefinedGrid, RingsHaveACentreAnAxisAndRadii) {
  const auto message = [](const std::string& ring) {
    return message_of([&] { parse_scene(plate(ring), "ring.toml"); });
  };
  EXPECT_EQ(message("{center = [0, 0, 0], radius = 0.1}"), "");
  expect_contains(message("{center = [0, 0, 0], radius = 0}"), {"ring.toml:8", "radius", "allowed: > 0 m"});
  expect_contains(message("{radius = 0.1}"), {"ring.toml:8", "center"});
  expect_contains(message("{center = [0, 0, 0], radius = 0.1, axis = [0, 0, 0]}"), {"ring.toml:8", "axis"});
  expect_contains(message("{center = [0, 0, 0], radius = 0.1, tube_radius = -1}"), {"tube_radius", "allowed: >= 0 m"});
  expect_contains(message("{center = [0, 0, 0], ring_radius = 0.1}"), {"ring_radius"});
}

}  // namespace
}  // namespace cgcontact::test_refined_grid
