#include "core/bodies/clipped_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "core/base/errors/errors.hpp"
#include "core/bodies/cell_facets.hpp"
#include "core/quadrature/gauss_rules.hpp"
#include "core/quadrature/point_compression.hpp"

namespace cgcontact {

namespace {

constexpr double plane_tolerance = 1e-10;
constexpr double grid_plane_tolerance = 1e-12;
constexpr double join_tolerance = 1e-12;      // relative: facets as large as their convex hull fill it
constexpr double straight_tolerance = 1e-13;  // sine of the angle at a corner
constexpr double parallel_tolerance = 1e-14;
/// Planes up to which they get the full rule, or one of degree 2: of a patch in a cell, of all patches in a cell.
constexpr int full_rule_planes = 8, quadratic_rule_planes = 32;
constexpr int full_rule_planes_of_cell = 32, quadratic_rule_planes_of_cell = 128;
/// Areas (cell units) from which facets of patches with more planes get the full rule, a rule of degree 2.
constexpr double full_rule_area = 1.0 / 16, quadratic_rule_area = 1.0 / 128;

/// Limits for a curved face of a CAD body in a cell: points from which those that stay are chosen (some 30); triangles
/// from which on they are small, and rules on them need two degrees less.
constexpr int few_points = 60, many_triangles = 15;

/// Sides of all dividers, one bit each.
using Sides = std::array<std::uint64_t, 4>;

/// Facet as the dividers leave it: on one side of each.
struct DividedFacet {
  int patch, plane;
  Sides sides;
  int triangle;
  SurfacePolygon polygon;
  auto key() const { return std::tie(patch, sides, plane); }
};

struct PatchPlane {
  int number;  ///< among those of the cell
  Vec3 normal, point;
};

Vec3 twice_area(const SurfacePolygon& p) {
  Vec3 sum = Vec3::Zero();
  for (int i = 1; i + 1 < p.n; ++i) sum += (p.x[i] - p.x[0]).cross(p.x[i + 1] - p.x[0]);
  return sum;
}

/// Cuts a polygon by a chord where the values of its corners change sign; cut(a, b) is the point between a negative and
/// a positive corner. The positive polygon is the run of positive corners around the largest value, the other has all
/// others: exact even where by rounding the polygon seems crossed more than twice. A polygon without corners of its
/// sign is empty.
template <class Value, class Cut>
void cut_polygon(const SurfacePolygon& polygon, const Value& value, const Cut& cut, SurfacePolygon& negative,
                 SurfacePolygon& positive) {
  negative.n = positive.n = 0;
  std::array<double, SurfacePolygon::max_corners> values;
  int top = 0;
  bool any_negative = false;
  for (int i = 0; i < polygon.n; ++i) {
    values[i] = value(polygon.x[i]);
    if (values[i] > values[top]) top = i;
    any_negative |= values[i] < 0;
  }
  if (!(values[top] > 0)) {
    negative = polygon;
    return;
  }
  if (!any_negative) {
    positive = polygon;
    return;
  }
  const auto next = [&](int i) { return i + 1 < polygon.n ? i + 1 : 0; };
  const auto previous = [&](int i) { return i > 0 ? i - 1 : polygon.n - 1; };
  int first = top, last = top;
  while (values[previous(first)] > 0) first = previous(first);
  while (values[next(last)] > 0) last = next(last);
  const auto end_of_run = [&](int inside, int outside) {
    return values[outside] == 0 ? polygon.x[outside] : cut(polygon.x[outside], polygon.x[inside]);
  };
  const Vec3 begin = end_of_run(first, previous(first)), end = end_of_run(last, next(last));
  positive.push(begin);
  for (int i = first; i != next(last); i = next(i)) positive.push(polygon.x[i]);
  positive.push(end);
  negative.push(end);
  for (int i = next(last); i != first; i = next(i))
    if (!(values[i] == 0 && (i == next(last) || i == previous(first)))) negative.push(polygon.x[i]);
  negative.push(begin);
}

/// Splits into the polygons on the negative side of a plane and on the other one.
void split_at(const SurfacePolygon& polygon, const Plane& plane, SurfacePolygon& negative, SurfacePolygon& positive) {
  const auto value = [&](const Vec3& x) { return plane.normal.dot(x) - plane.offset; };
  cut_polygon(
      polygon, value,
      [&](const Vec3& low, const Vec3& high) {
        const double a = value(low), b = value(high);
        return Vec3(low + a / (a - b) * (high - low));
      },
      negative, positive);
}

/// Returns whether the polygon lies in the plane, up to rounding of its corners.
bool lies_in(const SurfacePolygon& polygon, const Plane& plane) {
  return std::all_of(polygon.x.begin(), polygon.x.begin() + polygon.n,
                     [&](const Vec3& x) { return std::abs(plane.normal.dot(x) - plane.offset) < plane_tolerance; });
}

struct RulePoint {
  Vec3 position;
  double weight;
};

/// Axes that span the coordinate plane nearest to the plane with this normal.
std::pair<int, int> plane_axes(const Vec3& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return {(axis + 1) % 3, (axis + 2) % 3};
}

/// Corners of the convex hull in the plane of two axes (Andrew's monotone chain), without corners on straight edges.
std::vector<Vec3> convex_hull(std::vector<Vec3>& points, int s, int t) {
  std::sort(points.begin(), points.end(),
            [&](const Vec3& a, const Vec3& b) { return std::tie(a[s], a[t]) < std::tie(b[s], b[t]); });
  const auto turns_left = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const double us = b[s] - a[s], ut = b[t] - a[t], vs = c[s] - b[s], vt = c[t] - b[t];
    const double size = (std::abs(us) + std::abs(ut)) * (std::abs(vs) + std::abs(vt));
    return us * vt - ut * vs > straight_tolerance * size;
  };
  std::vector<Vec3> hull;
  const auto add = [&](const Vec3& x, std::size_t fixed) {
    while (hull.size() >= fixed + 2 && !turns_left(hull[hull.size() - 2], hull.back(), x)) hull.pop_back();
    hull.push_back(x);
  };
  for (const Vec3& x : points) add(x, 0);
  hull.pop_back();
  const std::size_t lower = hull.size();
  for (auto x = points.rbegin(); x != points.rend(); ++x) add(*x, lower);
  hull.pop_back();
  return hull;
}

/// Appends the points of a rule that is exact for polynomials of the degree.
void add_polygon_rule(const SurfacePolygon& p, int degree, std::vector<RulePoint>& points) {
  const bool is_parallelogram =
      p.n == 4 && (p.x[0] - p.x[1] + p.x[2] - p.x[3]).lpNorm<Eigen::Infinity>() <= parallel_tolerance;
  if (is_parallelogram && degree > 1) {
    const GaussRule& gauss = gauss_rule(degree / 2 + 1);
    const Vec3 u = p.x[1] - p.x[0], v = p.x[3] - p.x[0];
    const double area = u.cross(v).norm();
    for (std::size_t i = 0; i < gauss.node.size(); ++i)
      for (std::size_t j = 0; j < gauss.node.size(); ++j)
        points.push_back({p.x[0] + gauss.node[i] * u + gauss.node[j] * v, area * gauss.weight[i] * gauss.weight[j]});
    return;
  }
  const TriangleRule& rule = triangle_rule(degree);
  for (int k = 1; k + 1 < p.n; ++k) {
    const Vec3 u = p.x[k] - p.x[0], v = p.x[k + 1] - p.x[0];
    const double area = 0.5 * u.cross(v).norm();
    if (area == 0) continue;
    for (std::size_t q = 0; q < rule.weight.size(); ++q)
      points.push_back({p.x[0] + rule.a[q] * u + rule.b[q] * v, area * rule.weight[q]});
  }
}

/// Leaves no more points than there are polynomials of the degree on the plane; those without weight stay.
void compress(const Vec3& normal, int degree, std::vector<RulePoint>& points) {
  if (points.size() <= static_cast<std::size_t>((degree + 1) * (degree + 2) / 2)) return;
  const auto [s, t] = plane_axes(normal);
  std::vector<double> weights, local[3];
  for (const RulePoint& p : points) {
    local[0].push_back(p.position[s] - points[0].position[s]);
    local[1].push_back(p.position[t] - points[0].position[t]);
    local[2].push_back(0);
    weights.push_back(p.weight);
  }
  compress_weights(surface_polynomials(local, degree, false), weights);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].weight = weights[i];
}

