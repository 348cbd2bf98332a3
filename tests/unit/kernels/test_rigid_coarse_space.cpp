/// The coarse space of rigid motions: exact in what it is made for, absent where supports hold.
#include <gtest/gtest.h>

#include <algorithm>

#include "kernels/reference/plain_operator.hpp"
#include "kernels/solver/rigid_coarse_space.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test_rigid_coarse_space {
namespace {

/// A ball that soft springs at six points and three contact groups hold.
struct LooseBall {
  CutCells cells;
  ElasticSystem system;

  explicit LooseBall(double spring)
      : cells(test::cut(Solid::sphere({0.5, 0.5, 0.5}, 0.4, "ball"), test::odd_grid(8, 20))) {
    system = make_elastic_system({&cells}, {Material{3.0, 0.3}}, Scales{0.5, 2.0}, 0.01);
    std::vector<SupportTerm> terms;
    std::vector<GroupRow> rows;
    const int count = static_cast<int>(cells.cells.size());
    for (int k = 0; k < 6; ++k) {
      const Vec3 direction = Vec3(1 + k % 3, k - 2.5, 1 - k % 2).normalized();
      terms.push_back({cut_cell(k * count / 6), Vec3(0.2, -0.1 * k, 0.3), direction, spring, false, true});
    }
    add_support_terms(system, 0, terms);
    for (int k = 0; k < 3; ++k) {
      GroupRow row;
      displacement_row(system.meshes[0].cell_nodes[k * count / 3 + 5], Vec3(0.1, 0.2, -0.4),
                       Vec3(k == 0, k == 1, k == 2),
                       [&](int dof, double value) { row.entries.emplace_back(dof, value); });
      std::sort(row.entries.begin(), row.entries.end());
      rows.push_back(row);
    }
    set_group_rows(system, rows);
    set_group_stiffness(system, {2.0, 0.0, 5.0});
  }

  int cut_cell(int from) const {
    while (cells.cut_of_active[from] < 0) ++from;
    return from;
  }

  /// Force and moment of nodal forces, cells.
  std::pair<Vec3, Vec3> resultant(const RealView& r) const {
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    const BodyMesh& mesh = system.meshes[0];
    for (int n = 0; n < mesh.num_nodes; ++n) {
      const Vec3 f(r(3 * n), r(3 * n + 1), r(3 * n + 2));
      force += f;
      moment += mesh.node_position(n).cross(f);
    }
    return {force, moment};
  }
};

/// What is left over after the correction has no force and no moment, but for rounding: stiffness times motions that
/// soft springs make large, at positions of up to 9.
TEST(RigidCoarseSpace, LeavesNoForceAndNoMoment) {
  const LooseBall ball(1e-4);
  RigidCoarseSpace space(ExecSpace(), ball.system);
  ASSERT_FALSE(space.empty());
  space.update();
  const int n = ball.system.num_dofs();
  const RealView r = test::random_vector(n, 3), z = test::random_vector(n, 4), left("left", n);
  const auto left_over = [&] {
    PlainOperator(ball.system).apply(ExecSpace(), z, left);
    for (int i = 0; i < n; ++i) left(i) = r(i) - left(i);
    return ball.resultant(left);
  };
  EXPECT_GT(left_over().first.norm(), 0.1);
  space.correct(r, z);
  const auto [force, moment] = left_over();
  double largest = 0;
  for (int i = 0; i < n; ++i) largest = std::max(largest, std::abs(z(i)));
  EXPECT_LT(force.norm(), 1e-13 * largest);
  EXPECT_LT(moment.norm(), 9 * 1e-13 * largest);
}

/// Supports hold a body as long as they are not much softer than it is.
TEST(RigidCoarseSpace, IsEmptyWhereSupportsHold) {
  EXPECT_TRUE(RigidCoarseSpace(ExecSpace(), LooseBall(10).system).empty());
}

}  // namespace
}  // namespace cgcontact::test_rigid_coarse_space
