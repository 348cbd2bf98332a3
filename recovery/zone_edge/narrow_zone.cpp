#include "recovery/zone_edge/narrow_zone.hpp"

#include <algorithm>
#include <cmath>

#include "recovery/patch/tangents.hpp"
#include "recovery/zone_edge/smooth_fall.hpp"

namespace cgcontact {
namespace {

using Vec2 = Eigen::Vector2d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// What the moments do not determine (across a plate of one cell) is small.
constexpr double ridge = 1e-4;
/// Of the gradient, per closed area.
constexpr double converged = 1e-8;
constexpr int sweeps = 3, max_iterations = 40;

/// What the place of an edge may be off, cells, by 1 / width in cells: so that on hertz.toml (1.6 to 6.4 cells over the
/// radius, random offsets) the estimate of the pressure is near its error (docs/recovery.md, "Error figures").
double expected_error(double inverse_width) {
  const double square = inverse_width * inverse_width;
  return 0.006 + (0.35 + 3 * square) * square;
}

struct ZonePoint {
  Vec6 terms;
  Vec2 x;              // cells
  double area, force;  // cells squared, mean pressures times that; weighted
  bool closed;
  double spread = 0;  // of the function over the point's area, to one side
};

Vec6 terms(const Vec2& x) { return (Vec6() << 1, x[0], x[1], x[0] * x[0], x[0] * x[1], x[1] * x[1]).finished(); }
Vec2 gradient(const Vec6& q, const Vec2& x) {
  return {q[1] + 2 * q[3] * x[0] + q[4] * x[1], q[2] + q[4] * x[0] + 2 * q[5] * x[1]};
}
double second_derivative(const Vec6& q, const Vec2& v) {
  return 2 * (q[3] * v[0] * v[0] + q[4] * v[0] * v[1] + q[5] * v[1] * v[1]);
}

/// Mean over values from q - spread to q + spread of the root (of zero where negative), and its derivative by q.
std::pair<double, double> mean_root(double q, double spread) {
  const double high = std::sqrt(std::max(q + spread, 0.0)), low = std::sqrt(std::max(q - spread, 0.0));
  return {(high * high * high - low * low * low) / (3 * spread), (high - low) / (2 * spread)};
}

/// +1 on closed and -1 on open points by least squares, both sorts counting alike.
Vec6 part_points(const std::vector<ZonePoint>& points) {
  double area[2] = {};
  for (const ZonePoint& p : points) area[p.closed] += p.area;
  Mat6 A = Mat6::Identity() * ridge;
  Vec6 b = Vec6::Zero();
  for (const ZonePoint& p : points) {
    A += p.area / area[p.closed] * p.terms * p.terms.transpose();
    b += p.area / area[p.closed] * (p.closed ? 1 : -1) * p.terms;
  }
  return A.ldlt().solve(b);
}

/// The function whose root has the moments of the forces. What is missing of them is the gradient of a convex function
/// of the coefficients: Newton's method with steps that do not overshoot finds the one minimum.
bool match_moments(std::vector<ZonePoint>& points, double closed_area, Vec6& q) {
  Vec6 held = Vec6::Constant(ridge * closed_area);
  held[0] = 0;
  const auto missing = [&](const Vec6& c, Mat6* derivative) {
    Vec6 g = held.cwiseProduct(c);
    if (derivative) *derivative = held.asDiagonal();
    for (const ZonePoint& p : points) {
      const auto [root, slope] = mean_root(c.dot(p.terms), p.spread);
      g += (p.area * root - p.force) * p.terms;
      if (derivative && slope > 0) *derivative += p.area * slope * p.terms * p.terms.transpose();
    }
    return g;
  };
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (ZonePoint& p : points) p.spread = std::max(0.5 * std::sqrt(p.area) * gradient(q, p.x).norm(), 1e-3);
    for (int iteration = 0;; ++iteration) {
      Mat6 derivative;
      const Vec6 g = missing(q, &derivative);
      const Vec6 step = -derivative.ldlt().solve(g);
      if (iteration == max_iterations || !step.allFinite()) return false;
      if (g.norm() < converged * closed_area) {
        q += step;  // the last digits, alike on any number of threads
        break;
      }
      double length = 1;
      while (length > 1e-4 && missing(q + length * step, nullptr).dot(step) > 0.1 * std::abs(g.dot(step))) length /= 2;
      q += length * step;
    }
  }
  return true;
}

double fourth_moment_misfit(const std::vector<ZonePoint>& points, const Vec6& q) {
  double top = 0, force = 0, excess = 0;
  for (const ZonePoint& p : points) top = std::max(top, q.dot(p.terms));
  for (const ZonePoint& p : points) {
    const double value = q.dot(p.terms), square = std::clamp(1 - value / top, 0.0, 2.0);  // radius squared
    excess += (p.force - p.area * mean_root(value, p.spread).first) * square * square;
    force += p.force;
  }
  return std::abs(excess / force);
}

}  // namespace

