#include "core/bodies/profile_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "core/base/errors/errors.hpp"
#include "core/bodies/csg_body.hpp"

namespace cgcontact {

namespace {

constexpr double profile_rounding = 1e-12;  // lengths relative to the profile: rounding of what the scene computes
constexpr double widest_arc = pi / 3;       // angle of one segment: its triangle of tangents is flat
constexpr int max_divisions = 6;            // of arcs that come near to something, in halves
constexpr int tangents_around = 128;        // of the polygon that bounds an arc: 3e-4 of its radius

/// A line, or a segment of an arc, from `a` to `b`.
struct EdgeSegment {
  Vec2 a, b;
  int edge = 0;                  ///< of the profile
  std::optional<Circle> circle;  ///< of an arc
  double turn = 0;               ///< of an arc: angle from a to b, counterclockwise positive

  Vec2 at(double fraction) const {
    if (!circle) return a + fraction * (b - a);
    return circle->centre + Eigen::Rotation2Dd(fraction * turn) * (a - circle->centre);
  }
  /// Where the tangents at both ends meet.
  Vec2 tip() const { return circle->centre + (at(0.5) - circle->centre) / std::cos(0.5 * turn); }
  EdgeSegment between(double begin, double end) const {
    EdgeSegment result = *this;
    result.a = begin == 0 ? a : at(begin);
    result.b = end == 1 ? b : at(end);
    result.turn = (end - begin) * turn;
    return result;
  }
  /// A convex polygon that contains it.
  std::vector<Vec2> hull() const { return circle ? std::vector<Vec2>{a, b, tip()} : std::vector<Vec2>{a, b}; }
};

EdgeSegment segment_of(const ProfileEdge& edge, int number, double size) {
  EdgeSegment segment{edge.from, edge.to, number, std::nullopt, 0};
  if ((edge.to - edge.from).norm() <= profile_rounding * size)
    throw InputError(fmt::format("edge {} has no length", number + 1));
  if (!edge.is_arc) return segment;
  const auto arc = arc_through(edge.from, edge.through, edge.to, profile_rounding * size * size);
  if (!arc) throw InputError(fmt::format("edge {}: the three points of the arc lie on a line", number + 1));
  segment.circle = arc->circle;
  segment.turn = arc->turn;
  return segment;
}

/// Returns whether two convex polygons meet or touch.
bool meet(const std::vector<Vec2>& p, const std::vector<Vec2>& q) {
  for (const auto* polygon : {&p, &q})
    for (std::size_t i = 0; i < polygon->size(); ++i) {
      const Vec2 side = (*polygon)[(i + 1) % polygon->size()] - (*polygon)[i];
      for (const Vec2& normal : {Vec2(side[1], -side[0]), side}) {
        const auto range = [&](const std::vector<Vec2>& points) {
          double low = 1e300, high = -1e300;
          for (const Vec2& x : points) {
            low = std::min(low, x.dot(normal));
            high = std::max(high, x.dot(normal));
          }
          return std::make_pair(low, high);
        };
        const auto [low_p, high_p] = range(p);
        const auto [low_q, high_q] = range(q);
        if (low_q > high_p || low_p > high_q) return false;
      }
    }
  return true;
}

/// A closed profile, counterclockwise, in segments whose triangles of tangents do not meet.
class Outline {
 public:
  explicit Outline(const std::vector<ProfileEdge>& profile) {
    for (const ProfileEdge& edge : profile) {
      if (!edge.from.allFinite() || !edge.to.allFinite() || !edge.through.allFinite())
        throw InputError(std::string("a profile must have finite points"));
      for (const Vec2& x : {edge.from, edge.to}) size_ = std::max(size_, (x - profile[0].from).norm());
    }
    for (std::size_t k = 0; k < profile.size(); ++k) {
      if ((profile[k].to - profile[(k + 1) % profile.size()].from).norm() > profile_rounding * size_)
        throw InputError(std::string("a profile must be closed"));
      const EdgeSegment whole = segment_of(profile[k], static_cast<int>(k), size_);
      const int count = whole.circle ? static_cast<int>(std::ceil(std::abs(whole.turn) / widest_arc)) : 1;
      for (int i = 0; i < count; ++i) segments_.push_back(whole.between(double(i) / count, double(i + 1) / count));
    }
    for (std::size_t k = 0; k < segments_.size(); ++k) segments_[k].b = segments_[(k + 1) % segments_.size()].a;
    separate();
    orient();
  }