/// Point of a patch with many planes.
struct FacetPoint {
  RulePoint point;
  Vec3 normal;
};

/// Evaluates the functions that the reduced points of a patch with many planes integrate exactly: with s, t, z along
/// the coordinate axes, z the one nearest to the mean normal, all polynomials of degree 3 in (s, t), those of degree 2
/// times z, z^2, and each component of the normal times 1, s, t, z. This keeps forces and moments of pressures and
/// tractions, and the area's second moments.
FunctionTable facet_functions(const std::vector<FacetPoint>& points) {
  constexpr int degree = 3;
  Vec3 mean = Vec3::Zero();
  for (const FacetPoint& p : points) mean += p.point.weight * p.normal;
  const auto [s, t] = plane_axes(mean);
  const int axes[3] = {s, t, 3 - s - t}, n = static_cast<int>(points.size());
  std::vector<double> local[3];
  for (int k = 0; k < 3; ++k)
    for (const FacetPoint& p : points) local[k].push_back(p.point.position[axes[k]]);
  FunctionTable table = surface_polynomials(local, degree, true);  // scales the positions to -1 .. 1
  int f = table.num_functions;
  table.num_functions += 13;
  table.values.resize(static_cast<std::size_t>(table.num_functions) * n);
  for (int k = 0; k < 3; ++k, f += 4)
    for (int p = 0; p < n; ++p) {
      table[f][p] = points[p].normal[k];
      for (int i = 0; i < 3; ++i) table[f + 1 + i][p] = points[p].normal[k] * local[i][p];
    }
  for (int p = 0; p < n; ++p) table[f][p] = local[2][p] * local[2][p];
  return table;
}

