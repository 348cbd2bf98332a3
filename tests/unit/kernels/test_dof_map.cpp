/// Numbering: constrained nodes; the step from free values to all values against its transpose. Ghost nodes:
/// unit/ranks.
#include <gtest/gtest.h>

#include <Tpetra_Core.hpp>
#include <Tpetra_Map.hpp>
#include <limits>
#include <map>
#include <stdexcept>

#include "core/base/errors/errors.hpp"
#include "kernels/mesh/dof_map.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test_dof_map {
namespace {

RealView copy_of(const RealView& x) {
  RealView y("y", x.extent(0));
  Kokkos::deep_copy(y, x);
  return y;
}

/// Nodes of a face of one large cell against 2 x 2 small ones: corners 0 to 3, then the hanging nodes, four in the
/// middle of the edges and one in the middle of the face. Positions in units of the large cell.
struct HangingFace {
  std::vector<std::array<double, 2>> position = {{0, 0},   {1, 0},   {0, 1},   {1, 1},    {0.5, 0},
                                                 {0, 0.5}, {1, 0.5}, {0.5, 1}, {0.5, 0.5}};
  std::vector<NodeConstraint> constraints = {{4, {{0, 0.5}, {1, 0.5}}},
                                             {5, {{0, 0.5}, {2, 0.5}}},
                                             {6, {{1, 0.5}, {3, 0.5}}},
                                             {7, {{2, 0.5}, {3, 0.5}}},
                                             {8, {{0, 0.25}, {1, 0.25}, {2, 0.25}, {3, 0.25}}}};
  static constexpr int num_nodes = 9;
};

void expect_adjoint(const DofMap& dofs, unsigned seed) {
  const RealView x = test::random_vector(dofs.num_dofs(), seed), y = test::random_vector(dofs.num_dofs(), seed + 1);
  const RealView Px = copy_of(x), Pty = copy_of(y);
  apply_constraints(ExecSpace(), dofs, Px);
  apply_constraints_transposed(ExecSpace(), dofs, Pty);
  EXPECT_NEAR(test::dot(Px, y), test::dot(x, Pty), 1e-14 * test::norm(Px) * test::norm(y));
}

TEST(Dofs, NodesAndComponentsThereAndBack) {
  for (const int node : {0, 1, 17})
    for (int i = 0; i < dofs_per_node; ++i) {
      EXPECT_EQ(node_of_dof(dof_of(node, i)), node);
      EXPECT_EQ(component_of_dof(dof_of(node, i)), i);
      EXPECT_EQ(dof_offset(node, i), static_cast<std::size_t>(dof_of(node, i)));
    }
  // An offset does not overflow where the number of a degree of freedom would.
  EXPECT_EQ(dof_offset(2'000'000'000, 2), 6'000'000'002u);
}

TEST(DofMap, OneRankOwnsAllNodes) {
  for (const int nodes : {0, 1, 7}) {
    const DofMap dofs(nodes);
    EXPECT_EQ(dofs.num_nodes(), nodes);
    EXPECT_EQ(dofs.num_dofs(), dofs_per_node * nodes);
    EXPECT_EQ(dofs.num_constrained_nodes(), 0);
    const auto comm = Tpetra::getDefaultComm();
    EXPECT_EQ(dofs.vector_map(comm)->getNodeNumElements(), static_cast<std::size_t>(dofs.num_dofs()));
    EXPECT_EQ(dofs.node_map(comm)->getNodeNumElements(), static_cast<std::size_t>(nodes));
    const RealView x = test::random_vector(dofs.num_dofs(), 1), y = copy_of(x);
    apply_constraints(ExecSpace(), dofs, y);
    apply_constraints_transposed(ExecSpace(), dofs, y);
    for (std::size_t i = 0; i < x.extent(0); ++i) EXPECT_EQ(x(i), y(i));
  }
}

TEST(DofMap, MoreNodesThanNumbersAreRefused) {
  EXPECT_NO_THROW(DofMap(std::numeric_limits<int>::max() / 3));
  EXPECT_THROW(DofMap(std::numeric_limits<int>::max() / 3 + 1LL), InputError);
}

TEST(DofMap, HangingNodesKeepLinearFunctions) {
  const HangingFace face;
  const DofMap dofs(HangingFace::num_nodes, face.constraints);
  EXPECT_EQ(dofs.num_constrained_nodes(), 5);
  RealView u("u", dofs.num_dofs());
  const auto value = [&](int n, int i) { return 0.3 + (1 + i) * face.position[n][0] - 0.7 * i * face.position[n][1]; };
  for (int n = 0; n < dofs.num_nodes(); ++n)
    for (int i = 0; i < dofs_per_node; ++i)
      u(dof_of(n, i)) = n < 4 ? value(n, i) : 1e3;  // what was there does not count
  apply_constraints(ExecSpace(), dofs, u);
  for (int n = 0; n < dofs.num_nodes(); ++n)
    for (int i = 0; i < dofs_per_node; ++i) EXPECT_NEAR(u(dof_of(n, i)), value(n, i), 1e-15 * 4) << n;
}

TEST(DofMap, ConstraintsAreAdjoint) {
  const HangingFace face;
  expect_adjoint(DofMap(HangingFace::num_nodes, face.constraints), 3);
  // Random ones: every third node hangs on one to five others, with any weights.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> weight(-2, 2);
  for (const int nodes : {2, 4, 31, 500}) {
    std::vector<NodeConstraint> constraints;
    for (int n = 0; n < nodes; ++n) {
      if (n % 3 != 1) continue;
      std::map<int, double> masters;
      for (int m = 0; m < 5; ++m)
        if (const int master = static_cast<int>(random() % nodes); master % 3 != 1) masters[master] = weight(random);
      if (masters.empty()) masters[0] = 1;
      constraints.push_back({n, {masters.begin(), masters.end()}});
    }
    expect_adjoint(DofMap(nodes, constraints), nodes);
  }
}

/// Nodes that equal one master of their own, or one that others depend on as well, or that are but one term of a sum;
/// with degrees of freedom that are zero.
TEST(DofMap, AcrossNodesAndZerosAreAdjoint) {
  const std::vector<NodeConstraint> constraints{
      {1, {{0, 1.0}}}, {3, {{2, 1.0}}}, {4, {{2, 0.5}, {5, 0.5}}}, {7, {{6, 1.0}, {8, 0.5}}}, {9, {{8, 1.0}}}};
  const DofMap dofs(10, constraints, {0, 3, 8, 11});
  EXPECT_EQ(dofs.across_nodes().extent(0), 1u);
  EXPECT_EQ(dofs.num_constrained_nodes(), 5);
  expect_adjoint(dofs, 4);
  const RealView x = test::random_vector(dofs.num_dofs(), 5), before = copy_of(x);
  apply_constraints(ExecSpace(), dofs, x);
  for (const int dof : {0, 3, 8, 11}) EXPECT_EQ(x(dof), 0);
  EXPECT_EQ(x(dof_of(1, 1)), before(dof_of(0, 1)));
  EXPECT_EQ(x(dof_of(7, 2)), before(dof_of(6, 2)) + 0.5 * before(dof_of(8, 2)));
  EXPECT_THROW(DofMap(2, {}, {6}), std::invalid_argument);
}

/// After the transpose nothing is left at constrained nodes, and the sum of forces is what it was.
TEST(DofMap, TransposeKeepsTheResultant) {
  const HangingFace face;
  const DofMap dofs(HangingFace::num_nodes, face.constraints);
  const RealView f = test::random_vector(dofs.num_dofs(), 8), g = copy_of(f);
  apply_constraints_transposed(ExecSpace(), dofs, g);
  for (int i = 0; i < dofs_per_node; ++i) {
    double before = 0, after = 0;
    for (int n = 0; n < dofs.num_nodes(); ++n) {
      before += f(dof_of(n, i));
      after += g(dof_of(n, i));
      if (n >= 4) {
        EXPECT_EQ(g(dof_of(n, i)), 0);
      }
    }
    EXPECT_NEAR(before, after, 1e-14);
  }
}

std::string message(const std::vector<NodeConstraint>& constraints) {
  try {
    DofMap(4, constraints);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(DofMap, BadConstraintsAreRefused) {
  EXPECT_EQ(message({{2, {{0, 1.0}}}}), "accepted");
  EXPECT_NE(message({{2, {{0, 1.0}}}, {3, {{2, 0.5}, {1, 0.5}}}}).find("constraint of node 3: master 2 is constrained"),
            std::string::npos);
  EXPECT_NE(message({{3, {{3, 1.0}}}}).find("master 3 is constrained itself"), std::string::npos);
  EXPECT_NE(message({{4, {{0, 1.0}}}}).find("there are nodes 0 to 3 only"), std::string::npos);
  EXPECT_NE(message({{-1, {{0, 1.0}}}}).find("there are nodes"), std::string::npos);
  EXPECT_NE(message({{2, {{4, 1.0}}}}).find("master 4 does not exist"), std::string::npos);
  EXPECT_NE(message({{2, {{0, 1.0}}}, {2, {{1, 1.0}}}}).find("has a constraint already"), std::string::npos);
  EXPECT_NE(message({{2, {}}}).find("no masters"), std::string::npos);
  EXPECT_NE(message({{2, {{0, 0.5}, {0, 0.5}}}}).find("master 0 comes twice"), std::string::npos);
  EXPECT_NE(message({{2, {{0, std::nan("")}}}}).find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace cgcontact::test_dof_map
