#include "core/triangles/triangle_arrangement.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/base/process/parallel.hpp"
#include "core/triangles/triangle_checks.hpp"
#include "core/triangles/triangle_edges.hpp"
#include "core/triangles/triangle_reader.hpp"
#include "core/triangles/winding_numbers.hpp"

namespace cgcontact {
namespace {

using Predicates = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPoint = Exact::Point_3;
using Division = CGAL::Constrained_Delaunay_triangulation_2<Exact, CGAL::Default, CGAL::Exact_intersections_tag>;

/// From an integer: a winding number farther off is that of a point that rounding has put on the surface.
constexpr double clear_winding = 0.1;
constexpr std::size_t max_samples = 5;                   // of a patch
constexpr int num_kinds = WindingNumbers::num_surfaces;  // solids, cavities

/// A triangle and how often each kind of surface passes it: in its own sense minus the other one, the first not less
/// than 0.
struct Facet {
  Triangle corners;
  WindingNumbers::Passes passes;
};

/// Triangles cut along all intersections.
class Cutter {
 public:
  Cutter(const TriangleSoup& solids, const TriangleSoup& cavities) {
    for (const TriangleSoup* soup : {&solids, &cavities}) {
      const int first = static_cast<int>(soup_.points.size());
      soup_.points.insert(soup_.points.end(), soup->points.begin(), soup->points.end());
      for (const Triangle& t : soup->triangles) soup_.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
      kind_.resize(soup_.triangles.size(), soup == &solids ? 0 : 1);
    }
    merge_equal_points(soup_);
    for (const Vec3& x : soup_.points) points_.emplace_back(x[0], x[1], x[2]);
  }

  /// Returns the fragments, those that coincide as one, none that cancel.
  std::vector<Facet> run(std::vector<Vec3>& points) {
    const std::size_t n = soup_.triangles.size();
    std::vector<char> has_area(n);
    for (std::size_t t = 0; t < n; ++t) {
      const Triangle& c = soup_.triangles[t];
      has_area[t] = !CGAL::collinear(points_[c[0]], points_[c[1]], points_[c[2]]);
    }
    cuts_.resize(n);
    std::vector<std::vector<int>> partners(n);
    const TriangleTree tree(soup_.points, soup_.triangles);
    parallel_for("cgcontact::triangle_arrangement::partners", n, 256, [&](std::size_t t) {
      if (has_area[t]) find_partners(tree, static_cast<int>(t), has_area, partners[t]);
    });
    for (std::size_t t = 0; t < n; ++t)
      for (const int other : partners[t]) intersect(static_cast<int>(t), other);
    for (std::size_t t = 0; t < n; ++t)
      if (!cuts_[t].empty())
        for (const int p : soup_.triangles[t]) number_of_.emplace(exact(p), p);
    for (std::size_t t = 0; t < n; ++t) {
      if (!has_area[t]) continue;
      if (cuts_[t].empty())
        add(soup_.triangles[t], kind_[t]);
      else
        divide(static_cast<int>(t));
    }
    points = soup_.points;
    std::vector<Facet> facets;
    for (const auto& [key, count_of] : facets_) {
      Triangle corners = key;
      WindingNumbers::Passes passes = count_of;
      if (passes[0] == 0 && passes[1] == 0) continue;
      if ((passes[0] != 0 ? passes[0] : passes[1]) < 0) {  // then neighbours have the same sense
        std::swap(corners[1], corners[2]);
        for (int& count : passes) count = -count;
      }
      facets.push_back({corners, passes});
    }
    return facets;
  }

 private:
  using Cut = std::pair<ExactPoint, ExactPoint>;  ///< a segment, or a point twice

  /// Triangles after t that meet it in more than common corners and edges.
  void find_partners(const TriangleTree& tree, int t, const std::vector<char>& has_area,
                     std::vector<int>& found) const {
    Eigen::AlignedBox3d box;
    for (const int p : soup_.triangles[t]) box.extend(soup_.points[p]);
    tree.visit(
        [&](const Vec3& min, const Vec3& max) {
          return (min.array() <= box.max().array()).all() && (max.array() >= box.min().array()).all();
        },
        [&](int other) {
          if (other > t && has_area[other] && meet(soup_.triangles[t], soup_.triangles[other])) found.push_back(other);
        });
  }

