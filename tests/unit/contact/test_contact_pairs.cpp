/// Contact pairs: opposite points, areas, gaps; free motions; a body held only by contact across an initial gap.
#include <gtest/gtest.h>

#include <set>

#include "contact/groups/group_rows.hpp"
#include "contact/model/opposite_borders.hpp"
#include "contact/model/opposite_points.hpp"
#include "contact/preparation.hpp"
#include "tests/support/run_scene.hpp"
#include "tests/support/scene_text.hpp"

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

/// Rows of friction: what the bodies move together is no slip, what the secondary one moves alone is one along each
/// tangent, in the mean of the group. Rows that have the same entries keep their values.
TEST(ContactPairs, TangentRowsMeasureTheSlip) {
  const Scene scene = read("tests/scenes/gap.toml", {"contact.0.friction=0.3"});
  Simulation simulation(scene);
  simulation.set_up_grids();
  simulation.make_system();
  const SolvedState& state = simulation.state;
  const ContactPair& pair = state.pairs[0];
  ASSERT_EQ(pair.num_tangents, 2);
  std::vector<GroupRow> rows = make_tangent_rows(ExecSpace(), state.pairs, state.bodies, state.system);
  ASSERT_EQ(rows.size(), 2 * pair.groups.size());
  const Vec3 v(0.3, -0.7, 0.2);
  const auto expect_slip = [&] {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const ContactGroup& group = pair.groups[r / 2];
      double expected = 0;
      for (int q = group.first_point; q < group.last_point; ++q)
        expected += pair.points.weight(q) / group.area * pair.tangents(q)[r % 2].dot(v);
      double secondary = 0, both = 0;
      for (const auto& [dof, value] : rows[r].entries) {
        const int body = node_of_dof(dof) < state.system.meshes[1].first_node ? 0 : 1;
        const double change = value * state.bodies[body].cut_cells.grid.rotation.col(component_of_dof(dof)).dot(v);
        both += change;
        secondary += body == pair.secondary ? change : 0;
      }
      EXPECT_NEAR(secondary, expected, 1e-12);
      EXPECT_NEAR(both, 0, 1e-12);
    }
  };
  expect_slip();
  match_tangent_rows(state.pairs, 0, rows);
  expect_slip();
  for (std::size_t r = 0; r < rows.size(); r += 2) {
    ASSERT_EQ(rows[r].entries.size(), rows[r + 1].entries.size());
    for (std::size_t e = 0; e < rows[r].entries.size(); ++e)
      EXPECT_EQ(rows[r].entries[e].first, rows[r + 1].entries[e].first);
  }
}

/// Blocks of 0.6 m height with a gap between them, or that overlap: what a point sees along its normal.
TEST(OppositePoints, FaceThePointAcrossAGapOrAnOverlap) {
  const FaceSpec any;
  FaceSpec half;
  half.box = {Vec3(0.5, -1, -1), Vec3(2, 2, 2)};
  for (const double gap : {0.01, -0.001}) {
    const Scene scene = read("tests/scenes/gap.toml", {"gap=" + std::to_string(gap)});
    const std::vector<BodyModel> bodies = make_body_models(scene);
    const BodyModel &lower = bodies[0], &upper = bodies[1];
    const Vec3 up = Vec3::UnitZ(), top(0.3, 0.4, 0.6);
    const auto found = find_opposite(lower, upper, any, top, up, {0.02, 0.02});
    ASSERT_TRUE(found) << gap;
    EXPECT_NEAR(found->distance, gap, 1e-13);
    EXPECT_LT((upper.cut_cells.grid.to_global(found->position) - top - gap * up).norm(), 1e-13);
    EXPECT_LT((found->normal + up).norm(), 1e-13);
    EXPECT_LE(cell_coordinates(upper.cut_cells, found->cell, found->position).cwiseAbs().maxCoeff(), 1 + 1e-9);
    const auto back = find_opposite(upper, lower, any, top + gap * up, -up, {0.02, 0.02});
    ASSERT_TRUE(back) << gap;
    EXPECT_NEAR(back->distance, gap, 1e-13);
    const Reach too_short = gap > 0 ? Reach{0.5 * gap, 1} : Reach{1, -0.5 * gap};
    EXPECT_FALSE(find_opposite(lower, upper, any, top, up, too_short)) << "the far sides are hidden";
    EXPECT_FALSE(find_opposite(lower, upper, half, top, up, {0.02, 0.02})) << "outside of the face";
    EXPECT_TRUE(find_opposite(lower, upper, half, top + 0.4 * Vec3::UnitX(), up, {0.02, 0.02}));
    EXPECT_FALSE(find_opposite(lower, upper, any, Vec3(0.3, 0.4, 0), -up, {5, 5})) << "the body itself is between";
    EXPECT_FALSE(find_opposite(lower, upper, any, Vec3(0, 0.4, 0.3), -Vec3::UnitX(), {5, 5}));
    EXPECT_NEAR(box_distance(lower, upper), std::max(gap, 0.0), 1e-14);
    EXPECT_NEAR(longest_extent(lower), 1, 1e-14);
  }
}

