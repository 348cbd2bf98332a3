#include "core/triangles/triangle_repair.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/Euler_operations.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/errors/errors.hpp"
#include "core/triangles/triangle_arrangement.hpp"
#include "core/triangles/triangle_checks.hpp"
#include "core/triangles/triangle_crossings.hpp"
#include "core/triangles/triangle_edges.hpp"
#include "core/triangles/triangle_reader.hpp"
#include "core/triangles/triangle_surface.hpp"

namespace cgcontact {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

/// Fractions of the diagonal: distance of points on open edges that are made one; volume over area below which a shell
/// has no thickness.
constexpr double merge_distance = 1e-4, no_thickness = 1e-6;
constexpr int max_passes = 5;
constexpr double half_a_pass = 0.5;  // of the shortest edge at a rim: merging closes gaps, not triangles

[[noreturn]] void fail(const std::string& file, const std::string& problem) {
  throw InputError(SourceLocation{file, 0, ""}, "", "repair = true does not help: " + problem,
                   "a closed surface: mend it in the program it is from");
}

double area(const TriangleSoup& soup) {
  double sum = 0;
  for (const Triangle& t : soup.triangles)
    sum += (soup.points[t[1]] - soup.points[t[0]]).cross(soup.points[t[2]] - soup.points[t[0]]).norm() / 2;
  return sum;
}

void turn_over(TriangleSoup& soup) {
  for (Triangle& t : soup.triangles) std::swap(t[1], t[2]);
}

void append(const TriangleSoup& added, TriangleSoup& soup) {
  const int first = static_cast<int>(soup.points.size());
  soup.points.insert(soup.points.end(), added.points.begin(), added.points.end());
  for (const Triangle& t : added.triangles) soup.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

/// Points on open edges that nearly coincide become one, but no edge there collapses.
int merge_rims(TriangleSoup& soup) {
  std::vector<int> rim;
  double shortest = merge_distance * soup.diagonal() / half_a_pass;
  each_edge(soup.triangles, soup.points.size(), [&](const std::vector<EdgeUse>& uses) {
    if (uses.size() != 1) return;
    const Triangle& t = soup.triangles[uses[0].triangle];
    const int a = t[uses[0].corner], b = t[(uses[0].corner + 1) % 3];
    rim.push_back(a);
    rim.push_back(b);
    shortest = std::min(shortest, (soup.points[a] - soup.points[b]).norm());
  });
  if (rim.empty()) return 0;
  std::sort(rim.begin(), rim.end());
  rim.erase(std::unique(rim.begin(), rim.end()), rim.end());
  const int gone = soup.merge(std::move(rim), half_a_pass * shortest);
  soup.drop_collapsed();
  return gone;
}

/// A connected, closed surface.
struct Shell {
  TriangleSoup soup;
  double volume = 0;
  bool one_way = true;  ///< all triangles were oriented alike in the file
  bool crosses = false;
  Eigen::AlignedBox3d box;
};

/// Triangles between the rim of a hole and its middle; they may cross.
void close_with_fan(Mesh& mesh, Mesh::Halfedge_index rim) {
  Vec3 middle = Vec3::Zero();
  int count = 0;
  for (const Mesh::Vertex_index v : vertices_around_face(rim, mesh)) {
    middle += Vec3(mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
    ++count;
  }
  middle /= count;
  CGAL::Euler::fill_hole(rim, mesh);
  const Mesh::Halfedge_index spoke = CGAL::Euler::add_center_vertex(rim, mesh);
  mesh.point(target(spoke, mesh)) = Point(middle[0], middle[1], middle[2]);
}

/// The soup with neighbours oriented alike; non-manifold edges and corners are separated.
struct OrientedMesh {
  Mesh mesh;
  std::vector<char> turned;  ///< of every triangle of the soup: was oriented the other way in the file
};

OrientedMesh orient(const TriangleSoup& soup, const std::string& file) {
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> polygons;
  for (const Vec3& x : soup.points) points.emplace_back(x[0], x[1], x[2]);
  for (const Triangle& t : soup.triangles)
    polygons.push_back(
        {static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2])});
  pmp::repair_polygon_soup(points, polygons);
  const auto before = polygons;
  const std::vector<Point> points_before = points;
  pmp::orient_polygon_soup(points, polygons);
  const auto is_turned = [&](std::size_t i) {  // corners may have new numbers
    const auto first = std::find_if(polygons[i].begin(), polygons[i].end(),
                                    [&](std::size_t p) { return points[p] == points_before[before[i][0]]; });
    const std::size_t k = static_cast<std::size_t>(first - polygons[i].begin());
    return points[polygons[i][(k + 1) % 3]] != points_before[before[i][1]];
  };
  OrientedMesh result;
  result.turned.resize(polygons.size());
  for (std::size_t i = 0; i < polygons.size(); ++i) result.turned[i] = is_turned(i);
  if (!pmp::is_polygon_soup_a_polygon_mesh(polygons)) fail(file, "its triangles do not make up surfaces");
  pmp::polygon_soup_to_polygon_mesh(points, polygons, result.mesh);
  return result;
}

/// Returns the number of holes that were filled.
int fill_holes(Mesh& mesh, const std::string& file) {
  pmp::stitch_borders(mesh);
  std::vector<Mesh::Halfedge_index> cycles;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(cycles));
  for (const Mesh::Halfedge_index cycle : cycles) {
    std::vector<Mesh::Face_index> patch;
    pmp::triangulate_hole(mesh, cycle, std::back_inserter(patch));
    if (patch.empty()) close_with_fan(mesh, cycle);
  }
  if (!CGAL::is_closed(mesh)) fail(file, "its holes cannot be filled");
  return static_cast<int>(cycles.size());
}

