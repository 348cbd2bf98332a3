/// The fast operator against its plain reference (apply.hpp) on bodies that fit the grid, do not, are thin, have holes,
/// or are random sets of cells.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "kernels/operator/fast_operator.hpp"
#include "kernels/reference/plain_operator.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test_fast_operator {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

/// A vector between NaNs: what is read or written outside of it shows.
template <class Real>
struct Guarded {
  static constexpr int margin = 40;
  Kokkos::View<Real*, MemSpace> all, inner;
  explicit Guarded(int size)
      : all("all", size + 2 * margin), inner(Kokkos::subview(all, std::make_pair(margin, margin + size))) {
    Kokkos::deep_copy(all, static_cast<Real>(nan_value));
  }
  bool untouched() const {
    for (int i = 0; i < margin; ++i)
      if (!std::isnan(all(i)) || !std::isnan(all(all.extent(0) - 1 - i))) return false;
    return true;
  }
};

template <class Real>
void expect_equal(const Kokkos::View<Real*, MemSpace>& fast, const RealView& plain, const std::string& what,
                  double factor = 1) {
  double difference = 0, scale = 0;
  for (std::size_t i = 0; i < plain.extent(0); ++i) {
    difference = std::max(difference, std::abs(static_cast<double>(fast(i)) - plain(i)));
    if (std::isnan(fast(i))) difference = std::numeric_limits<double>::infinity();
    scale = std::max(scale, std::abs(plain(i)));
  }
  EXPECT_LT(difference, factor * (sizeof(Real) == 8 ? 1e-13 : 1e-6) * scale) << what;
}

template <class Real>
void compare(const ElasticSystem& system, const std::string& what) {
  const ExecSpace exec;
  const int n = system.num_dofs();
  const FastOperator<Real> fast(system);
  // Values that float holds exactly: both see the same vector.
  const RealView x = test::random_vector(n, 1), b = test::random_vector(n, 2);
  Guarded<Real> xf(n), bf(n), yf(n), rf(n);
  for (int i = 0; i < n; ++i) {
    xf.inner(i) = static_cast<Real>(x(i) = static_cast<float>(x(i)));
    bf.inner(i) = static_cast<Real>(b(i) = static_cast<float>(b(i)));
  }
  RealView y("y", n), r("r", n);
  const PlainOperator plain(system);
  plain.apply(exec, x, y);
  for (int i = 0; i < n; ++i) r(i) = b(i) - y(i);
  fast.apply(exec, xf.inner, yf.inner);
  fast.residual(exec, bf.inner, xf.inner, rf.inner);
  expect_equal<Real>(yf.inner, y, what + ": apply");
  expect_equal<Real>(rf.inner, r, what + ": residual");
  fast.residual(exec, bf.inner, xf.inner, bf.inner);
  for (int i = 0; i < n; ++i) ASSERT_EQ(bf.inner(i), rf.inner(i)) << what << ": residual in place";
  EXPECT_TRUE(yf.untouched() && rf.untouched() && bf.untouched()) << what;

  typename FastOperator<Real>::BlockView blocks("blocks", system.num_nodes);
  fast.diagonal_blocks(exec, blocks);
  // Unit vectors of one node of every 3 x 3 x 3: the operator reaches two nodes far.
  if (system.groups.stiffness.extent(0) > 0) return;
  RealView expected("expected", 6 * system.num_nodes);
  Kokkos::View<Real*, MemSpace> found("found", 6 * system.num_nodes);
  for (int colour = 0; colour < 27; ++colour)
    for (int j = 0; j < 3; ++j) {
      RealView e("e", n), Ae("Ae", n);
      auto own = [&](const Index3& c) { return c[0] % 3 + 3 * (c[1] % 3) + 9 * (c[2] % 3) == colour; };
      for (const BodyMesh& mesh : system.meshes)
        for (int a = 0; a < mesh.num_nodes; ++a)
          if (own(mesh.nodes[a])) e(dof_of(mesh.first_node + a, j)) = 1;
      plain.apply(exec, e, Ae);
      for (const BodyMesh& mesh : system.meshes)
        for (int a = 0; a < mesh.num_nodes; ++a)
          if (own(mesh.nodes[a])) {
            const int node = mesh.first_node + a;
            expected(6 * node + j) = Ae(dof_of(node, j));
            expected(6 * node + 3 + j) = Ae(dof_of(node, (j + 1) % 3));
          }
    }
  for (int a = 0; a < system.num_nodes; ++a)
    for (int p = 0; p < 6; ++p) found(6 * a + p) = blocks(a, p);
  expect_equal<Real>(found, expected, what + ": blocks", 3);  // unit vectors: no errors that average out
}

