/// Contents of the formats of CAD files, before any check that they are solids; for the files that use OpenCASCADE.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace cgcontact {

/// A solid or what is to become one, with what the file says of it.
struct Found {
  std::string name;
  TopoDS_Shape shape;
  std::vector<std::pair<TopoDS_Face, std::string>> face_names;
  std::vector<std::pair<TopoDS_Face, std::array<int, 3>>> colours;
};

/// Remarks on a file beside its shapes.
struct Remarks {
  std::string left_out;     ///< CadSolid::left_out
  std::string other_files;  ///< "" or names of files that it refers to
  /// Returns a hint for a file in which something is missing.
  std::string where_else() const {
    return other_files.empty() ? ""
                               : "; it is an assembly that refers to other files: " + other_files +
                                     " (allowed: these files themselves, or an export of all as one file)";
  }
};

/// Exporters write some words where a user gave no name.
bool is_no_name(const std::string& name);

/// Read everything in a file that has faces. Throw InputError: not to be read.
std::vector<Found> read_step(const std::string& file, Remarks& remarks);
std::vector<Found> read_iges(const std::string& file);
std::vector<Found> read_brep(const std::string& file);

}  // namespace cgcontact
