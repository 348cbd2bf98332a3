/// Finds expressions of loads and supports that are not finite on a plane face, before there is any grid.
#pragma once

#include <vector>

#include "core/scene/scene.hpp"

namespace cgcontact {

/// Evaluates the expressions at one point of each face plane that is parallel to the axes. There the constant
/// coordinate is exact, so that 1/(z-2) on z = 2 divides by zero; at quadrature points rounding hides it. Throws
/// InputError as the expressions do.
void probe_expressions(const BodySpec& body, const FaceSpec& face, const std::vector<const Expression*>& expressions);

}  // namespace cgcontact