  const std::vector<EdgeSegment>& segments() const { return segments_; }
  double size() const { return size_; }
  /// Points whose convex hull contains it, little larger than its own.
  std::vector<Vec2> bounds() const {
    std::vector<Vec2> points;
    for (const EdgeSegment& segment : segments_) {
      points.push_back(segment.a);
      if (!segment.circle) continue;
      const int count = static_cast<int>(std::ceil(tangents_around * std::abs(segment.turn) / (2 * pi)));
      for (int i = 0; i < count; ++i) points.push_back(segment.between(double(i) / count, double(i + 1) / count).tip());
    }
    return points;
  }

 private:
  /// Divides arcs until nothing meets but at common ends.
  void separate() {
    for (int division = 0; division <= max_divisions; ++division) {
      std::vector<char> divide(segments_.size(), 0);
      const std::size_t n = segments_.size();
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 1; j < n; ++j) {
          const bool neighbours = j == i + 1 || (i == 0 && j == n - 1);
          if (neighbours || !meet(segments_[i].hull(), segments_[j].hull())) continue;
          if ((!segments_[i].circle && !segments_[j].circle) || division == max_divisions)
            throw InputError(fmt::format("edges {} and {} cross, touch or come too near to each other",
                                         segments_[i].edge + 1, segments_[j].edge + 1));
          divide[i] = segments_[i].circle.has_value();
          divide[j] = segments_[j].circle.has_value();
        }
      std::vector<EdgeSegment> finer;
      for (std::size_t i = 0; i < n; ++i) {
        if (divide[i]) finer.push_back(segments_[i].between(0, 0.5));
        finer.push_back(divide[i] ? segments_[i].between(0.5, 1) : segments_[i]);
      }
      if (finer.size() == n && n >= 3) return;
      if (finer.size() == n) throw InputError(std::string("a profile must have an area"));
      segments_ = std::move(finer);
    }
  }

  void orient() {
    double area = 0;  // of the polygon of chords: it has the sign of the whole
    for (const EdgeSegment& segment : segments_)
      area += cross(segment.a - segments_[0].a, segment.b - segments_[0].a) / 2;
    if (std::abs(area) <= profile_rounding * size_ * size_)
      throw InputError(std::string("a profile must have an area"));
    if (area > 0) return;
    std::reverse(segments_.begin(), segments_.end());
    for (EdgeSegment& segment : segments_) {
      std::swap(segment.a, segment.b);
      segment.turn = -segment.turn;
    }
  }

  std::vector<EdgeSegment> segments_;
  double size_ = 0;
};

/// The elementary surfaces that lines and circles of the plane become, and what is inside.
class Lift {
 public:
  virtual ~Lift() = default;
  /// What is on the left of the line from a to b; none: everything.
  virtual std::optional<CsgBody> left_of(const Vec2& a, const Vec2& b, const std::vector<std::string>& names) const = 0;
  virtual CsgBody disc(const Circle& circle, const std::vector<std::string>& names) const = 0;
};

class Extrusion final : public Lift {
 public:
  Extrusion(const ProfileFrame& frame, CsgBody::Hull hull) : frame_(frame), hull_(std::move(hull)) {}

  std::optional<CsgBody> left_of(const Vec2& a, const Vec2& b, const std::vector<std::string>& names) const override {
    const Vec2 d = (b - a).normalized();
    Surface plane;
    plane.point = at(a);
    plane.direction = (d[1] * frame_.first - d[0] * frame_.second).normalized();
    plane.names = names;
    return CsgBody({plane}, hull_);
  }
  CsgBody disc(const Circle& circle, const std::vector<std::string>& names) const override {
    Surface cylinder;
    cylinder.kind = Surface::Kind::cylinder;
    cylinder.point = at(circle.centre);
    cylinder.direction = frame_.first.cross(frame_.second).normalized();
    cylinder.radius = circle.radius;
    cylinder.names = names;
    return CsgBody({cylinder}, hull_);
  }

 private:
  Vec3 at(const Vec2& x) const { return frame_.origin + x[0] * frame_.first + x[1] * frame_.second; }

  const ProfileFrame& frame_;
  const CsgBody::Hull hull_;
};

class Revolution final : public Lift {
 public:
  Revolution(const ProfileFrame& frame, CsgBody::Hull hull, double size)
      : frame_(frame), hull_(std::move(hull)), size_(size) {}

