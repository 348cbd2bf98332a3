#include "core/geometry/csg.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.hpp"

namespace cgcontact {

namespace {

constexpr double merge_tolerance = 1e-12;  // relative to the size of the solid
/// A patch this flat is a plane: coordinates in single precision, as STL files have them, are about 1e-7 off.
/// Small triangles are turned more by that than large ones.
constexpr double flat_tolerance = 1e-6, flat_angle = 1e-2;
constexpr double infinity = std::numeric_limits<double>::infinity();

Vec3 radial(const Surface& surface, const Vec3& x) {
  const Vec3 d = x - surface.point;
  return d - d.dot(surface.direction) * surface.direction;
}

void require(bool condition, const char* problem) {
  if (!condition) throw InputError(std::string(problem));
}

/// Do the surfaces coincide? `opposite` tells whether their inner sides are opposite ones.
bool coincide(const Surface& a, const Surface& b, double length, bool& opposite) {
  if (a.kind != b.kind) return false;
  opposite = false;
  const double tolerance =
      merge_tolerance * length + 1e-15 * std::max(a.point.lpNorm<Eigen::Infinity>(), b.point.lpNorm<Eigen::Infinity>());
  const Vec3 d = b.point - a.point;
  switch (a.kind) {
    case Surface::Kind::sphere:
      return std::abs(a.radius - b.radius) <= tolerance && d.norm() <= tolerance;
    case Surface::Kind::cylinder:
      return std::abs(a.radius - b.radius) <= tolerance && a.direction.cross(b.direction).norm() <= merge_tolerance &&
             radial(a, b.point).norm() <= tolerance;
    case Surface::Kind::plane:
      opposite = a.direction.dot(b.direction) < 0;
      // the points may lie far apart on the plane: compare where it is nearest to both
      return a.direction.cross(b.direction).norm() <= merge_tolerance &&
             std::abs(a.direction.dot(d)) <= tolerance + merge_tolerance * d.norm();
    case Surface::Kind::patch:
      return false;
  }
  return false;
}

/// Logic of a binary operation with unknown (-1) operands.
int combine_sides(BooleanOp::Kind kind, int a, int b) {
  if (kind == BooleanOp::Kind::subtract && b >= 0) b = 1 - b;
  if (kind == BooleanOp::Kind::unite) {
    if (a == 1 || b == 1) return 1;
    return a == 0 && b == 0 ? 0 : -1;
  }
  if (a == 0 || b == 0) return 0;
  return a == 1 && b == 1 ? 1 : -1;
}

/// The patches as elementary surfaces; a flat one is a plane.
std::vector<Surface> patch_surfaces(const std::shared_ptr<const TriangleSurface>& triangles) {
  const std::size_t n = triangles->face_names().size();
  std::vector<Surface> surfaces(n);
  std::vector<double> area(n, 0);
  for (Surface& s : surfaces) s.direction = Vec3::Zero();
  const auto each_triangle = [&](const auto& use) {
    for (std::size_t t = 0; t < triangles->triangles().size(); ++t) use(static_cast<int>(t));
  };
  each_triangle([&](int t) {
    const Vec3 &a = triangles->corner(t, 0), &b = triangles->corner(t, 1), &c = triangles->corner(t, 2);
    const double weight = (b - a).cross(c - a).norm();
    Surface& s = surfaces[triangles->patch(t)];
    s.point += weight * (a + b + c) / 3;
    s.direction += weight * triangles->normal(t);
    area[triangles->patch(t)] += weight;
  });
  for (std::size_t p = 0; p < n; ++p) {
    surfaces[p].names = {triangles->face_names()[p]};
    surfaces[p].point /= area[p];
    surfaces[p].direction.normalize();
  }
  const double distance = flat_tolerance * (triangles->tree().max() - triangles->tree().min()).norm();
  each_triangle([&](int t) {
    Surface& s = surfaces[triangles->patch(t)];
    bool flat = (triangles->normal(t) - s.direction).norm() < flat_angle;
    for (int k = 0; k < 3; ++k) flat = flat && std::abs(s.direction.dot(triangles->corner(t, k) - s.point)) < distance;
    if (flat) return;
    s.kind = Surface::Kind::patch;
    s.triangles = triangles;
    s.patch = triangles->patch(t);
  });
  return surfaces;
}

}  // namespace

double Surface::signed_distance(const Vec3& x) const {
  switch (kind) {
    case Kind::plane:
      return direction.dot(x - point);
    case Kind::sphere:
      return (x - point).norm() - radius;
    case Kind::cylinder:
      return radial(*this, x).norm() - radius;
    case Kind::patch:
      return near(x).signed_distance(x);
  }
  return 0;
}

Surface Surface::near(const Vec3& x) const {
  if (kind != Kind::patch) return *this;
  const int triangle = triangles->nearest(x, patch).triangle;
  Surface plane;
  plane.point = triangles->corner(triangle, 0);
  plane.direction = triangles->normal(triangle);
  return plane;
}

Vec3 Surface::gradient(const Vec3& x) const {
  if (kind == Kind::plane) return direction;
  if (kind == Kind::patch) {
    const TriangleSurface::Foot foot = triangles->nearest(x, patch);
    return triangles->smooth_normal(foot.triangle, foot.point);
  }
  const Vec3 d = kind == Kind::sphere ? Vec3(x - point) : radial(*this, x);
  const double length = d.norm();
  return length > 0 ? Vec3(d / length) : direction.unitOrthogonal();
}

int Surface::intersect_line(const Vec3& x, const Vec3& d, double t[2]) const {
  if (kind == Kind::patch) return 0;
  if (kind == Kind::plane) {
    const double slope = direction.dot(d);
    if (slope == 0) return 0;
    t[0] = direction.dot(point - x) / slope;
    return 1;
  }
  const bool sphere = kind == Kind::sphere;
  const Vec3 r = sphere ? Vec3(x - point) : radial(*this, x);
  const Vec3 e = sphere ? d : Vec3(d - d.dot(direction) * direction);
  const double a = e.squaredNorm(), b = r.dot(e), c = (r.norm() - radius) * (r.norm() + radius);
  const double discriminant = b * b - a * c;
  if (a <= 1e-30 * d.squaredNorm() || discriminant < 0) return 0;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  t[0] = q / a;
  t[1] = q != 0 ? c / q : 0.0;
  if (t[0] > t[1]) std::swap(t[0], t[1]);
  return 2;
}

Solid Solid::primitive(const std::vector<Surface>& surfaces, const Hull& hull) {
  Solid solid;
  solid.surfaces_ = surfaces;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    solid.expression_.push_back({BooleanOp::Kind::surface, static_cast<int>(i)});
    if (i > 0) solid.expression_.push_back({BooleanOp::Kind::intersect, -1});
  }
  solid.hulls_ = {hull};
  solid.bounds_ = {{BooleanOp::Kind::surface, 0}};
  return solid;
}

