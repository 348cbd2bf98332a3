/// Capacity of friction: axes of faces, the limit over motions, and closed forms of whole scenes.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/results/friction_capacity.hpp"
#include "tests/support/input_errors.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_friction_capacity {
namespace {

using From = TorqueCapacity::From;

/// Places all over a surface of revolution about z through (1, 2, *), whose radius over height s in [0, 1] is given,
/// over some of the turn.
std::vector<PressedPlace> revolved(const std::function<double(double)>& radius, double turn, bool inside) {
  std::vector<PressedPlace> places;
  for (int i = 0; i < 24; ++i)
    for (int j = 0; j < 8; ++j) {
      const double angle = turn * (i + 0.5) / 24, s = (j + 0.5) / 8, e = 1e-6;
      const double slope = (radius(s + e) - radius(s - e)) / (2 * e), c = std::cos(angle), w = std::sin(angle);
      const Vec3 normal = (inside ? -1 : 1) * Vec3(c, w, -slope).normalized();
      places.push_back({Vec3(1, 2, 0) + Vec3(radius(s) * c, radius(s) * w, s), normal, 1 + 0.1 * j});
    }
  return places;
}

std::optional<TorqueCapacity> axis_of(const std::function<double(double)>& radius, double turn) {
  return axis_of_faces({revolved(radius, turn, false), revolved(radius, turn, true)}, {1.2, 2.1, 0.4}, {});
}

std::vector<PressedPlace> plane(const Vec3& normal) {
  std::vector<PressedPlace> places;
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) places.push_back({Vec3(1, 1, 1) + 0.3 * i * u + 0.2 * j * v, normal, 1});
  return places;
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
  std::vector<PressedPlace> roller = revolved([](double) { return 0.5; }, 0.8, false);
  std::vector<PressedPlace> ground;
  for (const PressedPlace& place : roller) ground.push_back({place.x, Vec3(-1, 0, 0), place.area});
  EXPECT_FALSE(axis_of_faces({roller, ground}, Vec3::Zero(), {}));
  std::vector<PressedPlace> corner = plane({0, 0, 1});
  for (const Vec3& n : {Vec3(1, 0, 0), Vec3(0, 1, 0)})
    for (const PressedPlace& place : plane(n)) corner.push_back(place);
  EXPECT_FALSE(axis_of_faces({corner, corner}, Vec3::Zero(), {}));
}

/// A ball on a plane spins about the normal through its centre.
TEST(FrictionCapacity, AxisOfABallOnAPlane) {
  std::vector<PressedPlace> ball, ground;
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
  std::vector<PressedPlace> circle;
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
  std::vector<PressedPlace> facets;
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

/// Motions of a flat ring: two translations and a turn.
std::vector<Eigen::MatrixXd> ring(double weight, double radius, int count) {
  std::vector<Eigen::MatrixXd> rows;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * pi * (i + 0.5) / count;
    Eigen::MatrixXd row(3, 3);
    row << 1, 0, -radius * std::sin(angle), 0, 1, radius * std::cos(angle), 0, 0, 0;
    rows.push_back(weight / count * row);
  }
  return rows;
}

/// A force alone slides the ring, a moment alone turns it about its centre. With both the most of the ratio is above
/// each of them and below their sum; all motions give less.
TEST(FrictionCapacity, LimitOfAFlatRing) {
  const auto rows = ring(8, 0.5, 400);
  EXPECT_NEAR(largest_ratio(Eigen::Vector3d(4, 0, 0), rows).first, 0.5, 1e-8);
  EXPECT_NEAR(largest_ratio(Eigen::Vector3d(0, 0, 1), rows).first, 0.25, 1e-8);
  const Eigen::Vector3d load(4, 0, 1);
  const auto [most, motion] = largest_ratio(load, rows);
  EXPECT_GT(most, 0.5);
  EXPECT_LT(most, 0.75);
  const auto ratio = [&](const Eigen::VectorXd& v) {
    double sum = 0;
    for (const Eigen::MatrixXd& row : rows) sum += (row * v).norm();
    return load.dot(v) / sum;
  };
  EXPECT_NEAR(ratio(motion), most, 1e-9);
  for (int i = 0; i < 500; ++i) {
    const double a = 0.7 * i, b = 0.013 * i;
    EXPECT_LT(ratio(Eigen::Vector3d(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b))),
              most * (1 + 1e-6));
  }
}

