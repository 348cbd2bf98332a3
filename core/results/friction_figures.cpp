#include "core/results/friction_figures.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cgcontact {

std::string verdict_on(const FrictionFigures& friction) {
  constexpr double close_to_sliding = 0.95;
  if (!friction.use) return "";
  std::string text = "sticks everywhere";
  if (friction.slip_area > 0)
    text = friction.stick_area > 0 ? fmt::format("partial slip: {:.3g} % of the closed area slips",
                                                 100 * friction.slip_area / (friction.slip_area + friction.stick_area))
                                   : "slips everywhere";
  return *friction.use > close_to_sliding ? text + ", close to sliding all over" : text;
}

std::string use_text(double use) { return fmt::format("{:.3g} %", 100 * use); }

std::string components_text(const Vec3& direction) {
  const Vec3 shown = (1000 * direction).array().round().matrix() / 1000 + Vec3::Zero();  // no -0
  return fmt::format("{:g}, {:g}, {:g}", shown[0], shown[1], shown[2]);
}

}  // namespace cgcontact