Solid Solid::box(const Vec3& min, const Vec3& max, const std::string& name) {
  require(min.allFinite() && max.allFinite(), "a box must have finite corners");
  require((max - min).minCoeff() > 0, "a box must have a positive size in every direction");
  static const char* const faces[6] = {".x-", ".x+", ".y-", ".y+", ".z-", ".z+"};
  std::vector<Surface> surfaces;
  for (int k = 0; k < 3; ++k)
    for (int side = 0; side < 2; ++side) {
      Surface s;
      s.point = 0.5 * (min + max);
      s.point[k] = side == 0 ? min[k] : max[k];
      s.direction = (side == 0 ? -1.0 : 1.0) * Vec3::Unit(k);
      s.names = {name + faces[2 * k + side]};
      surfaces.push_back(s);
    }
  Hull hull;
  for (int c = 0; c < 8; ++c)
    hull.points.push_back(Vec3(c & 1 ? max[0] : min[0], c & 2 ? max[1] : min[1], c & 4 ? max[2] : min[2]));
  return primitive(surfaces, hull);
}

Solid Solid::sphere(const Vec3& centre, double radius, const std::string& name) {
  require(centre.allFinite() && std::isfinite(radius) && radius > 0, "a sphere must have a positive radius");
  Surface s;
  s.kind = Surface::Kind::sphere;
  s.point = centre;
  s.radius = radius;
  s.names = {name + ".surface"};
  Hull hull;
  hull.points = {centre};
  hull.ball_radius = radius;
  return primitive({s}, hull);
}

