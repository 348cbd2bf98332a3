/// Rigid motions set aside: displacements stay what they are, and nothing rigid is left in them.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/solve/floating/body_motion.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_body_motion {
namespace {

using Field = std::function<Vec3(int body, const Vec3& x)>;  ///< m, global axes

class RigidMotionsOfTurnedGrids : public testing::Test {
 protected:
  RigidMotionsOfTurnedGrids()
      : scene_(read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/scenes/patch_test.toml", {})), sim_(scene_) {
    sim_.set_up_grids();
    sim_.make_system();
    u_ = RealView("u", sim_.state.system.num_dofs());
  }

  /// Calls work(body, DoF, value in Scales::length and grid axes) for every component of a field.
  template <class Work>
  void for_each_dof(const Field& field, const Work& work) const {
    for (std::size_t b = 0; b < sim_.state.system.meshes.size(); ++b) {
      const BodyMesh& mesh = sim_.state.system.meshes[b];
      const Grid& grid = mesh.cut_cells->grid;
      for (int n = 0; n < mesh.num_nodes; ++n) {
        const Index3& g = mesh.nodes[n];
        const Vec3 value = grid.rotation.transpose() *
                           field(static_cast<int>(b), grid.to_global(Vec3(g[0], g[1], g[2]))) /
                           sim_.state.scales.length;
        for (int i = 0; i < 3; ++i) work(dof_of(mesh.first_node + n, i), value[i]);
      }
    }
  }
  void add(const Field& field) {
    for_each_dof(field, [&](int dof, double value) { u_(dof) += value; });
  }

  Scene scene_;
  Simulation sim_;
  RealView u_;
};

Vec3 rigid(int body, const Vec3& x) {
  return (body == 0 ? Vec3(0.3, -2, 1) : Vec3(0, 0, -300)) + Vec3(0.2, -0.1, body == 0 ? 0.4 : 0).cross(x);
}

/// Shear and a field of second order.
Vec3 deformation(int body, const Vec3& x) { return 1e-3 * Vec3(x[1], x[0], (body + 1) * x[2] * x[2]); }

/// Up to rounding of the largest displacement, 300 m here: 1e-13 of it.
constexpr double rounding = 3e-11;

TEST_F(RigidMotionsOfTurnedGrids, TakeRigidMotionsWhole) {
  BodyMotions motions(sim_.state.system.meshes, sim_.state.scales);
  add(rigid);
  motions.set_aside(ExecSpace(), u_);
  for (std::size_t i = 0; i < u_.extent(0); ++i) ASSERT_NEAR(u_(i), 0, rounding);
  for (int b = 0; b < 2; ++b)
    for (const Vec3& x : {Vec3(0, 0, 0), Vec3(1, -0.4, 0.7)})
      EXPECT_LT((motions.of_bodies()[b].at(x) - rigid(b, x)).norm(), rounding);
  EXPECT_GE(motions.largest_displacement(ExecSpace(), u_) * sim_.state.scales.length, 300);
  EXPECT_LT(motions.largest_displacement(ExecSpace(), u_) * sim_.state.scales.length, 301);
}

TEST_F(RigidMotionsOfTurnedGrids, KeepTheDisplacementsAndLeaveNothingRigidInThem) {
  BodyMotions motions(sim_.state.system.meshes, sim_.state.scales);
  add(rigid);
  add(deformation);
  motions.set_aside(ExecSpace(), u_);
  const Field all = [](int body, const Vec3& x) -> Vec3 { return rigid(body, x) + deformation(body, x); };
  const auto at_dof = [&](int dof) {
    const std::vector<BodyMesh>& meshes = sim_.state.system.meshes;
    const int node = node_of_dof(dof), b = node < meshes[1].first_node ? 0 : 1;
    const Grid& grid = meshes[b].cut_cells->grid;
    const Vec3 x = grid.to_global(meshes[b].node_position(node - meshes[b].first_node));
    return grid.rotation.col(component_of_dof(dof)).dot(motions.of_bodies()[b].at(x));
  };
  for_each_dof(all, [&](int dof, double value) {
    ASSERT_NEAR(u_(dof) + at_dof(dof) / sim_.state.scales.length, value, rounding / sim_.state.scales.length);
  });
  const BodyMotion before = motions.of_bodies()[1];
  motions.set_aside(ExecSpace(), u_);
  EXPECT_LT((motions.of_bodies()[1].at(Vec3(1, 1, 1)) - before.at(Vec3(1, 1, 1))).norm(), rounding);
}

/// What makes stiff bodies on soft ones exact: a small field added after the large motion is found to its own rounding,
/// not to that of the motion.
TEST_F(RigidMotionsOfTurnedGrids, LoseNothingOfWhatIsSmall) {
  BodyMotions motions(sim_.state.system.meshes, sim_.state.scales);
  add(rigid);
  motions.set_aside(ExecSpace(), u_);
  Kokkos::deep_copy(u_, 0.0);
  add(deformation);
  motions.set_aside(ExecSpace(), u_);
  double largest = 0;
  for (std::size_t i = 0; i < u_.extent(0); ++i) largest = std::max(largest, std::abs(u_(i)));
  BodyMotions alone(sim_.state.system.meshes, sim_.state.scales);
  RealView v("v", u_.extent(0));
  for_each_dof(deformation, [&](int dof, double value) { v(dof) = value; });
  alone.set_aside(ExecSpace(), v);
  for (std::size_t i = 0; i < u_.extent(0); ++i) ASSERT_NEAR(u_(i), v(i), 1e-14 * largest);
}

}  // namespace
}  // namespace cgcontact::test_body_motion
