#include "recovery/constrained/boundary_facets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/process/parallel.hpp"
#include "core/geometry/solid_middle.hpp"
#include "recovery/patch/cells_in_box.hpp"

namespace cgcontact {
namespace {

/// Facets smaller than this (standard deviation, cells of the patch) get one constraint point along that direction: a
/// stretch of 0.1 cells, below which three points differ by less than the fit resolves.
constexpr double min_spread = 0.1 / 3.4641016151377544;

/// On a flat contact face the points are spread at least this much, so that an open face is free of traction on its
/// whole plane however small the facet in the patch is.
constexpr double min_contact_spread = 0.1;

/// Weights for the direction of a tangent seen from the middle of the body: a scaled space, since those of a ball are
/// at right angles to the way there. Less than this (cells): neither.
const Vec3 uneven(1, 2, 3);
constexpr double same_position = 1e-6;

/// Facets of a patch that stay as they are, whatever their number; with more, those below a share of the patch's area
/// are joined where their normals are near to each other.
constexpr std::size_t max_facets = 12;
constexpr double own_share = 1.0 / 8;
/// Cosine of 60 degrees: at most 12 directions are that far apart.
constexpr double joined_cosine = 0.5;

template <int count>
std::array<Eigen::Vector2d, count> points_on_circle(double radius) {
  std::array<Eigen::Vector2d, count> points;
  for (int i = 0; i < count; ++i) {
    const double t = pi / 2 + i * 2 * pi / count;
    points[i] = radius * Eigen::Vector2d(std::cos(t), std::sin(t));
  }
  return points;
}

/// Returns the width (grid coordinates) that rounding leaves of a face which another one touches tangentially (the
/// bottom of the box that cuts a quarter out of a ball): where a circle of the body's size D is within its rounding of
/// its tangent, sqrt(8 D (10 eps D)). Such a strip is no face.
double width_of_rounding(const Solid& solid) {
  Vec3 min, max;
  if (!solid.bounding_box(min, max)) return 0;
  return std::sqrt(80 * std::numeric_limits<double>::epsilon()) * (max - min).norm();
}

Vec3 project(const Surface& surface, const Vec3& x) { return x - surface.signed_distance(x) * surface.gradient(x); }

}  // namespace

BoundaryFacets::BoundaryFacets(const CutCells& cut_cells, const BoundaryData& boundary)
    : cut_cells_(cut_cells),
      middle_(middle_of(cut_cells.solid)),
      width_of_rounding_(width_of_rounding(cut_cells.solid)) {
  const std::vector<int>&cell = cut_cells.boundary.cell, &active = cut_cells.active_of_cut;  // ascending, both
  std::vector<std::vector<Facet>> chunks(num_chunks(active.size(), grain_of_medium));
  begin_.assign(active.size() + 1, 0);
  parallel_chunks("cgcontact::boundary_pieces::sums", active.size(), grain_of_medium,
                  [&](std::size_t chunk, std::size_t first, std::size_t last) {
                    auto end = std::lower_bound(cell.begin(), cell.end(), active[first]);
                    for (std::size_t cut = first; cut < last; ++cut) {
                      const auto begin = std::lower_bound(end, cell.end(), active[cut]);
                      end = begin;
                      while (end != cell.end() && *end == active[cut]) ++end;
                      const std::size_t before = chunks[chunk].size();
                      add_cell(boundary, begin - cell.begin(), end - cell.begin(), chunks[chunk]);
                      begin_[cut + 1] = static_cast<int>(chunks[chunk].size() - before);
                    }
                  });
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  facets_.reserve(begin_.back());
  for (const std::vector<Facet>& chunk : chunks) facets_.insert(facets_.end(), chunk.begin(), chunk.end());
}

/// Appends the facets of the points begin .. end, those of one cell.
void BoundaryFacets::add_cell(const BoundaryData& boundary, std::size_t begin, std::size_t end,
                              std::vector<Facet>& facets) const {
  const BoundaryPoints& points = cut_cells_.boundary;
  const std::size_t first = facets.size();
  std::size_t latest = first;  // points of a facet mostly come one after the other
  const auto facet_of = [&](std::size_t p) -> Facet& {
    const std::array<int, 3> kind{points.surface[p], boundary.condition_of_point[p], boundary.pair_of_point[p]};
    if (latest < facets.size() && facets[latest].kind() == std::tie(kind[0], kind[1], kind[2])) return facets[latest];
    for (std::size_t i = first; i < facets.size(); ++i)
      if (facets[i].kind() == std::tie(kind[0], kind[1], kind[2])) return facets[latest = i];
    latest = facets.size();
    facets.push_back({kind[0], kind[1], kind[2]});
    return facets.back();
  };
  for (std::size_t p = begin; p < end; ++p) {
    Facet& facet = facet_of(p);
    facet.area += points.weight[p];
    facet.centroid += points.weight[p] * points.position[p];
    facet.normal += points.weight[p] * points.normal[p];
  }
  for (std::size_t i = first; i < facets.size(); ++i) facets[i].centroid /= facets[i].area;
  for (std::size_t p = begin; p < end; ++p) {
    Facet& facet = facet_of(p);
    const Vec3 d = points.position[p] - facet.centroid;
    facet.second += points.weight[p] * d * d.transpose();
  }
}

void BoundaryFacets::join(Facet& whole, const Facet& facet) {
  const double area = whole.area + facet.area;
  const Vec3 d = facet.centroid - whole.centroid;
  whole.second += facet.second + (whole.area * facet.area / area) * d * d.transpose();
  whole.centroid += facet.area / area * d;
  whole.normal += facet.normal;
  whole.area = area;
}

/// Puts points on the surface with the group's area moments up to degree 2: for a linear traction three on a circle,
/// c + sqrt(2) F (cos t, sin t) with F F^T the covariance in the tangent plane, for a quadratic one the centre and five
/// on a circle of sqrt(12/5) (no conic passes through all six). F is the Cholesky factor in a fixed frame, which
/// depends continuously on the group (principal axes would not, for square facets). Strips: two or three points on a
/// line. The tangents point from the middle of the body to the patch, so that mirror images have mirrored points.
void BoundaryFacets::put_points(const Facet& g, const Vec3& patch, const Surface& surface, int degree, double unit,
                                ConstraintGroup& group) const {
  auto [t1, t2] = tangents(g.normal.normalized());
  for (Vec3* t : {&t1, &t2})
    if (t->dot(uneven.cwiseProduct(patch - middle_)) < -same_position) *t = -*t;
  Eigen::Matrix2d covariance;
  covariance << t1.dot(g.second * t1), t1.dot(g.second * t2), t2.dot(g.second * t1), t2.dot(g.second * t2);
  covariance /= g.area;
  if (group.pair >= 0 && surface.kind == Surface::Kind::plane)
    covariance += min_contact_spread * min_contact_spread * unit * unit * Eigen::Matrix2d::Identity();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeDirect(covariance);
  const Eigen::Vector2d spread = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
  Eigen::Vector2d offsets[6];
  int count = 0;
  if (degree == 0 || spread[1] < min_spread * unit) {
    offsets[count++].setZero();
  } else if (spread[0] < min_spread * unit) {
    const Eigen::Vector2d along = spread[1] * eigen.eigenvectors().col(1);
    const double reach = degree == 1 ? 1 : std::sqrt(1.5);
    offsets[count++] = -reach * along;
    offsets[count++] = reach * along;
    if (degree == 2) offsets[count++].setZero();
  } else {
    const Eigen::Matrix2d factor = covariance.llt().matrixL();
    static const auto three = points_on_circle<3>(std::sqrt(2.0));
    static const auto five = points_on_circle<5>(std::sqrt(2.4));
    if (degree == 1)
      for (const Eigen::Vector2d& at : three) offsets[count++] = factor * at;
    else
      for (const Eigen::Vector2d& at : five) offsets[count++] = factor * at;
    if (degree == 2) offsets[count++].setZero();
  }
  for (int i = 0; i < count; ++i) {
    const Vec3 near = g.centroid + offsets[i][0] * t1 + offsets[i][1] * t2;
    if (g.is_rough) {
      group.position[i] = near;
      group.normal[i] = g.normal.normalized();
      continue;
    }
    const Vec3 x = surface.kind == Surface::Kind::patch ? project(surface.near(near), near) : project(surface, near);
    Vec3 n = surface.gradient(x);
    if (n.dot(g.normal) < 0) n = -n;
    group.position[i] = x;
    group.normal[i] = n;
  }
  group.num_points = count;
}

/// A rough surface (a scan, a knurl) has more small faces in a patch than the patch has unknowns: they act like their
/// mean planes, over which the force is that of all of them.
void BoundaryFacets::join_small(std::vector<Facet>& wholes) {
  if (wholes.size() <= max_facets) return;
  double area = 0;
  for (const Facet& facet : wholes) area += facet.area;
  std::stable_sort(wholes.begin(), wholes.end(), [](const Facet& a, const Facet& b) { return a.area > b.area; });
  struct Joined {
    Facet facet;
    Vec3 direction;  ///< of its largest facet
  };
  std::vector<Joined> joined;
  std::vector<Facet> kept;
  for (const Facet& facet : wholes) {
    if (facet.area >= own_share * area) {
      kept.push_back(facet);
      continue;
    }
    const Vec3 direction = facet.normal.normalized();
    const auto like = std::find_if(joined.begin(), joined.end(), [&](const Joined& j) {
      return j.facet.condition == facet.condition && j.facet.pair == facet.pair &&
             j.direction.dot(direction) > joined_cosine;
    });
    if (like == joined.end()) {
      joined.push_back({facet, direction});
    } else {
      join(like->facet, facet);
      like->facet.is_rough = true;
    }
  }
  for (const Joined& j : joined) kept.push_back(j.facet);
  wholes.swap(kept);
}

void BoundaryFacets::groups(const int* cells, int num_cells, int degree, std::vector<ConstraintGroup>& groups,
                            double unit) const {
  static thread_local std::vector<Facet> wholes;
  wholes.clear();
  for (int c = 0; c < num_cells; ++c) {
    const int cut = cut_cells_.cut_of_active[cells[c]];
    if (cut < 0) continue;
    for (int i = begin_[cut]; i < begin_[cut + 1]; ++i) {
      const Facet& facet = facets_[i];
      if (!(facet.area > 0)) continue;
      const auto whole = std::lower_bound(wholes.begin(), wholes.end(), facet,
                                          [](const Facet& a, const Facet& b) { return a.kind() < b.kind(); });
      if (whole != wholes.end() && whole->kind() == facet.kind())
        join(*whole, facet);
      else
        wholes.insert(whole, facet);
    }
  }
  wholes.erase(std::remove_if(wholes.begin(), wholes.end(),
                              [&](const Facet& facet) { return facet.area < width_of_rounding_ * unit; }),
               wholes.end());
  join_small(wholes);
  Vec3 middle_of_patch = Vec3::Zero();  // not of the facets: declared faces cut these
  for (int c = 0; c < num_cells; ++c) middle_of_patch += middle_of_cell(cut_cells_, cells[c]) / num_cells;
  groups.assign(wholes.size(), {});
  for (std::size_t i = 0; i < wholes.size(); ++i) {
    std::tie(groups[i].surface, groups[i].condition, groups[i].pair) = wholes[i].kind();
    groups[i].area = wholes[i].area;
    put_points(wholes[i], middle_of_patch, cut_cells_.solid.surfaces()[wholes[i].surface],
               wholes[i].is_rough ? std::min(degree, 1) : degree, unit, groups[i]);
  }
}

}  // namespace cgcontact
