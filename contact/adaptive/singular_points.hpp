/// Positions where the stress has no finite value: re-entrant edges, ends of loads and supports inside a face, rims of
/// punches. Found from the solves on several grids.
#pragma once

#include "contact/solve/solved_state.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Energies of one solve, by body and active cell: all that is kept of its stress.
struct CellEnergies {
  std::vector<Vec3> x;                           ///< m, middle of the cell
  std::vector<double> h, volume, energy, error;  ///< m, m^3 (quadtree: m^2), J (squares of energy norms)
  std::vector<double> fraction;                  ///< of the cell's volume that the body fills
};
std::vector<CellEnergies> cell_energies(const Results& results);

/// Finds singular positions by the mean stress S (uniaxial, of the same energy) in the ball of some cells around a
/// position. It is singular if
/// - the last solve's error there is still a large fraction of the stress, and the largest of its surroundings,
/// - S has grown from solve to solve like h^-a while its cells were at least halved, and still grows at the end,
/// - and S falls with the radius of the ball on the last grid, as it does not where a smooth stress was merely not
/// resolved before. One for each set of faces; not where further faces meet the edge between some. solves: in order,
/// the last one the state's.
std::vector<SingularPoint> singular_points(const SolvedState& state,
                                           const std::vector<std::vector<CellEnergies>>& solves);

/// Describes it in one sentence.
std::string describe(const SingularPoint& point);

}  // namespace cgcontact
