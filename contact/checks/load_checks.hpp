/// Check that the quadrature points of the loads see what their expressions do.
#pragma once

#include <string>
#include <vector>

#include "contact/model/model.hpp"

namespace cgcontact {

/// Returns a sentence for each load whose resultant, or its moment about the centroid of the face, changes by more than
/// ResultOptions::lost_load when the facets are divided: a jump that the planes of core/expressions/jump_planes.hpp
/// do not cut, or a peak, inside a cell. The same of body forces, with fewer points instead of more.
std::vector<std::string> load_resolution_warnings(const Scene& scene, const std::vector<BodyModel>& bodies);

}  // namespace cgcontact
