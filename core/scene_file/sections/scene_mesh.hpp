/// Reads the `mesh` of a shape: a triangle surface from a file, with its named faces.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/geometry/solid.hpp"
#include "core/scene_file/sections/toml_cursor.hpp"
#include "core/triangles/triangle_checks.hpp"
#include "core/triangles/triangle_repair.hpp"

namespace cgcontact {

struct MeshShape {
  Solid solid;
  std::vector<std::string> faces;  ///< without the name of the shape
  std::string note;                ///< what was read and what was repaired, one line
  bool repaired = false;
  std::shared_ptr<const RepairedSurface> repair;  ///< what was repaired on request; nullptr: nothing
  Vec3 extent = Vec3::Zero();                     ///< m
};

/// A surface from a file, in metres, checked.
struct BodySurface {
  TriangleSoup soup;
  SurfaceRepairs repairs;
  std::shared_ptr<const RepairedSurface> repair;  ///< what `repair = true` changed; nullptr: nothing
};

/// `repair`: surfaces that bound no body are repaired first (core/triangles/triangle_repair.hpp). Throws InputError.
BodySurface read_body_surface(const std::string& file, double scale, bool repair);

/// Metres per unit, by the names that a scene may use.
const std::map<std::string, double>& mesh_units();

/// Describes a surface in one line: size (extent in m) and repairs.
std::string describe_surface(const std::string& file, const BodySurface& surface, const Vec3& extent);

/// Asks about the unit, if a surface of this extent (m) is unusually long or short; else "".
std::string doubtful_unit(const Vec3& extent);

/// Throws InputError.
MeshShape read_mesh(const TomlCursor& node, const std::string& name);

}  // namespace cgcontact
