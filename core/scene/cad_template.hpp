/// A scene of all solids of a CAD file, for `cgcontact init`.
#pragma once

#include <string>

#include "core/scene/scene_template.hpp"

namespace cgcontact {

/// Each solid is a body, solids that touch or nearly touch are contact pairs; what the file does not say is marked
/// TODO. `state`: does it run? Appends to `told` what to tell the user. Throws InputError.
std::string scene_of_cad_file(const InitOptions& options, const std::string& file, const std::string& state,
                              std::string& told);

}  // namespace cgcontact
