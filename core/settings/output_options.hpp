/// Settings of what is written.
#pragma once

#include "core/settings/settings.hpp"

namespace cgcontact {

struct OutputOptions {
  std::string directory;         ///< empty: out/<name of the file>
  bool vtk = true;               ///< fields for ParaView 5.11 and later
  bool vtu = false;              ///< the same for older programs
  bool frd = false;              ///< fields for those that read CalculiX' results
  bool csv = true;               ///< contact.csv
  bool plots = true;             ///< pictures
  bool report = true;            ///< report.html
  bool view = true;              ///< with plots: the view to turn in it
  std::optional<PathEnds> path;  ///< along which the pressure is drawn; none: through the largest pressure

  bool fields() const { return vtk || vtu || frd; }

  std::vector<Setting> settings();
  void check() const;
  std::string print() const;
};

}  // namespace cgcontact