/// The values of some functions at the points begin .. end.
FunctionTable columns(const FunctionTable& table, std::size_t begin, std::size_t end) {
  FunctionTable result;
  result.resize(table.num_functions, static_cast<int>(end - begin));
  for (int f = 0; f < table.num_functions; ++f) std::copy(table[f] + begin, table[f] + end, result[f]);
  return result;
}

class PointMaker {
 public:
  PointMaker(const TriangleSurface& surface, const CurvedTriangles* curved, const std::vector<Plane>& dividers,
             int order, bool with_facets)
      : surface_(surface), curved_(curved), dividers_(dividers), order_(order), with_facets_(with_facets) {
    if (dividers.size() > 256)
      throw InputError(
          "too many borders of faces in one cell (allowed: up to 256; declare fewer faces or make the cells smaller)");
  }

  void add_facet(int triangle, const SurfacePolygon& polygon) {
    const bool curved = curved_ && !curved_->is_plane(triangle);
    DividedFacet facet{surface_.patch(triangle), curved ? -1 : find_plane(triangle), {}, triangle, polygon};
    divide(facet, 0);
  }

  void make_points(int owner, BoundaryPoints& points) {
    sorted_.resize(facets_.size());
    std::iota(sorted_.begin(), sorted_.end(), 0);
    std::stable_sort(sorted_.begin(), sorted_.end(), [&](int a, int b) { return facets_[a].key() < facets_[b].key(); });
    for (std::size_t begin = 0, end = 0; begin < sorted_.size(); begin = end) {
      double area = 0;
      for (end = begin; end < sorted_.size() && facet(end).patch == facet(begin).patch; ++end)
        area += twice_area(facet(end).polygon).norm() / 2;
      if (area <= lost_facet) continue;
      if (curved_ && !curved_->is_plane(facet(begin).triangle))
        make_curved_points(begin, end, owner, points);
      else if (num_planes(facet(begin).patch) > quadratic_rule_planes)
        make_facet_points(begin, end, owner, points);
      else
        make_patch_points(begin, end, owner, points);
    }
  }

 private:
  /// Number of the plane, shared by coplanar triangles of a patch. Planes without a rule of their own are only counted.
  int find_plane(int triangle) {
    const Vec3& n = surface_.normal(triangle);
    const Vec3& x = surface_.corner(triangle, 0);
    std::vector<PatchPlane>& planes = planes_[surface_.patch(triangle)];
    if (planes.size() > quadratic_rule_planes) return -1;
    for (const PatchPlane& plane : planes)
      if ((plane.normal - n).squaredNorm() < plane_tolerance * plane_tolerance &&
          std::abs(n.dot(x - plane.point)) < plane_tolerance)
        return plane.number;
    planes.push_back({num_planes_++, n, x});
    return planes.back().number;
  }

  int num_planes(int patch) const { return static_cast<int>(planes_.at(patch).size()); }

