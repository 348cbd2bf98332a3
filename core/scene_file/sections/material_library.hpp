/// Materials that a scene can name: "steel", "EN-GJL-250", ... Their values and where they are from: docs/materials.md.
#pragma once

#include <string>
#include <vector>

#include "core/scene/scene.hpp"

namespace cgcontact {

struct NamedMaterial {
  std::string name;
  Material material;
};

const std::vector<NamedMaterial>& material_library();

}  // namespace cgcontact
