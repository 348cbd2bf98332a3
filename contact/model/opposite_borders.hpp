/// Borders of the opposite face of a contact pair, on the body whose surface is integrated.
#pragma once

#include "core/cells/cut_cells.hpp"
#include "core/scene/face_dividers.hpp"

namespace cgcontact {

/// Returns planes (grid coordinates of `own`) that divide a body's surface where its normals meet the borders of a
/// declared face of the other body. Exact between planes, between coincident surfaces, and between concentric spheres
/// or cylinders; none for a border without a plane image (the rim of a ball's cap seen from a plane). `dividers`:
/// box_dividers of the other body and its face.
std::vector<Plane> opposite_borders(const CutCells& own, int surface, const CutCells& other, const FaceSpec& face,
                                    const std::vector<Plane>& dividers);

/// Returns the planes of a face's box that divide it; grid coordinates.
std::vector<Plane> box_dividers(const CutCells& cut_cells, const FaceSpec& face);

}  // namespace cgcontact