  /// Cuts the facet at all dividers from the given one on.
  void divide(DividedFacet facet, std::size_t divider) {
    SurfacePolygon negative, rest;
    for (; divider < dividers_.size(); ++divider) {
      if (!dividers_[divider].divides(facet.patch)) continue;
      if (dividers_[divider].of_normals) {
        if (dividers_[divider].normal.dot(surface_.normal(facet.triangle)) < dividers_[divider].offset)
          facet.sides[divider / 64] |= std::uint64_t{1} << divider % 64;
        continue;
      }
      if (lies_in(facet.polygon, dividers_[divider])) continue;
      split_at(facet.polygon, dividers_[divider], negative, rest);
      if (negative.n == 0) continue;
      if (rest.n > 0) {
        DividedFacet other = facet;
        other.polygon = rest;
        divide(other, divider + 1);
        facet.polygon = negative;
      }
      facet.sides[divider / 64] |= std::uint64_t{1} << divider % 64;
    }
    facets_.push_back(facet);
  }

  /// In the order of the keys.
  const DividedFacet& facet(std::size_t i) const { return facets_[sorted_[i]]; }

  int degree_of(int patch) const {
    const int full = 2 * order_ - 1, count = num_planes(patch);
    if (count <= full_rule_planes && num_planes_ <= full_rule_planes_of_cell) return full;
    return std::min(full, num_planes_ <= quadratic_rule_planes_of_cell ? 2 : 1);
  }

  /// Adds the points of the facets begin .. end, those of one patch.
  void make_patch_points(std::size_t begin, std::size_t end, int owner, BoundaryPoints& points) const {
    const int degree = degree_of(facet(begin).patch);
    for (std::size_t next = begin; begin < end; begin = next) {
      double area = 0;
      for (; next < end && facet(next).key() == facet(begin).key(); ++next)
        area += twice_area(facet(next).polygon).norm() / 2;
      if (area > lost_group) make_group_points(begin, next, degree, owner, points);
    }
  }

  /// Adds the points of the facets begin .. end, those of a patch with many planes: a bounded number on one side of
  /// every divider.
  void make_facet_points(std::size_t begin, std::size_t end, int owner, BoundaryPoints& points) const {
    const int patch = facet(begin).patch;
    for (std::size_t next = begin; begin < end; begin = next) {
      std::vector<FacetPoint> facet_points;
      Vec3 mean = Vec3::Zero();
      double area = 0;
      for (; next < end && facet(next).sides == facet(begin).sides; ++next) {
        const double own = twice_area(facet(next).polygon).norm() / 2;
        std::vector<RulePoint> rule;
        add_polygon_rule(facet(next).polygon,
                         own >= full_rule_area        ? 2 * order_ - 1
                         : own >= quadratic_rule_area ? 2
                                                      : 1,
                         rule);
        for (const RulePoint& p : rule) {
          facet_points.push_back({p, surface_.normal(facet(next).triangle)});
          mean += p.weight * p.position;
        }
        area += own;
      }
      if (area <= lost_group) continue;
      std::vector<double> weights;
      for (const FacetPoint& p : facet_points) weights.push_back(p.point.weight);
      compress_many_weights(facet_functions(facet_points), weights);
      for (std::size_t i = 0; i < facet_points.size(); ++i) {
        if (!(weights[i] > 0)) continue;
        points.append(facet_points[i].point.position, facet_points[i].normal, weights[i], owner, patch);
        if (with_facets_) points.set_facet(mean / area, facet_points[i].normal);
      }
    }
  }

  /// Adds one group: facets in one plane on one side of every divider. Where they make up a convex polygon they are
  /// one.
  void make_group_points(std::size_t begin, std::size_t end, int degree, int owner, BoundaryPoints& points) const {
    const Vec3& normal = surface_.normal(facet(begin).triangle);
    std::vector<RulePoint> rule;
    SurfacePolygon whole;
    if (is_bent(begin, end))
      add_bent_rule(begin, end, degree + bend_degrees, rule);
    else if (join_convex(begin, end, whole))
      add_polygon_rule(whole, degree, rule);
    else
      for (std::size_t i = begin; i < end; ++i) add_polygon_rule(facet(i).polygon, degree, rule);
    compress(normal, degree, rule);
    Vec3 mean = Vec3::Zero();
    double area = 0;
    for (const RulePoint& p : rule) {
      mean += p.weight * p.position;
      area += p.weight;
    }
    for (const RulePoint& p : rule) {
      if (!(p.weight > 0)) continue;
      points.append(p.position, normal, p.weight, owner, facet(begin).patch);
      if (with_facets_) points.set_facet(mean / area, normal);
    }
  }

