/// Constants of the contact pressure as a problem on the face (recovery/face/face_zone.hpp). Lengths in cells, the
/// larger ones of both bodies at the zone. Chosen on perf/edge_scenes (docs/accuracy.md, "The pressure on the face").
#pragma once

#include "core/settings/settings.hpp"

namespace cgcontact {

struct FaceOptions {
  /// Patches per cell along the zone at most, in plane strain and in 3D; wide zones have fewer.
  int patches_per_cell_2d = 16, patches_per_cell_3d = 12;
  /// Distance beyond the closed groups within which open ones count for the far field.
  double reach = 4;
  /// Bounds of the length of the far field's details: as long as the groups' mean gaps allow, which are off by a
  /// fraction `gap_error` of their change in a cell by the compliance's curvature and the pressure.
  double shortest_details = 0.5, longest_details = 1.5, gap_error = 0.045;
  /// Open groups so far away count exp(-1/2).
  double fall = 2;
  /// Stiffness of trilinear cells that the groups' mean gaps lack, times h^2 of the curvature of the compliance.
  double cell_stiffness = 0.08;
  /// Change of the pressure in the last iteration: as small as mirrored and turned bodies are to be alike.
  double tolerance = 1e-10;
  int max_iterations = 300;

  std::vector<Setting> settings();
};

}  // namespace cgcontact
