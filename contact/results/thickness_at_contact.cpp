#include "contact/results/thickness_at_contact.hpp"

#include <Eigen/Eigenvalues>
#include <limits>

namespace cgcontact {
namespace {

/// Cells around those with closed points. Faces, edges and corners of solid bodies count as eight cells thick.
constexpr int reach = 3;

}  // namespace

double thickness_at_contact(const SolvedState& state, const ContactPair& pair, int body) {
  const BodyModel& model = state.bodies[body];
  const CutCells& cells = model.cut_cells;
  std::vector<Index3> closed;
  for (const ContactPoint& q : pair.points)
    if (q.active) closed.push_back(cells.cells[body == pair.primary ? q.primary_cell : q.secondary_cell]);
  std::vector<char> near(cells.cells.size(), 0);
  mark_around(cells, std::move(closed), reach, near);
  double volume = 0;
  for (std::size_t e = 0; e < near.size(); ++e)
    if (near[e]) volume += cells.volume_fraction(static_cast<int>(e));
  Mat3 facing = Mat3::Zero();  // area times the squares of the normals' components
  const BoundaryPoints& boundary = cells.boundary;
  for (std::size_t p = 0; p < boundary.size(); ++p)
    if (near[boundary.cell[p]] && !model.boundary.conditions[model.boundary.condition_of_point[p]].is_support())
      facing += boundary.weight[p] * boundary.normal[p] * boundary.normal[p].transpose();
  const double area = Eigen::SelfAdjointEigenSolver<Mat3>(facing).eigenvalues()[2];
  return area > 0 ? 2 * volume / area : std::numeric_limits<double>::infinity();
}

}  // namespace cgcontact
