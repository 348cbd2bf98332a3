#include <fmt/format.h>

#include "core/triangles/triangle_repair.hpp"

namespace cgcontact {

std::string SurfaceRepair::text() const {
  std::string result;
  const auto add = [&](int count, const char* one, const char* many) {
    if (count > 0) result += fmt::format("{}{} {}", result.empty() ? "" : ", ", count, count > 1 ? many : one);
  };
  add(merged_points, "point merged", "points merged");
  add(turned, "triangle turned over", "triangles turned over");
  add(holes, "hole filled", "holes filled");
  add(untangled, "shell that crossed itself cut along the crossings",
      "shells that crossed themselves cut along the crossings");
  add(united, "shell united with another one", "shells united with others");
  add(lost, "shell without volume left out", "shells without volume left out");
  if (result.empty()) result = "shells that touch kept apart";
  return fmt::format(
      "{}; {} triangle{} gone, {} new ones at most {:.3g} m from the old surface; volume {:.6g} -> {:.6g} m3, area "
      "{:.6g} "
      "-> {:.6g} m2",
      result, gone_triangles, gone_triangles == 1 ? "" : "s", new_triangles, distance, volume_before, volume_after,
      area_before, area_after);
}

}  // namespace cgcontact