/// Blocks between different nodes of a column against the plain operator on unit vectors.
template <class Real>
int compare_columns(const ElasticSystem& system, const std::string& what) {
  const ExecSpace exec;
  const FastOperator<Real> fast(system);
  const PlainOperator plain(system);
  typename FastOperator<Real>::BlockView blocks("blocks", system.num_nodes);
  const NodeColumns<Real> columns = make_node_columns<Real>(system);
  fast.diagonal_blocks(exec, blocks, columns);
  const int step = 1 + columns.num_columns() / 40;
  double scale = 0, difference = 0;
  for (int c = 0; c < columns.num_columns(); c += step) {
    const auto& column = columns.columns(c);
    const int n = dof_of(column.size);
    for (int j = 0; j < n; ++j) {
      RealView e("e", system.num_dofs()), Ae("Ae", system.num_dofs());
      e(dof_of(columns.nodes(column.first + node_of_dof(j)), component_of_dof(j))) = 1;
      plain.apply(exec, e, Ae);
      for (int i = 0; i < n; ++i) {
        const double expected = Ae(dof_of(columns.nodes(column.first + node_of_dof(i)), component_of_dof(i)));
        scale = std::max(scale, std::abs(expected));
        if (i / 3 == j / 3) continue;
        difference = std::max(difference, std::abs(columns.matrices(column.matrix + i * n + j) - expected));
      }
    }
  }
  EXPECT_LE(difference, 3 * (sizeof(Real) == 8 ? 1e-13 : 1e-6) * scale) << what << ": columns";
  return columns.num_columns();
}

/// Plates of one to four layers of nodes, cut or not, across each axis, with ghost penalty and with supports.
TEST(FastOperator, BlocksOfColumns) {
  for (int axis = 0; axis < 3; ++axis)
    for (double thickness : {0.05, 0.8, 1.0, 1.7, 2.6})
      for (double offset : {0.0, 0.1, 0.9}) {
        Grid grid;
        grid.num_cells = {9, 9, 9};
        grid.num_cells[axis] = 4;
        Vec3 low = Vec3::Constant(0.6), high = Vec3(8.3, 8.4, 8.5);
        low[axis] = offset;
        high[axis] = offset + thickness;
        const CutCells cells = make_cut_cells(Solid::box(low, high, "plate"), grid);
        ElasticSystem system = make_elastic_system({&cells}, {Material{2.0, 0.49}}, Scales{0.7, 3.0}, 0.02);
        const std::string what = fmt::format("axis {}, thickness {}, offset {}", axis, thickness, offset);
        const Vec3 direction = Vec3(1, 2, 3).normalized();
        for (int e : cells.active_of_cut) add_support_terms(system, 0, {{e, Vec3(0.1, -0.3, 0.2), direction, 0.7}});
        EXPECT_GT(compare_columns<double>(system, what), 0) << what;
        EXPECT_GT(compare_columns<float>(system, what), 0) << what;
      }
}

void compare_both(const ElasticSystem& system, const std::string& what) {
  compare<double>(system, what);
  compare<float>(system, what);
}

ElasticSystem make_system(const CutCells& cc, double gamma) {
  return make_elastic_system({&cc}, {Material{2.0, 0.47}}, Scales{0.7, 3.0}, gamma);
}

/// A box of whole cells, one layer of empty cells around it or not.
CutCells whole_cells(const Index3& size, int margin) {
  Grid grid;
  for (int d = 0; d < 3; ++d) grid.num_cells[d] = size[d] + 2 * margin;
  const Vec3 low = Vec3::Constant(margin), high = low + Vec3(size[0], size[1], size[2]);
  return make_cut_cells(Solid::box(low, high, "box"), grid);
}

/// Random cells of a grid; a share of them is cut, with moments that no geometry needs to have.
CutCells random_cells(const Index3& size, double active, double cut, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  CutCells cc;
  cc.grid.num_cells = size;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i) {
        if (uniform(generator) > active) continue;
        if (uniform(generator) < cut) {
          Moments m = full_cell_moments();
          for (double& v : m) v = 0.7 * v + 0.2 * uniform(generator);
          cc.cut_of_active.push_back(static_cast<int>(cc.moments.size()));
          cc.active_of_cut.push_back(static_cast<int>(cc.cells.size()));
          cc.moments.push_back(m);
        } else {
          cc.cut_of_active.push_back(-1);
        }
        cc.cells.push_back({i, j, k});
      }
  cc.numbers = GridNumbers(size, cc.cells);
  return cc;
}

