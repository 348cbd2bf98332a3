#include "core/results/friction_figures.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cgcontact {

std::string verdict_on(const FrictionFigures& friction) {
  if (!friction.use) return "";
  if (!std::isfinite(*friction.use)) return "slides: nothing presses the faces";
  if (*friction.use > 1)
    return fmt::format("slides: friction cannot carry it, the loads need {:.3g} times what it can", *friction.use);
  return fmt::format(
      "friction could carry it, {:.3g} % of what it can; here a traction spread over the faces does, "
      "which is not contact",
      100 * *friction.use);
}

std::string use_text(double use) { return std::isfinite(use) ? fmt::format("{:.3g} %", 100 * use) : "more than any"; }

std::string components_text(const Vec3& direction) {
  const Vec3 shown = (1000 * direction).array().round().matrix() / 1000 + Vec3::Zero();  // no -0
  return fmt::format("{:g}, {:g}, {:g}", shown[0], shown[1], shown[2]);
}

}  // namespace cgcontact
