/// The square-root term at the edge of a contact zone: equilibrium, boundary conditions, integrals.
#include <gtest/gtest.h>

#include <random>

#include "core/quadrature/gauss_rules.hpp"
#include "recovery/patch/edge_moments.hpp"
#include "recovery/patch/known_pressures.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test_contact_edge {
namespace {

/// An edge on the plane through `point` with outward normal n.
ContactEdge plane_edge(const Vec3& point, const Vec3& n, double scale = 1) {
  ContactEdge edge;
  edge.surface.kind = Surface::Kind::plane;
  edge.surface.point = point;
  edge.surface.direction = n;
  edge.origin = point;
  edge.closed = n.unitOrthogonal();
  edge.along = n.cross(edge.closed);
  edge.scale = scale;
  edge.inverse_width = 0.1;
  edge.poisson_ratio = 0.3;
  return edge;
}

Mat3 stress_at(const ContactEdge& edge, const Vec3& x) {
  Sym3 s;
  edge.stress(x, s.data());
  return tensor(s);
}

const Vec3 normal = Vec3(1, -2, 3).normalized(), point(0.3, 0.2, -0.4);

/// div sigma by central differences, step 1e-5: rounding 1e-11, truncation 1e-10 times the third derivatives (< 100 at
/// distances above 0.3).
TEST(ContactEdge, IsInEquilibrium) {
  const ContactEdge edge = plane_edge(point, normal, 1.7);
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 100; ++i) {
    const Vec3 x = point - (0.3 + std::abs(uniform(generator))) * normal + uniform(generator) * edge.closed +
                   uniform(generator) * edge.along;
    Vec3 divergence = Vec3::Zero();
    constexpr double step = 1e-5;
    for (int j = 0; j < 3; ++j) {
      const Vec3 d = step * Vec3::Unit(j);
      divergence += (stress_at(edge, x + d) - stress_at(edge, x - d)).col(j) / (2 * step);
    }
    EXPECT_LT(divergence.norm(), 1e-8);
  }
}

/// On the face: no shear, the square root of the distance inside, nothing at all outside; so for a body on either side.
TEST(ContactEdge, CarriesTheSquareRootInsideAndNothingOutside) {
  for (const double orientation : {1.0, -1.0}) {
    ContactEdge edge = plane_edge(point, orientation * normal, 2);
    edge.orientation = orientation;
    for (double s : {-1.5, -0.3, -1e-9, 0.0, 1e-9, 0.2, 1.1}) {
      const Vec3 traction = stress_at(edge, point + s * edge.closed + 0.7 * edge.along) * normal;
      const double expected = s > 0 ? std::sqrt(2 * s * (1 - 0.1 * s)) : 0;
      EXPECT_NEAR(normal.dot(traction), expected, 1e-7) << s;  // rounding of the depth, 1e-16, has the root 1e-8
      EXPECT_LT((traction - normal.dot(traction) * normal).norm(), 1e-7) << s;
    }
  }
}

/// Grid axes and exact zero: what the flat scenes rely on for a pressure of exactly zero outside.
TEST(ContactEdge, IsExactlyZeroOutsideOnAPlaneOfTheGrid) {
  const ContactEdge edge = plane_edge(Vec3(0.2, 0.3, 0.25), Vec3::UnitZ());
  for (double s : {-2.0, -0.1, -1e-12}) {
    double stress[6];
    edge.stress(edge.origin + s * edge.closed, stress);
    EXPECT_EQ(stress[2], 0);
    EXPECT_EQ(stress[4], 0);
    EXPECT_EQ(stress[5], 0);
  }
}

