/// Surfaces as the image of a plane, S(u, v), and curves in that plane: what CAD systems describe faces and their rims
/// with.
#pragma once

#include <memory>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

using Vec2 = Eigen::Vector2d;

/// S and its derivatives at one point.
struct SurfaceJet {
  Vec3 x, xu, xv, xuu, xuv, xvv;
};

/// Read-only: threads share it.
class ParametricSurface {
 public:
  virtual ~ParametricSurface() = default;
  virtual bool is_plane() const = 0;
  /// Computes S, S_u, S_v; the second derivatives are left as they are.
  virtual void first(const Vec2& uv, SurfaceJet& jet) const = 0;
  virtual void second(const Vec2& uv, SurfaceJet& jet) const = 0;
  /// Returns the nearest parameters where S is defined.
  virtual Vec2 clamped(const Vec2& uv) const = 0;
};

/// Read-only: threads share it.
class PlaneCurve {
 public:
  virtual ~PlaneCurve() = default;
  virtual Vec2 at(double t) const = 0;
};

}  // namespace cgcontact
