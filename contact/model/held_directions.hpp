/// The directions that a support holds at a point of its face, by what it prescribes or by springs.
#pragma once

#include <vector>

#include "core/scene/scene.hpp"

namespace cgcontact {

/// Reaction that a support takes from its face.
struct SupportedFace {
  double area = 0;  ///< m^2, of the whole thickness
  Axis axis;        ///< of its cylinder; set where the support holds components about it
};

struct HeldDirection {
  Held component = Held::x;
  Vec3 direction;        ///< unit, global axes
  double value = 0;      ///< displacement along it, m
  double stiffness = 0;  ///< of springs, Pa/m; 0: held
};

/// Returns the held directions at x (m), n the outward normal, global axes.
std::vector<HeldDirection> held_at(const SupportSpec& support, const SupportedFace& face, const Vec3& x, const Vec3& n);

}  // namespace cgcontact
