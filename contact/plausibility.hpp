/// Values of a scene that are allowed and hardly meant: a wrong unit, a load that does nothing.
#pragma once

#include <string>
#include <vector>

#include "contact/preparation.hpp"

namespace cgcontact {

/// Returns one sentence for each of them, with what to write instead, in the order of the rules (plausibility.cpp has
/// the table). The scene must have been laid out; throws InputError where a load has no value on its face.
std::vector<std::string> implausible_values(const Scene& scene, const Preparation& preparation);

}  // namespace cgcontact
