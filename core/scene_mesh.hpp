/// Reads the `mesh` of a shape: a triangle surface from a file, with its named faces.
#pragma once

#include <string>
#include <vector>

#include "core/csg.hpp"
#include "core/toml_cursor.hpp"

namespace cgcontact {

struct MeshShape {
  Solid solid;
  std::vector<std::string> faces;  ///< without the name of the shape
  std::string note;                ///< what was read and what was repaired, one line
  bool repaired = false;
  Vec3 extent = Vec3::Zero();  ///< m
};

/// Throws InputError.
MeshShape read_mesh(const TomlCursor& node, const std::string& name);

}  // namespace cgcontact
