/// The gap between two bodies point by point over one group of a contact pair, finer than its quadrature points: edges,
/// corners and triangles of either body that lie between these are found.
#pragma once

#include <vector>

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

struct GapSample {
  Vec3 x;               ///< m, on the primary body
  double area = 0;      ///< m^2, across the group's mean normal
  double distance = 0;  ///< m, before deformation, along the group's mean normal
};

/// A square grid over the group, refined where distances below `limit` (m) may lie until they are known to a part of
/// the depth below `limit`. Empty, if no distance below `limit` is found.
std::vector<GapSample> sample_gap(const std::vector<BodyModel>& bodies, const ContactPair& pair,
                                  const ContactGroup& group, double limit);

}  // namespace cgcontact
