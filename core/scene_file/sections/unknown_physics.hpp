/// Keys of other programs' input for what this one does not compute.
#pragma once

#include <string>

namespace cgcontact {

/// Suggests in one sentence what replaces a key of physics or loads that do not exist ("friction", "mu", "force",
/// "density"); else "". Case, "_" and "-" do not matter.
std::string unknown_physics(const std::string& key);

}  // namespace cgcontact
