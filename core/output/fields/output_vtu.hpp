/// result.vtu and contact.vtu: the unstructured grids of the VTKHDF files in VTK's XML format, for programs that do not
/// know VTKHDF (ParaView before 5.11, meshio, PyVista, FreeCAD).
#pragma once

#include <string>

namespace cgcontact {

/// Copies the grid and all arrays of a VTKHDF file without time. Throws InputError if one cannot be read or written.
void write_vtu(const std::string& vtkhdf_file, const std::string& file_name);

}  // namespace cgcontact
