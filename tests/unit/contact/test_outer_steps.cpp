/// Parts of one outer iteration, each by itself: the line search, the active set, the right-hand side, the stress that
/// is lagged.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "contact/adaptive/zone_sizes.hpp"
#include "contact/simulation.hpp"
#include "contact/solve/active_set.hpp"
#include "contact/solve/lagged_stress.hpp"
#include "contact/solve/line_search.hpp"
#include "contact/solve/right_hand_side.hpp"
#include "core/scene_file/read_scene.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test_outer_steps {
namespace {

/// Two blocks, 0.01 m apart, under a pressure of 1 GPa: not solved yet. The lower one is the primary body.
class TwoBlocks : public testing::Test {
 protected:
  TwoBlocks()
      : scene_(read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/tests/scenes/gap.toml", {})), simulation_(scene_) {
    simulation_.set_up_grids();
    simulation_.make_system();
  }

  SolvedState& state() { return simulation_.state; }
  ContactPair& pair() { return state().pairs[0]; }
  OuterProblem problem() {
    return {scene_, state().bodies, state().pairs, state().supports, state().system, state().scales, ExecSpace()};
  }
  /// Returns displacements given in m and global axes: use(body, x).
  template <class Field>
  RealView displacements(const Field& field) {
    RealView u("u", state().system.num_dofs());
    for (int b = 0; b < 2; ++b) {
      const BodyMesh& mesh = state().system.meshes[b];
      const Grid& grid = mesh.cut_cells->grid;
      for (int n = 0; n < mesh.num_nodes; ++n) {
        const Vec3 value = grid.rotation.transpose() * field(b, grid.to_global(mesh.node_position(n)));
        for (int i = 0; i < 3; ++i) u(dof_of(mesh.first_node + n, i)) = value[i] / state().scales.length;
      }
    }
    return u;
  }
  /// Sets the lagged pressure of every contact point, Pa.
  template <class Pressure>
  void lag(Iterate& iterate, const Pressure& pressure) {
    for (std::size_t q = 0; q < pair().points.size(); ++q)
      iterate.contact_stress.h_view(q) = pressure(q) / state().scales.stress;
    iterate.contact_stress.modify_host();
  }
  double stiffness(std::size_t point) { return pair().stiffness(pair().groups[pair().points.group(point)]); }

  Scene scene_;
  Simulation simulation_;
};

/// Slope of the energy along a step, by its definition: K and the closed points are quadratic about the end of the
/// step, each point adds what it presses less what it would if its state stayed.
struct SlopeAlongStep {
  double curvature;  ///< system units, with the closed points
  std::vector<double> weight, at_begin,
      change;                      ///< of each point: m^2; pressure that closed it has, Pa; along the step
  std::vector<double> gap_change;  ///< m, of its group along the step
  std::vector<char> closed;
  double unit;  ///< J

