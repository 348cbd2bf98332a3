/// Reference curves that a scene names: CSV tables and expressions.
#pragma once

#include <optional>
#include <vector>

#include "core/scene/scene.hpp"

namespace cgcontact {

/// Rows of numbers, sorted by the first column; lines that start with '#' are comments, the first other one may have
/// names.
class ReferenceTable {
 public:
  /// Throws InputError (unreadable file, not a number, fewer than min_columns, unsorted).
  ReferenceTable(const std::string& file, int min_columns);
  /// Interpolates a column linearly at `s`; clamped at the ends.
  double operator()(double s, int column) const;

 private:
  std::vector<std::vector<double>> rows_;
};

/// Known values of the solution on the contact face.
class Reference {
 public:
  /// `spec`: the scene's, at the computed contact force. Both must outlive this.
  Reference(const Scene& scene, const ReferenceSpec& spec);
  bool has_pressure() const { return pressure_table_ || spec_.pressure; }
  bool has_stress() const { return stress_table_.has_value() || !spec_.stress_of_body.empty(); }
  /// Returns Pa.
  double pressure(const Vec3& x) const;
  /// Stress of body `side` at x on the contact face, Pa, global axes. Tables are plane strain in the y-z plane:
  /// xx = nu (yy + zz).
  Sym3 stress(int body, const Vec3& x) const;
  double coordinate(const Vec3& x) const { return x[axis_]; }

 private:
  const Scene& scene_;
  const ReferenceSpec& spec_;
  int axis_ = 1;
  std::optional<ReferenceTable> pressure_table_, stress_table_;
};

}  // namespace cgcontact
