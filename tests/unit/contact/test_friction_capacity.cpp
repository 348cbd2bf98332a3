/// Capacity of friction and what it carries: axes of faces, closed forms of whole scenes.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/results/estimates/friction_capacity.hpp"
#include "tests/support/input_errors.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_friction_capacity {
namespace {

using From = TorqueCapacity::From;

/// Points all over a surface of revolution about z through (1, 2, *), whose radius over height s in [0, 1] is given,
/// over some of the turn.
std::vector<PressedPoint> revolved(const std::function<double(double)>& radius, double turn, bool inside) {
  std::vector<PressedPoint> points;
  for (int i = 0; i < 24; ++i)
    for (int j = 0; j < 8; ++j) {
      const double angle = turn * (i + 0.5) / 24, s = (j + 0.5) / 8, e = 1e-6;
      const double slope = (radius(s + e) - radius(s - e)) / (2 * e), c = std::cos(angle), w = std::sin(angle);
      const Vec3 normal = (inside ? -1 : 1) * Vec3(c, w, -slope).normalized();
      points.push_back({Vec3(1, 2, 0) + Vec3(radius(s) * c, radius(s) * w, s), normal, 1 + 0.1 * j});
    }
  return points;
}

std::optional<TorqueCapacity> axis_of(const std::function<double(double)>& radius, double turn) {
  return axis_of_faces({revolved(radius, turn, false), revolved(radius, turn, true)}, {1.2, 2.1, 0.4}, {});
}

std::vector<PressedPoint> plane(const Vec3& normal) {
  std::vector<PressedPoint> points;
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) points.push_back({Vec3(1, 1, 1) + 0.3 * i * u + 0.2 * j * v, normal, 1});
  return points;
}

void expect_axis(const std::optional<TorqueCapacity>& found, const Vec3& point, const Vec3& direction, From from) {
  ASSERT_TRUE(found);
  EXPECT_LT(found->axis.direction.cross(direction).norm(), 1e-6);
  EXPECT_LT((found->axis.point - point).cross(direction).norm(), 1e-6);
  EXPECT_EQ(found->from, from);
}

TEST(FrictionCapacity, AxisOfFacesOfRevolution) {
  for (const double turn : {2 * pi, pi / 2}) {
    expect_axis(axis_of([](double) { return 0.5; }, turn), {1, 2, 0}, {0, 0, 1}, From::faces_of_revolution);
    expect_axis(axis_of([](double s) { return 0.5 + 0.2 * s; }, turn), {1, 2, 0}, {0, 0, 1}, From::faces_of_revolution);
    expect_axis(axis_of([](double s) { return 2 - std::sqrt(1 - 0.5 * s * s); }, turn), {1, 2, 0}, {0, 0, 1},
                From::faces_of_revolution);
  }
}

/// The axis of flat faces is anywhere: through the centre that is given.
TEST(FrictionCapacity, AxisOfFlatFaces) {
  const Vec3 n = Vec3(1, 2, 2) / 3, centre(1.1, 1.3, 0.8);
  const auto found = axis_of_faces({plane(n), plane(-n)}, centre, {});
  expect_axis(found, centre, n, From::flat_faces);
}

/// A sphere turns about any axis, a roller on a plane about none that both faces have, a box's corner about none.
TEST(FrictionCapacity, NoAxisOfFaces) {
  const auto ball = revolved([](double s) { return std::sqrt(1 - std::pow(s - 0.3, 2)); }, 2 * pi, false);
  EXPECT_FALSE(axis_of_faces({ball, ball}, Vec3::Zero(), {}));
  std::vector<PressedPoint> roller = revolved([](double) { return 0.5; }, 0.8, false);
  std::vector<PressedPoint> ground;
  for (const PressedPoint& point : roller) ground.push_back({point.x, Vec3(-1, 0, 0), point.area});
  EXPECT_FALSE(axis_of_faces({roller, ground}, Vec3::Zero(), {}));
  std::vector<PressedPoint> corner = plane({0, 0, 1});
  for (const Vec3& n : {Vec3(1, 0, 0), Vec3(0, 1, 0)})
    for (const PressedPoint& point : plane(n)) corner.push_back(point);
  EXPECT_FALSE(axis_of_faces({corner, corner}, Vec3::Zero(), {}));
}

