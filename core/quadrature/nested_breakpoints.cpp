#include "core/quadrature/nested_breakpoints.hpp"

#include <algorithm>
#include <cmath>

#include "core/quadrature/critical_points.hpp"
#include "core/quadrature/gauss_rules.hpp"

namespace cgcontact {

namespace {

struct Tangency {
  int function;
  double t;
};

/// Candidates for breakpoints; `scan` is set when some have no closed form.
struct Candidates {
  std::vector<double> t;
  std::vector<double> forced;  ///< break there even if the signature does not change
  std::vector<Tangency> tangencies;
  bool scan = false;
};

/// Interval of t where the signature is constant.
struct SliceRange {
  double begin, end;
  Signature signature;
};

void add_candidates(Candidates& candidates, double a, double b, double c) {
  double roots[2];
  const int n = quadratic_roots(a, b, c, roots);
  for (int r = 0; r < n; ++r) candidates.t.push_back(roots[r]);
}

/// t of the points common to a line and a conic.
void cross_line(Candidates& candidates, const Conic& line, const Conic& k) {
  const double c = line.c, s = line.s, t = line.t;
  if (std::abs(s) >= std::abs(t)) {
    if (s == 0) return;
    const double p = -c / s, m = -t / s;  // s = p + m t
    add_candidates(candidates, k.ss * m * m + k.st * m + k.tt, k.s * m + k.t + 2 * k.ss * p * m + k.st * p,
                   k.c + k.s * p + k.ss * p * p);
  } else {
    const double p = -c / t, m = -s / t;  // t = p + m s
    double roots[2];
    const int n = quadratic_roots(k.ss + k.st * m + k.tt * m * m, k.s + k.t * m + k.st * p + 2 * k.tt * p * m,
                                  k.c + k.t * p + k.tt * p * p, roots);
    for (int r = 0; r < n; ++r) candidates.t.push_back(p + m * roots[r]);
  }
}

/// Returns the line of common points if the quadratic terms are proportional.
bool radical_line(const Conic& a, const Conic& b, Conic& line) {
  const double size_a = std::abs(a.ss) + std::abs(a.st) + std::abs(a.tt);
  const double size_b = std::abs(b.ss) + std::abs(b.st) + std::abs(b.tt);
  const double dot = a.ss * b.ss + a.st * b.st + a.tt * b.tt;
  const double f = std::copysign(size_b / size_a, dot);
  const double tolerance = 1e-13 * size_b;
  if (std::abs(b.ss - f * a.ss) > tolerance || std::abs(b.st - f * a.st) > tolerance ||
      std::abs(b.tt - f * a.tt) > tolerance)
    return false;
  line = Conic{b.c - f * a.c, b.s - f * a.s, b.t - f * a.t};
  return true;
}

void add_tangencies(Candidates& candidates, int f, double a, double b, double c) {
  double roots[2];
  const int n = quadratic_roots(a, b, c, roots);
  for (int r = 0; r < n; ++r) {
    candidates.t.push_back(roots[r]);
    candidates.tangencies.push_back({f, roots[r]});
  }
}

void conic_candidates(Candidates& candidates, int f, const Conic& k, double w) {
  add_candidates(candidates, k.tt, k.t, k.c);
  add_candidates(candidates, k.tt, k.t + k.st * w, k.c + w * (k.s + k.ss * w));
  if (k.ss != 0)
    add_tangencies(candidates, f, k.st * k.st - 4 * k.ss * k.tt, 2 * k.s * k.st - 4 * k.ss * k.t,
                   k.s * k.s - 4 * k.ss * k.c);
}

/// t of the points common to two planes (g.u + c = 0) and the quadric.
void cross_planes(Candidates& candidates, const Vec3& g1, double c1, const Vec3& g2, double c2,
                  const Quadric& surface) {
  const Vec3 d = g1.cross(g2);
  const double d2 = d.squaredNorm();
  if (d2 <= 1e-24 * g1.squaredNorm() * g2.squaredNorm()) return;
  const Vec3 base = (c2 * g1 - c1 * g2).cross(d) / d2;
  double roots[2];
  const int n = quadratic_roots(d.dot(surface.q * d), surface.gradient(base).dot(d), surface(base), roots);
  for (int r = 0; r < n; ++r) candidates.t.push_back(base[1] + roots[r] * d[1]);
}

/// Discriminant of the intersection of the plane's line at t with the quadric.
double line_discriminant(const Quadric& plane, const Quadric& surface, double t) {
  const double m2 = plane.g[0] * plane.g[0] + plane.g[2] * plane.g[2];
  const double shift = -(plane.c + plane.g[1] * t) / m2;
  const Vec3 base(shift * plane.g[0], t, shift * plane.g[2]);
  const Vec3 d = Vec3(plane.g[2], 0, -plane.g[0]) / std::sqrt(m2);
  const double b = surface.gradient(base).dot(d);
  return b * b - 4 * d.dot(surface.q * d) * surface(base);
}

void trace_candidates(Candidates& candidates, const Region& region, int f) {
  const double w = region.width;
  const Quadric& plane = region.functions[f].quadric;
  const Quadric& surface = region.graph.quadric;
  for (int axis : {0, 2})
    for (double position : {0.0, w}) cross_planes(candidates, plane.g, plane.c, Vec3::Unit(axis), -position, surface);
  for (int other = 0; other < f; ++other) {
    const RegionFunction& function = region.functions[other];
    if (function.on_graph && !is_general_trace(function))
      cross_planes(candidates, plane.g, plane.c, function.quadric.g, function.quadric.c, surface);
  }
  if (plane.g[0] * plane.g[0] + plane.g[2] * plane.g[2] < 1e-24) {
    if (plane.g[1] != 0) candidates.t.push_back(-plane.c / plane.g[1]);
    return;
  }
  const double d0 = line_discriminant(plane, surface, 0), d1 = line_discriminant(plane, surface, w);
  const double dm = line_discriminant(plane, surface, 0.5 * w);
  const double a = 2 * (d0 + d1 - 2 * dm) / (w * w), b = (4 * dm - 3 * d0 - d1) / w;
  add_tangencies(candidates, f, a, b, d0);
}

/// Starts for Newton's method: on the graph where there is one.
std::vector<Vec3> newton_starts(const Region& region) {
  constexpr int n = 4;
  const double w = region.width;
  std::vector<Vec3> starts;
  for (int i = 0; i < n * n; ++i) {
    const int column = i % n, row = i / n;
    Vec3 u(w * (column + 0.5) / n, w * (row + 0.5) / n, 0);
    if (region.has_graph) {
      const double height = region.graph.height(u[0], u[1]);
      u[2] = height > -w && height < 2 * w ? height : 0.5 * w;
    }
    starts.push_back(u);
  }
  return starts;
}

/// Curves on the graph without closed form: crossings with the sides of the square, the faces of the cell, other
/// curves, and tangencies or self-crossings.
void general_candidates(Candidates& candidates, const Region& region, int f) {
  const double w = region.width, margin = 1e-6 * w;
  const std::vector<Vec3> starts = newton_starts(region);
  const Quadric& own = region.graph.quadric;
  const Quadric& trace = region.functions[f].quadric;
  std::vector<Vec3> points;
  auto add = [&](const Quadric& third) {
    common_points(own, trace, third, w, starts, points);
    for (const Vec3& u : points) candidates.t.push_back(u[1]);
  };
  for (int axis : {0, 2})
    for (double position : {0.0, w}) add(coordinate_plane(axis, position));
  for (std::size_t g = 0; g < region.functions.size(); ++g)
    if (region.functions[g].on_graph && static_cast<int>(g) != f) add(region.functions[g].quadric);
  add(tangency_function(own, trace, 1));
  for (const Vec3& u : points) {
    if (own.gradient(u)[2] * region.graph.sign <= 0) continue;
    candidates.tangencies.push_back({f, u[1]});
    if (u.minCoeff() > -margin && u.maxCoeff() < w + margin) candidates.forced.push_back(u[1]);
  }
  candidates.scan = true;
}

/// Two conics without radical line.
void cross_general_conics(Candidates& candidates, const Region& region, const Conic& a, const Conic& b) {
  std::vector<Vec3> points;
  common_points(cylinder_over(a), cylinder_over(b), coordinate_plane(2, 0), region.width, newton_starts(region),
                points);
  for (const Vec3& u : points) candidates.t.push_back(u[1]);
  candidates.scan = true;
}

void cross_conics(Candidates& candidates, const Region& region, const Conic& a, const Conic& b) {
  if (a.is_linear()) return cross_line(candidates, a, b);
  if (b.is_linear()) return cross_line(candidates, b, a);
  Conic line;
  if (radical_line(a, b, line))
    cross_line(candidates, line, a);
  else
    cross_general_conics(candidates, region, a, b);
}

void collect_candidates(const Region& region, Candidates& candidates) {
  candidates.t.clear();
  candidates.forced.clear();
  candidates.tangencies.clear();
  candidates.scan = false;
  const auto& functions = region.functions;
  const std::uint64_t own = region.predicate.lower | region.predicate.upper;
  for (std::size_t f = 0; f < functions.size(); ++f) {
    const int index = static_cast<int>(f);
    if (is_general_trace(functions[f])) {
      general_candidates(candidates, region, index);
    } else if (functions[f].on_graph) {
      trace_candidates(candidates, region, index);
    } else {
      conic_candidates(candidates, index, functions[f].conic, region.width);
      for (std::size_t g = 0; g < f; ++g) {
        const bool both_own = (functions[f].bit & own) && (functions[g].bit & own);
        if (!functions[g].on_graph && !both_own)
          cross_conics(candidates, region, functions[f].conic, functions[g].conic);
      }
    }
  }
  candidates.t.insert(candidates.t.end(), candidates.forced.begin(), candidates.forced.end());
  std::sort(candidates.t.begin(), candidates.t.end());
}

constexpr double unresolved = 1e-7;  // of the width: near self-crossings the structure is not resolved below this

class IntervalFinder {
 public:
  IntervalFinder(Slicer& slicer, Candidates& candidates)
      : slicer_(slicer), candidates_(candidates), width_(slicer.region().width) {}

