#include "contact/model/contact_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "contact/model/opposite_borders.hpp"
#include "contact/model/press_direction.hpp"
#include "core/base/numbers/rounding.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/ranks.hpp"
#include "core/cells/cells_around.hpp"

namespace cgcontact {
namespace {

/// Relative difference of cell sizes that is rounding.
constexpr double equal_cells = 1e-12;
/// Rigid bodies touch if they are nearer to each other than that, cells.
constexpr double touching = 1e-3;
/// Most ends of the other body's faces in a cell at which the contact is divided; with more (threads, scans) it ends
/// within a quadrature point.
constexpr std::size_t max_ends = 24;

/// Level of the smallest cells of a grid that there may be in a box, grid coordinates.
int finest_level(const CutCells& cells, const Vec3& low, const Vec3& high) {
  int finest = 0;
  const std::function<void(int, const Index3&)> visit = [&](int level, const Index3& cell) {
    const double size = std::ldexp(1.0, -level);
    for (int d = 0; d < 3; ++d)
      if (size * cell[d] > high[d] || size * (cell[d] + 1) < low[d]) return;
    if (!cells.tree->is_refined(level, cell)) return;
    finest = std::max(finest, level + 1);
    for (int a = 0; a < 8; ++a)
      visit(level + 1, {2 * cell[0] + (a & 1), 2 * cell[1] + (a >> 1 & 1), 2 * cell[2] + (a >> 2)});
  };
  if (!cells.tree) return 0;
  Index3 begin, end;
  for (int d = 0; d < 3; ++d) {
    begin[d] = std::max(0, static_cast<int>(std::floor(low[d])));
    end[d] = std::min(cells.grid.num_cells[d], static_cast<int>(std::floor(high[d])) + 1);
  }
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j)
      for (int i = begin[0]; i < end[0]; ++i) visit(0, {i, j, k});
  return finest;
}

/// Returns planes of the other grid that cross a cell, in the cell's grid coordinates: those of the smallest cells
/// nearby, so that every facet sees one cell only.
std::vector<Plane> other_grid_planes(const CutCells& own, int cell, const CutCells& other_cells) {
  const Grid &grid = own.grid, &other = other_cells.grid;
  const Mat3 to_other = other.rotation.transpose() * grid.rotation * (grid.cell_size / other.cell_size);
  const Vec3 shift = other.to_grid(grid.origin), first_corner = own.corner(cell);
  const double size = own.size(cell);
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  for (int d = 0; d < 3; ++d)
    for (int a = 0; a < 8; ++a) {
      const Vec3 corner = first_corner + size * Vec3(a & 1, a >> 1 & 1, a >> 2);
      const double value = to_other.row(d).dot(corner) + shift[d];
      low[d] = std::min(low[d], value);
      high[d] = std::max(high[d], value);
    }
  // Opposite faces may be a little away.
  const Vec3 around = 0.5 * (high - low);
  const double halvings = std::ldexp(1.0, finest_level(other_cells, low - around, high + around));
  std::vector<Plane> planes;
  for (int d = 0; d < 3; ++d) {
    if (other.is_quadtree() && d == other.plane_strain) continue;  // there is one layer of cells
    const double norm = to_other.row(d).norm();
    const int first = static_cast<int>(std::ceil(std::max(low[d] * halvings + rounding, 0.0)));
    const int last =
        static_cast<int>(std::floor(std::min(high[d] * halvings - rounding, halvings * other.num_cells[d])));
    for (int k = first; k <= last; ++k)
      planes.push_back({to_other.row(d).transpose() / norm, (k / halvings - shift[d]) / norm});
  }
  return planes;
}

/// Returns whether a plane is one of the solid's own, up to rounding.
bool is_own_plane(const Solid& solid, const Plane& plane) {
  return std::any_of(solid.surfaces().begin(), solid.surfaces().end(), [&](const Surface& s) {
    if (s.kind != Surface::Kind::plane) return false;
    const double cosine = s.direction.dot(plane.normal);
    return std::abs(cosine) > 1 - rounding &&
           std::abs(std::copysign(1.0, cosine) * plane.offset - s.direction.dot(s.point)) < rounding;
  });
}

/// Planes of the other solid that cut a plane surface of this one within a cell, in the cell's grid coordinates: there
/// a plane face of the other body, and with it the contact, may end.
std::vector<Plane> other_face_borders(const BodyModel& body, int cell, int surface, const BodyModel& other) {
  const Surface& own = body.cut_cells.solid.surfaces()[surface];
  std::vector<Plane> planes;
  if (own.kind != Surface::Kind::plane) return planes;
  const Grid &grid = body.cut_cells.grid, &other_grid = other.cut_cells.grid;
  const double size = body.cut_cells.size(cell);
  const Vec3 centre = grid_position(body.cut_cells, cell, Vec3::Zero());
  for (const Surface& s : other.cut_cells.solid.surfaces()) {
    if (s.kind != Surface::Kind::plane) continue;
    if (other_grid.is_quadtree() && std::abs(s.direction[other_grid.plane_strain]) > 0.5) continue;  // it has no ends
    const Vec3 normal = grid.rotation.transpose() * (other_grid.rotation * s.direction);
    if (std::abs(normal.dot(own.direction)) > 0.9) continue;  // no border, or one that the ray meets elsewhere
    const double offset = normal.dot(grid.to_grid(other_grid.to_global(s.point)));
    const double middle = normal.dot(centre);
    if (std::abs(offset - middle) > 0.5 * size * normal.cwiseAbs().sum() - rounding) continue;
    if (!is_own_plane(body.cut_cells.solid, {normal, offset})) planes.push_back({normal, offset});
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

/// Points of one cell and surface of the primary body.
struct SurfacePoints {
  int surface = 0;
  std::vector<ContactPoint> points;
  FacingNormals normals;
};

/// Points of one cell and surface that have an opposite along `direction`, or along their normals if that is zero.
/// `borders`: of the opposite face, as seen from the surface.
SurfacePoints find_points(const std::vector<BodyModel>& bodies, const ContactPair& pair, int cell, int surface,
                          const std::vector<Plane>& borders, const Vec3& direction, int order) {
  const BodyModel &primary = bodies[pair.primary], &secondary = bodies[pair.secondary];
  const Grid& grid = primary.cut_cells.grid;
  std::vector<Plane> dividers = other_grid_planes(primary.cut_cells, cell, secondary.cut_cells);
  std::vector<Plane> ends = crossing_planes(borders, primary.cut_cells.corner(cell), primary.cut_cells.size(cell));
  for (const Plane& border : other_face_borders(primary, cell, surface, secondary)) ends.push_back(border);
  if (ends.size() <= max_ends) dividers.insert(dividers.end(), ends.begin(), ends.end());
  BoundaryPoints points;
  boundary_points_of_cell(primary.cut_cells, cell, {surface}, dividers, order, points);
  SurfacePoints found;
  found.surface = surface;
  const auto& names = primary.cut_cells.solid.surfaces()[surface].names;
  for (std::size_t q = 0; q < points.size(); ++q) {
    ContactPoint point;
    point.x = grid.to_global(points.position[q]);
    point.normal = grid.rotation * points.normal[q];
    if (!pair.face(pair.primary)
             .contains(names, grid.to_global(points.position_of_facet(q)), grid.rotation * points.normal_of_facet(q)))
      continue;
    double cosine = 1;
    if (!direction.isZero()) {
      cosine = point.normal.dot(direction);
      if (cosine < min_facing_cosine) continue;
      point.normal = direction;
    }
    const auto opposite = find_opposite(bodies, pair, pair.primary, point.x, point.normal);
    if (!opposite) continue;
    point.direction = point.normal;
    point.primary_cell = cell;
    point.primary_position = points.position[q];
    point.primary_xi = cell_coordinates(primary.cut_cells, cell, points.position[q]);
    point.secondary_cell = opposite->cell;
    point.secondary_position = opposite->position;
    point.secondary_xi = cell_coordinates(secondary.cut_cells, opposite->cell, opposite->position);
    point.weight = cosine * points.weight[q] * grid.cell_size * grid.cell_size;
    // Coincident faces: a distance of rounding is none.
    point.distance = std::abs(opposite->distance) > 1e-12 * primary.cut_cells.h(cell) ? opposite->distance : 0.0;
    found.normals.add(point.weight, point.x, point.normal, opposite->normal);
    found.points.push_back(point);
  }
  return found;
}

/// Appends a group that has any area, and its points to those of the pair.
void add_group(const std::vector<BodyModel>& bodies, ContactGroup group, const std::vector<const ContactPoint*>& points,
               ContactPair& pair, std::vector<ContactPoint>& points_of_pair) {
  group.first_point = static_cast<int>(points_of_pair.size());
  group.last_point = group.first_point + static_cast<int>(points.size());
  group.larger_cell = bodies[group.body].cut_cells.h(group.cell);
  group.h = 1e300;
  for (const ContactPoint* point : points) {
    group.area += point->weight;
    group.distance += point->weight * point->distance;
    group.h = std::min({group.h, bodies[pair.primary].cut_cells.h(point->primary_cell),
                        bodies[pair.secondary].cut_cells.h(point->secondary_cell)});
  }
  if (!(group.area > 0)) return;
  group.distance /= group.area;
  for (const ContactPoint* point : points) {
    points_of_pair.push_back(*point);
    points_of_pair.back().group = static_cast<int>(pair.groups.size());
  }
  pair.groups.push_back(group);
}

/// Adds the groups of all points: facets in the primary body's cells, or under a cell of the other body where
/// that is larger.
void add_groups(const std::vector<BodyModel>& bodies, const std::vector<SurfacePoints>& found, ContactPair& pair) {
  std::map<std::array<int, 3>, std::size_t> number;  // body, cell, surface
  std::vector<ContactGroup> groups;
  std::vector<std::vector<const ContactPoint*>> points;
  for (const SurfacePoints& on_surface : found)
    for (const ContactPoint& point : on_surface.points) {
      ContactGroup group;
      group.surface = on_surface.surface;
      group.body = pair.primary;
      group.cell = point.primary_cell;
      if (bodies[pair.secondary].cut_cells.h(point.secondary_cell) >
          (1 + equal_cells) * bodies[pair.primary].cut_cells.h(point.primary_cell)) {
        group.body = pair.secondary;
        group.cell = point.secondary_cell;
      }
      const auto [entry, is_new] = number.try_emplace({group.body, group.cell, group.surface}, groups.size());
      if (is_new) {
        groups.push_back(group);
        points.emplace_back();
      }
      points[entry->second].push_back(&point);
    }
  std::size_t num_points = 0;
  for (const auto& of_group : points) num_points += of_group.size();
  std::vector<ContactPoint> points_of_pair;
  points_of_pair.reserve(num_points);
  for (std::size_t g = 0; g < groups.size(); ++g) add_group(bodies, groups[g], points[g], pair, points_of_pair);
  pair.points = ContactPoints(points_of_pair);
}

/// Axis of plane strain that both bodies of a pair have, or -1: nothing moves along it.
int common_plane_strain(const std::vector<BodyModel>& bodies, const ContactPair& pair) {
  const auto &first = bodies[pair.primary].spec->plane_strain, &second = bodies[pair.secondary].spec->plane_strain;
  return first && second && *first == *second ? static_cast<int>(*first) : -1;
}

/// Bonded faces: the points and groups once for every axis along which one of the bodies moves.
void copy_for_all_axes(const std::vector<BodyModel>& bodies, ContactPair& pair) {
  const int fixed = common_plane_strain(bodies, pair);
  const std::vector<ContactGroup> groups = std::move(pair.groups);
  const std::size_t num_points = pair.points.size();
  std::vector<ContactPoint> points;
  pair.groups.clear();
  pair.copies = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == fixed) continue;
    const int first_point = static_cast<int>(pair.copies * num_points);
    const int first_group = static_cast<int>(pair.copies * groups.size());
    for (ContactPoint point : pair.points) {
      point.direction = Vec3::Unit(axis);
      point.group += first_group;
      points.push_back(point);
    }
    for (ContactGroup group : groups) {
      group.first_point += first_point;
      group.last_point += first_point;
      pair.groups.push_back(group);
    }
    ++pair.copies;
  }
  pair.points = ContactPoints(points);
}

/// Gives groups of a pair with friction the axis that their tangents come from: the one across plane strain, else the
/// one that is least along the normals.
void set_tangents(const std::vector<BodyModel>& bodies, ContactPair& pair) {
  if (!(pair.friction() > 0)) return;
  const int across = common_plane_strain(bodies, pair);
  pair.num_tangents = across >= 0 ? 1 : 2;
  for (ContactGroup& group : pair.groups) {
    Vec3 along = Vec3::Zero();
    for (int q = group.first_point; q < group.last_point; ++q)
      along += pair.points.weight(q) * pair.points.normal(q).cwiseAbs2();
    Eigen::Index least;
    along.minCoeff(&least);
    group.tangent_axis = Vec3::Unit(across >= 0 ? across : static_cast<int>(least));
  }
}

/// Size of the largest cells of a body on a face, m; 0: it has none.
double largest_cell(const BodyModel& body, const FaceSpec& face) {
  double largest = 0;
  for (const auto& [cell, surface] : cells_with_face(body, face)) largest = std::max(largest, body.cut_cells.h(cell));
  return largest;
}

/// Marks the default boundary points of one side that face the other body, those nearer to another pair's excepted.
void mark_boundary_points(const ContactPair& pair, int index, int body, std::vector<BodyModel>& bodies,
                          std::vector<double>& nearest) {
  BodyModel& model = bodies[body];
  const BodyFace face(pair.face(body), model);
  parallel_for("cgcontact::contact_pairs::boundary_in_reach", model.cut_cells.boundary.size(), grain_of_medium,
               [&](std::size_t point) {
                 const int p = static_cast<int>(point);
                 if (!face.contains(p)) return;
                 const auto opposite = find_opposite(bodies, pair, body, model.point(p), model.normal(p));
                 if (!opposite || std::abs(opposite->distance) >= nearest[p]) return;
                 nearest[p] = std::abs(opposite->distance);
                 model.boundary.pair_of_point[p] = index;
               });
}

/// Least distance from the points of the primary face to the secondary one, m; 0 if they touch or overlap somewhere.
double closest_distance(const std::vector<BodyModel>& bodies, ContactPair pair) {
  const BodyModel &primary = bodies[pair.primary], &secondary = bodies[pair.secondary];
  pair.reach.ahead = box_distance(primary, secondary) + 2 * (longest_extent(primary) + longest_extent(secondary));
  const BodyFace face(pair.face(pair.primary), primary);
  const std::size_t size = primary.cut_cells.boundary.size();
  std::vector<double> least(num_chunks(size, grain_of_medium), 1e300);
  parallel_chunks("cgcontact::contact_pairs::closest_distance", size, grain_of_medium,
                  [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                    for (int p = static_cast<int>(begin); p < static_cast<int>(end); ++p) {
                      if (!face.contains(p)) continue;
                      const auto opposite =
                          find_opposite(bodies, pair, pair.primary, primary.point(p), primary.normal(p));
                      if (opposite) least[chunk] = std::min(least[chunk], opposite->distance);
                    }
                  });
  const double closest = least.empty() ? 1e300 : *std::min_element(least.begin(), least.end());
  return closest < 1e300 ? std::max(closest, 0.0) : 0.0;
}

double overlap_limit(const ContactOptions& options, const std::vector<BodyModel>& bodies, int a, int b) {
  return options.largest_overlap * std::min(longest_extent(bodies[a]), longest_extent(bodies[b]));
}

/// The scene's, or as far as the faces need: docs/scene.md.
Reach find_reach(const ContactOptions& options, const ContactPair& pair, const std::vector<BodyModel>& bodies,
                 double wider) {
  if (pair.spec->search_distance > 0) return {pair.spec->search_distance, pair.spec->search_distance};
  if (pair.bonded()) return {options.bond_reach * pair.largest_cell, options.bond_reach * pair.largest_cell};
  const BodyModel &primary = bodies[pair.primary], &secondary = bodies[pair.secondary];
  const double base = std::max(options.reach_in_cells * pair.largest_cell,
                               options.reach_in_extents * std::min(longest_extent(primary), longest_extent(secondary)));
  Reach reach{std::max(base, wider), overlap_limit(options, bodies, pair.primary, pair.secondary)};
  if (!pair.spec->automatic) reach.ahead = std::max(wider, base + closest_distance(bodies, pair));
  return reach;
}

ContactPair make_pair(const Scene& scene, const ContactSpec& spec, const std::vector<BodyModel>& bodies, double wider) {
  ContactPair pair;
  pair.spec = &spec;
  const int a = spec.first.body, b = spec.second.body;
  const double of_a = largest_cell(bodies[a], spec.first.face), of_b = largest_cell(bodies[b], spec.second.face);
  // Equal cells: by name, so that the order of the bodies in the scene does not matter.
  const bool equal = std::abs(of_a - of_b) < equal_cells * of_a;
  pair.primary = (equal ? scene.bodies[b].name < scene.bodies[a].name : of_b > of_a) ? b : a;
  pair.secondary = pair.primary == a ? b : a;
  pair.largest_cell = pair.primary == a ? of_a : of_b;
  const double E1 = stabilising_modulus(scene.bodies[a].material), E2 = stabilising_modulus(scene.bodies[b].material);
  pair.modulus = scene.solver.kappa * (std::isinf(E1) ? 2 * E2 : std::isinf(E2) ? 2 * E1 : 2 * E1 * E2 / (E1 + E2));
  pair.reach = find_reach(scene.contact, pair, bodies, wider);
  if (box_distance(bodies[a], bodies[b]) > pair.reach.ahead) return pair;
  const std::vector<std::pair<int, int>> face_cells = cells_with_face(bodies[pair.primary], pair.face(pair.primary));
  std::vector<SurfacePoints> found(face_cells.size());
  const CutCells &own = bodies[pair.primary].cut_cells, &other = bodies[pair.secondary].cut_cells;
  const FaceSpec& opposite = pair.face(pair.secondary);
  const std::vector<Plane> dividers = box_dividers(other, opposite);
  std::map<int, std::vector<Plane>> borders;  // by surface
  for (const auto& face_cell : face_cells) borders.try_emplace(face_cell.second);
  for (auto& [surface, planes] : borders) planes = opposite_borders(own, surface, other, opposite, dividers);
  const auto find = [&](std::size_t i, const Vec3& direction) {
    const auto [cell, surface] = face_cells[i];
    found[i] = find_points(bodies, pair, cell, surface, borders.at(surface), direction, scene.contact.quadrature_order);
  };
  parallel_for("cgcontact::contact_pairs::groups", face_cells.size(), 8, [&](std::size_t i) { find(i, Vec3::Zero()); });
  if (pair.bonded()) {  // whatever the way in which edges would press
    add_groups(bodies, found, pair);
    copy_for_all_axes(bodies, pair);
    set_interference(pair, 0);
    return pair;
  }
  std::vector<CellIndex> cells;
  std::vector<int> surfaces;
  std::vector<FacingNormals> normals;
  for (std::size_t i = 0; i < face_cells.size(); ++i) {
    cells.push_back(cell_index(own, face_cells[i].first));
    surfaces.push_back(face_cells[i].second);
    normals.push_back(found[i].normals);
  }
  const std::vector<Vec3> directions = press_directions(own.num_levels(), cells, surfaces, normals);
  parallel_for("cgcontact::contact_pairs::edges", face_cells.size(), 8, [&](std::size_t i) {
    if (!directions[i].isZero()) find(i, directions[i]);
  });
  add_groups(bodies, found, pair);
  set_tangents(bodies, pair);
  set_interference(pair, spec.interference);
  return pair;
}

/// Throws if a boundary point of one body lies inside another one, deeper than where their contact faces overlap.
void check_overlap(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<ContactPair>& pairs) {
  Eigen::MatrixXd overlap = Eigen::MatrixXd::Zero(bodies.size(), bodies.size());
  for (const ContactPair& pair : pairs)
    for (const ContactPoint& q : pair.points)
      for (const auto& [a, b] : {std::pair(pair.primary, pair.secondary), std::pair(pair.secondary, pair.primary)})
        overlap(a, b) = std::max(overlap(a, b), -q.distance);
  for (int a = 0; a < static_cast<int>(bodies.size()); ++a)
    for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
      if (a == b || box_distance(bodies[a], bodies[b]) > 0) continue;
      const CutCells& other = bodies[b].cut_cells;
      const CutCells& own = bodies[a].cut_cells;
      const auto check = [&](std::size_t p) {
        const Vec3 x = bodies[a].point(static_cast<int>(p)), g = other.grid.to_grid(x);
        if (!other.solid.contains(g)) return;
        const int cell = other.locate(g);
        const double h = own.h(own.boundary.cell[p]), smaller = cell < 0 ? h : std::min(h, other.h(cell));
        const double limit = overlap(a, b) + 0.5 * smaller;
        const double depth = other.solid.distance_to_surfaces(g) * other.grid.cell_size;
        if (depth > limit)
          throw InputError(
              scene.bodies[a].location, "\"" + scene.bodies[a].name + "\"",
              fmt::format("overlaps body \"{}\" by {:g} m or more at ({:g}, {:g}, {:g})", scene.bodies[b].name, depth,
                          x[0], x[1], x[2]),
              fmt::format("contact faces that overlap by up to {:g} m, a tenth of the smaller body, and by "
                          "less than the bodies' walls",
                          overlap_limit(scene.contact, bodies, a, b)));
      };
      const auto [begin, end] = share_out(own.boundary.size());
      on_all_ranks([&, first = begin, count = end - begin] {
        parallel_for("cgcontact::contact_pairs::overlap", count, grain_of_medium,
                     [&](std::size_t p) { check(first + p); });
      });
    }
}

}  // namespace

