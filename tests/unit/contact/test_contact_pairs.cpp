/// Contact pairs: opposite points, areas, gaps; free motions; a body held only by contact across an initial gap.
#include <gtest/gtest.h>

#include <set>

#include "contact/preparation.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_contact_pairs {
namespace {

Scene read(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/" + name, overrides);
}

TEST(ContactPairs, PointsCoverTheFaceAndMeetTheOtherBody) {
  const Scene scene = read("tests/scenes/gap.toml");
  const Preparation p = prepare(scene);
  ASSERT_EQ(p.pairs.size(), 1u);
  const ContactPair& pair = p.pairs[0];
  EXPECT_EQ(scene.bodies[pair.primary].name, "lower");  // the coarser one
  double area = 0, group_area = 0;
  for (const ContactPoint& q : pair.points) {
    area += q.weight;
    EXPECT_NEAR(q.distance, 0.01, 1e-13);
    const CutCells& other = p.bodies[pair.secondary].cut_cells;
    EXPECT_LT((other.grid.to_global(q.secondary_position) - q.x - 0.01 * q.normal).norm(), 1e-13);
    // Split at the other grid: the point lies in its cell, not merely near it.
    EXPECT_LE(q.secondary_xi.cwiseAbs().maxCoeff(), 1 + 1e-9);
    EXPECT_LE(q.primary_xi.cwiseAbs().maxCoeff(), 1 + 1e-9);
  }
  for (const ContactGroup& g : pair.groups) group_area += g.area;
  EXPECT_NEAR(area, 0.8, 1e-12);
  EXPECT_NEAR(group_area, 0.8, 1e-12);
}

/// Half of the coarser body's cells are made smaller than the other body's: there a group is what lies under a cell of
/// the other body, elsewhere what lies in a cell of its own.
TEST(ContactPairs, GroupsBelongToTheLargerCell) {
  Scene scene = read("tests/scenes/gap.toml");
  BodySpec& lower = scene.bodies[scene.bodies[0].name == "lower" ? 0 : 1];
  RefineSpec half;
  half.kind = RefineSpec::Kind::box;
  half.min = Vec3(-1, -1, -1);
  half.max = Vec3(0.3, 2, 2);
  half.size = lower.cell_size / 8;
  lower.refine = {half};
  std::vector<BodyModel> bodies = make_body_models(scene);
  const CutCells& coarser = bodies[&lower - scene.bodies.data()].cut_cells;
  ASSERT_EQ(coarser.num_levels(), 4);
  const std::vector<ContactPair> pairs = make_contact_pairs(scene, bodies);
  ASSERT_EQ(pairs.size(), 1u);
  const ContactPair& pair = pairs[0];
  ASSERT_EQ(scene.bodies[pair.primary].name, "lower") << "the largest cells are still its own";
  double area = 0;
  int own = 0, others = 0;
  std::set<std::pair<int, int>> cells;
  for (const ContactGroup& group : pair.groups) {
    area += group.area;
    EXPECT_TRUE(cells.insert({group.body, group.cell}).second) << "one face, one group for each cell";
    EXPECT_EQ(group.larger_cell, bodies[group.body].cut_cells.h(group.cell));
    (group.body == pair.primary ? own : others) += 1;
    for (int q = group.first_point; q < group.last_point; ++q) {
      const ContactPoint& point = pair.points[q];
      EXPECT_EQ(coarser.h(point.primary_cell) < bodies[pair.secondary].cut_cells.h(point.secondary_cell),
                group.body == pair.secondary);
      EXPECT_EQ(group.body == pair.primary ? point.primary_cell : point.secondary_cell, group.cell);
      EXPECT_LE(group.h, coarser.h(point.primary_cell));
      EXPECT_LE(coarser.h(point.primary_cell), group.larger_cell);
    }
  }
  EXPECT_NEAR(area, 0.8, 1e-12);
  EXPECT_GT(own, 0);
  EXPECT_GT(others, 0);
}

/// Rows of the gap: a relative rigid translation along the normal changes every gap by its length.
TEST(ContactPairs, GroupRowsMeasureTheGap) {
  const auto solved = test::run_scene("tests/scenes/gap.toml");
  const ElasticSystem& system = solved->simulation->state.system;
  for (const GroupRow& row : system.group_rows) {
    double opening = 0, common = 0;
    for (const auto& [dof, value] : row.entries) {
      const bool upper = node_of_dof(dof) >= system.meshes[1].first_node;
      // The upper grid is turned about z only: its third axis is the global one.
      if (component_of_dof(dof) == 2) (upper ? opening : common) += value;
    }
    EXPECT_NEAR(opening, 1, 1e-12);
    EXPECT_NEAR(common, -1, 1e-12);
  }
}

/// The upper body is held vertically by contact only; the gap closes and uniform pressure is exact.
TEST(ContactPairs, LoadClosesAnInitialGap) {
  const auto solved = test::run_scene("tests/scenes/gap.toml", {"solver.tolerance=1e-11"});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  EXPECT_NEAR(r.pairs[0].force_on_first[2] / (-0.8e9), 1, 1e-9);
  for (const ContactRow& row : r.contact_rows) {
    EXPECT_NEAR(row.pressure_sprc / 1e9, 1, 1e-8);
    EXPECT_NEAR(row.gap, 0, 1e-9);
  }
}

TEST(FreeMotion, IsNamed) {
  Scene scene = read("tests/scenes/gap.toml");
  scene.supports.erase(scene.supports.begin() + 3);  // upper.x-
  Simulation simulation(scene);
  try {
    simulation.run({});
    FAIL() << "a free body was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("\"upper\" is free to move along x: add a support"), std::string::npos)
        << error.what();
  }
}

/// Reactions, loads and contact forces of each body balance.
TEST(Equilibrium, OfEachBody) {
  const auto solved = test::run_scene("scenes/two_solids_3d.toml", {"n=8"});
  const Results& r = solved->results();
  Vec3 lower = r.pairs[0].force_on_first, upper = r.pairs[0].force_on_second;
  for (const SupportFigures& s : r.supports) (s.face.find("lower") == 0 ? lower : upper) += s.force;
  // Load on the lateral face: int_0^0.01 q (0.01 - z) z dz * thickness, with q = 4e11 (inwards, -y) and 10e11 (-z).
  const double integral = std::pow(0.01, 3) / 6 * 0.01;
  lower += Vec3(0, -4e11 * integral, -10e11 * integral);
  const double scale = r.pairs[0].force_on_first.norm();
  EXPECT_LT(lower.norm(), 1e-8 * scale);
  EXPECT_LT(upper.norm(), 1e-8 * scale);
}

/// No load and touching faces: nothing happens, and the loop sees that.
TEST(NoForce, ZeroLoadConvergesToZero) {
  const auto solved = test::run_scene("tests/scenes/gap.toml", {"gap=0", "p=0"});
  ASSERT_TRUE(solved->results().converged) << solved->results().diagnosis;
  for (const ContactRow& row : solved->results().contact_rows) EXPECT_LT(std::abs(row.pressure_sprc), 1.0);
}

/// The upper body is lifted off: a motion without stress, no contact.
TEST(NoForce, LiftingOffConverges) {
  const auto solved =
      test::run_scene("tests/scenes/turned.toml", {"load.0.pressure=0", "support.5.displacement={normal=1e-3}"});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  EXPECT_EQ(r.active_points, 0);
  for (const ContactRow& row : r.contact_rows) EXPECT_LT(std::abs(row.pressure_sprc), 1e-6 * 115e9 * 1e-3);
}

}  // namespace
}  // namespace cgcontact::test_contact_pairs
