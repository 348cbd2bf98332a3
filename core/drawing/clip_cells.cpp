#include "core/drawing/clip_cells.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include "core/base/process/parallel.hpp"

namespace cgcontact {

namespace {

constexpr int max_subdivision = 8;
/// Largest distance between a curved surface and its chords that needs no subdivision, cell units.
constexpr double max_sagitta = 0.008;
/// Points nearer to a surface than this lie on it (cell units). Above what make_cut_cells prunes, so that the face of a
/// pruned sliver is found on the neighbour.
constexpr double on_tolerance = 1e-10;
/// Subdivision of cells that a curved patch crosses.
constexpr int patch_subdivision = 2;
/// Patches in a cell that are cut one by one. Each one can double the polyhedra; with more, cells are cut at the whole
/// surface.
constexpr std::size_t max_cutting_patches = 8;
/// Volume (cell units) below which polyhedra are rounding only.
constexpr double min_volume = 1e-25;
/// Cells that are clipped by themselves: enough that the points of their common faces, which two ranges make, are few.
constexpr std::size_t cells_per_range = 1024;

using Hexahedron = std::array<int, 8>;
using Tetrahedron = std::array<int, 4>;

/// Few entries for each point, all of them in one block of memory.
template <class Entry>
class EntriesOfPoints {
 public:
  /// Returns the first entry of a point, from the latest one on, for which matches(entry); nullptr if there is none.
  template <class Matches>
  const Entry* find(int point, const Matches& matches) const {
    if (static_cast<std::size_t>(point) >= latest_.size()) return nullptr;
    for (int i = latest_[point]; i >= 0; i = links_[i].before)
      if (matches(links_[i].entry)) return &links_[i].entry;
    return nullptr;
  }
  void add(int point, const Entry& entry) {
    if (static_cast<std::size_t>(point) >= latest_.size()) latest_.resize(point + 1, -1);
    links_.push_back({entry, latest_[point]});
    latest_[point] = static_cast<int>(links_.size()) - 1;
  }

 private:
  struct Link {
    Entry entry;
    int before;  ///< of the same point, -1: none
  };
  std::vector<int> latest_;  ///< by point, -1: none
  std::vector<Link> links_;
};

/// Distance of a point to a patch.
struct PatchDistance {
  double distance;
  int surface;
};

/// Point where an edge meets a surface; an entry of the end of the lower number.
struct EdgePoint {
  int other_end, surface, point;
};

/// Hash of three coordinates, real or whole.
struct PositionHash {
  template <class Position>
  std::size_t operator()(const Position& x) const {
    std::size_t hash = 0;
    for (int k = 0; k < 3; ++k) hash = hash * 0x9e3779b97f4a7c15ull ^ std::hash<std::decay_t<decltype(x[k])>>()(x[k]);
    return hash ^ (hash >> 29);
  }
};

/// Corners of a hexahedron in VTK order, and its faces with outward orientation.
constexpr int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
constexpr int face[6][4] = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};

double tetrahedron_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a) / 6;
}

/// What makes a point: a node of the grid, or an edge between two points that meets a surface.
struct Origin {
  Index3 node;        ///< in eighths of a cell, of an edge unused
  int a, b, surface;  ///< ends of the edge, a: -1 for a node
};

/// One level of a body, as all ranges of its cells see it.
struct Level {
  explicit Level(const CutCells& cut_cells);
  /// Prepares distances to patches.
  void find_patches();

  const CutCells& cut_cells;
  const BodyGeometry& body;
  const bool has_facets;
  const std::vector<Surface>& surfaces;
  int subdivision = 1;
  std::vector<int> all_surfaces;
  int whole;                   ///< number of the boundary as a whole, the one after the surfaces
  std::vector<Surface> alone;  ///< BodyGeometry::surfaces_alone, where there are patches
};

Level::Level(const CutCells& c)
    : cut_cells(c),
      body(c.solid.geometry()),
      has_facets(body.num_facets() > 0),
      surfaces(body.surfaces()),
      whole(static_cast<int>(surfaces.size())) {
  double curvature = 0;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    all_surfaces.push_back(static_cast<int>(s));
    curvature = std::max(curvature, surfaces[s].max_curvature());
    if (surfaces[s].kind == Surface::Kind::patch) subdivision = patch_subdivision;
  }
  while (subdivision < max_subdivision && curvature / (8.0 * subdivision * subdivision) > max_sagitta) subdivision *= 2;
}

void Level::find_patches() {
  const auto is_patch = [](const Surface& s) { return s.kind == Surface::Kind::patch; };
  if (std::any_of(surfaces.begin(), surfaces.end(), is_patch)) alone = body.surfaces_alone();
}

/// Mesh of a range of cells, with the origin of each point.
struct RangeMesh {
  ClippedMesh mesh;
  std::vector<Origin> origins;
};

/// Clips a range of cells by itself.
class Clipper {
 public:
  explicit Clipper(const Level& level)
      : level_(level), cut_cells_(level.cut_cells), body_(level.body), surfaces_(level.surfaces), whole_(level.whole) {
    inner_side_.assign(surfaces_.size() + 1, 0);
  }
  RangeMesh run(std::size_t first, std::size_t last);

