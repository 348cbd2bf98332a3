/// The fits before constraints against dense least squares: sums over the cells one by one with shifted moments.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "recovery/constrained/fit_kernels.hpp"
#include "recovery/patch/cells_in_box.hpp"
#include "recovery/patch/flat_lists.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/execution_spaces.hpp"

namespace cgcontact::test_fit_kernels {
namespace {

using namespace test;

/// The terms of Polynomial<2> at size x + d are this matrix times those at x.
QuadraticMass shift(double size, const Vec3& d) {
  QuadraticMass here, there;
  for (int i = 0; i < 10; ++i) {
    const Vec3 x = Vec3::Random(), y = size * x + d;
    Polynomial<2>::terms(x.data(), here.col(i).data());
    Polynomial<2>::terms(y.data(), there.col(i).data());
  }
  return here.transpose().partialPivLu().solve(there.transpose()).transpose();
}

/// What a fit must be.
struct Dense {
  Eigen::MatrixXd mass, a;  ///< a: term, component
  double misfit = 0;        ///< mean square
  double min_pivot = 0;     ///< of the mass, least fraction of its diagonal entry
};

/// A ball in cells of two sizes; patches of the cells within a box around some points; the stress of random
/// displacements.
class Case {
 public:
  CutCells cc =
      cut_refined(Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.4, "ball"), odd_grid(7, 0.3), Vec3(0.8, 0.6, 0.5), 0.5);
  ElasticSystem system = make_elastic_system({&cc}, {Material{3, 0.3}}, Scales{0.5, 2}, 0.01);
  const BodyMesh& mesh = system.meshes[0];
  PatchSet patches = make_patches(mesh);
  RealView u = random_vector(system.num_dofs(), 3);
  CellStress stress = stress_of_displacements(mesh, u);
  StressIntegrals integrals = integrate_stress(mesh, stress, Subset(static_cast<int>(cc.cells.size())));
  std::vector<int> node;
  std::vector<Vec3> centre;
  std::vector<double> unit;
  FlatLists<int> cells;

  /// Nodes with as many cells as a quadratic polynomial needs; the last patch is the smallest subcell above
  /// 1e-6, a thin one.
  Case() {
    std::vector<int> list;
    for (int n = 0; n < mesh.num_nodes; n += 7) {
      if (!mesh.is_free(n)) continue;
      list.clear();
      const Vec3 x = mesh.node_position(n), width = Vec3::Constant(2 * unit_of(mesh, n));
      each_cell_within(cc, x - width, x + width, [&](int cell) { list.push_back(cell); });
      std::sort(list.begin(), list.end());
      if (list.size() >= 30) add(n, list);
    }
    int thin = -1;
    for (int cell = 0; cell < static_cast<int>(cc.cells.size()); ++cell)
      if (cc.volume_fraction(cell) > 1e-6 && (thin < 0 || cc.volume_fraction(cell) < cc.volume_fraction(thin)))
        thin = cell;
    add(node.front(), {thin});
  }

  template <int degree>
  Dense dense(std::size_t patch) const {
    constexpr int terms = Polynomial<degree>::num_terms;
    QuadraticMass mass = QuadraticMass::Zero();
    Eigen::Matrix<double, 10, 6> right = Eigen::Matrix<double, 10, 6>::Zero();
    double square = 0;
    for (const int cell : cells[patch]) {
      const QuadraticMass own = quadratic_mass(integrals.moments[integrals.moments_of_row[cell]].data());
      const QuadraticMass s =
          shift(cc.size(cell) / unit[patch], (middle_of_cell(cc, cell) - centre[patch]) / unit[patch]);
      const CellPolynomial p = stress(cell);
      mass += s * own * s.transpose();
      right += s * own * p.transpose();
      square += (p * own * p.transpose()).trace();
    }
    Dense fit;
    fit.mass = mass.topLeftCorner<terms, terms>();
    fit.a = fit.mass.ldlt().solve(Eigen::MatrixXd(right.topRows<terms>()));
    const Eigen::MatrixXd factor = fit.mass.llt().matrixL();
    fit.min_pivot = (factor.diagonal().array().square() / fit.mass.diagonal().array()).minCoeff();
    fit.misfit = (square - fit.a.cwiseProduct(right.topRows<terms>()).sum()) / mass(0, 0);
    return fit;
  }

  FitCells<Kokkos::HostSpace> fit_cells() const { return host_arrays(centre, unit, cells); }

 private:
  void add(int n, const std::vector<int>& list) {
    node.push_back(n);
    centre.push_back(mesh.node_position(n));
    unit.push_back(unit_of(mesh, n));
    cells.add(list);
  }
};

/// A class of all patches but every third, in reverse order.
template <int degree, int bodies>
struct Class {
  std::vector<int> patch;
  ClassArrays<Kokkos::HostSpace, degree, bodies> arrays;

