/// Scenes from a text in memory.
#pragma once

#include <string>
#include <vector>

#include "core/scene/scene.hpp"

namespace cgcontact {

/// As read_scene; `file`: its name in messages, and where files that it names are looked for.
Scene parse_scene(const std::string& text, const std::string& file, const std::vector<std::string>& overrides = {});

}  // namespace cgcontact