 private:
  void clip_cell(int active);
  void clip_cube(int active, const Index3& fine, int size, const std::vector<int>& surfaces);
  void clip_tetrahedron(const Tetrahedron& tetrahedron, const std::vector<int>& surfaces);
  void bisect(const Tetrahedron& tetrahedron, int surface, std::vector<Tetrahedron>& divided);
  void emit_leaf(Tetrahedron leaf, const std::vector<int>& surfaces);
  void emit_hexahedron(const Hexahedron& hexahedron, const std::vector<int>& surfaces);
  void emit_boundary(const std::array<int, 3>& points, const std::vector<int>& surfaces);

  std::vector<int> surfaces_near(const Vec3& centre, double half_size, const std::vector<int>& candidates) const;
  void set_far_sides(const Vec3& centre, const std::vector<int>& surfaces);
  bool is_inside(const Vec3& centroid) const;
  bool is_inside_beyond(const std::array<int, 3>& points, int surface);
  int add_point(const Vec3& x, const Origin& origin);
  int node(const Index3& fine);
  bool comes_first(int a, int b) const;
  int edge_point(int a, int b, int surface);
  int side(int point, int surface) const;
  double distance(int point, int surface) const;
  double distance_of(const Vec3& x, int surface) const;
  double crossing(const Vec3& x, const Vec3& d, double at_0, double at_1) const;
  bool is_patch(int surface) const;
  static int side_by_distance(double distance);
  template <class Points>
  void set_sides(const Points& points, const std::vector<int>& surfaces);

  const Level& level_;
  const CutCells& cut_cells_;
  const BodyGeometry& body_;
  const std::vector<Surface>& surfaces_;
  const int whole_;
  std::vector<int> cell_surfaces_;  ///< those that matter in the cell in work
  std::vector<int> cube_surfaces_;  ///< those that come near the cube in work
  int active_ = -1;                 ///< the cell in work
  std::vector<char> inner_side_;    ///< sides of the current polyhedron
  /// Point p counts as on another side than it measures for fixed_sides_[fixed_begin_[p] .. fixed_begin_[p + 1]]:
  /// surface and side.
  std::vector<int> fixed_begin_{0};
  std::vector<std::pair<int, int>> fixed_sides_;
  std::unordered_map<Index3, int, PositionHash> nodes_;  ///< points at nodes, in eighths of a cell
  mutable EntriesOfPoints<PatchDistance> patch_distances_;
  EntriesOfPoints<EdgePoint> edge_points_;
  std::vector<PatchDistance> measured_;  ///< of the point in work
  std::vector<Tetrahedron> tetrahedra_, next_tetrahedra_;
  ClippedMesh mesh_;
  std::vector<Origin> origins_;
};

/// Joins the meshes of ranges to that of a level: points of the same origin become one.
class LevelMesh {
 public:
  explicit LevelMesh(const Level& level);
  void add(const RangeMesh& range);
  ClippedMesh finish();
  ClippedMesh facets_alone();

 private:
  int point_of(const Origin& origin, const std::vector<int>& number, const RangeMesh& range, int p);
  int append(const Vec3& x, int cell);
  void add_facets();
  void drop_pieces_outside();
  void drop_inner_triangles();
  void drop_unused_points();
  void add_interior_points();

  const Level& level_;
  const CutCells& cut_cells_;
  GridNumbers node_numbers_;
  std::vector<int> nodes_;  ///< points at the grid's nodes, by their numbers; -1 where there is none yet
  std::unordered_map<Index3, int, PositionHash> fine_nodes_;
  EntriesOfPoints<EdgePoint> edge_points_;
  ClippedMesh mesh_;
};

LevelMesh::LevelMesh(const Level& level)
    : level_(level), cut_cells_(level.cut_cells), node_numbers_(level.cut_cells.numbers.corners()) {
  nodes_.assign(node_numbers_.size(), -1);
}

int LevelMesh::append(const Vec3& x, int cell) {
  mesh_.points.push_back(x);
  mesh_.cell_of_point.push_back(cell);
  return static_cast<int>(mesh_.points.size()) - 1;
}

/// Returns the point that has the origin of point p of a range, a new one where there is none. number: of the points of
/// the range before.
int LevelMesh::point_of(const Origin& origin, const std::vector<int>& number, const RangeMesh& range, int p) {
  const auto new_point = [&] { return append(range.mesh.points[p], range.mesh.cell_of_point[p]); };
  if (origin.a >= 0) {
    const int a = number[origin.a], b = number[origin.b];
    const auto matches = [&](const EdgePoint& e) { return e.other_end == b && e.surface == origin.surface; };
    if (const EdgePoint* const known = edge_points_.find(a, matches)) return known->point;
    const int point = new_point();
    edge_points_.add(a, {b, origin.surface, point});
    return point;
  }
  const Index3& fine = origin.node;
  const bool coarse = (fine[0] | fine[1] | fine[2]) % max_subdivision == 0;
  int& point = coarse ? nodes_[node_numbers_.find(
                            {fine[0] / max_subdivision, fine[1] / max_subdivision, fine[2] / max_subdivision})]
                      : fine_nodes_.try_emplace(origin.node, -1).first->second;
  if (point < 0) point = new_point();
  return point;
}

