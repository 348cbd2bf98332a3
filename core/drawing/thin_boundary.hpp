/// The boundary of drawn bodies with fewer triangles away from the contact, for where all of them are too many.
#pragma once

#include <vector>

#include "core/drawing/conforming_boundary.hpp"
#include "core/drawing/scene_view.hpp"

namespace cgcontact {

/// Returns by body at most about `most` triangles in all. Points in a cube of a lattice that lie on the same surfaces
/// become one of them; corners, edges and the surroundings of zones stay. So values and positions are those of the
/// drawn body, and a closed boundary stays closed. Few triangles come as conforming_boundary has them.
std::vector<std::vector<ThinTriangle>> thin_boundaries(const std::vector<DrawnBody>& bodies,
                                                       const std::vector<SceneBox>& zones, std::size_t most);

}  // namespace cgcontact
