/// The scalars of displacement and stress that probes and sections can ask for, by their names in scenes.
#pragma once

#include <string>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Without index: the magnitude of the displacement. Principal stresses: 1 is the largest (tension positive), 3 the
/// smallest. pressure: of the contact, no function of the stress alone.
enum class ScalarField {
  displacement,
  displacement_x,
  displacement_y,
  displacement_z,
  stress_xx,
  stress_yy,
  stress_zz,
  stress_xy,
  stress_yz,
  stress_zx,
  von_mises,
  tresca,
  principal_1,
  principal_2,
  principal_3,
  pressure
};

/// Lists the names in the order of the enumeration.
const std::vector<std::string>& scalar_field_names();
const std::string& name_of(ScalarField field);
/// Returns whether it is in m; else Pa.
bool is_length(ScalarField field);

/// Compute Pa. Tresca: the largest difference of two principal stresses.
double von_mises(const Sym3& stress);
double tresca(const Sym3& stress);
/// Returns them descending.
Vec3 principal_stresses(const Sym3& stress);

/// Returns any field but the contact pressure, which is NaN.
double value_of(ScalarField field, const Vec3& displacement, const Sym3& stress);

}  // namespace cgcontact
