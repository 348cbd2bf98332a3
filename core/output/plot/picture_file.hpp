/// The PNG file that is asked for: drawn beside its place and renamed, so that it is the old one or the new one, whole.
#pragma once

#include <functional>
#include <string>

#include "core/output/pictures/output_gnuplot.hpp"

namespace cgcontact {

class PictureFile {
 public:
  /// Throws InputError if it cannot be this file: no .png, no folder for it, something there that is no PNG, or a place
  /// inside `result`, which stays as it is.
  PictureFile(const std::string& file, const std::string& result);

  /// use(runs, name) starts the drawing of `name` in a folder that goes in the end. Throws InputError if gnuplot is not
  /// there or fails, or the file cannot be written.
  void draw(const std::function<void(GnuplotRuns& runs, const std::string& name)>& use) const;

 private:
  std::string file_;
};

}  // namespace cgcontact