TEST(FrictionCapacity, LimitWithoutResistance) {
  EXPECT_TRUE(std::isinf(largest_ratio(Eigen::Vector3d(1, 0, 0), {}).first));
  Eigen::MatrixXd row = Eigen::MatrixXd::Zero(3, 2);
  row(0, 0) = 1;
  EXPECT_TRUE(std::isinf(largest_ratio(Eigen::Vector2d(1, 1), {row}).first));
  EXPECT_NEAR(largest_ratio(Eigen::Vector2d(3, 0), {row}).first, 3, 1e-12);
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

/// The capacity is mu N, and exact; the push asks for 30 of 50 N. The torque capacity is that of a pressure whose
/// centre the push at the interface does not move. Both bodies are in balance with the traction in the place of
/// friction.
TEST(FrictionCapacity, BlockPushedAlongAPlate) {
  const auto solved = test::run_text(blocks("force = [18, 24, -200]\nat = [0.01, 0.005, 0.01]\n"));
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const FrictionFigures& f = friction(*solved);
  EXPECT_NEAR(f.capacity, 50, 1e-8);
  EXPECT_LT(*f.error, 1e-6);
  EXPECT_DOUBLE_EQ(f.whole, f.capacity);
  ASSERT_TRUE(f.use);
  EXPECT_NEAR(*f.use, 0.6, 1e-6);
  EXPECT_EQ(verdict_on(f).substr(0, 27), "friction could carry it, 60");
  EXPECT_TRUE(sliding_warnings(r).empty());
  ASSERT_TRUE(f.torque);
  EXPECT_EQ(f.torque->from, From::flat_faces);
  EXPECT_LT(f.torque->axis.direction.cross(Vec3(0, 0, 1)).norm(), 1e-9);
  EXPECT_LT((f.torque->axis.point - Vec3(0.01, 0.005, 0.01)).norm(), 1e-6);
  for (const BodyBalance& b : r.balance) {
    EXPECT_LT((b.loads + b.friction + b.supports + b.contact).norm(), 1e-6);
    EXPECT_LT(b.holds.norm(), 1e-6);
  }
  EXPECT_LT((r.balance[1].friction - Vec3(-18, -24, 0)).norm(), 1e-8);
  EXPECT_LT((r.balance[0].friction + r.balance[1].friction).norm(), 1e-8);
}

/// Uniform pressure: mu N times the mean distance from the centre. Above capacity the block slides, with a warning
/// first.
TEST(FrictionCapacity, BlockTurnedOnAPlate) {
  const double capacity = 50 * mean_distance(0.02, 0.01);
  for (const double part : {0.9, 1.1}) {
    const auto solved =
        test::run_text(blocks("force = [0, 0, -200]\nmoment = [0, 0, " + std::to_string(part * capacity) + "]\n"));
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    const FrictionFigures& f = friction(*solved);
    EXPECT_NEAR(f.torque->capacity / capacity, 1, 2e-3);
    EXPECT_NEAR(*f.use / part, 1, 2e-3);
    EXPECT_EQ(sliding_warnings(r).size(), part > 1 ? 1u : 0u);
    EXPECT_EQ(std::any_of(r.warnings.begin(), r.warnings.end(),
                          [](const std::string& w) { return w.find("slides: friction cannot carry it") < w.size(); }),
              part > 1);
  }
}

/// A weight on an incline: tan(angle) over mu, here 0.3 / 0.25.
TEST(FrictionCapacity, BlockOnAnIncline) {
  std::string text = blocks("pressure = 0\n");
  text.replace(text.find("grid = "), 0, "body_force = [3e5, 0, -1e6]\n");
  const auto solved = test::run_text(text);
  ASSERT_TRUE(solved->results().converged) << solved->results().diagnosis;
  EXPECT_NEAR(*friction(*solved).use, 1.2, 1e-6);
}

/// A block between two: both pairs carry the push together, with what each has.
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
  EXPECT_NEAR(r.pairs[0].friction->capacity, 50, 1e-7);
  EXPECT_NEAR(r.pairs[1].friction->capacity, 20, 1e-7);
  for (const PairFigures& pair : r.pairs) EXPECT_NEAR(*pair.friction->use, 0.4, 1e-6);
}

