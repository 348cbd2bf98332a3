/// Surfaces that cross: cut along the crossings in exact arithmetic, then sorted by what is inside.
#pragma once

#include "core/triangles/triangle_soup.hpp"

namespace cgcontact {

/// Fraction of the size: points of a result nearer than this are one, which rounding of intersections has separated.
constexpr double rounding_distance = 1e-11;

/// Returns the boundary of the points about which the solids wind (any number of times but none) and the cavities do
/// not, as a mesh arrangement (Zhou, Grinspun, Zorin, Jacobson, Mesh arrangements for solid geometry, ACM TOG 35,
/// 2016): all triangles are cut where others cross, touch or cover them; fragments that separate inside and outside
/// stay. The surfaces are closed, each oriented alike; cavities with their normals out of the hollow. In the result
/// normals point out of the body, two triangles meet at every edge, and each of several shells that touch has its own
/// points. Points nearer to each other than `one_point` are one.
TriangleSoup outer_boundary(const TriangleSoup& solids, const TriangleSoup& cavities, double one_point);

/// Cleans the result: removes needles and triangles that are there in both senses, and separates the surface where more
/// than two triangles meet at an edge, such that neighbours have body between them.
void separate_where_touching(TriangleSoup& soup);

}  // namespace cgcontact
