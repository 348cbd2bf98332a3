/// Scenes from files, or from a text in memory.
#pragma once

#include <string>
#include <vector>

#include "core/scene/scene.hpp"

namespace cgcontact {

/// Reads and validates a scene; `overrides` are "dotted.key=value" as given to --set (body.NAME.cell_size=1e-3
/// addresses a body by name). Throws InputError.
Scene read_scene(const std::string& file, const std::vector<std::string>& overrides = {});

/// Reads a text; `file`: its name in messages, and where files that it names are looked for.
Scene parse_scene(const std::string& text, const std::string& file, const std::vector<std::string>& overrides = {});

}  // namespace cgcontact
