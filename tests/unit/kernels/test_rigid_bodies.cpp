/// Projections on the rigid motions of rigid bodies, and the linear system between them.
#include <gtest/gtest.h>

#include "kernels/reference/plain_operator.hpp"
#include "kernels/solver/linear_solver.hpp"
#include "kernels/solver/rigid_bodies.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test_rigid_bodies {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// An elastic ball and a rigid one with hanging nodes, both held at a few points; the rigid one's springs are its all.
struct TwoBalls {
  CutCells elastic, rigid;
  ElasticSystem system;

  TwoBalls()
      : elastic(test::cut(Solid::sphere({0.5, 0.5, 0.5}, 0.4, "ball"), test::odd_grid(6, 20))),
        rigid(test::cut_refined(Solid::sphere({0.5, 0.5, 0.5}, 0.4, "ball"), test::odd_grid(6, 50), {0.5, 0.5, 0.9},
                                0.5)) {
    system =
        make_elastic_system({&elastic, &rigid}, {Material{3.0, 0.3}, Material{infinite, 0}}, Scales{0.5, 2.0}, 0.01);
    for (int body = 0; body < 2; ++body) {
      const CutCells& cells = body == 0 ? elastic : rigid;
      std::vector<SupportTerm> terms;
      for (int k = 0; k < 7; ++k) {
        int cell = k * static_cast<int>(cells.cells.size()) / 7;
        while (cells.cut_of_active[cell] < 0) ++cell;
        terms.push_back({cell, Vec3(0.2, -0.1 * k, 0.3), Vec3(1 + k % 3, k - 2.5, 1 - k % 2).normalized(), 2.0 + k});
      }
      add_support_terms(system, body, terms);
    }
    set_group_rows(system, {});
  }
  int num_dofs() const { return system.num_dofs(); }
  /// A force (zero at constrained nodes) or a displacement.
  RealView random(unsigned seed, NodeValues kind) const {
    const RealView v = test::random_vector(num_dofs(), seed);
    const ExecSpace exec;
    if (kind == NodeValues::forces)
      apply_constraints_transposed(exec, system.dofs, v);
    else
      apply_constraints(exec, system.dofs, v);
    exec.fence();
    return v;
  }
  RealView projected(NodeValues kind, const RealView& v) const {
    const RealView copy("copy", v.size());
    Kokkos::deep_copy(copy, v);
    RigidBodies(ExecSpace(), system).project(kind, copy);
    return copy;
  }
  double product(const RealView& a, const RealView& b) const {
    double sum = 0;
    for (int i = 0; i < num_dofs(); ++i) sum += a(i) * b(i);
    return sum;
  }
};

/// Six unknowns for the rigid body, three for every free node of the other.
TEST(RigidBodies, HaveSixUnknowns) {
  const TwoBalls balls;
  ASSERT_FALSE(balls.system.constraints.empty()) << "no hanging nodes: the case proves little";
  EXPECT_EQ(balls.system.num_free_dofs(), balls.system.meshes[0].num_free_dofs() + 6);
}

/// P P = P on both kinds of vectors, and each is the other's transpose; the elastic body is left alone.
TEST(RigidBodies, ProjectionsAreProjections) {
  const TwoBalls balls;
  const RealView force = balls.random(1, NodeValues::forces), u = balls.random(2, NodeValues::displacements);
  const RealView Pf = balls.projected(NodeValues::forces, force), Pu = balls.projected(NodeValues::displacements, u);
  const RealView PPf = balls.projected(NodeValues::forces, Pf), PPu = balls.projected(NodeValues::displacements, Pu);
  const int first = dof_of(balls.system.meshes[1].first_node);
  for (int i = 0; i < balls.num_dofs(); ++i) {
    EXPECT_NEAR(PPf(i), Pf(i), 1e-13);
    EXPECT_NEAR(PPu(i), Pu(i), 1e-13);
    if (i >= first) continue;
    EXPECT_EQ(Pf(i), force(i));
    EXPECT_EQ(Pu(i), u(i));
  }
  EXPECT_NEAR(balls.product(Pf, u), balls.product(force, Pu), 1e-12 * std::sqrt(balls.num_dofs()));
}

/// A rigid motion passes, hanging nodes included.
TEST(RigidBodies, LeaveRigidMotions) {
  const TwoBalls balls;
  const RealView u = test::nodal_field(
      balls.system, [](const Vec3& x) { return Vec3(Vec3(0.1, -0.3, 0.2) + Vec3(0.5, 0.1, -0.2).cross(x)); });
  const RealView Pu = balls.projected(NodeValues::displacements, u);
  for (int i = 0; i < balls.num_dofs(); ++i) EXPECT_NEAR(Pu(i), u(i), 1e-13);
}

/// The solution moves the rigid body as one, and what is left over of the forces has neither resultant nor moment
/// there, and is zero elsewhere.
TEST(RigidBodies, AreSolvedFor) {
  const TwoBalls balls;
  const RealView b = balls.random(3, NodeValues::forces), x("x", balls.num_dofs());
  LinearSolver solver(ExecSpace(), balls.system, Preconditioner::multigrid);
  solver.update();
  const LinearSolveResult result = solver.solve(b, x, 1e-10, 200);
  EXPECT_TRUE(result.converged) << result.residual << " " << result.iterations;
  EXPECT_LE(result.iterations, 30);  // 15
  const RealView moved = balls.projected(NodeValues::displacements, x), left("left", balls.num_dofs());
  PlainOperator(balls.system).apply(ExecSpace(), x, left);
  double largest = 0;
  for (int i = 0; i < balls.num_dofs(); ++i) {
    left(i) = b(i) - left(i);
    largest = std::max(largest, std::abs(x(i)));
  }
  const RealView left_over = balls.projected(NodeValues::forces, left);
  for (int i = 0; i < balls.num_dofs(); ++i) {
    EXPECT_NEAR(moved(i), x(i), 1e-12 * largest);
    EXPECT_NEAR(left_over(i), 0, 1e-10);
  }
}

}  // namespace
}  // namespace cgcontact::test_rigid_bodies
