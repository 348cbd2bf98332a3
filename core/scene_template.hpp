/// Scenes to start from, for `cgcontact init`: commented, and such that they run as they are.
#pragma once

#include <string>
#include <vector>

namespace cgcontact {

struct InitOptions {
  std::string file;     ///< scene to write; empty: scene.toml, or the name of the surface with .toml
  std::string surface;  ///< .stl, .obj or .ply file of a part; empty: the example without a file
  std::string unit;     ///< of the surface, as in a scene
  int cells = 20;       ///< along the longest side of the part
};

constexpr int fewest_init_cells = 4, most_init_cells = 200;

/// Writes the scene, which must not exist yet, and returns what to tell the user. Throws InputError.
std::string init_scene(const InitOptions& options);

/// An integer from fewest_init_cells to most_init_cells; throws InputError.
int parse_init_cells(const std::string& text);

/// The units that a surface may have in a scene.
std::vector<std::string> unit_names();

/// One of unit_names(); throws InputError.
std::string parse_unit(const std::string& text);

}  // namespace cgcontact
