/// Flexible CG as a solver manager of Belos, and the methods of its factory: the same solution by each, with both
/// preconditioners, and not a word on the terminal.
#include <gtest/gtest.h>

#include <BelosSolverFactory.hpp>
#include <Eigen/Dense>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>

#include "kernels/mesh/halo.hpp"
#include "kernels/multigrid/multigrid.hpp"
#include "kernels/solver/flexible_cg.hpp"
#include "kernels/solver/krylov.hpp"
#include "kernels/solver/linear_solver.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test_krylov {
namespace {

using Teuchos::RCP;
using Teuchos::rcp;
using Problem = Belos::LinearProblem<double, TpetraVector, TpetraOperator>;

/// A tridiagonal matrix with a varying diagonal, and 1 / diagonal as its preconditioner.
struct Chain {
  static constexpr int n = 60;
  RCP<const TpetraMap> map = rcp(new TpetraMap(n, 0, comm_of_this_rank()));
  RCP<Tpetra::CrsMatrix<double>> matrix, inverse_diagonal;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);

  /// sign: of the last entry of the diagonal.
  explicit Chain(double sign = 1) {
    for (int i = 0; i < n; ++i) {
      dense(i, i) = i + 1 < n ? 2 + 0.3 * i : sign * 7;
      if (i > 0) dense(i, i - 1) = dense(i - 1, i) = -1;
    }
    matrix = rcp(new Tpetra::CrsMatrix<double>(map, 3));
    inverse_diagonal = rcp(new Tpetra::CrsMatrix<double>(map, 1));
    for (int i = 0; i < n; ++i) {
      for (int j = std::max(0, i - 1); j < std::min(n, i + 2); ++j) {
        const Tpetra::Map<>::global_ordinal_type column = j;
        matrix->insertGlobalValues(i, 1, &dense(i, j), &column);
      }
      const Tpetra::Map<>::global_ordinal_type column = i;
      const double inverse = 1 / dense(i, i);
      inverse_diagonal->insertGlobalValues(i, 1, &inverse, &column);
    }
    matrix->fillComplete();
    inverse_diagonal->fillComplete();
  }

  RCP<TpetraVector> vectors(const Eigen::MatrixXd& values) const {
    const auto v = rcp(new TpetraVector(map, values.cols()));
    const auto view = v->getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < values.cols(); ++j) view(i, j) = values(i, j);
    return v;
  }
  static Eigen::MatrixXd values(const TpetraVector& v) {
    const auto view = v.getLocalViewHost(Tpetra::Access::ReadOnly);
    Eigen::MatrixXd values(n, v.getNumVectors());
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < values.cols(); ++j) values(i, j) = view(i, j);
    return values;
  }
  RCP<Problem> problem(const Eigen::MatrixXd& b, const Eigen::MatrixXd& x) const {
    const auto made = rcp(new Problem(matrix, vectors(x), vectors(b)));
    made->setRightPrec(inverse_diagonal);
    return made;
  }
};

RCP<Teuchos::ParameterList> parameters(double tolerance, int most) {
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  list->set("Maximum Iterations", most);
  return list;
}

Eigen::VectorXd some_vector(int seed) {
  const RealView random = test::random_vector(Chain::n, seed);
  return Eigen::Map<const Eigen::VectorXd>(random.data(), Chain::n);
}

/// Preconditioned CG as in every textbook.
Eigen::VectorXd plain_cg(const Chain& chain, const Eigen::VectorXd& b, Eigen::VectorXd x, int steps) {
  Eigen::VectorXd r = b - chain.dense * x, z = r.cwiseQuotient(chain.dense.diagonal()), p = z;
  for (int k = 0; k < steps; ++k) {
    const Eigen::VectorXd q = chain.dense * p;
    const double rz = r.dot(z), step = rz / p.dot(q);
    x += step * p;
    r -= step * q;
    z = r.cwiseQuotient(chain.dense.diagonal());
    p = z + r.dot(z) / rz * p;
  }
  return x;
}

