/// The first grid of a body without a cell size, from its shape.
#pragma once

#include "core/scene/scene.hpp"

namespace cgcontact {

/// m: so many cells over the mean thickness (twice the volume over the surface) as [accuracy] says, fewer where that
/// would be too many in all. Throws InputError for a body without volume.
double first_cell_size(const BodySpec& body, const GeometryOptions& geometry, const AccuracyOptions& options);

}  // namespace cgcontact
