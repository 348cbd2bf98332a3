/// Figures of a solved scene against what is known of it: forces, moments and zones of pairs, what holds and springs
/// take, limits of the theory, gaps that are left, points and paths.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contact/preparation.hpp"
#include "contact/results/figures/conditions.hpp"
#include "contact/results/figures/holding.hpp"
#include "contact/results/figures/pair_figures.hpp"
#include "contact/results/figures/pressure_paths.hpp"
#include "contact/results/figures/probes.hpp"
#include "contact/results/figures/slices.hpp"
#include "contact/results/figures/spring_share.hpp"
#include "contact/results/figures/zone_figures.hpp"
#include "contact/results/verdict/open_gaps.hpp"
#include "contact/results/verdict/small_strain.hpp"
#include "contact/results/verdict/zone_width.hpp"
#include "tests/support/input_errors.hpp"
#include "tests/support/run_scene.hpp"
#include "tests/support/scene_text.hpp"

namespace cgcontact::test_figures {
namespace {

/// Relative: uniform states are exact to what the solvers leave (test::tight).
constexpr double exact = 1e-9;
constexpr double E = 200e9, nu = 0.3;

/// Two blocks on each other, 0.5 x 0.4 m and 0.6 and 0.7 m high, with a corner at (0.2, 0.1, 0): between planes of
/// symmetry at their low sides.
std::string blocks(const std::string& faces, const std::string& foot, const std::string& more) {
  return R"(
[[body]]
name = "lower"
shape = {box = {min = [0.2, 0.1, 0], max = [0.7, 0.5, 0.6]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.13
grid = {offset = [0.2, 0.3, 0.6]}
[[body]]
name = "upper"
shape = {box = {min = [0.2, 0.1, 0.6], max = [0.7, 0.5, 1.3]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.11
grid = {offset = [0.3, 0.6, 0.2]}
[[contact]]
faces = )" +
         faces + "\n" + test::support_text("lower.z-", foot) +
         test::symmetry_text({"lower.x-", "lower.y-", "upper.x-", "upper.y-"}) + more;
}
const std::string lower_first = "[\"lower.z+\", \"upper.z-\"]", on_a_plane = "symmetry = true";

/// They are pressed together by p = 1 MPa: 0.2 MN.
class PressedBlocks : public testing::Test {
 protected:
  PressedBlocks()
      : solved_(test::run_text(blocks(lower_first, on_a_plane, "[[load]]\nface = \"upper.z+\"\npressure = 1e6\n"))) {}
  void SetUp() override { ASSERT_TRUE(solved_->results().converged) << solved_->results().diagnosis; }

  SolvedState& state() { return solved_->simulation->state; }
  /// Returns a copy of the results that a test may change.
  Results results() const { return solved_->results(); }

  static constexpr double p_ = 1e6, area_ = 0.2, force_ = 2e5;
  std::unique_ptr<test::SolvedScene> solved_;
};

/// The force on the lower body acts down, in the middle of the face; the moments are about the origin. The first body
/// is that of the scene, whichever has the larger cells.
TEST(PairFigures, OfAUniformlyPressedFace) {
  const double F = 2e5;
  for (const bool swapped : {false, true}) {
    const auto solved = test::run_text(blocks(swapped ? "[\"upper.z-\", \"lower.z+\"]" : lower_first, on_a_plane,
                                              "[[load]]\nface = \"upper.z+\"\npressure = 1e6\n"));
    ASSERT_TRUE(solved->results().converged) << solved->results().diagnosis;
    const SolvedState& state = solved->simulation->state;
    const std::vector<PairFigures> pairs = pair_figures(state, solved->results().contact_rows);
    ASSERT_EQ(pairs.size(), 1u);
    const PairFigures& pair = pairs[0];
    EXPECT_EQ(pair.body_first, swapped ? "upper" : "lower");
    const Vec3 middle(0.45, 0.3, 0.6), on_first(0, 0, swapped ? F : -F);
    EXPECT_LT((pair.force_on_first - on_first).norm(), exact * F);
    EXPECT_LT((pair.force_on_second + on_first).norm(), exact * F);
    EXPECT_LT((pair.moment_on_first - middle.cross(on_first)).norm(), exact * F);
    EXPECT_LT((pair.moment_on_second + middle.cross(on_first)).norm(), exact * F);
    EXPECT_LT((pair.centre - middle).norm(), exact);
    EXPECT_NEAR(pair.area, 0.2, exact);
    EXPECT_NEAR(pair.max_pressure, 1e6, exact * 1e6);
    EXPECT_EQ(pair.active_points, pair.points);
    EXPECT_NEAR(pair.zone.normal_force, F, exact * F);
    EXPECT_NEAR(normal_forces(state).at(0), F, exact * F);
  }
}

/// A fifth of the pressure lost is more than the 15 % that are let pass, a tenth is not.
TEST_F(PressedBlocks, WarnOfAPressureThatDoesNotAddUpToTheForce) {
  for (const double part : {1.0, 0.9, 0.8}) {
    Results r = results();
    r.pairs[0].pressure_on_face = false;
    for (ContactRow& row : r.contact_rows)
      if (row.body == 1) row.pressure_sprc *= part;
    const std::vector<std::string> warnings = lost_force_warnings(state(), r.contact_rows, r.pairs);
    ASSERT_EQ(warnings.size(), part < 0.85 ? 1u : 0u) << part;
    if (part < 0.85)
      expect_contains(warnings[0], {"the pressure on \"upper\" adds up to 1.6e+05 N, but 2e+05 N are transmitted"});
  }
}

/// Both planes of symmetry complete the zone to a rectangle of 1 x 0.8 m, whose ends are those of the faces: no open
/// point bounds it.
TEST_F(PressedBlocks, HaveARectangularZoneBehindTheirPlanesOfSymmetry) {
  Results r = results();
  r.pairs[0].zone.extent.reset();
  set_zone_figures(state(), r.contact_rows, r.pairs);
  const ZoneFigures& zone = r.pairs[0].zone;
  ASSERT_TRUE(zone.extent);
  EXPECT_EQ(zone.extent->shape, ZoneExtent::Shape::rectangular);
  EXPECT_NEAR(zone.extent->half_axes[0], 0.5, exact);
  EXPECT_NEAR(zone.extent->half_axes[1], 0.4, exact);
  EXPECT_LT((zone.extent->directions[0] - Vec3::UnitX()).norm(), exact);
  EXPECT_LT((zone.extent->directions[1] - Vec3::UnitY()).norm(), exact);
  EXPECT_FALSE(zone.hertz) << "planes have no curvature";
  const ZoneFrame frame = frame_of_zone(state(), r.contact_rows, r.pairs, 0);
  ASSERT_EQ(frame.planes.size(), 2u);
  for (const SymmetryPlane& plane : frame.planes)
    EXPECT_NEAR(plane.distance(Vec3(0.45, 0.3, 0.6)), std::abs(plane.normal[0]) > 0.5 ? -0.25 : -0.2, exact);
  ASSERT_TRUE(frame.normal);
  EXPECT_LT((*frame.normal - (state().pairs[0].primary == 0 ? 1 : -1) * Vec3::UnitZ()).norm(), exact);
  EXPECT_FALSE(zone_widths(state()).at(0).cells);
}

/// The point of a body's boundary nearest to x.
int boundary_point_near(const BodyModel& body, const Vec3& x) {
  int nearest = 0;
  for (int p = 0; p < static_cast<int>(body.cut_cells.boundary.size()); ++p)
    if ((body.point(p) - x).norm() < (body.point(nearest) - x).norm()) nearest = p;
  return nearest;
}

/// Adds a point that holds the upper body although no support of the scene does, with a force (N) along x; returns
/// where it is.
Vec3 hold_upper(SolvedState& state, const Vec3& near, double force) {
  const BodyModel& body = state.bodies[1];
  const CellPoint at = cell_point_of(body, boundary_point_near(body, near));
  SupportPoint point;
  point.body = 1;
  point.cell = at.cell;
  point.xi = at.xi;
  point.direction = Vec3::UnitX();
  point.weight = 2e-4;
  point.holds_along_surface = true;
  state.supports.push_back(point);
  state.outer.support_stress.push_back(force / point.weight);
  return global_position(body.cut_cells, at.cell, at.xi);
}

/// What holds a body counts by its force or by its moment over half the longest side (0.7 m), whichever is more.
TEST_F(PressedBlocks, CountWhatHoldsThem) {
  EXPECT_LT(held_fraction(state(), 1), exact) << "weak springs have let go";
  EXPECT_EQ(surface_hold_warning(state()), "");
  const Vec3 high = hold_upper(state(), Vec3(0.7, 0.3, 1.0), 200);
  EXPECT_LT((holding_force(state(), 1) - Vec3(200, 0, 0)).norm(), exact * force_);
  EXPECT_EQ(holding_force(state(), 0).norm(), 0);
  EXPECT_NEAR(held_fraction(state(), 1), 200 / force_, exact);
  EXPECT_EQ(held_fraction(state(), 0), 0);
  EXPECT_NEAR(held_fraction(state(), state().pairs[0]), 200 / force_, exact);
  expect_contains(surface_hold_warning(state()), {"a body held by contact alone", "at most 0.1 %", "body \"upper\""});
  // A couple.
  const Vec3 low = hold_upper(state(), Vec3(0.7, 0.3, 0.6), -200);
  EXPECT_LT(holding_force(state(), 1).norm(), exact * force_);
  const double moment = (high - low).cross(Vec3(200, 0, 0)).norm();
  EXPECT_GT(moment, 50);
  EXPECT_NEAR(held_fraction(state(), 1), 2 * moment / 0.7 / force_, exact);
}

/// Forces out of balance by two per cent are known to be wrong, those by half a per cent pass; a contact that pulls is
/// none; next to no force is none.
TEST_F(PressedBlocks, AreOutOfBalanceWithOtherForces) {
  const std::vector<double> right = state().outer.group_force;
  const auto with = [&](double factor) {
    state().outer.group_force = right;
    for (double& force : state().outer.group_force) force *= factor;
    return contact_fault(state());
  };
  EXPECT_EQ(with(1), "");
  EXPECT_TRUE(contact_carries(state()));
  EXPECT_EQ(with(1.005), "");
  expect_contains(with(1.02), {"its force of 2.04e+05 N is none that is known", "balance to 4e+03 N only"});
  expect_contains(with(-1), {"its force of -2e+05 N pulls"});
  with(1e-10);
  EXPECT_FALSE(contact_carries(state()));
}

/// A support that holds the normal on the face of one body marks its area.
TEST_F(PressedBlocks, AreNoResultOnAHeldFace) {
  Results r = results();
  EXPECT_EQ(held_contact(state(), r.contact_rows), "");
  for (ContactRow& row : r.contact_rows)
    if (row.body == 1) row.touching = false;
  expect_contains(held_contact(state(), r.contact_rows), {"acts on 0.2 m2 whose normal a support holds"});
}

TEST_F(PressedBlocks, HaveTheAreasAndConditionsOfTheirSupports) {
  Results r = results();
  for (SupportFigures& s : r.supports) s.area = 0;
  fill_conditions(state(), r);
  const double areas[] = {0.2, 0.24, 0.3, 0.28, 0.35};
  for (int s = 0; s < 5; ++s) {
    EXPECT_NEAR(r.supports[s].area, areas[s], exact);
    EXPECT_EQ(r.supports[s].condition, "symmetry");
  }
  const std::vector<LoadFigures> loads = load_figures(state().scene, state().bodies);
  ASSERT_EQ(loads.size(), 1u);
  EXPECT_EQ(loads[0].face, "upper.z+");
  EXPECT_LT((loads[0].force - Vec3(0, 0, -force_)).norm(), exact * force_);
}

/// Forces, areas and energies go with the thickness, norms of errors with its root; stresses, relative errors and
/// supports that stand for the ends do not.
TEST_F(PressedBlocks, ScaleFromASliceToTheBodies) {
  Results r = results();
  r.estimated_error = 5;
  r.estimated_error_relative = 0.1;
  r.bodies[0].error_of_cell = {2};
  r.bodies[0].energy_of_cell = {7};
  const Results slice = r;
  for (BodyModel& body : state().bodies) body.slices = 4;
  solved_->scene.supports[1].implied = true;
  scale_to_thickness(state(), r);
  EXPECT_EQ(r.pairs[0].force_on_first, 4 * slice.pairs[0].force_on_first);
  EXPECT_EQ(r.pairs[0].moment_on_second, 4 * slice.pairs[0].moment_on_second);
  EXPECT_EQ(r.pairs[0].area, 4 * slice.pairs[0].area);
  EXPECT_EQ(r.pairs[0].max_pressure, slice.pairs[0].max_pressure);
  EXPECT_EQ(r.pairs[0].centre, slice.pairs[0].centre);
  EXPECT_EQ(r.supports[0].force, 4 * slice.supports[0].force);
  EXPECT_EQ(r.supports[1].force, slice.supports[1].force);
  EXPECT_EQ(r.balance[1].loads, 4 * slice.balance[1].loads);
  EXPECT_EQ(r.contact_rows[0].weight, 4 * slice.contact_rows[0].weight);
  EXPECT_EQ(r.contact_rows[0].pressure_sprc, slice.contact_rows[0].pressure_sprc);
  EXPECT_EQ(r.estimated_error, 10);
  EXPECT_EQ(r.estimated_error_relative, 0.1);
  EXPECT_EQ(r.bodies[0].error_of_cell[0], 4);
  EXPECT_EQ(r.bodies[0].energy_of_cell[0], 28);
}

/// What lies off a face goes to it, within a cell and up to its end; the pressure there is p.
TEST_F(PressedBlocks, ProjectPointsToTheirFaces) {
  const Results r = results();
  const FaceProjection project(state(), r);
  for (const int body : {0, 1})
    for (const double off : {-0.02, 0.0, 0.05}) {
      const auto row = project(body, 0, Vec3(0.4, 0.3, 0.6 + off));
      ASSERT_TRUE(row) << off;
      EXPECT_LT((row->x - Vec3(0.4, 0.3, 0.6)).norm(), exact);
      EXPECT_LT((row->normal - Vec3(0, 0, body == 0 ? 1 : -1)).norm(), exact);
      EXPECT_NEAR(row->pressure_sprc, p_, exact * p_);
    }
  EXPECT_TRUE(project(1, -1, Vec3(0.4, 0.3, 0.6)));
  EXPECT_FALSE(project(1, 1, Vec3(0.4, 0.3, 0.6))) << "there is one pair";
  EXPECT_FALSE(project(1, 0, Vec3(0.75, 0.3, 0.6))) << "beyond the end of the face";
  EXPECT_FALSE(project(1, 0, Vec3(0.4, 0.3, 0.9))) << "farther than a cell";
}

/// Along a given line s is the way from its beginning; through the largest pressure it is the way from there.
TEST_F(PressedBlocks, HavePathsMeasuredAlongTheFace) {
  Results r = results();
  r.path.clear();
  fill_paths(state(), r);
  EXPECT_TRUE(r.path_from_largest);
  bool through_largest = false;
  for (std::size_t i = 0; i < r.path.size(); ++i) {
    through_largest |= r.path[i].s == 0;
    EXPECT_NEAR(r.path[i].pressure_sprc, p_, exact * p_);
    if (i == 0 || r.path[i].body != r.path[i - 1].body) continue;
    EXPECT_NEAR(r.path[i].s - r.path[i - 1].s, (r.path[i].x - r.path[i - 1].x).norm(), exact);
  }
  EXPECT_TRUE(through_largest);
  solved_->scene.output.path = {Vec3(0.2, 0.1, 0.61), Vec3(0.7, 0.5, 0.61)};
  r.path.clear();
  fill_paths(state(), r);
  ASSERT_EQ(r.path.size(), 2u * 401);
  const Vec3 along = Vec3(0.5, 0.4, 0).normalized();
  for (const PathSample& sample : r.path) EXPECT_LT((sample.x - Vec3(0.2, 0.1, 0.6) - sample.s * along).norm(), exact);
}

/// Springs above the contact stand beside the blocks: of the load F they take k A / (k A + K), K the stiffness of the
/// blocks and the springs below them in a row. Those below, which contact presses the lower block against, take nothing
/// from it.
TEST(SpringShare, IsThatOfSpringsBesideTheContact) {
  const double A = 0.2, above = 0.5e11, below = 1e12;  // Pa/m
  const double K = 1 / ((0.6 + 0.7) / (E * A) + 1 / (below * A)), share = above * A / (above * A + K);
  const auto solved = test::run_text(blocks(lower_first, "stiffness = [0, 0, 1e12]",
                                            test::support_text("upper.z+", "stiffness = [0, 0, 0.5e11]") +
                                                "[[load]]\nface = \"upper.z+\"\npressure = 1e6\n"));
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const std::vector<SpringShare> shares = spring_shares(solved->simulation->state, r);
  ASSERT_EQ(shares.size(), 1u);
  EXPECT_EQ(shares[0].body, 1);
  EXPECT_NEAR(shares[0].share, share, exact);
  EXPECT_NEAR(shares[0].force, share * 2e5, exact * 2e5);
  EXPECT_EQ(shares[0].faces, std::vector<std::string>{"\"upper.z+\""});
  EXPECT_NEAR(r.pairs[0].force_on_second[2], (1 - share) * 2e5, exact * 2e5);
  Results reported = r;
  reported.verdict.text = "resolved";
  reported.verdict.spring_share = 0;
  report_spring_shares(solved->simulation->state, reported);
  EXPECT_NEAR(reported.verdict.spring_share, share, exact);
  expect_contains(reported.verdict.text, {"resolved; springs of the scene take", "body \"upper\" into its contact"});
}

/// A bar of 1 m, pulled to a strain of 0.1 %.
class PulledBar : public testing::Test {
 protected:
  PulledBar() : solved_(test::run_text(test::pulled_bar_text())) {}
  void SetUp() override { ASSERT_TRUE(solved_->results().converged) << solved_->results().diagnosis; }

  SolvedState& state() { return solved_->simulation->state; }
  /// Multiplies all displacements.
  void scale(double factor) {
    for (std::size_t i = 0; i < state().outer.u.extent(0); ++i) state().outer.u(i) *= factor;
    state().outer.body_motions[0].translation *= factor;
    state().outer.body_motions[0].rotation *= factor;
  }
  std::string warning() {
    const std::vector<std::string> all = small_strain_warnings(state(), {});
    return all.empty() ? "" : all.at(0);
  }

  std::unique_ptr<test::SolvedScene> solved_;
};

/// The limits are a strain of 5 % and a displacement of a tenth of the length.
TEST_F(PulledBar, IsStrainedTooMuchFromFivePerCentOn) {
  scale(40);
  EXPECT_EQ(warning(), "");
  scale(60.0 / 40);
  expect_contains(warning(), {"body \"bar\"", "strain 6 %"});
  EXPECT_EQ(warning().find("displacement"), std::string::npos);
  scale(2);
  expect_contains(warning(), {"strain 12 %", "displacement 0.1"});
  EXPECT_EQ(beyond_all_grids(state()), "");
  scale(900.0 / 120);
  EXPECT_EQ(beyond_all_grids(state()), "");
  scale(2000.0 / 900);
  expect_contains(beyond_all_grids(state()), {"body \"bar\": strain 2e+02 %"});
}

/// A rotation by itself is a displacement, and no strain.
TEST_F(PulledBar, IsNotStrainedByARotation) {
  state().outer.body_motions[0].rotation += Vec3(0, 0.5, 0);
  expect_contains(warning(), {"displacement"});
  EXPECT_EQ(warning().find("strain", warning().find("rough")), std::string::npos) << warning();
}

/// A pressure of more than a tenth of E.
TEST_F(PulledBar, IsPressedTooMuchFromATenthOfItsModulusOn) {
  Results r;
  r.contact_rows.resize(1);
  r.contact_rows[0].pressure_sprc = 0.09 * E;
  EXPECT_TRUE(small_strain_warnings(state(), r.contact_rows).empty());
  r.contact_rows[0].pressure_sprc = 0.2 * E;
  expect_contains(small_strain_warnings(state(), r.contact_rows).at(0), {"contact pressure 4e+10 Pa, 20 % of E"});
}

/// The lower block is pressed at its side: it grows by nu q H/E towards the upper one, which leaves 1 um of a gap of 10
/// um. The state is exact, so the gap has no error.
TEST(OpenGaps, AreWhatADeformationLeaves) {
  const auto solved = test::run_text(R"(
[[body]]
name = "lower"
shape = {box = {min = [0, 0, 0], max = [0.5, 0.4, 0.6]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.13
grid = {offset = [0.2, 0.3, 0.6]}
[[body]]
name = "upper"
shape = {box = {min = [0, 0, 0.60001], max = [0.5, 0.4, 1]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.11
grid = {offset = [0.3, 0.6, 0.2]}
[[contact]]
faces = ["lower.z+", "upper.z-"]
[[load]]
face = "lower.x+"
pressure = 1e7
)" + test::symmetry_text({"lower.x-", "lower.y-", "lower.z-", "upper.x-", "upper.y-", "upper.z+"}));
  Results r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  ASSERT_EQ(r.pairs[0].active_points, 0);
  const double growth = nu * 1e7 * 0.6 / E;
  r.pairs[0].min_gap.reset();
  const SolvedState& state = solved->simulation->state;
  estimate_gap_errors(state, r.contact_rows, r.bodies, r.pairs);
  ASSERT_TRUE(r.pairs[0].min_gap);
  EXPECT_NEAR(*r.pairs[0].min_gap, 1e-5 - growth, 1e-13);  // of positions with some 1e-16 m
  EXPECT_LT(*r.pairs[0].min_gap_error, exact * growth);
  EXPECT_TRUE(unclear_gaps(state, r.pairs).empty());
  // Had it an error of 3 um: the force of a flat punch, a cell wide, under 2 um. That of a round one is 2 a E* d, and
  // the law for all shapes 7 % off it.
  r.pairs[0].min_gap = 1e-6;
  r.pairs[0].min_gap_error = 3e-6;
  r.pairs[0].min_gap_cell = 0.1;
  const std::vector<UnclearGap> unclear = unclear_gaps(state, r.pairs);
  ASSERT_EQ(unclear.size(), 1u);
  EXPECT_NEAR(unclear[0].force / (2 * 0.05 * E / (2 * (1 - nu * nu)) * 2e-6), 1, 0.08);
}

/// The error of a gap falls with the square of the energy norm's, which falls with the cells.
TEST(OpenGaps, AskForCellsThatTellThemFromTheirError) {
  EXPECT_NEAR(refinement_to_tell(1e-6, 4e-6), 0.5, 1e-15);
  EXPECT_NEAR(refinement_to_tell(-1e-6, 4e-6), std::sqrt(0.1), 1e-15);
}

/// Points in a body have their cell, also on its boundary; those beside it have none, although the grid has cells
/// there.
TEST(CellPoints, AreWhereTheBodyIs) {
  const Scene scene = parse_scene(R"(
[[body]]
name = "rod"
shape = {cylinder = {base = [0.1, 0.2, 0], top = [0.1, 0.2, 0.5], radius = 0.3}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.11
grid = {offset = [0.3, 0.6, 0.2], rotation = {axis = [1, 2, 3], angle = 20}}
)" + test::symmetry_text({"rod.bottom"}),
                                  "scene.toml");
  const Preparation prepared = discretise(scene);
  const BodyModel& rod = prepared.bodies[0];
  const auto position = [&](const CellPoint& at) { return global_position(rod.cut_cells, at.cell, at.xi); };
  for (int k = 0; k < 40; ++k) {
    const double angle = 0.7 * k, z = 0.5 * (k + 0.5) / 40;
    const Vec3 across(std::cos(angle), std::sin(angle), 0), axis(0.1, 0.2, z);
    const auto inside = find_cell_point(rod, axis + 0.299 * across);
    ASSERT_TRUE(inside) << k;
    EXPECT_LT((position(*inside) - axis - 0.299 * across).norm(), 1e-13);
    EXPECT_LT(inside->xi.cwiseAbs().maxCoeff(), 1 + 1e-9);
    EXPECT_FALSE(find_cell_point(rod, axis + 0.301 * across)) << k;
  }
  for (int p = 0; p < static_cast<int>(rod.cut_cells.boundary.size()); ++p)
    EXPECT_LT((position(cell_point_of(rod, p)) - rod.point(p)).norm(), 1e-13);
}

/// p = p0 x/a on a face of a x b: the force is p0 a b/2, its moment about the middle p0 a^2 b/12. The weight acts in
/// the middle of the body.
TEST(LoadFigures, OfALinearPressureAndOfGravity) {
  const Scene scene = parse_scene(R"(
gravity = [0, 0, -10]
[[body]]
name = "block"
shape = {box = {min = [0, 0, 0], max = [0.4, 0.6, 1]}}
material = {E = 200e9, nu = 0.3, density = 8000}
cell_size = 0.23
grid = {offset = [0.3, 0.6, 0.2], rotation = {axis = [1, 2, 3], angle = 20}}
[[load]]
face = "block.z+"
pressure = "1e6*x/0.4"
)" + test::symmetry_text({"block.z-"}),
                                  "scene.toml");
  const Preparation prepared = discretise(scene);
  const std::vector<LoadFigures> loads = load_figures(scene, prepared.bodies);
  ASSERT_EQ(loads.size(), 2u);
  EXPECT_NEAR(loads[0].area, 0.24, exact);
  EXPECT_LT((loads[0].force - Vec3(0, 0, -1.2e5)).norm(), exact * 1.2e5);
  EXPECT_LT((loads[0].about - Vec3(0.2, 0.3, 1)).norm(), exact);
  EXPECT_LT((loads[0].moment - Vec3(0, 1e6 * 0.16 * 0.6 / 12, 0)).norm(), exact * 1e5);
  EXPECT_TRUE(loads[1].of_body);
  EXPECT_LT((loads[1].force - Vec3(0, 0, -8000 * 10 * 0.24)).norm(), exact * 2e4);
  EXPECT_LT((loads[1].about - Vec3(0.2, 0.3, 0.5)).norm(), exact);
  EXPECT_LT(loads[1].moment.norm(), exact * 2e4);
}

// A roller that is moved along a flat face without friction: the solution is that of the roller at rest, moved, also
// where it goes by more than its zone is wide. Gaps along the roller's own normals, which lean by up to a/R, would open
// half of its zone (largest gap: distance times lean, here four cells). Bound: the linear solves.
TEST(Figures, PressureOfAFaceThatSlidesFar) {
  const auto pressures = [](const std::string& along) {
    const auto solved = test::run_text(R"(
plane_strain = "x"
[[body]]
name = "block"
shape = {name = "b", box = {min = [0, -0.004, -0.003], max = [8e-5, 0.004, 0]}}
material = {E = 210e9, nu = 0.3}
cell_size = 1.1e-4
grid = {offset = [0, 0.37, 0.61]}
[[body]]
name = "roller"
shape = {intersection = [{name = "roller", cylinder = {base = [0, 0, 0.01], top = [8e-5, 0, 0.01], radius = 0.01}},
  {name = "cut", box = {min = [0, -0.004, -0.001], max = [8e-5, 0.004, 0.003]}}]}
material = {E = 210e9, nu = 0.3}
cell_size = 0.9e-4
[[support]]
face = "block.b.z-"
displacement = {y = 0, z = 0}
[[support]]
face = "roller.cut.z+"
displacement = {y = )" + along + R"(, z = -20e-6}
[[contact]]
faces = ["block.b.z+", "roller.roller.side"]
)");
    EXPECT_TRUE(solved->simulation->results.converged);
    std::vector<double> all;
    for (const ContactRow& row : solved->simulation->results.contact_rows) all.push_back(row.pressure_sprc);
    return all;
  };
  const std::vector<double> rest = pressures("0"), moved = pressures("0.01");
  ASSERT_EQ(rest.size(), moved.size());
  const double largest = *std::max_element(rest.begin(), rest.end());
  EXPECT_GT(largest, 1e8);
  for (std::size_t i = 0; i < rest.size(); ++i) EXPECT_NEAR(moved[i], rest[i], 1e-5 * largest) << i;
}

}  // namespace
}  // namespace cgcontact::test_figures
