/// Reads the `shape` of a body: a tree of primitives and boolean operations.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/geometry/solid.hpp"
#include "core/scene_file/sections/toml_cursor.hpp"

namespace cgcontact {

struct RepairedSurface;

/// Name of a primitive and of its faces.
struct PrimitiveFaces {
  std::string name;
  std::vector<std::string> faces;
  Solid solid;  ///< where it is in the body, m
};

struct Shape {
  Solid solid;
  std::vector<PrimitiveFaces> primitives;                       ///< in the order of the file
  std::vector<std::string> notes;                               ///< on what was read from mesh files, one line each
  std::vector<std::string> warnings;                            ///< the same for what the user should look at
  std::vector<std::shared_ptr<const RepairedSurface>> repairs;  ///< on request, in the order of the file
  bool has_mesh = false;                                        ///< a surface from a file is in it

  /// "primitive.face" of all faces.
  std::vector<std::string> face_names() const;
  /// Returns the faces that "primitive.face", "primitive" (all its faces) or "face" (if only one primitive has such a
  /// face) means; empty if none.
  std::vector<std::string> resolve(const std::string& reference) const;
  /// Returns another face of the same primitive that is one with some of these (two edges of a profile in one line);
  /// "": there is none.
  std::string one_with(const std::vector<std::string>& faces) const;
  /// Returns the primitives of some faces ("primitive.face") if other primitives have faces on the same surfaces (two
  /// boxes of a union on one plane); none otherwise, and of bodies with surfaces from files.
  std::vector<Solid> owners_of_shared(const std::vector<std::string>& faces) const;
};

/// Reads the `cell_size` of a [[body]], m. Throws InputError.
double read_cell_size(const TomlCursor& body);

/// Reads the `shape` of a [[body]]. Throws InputError; checks that the solid is bounded.
Shape read_shape(const TomlCursor& body);

}  // namespace cgcontact