/// Divides a closed mesh into shells, each oriented as most of it was in the file. `turned`: of the first triangles.
std::vector<Shell> separate_shells(Mesh& mesh, const std::vector<char>& turned, SurfaceRepair& repair) {
  auto number = mesh.add_property_map<Mesh::Face_index, std::size_t>("f:shell", 0).first;
  std::vector<Shell> shells(pmp::connected_components(mesh, number));
  std::vector<std::array<int, 2>> ways(shells.size(), {0, 0});
  std::vector<int> point_number(mesh.num_vertices() + mesh.number_of_removed_vertices(), -1);
  std::vector<int> point_shell(point_number.size(), -1);
  for (const Mesh::Face_index f : mesh.faces()) {
    Shell& shell = shells[number[f]];
    Triangle t;
    int k = 0;
    for (const Mesh::Vertex_index v : vertices_around_face(mesh.halfedge(f), mesh)) {
      if (point_shell[v] != static_cast<int>(number[f])) {
        point_shell[v] = static_cast<int>(number[f]);
        point_number[v] = static_cast<int>(shell.soup.points.size());
        shell.soup.points.emplace_back(mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
        shell.box.extend(shell.soup.points.back());
      }
      t[k++] = point_number[v];
    }
    shell.soup.triangles.push_back(t);
    const auto index = static_cast<std::size_t>(f.idx());
    if (index < turned.size()) ++ways[number[f]][static_cast<std::size_t>(turned[index])];
  }
  for (std::size_t s = 0; s < shells.size(); ++s) {
    Shell& shell = shells[s];
    shell.one_way = ways[s][0] == 0 || ways[s][1] == 0;
    if (ways[s][1] > ways[s][0]) turn_over(shell.soup);  // as most of it was in the file
    repair.turned += std::min(ways[s][0], ways[s][1]);
    shell.volume = shell.soup.signed_volume();
  }
  return shells;
}

/// Neighbours oriented alike, holes filled, divided into shells.
std::vector<Shell> close_shells(const TriangleSoup& soup, const std::string& file, SurfaceRepair& repair) {
  OrientedMesh oriented = orient(soup, file);
  repair.holes = fill_holes(oriented.mesh, file);
  return separate_shells(oriented.mesh, oriented.turned, repair);
}

/// Shells as one list of triangles.
TriangleSoup joined(const std::vector<const Shell*>& shells) {
  TriangleSoup soup;
  for (const Shell* shell : shells) append(shell->soup, soup);
  return soup;
}

/// Returns the connected component of every triangle of a closed surface.
std::vector<int> shell_numbers(const TriangleSoup& soup, int& count) {
  std::vector<int> number(soup.triangles.size(), -1);
  const auto neighbours = edge_neighbours(soup.triangles, soup.points.size());
  count = 0;
  for (std::size_t t = 0; t < number.size(); ++t) {
    if (number[t] >= 0) continue;
    flood(
        neighbours, static_cast<int>(t), [&](int, int to) { return number[to] < 0; },
        [&](int now) { number[now] = count; });
    ++count;
  }
  return number;
}

/// Leaves out slivers between surfaces that nearly coincide; returns the number of shells that stay.
int drop_flat_shells(double size, TriangleSoup& soup) {
  int count = 0;
  const std::vector<int> number = shell_numbers(soup, count);
  std::vector<TriangleSoup> shells(static_cast<std::size_t>(count));
  for (std::size_t t = 0; t < number.size(); ++t) shells[number[t]].triangles.push_back(soup.triangles[t]);
  std::vector<char> is_flat;
  for (TriangleSoup& shell : shells) {
    shell.points.swap(soup.points);
    is_flat.push_back(std::abs(shell.signed_volume()) <= no_thickness * size * area(shell));
    shell.points.swap(soup.points);
  }
  std::vector<char> kept;
  for (const int n : number) kept.push_back(!is_flat[n]);
  soup.keep(kept);
  return static_cast<int>(std::count(is_flat.begin(), is_flat.end(), char{0}));
}

/// Unites shells whose boxes meet, cut along all crossings, without cavities. Where rounding leaves crossings or
/// needles it is cut again, merging points a little farther apart.
TriangleSoup unite(const std::vector<const Shell*>& solids, const std::vector<const Shell*>& cavities, double size,
                   const std::string& file, SurfaceRepair& repair) {
  TriangleSoup outer = joined(solids), hollows = joined(cavities), body;
  turn_over(hollows);
  int shells = 0;
  double distance = rounding_distance * size;
  for (int pass = 0; pass < max_passes; ++pass, distance *= 10) {
    body = outer_boundary(outer, hollows, distance);
    shells = drop_flat_shells(size, body);
    if (body.triangles.empty()) break;
    outer = body;
    hollows = {};
    try {
      check_separated(outer, file);
      break;
    } catch (const InputError&) {  // what the check has removed stays away
    }
  }
  repair.united += std::max(0, static_cast<int>(solids.size() + cavities.size()) - shells);
  return body;
}

/// Numbers of the groups of shells whose boxes meet.
std::vector<int> find_groups(const std::vector<Shell>& shells) {
  std::vector<int> group(shells.size());
  std::iota(group.begin(), group.end(), 0);
  for (std::size_t a = 0; a < shells.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (group[a] != group[b] && shells[a].box.intersects(shells[b].box)) {
        const int from = std::max(group[a], group[b]), to = std::min(group[a], group[b]);
        std::replace(group.begin(), group.end(), from, to);
      }
  return group;
}

/// Marks what was not in the file, measures how far from the old surface it is.
void compare(const TriangleSoup& old, TriangleSoup& soup, SurfaceRepair& repair) {
  TriangleSoup both;
  both.points = old.points;
  both.points.insert(both.points.end(), soup.points.begin(), soup.points.end());
  both.triangles = old.triangles;
  for (Triangle t : soup.triangles) {
    for (int& p : t) p += static_cast<int>(old.points.size());
    both.triangles.push_back(t);
  }
  merge_equal_points(both);
  std::vector<std::pair<Triangle, int>> order;  // old ones first among equals
  for (std::size_t t = 0; t < both.triangles.size(); ++t) {
    std::sort(both.triangles[t].begin(), both.triangles[t].end());
    order.emplace_back(both.triangles[t], static_cast<int>(t));
  }
  std::sort(order.begin(), order.end());
  const int num_old = static_cast<int>(old.triangles.size());
  repair.is_new.assign(soup.triangles.size(), 1);
  soup.number.assign(soup.triangles.size(), 0);
  std::vector<char> kept(old.triangles.size(), 0);
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (order[i].second >= num_old) continue;
    for (std::size_t j = i + 1; j < order.size() && order[j].first == order[i].first; ++j) {
      if (order[j].second < num_old) continue;
      const int t = order[j].second - num_old;
      repair.is_new[t] = 0;
      soup.number[t] = old.number.empty() ? order[i].second + 1 : old.number[order[i].second];
      kept[order[i].second] = 1;
    }
  }
  repair.new_triangles = static_cast<int>(std::count(repair.is_new.begin(), repair.is_new.end(), char{1}));
  repair.gone_triangles = static_cast<int>(std::count(kept.begin(), kept.end(), char{0}));
  const TriangleSurface surface(old.points, old.triangles, std::vector<int>(old.triangles.size(), 0), {""});
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    if (!repair.is_new[t]) continue;
    const Triangle& c = soup.triangles[t];
    const Vec3 centre = (soup.points[c[0]] + soup.points[c[1]] + soup.points[c[2]]) / 3;
    for (const Vec3& x : {soup.points[c[0]], soup.points[c[1]], soup.points[c[2]], centre})
      repair.distance = std::max(repair.distance, surface.nearest(x).distance);
  }
}

}  // namespace

