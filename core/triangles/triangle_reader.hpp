/// Reads surfaces of triangles: STL (ASCII and binary), OBJ, PLY (ASCII and binary), OFF (ASCII).
/// Formats:
/// STL: 3D Systems, StereoLithography Interface Specification (1989); OBJ: Wavefront, Advanced Visualizer Manual,
/// appendix B1; PLY: Turk, The PLY Polygon File Format (1994); OFF: Geomview manual, chapter 4.
#pragma once

#include <string>

#include "core/triangles/triangle_soup.hpp"

namespace cgcontact {

/// Returns by its name whether a file is one of these: .stl, .obj, .ply, .off.
bool is_triangle_file(const std::string& file);

/// Coordinates as they stand in the file. Corners of STL facets with equal coordinates are one point. Polygons are
/// divided into triangles (core/triangles/polygon_triangles.hpp). Throws InputError with file, line (of text) or facet,
/// and what is wrong.
TriangleSoup read_triangles(const std::string& file);

/// Parses the contents of a file of that name.
TriangleSoup parse_triangles(const std::string& file, const std::string& bytes);

/// Merges points with equal coordinates; returns how many went.
int merge_equal_points(TriangleSoup& soup);

}  // namespace cgcontact