void LevelMesh::add(const RangeMesh& range) {
  std::vector<int> number(range.origins.size());
  for (std::size_t p = 0; p < number.size(); ++p)
    number[p] = point_of(range.origins[p], number, range, static_cast<int>(p));
  const auto joined = [&](auto corners) {
    for (int& p : corners) p = number[p];
    return corners;
  };
  const ClippedMesh& m = range.mesh;
  const auto append_all = [](const auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
  for (const auto& h : m.hexahedra) mesh_.hexahedra.push_back(joined(h));
  for (const auto& t : m.tetrahedra) mesh_.tetrahedra.push_back(joined(t));
  for (const BoundaryTriangle& t : m.boundary) mesh_.boundary.push_back({joined(t.points), t.cell, t.surface});
  append_all(m.cell_of_hexahedron, mesh_.cell_of_hexahedron);
  append_all(m.cell_of_tetrahedron, mesh_.cell_of_tetrahedron);
  append_all(m.interior.cells, mesh_.interior.cells);
}

ClippedMesh LevelMesh::facets_alone() {
  add_facets();
  return std::move(mesh_);
}

ClippedMesh LevelMesh::finish() {
  drop_pieces_outside();
  drop_inner_triangles();
  if (level_.has_facets) add_facets();
  drop_unused_points();
  add_interior_points();
  return std::move(mesh_);
}

RangeMesh Clipper::run(std::size_t first, std::size_t last) {
  for (std::size_t active = first; active < last; ++active) clip_cell(static_cast<int>(active));
  return {std::move(mesh_), std::move(origins_)};
}

/// The candidates that may cross a cube.
std::vector<int> Clipper::surfaces_near(const Vec3& centre, double half_size,
                                        const std::vector<int>& candidates) const {
  const bool as_whole = candidates.size() == 1 && candidates[0] == whole_;
  std::vector<int> near =
      body_.surfaces_near(centre, half_size, on_tolerance, as_whole ? level_.all_surfaces : candidates);
  if (!near.empty() && as_whole) near.assign(1, whole_);
  return near;
}

/// Returns whether the current polyhedron is inside.
bool Clipper::is_inside(const Vec3& centroid) const { return body_.is_inside(inner_side_, cube_surfaces_, centroid); }

/// Returns whether the body goes on beyond a face of the current polyhedron that lies on a surface.
bool Clipper::is_inside_beyond(const std::array<int, 3>& points, int surface) {
  inner_side_[surface] = !inner_side_[surface];
  const Vec3 centroid = (mesh_.points[points[0]] + mesh_.points[points[1]] + mesh_.points[points[2]]) / 3;
  const bool inside = is_inside(centroid);
  inner_side_[surface] = !inner_side_[surface];
  return inside;
}

void Clipper::clip_cell(int active) {
  active_ = active;
  const Index3& c = cut_cells_.cells[active];
  const Vec3 centre(c[0] + 0.5, c[1] + 0.5, c[2] + 0.5);
  std::vector<int> near = surfaces_near(centre, 0.5, level_.all_surfaces);
  const bool endless = body_.has_endless_surfaces();
  if (!endless && near.size() > max_cutting_patches) near.assign(1, whole_);
  const bool full = cut_cells_.cut_of_active[active] < 0;
  if (full && near.empty() && !cut_cells_.grid.is_quadtree()) {  // a quadtree's cells end where their layer does
    mesh_.interior.cells.push_back(active);
    return;
  }
  cell_surfaces_ = endless ? level_.all_surfaces : near;
  set_far_sides(centre, level_.all_surfaces);
  const bool curved =
      std::any_of(near.begin(), near.end(), [&](int s) { return is_patch(s) || surfaces_[s].max_curvature() > 0; });
  const int divisions = curved && !full ? level_.subdivision : 1;
  const int size = max_subdivision / divisions;
  for (int k = 0; k < divisions; ++k)
    for (int j = 0; j < divisions; ++j)
      for (int i = 0; i < divisions; ++i) {
        const Index3 fine{c[0] * max_subdivision + i * size, c[1] * max_subdivision + j * size,
                          c[2] * max_subdivision + k * size};
        clip_cube(active, fine, size, near);
      }
}

/// Sides of the surfaces that do not come near; those that end at the body's edges are not asked for theirs.
void Clipper::set_far_sides(const Vec3& centre, const std::vector<int>& surfaces) {
  if (!body_.has_endless_surfaces()) return;
  for (int s : surfaces) inner_side_[s] = surfaces_[s].signed_distance(centre) < 0;
}

/// Cube of `size` fine units at `fine`, inside one active cell.
void Clipper::clip_cube(int active, const Index3& fine, int size, const std::vector<int>& surfaces) {
  const double length = static_cast<double>(size) / max_subdivision;
  const Vec3 centre = Vec3(fine[0], fine[1], fine[2]) / max_subdivision + Vec3::Constant(length / 2);
  set_far_sides(centre, surfaces);
  cube_surfaces_ = surfaces_near(centre, length / 2, surfaces);
  const std::vector<int>& near = cube_surfaces_;
  const bool full = cut_cells_.cut_of_active[active] < 0;
  if (near.empty() && !full && !is_inside(centre)) return;

  Hexahedron points;
  for (int v = 0; v < 8; ++v)
    points[v] = node({fine[0] + size * corner[v][0], fine[1] + size * corner[v][1], fine[2] + size * corner[v][2]});
  const bool cut = std::any_of(near.begin(), near.end(), [&](int s) {
    bool inner = false, outer = false;
    for (int p : points) {
      const int where = side(p, s);
      inner |= where < 0;
      outer |= where > 0;
    }
    return inner && outer;
  });
  if (full || !cut) {
    set_sides(points, near);
    if (full || is_inside(centre)) emit_hexahedron(points, near);
    return;
  }
  for (const auto& t : tetrahedra_of_hexahedron)
    clip_tetrahedron({points[t[0]], points[t[1]], points[t[2]], points[t[3]]}, near);
}

void Clipper::clip_tetrahedron(const Tetrahedron& tetrahedron, const std::vector<int>& surfaces) {
  tetrahedra_.assign(1, tetrahedron);
  for (int s : surfaces) {
    next_tetrahedra_.clear();
    for (const Tetrahedron& t : tetrahedra_) bisect(t, s, next_tetrahedra_);
    tetrahedra_.swap(next_tetrahedra_);
  }
  for (const Tetrahedron& t : tetrahedra_) emit_leaf(t, surfaces);
}

void Clipper::bisect(const Tetrahedron& tetrahedron, int surface, std::vector<Tetrahedron>& divided) {
  int sides[4];
  for (int v = 0; v < 4; ++v) sides[v] = side(tetrahedron[v], surface);
  int first = -1, second = -1;
  std::pair<int, int> lowest{-1, -1};
  for (int a = 0; a < 4; ++a)
    for (int b = a + 1; b < 4; ++b) {
      if (sides[a] * sides[b] >= 0) continue;
      std::pair<int, int> ends(tetrahedron[a], tetrahedron[b]);
      if (comes_first(ends.second, ends.first)) std::swap(ends.first, ends.second);
      if (first < 0 || (ends.first == lowest.first ? comes_first(ends.second, lowest.second)
                                                   : comes_first(ends.first, lowest.first))) {
        lowest = ends;
        first = a;
        second = b;
      }
    }
  if (first < 0) {
    divided.push_back(tetrahedron);
    return;
  }
  const int middle = edge_point(lowest.first, lowest.second, surface);
  Tetrahedron half = tetrahedron;
  half[first] = middle;
  bisect(half, surface, divided);
  half = tetrahedron;
  half[second] = middle;
  bisect(half, surface, divided);
}

/// Sets the sides of a polyhedron that no surface cuts: those of its points, or of its centroid when all points lie on
/// the surface.
template <class Points>
void Clipper::set_sides(const Points& points, const std::vector<int>& surfaces) {
  for (int s : surfaces) {
    int where = 0;
    for (std::size_t v = 0; v < points.size() && where == 0; ++v) where = side(points[v], s);
    if (where == 0) {
      Vec3 centroid = Vec3::Zero();
      for (int p : points) centroid += mesh_.points[p] / static_cast<double>(points.size());
      where = distance_of(centroid, s) < 0 ? -1 : 1;
    }
    inner_side_[s] = where < 0;
  }
}

void Clipper::emit_leaf(Tetrahedron leaf, const std::vector<int>& surfaces) {
  set_sides(leaf, surfaces);
  const auto& x = mesh_.points;
  if (!is_inside((x[leaf[0]] + x[leaf[1]] + x[leaf[2]] + x[leaf[3]]) / 4)) return;
  const double volume = tetrahedron_volume(x[leaf[0]], x[leaf[1]], x[leaf[2]], x[leaf[3]]);
  if (std::abs(volume) < min_volume) return;
  if (volume < 0) std::swap(leaf[2], leaf[3]);
  mesh_.tetrahedra.push_back(leaf);
  mesh_.cell_of_tetrahedron.push_back(active_);
  emit_boundary({leaf[1], leaf[2], leaf[3]}, surfaces);
  emit_boundary({leaf[0], leaf[3], leaf[2]}, surfaces);
  emit_boundary({leaf[0], leaf[1], leaf[3]}, surfaces);
  emit_boundary({leaf[0], leaf[2], leaf[1]}, surfaces);
}

void Clipper::emit_hexahedron(const Hexahedron& hexahedron, const std::vector<int>& surfaces) {
  mesh_.hexahedra.push_back(hexahedron);
  mesh_.cell_of_hexahedron.push_back(active_);
  if (surfaces.empty()) return;
  for (const auto& f : face) {
    const std::array<int, 4> q{hexahedron[f[0]], hexahedron[f[1]], hexahedron[f[2]], hexahedron[f[3]]};
    // Split along the diagonal that the tetrahedra use.
    emit_boundary({q[0], q[1], q[2]}, surfaces);
    emit_boundary({q[0], q[2], q[3]}, surfaces);
  }
}

/// Adds a face of the current polyhedron if it lies on a surface and the body ends there. (Facets are drawn
/// themselves.)
void Clipper::emit_boundary(const std::array<int, 3>& points, const std::vector<int>& surfaces) {
  if (level_.has_facets) return;
  for (int s : surfaces) {
    if (side(points[0], s) != 0 || side(points[1], s) != 0 || side(points[2], s) != 0) continue;
    if (is_inside_beyond(points, s)) continue;
    mesh_.boundary.push_back({points, active_, s});
    return;
  }
}

/// New point's number; its fixed sides, if any, have been appended before.
int Clipper::add_point(const Vec3& x, const Origin& origin) {
  mesh_.points.push_back(x);
  mesh_.cell_of_point.push_back(active_);
  origins_.push_back(origin);
  fixed_begin_.push_back(static_cast<int>(fixed_sides_.size()));
  return static_cast<int>(mesh_.points.size()) - 1;
}

int Clipper::node(const Index3& fine) {
  const auto [entry, added] = nodes_.try_emplace(fine, -1);
  if (added) entry->second = add_point(Vec3(fine[0], fine[1], fine[2]) / max_subdivision, {fine, -1, -1, -1});
  return entry->second;
}

/// Returns whether point a comes before b, by their positions, on which all ranges of cells agree (two points of one
/// position, of which both lie on all surfaces there, are as they were made).
bool Clipper::comes_first(int a, int b) const {
  const Vec3 &x = mesh_.points[a], &y = mesh_.points[b];
  for (int k = 2; k >= 0; --k)
    if (x[k] != y[k]) return x[k] < y[k];
  return a < b;
}

/// Returns where the line x + t d, 0 < t < 1, meets the boundary, given the distances at its ends, which have different
/// signs: regula falsi with halved ends (Illinois), as the distance has kinks at edges.
double Clipper::crossing(const Vec3& x, const Vec3& d, double at_0, double at_1) const {
  double low = 0, high = 1, t = at_0 / (at_0 - at_1);
  int last = 0;
  for (int pass = 0; pass < 8; ++pass) {
    const double at_t = distance_of(x + t * d, whole_);
    if (std::abs(at_t) <= on_tolerance) break;
    const bool is_low = (at_t < 0) == (at_0 < 0);
    (is_low ? low : high) = t;
    (is_low ? at_0 : at_1) = at_t;
    if (last == (is_low ? -1 : 1)) (is_low ? at_1 : at_0) /= 2;
    last = is_low ? -1 : 1;
    t = low + (high - low) * at_0 / (at_0 - at_1);
  }
  return t;
}

/// Returns the point where the edge from a to b, of which a comes first, meets a surface.
int Clipper::edge_point(int a, int b, int surface) {
  const auto matches = [&](const EdgePoint& entry) { return entry.other_end == b && entry.surface == surface; };
  if (const EdgePoint* const known = edge_points_.find(a, matches)) return known->point;

  const Vec3 x = mesh_.points[a], d = mesh_.points[b] - mesh_.points[a];
  const double da = distance(a, surface);
  const double linear = da / (da - distance(b, surface));
  double roots[2], t = linear, best = 1;
  const int num_roots = is_patch(surface) ? 0 : surfaces_[surface].intersect_line(x, d, roots);
  for (int r = 0; r < num_roots; ++r)
    if (roots[r] >= 0 && roots[r] <= 1 && std::abs(roots[r] - linear) < best) {
      best = std::abs(roots[r] - linear);
      t = roots[r];
    }
  if (surface == whole_) t = crossing(x, d, da, distance(b, surface));
  const Vec3 middle = x + t * d;
  fixed_sides_.emplace_back(surface, 0);
  measured_.clear();
  for (int s : cell_surfaces_) {
    const int side_a = side(a, s), side_b = side(b, s);
    // Between two points of one side a curved surface may bulge in; the mesh is linear and does not see that.
    const bool decided = s < surface ? side_a * side_b >= 0 : side_a == 0 && side_b == 0;
    if (s == surface || !decided) continue;
    const int linear_side = side_a != 0 ? side_a : side_b;
    const double distance = distance_of(middle, s);
    if (is_patch(s)) measured_.push_back({distance, s});
    if (linear_side != side_by_distance(distance)) fixed_sides_.emplace_back(s, linear_side);
  }
  const int point = add_point(middle, {{}, a, b, surface});
  for (const PatchDistance& measured : measured_) patch_distances_.add(point, measured);
  edge_points_.add(a, {b, surface, point});
  return point;
}

/// -1 inner, 0 on, +1 outer side of a surface.
int Clipper::side_by_distance(double distance) {
  if (std::abs(distance) <= on_tolerance) return 0;
  return distance < 0 ? -1 : 1;
}

/// Patch, or the boundary as a whole.
bool Clipper::is_patch(int surface) const {
  return surface == whole_ || surfaces_[surface].kind == Surface::Kind::patch;
}

double Clipper::distance_of(const Vec3& x, int surface) const {
  if (surface == whole_) return body_.signed_distance(x);
  if (!is_patch(surface)) return surfaces_[surface].signed_distance(x);
  return level_.alone[surface].signed_distance(x);
}

/// From a point to a surface; that to a patch, a search, is kept.
double Clipper::distance(int point, int surface) const {
  const Vec3& x = mesh_.points[point];
  if (!is_patch(surface)) return distance_of(x, surface);
  const auto matches = [&](const PatchDistance& entry) { return entry.surface == surface; };
  if (const PatchDistance* const known = patch_distances_.find(point, matches)) return known->distance;
  const double distance = distance_of(x, surface);
  patch_distances_.add(point, {distance, surface});
  return distance;
}

int Clipper::side(int point, int surface) const {
  for (int i = fixed_begin_[point]; i < fixed_begin_[point + 1]; ++i)
    if (fixed_sides_[i].first == surface) return fixed_sides_[i].second;
  return side_by_distance(distance(point, surface));
}

/// Adds the facets of the boundary themselves, clipped cell by cell.
void LevelMesh::add_facets() {
  std::map<std::pair<Index3, int>, int> adopter;  // of the facets of a patch in a cell without volume
  for (const MergedSliver& adoption : cut_cells_.adoptions)
    adopter.try_emplace({adoption.donor, adoption.surface}, adoption.active);
  std::unordered_map<Vec3, int, PositionHash> number;
  std::vector<int> corners;
  level_.body.each_facet_in_cell([&](const Index3& cell, int surface, const Vec3* x, int num_corners) {
    int active = cut_cells_.find(cell);
    if (active < 0) {
      const auto adopted = adopter.find({cell, surface});
      if (adopted == adopter.end()) return;  // of no area
      active = adopted->second;
    }
    corners.clear();
    for (int i = 0; i < num_corners; ++i) {
      const auto [entry, added] = number.try_emplace(x[i], static_cast<int>(mesh_.points.size()));
      if (added) append(x[i], active);
      corners.push_back(entry->second);
    }
    for (int i = 2; i < num_corners; ++i)
      mesh_.boundary.push_back({{corners[0], corners[i - 1], corners[i]}, active, surface});
  });
}

/// Drops groups of polyhedra outside of the body. A surface goes on beyond the end of its face, and may cut off there
/// what seems to be inside. Groups that whole cells belong to are inside; of the others the middle of the largest
/// polyhedron tells.
void LevelMesh::drop_pieces_outside() {
  std::vector<int> parent(mesh_.points.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int p) {
    while (parent[p] != p) p = parent[p] = parent[parent[p]];
    return p;
  };
  const auto join = [&](const auto& points) {
    for (const int p : points) parent[root(p)] = root(points[0]);
  };
  for (const Tetrahedron& t : mesh_.tetrahedra) join(t);
  for (const Hexahedron& h : mesh_.hexahedra) join(h);
  enum : char { unknown, inside, outside };
  std::vector<char> where(mesh_.points.size(), unknown);  // of the group of each root
  for (std::size_t i = 0; i < mesh_.hexahedra.size(); ++i)
    if (cut_cells_.cut_of_active[mesh_.cell_of_hexahedron[i]] < 0) where[root(mesh_.hexahedra[i][0])] = inside;
  for (const int cell : mesh_.interior.cells)
    for (int a = 0; a < 8; ++a) {
      const Index3& c = cut_cells_.cells[cell];
      const int p = nodes_[node_numbers_.find({c[0] + (a & 1), c[1] + (a >> 1 & 1), c[2] + (a >> 2)})];
      if (p >= 0) where[root(p)] = inside;
    }
  std::map<int, std::pair<double, Vec3>> largest;  // by root: volume and middle
  const auto look_at = [&](const auto& points, const auto& volume) {
    const int group = root(points[0]);
    if (where[group] == inside) return;
    Vec3 middle = Vec3::Zero();
    for (const int p : points) middle += mesh_.points[p] / static_cast<double>(points.size());
    const std::pair<double, Vec3> now{volume(), middle};
    const auto [entry, added] = largest.try_emplace(group, now);
    if (!added && now.first > entry->second.first) entry->second = now;
  };
  const auto corner = [&](const auto& points, int k) { return mesh_.points[points[k]]; };
  for (const Tetrahedron& t : mesh_.tetrahedra)
    look_at(t, [&] { return tetrahedron_volume(corner(t, 0), corner(t, 1), corner(t, 2), corner(t, 3)); });
  for (const Hexahedron& h : mesh_.hexahedra) look_at(h, [&] { return Vec3(corner(h, 6) - corner(h, 0)).prod(); });
  for (const auto& [group, entry] : largest)
    if (!cut_cells_.solid.contains(entry.second)) where[group] = outside;

  const auto is_outside = [&](int p) { return where[root(p)] == outside; };
  const auto drop = [&](auto& polyhedra, std::vector<int>& cells) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < polyhedra.size(); ++i) {
      if (is_outside(polyhedra[i][0])) continue;
      polyhedra[n] = polyhedra[i];
      cells[n++] = cells[i];
    }
    polyhedra.resize(n);
    cells.resize(n);
  };
  drop(mesh_.tetrahedra, mesh_.cell_of_tetrahedron);
  drop(mesh_.hexahedra, mesh_.cell_of_hexahedron);
  mesh_.boundary.erase(std::remove_if(mesh_.boundary.begin(), mesh_.boundary.end(),
                                      [&](const BoundaryTriangle& b) { return is_outside(b.points[0]); }),
                       mesh_.boundary.end());
}

