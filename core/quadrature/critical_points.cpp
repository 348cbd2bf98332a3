#include "core/quadrature/critical_points.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {

namespace {

constexpr int max_iterations = 40;
constexpr double same_point = 1e-6;  // relative to the cube; self-crossings are found to about 1e-8 only

/// One Newton run; true if it ends near the cube.
bool converge(const Quadric& a, const Quadric& b, const Quadric& c, double w, Vec3& u) {
  double last = 0;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Vec3 residual(a(u), b(u), c(u));
    Mat3 jacobian;
    jacobian.row(0) = a.gradient(u).transpose();
    jacobian.row(1) = b.gradient(u).transpose();
    jacobian.row(2) = c.gradient(u).transpose();
    Vec3 step = -(jacobian.inverse() * residual);
    last = step.norm();
    if (!std::isfinite(last)) return residual.norm() < 1e-13 * w;
    if (last > w) step *= w / last;
    u += step;
    if (u.minCoeff() < -2 * w || u.maxCoeff() > 3 * w) return false;
    if (last < 1e-14 * w) return true;
  }
  return last < 1e-7 * w;
}

}  // namespace

Quadric cylinder_over(const Conic& conic) {
  Quadric result;
  result.c = conic.c;
  result.g = Vec3(conic.s, conic.t, 0);
  result.q(0, 0) = conic.ss;
  result.q(0, 1) = result.q(1, 0) = 0.5 * conic.st;
  result.q(1, 1) = conic.tt;
  return result;
}

Quadric coordinate_plane(int axis, double position) { return {-position, Vec3::Unit(axis), Mat3::Zero()}; }

Quadric tangency_function(const Quadric& a, const Quadric& b, int direction) {
  const int m = (direction + 1) % 3, n = (direction + 2) % 3;
  Quadric result;
  auto add_product = [&](const Quadric& p, int i, const Quadric& r, int j, double factor) {
    const Vec3 x = 2 * p.q.col(i), y = 2 * r.q.col(j);
    result.c += factor * p.g[i] * r.g[j];
    result.g += factor * (p.g[i] * y + r.g[j] * x);
    result.q += 0.5 * factor * (x * y.transpose() + y * x.transpose());
  };
  add_product(a, m, b, n, 1);
  add_product(a, n, b, m, -1);
  return result;
}

void common_points(const Quadric& a, const Quadric& b, const Quadric& c, double w, const std::vector<Vec3>& starts,
                   std::vector<Vec3>& points) {
  points.clear();
  for (Vec3 u : starts) {
    if (!converge(a, b, c, w, u)) continue;
    const auto close = [&](const Vec3& x) { return (u - x).norm() < same_point * w; };
    if (std::none_of(points.begin(), points.end(), close)) points.push_back(u);
  }
}

}  // namespace cgcontact
