#include "core/cad/curved_triangles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

namespace {

constexpr int max_passes = 40;
constexpr std::size_t max_curved_triangles = 20000000;
constexpr double straight = 1e-12;  // of a side's length in the parameter plane: what bends less is straight
constexpr int newton_steps = 20;
constexpr double newton_end = 1e-13;  // of the size of the coordinates

double weight_of(int corner, double a, double b) { return corner == 0 ? 1 - a - b : corner == 1 ? a : b; }
Vec2 slope_of(int corner) { return corner == 0 ? Vec2(-1, -1) : corner == 1 ? Vec2(1, 0) : Vec2(0, 1); }

/// Chebyshev's points of [-1, 1].
std::array<double, CurvedTriangles::bend_terms> bend_nodes() {
  std::array<double, CurvedTriangles::bend_terms> z;
  const int n = static_cast<int>(z.size());
  for (int k = 0; k < n; ++k) z[k] = std::cos(pi * (2 * k + 1) / (2 * n));
  return z;
}

}  // namespace

bool CurvedTriangles::is_bent(int triangle) const {
  const auto& sides = triangles[triangle].sides;
  return triangles[triangle].pole >= 0 ||
         std::any_of(sides.begin(), sides.end(), [](const CurvedTriangle::Side& s) { return s.bend >= 0; });
}

CurvedTriangles::Map CurvedTriangles::map(int number, double a, double b) const {
  const CurvedTriangle& triangle = triangles[number];
  Map m{Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
  std::array<Vec2, 3> uv = triangle.uv;
  if (triangle.pole >= 0) {
    // The corner moves along its line as the direction from it turns from one of the other corners to the other.
    const int k = triangle.pole_axis, q = (triangle.pole + 1) % 3, r = (triangle.pole + 2) % 3;
    const double wq = weight_of(q, a, b), wr = weight_of(r, a, b), sum = wq + wr, share = sum > 0 ? wr / sum : 0.5;
    const Vec2 slope = sum > 0 ? Vec2((slope_of(r) - share * (slope_of(q) + slope_of(r))) / sum) : Vec2(0, 0);
    const double along = uv[r][k] - uv[q][k], w = weight_of(triangle.pole, a, b);
    uv[triangle.pole][k] = uv[q][k] + share * along;
    m.along_a[k] += w * along * slope[0];
    m.along_b[k] += w * along * slope[1];
  }
  for (int c = 0; c < 3; ++c) {
    m.uv += weight_of(c, a, b) * uv[c];
    m.along_a += slope_of(c)[0] * uv[c];
    m.along_b += slope_of(c)[1] * uv[c];
  }
  for (int s = 0; s < 3; ++s) {
    const int bend = triangle.sides[s].bend;
    if (bend < 0) continue;
    const int i = s, j = (s + 1) % 3;
    const double wi = weight_of(i, a, b), wj = weight_of(j, a, b), z = wj - wi;
    Vec2 g = Vec2::Zero(), dg = Vec2::Zero();
    for (int k = bend_terms - 1; k >= 0; --k) {
      dg = z * dg + g;
      g = z * g + bends[bend][k];
    }
    m.uv += wi * wj * g;
    const Vec2 product = wi * slope_of(j) + wj * slope_of(i), dz = slope_of(j) - slope_of(i);
    m.along_a += product[0] * g + wi * wj * dz[0] * dg;
    m.along_b += product[1] * g + wi * wj * dz[1] * dg;
  }
  return m;
}

Vec2 CurvedTriangles::parameters(int triangle, double a, double b) const { return map(triangle, a, b).uv; }

CurvedPoint CurvedTriangles::point_at(int triangle, double a, double b) const {
  const Map m = map(triangle, a, b);
  SurfaceJet jet;
  const CurvedFace& face = faces[triangles[triangle].face];
  face.surface->first(m.uv, jet);
  return {placement(jet.x), placement.direction(m.along_a[0] * jet.xu + m.along_a[1] * jet.xv),
          placement.direction(m.along_b[0] * jet.xu + m.along_b[1] * jet.xv),
          face.orientation * (placement.rotation * jet.xu.cross(jet.xv)).normalized()};
}

/// In the parameter plane.
Vec2 CurvedTriangles::middle_of_side(const CurvedTriangle& triangle, int s) const {
  const CurvedTriangle::Side& side = triangle.sides[s];
  if (side.curve >= 0) return curves[side.curve]->at((side.t0 + side.t1) / 2);
  const int j = (s + 1) % 3;
  Vec2 middle = (triangle.uv[s] + triangle.uv[j]) / 2;
  if (triangle.pole == s) middle[triangle.pole_axis] = triangle.uv[j][triangle.pole_axis];
  if (triangle.pole == j) middle[triangle.pole_axis] = triangle.uv[s][triangle.pole_axis];
  return middle;
}

double CurvedTriangles::sag_of_side(std::size_t t, int s) const {
  SurfaceJet jet;
  faces[triangles[t].face].surface->first(middle_of_side(triangles[t], s), jet);
  return (placement(jet.x) - (points[corners[t][s]] + points[corners[t][(s + 1) % 3]]) / 2).norm();
}

bool CurvedTriangles::is_wanted(std::size_t t, const Wanted& wanted) const {
  if (!wanted) return true;
  const Vec3 &a = points[corners[t][0]], &b = points[corners[t][1]], &c = points[corners[t][2]];
  return wanted(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c));
}

