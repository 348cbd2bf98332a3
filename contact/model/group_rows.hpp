/// Rows of the linear system that say how the mean gaps of contact groups change.
#pragma once

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

/// Makes the rows of all groups of all pairs, in order; dimensionless (displacement per displacement).
std::vector<GroupRow> make_group_rows(const ExecSpace& exec, const std::vector<ContactPair>& pairs,
                                      const std::vector<BodyModel>& bodies, const ElasticSystem& system);

}  // namespace cgcontact
