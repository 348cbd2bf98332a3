/// The matrix-free operator: symmetry, rigid motions, energy of linear fields, equality with the assembled matrix.
#include <gtest/gtest.h>

#include <Tpetra_Core.hpp>
#include <map>

#include "kernels/assembled/assembly.hpp"
#include "kernels/reference/plain_matrix.hpp"
#include "kernels/reference/plain_operator.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test_operator {
namespace {

using test::dot;
using test::norm;

constexpr double eps = 2.2e-16;

struct Case {
  const char* name;
  Solid solid;
  double volume;
  double angle;
};

std::vector<Case> cases() {
  const Solid box = Solid::box(Vec3(0.1, 0.15, 0.2), Vec3(0.9, 0.8, 0.75), "box");
  const Solid ball = Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.4, "ball");
  return {{"box", box, 0.8 * 0.65 * 0.55, 0.0},
          {"turned box", box, 0.8 * 0.65 * 0.55, 0.3},
          {"ball", ball, 4. / 3 * pi * 0.064, 0.7}};
}

ElasticSystem make_system(const CutCells& cc, double gamma) {
  return make_elastic_system({&cc}, {Material{2.0, 0.3}}, Scales{1.0, 1.0}, gamma);
}

RealView apply(const ElasticSystem& system, const RealView& x) {
  RealView y("y", system.num_dofs());
  PlainOperator(system).apply(ExecSpace(), x, y);
  return y;
}

TEST(Operator, IsSymmetric) {
  for (const Case& c : cases()) {
    const CutCells cc = test::cut(c.solid, test::odd_grid(7, c.angle));
    const ElasticSystem system = make_system(cc, 0.01);
    const RealView x = test::random_vector(system.num_dofs(), 1), y = test::random_vector(system.num_dofs(), 2);
    const RealView Ax = apply(system, x), Ay = apply(system, y);
    // Rounding of sums of some hundred products per entry.
    EXPECT_NEAR(dot(Ax, y), dot(x, Ay), 1000 * eps * norm(Ax) * norm(y)) << c.name;
  }
}

TEST(Operator, RigidMotionsCauseNoForce) {
  for (const Case& c : cases()) {
    const CutCells cc = test::cut(c.solid, test::odd_grid(7, c.angle));
    const ElasticSystem system = make_system(cc, 0.01);
    for (int m = 0; m < 6; ++m) {
      const RealView u = test::nodal_field(system, [m](const Vec3& x) -> Vec3 {
        return m < 3 ? Vec3(Vec3::Unit(m)) : Vec3(Vec3::Unit(m - 3).cross(x));
      });
      EXPECT_LT(norm(apply(system, u)), 1000 * eps * norm(u)) << c.name << " mode " << m;
    }
  }
}

TEST(Operator, EnergyOfALinearFieldIsExact) {
  for (const Case& c : cases()) {
    const CutCells cc = test::cut(c.solid, test::odd_grid(8, c.angle));
    const ElasticSystem system = make_system(cc, 0.01);
    Mat3 gradient;
    gradient << 0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.25, 0.15, -0.6;
    const RealView u = test::nodal_field(system, [&](const Vec3& x) -> Vec3 { return gradient * x; });
    const Mat3 strain = 0.5 * (gradient + gradient.transpose());
    const UnitElasticity law(0.3);
    const double density = law.lambda * std::pow(strain.trace(), 2) + 2 * law.mu * strain.squaredNorm();
    // The volume of a curved body is good to 1e-8 at this size, that of a box to rounding.
    EXPECT_NEAR(dot(u, apply(system, u)) / (2.0 * density * c.volume), 1, c.angle == 0.7 ? 1e-7 : 1e-12) << c.name;
  }
}

TEST(Operator, GhostPenaltyVanishesOnLinearFieldsOnly) {
  const CutCells cc = test::cut(cases()[2].solid, test::odd_grid(7, 0.7));
  const ElasticSystem with = make_system(cc, 1.0), without = make_system(cc, 0.0);
  Mat3 gradient;
  gradient << 0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.25, 0.15, -0.6;
  const RealView linear = test::nodal_field(with, [&](const Vec3& x) -> Vec3 { return gradient * x; });
  const double difference = dot(linear, apply(with, linear)) - dot(linear, apply(without, linear));
  EXPECT_NEAR(difference, 0, 1e-12);
  const RealView bent = test::nodal_field(with, [](const Vec3& x) -> Vec3 { return Vec3(x[0] * x[0], 0, 0); });
  EXPECT_GT(dot(bent, apply(with, bent)), 1.01 * dot(bent, apply(without, bent)));
}

