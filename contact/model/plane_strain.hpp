/// Bodies in plane strain: prisms one layer of cells thick, on whose ends nothing acts and along which nothing moves.
/// What of a scene contradicts that is an InputError.
#pragma once

#include "contact/model/contact_pairs.hpp"

namespace cgcontact {

/// The thickness (m) of a body along its axis of plane strain against its cells.
void check_thickness(const BodySpec& body, double thickness);

/// Of a body in plane strain, along its axis, m.
double thickness_across(const BodySpec& body);

/// The bodies of a scene with quadtrees are all in plane strain, and between the same two planes.
void check_slices(const Scene& scene);

/// The body of a quadtree, in the coordinates of its grid, longer on both sides than its one layer of cells: they have
/// no ends. Throws InputError if it is no prism.
Solid beyond_the_layer(const Solid& solid, const Grid& grid);

/// The boundary of such a body: two flat ends, and sides along the axis; cells in one layer.
void check_extruded(const BodySpec& body, const CutCells& cells);

/// Supports, loads and contact of such bodies.
void check_plane_strain(const Scene& scene, const std::vector<BodyModel>& bodies,
                        const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs);

}  // namespace cgcontact
