/// Whole runs with bodies read from mesh files: the same results as with CSG bodies.
#include <gtest/gtest.h>

#include "tests/support/scene_with_meshes.hpp"

namespace cgcontact::test_triangle_bodies {
namespace {

using test::SceneWithMeshes;

// Proves that a block read from an STL file behaves as the CSG block: forces, pressures and counts of the paper's
// scene, with one body replaced (mixed with CSG) and with both. 1e-9 of the largest: rounding through the active set
// and the recovery.
TEST(TriangleBodies, TwoSolidsAreThoseOfCsg) {
  const auto csg = test::run_scene("scenes/two_solids_3d.toml", {"n=8"});
  for (const bool both : {false, true}) {
    SceneWithMeshes scene("two_solids_3d.toml");
    scene.replace_box("lower", {0, 0, 0}, {0.01, 0.005, 0.01});
    if (both) scene.replace_box("upper", {0, 0, 0.01}, {0.01, 0.005, 0.02});
    const auto mesh = scene.run({"n=8"});
    const Results &a = csg->results(), &b = mesh->results();
    ASSERT_TRUE(b.converged);
    EXPECT_TRUE(b.warnings.empty());
    ASSERT_EQ(a.contact_rows.size(), b.contact_rows.size());
    double largest = 0, worst = 0, worst_distance = 0;
    for (std::size_t i = 0; i < a.contact_rows.size(); ++i) {
      largest = std::max(largest, std::abs(a.contact_rows[i].pressure_sprc));
      // The order of the points in a cell may differ.
      const ContactRow* nearest = &b.contact_rows[0];
      for (const ContactRow& row : b.contact_rows)
        if (row.body == a.contact_rows[i].body &&
            (row.x - a.contact_rows[i].x).norm() < (nearest->x - a.contact_rows[i].x).norm())
          nearest = &row;
      worst_distance = std::max(worst_distance, (nearest->x - a.contact_rows[i].x).norm());
      worst = std::max({worst, std::abs(nearest->pressure_sprc - a.contact_rows[i].pressure_sprc),
                        std::abs(nearest->pressure_raw - a.contact_rows[i].pressure_raw)});
    }
    EXPECT_LT(worst_distance, 1e-15);
    // The problem on the face stops when its pressure changes by 1e-10 of the force in total, at single points by more.
    EXPECT_LT(worst / largest, 1e-8);
    EXPECT_LT((a.pairs[0].force_on_first - b.pairs[0].force_on_first).norm() / a.pairs[0].force_on_first.norm(), 1e-9);
    EXPECT_NEAR(a.estimated_error / b.estimated_error, 1, 1e-9);
  }
}

// Proves that the contact patch test is exact with two bodies from STL files on shifted and turned grids; bound as
// there.
TEST(TriangleBodies, PatchTestIsExact) {
  SceneWithMeshes scene("patch_test.toml");
  scene.replace_box("lower", {0, 0, 0}, {1, 0.8, 0.6});
  scene.replace_box("upper", {0, 0, 0.6}, {1, 0.8, 1.1});
  const auto solved = scene.run({"solver.tolerance=1e-13", "solver.linear_tolerance=1e-15"});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  double worst = 0;
  for (const ContactRow& row : r.contact_rows)
    for (double value : {row.pressure_raw, row.pressure_spr, row.pressure_sprc})
      worst = std::max(worst, std::abs(value - 1e8) / 1e8);
  EXPECT_LT(worst, 1e-10);
  EXPECT_LT(r.estimated_error_relative, 1e-10);
}

// Proves that curved contact faces of triangles work through the whole run: the example scene converges, and the forces
// on both bodies balance the reactions.
TEST(TriangleBodies, RailSceneConverges) {
  const auto solved = test::run_scene("scenes/rail.toml");
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  EXPECT_GT(r.pairs[0].force_on_first.norm(), 1e3);
}

}  // namespace
}  // namespace cgcontact::test_triangle_bodies
