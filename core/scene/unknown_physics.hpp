/// Keys of other programs' input for what this one does not compute.
#pragma once

#include <string>

namespace cgcontact {

/// For a key that names physics or loads that there are not ("friction", "mu", "force", "density"): what there is
/// instead, in one sentence; else "". Case, "_" and "-" do not matter.
std::string unknown_physics(const std::string& key);

}  // namespace cgcontact
