/// Hertz's theory of two elastic bodies that touch at a point or along a line (Johnson, Contact Mechanics, chapter 4).
#pragma once

#include "core/results/zone_figures.hpp"
#include "core/scene/scene.hpp"

namespace cgcontact {

/// Solves point contact: force in N, principal relative curvatures 0 < least <= most in 1/m (sums over both bodies,
/// convex positive). a lies along the direction of the least.
HertzFigures hertz_point(double force, double min_curvature, double max_curvature, double modulus);

/// Solves line contact: force per length in N/m, relative curvature across in 1/m.
HertzFigures hertz_line(double force_per_length, double curvature, double modulus);

}  // namespace cgcontact
