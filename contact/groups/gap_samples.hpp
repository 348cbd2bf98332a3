/// Gap between two bodies point by point over one group of a contact pair, finer than its quadrature points: edges,
/// corners and triangles of either body between these are found.
#pragma once

#include <memory>
#include <vector>

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

struct GapSample {
  Vec3 x;               ///< m, on the primary body
  double area = 0;      ///< m^2, across the group's mean normal
  double distance = 0;  ///< m, before deformation, along the group's mean normal
};

/// Samples one group. What was sampled for one limit is kept for the next ones.
class GapSampler {
 public:
  /// Bodies, pair and group must outlive this.
  GapSampler(const std::vector<BodyModel>& bodies, const ContactPair& pair, const ContactGroup& group);
  GapSampler(GapSampler&&) noexcept;
  ~GapSampler();

  /// Samples a square grid over the group, refined where distances below `limit` (m) may lie until they are known to a
  /// fraction of the depth below `limit`. Empty, if no distance below `limit` is found. Not thread-safe.
  std::vector<GapSample> samples(double limit);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Samples the gap for one limit.
std::vector<GapSample> sample_gap(const std::vector<BodyModel>& bodies, const ContactPair& pair,
                                  const ContactGroup& group, double limit);

}  // namespace cgcontact