/// Drops triangles that belong to two polyhedra: they lie inside the body (chords of a curved surface).
void LevelMesh::drop_inner_triangles() {
  std::vector<std::pair<std::array<int, 3>, std::size_t>> order;
  order.reserve(mesh_.boundary.size());
  for (std::size_t i = 0; i < mesh_.boundary.size(); ++i) {
    std::array<int, 3> key = mesh_.boundary[i].points;
    std::sort(key.begin(), key.end());
    order.emplace_back(key, i);
  }
  std::sort(order.begin(), order.end());
  std::vector<char> keep(mesh_.boundary.size(), 1);
  for (std::size_t i = 1; i < order.size(); ++i)
    if (order[i].first == order[i - 1].first) keep[order[i].second] = keep[order[i - 1].second] = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) mesh_.boundary[n++] = mesh_.boundary[i];
  mesh_.boundary.resize(n);
}

void LevelMesh::drop_unused_points() {
  std::vector<int> number(mesh_.points.size(), -1);
  for (const auto& h : mesh_.hexahedra)
    for (int p : h) number[p] = 0;
  for (const auto& t : mesh_.tetrahedra)
    for (int p : t) number[p] = 0;
  for (const auto& b : mesh_.boundary)
    for (int p : b.points) number[p] = 0;
  int count = 0;
  for (std::size_t p = 0; p < number.size(); ++p)
    if (number[p] == 0) {
      mesh_.points[count] = mesh_.points[p];
      mesh_.cell_of_point[count] = mesh_.cell_of_point[p];
      number[p] = count++;
    }
  mesh_.points.resize(count);
  mesh_.cell_of_point.resize(count);
  for (auto& h : mesh_.hexahedra)
    for (int& p : h) p = number[p];
  for (auto& t : mesh_.tetrahedra)
    for (int& p : t) p = number[p];
  for (auto& b : mesh_.boundary)
    for (int& p : b.points) p = number[p];
  for (int& p : nodes_)
    if (p >= 0) p = number[p];
}

