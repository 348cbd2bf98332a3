/// Estimate of how far displacements may be off.
#pragma once

namespace cgcontact {

/// Returns the relative error of the displacement that the loads do their work on (the largest one, mostly), from the
/// relative error of the energy norm: twice its square, by which the energy is off exactly, as for a contact's force.
inline double displacement_estimate(double energy_error) { return 2 * energy_error * energy_error; }

}  // namespace cgcontact
