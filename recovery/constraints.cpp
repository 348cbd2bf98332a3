#include "recovery/constraints.hpp"

#include <map>
#include <tuple>

namespace cgcontact {
namespace {

/// Voigt index of component (i, j).
constexpr int voigt_index[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/// Pieces smaller than this (standard deviation, cell units) get one constraint point along that direction: a
/// stretch of 0.1 cells, below which three points differ by less than the fit can tell (prototype, section 4).
constexpr double min_spread = 0.1 / 3.4641016151377544;

/// On a flat contact face the points are spread at least this much, so that an open face is free of traction on its
/// whole plane however small the piece in the patch is.
constexpr double min_contact_spread = 0.1;

/// Moments of a group of boundary points.
struct GroupMoments {
  double area = 0;
  Vec3 centroid = Vec3::Zero(), normal = Vec3::Zero();
  Mat3 second = Mat3::Zero();
};

Vec3 project(const Surface& surface, const Vec3& x) { return x - surface.signed_distance(x) * surface.gradient(x); }

/// At most three points on the surface with the same area moments up to degree 2 as the group: c + sqrt(2) F (cos t,
/// sin t) with F F^T the covariance in the tangent plane. F is its Cholesky factor in a fixed frame, which depends
/// continuously on the group (principal axes would not, for square pieces).
void place_points(const GroupMoments& g, const Surface& surface, ConstraintGroup& group) {
  const auto [t1, t2] = tangents(g.normal.normalized());
  Eigen::Matrix2d covariance;
  covariance << t1.dot(g.second * t1), t1.dot(g.second * t2), t2.dot(g.second * t1), t2.dot(g.second * t2);
  if (group.pair >= 0 && surface.kind == Surface::Kind::plane)
    covariance += min_contact_spread * min_contact_spread * Eigen::Matrix2d::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(covariance);
  const Eigen::Vector2d spread = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
  std::vector<Eigen::Vector2d> offsets;
  if (spread[1] < min_spread) {
    offsets = {Eigen::Vector2d::Zero()};
  } else if (spread[0] < min_spread) {
    const Eigen::Vector2d along = spread[1] * eigen.eigenvectors().col(1);
    offsets = {-along, along};
  } else {
    const Eigen::Matrix2d factor = covariance.llt().matrixL();
    for (int i = 0; i < 3; ++i) {
      const double t = M_PI / 2 + i * 2 * M_PI / 3;
      offsets.emplace_back(std::sqrt(2.0) * factor * Eigen::Vector2d(std::cos(t), std::sin(t)));
    }
  }
  for (const Eigen::Vector2d& o : offsets) {
    const Vec3 x = project(surface, g.centroid + o[0] * t1 + o[1] * t2);
    Vec3 n = surface.gradient(x);
    if (n.dot(g.normal) < 0) n = -n;
    group.position.push_back(x);
    group.normal.push_back(n);
  }
}

}  // namespace

std::pair<Vec3, Vec3> tangents(const Vec3& n) {
  // A fixed choice with one threshold: rounding of n does not turn the frame.
  const Vec3 t1 = n.cross(std::abs(n[0]) < 0.9 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
  return {t1, n.cross(t1)};
}

Row24 traction_row(const Vec3& d, const Vec3& n, const Vec3& e) {
  const double p[num_terms] = {1, d[0], d[1], d[2]};
  Row24 row = Row24::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int t = 0; t < num_terms; ++t) row[voigt_index[i][j] * num_terms + t] += e[i] * n[j] * p[t];
  return row;
}

Eigen::Matrix<double, 3, 6 * num_terms> divergence_rows() {
  Eigen::Matrix<double, 3, 6 * num_terms> rows = decltype(rows)::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rows(i, voigt_index[i][j] * num_terms + 1 + j) = 1;
  return rows;
}

std::vector<ConstraintGroup> constraint_groups(const CutCells& cut_cells, const BoundaryData& boundary,
                                               const int* cells, int num_cells) {
  using Key = std::tuple<int, int, int>;  // surface, condition, pair
  std::map<Key, std::vector<int>> members;
  for (int c = 0; c < num_cells; ++c)
    for (int p : boundary.points_of_cell[cells[c]])
      members[{cut_cells.boundary.surface[p], boundary.condition_of_point[p], boundary.pair_of_point[p]}].push_back(p);

  std::vector<ConstraintGroup> groups;
  for (const auto& [key, points] : members) {
    GroupMoments g;
    for (int p : points) {
      const double w = cut_cells.boundary.weight[p];
      g.area += w;
      g.centroid += w * cut_cells.boundary.position[p];
      g.normal += w * cut_cells.boundary.normal[p];
    }
    if (!(g.area > 0)) continue;
    g.centroid /= g.area;
    for (int p : points) {
      const Vec3 d = cut_cells.boundary.position[p] - g.centroid;
      g.second += cut_cells.boundary.weight[p] / g.area * d * d.transpose();
    }
    ConstraintGroup group;
    std::tie(group.surface, group.condition, group.pair) = key;
    group.area = g.area;
    place_points(g, cut_cells.solid.surfaces()[group.surface], group);
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace cgcontact
