#include "core/scene/face_traction.hpp"

#include <Eigen/Eigenvalues>

#include "core/base/errors/errors.hpp"
#include "core/base/numbers/decompositions.hpp"

namespace cgcontact {
namespace {

/// Fraction of the largest moment of inertia of a face: one whose smallest is less is a line.
constexpr double narrowest = 1e-10;
/// Fraction of the force times the extent of the face below which there is no moment.
constexpr double no_moment = 1e-14;
/// Mean squares of the cosines between normals and the axis of a cylinder (coordinates of triangles in single
/// precision), and between normals and the plane that most of them lie in: a flat face has no axis.
constexpr double across = 1e-6, flat = 1e-4;
/// Mean square of the distances between normals and axis, of that of the points: facets of a twelfth of a turn have
/// 0.02, the four sides of a square 0.25.
constexpr double round = 0.05;
/// Fraction of a bearing's force that may be left across it: by the quadrature, or because the face ends (symmetry).
constexpr double whole = 0.02;
/// Fraction of the force within which Newton's iteration balances it.
constexpr double exact = 1e-14;

}  // namespace

void FaceMoments::add(const Vec3& x, const Vec3& n, double area) {
  if (points_.empty()) origin_ = x;
  const Vec3 r = x - origin_, tangential = r - r.dot(n) * n;
  area_ += area;
  first_ += area * r;
  second_ += area * r * r.transpose();
  normals_ += area * n * n.transpose();
  across_ += area * tangential;
  square_ += area * tangential.squaredNorm();
  points_.emplace_back(n, area);
}

FaceTraction FaceMoments::with_resultants(const Vec3& force, const Vec3& moment, const Vec3& at) const {
  FaceTraction traction;
  traction.centre = centroid();
  traction.constant = force / area_;
  Vec3 about_centre = moment + (at - traction.centre).cross(force);
  const Mat3 second = second_ - first_ * first_.transpose() / area_;
  if (across_plane_) {
    const Vec3 axis = Vec3::Unit(*across_plane_);
    if (!moment.cross(axis).isZero(0)) throw InputError("in plane strain a moment acts about that axis alone");
    about_centre = about_centre.dot(axis) * axis;
  }
  if (about_centre.norm() <= no_moment * force.norm() * std::sqrt(second.trace() / area_)) return traction;
  const Mat3 inertia = second.trace() * Mat3::Identity() - second;
  if (across_plane_) {
    const double about_axis = inertia(*across_plane_, *across_plane_);
    if (!(about_axis > 0)) throw InputError("the face is a point: no traction on it has a moment");
    traction.spin = about_centre / about_axis;
    return traction;
  }
  const SymmetricEigen<3> solver(inertia);
  if (!(solver.eigenvalues()[0] > narrowest * solver.eigenvalues()[2]))
    throw InputError("the face is a line: no traction on it has a moment about it");
  traction.spin =
      solver.eigenvectors() * (solver.eigenvectors().transpose() * about_centre).cwiseQuotient(solver.eigenvalues());
  return traction;
}

/// The axis is across all normals, at the point that the lines along the normals pass: least squares of
/// |(I - n n^T)(x - p)|.
std::optional<Axis> FaceMoments::axis() const {
  const SymmetricEigen<3> solver(normals_ / area_);
  if (solver.eigenvalues()[0] > across || solver.eigenvalues()[1] < flat) return {};
  Axis axis;
  axis.direction = solver.eigenvectors().col(0);
  const Mat3 tangents = area_ * Mat3::Identity() - normals_;
  const Vec3 p = tangents.ldlt().solve(across_);
  axis.point = origin_ + p;
  // Squares of what the normals miss the axis by, and of the distances from it, without what lies along it.
  const Mat3 about_p = second_ - first_ * p.transpose() - p * first_.transpose() + area_ * p * p.transpose();
  const double along = axis.direction.dot(about_p * axis.direction);
  const double missed = square_ - p.dot(across_) - along, distances = about_p.trace() - along;
  if (!(missed < round * distances)) return {};
  return axis;
}

std::pair<Vec3, Mat3> FaceMoments::pressed(const Vec3& slope) const {
  Mat3 derivative = Mat3::Zero();
  for (const auto& [n, area] : points_)
    if (n.dot(slope) < 0) derivative += area * n * n.transpose();
  return {derivative * slope, derivative};
}

FaceTraction FaceMoments::with_bearing(const Vec3& force) const {
  const std::optional<Axis> axis = this->axis();
  if (!axis) throw InputError("the face is no cylinder, which a bearing's pressure acts on");
  constexpr double along_axis = 1e-6;
  if (std::abs(axis->direction.dot(force)) > along_axis * force.norm())
    throw InputError("the force has a part along the axis of the cylinder, which no pressure has");
  FaceTraction traction;
  const Vec3 direction = force.normalized();
  const Vec3 sum = pressed(direction).first;
  if (!(sum.dot(direction) > 0)) throw InputError("no part of the face faces the force");
  traction.bearing = force / sum.dot(direction);
  const auto rest = [&](const Vec3& f) { return Vec3(f - f.dot(axis->direction) * axis->direction); };
  if ((sum - sum.dot(direction) * direction).norm() > whole * sum.norm()) return traction;
  // Newton's iteration removes what the quadrature leaves across the force; the derivative jumps at points without
  // pressure only.
  constexpr int max_steps = 20;
  for (int step = 0; step < max_steps; ++step) {
    const auto [now, derivative] = pressed(traction.bearing);
    const Vec3 missing = rest(force - now);
    if (missing.norm() <= exact * force.norm()) break;
    const Mat3 regular = derivative + area_ * axis->direction * axis->direction.transpose();
    traction.bearing += rest(regular.ldlt().solve(missing));
  }
  return traction;
}

}  // namespace cgcontact
