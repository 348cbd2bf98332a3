/// The curved scenes with known answers, their bodies read from fine STL files: the pressure is that of the CSG bodies
/// up to the error of the facets. Facets are a fraction of a cell, so that their ripple is averaged out over each
/// cell; what is left is a smaller (inscribed) surface on either side, and the mean depth of the facets that
/// the sides of the cells cut.
#include <cmath>

#include "tests/support/scene_with_meshes.hpp"

namespace cgcontact::test_triangle_contact {
namespace {

void add_quad(TriangleSoup& soup, int a, int b, int c, int d) {
  soup.triangles.push_back({a, b, c});
  soup.triangles.push_back({a, c, d});
}

/// Quarter of a ring about z with its flat ends in the planes x = 0 and y = 0.
TriangleSoup ring_quarter(double inner, double outer, double height, int facets) {
  TriangleSoup soup;
  const auto point = [](int i, int corner) {
    return 4 * i + corner;
  };  // corners: inner low, outer low, outer high, inner high
  for (int i = 0; i <= facets; ++i) {
    const double angle = 0.5 * pi * i / facets;
    const Vec3 e = i == 0 ? Vec3(1, 0, 0) : i == facets ? Vec3(0, 1, 0) : Vec3(std::cos(angle), std::sin(angle), 0);
    for (const auto& [r, z] : {std::pair(inner, 0.0), {outer, 0.0}, {outer, height}, {inner, height}})
      soup.points.push_back(r * e + Vec3(0, 0, z));
  }
  for (int i = 0; i < facets; ++i)
    for (int c = 0; c < 4; ++c)
      add_quad(soup, point(i, c), point(i + 1, c), point(i + 1, (c + 1) % 4), point(i, (c + 1) % 4));
  add_quad(soup, point(0, 0), point(0, 1), point(0, 2), point(0, 3));
  add_quad(soup, point(facets, 3), point(facets, 2), point(facets, 1), point(facets, 0));
  for (Triangle& t : soup.triangles) std::swap(t[1], t[2]);
  return soup;
}

/// Points of the positive octant of a sphere: (i, j), j <= i <= n; (0, 0) on the z axis, i = n in the plane z = 0.
class Octant {
 public:
  Octant(TriangleSoup& soup, double radius, int n) : soup_(soup), first_(static_cast<int>(soup.points.size())), n_(n) {
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= i; ++j) soup.points.push_back(radius * Vec3(i - j, j, n - i).normalized());
  }
  int operator()(int i, int j) const { return first_ + i * (i + 1) / 2 + j; }
  void add_surface(bool outwards) {
    const auto add = [&](int a, int b, int c) {
      soup_.triangles.push_back(outwards ? Triangle{a, b, c} : Triangle{a, c, b});
    };
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j <= i; ++j) {
        add((*this)(i, j), (*this)(i + 1, j), (*this)(i + 1, j + 1));
        if (j < i) add((*this)(i, j), (*this)(i + 1, j + 1), (*this)(i, j + 1));
      }
  }
  /// The points of its edge in the plane where coordinate k is zero, counterclockwise seen from the outside of the
  /// body.
  std::vector<int> edge(int k) const {
    std::vector<int> points;
    for (int s = 0; s <= n_; ++s)
      points.push_back(k == 0 ? (*this)(n_ - s, n_ - s) : k == 1 ? (*this)(s, 0) : (*this)(n_, s));
    return points;
  }

 private:
  TriangleSoup& soup_;
  int first_, n_;
};

TriangleSoup ball_octant(double radius, int n) {
  TriangleSoup soup;
  Octant surface(soup, radius, n);
  surface.add_surface(true);
  soup.points.push_back(Vec3::Zero());
  const int centre = static_cast<int>(soup.points.size()) - 1;
  for (int k = 0; k < 3; ++k) {
    const std::vector<int> edge = surface.edge(k);
    for (int s = 0; s < n; ++s) soup.triangles.push_back({centre, edge[s + 1], edge[s]});
  }
  return soup;
}

TriangleSoup shell_octant(double inner, double outer, int n) {
  TriangleSoup soup;
  Octant in(soup, inner, n), out(soup, outer, n);
  in.add_surface(false);
  out.add_surface(true);
  for (int k = 0; k < 3; ++k) {
    const std::vector<int> a = in.edge(k), b = out.edge(k);
    for (int s = 0; s < n; ++s) add_quad(soup, a[s], a[s + 1], b[s + 1], b[s]);
  }
  return soup;
}

/// Block [0, size]^2 x .. size whose underside is the sphere of the given radius about (0, 0, radius).
TriangleSoup cap_quarter(double radius, double size, int n) {
  TriangleSoup soup;
  const auto low = [n](int i, int j) { return i * (n + 1) + j; };
  const auto high = [n](int i, int j) { return (n + 1) * (n + 1) + i * (n + 1) + j; };
  for (const bool top : {false, true})
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) {
        const double x = size * i / n, y = size * j / n;
        soup.points.push_back({x, y, top ? size : radius - std::sqrt(radius * radius - x * x - y * y)});
      }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      add_quad(soup, low(i, j), low(i, j + 1), low(i + 1, j + 1), low(i + 1, j));
      add_quad(soup, high(i, j), high(i + 1, j), high(i + 1, j + 1), high(i, j + 1));
    }
  for (int i = 0; i < n; ++i) {
    add_quad(soup, low(i, 0), low(i + 1, 0), high(i + 1, 0), high(i, 0));
    add_quad(soup, low(i + 1, n), low(i, n), high(i, n), high(i + 1, n));
    add_quad(soup, low(0, i + 1), low(0, i), high(0, i), high(0, i + 1));
    add_quad(soup, low(n, i), low(n, i + 1), high(n, i + 1), high(n, i));
  }
  return soup;
}

