/// The scene that `init` makes of an input deck.
#pragma once

#include <string>

#include "core/scene_file/templates/scene_template.hpp"

namespace cgcontact {

/// Writes the scene of the deck options.file as init_scene does, and a surface file for each body beside it, none of
/// which may exist yet. Returns remarks for the user: also what of the deck is not taken over, and what `find_fault`
/// says. Throws InputError; nothing is written then.
std::string init_deck(const InitOptions& options, const FindFault& find_fault = {});

}  // namespace cgcontact