double CurvedTriangles::largest_sag(const Wanted& wanted) const {
  double largest = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!is_wanted(t, wanted)) continue;
    for (int s = 0; s < 3; ++s) largest = std::max(largest, sag_of_side(t, s));
  }
  return largest;
}

namespace {

/// Names a side that several triangles may have.
std::tuple<int, int, int> key_of(const Triangle& corners, const CurvedTriangle& triangle, int s) {
  const auto [low, high] = std::minmax(corners[s], corners[(s + 1) % 3]);
  const int edge = triangle.sides[s].edge;
  return {low, high, edge >= 0 ? edge : -1 - triangle.face};
}

}  // namespace

/// Up to six points around a triangle that is divided: its corners and the middles of its sides.
struct CurvedTriangles::Rim {
  struct Point {
    int point;
    Vec2 uv;
    int corner;  ///< -1: a middle
  };
  std::vector<Point> points;
  std::vector<CurvedTriangle::Side> sides;  ///< from each point to the next

  int size() const { return static_cast<int>(points.size()); }
  bool is_corner(int k) const { return points[k % size()].corner >= 0; }
};

bool CurvedTriangles::divide_long_sides(double sag, const Wanted& wanted) {
  if (triangles.size() > max_curved_triangles)
    throw InputError(fmt::format("it takes more than {} triangles to follow its faces: the cells are too small for it",
                                 max_curved_triangles));
  const SideMiddles middles = add_middles(sag, wanted);
  if (std::all_of(middles.begin(), middles.end(), [](const auto& entry) { return entry.second < 0; })) return false;
  const std::vector<Triangle> old_corners = std::move(corners);
  const std::vector<CurvedTriangle> old_triangles = std::move(triangles);
  corners.clear();
  triangles.clear();
  for (std::size_t t = 0; t < old_triangles.size(); ++t) {
    const CurvedTriangle& old = old_triangles[t];
    const Rim rim = rim_of(old_corners[t], old, middles);
    for (const std::array<int, 3>& child : children_of(rim, old.pole)) add_child(old, rim, child);
  }
  return true;
}

/// Adds points in the middle of sides that are too far from the surface. Sides of several triangles are divided alike:
/// what they are decided by belongs to the side, not to the triangle.
CurvedTriangles::SideMiddles CurvedTriangles::add_middles(double sag, const Wanted& wanted) {
  SideMiddles middles;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!is_wanted(t, wanted)) continue;
    // A triangle whose middle is too far away although its sides are not: all sides.
    const Vec3 centroid = (points[corners[t][0]] + points[corners[t][1]] + points[corners[t][2]]) / 3;
    const bool all = !is_plane(static_cast<int>(t)) &&
                     (point_at(static_cast<int>(t), 1.0 / 3, 1.0 / 3).x - centroid).norm() > 2 * sag;
    for (int s = 0; s < 3; ++s) {
      const auto [entry, added] = middles.try_emplace(key_of(corners[t], triangles[t], s), -1);
      if (entry->second >= 0) continue;
      if (!all && (!added || sag_of_side(t, s) <= sag)) continue;
      SurfaceJet jet;
      faces[triangles[t].face].surface->first(middle_of_side(triangles[t], s), jet);
      entry->second = static_cast<int>(points.size());
      points.push_back(placement(jet.x));
    }
  }
  return middles;
}

