#include "core/triangles/triangle_checks.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/errors/errors.hpp"
#include "core/triangles/triangle_crossings.hpp"
#include "core/triangles/triangle_edges.hpp"
#include "core/triangles/triangle_reader.hpp"
#include "core/triangles/triangle_surface.hpp"

namespace cgcontact {

namespace {

/// Fraction of the surface's diagonal: points on open edges nearer than this are one. Single precision is 1e-7 off.
constexpr double merge_distance = 1e-6;
/// Height over longest edge of a triangle that has no area.
constexpr double no_height = 1e-12;
/// Fraction of the diagonal: points of one shell nearer than this to another one are on it.
constexpr double near_shell = 1e-9;
/// Triangles of a shell that are asked whether they are inside another one.
constexpr std::size_t max_samples = 1000;

[[noreturn]] void fail(const std::string& file, const std::string& problem, const std::string& allowed) {
  throw InputError(SourceLocation{file, 0, ""}, "", problem, allowed);
}

std::string point_text(const Vec3& x) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0], x[1], x[2]); }

int drop_duplicates(TriangleSoup& soup) {
  // Turned such that the lowest corner comes first: equal triangles of equal orientation become equal.
  std::vector<int> order(soup.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<Triangle> turned = soup.triangles;
  for (Triangle& t : turned) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(order.begin(), order.end(), [&](int a, int b) { return std::tie(turned[a], a) < std::tie(turned[b], b); });
  std::vector<char> kept(soup.triangles.size(), 1);
  int gone = 0;
  for (std::size_t i = 1; i < order.size(); ++i)
    if (turned[order[i]] == turned[order[i - 1]]) {
      kept[order[i]] = 0;
      ++gone;
    }
  if (gone > 0) soup.keep(kept);
  return gone;
}

/// Merges points on open edges that are nearly the same.
int merge_near_points(TriangleSoup& soup) {
  std::vector<int> rim;
  each_edge(soup.triangles, soup.points.size(), [&](const std::vector<EdgeUse>& uses) {
    if (uses.size() != 1) return;
    const Triangle& t = soup.triangles[uses[0].triangle];
    rim.push_back(t[uses[0].corner]);
    rim.push_back(t[(uses[0].corner + 1) % 3]);
  });
  if (rim.empty()) return 0;
  std::sort(rim.begin(), rim.end());
  rim.erase(std::unique(rim.begin(), rim.end()), rim.end());
  return soup.merge(std::move(rim), merge_distance * soup.diagonal());
}

/// Longest edge of a triangle without area; -1 if it has one.
int edge_of_needle(const TriangleSoup& soup, const Triangle& c) {
  double longest = 0;
  int edge = 0;
  for (int e = 0; e < 3; ++e) {
    const double length = (soup.points[c[(e + 1) % 3]] - soup.points[c[e]]).norm();
    if (length > longest) edge = e;
    longest = std::max(longest, length);
  }
  const Vec3 twice_area = (soup.points[c[1]] - soup.points[c[0]]).cross(soup.points[c[2]] - soup.points[c[0]]);
  return twice_area.norm() > no_height * longest * longest ? -1 : edge;
}

}  // namespace

int remove_needles(TriangleSoup& soup) {
  std::vector<std::array<int, 3>> neighbours;
  std::vector<char> changed(soup.triangles.size(), 0);
  int gone = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const Triangle needle = soup.triangles[t];
    const int edge = changed[t] ? -1 : edge_of_needle(soup, needle);
    if (edge < 0) continue;
    if (neighbours.empty()) neighbours = edge_neighbours(soup.triangles, soup.points.size());
    const int other = neighbours[t][edge], middle = needle[(edge + 2) % 3];
    if (other < 0 || changed[other] || edge_of_needle(soup, soup.triangles[other]) >= 0) continue;
    Triangle second = soup.triangles[other];  // replaces the needle
    std::replace(soup.triangles[other].begin(), soup.triangles[other].end(), needle[edge], middle);
    std::replace(second.begin(), second.end(), needle[(edge + 1) % 3], middle);
    soup.triangles[t] = second;
    if (!soup.number.empty()) soup.number[t] = soup.number[other];
    if (!soup.line.empty()) soup.line[t] = soup.line[other];
    changed[t] = changed[other] = 1;
    ++gone;
  }
  return gone;
}

