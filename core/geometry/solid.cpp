#include "core/geometry/solid.hpp"

#include <cmath>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

Solid Solid::transformed(const Mat3& rotation, const Vec3& translation, double scale) const {
  if (!(std::isfinite(scale) && scale > 0 && rotation.allFinite() && translation.allFinite()))
    throw InputError(std::string("a placement must be finite with a positive scale"));
  if (!((rotation.transpose() * rotation - Mat3::Identity()).norm() < 1e-10 && rotation.determinant() > 0))
    throw InputError(std::string("a placement must be a rotation"));
  return Solid(geometry_->transformed(rotation, translation, scale));
}

}  // namespace cgcontact
