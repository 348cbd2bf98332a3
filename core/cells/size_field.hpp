/// Wanted cell sizes around given points: what an earlier solution asks of the next grid.
#pragma once

#include <memory>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Cells no larger than `size` in a ball. All in m.
struct SizedBall {
  Vec3 center = Vec3::Zero();
  double radius = 0, size = 0;
};

class SizeField {
 public:
  /// grading: growth of the size with the distance from a ball.
  SizeField(const std::vector<SizedBall>& balls, double grading);
  ~SizeField();
  SizeField(const SizeField&) = delete;

  /// Returns whether a size less than `size` (m) is wanted somewhere in a ball.
  bool asks_below(double size, const Vec3& center, double radius) const;
  /// Returns the smallest size of all balls, m; without any infinite.
  double smallest() const { return smallest_; }

 private:
  struct Search;
  std::unique_ptr<Search> search_;
  double grading_, smallest_;
};

}  // namespace cgcontact
