/// Cell sizes that a solution asks of the next grid in its contact zones.
#pragma once

#include <optional>
#include <vector>

#include "contact/solve/solved_state.hpp"
#include "core/cells/size_field.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// One contact pair after a solve.
struct ZoneState {
  bool relevant = false;          ///< carries enough to matter, or may touch and is not resolved
  bool resolved = false;          ///< its pressure can be relied on
  double cell = 0;                ///< m, of the larger cells in the zone
  std::optional<double> width;    ///< m; none: the zone ends where the faces end
  std::optional<double> needed;   ///< m; the size that would resolve it, as the verdict says
  bool narrowed = false;          ///< found between the quadrature points of cells that are larger
  double error = 0;               ///< of the pressure, relative, for the next sizes (two_grid_estimate.hpp)
  std::vector<SizedBall> balls;   ///< closed groups or what may touch; size: that of the present cells
  std::vector<SizedBall> missed;  ///< overlaps that transmit nothing; size: that asked of the next cells
};

/// Sets the local sizes of a resolved zone that ends where the faces end (a flat punch: peak of pressure at the rim):
/// fewest cells with `target` as the relative error of the pressure, by the estimated errors of the contact rows, taken
/// to fall like the size (Fuenmayor and Oliver, IJNME 39 (1996) 4039, in two dimensions): h_new/h = E e^(-1/2) (sum of
/// e)^(-1/2).
void size_by_error(const SolvedState& state, const Results& results, int pair, double target, ZoneState& zone);

/// Makes the balls of a resolved zone no larger than the shear's error asks for if it misses [accuracy] shear, as
/// above; it is largest where stick meets slip. present: the zone with the sizes of the present cells. Returns the
/// smallest ratio of new to present cells, at most 1.
double size_by_shear(const SolvedState& state, const Results& results, int pair, const ZoneState& present,
                     ZoneState& zone);

/// Returns one per pair of the state.
std::vector<ZoneState> zone_states(const SolvedState& state, const Results& results);

/// Returns the size of the cells of a zone on the next grid over the present one. estimate: of the pressure's error;
/// target: of the same, none: the zone is only to be found and resolved.
double next_size_ratio(const ZoneState& zone, double estimate, std::optional<double> target,
                       const AccuracyOptions& options);

}  // namespace cgcontact