namespace {

std::string edge_location(const TriangleSoup& soup, const EdgeUse& use) {
  const Triangle& t = soup.triangles[use.triangle];
  return fmt::format("from {} to {}, {}", point_text(soup.points[t[use.corner]]),
                     point_text(soup.points[t[(use.corner + 1) % 3]]), soup.location(use.triangle));
}

void check_edges(const TriangleSoup& soup, const std::string& file) {
  int open = 0, crowded = 0, inconsistent = 0;
  std::string first_open, first_crowded, first_inconsistent;
  each_edge(soup.triangles, soup.points.size(), [&](const std::vector<EdgeUse>& uses) {
    if (uses.size() == 1 && open++ == 0) first_open = edge_location(soup, uses[0]);
    if (uses.size() > 2 && crowded++ == 0)
      first_crowded = fmt::format("{} triangles at the edge {}", uses.size(), edge_location(soup, uses[0]));
    const auto start = [&](const EdgeUse& use) { return soup.triangles[use.triangle][use.corner]; };
    if (uses.size() == 2 && start(uses[0]) == start(uses[1]) && inconsistent++ == 0)
      first_inconsistent = fmt::format("{} and {}", soup.location(uses[0].triangle), soup.location(uses[1].triangle));
  });
  if (open > 0)
    fail(file,
         fmt::format("the surface is not closed: {} open edge{}, the first {}", open, open > 1 ? "s" : "", first_open),
         "a closed surface");
  if (crowded > 0)
    fail(file,
         fmt::format("{} edge{} belong{} to more than two triangles: {}", crowded, crowded > 1 ? "s" : "",
                     crowded > 1 ? "" : "s", first_crowded),
         "two triangles at every edge");
  if (inconsistent > 0)
    fail(file,
         fmt::format("neighbouring triangles disagree about which side is outside at {} edge{}: {}", inconsistent,
                     inconsistent > 1 ? "s" : "", first_inconsistent),
         "all triangles counterclockwise seen from outside");
}

/// Returns the connected component of every triangle.
std::vector<int> find_shells(const TriangleSoup& soup, int& count) {
  const auto neighbours = edge_neighbours(soup.triangles, soup.points.size());
  std::vector<int> shell(soup.triangles.size(), -1);
  count = 0;
  for (std::size_t t = 0; t < shell.size(); ++t) {
    if (shell[t] >= 0) continue;
    flood(
        neighbours, static_cast<int>(t), [&](int, int to) { return shell[to] < 0; },
        [&](int now) { shell[now] = count; });
    ++count;
  }
  return shell;
}

void turn(TriangleSoup& soup) {
  for (Triangle& t : soup.triangles) std::swap(t[1], t[2]);
}

/// Returns whether one shell is inside another one, by some of its triangles' centroids, of which those on the other
/// shell do not count; throws if they disagree, or none counts. `own_triangle`, `other_triangle`: one of each in the
/// soup.
bool is_inside(const TriangleSurface& shell, const TriangleSurface& other, const TriangleSoup& soup, int own_triangle,
               int other_triangle, const std::string& file) {
  const double distance = near_shell * soup.diagonal();
  const std::size_t count = shell.triangles().size(), stride = 1 + count / max_samples;
  int inside = 0, outside = 0, on_it = 0;
  for (std::size_t t = 0; t < count; t += stride) {
    const int triangle = static_cast<int>(t);
    const Vec3 x = (shell.corner(triangle, 0) + shell.corner(triangle, 1) + shell.corner(triangle, 2)) / 3;
    ++(other.nearest(x, -1, distance).triangle >= 0 ? on_it : other.contains(x) ? inside : outside);
  }
  if (on_it > 0 || (inside > 0) == (outside > 0))
    fail(file,
         fmt::format("two shells overlap or lie on each other: the one with {} and the one with {}",
                     soup.location(own_triangle), soup.location(other_triangle)),
         "shells apart from each other or wholly inside, united in the CAD program or as bodies of their own");
  return inside > 0;
}

/// Turns the surface outwards if all of it points inwards; refuses shells that disagree.
void orient(TriangleSoup& soup, const std::string& file, SurfaceRepairs& repairs) {
  const std::vector<int> shell = find_shells(soup, repairs.shells);
  std::vector<TriangleSoup> soups(repairs.shells);
  std::vector<int> first(repairs.shells, -1);
  for (std::size_t t = 0; t < shell.size(); ++t) {
    soups[shell[t]].triangles.push_back(soup.triangles[t]);
    if (first[shell[t]] < 0) first[shell[t]] = static_cast<int>(t);
  }
  std::vector<char> inward;
  std::vector<TriangleSurface> surfaces;
  for (TriangleSoup& own : soups) {
    if (repairs.shells > 1) {  // its own points only
      std::vector<Vec3> points;
      for (Triangle& t : own.triangles)
        for (int& p : t) {
          points.push_back(soup.points[p]);
          p = static_cast<int>(points.size()) - 1;
        }
      own.points = std::move(points);
      merge_equal_points(own);
    } else {
      own.points = soup.points;
    }
    inward.push_back(own.signed_volume() < 0);
    if (inward.back()) turn(own);
    if (repairs.shells > 1)
      surfaces.emplace_back(own.points, own.triangles, std::vector<int>(own.triangles.size(), 0),
                            std::vector<std::string>{""});
  }
  std::vector<Eigen::AlignedBox3d> boxes(surfaces.size());
  for (std::size_t k = 0; k < surfaces.size(); ++k)
    for (const Vec3& x : surfaces[k].points()) boxes[k].extend(x);
  std::vector<char> wrong;
  for (int s = 0; s < repairs.shells; ++s) {
    int depth = 0;
    for (int o = 0; o < static_cast<int>(surfaces.size()); ++o)
      if (o != s && boxes[s].intersects(boxes[o]) &&
          is_inside(surfaces[s], surfaces[o], soup, first[s], first[o], file))
        ++depth;
    wrong.push_back(inward[s] != (depth % 2 == 1));
  }
  const auto count = std::count(wrong.begin(), wrong.end(), char{1});
  if (count == 0) return;
  if (count < repairs.shells) {
    const auto bad = std::find(wrong.begin(), wrong.end(), char{1}) - wrong.begin();
    fail(file,
         fmt::format("{} of {} shells {} inside out: the one with {}", count, repairs.shells, count > 1 ? "are" : "is",
                     soup.location(first[bad])),
         "normals out of the material: inwards only in cavities");
  }
  turn(soup);
  repairs.turned = true;
}

void check_crossings(const TriangleSoup& soup, const std::string& file) {
  const std::vector<std::pair<int, int>> pairs = find_crossings(soup.points, soup.triangles);
  if (pairs.empty()) return;
  fail(file,
       fmt::format("the surface crosses itself: {} pair{} of triangles, the first {} and {}", pairs.size(),
                   pairs.size() > 1 ? "s" : "", soup.location(pairs[0].first), soup.location(pairs[0].second)),
       "triangles that meet at common edges and corners only");
}

void check_finite(const TriangleSoup& soup, const std::string& file) {
  for (std::size_t p = 0; p < soup.points.size(); ++p)
    if (!soup.points[p].allFinite()) fail(file, fmt::format("point {} is not finite", p + 1), "finite coordinates");
}

/// Everything but the merging of points.
void check_merged(TriangleSoup& soup, const std::string& file, SurfaceRepairs& repairs) {
  for (int gone = 1, pass = 0; gone > 0 && pass < max_needle_passes; repairs.zero_area += gone, ++pass)
    gone = remove_needles(soup);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    if (edge_of_needle(soup, soup.triangles[t]) >= 0)
      fail(file,
           soup.location(static_cast<int>(t)) + " has no area, and its neighbours do not close the surface without it",
           "triangles with an area");
  if (soup.triangles.empty()) fail(file, "no triangle has an area", "a closed surface");
  check_edges(soup, file);
  check_crossings(soup, file);
  orient(soup, file, repairs);
  repairs.num_triangles = static_cast<int>(soup.triangles.size());
}

}  // namespace

