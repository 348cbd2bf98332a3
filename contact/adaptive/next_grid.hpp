/// From a solution to the sizes of the cells of the next grids.
#pragma once

#include <memory>
#include <vector>

#include "contact/adaptive/zone_sizes.hpp"

namespace cgcontact {

/// Sizes of the cells of all bodies, m.
struct GridSizes {
  std::vector<double> first;                          ///< of each body: the largest cells
  std::vector<std::vector<SizedBall>> zones, energy;  ///< of each body: where they are to be smaller
  double change = 1;  ///< smallest ratio of cells to those before: of a zone, of the energy norm's error in the mean
};

/// Returns the sizes of the first grids: cell_size, or from the shape.
GridSizes first_sizes(const Scene& scene);

/// Halves all cells.
void halve(GridSizes& sizes);

/// Returns the scene on grids of these sizes; cells smaller than the first become larger by a factor. max_cells: limit
/// of each body (BodySpec).
std::unique_ptr<Scene> scene_on_grids(const Scene& scene, const GridSizes& sizes, double factor = 1,
                                      double max_cells = std::numeric_limits<double>::infinity());

/// Returns the scene on the grids that its first solve has.
Scene on_first_grids(const Scene& scene);

/// Relative estimated errors after a solve; none: not known, as the zone is not resolved.
struct ErrorFigures {
  std::optional<double> pressure, force;  ///< the largest of the pairs that matter
  std::optional<double> shear;            ///< the largest of those with shear that matters; none: there is none
  double stress = 0;
  std::vector<double> stress_of_body;        ///< for bodies with a target
  std::vector<std::optional<double>> named;  ///< of AccuracyOptions::named
  bool met = false;                          ///< all that the scene asks for
  bool finite = true;                        ///< all are numbers
};
/// Collects the errors; displacement: of the targets that are displacements, in their order.
ErrorFigures error_figures(const Scene& scene, const std::vector<ZoneState>& zones, const Results& results,
                           const std::vector<double>& displacement = {});

/// Chooses the sizes of the next grids by the present ones. displacement: as above.
GridSizes next_sizes(const SolvedState& state, const Results& results, const std::vector<ZoneState>& zones,
                     const GridSizes& present, const std::vector<double>& displacement = {});

}  // namespace cgcontact
