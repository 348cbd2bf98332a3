#include "contact/motions/statics.hpp"

#include <Eigen/Eigenvalues>

#include "contact/motions/rigid_motion.hpp"

namespace cgcontact {
namespace {

/// Of squares: motions that resist or miss by less than that count as none, rounding is far below.
constexpr double tolerance = 1e-10;

/// Least squares for the motion of all bodies, a sum over points: row . motion = value.
struct LeastSquares {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  double square = 0;  // of the values
  explicit LeastSquares(Eigen::Index size)
      : matrix(Eigen::MatrixXd::Zero(size, size)), right(Eigen::VectorXd::Zero(size)) {}
  void add(const Eigen::VectorXd& row, double weight, double value) {
    matrix += weight * row * row.transpose();
    right += weight * value * row;
    square += weight * value * value;
  }
  /// Part of the values' square that no motion meets.
  double missed() const {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
    double met = 0;
    for (Eigen::Index k = 0; k < matrix.rows(); ++k)
      if (eigen.eigenvalues()[k] > tolerance * eigen.eigenvalues().maxCoeff())
        met += std::pow(eigen.eigenvectors().col(k).dot(right), 2) / eigen.eigenvalues()[k];
    return square > 0 ? 1 - met / square : 1;
  }
};

Eigen::VectorXd row_of(const RigidPieces& pieces, const SupportPoint& p, const Vec3& x) {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(pieces.list.size()));
  row.segment<6>(6 * p.body) = pieces.list[p.body].row(x, p.direction);
  return row;
}

/// Of the relative motion along the normal, of the primary body less the secondary one.
Eigen::VectorXd row_of(const RigidPieces& pieces, const ContactPair& pair, const ContactPoint& q) {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(pieces.list.size()));
  row.segment<6>(6 * pair.primary) = pieces.list[pair.primary].row(q.x, q.normal);
  row.segment<6>(6 * pair.secondary) -= pieces.list[pair.secondary].row(q.x, q.normal);
  return row;
}

}  // namespace

bool force_follows_from_loads(const Scene& scene, const std::vector<BodyModel>& bodies,
                              const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs,
                              int pair, const Vec3& direction) {
  const RigidPieces pieces = whole_bodies(bodies);
  LeastSquares system(6 * static_cast<Eigen::Index>(pieces.list.size()));
  // Every support and every pair counts alike, however small its area is.
  std::vector<double> support_area(scene.supports.size(), 0);
  for (const SupportPoint& p : supports)
    if (p.support >= 0) support_area[p.support] += p.weight;
  for (const SupportPoint& p : supports)
    if (p.support >= 0)
      system.add(row_of(pieces, p, global_position(bodies[p.body].cut_cells, p.cell, p.xi)),
                 p.weight / support_area[p.support], 0);
  for (int k = 0; k < static_cast<int>(pairs.size()); ++k) {
    double area = 0;
    for (const ContactPoint& q : pairs[k].points) area += q.active ? q.weight : 0;
    for (const ContactPoint& q : pairs[k].points)
      if (q.active) system.add(row_of(pieces, pairs[k], q), q.weight / area, k == pair ? q.normal.dot(direction) : 0);
  }
  return system.missed() < tolerance;
}

}  // namespace cgcontact
