/// Contact patch test: uniform pressure across unrelated grids is exact, raw, SPR and SPR-C.
#include <gtest/gtest.h>

#include "tests/support/run_scene.hpp"

namespace cgcontact::test_patch {
namespace {

/// Outer and linear solver are converged far below the bound, so that it tests the discretisation.
const std::vector<std::string> tight{"solver.tolerance=1e-13", "solver.linear_tolerance=1e-15"};

struct PatchCase {
  std::string name;
  std::vector<std::string> overrides;
};

void PrintTo(const PatchCase& c, std::ostream* out) { *out << c.name; }

class ContactPatch : public testing::TestWithParam<PatchCase> {};

TEST_P(ContactPatch, IsExact) {
  std::vector<std::string> overrides = tight;
  overrides.insert(overrides.end(), GetParam().overrides.begin(), GetParam().overrides.end());
  const auto solved = test::run_scene("scenes/patch_test.toml", overrides);
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const double p = 1e8, tolerance = 1e-10;
  Sym3 exact = Sym3::Zero();
  exact[2] = -p;
  double worst_pressure = 0, worst_stress = 0;
  for (const ContactRow& row : r.contact_rows) {
    for (double value : {row.pressure_raw, row.pressure_spr, row.pressure_sprc})
      worst_pressure = std::max(worst_pressure, std::abs(value - p) / p);
    for (const Sym3& s : {row.stress_raw, row.stress_spr, row.stress_sprc})
      worst_stress = std::max(worst_stress, (s - exact).norm() / p);
  }
  EXPECT_LT(worst_pressure, tolerance);
  EXPECT_LT(worst_stress, tolerance);
  // Displacement and stress in every cell, at the centre and a corner.
  double worst_displacement = 0, worst_inside = 0, softest = 1e300;
  const double lower_modulus = r.bodies[0].material.youngs_modulus;
  for (const BodyFields& body : r.bodies) softest = std::min(softest, body.material.youngs_modulus);
  for (const BodyFields& body : r.bodies) {
    const bool lower = body.name == "lower";
    const double E = body.material.youngs_modulus, nu = body.material.poisson_ratio;
    const double offset = lower ? 0 : -p / lower_modulus * 0.6 + p / E * 0.6;
    const double scale = p / softest;
    for (int c = 0; c < static_cast<int>(body.cut_cells->cells.size()); ++c)
      for (const Vec3& xi : {Vec3(0, 0, 0), Vec3(-0.9, 0.8, 0.7)}) {
        const Index3& g = body.cut_cells->cells[c];
        const Vec3 x = body.cut_cells->grid.to_global(Vec3(g[0], g[1], g[2]) + 0.5 * (xi + Vec3::Ones()));
        const Vec3 u(nu * p / E * x[0], nu * p / E * x[1], -p / E * x[2] + offset);
        worst_displacement = std::max(worst_displacement, (body.displacement(c, xi) - u).norm() / scale);
        worst_inside = std::max(worst_inside, (body.stress_raw(c, xi) - exact).norm() / p);
        worst_inside = std::max(worst_inside, (body.stress_recovered(c, xi) - exact).norm() / p);
      }
  }
  EXPECT_LT(worst_displacement, tolerance);
  EXPECT_LT(worst_inside, tolerance);
  EXPECT_LT(r.estimated_error_relative, tolerance);
  ASSERT_EQ(r.pairs.size(), 1u);
  EXPECT_NEAR(r.pairs[0].force_on_first[2] / (-0.8 * p), 1, tolerance);
  EXPECT_LT((r.pairs[0].force_on_first + r.pairs[0].force_on_second).norm(), tolerance * 0.8 * p);
}

INSTANTIATE_TEST_SUITE_P(
    Grids, ContactPatch,
    testing::Values(
        PatchCase{"rotated", {}}, PatchCase{"shifted", {"angle=0"}},
        PatchCase{"on_a_grid_plane", {"body.lower.grid.offset=[0.3, 0.6, 0]"}},
        PatchCase{"both_on_grid_planes",
                  {"angle=0", "body.lower.grid.offset=[0, 0, 0]", "body.upper.grid.offset=[0, 0, 0]",
                   "body.upper.cell_size=0.05"}},
        PatchCase{"upper_coarser", {"body.upper.cell_size=0.23"}}, PatchCase{"degree_2", {"recovery.degree=2"}},
        PatchCase{"degree_2_of_contact", {"recovery.degree.contact=2"}},
        PatchCase{"degree_2_upper_coarser", {"recovery.degree=2", "recovery.rings=2", "body.upper.cell_size=0.23"}},
        PatchCase{
            "slivers_on_both_sides",
            {"angle=0", "body.lower.grid.offset=[0.3, 0.6, 1e-9]", "body.upper.grid.offset=[0.1, 0.2, 0.999999999]"}},
        PatchCase{"cells_1_to_8", {"h=0.4", "body.upper.cell_size=h/8"}},
        PatchCase{"cells_8_to_1", {"h=0.05", "body.upper.cell_size=8*h"}},
        PatchCase{"softer_by_1e6", {"body.upper.material.E=200e3"}},
        PatchCase{"stiffer_by_1e6", {"body.lower.material.E=200e3"}},
        PatchCase{"all_at_once",
                  {"h=0.4", "body.upper.cell_size=h/8", "body.lower.grid.offset=[0.3, 0.6, 0.500000001]",
                   "body.upper.material.E=200e3"}},
        PatchCase{"all_at_once_stiffer",
                  {"h=0.4", "body.upper.cell_size=h/8", "body.lower.grid.offset=[0.3, 0.6, 0.500000001]",
                   "body.lower.material.E=200e3"}}),
    [](const auto& test) { return test.param.name; });

/// Two automatic pairs, three materials: the same exactness on every interface.
TEST(ContactPatchChain, AutomaticPairsAreExact) {
  std::vector<std::string> overrides = tight;
  const auto solved = test::run_scene("tests/scenes/three_blocks.toml", overrides);
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  ASSERT_EQ(r.pairs.size(), 2u);
  ASSERT_FALSE(r.contact_rows.empty());
  for (const ContactRow& row : r.contact_rows)
    for (double value : {row.pressure_raw, row.pressure_spr, row.pressure_sprc}) EXPECT_NEAR(value / 1e7, 1, 1e-9);
  for (const PairFigures& pair : r.pairs) EXPECT_NEAR(pair.force_on_second[2] / 1e7, 1, 1e-9);
}

}  // namespace
}  // namespace cgcontact::test_patch
