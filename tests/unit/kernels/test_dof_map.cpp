/// Numbering: owned, ghost and constrained nodes; every step from free values to local ones against its transpose.
#include <gtest/gtest.h>

#include <Tpetra_Core.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <limits>
#include <map>
#include <stdexcept>

#include "core/base/errors.hpp"
#include "kernels/mesh/dof_map.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact {
namespace {

using Vector = Tpetra::MultiVector<double>;

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
  std::vector<long long> numbers = {0, 1, 2, 3, 4, 5, 6, 7, 8};
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
    EXPECT_EQ(dofs.num_owned_dofs(), dofs.num_dofs());
    EXPECT_EQ(dofs.num_ghost_nodes() + dofs.num_constrained_nodes(), 0);
    const auto comm = Tpetra::getDefaultComm();
    EXPECT_EQ(dofs.owned_map(comm)->getNodeNumElements(), static_cast<std::size_t>(dofs.num_dofs()));
    EXPECT_EQ(dofs.owned_node_map(comm)->getNodeNumElements(), static_cast<std::size_t>(nodes));
    EXPECT_TRUE(dofs.local_map(comm)->isSameAs(*dofs.owned_map(comm)));
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
  const DofMap dofs(face.numbers, {}, face.constraints);
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
  expect_adjoint(DofMap(face.numbers, {}, face.constraints), 3);
  // Random ones: every third node hangs on one to five others, with any weights.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> weight(-2, 2);
  for (const int nodes : {2, 4, 31, 500}) {
    std::vector<NodeConstraint> constraints;
    std::vector<long long> numbers;
    for (int n = 0; n < nodes; ++n) {
      numbers.push_back(nodes - n);
      if (n % 3 != 1) continue;
      std::map<int, double> masters;
      for (int m = 0; m < 5; ++m)
        if (const int master = static_cast<int>(random() % nodes); master % 3 != 1) masters[master] = weight(random);
      if (masters.empty()) masters[0] = 1;
      constraints.push_back({n, {masters.begin(), masters.end()}});
    }
    expect_adjoint(DofMap(numbers, {}, constraints), nodes);
  }
}

/// Nodes that equal one master of their own, or one that others depend on as well, or that are but part of a sum; with
/// degrees of freedom that are zero.
TEST(DofMap, TwinsAndZerosAreAdjoint) {
  const std::vector<NodeConstraint> constraints{
      {1, {{0, 1.0}}}, {3, {{2, 1.0}}}, {4, {{2, 0.5}, {5, 0.5}}}, {7, {{6, 1.0}, {8, 0.5}}}, {9, {{8, 1.0}}}};
  const DofMap dofs(10, constraints, {0, 3, 8, 11});
  EXPECT_EQ(dofs.twins().extent(0), 1u);
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
  const DofMap dofs(face.numbers, {}, face.constraints);
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
    DofMap({0, 1, 2, 3}, {}, constraints);
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
  EXPECT_THROW(DofMap({0, 1, 1}, {}), std::invalid_argument);
  EXPECT_THROW(DofMap({0, -1}, {}), std::invalid_argument);
}

/// Ghosts as copies of owned nodes: ownership that overlaps, on one rank.
TEST(DofMap, ImportOfGhostsIsAdjoint) {
  const auto comm = Tpetra::getDefaultComm();
  const std::vector<long long> owned = {5, 3, 9, 0};
  for (const std::vector<long long>& ghosts : {std::vector<long long>{9, 5, 5}, std::vector<long long>{}}) {
    const DofMap dofs(owned, ghosts);
    const auto importer = dofs.importer(comm);
    Vector x(dofs.owned_map(comm), 1), Px(dofs.local_map(comm), 1), y(dofs.local_map(comm), 1),
        Pty(dofs.owned_map(comm), 1);
    x.randomize();
    y.randomize();
    Px.doImport(x, *importer, Tpetra::REPLACE);
    Pty.doExport(y, *importer, Tpetra::ADD_ASSIGN);  // into zero
    const auto from = x.getLocalViewHost(Tpetra::Access::ReadOnly), to = Px.getLocalViewHost(Tpetra::Access::ReadOnly),
               b = y.getLocalViewHost(Tpetra::Access::ReadOnly), a = Pty.getLocalViewHost(Tpetra::Access::ReadOnly);
    double left = 0, right = 0;
    for (int d = 0; d < dofs.num_dofs(); ++d) left += to(d, 0) * b(d, 0);
    for (int d = 0; d < dofs.num_owned_dofs(); ++d) right += from(d, 0) * a(d, 0);
    EXPECT_NEAR(left, right, 1e-14 * dofs.num_dofs());
    for (int n = 0; n < dofs.num_nodes(); ++n) {
      int owner = 0;
      while (owned[owner] != dofs.global_node(n)) ++owner;
      for (int i = 0; i < dofs_per_node; ++i) EXPECT_EQ(to(dof_of(n, i), 0), from(dof_of(owner, i), 0));
    }
  }
}

/// Three ranks on a row of elements of two sizes, played by arrays: each holds the nodes of its elements; a node
/// belongs to the lowest rank that has it; one node hangs, and its masters lie on other ranks.
TEST(DofMap, SeveralRanksAreAdjoint) {
  const std::vector<std::vector<long long>> owned = {{0, 1, 2}, {3, 4, 5}, {6, 7}}, ghosts = {{3}, {2, 6}, {3, 5, 4}};
  // Global node 4 = 0.25 of node 3 + 0.75 of node 6, known where node 4 is.
  const std::vector<std::vector<NodeConstraint>> constraints = {
      {}, {{1, {{0, 0.25}, {4, 0.75}}}}, {{4, {{2, 0.25}, {0, 0.75}}}}};
  const int global_nodes = 8;
  const RealView x = test::random_vector(dof_of(global_nodes), 1);
  RealView Pty("Pty", dof_of(global_nodes));
  double left = 0;
  for (std::size_t rank = 0; rank < owned.size(); ++rank) {
    const DofMap dofs(owned[rank], ghosts[rank], constraints[rank]);
    ASSERT_EQ(dofs.num_ghost_nodes(), static_cast<int>(ghosts[rank].size()));
    const auto each = [&](const auto& use) {
      for (int n = 0; n < dofs.num_nodes(); ++n)
        for (int i = 0; i < dofs_per_node; ++i) use(dof_of(n, i), dof_of(static_cast<int>(dofs.global_node(n)), i));
    };
    RealView local("local", dofs.num_dofs());
    each([&](int to, int from) { local(to) = x(from); });
    apply_constraints(ExecSpace(), dofs, local);
    const RealView y = test::random_vector(dofs.num_dofs(), 10 + static_cast<unsigned>(rank));
    left += test::dot(local, y);
    apply_constraints_transposed(ExecSpace(), dofs, y);
    each([&](int from, int to) { Pty(to) += y(from); });
  }
  EXPECT_NEAR(left, test::dot(x, Pty), 1e-13);
}

}  // namespace
}  // namespace cgcontact
