/// Lagrange elements of degree 1 and 2: shape functions, interpolation at a point, and the plain operator of degree 2
/// on cut cells: exact for quadratic displacements, which the trilinear one is not.
#include <gtest/gtest.h>

#include "kernels/mesh/interpolate.hpp"
#include "kernels/reference/plain_operator.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test_elements {
namespace {

using test::dot;
using test::norm;

const std::array<double, 3> points[] = {{0, 0, 0}, {0.3, -0.7, 0.9}, {-1, 1, -1}, {1.2, 0.4, -1.1}};

/// A polynomial of degree `degree` per variable and its gradient, in cell units about the cell's centre.
template <int degree>
double polynomial(const double x[3], double gradient[3]) {
  double f[3], d[3];
  for (int i = 0; i < 3; ++i) {
    f[i] = 1 + (i + 1) * x[i] + (degree == 2 ? (2 - i) * x[i] * x[i] : 0);
    d[i] = (i + 1) + (degree == 2 ? 2 * (2 - i) * x[i] : 0);
  }
  gradient[0] = d[0] * f[1] * f[2];
  gradient[1] = f[0] * d[1] * f[2];
  gradient[2] = f[0] * f[1] * d[2];
  return f[0] * f[1] * f[2];
}

template <int degree>
void expect_shape_functions() {
  using Element = HexElement<degree>;
  const auto node = [](int a, double x[3]) {
    for (int d = 0; d < 3; ++d) x[d] = -1 + 2.0 * Element::index_along(a, d) / degree;
  };
  for (int a = 0; a < Element::num_nodes; ++a) {
    EXPECT_EQ(Element::node(Element::index_along(a, 0), Element::index_along(a, 1), Element::index_along(a, 2)), a);
    double x[3], N[Element::num_nodes];
    node(a, x);
    Element::shape(x, N);
    for (int b = 0; b < Element::num_nodes; ++b) EXPECT_EQ(N[b], a == b) << degree << ' ' << a << ' ' << b;
  }
  for (const auto& xi : points) {
    double N[Element::num_nodes], dN[Element::num_nodes][3], value = 0, slope[3] = {}, exact_slope[3], ignored[3];
    Element::shape(xi.data(), N);
    Element::gradient(xi.data(), dN);
    for (int a = 0; a < Element::num_nodes; ++a) {
      double x[3];
      node(a, x);
      for (double& c : x) c *= 0.5;
      const double u = polynomial<degree>(x, ignored);
      value += N[a] * u;
      for (int d = 0; d < 3; ++d) slope[d] += dN[a][d] * u;
    }
    const double x[3] = {0.5 * xi[0], 0.5 * xi[1], 0.5 * xi[2]};
    EXPECT_NEAR(value, polynomial<degree>(x, exact_slope), 1e-13);
    for (int d = 0; d < 3; ++d) EXPECT_NEAR(slope[d], exact_slope[d], 1e-13);
  }
}

TEST(Elements, ShapeFunctionsReproducePolynomials) {
  expect_shape_functions<1>();
  expect_shape_functions<2>();
}

/// A point of a cell from the nodal vector, and the row of a displacement as the transpose of the interpolation.
TEST(Elements, FieldAtAPoint) {
  const RealView u = test::random_vector(dof_of(12), 3);
  const std::array<int, 8> nodes = {3, 4, 7, 8, 1, 2, 10, 11};
  double corner[8][3];
  corner_values(nodes, u, corner);
  for (int a = 0; a < 8; ++a)
    for (int i = 0; i < 3; ++i) EXPECT_EQ(corner[a][i], u(dof_of(nodes[a], i)));
  for (const auto& point : points) {
    const Vec3 xi(point[0], point[1], point[2]), direction(0.3, -2, 0.7), start(5, 6, 7);
    const Vec3 value = interpolate(corner, xi);
    EXPECT_LT((interpolate(corner, xi, start) - start - value).norm(), 1e-14);
    double sum = 0;
    displacement_row(nodes, xi, direction, [&](int dof, double coefficient) { sum += coefficient * u(dof); });
    EXPECT_NEAR(sum, direction.dot(value), 1e-14);
    double g[3][3];
    interpolate_gradient(corner, point.data(), g);
    for (int j = 0; j < 3; ++j) {  // trilinear: differences along an axis are exact (two xi are one cell)
      const Vec3 difference = interpolate(corner, xi + Vec3::Unit(j)) - interpolate(corner, xi - Vec3::Unit(j));
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(g[i][j], difference[i], 1e-14);
    }
  }
}

/// Degree 1 of the template is the element of the system: the same nodes and the same product.
TEST(Elements, DegreeOneIsTheSystems) {
  const CutCells cc = test::cut(Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.4, "ball"), test::odd_grid(7, 0.4));
  const ElasticSystem system = make_elastic_system({&cc}, {Material{2.0, 0.3}}, Scales{1.0, 1.0}, 0.01);
  const PlainOperator<1> plain(system);
  EXPECT_EQ(plain.dofs().num_dofs(), system.num_dofs());
  EXPECT_EQ(plain.nodes(0).positions, system.meshes[0].nodes);
  EXPECT_EQ(plain.nodes(0).of_cell, system.meshes[0].cell_nodes);
}