  /// Returns whether one of the polygons has a rim that is not straight.
  bool is_bent(std::size_t begin, std::size_t end) const {
    if (!curved_) return false;
    for (std::size_t i = begin; i < end; ++i)
      if (curved_->is_bent(facet(i).triangle)) return true;
    return false;
  }

  void add_bent_rule(std::size_t begin, std::size_t end, int degree, std::vector<RulePoint>& rule) const {
    std::vector<FacetPoint> points;
    for (std::size_t i = begin; i < end; ++i) add_exact_rule(facet(i), degree, points);
    for (const FacetPoint& p : points) rule.push_back(p.point);
  }

  /// Appends points on the exact surface. Where a bent rim folds a triangle that is thinner than the
  /// bend, weights are negative: the folds cancel.
  void add_exact_rule(const DividedFacet& of, int degree, std::vector<FacetPoint>& rule) const {
    static thread_local std::vector<TrianglePoint> points;
    points.clear();
    add_clipped_rule(surface_, of.triangle, of.polygon, degree, points);
    for (const TrianglePoint& at : points) {
      const CurvedPoint image = curved_->point_at(of.triangle, at.a, at.b);
      const Vec3 across = image.along_a.cross(image.along_b);
      const double stretch = across.norm(), sign = across.dot(image.normal) < 0 ? -1 : 1;
      if (!std::isfinite(stretch) || !image.x.allFinite() || !image.normal.allFinite())
        throw InputError("face" + std::to_string(curved_->triangles[of.triangle].face + 1) +
                         " of the CAD solid has places that are not finite: its surface or a curve on it is damaged "
                         "(allowed: faces that are finite everywhere; export the part again)");
      rule.push_back({{image.x, sign * at.weight * stretch}, image.normal});
    }
  }

  /// Adds the points of the facets begin .. end, those of a curved face of a CAD body: with the integrals of many more
  /// points of all polynomials as on the quadrics of CSG bodies, of the normal and of the flux of the position.
  void make_curved_points(std::size_t begin, std::size_t end, int owner, BoundaryPoints& points) const {
    const int patch = facet(begin).patch;
    for (std::size_t next = begin; begin < end; begin = next) {
      int triangles = 0;
      for (; next < end && facet(next).sides == facet(begin).sides; ++next) triangles += facet(next).polygon.n - 2;
      std::vector<FacetPoint> rule;  // of few points, then of many
      add_few_points(begin, next, triangles, rule);
      const std::size_t num_few = rule.size();
      const int degree = triangles < many_triangles ? 2 * order_ + 1 : 2 * order_ - 1;
      for (std::size_t i = begin; i < next; ++i)
        add_exact_rule(facet(i), degree + (curved_->is_bent(facet(i).triangle) ? bend_degrees : 0), rule);
      double area = 0;
      Vec3 mean_position = Vec3::Zero(), mean_normal = Vec3::Zero();
      for (std::size_t i = num_few; i < rule.size(); ++i) {
        area += rule[i].point.weight;
        mean_position += rule[i].point.weight * rule[i].point.position;
        mean_normal += rule[i].point.weight * rule[i].normal;
      }
      if (area <= lost_group) continue;
      std::vector<double> weights = compress_curved(mean_normal, num_few, rule);
      for (std::size_t i = 0; i < weights.size(); ++i) {
        if (!(weights[i] > 0)) continue;
        points.append(rule[i].point.position, rule[i].normal, weights[i], owner, patch);
        if (with_facets_) points.set_facet(mean_position / area, mean_normal / area);
      }
    }
  }

  /// Adds about twice as many points as there are functions, more of them on the larger facets.
  void add_few_points(std::size_t begin, std::size_t end, int triangles, std::vector<FacetPoint>& rule) const {
    // A rule of degree 2 n - 1 has n^2 points on a triangle.
    int n = 1;
    while (n < order_ + 1 && (n + 1) * (n + 1) * triangles <= few_points) ++n;
    int left = few_points - n * n * triangles;
    std::vector<std::pair<double, std::size_t>> by_area;
    for (std::size_t i = begin; i < end; ++i) by_area.emplace_back(-twice_area(facet(i).polygon).norm(), i);
    std::sort(by_area.begin(), by_area.end());
    for (const auto& [area, i] : by_area) {
      const int more = (2 * n + 1) * (facet(i).polygon.n - 2);
      const bool finer = more <= left && n < order_ + 1;
      if (finer) left -= more;
      add_exact_rule(facet(i), 2 * (finer ? n + 1 : n) - 1, rule);
    }
  }