Vec3 centre_of(const ContactPair& pair, const ContactGroup& group) {
  Vec3 sum = Vec3::Zero();
  for (int q = group.first_point; q < group.last_point; ++q) sum += pair.points.weight(q) * pair.points.x(q);
  return sum / group.area;
}

double nearest_distance(const ContactPair& pair, const ContactGroup& group) {
  double nearest = pair.points.distance(group.first_point);
  for (int q = group.first_point; q < group.last_point; ++q) nearest = std::min(nearest, pair.points.distance(q));
  return nearest;
}

bool is_closed(const ContactPair& pair, const ContactGroup& group) {
  for (int q = group.first_point; q < group.last_point; ++q)
    if (pair.points.active(q)) return true;
  return false;
}

std::array<Vec3, 2> ContactPair::tangents(std::size_t point) const {
  const Vec3 n = points.normal(point), axis = groups[points.group(point)].tangent_axis;
  const Vec3 second = (axis - n * n.dot(axis)).normalized();
  return {second.cross(n), second};
}

std::optional<OppositePoint> find_opposite(const std::vector<BodyModel>& bodies, const ContactPair& pair, int body,
                                           const Vec3& x, const Vec3& n) {
  const int other = pair.other(body);
  auto opposite = find_opposite(bodies[body], bodies[other], pair.face(other), x, n, pair.reach);
  if (!opposite || !pair.spec->automatic) return opposite;
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b)
    if (b != body && b != other && comes_between(bodies[b], x, n, opposite->distance)) return std::nullopt;
  return opposite;
}

