/// The largest values in the bodies and on their declared faces, and where they are.
#pragma once

#include <vector>

#include "core/drawing/drawn_body.hpp"

namespace cgcontact {

/// Finds extremes by body: at the points of its drawn mesh, of a face at those on it (at quadrature points of a smaller
/// one); of the contact pressure in the contact rows.
std::vector<BodyExtremes> extremes_of(const Results& results, const Scene& scene, const std::vector<DrawnBody>& drawn);

/// Does so where nothing else is drawn: each rank draws some of the bodies. Collective.
std::vector<BodyExtremes> extremes_by_ranks(const Results& results, const Scene& scene);

/// Returns the body with the largest (or the smallest) value of one kind, or -1.
int body_with_largest(const std::vector<BodyExtremes>& bodies, Extreme Extremes::*kind);
int body_with_smallest(const std::vector<BodyExtremes>& bodies, Extreme Extremes::*kind);

}  // namespace cgcontact
