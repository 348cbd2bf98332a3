/// Rigid motions: what known supports and contact leave free, what loads drive, which contact forces equilibrium alone
/// gives, where rigid bodies rest on their contact.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contact/motions/free_components.hpp"
#include "contact/motions/free_motion.hpp"
#include "contact/motions/rigid_motion.hpp"
#include "contact/motions/statics.hpp"
#include "contact/preparation.hpp"
#include "contact/solve/floating/rigid_contact.hpp"
#include "contact/solve/floating/tangential_drift.hpp"
#include "core/scene_file/read_scene.hpp"
#include "tests/support/scene_text.hpp"

namespace cgcontact::test_motions {
namespace {

/// Rounding of the eigenvectors of resistances whose least eigenvalue is some hundredths of the largest one, with room.
constexpr double rounding = 1e-9;

/// A scene on its grids, with its contact closed; nothing is held but by its supports.
struct OnGrids {
  Scene scene;
  Preparation p;
  explicit OnGrids(const std::string& text) : scene(parse_scene(text, "scene.toml")), p(discretise(scene)) {}
  OnGrids(const OnGrids&) = delete;
};

/// A block of 0.4 x 0.6 x 1 m in a turned grid.
std::string block(const std::string& more) {
  return test::box_text("block", "[0, 0, 0]", "[0.4, 0.6, 1]", 0.23, test::turned_grid) + more;
}

/// Returns the free motions of the only body with its supports.
FreeMotions free_motions(const OnGrids& g) { return find_free_motions(g.p.bodies, g.p.supports, g.p.pairs); }

/// Expects the motions to be those of the span of orthonormal columns, and no others.
void expect_span(const FreeMotions& free, const std::vector<RigidMotion>& motions, const std::string& what) {
  ASSERT_EQ(free.modes.cols(), static_cast<Eigen::Index>(motions.size())) << what;
  for (const RigidMotion& m : motions)
    EXPECT_LT((m - free.modes * (free.modes.transpose() * m)).norm(), rounding * m.norm()) << what;
}

TEST(RigidComponent, RowGivesTheDisplacementAlongADirection) {
  const RigidComponent component{0, Vec3(1, 2, 3), Vec3(2, 5, 4)};  // centre (1.5, 3.5, 3.5), size 3
  RigidMotion motion;
  motion << 0.1, -0.2, 0.3, 0.4, 0.5, -0.6;
  const Vec3 x(2, -1, 7), d = Vec3(1, -2, 2) / 3;
  const Vec3 u = Vec3(0.1, -0.2, 0.3) + Vec3(0.4, 0.5, -0.6).cross(Vec3(0.5, -4.5, 3.5)) / 3;
  EXPECT_NEAR(component.row(x, d).dot(motion), u.dot(d), 1e-14);
}

/// A plane that holds its normal leaves three motions, two planes across each other one, three none.
TEST(FreeMotions, OfABlockAreThoseThatItsSupportsLeave) {
  const OnGrids on_a_plane(block(test::symmetry_text({"block.z-"})));
  EXPECT_EQ(free_rigid_motions(whole_bodies(on_a_plane.p.bodies), on_a_plane.p.bodies, {}, {}).cols(), 6);
  const auto unit = [](int k) { return RigidMotion(RigidMotion::Unit(k)); };
  expect_span(free_motions(on_a_plane), {unit(0), unit(1), unit(5)}, "z");
  expect_span(free_motions(OnGrids(block(test::symmetry_text({"block.z-", "block.x-"})))), {unit(1)}, "z, x");
  expect_span(free_motions(OnGrids(block(test::symmetry_text({"block.z-", "block.x-", "block.y-"})))), {}, "z, x, y");
  expect_span(free_motions(OnGrids(block(test::support_text("block.z-", "displacement = {x = 0, y = 0, z = 0}")))), {},
              "foot");
  // Held along x on the plane z = 0: it may turn about the y axis of that plane.
  const OnGrids hinged(block(test::support_text("block.z-", "displacement = {x = 0}")));
  const FreeMotions free = free_motions(hinged);
  RigidMotion hinge = unit(4);
  hinge[0] = free.bodies[0].centre()[2] / free.bodies[0].size();
  expect_span(free, {unit(1), unit(2), unit(3), hinge}, "x on z = 0");
}

std::string rod(const std::string& held) {
  return "[[body]]\nname = \"rod\"\nshape = {cylinder = {base = [0.1, 0.2, 0], top = [0.1, 0.2, 0.5], radius = 0.3}}\n"
         "material = {E = 200e9, nu = 0.3}\ncell_size = 0.11\ngrid = {offset = [0.3, 0.6, 0.2]}\n" +
         test::support_text("rod.side", "cylindrical = {" + held + "point = [0.1, 0.2, 0], axis = [0, 0, 1]}");
}

/// A rod in a bushing turns about its own axis, not about the middle of its cells.
TEST(FreeMotions, OfARodInABushingAreASlideAndASpinAboutItsAxis) {
  const OnGrids bushing(rod("radial = 0, "));
  const FreeMotions free = free_motions(bushing);
  const RigidComponent& component = free.bodies[0];
  const Vec3 to_centre = component.centre() - Vec3(0.1, 0.2, 0);
  ASSERT_GT(to_centre.head<2>().norm(), 1e-3) << "the grid fits the rod";
  RigidMotion spin;
  spin << Vec3::UnitZ().cross(to_centre), component.size() * Vec3::UnitZ();
  expect_span(free, {RigidMotion(RigidMotion::Unit(2)), spin}, "radial");
  EXPECT_EQ(free.without_rotation().modes.cols(), 1);
  EXPECT_TRUE(free.slides());
  const OnGrids journal(rod("radial = 0, axial = 0, "));
  EXPECT_FALSE(free_motions(journal).slides());
  const std::string text = find_free_motion(journal.scene, journal.p.bodies, journal.p.supports, journal.p.pairs);
  EXPECT_NE(text.find("\"rod\" is free to rotate about the axis along z through (0.1, 0.2, "), std::string::npos)
      << text;
}

/// As many points as there are motions, and nothing is free any more.
TEST(FreeMotions, AreHeldByOnePointEach) {
  const OnGrids g(block(test::symmetry_text({"block.z-"})));
  const FreeMotions free = free_motions(g);
  std::vector<SupportPoint> supports = hold(free, g.p.bodies);
  ASSERT_EQ(supports.size(), 3u);
  FreeMotions left = free;
  left.leave_out({supports[0]}, g.p.bodies);
  EXPECT_EQ(left.modes.cols(), 2);
  left.leave_out(supports, g.p.bodies);
  EXPECT_TRUE(left.empty());
  supports.insert(supports.end(), g.p.supports.begin(), g.p.supports.end());
  EXPECT_TRUE(find_free_motions(g.p.bodies, supports, {}).empty());
}

/// The motion that a load drives is the one that it does most work on: along its force and about its moment. What the
/// support takes drives nothing. Resultants of loads are exact to 1e-12.
TEST(FreeMotions, DrivenByALoadFollowItsForceAndMoment) {
  const OnGrids g(block(test::symmetry_text({"block.z-"}) +
                        "[[load]]\nface = \"block.z+\"\nforce = [300, 400, -500]\nat = [1.2, 0.9, 0.5]\n"));
  const FreeMotions free = free_motions(g), driven = driven_by_loads(free, g.p.bodies);
  const Vec3 arm = Vec3(1.2, 0.9, 0.5) - free.bodies[0].centre();
  RigidMotion expected = RigidMotion::Zero();
  expected[0] = 300;
  expected[1] = 400;
  expected[5] = (arm[0] * 400 - arm[1] * 300) / free.bodies[0].size();
  ASSERT_EQ(driven.modes.cols(), 1);
  EXPECT_LT((driven.modes - expected.normalized()).norm(), rounding);
  const OnGrids pressed(block(test::symmetry_text({"block.z-"}) + "[[load]]\nface = \"block.z+\"\npressure = 1e6\n"));
  EXPECT_TRUE(driven_by_loads(free_motions(pressed), pressed.p.bodies).empty());
}

TEST(DirectionText, NamesAxesWhateverTheSign) {
  EXPECT_EQ(direction_text(Vec3(0, 0, -2)), "z");
  EXPECT_EQ(direction_text(Vec3(-3, 4, 0)), "(-0.600, 0.800, 0.000)");
  EXPECT_EQ(direction_text(Vec3(3, -4, 0)), "(-0.600, 0.800, 0.000)");
}

/// Bonds join bodies over others; contact that is not bonded does not.
TEST(BondedAssemblies, AreNamedByTheirFirstBody) {
  ContactSpec bonded, touching;
  bonded.bonded = true;
  const auto assemblies = [&](const std::vector<std::array<int, 2>>& bonds) {
    std::vector<ContactPair> pairs(1);
    pairs[0].spec = &touching;
    pairs[0].primary = 0;
    pairs[0].secondary = 5;
    for (const auto& [first, second] : bonds) {
      pairs.emplace_back();
      pairs.back().spec = &bonded;
      pairs.back().primary = first;
      pairs.back().secondary = second;
    }
    return bonded_assemblies(6, pairs);
  };
  EXPECT_EQ(assemblies({}), (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(assemblies({{3, 1}, {1, 4}}), (std::vector<int>{0, 1, 2, 1, 1, 5}));
  EXPECT_EQ(assemblies({{4, 5}, {2, 3}, {5, 3}}), (std::vector<int>{0, 1, 2, 2, 2, 2}));
}

/// A body of two boxes three cells apart.
std::string two_pieces(const std::vector<std::string>& held) {
  return R"(
[[body]]
name = "pieces"
material = {E = 200e9, nu = 0.3}
cell_size = 0.1
grid = {offset = [0.3, 0.6, 0.2]}
shape = {union = [{name = "a", box = {min = [0, 0, 0], max = [0.4, 1, 0.3]}},
                  {name = "b", box = {min = [0.7, 0, 0], max = [1, 1, 0.3]}}]}
)" + test::symmetry_text(held);
}

/// They are two components, each with its own cells. Their lower faces lie on one plane, so that the support of "a.z-"
/// holds both of them: it leaves "b" three motions, and "a", which the plane across x holds too, a slide along y.
TEST(RigidComponents, OfABodyInTwoPieces) {
  const OnGrids g(two_pieces({"pieces.a.z-", "pieces.a.x-"}));
  EXPECT_EQ(whole_bodies(g.p.bodies).list.size(), 1u);
  const RigidComponents components = components_of(g.p.bodies);
  ASSERT_EQ(components.list.size(), 2u);
  const CutCells& cells = g.p.bodies[0].cut_cells;
  for (int c = 0; c < static_cast<int>(cells.cells.size()); ++c) {
    const Vec3 x = global_position(cells, c, Vec3::Zero());
    const RigidComponent& own = components.list[components.at(0, c)];
    EXPECT_TRUE((own.low.array() < x.array()).all() && (x.array() < own.high.array()).all());
    EXPECT_EQ(own.high[0] < 0.55, x[0] < 0.55);
  }
  EXPECT_EQ(free_rigid_motions(components, g.p.bodies, g.p.supports, {}).cols(), 1 + 3);
}

/// Three blocks on each other between planes of symmetry.
std::string stack(const std::string& more) {
  return test::box_text("low", "[0, 0, 0]", "[0.5, 0.4, 0.3]", 0.17) +
         test::box_text("middle", "[0, 0, 0.3]", "[0.5, 0.4, 0.7]", 0.13) +
         test::box_text("top", "[0, 0, 0.7]", "[0.5, 0.4, 1]", 0.19) +
         test::symmetry_text({"low.x-", "low.y-", "low.z-", "middle.x-", "middle.y-", "top.x-", "top.y-"}) +
         test::contact_text("low.z+", "middle.z-") + test::contact_text("top.z-", "middle.z+") + more;
}

/// Loads give every force in a stack that stands free, whatever carries them; none where the top is held as well. A
/// pair that is open carries nothing, and what stands above it is not held by it.
TEST(Statics, GiveTheForcesInAStackThatStandsFree) {
  const Vec3 z = Vec3::UnitZ();
  OnGrids standing(stack(""));
  ASSERT_EQ(standing.p.pairs.size(), 2u);
  const auto given = [&](const OnGrids& g, int pair, const Vec3& direction) {
    return Statics(g.scene, g.p.bodies, g.p.supports, g.p.pairs).loads_give(pair, direction);
  };
  for (const int pair : {0, 1}) {
    EXPECT_TRUE(given(standing, pair, z));
    EXPECT_TRUE(given(standing, pair, -z));
    EXPECT_FALSE(given(standing, pair, Vec3::UnitX())) << "it has no force along its faces";
  }
  ContactPoints& points = standing.p.pairs[0].points;
  for (std::size_t q = 0; q < points.size(); ++q) points.set_active(q, false);
  EXPECT_FALSE(given(standing, 0, z));
  EXPECT_TRUE(given(standing, 1, z));
  const OnGrids clamped(stack(test::symmetry_text({"top.z+"})));
  for (const int pair : {0, 1}) EXPECT_FALSE(given(clamped, pair, z));
  const OnGrids on_springs(stack(test::support_text("top.z+", "stiffness = 1e6")));
  for (const int pair : {0, 1}) EXPECT_FALSE(given(on_springs, pair, z)) << "soft as they are";
}

/// A plate on two columns shares its load by their stiffness; on one of them it does not.
TEST(Statics, DoNotShareALoadAmongTwoColumns) {
  OnGrids g(test::box_text("left", "[0, 0, 0]", "[0.2, 0.4, 0.3]", 0.11) +
            test::box_text("right", "[0.6, 0, 0]", "[0.8, 0.4, 0.3]", 0.11) +
            test::box_text("plate", "[0, 0, 0.3]", "[0.8, 0.4, 0.5]", 0.13) +
            test::symmetry_text({"plate.x-", "plate.y-"}) +
            test::support_text("left.z-", "displacement = {x = 0, y = 0, z = 0}") +
            test::support_text("right.z-", "displacement = {x = 0, y = 0, z = 0}") +
            test::contact_text("left.z+", "plate.z-") + test::contact_text("right.z+", "plate.z-"));
  ASSERT_EQ(g.p.pairs.size(), 2u);
  const auto given = [&](int pair) {
    return Statics(g.scene, g.p.bodies, g.p.supports, g.p.pairs).loads_give(pair, Vec3::UnitZ());
  };
  EXPECT_FALSE(given(0));
  EXPECT_FALSE(given(1));
  ContactPoints& right = g.p.pairs[1].points;
  for (std::size_t q = 0; q < right.size(); ++q) right.set_active(q, false);
  EXPECT_TRUE(given(0));
}

/// A block stands on a floor beside a wall, closed on both: the floor's force is the load's, but with friction at the
/// wall, which carries some of it; with friction at the floor alone it is the load's again.
TEST(Statics, FrictionBesideTakesAShare) {
  const auto given = [](const std::string& at_floor, const std::string& at_wall) {
    OnGrids g(test::box_text("floor", "[0, 0, -0.2]", "[0.8, 0.4, 0]", 0.11) +
              test::box_text("wall", "[-0.2, 0, 0]", "[0, 0.4, 0.5]", 0.13) +
              test::box_text("block", "[0, 0, 0]", "[0.4, 0.4, 0.4]", 0.12) + test::symmetry_text({"block.y-"}) +
              test::support_text("floor.z-", "displacement = {x = 0, y = 0, z = 0}") +
              test::support_text("wall.x-", "displacement = {x = 0, y = 0, z = 0}") +
              test::contact_text("floor.z+", "block.z-") + at_floor + test::contact_text("wall.x+", "block.x-") +
              at_wall);
    for (ContactPair& pair : g.p.pairs)
      for (std::size_t q = 0; q < pair.points.size(); ++q) pair.points.set_active(q, true);
    return Statics(g.scene, g.p.bodies, g.p.supports, g.p.pairs).loads_give(0, Vec3::UnitZ());
  };
  const std::string friction = "friction = 0.2\n";
  EXPECT_TRUE(given("", ""));
  EXPECT_FALSE(given("", friction));
  EXPECT_TRUE(given(friction, ""));
}

/// A block of 1 x 0.3 m on a wider foundation, `gap` above it, which nothing but contact holds along z and about y.
std::string on_foundation(const std::string& gap, const std::string& more) {
  return test::box_text("foundation", "[-0.5, 0, -0.2]", "[1.5, 0.3, 0]", 0.07, "grid = {offset = [0.2, 0.3, 0.6]}\n") +
         test::box_text("block", "[0, 0, \"" + gap + "\"]", "[1, 0.3, \"0.4+" + gap + "\"]", 0.11,
                        "grid = {offset = [0.3, 0.6, 0.2]}\n") +
         test::support_text("foundation.z-", "displacement = {x = 0, y = 0, z = 0}") +
         test::symmetry_text({"block.y-"}) + test::contact_text("foundation.z+", "block.z-") + more;
}

std::string load(const std::string& force, const std::string& at) {
  return "[[load]]\nface = \"block.z+\"\nforce = " + force + "\nat = " + at + "\n";
}

/// A rigid block of width b on a layer that takes no tension, loaded e > b/6 beside its middle, lifts off but for
/// 3 (b/2 - e) on the side of the load; groups are closed whole, so to one of them.
TEST(RigidContact, ClosesTheSideOfAnEccentricLoad) {
  OnGrids g(on_foundation("0", load("[0, 0, -1000]", "[0.8, 0.15, 0.4]")));
  ASSERT_TRUE(close_where_rigid_bodies_meet(g.p.bodies, g.p.supports, g.p.pairs));
  const ContactPair& pair = g.p.pairs[0];
  double closed = 0, leftmost = 1, all = 0;
  for (const ContactPoint& q : pair.points) {
    all += q.weight;
    if (!q.active) continue;
    closed += q.weight;
    leftmost = std::min(leftmost, q.x[0]);
  }
  EXPECT_NEAR(all, 0.3, 1e-12);
  EXPECT_NEAR(closed / 0.3, 3 * (0.5 - 0.3), 0.11);
  EXPECT_NEAR(leftmost, 0.4, 0.11);
}

/// A load in the middle closes all of a gap; a load that lifts the block has no balance, and the points stay.
TEST(RigidContact, ClosesAGapUnderALoadAndLeavesItUnderALift) {
  for (const bool lifted : {false, true}) {
    OnGrids g(on_foundation("1e-3", load(lifted ? "[0, 0, 1000]" : "[0, 0, -1000]", "[0.5, 0.15, 0.4]")));
    ContactPoints& points = g.p.pairs[0].points;
    for (std::size_t q = 0; q < points.size(); ++q) points.set_active(q, q % 2 == 0);
    EXPECT_EQ(close_where_rigid_bodies_meet(g.p.bodies, g.p.supports, g.p.pairs), !lifted);
    for (std::size_t q = 0; q < points.size(); ++q) ASSERT_EQ(points.active(q), !lifted || q % 2 == 0);
  }
}

/// The block sinks by the gap and by F over the stiffness of all groups; what lifts it is named, and opens the pair.
TEST(FloatingBodies, BalanceAForceOnTheirContact) {
  for (const double force : {-1e9, 1e9}) {
    OnGrids g(on_foundation("1e-3", load("[0, 0, " + std::to_string(force) + "]", "[0.5, 0.15, 0.4]")));
    const FloatingBodies floating(g.p.bodies, g.p.supports, g.p.pairs);
    EXPECT_TRUE(floating.any());
    EXPECT_FALSE(floating.floats(0));
    EXPECT_TRUE(floating.floats(1));
    const SmallZones zones(g.p.bodies, g.p.pairs, floating.displacement_driven_pairs(), g.scene.solver);
    const ContactPair& pair = g.p.pairs[0];
    std::vector<double> gap;
    double stiffness = 0;
    for (const ContactGroup& group : pair.groups) {
      gap.push_back(group.initial_gap);
      stiffness += pair.stiffness(group) * group.area;
    }
    const FloatingBodies::Balance balance =
        floating.balance(gap, std::vector<double>(pair.points.size(), 0.0), zones, {}, true);
    EXPECT_EQ(balance.found, force < 0);
    if (balance.found) {
      RigidMotion expected = RigidMotion::Zero();
      expected[2] = -1e-3 + force / stiffness;
      EXPECT_LT((balance.motions[1] - expected).norm(), rounding * 1e-3);
      EXPECT_LT(balance.motions[0].norm(), rounding * 1e-3);
    } else {
      EXPECT_EQ(floating.pairs_that_open(balance.unbalanced), std::vector<char>{1});
    }
  }
}

TEST(FloatingBodies, KnowWhatGivesTheForceOfTheirPairs) {
  const auto driven = [](const std::string& more) {
    const OnGrids g(on_foundation("0", more));
    return FloatingBodies(g.p.bodies, g.p.supports, g.p.pairs).displacement_driven_pairs().at(0);
  };
  EXPECT_EQ(driven(load("[0, 0, -1000]", "[0.5, 0.15, 0.4]")), DisplacementDriven::no);
  EXPECT_EQ(driven(""), DisplacementDriven::squeezed);
  EXPECT_EQ(driven(test::support_text("block.z+", "displacement = {x = 0, y = 0, z = -1e-6}")),
            DisplacementDriven::held);
}

/// A block that lies on a wider one.
std::string lying_block(const std::string& more) {
  return test::box_text("foundation", "[0, 0, -0.2]", "[1, 1, 0]", 0.11, "grid = {offset = [0.2, 0.3, 0.6]}\n") +
         test::box_text("block", "[0.3, 0.2, 0]", "[0.7, 0.8, 0.3]", 0.13, "grid = {offset = [0.3, 0.6, 0.2]}\n") +
         test::support_text("foundation.z-", "displacement = {x = 0, y = 0, z = 0}") +
         test::contact_text("foundation.z+", "block.z-") + more;
}

/// It drifts along the plane and about its normal, in the smaller cells, not off the plane; points that hold that leave
/// nothing free.
TEST(TangentialDrift, IsTheMotionAlongThePlane) {
  const OnGrids g(lying_block("[[load]]\nface = \"block.z+\"\npressure = 1e6\n"));
  const TangentialDrift drift(g.p.bodies, g.p.supports, g.p.pairs);
  const RigidComponent block = whole_bodies(g.p.bodies).list[1];
  std::vector<BodyMotion> motions(2);
  motions[1].centre = block.centre();
  const auto farthest = [&](int body, const Vec3& translation, const Vec3& rotation) {
    std::vector<BodyMotion> moved = motions;
    moved[body].translation = translation;
    moved[body].rotation = rotation;
    return drift.farthest(moved);
  };
  const Vec3 none = Vec3::Zero();
  EXPECT_NEAR(farthest(1, Vec3(0.03, -0.04, 0), none), 0.05 / 0.11, rounding);
  EXPECT_NEAR(farthest(1, none, Vec3(0, 0, -0.02)), 0.02 * block.size() / 0.11, rounding);
  EXPECT_LT(farthest(1, Vec3(0, 0, 0.1), Vec3(0.1, -0.2, 0)), rounding);
  EXPECT_LT(farthest(0, Vec3(0.1, 0, 0), none), rounding) << "the foundation is held";
  std::vector<SupportPoint> points = drift.hold(g.p.bodies);
  EXPECT_EQ(points.size(), 3u);
  for (const SupportPoint& p : points) {
    EXPECT_TRUE(p.holds_along_surface);
    EXPECT_EQ(p.body, 1);
    EXPECT_EQ(p.support, -1);
  }
  EXPECT_EQ(find_free_motions(g.p.bodies, g.p.supports, g.p.pairs).modes.cols(), 3);
  points.insert(points.end(), g.p.supports.begin(), g.p.supports.end());
  EXPECT_TRUE(find_free_motions(g.p.bodies, points, g.p.pairs).empty());
}

/// What a load drives is no drift: only what is across its force and moment is left.
TEST(TangentialDrift, LeavesOutWhatALoadDrives) {
  const Vec3 at(0.9, 0.1, 0.3);
  const OnGrids g(lying_block(load("[600, 800, -1000]", "[0.9, 0.1, 0.3]")));
  const TangentialDrift drift(g.p.bodies, g.p.supports, g.p.pairs);
  const RigidComponent block = whole_bodies(g.p.bodies).list[1];
  const Vec3 arm = at - block.centre();
  const Vec3 driven = Vec3(600, 800, (arm[0] * 800 - arm[1] * 600) / block.size()).normalized();  // x, y, about z
  const auto farthest = [&](const Vec3& moved) {
    std::vector<BodyMotion> motions(2);
    motions[1].centre = block.centre();
    motions[1].translation = Vec3(moved[0], moved[1], 0);
    motions[1].rotation = Vec3(0, 0, moved[2] / block.size());
    return drift.farthest(motions);
  };
  EXPECT_LT(farthest(driven), rounding);
  EXPECT_NEAR(farthest(Vec3::UnitX()), std::sqrt(1 - driven[0] * driven[0]) / 0.11, 1e-8);
  EXPECT_EQ(drift.hold(g.p.bodies).size(), 2u);
}

}  // namespace
}  // namespace cgcontact::test_motions
