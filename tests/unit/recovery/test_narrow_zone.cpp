/// Edges of contact zones of few cells from the moments of their forces, and the mirror images that complete halves
/// and quarters of zones.
#include <gtest/gtest.h>

#include <random>

#include "recovery/patch/contact_edge.hpp"
#include "recovery/zone_edge/narrow_zone.hpp"
#include "recovery/zone_edge/symmetry_planes.hpp"

namespace cgcontact {
namespace {

/// What the edges are moved outwards by, cells: solutions put them that much inside
/// (recovery/zone_edge/narrow_zone.cpp).
constexpr double deficit = 0.05;

struct Ellipse {
  Vec3 centre;
  double a, b, angle, top;  // semi-axes, m; turned about z; pressure in the middle, Pa
  /// (radius / radius of the edge in that direction)^2
  double square(const Vec3& x) const {
    const Vec3 d = Eigen::AngleAxisd(-angle, Vec3::UnitZ()) * (x - centre);
    return std::pow(d[0] / a, 2) + std::pow(d[1] / b, 2);
  }
};

/// A face of cells of size h, 12 x 12 points each, under `profile` (of the square above, for a pressure of 1 in the
/// middle).
template <class Profile>
std::vector<TransmittedForce> forces_under(const Ellipse& zone, double h, const Profile& profile) {
  std::vector<TransmittedForce> forces;
  constexpr int fine = 12, cells = 9;
  for (int q = -cells * fine; q < cells * fine; ++q)
    for (int p = -cells * fine; p < cells * fine; ++p) {
      const Vec3 x(h * (p + 0.5) / fine, h * (q + 0.5) / fine, 0);
      const double s = zone.square(x), area = h * h / (fine * fine), force = s < 1 ? zone.top * profile(s) * area : 0;
      forces.push_back({0, 0, 0, s < 1, x, Vec3::UnitZ(), area, force, force, h});
    }
  return forces;
}

std::vector<const TransmittedForce*> pointers(const std::vector<TransmittedForce>& forces) {
  std::vector<const TransmittedForce*> result;
  for (const TransmittedForce& f : forces) result.push_back(&f);
  return result;
}

double hertz(double square) { return std::sqrt(1 - square); }

/// Ellipses of 1.5 to 4 cells, any direction and unit: the edge to 0.01 cells (midpoint rule at a square root, 12
/// points per cell) beside the deficit, seen from places up to a cell beside it; the root's factor, width and curvature
/// to 3 % beside what the deficit changes (the pressure of a zone of radius 1.5 that grows by 0.05 falls by 6.5 %, and
/// with it the factor, 1.5 times a radius' power in the other direction).
TEST(NarrowZone, HertzsEllipsesAreFound) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 20; ++i) {
    const double h = std::pow(10, -4 * uniform(generator)), unit = 1e9;
    const Ellipse zone{h * Vec3(uniform(generator) - 0.5, uniform(generator) - 0.5, 0),
                       h * (1.5 + 2.5 * uniform(generator)), h * (1.5 + 2.5 * uniform(generator)),
                       3 * uniform(generator), 3e8};
    const auto forces = forces_under(zone, h, hertz);
    NarrowZone fitted;
    ASSERT_TRUE(
        fit_narrow_zone(pointers(forces), zone.centre + h * Vec3(0.2, -0.1, 0), Vec3::UnitZ(), h, unit, fitted));
    EXPECT_LT(fitted.misfit, 0.005);
    for (double turn = 0.1; turn < 6.28; turn += 0.7) {
      const Eigen::AngleAxisd frame(zone.angle, Vec3::UnitZ());
      const Vec3 edge = zone.centre + frame * Vec3(zone.a * std::cos(turn), zone.b * std::sin(turn), 0);
      const Vec3 inward = -(frame * Vec3(std::cos(turn) / zone.a, std::sin(turn) / zone.b, 0)).normalized();
      const double across = zone.a * zone.b / std::hypot(zone.b * std::cos(turn), zone.a * std::sin(turn));
      const Vec3 seen = edge + (2 * uniform(generator) - 1) * std::min(h, 0.3 * across) * inward;
      EdgePiece piece;
      ASSERT_TRUE(fitted.edge_near(seen, edge, piece));
      EXPECT_NEAR(piece.inside(edge) / h, deficit, 0.015) << i << " " << turn;
      const double expected_bend =
          zone.a * zone.b / std::pow(std::hypot(zone.a * std::sin(turn), zone.b * std::cos(turn)), 3);
      EXPECT_NEAR(-piece.curvature / expected_bend, 1, 0.12) << i << " " << turn;
      // Pressure half a cell inside the edge: the square root with the zone's width.
      const Vec3 x = edge + 0.5 * h * inward;
      const double s = piece.inside(x), term = -piece.factor * unit * edge_root(s, piece.inverse_width);
      EXPECT_NEAR(term / (zone.top * hertz(zone.square(x))), 1, 0.06) << i << " " << turn;
    }
  }
}