  /// Moves negative weights, which folds leave, to the others: the area stays.
  static void keep_positive(std::vector<double>& weights) {
    double all = 0, positive = 0;
    for (const double w : weights) {
      all += w;
      positive += std::max(w, 0.0);
    }
    if (positive > all)
      for (double& w : weights) w = std::max(w, 0.0) * all / positive;
  }

  /// Weights of the first points of a rule, or of all.
  std::vector<double> compress_curved(const Vec3& mean_normal, std::size_t num_few,
                                      std::vector<FacetPoint>& rule) const {
    const auto [s, t] = plane_axes(mean_normal);
    const int axes[3] = {s, t, 3 - s - t}, n = static_cast<int>(rule.size());
    std::vector<double> local[3];
    for (int k = 0; k < 3; ++k)
      for (const FacetPoint& p : rule) local[k].push_back(p.point.position[axes[k]] - rule[0].point.position[axes[k]]);
    FunctionTable table = surface_polynomials(local, order_ + 1, false);  // scales the positions to -1 .. 1
    int f = table.num_functions;
    table.num_functions += 4;
    table.values.resize(static_cast<std::size_t>(table.num_functions) * n);
    for (int k = 0; k < 3; ++k, ++f)
      for (int p = 0; p < n; ++p) table[f][p] = rule[p].normal[axes[k]];
    for (int p = 0; p < n; ++p)
      table[f][p] =
          rule[p].normal[s] * local[0][p] + rule[p].normal[t] * local[1][p] + rule[p].normal[axes[2]] * local[2][p];
    std::vector<double> weights, others;
    for (std::size_t i = 0; i < num_few; ++i) weights.push_back(std::abs(rule[i].point.weight));
    for (std::size_t i = num_few; i < rule.size(); ++i) others.push_back(rule[i].point.weight);
    if (take_integrals(table, others, weights)) {
      compress_weights(columns(table, 0, num_few), weights);
    } else {
      weights = others;
      table = columns(table, num_few, rule.size());
      rule.erase(rule.begin(), rule.begin() + static_cast<std::ptrdiff_t>(num_few));
      keep_positive(weights);
      compress_many_weights(table, weights);
    }
    return weights;
  }

  /// Joins the facets to their convex hull, if it has no larger area than they have.
  bool join_convex(std::size_t begin, std::size_t end, SurfacePolygon& whole) const {
    if (end - begin == 1) {
      whole = facet(begin).polygon;
      return true;
    }
    const auto [s, t] = plane_axes(surface_.normal(facet(begin).triangle));
    std::vector<Vec3> corners;
    double area = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const SurfacePolygon& p = facet(i).polygon;
      corners.insert(corners.end(), p.x.begin(), p.x.begin() + p.n);
      area += twice_area(p).norm();
    }
    const std::vector<Vec3> hull = convex_hull(corners, s, t);
    if (hull.size() < 3 || hull.size() > SurfacePolygon::max_corners) return false;
    whole.n = 0;
    for (const Vec3& x : hull) whole.push(x);
    return std::abs(twice_area(whole).norm() - area) <= join_tolerance * area;
  }

  const TriangleSurface& surface_;
  const CurvedTriangles* const curved_;
  const std::vector<Plane>& dividers_;
  const int order_;
  const bool with_facets_;
  std::unordered_map<int, std::vector<PatchPlane>> planes_;  ///< by patch
  int num_planes_ = 0;
  std::vector<DividedFacet> facets_;
  std::vector<int> sorted_;
};

}  // namespace

void SurfacePolygon::push(const Vec3& corner) {
  if (n == max_corners) throw std::logic_error("polygon has too many corners");
  x[n++] = corner;
}

SurfacePolygon triangle_polygon(const TriangleSurface& surface, int triangle) {
  SurfacePolygon polygon;
  for (int k = 0; k < 3; ++k) polygon.push(surface.corner(triangle, k));
  return polygon;
}

void split_at(const SurfacePolygon& polygon, int axis, double value, SurfacePolygon& below, SurfacePolygon& above) {
  cut_polygon(
      polygon, [&](const Vec3& x) { return x[axis] - value; },
      [&](const Vec3& low, const Vec3& high) {
        Vec3 x = low + (value - low[axis]) / (high[axis] - low[axis]) * (high - low);
        x[axis] = value;
        return x;
      },
      below, above);
}

