/// The contact pressure of a finished run, read back from its contact.csv and interpolated along the faces.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/results.hpp"

namespace cgcontact {

/// Rows of a contact.csv; body, x, weight and pressures only. Throws InputError if it is none.
std::vector<ContactRow> read_contact_rows(const std::string& file, const Scene& scene);

/// The SPR-C pressure between the given points: weighted linear fit to the nearest ones.
class FacePressure {
 public:
  /// `reach`: no point farther away counts, m; a cell of the run.
  FacePressure(std::vector<ContactRow> rows, double reach);
  /// Pa, at a point on the face of a body that has rows.
  double operator()(int body, const Vec3& x) const;

 private:
  using Bucket = std::array<long long, 4>;  ///< body and cube
  Bucket bucket(int body, const Vec3& x) const;
  double nearest(int body, const Vec3& x) const;

  std::vector<ContactRow> rows_;
  double reach_;
  std::map<Bucket, std::vector<int>> buckets_;
};

}  // namespace cgcontact
