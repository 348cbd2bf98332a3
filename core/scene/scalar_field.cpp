#include "core/scene/scalar_field.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "core/base/numbers/decompositions.hpp"

namespace cgcontact {

const std::vector<std::string>& scalar_field_names() {
  static const std::vector<std::string> names{"displacement", "displacement_x", "displacement_y", "displacement_z",
                                              "stress_xx",    "stress_yy",      "stress_zz",      "stress_xy",
                                              "stress_yz",    "stress_zx",      "von_mises",      "tresca",
                                              "principal_1",  "principal_2",    "principal_3",    "pressure"};
  return names;
}

const std::string& name_of(ScalarField field) { return scalar_field_names()[static_cast<std::size_t>(field)]; }

bool is_length(ScalarField field) { return field <= ScalarField::displacement_z; }

double von_mises(const Sym3& s) {
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt((a * a + b * b + c * c) / 2 + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

Vec3 principal_stresses(const Sym3& stress) {
  if (!stress.allFinite()) return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  return eigenvalues(tensor(stress)).reverse();
}

double tresca(const Sym3& stress) {
  const Vec3 principal = principal_stresses(stress);
  return principal[0] - principal[2];
}

double value_of(ScalarField field, const Vec3& displacement, const Sym3& stress) {
  const int k = static_cast<int>(field);
  switch (field) {
    case ScalarField::displacement:
      return displacement.norm();
    case ScalarField::displacement_x:
    case ScalarField::displacement_y:
    case ScalarField::displacement_z:
      return displacement[k - static_cast<int>(ScalarField::displacement_x)];
    case ScalarField::von_mises:
      return von_mises(stress);
    case ScalarField::tresca:
      return tresca(stress);
    case ScalarField::principal_1:
    case ScalarField::principal_2:
    case ScalarField::principal_3:
      return principal_stresses(stress)[k - static_cast<int>(ScalarField::principal_1)];
    case ScalarField::pressure:
      return std::numeric_limits<double>::quiet_NaN();
    default:
      return stress[k - static_cast<int>(ScalarField::stress_xx)];
  }
}

}  // namespace cgcontact
