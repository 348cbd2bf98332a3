#include "core/settings/output_options.hpp"

#include "core/base/errors/errors.hpp"

namespace cgcontact {

std::vector<Setting> OutputOptions::settings() {
  return {
      {"directory", &directory, "of the results, relative to the working directory", {}, {}, "out/<name of the file>"},
      {"vtk", &vtk, "fields for ParaView 5.11 and later"},
      {"vtu", &vtu, "the same for older programs"},
      {"frd", &frd, "fields for programs that read results of CalculiX"},
      {"csv", &csv, "contact.csv"},
      {"plots", &plots, "pictures"},
      {"report", &report, "report.html"},
      {"view", &view, "the view to turn in it; needs plots"},
      {"path",
       &path,
       "line on the contact face along which the pressure is drawn",
       {},
       {},
       "through the largest pressure"}};
}

void OutputOptions::check() const {
  if (path && !((path->second - path->first).stableNorm() > 0))
    throw InputError(SourceLocation{"", 0, "output.path"}, "", "has no length", "from different from to");
}

std::string OutputOptions::print() const {
  OutputOptions copy = *this, defaults;
  return print_settings("output", copy.settings(), defaults.settings());
}

}  // namespace cgcontact
