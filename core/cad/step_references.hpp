/// References to other files in a STEP file, by its text: OpenCASCADE does not say what is missing. No OpenCASCADE
/// here.
#pragma once

#include <string>

namespace cgcontact {

/// Throws InputError that names the file and the line of a reference to an instance (#12) that the file does not
/// define.
void check_step_references(const std::string& file);

}  // namespace cgcontact
