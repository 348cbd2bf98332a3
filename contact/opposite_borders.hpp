/// Where the opposite face of a contact pair ends, on the body whose surface is integrated.
#pragma once

#include "core/face_dividers.hpp"

namespace cgcontact {

/// Planes (grid coordinates of `own`) that divide a surface of one body where its normals meet the borders of a
/// declared face of the other body. Exact between planes, between coincident surfaces, and between concentric spheres
/// or cylinders; where a border has no plane image (the rim of a ball's cap seen from a plane) there is none.
std::vector<Plane> opposite_borders(const CutCells& own, int surface, const CutCells& other, const FaceSpec& face);

}  // namespace cgcontact