  Predicates::Triangle_3 flat(const Triangle& t) const { return {points_[t[0]], points_[t[1]], points_[t[2]]}; }

  bool meet(Triangle s, Triangle t) const {
    // Common corners first.
    int shared = 0;
    for (int i = 0; i < 3; ++i) {
      const auto same = std::find(t.begin() + shared, t.end(), s[i]);
      if (same == t.end()) continue;
      std::iter_swap(t.begin() + shared, same);
      std::swap(s[shared++], s[i]);
    }
    const auto edge = [&](const Triangle& c) { return Predicates::Segment_3(points_[c[1]], points_[c[2]]); };
    if (shared == 3) return false;
    if (shared == 2)
      return CGAL::coplanar(points_[s[0]], points_[s[1]], points_[s[2]], points_[t[2]]) &&
             CGAL::coplanar_orientation(points_[s[0]], points_[s[1]], points_[s[2]], points_[t[2]]) == CGAL::POSITIVE;
    if (shared == 1) return CGAL::do_intersect(edge(s), flat(t)) || CGAL::do_intersect(edge(t), flat(s));
    return CGAL::do_intersect(flat(s), flat(t));
  }

  ExactPoint exact(int p) const {
    const Vec3& x = soup_.points[p];
    return {x[0], x[1], x[2]};
  }
  Exact::Triangle_3 exact(const Triangle& t) const { return {exact(t[0]), exact(t[1]), exact(t[2])}; }

  void intersect(int a, int b) {
    const auto common = CGAL::intersection(exact(soup_.triangles[a]), exact(soup_.triangles[b]));
    if (!common) return;
    std::vector<ExactPoint> corners;
    if (const auto* point = boost::get<ExactPoint>(&*common)) corners = {*point};
    if (const auto* segment = boost::get<Exact::Segment_3>(&*common)) corners = {segment->source(), segment->target()};
    if (const auto* triangle = boost::get<Exact::Triangle_3>(&*common))
      corners = {triangle->vertex(0), triangle->vertex(1), triangle->vertex(2)};
    if (const auto* polygon = boost::get<std::vector<ExactPoint>>(&*common)) corners = *polygon;
    for (std::size_t i = 0; i < (corners.size() < 3 ? 1 : corners.size()); ++i)
      for (const int t : {a, b}) cuts_[t].emplace_back(corners[i], corners[(i + 1) % corners.size()]);
  }

  /// Divides a triangle, in the coordinate plane nearest to it.
  void divide(int t) {
    const Triangle& corners = soup_.triangles[t];
    const Vec3 normal = (soup_.points[corners[1]] - soup_.points[corners[0]])
                            .cross(soup_.points[corners[2]] - soup_.points[corners[0]]);
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    Exact::Plane_3 plane(exact(corners[0]), exact(corners[1]), exact(corners[2]));
    Exact::FT normal_of[3] = {plane.a(), plane.b(), plane.c()};
    if (CGAL::is_zero(normal_of[axis]))  // rounding of a needle
      for (int k = 0; k < 3; ++k)
        if (!CGAL::is_zero(normal_of[k])) axis = k;
    const int s = (axis + 1) % 3, r = (axis + 2) % 3;
    const auto flat_point = [&](const ExactPoint& x) { return Exact::Point_2(x[s], x[r]); };
    Division division;
    Division::Vertex_handle own[3];
    for (int k = 0; k < 3; ++k) own[k] = division.insert(flat_point(exact(corners[k])));
    for (int k = 0; k < 3; ++k) division.insert_constraint(own[k], own[(k + 1) % 3]);
    for (const auto& [from, to] : cuts_[t]) {
      const auto first = division.insert(flat_point(from)), last = division.insert(flat_point(to));
      if (first != last) division.insert_constraint(first, last);
    }
    std::map<Division::Vertex_handle, int> number;
    for (const Division::Vertex_handle v : division.finite_vertex_handles()) {
      Exact::FT x[3];
      x[s] = v->point().x();
      x[r] = v->point().y();
      x[axis] = -(normal_of[s] * x[s] + normal_of[r] * x[r] + plane.d()) / normal_of[axis];
      number[v] = number_of_point({x[0], x[1], x[2]});
    }
    const bool turned = normal_of[axis] < 0;
    for (const Division::Face_handle f : division.finite_face_handles()) {
      Triangle triangle{number.at(f->vertex(0)), number.at(f->vertex(1)), number.at(f->vertex(2))};
      if (turned) std::swap(triangle[1], triangle[2]);
      add(triangle, kind_[t]);
    }
  }

