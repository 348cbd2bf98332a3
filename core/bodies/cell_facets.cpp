#include "core/bodies/cell_facets.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/bodies/leaf_regions.hpp"
#include "core/quadrature/point_compression.hpp"
#include "core/quadrature/region_quadrature.hpp"

namespace cgcontact {

namespace {

constexpr double half_diagonal = 0.87;  // of a cube of width 1

/// By how much a surface turns in a leaf.
double turn_in(const Leaf& leaf, int surface) {
  const Vec3 middle = leaf.corner + Vec3::Constant(0.5 * leaf.width);
  return leaf.solid->surfaces()[surface].max_curvature(middle, half_diagonal * leaf.width) * leaf.width;
}

/// Gauss points per direction that make all moments of a leaf accurate to about 1e-12, or 1e-10 on coarse grids.
int moment_nodes(const Leaf& leaf) {
  double turn = 0;
  for (const int surface : leaf.local.surfaces) turn = std::max(turn, turn_in(leaf, surface));
  return turn < 0.1 ? 10 : turn < 0.2 ? 12 : turn < 0.35 ? 14 : turn < 0.5 ? 16 : 20;
}

void add_face_moments(const Leaf& leaf, const Vec3& cell, std::vector<RegionPoint>& points, Moments& moments) {
  constexpr int n = moment_degree + 1;
  const Region region = face_region(leaf, 0);
  const Leaf::Frame frame = leaf.frame(0);
  points.clear();
  integrate_region(region, {2 * moment_degree, n, moment_nodes(leaf) + 2}, points);
  for (const RegionPoint& p : points) {
    double ly[n], lz[n];
    const Vec3 x = frame.origin - cell + frame.axes * Vec3(p.s, p.t, 0);
    legendre_values(2 * x[1] - 1, ly);
    legendre_values(2 * x[2] - 1, lz);
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) moments[j * n + k] += 8 * p.weight * ly[j] * lz[k];
  }
}

void add_facet_moments(const Leaf& leaf, int i, const Vec3& cell, std::vector<RegionPoint>& points, Moments& moments) {
  constexpr int n = moment_degree + 1;
  const LeafFacet facet(leaf, i);
  if (facet.is_plane() && facet.plane_normal()[0] == 0) return;
  points.clear();
  const int nodes = moment_nodes(leaf);
  const RegionRule plane_rule{3 * moment_degree + 1, 7, nodes + 2};
  const RegionRule curved_rule{2 * nodes - 1, nodes, nodes + 2};
  integrate_region(facet.region(), facet.is_plane() ? plane_rule : curved_rule, points);
  for (const RegionPoint& p : points) {
    const SurfacePoint x = facet.at(p.s, p.t);
    double ax[n], ly[n], lz[n];
    legendre_integrals(2 * (x.position[0] - cell[0]) - 1, ax);
    legendre_values(2 * (x.position[1] - cell[1]) - 1, ly);
    legendre_values(2 * (x.position[2] - cell[2]) - 1, lz);
    add_product(moments, 4 * p.weight * p.value * x.stretch * x.normal[0], ax, ly, lz);
  }
}

/// The normals of a cone are no polynomials.
void add_normals(const std::vector<SurfacePoint>& points, FunctionTable& functions) {
  for (int k = 0; k < 3; ++k, ++functions.num_functions)
    for (const SurfacePoint& point : points) functions.values.push_back(point.normal[k]);
}

/// Appends the points of one group in a facet (those of one side of every divider), with as few points as the degree
/// needs.
void add_group(const LeafFacet& facet, const RegionPoint* begin, const RegionPoint* end, int order, int surface,
               int owner, bool with_facets, BoundaryPoints& points) {
  const int n = static_cast<int>(end - begin);
  const bool curved = !facet.is_plane();
  const int degree = curved ? std::max(1, order + 1) : 2 * order - 1;
  const int normals = facet.is_cone() ? 3 : 0;
  const int needed = normals + (curved ? (degree + 1) * (degree + 1) : (degree + 1) * (degree + 2) / 2);
  std::vector<SurfacePoint> all;
  std::vector<double> weights, local[3];
  for (int i = 0; i < n; ++i) {
    all.push_back(facet.at(begin[i].s, begin[i].t));
    weights.push_back(begin[i].weight * all[i].stretch);
    local[0].push_back(begin[i].s);
    local[1].push_back(begin[i].t);
    local[2].push_back(curved ? facet.region().graph.height(begin[i].s, begin[i].t) : 0.0);
  }
  const double area = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (area < lost_group) return;
  Vec3 mean_position = Vec3::Zero(), mean_normal = Vec3::Zero();
  for (int i = 0; with_facets && i < n; ++i) {
    mean_position += weights[i] / area * all[i].position;
    mean_normal += weights[i] / area * begin[i].value * all[i].normal;
  }
  if (n > needed) {
    FunctionTable functions = surface_polynomials(local, degree, curved);
    if (facet.is_cone()) add_normals(all, functions);
    compress_weights(functions, weights);
  }
  for (int i = 0; i < n; ++i) {
    if (!(weights[i] > 0)) continue;
    points.append(all[i].position, begin[i].value * all[i].normal, weights[i], owner, surface);
    if (with_facets) points.set_facet(mean_position, mean_normal);
  }
}

/// Gauss points per direction beyond the order before compression: area to about 1e-9 in every facet.
int extra_nodes(double turn) { return turn < 0.15 ? 2 : turn < 0.3 ? 3 : turn < 0.45 ? 6 : turn < 0.7 ? 11 : 13; }

void add_facet_points(const Leaf& leaf, int i, int order, int owner, bool with_facets, BoundaryPoints& points) {
  static thread_local std::vector<RegionPoint> region_points;
  const LeafFacet facet(leaf, i);
  const int fine = order + extra_nodes(turn_in(leaf, leaf.local.surfaces[i]));
  region_points.clear();
  const RegionRule plane_rule{2 * order - 1, order, order + 4};
  const RegionRule curved_rule{2 * fine - 1, fine, fine};
  integrate_region(facet.region(), facet.is_plane() ? plane_rule : curved_rule, region_points);
  auto key = [](const RegionPoint& p) { return std::make_pair(p.value, p.mask); };
  std::stable_sort(region_points.begin(), region_points.end(),
                   [&](const RegionPoint& a, const RegionPoint& b) { return key(a) < key(b); });
  const RegionPoint* const end = region_points.data() + region_points.size();
  for (const RegionPoint *begin = region_points.data(), *next = begin; begin != end; begin = next) {
    while (next != end && key(*next) == key(*begin)) ++next;
    add_group(facet, begin, next, order, leaf.local.surfaces[i], owner, with_facets, points);
  }
}

/// Removes the facets (points from `first` on) whose area is rounding.
void drop_lost_facets(const LocalSolid& local, std::size_t first, BoundaryPoints& points) {
  for (const int surface : local.surfaces) {
    double area = 0;
    for (std::size_t i = first; i < points.size(); ++i)
      if (points.surface[i] == surface) area += points.weight[i];
    if (area == 0 || area > lost_facet) continue;
    BoundaryPoints kept;
    for (std::size_t i = first; i < points.size(); ++i)
      if (points.surface[i] != surface) kept.append(points, i, points.cell[i]);
    points.truncate(first);
    for (std::size_t i = 0; i < kept.size(); ++i) points.append(kept, i, kept.cell[i]);
  }
}

}  // namespace

