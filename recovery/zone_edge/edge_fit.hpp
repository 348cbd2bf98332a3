/// Place and strength of the square root at the edge of a contact zone, from the forces that the contact transmits.
///
/// The contact forces are in equilibrium with the solution, so that their weighted sums over a few cells are more
/// accurate than any stress. The solution's own zone consists of whole contact groups: it ends up to half a cell off
/// the edge, and its pressure then has a part 1/sqrt(s) there (a punch's), to first order just that which moves
/// sqrt(s) to the true edge; the sums see the sum of both. Evidence: docs/recovery.md.
#pragma once

#include <vector>

#include "core/settings/edge_options.hpp"
#include "recovery/patch/edge_map.hpp"

namespace cgcontact {

/// What a contact point transmits; global axes.
struct TransmittedForce {
  int pair, cell;  ///< active cell of the pair's primary body
  int image;       ///< in which planes of symmetry it is mirrored, a bit each; 0: it is no image
  bool closed;
  Vec3 position, normal;  ///< m; outward unit normal of one of the bodies
  double area, force;     ///< m^2; N, compression positive
  double spread_force;    ///< N, where the group's force is spread over all its points, closed or not
  double cell_size;       ///< m, of the larger cell of both bodies there: that of its contact group
};

struct EdgeFit {
  bool found = false;
  double shift = 0;     ///< cells by which the edge lies outside of the assumed one
  double strength = 0;  ///< pressure = strength sqrt(s (1 - s / width)) at distance s inside: Pa per root of a metre
};

/// The edge near `piece` for which K sqrt(s (1 - s / width)) has the same sums as the forces. cell_size: m, of the
/// larger cells there, which carry the contact groups. Not found: no edge within a cell meets them.
EdgeFit fit_edge(const EdgePiece& piece, const std::vector<const TransmittedForce*>& forces, double cell_size,
                 const EdgeOptions& options = {});

}  // namespace cgcontact
