/// Outline of a part that is bounded by triangles: its size, what lies at its top and bottom, its smooth regions.
/// `cgcontact init` lays out a scene by it.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "core/base/numbers/types.hpp"
#include "core/triangles/triangle_surface.hpp"

namespace cgcontact {

/// Triangles that creases of 30 degrees divide from the others.
struct SmoothRegion {
  double area = 0;             ///< m^2
  Vec3 normal = Vec3::Zero();  ///< mean outward normal, zero where the region is closed in itself
  Vec3 seed = Vec3::Zero();    ///< m, centre of its largest triangle
  bool flat = false;           ///< all normals within a degree of the mean
};

/// End of the part in the direction z+ or z-.
struct PartEnd {
  bool flat = false;  ///< most of it lies in the plane that touches the part
  /// Extent of the flat region, or of what lies within 2 % of the part's height, m.
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();
  /// There is surface within the last tenth of the height whose normal is within 30 degrees of the direction.
  bool faces_outwards = false;
};

/// Plane figure.
struct PartCut {
  double area = 0, rim = 0;  ///< m^2; m, the length of its boundary
  /// Returns m; of a strip half its width, of a disc a quarter of its diameter.
  double half_width() const { return rim > 0 ? area / rim : 0; }
};

struct PartOutline {
  std::string note;                             ///< file, triangles, size, repairs; one line
  std::string doubt;                            ///< "" or why the unit may be wrong
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();  ///< m
  double volume = 0;                            ///< m^3
  PartEnd top, bottom;
  std::vector<SmoothRegion> regions;  ///< largest first, positions and normals as in the file
  Mat3 turn = Mat3::Identity();       ///< min, max, top and bottom are those of the part turned so about the origin
  double area = 0;                    ///< m^2
  /// Cuts the part by the horizontal plane after it has come down by `push` (m).
  PartCut cut_at(double push) const;
  /// Returns the distance to come down until the cut is far enough, m; at most `most`.
  double push_until(const std::function<bool(double push, const PartCut&)>& is_enough, double most) const;
  /// Triangles that come near the top, turned, m below it: corners by their depth.
  std::vector<std::array<Vec3, 3>> below_top;
};

/// Reads, checks and repairs the surface (.stl, .obj, .ply, .off) as a scene would. A part that ends in a tip or edge
/// at its top is turned such that its largest flat region is there, if it has one. scale: m per unit of the file.
/// Throws InputError that names the file.
PartOutline outline_part(const std::string& file, double scale, bool repair = false);

/// Outlines a surface (m) whose patches are its smooth regions; `note` says where it comes from.
PartOutline outline_surface(const TriangleSurface& surface, const std::string& note);

}  // namespace cgcontact