Moments cell_moments(const CsgBody& solid, const LocalSolid& local, const Index3& cell) {
  static thread_local std::vector<RegionPoint> points;
  Moments moments{};
  const Vec3 corner(cell[0], cell[1], cell[2]);
  for_each_leaf(solid, local, corner, {}, [&](const Leaf& leaf) {
    if (leaf.corner[0] + leaf.width == corner[0] + 1) add_face_moments(leaf, corner, points, moments);
    for (std::size_t i = 0; i < leaf.local.surfaces.size(); ++i)
      add_facet_moments(leaf, static_cast<int>(i), corner, points, moments);
  });
  return moments;
}

void cell_boundary_points(const CsgBody& solid, const LocalSolid& local, const Index3& cell,
                          const std::vector<char>& selected, const std::vector<Plane>& dividers, int order, int owner,
                          BoundaryPoints& points) {
  const Vec3 corner(cell[0], cell[1], cell[2]);
  const std::size_t first = points.size();
  const bool with_facets = divide_faces(dividers);
  for_each_leaf(solid, local, corner, dividers, [&](const Leaf& leaf) {
    for (std::size_t i = 0; i < leaf.local.surfaces.size(); ++i) {
      if (!selected.empty() && !selected[leaf.local.surfaces[i]]) continue;
      add_facet_points(leaf, static_cast<int>(i), order, owner, with_facets, points);
    }
  });
  drop_lost_facets(local, first, points);
}

}  // namespace cgcontact
