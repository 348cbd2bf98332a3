#include "core/bodies/csg_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors/errors.hpp"
#include "core/base/numbers/rounding.hpp"
#include "core/bodies/cell_facets.hpp"
#include "core/cells/cell_sweep.hpp"
#include "core/cells/grid.hpp"

namespace cgcontact {

namespace {

constexpr double merge_tolerance = 1e-12;  // relative to the size of the solid
constexpr double infinity = std::numeric_limits<double>::infinity();

void require(bool condition, const char* problem) {
  if (!condition) throw InputError(std::string(problem));
}

/// Returns whether the surfaces coincide; sets `opposite` if their inner sides are opposite ones.
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
    case Surface::Kind::cone:
      return std::abs(a.cosine * b.sine - a.sine * b.cosine) <= merge_tolerance && d.norm() <= tolerance &&
             a.direction.cross(b.direction).norm() <= merge_tolerance;
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

std::pair<Vec3, Vec3> hull_bounds(const CsgBody::Hull& hull) {
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

}  // namespace

void check_cone(const Surface& cone) {
  constexpr double steepest = 0.01;  // least cosine: flatter ones turn too much beside their other half
  constexpr double slimmest = 1e-6;  // least sine: beyond, the tip is too far away for double precision
  if (cone.cosine < steepest || cone.sine < slimmest)
    throw InputError(fmt::format("a line at {:.6g} degrees to the axis, not at 0, {:.2g} to {:.4g} or 90",
                                 std::atan2(cone.sine, cone.cosine) / radians_per_degree,
                                 std::asin(slimmest) / radians_per_degree, std::acos(steepest) / radians_per_degree));
}

namespace {

/// The largest cells, of halves of halves, that no more surfaces cross than can.
std::string remedy(const CsgBody& body, const Grid& grid, const Vec3& corner) {
  constexpr int max_division = 16;
  for (int division = 2; division <= max_division; division *= 2) {
    bool fits = true;
    const Vec3 half = Vec3::Constant(0.5 / division);
    for (int n = 0; n < division * division * division && fits; ++n) {
      const int x = n % division, y = n / division % division, z = n / (division * division);
      const Vec3 centre = corner + Vec3(x, y, z) / division + half;
      fits = std::count_if(body.surfaces().begin(), body.surfaces().end(),
                           [&](const Surface& s) { return side_of_box(s, centre, half) < 0; }) <= max_table_bits;
    }
    if (fits) return fmt::format("a cell_size of {:.3g} m or less", grid.cell_size / division);
  }
  return "fewer shapes that meet in one point; smaller cells do not help";
}

LocalSolid local_solid(const CsgBody& body, const Grid& grid, const Index3& cell) {
  const Vec3 corner(cell[0], cell[1], cell[2]);
  try {
    return make_local_solid(body, corner, 1);
  } catch (const InputError& error) {
    const Vec3 x = grid.to_global(corner + Vec3::Constant(0.5));
    throw InputError(fmt::format("{}; the cell is at ({:.4g}, {:.4g}, {:.4g}) m (allowed: {})", error.what(), x[0],
                                 x[1], x[2], remedy(body, grid, corner)));
  }
}

}  // namespace

CsgBody::CsgBody(std::vector<Surface> surfaces, Hull hull) : hulls_{std::move(hull)} {
  surfaces_ = std::move(surfaces);
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    expression_.push_back({BooleanOp::Kind::surface, static_cast<int>(i)});
    if (i > 0) expression_.push_back({BooleanOp::Kind::intersect, -1});
  }
  bounds_ = {{BooleanOp::Kind::surface, 0}};
}

CsgBody::CsgBody(std::vector<Surface> surfaces, std::vector<BooleanOp> expression, Hull hull)
    : expression_(std::move(expression)), hulls_{std::move(hull)}, bounds_{{BooleanOp::Kind::surface, 0}} {
  surfaces_ = std::move(surfaces);
}

CsgBody CsgBody::bounded_by(Hull hull) const {
  CsgBody result = *this;
  result.hulls_ = {std::move(hull)};
  result.bounds_ = {{BooleanOp::Kind::surface, 0}};
  return result;
}

CsgBody::CsgBody(const CsgBody& a, const CsgBody& b, BooleanOp::Kind kind) : CsgBody(a) {
  std::vector<int> index(b.surfaces_.size());
  std::vector<char> flipped(b.surfaces_.size(), 0);
  merge_surfaces(b, std::max(a.length_scale(), b.length_scale()), index, flipped);
  append_expression(b, index, flipped);
  expression_.push_back({kind, -1});
  bounds_.push_back({kind, -1});
}

/// Adds the surfaces of b that are not there yet. Of each: its number here, and whether its inner side is the opposite
/// one.
void CsgBody::merge_surfaces(const CsgBody& b, double length, std::vector<int>& index, std::vector<char>& flipped) {
  for (std::size_t j = 0; j < b.surfaces_.size(); ++j) {
    const Surface& surface = b.surfaces_[j];
    index[j] = -1;
    for (std::size_t i = 0; i < surfaces_.size() && index[j] < 0; ++i) {
      bool opposite = false;
      if (!coincide(surfaces_[i], surface, length, opposite)) continue;
      index[j] = static_cast<int>(i);
      flipped[j] = opposite;
    }
    if (index[j] < 0) {
      index[j] = static_cast<int>(surfaces_.size());
      surfaces_.push_back(surface);
      continue;
    }
    auto& names = surfaces_[index[j]].names;
    for (const std::string& name : surface.names)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
}

void CsgBody::append_expression(const CsgBody& b, const std::vector<int>& index, const std::vector<char>& flipped) {
  const BooleanOp empty{BooleanOp::Kind::empty, -1};
  if (expression_.empty()) expression_ = bounds_ = {empty};
  for (BooleanOp op : b.expression_) {
    const bool leaf = op.kind == BooleanOp::Kind::surface || op.kind == BooleanOp::Kind::complement_surface;
    if (leaf && flipped[op.surface])
      op.kind = op.kind == BooleanOp::Kind::surface ? BooleanOp::Kind::complement_surface : BooleanOp::Kind::surface;
    if (leaf) op.surface = index[op.surface];
    expression_.push_back(op);
  }
  const int num_hulls = static_cast<int>(hulls_.size());
  for (BoundOp op : b.bounds_) {
    if (op.kind == BooleanOp::Kind::surface) op.surface += num_hulls;
    bounds_.push_back(op);
  }
  if (b.expression_.empty()) {
    expression_.push_back(empty);
    bounds_.push_back(empty);
  }
  hulls_.insert(hulls_.end(), b.hulls_.begin(), b.hulls_.end());
}

std::shared_ptr<const BodyGeometry> CsgBody::transformed(const Mat3& rotation, const Vec3& translation,
                                                         double scale) const {
  auto result = std::make_shared<CsgBody>(*this);
  auto move = [&](Vec3& x) { x = (scale * (rotation * x) + translation).eval(); };
  for (Surface& s : result->surfaces_) {
    move(s.point);
    s.direction = (rotation * s.direction).normalized();
    s.radius *= scale;
  }
  for (Hull& hull : result->hulls_) {
    for (Vec3& x : hull.points) move(x);
    hull.axis = (rotation * hull.axis).normalized();
    hull.ball_radius *= scale;
    hull.disc_radius *= scale;
  }
  return result;
}

std::shared_ptr<const BodyGeometry> CsgBody::stretched(int axis, double factor, double shift) const {
  Vec3 min, max;
  require(bounding_box(min, max), "a prism must be bounded");
  auto result = std::make_shared<CsgBody>(*this);
  for (Surface& s : result->surfaces_) {
    const double cosine = std::abs(s.direction[axis]);
    const bool along =
        s.kind == Surface::Kind::plane ? cosine < rounding : s.kind == Surface::Kind::cylinder && cosine > 1 - rounding;
    const bool end = s.kind == Surface::Kind::plane && cosine > 1 - rounding;
    const double slack = rounding * (max - min)[axis];
    if (!(along || end) || (end && s.point[axis] > min[axis] + slack && s.point[axis] < max[axis] - slack))
      throw InputError(fmt::format("surface {} is neither an end of a prism nor along its axis",
                                   s.names.empty() ? "without a name" : '"' + s.names.front() + '"'));
    if (along) s.direction[axis] = s.kind == Surface::Kind::plane ? 0 : std::copysign(1.0, s.direction[axis]);
    s.direction.normalize();
    s.point[axis] = factor * s.point[axis] + shift;
  }
  for (Hull& hull : result->hulls_)
    for (Vec3& x : hull.points) x[axis] = factor * x[axis] + shift;
  return result;
}

double CsgBody::length_scale() const {
  Vec3 min, max;
  if (bounding_box(min, max) && (max - min).norm() > 0) return (max - min).norm();
  double length = 0;
  for (const Surface& s : surfaces_)
    for (const Surface& other : surfaces_) length = std::max({length, s.radius, (s.point - other.point).norm()});
  return length;
}

bool CsgBody::contains(const Vec3& x) const {
  std::vector<char> inner(surfaces_.size());
  for (std::size_t i = 0; i < surfaces_.size(); ++i) inner[i] = surfaces_[i].signed_distance(x) <= 0;
  return evaluate(inner);
}

double CsgBody::distance_to_surfaces(const Vec3& x) const {
  double least = infinity;
  for (const Surface& s : surfaces_) least = std::min(least, std::abs(s.signed_distance(x)));
  return least;
}

int CsgBody::surface_at(const Vec3& x, const Vec3& n) const {
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

void CsgBody::crossings(const Vec3& x, const Vec3& d, double reach, std::vector<Crossing>& found) const {
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

bool CsgBody::evaluate(const std::vector<char>& inner_side) const {
  std::vector<signed char> sides(inner_side.begin(), inner_side.end());
  for (auto& side : sides) side = side != 0;
  return evaluate_partial(sides) == 1;
}

int CsgBody::evaluate_partial(const std::vector<signed char>& sides) const {
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

bool CsgBody::bounding_box(Vec3& min, Vec3& max) const {
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

int CsgBody::side_of_block(const Vec3& centre, const Vec3& half_size, std::vector<signed char>& sides) const {
  for (std::size_t i = 0; i < sides.size(); ++i)
    if (sides[i] < 0) sides[i] = static_cast<signed char>(side_of_box(surfaces_[i], centre, half_size));
  return evaluate_partial(sides);
}

std::unique_ptr<CellSweep> CsgBody::sweep_cells(const Grid& grid, const std::vector<Plane>& dividers, int order,
                                                const LeafLevel& leaves) const {
  const auto integrate = [this, &grid, &dividers, order](const Index3& cell, SweptCells& found) {
    const LocalSolid local = local_solid(*this, grid, cell);
    if (local.is_constant()) {
      if (local.table[0]) found.inside.emplace_back(cell, 1);
      return;
    }
    found.crossed.push_back({cell, cell_moments(*this, local, cell), {}});
    cell_boundary_points(*this, local, cell, {}, dividers, order, 0, found.crossed.back().points);
  };
  return std::make_unique<CellByCell>(*this, grid, leaves, integrate);
}

void CsgBody::boundary_points(const Index3& cell, const std::vector<char>& selected, const std::vector<Plane>& dividers,
                              int order, int owner, BoundaryPoints& points) const {
  const LocalSolid local = make_local_solid(*this, Vec3(cell[0], cell[1], cell[2]), 1);
  cell_boundary_points(*this, local, cell, selected, dividers, order, owner, points);
}

CellEstimate CsgBody::estimate_cells(const Grid& grid, double max_cells) const {
  return estimate_by_coarse_cells(*this, grid, max_cells);
}

const CsgBody* as_csg(const Solid& solid) { return dynamic_cast<const CsgBody*>(&solid.geometry()); }

namespace {

Solid primitive(const std::vector<Surface>& surfaces, const CsgBody::Hull& hull) {
  return Solid(std::make_shared<CsgBody>(surfaces, hull));
}

Solid combine(const Solid& a, const Solid& b, BooleanOp::Kind kind) {
  const CsgBody *first = as_csg(a), *second = as_csg(b);
  require(first && second, "only bodies of primitive shapes can be combined as expressions");
  return Solid(std::make_shared<CsgBody>(*first, *second, kind));
}

}  // namespace

Solid::Solid() {
  static const auto nothing = std::make_shared<CsgBody>();
  geometry_ = nothing;
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
  CsgBody::Hull hull;
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
  CsgBody::Hull hull;
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
  CsgBody::Hull hull;
  hull.points = {base, top};
  hull.disc_radius = radius;
  hull.axis = side.direction;
  return primitive({side, bottom, lid}, hull);
}

Solid Solid::cone(const Vec3& base, const Vec3& top, double base_radius, double top_radius, const std::string& name) {
  const double height = (top - base).norm(), difference = std::abs(top_radius - base_radius);
  require(base.allFinite() && top.allFinite() && std::isfinite(height) && height > 0,
          "a cone must have different centres of its ends");
  require(std::min(base_radius, top_radius) >= 0 && difference > 0 && std::isfinite(difference),
          "a cone must have two different radii");
  const Vec3 up = (top - base) / height;
  const bool narrows = top_radius < base_radius;
  const double generator = std::hypot(height, difference);
  Surface side;
  side.kind = Surface::Kind::cone;
  side.direction = narrows ? Vec3(-up) : up;
  side.radius = std::max(base_radius, top_radius);
  side.cosine = height / generator;
  side.sine = difference / generator;
  side.point = (narrows ? base : top) - height * side.radius / difference * side.direction;
  check_cone(side);
  side.names = {name + ".side"};
  Surface bottom, lid;
  bottom.point = base;
  bottom.direction = -up;
  lid.point = top;
  lid.direction = up;
  if (base_radius > 0) bottom.names = {name + ".bottom"};
  if (top_radius > 0) lid.names = {name + ".top"};
  CsgBody::Hull hull;
  hull.points = {base, top};
  hull.disc_radius = side.radius;
  hull.axis = up;
  return primitive({side, bottom, lid}, hull);
}

Solid Solid::half_space(const Vec3& point, const Vec3& normal, const std::string& name) {
  require(point.allFinite() && normal.allFinite() && normal.norm() > 0, "a half-space must have a non-zero normal");
  Surface s;
  s.point = point;
  s.direction = normal.normalized();
  s.names = {name + ".plane"};
  CsgBody::Hull hull;
  hull.points = {point};
  hull.axis = s.direction;
  hull.half_space = true;
  return primitive({s}, hull);
}

Solid Solid::unite(const Solid& a, const Solid& b) { return combine(a, b, BooleanOp::Kind::unite); }
Solid Solid::intersect(const Solid& a, const Solid& b) { return combine(a, b, BooleanOp::Kind::intersect); }
Solid Solid::subtract(const Solid& a, const Solid& b) { return combine(a, b, BooleanOp::Kind::subtract); }

}  // namespace cgcontact
