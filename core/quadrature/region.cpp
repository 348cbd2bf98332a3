#include "core/quadrature/region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cgcontact {

int quadratic_roots(double a, double b, double c, double roots[2]) {
  if (a == 0) {
    if (b == 0) return 0;
    roots[0] = -c / b;
    return std::isfinite(roots[0]) ? 1 : 0;
  }
  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return 0;
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  int n = 0;
  if (std::isfinite(q / a)) roots[n++] = q / a;
  if (q != 0 && std::isfinite(c / q)) roots[n++] = c / q;
  if (n == 2 && roots[0] > roots[1]) std::swap(roots[0], roots[1]);
  return n;
}

int Conic::sign_on_square(double w) const {
  // Bernstein coefficients bound the polynomial
  const double cs = 0.5 * s * w, ct = 0.5 * t * w,
               b[3][3] = {{c, c + ct, c + 2 * ct + tt * w * w},
                          {c + cs, c + cs + ct + 0.25 * st * w * w, c + cs + 2 * ct + (tt + 0.5 * st) * w * w},
                          {c + 2 * cs + ss * w * w, c + 2 * cs + ct + (ss + 0.5 * st) * w * w,
                           c + 2 * cs + 2 * ct + (ss + st + tt) * w * w}};
  bool negative = true, positive = true;
  for (const auto& row : b)
    for (double value : row) (value < 0 ? positive : negative) = false;
  return negative ? -1 : positive ? 1 : 0;
}

double Graph::height(double s, double t) const {
  const double a = quadric.q(2, 2), b = quadric.g[2] + 2 * (quadric.q(2, 0) * s + quadric.q(2, 1) * t);
  const double c = quadric.c + s * (quadric.g[0] + quadric.q(0, 0) * s + 2 * quadric.q(0, 1) * t) +
                   t * (quadric.g[1] + quadric.q(1, 1) * t);
  const double discriminant = b * b - 4 * a * c;
  if (!(discriminant >= 0) || b * sign <= 0) return std::numeric_limits<double>::quiet_NaN();
  return -2 * c / (b + sign * std::sqrt(discriminant));
}

int RegionPredicate::operator()(std::uint64_t mask) const {
  const std::uint64_t sides = mask & surface_mask;
  if (facet == 0) return (*table)[sides];
  if (((mask & lower) != 0) == ((mask & upper) != 0)) return 0;
  return static_cast<int>((*table)[sides | facet]) - static_cast<int>((*table)[sides & ~facet]);
}

void Region::add(const RegionFunction& function) {
  if (!function.on_graph) {
    const int sign = function.conic.sign_on_square(width);
    if (sign < 0) fixed_bits |= function.bit;
    if (sign != 0) return;
  }
  functions.push_back(function);
}

}  // namespace cgcontact