  std::optional<CsgBody> left_of(const Vec2& a, const Vec2& b, const std::vector<std::string>& names) const override {
    if (std::max(a[0], b[0]) <= profile_rounding * size_) return std::nullopt;
    const Vec2 d = (b - a).normalized(), n(d[1], -d[0]);  // the line is n.x = offset
    const double offset = n.dot(a);
    Surface side;
    side.names = names;
    side.direction = frame_.second;
    if (std::abs(n[0]) <= profile_rounding) {
      side.point = frame_.origin + a[1] * frame_.second;
      side.direction *= n[1] > 0 ? 1 : -1;
      return CsgBody({side}, hull_);
    }
    const bool outside = n[0] < 0;
    using Op = BooleanOp::Kind;
    if (std::abs(n[1]) <= profile_rounding) {
      side.kind = Surface::Kind::cylinder;
      side.point = frame_.origin;
      side.radius = a[0];
      return CsgBody({side}, {{outside ? Op::complement_surface : Op::surface, 0}}, hull_);
    }
    side.kind = Surface::Kind::cone;
    side.point = frame_.origin + offset / n[1] * frame_.second;
    side.direction *= (n[1] > 0) == outside ? 1 : -1;
    side.radius = std::max(a[0], b[0]);
    side.cosine = std::abs(n[0]);
    side.sine = std::abs(n[1]);
    check_cone(side);
    Surface tip;
    tip.point = side.point;
    tip.direction = -side.direction;
    if (!outside) return CsgBody({side, tip}, hull_);
    return CsgBody({side, tip}, {{Op::complement_surface, 0}, {Op::complement_surface, 1}, {Op::unite, -1}}, hull_);
  }

  CsgBody disc(const Circle& circle, const std::vector<std::string>& names) const override {
    if (std::abs(circle.centre[0]) > 1e-9 * size_)
      throw InputError(fmt::format("the centre of an arc is ({:.6g}, {:.6g}) m: not on the axis, a torus",
                                   circle.centre[0], circle.centre[1]));
    Surface sphere;
    sphere.kind = Surface::Kind::sphere;
    sphere.point = frame_.origin + circle.centre[1] * frame_.second;
    sphere.radius = circle.radius;
    sphere.names = names;
    return CsgBody({sphere}, hull_);
  }

 private:
  const ProfileFrame& frame_;
  const CsgBody::Hull hull_;
  const double size_;
};

/// Turns an outline into a boolean expression: its convex hull without the pockets, which are polygons again; at arcs
/// the caps between circle and chord are added or taken away.
class Assembly {
 public:
  Assembly(const Outline& outline, const std::vector<ProfileEdge>& profile, const Lift& lift)
      : outline_(outline), profile_(profile), lift_(lift) {}

  CsgBody body() const {
    std::vector<Corner> corners;
    for (const EdgeSegment& segment : outline_.segments()) corners.push_back({segment.a, &segment});
    CsgBody result = *polygon(corners);
    for (const double sign : {1.0, -1.0})  // first what arcs add
      for (const EdgeSegment& segment : outline_.segments()) {
        if (!segment.circle || segment.turn * sign < 0) continue;
        const CsgBody disc = lift_.disc(*segment.circle, {profile_[segment.edge].face});
        const auto chord = lift_.left_of(segment.a, segment.b, {});
        if (!chord) continue;
        const CsgBody cap = combined(disc, *chord, sign > 0 ? Op::subtract : Op::intersect);
        result = combined(result, cap, sign > 0 ? Op::unite : Op::subtract);
      }
    return result;
  }

 private:
  using Op = BooleanOp::Kind;
  /// A corner, and the segment that goes on from there (none: a line that closes a pocket).
  struct Corner {
    Vec2 x;
    const EdgeSegment* segment;
  };

  static CsgBody combined(const CsgBody& a, const CsgBody& b, Op kind) { return {a, b, kind}; }