/// A ball on a plane spins about the normal through its centre.
TEST(FrictionCapacity, AxisOfABallOnAPlane) {
  std::vector<PressedPoint> ball, ground;
  for (int i = 0; i < 6; ++i)
    for (int j = 1; j < 4; ++j) {
      const Vec3 d(0.05 * j * std::cos(i), 0.05 * j * std::sin(i), 0);
      const Vec3 out = Vec3(d[0], d[1], -std::sqrt(1 - d.squaredNorm()));
      ball.push_back({Vec3(3, 4, 1) + out, out, 1});
      ground.push_back({Vec3(3, 4, 0) + d, Vec3(0, 0, 1), 1});
    }
  expect_axis(axis_of_faces({ball, ground}, Vec3::Zero(), {}), {3, 4, 0}, {0, 0, 1}, From::faces_of_revolution);
}

/// In plane strain all rows lie in one plane, and turns about other axes are none.
TEST(FrictionCapacity, AxisInPlaneStrain) {
  std::vector<PressedPoint> circle;
  for (int i = 0; i < 24; ++i) {
    const Vec3 n(std::cos(i * pi / 12), std::sin(i * pi / 12), 0);
    circle.push_back({0.4 * n, n, 1});
  }
  EXPECT_FALSE(axis_of_faces({circle, circle}, Vec3::Zero(), {}));
  expect_axis(axis_of_faces({circle, circle}, Vec3::Zero(), Vec3(0, 0, 1)), {0, 0, 0}, {0, 0, 1},
              From::faces_of_revolution);
}

/// Facets of a twenty-fourth of a turn stand for a cylinder.
TEST(FrictionCapacity, AxisOfFacets) {
  std::vector<PressedPoint> facets;
  for (int i = 0; i < 24; ++i)
    for (const double side : {-0.6, 0.0, 0.6})
      for (const double z : {0.0, 0.5, 1.0}) {
        const double angle = i * pi / 12;
        const Vec3 n(std::cos(angle), std::sin(angle), 0), t(-n[1], n[0], 0);
        facets.push_back({0.5 * n + side * 0.5 * std::tan(pi / 24) * t + Vec3(0, 0, z), n, 1});
      }
  const auto found = axis_of_faces({facets, facets}, Vec3::Zero(), {});
  ASSERT_TRUE(found);
  EXPECT_LT(found->axis.direction.cross(Vec3(0, 0, 1)).norm(), 1e-6);
  EXPECT_LT(found->axis.point.head<2>().norm(), 1e-6);
}

/// A block of 20 x 10 x 10 mm on another one, pressed by 200 N and pushed and turned at its top: mu = 0.25.
std::string blocks(const std::string& load, const std::string& more = "") {
  return R"(
[[body]]
name = "lower"
shape = {name = "block", box = {min = [0, 0, 0], max = [0.02, 0.01, 0.01]}}
material = {E = 200e9, nu = 0}
cell_size = 2.3e-3
[[body]]
name = "upper"
shape = {name = "block", box = {min = [0, 0, 0.01], max = [0.02, 0.01, 0.02]}}
material = {E = 200e9, nu = 0}
cell_size = 1.9e-3
grid = {offset = [0.3, 0.6, 0.2]}
[[contact]]
faces = ["lower.block.z+", "upper.block.z-"]
friction = 0.25
)" + more +
         R"(
[[support]]
face = "lower.block.z-"
displacement = {x = 0, y = 0, z = 0}
[[load]]
face = "upper.block.z+"
)" + load;
}

const FrictionFigures& friction(const test::SolvedScene& solved) { return *solved.results().pairs[0].friction; }

/// Mean distance of a rectangle from its centre: (2 / (a b)) times the integral over an eighth ..., here by sums.
double mean_distance(double a, double b) {
  double sum = 0;
  const int n = 400;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) sum += std::hypot(a * ((i + 0.5) / n - 0.5), b * ((j + 0.5) / n - 0.5));
  return sum / (n * n);
}

