#include "contact/face/zone_chart.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/base/numbers/decompositions.hpp"
#include "recovery/patch/tangents.hpp"

namespace cgcontact {
namespace {

/// A zone whose normals are all within 30 degrees of their mean is seen from above.
constexpr double min_flat_cosine = 0.866;
/// A face is round about an axis when the mean square of its normals along it is less, and its points are within that
/// fraction of the radius of one cylinder.
constexpr double no_turn = 1e-4, one_radius = 0.02;
/// Tolerance of directions and positions that are the same.
constexpr double same = 1e-6;

}  // namespace

std::optional<ZoneChart> ZoneChart::make(const std::vector<FacePoint>& points, const std::vector<SymmetryPlane>& planes,
                                         int across, const Mat3& turned) {
  ZoneChart chart;
  Vec3 mean = Vec3::Zero(), centre = Vec3::Zero();
  Mat3 spread = Mat3::Zero();
  double area = 0;
  for (const FacePoint& p : points) {
    area += p.weight;
    mean += p.weight * p.normal;
    centre += p.weight * p.x;
    spread += p.weight * p.normal * p.normal.transpose();
  }
  if (!(area > 0)) return std::nullopt;
  centre /= area;
  // With its images behind the planes.
  Vec3 middle = centre;
  for (const SymmetryPlane& plane : planes) {
    mean -= mean.dot(plane.normal) * plane.normal;
    middle -= plane.distance(middle) * plane.normal;
  }
  if (across >= 0) mean -= mean[across] * Vec3::Unit(across);
  mean.normalize();
  double least = 1;
  for (const FacePoint& p : points) least = std::min(least, p.normal.dot(mean));
  if (least > min_flat_cosine) {
    chart.origin_ = middle;
    chart.normal_ = mean;
    chart.axis_[0] = across >= 0      ? Vec3(Vec3::Unit(across))
                     : planes.empty() ? Vec3(turned * tangents(turned.transpose() * mean).first)
                                      : Vec3(-planes[0].normal);
    chart.axis_[0] = (chart.axis_[0] - chart.axis_[0].dot(mean) * mean).normalized();
    chart.axis_[1] = mean.cross(chart.axis_[0]);
    if (!chart.set_ends(planes)) return std::nullopt;
    return chart;
  }
  // Round: the direction in which no normal points.
  const SymmetricEigen<3> solver(spread / area);
  if (across < 0 && solver.eigenvalues()[0] > no_turn) return std::nullopt;
  const Vec3 axis = across >= 0 ? Vec3(Vec3::Unit(across)) : Vec3(solver.eigenvectors().col(0));
  const auto [e, f] = tangents(axis);
  Mat3 normal = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  for (const FacePoint& p : points) {
    const Vec3 d = p.x - centre, row(d.dot(e), d.dot(f), 1);
    normal += p.weight * row * row.transpose();
    right += p.weight * row * (row[0] * row[0] + row[1] * row[1]);
  }
  const Vec3 c = normal.ldlt().solve(right);
  chart.round_ = true;
  chart.origin_ = centre + 0.5 * c[0] * e + 0.5 * c[1] * f;
  chart.radius_ = std::sqrt(std::max(c[2] + 0.25 * (c[0] * c[0] + c[1] * c[1]), 0.0));
  chart.axis_[0] = axis;
  double misfit = 0, outward = 0;
  for (const FacePoint& p : points) {
    const Vec3 d = chart.radial(p.x);
    misfit = std::max(misfit, std::abs(d.norm() - chart.radius_));
    outward += p.weight * p.normal.dot(d.normalized());
  }
  if (!(misfit < one_radius * chart.radius_)) return std::nullopt;
  chart.outward_ = outward < 0 ? -1 : 1;
  chart.axis_[1] = chart.radial(centre).normalized();
  chart.normal_ = axis.cross(chart.axis_[1]);
  if (!chart.set_ends(planes)) return std::nullopt;
  return chart;
}

/// Puts the origin of an axis onto the symmetry plane across it.
bool ZoneChart::set_ends(const std::vector<SymmetryPlane>& planes) {
  for (const SymmetryPlane& plane : planes) {
    int axis = -1;
    if (round_) {
      if (std::abs(std::abs(plane.normal.dot(axis_[0])) - 1) < same) axis = 0;
      if (std::abs(plane.normal.dot(axis_[0])) < same && std::abs(plane.distance(origin_)) < 1e-3 * radius_) axis = 1;
    } else {
      for (int a = 0; a < 2; ++a)
        if (std::abs(std::abs(plane.normal.dot(axis_[a])) - 1) < same) axis = a;
    }
    if (axis < 0) return false;
    if (ends_[axis] == FaceEnd::period) return false;
    if (round_ && axis == 1) {
      if (ends_[1] == FaceEnd::mirror) return false;
      // Radial direction in the plane on the zone's side; the angle grows into the body.
      const Vec3 zero = (axis_[1] - axis_[1].dot(plane.normal) * plane.normal).normalized();
      if (!zero.allFinite()) return false;
      axis_[1] = zero;
      normal_ = -plane.normal;
      ends_[1] = FaceEnd::mirror;
      continue;
    }
    if (ends_[axis] == FaceEnd::free) {
      origin_ -= plane.distance(origin_) * plane.normal;
      axis_[axis] = -plane.normal;
      ends_[axis] = FaceEnd::mirror;
    } else {
      length_[axis] = -plane.distance(origin_);
      if (!(length_[axis] > 0)) return false;
      ends_[axis] = FaceEnd::period;
    }
  }
  return true;
}

Vec3 ZoneChart::radial(const Vec3& x) const {
  const Vec3 d = x - origin_;
  return d - d.dot(axis_[0]) * axis_[0];
}

FacePosition ZoneChart::coordinates(const Vec3& x) const {
  const Vec3 d = x - origin_;
  if (!round_) return {d.dot(axis_[0]), d.dot(axis_[1])};
  return {d.dot(axis_[0]), radius_ * std::atan2(d.dot(normal_), d.dot(axis_[1]))};
}

Vec3 ZoneChart::point(const FacePosition& position) const {
  if (!round_) return origin_ + position[0] * axis_[0] + position[1] * axis_[1];
  const double angle = position[1] / radius_;
  return origin_ + position[0] * axis_[0] + radius_ * (std::cos(angle) * axis_[1] + std::sin(angle) * normal_);
}

Vec3 ZoneChart::normal(const Vec3& x) const { return round_ ? Vec3(outward_ * radial(x).normalized()) : normal_; }

double ZoneChart::height(const Vec3& x) const {
  return round_ ? outward_ * (radial(x).norm() - radius_) : normal_.dot(x - origin_);
}

}  // namespace cgcontact
