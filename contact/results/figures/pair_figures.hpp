/// Area, force, largest pressure and centre of every contact pair, from its contact zone alone.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Sets ContactRow::touching: the closed points of a pair and, since closed points make up whole groups, the open ones
/// in the cells beside them that are less than a cell of the coarser body apart; without points where a support holds
/// the normal direction, whose pressure is a reaction, and open ones under a load. `boundary_point`: of the row's body,
/// by row.
void mark_touching_rows(const SolvedState& state, const std::vector<int>& boundary_point,
                        std::vector<ContactRow>& rows);

/// Returns whether there is pressure at a touching row. `largest`: of its pair.
bool is_pressed(const ContactRow& row, double largest);

/// Returns the figures of all pairs; rows: of the contact faces, empty: forces alone. A pair without closed points, or
/// whose forces are rounding beside those of the scene, has exactly zero force, area, pressure and centre.
std::vector<PairFigures> pair_figures(const SolvedState& state, const std::vector<ContactRow>& rows);

/// Returns force (N) and moment about the origin (N m) of a pair's friction on its first body, of the modelled
/// thickness: as they act in the discrete equilibrium, so that supports and loads balance them. The shear at the
/// points, whose gaps hold in the mean of groups, does not add up to the same on coarse grids.
std::pair<Vec3, Vec3> friction_on_first(const SolvedState& state, std::size_t pair);

/// Sums the forces of each pair's groups, N, compression positive; of a shrink fit too, whose resultant is
/// nothing.
std::vector<double> normal_forces(const SolvedState& state);

/// Returns a sentence for each pair whose recovered pressure, over the rows that touch, does not add up to the
/// transmitted force.
std::vector<std::string> lost_force_warnings(const SolvedState& state, const std::vector<ContactRow>& rows,
                                             const std::vector<PairFigures>& pairs);

}  // namespace cgcontact
