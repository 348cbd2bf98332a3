/// Reads the materials of a scene: the `material` of a [[body]], inline or by its name, and [[material]] sections.
#pragma once

#include <optional>
#include <vector>

#include "core/scene_file/sections/material_library.hpp"
#include "core/scene_file/sections/toml_cursor.hpp"

namespace cgcontact {

/// Those of the library and of the scene's [[material]] sections.
class SceneMaterials {
 public:
  /// `root`: the whole document. Throws InputError.
  explicit SceneMaterials(const TomlCursor& root);
  /// Reads a name, or {E, nu, density, expansion, yield}. Throws InputError.
  Material read(const TomlCursor& node) const;
  /// Reads the material of a rigid body, whose density alone counts: none, a name or {density}. Throws InputError.
  Material read_rigid(const std::optional<TomlCursor>& node) const;

 private:
  std::vector<NamedMaterial> materials_;
};

}  // namespace cgcontact