TEST(FlexibleCg, TakesTheStepsOfPlainCgWhereThePreconditionerIsFixed) {
  const Chain chain;
  const Eigen::VectorXd b = some_vector(1), start = some_vector(2);
  for (const int steps : {1, 2, 5, 9}) {
    FlexibleCgSolMgr solver;
    solver.setParameters(parameters(1e-15, steps));
    const RCP<Problem> problem = chain.problem(b, start);
    problem->setProblem();
    solver.setProblem(problem);
    EXPECT_EQ(solver.solve(), Belos::Unconverged);
    EXPECT_EQ(solver.getNumIters(), steps);
    const Eigen::VectorXd expected = plain_cg(chain, b, start, steps);
    EXPECT_LT((Chain::values(*problem->getLHS()) - expected).norm(), 1e-12 * expected.norm()) << steps;
    const double residual = (b - chain.dense * expected).norm() / (b - chain.dense * start).norm();
    EXPECT_NEAR(solver.achievedTol(), residual, 1e-12);
  }
}

TEST(FlexibleCg, SolvesSeveralRightHandSidesOneAfterTheOther) {
  const Chain chain;
  Eigen::MatrixXd b(Chain::n, 3);
  b << some_vector(3), Eigen::VectorXd::Zero(Chain::n), some_vector(4);  // of a zero one there is nothing to do
  const RCP<Problem> problem = chain.problem(b, Eigen::MatrixXd::Zero(Chain::n, 3));
  problem->setProblem();
  FlexibleCgSolMgr solver;
  solver.setParameters(parameters(1e-10, 100));
  solver.setProblem(problem);
  EXPECT_EQ(solver.solve(), Belos::Converged);
  EXPECT_LE(solver.achievedTol(), 1e-10);
  const Eigen::MatrixXd x = Chain::values(*problem->getLHS());
  const Eigen::MatrixXd residual = b - chain.dense * x;
  EXPECT_LT(residual.col(0).norm(), 1.01e-10 * b.col(0).norm());
  EXPECT_EQ(x.col(1).norm(), 0);
  EXPECT_LT(residual.col(2).norm(), 1.01e-10 * b.col(2).norm());
}

TEST(FlexibleCg, EndsWhereTheOperatorIsNotPositiveDefinite) {
  const Chain chain(-1);
  const RCP<Problem> problem = chain.problem(some_vector(5), Eigen::VectorXd::Zero(Chain::n));
  problem->setProblem();
  FlexibleCgSolMgr solver;
  solver.setParameters(parameters(1e-14, 1000));
  solver.setProblem(problem);
  EXPECT_EQ(solver.solve(), Belos::Unconverged);
  EXPECT_LT(solver.getNumIters(), 1000);
}

TEST(FlexibleCg, HasParametersThatAreDocumentedAndChecked) {
  FlexibleCgSolMgr solver;
  const RCP<const Teuchos::ParameterList> valid = solver.getValidParameters();
  for (const char* name : {"Convergence Tolerance", "Maximum Iterations", "Verbosity", "Output Style",
                           "Output Frequency", "Output Stream", "Timer Label"}) {
    ASSERT_TRUE(valid->isParameter(name)) << name;
    EXPECT_FALSE(valid->getEntry(name).docString().empty()) << name;
  }
  solver.setParameters(parameters(1e-3, 7));
  solver.setParameters(Teuchos::parameterList());  // leaves all as it is
  EXPECT_EQ(solver.getCurrentParameters()->get<int>("Maximum Iterations"), 7);
  EXPECT_EQ(solver.getCurrentParameters()->get<double>("Convergence Tolerance"), 1e-3);
  const auto unknown = Teuchos::parameterList();
  unknown->set("Maximal Iterations", 3);
  EXPECT_THROW(solver.setParameters(unknown), Teuchos::Exceptions::InvalidParameterName);
  const auto wrong = Teuchos::parameterList();
  wrong->set("Maximum Iterations", 1.5);
  EXPECT_THROW(solver.setParameters(wrong), Teuchos::Exceptions::InvalidParameterType);
  EXPECT_THROW(solver.solve(), std::invalid_argument);  // no problem
}

