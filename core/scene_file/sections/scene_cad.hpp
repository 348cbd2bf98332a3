/// Reads the `cad` of a shape: a solid of a CAD file, with its named faces.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/cad/cad_model.hpp"
#include "core/geometry/solid.hpp"
#include "core/scene_file/sections/toml_cursor.hpp"

namespace cgcontact {

struct CadShape {
  Solid solid;
  std::vector<std::string> faces;  ///< without the name of the shape
  std::string note;                ///< what was read, one line
  std::vector<std::string> warnings;
};

/// `name`: of the shape; `body`: the [[body]] that it belongs to. Throws InputError.
CadShape read_cad_solid(const TomlCursor& node, const std::string& name, const TomlCursor& body);

/// Returns the size of the body's cells for its triangles, m, from its `cell_size` or the longest side of the shape.
double cell_size_for_cad(const TomlCursor& body, double longest);

/// Returns whether a face can have this name of its file in a scene.
bool is_scene_name(const std::string& name);

}  // namespace cgcontact