Solid Solid::cylinder(const Vec3& base, const Vec3& top, double radius, const std::string& name) {
  require(base.allFinite() && top.allFinite() && std::isfinite(radius) && radius > 0,
          "a cylinder must have a positive radius");
  const double height = (top - base).norm();
  require(height > 0, "a cylinder must have different centres of its ends");
  Surface side;
  side.kind = Surface::Kind::cylinder;
  side.point = base;
  side.direction = (top - base) / height;
  side.radius = radius;
  side.names = {name + ".side"};
  Surface bottom, lid;
  bottom.point = base;
  bottom.direction = -side.direction;
  bottom.names = {name + ".bottom"};
  lid.point = top;
  lid.direction = side.direction;
  lid.names = {name + ".top"};
  Hull hull;
  hull.points = {base, top};
  hull.disc_radius = radius;
  hull.axis = side.direction;
  return primitive({side, bottom, lid}, hull);
}

Solid Solid::half_space(const Vec3& point, const Vec3& normal, const std::string& name) {
  require(point.allFinite() && normal.allFinite() && normal.norm() > 0, "a half-space must have a non-zero normal");
  Surface s;
  s.point = point;
  s.direction = normal.normalized();
  s.names = {name + ".plane"};
  Hull hull;
  hull.points = {point};
  hull.axis = s.direction;
  hull.half_space = true;
  return primitive({s}, hull);
}

Solid Solid::bounded_by(TriangleSurface surface) {
  Solid solid;
  solid.triangles_ = std::make_shared<const TriangleSurface>(std::move(surface));
  solid.surfaces_ = patch_surfaces(solid.triangles_);
  return solid;
}

double Solid::length_scale() const {
  Vec3 min, max;
  if (bounding_box(min, max) && (max - min).norm() > 0) return (max - min).norm();
  double length = 0;
  for (const Surface& s : surfaces_)
    for (const Surface& other : surfaces_) length = std::max({length, s.radius, (s.point - other.point).norm()});
  return length;
}

