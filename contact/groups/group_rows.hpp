/// Rows of the linear system that say how the mean gaps of contact groups change.
#pragma once

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

/// Makes the rows of all groups of all pairs, in order; dimensionless (displacement per displacement).
std::vector<GroupRow> make_group_rows(const ExecSpace& exec, const std::vector<ContactPair>& pairs,
                                      const std::vector<BodyModel>& bodies, const ElasticSystem& system);

/// Makes the rows of friction: how the bodies slide along the tangents of the groups of pairs with friction, in order,
/// ContactPair::num_tangents for each group, each coupled to the row of its gap.
std::vector<GroupRow> make_tangent_rows(const ExecSpace& exec, const std::vector<ContactPair>& pairs,
                                        const std::vector<BodyModel>& bodies, const ElasticSystem& system);

/// Gives both rows of a group along its tangents entries at the same degrees of freedom, so that they can be turned.
/// Rows from `first` on, of pairs with friction; constraints are resolved.
void match_tangent_rows(const std::vector<ContactPair>& pairs, std::size_t first, std::vector<GroupRow>& rows);

}  // namespace cgcontact
