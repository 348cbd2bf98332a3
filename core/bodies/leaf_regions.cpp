#include "core/bodies/leaf_regions.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/errors/errors.hpp"
#include "core/geometry/solid_middle.hpp"

namespace cgcontact {

namespace {

constexpr double same_slope = 1e-9;     // of graphs: the first axis counts, whatever the rounding
constexpr double same_position = 1e-9;  // cells; the middle of a leaf and of the solid
constexpr double same_quadric = 1e-14;
constexpr double same_axis = 1e-12;  // of two surfaces of revolution: rounding of what a scene computes
constexpr double min_slope = 0.3;    // least |component of the unit normal| along the axis of a graph
constexpr int max_depth = 12;        // of the cutting into octants
constexpr int comfortable_surfaces = 8;
constexpr int max_dividers = 40;
constexpr std::uint64_t lower_bit = std::uint64_t{1} << 20, upper_bit = std::uint64_t{1} << 21;
constexpr int first_divider_bit = 22;

/// Returns the quadric of a cone, with unit slope on it at the distance of x from its tip.
Quadric expand_cone(const Surface& cone, const Vec3& x) {
  const Vec3 across = radial(cone, x), &n = cone.direction;
  const double h = height(cone, x), rho = across.norm(), c = cone.cosine, s = cone.sine;
  const double from_tip = (x - cone.point).norm(), slope = (from_tip > 0 ? from_tip : 1) * c * s;
  Quadric result;
  result.c = (rho * c - h * s) * (rho * c + h * s) / (2 * slope);
  result.g = (c * c * across - s * s * h * n) / slope;
  result.q = (c * c * Mat3::Identity() - n * n.transpose()) / (2 * slope);
  return result;
}

/// Returns a function with the sign of the surface's signed distance, of unit slope on the surface, as a polynomial of
/// the difference to x. One copy: cells that share a face need bitwise equal coefficients.
[[gnu::noinline]] Quadric expand(const Surface& surface, const Vec3& x) {
  Quadric result;
  const Vec3 d = x - surface.point;
  if (surface.kind == Surface::Kind::plane) {
    result.c = surface.direction.dot(d);
    result.g = surface.direction;
    return result;
  }
  if (surface.kind == Surface::Kind::cone) return expand_cone(surface, x);
  Vec3 r = d;
  result.q = Mat3::Identity();
  if (surface.kind == Surface::Kind::cylinder) {
    r -= d.dot(surface.direction) * surface.direction;
    result.q -= surface.direction * surface.direction.transpose();
  }
  const double distance = r.norm();
  result.c = (distance - surface.radius) * (distance + surface.radius) / (2 * surface.radius);
  result.g = r / surface.radius;
  result.q /= 2 * surface.radius;
  return result;
}

[[gnu::noinline]] Conic section(const Surface& surface, const Vec3& base, const Vec3& s, const Vec3& t) {
  const Quadric f = expand(surface, base);
  Conic conic;
  conic.c = f.c;
  conic.s = f.g.dot(s);
  conic.t = f.g.dot(t);
  if (surface.kind != Surface::Kind::plane) {
    conic.ss = s.dot(f.q * s);
    conic.st = 2 * s.dot(f.q * t);
    conic.tt = t.dot(f.q * t);
  }
  return conic;
}

Quadric permuted(const Quadric& f, const Mat3& axes) {
  return {f.c, axes.transpose() * f.g, axes.transpose() * f.q * axes};
}

/// The function up to a multiple of that of the graph, which is zero there: a plane, if one is possible.
Quadric on_graph(const Quadric& f, const Quadric& graph) {
  const double factor = f.q.cwiseProduct(graph.q).sum() / graph.q.squaredNorm();
  if (!((f.q - factor * graph.q).norm() < same_quadric * f.q.norm())) return f;
  return {f.c - factor * graph.c, f.g - factor * graph.g, Mat3::Zero()};
}

/// Surfaces of revolution about one axis meet in circles, which are plane: replaces the function f on the graph of the
/// other one by the plane of the circle in the leaf. Returns its sign where there is no circle there, else 0 (f stays
/// as it is if there are two, or if the axes differ).
int rim_plane(const Vec3& axis, const Quadric& graph, double width, Quadric& f) {
  if (f.q.isZero(0)) return 0;
  const Vec3 across = axis.unitOrthogonal();
  const double factor = across.dot(f.q * across) / across.dot(graph.q * across);
  const Quadric rest{f.c - factor * graph.c, f.g - factor * graph.g, f.q - factor * graph.q};
  const double a = axis.dot(rest.q * axis), b = axis.dot(rest.g);
  const double size = f.q.norm() + std::abs(factor) * graph.q.norm();
  const double slope = f.g.norm() + std::abs(factor) * graph.g.norm();
  if (!((rest.q - a * axis * axis.transpose()).norm() < same_axis * size) ||
      !((rest.g - b * axis).norm() < same_axis * slope))
    return 0;
  const double low = width * axis.cwiseMin(0.0).sum(), high = width * axis.cwiseMax(0.0).sum();
  const double margin = same_position * width;
  double roots[2], root = 0;
  int inside = 0;
  const int count = quadratic_roots(a, b, rest.c, roots);
  for (int r = 0; r < count; ++r) {
    if (roots[r] < low - margin || roots[r] > high + margin) continue;
    root = roots[r];
    ++inside;
  }
  if (inside == 2) return 0;
  if (inside == 0) return rest(0.5 * (low + high) * axis) < 0 ? -1 : 1;
  const double sign = 2 * a * root + b > 0 ? 1 : -1;
  f = {-sign * root, sign * axis, Mat3::Zero()};
  return 0;
}

/// Axis along which the surface is a graph in the box, or -1 if it turns too much.
int graph_axis(const Surface& surface, const Vec3& corner, double width) {
  const Quadric f = expand(surface, corner + Vec3::Constant(0.5 * width));
  int best = 0;
  double best_slope = -1;
  for (int k = 0; k < 3; ++k) {
    const double slope = std::abs(f.g[k]) - width * f.q.row(k).cwiseAbs().sum();
    if (slope <= best_slope + same_slope) continue;
    best = k;
    best_slope = slope;
  }
  return surface.kind == Surface::Kind::plane || best_slope >= min_slope ? best : -1;
}

/// Surfaces that are no graphs even in the smallest leaves (beside the tip of a cone) end at its middle there.
void leave_out_tips(Leaf& leaf) {
  const auto& all = leaf.solid->surfaces();
  const Vec3 half = Vec3::Constant(0.5 * leaf.width), middle = leaf.corner + half;
  std::vector<signed char> sides;
  for (const Surface& surface : all) {
    const bool tip = graph_axis(surface, leaf.corner, leaf.width) < 0;
    sides.push_back(
        static_cast<signed char>(tip ? surface.signed_distance(middle) < 0 : side_of_box(surface, middle, half)));
  }
  leaf.local = make_local_solid(*leaf.solid, sides);
}

void visit_leaves(Leaf& leaf, int depth, const std::function<void(const Leaf&)>& visit) {
  const auto& surfaces = leaf.local.surfaces;
  if (surfaces.empty()) {
    if (leaf.local.table[0]) visit(leaf);
    return;
  }
  const bool last = depth == max_depth;
  bool divide = surfaces.size() > comfortable_surfaces || leaf.dividers.size() > max_dividers;
  leaf.axis.assign(surfaces.size(), 0);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    leaf.axis[i] = graph_axis(leaf.solid->surfaces()[surfaces[i]], leaf.corner, leaf.width);
    divide = divide || leaf.axis[i] < 0;
  }
  if (last && std::any_of(leaf.axis.begin(), leaf.axis.end(), [](int axis) { return axis < 0; })) {
    leave_out_tips(leaf);
    return visit_leaves(leaf, depth, visit);
  }
  if (!divide || last) {
    if (leaf.dividers.size() > max_dividers)
      throw InputError("the cells of two bodies in contact differ too much in size");
    return visit(leaf);
  }
  for (int octant = 0; octant < 8; ++octant) {
    Leaf child;
    child.solid = leaf.solid;
    child.width = 0.5 * leaf.width;
    child.corner = leaf.corner + child.width * Vec3(octant & 1, octant >> 1 & 1, octant >> 2 & 1);
    child.local = make_local_solid(*leaf.solid, child.corner, child.width);
    child.dividers = crossing_planes(leaf.dividers, child.corner, child.width);
    child.middle = leaf.middle;
    visit_leaves(child, depth + 1, visit);
  }
}

}  // namespace

