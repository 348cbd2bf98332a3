/// Numbering of the nodes of elements of any degree: they lie on a lattice `degree` times as fine as the grid.
#pragma once

#include <array>
#include <vector>

#include "core/cells/cut_cells.hpp"
#include "kernels/mesh/hex.hpp"

namespace cgcontact {

template <int degree>
struct ElementNodes {
  GridNumbers numbers;            ///< of the lattice's positions: indices into positions
  std::vector<Index3> positions;  ///< of each node on the lattice, by k, j, i
  std::vector<std::array<int, HexElement<degree>::num_nodes>> of_cell;  ///< first_node + index, of each active cell
};

/// Numbers the nodes of all active cells and of the given virtual cells, in the order of the lattice.
template <int degree>
ElementNodes<degree> number_element_nodes(const CutCells& cells, int first_node,
                                          const std::vector<Index3>& virtual_cells = {}) {
  using Element = HexElement<degree>;
  ElementNodes<degree> nodes;
  const auto corner = [](const Index3& cell, int j, int k) {
    return Index3{degree * cell[0], degree * cell[1] + j, degree * cell[2] + k};
  };
  if (degree == 1 && virtual_cells.empty()) {
    nodes.numbers = cells.numbers.corners();
  } else {
    const Index3& n = cells.grid.num_cells;
    nodes.numbers = GridNumbers({degree * n[0] + 1, degree * n[1] + 1, degree * n[2] + 1});
    for (const std::vector<Index3>* list : {&cells.cells, &virtual_cells})
      for (const Index3& cell : *list)
        for (int k = 0; k <= degree; ++k)
          for (int j = 0; j <= degree; ++j) nodes.numbers.insert_row(corner(cell, j, k), degree + 1);
    nodes.numbers.number();
  }
  nodes.positions.reserve(nodes.numbers.size());
  nodes.numbers.each([&](const Index3& position) { nodes.positions.push_back(position); });
  nodes.of_cell.resize(cells.cells.size());
  for (std::size_t e = 0; e < cells.cells.size(); ++e)
    for (int k = 0; k <= degree; ++k)
      for (int j = 0; j <= degree; ++j) {
        const int first = first_node + nodes.numbers.find(corner(cells.cells[e], j, k));
        for (int i = 0; i <= degree; ++i) nodes.of_cell[e][Element::node(i, j, k)] = first + i;  // along x one by one
      }
  return nodes;
}

}  // namespace cgcontact
