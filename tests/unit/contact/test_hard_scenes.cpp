/// Whole scenes with what recovery finds hardest (docs/recovery.md): contact that ends at a body's edge in the inside
/// of the other's face, walls thinner than a cell, loads that disagree at an edge, moduli 1e6 apart, nearly
/// incompressible, cells 8:1 and 1:8, turned grids, and several of these at once.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>

#include "tests/support/run_scene.hpp"

namespace cgcontact::test_hard_scenes {
namespace {

struct HardCase {
  std::string name;
  std::vector<std::string> overrides;
};

void PrintTo(const HardCase& c, std::ostream* out) { *out << c.name; }

class HardScene : public testing::TestWithParam<HardCase> {};

/// Every number finite; every patch counted with a kind and a status, nothing without a polynomial; forces in balance;
/// the recovered pressure carries the force. A punch's pressure is singular at its edges and most patches are of that
/// kind here: 35 % of the force is what these grids of two to six cells across give at worst (measured: 32 %), and the
/// constraints may not blow up the pressure (measured: 1.1 times SPR's).
TEST_P(HardScene, IsSolvedWithoutSilence) {
  const auto solved = test::run_scene("tests/scenes/hard_punch.toml", GetParam().overrides);
  const Results& r = solved->results();
  EXPECT_TRUE(r.converged) << r.diagnosis;
  double carried = 0, spr = 0, sprc = 0;
  for (const ContactRow& row : r.contact_rows) {
    for (const double value : {row.pressure_raw, row.pressure_spr, row.pressure_sprc, row.pressure_error})
      ASSERT_TRUE(std::isfinite(value)) << row.x.transpose();
    ASSERT_TRUE(row.stress_sprc.allFinite()) << row.x.transpose();
    carried += 0.5 * row.weight * row.pressure_sprc;
    spr += row.weight * row.pressure_spr * row.pressure_spr;
    sprc += row.weight * row.pressure_sprc * row.pressure_sprc;
  }
  const double force = r.pairs[0].force_on_first.norm();
  ASSERT_GT(force, 0);
  std::printf("carried %.3f of the force, norm of the pressure %.2f of SPR's\n", carried / force,
              std::sqrt(sprc / spr));
  EXPECT_NEAR(carried / force, 1, 0.35);
  EXPECT_LT(sprc, 4 * spr);
  EXPECT_LE((r.pairs[0].force_on_first + r.pairs[0].force_on_second).norm(), 1e-10 * force);
  EXPECT_TRUE(std::isfinite(r.estimated_error_relative));
  EXPECT_TRUE(std::isfinite(r.pairs[0].pressure_error_estimate));
  long long patches = 0;
  for (const BodyFields& body : r.bodies) {
    const BodyMesh& mesh = solved->simulation->state.system.meshes[&body - r.bodies.data()];
    patches += mesh.num_nodes;
    for (int c = 0; c < static_cast<int>(body.cut_cells->cells.size()); ++c)
      for (const Vec3& xi : {Vec3(0, 0, 0), Vec3(0.9, -0.9, 0.9)})
        ASSERT_TRUE(body.stress_recovered(c, xi).allFinite()) << body.name << " cell " << c;
  }
  const auto total = [](const auto& counts) {
    return std::accumulate(counts.begin(), counts.end(), 0LL,
                           [](long long sum, const auto& c) { return sum + c.second; });
  };
  EXPECT_EQ(total(r.patches_by_kind), patches);
  EXPECT_EQ(total(r.patches_by_status), patches);
  const std::map<std::string, long long> count(r.patches_by_status.begin(), r.patches_by_status.end());
  EXPECT_EQ(count.count("singular"), 0u);
  EXPECT_EQ(count.count("conflicting"), 1u) << "the punch's edges contradict each other: the case proves nothing";
}

INSTANTIATE_TEST_SUITE_P(
    Punch, HardScene,
    testing::Values(HardCase{"turned", {}}, HardCase{"aligned", {"angle=0"}},
                    HardCase{"softer_by_1e6", {"contrast=1e-6"}}, HardCase{"stiffer_by_1e6", {"contrast=1e6"}},
                    HardCase{"nearly_incompressible", {"nu=0.4999"}}, HardCase{"thin_wall", {"wall=0.03"}},
                    HardCase{"wall_of_a_tenth_of_a_cell", {"wall=0.01"}},
                    HardCase{"disagreeing_loads", {"disagreeing=1"}}, HardCase{"coarse_punch", {"ratio=0.125", "n=32"}},
                    HardCase{"fine_punch", {"ratio=8", "n=5"}},
                    HardCase{"all_at_once", {"contrast=1e3", "nu=0.4999", "wall=0.03", "disagreeing=1"}}));

}  // namespace
}  // namespace cgcontact::test_hard_scenes