/// Adds the corners of interior cells that no polyhedron has.
void LevelMesh::add_interior_points() {
  InteriorCells& interior = mesh_.interior;
  for (const int cell : interior.cells) {
    const Index3& c = cut_cells_.cells[cell];
    for (int a = 0; a < 8; ++a) {
      int& point = nodes_[node_numbers_.find({c[0] + (a & 1), c[1] + (a >> 1 & 1), c[2] + (a >> 2)})];
      if (point != -1) continue;
      point = -2 - static_cast<int>(interior.cell_of_point.size());
      interior.cell_of_point.push_back(cell);
      interior.corner_of_point.push_back(static_cast<signed char>(a));
    }
  }
  interior.levels.push_back({std::move(node_numbers_), std::move(nodes_)});
}

/// Clips ranges of cells side by side and joins them in order.
ClippedMesh clip_level(const CutCells& cut_cells) {
  Level level(cut_cells);
  level.find_patches();
  const std::size_t n = cut_cells.cells.size();
  std::vector<RangeMesh> ranges(num_chunks(n, cells_per_range));
  parallel_chunks(
      "cgcontact::clip_cells::range", n, cells_per_range,
      [&](std::size_t range, std::size_t first, std::size_t last) { ranges[range] = Clipper(level).run(first, last); });
  LevelMesh mesh(level);
  for (RangeMesh& range : ranges) {
    mesh.add(range);
    range = RangeMesh();
  }
  return mesh.finish();
}

