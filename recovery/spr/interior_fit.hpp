/// Polynomials of nodes inside of a body, whose patches are eight full cells of one size without contact: made from the
/// displacements on demand, by a few hundred operations instead of 200 bytes for each node of the volume.
#pragma once

#include <functional>
#include <vector>

#include "core/base/numbers/cell_lists.hpp"
#include "recovery/patch/patches.hpp"

namespace cgcontact {

class InteriorFit {
 public:
  /// Prepares the fit. u: displacements of all bodies, which must not change. corrected: in equilibrium (paper,
  /// equation 4), div sigma per cell unit at a node of the body being `divergence`; empty: zero. Otherwise the plain
  /// fit (equation 1).
  InteriorFit(const BodyMesh& mesh, const RealView& u, bool corrected, std::function<Vec3(int node)> divergence = {});

  /// Returns the 6 x 4 coefficients of a node. Throws std::logic_error if its patch is another one.
  void at(int node, double* a) const;
  /// Evaluates the fit at many nodes: each cell is integrated once. values: 24 of each.
  void at_all(const std::vector<int>& nodes, double* values) const;

 private:
  using Integrals = std::array<double, 6 * num_terms>;  ///< of {1, x, y, z} sigma_h over a full cell

  void find_cells(int node, int cells[8]) const;
  Integrals integrals_of(int cell) const;
  template <class IntegralsOf>
  void fit(int node, const IntegralsOf& integrals_of_cell, double* a) const;

  const BodyMesh& mesh_;
  HostVector u_;
  bool corrected_;
  std::function<Vec3(int node)> divergence_;
};

/// Returns the nodes of a body that InteriorFit does not know: those of other patches, of cells with contact, and
/// constrained ones with their masters. contacts: what touches each cell.
Subset nodes_beside_interior(const BodyMesh& mesh, const CellLists& contacts);

}  // namespace cgcontact
