/// Settings of what is written. What each means stands in settings().
#pragma once

#include "core/settings/settings.hpp"

namespace cgcontact {

struct OutputOptions {
  std::string directory;
  bool vtk = true, vtu = false, frd = false, csv = true;
  bool plots = true, report = true, view = true;
  std::optional<PathEnds> path;

  bool fields() const { return vtk || vtu || frd; }

  std::vector<Setting> settings();
  void check() const;
  std::string print() const;
};

}  // namespace cgcontact