/// Needs of a scene besides friction are asked for as before; two blocks that slide on each other and nothing drives
/// them are held.
TEST(FrictionCapacity, MistakesOfPushedBlocks) {
  const auto refusal = [](const std::string& text) { return message_of([&] { test::run_text(text); }); };
  const std::string pushed = blocks("force = [18, 24, -200]\n");
  std::string without = pushed;
  without.replace(without.find("friction = 0.25"), 15, "friction = 0");
  EXPECT_NE(refusal(without).find("and the loads drive it"), std::string::npos) << refusal(without);
  EXPECT_EQ(refusal(without).find("friction is no part"), std::string::npos);
  const std::string spin = message_of([&] {
    test::run_scene("tests/scenes/ball_in_groove.toml", {"spin=1e6", "contact.0.friction=0.2"});
  });
  expect_contains(spin, {"and the loads drive it", "friction is no part of the solve"});
  const auto held = test::run_text(blocks("pressure = 1e6\n"));
  ASSERT_TRUE(held->results().converged);
  EXPECT_FALSE(friction(*held).use);
  EXPECT_NEAR(friction(*held).capacity, 50, 1e-8);
}

/// The frictionless figures of a scene do not change by a bit.
TEST(FrictionCapacity, SolveKnowsNothingOfFriction) {
  const auto with = test::run_scene("scenes/hertz.toml", {"n=10", "contact.0.friction=0.3"});
  const auto without = test::run_scene("scenes/hertz.toml", {"n=10"});
  ASSERT_TRUE(with->results().pairs[0].friction);
  ASSERT_FALSE(without->results().pairs[0].friction);
  ASSERT_EQ(with->results().contact_rows.size(), without->results().contact_rows.size());
  for (std::size_t i = 0; i < with->results().contact_rows.size(); ++i) {
    EXPECT_EQ(with->results().contact_rows[i].pressure_sprc, without->results().contact_rows[i].pressure_sprc);
    EXPECT_EQ(with->results().contact_rows[i].stress_raw, without->results().contact_rows[i].stress_raw);
  }
  EXPECT_EQ(with->results().pairs[0].force_on_first, without->results().pairs[0].force_on_first);
  EXPECT_EQ(with->results().outer_residuals, without->results().outer_residuals);
  EXPECT_EQ(with->results().warnings, without->results().warnings);
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

/// A rigid flat punch, p = F / (2 pi a sqrt(a^2 - r^2)): mu F a pi/4, though the pressure at the rim is not resolved. A
/// quarter is modelled; 0.05 % off with ten cells over the radius.
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
  EXPECT_NEAR(f.torque->whole / (0.2 * 1e5 * 0.01 * pi / 4), 1, 0.01);
  EXPECT_FALSE(f.torque->error);
}

/// About an axis 1 m aside the parts behind the planes of symmetry have other distances than the quarter that is
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

/// Lame's pressure on all of the face: 2 pi r L mu p and 2 pi r^2 L mu p. A torque of 400 N m asks for 81 % of it.
TEST(FrictionCapacity, PressFit) {
  double before = 0;
  for (const char* n : {"n=8", "n=16"}) {
    const auto solved = test::run_scene("scenes/press_fit_torque.toml", {n});
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    const FrictionFigures& f = friction(*solved);
    const double p = 210e9 * 16.66667e-6 / 0.04 * 0.75, pull_out = 2 * pi * 0.02 * 0.02 * 0.15 * p;
    const double error = f.capacity / pull_out - 1;
    std::printf("%s: capacity %.3g off, estimated %.3g; torque %.3g off, estimated %.3g; use %.6g\n", n, error,
                *f.error, f.torque->capacity / (0.02 * pull_out) - 1, *f.torque->error, *f.use);
    EXPECT_LT(std::abs(error), 0.01);
    EXPECT_NEAR(f.torque->capacity / (0.02 * f.capacity), 1, 1e-3);
    EXPECT_EQ(f.torque->from, From::faces_of_revolution);
    EXPECT_NEAR(*f.use * f.torque->capacity / 400, 1, 2e-3);
    if (before > 0) {
      EXPECT_LT(std::abs(error), 0.6 * before);
    }
    before = std::abs(error);
  }
}

/// Pull-out of the same fit: sliding along the axis.
TEST(FrictionCapacity, PullOut) {
  const auto solved =
      test::run_scene("scenes/press_fit_torque.toml", {"load.0.moment=[0,0,0]", "load.0.force=[0, 0, 1e4]"});
  ASSERT_TRUE(solved->results().converged) << solved->results().diagnosis;
  const FrictionFigures& f = friction(*solved);
  ASSERT_TRUE(f.use);
  EXPECT_NEAR(*f.use * f.capacity / 1e4, 1, 1e-3);
}

}  // namespace
}  // namespace cgcontact::test_friction_capacity