/// The capacity is mu N, and exact; the push at the interface asks for 30 of 50 N and is what friction carries. Both
/// bodies are in balance with it, without anything else that holds.
TEST(FrictionCapacity, BlockPushedAlongAPlate) {
  const auto solved = test::run_text(blocks("force = [18, 24, -200]\nat = [0.01, 0.005, 0.01]\n"));
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const FrictionFigures& f = friction(*solved);
  EXPECT_NEAR(f.capacity, 50, 1e-5);  // linear tolerance
  EXPECT_DOUBLE_EQ(f.whole, f.capacity);
  ASSERT_TRUE(f.use);
  EXPECT_NEAR(*f.use, 0.6, 1e-6);
  EXPECT_LT((f.force - Vec3(18, 24, 0)).norm(), 1e-5);
  EXPECT_NEAR(f.stick_area + f.slip_area, 2e-4, 1e-9);
  ASSERT_TRUE(f.torque);
  EXPECT_EQ(f.torque->from, From::flat_faces);
  for (const BodyBalance& b : r.balance) {
    EXPECT_LT((b.loads + b.supports + b.contact).norm(), 1e-5);
    EXPECT_LT(b.holds.norm(), 1e-5);
  }
  EXPECT_LT((r.balance[1].contact - Vec3(-18, -24, 200)).norm(), 1e-5);
}

/// Uniform pressure: mu N times the mean distance from the centre. Below that the block holds, above it slides, with
/// how much more the load needs.
TEST(FrictionCapacity, BlockTurnedOnAPlate) {
  const double capacity = 50 * mean_distance(0.02, 0.01);
  const auto turned = [&](double fraction) {
    return test::run_text(
        blocks("force = [0, 0, -200]\nmoment = [0, 0, " + std::to_string(fraction * capacity) + "]\n"));
  };
  const auto holds = turned(0.9);
  ASSERT_TRUE(holds->results().converged) << holds->results().diagnosis;
  EXPECT_NEAR(friction(*holds).torque->capacity / capacity, 1, 2e-3);
  // The shear of points of one group differs, its slip does not: they add up to the torque but for a fraction of a
  // cell.
  EXPECT_NEAR(*friction(*holds).use / 0.9, 1, 5e-3);
  EXPECT_NEAR(std::abs(friction(*holds).torque->carried) / (0.9 * capacity), 1, 5e-3);
  const auto slides = turned(1.1);
  EXPECT_FALSE(slides->results().converged);
  expect_contains(slides->results().diagnosis, {"slides on", "all over", "the loads need 1.1 times"});
}

/// A weight on an incline holds up to tan(angle) = mu = 0.25.
TEST(FrictionCapacity, BlockOnAnIncline) {
  const auto at_slope = [](const char* along) {
    std::string text = blocks("pressure = 0\n");
    text.replace(text.find("grid = "), 0, "body_force = [" + std::string(along) + ", 0, -1e6]\n");
    return test::run_text(text);
  };
  const auto holds = at_slope("2.3e5");
  ASSERT_TRUE(holds->results().converged) << holds->results().diagnosis;
  EXPECT_NEAR(*friction(*holds).use, 0.92, 1e-5);
  EXPECT_EQ(holds->results().verdict.spring_share, 0);
  const auto slides = at_slope("2.7e5");
  EXPECT_FALSE(slides->results().converged);
  expect_contains(slides->results().diagnosis, {"slides on", "the loads need 1.08"});
}

/// A block between two: both pairs carry the push together.
TEST(FrictionCapacity, TwoPairsShare) {
  std::string text = blocks("pressure = 1e6\n", R"(
[[body]]
name = "top"
shape = {name = "block", box = {min = [0, 0, 0.02], max = [0.02, 0.01, 0.03]}}
material = {E = 200e9, nu = 0}
cell_size = 2.1e-3
[[contact]]
faces = ["upper.block.z+", "top.block.z-"]
friction = 0.1
[[support]]
face = "top.block.z+"
displacement = {x = 0, y = 0}
[[load]]
face = "upper.block.x-"
force = [28, 0, 0]
)");
  text.replace(text.rfind("upper.block.z+"), 14, "top.block.z+");
  const auto solved = test::run_text(text);
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  EXPECT_NEAR(r.pairs[0].friction->capacity, 50, 1e-4);
  EXPECT_NEAR(r.pairs[1].friction->capacity, 20, 1e-4);
  Vec3 sum = Vec3::Zero();
  for (const PairFigures& pair : r.pairs) {
    EXPECT_LT(*pair.friction->use, 1);
    sum += (pair.body_first == "upper" ? 1 : -1) * pair.friction->force;
  }
  EXPECT_LT((sum - Vec3(-28, 0, 0)).norm(), 1e-4);
}

