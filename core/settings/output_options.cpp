#include "core/settings/output_options.hpp"

#include "core/base/errors.hpp"

namespace cgcontact {

std::vector<Setting> OutputOptions::settings() {
  return {{"directory", &directory, {}, {}, "out/<name of the file>"},
          {"vtk", &vtk},
          {"vtu", &vtu},
          {"frd", &frd},
          {"csv", &csv},
          {"plots", &plots},
          {"report", &report},
          {"view", &view},
          {"path", &path, {}, {}, "through the largest pressure"}};
}

void OutputOptions::check() const {
  if (path && !((path->second - path->first).stableNorm() > 0))
    throw InputError(SourceLocation{"", 0, "output.path"}, "", "has no length", "from different from to");
}

std::string OutputOptions::print() const {
  OutputOptions copy = *this;
  return print_settings("output", copy.settings());
}

}  // namespace cgcontact
