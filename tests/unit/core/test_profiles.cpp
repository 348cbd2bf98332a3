// Cones, extruded and revolved profiles: volumes, areas and centres against closed forms, names of faces, what is
// refused.
#include <algorithm>

#include "core/base/errors/errors.hpp"
#include "core/bodies/booleans.hpp"
#include "core/bodies/profile_body.hpp"
#include "core/triangles/triangle_reader.hpp"
#include "tests/unit/core/cut_cells_checks.hpp"

namespace cgcontact::test_profiles {
namespace {

ProfileEdge line(const Vec2& a, const Vec2& b) { return {a, b, "p.side"}; }
ProfileEdge arc(const Vec2& a, const Vec2& through, const Vec2& b) { return {a, b, "p.round", true, through}; }

std::vector<ProfileEdge> polygon(const std::vector<Vec2>& corners) {
  std::vector<ProfileEdge> edges;
  for (std::size_t k = 0; k < corners.size(); ++k) edges.push_back(line(corners[k], corners[(k + 1) % corners.size()]));
  return edges;
}

const ProfileFrame frame{{0.3, -0.2, 0.1}, {1, 0, 0}, {0, 0, 1}};  // extruded towards -y

Solid extruded_by(const std::vector<ProfileEdge>& profile, double height) {
  return extruded(profile, frame, height, "p.bottom", "p.top");
}

/// Area and perimeter, for Pappus' theorems the moments of both about the second axis.
struct Polygon {
  double area = 0, perimeter = 0, area_moment = 0, line_moment = 0;
  explicit Polygon(const std::vector<Vec2>& x) {
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Vec2 &a = x[k], &b = x[(k + 1) % x.size()];
      const double term = (a[0] * b[1] - a[1] * b[0]) / 2, length = (b - a).norm();
      area += term;
      area_moment += term * (a[0] + b[0]) / 3;
      perimeter += length;
      line_moment += length * (a[0] + b[0]) / 2;
    }
  }
};

std::vector<Vec2> star() {
  std::vector<Vec2> corners;
  for (int k = 0; k < 10; ++k) {
    const double angle = 2 * pi * k / 10 + 0.1, radius = k % 2 ? 2.2 : 5;
    corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return corners;
}

// A comb with pockets in pockets: the hull without them, with them again, ...
const std::vector<Vec2> spiral{{0, 0}, {10, 0}, {10, 10}, {2, 10}, {2, 4}, {6, 4},
                               {6, 6}, {4, 6},  {4, 8},   {8, 8},  {8, 2}, {0, 2}};

std::vector<KnownBody> cones() {
  const double r = 4, s = 1.5, h = 9, slope = std::hypot(h, r - s), full = std::hypot(h, r);
  std::vector<KnownBody> list;
  const Solid frustum = Solid::cone({0, 0, 0}, {0, 0, h}, r, s, "c");
  const double volume = pi * h * (r * r + r * s + s * s) / 3, side = pi * (r + s) * slope;
  list.push_back({"frustum", frustum, volume, side + pi * (r * r + s * s)});
  list.push_back({"wider above", Solid::cone({0, 0, 0}, {0, 0, h}, s, r, "c"), volume, side + pi * (r * r + s * s)});
  const Solid pointed = Solid::cone({0, 0, 0}, {0, 0, h}, r, 0, "c");
  list.push_back({"tip", pointed, pi * r * r * h / 3, pi * r * full + pi * r * r});
  list.push_back({"half of a cone", Solid::intersect(pointed, Solid::half_space({0, 0, 0}, {1, 0, 0}, "h")),
                  pi * r * r * h / 6, pi * r * (full + r) / 2 + r * h});
  const double outer = r * 1.2;
  list.push_back({"block with a conical hole",
                  Solid::subtract(Solid::box({-outer, -outer, 0}, {outer, outer, h}, "b"), frustum),
                  4 * outer * outer * h - volume, 8 * outer * outer + 8 * outer * h - pi * (r * r + s * s) + side});
  // a ball about the tip: the sections of sphere and cone are not similar conics
  const double ball = 8, angle = std::atan2(r, h);
  list.push_back({"ball in a cone", Solid::intersect(Solid::sphere({0, 0, h}, ball, "s"), pointed),
                  2 * pi / 3 * ball * ball * ball * (1 - std::cos(angle)),
                  2 * pi * ball * ball * (1 - std::cos(angle)) + pi * ball * ball * std::sin(angle)});
  // two cones tip to tip have one surface
  list.push_back({"diabolo", Solid::unite(pointed, Solid::cone({0, 0, 2 * h}, {0, 0, h}, r, 0, "d")),
                  2 * pi * r * r * h / 3, 2 * pi * r * (full + r)});
  list.push_back(
      {"flat", Solid::cone({0, 0, 0}, {0, 0, 1}, 5, 1, "c"), pi * 31 / 3, pi * 6 * std::hypot(1, 4) + pi * 26});
  list.push_back({"slim", Solid::cone({0, 0, 0}, {0, 0, 9}, 3, 2.99, "c"), pi * 9 * (9 + 3 * 2.99 + 2.99 * 2.99) / 3,
                  pi * 5.99 * std::hypot(9, 0.01) + pi * (9 + 2.99 * 2.99)});
  return list;
}

std::vector<KnownBody> prisms() {
  std::vector<KnownBody> list;
  for (const auto& [name, corners] : {std::make_pair("triangle", std::vector<Vec2>{{0, 0}, {9, 1}, {3, 8}}),
                                      std::make_pair("star", star()), std::make_pair("spiral", spiral)}) {
    const Polygon p(corners);
    list.push_back({name, extruded_by(polygon(corners), 3), 3 * p.area, 3 * p.perimeter + 2 * p.area, planar});
    std::vector<Vec2> clockwise = corners;
    std::reverse(clockwise.begin(), clockwise.end());
    list.push_back({name, extruded_by(polygon(clockwise), 3), 3 * p.area, 3 * p.perimeter + 2 * p.area, planar});
  }
  const double r = 2;
  list.push_back({"disc of two arcs", extruded_by({arc({-4, 0}, {0, -4}, {4, 0}), arc({4, 0}, {0, 4}, {-4, 0})}, 5),
                  pi * 16 * 5, 2 * pi * 16 + 8 * pi * 5});
  list.push_back({"slot",
                  extruded_by({line({-3, -r}, {3, -r}), arc({3, -r}, {3 + r, 0}, {3, r}), line({3, r}, {-3, r}),
                               arc({-3, r}, {-3 - r, 0}, {-3, -r})},
                              3),
                  3 * (12 * r + pi * r * r), 2 * (12 * r + pi * r * r) + 3 * (12 + 2 * pi * r)});
  // three quarters of a ring: an arc that bulges in, wider than half a turn
  const double a = 5, b = 3, wide = 1.5 * pi;
  list.push_back({"open ring",
                  extruded_by({arc({a, 0}, {-a * std::sqrt(0.5), a * std::sqrt(0.5)}, {0, -a}), line({0, -a}, {0, -b}),
                               arc({0, -b}, {-b * std::sqrt(0.5), b * std::sqrt(0.5)}, {b, 0}), line({b, 0}, {a, 0})},
                              2),
                  wide * (a * a - b * b), wide * (a * a - b * b) + 2 * (wide * (a + b) + 2 * (a - b))});
  // a block with a rounded edge and a fillet, tangents throughout
  list.push_back(
      {"rounded step",
       extruded_by({line({0, 0}, {9, 0}), line({9, 0}, {9, 3}), line({9, 3}, {6, 3}),
                    arc({6, 3}, {6 - 2 * std::sqrt(0.5), 5 - 2 * std::sqrt(0.5)}, {4, 5}), line({4, 5}, {4, 6}),
                    arc({4, 6}, {2 + 2 * std::sqrt(0.5), 6 + 2 * std::sqrt(0.5)}, {2, 8}), line({2, 8}, {0, 8}),
                    line({0, 8}, {0, 0})},
                   4),
       4 * 47, 2 * 47 + 4 * (26 + 2 * pi)});  // what the fillet adds the rounding takes away
  return list;
}

std::vector<KnownBody> turned() {
  std::vector<KnownBody> list;
  const auto add = [&](const char* name, const std::vector<Vec2>& corners) {
    const Polygon p(corners);
    list.push_back({name, revolved(polygon(corners), frame), 2 * pi * p.area_moment, 2 * pi * p.line_moment});
  };
  add("ring", {{2, 0}, {5, 0}, {5, 4}, {2, 4}});
  add("solid cylinder", {{0, 0}, {4, 0}, {4, 6}, {0, 6}});
  add("pulley", {{1, 0}, {5, 0}, {5, 1}, {3, 3}, {5, 5}, {5, 6}, {1, 6}});
  add("spindle", {{0, 0}, {4, 3}, {2.5, 6}, {0, 9}});
  add("countersunk bore", {{4, 0}, {4, 5}, {2.5, 5}, {1, 3.5}, {1, 0}});
  const double r = 4;
  list.push_back({"ball", revolved({arc({0, -r}, {r, 0}, {0, r}), line({0, r}, {0, -r})}, frame),
                  4 * pi * r * r * r / 3, 4 * pi * r * r});
  // a hemispherical cup
  const double q = 2.5;
  list.push_back({"cup",
                  revolved({arc({0, -r}, {r * std::sqrt(0.5), -r * std::sqrt(0.5)}, {r, 0}), line({r, 0}, {q, 0}),
                            arc({q, 0}, {q * std::sqrt(0.5), -q * std::sqrt(0.5)}, {0, -q}), line({0, -q}, {0, -r})},
                           frame),
                  2 * pi * (r * r * r - q * q * q) / 3, 2 * pi * (r * r + q * q) + pi * (r * r - q * q)});
  return list;
}

void check(const std::vector<KnownBody>& bodies) { check_totals(bodies, {Mat3::Identity(), rotation({1, 2, 3}, 0.7)}); }

TEST(Profiles, cones_have_their_volumes_and_areas) { check(cones()); }
TEST(Profiles, prisms_have_their_volumes_and_areas) { check(prisms()); }
TEST(Profiles, turned_bodies_have_their_volumes_and_areas) { check(turned()); }

// The integral of x over the body gives its centroid, also of a body of many surfaces.
TEST(Profiles, centres_are_where_formulas_have_them) {
  const double r = 4, h = 9;
  const CutCells cone = cut(Solid::cone({0, 0, 0}, {0, 0, h}, r, 0, "c"));
  const double volume = pi * r * r * h / 3;
  EXPECT_LT((first_moment(cone) / volume - Vec3(r, r, h / 4)).norm(), 1e-8);
  const CutCells prism = cut(extruded_by(polygon({{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 8}, {0, 8}}), 3));
  EXPECT_LT((first_moment(prism) / (3 * 24) - Vec3((12 * 3 + 12 * 1) / 24., 1.5, (12 * 1 + 12 * 5) / 24.)).norm(),
            planar);
}

TEST(Profiles, faces_have_the_names_of_their_edges) {
  std::vector<ProfileEdge> edges = polygon({{1, 0}, {5, 0}, {5, 4}, {3, 5}});
  for (std::size_t k = 0; k < edges.size(); ++k) edges[k].face = "p.edge" + std::to_string(k);
  const auto name_at = [](const Solid& solid, const Vec3& x, const Vec3& n) {
    const std::vector<std::string>& names = solid.surfaces()[solid.surface_at(x, n)].names;
    return names.empty() ? "" : names[0];
  };
  const ProfileFrame plain{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  const Solid prism = extruded(edges, plain, 2, "p.bottom", "p.top");
  EXPECT_EQ(name_at(prism, {3, -1, 0}, {0, 0, -1}), "p.edge0");
  EXPECT_EQ(name_at(prism, {5, -1, 2}, {1, 0, 0}), "p.edge1");
  EXPECT_EQ(name_at(prism, {4, -1, 4.5}, Vec3(1, 0, 2).normalized()), "p.edge2");
  EXPECT_EQ(name_at(prism, {3, 0, 2}, {0, 1, 0}), "p.bottom");
  EXPECT_EQ(name_at(prism, {3, -2, 2}, {0, -1, 0}), "p.top");
  const Solid ring = revolved(edges, plain);
  EXPECT_EQ(name_at(ring, {0, 3, 0}, {0, 0, -1}), "p.edge0");
  EXPECT_EQ(name_at(ring, {0, 5, 2}, {0, 1, 0}), "p.edge1");
  EXPECT_EQ(name_at(ring, {0, 4, 4.5}, Vec3(0, 1, 2).normalized()), "p.edge2");
  EXPECT_EQ(name_at(ring, {0, 2, 2.5}, Vec3(0, -5, 2).normalized()), "p.edge3");
}

// Lines through a cone: at the radii that belong to their heights, with the normal of the cone; the half beyond the tip
// does not belong to it.
TEST(Profiles, lines_meet_cones) {
  const Solid cone = Solid::cone({0, 0, 0}, {0, 0, 4}, 2, 0, "c");
  std::vector<Crossing> found;
  cone.crossings({0.5, 0, 1}, {0, 1, 0}, 10, found);
  ASSERT_EQ(found.size(), 2u);
  const double reach = std::sqrt(1.5 * 1.5 - 0.25);
  for (const Crossing& crossing : found) {
    EXPECT_NEAR(std::abs(crossing.t), reach, 1e-14);
    const Vec3 normal = Vec3(0.5, crossing.t, 0.75).normalized();  // radius 1.5 across, half of it up
    EXPECT_LT((crossing.normal - normal).norm(), 1e-14);
  }
  found.clear();
  cone.crossings({0.1, 0, 5}, {0, 1, 0}, 10, found);
  EXPECT_TRUE(found.empty());
  cone.crossings({0, 0, 5}, {0, 0, -1}, 10, found);  // along the axis: in at the tip, out at the bottom
  EXPECT_TRUE(std::any_of(found.begin(), found.end(), [](const Crossing& c) { return std::abs(c.t - 5) < 1e-14; }));
  found.clear();
  cone.crossings({0, 0, 2}, Vec3(1, 0, -2).normalized(), 10, found);  // along a generator, inside
  for (const Crossing& crossing : found)
    EXPECT_NEAR(crossing.normal.dot(Vec3(0, 0, -1)), crossing.t > 0 ? 1 : -0.447, 1e-3);
  EXPECT_TRUE(cone.contains({0, 0, 3.9}));
  EXPECT_FALSE(cone.contains({0, 0, 4.1}));
}

// Cones and profiles with a triangle surface: facets, at most a thousandth of a cell inside.
TEST(Profiles, combine_with_triangle_surfaces) {
  const double cell = 0.5;
  const Solid block = combine_triangles(BooleanOp::Kind::intersect, Solid::box({-4, -4, 0}, {4, 4, 4}, "b"),
                                        Solid::box({-5, -5, -1}, {5, 5, 5}, "all"), cell)
                          .solid;
  const auto volume = [](const Solid& solid) { return totals(cut(solid)).volume; };
  const TriangleBoolean holed =
      combine_triangles(BooleanOp::Kind::subtract, block, Solid::cone({0, 0, 0}, {0, 0, 4}, 3, 1, "c"), cell);
  EXPECT_NEAR(volume(holed.solid), 256 - pi * 4 * 13 / 3, 3 * 1e-3 * cell * 2 * pi * 4 * 2);
  EXPECT_LE(holed.facet_error, 1.5e-3 * cell) << "the far end of the cone is wider than the hole";
  const TriangleBoolean pointed =
      combine_triangles(BooleanOp::Kind::subtract, block, Solid::cone({0, 0, 0}, {0, 0, 3}, 3, 0, "c"), cell);
  EXPECT_NEAR(volume(pointed.solid), 256 - pi * 9, 1e-3 * cell * 30);
  std::vector<ProfileEdge> step = polygon({{-2, -2}, {2, -2}, {2, 0}, {0, 0}, {0, 2}, {-2, 2}});
  const Solid through = extruded(step, {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}}, 6, "p.bottom", "p.top");
  EXPECT_NEAR(volume(combine_triangles(BooleanOp::Kind::subtract, block, through, cell).solid), 256 - 12 * 4, 1e-9);
}

/// Both ways round, more and less than half of the circle; none through points of a line.
TEST(Profiles, arc_through_three_points) {
  const auto at = [](double angle) { return Vec2(2 + 3 * std::cos(angle), -1 + 3 * std::sin(angle)); };
  for (const double turn : {0.1, 3.0, 6.0, -0.1, -3.0, -6.0}) {
    const auto found = arc_through(at(0.4), at(0.4 + 0.3 * turn), at(0.4 + turn));
    ASSERT_TRUE(found);
    EXPECT_LT((found->circle.centre - Vec2(2, -1)).norm(), 1e-11);
    EXPECT_NEAR(found->circle.radius, 3, 1e-11);
    EXPECT_NEAR(found->turn, turn, 1e-11);
  }
  EXPECT_FALSE(arc_through({0, 0}, {1, 1}, {2, 2}));
  EXPECT_FALSE(arc_through({0, 0}, {1, 1e-9}, {2, 0}, 1e-8));
}

TEST(Profiles, nonsense_is_refused) {
  const auto message = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto contains = [](const std::string& text, const std::string& words) {
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n  in: " << text;
  };
  contains(message([] { Solid::cone({0, 0, 0}, {0, 0, 1}, 1, 1, "c"); }), "two different radii");
  contains(message([] { Solid::cone({0, 0, 0}, {0, 0, 0}, 1, 2, "c"); }), "different centres");
  contains(message([] { Solid::cone({0, 0, 0}, {0, 0, 1}, -1, 2, "c"); }), "two different radii");
  contains(message([] { Solid::cone({0, 0, 0}, {0, 0, 1e-3}, 1, 2, "c"); }), "degrees to the axis");
  contains(message([] { extruded_by(polygon({{0, 0}, {2, 2}, {2, 0}, {0, 2}}), 1); }), "edges 1 and 3 cross");
  contains(message([] { extruded_by(polygon({{0, 0}, {1, 1}, {2, 2}}), 1); }), "area");
  contains(message([] { extruded_by(polygon({{0, 0}, {0, 0}, {2, 2}}), 1); }), "edge 1 has no length");
  contains(message([] { extruded_by({line({0, 0}, {1, 0}), line({1, 0}, {1, 1})}, 1); }), "closed");
  contains(message([] { extruded_by({arc({0, 0}, {1, 0}, {2, 0}), line({2, 0}, {0, 0})}, 1); }), "lie on a line");
  contains(message([] { revolved(polygon({{-1, 0}, {2, 0}, {2, 2}}), frame); }), "crosses the axis");
  contains(message([] { revolved({arc({3, 0}, {4, 1}, {3, 2}), line({3, 2}, {3, 0})}, frame); }), "a torus");
  contains(message([] { revolved(polygon({{1, 0}, {5, 1e-3}, {5, 2}, {1, 2}}), frame); }), "edge 1: a line at");
}

}  // namespace
}  // namespace cgcontact::test_profiles