/// Without friction the same blocks are a mistake, and a coefficient of zero is none: the same bits.
TEST(FrictionCapacity, WithoutFrictionNothingChanges) {
  const auto refusal = [](const std::string& text) { return message_of([&] { test::run_text(text); }); };
  std::string without = blocks("force = [18, 24, -200]\n");
  without.replace(without.find("friction = 0.25"), 15, "friction = 0");
  EXPECT_NE(refusal(without).find("and the loads drive it"), std::string::npos) << refusal(without);
  const auto zero = test::run_scene("scenes/hertz.toml", {"n=10", "contact.0.friction=0"});
  const auto none = test::run_scene("scenes/hertz.toml", {"n=10"});
  ASSERT_EQ(zero->results().contact_rows.size(), none->results().contact_rows.size());
  for (std::size_t i = 0; i < zero->results().contact_rows.size(); ++i)
    EXPECT_EQ(zero->results().contact_rows[i].pressure_sprc, none->results().contact_rows[i].pressure_sprc);
  EXPECT_EQ(zero->results().outer_residuals, none->results().outer_residuals);
  EXPECT_FALSE(zero->results().pairs[0].friction);
}

/// 3 pi/16 mu F a of the whole zone, a from Hertz at the force of the run; a quarter is modelled.
TEST(FrictionCapacity, HertzTorque) {
  const auto solved = test::run_scene("scenes/hertz.toml", {"n=25", "contact.0.friction=0.3"});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged);
  const FrictionFigures& f = friction(*solved);
  const double force = 4 * r.pairs[0].zone.normal_force, a = *r.pairs[0].zone.hertz->a;
  EXPECT_NEAR(f.whole / (0.3 * force), 1, 1e-12);
  ASSERT_TRUE(f.torque);
  const double exact = 3 * pi / 16 * 0.3 * force * a;
  std::printf("Hertz torque / exact - 1: %.3g, estimated %.3g\n", f.torque->whole / exact - 1, *f.torque->error);
  EXPECT_NEAR(f.torque->whole / exact, 1, 0.01);
  EXPECT_NEAR(f.torque->whole / (4 * f.torque->capacity), 1, 1e-6);
}

/// A rigid flat punch, p = F / (2 pi a sqrt(a^2 - r^2)): mu F a pi/4, though the pressure has no finite value at the
/// rim. A quarter is modelled; 0.8 % off with ten cells over the radius.
TEST(FrictionCapacity, FlatPunch) {
  std::string text = R"(
[[body]]
name = "block"
shape = {name = "block", box = {min = [0, 0, -0.1], max = [0.1, 0.1, 0]}}
material = {E = 200e9, nu = 0.3}
cell_size = 8e-3
refine = [{sphere = {center = [0, 0, 0], radius = 0.01}, size = 1e-3, distance = 3e-3}]
[[body]]
name = "punch"
rigid = true
shape = {intersection = [{name = "quarter", box = {min = [0, 0, 0], max = [1, 1, 0.01]}},
                         {name = "round", cylinder = {base = [0, 0, 0], top = [0, 0, 0.02], radius = 0.01}}]}
[[load]]
face = "punch.quarter.z+"
force = [0, 0, -25000]
[[contact]]
faces = ["block.block.z+", "punch.quarter.z-"]
friction = 0.2
[[support]]
face = "block.block.z-"
displacement = {x = 0, y = 0, z = 0}
)";
  for (const char* face : {"block.block.x-", "block.block.y-", "punch.quarter.x-", "punch.quarter.y-"})
    text += "[[support]]\nface = \"" + std::string(face) + "\"\nsymmetry = true\n";
  const auto solved = test::run_text(text, {});
  ASSERT_TRUE(solved->results().converged) << solved->results().diagnosis;
  const FrictionFigures& f = friction(*solved);
  EXPECT_NEAR(f.whole, 0.2 * 1e5, 1e-4);
  ASSERT_TRUE(f.torque);
  const double error = std::abs(f.torque->whole / (0.2 * 1e5 * 0.01 * pi / 4) - 1);
  ASSERT_TRUE(f.torque->error);
  std::printf("torque of a flat punch off by %.5f, estimated %.3f\n", error, *f.torque->error);
  EXPECT_LT(error, 0.01);
  EXPECT_LT(error, *f.torque->error);
}