TEST(FastOperator, CurvedAndTurnedBodies) {
  const Solid box = Solid::box(Vec3(0.1, 0.15, 0.2), Vec3(0.9, 0.8, 0.75), "box");
  const Solid ball = Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.4, "ball");
  for (int n : {3, 7, 12, 21}) {
    for (double angle : {0.0, 0.3}) {
      const CutCells cc = test::cut(box, test::odd_grid(n, angle));
      compare_both(make_system(cc, 0.01), "box " + std::to_string(n));
    }
    const CutCells cc = test::cut(ball, test::odd_grid(n, 0.7));
    compare_both(make_system(cc, 0.1), "ball " + std::to_string(n));
    compare_both(make_system(cc, 0.0), "ball without ghost penalty " + std::to_string(n));
  }
}

TEST(FastOperator, RowsOfAllLengths) {
  for (int n = 1; n <= 20; ++n) {
    const CutCells cc = whole_cells({n, 3, 4}, n % 2);
    compare_both(make_system(cc, 0.01), "row of " + std::to_string(n));
  }
}

TEST(FastOperator, CellsOnFacesThatFitTheGridCountAsFull) {
  const CutCells cc = whole_cells({6, 5, 4}, 1);
  EXPECT_EQ(cc.moments.size(), 120 - 4 * 3 * 2);
  const FastOperator<double> fast(make_system(cc, 0.01));
  EXPECT_EQ(fast.sizes().cut_cells, 0);
  EXPECT_EQ(fast.sizes().stencil_nodes, 5 * 4 * 3);
}

TEST(FastOperator, BodiesLongerThanATile) {
  for (const Index3& size : {Index3{150, 4, 3}, Index3{300, 3, 3}, Index3{3, 40, 5}, Index3{4, 5, 70}})
    compare_both(make_system(whole_cells(size, 0), 0.01), "bar");
}

TEST(FastOperator, BodiesOneCellThick) {
  for (const Index3& size : {Index3{1, 9, 11}, Index3{13, 1, 5}, Index3{6, 17, 1}, Index3{1, 1, 1}, Index3{1, 1, 9}})
    compare_both(make_system(whole_cells(size, 1), 0.01), "plate");
}

TEST(FastOperator, RandomCells) {
  for (unsigned seed = 0; seed < 4; ++seed)
    for (double active : {0.4, 0.9, 0.98, 1.0}) {
      const CutCells cc = random_cells({19, 14, 11}, active, seed % 2 ? 0.02 : 0.3, seed);
      compare_both(make_system(cc, 0.05), "random cells " + std::to_string(active));
    }
}

TEST(FastOperator, SupportsAndGroupsOfTwoBodies) {
  const Solid ball = Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.4, "ball");
  const CutCells first = test::cut(ball, test::odd_grid(9, 0.3)), second = test::cut(ball, test::odd_grid(6, 0.2));
  for (int with_groups = 0; with_groups < 2; ++with_groups) {
    ElasticSystem system =
        make_elastic_system({&first, &second}, {Material{2.0, 0.3}, Material{0.1, 0.45}}, Scales{0.5, 4.0}, 0.01);
    for (int b = 0; b < 2; ++b) {
      const BoundaryPoints& points = (b == 0 ? first : second).boundary;
      std::vector<SupportTerm> terms;
      for (std::size_t p = 0; p < points.size(); p += 3) {
        const Vec3 xi = Vec3(0.1 + 0.05 * (p % 7), -0.3, 0.9 - 0.1 * (p % 11));
        terms.push_back({points.cell[p], xi, p % 2 ? Vec3(Vec3::UnitZ()) : points.normal[p], 0.7 + 0.1 * (p % 5)});
      }
      add_support_terms(system, b, terms);
    }
    if (with_groups) {
      const int other = dof_of(system.meshes[1].first_node);
      set_group_rows(system, {{{{0, 0.5}, {1, -0.25}, {other + 2, 1.5}}}, {{{4, 0.5}, {5, 0.75}}}, {{{4, 1}}}});
      set_group_stiffness(system, {3.0, 0.0, 0.5});
    }
    compare_both(system, with_groups ? "with groups" : "with supports");
  }
}

