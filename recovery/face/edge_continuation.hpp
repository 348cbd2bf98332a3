/// The end of a contact zone inside of the patches: there the square of the pressure ends like a straight line.
#pragma once

#include "recovery/face/face_grid.hpp"

namespace cgcontact {

/// Returns the square of the pressure at every patch, Pa^2; negative outside of the zone. Patches at the edge are
/// whole, as groups are, and carry what belongs beyond it. So the square is continued linearly from farther inside to a
/// little beyond the edge; then the force is set again. pressure: Pa, at the patches; inside: 1 at those on the faces;
/// force: N, in plane strain N/m.
std::vector<double> continue_to_edge(const FaceGrid& grid, const std::vector<char>& inside,
                                     const std::vector<double>& pressure, double force);

}  // namespace cgcontact
