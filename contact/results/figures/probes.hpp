/// Displacement and recovered stress at the points that the scene asks for.
#pragma once

#include <optional>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Point in an active cell: cell coordinates.
struct CellPoint {
  int cell = 0;
  Vec3 xi;
};
/// Finds the cell that holds x (m); none where the body does not hold it.
std::optional<CellPoint> find_cell_point(const BodyModel& body, const Vec3& x);
/// Finds the cell coordinates of a boundary point.
CellPoint cell_point_of(const BodyModel& body, int point);

/// Appends the figures of all probes of the scene; needs the contact rows. Warns of points in no body.
void fill_probes(const SolvedState& state, Results& results);

}  // namespace cgcontact
