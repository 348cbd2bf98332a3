/// Contact zones smaller than the cells: point-wise gaps and the forces that follow from them.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/groups/gap_samples.hpp"
#include "contact/model/press_direction.hpp"
#include "contact/preparation.hpp"
#include "contact/solve/forces/small_zones.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_small_zones {
namespace {

double force(const std::string& scene, const std::vector<std::string>& overrides) {
  const auto solved = test::run_scene(scene, overrides);
  const Results& r = solved->results();
  EXPECT_TRUE(r.converged) << r.diagnosis;
  EXPECT_EQ(r.verdict.state, Verdict::State::not_resolved);
  // First: the recovered pressure of such a zone may be warned of as well.
  EXPECT_NE(r.warnings.at(0).find("zone smaller than the cells"), std::string::npos);
  return r.pairs[0].force_on_first.norm();
}

/// A wedge of 45 degrees to either side over a plane: below a limit d above the edge lies, per metre of edge, a strip 2
/// d wide with the volume d^2. The samples of all groups give both within the refinement's tolerance (a tenth of the
/// depth; measured 10 and 3 %), although no contact point lies in the strip.
TEST(GapSamples, FindAnEdgeBetweenTheContactPoints) {
  const Scene scene = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/tests/scenes/cube_on_edge.toml", {});
  const Preparation p = prepare(scene);
  ASSERT_EQ(p.pairs.size(), 1u);
  for (const double limit : {3e-3, 3e-4}) {
    double area = 0, volume = 0, least = 1e300;
    for (const ContactGroup& group : p.pairs[0].groups)
      for (const GapSample& sample : sample_gap(p.bodies, p.pairs[0], group, limit)) {
        least = std::min(least, sample.distance);
        if (sample.distance >= limit) continue;
        area += sample.area;
        volume += sample.area * (limit - sample.distance);
        EXPECT_NEAR(sample.distance, std::abs(sample.x[0]), 1e-12);
      }
    const double length = 0.8;
    EXPECT_NEAR(area / (2 * limit * length), 1, 0.15);
    EXPECT_NEAR(volume / (limit * limit * length), 1, 0.05);
    EXPECT_LT(least, 0.2 * limit);
    for (const ContactPoint& q : p.pairs[0].points) EXPECT_GT(q.distance, 3e-3);
  }
}

/// Two planes: no samples where no distance is below the limit, else all of the face (slivers of it between samples
/// count nothing: measured 1 %).
TEST(GapSamples, NoneAboveTheLimit) {
  const Scene scene = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/tests/scenes/gap.toml", {});
  const Preparation p = prepare(scene);
  double area = 0, found = 0;
  for (const ContactGroup& group : p.pairs[0].groups) {
    EXPECT_TRUE(sample_gap(p.bodies, p.pairs[0], group, 0.0099).empty());
    area += group.area;
    for (const GapSample& sample : sample_gap(p.bodies, p.pairs[0], group, 0.0101)) found += sample.area;
  }
  EXPECT_NEAR(found / area, 1, 0.03);
}

/// The edge of a cube, pressed in by 0.005 to 0.05 cells: the force is the same for all cells within 8 % (measured 6 %;
/// the mean gaps of the cells see no contact at all).
TEST(SmallZones, ForceOfAnEdgeDoesNotDependOnTheCells) {
  const double coarse = force("tests/scenes/cube_on_edge.toml", {});
  EXPECT_GT(coarse, 0);
  for (const char* h : {"h=0.12", "h=0.07"})
    EXPECT_NEAR(force("tests/scenes/cube_on_edge.toml", {h}) / coarse, 1, 0.08);
}

/// The same with the cube as the coarser body: contact is measured across the edge, not along its faces' normals
/// (measured 1 %; 20 % with these, or no contact).
TEST(SmallZones, EdgeOfTheCoarserBody) {
  const double flat = force("tests/scenes/cube_on_edge.toml", {});
  EXPECT_NEAR(force("tests/scenes/cube_on_edge.toml", {"body.cube.cell_size=0.2", "body.block.cell_size=0.13"}) / flat,
              1, 0.12);
}

/// Normals of two faces that make up an edge, and of what they see, give the direction: that of a plane, or across both
/// edges. A cup is no tip.
TEST(PressDirection, PlanesAndEdges) {
  const Vec3 left = Vec3(-1, 0, -1).normalized(), right = Vec3(1, 0, -2).normalized();
  const Vec3 front = Vec3(0, -1, 1).normalized(), back = Vec3(0, 3, 1).normalized();
  FacingNormals on_plane, crossed, cup;
  for (const Vec3& n : {left, right}) {
    on_plane.add(n == left ? 1 : 3, Vec3(n[0], 0, 0), n, Vec3(0, 0, 1));
    cup.add(1, Vec3(-n[0], 0, 0), Vec3(n[0], 0, -0.1).normalized(), Vec3(0, 0, 1));
    for (const Vec3& m : {front, back}) crossed.add(m == front ? 1 : 2, Vec3(n[0], 0, 0), n, m);
  }
  EXPECT_LT((on_plane.direction() - Vec3(0, 0, -1)).norm(), 1e-8);
  EXPECT_LT((crossed.direction() - Vec3(0, 0, -1)).norm(), 1e-8);
  EXPECT_FALSE(cup.is_tip());
}

/// The zone's radius is 0.1 m, cells are 0.25 to 0.125 m: the force is that of cells of 25 mm, 3.585e7 N, within a
/// quarter (measured: 0.78, 0.93, 1.03; by mean gaps 0 and up to 1.4).
TEST(SmallZones, ForceOfABall) {
  for (const char* n : {"n=2", "n=3", "n=4"}) EXPECT_NEAR(force("scenes/hertz.toml", {n, "L=0.5"}) / 3.585e7, 1, 0.3);
}

/// Where the zone is several cells wide everything is as without them.
TEST(SmallZones, ResolvedZonesAreLeftAlone) {
  const auto solved = test::run_scene("scenes/hertz.toml", {"n=16", "L=0.5"});
  for (const int count : solved->simulation->state.outer.small_zone_groups) EXPECT_EQ(count, 0);
  EXPECT_TRUE(solved->results().warnings.empty());
}

}  // namespace
}  // namespace cgcontact::test_small_zones