std::string flat(const std::string& axis) { return "normal = {axis = " + axis + ", angle = 0.01}"; }
std::string curved(const std::string& seed) { return "smooth = {seed = " + seed + ", angle = 10}"; }

/// Errors of the pressure, force, area and largest pressure with triangles, less those of CSG, relative.
void expect_like_csg(const Results& mesh, const Results& csg, double facet_error) {
  ASSERT_TRUE(mesh.converged) << mesh.diagnosis;
  const PairFigures &a = mesh.pairs[0], &b = csg.pairs[0];
  const double extra = test::zone(mesh, "whole").sprc - test::zone(csg, "whole").sprc;
  std::printf(
      "triangles against CSG: pressure error %.4f (CSG %.4f), force %+.4f, area %+.4f, maximum %+.4f; facets %.4f\n",
      test::zone(mesh, "whole").sprc, test::zone(csg, "whole").sprc,
      a.force_on_first.norm() / b.force_on_first.norm() - 1, a.area / b.area - 1, a.max_pressure / b.max_pressure - 1,
      facet_error);
  EXPECT_LE(extra, facet_error);
  EXPECT_NEAR(a.force_on_first.norm() / b.force_on_first.norm(), 1, facet_error);
  EXPECT_NEAR(a.area / b.area, 1, facet_error);
  EXPECT_NEAR(a.max_pressure / b.max_pressure, 1, 2 * facet_error);
}

/// The interference of 1 mm is short of or beyond the difference of the two surfaces' mean depths, 2/3 of s = L^2 / 8R
/// with facets of length L; the cells cut facets, which leaves a ripple of up to s of either side.
TEST(TriangleContact, RingsAreThoseOfCsg) {
  const auto csg = test::run_scene("scenes/rings.toml", {"n=16", "delta=1e-3"});
  test::SceneWithMeshes scene("rings.toml");
  const double b = 0.7, t = 1 / (1.3 * 16);
  const auto faces = [](const std::string& seed_of_rim, const std::string& seed_of_bore) {
    return std::vector<test::SceneWithMeshes::MeshFace>{
        {"quarter.x-", "xm", flat("[-1, 0, 0]")}, {"quarter.y-", "ym", flat("[0, -1, 0]")},
        {"quarter.z-", "zm", flat("[0, 0, -1]")}, {"quarter.z+", "zp", flat("[0, 0, 1]")},
        {"rim.side", "rim", curved(seed_of_rim)}, {"bore.side", "bore", curved(seed_of_bore)}};
  };
  const int facets[2] = {250, 330};
  scene.replace_shape("inner", ring_quarter(0.4, b, t, facets[0]), faces("[0.49, 0.5, 0.02]", "[0.28, 0.29, 0.02]"));
  scene.replace_shape("outer", ring_quarter(b, 1.0, t, facets[1]), faces("[0.7, 0.72, 0.02]", "[0.49, 0.5, 0.02]"));
  const auto mesh = scene.run({"n=16", "delta=1e-3"});
  const auto depth = [b](int n) { return b * std::pow(pi / (2 * n), 2) / 8; };
  expect_like_csg(mesh->results(), csg->results(), (depth(facets[0]) + depth(facets[1])) / 1e-3);
}

/// As above; the mean depth of equilateral facets is L^2 / 8R, the longest ones here have L = 1.5 pi b / 2 n.
TEST(TriangleContact, SphereInShellIsThatOfCsg) {
  const auto csg = test::run_scene("scenes/sphere_in_shell.toml", {"n=8", "delta=1e-3"});
  test::SceneWithMeshes scene("sphere_in_shell.toml");
  const double b = 0.7;
  const auto faces = [](const std::string& face, const std::string& seed) {
    return std::vector<test::SceneWithMeshes::MeshFace>{{"octant.x-", "xm", flat("[-1, 0, 0]")},
                                                        {"octant.y-", "ym", flat("[0, -1, 0]")},
                                                        {"octant.z-", "zm", flat("[0, 0, -1]")},
                                                        {face, "contact", curved(seed)}};
  };
  const int facets[2] = {150, 200};
  scene.replace_shape("sphere", ball_octant(b, facets[0]), faces("ball.surface", "[0.4, 0.41, 0.4]"));
  scene.replace_shape("shell", shell_octant(b, 1.0, facets[1]), faces("bore.surface", "[0.4, 0.41, 0.4]"));
  const auto mesh = scene.run({"n=8", "delta=1e-3"});
  const auto depth = [b](int n) { return b * std::pow(1.5 * pi / (2 * n), 2) / 8; };
  expect_like_csg(mesh->results(), csg->results(), (depth(facets[0]) + depth(facets[1])) / 1e-3);
}

/// A facet of a sphere on a plane changes the slope of the gap (0.1 at the edge of the contact) by L / R. With L =
/// 1/160 that is 6 % at the edges of the facets, averaged over four of them in each direction of a cell: 1 %, which is
/// the error allowed.
TEST(TriangleContact, HertzIsThatOfCsg) {
  const auto csg = test::run_scene("scenes/hertz.toml", {"n=20"});
  test::SceneWithMeshes scene("hertz.toml");
  scene.replace_shape("cap", cap_quarter(1.0, 0.5, 80),
                      {{"cut.x-", "xm", flat("[-1, 0, 0]")},
                       {"cut.y-", "ym", flat("[0, -1, 0]")},
                       {"cut.z+", "zp", flat("[0, 0, 1]")},
                       {"ball.surface", "ball", curved("[0.1, 0.11, 0.01]")}});
  const auto mesh = scene.run({"n=20"});
  expect_like_csg(mesh->results(), csg->results(), 0.015);
}

}  // namespace
}  // namespace cgcontact::test_triangle_contact