/// A quarter of a circle with the three others as images is the circle.
TEST(NarrowZone, ImagesCompleteAQuarter) {
  const SymmetryPlane planes[] = {{Vec3::Zero(), -Vec3::UnitX()}, {Vec3::Zero(), -Vec3::UnitY()}};
  const Ellipse circle{Vec3::Zero(), 2.3, 2.3, 0, 5};
  const auto whole = forces_under(circle, 1, hertz);
  std::vector<TransmittedForce> quarter;
  for (const TransmittedForce& f : whole)
    if (f.position[0] > 0 && f.position[1] > 0) quarter.push_back(f);
  for (const SymmetryPlane& plane : planes)
    for (std::size_t i = 0, n = quarter.size(); i < n; ++i) {
      quarter.push_back(quarter[i]);
      quarter.back().position = plane.image(quarter[i].position);
    }
  NarrowZone expected, fitted;
  ASSERT_TRUE(fit_narrow_zone(pointers(whole), Vec3::Zero(), Vec3::UnitZ(), 1, 1, expected));
  ASSERT_TRUE(fit_narrow_zone(pointers(quarter), Vec3::Zero(), Vec3::UnitZ(), 1, 1, fitted));
  EXPECT_LT((fitted.coefficients - expected.coefficients).norm(), 1e-8 * expected.coefficients.norm());
}

/// The misfit, or a border that is not that of the closed points, tells Hertz's profile from a hollow one (a punch), a
/// flat and a pointed one (a cone).
TEST(NarrowZone, OtherProfilesAreNoticed) {
  const Ellipse circle{Vec3(0.2, 0.1, 0), 3, 3, 0, 1};
  const auto misfit = [&](const auto& profile) {
    NarrowZone fitted;
    const auto forces = forces_under(circle, 1, profile);
    return fit_narrow_zone(pointers(forces), Vec3::Zero(), Vec3::UnitZ(), 1, 1, fitted) ? fitted.misfit : 1e300;
  };
  EXPECT_LT(misfit(hertz), 0.003);
  EXPECT_GT(misfit([](double s) { return std::sqrt((1 - s) * (0.2 + s)); }), 0.012);
  EXPECT_GT(misfit([](double) { return 1.0; }), 0.012);
  EXPECT_GT(misfit([](double s) { return std::acosh(1 / std::sqrt(std::max(s, 1e-3))); }), 0.012);
}

/// No forces, no closed point, forces far away: no zone, and no number that is none.
TEST(NarrowZone, IsNotFoundWhereNoneIs) {
  NarrowZone fitted;
  EXPECT_FALSE(fit_narrow_zone({}, Vec3::Zero(), Vec3::UnitZ(), 1, 1, fitted));
  auto forces = forces_under({Vec3::Zero(), 2, 2, 0, 1}, 1, hertz);
  EXPECT_FALSE(fit_narrow_zone(pointers(forces), Vec3(100, 0, 0), Vec3::UnitZ(), 1, 1, fitted));
  for (TransmittedForce& f : forces) f.spread_force = 0;
  EXPECT_FALSE(fit_narrow_zone(pointers(forces), Vec3::Zero(), Vec3::UnitZ(), 1, 1, fitted));
  // Two zones far from each other are no ellipse.
  forces = forces_under({Vec3(-5, 0, 0), 1, 1, 0, 1}, 1, hertz);
  const auto other = forces_under({Vec3(5, 0, 0), 1, 1, 0, 1}, 1, hertz);
  for (std::size_t i = 0; i < forces.size(); ++i) {
    forces[i].closed = forces[i].closed || other[i].closed;
    forces[i].spread_force += other[i].spread_force;
  }
  EXPECT_FALSE(fit_narrow_zone(pointers(forces), Vec3::Zero(), Vec3::UnitZ(), 1, 1, fitted));
}

/// Planes of two bodies are the same if point and normal are; an opposite or shifted one is another.
TEST(SymmetryPlanes, CommonOnes) {
  const std::vector<SymmetryPlane> a = {{Vec3(1, 0, 0), Vec3::UnitX()}, {Vec3(0, 0, 0), -Vec3::UnitY()}};
  const std::vector<SymmetryPlane> b = {
      {Vec3(1, 5, 7), Vec3::UnitX()}, {Vec3(0, 0.1, 0), -Vec3::UnitY()}, {Vec3(0, 0, 0), Vec3::UnitY()}};
  const auto common = common_planes(a, b, 0.1);
  ASSERT_EQ(common.size(), 1u);
  EXPECT_EQ(common[0].normal, Vec3::UnitX());
  EXPECT_EQ(common[0].image(Vec3(3, 4, 5)), Vec3(-1, 4, 5));
  EXPECT_EQ(common[0].turned(Vec3(1, 2, 3)), Vec3(-1, 2, 3));
}

}  // namespace
}  // namespace cgcontact