  double at(double t) const {
    double slope = -curvature * (1 - t);
    for (std::size_t q = 0; q < weight.size(); ++q) {
      const double p = at_begin[q] + t * change[q];
      slope -= weight[q] * (std::max(p, 0.0) - (closed[q] ? p : 0.0)) * gap_change[q] / unit;
    }
    return slope;
  }
  /// Returns the zero of the slope, which is straight between the positions at which points open or close.
  double zero() const {
    std::vector<double> breaks{0, 1};
    for (std::size_t q = 0; q < weight.size(); ++q)
      if (const double t = -at_begin[q] / change[q]; t > 0 && t < 1) breaks.push_back(t);
    std::sort(breaks.begin(), breaks.end());
    const auto end = std::find_if(breaks.begin() + 1, breaks.end(), [&](double t) { return at(t) > 0; });
    if (end == breaks.end()) return 1;
    const double low = *(end - 1), first = at(low), last = at(*end);
    return low - first * (*end - low) / (last - first);
  }
};

/// Points at random are taken for closed, with a random lagged pressure: they open and close all along the step, which
/// sets the upper block down by twice the gap. The search bisects 30 times.
TEST_F(TwoBlocks, LineSearchFindsTheLeastEnergyAmongAllBreaks) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  ContactPoints& points = pair().points;
  for (std::size_t q = 0; q < points.size(); ++q) points.set_active(q, uniform(random) > 0);
  Iterate now(problem());
  lag(now, [&](std::size_t q) { return 8e-3 * stiffness(q) * uniform(random); });
  set_group_stiffness(state().system, now.group_stiffness());
  LinearSolver solver(ExecSpace(), state().system, Preconditioner::multigrid);
  solver.update();
  const RealView before = displacements([](int, const Vec3& x) { return Vec3(0, 0, 1e-4 * x[0]); });
  const RealView after = displacements(
      [](int body, const Vec3& x) { return Vec3(1e-4 * x[1], 0, body == 1 ? -0.02 * (1 + 0.2 * x[0]) : 0); });
  const RealView step("step", after.size());
  for (std::size_t i = 0; i < step.size(); ++i) step(i) = after(i) - before(i);
  SlopeAlongStep slope;
  slope.curvature = solver.energy(step);
  slope.unit = now.force_unit() * state().scales.length;
  const RealView begin = now.gap_change_of(before), along = now.gap_change_of(step);
  int breaks = 0;
  for (std::size_t q = 0; q < points.size(); ++q) {
    const int g = points.group(q);
    const double k = stiffness(q), lagged = now.contact_stress.h_view(q) * state().scales.stress;
    slope.weight.push_back(points.weight(q));
    slope.at_begin.push_back(lagged - k * (pair().groups[g].initial_gap + begin(g)));
    slope.change.push_back(-k * along(g));
    slope.gap_change.push_back(along(g));
    slope.closed.push_back(points.active(q));
    breaks += slope.at_begin[q] < 0 && slope.at_begin[q] + slope.change[q] > 0;
  }
  ASSERT_GT(breaks, static_cast<int>(points.size() / 2));
  const double least = slope.zero();
  ASSERT_GT(least, 0.05);
  ASSERT_LT(least, 0.95);
  Kokkos::deep_copy(now.u, after);
  EXPECT_NEAR(search_along_step(solver, before, now), least, 2 * std::pow(0.5, 30));
  for (std::size_t i = 0; i < step.size(); ++i) ASSERT_NEAR(now.u(i), before(i) + least * step(i), 1e-8);
}

/// Where no point changes along the step it is taken whole.
TEST_F(TwoBlocks, LineSearchTakesAStepThatChangesNothingWhole) {
  Iterate now(problem());
  lag(now, [&](std::size_t q) { return 1.0 * stiffness(q); });
  set_group_stiffness(state().system, now.group_stiffness());
  LinearSolver solver(ExecSpace(), state().system, Preconditioner::multigrid);
  solver.update();
  const RealView before("before", now.u.size());
  const RealView after = displacements([](int body, const Vec3&) { return Vec3(0, 0, body == 1 ? -0.02 : 0); });
  Kokkos::deep_copy(now.u, after);
  EXPECT_EQ(search_along_step(solver, before, now), 1);
  for (std::size_t i = 0; i < after.size(); ++i) ASSERT_EQ(now.u(i), after(i));
}

/// The upper block sinks by the gap and turns about the middle of its face: contact is where that takes it down. With a
/// lagged pressure of k times 3 mm it is up to where the gap is 3 mm.
TEST_F(TwoBlocks, PointsCloseWhereTheyPress) {
  Iterate now(problem());
  now.body_motions.move(1, Vec3(0, 0, -0.01), Vec3(0, 0.01, 0), Vec3(0.5, 0.4, 0.61));
  for (const double gap : {0.0, 3e-3}) {
    lag(now, [&](std::size_t q) { return gap * stiffness(q); });
    now.set_rigid_motions_aside();
    close_pressing_points(now);
    long long closed = 0;
    for (const ContactGroup& group : pair().groups) {
      const double x = centre_of(pair(), group)[0], border = 0.5 - gap / 0.01;
      ASSERT_GT(std::abs(x - border), 1e-6) << "which side it lies on is rounding";
      EXPECT_EQ(is_closed(pair(), group), x > border) << x;
      closed += x > border ? group.last_point - group.first_point : 0;
    }
    EXPECT_EQ(count_active(state().pairs), closed);
  }
}

