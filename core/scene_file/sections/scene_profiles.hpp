/// Reads shapes that are given by a cone or a profile: cone, torus, extrude, revolve.
#pragma once

#include <string>
#include <vector>

#include "core/geometry/solid.hpp"
#include "core/scene_file/sections/toml_cursor.hpp"

namespace cgcontact {

/// A solid and the names of its faces, without that of the primitive.
struct ProfileShape {
  Solid solid;
  std::vector<std::string> faces;
};

/// {base, top, base_radius, top_radius}. `name`: of the primitive. Throws InputError, as the others do.
ProfileShape read_cone(const TomlCursor& node, const std::string& name);
/// {profile, height, origin, x, normal}
ProfileShape read_extrude(const TomlCursor& node, const std::string& name);
/// {profile, origin, axis}; a CAD solid where it has a torus. `body`: the [[body]] that it belongs to.
ProfileShape read_revolve(const TomlCursor& node, const std::string& name, const TomlCursor& body);
/// {center, axis, ring_radius, tube_radius}; a CAD solid.
ProfileShape read_torus(const TomlCursor& node, const std::string& name, const TomlCursor& body);

}  // namespace cgcontact
