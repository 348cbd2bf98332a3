/// A smooth step down, for weights that end.
#pragma once

namespace cgcontact {

/// 1 for x <= 0, 0 for x >= 1, with a continuous derivative.
inline double smooth_fall(double x) { return x <= 0 ? 1 : x >= 1 ? 0 : 1 - x * x * (3 - 2 * x); }

}  // namespace cgcontact