/// Nothing holds the upper block but contact: if that is open, the load drives it down, and nothing if it is closed.
TEST_F(TwoBlocks, LoadsDriveWhatOpenContactDoesNotHold) {
  EXPECT_TRUE(driven_motions(problem()).empty());
  for (std::size_t q = 0; q < pair().points.size(); ++q) pair().points.set_active(q, false);
  const FreeMotions driven = driven_motions(problem());
  ASSERT_EQ(driven.modes.cols(), 1);
  Eigen::VectorXd down = Eigen::VectorXd::Zero(12);
  down[8] = -1;
  EXPECT_LT((driven.modes.col(0) - down).norm(), 1e-9);
  Iterate now(problem());
  initialise_active_set(now);
  EXPECT_TRUE(driven_motions(problem()).empty()) << "points have closed to hold it";
}

/// The forces on both bodies: the load on the upper one, and closed contact, which pulls across its gap g with k g. The
/// scale of the linear tolerance is the load alone.
TEST_F(TwoBlocks, RightHandSideIsTheLoadAndThePullAcrossTheGap) {
  double pull = 0;
  for (const ContactGroup& group : pair().groups) pull += pair().stiffness(group) * group.area * group.initial_gap;
  Iterate now(problem());
  RightHandSide right(problem());
  const std::vector<double> load = make_load_vector(state().bodies, state().system, state().scales);
  double square = 0;
  for (const double f : load) square += f * f;
  const auto forces = [&] {
    right.begin(load, false);
    right.assemble(now);
    return force_of_body(state().bodies, state().system, state().scales, to_host(right.vector()));
  };
  const double weight = 1e9 * 0.8;
  std::vector<Vec3> sum = forces();
  EXPECT_LT((sum[0] - Vec3(0, 0, pull)).norm(), 1e-10 * pull);
  EXPECT_LT((sum[1] - Vec3(0, 0, -pull - weight)).norm(), 1e-10 * pull);
  EXPECT_NEAR(right.force_norm(), std::sqrt(square), 1e-12 * std::sqrt(square));
  EXPECT_FALSE(right.underflows());
  // A lagged pressure pushes instead.
  lag(now, [](std::size_t) { return 2e9; });
  sum = forces();
  EXPECT_LT((sum[0] - Vec3(0, 0, pull - 2e9 * 0.8)).norm(), 1e-10 * pull);
  EXPECT_LT((sum[1] - Vec3(0, 0, 2e9 * 0.8 - pull - weight)).norm(), 1e-10 * pull);
  for (std::size_t q = 0; q < pair().points.size(); ++q) pair().points.set_active(q, false);
  sum = forces();
  EXPECT_LT(sum[0].norm(), 1e-10 * weight);
  EXPECT_LT((sum[1] - Vec3(0, 0, -weight)).norm(), 1e-10 * weight);
}

/// A strain along z without any across it: sigma_z = (lambda + 2 mu) e, sigma_x = sigma_y = lambda e, which the
/// recovery has exactly. The first change is all of it, the second none.
TEST_F(TwoBlocks, LaggedStressIsThatOfTheDisplacements) {
  const double E = 200e9, nu = 0.3, e = -1e-3;
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu)), along = (lambda + 2 * mu) * e;
  Iterate now(problem());
  Kokkos::deep_copy(now.u, displacements([&](int, const Vec3& x) { return Vec3(0, 0, e * x[2]); }));
  LaggedStress stress(problem());
  EXPECT_NEAR(stress.update(now), 1, 1e-12);
  for (std::size_t q = 0; q < pair().points.size(); ++q)
    ASSERT_NEAR(now.contact_stress.h_view(q) * state().scales.stress, -along, 1e-9 * std::abs(along));
  int held = 0;
  for (std::size_t s = 0; s < state().supports.size(); ++s) {
    const SupportPoint& p = state().supports[s];
    const double value = now.support_stress.h_view(s) * state().scales.stress;
    const double expected = p.support < 0 ? 0 : std::abs(p.normal[2]) > 0.5 ? along : lambda * e;
    ASSERT_NEAR(value, expected, 1e-9 * std::abs(along)) << p.normal;
    held += p.support >= 0;
  }
  EXPECT_GT(held, 0);
  EXPECT_LT(stress.update(now), 1e-12);
  Kokkos::deep_copy(now.u, displacements([&](int, const Vec3& x) { return Vec3(0, 0, 1.25 * e * x[2]); }));
  EXPECT_NEAR(stress.update(now), 0.2, 1e-9) << "relative to the new stress";
}

}  // namespace
}  // namespace cgcontact::test_outer_steps
