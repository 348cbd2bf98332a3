#include "core/drawing/face_chart.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/base/numbers/decompositions.hpp"

namespace cgcontact {

namespace {

/// Eigenvalues of the mean of n n^T: below the first the normals lie in a plane, above the second they spread in it
/// (0.02: an arc of 28 degrees).
constexpr double flat_spread = 1e-3, round_spread = 0.02;
/// Tolerance of the distances of a cylinder's points from the axis, relative to the mean radius.
constexpr double round_tolerance = 0.02;
/// Cosine between the mean normal and a coordinate axis along which the face is seen.
constexpr double along_axis = 0.95;
/// Fraction of the largest component of the mean normal that the one along an axis must be; fraction of the area of a
/// face that may turn away from it (triangles of rounding size at its end).
constexpr double about_as_near = 0.8, turned_away = 0.02;

Vec3 area_normal(const FaceTriangles& face, const std::array<int, 3>& t) {
  const std::vector<Vec3>& x = *face.position;
  return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]) / 2;
}

/// Angle in (-pi, pi].
double wrapped_angle(double a) { return std::remainder(a, 2 * pi); }

/// Middle of the arc that the angles cover: opposite to their largest gap.
double middle_of(std::vector<double> angles) {
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + 2 * pi - angles.back(), start = angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i)
    if (angles[i] - angles[i - 1] > gap) {
      gap = angles[i] - angles[i - 1];
      start = angles[i - 1];
    }
  return wrapped_angle(start + gap / 2 + pi);
}

}  // namespace

FaceChart::FaceChart(const FaceTriangles& face) {
  Mat3 normals = Mat3::Zero();
  Vec3 mean = Vec3::Zero();
  double area = 0;
  for (const auto& t : face.triangles) {
    const Vec3 n = area_normal(face, t);
    const double a = n.norm();
    if (!(a > 0)) continue;
    normals += n * n.transpose() / a;
    mean += n;
    area += a;
  }
  if (area > 0) normals /= area;
  if (unroll(face, normals)) return;
  const Vec3 mean_normal = mean.norm() > 1e-3 * area ? Vec3(mean.normalized()) : Vec3(Vec3::UnitZ());
  int axis = 0;
  if (!(mean_normal.cwiseAbs().maxCoeff(&axis) > along_axis)) axis = axis_of_curved_face(face, mean_normal, normals);
  project(mean_normal, axis);
}

/// -1: none, or the face is flat.
int FaceChart::axis_of_curved_face(const FaceTriangles& face, const Vec3& mean_normal, const Mat3& normals) const {
  if (SymmetricEigen<3>(normals).eigenvalues()[1] < round_spread) return -1;
  for (int axis = 2; axis >= 0; --axis) {
    if (std::abs(mean_normal[axis]) < about_as_near * mean_normal.cwiseAbs().maxCoeff()) continue;
    double away = 0, area = 0;
    for (const auto& t : face.triangles) {
      const Vec3 n = area_normal(face, t);
      area += n.norm();
      if (n[axis] * mean_normal[axis] < 0) away += n.norm();
    }
    if (away <= turned_away * area) return axis;
  }
  return -1;
}

bool FaceChart::unroll(const FaceTriangles& face, const Mat3& normals) {
  const SymmetricEigen<3> solver(normals);
  if (solver.eigenvalues()[0] > flat_spread || solver.eigenvalues()[1] < round_spread) return false;
  up_ = solver.eigenvectors().col(0);
  int largest = 0;
  up_.cwiseAbs().maxCoeff(&largest);
  if (up_[largest] < 0) up_ = -up_;
  right_ = up_.unitOrthogonal();
  eye_ = right_.cross(up_);
  // Least-squares circle in the plane across the axis: x^2 + y^2 = c0 x + c1 y + c2, from the first point.
  const Vec3 origin = (*face.position)[face.triangles.front()[0]];
  Mat3 matrix = Mat3::Zero();
  Vec3 rhs = Vec3::Zero();
  double outward = 0;
  for (const auto& t : face.triangles)
    for (int p : t) {
      const Vec3 d = (*face.position)[p] - origin;
      const Vec3 row(right_.dot(d), eye_.dot(d), 1);
      matrix += row * row.transpose();
      rhs += row * row.head<2>().squaredNorm();
    }
  const Vec3 c = matrix.fullPivLu().solve(rhs);
  const double squared = c[2] + c.head<2>().squaredNorm() / 4;
  if (!c.allFinite() || !(squared > 0)) return false;
  centre_ = origin + c[0] / 2 * right_ + c[1] / 2 * eye_;
  const double radius = std::sqrt(squared);
  std::vector<double> angles;
  for (const auto& t : face.triangles) {
    for (int p : t) {
      const Vec3 d = (*face.position)[p] - centre_;
      if (std::abs(std::hypot(right_.dot(d), eye_.dot(d)) - radius) > round_tolerance * radius) return false;
    }
    const Vec3 centroid = ((*face.position)[t[0]] + (*face.position)[t[1]] + (*face.position)[t[2]]) / 3;
    angles.push_back(angle(centroid));
    outward += area_normal(face, t).dot(centroid - centre_);
  }
  radius_ = radius;
  middle_angle_ = middle_of(angles);
  mirrored_ = outward < 0;
  right_name_ = "arc length";
  up_name_ = up_[largest] > 1 - 1e-9 ? std::string(1, "xyz"[largest]) : "along the axis";
  return true;
}

/// axis: coordinate axis, -1: along the mean normal.
void FaceChart::project(const Vec3& mean_normal, int axis) {
  if (axis >= 0) {
    right_ = axis == 0 ? Vec3::UnitY() : Vec3::UnitX();
    up_ = axis == 2 ? Vec3::UnitY() : Vec3::UnitZ();
    right_name_ = axis == 0 ? "y" : "x";
    up_name_ = axis == 2 ? "y" : "z";
    mirrored_ = right_.cross(up_).dot(mean_normal) < 0;
    eye_ = mirrored_ ? Vec3(-right_.cross(up_)) : Vec3(right_.cross(up_));
    return;
  }
  eye_ = mean_normal;
  right_ = Vec3::UnitZ().cross(eye_).normalized();
  up_ = eye_.cross(right_);
  right_name_ = "horizontal";
  up_name_ = "upwards";
}

/// About the axis, counted from `eye` towards `right`: so that `right` is the arc's direction seen from outside.
double FaceChart::angle(const Vec3& x) const { return std::atan2(right_.dot(x - centre_), eye_.dot(x - centre_)); }

Vec3 FaceChart::direction(int axis, const Vec3& x) const {
  if (axis == 1) return up_;
  if (!unrolled()) return right_;
  const double a = angle(x);
  return std::cos(a) * right_ - std::sin(a) * eye_;
}

/// The right of an unrolled face turns, but only in the plane that `up` is across.
int FaceChart::axis_across(const Vec3& direction) const {
  return std::abs(right_.dot(direction)) > std::abs(up_.dot(direction)) ? 1 : 0;
}

Vec3 FaceChart::position(const Vec3& x, const Vec3& near) const {
  if (!unrolled()) return {right_.dot(x), up_.dot(x), eye_.dot(x)};
  const double middle = wrapped_angle(angle(near) - middle_angle_);
  return {radius_ * (middle + wrapped_angle(angle(x) - angle(near))), up_.dot(x), 0};
}

}  // namespace cgcontact
