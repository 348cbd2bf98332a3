#include "core/settings/face_options.hpp"

namespace cgcontact {

std::vector<Setting> FaceOptions::settings() {
  const auto cells = [](const std::string& key, double& value) {
    return method_constant("face." + key, value, Range::positive("cells"));
  };
  return {method_constant("face.patches_per_cell_2d", patches_per_cell_2d, Range::integers(2, 64)),
          method_constant("face.patches_per_cell_3d", patches_per_cell_3d, Range::integers(2, 16)),
          cells("reach", reach),
          cells("shortest_details", shortest_details),
          cells("longest_details", longest_details),
          method_constant("face.gap_error", gap_error, Range::from_to(0, 1, "0 to 1")),
          cells("fall", fall),
          method_constant("face.cell_stiffness", cell_stiffness, Range::from_to(0, 1, "0 to 1")),
          method_constant("face.tolerance", tolerance, Range::positive()),
          method_constant("face.max_iterations", max_iterations, Range::integers(1, 10000))};
}

}  // namespace cgcontact
