#include "contact/contact_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"

namespace cgcontact {
namespace {

/// Order of the rule on contact pieces: exact for the trilinear shape functions of either body on a plane.
constexpr int contact_order = 2;
/// Boundary points per chunk of the parallel loops.
constexpr std::size_t grain = 512;
/// Cells, from a surface into the body: less than the thinnest cells that are kept, more than rounding of positions.
constexpr double inward_step = 1e-12;

/// Planes of the other grid that cross a cell, in the cell's grid coordinates.
std::vector<Plane> other_grid_planes(const Grid& grid, const Index3& cell, const Grid& other) {
  const Mat3 to_other = other.rotation.transpose() * grid.rotation * (grid.cell_size / other.cell_size);
  const Vec3 shift = other.to_grid(grid.origin);
  std::vector<Plane> planes;
  for (int d = 0; d < 3; ++d) {
    double low = 1e300, high = -1e300;
    for (int a = 0; a < 8; ++a) {
      const Vec3 corner(cell[0] + (a & 1), cell[1] + (a >> 1 & 1), cell[2] + (a >> 2));
      const double value = to_other.row(d).dot(corner) + shift[d];
      low = std::min(low, value);
      high = std::max(high, value);
    }
    const double norm = to_other.row(d).norm();
    const int first = static_cast<int>(std::ceil(std::max(low + 1e-9, 0.0)));
    const int last = static_cast<int>(std::floor(std::min(high - 1e-9, 1.0 * other.num_cells[d])));
    for (int k = first; k <= last; ++k) planes.push_back({to_other.row(d).transpose() / norm, (k - shift[d]) / norm});
  }
  return planes;
}

/// Active cells of the primary body and the surfaces of the face in them, ascending.
std::vector<std::pair<int, int>> cells_with_face(const BodyModel& body, const FaceSpec& face) {
  std::vector<std::pair<int, int>> cells;
  const BoundaryPoints& boundary = body.cut_cells.boundary;
  const BodyFace points_of_face(face, body);
  for (int p = 0; p < static_cast<int>(boundary.size()); ++p)
    if (points_of_face.contains(p)) cells.emplace_back(boundary.cell[p], boundary.surface[p]);
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

/// One group: its points and their sums.
struct GroupPoints {
  int surface = 0;
  std::vector<ContactPoint> points;
  double area = 0, initial_gap = 0;
};

/// Points of one cell and surface that have an opposite.
GroupPoints find_group(const std::vector<BodyModel>& bodies, const ContactPair& pair, int cell, int surface) {
  const BodyModel &primary = bodies[pair.primary], &secondary = bodies[pair.secondary];
  const Grid& grid = primary.cut_cells.grid;
  BoundaryPoints points;
  boundary_points_of_cell(primary.cut_cells, cell, {surface},
                          other_grid_planes(grid, primary.cut_cells.cells[cell], secondary.cut_cells.grid),
                          contact_order, points);
  GroupPoints group;
  group.surface = surface;
  const auto& names = primary.cut_cells.solid.surfaces()[surface].names;
  for (std::size_t q = 0; q < points.size(); ++q) {
    ContactPoint point;
    point.x = grid.to_global(points.position[q]);
    point.normal = grid.rotation * points.normal[q];
    if (!pair.face(pair.primary).contains(names, point.x, point.normal)) continue;
    const auto opposite = find_opposite(secondary, pair.face(pair.secondary), point.x, point.normal, pair.search);
    if (!opposite) continue;
    point.primary_cell = cell;
    point.primary_position = points.position[q];
    point.primary_xi = cell_coordinates(primary.cut_cells, cell, points.position[q]);
    point.secondary_cell = opposite->cell;
    point.secondary_position = opposite->position;
    point.secondary_xi = cell_coordinates(secondary.cut_cells, opposite->cell, opposite->position);
    point.weight = points.weight[q] * grid.cell_size * grid.cell_size;
    // Coincident faces: a distance of rounding is none.
    point.distance = std::abs(opposite->distance) > 1e-12 * grid.cell_size ? opposite->distance : 0.0;
    group.area += point.weight;
    group.initial_gap += point.weight * (point.distance - pair.spec->interference);
    group.points.push_back(point);
  }
  if (group.area > 0) group.initial_gap /= group.area;
  return group;
}

/// Appends the points of a group that has any area.
void add_group(const GroupPoints& found, ContactPair& pair) {
  if (!(found.area > 0)) return;
  ContactGroup group;
  group.first_point = static_cast<int>(pair.points.size());
  group.surface = found.surface;
  group.area = found.area;
  group.initial_gap = found.initial_gap;
  for (ContactPoint point : found.points) {
    point.group = static_cast<int>(pair.groups.size());
    pair.points.push_back(point);
  }
  group.last_point = static_cast<int>(pair.points.size());
  pair.groups.push_back(group);
}

/// Marks the default boundary points of one side that face the other body.
void mark_boundary_points(const ContactPair& pair, int index, int body, int other, std::vector<BodyModel>& bodies) {
  BodyModel& model = bodies[body];
  const BodyFace face(pair.face(body), model);
  parallel_for(model.cut_cells.boundary.size(), grain, [&](std::size_t point) {
    const int p = static_cast<int>(point);
    if (model.boundary.pair_of_point[p] >= 0 || !face.contains(p)) return;
    if (find_opposite(bodies[other], pair.face(other), model.point(p), model.normal(p), pair.search))
      model.boundary.pair_of_point[p] = index;
  });
}

ContactPair make_pair(const Scene& scene, const ContactSpec& spec, const std::vector<BodyModel>& bodies) {
  ContactPair pair;
  pair.spec = &spec;
  const auto h = [&](int b) { return bodies[b].cut_cells.grid.cell_size; };
  const int a = spec.first.body, b = spec.second.body;
  pair.primary = h(b) > h(a) ? b : a;
  pair.secondary = pair.primary == a ? b : a;
  const double E1 = scene.bodies[a].material.youngs_modulus, E2 = scene.bodies[b].material.youngs_modulus;
  pair.stiffness = scene.solver.kappa * 2 * E1 * E2 / (E1 + E2) / std::min(h(a), h(b));
  pair.search = spec.search_distance > 0 ? spec.search_distance : 2 * std::max(h(a), h(b));
  const std::vector<std::pair<int, int>> places = cells_with_face(bodies[pair.primary], pair.face(pair.primary));
  std::vector<GroupPoints> groups(places.size());
  parallel_for(places.size(), 8,
               [&](std::size_t i) { groups[i] = find_group(bodies, pair, places[i].first, places[i].second); });
  for (const GroupPoints& group : groups) add_group(group, pair);
  return pair;
}

/// Throws if a boundary point of one body lies inside another one, farther than half a cell from all its surfaces.
void check_overlap(const Scene& scene, const std::vector<BodyModel>& bodies) {
  for (std::size_t a = 0; a < bodies.size(); ++a)
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (a == b) continue;
      const CutCells& other = bodies[b].cut_cells;
      const double limit = 0.5 * std::min(bodies[a].cut_cells.grid.cell_size, other.grid.cell_size);
      parallel_for(bodies[a].cut_cells.boundary.size(), grain, [&](std::size_t p) {
        const Vec3 x = bodies[a].point(static_cast<int>(p)), g = other.grid.to_grid(x);
        if (!other.solid.contains(g)) return;
        const double depth = other.solid.distance_to_surfaces(g) * other.grid.cell_size;
        if (depth > limit)
          throw InputError(scene.bodies[a].place, "\"" + scene.bodies[a].name + "\"",
                           fmt::format("overlaps body \"{}\" by {:g} m or more at ({:g}, {:g}, {:g})",
                                       scene.bodies[b].name, depth, x[0], x[1], x[2]),
                           fmt::format("overlap up to half a cell, {:g} m", limit));
      });
    }
}

/// Entries of one row in the order of the DoFs, those of one DoF summed in the order in which they came.
GroupRow sum_by_dof(std::vector<std::pair<int, double>> entries) {
  std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  GroupRow row;
  for (const auto& [dof, value] : entries)
    if (!row.entries.empty() && row.entries.back().first == dof)
      row.entries.back().second += value;
    else
      row.entries.emplace_back(dof, value);
  row.entries.shrink_to_fit();
  return row;
}

}  // namespace

std::optional<OppositePoint> find_opposite(const BodyModel& other, const FaceSpec& face, const Vec3& x, const Vec3& n,
                                           double search) {
  const Grid& grid = other.cut_cells.grid;
  const Solid& solid = other.cut_cells.solid;
  const Vec3 origin = grid.to_grid(x), direction = grid.rotation.transpose() * n;
  static thread_local std::vector<Crossing> crossings;
  crossings.clear();
  solid.crossings(origin, direction, search / grid.cell_size, crossings);
  std::optional<OppositePoint> best;
  for (const Crossing& crossing : crossings) {
    if (best && std::abs(crossing.t) >= std::abs(best->distance)) continue;
    if (crossing.normal.dot(direction) > -0.1) continue;  // does not face this point
    const Vec3 y = origin + crossing.t * direction;
    if (!face.contains(solid.surfaces()[crossing.surface].names, grid.to_global(y), grid.rotation * crossing.normal))
      continue;
    // The cell on the inner side of the surface, also where the surface lies on a grid plane.
    const int cell = other.cut_cells.locate(y - inward_step * crossing.normal);
    if (cell >= 0) best = OppositePoint{crossing.t, cell, y};
  }
  if (best) best->distance *= grid.cell_size;
  return best;
}

std::vector<ContactPair> make_contact_pairs(const Scene& scene, std::vector<BodyModel>& bodies) {
  check_overlap(scene, bodies);
  std::vector<ContactPair> pairs;
  for (const ContactSpec& spec : scene.contacts) {
    ContactPair pair = make_pair(scene, spec, bodies);
    if (pair.points.empty()) {
      if (spec.automatic) continue;
      throw InputError(spec.place, "\"" + spec.name + "\"",
                       "no point of the first face has the second face within reach",
                       fmt::format("faces closer than search_distance = {:g} m along the normal", pair.search));
    }
    for (const ContactPoint& point : pair.points) {
      const double limit = 0.5 * std::min(bodies[pair.primary].cut_cells.grid.cell_size,
                                          bodies[pair.secondary].cut_cells.grid.cell_size);
      if (-point.distance > limit)
        throw InputError(spec.place, "\"" + spec.name + "\"",
                         fmt::format("the bodies overlap by {:g} m at ({:g}, {:g}, {:g})", -point.distance, point.x[0],
                                     point.x[1], point.x[2]),
                         fmt::format("overlap up to half a cell, {:g} m", limit));
    }
    const int index = static_cast<int>(pairs.size());
    mark_boundary_points(pair, index, pair.primary, pair.secondary, bodies);
    mark_boundary_points(pair, index, pair.secondary, pair.primary, bodies);
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

Subset nodes_near_contact(const std::vector<ContactPair>& pairs, const std::vector<BodyModel>& bodies, int body,
                          const BodyMesh& mesh) {
  constexpr int reach = 3, width = 2 * reach + 1;
  const BodyModel& model = bodies[body];
  const CutCells& cc = model.cut_cells;
  std::vector<char> marked(mesh.num_nodes, 0);
  std::vector<BodyFace> faces;
  for (const ContactPair& pair : pairs)
    if (pair.primary == body || pair.secondary == body) faces.emplace_back(pair.face(body), model);
  int last = -1;
  for (int p = 0; p < static_cast<int>(cc.boundary.size()); ++p) {
    const int cell = cc.boundary.cell[p];
    if (cell == last) continue;
    const bool on_face =
        std::any_of(faces.begin(), faces.end(), [&](const BodyFace& face) { return face.contains(p); });
    if (!on_face) continue;
    last = cell;
    const Index3& c = cc.cells[cell];
    for (int n = 0; n < width * width * width; ++n) {
      const int near =
          cc.find({c[0] + n % width - reach, c[1] + n / width % width - reach, c[2] + n / width / width - reach});
      if (near < 0) continue;
      for (int node : mesh.cell_nodes[near]) marked[node - mesh.first_node] = 1;
    }
  }
  return Subset(marked);
}

std::vector<GroupRow> make_group_rows(const std::vector<ContactPair>& pairs, const std::vector<BodyModel>& bodies,
                                      const ElasticSystem& system) {
  std::size_t max_surfaces = 0;  // a family is a surface of a pair
  for (const BodyModel& body : bodies) max_surfaces = std::max(max_surfaces, body.cut_cells.solid.surfaces().size());
  std::vector<GroupRow> rows;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const ContactPair& pair = pairs[k];
    for (const ContactGroup& group : pair.groups) {
      std::vector<std::pair<int, double>> entries;
      const auto add = [&](int body, int cell, const Vec3& xi, const Vec3& direction) {
        const Vec3 local = bodies[body].cut_cells.grid.rotation.transpose() * direction;
        double N[8];
        hex_shape(xi.data(), N);
        for (int a = 0; a < 8; ++a)
          for (int i = 0; i < 3; ++i)
            if (local[i] != 0) entries.emplace_back(3 * system.meshes[body].cell_nodes[cell][a] + i, N[a] * local[i]);
      };
      for (int q = group.first_point; q < group.last_point; ++q) {
        const ContactPoint& point = pair.points[q];
        const Vec3 direction = point.weight / group.area * point.normal;
        add(pair.primary, point.primary_cell, point.primary_xi, -direction);
        add(pair.secondary, point.secondary_cell, point.secondary_xi, direction);
      }
      const ContactPoint& first = pair.points[group.first_point];
      GroupRow row = sum_by_dof(std::move(entries));
      row.body = pair.primary;
      row.cell = first.primary_cell;
      row.family = static_cast<int>(k * max_surfaces + group.surface);
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

void update_contact_links(const std::vector<ContactPair>& pairs, std::vector<BodyModel>& bodies,
                          const std::vector<double>& group_force) {
  std::size_t first_group = 0;
  for (BodyModel& body : bodies) body.boundary.links.clear();
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const ContactPair& pair = pairs[p];
    BodyModel &primary = bodies[pair.primary], &secondary = bodies[pair.secondary];
    const Mat3 to_primary = primary.cut_cells.grid.rotation.transpose();
    const Mat3 to_secondary = secondary.cut_cells.grid.rotation.transpose();
    std::vector<double> closed_area(pair.groups.size(), 0.0);
    for (const ContactPoint& q : pair.points)
      if (q.active) closed_area[q.group] += q.weight;
    for (const ContactPoint& q : pair.points) {
      const int index = static_cast<int>(p);
      const double pressure =
          q.active && !group_force.empty() ? group_force[first_group + q.group] / closed_area[q.group] : 0.0;
      primary.boundary.links.push_back({q.primary_cell, index, q.primary_position, to_primary * q.normal, q.weight,
                                        pair.secondary, q.secondary_cell, q.secondary_position, q.distance, q.active,
                                        pressure});
      secondary.boundary.links.push_back({q.secondary_cell, index, q.secondary_position, -(to_secondary * q.normal),
                                          q.weight, pair.primary, q.primary_cell, q.primary_position, q.distance,
                                          q.active, pressure});
    }
    first_group += pair.groups.size();
  }
  for (BodyModel& body : bodies) {
    std::vector<int> cells;
    for (const ContactLink& link : body.boundary.links) cells.push_back(link.cell);
    body.boundary.links_of_cell = cells.empty() ? CellLists() : CellLists(body.cut_cells.cells.size(), cells);
  }
}

}  // namespace cgcontact