Solid Solid::combine(const Solid& a, const Solid& b, BooleanOp::Kind kind) {
  require(!a.triangles_ && !b.triangles_, "a body bounded by a triangle surface cannot be combined with other shapes");
  Solid result = a;
  const double length = std::max(a.length_scale(), b.length_scale());
  std::vector<int> index(b.surfaces_.size());
  std::vector<char> flipped(b.surfaces_.size(), 0);
  for (std::size_t j = 0; j < b.surfaces_.size(); ++j) {
    const Surface& surface = b.surfaces_[j];
    index[j] = -1;
    for (std::size_t i = 0; i < result.surfaces_.size() && index[j] < 0; ++i) {
      bool opposite = false;
      if (!coincide(result.surfaces_[i], surface, length, opposite)) continue;
      index[j] = static_cast<int>(i);
      flipped[j] = opposite;
    }
    if (index[j] < 0) {
      index[j] = static_cast<int>(result.surfaces_.size());
      result.surfaces_.push_back(surface);
      continue;
    }
    auto& names = result.surfaces_[index[j]].names;
    for (const std::string& name : surface.names)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  if (a.expression_.empty()) result.expression_ = result.bounds_ = {{BooleanOp::Kind::empty, -1}};
  for (BooleanOp op : b.expression_) {
    const bool leaf = op.kind == BooleanOp::Kind::surface || op.kind == BooleanOp::Kind::complement_surface;
    if (leaf && flipped[op.surface])
      op.kind = op.kind == BooleanOp::Kind::surface ? BooleanOp::Kind::complement_surface : BooleanOp::Kind::surface;
    if (leaf) op.surface = index[op.surface];
    result.expression_.push_back(op);
  }
  const int num_hulls = static_cast<int>(a.hulls_.size());
  for (BoundOp op : b.bounds_) {
    if (op.kind == BooleanOp::Kind::surface) op.surface += num_hulls;
    result.bounds_.push_back(op);
  }
  if (b.expression_.empty()) {
    result.expression_.push_back({BooleanOp::Kind::empty, -1});
    result.bounds_.push_back({BooleanOp::Kind::empty, -1});
  }
  result.hulls_.insert(result.hulls_.end(), b.hulls_.begin(), b.hulls_.end());
  result.expression_.push_back({kind, -1});
  result.bounds_.push_back({kind, -1});
  return result;
}

Solid Solid::unite(const Solid& a, const Solid& b) { return combine(a, b, BooleanOp::Kind::unite); }
Solid Solid::intersect(const Solid& a, const Solid& b) { return combine(a, b, BooleanOp::Kind::intersect); }
Solid Solid::subtract(const Solid& a, const Solid& b) { return combine(a, b, BooleanOp::Kind::subtract); }

Solid Solid::transformed(const Mat3& rotation, const Vec3& translation, double scale) const {
  require(std::isfinite(scale) && scale > 0 && rotation.allFinite() && translation.allFinite(),
          "a placement must be finite with a positive scale");
  require((rotation.transpose() * rotation - Mat3::Identity()).norm() < 1e-10 && rotation.determinant() > 0,
          "a placement must be a rotation");
  if (triangles_) return bounded_by(triangles_->transformed(rotation, translation, scale));
  Solid result = *this;
  auto move = [&](Vec3& x) { x = (scale * (rotation * x) + translation).eval(); };
  for (Surface& s : result.surfaces_) {
    move(s.point);
    s.direction = (rotation * s.direction).normalized();
    s.radius *= scale;
  }
  for (Hull& hull : result.hulls_) {
    for (Vec3& x : hull.points) move(x);
    hull.axis = (rotation * hull.axis).normalized();
    hull.ball_radius *= scale;
    hull.disc_radius *= scale;
  }
  return result;
}

bool Solid::contains(const Vec3& x) const {
  if (triangles_) return triangles_->contains(x);
  std::vector<char> inner(surfaces_.size());
  for (std::size_t i = 0; i < surfaces_.size(); ++i) inner[i] = surfaces_[i].signed_distance(x) <= 0;
  return evaluate(inner);
}

double Solid::distance_to_surfaces(const Vec3& x) const {
  if (triangles_) return triangles_->nearest(x).distance;
  double least = infinity;
  for (const Surface& s : surfaces_) least = std::min(least, std::abs(s.signed_distance(x)));
  return least;
}

int Solid::surface_at(const Vec3& x, const Vec3& n) const {
  if (triangles_) return triangles_->patch(triangles_->nearest_facing(x, n));
  int best = -1;
  double least = infinity;
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const double misfit = std::abs(surfaces_[s].signed_distance(x)) + (1 - std::abs(surfaces_[s].gradient(x).dot(n)));
    if (misfit >= least) continue;
    least = misfit;
    best = static_cast<int>(s);
  }
  return best;
}

void Solid::crossings(const Vec3& x, const Vec3& d, double reach, std::vector<Crossing>& found) const {
  if (triangles_) {
    triangles_->each_hit(x, d, reach, [&](double t, int triangle) {
      found.push_back({t, triangles_->patch(triangle), triangles_->normal(triangle)});
    });
    return;
  }
  static thread_local std::vector<char> side;
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    double t[2];
    const int count = surfaces_[s].intersect_line(x, d, t);
    for (int r = 0; r < count; ++r) {
      if (std::abs(t[r]) > reach) continue;
      const Vec3 y = x + t[r] * d;
      side.resize(surfaces_.size());
      for (std::size_t k = 0; k < side.size(); ++k) side[k] = surfaces_[k].signed_distance(y) <= 0;
      side[s] = 1;
      const bool inside = evaluate(side);
      side[s] = 0;
      if (inside == evaluate(side)) continue;  // not on the boundary here
      found.push_back({t[r], static_cast<int>(s), (inside ? 1.0 : -1.0) * surfaces_[s].gradient(y)});
    }
  }
}