  /// Numbers of the corners on the convex hull, ascending.
  std::vector<int> hull(const std::vector<Corner>& corners) const {
    const double tolerance = profile_rounding * outline_.size() * outline_.size();
    std::vector<int> order(corners.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<int>(k);
    // Corners above each other but for rounding go by their height: out of order they would all seem to be on the hull.
    const auto less = [&](int i, int j) {
      const Vec2 &a = corners[i].x, &b = corners[j].x;
      return std::abs(a[0] - b[0]) > profile_rounding * outline_.size() ? a[0] < b[0] : a[1] < b[1];
    };
    std::sort(order.begin(), order.end(), less);
    std::vector<char> on_hull(corners.size(), 0);
    for (int pass = 0; pass < 2; ++pass) {
      std::vector<int> chain;
      for (const int k : order) {
        while (chain.size() > 1 && cross(corners[chain.back()].x - corners[chain[chain.size() - 2]].x,
                                         corners[k].x - corners[chain.back()].x) < -tolerance)
          chain.pop_back();
        chain.push_back(k);
      }
      for (const int k : chain) on_hull[k] = 1;
      std::reverse(order.begin(), order.end());
    }
    std::vector<int> numbers;
    for (std::size_t k = 0; k < on_hull.size(); ++k)
      if (on_hull[k]) numbers.push_back(static_cast<int>(k));
    return numbers;
  }

  /// A simple polygon, counterclockwise; none: everything.
  std::optional<CsgBody> polygon(const std::vector<Corner>& corners) const {
    std::optional<CsgBody> result;
    const auto intersect = [&](const std::optional<CsgBody>& half) {
      if (half) result = result ? combined(*result, *half, Op::intersect) : *half;
    };
    const std::vector<int> on_hull = hull(corners);
    const int n = static_cast<int>(corners.size());
    std::vector<std::vector<Corner>> pockets;
    for (std::size_t k = 0; k < on_hull.size(); ++k) {
      const int i = on_hull[k], j = on_hull[(k + 1) % on_hull.size()];
      const bool is_edge = (i + 1) % n == j;
      const EdgeSegment* const segment = is_edge ? corners[i].segment : nullptr;
      const bool has_face = segment && !segment->circle;
      intersect(
          left_of(segment, corners[i].x, corners[j].x,
                  has_face ? std::vector<std::string>{profile_[segment->edge].face} : std::vector<std::string>{}));
      if (!is_edge) pockets.push_back(pocket(corners, i, j));
    }
    for (const std::vector<Corner>& corners_of_pocket : pockets)
      if (const auto taken = polygon(corners_of_pocket)) result = combined(*result, *taken, Op::subtract);
    return result;
  }

  /// What is refused is said with the number of the edge.
  std::optional<CsgBody> left_of(const EdgeSegment* segment, const Vec2& a, const Vec2& b,
                                 const std::vector<std::string>& names) const {
    try {
      return lift_.left_of(a, b, names);
    } catch (const InputError& error) {
      throw InputError((segment ? fmt::format("edge {}: ", segment->edge + 1) : "across a pocket: ") + error.what());
    }
  }

  /// Between the line from corner i to j of the hull and the sides there, which are passed from j back to i.
  static std::vector<Corner> pocket(const std::vector<Corner>& corners, int i, int j) {
    const int n = static_cast<int>(corners.size());
    std::vector<Corner> result{{corners[i].x, nullptr}};
    for (int k = j; k != i; k = (k + n - 1) % n) result.push_back({corners[k].x, corners[(k + n - 1) % n].segment});
    return result;
  }

  const Outline& outline_;
  const std::vector<ProfileEdge>& profile_;
  const Lift& lift_;
};

}  // namespace

Solid extruded(const std::vector<ProfileEdge>& profile, const ProfileFrame& frame, double height,
               const std::string& bottom, const std::string& top) {
  if (!(height > 0 && std::isfinite(height))) throw InputError(std::string("an extruded profile must have a height"));
  const Outline outline(profile);
  const Vec3 up = frame.first.cross(frame.second).normalized();
  CsgBody::Hull hull;
  for (const Vec2& x : outline.bounds())
    for (const double z : {0.0, height})
      hull.points.push_back(frame.origin + x[0] * frame.first + x[1] * frame.second + z * up);
  const Extrusion lift(frame, hull);
  Surface low, high;
  low.point = frame.origin;
  low.direction = -up;
  low.names = {bottom};
  high.point = frame.origin + height * up;
  high.direction = up;
  high.names = {top};
  const CsgBody slab({low, high}, hull), prism = Assembly(outline, profile, lift).body();
  return Solid(std::make_shared<CsgBody>(CsgBody(prism, slab, BooleanOp::Kind::intersect).bounded_by(hull)));
}

Solid revolved(const std::vector<ProfileEdge>& profile, const ProfileFrame& frame) {
  const Outline outline(profile);
  double low = 1e300, high = -1e300, radius = 0;
  for (const Vec2& x : outline.bounds()) {
    low = std::min(low, x[1]);
    high = std::max(high, x[1]);
    radius = std::max(radius, x[0]);
  }
  for (const EdgeSegment& segment : outline.segments())
    if (segment.a[0] < -profile_rounding * outline.size())
      throw InputError(fmt::format("edge {} crosses the axis: first coordinates must be >= 0", segment.edge + 1));
  CsgBody::Hull hull;
  hull.points = {frame.origin + low * frame.second, frame.origin + high * frame.second};
  hull.disc_radius = radius;
  hull.axis = frame.second;
  const Revolution lift(frame, hull, outline.size());
  return Solid(std::make_shared<CsgBody>(Assembly(outline, profile, lift).body().bounded_by(hull)));
}

}  // namespace cgcontact