TEST(FlexibleCg, PrintsWhatItIsAskedFor) {
  const Chain chain;
  const RCP<Problem> problem = chain.problem(some_vector(6), Eigen::VectorXd::Zero(Chain::n));
  problem->setProblem();
  const auto text = rcp(new std::ostringstream);
  const auto list = parameters(1e-8, 100);
  list->set("Output Stream", RCP<std::ostream>(text));
  list->set("Verbosity", Belos::Errors + Belos::StatusTestDetails + Belos::FinalSummary + Belos::TimingDetails);
  list->set("Output Frequency", 1);
  list->set("Output Style", static_cast<int>(Belos::General));
  FlexibleCgSolMgr solver;
  solver.setParameters(list);
  solver.setProblem(problem);
  EXPECT_EQ(solver.solve(), Belos::Converged);
  EXPECT_NE(text->str().find("Number of Iterations = 1 "), std::string::npos) << text->str();
  EXPECT_NE(text->str().find("Converged"), std::string::npos) << text->str();
  EXPECT_NE(text->str().find("FlexibleCgSolMgr total solve time"), std::string::npos) << text->str();
}

TEST(Krylov, TheFactoryKnowsEveryMethod) {
  register_flexible_cg();
  Belos::SolverFactory<double, TpetraVector, TpetraOperator> factory;
  for (const std::string& name : linear_method_names()) {
    EXPECT_TRUE(factory.isSupported(name)) << name;
    EXPECT_FALSE(factory.create(name, Teuchos::null).is_null()) << name;
  }
  EXPECT_FALSE(factory.isSupported("flexible gc"));
  EXPECT_NE(Teuchos::rcp_dynamic_cast<FlexibleCgSolMgr>(factory.create("Flexible CG", Teuchos::null)), Teuchos::null);
}

/// Two blocks side by side, the first held at its lower side, joined by contact groups: too large for one grid.
struct JoinedBlocks {
  CutCells cells[2];
  ElasticSystem system;

  explicit JoinedBlocks(int n) {
    for (int b = 0; b < 2; ++b)
      cells[b] = test::cut(Solid::box(Vec3(0.05, 0.1, 0), Vec3(0.9, 0.8, 1), "block"), test::odd_grid(n, 0.3 * b));
    system =
        make_elastic_system({&cells[0], &cells[1]}, {Material{1, 0.3}, Material{2, 0.2}}, Scales{1.0 / n, 1.0}, 0.01);
    for (int b = 0; b < 2; ++b) {
      std::vector<SupportTerm> terms;
      const BoundaryPoints& points = cells[b].boundary;
      for (std::size_t p = 0; p < points.size(); ++p) {
        if (cells[b].grid.to_global(points.position[p])[2] > 0.3) continue;
        const Index3& c = cells[b].cells[points.cell[p]];
        const Vec3 xi = 2 * (points.position[p] - Vec3(c[0], c[1], c[2])) - Vec3::Ones();
        for (int d = 0; d < 3; ++d)
          terms.push_back({points.cell[p], xi, Vec3::Unit(d), (b == 0 ? 10 : 0.01) * points.weight[p]});
      }
      add_support_terms(system, b, terms);
    }
    std::vector<GroupRow> rows;
    for (int g = 0; g < 20; ++g) {
      GroupRow row;
      for (int b = 0; b < 2; ++b) {
        const BodyMesh& mesh = system.meshes[b];
        const int cell = (g + 1) * static_cast<int>(mesh.cell_nodes.size()) / 22;
        for (const int node : mesh.cell_nodes[cell])
          row.entries.emplace_back(dof_of(node, g % 3), b == 0 ? 0.125 : -0.125);
        if (b == 0) row.cell = cell;
      }
      std::sort(row.entries.begin(), row.entries.end());
      rows.push_back(row);
    }
    set_group_rows(system, rows);
    system.full_group_stiffness.assign(rows.size(), 1.0);
    set_group_stiffness(system, std::vector<double>(rows.size(), 1.0));
  }
};

