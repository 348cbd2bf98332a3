/// The contact pressure of a finished run, read back from its contact.csv and interpolated along the faces.
#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/results/results.hpp"

namespace cgcontact {

/// Reads the rows of a contact.csv; body, x, weight and pressures only. Throws InputError if it is none.
std::vector<ContactRow> read_contact_rows(const std::string& file, const Scene& scene);

/// The SPR-C pressure between the given points: weighted linear fit to the nearest ones. Within a cell of the end of a
/// zone, where the pressure falls like a square root, its square is fitted to the closed points within a cell, and the
/// zone ends at its zero. Ends towards which the pressure does not fall (body's edge) do not count.
class SampledPressure {
 public:
  /// `reach`: no point farther away counts, m; a cell of the run.
  SampledPressure(std::vector<ContactRow> rows, double reach);
  /// Returns Pa, at a point on the face of a body that has rows.
  double operator()(int body, const Vec3& x) const;

 private:
  using Bucket = std::array<long long, 4>;   ///< body and cube
  using Neighbour = std::pair<double, int>;  ///< distance and row
  struct Linear {
    double mean = 0;
    Vec3 middle = Vec3::Zero(), gradient = Vec3::Zero();
    double operator()(const Vec3& x) const { return mean + gradient.dot(x - middle); }
  };
  Bucket bucket(int body, const Vec3& x) const;
  std::vector<Neighbour> neighbours(int body, const Vec3& x) const;  ///< within reach, nearest first
  double nearest(int body, const Vec3& x) const;
  Linear fit(const std::vector<Neighbour>& points, int power) const;  ///< of the power of the pressure

  std::vector<ContactRow> rows_;
  double reach_;
  double open_ = 0;  ///< pressures up to it: open, Pa
  std::map<Bucket, std::vector<int>> buckets_;
};

}  // namespace cgcontact
