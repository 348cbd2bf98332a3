/// What `cgcontact check` prints: the scene on its grids, without solving.
#pragma once

#include <string>

#include "contact/simulation.hpp"

namespace cgcontact {

/// Bodies with volume, faces, cells and unknowns; pairs; expected memory. A few lines per body.
std::string describe(const Scene& scene, const Preparation& preparation);

}  // namespace cgcontact
