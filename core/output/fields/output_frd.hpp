/// result.frd: the bodies as CalculiX writes its results, for PrePoMax, FreeCAD and CalculiX GraphiX (cgx). The format
/// is that of the manual of CalculiX GraphiX 2.20, "Result Format", in its long ASCII form.
#pragma once

#include <string>
#include <vector>

#include "core/drawing/drawn_body.hpp"

namespace cgcontact {

/// Writes all bodies, in m, Pa: nodes from 1; hexahedra (he8) and tetrahedra (te4) whose group and material are the
/// number of the body from 1, `names` in the header; datasets DISP and STRESS (recovered) where all bodies have them,
/// and CONTACT (COPEN: gap, CPRESS: the result's pressure, CPERROR: its estimated error; means of the triangles around)
/// on nodes of contact faces with an opposite face. Throws InputError if it cannot be written.
void write_frd(const std::vector<DrawnBody>& bodies, const ContactSurface& surface,
               const std::vector<std::string>& names, const std::string& title, const std::string& file_name);

}  // namespace cgcontact