/// u = linear + quadratic in global axes without body force: the divergence of its stress is zero for nu = 0.3.
struct QuadraticField {
  UnitElasticity law{0.3};
  /// (lambda + 2 mu) u_x,xx + mu (u_x,yy + u_x,zz) + (lambda + mu) (u_y,xy + u_z,xz) = 0 and cyclic.
  Vec3 operator()(const Vec3& x) const {
    const double c = (law.lambda + 2 * law.mu) / law.mu;
    return Vec3(0.1 * x[0] + 0.3 * x[1] + x[0] * x[0] - c * x[1] * x[1], 0.2 * x[2] + 0.7 * (x[2] * x[2] - x[0] * x[0]),
                -0.4 * x[1] + 0.5 * x[0] * x[1]);
  }
  Mat3 gradient(const Vec3& x) const {
    const double c = (law.lambda + 2 * law.mu) / law.mu;
    Mat3 g;
    g << 0.1 + 2 * x[0], 0.3 - 2 * c * x[1], 0,  //
        -1.4 * x[0], 0, 0.2 + 1.4 * x[2],        //
        0.5 * x[1], -0.4 + 0.5 * x[0], 0;
    return g;
  }
  double energy_density(const Vec3& x) const {
    const Mat3 e = 0.5 * (gradient(x) + gradient(x).transpose());
    return law.lambda * e.trace() * e.trace() + 2 * law.mu * e.squaredNorm();
  }
};

template <int degree>
RealView nodal_values(const PlainOperator<degree>& plain, const Grid& grid, const QuadraticField& field) {
  RealView u("u", plain.dofs().num_dofs());
  const auto& positions = plain.nodes(0).positions;
  for (std::size_t n = 0; n < positions.size(); ++n) {
    const Vec3 value = grid.rotation.transpose() *
                       field(grid.to_global(Vec3(positions[n][0], positions[n][1], positions[n][2]) / degree));
    for (int i = 0; i < 3; ++i) u(dof_of(static_cast<int>(n), i)) = value[i];
  }
  return u;
}

/// Energy of the interpolated field relative to the exact one, over a box that does not fit the grid.
template <int degree>
double energy_ratio(const ElasticSystem& system, const QuadraticField& field, const Vec3& low, const Vec3& high) {
  const PlainOperator<degree> plain(system);
  const RealView u = nodal_values(plain, system.meshes[0].cut_cells->grid, field);
  RealView Au("Au", u.extent(0));
  plain.apply(ExecSpace(), u, Au);
  double exact = 0;  // of degree 2 per variable
  for (int q = 0; q < 27; ++q) {
    Vec3 x;
    double w = 1;
    for (int d = 0, k = q; d < 3; ++d, k /= 3) {
      x[d] = 0.5 * (low[d] + high[d]) + 0.5 * (high[d] - low[d]) * Gauss3::point[k % 3];
      w *= 0.5 * (high[d] - low[d]) * Gauss3::weight[k % 3];
    }
    exact += w * field.energy_density(x);
  }
  return dot(u, Au) / exact;
}

TEST(QuadraticElements, EnergyOfAQuadraticFieldIsExact) {
  const Vec3 low(0.1, 0.15, 0.2), high(0.9, 0.8, 0.75);
  for (const double angle : {0.0, 0.3}) {
    const CutCells cc = test::cut(Solid::box(low, high, "box"), test::odd_grid(5, angle));
    for (const double gamma : {0.0, 0.1}) {
      const ElasticSystem system = make_elastic_system({&cc}, {Material{1.0, 0.3}}, Scales{1.0, 1.0}, gamma);
      EXPECT_NEAR(energy_ratio<2>(system, QuadraticField(), low, high), 1, 1e-12) << angle << ' ' << gamma;
      EXPECT_GT(std::abs(energy_ratio<1>(system, QuadraticField(), low, high) - 1), 1e-3);
    }
  }
}