namespace {

/// Automatic pairs of rigid bodies are left out where these are apart.
void leave_out_rigid_pairs(const Scene& scene, std::vector<ContactPair>& pairs) {
  const auto are_rigid = [&](const ContactPair& pair) {
    return scene.bodies[pair.primary].rigid() && scene.bodies[pair.secondary].rigid();
  };
  for (const ContactPair& pair : pairs) {
    if (!are_rigid(pair)) continue;
    for (const ContactPoint& q : pair.points)
      if (q.distance < touching * pair.largest_cell)
        throw InputError(pair.spec->location, "\"" + pair.spec->name + "\"",
                         fmt::format("both bodies are rigid and touch at ({:g}, {:g}, {:g}): the pressure between them "
                                     "is not determined",
                                     q.x[0], q.x[1], q.x[2]),
                         "rigid bodies that are apart, or one of them elastic");
  }
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), are_rigid), pairs.end());
}

}  // namespace

std::vector<ContactPair> make_contact_pairs(const Scene& scene, std::vector<BodyModel>& bodies,
                                            const std::vector<double>& wider) {
  std::vector<ContactPair> pairs;
  for (std::size_t k = 0; k < scene.contacts.size(); ++k)
    pairs.push_back(make_pair(scene, scene.contacts[k], bodies, wider.empty() ? 0.0 : wider[k]));
  leave_out_rigid_pairs(scene, pairs);
  check_overlap(scene, bodies, pairs);
  for (const ContactPair& pair : pairs)
    if (pair.points.empty() && pair.bonded())
      throw InputError(pair.spec->location, "\"" + pair.spec->name + "\"",
                       fmt::format("no point of the first face has the second face within {:g} m: there is nothing to "
                                   "bond",
                                   pair.reach.ahead),
                       pair.spec->search_distance > 0
                           ? "faces closer than search_distance along the normal"
                           : fmt::format("faces that touch; apart, or overlapping, by less than {:g} of the larger "
                                         "cells there; or a search_distance",
                                         scene.contact.bond_reach));
  for (const ContactPair& pair : pairs)
    if (pair.points.empty() && !pair.spec->automatic)
      throw InputError(
          pair.spec->location, "\"" + pair.spec->name + "\"",
          "no point of the first face has the second face within reach",
          pair.spec->search_distance > 0
              ? fmt::format("faces closer than search_distance = {:g} m along the normal", pair.spec->search_distance)
              : "faces that see each other along the normal");
  const auto sees_nothing = [&](const ContactPair& pair) {
    double area = 0;  // faces of the larger cells
    for (const ContactGroup& group : pair.groups) area += group.area / std::pow(group.larger_cell, 2);
    return pair.spec->automatic && area < rounding;
  };
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), sees_nothing), pairs.end());
  std::vector<ContactPoints*> points;
  for (ContactPair& pair : pairs) points.push_back(&pair.points);
  ContactPoints::join(points);
  std::vector<std::vector<double>> nearest;
  for (BodyModel& body : bodies) {
    nearest.emplace_back(body.cut_cells.boundary.size(), 1e300);
    body.boundary.pair_of_point.assign(body.cut_cells.boundary.size(), -1);
  }
  for (std::size_t k = 0; k < pairs.size(); ++k)
    for (const int body : {pairs[k].primary, pairs[k].secondary})
      mark_boundary_points(pairs[k], static_cast<int>(k), body, bodies, nearest[body]);
  return pairs;
}