  explicit Class(std::size_t num_patches) {
    for (int i = static_cast<int>(num_patches) - 1; i >= 0; --i)
      if (i % 3 != 1 || i + 1 == static_cast<int>(num_patches)) patch.push_back(i);
    const std::size_t size = patch.size();
    arrays = {view_of<decltype(arrays.patch)>(patch), decltype(arrays.inputs)("inputs", size),
              decltype(arrays.regular)("regular", size), decltype(arrays.variance)("variance", size)};
  }
};

/// The fit of a body against the dense one; rounding of sums over some hundred cells times the condition of the mass
/// matrices, some 1e3.
template <int degree, int bodies>
void expect_fit(const FitInput<degree, bodies>& input, int b, double variance, const Dense& expected) {
  constexpr int T = Polynomial<degree>::num_terms;
  for (int i = 0, at = 0; i < T; ++i)
    for (int j = 0; j <= i; ++j, ++at)
      EXPECT_NEAR(input.mass[b][at], expected.mass(i, j), 1e-12 * expected.mass.cwiseAbs().maxCoeff());
  for (int k = 0; k < 6; ++k)
    for (int t = 0; t < T; ++t)
      EXPECT_NEAR(input.a[b][k][t], expected.a(t, k), 1e-10 * expected.a.cwiseAbs().maxCoeff());
  EXPECT_NEAR(variance, expected.misfit, 1e-10 * expected.misfit);
}

template <class Exec>
class FitKernels : public testing::Test {};
TYPED_TEST_SUITE(FitKernels, ExecutionSpaces);

template <int degree, class Exec>
void sums_are_dense_fits(const Exec& exec) {
  const Case c;
  const Class<degree, 2> all(c.node.size());
  std::vector<int> entries;  // every second one
  for (int k = 0; k < static_cast<int>(all.patch.size()); k += 2) entries.push_back(k);
  using Entries = SubsetArrays<Kokkos::HostSpace>;
  fit_sums(exec, host_arrays(c.mesh, c.integrals), c.fit_cells(),
           Entries{view_of<decltype(Entries::numbers)>(entries), {}, static_cast<int>(entries.size())}, 1, all.arrays);
  exec.fence();
  int num_fits = 0;
  for (std::size_t k = 0; k < all.patch.size(); ++k) {
    const auto patch = static_cast<std::size_t>(all.patch[k]);
    const bool thin = patch + 1 == c.node.size();
    const Dense expected = c.dense<degree>(patch);
    const bool regular = expected.min_pivot > (degree == 1 ? min_linear_pivot : min_quadratic_pivot);
    EXPECT_EQ(all.arrays.regular(k, 1) != 0, k % 2 == 0 && regular) << k;
    EXPECT_TRUE(!thin || regular == (degree == 1));
    EXPECT_EQ(all.arrays.regular(k, 0), 0);
    num_fits += all.arrays.regular(k, 1);
    if (all.arrays.regular(k, 1) && !thin) expect_fit(all.arrays.inputs(k), 1, all.arrays.variance(k, 1), expected);
  }
  EXPECT_GT(num_fits, 15);
}
TYPED_TEST(FitKernels, SumsLinear) { sums_are_dense_fits<1>(TypeParam()); }
TYPED_TEST(FitKernels, SumsQuadratic) { sums_are_dense_fits<2>(TypeParam()); }

/// Masses and variances of plain fits; what cells have no integrals leaves the variance unknown.
TYPED_TEST(FitKernels, PlainFits) {
  const TypeParam exec;
  Case c;
  const Class<1, 2> all(c.node.size());
  const CoefficientView values("values", c.mesh.num_nodes);
  for (std::size_t i = 0; i < c.node.size(); ++i) {
    const Dense fit = c.dense<1>(i);
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t) values(c.node[i], k, t) = fit.a(t, k);
  }
  std::vector<char> marked(c.cc.cells.size(), 1);
  const std::size_t missing = all.patch[3];
  marked[c.cells[missing][5]] = 0;
  const StressIntegrals some = integrate_stress(c.mesh, c.stress, Subset(marked));
  using Nodes = Kokkos::View<const int*, Kokkos::LayoutRight, Kokkos::HostSpace>;
  take_plain_fits(exec, host_arrays(c.mesh, c.patches), c.fit_cells(), view_of<Nodes>(c.node),
                  SubsetArrays<Kokkos::HostSpace>{}, values, all.arrays);
  find_plain_variances(exec, host_arrays(c.mesh, some), c.fit_cells(), all.arrays);
  exec.fence();
  int unknown = 0;
  for (std::size_t k = 0; k < all.patch.size(); ++k) {
    const auto patch = static_cast<std::size_t>(all.patch[k]);
    EXPECT_TRUE(all.arrays.regular(k, 0));
    if (c.node[patch] == c.node.back()) continue;  // two patches, the thin one too, share its value
    Dense expected = c.dense<1>(patch);
    const auto& list = c.cells[patch];
    const bool known = std::find(list.begin(), list.end(), c.cells[missing][5]) == list.end();
    if (!known) {
      EXPECT_EQ(all.arrays.variance(k, 0), 0);
      ++unknown;
      continue;
    }
    expect_fit(all.arrays.inputs(k), 0, all.arrays.variance(k, 0), expected);
  }
  EXPECT_GT(unknown, 0);
}

/// The inverse variance, at most the given factor either way; nothing where a variance is not known.
TYPED_TEST(FitKernels, Weights) {
  const TypeParam exec;
  const Class<1, 2> all(7);
  const double variances[][2] = {{1, 4}, {1e9, 1}, {1, 1e9}, {0, 1}, {2, 0}}, weights[] = {0.25, 100, 0.01, 1, 1};
  ASSERT_EQ(all.patch.size(), 5u);
  for (int k = 0; k < 5; ++k) {
    for (int b = 0; b < 2; ++b) {
      all.arrays.variance(k, b) = variances[k][b];
      for (double& m : all.arrays.inputs(k).mass[b]) m = 3;
    }
  }
  weigh_auxiliary(exec, 100.0, all.arrays);
  exec.fence();
  for (int k = 0; k < 5; ++k)
    for (int i = 0; i < Polynomial<1>::num_packed; ++i) {
      EXPECT_EQ(all.arrays.inputs(k).mass[0][i], 3);
      EXPECT_EQ(all.arrays.inputs(k).mass[1][i], 3 * weights[k]);
    }
}

}  // namespace
}  // namespace cgcontact::test_fit_kernels