void for_each_leaf(const CsgBody& solid, const LocalSolid& local, const Vec3& corner,
                   const std::vector<Plane>& dividers, const std::function<void(const Leaf&)>& visit) {
  Leaf leaf;
  leaf.solid = &solid;
  leaf.corner = corner;
  leaf.local = local;
  leaf.dividers = crossing_planes(dividers, corner, 1);
  leaf.middle = middle_of(solid);
  visit_leaves(leaf, 0, visit);
}

Leaf::Frame Leaf::frame(int along) const {
  Frame frame{Mat3::Zero(), corner};
  for (int k = 0; k < 3; ++k) {
    const int d = (along + 1 + k) % 3;
    const bool turned = k < 2 && corner[d] + 0.5 * width > middle[d] + same_position;
    frame.axes(d, k) = turned ? -1 : 1;
    if (turned) frame.origin[d] += width;
  }
  return frame;
}

Region face_region(const Leaf& leaf, int axis) {
  const Leaf::Frame frame = leaf.frame(axis);
  Vec3 corner = frame.origin;
  corner[axis] += leaf.width;
  Region region;
  region.width = leaf.width;
  region.predicate.table = &leaf.local.table;
  region.predicate.surface_mask = leaf.local.table.size() - 1;
  for (std::size_t i = 0; i < leaf.local.surfaces.size(); ++i) {
    RegionFunction f;
    f.bit = std::uint64_t{1} << i;
    f.conic = section(leaf.solid->surfaces()[leaf.local.surfaces[i]], corner, frame.axes.col(0), frame.axes.col(1));
    region.add(f);
  }
  return region;
}

