/// The fast loops of the recovery against plain ones: cell by cell with quadrature, patch by patch with dense matrices.
#include <gtest/gtest.h>

#include "core/cells/cells_around.hpp"
#include "kernels/mesh/mean_dilatation.hpp"
#include "recovery/constrained/boundary_facets.hpp"
#include "recovery/constrained/divergence.hpp"
#include "recovery/constrained/recover_stress.hpp"
#include "recovery/error/error_estimate.hpp"
#include "recovery/spr/spr_kernels.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/constrained_fit.hpp"
#include "tests/support/triangle_shapes.hpp"

namespace cgcontact::test_plain_references {
namespace {

using namespace test;

/// A turned box with cut cells of all sizes, a random displacement and its plain SPR.
struct Case {
  CutCells cc = test::cut(Solid::box(Vec3(0.1, 0.15, 0.2), Vec3(0.9, 0.8, 0.75), "box"), test::odd_grid(9, 0.3));
  ElasticSystem system = make_elastic_system({&cc}, {Material{3, 0.48}}, Scales{0.5, 2}, 0.01);
  const BodyMesh& mesh = system.meshes[0];
  PatchSet patches = make_patches(mesh);
  Subset cells{static_cast<int>(cc.cells.size())};
  RealView u = test::random_vector(system.num_dofs(), 3);
  CellStressView stress{"stress", cc.cells.size()};
  RecoveredField field{Subset(mesh.num_nodes), CoefficientView("field", mesh.num_nodes)};

  Case() {
    integrate_cell_stress(mesh, patches, cells, u, stress);
    fit_patches(mesh, patches, stress, cells, field);
  }

