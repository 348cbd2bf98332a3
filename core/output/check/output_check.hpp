/// Picture and the ParaView files of `cgcontact check --out DIR`.
#pragma once

#include <string>
#include <vector>

#include "core/drawing/drawn_body.hpp"
#include "core/drawing/marked_faces.hpp"
#include "core/output/pictures/output_gnuplot.hpp"
#include "core/output/pictures/picture_sheet.hpp"

namespace cgcontact {

/// Files that write_check has written.
struct CheckFiles {
  std::vector<std::string> names, warnings;  ///< warnings: no gnuplot, no picture
};

/// Writes into `directory` (made if it is missing; other files in it stay):
/// - check.png: the scene with its bodies in different colours; each body from two sides with its faces numbered and
///   coloured by what holds there (support, load, contact), and a slice through its grid with the cut cells; legends.
/// - check_faces.vtkhdf: the boundary; cell arrays body, face (the numbers of the picture), support, load, contact.
/// - check_cells.vtkhdf: the cells; cell arrays body, cell, cut, volume_fraction.
/// - check_repair.png, where surfaces have been repaired on request (core/output/check/output_repair.hpp).
/// Throws InputError if the files cannot be written; the old ones are then still there.
CheckFiles write_check(const Scene& scene, const std::vector<CheckedBody>& bodies, const std::string& directory);

/// Face of a picture of draw_conditions.
struct ConditionFace {
  int number = 0;               ///< in the picture
  std::string name, condition;  ///< "body.face"; what holds there, in words
  double area = 0;              ///< m^2
};

/// Faces of drawn bodies: what they are and which triangles they have.
struct DrawnFaces {
  std::vector<FaceRegion> regions;
  std::vector<std::vector<int>> region_of_triangle;  ///< by body; -1: none
  std::vector<Rgb> colours;                          ///< of the regions: of what holds there
};
DrawnFaces find_faces(const Scene& scene, const std::vector<CheckedBody>& bodies, const std::vector<DrawnBody>& drawn);

/// Returns what decides the colour of a region: "free", "support", "load", "contact".
const char* role_name(const FaceRegion& region);
/// Says the same in words with its values.
std::string conditions(const Scene& scene, const FaceRegion& region);
/// Returns the mean prescribed displacement in global axes, zero where there is none, or both ways (a rotation).
Vec3 prescribed(const FaceRegion& region);

/// Starts conditions.png: each body from two sides, its faces numbered and coloured by what holds there, with arrows
/// for loads and prescribed motions. `drawn`: the same bodies. Returns the faces on which something holds.
std::vector<ConditionFace> draw_conditions(const Scene& scene, const std::vector<CheckedBody>& bodies,
                                           const std::vector<DrawnBody>& drawn, const DrawnFaces& found,
                                           GnuplotRuns& runs);

}  // namespace cgcontact
