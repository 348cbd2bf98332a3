/// Scenes to start from, for `cgcontact init`: commented; they run as they are or say why not.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cgcontact {

struct InitOptions {
  std::string file;     ///< scene to write; empty: scene.toml, or the name of the surface or CAD file with .toml
  std::string surface;  ///< .stl, .obj, .ply or .off file of a part; empty: the example without a file
  std::string cad;      ///< .step, .iges or .brep file whose solids become bodies, instead of a surface
  std::string unit;     ///< of the surface or the .brep file, as in a scene
  bool repair = false;  ///< the surface, as the key of that name does
  /// Number of cells of one size along the longest side of the part; none: the scene asks for an accuracy.
  std::optional<int> cells;
};

/// Cells along the longest side; the default: where [accuracy] cannot be asked for.
constexpr int min_init_cells = 4, max_init_cells = 200, default_init_cells = 20;

/// Function that finds what keeps a scene (its text, the name of its file) from running; "": nothing.
using FindFault = std::function<std::string(const std::string& text, const std::string& file)>;

/// Writes the scene, which must not exist yet, and returns remarks for the user: also that it fails `find_fault`, with
/// [accuracy] and with all tried cell sizes. Throws InputError.
std::string init_scene(const InitOptions& options, const FindFault& find_fault = {});

/// Parses an integer from min_init_cells to max_init_cells; throws InputError.
int parse_init_cells(const std::string& text);

/// Returns by its name whether a file is an input deck of CalculiX or Abaqus (.inp), which core/decks reads.
bool is_deck(const std::string& file);

/// Throws InputError for a name that a scene cannot hold.
void check_file_names(const std::vector<std::string>& files);

/// Quotes a TOML string.
std::string toml_string(const std::string& text);

/// Formats a word of a command line in a comment: without line breaks, quoted if needed.
std::string comment_word(const std::string& text);

/// Lists the units that a surface may have in a scene.
std::vector<std::string> unit_names();

/// Parses one of unit_names(); throws InputError.
std::string parse_unit(const std::string& text);

}  // namespace cgcontact