void set_interference(ContactPair& pair, double interference) {
  pair.interference = interference;
  for (ContactGroup& group : pair.groups) group.initial_gap = pair.bonded() ? 0 : group.distance - interference;
}

Subset nodes_near_contact(const std::vector<ContactPair>& pairs, const std::vector<BodyModel>& bodies, int body,
                          const BodyMesh& mesh) {
  constexpr int reach = 3;
  const BodyModel& model = bodies[body];
  const CutCells& cc = model.cut_cells;
  std::vector<int> cells;
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
    cells.push_back(cell);
  }
  std::vector<char> near(cc.cells.size(), 0), marked(mesh.num_nodes, 0);
  mark_cells_around(cc, cells, reach, near);
  for (std::size_t c = 0; c < near.size(); ++c)
    if (near[c])
      for (int node : mesh.cell_nodes[c]) marked[node - mesh.first_node] = 1;
  return Subset(marked);
}

Vec3 force_of_surface_group(const ContactPair& pair, const double* group_force, std::size_t group) {
  Vec3 force = Vec3::Zero();
  for (std::size_t g = group; g < pair.groups.size(); g += pair.num_surface_groups())
    force += group_force[g] * pair.points.direction(pair.groups[g].first_point);
  return force;
}

std::vector<std::string> bonded_gap_warnings(const Scene& scene, const std::vector<ContactPair>& pairs) {
  std::vector<std::string> warnings;
  for (const ContactPair& pair : pairs) {
    if (!pair.bonded()) continue;
    double apart = 0;
    for (std::size_t q = 0; q < pair.num_surface_points(); ++q)
      apart = std::max(apart, std::abs(pair.points.distance(q)));
    if (apart > scene.contact.bond_gap * pair.largest_cell)
      warnings.push_back(fmt::format(
          "bonded contact \"{}\": its faces are apart, or overlap, by up to {:.3g} m where they are tied, as if by "
          "rigid links: moments of shear are off by that much",
          pair.spec->name, apart));
  }
  return warnings;
}