/// What makes the result independent of the number of threads.
TEST(FastOperator, SlabsOfOneColourShareNoNode) {
  const Solid ball = Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.4, "ball");
  const CutCells first = test::cut(ball, test::odd_grid(19, 0.3)), second = whole_cells({5, 31, 3}, 1),
                 third = whole_cells({31, 2, 3}, 0);
  const Material material{1.0, 0.3};
  const ElasticSystem system = make_elastic_system({&first, &second, &third}, {material, material, material}, {}, 0.01);
  const SlabPartition slabs = make_slabs(system.level_meshes());
  EXPECT_GT(slabs.colour_of_slab.size(), 20u);
  std::vector<std::array<int, 2>> owner(system.num_nodes, {-1, -1});
  for (int b = 0; b < 3; ++b) {
    const BodyMesh& mesh = system.meshes[b];
    const CutCells& cc = *mesh.cut_cells;
    for (std::size_t e = 0; e < cc.cells.size(); ++e) {
      const int slab = slabs.slab_of(b, cc.cells[e]);
      auto touch = [&](const std::array<int, 8>& nodes) {
        for (int n : nodes) {
          int& own = owner[n][slabs.colour_of_slab[slab]];
          ASSERT_TRUE(own < 0 || own == slab);
          own = slab;
        }
      };
      touch(mesh.cell_nodes[e]);
      for (int d = 0; d < 3; ++d) {  // as if every face were a ghost face
        Index3 c = cc.cells[e];
        ++c[d];
        if (cc.find(c) >= 0) touch(mesh.cell_nodes[cc.find(c)]);
      }
    }
  }
}

TEST(FastOperator, GroupStiffnessCanBeChanged) {
  const CutCells cc = whole_cells({4, 4, 4}, 0);
  ElasticSystem system = make_system(cc, 0.01);
  set_group_rows(system, {{{{0, 0.5}, {1, -0.25}, {7, 1.5}}}, {{{4, 0.5}, {5, 0.75}}}});
  FastOperator<double> fast(system);
  set_group_stiffness(system, {2.0, 1.0});
  fast.set_groups(system);
  const RealView x = test::random_vector(system.num_dofs(), 1);
  RealView y("y", system.num_dofs()), z("z", system.num_dofs());
  PlainOperator(system).apply(ExecSpace(), x, y);
  fast.apply(ExecSpace(), x, z);
  expect_equal<double>(z, y, "groups");
}

/// The force of a row that depends on the gap of another: in double only, what preconditions stays symmetric.
TEST(FastOperator, CouplingOfRows) {
  const CutCells cc = whole_cells({4, 4, 4}, 0);
  ElasticSystem system = make_system(cc, 0.01);
  std::vector<GroupRow> rows{{{{0, 0.5}, {1, -0.25}, {7, 1.5}}}, {{{4, 0.5}, {5, 0.75}}}, {{{8, 1}}}};
  rows[1].coupled = 0;
  rows[2].coupled = 1;
  set_group_rows(system, rows);
  set_group_stiffness(system, {2.0, 1.0, 0.0});
  const RealView x = test::random_vector(system.num_dofs(), 1);
  const RealView without("without", system.num_dofs()), y("y", system.num_dofs()), z("z", system.num_dofs());
  PlainOperator(system).apply(ExecSpace(), x, without);
  set_group_coupling(system, {0.0, 3.0, -0.7});
  FastOperator<double> fast(system);
  fast.apply(ExecSpace(), x, z);
  PlainOperator(system).apply(ExecSpace(), x, y);
  expect_equal<double>(z, y, "coupled");
  // Only the DoFs of the rows that are coupled have forces more.
  const double gap[2] = {0.5 * x(0) - 0.25 * x(1) + 1.5 * x(7), 0.5 * x(4) + 0.75 * x(5)};
  const double more[3] = {3 * gap[0] * 0.5, 3 * gap[0] * 0.75, -0.7 * gap[1]};
  const int dof[3] = {4, 5, 8};
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(z(dof[i]) - without(dof[i]), more[i], 1e-13);
  const Kokkos::View<float*, MemSpace> xf("xf", system.num_dofs()), yf("yf", system.num_dofs());
  for (int i = 0; i < system.num_dofs(); ++i) xf(i) = static_cast<float>(x(i));
  FastOperator<float>(system).apply(ExecSpace(), xf, yf);
  expect_equal<float>(yf, without, "symmetric");
  set_group_coupling(system, {0.0, 0.0, 0.0});
  EXPECT_EQ(system.groups.coupling.extent(0), 0u) << "nothing to be unsymmetric";
}

}  // namespace
}  // namespace cgcontact::test_fast_operator
