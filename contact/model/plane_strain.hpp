/// Bodies in plane strain: prisms one layer of cells thick, on whose ends nothing acts and along which nothing moves.
/// Bodies of revolution: their half-planes are such layers. What of a scene contradicts that is an InputError.
#pragma once

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

/// The thickness (m) of a body along its axis of plane strain against its cells.
void check_thickness(const BodySpec& body, double thickness);

/// The bodies of a scene with quadtrees are all in plane strain, and between the same two planes.
void check_slices(const Scene& scene);

/// The body, in any coordinates that are turned about its axis only, between other ends (low < high). Refuses it if it
/// is no prism.
Solid stretched_to(const BodySpec& body, const Solid& solid, double low, double high);

/// The boundary of such a body: two flat ends, and sides along the axis; cells in one layer.
void check_extruded(const BodySpec& body, const CutCells& cells);

/// Supports, loads and contact of such bodies.
void check_plane_strain(const Scene& scene, const std::vector<BodyModel>& bodies,
                        const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs);

}  // namespace cgcontact