double narrow_zone_weight(double distance) {
  return smooth_fall((distance - narrow_zone_full) / (narrow_zone_reach - narrow_zone_full));
}

bool fit_narrow_zone(const std::vector<const TransmittedForce*>& forces, const Vec3& centre, const Vec3& normal,
                     double cell_size, double stress_unit, NarrowZone& zone, const EdgeOptions& options) {
  zone.centre = centre;
  zone.normal = normal;
  std::tie(zone.axis[0], zone.axis[1]) = tangents(normal);
  zone.cell_size = cell_size;
  zone.deficit = options.moments_deficit;
  zone.coefficients.setZero();
  std::vector<ZonePoint> points;
  double closed_area = 0, force = 0;
  for (const TransmittedForce* f : forces) {
    const Vec3 d = (f->position - centre) / cell_size;
    const Vec2 x(zone.axis[0].dot(d), zone.axis[1].dot(d));
    const double w = narrow_zone_weight(x.norm());
    if (w == 0) continue;
    points.push_back({terms(x), x, w * f->area / (cell_size * cell_size), w * f->spread_force, f->closed});
    force += points.back().force;
    if (f->closed) closed_area += points.back().area;
  }
  if (!(force > 0 && closed_area > 0)) return false;
  const double unit = force / closed_area;  // the mean pressure on the area of a cell
  for (ZonePoint& p : points) p.force /= unit;
  Vec6 q = part_points(points);
  if (!match_moments(points, closed_area, q)) return false;
  double wrong = 0;
  for (const ZonePoint& p : points)
    if (p.closed != (q.dot(p.terms) > 0)) wrong += p.area;
  zone.misfit = fourth_moment_misfit(points, q);
  zone.coefficients = std::pow(unit / (cell_size * cell_size * stress_unit), 2) * q;
  return wrong <= options.largest_mismatch * 2 * std::sqrt(M_PI * closed_area);  // of a circle's edge
}

bool NarrowZone::edge_near(const Vec3& x, const Vec3& start, EdgePiece& piece) const {
  const auto flat = [&](const Vec3& p) -> Vec2 {
    return Vec2(axis[0].dot(p - centre), axis[1].dot(p - centre)) / cell_size;
  };
  // Towards the zero across, towards x along; steps shorter than the edge's radius.
  const Vec2 aim = flat(x);
  Vec2 p = flat(start), n, t;
  double steep = 0;
  const auto set_directions = [&] {
    const Vec2 g = gradient(coefficients, p);
    steep = g.norm();
    n = g / steep;
    t = {-n[1], n[0]};
  };
  for (int iteration = 0; iteration < 60; ++iteration) {  // to the last digits: whatever the start, the same place
    set_directions();
    if (!(steep > 0)) return false;
    const double bend = std::abs(second_derivative(coefficients, t)) / steep, longest = 0.5 / std::max(bend, 0.5);
    const double across = std::clamp(-coefficients.dot(terms(p)) / steep, -1.0, 1.0);
    const double along = std::clamp(0.5 * t.dot(aim - p), -longest, longest);
    p += across * n + along * t;
    if (std::abs(across) < 1e-13 && std::abs(along) < 1e-13) break;
  }
  set_directions();
  if (!(std::abs(coefficients.dot(terms(p))) < 0.05 * steep)) return false;
  // The edge goes outwards by the deficit; the force (pressure times radius, where the zone is round radius squared)
  // stays.
  const double bend = std::max(-second_derivative(coefficients, t) / steep, 0.0);                 // 1 / radius
  const double inverse_width = std::max(-second_derivative(coefficients, n) / (2 * steep), 0.0);  // of the zone
  const double growth = 1 + 2 * deficit * inverse_width;
  const double force_power = 1 + (inverse_width > 0 ? std::min(0.5 * bend / inverse_width, 1.0) : 0);
  p -= deficit * n;
  piece.origin = centre + cell_size * (p[0] * axis[0] + p[1] * axis[1]) + normal.dot(start - centre) * normal;
  piece.closed = n[0] * axis[0] + n[1] * axis[1];
  piece.along = normal.cross(piece.closed);
  piece.curvature = -bend / (1 + deficit * bend) / cell_size;
  piece.inverse_width = inverse_width / growth / cell_size;
  piece.factor = -std::sqrt(steep / cell_size) * std::pow(growth, -force_power - 0.5);
  piece.place_error = expected_error(inverse_width) * cell_size;
  return true;
}

}  // namespace cgcontact