  void run(std::vector<Interval>& intervals) {
    collect_candidates(slicer_.region(), candidates_);
    merge_ = !candidates_.scan;
    split_at_candidates();
    for (int pass = 0; pass < 4 && candidates_.scan; ++pass)
      if (!scan_ranges()) break;
    if (candidates_.scan) merge_ranges();
    for (const SliceRange& range : ranges_) {
      if (range.signature.empty) continue;
      if (candidates_.scan)
        refine(range, 0, intervals);
      else
        intervals.push_back(make_interval(range));
    }
  }

 private:
  void append(double begin, double end, const Signature& signature) {
    // while intervals are still to be scanned they keep the candidates as their ends
    const auto& kept = merge_ ? candidates_.forced : candidates_.t;
    if (!ranges_.empty() && ranges_.back().signature == signature &&
        std::find(kept.begin(), kept.end(), begin) == kept.end())
      ranges_.back().end = end;
    else
      ranges_.push_back({begin, end, signature});
  }

  void split_at_candidates() {
    const double tiny = 1e-14 * width_;
    double begin = 0;
    for (double t : candidates_.t) {
      if (t <= begin + tiny || t >= width_ - tiny) continue;
      append(begin, t, slicer_.signature(0.5 * (begin + t)));
      begin = t;
    }
    append(begin, width_, slicer_.signature(0.5 * (begin + width_)));
  }

