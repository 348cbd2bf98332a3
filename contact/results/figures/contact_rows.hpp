/// Contact faces point by point: pressures, gap, open or closed.
#pragma once

#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Makes a row of a pair at a grid position on the boundary of a body, with the outward normal (global axes); without
/// weight.
ContactRow contact_row(const SolvedState& state, int body, int pair, int cell, const Vec3& position,
                       const Vec3& normal);

/// Returns the scale of relative errors of a row's pressure, Pa: the pressure; on bonded faces, which may carry shear
/// alone, the traction.
double size_of_traction(const ContactRow& row, bool bonded);

/// Returns a row for every boundary point of the contact faces.
std::vector<ContactRow> contact_rows(const SolvedState& state);

}  // namespace cgcontact