SurfaceRepair repair_surface(TriangleSoup& soup, const std::string& file) {
  SurfaceRepair repair;
  repair.merged_points = merge_equal_points(soup);
  soup.drop_collapsed();
  if (soup.triangles.empty()) fail(file, "no triangle has an area");
  const TriangleSoup old = soup;
  const double size = soup.diagonal();
  repair.volume_before = soup.signed_volume();
  repair.area_before = area(soup);
  repair.merged_points += merge_rims(soup);

  std::vector<Shell> shells = close_shells(soup, file, repair);
  const auto flat = std::remove_if(shells.begin(), shells.end(), [&](const Shell& shell) {
    return std::abs(shell.volume) <= no_thickness * size * area(shell.soup);
  });
  repair.lost = static_cast<int>(shells.end() - flat);
  shells.erase(flat, shells.end());
  if (shells.empty()) fail(file, "it encloses no volume");
  for (Shell& shell : shells) {
    shell.crosses = !find_crossings(shell.soup.points, shell.soup.triangles).empty();
    repair.untangled += shell.crosses;
  }
  double total = 0;
  for (const Shell& shell : shells) total += shell.volume;
  const auto turn = [&](Shell& shell) {
    turn_over(shell.soup);
    shell.volume = -shell.volume;
    repair.turned += static_cast<int>(shell.soup.triangles.size());
  };
  for (Shell& shell : shells)
    if (total < 0) turn(shell);
  for (Shell& shell : shells) {
    const bool in_another = std::any_of(shells.begin(), shells.end(), [&](const Shell& other) {
      return &other != &shell && other.volume > 0 && other.box.contains(shell.box);
    });
    if (shell.volume < 0 && (!in_another || !shell.one_way)) turn(shell);
  }

  const std::vector<int> group = find_groups(shells);
  soup = {};
  for (int g = 0; g < static_cast<int>(shells.size()); ++g) {
    std::vector<const Shell*> solids, cavities;
    for (std::size_t s = 0; s < shells.size(); ++s)
      if (group[s] == g) (shells[s].volume > 0 ? solids : cavities).push_back(&shells[s]);
    if (solids.size() + cavities.size() == 1 && !shells[g].crosses) {
      append(shells[g].soup, soup);
    } else if (!solids.empty()) {
      append(unite(solids, cavities, size, file, repair), soup);
    }
  }
  bool crowded = false;
  each_edge(soup.triangles, soup.points.size(),
            [&](const std::vector<EdgeUse>& uses) { crowded = crowded || uses.size() > 2; });
  if (crowded) separate_where_touching(soup);
  if (soup.triangles.empty()) fail(file, "nothing is left of it");
  repair.volume_after = soup.signed_volume();
  repair.area_after = area(soup);
  compare(old, soup, repair);
  return repair;
}

}  // namespace cgcontact