  int number_of_point(const ExactPoint& x) {
    const auto [entry, is_new] = number_of_.try_emplace(x, static_cast<int>(soup_.points.size()));
    if (is_new) soup_.points.emplace_back(CGAL::to_double(x.x()), CGAL::to_double(x.y()), CGAL::to_double(x.z()));
    return entry->second;
  }

  void add(Triangle corners, int kind) {
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    const bool turned = corners[1] > corners[2];
    if (turned) std::swap(corners[1], corners[2]);
    facets_[corners][static_cast<std::size_t>(kind)] += turned ? -1 : 1;
  }

  TriangleSoup soup_;
  std::vector<int> kind_;
  std::vector<Predicates::Point_3> points_;  ///< those of the surfaces
  std::vector<std::vector<Cut>> cuts_;
  std::map<ExactPoint, int> number_of_;  ///< of the corners of divided triangles
  std::map<Triangle, WindingNumbers::Passes> facets_;
};

/// Numbers of the patches: facets that meet at edges of two.
std::vector<int> find_patches(const std::vector<Triangle>& triangles, std::size_t num_points, int& count) {
  std::vector<std::array<int, 3>> neighbours(triangles.size(), {-1, -1, -1});
  each_edge(triangles, num_points, [&](const std::vector<EdgeUse>& uses) {
    if (uses.size() != 2) return;
    neighbours[uses[0].triangle][uses[0].corner] = uses[1].triangle;
    neighbours[uses[1].triangle][uses[1].corner] = uses[0].triangle;
  });
  std::vector<int> patch(triangles.size(), -1);
  count = 0;
  for (std::size_t t = 0; t < patch.size(); ++t) {
    if (patch[t] >= 0) continue;
    flood(
        neighbours, static_cast<int>(t), [&](int, int to) { return patch[to] < 0; },
        [&](int now) { patch[now] = count; });
    ++count;
  }
  return patch;
}

/// Finds the facets that separate inside and outside: 1 with the inside behind, -1 in front, 0 neither. One answer for
/// a patch, from the winding numbers about one of its largest facets.
std::vector<int> find_sides(const std::vector<Facet>& facets, const std::vector<Vec3>& points) {
  std::vector<Triangle> triangles;
  std::vector<WindingNumbers::Passes> passes;
  std::vector<double> area;
  for (const Facet& f : facets) {
    triangles.push_back(f.corners);
    passes.push_back(f.passes);
    const Vec3& a = points[f.corners[0]];
    area.push_back((points[f.corners[1]] - a).cross(points[f.corners[2]] - a).norm());
  }
  int count = 0;
  const std::vector<int> patch = find_patches(triangles, points.size(), count);
  std::vector<std::vector<int>> members(static_cast<std::size_t>(count));
  for (std::size_t f = 0; f < facets.size(); ++f)
    members[static_cast<std::size_t>(patch[f])].push_back(static_cast<int>(f));

  const WindingNumbers winding_numbers(points, triangles, passes);
  std::vector<int> side(facets.size(), 0);
  parallel_for("cgcontact::triangle_arrangement::sides", members.size(), 1, [&](std::size_t p) {
    std::vector<int>& list = members[p];
    const std::size_t samples = std::min(max_samples, list.size());
    std::partial_sort(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(samples), list.end(),
                      [&](int a, int b) { return std::make_pair(-area[a], a) < std::make_pair(-area[b], b); });
    int answer = 0;
    double least = 1e300;
    for (std::size_t i = 0; i < samples && least > clear_winding; ++i) {
      const Triangle& own = triangles[static_cast<std::size_t>(list[i])];
      const Vec3 centroid = (points[own[0]] + points[own[1]] + points[own[2]]) / 3;
      const auto middle = winding_numbers.at(centroid, list[i]);  // mean of both sides
      double doubt = 0;
      const auto is_inside = [&](double sense) {
        double number[num_kinds];
        for (std::size_t k = 0; k < num_kinds; ++k) {
          const double winding = middle[k] + sense * passes[static_cast<std::size_t>(list[i])][k] / 2;
          number[k] = std::round(winding);
          doubt = std::max(doubt, std::abs(winding - number[k]));
        }
        return number[0] != 0 && number[1] == 0;
      };
      const int found = static_cast<int>(is_inside(1)) - static_cast<int>(is_inside(-1));
      if (doubt >= least) continue;
      least = doubt;
      answer = found;
    }
    for (const int f : list) side[static_cast<std::size_t>(f)] = answer;
  });
  return side;
}

/// Triangles that are there in both senses go.
void cancel(TriangleSoup& soup) {
  std::map<Triangle, std::vector<int>> found;
  std::vector<char> kept(soup.triangles.size(), 1);
  for (std::size_t t = 0; t < kept.size(); ++t) {
    Triangle c = soup.triangles[t];
    kept[t] = c[0] != c[1] && c[1] != c[2] && c[2] != c[0];
    if (!kept[t]) continue;
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    const auto opposite = found.find({c[0], c[2], c[1]});
    if (opposite == found.end() || opposite->second.empty()) {
      found[c].push_back(static_cast<int>(t));
      continue;
    }
    kept[t] = kept[opposite->second.back()] = 0;
    opposite->second.pop_back();
  }
  soup.keep(kept);
}

using EdgePair = std::pair<EdgeUse, EdgeUse>;

/// Neighbours at an edge: triangles with body between them.
std::vector<EdgePair> pairs_at_edge(const TriangleSoup& soup, const std::vector<EdgeUse>& uses) {
  if (uses.size() == 2) return {{uses[0], uses[1]}};
  const auto point = [&](const EdgeUse& use, int next) -> const Vec3& {
    return soup.points[soup.triangles[use.triangle][(use.corner + next) % 3]];
  };
  const auto start_of = [&](const EdgeUse& use) { return soup.triangles[use.triangle][use.corner]; };
  const Vec3 start = point(uses[0], 0), along = (point(uses[0], 1) - start).normalized();
  const Vec3 s = along.unitOrthogonal(), r = along.cross(s);
  struct Use {
    double angle;
    bool forward;
    EdgeUse edge;
  };
  std::vector<Use> around;
  for (const EdgeUse& use : uses) {
    const Vec3 x = point(use, 2) - start;
    around.push_back({std::atan2(x.dot(r), x.dot(s)), start_of(use) == start_of(uses[0]), use});
  }
  std::sort(around.begin(), around.end(), [](const Use& a, const Use& b) {
    return std::tie(a.angle, a.edge.triangle) < std::tie(b.angle, b.edge.triangle);
  });
  // Body begins behind a triangle that has the edge backwards and ends at the next one that has it forwards.
  std::vector<EdgePair> pairs;
  std::vector<EdgeUse> open;
  std::vector<char> done(around.size(), 0);
  for (std::size_t i = 0; i < 2 * around.size(); ++i) {
    const std::size_t k = i % around.size();
    if (done[k]) continue;
    if (!around[k].forward) {
      if (i < around.size()) open.push_back(around[k].edge);
    } else if (!open.empty()) {
      pairs.emplace_back(around[k].edge, open.back());
      open.pop_back();
      done[k] = 1;
    }
  }
  return pairs;
}

/// Separates the surface where more than two triangles meet at an edge, or several fans of them at a point.
void separate_fans(TriangleSoup& soup) {
  std::vector<int> leader(3 * soup.triangles.size());  // of every corner of a triangle
  std::iota(leader.begin(), leader.end(), 0);
  const auto find = [&](int c) {
    while (leader[c] != c) c = leader[c] = leader[leader[c]];
    return c;
  };
  const auto corner = [&](const EdgeUse& use, int next) { return 3 * use.triangle + (use.corner + next) % 3; };
  each_edge(soup.triangles, soup.points.size(), [&](const std::vector<EdgeUse>& uses) {
    for (const auto& [a, b] : pairs_at_edge(soup, uses)) {  // of opposite senses
      leader[find(corner(a, 0))] = find(corner(b, 1));
      leader[find(corner(a, 1))] = find(corner(b, 0));
    }
  });
  TriangleSoup separated;
  std::map<int, int> number;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    Triangle corners;
    for (int k = 0; k < 3; ++k) {
      const auto [entry, is_new] =
          number.try_emplace(find(3 * static_cast<int>(t) + k), static_cast<int>(separated.points.size()));
      if (is_new) separated.points.push_back(soup.points[soup.triangles[t][k]]);
      corners[k] = entry->second;
    }
    separated.triangles.push_back(corners);
  }
  soup = std::move(separated);
}

/// Gives pairs of neighbours at a shared edge a middle of their own: where the fans about both ends are one, the ends
/// cannot be separated.
void split_common_edges(TriangleSoup& soup) {
  for (bool more = true; more;) {
    more = false;
    std::vector<EdgePair> pairs;
    std::vector<char> taken(soup.triangles.size(), 0);
    each_edge(soup.triangles, soup.points.size(), [&](const std::vector<EdgeUse>& uses) {
      if (uses.size() <= 2) return;
      for (const EdgePair& pair : pairs_at_edge(soup, uses)) {
        if (taken[pair.first.triangle] || taken[pair.second.triangle]) {
          more = true;
          continue;
        }
        taken[pair.first.triangle] = taken[pair.second.triangle] = 1;
        pairs.push_back(pair);
      }
    });
    for (const auto& [a, b] : pairs) {
      const Triangle& ends = soup.triangles[a.triangle];
      const int middle = static_cast<int>(soup.points.size());
      soup.points.push_back((soup.points[ends[a.corner]] + soup.points[ends[(a.corner + 1) % 3]]) / 2);
      for (const EdgeUse& use : {a, b}) {
        Triangle second = soup.triangles[use.triangle];
        soup.triangles[use.triangle][(use.corner + 1) % 3] = middle;
        second[use.corner] = middle;
        soup.triangles.push_back(second);
      }
    }
    more = more && !pairs.empty();
  }
}

}  // namespace

TriangleSoup outer_boundary(const TriangleSoup& solids, const TriangleSoup& cavities, double one_point) {
  TriangleSoup result;
  const std::vector<Facet> facets = Cutter(solids, cavities).run(result.points);
  const std::vector<int> side = find_sides(facets, result.points);
  for (std::size_t f = 0; f < facets.size(); ++f) {
    Triangle t = facets[f].corners;
    if (side[f] < 0) std::swap(t[1], t[2]);
    if (side[f] != 0) result.triangles.push_back(t);
  }
  std::vector<int> used;
  for (const Triangle& t : result.triangles) used.insert(used.end(), t.begin(), t.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  result.merge(std::move(used), one_point);
  separate_where_touching(result);
  return result;
}

void separate_where_touching(TriangleSoup& soup) {
  for (int pass = 0; pass < max_needle_passes; ++pass) {
    cancel(soup);
    separate_fans(soup);
    if (remove_needles(soup) == 0) break;
  }
  split_common_edges(soup);
}

}  // namespace cgcontact