LeafFacet::LeafFacet(const Leaf& leaf, int i)
    : leaf_(leaf),
      index_(i),
      axis_(leaf.axis[i]),
      surface_(leaf.solid->surfaces()[leaf.local.surfaces[i]]),
      frame_(leaf.frame(axis_)),
      base_(frame_.origin),
      along_s_(frame_.axes.col(0)),
      along_t_(frame_.axes.col(1)) {
  region_.width = leaf.width;
  region_.predicate.table = &leaf.local.table;
  region_.predicate.surface_mask = leaf.local.table.size() - 1;
  region_.predicate.facet = std::uint64_t{1} << i;
  region_.predicate.lower = lower_bit;
  region_.predicate.upper = upper_bit;
  add_ownership();
  if (is_plane()) {
    const Vec3& n = surface_.direction;
    base_[axis_] -= expand(surface_, base_).c / n[axis_];
    along_s_[axis_] = -n.dot(frame_.axes.col(0)) / n[axis_];
    along_t_[axis_] = -n.dot(frame_.axes.col(1)) / n[axis_];
  } else {
    region_.has_graph = true;
    region_.graph.quadric = permuted(expand(surface_, frame_.origin), frame_.axes);
    region_.graph.sign = expand(surface_, leaf.corner + Vec3::Constant(0.5 * leaf.width)).g[axis_] > 0 ? 1.0 : -1.0;
  }
  add_trims();
  add_dividers();
}

void LeafFacet::add_ownership() {
  for (const std::uint64_t bit : {lower_bit, upper_bit}) {
    Vec3 corner = frame_.origin;
    if (bit == upper_bit) corner[axis_] += leaf_.width;
    RegionFunction f;
    f.bit = bit;
    f.conic = section(surface_, corner, frame_.axes.col(0), frame_.axes.col(1));
    region_.add(f);
  }
}

void LeafFacet::add_trims() {
  for (std::size_t j = 0; j < leaf_.local.surfaces.size(); ++j) {
    if (static_cast<int>(j) == index_) continue;
    const Surface& other = leaf_.solid->surfaces()[leaf_.local.surfaces[j]];
    RegionFunction f;
    f.bit = std::uint64_t{1} << j;
    f.on_graph = !is_plane();
    if (is_plane()) {
      f.conic = section(other, base_, along_s_, along_t_);
    } else {
      f.quadric = on_graph(permuted(expand(other, frame_.origin), frame_.axes), region_.graph.quadric);
      const Surface& round = surface_.kind == Surface::Kind::sphere ? other : surface_;
      const int sign =
          rim_plane(frame_.axes.transpose() * round.direction, region_.graph.quadric, leaf_.width, f.quadric);
      if (sign < 0) region_.fixed_bits |= f.bit;
      if (sign != 0) continue;
    }
    region_.add(f);
  }
}

void LeafFacet::add_dividers() {
  for (std::size_t d = 0; d < leaf_.dividers.size(); ++d) {
    const Plane& plane = leaf_.dividers[d];
    if (!plane.divides(leaf_.local.surfaces[index_])) continue;
    RegionFunction f;
    f.bit = std::uint64_t{1} << (first_divider_bit + d);
    f.is_divider = true;
    f.on_graph = !is_plane();
    const double value = plane.normal.dot(base_) - plane.offset;
    if (is_plane())
      f.conic = Conic{value, plane.normal.dot(along_s_), plane.normal.dot(along_t_)};
    else
      f.quadric = {plane.normal.dot(frame_.origin) - plane.offset, frame_.axes.transpose() * plane.normal,
                   Mat3::Zero()};
    region_.predicate.divider_mask |= f.bit;
    region_.add(f);
  }
}

SurfacePoint LeafFacet::at(double s, double t) const {
  if (is_plane())
    return {base_ + s * along_s_ + t * along_t_, surface_.direction, 1 / std::abs(surface_.direction[axis_])};
  const Vec3 x = frame_.origin + frame_.axes * Vec3(s, t, region_.graph.height(s, t));
  const Vec3 n = surface_.gradient(x);
  return {x, n, 1 / std::abs(n[axis_])};
}

}  // namespace cgcontact