  void merge_ranges() {
    std::vector<SliceRange> all;
    all.swap(ranges_);
    merge_ = true;
    for (const SliceRange& range : all) {
      const bool tiny = range.end - range.begin < unresolved * width_;
      if (tiny && !ranges_.empty() && !range.signature.empty && !ranges_.back().signature.empty)
        ranges_.back().end = range.end;
      else
        append(range.begin, range.end, range.signature);
    }
  }

  /// Finds the changes between two points of different signature by bisection; the last interval is left open.
  void find_changes(double& begin, double ta, Signature a, double tb, const Signature& b) {
    for (int change = 0; change < 16 && a != b; ++change) {
      double lo = ta, hi = tb;
      Signature at_hi = b;
      while (hi - lo > 1e-15 * width_) {
        const double mid = 0.5 * (lo + hi);
        if (mid <= lo || mid >= hi) break;
        const Signature s = slicer_.signature(mid);
        if (s == a) {
          lo = mid;
        } else {
          hi = mid;
          at_hi = s;
        }
      }
      append(begin, hi, a);
      begin = hi;
      ta = hi;
      a = tb - hi < unresolved * width_ ? b : at_hi;
    }
  }

  /// Looks for changes of the signature inside the intervals; true if there were any.
  bool scan_ranges() {
    std::vector<SliceRange> coarse;
    std::vector<double> positions;
    coarse.swap(ranges_);
    for (const SliceRange& range : coarse) {
      if (range.end - range.begin < unresolved * width_) {
        append(range.begin, range.end, range.signature);
        continue;
      }
      scan_positions(range, positions);
      double begin = range.begin;
      Signature previous = slicer_.signature(positions[0]);
      for (std::size_t i = 1; i < positions.size(); ++i) {
        const Signature s = slicer_.signature(positions[i]);
        find_changes(begin, positions[i - 1], previous, positions[i], s);
        previous = s;
      }
      append(begin, range.end, previous);
    }
    return ranges_.size() > coarse.size();
  }