CurvedTriangles::Rim CurvedTriangles::rim_of(const Triangle& corners_of, const CurvedTriangle& triangle,
                                             const SideMiddles& middles) const {
  Rim rim;
  for (int s = 0; s < 3; ++s) {
    rim.points.push_back({corners_of[s], triangle.uv[s], s});
    const auto found = middles.find(key_of(corners_of, triangle, s));
    const int number = found == middles.end() ? -1 : found->second;
    CurvedTriangle::Side side = triangle.sides[s];
    if (number >= 0) {
      CurvedTriangle::Side first = side;
      first.t1 = side.t0 = (side.t0 + side.t1) / 2;
      rim.sides.push_back(first);
      rim.points.push_back({number, middle_of_side(triangle, s), -1});
    }
    rim.sides.push_back(side);
  }
  return rim;
}

/// Returns triangles that fill the rim, as indices of its points. pole: of the corners, < 0: none.
std::vector<std::array<int, 3>> CurvedTriangles::children_of(const Rim& rim, int pole) const {
  if (rim.size() == 3) return {{0, 1, 2}};
  if (rim.size() == 6) return {{5, 0, 1}, {1, 2, 3}, {3, 4, 5}, {1, 3, 5}};
  if (rim.size() == 4) {  // from the middle to the corner opposite
    int m = 0;
    while (rim.is_corner(m)) ++m;
    return {{m, (m + 1) % 4, (m + 2) % 4}, {m, (m + 2) % 4, (m + 3) % 4}};
  }
  // Corner between the two middles, then a quadrangle: along its shorter diagonal.
  int c = 0;
  while (!(rim.is_corner(c) && !rim.is_corner(c + 4) && !rim.is_corner(c + 1))) ++c;
  const auto at = [&](int k) { return (c + k) % 5; };
  const auto length = [&](int i, int j) {
    return (points[rim.points[at(i)].point] - points[rim.points[at(j)].point]).norm();
  };
  const bool to_pole = pole >= 0 && rim.points[at(0)].corner != pole;
  const bool first = to_pole ? rim.points[at(3)].corner == pole : length(1, 3) < length(2, 4);
  if (first) return {{at(4), at(0), at(1)}, {at(1), at(2), at(3)}, {at(1), at(3), at(4)}};
  return {{at(4), at(0), at(1)}, {at(1), at(2), at(4)}, {at(2), at(3), at(4)}};
}

void CurvedTriangles::add_child(const CurvedTriangle& parent, const Rim& rim, const std::array<int, 3>& child) {
  CurvedTriangle triangle;
  triangle.face = parent.face;
  Triangle points_of;
  for (int c = 0; c < 3; ++c) {
    const Rim::Point& from = rim.points[child[c]];
    points_of[c] = from.point;
    triangle.uv[c] = from.uv;
    if (from.corner >= 0 && from.corner == parent.pole) {
      triangle.pole = c;
      triangle.pole_axis = parent.pole_axis;
    }
    if (child[(c + 1) % 3] == (child[c] + 1) % rim.size()) triangle.sides[c] = rim.sides[child[c]];
  }
  corners.push_back(points_of);
  triangles.push_back(triangle);
}

void CurvedTriangles::find_bends() {
  static const auto z = bend_nodes();
  static const Eigen::Matrix<double, bend_terms, bend_terms> inverse = [] {
    Eigen::Matrix<double, bend_terms, bend_terms> powers;
    for (int k = 0; k < bend_terms; ++k)
      for (int p = 0; p < bend_terms; ++p) powers(k, p) = std::pow(z[k], p);
    return Eigen::Matrix<double, bend_terms, bend_terms>(powers.inverse());
  }();
  bends.clear();
  for (CurvedTriangle& triangle : triangles)
    for (int s = 0; s < 3; ++s) {
      CurvedTriangle::Side& side = triangle.sides[s];
      side.bend = -1;
      if (side.curve < 0) continue;
      Vec2 from = triangle.uv[s], to = triangle.uv[(s + 1) % 3];
      if (triangle.pole == s) from[triangle.pole_axis] = to[triangle.pole_axis];
      if (triangle.pole == (s + 1) % 3) to[triangle.pole_axis] = from[triangle.pole_axis];
      std::array<Vec2, bend_terms> at;
      double most = 0;
      for (int k = 0; k < bend_terms; ++k) {
        const double share = (1 + z[k]) / 2;
        const Vec2 off = curves[side.curve]->at(side.t0 + share * (side.t1 - side.t0)) - (from + share * (to - from));
        most = std::max(most, off.norm());
        at[k] = off / (share * (1 - share));
      }
      if (most <= straight * (to - from).norm()) continue;
      side.bend = static_cast<int>(bends.size());
      Bend bend;
      for (int p = 0; p < bend_terms; ++p) {
        bend[p].setZero();
        for (int k = 0; k < bend_terms; ++k) bend[p] += inverse(p, k) * at[k];
      }
      bends.push_back(bend);
    }
}

