/// Named faces of a triangle surface: every triangle belongs to exactly one.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/errors/errors.hpp"
#include "core/base/numbers/types.hpp"
#include "core/triangles/triangle_soup.hpp"
#include "core/triangles/triangle_surface.hpp"

namespace cgcontact {

/// Angle between the normals of two triangles from which their edge separates patches, radians.
constexpr double default_crease_angle = pi / 6;

/// Selects the triangles that meet all conditions given. Lengths in m, in the coordinates of the surface.
struct TriangleSelector {
  std::string name;
  std::optional<std::pair<Vec3, double>> normal_cone;  ///< unit axis, cosine of the half angle: the triangle's normal
  std::optional<std::pair<Vec3, Vec3>> box;            ///< all corners in [min, max]
  struct Slab {
    Vec3 point, normal;  ///< unit normal
    double distance;     ///< >= 0
  };
  std::optional<Slab> plane;  ///< all corners within the distance of the plane
  struct Growth {
    Vec3 seed;     ///< the nearest triangle is the first
    double angle;  ///< radians: across edges where the normals differ by no more
  };
  std::optional<Growth> smooth;
  std::optional<std::string> group;  ///< of the file
  SourceLocation location;
};

struct NamedTriangles {
  std::vector<int> face;           ///< by triangle
  std::vector<std::string> names;  ///< "part.face"
};

/// Names faces; triangles that no selector takes make up the face "rest". Throws InputError if a selector takes none or
/// one that another has taken.
NamedTriangles name_faces(const TriangleSoup& soup, const std::string& part,
                          const std::vector<TriangleSelector>& selectors);

/// Divides the faces of a surface into patches at edges sharper than the crease angle (radians).
TriangleSurface make_surface(const TriangleSoup& soup, const NamedTriangles& faces, double crease_angle);

}  // namespace cgcontact
