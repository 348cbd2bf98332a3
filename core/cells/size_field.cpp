#include "core/cells/size_field.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <unsupported/Eigen/BVH>

namespace cgcontact {
namespace {

using Box = Eigen::AlignedBox3d;

}  // namespace

/// For Eigen's hierarchy of bounding boxes.
Box bounding_box(const SizedBall& ball) {
  return {ball.center - Vec3::Constant(ball.radius), ball.center + Vec3::Constant(ball.radius)};
}

struct SizeField::Search {
  explicit Search(const std::vector<SizedBall>& balls) : tree(balls.begin(), balls.end()) {}
  Eigen::KdBVH<double, 3, SizedBall> tree;
};

namespace {

/// Query for Eigen::BVIntersect: balls that want less than `size` within `reach` of their surface.
struct Below {
  const Vec3& center;
  double size, reach;
  bool found = false;

  bool intersectVolume(const Box& box) const { return box.exteriorDistance(center) < reach; }
  bool intersectObject(const SizedBall& ball) {
    found = ball.size < size && (ball.center - center).norm() - ball.radius < reach;
    return found;
  }
};

}  // namespace

SizeField::SizeField(const std::vector<SizedBall>& balls, double grading)
    : grading_(grading), smallest_(std::numeric_limits<double>::infinity()) {
  for (const SizedBall& ball : balls) smallest_ = std::min(smallest_, ball.size);
  search_ = std::make_unique<Search>(balls);
}

SizeField::~SizeField() = default;

bool SizeField::asks_below(double size, const Vec3& center, double radius) const {
  if (!(smallest_ < size)) return false;
  Below below{center, size, radius + size / grading_};
  Eigen::BVIntersect(search_->tree, below);
  return below.found;
}

}  // namespace cgcontact
