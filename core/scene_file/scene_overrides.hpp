/// Changes of the scene file's values from the command line: "--set dotted.key=value".
#pragma once

#include <toml++/toml.h>

#include <string>
#include <vector>

namespace cgcontact {

/// Writes the overrides into the document; array elements are addressed by index or by their `name`, parameters also
/// without "parameters.". Throws InputError if the key cannot be followed; whether the scene knows it is checked when
/// the scene is read.
void apply_overrides(toml::table& document, const std::vector<std::string>& overrides);

}  // namespace cgcontact
