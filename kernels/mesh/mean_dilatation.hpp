/// Mean dilatation of a cell's part in the body, which resists what lambda has beyond UnitElasticity::lambda_at_points.
#pragma once

#include "kernels/mesh/mesh.hpp"

namespace cgcontact {

/// Returns it per cell unit from the corner displacements; of a ring over a volume in proportion to the radius. Zero
/// where the material has no use for it.
double mean_dilatation(const BodyMesh& mesh, int cell, const double u[8][3]);

}  // namespace cgcontact
