/// From the solved simulation to the Results that the output writes. SI units, global axes.
#pragma once

#include "contact/simulation.hpp"

namespace cgcontact {

/// Condenses the support points into the cell matrices.
void add_supports(const Scene& scene, const std::vector<BodyModel>& bodies, const std::vector<SupportPoint>& supports,
                  const Scales& scales, ElasticSystem& system);

/// Of a point of a body: active cell and cell coordinates -> m, global axes.
Vec3 displacement(const Simulation& simulation, int body, int cell, const Vec3& xi);

/// A row of a pair at a grid position on the boundary of a body, with the outward normal (global axes); without weight.
ContactRow contact_row(const Simulation& simulation, int body, int pair, int cell, const Vec3& position,
                       const Vec3& normal);

void fill_counts(const Simulation& simulation, Results& results);
/// Displacement and stress fields, error estimate and effectivity.
void fill_body_fields(const Simulation& simulation, Results& results);
void fill_contact_rows(const Simulation& simulation, Results& results);
void fill_support_figures(const Simulation& simulation, Results& results);
/// Resultants on every body; needs the pair figures.
void fill_balance(const Simulation& simulation, Results& results);
/// Relative L2 errors of the pressure per zone (norm of the reference over the whole face) and stress errors.
void fill_pressure_errors(const Simulation& simulation, Results& results);

}  // namespace cgcontact