  void scan_positions(const SliceRange& range, std::vector<double>& positions) const {
    static const double fractions[] = {1e-7, 0.04, 0.12, 0.22, 0.33, 0.44, 0.56, 0.67, 0.78, 0.88, 0.96, 1 - 1e-7};
    positions.clear();
    for (double f : fractions) positions.push_back(range.begin + f * (range.end - range.begin));
  }

  /// Area and first moment of the slices of an interval.
  Eigen::Vector2d measure(const Interval& interval) {
    const GaussRule& gauss = gauss_rule(8);
    const OuterMap map(interval);
    Eigen::Vector2d sum(0, 0);
    for (std::size_t i = 0; i < gauss.node.size(); ++i) {
      double t = 0, slope = 0;
      map(gauss.node[i], t, slope);
      for (const Segment& segment : slicer_.slice(t)) {
        const double length = segment.end - segment.begin;
        sum += gauss.weight[i] * slope * length * Eigen::Vector2d(1, segment.begin + segment.end);
      }
    }
    return sum;
  }

  /// Bisects while the measure is not resolved (curves that nearly touch or cross).
  void refine(const SliceRange& range, int depth, std::vector<Interval>& intervals) {
    constexpr int max_depth = 12;
    constexpr double tolerance = 1e-11;
    const Interval whole = make_interval(range);
    const double middle = 0.5 * (range.begin + range.end);
    const SliceRange first{range.begin, middle, range.signature}, second{middle, range.end, range.signature};
    const double error = (measure(whole) - measure(make_interval(first)) - measure(make_interval(second))).norm();
    if (!(error > tolerance * width_ * width_) || depth == max_depth) {
      intervals.push_back(whole);
    } else {
      refine(first, depth + 1, intervals);
      refine(second, depth + 1, intervals);
    }
  }

  Interval make_interval(const SliceRange& range) const {
    Interval interval{range.begin, range.end, 0, 0, false, false};
    const double length = range.end - range.begin, tiny = 1e-12 * width_;
    for (const Tangency& tangency : candidates_.tangencies) {
      if (!(range.signature.used >> tangency.function & 1)) continue;
      const double before = range.begin - tangency.t, after = tangency.t - range.end;
      if (before >= -tiny && before <= 2 * length && (!interval.left_singular || tangency.t > interval.left)) {
        interval.left_singular = true;
        interval.left = std::min(tangency.t, range.begin);
      }
      if (after >= -tiny && after <= 2 * length && (!interval.right_singular || tangency.t < interval.right)) {
        interval.right_singular = true;
        interval.right = std::max(tangency.t, range.end);
      }
    }
    return interval;
  }

  Slicer& slicer_;
  Candidates& candidates_;
  const double width_;
  bool merge_ = true;
  std::vector<SliceRange> ranges_;
};

}  // namespace

void find_intervals(Slicer& slicer, std::vector<Interval>& intervals) {
  static thread_local Candidates candidates;
  intervals.clear();
  IntervalFinder(slicer, candidates).run(intervals);
}

}  // namespace cgcontact