TEST(Krylov, EveryMethodFindsTheSameDisplacementsWithBothPreconditionersAndPrintsNothing) {
  const JoinedBlocks blocks(12);
  const int n = blocks.system.num_dofs();
  const RealView b = test::random_vector(n, 7);
  const double tolerance = 1e-11 * test::norm(b);
  RealView expected;
  for (const Preconditioner kind : {Preconditioner::multigrid, Preconditioner::muelu})
    for (std::size_t m = 0; m < linear_method_names().size(); ++m) {
      const LinearMethod method = static_cast<LinearMethod>(m);
      const std::string name = name_of(method) + ", " + name_of(kind);
      LinearSolver solver(ExecSpace(), blocks.system, kind, -1, method);
      solver.update();
      const RealView x("x", n);
      testing::internal::CaptureStdout();
      testing::internal::CaptureStderr();
      const LinearSolveResult result = solver.solve(b, x, tolerance, 300);
      EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "") << name;
      EXPECT_TRUE(result.converged) << name;
      std::printf("%-32s %d iterations\n", name.c_str(), result.iterations);
      if (expected.size() == 0) expected = x;
      RealView difference("difference", n);
      for (int i = 0; i < n; ++i) difference(i) = x(i) - expected(i);
      EXPECT_LT(test::norm(difference), 1e-7 * test::norm(expected)) << name;  // tolerance times the condition
    }
}

/// True relative residual that a method ends with, asked for 1e-9, preconditioned by a V-cycle or a K-cycle.
double residual_with_cycle(const ElasticSystem& system, LinearMethod method, int coarse_steps) {
  MultigridSettings settings;
  settings.coarse_steps = coarse_steps;
  const auto multigrid = rcp(new Multigrid(system, settings));
  const auto op = rcp(new ElasticityOperator(system, multigrid->getDomainMap()));
  const auto b = rcp(new TpetraVector(op->getDomainMap(), 1)), x = rcp(new TpetraVector(op->getDomainMap(), 1)),
             r = rcp(new TpetraVector(op->getDomainMap(), 1));
  const RealView random = test::random_vector(system.num_dofs(), 8);
  {
    const auto view = b->getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (int i = 0; i < system.num_dofs(); ++i) view(i, 0) = random(i);
  }
  const int iterations = solve_krylov(method, op, multigrid, b, x, 1e-9, 200);
  op->apply(*x, *r, Teuchos::NO_TRANS, 1, 0);
  r->update(1, *b, -1);
  const double residual = std::sqrt(ordered_product(*r, *r) / ordered_product(*b, *b));
  std::printf("%-14s %s-cycle: %3d iterations, residual %.1e\n", name_of(method).c_str(), coarse_steps ? "K" : "V",
              iterations, residual);
  return residual;
}

/// GMRES makes its solution of one sum of directions that it then preconditions: what a cycle in single precision lacks
/// of a linear map stays in it. LinearSolver sees the true residual and starts again; the flexible form keeps what the
/// cycle gave.
TEST(Krylov, FlexibleMethodsTakeTheKCycleAndAllTakeTheVCycle) {
  const JoinedBlocks blocks(16);
  for (std::size_t m = 0; m < linear_method_names().size(); ++m) {
    const LinearMethod method = static_cast<LinearMethod>(m);
    const bool sums_up = method == LinearMethod::gmres || method == LinearMethod::block_gmres;
    EXPECT_LT(residual_with_cycle(blocks.system, method, 0), sums_up ? 1e-3 : 1.1e-9) << name_of(method);
    const double with_k = residual_with_cycle(blocks.system, method, 3);
    if (!is_flexible(method)) continue;
    EXPECT_LT(with_k, 1.1e-9) << name_of(method);
  }
}

}  // namespace
}  // namespace cgcontact::test_krylov
