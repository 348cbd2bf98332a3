#include "contact/model/plane_strain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/files/text.hpp"

namespace cgcontact {
namespace {

/// Cells: so much may stick out of the layer, so thin may it be. Cells filled by less than a quarter do not
/// hold their nodes; those that the sides cut are filled by less than the thickness.
constexpr double sticking_out = 1e-6, thinnest = 0.5;
/// Tolerance of the normals and, in cells, of the positions of the ends: triangle surfaces have coordinates in single
/// precision.
constexpr double flat_end_tolerance = 1e-3;
/// Fraction of a load: less than that along the axis is none.
constexpr double along_axis = 1e-3;
/// Fraction of the thickness: triangle surfaces have coordinates in single precision.
constexpr double same_ends = 1e-5;

[[noreturn]] void refuse(const BodySpec& body, const std::string& problem, const std::string& allowed) {
  const std::string& axis =
      body.axisymmetric() ? coordinate_names()[body.axis_of_revolution()] : name_of(*body.plane_strain);
  throw InputError(body.plane_strain_location, '"' + axis + '"', "body \"" + body.name + "\": " + problem, allowed);
}

std::string name_of_face(const Scene& scene, const FaceRef& face) {
  return '"' + scene.bodies[face.body].name + "." + face.face.name + '"';
}

int axis_of(const BodySpec& body) { return static_cast<int>(*body.plane_strain); }

/// Where a bounded body ends along its axis, m.
std::pair<double, double> ends_of(const BodySpec& body) {
  Vec3 min, max;
  if (!body.solid.bounding_box(min, max))
    throw InputError(body.location, '"' + body.name + '"', "the body is not bounded",
                     "intersect half-spaces with a box");
  return {min[axis_of(body)], max[axis_of(body)]};
}

/// Tells whether a boundary point is on an end.
bool on_end(const BodyModel& body, int point) { return std::abs(body.normal(point)[axis_of(*body.spec)]) > 0.5; }

std::string on_end_text(const BodySpec& body, const Vec3& x) {
  return "lies on an end of a body in plane strain across " + name_of(*body.plane_strain) + ", " + at_position(x);
}

void check_supports(const Scene& scene, const std::vector<BodyModel>& bodies,
                    const std::vector<SupportPoint>& supports) {
  for (const SupportPoint& p : supports) {
    const BodySpec& body = scene.bodies[p.body];
    if (!body.plane_strain || p.support < 0 || p.implied) continue;
    const SupportSpec& support = scene.supports[p.support];
    const std::string& axis = name_of(*body.plane_strain);
    const Vec3 x = global_position(bodies[p.body].cut_cells, p.cell, p.xi);
    if (std::abs(p.normal[axis_of(body)]) > 0.5)
      throw InputError(support.location, name_of_face(scene, support.face),
                       on_end_text(body, x) + ": its ends hold of themselves", "supports on the sides only");
    if (p.value == 0 || std::abs(p.direction[axis_of(body)]) <= flat_end_tolerance) continue;
    const std::string moves = body.axisymmetric() ? "turns a body of revolution about its axis"
                                                  : "moves a body in plane strain along " + axis;
    throw InputError(support.location, name_of_face(scene, support.face), moves + ", " + at_position(x),
                     "no displacement along " + axis + ", or 0");
  }
}

/// A force on a face of a body of revolution acts along the axis: others have no resultant, or vary around it.
void check_resultants(const Scene& scene, const LoadSpec& load, const BodySpec& body) {
  if (!load.has_resultants()) return;
  const int along = body.axis_of_revolution();
  const Vec3 other = load.force - load.force[along] * Vec3::Unit(along);
  if (other.norm() <= along_axis * load.force.norm() && load.moment.isZero(0) && !load.bearing) return;
  throw InputError(
      load.location, name_of_face(scene, load.face), "a force or moment that varies around the axis of revolution",
      fmt::format("a force along {}, pressures and tractions in the half-plane", coordinate_names()[along]));
}

void check_load(const Scene& scene, int number, const BodyModel& body) {
  const LoadSpec& load = scene.loads[number];
  if (body.spec->axisymmetric()) check_resultants(scene, load, *body.spec);
  const FaceTraction resultant = resultant_of(body, number);
  const int axis = axis_of(*body.spec);
  for (const int p : BodyFace(load.face.face, body).points()) {
    const Vec3 x = body.point(p);
    const std::string& name = name_of(*body.spec->plane_strain);
    if (on_end(body, p))
      throw InputError(load.location, name_of_face(scene, load.face), on_end_text(*body.spec, x),
                       "loads on the sides only");
    const Vec3 traction = load.traction_at(x, body.normal(p), resultant);
    if (std::abs(traction[axis]) > along_axis * traction.norm())
      throw InputError(load.location, name_of_face(scene, load.face),
                       fmt::format("acts along {}, {}, {}", name,
                                   body.spec->axisymmetric() ? "around the axis of revolution"
                                                             : "across which the body is in plane strain",
                                   at_position(x)),
                       "no traction along " + name);
    const Vec3 beside =
        load.traction_at(x + body.cut_cells.grid.cell_size * Vec3::Unit(axis), body.normal(p), resultant);
    if ((beside - traction).norm() > along_axis * std::max(beside.norm(), traction.norm()))
      throw InputError(load.location, name_of_face(scene, load.face),
                       fmt::format("varies with {}, {}", name, at_position(x)),
                       fmt::format("a load that is the same for all {} ({})", name,
                                   body.spec->axisymmetric() ? "the half-plane is that of " + name + " = 0"
                                                             : "the body is in plane strain across it"));
  }
}

/// Weight acts along the axis of revolution, and the body rotates about it.
void check_inertia_of_revolution(const BodySpec& body) {
  const int along = body.axis_of_revolution();
  const Vec3 axis = Vec3::Unit(along);
  const Inertia& inertia = body.inertia;
  const std::string& name = coordinate_names()[along];
  if ((inertia.weight - inertia.weight.dot(axis) * axis).norm() > along_axis * inertia.weight.norm())
    refuse(body, "gravity acts across its axis of revolution", "gravity along " + name);
  if (inertia.spin != 0 && (inertia.axis.cross(axis).norm() > flat_end_tolerance ||
                            inertia.centre.cross(axis).norm() > sticking_out * body.unit_radius))
    refuse(body, "it rotates about another axis than that of revolution", "rotation about " + name);
}

void check_body_force(const BodyModel& body) {
  if (!body.boundary.body_force_at) return;
  const bool axisymmetric = body.spec->axisymmetric();
  if (axisymmetric) check_inertia_of_revolution(*body.spec);
  const int axis = axis_of(*body.spec);
  // Quadtrees have the plane in the middle only, where such a rotation has no force along the axis.
  if (const Inertia& inertia = body.spec->inertia;
      !axisymmetric && inertia.spin != 0 && std::abs(inertia.axis[axis]) < 1 - flat_end_tolerance)
    refuse(*body.spec, "it rotates about another axis than that of plane strain",
           "rotation about an axis along " + name_of(*body.spec->plane_strain));
  for (int cell = 0; cell < static_cast<int>(body.cut_cells.cells.size()); ++cell) {
    const Vec3 x = global_position(body.cut_cells, cell, Vec3::Zero()), force = body.boundary.body_force_at(x);
    if (std::abs(force[axis]) > along_axis * force.norm())
      refuse(*body.spec,
             fmt::format("the force on its volume acts {}, {}",
                         axisymmetric ? "around its axis of revolution" : "along the axis of plane strain",
                         at_position(x)),
             axisymmetric ? "none around it" : "no body force along it");
  }
}

}  // namespace

void check_thickness(const BodySpec& body, double thickness) {
  const double offset = body.grid_offset[axis_of(body)], cells = thickness / body.cell_size;
  if (cells >= thinnest && cells + offset <= 1 + sticking_out) return;
  refuse(
      body,
      fmt::format("it is {:.6g} m thick along the axis of plane strain, {:.3g} of its cells, which begin {:.3g} cells "
                  "before it: it must lie in one layer of cells and fill half of it",
                  thickness, cells, offset),
      fmt::format("a thickness of {:.6g} to {:.6g} m", thinnest * body.cell_size, (1 - offset) * body.cell_size));
}

void check_slices(const Scene& scene) {
  const auto quadtree =
      std::find_if(scene.bodies.begin(), scene.bodies.end(), [](const BodySpec& body) { return body.quadtree; });
  if (quadtree == scene.bodies.end()) return;
  const auto [low, high] = ends_of(*quadtree);
  const std::string& axis = name_of(*quadtree->plane_strain);
  for (const BodySpec& body : scene.bodies) {
    if (!body.plane_strain)
      throw InputError(quadtree->plane_strain_location, '"' + axis + '"',
                       "body \"" + body.name + "\" is not in plane strain, and cells are refined",
                       "plane_strain for all bodies of a scene with refine or [accuracy]");
    const auto [own_low, own_high] = ends_of(body);
    if (std::abs(own_low - low) + std::abs(own_high - high) > same_ends * (high - low))
      refuse(body,
             fmt::format("it lies between {:.6g} and {:.6g} m, body \"{}\" between {:.6g} and {:.6g} m", own_low,
                         own_high, quadtree->name, low, high),
             "the same ends for all bodies of a scene with refine or [accuracy]");
    stretched_to(body, body.solid, low, high);  // refuses what is no prism
  }
}

Solid stretched_to(const BodySpec& body, const Solid& solid, double low, double high) {
  Vec3 min, max;
  solid.bounding_box(min, max);
  const int axis = axis_of(body);
  const double factor = (high - low) / (max - min)[axis];
  try {
    return solid.stretched(axis, factor, low - factor * min[axis]);
  } catch (const InputError& error) {
    refuse(body, error.what(), "a prism between two planes across the axis, of primitives or triangles");
  }
}

void check_extruded(const BodySpec& body, const CutCells& cells) {
  const int axis = axis_of(body);
  const BoundaryPoints& boundary = cells.boundary;
  double low = 1e300, high = -1e300;  // the ends, grid coordinates
  for (std::size_t p = 0; p < boundary.size(); ++p) {
    if (std::abs(boundary.normal[p][axis]) <= 0.5) continue;
    low = std::min(low, boundary.position[p][axis]);
    high = std::max(high, boundary.position[p][axis]);
  }
  for (std::size_t p = 0; p < boundary.size(); ++p) {
    const double normal = boundary.normal[p][axis], position = boundary.position[p][axis];
    const bool side = std::abs(normal)<flat_end_tolerance, end = std::abs(normal)> 1 - flat_end_tolerance;
    if (side || (end && std::abs(position - (normal < 0 ? low : high)) < flat_end_tolerance)) continue;
    refuse(body,
           "its boundary is neither an end nor along the axis of plane strain, " +
               at_position(cells.grid.to_global(boundary.position[p])),
           "a prism between two planes across the axis");
  }
  for (const Index3& cell : cells.cells)
    if (cell[axis] != cells.cells.front()[axis])
      refuse(body, "it lies in more than one layer of cells across the axis of plane strain",
             "a little less thickness, or another grid.offset");
}

void check_plane_strain(const Scene& scene, const std::vector<BodyModel>& bodies,
                        const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs) {
  check_supports(scene, bodies, supports);
  for (int l = 0; l < static_cast<int>(scene.loads.size()); ++l)
    if (const int b = scene.loads[l].face.body; scene.bodies[b].plane_strain) check_load(scene, l, bodies[b]);
  for (const BodyModel& body : bodies)
    if (body.spec->plane_strain) check_body_force(body);
  for (const ContactPair& pair : pairs)
    for (const int b : {pair.primary, pair.secondary}) {
      const BodySpec& body = scene.bodies[b];
      if (!body.plane_strain) continue;
      for (const ContactPoint& point : pair.points)
        if (std::abs(point.normal[axis_of(body)]) > 0.5)
          throw InputError(pair.spec->location, '"' + pair.spec->name + '"',
                           fmt::format("presses body \"{}\" along {}, across which it is in plane strain, {}",
                                       body.name, name_of(*body.plane_strain), at_position(point.x)),
                           "contact of the sides only");
    }
}

}  // namespace cgcontact
