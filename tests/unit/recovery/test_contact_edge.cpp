/// The square-root term at the edge of a contact zone: equilibrium, boundary conditions, integrals; the edge through
/// samples on a circle.
#include <gtest/gtest.h>

#include <random>

#include "core/quadrature/gauss_rules.hpp"
#include "recovery/zone_edge/edge_moments.hpp"
#include "recovery/zone_edge/edge_search.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact {
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

/// Samples on a circle of ten cells, two per cell: place to 1 % of a cell, direction to one degree; the ridge takes
/// little of the curvature. Other pairs and far places: no edge.
TEST(FoundEdges, DrawTheCircleThatTheSamplesLieOn) {
  std::vector<EdgeSample> samples;
  constexpr double radius = 10;
  for (int i = 0; i < 126; ++i) {
    const double angle = 0.05 * i;
    const Vec3 out(std::cos(angle), std::sin(angle), 0);
    const Vec3 skew(std::cos(angle + 0.1 * (i % 3 - 1)), std::sin(angle + 0.1 * (i % 3 - 1)), 0);
    samples.push_back({2, i, radius * out, -skew, i % 2 ? Vec3(0, 0, -1) : Vec3(0, 0, 1), 0, -0.5, nullptr, 1});
  }
  const FoundEdges edges(samples);
  for (double angle : {0.3, 1.0, 2.2, 4.0})
    for (double r : {9.0, 10.0, 11.5}) {
      const Vec3 out(std::cos(angle), std::sin(angle), 0);
      EdgePiece piece;
      ASSERT_TRUE(edges.near(2, r * out, piece));
      EXPECT_NEAR(piece.inside(r * out), radius - r, 0.02);
      EXPECT_GT(piece.closed.dot(-out), std::cos(M_PI / 180));
      EXPECT_LT(piece.curvature, -0.9 / radius);
      EXPECT_GT(piece.curvature, -1.1 / radius);
      EXPECT_DOUBLE_EQ(piece.factor, -0.5);
      EXPECT_FALSE(edges.near(1, r * out, piece));
    }
  EdgePiece piece;
  EXPECT_FALSE(edges.near(2, Vec3(0, 0, 0), piece));
}

/// The two edges of a zone three cells wide do not pull at each other; in a strip (a slab) single places beside the
/// others do not turn the edge. Zones of edges are told apart, and those marked are gone.
TEST(FoundEdges, KeepOppositeEdgesAndZonesApart) {
  std::vector<EdgeSample> samples;
  const auto add = [&](double x, double closed, bool in_strip) {
    for (int i = 0; i < 3; ++i)
      samples.push_back({0, i, Vec3(x + 0.1 * (i - 1), 0.4 * i, 0), closed * Vec3::UnitX(), Vec3::UnitZ(), 1. / 3,
                         -closed, nullptr, 1, in_strip});
  };
  add(0, 1, true);
  add(3, -1, true);
  add(20, 1, false);
  const FoundEdges edges(samples);
  EdgePiece piece;
  ASSERT_TRUE(edges.near(0, Vec3(0.2, 0.4, 0), piece));
  EXPECT_NEAR(piece.origin[0], 0, 1e-3);
  EXPECT_NEAR(piece.closed[0], 1, 1e-9);
  EXPECT_NEAR(piece.curvature, 0, 1e-3);
  EXPECT_DOUBLE_EQ(piece.factor, -1);
  ASSERT_TRUE(edges.near(0, Vec3(2.9, 0.4, 0), piece));
  EXPECT_NEAR(piece.origin[0], 3, 1e-3);
  EXPECT_DOUBLE_EQ(piece.factor, 1);
  ASSERT_TRUE(edges.near(0, Vec3(20, 0.4, 0), piece));
  EXPECT_LT(piece.closed[0], 0.999);  // on a wide face the places turn the edge

  ASSERT_EQ(edges.num_zones(), 2u);
  const int zone = edges.zone(0, Vec3::Zero());
  EXPECT_EQ(edges.zone(0, Vec3(3, 0, 0)), zone);
  EXPECT_NE(edges.zone(0, Vec3(20, 0, 0)), zone);
  EXPECT_EQ(edges.zone(0, Vec3(10, 0, 0)), -1);
  std::vector<char> wrong(2, 0);
  wrong[zone] = 1;
  const FoundEdges kept = edges.without(wrong);
  EXPECT_FALSE(kept.near(0, Vec3::Zero(), piece));
  EXPECT_TRUE(kept.near(0, Vec3(20, 0, 0), piece));
}

