/// Thickness of the bodies at contact, in cells. A body thinner than a cell bends far too stiffly, and with it forces
/// and pressures are wrong, however many cells the contact zone has.
#pragma once

#include "contact/solve/solved_state.hpp"

namespace cgcontact {

struct Thickness {
  double cells = 0;  ///< in cells of the size `cell`
  double cell = 0;   ///< m, the largest of the body's cells with closed points
};

/// Thickness of a body within three cells of the closed points of a pair: 2 V / A with its volume V there and the free
/// area A that faces one direction, the largest eigenvalue of the integral of n n^T: that of a plate, the side of a
/// square bar or a cube, the diameter of a rod or a ball. Supported faces do not count (plane strain). Infinite without
/// closed points.
Thickness thickness_at_contact(const SolvedState& state, const ContactPair& pair, int body);

}  // namespace cgcontact