bool Solid::evaluate(const std::vector<char>& inner_side) const {
  std::vector<signed char> sides(inner_side.begin(), inner_side.end());
  for (auto& side : sides) side = side != 0;
  return evaluate_partial(sides) == 1;
}

int Solid::evaluate_partial(const std::vector<signed char>& sides) const {
  constexpr std::size_t small = 64;  // no allocation for usual solids: this is called for every block of cells
  int fixed[small];
  std::vector<int> large(expression_.size() > small ? expression_.size() : 0);
  int* const stack = large.empty() ? fixed : large.data();
  int size = 0;
  for (const BooleanOp& op : expression_) {
    switch (op.kind) {
      case BooleanOp::Kind::empty:
        stack[size++] = 0;
        break;
      case BooleanOp::Kind::surface:
        stack[size++] = sides[op.surface];
        break;
      case BooleanOp::Kind::complement_surface:
        stack[size++] = sides[op.surface] < 0 ? -1 : 1 - sides[op.surface];
        break;
      default:
        --size;
        stack[size - 1] = combine_sides(op.kind, stack[size - 1], stack[size]);
    }
  }
  return size == 0 ? 0 : stack[0];
}

std::pair<Vec3, Vec3> Solid::hull_bounds(const Hull& hull) {
  Vec3 min = Vec3::Constant(hull.half_space ? -infinity : infinity), max = -min;
  if (hull.half_space) {
    for (int k = 0; k < 3; ++k)
      if (1.0 - std::abs(hull.axis[k]) < 1e-14) (hull.axis[k] > 0 ? max : min)[k] = hull.points[0][k];
    return {min, max};
  }
  for (const Vec3& x : hull.points) {
    min = min.cwiseMin(x);
    max = max.cwiseMax(x);
  }
  for (int k = 0; k < 3; ++k) {
    const double across = std::sqrt(std::max(0.0, 1.0 - hull.axis[k] * hull.axis[k]));
    const double reach = hull.ball_radius + hull.disc_radius * across;
    min[k] -= reach;
    max[k] += reach;
  }
  return {min, max};
}

bool Solid::bounding_box(Vec3& min, Vec3& max) const {
  if (triangles_) {
    min = triangles_->tree().min();
    max = triangles_->tree().max();
    return true;
  }
  std::vector<std::pair<Vec3, Vec3>> stack;
  for (const BoundOp& op : bounds_) {
    if (op.kind == BooleanOp::Kind::surface) {
      stack.push_back(hull_bounds(hulls_[op.surface]));
    } else if (op.kind == BooleanOp::Kind::empty) {
      stack.push_back({Vec3::Constant(infinity), Vec3::Constant(-infinity)});
    } else {
      const auto b = stack.back();
      stack.pop_back();
      auto& a = stack.back();
      if (op.kind == BooleanOp::Kind::unite) a = {a.first.cwiseMin(b.first), a.second.cwiseMax(b.second)};
      if (op.kind == BooleanOp::Kind::intersect) a = {a.first.cwiseMax(b.first), a.second.cwiseMin(b.second)};
    }
  }
  if (stack.empty()) stack.push_back({Vec3::Zero(), Vec3::Zero()});
  min = stack.back().first;
  max = stack.back().second;
  if (!((max - min).minCoeff() >= 0)) {  // empty
    min = max = Vec3::Zero();
    return true;
  }
  return min.allFinite() && max.allFinite();
}

}  // namespace cgcontact
