/// Parts for tests and scenes as CAD files, made by OpenCASCADE.
#pragma once

#include <string>
#include <vector>

namespace cgcontact::test {

/// A part with what is known of it.
struct CadPart {
  std::string name;     ///< its file is name.step
  double volume, area;  ///< mm^3, mm^2; 0: as OpenCASCADE's GProp has it
};

/// Writes all parts into a folder.
std::vector<CadPart> write_cad_parts(const std::string& folder);

}  // namespace cgcontact::test
