#include "recovery/zone_edge/edge_fit.hpp"

#include <array>
#include <cmath>

#include "core/quadrature/gauss_rules.hpp"
#include "recovery/patch/contact_edge.hpp"
#include "recovery/zone_edge/smooth_fall.hpp"

namespace cgcontact {
namespace {

/// All lengths in cells. Along the edge the sums fall to 0 at that on both sides.
constexpr double breadth = 3;
/// The square root is integrated exactly near the edge (falling from 1 to 0 here), else summed over the points.
constexpr double exact_from = 0.5, exact_to = 1.5;
constexpr double largest_shift = 1;

double exact_part(double s) { return smooth_fall((s - exact_from) / (exact_to - exact_from)); }

/// Sums of forces and of the square root over the area around an assumed edge.
class EdgeSums {
 public:
  EdgeSums(const EdgePiece& piece, const std::vector<const TransmittedForce*>& forces, double cell_size,
           const EdgeOptions& options)
      : plateau_(options.plateau),
        ends_{options.nearer_end, options.farther_end},
        convexity_(-piece.curvature * cell_size),
        inverse_width_(piece.inverse_width * cell_size) {
    for (const TransmittedForce* f : forces) add(piece, *f, cell_size);
    coverage_ /= 1 - convexity_;  // of the weight 1 - |s - 1| on rings of a circle
  }
  bool pressed() const { return force_[0] > 0 && force_[1] > 0 && coverage_ > 0; }
  double force(int sum) const { return force_[sum]; }

  /// Both sums of the unit square root whose edge lies `shift` outside.
  std::array<double, 2> roots(double shift) const {
    const GaussRule& rule = gauss_rule(16);
    double near[2] = {}, far[2] = {};
    const double length = exact_to + shift;
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      const double q = rule.node[i], inside = length * q * q, s = inside - shift;
      const double root = rule.weight[i] * 2 * q * length * root_at(inside) * exact_part(s);
      for (int k = 0; k < 2; ++k) near[k] += root * weight(s, k) * (1 - convexity_ * s);
    }
    for (const Point& p : points_) {
      const double root = root_at(p.inside + shift);
      for (int k = 0; k < 2; ++k) far[k] += p.area[k] * root;
    }
    return {coverage_ * near[0] + far[0], coverage_ * near[1] + far[1]};
  }

 private:
  struct Point {
    double inside;
    double area[2];  ///< m^2, weighted
  };

  double weight(double s, int sum) const { return smooth_fall((s - plateau_) / (ends_[sum] - plateau_)); }
  double root_at(double inside) const { return edge_root(inside, inverse_width_); }

  /// On the circle that the edge is locally; along: by the arc on the edge.
  void add(const EdgePiece& piece, const TransmittedForce& f, double cell_size) {
    const Vec3 d = (f.position - piece.origin) / cell_size;
    const double x = piece.closed.dot(d), t = piece.along.dot(d), c = convexity_, towards = 1 - c * x;
    if (!(towards > 0)) return;  // beyond the centre
    const double s = (2 * x - c * (x * x + t * t)) / (1 + std::hypot(towards, c * t));
    const double along = smooth_fall(std::abs(t / towards) / breadth), area = along * f.area,
                 far = area * (1 - exact_part(s));
    for (int k = 0; k < 2; ++k) force_[k] += along * f.force * weight(s, k);
    coverage_ += area * std::max(1 - std::abs(s - 1), 0.0);
    if (far > 0 && s < ends_[1]) points_.push_back({s, {far * weight(s, 0), far * weight(s, 1)}});
  }

  double plateau_, ends_[2], convexity_, inverse_width_;
  double force_[2] = {}, coverage_ = 0;  ///< N; m^2 per cell of s
  std::vector<Point> points_;
};

}  // namespace

EdgeFit fit_edge(const EdgePiece& piece, const std::vector<const TransmittedForce*>& forces, double cell_size,
                 const EdgeOptions& options) {
  EdgeFit fit;
  const EdgeSums sums(piece, forces, cell_size, options);
  if (!sums.pressed()) return fit;
  // Farther outside the nearer sum has the larger share.
  const auto excess = [&](double shift) {
    const std::array<double, 2> roots = sums.roots(shift);
    return roots[0] / roots[1];
  };
  const double share = sums.force(0) / sums.force(1);
  double low = -largest_shift, high = largest_shift, below = excess(low) - share, above = excess(high) - share;
  if (!(below < 0 && above > 0)) return fit;
  for (int iteration = 0, kept = 0; iteration < 15 && high - low > 1e-6; ++iteration) {  // false position, Illinois
    const double middle = (low * above - high * below) / (above - below), value = excess(middle) - share;
    fit.shift = middle;
    if (std::abs(value) < 1e-8 * share) break;
    if (value < 0) {
      low = middle, below = value;
      if (kept == 1) above /= 2;
      kept = 1;
    } else {
      high = middle, above = value;
      if (kept == -1) below /= 2;
      kept = -1;
    }
  }
  fit.shift += options.sums_deficit;
  fit.strength = sums.force(1) / sums.roots(fit.shift)[1] / std::sqrt(cell_size);
  fit.found = true;
  return fit;
}

}  // namespace cgcontact
