#include "core/scene/linear_traction.hpp"

#include <Eigen/Eigenvalues>

#include "core/base/errors.hpp"

namespace cgcontact {
namespace {

/// Of the largest one: a face whose smallest moment of inertia is less is a line.
constexpr double narrowest = 1e-10;
/// Of the force times the extent of the face: less is no moment.
constexpr double no_moment = 1e-14;

}  // namespace

void FaceMoments::add(const Vec3& x, double area) {
  area_ += area;
  first_ += area * x;
  second_ += area * x * x.transpose();
}

LinearTraction FaceMoments::with_resultants(const Vec3& force, const Vec3& moment, const Vec3& at) const {
  LinearTraction traction;
  traction.centre = centroid();
  traction.constant = force / area_;
  const Vec3 about_centre = moment + (at - traction.centre).cross(force);
  const Mat3 second = second_ - area_ * traction.centre * traction.centre.transpose();
  if (about_centre.norm() <= no_moment * force.norm() * std::sqrt(second.trace() / area_)) return traction;
  const Mat3 inertia = second.trace() * Mat3::Identity() - second;
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(inertia);
  if (!(solver.eigenvalues()[0] > narrowest * solver.eigenvalues()[2]))
    throw InputError("the face is a line: no traction on it has a moment about it");
  traction.spin =
      solver.eigenvectors() * (solver.eigenvectors().transpose() * about_centre).cwiseQuotient(solver.eigenvalues());
  return traction;
}

}  // namespace cgcontact