/// Appends the mesh of one level of a body.
void append_level(const ClippedMesh& level, int number, int first_cell, ClippedMesh& mesh) {
  const int first_point = static_cast<int>(mesh.points.size());
  const auto moved = [&](auto corners) {
    for (int& p : corners) p += first_point;
    return corners;
  };
  for (const Vec3& x : level.points) mesh.points.emplace_back(std::ldexp(1.0, -number) * x);
  for (const int cell : level.cell_of_point) mesh.cell_of_point.push_back(first_cell + cell);
  for (const auto& h : level.hexahedra) mesh.hexahedra.push_back(moved(h));
  for (const int cell : level.cell_of_hexahedron) mesh.cell_of_hexahedron.push_back(first_cell + cell);
  for (const auto& t : level.tetrahedra) mesh.tetrahedra.push_back(moved(t));
  for (const int cell : level.cell_of_tetrahedron) mesh.cell_of_tetrahedron.push_back(first_cell + cell);
  for (const BoundaryTriangle& t : level.boundary)
    mesh.boundary.push_back({moved(t.points), first_cell + t.cell, t.surface, number});
  InteriorCells& interior = mesh.interior;
  const int first_interior = static_cast<int>(interior.cell_of_point.size());
  for (const int cell : level.interior.cells) interior.cells.push_back(first_cell + cell);
  for (const int cell : level.interior.cell_of_point) interior.cell_of_point.push_back(first_cell + cell);
  interior.corner_of_point.insert(interior.corner_of_point.end(), level.interior.corner_of_point.begin(),
                                  level.interior.corner_of_point.end());
  interior.levels.insert(interior.levels.end(), level.interior.levels.begin(), level.interior.levels.end());
  if (level.interior.levels.empty()) interior.levels.emplace_back();
  for (int& p : interior.levels.back().point)
    if (p != -1) p += p >= 0 ? first_point : -first_interior;
}

