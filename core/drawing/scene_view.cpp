#include "core/drawing/scene_view.hpp"

#include <algorithm>
#include <cmath>

#include "core/drawing/cut_open.hpp"

namespace cgcontact {

namespace {

/// The contact is inside the scene, and the scene cut open, if it is this far (fraction of the extent) from its sides.
constexpr double inside_fraction = 0.15;
/// Fraction of the scene's extent: a zone this near to a side of the scene reaches it.
constexpr double beside = 0.05;
/// Side of what is shown around a zone over the zone's, as the page's view has it.
constexpr double zone_view = 2.2;

SceneBox bounds(const std::vector<DrawnBody>& bodies) {
  SceneBox box;
  for (const DrawnBody& body : bodies)
    for (const Vec3& x : body.position) box.add(x);
  return box;
}

/// Returns the axis across which bodies are one layer of cells on every level; -1: there are others.
int axis_of_quadtrees(const Results& results) {
  int axis = -1;
  for (const BodyFields& body : results.bodies) {
    const Grid& grid = body.cut_cells->grid;
    if (!grid.is_quadtree()) return -1;
    grid.rotation.col(grid.plane_strain).cwiseAbs().maxCoeff(&axis);
  }
  return axis;
}

int find_thin_axis(const Results& results, const SceneBox& box) {
  if (const int axis = axis_of_quadtrees(results); axis >= 0) return axis;
  double cell = std::numeric_limits<double>::max();
  for (const BodyFields& body : results.bodies) cell = std::min(cell, body.cut_cells->grid.cell_size);
  const Vec3 extent = box.extent();
  int axis = 0;
  extent.minCoeff(&axis);
  const double others = std::min(extent[(axis + 1) % 3], extent[(axis + 2) % 3]);
  return extent[axis] < 2.01 * cell && extent[axis] < 0.34 * others ? axis : -1;
}

/// Stress-weighted area that faces the viewer.
double visible_stress(const std::vector<DrawnBody>& bodies, const Vec3& eye) {
  double sum = 0;
  for (const DrawnBody& body : bodies) {
    if (body.stress.empty()) continue;
    for (const BoundaryTriangle& triangle : body.mesh.boundary) {
      const auto& t = triangle.points;
      const Vec3& a = body.position[t[0]];
      const double area = (body.position[t[1]] - a).cross(body.position[t[2]] - a).dot(eye);
      if (area > 0) sum += area * von_mises(body.stress[t[0]]);
    }
  }
  return sum;
}

void look_along_axis(int axis, Camera& camera) {
  camera.right = axis == 0 ? Vec3::UnitY() : Vec3::UnitX();
  camera.up = axis == 2 ? Vec3::UnitY() : Vec3::UnitZ();
  camera.eye = camera.right.cross(camera.up);
}

/// `eye`: to the viewer, of length 1.
void look_from(const Vec3& eye, Camera& camera) {
  camera.eye = eye;
  camera.right = Vec3::UnitZ().cross(eye).normalized();
  camera.up = eye.cross(camera.right);
}

/// From above, from the corner that shows the most stress.
void look_from_corner(const std::vector<DrawnBody>& bodies, Camera& camera) {
  double best = -1;
  Vec3 eye = Vec3::UnitZ();
  for (double x : {1.0, -1.0})
    for (double y : {-1.0, 1.0}) {
      const Vec3 candidate = Vec3(0.55 * x, 0.75 * y, 0.42).normalized();
      const double stress = visible_stress(bodies, candidate);
      if (stress <= best * (1 + 1e-6)) continue;
      best = stress;
      eye = candidate;
    }
  look_from(eye, camera);
}

/// Centre and main direction of the closed contact, if it lies inside the scene.
struct ContactCentre {
  Vec3 centre;
  int axis;  ///< coordinate axis nearest to the normal
};

std::optional<ContactCentre> contact_inside(const Results& results, const SceneBox& box) {
  Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();
  double area = 0;
  for (const ContactRow& row : results.contact_rows) {
    if (!row.active) continue;
    centre += row.weight * row.x;
    normal += row.weight * row.normal.cwiseAbs();
    area += row.weight;
  }
  if (!(area > 0)) return std::nullopt;
  ContactCentre contact{centre / area, 0};
  normal.maxCoeff(&contact.axis);
  for (int k = 0; k < 3; ++k) {
    if (k == contact.axis) continue;
    const double fraction = (contact.centre[k] - box.low[k]) / box.extent()[k];
    if (fraction < inside_fraction || fraction > 1 - inside_fraction) return std::nullopt;
  }
  return contact;
}

/// Sides of the scene that a zone reaches, a plane of symmetry mostly: the contact is seen there. -1 and 1: the lower
/// and the upper end of an axis, 0: neither or both.
struct ReachedSides {
  bool any = false;
  std::array<int, 3> side{0, 0, 0};
};

ReachedSides sides_reached(const SceneBox& scene, const ContactZoneBox& zone) {
  ReachedSides reached;
  for (int k = 0; k < 3; ++k) {
    if (k == zone.axis) continue;
    const double near = beside * zone.box.extent()[k];
    const bool low = zone.box.low[k] - scene.low[k] <= near, high = scene.high[k] - zone.box.high[k] <= near;
    reached.any |= low || high;
    if (low != high) reached.side[k] = low ? -1 : 1;
  }
  return reached;
}

/// Turns a direction to the viewer to where the contact is seen.
Vec3 towards(const ReachedSides& reached, Vec3 eye) {
  for (int k = 0; k < 3; ++k)
    if (reached.side[k] != 0) eye[k] = reached.side[k] * std::abs(eye[k]);
  return eye;
}

/// The pair with the largest force that is pressed; -1: none.
int most_pressed(const Results& results) {
  int most = -1;
  for (int p = 0; p < static_cast<int>(results.pairs.size()); ++p)
    if (results.pairs[p].max_pressure > 0 &&
        (most < 0 || told_force(results.pairs[p]) > told_force(results.pairs[most])))
      most = p;
  return most;
}

/// Quarter towards the viewer around the contact.
SceneCut cut_towards(const ContactCentre& contact, const Vec3& eye) {
  SceneCut cut;
  cut.corner = contact.centre;
  for (int i = 0; i < 2; ++i) {
    const int k = (contact.axis + 1 + i) % 3;
    cut.directions[i] = Vec3::Unit(k) * (eye[k] < 0 ? -1.0 : 1.0);
  }
  return cut;
}

}  // namespace

SceneView direction_to_scene(const Results& results, const std::vector<DrawnBody>& bodies) {
  SceneView view;
  view.box = bounds(bodies);
  view.thin_axis = find_thin_axis(results, view.box);
  if (view.thin_axis >= 0) {
    look_along_axis(view.thin_axis, view.camera);
  } else {
    look_from_corner(bodies, view.camera);
    const int most = most_pressed(results);
    const auto zone = most < 0 ? std::nullopt : zone_of_pair(results, most);
    const ReachedSides reached = zone ? sides_reached(view.box, *zone) : ReachedSides();
    if (reached.side != std::array<int, 3>{0, 0, 0}) {  // a plane of symmetry opens them already
      look_from(towards(reached, view.camera.eye), view.camera);
    } else if (const auto contact = contact_inside(results, view.box)) {
      view.cut = cut_towards(*contact, view.camera.eye);
      view.opened = true;
    }
  }
  return view;
}

SceneView look_at_scene(const Results& results, const std::vector<DrawnBody>& bodies) {
  const bool complete =
      std::all_of(bodies.begin(), bodies.end(), [](const DrawnBody& body) { return !body.stress.empty(); });
  if (bodies.empty() || !complete) return {};
  SceneView view = direction_to_scene(results, bodies);
  view.shown = shown_in(view, bodies);
  return view;
}

std::vector<DrawnBody> shown_in(const SceneView& view, const std::vector<DrawnBody>& bodies) {
  std::vector<DrawnBody> shown;
  for (const DrawnBody& body : bodies)
    shown.push_back(view.opened ? cut_open(body, view.cut.corner, view.cut.directions) : boundary_of(body));
  return shown;
}

std::optional<ZoneLook> look_at_main_zone(const Results& results, const std::vector<DrawnBody>& bodies,
                                          const SceneView& scene) {
  const int pair = most_pressed(results);
  const std::optional<ContactZoneBox> zone = pair < 0 ? std::nullopt : zone_of_pair(results, pair);
  if (!zone || scene.shown.empty()) return std::nullopt;
  return ZoneLook{pair, zone->box, look_at_zone(bodies, scene, *zone)};
}

std::vector<Vec3> corners_around(const SceneBox& zone) {
  std::vector<Vec3> corners;
  const Vec3 middle = (zone.low + zone.high) / 2, half = zone_view * zone.extent() / 2;
  for (int c = 0; c < 8; ++c)
    corners.push_back(middle + half.cwiseProduct(Vec3(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1)));
  return corners;
}

std::optional<ContactZoneBox> zone_of_pair(const Results& results, int pair) {
  const double most = results.pairs[pair].max_pressure;
  if (!(most > 0)) return std::nullopt;
  ContactZoneBox zone;
  Vec3 normal = Vec3::Zero();
  for (const ContactRow& row : results.contact_rows) {
    if (row.pair != pair || !(row.pressure_sprc > zone_end * most)) continue;
    zone.box.add(row.x);
    normal += row.weight * row.normal.cwiseAbs();
    if (results.bodies[row.body].name == results.pairs[pair].body_first) zone.normal += row.weight * row.normal;
  }
  if (!(zone.box.extent().maxCoeff() > 0)) return std::nullopt;
  normal.maxCoeff(&zone.axis);
  return zone;
}

SceneView look_at_zone(const std::vector<DrawnBody>& bodies, const SceneView& scene, const ContactZoneBox& zone) {
  if (scene.thin_axis >= 0) return scene;
  SceneView view;  // no copy of what the scene shows, which is large
  view.box = scene.box;
  view.camera = scene.camera;
  const ReachedSides reached = sides_reached(scene.box, zone);
  const Vec3 eye = towards(reached, scene.camera.eye);
  look_from(eye, view.camera);
  view.opened = !reached.any;
  view.cut = cut_towards({(zone.box.low + zone.box.high) / 2, zone.axis}, eye);
  view.shown = shown_in(view, bodies);
  return view;
}

}  // namespace cgcontact