TEST(Operator, AssembledMatrixEqualsMatrixFree) {
  for (const Case& c : cases()) {
    const CutCells first = test::cut(c.solid, test::odd_grid(7, c.angle));
    const CutCells second = test::cut(c.solid, test::odd_grid(5, 0.2));
    ElasticSystem system =
        make_elastic_system({&first, &second}, {Material{2.0, 0.3}, Material{0.1, 0.45}}, Scales{0.5, 4.0}, 0.01);
    add_support_terms(system, 0, {{first.boundary.cell[3], Vec3(0.1, -0.3, 0.6), Vec3(1, 2, 2) / 3, 0.7}});
    set_group_rows(system,
                   {{{{0, 0.5}, {1, -0.25}, {dof_of(system.meshes[1].first_node, 2), 1.5}}}, {{{4, 0.5}, {5, 0.75}}}});
    set_group_stiffness(system, {3.0, 0.0});
    const auto map = system.dofs.vector_map(Tpetra::getDefaultComm());
    const auto matrix = assemble_matrix(system, map);
    const ElasticityOperator op(system, map);
    TpetraVector x(map, 2), y(map, 2), z(map, 2);
    x.randomize();
    y.randomize();
    Tpetra::deep_copy(z, y);
    matrix->apply(x, y, Teuchos::NO_TRANS, 1.5, -0.5);
    op.apply(x, z, Teuchos::NO_TRANS, 1.5, -0.5);
    const double scale = z.getVector(0)->norm2();
    z.update(-1, y, 1);
    EXPECT_LT(z.getVector(0)->norm2(), 100 * eps * scale) << c.name;
    EXPECT_LT(z.getVector(1)->norm2(), 100 * eps * scale) << c.name;
  }
}

/// Every second cell is declared to be of the next level: half the size, half the stiffness, twice the stress.
TEST(Operator, SizeBelongsToTheCell) {
  const CutCells large = test::cut(cases()[2].solid, test::odd_grid(7, 0.7));
  CutCells mixed = large;
  mixed.grid.num_levels = 2;
  for (std::size_t e = 0; e < mixed.cells.size(); ++e) mixed.levels.push_back(e % 2);
  const ElasticSystem one = make_system(large, 0.0), two = make_system(mixed, 0.0);
  const CellMatrixView K = make_cell_matrices(one.meshes[0], {}), H = make_cell_matrices(two.meshes[0], {});
  for (int e = 0; e < static_cast<int>(large.cells.size()); ++e) {
    const double factor = e % 2 ? 0.5 : 1.0;
    EXPECT_EQ(mixed.h(e), factor * large.h(e));
    EXPECT_EQ(two.meshes[0].h(e), factor * one.meshes[0].h(e));
    EXPECT_EQ(two.meshes[0].stress_factor(e), one.meshes[0].stress_factor(e) / factor);
    const int m = 1 + large.cut_of_active[e];
    if (m == 0) continue;
    for (int r = 0; r < 24; ++r)
      for (int c = 0; c < 24; ++c) ASSERT_EQ(H(m, r, c), factor * K(m, r, c));
  }
  EXPECT_THROW(FastOperator<double>{two}, std::logic_error);
}

/// Bit for bit: every entry is the sum of the same numbers in the same order.
TEST(Operator, AssembledMatrixEqualsItsPlainReference) {
  const Case c = cases()[1];
  const CutCells first = test::cut(c.solid, test::odd_grid(7, c.angle));
  const CutCells second = test::cut(cases()[2].solid, test::odd_grid(5, 0.2));
  ElasticSystem system =
      make_elastic_system({&first, &second}, {Material{2.0, 0.3}, Material{0.1, 0.45}}, Scales{0.5, 4.0}, 0.01);
  add_support_terms(system, 0, {{first.boundary.cell[3], Vec3(0.1, -0.3, 0.6), Vec3(1, 2, 2) / 3, 0.7}});
  const int last = system.num_dofs() - 1, other = 3 * system.meshes[1].first_node;
  set_group_rows(system, {{{{0, 0.5}, {1, -0.25}, {other + 2, 1.5}}},
                          {{{4, 0.5}, {5, 0.75}, {last, 0.1}}},
                          {{{1, 0.3}, {other + 2, -0.7}, {last, 0.2}}}});
  set_group_stiffness(system, {3.0, 0.0, 0.7});
  BlockMatrix plain = plain_matrix(system);
  const auto matrix = assemble_matrix(system, system.dofs.vector_map(Tpetra::getDefaultComm()));
  const auto local = matrix->getLocalMatrixHost();
  ASSERT_EQ(local.numRows(), system.num_dofs());
  ASSERT_EQ(local.nnz(), plain.value.size());
  for (int row = 0; row < local.numRows(); ++row) {
    const auto begin = local.graph.row_map(row), end = local.graph.row_map(row + 1);
    for (auto k = begin; k < end; ++k) {
      const int column = local.graph.entries(k);
      if (k > begin) {
        EXPECT_LT(local.graph.entries(k - 1), column);
      }
      EXPECT_EQ(local.values(k), plain.block(row / 3, column / 3)[3 * (row % 3) + column % 3]) << row << ' ' << column;
    }
  }
}

