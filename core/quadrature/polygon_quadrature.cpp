#include "core/quadrature/polygon_quadrature.hpp"

#include <cmath>
#include <stdexcept>

#include "core/quadrature/gauss_rules.hpp"

namespace cgcontact {

namespace {

constexpr int max_corners = 80;

struct Polygon {
  int n = 0;
  double s[max_corners], t[max_corners];
  void push(double x, double y) {
    if (n == max_corners) throw std::logic_error("polygon has too many corners");
    s[n] = x;
    t[n] = y;
    ++n;
  }
};

/// Splits the polygon where the line's function is negative and where it is not.
void split(const Polygon& polygon, const Conic& line, Polygon& negative, Polygon& rest) {
  negative.n = rest.n = 0;
  double previous = line(polygon.s[polygon.n - 1], polygon.t[polygon.n - 1]);
  for (int i = 0, j = polygon.n - 1; i < polygon.n; j = i++) {
    const double value = line(polygon.s[i], polygon.t[i]);
    if ((value < 0) != (previous < 0)) {
      const double x = previous / (previous - value);
      const double s = polygon.s[j] + x * (polygon.s[i] - polygon.s[j]);
      const double t = polygon.t[j] + x * (polygon.t[i] - polygon.t[j]);
      negative.push(s, t);
      rest.push(s, t);
    }
    (value < 0 ? negative : rest).push(polygon.s[i], polygon.t[i]);
    previous = value;
  }
}

/// Corners that coincide up to rounding are one.
void merge_corners(Polygon& polygon, double tolerance) {
  int kept = 0;
  for (int i = 0; i < polygon.n; ++i) {
    const int last = kept > 0 ? kept - 1 : polygon.n - 1;
    const bool same = kept > 0 && std::abs(polygon.s[i] - polygon.s[last]) <= tolerance &&
                      std::abs(polygon.t[i] - polygon.t[last]) <= tolerance;
    if (same) continue;
    polygon.s[kept] = polygon.s[i];
    polygon.t[kept] = polygon.t[i];
    ++kept;
  }
  while (kept > 1 && std::abs(polygon.s[0] - polygon.s[kept - 1]) <= tolerance &&
         std::abs(polygon.t[0] - polygon.t[kept - 1]) <= tolerance)
    --kept;
  polygon.n = kept;
}

class PolygonIntegrator {
 public:
  PolygonIntegrator(const Region& region, const RegionRule& rule, std::vector<RegionPoint>& points)
      : region_(region), rule_(rule), points_(points), tolerance_(1e-15 * region.width) {}

  /// `open`: functions whose sign on the polygon is not decided yet.
  void visit(const Polygon& polygon, std::uint64_t mask, std::uint64_t open) {
    std::uint64_t dividers = 0, bits[64];
    int num_bits = 0, first = -1, first_divider = -1;
    for (std::size_t f = 0; f < region_.functions.size(); ++f) {
      if (!(open >> f & 1)) continue;
      const RegionFunction& function = region_.functions[f];
      const int sign = sign_on(polygon, function.conic);
      if (sign != 0) {
        open &= ~(std::uint64_t{1} << f);
        if (sign < 0) mask |= function.bit;
      } else if (function.is_divider) {
        dividers |= function.bit;
        first_divider = static_cast<int>(f);
      } else {
        if (first < 0) first = static_cast<int>(f);
        bits[num_bits++] = function.bit;
      }
    }
    const int value = region_.predicate(mask);
    if (num_bits > 0 && !is_constant(mask, bits, num_bits, value)) return cut(polygon, mask, open, first);
    if (value == 0) return;
    if (dividers != 0) return cut(polygon, mask, open, first_divider);
    emit(polygon, value, mask & region_.predicate.divider_mask);
  }

