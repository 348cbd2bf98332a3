#include "contact/results/verdict/thickness_at_contact.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/numbers/decompositions.hpp"
#include "core/cells/cells_around.hpp"

namespace cgcontact {
namespace {

/// Cells around those with closed points. Faces, edges and corners of solid bodies count as eight cells thick.
constexpr int num_cells_around = 3;

}  // namespace

Thickness thickness_at_contact(const SolvedState& state, const ContactPair& pair, int body) {
  const BodyModel& model = state.bodies[body];
  const CutCells& cells = model.cut_cells;
  std::vector<int> closed;
  int largest = cells.grid.num_levels - 1;  // level
  for (const ContactPoint& q : pair.points) {
    if (!q.active) continue;
    const int cell = body == pair.primary ? q.primary_cell : q.secondary_cell;
    closed.push_back(cell);
    largest = std::min(largest, cells.level(cell));
  }
  std::vector<char> near(cells.cells.size(), 0);
  mark_cells_around(cells, closed, num_cells_around, near);
  double volume = 0;
  for (int e = 0; e < static_cast<int>(near.size()); ++e)
    if (near[e]) volume += cells.volume(e);
  Mat3 facing = Mat3::Zero();  // area times the squares of the normals' components
  const BoundaryPoints& boundary = cells.boundary;
  for (std::size_t p = 0; p < boundary.size(); ++p)
    if (near[boundary.cell[p]] && !model.boundary.conditions[model.boundary.condition_of_point[p]].is_support())
      facing += boundary.weight[p] * boundary.normal[p] * boundary.normal[p].transpose();
  const double area = eigenvalues(facing)[2];
  const double cell = cells.grid.cell_size_of(largest);
  if (!(area > 0)) return {std::numeric_limits<double>::infinity(), cell};
  return {std::ldexp(2 * volume / area, largest), cell};
}

}  // namespace cgcontact