/// A contact face of unit cells, turned against the edge by `angle`, 3 x 3 points per cell, pressed with
/// 7 sqrt(s (1 - s / width)) by a zone that is a circle of the given radius (0: a half plane). As in a solution the
/// pressure is constant over a cell, with the right force.
std::vector<TransmittedForce> pressed_face(double radius, double width, double angle, const Vec3& offset) {
  std::vector<TransmittedForce> forces;
  constexpr int fine = 40;
  const GaussRule& gauss = gauss_rule(3);
  const auto inside = [&](const Vec3& x) { return radius == 0 ? x[0] : radius - (x - radius * Vec3::UnitX()).norm(); };
  const auto pressure = [&](const Vec3& x) {
    const double s = inside(x);
    return s > 0 && s < width ? std::sqrt(s * (1 - s / width)) : 0;
  };
  const Eigen::AngleAxisd turn(angle, Vec3::UnitZ());
  for (int j = -8; j < 8; ++j)
    for (int i = -8; i < 8; ++i) {
      const auto place = [&](double a, double b) { return Vec3(turn * (Vec3(i + a, j + b, 0) + offset)); };
      double force = 0;
      for (int q = 0; q < fine * fine; ++q)
        force += pressure(place((q % fine + 0.5) / fine, (q / fine + 0.5) / fine)) / (fine * fine);
      for (int q = 0; q < 9; ++q) {
        const double weight = gauss.weight[q % 3] * gauss.weight[q / 3];
        forces.push_back({0, 100 * j + i, 0, force > 0, place(gauss.node[q % 3], gauss.node[q / 3]), Vec3::UnitZ(),
                          weight, 7 * force * weight, 7 * force * weight, 1});
      }
    }
  return forces;
}

std::vector<const TransmittedForce*> pointers(const std::vector<TransmittedForce>& forces) {
  std::vector<const TransmittedForce*> result;
  for (const TransmittedForce& f : forces) result.push_back(&f);
  return result;
}

/// Straight edges and circles of ten cells, cells turned by any angle, the edge assumed up to half a cell off.
/// Pressures that are constant over cells put the edge 0.03 cells outwards, and 0.035 are added (a solution's zone is
/// too small by as much together); beside that 0.02 cells. Strength: 1.5 shift / 3 = 3 % low with that shift, 2 %
/// beside.
TEST(EdgeFit, FindsTheEdgeFromConstantPressuresOfCells) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const double radius : {0.0, 10.0})
    for (int i = 0; i < 20; ++i) {
      const double width = radius == 0 ? 15 : 2 * radius;
      const auto forces =
          pressed_face(radius, width, uniform(generator), Vec3(uniform(generator), uniform(generator), 0));
      EdgePiece piece;
      piece.closed = Vec3::UnitX();
      piece.along = Vec3::UnitY();
      piece.curvature = radius == 0 ? 0 : -1 / radius;
      piece.inverse_width = 1 / width;
      const double assumed = uniform(generator) - 0.5;
      piece.origin = assumed * Vec3::UnitX();
      const EdgeFit fit = fit_edge(piece, pointers(forces), 1);
      ASSERT_TRUE(fit.found);
      EXPECT_NEAR(fit.shift, assumed + 0.065, 0.025) << radius << " " << i;
      EXPECT_NEAR(fit.strength, 0.97 * 7, 0.02 * 7) << radius << " " << i;
    }
}

/// Lengths in millimetres instead of cells: the shift counts cells, the strength has the unit's root.
TEST(EdgeFit, KnowsItsUnits) {
  const auto cells = pressed_face(0, 15, 0.2, Vec3(0.3, 0.4, 0));
  auto metres = cells;
  constexpr double h = 1e-3;
  for (TransmittedForce& f : metres) f.position *= h, f.area *= h * h, f.force *= h * h;
  EdgePiece piece;
  piece.closed = Vec3::UnitX();
  piece.along = Vec3::UnitY();
  piece.inverse_width = 1.0 / 15;
  const EdgeFit expected = fit_edge(piece, pointers(cells), 1);
  piece.inverse_width /= h;
  const EdgeFit fit = fit_edge(piece, pointers(metres), h);
  ASSERT_TRUE(expected.found && fit.found);
  EXPECT_NEAR(fit.shift, expected.shift, 1e-9);
  EXPECT_NEAR(fit.strength * std::sqrt(h), expected.strength, 1e-9 * expected.strength);
}

/// No force, forces on the wrong side, or none near: no edge, and no number that is none.
TEST(EdgeFit, IsNotFoundWhereNoEdgeIs) {
  EdgePiece piece;
  piece.closed = Vec3::UnitX();
  piece.along = Vec3::UnitY();
  EXPECT_FALSE(fit_edge(piece, {}, 1).found);
  auto forces = pressed_face(0, 15, 0, Vec3::Zero());
  for (TransmittedForce& f : forces) f.force = 0;
  EXPECT_FALSE(fit_edge(piece, pointers(forces), 1).found);
  forces = pressed_face(0, 15, 0, Vec3::Zero());
  piece.closed = -Vec3::UnitX();
  EXPECT_FALSE(fit_edge(piece, pointers(forces), 1).found);
  piece.closed = Vec3::UnitX();
  piece.origin = 100 * Vec3::UnitX();
  EXPECT_FALSE(fit_edge(piece, pointers(forces), 1).found);
}

}  // namespace
}  // namespace cgcontact
