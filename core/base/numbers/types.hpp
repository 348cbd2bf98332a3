/// Small shared types: vectors, symmetric tensors.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

namespace cgcontact {

constexpr double pi = 3.14159265358979323846;
constexpr double radians_per_degree = pi / 180;

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// Symmetric tensor as (xx, yy, zz, xy, yz, zx); stresses carry true shear components (not doubled).
using Sym3 = Eigen::Matrix<double, 6, 1>;
using Index3 = std::array<int, 3>;

/// Returns the full 3x3 tensor of a Sym3 (xx, yy, zz, xy, yz, zx).
inline Mat3 tensor(const Sym3& s) {
  Mat3 t;
  t << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return t;
}

/// Returns (xx, yy, zz, xy, yz, zx) of a symmetric 3x3 tensor.
inline Sym3 voigt(const Mat3& t) {
  Sym3 s;
  s << t(0, 0), t(1, 1), t(2, 2), t(0, 1), t(1, 2), t(2, 0);
  return s;
}

}  // namespace cgcontact
