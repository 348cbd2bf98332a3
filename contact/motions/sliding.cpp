#include "contact/motions/sliding.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/base/decompositions.hpp"

namespace cgcontact {
namespace {

using SlidingMotion = Eigen::Matrix<double, 6, 1>;
using SlidingMatrix = Eigen::Matrix<double, 6, 6>;

/// Fraction of the largest squared sliding, of motions of one size, below which a motion slides nowhere: it lifts or
/// tilts, and works on the pressure.
constexpr double no_sliding = 1e-3;
/// Fraction of the largest speed that points count with at least; change of the ratio that ends the iteration; largest
/// number of steps.
constexpr double min_speed = 1e-6, settled = 1e-6;
constexpr int max_weightings = 100;
/// Points of a ring: motions across the axis and about it work alike on any number above two.
constexpr int points_of_ring = 8;

/// Wrench of a contact and of its image.
Wrench with_image(const Wrench& w, const SymmetryPlane& plane) {
  const Vec3 force = plane.turned(w.force), at = 2 * plane.normal.dot(plane.point) * plane.normal;
  return {w.force + force, w.moment - plane.turned(w.moment) + at.cross(force)};
}

std::vector<FrictionLimit> with_images(std::vector<FrictionLimit> points, const SymmetryPlane& plane) {
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
    points.push_back({plane.image(points[i].x), plane.turned(points[i].normal), points[i].force});
  return points;
}

/// Velocity along the face at a point, of a motion in units of the contact's size.
Vec3 sliding(const FrictionLimit& point, const Vec3& r, const SlidingMotion& motion) {
  const Vec3 v = motion.head<3>() + motion.tail<3>().cross(r);
  return v - point.normal.dot(v) * point.normal;
}

}  // namespace

std::vector<FrictionLimit> around_axis(const std::vector<FrictionLimit>& rings, int axis) {
  std::vector<FrictionLimit> points;
  for (int k = 0; k < points_of_ring; ++k) {
    const Mat3 turn = Eigen::AngleAxisd(2 * pi * k / points_of_ring, Vec3::Unit(axis)).toRotationMatrix();
    for (const FrictionLimit& p : rings) points.push_back({turn * p.x, turn * p.normal, p.force / points_of_ring});
  }
  return points;
}

double use_of_friction(const std::vector<FrictionLimit>& given, const Wrench& of_given,
                       const std::vector<SymmetryPlane>& planes) {
  std::vector<FrictionLimit> points;
  std::copy_if(given.begin(), given.end(), std::back_inserter(points),
               [](const FrictionLimit& p) { return p.force > 0; });
  if (points.empty()) return 0;
  Wrench wrench = of_given;
  for (const SymmetryPlane& plane : planes) {
    points = with_images(std::move(points), plane);
    wrench = with_image(wrench, plane);
  }
  Vec3 centre = Vec3::Zero();
  double all = 0, size = 0;
  for (const FrictionLimit& p : points) {
    centre += p.force * p.x;
    all += p.force;
  }
  centre /= all;
  for (const FrictionLimit& p : points) size = std::max(size, (p.x - centre).norm());
  if (size == 0) return wrench.force.norm() / all;
  SlidingMotion load;
  load << wrench.force, (wrench.moment - centre.cross(wrench.force)) / size;

  // The sum of |v| is the limit of sums of v^2 / |v of the step before|.
  std::vector<double> speed(points.size(), 1.0);
  double use = 0;
  for (int step = 0; step < max_weightings; ++step) {
    const double least = min_speed * *std::max_element(speed.begin(), speed.end());
    SlidingMatrix resisted = SlidingMatrix::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const FrictionLimit& p = points[i];
      const Vec3 r = (p.x - centre) / size;
      Eigen::Matrix<double, 3, 6> along;
      for (int k = 0; k < 6; ++k) along.col(k) = sliding(p, r, SlidingMotion::Unit(k));
      resisted += p.force / std::max(speed[i], least) * along.transpose() * along;
    }
    const SymmetricEigen<6> eigen(resisted);
    SlidingMotion motion = SlidingMotion::Zero();
    for (int k = 0; k < 6; ++k)
      if (eigen.eigenvalues()[k] > no_sliding * eigen.eigenvalues()[5])
        motion += eigen.eigenvectors().col(k).dot(load) / eigen.eigenvalues()[k] * eigen.eigenvectors().col(k);
    double dissipated = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      speed[i] = sliding(points[i], (points[i].x - centre) / size, motion).norm();
      dissipated += points[i].force * speed[i];
    }
    if (!(dissipated > 0)) return use;
    const double before = std::exchange(use, std::max(use, load.dot(motion) / dissipated));
    if (use - before <= settled * use) break;
  }
  return use;
}

}  // namespace cgcontact