/// About an axis 1 m aside the regions behind the planes of symmetry have other distances than the quarter that is
/// modelled, whose centre of pressure is 3 a/8 nearer.
TEST(FrictionCapacity, WholeZoneAboutAnAxisAside) {
  const auto solved =
      test::run_scene("scenes/hertz.toml", {"n=15", "contact.0.friction=0.3", "contact.0.moment_about.point=[1, 0, 0]",
                                            "contact.0.moment_about.axis=[0, 0, 1]"});
  ASSERT_TRUE(solved->results().converged);
  const FrictionFigures& f = friction(*solved);
  ASSERT_TRUE(f.torque);
  EXPECT_EQ(f.torque->from, From::scene);
  const double a = *solved->results().pairs[0].zone.hertz->a;
  // The rest of the mean distance: half of the mean square of y, a^2/10.
  EXPECT_NEAR(f.torque->whole / f.whole, 1 + a * a / 10, 2e-4);
  EXPECT_NEAR(f.torque->capacity / f.capacity, 1 - 3 * a / 8 + a * a / 10, 1e-3);
}

/// With hardly any friction the pressure is Lame's on all of the face, like the square of a cell: 2 pi r L mu p.
TEST(FrictionCapacity, PressFitWithHardlyAnyFriction) {
  double before = 0;
  for (const char* n : {"n=8", "n=16"}) {
    const auto solved = test::run_scene("scenes/press_fit_torque.toml", {n, "mu=1e-3", "T=1"});
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    const double pressure = 210e9 * 16.66667e-6 / 0.04 * 0.75, pull_out = 2 * pi * 0.02 * 0.02 * 1e-3 * pressure;
    const double error = friction(*solved).capacity / pull_out - 1;
    std::printf("%s: capacity %.3g off, estimated %.3g\n", n, error, *friction(*solved).error);
    EXPECT_LT(std::abs(error), 0.01);
    if (before > 0) {
      EXPECT_LT(std::abs(error), 0.6 * before);
    }
    before = std::abs(error);
  }
}

/// 81 % of the torque is carried and 1.02 of it slides, although the ends slip along the axis as the shaft is pressed
/// in. That friction makes the pressure 1 % larger than Lame's.
TEST(FrictionCapacity, PressFit) {
  for (const char* n : {"n=8", "n=16"}) {
    const auto solved = test::run_scene("scenes/press_fit_torque.toml", {n});
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    const FrictionFigures& f = friction(*solved);
    const double p = 210e9 * 16.66667e-6 / 0.04 * 0.75, pull_out = 2 * pi * 0.02 * 0.02 * 0.15 * p;
    const double error = f.capacity / pull_out - 1;
    std::printf("%s: capacity %.3g off, estimated %.3g; torque %.3g off, estimated %.3g; use %.6g\n", n, error,
                *f.error, f.torque->capacity / (0.02 * pull_out) - 1, *f.torque->error, *f.use);
    EXPECT_LT(std::abs(error), 0.02);
    EXPECT_NEAR(f.torque->capacity / (0.02 * f.capacity), 1, 1e-3);
    EXPECT_EQ(f.torque->from, From::faces_of_revolution);
    EXPECT_NEAR(std::abs(f.torque->carried) / 400, 1, 1e-3);
    EXPECT_NEAR(*f.use * f.torque->capacity / 400, 1, 2e-3);
  }
  const auto slides = test::run_scene("scenes/press_fit_torque.toml", {"T=510"});
  EXPECT_FALSE(slides->results().converged);
  expect_contains(slides->results().diagnosis, {"\"shaft\" slides on \"hub\""});
}

/// Pull-out of the same fit: sliding along the axis.
TEST(FrictionCapacity, PullOut) {
  const auto pulled = [](const char* force) {
    return test::run_scene("scenes/press_fit_torque.toml", {"load.0.moment=[0,0,0]", force});
  };
  const auto holds = pulled("load.0.force=[0, 0, 2.3e4]");
  ASSERT_TRUE(holds->results().converged) << holds->results().diagnosis;
  EXPECT_NEAR(*friction(*holds).use * friction(*holds).capacity / 2.3e4, 1, 1e-3);
  EXPECT_FALSE(pulled("load.0.force=[0, 0, 2.6e4]")->results().converged);
}

}  // namespace
}  // namespace cgcontact::test_friction_capacity