/// Adds the ends of a quadtree's body, which its cells have where their layer ends, inside of the solid (of that
/// level).
void add_ends(const CutCells& level, ClippedMesh& mesh) {
  const int axis = level.grid.plane_strain;
  const std::vector<Surface>& surfaces = level.solid.surfaces();
  for (const int side : {0, 1}) {
    const auto end = std::find_if(surfaces.begin(), surfaces.end(), [&](const Surface& s) {
      return s.kind == Surface::Kind::plane && (side == 0 ? -1 : 1) * s.direction[axis] > 0.5;
    });
    const int surface = end == surfaces.end() ? 0 : static_cast<int>(end - surfaces.begin());
    const auto add = [&](const std::array<int, 3>& points, int cell) {
      for (const int p : points)
        if (std::abs(mesh.points[p][axis] - side) > on_tolerance) return;
      mesh.boundary.push_back({points, cell, surface});
    };
    for (std::size_t i = 0; i < mesh.hexahedra.size(); ++i)
      for (const auto& f : face) {
        const Hexahedron& h = mesh.hexahedra[i];
        add({h[f[0]], h[f[1]], h[f[2]]}, mesh.cell_of_hexahedron[i]);
        add({h[f[0]], h[f[2]], h[f[3]]}, mesh.cell_of_hexahedron[i]);
      }
    for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i)
      for (const auto& f : {Index3{0, 2, 1}, Index3{0, 1, 3}, Index3{0, 3, 2}, Index3{1, 2, 3}}) {
        const Tetrahedron& t = mesh.tetrahedra[i];
        add({t[f[0]], t[f[1]], t[f[2]]}, mesh.cell_of_tetrahedron[i]);
      }
  }
}

