#include "core/settings/face_options.hpp"

namespace cgcontact {

std::vector<Setting> FaceOptions::settings() {
  const auto cells = [](const std::string& key, double& value, const std::string& meaning) {
    return method_constant("face." + key, value, meaning, Range::positive("cells"));
  };
  return {
      method_constant("face.patches_per_cell_2d", patches_per_cell_2d,
                      "patches per cell along the zone at most, in plane strain", Range::integers(2, 64)),
      method_constant("face.patches_per_cell_3d", patches_per_cell_3d, "patches per cell along the zone at most, in 3D",
                      Range::integers(2, 16)),
      cells("reach", reach, "distance beyond the closed groups within which open ones count for the far field"),
      cells("shortest_details", shortest_details, "lower bound of the length of the far field's details"),
      cells("longest_details", longest_details, "upper bound of the length of the far field's details"),
      method_constant("face.gap_error", gap_error, "error of the groups' mean gaps, of their change in a cell",
                      Range::from_to(0, 1, "0 to 1")),
      cells("fall", fall, "open groups so far away count exp(-1/2)"),
      method_constant("face.cell_stiffness", cell_stiffness,
                      "stiffness of cells that mean gaps lack, times h^2 of the compliance's curvature",
                      Range::from_to(0, 1, "0 to 1")),
      method_constant("face.tolerance", tolerance,
                      "change of the pressure in the last iteration of the problem on the face", Range::positive()),
      method_constant("face.max_iterations", max_iterations, "of the problem on the face", Range::integers(1, 10000))};
}

}  // namespace cgcontact
