/// Substitution of the outer variable of nested quadrature.
#pragma once

#include <algorithm>
#include <cmath>

namespace cgcontact {

/// An interval of t on which the slices of a region have one structure. Singular: a curve that delimits the slices is
/// tangent to the line t = left <= begin (t = right >= end), at the end of the interval or not far outside of it.
struct Interval {
  double begin, end;
  double left, right;
  bool left_singular, right_singular;
};

/// Monotone map of [0,1] to [ta,tb] that makes square roots of the distances to t1 <= ta and t2 >= tb smooth.
class OuterMap {
 public:
  explicit OuterMap(const Interval& interval) : interval_(interval) {
    const double ta = interval.begin, tb = interval.end;
    if (interval.left_singular && interval.right_singular) {
      centre_ = 0.5 * (interval.left + interval.right);
      radius_ = 0.5 * (interval.right - interval.left);
      a_ = angle(ta);
      b_ = angle(tb);
    } else if (interval.left_singular) {
      a_ = std::sqrt(std::max(0.0, ta - interval.left));
      b_ = std::sqrt(tb - interval.left);
    } else if (interval.right_singular) {
      a_ = std::sqrt(interval.right - ta);
      b_ = std::sqrt(std::max(0.0, interval.right - tb));
    }
  }

  void operator()(double x, double& t, double& slope) const {
    const double y = a_ + x * (b_ - a_);
    if (interval_.left_singular && interval_.right_singular) {
      t = centre_ - radius_ * std::cos(y);
      slope = radius_ * std::sin(y) * (b_ - a_);
    } else if (interval_.left_singular) {
      t = interval_.left + y * y;
      slope = 2 * y * (b_ - a_);
    } else if (interval_.right_singular) {
      t = interval_.right - y * y;
      slope = -2 * y * (b_ - a_);
    } else {
      slope = interval_.end - interval_.begin;
      t = interval_.begin + x * slope;
    }
  }

 private:
  double angle(double t) const { return std::acos(std::clamp((centre_ - t) / radius_, -1.0, 1.0)); }

  const Interval& interval_;
  double centre_ = 0, radius_ = 1, a_ = 0, b_ = 1;
};

}  // namespace cgcontact
