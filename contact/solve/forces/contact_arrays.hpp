/// The contact and the supports of a problem as the arrays that kernels run on (contact/kernels).
#pragma once

#include "contact/kernels/support_kernels.hpp"
#include "contact/solve/forces/outer_problem.hpp"
#include "contact/solve/forces/small_zones.hpp"

namespace cgcontact {

/// Makes groups and points of all pairs; `active` is that of the pairs' points where kernels reach the host's memory.
ContactGroupArrays<MemSpace> make_group_arrays(const OuterProblem& problem);
/// Copies what changes in the outer iteration and between solves: stiffness and gaps of the groups, zones smaller than
/// the cells, closed points.
void take_state(const OuterProblem& problem, const SmallZones& zones, const ContactGroupArrays<MemSpace>& groups);
/// Hands which points are closed back to the pairs.
void give_state(const OuterProblem& problem, const ContactGroupArrays<MemSpace>& groups);

/// Makes the arrays without their values, which take_values() sets: springs that follow a motion change them.
SupportArrays<MemSpace> make_support_arrays(const OuterProblem& problem);
void take_values(const OuterProblem& problem, const SupportArrays<MemSpace>& supports);

/// Gathers where each support point is and what it holds.
DirectionArrays<MemSpace> support_directions(const OuterProblem& problem);
/// Gathers node and axis of each degree of freedom in the rows of the groups (GroupRows::dof_list).
DirectionArrays<MemSpace> row_directions(const OuterProblem& problem);
/// Finds the index of each entry of the rows in GroupRows::dof_list.
IntView indices_of_entries(const GroupRows& rows);

/// Returns the nodes that supports (but those that plane strain stands for) and rows of groups act on.
TouchedNodes<MemSpace> make_touched_nodes(const OuterProblem& problem);

}  // namespace cgcontact
