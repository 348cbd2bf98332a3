/// Elements of arrays with `copies = n` (bodies, contacts, regions of refine, operands of a union, ...) become n
/// elements, in whose texts {i} is the number of the copy.
#pragma once

#include <functional>

#include "core/scene_file/sections/toml_cursor.hpp"

namespace cgcontact {

/// Replaces them in the document. `again` parses the document once more: nodes know their line in the file, copies do
/// not. Throws InputError.
void make_copies(toml::table& document, const SceneText& text, const std::function<toml::table()>& again);

}  // namespace cgcontact