TEST(OppositePoints, AreHiddenByWhatComesBetween) {
  const Scene scene = read("tests/scenes/gap.toml");
  const std::vector<BodyModel> bodies = make_body_models(scene);
  const Vec3 below(0.3, 0.4, -0.1), up = Vec3::UnitZ();
  EXPECT_TRUE(comes_between(bodies[0], below, up, 0.2));
  EXPECT_FALSE(comes_between(bodies[0], below, up, 0.05));
  EXPECT_FALSE(comes_between(bodies[0], below, -up, 0.2));
  EXPECT_FALSE(comes_between(bodies[0], Vec3(1.2, 0.4, -0.1), up, 5)) << "beside it";
}

/// The distance between boxes that are apart along all axes is that of their corners.
TEST(OppositePoints, BoxDistanceIsThatOfTheNearestCorners) {
  const Scene scene =
      parse_scene(test::box_text("a", "[0, 0, 0]", "[1, 1, 1]", 0.4, test::turned_grid) +
                      test::box_text("b", "[3, 4, -7]", "[4, 5, -6]", 0.4) + test::symmetry_text({"a.z-"}),
                  "scene.toml");
  const std::vector<BodyModel> bodies = make_body_models(scene);
  EXPECT_NEAR(box_distance(bodies[0], bodies[1]), 7, 1e-12);  // 2, 3 and 6
  EXPECT_NEAR(box_distance(bodies[1], bodies[0]), 7, 1e-12);
  EXPECT_EQ(box_distance(bodies[0], bodies[0]), 0);
}

/// A face ends at x = 0.3 on a block; the surface of a block that leans by 20 degrees above it is divided where its
/// normals meet that border, at the top of the lower block (or would at its bottom).
TEST(OppositeBorders, AreSeenAlongTheNormalsOfTheOwnSurface) {
  const Scene scene = parse_scene(R"(
[[body]]
name = "lower"
shape = {box = {min = [0, 0, 0], max = [1, 0.8, 0.6]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.17
grid = {offset = [0.2, 0.3, 0.6]}
[[body]]
name = "upper"
shape = {box = {min = [0, 0, 1], max = [0.9, 0.8, 1.3]}, rotate = {axis = [0, 1, 0], angle = 20}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.13
grid = {offset = [0.7, 0.1, 0.4], rotation = {axis = [1, 2, 3], angle = 15}}
[[support]]
face = "lower.z-"
symmetry = true
)",
                                  "scene.toml");
  const std::vector<BodyModel> bodies = make_body_models(scene);
  const CutCells &own = bodies[1].cut_cells, &other = bodies[0].cut_cells;
  FaceSpec face;
  face.surfaces = {"box.z+"};
  face.box = {Vec3(-1, -1, -1), Vec3(0.3, 2, 2)};
  const std::vector<Plane> dividers = box_dividers(other, face);
  ASSERT_FALSE(dividers.empty());
  int at_the_top = 0;
  for (int s = 0; s < static_cast<int>(own.solid.surfaces().size()); ++s) {
    const Surface& surface = own.solid.surfaces()[s];
    const Vec3 n = own.grid.rotation * surface.direction;
    if (n[2] > -0.9) continue;  // its lower face only
    EXPECT_NEAR(std::abs(n[0]), std::sin(20 * radians_per_degree), 1e-12);
    for (const Plane& border : opposite_borders(own, s, other, face, dividers)) {
      if (std::abs((own.grid.rotation * border.normal)[1]) > 0.9) continue;  // ends of the box along y
      Mat3 planes;                                                           // a point of both, by its y in the grid
      planes << surface.direction.transpose(), border.normal.transpose(),
          (own.grid.rotation.transpose() * Vec3::UnitY()).transpose();
      const Vec3 x = own.grid.to_global(
          planes.partialPivLu().solve(Vec3(surface.direction.dot(surface.point), border.offset, 0.2)));
      const auto seen = [&](double z) { return x[0] + (z - x[2]) / n[2] * n[0]; };  // where its normal meets a height
      const bool at_bottom = std::abs(seen(0) - 0.3) < 1e-9 || std::abs(seen(0) + 1) < 1e-9;
      EXPECT_TRUE(at_bottom || std::abs(seen(0.6) - 0.3) < 1e-9 || std::abs(seen(0.6) + 1) < 1e-9) << seen(0.6);
      at_the_top += std::abs(seen(0.6) - 0.3) < 1e-9;
    }
  }
  EXPECT_EQ(at_the_top, 1);
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