/// A sphere of radius 20: traction on its surface off by no more than the distance over the radius.
TEST(ContactEdge, FollowsACurvedFace) {
  ContactEdge edge = plane_edge(Vec3::Zero(), Vec3::UnitZ());
  edge.surface.kind = Surface::Kind::sphere;
  edge.surface.point = Vec3(0, 0, -20);
  edge.surface.radius = 20;
  edge.closed = Vec3::UnitX();
  edge.along = Vec3::UnitY();
  for (double s : {-1.0, -0.4, 0.5, 1.0}) {
    const Vec3 n = (Vec3(s, 0.3, 0) - edge.surface.point).normalized();
    const Vec3 x = edge.surface.point + 20 * n, traction = stress_at(edge, x) * n;
    EXPECT_NEAR(n.dot(traction), s > 0 ? std::sqrt(s * (1 - 0.1 * s)) : 0, 0.05);
    EXPECT_LT((traction - n.dot(traction) * n).norm(), 0.05);
  }
}

/// The vectorised integrals over plane faces are those of the general loop, here over a sphere of 1e9 cells: flat to
/// 1e-8, which moves the depth by as much and its square root at the edge by 1e-4 at a few points.
TEST(EdgeMoments, OfAPlaneFaceEqualTheGeneralOnes) {
  const CutCells cc = test::cut(Solid::box(Vec3(0.1, 0.15, 0.2), Vec3(0.9, 0.8, 0.75), "box"), test::odd_grid(6, 0.3));
  const ElasticSystem system = make_elastic_system({&cc}, {Material{1, 0.3}}, Scales{1, 1}, 0.01);
  const BodyMesh& mesh = system.meshes[0];
  const Vec3 n = (cc.grid.rotation.transpose() * Vec3::UnitZ());
  const Vec3 top = cc.grid.to_grid(Vec3(0.5, 0.5, 0.75));
  ContactEdge plane = plane_edge(top, n);
  plane.curvature = -0.1;
  ContactEdge general = plane;
  general.surface.kind = Surface::Kind::sphere;
  general.surface.radius = 1e9;
  general.surface.point = top - 1e9 * n;
  std::vector<int> cells;
  for (int c = 0; c < static_cast<int>(cc.cells.size()); ++c)
    if ((Vec3(cc.cells[c][0], cc.cells[c][1], cc.cells[c][2]) - top).norm() < 2.5) cells.push_back(c);
  ASSERT_GT(cells.size(), 5u);
  const int count = static_cast<int>(cells.size());
  const auto fast = edge_moments<1>(mesh, cells.data(), count, top, plane),
             slow = edge_moments<1>(mesh, cells.data(), count, top, general);
  EXPECT_LT((fast - slow).norm(), 1e-6 * slow.norm());
}

/// The distance from a circular edge, around a zone or a hole in one, in axes turned in space: right to the fourth
/// order of the angle from the segment's origin, t^4/8 of the radius; along the normal exactly. Off the face nothing
/// changes.
TEST(ZoneEdgeSegment, IsTheDistanceFromACurvedEdge) {
  const double radius = 0.7;
  const Mat3 turned = Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3 centre(3, -1, 2);
  for (const double side : {1.0, -1.0}) {  // a zone inside of the circle, or all around it
    ZoneEdgeSegment segment;
    segment.origin = centre + radius * turned.col(0);
    segment.closed = -side * turned.col(0);
    segment.along = turned.col(1);
    segment.curvature = -side / radius;
    for (const double t : {-0.3, -0.1, 0.0, 0.05, 0.2})
      for (const double off : {-0.01, 0.0, 0.02}) {
        const Vec3 outward = std::cos(t) * turned.col(0) + std::sin(t) * turned.col(1);
        const Vec3 x = centre + (radius + off) * outward + 0.1 * turned.col(2);
        // Both terms of the expansion hold at radius + off as well: off t^2 is what they leave.
        const double left = std::pow(t, 4) / 8 * radius + std::abs(off) * t * t;
        EXPECT_NEAR(segment.inside(x), -side * off, 1.1 * left + 1e-14) << t << " " << off;
      }
  }
}

}  // namespace
}  // namespace cgcontact::test_contact_edge