  void corner_displacements(int cell, double corner[8][3]) const { corner_values(mesh.cell_nodes[cell], u, corner); }
  const Moments& moments(int cell) const {
    const int cut = cc.cut_of_active[cell];
    return cut < 0 ? full_cell_moments() : cc.moments[cut];
  }
};

TEST(PlainReferences, CellStressIntegrals) {
  const Case c;
  for (int e = 0; e < c.cells.size(); ++e) {
    double weights[27], corner[8][3], sum[6][num_terms] = {}, largest = 0;
    fitted_weights(c.moments(e), 3, weights);
    c.corner_displacements(e, corner);
    for (int q = 0; q < 27; ++q) {
      const double xi[3] = {Gauss3::point[q / 9], Gauss3::point[q / 3 % 3], Gauss3::point[q % 3]};
      double s[6];
      hex_stress(c.mesh.law, corner, mean_dilatation(c.mesh, e, corner), xi, s);
      for (int k = 0; k < 6; ++k) {
        const double value = c.mesh.stress_factor(e) * weights[q] / 8 * s[k];
        largest = std::max(largest, std::abs(c.mesh.stress_factor(e) * s[k]));
        sum[k][0] += value;
        for (int d = 0; d < 3; ++d) sum[k][1 + d] += 0.5 * xi[d] * value;
      }
    }
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t) EXPECT_NEAR(c.stress(e, k, t), sum[k][t], 1e-14 * largest);
  }
}

TEST(PlainReferences, CellsAround) {
  const Case c;
  std::vector<int> some;
  for (std::size_t e = 0; e < c.cc.cells.size(); e += 37) some.push_back(static_cast<int>(e));
  std::vector<char> marked(c.cc.cells.size(), 0);
  mark_cells_around(c.cc, some, 2, marked);
  int count = 0;
  for (std::size_t e = 0; e < c.cc.cells.size(); ++e) {
    const bool near = std::any_of(some.begin(), some.end(), [&](const int other) {
      const Index3& at = c.cc.cells[other];
      int most = 0;
      for (int d = 0; d < 3; ++d) most = std::max(most, std::abs(at[d] - c.cc.cells[e][d]));
      return most <= 2;
    });
    EXPECT_EQ(marked[e] != 0, near);
    count += near;
  }
  EXPECT_GT(count, 100);
  EXPECT_LT(count, static_cast<int>(c.cc.cells.size()));
}

/// All patches, the full ones with the general fit, and only some of them.
TEST(PlainReferences, PatchFits) {
  const Case c;
  std::vector<char> marked(c.mesh.num_nodes, 0), marked_cells(c.cells.size(), 0);
  for (int n = 0; n < c.mesh.num_nodes; n += 3) {
    marked[n] = 1;
    for (int p = c.patches.begin[n]; p < c.patches.begin[n + 1]; ++p) marked_cells[c.patches.cells[p]] = 1;
  }
  const Subset some_nodes(marked), some_cells(marked_cells);
  const RecoveredField some{some_nodes, CoefficientView("some", some_nodes.size())};
  CellStressView some_stress("some", some_cells.size());
  const PatchSet some_patches = make_patches(c.mesh, 1, some_nodes);
  integrate_cell_stress(c.mesh, some_patches, some_cells, c.u, some_stress);
  fit_patches(c.mesh, some_patches, some_stress, some_cells, some);
  const RecoveredField all{Subset(c.mesh.num_nodes), CoefficientView("all", c.mesh.num_nodes)};
  EXPECT_EQ(recover_all(c.mesh, c.patches, c.u, all, 100), 0);
  int full = 0;
  for (int n = 0; n < c.mesh.num_nodes; ++n) {
    EXPECT_TRUE(std::equal(all.at(n), all.at(n) + 6 * num_terms, c.field.at(n)));
    const Index3& node = c.mesh.nodes[n];
    const double centre[3] = {double(node[0]), double(node[1]), double(node[2])};
    const int* cells = c.patches.cells.data() + c.patches.begin[n];
    const int num_cells = c.patches.begin[n + 1] - c.patches.begin[n];
    const auto arrays = host_arrays(c.mesh, c.patches);
    double m[num_terms][num_terms], H[6][num_terms];
    gather_mass(arrays, cells, num_cells, centre, m);
    gather_stress(arrays, cells, num_cells, centre, c.stress, host_arrays(c.cells), H);
    ASSERT_TRUE(cholesky(m));
    for (int k = 0; k < 6; ++k) {
      cholesky_solve(m, H[k]);
      for (int t = 0; t < num_terms; ++t) EXPECT_NEAR(c.field.at(n)[num_terms * k + t], H[k][t], 1e-13);
    }
    full += c.patches.full[n];
    EXPECT_TRUE(!marked[n] || std::equal(some.at(n), some.at(n) + 6 * num_terms, c.field.at(n)));
    EXPECT_EQ(some_patches.begin[n + 1] - some_patches.begin[n], marked[n] ? num_cells : 0);
  }
  EXPECT_GT(full, 20);
}

/// Polynomials that are made where they are asked for, one by one and many, against those of all nodes; the error
/// estimate from them against that from a field that stores all.
TEST(PlainReferences, InteriorFit) {
  const Case c;
  const int touched = c.cells.size() / 2;
  const Subset beside = nodes_beside_interior(c.mesh, CellLists(c.cells.size(), {touched}));
  const InteriorFit plain(c.mesh, c.u, false);
  std::vector<int> inside;
  for (int n = 0; n < c.mesh.num_nodes; ++n) {
    bool contact = false;
    for (int p = c.patches.begin[n]; p < c.patches.begin[n + 1]; ++p) contact |= c.patches.cells[p] == touched;
    EXPECT_EQ(beside.row(n) < 0, c.patches.full[n] && !contact);
    if (beside.row(n) >= 0) continue;
    inside.push_back(n);
    Coefficients a;
    plain.at(n, a.data());
    EXPECT_TRUE(std::equal(a.begin(), a.end(), c.field.at(n)));
  }
  ASSERT_GT(inside.size(), 20U);
  std::vector<Coefficients> all(inside.size());
  plain.at_all(inside, all.front().data());
  for (std::size_t i = 0; i < inside.size(); ++i)
    EXPECT_TRUE(std::equal(all[i].begin(), all[i].end(), c.field.at(inside[i])));
  Coefficients none;
  EXPECT_THROW(plain.at(beside.number(0), none.data()), std::logic_error);

  RecoveredField stored = restricted_field(c.field, beside);
  stored.interior = std::make_shared<InteriorFit>(plain);
  const Scales scales{0.5, 2};
  const EnergySums whole = estimate_error(c.mesh, scales, c.field, c.u, nullptr),
                   made = estimate_error(c.mesh, scales, stored, c.u, nullptr);
  EXPECT_EQ(whole.error, made.error);
  EXPECT_EQ(whole.error_of_cell, made.error_of_cell);
  const RecoveredField copy = restricted_field(stored, Subset(c.mesh.num_nodes));
  const double corner[3] = {1, -1, 1}, middle[3] = {0.2, -0.3, 0.7};
  for (int cell = 0; cell < c.cells.size(); ++cell)
    for (const double* xi : {corner, middle}) {
      Sym3 s, t;
      evaluate_recovered(c.mesh, stored, cell, xi, s.data());
      evaluate_recovered(c.mesh, c.field, cell, xi, t.data());
      EXPECT_EQ(s, t);
      evaluate_recovered(c.mesh, copy, cell, xi, t.data());
      EXPECT_EQ(s, t);
    }
}

TEST(PlainReferences, ErrorEstimate) {
  const Case c;
  const double nu = c.mesh.poisson_ratio(), factor = std::pow(c.mesh.h(0), 3) / 8 / c.mesh.modulus;
  const auto energy = [&](const double s[6]) {
    return s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - 2 * nu * (s[0] * s[1] + s[1] * s[2] + s[2] * s[0]) +
           2 * (1 + nu) * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
  };
  const auto exact = [](const Vec3& x) -> Sym3 {
    return (Sym3() << std::sin(x[0]), x[1], x[2] * x[0], 1, std::exp(x[1]), x[0]).finished();
  };
  const EnergySums polynomial = estimate_error(c.mesh, Scales{0.5, 2}, c.field, c.u, nullptr);
  const EnergySums sums = estimate_error(c.mesh, Scales{0.5, 2}, c.field, c.u, exact);
  const Mat3& R = c.cc.grid.rotation;
  double solution = 0, exact_error = 0, recovered_error = 0, error = 0;
  for (int e = 0; e < c.cells.size(); ++e) {
    double weights[125], corner[8][3], cell_error = 0;
    fitted_weights(c.moments(e), 5, weights);
    c.corner_displacements(e, corner);
    for (int q = 0; q < 125; ++q) {
      const double xi[3] = {Gauss5::point[q / 25], Gauss5::point[q / 5 % 5], Gauss5::point[q % 5]};
      const Index3& cell = c.cc.cells[e];
      const Vec3 x = c.cc.grid.to_global(Vec3(cell[0], cell[1], cell[2]) + 0.5 * Vec3(xi[0] + 1, xi[1] + 1, xi[2] + 1));
      const Sym3 t = voigt(R.transpose() * tensor(exact(x)) * R) / 2;
      double s[6], r[6], d[6], ds[6], dr[6];
      hex_stress(c.mesh.law, corner, mean_dilatation(c.mesh, e, corner), xi, s);
      evaluate_recovered(c.mesh, c.field, e, xi, r);
      for (int k = 0; k < 6; ++k) {
        s[k] *= c.mesh.stress_factor(e);
        d[k] = r[k] - s[k];
        ds[k] = t[k] - s[k];
        dr[k] = t[k] - r[k];
      }
      const double w = weights[q] * factor;
      cell_error += w * energy(d);
      solution += w * energy(s);
      exact_error += w * energy(ds);
      recovered_error += w * energy(dr);
    }
    error += cell_error;
    EXPECT_NEAR(polynomial.error_of_cell[e], std::max(cell_error, 0.0), 1e-12 * polynomial.error);
  }
  for (const EnergySums* both : {&polynomial, &sums}) {
    EXPECT_NEAR(both->error / error, 1, 1e-13);
    EXPECT_NEAR(both->solution / solution, 1, 1e-13);
  }
  EXPECT_NEAR(sums.exact_error / exact_error, 1, 1e-12);
  EXPECT_NEAR(sums.recovered_error / recovered_error, 1, 1e-12);
}

/// Free boundary everywhere and a body force: patches inside by hand, all others with the dense KKT matrix.
TEST(PlainReferences, ConstrainedPatchesAreInEquilibriumAndNearest) {
  const Case c;
  BoundaryData boundary;
  boundary.conditions.resize(1);
  boundary.condition_of_point.assign(c.cc.boundary.size(), 0);
  boundary.pair_of_point.assign(c.cc.boundary.size(), -1);
  boundary.body_force_at = [](const Vec3& x) { return Vec3(x[0], -1, x[1] * x[2]); };
  RecoveryBody body{
      &c.mesh, &c.patches, &boundary, {Subset(c.mesh.num_nodes), CoefficientView("constrained", c.mesh.num_nodes)}};
  Kokkos::deep_copy(body.field.values, c.field.values);
  const RecoveryCounts counts = recover_constrained(HostExec(), {body}, c.u, Scales{0.5, 2}, {}).counts;
  int inside = 0;
  for (int n = 0; n < c.mesh.num_nodes; ++n) {
    if (!c.patches.full[n]) continue;
    ++inside;
    const Index3& node = c.mesh.nodes[n];
    const Vec3 x = c.cc.grid.to_global(Vec3(node[0], node[1], node[2]));
    const Eigen::Vector3d value =
        -c.cc.grid.cell_size / 2 * (c.cc.grid.rotation.transpose() * boundary.body_force_at(x));
    Eigen::VectorXd a = Eigen::Map<const Eigen::VectorXd>(c.field.at(n), 24);
    MassMatrix mass = Eigen::Vector4d(8, 8. / 3, 8. / 3, 8. / 3).asDiagonal();
    constrain_fit_kkt({mass}, divergence_rows(), value, a);
    for (int i = 0; i < 24; ++i) EXPECT_NEAR(body.field.at(n)[i], a[i], 1e-12);
    Coefficients made;
    InteriorFit(c.mesh, c.u, true, divergence_at_nodes(c.mesh, boundary, 2)).at(n, made.data());
    EXPECT_TRUE(std::equal(made.begin(), made.end(), body.field.at(n)));
  }
  EXPECT_GE(counts.kinds[static_cast<int>(PatchKind::interior)], inside);
  EXPECT_GT(inside, 20);
}

/// The points of every group carry the first and second moments of its boundary points.
TEST(PlainReferences, ConstraintGroups) {
  const Case c;
  BoundaryData boundary;
  boundary.condition_of_point.assign(c.cc.boundary.size(), 0);
  boundary.pair_of_point.assign(c.cc.boundary.size(), -1);
  for (std::size_t p = 0; p < c.cc.boundary.size(); p += 2) boundary.condition_of_point[p] = 1;
  const BoundaryFacets facets(c.cc, boundary);
  int threes = 0;
  for (int n = 0; n < c.mesh.num_nodes; ++n) {
    const int* cells = c.patches.cells.data() + c.patches.begin[n];
    const int num_cells = c.patches.begin[n + 1] - c.patches.begin[n];
    for (const ConstraintGroup& group : facets.groups(cells, num_cells)) {
      double area = 0;
      Vec3 centroid = Vec3::Zero(), mean = Vec3::Zero();
      Mat3 second = Mat3::Zero(), of_points = Mat3::Zero();
      for (std::size_t p = 0; p < c.cc.boundary.size(); ++p) {
        if (c.cc.boundary.surface[p] != group.surface || boundary.condition_of_point[p] != group.condition ||
            std::find(cells, cells + num_cells, c.cc.boundary.cell[p]) == cells + num_cells)
          continue;
        const double w = c.cc.boundary.weight[p];
        const Vec3 x = c.cc.boundary.position[p];
        area += w;
        centroid += w * x;
        second += w * x * x.transpose();
      }
      centroid /= area;
      second = second / area - centroid * centroid.transpose();
      for (int i = 0; i < group.num_points; ++i) mean += group.position[i] / group.num_points;
      for (int i = 0; i < group.num_points; ++i)
        of_points += (group.position[i] - mean) * (group.position[i] - mean).transpose() / group.num_points;
      EXPECT_NEAR(group.area, area, 1e-13);
      EXPECT_LT((mean - centroid).norm(), 1e-12);
      if (group.num_points < 3) continue;
      ++threes;
      EXPECT_LT((of_points - second).norm(), 1e-12);
    }
  }
  EXPECT_GT(threes, 100);
}

/// Every patch of a shaft with 20 grooves in a cell has a bounded number of constraint points; they keep the area, and
/// the mean planes of the groups the force of a pressure (area times normal) of each patch up to the spread of the
/// normals in a group: less than 60 degrees, here 45 on both sides.
TEST(PlainReferences, GroupsOfRoughSurfacesAreBounded) {
  const TriangleSoup soup = test::prism_soup(test::star(800, 3, 2.9), {0, 0}, 4);
  const Solid solid = Solid::bounded_by(test::surface_of(soup)).transformed(Mat3::Identity(), {4.1, 4.2, 1.3});
  Grid grid;
  grid.num_cells = {8, 8, 8};
  const CutCells cells = make_cut_cells(solid, grid);
  BoundaryData boundary;
  boundary.condition_of_point.assign(cells.boundary.size(), 0);
  boundary.pair_of_point.assign(cells.boundary.size(), -1);
  const BoundaryFacets facets(cells, boundary);
  std::vector<double> area(cells.cells.size(), 0);
  for (std::size_t p = 0; p < cells.boundary.size(); ++p) area[cells.boundary.cell[p]] += cells.boundary.weight[p];
  for (int c = 0; c < static_cast<int>(cells.cells.size()); ++c) {
    double of_groups = 0;
    const std::vector<ConstraintGroup> groups = facets.groups(&c, 1, 2);
    EXPECT_LE(groups.size(), 16u);
    for (const ConstraintGroup& group : groups) of_groups += group.area;
    EXPECT_NEAR(of_groups, area[c], 1e-12);
  }
}

}  // namespace
}  // namespace cgcontact::test_plain_references