 private:
  static int sign_on(const Polygon& polygon, const Conic& line) {
    bool negative = false, other = false;
    for (int i = 0; i < polygon.n; ++i) (line(polygon.s[i], polygon.t[i]) < 0 ? negative : other) = true;
    return negative && other ? 0 : negative ? -1 : 1;
  }

  bool is_constant(std::uint64_t mask, const std::uint64_t* bits, int num_bits, int value) const {
    for (std::uint64_t combination = 1; combination < (std::uint64_t{1} << num_bits); ++combination) {
      std::uint64_t trial = mask;
      for (int i = 0; i < num_bits; ++i)
        if (combination >> i & 1) trial |= bits[i];
      if (region_.predicate(trial) != value) return false;
    }
    return true;
  }

  void cut(const Polygon& polygon, std::uint64_t mask, std::uint64_t open, int f) {
    Polygon negative, rest;
    split(polygon, region_.functions[f].conic, negative, rest);
    open &= ~(std::uint64_t{1} << f);
    if (negative.n >= 3) visit(negative, mask | region_.functions[f].bit, open);
    if (rest.n >= 3) visit(rest, mask, open);
  }

  void emit(Polygon polygon, int value, std::uint64_t mask) {
    merge_corners(polygon, tolerance_);
    if (polygon.n < 3) return;
    if (polygon.n == 4 && is_parallelogram(polygon)) return emit_parallelogram(polygon, value, mask);
    const TriangleRule& triangle = triangle_rule(rule_.polygon_degree);
    for (int i = 1; i + 1 < polygon.n; ++i) {
      const double as = polygon.s[i] - polygon.s[0], at = polygon.t[i] - polygon.t[0];
      const double bs = polygon.s[i + 1] - polygon.s[0], bt = polygon.t[i + 1] - polygon.t[0];
      const double area = 0.5 * std::abs(as * bt - at * bs);
      if (area == 0) continue;
      for (std::size_t q = 0; q < triangle.weight.size(); ++q) {
        const double a = triangle.a[q], b = triangle.b[q];
        points_.push_back(
            {polygon.s[0] + a * as + b * bs, polygon.t[0] + a * at + b * bt, area * triangle.weight[q], value, mask});
      }
    }
  }

  bool is_parallelogram(const Polygon& p) const {
    const double tolerance = 10 * tolerance_;
    return std::abs(p.s[0] - p.s[1] + p.s[2] - p.s[3]) <= tolerance &&
           std::abs(p.t[0] - p.t[1] + p.t[2] - p.t[3]) <= tolerance;
  }

  void emit_parallelogram(const Polygon& p, int value, std::uint64_t mask) {
    const GaussRule& gauss = gauss_rule(rule_.polygon_degree / 2 + 1);
    const double as = p.s[1] - p.s[0], at = p.t[1] - p.t[0], bs = p.s[3] - p.s[0], bt = p.t[3] - p.t[0];
    const double area = std::abs(as * bt - at * bs);
    if (area == 0) return;
    for (std::size_t i = 0; i < gauss.node.size(); ++i)
      for (std::size_t j = 0; j < gauss.node.size(); ++j) {
        const double a = gauss.node[i], b = gauss.node[j];
        points_.push_back({p.s[0] + a * as + b * bs, p.t[0] + a * at + b * bt, area * gauss.weight[i] * gauss.weight[j],
                           value, mask});
      }
  }

  const Region& region_;
  const RegionRule& rule_;
  std::vector<RegionPoint>& points_;
  const double tolerance_;
};

}  // namespace

void integrate_polygons(const Region& region, const RegionRule& rule, std::vector<RegionPoint>& points) {
  Polygon square;
  square.push(0, 0);
  square.push(region.width, 0);
  square.push(region.width, region.width);
  square.push(0, region.width);
  const std::size_t n = region.functions.size();
  if (n > 63) throw std::logic_error("too many lines in one cell");
  PolygonIntegrator(region, rule, points).visit(square, region.fixed_bits, (std::uint64_t{1} << n) - 1);
}

}  // namespace cgcontact