/// Level by level: points are shared within a level only.
template <class Clip>
ClippedMesh clip_levels(const CutCells& cut_cells, const Clip& clip_level) {
  const auto clip = [&](const CutCells& level) {
    ClippedMesh mesh = clip_level(level);
    if (level.grid.is_quadtree()) add_ends(level, mesh);
    return mesh;
  };
  ClippedMesh mesh;
  if (cut_cells.level_cells.empty()) {
    mesh = clip(cut_cells);
    mesh.cut_cells = &cut_cells;
    return mesh;
  }
  mesh.cut_cells = &cut_cells;
  mesh.level_of_cell = cut_cells.levels;
  for (int l = 0; l < cut_cells.num_levels(); ++l) {
    CutCells level = cut_cells.level_cells[l];
    level.solid = cut_cells.level_solids[l];
    const int first = cut_cells.first_of_level[l];
    for (const MergedSliver& adoption : cut_cells.adoptions)
      if (adoption.level == l && cut_cells.level(adoption.active) == l)
        level.adoptions.push_back({adoption.active - first, adoption.donor, adoption.surface});
    append_level(clip(level), l, first, mesh);
  }
  return mesh;
}

}  // namespace

ClippedMesh clip_cells(const CutCells& cut_cells) { return clip_levels(cut_cells, clip_level); }

ClippedMesh clip_boundary(const CutCells& cut_cells) {
  return clip_levels(cut_cells, [](const CutCells& cells) {
    const Level level(cells);
    if (cells.grid.is_quadtree() || !level.has_facets) return clip_level(cells);
    return LevelMesh(level).facets_alone();
  });
}

Vec3 clamped_cell_coordinates(const CutCells& cut_cells, int active_cell, const Vec3& point) {
  return cell_coordinates(cut_cells, active_cell, point).cwiseMax(-1.0).cwiseMin(1.0);
}

Vec3 ClippedMesh::interior_xi(std::size_t point) const {
  const int a = interior.corner_of_point[point];
  return {a & 1 ? 1.0 : -1.0, a & 2 ? 1.0 : -1.0, a & 4 ? 1.0 : -1.0};
}

Vec3 ClippedMesh::interior_point(std::size_t point) const {
  return grid_position(*cut_cells, interior.cell_of_point[point], interior_xi(point));
}

std::array<int, 8> ClippedMesh::interior_hexahedron(std::size_t i) const {
  const int cell = interior.cells[i];
  const InteriorCells::Nodes& nodes = interior.levels[level(cell)];
  const Index3& c = cut_cells->cells[cell];
  std::array<int, 8> hexahedron;
  for (int v = 0; v < 8; ++v) {
    const int point = nodes.point[nodes.numbers.find({c[0] + corner[v][0], c[1] + corner[v][1], c[2] + corner[v][2]})];
    hexahedron[v] = point >= 0 ? point : static_cast<int>(points.size()) - 2 - point;
  }
  return hexahedron;
}

ClippedMesh::Polyhedron ClippedMesh::polyhedron(std::size_t i) const {
  if (i < hexahedra.size()) return {hexahedra[i], 8, cell_of_hexahedron[i]};
  i -= hexahedra.size();
  if (i >= tetrahedra.size()) {
    i -= tetrahedra.size();
    return {interior_hexahedron(i), 8, interior.cells[i]};
  }
  const auto& t = tetrahedra[i];
  return {{t[0], t[1], t[2], t[3]}, 4, cell_of_tetrahedron[i]};
}

double ClippedMesh::volume() const {
  double sum = 0;
  for (const auto& h : hexahedra) {
    const Vec3 d = points[h[6]] - points[h[0]];
    sum += d[0] * d[1] * d[2];
  }
  for (const auto& t : tetrahedra) sum += tetrahedron_volume(points[t[0]], points[t[1]], points[t[2]], points[t[3]]);
  for (const int cell : interior.cells) sum += std::ldexp(1.0, -3 * level(cell));
  return sum;
}

double ClippedMesh::boundary_area() const {
  double sum = 0;
  for (const auto& b : boundary) {
    const Vec3& a = points[b.points[0]];
    sum += (points[b.points[1]] - a).cross(points[b.points[2]] - a).norm() / 2;
  }
  return sum;
}

}  // namespace cgcontact
