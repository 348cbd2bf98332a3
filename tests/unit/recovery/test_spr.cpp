/// Patches and the unconstrained fit on cut grids.
#include <gtest/gtest.h>

#include "recovery/spr/spr.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test_spr {
namespace {

CutCells turned_box() {
  return test::cut(Solid::box(Vec3(0.1, 0.15, 0.2), Vec3(0.9, 0.8, 0.75), "box"), test::odd_grid(7, 0.3));
}

/// The exact integrals of a linear stress field are fitted back to that field in every patch, slivers included.
TEST(Spr, ReproducesLinearStressesInAllPatches) {
  const CutCells cc = turned_box();
  const ElasticSystem system = make_elastic_system({&cc}, {Material{1, 0.3}}, Scales{1, 1}, 0.01);
  const BodyMesh& mesh = system.meshes[0];
  const PatchSet patches = make_patches(mesh);
  double slope[6][num_terms];
  for (int k = 0; k < 6; ++k)
    for (int t = 0; t < num_terms; ++t) slope[k][t] = std::sin(1.0 + 4 * k + t);
  CellStressView stress("stress", cc.cells.size());
  for (std::size_t e = 0; e < cc.cells.size(); ++e) {
    const double c[3] = {cc.cells[e][0] + 0.5, cc.cells[e][1] + 0.5, cc.cells[e][2] + 0.5};
    const MonomialMoments& m = patches.moments_of(cc, static_cast<int>(e));
    const double second[3][3] = {{m[4], m[7], m[9]}, {m[7], m[5], m[8]}, {m[9], m[8], m[6]}};
    for (int k = 0; k < 6; ++k) {
      const double at_centre = slope[k][0] + slope[k][1] * c[0] + slope[k][2] * c[1] + slope[k][3] * c[2];
      stress(e, k, 0) = at_centre * m[0];
      for (int i = 0; i < 3; ++i) {
        stress(e, k, 0) += slope[k][1 + i] * m[1 + i];
        stress(e, k, 1 + i) = at_centre * m[1 + i];
        for (int j = 0; j < 3; ++j) stress(e, k, 1 + i) += slope[k][1 + j] * second[i][j];
      }
    }
  }
  const Subset all_cells(static_cast<int>(cc.cells.size()));
  const RecoveredField field{Subset(mesh.num_nodes), CoefficientView("a", mesh.num_nodes)};
  EXPECT_EQ(fit_patches(mesh, patches, stress, all_cells, field), 0);
  const CoefficientView& a = field.values;
  for (int n = 0; n < mesh.num_nodes; ++n)
    for (int k = 0; k < 6; ++k) {
      const Index3& x = mesh.nodes[n];
      // Patches hold at least one cell of volume: condition of m below some hundred.
      EXPECT_NEAR(a(n, k, 0), slope[k][0] + slope[k][1] * x[0] + slope[k][2] * x[1] + slope[k][3] * x[2], 1e-10);
      for (int i = 1; i < 4; ++i) EXPECT_NEAR(a(n, k, i), slope[k][i], 1e-10);
    }
}

TEST(Spr, EveryPatchHoldsAtLeastOneCellOfVolume) {
  const CutCells cc = turned_box();
  const ElasticSystem system = make_elastic_system({&cc}, {Material{1, 0.3}}, Scales{1, 1}, 0.01);
  const PatchSet patches = make_patches(system.meshes[0]);
  int grown = 0;
  for (int n = 0; n < system.meshes[0].num_nodes; ++n) {
    double volume = 0;
    for (int p = patches.begin[n]; p < patches.begin[n + 1]; ++p) volume += cc.volume_fraction(patches.cells[p]);
    EXPECT_GE(volume, 1 - 1e-12);
    grown += patches.grown[n];
  }
  EXPECT_GT(grown, 0);  // otherwise the case proves nothing
}

/// A constant strain gives a constant recovered stress: sigma_h is exact and conjoint evaluation is a partition of
/// unity.
TEST(Spr, ConstantStressIsExactAtBoundaryPoints) {
  const CutCells cc = turned_box();
  const ElasticSystem system = make_elastic_system({&cc}, {Material{3, 0.3}}, Scales{0.5, 2}, 0.01);
  const BodyMesh& mesh = system.meshes[0];
  const PatchSet patches = make_patches(mesh);
  const Mat3 R = cc.grid.rotation;
  Mat3 gradient;
  gradient << 0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.25, 0.15, -0.6;
  const RealView u = test::nodal_field(system, [&](const Vec3& x) -> Vec3 { return gradient * x / 0.5; });
  CellStressView stress("stress", cc.cells.size());
  const Subset all_cells(static_cast<int>(cc.cells.size()));
  integrate_cell_stress(mesh, patches, all_cells, u, stress);
  const RecoveredField field{Subset(mesh.num_nodes), CoefficientView("a", mesh.num_nodes)};
  fit_patches(mesh, patches, stress, all_cells, field);
  const UnitElasticity law(0.3);
  const Mat3 strain = 0.5 * (gradient + gradient.transpose());
  const Mat3 exact = 1.5 * (law.lambda * strain.trace() * Mat3::Identity() + 2 * law.mu * strain);
  for (std::size_t p = 0; p < cc.boundary.size(); ++p) {
    const Index3& c = cc.cells[cc.boundary.cell[p]];
    const Vec3 xi = 2 * (cc.boundary.position[p] - Vec3(c[0], c[1], c[2])) - Vec3::Ones();
    Sym3 s;
    evaluate_recovered(mesh, field, cc.boundary.cell[p], xi.data(), s.data());
    EXPECT_LT((R * tensor(s) * R.transpose() - exact).norm(), 1e-11 * exact.norm());
  }
}

}  // namespace
}  // namespace cgcontact::test_spr
