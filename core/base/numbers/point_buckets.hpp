/// Numbered points in cubes of one size, for loops over all points near a position.
#pragma once

#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

class PointBuckets {
 public:
  /// reach: of the loops, unit of the positions.
  explicit PointBuckets(double reach) : size_(reach) {}
  void add(const Vec3& x, int index) { buckets_[bucket(x)].push_back(index); }

  /// Calls use(index) for all points within the reach of x, and some others.
  template <class Use>
  void each_near(const Vec3& x, const Use& use) const {
    any_near(x, [&](int index) {
      use(index);
      return false;
    });
  }
  /// Returns whether is(index) holds for one of the same points; stops at the first.
  template <class Is>
  bool any_near(const Vec3& x, const Is& is) const {
    const Bucket centre = bucket(x);
    for (int n = 0; n < 27; ++n) {
      const auto found = buckets_.find({centre[0] + n % 3 - 1, centre[1] + n / 3 % 3 - 1, centre[2] + n / 9 - 1});
      if (found == buckets_.end()) continue;
      for (int index : found->second)
        if (is(index)) return true;
    }
    return false;
  }

 private:
  using Bucket = std::array<long long, 3>;
  struct Hash {
    std::size_t operator()(const Bucket& key) const {
      std::size_t hash = 0;
      for (const long long k : key) hash = (hash ^ static_cast<std::size_t>(k)) * 0x9E3779B97F4A7C15u;
      return hash ^ hash >> 32;
    }
  };
  Bucket bucket(const Vec3& x) const {
    Bucket key;
    for (int d = 0; d < 3; ++d) key[d] = static_cast<long long>(std::floor(x[d] / size_));
    return key;
  }

  double size_;
  std::unordered_map<Bucket, std::vector<int>, Hash> buckets_;
};

}  // namespace cgcontact
