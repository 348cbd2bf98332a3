/// Planes of symmetry and images behind them, connected sets of points, tangents.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "recovery/face/connected_sets.hpp"
#include "recovery/face/symmetry_planes.hpp"
#include "recovery/patch/tangents.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test_symmetry_planes {
namespace {

/// Boundary data of a box: the conditions of its faces, by their outward normals (global axes); others are free.
BoundaryData conditions_of(const CutCells& cells, const std::vector<std::pair<Vec3, TractionCondition>>& faces) {
  BoundaryData boundary;
  boundary.conditions.emplace_back();
  for (const auto& face : faces) boundary.conditions.push_back(face.second);
  for (const Vec3& n : cells.boundary.normal) {
    int condition = 0;
    for (std::size_t f = 0; f < faces.size(); ++f)
      if ((cells.grid.rotation * n).dot(faces[f].first) > 0.99) condition = static_cast<int>(f) + 1;
    boundary.condition_of_point.push_back(condition);
  }
  return boundary;
}

/// A face is one if its normal is held and nothing else: held as such, or as the component along an axis; in any grid.
TEST(SymmetryPlanes, AreFacesWhoseNormalAloneIsHeld) {
  const Solid box = Solid::box(Vec3(0.1, 0.2, 0.3), Vec3(0.9, 0.7, 0.8), "box");
  TractionCondition normal, x, x_and_y, loaded;
  normal.normal_held = true;
  x.component_held[0] = true;
  x_and_y.component_held = {true, true, false};
  loaded.traction = [](const Vec3&, const Vec3&) { return Vec3(1, 2, 3); };
  const CutCells cells = test::cut(box, test::odd_grid(5, 0.4));
  const auto planes_of = [&](const std::vector<std::pair<Vec3, TractionCondition>>& faces) {
    return symmetry_planes(cells, conditions_of(cells, faces));
  };
  for (const TractionCondition& held : {normal, x}) {
    const std::vector<SymmetryPlane> planes = planes_of({{-Vec3::UnitX(), held}, {Vec3::UnitZ(), loaded}});
    ASSERT_EQ(planes.size(), 1u);
    EXPECT_LT((planes[0].normal + Vec3::UnitX()).norm(), 1e-13);
    EXPECT_NEAR(planes[0].distance(Vec3(0.4, 5, 6)), -0.3, 1e-13) << "inside of the face at x = 0.1";
    EXPECT_LT((planes[0].image(Vec3(0.4, 5, 6)) - Vec3(-0.2, 5, 6)).norm(), 1e-13);
    EXPECT_LT((planes[0].turned(Vec3(1, 2, 3)) - Vec3(-1, 2, 3)).norm(), 1e-13);
  }
  EXPECT_TRUE(planes_of({{-Vec3::UnitX(), x_and_y}}).empty());
  EXPECT_TRUE(planes_of({{-Vec3::UnitY(), x}}).empty()) << "held along the face";
  EXPECT_EQ(planes_of({{-Vec3::UnitX(), normal}, {Vec3::UnitX(), x}, {-Vec3::UnitY(), normal}}).size(), 3u);
}

/// The side of a cylinder is none.
TEST(SymmetryPlanes, AreNoCurvedFaces) {
  const Solid cylinder = Solid::cylinder(Vec3(0.5, 0.5, 0.2), Vec3(0.5, 0.5, 0.8), 0.3, "rod");
  const CutCells cells = test::cut(cylinder, test::odd_grid(5, 0.4));
  BoundaryData boundary;
  boundary.conditions.resize(1);
  boundary.conditions[0].normal_held = true;
  boundary.condition_of_point.assign(cells.boundary.size(), 0);
  const std::vector<SymmetryPlane> planes = symmetry_planes(cells, boundary);
  ASSERT_EQ(planes.size(), 2u) << "bottom and top";
  for (const SymmetryPlane& plane : planes) EXPECT_NEAR(std::abs(plane.normal[2]), 1, 1e-13);
}

const SymmetryPlane left{Vec3(1, 0, 0), -Vec3::UnitX()}, right{Vec3(4, 0, 0), Vec3::UnitX()},
    front{Vec3(0, -2, 0), -Vec3::UnitY()}, low{Vec3(0, 0, 3), -Vec3::UnitZ()};

/// Two planes across each other make four quarters, three eight octants; two that are parallel one image each.
TEST(SymmetryPlanes, CompleteAPointByItsImages) {
  const Vec3 x(1.5, 0, 3.25);
  const auto has = [](const std::vector<Vec3>& all, const Vec3& y) {
    return std::any_of(all.begin(), all.end(), [&](const Vec3& z) { return (y - z).norm() < 1e-14; });
  };
  EXPECT_EQ(with_images(x, {}), std::vector<Vec3>{x});
  const std::vector<Vec3> quarters = with_images(x, {left, front});
  ASSERT_EQ(quarters.size(), 4u);
  for (const Vec3& y : {x, Vec3(0.5, 0, 3.25), Vec3(1.5, -4, 3.25), Vec3(0.5, -4, 3.25)})
    EXPECT_TRUE(has(quarters, y)) << y.transpose();
  const std::vector<Vec3> octants = with_images(x, {left, front, low});
  ASSERT_EQ(octants.size(), 8u);
  EXPECT_TRUE(has(octants, Vec3(0.5, -4, 2.75)));
  const std::vector<Vec3> slice = with_images(x, {left, right});
  ASSERT_EQ(slice.size(), 3u);
  EXPECT_TRUE(has(slice, Vec3(0.5, 0, 3.25)) && has(slice, Vec3(6.5, 0, 3.25)));
}

/// The same plane, wherever its point lies on it; not the other side of it, nor one beside it.
TEST(SymmetryPlanes, OfTwoBodiesAreThoseThatBothHave) {
  const SymmetryPlane moved_along{Vec3(1, 7, -8), left.normal}, opposite{left.point, -left.normal},
      beside{left.point + 1e-3 * left.normal, left.normal};
  const std::vector<SymmetryPlane> common = common_planes({left, front, left}, {low, moved_along}, 0.1);
  ASSERT_EQ(common.size(), 1u) << "each once";
  EXPECT_EQ(common[0].normal, left.normal);
  EXPECT_TRUE(common_planes({left}, {opposite, beside, front}, 0.1).empty());
}

/// Points in a row with one gap, and one beside, in any order: each has the first of those that it is joined to.
TEST(ConnectedSets, EndAtGaps) {
  const std::vector<double> position{5, 0, 1, 6, 2, 9, 3};
  const std::vector<int> first = connected_sets(
      position.size(), 1.5, [&](std::size_t i) { return Vec3(100, position[i], -3); },
      [&](int i, int k) { return std::abs(position[i] - position[k]) < 1.2; });
  EXPECT_EQ(first, (std::vector<int>{0, 1, 1, 0, 1, 5, 1}));
  // Near ones that are not joined are apart.
  const std::vector<int> parity = connected_sets(
      position.size(), 2.5, [&](std::size_t i) { return Vec3(100, position[i], -3); },
      [&](int i, int k) {
        const double apart = std::abs(position[i] - position[k]);
        return apart < 2.2 && std::abs(std::remainder(apart, 2.0)) < 0.5;
      });
  EXPECT_EQ(parity, (std::vector<int>{0, 1, 0, 3, 1, 5, 0}));
}

/// (n, t1, t2) is orthonormal and right-handed for all normals, and next to an axis as on it.
TEST(Tangents, CompleteANormalToARightHandedFrame) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<Vec3> all;
  for (int k = 0; k < 3; ++k)
    for (const double sign : {-1.0, 1.0}) {
      all.push_back(sign * Vec3::Unit(k));
      all.push_back((sign * Vec3::Unit(k) + Vec3(1e-9, -1e-9, 1e-9)).normalized());
      EXPECT_LT((tangents(all[all.size() - 1]).first - tangents(all[all.size() - 2]).first).norm(), 1e-8);
    }
  for (int k = 0; k < 100; ++k) all.push_back(Vec3(normal(random), normal(random), normal(random)).normalized());
  for (const Vec3& n : all) {
    const auto [t1, t2] = tangents(n);
    Mat3 frame;
    frame << n, t1, t2;
    EXPECT_LT((frame.transpose() * frame - Mat3::Identity()).norm(), 1e-14);
    EXPECT_NEAR(frame.determinant(), 1, 1e-14);
  }
}

}  // namespace
}  // namespace cgcontact::test_symmetry_planes