/// Patch test (the trilinear stencil is exact at the nodes of such fields too, but not between them): the field is
/// given at all nodes of cut cells; the others find it by equilibrium alone.
template <int degree>
double patch_test_error(const ElasticSystem& system, const QuadraticField& field) {
  const PlainOperator<degree> plain(system);
  const CutCells& cc = *system.meshes[0].cut_cells;
  const RealView exact = nodal_values(plain, cc.grid, field);
  const std::size_t n = exact.extent(0);
  std::vector<char> given(n, 0);
  for (const int e : cc.active_of_cut)
    for (const int node : plain.nodes(0).of_cell[e])
      for (int i = 0; i < 3; ++i) given[dof_of(node, i)] = 1;
  EXPECT_GT(std::count(given.begin(), given.end(), 0), 300);
  RealView u("u", n), r("r", n), p("p", n), Ap("Ap", n);
  for (std::size_t i = 0; i < n; ++i) u(i) = given[i] ? exact(i) : 0.0;
  const auto apply = [&](const RealView& x, const RealView& y) {
    plain.apply(ExecSpace(), x, y);
    for (std::size_t i = 0; i < n; ++i)
      if (given[i]) y(i) = 0;
  };
  apply(u, r);
  for (std::size_t i = 0; i < n; ++i) p(i) = r(i) = -r(i);
  const double start = norm(r);
  double rr = dot(r, r);
  for (int k = 0; k < 2000 && std::sqrt(rr) > 1e-14 * start; ++k) {  // conjugate gradients
    apply(p, Ap);
    const double alpha = rr / dot(p, Ap);
    for (std::size_t i = 0; i < n; ++i) {
      u(i) += alpha * p(i);
      r(i) -= alpha * Ap(i);
    }
    const double next = dot(r, r);
    for (std::size_t i = 0; i < n; ++i) p(i) = r(i) + next / rr * p(i);
    rr = next;
  }
  for (std::size_t i = 0; i < n; ++i) u(i) -= exact(i);
  return norm(u) / norm(exact);
}

TEST(QuadraticElements, PatchTest) {
  const CutCells cc = test::cut(Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.45, "ball"), test::odd_grid(8, 0.3));
  const ElasticSystem system = make_elastic_system({&cc}, {Material{2.0, 0.3}}, Scales{1.0, 1.0}, 0.01);
  EXPECT_LT(patch_test_error<2>(system, QuadraticField()), 1e-12);
}

TEST(QuadraticElements, SymmetryRigidMotionsAndGhostPenalty) {
  const CutCells cc = test::cut(Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.4, "ball"), test::odd_grid(6, 0.7));
  ElasticSystem with = make_elastic_system({&cc}, {Material{2.0, 0.3}}, Scales{1.0, 1.0}, 1.0);
  const ElasticSystem without = make_elastic_system({&cc}, {Material{2.0, 0.3}}, Scales{1.0, 1.0}, 0.0);
  add_support_terms(with, 0, {{cc.active_of_cut[2], Vec3(0.3, -0.2, 0.6), Vec3(1, 2, 2) / 3, 0.7}});
  const PlainOperator<2> plain(with), bare(without);
  const int n = plain.dofs().num_dofs();
  const auto apply = [n](const PlainOperator<2>& A, const RealView& x) {
    RealView y("y", n);
    A.apply(ExecSpace(), x, y);
    return y;
  };
  const RealView x = test::random_vector(n, 1), y = test::random_vector(n, 2);
  const RealView Ax = apply(plain, x), Ay = apply(plain, y);
  EXPECT_NEAR(dot(Ax, y), dot(x, Ay), 1e-12 * norm(Ax) * norm(y));
  // A turn about z through node (0, 0, 0), grid axes.
  RealView turn("turn", n), cubic("cubic", n);
  const auto& positions = bare.nodes(0).positions;
  for (std::size_t m = 0; m < positions.size(); ++m) {
    turn(dof_of(static_cast<int>(m), 0)) = -0.5 * positions[m][1];
    turn(dof_of(static_cast<int>(m), 1)) = 0.5 * positions[m][0];
    cubic(dof_of(static_cast<int>(m), 0)) = std::pow(0.1 * positions[m][0], 3);
  }
  EXPECT_LT(norm(apply(bare, turn)), 1e-12 * norm(turn));
  // The penalty is zero on quadratic fields (EnergyOfAQuadraticFieldIsExact) and not on cubic ones.
  ElasticSystem penalised = make_elastic_system({&cc}, {Material{2.0, 0.3}}, Scales{1.0, 1.0}, 1.0);
  EXPECT_GT(dot(cubic, apply(PlainOperator<2>(penalised), cubic)), 1.0001 * dot(cubic, apply(bare, cubic)));
}

}  // namespace
}  // namespace cgcontact::test_elements
