/// Coarse cells that are wider than the body is thick. A trilinear displacement bends such a piece of a plate only with
/// a parasitic shear that is (width / thickness)^2 times as stiff as the bending (shear locking): the coarser the
/// level, the less of a bending motion it would correct. So the shear across the plate is taken as constant along it,
/// in coarse levels of the preconditioner only; and as what bends is then soft compared with what shears, the smoother
/// of such a level works on more of the spectrum.
#pragma once

#include <vector>

namespace cgcontact {

struct SoftCells {
  /// (body, active cell): all nodes belong to columns along one axis, and so do those of all cells that it is made of
  /// on the finer levels: a corner of a solid body is not thin.
  std::vector<std::vector<char>> thin;
  std::vector<std::vector<signed char>> axis;  ///< (body, active cell): direction across the plate, -1: none
  /// (body, active cell): BodyMesh::full_volume, the mean thickness where a body is thin; empty: none is.
  std::vector<std::vector<double>> full_volume;
  int halvings = 0;  ///< log2 of cell size over thickness of the thinnest such body, rounded; 0 without such cells
  signed char of(std::size_t body, std::size_t cell) const { return axis.empty() ? -1 : axis[body][cell]; }
};

}  // namespace cgcontact