void update_contact_links(const std::vector<ContactPair>& pairs, std::vector<BodyModel>& bodies,
                          const std::vector<double>& group_force, const std::vector<FrictionPoints>& friction) {
  std::size_t first_group = 0;
  std::vector<std::size_t> num_links(bodies.size(), 0);
  for (const ContactPair& pair : pairs)
    for (const int body : {pair.primary, pair.secondary}) num_links[body] += pair.num_surface_points();
  for (BodyModel& body : bodies) {
    body.boundary.links.clear();
    body.boundary.links.reserve(num_links[&body - bodies.data()]);
    body.boundary.bonded.clear();
    for (const ContactPair& pair : pairs) body.boundary.bonded.push_back(pair.bonded() ? 1 : 0);
    body.boundary.friction.clear();
    for (const ContactPair& pair : pairs) body.boundary.friction.push_back(pair.friction());
  }
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const ContactPair& pair = pairs[p];
    BodyModel &primary = bodies[pair.primary], &secondary = bodies[pair.secondary];
    const Mat3 to_primary = primary.cut_cells.grid.rotation.transpose();
    const Mat3 to_secondary = secondary.cut_cells.grid.rotation.transpose();
    std::vector<double> closed_area(pair.groups.size(), 0.0);
    for (const ContactPoint& q : pair.points)
      if (q.active) closed_area[q.group] += q.weight;
    for (std::size_t number = 0; number < pair.num_surface_points(); ++number) {
      const ContactPoint q = pair.points[number];
      const int index = static_cast<int>(p);
      const ContactGroup& group = pair.groups[q.group];
      Vec3 on_secondary = Vec3::Zero();
      if (pair.bonded() && !group_force.empty())
        on_secondary = force_of_surface_group(pair, &group_force[first_group], q.group);
      const double force = group_force.empty() ? 0.0
                           : pair.bonded()     ? on_secondary.dot(q.normal)
                                               : group_force[first_group + q.group];
      const double pressure = q.active && !group_force.empty() ? force / closed_area[q.group] : 0.0;
      const double spread = force / group.area;
      primary.boundary.links.push_back({q.primary_cell, index, q.primary_position, to_primary * q.normal, q.weight,
                                        pair.secondary, q.secondary_cell, q.secondary_position, group.larger_cell,
                                        q.distance, q.active, pressure, spread, true,
                                        to_primary * -on_secondary / group.area});
      secondary.boundary.links.push_back({q.secondary_cell, index, q.secondary_position, -(to_secondary * q.normal),
                                          q.weight, pair.primary, q.primary_cell, q.primary_position, group.larger_cell,
                                          q.distance, q.active, pressure, spread, false,
                                          to_secondary * on_secondary / group.area});
      if (friction.empty() || friction[p].shear.empty()) continue;
      const FrictionPoints& points = friction[p];
      for (const auto& [link, axes, sign] : {std::tuple(&primary.boundary.links.back(), &to_primary, -1.0),
                                             std::tuple(&secondary.boundary.links.back(), &to_secondary, 1.0)}) {
        link->shear = sign * (*axes * points.shear[number]);
        link->slip = sign * (*axes * points.slip[number]);
        link->travelled = points.travelled[number];
        link->wear = points.wear[number];
        link->slips = points.slips[number] != 0;
      }
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
