#include "core/quadrature/region_slice.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/numbers/root_search.hpp"

namespace cgcontact {

void Slicer::reset(const Region& region) {
  region_ = &region;
  has_general_ = false;
  for (const RegionFunction& f : region.functions) has_general_ = has_general_ || is_general_trace(f);
}

void Slicer::add_roots(int f, double t) {
  const RegionFunction& function = region_->functions[f];
  double roots[2];
  if (!function.on_graph) {
    const Conic& conic = function.conic;
    const int n = quadratic_roots(conic.ss, conic.s + conic.st * t, conic.c + t * (conic.t + conic.tt * t), roots);
    for (int r = 0; r < n; ++r)
      if (roots[r] > 0 && roots[r] < region_->width) cuts_.push_back({roots[r], 2 * f + r});
    return;
  }
  // a plane's line in the plane t = const meets the graph's quadric
  const Quadric& plane = function.quadric;
  const Quadric& surface = region_->graph.quadric;
  const double m2 = plane.g[0] * plane.g[0] + plane.g[2] * plane.g[2];
  if (m2 < 1e-24) return;
  const double shift = -(plane.c + plane.g[1] * t) / m2;
  const Vec3 base(shift * plane.g[0], t, shift * plane.g[2]);
  const Vec3 d = Vec3(plane.g[2], 0, -plane.g[0]) / std::sqrt(m2);
  const int n = quadratic_roots(d.dot(surface.q * d), surface.gradient(base).dot(d), surface(base), roots);
  for (int r = 0; r < n; ++r) {
    const Vec3 u = base + roots[r] * d;
    if (u[0] <= 0 || u[0] >= region_->width) continue;
    if (surface.gradient(u)[2] * region_->graph.sign <= 0) continue;  // the other branch
    cuts_.push_back({u[0], 2 * f + r});
  }
}

void Slicer::add_general_roots(int f, double t, double begin, double end) {
  const Quadric& quadric = region_->functions[f].quadric;
  const Quadric& own = region_->graph.quadric;
  auto value = [&](double s) {
    const Vec3 u(s, t, region_->graph.height(s, t)), g = quadric.gradient(u), own_g = own.gradient(u);
    return FunctionSample{s, quadric(u), g[0] - g[2] * own_g[0] / own_g[2]};
  };
  double roots[8];
  const int n = find_roots(value, begin, end, roots, 8);
  for (int r = 0; r < n; ++r) cuts_.push_back({roots[r], 2 * f + (r & 1)});
}

void Slicer::sort_cuts() {
  for (std::size_t i = 1; i < cuts_.size(); ++i)
    for (std::size_t j = i; j > 0 && cuts_[j].s < cuts_[j - 1].s; --j) std::swap(cuts_[j], cuts_[j - 1]);
}

std::uint64_t Slicer::mask_at(double s, double t, bool with_general) const {
  std::uint64_t mask = region_->fixed_bits;
  double height = 0;
  if (region_->has_graph) {
    height = region_->graph.height(s, t);
    if (std::isnan(height)) return mask & ~(region_->predicate.lower | region_->predicate.upper);
  }
  for (const RegionFunction& f : region_->functions) {
    if (!with_general && is_general_trace(f)) continue;
    const double value = f.on_graph ? f.quadric(Vec3(s, t, height)) : f.conic(s, t);
    if (value < 0) mask |= f.bit;
  }
  return mask;
}

const std::vector<Segment>& Slicer::slice(double t) {
  cuts_.clear();
  segments_.clear();
  cuts_.push_back({0, -1});
  const int num_functions = static_cast<int>(region_->functions.size());
  for (int f = 0; f < num_functions; ++f)
    if (!is_general_trace(region_->functions[f])) add_roots(f, t);
  sort_cuts();
  cuts_.push_back({region_->width, -2});
  const RegionPredicate& predicate = region_->predicate;
  if (has_general_) {
    const std::size_t n = cuts_.size();
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const double begin = cuts_[i].s, end = cuts_[i + 1].s;
      const std::uint64_t mask = mask_at(0.5 * (begin + end), t, false);
      if (!(begin < end) || ((mask & predicate.lower) != 0) == ((mask & predicate.upper) != 0)) continue;
      for (int f = 0; f < num_functions; ++f)
        if (is_general_trace(region_->functions[f])) add_general_roots(f, t, begin, end);
    }
    sort_cuts();
  }
  for (std::size_t i = 0; i + 1 < cuts_.size(); ++i) {
    const Cut& a = cuts_[i];
    const Cut& b = cuts_[i + 1];
    if (!(a.s < b.s)) continue;
    const std::uint64_t mask = mask_at(0.5 * (a.s + b.s), t, true);
    const int value = predicate(mask);
    if (value == 0) continue;
    const std::uint64_t group = mask & predicate.divider_mask;
    if (!segments_.empty() && segments_.back().end == a.s && segments_.back().value == value &&
        segments_.back().mask == group) {
      segments_.back().end = b.s;
      segments_.back().end_id = b.id;
    } else {
      segments_.push_back({a.s, b.s, a.id, b.id, value, group});
    }
  }
  return segments_;
}

Signature Slicer::signature(double t) {
  Signature result;
  const auto& segments = slice(t);
  result.empty = segments.empty();
  auto mix = [&](std::uint64_t x) {
    result.hash ^= x + 0x9e3779b97f4a7c15ull + (result.hash << 6) + (result.hash >> 2);
    result.hash *= 0xbf58476d1ce4e5b9ull;
  };
  for (const Segment& a : segments) {
    mix(static_cast<std::uint64_t>(a.begin_id) + 8);
    mix(static_cast<std::uint64_t>(a.end_id) + 8);
    mix(static_cast<std::uint64_t>(a.value) + 8);
    mix(a.mask);
    for (int id : {a.begin_id, a.end_id})
      if (id >= 0) result.used |= std::uint64_t{1} << (id / 2);
  }
  return result;
}

}  // namespace cgcontact
