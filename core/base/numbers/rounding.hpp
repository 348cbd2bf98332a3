/// Rounding: which figures are zero beside others of their kind, and which are equal.
#pragma once

#include <cmath>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Fraction of the figures that it is the sum or part of below which a figure is rounding: what the linear solver
/// leaves of its residual (its tolerance is 1e-10 of the forces; SolverOptions), sums of many terms, and cosines and
/// positions of what is meant to be in line stay below.
constexpr double rounding = 1e-9;

/// Returns components with 0 for those that are rounding beside `scale` (same unit, at least 0).
inline Vec3 without_rounding(Vec3 v, double scale) {
  for (double& component : v)
    if (std::abs(component) <= rounding * scale) component = 0;
  return v;
}

}  // namespace cgcontact
