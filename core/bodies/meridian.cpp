#include "core/bodies/meridian.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "core/base/errors/errors.hpp"
#include "core/bodies/cad_body.hpp"
#include "core/bodies/csg_body.hpp"
#include "core/bodies/profile_body.hpp"

namespace cgcontact {
namespace {

/// Sines of angles, and distances relative to the body, up to which surfaces are about the axis.
constexpr double on_axis_tolerance = 1e-9;

/// Directions of the half-plane: along the axis, away from it, across.
struct HalfPlane {
  explicit HalfPlane(int axis)
      : along(Vec3::Unit(axis)), away(Vec3::Unit((axis + 1) % 3)), across(Vec3::Unit((axis + 2) % 3)) {}
  Vec3 along, away, across;

  bool is_on_axis(const Vec3& x, double size) const {
    return (x - x.dot(along) * along).norm() <= on_axis_tolerance * size;
  }
  bool is_along(const Vec3& direction) const { return direction.cross(along).norm() <= on_axis_tolerance; }
};

/// Tells whether a plane along the axis is so far away that it bounds nothing of a body up to a radius (that of its
/// bounding box).
bool is_beyond(const Surface& surface, const HalfPlane& plane, double radius) {
  return std::abs(surface.direction.dot(plane.along)) <= on_axis_tolerance &&
         surface.direction.dot(surface.point) >= (1 - on_axis_tolerance) * radius;
}

/// Tells whether a surface does not vary around the axis.
bool is_of_revolution(const Surface& surface, const HalfPlane& plane, double size, double radius) {
  switch (surface.kind) {
    case Surface::Kind::plane:
      return plane.is_along(surface.direction) || is_beyond(surface, plane, radius);
    case Surface::Kind::sphere:
      return plane.is_on_axis(surface.point, size);
    case Surface::Kind::cylinder:
    case Surface::Kind::cone:
      return plane.is_along(surface.direction) && plane.is_on_axis(surface.point, size);
    case Surface::Kind::patch:
      return false;
  }
  return false;
}

/// Tells whether a surface is one of a prism across the half-plane.
bool is_of_prism(const Surface& surface, const HalfPlane& plane) {
  const double across = std::abs(surface.direction.dot(plane.across));
  if (surface.kind == Surface::Kind::plane) return across <= on_axis_tolerance || across >= 1 - on_axis_tolerance;
  return surface.kind == Surface::Kind::cylinder && across >= 1 - on_axis_tolerance;
}

/// What a surface of revolution is in the half-plane: circles and lines, as cylinders and planes across it.
Surface section_of(Surface surface, const HalfPlane& plane) {
  switch (surface.kind) {
    case Surface::Kind::plane:
      if (plane.is_along(surface.direction)) break;
      surface.point = 2 * surface.direction.dot(surface.point) * plane.away;  // beyond the body
      surface.direction = plane.away;
      surface.names.clear();
      break;
    case Surface::Kind::sphere:
      surface.kind = Surface::Kind::cylinder;
      surface.direction = plane.across;
      surface.point = surface.point.dot(plane.along) * plane.along;
      break;
    case Surface::Kind::cylinder:
      surface.kind = Surface::Kind::plane;
      surface.direction = plane.away;
      surface.point = surface.radius * plane.away;
      surface.radius = 0;
      break;
    case Surface::Kind::cone: {  // the half that is in use
      const double up = surface.direction.dot(plane.along) > 0 ? 1 : -1;
      surface.kind = Surface::Kind::plane;
      surface.direction = (surface.cosine * plane.away - up * surface.sine * plane.along).normalized();
      surface.point = surface.point.dot(plane.along) * plane.along;
      surface.radius = 0;
      surface.cosine = 1;
      surface.sine = 0;
      break;
    }
    default:
      break;
  }
  return surface;
}

std::string name_of(const Surface& surface) {
  return surface.names.empty() ? "a surface without a name" : "face \"" + surface.names.front() + '"';
}

/// Convex hull of a box.
CsgBody::Hull hull_of(const Vec3& min, const Vec3& max) {
  CsgBody::Hull hull;
  for (int c = 0; c < 8; ++c)
    hull.points.push_back(Vec3(c & 1 ? max[0] : min[0], c & 2 ? max[1] : min[1], c & 4 ? max[2] : min[2]));
  return hull;
}

double area_of(const std::vector<CadModel::SectionEdge>& line) {
  double twice = 0;
  for (const auto& edge : line) {
    const Vec2 middle = edge.is_arc ? edge.through : Vec2((edge.from + edge.to) / 2);
    twice += edge.from[0] * middle[1] - edge.from[1] * middle[0] + middle[0] * edge.to[1] - middle[1] * edge.to[0];
  }
  return std::abs(twice) / 2;
}

/// Points along an edge, its end left out.
std::vector<Vec2> points_along(const CadModel::SectionEdge& edge) {
  constexpr int chords = 256;
  const auto arc = edge.is_arc ? arc_through(edge.from, edge.through, edge.to) : std::nullopt;
  if (!arc) return {edge.from};
  const Vec2& centre = arc->circle.centre;
  std::vector<Vec2> points;
  for (int k = 0; k < chords; ++k)
    points.push_back(centre + Eigen::Rotation2Dd(arc->turn * k / chords) * (edge.from - centre));
  return points;
}

/// Volume of what a closed line goes round, turned about the axis, mm^3: arcs as chords, to 1e-5.
double volume_around(const std::vector<CadModel::SectionEdge>& line) {
  std::vector<Vec2> polygon;
  for (const auto& edge : line)
    for (const Vec2& x : points_along(edge)) polygon.push_back(x);
  double sum = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    sum += pi / 3 * (a[0] * a[0] + a[0] * b[0] + b[0] * b[0]) * (b[1] - a[1]);
  }
  return std::abs(sum);
}

/// The same with the names of a body's faces instead of their numbers; -1: the axis, "": the ends of the prism.
Solid with_names_of(const BodyGeometry& body, const Solid& section) {
  const CsgBody& of_numbers = *as_csg(section);
  std::vector<Surface> surfaces = of_numbers.surfaces();
  for (Surface& surface : surfaces) {
    std::vector<std::string> names;
    for (const std::string& number : surface.names) {
      if (number.empty()) continue;
      const int face = std::stoi(number);
      const std::vector<std::string> of_face =
          face < 0 ? std::vector<std::string>{"axis.plane"} : body.surfaces()[face].names;
      for (const std::string& name : of_face)
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    surface.names = std::move(names);
  }
  Vec3 min, max;
  section.bounding_box(min, max);
  return Solid(std::make_shared<CsgBody>(std::move(surfaces), of_numbers.expression(), hull_of(min, max)));
}

/// The section of a CAD solid as a profile: lines of less area lie in the larger ones, as holes or islands in holes.
Solid section_of(const CadBody& body, const HalfPlane& plane) {
  const Similarity& placement = body.placement();
  const auto into_model = [&](const Vec3& x) {
    return Vec3(placement.rotation.transpose() * (x - placement.translation) / placement.scale);
  };
  const auto direction = [&](const Vec3& d) { return Vec3(placement.rotation.transpose() * d); };
  const ProfileFrame in_model{into_model(Vec3::Zero()), direction(plane.away), direction(plane.along)};
  auto lines = body.model().section(in_model);
  if (lines.empty()) throw InputError(std::string("the half-plane does not meet the body"));
  std::stable_sort(lines.begin(), lines.end(), [](const auto& a, const auto& b) { return area_of(a) > area_of(b); });
  const ProfileFrame frame{half_thickness_of_meridian * plane.across, plane.away, plane.along};
  std::optional<Solid> result;
  double volume = 0;  // mm^3
  for (const auto& line : lines) {
    std::vector<ProfileEdge> profile;
    for (const auto& edge : line)
      profile.push_back({placement.scale * edge.from, placement.scale * edge.to, std::to_string(edge.face),
                         edge.is_arc != 0, placement.scale * edge.through});
    const Solid prism = extruded(profile, frame, 2 * half_thickness_of_meridian, "", "");
    const Vec2 middle =
        profile.front().is_arc ? profile.front().through : Vec2((profile.front().from + profile.front().to) / 2);
    const bool is_hole = result && result->contains(middle[0] * plane.away + middle[1] * plane.along);
    volume += (is_hole ? -1 : 1) * volume_around(line);
    result = !result ? prism : is_hole ? Solid::subtract(*result, prism) : Solid::unite(*result, prism);
  }
  constexpr double same_volume = 1e-4;
  if (const double whole = body.model().volume(); !(std::abs(volume - whole) <= same_volume * whole))
    throw InputError(fmt::format(
        "its section, turned about the axis, has a volume of {:.6g} mm^3, the solid has {:.6g} mm^3: it is no "
        "whole body of revolution, or OpenCASCADE's section is incomplete",
        volume, whole));
  return with_names_of(body, *result);
}

}  // namespace

Solid meridian_of(const Solid& solid, int axis) {
  const HalfPlane plane(axis);
  if (const CadBody* cad = as_cad(solid)) return section_of(*cad, plane);
  const CsgBody* body = as_csg(solid);
  if (!body) throw InputError(std::string("it is bounded by triangles, which are of revolution only nearly"));
  Vec3 min, max;
  if (!solid.bounding_box(min, max)) throw InputError(std::string("the body is not bounded"));
  const int away = (axis + 1) % 3, across = (axis + 2) % 3;
  const double size = (max - min).maxCoeff(),
               radius = std::hypot(std::max(max[away], -min[away]), std::max(max[across], -min[across]));
  std::vector<Surface> surfaces = body->surfaces();
  const Surface *turned = nullptr, *straight = nullptr;  // what is not of revolution, not of a prism
  for (const Surface& surface : body->surfaces()) {
    if (!is_of_revolution(surface, plane, size, radius)) turned = &surface;
    if (!is_of_prism(surface, plane)) straight = &surface;
  }
  if (turned && straight) throw InputError(name_of(*turned) + " is not of revolution about the axis");
  if (turned && min[away] < -on_axis_tolerance * size)
    throw InputError(
        fmt::format("{} is not of revolution about the axis, and a section given as a prism must lie on "
                    "one side of it (it reaches to {:.6g} m)",
                    name_of(*turned), min[away]));
  if (!turned)
    for (Surface& surface : surfaces) surface = section_of(surface, plane);
  min[away] = 0;
  min[across] = -half_thickness_of_meridian;
  max[across] = half_thickness_of_meridian;
  std::vector<BooleanOp> expression = body->expression();
  if (turned)  // its ends become those of the prism below
    for (Surface& surface : surfaces)
      if (surface.kind == Surface::Kind::plane && std::abs(surface.direction[across]) > 0.5)
        surface.point[across] = std::copysign(half_thickness_of_meridian, surface.direction[across]);
  const auto cut_by = [&](const Vec3& point, const Vec3& normal, std::vector<std::string> names) {
    Surface surface;
    surface.point = point;
    surface.direction = normal;
    surface.names = std::move(names);
    expression.push_back({BooleanOp::Kind::surface, static_cast<int>(surfaces.size())});
    expression.push_back({BooleanOp::Kind::intersect, -1});
    surfaces.push_back(surface);
  };
  cut_by(Vec3::Zero(), -plane.away, {"axis.plane"});
  if (!turned)
    for (const int side : {-1, 1}) cut_by(side * half_thickness_of_meridian * plane.across, side * plane.across, {});
  return Solid(std::make_shared<CsgBody>(std::move(surfaces), std::move(expression), hull_of(min, max)));
}

}  // namespace cgcontact
