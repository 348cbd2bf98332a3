/// Output of `cgcontact check`: the scene on its grids, without solving.
#pragma once

#include <string>
#include <vector>

#include "contact/preparation.hpp"
#include "core/output/check/output_check.hpp"

namespace cgcontact {

/// Describes bodies with volume, faces, cells and unknowns; pairs; expected memory. A few lines per body.
std::string describe(const Scene& scene, const Preparation& preparation);

/// Lists the settings of all stages as TOML, with their defaults, ranges and meanings; those that no scene can set are
/// comments.
std::string describe_settings(const Scene& scene);

/// Draws the scene on its grids into `directory` (core/output/check/output_check.hpp).
CheckFiles draw(const Scene& scene, const Preparation& preparation, const std::string& directory);

}  // namespace cgcontact
