#include "contact/motions/statics.hpp"

#include "contact/motions/rigid_motion.hpp"
#include "core/base/numbers/decompositions.hpp"

namespace cgcontact {
namespace {

/// Fraction of squares: motions that resist or miss by less count as none, rounding is far below.
constexpr double balance_tolerance = 1e-10;

}  // namespace

/// Least squares for the motion of all bodies, a sum over points: row . motion = value. The matrix is the same for all
/// pairs.
struct Statics::Impl {
  const std::vector<ContactPair>& pairs;
  RigidComponents components;
  std::vector<double> closed_area;  // of each pair
  SymmetricEigen<Eigen::Dynamic> matrix;

  Impl(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
       const std::vector<ContactPair>& all_pairs)
      : pairs(all_pairs), components(whole_bodies(bodies)), closed_area(all_pairs.size(), 0) {
    const Eigen::Index size = 6 * static_cast<Eigen::Index>(bodies.size());
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
    // Every support and every pair counts alike, however small its area is.
    std::vector<double> support_area(scene.supports.size(), 0);
    for (const SupportPoint& p : supports)
      if (p.support >= 0) support_area[p.support] += p.weight;
    for (const SupportPoint& p : supports) {
      if (p.support < 0) continue;
      const RigidMotion row =
          components.list[p.body].row(global_position(bodies[p.body].cut_cells, p.cell, p.xi), p.direction);
      sum.block<6, 6>(6 * p.body, 6 * p.body) += p.weight / support_area[p.support] * row * row.transpose();
    }
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const int first = 6 * pairs[k].primary, second = 6 * pairs[k].secondary;
      for (const ContactPoint& q : pairs[k].points) closed_area[k] += q.active ? q.weight : 0;
      each_row(k, [&](const Vec3&, double weight, const RigidMotion& on_first, const RigidMotion& on_second) {
        sum.block<6, 6>(first, first) += weight * on_first * on_first.transpose();
        sum.block<6, 6>(second, second) += weight * on_second * on_second.transpose();
        sum.block<6, 6>(first, second) += weight * on_first * on_second.transpose();
        sum.block<6, 6>(second, first) += weight * on_second * on_first.transpose();
      });
    }
    matrix = SymmetricEigen<Eigen::Dynamic>(sum);
  }

  /// Calls use(direction, weight, row of the primary body, row of the secondary one) for the relative motions that the
  /// closed points of a pair resist: along their normals, and where friction acts along the face.
  template <class Use>
  void each_row(std::size_t k, const Use& use) const {
    const ContactPair& pair = pairs[k];
    for (std::size_t i = 0; i < pair.points.size(); ++i) {
      const ContactPoint& q = pair.points[i];
      if (!q.active) continue;
      pair.each_direction(i, [&](const Vec3& direction) {
        use(direction, q.weight / closed_area[k], components.list[pair.primary].row(q.x, direction),
            -components.list[pair.secondary].row(q.x, direction));
      });
    }
  }
};

Statics::Statics(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                 const std::vector<ContactPair>& pairs)
    : impl_(std::make_unique<Impl>(scene, bodies, supports, pairs)) {}
Statics::~Statics() = default;

bool Statics::loads_give(int pair, const Vec3& direction) const {
  const ContactPair& p = impl_->pairs[pair];
  const auto& values = impl_->matrix.eigenvalues();
  Eigen::VectorXd right = Eigen::VectorXd::Zero(values.size());
  double square = 0;  // of the work wanted, and what motions meet of it
  impl_->each_row(pair,
                  [&](const Vec3& resisting, double weight, const RigidMotion& on_first, const RigidMotion& on_second) {
                    const double value = resisting.dot(direction);
                    right.segment<6>(6 * p.primary) += weight * value * on_first;
                    right.segment<6>(6 * p.secondary) += weight * value * on_second;
                    square += weight * value * value;
                  });
  double met = 0;
  for (Eigen::Index k = 0; k < values.size(); ++k)
    if (values[k] > balance_tolerance * values.maxCoeff())
      met += std::pow(impl_->matrix.eigenvectors().col(k).dot(right), 2) / values[k];
  return square > 0 && 1 - met / square < balance_tolerance;
}

}  // namespace cgcontact