std::string SurfaceRepairs::text() const {
  std::string result;
  const auto add = [&](int count, const char* one, const char* many) {
    if (count == 0) return;
    if (!result.empty()) result += ", ";
    result += fmt::format("{} {}", count, count > 1 ? many : one);
  };
  add(merged_points, "duplicate point merged", "duplicate points merged");
  add(zero_area, "triangle without area removed", "triangles without area removed");
  add(duplicates, "duplicate triangle removed", "duplicate triangles removed");
  if (turned) result += std::string(result.empty() ? "" : ", ") + "surface turned outwards";
  return result;
}

SurfaceRepairs repair_and_check(TriangleSoup& soup, const std::string& file) {
  SurfaceRepairs repairs;
  check_finite(soup, file);
  repairs.merged_points = merge_equal_points(soup);
  repairs.zero_area = soup.drop_collapsed();
  repairs.duplicates = drop_duplicates(soup);
  if (const int merged = merge_near_points(soup); merged > 0) {
    repairs.merged_points += merged;
    repairs.zero_area += soup.drop_collapsed();
  }
  check_merged(soup, file, repairs);
  return repairs;
}

SurfaceRepairs check_separated(TriangleSoup& soup, const std::string& file) {
  SurfaceRepairs repairs;
  check_finite(soup, file);
  check_merged(soup, file, repairs);
  return repairs;
}

}  // namespace cgcontact
