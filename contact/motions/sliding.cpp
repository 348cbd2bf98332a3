#include "contact/motions/sliding.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/base/numbers/decompositions.hpp"

namespace cgcontact {
namespace {

/// Translation, then rotation about the centre of a contact with lengths over its size.
using SlidingMotion = Eigen::Matrix<double, 6, 1>;
using SlidingMatrix = Eigen::Matrix<double, 6, 6>;
/// Velocity of a point along its face, by motion.
using AlongFace = Eigen::Matrix<double, 3, 6>;

/// Mean squared sliding of a motion of size 1 below which it goes along normals, leaning by less than 30 degrees: it
/// lifts, tilts or presses, and works on the pressure.
constexpr double no_sliding = 0.25;
/// Fraction of the largest speed that points count with at least: far below what a point beside the axis of turning
/// has.
constexpr double min_speed = 1e-6;
/// Change of the ratio, relative, that ends the iteration: a figure of three digits. Largest number of steps: points
/// that slide with one motion take one, those around an axis within the contact some ten.
constexpr double settled = 1e-4;
constexpr int max_weightings = 40;

/// Projects onto motions that have the contact's symmetry: along planes and about their normals, along an axis and
/// about it.
SlidingMatrix symmetric_motions(const ContactSymmetry& symmetry) {
  Mat3 along = Mat3::Identity(), about = Mat3::Identity();
  if (symmetry.axis >= 0) along = about = Vec3::Unit(symmetry.axis) * Vec3::Unit(symmetry.axis).transpose();
  for (const SymmetryPlane& plane : symmetry.planes) {
    const Mat3 normal = plane.normal * plane.normal.transpose();
    along -= normal * along;
    about = normal * about;
  }
  SlidingMatrix both = SlidingMatrix::Zero();
  both.topLeftCorner<3, 3>() = along;
  both.bottomRightCorner<3, 3>() = about;
  return both;
}

AlongFace along_face(const FrictionLimit& point, const Vec3& r) {
  AlongFace velocity;
  velocity.leftCols<3>().setIdentity();
  for (int k = 0; k < 3; ++k) velocity.col(3 + k) = Vec3::Unit(k).cross(r);
  return velocity - point.normal * (point.normal.transpose() * velocity);
}

}  // namespace

ContactSymmetry contact_symmetry(const BodySpec& body, std::vector<SymmetryPlane> planes) {
  if (body.plane_strain) planes.push_back({Vec3::Zero(), Vec3::Unit(static_cast<int>(*body.plane_strain))});
  return {std::move(planes), body.axisymmetric() ? body.axis_of_revolution() : -1};
}

double use_of_friction(const std::vector<FrictionLimit>& given, const Wrench& wrench, const ContactSymmetry& symmetry) {
  std::vector<FrictionLimit> points;
  std::copy_if(given.begin(), given.end(), std::back_inserter(points),
               [](const FrictionLimit& p) { return p.force > 0; });
  Vec3 centre = Vec3::Zero();
  double all = 0, square = 0;
  for (const FrictionLimit& p : points) {
    centre += p.force * p.x;
    all += p.force;
  }
  if (!(all > 0)) return 0;
  centre /= all;
  for (const FrictionLimit& p : points) square += p.force * (p.x - centre).squaredNorm();
  if (square == 0) return wrench.force.norm() / all;
  const double size = std::sqrt(square / all);
  SlidingMotion load;
  load << wrench.force, (wrench.moment - centre.cross(wrench.force)) / size;

  // Coordinates are those of the motions along the faces.
  const SlidingMatrix symmetric = symmetric_motions(symmetry);
  std::vector<AlongFace> velocity;
  SlidingMatrix mean = SlidingMatrix::Zero();
  for (const FrictionLimit& p : points) {
    velocity.emplace_back(along_face(p, (p.x - centre) / size) * symmetric);
    mean += p.force / all * velocity.back().transpose() * velocity.back();
  }
  const SymmetricEigen<6> slides(mean);
  Eigen::Index first = 0;
  while (first < 6 && slides.eigenvalues()[first] < no_sliding) ++first;
  if (first == 6) return 0;
  SlidingMatrix to_motions = SlidingMatrix::Zero();
  to_motions.rightCols(6 - first) = slides.eigenvectors().rightCols(6 - first);
  load = to_motions.transpose() * load.eval();
  for (AlongFace& v : velocity) v = v * to_motions.eval();

  // The sum of |v| is the limit of sums of v^2 / |v of the step before|.
  std::vector<double> speed(points.size(), 1.0);
  double use = 0;
  for (int step = 0; step < max_weightings; ++step) {
    const double least = min_speed * *std::max_element(speed.begin(), speed.end());
    SlidingMatrix resisted = SlidingMatrix::Zero();
    for (std::size_t i = 0; i < points.size(); ++i)
      resisted += points[i].force / std::max(speed[i], least) * velocity[i].transpose() * velocity[i];
    for (Eigen::Index k = 0; k < first; ++k) resisted(k, k) = 1;  // no motion
    const SlidingMotion motion = resisted.ldlt().solve(load);
    double dissipated = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      speed[i] = (velocity[i] * motion).norm();
      dissipated += points[i].force * speed[i];
    }
    if (!(dissipated > 0)) return use;
    const double before = std::exchange(use, std::max(use, load.dot(motion) / dissipated));
    if (use - before <= settled * use) break;
  }
  return use;
}

}  // namespace cgcontact
