/// Pixels below what gnuplot has drawn on a transparent page. gnuplot draws pixels too, but takes 0.4 s of CPU time for
/// a picture of 0.6 million of them, half of what a small scene's run took.
#pragma once

#include <string>
#include <vector>

namespace cgcontact {

/// Pixels of a picture: bytes red, green, blue, by row from the bottom.
struct PixelLayer {
  std::string file;             ///< that holds them
  int width = 0, height = 0;    ///< pixels
  double left = 0, bottom = 0;  ///< lower left corner in the picture, pixels; rounded
};

/// Lays layers on white, and on them what a PNG file holds, which becomes opaque. Parts of layers outside the picture
/// are left out. Throws InputError where the file is no PNG, layers are shorter than they should be, or it cannot be
/// written.
void lay_below(const std::string& png, const std::vector<PixelLayer>& layers);

}  // namespace cgcontact