void CurvedTriangles::refine(double sag, const Wanted& wanted) {
  for (int pass = 0; pass < max_passes && divide_long_sides(sag, wanted); ++pass) find_bends();
  find_bends();
}

CurvedTriangles CurvedTriangles::moved(const Similarity& motion) const {
  CurvedTriangles result = *this;
  for (Vec3& x : result.points) x = motion(x).eval();
  result.placement = motion.after(placement);
  return result;
}

bool project(const ParametricSurface& surface, const Vec3& x, Vec2& uv, SurfaceJet& jet) {
  Vec2 now = surface.clamped(uv);
  surface.second(now, jet);
  double distance = (jet.x - x).squaredNorm();
  const double end = newton_end * (1 + x.norm());
  for (int step = 0; step < newton_steps; ++step) {
    const Vec3 off = jet.x - x;
    const Vec2 slope(off.dot(jet.xu), off.dot(jet.xv));
    Eigen::Matrix2d metric, hessian;
    metric << jet.xu.dot(jet.xu), jet.xu.dot(jet.xv), jet.xu.dot(jet.xv), jet.xv.dot(jet.xv);
    hessian << metric(0, 0) + off.dot(jet.xuu), metric(0, 1) + off.dot(jet.xuv), metric(0, 1) + off.dot(jet.xuv),
        metric(1, 1) + off.dot(jet.xvv);
    // Far from the surface the Hessian need not be positive: then the tangent plane leads the way.
    const bool convex = hessian(0, 0) > 0 && hessian.determinant() > 1e-6 * metric(0, 0) * metric(1, 1);
    const Eigen::Matrix2d& matrix = convex ? hessian : metric;
    const double determinant = matrix.determinant();
    if (!(determinant > 1e-14 * metric(0, 0) * metric(1, 1))) return false;  // at a pole
    Vec2 move(-(matrix(1, 1) * slope[0] - matrix(0, 1) * slope[1]) / determinant,
              -(matrix(0, 0) * slope[1] - matrix(0, 1) * slope[0]) / determinant);
    SurfaceJet next;
    Vec2 there;
    double closer = 0;
    for (int halving = 0; halving < 8; ++halving, move /= 2) {
      there = surface.clamped(now + move);
      surface.second(there, next);
      closer = (next.x - x).squaredNorm();
      if (closer <= distance * (1 + 1e-14) + end * end) break;
    }
    const double moved = (next.x - jet.x).norm();
    now = there;
    jet = next;
    distance = closer;
    if (moved <= end) {
      uv = now;
      return true;
    }
  }
  return false;
}

bool meet(const ParametricSurface& surface, const Vec3& x, const Vec3& d, Vec2& uv, double& t, SurfaceJet& jet) {
  Vec2 now = surface.clamped(uv);
  double along = t;
  const double end = newton_end * (1 + x.norm() + std::abs(t) * d.norm());
  for (int step = 0; step < newton_steps; ++step) {
    surface.first(now, jet);
    const Vec3 miss = jet.x - x - along * d;
    if (miss.norm() <= end) {
      uv = now;
      t = along;
      return true;
    }
    const Vec3 n = jet.xu.cross(jet.xv);
    const double slope = n.dot(d);
    if (std::abs(slope) <= 1e-9 * n.norm() * d.norm()) return false;
    // miss + xu du + xv dv - d dt = 0
    const double dt = n.dot(miss) / slope;
    const Vec3 rest = dt * d - miss;
    const double inverse = 1 / n.squaredNorm();
    now = surface.clamped(now + Vec2(n.dot(rest.cross(jet.xv)) * inverse, n.dot(jet.xu.cross(rest)) * inverse));
    along += dt;
  }
  return false;
}

}  // namespace cgcontact
