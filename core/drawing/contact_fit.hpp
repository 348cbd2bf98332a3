/// Values of the contact rows between them: what a smooth picture of a contact face shows.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "core/base/numbers/point_buckets.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Rows of one body. At a point a linear function is fitted to the rows near it, as few as give one; it never leaves
/// the range of their values.
class ContactFit {
 public:
  struct Values {
    double gap, pressure, pressure_error;  ///< m; Pa, SPR-C. NaN: no row near has one
    double shear, slip, wear;              ///< sizes: Pa, SPR-C; m, Pa m of closed rows
  };
  ContactFit(const Results& results, int body);

  /// `cell`: size there, m; rows farther away than that do not count. None: no row is near.
  std::optional<Values> at(const Vec3& x, double cell);

 private:
  struct Neighbours;
  Neighbours neighbours_of(const Vec3& x, double reach);
  const PointBuckets& buckets(double reach);

  std::vector<const ContactRow*> rows_;
  std::map<double, PointBuckets> buckets_;  ///< by reach
};

}  // namespace cgcontact