/// Cut cells of the grid with cells of twice the size, moments summed from the children.
CutCells coarsen(const CutCells& fine) {
  CutCells coarse;
  coarse.solid = fine.solid;
  coarse.grid = fine.grid;
  coarse.grid.cell_size *= 2;
  for (int& n : coarse.grid.num_cells) n /= 2;
  for (int k = 0; k < coarse.grid.num_cells[2]; ++k)
    for (int j = 0; j < coarse.grid.num_cells[1]; ++j)
      for (int i = 0; i < coarse.grid.num_cells[0]; ++i) {
        std::array<const Moments*, 8> children{};
        bool active = false;
        for (int a = 0; a < 8; ++a) {
          const int e = fine.find({2 * i + (a & 1), 2 * j + (a >> 1 & 1), 2 * k + (a >> 2)});
          if (e < 0) continue;
          children[a] = fine.cut_of_active[e] < 0 ? &full_cell_moments() : &fine.moments[fine.cut_of_active[e]];
          active = true;
        }
        if (!active) continue;
        coarse.cut_of_active.push_back(static_cast<int>(coarse.moments.size()));
        coarse.active_of_cut.push_back(static_cast<int>(coarse.cells.size()));
        coarse.cells.push_back({i, j, k});
        coarse.moments.push_back(coarse_moments(children));
      }
  coarse.numbers = GridNumbers(coarse.grid.num_cells, coarse.cells);
  return coarse;
}

/// Trilinear interpolation from the coarse to the fine nodes.
RealView prolongate(const BodyMesh& coarse, const BodyMesh& fine, const RealView& x) {
  std::map<Index3, int> number;
  for (int n = 0; n < coarse.num_nodes; ++n) number[coarse.nodes[n]] = n;
  RealView y("y", dof_of(fine.num_nodes));
  for (int n = 0; n < fine.num_nodes; ++n)
    for (int a = 0; a < 8; ++a) {
      Index3 parent;
      double weight = 1;
      for (int d = 0; d < 3; ++d) {
        const int g = fine.nodes[n][d], upper = a >> d & 1;
        parent[d] = g / 2 + (g % 2 ? upper : 0);
        weight *= g % 2 ? 0.5 : (upper ? 0.0 : 1.0);
      }
      if (weight == 0) continue;
      for (int i = 0; i < 3; ++i) y(dof_of(n, i)) += weight * x(dof_of(number.at(parent), i));
    }
  return y;
}

/// x^T P^T K P y = x^T K_c y with K_c from the summed moments.
TEST(Operator, CoarseOperatorFromChildrensMomentsIsGalerkin) {
  for (const Case& c : cases()) {
    Grid grid = test::odd_grid(8, c.angle);
    for (int& n : grid.num_cells) n += n % 2;
    const CutCells fine = test::cut(c.solid, grid), coarse = coarsen(fine);
    const ElasticSystem A = make_system(fine, 0.0), B = make_system(coarse, 0.0);
    const RealView x = test::random_vector(B.num_dofs(), 3), y = test::random_vector(B.num_dofs(), 4);
    const RealView Px = prolongate(B.meshes[0], A.meshes[0], x), Py = prolongate(B.meshes[0], A.meshes[0], y);
    const RealView By = apply(B, y);
    EXPECT_NEAR(dot(Px, apply(A, Py)), dot(x, By), 1e-13 * norm(x) * norm(By)) << c.name;
  }
}

}  // namespace
}  // namespace cgcontact::test_operator