namespace clipped_triangles {

std::pair<int, int> cell_range(const SurfacePolygon& polygon, int axis, double normal) {
  double low = polygon.x[0][axis], high = low;
  for (int i = 1; i < polygon.n; ++i) {
    low = std::min(low, polygon.x[i][axis]);
    high = std::max(high, polygon.x[i][axis]);
  }
  const double plane = std::round(0.5 * (low + high));
  if (low > plane - grid_plane_tolerance && high < plane + grid_plane_tolerance) {
    const int owner = static_cast<int>(plane) - (normal > 0 ? 1 : 0);
    return {owner, owner};
  }
  return {static_cast<int>(std::floor(low)), static_cast<int>(std::ceil(high)) - 1};
}

}  // namespace clipped_triangles

SurfacePolygon clipped_to_cell(const TriangleSurface& surface, int triangle, const Index3& cell) {
  SurfacePolygon polygon = triangle_polygon(surface, triangle), below, above;
  for (int axis = 2; axis >= 0; --axis) {
    const auto [first, last] = clipped_triangles::cell_range(polygon, axis, surface.normal(triangle)[axis]);
    if (cell[axis] < first || cell[axis] > last) return {};
    if (cell[axis] > first) {
      split_at(polygon, axis, cell[axis], below, above);
      polygon = above;
    }
    if (cell[axis] < last) {
      split_at(polygon, axis, cell[axis] + 1, below, above);
      polygon = below;
    }
  }
  return polygon;
}

std::vector<int> triangles_near_cell(const TriangleSurface& surface, const Index3& cell) {
  std::vector<int> found;
  // Triangles in a grid plane may lie just outside of their cell.
  const Vec3 low = Vec3(cell[0], cell[1], cell[2]) - Vec3::Constant(2 * grid_plane_tolerance),
             high = low + Vec3::Constant(1 + 4 * grid_plane_tolerance);
  surface.tree().visit(
      [&](const Vec3& min, const Vec3& max) {
        return (min.array() <= high.array()).all() && (max.array() >= low.array()).all();
      },
      [&](int t) { found.push_back(t); });
  std::sort(found.begin(), found.end());
  return found;
}

void add_clipped_rule(const TriangleSurface& surface, int triangle, const SurfacePolygon& polygon, int degree,
                      std::vector<TrianglePoint>& points) {
  const TriangleRule& rule = triangle_rule(degree);
  const Vec3& origin = surface.corner(triangle, 0);
  const Vec3 u = surface.corner(triangle, 1) - origin, v = surface.corner(triangle, 2) - origin, n = u.cross(v);
  const double inverse = 1 / n.squaredNorm();
  const auto weights = [&](const Vec3& x) {
    const Vec3 y = x - origin;
    return Vec2(n.dot(y.cross(v)) * inverse, n.dot(u.cross(y)) * inverse);
  };
  const Vec2 first = weights(polygon.x[0]);
  Vec2 last = weights(polygon.x[1]);
  for (int k = 2; k < polygon.n; ++k) {
    const Vec2 next = weights(polygon.x[k]), p = last - first, q = next - first;
    const double area = 0.5 * (p[0] * q[1] - p[1] * q[0]);
    last = next;
    if (area == 0) continue;
    for (std::size_t i = 0; i < rule.weight.size(); ++i) {
      const Vec2 at = first + rule.a[i] * p + rule.b[i] * q;
      points.push_back({at[0], at[1], area * rule.weight[i]});
    }
  }
}

void triangle_boundary_points(const TriangleSurface& surface, const CurvedTriangles* curved,
                              const std::vector<int>& triangles, const Index3& cell, const std::vector<char>& selected,
                              const std::vector<Plane>& dividers, int order, int owner, BoundaryPoints& points) {
  const std::vector<Plane> crossing = crossing_planes(dividers, Vec3(cell[0], cell[1], cell[2]), 1);
  PointMaker maker(surface, curved, crossing, order, divide_faces(dividers));
  for (const int t : triangles) {
    if (!selected.empty() && !selected[surface.patch(t)]) continue;
    const SurfacePolygon polygon = clipped_to_cell(surface, t, cell);
    if (polygon.n >= 3) maker.add_facet(t, polygon);
  }
  maker.make_points(owner, points);
}

}  // namespace cgcontact
